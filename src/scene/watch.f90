!> How a run asks its caller whether to continue, and reports its progress. The library prints
!> nothing and has no global flag: a program extends this type (app/: progress on the terminal,
!> SIGINT).
module poinsot_scene_watch
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: run_watch

   !> Does nothing and never stops; extend it.
   type :: run_watch
   contains
      procedure :: stop_now
      procedure :: report_progress
      procedure :: wipe
   end type run_watch

contains

   !> Should the run end at the next step boundary? Asked several times a second.
   logical function stop_now(self)
      class(run_watch), intent(inout) :: self
      associate (unused => self)
      end associate
      stop_now = .false.
   end function stop_now

   !> How far the run is.
   subroutine report_progress(self, t, t_end)
      class(run_watch), intent(inout) :: self
      real(dp), intent(in) :: t     !! time reached
      real(dp), intent(in) :: t_end !! time wanted
      associate (unused_1 => self, unused_2 => t, unused_3 => t_end)
      end associate
   end subroutine report_progress

   !> Make room on the terminal: a line of a table follows.
   subroutine wipe(self)
      class(run_watch), intent(inout) :: self
      associate (unused => self)
      end associate
   end subroutine wipe

end module poinsot_scene_watch
