!> All effects, found by name; their descriptions come from their own files.
!>
!> A new effect is one file, with its label and its row in the two lists here, at any position.
!> Users see effects in the order of the labels, programs by number.
module poinsot_effect_registry
   use poinsot_core_kinds, only: dp, name_length
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_method
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_message, only: printable
   use poinsot_core_nearest, only: suggestion
   use poinsot_core_number, only: lower
   use poinsot_effect_effect, only: effect
   use poinsot_effect_row, only: effect_label, effect_row, row_source
   use poinsot_effect_settings, only: setting, effect_key, effect_info, number_key, &
      check_keys, get_value
   use poinsot_effect_gravity, only: gravity_label, gravity_row
   use poinsot_effect_field, only: field_label, field_row
   use poinsot_effect_gravity_gradient, only: gravity_gradient_label, gravity_gradient_row
   use poinsot_effect_spring, only: spring_label, spring_row
   use poinsot_effect_torque, only: torque_label, torque_row
   use poinsot_effect_drag, only: drag_label, drag_row
   use poinsot_effect_langevin, only: langevin_label, langevin_row
   use poinsot_effect_gyrostat, only: gyrostat_label, gyrostat_row
   use poinsot_effect_dipoles, only: dipoles_label, dipoles_row
   use poinsot_effect_potential, only: potential_label, potential_row
   use poinsot_effect_callback, only: callback_label, callback_row
   implicit none(type, external)
   private
   public :: effect_count, effect_names, describe_effect, effect_name, effect_number, make_effect, &
      remake_effect, noise_key, shown_key
   public :: numbered_effects, numbered_effect_count, numbered_effect

   type(effect_label), parameter :: labels(*) = [ &
      gravity_label, &
      field_label, &
      gravity_gradient_label, &
      spring_label, &
      torque_label, &
      drag_label, &
      langevin_label, &
      gyrostat_label, &
      dipoles_label, &
      potential_label, &
      callback_label]

   integer :: k !! of the tables only
   integer, parameter :: effect_count = size(labels)
   !> Names in the order of the labels.
   character(name_length), parameter :: effect_names(*) = labels%name
   !> Names by public number; "" where a number is not given.
   character(name_length), parameter :: numbered_effects(*) = &
      [(merge(labels(max(1, findloc(labels%number, k, dim=1)))%name, repeat(" ", name_length), &
              any(labels%number == k)), k=1, maxval(labels%number))]

contains

   !> The rows, in any order.
   subroutine list_rows(sources)
      type(row_source), allocatable, intent(out) :: sources(:)
      sources = [ &
         row_source(gravity_row), &
         row_source(field_row), &
         row_source(gravity_gradient_row), &
         row_source(spring_row), &
         row_source(torque_row), &
         row_source(drag_row), &
         row_source(langevin_row), &
         row_source(gyrostat_row), &
         row_source(dipoles_row), &
         row_source(potential_row), &
         row_source(callback_row)]
   end subroutine list_rows

   !> The row for a name; without keys if there is none.
   subroutine find_row(name, row)
      character(*), intent(in) :: name
      type(effect_row), intent(out) :: row
      type(row_source), allocatable :: sources(:)
      integer :: i
      call list_rows(sources)
      do i = 1, size(sources)
         row = sources(i)%row()
         if (row%info%name == name) return
      end do
      row = effect_row(info=effect_info())
      allocate (row%info%keys(0))
   end subroutine find_row

   !> The row of effect i, 1 to effect_count; every effect also has the key `class`.
   function describe_effect(i) result(info)
      integer, intent(in) :: i !! 1 to effect_count
      type(effect_info) :: info
      type(effect_row) :: row
      call find_row(effect_name(i), row)
      info = row%info
      info%by_name = associated(row%make)
      if (info%by_name) info%keys = [info%keys, class_key()]
   end function describe_effect

   !> Name of effect i, as people see them listed; "" outside 1 to effect_count.
   pure function effect_name(i) result(name)
      integer, intent(in) :: i !! 1 to effect_count
      character(:), allocatable :: name
      name = ""
      if (i >= 1 .and. i <= effect_count) name = trim(effect_names(i))
   end function effect_name

   !> The key of the temperature of an effect's noise; "" of one without noise.
   function noise_key(name) result(key)
      character(*), intent(in) :: name !! of an effect
      character(:), allocatable :: key
      type(effect_row) :: row
      integer :: k
      key = ""
      call find_row(name, row)
      do k = 1, size(row%info%keys)
         if (row%info%keys(k)%is_noise) key = trim(row%info%keys(k)%name)
      end do
   end function noise_key

   !> The key of an effect whose body vector pictures show as "centre", "rotor" or "dipole"; "" of
   !> one without.
   function shown_key(name, what) result(key)
      character(*), intent(in) :: name !! of an effect
      character(*), intent(in) :: what !! one of the three
      character(:), allocatable :: key
      type(effect_row) :: row
      integer :: k
      key = ""
      call find_row(name, row)
      do k = 1, size(row%info%keys)
         if (row%info%keys(k)%shown == what) key = trim(row%info%keys(k)%name)
      end do
   end function shown_key

   !> The highest public number of an effect.
   pure integer function numbered_effect_count()
      numbered_effect_count = size(numbered_effects)
   end function numbered_effect_count

   !> Name of the effect of public number i, from 1; "" for a number that none has.
   pure function numbered_effect(i) result(name)
      integer, intent(in) :: i
      character(:), allocatable :: name
      name = ""
      if (i >= 1 .and. i <= size(numbered_effects)) name = trim(numbered_effects(i))
   end function numbered_effect

   !> Which of the effects, as people see them listed, has this name; 0 for an unknown one.
   pure integer function effect_number(name) result(i)
      character(*), intent(in) :: name !! of an effect
      do i = 1, effect_count
         if (effect_names(i) == name) return
      end do
      i = 0
   end function effect_number

   !> Make an effect from its name and settings. POINSOT_E_METHOD for an unknown name or key (the
   !> message names the nearest known one), _SIZE for a wrong count of numbers, _DOMAIN for a wrong
   !> value.
   subroutine make_effect(called, settings, made, error)
      character(*), intent(in) :: called                  !! its name, in any case
      type(setting), intent(in) :: settings(:)            !! keys not named keep their defaults
      class(effect), allocatable, intent(out) :: made     !! not allocated after an error
      type(poinsot_error), intent(inout) :: error
      type(effect_info) :: info
      type(effect_row) :: row
      real(dp) :: class_number
      character(:), allocatable :: name
      name = lower(trim(adjustl(called)))
      if (effect_number(name) == 0) then
         call raise(error, poinsot_e_method, "unknown effect '" // printable(name) // "'" // &
                    suggestion(name, effect_names))
         return
      end if
      call find_row(name, row)
      if (.not. associated(row%make)) then
         call raise(error, poinsot_e_domain, &
                    "effect '" // trim(name) // "' is a program's own torque: extend " // &
                    "poinsot_user_torque or poinsot_user_potential (Fortran) or pass a " // &
                    "callback (C)")
         return
      end if
      info = row%info
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
      type(effect_row) :: row
      call find_row(trim(info%name), row)
      call row%make(info, settings, made, error)
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
