!> When a scene steps and when it writes. The run is cut at its output times; each piece is cut into
!> equal steps no longer than h. Everything is a function of the piece's number, never of history,
!> so that a run continued from a restart takes the very same steps.
module poinsot_scene_schedule
   use poinsot_core_kinds, only: dp, i8
   use poinsot_scene_settings, only: scene_settings
   implicit none(type, external)
   private
   public :: piece, piece_count, get_piece, step_total, output_count

   real(dp), parameter :: near = 1e-10_dp !! two times or lengths this near, relatively, are the
                                          !! same

   !> From one output (or the start) to the next (or the end).
   type :: piece
      real(dp) :: from = 0, to = 0   !! times
      real(dp) :: h = 0              !! length of each step
      integer(i8) :: steps = 0       !! number of steps
      logical :: writes = .false.    !! is `to` an output time?
   end type piece

contains

   !> How many pieces the run has.
   pure integer(i8) function piece_count(scene) result(pieces)
      type(scene_settings), intent(in) :: scene !! the typed scene
      integer :: n
      if (.not. scene%output%present) then
         pieces = 1
      else if (scene%output%every > 0) then
         pieces = ceiling(scene%t_end/scene%output%every*(1 - near), i8)
      else
         n = size(scene%output%times)
         pieces = n
         if (scene%output%times(1) <= 0) pieces = pieces - 1
         if (scene%output%times(n) < scene%t_end) pieces = pieces + 1
      end if
      pieces = max(pieces, 1_i8)
   end function piece_count

   !> The k-th piece, counted from 1.
   pure function get_piece(scene, k) result(part)
      type(scene_settings), intent(in) :: scene !! the typed scene
      integer(i8), intent(in) :: k              !! 1 to piece_count
      type(piece) :: part
      part%from = border(scene, k - 1)
      part%to = border(scene, k)
      part%writes = writes_at(scene, k)
      part%steps = 1
      part%h = part%to - part%from
      if (scene%h <= 0 .or. part%h <= scene%h) then
         if (abs(part%h - scene%h) <= near*scene%h) part%h = scene%h
         return
      end if
      part%steps = ceiling(part%h/scene%h*(1 - near), i8)
      part%h = part%h/real(part%steps, dp)
      if (abs(part%h - scene%h) <= near*scene%h) part%h = scene%h
   end function get_piece

   !> Time at the end of the k-th piece; 0 for k = 0.
   pure real(dp) function border(scene, k)
      type(scene_settings), intent(in) :: scene
      integer(i8), intent(in) :: k
      integer(i8) :: skipped
      border = 0
      if (k == 0) return
      border = scene%t_end
      if (k >= piece_count(scene)) return
      if (scene%output%every > 0) then
         border = real(k, dp)*scene%output%every
      else
         skipped = merge(1, 0, scene%output%times(1) <= 0)
         border = scene%output%times(k + skipped)
      end if
   end function border

   pure logical function writes_at(scene, k)
      type(scene_settings), intent(in) :: scene
      integer(i8), intent(in) :: k
      writes_at = scene%output%present
      if (.not. scene%output%present .or. scene%output%every > 0) return
      writes_at = k < piece_count(scene) .or. &
         scene%output%times(size(scene%output%times)) >= scene%t_end
   end function writes_at

   !> Steps of the whole run, as a real: an absurd h must not overflow.
   pure real(dp) function step_total(scene) result(steps)
      type(scene_settings), intent(in) :: scene !! the typed scene
      steps = max(output_count(scene) - 1, 1.0_dp)
      if (scene%h > 0) steps = max(steps, scene%t_end/scene%h)
   end function step_total

   !> Outputs of the whole run, as a real.
   pure real(dp) function output_count(scene) result(outputs)
      type(scene_settings), intent(in) :: scene !! the typed scene
      outputs = 0
      if (.not. scene%output%present) return
      if (scene%output%every > 0) then
         outputs = 1 + scene%t_end/scene%output%every
      else
         outputs = size(scene%output%times)
      end if
   end function output_count

end module poinsot_scene_schedule
