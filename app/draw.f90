!> Pictures by gnuplot, and text files on the terminal.
module app_draw
   use poinsot_scene_text, only: escaped
   use app_terminal, only: say, print_error
   implicit none(type, external)
   private
   public :: draw_pictures, show_file

contains

   !> Draw plot_NAME.gp of a folder, where gnuplot is found; what it complains of stays in
   !> plot_NAME.log.
   subroutine draw_pictures(names, out, quiet)
      character(*), intent(in) :: names(:), out
      logical, intent(in) :: quiet
      character(:), allocatable :: script
      integer :: i, state, code
      if (size(names) == 0) return
      call execute_command_line("gnuplot --version >/dev/null 2>&1", exitstat=state, cmdstat=code)
      if (state /= 0 .or. code /= 0) then
         if (.not. quiet) call say("gnuplot is not here; plot_*.gp draw the pictures where it is")
         return
      end if
      do i = 1, size(names)
         script = "plot_" // trim(names(i))
         call execute_command_line("cd " // escaped(out) // " && gnuplot " // script // ".gp >" // &
                                   script // ".log 2>&1 && rm -f " // script // ".log", &
                                   exitstat=state, cmdstat=code)
         if (state /= 0 .or. code /= 0) then
            call print_error("gnuplot failed on " // script // ".gp; see " // script // &
               ".log beside it")
         else if (.not. quiet) then
            call say("picture   " // trim(names(i)) // ".svg, " // trim(names(i)) // ".png")
         end if
      end do
   end subroutine draw_pictures

   !> A text file on standard output.
   subroutine show_file(file)
      character(*), intent(in) :: file
      character(400) :: line
      integer :: unit, code
      open (newunit=unit, file=file, action="read", status="old", iostat=code)
      if (code /= 0) return
      do
         read (unit, "(a)", iostat=code) line
         if (code /= 0) exit
         call say(trim(line))
      end do
      close (unit)
   end subroutine show_file

end module app_draw
