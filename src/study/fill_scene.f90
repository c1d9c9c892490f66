!> A scene file with a choice filled in: the text of the file unchanged, including comments, except
!> for method, splitting and step size of &scene.
module poinsot_study_fill_scene
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io, poinsot_e_scene
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_text, only: lower
   use poinsot_study_group_text, only: set_entry, append_entry
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

   !> "group.key=value", "group(2).key=value" or "group.key(2)=value", as --set has it, which was
   !> found right before; a group that is not there is added.
   subroutine set_as_told(lines, setting)
      type(text_line), allocatable, intent(inout) :: lines(:)
      character(*), intent(in) :: setting
      character(:), allocatable :: group, key, value
      integer :: equals, dot, open, nth, code
      logical :: found
      equals = index(setting, "=")
      dot = index(setting(:equals), ".")
      group = lower(trim(adjustl(setting(:dot - 1))))
      key = lower(trim(adjustl(setting(dot + 1:equals - 1))))
      value = trim(adjustl(setting(equals + 1:)))
      nth = 1
      open = index(group, "(")
      if (open > 0) then
         read (group(open + 1:len(group) - 1), *, iostat=code) nth
         if (code /= 0) nth = 1
         group = trim(group(:open - 1))
      end if
      call set_keys(lines, group, [key], [text_line(value)], found, nth)
      if (.not. found) call insert_line(lines, size(lines), "&" // group // " " // key // " = " // &
         value // " /")
   end subroutine set_as_told

   !> Set keys of the first group of a name, or of another. A value that is there is replaced where
   !> it stands; a key that is not there is added behind the group's name; some numbers of a key,
   !> "moments(2)", at the group's end.
   subroutine set_keys(lines, group, keys, values, found, nth)
      type(text_line), allocatable, intent(inout) :: lines(:)
      character(*), intent(in) :: group          !! lower case
      character(*), intent(in) :: keys(:)        !! lower case
      type(text_line), intent(in) :: values(:)
      logical, intent(out) :: found              !! is there such a group?
      integer, intent(in), optional :: nth       !! of that name, from 1
      character(:), allocatable :: text
      integer :: k, at, first, left
      logical :: there(size(keys))
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
      text = joined(lines(first:), at)
      do k = 1, size(keys)
         there(k) = index(keys(k), "(") > 0
         if (there(k)) then
            call append_entry(text, trim(keys(k)) // " = " // values(k)%text)
         else
            call set_entry(text, trim(keys(k)), values(k)%text, there(k))
         end if
      end do
      call take_lines(lines, first, at, text)
      do k = size(keys), 1, -1
         if (.not. there(k)) call add_key(lines, first, at, trim(keys(k)) // " = " // &
            values(k)%text)
      end do
   end subroutine set_keys

   !> Lines as one text, from a column of the first on.
   pure function joined(lines, at) result(text)
      type(text_line), intent(in) :: lines(:)
      integer, intent(in) :: at
      character(:), allocatable :: text
      integer :: i
      text = lines(1)%text(at:)
      do i = 2, size(lines)
         text = text // new_line(text) // lines(i)%text
      end do
   end function joined

   !> The reverse: all lines from `first` on, the first of them from column `at` on.
   pure subroutine take_lines(lines, first, at, text)
      type(text_line), allocatable, intent(inout) :: lines(:)
      integer, intent(in) :: first, at
      character(*), intent(in) :: text
      type(text_line), allocatable :: more(:)
      integer :: i, n, from, ending
      n = count([(text(i:i) == new_line(text), i=1, len(text))])
      allocate (more(first + n))
      more(:first) = lines(:first)
      more(first)%text = lines(first)%text(:at - 1)
      from = 1
      do i = first, first + n
         ending = index(text(from:) // new_line(text), new_line(text))
         if (i > first) more(i)%text = ""
         more(i)%text = more(i)%text // text(from:from + ending - 2)
         from = from + ending
      end do
      call move_alloc(more, lines)
   end subroutine take_lines

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
