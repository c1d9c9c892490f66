!> The progress of a run, on one line of the terminal; and whether the user asked it to stop.
module app_progress
   use, intrinsic :: iso_fortran_env, only: error_unit
   use poinsot_core_kinds, only: dp, i8
   use poinsot_scene_watch, only: run_watch
   use poinsot_scene_text, only: text_of
   use app_terminal, only: was_interrupted
   implicit none(type, external)
   private
   public :: progress_watch

   real(dp), parameter :: pause = 0.2_dp !! seconds between two lines

   !> The watch of a run started from the command line.
   type, extends(run_watch) :: progress_watch
      logical :: shown = .false.           !! there is a terminal to show it on
      logical :: dirty = .false.           !! the line has been written
      integer(i8) :: last = 0              !! clock at the last line
      character(9) :: clock = ""  !! of a study whose progress is its budget: wall, processor
      character(9) :: things = "" !! of a study that counts: methods, cases
      integer(i8) :: begun = 0             !! clock at the first line of a run,
      real(dp) :: t_begun = 0              !! and the time that it had reached
   contains
      procedure :: stop_now
      procedure :: report_progress
      procedure :: wipe
   end type progress_watch

contains

   logical function stop_now(self)
      class(progress_watch), intent(inout) :: self
      associate (unused => self)
      end associate
      stop_now = was_interrupted()
   end function stop_now

   subroutine report_progress(self, t, t_end)
      class(progress_watch), intent(inout) :: self
      real(dp), intent(in) :: t, t_end
      integer(i8) :: now, rate
      character(:), allocatable :: line
      if (.not. self%shown) return
      call system_clock(now, rate)
      if (real(now - self%last, dp) < pause*real(rate, dp)) return
      self%last = now
      self%dirty = .true.
      if (len_trim(self%clock) > 0) then
         write (error_unit, "(a, i3, a)", advance="no") achar(13), int(100*t/t_end), " %  " // &
            text_of(nint(t)) // " of " // text_of(nint(t_end)) // " " // trim(self%clock) // &
            " seconds, at most " // text_of(max(0, nint(t_end - t))) // " left    "
      else
         if (self%begun == 0 .or. t < self%t_begun) then
            self%begun = now
            self%t_begun = t
         end if
         line = progress_line(trim(self%things), t, t_end, self%t_begun, &
            real(now - self%begun, dp)/real(rate, dp))
         write (error_unit, "(a)", advance="no") achar(13) // line // &
            repeat(" ", max(0, 70 - len(line)))
      end if
      flush (error_unit)
   end subroutine report_progress

   !> " 42 %  t = 4.2 of 10.0, 12 s left", or " 42 %  5 of 12 methods, 12 s left"
   pure function progress_line(things, t, t_end, t_begun, seconds) result(line)
      character(*), intent(in) :: things !! that are counted; "": time is
      real(dp), intent(in) :: t, t_end !! time reached, and that of the end
      real(dp), intent(in) :: t_begun  !! where the clock began
      real(dp), intent(in) :: seconds  !! since then
      character(:), allocatable :: line
      character(16) :: number
      real(dp) :: left
      write (number, "(i3)") int(100*t/t_end)
      line = trim(number) // " %  "
      if (things /= "") then
         line = line // text_of(nint(t)) // " of " // text_of(nint(t_end)) // " " // things
      else
         write (number, "(g0.4)") t
         line = line // "t = " // trim(adjustl(number)) // " of " // text_of(t_end)
      end if
      if (seconds < 1 .or. .not. t > t_begun) return
      left = seconds*((t_end - t)/(t - t_begun))
      if (left >= 5400) then
         write (number, "(f12.1)") left/3600
         line = line // ", " // trim(adjustl(number)) // " h left"
      else if (left >= 90) then
         write (number, "(i0)") nint(left/60)
         line = line // ", " // trim(number) // " min left"
      else
         write (number, "(i0)") nint(left)
         line = line // ", " // trim(number) // " s left"
      end if
   end function progress_line

   !> Take the line away.
   subroutine wipe(self)
      class(progress_watch), intent(inout) :: self
      if (self%dirty) then
         write (error_unit, "(a)", advance="no") achar(13) // repeat(" ", 70) // achar(13)
      end if
      flush (error_unit)
      self%dirty = .false.
   end subroutine wipe

end module app_progress
