!> All effects by name: one row each, with its description and its constructor.
!>
!> A new effect is one file, one row in `effect_row` with its name in `effect_names`, one test.
module poinsot_effect_registry
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_method
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_nearest, only: suggestion
   use poinsot_effect_effect, only: effect
   use poinsot_effect_settings, only: setting, effect_key, effect_info, number_key, &
      check_keys, get_value
   use poinsot_effect_gravity, only: describe_gravity, make_gravity
   use poinsot_effect_field, only: describe_field, make_field
   use poinsot_effect_gravity_gradient, only: describe_gravity_gradient, make_gravity_gradient
   use poinsot_effect_spring, only: describe_spring, make_spring
   use poinsot_effect_torque, only: describe_torque, make_torque
   use poinsot_effect_drag, only: describe_drag, make_drag
   use poinsot_effect_langevin, only: describe_langevin, make_langevin
   use poinsot_effect_gyrostat, only: describe_gyrostat, make_gyrostat
   use poinsot_effect_dipoles, only: describe_dipoles, make_dipoles
   use poinsot_effect_callback, only: describe_callback
   implicit none(type, external)
   private
   public :: effect_count, effect_names, describe_effect, effect_name, effect_number, make_effect, &
      remake_effect

   !> Names of the rows, in their order.
   character(18), parameter :: effect_names(*) = [character(18) :: &
      "gravity", "field", "gravity_gradient", "spring", "torque", "drag", "langevin", "gyrostat", &
      "dipoles", "callback"]
   integer, parameter :: effect_count = size(effect_names)

   abstract interface
      subroutine constructor(info, settings, made, error)
         import :: effect, effect_info, setting, poinsot_error
         implicit none(type, external)
         type(effect_info), intent(in) :: info
         type(setting), intent(in) :: settings(:)
         class(effect), allocatable, intent(out) :: made
         type(poinsot_error), intent(inout) :: error
      end subroutine constructor
   end interface

contains

   !> One row: description and constructor (null: not made from settings).
   subroutine effect_row(i, info, make)
      integer, intent(in) :: i
      type(effect_info), intent(out) :: info
      procedure(constructor), pointer, intent(out) :: make
      make => null()
      select case (i)
      case (1); info = describe_gravity(); make => make_gravity
      case (2); info = describe_field(); make => make_field
      case (3); info = describe_gravity_gradient(); make => make_gravity_gradient
      case (4); info = describe_spring(); make => make_spring
      case (5); info = describe_torque(); make => make_torque
      case (6); info = describe_drag(); make => make_drag
      case (7); info = describe_langevin(); make => make_langevin
      case (8); info = describe_gyrostat(); make => make_gyrostat
      case (9); info = describe_dipoles(); make => make_dipoles
      case (10); info = describe_callback()
      case default; allocate (info%keys(0))
      end select
   end subroutine effect_row

   !> What the registry knows of effect i, 1 to effect_count; every effect also has the key `class`.
   function describe_effect(i) result(info)
      integer, intent(in) :: i !! 1 to effect_count
      type(effect_info) :: info
      procedure(constructor), pointer :: make
      call effect_row(i, info, make)
      if (associated(make)) info%keys = [info%keys, class_key()]
   end function describe_effect

   !> Name of effect i; "" outside 1 to effect_count.
   function effect_name(i) result(name)
      integer, intent(in) :: i !! 1 to effect_count
      character(:), allocatable :: name
      type(effect_info) :: info
      info = describe_effect(i)
      name = trim(info%name)
   end function effect_name

   !> Number of an effect; 0 for an unknown name.
   integer function effect_number(name) result(i)
      character(*), intent(in) :: name !! of an effect
      do i = 1, effect_count
         if (effect_name(i) == name) return
      end do
      i = 0
   end function effect_number

   !> Make an effect from its name and settings. POINSOT_E_METHOD for an unknown name or key (the
   !> message names the nearest known one), _SIZE for a wrong count of numbers, _DOMAIN for a wrong
   !> value.
   subroutine make_effect(name, settings, made, error)
      character(*), intent(in) :: name                    !! as in the registry
      type(setting), intent(in) :: settings(:)            !! keys not named keep their defaults
      class(effect), allocatable, intent(out) :: made     !! not allocated after an error
      type(poinsot_error), intent(inout) :: error
      type(effect_info) :: info
      procedure(constructor), pointer :: make
      integer :: i
      real(dp) :: class_number
      character(len(info%name)) :: names(effect_count)
      i = effect_number(name)
      if (i == 0) then
         do i = 1, effect_count
            names(i) = effect_name(i)
         end do
         call raise(error, poinsot_e_method, "unknown effect '" // trim(name) // "'" // &
                    suggestion(name, names))
         return
      end if
      call effect_row(i, info, make)
      if (.not. associated(make)) then
         call raise(error, poinsot_e_domain, &
                    "effect '" // trim(name) // "' is a program's own torque: extend " // &
                    "user_torque or user_potential (Fortran) or pass a callback (C)")
         return
      end if
      info%keys = [info%keys, class_key()]
      call check_keys(info, settings, error)
      if (raised(error)) return
      class_number = get_value(info, settings, "class")
      if (class_number < 0 .or. class_number > 1e9_dp .or. &
          abs(class_number - anint(class_number)) > 0) then
         call raise(error, poinsot_e_domain, "effect '" // name // &
                    "': key 'class' is the number of a body class, 0 for all")
         return
      end if
      call remake_effect(info, settings, made, error)
   end subroutine make_effect

   !> Make an effect from settings that were checked, and perhaps turned into another frame since.
   subroutine remake_effect(info, settings, made, error)
      type(effect_info), intent(in) :: info               !! its row
      type(setting), intent(in) :: settings(:)
      class(effect), allocatable, intent(out) :: made     !! not allocated after an error
      type(poinsot_error), intent(inout) :: error
      procedure(constructor), pointer :: make
      type(effect_info) :: row
      call effect_row(effect_number(trim(info%name)), row, make)
      call make(info, settings, made, error)
      if (raised(error)) then
         if (allocated(made)) deallocate (made)
         return
      end if
      made%name = info%name
      made%class_index = nint(get_value(info, settings, "class"))
   end subroutine remake_effect

   pure type(effect_key) function class_key()
      class_key = number_key("class", 1, 1, "0", "number", &
         "the body class it acts on, from 1; 0 = all")
   end function class_key

end module poinsot_effect_registry
