!> How far a run is, on one line of the terminal; and whether the user asked it to stop.
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
         write (error_unit, "(a, i3, a)", advance="no") achar(13), int(100*t/t_end), " %  t = " // &
            text_of(real(real(t), dp)) // " of " // text_of(t_end) // "    "
      end if
      flush (error_unit)
   end subroutine report_progress

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
