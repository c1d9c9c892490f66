!> Room ensemble: a body's bits depend on nothing but the body, its class and the step.
module test_ensemble_bits
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_round_type, &
      ieee_get_rounding_mode, ieee_set_rounding_mode, ieee_up, ieee_down, ieee_to_zero
   use testdrive, only: unittest_type, new_unittest, error_type
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_partial, poinsot_e_step, &
      poinsot_e_not_finite, poinsot_e_not_unit
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_system, only: torque_callback
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_effect, set_option
   use poinsot_ensemble_rotate, only: rotate_bodies, threads_for
   use poinsot_ensemble_bodies, only: column
   use poinsot_ensemble_drive, only: team_size
   use poinsot_ensemble_observe, only: body_energies
   use poinsot_ensemble_step, only: drift_bodies, kick_bodies, step_bodies
   use poinsot_free_method, only: method_count, method_name, free_method, find_method
   use poinsot_effect_settings, only: number_setting
   use test_bodies, only: random_quaternion, random_stream, start_stream, uniform
   use test_crowd, only: crowd, make_crowd, mixed_plan, plain_plan, with_effect, &
      class_count, same_bits
   use test_expectation, only: expect
   implicit none(type, external)
   private
   public :: collect_bits

   !> A torque that depends on the attitude, differently for each component.
   type, extends(torque_callback) :: swirl
   contains
      procedure :: evaluate => evaluate_swirl
   end type swirl

   real(dp), parameter :: h = 0.05_dp

contains

   subroutine collect_bits(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("bits-threads", test_threads), &
         new_unittest("bits-place", test_place), &
         new_unittest("bits-one-in-a-hundred-thousand", test_one), &
         new_unittest("bits-steps", test_steps), &
         new_unittest("bits-callback", test_callback), &
         new_unittest("bits-no-effect-is-the-rotor", test_bare), &
         new_unittest("bits-failed-bodies", test_failed_bodies), &
         new_unittest("bits-inside-a-parallel-region", test_nested), &
         new_unittest("bits-of-rotors-in-other-units", test_units), &
         new_unittest("bits-thermostat-by-id", test_ids), &
         new_unittest("threads-that-start", test_team), &
         new_unittest("rounding-mode-of-the-host", test_rounding), &
         new_unittest("rounding-mode-of-one-thread", test_rounding_of_one)]
   end subroutine collect_bits

   !> Gravity on one class, drag on all, so that schemes differ between classes.
   subroutine busy_plan(method, threads, plan)
      character(*), intent(in) :: method
      integer, intent(in) :: threads
      type(poinsot_plan), intent(out) :: plan
      type(poinsot_error) :: problem
      character(4) :: number
      call mixed_plan(plan)
      call with_effect(plan, "gravity", "centre = 0.1, 0.2, 1; class = 2")
      call with_effect(plan, "gravity", "centre = 0.1, 0.2, 1; class = 9")
      call set_option(plan, "method", method, problem)
      write (number, "(i0)") threads
      call set_option(plan, "threads", trim(number), problem)
      call make_ready(plan, problem)
      if (raised(problem)) error stop "busy_plan"
   end subroutine busy_plan

   !> Units of mass length^2 and of time that are powers of two: moments, momenta, rotor and step in
   !> them give the same bits, for every length of a rotor.
   subroutine test_units(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: mass(4) = [0, -37, 5, 0], time(4) = [0, 0, 11, -64]
      type(random_stream) :: stream
      real(dp) :: part(3), moments(3), rotor(3), y(3), q(4), first(7), now(7)
      integer :: k, j, unit
      stream = start_stream(77)
      do k = 1, 300
         do j = 1, 3
            part(j) = 0.1_dp + uniform(stream)
            rotor(j) = 2*uniform(stream) - 1
            y(j) = 2*uniform(stream) - 1
         end do
         moments = sum(part) - part
         q = random_quaternion(stream)
         do unit = 1, size(mass)
            now = turned(scale(moments, mass(unit)), scale(rotor, mass(unit) - time(unit)), &
                         scale(y, mass(unit) - time(unit)), q, scale(0.3_dp, time(unit)))
            now(:3) = scale(now(:3), time(unit) - mass(unit))
            if (unit == 1) first = now
            call expect(error, all(abs(now - first) <= 0), "other units, other bits")
         end do
      end do
   contains
      function turned(moments, rotor, y, q, h) result(state)
         real(dp), intent(in) :: moments(3), rotor(3), y(3), q(4), h
         real(dp) :: state(7)
         real(dp), target :: ys(3, 1), qs(4, 1)
         type(poinsot_plan) :: plan
         type(body_view) :: view
         type(poinsot_error) :: problem
         integer :: number, status
         call add_class(plan, moments, number, problem)
         call add_effect(plan, "gyrostat", [number_setting("rotor", rotor)], problem)
         call make_ready(plan, problem)
         ys(:, 1) = y
         qs(:, 1) = q
         call view_rows(ys, qs, view)
         call drift_bodies(plan, view, h, status, problem)
         if (raised(problem) .or. status /= poinsot_ok) error stop "test_units"
         state = [ys(:, 1), qs(:, 1)]
      end function turned
   end subroutine test_units

   !> 20 ms of work where nobody says how many; 0.2 ms for each thread.
   subroutine test_team(error)
      type(error_type), allocatable, intent(out) :: error
      call expect(error, threads_for(0, 1.9e7_dp) == 1 .and. threads_for(0, 2.1e7_dp) == 0 .and. &
         threads_for(2, 1.0_dp) == 2, "20 ms")
      call expect(error, team_size(4, 0.0_dp) == 1 .and. team_size(4, 3.9e5_dp) == 1 .and. &
         team_size(4, 6.1e5_dp) == 3 .and. team_size(4, 1e300_dp) == 4, "0.2 ms each")
   end subroutine test_team

   !> While the thread rounds otherwise than to nearest every call refuses its bodies, and leaves
   !> them; but those that are skipped. Afterwards the bits of before.
   subroutine test_rounding(error)
      type(error_type), allocatable, intent(out) :: error
      type(ieee_round_type), parameter :: modes(3) = [ieee_up, ieee_down, ieee_to_zero]
      type(crowd), target :: start, after
      type(poinsot_plan), target :: plan
      type(body_view) :: view
      type(ieee_round_type) :: usual
      integer, target :: each(400)
      integer :: i, call_of, status
      logical :: right
      call make_crowd(size(each), start)
      start%class(7) = -1
      call busy_plan("exact", 1, plan)
      call ieee_get_rounding_mode(usual)
      do i = 1, size(modes)
         do call_of = 1, 6
            after = start
            call open(after, view)
            each = poinsot_ok
            view%status => each
            call ieee_set_rounding_mode(modes(i))
            call one_call(call_of, plan, view, status)
            call ieee_set_rounding_mode(usual)
            right = status == poinsot_e_partial .and. each(7) == poinsot_ok .and. &
               count(each == poinsot_e_domain) == size(each) - 1
            call expect(error, right, "a call that rounds otherwise is not refused")
            call compare_if_none(error, start, after, "bodies that were refused have changed")
         end do
      end do
   end subroutine test_rounding

   subroutine compare_if_none(error, a, b, what)
      type(error_type), allocatable, intent(inout) :: error
      type(crowd), intent(in) :: a, b
      character(*), intent(in) :: what
      call expect(error, same_bits(a%y, b%y) .and. same_bits(a%q, b%q), what)
   end subroutine compare_if_none

   !> Each of the calls that turn a state into another.
   subroutine one_call(i, plan, view, status)
      integer, intent(in) :: i
      type(poinsot_plan), intent(in), target :: plan
      type(body_view), intent(in) :: view
      integer, intent(out) :: status
      type(swirl), target :: callback
      type(free_method) :: method
      type(column) :: torque(3)
      type(poinsot_error) :: problem
      real(dp), target :: g(view%n), u(view%n)
      g = 1
      select case (i)
      case (1)
         call drift_bodies(plan, view, h, status, problem)
      case (2)
         torque(1)%of => g
         torque(2)%of => g
         torque(3)%of => g
         call kick_bodies(plan, view, h, torque, status, problem)
      case (3)
         call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem)
      case (4)
         call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem, callback)
      case (5)
         call body_energies(plan, view, 0.0_dp, g, u, status, problem)
      case default
         call find_method("exact", method, problem)
         call rotate_bodies(plan%classes(1)%it, method, h, 1, view, 1, status, problem)
      end select
   end subroutine one_call

   !> Of two threads one rounds up: its bodies are refused, those of the other have their bits.
   subroutine test_rounding_of_one(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, right, half
      type(poinsot_plan), target :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      type(ieee_round_type) :: usual
      type(swirl), target :: callback
      integer, target :: each(3000)
      integer :: i, status, refused
      logical :: whole
      call make_crowd(size(each), start)
      call busy_plan("exact", 2, plan)
      call ieee_get_rounding_mode(usual)
      right = start
      call open(right, view)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem)
      half = start
      call open(half, view)
      view%status => each
      call set_mode_of_last_thread(ieee_up)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem)
      call set_mode_of_last_thread(usual)
      refused = count(each == poinsot_e_domain)
      whole = .true.
      do i = 1, size(each)
         if (each(i) == poinsot_ok) whole = whole .and. all(right%y(:, i) == half%y(:, i))
         if (each(i) /= poinsot_ok) whole = whole .and. all(start%y(:, i) == half%y(:, i))
      end do
      call expect(error, whole, "a body that is neither right nor refused")
      !$ call expect(error, refused > 0 .and. refused < size(each), "one thread's bodies")
      half = start
      call open(half, view)
      view%status => each
      call set_mode_of_last_thread(ieee_up)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem, callback)
      call set_mode_of_last_thread(usual)
      !$ call expect(error, any(each == poinsot_e_domain), "one thread's bodies, coupled")
   end subroutine test_rounding_of_one

   subroutine set_mode_of_last_thread(mode)
      type(ieee_round_type), intent(in) :: mode
      !$ integer :: i
      !$omp parallel do num_threads(2) schedule(static) default(none) shared(mode) private(i)
      !$ do i = 1, 2
      !$    if (i == 2) call ieee_set_rounding_mode(mode)
      !$ end do
      !$omp end parallel do
   end subroutine set_mode_of_last_thread

   subroutine open(it, view)
      type(crowd), intent(in), target :: it
      type(body_view), intent(out) :: view
      call view_rows(it%y, it%q, view)
      view%body_class => it%class
   end subroutine open

   subroutine compare(error, a, b, what)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), intent(in) :: a, b
      character(*), intent(in) :: what
      call expect(error, same_bits(a%y, b%y) .and. same_bits(a%q, b%q), what)
   end subroutine compare

   !> The same bits by one, two and three threads, for every method.
   subroutine test_threads(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, one, many
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer :: m, threads, status
      call make_crowd(3000, start)
      do m = 1, method_count()
         do threads = 1, 3
            call busy_plan(method_name(m), threads, plan)
            many = start
            call open(many, view)
            call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem)
            call expect(error, status, poinsot_ok, method_name(m)//": some failed")
            if (threads == 1) one = many
            call compare(error, one, many, method_name(m)//": bits depend on threads")
            if (allocated(error)) return
         end do
      end do
   end subroutine test_threads

   !> Classes mixed, sorted by class, in reverse, and one by one.
   subroutine test_place(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, mixed, sorted, alone
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer, allocatable :: places(:)
      integer :: i, m, status
      call make_crowd(700, start)
      do m = 1, method_count()
         call busy_plan(method_name(m), 1, plan)
         mixed = start
         call open(mixed, view)
         call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem)
         places = order_by_class(start)
         sorted = taken(start, places)
         call open(sorted, view)
         call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem)
         call compare(error, sorted, taken(mixed, places), method_name(m)//": sorted by class")
         if (allocated(error)) return
         do i = 1, start%n, 97
            alone = taken(start, [i])
            call open(alone, view)
            call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem)
            call compare(error, alone, taken(mixed, [i]), method_name(m)//": alone")
            if (allocated(error)) return
         end do
      end do
   end subroutine test_place

   pure function order_by_class(it) result(places)
      type(crowd), intent(in) :: it
      integer, allocatable :: places(:)
      integer :: c, i
      allocate (places(0))
      do c = class_count, 1, -1
         places = [places, pack([(i, i=1, it%n)], it%class == c)]
      end do
   end function order_by_class

   pure function taken(it, places) result(some)
      type(crowd), intent(in) :: it
      integer, intent(in) :: places(:)
      type(crowd) :: some
      some%n = size(places)
      some%y = it%y(:, places)
      some%q = it%q(:, places)
      some%class = it%class(places)
   end function taken

   !> n = 1 equals its place in 10^5.
   subroutine test_one(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, all, alone
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer :: i, status
      call make_crowd(100000, start)
      call busy_plan("exact", 2, plan)
      all = start
      call open(all, view)
      call drift_bodies(plan, view, h, status, problem)
      do i = 1, start%n, 9973
         alone = taken(start, [i])
         call open(alone, view)
         call drift_bodies(plan, view, h, status, problem)
         call compare(error, alone, taken(all, [i]), "one in a hundred thousand")
         if (allocated(error)) return
      end do
   end subroutine test_one

   !> Ten steps are ten steps of one, with effects, with and without compensated sums, for every
   !> splitting's ends.
   subroutine test_steps(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, at_once, one_by_one
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), allocatable, target :: carry(:, :, :)
      integer :: k, m, status
      logical :: compensated
      call make_crowd(200, start)
      where (start%class == class_count) start%class = 1 ! a tensor class turns frames at the
                                                         ! border, which rounds
      allocate (carry(7, start%n, 2))
      do m = 0, 2*method_count() - 1
         compensated = mod(m, 2) == 1
         carry = 0
         call busy_plan(method_name(1 + m/2), 1, plan)
         at_once = start
         call open(at_once, view)
         if (compensated) view%carry => carry(:, :, 1)
         call step_bodies(plan, view, 0.5_dp, h, 3_i8, 10_i8, status, problem)
         one_by_one = start
         call open(one_by_one, view)
         if (compensated) view%carry => carry(:, :, 2)
         do k = 3, 12
            call step_bodies(plan, view, 0.5_dp, h, int(k, i8), 1_i8, status, problem)
         end do
         call compare(error, at_once, one_by_one, method_name(1 + m/2)//": ten at once")
         if (allocated(error)) return
         call expect(error, same_bits(carry(:, :, 1), carry(:, :, 2)), method_name(1 + m/2)// &
            ": carries of ten at once")
         call expect(error, (maxval(abs(carry)) > 0) .eqv. compensated, "carries in use")
      end do
   end subroutine test_steps

   subroutine evaluate_swirl(self, t, q, torque, energy, stop)
      class(swirl), intent(inout) :: self
      real(dp), intent(in) :: t
      real(dp), intent(in), target :: q(:, :)
      real(dp), intent(inout), target :: torque(:, :)
      real(dp), intent(inout) :: energy
      logical, intent(inout) :: stop
      torque(:, 1) = q(:, 1)*q(:, 2) + t
      torque(:, 2) = q(:, 3)
      torque(:, 3) = -q(:, 2)*q(:, 4)
      energy = 0
      stop = .false.
      associate (unused => self)
      end associate
   end subroutine evaluate_swirl

   !> With a callback too: steps and threads.
   subroutine test_callback(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, at_once, one_by_one
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      type(swirl) :: host
      integer :: k, status
      call make_crowd(600, start)
      where (start%class == class_count) start%class = 1
      call busy_plan("exact", 1, plan)
      at_once = start
      call open(at_once, view)
      call step_bodies(plan, view, 0.5_dp, h, 0_i8, 5_i8, status, problem, host)
      call expect(error, status, poinsot_ok, "steps with a callback")
      call busy_plan("exact", 3, plan)
      one_by_one = start
      call open(one_by_one, view)
      do k = 0, 4
         call step_bodies(plan, view, 0.5_dp, h, int(k, i8), 1_i8, status, problem, host)
      end do
      call compare(error, at_once, one_by_one, "five at once, by one and by three threads")
   end subroutine test_callback

   !> A plan without effects steps as it drifts, and as poinsot_rotate does.
   subroutine test_bare(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, stepped, drifted, rotated
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer :: k, status
      call make_crowd(300, start)
      start%class = 1
      call plain_plan([0.6_dp, 0.8_dp, 1.0_dp], "native", plan)
      stepped = start
      call open(stepped, view)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 7_i8, status, problem)
      drifted = start
      call open(drifted, view)
      do k = 1, 7
         call drift_bodies(plan, view, h, status, problem)
      end do
      rotated = start
      call open(rotated, view)
      call rotate_bodies(plan%classes(1)%it, plan%method, h, 7, view, 0, status, problem)
      call compare(error, stepped, drifted, "step and drift")
      if (allocated(error)) return
      call compare(error, stepped, rotated, "step and rotate")
   end subroutine test_bare

   !> Bodies that fail keep their state and get a status; the others do not notice.
   subroutine test_failed_bodies(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, healthy, ill
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer, allocatable, target :: each(:)
      integer :: failures(6), causes(6), i, status
      call make_crowd(300, start)
      start%class = min(start%class, 7)
      failures = [3, 40, 41, 100, 150, 299]
      causes = [poinsot_e_not_finite, poinsot_e_not_unit, poinsot_e_not_unit, poinsot_e_step, &
                poinsot_e_domain, poinsot_e_domain]
      allocate (each(300))
      call busy_plan("dmv8", 1, plan)
      healthy = start
      call open(healthy, view)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 3_i8, status, problem)
      ill = start
      ill%y(2, 3) = ieee_value(1.0_dp, ieee_quiet_nan)
      ill%q(:, 40) = 0
      ill%q(:, 41) = 2*ill%q(:, 41)
      ill%y(:, 100) = 1e3_dp    ! a step too long for the method
      ill%class(150) = 99
      ill%y(1, 299) = 1e300_dp
      start = ill
      call open(ill, view)
      view%status => each
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 3_i8, status, problem)
      call expect(error, status, poinsot_e_partial, "some fail")
      do i = 1, start%n
         if (any(failures == i)) then
            call expect(error, each(i), causes(findloc(failures, i, 1)), &
               "status of a body that fails")
            call compare(error, taken(ill, [i]), taken(start, [i]), &
               "a body that fails keeps its state")
         else
            call expect(error, each(i), poinsot_ok, "status of a good body")
            call compare(error, taken(ill, [i]), taken(healthy, [i]), "a neighbour noticed")
         end if
         if (allocated(error)) return
      end do
   end subroutine test_failed_bodies

   !> Called from inside somebody's parallel region.
   subroutine test_nested(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, outside
      type(crowd), target :: inside(3)
      type(poinsot_plan) :: plan
      integer :: k
      call make_crowd(1000, start)
      call busy_plan("exact", 2, plan)
      outside = start
      call two_steps(plan, outside)
      inside = start
      !$omp parallel do num_threads(3)
      do k = 1, 3
         call two_steps(plan, inside(k))
      end do
      !$omp end parallel do
      do k = 1, 3
         call compare(error, inside(k), outside, "inside a parallel region")
         if (allocated(error)) return
      end do
   end subroutine test_nested

   subroutine two_steps(plan, it)
      type(poinsot_plan), intent(in), target :: plan
      type(crowd), intent(inout), target :: it
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer :: status
      call open(it, view)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem)
   end subroutine two_steps

   !> Noise belongs to the body's id, wherever it stands.
   subroutine test_ids(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, forward, back
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer(i8), allocatable, target :: ids(:)
      integer, allocatable :: reversed(:)
      integer :: i, status
      call make_crowd(300, start)
      call mixed_plan(plan)
      call with_effect(plan, "langevin", "friction = 1; temperature = 0.5")
      call set_option(plan, "seed", "12345678901234", problem)
      call make_ready(plan, problem)
      call expect(error, .not. raised(problem), "a plan with a thermostat")
      ids = [(int(i, i8)*1000003_i8, i=1, start%n)]
      reversed = [(i, i=start%n, 1, -1)]
      forward = start
      call open(forward, view)
      view%id => ids
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 3_i8, status, problem)
      call expect(error, status, poinsot_ok, "steps with a thermostat")
      ids = ids(reversed)
      back = taken(start, reversed)
      call open(back, view)
      view%id => ids
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 3_i8, status, problem)
      call compare(error, back, taken(forward, reversed), "noise by id")
      if (allocated(error)) return
      call expect(error, .not. same_bits(forward%y, start%y), "there is noise")
   end subroutine test_ids

end module test_ensemble_bits
