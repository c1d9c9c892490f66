!> NumPy's own format for arrays, version 1.0: a head of 128 bytes, then float64 numbers as they
!> stand in
!> memory. The first dimension is known when the file is finished: the head is written twice.
module poinsot_scene_npy
   use poinsot_core_kinds, only: dp, i4, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_files, only: out_file, open_out, put_text, rewind_out, finish_out, is_open
   use poinsot_scene_text, only: text_of
   implicit none(type, external)
   private
   public :: npy_file, open_npy, write_npy, finish_npy

   integer, parameter :: head_length = 128, number_bytes = 8

   !> An array (frames, rows, columns) being written.
   type :: npy_file
      type(out_file) :: file
      integer(i8) :: written = 0 !! rows of all frames
      integer :: rows = 0, columns = 0
   end type npy_file

contains

   !> Begin the file. Error: POINSOT_E_IO.
   subroutine open_npy(path, rows, columns, this, error)
      character(*), intent(in) :: path
      integer, intent(in) :: rows, columns !! of each frame
      type(npy_file), intent(inout) :: this
      type(poinsot_error), intent(inout) :: error
      this%rows = rows
      this%columns = columns
      call open_out(path, this%file, error)
      if (.not. raised(error)) call put_text(this%file, head(this), error)
   end subroutine open_npy

   !> Rows of a frame, some or all of them.
   subroutine write_npy(this, values, error)
      type(npy_file), intent(inout) :: this
      real(dp), intent(in) :: values(:, :) !! (columns, some rows)
      type(poinsot_error), intent(inout) :: error
      character(number_bytes*size(values)) :: bytes
      bytes = transfer(values, bytes)
      call put_text(this%file, bytes, error)
      if (.not. raised(error)) this%written = this%written + size(values, 2)
   end subroutine write_npy

   !> The head as it must be now, and the file gets its name.
   subroutine finish_npy(this, error)
      type(npy_file), intent(inout) :: this
      type(poinsot_error), intent(inout) :: error
      if (.not. is_open(this%file)) return
      if (.not. raised(error)) call rewind_out(this%file)
      call put_text(this%file, head(this), error)
      call finish_out(this%file, error)
   end subroutine finish_npy

   !> Magic, version, length of the rest, the rest: a dictionary of Python, blanks, a line end.
   function head(this) result(text)
      type(npy_file), intent(in) :: this
      character(head_length) :: text
      character :: order
      order = "<"
      if (iachar(transfer(1_i4, "a")) /= 1) order = ">"
      text = char(147) // "NUMPY" // char(1) // char(0) // char(head_length - 10) // char(0) // &
         "{'descr': '" // order // "f8', 'fortran_order': False, 'shape': (" // &
         text_of(this%written/max(this%rows, 1)) // ", " // text_of(this%rows) // ", " // &
            text_of(this%columns) // &
            "), }"
      text(head_length:) = achar(10)
   end function head

end module poinsot_scene_npy
