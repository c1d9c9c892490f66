!> The short path for bodies with moments of their own: a multiple of those of the class, or
!> arbitrary. See poinsot_ensemble_direct.
module poinsot_ensemble_direct_by_lane
   use poinsot_core_kinds, only: dp, group, lanes
   use poinsot_core_lanes, only: any_failed
   use poinsot_core_status, only: poinsot_ok
   use poinsot_body_class, only: body_class
   use poinsot_ensemble_block, only: reject, reject_by_lane, reject_torques, add_products
   use poinsot_ensemble_layout, only: body_momentum, body_velocity, space_velocity, from_native, &
      to_native
   use poinsot_ensemble_plain, only: ask_for, plain_arrays, plain_torques, load, load_moments, &
      load_scale, load_torques, store
   use poinsot_free_lane_moments, only: lane_moments, advance_by_lane, common_limit, &
      complete_moments, take_moments, take_scale
   use poinsot_free_limits, only: are_slow, reject_speed_each
   use poinsot_free_method, only: free_method
   implicit none(type, external)
   private
   public :: rotate_by_lane, kick_by_lane

contains

   !> `steps` steps of h. Bodies that fail keep their state. A block with a body that has no inertia
   !> about an axis, and what comes after it, is left.
   subroutine rotate_by_lane(class, method, momentum, h, steps, keep, a, failed, left)
      type(body_class), intent(in) :: class
      type(free_method), intent(in) :: method
      integer, intent(in) :: momentum
      real(dp), intent(in) :: h
      integer, intent(in) :: steps
      logical, intent(in) :: keep
      type(plain_arrays), intent(in) :: a
      logical, intent(inout) :: failed
      integer, intent(out) :: left              !! first body that is left; 0: none is
      real(dp) :: y(lanes, 3), q(lanes, 4), p(lanes, 4)
      type(lane_moments) :: by_lane
      integer :: status(lanes), first, m, nvec, k
      left = 0
      do k = 1, lanes ! a loop here has the compiler align the whole of them
         y(k, 1) = 0
         q(k, 1) = 0
         p(k, 1) = 0
         by_lane%scale(k) = 1
      end do
      do first = 1, a%n, lanes
         m = min(lanes, a%n - first + 1)
         nvec = (m + group - 1)/group
         if (a%has_moments) call ask_for(a, first)
         call take_by_lane(class, momentum, a, first, m, nvec, by_lane, status)
         if (by_lane%linear) then
            left = first
            return
         end if
         if (momentum == body_momentum) then
            call load(a, first, m, nvec, y, q)
            call reject_by_lane(class, nvec, by_lane, y, q, status)
            call advance_by_lane(by_lane, method, class, h, steps, y, q, status, nvec)
            call store(a, first, m, nvec, y, q, status, .false., .false., failed)
         else
            call load_by_lane(class, momentum, a, first, m, nvec, by_lane, p, q, y, status)
            call advance_by_lane(by_lane, method, class, h, steps, y, q, status, nvec)
            if (.not. keep) call from_native(momentum, .false., class, class%rotor, y, q, p, &
               by_lane, nvec)
            call store(a, first, m, nvec, p, q, status, keep, .false., failed)
         end if
      end do
   end subroutine rotate_by_lane

   !> p += h g in the caller's variable.
   subroutine kick_by_lane(class, momentum, h, g, a, failed, left)
      type(body_class), intent(in) :: class
      integer, intent(in) :: momentum
      real(dp), intent(in) :: h
      type(plain_torques), intent(in) :: g
      type(plain_arrays), intent(in) :: a
      logical, intent(inout) :: failed
      integer, intent(out) :: left
      real(dp) :: y(lanes, 3), q(lanes, 4), p(lanes, 4), torque(lanes, 3)
      type(lane_moments) :: by_lane
      integer :: status(lanes), first, m, nvec, k
      left = 0
      do k = 1, lanes ! aligned
         y(k, 1) = 0
         q(k, 1) = 0
         p(k, 1) = 0
         torque(k, 1) = 0
         by_lane%scale(k) = 1
      end do
      do first = 1, a%n, lanes
         m = min(lanes, a%n - first + 1)
         nvec = (m + group - 1)/group
         if (a%has_moments) call ask_for(a, first)
         call take_by_lane(class, momentum, a, first, m, nvec, by_lane, status)
         if (by_lane%linear) then
            left = first
            return
         end if
         call load_torques(g, first, m, nvec, torque)
         if (momentum == body_momentum) then
            call load(a, first, m, nvec, p, q)
            call reject_by_lane(class, nvec, by_lane, p, q, status)
         else
            call load_by_lane(class, momentum, a, first, m, nvec, by_lane, p, q, y, status)
         end if
         call reject_torques(nvec, h, torque, status)
         call add_products(nvec, h, torque, p, status)
         call store(a, first, m, nvec, p, q, status, .false., .true., failed)
      end do
   end subroutine kick_by_lane

   !> Moments of a block.
   subroutine take_by_lane(class, momentum, a, first, m, nvec, by_lane, status)
      type(body_class), intent(in) :: class
      integer, intent(in) :: momentum
      type(plain_arrays), intent(in) :: a
      integer, intent(in) :: first, m, nvec
      type(lane_moments), intent(inout) :: by_lane
      integer, intent(out) :: status(lanes)
      status = poinsot_ok
      if (a%has_moments) then
         call load_moments(a, first, m, nvec, by_lane%moments)
         call take_moments(nvec, by_lane, status)
      else
         call load_scale(a, first, m, nvec, by_lane%scale)
         call take_scale(class, nvec, by_lane, status)
      end if
      if (momentum == body_velocity .or. momentum == space_velocity) then
         call complete_moments(class, nvec, by_lane)
      end if
   end subroutine take_by_lane

   !> The caller's variable, checked, and y.
   subroutine load_by_lane(class, momentum, a, first, m, nvec, by_lane, p, q, y, status)
      type(body_class), intent(in) :: class
      integer, intent(in) :: momentum
      type(plain_arrays), intent(in) :: a
      integer, intent(in) :: first, m, nvec
      type(lane_moments), intent(inout) :: by_lane
      real(dp), intent(inout) :: p(lanes, 4), q(lanes, 4), y(lanes, 3)
      integer, intent(inout) :: status(lanes)
      real(dp), parameter :: none = huge(1.0_dp)
      integer :: l
      call load(a, first, m, nvec, p, q)
      call reject(nvec, a%columns, [none, none, none, none], p, q, status)
      if (any_failed(status, nvec)) then
         do l = 1, m
            if (status(l) == poinsot_ok) cycle
            p(l, :) = 0
            q(l, :) = [1, 0, 0, 0]
         end do
      end if
      call to_native(momentum, .false., class, class%rotor, p, y, q, by_lane, nvec)
      call reject_speed_by_lane(class, nvec, by_lane, y, status)
   end subroutine load_by_lane

   !> Bodies that turn too fast.
   pure subroutine reject_speed_by_lane(class, nvec, by_lane, y, status)
      type(body_class), intent(in) :: class
      integer, intent(in) :: nvec
      type(lane_moments), intent(inout) :: by_lane
      real(dp), intent(inout) :: y(lanes, 3)
      integer, intent(inout) :: status(lanes)
      if (are_slow(common_limit(by_lane), y, nvec)) return
      call complete_moments(class, nvec, by_lane)
      call reject_speed_each(by_lane%limit, y, status, nvec)
   end subroutine reject_speed_by_lane

end module poinsot_ensemble_direct_by_lane
