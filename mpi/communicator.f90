!> The ranks of an MPI run, using the interface that MPICH and Open MPI both provide for every type
!> of buffer; files by MPI-IO.
module mpi_communicators
   use mpi_f08, only: mpi_file, mpi_status, mpi_info_null, mpi_status_ignore, mpi_offset_kind, &
      mpi_comm_self, world => mpi_comm_world, mpi_success, mpi_err_io, mpi_in_place, mpi_max, &
      mpi_min, mpi_sum, mpi_bxor, double => mpi_double_precision, mpi_integer, mpi_integer8, &
      mpi_character, mpi_mode_create, mpi_mode_wronly, mpi_mode_rdonly, mpi_init, mpi_finalize, &
      mpi_comm_rank, mpi_comm_size, mpi_allreduce, mpi_bcast, mpi_send, mpi_recv, mpi_file_open, &
      mpi_file_close, mpi_file_write_at, mpi_file_read_at, mpi_file_get_size, mpi_get_count
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_status, only: poinsot_e_io
   use poinsot_scene_communicator, only: communicator
   use poinsot_scene_files, only: remove_file, take_name, unfinished
   implicit none(type)
   private
   public :: mpi_communicator, start_mpi, finish_mpi

   integer, parameter :: tag_rows = 1, tag_sums = 2

   !> One of MPI's processes.
   type, extends(communicator) :: mpi_communicator
      character(:), allocatable :: path  !! of the file that is being written
      type(mpi_file) :: shared
   contains
      procedure :: broadcast
      procedure :: share_error
      procedure :: sum_over_ranks
      procedure :: xor_over_ranks
      procedure :: largest_over_ranks
      procedure :: sums_before
      procedure :: sums_after
      procedure :: send_rows
      procedure :: receive_rows
      procedure :: open_file
      procedure :: write_at
      procedure :: close_file
      procedure :: read_at
   end type mpi_communicator

contains

   !> Start MPI.
   subroutine start_mpi(ranks)
      type(mpi_communicator), intent(out) :: ranks
      integer :: code
      call mpi_init(code)
      call mpi_comm_rank(world, ranks%number, code)
      call mpi_comm_size(world, ranks%size, code)
   end subroutine start_mpi

   !> End MPI.
   subroutine finish_mpi()
      integer :: code
      call mpi_finalize(code)
   end subroutine finish_mpi

   integer(i8) function broadcast(self, number)
      class(mpi_communicator), intent(inout) :: self
      integer(i8), intent(in) :: number
      integer(i8) :: told(1)
      integer :: code
      told = number
      if (self%size > 0) call mpi_bcast(told, 1, mpi_integer8, 0, world, code)
      broadcast = told(1)
   end function broadcast

   subroutine share_error(self, error)
      class(mpi_communicator), intent(inout) :: self
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: message
      integer :: lowest(1), what(2), code
      lowest = self%size
      if (raised(error)) lowest = self%number
      call mpi_allreduce(mpi_in_place, lowest, 1, mpi_integer, mpi_min, world, code)
      if (lowest(1) == self%size) return
      if (self%number == lowest(1)) then
         what = [error%code, len(error%message)]
         message = error%message
      end if
      call mpi_bcast(what, 2, mpi_integer, lowest(1), world, code)
      if (self%number /= lowest(1)) allocate (character(what(2)) :: message)
      call mpi_bcast(message, what(2), mpi_character, lowest(1), world, code)
      if (self%number /= lowest(1)) call raise(error, what(1), message)
   end subroutine share_error

   integer(i8) function sum_over_ranks(self, number)
      class(mpi_communicator), intent(inout) :: self
      integer(i8), intent(in) :: number
      integer(i8) :: values(1)
      integer :: code
      values = number
      if (self%size > 0) call mpi_allreduce(mpi_in_place, values, 1, mpi_integer8, mpi_sum, &
         world, code)
      sum_over_ranks = values(1)
   end function sum_over_ranks

   integer(i8) function xor_over_ranks(self, bits)
      class(mpi_communicator), intent(inout) :: self
      integer(i8), intent(in) :: bits
      integer(i8) :: values(1)
      integer :: code
      values = bits
      if (self%size > 0) call mpi_allreduce(mpi_in_place, values, 1, mpi_integer8, mpi_bxor, &
         world, code)
      xor_over_ranks = values(1)
   end function xor_over_ranks

   subroutine largest_over_ranks(self, values)
      class(mpi_communicator), intent(inout) :: self
      real(dp), intent(inout) :: values(:)
      real(dp) :: all_of_them(size(values))
      integer :: code
      all_of_them = values
      if (self%size > 0) call mpi_allreduce(mpi_in_place, all_of_them, size(values), double, &
         mpi_max, world, code)
      values = all_of_them
   end subroutine largest_over_ranks

   subroutine sums_before(self, sums)
      class(mpi_communicator), intent(inout) :: self
      real(dp), intent(out) :: sums(:)
      real(dp) :: told(size(sums))
      integer :: code
      told = 0
      if (self%number > 0) call mpi_recv(told, size(told), double, self%number - 1, tag_sums, &
         world, mpi_status_ignore, code)
      sums = told
   end subroutine sums_before

   subroutine sums_after(self, sums)
      class(mpi_communicator), intent(inout) :: self
      real(dp), intent(inout) :: sums(:)
      real(dp) :: told(size(sums))
      integer :: code
      told = sums
      if (self%number < self%size - 1) call mpi_send(told, size(told), double, self%number + 1, &
         tag_sums, world, code)
      call mpi_bcast(told, size(told), double, self%size - 1, world, code)
      sums = told
   end subroutine sums_after

   subroutine send_rows(self, rows)
      class(mpi_communicator), intent(inout) :: self
      real(dp), intent(in), contiguous :: rows(:, :)
      integer :: code
      if (self%number > 0) call mpi_send(rows, size(rows), double, 0, tag_rows, world, code)
   end subroutine send_rows

   subroutine receive_rows(self, rank, rows)
      class(mpi_communicator), intent(inout) :: self
      integer, intent(in) :: rank
      real(dp), intent(inout), contiguous :: rows(:, :)
      integer :: code
      if (self%number == 0) call mpi_recv(rows, size(rows), double, rank, tag_rows, world, &
         mpi_status_ignore, code)
   end subroutine receive_rows

   subroutine open_file(self, path, error)
      class(mpi_communicator), intent(inout) :: self
      character(*), intent(in) :: path
      type(poinsot_error), intent(inout) :: error
      integer :: code, mode
      mode = mpi_mode_create + mpi_mode_wronly
      if (self%number == 0) call remove_file(path)
      mode = int(self%broadcast(int(mode, i8))) ! not before the old one is gone
      self%path = path
      call mpi_file_open(world, path // unfinished, mode, mpi_info_null, self%shared, code)
      if (code /= mpi_success) call raise(error, poinsot_e_io, path // &
         ": cannot be written; may this folder be written to?")
      call self%share_error(error)
   end subroutine open_file

   subroutine write_at(self, place, text, error)
      class(mpi_communicator), intent(inout) :: self
      integer(i8), intent(in) :: place
      character(*), intent(in) :: text
      type(poinsot_error), intent(inout) :: error
      type(mpi_status) :: status
      integer :: code, written
      if (raised(error)) return
      call mpi_file_write_at(self%shared, int(place, mpi_offset_kind), text, len(text), &
         mpi_character, status, code)
      ! Open MPI 4.1 answers success when a disk is full, and counts what was written
      written = 0
      if (code == mpi_success) call mpi_get_count(status, mpi_character, written)
      if (written /= len(text)) call no_room(self%path, error)
   end subroutine write_at

   subroutine no_room(path, error)
      character(*), intent(in) :: path
      type(poinsot_error), intent(inout) :: error
      call raise(error, poinsot_e_io, path // ": cannot be written to its end: is the " // &
                 "disk full? What there is of it is called " // path // unfinished)
   end subroutine no_room

   subroutine close_file(self, error)
      class(mpi_communicator), intent(inout) :: self
      type(poinsot_error), intent(inout) :: error
      integer :: code
      call mpi_file_close(self%shared, code)
      if (code /= mpi_success .and. .not. raised(error)) call no_room(self%path, error)
      call self%share_error(error)
      if (self%number == 0) call take_name(self%path, error)
      call self%share_error(error)
   end subroutine close_file

   subroutine read_at(self, path, place, text, error)
      class(mpi_communicator), intent(inout) :: self
      character(*), intent(in) :: path
      integer(i8), intent(in) :: place
      character(*), intent(inout) :: text
      type(poinsot_error), intent(inout) :: error
      type(mpi_file) :: file
      integer(mpi_offset_kind) :: length
      type(mpi_status) :: status
      integer :: code, most, got
      text = ""
      if (raised(error) .or. self%size == 0) return
      call mpi_file_open(mpi_comm_self, path, mpi_mode_rdonly, mpi_info_null, file, code)
      if (code == mpi_success) then
         call mpi_file_get_size(file, length, code)
         most = int(max(0_i8, min(len(text, i8), int(length, i8) - place)))
         got = most
         if (most > 0) call mpi_file_read_at(file, int(place, mpi_offset_kind), text, most, &
            mpi_character, status, code)
         if (most > 0 .and. code == mpi_success) call mpi_get_count(status, mpi_character, got)
         if (got /= most) code = mpi_err_io
         call mpi_file_close(file)
      end if
      if (code /= mpi_success) call raise(error, poinsot_e_io, path // ": cannot be read")
   end subroutine read_at

end module mpi_communicators
