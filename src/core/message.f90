!> Parts of messages: places in files, and text from users made safe to print.
module poinsot_core_message
   implicit none(type, external)
   private
   public :: from_option, place, printable

   integer, parameter :: from_option = -1 !! line of what stands on the command line, not in the
                                          !! file

contains

   !> "file:line: " for a message; without a line (0) "file: "; of the command line (from_option)
   !> "--set (over file): ".
   pure function place(file, line) result(text)
      character(*), intent(in) :: file !! its name
      integer, intent(in) :: line
      character(:), allocatable :: text
      character(11) :: digits
      select case (line)
      case (from_option)
         text = "--set (over " // file // "): "
      case (1:)
         write (digits, "(i0)") line
         text = file // ":" // trim(digits) // ": "
      case default
         text = file // ": "
      end select
   end function place

   !> Text safe to show on a terminal, in one line: other bytes as \xNN, at most 60 of them.
   pure function printable(text, most) result(safe)
      character(*), intent(in) :: text        !! any bytes
      integer, intent(in), optional :: most   !! how many of them; default 60
      character(:), allocatable :: safe
      character(2) :: hex
      integer :: i, code, shown
      shown = 60
      if (present(most)) shown = most
      safe = ""
      do i = 1, min(len(text), shown)
         code = iachar(text(i:i))
         if (code >= 32 .and. code /= 127 .and. code < 128) then
            safe = safe // text(i:i)
         else
            write (hex, "(z2.2)") iand(code, 255)
            safe = safe // "\x" // hex
         end if
      end do
      if (len(text) > shown) safe = safe // "..."
   end function printable

end module poinsot_core_message
