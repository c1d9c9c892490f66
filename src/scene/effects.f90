!> The effect groups of a scene: keys are checked here with file and line, values by the effect
!> itself.
module poinsot_scene_effects
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_effect_registry, only: make_effect
   use poinsot_effect_settings, only: effect_info, effect_key, setting, was_given, number_setting
   use poinsot_scene_source, only: scene_source, find_groups, reject, from_option
   use poinsot_scene_text, only: text_of
   use poinsot_scene_names, only: effect_table
   use poinsot_scene_settings, only: scene_settings, effect_setting, body_total
   use poinsot_scene_typed_group, only: typed_group, type_group, given, word_of, number_of, &
      plain, reject_key
   use poinsot_scene_table, only: read_table, file_beside
   implicit none(type, external)
   private
   public :: build_effects, body_positions

contains

   !> All effect groups of the file, in the order of the registry, those of one name in the order of
   !> the file. Error: POINSOT_E_SCENE naming file, line, group and key.
   subroutine build_effects(source, scene, error)
      type(scene_source), intent(in) :: source     !! the scanned file
      type(scene_settings), intent(inout) :: scene !! its bodies are known; gets the effects
      type(poinsot_error), intent(inout) :: error
      type(effect_info), allocatable :: table(:)
      type(effect_setting), allocatable :: found(:)
      integer, allocatable :: places(:)
      integer :: i, k, n
      call effect_table(table)
      allocate (found(source%count))
      n = 0
      do i = 1, size(table)
         places = find_groups(source, trim(table(i)%name))
         do k = 1, size(places)
            n = n + 1
            call build_one(source, places(k), table(i), scene, found(n), error)
            if (raised(error)) return
         end do
      end do
      allocate (scene%effects(n))
      scene%effects = found(:n)
   end subroutine build_effects

   !> One group, and the effect made from it, which checks its values.
   subroutine build_one(source, k, info, scene, item, error)
      type(scene_source), intent(in) :: source
      integer, intent(in) :: k
      type(effect_info), intent(in) :: info
      type(scene_settings), intent(in) :: scene
      type(effect_setting), intent(out) :: item
      type(poinsot_error), intent(inout) :: error
      type(typed_group) :: group
      type(poinsot_error) :: refused
      integer :: i
      call type_group(source%file, source%groups(k), info, group, error)
      if (raised(error)) return
      item%name = group%name
      item%line = group%line
      item%settings = group%settings
      if (number_of(group, "class") > size(scene%bodies)) then
         call reject_key(group, "class", "= " // plain(number_of(group, "class")) // &
                       " is not the number of a &bodies group; there are " // &
                       text_of(size(scene%bodies)), error)
         return
      end if
      do i = 1, size(info%keys)
         if (info%keys(i)%is_table) call take_file(source%file, group, item, error)
         if (info%keys(i)%positions_unless /= "") call take_positions(scene, info%keys(i), item)
         if (raised(error)) return
      end do
      call make_effect(item%name, item%settings, item%made, refused)
      if (raised(refused)) then
         call reject(error, source%file, blamed_line(group, refused%message), "&" // &
            group%name // ": " // without(refused%message, "effect '" // group%name // "': "))
      end if
   end subroutine build_one

   !> The line of the key that a message names, --set first; else that of the group.
   pure integer function blamed_line(group, message) result(line)
      type(typed_group), intent(in) :: group
      character(*), intent(in) :: message
      integer :: i
      line = group%line
      do i = 1, size(group%settings)
         if (index(message, "'" // group%settings(i)%key // "'") == 0) cycle
         if (line /= from_option) line = group%lines(i)
      end do
   end function blamed_line

   !> A message without its beginning, if that repeats what precedes it.
   pure function without(message, beginning) result(rest)
      character(*), intent(in) :: message, beginning
      character(:), allocatable :: rest
      rest = message
      if (index(message, beginning) == 1) rest = message(len(beginning) + 1:)
   end function without

   !> file = '...' of a group: its numbers in place of times and table.
   subroutine take_file(scene_file, group, item, error)
      character(*), intent(in) :: scene_file
      type(typed_group), intent(in) :: group
      type(effect_setting), intent(inout) :: item
      type(poinsot_error), intent(inout) :: error
      type(poinsot_error) :: refused
      real(dp), allocatable :: times(:), rows(:)
      character(:), allocatable :: name
      integer :: i, n
      if (.not. given(group, "file")) return
      if (given(group, "times") .or. given(group, "table")) then
         call reject_key(group, "file", "and times or table are both given; leave one out", error)
         return
      end if
      name = word_of(group, "file")
      if (len(name) == 0) then
         call reject_key(group, "file", &
                       "is empty; name a file with lines of t and three numbers", error)
         return
      end if
      name = file_beside(scene_file, name)
      call read_table(name, 3, times, rows, refused)
      if (raised(refused)) then
         call reject_key(group, "file", "refused: " // refused%message, error)
         return
      end if
      item%file = name
      n = 0
      do i = 1, size(item%settings)
         if (item%settings(i)%key == "file") cycle
         n = n + 1
         item%settings(n) = item%settings(i)
      end do
      call extend(item, n, number_setting("times", times))
      call extend(item, size(item%settings), number_setting("table", rows))
   end subroutine take_file

   !> The first n settings and one more.
   subroutine extend(item, n, more)
      type(effect_setting), intent(inout) :: item
      integer, intent(in) :: n
      type(setting), intent(in) :: more
      type(setting), allocatable :: longer(:)
      allocate (longer(n + 1))
      longer(:n) = item%settings(:n)
      longer(n + 1) = more
      call move_alloc(longer, item%settings)
   end subroutine extend

   !> Bodies are where the &bodies groups put them, if they put them anywhere.
   subroutine take_positions(scene, key, item)
      type(scene_settings), intent(in) :: scene
      type(effect_key), intent(in) :: key            !! which takes the positions
      type(effect_setting), intent(inout) :: item
      real(dp), allocatable :: position(:, :)
      if (was_given(item%settings, trim(key%name)) .or. &
          was_given(item%settings, trim(key%positions_unless))) return
      if (body_total(scene) > 100000) return ! more than pairs are meant for: its own message
      call body_positions(scene, position)
      if (all(abs(position) <= 0)) return
      call extend(item, size(item%settings), &
                  number_setting(trim(key%name), reshape(position, [size(position)])))
   end subroutine take_positions

   !> Positions of all bodies, as their groups say.
   subroutine body_positions(scene, position)
      type(scene_settings), intent(in) :: scene            !! the typed scene
      real(dp), allocatable, intent(out) :: position(:, :) !! (3, bodies)
      integer(i8) :: j, n, at(3)
      integer :: i
      allocate (position(3, body_total(scene)))
      n = 0
      do i = 1, size(scene%bodies)
         do j = 1, scene%bodies(i)%count
            n = n + 1
            at = j - 1
            associate (side => scene%bodies(i)%lattice)
               if (all(side > 0)) at = [mod(j - 1, int(side(1), i8)), &
                  mod((j - 1)/side(1), int(side(2), i8)), (j - 1)/side(1)/side(2)]
            end associate
            position(:, n) = scene%bodies(i)%position + real(at, dp)*scene%bodies(i)%spacing
         end do
      end do
   end subroutine body_positions

end module poinsot_scene_effects
