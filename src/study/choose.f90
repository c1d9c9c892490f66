!> The cheapest method, splitting and step size that meet a tolerance for a scene on this machine,
!> found by trial on the scene's own bodies; the choice is then verified on all of them, from start
!> to end.
module poinsot_study_choose
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_choice, only: choose_request, choice, chosen, time_ran_out, out_of_reach, &
      motion_chaotic
   use poinsot_study_choose_check, only: test_choice
   use poinsot_study_choose_growth, only: error_growth, find_growth
   use poinsot_study_choose_rank, only: time_finalists, take
   use poinsot_study_choose_trials, only: trials, prepare_trials
   use poinsot_study_clock, only: processor_seconds, time_limit, limit_in, part_of
   use poinsot_study_search, only: contender, search_steps, run_cost, usual_slack
   use poinsot_taylor_settings, only: least_tolerance
   implicit none(type, external)
   private
   public :: choose_method

   integer, parameter :: most_rounds = 4         !! of searches

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
         call take(scene, all, k, run_cost(all%contenders(k), all%contenders(k)%best_multiple), &
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
