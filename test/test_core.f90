!> Room core: status list, error type, version.
module test_core
   use, intrinsic :: ieee_arithmetic, only: ieee_down, ieee_get_rounding_mode, ieee_round_type, &
      ieee_set_rounding_mode, ieee_to_zero, ieee_up
   use, intrinsic :: iso_fortran_env, only: real128
   use testdrive, only: new_unittest, unittest_type, error_type, test_failed
   use poinsot_core_kinds, only: dp, qp, i4, i8, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_null, poinsot_e_axis_momentum, status_text
   use poinsot_core_error, only: poinsot_error, clear, raise, raised
   use poinsot_core_decimal, only: append_number, append_integer, longest_number
   use poinsot_core_message, only: printable
   use poinsot_core_nearest, only: nearest_name, suggestion
   use poinsot_core_number, only: parse_real, number_ok, number_range
   use poinsot_core_rounding, only: rounds_to_nearest
   use poinsot_core_version, only: version_number, version_text
   use test_expectation, only: expect
   implicit none(type, external)
   private
   public :: collect_core

contains

   subroutine collect_core(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("kinds", test_kinds), &
         new_unittest("status-texts", test_status_texts), &
         new_unittest("unknown-status", test_unknown_status), &
         new_unittest("error-life", test_error_life), &
         new_unittest("rounding-mode", test_rounding), &
         new_unittest("suggestions", test_suggestions), &
         new_unittest("version-number-and-text", test_version), &
         new_unittest("version-in-manifest", test_manifest), &
         new_unittest("numbers-as-text", test_numbers), &
         new_unittest("numbers-from-text", test_number_reader), &
         new_unittest("text-of-users", test_printable), &
         new_unittest("whole-numbers-as-text", test_whole_numbers)]
   end subroutine collect_core

   !> Zeros in front of a power count for nothing, however many.
   subroutine test_number_reader(error)
      type(error_type), allocatable, intent(out) :: error
      character(16), parameter :: texts(6) = [character(16) :: "1e-0000001", "1e0000001", &
         "-2.5d+00000002", "1e-0000000000", "1e0000999", "1e-0000999"]
      real(dp), parameter :: values(6) = [0.1_dp, 10.0_dp, -250.0_dp, 1.0_dp, 0.0_dp, 0.0_dp]
      real(dp) :: x
      integer :: i, outcome
      do i = 1, size(texts)
         call parse_real(trim(texts(i)), x, outcome)
         call expect(error, outcome, merge(number_range, number_ok, i == 5), texts(i))
         call expect(error, abs(x - values(i)) <= 0, "another number: " // texts(i))
      end do
   end subroutine test_number_reader

   subroutine test_printable(error)
      type(error_type), allocatable, intent(out) :: error
      call expect(error, printable("a" // achar(27) // "b"), "a\x1Bb")
      call expect(error, len(printable(repeat("a", 1000))), 63, "sixty letters, three points")
      call expect(error, printable(repeat("a", 5), 3), "aaa...")
   end subroutine test_printable

   subroutine test_rounding(error)
      type(error_type), allocatable, intent(out) :: error
      type(ieee_round_type), parameter :: others(3) = [ieee_up, ieee_down, ieee_to_zero]
      type(ieee_round_type) :: usual
      logical :: nearest(3)
      integer :: i
      call ieee_get_rounding_mode(usual)
      do i = 1, 3
         call ieee_set_rounding_mode(others(i))
         nearest(i) = rounds_to_nearest()
         call ieee_set_rounding_mode(usual)
      end do
      call expect(error, .not. any(nearest), "directed rounding not noticed")
      call expect(error, rounds_to_nearest(), "rounding to nearest not noticed")
   end subroutine test_rounding

   !> A name that is near is suggested, one that is not is not.
   subroutine test_suggestions(error)
      type(error_type), allocatable, intent(out) :: error
      character(10), parameter :: known(5) = [character(10) :: "free-body", "heavy-top", &
         "gyrostat", "scene", "t_end"]
      character(10), parameter :: asked(10) = [character(10) :: "nosuch", "secne", "hev-top", &
         "gyr", "FREE-BODY", "", "x", "topheavy", "tend", "ab"]
      character(10), parameter :: right(10) = [character(10) :: "", "scene", "heavy-top", &
         "gyrostat", "free-body", "", "", "", "t_end", ""]
      integer :: i
      do i = 1, size(asked)
         call expect(error, nearest_name(asked(i), known), trim(right(i)), "near "//asked(i))
      end do
      call expect(error, suggestion("heavytop", known), "; the nearest known one is 'heavy-top'")
      call expect(error, suggestion("sceen", known, "&<", ">"), &
         "; the nearest known one is &<scene>")
      call expect(error, suggestion("nosuch", known), "")
   end subroutine test_suggestions

   subroutine test_kinds(error)
      type(error_type), allocatable, intent(out) :: error
      call expect(error, precision(1.0_dp) >= 15 .and. precision(1.0_qp) >= merge(33, 15, &
         real128 > 0), "short kinds")
      call expect(error, bit_size(0_i4) == 32 .and. bit_size(0_i8) == 64, "integer kinds")
      if (allocated(error)) return
      call expect(error, mod(lanes, 8), 0, "a block is not whole 512-bit vectors")
   end subroutine test_kinds

   !> Every value has a text of its own.
   subroutine test_status_texts(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: i, k
      call expect(error, status_text(poinsot_ok), "ok")
      do i = poinsot_e_null, poinsot_e_axis_momentum
         do k = poinsot_ok, i - 1
            call expect(error, len(status_text(i)) > 0 .and. status_text(i) /= status_text(k), &
               "status text empty or used twice: "//status_text(i))
         end do
      end do
   end subroutine test_status_texts

   subroutine test_unknown_status(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: strange(4) = [-1, poinsot_e_axis_momentum + 1, huge(1), -huge(1)]
      integer :: i
      do i = 1, size(strange)
         call expect(error, status_text(strange(i)), "unknown status")
      end do
   end subroutine test_unknown_status

   !> Clean at birth, raised with the caller's words or the list's, clean after clear.
   subroutine test_error_life(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: e
      call expect(error, .not. raised(e), "a new error is raised")
      call raise(e, poinsot_e_null, "y is NULL")
      call expect(error, raised(e) .and. e%code == poinsot_e_null .and. &
         e%message == "y is NULL", "raise with a message")
      call raise(e, poinsot_e_axis_momentum)
      call expect(error, e%message, status_text(poinsot_e_axis_momentum))
      call clear(e)
      call expect(error, .not. raised(e) .and. .not. allocated(e%message), "clear leaves something")
   end subroutine test_error_life

   subroutine test_version(error)
      type(error_type), allocatable, intent(out) :: error
      character(32) :: text
      integer :: n
      n = version_number
      write (text, '(i0, ".", i0, ".", i0)') n/10000, mod(n/100, 100), mod(n, 100)
      call expect(error, trim(text), version_text)
   end subroutine test_version

   !> The manifest is the other place that says the version.
   subroutine test_manifest(error)
      type(error_type), allocatable, intent(out) :: error
      character(256) :: line
      integer :: unit, stat
      open (newunit=unit, file="fpm.toml", status="old", action="read", iostat=stat)
      if (stat /= 0) then
         call test_failed(error, "fpm.toml not found: tests run from the project's root")
         return
      end if
      do
         read (unit, '(a)', iostat=stat) line
         if (stat /= 0 .or. index(line, "version = ") == 1) exit
      end do
      close (unit)
      call expect(error, stat, "fpm.toml has no version")
      call expect(error, trim(line), 'version = "'//version_text//'"')
   end subroutine test_manifest

   !> The characters of the run-time library, for doubles of all sizes, ties and ends of the range.
   subroutine test_numbers(error)
      type(error_type), allocatable, intent(out) :: error
      integer(i8) :: bits
      real(dp) :: x
      character(8) :: power
      integer :: k
      call same_text(error, 0.0_dp)
      call same_text(error, -0.0_dp)
      call same_text(error, huge(x))
      call same_text(error, -tiny(x))
      do k = -1074, 1023 ! 2^-25 has 18 digits, the last a 5: a tie
         call same_text(error, scale(1.0_dp, k))
         call same_text(error, scale(-3.0_dp, min(k, 1020)))
      end do
      do k = -307, 307 ! beside the powers of ten the first digit changes
         write (power, "('1e', i0)") k
         read (power, *) x
         call same_text(error, x)
         call same_text(error, nearest(x, 1.0_dp))
         call same_text(error, nearest(x, -1.0_dp))
      end do
      bits = 88172645463325252_i8
      do k = 1, 20000 ! xorshift
         bits = ieor(bits, ishft(bits, 13))
         bits = ieor(bits, ishft(bits, -7))
         bits = ieor(bits, ishft(bits, 17))
         if (iand(shiftr(bits, 52), 2047_i8) == 2047) cycle
         call same_text(error, transfer(bits, x))
         call same_text(error, real(mod(bits, 10000000_i8), dp)/1000)
      end do
      bits = 9218868437227405312_i8
      call expect_text(error, transfer(bits, x), "Infinity")
      call expect_text(error, transfer(bits + 1, x), "NaN")
   end subroutine test_numbers

   subroutine same_text(error, x)
      type(error_type), allocatable, intent(inout) :: error
      real(dp), intent(in) :: x
      character(32) :: buffer, want
      integer :: mark, digits
      if (allocated(error)) return
      write (buffer, "(es32.16e3)") x
      buffer = adjustl(buffer)
      mark = index(buffer, "E")
      digits = mark - 1
      do while (buffer(digits:digits) == "0" .and. buffer(digits - 1:digits - 1) /= ".")
         digits = digits - 1
      end do
      want = buffer(:digits)//buffer(mark:)
      call expect_text(error, x, trim(want))
   end subroutine same_text

   subroutine expect_text(error, x, want)
      type(error_type), allocatable, intent(inout) :: error
      real(dp), intent(in) :: x
      character(*), intent(in) :: want
      character(2 + longest_number) :: text
      integer :: n
      if (allocated(error)) return
      text = "x="
      n = 2
      call append_number(x, text, n)
      call expect(error, text(:n), "x="//want)
   end subroutine expect_text

   subroutine test_whole_numbers(error)
      type(error_type), allocatable, intent(out) :: error
      integer(i8) :: number
      character(24) :: want
      character(1 + longest_number) :: text
      integer :: k, n
      number = -huge(number) - 1
      do k = 1, 80
         text = "#"
         n = 1
         call append_integer(number, text, n)
         write (want, "('#', i0)") number
         call expect(error, text(:n), trim(want))
         number = number/3 + merge(huge(number), 0_i8, k == 41)
      end do
   end subroutine test_whole_numbers

end module test_core
