!> Verification of a choice: the scene as it will be run, all its bodies from start to end, against
!> a reference. Bodies that miss the tolerance are added to the trial states.
module poinsot_study_choose_check
   use poinsot_core_kinds, only: dp, i8, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_engine, only: engine, start_engine, engine_step
   use poinsot_scene_schedule, only: piece, piece_count, get_piece
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_states, only: body_states, first_states
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_choice, only: choose_request, choice, chosen_scene, tolerance_kept
   use poinsot_study_choose_rank, only: no_cost
   use poinsot_study_choose_trials, only: trials, whole_margin
   use poinsot_study_clock, only: time_limit, part_of, left_of
   use poinsot_study_errors, only: compare_states
   use poinsot_study_members, only: member_set, draw_members
   use poinsot_study_reference, only: reference_solution, find_reference
   use poinsot_study_search, only: problem, run_cost
   use poinsot_study_trial, only: make_plan, trial_run, run_trial
   implicit none(type, external)
   private
   public :: test_choice

   integer, parameter :: worst_added = 64        !! that a test found beyond the tolerance

contains

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
      call add_worst(all, everybody, off, reference)
   end subroutine test_choice

   !> The scene step by step, as `poinsot run` takes it, without files. Not done when the limit is
   !> over. Error: what the engine refuses.
   subroutine run_whole(scene, limit, watch, states, done, error)
      type(scene_settings), intent(in) :: scene  !! method, splitting, step and tolerance as chosen
      type(time_limit), intent(in) :: limit
      class(run_watch), intent(inout) :: watch
      type(body_states), intent(out) :: states
      logical, intent(out) :: done
      type(poinsot_error), intent(inout) :: error
      type(engine) :: motor
      type(piece) :: part
      integer(i8) :: k, number, from, several
      done = .false.
      call first_states(scene, states, error)
      if (.not. raised(error)) call start_engine(scene, motor, error)
      number = 0
      do k = 1, piece_count(scene)
         part = get_piece(scene, k)
         from = 0
         do while (from < part%steps)
            several = min(part%steps - from, max(1_i8, 1000000_i8/states%n))
            if (.not. raised(error)) call engine_step(motor, states, part%from - &
               real(number, dp)*part%h, part%h, number + from, several, error)
            if (raised(error) .or. left_of(limit) < 0 .or. watch%stop_now()) return
            from = from + several
         end do
         number = number + part%steps
      end do
      done = .true.
   end subroutine run_whole

   !> Bodies beyond the tolerance join those that are tried, the worst first; all candidates that
   !> may still win begin again.
   subroutine add_worst(all, everybody, off, reference)
      type(trials), intent(inout) :: all
      type(member_set), intent(in) :: everybody
      real(dp), intent(in) :: off(:)
      type(reference_solution), intent(in) :: reference
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
            if (one%met > 0) least = min(least, run_cost(one, one%met))
         end associate
      end do
      do i = 1, size(all%contenders)
         associate (one => all%contenders(i))
            one%running = one%met > 0
            if (one%running) one%running = run_cost(one, one%met) <= 3*least
            one%failed = 0
            one%met = 0
            one%last = huge(one%last)
            one%best_error = huge(one%best_error)
            one%best_multiple = 0
         end associate
      end do
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

end module poinsot_study_choose_check
