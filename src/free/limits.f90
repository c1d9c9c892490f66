!> Limits on bodies, which keep the squares in kernels from overflowing.
module poinsot_free_limits
   use poinsot_core_kinds, only: dp, i8, group, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain
   use poinsot_body_class, only: body_class
   implicit none(type, external)
   private
   public :: are_slow, reject_speed, reject_speed_each, reject_torque

contains

   !> Lanes that turn faster than 1e70, or whose momentum is no number (what a kick can do), get
   !> POINSOT_E_DOMAIN and stand still with y = 0.
   pure subroutine reject_speed(class, y, status, nvec)
      type(body_class), intent(in) :: class !! of these bodies
      real(dp), intent(inout) :: y(lanes, 3)
      integer, intent(inout) :: status(lanes)
      integer, intent(in), optional :: nvec !! groups of lanes to look at, instead of all
      integer(i8) :: limit(3), excess
      integer :: l, n
      n = lanes
      if (present(nvec)) n = group*nvec
      limit = magnitude(class%limit)
      excess = -1
      !GCC$ ivdep
      do l = 1, n
         excess = max(excess, magnitude(y(l, 1)) - limit(1), magnitude(y(l, 2)) - limit(2), &
                      magnitude(y(l, 3)) - limit(3))
      end do
      if (excess <= 0) return
      do l = 1, n
         if (all(magnitude(y(l, :)) <= limit)) cycle
         if (status(l) == poinsot_ok) status(l) = poinsot_e_domain
         y(l, :) = 0
      end do
   end subroutine reject_speed

   !> Is no momentum beyond a limit?
   pure logical function are_slow(limit, y, nvec)
      real(dp), intent(in) :: limit
      real(dp), intent(in) :: y(lanes, 3)
      integer, intent(in) :: nvec           !! groups of lanes to look at
      integer(i8) :: most
      integer :: l
      most = 0
      !GCC$ ivdep
      do l = 1, group*nvec
         most = max(most, magnitude(y(l, 1)), magnitude(y(l, 2)), magnitude(y(l, 3)))
      end do
      are_slow = most <= magnitude(limit)
   end function are_slow

   !> The same for bodies that all differ.
   pure subroutine reject_speed_each(limit, y, status, nvec)
      real(dp), intent(in) :: limit(lanes, 3)   !! of each body, same axes as y
      real(dp), intent(inout) :: y(lanes, 3)
      integer, intent(inout) :: status(lanes)
      integer, intent(in) :: nvec               !! groups of lanes to look at
      integer(i8) :: excess
      integer :: j, l
      excess = -1
      do j = 1, 3
         !GCC$ ivdep
         do l = 1, group*nvec
            excess = max(excess, magnitude(y(l, j)) - magnitude(limit(l, j)))
         end do
      end do
      if (excess <= 0) return
      do l = 1, group*nvec
         if (all(magnitude(y(l, :)) <= magnitude(limit(l, :)))) cycle
         if (status(l) == poinsot_ok) status(l) = poinsot_e_domain
         y(l, :) = 0
      end do
   end subroutine reject_speed_each

   !> Lanes whose torque a force gradient cannot square, g g/I beyond 1e300, or is no number, get
   !> POINSOT_E_DOMAIN and no torque.
   pure subroutine reject_torque(class, g, status, scale)
      type(body_class), intent(in) :: class          !! of these bodies
      real(dp), intent(inout) :: g(lanes, 3)         !! body torque
      integer, intent(inout) :: status(lanes)
      real(dp), intent(in), optional :: scale(lanes) !! moments over those of the class
      real(dp) :: strongest
      integer(i8) :: limit(lanes), excess
      integer :: l
      strongest = 1e150_dp*sqrt(min(minval(class%moments, class%moments > 0), 1e200_dp))
      limit = magnitude(strongest)
      if (present(scale)) limit = magnitude(strongest*sqrt(min(scale, 1e100_dp)))
      excess = -1
      !GCC$ ivdep
      do l = 1, lanes
         excess = max(excess, magnitude(g(l, 1)) - limit(l), magnitude(g(l, 2)) - limit(l), &
                      magnitude(g(l, 3)) - limit(l))
      end do
      if (excess <= 0) return
      do l = 1, lanes
         if (all(magnitude(g(l, :)) <= limit(l))) cycle
         if (status(l) == poinsot_ok) status(l) = poinsot_e_domain
         g(l, :) = 0
      end do
   end subroutine reject_torque

   !> Bits of |x|: they compare like the numbers, and infinite and NaN are at the top. No comparison
   !> of a NaN, which would raise an exception in hosts that trap.
   elemental integer(i8) function magnitude(x)
      real(dp), intent(in) :: x
      magnitude = iand(transfer(x, 1_i8), huge(1_i8))
   end function magnitude

end module poinsot_free_limits
