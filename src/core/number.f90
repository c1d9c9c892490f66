!> Numbers in scene files, settings and tables, checked character by character before Fortran reads
!> them: a host may run with floating-point traps on, so a text such as 1e999 must never reach the
!> run-time library.
module poinsot_core_number
   use poinsot_core_kinds, only: dp, i8
   implicit none(type, external)
   private
   public :: parse_real, parse_integer, parse_repeats, trusted_reals, lower
   public :: most_repeats
   public :: number_ok, number_no, number_range

   integer, parameter :: number_ok = 0    !! read
   integer, parameter :: number_no = 1    !! not a number
   !> A number beyond 1e307 in size, an integer beyond 64 bits, or not finite.
   integer, parameter :: number_range = 2
   integer, parameter :: most_repeats = 100000000 !! as the count of `n*value`

contains

   !> A real: [+-]digits[.digits][(e|d)[+-]digits]; nan, inf: number_range.
   pure subroutine parse_real(text, value, outcome)
      character(*), intent(in) :: text !! without blanks
      real(dp), intent(out) :: value
      integer, intent(out) :: outcome  !! number_ok, number_no or number_range
      character(:), allocatable :: word, digits
      integer :: at, point, power, mark
      value = 0
      outcome = number_no
      word = lower(text)
      if (len(word) == 0 .or. len(word) > 400) return
      at = 1
      if (scan(word(1:1), "+-") == 1) at = 2
      select case (word(at:))
      case ("nan", "inf", "infinity")
         outcome = number_range
         return
      case default
         continue
      end select
      mark = scan(word, "ed")
      if (mark == 0) mark = len(word) + 1
      digits = word(at:mark - 1)
      point = index(digits, ".")
      if (point == 0) then
         point = len(digits) + 1
      else
         digits = digits(:point - 1) // digits(point + 1:)
      end if
      if (len(digits) == 0 .or. verify(digits, "0123456789") > 0) return
      call parse_power(word, mark, power, outcome)
      if (outcome == number_no) return
      at = verify(digits, "0")
      if (at == 0) outcome = number_ok
      if (at == 0) return                       ! zero, whatever its power
      if (outcome == number_range .or. point - 1 - at + power >= 307) then
         outcome = number_range
         if (power < 0) outcome = number_ok     ! far below the smallest number: zero
         return
      end if
      if (point - 1 - at + power < -330) return
      read (text, *) value
   end subroutine parse_real

   !> The power of ten after the letter at `mark`; number_range for more than six digits.
   pure subroutine parse_power(word, mark, power, outcome)
      character(*), intent(in) :: word
      integer, intent(in) :: mark
      integer, intent(out) :: power, outcome
      integer :: at
      power = 0
      outcome = number_ok
      if (mark > len(word)) return
      outcome = number_no
      at = mark + 1
      if (at > len(word)) return
      if (scan(word(at:at), "+-") == 1) at = at + 1
      if (at > len(word)) return
      if (verify(word(at:), "0123456789") > 0) return
      at = at - 1 + verify(word(at:len(word) - 1) // "1", "0") ! without zeros in front
      if (len(word) - at >= 6) then
         outcome = number_range
         power = 999999
      else
         outcome = number_ok
         read (word(at:), *) power
      end if
      if (word(mark + 1:mark + 1) == "-") power = -power
   end subroutine parse_power

   !> An integer: [+-]digits, of 64 bits.
   pure subroutine parse_integer(text, value, outcome)
      character(*), intent(in) :: text
      integer(i8), intent(out) :: value
      integer, intent(out) :: outcome !! number_ok, number_no or number_range
      integer :: at, i
      integer(i8) :: digit
      value = 0
      outcome = number_no
      if (len(text) == 0) return
      at = 1
      if (scan(text(1:1), "+-") == 1) at = 2
      if (at > len(text)) return
      if (verify(text(at:), "0123456789") > 0) return
      outcome = number_range
      do i = at, len(text)
         digit = iachar(text(i:i)) - iachar("0")
         if (value > (huge(value) - digit)/10) return
         value = 10*value + digit
      end do
      if (text(1:1) == "-") value = -value
      outcome = number_ok
   end subroutine parse_integer

   !> The repeat count of the value at the start of a text: 3 in `3*0`.
   pure subroutine parse_repeats(text, repeats, length, good)
      character(*), intent(in) :: text
      integer, intent(out) :: repeats !! 0: there is no count
      integer, intent(out) :: length  !! of the count and its asterisk
      logical, intent(out) :: good    !! there is none, or one from 1 to most_repeats
      integer(i8) :: number
      integer :: outcome
      repeats = 0
      good = .true.
      length = verify(text, "0123456789")
      if (length <= 1) length = 0
      if (length == 0) return
      if (text(length:length) /= "*") length = 0
      if (length == 0) return
      call parse_integer(text(:length - 1), number, outcome)
      good = outcome == number_ok .and. number >= 1 .and. number <= most_repeats
      if (good) repeats = int(number)
   end subroutine parse_repeats

   !> The numbers of a text of our own, apart by commas or blanks: no check, what is no number is 0.
   pure subroutine trusted_reals(text, values)
      character(*), intent(in) :: text
      real(dp), intent(out) :: values(:)
      integer :: k, at, last, outcome
      values = 0
      at = 1
      do k = 1, size(values)
         if (at > len(text)) return
         last = verify(text(at:), " ,")
         if (last == 0) return
         at = at + last - 1
         last = scan(text(at:), " ,") + at - 2
         if (last < at) last = len(text)
         call parse_real(text(at:last), values(k), outcome)
         at = last + 1
      end do
   end subroutine trusted_reals

   !> ASCII capital letters made small; other bytes stay.
   pure function lower(text) result(small)
      character(*), intent(in) :: text !! any text
      character(len(text)) :: small
      integer :: i, code
      small = text
      do i = 1, len(text)
         code = iachar(text(i:i))
         if (code >= iachar("A") .and. code <= iachar("Z")) small(i:i) = achar(code + 32)
      end do
   end function lower

end module poinsot_core_number
