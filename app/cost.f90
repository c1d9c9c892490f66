!> poinsot cost
module app_cost
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_claim, only: claim_files
   use poinsot_scene_settings, only: scene_settings
   use poinsot_study_cost, only: cost_request, cost_study, study_cost
   use poinsot_study_cost_files, only: write_points, write_members, write_report, write_drift_rows
   use poinsot_study_cost_plots, only: write_cost_plots, cost_pictures, cost_files
   use poinsot_study_members, only: any_direction
   use poinsot_study_rivals, only: rival_point, read_rivals
   use app_arguments, only: word_list
   use app_codes, only: exit_ok, exit_usage, exit_of_run
   use app_draw, only: draw_pictures, show_file
   use app_options, only: study_options, read_study_options, seconds_of, numbers_in, names_in
   use app_progress, only: progress_watch
   use app_run, only: load_scene
   use app_terminal, only: say, print_error, error_is_terminal, catch_interrupts
   implicit none(type, external)
   private
   public :: command_cost

   character(13), parameter :: known(12) = [character(13) :: "--out", "--budget", "--methods", &
      "--splittings", "--tol", "--spread", "--states", "--sums", "--rivals", "--set", &
      "--no-pictures", "--quiet"]
   real(dp), parameter :: to_write = 0.5_dp, to_draw = 6 !! seconds of the budget
   real(dp), parameter :: usual_tolerances(5) = [1e-3_dp, 1e-6_dp, 1e-9_dp, 1e-12_dp, 1e-15_dp]

contains

   !> The command.
   subroutine command_cost(words, code)
      type(word_list), intent(in) :: words !! what follows the command
      integer, intent(out) :: code         !! exit code
      type(study_options) :: options
      type(scene_settings) :: scene
      type(cost_request) :: request
      real(dp), allocatable :: tolerances(:)
      logical :: good
      code = exit_usage
      call read_study_options("cost", words, known, options, good)
      if (.not. good) return
      call to_request(options, request, tolerances, good)
      if (.not. good) return
      call load_scene(options%scene, options%settings, scene, good)
      if (.not. good) return
      if (options%spread == "" .and. size(scene%effects) == 0) request%spread = any_direction
      call measure(scene, options, request, tolerances, code)
   end subroutine command_cost

   !> Texts to numbers.
   subroutine to_request(options, request, tolerances, good)
      type(study_options), intent(in) :: options
      type(cost_request), intent(out) :: request
      real(dp), allocatable, intent(out) :: tolerances(:)
      logical, intent(out) :: good
      real(dp), allocatable :: states(:), spread(:)
      good = .true.
      tolerances = usual_tolerances
      call names_in(options%methods, request%methods)
      call names_in(options%splittings, request%splittings)
      if (options%budget /= "") call seconds_of("cost", options%budget, request%budget, good)
      request%reserve = min(0.1_dp*request%budget, merge(to_draw, to_write, options%pictures))
      if (good .and. options%tol /= "") call numbers_in("cost", "--tol", options%tol, 1e-17_dp, &
         1.0_dp, tolerances, good)
      if (good .and. options%states /= "") then
         call numbers_in("cost", "--states", options%states, 1.0_dp, 1e5_dp, states, good)
         if (good) request%members = nint(states(1))
      end if
      if (good .and. options%spread == "any") then
         request%spread = any_direction
      else if (good .and. options%spread /= "") then
         call numbers_in("cost", "--spread", options%spread, 0.0_dp, 3.2_dp, spread, good)
         if (good) request%spread = spread(1)
      end if
      if (.not. good .or. options%sums == "") return
      good = options%sums == "plain" .or. options%sums == "compensated"
      request%compensated = options%sums /= "plain"
      if (.not. good) call print_error("cost: --sums is plain or compensated, not '" // &
         options%sums // "'")
   end subroutine to_request

   !> Study, write, draw.
   subroutine measure(scene, options, request, tolerances, code)
      type(scene_settings), intent(in) :: scene
      type(study_options), intent(in) :: options
      type(cost_request), intent(in) :: request
      real(dp), intent(in) :: tolerances(:)
      integer, intent(out) :: code
      type(progress_watch) :: watch
      type(cost_study) :: study
      type(rival_point), allocatable :: rivals(:)
      type(poinsot_error) :: error
      character(:), allocatable :: out
      out = options%out
      if (len(out) == 0) out = "poinsot-out/" // scene%name // "-cost"
      watch%shown = error_is_terminal() .and. .not. options%quiet
      watch%clock = "wall"
      call catch_interrupts()
      call claim_files(out, cost_files(), error)
      if (.not. raised(error)) call read_rivals(options%rivals, rivals, error)
      if (.not. raised(error)) call study_cost(scene, request, watch, study, error)
      call watch%wipe()
      if (.not. raised(error)) study%rivals = rivals
      if (.not. raised(error)) call write_points(out // "/cost.csv", study, error)
      if (.not. raised(error)) call write_drift_rows(out // "/drift.csv", study, error)
      if (.not. raised(error)) call write_members(out // "/members.csv", scene, study, error)
      if (.not. raised(error)) call write_report(out // "/cost.txt", scene, request, study, &
         tolerances, error)
      if (.not. raised(error)) call write_cost_plots(out, scene, study, error)
      code = exit_of_run(error%code)
      if (raised(error)) then
         call print_error(error%message)
         return
      end if
      if (study%stopped) call print_error("interrupted: results measured so far are written")
      if (.not. options%quiet) call show_file(out // "/cost.txt")
      call draw_pictures(cost_pictures(study), out, options%quiet, &
                         scripts_only=.not. options%pictures)
      if (.not. options%quiet) call say("written to " // out)
      code = merge(exit_usage, exit_ok, code == exit_usage)
   end subroutine measure

end module app_cost
