!> A scene file with a choice filled in: the text of the file as it is, comments and all, with
!> method, splitting and step of &scene set.
module poinsot_study_fill_scene
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io, poinsot_e_scene
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_text, only: lower
   implicit none(type, external)
   private
   public :: fill_scene, set_keys, text_line, insert_line, set_as_told

   !> A line of any length.
   type :: text_line
      character(:), allocatable :: text
   end type text_line

contains

   !> Copy a scene file with keys of &scene set. Error: POINSOT_E_IO; POINSOT_E_SCENE if there is no
   !> &scene in it.
   subroutine fill_scene(from, to, head, settings, keys, values, error)
      character(*), intent(in) :: from, to       !! files
      character(*), intent(in) :: head           !! a comment for the first line
      type(text_line), intent(in) :: settings(:) !! of --set: group.key=value, set before
      character(*), intent(in) :: keys(:)
      type(text_line), intent(in) :: values(:) !! as they stand in the file, strings with their
         !! quotes
      type(poinsot_error), intent(inout) :: error
      type(text_line), allocatable :: lines(:)
      type(out_file) :: file
      integer :: i
      logical :: found
      call read_lines(from, lines, error)
      if (raised(error)) return
      do i = 1, size(settings)
         call set_as_told(lines, settings(i)%text)
      end do
      call set_keys(lines, "scene", keys, values, found)
      if (.not. found) then
         call raise(error, poinsot_e_scene, from // ": has no &scene group")
         return
      end if
      call open_out(to, file, error)
      if (raised(error)) return
      call put(file, "! " // head, error)
      do i = 1, size(lines)
         call put(file, lines(i)%text, error)
      end do
      call finish_out(file, error)
   end subroutine fill_scene

   !> One more line, behind line number `behind`.
   subroutine insert_line(lines, behind, text)
      type(text_line), allocatable, intent(inout) :: lines(:)
      integer, intent(in) :: behind
      character(*), intent(in) :: text
      type(text_line), allocatable :: more(:)
      integer :: i
      allocate (more(size(lines) + 1))
      do i = 1, size(lines)
         call move_alloc(lines(i)%text, more(merge(i, i + 1, i <= behind))%text)
      end do
      more(behind + 1)%text = text
      call move_alloc(more, lines)
   end subroutine insert_line

   subroutine read_lines(path, lines, error)
      character(*), intent(in) :: path
      type(text_line), allocatable, intent(out) :: lines(:)
      type(poinsot_error), intent(inout) :: error
      character(1000) :: buffer
      character(200) :: reason
      integer :: unit, code
      allocate (lines(0))
      open (newunit=unit, file=path, action="read", status="old", iostat=code, iomsg=reason)
      if (code /= 0) then
         call raise(error, poinsot_e_io, path // ": cannot be read: " // trim(reason))
         return
      end if
      do
         read (unit, "(a)", iostat=code) buffer
         if (code /= 0) exit
         call insert_line(lines, size(lines), trim(buffer))
      end do
      close (unit)
   end subroutine read_lines

   !> "group.key=value" or "group(2).key=value", as --set has it, which was found right before; a
   !> group that is not there is added.
   subroutine set_as_told(lines, setting)
      type(text_line), allocatable, intent(inout) :: lines(:)
      character(*), intent(in) :: setting
      character(:), allocatable :: group, key
      integer :: equals, dot, open, nth, code
      logical :: found
      equals = index(setting, "=")
      dot = index(setting(:equals), ".")
      group = lower(trim(adjustl(setting(:dot - 1))))
      key = lower(trim(adjustl(setting(dot + 1:equals - 1))))
      nth = 1
      open = index(group, "(")
      if (open > 0) then
         read (group(open + 1:len(group) - 1), *, iostat=code) nth
         if (code /= 0) nth = 1
         group = trim(group(:open - 1))
      end if
      call set_keys(lines, group, [key], [text_line(trim(adjustl(setting(equals + 1:))))], found, &
         nth)
      if (.not. found) call insert_line(lines, size(lines), "&" // group // " " // key // " = " // &
         trim(adjustl(setting(equals + 1:))) // " /")
   end subroutine set_as_told

   !> Set keys of the first group of a name, or of another. A value that is there is replaced where
   !> it stands; a key that is not there is added behind the group's name.
   subroutine set_keys(lines, group, keys, values, found, nth)
      type(text_line), allocatable, intent(inout) :: lines(:)
      character(*), intent(in) :: group          !! lower case
      character(*), intent(in) :: keys(:)        !! lower case
      type(text_line), intent(in) :: values(:)
      logical, intent(out) :: found              !! is there such a group?
      integer, intent(in), optional :: nth       !! of that name, from 1
      logical :: done(size(keys)), ended
      integer :: i, k, at, first, left
      found = .false.
      left = 1
      if (present(nth)) left = nth
      do first = 1, size(lines)
         at = group_at(lines(first)%text, group)
         if (at > 0) left = left - 1
         if (at == 0 .or. left > 0) cycle
         found = .true.
         exit
      end do
      if (.not. found) return
      done = .false.
      ended = .false.
      do i = first, size(lines)
         call edit_line(lines(i)%text, merge(at, 1, i == first), keys, values, done, ended)
         if (ended) exit
      end do
      do k = size(keys), 1, -1
         if (.not. done(k)) call add_key(lines, first, at, trim(keys(k)) // " = " // values(k)%text)
      end do
   end subroutine set_keys

   !> Column behind "&group" in a line, 0 if it does not begin one.
   pure integer function group_at(text, group) result(at)
      character(*), intent(in) :: text, group
      integer :: start
      at = 0
      start = verify(text, " " // achar(9))
      if (start == 0) return
      if (scan(text(start:start), "&$") == 0) return
      if (len(text) < start + len(group)) return
      if (lower(text(start + 1:start + len(group))) /= group) return
      at = start + len(group) + 1
      if (at > len(text)) return
      if (scan(text(at:at), " !/" // achar(9)) == 0) at = 0
   end function group_at

   !> Replace values in one line; `ended` at the group's slash.
   subroutine edit_line(text, from, keys, values, done, ended)
      character(:), allocatable, intent(inout) :: text
      integer, intent(in) :: from
      character(*), intent(in) :: keys(:)
      type(text_line), intent(in) :: values(:)
      logical, intent(inout) :: done(:), ended
      character(*), parameter :: letters = "abcdefghijklmnopqrstuvwxyz_0123456789"
      integer :: i, k, last, ending
      i = from
      do while (i <= len(text))
         select case (text(i:i))
         case ("!")
            return
         case ("/")
            ended = .true.
            return
         case ("'", achar(34))
            ending = index(text(i + 1:), text(i:i))
            if (ending == 0) return
            i = i + ending + 1
            cycle
         case default
            if (verify(lower(text(i:i)), letters) > 0) then
               i = i + 1
               cycle
            end if
         end select
         last = i + verify(lower(text(i:)) // " ", letters) - 2
         k = findloc(keys, lower(text(i:last)), 1)
         if (k > 0 .and. index(adjustl(text(last + 1:)), "=") == 1) then
            i = last + index(text(last + 1:), "=") + 1
            call replace_value(text, i, values(k)%text)
            done(k) = .true.
            i = i + len(values(k)%text)
         else
            i = last + 1
         end if
      end do
   end subroutine edit_line

   !> The value that begins at or behind column `at`; `at` becomes where the new one begins.
   subroutine replace_value(text, at, value)
      character(:), allocatable, intent(inout) :: text
      integer, intent(inout) :: at
      character(*), intent(in) :: value
      integer :: last
      do while (at < len(text) .and. scan(text(min(at, len(text)):min(at, len(text))), " " // &
         achar(9)) > 0)
         at = at + 1
      end do
      last = at - 1
      if (at <= len(text)) then
         if (scan(text(at:at), "'""") > 0) then
            last = at + index(text(at + 1:), text(at:at))
         else
            last = end_of_value(text, at)
         end if
      end if
      text = text(:at - 1) // value // text(last + 1:)
   end subroutine replace_value

   !> Column of the last character of a value without quotes that begins at column `at`: one number
   !> or several.
   pure integer function end_of_value(text, at) result(last)
      character(*), intent(in) :: text
      integer, intent(in) :: at
      integer :: next
      last = at + scan(text(at:) // " ", " ,/!" // achar(9)) - 2
      do
         next = last + verify(text(last + 1:) // "!", " ," // achar(9))
         if (next > len(text)) return
         if (scan(text(next:next), "0123456789+-.") == 0) return
         last = next + scan(text(next:) // " ", " ,/!" // achar(9)) - 2
      end do
   end function end_of_value

   !> "key = value" behind the group's name: on a line of its own where that line holds nothing
   !> else.
   subroutine add_key(lines, first, at, entry)
      type(text_line), allocatable, intent(inout) :: lines(:)
      integer, intent(in) :: first, at
      character(*), intent(in) :: entry
      character(:), allocatable :: rest
      rest = adjustl(lines(first)%text(min(at, len(lines(first)%text) + 1):))
      if (len(rest) == 0 .or. index(rest, "!") == 1) then
         call insert_line(lines, first, "   " // entry)
      else
         lines(first)%text = lines(first)%text(:at - 1) // " " // entry // ", " // rest
      end if
   end subroutine add_key

end module poinsot_study_fill_scene
