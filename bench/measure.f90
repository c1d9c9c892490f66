!> Timing on a machine that others use too: short runs of many candidates in turn, so that what disturbs
!> one disturbs all; the median, the minimum and the spread of the repetitions are kept.
module bench_measure
   use poinsot_core_kinds, only: dp, i8
   implicit none(type, external)
   private
   public :: task, task_item, measure, median, minimum, spread_of

   !> Something to be timed.
   type, abstract :: task
      character(24) :: name = ""
      character(16) :: section = ""           !! of the table
      character(10) :: layout = "rows"
      integer :: order = 0                    !! 0: exact
      integer :: n = 0                        !! bodies
      integer :: steps = 1                    !! in one run
      integer :: threads = 1
      real(dp) :: phase = 0                   !! largest h |omega|
      logical :: failed = .false.             !! it could not do it
      real(dp), allocatable :: ns(:)          !! per body-step, one value a repetition
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

   !> Time all tasks `repeats` times in turn, after one run of each that is not counted. A task that takes long is left out of
   !> later rounds once the budget is spent; each has three repetitions at least.
   subroutine measure(tasks, repeats, budget)
      type(task_item), intent(inout) :: tasks(:)
      integer, intent(in) :: repeats
      real(dp), intent(in) :: budget           !! seconds for all
      integer :: i, k, done
      integer(i8) :: start, finish, first, rate
      real(dp) :: ns(repeats, size(tasks))

      call system_clock(first, rate)
      do i = 1, size(tasks)
         call tasks(i)%it%prepare()
         call tasks(i)%it%run()
      end do
      done = 0
      do k = 1, repeats
         do i = 1, size(tasks)
            associate (one => tasks(i)%it)
               if (one%failed) cycle
               call one%prepare()
               call system_clock(start)
               call one%run()
               call system_clock(finish)
               ns(k, i) = 1e9_dp*real(finish - start, dp)/real(rate, dp)/(real(one%n, dp)*one%steps)
            end associate
         end do
         done = k
         call system_clock(finish)
         if (k >= 3 .and. real(finish - first, dp) > budget*real(rate, dp)) exit
      end do
      do i = 1, size(tasks)
         tasks(i)%it%ns = ns(1:done, i)
      end do
   end subroutine measure

   !> Median of the repetitions, ns per body-step.
   pure real(dp) function median(one)
      class(task), intent(in) :: one
      median = quantile(one%ns, 0.5_dp)
   end function median

   pure real(dp) function minimum(one)
      class(task), intent(in) :: one
      minimum = minval(one%ns)
   end function minimum

   !> Half the middle half of the repetitions, relative to the median.
   pure real(dp) function spread_of(one)
      class(task), intent(in) :: one
      spread_of = 0.5_dp*(quantile(one%ns, 0.75_dp) - quantile(one%ns, 0.25_dp))/median(one)
   end function spread_of

   !> Quantile between neighbours in order.
   pure real(dp) function quantile(x, part)
      real(dp), intent(in) :: x(:), part
      real(dp) :: s(size(x)), place, keep
      integer :: i, j
      s = x
      do i = 2, size(s)
         keep = s(i)
         do j = i - 1, 1, -1
            if (s(j) <= keep) exit
            s(j + 1) = s(j)
         end do
         s(j + 1) = keep
      end do
      place = 1 + part*(size(s) - 1)
      i = min(int(place), max(1, size(s) - 1))
      j = min(i + 1, size(s))
      quantile = s(i) + (place - i)*(s(j) - s(i))
   end function quantile

end module bench_measure
