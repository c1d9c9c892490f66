!> The trials of a choice: the scene without noise, some of its bodies and states near them, a
!> reference to measure errors, the candidates, and the number of steps required by outputs.
module poinsot_study_choose_trials
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_schedule, only: piece_count
   use poinsot_scene_noise, only: has_noise
   use poinsot_scene_settings, only: scene_settings, body_total
   use poinsot_study_candidates, only: candidate, scene_kind, survey_scene, quiet_scene, &
      list_candidates, plan_splitting
   use poinsot_study_choice, only: choose_request, choice
   use poinsot_study_clock, only: time_limit, limit_in, part_of, left_of
   use poinsot_study_members, only: draw_members
   use poinsot_study_reference, only: reference_solution, find_reference
   use poinsot_study_search, only: problem, contender
   use poinsot_study_statistics, only: median
   use poinsot_study_trial, only: make_plan, trial_run, run_trial
   implicit none(type, external)
   private
   public :: trials, prepare_trials, prepare_task

   !> The trials: a scene without noise, and some of its bodies.
   type :: trials
      type(scene_settings) :: quiet
      type(scene_kind) :: kind
      type(problem) :: task
      type(candidate), allocatable :: list(:)
      type(contender), allocatable :: contenders(:)
      real(dp) :: reference_seconds = 0        !! of a body and a unit of time
      logical :: series = .false.              !! the reference is a Taylor series
      real(dp), allocatable :: doubt(:)        !! (members): the reference's own errors
   end type trials

   integer, parameter :: most_given = 128        !! of the scene's bodies, if it has many
   real(dp), parameter :: near_by = 0.02_dp !! spread of the states beside the scene's own, radians
   !> Errors must be so many times within the tolerance: all bodies tried; some of them.
   real(dp), parameter, public :: whole_margin = 1.1_dp, sample_margin = 2

contains

   !> Reference, candidates, and the number of steps they must come in: as a test of all candidates
   !> needs them.
   subroutine prepare_task(scene, request, task, list, contenders, answer, error)
      type(scene_settings), intent(in) :: scene
      type(choose_request), intent(in) :: request
      type(problem), intent(out) :: task
      type(candidate), allocatable, intent(out) :: list(:)
      type(contender), allocatable, intent(out) :: contenders(:)
      type(choice), intent(inout) :: answer
      type(poinsot_error), intent(inout) :: error
      type(trials) :: all
      call prepare_trials(scene, request, limit_in(request%budget, .false.), all, answer, error)
      if (raised(error)) return
      task = all%task
      call move_alloc(all%list, list)
      call move_alloc(all%contenders, contenders)
   end subroutine prepare_task

   !> What the search tries and what it compares with: task, list and contenders of a scene.
   subroutine prepare_trials(scene, request, limit, all, answer, error)
      type(scene_settings), intent(in) :: scene
      type(choose_request), intent(in) :: request
      type(time_limit), intent(in) :: limit
      type(trials), intent(inout) :: all
      type(choice), intent(inout) :: answer
      type(poinsot_error), intent(inout) :: error
      integer :: i
      call quiet_scene(scene, all%quiet)
      call survey_scene(all%quiet, all%kind, error)
      if (.not. raised(error)) call list_candidates(all%quiet, all%kind, request%methods, &
         request%splittings, all%list, error)
      if (.not. raised(error)) call draw_members(all%quiet, all%kind%coupled, &
         max(lanes, int(min(body_total(scene), int(most_given, i8)))), near_by, all%task%members, &
         error)
      if (raised(error)) return
      all%task%tol = request%tol
      all%task%margin = whole_margin
      if (all%task%members%given < body_total(scene)) all%task%margin = sample_margin
      call window(limit, all, answer, error)
      if (raised(error)) return
      associate (task => all%task)
         task%unit = least_steps(scene, request%longest, task%t_end)
         task%pieces = least_steps(scene, 0.0_dp, task%t_end)
         task%longest = task%t_end/real(task%unit, dp)
         if (request%longest <= 0 .and. scene%output%present .and. scene%output%every > 0) then
            task%longest = min(scene%output%every, scene%t_end)
         end if
         allocate (all%contenders(size(all%list)))
         do i = 1, size(all%list)
            associate (one => all%contenders(i), setup => all%list(i))
               call make_plan(all%quiet, trim(setup%method), plan_splitting(setup), one%plan, error)
               if (raised(error)) return
               one%order = setup%order
               one%adaptive = setup%adaptive
               one%unit = merge(task%pieces, task%unit, setup%adaptive)
               one%longest = task%longest
               if (setup%adaptive) one%longest = task%t_end/real(task%pieces, dp)
            end associate
         end do
         answer%t_measured = task%t_end
         answer%bodies = task%members%n
         answer%given = task%members%given
      end associate
      answer%total = body_total(scene)
      answer%noisy = has_noise(scene)
   end subroutine prepare_trials

   !> A reference good enough for the tolerance, to the scene's end or, where that takes too long,
   !> to an earlier time; errors are then taken to grow in proportion to time.
   subroutine window(limit, all, answer, error)
      type(time_limit), intent(in) :: limit
      type(trials), intent(inout) :: all
      type(choice), intent(inout) :: answer
      type(poinsot_error), intent(inout) :: error
      type(reference_solution) :: reference
      type(poinsot_error) :: failure
      real(dp) :: given_error
      integer :: tries
      associate (task => all%task)
         task%t_end = affordable(limit, all)
         do tries = 1, 6
            failure = poinsot_error()
            call find_reference(all%quiet, all%kind, task%members, task%t_end, 1, &
               part_of(limit, 0.2_dp), reference, failure, 0.01_dp*task%tol)
            if (reference%series .or. all%kind%free) exit ! a shorter time would not be nearer
            given_error = huge(given_error)
            if (.not. raised(failure)) given_error = max(median(reference%angle), &
               median(reference%momentum))
            if (given_error < max(0.1_dp*task%tol, 1e-13_dp)) exit
            task%t_end = task%t_end/4
         end do
         if (raised(failure)) then
            error = failure
            return
         end if
         task%growth = all%quiet%t_end/task%t_end
         task%reference = reference%state
         all%series = reference%series
         all%doubt = max(reference%angle, reference%momentum)
         all%reference_seconds = reference%seconds/(task%members%n*task%t_end)
         if (all%kind%free) all%reference_seconds = 0
         answer%reference = reference%how
      end associate
   end subroutine window

   !> The scene's end, or an earlier time if `taylor` would take longer than a tenth of what is left
   !> to get there.
   real(dp) function affordable(limit, all) result(t)
      type(time_limit), intent(in) :: limit
      type(trials), intent(in) :: all
      integer, parameter :: part = 64
      type(contender) :: pilot
      type(trial_run) :: run
      type(poinsot_error) :: refused
      t = all%quiet%t_end
      if (all%kind%free) return
      call make_plan(all%quiet, "exact", "taylor", pilot%plan, refused)
      if (raised(refused)) return
      call run_trial(pilot%plan, all%task%members, t/part, 1_i8, 1, .true., run)
      do while (run%seconds*part*(t/all%quiet%t_end) > 0.1_dp*left_of(limit) .and. &
         t > all%quiet%t_end/part)
         t = t/2
      end do
   end function affordable

   !> Steps that outputs ask for at least, to time t: a step is never longer than from one to the
   !> next.
   pure integer(i8) function least_steps(scene, longest, t) result(steps)
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: longest, t
      steps = max(1_i8, nint(real(piece_count(scene), dp)*t/scene%t_end, i8))
      if (longest > 0) steps = max(steps, ceiling(t/longest*(1 - 1e-10_dp), i8))
   end function least_steps

end module poinsot_study_choose_trials
