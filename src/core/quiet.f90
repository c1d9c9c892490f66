!> Arithmetic whose result is checked before it is used: traps are disabled meanwhile, and the flags
!> that it raised are cleared.
module poinsot_core_quiet
   use, intrinsic :: ieee_exceptions, only: ieee_all, ieee_get_status, ieee_set_halting_mode, &
      ieee_set_status, ieee_status_type, ieee_support_halting
   use poinsot_core_kinds, only: dp, i8
   implicit none(type, external)
   private
   public :: quiet_state, begin_quiet, end_quiet, is_number, no_number

   integer(i8), parameter :: infinite_bits = int(z'7ff0000000000000', i8)
   !> A quiet NaN, for a result that there is not: it raises nothing where it is added or
   !> multiplied.
   real(dp), parameter :: no_number = transfer(int(z'7ff8000000000000', i8), 1.0_dp)

   !> The floating-point environment as it was.
   type :: quiet_state
      private
      type(ieee_status_type) :: saved
   end type quiet_state

contains

   !> Disable traps in this thread.
   subroutine begin_quiet(state)
      type(quiet_state), intent(out) :: state
      integer :: i
      call ieee_get_status(state%saved)
      do i = 1, size(ieee_all)
         if (ieee_support_halting(ieee_all(i))) call ieee_set_halting_mode(ieee_all(i), .false.)
      end do
   end subroutine begin_quiet

   !> Flags and traps as they were.
   subroutine end_quiet(state)
      type(quiet_state), intent(in) :: state
      call ieee_set_status(state%saved)
   end subroutine end_quiet

   !> Neither infinite nor a NaN, by its bits: raises nothing.
   elemental logical function is_number(x)
      real(dp), intent(in) :: x
      is_number = iand(transfer(x, 1_i8), infinite_bits) /= infinite_bits
   end function is_number

end module poinsot_core_quiet
