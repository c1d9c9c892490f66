!> Room ensemble: layouts, kicks, energies, the plan's refusals, callbacks. Bits stand in
!> test_ensemble_bits.
module test_ensemble
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised, clear
   use poinsot_core_status, only: poinsot_ok, poinsot_e_callback, poinsot_e_domain, &
      poinsot_e_not_unit, &
      poinsot_e_method, poinsot_e_partial, poinsot_e_size
   use poinsot_effect_effect, only: effect
   use poinsot_effect_registry, only: effect_count, effect_name, describe_effect, &
      numbered_effects, numbered_effect, numbered_effect_count
   use poinsot_effect_settings, only: setting, effect_info
   use poinsot_effect_settings_text, only: read_settings
   use poinsot_ensemble_bodies, only: body_view, column, view_columns, view_rows
   use poinsot_ensemble_system, only: torque_callback
   use poinsot_ensemble_layout, only: momentum_names
   use poinsot_ensemble_observe, only: body_energies, body_momenta, total_degrees_of_freedom
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_effect, add_ready_effect, &
      set_option
   use poinsot_ensemble_step, only: drift_bodies, kick_bodies, step_bodies
   use poinsot_free_method, only: method_count, method_name, numbered_methods, &
      numbered_method, numbered_method_count
   use poinsot_rotation_conversions, only: to_matrix
   use poinsot_rotation_quaternion, only: quaternion_conjugate, quaternion_product, &
      rotate, rotate_back
   use poinsot_splitting_registry, only: splitting_count, splitting_name, &
      numbered_splittings, numbered_splitting, numbered_count
   use test_crowd, only: crowd, make_crowd, mixed_plan, plain_plan, with_effect, &
      same_bits, turned_tensor
   use test_ensemble_bits, only: collect_bits
   use test_ensemble_dissipate, only: collect_dissipate
   use test_ensemble_every, only: collect_every
   use test_ensemble_classes, only: collect_classes
   use test_ensemble_own, only: collect_own
   use test_ensemble_plain, only: collect_plain
   use test_expectation, only: expect
   implicit none(type, external)
   private
   public :: collect_ensemble

   real(dp), parameter :: tight = 4e-15_dp
   real(dp), parameter :: moments(3) = [0.6_dp, 0.8_dp, 1.0_dp]

   !> A dipole along body axis 3 in a unit field along space axis 3, or gravity: body torque gamma x
   !> centre. Stops at evaluation number `last`.
   type, extends(torque_callback) :: top
      integer :: calls = 0, last = huge(0)
      logical :: space = .false.
   contains
      procedure :: evaluate => evaluate_top
   end type top

   !> An effect that says nothing of what it does.
   type, extends(effect) :: idle
   end type idle

contains

   subroutine collect_ensemble(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      type(unittest_type), allocatable :: bits(:), dissipate(:), every(:), own(:), classes(:), &
         plain(:)
      testsuite = [ &
         new_unittest("momentum-variables-mean-what-they-say", test_variables), &
         new_unittest("momentum-variables-move-alike", test_alike), &
         new_unittest("tensor-class-is-its-principal-class", test_tensor), &
         new_unittest("rows-and-columns", test_columns), &
         new_unittest("kick-in-space-and-body", test_kick), &
         new_unittest("kick-adds-where-it-can", test_kick_adds), &
         new_unittest("linear-bodies-stay-linear", test_linear), &
         new_unittest("energies-momenta-freedom", test_observe), &
         new_unittest("callback-is-gravity", test_callback), &
         new_unittest("callback-stops", test_stop), &
         new_unittest("plan-refuses", test_refusals), &
         new_unittest("settings-in-a-text", test_settings), &
         new_unittest("labels-are-those-of-the-rows", test_names), &
         new_unittest("public-numbers", test_numbers)]
      call collect_bits(bits)
      call collect_every(every)
      call collect_own(own)
      call collect_plain(plain)
      call collect_classes(classes)
      call collect_dissipate(dissipate)
      testsuite = [testsuite, bits, every, own, plain, classes, dissipate]
   end subroutine collect_ensemble

   !> A body's state in one of the five variables, by the algebra of room rotation; axes: the
   !> caller's body frame is turned against the principal one by s (x_caller = s x_principal).
   subroutine express(variable, inertia, y, q, s, p, qc)
      integer, intent(in) :: variable
      real(dp), intent(in) :: inertia(3), y(3), q(4), s(4)
      real(dp), intent(out) :: p(4), qc(4)
      real(dp) :: omega(3)
      omega = 0
      where (inertia > 0) omega = y/inertia
      qc = quaternion_product(q, quaternion_conjugate(s))
      p = 0
      select case (variable)
      case (1); p(1:3) = rotate(s, y)
      case (2); p(1:3) = rotate(q, y)
      case (3); p(1:3) = rotate(s, omega)
      case (4); p(1:3) = rotate(q, omega)
      case default; p = 2*quaternion_product(qc, [0.0_dp, rotate(s, y)])
      end select
   end subroutine express

   !> All bodies of a crowd in one of the variables; the tensor class in its given frame.
   subroutine express_all(plan, variable, it, p, q)
      type(poinsot_plan), intent(in) :: plan
      integer, intent(in) :: variable
      type(crowd), intent(in) :: it
      real(dp), allocatable, intent(out) :: p(:, :), q(:, :)
      integer :: i
      allocate (p(4, it%n), q(4, it%n))
      do i = 1, it%n
         call express(variable, plan%classes(it%class(i))%it%moments, it%y(:, i), it%q(:, i), &
                      plan%classes(it%class(i))%it%axes, p(:, i), q(:, i))
      end do
   end subroutine express_all

   subroutine ready_with(variable, plan, frame)
      character(*), intent(in) :: variable
      type(poinsot_plan), intent(out) :: plan
      character(*), intent(in), optional :: frame
      type(poinsot_error) :: problem
      call mixed_plan(plan)
      call set_option(plan, "momentum", trim(variable), problem)
      if (present(frame)) call set_option(plan, "frame", frame, problem)
      call make_ready(plan, problem)
      if (raised(problem)) error stop "ready_with"
   end subroutine ready_with

   !> Momenta in space and kinetic energies, asked for through each variable, are those of the
   !> native state.
   subroutine test_variables(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd) :: it
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), allocatable, target :: p(:, :), q(:, :), l(:, :), kinetic(:), potential(:), &
         before(:, :)
      real(dp) :: expected
      integer :: variable, i, status
      call make_crowd(100, it)
      allocate (l(3, it%n), kinetic(it%n), potential(it%n))
      do variable = 1, size(momentum_names)
         call ready_with(momentum_names(variable), plan)
         call express_all(plan, variable, it, p, q)
         before = p
         call view_rows(p, q, view)
         view%body_class => null()
         call point_class(it, view)
         call body_momenta(plan, view, l, status, problem)
         call expect(error, status, poinsot_ok, "momenta: "//momentum_names(variable))
         call body_energies(plan, view, 0.0_dp, kinetic, potential, status, problem)
         do i = 1, it%n
            associate (inverse => plan%classes(it%class(i))%it%inverse)
               expected = 0.5_dp*sum(it%y(:, i)**2*inverse)
               call expect(error, maxval(abs(l(:, i) - &
                          rotate(it%q(:, i), it%y(:, i)))) < tight .and. abs(kinetic(i) - &
                          expected) < 2*tight*(1 + expected), "wrong: "// momentum_names(variable))
            end associate
            if (allocated(error)) return
         end do
         call expect(error, same_bits(p, before), "asking must not change anything")
      end do
   end subroutine test_variables

   subroutine point_class(it, view)
      type(crowd), intent(in), target :: it
      type(body_view), intent(inout) :: view
      view%body_class => it%class
   end subroutine point_class

   !> Drift in each variable is drift of the native state; back again is where it began.
   subroutine test_alike(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: it, moved
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), allocatable, target :: p(:, :), q(:, :)
      real(dp), allocatable :: pm(:, :), qm(:, :), p0(:, :), q0(:, :)
      integer :: variable, i, status
      real(dp), parameter :: h = 0.3_dp
      call make_crowd(100, it)
      moved = it
      call ready_with("body-momentum", plan)
      plan%principal = .true.
      call view_rows(moved%y, moved%q, view)
      call point_class(moved, view)
      call drift_bodies(plan, view, h, status, problem)
      do variable = 1, size(momentum_names)
         call ready_with(momentum_names(variable), plan)
         call express_all(plan, variable, it, p, q)
         call express_all(plan, variable, moved, pm, qm)
         p0 = p
         q0 = q
         call view_rows(p, q, view)
         call point_class(it, view)
         call drift_bodies(plan, view, h, status, problem)
         call expect(error, status, poinsot_ok, "drift: "//momentum_names(variable))
         i = merge(4, 3, variable == 5)
         call expect(error, maxval(abs(p(1:i, :) - pm(1:i, :))) < 2*tight .and. &
                    maxval(abs(q - qm)) < tight, "moved otherwise: "//momentum_names(variable))
         if (variable == 2) call expect(error, same_bits(p, p0), &
            "free motion must leave space momenta, to the bit")
         call drift_bodies(plan, view, -h, status, problem)
         call expect(error, maxval(abs(p(1:i, :) - p0(1:i, :))) < 2*tight .and. &
                    maxval(abs(q - q0)) < tight, "did not come back: "//momentum_names(variable))
      end do
   end subroutine test_alike

   !> The tensor's class against an own product of matrices: L in space stays, and omega = J^-1 L
   !> turns the given frame.
   subroutine test_tensor(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), target :: y(3, 1), q(4, 1), kinetic(1), potential(1)
      integer, target :: classes(1)
      real(dp) :: l(3), tensor(3, 3), omega(3), before(3, 3), rate(3, 3)
      real(dp), parameter :: h = 1e-5_dp
      integer :: status
      classes = 9
      call ready_with("body-momentum", plan)
      tensor = turned_tensor()
      omega = [0.3_dp, -0.7_dp, 0.5_dp]
      y(:, 1) = matmul(tensor, omega)
      q(:, 1) = [0.5_dp, 0.5_dp, -0.5_dp, 0.5_dp]
      l = rotate(q(:, 1), y(:, 1))
      call view_rows(y, q, view)
      view%body_class => classes
      call body_energies(plan, view, 0.0_dp, kinetic, potential, status, problem)
      call expect(error, kinetic(1), 0.5_dp*dot_product(omega, y(:, 1)), &
                 "T = omega.J omega/2", thr=tight)
      before = to_matrix(q(:, 1))
      call drift_bodies(plan, view, h, status, problem)
      rate = matmul(transpose(before), (to_matrix(q(:, 1)) - before)/h)
      call expect(error, maxval(abs([rate(3, 2), rate(1, 3), rate(2, 1)] - omega)) < 1e-4_dp, &
         "turns with J^-1 L")
      call drift_bodies(plan, view, 3.0_dp, status, problem)
      call expect(error, maxval(abs(rotate(q(:, 1), y(:, 1)) - l)) < tight, "L in space is kept")
   end subroutine test_tensor

   !> Component arrays and rows give the same bits.
   subroutine test_columns(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: it
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), allocatable, target :: y(:, :), q(:, :)
      integer :: status
      call make_crowd(77, it)
      y = transpose(it%y)
      q = transpose(it%q)
      call ready_with("body-momentum", plan)
      call view_rows(it%y, it%q, view)
      call point_class(it, view)
      call drift_bodies(plan, view, 0.2_dp, status, problem)
      call view_columns(y, q, view)
      call point_class(it, view)
      call drift_bodies(plan, view, 0.2_dp, status, problem)
      call expect(error, same_bits(transpose(y), it%y) &
         .and. same_bits(transpose(q), it%q), "columns differ from rows")
   end subroutine test_columns

   !> The same torque in space and in the caller's body frame, in all variables: L in space gains h
   !> torque, but for the part about an axis without inertia.
   subroutine test_kick(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: it
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      type(column) :: torque(3)
      real(dp), allocatable, target :: p(:, :), q(:, :), g(:, :), l(:, :)
      real(dp) :: expected(3), axis(3)
      integer :: variable, i, j, status
      logical :: space
      real(dp), parameter :: push(3) = [0.3_dp, -0.2_dp, 0.5_dp], h = 0.4_dp
      call make_crowd(100, it)
      allocate (g(3, it%n), l(3, it%n))
      do j = 1, 3
         torque(j)%of => g(j, :)
      end do
      do variable = 1, size(momentum_names)
         do i = 0, 1
            space = i == 1
            call ready_with(momentum_names(variable), plan, merge("space", "body ", space))
            call express_all(plan, variable, it, p, q)
            call set_torque(space, push, q, g)
            call view_rows(p, q, view)
            call point_class(it, view)
            call kick_bodies(plan, view, h, torque, status, problem)
            call expect(error, status, poinsot_ok, "kick: "//momentum_names(variable))
            call body_momenta(plan, view, l, status, problem)
            do j = 1, it%n
               expected = rotate(it%q(:, j), it%y(:, j)) + h*push
               axis = rotate(it%q(:, j), [0.0_dp, 0.0_dp, 1.0_dp])
               if (it%class(j) == 8) expected = expected - dot_product(expected, axis)*axis
               call expect(error, maxval(abs(l(:, j) - expected)) < 2*tight, &
                  "kicked otherwise: "// &
                  momentum_names(variable))
            end do
         end do
      end do
   end subroutine test_kick

   subroutine set_torque(space, push, q, g)
      logical, intent(in) :: space
      real(dp), intent(in) :: push(3), q(:, :)
      real(dp), intent(inout) :: g(:, :)
      integer :: i
      do i = 1, size(q, 2)
         g(:, i) = push
         if (.not. space) g(:, i) = rotate_back(q(:, i), push)
      end do
   end subroutine set_torque

   !> In the caller's own variable and frame a kick is one addition, to the bit; attitudes are not
   !> touched.
   subroutine test_kick_adds(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      type(column) :: torque(3)
      real(dp), target :: y(3, 5), q(4, 5), g(3, 5)
      real(dp) :: y0(3, 5), q0(4, 5)
      type(crowd) :: it
      integer :: j, status
      call make_crowd(5, it)
      call plain_plan(moments, "lammps", plan)
      y = it%y
      q = it%q
      g = cos(1e3_dp*it%y)
      y0 = y
      q0 = q
      do j = 1, 3
         torque(j)%of => g(j, :)
      end do
      call view_rows(y, q, view)
      call kick_bodies(plan, view, 0.125_dp, torque, status, problem)
      call expect(error, same_bits(y, y0 + 0.125_dp*g), "a kick must add h torque, and no more")
      call expect(error, same_bits(q, q0), "a kick must leave attitudes alone")
   end subroutine test_kick_adds

   !> A plan as it is created.
   subroutine renew(plan)
      type(poinsot_plan), intent(out) :: plan
      associate (unused => plan)
      end associate
   end subroutine renew

   !> Call after call every method leaves a linear body without momentum about its axis.
   subroutine test_linear(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), target :: y(3, 3), q(4, 3)
      integer :: k, m, axis, status, number
      integer, target :: classes(3)
      classes = [1, 2, 3]
      do m = 1, method_count()
         call renew(plan)
         do axis = 1, 3
            call add_class(plan, cshift([0.0_dp, 0.7_dp, 0.7_dp], 1 - axis), number, problem)
            y(:, axis) = cshift([0.0_dp, 0.5_dp, -0.6_dp], 1 - axis)
         end do
         call set_option(plan, "method", method_name(m), problem)
         call make_ready(plan, problem)
         q = 0.5_dp
         call view_rows(y, q, view)
         view%body_class => classes
         do k = 1, 20
            call drift_bodies(plan, view, 0.1_dp, status, problem)
            call expect(error, status, poinsot_ok, method_name(m)//": a linear body failed")
         end do
         do axis = 1, 3
            call expect(error, abs(y(axis, axis)) <= 0 .and. &
               abs(norm2(y(:, axis)) - norm2([0.5_dp, &
                       0.6_dp])) < 1e-5_dp, method_name(m)//": momentum of a linear body")
         end do
      end do
   end subroutine test_linear

   subroutine test_observe(error)
      type(error_type), allocatable, intent(out) :: error
      type(crowd), target :: it
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), allocatable, target :: kinetic(:), potential(:)
      integer, allocatable, target :: status(:)
      real(dp) :: q(4)
      integer :: i, answer
      call make_crowd(50, it)
      call mixed_plan(plan)
      call with_effect(plan, "gravity", "centre = 0, 0, 1; weight = 2; class = 3")
      call make_ready(plan, problem)
      allocate (kinetic(50), potential(50), status(50))
      call view_rows(it%y, it%q, view)
      call point_class(it, view)
      view%status => status
      it%q(:, 7) = 0
      call body_energies(plan, view, 0.0_dp, kinetic, potential, answer, problem)
      call expect(error, answer, poinsot_e_partial, "one body is none")
      call expect(error, status(7) == poinsot_e_not_unit .and. count(status /= 0) == 1 &
         .and. abs(kinetic(7)) <= 0, "its status")
      do i = 1, it%n
         if (i == 7) cycle
         q = it%q(:, i)
         call expect(error, potential(i), merge(2*(q(1)**2 - q(2)**2 - q(3)**2 + q(4)**2), 0.0_dp, &
                    it%class(i) == 3), "potential", thr=tight)
      end do
      call expect(error, total_degrees_of_freedom(plan, view), 3*50 - count(it%class == 8), &
         "degrees of freedom")
   end subroutine test_observe

   subroutine evaluate_top(self, t, q, torque, energy, stop)
      class(top), intent(inout) :: self
      real(dp), intent(in) :: t
      real(dp), intent(in), target :: q(:, :)
      real(dp), intent(inout), target :: torque(:, :)
      real(dp), intent(inout) :: energy
      logical, intent(inout) :: stop
      real(dp) :: gamma(3), one(4)
      integer :: i
      self%calls = self%calls + 1
      stop = self%calls > self%last
      do i = 1, size(q, 1)
         one = q(i, :)
         gamma = rotate_back(one, [0.0_dp, 0.0_dp, 1.0_dp])
         torque(i, :) = [gamma(2), -gamma(1), 0.0_dp] ! gamma x e3
         if (self%space) torque(i, :) = rotate(one, torque(i, :))
         energy = energy + gamma(3)
      end do
      if (t > 1e30_dp) energy = 0
   end subroutine evaluate_top

   !> The heavy top of Hairer and Vilmart by the effect and by a callback, torques in body and space
   !> frame.
   subroutine test_callback(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: bare, heavy
      type(poinsot_error) :: problem
      type(body_view) :: view
      type(top) :: host
      real(dp), target :: y(3, 40), q(4, 40), y2(3, 40), q2(4, 40)
      type(crowd) :: it
      integer :: status, number, i
      call make_crowd(40, it)
      call add_class(heavy, moments, number, problem)
      call with_effect(heavy, "gravity", "centre = 0, 0, 1")
      call make_ready(heavy, problem)
      y = it%y
      q = it%q
      y(:, 1) = [1.8_dp, 0.4_dp, -0.9_dp]
      q(:, 1) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
      call view_rows(y, q, view)
      call step_bodies(heavy, view, 0.0_dp, 0.01_dp, 0_i8, 1000_i8, status, problem)
      call expect(error, maxval(abs(q(:, 1) - [0.9257399890934638_dp, -0.3514906679727545_dp, &
                 0.1021838760186523_dp, -0.0949644059798463_dp])) < 1e-10_dp, "published top")
      do i = 0, 1
         call add_class(bare, moments, number, problem)
         call set_option(bare, "frame", merge("space", "body ", i == 1), problem)
         call make_ready(bare, problem)
         host%space = i == 1
         y2 = it%y
         q2 = it%q
         y2(:, 1) = [1.8_dp, 0.4_dp, -0.9_dp]
         q2(:, 1) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
         call view_rows(y2, q2, view)
         call step_bodies(bare, view, 0.0_dp, 0.01_dp, 0_i8, 1000_i8, status, problem, host)
         call expect(error, status, poinsot_ok, "steps with a callback")
         call expect(error, maxval(abs(y2 - y)) < 1e-11_dp &
            .and. maxval(abs(q2 - q)) < 1e-11_dp, "callback is not gravity")
         call renew(bare)
      end do
   end subroutine test_callback

   !> Stopped in step 4 of 6: the state after three steps, to the bit.
   subroutine test_stop(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      type(body_view) :: view
      type(top) :: host
      real(dp), target :: y(3, 40), q(4, 40), y2(3, 40), q2(4, 40)
      type(crowd) :: it
      integer :: status, per_step
      call make_crowd(40, it)
      call plain_plan(moments, "native", plan)
      y = it%y
      q = it%q
      call view_rows(y, q, view)
      call step_bodies(plan, view, 0.0_dp, 0.1_dp, 0_i8, 1_i8, status, problem, host)
      per_step = host%calls
      call step_bodies(plan, view, 0.0_dp, 0.1_dp, 1_i8, 2_i8, status, problem, host)
      host%calls = 0
      host%last = 3*per_step + 2
      y2 = it%y
      q2 = it%q
      call view_rows(y2, q2, view)
      call step_bodies(plan, view, 0.0_dp, 0.1_dp, 0_i8, 6_i8, status, problem, host)
      call expect(error, status == poinsot_e_callback &
         .and. problem%code == poinsot_e_callback, "the callback stopped")
      call expect(error, host%calls == host%last + 1 .and. same_bits(y, y2) .and. &
         same_bits(q, q2), &
                 "the state must be that of before the step")
   end subroutine test_stop

   subroutine test_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      type(body_view) :: view
      type(top) :: host
      class(effect), allocatable :: own
      real(dp), target :: y(3, 2), q(4, 2)
      integer :: status, number
      character(20), parameter :: bad(2, 7) = reshape([character(20) :: "method", "exakt", &
         "splitting", "stang", &
         "layout", "lamps", "momentum", "body", "frame", "both", "threads", "-2", "sed", "1"], &
            [2, 7])
      y = 0.1_dp
      q = 0.5_dp
      call view_rows(y, q, view)
      do number = 1, size(bad, 2)
         call clear(problem)
         call set_option(plan, trim(bad(1, number)), trim(bad(2, number)), problem)
         call expect(error, problem%code == merge(poinsot_e_domain, poinsot_e_method, &
            number == 6), &
            "accepted: "//bad(2, number))
      end do
      allocate (idle :: own)
      call clear(problem)
      call add_ready_effect(plan, own, problem)
      call expect(error, problem%code, poinsot_e_method, "an effect that does nothing")
      call clear(problem)
      call drift_bodies(plan, view, 0.1_dp, status, problem)
      call expect(error, status, poinsot_e_domain, "a plan that is not ready")
      call clear(problem)
      call add_class(plan, moments, number, problem)
      call set_option(plan, "layout", "hoomd", problem)
      call set_option(plan, "splitting", "chin4", problem)
      call make_ready(plan, problem)
      call drift_bodies(plan, view, 0.1_dp, status, problem)
      call expect(error, status, poinsot_e_size, "three components for a conjugate momentum")
      plan%momentum = 1
      call clear(problem)
      call step_bodies(plan, view, 0.0_dp, 0.1_dp, 0_i8, 1_i8, status, problem, host)
      call expect(error, status, poinsot_e_method, "a callback has no force gradient")
      call clear(problem)
      call add_class(plan, moments, number, problem)
      call expect(error, problem%code, poinsot_e_domain, "a ready plan takes no class")
   end subroutine test_refusals

   subroutine test_settings(error)
      type(error_type), allocatable, intent(out) :: error
      type(setting), allocatable :: s(:)
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      character(24), parameter :: bad(11) = [character(24) :: "centre", "= 1", &
         "a =", "a = 1 two", "a = 1..2", "a = 1; b", "a = 0, 0, 1e999", "a = -1e308", "a = nan", &
         "a = ,1", "a = 1,,"]
      integer :: i
      call read_settings("centre = 0, -1e-3 2;; frame='space' ; kind = slow;", s, problem)
      call expect(error, .not. raised(problem) .and. size(s) == 3, "three settings")
      if (allocated(error)) return
      call expect(error, s(1)%key == "centre" .and. s(2)%text == "space" .and. s(3)%text == "slow" &
                 .and. .not. allocated(s(3)%values), "keys and words")
      if (allocated(error)) return
      call expect(error, maxval(abs(s(1)%values - [0.0_dp, -1e-3_dp, 2.0_dp])) <= 0, "numbers")
      call read_settings("", s, problem)
      call expect(error, .not. raised(problem) .and. size(s) == 0, "nothing")
      do i = 1, size(bad)
         if (allocated(error)) return
         call clear(problem)
         call read_settings(trim(bad(i)), s, problem)
         call expect(error, problem%code, poinsot_e_domain, "accepted: "//bad(i))
      end do
      call clear(problem)
      call read_settings("a = ' b''" // repeat("c", 300000) // "', ;", s, problem) ! in no time
      call expect(error, len(s(1)%text) == 300003 .and. s(1)%text(:4) == " b'c", "a long text")
      call read_settings("a = 1" // achar(27) // repeat("1", 1000), s, problem)
      call expect_plain("a number")
      call read_settings("a" // achar(27) // repeat("1", 1000), s, problem)
      call expect_plain("no key")
      call set_option(plan, "method", "e" // achar(27) // repeat("x", 1000), problem)
      call expect_plain("a method")
      call set_option(plan, "splitting", "e" // achar(27) // repeat("x", 1000), problem)
      call expect_plain("a splitting")
      call set_option(plan, "seed", "e" // achar(27) // repeat("x", 1000), problem)
      call expect_plain("a seed")
      call set_option(plan, "tolerance", "e" // achar(27) // repeat("x", 1000), problem)
      call expect_plain("a tolerance")
      call set_option(plan, "e" // achar(27) // repeat("x", 1000), "1", problem)
      call expect_plain("an option")
      call set_option(plan, "layout", "e" // achar(27) // repeat("x", 1000), problem)
      call expect_plain("a layout")
      call add_effect(plan, "e" // achar(27) // repeat("x", 1000), s(:0), problem)
      call expect_plain("an effect")
      call set_option(plan, "momentum", "x", problem)
      call expect(error, index(problem%message, " there are: body-momentum space-") > 0, &
         "what is allowed")
      call clear(problem)
      call set_option(plan, " Threads", " 2 ", problem)
      call set_option(plan, "METHOD ", " dmv8", problem)
      call expect(error, .not. raised(problem) .and. plan%threads == 2 .and. &
         plan%method%name == "dmv8", "blanks and case of an option")
   contains
      !> A refusal that shows no byte a terminal would obey, and is not as long as what it refuses.
      subroutine expect_plain(what)
         character(*), intent(in) :: what
         call expect(error, raised(problem), "accepted: " // what)
         if (allocated(error)) return
         call expect(error, len(problem%message) < 300 .and. is_plain(problem%message), what)
         call clear(problem)
      end subroutine expect_plain
   end subroutine test_settings

   pure logical function is_plain(text)
      character(*), intent(in) :: text
      integer :: i
      is_plain = all([(iachar(text(i:i)) >= 32 .and. iachar(text(i:i)) < 127, i=1, len(text))])
   end function is_plain

   !> Effects have a label and a row: both are of the same names.
   subroutine test_names(error)
      type(error_type), allocatable, intent(out) :: error
      type(effect_info) :: info
      integer :: i
      do i = 1, effect_count
         info = describe_effect(i)
         call expect(error, trim(info%name), effect_name(i), "a label without a row")
      end do
   end subroutine test_names

   !> Public numbers are ABI: what a number means stays, wherever its row stands. New ones are added
   !> at the end.
   subroutine test_numbers(error)
      type(error_type), allocatable, intent(out) :: error
      character(20), parameter :: splittings(16) = [character(20) :: "strang", "forest-ruth", &
         "suzuki4", "yoshida6", "mclachlan4", "srkn4", "srkn6", "chin4", "omelyan4", "omelyan6", &
         "omelyan8", "takahashi-imada", "taylor", "baoab", "saba864", "saba1064"]
      character(20), parameter :: methods(18) = [character(20) :: "exact", "jacobi", "dmv2", &
         "dmv4", "dmv6", "dmv8", "dmv10", "dmv12", "dmv14", "dmv16", "dmv18", "dmv20", "dmv22", &
         "dmv24", "midpoint", "three-rotations", "symmetric-rotation", "rattle"]
      character(20), parameter :: effects(11) = [character(20) :: "gravity", "field", &
         "gravity_gradient", "spring", "torque", "drag", "langevin", "gyrostat", "dipoles", &
         "callback", "potential"]
      integer :: i
      do i = 1, size(effects)
         call expect(error, numbered_effect(i), trim(effects(i)), "an effect's number")
      end do
      do i = 1, effect_count
         call expect(error, count(numbered_effects == effect_name(i)), 1, &
            "not one number: "//effect_name(i))
      end do
      call expect(error, count(numbered_effects /= ""), effect_count, "shared numbers")
      call expect(error, numbered_effect_count(), size(effects), "enter a new effect here")
      call expect(error, numbered_effect(0)//numbered_effect(numbered_effect_count() + 1), "")
      do i = 1, size(methods)
         call expect(error, numbered_method(i), trim(methods(i)), "a method's number")
      end do
      do i = 1, method_count()
         call expect(error, count(numbered_methods == method_name(i)), 1, &
            "not one number: "//method_name(i))
      end do
      call expect(error, count(numbered_methods /= ""), method_count(), "shared numbers")
      call expect(error, numbered_method_count(), size(methods), "enter a new method here")
      call expect(error, numbered_method(0)//numbered_method(numbered_method_count() + 1), "")
      do i = 1, size(splittings)
         call expect(error, numbered_splitting(i), trim(splittings(i)), "a splitting's number")
      end do
      do i = 1, splitting_count()
         call expect(error, count(numbered_splittings == splitting_name(i)), 1, &
            "not one number: "//splitting_name(i))
      end do
      call expect(error, count(numbered_splittings /= ""), splitting_count(), "shared numbers")
      call expect(error, numbered_count(), size(splittings), "enter a new splitting here")
      call expect(error, numbered_splitting(0)//numbered_splitting(numbered_count() + 1), "")
   end subroutine test_numbers

end module test_ensemble
