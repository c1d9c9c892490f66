!> A block under test: a body class, a method, a splitting and effects put together, and an
!> independent judge for torques that the Taylor series of the oracle does not know.
module test_turning
   use poinsot_core_kinds, only: dp, i8, groups, lanes
   use poinsot_core_status, only: poinsot_ok
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_body_class, only: body_class, make_class
   use poinsot_free_method, only: free_method, find_method
   use poinsot_effect_effect, only: effect_item, torque_effect
   use poinsot_effect_drag, only: drag
   use poinsot_effect_settings, only: number_setting
   use poinsot_effect_registry, only: make_effect
   use poinsot_splitting_tableaux, only: splitting, free_scheme
   use poinsot_splitting_registry, only: find_splitting
   use poinsot_splitting_stepper, only: run_steps, apply_preprocessor, apply_postprocessor
   use poinsot_splitting_block_flows, only: block_flows
   use poinsot_splitting_class_flows, only: class_flows, compose_class
   use test_oracle_taylor, only: taylor_problem, top_problem
   implicit none(type, external)
   private
   public :: bench, set_up, place, run, run_processed, judge
   public :: no_effects, generic_effects, generic_problem, generic_moments_of, generic_y, generic_q

   !> A body and a state with nothing special about them.
   real(dp), parameter :: generic_moments_of(3) = [0.6_dp, 1.0_dp, 0.8_dp]
   real(dp), parameter :: generic_y(3) = [0.9_dp, 0.4_dp, -0.7_dp]
   real(dp), parameter :: generic_q(4) = [0.5_dp, 0.1_dp, -0.7_dp, 0.5_dp]
   real(dp), parameter :: up(3) = [1.0_dp/3, 2.0_dp/3, -2.0_dp/3]
   real(dp), parameter :: centre(3) = [0.3_dp, -0.5_dp, 0.7_dp], dipole(3) = [0.2_dp, 0.4_dp, &
      -0.1_dp]
   real(dp), parameter :: axis(3) = [0.48_dp, 0.6_dp, 0.64_dp]

   !> Everything a block needs, in one place that stays put.
   type :: bench
      type(body_class) :: class
      type(free_method) :: method
      type(splitting) :: scheme
      type(effect_item), allocatable :: effects(:)
      type(class_flows) :: acting
      type(block_flows) :: block
      logical :: good = .false.
      character(:), allocatable :: message
   end type bench

contains

   !> None at all.
   function no_effects() result(effects)
      type(effect_item), allocatable :: effects(:)
      allocate (effects(0))
   end function no_effects

   !> Gravity off the axes, a dipole in a field and a spring, all along one direction of space, so
   !> that the Taylor series of the oracle knows the motion.
   subroutine generic_effects(effects)
      type(effect_item), allocatable, intent(out) :: effects(:)
      type(poinsot_error) :: error
      allocate (effects(3))
      call make_effect("gravity", [number_setting("centre", centre), number_setting("up", up), &
         number_setting("weight", [1.3_dp])], effects(1)%it, error)
      call make_effect("field", [number_setting("dipole", dipole), &
                       number_setting("strength", 1.1_dp*up)], effects(2)%it, error)
      call make_effect("spring", [number_setting("stiffness", [0.9_dp]), number_setting("axis", &
                       axis), number_setting("direction", up)], effects(3)%it, error)
   end subroutine generic_effects

   !> The same for the oracle.
   function generic_problem() result(problem)
      type(taylor_problem) :: problem
      integer :: i, j
      problem = top_problem(generic_moments_of, 1.3_dp*centre - 1.1_dp*dipole, up)
      do i = 1, 3
         do j = 1, 3
            problem%stiffness(i, j) = -0.9_dp*axis(i)*axis(j)
         end do
      end do
   end function generic_problem

   !> Put a block together; `good` says whether it worked.
   subroutine set_up(it, moments, method, scheme, effects)
      type(bench), intent(inout), target :: it
      real(dp), intent(in) :: moments(3)
      character(*), intent(in) :: method, scheme
      type(effect_item), intent(in) :: effects(:)
      type(poinsot_error) :: error
      it%effects = effects
      call make_class(moments, it%class, error)
      if (.not. raised(error)) call find_method(method, it%method, error)
      if (.not. raised(error)) call find_splitting(scheme, it%scheme, error)
      if (.not. raised(error)) call compose_class(it%class, on_first(it%effects), it%scheme, &
         it%effects, it%acting, error)
      it%good = .not. raised(error)
      it%message = "set-up"
      if (allocated(error%message)) it%message = error%message
      if (.not. it%good) return
      if (size(it%acting%torques) == 0) it%scheme = free_scheme(it%scheme%middle > 0 .and. &
         size(it%acting%dissipative) > 0)
      nullify (it%block%by_lane)
      call it%block%attach(it%class, it%method, it%acting, it%effects, 0_i8)
      it%block%compensated = .false.
      it%block%n = lanes
   end subroutine set_up

   !> Places of the effects that act on class 1.
   function on_first(effects) result(acting)
      type(effect_item), intent(in) :: effects(:)
      integer, allocatable :: acting(:)
      integer :: i
      acting = pack([(i, i=1, size(effects))], [(effects(i)%it%acts_on(1), i=1, size(effects))])
   end function on_first

   !> The same state in every lane.
   subroutine place(it, y, q)
      type(bench), intent(inout) :: it
      real(dp), intent(in) :: y(3), q(4)
      integer :: j
      do j = 1, 3
         it%block%y(:, j) = y(j)
      end do
      do j = 1, 4
         it%block%q(:, j) = q(j)
      end do
      it%block%status = poinsot_ok
      it%block%nvec = groups
      it%block%carry = 0
      it%block%fresh = .false.
   end subroutine place

   !> `steps` steps from time t.
   subroutine run(it, t, h, first, steps)
      type(bench), intent(inout) :: it
      real(dp), intent(in) :: t, h
      integer, intent(in) :: first, steps
      call run_steps(it%scheme, it%block, t, h, int(first, i8), int(steps, i8))
   end subroutine run

   !> The same from state to state, through the processor of the scheme.
   subroutine run_processed(it, t, h, steps)
      type(bench), intent(inout) :: it
      real(dp), intent(in) :: t, h
      integer, intent(in) :: steps
      call apply_preprocessor(it%scheme, it%block, t, h, 0_i8)
      call run_steps(it%scheme, it%block, t, h, 0_i8, int(steps, i8))
      call apply_postprocessor(it%scheme, it%block, t, h, int(steps, i8))
   end subroutine run_processed

   !> y' = y x w + g - friction w, q' = q o (0, w)/2 with Runge and Kutta's method in every lane:
   !> knows nothing of splittings.
   subroutine judge(it, t, h, steps)
      type(bench), intent(inout) :: it
      real(dp), intent(in) :: t, h
      integer, intent(in) :: steps
      real(dp), dimension(lanes, 7) :: x, k1, k2, k3, k4, low, add, sum
      integer :: k
      real(dp) :: now
      x(:, 1:3) = it%block%y
      x(:, 4:7) = it%block%q
      low = 0
      do k = 0, steps - 1
         now = t + k*h
         call slope(it, now, x, k1)
         call slope(it, now + 0.5_dp*h, x + 0.5_dp*h*k1, k2)
         call slope(it, now + 0.5_dp*h, x + 0.5_dp*h*k2, k3)
         call slope(it, now + h, x + h*k3, k4)
         add = h*(k1 + 2*k2 + 2*k3 + k4)/6 + low
         sum = x + add
         low = add - (sum - x)
         x = sum
      end do
      it%block%y = x(:, 1:3)
      it%block%q = x(:, 4:7)
   end subroutine judge

   subroutine slope(it, t, x, rate)
      type(bench), intent(in) :: it
      real(dp), intent(in) :: t, x(lanes, 7)
      real(dp), intent(out) :: rate(lanes, 7)
      real(dp) :: w(lanes, 3), g(lanes, 3), q(lanes, 4)
      integer :: i, j
      q = x(:, 4:7)
      g = 0
      do j = 1, 3
         w(:, j) = it%class%inverse(j)*x(:, j)
      end do
      do i = 1, size(it%effects)
         select type (one => it%effects(i)%it)
         class is (torque_effect)
            call one%add_torque(it%class, t, q, g)
         class is (drag)
            do j = 1, 3
               g(:, j) = g(:, j) - one%law%values(j)*w(:, j)
            end do
         end select
      end do
      rate(:, 1) = x(:, 2)*w(:, 3) - x(:, 3)*w(:, 2) + g(:, 1)
      rate(:, 2) = x(:, 3)*w(:, 1) - x(:, 1)*w(:, 3) + g(:, 2)
      rate(:, 3) = x(:, 1)*w(:, 2) - x(:, 2)*w(:, 1) + g(:, 3)
      rate(:, 4) = -0.5_dp*(q(:, 2)*w(:, 1) + q(:, 3)*w(:, 2) + q(:, 4)*w(:, 3))
      rate(:, 5) = 0.5_dp*(q(:, 1)*w(:, 1) + q(:, 3)*w(:, 3) - q(:, 4)*w(:, 2))
      rate(:, 6) = 0.5_dp*(q(:, 1)*w(:, 2) + q(:, 4)*w(:, 1) - q(:, 2)*w(:, 3))
      rate(:, 7) = 0.5_dp*(q(:, 1)*w(:, 3) + q(:, 2)*w(:, 2) - q(:, 3)*w(:, 1))
   end subroutine slope

end module test_turning
