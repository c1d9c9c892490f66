!> poinsot run
module app_run
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_nearest, only: suggestion
   use poinsot_scene_text, only: text_of, joined
   use poinsot_scene_source, only: scene_source
   use poinsot_scene_reader, only: read_source
   use poinsot_scene_override, only: override
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_settings, only: scene_settings, body_total, is_auto
   use poinsot_scene_schedule, only: step_total, output_count
   use poinsot_scene_communicator, only: communicator
   use poinsot_scene_folder, only: folder_lock, lock_folder
   use poinsot_scene_run, only: run_scene, check_scene
   use poinsot_scene_pictures, only: picture_names
   use poinsot_scene_summary, only: run_report, brief_number, class_words
   use poinsot_study_auto, only: resolve_auto
   use app_arguments, only: word, word_list, option_value, is_option, append_word
   use app_codes, only: exit_ok, exit_tolerance, exit_runtime, exit_usage, exit_of_run
   use app_draw, only: draw_pictures, show_file
   use app_view, only: find_template, remake_page
   use poinsot_scene_view, only: page_name
   use app_find_scene, only: find_scene, missing_scene, shipped_scenes
   use app_progress, only: progress_watch
   use app_terminal, only: say, print_error, error_is_terminal, catch_interrupts
   implicit none(type, external)
   private
   public :: command_run, command_view, load_scene, run_options, unknown_option

   !> What `poinsot run` was asked for.
   type :: run_options
      character(:), allocatable :: scene, out, threads
      type(word), allocatable :: settings(:)   !! of --set, in their order
      logical :: check = .false., quiet = .false., pictures = .true., view = .true.
   end type run_options

   character(13), parameter :: known(7) = [character(13) :: "--out", "--threads", "--set", &
                                           "--check", "--no-pictures", "--no-view", "--quiet"]

contains

   !> The command.
   subroutine command_run(words, code, ranks)
      type(word_list), intent(in) :: words !! what follows the command
      integer, intent(out) :: code         !! exit code
      class(communicator), intent(inout), optional :: ranks
      type(run_options) :: options
      type(scene_settings) :: scene
      logical :: good
      code = exit_usage
      call read_options(words, options, good)
      if (.not. good) return
      call load_scene(options%scene, options%settings, scene, good)
      if (.not. good) return
      if (options%check) then
         call check_only(scene, options, code)
      else
         call run_it(scene, options, code, ranks)
      end if
   end subroutine command_run

   !> `poinsot view`: remake the page of a folder, or run a scene only for its page.
   subroutine command_view(words, code)
      type(word_list), intent(in) :: words
      integer, intent(out) :: code
      type(run_options) :: options
      type(scene_settings) :: scene
      logical :: done
      call remake_page(words, code, done)
      if (done) return
      call read_options(words, options, done)
      if (done) call load_scene(options%scene, options%settings, scene, done)
      if (.not. done) return
      options%pictures = .false.
      options%quiet = .true.
      if (len(options%out) == 0) options%out = "poinsot-out/" // scene%name
      call run_it(scene, options, code)
      if (code == exit_ok .or. code == exit_tolerance) call say(options%out // "/" // page_name)
   end subroutine command_view

   !> Words to typed options.
   subroutine read_options(words, options, good)
      type(word_list), intent(in) :: words
      type(run_options), intent(out) :: options
      logical, intent(out) :: good
      character(:), allocatable :: name, value
      integer :: i
      options%scene = ""
      options%out = ""
      options%threads = ""
      allocate (options%settings(0))
      good = .true.
      i = 0
      do while (i < size(words%at) .and. good)
         i = i + 1
         name = words%at(i)%text
         if (.not. is_option(name)) then
            good = len(options%scene) == 0
            if (.not. good) then
               call print_error("run: one scene at a time; unexpected '" // name // "'")
            end if
            options%scene = name
            cycle
         end if
         if (index(name, "=") > 0) name = name(:index(name, "=") - 1)
         select case (name)
         case ("--check")
            options%check = .true.
         case ("--no-pictures")
            options%pictures = .false.
         case ("--no-view")
            options%view = .false.
         case ("--quiet")
            options%quiet = .true.
         case ("--out", "--threads", "--set")
            call option_value(words, i, value, good)
            if (.not. good) then
               call print_error("run: the option " // name // " needs a value")
            else if (name == "--out") then
               options%out = value
            else if (name == "--threads") then
               call append_word(options%settings, "scene.threads=" // value)
            else
               call append_word(options%settings, value)
            end if
         case default
            call unknown_option("run", name, known)
            good = .false.
         end select
      end do
      if (good .and. len(options%scene) == 0) then
         call print_error("run: no scene given; shipped scenes: " // joined(shipped_scenes))
         good = .false.
      end if
      do while (len(options%out) > 1)
         if (options%out(len(options%out):) /= "/") exit
         options%out = options%out(:len(options%out) - 1)
      end do
   end subroutine read_options

   !> Report an unknown option.
   subroutine unknown_option(command, name, options)
      character(*), intent(in) :: command, name
      character(*), intent(in) :: options(:)   !! those there are
      if (size(options) == 0) then
         call print_error(command // ": unknown option '" // name // "'; there is only --help")
      else
         call print_error(command // ": unknown option '" // name // "'" // &
                       suggestion(name, options) // " (poinsot " // command // &
                       " --help shows all)")
      end if
   end subroutine unknown_option

   !> Find, read and build a scene, with settings over the file's; complains itself.
   subroutine load_scene(name, settings, scene, good)
      character(*), intent(in) :: name
      type(word), intent(in) :: settings(:)       !! group.key=value each
      type(scene_settings), intent(out) :: scene
      logical, intent(out) :: good
      type(scene_source) :: source
      type(poinsot_error) :: error
      character(:), allocatable :: file
      integer :: i
      call find_scene(name, file, good)
      if (.not. good) then
         call print_error(missing_scene(name))
         return
      end if
      call read_source(file, source, error)
      do i = 1, size(settings)
         if (.not. raised(error)) call override(settings(i)%text, source, error)
      end do
      if (.not. raised(error)) call build_scene(source, scene, error)
      good = .not. raised(error)
      if (.not. good) then
         call print_error(error%message)
         return
      end if
      do i = 1, size(scene%bodies)
         if (allocated(scene%bodies(i)%note)) call print_error(scene%bodies(i)%note)
      end do
   end subroutine load_scene

   !> --check
   subroutine check_only(scene, options, code)
      type(scene_settings), intent(in) :: scene
      type(run_options), intent(in) :: options
      integer, intent(out) :: code
      type(poinsot_error) :: error
      type(scene_settings) :: trial
      real(dp) :: rows
      integer :: i, j
      trial = scene
      if (trial%method == "auto") trial%method = "exact"
      if (trial%splitting == "auto") trial%splitting = "srkn6"
      call check_scene(trial, error)
      code = exit_ok
      if (raised(error)) then
         call print_error(scene%file // ": " // error%message)
         code = exit_usage
         return
      end if
      if (options%quiet) return
      rows = size(scene%output%bodies)
      if (size(scene%output%bodies) == 0) rows = real(body_total(scene), dp)
      rows = rows*output_count(scene)
      call say(scene%file // ": scene OK")
      call say("   bodies   " // text_of(body_total(scene)))
      do i = 1, size(scene%bodies)
         call say("   class " // text_of(i) // "  moments " // class_words(scene, i))
         if (.not. scene%bodies(i)%turned) cycle
         do j = 1, 3
            call say("            axis " // text_of(j) // "  " // &
               text_of(scene%bodies(i)%axes(:, j) + 0.0_dp))
         end do
      end do
      if (is_auto(scene)) then
         call say("   steps    chosen at the start, for tol = " // text_of(scene%tol))
      else
         call say("   steps    " // text_of(nint(step_total(scene), i8)) // " of '" // &
                  scene%method // "'")
      end if
      call say("   rows     " // text_of(nint(rows, i8)) // " of trajectory, about " // &
               text_of(nint(rows*240/1e6_dp, i8)) // " MB")
   end subroutine check_only

   !> Run, report, draw.
   subroutine run_it(scene, options, code, ranks)
      type(scene_settings), intent(inout) :: scene     !! `auto` gets its choice
      type(run_options), intent(in) :: options
      integer, intent(out) :: code
      class(communicator), intent(inout), optional :: ranks
      type(progress_watch) :: watch
      type(run_report) :: report
      type(folder_lock) :: lock
      type(poinsot_error) :: error
      character(16), allocatable :: names(:) !! of pictures
      character(:), allocatable :: out
      logical :: beyond
      out = options%out
      if (len(out) == 0) out = "poinsot-out/" // scene%name
      if (options%view) call find_template(scene%output%page, options%quiet)
      watch%shown = error_is_terminal() .and. .not. options%quiet
      scene%output%draw = options%pictures
      call lock_for_all(out, lock, ranks, error)
      call catch_interrupts()
      if (raised(error)) then
         continue
      else if (present(ranks)) then
         call resolve_auto_on_all(scene, watch, ranks, error)
      else
         call resolve_auto(scene, watch, error)
      end if
      call watch%wipe()
      if (.not. raised(error)) call run_scene(scene, out, watch, report, error, ranks)
      call watch%wipe()
      code = exit_of_run(error%code)
      if (raised(error)) then
         call print_error(error%message)
         return
      end if
      if (report%state == "interrupted") then
         call print_error("interrupted at t = " // text_of(report%t) // &
                          hint_of(report))
         code = exit_runtime
         return
      end if
      beyond = len(scene%chosen_fails) > 0 .or. report%beyond
      if (present(ranks)) then
         beyond = ranks%broadcast(merge(1_i8, 0_i8, beyond)) > 0 ! the first rank knows
         if (beyond) code = exit_tolerance
         if (ranks%number > 0) return
      end if
      if (.not. options%quiet) call show_file(out // "/summary.txt")
      call picture_names(scene, names)
      call draw_pictures(names, out, options%quiet, scripts_only=.not. options%pictures)
      if (.not. options%quiet) call say("written to " // out)
      if (.not. beyond) return
      if (len(scene%chosen_fails) == 0) scene%chosen_fails = "off by " // &
         brief_number(max(report%error_y, 2*report%error_q)) // " from " // report%reference
      call print_error("auto: the end is not within tol = " // text_of(scene%tol) // ": " // &
         scene%chosen_fails)
      code = exit_tolerance
   end subroutine run_it

   !> The first rank locks the folder for all, until this process ends.
   subroutine lock_for_all(out, lock, ranks, error)
      character(*), intent(in) :: out
      type(folder_lock), intent(inout) :: lock
      class(communicator), intent(inout), optional :: ranks
      type(poinsot_error), intent(inout) :: error
      if (.not. present(ranks)) then
         call lock_folder(out, lock, error)
         return
      end if
      if (ranks%number == 0) call lock_folder(out, lock, error)
      call ranks%share_error(error)
   end subroutine lock_for_all

   !> How to go on, if there is something to go on from.
   function hint_of(report) result(hint)
      type(run_report), intent(in) :: report
      character(:), allocatable :: hint
      hint = "; no restart file was written (output.restart is empty)"
      if (len(report%restart) > 0) hint = "; continue with --set scene.from=" // report%restart
   end function hint_of

   !> `auto` measures times: the first rank chooses, for all.
   subroutine resolve_auto_on_all(scene, watch, ranks, error)
      type(scene_settings), intent(inout) :: scene
      type(progress_watch), intent(inout) :: watch
      class(communicator), intent(inout) :: ranks
      type(poinsot_error), intent(inout) :: error
      if (.not. is_auto(scene)) return
      if (ranks%number == 0) call resolve_auto(scene, watch, error)
      call ranks%share_error(error)
      if (raised(error)) return
      call broadcast_name(ranks, scene%method)
      call broadcast_name(ranks, scene%splitting)
      scene%h = transfer(ranks%broadcast(transfer(scene%h, 0_i8)), scene%h)
      scene%tolerance = transfer(ranks%broadcast(transfer(scene%tolerance, 0_i8)), scene%tolerance)
   end subroutine resolve_auto_on_all

   !> The first rank's name, letter by letter.
   subroutine broadcast_name(ranks, name)
      class(communicator), intent(inout) :: ranks
      character(:), allocatable, intent(inout) :: name
      character(24) :: letters
      integer :: i
      letters = name
      do i = 1, len(letters)
         letters(i:i) = achar(int(ranks%broadcast(int(iachar(letters(i:i)), i8))))
      end do
      name = trim(letters)
   end subroutine broadcast_name

end module app_run
