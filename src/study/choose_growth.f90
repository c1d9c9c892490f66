!> Growth of errors where no choice meets the tolerance: bodies followed by `taylor` at its smallest
!> tolerance, compared with quadruple precision.
module poinsot_study_choose_growth
   use poinsot_core_kinds, only: dp, i8, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_settings, only: scene_settings
   use poinsot_study_clock, only: time_limit, part_of
   use poinsot_study_errors, only: end_state, compare_states
   use poinsot_study_members, only: member_set
   use poinsot_study_torque_reference, only: turn_in_time
   use poinsot_study_torque_series, only: torque_problem, torque_problems, coarse
   use poinsot_study_trial, only: make_plan, set_tolerance, integrate
   use poinsot_taylor_settings, only: least_tolerance
   implicit none(type, external)
   private
   public :: error_growth, find_growth

   integer, parameter :: half = 32, looks = 9*half !! at errors that grow
   real(dp), parameter :: chaotic_gain = 30      !! in the second half of the time, at least
   real(dp), parameter :: full_grown = 0.1_dp    !! radians

   !> How the errors of the most accurate run grow.
   type :: error_growth
      logical :: known = .false.
      logical :: chaotic = .false.
      real(dp) :: fold = 0                       !! the time in which they grow e-fold
      real(dp) :: holds = 0                      !! the tolerance holds to this time; beyond what
         !! was followed by the growth so far
   end type error_growth

contains

   !> Follow some bodies by `taylor` at its finest beside quadruple precision: do errors grow
   !> exponentially, how fast, and how long does a tolerance hold? Each is followed until its error
   !> is full grown, or its part of the time is over. Not known where the torques are no data.
   subroutine find_growth(scene, members, at, tol, limit, growth)
      type(scene_settings), intent(in) :: scene
      type(member_set), intent(in) :: members
      integer, intent(in) :: at(:)               !! which of them: the worst
      real(dp), intent(in) :: tol
      type(time_limit), intent(in) :: limit
      type(error_growth), intent(out) :: growth
      type(torque_problem), allocatable :: problems(:)
      type(poinsot_plan) :: plan
      type(poinsot_error) :: refused
      real(dp) :: times(0:looks), errors(0:looks)
      integer :: i, last
      call make_plan(scene, "exact", "taylor", plan, refused)
      if (.not. raised(refused)) call torque_problems(plan, problems, refused)
      if (raised(refused)) return
      call set_tolerance(plan, least_tolerance)
      growth%holds = scene%t_end
      times = scene%t_end*look_times()
      do i = 1, size(at)
         call errors_of(plan, problems, members, at(i), times, part_of(limit, merge(0.6_dp, &
            1.0_dp, i < size(at))), errors, last)
         if (last > 0) call judge_growth(times(:last), errors(:last), scene%t_end, tol, growth)
      end do
   end subroutine find_growth

   !> When to look, in parts of the whole time: first at equal distances, doubled each time the time
   !> is.
   pure function look_times() result(times)
      real(dp) :: times(0:looks)
      real(dp) :: apart
      integer :: j
      apart = 1
      times(0) = 0
      do j = 1, looks
         times(j) = times(j - 1) + apart
         if (j >= 2*half .and. mod(j, half) == 0) apart = 2*apart
      end do
      times = times/times(looks)
   end function look_times

   !> What the errors of one body say.
   pure subroutine judge_growth(times, errors, t_end, tol, growth)
      real(dp), intent(in) :: times(0:), errors(0:)   !! one look at least behind the start
      real(dp), intent(in) :: t_end, tol
      type(error_growth), intent(inout) :: growth
      real(dp) :: fold, holds, before
      integer :: last, beyond
      last = ubound(errors, 1)
      beyond = findloc(errors > tol, .true., 1) - 1
      holds = t_end
      if (beyond > 0) holds = times(beyond - 1)
      before = maxval(errors, mask=times <= 0.5_dp*times(last))
      fold = 0
      if (errors(last) > chaotic_gain*max(before, epsilon(before))) fold = fold_of(times, errors)
      if (fold > 0) then
         if (beyond < 0) holds = min(t_end, times(last) + fold*log(tol/errors(last)))
         growth%chaotic = growth%chaotic .or. holds < t_end
         if (growth%fold > 0) fold = min(fold, growth%fold)
         growth%fold = fold
      end if
      growth%holds = min(holds, merge(growth%holds, t_end, growth%known))
      growth%known = .true.
   end subroutine judge_growth

   !> Errors of one body, until they are full grown or the time is over.
   subroutine errors_of(plan, problems, members, k, times, limit, errors, last)
      type(poinsot_plan), intent(in) :: plan
      type(torque_problem), intent(in) :: problems(:)
      type(member_set), intent(in) :: members
      integer, intent(in) :: k
      real(dp), intent(in) :: times(0:looks)
      type(time_limit), intent(in) :: limit
      real(dp), intent(out) :: errors(0:looks)
      integer, intent(out) :: last               !! looks that came to an end
      type(member_set) :: one
      type(end_state) :: state
      real(dp), allocatable :: y(:, :), q(:, :), carry(:, :), angle(:), momentum(:)
      real(dp) :: h
      integer :: j
      logical :: done
      one%n = 1
      one%given = 1
      one%group = members%group(k:k)
      y = members%y(:, k:k)
      q = members%q(:, k:k)
      state%y = y
      state%q = q
      allocate (carry(7, 1), source=0.0_dp)
      errors = 0
      last = 0
      do j = 1, looks
         call turn_in_time(problems(one%group(1)), coarse, real(times(j - 1), qp), &
            real(times(j), qp), limit, state%y(:, 1), state%q(:, 1), done)
         h = times(j) - times(j - 1)
         if (done) call integrate(plan, one, h, 0_i8, 1_i8, y, q, carry, done, times(j - 1))
         if (.not. done) return
         call compare_states(real(y, qp), real(q, qp), state, angle, momentum)
         errors(j) = max(angle(1), momentum(1))
         last = j
         if (errors(j) > full_grown) return
      end do
   end subroutine errors_of

   !> The time of an e-fold growth: the line through the logarithms, from rounding to the end.
   pure real(dp) function fold_of(times, errors) result(fold)
      real(dp), intent(in) :: times(0:), errors(0:)
      real(dp) :: t(size(times)), e(size(times)), rate
      logical :: late(size(times))
      late = times >= 0.25_dp*times(ubound(times, 1))
      fold = times(ubound(times, 1))/log(max(errors(ubound(errors, 1))/epsilon(fold), 2.0_dp))
      if (count(late) < 3) return ! full grown at the first look or two
      t = times - sum(times, mask=late)/count(late)
      e = log(max(errors, 1e-17_dp))
      rate = sum(t*e, mask=late)/sum(t**2, mask=late)
      fold = 0
      if (rate > 0) fold = 1/rate
   end function fold_of

end module poinsot_study_choose_growth
