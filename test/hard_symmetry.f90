!> The symmetries of the problem as a judge, for every effect and free motion: other units in powers
!> of two give the same bits; space turned, axes of the body relabelled by even and odd
!> permutations, and both relabelled at once give the same motion.
module test_hard_symmetry
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok
   use poinsot_effect_registry, only: effect_count, effect_name
   use poinsot_effect_settings, only: setting, number_setting, text_setting
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_coupled, only: torque_callback
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_effect, set_option
   use poinsot_ensemble_step, only: step_bodies
   use poinsot_free_method, only: method_count, method_name
   use test_bodies, only: random_stream, start_stream, random_quaternion, uniform
   use test_expectation, only: expect
   use test_free_tools, only: text
   use test_oracle_algebra, only: quaternion_product, rotate, rotate_back
   implicit none(type, external)
   private
   public :: collect_hard_symmetry

   integer, parameter :: n = 5

   !> How a problem is told otherwise: units, a turn of space, a relabelling of the body's axes.
   type :: view_of_it
      real(dp) :: mass = 1, rate = 1, length = 1, dipole = 1
      real(dp) :: space(4) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp] !! of unit norm
      integer :: order(3) = [1, 2, 3]
      real(dp) :: sign = 1                                     !! -1 makes an odd order a rotation
      real(dp) :: heat = 1   !! of the noise, which is drawn axis by axis: other labels, other noise
   end type view_of_it

   !> The heavy top by a callback.
   type, extends(torque_callback) :: hand_top
      real(dp) :: centre(3) = 0, up(3) = 0
   contains
      procedure :: evaluate => evaluate_top
   end type hand_top

   !> Body vectors, space vectors and numbers that are nothing special.
   real(dp), parameter :: in_body(3) = [0.3_dp, -0.5_dp, 0.7_dp], in_space(3) = [0.4_dp, 0.9_dp, &
      -0.2_dp], across(3) = [0.9_dp, -0.4_dp, 0.0_dp], moments(3) = [0.8_dp, 0.6_dp, 1.1_dp]

   character(18), parameter :: effects(15) = [character(18) :: "", "gravity", "field", "field", &
      "field", "gravity_gradient", "gravity_gradient", "spring", "torque", "torque", "drag", &
      "langevin", "gyrostat", "dipoles", "potential"]
   character(11), parameter :: variants(15) = [character(11) :: "", "", "static", "rotating", &
      "oscillating", "circular", "fixed", "", "body", "space", "", "", "", "", ""]

contains

   subroutine collect_hard_symmetry(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("every-effect-in-other-units", test_units), &
         new_unittest("every-effect-in-a-turned-space", test_space), &
         new_unittest("every-effect-with-other-axes", test_axes), &
         new_unittest("callback-in-every-view", test_callback), &
         new_unittest("no-effect-is-left-out", test_complete)]
   end subroutine collect_hard_symmetry

   ! The problem, told in a view
   ! ---------------------------------------------------------------------------------------------

   !> A vector of the body in the labels of the view.
   pure function of_body(view, v) result(w)
      type(view_of_it), intent(in) :: view
      real(dp), intent(in) :: v(3)
      real(dp) :: w(3)
      w = view%sign*v(view%order)
   end function of_body

   !> The relabelling as a quaternion m, w = m v m*: from its matrix M, |m| = 1.
   pure function of_axes(view) result(m)
      type(view_of_it), intent(in) :: view
      real(dp) :: m(4), a(3, 3), size(4)
      integer :: i, k
      a = 0
      do i = 1, 3
         a(i, view%order(i)) = view%sign
      end do
      size = 1 + [a(1, 1) + a(2, 2) + a(3, 3), a(1, 1) - a(2, 2) - a(3, 3), &
         a(2, 2) - a(1, 1) - a(3, 3), a(3, 3) - a(1, 1) - a(2, 2)]
      k = maxloc(size, dim=1)
      select case (k)
      case (1)
         m = [size(1), a(3, 2) - a(2, 3), a(1, 3) - a(3, 1), a(2, 1) - a(1, 2)]
      case (2)
         m = [a(3, 2) - a(2, 3), size(2), a(2, 1) + a(1, 2), a(1, 3) + a(3, 1)]
      case (3)
         m = [a(1, 3) - a(3, 1), a(2, 1) + a(1, 2), size(3), a(3, 2) + a(2, 3)]
      case default
         m = [a(2, 1) - a(1, 2), a(1, 3) + a(3, 1), a(3, 2) + a(2, 3), size(4)]
      end select
      m = m/norm2(m)
   end function of_axes

   function number(x) result(text)
      real(dp), intent(in) :: x
      character(:), allocatable :: text
      character(26) :: digits
      write (digits, "(es26.16e3)") x
      text = trim(adjustl(digits))
   end function number

   !> The settings of an effect as the view tells them.
   subroutine tell(view, effect, variant, settings)
      type(view_of_it), intent(in) :: view
      character(*), intent(in) :: effect, variant
      type(setting), allocatable, intent(out) :: settings(:)
      real(dp) :: energy, space(3), normal(3), radial(3)
      energy = view%mass*view%rate**2
      space = rotate(view%space, in_space)
      radial = rotate(view%space, across/norm2(across))
      normal = rotate(view%space, [0.0_dp, 0.0_dp, 1.0_dp])
      select case (effect)
      case ("potential") ! gravity and the square of a cosine, by what Q's columns are in the view
         settings = [text_setting("u", "m*(u*(x*Q11 + y*Q21 + z*Q31) + v*(x*Q12 + y*Q22 + z*Q32)" &
            // " + (x*Q13 + y*Q23 + z*Q33)^2)"), text_setting("constants", "m = " // &
            number(energy) // ", u = 0.3, v = -0.5, x = " // number(space(1)) // ", y = " // &
            number(space(2)) // ", z = " // number(space(3))), &
            number_setting("axes", [of_body(view, [1.0_dp, 0.0_dp, 0.0_dp]), &
            of_body(view, [0.0_dp, 1.0_dp, 0.0_dp]), of_body(view, [0.0_dp, 0.0_dp, 1.0_dp])])]
      case ("gravity")
         settings = [number_setting("centre", of_body(view, in_body)*view%length), &
            number_setting("weight", [1.3_dp]*energy/view%length), number_setting("up", space)]
      case ("field")
         settings = [number_setting("dipole", of_body(view, in_body)*view%dipole), &
            number_setting("strength", space*energy/view%dipole), text_setting("motion", variant), &
            number_setting("frequency", [0.7_dp]*view%rate), number_setting("phase", [0.3_dp]), &
            number_setting("axis", normal)]
         if (variant == "static") settings = settings(:3)
         if (variant == "oscillating") settings = settings(:5)
      case ("gravity_gradient")
         settings = [number_setting("rate", [0.8_dp]*view%rate), number_setting("radial", radial), &
            number_setting("normal", normal), text_setting("orbit", variant)]
      case ("spring")
         settings = [number_setting("stiffness", [0.9_dp]*energy), number_setting("axis", &
            of_body(view, in_body)), number_setting("direction", space)]
      case ("torque")
         settings = [number_setting("value", merge(of_body(view, in_body), space, &
            variant == "body")*energy), text_setting("frame", variant), &
            number_setting("frequency", [0.7_dp]*view%rate), number_setting("phase", [0.3_dp])]
      case ("drag", "langevin")
         settings = [number_setting("friction", abs(of_body(view, in_body))*view%mass*view%rate), &
            number_setting("temperature", [0.7_dp]*energy*view%heat)]
         if (effect == "drag") settings = settings(:1)
      case ("gyrostat")
         settings = [number_setting("rotor", of_body(view, in_body)*view%mass*view%rate)]
      case ("dipoles")
         settings = [number_setting("dipole", of_body(view, in_body)*view%dipole), &
            number_setting("coupling", [0.6_dp]*energy*view%length**3/view%dipole**2), &
            number_setting("spacing", [1.2_dp]*view%length), number_setting("axis", space)]
      case default
         allocate (settings(0))
      end select
   end subroutine tell

   !> Ten steps as the view tells them, and told back: y and q of all bodies.
   subroutine run(view, method, effect, variant, scheme, y, q, status)
      type(view_of_it), intent(in) :: view
      character(*), intent(in) :: method, effect, variant, scheme
      real(dp), intent(out) :: y(3, n), q(4, n)
      integer, intent(out) :: status
      type(poinsot_plan) :: plan
      type(body_view) :: host
      type(setting), allocatable :: settings(:)
      type(poinsot_error) :: error
      type(random_stream) :: stream
      type(hand_top) :: hand
      real(dp), target :: yy(3, n), qq(4, n)
      real(dp) :: m(4), s(4)
      integer :: i, j, number
      m = of_axes(view)
      s = view%space
      stream = start_stream(11)
      do i = 1, n
         do j = 1, 3
            y(j, i) = 2*uniform(stream) - 1
         end do
         q(:, i) = random_quaternion(stream)
         yy(:, i) = of_body(view, y(:, i))*view%mass*view%rate
         qq(:, i) = q(:, i)
         if (abs(s(1)) < 1) qq(:, i) = quaternion_product(s, qq(:, i))
         if (m(1) < 1) qq(:, i) = quaternion_product(qq(:, i), [m(1), -m(2:4)])
      end do
      call add_class(plan, moments(view%order)*view%mass, number, error)
      call set_option(plan, "method", method, error)
      call set_option(plan, "splitting", scheme, error)
      call set_option(plan, "seed", "5", error)
      call tell(view, effect, variant, settings)
      if (effect /= "" .and. effect /= "callback") call add_effect(plan, effect, settings, error)
      call make_ready(plan, error)
      call view_rows(yy, qq, host)
      if (effect == "callback") then
         hand%centre = of_body(view, in_body)
         hand%up = rotate(s, in_space)*view%mass*view%rate**2
         call step_bodies(plan, host, 0.2_dp/view%rate, 0.05_dp/view%rate, 0_i8, 10_i8, status, &
            error, hand)
      else
         call step_bodies(plan, host, 0.2_dp/view%rate, 0.05_dp/view%rate, 0_i8, 10_i8, status, &
            error)
      end if
      if (raised(error)) status = error%code
      do i = 1, n
         y(view%order, i) = view%sign*yy(:, i)/view%rate/view%mass
         q(:, i) = qq(:, i)
         if (abs(s(1)) < 1) q(:, i) = quaternion_product([s(1), -s(2:4)], q(:, i))
         if (m(1) < 1) q(:, i) = quaternion_product(q(:, i), m)
      end do
   end subroutine run

   subroutine evaluate_top(self, t, q, torque, energy, stop)
      class(hand_top), intent(inout) :: self
      real(dp), intent(in) :: t
      real(dp), intent(in), target :: q(:, :)
      real(dp), intent(inout), target :: torque(:, :)
      real(dp), intent(inout) :: energy
      logical, intent(inout) :: stop
      real(dp) :: g(3)
      integer :: i
      do i = 1, size(q, 1)
         g = rotate_back(q(i, :), self%up)
         torque(i, :) = [g(2)*self%centre(3) - g(3)*self%centre(2), &
            g(3)*self%centre(1) - g(1)*self%centre(3), g(1)*self%centre(2) - g(2)*self%centre(1)]
      end do
      energy = 0*t
      stop = .false.
   end subroutine evaluate_top

   ! The judge
   ! ---------------------------------------------------------------------------------------------

   !> One effect in one view against the plain one.
   subroutine compare(error, view, method, effect, variant, scheme, may)
      type(error_type), allocatable, intent(inout) :: error
      type(view_of_it), intent(in) :: view
      character(*), intent(in) :: method, effect, variant, scheme
      real(dp), intent(in) :: may
      type(view_of_it) :: plain
      real(dp) :: y(3, n, 2), q(4, n, 2), gap
      integer :: status(2)
      if (allocated(error)) return
      plain%heat = view%heat
      call run(plain, method, effect, variant, scheme, y(:, :, 1), q(:, :, 1), status(1))
      call run(view, method, effect, variant, scheme, y(:, :, 2), q(:, :, 2), status(2))
      gap = max(maxval(abs(y(:, :, 1) - y(:, :, 2))), maxval(abs(q(:, :, 1) - q(:, :, 2))))
      call expect(error, all(status == poinsot_ok), effect//" "//variant//" fails, "//method)
      call expect(error, gap <= may, effect//" "//trim(variant)//" by "//method//", "//scheme// &
         ": another motion, "//text(gap))
   end subroutine compare

   !> All effects, all methods that see every axis alike, with and without force gradient.
   subroutine compare_all(error, view, may, by_axis)
      type(error_type), allocatable, intent(inout) :: error
      type(view_of_it), intent(in) :: view
      real(dp), intent(in) :: may
      logical, intent(in) :: by_axis             !! methods with an order of axes too
      integer :: e, m
      do e = 1, size(effects)
         do m = 1, method_count()
            if (.not. by_axis .and. (method_name(m) == "three-rotations" &
               .or. method_name(m) == "symmetric-rotation")) cycle
            if (mod(m + e, 3) /= 0 .and. method_name(m) /= "exact") cycle
            call compare(error, view, method_name(m), trim(effects(e)), trim(variants(e)), &
               "srkn6", may)
         end do
         if (any(effects(e) == [character(18) :: "gravity", "field", "gravity_gradient", &
            "spring", "dipoles"])) call compare(error, view, "exact", trim(effects(e)), &
            trim(variants(e)), "omelyan4", may)
      end do
   end subroutine compare_all

   subroutine test_units(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: powers(4, 4) = reshape([-153, 40, -33, -98, 10, -7, 3, 5, 200, -60, &
         30, 11, -250, 90, 0, -60], [4, 4])
      integer :: k
      do k = 1, size(powers, 2)
         call compare_all(error, view_of_it(2.0_dp**powers(1, k), 2.0_dp**powers(2, k), &
            2.0_dp**powers(3, k), 2.0_dp**powers(4, k)), 0.0_dp, .true.)
      end do
   end subroutine test_units

   subroutine test_space(error)
      type(error_type), allocatable, intent(out) :: error
      type(view_of_it) :: view
      view%space = [0.1_dp, 0.7_dp, -0.5_dp, 0.5_dp]
      call compare_all(error, view, 2e-14_dp, .true.)
      view%space = [0.0_dp, 0.0_dp, 0.6_dp, 0.8_dp]
      call compare_all(error, view, 2e-14_dp, .true.)
   end subroutine test_space

   subroutine test_axes(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: orders(3, 5) = reshape([2, 3, 1, 3, 1, 2, 2, 1, 3, 1, 3, 2, 3, 2, 1], &
         [3, 5])
      type(view_of_it) :: view
      integer :: k
      view%heat = 0
      do k = 1, 5
         view%order = orders(:, k)
         view%sign = merge(1.0_dp, -1.0_dp, k <= 2)
         call compare_all(error, view, 2e-14_dp, .false.)
      end do
      view%space = [0.1_dp, 0.7_dp, -0.5_dp, 0.5_dp]
      call compare_all(error, view, 2e-14_dp, .false.)
   end subroutine test_axes

   subroutine test_callback(error)
      type(error_type), allocatable, intent(out) :: error
      type(view_of_it) :: view
      call compare(error, view_of_it(2.0_dp**(-153), 2.0_dp**40), "exact", "callback", "", &
         "srkn6", 0.0_dp)
      view%order = [3, 2, 1]
      view%sign = -1
      view%space = [0.1_dp, 0.7_dp, -0.5_dp, 0.5_dp]
      call compare(error, view, "exact", "callback", "", "srkn6", 2e-14_dp)
   end subroutine test_callback

   !> The list above has every row of the registry.
   subroutine test_complete(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: i
      do i = 1, effect_count
         call expect(error, any(effects == effect_name(i)) .or. effect_name(i) == "callback", &
            "no symmetry is looked at for "//effect_name(i))
      end do
   end subroutine test_complete

end module test_hard_symmetry
