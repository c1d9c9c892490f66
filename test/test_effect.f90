!> Room effect: the registry and its refusals, time. Torques and gradients stand in
!> test_effect_torque, what theory says of the motion in test_effect_motion, random numbers and the
!> thermostat in test_effect_random.
module test_effect
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_method, poinsot_e_size
   use poinsot_core_error, only: poinsot_error, raised, clear
   use poinsot_effect_effect, only: effect
   use poinsot_effect_field, only: field
   use poinsot_effect_torque, only: torque
   use poinsot_effect_registry, only: effect_count, effect_name, describe_effect, make_effect
   use poinsot_effect_settings, only: setting, effect_info, number_setting, text_setting
   use test_effect_motion, only: collect_motion
   use test_effect_potential, only: collect_potential
   use test_effect_random, only: collect_random
   use test_effect_torque, only: collect_torque, energy_of, states
   use test_expectation, only: expect
   use test_effect_time, only: collect_effect_time
   use test_turning, only: generic_y
   implicit none(type, external)
   private
   public :: collect_effect

contains

   subroutine collect_effect(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      type(unittest_type), allocatable :: torques(:), motion(:), random(:), formulas(:), &
         in_time(:)
      testsuite = [ &
         new_unittest("rows-are-complete", test_rows), &
         new_unittest("every-row-makes-its-effect", test_making), &
         new_unittest("unknown-names-refused", test_unknown), &
         new_unittest("bad-values-refused", test_refusals), &
         new_unittest("large-numbers-raise-nothing", test_large), &
         new_unittest("defaults", test_defaults), &
         new_unittest("moving-fields", test_moving), &
         new_unittest("torque-table", test_table)]
      call collect_torque(torques)
      call collect_motion(motion)
      call collect_random(random)
      call collect_potential(formulas)
      call collect_effect_time(in_time)
      testsuite = [testsuite, torques, motion, random, formulas, in_time]
   end subroutine collect_effect

   subroutine test_rows(error)
      type(error_type), allocatable, intent(out) :: error
      type(effect_info) :: info
      integer :: i, j
      do i = 1, effect_count
         info = describe_effect(i)
         call expect(error, info%name /= "" .and. info%formula /= "" .and. info%check /= "", &
            "incomplete row")
         do j = 1, i - 1
            call expect(error, effect_name(j) /= effect_name(i), &
               "name used twice: "//effect_name(i))
         end do
         do j = 1, size(info%keys)
            call expect(error, info%keys(j)%meaning /= "" .and. (info%keys(j)%is_text .or. &
               info%keys(j)%units /= ""), &
               "key without words: "//trim(info%name)//" "//info%keys(j)%name)
         end do
      end do
   end subroutine test_rows

   !> With its required keys only, every effect but the callback is made; a number too many is
   !> refused.
   subroutine test_making(error)
      type(error_type), allocatable, intent(out) :: error
      type(effect_info) :: info
      type(setting), allocatable :: settings(:)
      class(effect), allocatable :: made
      type(poinsot_error) :: refusal
      integer :: i, k
      do i = 1, effect_count
         if (effect_name(i) == "callback") cycle
         info = describe_effect(i)
         call required(info, settings)
         refusal = poinsot_error()
         call make_effect(effect_name(i), settings, made, refusal)
         call expect(error, .not. raised(refusal) .and. allocated(made), &
            "not made: "//effect_name(i))
         if (allocated(error)) return
         call expect(error, made%name == info%name .and. made%class_index == 0, &
            "made with another name or class")
         if (size(settings) == 0) cycle
         do k = 1, size(settings)
            refusal = poinsot_error()
            call make_effect(effect_name(i), [settings(:k - 1), settings(k + 1:)], made, refusal)
            call expect(error, raised(refusal) .and. .not. allocated(made), &
               "made without a required key")
            if (allocated(error)) return
            call expect(error, index(refusal%message, "'"//settings(k)%key//"'") > 0, &
               refusal%message)
         end do
      end do
   end subroutine test_making

   subroutine required(info, settings)
      type(effect_info), intent(in) :: info
      type(setting), allocatable, intent(out) :: settings(:)
      real(dp) :: values(3)
      integer :: k
      values = [0.5_dp, 1.0_dp, 2.0_dp]
      allocate (settings(0))
      do k = 1, size(info%keys)
         if (info%keys(k)%default /= "required") cycle
         if (info%keys(k)%is_text) then
            settings = [settings, text_setting(trim(info%keys(k)%name), "2*Q33")]
         else
            settings = [settings, &
               number_setting(trim(info%keys(k)%name), values(:info%keys(k)%least))]
         end if
      end do
   end subroutine required

   subroutine test_unknown(error)
      type(error_type), allocatable, intent(out) :: error
      class(effect), allocatable :: made
      type(poinsot_error) :: refusal
      call make_effect("gravty", [setting ::], made, refusal)
      call expect(error, refusal%code, poinsot_e_method)
      call expect(error, index(refusal%message, "'gravity'") > 0, refusal%message)
      refusal = poinsot_error()
      call make_effect("gravity", [number_setting("center", generic_y)], made, refusal)
      call expect(error, refusal%code, poinsot_e_method)
      call expect(error, index(refusal%message, "'centre'") > 0 .and. &
                 index(refusal%message, "'center'") > 0, refusal%message)
      refusal = poinsot_error()
      call make_effect("callback", [setting ::], made, refusal)
      call expect(error, raised(refusal), "a callback cannot be made from settings")
   end subroutine test_unknown

   subroutine test_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      type(setting) :: centre, nan
      real(dp) :: bad(3)
      integer, parameter :: d = poinsot_e_domain, s = poinsot_e_size
      centre = number_setting("centre", generic_y)
      bad = generic_y
      bad(2) = ieee_value(1.0_dp, ieee_quiet_nan)
      nan = number_setting("centre", bad)
      call refused("gravity", [number_setting("centre", [1.0_dp])], s, error)
      call refused("gravity", [nan], d, error)
      call refused("gravity", [text_setting("centre", "here")], d, error)
      call refused("gravity", [centre, centre], d, error)
      call refused("gravity", [centre, number_setting("up", [0.0_dp, 0.0_dp, 0.0_dp])], d, error)
      call refused("gravity", [centre, number_setting("class", [-1.0_dp])], d, error)
      call refused("gravity", [centre, number_setting("class", [1.5_dp])], d, error)
      call refused("gravity", [number_setting("centre", [1e200_dp, 0.0_dp, 0.0_dp]), &
         number_setting("weight", [1e200_dp])], d, error)
      call refused("gravity_gradient", [number_setting("rate", [1e200_dp])], d, error)
      call refused("field", [number_setting("dipole", generic_y), number_setting("strength", &
                   generic_y), text_setting("motion", "dancing")], d, error)
      call refused("field", [number_setting("dipole", generic_y), number_setting("strength", &
                   generic_y), number_setting("motion", [1.0_dp])], d, error)
      call refused("gravity_gradient", [number_setting("rate", [1.0_dp]), &
         number_setting("normal", [1.0_dp, 0.0_dp, 1.0_dp])], d, error)
      call refused("torque", [number_setting("times", [0.0_dp, 1.0_dp]), &
         number_setting("table", [1.0_dp, 2.0_dp, 3.0_dp])], s, error)
      call refused("torque", [number_setting("times", [1.0_dp, 0.5_dp]), &
         number_setting("table", [1.0_dp, 2.0_dp, 3.0_dp, 1.0_dp, 2.0_dp, 3.0_dp])], d, error)
      call refused("torque", [number_setting("times", [1.0_dp]), number_setting("table", &
                   generic_y), number_setting("value", generic_y)], d, error)
      call refused("torque", [text_setting("file", "torque.dat")], d, error)
      call refused("drag", [number_setting("friction", [1.0_dp, 2.0_dp])], d, error)
      call refused("drag", [number_setting("friction", [-1.0_dp])], d, error)
      call refused("drag", [number_setting("rate", [-1.0_dp])], d, error)
      call refused("drag", [number_setting("friction", [1.0_dp]), number_setting("rate", &
         [1.0_dp])], d, error)
      call refused("langevin", [number_setting("friction", [1.0_dp]), &
                   number_setting("temperature", [-1.0_dp])], d, error)
      call refused("dipoles", &
                   [number_setting("dipole", [1.0_dp, 2.0_dp, 3.0_dp, 4.0_dp])], s, error)
      call refused("dipoles", [number_setting("dipole", generic_y), number_setting("spacing", &
         [0.0_dp])], d, error)
      call refused("dipoles", [number_setting("dipole", generic_y), &
         number_setting("positions", [generic_y, generic_y])], d, error)
   end subroutine test_refusals

   subroutine refused(name, settings, code, error)
      character(*), intent(in) :: name
      type(setting), intent(in) :: settings(:)
      integer, intent(in) :: code
      type(error_type), allocatable, intent(inout) :: error
      class(effect), allocatable :: made
      type(poinsot_error) :: refusal
      if (allocated(error)) return
      call make_effect(name, settings, made, refusal)
      call expect(error, refusal%code, code, name//" took a bad "//settings(size(settings))%key)
      if (allocated(error)) return
      call expect(error, .not. allocated(made) .and. index(refusal%message, name) > 0, &
         "message: "//refusal%message)
   end subroutine refused

   !> 1e200 in every key of numbers, alone and in all at once: taken or refused, but no overflow
   !> (the checking profile has traps).
   subroutine test_large(error)
      type(error_type), allocatable, intent(out) :: error
      type(effect_info) :: info
      type(setting), allocatable :: settings(:)
      class(effect), allocatable :: made
      type(poinsot_error) :: refusal
      real(dp) :: size_of
      integer :: i, k, which, n, given
      do i = 1, effect_count
         info = describe_effect(i)
         if (info%name == "potential" .or. info%name == "callback") cycle
         do which = 0, size(info%keys)
            allocate (settings(size(info%keys)))
            given = 0
            do k = 1, size(info%keys)
               associate (key => info%keys(k))
                  if (key%is_text) cycle
                  if (which /= k .and. which > 0 .and. key%default /= "required") cycle
                  size_of = merge(1e200_dp, 0.5_dp, which == 0 .or. which == k)
                  n = max(key%least, 1)
                  given = given + 1
                  settings(given) = number_setting(trim(key%name), spread(size_of, 1, n))
               end associate
            end do
            call clear(refusal)
            call make_effect(trim(info%name), settings(:given), made, refusal)
            call expect(error, allocated(made) .neqv. raised(refusal), trim(info%name))
            deallocate (settings)
         end do
      end do
   end subroutine test_large

   !> weight = 1, up = z: U = centre_3 at q = 1; up is a direction, its length does not count; class
   !> is kept.
   subroutine test_defaults(error)
      type(error_type), allocatable, intent(out) :: error
      class(effect), allocatable :: plain, said
      type(poinsot_error) :: refusal
      real(dp) :: u(lanes), v(lanes)
      call make_effect("gravity", [number_setting("centre", generic_y)], plain, refusal)
      call make_effect("gravity", [number_setting("centre", generic_y), &
                       number_setting("weight", [1.0_dp]), number_setting("class", [3.0_dp]), &
                       number_setting("up", [0.0_dp, 0.0_dp, 1e200_dp])], said, refusal)
      call energy_of(plain, states(1), 0.0_dp, u)
      call energy_of(said, states(1), 0.0_dp, v)
      call expect(error, all(u == v), "defaults")
      call expect(error, said%class_index == 3 .and. .not. said%acts_on(1) .and. &
                 said%acts_on(3) .and. plain%acts_on(7), "class")
   end subroutine test_defaults

   subroutine test_moving(error)
      type(error_type), allocatable, intent(out) :: error
      class(effect), allocatable :: made
      type(poinsot_error) :: refusal
      real(dp), parameter :: pi = acos(-1.0_dp), e(3) = [1.0_dp, 0.0_dp, 0.5_dp], x(3) = [1.0_dp, &
         0.0_dp, 0.0_dp]
      call make_effect("field", [number_setting("dipole", x), number_setting("strength", e), &
         number_setting("frequency", [2.0_dp]), number_setting("phase", [0.5_dp*pi]), &
         text_setting("motion", "rotating")], made, refusal)
      select type (made)
      type is (field)
         call expect(error, maxval(abs(made%at_time(0.25_dp*pi) - [-1.0_dp, 0.0_dp, 0.5_dp])) &
            < 1e-15_dp, "rotating")
      end select
      if (allocated(error)) return
      call make_effect("field", [number_setting("dipole", x), &
                       number_setting("strength", e), number_setting("frequency", [2.0_dp]), &
                       text_setting("motion", "oscillating")], made, refusal)
      select type (made)
      type is (field)
         call expect(error, maxval(abs(made%at_time(pi/6) - 0.5_dp*e)) < 1e-15_dp, "oscillating")
      end select
   end subroutine test_moving

   !> Linear between its times, constant beyond; exact at the times.
   subroutine test_table(error)
      type(error_type), allocatable, intent(out) :: error
      class(effect), allocatable :: made
      type(poinsot_error) :: refusal
      real(dp), parameter :: a(3) = [1.0_dp, 2.0_dp, 3.0_dp], b(3) = [3.0_dp, 2.0_dp, -1.0_dp], &
         c(3) = [0.0_dp, 8.0_dp, 0.0_dp]
      call make_effect("torque", [number_setting("times", [1.0_dp, 3.0_dp, 4.0_dp]), &
         number_setting("table", [a, b, c])], made, refusal)
      call expect(error, .not. raised(refusal), "table refused")
      select type (made)
      type is (torque)
         call expect(error, all(made%at_time(-5.0_dp) == a) .and. &
                    all(made%at_time(1.0_dp) == a) .and. all(made%at_time(3.0_dp) == b) .and. &
                    all(made%at_time(9.0_dp) == c) .and. &
                    maxval(abs(made%at_time(1.5_dp) - (0.75_dp*a + 0.25_dp*b))) < 1e-15_dp .and. &
                    maxval(abs(made%at_time(3.5_dp) - 0.5_dp*(b + c))) < 1e-15_dp, "table")
      end select
   end subroutine test_table

end module test_effect
