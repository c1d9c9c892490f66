!> What accuracy costs in time, on a scene's own bodies and effects: errors against a reference and
!> times for every candidate over a range of steps.
module poinsot_study_cost
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_candidates, only: candidate, scene_kind, look_at, quiet_scene, &
      list_candidates, &
      plan_splitting
   use poinsot_study_clock, only: wall_seconds, processor_seconds
   use poinsot_study_cost_point, only: cost_point, digest, frontier, add_point, of_angle, &
      of_momentum, &
      middle, error_of, of_both
   use poinsot_study_efficient, only: frontier_part, frontier_parts
   use poinsot_study_energy_drift, only: drift_row, follow_energy
   use poinsot_study_errors, only: body_errors, find_errors
   use poinsot_study_members, only: member_set, draw_members, repeat_members
   use poinsot_study_reference, only: reference_solution, find_reference
   use poinsot_study_rivals, only: rival_point
   use poinsot_study_statistics, only: median, quantile
   use poinsot_study_timing, only: time_steps
   use poinsot_study_trial, only: trial_run, make_plan, run_trial, most_checks
   implicit none(type, external)
   private
   public :: cost_request, cost_study, study_cost

   !> What is asked.
   type :: cost_request
      character(24), allocatable :: methods(:), splittings(:) !! size 0: all that apply
      real(dp) :: budget = 60                 !! seconds for everything
      real(dp) :: spread = 0.3_dp !! of the initial states, radians; any_direction: uniform
      integer :: members = 2*lanes            !! initial states
      integer :: ensemble = 1024              !! bodies that are timed together
      logical :: compensated = .true.         !! compensated sums, as `poinsot run` has them
      logical :: timed = .true.               !! false: errors only
      integer(i8) :: most_steps = 2_i8**40    !! from start to end
   end type cost_request

   !> What is found.
   type :: cost_study
      type(scene_kind) :: kind
      type(candidate), allocatable :: candidates(:)
      type(cost_point), allocatable :: points(:)  !! candidate by candidate, steps ascending
      type(member_set) :: members
      type(reference_solution) :: reference
      real(dp) :: t_end = 0
      type(drift_row), allocatable :: drift(:)    !! energy in long runs
      type(rival_point), allocatable :: rivals(:) !! other integrators, from files; size 0: none
      logical :: conserves = .false.              !! the scene keeps its energy
      real(dp) :: seconds = 0                     !! spent
      logical :: stopped = .false.                !! somebody asked to stop
   end type cost_study

   ! shares of the budget: when each part must have ended
   real(dp), parameter :: reference_share = 0.2_dp, error_share = 0.6_dp, time_share = 0.9_dp
   real(dp), parameter :: one_share = 0.05_dp     !! longest single run
   real(dp), parameter :: far_behind = 30 !! times the cheapest of its accuracy: given up ...
   real(dp), parameter :: behind = 4
   real(dp), parameter :: long_level = 0.008_dp   !! ... once a level takes this part of the budget
   real(dp), parameter :: longer_level = 0.04_dp
   integer, parameter :: most_rounds = 15
   real(dp), parameter :: one_run = 1e-3_dp       !! seconds of a timed run

   !> How far a candidate has come.
   type :: climber
      type(poinsot_plan) :: plan
      logical :: running = .true.
      integer :: stalls = 0                       !! levels without gain
      real(dp) :: last = huge(1.0_dp)             !! error at the level before
      real(dp) :: seconds = 0                     !! of its last run, a step
   end type climber

contains

   !> Measure. Errors: what the plan or the candidates' names refuse, POINSOT_E_CONVERGENCE without
   !> a reference.
   subroutine study_cost(scene, request, watch, study, error)
      type(scene_settings), intent(in) :: scene
      type(cost_request), intent(in) :: request
      class(run_watch), intent(inout) :: watch     !! told the seconds spent; may ask to stop
      type(cost_study), intent(out) :: study
      type(poinsot_error), intent(inout) :: error
      type(scene_settings) :: quiet
      type(climber), allocatable :: climbers(:)
      real(dp) :: begun
      integer :: i
      begun = wall_seconds()
      call quiet_scene(scene, quiet)
      call look_at(quiet, study%kind, error)
      if (.not. raised(error)) call list_candidates(quiet, study%kind, request%methods, &
         request%splittings, &
                                                    study%candidates, error)
      if (.not. raised(error)) call draw_members(quiet, study%kind%coupled, request%members, &
         request%spread, &
                                                 study%members, error)
      if (raised(error)) return
      study%t_end = quiet%t_end
      call find_reference(quiet, study%kind, study%members, study%t_end, most_checks, &
                          reference_share*request%budget, study%reference, error)
      if (raised(error)) return
      allocate (climbers(size(study%candidates)), study%points(0))
      do i = 1, size(climbers)
         call make_plan(quiet, trim(study%candidates(i)%method), &
            plan_splitting(study%candidates(i)), &
                        climbers(i)%plan, error)
         if (raised(error)) return
      end do
      call climb(request, begun, watch, climbers, study)
      if (request%timed) call take_times(request, begun, watch, climbers, study)
      call frontier(study%points, of_angle)
      call frontier(study%points, of_momentum)
      allocate (study%drift(0), study%rivals(0))
      if (request%timed) call run_long(quiet, request, begun, watch, study, error)
      study%seconds = wall_seconds() - begun
   end subroutine study_cost

   !> Number of steps at a level: 1, 2, 3, 4, 6, 8, 12, ...
   pure integer(i8) function steps_of(level) result(steps)
      integer, intent(in) :: level       !! from 1
      steps = 1
      if (level == 1) return
      steps = ishft(merge(2_i8, 3_i8, mod(level, 2) == 0), level/2 - 1)
   end function steps_of

   !> Errors, level by level: all candidates with long steps first, so that a budget that ends
   !> leaves all of them equally far.
   subroutine climb(request, begun, watch, climbers, study)
      type(cost_request), intent(in) :: request
      real(dp), intent(in) :: begun
      class(run_watch), intent(inout) :: watch
      type(climber), intent(inout) :: climbers(:)
      type(cost_study), intent(inout) :: study
      type(cost_point) :: one
      integer :: level, i, n
      integer(i8) :: steps
      real(dp) :: left, level_took, limit
      n = 0
      limit = 1e30_dp
      level = 1
      if (.not. study%kind%free) level = 8
      do while (any(climbers%running) .and. level < 64)
         steps = steps_of(level)
         if (steps > request%most_steps) exit
         level_took = wall_seconds()
         do i = 1, size(climbers)
            if (.not. climbers(i)%running) cycle
            left = error_share*request%budget - (wall_seconds() - begun)
            if (climbers(i)%seconds*real(steps, dp) > min(left, one_share*request%budget) .or. &
               left <= 0) then
               climbers(i)%running = .false.
               cycle
            end if
            if (watch%stop_now()) study%stopped = .true.
            if (study%stopped) exit
            call one_point(request, climbers(i), i, steps, study, one)
            call add_point(study%points, n, one)
            call judge(study%candidates(i)%order, study%points(:n), one, limit, climbers(i))
            call watch%tell(wall_seconds() - begun, request%budget)
         end do
         if (study%stopped) exit
         level_took = wall_seconds() - level_took
         if (level_took > long_level*request%budget) limit = min(limit, far_behind)
         if (level_took > longer_level*request%budget) limit = behind
         level = level + 1
      end do
      call by_candidate(study%points(:n), size(climbers), study%points)
   end subroutine climb

   !> Run and compare.
   subroutine one_point(request, mine, number, steps, study, one)
      type(cost_request), intent(in) :: request
      type(climber), intent(inout) :: mine
      integer, intent(in) :: number
      integer(i8), intent(in) :: steps
      type(cost_study), intent(in) :: study
      type(cost_point), intent(out) :: one
      type(trial_run) :: run
      type(body_errors) :: errors
      one%candidate = number
      one%steps = steps
      one%h = study%t_end/real(steps, dp)
      call run_trial(mine%plan, study%members, study%t_end, steps, most_checks, &
         request%compensated, run)
      mine%seconds = run%seconds/real(steps, dp)
      one%good = run%good
      if (.not. run%good) return
      one%guess = 1e9_dp*run%seconds/(real(steps, dp)*study%members%n)
      call find_errors(run, study%reference%state, study%t_end, errors)
      call digest(errors, study%members%own, one)
   end subroutine one_point

   !> Is there anything to gain from shorter steps?
   subroutine judge(order, points, one, limit, mine)
      integer, intent(in) :: order
      real(dp), intent(in) :: limit            !! times dearer than another that is as good
      type(cost_point), intent(in) :: points(:), one
      type(climber), intent(inout) :: mine
      real(dp) :: off, price
      integer :: i
      if (.not. one%good) return
      off = error_of(one, of_both, middle)
      if (off > 0.6_dp*mine%last .and. off < 1e-9_dp) mine%stalls = mine%stalls + 1
      if (off < 0.6_dp*mine%last) mine%stalls = 0
      mine%last = min(off, mine%last)
      mine%running = mine%stalls < merge(16, 3, order == 0)
      if (.not. off < 1e-2_dp) return
      price = one%guess/one%h
      do i = 1, size(points)
         if (.not. points(i)%good) cycle
         if (error_of(points(i), of_both, middle) <= off .and. &
             limit*points(i)%guess/points(i)%h < price) mine%running = .false.
      end do
   end subroutine judge

   !> Points in the order of candidates.
   subroutine by_candidate(points, candidates, sorted)
      type(cost_point), intent(in) :: points(:)
      integer, intent(in) :: candidates
      type(cost_point), allocatable, intent(inout) :: sorted(:)
      type(cost_point), allocatable :: list(:)
      integer :: i, k, n
      allocate (list(size(points)))
      n = 0
      do k = 1, candidates
         do i = 1, size(points)
            if (points(i)%candidate /= k) cycle
            n = n + 1
            list(n) = points(i)
         end do
      end do
      call move_alloc(list, sorted)
   end subroutine by_candidate

   !> Time all points in rounds; when another round of all would go beyond the budget, those that
   !> may be on the frontier only.
   subroutine take_times(request, begun, watch, climbers, study)
      type(cost_request), intent(in) :: request
      real(dp), intent(in) :: begun
      class(run_watch), intent(inout) :: watch
      type(climber), intent(in) :: climbers(:)
      type(cost_study), intent(inout) :: study
      type(member_set) :: many, one
      real(dp), allocatable :: ns(:, :), alone(:, :)
      real(dp) :: left, round_took
      logical :: wanted(size(study%points))
      integer :: i, round
      many = study%members
      if (study%members%together == 1) call repeat_members(study%members, request%ensemble, many)
      one = study%members
      if (study%members%together == 1) call repeat_members(study%members, 1, one)
      allocate (ns(most_rounds, size(study%points)), alone(most_rounds, size(study%points)))
      round_took = 0
      wanted = study%points%good
      ns = 0
      alone = 0
      do round = 1, most_rounds
         left = time_share*request%budget - (wall_seconds() - begun)
         if (round > 1 .and. round_took*(4 - min(round, 3)) > left) then
            if (all(wanted .eqv. study%points%good)) call near_frontier(study%points, ns(:round - &
               1, :), wanted)
            if (round_took > left .and. count(wanted) > count(study%points%good)/4) exit
         end if
         if (left <= 0) exit
         round_took = wall_seconds()
         do i = 1, size(study%points)
            associate (p => study%points(i), plan => climbers(study%points(i)%candidate)%plan)
               if (watch%stop_now()) study%stopped = .true.
               if (.not. wanted(i) .or. study%stopped) cycle
               if (round > 1 .and. wall_seconds() - begun > time_share*request%budget) cycle
               call time_steps(plan, many, p%h, p%guess, one_run, p%steps, request%compensated, &
                  ns(round, i))
               if (study%members%together == 1) then
                  call time_steps(plan, one, p%h, lanes*p%guess, 0.5_dp*one_run, p%steps, &
                                  request%compensated, alone(round, i))
               end if
               p%repeats = round
            end associate
            call watch%tell(wall_seconds() - begun, request%budget)
         end do
         if (study%stopped) exit
         round_took = wall_seconds() - round_took
      end do
      do i = 1, size(study%points)
         call summarise(ns(:study%points(i)%repeats, i), alone(:study%points(i)%repeats, i), &
            study%points(i))
      end do
   end subroutine take_times

   !> Points that cost at most `near` times the cheapest of their accuracy, so far.
   pure subroutine near_frontier(points, ns, wanted)
      type(cost_point), intent(in) :: points(:)
      real(dp), intent(in) :: ns(:, :)          !! (rounds, points)
      logical, intent(inout) :: wanted(:)
      real(dp), parameter :: near = 2
      real(dp) :: price(size(points)), off(size(points))
      integer :: i
      do i = 1, size(points)
         price(i) = minval(ns(:, i))/points(i)%h
         off(i) = error_of(points(i), of_both, middle)
      end do
      do i = 1, size(points)
         if (wanted(i)) wanted(i) = price(i) <= near*minval(price, mask=points%good .and. &
            off <= off(i))
      end do
   end subroutine near_frontier

   !> Energy in long runs of the frontier's candidates; of a free scene of all kinds of methods.
   subroutine run_long(quiet, request, begun, watch, study, error)
      type(scene_settings), intent(in) :: quiet
      type(cost_request), intent(in) :: request
      real(dp), intent(in) :: begun
      class(run_watch), intent(inout) :: watch
      type(cost_study), intent(inout) :: study
      type(poinsot_error), intent(inout) :: error
      type(drift_row), allocatable :: rows(:)
      integer, allocatable :: at(:)
      integer :: i, n
      real(dp) :: each, change
      change = 0
      associate (e => study%reference%state%energy, scale => study%reference%state%scale)
         do i = lbound(e, 2), ubound(e, 2)
            change = max(change, maxval(abs(e(:, i) - e(:, lbound(e, 2)))/scale))
         end do
      end associate
      study%conserves = change < 1e-9_dp
      if (.not. study%conserves .or. study%stopped .or. size(study%points) == 0) return
      call pick_for_drift(study, at)
      allocate (rows(100*max(1, size(at))))
      each = max(0.02_dp*request%budget, 0.98_dp*request%budget - (wall_seconds() - begun))/max(1, &
         size(at))
      n = 0
      do i = 1, size(at)
         associate (p => study%points(at(i)))
            call follow_energy(quiet, study%candidates(p%candidate), p%candidate, study%members, &
               p%h, study%t_end, &
                               min(each, 0.02_dp*request%budget), request%compensated, watch, &
                                  rows, n, error)
         end associate
         if (raised(error)) return
      end do
      study%drift = rows(:n)
   end subroutine run_long

   !> Points whose energy is followed.
   subroutine pick_for_drift(study, at)
      type(cost_study), intent(in) :: study
      integer, allocatable, intent(out) :: at(:)
      character(24), parameter :: shown(8) = [character(24) :: "exact", "dmv2", "dmv10", &
         "midpoint", &
                                              "three-rotations", "symmetric-rotation", "rattle", &
                                                 "jacobi"]
      type(frontier_part), allocatable :: parts(:)
      integer :: i, k
      allocate (at(0))
      if (study%kind%free) then
         do k = 1, size(shown)
            i = usual_point(study, shown(k))
            if (i > 0) at = [at, i]
         end do
         return
      end if
      call frontier_parts(study%points, size(study%candidates), of_both, parts)
      do k = 1, size(parts)
         if (size(at) >= 7 .or. parts(k)%point == 0) cycle
         if (.not. any(study%points(at)%candidate == parts(k)%candidate)) at = [at, parts(k)%point]
      end do
   end subroutine pick_for_drift

   !> A method's point with the step that turns the fastest body by about 0.2.
   integer function usual_point(study, method) result(at)
      type(cost_study), intent(in) :: study
      character(*), intent(in) :: method
      real(dp) :: nearest, off, wanted
      integer :: i
      at = 0
      nearest = huge(nearest)
      ! dmv2 makes an error of about (h omega)^3/12 a step: the step where it is a few per cent at
      ! the end is a usual one, whatever the unit of time
      wanted = 0
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (study%candidates(p%candidate)%method /= "dmv2" .or. .not. p%good) cycle
            if (p%angle(middle) < 0.05_dp .and. wanted <= 0) wanted = p%h
         end associate
      end do
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (study%candidates(p%candidate)%method /= method .or. .not. p%good) cycle
            off = abs(log(p%h/max(wanted, tiny(wanted))))
            if (off >= nearest) cycle
            nearest = off
            at = i
         end associate
      end do
   end function usual_point

   !> Median, least and spread of the repetitions.
   pure subroutine summarise(ns, alone, point)
      real(dp), intent(in) :: ns(:), alone(:)
      type(cost_point), intent(inout) :: point
      if (size(ns) == 0) return
      point%ns = median(ns)
      point%ns_least = minval(ns)
      point%single = median(alone)
      if (point%ns > 0) point%ns_spread = 0.5_dp*(quantile(ns, 0.75_dp) - quantile(ns, &
         0.25_dp))/point%ns
      if (point%single > 0) point%single_spread = 0.5_dp*(quantile(alone, 0.75_dp) - &
                                                          quantile(alone, 0.25_dp))/point%single
   end subroutine summarise

end module poinsot_study_cost
