!> Faults in the middle: a body that fails among many, a callback that stops, states that are none.
module test_hard_faults
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_partial, &
      poinsot_e_callback, poinsot_e_not_finite, poinsot_e_not_unit, poinsot_e_axis_momentum
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_system, only: torque_callback
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, set_option
   use poinsot_ensemble_step, only: step_bodies, kick_bodies
   use poinsot_free_method, only: method_count, method_name
   use poinsot_splitting_registry, only: is_table, splitting_count, splitting_name
   use test_crowd, only: crowd, make_crowd, mixed_plan, with_effect, same_bits
   use test_expectation, only: expect
   use test_free_tools, only: text
   implicit none(type, external)
   private
   public :: collect_hard_faults, collect_hard_faults_deep

   !> Torques that depend on the attitude; from call number `last` on it stops, and the body `ill`
   !> gets a torque that is no number in every call.
   type, extends(torque_callback) :: moody
      integer :: calls = 0, last = huge(0), ill = 0
   contains
      procedure :: evaluate => evaluate_moody
   end type moody

   real(dp), parameter :: h = 0.05_dp

contains

   subroutine collect_hard_faults(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("one-fails-of-many", test_one_of_many), &
         new_unittest("one-torque-is-no-number", test_one_torque), &
         new_unittest("callback-stops-at-every-call", test_stop_anywhere), &
         new_unittest("carry-that-is-none", test_carry), &
         new_unittest("kick-out-of-range", test_kick_range), &
         new_unittest("quaternions-off-norm", test_norms), &
         new_unittest("four-thousand-threads", test_threads), &
         new_unittest("no-bodies-many-steps", test_none)]
   end subroutine collect_hard_faults

   subroutine collect_hard_faults_deep(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [new_unittest("one-fails-of-a-million", test_one_of_a_million)]
   end subroutine collect_hard_faults_deep

   subroutine evaluate_moody(self, t, q, torque, energy, stop)
      class(moody), intent(inout) :: self
      real(dp), intent(in) :: t
      real(dp), intent(in), target :: q(:, :)
      real(dp), intent(inout), target :: torque(:, :)
      real(dp), intent(inout) :: energy
      logical, intent(inout) :: stop
      self%calls = self%calls + 1
      torque(:, 1) = q(:, 2) + 0.1_dp*t
      torque(:, 2) = 0.3_dp*q(:, 1)*q(:, 4)
      energy = 0
      if (self%ill > 0) torque(self%ill, 2) = ieee_value(1.0_dp, ieee_quiet_nan)
      stop = self%calls >= self%last
   end subroutine evaluate_moody

   subroutine open(it, view)
      type(crowd), intent(in), target :: it
      type(body_view), intent(out) :: view
      call view_rows(it%y, it%q, view)
      view%body_class => it%class
   end subroutine open

   !> A plan of nine classes with gravity on two of them.
   subroutine some_plan(method, scheme, plan)
      character(*), intent(in) :: method, scheme
      type(poinsot_plan), intent(out) :: plan
      type(poinsot_error) :: problem
      call mixed_plan(plan)
      call with_effect(plan, "gravity", "centre = 0.1, 0.2, 1; class = 2")
      call set_option(plan, "method", method, problem)
      call set_option(plan, "splitting", scheme, problem)
      call make_ready(plan, problem)
      if (raised(problem)) error stop "some_plan"
   end subroutine some_plan

   !> All but body i.
   function without(it, i) result(rest)
      type(crowd), intent(in) :: it
      integer, intent(in) :: i
      type(crowd) :: rest
      integer :: k
      integer, allocatable :: places(:)
      places = [(k, k=1, i - 1), (k, k=i + 1, it%n)]
      rest%n = it%n - 1
      rest%y = it%y(:, places)
      rest%q = it%q(:, places)
      rest%class = it%class(places)
   end function without

   subroutine test_one_of_many(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: m
      call fail_one(error, 100000, "exact")
      do m = 2, method_count()
         if (.not. allocated(error)) call fail_one(error, 700, method_name(m))
      end do
   end subroutine test_one_of_many

   subroutine test_one_of_a_million(error)
      type(error_type), allocatable, intent(out) :: error
      call fail_one(error, 1000000, "exact")
      if (.not. allocated(error)) call fail_one(error, 1000000, "dmv8")
   end subroutine test_one_of_a_million

   !> One body of n fails in each of several ways: the others have the bits of a run without it.
   subroutine fail_one(error, n, method)
      type(error_type), allocatable, intent(inout) :: error
      integer, intent(in) :: n
      character(*), intent(in) :: method
      type(crowd), target :: start, all, rest
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer, allocatable, target :: each(:)
      integer :: approach, ill, status
      integer, parameter :: causes(6) = [poinsot_e_not_finite, poinsot_e_not_unit, &
         poinsot_e_not_finite, poinsot_e_domain, poinsot_e_axis_momentum, poinsot_e_domain]
      call some_plan(method, "srkn6", plan)
      ill = n/2 + 7
      allocate (each(n))
      call make_crowd(n, start)
      start%class(ill) = 1
      rest = without(start, ill)
      call open(rest, view)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem)
      call expect(error, status, poinsot_ok, method//": some fail without a reason")
      do approach = 1, merge(2, 6, n > 1000)
         if (allocated(error)) return
         all = start
         select case (approach)
         case (1)
            all%y(2, ill) = ieee_value(1.0_dp, ieee_quiet_nan)
         case (2)
            all%q(:, ill) = 0
         case (3)
            all%q(1, ill) = ieee_value(1.0_dp, ieee_positive_inf)
         case (4)
            all%y(:, ill) = 1e90_dp
         case (5)
            all%class(ill) = 8 ! linear, with momentum about its axis
            all%y(3, ill) = 0.5_dp
         case default
            all%class(ill) = 99
         end select
         call open(all, view)
         view%status => each
         call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem)
         call expect(error, status == poinsot_e_partial .and. each(ill) == causes(approach) .and. &
            count(each /= poinsot_ok) == 1, method//": not one of the bodies fails")
         call expect(error, same_bits(rest%y, without_columns(all%y, ill)) .and. &
            same_bits(rest%q, without_columns(all%q, ill)), method//": the others noticed")
      end do
   end subroutine fail_one

   function without_columns(x, i) result(rest)
      real(dp), intent(in) :: x(:, :)
      integer, intent(in) :: i
      real(dp), allocatable :: rest(:, :)
      allocate (rest(size(x, 1), size(x, 2) - 1))
      rest(:, :i - 1) = x(:, :i - 1)
      rest(:, i:) = x(:, i + 1:)
   end function without_columns

   !> The callback gives one body a torque that is no number.
   subroutine test_one_torque(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, all, well
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      type(moody) :: host
      integer, target :: each(500)
      integer :: status
      call make_crowd(500, start)
      call some_plan("exact", "srkn4", plan)
      well = start
      call open(well, view)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 3_i8, status, problem, host)
      all = start
      call open(all, view)
      view%status => each
      host = moody(ill=321)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 3_i8, status, problem, host)
      call expect(error, status == poinsot_e_partial .and. each(321) == poinsot_e_not_finite &
         .and. count(each /= poinsot_ok) == 1, &
         "one torque is no number, one body should fail")
      call expect(error, all_but(all%y, well%y, 321) .and. all_but(all%q, well%q, 321), &
         "the others noticed")
      call expect(error, same_bits(all%y(:, [321]), start%y(:, [321])) .and. same_bits(all%q(:, &
         [321]), start%q(:, [321])), &
         "the body that failed has not the state of before")
   end subroutine test_one_torque

   logical function all_but(a, b, i)
      real(dp), intent(in) :: a(:, :), b(:, :)
      integer, intent(in) :: i
      all_but = same_bits(a(:, :i - 1), b(:, :i - 1)) .and. same_bits(a(:, i + 1:), b(:, i + 1:))
   end function all_but

   !> For every splitting: the callback stops at each of its calls in turn; the state is that of the
   !> last whole step, to the bit.
   subroutine test_stop_anywhere(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, stopped, whole
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      type(moody) :: host
      integer :: i, k, steps, status, total(0:3)
      call make_crowd(40, start)
      do i = 1, splitting_count()
         if (.not. is_table(i)) cycle
         if (splitting_name(i) == "chin4" .or. index(splitting_name(i), "omelyan") > 0) cycle
         call some_plan("dmv8", splitting_name(i), plan)
         do steps = 0, 3
            whole = start
            call open(whole, view)
            host = moody()
            call step_bodies(plan, view, 0.0_dp, h, 0_i8, int(steps, i8), status, problem, host)
            total(steps) = host%calls
         end do
         do k = 1, total(3)
            stopped = start
            call open(stopped, view)
            host = moody(last=k)
            call step_bodies(plan, view, 0.0_dp, h, 0_i8, 3_i8, status, problem, host)
            call expect(error, status, poinsot_e_callback, splitting_name(i)// &
               ": stopped, and not told")
            problem = poinsot_error()
            steps = count(total(1:3) < k)
            whole = start
            call open(whole, view)
            host = moody()
            call step_bodies(plan, view, 0.0_dp, h, 0_i8, int(steps, i8), status, problem, host)
            call expect(error, same_bits(whole%y, stopped%y) .and. same_bits(whole%q, stopped%q), &
               splitting_name(i)// &
               ": stopped in the middle of a step, and left there")
         end do
      end do
   end subroutine test_stop_anywhere

   !> A carry that is no number, or is no rounding, is refused.
   subroutine test_carry(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, all
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), target :: carry(7, 70)
      integer, target :: each(70)
      integer :: k, status
      call make_crowd(70, start)
      call some_plan("exact", "srkn6", plan)
      do k = 1, 9
         all = start
         carry = 0
         carry(min(k, 7), 35) = ieee_value(1.0_dp, ieee_quiet_nan)
         if (k > 7) carry(7, 35) = 10.0_dp**(40*(k - 7))
         call open(all, view)
         view%status => each
         view%carry => carry
         call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem)
         call expect(error, status == poinsot_e_partial .and. &
            each(35) == merge(poinsot_e_not_finite, poinsot_e_domain, k <= 7) &
            .and. count(each /= 0) == 1 &
            .and. same_bits(all%y(:, [35]), start%y(:, [35])), "a carry that is none is taken")
      end do
   end subroutine test_carry

   !> y + h torque leaves the range of numbers: the body fails, in every momentum variable.
   subroutine test_kick_range(error)
      use poinsot_ensemble_bodies, only: column
      type(error_type), allocatable, intent(out) :: error
      character(14), parameter :: variables(4) = [character(14) :: "body-momentum", &
         "space-momentum", "body-velocity", &
         "space-velocity"]
      type(crowd), target :: start, all
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      type(column) :: torque(3)
      real(dp), target :: g(40, 3)
      integer, target :: each(40)
      integer :: j, k, status
      logical :: halting(2)
      call make_crowd(40, start)
      call traps_off(halting)
      do k = 1, 4
         call mixed_plan(plan)
         call set_option(plan, "momentum", trim(variables(k)), problem)
         call make_ready(plan, problem)
         g = 0.1_dp
         g(:, 3) = 0
         g(20, 2) = 1.5e308_dp
         do j = 1, 3
            torque(j)%of => g(:, j)
         end do
         all = start
         all%class = 1
         call open(all, view)
         view%status => each
         call kick_bodies(plan, view, 3.0_dp, torque, status, problem)
         call expect(error, status == poinsot_e_partial .and. each(20) == poinsot_e_domain &
            .and. count(each /= 0) == 1 &
            .and. same_bits(all%y(:, [20]), start%y(:, [20])), &
               "a kick out of the range of numbers: "//variables(k))
         if (allocated(error)) exit
      end do
      call traps_back(halting)
   end subroutine test_kick_range

   !> A kick out of the range may trap in a host that wants that: here the status is looked at.
   subroutine traps_off(halting)
      use, intrinsic :: ieee_exceptions, only: ieee_get_halting_mode, ieee_set_halting_mode, &
         ieee_overflow, ieee_invalid
      logical, intent(out) :: halting(2)
      call ieee_get_halting_mode(ieee_overflow, halting(1))
      call ieee_get_halting_mode(ieee_invalid, halting(2))
      call ieee_set_halting_mode(ieee_overflow, .false.)
      call ieee_set_halting_mode(ieee_invalid, .false.)
   end subroutine traps_off

   subroutine traps_back(halting)
      use, intrinsic :: ieee_exceptions, only: ieee_set_flag, ieee_set_halting_mode, &
         ieee_overflow, ieee_invalid
      logical, intent(in) :: halting(2)
      call ieee_set_flag(ieee_overflow, .false.)
      call ieee_set_flag(ieee_invalid, .false.)
      call ieee_set_halting_mode(ieee_overflow, halting(1))
      call ieee_set_halting_mode(ieee_invalid, halting(2))
   end subroutine traps_back

   !> Off unit norm by up to 1e-6: used, and the norm stays what it is or nears 1. Beyond: refused.
   subroutine test_norms(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: factors(14) = [1 + 1e-15_dp, 1 - 1e-12_dp, 1 + 1e-9_dp, 1 - 9e-7_dp, &
         1 + 9e-7_dp, 1 + 1.1e-6_dp, &
         1 - 1.1e-6_dp, 1.001_dp, 0.5_dp, 2.0_dp, 1e-200_dp, 1e-320_dp, 1e200_dp, 1.7e308_dp]
      type(crowd), target :: start, all
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer, target :: each(40)
      integer :: k, m, status
      real(dp) :: norm
      call make_crowd(40, start)
      do m = 1, method_count()
         call some_plan(method_name(m), "strang", plan)
         do k = 1, size(factors)
            all = start
            all%q(:, 20) = factors(k)*all%q(:, 20)
            call open(all, view)
            view%status => each
            call step_bodies(plan, view, 0.0_dp, h, 0_i8, 10_i8, status, problem)
            call expect(error, each(20), merge(poinsot_ok, poinsot_e_not_unit, k <= 5), &
               method_name(m)//": a quaternion "// &
               text(factors(k) - 1)//" off unit norm")
            norm = 1
            if (k <= 5) norm = norm2(all%q(:, 20))
            call expect(error, abs(norm - 1) <= abs(factors(k) - 1) + 5e-15_dp, method_name(m)// &
               ": the norm goes from 1 + "// &
               text(factors(k) - 1)//" to 1 + "//text(norm - 1))
         end do
      end do
   end subroutine test_norms

   !> As many threads as a plan takes, few bodies: no more threads start than there is work for.
   subroutine test_threads(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: start, all, one
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      type(moody) :: host
      character(4) :: number
      integer :: k, status
      call make_crowd(60, start)
      do k = 1, 2
         call mixed_plan(plan)
         number = merge("1   ", "4096", k == 1)
         call set_option(plan, "threads", number, problem)
         call make_ready(plan, problem)
         all = start
         call open(all, view)
         call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8, status, problem)
         call step_bodies(plan, view, 0.0_dp, h, 2_i8, 2_i8, status, problem, host)
         if (k == 1) one = all
      end do
      call expect(error, status == poinsot_ok .and. same_bits(all%y, one%y), &
         "4096 threads and one differ")
   end subroutine test_threads

   !> No bodies and 2^62 steps: done at once.
   subroutine test_none(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: nobody
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      type(moody) :: host
      integer :: status
      call make_crowd(0, nobody)
      call some_plan("exact", "srkn4", plan)
      call open(nobody, view)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8**62, status, problem, host)
      call expect(error, status, poinsot_ok, "no bodies")
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 2_i8**62, status, problem)
      call expect(error, status, poinsot_ok, "no bodies")
   end subroutine test_none

end module test_hard_faults
