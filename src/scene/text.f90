!> Text for users: lower case, and numbers as short text that is read back exactly.
module poinsot_scene_text
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_message, only: printable
   use poinsot_core_number, only: lower
   implicit none(type, external)
   private
   public :: lower, text_of, printable, joined, quoted, escaped, for_shell, reason_of, next_word

   !> A number as text: integers plainly, reals with the fewest digits that keep their bits.
   interface text_of
      module procedure text_of_integer, text_of_long, text_of_real, text_of_reals
   end interface text_of

contains

   pure function text_of_integer(number) result(text)
      integer, intent(in) :: number
      character(:), allocatable :: text
      text = text_of_long(int(number, i8))
   end function text_of_integer

   pure function text_of_long(number) result(text)
      integer(i8), intent(in) :: number
      character(:), allocatable :: text
      character(24) :: buffer
      write (buffer, "(i0)") number
      text = trim(buffer)
   end function text_of_long

   pure function text_of_reals(numbers) result(text)
      real(dp), intent(in) :: numbers(:)
      character(:), allocatable :: text
      integer :: i
      text = ""
      do i = 1, size(numbers)
         if (i > 1) text = text // ", "
         text = text // text_of_real(numbers(i))
      end do
   end function text_of_reals

   pure function text_of_real(number) result(text)
      use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
      real(dp), intent(in) :: number
      character(:), allocatable :: text
      character(32) :: buffer
      real(dp) :: back
      integer :: digits, mark, power
      character(*), parameter :: forms(15:17) = &
         [character(12) :: "(es32.14e3)", "(es32.15e3)", "(es32.16e3)"]
      if (.not. ieee_is_finite(number)) then
         text = "inf"
         if (ieee_is_nan(number)) text = "nan"
         return
      end if
      do digits = 15, 17
         write (buffer, forms(digits)) number
         if (digits == 17) exit
         ! the largest doubles round up to a text beyond the range: never read those back
         if (abs(number) > 1e307_dp) cycle
         read (buffer, *) back
         if (back == number) exit
      end do
      buffer = adjustl(buffer)
      mark = index(buffer, "E")
      read (buffer(mark + 1:), *) power
      text = decimal(buffer(:mark - 1), power)
   end function text_of_real

   !> "-1.2300" and a power of ten as the shortest usual notation.
   pure function decimal(mantissa, power) result(text)
      character(*), intent(in) :: mantissa
      integer, intent(in) :: power
      character(:), allocatable :: text, digits
      integer :: last
      logical :: minus
      minus = mantissa(1:1) == "-"
      digits = mantissa(merge(2, 1, minus):)
      digits = digits(1:1) // digits(3:)
      last = max(1, verify(digits, "0", back=.true.))
      digits = digits(:last)
      if (power >= 0 .and. power <= 15) then
         if (last <= power + 1) then
            text = digits // repeat("0", power + 1 - last) // ".0"
         else
            text = digits(:power + 1) // "." // digits(power + 2:)
         end if
      else if (power < 0 .and. power >= -4) then
         text = "0." // repeat("0", -power - 1) // digits
      else
         text = digits(1:1)
         if (last > 1) text = text // "." // digits(2:)
         text = text // "e" // text_of_integer(power)
      end if
      if (minus) text = "-" // text
   end function decimal

   !> A printable text between double quotes.
   pure function quoted(text) result(marked)
      character(*), intent(in) :: text !! any bytes
      character(:), allocatable :: marked
      marked = """" // printable(text) // """"
   end function quoted

   !> What the system says of a file, without the name that stands in the message already: "No such
   !> file or directory".
   pure function reason_of(message) result(reason)
      character(*), intent(in) :: message !! of an iomsg
      character(:), allocatable :: reason
      integer :: quote
      quote = index(message, "': ", back=.true.)
      reason = trim(message)
      if (quote > 0) reason = trim(message(quote + 3:))
   end function reason_of

   !> The words as one text, "a, b, c"; blanks at the ends dropped, empty words left out.
   pure function joined(words) result(text)
      character(*), intent(in) :: words(:) !! any words
      character(:), allocatable :: text
      integer :: i
      text = ""
      do i = 1, size(words)
         if (len_trim(words(i)) == 0) cycle
         if (len(text) > 0) text = text // ", "
         text = text // trim(words(i))
      end do
   end function joined

   !> Take the first of the words that blanks, commas or plus signs separate; "" if none is left.
   pure subroutine next_word(rest, word)
      character(:), allocatable, intent(inout) :: rest
      character(:), allocatable, intent(out) :: word
      character(*), parameter :: separators = " ,+"
      integer :: from, length
      from = verify(rest, separators)
      word = ""
      if (from == 0) return
      rest = rest(from:)
      length = scan(rest, separators) - 1
      if (length < 0) length = len(rest)
      word = rest(:length)
      rest = rest(length + 1:)
   end subroutine next_word

   !> A text between single quotes for a POSIX shell, whatever it holds.
   pure function escaped(text) result(safe)
      character(*), intent(in) :: text !! a file name or another argument
      character(:), allocatable :: safe
      integer :: i
      safe = "'"
      do i = 1, len(text)
         if (text(i:i) == "'") then
            safe = safe // "'\''"
         else
            safe = safe // text(i:i)
         end if
      end do
      safe = safe // "'"
   end function escaped

   !> A text as a word that may be pasted into a shell: between quotes only where it needs them.
   pure function for_shell(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      character(*), parameter :: harmless = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz" &
         // "0123456789_-./+,:=@%"
      if (len(text) > 0 .and. verify(text, harmless) == 0) then
         word = text
      else
         word = escaped(text)
      end if
   end function for_shell

end module poinsot_scene_text
