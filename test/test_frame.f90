!> One frame: a class made from a tensor takes and gives everything in the frame of the tensor; and
!> one angular velocity, I^-1 (y - s). The same problem is put twice, in the given frame and, turned
!> here by the description of the keys, in the principal one.
module test_frame
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_partial, poinsot_e_step, poinsot_e_domain, &
      poinsot_e_axis_momentum
   use poinsot_effect_callback, only: user_torque, user_potential
   use poinsot_effect_effect, only: effect
   use poinsot_effect_registry, only: effect_count, describe_effect
   use poinsot_effect_settings, only: setting, effect_info, number_setting, text_setting
   use poinsot_effect_settings_text, only: read_settings
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_observe, only: body_energies
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_tensor_class, class_axes, &
      set_option, add_effect, add_ready_effect
   use poinsot_ensemble_step, only: drift_bodies, step_bodies
   use poinsot_rotation_conversions, only: from_matrix, to_matrix
   use poinsot_rotation_quaternion, only: quaternion_product, quaternion_conjugate
   use test_expectation, only: expect
   implicit none(type, external)
   private
   public :: collect_frame

   real(dp), parameter :: moments(3) = [0.6_dp, 0.8_dp, 1.1_dp], generic(3) = [0.3_dp, -0.5_dp, &
      0.7_dp]
   integer, parameter :: n = 3

   !> Gravity by a program: centre `generic`, weight 1, up = z, in the frame that it is asked in.
   type, extends(user_torque) :: own_torque
   contains
      procedure :: evaluate => evaluate_torque
   end type own_torque
   type, extends(user_potential) :: own_potential
   contains
      procedure :: evaluate => evaluate_potential
   end type own_potential

contains

   subroutine collect_frame(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("every-effect-in-the-frame-of-a-tensor", test_every_effect), &
         new_unittest("a-program-s-own-torque-too", test_own), &
         new_unittest("friction-about-axes-of-a-tensor", test_friction), &
         new_unittest("diagonal-tensor-is-moments", test_diagonal), &
         new_unittest("a-plan-that-was-refused-can-be-mended", test_again), &
         new_unittest("drag-leaves-a-wheel-alone", test_wheel_drag), &
         new_unittest("heat-is-about-the-wheel", test_wheel_heat), &
         new_unittest("drift-turns-the-wheel", test_wheel_drift), &
         new_unittest("velocities-know-the-wheel", test_wheel_velocity), &
         new_unittest("a-wheel-too-fast", test_wheel_fast), &
         new_unittest("momentum-about-the-axis-of-a-linear-body", test_axis)]
   end subroutine collect_frame

   !> A rotation about no axis in particular.
   function some_rotation() result(r)
      real(dp) :: r(3, 3), q(4)
      q = [0.5_dp, 0.1_dp, -0.7_dp, 0.5_dp]
      r = to_matrix(q/norm2(q))
   end function some_rotation

   function some_tensor() result(tensor)
      real(dp) :: tensor(3, 3), r(3, 3)
      r = some_rotation()
      tensor = matmul(r*spread(moments, 1, 3), transpose(r))
      tensor = tensor/2 + transpose(tensor)/2
   end function some_tensor

   !> Bodies in the principal frame.
   subroutine start(y, q)
      real(dp), intent(out) :: y(3, n), q(4, n)
      integer :: i
      do i = 1, n
         y(:, i) = [0.9_dp, 0.4_dp, -0.7_dp] + 0.1_dp*i
         q(:, i) = [0.5_dp, 0.1_dp*i, -0.7_dp, 0.5_dp]
         q(:, i) = q(:, i)/norm2(q(:, i))
      end do
   end subroutine start

   !> Settings of an effect that leave no key of a required kind or frame at rest; but axes that
   !> have
   !> a default keep it.
   subroutine some_settings(info, settings)
      type(effect_info), intent(in) :: info
      type(setting), allocatable, intent(out) :: settings(:)
      integer :: k
      allocate (settings(0))
      do k = 1, size(info%keys)
         if (info%keys(k)%is_text .and. info%keys(k)%default == "required") then
            settings = [settings, text_setting(trim(info%keys(k)%name), "Q11*Q23 + 2*Q32 - Q13")]
         else if (info%keys(k)%default == "required" .or. info%keys(k)%name == "value") then
            settings = &
               [settings, number_setting(trim(info%keys(k)%name), generic(:info%keys(k)%least))]
         end if
      end do
   end subroutine some_settings

   !> The same for a body in its principal frame, written by hand: vectors A^T v.
   subroutine turn_by_hand(info, axes, settings)
      type(effect_info), intent(in) :: info
      real(dp), intent(in) :: axes(3, 3)
      type(setting), allocatable, intent(inout) :: settings(:)
      integer :: i, k
      if (info%name == "spring") settings = [settings, &
         number_setting("axis", [0.0_dp, 0.0_dp, 1.0_dp])]
      do k = 1, size(info%keys)
         do i = 1, size(settings)
            if (settings(i)%key /= info%keys(k)%name) cycle
            if (index(info%keys(k)%frame, "vector") > 0) then
               settings(i)%values = matmul(transpose(axes), settings(i)%values)
            end if
         end do
      end do
      if (info%name == "potential") settings = [settings, number_setting("axes", &
         reshape(transpose(axes), [9]))]
   end subroutine turn_by_hand

   !> Every effect: motion and energies of a tensor class are those of its principal class.
   subroutine test_every_effect(error)
      type(error_type), allocatable, intent(out) :: error
      type(effect_info) :: info
      type(setting), allocatable :: settings(:)
      type(poinsot_plan) :: given, principal
      type(poinsot_error) :: problem
      real(dp) :: axes(3, 3)
      integer :: i, number
      do i = 1, effect_count
         info = describe_effect(i)
         if (info%name == "callback") cycle
         call renew(given)
         call renew(principal)
         call add_tensor_class(given, some_tensor(), number, problem)
         call class_axes(given, number, axes, problem)
         call add_class(principal, given%classes(1)%it%moments, number, problem)
         call some_settings(info, settings)
         call add_effect(given, trim(info%name), settings, problem)
         call turn_by_hand(info, axes, settings)
         call add_effect(principal, trim(info%name), settings, problem)
         call make_ready(given, problem)
         call make_ready(principal, problem)
         call expect(error, .not. raised(problem), trim(info%name))
         if (.not. allocated(error)) call same_motion(given, principal, axes, trim(info%name), &
            error)
         if (allocated(error)) return
      end do
   end subroutine test_every_effect

   subroutine renew(plan)
      type(poinsot_plan), intent(out) :: plan
      plan%threads = 1
   end subroutine renew

   subroutine same_motion(given, principal, axes, what, error)
      type(poinsot_plan), intent(in), target :: given, principal
      real(dp), intent(in) :: axes(3, 3)
      character(*), intent(in) :: what
      type(error_type), allocatable, intent(inout) :: error
      real(dp), target :: y(3, n), q(4, n), yg(3, n), qg(4, n)
      real(dp) :: k(n), u(n), kg(n), ug(n), a(4)
      type(body_view) :: view, view_g
      type(poinsot_error) :: problem
      integer :: status, i, j
      call start(y, q)
      a = from_matrix(axes)
      do i = 1, n
         yg(:, i) = matmul(axes, y(:, i))
         qg(:, i) = quaternion_product(q(:, i), quaternion_conjugate(a))
      end do
      call view_rows(y, q, view)
      call view_rows(yg, qg, view_g)
      do j = 1, 2
         call body_energies(principal, view, 0.3_dp, k, u, status, problem)
         call body_energies(given, view_g, 0.3_dp, kg, ug, status, problem)
         call expect(error, .not. raised(problem) .and. maxval(abs(k - kg)) < 1e-12_dp .and. &
                    maxval(abs(u - ug)) < 1e-12_dp, what//": energies")
         call step_bodies(principal, view, 0.0_dp, 0.1_dp, 0_i8, 20_i8, status, problem)
         call step_bodies(given, view_g, 0.0_dp, 0.1_dp, 0_i8, 20_i8, status, problem)
      end do
      do i = 1, n
         call expect(error, maxval(abs(yg(:, i) - matmul(axes, y(:, i)))) < 1e-12_dp .and. &
            maxval(abs(qg(:, i) - quaternion_product(q(:, i), quaternion_conjugate(a)))) &
            < 1e-12_dp, what//": motion")
      end do
   end subroutine same_motion

   !> user_torque and user_potential are asked in the given frame.
   subroutine test_own(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: own, known
      type(poinsot_error) :: problem
      class(effect), allocatable :: made
      integer :: form, number
      call renew(known)
      call add_tensor_class(known, some_tensor(), number, problem)
      call add_effect(known, "gravity", [number_setting("centre", generic)], problem)
      call make_ready(known, problem)
      do form = 1, 2
         call renew(own)
         call add_tensor_class(own, some_tensor(), number, problem)
         if (form == 1) allocate (own_torque :: made)
         if (form == 2) allocate (own_potential :: made)
         call add_ready_effect(own, made, problem)
         call make_ready(own, problem)
         call expect(error, .not. raised(problem), "refused")
         call same_motion(own, known, unit_matrix(), "own torque", error)
         if (allocated(error)) return
      end do
   end subroutine test_own

   pure function unit_matrix() result(e)
      real(dp) :: e(3, 3)
      integer :: i
      e = 0
      do i = 1, 3
         e(i, i) = 1
      end do
   end function unit_matrix

   subroutine evaluate_torque(self, t, q, torque, energy)
      class(own_torque), intent(in) :: self
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(4)
      real(dp), intent(out) :: torque(3), energy
      real(dp) :: g(3), a(3, 3)
      a = to_matrix(q)
      g = a(3, :)
      torque = [g(2)*generic(3) - g(3)*generic(2), g(3)*generic(1) - g(1)*generic(3), &
                g(1)*generic(2) - g(2)*generic(1)]
      energy = sum(g*generic) + 0*(t + self%class_index)
   end subroutine evaluate_torque

   subroutine evaluate_potential(self, t, attitude, energy, gradient)
      class(own_potential), intent(in) :: self
      real(dp), intent(in) :: t
      real(dp), intent(in) :: attitude(3, 3)
      real(dp), intent(out) :: energy, gradient(3, 3)
      energy = sum(attitude(3, :)*generic) + 0*(t + self%class_index)
      gradient = 0
      gradient(3, :) = generic
   end subroutine evaluate_potential

   !> Three frictions about the axes of a tensor: y' = y x w - F w, F diagonal in that frame, by
   !> Runge and Kutta.
   subroutine test_friction(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan), target :: plan
      type(poinsot_error) :: problem
      type(body_view) :: view
      real(dp), target :: y(3, 1), q(4, 1)
      real(dp) :: x(3), k1(3), k2(3), k3(3), k4(3), inverse(3, 3), r(3, 3)
      real(dp), parameter :: friction(3) = [0.2_dp, 1.0_dp, 3.0_dp], h = 1e-3_dp
      integer :: number, status, k
      call renew(plan)
      r = some_rotation()
      inverse = matmul(r*spread(1/moments, 1, 3), transpose(r))
      call add_tensor_class(plan, some_tensor(), number, problem)
      call add_effect(plan, "drag", [number_setting("friction", friction)], problem)
      call make_ready(plan, problem)
      call expect(error, .not. raised(problem), "refused")
      y(:, 1) = [0.9_dp, 0.4_dp, -0.7_dp]
      q(:, 1) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
      x = y(:, 1)
      call view_rows(y, q, view)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 500_i8, status, problem)
      do k = 1, 500
         k1 = slope(x)
         k2 = slope(x + h/2*k1)
         k3 = slope(x + h/2*k2)
         k4 = slope(x + h*k3)
         x = x + h/6*(k1 + 2*k2 + 2*k3 + k4)
      end do
      call expect(error, maxval(abs(y(:, 1) - x)) < 1e-6_dp, "another friction")
   contains
      pure function slope(v) result(rate)
         real(dp), intent(in) :: v(3)
         real(dp) :: rate(3), w(3)
         w = matmul(inverse, v)
         rate = [v(2)*w(3) - v(3)*w(2), v(3)*w(1) - v(1)*w(3), v(1)*w(2) - v(2)*w(1)] - friction*w
      end function slope
   end subroutine test_friction

   !> Moments in the order of the axes, to the bit; no axes.
   subroutine test_diagonal(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      real(dp) :: tensor(3, 3), axes(3, 3)
      integer :: number, i
      tensor = 0
      do i = 1, 3
         tensor(i, i) = moments(4 - i)
      end do
      call add_tensor_class(plan, tensor, number, problem)
      call class_axes(plan, 1, axes, problem)
      call expect(error, .not. raised(problem) .and. &
         all(plan%classes(1)%it%moments == moments(3:1:-1)) &
                 .and. all(axes == unit_matrix()), "diagonal")
      call class_axes(plan, 2, axes, problem)
      call expect(error, problem%code, poinsot_e_domain, "axes of no class")
   end subroutine test_diagonal

   !> Copies of effects made for a tensor class go when the plan is refused.
   subroutine test_again(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem, none
      integer :: number
      class(effect), allocatable :: made
      call add_tensor_class(plan, some_tensor(), number, problem)
      call add_effect(plan, "gravity", [number_setting("centre", generic)], problem)
      allocate (own_torque :: made)
      call add_ready_effect(plan, made, problem)
      call set_option(plan, "splitting", "chin4", problem)
      call make_ready(plan, problem)
      call expect(error, raised(problem) .and. size(plan%effects) == 2, "not refused")
      if (allocated(error)) return
      call set_option(plan, "splitting", "srkn4", none)
      call make_ready(plan, none)
      call expect(error, .not. raised(none), "not mended")
   end subroutine test_again

   !> A plan with a wheel.
   subroutine wheel_plan(plan, rotor, effect_name, text)
      type(poinsot_plan), intent(out) :: plan
      real(dp), intent(in) :: rotor(3)
      character(*), intent(in) :: effect_name, text
      type(setting), allocatable :: settings(:)
      type(poinsot_error) :: problem
      integer :: number
      plan%threads = 1
      call add_class(plan, moments, number, problem)
      call add_effect(plan, "gyrostat", [number_setting("rotor", rotor)], problem)
      if (effect_name == "") return
      call read_settings(text, settings, problem)
      call add_effect(plan, effect_name, settings, problem)
   end subroutine wheel_plan

   !> At rest, y = s, and stays so.
   subroutine test_wheel_drag(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan), target :: plan
      type(poinsot_error) :: problem
      type(body_view) :: view
      real(dp), target :: y(3, 1), q(4, 1)
      integer :: status
      call wheel_plan(plan, [0.0_dp, 0.0_dp, 1.0_dp], "drag", "friction = 1")
      call make_ready(plan, problem)
      y(:, 1) = [0.0_dp, 0.0_dp, 1.0_dp]
      q(:, 1) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
      call view_rows(y, q, view)
      call step_bodies(plan, view, 0.0_dp, 0.01_dp, 0_i8, 500_i8, status, problem)
      call expect(error, maxval(abs(y(:, 1) - [0.0_dp, 0.0_dp, 1.0_dp])) < 1e-13_dp, "spun up")
   end subroutine test_wheel_drag

   !> <(y - s)^2/I> = kT on each axis, <y> = s.
   subroutine test_wheel_heat(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: many = 20000
      type(poinsot_plan), target :: plan
      type(poinsot_error) :: problem
      type(body_view) :: view
      real(dp), allocatable, target :: y(:, :), q(:, :)
      real(dp) :: heat(3)
      integer :: status, j
      allocate (y(3, many), q(4, many))
      call wheel_plan(plan, [0.0_dp, 0.0_dp, 3.0_dp], "langevin", "friction = 2; temperature = 1")
      call make_ready(plan, problem)
      y = 0
      q = spread([1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 2, many)
      call view_rows(y, q, view)
      call step_bodies(plan, view, 0.0_dp, 0.1_dp, 0_i8, 50_i8, status, problem)
      y(3, :) = y(3, :) - 3
      do j = 1, 3
         heat(j) = sum(y(j, :)**2)/many/moments(j)
      end do
      call expect(error, maxval(abs(heat - 1)) < 0.05_dp .and. &
                 maxval(abs(sum(y, 2)))/many < 0.05_dp, "not kT about the wheel")
   end subroutine test_wheel_heat

   !> poinsot_drift is poinsot_step without effects.
   subroutine test_wheel_drift(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan), target :: plan
      type(poinsot_error) :: problem
      type(body_view) :: view, view2
      real(dp), target :: y(3, n), q(4, n), y2(3, n), q2(4, n)
      integer :: status
      call wheel_plan(plan, generic, "", "")
      call make_ready(plan, problem)
      call start(y, q)
      y2 = y
      q2 = q
      call view_rows(y, q, view)
      call view_rows(y2, q2, view2)
      call drift_bodies(plan, view, 0.2_dp, status, problem)
      call step_bodies(plan, view2, 0.0_dp, 0.2_dp, 0_i8, 1_i8, status, problem)
      call expect(error, all(y == y2) .and. all(q == q2), "drift is not the step")
   end subroutine test_wheel_drift

   !> omega = I^-1 (y - s) in every layout with velocities.
   subroutine test_wheel_velocity(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan), target :: plan, momentum
      type(poinsot_error) :: problem
      type(body_view) :: view, view2
      real(dp), target :: y(3, n), q(4, n), w(3, n), q2(4, n)
      character(14), parameter :: names(2) = [character(14) :: "body-velocity", "space-velocity"]
      integer :: status, form, i
      call wheel_plan(momentum, generic, "", "")
      call make_ready(momentum, problem)
      do form = 1, 2
         call wheel_plan(plan, generic, "", "")
         call set_option(plan, "momentum", trim(names(form)), problem)
         call make_ready(plan, problem)
         call start(y, q)
         q2 = q
         call velocities(y, q, form, w)
         call view_rows(y, q, view)
         call view_rows(w, q2, view2)
         call step_bodies(momentum, view, 0.0_dp, 0.1_dp, 0_i8, 5_i8, status, problem)
         call step_bodies(plan, view2, 0.0_dp, 0.1_dp, 0_i8, 5_i8, status, problem)
         call velocities(y, q, form, y)
         do i = 1, n
            call expect(error, maxval(abs(w(:, i) - y(:, i))) < 1e-13_dp .and. &
                       maxval(abs(q2(:, i) - q(:, i))) < 1e-13_dp, names(form))
         end do
      end do
   end subroutine test_wheel_velocity

   subroutine velocities(y, q, form, w)
      real(dp), intent(in) :: y(3, n), q(4, n)
      integer, intent(in) :: form            !! 1 body, 2 space
      real(dp), intent(out) :: w(3, n)
      real(dp) :: v(3, n)
      integer :: i
      do i = 1, n
         v(:, i) = (y(:, i) - generic)/moments
         if (form == 2) v(:, i) = matmul(to_matrix(q(:, i)), v(:, i))
      end do
      w = v
   end subroutine velocities

   !> A turn beyond 1e15 radians: a status, and the state of before. A rotor beyond 1e70: refused.
   subroutine test_wheel_fast(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan), target :: plan
      type(poinsot_error) :: problem
      type(body_view) :: view
      real(dp), target :: y(3, n), q(4, n), y2(3, n), q2(4, n)
      real(dp), parameter :: rotors(2) = [1e17_dp, 1e60_dp], steps(2) = [1.0_dp, 1e155_dp]
      integer, target :: each(n)
      integer :: status, i
      do i = 1, 2
         call wheel_plan(plan, [0.0_dp, 0.0_dp, rotors(i)], "", "")
         call make_ready(plan, problem)
         call start(y, q)
         y2 = y
         q2 = q
         call view_rows(y, q, view)
         view%status => each
         call step_bodies(plan, view, 0.0_dp, steps(i), 0_i8, 1_i8, status, problem)
         call expect(error, status == poinsot_e_partial .and. all(each == poinsot_e_step) .and. &
                    all(y == y2) .and. all(q == q2), "a turn without a right digit")
      end do
      call wheel_plan(plan, [0.0_dp, 0.0_dp, 1e155_dp], "", "")
      call make_ready(plan, problem)
      call expect(error, problem%code, poinsot_e_domain, "a rotor beyond 1e70")
   end subroutine test_wheel_fast

   !> Up to 1e-6 of |y| it is dropped, in the caller's array too, whatever its variable; beyond it
   !> is
   !> refused with a status of its own.
   subroutine test_axis(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan), target :: plan
      type(poinsot_error) :: problem
      type(body_view) :: view
      real(dp), target :: y(3, n), q(4, n)
      real(dp) :: before(3), axis(3), a(3, 3)
      character(14), parameter :: names(2) = [character(14) :: "body-momentum", "space-momentum"]
      integer, target :: each(n)
      integer :: form, number, status
      do form = 1, 2
         call renew(plan)
         call add_class(plan, [0.0_dp, 1.0_dp, 1.0_dp], number, problem)
         call set_option(plan, "momentum", trim(names(form)), problem)
         call make_ready(plan, problem)
         call start(y, q)
         y(:, 1) = [9e-7_dp, 0.6_dp, 0.8_dp]
         y(:, 2) = [1.1e-6_dp, 0.6_dp, 0.8_dp]
         y(:, 3) = [0.0_dp, 0.6_dp, 0.8_dp]
         if (form == 2) call to_space(y, q)
         before = y(:, 3)
         call view_rows(y, q, view)
         view%status => each
         call drift_bodies(plan, view, 0.1_dp, status, problem)
         call expect(error, all(each == [poinsot_ok, poinsot_e_axis_momentum, poinsot_ok]), &
            names(form))
         axis = [1.0_dp, 0.0_dp, 0.0_dp]
         a = to_matrix(q(:, 1))
         if (form == 2) axis = a(:, 1)
         call expect(error, abs(sum(axis*y(:, 1))) < 1e-15_dp, names(form)//" keeps it")
         if (form == 2) call expect(error, all(y(:, 3) == before), &
            "a momentum that is kept, changed")
      end do
   end subroutine test_axis

   subroutine to_space(y, q)
      real(dp), intent(inout) :: y(3, n)
      real(dp), intent(in) :: q(4, n)
      integer :: i
      do i = 1, n
         y(:, i) = matmul(to_matrix(q(:, i)), y(:, i))
      end do
   end subroutine to_space

end module test_frame
