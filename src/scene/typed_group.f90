!> A group of the scene file met with the table of its keys: values of the right type and number,
!> defaults filled in, and the line of each key kept for messages.
module poinsot_scene_typed_group
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised, clear
   use poinsot_core_nearest, only: suggestion
   use poinsot_core_number, only: trusted_reals
   use poinsot_effect_settings, only: effect_info, effect_key, setting, is_missing
   use poinsot_scene_text, only: text_of, quoted
   use poinsot_scene_source, only: scene_value, scene_entry, scene_group, reject, &
      value_null, value_number, value_text, value_logical
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
         k = find_key(info, group%entries(i)%key)
         if (k == 0) then
            call reject(error, file, group%entries(i)%line, "&" // group%name // &
                        ": unknown key " // quoted(group%entries(i)%key) // &
                        key_suggestion(info, group%entries(i)%key))
            return
         end if
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
         call convert(typed, info%keys(k), group%entries(i), typed%settings(here), error)
         if (raised(error)) return
      end do
      typed%settings = typed%settings(:found)
      call check_complete(typed, error)
   end subroutine type_group

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
         call reject_key(typed, item%key, "takes one text in quotes", error)
      else if (entry%values(1)%kind == value_null) then
         item%text = trim(key%default)
      else if (entry%values(1)%kind /= value_text) then
         call reject_key(typed, item%key, "= " // quoted(entry%values(1)%text) // &
                       " is not a text; put it in quotes", error)
      else
         item%text = trim(entry%values(1)%text)
         if (key%units == "" .or. is_choice(item%text, trim(key%units))) return
         call reject_key(typed, item%key, "= " // quoted(item%text) // " is not one of: " // &
                       trim(key%units), error)
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

   pure logical function is_choice(text, choices)
      character(*), intent(in) :: text, choices
      is_choice = len(text) > 0 .and. index(text, " ") == 0
      if (is_choice) is_choice = index(" " // choices // " ", " " // text // " ") > 0
   end function is_choice

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
      if (last > most) then
         call reject_key(typed, item%key, "takes " // count_text(key) // ", more are given", error)
         return
      end if
      call default_numbers(key, defaults)
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

   !> The default of a key as numbers; size 0 if there is none.
   subroutine default_numbers(key, values)
      type(effect_key), intent(in) :: key
      real(dp), allocatable, intent(out) :: values(:)
      allocate (values(0))
      if (key%default == "" .or. key%default == "required") return
      deallocate (values)
      allocate (values(max(key%least, 1)))
      call trusted_reals(key%default, values)
   end subroutine default_numbers

   !> Every number there, enough of them, and every required key.
   subroutine check_complete(typed, error)
      type(typed_group), intent(in) :: typed
      type(poinsot_error), intent(inout) :: error
      type(effect_key) :: key
      integer :: i
      do i = 1, size(typed%settings)
         key = typed%info%keys(find_key(typed%info, typed%settings(i)%key))
         if (key%is_text) cycle
         if (size(typed%settings(i)%values) < key%least) then
            call reject_key(typed, typed%settings(i)%key, "takes " // count_text(key) // &
                          ", too few are given", error)
            return
         else if (any(typed%settings(i)%values == huge(1.0_dp))) then
            call reject_key(typed, typed%settings(i)%key, &
               "has a place without a value, and no " // &
                          "default for it", error)
            return
         end if
      end do
      do i = 1, size(typed%info%keys)
         if (.not. is_missing(typed%info, i, typed%settings)) cycle
         call reject(error, typed%file, typed%line, "&" // typed%name // ": the key """ // &
                     trim(typed%info%keys(i)%name) // """ is required: " // &
                     trim(typed%info%keys(i)%meaning))
         return
      end do
   end subroutine check_complete

   !> "3 numbers", "1 to 3 numbers", "1 or more numbers"
   pure function count_text(key) result(text)
      type(effect_key), intent(in) :: key
      character(:), allocatable :: text
      text = text_of(key%least)
      if (key%most < 0) then
         text = text // " to " // text_of(largest_list)
      else if (key%most > key%least) then
         text = text // " to " // text_of(key%most)
      end if
      text = text // " number"
      if (key%most /= 1) text = text // "s"
   end function count_text

   pure function key_suggestion(info, name) result(text)
      type(effect_info), intent(in) :: info
      character(*), intent(in) :: name
      character(:), allocatable :: text
      character(len(info%keys%name)) :: names(size(info%keys))
      integer :: k
      do k = 1, size(names)
         names(k) = info%keys(k)%name
      end do
      text = suggestion(name, names, """", """")
   end function key_suggestion

   pure integer function find_key(info, name) result(k)
      type(effect_info), intent(in) :: info
      character(*), intent(in) :: name
      do k = 1, size(info%keys)
         if (info%keys(k)%name == name) return
      end do
      k = 0
   end function find_key

   pure integer function find_setting(typed, key) result(k)
      type(typed_group), intent(in) :: typed
      character(*), intent(in) :: key
      if (allocated(typed%settings)) then
         do k = 1, size(typed%settings)
            if (typed%settings(k)%key == key) return
         end do
      end if
      k = 0
   end function find_setting

   !> Did the user give this key?
   pure logical function given(typed, key)
      type(typed_group), intent(in) :: typed !! keys with their values
      character(*), intent(in) :: key        !! its name
      given = find_setting(typed, key) > 0
   end function given

   !> The numbers of a key, given or default; size 0 if there are none.
   subroutine numbers_of(typed, key, values)
      type(typed_group), intent(in) :: typed           !! keys with their values
      character(*), intent(in) :: key                  !! its name
      real(dp), allocatable, intent(out) :: values(:)
      integer :: k
      k = find_setting(typed, key)
      if (k > 0) then
         values = typed%settings(k)%values
      else
         call default_numbers(typed%info%keys(find_key(typed%info, key)), values)
      end if
   end subroutine numbers_of

   !> The one number of a key, given or default; 0 if there is none.
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
      integer :: k
      k = find_setting(typed, key)
      if (k > 0) then
         text = typed%settings(k)%text
      else
         text = trim(typed%info%keys(find_key(typed%info, key))%default)
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
      integer :: k, line
      k = find_setting(typed, key)
      line = typed%line
      if (k > 0) line = typed%lines(k)
      call reject(error, typed%file, line, "&" // typed%name // ": " // key // " " // message)
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
