!> A group of the scene file checked against the table of its keys: values of the right type and
!> number, defaults filled in, and the line of each key kept for messages.
module poinsot_scene_typed_group
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised, clear
   use poinsot_effect_settings, only: effect_info, effect_key, setting, settings_place, &
      check_keys, reject_unknown, reject_setting => reject_key, find_key, default_values, &
      get_values, get_text, was_given
   use poinsot_scene_text, only: text_of, quoted
   use poinsot_scene_source, only: scene_value, scene_entry, scene_group, value_null, &
      value_number, value_text, value_logical, from_option
   implicit none(type, external)
   private
   public :: typed_group, type_group, given, number_of, numbers_of, word_of, integer_of, plain, &
      reject_key, relabel
   public :: flag_of, is_logical, logical_choices, largest_list

   character(*), parameter :: logical_choices = ".true. .false." !! units of a logical key

   integer, parameter :: largest_list = 1000000 !! most numbers one key may hold

   !> One group, read.
   type :: typed_group
      character(:), allocatable :: file
      character(:), allocatable :: name
      integer :: line = 0                        !! of its opening; 0 if it is absent
      type(effect_info) :: info
      type(setting), allocatable :: settings(:)  !! one per key that was given
      integer, allocatable :: lines(:)           !! of each setting
   end type typed_group

contains

   !> Give the entries of a group the types of its table. Error: POINSOT_E_SCENE for an unknown key
   !> (naming the nearest one), a key given twice, a value of the wrong type, too few or too many.
   subroutine type_group(file, group, info, typed, error)
      character(*), intent(in) :: file           !! for messages
      type(scene_group), intent(in) :: group     !! as scanned
      type(effect_info), intent(in) :: info      !! the keys it may have
      type(typed_group), intent(out) :: typed
      type(poinsot_error), intent(inout) :: error
      integer :: i, j, k, found, here
      typed%file = file
      typed%name = group%name
      typed%line = group%line
      typed%info = info
      allocate (typed%settings(group%count), typed%lines(group%count))
      found = 0
      do i = 1, group%count
         here = 0
         do j = 1, found
            if (typed%settings(j)%key == group%entries(i)%key) here = j
         end do
         if (here > 0 .and. .not. group%entries(i)%subscripted) then
            call reject_key(typed, group%entries(i)%key, "is given twice, again in line " // &
                          text_of(group%entries(i)%line), error)
            return
         end if
         if (here == 0) then
            found = found + 1
            here = found
            typed%settings(here)%key = group%entries(i)%key
            typed%lines(here) = group%entries(i)%line
         end if
         if (group%entries(i)%line == from_option) typed%lines(here) = from_option
         k = find_key(info, group%entries(i)%key)
         if (k == 0) then
            call reject_unknown(info, typed%settings(:found), here, error, place_of(typed))
         else
            call convert(typed, info%keys(k), group%entries(i), typed%settings(here), error)
         end if
         if (raised(error)) return
      end do
      typed%settings = typed%settings(:found)
      call check_keys(info, typed%settings, error, place_of(typed))
      if (.not. raised(error)) call check_places(typed, error)
   end subroutine type_group

   pure function place_of(typed) result(at)
      type(typed_group), intent(in) :: typed
      type(settings_place) :: at
      at%file = typed%file
      at%group = typed%name
      at%line = typed%line
      if (allocated(typed%lines)) at%lines = typed%lines
   end function place_of

   !> One entry into its setting.
   subroutine convert(typed, key, entry, item, error)
      type(typed_group), intent(in) :: typed
      type(effect_key), intent(in) :: key
      type(scene_entry), intent(in) :: entry
      type(setting), intent(inout) :: item
      type(poinsot_error), intent(inout) :: error
      if (key%is_text) then
         call convert_text(typed, key, entry, item, error)
      else
         call convert_numbers(typed, key, entry, item, error)
      end if
   end subroutine convert

   subroutine convert_text(typed, key, entry, item, error)
      type(typed_group), intent(in) :: typed
      type(effect_key), intent(in) :: key
      type(scene_entry), intent(in) :: entry
      type(setting), intent(inout) :: item
      type(poinsot_error), intent(inout) :: error
      logical :: one
      one = entry%count == 1 .and. entry%first == 1
      if (one) one = entry%values(1)%repeats == 1
      if (one .and. is_logical(key)) then
         call convert_logical(typed, key, entry%values(1), item, error)
      else if (.not. one) then
         call reject_key(typed, item%key, "takes one string in quotes", error)
      else if (entry%values(1)%kind == value_null) then
         item%text = trim(key%default)
      else if (entry%values(1)%kind /= value_text) then
         call reject_key(typed, item%key, "= " // quoted(entry%values(1)%text) // &
                       " is not a string; put it in quotes", error)
      else
         item%text = trim(entry%values(1)%text)
      end if
   end subroutine convert_text

   !> .true. or .false., however it is written; --set may have it as a bare word.
   subroutine convert_logical(typed, key, value, item, error)
      type(typed_group), intent(in) :: typed
      type(effect_key), intent(in) :: key
      type(scene_value), intent(in) :: value
      type(setting), intent(inout) :: item
      type(poinsot_error), intent(inout) :: error
      if (value%kind == value_null) then
         item%text = trim(key%default)
      else if (value%kind == value_logical) then
         item%text = trim(merge(".true. ", ".false.", value%flag))
      else
         call reject_key(typed, item%key, "= " // quoted(value%text) // &
            " is neither .true. nor " // &
                         ".false.", error)
      end if
   end subroutine convert_logical

   !> Does a key take .true. or .false.?
   elemental logical function is_logical(key)
      type(effect_key), intent(in) :: key
      is_logical = key%is_text .and. key%units == logical_choices
   end function is_logical

   !> Numbers from the entry's subscript on; null values keep what is there, else the default.
   subroutine convert_numbers(typed, key, entry, item, error)
      type(typed_group), intent(in) :: typed
      type(effect_key), intent(in) :: key
      type(scene_entry), intent(in) :: entry
      type(setting), intent(inout) :: item
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: room(:), defaults(:)
      integer :: i, j, at, last, most
      most = key%most
      if (most < 0) most = largest_list
      last = last_subscript(entry, most)
      if (last > largest_list) then
         call reject_key(typed, item%key, "takes at most " // text_of(largest_list) // &
                         " numbers, more are given", error)
         return
      end if
      if (last > entry%last) then
         call reject_key(typed, item%key, "(" // text_of(entry%first) // ":" // &
            text_of(entry%last) // ") has room for " // text_of(entry%last - entry%first + 1) // &
            " numbers, more are given", error)
         return
      end if
      call default_values(key, defaults)
      allocate (room(max(last, size(defaults))))
      room = huge(room) ! marks a place without a value: no scene holds a number beyond 1e307
      room(:size(defaults)) = defaults
      if (allocated(item%values)) then
         if (size(item%values) > size(room)) room = [room, item%values(size(room) + 1:)]
         room(:size(item%values)) = item%values
      end if
      at = entry%first - 1
      do i = 1, entry%count
         if (entry%values(i)%kind /= value_null .and. entry%values(i)%kind /= value_number) then
            call reject_key(typed, item%key, "takes numbers; " // quoted(entry%values(i)%text) // &
                          " is not a number", error)
            return
         end if
         do j = 1, entry%values(i)%repeats
            at = at + 1
            if (at > size(room)) exit ! trailing null values
            if (entry%values(i)%kind == value_number) room(at) = entry%values(i)%number
         end do
      end do
      call move_alloc(room, item%values)
   end subroutine convert_numbers

   !> The last subscript that an entry gives a number to, at most `most + 1`.
   pure integer function last_subscript(entry, most) result(last)
      type(scene_entry), intent(in) :: entry
      integer, intent(in) :: most
      integer :: i
      integer(i8) :: at
      at = entry%first - 1
      last = 0
      do i = 1, entry%count
         at = min(at + entry%values(i)%repeats, int(most, i8) + 1)
         if (entry%values(i)%kind /= value_null) last = int(at)
      end do
   end function last_subscript

   !> Every place has a value, its default or the user's.
   subroutine check_places(typed, error)
      type(typed_group), intent(in) :: typed
      type(poinsot_error), intent(inout) :: error
      integer :: i
      do i = 1, size(typed%settings)
         if (.not. allocated(typed%settings(i)%values)) cycle
         if (.not. any(typed%settings(i)%values == huge(1.0_dp))) cycle
         call reject_key(typed, typed%settings(i)%key, &
            "has a place without a value, and no default for it", error)
         return
      end do
   end subroutine check_places

   !> Did the user give this key?
   pure logical function given(typed, key)
      type(typed_group), intent(in) :: typed !! keys with their values
      character(*), intent(in) :: key        !! its name
      given = .false.
      if (allocated(typed%settings)) given = was_given(typed%settings, key)
   end function given

   !> The numbers of a key, given or default; size 0 if there are none.
   subroutine numbers_of(typed, key, values)
      type(typed_group), intent(in) :: typed           !! keys with their values
      character(*), intent(in) :: key                  !! its name
      real(dp), allocatable, intent(out) :: values(:)
      type(setting) :: none(0)
      if (allocated(typed%settings)) then
         call get_values(typed%info, typed%settings, key, values)
      else
         call get_values(typed%info, none, key, values)
      end if
   end subroutine numbers_of

   !> The number of a key, given or default; 0 if there is none.
   real(dp) function number_of(typed, key) result(value)
      type(typed_group), intent(in) :: typed !! keys with their values
      character(*), intent(in) :: key        !! its name
      real(dp), allocatable :: values(:)
      call numbers_of(typed, key, values)
      value = 0
      if (size(values) > 0) value = values(1)
   end function number_of

   !> The text of a key, given or default.
   function word_of(typed, key) result(text)
      type(typed_group), intent(in) :: typed !! keys with their values
      character(*), intent(in) :: key        !! its name
      character(:), allocatable :: text
      type(setting) :: none(0)
      if (allocated(typed%settings)) then
         text = get_text(typed%info, typed%settings, key)
      else
         text = get_text(typed%info, none, key)
      end if
   end function word_of

   !> A logical key, given or default.
   logical function flag_of(typed, key)
      type(typed_group), intent(in) :: typed !! keys with their values
      character(*), intent(in) :: key        !! its name
      flag_of = word_of(typed, key) == ".true."
   end function flag_of

   !> The one number of a key as an integer within bounds. Error: POINSOT_E_SCENE.
   subroutine integer_of(typed, key, least, most, value, error)
      type(typed_group), intent(in) :: typed           !! keys with their values
      character(*), intent(in) :: key                  !! its name
      integer(i8), intent(in) :: least, most           !! bounds
      integer(i8), intent(out) :: value
      type(poinsot_error), intent(inout) :: error
      real(dp) :: number
      value = least
      number = number_of(typed, key)
      if (number >= real(least, dp) .and. number <= real(most, dp)) then
         value = nint(number, i8)
         if (real(value, dp) == number) return
      end if
      call reject_key(typed, key, "= " // plain(number) // " is not an integer from " // &
                    text_of(least) // " to " // text_of(most), error)
   end subroutine integer_of

   !> A number as a user would write it: 9999, not 9999.0.
   function plain(number) result(text)
      real(dp), intent(in) :: number
      character(:), allocatable :: text
      text = text_of(number)
      if (abs(number) > 1e9_dp) return
      if (abs(number - anint(number)) <= 0) text = text_of(nint(number))
   end function plain

   !> Raise POINSOT_E_SCENE naming file, line, group and key.
   subroutine reject_key(typed, key, message, error)
      type(typed_group), intent(in) :: typed !! keys with their values
      character(*), intent(in) :: key        !! its name
      character(*), intent(in) :: message    !! what is wrong and what would be right
      type(poinsot_error), intent(inout) :: error
      type(setting) :: none(0)
      if (allocated(typed%settings)) then
         call reject_setting(typed%info, typed%settings, key, message, error, place_of(typed))
      else
         call reject_setting(typed%info, none, key, message, error, place_of(typed))
      end if
   end subroutine reject_key

   !> An error of the numerical library, with the place in front.
   subroutine relabel(group, key, error)
      type(typed_group), intent(in) :: group         !! where the value stands
      character(*), intent(in) :: key                !! its key
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: message
      if (.not. raised(error)) return
      message = error%message
      call clear(error)
      call reject_key(group, key, "refused: " // message, error)
   end subroutine relabel

end module poinsot_scene_typed_group
