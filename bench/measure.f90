!> Timing on a machine that others use too: short runs of many candidates in turn, so that what
!> disturbs one disturbs all; the median, the minimum and the spread of the repetitions are kept.
!> One thread is timed by the processor's time, which does not run while another program has the
!> processor. The gain from a second thread is timed by the clock on the wall, and that needs a
!> machine at rest.
module bench_measure
   use poinsot_core_kinds, only: dp, i8
   use poinsot_study_statistics, only: quantile
   implicit none(type, external)
   private
   public :: task, task_item, measure, median, minimum, spread_of, median_cpu, clock_rate

   !> Something to be timed.
   type, abstract :: task
      character(24) :: name = ""
      character(16) :: section = ""           !! of the table
      character(10) :: layout = "rows"
      integer :: order = 0                    !! 0: exact
      integer :: n = 0                        !! bodies
      integer :: steps = 1                    !! in one call
      integer :: calls = 1                    !! in one run
      integer :: threads = 1
      logical :: wall = .false.               !! time by the clock on the wall
      real(dp) :: phase = 0                   !! largest h |omega|
      logical :: failed = .false.             !! it could not do it
      real(dp), allocatable :: ns(:)          !! per body-step, one value a repetition
      real(dp), allocatable :: cpu(:)         !! the same by processor time, all threads together
   contains
      procedure :: prepare                    !! before each run, not timed
      procedure(run_task), deferred :: run    !! what is timed
   end type task

   type :: task_item
      class(task), allocatable :: it
   end type task_item

   abstract interface
      subroutine run_task(self)
         import :: task
         implicit none(type, external)
         class(task), intent(inout) :: self
      end subroutine run_task
   end interface

contains

   subroutine prepare(self)
      class(task), intent(inout) :: self
      associate (unused => self%n)
      end associate
   end subroutine prepare

   !> Time all tasks `repeats` times in turn, after one run of each that is not counted. A task that
   !> takes long is left out of later rounds once the budget is spent; each has three repetitions at
   !> least.
   subroutine measure(tasks, repeats, budget)
      type(task_item), intent(inout) :: tasks(:)
      integer, intent(in) :: repeats
      real(dp), intent(in) :: budget           !! seconds for all
      integer :: i, k, done
      real(dp) :: first, start, start_cpu, scale
      real(dp), dimension(repeats, size(tasks)) :: wall, cpu

      first = now(.true.)
      do i = 1, size(tasks)
         call tasks(i)%it%prepare()
         call run_calls(tasks(i)%it)
      end do
      done = 0
      do k = 1, repeats
         do i = 1, size(tasks)
            associate (one => tasks(i)%it)
               if (one%failed) cycle
               call one%prepare()
               scale = 1e9_dp/(real(one%n, dp)*one%steps*one%calls)
               start = now(.true.)
               start_cpu = now(.false.)
               call run_calls(one)
               cpu(k, i) = scale*(now(.false.) - start_cpu)
               wall(k, i) = scale*(now(.true.) - start)
            end associate
         end do
         done = k
         if (k >= 3 .and. now(.true.) - first > budget) exit
      end do
      do i = 1, size(tasks)
         tasks(i)%it%cpu = cpu(1:done, i)
         tasks(i)%it%ns = merge(wall(1:done, i), cpu(1:done, i), tasks(i)%it%wall)
      end do
   end subroutine measure

   subroutine run_calls(one)
      class(task), intent(inout) :: one
      integer :: k
      do k = 1, one%calls
         call one%run()
      end do
   end subroutine run_calls

   !> Seconds: of the wall, or of the processor, all threads of this program together.
   real(dp) function now(wall)
      logical, intent(in) :: wall
      integer(i8) :: ticks, rate
      if (wall) then
         call system_clock(ticks, rate)
         now = real(ticks, dp)/real(rate, dp)
      else
         call cpu_time(now)
      end if
   end function now

   !> Clock of the processor in GHz, from a chain of integer multiplications and additions: 5 cycles
   !> a link (multiplication 3, and 1, addition 1) on the processors of the last ten years.
   real(dp) function clock_rate(factor, term)
      integer(i8), intent(in) :: factor, term   !! any odd numbers the compiler does not know
      integer, parameter :: links = 2000000
      integer(i8) :: x
      integer :: i, k
      real(dp) :: start
      clock_rate = 0
      do k = 1, 9
         x = term
         start = now(.false.)
         do i = 1, links
            x = iand(x*factor, huge(x)/2) + term
         end do
         start = now(.false.) - start
         if (x /= 0 .and. start > 0) clock_rate = max(clock_rate, 5e-9_dp*links/start)
      end do
   end function clock_rate

   !> Median of the repetitions, ns per body-step.
   pure real(dp) function median(one)
      class(task), intent(in) :: one
      median = quantile(one%ns, 0.5_dp)
   end function median

   !> The same by processor time, all threads together.
   pure real(dp) function median_cpu(one)
      class(task), intent(in) :: one
      median_cpu = quantile(one%cpu, 0.5_dp)
   end function median_cpu

   pure real(dp) function minimum(one)
      class(task), intent(in) :: one
      minimum = minval(one%ns)
   end function minimum

   !> Half the middle half of the repetitions, relative to the median.
   pure real(dp) function spread_of(one)
      class(task), intent(in) :: one
      spread_of = 0.5_dp*(quantile(one%ns, 0.75_dp) - quantile(one%ns, 0.25_dp))/median(one)
   end function spread_of

end module bench_measure
