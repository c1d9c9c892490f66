!> Is the rounding mode of this thread the one that the kernels are written for?
!>
!> Kernels round to integers by adding and subtracting a large number, and compute rounding errors
!> of sums exactly: both require rounding to nearest. A host may have set another mode (fesetround,
!> _MM_SET_ROUNDING_MODE), separately for each thread. So every thread that computes tests it first,
!> once per chunk of bodies, and otherwise sets POINSOT_E_DOMAIN:
!>
!>     if (.not. rounds_to_nearest()) then ... each body of the chunk gets poinsot_e_domain
!>
!> In a parallel region the test must be inside: the thread that opened it may have another mode
!> than its workers. It takes two additions, and raises no exception except inexact.
module poinsot_core_rounding
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: rounds_to_nearest

   !> Much less than the spacing of numbers next to 1. Never changed, and yet a variable, and
   !> public: of a constant the compiler itself would take the sums, in its own rounding mode.
   real(dp), public, protected, save :: rounded_off = 2.0_dp**(-60)

contains

   !> .true. if sums of this thread are rounded to nearest. The arithmetic itself is asked: a mode
   !> set behind the back of fegetround counts too.
   pure logical function rounds_to_nearest()
      real(dp) :: up, down
      up = 1.0_dp + rounded_off
      down = 1.0_dp - rounded_off
      rounds_to_nearest = up <= 1.0_dp .and. down >= 1.0_dp
   end function rounds_to_nearest

end module poinsot_core_rounding
