!> The short way for what hosts do most: free rotation of bodies of one class, in the native
!> variables, component by component with any stride. The kernels and checks are those of all ways,
!> and so are the bits; what is left out are views, sorting, and the tables of effects.
module poinsot_ensemble_direct
   use, intrinsic :: iso_c_binding, only: c_int, c_ptrdiff_t
   use poinsot_core_kinds, only: dp, group, lanes
   use poinsot_core_lanes, only: any_failed
   use poinsot_core_rounding, only: rounds_to_nearest
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain
   use poinsot_body_class, only: body_class
   use poinsot_ensemble_block, only: reject, reject_torques, add_products
   use poinsot_ensemble_layout, only: body_momentum
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_free_exact_lanes, only: advance_each, make_constants
   use poinsot_free_method, only: free_method, advance
   use poinsot_free_lane_moments, only: lane_moments, take_moments
   implicit none(type, external)
   private
   public :: one_chunk, without_inertia, takes_direct, is_free, rotate_direct, rotate_by_moments, &
      kick_direct

   integer, parameter :: without_inertia = -1
   integer, parameter :: one_chunk = 8*lanes   !! so many are never shared between threads

contains

   !> May a plan drift n bodies of its first class this way?
   pure logical function takes_direct(plan, n)
      type(poinsot_plan), intent(in) :: plan
      integer, intent(in) :: n
      takes_direct = .false.
      if (.not. plan%ready .or. plan%momentum /= body_momentum) return
      if (plan%threads /= 1 .and. n > one_chunk) return
      if (plan%class_count() < 1) return
      associate (class => plan%classes(1)%it)
         takes_direct = class%sorted(1) > 0 .and. .not. (class%has_rotor .or. plan%is_turned(class))
      end associate
   end function takes_direct

   !> Is a step of a plan free rotation and nothing else?
   pure logical function is_free(plan)
      type(poinsot_plan), intent(in) :: plan       !! ready
      is_free = size(plan%effects) == 0 .and. .not. allocated(plan%taylor)
   end function is_free

   !> `steps` steps of h. Bodies that fail keep their state.
   subroutine rotate_direct(class, method, h, steps, n, y1, y2, y3, dy, q0, q1, q2, q3, dq, &
                            failed, each)
      type(body_class), intent(in) :: class           !! with inertia about every axis
      type(free_method), intent(in) :: method
      real(dp), intent(in) :: h                       !! finite
      integer, intent(in) :: steps, n
      real(dp), intent(inout) :: y1(*), y2(*), y3(*), q0(*), q1(*), q2(*), q3(*)
      integer(c_ptrdiff_t), intent(in) :: dy, dq      !! strides
      logical, intent(out) :: failed                  !! some did
      integer(c_int), intent(inout), optional :: each(n) !! the status of each
      real(dp) :: y(lanes, 3), q(lanes, 4)
      integer :: status(lanes), first, m, nvec, k
      failed = n > 0 .and. .not. rounds_to_nearest()
      if (failed) then
         if (present(each)) each = poinsot_e_domain
         return
      end if
      do first = 1, n, lanes
         m = min(lanes, n - first + 1)
         nvec = (m + group - 1)/group
         call load(m, nvec, first, y1, y2, y3, dy, q0, q1, q2, q3, dq, y, q)
         status(:group*nvec) = poinsot_ok
         call reject(nvec, 3, [class%limit, 0.0_dp], y, q, status)
         do k = 1, steps
            call advance(method, class, h, y, q, status, nvec=nvec)
         end do
         call store(m, nvec, first, y, q, status, y1, y2, y3, dy, q0, q1, q2, q3, dq, failed, each)
      end do
   end subroutine rotate_direct

   !> Bodies of one kind in rows, by constants for each lane: no class is made. Not for bodies with
   !> an axis without inertia.
   subroutine rotate_by_moments(moments, by_jacobi, h, steps, n, y, q, failed, refused, each)
      real(dp), intent(in) :: moments(3)
      logical, intent(in) :: by_jacobi                !! method `jacobi`, else `exact`
      real(dp), intent(in) :: h                       !! finite
      integer, intent(in) :: steps, n
      real(dp), intent(inout) :: y(3, n), q(4, n)
      logical, intent(out) :: failed
      integer, intent(out) :: refused                 !! status of the moments, or without_inertia
      integer(c_int), intent(inout), optional :: each(n)
      type(lane_moments) :: own
      real(dp) :: yb(lanes, 3), qb(lanes, 4), hl(lanes)
      integer :: status(lanes), first, m, nvec, k
      failed = n > 0 .and. .not. rounds_to_nearest()
      refused = poinsot_ok
      if (failed) then
         if (present(each)) each = poinsot_e_domain
         return
      end if
      status = poinsot_ok
      call take_moments(spread(moments, 1, lanes), max(1, min(lanes, n + group - 1)/group), own, &
                        status)
      refused = status(1)
      if (refused == poinsot_ok .and. own%linear) refused = without_inertia
      if (refused /= poinsot_ok) return
      call make_constants(max(1, min(lanes, n + group - 1)/group), own%moments, own%constants)
      hl = h
      do first = 1, n, lanes
         m = min(lanes, n - first + 1)
         nvec = (m + group - 1)/group
         call load(m, nvec, first, y(1, 1), y(2, 1), y(3, 1), 3_c_ptrdiff_t, q(1, 1), q(2, 1), &
                   q(3, 1), q(4, 1), 4_c_ptrdiff_t, yb, qb)
         status(:group*nvec) = poinsot_ok
         call reject(nvec, 3, [own%limit(1, :), 0.0_dp], yb, qb, status)
         do k = 1, steps
            call advance_each(own%constants, by_jacobi, hl, yb, qb, status, nvec)
         end do
         call store(m, nvec, first, yb, qb, status, y(1, 1), y(2, 1), y(3, 1), 3_c_ptrdiff_t, &
                    q(1, 1), q(2, 1), q(3, 1), q(4, 1), 4_c_ptrdiff_t, failed, each)
      end do
   end subroutine rotate_by_moments

   !> y += h g. A torque, or a sum, that is no number fails its body.
   subroutine kick_direct(class, h, n, g1, g2, g3, dg, y1, y2, y3, dy, q0, q1, q2, q3, dq, failed, &
                          each)
      type(body_class), intent(in) :: class           !! with inertia about every axis
      real(dp), intent(in) :: h                       !! finite
      integer, intent(in) :: n
      real(dp), intent(in) :: g1(*), g2(*), g3(*)     !! torques, body frame
      real(dp), intent(inout) :: y1(*), y2(*), y3(*)
      real(dp), intent(in) :: q0(*), q1(*), q2(*), q3(*)
      integer(c_ptrdiff_t), intent(in) :: dg, dy, dq  !! strides
      logical, intent(out) :: failed
      integer(c_int), intent(inout), optional :: each(n)
      real(dp) :: y(lanes, 3), q(lanes, 4), g(lanes, 3)
      integer(c_ptrdiff_t) :: at
      integer :: status(lanes), first, m, nvec, l
      failed = n > 0 .and. .not. rounds_to_nearest()
      if (failed) then
         if (present(each)) each = poinsot_e_domain
         return
      end if
      do first = 1, n, lanes
         m = min(lanes, n - first + 1)
         nvec = (m + group - 1)/group
         call load(m, nvec, first, y1, y2, y3, dy, q0, q1, q2, q3, dq, y, q)
         g(:group*nvec, :) = 0
         at = 1 + (first - 1)*dg
         do l = 1, m
            g(l, 1) = g1(at)
            g(l, 2) = g2(at)
            g(l, 3) = g3(at)
            at = at + dg
         end do
         status(:group*nvec) = poinsot_ok
         call reject(nvec, 3, [class%limit, 0.0_dp], y, q, status)
         call reject_torques(nvec, h, g, status)
         call add_products(nvec, h, g, y, status)
         at = 1 + (first - 1)*dy
         do l = 1, m
            if (status(l) == poinsot_ok) then
               y1(at) = y(l, 1)
               y2(at) = y(l, 2)
               y3(at) = y(l, 3)
            end if
            at = at + dy
         end do
         if (present(each)) each(first:first + m - 1) = status(:m)
         failed = failed .or. any_failed(status, nvec)
      end do
   end subroutine kick_direct

   !> Bodies from `first` on into the first m lanes; the rest of the last group is at rest.
   pure subroutine load(m, nvec, first, y1, y2, y3, dy, q0, q1, q2, q3, dq, y, q)
      integer, intent(in) :: m, nvec, first
      real(dp), intent(in) :: y1(*), y2(*), y3(*), q0(*), q1(*), q2(*), q3(*)
      integer(c_ptrdiff_t), intent(in) :: dy, dq
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      integer(c_ptrdiff_t) :: at
      integer :: l
      at = 1 + (first - 1)*dy
      do l = 1, m
         y(l, 1) = y1(at)
         y(l, 2) = y2(at)
         y(l, 3) = y3(at)
         at = at + dy
      end do
      at = 1 + (first - 1)*dq
      do l = 1, m
         q(l, 1) = q0(at)
         q(l, 2) = q1(at)
         q(l, 3) = q2(at)
         q(l, 4) = q3(at)
         at = at + dq
      end do
      do l = m + 1, group*nvec
         y(l, :) = 0
         q(l, :) = [1, 0, 0, 0]
      end do
   end subroutine load

   !> And back, but for those that failed.
   pure subroutine store(m, nvec, first, y, q, status, y1, y2, y3, dy, q0, q1, q2, q3, dq, failed, &
                         each)
      integer, intent(in) :: m, nvec, first
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4)
      integer, intent(in) :: status(lanes)
      real(dp), intent(inout) :: y1(*), y2(*), y3(*), q0(*), q1(*), q2(*), q3(*)
      integer(c_ptrdiff_t), intent(in) :: dy, dq
      logical, intent(inout) :: failed
      integer(c_int), intent(inout), optional :: each(*)
      integer(c_ptrdiff_t) :: at
      integer :: l
      if (present(each)) each(first:first + m - 1) = status(:m)
      if (any_failed(status, nvec)) then
         failed = .true.
         do l = 1, m
            if (status(l) /= poinsot_ok) cycle
            at = 1 + (first + l - 2)*dy
            y1(at) = y(l, 1)
            y2(at) = y(l, 2)
            y3(at) = y(l, 3)
            at = 1 + (first + l - 2)*dq
            q0(at) = q(l, 1)
            q1(at) = q(l, 2)
            q2(at) = q(l, 3)
            q3(at) = q(l, 4)
         end do
         return
      end if
      at = 1 + (first - 1)*dy
      do l = 1, m
         y1(at) = y(l, 1)
         y2(at) = y(l, 2)
         y3(at) = y(l, 3)
         at = at + dy
      end do
      at = 1 + (first - 1)*dq
      do l = 1, m
         q0(at) = q(l, 1)
         q1(at) = q(l, 2)
         q2(at) = q(l, 3)
         q3(at) = q(l, 4)
         at = at + dq
      end do
   end subroutine store

end module poinsot_ensemble_direct
