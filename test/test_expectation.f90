!> What tests of several rooms expect: a number within a bound, a statement, a refusal. After a
!> first failure the later ones are not looked at, so a test reads as a list.
module test_expectation
   use testdrive, only: error_type, check
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, clear
   implicit none(type, external)
   private
   public :: within, expect, refused, accepted

   !> A statement is true, or two numbers or texts are equal.
   interface expect
      module procedure expect_true, expect_integer, expect_success, expect_number, expect_text
   end interface expect

contains

   !> |value| is at most the bound (a NaN is not).
   subroutine within(error, value, bound, what)
      type(error_type), allocatable, intent(inout) :: error
      real(dp), intent(in) :: value, bound
      character(*), intent(in) :: what
      character(64) :: numbers
      if (allocated(error)) return
      write (numbers, "(es12.3e3, a, es10.2e3)") value, " beyond", bound
      call check(error, abs(value) <= bound, what//":"//trim(numbers))
   end subroutine within

   !> A statement is true.
   subroutine expect_true(error, statement, message)
      type(error_type), allocatable, intent(inout) :: error
      logical, intent(in) :: statement
      character(*), intent(in), optional :: message
      if (.not. allocated(error)) call check(error, statement, message)
   end subroutine expect_true

   !> Two integers are equal.
   subroutine expect_integer(error, actual, expected, message)
      type(error_type), allocatable, intent(inout) :: error
      integer, intent(in) :: actual, expected
      character(*), intent(in), optional :: message
      if (.not. allocated(error)) call check(error, actual, expected, message)
   end subroutine expect_integer

   !> A state of input or output is 0.
   subroutine expect_success(error, state, message)
      type(error_type), allocatable, intent(inout) :: error
      integer, intent(in) :: state
      character(*), intent(in) :: message
      if (.not. allocated(error)) call check(error, state, message)
   end subroutine expect_success

   !> Two numbers are equal to within `thr`; by default, to a few roundings.
   subroutine expect_number(error, actual, expected, message, thr)
      type(error_type), allocatable, intent(inout) :: error
      real(dp), intent(in) :: actual, expected
      character(*), intent(in), optional :: message
      real(dp), intent(in), optional :: thr
      if (.not. allocated(error)) call check(error, actual, expected, message, thr=thr)
   end subroutine expect_number

   !> Two texts are equal.
   subroutine expect_text(error, actual, expected, message)
      type(error_type), allocatable, intent(inout) :: error
      character(*), intent(in) :: actual, expected
      character(*), intent(in), optional :: message
      if (.not. allocated(error)) call check(error, actual, expected, message)
   end subroutine expect_text

   !> A call was refused with this code and a message that holds these words; then forget the
   !> refusal.
   subroutine refused(error, refusal, code, words)
      type(error_type), allocatable, intent(inout) :: error
      type(poinsot_error), intent(inout) :: refusal
      integer, intent(in) :: code
      character(*), intent(in) :: words
      character(:), allocatable :: message
      if (allocated(error)) return
      message = "(no message)"
      if (allocated(refusal%message)) message = refusal%message
      call check(error, refusal%code, code, "not refused for: "//words//"; said: "//message)
      if (allocated(error)) return
      call check(error, index(message, words) > 0, "no '"//words//"' in: "//message)
      call clear(refusal)
   end subroutine refused

   !> A call was not refused.
   subroutine accepted(error, refusal)
      type(error_type), allocatable, intent(inout) :: error
      type(poinsot_error), intent(in) :: refusal
      character(:), allocatable :: message
      if (allocated(error)) return
      message = "(no message)"
      if (allocated(refusal%message)) message = refusal%message
      call check(error, refusal%code, 0, "refused: "//message)
   end subroutine accepted

end module test_expectation
