!> A position in the text of a scene file, and the elementary operations of the reader: skipping
!> blanks and comments, reading a name, reading a subscript.
module poinsot_scene_cursor
   use poinsot_core_kinds, only: i8
   use poinsot_core_error, only: poinsot_error
   use poinsot_core_number, only: parse_integer, number_ok
   use poinsot_scene_text, only: lower, text_of
   use poinsot_scene_source, only: scene_entry, reject
   implicit none(type, external)
   private
   public :: cursor, open_cursor, skip, word_at, scan_name, scan_subscript, reject_key
   public :: newline, tab, letters, name_set, longest_name

   integer, parameter :: longest_name = 63 !! of a group or a key
   integer, parameter :: largest_subscript = 100000000
   character, parameter :: newline = achar(10), tab = achar(9)
   character(*), parameter :: letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_"
   character(*), parameter :: name_set = letters // "0123456789" !! what a name is made of

   !> A place in a text.
   type :: cursor
      character(:), allocatable :: file, text
      integer :: at = 1
      integer :: line = 1
      logical :: loose = .false. !! bare words are strings (command line)
   end type cursor

contains

   !> Put the cursor before a text: one line end for all systems, no byte-order mark. Error:
   !> POINSOT_E_SCENE for a control byte, which says that this is no text.
   subroutine open_cursor(text, file, here, error)
      character(*), intent(in) :: text     !! the bytes of the file
      character(*), intent(in) :: file     !! its name, for messages
      type(cursor), intent(out) :: here
      type(poinsot_error), intent(inout) :: error
      integer :: i, n, code, line
      character(*), parameter :: mark = char(239) // char(187) // char(191)
      here%file = file
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
            call reject(error, file, line, "holds the byte " // text_of(code) // &
                        ": not a text file; a scene is plain text (ASCII or UTF-8)")
            return
         end if
         n = n + 1
         here%text(n:n) = achar(code)
         if (code > 127) here%text(n:n) = text(i:i)
         i = i + 1
      end do
      here%text = here%text(:n)
   end subroutine open_cursor

   !> Past blanks, line ends and comments.
   subroutine skip(here)
      type(cursor), intent(inout) :: here !! moves on
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
      type(cursor), intent(in) :: here !! where the reader is
      character(:), allocatable :: word
      integer :: length
      length = scan(here%text(here%at:), " ," // tab // newline) - 1
      if (length < 0) length = len(here%text) - here%at + 1
      word = here%text(here%at:here%at + max(length, 1) - 1)
   end function word_at

   !> The name (letter or _, then letters, digits, _) at this position, lower case; "" if none.
   subroutine scan_name(here, name)
      type(cursor), intent(inout) :: here !! moves on
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

   !> An optional (i), or a section (i:j) whose bounds may be left out.
   subroutine scan_subscript(here, group, entry, error)
      type(cursor), intent(inout) :: here !! moves on
      character(*), intent(in) :: group   !! its name
      type(scene_entry), intent(inout) :: entry
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: inside
      integer :: last, colon
      logical :: good
      if (here%at > len(here%text)) return
      if (here%text(here%at:here%at) /= "(") return
      last = scan(here%text(here%at:), ")" // newline)
      if (last == 0) last = 1
      inside = here%text(here%at + 1:here%at + last - 2)
      colon = index(inside, ":")
      if (colon == 0) then
         call read_bound(inside, 0, entry%first, good)
      else
         call read_bound(inside(:colon - 1), 1, entry%first, good)
         if (good) call read_bound(inside(colon + 1:), largest_subscript, entry%last, good)
         good = good .and. entry%last >= entry%first
      end if
      if (.not. good) then
         call reject_key(here, group, entry, ": in ( ) stands one positive subscript, as in " // &
                         "(2), or a section, as in (1:3)", error)
         return
      end if
      entry%subscripted = .true.
      here%at = here%at + last
   end subroutine scan_subscript

   !> A positive subscript; `default` if nothing is there, unless that is 0.
   subroutine read_bound(text, default, bound, good)
      character(*), intent(in) :: text
      integer, intent(in) :: default
      integer, intent(out) :: bound
      logical, intent(out) :: good
      integer(i8) :: number
      integer :: outcome
      bound = default
      good = default > 0
      if (len_trim(text) == 0) return
      call parse_integer(trim(adjustl(text)), number, outcome)
      good = outcome == number_ok
      if (good) good = number >= 1 .and. number <= largest_subscript
      if (good) bound = int(number)
   end subroutine read_bound

   !> Raise POINSOT_E_SCENE naming file, line, group and key.
   subroutine reject_key(here, group, entry, message, error)
      type(cursor), intent(in) :: here  !! where the reader is
      character(*), intent(in) :: group !! its name
      type(scene_entry), intent(in) :: entry
      character(*), intent(in) :: message
      type(poinsot_error), intent(inout) :: error
      call reject(error, here%file, here%line, "&" // group // " " // entry%key // message)
   end subroutine reject_key

end module poinsot_scene_cursor
