!> The largest step size with which a candidate meets a tolerance, and the cheapest candidate: all
!> of them start with large steps; a candidate that costs more than one that meets the tolerance is
!> dropped.
module poinsot_study_search
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_maxima, only: larger, largest_of
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_clock, only: time_limit, now_by, left_of
   use poinsot_study_errors, only: end_state, compare_states
   use poinsot_study_members, only: member_set
   use poinsot_study_statistics, only: median
   use poinsot_study_trial, only: trial_run, run_trial, set_tolerance
   use poinsot_taylor_settings, only: least_tolerance, most_tolerance
   use poinsot_core_kinds, only: qp
   implicit none(type, external)
   private
   public :: problem, contender, search_steps, step_of, run_cost

   !> What has to be solved.
   type :: problem
      type(member_set) :: members
      type(end_state) :: reference
      real(dp) :: t_end = 0                !! to here the candidates run
      real(dp) :: growth = 1               !! errors are so much larger at the scene's own end
      real(dp) :: tol = 0                  !! largest error allowed
      real(dp) :: margin = 1               !! times the error measured must be within
      integer(i8) :: unit = 1 !! steps come in multiples of this (pieces between outputs)
      real(dp) :: longest = 0              !! step with one multiple
      integer(i8) :: pieces = 1            !! calls of `taylor`, which takes no shorter ones
   end type problem

   !> A candidate in the race. Multiples of the unit, not steps.
   type :: contender
      type(poinsot_plan) :: plan
      integer :: order = 0
      logical :: adaptive = .false.        !! a tolerance, `multiple` is 1
      integer(i8) :: unit = 1              !! calls with one multiple
      real(dp) :: longest = 0              !! their length
      logical :: running = .true.
      logical :: late = .false.            !! given up for want of time
      real(dp) :: tolerance = 0            !! of `taylor`, with which it met
      real(dp) :: best_tolerance = 0       !! with which it came nearest
      integer(i8) :: failed = 0            !! most multiples that did not do
      integer(i8) :: met = 0               !! fewest that did; 0: none yet
      real(dp) :: error = 0                !! with `met` multiples, before the margin
      real(dp) :: given = 0, near = 0        !! the scene's own, and the median of all
      real(dp) :: last = huge(1.0_dp)      !! error of the last try ...
      real(dp) :: paid = 0                 !! ... and its price
      real(dp) :: ns = 0                   !! of a body-step, as seen in passing
      real(dp) :: best_error = huge(1.0_dp)
      integer(i8) :: best_multiple = 0
   end type contender

   real(dp), parameter, public :: usual_slack = 1.6_dp !! seen in passing, times are so uncertain
   real(dp), parameter :: close_enough = 1.06_dp
   real(dp), parameter :: usual_share = 0.03_dp !! of its tolerance: the error that `taylor` makes

contains

   !> Run the search. A candidate `slack` times dearer than one that meets the tolerance is out: a
   !> choice with usual_slack, an exhaustive search with a large one.
   subroutine search_steps(task, contenders, slack, limit, watch)
      type(problem), intent(in) :: task
      type(contender), intent(inout) :: contenders(:)
      real(dp), intent(in) :: slack
      type(time_limit), intent(in) :: limit
      class(run_watch), intent(inout) :: watch
      integer(i8) :: multiple
      real(dp) :: begun
      integer :: i
      begun = now_by(limit)
      do i = 1, size(contenders)
         if (.not. (contenders(i)%adaptive .and. contenders(i)%running)) cycle
         call find_tolerance(task, limit, watch, contenders(i))
         contenders(i)%running = .false.
      end do
      multiple = 1
      do while (any(contenders%running) .and. multiple < 2_i8**40/task%unit)
         do i = 1, size(contenders)
            if (.not. contenders(i)%running) cycle
            if (estimate(task, contenders(i), multiple) > left_of(limit) .or. &
               watch%stop_now()) then
               contenders(i)%running = .false.
               contenders(i)%late = .true.
               cycle
            end if
            call try_steps(task, multiple, contenders(i))
            contenders(i)%running = contenders(i)%met == 0
            if (run_cost(contenders(i), multiple) > slack*lowest_cost(contenders)) then
               contenders(i)%running = .false.
            end if
            if (stalled(contenders(i), multiple)) contenders(i)%running = .false.
            if (beaten(contenders, i, 2*slack)) contenders(i)%running = .false.
            call watch%report_progress(now_by(limit) - begun, limit%at - begun)
         end do
         multiple = 2*multiple
      end do
      call narrow(task, contenders, slack, limit, watch)
   end subroutine search_steps

   !> The largest tolerance of `taylor` that does: errors are in proportion to it, down to rounding.
   subroutine find_tolerance(task, limit, watch, one)
      type(problem), intent(in) :: task
      type(time_limit), intent(in) :: limit
      class(run_watch), intent(inout) :: watch
      type(contender), intent(inout) :: one
      type(contender) :: trial
      real(dp) :: next, ratio, low, high
      integer :: tries
      low = 0
      high = huge(high)
      next = task%tol/(task%margin*task%growth*usual_share)
      do tries = 1, 12
         next = min(most_tolerance, max(least_tolerance, two_digits(next)))
         one%late = estimate(task, one, 1_i8) > left_of(limit) .or. watch%stop_now()
         if (one%late) exit
         trial = one
         trial%met = 0
         trial%last = huge(trial%last)
         call set_tolerance(trial%plan, next)
         call try_steps(task, 1_i8, trial)
         ratio = 1e-3_dp
         if (trial%last < 1) ratio = 0.7_dp*task%tol/(task%margin*max(trial%last, &
            tiny(ratio)**0.5_dp))
         if (trial%met > 0) then
            low = next
            one = trial
            if (next >= most_tolerance .or. ratio < 1.6_dp) exit
            next = next*min(ratio, 30.0_dp)
         else
            high = next
            if (low <= 0) one = trial
            if (next <= least_tolerance) exit
            next = next*max(1e-3_dp, min(ratio, 0.3_dp))
         end if
         if (next >= high .or. next <= low) next = sqrt(low*high)
         if (next < 1.3_dp*low) exit
      end do
   end subroutine find_tolerance

   !> A number no larger, of two digits: people read it.
   pure real(dp) function two_digits(x)
      real(dp), intent(in) :: x
      integer :: power
      power = floor(log10(x)) - 1
      two_digits = real(floor(x/10.0_dp**power), dp)*10.0_dp**power
      if (power < 0) two_digits = real(floor(x*10.0_dp**(-power)), dp)/10.0_dp**(-power)
   end function two_digits

   !> The step of a contender with so many multiples.
   pure real(dp) function step_of(one, multiple)
      type(contender), intent(in) :: one
      integer(i8), intent(in) :: multiple
      step_of = one%longest/real(multiple, dp)
   end function step_of

   !> Rounding is reached, and shorter steps do not help.
   pure logical function stalled(one, multiple)
      type(contender), intent(in) :: one
      integer(i8), intent(in) :: multiple
      stalled = one%best_multiple > 0 .and. one%best_error < 1e-10_dp .and. &
         multiple >= 8*one%best_multiple
   end function stalled

   !> Another is as accurate for a fraction of the price.
   pure logical function beaten(contenders, i, slack)
      type(contender), intent(in) :: contenders(:)
      integer, intent(in) :: i
      real(dp), intent(in) :: slack
      beaten = contenders(i)%met == 0 .and. contenders(i)%last < 0.1_dp .and. &
               any(contenders%last <= contenders(i)%last .and. &
                  slack*contenders%paid < contenders(i)%paid)
   end function beaten

   !> Seconds that a try will take.
   pure real(dp) function estimate(task, one, multiple)
      type(problem), intent(in) :: task
      type(contender), intent(in) :: one
      integer(i8), intent(in) :: multiple
      estimate = 1e-9_dp*task%members%n*run_cost(one, multiple)
   end function estimate

   !> Run one candidate with one step.
   subroutine try_steps(task, multiple, one)
      type(problem), intent(in) :: task
      integer(i8), intent(in) :: multiple
      type(contender), intent(inout) :: one
      type(trial_run) :: run
      real(dp), allocatable :: angle(:), momentum(:)
      real(dp) :: near, given, deviation
      integer(i8) :: steps
      steps = multiple*one%unit
      call run_trial(one%plan, task%members, task%t_end, steps, 1, .true., run)
      one%ns = 1e9_dp*run%seconds/(real(steps, dp)*task%members%n)
      if (.not. run%good) then
         one%failed = max(one%failed, multiple)
         return
      end if
      call compare_states(real(run%y, qp), real(run%q, qp), task%reference, angle, momentum)
      angle = larger(angle, momentum)*task%growth
      near = median(angle)
      given = largest_of(angle(:task%members%given))
      deviation = larger(near, given)
      one%last = deviation
      one%paid = run_cost(one, multiple)
      if (deviation < 0.7_dp*one%best_error) then
         one%best_error = deviation
         one%best_multiple = multiple
         one%best_tolerance = one%plan%tolerance
      end if
      if (deviation*task%margin <= task%tol) then
         if (one%met > 0 .and. multiple >= one%met .and. .not. one%adaptive) return
         one%met = multiple
         one%tolerance = one%plan%tolerance
         one%error = deviation
         one%given = given
         one%near = near
      else
         one%failed = max(one%failed, multiple)
      end if
   end subroutine try_steps

   !> Time per unit of simulated time, in units that all candidates share.
   pure real(dp) function run_cost(one, multiple)
      type(contender), intent(in) :: one
      integer(i8), intent(in) :: multiple
      run_cost = one%ns*real(multiple*one%unit, dp)
   end function run_cost

   pure real(dp) function lowest_cost(contenders)
      type(contender), intent(in) :: contenders(:)
      integer :: i
      lowest_cost = 1e100_dp
      do i = 1, size(contenders)
         if (contenders(i)%met > 0) lowest_cost = min(lowest_cost, run_cost(contenders(i), &
            contenders(i)%met))
      end do
   end function lowest_cost

   !> Close in on the fewest steps of those that may still win.
   subroutine narrow(task, contenders, slack, limit, watch)
      type(problem), intent(in) :: task
      type(contender), intent(inout) :: contenders(:)
      real(dp), intent(in) :: slack
      type(time_limit), intent(in) :: limit
      class(run_watch), intent(inout) :: watch
      integer(i8) :: multiple
      real(dp) :: expected, least
      integer :: i, next, tries
      logical :: closed(size(contenders))
      closed = contenders%met == 0
      do tries = 1, 20*size(contenders)
         next = 0
         least = huge(least)
         do i = 1, size(contenders)
            if (closed(i)) cycle
            call guess_multiple(task, contenders(i), multiple)
            closed(i) = multiple == 0
            if (closed(i)) cycle
            expected = run_cost(contenders(i), max(multiple, contenders(i)%failed + 1))
            if (expected > slack*lowest_cost(contenders)) closed(i) = .true.
            if (closed(i) .or. expected >= least) cycle
            least = expected
            next = i
         end do
         if (next == 0 .or. watch%stop_now()) return
         call guess_multiple(task, contenders(next), multiple)
         if (estimate(task, contenders(next), multiple) > left_of(limit)) return
         call try_steps(task, multiple, contenders(next))
      end do
   end subroutine narrow

   !> The next number to try between what failed and what met the tolerance: by the order, kept
   !> inside; 0 when there is no use.
   pure subroutine guess_multiple(task, one, multiple)
      type(problem), intent(in) :: task
      type(contender), intent(in) :: one
      integer(i8), intent(out) :: multiple
      real(dp) :: ratio, low, high
      multiple = 0
      if (one%met <= 1) return
      low = real(max(one%failed, 1_i8), dp)
      high = real(one%met, dp)
      if (one%failed >= one%met .or. one%met - one%failed <= 1) return
      if (one%failed > 0 .and. high/low < close_enough) return
      ratio = sqrt(low/high)
      if (one%order > 0 .and. one%error > 0) then
         ratio = max(ratio, (one%error*task%margin/(0.97_dp*task%tol))**(1.0_dp/one%order))
      end if
      multiple = nint(high*min(ratio, 0.97_dp), i8)
      multiple = max(one%failed + 1, min(one%met - 1, multiple))
   end subroutine guess_multiple

end module poinsot_study_search
