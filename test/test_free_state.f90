!> Room free: symmetries, bits, refusals, and what a long run keeps.
module test_free_state
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use, intrinsic :: ieee_exceptions, only: ieee_get_flag, ieee_set_flag, ieee_invalid, &
      ieee_overflow, ieee_divide_by_zero, ieee_set_halting_mode, ieee_get_halting_mode
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, qp, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_step, &
      poinsot_e_convergence
   use poinsot_body_class, only: body_class, make_class
   use poinsot_free_method, only: free_method, advance
   use test_bodies, only: random_body, random_stream, start_stream, hard_body, &
      body_kinds, permute_body
   use test_expectation, only: expect
   use test_free_tools, only: method_names, approximate_count, generic, start, start_q, turn_body, &
      prepare, rest_block, random_block, text
   use test_measure, only: attitude_distance, momentum_distance
   use test_oracle_dmv, only: reference_map, make_reference
   use test_oracle_taylor, only: taylor_report, taylor_flow, free_problem
   implicit none(type, external)
   private
   public :: collect_free_state

contains

   !> Tests of how state is treated.
   subroutine collect_free_state(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("symmetric-exact", test_symmetric), &
         new_unittest("reversal", test_reversal), &
         new_unittest("permutations", test_permutations), &
         new_unittest("powers-of-two", test_scaling), &
         new_unittest("lanes", test_lanes), &
         new_unittest("class-and-padding", test_padding), &
         new_unittest("steps", test_steps), &
         new_unittest("refuses-long-step", test_long_step), &
         new_unittest("refuses-bad-moments", test_bad_moments), &
         new_unittest("extreme-steps", test_extreme_steps), &
         new_unittest("frozen-lanes", test_frozen), &
         new_unittest("no-exceptions", test_exceptions), &
         new_unittest("drift", test_drift)]
   end subroutine collect_free_state

   ! Symmetries
   ! --------------------------------------------------------------------------------------

   !> symmetric-rotation is exact for any two equal moments.
   subroutine test_symmetric(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: moments(3, 4) = reshape([0.7_dp, 0.7_dp, 1.1_dp, 1.1_dp, 0.7_dp, &
         0.7_dp, &
         0.7_dp, 1.1_dp, 0.7_dp, 0.9_dp, 0.9_dp, 0.9_dp], [3, 4])
      type(taylor_report) :: report
      real(qp) :: yt(3), qt(4)
      real(dp) :: y(3), q(4)
      integer :: k, status
      do k = 1, 4
         y = start
         q = [0.5_dp, -0.5_dp, 0.5_dp, 0.5_dp]
         yt = y
         qt = q
         call turn_body("symmetric-rotation", moments(:, k), -1.1_dp, 1, y, q, status)
         call taylor_flow(free_problem(moments(:, k)), -1.1_qp, yt, qt, report)
         call expect(error, momentum_distance(real(y, qp), yt) + attitude_distance(real(q, qp), &
            qt) < 2.0e-15_dp, &
            "not exact for two equal moments: "//text(momentum_distance(real(y, qp), yt))//", "// &
            text(attitude_distance(real(q, qp), qt)))
      end do
   end subroutine test_symmetric

   !> h, then -h: every method comes back; and -h from y is h from -y.
   subroutine test_reversal(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(random_body) :: body
      real(dp) :: y(3), q(4), z(3), r(4), gap
      integer :: i, k, status(4)
      do i = 1, approximate_count + 1
         stream = start_stream(23)
         do k = 1, 12
            call hard_body(stream, merge("generic     ", "flat        ", k > 4), 0.9_dp, body)
            y = body%y
            q = body%q
            call turn_body(method_names(i), body%moments, body%h, 1, y, q, status(1))
            z = y
            r = q
            call turn_body(method_names(i), body%moments, -body%h, 1, z, r, status(2))
            gap = momentum_distance(z, body%y) + attitude_distance(r, body%q)
            z = -body%y
            r = body%q
            call turn_body(method_names(i), body%moments, -body%h, 1, z, r, status(3))
            call expect(error, all(status(1:3) == poinsot_ok), "status of "//method_names(i))
            call expect(error, gap < 3.0e-15_dp, &
                       trim(method_names(i))//" does not come back: "// text(gap))
            call expect(error, all(z == -y) .and. all(r == q), &
               trim(method_names(i))//": turning y and h together changes bits")
         end do
      end do
   end subroutine test_reversal

   !> Other labels of the axes, same motion. three-rotations names its axes, so it is left out;
   !> symmetric-rotation tells the two axes of its pair apart by the cyclic order.
   subroutine test_permutations(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: p(3, 5) = reshape([2, 3, 1, 3, 1, 2, 2, 1, 3, 3, 2, 1, 1, 3, 2], [3, 5])
      type(random_body) :: body, other
      real(dp) :: gap
      integer :: i, k, status
      do i = 2, approximate_count + 1
         do k = 1, merge(2, 5, i == 2)
            body%moments = generic
            body%y = start
            body%q = [0.1_dp, 0.7_dp, -0.5_dp, 0.5_dp]
            other = body
            call permute_body(p(:, k), other)
            call turn_body(method_names(i), body%moments, 0.8_dp, 1, body%y, body%q, status)
            call turn_body(method_names(i), other%moments, 0.8_dp, 1, other%y, other%q, status)
            call permute_body(p(:, k), body)
            gap = momentum_distance(body%y, other%y) + attitude_distance(body%q, other%q)
            call expect(error, gap < 2.0e-15_dp, trim(method_names(i))// &
               " depends on the labels: "//text(gap))
         end do
      end do
   end subroutine test_permutations

   !> Other units, powers of two: the same bits.
   subroutine test_scaling(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: mass(4) = [-150, 40, 300, -3], rate(4) = [0, 30, -60, 45]
      type(random_stream) :: stream
      type(random_body) :: body
      real(dp) :: y(3), q(4), z(3), r(4)
      integer :: i, k, status(2)
      do i = 1, size(method_names)
         stream = start_stream(29)
         do k = 1, 24
            call hard_body(stream, merge("generic     ", "flat        ", k > 8), 0.9_dp, body)
            associate (m => mass(1 + mod(k, 4)), w => rate(1 + mod(k, 4)))
               y = body%y
               q = body%q
               z = scale(body%y, m + w)
               r = body%q
               call turn_body(method_names(i), body%moments, body%h, 1, y, q, status(1))
               call turn_body(method_names(i), scale(body%moments, m), scale(body%h, -w), 1, &
                              z, r, status(2))
               call expect(error, status(1) == status(2), trim(method_names(i))// &
                  ": status depends on the units")
               call expect(error, all(z == scale(y, m + w)) .and. all(r == q), &
                  trim(method_names(i))//": bits depend on the units")
            end associate
         end do
      end do
   end subroutine test_scaling

   ! Bits
   ! --------------------------------------------------------------------------------------------

   !> A body's bits do not depend on its place in the block, nor on its neighbours.
   subroutine test_lanes(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      real(dp) :: y0(lanes, 3), q0(lanes, 4), y(lanes, 3), q(lanes, 4), z(3), r(4), h
      real(dp), parameter :: several(5) = [0.37_dp, -0.37_dp, 0.05_dp, -2.3_dp, 70.0_dp]
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: answer
      integer :: i, k, l, status(lanes), alone
      do i = 1, size(method_names)
         call prepare(method_names(i), generic, method, class, answer)
         if (raised(answer)) cycle
         stream = start_stream(31)
         call random_block(stream, y0, q0)
         do l = 1, lanes ! rates from 0 up: all series lengths, sweeps, pieces
            y0(l, :) = y0(l, :)*(l - 1)/lanes
         end do
         do k = -1, 3
            h = several(k + 2)
            y = cshift(y0, k)
            q = cshift(q0, k)
            status = poinsot_ok
            call advance(method, class, h, y, q, status)
            y = cshift(y, -k)
            q = cshift(q, -k)
            do l = 1, lanes
               z = y0(l, :)
               r = q0(l, :)
               call turn_body(method_names(i), generic, h, 1, z, r, alone, lane=1 + mod(7*l, lanes))
               call expect(error, all(z == y(l, :)) .and. all(r == q(l, :)), &
                  trim(method_names(i))//": bits depend on the place or the neighbours")
            end do
         end do
      end do
   end subroutine test_lanes

   !> Padding at rest, other states in the padding, a body that fails: the others keep their bits.
   subroutine test_padding(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      real(dp) :: y0(lanes, 3), q0(lanes, 4), y(lanes, 3), q(lanes, 4), z(lanes, 3), r(lanes, 4)
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: answer
      integer :: i, status(lanes), other(lanes)
      do i = 1, size(method_names)
         call prepare(method_names(i), generic, method, class, answer)
         if (raised(answer)) cycle
         stream = start_stream(37)
         call random_block(stream, y0, q0)
         y = y0
         q = q0
         status = poinsot_ok
         call advance(method, class, 0.4_dp, y, q, status)
         call rest_block(z, r, other)
         z(1:3, :) = y0(1:3, :)
         r(1:3, :) = q0(1:3, :)
         z(9, :) = 300*y0(9, :)
         call advance(method, class, 0.4_dp, z, r, other)
         call expect(error, all(z(1:3, :) == y(1:3, :)) .and. all(r(1:3, :) == q(1:3, :)), &
            trim(method_names(i))//": bits depend on the padding")
         call expect(error, all(z(10:, :) == 0) .and. all(r(10:, 1) == 1) .and. &
                    all(r(10:, 2:) == 0), trim(method_names(i))//": a body at rest moves")
         call expect(error, all(other(10:) == poinsot_ok), trim(method_names(i))// &
            ": a body at rest fails")
      end do
   end subroutine test_padding

   !> Ten steps in one block and ten calls of a single body are the same; so is a stop and a new
   !> start.
   subroutine test_steps(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: y(3), q(4), z(3), r(4)
      integer :: i, k, status
      do i = 1, size(method_names)
         y = start
         q = [0.1_dp, 0.7_dp, -0.5_dp, 0.5_dp]
         z = y
         r = q
         call turn_body(method_names(i), generic, -0.3_dp, 10, y, q, status)
         do k = 1, 10
            call turn_body(method_names(i), generic, -0.3_dp, 1, z, r, status, &
                           lane=1 + mod(3*k, lanes))
         end do
         call expect(error, all(y == z) .and. all(q == r), trim(method_names(i))// &
            ": ten steps are not ten times one")
      end do
   end subroutine test_steps

   ! Refusals
   ! ----------------------------------------------------------------------------------------

   !> h|omega| > pi/2: approximate methods say E_STEP and keep the state. Below, up to that edge,
   !> they agree with their reference maps, where there is a root, and never return the wrong one.
   subroutine test_long_step(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: moments(3) = [0.627_dp, 0.376_dp, 1.0_dp]
      type(reference_map) :: map
      real(qp) :: yt(3), qt(4)
      real(dp) :: y(3), q(4), turn, gap
      integer :: i, k, status
      logical :: ok
      do i = 1, approximate_count
         call make_reference(method_names(i), moments, map)
         do k = 1, 60
            turn = 0.75_dp + 0.02_dp*k
            y = start*(turn/norm2(start/moments))
            q = start_q
            yt = y
            qt = q
            call map%apply(1.0_qp, yt, qt, ok)
            call turn_body(method_names(i), moments, 1.0_dp, 1, y, q, status)
            if (status == poinsot_ok) then
               gap = momentum_distance(real(y, qp), yt) + attitude_distance(real(q, qp), qt)
               call expect(error, ok .and. gap < 3.0e-14_dp, trim(method_names(i))// &
                  " returns a wrong root, "//text(gap)//" off, h|omega| = "//text(turn))
               call expect(error, turn < 1.6_dp, trim(method_names(i))//" accepts "//text(turn))
            else
               call expect(error, all(abs(y - start*(turn/norm2(start/moments))) <= 0) .and. &
                  all(abs(q - start_q) <= 0), trim(method_names(i))//" fails and moves")
               call expect(error, status == poinsot_e_step .or. status == poinsot_e_convergence, &
                  trim(method_names(i))//" fails with another status")
               call expect(error, turn > merge(0.9_dp, 1.3_dp, any(method_names(i) == ["dmv2  ", &
                          "rattle"])), trim(method_names(i))//" refuses h|omega| = "//text(turn))
            end if
            if (allocated(error)) return
         end do
         call expect(error, status, poinsot_e_step, "a step far too long, "//method_names(i))
      end do
   end subroutine test_long_step

   !> Moments that are no body's are refused with a message. (States are judged where they enter a
   !> block.)
   subroutine test_bad_moments(error)
      type(error_type), allocatable, intent(out) :: error
      type(body_class) :: class
      type(poinsot_error) :: answer
      real(dp) :: bad(3, 8), nan, inf
      integer :: k
      nan = ieee_value(nan, ieee_quiet_nan)
      inf = ieee_value(inf, ieee_positive_inf)
      bad = reshape([nan, 1.0_dp, 1.0_dp, 1.0_dp, inf, 1.0_dp, 1.0_dp, 1.0_dp, -0.5_dp, 0.0_dp, &
         0.0_dp, 0.0_dp, 1.0_dp, 2.0_dp, 3.1_dp, 0.0_dp, 1.0_dp, 2.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, &
         -1.0_dp, -1.0_dp, -1.0_dp], [3, 8])
      do k = 1, size(bad, 2)
         answer = poinsot_error()
         call make_class(bad(:, k), class, answer)
         call expect(error, answer%code, poinsot_e_domain, &
                    "moments "//text(bad(1, k))//" "// text(bad(2, k))//" "// text(bad(3, k)))
         call expect(error, allocated(answer%message), "refused without a message")
         if (allocated(error)) return
      end do
   end subroutine test_bad_moments

   !> h = 0 keeps every bit; a step of any finite size is answered without an exception: approximate
   !> methods say E_STEP and keep the state, the exact ones may say so too, but never return a
   !> number that is not finite.
   subroutine test_extreme_steps(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: steps(6) = [0.0_dp, 1.0e20_dp, -1.0e160_dp, 1.0e300_dp, 1.0e-160_dp, &
         -1.0e-310_dp]
      real(dp) :: y(3), q(4)
      logical :: halting(3), flags(3), kept
      integer :: i, k, status
      do i = 1, size(method_names)
         do k = 1, size(steps)
            y = start
            q = start_q
            call quiet_begin(halting)
            call turn_body(method_names(i), generic, steps(k), 1, y, q, status)
            call quiet_end(halting, flags)
            kept = all(y == start) .and. all(q == start_q)
            call expect(error, .not. any(flags), trim(method_names(i))// &
               " raises an exception for h = "//text(steps(k)))
            if (k == 1 .or. (abs(steps(k)) > 1 .and. i <= approximate_count)) then
               call expect(error, kept, trim(method_names(i))//" moves for h = "//text(steps(k)))
            end if
            if (abs(steps(k)) > 1 .and. i <= approximate_count) then
               call expect(error, status, poinsot_e_step, trim(method_names(i))//" for h = "// &
                  text(steps(k)))
            else if (abs(steps(k)) > 1) then
               call expect(error, abs(norm2(y)/norm2(start) - 1) < 1.0e-10_dp .and. &
                  abs(norm2(q) - 1) < 1.0e-10_dp, &
                  trim(method_names(i))//" loses the state for h = "//text(steps(k)))
            else
               call expect(error, status, poinsot_ok, trim(method_names(i))//" for h = "// &
                  text(steps(k)))
            end if
            if (allocated(error)) return
         end do
      end do
   end subroutine test_extreme_steps

   !> Exceptions do not stop us, and none is raised yet.
   subroutine quiet_begin(halting)
      logical, intent(out) :: halting(3)
      call ieee_get_halting_mode(ieee_invalid, halting(1))
      call ieee_get_halting_mode(ieee_overflow, halting(2))
      call ieee_get_halting_mode(ieee_divide_by_zero, halting(3))
      call ieee_set_halting_mode([ieee_invalid, ieee_overflow, ieee_divide_by_zero], .false.)
      call ieee_set_flag([ieee_invalid, ieee_overflow, ieee_divide_by_zero], .false.)
   end subroutine quiet_begin

   !> Which of invalid, overflow, division by zero were raised; things as before.
   subroutine quiet_end(halting, flags)
      logical, intent(in) :: halting(3)
      logical, intent(out) :: flags(3)
      call ieee_get_flag([ieee_invalid, ieee_overflow, ieee_divide_by_zero], flags)
      call ieee_set_flag([ieee_invalid, ieee_overflow, ieee_divide_by_zero], .false.)
      call ieee_set_halting_mode([ieee_invalid, ieee_overflow, ieee_divide_by_zero], halting)
   end subroutine quiet_end

   !> A lane that comes with a status stands still, bit for bit, and keeps the status.
   subroutine test_frozen(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      real(dp) :: y0(lanes, 3), q0(lanes, 4), y(lanes, 3), q(lanes, 4), z(lanes, 3), r(lanes, 4), &
         carry(lanes, 7)
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: answer
      integer :: i, k, status(lanes), all_well(lanes)
      do i = 1, size(method_names)
         call prepare(method_names(i), generic, method, class, answer)
         if (raised(answer)) cycle
         stream = start_stream(41)
         call random_block(stream, y0, q0)
         do k = 1, 2
            carry = 0
            y = y0
            q = q0
            z = y0
            r = q0
            status = poinsot_ok
            status(5::7) = poinsot_e_domain
            all_well = poinsot_ok
            if (k == 1) then
               call advance(method, class, 0.4_dp, y, q, status)
               call advance(method, class, 0.4_dp, z, r, all_well)
            else
               call advance(method, class, 0.4_dp, y, q, status, carry)
               carry = 0
               call advance(method, class, 0.4_dp, z, r, all_well, carry)
            end if
            z(5::7, :) = y0(5::7, :)
            r(5::7, :) = q0(5::7, :)
            all_well(5::7) = poinsot_e_domain
            call expect(error, all(y == z) .and. all(q == r), trim(method_names(i))// &
               " moves a frozen lane, or a neighbour")
            call expect(error, all(status == all_well), trim(method_names(i))// &
               " changes the status of a frozen lane")
         end do
      end do
   end subroutine test_frozen

   !> Valid input raises neither invalid nor overflow nor division by zero, in padding and masked
   !> lanes neither.
   subroutine test_exceptions(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(random_body) :: body
      logical :: halting(3), flags(3)
      integer :: i, k, status
      do i = 1, size(method_names)
         stream = start_stream(43)
         do k = 1, 10*size(body_kinds)
            call hard_body(stream, body_kinds(1 + mod(k, size(body_kinds))), merge(1.4_dp, &
               200.0_dp, i <= approximate_count), body)
            call quiet_begin(halting)
            call turn_body(method_names(i), body%moments, body%h, 1, body%y, body%q, status, lane=3)
            call quiet_end(halting, flags)
            call expect(error, .not. flags(1), &
                       trim(method_names(i))//" raises invalid on "// body%kind)
            call expect(error, .not. flags(2), &
                       trim(method_names(i))//" raises overflow on "// body%kind)
            call expect(error, .not. flags(3), &
                       trim(method_names(i))//" divides by zero on "// body%kind)
         end do
      end do
   end subroutine test_exceptions

   !> Energy, |y| and |q| over 1e4 steps at h|omega| = .1, plain and compensated, `exact` and dmv10.
   subroutine test_drift(error)
      type(error_type), allocatable, intent(out) :: error
      character(5), parameter :: names(2) = [character(5) :: "exact", "dmv10"]
      type(random_stream) :: stream
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: answer
      real(dp) :: y(lanes, 3), q(lanes, 4), carry(lanes, 7), h0(lanes), c0(lanes), rms, norm
      integer :: i, k, n, status(lanes)
      do i = 1, 2
         do k = 1, 2
            call prepare(names(i), generic, method, class, answer)
            stream = start_stream(47)
            call random_block(stream, y, q)
            y = y/spread(norm2(y, 2), 2, 3)
            h0 = energies(y)
            c0 = norm2(y, 2)
            carry = 0
            status = poinsot_ok
            do n = 1, 10000
               if (k == 1) then
                  call advance(method, class, 0.07_dp, y, q, status)
               else
                  call advance(method, class, 0.07_dp, y, q, status, carry)
               end if
            end do
            rms = sqrt(sum((energies(y)/h0 - 1)**2)/lanes)
            norm = max(maxval(abs(norm2(q, 2) - 1)), maxval(abs(norm2(y, 2)/c0 - 1))/10)
            call expect(error, rms < merge(3.0e-14_dp, 1.0e-15_dp, k == 1), names(i)// &
               " energy drifts: "//text(rms))
            call expect(error, norm < 2.0e-15_dp, names(i)//" |q| or |y| drifts: "//text(norm))
         end do
      end do
   end subroutine test_drift

   pure function energies(y)
      real(dp), intent(in) :: y(lanes, 3)
      real(dp) :: energies(lanes)
      energies = (y(:, 1)**2/generic(1) + y(:, 2)**2/generic(2) + y(:, 3)**2/generic(3))/2
   end function energies

end module test_free_state
