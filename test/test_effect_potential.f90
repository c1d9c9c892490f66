!> Effect potential: formulas against the effects they stand for, what they mean, what they refuse,
!> and what happens where they have no value.
module test_effect_potential
   use testdrive, only: new_unittest, unittest_type, error_type
   use test_expectation, only: expect, within
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_quiet, only: is_number
   use poinsot_effect_effect, only: effect, torque_effect
   use poinsot_effect_gravity_gradient, only: gravity_gradient
   use poinsot_effect_registry, only: make_effect
   use poinsot_effect_settings_text, only: read_settings
   use poinsot_effect_settings, only: setting, text_setting
   use poinsot_body_class, only: body_class, make_class
   use poinsot_rotation_random, only: random_quaternion
   implicit none(type, external)
   private
   public :: collect_potential

   real(dp), parameter :: moments(3) = [0.6_dp, 0.8_dp, 1.1_dp], t = 0.7_dp

contains

   subroutine collect_potential(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("formulas-of-built-in-effects", test_known), &
         new_unittest("formulas-mean", test_meaning), &
         new_unittest("formulas-refused", test_refused), &
         new_unittest("formulas-without-a-value", test_no_value), &
         new_unittest("eccentric-orbit", test_orbit)]
   end subroutine collect_potential

   !> Torque, energy and derivative of the effect and of its formula, to 1e-14 of the largest.
   subroutine test_known(error)
      type(error_type), allocatable, intent(out) :: error
      call same("gravity", "centre = 0.3, -0.5, 0.7; weight = 1.3; up = 0.6, 0, 0.8", &
         "u = 'm*(0.3*(0.6*Q11 + 0.8*Q31) - 0.5*(0.6*Q12 + 0.8*Q32) + 0.7*(0.6*Q13 + 0.8*Q33))'; &
         &constants = m = 1.3")
      call same("field", "dipole = 0.3, -0.5, 0.7; strength = 1, 0, 2; motion = oscillating; &
         &frequency = 3", "u = '-cos(3*t)*((0.3*Q11 - 0.5*Q12 + 0.7*Q13) + 2*(0.3*Q31 - 0.5*Q32 + &
         &0.7*Q33))'")
      call same("field", "dipole = 0.3, -0.5, 0.7; strength = 1, 0, 2; motion = rotating; &
         &frequency = 3", "u = '-(cos(w*t)*(0.3*Q11 - 0.5*Q12 + 0.7*Q13) + sin(w*t)*(0.3*Q21 - &
         &0.5*Q22 + 0.7*Q23) + 2*(0.3*Q31 - 0.5*Q32 + 0.7*Q33))'; constants = w = 3")
      call same("spring", "stiffness = 1.5; axis = 0, 0.6, 0.8; direction = 0, 0, 1", &
         "u = '-k/2*(0.6*Q32 + 0.8*Q33)^2'; constants = k = 1.5")
      call same("gravity_gradient", "rate = 1.2; radial = 0, 0, 1; orbit = fixed", &
         "u = '3/2*n^2*(0.6*Q31^2 + 0.8*Q32^2 + 1.1*Q33^2)'; constants = n = 1.2")

   contains

      subroutine same(name, settings, words)
         character(*), intent(in) :: name, settings, words
         real(dp) :: g(lanes, 3), u(lanes), dg(lanes, 3), h(lanes, 3), v(lanes), dh(lanes, 3)
         class(effect), allocatable :: one, other
         call make(name, settings, one, error)
         call make("potential", words, other, error)
         if (allocated(error)) return
         call ask(one, attitudes(), g, u, dg)
         call ask(other, attitudes(), h, v, dh)
         call within(error, maxval(abs(h - g))/maxval(abs(g)), 1e-14_dp, "torque of " // name)
         call within(error, maxval(abs(v - u))/maxval(abs(u)), 1e-14_dp, "energy of " // name)
         call within(error, maxval(abs(dh - dg))/maxval(abs(dg)), 1e-14_dp, "gradient of " // name)
      end subroutine same

   end subroutine test_known

   pure function attitudes() result(q)
      real(dp) :: q(lanes, 4)
      integer :: l
      do l = 1, lanes
         q(l, :) = random_quaternion(3_i8, int(l, i8))
      end do
   end function attitudes

   subroutine make(name, settings, made, error)
      character(*), intent(in) :: name, settings
      class(effect), allocatable, intent(out) :: made
      type(error_type), allocatable, intent(inout) :: error
      type(setting), allocatable :: list(:)
      type(poinsot_error) :: failure
      call read_settings(settings, list, failure)
      if (.not. raised(failure)) call make_effect(name, list, made, failure)
      if (raised(failure)) call expect(error, .false., failure%message)
   end subroutine make

   subroutine ask(one, q, g, u, dg)
      class(effect), intent(in) :: one
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(out) :: g(lanes, 3), u(lanes), dg(lanes, 3)
      real(dp) :: delta(lanes, 3)
      type(body_class) :: class
      type(poinsot_error) :: failure
      call make_class(moments, class, failure)
      g = 0
      u = 0
      dg = 0
      delta(:, 1) = 0.3_dp
      delta(:, 2) = -0.2_dp
      delta(:, 3) = 0.9_dp
      select type (one)
      class is (torque_effect)
         call one%add_torque(class, t, q, g)
         call one%add_energy(class, t, q, u)
         call one%add_derivative(class, t, q, delta, dg)
      end select
   end subroutine ask

   !> Precedence, numbers, names in either case.
   subroutine test_meaning(error)
      type(error_type), allocatable, intent(out) :: error
      call is("-2^2", -4.0_dp)
      call is("2^3^2", 512.0_dp)
      call is("2**3 ** 2", 512.0_dp)
      call is("1 - 2 - 3", -4.0_dp)
      call is("8/4/2", 1.0_dp)
      call is("2^-1 + .5e0 + 1E+1 - 5.", 6.0_dp)
      call is("-(-3)*+2", 6.0_dp)
      call is("min(3, 1, 2) + max(3, 1, 4)", 5.0_dp)
      call is("Atan2(1, -1)/PI", 0.75_dp)
      call is("t", t)
      call is("2*Kappa_1 + kappa_1", 0.75_dp)
      call is("Q11^0 + 0*q11", 1.0_dp)
      call is("(1 + 2)^4", 81.0_dp)
      call is("9^0.5 + 8^(1/3) + 2^t", 5 + 2**t)
      call is("tan(0.5) - sin(0.5)/cos(0.5)", 0.0_dp)

   contains

      subroutine is(words, value)
         character(*), intent(in) :: words
         real(dp), intent(in) :: value
         class(effect), allocatable :: one
         real(dp) :: g(lanes, 3), u(lanes), dg(lanes, 3)
         call make("potential", "u = '" // words // "'; constants = 'm=-1,Kappa_1 = 0.25'", one, &
            error)
         if (allocated(error)) return
         call ask(one, attitudes(), g, u, dg)
         call within(error, maxval(abs(u - value)), 2e-15_dp, words)
         call within(error, maxval(abs(g)) + maxval(abs(dg)), 0.0_dp, "torque of " // words)
      end subroutine is

   end subroutine test_meaning

   !> What is wrong, and at which character.
   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      call is("k*(1 - Q34)", "k = 1", "character 8: unknown name 'q34'; the nearest")
      call is("2*(Q33 + 1", "", "character 11: ) is expected")
      call is("2*Q33)", "", "character 6: ')' is not expected here")
      call is("2 Q33", "", "character 3: 'Q' is not expected here")
      call is("2*", "", "character 3: ends where a number, a name or ( is expected")
      call is("sin Q33", "", "character 5: ( is expected")
      call is("atan2(Q33)", "", "character 10: , is expected")
      call is("Q33 # 2", "", "character 5: '#' is not expected here")
      call is("1e400*Q33", "", "character 1: a finite number is expected")
      call is("1/0*Q33", "", "a constant part that is not a finite number")
      call is("k*Q33", "k = 1, k = 2", "character 8: 'k' has a meaning already")
      call is("k*Q33", "sin = 1", "character 1: 'sin' has a meaning already")
      call is("k*Q33", "k 1", "character 3: = is expected behind 'k'")
      call is("k*Q33", "k = x", "character 5: a finite number is expected")
      call is("k*Q33", "k = 1 l = 2", "character 7: a comma is expected")
      call is(repeat("(", 200) // "Q33" // repeat(")", 200), "", "more than 100 parentheses")
      call is("Q33" // repeat(" + sin(2*Q33)*t", 90) // &
         repeat(" + 2*Q11*cos(3*Q22 + Q33 + 4)^Q21", &
         99), "", "")
      call is(sum_of_many(), "", "more than 200 operations")

   contains

      subroutine is(words, constants, part)
         character(*), intent(in) :: words, constants, part
         class(effect), allocatable :: one
         type(poinsot_error) :: failure
         call make_effect("potential", [text_setting("u", words), &
            text_setting("constants", constants)], one, failure)
         if (part == "" .and. .not. raised(failure)) return
         call expect(error, raised(failure), "taken: " // words)
         if (raised(failure)) call expect(error, index(failure%message, part) > 0, failure%message)
      end subroutine is

      !> A formula of 300 different terms.
      function sum_of_many() result(words)
         character(:), allocatable :: words
         character(20) :: term
         integer :: i
         words = "Q33"
         do i = 1, 300
            write (term, "(a, i0, a)") " + sin(", i, "*Q11)"
            words = words // trim(term)
         end do
      end function sum_of_many

   end subroutine test_refused

   !> A body where the formula has no finite value gets none, and nobody else; nothing traps (this
   !> runs with traps on).
   subroutine test_no_value(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: words(8) = [character(40) :: "sqrt(1 - Q33^2)", "1/Q12", &
         "log(Q12)", "log(-1 - Q12^2)*Q11", "exp(1e6*Q33)", "1e300*Q33*1e300*Q33", "acos(2*Q33)", &
         "Q33^(-1.5)*Q12^t"]
      class(effect), allocatable :: one
      real(dp) :: q(lanes, 4), g(lanes, 3), u(lanes), dg(lanes, 3), alone(lanes, 3)
      integer :: i, l
      do i = 1, size(words)
         call make("potential", "u = '" // trim(words(i)) // "'", one, error)
         if (allocated(error)) return
         q = attitudes()
         q(2, :) = [1, 0, 0, 0]
         call ask(one, q, g, u, dg)
         call expect(error, .not. all(is_number(g(2, :))), "a torque of " // words(i))
         do l = 1, lanes
            call expect(error, all(is_number(g(l, :))) .or. .not. any(is_number(g(l, :))), &
               "half a torque of " // words(i))
         end do
      end do
      call make("potential", "u = '1/(1 - Q33) + Q12'", one, error)
      call ask(one, q, g, u, dg)
      q(2, :) = q(1, :)
      call ask(one, q, alone, u, dg)
      call expect(error, .not. any(is_number(g(2, :))), "at the pole")
      call within(error, maxval(abs(g([1, 3, lanes], :) - alone([1, 3, lanes], :))), 0.0_dp, &
         "neighbours of a body at the pole")
   end subroutine test_no_value

   !> At the least and the largest distance the angle is known, and R; between, Kepler's equation
   !> and
   !> the law of areas, dnu/dM = sqrt(1 - e^2)/(R/a)^2.
   subroutine test_orbit(error)
      type(error_type), allocatable, intent(out) :: error
      class(effect), allocatable :: one
      real(dp), parameter :: n = 1.3_dp, pi = acos(-1.0_dp), step = 1e-5_dp
      real(dp), parameter :: eccentric(4) = [0.0_dp, 0.1_dp, 0.6_dp, 0.99_dp]
      real(dp) :: e(3), kappa, before(3), after(3), mean, distance, turn
      character(90) :: words
      integer :: i, k
      do i = 1, size(eccentric)
         write (words, "(a, f5.2)") "rate = 1.3; anomaly = 0.5; eccentricity =", eccentric(i)
         call make("gravity_gradient", trim(words), one, error)
         if (allocated(error)) return
         select type (one)
         class is (gravity_gradient)
            call one%look(-0.5_dp/n, e, kappa)
            call within(error, norm2(e - [1, 0, 0]), 1e-15_dp/(1 - eccentric(i)), &
                        "least distance")
            call within(error, kappa*(1 - eccentric(i))**3/(3*n**2) - 1, 1e-13_dp, "R least")
            call one%look((5*pi - 0.5_dp)/n, e, kappa)
            call within(error, norm2(e + [1, 0, 0]), 2e-13_dp, "largest distance")
            call within(error, kappa*(1 + eccentric(i))**3/(3*n**2) - 1, 1e-12_dp, "R largest")
            do k = 1, 40
               mean = 0.3_dp*k
               call one%look((mean - 0.5_dp - step)/n, before, kappa)
               call one%look((mean - 0.5_dp + step)/n, after, kappa)
               call one%look((mean - 0.5_dp)/n, e, kappa)
               distance = (3*n**2/kappa)**(1/3.0_dp)
               turn = (before(1)*after(2) - before(2)*after(1))/(2*step)
               call within(error, turn*distance**2/sqrt(1 - eccentric(i)**2) - 1, 1e-6_dp, &
                  "law of areas")
               call within(error, distance*(1 + eccentric(i)*e(1))/(1 - eccentric(i)**2) - 1, &
                  1e-12_dp, "ellipse")
            end do
         end select
      end do
   end subroutine test_orbit

end module test_effect_potential
