!> Room core: status list, error type, version.
module test_core
   use, intrinsic :: iso_fortran_env, only: real128
   use testdrive, only: new_unittest, unittest_type, error_type, check, test_failed
   use poinsot_core_kinds, only: dp, qp, i4, i8, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_null, poinsot_e_cpu, status_text
   use poinsot_core_error, only: poinsot_error, clear, raise, raised
   use poinsot_core_version, only: version_number, version_text
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
         new_unittest("version-number-and-text", test_version), &
         new_unittest("version-in-manifest", test_manifest)]
   end subroutine collect_core

   subroutine test_kinds(error)
      type(error_type), allocatable, intent(out) :: error
      call check(error, precision(1.0_dp) >= 15 .and. precision(1.0_qp) >= merge(33, 15, &
         real128 > 0), "short kinds")
      if (allocated(error)) return
      call check(error, bit_size(0_i4) == 32 .and. bit_size(0_i8) == 64, "integer kinds")
      if (allocated(error)) return
      call check(error, mod(lanes, 8), 0, "a block is not whole 512-bit vectors")
   end subroutine test_kinds

   !> Every value has a text of its own.
   subroutine test_status_texts(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: i, k
      call check(error, status_text(poinsot_ok), "ok")
      if (allocated(error)) return
      do i = poinsot_e_null, poinsot_e_cpu
         do k = poinsot_ok, i - 1
            call check(error, len(status_text(i)) > 0 .and. status_text(i) /= status_text(k), &
               "status text empty or used twice: "//status_text(i))
            if (allocated(error)) return
         end do
      end do
   end subroutine test_status_texts

   subroutine test_unknown_status(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: strange(4) = [-1, poinsot_e_cpu + 1, huge(1), -huge(1)]
      integer :: i
      do i = 1, size(strange)
         call check(error, status_text(strange(i)), "unknown status")
         if (allocated(error)) return
      end do
   end subroutine test_unknown_status

   !> Clean at birth, raised with the caller's words or the list's, clean after clear.
   subroutine test_error_life(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: e
      call check(error,.not. raised(e), "a new error is raised")
      if (allocated(error)) return
      call raise(e, poinsot_e_null, "y is NULL")
      call check(error, raised(e) .and. e%code == poinsot_e_null .and. &
         e%message == "y is NULL", "raise with a message")
      if (allocated(error)) return
      call raise(e, poinsot_e_cpu)
      call check(error, e%message, status_text(poinsot_e_cpu))
      if (allocated(error)) return
      call clear(e)
      call check(error,.not. raised(e) .and. .not. allocated(e%message), "clear leaves something")
   end subroutine test_error_life

   subroutine test_version(error)
      type(error_type), allocatable, intent(out) :: error
      character(32) :: text
      integer :: n
      n = version_number
      write (text, '(i0, ".", i0, ".", i0)') n/10000, mod(n/100, 100), mod(n, 100)
      call check(error, trim(text), version_text)
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
      call check(error, stat, "fpm.toml has no version")
      if (allocated(error)) return
      call check(error, trim(line), 'version = "'//version_text//'"')
   end subroutine test_manifest

end module test_core
