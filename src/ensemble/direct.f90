!> A short path for the most frequent calls of hosts: free rotation and kicks of bodies of one
!> class, if a call has nothing but y, q, statuses, and scales or moments. Kernels, transformations
!> of momenta and checks are those of the general path, and so are the bits; views, sorting and the
!> tables of effects are left out.
module poinsot_ensemble_direct
   use poinsot_core_kinds, only: dp, group, lanes
   use poinsot_core_rounding, only: rounds_to_nearest
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain
   use poinsot_body_class, only: body_class
   use poinsot_ensemble_block, only: reject, reject_torques, add_products
   use poinsot_ensemble_direct_by_lane, only: kick_by_lane, rotate_by_lane
   use poinsot_ensemble_layout, only: body_momentum, conjugate_momentum, space_momentum, &
      from_native, to_native
   use poinsot_ensemble_plain, only: plain_arrays, plain_torques, load, load_torques, store
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_free_exact_lanes, only: advance_each, make_constants
   use poinsot_free_limits, only: reject_speed
   use poinsot_free_method, only: free_method, advance
   use poinsot_free_lane_moments, only: lane_moments, speed_limit, take_moments, &
      takes_moments
   implicit none(type, external)
   private
   public :: one_chunk, without_inertia, takes_direct, is_free, adds_direct, momentum_columns, &
      rotate_direct, rotate_by_moments, kick_direct

   integer, parameter :: without_inertia = -1
   integer, parameter :: one_chunk = 8*lanes   !! so many are never shared between threads

contains

   !> May a plan drift n bodies of its first class, or with moments of their own, this way?
   pure logical function takes_direct(plan, n, by_moments)
      type(poinsot_plan), intent(in) :: plan
      integer, intent(in) :: n
      logical, intent(in) :: by_moments
      takes_direct = .false.
      if (.not. plan%ready) return
      if (plan%threads /= 1 .and. n > one_chunk) return
      if (by_moments) then
         if (.not. takes_moments(plan%method)) return
      else if (plan%class_count() < 1) then
         return
      end if
      associate (class => plan%classes(1)%it)
         takes_direct = class%sorted(1) > 0 .and. .not. (class%has_rotor .or. plan%is_turned(class))
      end associate
   end function takes_direct

   !> Is a step of a plan free rotation and nothing else?
   pure logical function is_free(plan)
      type(poinsot_plan), intent(in) :: plan       !! ready
      is_free = size(plan%effects) == 0 .and. .not. allocated(plan%taylor)
   end function is_free

   !> Is a kick a sum in the caller's own variable?
   pure logical function adds_direct(plan)
      type(poinsot_plan), intent(in) :: plan
      adds_direct = plan%momentum == merge(space_momentum, body_momentum, plan%space_torque)
   end function adds_direct

   !> Components of the caller's momentum variable.
   pure integer function momentum_columns(plan)
      type(poinsot_plan), intent(in) :: plan
      momentum_columns = merge(4, 3, plan%momentum == conjugate_momentum)
   end function momentum_columns

   !> `steps` steps of h. Bodies that fail keep their state. Of bodies with moments some may be left
   !> for another way.
   subroutine rotate_direct(class, method, momentum, h, steps, keep, a, failed, left)
      type(body_class), intent(in) :: class      !! with inertia about every axis, and no rotors
      type(free_method), intent(in) :: method
      integer, intent(in) :: momentum            !! the caller's variable
      real(dp), intent(in) :: h                  !! finite
      integer, intent(in) :: steps
      logical, intent(in) :: keep                !! the momentum variable is left as it is
      type(plain_arrays), intent(in) :: a
      logical, intent(out) :: failed             !! some did
      integer, intent(out) :: left               !! the first that is left; 0: none
      real(dp) :: y(lanes, 3), q(lanes, 4), p(lanes, 4)
      integer :: status(lanes), first, m, nvec, k
      left = 0
      call refuse_all(a, failed)
      if (failed) return
      if (associated(a%scale) .or. a%has_moments) then
         call rotate_by_lane(class, method, momentum, h, steps, keep, a, failed, left)
         return
      end if
      do k = 1, lanes ! a loop here has the compiler align the whole of them
         y(k, 1) = 0
         q(k, 1) = 0
         p(k, 1) = 0
      end do
      do first = 1, a%n, lanes
         m = min(lanes, a%n - first + 1)
         nvec = (m + group - 1)/group
         status = poinsot_ok
         if (momentum == body_momentum) then
            call load(a, first, m, nvec, y, q)
            call reject(nvec, 3, [class%limit, 0.0_dp], y, q, status)
         else
            call load(a, first, m, nvec, p, q)
            call make_native(class, momentum, a%columns, nvec, p, q, y, status)
         end if
         do k = 1, steps
            call advance(method, class, h, y, q, status, nvec=nvec)
         end do
         if (momentum == body_momentum) then
            call store(a, first, m, nvec, y, q, status, .false., .false., failed)
         else
            if (.not. keep) call from_native(momentum, .false., class, class%rotor, y, q, p, &
               nvec=nvec)
            call store(a, first, m, nvec, p, q, status, keep, .false., failed)
         end if
      end do
   end subroutine rotate_direct

   !> A thread that does not round to nearest computes nothing.
   subroutine refuse_all(a, failed)
      type(plain_arrays), intent(in) :: a
      logical, intent(out) :: failed
      failed = a%n > 0 .and. .not. rounds_to_nearest()
      if (failed .and. associated(a%each)) a%each = poinsot_e_domain
   end subroutine refuse_all

   !> The caller's momentum variable, checked, and y.
   pure subroutine make_native(class, momentum, columns, nvec, p, q, y, status)
      type(body_class), intent(in) :: class
      integer, intent(in) :: momentum, columns, nvec
      real(dp), intent(inout) :: p(lanes, 4), q(lanes, 4), y(lanes, 3)
      integer, intent(inout) :: status(lanes)
      real(dp), parameter :: none = huge(1.0_dp)
      call reject(nvec, columns, [none, none, none, none], p, q, status)
      call to_native(momentum, .false., class, class%rotor, p, y, q, nvec=nvec)
      call reject_speed(class, y, status, nvec)
   end subroutine make_native

   !> Bodies of one kind in rows, by constants for each lane: no class is made. Not for bodies with
   !> an axis without inertia.
   subroutine rotate_by_moments(moments, by_jacobi, h, steps, a, failed, refused)
      real(dp), intent(in) :: moments(3)
      logical, intent(in) :: by_jacobi           !! method `jacobi`, else `exact`
      real(dp), intent(in) :: h                  !! finite
      integer, intent(in) :: steps
      type(plain_arrays), intent(in) :: a        !! angular momenta, body frame
      logical, intent(out) :: failed
      integer, intent(out) :: refused            !! status of the moments, or without_inertia
      type(lane_moments) :: by_lane
      real(dp) :: y(lanes, 3), q(lanes, 4), hl(lanes), limit(3)
      integer :: status(lanes), first, m, nvec, most
      refused = poinsot_ok
      call refuse_all(a, failed)
      if (failed) return
      status = poinsot_ok
      most = max(1, min(lanes, a%n + group - 1)/group)
      by_lane%moments(:group*most, :) = spread(moments, 1, group*most)
      call take_moments(most, by_lane, status)
      refused = status(1)
      if (refused == poinsot_ok .and. by_lane%linear) refused = without_inertia
      if (refused /= poinsot_ok) return
      call make_constants(most, by_lane%moments, by_lane%constants)
      limit = speed_limit(by_lane%moments(1, :))
      hl = h
      do first = 1, a%n, lanes
         m = min(lanes, a%n - first + 1)
         nvec = (m + group - 1)/group
         call load(a, first, m, nvec, y, q)
         status(:group*nvec) = poinsot_ok
         call reject(nvec, 3, [limit, 0.0_dp], y, q, status)
         call advance_each(by_lane%constants, by_jacobi, hl, steps, y, q, status, nvec)
         call store(a, first, m, nvec, y, q, status, .false., .false., failed)
      end do
   end subroutine rotate_by_moments

   !> p += h g in the caller's variable. A torque, or a sum, that is no number fails its body.
   subroutine kick_direct(class, momentum, h, g, a, failed, left)
      type(body_class), intent(in) :: class      !! with inertia about every axis, and no rotors
      integer, intent(in) :: momentum            !! the caller's variable
      real(dp), intent(in) :: h                  !! finite
      type(plain_torques), intent(in) :: g       !! in the frame of the momenta
      type(plain_arrays), intent(in) :: a
      logical, intent(out) :: failed
      integer, intent(out) :: left               !! the first that is left; 0: none
      real(dp) :: y(lanes, 3), p(lanes, 4), q(lanes, 4), torque(lanes, 3)
      integer :: status(lanes), first, m, nvec, l
      left = 0
      call refuse_all(a, failed)
      if (failed) return
      if (associated(a%scale) .or. a%has_moments) then
         call kick_by_lane(class, momentum, h, g, a, failed, left)
         return
      end if
      do l = 1, lanes ! aligned, as in rotate_direct
         q(l, 1) = 0
         p(l, 1) = 0
         torque(l, 1) = 0
      end do
      do first = 1, a%n, lanes
         m = min(lanes, a%n - first + 1)
         nvec = (m + group - 1)/group
         status = poinsot_ok
         call load_torques(g, first, m, nvec, torque)
         call load(a, first, m, nvec, p, q)
         if (momentum == body_momentum) then
            call reject(nvec, 3, [class%limit, 0.0_dp], p, q, status)
         else
            call make_native(class, momentum, a%columns, nvec, p, q, y, status)
         end if
         call reject_torques(nvec, h, torque, status)
         call add_products(nvec, h, torque, p, status)
         call store(a, first, m, nvec, p, q, status, .false., .true., failed)
      end do
   end subroutine kick_direct

end module poinsot_ensemble_direct
