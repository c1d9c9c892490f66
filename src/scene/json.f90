!> Strings and numbers as JSON for an HTML page: no string can end the element that contains it.
module poinsot_scene_json
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: quoted_json, number_json, numbers_json

contains

   !> A text in quotes. Quotes, backslashes, control characters, <, > and & go as \u00XX; other
   !> bytes
   !> stay (UTF-8).
   pure function quoted_json(text) result(quoted)
      character(*), intent(in) :: text
      character(:), allocatable :: quoted
      character(4) :: hex
      integer :: i, code
      quoted = """"
      do i = 1, len(text)
         code = iachar(text(i:i))
         if (code < 32 .or. code == 127 .or. index("""\<>&", text(i:i)) > 0) then
            write (hex, "(z4.4)") code
            quoted = quoted // "\u" // hex
         else
            quoted = quoted // text(i:i)
         end if
      end do
      quoted = quoted // """"
   end function quoted_json

   !> A number in as few characters as so many significant digits take; null if it is not finite.
   pure function number_json(x, digits) result(text)
      real(dp), intent(in) :: x
      integer, intent(in) :: digits             !! 1 to 17
      character(:), allocatable :: text
      character(32) :: buffer, form
      integer :: mark, power, last
      if (.not. ieee_is_finite(x)) then
         text = "null"
         return
      else if (abs(x) <= 0) then
         text = "0"
         return
      end if
      write (form, "(a, i0, a)") "(es32.", digits - 1, "e3)"
      write (buffer, form) abs(x)
      buffer = adjustl(buffer)
      mark = index(buffer, "E")
      read (buffer(mark + 1:), "(i4)") power
      last = mark - 1
      do while (buffer(last:last) == "0")
         last = last - 1
      end do
      text = buffer(1:1) // buffer(3:last)      ! the digits
      if (power >= 0 .and. power < digits) then
         if (len(text) <= power) text = text // repeat("0", power + 1 - len(text))
         if (len(text) > power + 1) text = text(:power + 1) // "." // text(power + 2:)
      else if (power < 0 .and. power >= -3) then
         text = "0." // repeat("0", -power - 1) // text
      else
         write (buffer, "(i0)") power
         if (len(text) > 1) text = text(1:1) // "." // text(2:)
         text = text // "e" // trim(buffer)
      end if
      if (x < 0) text = "-" // text
   end function number_json

   !> [1, 2.5, ...]; `bare`: without brackets.
   pure function numbers_json(x, digits, bare) result(text)
      real(dp), intent(in) :: x(:)
      integer, intent(in) :: digits             !! of each, 1 to 17
      logical, intent(in), optional :: bare
      character(:), allocatable :: text
      integer :: i
      text = ""
      do i = 1, size(x)
         if (i > 1) text = text // ","
         text = text // number_json(x(i), digits)
      end do
      if (present(bare)) then
         if (bare) return
      end if
      text = "[" // text // "]"
   end function numbers_json

end module poinsot_scene_json
