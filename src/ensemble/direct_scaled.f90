!> The short way for bodies of one shape and any size: the moments of each are a number times those
!> of the class. See poinsot_ensemble_direct.
module poinsot_ensemble_direct_scaled
   use poinsot_core_kinds, only: dp, group, lanes
   use poinsot_core_lanes, only: any_failed
   use poinsot_core_status, only: poinsot_ok
   use poinsot_body_class, only: body_class
   use poinsot_ensemble_block, only: reject, reject_torques, add_products
   use poinsot_ensemble_layout, only: from_native, to_native
   use poinsot_ensemble_plain, only: plain_arrays, plain_torques, load, load_torques, store
   use poinsot_free_lane_moments, only: lane_moments, advance_own, take_scale
   use poinsot_free_limits, only: reject_speed_each
   use poinsot_free_method, only: free_method
   implicit none(type, external)
   private
   public :: rotate_scaled, kick_scaled

contains

   !> `steps` steps of h. Bodies that fail keep their state.
   subroutine rotate_scaled(class, method, momentum, h, steps, keep, a, failed)
      type(body_class), intent(in) :: class
      type(free_method), intent(in) :: method
      integer, intent(in) :: momentum
      real(dp), intent(in) :: h
      integer, intent(in) :: steps
      logical, intent(in) :: keep
      type(plain_arrays), intent(in) :: a
      logical, intent(inout) :: failed
      real(dp) :: y(lanes, 3), q(lanes, 4), p(lanes, 4)
      type(lane_moments) :: own
      integer :: status(lanes), first, m, nvec, k
      do k = 1, lanes ! a loop here has the compiler align the whole of them
         y(k, 1) = 0
         q(k, 1) = 0
         p(k, 1) = 0
         own%scale(k) = 1
      end do
      do first = 1, a%n, lanes
         m = min(lanes, a%n - first + 1)
         nvec = (m + group - 1)/group
         call load_scaled(class, momentum, a, first, m, nvec, own, p, q, y, status)
         do k = 1, steps
            call advance_own(own, method, class, h, y, q, status, nvec)
         end do
         if (.not. keep) call from_native(momentum, .false., class, class%rotor, y, q, p, own, nvec)
         call store(a, first, m, nvec, p, q, status, keep, .false., failed)
      end do
   end subroutine rotate_scaled

   !> p += h g in the caller's variable.
   subroutine kick_scaled(class, momentum, h, g, a, failed)
      type(body_class), intent(in) :: class
      integer, intent(in) :: momentum
      real(dp), intent(in) :: h
      type(plain_torques), intent(in) :: g
      type(plain_arrays), intent(in) :: a
      logical, intent(inout) :: failed
      real(dp) :: y(lanes, 3), q(lanes, 4), p(lanes, 4), torque(lanes, 3)
      type(lane_moments) :: own
      integer :: status(lanes), first, m, nvec, k
      do k = 1, lanes ! aligned
         y(k, 1) = 0
         q(k, 1) = 0
         p(k, 1) = 0
         torque(k, 1) = 0
         own%scale(k) = 1
      end do
      do first = 1, a%n, lanes
         m = min(lanes, a%n - first + 1)
         nvec = (m + group - 1)/group
         call load_torques(g, first, m, nvec, torque)
         call load_scaled(class, momentum, a, first, m, nvec, own, p, q, y, status)
         call reject_torques(nvec, h, torque, status)
         call add_products(nvec, h, torque, p, status)
         call store(a, first, m, nvec, p, q, status, .false., .true., failed)
      end do
   end subroutine kick_scaled

   !> A block of such bodies, checked.
   subroutine load_scaled(class, momentum, a, first, m, nvec, own, p, q, y, status)
      type(body_class), intent(in) :: class
      integer, intent(in) :: momentum
      type(plain_arrays), intent(in) :: a
      integer, intent(in) :: first, m, nvec
      type(lane_moments), intent(inout) :: own
      real(dp), intent(inout) :: p(lanes, 4), q(lanes, 4), y(lanes, 3)
      integer, intent(out) :: status(lanes)
      real(dp), parameter :: none = huge(1.0_dp)
      real(dp) :: factor(lanes)
      integer :: l
      do l = 1, lanes
         factor(l) = 1
         status(l) = poinsot_ok
      end do
      do l = 1, m
         factor(l) = a%scale(first + l - 1)
      end do
      call take_scale(class, factor, own, status)
      call load(a, first, m, nvec, p, q)
      call reject(nvec, a%columns, [none, none, none, none], p, q, status)
      if (any_failed(status, nvec)) then
         do l = 1, m
            if (status(l) == poinsot_ok) cycle
            p(l, :) = 0
            q(l, :) = [1, 0, 0, 0]
         end do
      end if
      call to_native(momentum, .false., class, class%rotor, p, y, q, own, nvec)
      call reject_speed_each(own%limit, y, status, nvec)
   end subroutine load_scaled

end module poinsot_ensemble_direct_scaled
