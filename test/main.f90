!> Runs the test suites:  check [--without SUITE] [--deep] [SUITE [TEST]]
!> --deep: the long suites too; --without: all but one, unless it is named.
!> The last line is "N passed, M failed"; the exit code is non-zero if a test failed or none ran.
program check_poinsot
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: output_unit
   use testdrive, only: testsuite_type, unittest_type, new_testsuite, select_suite, select_test
   use testdrive, only: run_selected, get_argument
   use poinsot_core_kinds, only: dp, i8
   use test_body, only: collect_body
   use test_choose, only: collect_choose, collect_choose_deep
   use test_core, only: collect_core
   use test_drift, only: collect_drift, collect_drift_deep
   use test_effect, only: collect_effect
   use test_elliptic, only: collect_elliptic
   use test_ensemble, only: collect_ensemble
   use test_ensemble_classes, only: collect_classes_deep
   use test_frame, only: collect_frame
   use test_free, only: collect_free
   use test_hard, only: collect_hard, collect_hard_deep
   use test_hard_faults, only: collect_hard_faults_deep
   use test_matrix, only: collect_matrix
   use test_long, only: collect_long, collect_long_deep
   use test_oracle, only: collect_oracle
   use test_properties, only: collect_properties
   use test_rattle, only: collect_rattle
   use test_repeat, only: collect_repeat
   use test_rotation, only: collect_rotation
   use test_pictures, only: collect_pictures
   use test_scene, only: collect_scene
   use test_splitting, only: collect_splitting
   use test_study, only: collect_study
   use test_taylor, only: collect_taylor
   use test_view, only: collect_view
   implicit none(type, external)

   interface
      subroutine c_exit(code) bind(c, name="exit")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value, intent(in) :: code
      end subroutine c_exit
   end interface

   type(testsuite_type), allocatable :: suites(:)
   character(:), allocatable :: suite, test, without
   integer :: i, first, run, failed, skipped

   suites = [ &
      new_testsuite("core", collect_core), &
      new_testsuite("rotation", collect_rotation), &
      new_testsuite("body", collect_body), &
      new_testsuite("elliptic", collect_elliptic), &
      new_testsuite("oracle", collect_oracle), &
      new_testsuite("free", collect_free), &
      new_testsuite("rattle", collect_rattle), &
      new_testsuite("drift", collect_drift), &
      new_testsuite("properties", collect_properties), &
      new_testsuite("effect", collect_effect), &
      new_testsuite("splitting", collect_splitting), &
      new_testsuite("ensemble", collect_ensemble), &
      new_testsuite("taylor", collect_taylor), &
      new_testsuite("frame", collect_frame), &
      new_testsuite("matrix", collect_matrix), &
      new_testsuite("scene", collect_scene), &
      new_testsuite("pictures", collect_pictures), &
      new_testsuite("study", collect_study), &
      new_testsuite("view", collect_view), &
      new_testsuite("repeat", collect_repeat), &
      new_testsuite("choose", collect_choose), &
      new_testsuite("hard", collect_hard), &
      new_testsuite("long", collect_long)]
   first = 1
   without = ""
   call get_argument(first, suite)
   if (allocated(suite)) then
      if (suite == "--without") then
         call get_argument(first + 1, without)
         if (.not. allocated(without)) error stop "--without which suite?"
         if (select_suite(suites, without) == 0) error stop "--without a suite that is not there"
         first = first + 2
      end if
   end if
   call get_argument(first, suite)
   if (allocated(suite)) then
      if (suite == "--deep") then
         first = first + 1
         suites = [suites, deep_suites()]
      end if
   end if

   run = 0
   failed = 0
   skipped = 0
   call get_argument(first, suite)
   call get_argument(first + 1, test)
   if (.not. allocated(suite)) then
      do i = 1, size(suites)
         if (suites(i)%name /= without) call run_suite(suites(i))
      end do
   else
      i = select_suite(suites, suite)
      if (i == 0) then
         call list_suites()
      else if (.not. allocated(test)) then
         call run_suite(suites(i))
      else
         call run_test(suites(i), test)
      end if
   end if

   if (skipped > 0) write (output_unit, '(i0, " skipped")') skipped
   write (output_unit, '(i0, " passed, ", i0, " failed")') run - failed - skipped, failed
   flush (output_unit)
   if (run == skipped .or. failed > 0) call c_exit(1_c_int)

contains

   !> Suites that take long: `make check-deep`.
   function deep_suites() result(list)
      type(testsuite_type), allocatable :: list(:)
      list = [ &
         new_testsuite("long-drift", collect_drift_deep), &
         new_testsuite("classes-deep", collect_classes_deep), &
         new_testsuite("long-deep", collect_long_deep), &
         new_testsuite("choose-promise", collect_choose_deep), &
         new_testsuite("hard-deep", collect_hard_deep), &
         new_testsuite("hard-faults-deep", collect_hard_faults_deep)]
   end function deep_suites

   !> All tests of a suite, one after the other: some of them change thread counts.
   subroutine run_suite(this)
      type(testsuite_type), intent(in) :: this
      type(unittest_type), allocatable :: tests(:)
      integer :: k
      integer(i8) :: start, finish, rate
      call system_clock(start, rate)
      call this%collect(tests)
      write (output_unit, '("# Suite ", a, ", ", i0, " tests")') this%name, size(tests)
      do k = 1, size(tests)
         if (select_test(tests, tests(k)%name) /= k) error stop "two tests of one name in a suite"
         call run_test(this, tests(k)%name)
      end do
      call system_clock(finish)
      write (output_unit, '("# Suite ", a, ": ", f0.1, " s")') &
         this%name, real(finish - start, dp)/real(rate, dp)
   end subroutine run_suite

   !> One test; an unknown name lists the names and runs nothing. The framework tells failures by a
   !> number, but skipped tests in words only, so its words pass through a scratch file.
   subroutine run_test(this, name)
      type(testsuite_type), intent(in) :: this
      character(*), intent(in) :: name
      character(1024) :: line
      integer :: unit, stat, ios
      open (newunit=unit, status="scratch", action="readwrite")
      flush (output_unit)
      stat = 0
      call run_selected(this%collect, name, unit, stat)
      if (stat >= 0) run = run + 1
      failed = failed + max(stat, 0)
      rewind (unit)
      do
         read (unit, '(a)', iostat=ios) line
         if (ios /= 0) exit
         if (index(line, "... "//name//" [SKIPPED]") > 0) skipped = skipped + 1
         write (output_unit, '(a)') trim(line)
      end do
      close (unit)
   end subroutine run_test

   subroutine list_suites()
      integer :: k
      write (output_unit, '(3a)') "There is no suite '", suite, "'. Suites:"
      do k = 1, size(suites)
         write (output_unit, '(2a)') "  ", suites(k)%name
      end do
   end subroutine list_suites

end program check_poinsot
