!> Lines of text, written to a unit that the caller opened.
module poinsot_study_write_line
   implicit none(type, external)
   private
   public :: write_line

contains

   !> Write one line; nothing if the unit is no longer read.
   subroutine write_line(unit, line)
      integer, intent(in) :: unit
      character(*), intent(in) :: line
      integer :: code
      write (unit, "(a)", iostat=code) trim(line)
      if (code /= 0) return
   end subroutine write_line

end module poinsot_study_write_line
