!> The longest step with which a candidate meets a tolerance, and the cheapest candidate: all of
!> them with long steps first; whoever is dearer than a candidate that meets the tolerance already
!> is out.
module poinsot_study_search
   use poinsot_core_kinds, only: dp, i8
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_clock, only: wall_seconds
   use poinsot_study_errors, only: end_state, compare_states
   use poinsot_study_members, only: member_set
   use poinsot_study_statistics, only: median
   use poinsot_study_trial, only: trial_run, run_trial
   use poinsot_core_kinds, only: qp
   implicit none(type, external)
   private
   public :: problem, contender, search_steps, try_steps

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
   end type problem

   !> A candidate in the race. Multiples of the unit, not steps.
   type :: contender
      type(poinsot_plan) :: plan
      integer :: order = 0
      logical :: running = .true.
      integer(i8) :: failed = 0            !! most multiples that did not do
      integer(i8) :: met = 0               !! fewest that did; 0: none yet
      real(dp) :: error = 0                !! with `met` multiples, before the margin
      real(dp) :: own = 0, near = 0        !! the scene's own, and the median of all
      real(dp) :: last = huge(1.0_dp)      !! error of the last try ...
      real(dp) :: paid = 0                 !! ... and its price
      real(dp) :: ns = 0                   !! of a body-step, as seen in passing
      real(dp) :: best_error = huge(1.0_dp)
      integer(i8) :: best_multiple = 0
   end type contender

   real(dp), parameter, public :: usual_slack = 1.6_dp !! seen in passing, times are so uncertain
   real(dp), parameter :: close_enough = 1.06_dp

contains

   !> Run the race. Who is `slack` times dearer than another that meets the tolerance is out: with
   !> usual_slack a choice, with a large one an exhaustive search.
   subroutine search_steps(task, racers, slack, deadline, watch)
      type(problem), intent(in) :: task
      type(contender), intent(inout) :: racers(:)
      real(dp), intent(in) :: slack
      real(dp), intent(in) :: deadline           !! on the wall clock
      class(run_watch), intent(inout) :: watch
      integer(i8) :: multiple
      real(dp) :: begun
      integer :: i
      begun = wall_seconds()
      multiple = 1
      do while (any(racers%running) .and. multiple < 2_i8**40/task%unit)
         do i = 1, size(racers)
            if (.not. racers(i)%running) cycle
            if (wall_seconds() + estimate(task, racers(i), multiple) > deadline .or. &
               watch%stop_now()) then
               racers(i)%running = .false.
               cycle
            end if
            call try_steps(task, multiple, racers(i))
            racers(i)%running = racers(i)%met == 0
            if (racers(i)%running) racers(i)%running = price(racers(i), multiple) <= &
                                                       slack*best_price(racers)
            if (stalled(racers(i), multiple)) racers(i)%running = .false.
            if (beaten(racers, i, 2*slack)) racers(i)%running = .false.
            call watch%tell(wall_seconds() - begun, deadline - begun)
         end do
         multiple = 2*multiple
      end do
      call narrow(task, racers, slack, deadline, watch)
   end subroutine search_steps

   !> Rounding is reached, and shorter steps do not help.
   pure logical function stalled(one, multiple)
      type(contender), intent(in) :: one
      integer(i8), intent(in) :: multiple
      stalled = one%best_multiple > 0 .and. one%best_error < 1e-10_dp .and. &
         multiple >= 8*one%best_multiple
   end function stalled

   !> Another is as accurate for a fraction of the price.
   pure logical function beaten(racers, i, slack)
      type(contender), intent(in) :: racers(:)
      integer, intent(in) :: i
      real(dp), intent(in) :: slack
      beaten = racers(i)%met == 0 .and. racers(i)%last < 0.1_dp .and. &
               any(racers%last <= racers(i)%last .and. slack*racers%paid < racers(i)%paid)
   end function beaten

   !> Seconds that a try will take.
   pure real(dp) function estimate(task, one, multiple)
      type(problem), intent(in) :: task
      type(contender), intent(in) :: one
      integer(i8), intent(in) :: multiple
      estimate = 1e-9_dp*one%ns*task%members%n*real(multiple*task%unit, dp)
   end function estimate

   !> Run one candidate with one step.
   subroutine try_steps(task, multiple, one)
      type(problem), intent(in) :: task
      integer(i8), intent(in) :: multiple
      type(contender), intent(inout) :: one
      type(trial_run) :: run
      real(dp), allocatable :: angle(:), momentum(:)
      real(dp) :: near, own, off
      integer(i8) :: steps
      steps = multiple*task%unit
      call run_trial(one%plan, task%members, task%t_end, steps, 1, .true., run)
      one%ns = 1e9_dp*run%seconds/(real(steps, dp)*task%members%n)
      if (.not. run%good) then
         one%failed = max(one%failed, multiple)
         return
      end if
      call compare_states(real(run%y, qp), real(run%q, qp), task%reference, angle, momentum)
      angle = max(angle, momentum)*task%growth
      near = median(angle)
      own = maxval(angle(:task%members%own))
      off = max(near, own)
      one%last = off
      one%paid = price(one, multiple)
      if (off < 0.7_dp*one%best_error) then
         one%best_error = off
         one%best_multiple = multiple
      end if
      if (off*task%margin <= task%tol) then
         if (one%met > 0 .and. multiple >= one%met) return
         one%met = multiple
         one%error = off
         one%own = own
         one%near = near
      else
         one%failed = max(one%failed, multiple)
      end if
   end subroutine try_steps

   !> Time per unit of simulated time, in units that all racers share.
   pure real(dp) function price(one, multiple)
      type(contender), intent(in) :: one
      integer(i8), intent(in) :: multiple
      price = one%ns*real(multiple, dp)
   end function price

   pure real(dp) function best_price(racers)
      type(contender), intent(in) :: racers(:)
      integer :: i
      best_price = 1e100_dp
      do i = 1, size(racers)
         if (racers(i)%met > 0) best_price = min(best_price, price(racers(i), racers(i)%met))
      end do
   end function best_price

   !> Close in on the fewest steps of those that may still win.
   subroutine narrow(task, racers, slack, deadline, watch)
      type(problem), intent(in) :: task
      type(contender), intent(inout) :: racers(:)
      real(dp), intent(in) :: slack
      real(dp), intent(in) :: deadline
      class(run_watch), intent(inout) :: watch
      integer(i8) :: multiple
      real(dp) :: hope, least
      integer :: i, next, tries
      logical :: closed(size(racers))
      closed = racers%met == 0
      do tries = 1, 20*size(racers)
         next = 0
         least = huge(least)
         do i = 1, size(racers)
            if (closed(i)) cycle
            call guess_multiple(task, racers(i), multiple)
            closed(i) = multiple == 0
            if (closed(i)) cycle
            hope = price(racers(i), max(multiple, racers(i)%failed + 1))
            if (hope > slack*best_price(racers)) closed(i) = .true.
            if (closed(i) .or. hope >= least) cycle
            least = hope
            next = i
         end do
         if (next == 0 .or. watch%stop_now()) return
         call guess_multiple(task, racers(next), multiple)
         if (wall_seconds() + estimate(task, racers(next), multiple) > deadline) return
         call try_steps(task, multiple, racers(next))
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
