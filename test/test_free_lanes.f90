!> Room free: what a kernel does with the lanes of a block, whatever stands beside them.
module test_free_lanes
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, i8, group, groups, lanes
   use poinsot_core_error, only: poinsot_error
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_not_finite, poinsot_e_step
   use poinsot_body_class, only: body_class, extend_class
   use poinsot_free_exact_lanes, only: lane_constants, make_lane_constants, advance_each
   use poinsot_free_limits, only: reject_speed_each
   use poinsot_free_method, only: free_method, advance, advance_lanes
   use test_bodies, only: random_stream, random_body, start_stream, uniform, hard_body, &
      body_kinds, generic_moments
   use test_expectation, only: expect, within
   use test_free_tools, only: method_names, generic, prepare, random_block
   implicit none(type, external)
   private
   public :: collect_free_lanes

   !> h |omega| from far within the short series to beyond what a pass reaches.
   real(dp), parameter :: sizes(6) = [0.02_dp, 0.11_dp, 0.15_dp, 0.45_dp, 0.9_dp, 1.4_dp]

contains

   subroutine collect_free_lanes(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("groups-of-lanes", test_groups), &
         new_unittest("neighbours-far-and-near", test_neighbours), &
         new_unittest("step-of-each-lane", test_lane_steps), &
         new_unittest("long-series-kept-or-not", test_extended), &
         new_unittest("jacobi-keeps-momentum", test_momentum), &
         new_unittest("moments-of-each-any-place", test_any_place), &
         new_unittest("moments-of-each-refused", test_refused), &
         new_unittest("moments-of-each-too-far", test_too_far), &
         new_unittest("moments-of-each-long-run", test_long_run)]
   end subroutine collect_free_lanes

   !> A block of bodies whose h |omega| are of all sizes.
   subroutine mixed_block(stream, y, q)
      type(random_stream), intent(inout) :: stream
      real(dp), intent(out) :: y(lanes, 3), q(lanes, 4)
      integer :: l
      call random_block(stream, y, q)
      do l = 1, lanes
         y(l, :) = y(l, :)*(sizes(1 + int(size(sizes)*uniform(stream)))/norm2(y(l, :)/generic))
      end do
   end subroutine mixed_block

   !> Bits of all lanes up to n are the same in both states.
   pure logical function same(n, y, q, z, r)
      integer, intent(in) :: n
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4), z(lanes, 3), r(lanes, 4)
      same = all(transfer(y(:n, :), [0_i8]) == transfer(z(:n, :), [0_i8])) &
             .and. all(transfer(q(:n, :), [0_i8]) == transfer(r(:n, :), [0_i8]))
   end function same

   !> Few groups of lanes: the bits of the whole block, and nothing behind them is touched.
   subroutine test_groups(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: refusal
      real(dp) :: y0(lanes, 3), q0(lanes, 4), y(lanes, 3), q(lanes, 4), z(lanes, 3), r(lanes, 4)
      real(dp) :: carry(lanes, 7), other(lanes, 7)
      integer :: status(lanes), few(lanes), i, k, n, nvec
      do i = 1, size(method_names)
         call prepare(method_names(i), generic, method, class, refusal)
         stream = start_stream(61)
         call mixed_block(stream, y0, q0)
         do nvec = 1, groups
            n = group*nvec
            do k = 1, 2
               y = y0
               q = q0
               z = y0
               r = q0
               z(n + 1:, :) = huge(1.0_dp)
               r(n + 1:, :) = huge(1.0_dp)
               status = poinsot_ok
               few = poinsot_ok
               carry = 0
               other = 0
               if (k == 1) then
                  call advance(method, class, 0.9_dp, y, q, status)
                  call advance(method, class, 0.9_dp, z, r, few, nvec=nvec)
               else
                  call advance(method, class, 0.9_dp, y, q, status, carry)
                  call advance(method, class, 0.9_dp, z, r, few, other, nvec)
               end if
               call expect(error, same(n, y, q, z, r), trim(method_names(i))//": other bits")
               call expect(error, all(status(:n) == few(:n)), trim(method_names(i))//": statuses")
               call expect(error, all(abs(carry(:n, :) - other(:n, :)) <= 0), "carries")
               call expect(error, all(z(n + 1:, :) >= huge(1.0_dp)) .and. &
                  all(r(n + 1:, :) >= huge(1.0_dp)) .and. all(few(n + 1:) == poinsot_ok), &
                  trim(method_names(i))//" touches lanes that it should not")
            end do
         end do
      end do
   end subroutine test_groups

   !> Lanes of all sizes beside each other, and each among copies of itself: the same bits.
   subroutine test_neighbours(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: refusal
      real(dp) :: y0(lanes, 3), q0(lanes, 4), y(lanes, 3), q(lanes, 4), z(lanes, 3), r(lanes, 4)
      real(dp) :: carry(lanes, 7), other(lanes, 7)
      integer :: status(lanes), few(lanes), i, k, l
      do i = 1, size(method_names)
         call prepare(method_names(i), generic, method, class, refusal)
         stream = start_stream(62)
         call mixed_block(stream, y0, q0)
         do k = 1, 2
            y = y0
            q = q0
            carry = 0
            status = poinsot_ok
            if (k == 1) call advance(method, class, 1.0_dp, y, q, status)
            if (k == 2) call advance(method, class, 1.0_dp, y, q, status, carry)
            do l = 1, lanes
               z = spread(y0(l, :), 1, lanes)
               r = spread(q0(l, :), 1, lanes)
               other = 0
               few = poinsot_ok
               if (k == 1) call advance(method, class, 1.0_dp, z, r, few)
               if (k == 2) call advance(method, class, 1.0_dp, z, r, few, other)
               call expect(error, all(transfer(z(l, :), [0_i8]) == transfer(y(l, :), [0_i8])) &
                  .and. all(transfer(r(l, :), [0_i8]) == transfer(q(l, :), [0_i8])) &
                  .and. few(l) == status(l), trim(method_names(i))//": bits depend on neighbours")
            end do
         end do
      end do
   end subroutine test_neighbours

   !> A step for each lane: the bits of that step for all, and h = 0 keeps a lane.
   subroutine test_lane_steps(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: refusal
      real(dp) :: y0(lanes, 3), q0(lanes, 4), y(lanes, 3), q(lanes, 4), z(lanes, 3), r(lanes, 4)
      real(dp) :: h(lanes)
      integer :: status(lanes), few(lanes), i, k
      real(dp), parameter :: steps(4) = [1.0_dp, -0.3_dp, 0.07_dp, 0.0_dp]
      do i = 1, size(method_names)
         call prepare(method_names(i), generic, method, class, refusal)
         stream = start_stream(63)
         call mixed_block(stream, y0, q0)
         do k = 1, lanes
            h(k) = steps(1 + mod(k, size(steps)))
         end do
         y = y0
         q = q0
         status = poinsot_ok
         call advance_lanes(method, class, h, y, q, status, groups)
         do k = 1, size(steps)
            z = y0
            r = q0
            few = poinsot_ok
            call advance(method, class, steps(k), z, r, few)
            call expect(error, all(pack(abs(y - z), spread(abs(h - steps(k)) <= 0, 2, 3)) <= 0) &
               .and. all(pack(abs(q - r), spread(abs(h - steps(k)) <= 0, 2, 4)) <= 0), &
               trim(method_names(i))//": a lane does not take its own step")
         end do
      end do
   end subroutine test_lane_steps

   !> The long series kept in the class, or worked out at the call.
   subroutine test_extended(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: refusal
      real(dp) :: y(lanes, 3), q(lanes, 4), z(lanes, 3), r(lanes, 4)
      integer :: status(lanes), i
      do i = 1, size(method_names)
         call prepare(method_names(i), generic, method, class, refusal)
         stream = start_stream(64)
         call mixed_block(stream, y, q)
         z = y
         r = q
         status = poinsot_ok
         call advance(method, class, 0.9_dp, y, q, status)
         call extend_class(class, method%terms)
         status = poinsot_ok
         call advance(method, class, 0.9_dp, z, r, status)
         call expect(error, same(lanes, y, q, z, r), trim(method_names(i))//": other bits")
      end do
   end subroutine test_extended

   !> |y| after many steps of `jacobi`, plain sums: a random walk, also where every step of a
   !> symmetric body rounds alike.
   subroutine test_momentum(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: moments(3, 4) = reshape([0.5_dp, 0.5_dp, 0.8_dp, 0.3_dp, 0.8_dp, &
         0.8_dp, 0.5_dp, 0.5000000005_dp, 0.8_dp, 0.376_dp, 0.627_dp, 1.0_dp], [3, 4])
      real(dp), parameter :: steps(2) = [0.05_dp, 0.3_dp]
      integer, parameter :: many = 50000
      type(random_stream) :: stream
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: refusal
      real(dp) :: y(lanes, 3), q(lanes, 4), start(lanes)
      integer :: status(lanes), i, k, l
      do i = 1, size(moments, 2)
         call prepare("jacobi", moments(:, i), method, class, refusal)
         do k = 1, size(steps)
            stream = start_stream(65)
            call random_block(stream, y, q)
            start = norm2(y, 2)
            status = poinsot_ok
            do l = 1, many
               call advance(method, class, steps(k), y, q, status, nvec=1)
            end do
            call within(error, maxval(abs(norm2(y(:group, :), 2)/start(:group) - 1)), 4e-14_dp, &
               "|y|")
         end do
      end do
   end subroutine test_momentum

   !> Moments for each body: the bits of a body in any place, among any others, in any number of
   !> groups, with plain and compensated sums.
   subroutine test_any_place(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(random_body) :: body
      type(lane_constants) :: c, moved
      real(dp) :: m(lanes, 3), h(lanes), y0(lanes, 3), q0(lanes, 4), y(lanes, 3), q(lanes, 4)
      real(dp) :: z(lanes, 3), r(lanes, 4), carry(lanes, 7), other(lanes, 7)
      integer :: status(lanes), few(lanes), i, k, l, shift, n
      logical :: by_jacobi
      stream = start_stream(66)
      do i = 1, 40
         do l = 1, lanes
            call hard_body(stream, body_kinds(1 + int(size(body_kinds)*uniform(stream))), &
               merge(0.15_dp, 4.0_dp, uniform(stream) < 0.7_dp), body)
            m(l, :) = body%moments
            y0(l, :) = body%y
            q0(l, :) = body%q
            h(l) = body%h
         end do
         shift = 1 + mod(5*i, 7)
         n = group*(1 + mod(i, groups))
         do k = 1, 4
            by_jacobi = k > 2
            y = y0
            q = q0
            z = cshift(y0, shift)
            r = cshift(q0, shift)
            status = poinsot_ok
            few = poinsot_ok
            carry = 0
            other = 0
            call make_lane_constants(m, groups, c, status)
            m = cshift(m, shift)
            call make_lane_constants(m, n/group, moved, few)
            m = cshift(m, -shift)
            if (mod(k, 2) == 1) then
               call advance_each(c, by_jacobi, h, 1, y, q, status, groups)
               call advance_each(moved, by_jacobi, cshift(h, shift), 1, z, r, few, n/group)
            else
               call advance_each(c, by_jacobi, h, 1, y, q, status, groups, carry)
               call advance_each(moved, by_jacobi, cshift(h, shift), 1, z, r, few, n/group, other)
            end if
            y = cshift(y, shift)
            q = cshift(q, shift)
            status = cshift(status, shift)
            carry = cshift(carry, shift)
            call expect(error, same(n, y, q, z, r), "bits depend on the place")
            call expect(error, all(status(:n) == few(:n)), "statuses")
            call expect(error, all(abs(carry(:n, :) - other(:n, :)) <= 0), "carries")
         end do
      end do
   end subroutine test_any_place

   !> What no body has is refused, and the lanes beside it do not notice; few digits are taken.
   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(lane_constants) :: c
      real(dp) :: m(lanes, 3), h(lanes), y0(lanes, 3), q0(lanes, 4), y(lanes, 3), q(lanes, 4)
      real(dp) :: limit(lanes, 3), nan
      integer :: status(lanes), l
      logical :: bad(lanes)
      nan = ieee_value(nan, ieee_quiet_nan)
      stream = start_stream(67)
      call random_block(stream, y0, q0)
      do l = 1, lanes
         m(l, :) = generic*10.0_dp**(mod(7*l, 300) - 150)
         h(l) = 0.1_dp*m(l, 1)
      end do
      bad = .false.
      bad([2, 3, 5, 8, 13, 21, 30]) = .true.
      m(2, :) = [1.0_dp, 1.0_dp, 2.1_dp]
      m(3, :) = [nan, 1.0_dp, 1.0_dp]
      m(5, :) = [1.0_dp, -1.0_dp, 1.0_dp]
      m(8, :) = 0
      m(13, :) = [0.0_dp, 1.0_dp, 2.0_dp]
      m(21, :) = [1.0_dp, 1.0_dp, 1e-310_dp]
      m(30, :) = [1.0_dp, huge(1.0_dp), 1.0_dp]
      m(4, :) = [1.022_dp, 1.920_dp, 2.9421_dp]
      m(6, :) = [0.0_dp, 1.0_dp, 1.000008_dp]
      y0(6, 1) = 0
      h([2, 3, 4, 5, 6, 8, 13, 21, 30]) = 0.1_dp
      status = poinsot_ok
      call make_lane_constants(m, groups, c, status)
      call expect(error, all((status == poinsot_e_domain .or. status == poinsot_e_not_finite) &
         .eqv. bad) .and. all((status == poinsot_e_not_finite) .eqv. [(l == 3, l=1, lanes)]), &
         "what is refused, and why")
      y = y0
      q = q0
      call advance_each(c, .false., h, 1, y, q, status, groups)
      call expect(error, all((status == poinsot_e_domain .or. status == poinsot_e_not_finite) &
         .eqv. bad) .and. all(status == poinsot_ok .or. bad), "other statuses")
      do l = 1, lanes
         if (bad(l)) call expect(error, all(abs(y(l, :) - y0(l, :)) <= 0) .and. &
            all(abs(q(l, :) - q0(l, :)) <= 0), "a refused body moves")
         call within(error, norm2(y(l, :))/norm2(y0(l, :)) - 1, 1e-15_dp, "|y|")
         call within(error, norm2(q(l, :)) - 1, 1e-15_dp, "|q|")
         call expect(error, bad(l) .or. any(abs(q(l, :) - q0(l, :)) > 1e-3_dp), "stands still")
      end do
      ! momenta that no body may have: too fast, and none
      do l = 1, lanes
         y(l, :) = 0
         if (.not. bad(l)) y(l, :) = y0(l, :)*maxval(m(l, :))
      end do
      y(6, 1) = 0
      y(7, 2) = 1e80_dp*m(7, 2)
      y(9, 1) = nan
      status = poinsot_ok
      where (bad) status = poinsot_e_domain
      limit = 1
      do l = 1, lanes
         if (.not. bad(l)) limit(l, :) = 1e70_dp*m(l, :)
      end do
      call reject_speed_each(limit, y, status, groups)
      call expect(error, status(7) == poinsot_e_domain .and. status(9) == poinsot_e_domain &
         .and. all(abs(y([7, 9], :)) <= 0), "a speed beyond 1e70, a momentum that is no number")
      call expect(error, count(status == poinsot_ok) == lanes - count(bad) - 2, "others refused")
      y = y0
      ! a step that no double holds
      h = 1e300_dp
      status = poinsot_ok
      m = spread(generic, 1, lanes)
      call make_lane_constants(m, groups, c, status)
      call advance_each(c, .false., h, 1, y, q, status, groups)
      call expect(error, all(status == poinsot_e_step), "far too long a step")
   end subroutine test_refused

   !> h y/I from 1e16 to where a double ends, split over h, y and I in every way: refused, and the
   !> state kept, without a square that overflows. Beside each such body one that turns as it would
   !> alone.
   subroutine test_too_far(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: powers(12) = [54, 100, 228, 229, 230, 231, 232, 233, 255, 256, 511, 900]
      type(random_stream) :: stream
      type(lane_constants) :: c
      real(dp), dimension(lanes, 3) :: m, y, y0, alone
      real(dp), dimension(lanes, 4) :: q, q0, alone_q
      real(dp) :: h(lanes), carry(lanes, 7)
      integer :: status(lanes), i, k, l, way
      stream = start_stream(69)
      do k = 1, size(powers)
         do way = 0, 3
            call random_block(stream, y0, q0)
            m = spread(generic, 1, lanes)
            h = 0.05_dp
            call turn(.false., y0, q0, alone, alone_q)
            do l = 1, lanes, 2
               i = mod(l/2, 3)
               if (powers(k) > 700) i = 3 ! a bit of each
               h(l) = scale(1.99_dp, merge(powers(k), merge(powers(k)/3, 0, i == 3), i == 0))
               y0(l, :) = scale(1.99_dp, merge(powers(k), merge(powers(k)/3, 0, i == 3), i == 1))
               m(l, :) = scale(m(l, :), -merge(powers(k), merge(powers(k)/3, 0, i == 3), i == 2))
            end do
            call turn(way > 1, y0, q0, y, q)
            call expect(error, all(status(1::2) == poinsot_e_step) .and. &
               all(status(2::2) == poinsot_ok), "statuses of steps too far")
            call expect(error, all(y(1::2, :) == y0(1::2, :)) .and. &
               all(q(1::2, :) == q0(1::2, :)), "states of bodies that turn too far")
            call expect(error, way > 0 .or. (all(y(2::2, :) == alone(2::2, :)) .and. &
               all(q(2::2, :) == alone_q(2::2, :))), "their neighbours")
            if (allocated(error)) return
         end do
      end do

   contains

      subroutine turn(by_jacobi, from_y, from_q, y, q)
         logical, intent(in) :: by_jacobi
         real(dp), intent(in) :: from_y(lanes, 3), from_q(lanes, 4)
         real(dp), intent(out) :: y(lanes, 3), q(lanes, 4)
         y = from_y
         q = from_q
         carry = 0
         status = poinsot_ok
         call make_lane_constants(m, groups, c, status)
         if (mod(way, 2) == 0) call advance_each(c, by_jacobi, h, 5, y, q, status, groups)
         if (mod(way, 2) == 1) call advance_each(c, by_jacobi, h, 5, y, q, status, groups, carry)
      end subroutine turn

   end subroutine test_too_far

   !> Many steps: |y|, energy and |q| with plain and with compensated sums.
   subroutine test_long_run(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: many = 20000
      type(random_stream) :: stream
      type(lane_constants) :: c
      real(dp) :: m(lanes, 3), h(lanes), y0(lanes, 3), y(lanes, 3), q(lanes, 4), carry(lanes, 7)
      real(dp) :: before, after
      integer :: status(lanes), k, l
      stream = start_stream(68)
      do k = 1, 2
         call random_block(stream, y0, q)
         do l = 1, lanes
            m(l, :) = generic_moments(stream)
            h(l) = 0.08_dp/norm2(y0(l, :)/m(l, :))
         end do
         y = y0
         status = poinsot_ok
         carry = 0
         call make_lane_constants(m, 1, c, status)
         do l = 1, many
            if (k == 1) call advance_each(c, .false., h, 1, y, q, status, 1)
            if (k == 2) call advance_each(c, .false., h, 1, y, q, status, 1, carry)
         end do
         do l = 1, group
            before = sum(y0(l, :)**2/m(l, :))
            after = sum(y(l, :)**2/m(l, :))
            call within(error, after/before - 1, merge(4e-14_dp, 2e-15_dp, k == 1), "energy")
            call within(error, norm2(y(l, :))/norm2(y0(l, :)) - 1, &
               merge(2e-14_dp, 1e-15_dp, k == 1), "|y|")
            call within(error, norm2(q(l, :)) - 1, 5e-16_dp, "|q|")
         end do
      end do
   end subroutine test_long_run

end module test_free_lanes
