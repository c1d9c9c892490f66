!> From groups and keys to a typed scene, with every value checked.
module poinsot_scene_build
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_nearest, only: suggestion
   use poinsot_effect_registry, only: shown_key
   use poinsot_effect_settings, only: effect_info, setting
   use poinsot_scene_text, only: text_of, quoted, joined, next_word
   use poinsot_scene_source, only: scene_source, scene_group, find_group, find_groups, reject, &
      from_option
   use poinsot_scene_settings, only: scene_settings, body_total, is_auto
   use poinsot_scene_keys, only: scene_keys, bodies_keys, output_keys
   use poinsot_scene_names, only: effect_table, method_list, splitting_list, is_exact_method
   use poinsot_scene_typed_group, only: typed_group, type_group, given, number_of, numbers_of, &
      word_of, flag_of, &
      integer_of, plain, reject_key
   use poinsot_scene_bodies, only: build_bodies, add_rotors
   use poinsot_scene_columns, only: column_names, find_columns
   use poinsot_scene_effects, only: build_effects
   use poinsot_scene_schedule, only: step_total
   use poinsot_taylor_settings, only: least_tolerance, most_tolerance
   implicit none(type, external)
   private
   public :: build_scene

   integer(i8), parameter :: largest_count = 2000000000_i8 !! bodies of a scene
   real(dp), parameter :: most_steps = 1e15_dp, most_outputs = 1e9_dp

contains

   !> Make a typed scene of a scanned file. Error: POINSOT_E_SCENE, or POINSOT_E_DOMAIN for a body,
   !> with a message that names file, line, group and key, and what would be right.
   subroutine build_scene(source, scene, error)
      type(scene_source), intent(in) :: source   !! the scanned file
      type(scene_settings), intent(out) :: scene !! the typed scene
      type(poinsot_error), intent(inout) :: error
      type(effect_info), allocatable :: effects(:)
      scene%file = source%file
      scene%head = source%head
      scene%name = base_name(source%file)
      call effect_table(effects)
      call check_groups(source, effects, error)
      if (.not. raised(error)) call build_run(source, scene, error)
      if (.not. raised(error)) call build_all_bodies(source, scene, error)
      if (.not. raised(error)) call build_effects(source, scene, error)
      if (.not. raised(error)) call add_rotors(scene)
      if (.not. raised(error)) call build_output(source, scene, error)
      if (.not. raised(error)) call check_run(source, scene, error)
   end subroutine build_scene

   !> The file's name without its folder and its ending.
   pure function base_name(file) result(name)
      character(*), intent(in) :: file
      character(:), allocatable :: name
      integer :: dot
      name = file(index(file, "/", back=.true.) + 1:)
      dot = index(name, ".", back=.true.)
      if (dot > 1) name = name(:dot - 1)
   end function base_name

   !> Every group known, &scene and &output at most once, &scene and &bodies there.
   subroutine check_groups(source, effects, error)
      type(scene_source), intent(in) :: source
      type(effect_info), intent(in) :: effects(:)
      type(poinsot_error), intent(inout) :: error
      character(24), allocatable :: known(:)
      integer :: i, first
      allocate (known(3 + size(effects)))
      known(:3) = [character(24) :: "scene", "bodies", "output"]
      known(4:) = effects%name
      do i = 1, source%count
         if (.not. any(known == source%groups(i)%name)) then
            call reject(error, source%file, source%groups(i)%line, "unknown group " // &
                        quoted("&" // source%groups(i)%name) // &
                        suggestion(source%groups(i)%name, known, """&", """"))
            return
         end if
         if (.not. any(source%groups(i)%name == [character(6) :: "scene", "output"])) cycle
         first = find_group(source, source%groups(i)%name)
         if (first < i) then
            call reject(error, source%file, source%groups(i)%line, "a second &" // &
                        source%groups(i)%name // ", the first is in line " // &
                        text_of(source%groups(first)%line) // &
                           "; only &bodies and effects may be repeated")
            return
         end if
      end do
      if (find_group(source, "scene") == 0) then
         call reject(error, source%file, 0, &
            "has no &scene group; at least t_end must be given there")
      else if (find_group(source, "bodies") == 0) then
         call reject(error, source%file, 0, "has no &bodies group; at least one body is needed")
      end if
   end subroutine check_groups

   !> &scene
   subroutine build_run(source, scene, error)
      type(scene_source), intent(in) :: source
      type(scene_settings), intent(inout) :: scene
      type(poinsot_error), intent(inout) :: error
      type(typed_group) :: group
      type(effect_info) :: info
      integer(i8) :: threads
      call scene_keys(info)
      call type_group(source%file, source%groups(find_group(source, "scene")), info, group, error)
      if (raised(error)) return
      scene%t_end = number_of(group, "t_end")
      scene%h = number_of(group, "h")
      scene%tol = number_of(group, "tol")
      scene%tolerance = number_of(group, "tolerance")
      scene%method = word_of(group, "method")
      scene%splitting = word_of(group, "splitting")
      scene%from = word_of(group, "from")
      scene%reseed = flag_of(group, "reseed")
      scene%chosen = ""
      scene%chosen_fails = ""
      if (scene%reseed .and. len(scene%from) == 0) then
         call reject_key(group, "reseed", "is for a restart, but from is not given", error)
      else if (scene%t_end <= 0) then
         call reject_key(group, "t_end", "= " // text_of(scene%t_end) // " must be positive", error)
      else if (scene%h < 0 .or. (given(group, "h") .and. scene%h <= 0)) then
         call reject_key(group, "h", "= " // text_of(scene%h) // " must be positive", error)
      else if (scene%h > 0 .and. scene%t_end/max(scene%h, 1e-290_dp) > most_steps) then
         call reject_key(group, "h", "= " // text_of(scene%h) // " makes more than 1e15 steps " // &
                       "to t_end = " // text_of(scene%t_end) // "; give a longer step", error)
      else if (scene%tol < 1e-15_dp .or. scene%tol > 1) then
         call reject_key(group, "tol", "= " // text_of(scene%tol) // " is not from 1e-15 to 1", &
            error)
      else if (scene%tolerance < least_tolerance .or. scene%tolerance > most_tolerance) then
         call reject_key(group, "tolerance", "= " // text_of(scene%tolerance) // &
            " is not from 1e-15 to 1e-2", error)
      end if
      if (.not. raised(error)) then
         call integer_of(group, "seed", -9007199254740992_i8, &
            9007199254740992_i8, scene%seed, error)
      end if
      if (.not. raised(error)) call integer_of(group, "threads", 0_i8, 4096_i8, threads, error)
      if (raised(error)) return
      scene%threads = int(threads)
      call check_name(group, "method", scene%method, error)
      if (.not. raised(error)) call check_name(group, "splitting", scene%splitting, error)
   end subroutine build_run

   !> A method or splitting that exists.
   subroutine check_name(group, key, name, error)
      type(typed_group), intent(in) :: group
      character(*), intent(in) :: key, name
      type(poinsot_error), intent(inout) :: error
      character(24), allocatable :: known(:)
      if (key == "method") then
         call method_list(known)
      else
         call splitting_list(known)
      end if
      if (any(known == name)) return
      call reject_key(group, key, "= " // quoted(name) // ": unknown " // key // &
                    suggestion(name, known, """", """") // " (poinsot " // key // "s shows all)", &
                    error)
   end subroutine check_name

   !> All &bodies groups.
   subroutine build_all_bodies(source, scene, error)
      type(scene_source), intent(in) :: source
      type(scene_settings), intent(inout) :: scene
      type(poinsot_error), intent(inout) :: error
      type(typed_group) :: group
      type(effect_info) :: info
      integer, allocatable :: places(:)
      integer :: i
      integer(i8) :: total
      places = find_groups(source, "bodies")
      allocate (scene%bodies(size(places)))
      call bodies_keys(info)
      total = 0
      do i = 1, size(places)
         call type_group(source%file, source%groups(places(i)), info, group, error)
         if (.not. raised(error)) call build_bodies(group, scene%bodies(i), error)
         if (raised(error)) return
         total = total + scene%bodies(i)%count
         if (total <= largest_count) cycle
         call reject_key(group, merge("lattice", "count  ", given(group, "lattice")), &
                       "makes more than " // text_of(largest_count) // " bodies", error)
         return
      end do
   end subroutine build_all_bodies

   !> &output
   subroutine build_output(source, scene, error)
      type(scene_source), intent(in) :: source
      type(scene_settings), intent(inout) :: scene
      type(poinsot_error), intent(inout) :: error
      type(typed_group) :: group
      type(effect_info) :: info
      character(:), allocatable :: word
      integer :: k
      allocate (scene%output%bodies(0), scene%output%times(0), scene%output%columns(0))
      scene%output%restart = "restart.txt"
      scene%output%pictures = "none"
      scene%output%page = ""
      k = find_group(source, "output")
      if (k == 0) return
      call output_keys(info)
      call type_group(source%file, source%groups(k), info, group, error)
      if (raised(error)) return
      scene%output%present = .true.
      word = word_of(group, "format")
      scene%output%csv = index(word, "csv") > 0
      scene%output%extxyz = index(word, "extxyz") > 0
      scene%output%npy = index(word, "npy") > 0
      scene%output%observables = flag_of(group, "observables")
      call find_columns(word_of(group, "columns"), scene%output%columns, word)
      if (word /= "") then
         call reject_key(group, "columns", "= " // quoted(word_of(group, "columns")) // ": " // &
            quoted(word) // " is not one of: " // joined(column_names), error)
         return
      end if
      scene%output%pictures = word_of(group, "pictures")
      scene%output%restart = word_of(group, "restart")
      if (index(scene%output%restart, "/") > 0) then
         call reject_key(group, "restart", "= " // quoted(scene%output%restart) // &
                       " must be a file name without /, in the output folder", error)
         return
      end if
      call build_times(group, scene, error)
      if (.not. raised(error)) call build_choice(group, scene, error)
      if (.not. raised(error)) call build_pictures(group, scene, error)
   end subroutine build_output

   !> Which pictures, and of what.
   subroutine build_pictures(group, scene, error)
      type(typed_group), intent(in) :: group
      type(scene_settings), intent(inout) :: scene
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: axis(:), centre(:)
      character(:), allocatable :: key
      integer :: i
      call check_pictures(group, scene%output%pictures, error)
      if (raised(error)) return
      call numbers_of(group, "axis", axis)
      scene%output%rate = number_of(group, "rate")
      allocate (centre(0))
      do i = 1, size(scene%effects)
         key = shown_key(scene%effects(i)%name, "centre")
         if (key == "") cycle
         call get_setting(scene%effects(i)%settings, key, centre)
         if (scene%output%pictures == "auto") scene%output%pictures = "top"
      end do
      if (scene%output%pictures == "auto") scene%output%pictures = "body"
      if (scene%output%pictures == "body" .and. written(scene) > 20) then
         scene%output%pictures = "ensemble"
      end if
      if (size(axis) == 0) axis = centre
      if (size(axis) == 0) axis = scene%output%axis
      if (maxval(abs(axis)) <= 0) then
         call reject_key(group, "axis", "is zero; a direction is needed", error)
         return
      end if
      axis = axis/maxval(abs(axis))
      scene%output%axis = axis/norm2(axis)
   end subroutine build_pictures

   !> Check kinds of pictures. `auto` and `none` must be alone.
   subroutine check_pictures(group, kinds, error)
      type(typed_group), intent(in) :: group
      character(*), intent(in) :: kinds
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: known(5) = [character(8) :: "body", "top", "tilt", "angle", &
                                             "ensemble"]
      character(:), allocatable :: rest, kind
      if (kinds == "auto" .or. kinds == "none") return
      rest = kinds
      call next_word(rest, kind)
      if (kind == "") call reject_key(group, "pictures", &
         "= '' is not a picture; use 'none' for no pictures", error)
      do while (kind /= "" .and. .not. raised(error))
         if (.not. any(known == kind)) call reject_key(group, "pictures", "= " // quoted(kinds) // &
            ": " // quoted(kind) // " is not one of: auto or none, alone, or " // &
            joined(known), error)
         call next_word(rest, kind)
      end do
   end subroutine check_pictures

   !> How many bodies are written.
   pure integer(i8) function written(scene)
      type(scene_settings), intent(in) :: scene
      written = size(scene%output%bodies)
      if (written == 0) written = body_total(scene)
   end function written

   !> The numbers of a key in a list of settings; untouched if it is not there.
   pure subroutine get_setting(settings, key, values)
      type(setting), intent(in) :: settings(:)
      character(*), intent(in) :: key
      real(dp), allocatable, intent(inout) :: values(:)
      integer :: i
      do i = 1, size(settings)
         if (settings(i)%key == key .and. allocated(settings(i)%values)) values = settings(i)%values
      end do
   end subroutine get_setting

   !> every, or times.
   subroutine build_times(group, scene, error)
      type(typed_group), intent(in) :: group
      type(scene_settings), intent(inout) :: scene
      type(poinsot_error), intent(inout) :: error
      integer :: n
      if (given(group, "every") .eqv. given(group, "times")) then
         call reject_key(group, "every", "or times must be given, one of the two", error)
      else if (given(group, "every")) then
         scene%output%every = number_of(group, "every")
         if (scene%output%every <= 0) then
            call reject_key(group, "every", "= " // text_of(scene%output%every) // &
                          " must be positive", error)
         else if (scene%t_end/max(scene%output%every, 1e-290_dp) > most_outputs) then
            call reject_key(group, "every", "= " // text_of(scene%output%every) // &
                          " makes more than 1e9 outputs", error)
         end if
      else
         call numbers_of(group, "times", scene%output%times)
         n = size(scene%output%times)
         if (scene%output%times(1) < 0 .or. scene%output%times(n) > scene%t_end) then
            call reject_key(group, "times", "leave the run from 0 to t_end = " // &
                          text_of(scene%t_end), error)
         else if (any(scene%output%times(2:) <= scene%output%times(:n - 1))) then
            call reject_key(group, "times", "must ascend", error)
         end if
      end if
   end subroutine build_times

   !> Which bodies are written.
   subroutine build_choice(group, scene, error)
      type(typed_group), intent(in) :: group
      type(scene_settings), intent(inout) :: scene
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: numbers(:)
      integer(i8) :: sample, total
      integer :: i
      total = body_total(scene)
      call integer_of(group, "sample", 0_i8, total, sample, error)
      if (raised(error)) return
      if (sample > 0) then
         if (given(group, "bodies")) then
            call reject_key(group, "sample", "and bodies are both given; leave one out", error)
         end if
         scene%output%bodies = [(1 + (i - 1)*total/sample, i=1, int(sample))]
         return
      end if
      call numbers_of(group, "bodies", numbers)
      do i = 1, size(numbers)
         if (numbers(i) >= 1 .and. numbers(i) <= real(total, dp)) then
            if (abs(numbers(i) - aint(numbers(i))) <= 0) cycle
         end if
         call reject_key(group, "bodies", "names body " // plain(numbers(i)) // &
                       "; the scene has bodies 1 to " // text_of(total), error)
         return
      end do
      scene%output%bodies = nint(numbers, i8)
      if (all(scene%output%bodies(2:) > scene%output%bodies(:max(size(numbers) - 1, 0)))) return
      call reject_key(group, "bodies", "must ascend, each number once", error)
   end subroutine build_choice

   !> The line of a group, or --set, if that gave one of these keys.
   pure integer function line_of(group, keys) result(line)
      type(scene_group), intent(in) :: group
      character(*), intent(in) :: keys(:)
      integer :: i
      line = group%line
      do i = 1, group%count
         if (any(keys == group%entries(i)%key)) line = merge(from_option, line, &
            group%entries(i)%line == from_option)
      end do
   end function line_of

   !> What only the whole scene shows.
   subroutine check_run(source, scene, error)
      type(scene_source), intent(in) :: source
      type(scene_settings), intent(in) :: scene
      type(poinsot_error), intent(inout) :: error
      integer :: line
      line = line_of(source%groups(find_group(source, "scene")), &
         [character(6) :: "h", "t_end", "method"])
      if (step_total(scene) > most_steps) then
         call reject(error, scene%file, line, "&scene: more than 1e15 steps; give a longer h")
      else if (is_auto(scene) .or. scene%splitting == "taylor") then
         return ! the step will be chosen too; one that is given is the longest allowed
      else if (scene%h <= 0 .and. size(scene%effects) > 0) then
         call reject(error, scene%file, line, "&scene: the key ""h"" is required, because of &" // &
                     scene%effects(1)%name // "; only free bodies do without")
      else if (scene%h <= 0 .and. .not. is_exact_method(scene%method)) then
         call reject(error, scene%file, line, "&scene: the key ""h"" is required for method " // &
                     "= '" // scene%method // "'; only 'exact' and 'jacobi' do without")
      end if
   end subroutine check_run

end module poinsot_scene_build
