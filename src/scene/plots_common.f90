!> What the plot scripts share: terminals, colours, columns of the trajectory.
module poinsot_scene_plots_common
   use poinsot_core_error, only: poinsot_error
   use poinsot_scene_files, only: out_file, put
   implicit none(type, external)
   private
   public :: put_lines, put_end


contains

   !> Lines of a script; blanks at the ends are dropped, empty ones left out.
   subroutine put_lines(file, lines, error)
      type(out_file), intent(in) :: file !! open
      character(*), intent(in) :: lines(:)
      type(poinsot_error), intent(inout) :: error
      integer :: i
      do i = 1, size(lines)
         if (len_trim(lines(i)) > 0) call put(file, trim(lines(i)), error)
      end do
   end subroutine put_lines

   !> Close the loop over terminals.
   subroutine put_end(file, error)
      type(out_file), intent(in) :: file !! open
      type(poinsot_error), intent(inout) :: error
      call put_lines(file, [character(20) :: "unset output", "}"], error)
   end subroutine put_end

end module poinsot_scene_plots_common
