!> Settings from the command line, "group.key=value", inserted into a scanned scene as if they were
!> in the file.
module poinsot_scene_override
   use poinsot_core_kinds, only: i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_text, only: lower, quoted, text_of
   use poinsot_core_number, only: parse_integer, number_ok
   use poinsot_scene_cursor, only: cursor, open_cursor, scan_name, scan_subscript
   use poinsot_scene_values, only: scan_values
   use poinsot_scene_source, only: scene_source, scene_group, scene_entry, append, find_group, &
      reject, from_option
   implicit none(type, external)
   private
   public :: override

   character(*), parameter :: place = "--set" !! stands for the file in messages

contains

   !> Put one setting in, over the file's own value of that key; a group that is not there is added.
   !> `bodies.y(2)=1` is over the second number of the key alone.
   !> `bodies(2).key=value` names the second &bodies group; so with any group that is repeated.
   !> Error: POINSOT_E_SCENE for what is not
   !> of that form; whether group and key exist is found out when the scene is built.
   subroutine override(text, source, error)
      character(*), intent(in) :: text               !! group.key=value
      type(scene_source), intent(inout) :: source    !! the scanned file
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: group
      type(scene_entry) :: entry
      integer :: equals, dot, nth
      equals = index(text, "=")
      dot = index(text(:max(equals - 1, 0)), ".")
      if (dot < 2 .or. equals < dot + 2 .or. equals == len(text)) then
         call reject(error, place, 0, quoted(text) // " is not of the form group.key=value, " // &
                     "as in scene.h=0.1")
         return
      end if
      group = lower(trim(adjustl(text(:dot - 1))))
      entry%line = from_option
      call take_key(text(dot + 1:equals - 1), group, entry, error)
      if (.not. raised(error)) call take_number(group, nth, error)
      if (.not. raised(error)) call scan_values(text(equals + 1:), place, group, entry, error)
      if (raised(error)) return
      if (nth == 0 .and. find_group(source, group, 2) > 0) then
         call reject(error, place, 0, quoted(text) // ": the scene has several &" // group // &
                     " groups; select one, as in " // group // "(2)." // entry%key)
         return
      end if
      call put_entry(source, group, max(nth, 1), entry, error)
   end subroutine override

   !> "moments", "moments(2)", "moments(1:2)": the key, and which of its numbers. What is no name is
   !> left as it is: an unknown key.
   subroutine take_key(text, group, entry, error)
      character(*), intent(in) :: text, group
      type(scene_entry), intent(inout) :: entry
      type(poinsot_error), intent(inout) :: error
      type(cursor) :: here
      call open_cursor(trim(adjustl(text)), place, here, error)
      if (raised(error)) return
      here%line = 0
      call scan_name(here, entry%key)
      call scan_subscript(here, group, entry, error)
      if (here%at <= len(here%text)) entry%key = lower(here%text)
   end subroutine take_key

   !> "bodies(2)" into "bodies" and 2; 0 if there is no number.
   subroutine take_number(group, nth, error)
      character(:), allocatable, intent(inout) :: group
      integer, intent(out) :: nth
      type(poinsot_error), intent(inout) :: error
      integer(i8) :: number
      integer :: open, outcome
      nth = 0
      open = index(group, "(")
      if (open == 0) return
      outcome = number_ok + 1
      if (group(len(group):) == ")") then
         call parse_integer(group(open + 1:len(group) - 1), number, outcome)
      end if
      if (outcome == number_ok) then
         if (number < 1 .or. number > 1000000) outcome = number_ok + 1
      end if
      if (outcome /= number_ok) then
         call reject(error, place, 0, quoted(group) // " does not name a group, as bodies(2) does")
         return
      end if
      nth = int(number)
      group = group(:open - 1)
   end subroutine take_number

   !> The entry into the nth group of that name.
   subroutine put_entry(source, name, nth, entry, error)
      type(scene_source), intent(inout) :: source
      character(*), intent(in) :: name
      integer, intent(in) :: nth
      type(scene_entry), intent(in) :: entry
      type(poinsot_error), intent(inout) :: error
      type(scene_group) :: group
      integer :: k, i, kept
      k = find_group(source, name, nth)
      if (k == 0 .and. nth > 1) then
         call reject(error, place, 0, "there is no &" // name // " group number " // text_of(nth))
         return
      end if
      if (k == 0) then
         group%name = name
         group%line = from_option
         call append(source, group)
         k = source%count
      end if
      kept = 0
      do i = 1, source%groups(k)%count
         if (source%groups(k)%entries(i)%key == entry%key .and. .not. entry%subscripted) cycle
         kept = kept + 1
         if (kept < i) source%groups(k)%entries(kept) = source%groups(k)%entries(i)
      end do
      source%groups(k)%count = kept
      call append(source%groups(k), entry)
   end subroutine put_entry

end module poinsot_scene_override
