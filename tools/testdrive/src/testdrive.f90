!> Stand-in for test-drive, written for poinsot: the part of the interface that our tests use
!> (see README.md).
module testdrive
   use, intrinsic :: iso_fortran_env, only: int8, int16, int32, int64, real32, real64
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_is_nan
   implicit none(type, external)
   private
   public :: error_type, unittest_type, testsuite_type
   public :: test_interface, collect_interface
   public :: new_unittest, new_testsuite, select_test, select_suite
   public :: run_testsuite, run_selected
   public :: check, test_failed, skip_test
   public :: get_argument, get_variable, to_string

   integer, parameter :: code_ok = 0, code_failed = 1, code_skipped = 77
   character(*), parameter :: continuation = new_line("a")//"           "

   !> Allocated means: the test failed (`stat` 1) or was skipped (`stat` 77).
   type :: error_type
      integer :: stat = code_ok
      character(:), allocatable :: message
   contains
      final :: stop_if_unseen
   end type error_type

   abstract interface
      !> A test: allocates `error` to say that it failed.
      subroutine test_interface(error)
         import :: error_type
         implicit none(type, external)
         type(error_type), allocatable, intent(out) :: error
      end subroutine test_interface
   end interface

   !> A named test.
   type :: unittest_type
      character(:), allocatable :: name
      procedure(test_interface), pointer, nopass :: test => null()
      logical :: should_fail = .false. !! a known gap: passing would be news
   end type unittest_type

   abstract interface
      !> Lists the tests of a suite.
      subroutine collect_interface(testsuite)
         import :: unittest_type
         implicit none(type, external)
         type(unittest_type), allocatable, intent(out) :: testsuite(:)
      end subroutine collect_interface
   end interface

   !> A named suite.
   type :: testsuite_type
      character(:), allocatable :: name
      procedure(collect_interface), pointer, nopass :: collect => null()
   end type testsuite_type

   !> Fail the test unless a value is as it should be.
   interface check
      module procedure :: check_status, check_true, check_logical, check_text
      module procedure :: check_int8, check_int16, check_int32, check_int64
      module procedure :: check_real32, check_real64, check_complex32, check_complex64
      module procedure :: check_number32, check_number64
      module procedure :: check_complex_number32, check_complex_number64
   end interface check

   !> A number as text.
   interface to_string
      module procedure :: text_int8, text_int16, text_int32, text_int64
      module procedure :: text_real32, text_real64, text_complex32, text_complex64
   end interface to_string

contains

   !> Make a test.
   function new_unittest(name, test, should_fail) result(self)
      character(*), intent(in) :: name
      procedure(test_interface) :: test
      logical, intent(in), optional :: should_fail
      type(unittest_type) :: self
      self%name = name
      self%test => test
      if (present(should_fail)) self%should_fail = should_fail
   end function new_unittest

   !> Make a suite.
   function new_testsuite(name, collect) result(self)
      character(*), intent(in) :: name
      procedure(collect_interface) :: collect
      type(testsuite_type) :: self
      self%name = name
      self%collect => collect
   end function new_testsuite

   !> Place of the test of that name, 0 if there is none.
   function select_test(tests, name) result(pos)
      type(unittest_type), intent(in) :: tests(:)
      character(*), intent(in) :: name
      integer :: pos
      do pos = size(tests), 1, -1
         if (tests(pos)%name == name) return
      end do
   end function select_test

   !> Place of the suite of that name, 0 if there is none.
   function select_suite(suites, name) result(pos)
      type(testsuite_type), intent(in) :: suites(:)
      character(*), intent(in) :: name
      integer :: pos
      do pos = size(suites), 1, -1
         if (suites(pos)%name == name) return
      end do
   end function select_suite

   !> Run all tests of a suite, one after the other; `stat` grows by the number that failed.
   recursive subroutine run_testsuite(collect, unit, stat, parallel)
      procedure(collect_interface) :: collect
      integer, intent(in) :: unit
      integer, intent(inout) :: stat
      logical, intent(in), optional :: parallel !! accepted, without effect
      type(unittest_type), allocatable :: tests(:)
      integer :: i
      if (present(parallel)) continue
      call collect(tests)
      do i = 1, size(tests)
         write (unit, '("   Starting ", a, " ... (", i0, "/", i0, ")")') &
            tests(i)%name, i, size(tests)
         call run_one(tests(i), unit, stat)
      end do
   end subroutine run_testsuite

   !> Run the test of that name; if there is none, list the names and make `stat` negative.
   recursive subroutine run_selected(collect, name, unit, stat)
      procedure(collect_interface) :: collect
      character(*), intent(in) :: name
      integer, intent(in) :: unit
      integer, intent(inout) :: stat
      type(unittest_type), allocatable :: tests(:)
      integer :: i
      call collect(tests)
      i = select_test(tests, name)
      if (i > 0) then
         call run_one(tests(i), unit, stat)
         return
      end if
      write (unit, '(a)') "  Available tests:"
      do i = 1, size(tests)
         write (unit, '(2a)') "  - ", tests(i)%name
      end do
      stat = -huge(stat)
   end subroutine run_selected

   !> Run a test and report it.
   recursive subroutine run_one(test, unit, stat)
      type(unittest_type), intent(in) :: test
      integer, intent(in) :: unit
      integer, intent(inout) :: stat
      type(error_type), allocatable :: error
      character(:), allocatable :: verdict
      logical :: failed
      call test%test(error)
      failed = allocated(error)
      if (failed) failed = error%stat /= code_skipped
      if (allocated(error) .and. .not. failed) then
         verdict = "[SKIPPED]"
      else if (test%should_fail) then
         verdict = "[EXPECTED FAIL]"
         if (.not. failed) verdict = "[UNEXPECTED PASS]"
      else
         verdict = "[PASSED]"
         if (failed) verdict = "[FAILED]"
      end if
      if (verdict == "[FAILED]" .or. verdict == "[UNEXPECTED PASS]") stat = stat + 1
      write (unit, '("       ... ", a, 1x, a)') test%name, verdict
      if (.not. allocated(error)) return
      write (unit, '("  Message: ", a)') error%message
      error%stat = code_ok ! seen
   end subroutine run_one

   !> Let the test fail.
   subroutine test_failed(error, message, more, and_more)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: message
      character(*), intent(in), optional :: more, and_more
      allocate (error)
      error%stat = code_failed
      error%message = message
      if (present(more)) error%message = error%message//continuation//more
      if (present(and_more)) error%message = error%message//continuation//and_more
   end subroutine test_failed

   !> Skip the test, because something it needs is not there.
   subroutine skip_test(error, message, more, and_more)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: message
      character(*), intent(in), optional :: more, and_more
      call test_failed(error, message, more, and_more)
      error%stat = code_skipped
   end subroutine skip_test

   !> A failure that is thrown away unseen is a mistake in the test.
   subroutine stop_if_unseen(error)
      type(error_type), intent(inout) :: error
      if (error%stat == code_ok) return
      if (allocated(error%message)) then
         error stop "a check failed and the test went on: "//error%message
      end if
      error stop "a check failed and the test went on"
   end subroutine stop_if_unseen

   !> What every check ends in: fail with the caller's message, or else with ours.
   subroutine conclude(error, good, what, detail, message, more)
      type(error_type), allocatable, intent(out) :: error
      logical, intent(in) :: good
      character(*), intent(in) :: what, detail
      character(*), intent(in), optional :: message, more
      if (good) return
      if (present(message)) then
         call test_failed(error, message, more)
      else if (detail == "") then
         call test_failed(error, what, more)
      else
         call test_failed(error, what, detail, more)
      end if
   end subroutine conclude

   !> A status of 0.
   subroutine check_status(error, stat, message, more)
      type(error_type), allocatable, intent(out) :: error
      integer, intent(in) :: stat
      character(*), intent(in), optional :: message, more
      call conclude(error, stat == 0, "status is not zero", "got "//to_string(stat), message, more)
   end subroutine check_status

   !> A true expression.
   subroutine check_true(error, expression, message, more)
      type(error_type), allocatable, intent(out) :: error
      logical, intent(in) :: expression
      character(*), intent(in), optional :: message, more
      call conclude(error, expression, "condition is not fulfilled", "", message, more)
   end subroutine check_true

   !> Two logical values that agree.
   subroutine check_logical(error, actual, expected, message, more)
      type(error_type), allocatable, intent(out) :: error
      logical, intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more
      call conclude(error, actual .eqv. expected, "logical values differ", &
         "expected "//merge("T", "F", expected)//", got "//merge("T", "F", actual), message, more)
   end subroutine check_logical

   !> Two texts that agree (up to trailing blanks).
   subroutine check_text(error, actual, expected, message, more)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more
      call conclude(error, actual == expected, "texts differ", &
         "expected '"//expected//"', got '"//actual//"'", message, more)
   end subroutine check_text

   !> Two integers that agree.
   subroutine check_int8(error, actual, expected, message, more)
      type(error_type), allocatable, intent(out) :: error
      integer(int8), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more
      call conclude(error, actual == expected, "integers differ", &
         "expected "//to_string(expected)//", got "//to_string(actual), message, more)
   end subroutine check_int8

   !> Two integers that agree.
   subroutine check_int16(error, actual, expected, message, more)
      type(error_type), allocatable, intent(out) :: error
      integer(int16), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more
      call conclude(error, actual == expected, "integers differ", &
         "expected "//to_string(expected)//", got "//to_string(actual), message, more)
   end subroutine check_int16

   !> Two integers that agree.
   subroutine check_int32(error, actual, expected, message, more)
      type(error_type), allocatable, intent(out) :: error
      integer(int32), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more
      call conclude(error, actual == expected, "integers differ", &
         "expected "//to_string(expected)//", got "//to_string(actual), message, more)
   end subroutine check_int32

   !> Two integers that agree.
   subroutine check_int64(error, actual, expected, message, more)
      type(error_type), allocatable, intent(out) :: error
      integer(int64), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more
      call conclude(error, actual == expected, "integers differ", &
         "expected "//to_string(expected)//", got "//to_string(actual), message, more)
   end subroutine check_int64

   !> A number, not a NaN.
   subroutine check_number32(error, actual, message, more)
      type(error_type), allocatable, intent(out) :: error
      real(real32), intent(in) :: actual
      character(*), intent(in), optional :: message, more
      call conclude(error, .not. ieee_is_nan(actual), "not a number", "", message, more)
   end subroutine check_number32

   !> A complex number without a NaN.
   subroutine check_complex_number32(error, actual, message, more)
      type(error_type), allocatable, intent(out) :: error
      complex(real32), intent(in) :: actual
      character(*), intent(in), optional :: message, more
      call conclude(error, .not. (ieee_is_nan(actual%re) .or. ieee_is_nan(actual%im)), &
         "not a number", "", message, more)
   end subroutine check_complex_number32

   !> Two reals that agree to `thr` (default: epsilon), absolutely or relative to `expected`.
   subroutine check_real32(error, actual, expected, message, more, thr, rel)
      type(error_type), allocatable, intent(out) :: error
      real(real32), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more
      real(real32), intent(in), optional :: thr
      logical, intent(in), optional :: rel
      logical :: finite, good
      character(:), allocatable :: difference
      real(real32) :: tolerance
      tolerance = epsilon(expected)
      if (present(thr)) tolerance = thr
      finite = ieee_is_finite(actual) .and. ieee_is_finite(expected)
      difference = ""
      if (finite) then
         if (present(rel)) tolerance = merge(tolerance*abs(expected), tolerance, rel)
         good = abs(actual - expected) <= tolerance
         difference = ", difference "//to_string(abs(actual - expected))// &
            ", allowed "//to_string(tolerance)
      else
         good = .not. (ieee_is_nan(actual) .or. ieee_is_nan(expected))
         if (good) good = actual <= expected .and. actual >= expected
      end if
      call conclude(error, good, "reals differ", &
         "expected "//to_string(expected)//", got "//to_string(actual)//difference, &
         message, more)
   end subroutine check_real32

   !> Two complex numbers that agree to `thr` (default: epsilon), or to that part of `expected`.
   subroutine check_complex32(error, actual, expected, message, more, thr, rel)
      type(error_type), allocatable, intent(out) :: error
      complex(real32), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more
      real(real32), intent(in), optional :: thr
      logical, intent(in), optional :: rel
      logical :: good
      real(real32) :: tolerance
      tolerance = epsilon(tolerance)
      if (present(thr)) tolerance = thr
      good = ieee_is_finite(actual%re) .and. ieee_is_finite(actual%im)
      if (good) then
         if (present(rel)) tolerance = merge(tolerance*abs(expected), tolerance, rel)
         good = abs(actual - expected) <= tolerance
      end if
      call conclude(error, good, "complex numbers differ", &
         "expected "//to_string(expected)//", got "//to_string(actual), message, more)
   end subroutine check_complex32

   !> A number, not a NaN.
   subroutine check_number64(error, actual, message, more)
      type(error_type), allocatable, intent(out) :: error
      real(real64), intent(in) :: actual
      character(*), intent(in), optional :: message, more
      call conclude(error, .not. ieee_is_nan(actual), "not a number", "", message, more)
   end subroutine check_number64

   !> A complex number without a NaN.
   subroutine check_complex_number64(error, actual, message, more)
      type(error_type), allocatable, intent(out) :: error
      complex(real64), intent(in) :: actual
      character(*), intent(in), optional :: message, more
      call conclude(error, .not. (ieee_is_nan(actual%re) .or. ieee_is_nan(actual%im)), &
         "not a number", "", message, more)
   end subroutine check_complex_number64

   !> Two reals that agree to `thr` (default: epsilon), absolutely or relative to `expected`.
   subroutine check_real64(error, actual, expected, message, more, thr, rel)
      type(error_type), allocatable, intent(out) :: error
      real(real64), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more
      real(real64), intent(in), optional :: thr
      logical, intent(in), optional :: rel
      logical :: finite, good
      character(:), allocatable :: difference
      real(real64) :: tolerance
      tolerance = epsilon(expected)
      if (present(thr)) tolerance = thr
      finite = ieee_is_finite(actual) .and. ieee_is_finite(expected)
      difference = ""
      if (finite) then
         if (present(rel)) tolerance = merge(tolerance*abs(expected), tolerance, rel)
         good = abs(actual - expected) <= tolerance
         difference = ", difference "//to_string(abs(actual - expected))// &
            ", allowed "//to_string(tolerance)
      else
         good = .not. (ieee_is_nan(actual) .or. ieee_is_nan(expected))
         if (good) good = actual <= expected .and. actual >= expected
      end if
      call conclude(error, good, "reals differ", &
         "expected "//to_string(expected)//", got "//to_string(actual)//difference, &
         message, more)
   end subroutine check_real64

   !> Two complex numbers that agree to `thr` (default: epsilon), or to that part of `expected`.
   subroutine check_complex64(error, actual, expected, message, more, thr, rel)
      type(error_type), allocatable, intent(out) :: error
      complex(real64), intent(in) :: actual, expected
      character(*), intent(in), optional :: message, more
      real(real64), intent(in), optional :: thr
      logical, intent(in), optional :: rel
      logical :: good
      real(real64) :: tolerance
      tolerance = epsilon(tolerance)
      if (present(thr)) tolerance = thr
      good = ieee_is_finite(actual%re) .and. ieee_is_finite(actual%im)
      if (good) then
         if (present(rel)) tolerance = merge(tolerance*abs(expected), tolerance, rel)
         good = abs(actual - expected) <= tolerance
      end if
      call conclude(error, good, "complex numbers differ", &
         "expected "//to_string(expected)//", got "//to_string(actual), message, more)
   end subroutine check_complex64

   pure function text_int8(val) result(string)
      integer(int8), intent(in) :: val
      character(:), allocatable :: string
      character(24) :: buffer
      write (buffer, '(i0)') val
      string = trim(buffer)
   end function text_int8

   pure function text_int16(val) result(string)
      integer(int16), intent(in) :: val
      character(:), allocatable :: string
      character(24) :: buffer
      write (buffer, '(i0)') val
      string = trim(buffer)
   end function text_int16

   pure function text_int32(val) result(string)
      integer(int32), intent(in) :: val
      character(:), allocatable :: string
      character(24) :: buffer
      write (buffer, '(i0)') val
      string = trim(buffer)
   end function text_int32

   pure function text_int64(val) result(string)
      integer(int64), intent(in) :: val
      character(:), allocatable :: string
      character(24) :: buffer
      write (buffer, '(i0)') val
      string = trim(buffer)
   end function text_int64

   pure function text_real32(val) result(string)
      real(real32), intent(in) :: val
      character(:), allocatable :: string
      character(32) :: buffer
      write (buffer, '(es16.8e3)') val
      string = trim(adjustl(buffer))
   end function text_real32

   pure function text_complex32(val) result(string)
      complex(real32), intent(in) :: val
      character(:), allocatable :: string
      string = "("//to_string(val%re)//", "//to_string(val%im)//")"
   end function text_complex32

   pure function text_real64(val) result(string)
      real(real64), intent(in) :: val
      character(:), allocatable :: string
      character(32) :: buffer
      write (buffer, '(es24.16e3)') val
      string = trim(adjustl(buffer))
   end function text_real64

   pure function text_complex64(val) result(string)
      complex(real64), intent(in) :: val
      character(:), allocatable :: string
      string = "("//to_string(val%re)//", "//to_string(val%im)//")"
   end function text_complex64

   !> An argument of the command line; not allocated if there is none of that number.
   subroutine get_argument(idx, arg)
      integer, intent(in) :: idx
      character(:), allocatable, intent(out) :: arg
      integer :: length
      if (idx < 0 .or. idx > command_argument_count()) return
      call get_command_argument(idx, length=length)
      allocate (character(length) :: arg)
      if (length > 0) call get_command_argument(idx, arg)
   end subroutine get_argument

   !> A variable of the environment; not allocated if it is not set.
   subroutine get_variable(var, val)
      character(*), intent(in) :: var
      character(:), allocatable, intent(out) :: val
      integer :: length, stat
      call get_environment_variable(var, length=length, status=stat)
      if (stat /= 0) return
      allocate (character(length) :: val)
      if (length > 0) call get_environment_variable(var, val)
   end subroutine get_variable

end module testdrive
