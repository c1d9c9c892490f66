!> `poinsot properties` and `poinsot hard`: their maps, dual numbers and judges against the oracles
!> of the tests, and what their tables must say.
module test_properties
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_free_method, only: free_method, find_method, method_count, method_name
   use poinsot_study_defects, only: defects, measure_defects, plain_step
   use poinsot_core_error, only: poinsot_error
   use poinsot_splitting_registry, only: is_table, splitting_count
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_hard, only: run_hard
   use poinsot_study_hard_promises, only: promise_names
   use poinsot_study_hard_rows, only: find_row, hard_row, measure_rows, verdict_words
   use poinsot_study_hard_cases, only: cases_of_kind
   use poinsot_study_hard_series, only: series_names
   use poinsot_study_hard_tops, only: top_names
   use poinsot_study_hard_kinds, only: approaches, hard_result, judge_kind
   use poinsot_study_hard_cases, only: hard_case, kind_names, cases_of_kind, make_case
   use poinsot_study_properties, only: method_properties, measure_method, holds
   use poinsot_study_taylor, only: judge_flow => taylor_flow, judge_conditioning => conditioning
   use test_bodies, only: random_body, random_stream, start_stream, hard_body, body_kinds
   use test_expectation, only: expect
   use test_free_tools, only: text, generic, start, start_q
   use test_measure, only: attitude_distance, momentum_distance
   use test_oracle_dmv, only: reference_map, make_reference
   use test_oracle_properties, only: property_report, measure_oracle => measure_properties
   use test_oracle_taylor, only: taylor_report, taylor_flow, free_problem, conditioning
   implicit none(type, external)
   private
   public :: collect_properties

   !> Counts how often it is told how far a study is.
   type, extends(run_watch) :: counting_watch
      integer :: told = 0
   contains
      procedure :: report_progress
   end type counting_watch

contains

   subroutine report_progress(self, t, t_end)
      class(counting_watch), intent(inout) :: self
      real(dp), intent(in) :: t, t_end
      if (t >= 0 .and. t < t_end) self%told = self%told + 1
   end subroutine report_progress


   subroutine collect_properties(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("maps", test_maps), &
         new_unittest("derivatives", test_derivatives), &
         new_unittest("table", test_table), &
         new_unittest("judge", test_judge), &
         new_unittest("hard-cases", test_hard), &
         new_unittest("hard-promises-and-tops", test_promises), &
         new_unittest("hard-scale-and-moments", test_own)]
   end subroutine collect_properties

   !> The maps in dual numbers are the oracle's maps.
   subroutine test_maps(error)
      type(error_type), allocatable, intent(out) :: error
      character(20), parameter :: names(8) = [character(20) :: "dmv2", "dmv4", "dmv14", "dmv24", &
         "midpoint", "three-rotations", "symmetric-rotation", "exact"]
      type(random_stream) :: stream
      type(random_body) :: body
      type(reference_map) :: map
      real(qp) :: y(3), q(4), z(3), r(4)
      real(dp) :: gap
      logical :: ok, fine
      integer :: i, k
      do i = 1, size(names)
         stream = start_stream(61)
         do k = 1, 12
            call hard_body(stream, body_kinds(k), 0.8_dp, body)
            if (body_kinds(k) == "linear" .and. names(i) == "three-rotations") cycle
            if (body_kinds(k) == "slow" .or. body_kinds(k) == "units") cycle
            y = body%y
            q = body%q
            z = y
            r = q
            call plain_step(trim(names(i)), body%moments, real(body%h, qp), y, q, ok)
            call make_reference(names(i), body%moments, map)
            call map%apply(real(body%h, qp), z, r, fine)
            gap = momentum_distance(y, z) + attitude_distance(q, r)
            call expect(error, ok .and. fine .and. gap < 1.0e-28_dp, trim(names(i))//" on "// &
               trim(body_kinds(k))//": "//text(gap))
         end do
      end do
   end subroutine test_maps

   !> Defects from dual numbers equal those from differences of the oracle's maps, where there are
   !> any.
   subroutine test_derivatives(error)
      type(error_type), allocatable, intent(out) :: error
      character(20), parameter :: names(5) = [character(20) :: "dmv2", "dmv4", "dmv8", "midpoint", &
         "three-rotations"]
      type(reference_map) :: map
      type(property_report) :: other
      type(defects) :: found
      integer :: i
      do i = 1, size(names)
         call measure_defects(trim(names(i)), generic, 0.5_dp, start, start_q, found)
         call make_reference(names(i), generic, map)
         call measure_oracle(map, map%inverse, 0.5_qp, real(start, qp), &
            start_q/sqrt(sum(real(start_q, qp)**2)), other)
         call expect(error, abs(found%poisson - other%poisson) < 1.0e-17_dp &
            + 1.0e-12_dp*found%poisson, &
            trim(names(i))//" Poisson: "//text(found%poisson)//", "//text(other%poisson))
         call expect(error, abs(found%symplectic - other%symplectic) < &
                    1.0e-17_dp + 1.0e-12_dp*found%symplectic, trim(names(i))// &
                    " symplectic: "//text(found%symplectic)//", "//text(other%symplectic))
      end do
   end subroutine test_derivatives

   !> The table's ticks and orders.
   subroutine test_table(error)
      type(error_type), allocatable, intent(out) :: error
      character(20), parameter :: names(7) = [character(20) :: "jacobi", "dmv2", "dmv10", &
         "midpoint", &
         "three-rotations", "symmetric-rotation", "rattle"]
      !> H, Poisson, symplectic, linear, exact for symmetric bodies.
      character(3), parameter :: expected(5, 7) = reshape([character(3) :: &
         "yes", "yes", "yes", "yes", "yes", &
         "yes", "yes", "yes", "yes", "no", &
         "yes", "yes", "no", "yes", "no", &
         "yes", "no", "no", "yes", "no", &
         "no", "yes", "yes", "no", "no", &
         "no", "yes", "yes", "yes", "yes", &
         "yes", "yes", "yes", "yes", "no"], [5, 7])
      character(3) :: said(5)
      type(method_properties) :: row
      type(poinsot_error) :: answer
      integer :: i
      do i = 1, size(names)
         call measure_method(trim(names(i)), row, answer)
         call expect(error, .not. raised(answer), "refused: "//trim(names(i)))
         said = [holds(row%map%energy), holds(row%map%poisson), holds(row%map%symplectic), &
            holds(row%linear), holds(row%symmetric_body)]
         call expect(error, all(said == expected(:, i)), &
                    "ticks of "//trim(names(i))//": "//said(1)//said(2)// said(3)//said(4)//said(5))
         call expect(error, max(row%map%space, row%map%casimir, row%map%norm, row%map%symmetric, &
            row%map%reversible) < 1.0e-31_dp, "what all of them keep: "//trim(names(i)))
         call expect(error, row%distance < 5, &
            trim(names(i))//" is not its map: "//text(row%distance))
         call expect(error, maxval(abs(row%slope - row%order)) < 0.1_dp + 0.03_dp*row%order, &
            "slopes of "//trim(names(i)))
      end do
   end subroutine test_table

   !> What `poinsot hard` says of promises and tops: every verdict is good, one that is not is seen,
   !> and unknown names are refused.
   subroutine test_promises(error)
      type(error_type), allocatable, intent(out) :: error
      type(hard_row), allocatable :: rows(:)
      type(hard_row) :: row
      type(counting_watch) :: watch
      type(poinsot_error) :: problem
      integer :: m, i, unit
      open (newunit=unit, status="scratch", action="readwrite")
      do i = 1, size(promise_names)
         call measure_rows(trim(promise_names(i)), watch, rows)
         call judge_rows(error, rows, method_count())
         if (allocated(error)) return
      end do
      do i = 1, size(top_names)
         call measure_rows(trim(top_names(i)), watch, rows)
         call judge_rows(error, rows, count([(is_table(m), m=1, splitting_count())]))
         if (allocated(error)) return
      end do
      do i = 1, size(series_names)
         call measure_rows(trim(series_names(i)), watch, rows)
         call judge_rows(error, rows, 1)
         if (allocated(error)) return
         call expect(error, rows(1)%who, "taylor")
      end do
      call expect(error, watch%told, size(promise_names) + size(top_names) + size(series_names), &
         "cases told of")
      call measure_rows("taylor", watch, rows)
      call judge_rows(error, rows, size(series_names))
      call run_hard("srkn6", "", unit, watch, problem)
      call expect(error, problem%code, 0, "a verdict on srkn6 is bad")
      call run_hard("seperatrix", "", unit, watch, problem)
      call expect(error, index(problem%message, "'separatrix'") > 0, "an unknown name is taken")
      close (unit)
      if (allocated(error)) return
      row%good = .false.
      call expect(error, verdict_words(row), "BROKEN")
   end subroutine test_promises

   !> By scale and by moments of the body's own: rows of both exact methods, right to rounding on
   !> the bodies that ask most of the constants.
   subroutine test_own(error)
      type(error_type), allocatable, intent(out) :: error
      character(11), parameter :: cases(3) = [character(11) :: "generic", "wide", "linear"]
      type(hard_row), allocatable :: rows(:)
      type(counting_watch) :: watch
      integer :: i, k
      do i = 1, size(cases)
         call measure_rows(trim(cases(i)), watch, rows)
         call judge_rows(error, rows, 3*method_count() + 4)
         if (allocated(error)) return
         do k = find_row(rows, cases(i), "exact", "scale"), find_row(rows, cases(i), "exact", &
               "moments")
            call expect(error, rows(k)%counts%answered, 2*cases_of_kind, "cases by "// &
               trim(rows(k)%approach))
            call expect(error, rows(k)%figure < 5, "exact by "//trim(rows(k)%approach)//": "// &
               text(rows(k)%figure)//" units")
         end do
         k = find_row(rows, cases(i), "jacobi", "moments")
         call expect(error, k > 0 .and. find_row(rows, cases(i), "dmv2", "moments") == 0, &
            "rows by moments")
      end do
   end subroutine test_own

   subroutine judge_rows(error, rows, wanted)
      type(error_type), allocatable, intent(inout) :: error
      type(hard_row), intent(in) :: rows(:)
      integer, intent(in) :: wanted
      integer :: i
      call expect(error, size(rows), wanted, "rows of a case")
      do i = 1, size(rows)
         if (allocated(error)) return
         call expect(error, rows(i)%good, trim(rows(i)%case)//" by "//trim(rows(i)%who)//": "// &
            text(rows(i)%figure)//" breaks the bound")
      end do
   end subroutine judge_rows

   !> The judge of the hard cases and its condition numbers against the tests' own.
   subroutine test_judge(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(random_body) :: body
      type(taylor_report) :: report
      real(qp) :: inverse(3), y(3), q(4), z(3), r(4)
      real(dp) :: gap, c(4), d(4)
      integer :: k
      stream = start_stream(67)
      do k = 1, 12
         call hard_body(stream, body_kinds(k), 10.0_dp, body)
         inverse = 0
         where (body%moments > 0) inverse = 1/real(body%moments, qp)
         y = body%y
         q = body%q
         z = y
         r = q
         call judge_flow(inverse, real(body%h, qp), y, q, .false.)
         call taylor_flow(free_problem(body%moments), real(body%h, qp), z, r, report)
         call conditioning(body%moments, body%y, body%h, c(1), c(2), c(3), c(4))
         gap = momentum_distance(y, z) + attitude_distance(q, r)
         call expect(error, gap < 1.0e-28_dp*maxval(c), &
            "judge on "//trim(body_kinds(k))//": "//text(gap))
         call judge_conditioning(body%moments, body%y, body%h, .true., d(1), d(2))
         call judge_conditioning(body%moments, body%y, body%h, .false., d(3), d(4))
         if (body_kinds(k) == "middle" .or. body_kinds(k) == "separatrix") cycle
         call expect(error, maxval(abs(log(d/c))) < 0.1_dp, "condition numbers on "//body_kinds(k))
      end do
   end subroutine test_judge

   !> exact and jacobi are right to rounding on every hard case, and nothing ever fails otherwise
   !> than by a refusal; the cases are what they promise.
   subroutine test_hard(error)
      type(error_type), allocatable, intent(out) :: error
      type(hard_result), allocatable :: results(:, :)
      type(hard_case) :: one
      type(free_method) :: method
      type(poinsot_error) :: refusal
      real(dp) :: units
      integer :: kind, number, m
      allocate (results(method_count(), approaches))
      do kind = 1, size(kind_names)
         do number = 1, cases_of_kind
            call make_case(kind, number, one)
            associate (i => one%moments)
               call expect(error, maxval(i)*(1 - 1.0e-15_dp) <= sum(i) - maxval(i) .and. &
                          minval(i) >= 0, "no body: "//kind_names(kind))
            end associate
            if (allocated(error)) return
         end do
         if (kind_names(kind) == "long") cycle
         call judge_kind(kind, results)
         call expect(error, all(results%other == 0), "something fails on "//kind_names(kind))
         call expect(error, all(results%part <= 1), "a method does not keep its order on "// &
            kind_names(kind))
         do m = 1, method_count()
            call find_method(method_name(m), method, refusal)
            if (method%order > 0) cycle
            call expect(error, all(results(m, :3)%answered == cases_of_kind) .and. &
               all(results(m, 4:)%answered == 2*cases_of_kind), &
               method_name(m)//" refuses on "//kind_names(kind))
            units = max(results(m, 1)%y, results(m, 1)%q)
            call expect(error, units < 5, "units on "//trim(kind_names(kind))//": "// &
               method_name(m)//" "//text(units))
            units = max(results(m, 3)%y, results(m, 3)%q)
            call expect(error, units < merge(4, 10, method_name(m) == "exact"), &
               "units with compensated sums on "//trim(kind_names(kind))//": "//method_name(m)// &
               " "//text(units))
         end do
      end do
   end subroutine test_hard

end module test_properties
