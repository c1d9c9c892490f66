!> Output files that are never mistaken for complete while they are not: text goes to NAME.part,
!> which is renamed when everything is on the disk. Uses C's stdio: the Fortran run-time library
!> (gfortran 12) does not report a full disk, neither at flush nor at close.
module poinsot_scene_files
   use, intrinsic :: iso_c_binding, only: c_int, c_char, c_size_t, c_ptr, c_null_char, c_null_ptr, &
      c_associated, c_new_line
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io
   implicit none(type, external)
   private
   public :: out_file, open_out, put, put_text, rewind_out, flush_out, finish_out, is_open
   public :: take_name, unfinished
   public :: make_folder, remove_file, file_exists, is_folder, real_path

   character(*), parameter :: unfinished = ".part" !! behind the name of a file that is not whole

   !> A text file being written.
   type :: out_file
      type(c_ptr) :: handle = c_null_ptr       !! C's FILE; null: not open
      character(:), allocatable :: path        !! its name once finished
   end type out_file

   interface
      integer(c_int) function c_mkdir(path, mode) bind(c, name="mkdir")
         import :: c_int, c_char
         implicit none(type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value, intent(in) :: mode
      end function c_mkdir

      integer(c_int) function c_rename(from, to) bind(c, name="rename")
         import :: c_int, c_char
         implicit none(type, external)
         character(kind=c_char), intent(in) :: from(*), to(*)
      end function c_rename

      type(c_ptr) function c_fopen(path, mode) bind(c, name="fopen")
         import :: c_ptr, c_char
         implicit none(type, external)
         character(kind=c_char), intent(in) :: path(*), mode(*)
      end function c_fopen

      integer(c_size_t) function c_fwrite(text, size, count, file) bind(c, name="fwrite")
         import :: c_size_t, c_ptr, c_char
         implicit none(type, external)
         character(kind=c_char), intent(in) :: text(*)
         integer(c_size_t), value, intent(in) :: size, count
         type(c_ptr), value, intent(in) :: file
      end function c_fwrite

      integer(c_int) function c_fflush(file) bind(c, name="fflush")
         import :: c_int, c_ptr
         implicit none(type, external)
         type(c_ptr), value, intent(in) :: file
      end function c_fflush

      subroutine c_rewind(file) bind(c, name="rewind")
         import :: c_ptr
         implicit none(type, external)
         type(c_ptr), value, intent(in) :: file
      end subroutine c_rewind

      integer(c_int) function c_fclose(file) bind(c, name="fclose")
         import :: c_int, c_ptr
         implicit none(type, external)
         type(c_ptr), value, intent(in) :: file
      end function c_fclose

      integer(c_int) function c_unlink(path) bind(c, name="unlink")
         import :: c_int, c_char
         implicit none(type, external)
         character(kind=c_char), intent(in) :: path(*)
      end function c_unlink

      type(c_ptr) function c_realpath(path, resolved) bind(c, name="realpath")
         import :: c_ptr, c_char
         implicit none(type, external)
         character(kind=c_char), intent(in) :: path(*)
         character(kind=c_char), intent(inout) :: resolved(*)
      end function c_realpath
   end interface

contains

   !> Make a folder and those above it; one that is there is welcome. Error: POINSOT_E_IO.
   subroutine make_folder(path, error)
      character(*), intent(in) :: path !! of the file
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
      character(*), intent(in) :: path !! of the file
      inquire (file=path // "/.", exist=is_folder)
   end function is_folder

   !> Is there anything of that name?
   logical function file_exists(path)
      character(*), intent(in) :: path !! of the file
      inquire (file=path, exist=file_exists)
   end function file_exists

   !> Remove a file, and what an interrupted run left of it; none there is no error.
   subroutine remove_file(path)
      character(*), intent(in) :: path !! of the file
      integer(c_int) :: code
      code = c_unlink(path // c_null_char)
      code = c_unlink(path // unfinished // c_null_char)
   end subroutine remove_file

   !> The one name of a file or folder that is there: absolute, without symbolic links and dots.
   !> Empty
   !> if there is none of that name. Two names of one file are told by it, however they are written.
   function real_path(path) result(place)
      character(*), intent(in) :: path !! of the file
      character(:), allocatable :: place
      integer, parameter :: longest_path = 4096 ! PATH_MAX
      character(longest_path + 1) :: room
      room = " "
      place = ""
      if (len(path) == 0) return
      if (.not. c_associated(c_realpath(path // c_null_char, room))) return
      place = room(:index(room, c_null_char) - 1)
   end function real_path

   !> Begin a file. An older one of that name goes away now. Error: POINSOT_E_IO.
   subroutine open_out(path, file, error)
      character(*), intent(in) :: path    !! of the file
      type(out_file), intent(out) :: file !! open from here on
      type(poinsot_error), intent(inout) :: error
      call remove_file(path)
      file%path = path
      file%handle = c_fopen(path // unfinished // c_null_char, "w" // c_null_char)
      if (.not. is_open(file)) then
         call raise(error, poinsot_e_io, path // &
            ": cannot be written; may this folder be written to?")
      end if
   end subroutine open_out

   !> Is it open?
   pure logical function is_open(file)
      type(out_file), intent(in) :: file !! open
      is_open = c_associated(file%handle)
   end function is_open

   !> One line. Error: POINSOT_E_IO, a full disk for instance; nothing is written after an error.
   subroutine put(file, line, error)
      type(out_file), intent(in) :: file !! open
      character(*), intent(in) :: line
      type(poinsot_error), intent(inout) :: error
      call put_text(file, line // c_new_line, error)
   end subroutine put

   !> Text that brings its ends of lines, or any bytes. Error: POINSOT_E_IO; nothing is written
   !> after an error.
   subroutine put_text(file, text, error)
      type(out_file), intent(in) :: file !! open
      character(*), intent(in) :: text
      type(poinsot_error), intent(inout) :: error
      integer(c_size_t) :: length
      if (raised(error)) return
      length = len(text, c_size_t)
      if (c_fwrite(text, 1_c_size_t, length, file%handle) /= length) call no_room(file, error)
   end subroutine put_text

   !> Continue writing at the beginning of the file.
   subroutine rewind_out(file)
      type(out_file), intent(in) :: file !! open
      call c_rewind(file%handle)
   end subroutine rewind_out

   subroutine no_room(file, error)
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      call raise(error, poinsot_e_io, file%path // ": cannot be written to its end: is the " // &
                 "disk full? What there is of it is called " // file%path // unfinished)
   end subroutine no_room

   !> Flush everything written so far to the disk. Error: POINSOT_E_IO.
   subroutine flush_out(file, error)
      type(out_file), intent(in) :: file !! open
      type(poinsot_error), intent(inout) :: error
      if (raised(error) .or. .not. is_open(file)) return
      if (c_fflush(file%handle) /= 0) call no_room(file, error)
   end subroutine flush_out

   !> End a file and give it its name; after an earlier error it keeps the name of an unfinished
   !> one.
   !> Error: POINSOT_E_IO.
   subroutine finish_out(file, error)
      type(out_file), intent(inout) :: file !! open
      type(poinsot_error), intent(inout) :: error
      integer(c_int) :: code
      if (.not. is_open(file)) return
      code = c_fclose(file%handle)
      file%handle = c_null_ptr
      if (raised(error)) return
      if (code /= 0) call no_room(file, error)
      call take_name(file%path, error)
   end subroutine finish_out

   !> A file that is whole takes its name, after no error. Error: POINSOT_E_IO.
   subroutine take_name(path, error)
      character(*), intent(in) :: path    !! its name from here on
      type(poinsot_error), intent(inout) :: error
      if (raised(error)) return
      if (c_rename(path // unfinished // c_null_char, path // c_null_char) /= 0) then
         call raise(error, poinsot_e_io, path // ": cannot be renamed from " // path // unfinished)
      end if
   end subroutine take_name

end module poinsot_scene_files
