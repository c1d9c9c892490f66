!> Entries in the text of a group of a scene file: their position, and how to change them without
!> touching comments. A text begins after "&name" and may extend beyond the slash of the group.
module poinsot_study_group_text
   use poinsot_scene_text, only: lower
   implicit none(type, external)
   private
   public :: set_entry, append_entry

   !> "key(1:2) = 1, 2": the columns where it begins, where its value does, and where it ends.
   type :: entry_place
      logical :: subscripted = .false.
      integer :: first = 0, value = 0, last = 0
   end type entry_place

   character(*), parameter :: break = new_line("a")
   character(*), parameter :: space = " " // achar(9)
   character(*), parameter :: separators = space // "," // break
   character(*), parameter :: letters = "abcdefghijklmnopqrstuvwxyz_0123456789"

contains

   !> Set all of a key: its value where it stands. Entries of some of its numbers go. Not found: the
   !> caller has to say where it is to stand.
   pure subroutine set_entry(text, key, value, found)
      character(:), allocatable, intent(inout) :: text
      character(*), intent(in) :: key            !! lower case
      character(*), intent(in) :: value          !! as it stands in a file, with its quotes
      logical, intent(out) :: found
      type(entry_place), allocatable :: places(:)
      integer :: i, whole
      call find_entries(text, key, places)
      whole = findloc(places%subscripted, .false., 1)
      found = whole > 0
      do i = size(places), 1, -1
         if (i == whole) then
            text = text(:places(i)%value - 1) // value // text(places(i)%last + 1:)
         else
            call remove(text, places(i))
         end if
      end do
   end subroutine set_entry

   !> An entry at the group's end, which is over all before it.
   pure subroutine append_entry(text, entry)
      character(:), allocatable, intent(inout) :: text
      character(*), intent(in) :: entry          !! key(2) = value
      type(entry_place) :: place
      integer :: slash, last
      slash = 1
      do
         call next_entry(text, slash, place)
         if (place%first == 0) exit
         slash = place%last + 1
      end do
      call skip_separators(text, slash)
      last = verify(text(:slash - 1), separators, back=.true.)
      if (index(text(:slash - 1), break, back=.true.) > last) then
         text = text(:slash - 1) // "   " // entry // break // text(slash:)
      else
         text = text(:last) // merge("  ", ", ", last == 0) // entry // " " // text(slash:)
      end if
   end subroutine append_entry

   !> All entries of a key, in their order.
   pure subroutine find_entries(text, key, places)
      character(*), intent(in) :: text, key
      type(entry_place), allocatable, intent(out) :: places(:)
      type(entry_place) :: place
      integer :: at
      allocate (places(0))
      at = 1
      do
         call next_entry(text, at, place)
         if (place%first == 0) return
         at = place%last + 1
         if (name_at(text, place%first) == key) places = [places, place]
      end do
   end subroutine find_entries

   !> The next entry from a column on; `first` is 0 at the group's slash.
   pure subroutine next_entry(text, from, place)
      character(*), intent(in) :: text
      integer, intent(in) :: from
      type(entry_place), intent(out) :: place
      integer :: at, behind
      at = from
      do
         call skip_separators(text, at)
         if (at > len(text)) return
         if (text(at:at) == "/") return
         behind = behind_equals(text, at)
         if (behind > 0 .and. place%first > 0) return ! the next one
         if (behind > 0) then
            place%first = at
            place%subscripted = scan(text(at:behind - 1), "(") > 0
            at = behind
            call skip_separators(text, at)
            place%value = at
            place%last = at - 1
         else
            at = behind_token(text, at)
            if (place%first > 0) place%last = at - 1
         end if
      end do
   end subroutine next_entry

   !> Behind blanks, commas, ends of lines, comments.
   pure subroutine skip_separators(text, at)
      character(*), intent(in) :: text
      integer, intent(inout) :: at
      integer :: ending
      do while (at <= len(text))
         if (text(at:at) == "!") then
            ending = index(text(at:) // break, break)
            at = at + ending
         else if (scan(text(at:at), separators) > 0) then
            at = at + 1
         else
            return
         end if
      end do
   end subroutine skip_separators

   !> Behind "key =", "key(1:2) =": 0 if there is none of these.
   pure integer function behind_equals(text, from) result(at)
      character(*), intent(in) :: text
      integer, intent(in) :: from
      integer :: next
      at = 0
      next = from + len(name_at(text, from))
      if (next == from) return
      next = next + verify(text(next:) // "=", space) - 1
      if (next > len(text)) return
      if (text(next:next) == "(") then
         next = next + index(text(next:) // ")", ")")
         next = next + verify(text(next:) // "=", space) - 1
         if (next > len(text)) return
      end if
      if (text(next:next) == "=") at = next + 1
   end function behind_equals

   !> The position after a quoted string or an unquoted word.
   pure integer function behind_token(text, from) result(at)
      character(*), intent(in) :: text
      integer, intent(in) :: from
      if (scan(text(from:from), "'""") > 0) then
         at = from + 1 + index(text(from + 1:) // text(from:from), text(from:from))
      else
         at = from + scan(text(from + 1:) // " ", separators // "/!'""")
      end if
   end function behind_token

   !> The name that begins at a column, in lower case.
   pure function name_at(text, at) result(name)
      character(*), intent(in) :: text
      integer, intent(in) :: at
      character(:), allocatable :: name
      name = lower(text(at:at + verify(lower(text(at:)) // " ", letters) - 2))
      if (verify("0123456789", name(:min(1, len(name)))) == 0) name = ""
   end function name_at

   !> An entry goes, and its line where nothing else is on it.
   pure subroutine remove(text, place)
      character(:), allocatable, intent(inout) :: text
      type(entry_place), intent(in) :: place
      integer :: before, behind
      before = verify(text(:place%first - 1), space, back=.true.)
      behind = place%last + verify(text(place%last + 1:) // break, space // ",")
      if (behind > len(text)) then
         text = text(:before)
      else if (text(behind:behind) == break .and. before > 0) then
         if (text(before:before) == break) before = before - 1
         text = text(:before) // text(behind:)
      else
         text = text(:place%first - 1) // text(behind:)
      end if
   end subroutine remove

end module poinsot_study_group_text
