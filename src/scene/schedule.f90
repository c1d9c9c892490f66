!> The times of steps and outputs of a scene. The run is divided at its output times, each piece
!> into equal steps no longer than h. Everything is a function of the number of the piece, never of
!> history, so that a run continued from a restart takes the same steps.
module poinsot_scene_schedule
   use poinsot_core_kinds, only: dp, i8
   use poinsot_effect_effect, only: effect, torque_effect
   use poinsot_scene_settings, only: scene_settings
   implicit none(type, external)
   private
   public :: piece, piece_count, get_piece, whole_steps, knot_within_step, step_total, output_count

   real(dp), parameter :: near = 1e-10_dp
   !! an output this near t_end, relative to `every`, is there
   real(dp), parameter :: rounding = 8*epsilon(1.0_dp) !! of the times of a piece

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
         if (abs(part%h - scene%h) <= rounding*part%to) part%h = scene%h
         return
      end if
      part%steps = whole_steps(part%from, part%to, scene%h)
      part%h = part%h/real(part%steps, dp)
      if (abs(part%h - scene%h)*part%steps <= rounding*part%to) part%h = scene%h
   end function get_piece

   !> How many steps no longer than h from one time to another. Of two times only rounding may make
   !> a
   !> step longer than h, never a part of a step shared out among the others.
   pure integer(i8) function whole_steps(from, to, h)
      real(dp), intent(in) :: from, to !! times, from < to
      real(dp), intent(in) :: h        !! positive
      real(dp) :: wished
      wished = (to - from)/h
      whole_steps = max(1_i8, ceiling(wished - min(rounding*(to/h), 0.01_dp), i8))
   end function whole_steps

   !> The first knot of a table of torques that lies within a step: there a scheme has order 2,
   !> whatever its own. Negative if all knots are ends of steps, or beyond the run.
   subroutine knot_within_step(scene, knot, name)
      type(scene_settings), intent(in) :: scene              !! the typed scene
      real(dp), intent(out) :: knot                          !! its time
      character(:), allocatable, intent(out) :: name         !! of the effect that has the table
      integer :: i, k, j
      knot = -1
      name = ""
      do i = 1, size(scene%effects)
         if (.not. is_torque(scene%effects(i)%made)) cycle
         do k = 1, size(scene%effects(i)%settings)
            if (scene%effects(i)%settings(k)%key /= "times") cycle
            associate (times => scene%effects(i)%settings(k)%values)
               do j = 1, size(times)
                  if (.not. is_within_step(scene, times(j))) cycle
                  if (knot < 0 .or. times(j) < knot) then
                     knot = times(j)
                     name = scene%effects(i)%name
                  end if
                  exit
               end do
            end associate
         end do
      end do
   end subroutine knot_within_step

   pure logical function is_torque(one)
      class(effect), intent(in) :: one
      is_torque = .false.
      select type (one)
      class is (torque_effect)
         is_torque = .true.
      end select
   end function is_torque

   !> Does a time lie between two steps?
   pure logical function is_within_step(scene, t)
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: t
      type(piece) :: part
      integer(i8) :: low, high, middle
      real(dp) :: steps
      is_within_step = .false.
      if (t <= 0 .or. t >= scene%t_end) return
      low = 1
      high = piece_count(scene)
      do while (low < high)
         middle = low + (high - low)/2
         if (border(scene, middle) < t) then
            low = middle + 1
         else
            high = middle
         end if
      end do
      part = get_piece(scene, low)
      steps = (t - part%from)/part%h
      is_within_step = abs(steps - anint(steps)) > 1e-9_dp + rounding*(t/part%h)
   end function is_within_step

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
