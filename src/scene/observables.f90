!> Averages over all bodies at each output: observables.csv, written by rank 0. Sums are passed from
!> rank to rank, each of which adds its own bodies.
module poinsot_scene_observables
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_decimal, only: append_number, longest_number
   use poinsot_rotation_quaternion, only: rotate
   use poinsot_scene_columns, only: tilt_cosine
   use poinsot_scene_communicator, only: communicator
   use poinsot_scene_files, only: out_file, open_out, put, flush_out, finish_out
   use poinsot_scene_integrals, only: integral_list, scene_integrals
   use poinsot_scene_settings, only: scene_settings, rotor_of
   use poinsot_scene_states, only: find_group, to_scene_frame
   use poinsot_scene_text, only: text_of
   implicit none(type, external)
   private
   public :: observable_file, open_observables, begin_observables, add_observables, &
      end_observables, finish_observables

   integer, parameter :: bins = 10 !! of the cosine of the tilt, from -1 to 1
   integer, parameter :: columns = 13 + bins
   ! kinetic energy by axes, cos, cos^2, autocorrelation, kinetic and potential energy, Q y;
   ! axes with inertia, bodies, bins
   integer, parameter :: axis_count = 12, body_count = 13, sum_count = 13 + bins
   character(*), parameter :: header = "t,kinetic1,kinetic2,kinetic3,temperature,cos,cos2," // &
      "autocorrelation,energy,rotating,Qy1,Qy2,Qy3"

   !> The file, and what its numbers are counted from.
   type :: observable_file
      type(out_file) :: file
      real(dp), allocatable :: axis(:, :) !! (3, n): the axes at the first output, of this rank
      real(dp) :: spin(3) = 0             !! W of T + U - W.L
      logical :: first = .true.           !! is this the first output?
      real(dp) :: sums(sum_count) = 0     !! over the bodies of an output that were added so far
   end type observable_file

contains

   !> Begin the file. Error: POINSOT_E_IO.
   subroutine open_observables(path, scene, this, error)
      character(*), intent(in) :: path
      type(scene_settings), intent(in) :: scene
      type(observable_file), intent(inout) :: this
      type(poinsot_error), intent(inout) :: error
      type(integral_list) :: list
      character(:), allocatable :: line
      integer :: i
      call scene_integrals(scene, list)
      this%spin = list%spin
      line = header
      do i = 1, bins
         line = line // ",bin" // text_of(i)
      end do
      call open_out(path, this%file, error)
      if (.not. raised(error)) call put(this%file, line, error)
   end subroutine open_observables

   !> A new output. All ranks call.
   subroutine begin_observables(this, n, ranks)
      type(observable_file), intent(inout) :: this
      integer, intent(in) :: n                    !! bodies of this rank
      class(communicator), intent(inout) :: ranks
      this%first = .not. allocated(this%axis)
      if (this%first) allocate (this%axis(3, n))
      call ranks%sums_before(this%sums)
   end subroutine begin_observables

   !> Some bodies of this rank, in their order.
   subroutine add_observables(this, scene, t, before_ours, from, rows)
      type(observable_file), intent(inout) :: this
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: t               !! time
      integer(i8), intent(in) :: before_ours  !! bodies of the ranks before this one
      integer(i8), intent(in) :: from         !! place of the first among those of this rank
      real(dp), intent(in) :: rows(:, :)      !! (y, q, kinetic, potential; bodies), principal frame
      real(dp) :: v(3), y(3), q(4), axis(3), cosine, sine
      integer(i8) :: before, place
      integer :: i, j, group
      group = 0
      before = 0
      do i = 1, size(rows, 2)
         place = from + i - 1
         call find_group(scene, before_ours + place, group, before)
         associate (b => scene%bodies(group))
            v = rows(1:3, i) - rotor_of(b, t)
            where (b%moments > 0)
               v = 0.5_dp*(v/b%moments)*v
            else where
               v = 0
            end where
            this%sums(axis_count) = this%sums(axis_count) + count(b%moments > 0)
            y = rows(1:3, i)
            q = rows(4:7, i)
            call to_scene_frame(b, y, q)
         end associate
         axis = rotate(q, scene%output%axis)
         if (this%first) this%axis(:, place) = axis
         call tilt_cosine(scene, q, cosine, sine)
         this%sums(1:3) = this%sums(1:3) + v
         this%sums(4) = this%sums(4) + cosine
         this%sums(5) = this%sums(5) + cosine**2
         this%sums(6) = this%sums(6) + dot_product(axis, this%axis(:, place))
         this%sums(7) = this%sums(7) + rows(8, i)
         this%sums(8) = this%sums(8) + rows(9, i)
         this%sums(9:11) = this%sums(9:11) + rotate(q, y)
         j = 1 + min(max(int(0.5_dp*(cosine + 1)*bins), 0), bins - 1)
         this%sums(body_count + j) = this%sums(body_count + j) + 1
      end do
      this%sums(body_count) = this%sums(body_count) + size(rows, 2)
   end subroutine add_observables

   !> The line of this output. All ranks call. Error: POINSOT_E_IO, on rank 0.
   subroutine end_observables(this, t, ranks, error)
      type(observable_file), intent(inout) :: this
      real(dp), intent(in) :: t
      class(communicator), intent(inout) :: ranks
      type(poinsot_error), intent(inout) :: error
      real(dp) :: values(columns), energy
      character(columns*(longest_number + 1)) :: line
      integer :: i, n
      call ranks%sums_after(this%sums)
      if (ranks%number > 0) return
      energy = this%sums(7) + this%sums(8)
      values(1) = t
      values(2:4) = this%sums(1:3)/this%sums(body_count)
      values(5) = 2*sum(this%sums(1:3))/max(this%sums(axis_count), 1.0_dp)
      values(6:8) = this%sums(4:6)/this%sums(body_count)
      values(9) = energy
      values(10) = energy - dot_product(this%spin, this%sums(9:11))
      values(11:13) = this%sums(9:11)
      values(14:) = this%sums(body_count + 1:)/this%sums(body_count)
      n = 0
      do i = 1, columns
         if (i > 1) n = n + 1
         if (i > 1) line(n:n) = ","
         call append_number(values(i), line, n)
      end do
      call put(this%file, line(:n), error)
      call flush_out(this%file, error)
   end subroutine end_observables

   !> Close it.
   subroutine finish_observables(this, error)
      type(observable_file), intent(inout) :: this
      type(poinsot_error), intent(inout) :: error
      call finish_out(this%file, error)
   end subroutine finish_observables

end module poinsot_scene_observables
