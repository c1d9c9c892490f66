!> poinsot methods, splittings, effects, keys, scenes: lists and explanations.
module app_lists
   use poinsot_core_kinds, only: name_length
   use poinsot_core_error, only: poinsot_error
   use poinsot_core_nearest, only: suggestion
   use poinsot_effect_settings, only: effect_info, effect_key
   use poinsot_effect_registry, only: effect_count
   use poinsot_free_method, only: free_method, find_method, method_count, method_name
   use poinsot_splitting_registry, only: splitting_count, splitting_name, find_splitting
   use poinsot_splitting_tableaux, only: splitting
   use poinsot_scene_text, only: text_of
   use app_arguments, only: word_list, is_option
   use app_codes, only: exit_ok, exit_usage
   use app_find_scene, only: find_scene, missing_scene, shipped_scenes
   use app_keys, only: group_count, get_group, put_table
   use app_run, only: unknown_option
   use app_terminal, only: say, print_error
   implicit none(type, external)
   private
   public :: command_methods, command_splittings, command_effects, command_keys, &
      command_scenes

contains

   !> At most `most` names and no options; prints the error message.
   logical function fine(command, words, most)
      character(*), intent(in) :: command
      type(word_list), intent(in) :: words
      integer, intent(in) :: most
      character(1) :: none(0)
      integer :: i
      fine = .false.
      do i = 1, size(words%at)
         if (is_option(words%at(i)%text)) then
            call unknown_option(command, words%at(i)%text, none)
            return
         end if
      end do
      fine = size(words%at) <= most
      if (.not. fine) then
         call print_error(command // ": unexpected argument '" // words%at(most + 1)%text // "'")
      end if
   end function fine

   !> poinsot methods
   subroutine command_methods(words, code)
      type(word_list), intent(in) :: words !! what follows the command
      integer, intent(out) :: code         !! exit code
      type(free_method) :: method
      type(poinsot_error) :: error
      character(20) :: name
      character(8) :: order
      integer :: i
      code = exit_usage
      if (.not. fine("methods", words, 0)) return
      code = exit_ok
      call say("method              order   what it is")
      do i = 1, method_count()
         name = method_name(i)
         call find_method(trim(name), method, error)
         order = "exact"
         if (method%order > 0) order = text_of(method%order)
         call say(name // order // trim(method%about))
      end do
   end subroutine command_methods

   !> poinsot splittings
   subroutine command_splittings(words, code)
      type(word_list), intent(in) :: words !! what follows the command
      integer, intent(out) :: code         !! exit code
      type(splitting) :: scheme
      type(poinsot_error) :: error
      character(17) :: name
      character(7) :: order, stages
      character(11) :: gradients
      integer :: i
      code = exit_usage
      if (.not. fine("splittings", words, 0)) return
      code = exit_ok
      call say("splitting        order  drifts gradients  what it is for; source")
      do i = 1, splitting_count()
         name = splitting_name(i)
         call find_splitting(trim(name), scheme, error)
         order = text_of(scheme%order)
         stages = text_of(scheme%stages)
         gradients = merge("yes", "no ", scheme%needs_gradient)
         if (scheme%adaptive) then
            order = "-"
            stages = "-"
            gradients = "-"
         end if
         call say(name // order // stages // gradients // trim(scheme%purpose) // "; " // &
                  trim(scheme%author) // ", " // text_of(scheme%year))
      end do
      name = "auto"
      call say(name // "-      -      -          the cheapest that meets &scene tol")
   end subroutine command_splittings

   !> poinsot effects [NAME]
   subroutine command_effects(words, code)
      type(word_list), intent(in) :: words !! what follows the command
      integer, intent(out) :: code         !! exit code
      type(effect_info) :: info
      integer :: i
      code = exit_usage
      if (.not. fine("effects", words, 1)) return
      if (size(words%at) == 1) then
         call find_group("effects: unknown effect", words%at(1)%text, info, i)
         if (i == 0) return
         call explain(info)
      else
         do i = 1, effect_count
            call get_group(i, info)
            call say(info%name(:18) // trim(info%formula))
         end do
         call say("")
         call say("poinsot effects NAME explains one; scene, bodies and output are explained too")
      end if
      code = exit_ok
   end subroutine command_effects

   !> poinsot keys [GROUP]
   subroutine command_keys(words, code)
      type(word_list), intent(in) :: words !! what follows the command
      integer, intent(out) :: code         !! exit code
      type(effect_info) :: info
      integer :: i, k
      code = exit_usage
      if (.not. fine("keys", words, 1)) return
      if (size(words%at) == 1) then
         call find_group("keys: unknown group", words%at(1)%text, info, i)
         if (i == 0) return
         call put_table(info)
      else
         do k = 1, group_count
            i = 1 + mod(k - 1 + effect_count, group_count) ! &scene, &bodies, &output first
            call get_group(i, info)
            if (size(info%keys) > 0) call put_table(info)
         end do
      end if
      code = exit_ok
   end subroutine command_keys

   !> A group by name; prints the error message.
   subroutine find_group(what, name, info, i)
      character(*), intent(in) :: what            !! an unknown name
      character(*), intent(in) :: name
      type(effect_info), intent(out) :: info
      integer, intent(out) :: i                   !! its number; 0: there is none
      character(name_length) :: names(group_count)
      do i = 1, group_count
         call get_group(i, info)
         if (info%name == name) return
         names(i) = info%name
      end do
      i = 0
      call print_error(what // " '" // name // "'" // suggestion(name, names))
   end subroutine find_group

   !> One group: formula, keys, check.
   subroutine explain(info)
      type(effect_info), intent(in) :: info
      integer :: k
      call say("&" // trim(info%name))
      call say("   " // trim(info%formula))
      call say("")
      do k = 1, size(info%keys)
         call say("   " // key_head(info%keys(k)) // trim(info%keys(k)%meaning))
         if (info%keys(k)%units == "") cycle
         if (info%keys(k)%is_text) then
            call say(repeat(" ", 34) // "one of: " // trim(info%keys(k)%units))
         else
            call say(repeat(" ", 34) // "(" // trim(info%keys(k)%units) // ")")
         end if
      end do
      if (info%order > 0) then
         call say("")
         call say("   limits the order to " // text_of(info%order) // ", whatever the splitting")
      end if
      if (info%check == "") return
      call say("")
      call say("   checked: " // trim(info%check))
   end subroutine explain

   !> "centre(3)  required"
   function key_head(key) result(text)
      type(effect_key), intent(in) :: key
      character(31) :: text
      character(:), allocatable :: name
      character(15) :: left
      character(16) :: value
      name = trim(key%name)
      if (key%most < 0) name = name // "(:)"
      if (key%most > 1) name = name // "(" // text_of(key%most) // ")"
      left = name
      value = "-"
      if (key%default /= "") value = key%default(1:len(value))
      if (len_trim(key%default) >= len(value)) value = key%default(:len(value) - 4) // "..."
      if (key%is_text .and. key%default /= "" .and. key%default /= "required") then
         value = "'" // trim(value(1:len(value) - 2)) // "'"
      end if
      text = left // value
   end function key_head

   !> poinsot scenes [NAME]
   subroutine command_scenes(words, code)
      type(word_list), intent(in) :: words !! what follows the command
      integer, intent(out) :: code         !! exit code
      integer :: i
      code = exit_usage
      if (.not. fine("scenes", words, 1)) return
      if (size(words%at) == 1) then
         call show_scene(words%at(1)%text, .false., code)
         return
      end if
      do i = 1, size(shipped_scenes)
         call show_scene(trim(shipped_scenes(i)), .true., code)
      end do
      call say("")
      call say("poinsot run NAME runs one, poinsot scenes NAME prints it")
      code = exit_ok
   end subroutine command_scenes

   !> A scene: its first comment beside its name, or all of it.
   subroutine show_scene(name, brief, code)
      character(*), intent(in) :: name
      logical, intent(in) :: brief
      integer, intent(out) :: code
      character(:), allocatable :: file
      character(400) :: line
      character(17) :: left
      logical :: found
      integer :: unit
      code = exit_usage
      call find_scene(name, file, found)
      if (.not. found) then
         call print_error("scenes: " // missing_scene(name))
         return
      end if
      open (newunit=unit, file=file, action="read", status="old", iostat=code)
      if (code /= 0) then
         call print_error("scenes: " // file // " cannot be read")
         code = exit_usage
         return
      end if
      left = name
      do
         read (unit, "(a)", iostat=code) line
         if (code /= 0) exit
         if (brief) then
            call say(left // trim(adjustl(line(verify(line, "! "):))))
            exit
         end if
         call say(trim(line))
      end do
      close (unit)
      code = exit_ok
   end subroutine show_scene

end module app_lists
