!> Our own reader of scene files: Fortran namelist text into groups, keys and values with line
!> numbers, with messages that say what, where and what would be right (the run-time library's own
!> do not).
!>
!> The subset of namelist input that is read: `&name key = values / ` with any case;
!> `key(i) = values` from subscript i; values apart by blanks, line ends or one comma; nothing
!> between two commas is a null value (the default stays), as is `3*`; `3*0.0` repeats; numbers
!> with e or d; .true. .false. t f; strings in ' or " with the quote doubled inside, closed on their
!> own line; comments from ! to the line's end; /, or &end, closes. Lines end in LF, CRLF or CR.
!> Bytes beyond ASCII are welcome in comments and strings. Not read: unquoted words, sections
!> a(i:j), text between groups.
module poinsot_scene_reader
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io
   use poinsot_scene_text, only: lower, text_of, quoted
   use poinsot_scene_number, only: parse_real, parse_integer, number_no, number_range, number_ok
   use poinsot_scene_source, only: scene_value, scene_entry, scene_group, scene_source, append, &
      refuse, value_null, value_number, value_logical, value_text
   use poinsot_core_kinds, only: dp, i8
   implicit none(type, external)
   private
   public :: read_source, scan_source, scan_values

   integer, parameter :: largest_file = 16*1024*1024
   integer, parameter :: longest_name = 63
   character, parameter :: newline = achar(10), tab = achar(9)
   character(*), parameter :: letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_"
   character(*), parameter :: name_set = letters // "0123456789"
   character(*), parameter :: ends = " ,/!&='""" // tab // newline !! what ends a bare value

   !> A place in a text.
   type :: cursor
      character(:), allocatable :: file, text
      integer :: at = 1
      integer :: line = 1
      logical :: loose = .false. !! bare words are strings (command line)
   end type cursor

contains

   !> Read a scene file. Errors: POINSOT_E_IO if it cannot be read, POINSOT_E_SCENE if it is not a
   !> namelist file.
   subroutine read_source(file, source, error)
      character(*), intent(in) :: file
      type(scene_source), intent(out) :: source
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: text
      call load(file, text, error)
      if (raised(error)) return
      call scan_source(text, file, source, error)
   end subroutine read_source

   !> The whole file as text; at most 16 MB.
   subroutine load(file, text, error)
      character(*), intent(in) :: file
      character(:), allocatable, intent(out) :: text
      type(poinsot_error), intent(inout) :: error
      integer :: unit, code, length
      character(200) :: reason
      open (newunit=unit, file=file, access="stream", form="unformatted", action="read", &
            status="old", iostat=code, iomsg=reason)
      if (code /= 0) then
         call raise(error, poinsot_e_io, file // ": cannot be opened: " // trim(reason))
         return
      end if
      inquire (unit=unit, size=length)
      if (length > largest_file) then
         call refuse(error, file, 0, "is " // text_of(length) // " bytes long; a scene has at " // &
                     "most " // text_of(largest_file))
      else if (length > 0) then
         allocate (character(length) :: text, stat=code)
         if (code == 0) read (unit, iostat=code, iomsg=reason) text
         if (code /= 0) then
            call raise(error, poinsot_e_io, file // ": cannot be read: " // &
               trim(reason))
         end if
      else
         call load_slowly(unit, text, error, file)
      end if
      close (unit)
   end subroutine load

   !> Files without a size (pipes, /proc, /dev): byte by byte to the end.
   subroutine load_slowly(unit, text, error, file)
      integer, intent(in) :: unit
      character(:), allocatable, intent(out) :: text
      type(poinsot_error), intent(inout) :: error
      character(*), intent(in) :: file
      character(:), allocatable :: more
      character :: byte
      integer :: code, count
      allocate (character(65536) :: text)
      count = 0
      do
         read (unit, iostat=code) byte
         if (code /= 0) exit
         if (count == largest_file) then
            call refuse(error, file, 0, "has no end within " // text_of(largest_file) // " bytes")
            return
         end if
         if (count == len(text)) then
            more = text // repeat(" ", count)
            call move_alloc(more, text)
         end if
         count = count + 1
         text(count:count) = byte
      end do
      if (.not. is_iostat_end(code)) then
         call raise(error, poinsot_e_io, file // ": cannot be read")
         return
      end if
      more = text(:count)
      call move_alloc(more, text)
   end subroutine load_slowly

   !> Scan the text of a scene file. Error: POINSOT_E_SCENE naming file and line.
   subroutine scan_source(text, file, source, error)
      character(*), intent(in) :: text   !! the bytes of the file
      character(*), intent(in) :: file   !! its name, for messages
      type(scene_source), intent(out) :: source
      type(poinsot_error), intent(inout) :: error
      type(cursor) :: here
      type(scene_group) :: group
      source%file = file
      allocate (source%groups(0:0))
      deallocate (source%groups)
      here%file = file
      call normalise(text, here, error)
      do while (.not. raised(error))
         call skip(here)
         if (here%at > len(here%text)) exit
         if (here%text(here%at:here%at) /= "&") then
            call refuse(error, file, here%line, quoted(word_at(here)) // " stands outside of " // &
                        "a group; a group begins with &name and ends with /, a comment with !")
            return
         end if
         call scan_group(here, group, error)
         if (.not. raised(error)) call append(source, group)
      end do
      if (raised(error)) return
      if (source%count == 0) then
         call refuse(error, file, 0, &
            "holds no group; a scene has at least &scene and &bodies")
      end if
   end subroutine scan_source

   !> One line end for all systems, no byte-order mark; a control byte says that this is no text.
   subroutine normalise(text, here, error)
      character(*), intent(in) :: text
      type(cursor), intent(inout) :: here
      type(poinsot_error), intent(inout) :: error
      integer :: i, n, code, line
      character(*), parameter :: mark = char(239) // char(187) // char(191)
      allocate (character(len(text)) :: here%text)
      n = 0
      line = 1
      i = 1
      if (len(text) >= 3) then
         if (text(1:3) == mark) i = 4
      end if
      do while (i <= len(text))
         code = iand(iachar(text(i:i)), 255)
         if (code == 13) then
            code = 10
            if (i < len(text)) then
               if (text(i + 1:i + 1) == newline) i = i + 1
            end if
         end if
         if (code == 10) line = line + 1
         if ((code < 32 .and. code /= 9 .and. code /= 10) .or. code == 127) then
            call refuse(error, here%file, line, "holds the byte " // text_of(code) // &
                        ": not a text file; a scene is plain text (ASCII or UTF-8)")
            return
         end if
         n = n + 1
         here%text(n:n) = achar(code)
         if (code > 127) here%text(n:n) = text(i:i)
         i = i + 1
      end do
      here%text = here%text(:n)
   end subroutine normalise

   !> Raise POINSOT_E_SCENE naming file, line, group and key.
   subroutine complain(here, group, entry, message, error)
      type(cursor), intent(in) :: here
      character(*), intent(in) :: group
      type(scene_entry), intent(in) :: entry
      character(*), intent(in) :: message
      type(poinsot_error), intent(inout) :: error
      call refuse(error, here%file, here%line, "&" // group // " " // entry%key // message)
   end subroutine complain

   !> Past blanks, line ends and comments.
   subroutine skip(here)
      type(cursor), intent(inout) :: here
      integer :: last
      do while (here%at <= len(here%text))
         select case (here%text(here%at:here%at))
         case (newline)
            here%line = here%line + 1
            here%at = here%at + 1
         case (" ", tab)
            here%at = here%at + 1
         case ("!")
            last = index(here%text(here%at:), newline)
            if (last == 0) last = len(here%text) - here%at + 2
            here%at = here%at + last - 1
         case default
            return
         end select
      end do
   end subroutine skip

   !> What a message may quote: from here to the next blank, at least one byte.
   pure function word_at(here) result(word)
      type(cursor), intent(in) :: here
      character(:), allocatable :: word
      integer :: length
      length = scan(here%text(here%at:), " ," // tab // newline) - 1
      if (length < 0) length = len(here%text) - here%at + 1
      word = here%text(here%at:here%at + max(length, 1) - 1)
   end function word_at

   !> A name (letter or _, then letters, digits, _) from here on, lower case; "" if there is none.
   subroutine scan_name(here, name)
      type(cursor), intent(inout) :: here
      character(:), allocatable, intent(out) :: name
      integer :: length
      name = ""
      if (here%at > len(here%text)) return
      if (verify(here%text(here%at:here%at), letters) > 0) return
      length = verify(here%text(here%at:), name_set) - 1
      if (length < 0) length = len(here%text) - here%at + 1
      name = lower(here%text(here%at:here%at + length - 1))
      here%at = here%at + length
   end subroutine scan_name

   !> `&name ... /`, the cursor on the ampersand.
   subroutine scan_group(here, group, error)
      type(cursor), intent(inout) :: here
      type(scene_group), intent(out) :: group
      type(poinsot_error), intent(inout) :: error
      type(scene_entry) :: entry
      type(cursor) :: before
      character(:), allocatable :: name
      group%line = here%line
      here%at = here%at + 1
      call scan_name(here, group%name)
      if (len(group%name) == 0 .or. len(group%name) > longest_name) then
         call refuse(error, here%file, here%line, "& is not followed by the name of " // &
                     "a group, as in &scene")
         return
      end if
      do
         call skip(here)
         if (here%at > len(here%text)) then
            call refuse(error, here%file, group%line, "&" // group%name // &
                        " begins here and is not closed by /")
            return
         end if
         select case (here%text(here%at:here%at))
         case ("/")
            here%at = here%at + 1
            return
         case ("&")
            before%at = here%at
            here%at = here%at + 1
            call scan_name(here, name)
            if (name == "end") return
            call refuse(error, here%file, here%line, "&" // name // " begins inside of &" // &
                        group%name // " (line " // text_of(group%line) // &
                        "): is the closing / missing?")
            return
         case default
            call scan_entry(here, group%name, entry, error)
            if (raised(error)) return
            call append(group, entry)
         end select
      end do
   end subroutine scan_group

   !> `key = values` or `key(i) = values`.
   subroutine scan_entry(here, group, entry, error)
      type(cursor), intent(inout) :: here
      character(*), intent(in) :: group
      type(scene_entry), intent(out) :: entry
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: found
      entry%line = here%line
      found = word_at(here)
      call scan_name(here, entry%key)
      if (len(entry%key) == 0 .or. len(entry%key) > longest_name) then
         call refuse(error, here%file, here%line, "&" // group // ": " // quoted(found) // &
                     " where a key is expected, as in key = value")
         return
      end if
      call scan_subscript(here, group, entry, error)
      if (raised(error)) return
      call skip(here)
      if (here%at <= len(here%text)) then
         if (here%text(here%at:here%at) == "=") then
            here%at = here%at + 1
            call scan_list(here, group, entry, error)
            return
         end if
      end if
      call refuse(error, here%file, entry%line, "&" // group // ": " // quoted(entry%key) // &
                  " is not followed by = (is a string without its quotes?)")
   end subroutine scan_entry

   !> An optional (i).
   subroutine scan_subscript(here, group, entry, error)
      type(cursor), intent(inout) :: here
      character(*), intent(in) :: group
      type(scene_entry), intent(inout) :: entry
      type(poinsot_error), intent(inout) :: error
      integer :: last, outcome
      integer(i8) :: number
      if (here%at > len(here%text)) return
      if (here%text(here%at:here%at) /= "(") return
      last = scan(here%text(here%at:), ")" // newline)
      if (last == 0) last = 1
      call parse_integer(trim(adjustl(here%text(here%at + 1:here%at + last - 2))), number, outcome)
      if (outcome /= number_ok .or. number < 1 .or. number > 100000000) then
         call complain(here, group, entry, ": the subscript is not one positive " // &
                       "number in ( )", error)
         return
      end if
      entry%first = int(number)
      entry%subscripted = .true.
      here%at = here%at + last
   end subroutine scan_subscript

   !> The values behind the equals sign.
   subroutine scan_list(here, group, entry, error)
      type(cursor), intent(inout) :: here
      character(*), intent(in) :: group
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
      call complain(here, group, entry, " has no value; give one or leave the key out", error)
   end subroutine scan_list

   !> Is this `key =` or `key(i) =`, not a value?
   logical function key_ahead(here)
      type(cursor), intent(in) :: here
      integer :: at, length
      key_ahead = .false.
      at = here%at
      if (verify(here%text(at:at), letters) > 0) return
      length = verify(here%text(at:), name_set // "( )" // tab) - 1
      if (length < 0) return
      key_ahead = here%text(at + length:at + length) == "="
   end function key_ahead

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
         call complain(here, group, entry, ": " // quoted(word_at(here)) // " is not a value", &
                       error)
         return
      end if
      if (length > 0) then
         call classify(here, here%text(here%at:here%at + length - 1), group, entry, &
            value, error)
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
      integer :: length, outcome
      integer(i8) :: number
      value%repeats = 0
      length = verify(here%text(here%at:), "0123456789") - 1
      if (length <= 0) return
      if (here%text(here%at + length:here%at + length) /= "*") return
      call parse_integer(here%text(here%at:here%at + length - 1), number, outcome)
      if (outcome /= number_ok .or. number < 1 .or. number > 100000000) then
         call complain(here, group, entry, ": the repeat count " // quoted(word_at(here)) // &
                       " is not from 1 to 100000000", error)
         return
      end if
      value%repeats = int(number)
      here%at = here%at + length + 1
   end subroutine scan_repeats

   !> A string, the cursor on its opening quote.
   subroutine scan_string(here, group, entry, value, error)
      type(cursor), intent(inout) :: here
      character(*), intent(in) :: group
      type(scene_entry), intent(in) :: entry
      type(scene_value), intent(inout) :: value
      type(poinsot_error), intent(inout) :: error
      character :: quote
      integer :: length
      quote = here%text(here%at:here%at)
      value%kind = value_text
      value%repeats = max(value%repeats, 1)
      value%text = ""
      here%at = here%at + 1
      do
         length = scan(here%text(min(here%at, len(here%text) + 1):), quote // newline) - 1
         if (length >= 0) then
            if (here%text(here%at + length:here%at + length) == newline) length = -1
         end if
         if (length < 0) then
            call complain(here, group, entry, ": the closing quote of the string is missing " // &
                          "on its line", error)
            return
         end if
         value%text = value%text // here%text(here%at:here%at + length - 1)
         here%at = here%at + length + 1
         if (here%at > len(here%text)) return
         if (here%text(here%at:here%at) /= quote) return
         value%text = value%text // quote ! doubled inside
         here%at = here%at + 1
      end do
   end subroutine scan_string

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
         call complain(here, group, entry, " = " // quoted(word) // &
                       " is not finite or beyond 1e307; give a finite number", error)
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
            call complain(here, group, entry, ": " // quoted(word) // &
                          " is neither a number nor a string in quotes", error)
         end select
      end if
   end subroutine classify

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
      here%file = file
      here%line = 0
      here%loose = .true.
      call normalise(text, here, error)
      if (raised(error)) return
      here%line = 0
      if (scan(here%text, "'""*") > 0) then
         call scan_list(here, group, entry, error)
         if (raised(error) .or. here%at > len(here%text)) return
         call refuse(error, file, 0, quoted(word_at(here)) // " is not part of a value")
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

end module poinsot_scene_reader
