!> Hard cases: every method converges, reports or is exact; never a NaN, never a silent wrong
!> answer.
module test_hard
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_status, only: poinsot_ok, poinsot_e_step
   use test_bodies, only: permute_body, random_body
   use test_expectation, only: expect
   use test_free_tools, only: method_names, approximate_count, turn_body, text
   use test_hard_cases, only: hard_case, hard_list, add_case, judge_case, worst_errors, &
      all_orders, unmoved, &
      largest_rate, last_truth
   use test_hard_faults, only: collect_hard_faults
   use test_hard_symmetry, only: collect_hard_symmetry
   use test_hard_tops, only: collect_hard_tops
   use test_measure, only: attitude_distance, momentum_distance
   implicit none(type, external)
   private
   public :: collect_hard, collect_hard_deep

   integer, parameter :: methods = size(method_names)
   real(dp), parameter :: generic(3) = [0.6_dp, 0.8_dp, 1.0_dp]

contains

   subroutine collect_hard(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      type(unittest_type), allocatable :: tops(:), faults(:), symmetry(:)
      call collect_hard_tops(tops)
      call collect_hard_faults(faults)
      call collect_hard_symmetry(symmetry)
      testsuite = [ &
         new_unittest("separatrix", test_separatrix), &
         new_unittest("kinds-of-body", test_kinds), &
         new_unittest("units", test_units), &
         new_unittest("steps-of-any-length", test_steps), &
         new_unittest("billion-periods-symmetric", test_billion), &
         new_unittest("there-and-back", test_back), &
         new_unittest("every-root-of-the-plain-map", test_roots), &
         new_unittest("moments-a-rounding-too-wide", test_too_wide), &
         new_unittest("rest-and-denormals", test_rest), &
         tops, symmetry, faults]
   end subroutine collect_hard

   !> The same with more orders of the axes and more steps.
   subroutine collect_hard_deep(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("separatrix-deep", test_separatrix_deep), &
         new_unittest("kinds-of-body-deep", test_kinds_deep)]
   end subroutine collect_hard_deep

   ! The lists
   ! -----------------------------------------------------------------------------------------

   !> On the separatrix to one part in 10^k (k to 16, and exactly), and at the middle axis to 10^-k
   !> (k to 300, and exactly).
   subroutine list_separatrix(list)
      type(hard_list), intent(out) :: list
      real(dp), parameter :: even(3) = [2.0_dp, 3.0_dp, 6.0_dp] ! c1 = c2: y1 = y3 is exactly on it
      integer, parameter :: near(10) = [1, 2, 4, 6, 8, 10, 12, 14, 15, 16]
      integer, parameter :: far(15) = [1, 2, 4, 8, 12, 15, 16, 17, 30, 75, 100, 150, 160, 200, 300]
      character(4) :: power
      real(dp) :: d, c1, c2
      integer :: k
      c1 = 0.6_dp*0.2_dp/(0.8_dp*0.4_dp)
      c2 = 1.0_dp*0.2_dp/(0.8_dp*0.4_dp)
      do k = 1, size(near)
         d = 10.0_dp**(-near(k))
         write (power, "(i0)") near(k)
         call add_case(list, "separatrix to 1e-"//power, generic, [0.5_dp*(1 + d), -0.4_dp, &
            0.5_dp*sqrt(c2/c1)])
         call add_case(list, "separatrix to -1e-"//power, generic, [0.5_dp*(1 - d), 0.7_dp, &
            -0.5_dp*sqrt(c2/c1)])
         call add_case(list, "even separatrix to 1e-"//power, even - [0.0_dp, 0.0_dp, 1.0_dp + d], &
            [1.0_dp, 0.3_dp, 1.0_dp])
      end do
      call add_case(list, "exactly on the separatrix", [2.0_dp, 3.0_dp, 4.0_dp], [0.5_dp, 0.3_dp, &
         1.0_dp/sqrt(2.0_dp)])
      do k = 1, size(far)
         d = 10.0_dp**(-far(k))
         write (power, "(i0)") far(k)
         call add_case(list, "middle axis, both 1e-"//power, generic, [d, 1.0_dp, 2*d])
         call add_case(list, "middle axis, one 1e-"//power, generic, [0.0_dp, -1.0_dp, d])
         call add_case(list, "middle axis, ingoing 1e-"//power, generic, [d, 1.0_dp, &
            -sqrt(c2/c1)*d])
      end do
      call add_case(list, "middle axis exactly", generic, [0.0_dp, 1.0_dp, 0.0_dp])
   end subroutine list_separatrix

   !> Nearly symmetric, spherical, flat, linear, to 1e-15 and exactly; axes; parts of momentum far
   !> smaller than the rest.
   subroutine list_kinds(list)
      type(hard_list), intent(out) :: list
      integer, parameter :: powers(7) = [1, 3, 6, 9, 12, 15, 400]
      real(dp), parameter :: y(3) = [0.5_dp, -0.6_dp, 0.4_dp]
      character(4) :: power
      real(dp) :: d
      integer :: k
      do k = 1, size(powers)
         d = 0
         if (powers(k) < 300) d = 10.0_dp**(-powers(k))
         write (power, "(i0)") powers(k)
         if (powers(k) == 400) power = "inf"
         call add_case(list, "lower pair 1e-"//power, [0.7_dp, 0.7_dp*(1 + d), 1.1_dp], y)
         call add_case(list, "upper pair 1e-"//power, [0.7_dp, 1.1_dp*(1 - d), 1.1_dp], y)
         call add_case(list, "sphere 1e-"//power, [1.0_dp, 1 + d, 1 + 2*d], y)
         call add_case(list, "flat 1e-"//power, [0.4_dp, 0.6_dp, 1.0_dp - d/2], y)
         call add_case(list, "disc 1e-"//power, [0.5_dp, 0.5_dp*(1 + d), 1.0_dp], y)
         call add_case(list, "linear 1e-"//power, [d, 1.0_dp, 1.0_dp + d/2], [d/2, 0.6_dp, -0.4_dp])
         call add_case(list, "linear at rest about it 1e-"//power, [d, 1.0_dp, 1.0_dp], [0.0_dp, &
            0.6_dp, -0.4_dp])
         call add_case(list, "first axis, off by 1e-"//power, generic, [1.0_dp, d, d])
         call add_case(list, "last axis, off by 1e-"//power, generic, [d, d, -1.0_dp])
      end do
      call add_case(list, "linear 1e-30", [1e-30_dp, 1.0_dp, 1.0_dp], [3e-31_dp, 0.6_dp, -0.4_dp])
      call add_case(list, "linear 1e-100", [1e-100_dp, 1.0_dp, 1.0_dp], [3e-101_dp, 0.6_dp, &
         -0.4_dp])
      call add_case(list, "linear 1e-300", [1e-300_dp, 1.0_dp, 1.0_dp], [0.0_dp, 0.6_dp, -0.4_dp])
   end subroutine list_kinds

   ! Judged
   ! ------------------------------------------------------------------------------------------

   !> A list by all methods.
   subroutine judge_list(error, list, orders, turns, units, worst)
      type(error_type), allocatable, intent(inout) :: error
      type(hard_list), intent(in) :: list
      integer, intent(in) :: orders(:)
      real(dp), intent(in) :: turns(:), units
      type(worst_errors), intent(inout) :: worst(methods)
      type(last_truth) :: truth
      integer :: i, k, m, o
      do i = 1, list%n
         do k = 1, size(turns)
            o = orders(1 + mod(i + k, size(orders)))
            do m = 1, methods
               if (m <= approximate_count .and. abs(turns(k)) > 1.5_dp) cycle ! test_steps has them
               call judge_case(error, list%at(i), o, turns(k), m, units, worst(m), truth)
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine judge_list

   subroutine test_separatrix(error)
      type(error_type), allocatable, intent(out) :: error
      type(hard_list) :: list
      type(worst_errors) :: worst(methods)
      call list_separatrix(list)
      call judge_list(error, list, [1, 4, 2, 5], [0.1_dp, -1.0_dp, 5.0_dp], 6.0_dp, worst)
   end subroutine test_separatrix

   subroutine test_kinds(error)
      type(error_type), allocatable, intent(out) :: error
      type(hard_list) :: list
      type(worst_errors) :: worst(methods)
      call list_kinds(list)
      call judge_list(error, list, [4, 1, 6, 3], [0.1_dp, -1.0_dp, 5.0_dp], 6.0_dp, worst)
   end subroutine test_kinds

   subroutine test_separatrix_deep(error)
      type(error_type), allocatable, intent(out) :: error
      type(hard_list) :: list
      call list_separatrix(list)
      call judge_deep(error, list, "separatrix", passes=6)
   end subroutine test_separatrix_deep

   subroutine test_kinds_deep(error)
      type(error_type), allocatable, intent(out) :: error
      type(hard_list) :: list
      call list_kinds(list)
      call judge_deep(error, list, "kinds", passes=2)
   end subroutine test_kinds_deep

   !> All orders of the axes in turn, another one for a case in each pass, many steps; prints the
   !> widest error of each method.
   subroutine judge_deep(error, list, what, passes)
      use, intrinsic :: iso_fortran_env, only: output_unit
      type(error_type), allocatable, intent(inout) :: error
      type(hard_list), intent(in) :: list
      character(*), intent(in) :: what
      integer, intent(in) :: passes
      type(worst_errors) :: worst(methods)
      integer :: m, o, pass
      do pass = 1, passes
         call judge_list(error, list, [(1 + mod(o + pass, 6), o=1, 6)], [1e-3_dp, 0.1_dp, &
            -0.5_dp, -1.0_dp, 1.4_dp, 3.0_dp, -10.0_dp], 10.0_dp, worst)
         if (allocated(error)) return
      end do
      do m = 1, methods
         write (output_unit, &
            "(a, ', ', a, t36, i6, ' answers', i6, ' refusals; widest ', f6.3, ' of allowed, ', &
            &f6.2, ' units of conditioning, ', a, ', h|omega| = ', &
               a)") what, trim(method_names(m)), worst(m)%answered, &
            worst(m)%refused, worst(m)%part, worst(m)%units, trim(worst(m)%label), &
               text(worst(m)%turn)
      end do
   end subroutine judge_deep

   ! Units and steps
   ! ----------------------------------------------------------------------------------

   !> Moments, momenta and times in units 1e-150 to 1e+150 times as large, and a molecule in SI
   !> units: the same bits for powers of two, a few roundings of the input for powers of ten.
   subroutine test_units(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: two(2, 7) = reshape([-498, 0, 498, 0, -200, 300, 498, -200, -153, 40, &
         0, 230, 0, -230], [2, 7])
      real(dp), parameter :: ten(2, 6) = reshape([1e-150_dp, 1.0_dp, 1e150_dp, 1.0_dp, 1e-46_dp, &
         1e12_dp, 1e-100_dp, &
         1e60_dp, 1e100_dp, 1e-60_dp, 1.0_dp, 1e60_dp], [2, 6])
      real(dp), parameter :: y0(3) = [0.5_dp, -0.6_dp, 0.4_dp], q0(4) = [0.1_dp, 0.7_dp, -0.5_dp, &
         0.5_dp], h0 = 0.7_dp
      real(dp) :: y(3), q(4), z(3), r(4), gap, moments(3)
      integer :: i, k, m, status(2)
      do i = 1, methods
         do k = 1, 13
            m = 1 + mod(k, 6)
            moments = generic(all_orders(:, m))
            y = y0
            q = q0
            r = q0
            call turn_body(method_names(i), moments, h0, 3, y, q, status(1))
            if (k <= 7) then
               z = scale(y0, two(1, k) + two(2, k))
               call turn_body(method_names(i), scale(moments, two(1, k)), scale(h0, -two(2, k)), &
                  3, z, r, status(2))
               z = scale(z, -two(1, k) - two(2, k))
               gap = maxval(abs(z - y)) + maxval(abs(r - q))
            else
               associate (mass => ten(1, k - 7), rate => ten(2, k - 7))
                  z = y0*mass*rate
                  call turn_body(method_names(i), moments*mass, h0/rate, 3, z, r, status(2))
                  gap = max(0.0_dp, momentum_distance(z/(mass*rate), y) + attitude_distance(r, &
                     q) - 4e-15_dp)
               end associate
            end if
            call expect(error, all(status == poinsot_ok), trim(method_names(i))// &
               " fails in other units")
            call expect(error, gap <= 0, trim(method_names(i))//" does not scale, "//text(gap)// &
               " off")
         end do
      end do
   end subroutine test_units

   !> h from 1e-12 to 1e+9 periods, both signs, and zero, on every hard body of the list of kinds.
   subroutine test_steps(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: powers(10) = [-12, -8, -4, -2, 1, 2, 3, 5, 7, 9]
      type(hard_list) :: list
      type(worst_errors) :: worst(methods)
      type(hard_case) :: case
      type(last_truth) :: truth
      real(dp) :: y(3), q(4), turn
      integer :: i, k, m, status
      call list_kinds(list)
      do i = 1, list%n
         case = list%at(i)
         do m = 1, methods
            y = case%y
            q = case%q
            call turn_body(method_names(m), case%moments, merge(0.0_dp, -0.0_dp, mod(i, 2) == 0), &
               3, y, q, status)
            call expect(error, status == poinsot_ok .and. unmoved(y, case%y) .and. unmoved(q, &
               case%q), &
               trim(method_names(m))//": a step of zero moves, "//case%label)
         end do
         do k = 1, size(powers)
            do m = 1, methods
               if (mod(i + k + m, 3) /= 0) cycle
               turn = (-1)**k*6.28_dp*10.0_dp**powers(k)
               if (abs(turn) < 3) then
                  call judge_case(error, case, 1 + mod(i, 6), turn, m, 6.0_dp, worst(m), truth)
               else
                  call judge_case(error, case, 1 + mod(i, 6), turn, m, 40.0_dp, worst(m), truth, &
                     .false.)
               end if
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine test_steps

   !> A symmetric body over 1e9 periods against the closed form in quadruple precision: what is lost
   !> is the rounding of the angle, and the two exact methods say E_STEP where no digit is left.
   subroutine test_billion(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: moments(3) = [0.75_dp, 0.75_dp, 1.0_dp], y0(3) = [0.5_dp, 0.25_dp, &
         -0.5_dp]
      real(qp) :: yt(3), qt(4), rate, angle, half, pole(3), length
      real(dp) :: y(3), q(4), h, gap
      integer :: k, m, status
      do k = 0, 18
         h = 10.0_dp**k
         rate = real(y0(3), qp)/moments(3) - real(y0(3), qp)/moments(1)
         angle = rate*h
         yt = [y0(1)*cos(angle) + y0(2)*sin(angle), y0(2)*cos(angle) - y0(1)*sin(angle), &
            real(y0(3), qp)]
         length = sqrt(sum(real(y0, qp)**2))
         half = length/moments(1)*h/2
         pole = y0/length*sin(half)
         angle = angle/2
         qt = [cos(half)*cos(angle) - pole(3)*sin(angle), pole(1)*cos(angle) + pole(2)*sin(angle), &
            pole(2)*cos(angle) - pole(1)*sin(angle), cos(half)*sin(angle) + pole(3)*cos(angle)]
         do m = approximate_count + 1, methods
            y = y0
            q = [1, 0, 0, 0]
            call turn_body(method_names(m), moments, h, 1, y, q, status)
            if (status == poinsot_e_step) then
               call expect(error, k >= 15 .and. unmoved(y, y0), trim(method_names(m))// &
                  " refuses a step of 1e"// &
                  achar(iachar("0") + k/10)//achar(iachar("0") + mod(k, 10)))
            else
               gap = momentum_distance(real(y, qp), yt) + attitude_distance(real(q, qp), qt)
               call expect(error, status == poinsot_ok .and. gap < 4e-16_dp*(2 + h), &
                  trim(method_names(m))//" is "//text(gap)// &
                  " off after "//text(h))
            end if
            if (allocated(error)) return
         end do
      end do
   end subroutine test_billion

   !> A hundred steps there, a hundred back, every method, every hard body.
   subroutine test_back(error)
      type(error_type), allocatable, intent(out) :: error
      type(hard_list) :: list
      type(random_body) :: body
      real(dp) :: y(3), q(4), h, gap
      integer :: i, m, status(2)
      call list_kinds(list)
      do i = 1, list%n
         body%moments = list%at(i)%moments
         body%y = list%at(i)%y
         body%q = list%at(i)%q
         call permute_body(all_orders(:, 1 + mod(i, 6)), body)
         h = 0.3_dp/max(largest_rate(body%moments, body%y), 1e-3_dp)
         do m = 1, methods
            if (mod(i + m, 3) /= 0) cycle
            y = body%y
            q = body%q
            call turn_body(method_names(m), body%moments, h, 100, y, q, status(1))
            call turn_body(method_names(m), body%moments, -h, 100, y, q, status(2))
            if (m <= 2 .and. any(status == poinsot_e_step)) then
               cycle
            end if ! a thin body: see refuse_wide_turns
            gap = momentum_distance(y, body%y) + attitude_distance(q, body%q)
            call expect(error, all(status == poinsot_ok) .and. gap < 2e-13_dp, &
               trim(method_names(m))// &
               " does not come back, "//text(gap)//" off: "//list%at(i)%label)
         end do
      end do
   end subroutine test_back

   !> The plain Moser-Veselov map has a root below 90 degrees as long as h |omega| <= 1, and two
   !> solvers of it find the same; beyond, both find it or both refuse. On a sphere the roots meet
   !> at 1, and e = (1 - sqrt(1 - s^2))/s there.
   subroutine test_roots(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: sizes(12) = [0.8_dp, 0.9_dp, 0.95_dp, 0.98_dp, 0.999_dp, 1.0_dp, &
         1.03_dp, 1.06_dp, 1.1_dp, 1.15_dp, 1.25_dp, 1.4_dp]
      type(hard_list) :: list
      real(dp) :: y(3, 2), q(4, 2), y0(3), gap, s
      integer :: i, k, status(2)
      call list_kinds(list)
      do i = 1, list%n
         do k = 1, size(sizes)
            if (.not. all(list%at(i)%moments > 1e-2_dp)) cycle
            y0 = list%at(i)%y*sizes(k)*(1 - 1e-6_dp)/largest_rate(list%at(i)%moments, list%at(i)%y)
            y = spread(y0, 2, 2)
            q = spread([1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 2, 2)
            call turn_body("dmv2", list%at(i)%moments, 1.0_dp, 1, y(:, 1), q(:, 1), status(1))
            call turn_body("rattle", list%at(i)%moments, 1.0_dp, 1, y(:, 2), q(:, 2), status(2))
            call expect(error, status(1) == status(2) .and. (status(1) == poinsot_ok &
               .or. sizes(k) > 1), merge("rattle", "dmv2  ", status(1) == poinsot_ok)// &
               " finds no root: "//list%at(i)%label//", h|omega| = "//text(sizes(k)))
            gap = momentum_distance(y(:, 1), y(:, 2)) + attitude_distance(q(:, 1), q(:, 2))
            call expect(error, gap < 1e-11_dp, "dmv2 and rattle differ by "//text(gap)//": "// &
               list%at(i)%label//", h|omega| = "//text(sizes(k)))
         end do
      end do
      do k = 1, 12
         s = 1 - 10.0_dp**(-k)
         y(:, 1) = [0.0_dp, 0.6_dp*s, 0.8_dp*s]
         q(:, 1) = [1, 0, 0, 0]
         call turn_body("dmv2", [1.0_dp, 1.0_dp, 1.0_dp], 1.0_dp, 1, y(:, 1), q(:, 1), status(1))
         gap = abs(norm2(q(2:4, 1))/q(1, 1) - (1 - sqrt((1 - s)*(1 + s)))/s)
         call expect(error, status(1) == poinsot_ok .and. gap < 1e-15_dp/sqrt(1 - s), &
            "the root on a sphere is "//text(gap)//" off")
      end do
   end subroutine test_roots

   !> A thin body whose I3 - I2 is many times I1, and still a rounding of I3: it is taken as flat,
   !> by all constants alike, so that the two exact methods tell the same motion.
   subroutine test_too_wide(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: moments(3) = [1e-20_dp, 1.0_dp, 1.0_dp + 2.3e-16_dp]
      real(dp), parameter :: y0(3) = [2e-21_dp, 0.6_dp, -0.4_dp]
      real(dp) :: y(3, 2), q(4, 2), h, gap
      integer :: k, m, status(2)
      do k = -2, 4
         h = 1.3_dp*10.0_dp**k
         do m = 1, 2
            y(:, m) = y0
            q(:, m) = [1, 0, 0, 0]
            call turn_body(method_names(approximate_count + m), moments, h, 1, y(:, m), q(:, m), &
               status(m))
         end do
         gap = momentum_distance(y(:, 1), y(:, 2)) + attitude_distance(q(:, 1), q(:, 2))
         call expect(error, all(status == poinsot_ok) .and. gap < 1e-14_dp*(1 + 10*h), &
            "exact and jacobi differ by "//text(gap)//" after "//text(h))
      end do
   end subroutine test_too_wide

   !> y = 0, and momenta, moments and steps at the lower end of the range.
   subroutine test_rest(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: small(7) = [0.0_dp, 1e-300_dp, 1e-307_dp, 3e-308_dp, 1e-310_dp, &
         1e-320_dp, 5e-324_dp]
      real(dp), parameter :: tinies(3) = [3e-308_dp, 4e-308_dp, 5e-308_dp]
      real(dp) :: y(3), q(4), y0(3), q0(4), gap
      integer :: i, j, k, m, status
      q0 = [0.5_dp, 0.5_dp, -0.5_dp, 0.5_dp]
      do m = 1, methods
         do k = 1, size(small)
            do j = 1, 4
               y0 = 0
               if (j == 4) y0 = [1, -2, 1]*small(k)
               if (j < 4) y0(j) = small(k)
               do i = 1, 3
                  y = y0
                  q = q0
                  select case (i)
                  case (1) ! a body of order one, hardly moving
                     call turn_body(method_names(m), generic, 0.5_dp, 2, y, q, status)
                  case (2) ! as small a body, h|omega| about .1
                     call turn_body(method_names(m), tinies, 0.03_dp, 2, y, q, status)
                  case default
                     call turn_body(method_names(m), generic, 1e-300_dp, 2, y, q, status)
                  end select
                  gap = maxval(abs(q - q0))
                  ! not slow at all
                  if (i == 2 .and. small(k) > 5e-307_dp .and. m <= approximate_count) then
                     call expect(error, status == poinsot_e_step .and. unmoved(y, y0), &
                        trim(method_names(m))//": no E_STEP")
                     cycle
                  end if
                  call expect(error, status == poinsot_ok .and. all(ieee_is_finite(y)) &
                     .and. all(ieee_is_finite(q)), &
                     trim(method_names(m))//" fails on "//text(small(k)))
                  call expect(error, abs(norm2(q) - 1) < 1e-15_dp .and. (i == 2 &
                     .or. gap < 1e-15_dp), &
                     trim(method_names(m))//" turns what is at rest, "//text(gap))
                  call expect(error, all(abs(y) <= 2.1_dp*maxval(abs(y0))*sqrt(1.5_dp)), &
                     trim(method_names(m))// &
                     " speeds up what is at rest: "//text(small(k)))
               end do
            end do
         end do
      end do
   end subroutine test_rest

end module test_hard
