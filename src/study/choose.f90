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
   use poinsot_study_candidates, only: candidate, scene_kind, look_at, quiet_scene, &
      list_candidates, &
      plan_splitting, label_of
   use poinsot_study_clock, only: wall_seconds
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
      type(candidate) :: way
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
      integer :: bodies = 0, own = 0           !! states tried, the scene's own among them
      integer :: candidates = 0                !! that ran
      logical :: noisy = .false.               !! the scene has noise, the trials had not
      real(dp) :: seconds = 0                  !! spent
   end type choice

   integer, parameter :: most_own = 128        !! of the scene's bodies, if it has many
   real(dp), parameter :: near_by = 0.02_dp !! spread of the states beside the scene's own, radians
   real(dp), parameter :: whole_margin = 1.1_dp, sample_margin = 2 !! all bodies tried; some of them
   integer, parameter :: finalists = 10, repeats = 9
   real(dp), parameter :: final_share = 1.5_dp !! times the cheapest: timed again
   real(dp), parameter :: one_run = 1e-3_dp
   real(dp), parameter :: no_price = 1e100_dp  !! of who does not meet the tolerance

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
      type(contender), allocatable :: racers(:)
      type(problem) :: task
      real(dp) :: begun
      begun = wall_seconds()
      call prepare_task(scene, request, task, list, racers, answer, error)
      if (raised(error)) return
      call search_steps(task, racers, usual_slack, begun + 0.8_dp*request%budget, watch)
      if (all(racers%met == 0)) then
         call refuse(scene, request, list, racers, task, error)
         return
      end if
      call time_finalists(scene, request, task, list, racers, begun + 0.97_dp*request%budget, &
         answer)
      answer%candidates = count(racers%best_multiple > 0)
      answer%seconds = wall_seconds() - begun
   end subroutine choose_method

   !> Reference, candidates, and the number of steps they must come in.
   subroutine prepare_task(scene, request, task, list, racers, answer, error)
      type(scene_settings), intent(in) :: scene
      type(choose_request), intent(in) :: request
      type(problem), intent(out) :: task
      type(candidate), allocatable, intent(out) :: list(:)
      type(contender), allocatable, intent(out) :: racers(:)
      type(choice), intent(inout) :: answer
      type(poinsot_error), intent(inout) :: error
      type(scene_settings) :: quiet
      type(scene_kind) :: kind
      integer :: i
      call quiet_scene(scene, quiet)
      call look_at(quiet, kind, error)
      if (.not. raised(error)) call list_candidates(quiet, kind, request%methods, &
         request%splittings, list, error)
      if (.not. raised(error)) call draw_members(quiet, kind%coupled, &
                                                 max(lanes, int(min(body_total(scene), &
                                                    int(most_own, i8)))), &
                                                 near_by, task%members, error)
      if (raised(error)) return
      task%tol = request%tol
      task%margin = whole_margin
      if (task%members%own < body_total(scene)) task%margin = sample_margin
      call window(quiet, kind, request, task, answer, error)
      if (raised(error)) return
      task%unit = least_steps(scene, request%longest, task%t_end)
      task%longest = task%t_end/real(task%unit, dp)
      if (request%longest <= 0 .and. scene%output%present .and. scene%output%every > 0) then
         task%longest = min(scene%output%every, scene%t_end)
      end if
      allocate (racers(size(list)))
      do i = 1, size(list)
         call make_plan(quiet, trim(list(i)%method), plan_splitting(list(i)), racers(i)%plan, error)
         if (raised(error)) return
         racers(i)%order = list(i)%order
      end do
      answer%t_measured = task%t_end
      answer%bodies = task%members%n
      answer%own = task%members%own
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
      real(dp) :: own_error, share
      integer :: tries
      task%t_end = quiet%t_end
      share = 0.2_dp
      do tries = 1, 6
         failure = poinsot_error()
         call find_reference(quiet, kind, task%members, task%t_end, 1, share*request%budget, &
            reference, failure, &
                             0.01_dp*task%tol)
         own_error = huge(own_error)
         if (.not. raised(failure)) own_error = max(median(reference%angle), &
            median(reference%momentum))
         if (own_error < 0.1_dp*task%tol) exit
         if (own_error < 1e-13_dp .or. kind%free) exit ! rounding: a shorter time changes nothing
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
   subroutine time_finalists(scene, request, task, list, racers, deadline, answer)
      type(scene_settings), intent(in) :: scene
      type(choose_request), intent(in) :: request
      type(problem), intent(in) :: task
      type(candidate), intent(in) :: list(:)
      type(contender), intent(in) :: racers(:)
      real(dp), intent(in) :: deadline
      type(choice), intent(inout) :: answer
      type(member_set) :: many
      real(dp) :: price(size(list)), ns(repeats), times(repeats, finalists), h, least
      integer :: at(finalists), i, k, n, round, done
      many = task%members
      if (many%together == 1) call repeat_members(task%members, int(min(body_total(scene), &
         1024_i8)), many)
      price = no_price
      where (racers%met > 0) price = racers%ns*real(racers%met, dp)
      n = 0
      least = 0
      do i = 1, finalists
         k = minloc(price, 1)
         if (.not. price(k) < no_price) exit
         if (i == 1) least = price(k)
         if (i > 3 .and. price(k) > final_share*least) exit
         n = n + 1
         at(n) = k
         price(k) = no_price
      end do
      done = 0
      do round = 1, repeats
         if (round > 1 .and. wall_seconds() > deadline) exit
         do i = 1, n
            h = task%longest/real(racers(at(i))%met, dp)
            call time_steps(racers(at(i))%plan, many, h, racers(at(i))%ns*max(1, lanes/many%n), &
               one_run, &
                            task%unit*racers(at(i))%met, .true., times(round, i))
         end do
         done = round
      end do
      price = no_price
      do i = 1, n
         ns(1) = median(times(:done, i))
         if (minval(times(:done, i)) > 0) price(at(i)) = ns(1)*real(racers(at(i))%met, dp)
      end do
      call take_best(scene, task, list, racers, price, answer%best)
      k = minloc(price, 1)
      price(k) = no_price
      if (minval(price) < no_price) call take_best(scene, task, list, racers, price, &
         answer%runner_up)
      associate (unused => request%tol)
      end associate
   end subroutine time_finalists

   !> The cheapest as an answer.
   subroutine take_best(scene, task, list, racers, price, best)
      type(scene_settings), intent(in) :: scene
      type(problem), intent(in) :: task
      type(candidate), intent(in) :: list(:)
      type(contender), intent(in) :: racers(:)
      real(dp), intent(in) :: price(:)
      type(chosen), intent(out) :: best
      integer :: k
      k = minloc(price, 1)
      best%way = list(k)
      best%h = task%longest/real(racers(k)%met, dp)
      best%error = racers(k)%own
      best%near = racers(k)%near
      best%ns = price(k)/real(racers(k)%met, dp)
      best%run = 1e-9_dp*best%ns*(scene%t_end/best%h)*real(body_total(scene), dp)
   end subroutine take_best

   !> Nothing meets the tolerance: say what comes nearest.
   subroutine refuse(scene, request, list, racers, task, error)
      type(scene_settings), intent(in) :: scene
      type(choose_request), intent(in) :: request
      type(candidate), intent(in) :: list(:)
      type(contender), intent(in) :: racers(:)
      type(problem), intent(in) :: task
      type(poinsot_error), intent(inout) :: error
      integer :: k
      k = minloc(racers%best_error, 1)
      if (racers(k)%best_multiple == 0) then
         call raise(error, poinsot_e_convergence, scene%file // &
            ": no method comes through with any step " // &
                    "that the budget of " // brief_number(request%budget) // " s allows")
         return
      end if
      call raise(error, poinsot_e_convergence, scene%file // ": nothing meets the tolerance " // &
                 brief_number(request%tol) // " within " // brief_number(request%budget) // &
                    " s; " // &
                 label_of(list(k)) // " with h = " // &
                 text_of(task%longest/real(racers(k)%best_multiple, dp)) // &
                    " comes nearest, with an error of " // &
                 brief_number(racers(k)%best_error))
   end subroutine refuse

end module poinsot_study_choose
