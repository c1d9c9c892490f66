!> Files written so that a reader never takes half of one for the whole: text goes to NAME.part, and
!> takes its name only when everything is on the disk.
module poinsot_scene_files
   use, intrinsic :: iso_c_binding, only: c_int, c_char, c_null_char
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io
   implicit none(type, external)
   private
   public :: out_file, open_out, put, flush_out, finish_out, abandon_out
   public :: make_folder, remove_file, file_exists, is_folder

   character(*), parameter :: unfinished = ".part"

   !> A text file being written.
   type :: out_file
      integer :: unit = 0                      !! 0: not open
      character(:), allocatable :: path        !! its name once finished
   end type out_file

   interface
      integer(c_int) function c_mkdir(path, mode) bind(c, name="mkdir")
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value, intent(in) :: mode
      end function c_mkdir

      integer(c_int) function c_rename(from, to) bind(c, name="rename")
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: from(*), to(*)
      end function c_rename

      integer(c_int) function c_remove(path) bind(c, name="remove")
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)
      end function c_remove
   end interface

contains

   !> Make a folder and those above it; one that is there is welcome. Error: POINSOT_E_IO.
   subroutine make_folder(path, error)
      character(*), intent(in) :: path
      type(poinsot_error), intent(inout) :: error
      integer :: at, code
      integer(c_int), parameter :: everyone = int(o"777", c_int) ! less what the umask takes
      do at = 2, len(path)
         if (path(at:at) /= "/" .and. at < len(path)) cycle
         code = c_mkdir(path(:at) // c_null_char, everyone)
      end do
      if (len(path) == 1) code = c_mkdir(path // c_null_char, everyone)
      if (is_folder(path)) return
      if (file_exists(path)) then
         call raise(error, poinsot_e_io, path // ": the output folder is a file; name another")
      else
         call raise(error, poinsot_e_io, path // ": the output folder cannot be made")
      end if
   end subroutine make_folder

   !> Is there a folder of that name?
   logical function is_folder(path)
      character(*), intent(in) :: path
      inquire (file=path // "/.", exist=is_folder)
   end function is_folder

   !> Is there anything of that name?
   logical function file_exists(path)
      character(*), intent(in) :: path
      inquire (file=path, exist=file_exists)
   end function file_exists

   !> Remove a file, and what an interrupted run left of it; none there is no error.
   subroutine remove_file(path)
      character(*), intent(in) :: path
      integer(c_int) :: code
      code = c_remove(path // c_null_char)
      code = c_remove(path // unfinished // c_null_char)
   end subroutine remove_file

   !> Begin a file. An older one of that name goes away now. Error: POINSOT_E_IO.
   subroutine open_out(path, file, error)
      character(*), intent(in) :: path
      type(out_file), intent(out) :: file
      type(poinsot_error), intent(inout) :: error
      integer :: code
      character(200) :: reason
      call remove_file(path)
      open (newunit=file%unit, file=path // unfinished, access="stream", form="formatted", &
            action="write", status="replace", iostat=code, iomsg=reason)
      file%path = path
      if (code == 0) return
      file%unit = 0
      call raise(error, poinsot_e_io, path // ": cannot be written: " // trim(reason))
   end subroutine open_out

   !> One line. Error: POINSOT_E_IO, a full disk for instance; nothing is written after an error.
   subroutine put(file, line, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: line
      type(poinsot_error), intent(inout) :: error
      integer :: code
      character(200) :: reason
      if (raised(error)) return
      write (file%unit, "(a)", iostat=code, iomsg=reason) line
      if (code /= 0) call raise(error, poinsot_e_io, file%path // ": cannot be written: " // &
                                trim(reason))
   end subroutine put

   !> What is written so far to the disk.
   subroutine flush_out(file, error)
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      integer :: code
      character(200) :: reason
      if (raised(error) .or. file%unit == 0) return
      flush (file%unit, iostat=code, iomsg=reason)
      if (code /= 0) call raise(error, poinsot_e_io, file%path // ": cannot be written: " // &
                                trim(reason))
   end subroutine flush_out

   !> End a file and give it its name; after an earlier error it keeps the name of an unfinished one.
   subroutine finish_out(file, error)
      type(out_file), intent(inout) :: file
      type(poinsot_error), intent(inout) :: error
      integer :: code
      character(200) :: reason
      if (file%unit == 0) return
      call flush_out(file, error)
      close (file%unit, iostat=code, iomsg=reason)
      file%unit = 0
      if (raised(error)) return
      if (code == 0) then
         code = c_rename(file%path // unfinished // c_null_char, file%path // c_null_char)
         reason = "it cannot be renamed from " // file%path // unfinished
      end if
      if (code /= 0) call raise(error, poinsot_e_io, file%path // ": " // trim(reason))
   end subroutine finish_out

   !> Drop a file that will not be finished.
   subroutine abandon_out(file)
      type(out_file), intent(inout) :: file
      integer :: code
      if (file%unit == 0) return
      close (file%unit, iostat=code)
      file%unit = 0
      call remove_file(file%path)
   end subroutine abandon_out

end module poinsot_scene_files
