!> Loads the caller's bodies into a block and stores them back: `lanes` bodies of one class,
!> checked, in native variables.
!>
!> A lane that is refused (not finite, not a unit quaternion, momentum about an axis without
!> inertia) gets a status and is at rest in the block, so that it can do no harm; it is never
!> written back.
module poinsot_ensemble_block
   use, intrinsic :: iso_c_binding, only: c_int
   use poinsot_core_constants, only: exponent_bits
   use poinsot_core_kinds, only: dp, i8, group, groups, lanes
   use poinsot_core_lanes, only: any_failed
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_not_finite, &
      poinsot_e_not_unit, poinsot_e_axis_momentum
   use poinsot_body_class, only: body_class, rotor_at
   use poinsot_ensemble_bodies, only: body_view
   use poinsot_free_lane_moments, only: lane_moments, common_limit, complete_moments, &
      take_moments, take_scale
   use poinsot_free_limits, only: reject_speed, reject_speed_each
   use poinsot_ensemble_layout, only: body_momentum, conjugate_momentum, to_native, from_native
   use poinsot_ensemble_transfer, only: arrays, find_layout, copy_in, copy_out
   use poinsot_splitting_block_flows, only: block_flows
   implicit none(type, external)
   private
   public :: clock, host_arrays, open_host, reject, reject_by_lane, load_block, store_block, &
      store_status, &
      add_momentum, reject_values, reject_torques, add_products, reject_energies

   !> A time, and whence rotors that jump there are seen (rotor_at).
   type :: clock
      real(dp) :: t = 0
      real(dp) :: ahead = 0
   end type clock

   !> The caller's arrays during one call.
   type :: host_arrays
      type(body_view), pointer :: view => null()
      type(arrays) :: y, q
      integer :: momentum = body_momentum          !! the momentum variable
      logical :: principal = .false.               !! the arrays are in principal frames, whatever
                                                   !! frame a class was given in
      logical :: has_by_lane = .false.                 !! bodies have moments of their own
      logical :: wants_id = .false.                !! random numbers are drawn by body
      type(clock) :: loaded, stored                !! when velocities are read and written
   end type host_arrays

   real(dp), parameter :: norm_slack = 2e-6_dp   !! of |q|^2: |q| within 1e-6 of 1
   real(dp), parameter :: carry_slack = 1e-6_dp  !! of an attitude's carry
   real(dp), parameter :: axis_slack = 1e-6_dp   !! momentum about a zero moment, relative to |y|
   real(dp), parameter :: axis_rounding = 1e-14_dp !! of that, what turning there and back leaves

   integer(i8), parameter :: two = transfer(2.0_dp, 1_i8)

contains

   !> Look at the caller's arrays, once per call.
   subroutine open_host(view, momentum, principal, host)
      type(body_view), intent(in), target :: view  !! it must outlive `host`
      integer, intent(in) :: momentum              !! the caller's momentum variable
      logical, intent(in) :: principal             !! in principal frames
      type(host_arrays), intent(out) :: host
      host%view => view
      host%momentum = momentum
      host%principal = principal
      call find_layout(view%y, merge(4, 3, momentum == conjugate_momentum), host%y)
      call find_layout(view%q, 4, host%q)
      host%y%scattered = associated(view%y_at)
      host%q%scattered = associated(view%q_at)
      host%has_by_lane = associated(view%scale) .or. associated(view%moments(1)%of)
   end subroutine open_host

   !> The momentum of a class's rotors at a time.
   pure function rotor_then(class, when) result(rotor)
      type(body_class), intent(in) :: class
      type(clock), intent(in) :: when
      real(dp) :: rotor(3)
      rotor = class%rotor
      if (allocated(class%rotor_tables)) rotor = rotor_at(class, when%t, when%ahead)
   end function rotor_then

   !> Fill a block with n bodies of one class and check them.
   subroutine load_block(host, at, n, number, class, by_lane, b)
      type(host_arrays), intent(in) :: host
      integer, intent(in) :: n                     !! bodies, 1 to lanes
      integer, intent(in) :: at(n)                 !! their places
      integer, intent(in) :: number                !! their class
      type(body_class), intent(in), target :: class
      type(lane_moments), intent(inout), target :: by_lane !! room for moments of the bodies' own
      type(block_flows), intent(inout) :: b
      real(dp) :: p(lanes, 4)

      b%n = n
      b%nvec = (n + group - 1)/group
      b%number = number
      b%class => class
      b%at(1:n) = at
      b%status = poinsot_ok
      b%stored = .false.
      b%drops = .false.
      nullify (b%by_lane)
      if (n < lanes) call rest(n + 1, lanes, b%y, b%q)
      call take(host%q, host%view%q_at, at, n, b%q)
      if (host%has_by_lane) then
         call load_by_lane(host, at, by_lane, b)
      else if (host%momentum == body_momentum .and. .not. is_turned(host, class)) then
         call take(host%y, host%view%y_at, at, n, b%y)
         call reject(b%nvec, 3, [class%limit, 0.0_dp], b%y, b%q, b%status)
      else
         if (n < lanes) p = 0
         p(:, 4) = 0
         call take(host%y, host%view%y_at, at, n, p)
         call reject(b%nvec, 4, [huge(p), huge(p), huge(p), huge(p)], p, b%q, b%status)
         call to_native(host%momentum, is_turned(host, class), class, &
            rotor_then(class, host%loaded), p, b%y, b%q)
         call reject_speed(class, b%y, b%status)
      end if
      if (class%sorted(1) <= 0 .and. .not. host%has_by_lane) then
         call reject_axis_momentum(spread(class%inverse, 1, lanes), b)
      end if
      if (host%wants_id) call load_id(host%view, b)
      b%compensated = associated(host%view%carry)
      if (b%compensated) call load_carry(host%view, b)
   end subroutine load_block

   !> Bodies with moments of their own.
   subroutine load_by_lane(host, at, by_lane, b)
      type(host_arrays), intent(in) :: host
      integer, intent(in) :: at(:)                 !! places of the bodies
      type(lane_moments), intent(inout), target :: by_lane
      type(block_flows), intent(inout) :: b
      real(dp) :: p(lanes, 4)
      integer :: j, l
      if (associated(host%view%scale)) then
         by_lane%scale = 1
         do l = 1, b%n
            by_lane%scale(l) = host%view%scale(at(l))
         end do
         call take_scale(b%class, groups, by_lane, b%status)
      else
         by_lane%scale = 1
         by_lane%moments = 1
         do j = 1, 3
            do l = 1, b%n
               by_lane%moments(l, j) = host%view%moments(j)%of(at(l))
            end do
         end do
         call take_moments(groups, by_lane, b%status)
      end if
      call complete_moments(b%class, groups, by_lane)
      b%by_lane => by_lane
      p = 0
      call take(host%y, host%view%y_at, at, b%n, p)
      call reject(b%nvec, 4, [huge(p), huge(p), huge(p), huge(p)], p, b%q, b%status)
      do l = 1, b%n
         if (b%status(l) == poinsot_ok) cycle
         p(l, :) = 0
         call rest(l, l, p, b%q)
      end do
      call to_native(host%momentum, is_turned(host, b%class), b%class, &
         rotor_then(b%class, host%loaded), p, b%y, b%q, by_lane)
      call reject_speed_each(by_lane%limit, b%y, b%status, b%nvec)
      if (by_lane%linear) call reject_axis_momentum(by_lane%inverse, b)
   end subroutine load_by_lane

   !> Bodies at n places into a block: the rows of the array are their places, or what the caller
   !> says.
   subroutine take(a, rows, at, n, into)
      type(arrays), intent(in) :: a
      integer(c_int), pointer, intent(in) :: rows(:)   !! from 0; not associated: body i is row i
      integer, intent(in) :: n, at(n)
      real(dp), intent(inout) :: into(lanes, *)
      integer :: row(lanes), l
      if (.not. associated(rows)) then
         call copy_in(a, at, n, into)
      else
         do l = 1, n
            row(l) = rows(at(l)) + 1
         end do
         call copy_in(a, row, n, into)
      end if
   end subroutine take

   !> The inverse.
   subroutine give(a, rows, at, n, from)
      type(arrays), intent(inout) :: a
      integer(c_int), pointer, intent(in) :: rows(:)
      integer, intent(in) :: n, at(n)
      real(dp), intent(in) :: from(lanes, *)
      integer :: row(lanes), l
      if (.not. associated(rows)) then
         call copy_out(a, at, n, from)
      else
         do l = 1, n
            row(l) = rows(at(l)) + 1
         end do
         call copy_out(a, row, n, from)
      end if
   end subroutine give

   !> Do the caller's arrays have another body frame than the principal one?
   pure logical function is_turned(host, class)
      type(host_arrays), intent(in) :: host
      type(body_class), intent(in) :: class
      is_turned = class%turned .and. .not. host%principal
   end function is_turned

   !> Numbers for random streams: the caller's, or the place of each body.
   pure subroutine load_id(view, b)
      type(body_view), intent(in) :: view
      type(block_flows), intent(inout) :: b
      integer :: l
      b%id(b%n + 1:) = 0
      if (associated(view%id)) then
         do l = 1, b%n
            b%id(l) = view%id(b%at(l))
         end do
      else
         do l = 1, b%n
            b%id(l) = b%at(l) - 1
         end do
      end if
   end subroutine load_id

   pure subroutine load_carry(view, b)
      type(body_view), intent(in) :: view
      type(block_flows), intent(inout) :: b
      integer :: l
      b%carry = 0
      do l = 1, b%n
         b%carry(l, :) = view%carry(:, b%at(l))
      end do
      call reject_carry(b)
   end subroutine load_carry

   !> A carry is what rounding left over. One that is not finite, or larger than that could be, is
   !> no carry.
   pure subroutine reject_carry(b)
      type(block_flows), intent(inout) :: b
      integer :: l
      do l = 1, b%n
         if (maxval(magnitude(b%carry(l, :))) >= exponent_bits) then
            b%status(l) = poinsot_e_not_finite
         else if (maxval(abs(b%carry(l, 4:7))) <= carry_slack) then
            cycle
         else
            b%status(l) = poinsot_e_domain
         end if
         b%carry(l, :) = 0
      end do
   end subroutine reject_carry

   !> Lanes first to last at rest.
   pure subroutine rest(first, last, y, q)
      integer, intent(in) :: first, last
      real(dp), intent(inout) :: y(lanes, *), q(lanes, 4)
      integer :: j
      do j = 1, 3
         y(first:last, j) = 0
         q(first:last, j + 1) = 0
      end do
      q(first:last, 1) = 1
   end subroutine rest

   !> Put lanes at rest whose momenta are not finite or beyond a limit, or whose quaternion is not
   !> of unit norm.
   pure subroutine reject(nvec, columns, limit, p, q, status)
      integer, intent(in) :: nvec                   !! groups of lanes that hold bodies
      integer, intent(in) :: columns                !! of p, 3 or 4
      real(dp), intent(in) :: limit(4)
      real(dp), intent(inout) :: p(lanes, columns), q(lanes, 4)
      integer, intent(inout) :: status(lanes)
      integer :: l
      if (are_good(nvec, columns, limit, p, q)) return
      do l = 1, group*nvec
         if (excess(p(l, :), limit(:columns), q(l, :)) <= 0) cycle
         status(l) = cause(p(l, :), q(l, :))
         p(l, :) = 0
         call rest(l, l, p, q)
      end do
   end subroutine reject

   !> The same of momenta y of bodies with moments of their own; and lanes that these have failed.
   pure subroutine reject_by_lane(class, nvec, by_lane, y, q, status)
      type(body_class), intent(in) :: class         !! of these bodies
      integer, intent(in) :: nvec
      type(lane_moments), intent(inout) :: by_lane
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      integer, intent(inout) :: status(lanes)
      real(dp) :: limit
      integer :: l
      limit = common_limit(by_lane)
      if (are_good(nvec, 3, [limit, limit, limit, limit], y, q) .and. &
          .not. any_failed(status, nvec)) return
      call complete_moments(class, nvec, by_lane)
      do l = 1, group*nvec
         if (excess(y(l, :), by_lane%limit(l, :), q(l, :)) > 0) then
            status(l) = cause(y(l, :), q(l, :))
         else if (status(l) == poinsot_ok) then
            cycle
         end if
         call rest(l, l, y, q)
      end do
   end subroutine reject_by_lane

   !> Is no lane of this kind? Bits are compared: a comparison with a NaN would raise an exception
   !> in hosts that trap. A component of q above 2 counts as 2, so that its square is a number.
   pure logical function are_good(nvec, columns, limit, p, q)
      integer, intent(in) :: nvec, columns
      real(dp), intent(in) :: limit(4), p(lanes, columns), q(lanes, 4)
      integer(i8) :: top(4), slack, most
      integer :: l
      top = magnitude(limit)
      slack = magnitude(norm_slack)
      most = 0
      !GCC$ ivdep
      do l = 1, group*nvec
         most = max(most, magnitude(p(l, 1)) - top(1), magnitude(p(l, 2)) - top(2), &
                    magnitude(p(l, 3)) - top(3), magnitude(p(l, columns)) - top(columns), &
                    magnitude(square(q(l, 1)) + square(q(l, 2)) + square(q(l, 3)) &
                              + square(q(l, 4)) - 1) - slack)
      end do
      are_good = most <= 0
   end function are_good

   !> How far one lane is beyond what is allowed, in bits; not above 0 if it is not.
   pure integer(i8) function excess(p, limit, q)
      real(dp), intent(in) :: p(:), limit(:), q(4)
      excess = max(maxval(magnitude(p) - magnitude(limit)), &
                   magnitude(square(q(1)) + square(q(2)) + square(q(3)) + square(q(4)) - 1) &
                   - magnitude(norm_slack))
   end function excess

   !> Why a lane was refused: the first cause.
   pure integer function cause(p, q)
      real(dp), intent(in) :: p(:), q(4)
      cause = poinsot_e_domain
      if (max(maxval(magnitude(p)), maxval(magnitude(q))) >= exponent_bits) then
         cause = poinsot_e_not_finite
      else if (abs(sum(square(q)) - 1) > norm_slack) then
         cause = poinsot_e_not_unit
      end if
   end function cause

   !> Bits of |x|: they compare like the numbers, and infinite and NaN are at the top.
   elemental integer(i8) function magnitude(x)
      real(dp), intent(in) :: x
      magnitude = iand(transfer(x, 1_i8), huge(1_i8))
   end function magnitude

   !> x^2, of anything above 2 that of 2.
   elemental real(dp) function square(x)
      real(dp), intent(in) :: x
      square = transfer(min(magnitude(x), two), x)**2
   end function square

   !> Numbers that come with the bodies, a torque for instance: a lane where they are not finite
   !> fails, and gets zeros.
   pure subroutine reject_values(b, values)
      type(block_flows), intent(inout) :: b
      real(dp), intent(inout) :: values(:, :)   !! (lanes, components)
      integer :: l, j
      do j = 1, size(values, 2)
         do l = 1, lanes
            if (iand(transfer(values(l, j), 1_i8), exponent_bits) /= exponent_bits) cycle
            b%status(l) = poinsot_e_not_finite
            values(l, :) = 0
         end do
      end do
   end subroutine reject_values

   !> Torques that are not finite, or whose product with the step would leave the range of numbers:
   !> their bodies fail, and get none.
   pure subroutine reject_torques(nvec, h, torque, status)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: h
      real(dp), intent(inout) :: torque(lanes, 3)
      integer, intent(inout) :: status(lanes)
      integer(i8) :: strongest, most
      integer :: l
      strongest = magnitude(0.0625_dp*huge(h)/max(1.0_dp, abs(h)))
      most = 0
      !GCC$ ivdep
      do l = 1, group*nvec
         most = max(most, magnitude(torque(l, 1)), magnitude(torque(l, 2)), magnitude(torque(l, 3)))
      end do
      if (most <= strongest) return
      do l = 1, group*nvec
         if (maxval(magnitude(torque(l, :))) <= strongest) cycle
         status(l) = merge(poinsot_e_not_finite, poinsot_e_domain, &
            maxval(magnitude(torque(l, :))) >= exponent_bits)
         torque(l, :) = 0
      end do
   end subroutine reject_torques

   !> y += h g, the product rounded before it is added: as add_momentum has it. A sum that is not
   !> finite fails its body.
   pure subroutine add_products(nvec, h, g, y, status)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: h
      real(dp), intent(inout) :: g(lanes, 3)
      real(dp), intent(inout) :: y(lanes, 3)
      integer, intent(inout) :: status(lanes)
      integer(i8) :: most
      integer :: l
      g(:group*nvec, :) = h*g(:group*nvec, :)
      most = 0
      !GCC$ ivdep
      do l = 1, group*nvec
         y(l, 1) = y(l, 1) + g(l, 1)
         y(l, 2) = y(l, 2) + g(l, 2)
         y(l, 3) = y(l, 3) + g(l, 3)
         most = max(most, magnitude(y(l, 1)), magnitude(y(l, 2)), magnitude(y(l, 3)))
      end do
      if (most < exponent_bits) return
      do l = 1, group*nvec
         if (maxval(magnitude(y(l, :))) < exponent_bits) cycle
         if (status(l) == poinsot_ok) status(l) = poinsot_e_domain
      end do
   end subroutine add_products

   !> An energy beyond the range of numbers is no energy: the body fails.
   pure subroutine reject_energies(kinetic, potential, b)
      real(dp), intent(in) :: kinetic(lanes), potential(lanes)
      type(block_flows), intent(inout) :: b
      integer(i8) :: sizes(lanes)
      integer :: l
      sizes = max(magnitude(kinetic), magnitude(potential))
      if (maxval(sizes) < exponent_bits) return
      do l = 1, b%n
         if (sizes(l) >= exponent_bits .and. &
            b%status(l) == poinsot_ok) b%status(l) = poinsot_e_domain
      end do
   end subroutine reject_energies

   !> Momentum about an axis without inertia is refused; what few digits and rounding leave there is
   !> dropped, in the caller's array too unless turning there and back would leave as much again.
   pure subroutine reject_axis_momentum(inverse, b)
      real(dp), intent(in) :: inverse(lanes, 3) !! moments; 0: no inertia
      type(block_flows), intent(inout) :: b
      real(dp) :: length
      integer :: j, l
      b%dropped = .false.
      do j = 1, 3
         do l = 1, b%n
            if (inverse(l, j) > 0) cycle
            length = norm2(b%y(l, :))
            if (abs(b%y(l, j)) > axis_slack*length) then
               if (b%status(l) == poinsot_ok) b%status(l) = poinsot_e_axis_momentum
               b%y(l, :) = 0
            else if (abs(b%y(l, j)) > axis_rounding*length) then
               b%dropped(l) = .true.
               b%drops = .true.
            end if
            b%y(l, j) = 0
         end do
      end do
   end subroutine reject_axis_momentum

   !> Write back the bodies that did not fail, and every status. `keep_momentum`: a variable that
   !> free motion does not change (space-frame momentum) is left as it is, to the bit; so is
   !> `keep_attitude` by a kick.
   subroutine store_block(host, keep_momentum, keep_attitude, b)
      type(host_arrays), intent(inout) :: host
      logical, intent(in) :: keep_momentum, keep_attitude
      type(block_flows), intent(inout) :: b
      real(dp) :: p(lanes, 4)
      integer :: l, n, at(lanes)

      call store_status(host%view, b)
      if (b%stored) return
      if (keep_momentum .and. b%drops) call store_dropped(host, p, b)
      n = b%n
      if (host%momentum == body_momentum .and. &
          .not. (is_turned(host, b%class) .or. any_failed(b%status))) then
         if (.not. keep_momentum) call give(host%y, host%view%y_at, b%at, n, b%y)
         if (.not. keep_attitude) call give(host%q, host%view%q_at, b%at, n, b%q)
      else
         call from_native(host%momentum, is_turned(host, b%class), b%class, &
            rotor_then(b%class, host%stored), b%y, b%q, p, b%by_lane)
         at(:n) = b%at(:n)
         if (any_failed(b%status)) call pack_lanes(b, p, at, n)
         if (n > 0 .and. .not. keep_momentum) call give(host%y, host%view%y_at, at, n, p)
         if (n > 0 .and. .not. keep_attitude) call give(host%q, host%view%q_at, at, n, b%q)
      end if
      if (.not. b%compensated) return
      do l = 1, b%n
         if (b%status(l) == poinsot_ok) host%view%carry(:, b%at(l)) = b%carry(l, :)
      end do
   end subroutine store_block

   !> Momenta that would have been kept, of lanes where a part about an axis without inertia was
   !> dropped.
   subroutine store_dropped(host, p, b)
      type(host_arrays), intent(inout) :: host
      type(block_flows), intent(in) :: b
      real(dp), intent(out) :: p(lanes, 4)       !! work space
      real(dp) :: q(lanes, 4)
      integer :: l
      q = b%q
      call from_native(host%momentum, is_turned(host, b%class), b%class, &
         rotor_then(b%class, host%stored), b%y, q, p, b%by_lane)
      do l = 1, b%n
         if (.not. b%dropped(l) .or. b%status(l) /= poinsot_ok) cycle
         p(1, :) = p(l, :)
         call give(host%y, host%view%y_at, b%at(l:l), 1, p)
      end do
   end subroutine store_dropped

   !> Every status into the caller's array, if there is one.
   subroutine store_status(view, b)
      type(body_view), intent(in) :: view
      type(block_flows), intent(in) :: b
      integer :: l
      if (.not. associated(view%status)) return
      do l = 1, b%n
         view%status(b%at(l)) = b%status(l)
      end do
   end subroutine store_status

   !> Move the lanes that did not fail to the front.
   pure subroutine pack_lanes(b, p, at, n)
      type(block_flows), intent(inout) :: b
      real(dp), intent(inout) :: p(lanes, 4)
      integer, intent(out) :: at(lanes), n
      integer :: l, from(lanes)
      n = 0
      at = 1
      from = 1
      do l = 1, b%n
         if (b%status(l) /= poinsot_ok) cycle
         n = n + 1
         at(n) = b%at(l)
         from(n) = l
      end do
      if (n == b%n) return
      p(1:n, :) = p(from(1:n), :)
      b%q(1:n, :) = b%q(from(1:n), :)
   end subroutine pack_lanes

   !> A kick in the caller's own variable: no turning there and back, no rounding but that of the
   !> sum. A sum that is not finite is not stored: the body fails.
   subroutine add_momentum(view, add, b)
      type(body_view), intent(in) :: view
      real(dp), intent(in) :: add(lanes, 3)     !! in the caller's variable and frame
      type(block_flows), intent(inout) :: b
      real(dp) :: total(3)
      integer :: j, l, row
      b%stored = .true.
      do l = 1, b%n
         if (b%status(l) /= poinsot_ok) cycle
         row = b%at(l)
         if (associated(view%y_at)) row = view%y_at(row) + 1
         do j = 1, 3
            total(j) = view%y(j)%of(row) + add(l, j)
         end do
         if (maxval(magnitude(total)) >= exponent_bits) then
            b%status(l) = poinsot_e_domain
            cycle
         end if
         do j = 1, 3
            view%y(j)%of(row) = total(j)
         end do
      end do
   end subroutine add_momentum

end module poinsot_ensemble_block
