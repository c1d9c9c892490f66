!> The cheapest method, splitting and step that meet a tolerance on a scene and a machine, by trial
!> on the scene's own bodies.
module poinsot_study_choose
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_convergence
   use poinsot_scene_schedule, only: piece_count
   use poinsot_scene_settings, only: scene_settings, body_total
   use poinsot_scene_summary, only: brief_number
   use poinsot_scene_text, only: text_of
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_candidates, only: candidate, scene_kind, survey_scene, quiet_scene, &
      list_candidates, &
      plan_splitting, label_of
   use poinsot_study_clock, only: processor_seconds, limit_in
   use poinsot_study_members, only: member_set, draw_members, repeat_members
   use poinsot_study_reference, only: reference_solution, find_reference
   use poinsot_study_search, only: problem, contender, search_steps, usual_slack
   use poinsot_study_statistics, only: median
   use poinsot_study_timing, only: time_steps
   use poinsot_study_trial, only: make_plan
   implicit none(type, external)
   private
   public :: choose_request, choice, chosen, choose_method, prepare_task

   !> What is asked.
   type :: choose_request
      real(dp) :: tol = 1e-8_dp                !! attitude in radians, momentum relative, at the end
      real(dp) :: budget = 20                  !! seconds
      character(24), allocatable :: methods(:), splittings(:)  !! size 0: all
      real(dp) :: longest = 0                  !! longest step allowed; 0: as the outputs have it
   end type choose_request

   !> One way, and what it promises.
   type :: chosen
      type(candidate) :: setup
      real(dp) :: h = 0
      real(dp) :: error = 0                    !! of the scene's own bodies at its end
      real(dp) :: near = 0                     !! median of those and states near them
      real(dp) :: ns = 0                       !! of a body-step, one thread
      real(dp) :: run = 0                      !! seconds of the whole run, one thread
   end type chosen

   !> The answer.
   type :: choice
      type(chosen) :: best, runner_up          !! runner_up%h = 0: there is none
      character(:), allocatable :: reference   !! how errors were measured
      real(dp) :: t_measured = 0 !! to which time; the scene's end if it was near enough
      integer :: bodies = 0, given = 0           !! states tried, the scene's own among them
      integer :: candidates = 0                !! that ran
      logical :: noisy = .false.               !! the scene has noise, the trials had not
      real(dp) :: seconds = 0                  !! spent
   end type choice

   integer, parameter :: most_given = 128        !! of the scene's bodies, if it has many
   real(dp), parameter :: near_by = 0.02_dp !! spread of the states beside the scene's own, radians
   real(dp), parameter :: whole_margin = 1.1_dp, sample_margin = 2 !! all bodies tried; some of them
   integer, parameter :: finalists = 10, repeats = 9
   real(dp), parameter :: final_share = 1.5_dp !! times the cheapest: timed again
   real(dp), parameter :: one_run = 1e-3_dp
   real(dp), parameter :: no_cost = 1e100_dp  !! of who does not meet the tolerance

contains

   !> Choose. Errors: what the plan refuses; POINSOT_E_CONVERGENCE if nothing meets the tolerance,
   !> with the best there is.
   subroutine choose_method(scene, request, watch, answer, error)
      type(scene_settings), intent(in) :: scene
      type(choose_request), intent(in) :: request
      class(run_watch), intent(inout) :: watch
      type(choice), intent(out) :: answer
      type(poinsot_error), intent(inout) :: error
      type(candidate), allocatable :: list(:)
      type(contender), allocatable :: contenders(:)
      type(problem) :: task
      real(dp) :: begun
      begun = processor_seconds()
      call prepare_task(scene, request, task, list, contenders, answer, error)
      if (raised(error)) return
      call search_steps(task, contenders, usual_slack, limit_in(begun + 0.8_dp*request%budget - &
         processor_seconds(), .false.), watch)
      if (all(contenders%met == 0)) then
         call reject(scene, request, list, contenders, task, error)
         return
      end if
      call time_finalists(scene, request, task, list, contenders, begun + 0.97_dp*request%budget, &
         answer)
      answer%candidates = count(contenders%best_multiple > 0)
      answer%seconds = processor_seconds() - begun
   end subroutine choose_method

   !> Reference, candidates, and the number of steps they must come in.
   subroutine prepare_task(scene, request, task, list, contenders, answer, error)
      type(scene_settings), intent(in) :: scene
      type(choose_request), intent(in) :: request
      type(problem), intent(out) :: task
      type(candidate), allocatable, intent(out) :: list(:)
      type(contender), allocatable, intent(out) :: contenders(:)
      type(choice), intent(inout) :: answer
      type(poinsot_error), intent(inout) :: error
      type(scene_settings) :: quiet
      type(scene_kind) :: kind
      integer :: i
      call quiet_scene(scene, quiet)
      call survey_scene(quiet, kind, error)
      if (.not. raised(error)) call list_candidates(quiet, kind, request%methods, &
         request%splittings, list, error)
      if (.not. raised(error)) call draw_members(quiet, kind%coupled, &
                                                 max(lanes, int(min(body_total(scene), &
                                                    int(most_given, i8)))), &
                                                 near_by, task%members, error)
      if (raised(error)) return
      task%tol = request%tol
      task%margin = whole_margin
      if (task%members%given < body_total(scene)) task%margin = sample_margin
      call window(quiet, kind, request, task, answer, error)
      if (raised(error)) return
      task%unit = least_steps(scene, request%longest, task%t_end)
      task%longest = task%t_end/real(task%unit, dp)
      if (request%longest <= 0 .and. scene%output%present .and. scene%output%every > 0) then
         task%longest = min(scene%output%every, scene%t_end)
      end if
      allocate (contenders(size(list)))
      do i = 1, size(list)
         call make_plan(quiet, trim(list(i)%method), plan_splitting(list(i)), contenders(i)%plan, &
            error)
         if (raised(error)) return
         contenders(i)%order = list(i)%order
      end do
      answer%t_measured = task%t_end
      answer%bodies = task%members%n
      answer%given = task%members%given
      answer%noisy = kind%noisy
   end subroutine prepare_task

   !> A reference good enough for the tolerance, to the scene's end or, where that takes too long,
   !> to an earlier time; errors are then taken to grow in proportion to time.
   subroutine window(quiet, kind, request, task, answer, error)
      type(scene_settings), intent(in) :: quiet
      type(scene_kind), intent(in) :: kind
      type(choose_request), intent(in) :: request
      type(problem), intent(inout) :: task
      type(choice), intent(inout) :: answer
      type(poinsot_error), intent(inout) :: error
      type(reference_solution) :: reference
      type(poinsot_error) :: failure
      real(dp) :: given_error, share
      integer :: tries
      task%t_end = quiet%t_end
      share = 0.2_dp
      do tries = 1, 6
         failure = poinsot_error()
         call find_reference(quiet, kind, task%members, task%t_end, 1, &
            limit_in(share*request%budget, .false.), &
            reference, failure, &
                             0.01_dp*task%tol)
         given_error = huge(given_error)
         if (.not. raised(failure)) given_error = max(median(reference%angle), &
            median(reference%momentum))
         if (given_error < 0.1_dp*task%tol) exit
         if (given_error < 1e-13_dp .or. kind%free) exit ! rounding: a shorter time changes nothing
         task%t_end = task%t_end/4
         share = 0.08_dp
      end do
      if (raised(failure)) then
         error = failure
         return
      end if
      task%growth = quiet%t_end/task%t_end
      task%reference = reference%state
      answer%reference = reference%how
   end subroutine window

   !> Steps that outputs ask for at least, to time t: a step is never longer than from one to the
   !> next.
   pure integer(i8) function least_steps(scene, longest, t) result(steps)
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: longest, t
      steps = max(1_i8, nint(real(piece_count(scene), dp)*t/scene%t_end, i8))
      if (longest > 0) steps = max(steps, ceiling(t/longest*(1 - 1e-10_dp), i8))
   end function least_steps

   !> Time those that may be the cheapest in turn, and rank them.
   subroutine time_finalists(scene, request, task, list, contenders, deadline, answer)
      type(scene_settings), intent(in) :: scene
      type(choose_request), intent(in) :: request
      type(problem), intent(in) :: task
      type(candidate), intent(in) :: list(:)
      type(contender), intent(in) :: contenders(:)
      real(dp), intent(in) :: deadline
      type(choice), intent(inout) :: answer
      type(member_set) :: many
      real(dp) :: cost_of(size(list)), ns(repeats), times(repeats, finalists), h, least
      integer :: at(finalists), i, k, n, round, done
      many = task%members
      if (many%together == 1) call repeat_members(task%members, int(min(body_total(scene), &
         1024_i8)), many)
      cost_of = no_cost
      where (contenders%met > 0) cost_of = contenders%ns*real(contenders%met, dp)
      n = 0
      least = 0
      do i = 1, finalists
         k = minloc(cost_of, 1)
         if (.not. cost_of(k) < no_cost) exit
         if (i == 1) least = cost_of(k)
         if (i > 3 .and. cost_of(k) > final_share*least) exit
         n = n + 1
         at(n) = k
         cost_of(k) = no_cost
      end do
      done = 0
      do round = 1, repeats
         if (round > 1 .and. processor_seconds() > deadline) exit
         do i = 1, n
            h = task%longest/real(contenders(at(i))%met, dp)
            call time_steps(contenders(at(i))%plan, many, h, contenders(at(i))%ns*max(1, &
               lanes/many%n), &
               one_run, &
                            task%unit*contenders(at(i))%met, .true., times(round, i))
         end do
         done = round
      end do
      cost_of = no_cost
      do i = 1, n
         ns(1) = median(times(:done, i))
         if (minval(times(:done, i)) > 0) cost_of(at(i)) = ns(1)*real(contenders(at(i))%met, dp)
      end do
      call take_best(scene, task, list, contenders, cost_of, answer%best)
      k = minloc(cost_of, 1)
      cost_of(k) = no_cost
      if (minval(cost_of) < no_cost) call take_best(scene, task, list, contenders, cost_of, &
         answer%runner_up)
      associate (unused => request%tol)
      end associate
   end subroutine time_finalists

   !> The cheapest as an answer.
   subroutine take_best(scene, task, list, contenders, cost_of, best)
      type(scene_settings), intent(in) :: scene
      type(problem), intent(in) :: task
      type(candidate), intent(in) :: list(:)
      type(contender), intent(in) :: contenders(:)
      real(dp), intent(in) :: cost_of(:)
      type(chosen), intent(out) :: best
      integer :: k
      k = minloc(cost_of, 1)
      best%setup = list(k)
      best%h = task%longest/real(contenders(k)%met, dp)
      best%error = contenders(k)%given
      best%near = contenders(k)%near
      best%ns = cost_of(k)/real(contenders(k)%met, dp)
      best%run = 1e-9_dp*best%ns*(scene%t_end/best%h)*real(body_total(scene), dp)
   end subroutine take_best

   !> Nothing meets the tolerance: say what comes nearest.
   subroutine reject(scene, request, list, contenders, task, error)
      type(scene_settings), intent(in) :: scene
      type(choose_request), intent(in) :: request
      type(candidate), intent(in) :: list(:)
      type(contender), intent(in) :: contenders(:)
      type(problem), intent(in) :: task
      type(poinsot_error), intent(inout) :: error
      integer :: k
      k = minloc(contenders%best_error, 1)
      if (contenders(k)%best_multiple == 0) then
         call raise(error, poinsot_e_convergence, scene%file // &
            ": no method comes through with any step " // &
                    "that the budget of " // brief_number(request%budget) // " s allows")
         return
      end if
      call raise(error, poinsot_e_convergence, scene%file // ": nothing meets the tolerance " // &
                 brief_number(request%tol) // " within " // brief_number(request%budget) // &
                    " s; " // &
                 label_of(list(k)) // " with h = " // &
                 text_of(task%longest/real(contenders(k)%best_multiple, dp)) // &
                    " comes nearest, with an error of " // &
                 brief_number(contenders(k)%best_error))
   end subroutine reject

end module poinsot_study_choose
