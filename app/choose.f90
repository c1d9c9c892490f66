!> poinsot choose
module app_choose
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_files, only: make_folder, is_folder
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_text, only: for_shell
   use poinsot_study_choice, only: choose_request, choice, tolerance_kept
   use poinsot_study_choose, only: choose_method
   use poinsot_study_choose_text, only: choice_lines, verdict, write_chosen_scene
   use poinsot_study_fill_scene, only: text_line
   use app_arguments, only: word_list
   use app_codes, only: exit_usage, exit_tolerance, exit_of_run
   use app_options, only: study_options, read_study_options, seconds_of, numbers_in, names_in
   use app_progress, only: progress_watch
   use app_run, only: load_scene
   use app_terminal, only: say, print_error, error_is_terminal, catch_interrupts
   implicit none(type, external)
   private
   public :: command_choose

   character(13), parameter :: known(7) = [character(13) :: "--tol", "--out", "--budget", &
      "--methods", "--splittings", "--set", "--quiet"]

contains

   !> The command.
   subroutine command_choose(words, code)
      type(word_list), intent(in) :: words !! what follows the command
      integer, intent(out) :: code         !! exit code
      type(study_options) :: options
      type(scene_settings) :: scene
      type(choose_request) :: request
      real(dp), allocatable :: tol(:)
      logical :: good
      code = exit_usage
      call read_study_options("choose", words, known, options, good)
      if (.not. good) return
      call names_in(options%methods, request%methods)
      call names_in(options%splittings, request%splittings)
      if (options%budget /= "") call seconds_of("choose", options%budget, request%budget, good)
      if (good .and. options%tol /= "") call numbers_in("choose", "--tol", options%tol, 1e-15_dp, &
                                                       1.0_dp, tol, good)
      if (.not. good) return
      call load_scene(options%scene, options%settings, scene, good)
      if (.not. good) return
      request%tol = scene%tol
      if (allocated(tol)) request%tol = tol(1)
      call search(scene, options, request, code)
   end subroutine command_choose

   !> Choose, print and write the choice.
   subroutine search(scene, options, request, code)
      type(scene_settings), intent(in) :: scene
      type(study_options), intent(in) :: options
      type(choose_request), intent(in) :: request
      integer, intent(out) :: code
      type(progress_watch) :: watch
      type(choice) :: answer
      type(text_line), allocatable :: lines(:), settings(:)
      type(poinsot_error) :: error
      character(:), allocatable :: out
      integer :: i
      watch%shown = error_is_terminal() .and. .not. options%quiet
      watch%clock = "processor"
      call catch_interrupts()
      call choose_method(scene, request, watch, answer, error)
      call watch%wipe()
      code = exit_of_run(error%code)
      if (raised(error)) then
         call print_error(error%message)
         return
      end if
      call choice_lines(scene, request%tol, answer, lines)
      do i = 1, size(lines)
         if (.not. options%quiet) call say(lines(i)%text)
      end do
      if (answer%ended /= tolerance_kept) then
         call print_error(scene%file // ": " // verdict(scene, request%tol, answer))
         code = exit_tolerance
      end if
      if (.not. answer%best%h > 0) return
      out = options%out
      if (len(out) == 0) then
         out = "poinsot-out/" // scene%name // "-chosen.nml"
         call make_folder("poinsot-out", error)
      else if (is_folder(out)) then
         out = out // "/" // scene%name // "-chosen.nml"
      end if
      allocate (settings(size(options%settings)))
      do i = 1, size(settings)
         settings(i)%text = options%settings(i)%text
      end do
      if (.not. raised(error)) call write_chosen_scene(scene, out, request%tol, answer, settings, &
         error)
      if (raised(error)) then
         code = exit_of_run(error%code)
         call print_error(error%message)
      else if (.not. options%quiet) then
         call say("written to  " // out // "; poinsot run " // for_shell(out) // " runs it")
      end if
   end subroutine search

end module app_choose
