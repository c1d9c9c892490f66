!> The cheapest method, splitting and step that meet a tolerance on a scene and a machine, by trial
!> on the scene's own bodies; the choice is then put to the test on all of them, from start to end.
module poinsot_study_choose
   use poinsot_core_kinds, only: dp, i8, qp, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_schedule, only: piece_count
   use poinsot_scene_settings, only: scene_settings, body_total
   use poinsot_scene_states, only: body_states
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_candidates, only: candidate, scene_kind, survey_scene, quiet_scene, &
      list_candidates, plan_splitting, no_splitting
   use poinsot_study_choose_check, only: run_whole, error_growth, find_growth
   use poinsot_study_clock, only: processor_seconds, time_limit, limit_in, part_of, left_of
   use poinsot_study_errors, only: compare_states
   use poinsot_study_members, only: member_set, draw_members, repeat_members
   use poinsot_study_reference, only: reference_solution, find_reference
   use poinsot_study_search, only: problem, contender, search_steps, step_of, price_of, usual_slack
   use poinsot_study_statistics, only: median
   use poinsot_study_timing, only: time_steps
   use poinsot_study_trial, only: make_plan, trial_run, run_trial
   use poinsot_taylor_settings, only: least_tolerance
   implicit none(type, external)
   private
   public :: choose_request, choice, chosen, choose_method, prepare_task, chosen_scene, best_of

   !> What is asked.
   type :: choose_request
      real(dp) :: tol = 1e-8_dp                !! attitude in radians, momentum relative, at the end
      real(dp) :: budget = 20                  !! seconds of the processor
      character(24), allocatable :: methods(:), splittings(:)  !! size 0: all
      real(dp) :: longest = 0                  !! longest step allowed; 0: as the outputs have it
   end type choose_request

   !> One way, and what it promises.
   type :: chosen
      type(candidate) :: setup
      real(dp) :: h = 0
      real(dp) :: tolerance = 0                !! of `taylor`; 0 of others
      real(dp) :: error = 0                    !! of the scene's own bodies at its end
      real(dp) :: near = 0                     !! median of those and states near them
      real(dp) :: ns = 0                       !! of a body-step, one thread
      real(dp) :: run = 0                      !! seconds of the whole run, one thread
   end type chosen

   !> How a choice ended.
   integer, parameter, public :: tolerance_kept = 0   !! within the tolerance
   integer, parameter, public :: time_ran_out = 1     !! before anything was
   integer, parameter, public :: out_of_reach = 2     !! rounding, or the order of what was named
   integer, parameter, public :: motion_chaotic = 3   !! nothing can be, to the scene's end

   !> The answer.
   type :: choice
      type(chosen) :: best, runner_up          !! %h = 0: there is none
      integer :: ended = tolerance_kept
      logical :: checked = .false.             !! all bodies, the whole run
      type(error_growth) :: growth             !! where the motion is chaotic
      character(:), allocatable :: reference   !! how errors were measured
      real(dp) :: t_measured = 0 !! to which time; the scene's end if it was near enough
      integer :: bodies = 0, given = 0         !! states tried, the scene's own among them
      integer(i8) :: total = 0                 !! bodies of the scene
      integer :: candidates = 0                !! that came through
      integer :: late = 0                      !! that were given up for want of time
      logical :: noisy = .false.               !! the scene has noise, the trials had not
      real(dp) :: seconds = 0                  !! of the processor, spent
   end type choice

   !> What is tried: a scene without noise, and some of its bodies.
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
   integer, parameter :: worst_added = 64        !! that a test found beyond the tolerance
   integer, parameter :: most_rounds = 4
   real(dp), parameter :: near_by = 0.02_dp !! spread of the states beside the scene's own, radians
   real(dp), parameter :: whole_margin = 1.1_dp, sample_margin = 2 !! all bodies tried; some of them
   integer, parameter :: finalists = 10, repeats = 9
   real(dp), parameter :: final_share = 1.5_dp !! times the cheapest: timed again
   real(dp), parameter :: as_cheap = 1.1_dp    !! times closer than this are the same
   real(dp), parameter :: one_run = 1e-3_dp
   real(dp), parameter :: no_cost = 1e100_dp  !! of who does not meet the tolerance

contains

   !> Choose. Errors: what the plan refuses. Where nothing keeps the tolerance the answer says why,
   !> with the best there is; its h is 0 if no method came through with any step.
   subroutine choose_method(scene, request, watch, answer, error)
      type(scene_settings), intent(in) :: scene
      type(choose_request), intent(in) :: request
      class(run_watch), intent(inout) :: watch
      type(choice), intent(out) :: answer
      type(poinsot_error), intent(inout) :: error
      type(trials) :: all
      type(time_limit) :: limit
      real(dp) :: begun
      integer :: round
      logical :: again
      begun = processor_seconds()
      limit = limit_in(request%budget, .false.)
      call prepare_trials(scene, request, limit, all, answer, error)
      if (raised(error)) return
      again = .false.
      do round = 1, most_rounds
         call search(all, limit, watch, answer%growth)
         if (all_failed(all%contenders) .or. answer%growth%chaotic) exit
         call time_finalists(scene, all, part_of(limit, 0.5_dp), answer)
         call test_choice(request, limit, watch, all, answer, again, error)
         if (raised(error)) return
         if (.not. again) exit
      end do
      if (again .or. answer%growth%chaotic .or. all_failed(all%contenders)) then
         call explain(scene, request, all, limit, answer)
      end if
      answer%candidates = count(all%contenders%best_multiple > 0)
      answer%late = count(all%contenders%late .and. all%contenders%met == 0)
      answer%seconds = processor_seconds() - begun
   end subroutine choose_method

   pure logical function all_failed(contenders)
      type(contender), intent(in) :: contenders(:)
      all_failed = all(contenders%met == 0)
   end function all_failed

   !> Those first that are the best in most scenes: whoever comes after them is soon too dear. Where
   !> errors outgrow the tolerance nobody else is tried.
   subroutine search(all, limit, watch, growth)
      type(trials), intent(inout) :: all
      type(time_limit), intent(in) :: limit
      class(run_watch), intent(inout) :: watch
      type(error_growth), intent(inout) :: growth
      logical :: wanted(size(all%list))
      integer :: i
      wanted = all%contenders%running
      all%contenders%running = wanted .and. all%list%adaptive
      call search_steps(all%task, all%contenders, usual_slack, part_of(limit, 0.5_dp), watch)
      if (.not. growth%known .and. all%series .and. (all%task%growth > 1 .or. &
          any(out_of_hand(all%contenders, all%task%tol)))) then
         call find_growth(all%quiet, all%task%members, [(i, i=1, min(4, all%task%members%given))], &
            all%task%tol, part_of(limit, 0.25_dp), growth)
         if (growth%chaotic) return
      end if
      all%contenders%running = wanted .and. all%list%method == "exact" .and. &
         .not. all%list%adaptive
      call search_steps(all%task, all%contenders, usual_slack, part_of(limit, 0.5_dp), watch)
      all%contenders%running = wanted .and. all%list%method /= "exact"
      call search_steps(all%task, all%contenders, usual_slack, part_of(limit, 0.4_dp), watch)
   end subroutine search

   !> At its finest `taylor` is so far from the tolerance that no smaller rounding would do.
   elemental logical function out_of_hand(one, tol)
      type(contender), intent(in) :: one
      real(dp), intent(in) :: tol
      out_of_hand = one%adaptive .and. one%met == 0 .and. one%plan%tolerance <= &
         1.01_dp*least_tolerance .and. one%best_error > 10*tol
   end function out_of_hand

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
      answer%noisy = any_noise(scene)
   end subroutine prepare_trials

   !> Does a thermostat make noise, which the trials have not?
   pure logical function any_noise(scene)
      type(scene_settings), intent(in) :: scene
      integer :: i
      any_noise = any([(scene%effects(i)%name == "langevin", i=1, size(scene%effects))])
   end function any_noise

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

   !> Time those that may be the cheapest in turn, and rank them.
   subroutine time_finalists(scene, all, limit, answer)
      type(scene_settings), intent(in) :: scene
      type(trials), intent(in) :: all
      type(time_limit), intent(in) :: limit
      type(choice), intent(inout) :: answer
      type(member_set) :: many
      real(dp) :: cost_of(size(all%list)), times(repeats, finalists)
      integer :: at(finalists), i, k, n, round, done
      many = all%task%members
      if (many%together == 1) call repeat_members(all%task%members, int(min(body_total(scene), &
         1024_i8)), many)
      cost_of = no_cost
      do i = 1, size(all%list)
         associate (one => all%contenders(i))
            if (one%met > 0) cost_of(i) = price_of(one, one%met)
         end associate
      end do
      call pick_finalists(cost_of, at, n)
      done = 0
      do round = 1, repeats
         if (round > 1 .and. left_of(limit) < 0) exit
         do i = 1, n
            associate (one => all%contenders(at(i)))
               call time_steps(one%plan, many, step_of(one, one%met), one%ns*max(1, lanes/many%n), &
                  one_run, one%unit*one%met, .true., times(round, i))
            end associate
         end do
         done = round
      end do
      cost_of = no_cost
      do i = 1, n
         associate (one => all%contenders(at(i)))
            if (minval(times(:done, i)) > 0) cost_of(at(i)) = median(times(:done, i))* &
               real(one%met*one%unit, dp)
         end associate
      end do
      if (minval(cost_of) >= no_cost) cost_of(at(1)) = price_of(all%contenders(at(1)), &
         all%contenders(at(1))%met)
      k = best_of(all%contenders, cost_of)
      call take(scene, all, k, cost_of(k), answer%best)
      cost_of(k) = no_cost
      k = best_of(all%contenders, cost_of)
      answer%runner_up%h = 0
      if (minval(cost_of) < no_cost) call take(scene, all, k, cost_of(k), answer%runner_up)
   end subroutine time_finalists

   !> The cheapest as seen in passing.
   pure subroutine pick_finalists(cost_of, at, n)
      real(dp), intent(inout) :: cost_of(:)
      integer, intent(out) :: at(finalists), n
      real(dp) :: least
      integer :: i, k
      n = 0
      at = 0
      least = minval(cost_of)
      do i = 1, finalists
         k = minloc(cost_of, 1)
         if (.not. cost_of(k) < no_cost) exit
         if (i > 3 .and. cost_of(k) > final_share*least) exit
         n = n + 1
         at(n) = k
         cost_of(k) = no_cost
      end do
   end subroutine pick_finalists

   !> The most accurate of those that cost the same.
   pure integer function best_of(contenders, cost_of) result(best)
      type(contender), intent(in) :: contenders(:)
      real(dp), intent(in) :: cost_of(:)
      best = minloc(contenders%error, 1, mask=cost_of <= as_cheap*minval(cost_of))
   end function best_of

   !> A contender as an answer.
   subroutine take(scene, all, k, cost_of, best)
      type(scene_settings), intent(in) :: scene
      type(trials), intent(in) :: all
      integer, intent(in) :: k
      real(dp), intent(in) :: cost_of
      type(chosen), intent(out) :: best
      integer(i8) :: multiple
      associate (one => all%contenders(k))
         multiple = one%met
         if (multiple == 0) multiple = one%best_multiple
         best%setup = all%list(k)
         best%h = step_of(one, multiple)
         best%error = one%given
         best%near = one%near
         if (one%met == 0) best%error = one%best_error
         if (one%met == 0) best%near = one%best_error
         if (one%adaptive) best%tolerance = merge(one%tolerance, one%best_tolerance, one%met > 0)
         best%ns = cost_of/real(multiple*one%unit, dp)
         best%run = 1e-9_dp*best%ns*(scene%t_end/best%h)*real(body_total(scene), dp)
      end associate
   end subroutine take

   !> A scene with a choice filled in.
   pure function chosen_scene(scene, best) result(filled)
      type(scene_settings), intent(in) :: scene
      type(chosen), intent(in) :: best
      type(scene_settings) :: filled
      filled = scene
      filled%method = trim(best%setup%method)
      if (filled%splitting == "auto" .or. best%setup%splitting /= no_splitting) then
         filled%splitting = plan_splitting(best%setup)
      end if
      filled%h = best%h
      if (best%setup%adaptive) filled%tolerance = best%tolerance
   end function chosen_scene

   !> Run the scene as chosen, all its bodies to its end. If some are beyond the tolerance they join
   !> those that are tried, and the search has to begin again.
   subroutine test_choice(request, limit, watch, all, answer, again, error)
      type(choose_request), intent(in) :: request
      type(time_limit), intent(in) :: limit
      class(run_watch), intent(inout) :: watch
      type(trials), intent(inout) :: all
      type(choice), intent(inout) :: answer
      logical, intent(out) :: again
      type(poinsot_error), intent(inout) :: error
      type(body_states) :: states
      type(member_set) :: everybody
      type(reference_solution) :: reference
      type(poinsot_plan) :: plan
      type(trial_run) :: run
      real(dp), allocatable :: angle(:), momentum(:), off(:)
      real(dp) :: needed
      logical :: done, known
      again = .false.
      answer%ended = tolerance_kept
      answer%checked = .false.
      needed = answer%best%run
      known = all%task%members%given == answer%total .and. all%task%growth <= 1
      if (.not. known) needed = needed + all%reference_seconds*all%quiet%t_end* &
         real(answer%total, dp)
      if (needed > 0.8_dp*left_of(limit)) return
      call run_whole(chosen_scene(all%quiet, answer%best), limit, watch, states, done, error)
      if (raised(error) .or. .not. done) return
      call draw_members(all%quiet, all%kind%coupled, states%n, 0.0_dp, everybody, error)
      if (raised(error)) return
      if (known) then
         reference%state%y = all%task%reference%y(:, :states%n)
         reference%state%q = all%task%reference%q(:, :states%n)
      else if (all%kind%free) then
         call make_plan(all%quiet, "jacobi", "srkn6", plan, error)
         call run_trial(plan, everybody, all%quiet%t_end, 1_i8, 1, .true., run)
         reference%state%y = run%y
         reference%state%q = run%q/spread(norm2(run%q, 1), 1, 4)
      else
         call find_reference(all%quiet, all%kind, everybody, all%quiet%t_end, 1, &
            part_of(limit, 0.3_dp), reference, error, 0.01_dp*request%tol)
         if (raised(error)) return
      end if
      call compare_states(real(states%y, qp), real(states%q, qp), reference%state, angle, momentum)
      off = max(angle(:states%n), momentum(:states%n))
      if (known) then
         off = max(off, all%doubt(:states%n)) ! nobody can vouch for less
      else if (allocated(reference%angle)) then
         off = max(off, reference%angle, reference%momentum)
      end if
      answer%checked = .true.
      answer%best%error = maxval(off)
      again = answer%best%error > request%tol
      if (.not. again) return
      all%task%margin = max(all%task%margin, whole_margin*all%task%margin*min(3.0_dp, &
         answer%best%error/request%tol))
      call add_worst(all, everybody, off, reference, error)
   end subroutine test_choice

   !> Bodies beyond the tolerance join those that are tried, the worst first; all candidates that
   !> may still win begin again.
   subroutine add_worst(all, everybody, off, reference, error)
      type(trials), intent(inout) :: all
      type(member_set), intent(in) :: everybody
      real(dp), intent(in) :: off(:)
      type(reference_solution), intent(in) :: reference
      type(poinsot_error), intent(inout) :: error
      logical :: left(size(off))
      real(dp) :: least
      integer :: i, k
      associate (task => all%task)
         left = off > task%tol
         if (task%growth <= 1 .and. task%members%given < everybody%n .and. &
             task%members%together == 1) then
            task%margin = whole_margin ! the worst are there from now on
            do i = 1, min(worst_added, count(left))
               k = maxloc(off, 1, mask=left)
               left(k) = .false.
               call put_first(everybody, k, reference, task)
            end do
         end if
      end associate
      least = no_cost
      do i = 1, size(all%contenders)
         associate (one => all%contenders(i))
            if (one%met > 0) least = min(least, price_of(one, one%met))
         end associate
      end do
      do i = 1, size(all%contenders)
         associate (one => all%contenders(i))
            one%running = one%met > 0
            if (one%running) one%running = price_of(one, one%met) <= 3*least
            one%failed = 0
            one%met = 0
            one%last = huge(one%last)
            one%best_error = huge(one%best_error)
            one%best_multiple = 0
         end associate
      end do
      associate (unused => error%code)
      end associate
   end subroutine add_worst

   !> One more of the scene's bodies among those that are tried, with its end.
   subroutine put_first(everybody, k, reference, task)
      type(member_set), intent(in) :: everybody
      integer, intent(in) :: k
      type(reference_solution), intent(in) :: reference
      type(problem), intent(inout) :: task
      associate (m => task%members, r => task%reference)
         m%group = [everybody%group(k), m%group]
         m%y = reshape([everybody%y(:, k), m%y], [3, m%n + 1])
         m%q = reshape([everybody%q(:, k), m%q], [4, m%n + 1])
         r%y = reshape([reference%state%y(:, k), r%y], [3, m%n + 1])
         r%q = reshape([reference%state%q(:, k), r%q], [4, m%n + 1])
         m%n = m%n + 1
         m%given = m%given + 1
      end associate
   end subroutine put_first

   !> Nothing meets the tolerance: the best there is, and why.
   subroutine explain(scene, request, all, limit, answer)
      type(scene_settings), intent(in) :: scene
      type(choose_request), intent(in) :: request
      type(trials), intent(in) :: all
      type(time_limit), intent(in) :: limit
      type(choice), intent(inout) :: answer
      type(chosen) :: nearest
      integer :: k, i
      k = minloc(all%contenders%best_error, 1)
      answer%runner_up%h = 0
      if (all%contenders(k)%best_multiple > 0) then
         call take(scene, all, k, price_of(all%contenders(k), all%contenders(k)%best_multiple), &
            nearest)
         if (.not. (answer%best%h > 0 .and. answer%checked .and. answer%best%error < &
            nearest%error)) then
            answer%best = nearest
            answer%checked = .false.
         end if
      end if
      answer%ended = out_of_reach
      if (any(all%contenders%late)) answer%ended = time_ran_out
      if (any(all%contenders%adaptive .and. all%contenders%best_tolerance > 0)) then
         answer%ended = out_of_reach ! at its finest, what torques as data allow
         if (.not. answer%growth%known) call find_growth(all%quiet, all%task%members, &
            [(i, i=1, min(4, all%task%members%given))], request%tol, limit, answer%growth)
         if (all%task%growth > 1) answer%ended = time_ran_out ! to try the whole run
      end if
      if (answer%growth%chaotic) answer%ended = motion_chaotic
      if (answer%ended == motion_chaotic .and. answer%best%setup%adaptive) then
         answer%best%tolerance = least_tolerance
      end if
   end subroutine explain

end module poinsot_study_choose
