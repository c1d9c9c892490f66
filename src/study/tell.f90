!> Lines for people, on a unit that the caller opened.
module poinsot_study_tell
   implicit none(type, external)
   private
   public :: tell

contains

   !> One line; none if nobody reads the unit any more.
   subroutine tell(unit, line)
      integer, intent(in) :: unit
      character(*), intent(in) :: line
      integer :: code
      write (unit, "(a)", iostat=code) trim(line)
      if (code /= 0) return
   end subroutine tell

end module poinsot_study_tell
