!> What no body may exceed, so that no square of a kernel overflows.
module poinsot_free_limits
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_lanes, only: smallest
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain
   use poinsot_body_class, only: body_class
   implicit none(type, external)
   private
   public :: refuse_speed

   real(dp), parameter :: fastest = 1e70_dp      !! angular velocity, in the caller's unit

contains

   !> Lanes that turn faster than 1e70, or whose momentum is no number (what a kick can do), get
   !> POINSOT_E_DOMAIN and stand still with y = 0. The comparison cannot overflow itself.
   pure subroutine refuse_speed(class, y, status)
      type(body_class), intent(in) :: class !! of these bodies
      real(dp), intent(inout) :: y(lanes, 3)
      integer, intent(inout) :: status(lanes)
      real(dp) :: limit(3), good(lanes)
      integer :: l
      limit = fastest*min(class%moments, 1e200_dp)
      where (.not. class%moments > 0) limit = 1e270_dp
      !GCC$ ivdep
      do l = 1, lanes
         good(l) = merge(1.0_dp, 0.0_dp, abs(y(l, 1)) <= limit(1) .and. abs(y(l, 2)) <= limit(2) &
                         .and. abs(y(l, 3)) <= limit(3))
      end do
      if (smallest(good) >= 1) return
      do l = 1, lanes
         if (good(l) >= 1) cycle
         if (status(l) == poinsot_ok) status(l) = poinsot_e_domain
         y(l, :) = 0
      end do
   end subroutine refuse_speed

end module poinsot_free_limits
