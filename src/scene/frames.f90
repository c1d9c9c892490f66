!> Frames of a run: the bodies the scene wants, in the scene's own frame, into CSV and extended XYZ.
module poinsot_scene_frames
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_rotation_quaternion, only: rotate
   use poinsot_scene_settings, only: scene_settings, body_total
   use poinsot_scene_states, only: body_states, to_scene_frame, find_group
   use poinsot_scene_communicator, only: communicator
   use poinsot_scene_collect, only: collect, row_size
   use poinsot_scene_effects, only: body_positions
   use poinsot_scene_files, only: out_file, finish_out, flush_out, is_open
   use poinsot_scene_columns, only: column_names, column_values
   use poinsot_scene_npy, only: npy_file, open_npy, write_npy, finish_npy
   use poinsot_scene_observables, only: observable_file, open_observables, begin_observables, &
      add_observables, end_observables, finish_observables
   use poinsot_scene_trajectory, only: open_csv, write_csv, open_xyz, begin_xyz, write_xyz, &
      semi_axes
   implicit none(type, external)
   private
   public :: frame_writer, open_frames, write_frame, finish_frames

   integer, parameter :: chunk = 4096           !! bodies that are on their way at once
   integer, parameter :: state_columns = 12     !! of the CSV file, before those of the scene's own

   !> Open files, and what they need.
   type :: frame_writer
      type(out_file) :: csv, xyz
      type(npy_file) :: npy
      type(observable_file) :: observables
      integer(i8), allocatable :: bodies(:)     !! numbers of those written; not allocated: all
      integer(i8) :: written = 0                !! how many
      real(dp), allocatable :: position(:, :), shape(:, :) !! (3, written), XYZ only
   end type frame_writer

contains

   !> Open what the scene asks for, on rank 0; nothing for a scene without &output. Error:
   !> POINSOT_E_IO.
   subroutine open_frames(scene, out, speaks, frames, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: out
      logical, intent(in) :: speaks             !! is this rank 0?
      type(frame_writer), intent(inout) :: frames
      type(poinsot_error), intent(inout) :: error
      if (.not. scene%output%present) return
      frames%written = body_total(scene)
      if (size(scene%output%bodies) > 0) then
         frames%bodies = scene%output%bodies
         frames%written = size(frames%bodies, kind=i8)
      end if
      if (.not. speaks) return
      if (scene%output%csv) call open_csv(out // "/trajectory.csv", &
         column_names(scene%output%columns), frames%csv, error)
      if (scene%output%npy .and. .not. raised(error)) then
         call open_npy(out // "/trajectory.npy", int(frames%written), &
            state_columns + size(scene%output%columns), frames%npy, error)
      end if
      if (scene%output%observables .and. .not. raised(error)) then
         call open_observables(out // "/observables.csv", scene, frames%observables, error)
      end if
      if (raised(error) .or. .not. scene%output%extxyz) return
      call open_xyz(out // "/trajectory.xyz", frames%xyz, error)
      call place_bodies(scene, frames)
   end subroutine open_frames

   !> Numbers of the bodies written in places from to to.
   pure function numbers_of(frames, from, to) result(numbers)
      type(frame_writer), intent(in) :: frames
      integer(i8), intent(in) :: from, to
      integer(i8) :: numbers(to - from + 1)
      integer(i8) :: i
      if (allocated(frames%bodies)) then
         numbers = frames%bodies(from:to)
      else
         numbers = [(i, i=from, to)]
      end if
   end function numbers_of

   !> Positions and semi-axes for OVITO; bodies that nobody placed stand on a cubic grid.
   subroutine place_bodies(scene, frames)
      type(scene_settings), intent(in) :: scene
      type(frame_writer), intent(inout) :: frames
      real(dp), allocatable :: position(:, :)
      real(dp) :: apart
      integer(i8), allocatable :: numbers(:)
      integer(i8) :: before
      integer :: i, j, n, side, group
      n = int(frames%written)
      numbers = numbers_of(frames, 1_i8, frames%written)
      allocate (frames%position(3, n), frames%shape(3, n))
      call body_positions(scene, position)
      group = 0
      before = 0
      do i = 1, n
         call find_group(scene, numbers(i), group, before)
         frames%position(:, i) = position(:, numbers(i))
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

   !> One frame, of the bodies of all ranks. All ranks call, rank 0 writes. Error: POINSOT_E_IO, on
   !> rank 0.
   subroutine write_frame(frames, scene, t, states, kinetic, potential, ranks, error)
      type(frame_writer), intent(inout) :: frames
      type(scene_settings), intent(in) :: scene           !! the typed scene
      real(dp), intent(in) :: t                           !! time
      type(body_states), intent(in) :: states             !! of this rank
      real(dp), intent(in) :: kinetic(:), potential(:)    !! of this rank
      class(communicator), intent(inout) :: ranks
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: rows(:, :)
      integer(i8), allocatable :: numbers(:)
      integer(i8) :: from, to
      if (is_open(frames%xyz)) call begin_xyz(frames%xyz, t, frames%written, error)
      allocate (rows(row_size, min(int(chunk, i8), frames%written)))
      do from = 1, frames%written, chunk
         to = min(frames%written, from + chunk - 1)
         numbers = numbers_of(frames, from, to)
         call collect(ranks, states, kinetic, potential, numbers, rows)
         if (ranks%number == 0) call write_rows(frames, scene, t, from, numbers, rows, error)
      end do
      call flush_out(frames%xyz, error)
      call flush_out(frames%csv, error)
      call flush_out(frames%npy%file, error)
      if (scene%output%observables) then
         call observe_all(frames, scene, t, states, kinetic, potential, ranks, error)
      end if
   end subroutine write_frame

   !> Averages over all bodies, whichever are written; all ranks call.
   subroutine observe_all(frames, scene, t, states, kinetic, potential, ranks, error)
      type(frame_writer), intent(inout) :: frames
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: t
      type(body_states), intent(in) :: states
      real(dp), intent(in) :: kinetic(:), potential(:)
      class(communicator), intent(inout) :: ranks
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: rows(:, :)
      integer(i8) :: from, to, i
      allocate (rows(row_size, min(int(chunk, i8), body_total(scene))))
      if (ranks%number == 0) call begin_observables(frames%observables, scene)
      do from = 1, body_total(scene), chunk
         to = min(body_total(scene), from + chunk - 1)
         call collect(ranks, states, kinetic, potential, [(i, i=from, to)], rows)
         if (ranks%number == 0) call add_observables(frames%observables, scene, from, &
            rows(:, :int(to - from + 1)))
      end do
      if (ranks%number == 0) call end_observables(frames%observables, t, error)
   end subroutine observe_all

   !> Rows of a frame; those of XYZ have the principal axes.
   subroutine write_rows(frames, scene, t, first, numbers, rows, error)
      type(frame_writer), intent(inout) :: frames
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: t
      integer(i8), intent(in) :: first                    !! place of the first among those written
      integer(i8), intent(in) :: numbers(:)
      real(dp), intent(in) :: rows(:, :)
      type(poinsot_error), intent(inout) :: error
      real(dp) :: y(3, size(numbers)), q(4, size(numbers))
      real(dp) :: more(size(scene%output%columns), size(numbers))
      integer(i8) :: before
      integer :: i, n, group
      n = size(numbers)
      if (is_open(frames%xyz)) then
         do i = 1, n
            q(:, i) = rows(4:7, i)
            y(:, i) = rotate(q(:, i), rows(1:3, i))
         end do
         call write_xyz(frames%xyz, numbers, frames%position(:, first:first + n - 1), &
            frames%shape(:, first:first + n - 1), y, q, rows(8, :n) + rows(9, :n), error)
      end if
      if (raised(error) .or. .not. (is_open(frames%csv) .or. is_open(frames%npy%file))) return
      group = 0
      before = 0
      do i = 1, n
         y(:, i) = rows(1:3, i)
         q(:, i) = rows(4:7, i)
         call find_group(scene, numbers(i), group, before)
         call to_scene_frame(scene%bodies(group), y(:, i), q(:, i))
         if (size(more, 1) > 0) call column_values(scene, group, rows(1:3, i), rows(4:7, i), &
            scene%output%columns, more(:, i))
      end do
      if (is_open(frames%csv)) call write_csv(frames%csv, t, numbers, y, q, rows(8, :n), &
         rows(9, :n), more, error)
      if (is_open(frames%npy%file)) call write_array(frames%npy, t, numbers, y, q, rows(8, :n), &
         rows(9, :n), more, error)
   end subroutine write_rows

   !> Rows of trajectory.npy: the columns of the CSV file.
   subroutine write_array(npy, t, numbers, y, q, kinetic, potential, more, error)
      type(npy_file), intent(inout) :: npy
      real(dp), intent(in) :: t
      integer(i8), intent(in) :: numbers(:)
      real(dp), intent(in) :: y(:, :), q(:, :), kinetic(:), potential(:), more(:, :)
      type(poinsot_error), intent(inout) :: error
      real(dp) :: values(state_columns + size(more, 1), size(numbers))
      values(1, :) = t
      values(2, :) = real(numbers, dp)
      values(3:6, :) = q
      values(7:9, :) = y
      values(10, :) = kinetic
      values(11, :) = potential
      values(12, :) = kinetic + potential
      values(13:, :) = more
      call write_npy(npy, values, error)
   end subroutine write_array

   !> Close the files and give them their names. Error: POINSOT_E_IO.
   subroutine finish_frames(frames, error)
      type(frame_writer), intent(inout) :: frames
      type(poinsot_error), intent(inout) :: error
      call finish_out(frames%csv, error)
      call finish_out(frames%xyz, error)
      call finish_npy(frames%npy, error)
      call finish_observables(frames%observables, error)
   end subroutine finish_frames

end module poinsot_scene_frames
