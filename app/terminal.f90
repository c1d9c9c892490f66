!> System services: whether output is a terminal, whether the program was asked to stop, where its
!> files are.
module app_terminal
   use, intrinsic :: iso_c_binding, only: c_int, c_char, c_size_t, c_long, c_intptr_t, c_funptr, &
      c_funloc, c_null_funptr, c_null_char
   use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
   implicit none(type, external)
   private
   public :: error_is_terminal, catch_interrupts, was_interrupted, executable_folder
   public :: say, print_error, environment, leave

   integer(c_int), parameter :: signal_hangup = 1, signal_interrupt = 2, signal_terminate = 15, &
      signal_file_size = 25
   integer(c_intptr_t), parameter :: ignored = 1 !! SIG_IGN

   !> Set by the handler. The library never sees it: the run asks through a context (app_progress).
   logical, volatile, save :: interrupted = .false.

   interface
      subroutine c_exit(code) bind(c, name="exit")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value, intent(in) :: code
      end subroutine c_exit

      integer(c_int) function c_isatty(descriptor) bind(c, name="isatty")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value, intent(in) :: descriptor
      end function c_isatty

      type(c_funptr) function c_signal(number, handler) bind(c, name="signal")
         import :: c_int, c_funptr
         implicit none(type, external)
         integer(c_int), value, intent(in) :: number
         type(c_funptr), value, intent(in) :: handler
      end function c_signal

      integer(c_long) function c_readlink(path, buffer, size) bind(c, name="readlink")
         import :: c_char, c_size_t, c_long
         implicit none(type, external)
         character(kind=c_char), intent(in) :: path(*)
         integer(c_size_t), value, intent(in) :: size
         character(kind=c_char), intent(out) :: buffer(size)
      end function c_readlink
   end interface

contains

   !> End the program with an exit code and without a word (STOP has one for every code, before
   !> gfortran 12). Files are flushed.
   subroutine leave(code)
      integer, intent(in) :: code
      flush (output_unit)
      flush (error_unit)
      call c_exit(int(code, c_int))
   end subroutine leave

   !> Is standard error a terminal?
   logical function error_is_terminal()
      error_is_terminal = c_isatty(2_c_int) == 1
   end function error_is_terminal

   !> From now on SIGINT, SIGTERM and SIGHUP (unless it is ignored: nohup) ask the run to stop; a
   !> second one ends the program at once. A file beyond the limit of its size is an error of the
   !> write, as on a full disk.
   subroutine catch_interrupts()
      type(c_funptr) :: before
      before = c_signal(signal_interrupt, c_funloc(on_interrupt))
      before = c_signal(signal_terminate, c_funloc(on_interrupt))
      before = c_signal(signal_hangup, c_funloc(on_interrupt))
      if (transfer(before, ignored) == ignored) before = c_signal(signal_hangup, before)
      before = c_signal(signal_file_size, transfer(ignored, before))
   end subroutine catch_interrupts

   subroutine on_interrupt(number) bind(c)
      integer(c_int), value, intent(in) :: number
      type(c_funptr) :: before
      interrupted = .true.
      before = c_signal(number, c_null_funptr) ! SIG_DFL
   end subroutine on_interrupt

   !> Did a signal ask to stop?
   logical function was_interrupted()
      was_interrupted = interrupted
   end function was_interrupted

   !> Folder of the running program, "" if unknown.
   function executable_folder() result(folder)
      character(:), allocatable :: folder
      character(kind=c_char) :: buffer(4096)
      character(4096) :: name
      integer :: i, length
      length = int(c_readlink("/proc/self/exe" // c_null_char, buffer, 4096_c_size_t))
      if (length > 0) then
         do i = 1, length
            name(i:i) = buffer(i)
         end do
      else
         call get_command_argument(0, name, length)
      end if
      folder = name(:max(index(name(:length), "/", back=.true.) - 1, 0))
   end function executable_folder

   !> An environment variable, "" if it is not set.
   function environment(name) result(value)
      character(*), intent(in) :: name
      character(:), allocatable :: value
      integer :: length
      call get_environment_variable(name, length=length)
      allocate (character(length) :: value)
      if (length > 0) call get_environment_variable(name, value)
   end function environment

   !> Write a line to standard output; nothing if that is no longer read.
   subroutine say(line)
      character(*), intent(in) :: line
      integer :: code
      write (output_unit, "(a)", iostat=code) line
      if (code /= 0) return
   end subroutine say

   !> A line on standard error, with the program's name.
   subroutine print_error(line)
      character(*), intent(in) :: line
      flush (output_unit)
      write (error_unit, "(a)") "poinsot: " // line
   end subroutine print_error

end module app_terminal
