!> Errors of a cost study: every candidate with smaller and smaller steps.
module poinsot_study_cost_climb
   use poinsot_core_kinds, only: dp, i8
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_clock, only: wall_seconds
   use poinsot_study_cost_data, only: cost_request, cost_study
   use poinsot_study_cost_point, only: cost_point, digest, add_point, middle, error_of, of_both
   use poinsot_study_errors, only: body_errors, find_errors
   use poinsot_taylor_settings, only: least_tolerance, most_tolerance
   use poinsot_study_trial, only: trial_run, run_trial, set_tolerance, most_checks
   implicit none(type, external)
   private
   public :: climber, climb

   real(dp), parameter :: error_share = 0.6_dp    !! of the budget: when errors must be known
   real(dp), parameter :: one_share = 0.05_dp     !! longest single run
   real(dp), parameter :: far_behind = 30 !! times the cheapest of its accuracy: given up ...
   real(dp), parameter :: behind = 4
   real(dp), parameter :: long_level = 0.008_dp   !! ... once a level takes this part of the budget
   real(dp), parameter :: longer_level = 0.04_dp

   !> How far a candidate has come.
   type :: climber
      type(poinsot_plan) :: plan
      logical :: running = .true.
      integer :: stalls = 0                       !! levels without gain
      real(dp) :: last = huge(1.0_dp)             !! error at the level before
      real(dp) :: seconds = 0                     !! of its last run, a step
      logical :: adaptive = .false.               !! levels are tolerances
   end type climber

   real(dp), parameter :: of_level = sqrt(0.1_dp) !! from one tolerance of `taylor` to the next

contains

   !> Tolerance at a level of `taylor`, counted from 1; 0 beyond the finest.
   pure real(dp) function tolerance_of(level) result(tolerance)
      integer, intent(in) :: level
      tolerance = most_tolerance*of_level**(level - 1)
      if (tolerance < 0.99_dp*least_tolerance) tolerance = 0
      if (tolerance > 0) tolerance = max(tolerance, least_tolerance)
   end function tolerance_of


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
      do i = 1, size(climbers)
         if (climbers(i)%adaptive) call climb_tolerances(request, begun, watch, climbers(i), i, n, &
            study)
      end do
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
               study%late = study%late + 1
               cycle
            end if
            if (watch%stop_now()) study%stopped = .true.
            if (study%stopped) exit
            call one_point(request, climbers(i), i, steps, 0.0_dp, study, one)
            call add_point(study%points, n, one)
            call judge(study%candidates(i)%order, study%points(:n), one, limit, climbers(i))
            call watch%report_progress(wall_seconds() - begun, request%budget)
         end do
         if (study%stopped) exit
         level_took = wall_seconds() - level_took
         if (level_took > long_level*request%budget) limit = min(limit, far_behind)
         if (level_took > longer_level*request%budget) limit = behind
         level = level + 1
      end do
      call by_candidate(study%points(:n), size(climbers), study%points)
   end subroutine climb

   !> Errors of `taylor`: all its tolerances, which take little time, before any other.
   subroutine climb_tolerances(request, begun, watch, mine, number, n, study)
      type(cost_request), intent(in) :: request
      real(dp), intent(in) :: begun
      class(run_watch), intent(inout) :: watch
      type(climber), intent(inout) :: mine
      integer, intent(in) :: number
      integer, intent(inout) :: n               !! points there are
      type(cost_study), intent(inout) :: study
      type(cost_point) :: one
      real(dp) :: left
      integer :: level
      level = 1
      do while (tolerance_of(level) > 0)
         left = error_share*request%budget - (wall_seconds() - begun)
         if (2*mine%seconds > min(left, one_share*request%budget) .or. left <= 0) then
            study%late = study%late + 1
            exit
         end if
         if (watch%stop_now()) study%stopped = .true.
         if (study%stopped) exit
         call one_point(request, mine, number, 1_i8, tolerance_of(level), study, one)
         call add_point(study%points, n, one)
         level = level + 1
      end do
      mine%running = .false.
   end subroutine climb_tolerances

   !> Run and compare.
   subroutine one_point(request, mine, number, steps, tolerance, study, one)
      type(cost_request), intent(in) :: request
      type(climber), intent(inout) :: mine
      integer, intent(in) :: number
      integer(i8), intent(in) :: steps
      real(dp), intent(in) :: tolerance    !! of `taylor`, which takes the way in one call
      type(cost_study), intent(in) :: study
      type(cost_point), intent(out) :: one
      type(trial_run) :: run
      type(body_errors) :: errors
      one%candidate = number
      one%steps = steps
      if (mine%adaptive) then
         one%steps = 1
         one%tolerance = tolerance
         call set_tolerance(mine%plan, tolerance)
      end if
      one%h = study%t_end/real(one%steps, dp)
      call run_trial(mine%plan, study%members, study%t_end, one%steps, most_checks, &
         request%compensated, run)
      mine%seconds = run%seconds/real(steps, dp)
      one%good = run%good
      if (.not. run%good) return
      one%guess = 1e9_dp*run%seconds/(real(one%steps, dp)*study%members%n)
      call find_errors(run, study%reference%state, study%t_end, errors)
      call digest(errors, study%members%given, one)
   end subroutine one_point

   !> Is there anything to gain from shorter steps?
   subroutine judge(order, points, one, limit, mine)
      integer, intent(in) :: order
      real(dp), intent(in) :: limit            !! times dearer than another that is as good
      type(cost_point), intent(in) :: points(:), one
      type(climber), intent(inout) :: mine
      real(dp) :: deviation, cost_of
      integer :: i
      if (.not. one%good) return
      deviation = error_of(one, of_both, middle)
      if (deviation > 0.6_dp*mine%last .and. deviation < 1e-9_dp) mine%stalls = mine%stalls + 1
      if (deviation < 0.6_dp*mine%last) mine%stalls = 0
      mine%last = min(deviation, mine%last)
      mine%running = mine%stalls < merge(16, 3, order == 0)
      if (.not. deviation < 1e-2_dp) return
      cost_of = one%guess/one%h
      do i = 1, size(points)
         if (.not. points(i)%good) cycle
         if (error_of(points(i), of_both, middle) <= deviation .and. &
             limit*points(i)%guess/points(i)%h < cost_of) mine%running = .false.
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

end module poinsot_study_cost_climb
