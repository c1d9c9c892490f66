!> Clocks. Work on one thread is timed by processor time, which does not advance while another
!> program has the processor. A budget is wall-clock time where the user waits for the result
!> (`cost`), and processor time where the result must not depend on other programs (`choose`).
module poinsot_study_clock
   use poinsot_core_kinds, only: dp, i8
   implicit none(type, external)
   private
   public :: processor_seconds, wall_seconds, time_limit, limit_in, part_of, now_by, left_of

   !> When to be done.
   type :: time_limit
      logical :: wall = .true.        !! by the clock on the wall; else by the processor's time
      real(dp) :: at = 0
   end type time_limit

contains

   !> So many seconds from now.
   type(time_limit) function limit_in(seconds, wall)
      real(dp), intent(in) :: seconds
      logical, intent(in) :: wall
      limit_in%wall = wall
      limit_in%at = now_by(limit_in) + seconds
   end function limit_in

   !> A part of the remaining time.
   type(time_limit) function part_of(limit, share)
      type(time_limit), intent(in) :: limit
      real(dp), intent(in) :: share
      part_of = limit_in(share*left_of(limit), limit%wall)
   end function part_of

   !> Seconds on the clock of a limit.
   real(dp) function now_by(limit)
      type(time_limit), intent(in) :: limit
      if (limit%wall) then
         now_by = wall_seconds()
      else
         now_by = processor_seconds()
      end if
   end function now_by

   !> Seconds left, negative if it is over.
   real(dp) function left_of(limit)
      type(time_limit), intent(in) :: limit
      left_of = limit%at - now_by(limit)
   end function left_of


   !> Seconds this program has had of the processor.
   real(dp) function processor_seconds()
      call cpu_time(processor_seconds)
   end function processor_seconds

   !> Seconds on some clock.
   real(dp) function wall_seconds()
      integer(i8) :: count, rate
      call system_clock(count, rate)
      wall_seconds = real(count, dp)/real(max(rate, 1_i8), dp)
   end function wall_seconds

end module poinsot_study_clock
