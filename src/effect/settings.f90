!> Settings of effects (key = values): the descriptions of keys, the values given by the user, and
!> the check of one against the other. The default of a key is the text in its description, so that
!> there is no second place that could disagree.
module poinsot_effect_settings
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, name_length
   use poinsot_core_message, only: place, printable
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_method, poinsot_e_scene, &
      poinsot_e_size
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_nearest, only: suggestion
   use poinsot_core_number, only: lower, trusted_reals
   implicit none(type, external)
   private
   public :: setting, effect_key, effect_info, number_key, text_key
   public :: body_vector, class_vectors, per_axis
   public :: settings_place, check_keys, check_product, reject_unknown, reject_key, find_key
   public :: get_values, get_value, get_text, get_direction, was_given, default_values, &
      number_setting, text_setting

   !> What frame the numbers of a key are in; "" is space, or none. They are turned when an effect
   !> acts on a class that was given in another frame than the principal one.
   character(*), parameter :: body_vector = "body vector"     !! three numbers for each vector
   character(*), parameter :: class_vectors = "class vectors" !! three for all classes, or for each
   character(*), parameter :: per_axis = "per axis"           !! one number, or one for each body
                                                              !! axis; where these are not
                                                              ! principal,
                                                              !! the effect gets a matrix: nine

   !> One setting by the user: a key with numbers, or with a string.
   type :: setting
      character(:), allocatable :: key
      real(dp), allocatable :: values(:)  !! allocated for numbers
      character(:), allocatable :: text   !! allocated for a text
   end type setting

   !> The place of settings in a file, for messages.
   type :: settings_place
      character(:), allocatable :: file
      character(:), allocatable :: group
      integer :: line = 0             !! of the group's opening; 0 if it is absent
      integer, allocatable :: lines(:) !! of each setting
   end type settings_place

   !> One key of an effect. `least` and `most` count the numbers it takes; a text has `is_text`.
   type :: effect_key
      character(12) :: name = ""
      logical :: is_text = .false.
      integer :: least = 1, most = 1     !! how many numbers; most < 0: any number of them
      character(28) :: default = ""      !! as a user would write it; "required"; "" = absent
      character(48) :: units = ""        !! units, or for a text the choices, separated by blanks
      character(72) :: meaning = ""
      character(16) :: frame = ""        !! one of the words above
      character(12) :: frame_key = ""
      !! a text key that may say 'space': then it is no body vector
      character(12) :: instead_of = ""   !! a key in whose place it is given, not beside it
      character(8) :: shown = ""         !! a body vector that pictures show: "centre" (of mass),
                                         !! "rotor" or "dipole"
      logical :: is_noise = .false.      !! the temperature of noise: zero is without
      logical :: is_table = .false.      !! scenes: a file of `times` and `table`
      character(12) :: positions_unless = ""
      !! scenes: takes the positions of the bodies, unless it or this other key is given
   end type effect_key

   !> One effect as the registry shows it.
   type :: effect_info
      character(name_length) :: name = ""
      character(128) :: formula = ""
      character(120) :: check = ""       !! the analytic result it is tested against
      integer :: order = 0               !! highest order a splitting reaches with it; 0 = no limit
      logical :: gradient = .true.       !! has the force gradient in closed form
      logical :: by_name = .true.        !! made from settings; else a program's own
      type(effect_key), allocatable :: keys(:)
   end type effect_info

contains

   !> Describe a key that takes numbers.
   pure function number_key(name, least, most, default, units, meaning, frame, frame_key, shown) &
         result(key)
      character(*), intent(in) :: name, default, units, meaning
      integer, intent(in) :: least, most
      character(*), intent(in), optional :: frame, frame_key, shown
      type(effect_key) :: key
      key = effect_key(name, .false., least, most, default, units, meaning)
      if (present(shown)) key%shown = shown
      if (present(frame)) key%frame = frame
      if (present(frame_key)) key%frame_key = frame_key
   end function number_key

   !> Describe a key that takes one word out of `choices` (separated by blanks; "" = free text).
   pure function text_key(name, default, choices, meaning) result(key)
      character(*), intent(in) :: name, default, choices, meaning
      type(effect_key) :: key
      key = effect_key(name, .true., 0, 0, default, choices, meaning)
   end function text_key

   !> key = numbers
   pure function number_setting(key, values) result(made)
      character(*), intent(in) :: key !! its name
      real(dp), intent(in) :: values(:)
      type(setting) :: made
      made%key = lower(key)
      allocate (made%values, source=values)
   end function number_setting

   !> key = 'text'
   pure function text_setting(key, text) result(made)
      character(*), intent(in) :: key, text
      type(setting) :: made
      made%key = lower(key)
      made%text = text
   end function text_setting

   !> Refuse keys the effect does not know (naming the nearest one), keys given twice, numbers for a
   !> text and a text for numbers, wrong counts, numbers that are not finite, words that are not a
   !> choice, required keys that are missing. Error: POINSOT_E_METHOD for an unknown key, _SIZE for
   !> a count, else _DOMAIN; of settings that stand in a file always _SCENE, with the place.
   pure subroutine check_keys(info, settings, error, at)
      type(effect_info), intent(in) :: info    !! the row of the registry
      type(setting), intent(in) :: settings(:) !! checked against the row
      type(poinsot_error), intent(inout) :: error
      type(settings_place), intent(in), optional :: at
      integer :: i, k
      do i = 1, size(settings)
         k = find_key(info, settings(i)%key)
         if (k == 0) then
            call reject_unknown(info, settings, i, error, at)
         else if (was_given(settings(:i - 1), settings(i)%key)) then
            call reject_key(info, settings, settings(i)%key, "is given twice", error, at)
         else
            call check_one(info, info%keys(k), settings, i, error, at)
         end if
         if (raised(error)) return
      end do
      do k = 1, size(info%keys)
         if (is_missing(info, k, settings)) then
            call reject_missing(info, info%keys(k), error, at)
         else if (is_double(info, k, settings)) then
            call reject_key(info, settings, trim(info%keys(k)%name), "is given instead of '" // &
                            trim(info%keys(k)%instead_of) // "', not beside it", error, at)
         end if
         if (raised(error)) return
      end do
   end subroutine check_keys

   !> Is a key required, and neither it nor one in its place given?
   pure logical function is_missing(info, k, settings)
      type(effect_info), intent(in) :: info
      integer, intent(in) :: k                 !! which of its keys
      type(setting), intent(in) :: settings(:)
      integer :: i
      is_missing = info%keys(k)%default == "required"
      do i = 1, size(info%keys)
         if (i /= k .and. info%keys(i)%instead_of /= info%keys(k)%name) cycle
         if (was_given(settings, trim(info%keys(i)%name))) is_missing = .false.
      end do
   end function is_missing

   pure logical function is_double(info, k, settings)
      type(effect_info), intent(in) :: info
      integer, intent(in) :: k
      type(setting), intent(in) :: settings(:)
      is_double = info%keys(k)%instead_of /= ""
      if (is_double) is_double = was_given(settings, trim(info%keys(k)%name)) .and. &
         was_given(settings, trim(info%keys(k)%instead_of))
   end function is_double

   pure subroutine check_one(info, key, settings, i, error, at)
      type(effect_info), intent(in) :: info
      type(effect_key), intent(in) :: key
      type(setting), intent(in) :: settings(:)
      integer, intent(in) :: i                      !! which of them
      type(poinsot_error), intent(inout) :: error
      type(settings_place), intent(in), optional :: at
      character(:), allocatable :: why
      integer :: code
      code = poinsot_e_domain
      associate (given => settings(i))
         if (key%is_text .and. .not. allocated(given%text)) then
            why = "takes a string"
         else if (allocated(given%text) .and. .not. key%is_text) then
            why = "takes numbers only"
         else if (key%is_text) then
            if (key%units == "" .or. is_choice(given%text, trim(key%units))) return
            why = "= " // quoted(given%text, at) // " is not one of: " // trim(key%units)
         else if (.not. allocated(given%values)) then
            why = "takes numbers, none is given"
         else if (size(given%values) < key%least) then
            why = "takes " // count_text(key) // ", too few are given"
            code = poinsot_e_size
         else if (key%most >= 0 .and. size(given%values) > key%most) then
            why = "takes " // count_text(key) // ", more are given"
            code = poinsot_e_size
         else if (.not. all(ieee_is_finite(given%values))) then
            why = "has a value that is not finite"
         else
            return
         end if
      end associate
      call reject_key(info, settings, trim(key%name), why, error, at, code)
   end subroutine check_one

   pure logical function is_choice(text, choices)
      character(*), intent(in) :: text, choices
      is_choice = len(text) > 0 .and. index(text, " ") == 0
      if (is_choice) is_choice = index(" " // choices // " ", " " // text // " ") > 0
   end function is_choice

   !> "3 numbers", "1 to 3 numbers", "1 or more numbers"
   pure function count_text(key) result(text)
      type(effect_key), intent(in) :: key
      character(:), allocatable :: text
      character(11) :: digits
      write (digits, "(i0)") key%least
      text = trim(digits)
      if (key%most < 0) then
         text = text // " or more"
      else if (key%most > key%least) then
         write (digits, "(i0)") key%most
         text = text // " to " // trim(digits)
      end if
      text = text // " number"
      if (key%most /= 1) text = text // "s"
   end function count_text

   !> A text of the user's as messages of a program, or of a file, have it.
   pure function quoted(text, at) result(marked)
      character(*), intent(in) :: text
      type(settings_place), intent(in), optional :: at
      character(:), allocatable :: marked
      marked = "'" // printable(text) // "'"
      if (present(at)) marked = """" // printable(text) // """"
   end function quoted

   !> Setting i has a key that the group or effect does not know.
   pure subroutine reject_unknown(info, settings, i, error, at)
      type(effect_info), intent(in) :: info
      type(setting), intent(in) :: settings(:)
      integer, intent(in) :: i
      type(poinsot_error), intent(inout) :: error
      type(settings_place), intent(in), optional :: at
      character(:), allocatable :: what
      what = "unknown key " // quoted(settings(i)%key, at)
      if (present(at)) then
         call raise(error, poinsot_e_scene, place(at%file, at%lines(i)) // "&" // at%group // &
            ": " // what // suggestion(settings(i)%key, info%keys%name, """", """"))
      else
         call raise(error, poinsot_e_method, "effect '" // trim(info%name) // "': " // what // &
            suggestion(settings(i)%key, info%keys%name))
      end if
   end subroutine reject_unknown

   !> A required key is not there.
   pure subroutine reject_missing(info, key, error, at)
      type(effect_info), intent(in) :: info
      type(effect_key), intent(in) :: key
      type(poinsot_error), intent(inout) :: error
      type(settings_place), intent(in), optional :: at
      if (present(at)) then
         call raise(error, poinsot_e_scene, place(at%file, at%line) // "&" // at%group // &
            ": the key """ // trim(key%name) // """ is required: " // trim(key%meaning))
      else
         call raise(error, poinsot_e_domain, "effect '" // trim(info%name) // "': key '" // &
            trim(key%name) // "' is required: " // trim(key%meaning))
      end if
   end subroutine reject_missing

   !> Report an error of a key: "effect 'x': key 'k' ...", or place and group of the file, with the
   !> line of the key if it is there.
   pure subroutine reject_key(info, settings, key, why, error, at, code)
      type(effect_info), intent(in) :: info
      type(setting), intent(in) :: settings(:)
      character(*), intent(in) :: key                  !! its name
      character(*), intent(in) :: why                  !! what is wrong and what would be right
      type(poinsot_error), intent(inout) :: error
      type(settings_place), intent(in), optional :: at
      integer, intent(in), optional :: code            !! without a file; default _DOMAIN
      integer :: i, line, status
      status = poinsot_e_domain
      if (present(code)) status = code
      if (.not. present(at)) then
         call raise(error, status, "effect '" // trim(info%name) // "': key '" // key // "' " // &
                    why)
         return
      end if
      line = at%line
      do i = 1, size(settings)
         if (settings(i)%key == key) line = at%lines(i)
      end do
      call raise(error, poinsot_e_scene, place(at%file, line) // "&" // at%group // ": " // &
                 key // " " // why)
   end subroutine reject_key

   !> Has the user said anything about this key?
   pure logical function was_given(settings, key)
      type(setting), intent(in) :: settings(:) !! checked against the row
      character(*), intent(in) :: key          !! its name
      integer :: i
      was_given = .false.
      do i = 1, size(settings)
         if (settings(i)%key == key) was_given = .true.
      end do
   end function was_given

   !> The numbers of a key: the user's, or the default; size 0 if absent. After check_keys.
   pure subroutine get_values(info, settings, key, values)
      type(effect_info), intent(in) :: info    !! the row of the registry
      type(setting), intent(in) :: settings(:) !! checked against the row
      character(*), intent(in) :: key          !! its name
      real(dp), allocatable, intent(out) :: values(:)
      integer :: i, k
      do i = 1, size(settings)
         if (settings(i)%key /= key) cycle
         values = settings(i)%values
         return
      end do
      k = find_key(info, key)
      call default_values(info%keys(k), values)
   end subroutine get_values

   !> The default of a key as numbers; of size 0 if there is none.
   pure subroutine default_values(key, values)
      type(effect_key), intent(in) :: key
      real(dp), allocatable, intent(out) :: values(:)
      if (key%default == "" .or. key%default == "required") then
         allocate (values(0))
      else
         allocate (values(max(key%least, 1)))
         call trusted_reals(key%default, values)
      end if
   end subroutine default_values

   !> The one number of a key that takes one.
   pure real(dp) function get_value(info, settings, key) result(value)
      type(effect_info), intent(in) :: info    !! the row of the registry
      type(setting), intent(in) :: settings(:) !! checked against the row
      character(*), intent(in) :: key          !! its name
      real(dp), allocatable :: values(:)
      call get_values(info, settings, key, values)
      value = values(1)
   end function get_value

   !> The text of a key: the user's, or the default.
   pure function get_text(info, settings, key) result(text)
      type(effect_info), intent(in) :: info    !! the row of the registry
      type(setting), intent(in) :: settings(:) !! checked against the row
      character(*), intent(in) :: key          !! its name
      character(:), allocatable :: text
      integer :: i
      text = trim(info%keys(find_key(info, key))%default)
      do i = 1, size(settings)
         if (settings(i)%key == key) text = settings(i)%text
      end do
   end function get_text

   !> The three numbers of a key as a unit vector; the zero vector is refused.
   pure subroutine get_direction(info, settings, key, direction, error)
      type(effect_info), intent(in) :: info    !! the row of the registry
      type(setting), intent(in) :: settings(:) !! checked against the row
      character(*), intent(in) :: key          !! its name
      real(dp), intent(out) :: direction(3)
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: values(:)
      real(dp) :: largest
      call get_values(info, settings, key, values)
      direction = values
      largest = maxval(abs(values))
      if (largest > 0) then
         values = values/largest
         direction = values/norm2(values)
      else
         call reject_key(info, settings, key, "is a direction and must not be zero", error)
      end if
   end subroutine get_direction

   !> Refuse a key whose numbers times `factor`, and three times that, are beyond the range of
   !> doubles.
   pure subroutine check_product(info, settings, key, factor, error)
      type(effect_info), intent(in) :: info    !! the row of the registry
      type(setting), intent(in) :: settings(:) !! checked against the row
      character(*), intent(in) :: key          !! its name
      real(dp), intent(in) :: factor           !! finite
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: values(:)
      call get_values(info, settings, key, values)
      if (maxval(exponent(values)) + exponent(factor) > maxexponent(factor) - 2) then
         call reject_key(info, settings, key, "makes a torque beyond the range of numbers", error)
      end if
   end subroutine check_product

   !> Place of a key among those of an effect; 0 if it has none of that name.
   pure integer function find_key(info, key) result(k)
      type(effect_info), intent(in) :: info
      character(*), intent(in) :: key
      do k = 1, size(info%keys)
         if (info%keys(k)%name == key) return
      end do
      k = 0
   end function find_key

end module poinsot_effect_settings
