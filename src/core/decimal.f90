!> Fast conversion of numbers to text: 17 significant digits, correctly rounded, so that every
!> double is read back exactly. The Fortran run-time library takes twenty times as long for the same
!> characters.
!>
!> x 10^p, with p chosen so that 17 digits precede the point, is computed as a sum of two doubles
!> (about 104 bits). Where 40 bits after the point do not determine the last digit, for example at a
!> tie, the run-time library is used.
module poinsot_core_decimal
   use poinsot_core_kinds, only: dp, i8
   implicit none(type, external)
   private
   public :: append_number, append_integer, longest_number

   integer, parameter :: longest_number = 24 !! characters that a number takes at most

   integer(i8), parameter :: low_52 = 4503599627370495_i8, hidden_bit = 4503599627370496_i8
   integer(i8), parameter :: ten_16 = 10000000000000000_i8, ten_17 = 10*ten_16
   integer(i8), parameter :: ten_8 = 100000000_i8
   real(dp), parameter :: doubtful = 2.0_dp**(-40)  !! of the last digit, about one half
   integer :: i_, j_

   !> 10^0 to 10^21, exact.
   real(dp), parameter :: small_powers(0:21) = [(10.0_dp**i_, i_=0, 21)]

   !> 10^(22 a) = (high + low) 2^exponent, 1 <= high < 2.
   integer, parameter :: first_power = -14
   real(dp), parameter :: high(first_power:15) = [ &
      1.79769313486231597e+00_dp, 1.90338164285156242e+00_dp, 1.00764185168393183e+00_dp, &
      1.06688230926077665e+00_dp, 1.12960558348328699e+00_dp, 1.19601643326595264e+00_dp, &
      1.26633165554229521e+00_dp, 1.34078079299425967e+00_dp, 1.41960688338985719e+00_dp, &
      1.50306725297525334e+00_dp, 1.59143435651131715e+00_dp, 1.68499666669691495e+00_dp, &
      1.78405961588244977e+00_dp, 1.88894659314785818e+00_dp, 1.00000000000000000e+00_dp, &
      1.05879118406787542e+00_dp, 1.12103877145985376e+00_dp, 1.18694596821997478e+00_dp, &
      1.25672792711621795e+00_dp, 1.33061245000254713e+00_dp, 1.40884073147365352e+00_dp, &
      1.49166814624004140e+00_dp, 1.57936508279382615e+00_dp, 1.67221782608673331e+00_dp, &
      1.77052949210178090e+00_dp, 1.87462101736953879e+00_dp, 1.98483220665921922e+00_dp, &
      1.05076142113238435e+00_dp, 1.11253692925360070e+00_dp, 1.17794429264365808e+00_dp]
   real(dp), parameter :: low(first_power:15) = [ &
      -5.90417017790042148e-17_dp, -9.60148848444575237e-17_dp, -1.23070075600323960e-17_dp, &
      3.26808671069769119e-17_dp, 8.59227710931918616e-18_dp, 1.04675107168732235e-16_dp, &
      5.17396448065929070e-18_dp, 3.63234969501705032e-17_dp, 1.99550400929152463e-17_dp, &
      -7.69900559406942797e-17_dp, 1.05201140087678234e-16_dp, 4.06961460249831441e-17_dp, &
      8.38684256402779259e-17_dp, -9.17967113021513437e-17_dp, 0.00000000000000000e+00_dp, &
      0.00000000000000000e+00_dp, -9.88908815240808022e-17_dp, 6.48994353667615583e-17_dp, &
      5.10021357495571130e-17_dp, -3.13616938530405273e-17_dp, 1.29196789687871761e-17_dp, &
      -5.51134769846250478e-17_dp, -1.17646597073882048e-17_dp, -2.93232451967825138e-17_dp, &
      6.30796798175210429e-18_dp, -9.55326170869029471e-17_dp, -8.76115235371166324e-17_dp, &
      -3.46631598113606748e-17_dp, -1.22146137363775758e-17_dp, -4.71226489968317111e-17_dp]
   integer, parameter :: exponents(first_power:15) = [ &
      -1024, -951, -877, -804, -731, -658, -585, -512, -439, -366, -293, -220, -147, -74, 0, 73, &
      146, 219, 292, 365, 438, 511, 584, 657, 730, 803, 876, 950, 1023, 1096]

   !> "00" to "99".
   character(2), parameter :: pairs(0:99) = &
      [((achar(48 + i_)//achar(48 + j_), j_=0, 9), i_=0, 9)]

contains

   !> Write x behind the first n characters of a text: 1.5E+000, -2.0E-003, NaN, Infinity. Zeros at
   !> the end of the digits are left out, but for one.
   pure subroutine append_number(x, text, n)
      real(dp), intent(in) :: x
      character(*), intent(inout) :: text !! with room for longest_number characters more
      integer, intent(inout) :: n         !! characters that stand in it
      integer(i8) :: bits, digits
      integer :: power
      bits = transfer(x, bits)
      if (bits < 0) then
         n = n + 1
         text(n:n) = "-"
         bits = iand(bits, huge(bits))
      end if
      if (bits > shiftl(2047_i8, 52)) then
         if (transfer(x, bits) < 0) n = n - 1
         call append("NaN", text, n)
      else if (bits == shiftl(2047_i8, 52)) then
         call append("Infinity", text, n)
      else if (bits == 0) then
         call append("0.0E+000", text, n)
      else
         call find_digits(bits, digits, power)
         call append_digits(digits, power, text, n)
      end if
   end subroutine append_number

   !> The 17 digits of a positive double and its power of ten: digits 10^(power - 16).
   pure subroutine find_digits(bits, digits, power)
      integer(i8), intent(in) :: bits     !! of the double
      integer(i8), intent(out) :: digits  !! 10^16 to 10^17 - 1
      integer, intent(out) :: power
      integer(i8) :: whole
      integer :: two
      real(dp) :: significand, part
      logical :: sure
      whole = iand(bits, low_52)
      two = int(shiftr(bits, 52)) - 1023
      if (two > -1023) then
         whole = whole + hidden_bit
      else ! subnormal: shifted until its first bit is the hidden one
         two = -1022 - (leadz(whole) - 11)
         whole = shiftl(whole, leadz(whole) - 11)
      end if
      significand = transfer(iand(whole, low_52) + shiftl(1023_i8, 52), significand)
      power = floor((two + (significand - 1))*0.30102999566398120_dp)
      do ! the estimate is at most one off
         call scale(significand, two, 16 - power, digits, part)
         if (digits >= ten_17) then
            power = power + 1
         else if (digits < ten_16) then
            power = power - 1
         else
            exit
         end if
      end do
      sure = abs(part - 0.5_dp) > doubtful
      if (.not. sure) then
         call ask_library(transfer(bits, part), digits, power)
      else if (part > 0.5_dp) then
         digits = digits + 1
         if (digits == ten_17) then
            digits = ten_16
            power = power + 1
         end if
      end if
   end subroutine find_digits

   !> significand 2^two 10^ten as a whole number and the part behind the point.
   pure subroutine scale(significand, two, ten, whole, part)
      real(dp), intent(in) :: significand  !! 1 to 2
      integer, intent(in) :: two, ten
      integer(i8), intent(out) :: whole
      real(dp), intent(out) :: part        !! 0 to 1
      real(dp) :: first, first_error, product, error, factor
      integer(i8) :: below
      integer :: a
      a = floor(ten/22.0_dp)
      call multiply(significand, small_powers(ten - 22*a), first, first_error)
      call multiply(first, high(a), product, error)
      error = error + (first*low(a) + first_error*high(a))
      factor = transfer(shiftl(int(two + exponents(a) + 1023, i8), 52), factor)
      product = product*factor
      error = error*factor
      whole = int(product, i8)
      part = (product - real(whole, dp)) + error
      below = floor(part, i8)
      whole = whole + below
      part = part - real(below, dp)
   end subroutine scale

   !> a b = product + error, exactly (Dekker).
   pure subroutine multiply(a, b, product, error)
      real(dp), intent(in) :: a, b
      real(dp), intent(out) :: product, error
      real(dp) :: a1, a2, b1, b2
      product = a*b
      call split(a, a1, a2)
      call split(b, b1, b2)
      error = ((a1*b1 - product) + a1*b2 + a2*b1) + a2*b2
   end subroutine multiply

   !> Upper 26 bits and the rest.
   pure subroutine split(x, upper, lower)
      real(dp), intent(in) :: x
      real(dp), intent(out) :: upper, lower
      upper = transfer(iand(transfer(x, 1_i8), not(134217727_i8)), x)
      lower = x - upper
   end subroutine split

   !> The same from the run-time library, which is exact and slow.
   pure subroutine ask_library(x, digits, power)
      real(dp), intent(in) :: x
      integer(i8), intent(out) :: digits
      integer, intent(out) :: power
      character(24) :: text
      integer :: k
      write (text, "(es24.16e3)") x
      digits = 0
      do k = 1, 19
         if (text(k:k) < "0" .or. text(k:k) > "9") cycle
         digits = 10*digits + (iachar(text(k:k)) - 48)
      end do
      power = 0
      do k = 22, 24
         power = 10*power + (iachar(text(k:k)) - 48)
      end do
      if (text(21:21) == "-") power = -power
   end subroutine ask_library

   !> d.dddddE+ddd
   pure subroutine append_digits(digits, power, text, n)
      integer(i8), intent(in) :: digits
      integer, intent(in) :: power
      character(*), intent(inout) :: text
      integer, intent(inout) :: n
      character(17) :: all
      integer :: upper, lower, last, k
      lower = int(mod(digits, ten_8))
      upper = int(mod(digits/ten_8, ten_8))
      all(1:1) = achar(48 + int(digits/ten_16))
      do k = 8, 2, -2
         all(k:k + 1) = pairs(mod(upper, 100))
         all(k + 8:k + 9) = pairs(mod(lower, 100))
         upper = upper/100
         lower = lower/100
      end do
      text(n + 1:n + 1) = all(1:1)
      text(n + 2:n + 2) = "."
      text(n + 3:n + 18) = all(2:17)
      do last = 17, 3, -1
         if (all(last:last) /= "0") exit
      end do
      text(n + 2 + last:n + 3 + last) = merge("E+", "E-", power >= 0)
      text(n + 4 + last:n + 4 + last) = achar(48 + abs(power)/100)
      text(n + 5 + last:n + 6 + last) = pairs(mod(abs(power), 100))
      n = n + 6 + last
   end subroutine append_digits

   !> Append a whole number to the first n characters of a text.
   pure subroutine append_integer(number, text, n)
      integer(i8), intent(in) :: number
      character(*), intent(inout) :: text !! with room for longest_number characters more
      integer, intent(inout) :: n         !! characters that stand in it
      character(20) :: digits
      integer(i8) :: rest
      integer :: first
      first = len(digits) + 1
      rest = number
      do
         first = first - 1
         digits(first:first) = achar(48 + abs(int(mod(rest, 10_i8))))
         rest = rest/10
         if (rest == 0) exit
      end do
      if (number < 0) call append("-", text, n)
      call append(digits(first:), text, n)
   end subroutine append_integer

   pure subroutine append(piece, text, n)
      character(*), intent(in) :: piece
      character(*), intent(inout) :: text
      integer, intent(inout) :: n
      text(n + 1:n + len(piece)) = piece
      n = n + len(piece)
   end subroutine append

end module poinsot_core_decimal
