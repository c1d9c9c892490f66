!> The request for a choice, and the result.
module poinsot_study_choice
   use poinsot_core_kinds, only: dp, i8
   use poinsot_scene_settings, only: scene_settings
   use poinsot_study_candidates, only: candidate, plan_splitting, no_splitting
   use poinsot_study_choose_growth, only: error_growth
   implicit none(type, external)
   private
   public :: choose_request, choice, chosen, chosen_scene

   !> The request.
   type :: choose_request
      real(dp) :: tol = 1e-8_dp                !! attitude in radians, momentum relative, at the end
      real(dp) :: budget = 20                  !! seconds of the processor
      character(24), allocatable :: methods(:), splittings(:)  !! size 0: all
      real(dp) :: longest = 0                  !! longest step allowed; 0: as the outputs have it
   end type choose_request

   !> One way, and what it promises.
   type :: chosen
      type(candidate) :: setup
      real(dp) :: h = 0
      real(dp) :: tolerance = 0                !! of `taylor`; 0 of others
      real(dp) :: error = 0                    !! of the scene's own bodies at its end
      real(dp) :: near = 0                     !! median of those and states near them
      real(dp) :: ns = 0                       !! of a body-step, one thread
      real(dp) :: run = 0                      !! seconds of the whole run, one thread
   end type chosen

   !> How a choice ended.
   integer, parameter, public :: tolerance_kept = 0   !! within the tolerance
   integer, parameter, public :: time_ran_out = 1     !! before anything was
   integer, parameter, public :: out_of_reach = 2     !! rounding, or the order of what was named
   integer, parameter, public :: motion_chaotic = 3   !! nothing can be, to the scene's end

   !> The result.
   type :: choice
      type(chosen) :: best, runner_up          !! %h = 0: there is none
      integer :: ended = tolerance_kept
      logical :: checked = .false.             !! all bodies, the whole run
      type(error_growth) :: growth             !! where the motion is chaotic
      character(:), allocatable :: reference   !! how errors were measured
      real(dp) :: t_measured = 0 !! to which time; the scene's end if it was near enough
      integer :: bodies = 0, given = 0         !! states tried, the scene's own among them
      integer(i8) :: total = 0                 !! bodies of the scene
      integer :: candidates = 0                !! that came through
      integer :: late = 0                      !! that were given up for want of time
      logical :: noisy = .false.               !! the scene has noise, the trials had not
      real(dp) :: seconds = 0                  !! of the processor, spent
   end type choice

contains

   !> A scene with a choice filled in.
   pure function chosen_scene(scene, best) result(filled)
      type(scene_settings), intent(in) :: scene
      type(chosen), intent(in) :: best
      type(scene_settings) :: filled
      filled = scene
      filled%method = trim(best%setup%method)
      if (filled%splitting == "auto" .or. best%setup%splitting /= no_splitting) then
         filled%splitting = plan_splitting(best%setup)
      end if
      filled%h = best%h
      if (best%setup%adaptive) filled%tolerance = best%tolerance
   end function chosen_scene

end module poinsot_study_choice
