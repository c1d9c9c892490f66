!> poinsot reproduce
module app_reproduce
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_nearest, only: suggestion
   use poinsot_scene_claim, only: claim_files, picture_claims
   use poinsot_scene_text, only: joined
   use poinsot_study_repeat_celledoni, only: repeat_celledoni
   use poinsot_study_repeat_fasso, only: repeat_fasso
   use poinsot_study_repeat_hairer, only: repeat_hairer
   use poinsot_study_repeat_review, only: repeat_review
   use app_arguments, only: word_list
   use app_codes, only: exit_ok, exit_usage, exit_of_run
   use app_draw, only: draw_pictures, show_file
   use app_options, only: study_options, read_study_options, seconds_of
   use app_progress, only: progress_watch
   use app_run, only: command_run
   use app_terminal, only: say, print_error, error_is_terminal, catch_interrupts
   implicit none(type, external)
   private
   public :: command_reproduce

   character(13), parameter :: known(4) = [character(13) :: "--out", "--budget", "--no-pictures", &
      "--quiet"]
   character(16), parameter :: figures(4) = [character(16) :: "review", "hairer-vilmart", "fasso", &
      "celledoni"]

contains

   !> The files of a figure.
   subroutine claim_figure(out, figure, error)
      character(*), intent(in) :: out, figure
      type(poinsot_error), intent(inout) :: error
      character(64), allocatable :: pictures(:)
      character(64) :: data(3), one(1)
      data(1) = figure // ".csv"
      data(2) = figure // ".txt"
      data(3) = figure // ".gp"
      one = figure
      pictures = picture_claims(one)
      call claim_files(out, [data, pictures], error)
   end subroutine claim_figure

   !> The command.
   subroutine command_reproduce(words, code)
      type(word_list), intent(in) :: words !! what follows the command
      integer, intent(out) :: code         !! exit code
      type(study_options) :: options
      type(progress_watch) :: watch
      type(poinsot_error) :: error
      character(:), allocatable :: out
      real(dp) :: budget
      logical :: good
      code = exit_usage
      call read_study_options("reproduce", words, known, options, good, &
                              "no figure given; choose one of: " // joined(figures))
      if (.not. good) return
      if (.not. any(figures == options%scene)) then
         call print_error("reproduce: unknown figure '" // options%scene // "'" // &
            suggestion(options%scene, figures))
         return
      end if
      budget = 120
      if (options%budget /= "") call seconds_of("reproduce", options%budget, budget, good)
      if (.not. good) return
      out = options%out
      if (len(out) == 0) out = "poinsot-out/" // options%scene
      watch%shown = error_is_terminal() .and. .not. options%quiet
      call catch_interrupts()
      call claim_figure(out, options%scene, error)
      if (.not. raised(error)) then
         select case (options%scene)
         case ("review")
            call repeat_review(out, error)
         case ("hairer-vilmart")
            call repeat_hairer(out, error)
         case ("fasso")
            call repeat_fasso(out, error)
         case default
            call repeat_celledoni(out, budget, watch, error)
         end select
      end if
      call watch%wipe()
      code = exit_of_run(error%code)
      if (raised(error)) then
         call print_error(error%message)
         return
      end if
      if (.not. options%quiet) call show_file(out // "/" // options%scene // ".txt")
      if (options%scene == "review") then
         call run_book(out, options, code)
         return
      end if
      call draw_pictures([options%scene], out, options%quiet, &
                         scripts_only=.not. options%pictures)
      if (.not. options%quiet) call say("written to " // out)
      code = exit_ok
   end subroutine command_reproduce

   !> The review's figure is that of the shipped scene.
   subroutine run_book(out, options, code)
      character(*), intent(in) :: out
      type(study_options), intent(in) :: options
      integer, intent(out) :: code
      type(word_list) :: words
      allocate (words%at(5))
      words%at(1)%text = "free-body"
      words%at(2)%text = "--out"
      words%at(3)%text = out
      words%at(4)%text = "--out=" // out
      words%at(5)%text = "--out=" // out
      if (options%quiet) words%at(4)%text = "--quiet"
      if (.not. options%pictures) words%at(5)%text = "--no-pictures"
      call command_run(words, code)
   end subroutine run_book

end module app_reproduce
