!> What a user says about an effect (key = values), what an effect says about its keys, and the
!> meeting of the two. The default of a key is the text in its description: there is no second place
!> that could disagree.
module poinsot_effect_settings
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, name_length
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_method, poinsot_e_size
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_nearest, only: suggestion
   use poinsot_core_number, only: trusted_reals
   implicit none(type, external)
   private
   public :: setting, effect_key, effect_info, number_key, text_key
   public :: body_vector, class_vectors, per_axis
   public :: check_keys, get_values, get_value, get_text, get_direction, was_given, &
      is_missing, &
      number_setting, text_setting

   !> What frame the numbers of a key are in; "" is space, or none. They are turned when an effect
   !> acts on a class that was given in another frame than the principal one.
   character(*), parameter :: body_vector = "body vector"     !! three numbers for each vector
   character(*), parameter :: class_vectors = "class vectors" !! three for all classes, or for each
   character(*), parameter :: per_axis = "per axis"           !! one number, or one for each body
                                                              !! axis; where these are not
                                                              ! principal,
                                                              !! the effect gets a matrix: nine

   !> One thing a user says: a key with numbers, or with a text.
   type :: setting
      character(:), allocatable :: key
      real(dp), allocatable :: values(:)  !! allocated for numbers
      character(:), allocatable :: text   !! allocated for a text
   end type setting

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
   end type effect_key

   !> One effect as the registry shows it.
   type :: effect_info
      character(name_length) :: name = ""
      character(128) :: formula = ""
      character(120) :: check = ""       !! the analytic result it is tested against
      integer :: order = 0               !! highest order a splitting reaches with it; 0 = no limit
      logical :: gradient = .true.       !! has the force gradient in closed form
      type(effect_key), allocatable :: keys(:)
   end type effect_info

contains

   !> Describe a key that takes numbers.
   pure function number_key(name, least, most, default, units, meaning, frame, frame_key) &
         result(key)
      character(*), intent(in) :: name, default, units, meaning
      integer, intent(in) :: least, most
      character(*), intent(in), optional :: frame, frame_key
      type(effect_key) :: key
      key = effect_key(name, .false., least, most, default, units, meaning)
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
      made%key = key
      allocate (made%values, source=values)
   end function number_setting

   !> key = 'text'
   pure function text_setting(key, text) result(made)
      character(*), intent(in) :: key, text
      type(setting) :: made
      made%key = key
      made%text = text
   end function text_setting

   !> Refuse keys the effect does not know (naming the nearest one), keys given twice, numbers for a
   !> text and a text for numbers, wrong counts, numbers that are not finite, words that are not a
   !> choice.
   pure subroutine check_keys(info, settings, error)
      type(effect_info), intent(in) :: info    !! the row of the registry
      type(setting), intent(in) :: settings(:) !! checked against the row
      type(poinsot_error), intent(inout) :: error
      integer :: i, j, k
      do i = 1, size(settings)
         k = find_key(info, settings(i)%key)
         if (k == 0) then
            call raise(error, poinsot_e_method, "effect '" // trim(info%name) // &
                       "': unknown key '" // settings(i)%key // "'" // &
                       suggestion(settings(i)%key, info%keys%name))
            return
         end if
         do j = 1, i - 1
            if (settings(j)%key == settings(i)%key) then
               call reject(info, info%keys(k), "is given twice", error)
               return
            end if
         end do
         call check_one(info, info%keys(k), settings(i), error)
         if (raised(error)) return
      end do
      do k = 1, size(info%keys)
         if (is_missing(info, k, settings)) then
            call reject(info, info%keys(k), "is required: " // trim(info%keys(k)%meaning), error)
         else if (is_double(info, k, settings)) then
            call reject(info, info%keys(k), "is given instead of '" // &
                        trim(info%keys(k)%instead_of) // "', not beside it", error)
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

   pure subroutine check_one(info, key, given, error)
      type(effect_info), intent(in) :: info
      type(effect_key), intent(in) :: key
      type(setting), intent(in) :: given
      type(poinsot_error), intent(inout) :: error
      character(12) :: least, most
      logical :: known
      if (key%is_text .and. .not. allocated(given%text)) then
         call reject(info, key, "takes a text", error)
      else if (allocated(given%text) .and. .not. key%is_text) then
         call reject(info, key, "takes numbers only", error)
      else if (key%is_text) then
         known = index(" " // trim(key%units) // " ", " " // given%text // " ") > 0
         if (key%units /= "" .and. .not. known) then
            call reject(info, key, "= '" // given%text // "' is not one of: " // &
                        trim(key%units), error)
         end if
      else if (.not. allocated(given%values)) then
         call reject(info, key, "takes numbers, none is given", error)
      else if (size(given%values) < key%least .or. (key%most >= 0 .and. size(given%values) &
         > key%most)) then
         write (least, "(i0)") key%least
         write (most, "(i0)") key%most
         if (key%most < 0) most = "more"
         call reject(info, key, &
                     "takes " // trim(least) // " to " // trim(most) // " numbers", error)
         error%code = poinsot_e_size
      else if (.not. all(ieee_is_finite(given%values))) then
         call reject(info, key, "has a value that is not finite", error)
      end if
   end subroutine check_one

   pure subroutine reject(info, key, why, error)
      type(effect_info), intent(in) :: info
      type(effect_key), intent(in) :: key
      character(*), intent(in) :: why
      type(poinsot_error), intent(inout) :: error
      call raise(error, poinsot_e_domain, "effect '" // trim(info%name) // "': key '" // &
         trim(key%name) // "' " // why)
   end subroutine reject

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
      allocate (values(merge(0, info%keys(k)%least, info%keys(k)%default == "")))
      call trusted_reals(info%keys(k)%default, values)
   end subroutine get_values

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
         call reject(info, info%keys(find_key(info, key)), &
                     "is a direction and must not be zero", error)
      end if
   end subroutine get_direction

   pure integer function find_key(info, key) result(k)
      type(effect_info), intent(in) :: info
      character(*), intent(in) :: key
      do k = 1, size(info%keys)
         if (info%keys(k)%name == key) return
      end do
      k = 0
   end function find_key

end module poinsot_effect_settings
