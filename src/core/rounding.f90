!> Is this thread's arithmetic the one that the kernels are written for?
!>
!> Kernels round to integers by adding and subtracting a large number, and take sums apart into
!> what was rounded off: both are right in rounding to nearest only. A host may have set another
!> mode (fesetround, _MM_SET_ROUNDING_MODE), and each thread has one of its own. So every thread
!> that computes asks before it does, once for a chunk of bodies, and answers POINSOT_E_DOMAIN if
!> it must not:
!>
!>     if (.not. rounds_to_nearest()) then ... each body of the chunk gets poinsot_e_domain
!>
!> In a parallel region the question stands inside it: the thread that opened it may round
!> otherwise than its workers. It takes two additions, and raises no exception but inexact.
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
