!> Clocks. Work on one thread is timed by the processor's own time, which stands still while another
!> program has the processor; budgets are kept by the clock on the wall.
module poinsot_study_clock
   use poinsot_core_kinds, only: dp, i8
   implicit none(type, external)
   private
   public :: processor_seconds, wall_seconds

contains

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
