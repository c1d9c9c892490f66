!> Room free: what a kernel does with the lanes of a block, whatever stands beside them.
module test_free_lanes
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, i8, group, groups, lanes
   use poinsot_core_error, only: poinsot_error
   use poinsot_core_status, only: poinsot_ok
   use poinsot_body_class, only: body_class, extend_class
   use poinsot_free_method, only: free_method, advance, advance_lanes
   use test_bodies, only: random_stream, start_stream, uniform
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
         new_unittest("jacobi-keeps-momentum", test_momentum)]
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
               call expect(error, all(abs(z(l, :) - y(l, :)) <= 0) .and. &
                  all(abs(r(l, :) - q(l, :)) <= 0) .and. few(l) == status(l), &
                  trim(method_names(i))//": bits depend on neighbours")
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

   !> |y| after many steps of `jacobi`, plain sums: a random walk, also where every step of a symmetric
   !> body rounds alike.
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

end module test_free_lanes
