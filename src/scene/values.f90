!> The values of a key in a scene file: numbers, logicals, strings, repeats and null values.
module poinsot_scene_values
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_text, only: lower, quoted, text_of
   use poinsot_core_number, only: parse_real, parse_repeats, number_range, number_ok, most_repeats
   use poinsot_scene_source, only: scene_value, scene_entry, append, reject, value_number, &
      value_logical, value_text
   use poinsot_scene_cursor, only: cursor, open_cursor, skip, word_at, reject_key, newline, tab, &
      letters, name_set
   implicit none(type, external)
   private
   public :: scan_list, scan_values

   character(*), parameter :: blanks = " " // tab
   character(*), parameter :: ends = " ,/!&='""" // tab // newline !! what ends a bare value

contains

   !> The values behind the equals sign.
   subroutine scan_list(here, group, entry, error)
      type(cursor), intent(inout) :: here !! moves on
      character(*), intent(in) :: group   !! its name
      type(scene_entry), intent(inout) :: entry
      type(poinsot_error), intent(inout) :: error
      type(scene_value) :: nothing
      logical :: wanted
      wanted = .true.
      do
         call skip(here)
         if (here%at > len(here%text)) exit
         if (scan(here%text(here%at:here%at), "/&") == 1) exit
         if (here%text(here%at:here%at) == ",") then
            if (wanted) call append(entry, nothing)
            wanted = .true.
            here%at = here%at + 1
            cycle
         end if
         if (key_ahead(here)) exit
         call scan_value(here, group, entry, error)
         if (raised(error)) return
         wanted = .false.
      end do
      if (entry%count > 0) return
      call reject_key(here, group, entry, " has no value; give one or leave the key out", error)
   end subroutine scan_list

   !> Values as the command line gives them (`--set group.key=values`): apart by commas, strings
   !> with or without quotes.
   subroutine scan_values(text, file, group, entry, error)
      character(*), intent(in) :: text    !! what stands behind the equals sign
      character(*), intent(in) :: file    !! for messages
      character(*), intent(in) :: group   !! for messages
      type(scene_entry), intent(inout) :: entry !! its key is set; gets the values
      type(poinsot_error), intent(inout) :: error
      type(cursor) :: here
      type(scene_value) :: value
      integer :: first, last
      call open_cursor(text, file, here, error)
      if (raised(error)) return
      here%line = 0
      here%loose = .true.
      if (scan(here%text, "'""*") > 0) then
         call scan_list(here, group, entry, error)
         if (raised(error) .or. here%at > len(here%text)) return
         call reject(error, file, 0, quoted(word_at(here)) // " is not part of a value")
         return
      end if
      first = 1
      do while (first <= len(here%text) + 1)
         last = index(here%text(first:), ",") + first - 2
         if (last < first - 1) last = len(here%text)
         value = scene_value()
         if (len_trim(here%text(first:last)) > 0) then
            call classify(here, trim(adjustl(here%text(first:last))), group, entry, value, error)
         end if
         if (raised(error)) return
         call append(entry, value)
         first = last + 2
      end do
   end subroutine scan_values

   !> Is this `key =`, `key(i) =` or `key(i:j) =`, not a value?
   logical function key_ahead(here)
      type(cursor), intent(in) :: here
      integer :: at
      key_ahead = .false.
      if (verify(here%text(here%at:here%at), letters) > 0) return
      at = after(here%text, here%at, name_set)
      at = after(here%text, at, blanks)
      if (at > len(here%text)) return
      if (here%text(at:at) == "(") then
         at = after(here%text, at + 1, "0123456789:" // blanks)
         if (at > len(here%text)) return
         if (here%text(at:at) /= ")") return
         at = after(here%text, at + 1, blanks)
         if (at > len(here%text)) return
      end if
      key_ahead = here%text(at:at) == "="
   end function key_ahead

   !> The first place from `at` on that holds none of a set.
   pure integer function after(text, at, set)
      character(*), intent(in) :: text, set
      integer, intent(in) :: at
      after = verify(text(at:), set)
      if (after == 0) after = len(text) - at + 2
      after = at + after - 1
   end function after

   !> One value, with its repeat count.
   subroutine scan_value(here, group, entry, error)
      type(cursor), intent(inout) :: here
      character(*), intent(in) :: group
      type(scene_entry), intent(inout) :: entry
      type(poinsot_error), intent(inout) :: error
      type(scene_value) :: value
      integer :: length
      call scan_repeats(here, group, entry, value, error)
      if (raised(error)) return
      length = 0
      if (here%at <= len(here%text)) then
         if (scan(here%text(here%at:here%at), "'""") == 1) then
            call scan_string(here, group, entry, value, error)
            if (.not. raised(error)) call append(entry, value)
            return
         end if
         length = scan(here%text(here%at:), ends) - 1
         if (length < 0) length = len(here%text) - here%at + 1
      end if
      if (length == 0 .and. value%repeats == 0) then
         call reject_key(here, group, entry, &
                       ": " // quoted(word_at(here)) // " is not a value", error)
         return
      end if
      if (length > 0) then
         call classify(here, here%text(here%at:here%at + length - 1), group, entry, value, error)
      end if
      if (raised(error)) return
      value%repeats = max(value%repeats, 1)
      here%at = here%at + length
      call append(entry, value)
   end subroutine scan_value

   !> `n*` if there is one, else 0 repeats for now.
   subroutine scan_repeats(here, group, entry, value, error)
      type(cursor), intent(inout) :: here
      character(*), intent(in) :: group
      type(scene_entry), intent(in) :: entry
      type(scene_value), intent(inout) :: value
      type(poinsot_error), intent(inout) :: error
      integer :: length
      logical :: good
      call parse_repeats(here%text(here%at:), value%repeats, length, good)
      if (.not. good) call reject_key(here, group, entry, ": the repeat count " // &
         quoted(word_at(here)) // " is not from 1 to " // text_of(most_repeats), error)
      here%at = here%at + length
   end subroutine scan_repeats

   !> A string, the cursor on its opening quote.
   subroutine scan_string(here, group, entry, value, error)
      type(cursor), intent(inout) :: here
      character(*), intent(in) :: group
      type(scene_entry), intent(in) :: entry
      type(scene_value), intent(inout) :: value
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: found
      character :: quote
      integer :: n
      quote = here%text(here%at:here%at)
      value%kind = value_text
      value%repeats = max(value%repeats, 1)
      n = 0
      allocate (character(64) :: found)
      do
         here%at = here%at + 1
         if (here%at > len(here%text)) exit
         if (here%text(here%at:here%at) == newline) exit
         if (here%text(here%at:here%at) == quote) then
            here%at = here%at + 1
            if (.not. is_at(here, quote)) then ! else one, doubled inside
               value%text = found(:n)
               return
            end if
         end if
         if (n == len(found)) found = found//repeat(" ", n)
         n = n + 1
         found(n:n) = here%text(here%at:here%at)
      end do
      call reject_key(here, group, entry, ": the closing quote of the string is missing on its "// &
                      "line", error)
   end subroutine scan_string

   !> Does this character come next?
   pure logical function is_at(here, letter)
      type(cursor), intent(in) :: here
      character, intent(in) :: letter
      is_at = .false.
      if (here%at <= len(here%text)) is_at = here%text(here%at:here%at) == letter
   end function is_at

   !> Number, logical or bare word.
   subroutine classify(here, word, group, entry, value, error)
      type(cursor), intent(in) :: here
      character(*), intent(in) :: word, group
      type(scene_entry), intent(in) :: entry
      type(scene_value), intent(inout) :: value
      type(poinsot_error), intent(inout) :: error
      integer :: outcome
      value%text = word
      call parse_real(word, value%number, outcome)
      if (outcome == number_ok) then
         value%kind = value_number
      else if (outcome == number_range) then
         call reject_key(here, group, entry, " = " // quoted(word) // &
                       " must be finite and at most 1e307 in size", error)
      else
         value%kind = value_logical
         select case (lower(word))
         case (".true.", ".t.", "t", "true")
            value%flag = .true.
         case (".false.", ".f.", "f", "false")
            value%flag = .false.
         case default
            value%kind = value_text
            if (here%loose) return
            call reject_key(here, group, entry, ": " // quoted(word) // &
                          " is neither a number nor a string in quotes", error)
         end select
      end if
   end subroutine classify

end module poinsot_scene_values
