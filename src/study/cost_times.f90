!> Times of a cost study: every point, in rounds.
module poinsot_study_cost_times
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_clock, only: wall_seconds
   use poinsot_study_cost_climb, only: climber
   use poinsot_study_cost_data, only: cost_request, cost_study
   use poinsot_study_cost_point, only: cost_point, middle, error_of, of_both
   use poinsot_study_members, only: member_set, repeat_members
   use poinsot_study_statistics, only: median, quantile
   use poinsot_study_timing, only: time_steps
   use poinsot_study_trial, only: set_tolerance
   implicit none(type, external)
   private
   public :: take_times

   real(dp), parameter :: time_share = 0.9_dp     !! of the budget: when times must be known
   integer, parameter :: most_rounds = 15
   real(dp), parameter :: one_run = 1e-3_dp       !! seconds of a timed run
   real(dp), parameter :: first_round = 2e-3_dp   !! seconds that a point may take in a round

contains

   !> Time all points in rounds, those first that may be on the frontier: of them there are times
   !> even where other programs leave little of the budget. When another round of all would go
   !> beyond it, those only.
   subroutine take_times(request, begun, watch, climbers, study)
      type(cost_request), intent(in) :: request
      real(dp), intent(in) :: begun
      class(run_watch), intent(inout) :: watch
      type(climber), intent(inout) :: climbers(:)   !! their tolerances change
      type(cost_study), intent(inout) :: study
      type(member_set) :: many, one
      real(dp), allocatable :: ns(:, :), alone(:, :)
      real(dp) :: left, round_took
      logical, dimension(size(study%points)) :: wanted, likely
      integer :: i, round, half
      many = study%members
      if (study%members%together == 1) call repeat_members(study%members, request%ensemble, many)
      one = study%members
      if (study%members%together == 1) call repeat_members(study%members, 1, one)
      allocate (ns(most_rounds, size(study%points)), alone(most_rounds, size(study%points)))
      round_took = 0
      wanted = study%points%good
      ns = 0
      alone = 0
      left = time_share*request%budget - (wall_seconds() - begun)
      likely = wanted
      call near_frontier(study%points, study%points%guess, likely)
      if (first_round*count(wanted) > left) wanted = likely
      do round = 1, most_rounds
         left = time_share*request%budget - (wall_seconds() - begun)
         if (round > 1 .and. round_took*(4 - min(round, 3)) > left) then
            if (all(wanted .eqv. study%points%good)) then
               call near_frontier(study%points, minval(ns(:round - 1, :), dim=1), wanted)
            end if
            if (round_took > left .and. count(wanted) > count(study%points%good)/4) exit
         end if
         if (left <= 0) exit
         round_took = wall_seconds()
         do half = 1, 2
            do i = 1, size(study%points)
               if (likely(i) .neqv. half == 1) cycle
               if (watch%stop_now()) study%stopped = .true.
               if (.not. wanted(i) .or. study%stopped) cycle
               if (wall_seconds() - begun > time_share*request%budget) cycle
               call time_point(i)
               call watch%report_progress(wall_seconds() - begun, request%budget)
            end do
         end do
         if (study%stopped) exit
         round_took = wall_seconds() - round_took
      end do
      do i = 1, size(study%points)
         associate (p => study%points(i))
            call summarise(ns(:p%repeats, i), alone(:p%repeats, i), p)
            if (p%good .and. p%repeats == 0) study%untimed = study%untimed + 1
         end associate
      end do

   contains

      subroutine time_point(i)
         integer, intent(in) :: i
         associate (p => study%points(i), plan => climbers(study%points(i)%candidate)%plan)
            if (p%tolerance > 0) call set_tolerance(climbers(p%candidate)%plan, p%tolerance)
            call time_steps(plan, many, p%h, p%guess, one_run, p%steps, request%compensated, &
                            ns(round, i))
            if (study%members%together == 1) then
               call time_steps(plan, one, p%h, lanes*p%guess, 0.5_dp*one_run, p%steps, &
                               request%compensated, alone(round, i))
            end if
            p%repeats = round
         end associate
      end subroutine time_point

   end subroutine take_times

   !> Points that cost at most `near` times the cheapest of their accuracy, so far.
   pure subroutine near_frontier(points, ns, wanted)
      type(cost_point), intent(in) :: points(:)
      real(dp), intent(in) :: ns(:)             !! of a body-step
      logical, intent(inout) :: wanted(:)
      real(dp), parameter :: near = 2
      real(dp) :: cost_of(size(points)), deviation(size(points))
      integer :: i
      do i = 1, size(points)
         cost_of(i) = ns(i)/points(i)%h
         deviation(i) = huge(deviation)
         if (points(i)%good) deviation(i) = error_of(points(i), of_both, middle)
      end do
      do i = 1, size(points)
         if (.not. wanted(i)) cycle
         wanted(i) = cost_of(i) <= near*minval(cost_of, mask=points%good .and. &
            deviation <= deviation(i))
      end do
   end subroutine near_frontier

   !> Median, least and spread of the repetitions.
   pure subroutine summarise(ns, alone, point)
      real(dp), intent(in) :: ns(:), alone(:)
      type(cost_point), intent(inout) :: point
      if (size(ns) == 0) return
      point%ns = median(ns)
      point%ns_least = minval(ns)
      point%single = median(alone)
      point%ns_spread = half_width(ns)
      point%single_spread = half_width(alone)
   end subroutine summarise

   !> Half the range of the middle half of the values, over their median.
   pure real(dp) function half_width(values)
      real(dp), intent(in) :: values(:)
      half_width = 0
      if (.not. median(values) > 0) return
      half_width = 0.5_dp*(quantile(values, 0.75_dp) - quantile(values, 0.25_dp))/median(values)
   end function half_width

end module poinsot_study_cost_times
