!> Frames of a run: the bodies the scene wants, in the scene's own frame, into CSV and extended XYZ.
module poinsot_scene_frames
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_rotation_quaternion, only: rotate
   use poinsot_scene_settings, only: scene_settings, body_total
   use poinsot_scene_states, only: body_states, to_scene_frame
   use poinsot_scene_effects, only: body_positions
   use poinsot_scene_files, only: out_file, finish_out, is_open
   use poinsot_scene_trajectory, only: open_csv, write_csv, open_xyz, write_xyz, semi_axes
   implicit none(type, external)
   private
   public :: frame_writer, open_frames, write_frame, finish_frames

   !> Open files and room for the bodies that are written.
   type :: frame_writer
      type(out_file) :: csv, xyz
      integer(i8), allocatable :: bodies(:)     !! their numbers
      real(dp), allocatable :: position(:, :), shape(:, :) !! (3, written), XYZ only
      real(dp), allocatable :: y(:, :), q(:, :) !! in the scene's frame
   end type frame_writer

contains

   !> Open what the scene asks for; nothing for a scene without &output. Error: POINSOT_E_IO.
   subroutine open_frames(scene, out, frames, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: out
      type(frame_writer), intent(inout) :: frames
      type(poinsot_error), intent(inout) :: error
      integer :: i
      if (.not. scene%output%present) return
      if (size(scene%output%bodies) > 0) then
         frames%bodies = scene%output%bodies
      else
         frames%bodies = [(int(i, i8), i=1, int(body_total(scene)))]
      end if
      allocate (frames%y(3, size(frames%bodies)), frames%q(4, size(frames%bodies)))
      if (scene%output%csv) call open_csv(out // "/trajectory.csv", frames%csv, error)
      if (raised(error) .or. .not. scene%output%extxyz) return
      call open_xyz(out // "/trajectory.xyz", frames%xyz, error)
      call place_bodies(scene, frames)
   end subroutine open_frames

   !> Positions and semi-axes for OVITO; bodies that nobody placed stand on a cubic grid.
   subroutine place_bodies(scene, frames)
      type(scene_settings), intent(in) :: scene
      type(frame_writer), intent(inout) :: frames
      real(dp), allocatable :: position(:, :)
      real(dp) :: apart
      integer :: i, j, n, side, group, last
      n = size(frames%bodies)
      allocate (frames%position(3, n), frames%shape(3, n))
      call body_positions(scene, position)
      group = 1
      last = int(scene%bodies(1)%count)
      do i = 1, n
         do while (frames%bodies(i) > last)
            group = group + 1
            last = last + int(scene%bodies(group)%count)
         end do
         frames%position(:, i) = position(:, frames%bodies(i))
         frames%shape(:, i) = semi_axes(scene%bodies(group)%moments)
      end do
      if (any(abs(position) > 0)) return
      apart = 2.5_dp*maxval(frames%shape)
      side = ceiling(real(n, dp)**(1/3.0_dp) - 1e-9_dp)
      do i = 1, n
         j = i - 1
         frames%position(:, i) = apart*real([mod(j, side), mod(j/side, side), j/side**2], dp)
      end do
   end subroutine place_bodies

   !> One frame. Error: POINSOT_E_IO.
   subroutine write_frame(frames, scene, t, states, kinetic, potential, error)
      type(frame_writer), intent(inout) :: frames
      type(scene_settings), intent(in) :: scene           !! the typed scene
      real(dp), intent(in) :: t                           !! time
      type(body_states), intent(in) :: states             !! of all bodies
      real(dp), intent(in) :: kinetic(:), potential(:)    !! of all bodies
      type(poinsot_error), intent(inout) :: error
      integer :: i, k
      if (.not. allocated(frames%bodies)) return
      associate (b => frames%bodies)
         if (is_open(frames%xyz)) then
            ! the ellipsoid's axes are the principal ones
            do i = 1, size(b)
               k = int(b(i))
               frames%q(:, i) = states%q(:, k)
               frames%y(:, i) = rotate(states%q(:, k), states%y(:, k))
            end do
            call write_xyz(frames%xyz, t, b, frames%position, frames%shape, frames%y, frames%q, &
                           kinetic(b) + potential(b), error)
         end if
         if (raised(error) .or. .not. is_open(frames%csv)) return
         do i = 1, size(b)
            k = int(b(i))
            frames%y(:, i) = states%y(:, k)
            frames%q(:, i) = states%q(:, k)
            call to_scene_frame(scene%bodies(states%group(k)), frames%y(:, i), frames%q(:, i))
         end do
         call write_csv(frames%csv, t, b, frames%y, frames%q, kinetic(b), potential(b), error)
      end associate
   end subroutine write_frame

   !> Close the files and give them their names. Error: POINSOT_E_IO.
   subroutine finish_frames(frames, error)
      type(frame_writer), intent(inout) :: frames
      type(poinsot_error), intent(inout) :: error
      call finish_out(frames%csv, error)
      call finish_out(frames%xyz, error)
   end subroutine finish_frames

end module poinsot_scene_frames
