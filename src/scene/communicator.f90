!> The ranks of a run. The library contains no message passing: a program with MPI extends this type
!> (mpi/communicator.f90); the type itself, for a single process, does next to nothing. Each rank
!> holds and steps the bodies of a slice of its own, and writes them into files that all ranks
!> share, one at a time; a copy of a communicator has a file of its own. If bodies interact (pairs),
!> every rank holds all of them and rank 0 writes.
module poinsot_scene_communicator
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io
   use poinsot_scene_files, only: out_file, open_out, put_text, rewind_out, &
      flush_out, finish_out
   implicit none(type, external)
   private
   public :: communicator, slice_of

   !> One rank among `size`.
   type :: communicator
      integer :: number = 0   !! this rank, from 0; 0 speaks
      integer :: size = 1
      type(out_file) :: file  !! that is being written
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
      procedure :: flush_file
      procedure :: close_file
      procedure :: read_at
   end type communicator

contains

   !> First and last body of a rank: whole blocks, as even as they come. Rank 0 always has some.
   pure subroutine slice_of(number, size, n, from, to)
      integer, intent(in) :: number, size   !! rank, from 0, and how many there are
      integer, intent(in) :: n              !! bodies
      integer, intent(out) :: from, to      !! to = from - 1 for a rank without bodies
      integer(i8) :: blocks
      blocks = (int(n, i8) + lanes - 1)/lanes
      from = int(min(int(n, i8), lanes*((blocks*number + size - 1)/size))) + 1
      to = int(min(int(n, i8), lanes*((blocks*(number + 1) + size - 1)/size)))
   end subroutine slice_of

   !> Rank 0's number, for what depends on a clock or a signal.
   integer(i8) function broadcast(self, number)
      class(communicator), intent(inout) :: self
      integer(i8), intent(in) :: number
      associate (unused => self)
      end associate
      broadcast = number
   end function broadcast

   !> The error of the lowest rank that has one becomes that of all.
   subroutine share_error(self, error)
      class(communicator), intent(inout) :: self
      type(poinsot_error), intent(inout) :: error
      associate (unused_1 => self, unused_2 => error)
      end associate
   end subroutine share_error

   !> The sum of all ranks' numbers.
   integer(i8) function sum_over_ranks(self, number)
      class(communicator), intent(inout) :: self
      integer(i8), intent(in) :: number
      associate (unused => self)
      end associate
      sum_over_ranks = number
   end function sum_over_ranks

   !> Exclusive or of all ranks' bits.
   integer(i8) function xor_over_ranks(self, bits)
      class(communicator), intent(inout) :: self
      integer(i8), intent(in) :: bits
      associate (unused => self)
      end associate
      xor_over_ranks = bits
   end function xor_over_ranks

   !> The largest of all ranks, number by number, in place.
   subroutine largest_over_ranks(self, values)
      class(communicator), intent(inout) :: self
      real(dp), intent(inout) :: values(:)
      associate (unused_1 => self, unused_2 => values)
      end associate
   end subroutine largest_over_ranks

   !> Sums over the bodies of the ranks before this one; it adds those of its own, in their order,
   !> and calls `sums_after`. So no bit of a sum depends on how many ranks there are.
   subroutine sums_before(self, sums)
      class(communicator), intent(inout) :: self
      real(dp), intent(out) :: sums(:)
      associate (unused => self)
      end associate
      sums = 0
   end subroutine sums_before

   !> Hand the sums on; all get those of all.
   subroutine sums_after(self, sums)
      class(communicator), intent(inout) :: self
      real(dp), intent(inout) :: sums(:)
      associate (unused_1 => self, unused_2 => sums)
      end associate
   end subroutine sums_after

   !> Rows to rank 0, which calls `receive_rows` for this rank.
   subroutine send_rows(self, rows)
      class(communicator), intent(inout) :: self
      real(dp), intent(in), contiguous :: rows(:, :)
      associate (unused_1 => self, unused_2 => rows)
      end associate
   end subroutine send_rows

   !> Rows of another rank.
   subroutine receive_rows(self, rank, rows)
      class(communicator), intent(inout) :: self
      integer, intent(in) :: rank
      real(dp), intent(inout), contiguous :: rows(:, :)
      associate (unused_1 => self, unused_2 => rank, unused_3 => rows)
      end associate
   end subroutine receive_rows

   !> Begin a file that all ranks write into, under its temporary name. All ranks call. Error:
   !> POINSOT_E_IO, on all.
   subroutine open_file(self, path, error)
      class(communicator), intent(inout) :: self
      character(*), intent(in) :: path
      type(poinsot_error), intent(inout) :: error
      call open_out(path, self%file, error)
   end subroutine open_file

   !> Text into the file, from a place in it on, counted from 0. Alone, without a gap: from the
   !> beginning to the end, and from place 0 on anew. Error: POINSOT_E_IO, on this rank alone.
   subroutine write_at(self, place, text, error)
      class(communicator), intent(inout) :: self
      integer(i8), intent(in) :: place
      character(*), intent(in) :: text
      type(poinsot_error), intent(inout) :: error
      if (place == 0) call rewind_out(self%file)
      call put_text(self%file, text, error)
   end subroutine write_at

   !> What this rank has written so far to the disk, if it is held back. Error: POINSOT_E_IO, on
   !> this rank alone.
   subroutine flush_file(self, error)
      class(communicator), intent(inout) :: self
      type(poinsot_error), intent(inout) :: error
      call flush_out(self%file, error)
   end subroutine flush_file

   !> End the file and give it its name; after an error of any rank it keeps that of an unfinished
   !> one. All ranks call. Error: POINSOT_E_IO, or the one that there was, on all.
   subroutine close_file(self, error)
      class(communicator), intent(inout) :: self
      type(poinsot_error), intent(inout) :: error
      call finish_out(self%file, error)
   end subroutine close_file

   !> Text of a file that is there, from a place in it on, counted from 0. Blank where the file has
   !> ended. Error: POINSOT_E_IO.
   subroutine read_at(self, path, place, text, error)
      class(communicator), intent(inout) :: self
      character(*), intent(in) :: path
      integer(i8), intent(in) :: place
      character(*), intent(inout) :: text
      type(poinsot_error), intent(inout) :: error
      integer(i8) :: length
      integer :: unit, code, most
      associate (unused => self)
      end associate
      text = ""
      if (raised(error)) return
      open (newunit=unit, file=path, access="stream", form="unformatted", action="read", &
            status="old", iostat=code)
      if (code == 0) then
         inquire (unit=unit, size=length)
         most = int(max(0_i8, min(len(text, i8), length - place)))
         if (most > 0) read (unit, pos=place + 1, iostat=code) text(:most)
         close (unit)
      end if
      if (code /= 0) call raise(error, poinsot_e_io, path // ": cannot be read")
   end subroutine read_at

end module poinsot_scene_communicator
