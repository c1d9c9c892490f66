!> NumPy's array format, version 1.0: a header of 128 bytes, then float64 numbers in memory order.
!> Ranks write the rows of their own bodies. The first dimension is known only at the end, so the
!> header is written twice.
module poinsot_scene_npy
   use poinsot_core_kinds, only: dp, i4, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_communicator, only: communicator
   use poinsot_scene_text, only: text_of
   implicit none(type, external)
   private
   public :: npy_file, open_npy, write_npy, end_npy_frame, finish_npy

   integer, parameter :: head_length = 128, number_bytes = 8

   !> An array (frames, rows, columns) being written.
   type :: npy_file
      class(communicator), allocatable :: ranks !! who write it, and the file itself; not
                                                !! allocated: not open
      integer(i8) :: frames = 0, rows = 0       !! whole frames so far; rows of each
      integer :: columns = 0
   end type npy_file

contains

   !> Begin the file. All ranks call. Error: POINSOT_E_IO, or that of another rank, on all.
   subroutine open_npy(path, rows, columns, ranks, this, error)
      character(*), intent(in) :: path
      integer(i8), intent(in) :: rows           !! of each frame
      integer, intent(in) :: columns
      class(communicator), intent(inout) :: ranks
      type(npy_file), intent(inout) :: this
      type(poinsot_error), intent(inout) :: error
      call ranks%share_error(error)
      if (raised(error)) return
      this%rows = rows
      this%columns = columns
      allocate (this%ranks, source=ranks) ! a file of its own
      call this%ranks%open_file(path, error)
      if (raised(error)) deallocate (this%ranks)
      if (.not. raised(error)) call put_head(this, error)
   end subroutine open_npy

   !> Rows of a frame, from a place in it on. Error: POINSOT_E_IO, on this rank alone.
   subroutine write_npy(this, place, values, error)
      type(npy_file), intent(inout) :: this
      integer(i8), intent(in) :: place     !! of the first row among those of the frame, from 1
      real(dp), intent(in) :: values(:, :) !! (columns, some rows)
      type(poinsot_error), intent(inout) :: error
      character(number_bytes*size(values)) :: bytes
      bytes = transfer(values, bytes)
      call this%ranks%write_at(head_length + &
         number_bytes*this%columns*(this%frames*this%rows + place - 1), bytes, error)
   end subroutine write_npy

   !> A frame is whole as far as this rank goes. Error: POINSOT_E_IO, on this rank alone.
   subroutine end_npy_frame(this, error)
      type(npy_file), intent(inout) :: this
      type(poinsot_error), intent(inout) :: error
      call this%ranks%flush_file(error)
      if (.not. raised(error)) this%frames = this%frames + 1
   end subroutine end_npy_frame

   !> The head as it must be now, and the file gets its name. All ranks call. Error: POINSOT_E_IO,
   !> or that of another rank, on all.
   subroutine finish_npy(this, error)
      type(npy_file), intent(inout) :: this
      type(poinsot_error), intent(inout) :: error
      if (.not. allocated(this%ranks)) return
      call put_head(this, error)
      call this%ranks%close_file(error)
      deallocate (this%ranks)
   end subroutine finish_npy

   subroutine put_head(this, error)
      type(npy_file), intent(inout) :: this
      type(poinsot_error), intent(inout) :: error
      if (this%ranks%number == 0) call this%ranks%write_at(0_i8, head(this), error)
   end subroutine put_head

   !> Magic, version, length of the rest, the rest: a dictionary of Python, blanks, a line end.
   function head(this) result(text)
      type(npy_file), intent(in) :: this
      character(head_length) :: text
      character :: order
      order = "<"
      if (iachar(transfer(1_i4, "a")) /= 1) order = ">"
      text = char(147) // "NUMPY" // char(1) // char(0) // char(head_length - 10) // char(0) // &
         "{'descr': '" // order // "f8', 'fortran_order': False, 'shape': (" // &
         text_of(this%frames) // ", " // text_of(this%rows) // ", " // text_of(this%columns) // &
            "), }"
      text(head_length:) = achar(10)
   end function head

end module poinsot_scene_npy
