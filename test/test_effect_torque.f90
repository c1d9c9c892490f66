!> Torque against energy, force gradient against torque, axes and bodies that feel nothing.
module test_effect_torque
   use testdrive, only: new_unittest, unittest_type, error_type, test_failed
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_error, only: poinsot_error
   use poinsot_body_class, only: body_class, make_class
   use poinsot_effect_effect, only: effect, effect_item, torque_effect, pair_effect
   use poinsot_effect_callback, only: user_potential, torque_of_gradient
   use poinsot_effect_registry, only: make_effect
   use poinsot_effect_settings, only: number_setting, text_setting
   use test_bodies, only: random_stream, start_stream, uniform, random_quaternion
   use test_expectation, only: expect
   use test_oracle_algebra, only: quaternion_product, rotate_back
   use test_turning, only: bench, set_up, place, generic_moments_of, generic_q
   implicit none(type, external)
   private
   public :: collect_torque, energy_of, states

   !> U = Q33 and dU/dQ, as a user would write it: the review's heavy top.
   type, extends(user_potential) :: review_top
   contains
      procedure :: evaluate => evaluate_top
   end type review_top

contains

   subroutine collect_torque(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("torque-is-minus-gradient", test_torques), &
         new_unittest("derivative-of-torque", test_derivatives), &
         new_unittest("force-gradient-of-the-top", test_top_gradient), &
         new_unittest("dipoles-torque-and-derivative", test_dipoles), &
         new_unittest("dipoles-dealt-out-otherwise", test_dipole_blocks), &
         new_unittest("callback-is-equation-8", test_callback), &
         new_unittest("frozen-axis", test_frozen_axis), &
         new_unittest("sphere-feels-no-gradient", test_sphere)]
   end subroutine collect_torque

   !> Body torque = -dU along Q -> Q exp(hat(delta)), by central differences; every effect with a
   !> potential.
   subroutine test_torques(error)
      type(error_type), allocatable, intent(out) :: error
      type(effect_item), allocatable :: effects(:)
      real(dp) :: q(lanes, 4), g(lanes, 3), up(lanes), down(lanes), w(3)
      real(dp), parameter :: step = 1e-5_dp, t = 0.7_dp
      integer :: i, j
      call all_torques(effects)
      q = states(2)
      do i = 1, size(effects)
         if (effects(i)%it%name == "torque") cycle
         call torque_at(effects(i)%it, q, t, g)
         do j = 1, 3
            w = 0
            w(j) = step
            call energy_of(effects(i)%it, moved(q, w), t, up)
            call energy_of(effects(i)%it, moved(q, -w), t, down)
            call expect(error, maxval(abs(g(:, j) + (up - &
                       down)/(2*step))) < 1e-9_dp*maxval(abs(g)), "torque of "//effects(i)%it%name)
         end do
         call expect(error, maxval(abs(g)) > 0.1_dp, "no torque of "//effects(i)%it%name)
      end do
   end subroutine test_torques

   !> Dg[delta] by central differences of the torque.
   subroutine test_derivatives(error)
      type(error_type), allocatable, intent(out) :: error
      type(effect_item), allocatable :: effects(:)
      type(random_stream) :: stream
      type(body_class) :: class
      real(dp) :: q(lanes, 4), up(lanes, 3), down(lanes, 3), dg(lanes, 3), w(lanes, 3)
      real(dp), parameter :: step = 1e-5_dp, t = 0.7_dp
      integer :: i, j, l
      call all_torques(effects)
      q = states(3)
      stream = start_stream(11)
      do j = 1, 3
         do l = 1, lanes
            w(l, j) = 2*uniform(stream) - 1
         end do
      end do
      class = generic_class()
      do i = 1, size(effects)
         select type (one => effects(i)%it)
         class is (torque_effect)
            call expect(error, one%has_gradient(), "no gradient: "//one%name)
            dg = 0
            call one%add_derivative(class, t, q, w, dg)
            call torque_at(one, each_moved(q, step*w), t, up)
            call torque_at(one, each_moved(q, -step*w), t, down)
            call expect(error, maxval(abs(dg - (up - down)/(2*step))) < 1e-9_dp*max(1.0_dp, &
                       maxval(abs(dg))), "derivative of "//one%name)
         end select
      end do
   end subroutine test_derivatives

   !> Section 6: U = Q33, G = (2 g2 g3/I1, -2 g1 g3/I2, -2 g1 g2 (1/I1 - 1/I2)).
   subroutine test_top_gradient(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      type(poinsot_error) :: refusal
      real(dp) :: m(3), v(3), g(3)
      allocate (effects(1))
      call make_effect("gravity", [number_setting("centre", [0.0_dp, 0.0_dp, 1.0_dp])], &
         effects(1)%it, refusal)
      call set_up(it, generic_moments_of, "exact", "chin4", effects)
      call place(it, [0.0_dp, 0.0_dp, 0.0_dp], generic_q)
      call it%block%kick(0.0_dp, 0.0_dp, 1.0_dp, 0.0_dp)
      m = 1/generic_moments_of
      v = rotate_back(generic_q, [0.0_dp, 0.0_dp, 1.0_dp])
      g = [2*v(2)*v(3)*m(1), -2*v(1)*v(3)*m(2), -2*v(1)*v(2)*(m(1) - m(2))]
      call expect(error, maxval(abs(it%block%y(1, :) - g)) < 1e-15_dp, &
         "force gradient of the heavy top")
   end subroutine test_top_gradient

   !> Five dipoles of two classes anywhere: torque = -dU on each, and Dg[delta] with all of them
   !> turning.
   subroutine test_dipoles(error)
      type(error_type), allocatable, intent(out) :: error
      class(effect), allocatable :: made
      real(dp) :: q(lanes, 4, 2), g(lanes, 3, 2), p(lanes, 4, 2), u(lanes, 2), up, down, w(3)
      real(dp) :: dg(lanes, 3, 2), delta(lanes, 3, 2), high(lanes, 3, 2), low(lanes, 3, 2), x(3, &
         5), z(3, 5)
      real(dp), parameter :: step = 1e-5_dp
      integer :: body(lanes, 2), k, l, j
      call five_dipoles(made, body)
      q(:, :, 1) = states(4)
      q(:, :, 2) = states(5)
      select type (made)
      class is (pair_effect)
         call expect(error, made%bodies(), 5)
         g = 0
         call made%add_torques([1, 2], body, q, x, g)
         do k = 1, 2
            do l = 1, 4 - k
               do j = 1, 3
                  w = 0
                  w(j) = step
                  p = q
                  p(l, :, k) = quaternion_product(q(l, :, k), turn_of(w))
                  u = 0
                  call made%add_energies([1, 2], body, p, x, u)
                  up = sum(u)
                  p(l, :, k) = quaternion_product(q(l, :, k), turn_of(-w))
                  u = 0
                  call made%add_energies([1, 2], body, p, x, u)
                  down = sum(u)
                  call expect(error, abs(g(l, j, k) + (up - down)/(2*step)) &
                     < 1e-9_dp*maxval(abs(g)), "torque")
               end do
            end do
         end do
         call expect(error, all(g(4:, :, 1) == 0) .and. all(g(3:, :, 2) == 0), &
            "padding feels a torque")
         p(:, :, 1) = states(6)
         p(:, :, 2) = states(7)
         delta = p(:, 1:3, :)
         dg = 0
         call made%add_derivatives([1, 2], body, q, delta, sources_of(made, body, q), z, dg)
         high = 0
         low = 0
         do k = 1, 2
            p(:, :, k) = each_moved(q(:, :, k), step*delta(:, :, k))
         end do
         call made%add_torques([1, 2], body, p, x, high)
         do k = 1, 2
            p(:, :, k) = each_moved(q(:, :, k), -step*delta(:, :, k))
         end do
         call made%add_torques([1, 2], body, p, x, low)
         call expect(error, maxval(abs(dg - &
                    (high - low)/(2*step))) < 1e-9_dp*maxval(abs(dg)), "derivative")
      class default
         call test_failed(error, "dipoles are not a pair effect")
      end select
   end subroutine test_dipoles

   function sources_of(made, body, q) result(x)
      class(pair_effect), intent(in) :: made
      integer, intent(in) :: body(lanes, 2)
      real(dp), intent(in) :: q(lanes, 4, 2)
      real(dp) :: x(3, 5)
      integer :: k
      x = 0
      do k = 1, 2
         call made%scatter_source(k, body(:, k), q(:, :, k), x)
      end do
   end function sources_of

   subroutine five_dipoles(made, body)
      class(effect), allocatable, intent(out) :: made
      integer, intent(out) :: body(lanes, 2)
      type(poinsot_error) :: refusal
      call make_effect("dipoles", &
                       [number_setting("dipole", [0.3_dp, 0.4_dp, 1.0_dp, 0.0_dp, -0.7_dp, &
                       0.2_dp]), number_setting("coupling", [1.7_dp]), number_setting("positions", &
                       [0.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, 0.2_dp, 0.0_dp, 0.1_dp, 1.1_dp, 0.3_dp, &
                       -0.9_dp, 0.4_dp, 0.8_dp, 0.5_dp, -0.6_dp, 1.0_dp])], made, refusal)
      body = 0
      body(1:3, 1) = [2, 5, 1]
      body(1:2, 2) = [4, 3]
   end subroutine five_dipoles

   !> Torques do not depend, to the bit, on which block and lane a body sits in.
   subroutine test_dipole_blocks(error)
      type(error_type), allocatable, intent(out) :: error
      class(effect), allocatable :: made
      real(dp) :: q(lanes, 4, 2), g(lanes, 3, 2), q2(lanes, 4, 2), g2(lanes, 3, 2), x(3, 5)
      integer :: body(lanes, 2), body2(lanes, 2)
      call five_dipoles(made, body)
      q(:, :, 1) = states(4)
      q(:, :, 2) = states(5)
      body2 = 0
      body2(11:12, 2) = body(2:1:-1, 1)
      body2(20, 1) = body(3, 1)
      q2 = q
      q2(11:12, :, 2) = q(2:1:-1, :, 1)
      q2(20, :, 1) = q(3, :, 1)
      body(1:2, 2) = 0
      g = 0
      g2 = 0
      select type (made)
      class is (pair_effect)
         call made%add_torques([1, 1], body, q, x, g)
         call made%add_torques([1, 1], body2, q2, x, g2)
      end select
      call expect(error, all(g2(11:12, :, 2) == g(2:1:-1, :, 1)) .and. &
                 all(g2(20, :, 1) == g(3, :, 1)) .and. any(g(3, :, 1) /= 0), "bits of dipoles")
   end subroutine test_dipole_blocks

   !> The review's top through dU/dQ: the torque of `gravity`, and equation (8) by its signs.
   subroutine test_callback(error)
      type(error_type), allocatable, intent(out) :: error
      class(effect), allocatable :: gravity
      type(review_top) :: top
      type(poinsot_error) :: refusal
      real(dp) :: g(lanes, 3), h(lanes, 3), u(lanes), v(lanes), one(3, 3)
      integer :: i
      call make_effect("gravity", [number_setting("centre", [0.0_dp, 0.0_dp, 1.0_dp])], &
                       gravity, refusal)
      call torque_at(gravity, states(8), 0.0_dp, g)
      call torque_at(top, states(8), 0.0_dp, h)
      call energy_of(gravity, states(8), 0.0_dp, u)
      call energy_of(top, states(8), 0.0_dp, v)
      call expect(error, maxval(abs(g - h)) < 1e-15_dp .and. maxval(abs(u - v)) < 1e-15_dp, &
         "not the top")
      one = 0
      do i = 1, 3
         one(i, i) = 1
      end do
      call expect(error, maxval(abs(torque_of_gradient(one, &
                 reshape([0.0_dp, 1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], &
                 [3, 3])) - [0.0_dp, 0.0_dp, -1.0_dp])) <= 0, "signs")
   end subroutine test_callback

   subroutine evaluate_top(self, t, attitude, energy, gradient)
      class(review_top), intent(in) :: self
      real(dp), intent(in) :: t, attitude(3, 3)
      real(dp), intent(out) :: energy, gradient(3, 3)
      energy = attitude(3, 3) + 0*t*self%class_index
      gradient = 0
      gradient(3, 3) = 1
   end subroutine evaluate_top

   !> An axis without inertia takes neither torque nor gradient kick.
   subroutine test_frozen_axis(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      integer :: j
      real(dp) :: moments(3), y(3)
      call all_torques(effects)
      do j = 1, 3
         moments = 2
         moments(j) = 0
         y = 1
         y(j) = 0
         call set_up(it, moments, "exact", "omelyan4", effects)
         call expect(error, it%good, it%message)
         call place(it, y, generic_q)
         call it%block%kick(0.3_dp, 0.1_dp, 0.1_dp, 0.0_dp)
         call expect(error, all(it%block%y(:, j) == 0) .and. all(abs(it%block%y(1, :) - y) &
            > 0 .or. y == 0), "kick")
      end do
   end subroutine test_frozen_axis

   subroutine test_sphere(error)
      type(error_type), allocatable, intent(out) :: error
      class(effect), allocatable :: made
      type(body_class) :: class
      type(poinsot_error) :: refusal
      real(dp) :: g(lanes, 3)
      call make_effect("gravity_gradient", [number_setting("rate", [1.0_dp])], made, refusal)
      call make_class([0.7_dp, 0.7_dp, 0.7_dp], class, refusal)
      g = 0
      select type (made)
      class is (torque_effect)
         call made%add_torque(class, 0.0_dp, states(9), g)
      end select
      call expect(error, all(g == 0), "a sphere is turned by a gravity gradient")
   end subroutine test_sphere

   !> One of each torque, generic, moving ones too.
   subroutine all_torques(effects)
      type(effect_item), allocatable, intent(out) :: effects(:)
      type(poinsot_error) :: refusal
      real(dp), parameter :: a(3) = [0.3_dp, -0.5_dp, 0.7_dp], b(3) = [1.0_dp, 2.0_dp, -1.5_dp]
      allocate (effects(11))
      call make_effect("gravity", [number_setting("centre", a), number_setting("up", b)], &
         effects(1)%it, refusal)
      call make_effect("field", [number_setting("dipole", a), number_setting("strength", b), &
         number_setting("frequency", [1.0_dp]), number_setting("axis", [1.0_dp, 1.0_dp, 3.0_dp]), &
         text_setting("motion", "rotating")], effects(2)%it, refusal)
      call make_effect("gravity_gradient", [number_setting("rate", [1.3_dp]), &
         number_setting("radial", b), &
         number_setting("normal", [-2.0_dp, 1.0_dp, 0.0_dp])], effects(3)%it, refusal)
      call make_effect("spring", [number_setting("stiffness", [1.1_dp]), number_setting("axis", &
                       a), number_setting("direction", b)], effects(4)%it, refusal)
      call make_effect("torque", [number_setting("value", a), text_setting("frame", "space")], &
         effects(5)%it, refusal)
      call make_effect("torque", [number_setting("value", b)], effects(6)%it, refusal)
      ! every function of formulas, and every operation on two things
      call make_effect("potential", [text_setting("u", "k*(1 - Q33)^2 + 2^Q12*Q21 - Q13/(3 - Q22)" &
         // " + (3 + Q31)^0.3 + (2 + Q11)^-2 + (4 + Q23)^Q32 + sqrt(2 + Q32*Q12)"), &
         text_setting("constants", "K = 1.5")], effects(7)%it, refusal)
      call make_effect("potential", [text_setting("u", "exp(Q11*Q22) + log(3 + Q13) - sin(w*t)" &
         // "*sin(2*Q21)*cos(3*Q33) + tan(Q32/2) + atan2(Q23 - 0.1, Q12 + 3) + pi*Q11"), &
         text_setting("constants", "w = 0.9")], effects(8)%it, refusal)
      call make_effect("potential", [text_setting("u", "asin(Q11/2) + acos(Q22/2)*Q12 + " // &
         "atan(2*Q33) + sinh(Q13) - cosh(Q31)*Q32 + tanh(3*Q21) + abs(Q23 + 2) - " // &
         "min(Q11, 2, 3 + Q31) + max(Q12*Q12, -1)")], effects(9)%it, refusal)
      call make_effect("potential", [text_setting("u", "(Q11 + 2*Q12 - Q33)^2"), &
         number_setting("axes", [a, b, a - b])], effects(10)%it, refusal)
      call make_effect("gravity_gradient", [number_setting("rate", [1.3_dp]), &
         number_setting("eccentricity", [0.3_dp]), number_setting("anomaly", [1.0_dp])], &
         effects(11)%it, refusal)
   end subroutine all_torques

   pure function turn_of(w) result(r)
      real(dp), intent(in) :: w(3)
      real(dp) :: r(4)
      r = [sqrt(1 - 0.25_dp*dot_product(w, w)), 0.5_dp*w]   ! exp(w/2) up to third order
   end function turn_of

   pure function moved(q, w) result(p)
      real(dp), intent(in) :: q(lanes, 4), w(3)
      real(dp) :: p(lanes, 4)
      p = each_moved(q, spread(w, 1, lanes))
   end function moved

   pure function each_moved(q, w) result(p)
      real(dp), intent(in) :: q(lanes, 4), w(lanes, 3)
      real(dp) :: p(lanes, 4)
      integer :: l
      do l = 1, lanes
         p(l, :) = quaternion_product(q(l, :), turn_of(w(l, :)))
      end do
   end function each_moved

   subroutine torque_at(one, q, t, g)
      class(effect), intent(in) :: one
      real(dp), intent(in) :: q(lanes, 4), t
      real(dp), intent(out) :: g(lanes, 3)
      g = 0
      select type (one)
      class is (torque_effect)
         call one%add_torque(generic_class(), t, q, g)
      end select
   end subroutine torque_at

   subroutine energy_of(one, q, t, u)
      class(effect), intent(in) :: one
      real(dp), intent(in) :: q(lanes, 4), t
      real(dp), intent(out) :: u(lanes)
      u = 0
      select type (one)
      class is (torque_effect)
         call one%add_energy(generic_class(), t, q, u)
      end select
   end subroutine energy_of

   function generic_class() result(class)
      type(body_class) :: class
      type(poinsot_error) :: refusal
      call make_class(generic_moments_of, class, refusal)
   end function generic_class

   function states(seed) result(q)
      integer, intent(in) :: seed
      real(dp) :: q(lanes, 4)
      type(random_stream) :: stream
      integer :: l
      stream = start_stream(seed)
      do l = 1, lanes
         q(l, :) = random_quaternion(stream)
      end do
   end function states

end module test_effect_torque
