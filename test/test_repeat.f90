!> The published comparisons once more: what their tables say, never how long it took.
module test_repeat
   use testdrive, only: new_unittest, unittest_type, error_type, test_failed
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_e_io
   use poinsot_scene_files, only: make_folder
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_repeat_celledoni, only: repeat_celledoni
   use poinsot_study_repeat_fasso, only: repeat_fasso
   use poinsot_study_repeat_hairer, only: repeat_hairer
   use poinsot_study_repeat_review, only: repeat_review
   use test_expectation, only: expect
   implicit none(type, external)
   private
   public :: collect_repeat

   character(*), parameter :: folder = "build/test-repeat"
   integer, parameter :: most_columns = 12

   !> A table of a comparison: words and numbers, as they stand.
   type :: table
      integer :: rows = 0
      character(24), allocatable :: word(:, :)   !! (columns, rows)
      real(dp), allocatable :: number(:, :)      !! 0 where there is a word
   end type table

contains

   subroutine collect_repeat(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("review: the published end", review_end), &
         new_unittest("hairer and vilmart: slopes, exact at rounding", hairer_slopes), &
         new_unittest("fasso: splittings vary with the body, dmv does not", fasso_span), &
         new_unittest("celledoni: tolerance kept, longer steps with exact", celledoni_steps), &
         new_unittest("comparisons: a folder that is not there", no_folder)]
   end subroutine collect_repeat

   subroutine review_end(error)
      type(error_type), allocatable, intent(out) :: error
      type(table) :: found
      type(poinsot_error) :: failure
      integer :: i
      call make_folder(folder, failure)
      if (.not. raised(failure)) call repeat_review(folder, failure)
      call read_table("review.csv", failure, found, error)
      if (allocated(error)) return
      call expect(error, found%rows == 10, "ten lines")
      do i = 1, found%rows
         if (allocated(error)) return
         select case (found%word(1, i))
         case ("dmv10", "exact", "jacobi") ! the published digits are right to 1e-15
            call expect(error, maxval(found%number(10:11, i)) < 4e-15_dp, trim(found%word(1, i)))
         case ("dmv2", "midpoint", "three-rotations", "symmetric-rotation")
            call expect(error, minval(found%number(10:11, i)) > 1e-6_dp, &
                       trim(found%word(1, i)) // " is of order 2")
         case default
            call expect(error, maxval(found%number(10:11, i)) < 1e-7_dp, trim(found%word(1, i)))
         end select
      end do
   end subroutine review_end

   !> Order between 128 and 256 steps; the exact step at any of them.
   subroutine hairer_slopes(error)
      type(error_type), allocatable, intent(out) :: error
      character(16), parameter :: methods(5) = [character(16) :: "dmv2", "dmv4", "dmv6", &
         "midpoint", "three-rotations"]
      integer, parameter :: orders(5) = [2, 4, 6, 2, 2]
      type(table) :: found
      type(poinsot_error) :: failure
      real(dp) :: coarse, fine
      integer :: i, m, body
      call make_folder(folder, failure)
      if (.not. raised(failure)) call repeat_hairer(folder, failure, finest=8)
      call read_table("hairer-vilmart.csv", failure, found, error)
      if (allocated(error)) return
      do i = 1, found%rows
         if (found%word(2, i) /= "exact") cycle
         call expect(error, maxval(found%number(5:6, i)) < 1e-13_dp, "exact is exact")
      end do
      do body = 1, 2
         do m = 1, size(methods)
            coarse = 0
            fine = 0
            do i = 1, found%rows
               if (nint(found%number(1, i)) /= body .or. found%word(2, i) /= methods(m)) cycle
               if (nint(found%number(3, i)) == 128) coarse = found%number(6, i)
               if (nint(found%number(3, i)) == 256) fine = found%number(6, i)
            end do
            call expect(error, coarse > 0 .and. fine > 0, trim(methods(m)) // " came through")
            call expect(error, abs(log(coarse/fine)/log(2.0_dp) - orders(m)) < 0.15_dp, &
                       "slope of " // trim(methods(m)))
         end do
      end do
   end subroutine hairer_slopes

   !> Columns 6 to 11: the methods.
   subroutine fasso_span(error)
      type(error_type), allocatable, intent(out) :: error
      type(table) :: found
      type(poinsot_error) :: failure
      real(dp) :: span(6:11)
      integer :: m
      call make_folder(folder, failure)
      if (.not. raised(failure)) call repeat_fasso(folder, failure, cells=12)
      call read_table("fasso.csv", failure, found, error)
      if (allocated(error)) return
      call expect(error, found%rows == 144, "every body has a line")
      do m = 6, 11
         span(m) = maxval(found%number(m, :))/minval(found%number(m, :))
      end do
      call expect(error, span(6) > 100, "three-rotations: two decades at least")
      call expect(error, minval(found%number(7, :)) < 1e-13_dp .and. &
                 maxval(found%number(7, :)) > 1e-4_dp, "symmetric-rotation: exact where symmetric")
      call expect(error, maxval(span(8:11)) < 5, "midpoint and dmv: hardly")
      call expect(error, maxval(found%number(11, :)) < 1e-8_dp .and. &
                 minval(found%number(9, :)) > 5e-3_dp, "dmv6 and dmv2 lie where they must")
   end subroutine fasso_span

   subroutine celledoni_steps(error)
      type(error_type), allocatable, intent(out) :: error
      type(table) :: found
      type(poinsot_error) :: failure
      type(run_watch) :: watch
      real(dp) :: exact, other
      integer :: i
      ! seconds that only a slow machine needs: 3 for each search
      call make_folder(folder, failure)
      if (.not. raised(failure)) call repeat_celledoni(folder, 150.0_dp, watch, failure, fewer=2)
      call read_table("celledoni.csv", failure, found, error)
      if (allocated(error)) return
      exact = huge(exact)
      other = 0
      do i = 1, found%rows
         call expect(error, found%number(5, i) <= 1e-6_dp, "within the tolerance")
         if (found%word(2, i) == "exact") exact = min(exact, found%number(4, i))
         if (found%word(2, i) == "dmv2") other = max(other, found%number(4, i))
      end do
      call expect(error, found%rows >= 2 .and. exact < huge(exact), "the exact rotor comes through")
      ! weak torques: the kicks could be far apart, and only order 2 of the turn forbids it
      call expect(error, exact > 3*other, "longer steps with the exact rotor")
   end subroutine celledoni_steps

   subroutine no_folder(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: failure
      call repeat_review("build/nowhere/at/all", failure)
      call expect(error, failure%code, poinsot_e_io)
      call expect(error, index(failure%message, "build/nowhere/at/all/review.csv") > 0, &
                 failure%message)
   end subroutine no_folder

   !> A CSV of the folder; after a failure its message fails the test.
   subroutine read_table(name, failure, found, error)
      character(*), intent(in) :: name
      type(poinsot_error), intent(in) :: failure
      type(table), intent(out) :: found
      type(error_type), allocatable, intent(out) :: error
      character(400) :: line
      integer :: unit, code, pass, from, comma, column
      if (raised(failure)) then
         call test_failed(error, failure%message)
         return
      end if
      do pass = 1, 2
         open (newunit=unit, file=folder // "/" // name, action="read", status="old")
         read (unit, "(a)") line
         found%rows = 0
         do
            read (unit, "(a)", iostat=code) line
            if (code /= 0) exit
            found%rows = found%rows + 1
            if (pass == 1) cycle
            from = 1
            do column = 1, most_columns
               if (from > len_trim(line)) exit
               comma = index(trim(line(from:)) // ",", ",")
               found%word(column, found%rows) = adjustl(line(from:from + comma - 2))
               from = from + comma
               associate (word => found%word(column, found%rows))
                  if (scan(word(:1), "-0123456789") == 1) read (word, *) &
                     found%number(column, found%rows)
               end associate
            end do
         end do
         close (unit)
         if (pass == 2) exit
         allocate (found%word(most_columns, found%rows), found%number(most_columns, found%rows))
         found%word = ""
         found%number = 0
      end do
   end subroutine read_table

end module test_repeat
