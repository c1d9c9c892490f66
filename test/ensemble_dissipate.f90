!> Drag and thermostat called by a host in the middle of its own steps.
module test_ensemble_dissipate
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_method
   use poinsot_ensemble_bodies, only: body_view, column, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_dissipate, only: dissipate_bodies
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, set_option
   use poinsot_ensemble_step, only: drift_bodies, kick_bodies, step_bodies
   use poinsot_splitting_registry, only: splitting_flows
   use test_crowd, only: crowd, make_crowd, mixed_plan, with_effect, same_bits, class_count
   use test_expectation, only: expect
   implicit none(type, external)
   private
   public :: collect_dissipate

   integer, parameter :: bodies = 300, tensor = class_count
   real(dp), parameter :: h = 0.3_dp

contains

   subroutine collect_dissipate(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("dissipate-is-the-middle-of-baoab", test_middle), &
         new_unittest("dissipate-touches-whom-it-concerns", test_others), &
         new_unittest("dissipate-refuses", test_refusals), &
         new_unittest("rates-are-friction-over-moments", test_rate), &
         new_unittest("two-thermostats-are-two", test_two)]
   end subroutine collect_dissipate

   !> All kinds of body, three frictions, drag beside noise, a wheel on the second class; with a
   !> torque if so wished.
   subroutine thermal_plan(kicked, drag, plan)
      logical, intent(in) :: kicked, drag
      type(poinsot_plan), intent(out) :: plan
      type(poinsot_error) :: error
      call mixed_plan(plan)
      call set_option(plan, "splitting", "baoab", error)
      call set_option(plan, "seed", "5", error)
      call with_effect(plan, "langevin", "friction = 0.3, 0.5, 0.2; temperature = 0.4")
      call with_effect(plan, "gyrostat", "rotor = 0.1, 0.3, -0.2; class = 2")
      if (drag) call with_effect(plan, "drag", "friction = 0.1")
      if (kicked) call with_effect(plan, "torque", "value = 0.3, -0.2, 0.4")
      call make_ready(plan, error)
      if (raised(error)) error stop "thermal_plan"
   end subroutine thermal_plan

   !> Three steps by poinsot_step and three by their flows: the same bits, but for a class that
   !> was given by a tensor, which rounds at each call.
   subroutine test_middle(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: i
      do i = 0, 3
         call compare(i > 1, mod(i, 2) == 1, error)
         if (allocated(error)) return
      end do
   end subroutine test_middle

   subroutine compare(kicked, drag, error)
      logical, intent(in) :: kicked, drag
      type(error_type), allocatable, intent(inout) :: error
      type(poinsot_plan), target :: plan
      type(crowd), target :: it, own
      type(body_view) :: view
      type(column) :: torque(3)
      type(poinsot_error) :: problem
      real(dp), target :: push(bodies, 3)
      integer, target :: class(bodies)
      logical :: exact(bodies)
      integer :: j, k, status
      call thermal_plan(kicked, drag, plan)
      call make_crowd(bodies, it)
      own = it
      class = it%class
      push = spread([0.3_dp, -0.2_dp, 0.4_dp], 1, bodies)
      do j = 1, 3
         torque(j)%of => push(:, j)
      end do
      call view_rows(it%y, it%q, view)
      view%body_class => class
      call step_bodies(plan, view, 0.0_dp, h, 7_i8, 3_i8, status, problem)
      call expect(error, status, poinsot_ok, "steps of baoab")
      call view_rows(own%y, own%q, view)
      view%body_class => class
      do k = 7, 9
         if (kicked) call kick_bodies(plan, view, h/2, torque, status, problem)
         call drift_bodies(plan, view, h/2, status, problem)
         call dissipate_bodies(plan, view, h, int(k, i8), status, problem)
         call expect(error, status, poinsot_ok, "dissipate")
         call drift_bodies(plan, view, h/2, status, problem)
         if (kicked) call kick_bodies(plan, view, h/2, torque, status, problem)
      end do
      exact = class /= tensor
      call expect(error, same_bits(pick(it%y, exact), pick(own%y, exact)) .and. &
         same_bits(pick(it%q, exact), pick(own%q, exact)), "not the bits of a step")
      call expect(error, maxval(abs(it%y - own%y)) < 1e-14_dp, "tensor class")
      call make_crowd(bodies, own)
      call expect(error, .not. any(same_rows(it%y, own%y)), "somebody was not damped")
   end subroutine compare

   pure function pick(a, mask) result(b)
      real(dp), intent(in) :: a(:, :)
      logical, intent(in) :: mask(:)
      real(dp), allocatable :: b(:, :)
      integer :: i
      b = a(:, pack([(i, i=1, size(mask))], mask))
   end function pick

   pure function same_rows(a, b) result(same)
      real(dp), intent(in) :: a(:, :), b(:, :)
      logical :: same(size(a, 2))
      same = all(a == b, dim=1)
   end function same_rows

   !> Attitudes stay; bodies without such an effect keep every bit, in any variable, as do all
   !> bodies of a plan without one.
   subroutine test_others(error)
      type(error_type), allocatable, intent(out) :: error
      character(8), parameter :: layouts(3) = [character(8) :: "native", "lammps", "dl_poly"]
      type(poinsot_plan), target :: plan
      type(crowd), target :: it, before
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer, target :: class(bodies), each(bodies)
      integer :: i, status
      do i = 1, 2*size(layouts)
         plan = poinsot_plan()
         call mixed_plan(plan)
         call set_option(plan, "layout", trim(layouts((i + 1)/2)), problem)
         if (mod(i, 2) == 0) call with_effect(plan, "drag", "friction = 1; class = 3")
         call make_ready(plan, problem)
         call make_crowd(bodies, it)
         class = it%class
         class(1) = -1
         each = -7
         before = it
         call view_rows(it%y, it%q, view)
         view%body_class => class
         view%status => each
         call dissipate_bodies(plan, view, h, 1_i8, status, problem)
         call expect(error, status == poinsot_ok .and. all(each == poinsot_ok), "statuses")
         call expect(error, same_bits(it%q, before%q), "attitudes moved")
         call expect(error, all(same_rows(it%y, before%y) .neqv. (class == 3 .and. &
            mod(i, 2) == 0)), "the wrong bodies were damped: " // layouts((i + 1)/2))
      end do
   end subroutine test_others

   subroutine test_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan), target :: plan
      type(crowd), target :: it, before
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), allocatable :: kick(:), drift(:)
      integer, target :: class(bodies)
      integer :: status
      call thermal_plan(.false., .false., plan)
      call make_crowd(bodies, it)
      class = it%class
      before = it
      call view_rows(it%y, it%q, view)
      view%body_class => class
      call dissipate_bodies(plan, view, -h, 1_i8, status, problem)
      call expect(error, status == poinsot_e_domain .and. problem%code == poinsot_e_domain .and. &
         same_bits(it%y, before%y), "a negative step")
      problem = poinsot_error()
      call splitting_flows("baoab", kick, drift, problem)
      call expect(error, problem%code, poinsot_e_method, "baoab is kicks and drifts alone")
      call expect(error, index(problem%message, "poinsot_dissipate") > 0, problem%message)
   end subroutine test_refusals

   !> One rate damps every kind of body alike, tensor class and wheel included; three damp each
   !> principal axis by its own, and are three frictions rate I.
   subroutine test_rate(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan), target :: plan
      type(crowd), target :: it, before
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), parameter :: rates(3, 2) = reshape([0.7_dp, 0.7_dp, 0.7_dp, 0.2_dp, 1.3_dp, &
         0.6_dp], [3, 2])
      character(20), parameter :: texts(2) = [character(20) :: "rate = 0.7", "rate = 0.2 1.3 0.6"]
      integer, target :: class(bodies)
      real(dp) :: want(3)
      integer :: i, k, status
      do k = 1, 2
         plan = poinsot_plan()
         call mixed_plan(plan)
         call with_effect(plan, "drag", trim(texts(k)))
         call make_ready(plan, problem)
         call make_crowd(bodies, it)
         class = it%class
         before = it
         call view_rows(it%y, it%q, view)
         view%body_class => class
         call dissipate_bodies(plan, view, h, 1_i8, status, problem)
         call expect(error, status, poinsot_ok, "drag by a rate")
         do i = 1, bodies
            want = exp(-rates(:, k)*h)*before%y(:, i)
            if (class(i) == tensor .and. k == 2) cycle
            call expect(error, maxval(abs(it%y(:, i) - want)) < 1e-15_dp, "rate: " // texts(k))
            if (allocated(error)) return
         end do
      end do
   end subroutine test_rate

   !> Two thermostats of one temperature keep it, however weak they are: their noises are not the
   !> same numbers. 19200 nearly independent squares, 5 standard errors.
   subroutine test_two(error)
      type(error_type), allocatable, intent(out) :: error
      character(6), parameter :: schemes(2) = [character(6) :: "strang", "baoab"]
      integer, parameter :: n = 3200, samples = 2
      type(poinsot_plan), target :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), target :: y(3, n), q(4, n)
      real(dp) :: heat
      integer :: i, k, number, status
      do i = 1, 2
         plan = poinsot_plan()
         call add_class(plan, [1.0_dp, 1.0_dp, 1.0_dp], number, problem)
         call set_option(plan, "splitting", trim(schemes(i)), problem)
         call with_effect(plan, "langevin", "friction = 0.3; temperature = 1")
         call with_effect(plan, "langevin", "friction = 0.2; temperature = 1")
         call make_ready(plan, problem)
         y = 0
         q = spread([1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 2, n)
         call view_rows(y, q, view)
         heat = 0
         do k = 0, samples - 1
            call step_bodies(plan, view, 0.0_dp, 0.5_dp, 32_i8*k, 32_i8, status, problem)
            heat = heat + sum(y**2)/(3*n*samples)
         end do
         call expect(error, abs(heat - 1) < 5*sqrt(2.0_dp/(3*n*samples)), "two are too hot")
      end do
   end subroutine test_two

end module test_ensemble_dissipate
