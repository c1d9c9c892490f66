!> The Taylor integrator through plans: errors against tolerances, beside an independent solution in
!> quadruple precision of (y, q) equations that share nothing with it; bits; statuses; hard bodies.
module test_taylor
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, i8, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_method, poinsot_e_step
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_tensor_class, set_option
   use poinsot_ensemble_step, only: step_bodies
   use poinsot_taylor_basis, only: span_rows
   use poinsot_splitting_registry, only: splitting_flows
   use poinsot_study_torque_series, only: torque_problem, torque_problems, turn_under_torque, fine
   use test_bodies, only: random_quaternion, random_stream, start_stream, uniform
   use test_expectation, only: expect
   use test_oracle_algebra, only: cross, rotate_back
   use test_oracle_data, only: top_case, read_top
   use test_crowd, only: with_effect, turned_tensor
   implicit none(type, external)
   private
   public :: collect_taylor

   real(dp), parameter :: moments(3) = [0.6_dp, 0.8_dp, 1.1_dp]
   real(dp), parameter :: tolerances(5) = [1e-4_dp, 1e-6_dp, 1e-8_dp, 1e-11_dp, 1e-14_dp]

   !> Settings of an effect as text, and what the reference knows of it.
   type :: one_effect
      character(18) :: name = ""
      character(160) :: text = ""
   end type one_effect

   type(one_effect), parameter :: list(*) = [ &
      one_effect("gravity", "centre = 0.3, -0.4, 0.9; weight = 1.1; up = 0.3, 0.5, 0.8"), &
      one_effect("field", "dipole = 0.5, -0.3, 0.4; strength = 1.5, 0.2, 0.3"), &
      one_effect("field", "dipole = 0.5, -0.3, 0.4; strength = 1.5, 0.2, 0.3; " // &
         "motion = rotating; frequency = 1.3; phase = 0.4; axis = 0.1, 0.2, 0.9"), &
      one_effect("field", "dipole = 0.5, -0.3, 0.4; strength = 1.5, 0.2, 0.3; " // &
         "motion = oscillating; frequency = 2.3; phase = 0.4"), &
      one_effect("gravity_gradient", "rate = 0.7; orbit = fixed"), &
      one_effect("gravity_gradient", "rate = 0.7"), &
      one_effect("spring", "stiffness = 1.2; axis = 1, 2, -0.5; direction = 0.2, 0.7, -0.4"), &
      one_effect("torque", "value = 0.2, -0.3, 0.4"), &
      one_effect("torque", "value = 0.2, -0.3, 0.4; frame = space; frequency = 1.7; phase = 1"), &
      one_effect("torque", "times = 0.5, 1.3, 2.2; " // &
         "table = 0.2, -0.3, 0.4, 0.5, 0.1, -0.2, -0.3, 0.6, 0.2"), &
      one_effect("torque", "times = 0.5, 1.3, 2.2; " // &
         "table = 0.2, -0.3, 0.4, 0.5, 0.1, -0.2, -0.3, 0.6, 0.2; frame = space"), &
      one_effect("drag", "friction = 0.2, 0.3, 0.1"), &
      one_effect("gyrostat", "rotor = 0.3, -0.2, 0.5")]

   !> The same kinds with numbers that double precision does not round when effects are made.
   type(one_effect), parameter :: unrounded(*) = [ &
      one_effect("gravity", "centre = 0.3, -0.4, 0.9; weight = 2; up = 0, 1, 0"), &
      list(2), &
      one_effect("field", "dipole = 0.5, -0.3, 0.4; strength = 1.5, 0.2, 0.3; " // &
         "motion = rotating; frequency = 1.3; phase = 0.4; axis = 1, 0, 0"), &
      list(4), &
      one_effect("gravity_gradient", "rate = 0.5; orbit = fixed"), &
      one_effect("gravity_gradient", "rate = 0.5"), &
      one_effect("spring", "stiffness = 1.2; axis = 0, 1, 0; direction = 0, 0, -1"), &
      list(8:13)]

contains

   subroutine collect_taylor(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("every-effect-keeps-its-tolerance", test_effects), &
         new_unittest("sums-of-effects", test_sums), &
         new_unittest("quadruple-series", test_quadruple), &
         new_unittest("quadruple-series-published-tops", test_tops), &
         new_unittest("tensor-class", test_tensor), &
         new_unittest("steps-and-bits", test_bits), &
         new_unittest("floor", test_floor), &
         new_unittest("sleeping-top", test_sleeping), &
         new_unittest("pendulum-at-its-separatrix", test_separatrix), &
         new_unittest("thin-and-linear", test_thin), &
         new_unittest("any-unit", test_units), &
         new_unittest("limits", test_limits), &
         new_unittest("refusals", test_refusals), &
         new_unittest("rank-of-directions", test_rank)]
   end subroutine collect_taylor

   ! Reference
   ! ---------------------------------------------------------------------------------------------

   !> A row "1.0, 2.0" after "key = " in the settings, or a default.
   pure function numbers(text, key, default) result(values)
      character(*), intent(in) :: text, key
      real(dp), intent(in) :: default(:)
      real(qp) :: values(size(default))
      real(dp) :: found(size(default))
      character(len(text) + 2) :: padded
      integer :: i, last
      values = default
      padded = "; "//text
      i = index(padded, "; "//key//" = ")
      if (i == 0) return
      i = i + len("; "//key//" = ")
      last = index(padded(i:), ";")
      if (last == 0) last = len(padded) - i + 2
      read (padded(i:i + last - 2), *) found
      values = found
   end function numbers

   !> v turned about a unit axis.
   pure function turn(v, axis, angle) result(w)
      real(qp), intent(in) :: v(3), axis(3), angle
      real(qp) :: w(3)
      w = cos(angle)*v + sin(angle)*cross(axis, v) + (1 - cos(angle))*dot_product(axis, v)*axis
   end function turn

   pure function unit(v) result(u)
      real(qp), intent(in) :: v(3)
      real(qp) :: u(3)
      u = v/sqrt(sum(v*v))
   end function unit

   !> Torque of an effect, straight from its formula; friction and rotors are not here.
   pure function torque_of(one, inertia, t, q) result(g)
      type(one_effect), intent(in) :: one
      real(qp), intent(in) :: inertia(3), t, q(4)
      real(qp) :: g(3), v(3), a(3), e(3), f(1), p(1), times(3), table(9), s
      real(dp), parameter :: z3(3) = 0, z9(9) = 0
      integer :: i
      g = 0
      f = numbers(one%text, "frequency", [0.0_dp])
      p = numbers(one%text, "phase", [0.0_dp])
      select case (one%name)
      case ("gravity")
         f = numbers(one%text, "weight", [1.0_dp])
         v = rotate_back(q, unit(numbers(one%text, "up", [0.0_dp, 0.0_dp, 1.0_dp])))
         g = f(1)*cross(v, numbers(one%text, "centre", z3))
      case ("field")
         e = numbers(one%text, "strength", z3)
         if (index(one%text, "rotating") > 0) e = turn(e, unit(numbers(one%text, "axis", z3)), &
            f(1)*t + p(1))
         if (index(one%text, "oscillating") > 0) e = e*cos(f(1)*t + p(1))
         g = cross(numbers(one%text, "dipole", z3), rotate_back(q, e))
      case ("gravity_gradient")
         f = numbers(one%text, "rate", [0.0_dp])
         e = [1, 0, 0]
         if (index(one%text, "fixed") == 0) e = turn(e, [0.0_qp, 0.0_qp, 1.0_qp], f(1)*t)
         v = rotate_back(q, e)
         g = 3*f(1)**2*cross(v, inertia*v)
      case ("spring")
         f = numbers(one%text, "stiffness", [0.0_dp])
         a = unit(numbers(one%text, "axis", z3))
         v = rotate_back(q, unit(numbers(one%text, "direction", z3)))
         g = f(1)*dot_product(a, v)*cross(a, v)
      case ("torque")
         if (index(one%text, "times") > 0) then
            times = numbers(one%text, "times", z3)
            table = numbers(one%text, "table", z9)
            g = table(7:9)
            if (t <= times(1)) g = table(1:3)
            do i = 1, 2
               s = (t - times(i))/(times(i + 1) - times(i))
               if (s > 0 .and. s <= 1) g = table(3*i - 2:3*i)*(1 - s) + table(3*i + 1:3*i + 3)*s
            end do
         else
            g = numbers(one%text, "value", z3)
            if (abs(f(1)) > 0) g = g*cos(f(1)*t + p(1))
         end if
         if (index(one%text, "space") > 0) g = rotate_back(q, g)
      case default ! gyrostat and drag are no torques of the attitude
         continue
      end select
   end function torque_of

   !> Right-hand side of (y, q).
   pure function slope(effects, inertia, t, x) result(dx)
      type(one_effect), intent(in) :: effects(:)
      real(qp), intent(in) :: inertia(3), t, x(7)
      real(qp) :: dx(7), w(3), rotor(3)
      integer :: i
      rotor = 0
      do i = 1, size(effects)
         if (effects(i)%name == "gyrostat") rotor = rotor + numbers(effects(i)%text, "rotor", &
            [0.0_dp, 0.0_dp, 0.0_dp])
      end do
      w = 0
      where (inertia > 0) w = (x(1:3) - rotor)/inertia
      dx(1:3) = cross(x(1:3), w)
      do i = 1, size(effects)
         if (effects(i)%name == "drag") then
            dx(1:3) = dx(1:3) - numbers(effects(i)%text, "friction", [0.0_dp, 0.0_dp, 0.0_dp])*w
         else
            dx(1:3) = dx(1:3) + torque_of(effects(i), inertia, t, x(4:7))
         end if
      end do
      where (.not. inertia > 0) dx(1:3) = 0
      dx(4) = -dot_product(x(5:7), w)/2
      dx(5:7) = (x(4)*w + cross(x(5:7), w))/2
   end function slope

   !> Gragg's midpoint rule extrapolated over steps no knot of the tables lies within.
   subroutine reference(effects, body, t0, t1, y, q)
      type(one_effect), intent(in) :: effects(:)
      real(dp), intent(in) :: body(3)
      real(dp), intent(in) :: t0, t1
      real(dp), intent(inout) :: y(3), q(4)
      real(qp) :: long_y(3), long_q(4)
      long_y = y
      long_q = q
      call long_reference(effects, body, t0, t1, long_y, long_q)
      y = real(long_y, dp)
      q = real(long_q, dp)
   end subroutine reference

   subroutine long_reference(effects, body, t0, t1, y, q)
      type(one_effect), intent(in) :: effects(:)
      real(dp), intent(in) :: body(3)
      real(dp), intent(in) :: t0, t1
      real(qp), intent(inout) :: y(3), q(4)
      integer, parameter :: columns = 8
      real(qp) :: x(7), a(7), b(7), c(7), table(7, columns), last(7, columns), h, s, t, inertia(3)
      real(qp) :: stops(5)
      integer :: i, k, n, m, part, parts
      inertia = body
      x = [y, q]
      stops = [real(t0, qp), 0.5_qp*1, real(1.3_dp, qp), real(2.2_dp, qp), real(t1, qp)]
      do part = 1, 4
         parts = 8
         h = (stops(part + 1) - stops(part))/parts
         do m = 1, parts
            t = stops(part) + (m - 1)*h
            do k = 1, columns
               n = 2*k
               s = h/n
               a = x
               b = a + s*slope(effects, inertia, t + 1e-30_qp, a)
               do i = 1, n - 1
                  c = a + 2*s*slope(effects, inertia, t + i*s, b)
                  a = b
                  b = c
               end do
               table(:, 1) = (a + b + s*slope(effects, inertia, t + h, b))/2
               do i = 2, k
                  table(:, i) = table(:, i - 1) + (table(:, i - 1) - last(:, i - 1))/ &
                     ((real(k, qp)/(k - i + 1))**2 - 1)
               end do
               last(:, :k) = table(:, :k)
            end do
            x = table(:, columns)
         end do
      end do
      y = x(1:3)
      q = x(4:7)/sqrt(sum(x(4:7)**2))
   end subroutine long_reference

   ! Runs
   ! ---------------------------------------------------------------------------------------------

   !> A plan of one class with effects.
   subroutine taylor_plan(body, effects, tolerance, plan, problem)
      real(dp), intent(in) :: body(3)
      type(one_effect), intent(in) :: effects(:)
      real(dp), intent(in) :: tolerance
      type(poinsot_plan), intent(out) :: plan
      type(poinsot_error), intent(out) :: problem
      character(20) :: text
      integer :: i, number
      call add_class(plan, body, number, problem)
      do i = 1, size(effects)
         call with_effect(plan, trim(effects(i)%name), trim(effects(i)%text))
      end do
      call set_option(plan, "splitting", "taylor", problem)
      write (text, "(es12.4)") tolerance
      if (.not. raised(problem)) call set_option(plan, "tolerance", trim(adjustl(text)), problem)
      if (.not. raised(problem)) call make_ready(plan, problem)
   end subroutine taylor_plan

   !> Some states, |y| about 1.
   subroutine states(n, y, q)
      integer, intent(in) :: n
      real(dp), allocatable, intent(out) :: y(:, :), q(:, :)
      type(random_stream) :: stream
      integer :: i, j
      allocate (y(3, n), q(4, n))
      stream = start_stream(11)
      do i = 1, n
         do j = 1, 3
            y(j, i) = 2*uniform(stream) - 1
         end do
         q(:, i) = random_quaternion(stream)
      end do
   end subroutine states

   subroutine go(plan, t, h, first, steps, y, q, status, worst)
      type(poinsot_plan), intent(in) :: plan
      real(dp), intent(in) :: t, h
      integer, intent(in) :: first, steps
      real(dp), intent(inout), target :: y(:, :), q(:, :)
      integer, intent(out), target :: status(:)
      integer, intent(out) :: worst
      type(body_view) :: view
      type(poinsot_error) :: problem
      call view_rows(y, q, view)
      view%status => status
      status = 0
      call step_bodies(plan, view, t, h, int(first, i8), int(steps, i8), worst, problem)
   end subroutine go

   !> Largest difference of two sets of states.
   pure real(dp) function apart(y, q, yr, qr)
      real(dp), intent(in) :: y(:, :), q(:, :), yr(:, :), qr(:, :)
      integer :: i
      apart = 0
      do i = 1, size(y, 2)
         apart = max(apart, norm2(y(:, i) - yr(:, i)), 2*min(norm2(q(:, i) - qr(:, i)), &
            norm2(q(:, i) + qr(:, i))))
      end do
   end function apart

   !> Errors of four bodies at t = 3, in two steps, and there and back, at every tolerance.
   subroutine judge(error, body, effects, what)
      type(error_type), allocatable, intent(inout) :: error
      real(dp), intent(in) :: body(3)
      type(one_effect), intent(in) :: effects(:)
      character(*), intent(in) :: what
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      real(dp), allocatable :: y0(:, :), q0(:, :), y(:, :), q(:, :), yr(:, :), qr(:, :)
      real(dp) :: gap, allowed
      integer :: status(4), worst, i, k
      character(12) :: text
      call states(4, y0, q0)
      where (spread(body, 2, 4) <= 0) y0 = 0
      yr = y0
      qr = q0
      do i = 1, 4
         call reference(effects, body, 0.0_dp, 3.0_dp, yr(:, i), qr(:, i))
      end do
      do k = 1, size(tolerances)
         call taylor_plan(body, effects, tolerances(k), plan, problem)
         call expect(error, .not. raised(problem), what//": refused")
         y = y0
         q = q0
         call go(plan, 0.0_dp, 1.5_dp, 0, 2, y, q, status, worst)
         gap = apart(y, q, yr, qr)
         allowed = 30*tolerances(k) + 2e-14_dp
         write (text, "(es9.2)") gap
         call expect(error, worst == poinsot_ok .and. gap <= allowed, what//": error"//text)
         if (any(effects%name == "drag")) cycle
         call go(plan, 3.0_dp, -1.5_dp, 0, 2, y, q, status, worst)
         gap = apart(y, q, y0, q0)
         write (text, "(es9.2)") gap
         call expect(error, worst == poinsot_ok .and. gap <= 2*allowed, what//": back"//text)
      end do
   end subroutine judge

   ! Tests
   ! ---------------------------------------------------------------------------------------------

   subroutine test_effects(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: i
      character(3) :: text
      do i = 1, size(list)
         write (text, "(i3)") i
         call judge(error, moments, list(i:i), trim(list(i)%name)//text)
         if (allocated(error)) return
      end do
      call judge(error, moments, list(1:0), "free")
   end subroutine test_effects

   !> Sums: one, two and three directions, fixed and turning, with all that has no direction.
   subroutine test_sums(error)
      type(error_type), allocatable, intent(out) :: error
      call judge(error, moments, list([1, 2]), "two fields")
      if (.not. allocated(error)) call judge(error, moments, list([1, 2, 3, 7]), "three")
      if (.not. allocated(error)) call judge(error, moments, list([4, 6, 7, 5]), "gradients")
      if (.not. allocated(error)) call judge(error, moments, list([3, 6, 9, 11, 13]), "times")
      if (.not. allocated(error)) call judge(error, moments, list, "all")
      if (.not. allocated(error)) call judge(error, [0.5_dp, 0.9_dp, 0.4_dp], list, "flat")
      if (.not. allocated(error)) call judge(error, [1.0_dp, 1.0_dp, 1.0_dp], list, "sphere")
      if (.not. allocated(error)) call judge(error, [0.7_dp, 0.7_dp, 0.3_dp], list, "symmetric")
   end subroutine test_sums

   !> The reference of cost and choose, in quadruple precision, for every effect: Gragg's rule knows
   !> the torques as formulas, and is right to 1e-19 itself.
   subroutine test_quadruple(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: short(3) = [0.625_dp, 0.875_dp, 1.125_dp]
      integer :: i
      do i = 1, size(unrounded)
         call judge_series(error, short, unrounded(i:i), trim(unrounded(i)%name))
         if (allocated(error)) return
      end do
      call judge_series(error, short, unrounded, "all effects")
      if (.not. allocated(error)) call judge_series(error, [0.5_dp, 0.875_dp, 0.375_dp], &
         unrounded, "flat")
   end subroutine test_quadruple

   subroutine judge_series(error, body, effects, what)
      type(error_type), allocatable, intent(out) :: error
      real(dp), intent(in) :: body(3)
      type(one_effect), intent(in) :: effects(:)
      character(*), intent(in) :: what
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      type(torque_problem), allocatable :: problems(:)
      real(dp), allocatable :: y0(:, :), q0(:, :)
      real(qp) :: t, y(3), q(4), yr(3), qr(4)
      logical :: done
      call states(1, y0, q0)
      call taylor_plan(body, effects, 1e-12_dp, plan, problem)
      if (.not. raised(problem)) call torque_problems(plan, problems, problem)
      call expect(error, .not. raised(problem), what//": "//problem%message)
      if (raised(problem)) return
      y = y0(:, 1)
      q = q0(:, 1)
      yr = y
      qr = q
      call long_reference(effects, body, 0.0_dp, 3.0_dp, yr, qr)
      t = 0
      call turn_under_torque(problems(1), fine, t, 3.0_qp, 1000, y, q, done)
      call expect(error, norm2(y - yr) < 1e-18_qp*norm2(yr) .and. &
         norm2(q - sign(1.0_qp, dot_product(q, qr))*qr) < 1e-18_qp, &
         what//": another motion than by Gragg's rule")
      call turn_under_torque(problems(1), fine, t, 0.0_qp, 1000, y, q, done)
      call expect(error, done .and. norm2(y - y0(:, 1)) < 1e-19_qp*norm2(y), &
         what//": no way back")
      call turn_under_torque(problems(1), fine, t, 3.0_qp, 2, y, q, done)
      call expect(error, .not. done .and. t > 0 .and. t < 3, what//": more steps than allowed")
      call turn_under_torque(problems(1), fine, t, 3.0_qp, 1000, y, q, done)
      call expect(error, done .and. norm2(y - yr) < 1e-18_qp*norm2(yr), &
         what//": it does not go on from where it stopped")
   end subroutine judge_series

   !> The published tops, every row; the first to all its digits.
   subroutine test_tops(error)
      type(error_type), allocatable, intent(out) :: error
      type(top_case), allocatable :: tops(:)
      type(torque_problem), allocatable :: problems(:)
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      character(200) :: text
      real(qp) :: t, y(3), q(4), off, allowed
      integer :: i, number
      logical :: done
      call read_top(tops)
      call expect(error, size(tops) >= 12, "data/top.csv")
      do i = 1, size(tops)
         if (allocated(error)) return
         associate (top => tops(i))
            plan = poinsot_plan()
            call add_class(plan, top%moments, number, problem)
            write (text, "(3(a, es24.16e3, 2(',', es24.16e3)))") "dipole = ", -top%centre, &
               "; strength = ", top%direction
            call with_effect(plan, "field", trim(text))
            call make_ready(plan, problem)
            call torque_problems(plan, problems, problem)
            y = top%y
            q = top%q
            t = 0
            call turn_under_torque(problems(1), fine, t, real(top%t, qp), 1000, y, q, &
               done)
            off = max(norm2(y - top%y_end)/norm2(top%y_end), norm2(q - sign(1.0_qp, &
               dot_product(q, top%q_end))*top%q_end))
            allowed = merge(1e-23_qp, 1e-14_qp, i == 1)
            write (text, "(a, i0, a, es9.2)") "row ", i, " is off by ", off
            call expect(error, .not. raised(problem) .and. done .and. off < allowed, trim(text))
         end associate
      end do
   end subroutine test_tops

   !> Effects are in the frame of the tensor: the same run as by srkn6.
   subroutine test_tensor(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      real(dp), allocatable :: y0(:, :), q0(:, :), y(:, :), q(:, :), yr(:, :), qr(:, :)
      integer :: status(4), worst, number, k, i
      call states(4, y0, q0)
      do k = 1, 2
         plan = poinsot_plan()
         call add_tensor_class(plan, turned_tensor(), number, problem)
         do i = 1, 7
            call with_effect(plan, trim(list(i)%name), trim(list(i)%text))
         end do
         if (k == 1) call set_option(plan, "splitting", "taylor", problem)
         call make_ready(plan, problem)
         call expect(error, .not. raised(problem), "refused")
         y = y0
         q = q0
         if (k == 1) call go(plan, 0.0_dp, 2.0_dp, 0, 1, y, q, status, worst)
         if (k == 2) call go(plan, 0.0_dp, 0.005_dp, 0, 400, y, q, status, worst)
         if (k == 2) exit
         yr = y
         qr = q
      end do
      call expect(error, apart(y, q, yr, qr) < 1e-10_dp, "another motion than by srkn6")
   end subroutine test_tensor

   !> Ten steps are ten calls; one body alone, few and many: the same bits, at every place.
   subroutine test_bits(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      real(dp), allocatable :: y0(:, :), q0(:, :), y(:, :), q(:, :), yr(:, :), qr(:, :)
      integer, parameter :: n = 67
      integer :: status(n), worst, k, i, e
      real(dp), parameter :: some(3) = [1e-3_dp, 1e-9_dp, 1e-14_dp]
      do e = 1, 2
         do k = 1, size(some)
            if (e == 1) call taylor_plan(moments, list(1:1), some(k), plan, problem)
            if (e == 2) call taylor_plan(moments, list, some(k), plan, problem)
            call states(n, y0, q0)
            y0(:, 5) = 0
            y0(:, 9) = 30*y0(:, 9)
            yr = y0
            qr = q0
            call go(plan, 0.1_dp, 0.7_dp, 0, 10, yr, qr, status, worst)
            call expect(error, worst, poinsot_ok, "a body failed")
            y = y0
            q = q0
            do i = 0, 9
               call go(plan, 0.1_dp, 0.7_dp, i, 1, y, q, status, worst)
            end do
            call expect(error, all(y == yr) .and. all(q == qr), "ten calls")
            y = y0(:, n:1:-1)
            q = q0(:, n:1:-1)
            call go(plan, 0.1_dp, 0.7_dp, 0, 10, y, q, status, worst)
            call expect(error, all(y == yr(:, n:1:-1)) .and. all(q == qr(:, n:1:-1)), "places")
            do i = 1, n, 3
               y = y0(:, i:i)
               q = q0(:, i:i)
               call go(plan, 0.1_dp, 0.7_dp, 0, 10, y, q, status(:1), worst)
               call expect(error, all(y(:, 1) == yr(:, i)) .and. all(q(:, 1) == qr(:, i)), "alone")
            end do
         end do
      end do
   end subroutine test_bits

   !> The heavy top at t = 10: rounding alone.
   subroutine test_floor(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      real(dp) :: y(3, 1), q(4, 1)
      real(dp), parameter :: known(3) = [1.922573381663007_dp, 0.7720232344670848_dp, &
         -0.2011054792035490_dp]
      integer :: status(1), worst
      call taylor_plan([0.6_dp, 0.8_dp, 1.0_dp], &
         [one_effect("gravity", "centre = 0, 0, 1")], 1e-15_dp, plan, problem)
      y(:, 1) = [1.8_dp, 0.4_dp, -0.9_dp]
      q(:, 1) = [1, 0, 0, 0]
      call go(plan, 0.0_dp, 10.0_dp, 0, 1, y, q, status, worst)
      call expect(error, norm2(y(:, 1) - known) < 8e-15_dp, "not the published state")
   end subroutine test_floor

   !> Spin along the vertical: the angle about it grows without bound, nothing else moves. A
   !> relative change of omega by x turns the body by x times its angle more: that is the problem's
   !> own conditioning, and errors are measured in it. From 1e-6 on, all in single precision, they
   !> are the rounding of the angle, alike in every substep: 1e-8 of it.
   subroutine test_sleeping(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      real(dp) :: y(3, 1), q(4, 1), angle
      integer :: status(1), worst, k
      do k = 1, size(tolerances)
         call taylor_plan([0.8_dp, 0.8_dp, 0.5_dp], [one_effect("gravity", "centre = 0, 0, 1")], &
            tolerances(k), plan, problem)
         y(:, 1) = [0.0_dp, 0.0_dp, 3.0_dp]
         q(:, 1) = [1, 0, 0, 0]
         call go(plan, 0.0_dp, 100.0_dp, 0, 2, y, q, status, worst)
         angle = 600
         call expect(error, worst == poinsot_ok .and. abs(norm2(q) - 1) < 4e-16_dp .and. &
            abs(y(3, 1) - 3) <= 0 .and. hypot(q(1, 1) - cos(angle), q(4, 1) - sin(angle)) < &
            angle*(tolerances(k)/50 + epsilon(1.0_dp)), "it does not sleep")
      end do
   end subroutine test_sleeping

   !> A pendulum let go near the top, at rest: it falls as the elliptic integral says, E is kept.
   subroutine test_separatrix(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      real(dp) :: y(3, 1), q(4, 1), angle, energy
      integer :: status(1), worst
      call taylor_plan([1.0_dp, 0.7_dp, 0.6_dp], [one_effect("gravity", "centre = 0, 0, 1")], &
         1e-13_dp, plan, problem)
      angle = 1e-6_dp
      y = 0
      q(:, 1) = [cos(angle/2), sin(angle/2), 0.0_dp, 0.0_dp]
      call go(plan, 0.0_dp, 12.0_dp, 0, 1, y, q, status, worst)
      energy = y(1, 1)**2/2 - 2*(sin(acos(-1.0_dp)/2)**2)*(q(2, 1)**2 + q(3, 1)**2) + &
         2*sin(angle/2)**2
      call expect(error, worst == poinsot_ok .and. abs(energy) < 1e-12_dp .and. &
         maxval(abs(y(2:3, 1))) <= 0, "energy at the separatrix")
   end subroutine test_separatrix

   !> Nearly linear bodies need nothing more; a linear one takes no torque about its axis.
   subroutine test_thin(error)
      type(error_type), allocatable, intent(out) :: error
      call judge(error, [1.0_dp, 0.0_dp, 1.0_dp], list([1, 3, 5, 7, 8]), "linear")
      if (.not. allocated(error)) call judge_thin(error, 1e-3_dp)
      if (.not. allocated(error)) call judge_thin(error, 1e-10_dp)
   end subroutine test_thin

   !> A thin body with little momentum about its axis, under a torque across it, is as a linear one.
   subroutine judge_thin(error, thin)
      type(error_type), allocatable, intent(inout) :: error
      real(dp), intent(in) :: thin
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      real(dp), allocatable :: y(:, :), q(:, :), yr(:, :), qr(:, :)
      type(one_effect) :: fall(1)
      integer :: status(4), worst, i
      fall = one_effect("gravity", "centre = 0, 0, 0.7; up = 0, 0.6, 0.8")
      call states(4, y, q)
      y(3, :) = y(3, :)*thin
      yr = y
      qr = q
      call taylor_plan([0.9_dp, 0.9_dp, thin], fall, 1e-13_dp, plan, problem)
      call go(plan, 0.0_dp, 3.0_dp, 0, 1, y, q, status, worst)
      do i = 1, 4
         call reference(fall, [0.9_dp, 0.9_dp, thin], 0.0_dp, 3.0_dp, yr(:, i), qr(:, i))
      end do
      call expect(error, worst == poinsot_ok .and. apart(y, q, yr, qr) < 2e-13_dp, "a thin body")
   end subroutine judge_thin

   !> SI units of molecules, 1e70, 1e-70: powers of two change nothing, others rounding alone.
   subroutine test_units(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      real(dp), allocatable :: y0(:, :), q0(:, :), y(:, :), q(:, :), yr(:, :), qr(:, :)
      real(dp) :: mass, rate
      integer, parameter :: masses(6) = [-152, 200, -400, 0, 0, 100]
      integer, parameter :: rates(6) = [40, 20, -50, 220, -230, -100]
      character(100) :: text
      integer :: status(6), worst, i
      call states(6, y0, q0)
      do i = 0, size(masses)
         mass = 1
         rate = 1
         if (i > 0) mass = 2.0_dp**masses(i)
         if (i > 0) rate = 2.0_dp**rates(i)
         write (text, "(a, es24.16e3)") "centre = 0.3, -0.4, 0.9; up = 0.3, 0.5, 0.8; weight = ", &
            mass*rate**2
         call taylor_plan(mass*moments, [one_effect("gravity", text)], 1e-12_dp, plan, problem)
         y = mass*rate*y0
         q = q0
         call go(plan, 0.0_dp, 5/rate, 0, 1, y, q, status, worst)
         y = y/(mass*rate)
         if (i == 0) then
            yr = y
            qr = q
         end if
         call expect(error, worst == poinsot_ok .and. all(y == yr) .and. all(q == qr), "units")
      end do
   end subroutine test_units

   !> Too fast, too many substeps: a status and the state of entry; the others do not notice.
   subroutine test_limits(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      real(dp), allocatable :: y0(:, :), q0(:, :), y(:, :), q(:, :), yr(:, :), qr(:, :)
      integer :: status(20), worst
      call states(20, y0, q0)
      call taylor_plan(moments, list(1:1), 1e-12_dp, plan, problem)
      yr = y0
      qr = q0
      call go(plan, 0.0_dp, 3.0_dp, 0, 2, yr, qr, status, worst)
      y0(:, 7) = 1e40_dp*y0(:, 7)
      y0(:, 8) = 1e80_dp*y0(:, 8)
      y = y0
      q = q0
      call go(plan, 0.0_dp, 3.0_dp, 0, 2, y, q, status, worst)
      call expect(error, status(7) == poinsot_e_step .and. status(8) == poinsot_e_domain .and. &
         count(status /= poinsot_ok) == 2, "statuses")
      call expect(error, all(y(:, 7:8) == y0(:, 7:8)) .and. all(q(:, 7:8) == q0(:, 7:8)), "kept")
      call expect(error, all(y(:, 9:) == yr(:, 9:)) .and. all(y(:, :6) == yr(:, :6)), "others")
      call taylor_plan(moments, [one_effect("gravity", "centre = 0, 0, 1; weight = 1e290")], &
         1e-12_dp, plan, problem)
      y = y0
      q = q0
      call go(plan, 0.0_dp, 1.0_dp, 0, 1, y, q, status, worst)
      call expect(error, all(status == poinsot_e_domain) .and. all(y == y0), "too strong")
   end subroutine test_limits

   subroutine test_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      character(8), parameter :: wrong(4) = [character(8) :: "1e-16", "0.02", "nan", "1e-6 x"]
      real(dp), allocatable :: kick(:), drift(:)
      integer :: i
      do i = 1, size(wrong)
         problem = poinsot_error()
         call set_option(plan, "tolerance", wrong(i), problem)
         call expect(error, problem%code, poinsot_e_domain, "tolerance "//wrong(i))
      end do
      call taylor_plan(moments, [one_effect("langevin", "friction = 0.1; temperature = 0.3")], &
         1e-12_dp, plan, problem)
      call expect(error, problem%code == poinsot_e_method .and. &
         index(problem%message, "langevin") > 0, "noise is taken")
      problem = poinsot_error()
      call splitting_flows("taylor", kick, drift, problem)
      call expect(error, problem%code, poinsot_e_method, "flows of taylor")
   end subroutine test_refusals

   !> Rows along one direction span one; small differences count.
   subroutine test_rank(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: basis(3, 3), rows(3, 3), gram(3, 3)
      real(dp), parameter :: e(3) = [0.36_dp, 0.48_dp, 0.8_dp]
      integer :: n, i
      n = 0
      rows = spread(e, 2, 3)*spread([1.0_dp, -3.0_dp, 1e-9_dp], 1, 3)
      call span_rows(rows, basis, n)
      call expect(error, n == 1 .and. abs(abs(dot_product(basis(:, 1), e)) - 1) < 1e-15_dp, "one")
      rows(2, 2) = rows(2, 2) + 1e-11_dp
      n = 0
      call span_rows(rows, basis, n)
      call expect(error, n, 2, "two")
      rows(1, 3) = 1e-3_dp
      n = 0
      call span_rows(rows, basis, n)
      gram = matmul(transpose(basis), basis)
      do i = 1, 3
         gram(i, i) = gram(i, i) - 1
      end do
      call expect(error, n == 3 .and. maxval(abs(gram)) < 1e-15_dp, "three")
   end subroutine test_rank

end module test_taylor
