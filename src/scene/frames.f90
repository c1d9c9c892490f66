!> Frames of a run: the bodies selected by the scene, in the scene's own frame. Rank 0 writes text
!> (CSV, extended XYZ); every rank writes the rows of its own bodies of an array (NumPy).
module poinsot_scene_frames
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_rotation_quaternion, only: rotate
   use poinsot_scene_settings, only: scene_settings, body_total
   use poinsot_scene_states, only: body_states, to_scene_frame, find_group
   use poinsot_scene_communicator, only: communicator
   use poinsot_scene_collect, only: collect, own_rows, row_size
   use poinsot_scene_effects, only: body_positions
   use poinsot_scene_files, only: out_file, finish_out, flush_out, is_open
   use poinsot_scene_columns, only: column_names, column_values
   use poinsot_scene_npy, only: npy_file, open_npy, write_npy, end_npy_frame, finish_npy
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

   !> Open the files that the scene requests, if it has &output. All ranks call. Error:
   !> POINSOT_E_IO.
   subroutine open_frames(scene, out, ranks, frames, error)
      type(scene_settings), intent(in) :: scene   !! the typed scene
      character(*), intent(in) :: out
      class(communicator), intent(inout) :: ranks !! who write
      type(frame_writer), intent(inout) :: frames
      type(poinsot_error), intent(inout) :: error
      logical :: speaks
      if (.not. scene%output%present) return
      speaks = ranks%number == 0
      frames%written = body_total(scene)
      if (size(scene%output%bodies) > 0) then
         frames%bodies = scene%output%bodies
         frames%written = size(frames%bodies, kind=i8)
      end if
      if (speaks .and. scene%output%csv) call open_csv(out // "/trajectory.csv", &
         column_names(scene%output%columns), frames%csv, error)
      if (scene%output%npy) then
         call open_npy(out // "/trajectory.npy", frames%written, &
            state_columns + size(scene%output%columns), ranks, frames%npy, error)
      end if
      if (.not. speaks) return
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

   !> Positions and semi-axes for OVITO; bodies without positions are put on a cubic grid.
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

   !> One frame, of the bodies of all ranks. All ranks call. Error: POINSOT_E_IO, on the rank that
   !> could not write.
   subroutine write_frame(frames, scene, t, states, kinetic, potential, ranks, error)
      type(frame_writer), intent(inout) :: frames
      type(scene_settings), intent(in) :: scene           !! the typed scene
      real(dp), intent(in) :: t                           !! time
      type(body_states), intent(in) :: states             !! of this rank
      real(dp), intent(in) :: kinetic(:), potential(:)    !! of this rank
      class(communicator), intent(inout) :: ranks
      type(poinsot_error), intent(inout) :: error
      if (scene%output%csv .or. scene%output%extxyz) then
         call write_texts(frames, scene, t, states, kinetic, potential, ranks, error)
      end if
      if (scene%output%npy) call write_array(frames, scene, t, states, kinetic, potential, error)
      if (scene%output%observables) then
         call observe_all(frames, scene, t, states, kinetic, potential, ranks, error)
      end if
   end subroutine write_frame

   !> CSV and XYZ, by rank 0; all ranks call.
   subroutine write_texts(frames, scene, t, states, kinetic, potential, ranks, error)
      type(frame_writer), intent(inout) :: frames
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: t
      type(body_states), intent(in) :: states
      real(dp), intent(in) :: kinetic(:), potential(:)
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
   end subroutine write_texts

   !> Averages over all bodies, whichever are written; all ranks call.
   subroutine observe_all(frames, scene, t, states, kinetic, potential, ranks, error)
      type(frame_writer), intent(inout) :: frames
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: t
      type(body_states), intent(in) :: states
      real(dp), intent(in) :: kinetic(:), potential(:)
      class(communicator), intent(inout) :: ranks
      type(poinsot_error), intent(inout) :: error
      integer :: from, to, i
      call begin_observables(frames%observables, states%n, ranks)
      do from = 1, states%n, chunk
         to = min(states%n, from + chunk - 1)
         call add_observables(frames%observables, scene, t, int(states%first, i8), &
            int(from, i8), own_rows(states, kinetic, potential, &
            [(int(states%first, i8) + i, i=from, to)]))
      end do
      call end_observables(frames%observables, t, ranks, error)
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
      integer :: i, n
      n = size(numbers)
      if (is_open(frames%xyz)) then
         do i = 1, n
            q(:, i) = rows(4:7, i)
            y(:, i) = rotate(q(:, i), rows(1:3, i))
         end do
         call write_xyz(frames%xyz, numbers, frames%position(:, first:first + n - 1), &
            frames%shape(:, first:first + n - 1), y, q, rows(8, :n) + rows(9, :n), error)
      end if
      if (raised(error) .or. .not. is_open(frames%csv)) return
      call show(scene, t, numbers, rows, y, q, more)
      call write_csv(frames%csv, t, numbers, y, q, rows(8, :n), rows(9, :n), more, error)
   end subroutine write_rows

   !> Momenta and attitudes in the scene's frame, and the scene's own columns.
   subroutine show(scene, t, numbers, rows, y, q, more)
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: t
      integer(i8), intent(in) :: numbers(:)
      real(dp), intent(in) :: rows(:, :)
      real(dp), intent(out) :: y(:, :), q(:, :), more(:, :)
      integer(i8) :: before
      integer :: i, group
      group = 0
      before = 0
      do i = 1, size(numbers)
         y(:, i) = rows(1:3, i)
         q(:, i) = rows(4:7, i)
         call find_group(scene, numbers(i), group, before)
         call to_scene_frame(scene%bodies(group), y(:, i), q(:, i))
         if (size(more, 1) > 0) call column_values(scene, group, t, rows(1:3, i), &
            rows(4:7, i), scene%output%columns, more(:, i))
      end do
   end subroutine show

   !> Rows of trajectory.npy, the columns of the CSV file: those of this rank's bodies.
   subroutine write_array(frames, scene, t, states, kinetic, potential, error)
      type(frame_writer), intent(inout) :: frames
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: t
      type(body_states), intent(in) :: states
      real(dp), intent(in) :: kinetic(:), potential(:)
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: rows(:, :), values(:, :), y(:, :), q(:, :)
      integer(i8), allocatable :: numbers(:)
      integer(i8) :: from, to
      integer :: n
      to = 0
      do
         call next_places(frames, states, from, to)
         if (from > to) exit
         n = int(to - from + 1)
         numbers = numbers_of(frames, from, to)
         rows = own_rows(states, kinetic, potential, numbers)
         if (allocated(y)) deallocate (y, q, values)
         allocate (y(3, n), q(4, n), values(state_columns + size(scene%output%columns), n))
         call show(scene, t, numbers, rows, y, q, values(state_columns + 1:, :))
         values(1, :) = t
         values(2, :) = real(numbers, dp)
         values(3:6, :) = q
         values(7:9, :) = y
         values(10, :) = rows(8, :)
         values(11, :) = rows(9, :)
         values(12, :) = rows(8, :) + rows(9, :)
         call write_npy(frames%npy, from, values, error)
      end do
      call end_npy_frame(frames%npy, error)
   end subroutine write_array

   !> The next places in a row, a chunk at most, of bodies that this rank holds.
   pure subroutine next_places(frames, states, from, to)
      type(frame_writer), intent(in) :: frames
      type(body_states), intent(in) :: states
      integer(i8), intent(out) :: from
      integer(i8), intent(inout) :: to   !! in: the last place before, 0 at first; < from: no more
      if (.not. allocated(frames%bodies)) then
         from = max(to, int(states%first, i8)) + 1
         to = min(from + chunk, int(states%first, i8) + states%n + 1) - 1
         return
      end if
      from = to + 1
      do while (from <= frames%written)
         if (holds(states, frames%bodies(from))) exit
         from = from + 1
      end do
      to = from - 1
      do while (to < min(frames%written, from + chunk - 1))
         if (.not. holds(states, frames%bodies(to + 1))) exit
         to = to + 1
      end do
   end subroutine next_places

   !> Is that body among those of this rank?
   pure logical function holds(states, number)
      type(body_states), intent(in) :: states
      integer(i8), intent(in) :: number
      holds = number > states%first .and. number <= states%first + states%n
   end function holds

   !> Close the files and give them their names; those that are not open stay as they are. All ranks
   !> call. Error: POINSOT_E_IO.
   subroutine finish_frames(frames, error)
      type(frame_writer), intent(inout) :: frames
      type(poinsot_error), intent(inout) :: error
      call finish_out(frames%csv, error)
      call finish_out(frames%xyz, error)
      call finish_npy(frames%npy, error)
      call finish_observables(frames%observables, error)
   end subroutine finish_frames

end module poinsot_scene_frames
