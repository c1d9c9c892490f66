!> The judges judged: the tests' own instruments against data and against each other, without the
!> library.
module test_oracle
   use testdrive, only: new_unittest, unittest_type, error_type, test_failed
   use poinsot_core_kinds, only: dp, qp
   use test_bodies, only: random_body, random_stream, start_stream, hard_body, body_kinds, &
      rate_bound, uniform, log_uniform, permute_body
   use test_expectation, only: expect
   use test_measure, only: measure_slope, attitude_distance, momentum_distance
   use test_oracle_data, only: free_case, read_free_rotation, top_case, read_top, dmv_term, &
      read_dmv_coefficients, published_3
   use test_oracle_dmv, only: table_1, rational_coefficients, exact_inverses, modified_inverses, &
      truncated_inverses, reference_map, make_reference, inverse_moments
   use test_oracle_properties, only: property_report, measure_properties
   use test_oracle_taylor, only: taylor_report, taylor_flow, taylor_verified, free_problem, &
      top_problem, conditioning, taylor_problem
   implicit none(type, external)
   private
   public :: collect_oracle

   real(dp), parameter :: moments(3) = [0.8_dp, 0.55_dp, 0.95_dp], momentum(3) = [0.5_dp, &
      -0.6_dp, 0.4_dp]

contains

   !> Tests of the instruments.
   subroutine collect_oracle(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("slope", test_slope), &
         new_unittest("taylor-free-data", test_taylor_free), &
         new_unittest("taylor-top-data", test_taylor_top), &
         new_unittest("taylor-published-top", test_taylor_published), &
         new_unittest("taylor-fields", test_taylor_fields), &
         new_unittest("conditioning", test_conditioning), &
         new_unittest("table-1-is-rational", test_table), &
         new_unittest("series-is-exact", test_series), &
         new_unittest("two-ways-to-the-series", test_truncated), &
         new_unittest("reference-orders", test_orders), &
         new_unittest("reference-properties", test_properties), &
         new_unittest("random-bodies", test_random)]
   end subroutine collect_oracle

   !> A made-up error 3 h**4 on a plateau of 1e-15, and too few points.
   subroutine test_slope(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: h(8), slope
      integer :: i, used
      h = [(0.4_dp/3**i, i=1, 8)]
      call measure_slope(h, max(3*h**4, 1.0e-15_dp), 1.0e-15_dp, slope, used)
      call expect(error, slope, 4.0_dp, thr=1.0e-10_dp)
      call expect(error, used >= 5 .and. used < 8, "the plateau was not dropped")
      call measure_slope(h, 3*h**4, 1.0e-4_dp, slope, used)
      call expect(error, slope == 0, "two points are no slope")
   end subroutine test_slope

   !> The series against the data file, to quadruple precision.
   subroutine test_taylor_free(error)
      type(error_type), allocatable, intent(out) :: error
      type(free_case), allocatable :: cases(:)
      type(taylor_report) :: report
      real(qp) :: y(3), q(4)
      real(dp) :: worst
      integer :: i, n
      call read_free_rotation(cases)
      call expect(error, size(cases), 264)
      if (allocated(error)) return
      n = 0
      worst = 0
      do i = 1, size(cases), 2
         if (rate_bound(cases(i)%moments, cases(i)%y)*abs(cases(i)%h) > 12) cycle
         y = cases(i)%y
         q = [1, 0, 0, 0]
         call taylor_flow(free_problem(cases(i)%moments), real(cases(i)%h, qp), y, q, report)
         worst = max(worst, momentum_distance(y, cases(i)%y_end)/cases(i)%cond_y)
         worst = max(worst, attitude_distance(q, cases(i)%turn)/cases(i)%cond_r)
         n = n + 1
         if (.not. report%finished) exit
      end do
      call expect(error, n > 60, "too few cases of moderate h")
      call expect(error, worst < 1.0e-23_dp, "Taylor series and data file differ")
   end subroutine test_taylor_free

   !> The series against top.csv: the first row to all its digits, the others to the rounding of
   !> their attitudes.
   subroutine test_taylor_top(error)
      type(error_type), allocatable, intent(out) :: error
      type(top_case), allocatable :: cases(:)
      type(taylor_report) :: report
      real(qp) :: y(3), q(4)
      real(dp) :: worst
      integer :: i
      call read_top(cases)
      call expect(error, size(cases) > 10, "top.csv has too few rows")
      if (allocated(error)) return
      worst = 0
      do i = 1, size(cases), 4
         y = cases(i)%y
         q = cases(i)%q/sqrt(sum(real(cases(i)%q, qp)**2))
         call taylor_flow(top_problem(cases(i)%moments, cases(i)%centre, cases(i)%direction), &
            real(cases(i)%t, qp), y, q, report)
         worst = max(momentum_distance(y, cases(i)%y_end), attitude_distance(q, cases(i)%q_end))
         if (worst > merge(1.0e-24_dp, 3.0e-16_dp, i == 1)) exit
      end do
      call expect(error, i > size(cases), "Taylor series and top.csv differ")
   end subroutine test_taylor_top

   !> The published end state of the top, to its printed digits.
   subroutine test_taylor_published(error)
      type(error_type), allocatable, intent(out) :: error
      type(taylor_report) :: report
      real(qp) :: y(3), q(4)
      y = published_3%y
      q = [1, 0, 0, 0]
      call taylor_flow(top_problem(published_3%moments, [0.0_dp, 0.0_dp, 1.0_dp], &
                       [0.0_dp, 0.0_dp, 1.0_dp]), real(published_3%t, qp), y, q, report)
      call expect(error, maxval(abs(y - published_3%y_end)) < published_3%digits, "momentum")
      call expect(error, maxval(abs(q - published_3%q_end)) < published_3%digits, "attitude")
   end subroutine test_taylor_published

   !> Quadratic field and internal rotor: energy and k.Qy kept, two different runs agree.
   subroutine test_taylor_fields(error)
      type(error_type), allocatable, intent(out) :: error
      type(taylor_problem) :: problem
      type(taylor_report) :: report
      real(qp) :: y(3), q(4)
      problem = top_problem(moments, [0.1_dp, -0.3_dp, 0.4_dp], [0.6_dp, 0.0_dp, 0.8_dp])
      problem%stiffness = reshape([0.5_qp, 0.1_qp, 0.0_qp, 0.1_qp, -0.3_qp, 0.2_qp, 0.0_qp, &
         0.2_qp, 0.7_qp], [3, 3])
      problem%spin = [0.2_qp, 0.1_qp, -0.3_qp]
      y = momentum
      q = [0.5_qp, 0.5_qp, -0.5_qp, 0.5_qp]
      call taylor_verified(problem, -2.0_qp, y, q, report)
      call expect(error, report%difference < 1.0e-29_qp, "two runs differ")
      call expect(error, max(report%energy, report%momentum, report%norm) < 1.0e-29_qp, &
         "an invariant is lost")
   end subroutine test_taylor_fields

   !> Our condition numbers against those of the data file.
   subroutine test_conditioning(error)
      type(error_type), allocatable, intent(out) :: error
      type(free_case), allocatable :: cases(:)
      real(dp) :: c(4), expected(4)
      integer :: i, n
      call read_free_rotation(cases)
      n = 0
      do i = 1, size(cases), 11
         if (rate_bound(cases(i)%moments, cases(i)%y)*abs(cases(i)%h) > 12 .or. &
            all(cases(i)%y == 0)) cycle
         call conditioning(cases(i)%moments, cases(i)%y, cases(i)%h, c(1), c(2), c(3), c(4))
         expected = [cases(i)%cond_y, cases(i)%cond_r, cases(i)%state_y, cases(i)%state_r]
         if (cases(i)%kind == "linear") c(1:2) = expected(1:2) ! there the two moments go together
         call expect(error, maxval(abs(log(c/expected))) < log(1.5_dp), "condition numbers of "// &
            cases(i)%kind)
         n = n + 1
      end do
      call expect(error, n > 8, "too few cases")
   end subroutine test_conditioning

   !> Table 1 as printed equals the rational polynomials.
   subroutine test_table(error)
      type(error_type), allocatable, intent(out) :: error
      type(dmv_term), allocatable :: terms(:)
      type(random_stream) :: stream
      real(qp) :: i(3), c, h, s(3:7), t(3:7), rs(3:23), rt(3:23), worst
      integer :: j, k
      call read_dmv_coefficients(terms)
      call expect(error, size(terms), 1689)
      if (allocated(error)) return
      stream = start_stream(3)
      worst = 0
      do j = 1, 20
         do k = 1, 3
            i(k) = 0.5_qp + uniform(stream)
         end do
         c = uniform(stream)
         h = uniform(stream)
         call table_1(i, c, h, s, t)
         call rational_coefficients(terms, 1/i, c, h, 7, rs, rt)
         do k = 3, 7, 2
            worst = max(worst, abs(s(k) - rs(k)), abs(t(k) - rt(k)))
         end do
      end do
      call expect(error, worst < 1.0e-30_qp, "Table 1 and the rational coefficients differ")
   end subroutine test_table

   !> The series to order 24 converges to the inverses that make Moser-Veselov the exact flow.
   subroutine test_series(error)
      type(error_type), allocatable, intent(out) :: error
      type(dmv_term), allocatable :: terms(:)
      real(dp), parameter :: rising(3) = [0.55_dp, 0.8_dp, 0.95_dp]
      real(qp) :: exact(3), series(3), h
      real(dp) :: gap(2), slope
      integer :: k, order
      call read_dmv_coefficients(terms)
      do order = 4, 24, 4
         do k = 1, 2
            h = 0.2_qp/2**k
            call exact_inverses(rising, h, 0.6_qp, -0.7_qp, exact)
            call modified_inverses(terms, inverse_moments(rising), order, h, [0.6_qp, 0.0_qp, &
               -0.7_qp], series)
            gap(k) = real(maxval(abs(series - exact)), dp)
         end do
         slope = log(gap(1)/gap(2))/log(2.0_dp)
         if (abs(slope - order) < 0.3_dp) cycle
         if (gap(1) < 1.0e-27_dp) cycle
         call test_failed(error, "the inverses miss their order")
         return
      end do
   end subroutine test_series

   !> Rational polynomials and power series give the same modified inverses, for any labels of the
   !> axes.
   subroutine test_truncated(error)
      type(error_type), allocatable, intent(out) :: error
      type(dmv_term), allocatable :: terms(:)
      type(random_stream) :: stream
      type(random_body) :: body
      character(12), parameter :: kinds(4) = [character(12) :: "generic", "nearsym", "flat", &
         "sphere"]
      real(qp) :: one(3), other(3)
      integer :: i, order
      call read_dmv_coefficients(terms)
      stream = start_stream(7)
      do i = 1, 40
         call hard_body(stream, kinds(1 + mod(i, 4)), 1.0_dp, body)
         order = 2 + 2*mod(i, 12)
         call modified_inverses(terms, inverse_moments(body%moments), order, real(body%h, qp), &
            real(body%y, qp), one)
         call truncated_inverses(real(body%moments, qp), order, real(body%h, qp), &
                                 real(body%y, qp), other)
         call expect(error, maxval(abs(other/one - 1)) < 1.0e-26_qp, "they differ " // &
                    "for "// trim(body%kind)//": "// text(real(maxval(abs(other/one - 1)), dp)))
      end do
   end subroutine test_truncated

   !> Every reference map has its order, in y and in q.
   subroutine test_orders(error)
      type(error_type), allocatable, intent(out) :: error
      character(20), parameter :: names(8) = [character(20) :: "midpoint", "three-rotations", &
         "symmetric-rotation", &
         "dmv2", "dmv4", "dmv8", "dmv16", "dmv24"]
      integer, parameter :: orders(8) = [2, 2, 2, 2, 4, 8, 16, 24]
      type(reference_map) :: map
      type(taylor_report) :: report
      real(qp) :: y(3), q(4), z(3), r(4)
      real(dp) :: h(4), ey(4), eq(4), slope(2)
      integer :: i, k, used(2)
      logical :: ok
      do i = 1, size(names)
         call make_reference(names(i), moments, map)
         do k = 1, 4
            h(k) = (0.2_dp + 0.04_dp*orders(i))/1.3_dp**k
            y = momentum
            q = [1, 0, 0, 0]
            z = y
            r = q
            call map%apply(real(h(k), qp), y, q, ok)
            call taylor_flow(free_problem(moments), real(h(k), qp), z, r, report)
            ey(k) = momentum_distance(y, z)
            eq(k) = attitude_distance(q, r)
            if (.not. ok) exit
         end do
         call measure_slope(h, ey, 1.0e-32_dp, slope(1), used(1))
         call measure_slope(h, eq, 1.0e-32_dp, slope(2), used(2))
         call expect(error, maxval(abs(slope - orders(i) - 1)) < 0.1_dp + 0.04_dp*orders(i), &
            "local order of "//trim(names(i))//": "//text(slope(1))//text(slope(2)))
      end do
   end subroutine test_orders

   !> What each reference map keeps, and what it does not: the measured Table 2 of the review.
   subroutine test_properties(error)
      type(error_type), allocatable, intent(out) :: error
      character(20), parameter :: names(7) = [character(20) :: "exact", "three-rotations", &
         "symmetric-rotation", &
         "midpoint", "dmv2", "dmv4", "dmv8"]
      logical, parameter :: poisson(7) = [.true., .true., .true., .false., .true., .true., .true.]
      logical, parameter :: symplectic(7) = [.true., .true., .true., .false., .true., &
         .false., .false.]
      logical, parameter :: energy(7) = [.true., .false., .false., .true., .true., .true., .true.]
      type(reference_map) :: map
      type(property_report) :: p
      integer :: i
      do i = 1, size(names)
         call make_reference(names(i), moments, map)
         call measure_properties(map, map%inverse, 0.5_qp, real(momentum, qp), [0.1_qp, 0.7_qp, &
            -0.5_qp, 0.5_qp], p)
         call expect(error, p%ok, names(i)//" has no answer")
         call agrees(error, names(i), "Poisson", p%poisson, poisson(i))
         if (allocated(error)) return
         call agrees(error, names(i), "symplectic", p%symplectic, symplectic(i))
         if (allocated(error)) return
         call agrees(error, names(i), "energy", p%energy, energy(i))
         if (allocated(error)) return
         call agrees(error, names(i), "common", max(p%symmetric, p%reversible, p%space_momentum, &
                     p%casimir, p%norm, p%equivariant), .true.)
         if (allocated(error)) return
      end do
   end subroutine test_properties

   !> A defect is either far below 1e-18 or far above 1e-9.
   subroutine agrees(error, name, property, defect, holds)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: name, property
      real(dp), intent(in) :: defect
      logical, intent(in) :: holds
      if (holds) then
         call expect(error, defect < 1.0e-18_dp, trim(name)//" should keep: "//property)
      else
         call expect(error, defect > 1.0e-9_dp, trim(name)//" should break: "//property)
      end if
   end subroutine agrees

   !> The random bodies are physical, spread over the decades they promise, and permute properly.
   subroutine test_random(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(random_body) :: body, other
      type(taylor_report) :: report
      real(qp) :: y(3), q(4), z(3), r(4)
      real(dp) :: thin
      integer :: k, j
      stream = start_stream(1)
      thin = 1
      do k = 1, size(body_kinds)
         do j = 1, 30
            call hard_body(stream, body_kinds(k), 100.0_dp, body)
            associate (i => body%moments)
               call expect(error, maxval(i)*(1 - 1.0e-15_dp) <= sum(i) - maxval(i), &
                  "unphysical "// &
                  body_kinds(k))
               thin = min(thin, minval(i)/maxval(i))
            end associate
            call expect(error, rate_bound(body%moments, body%y)*abs(body%h) < 101, "step of "// &
               body_kinds(k))
         end do
      end do
      call expect(error, thin < 1.0e-7_dp, "no thin body")
      call hard_body(stream, "generic", 1.0_dp, body)
      other = body
      call permute_body([3, 2, 1], other)
      y = body%y
      q = body%q
      z = other%y
      r = other%q
      call taylor_flow(free_problem(body%moments), real(body%h, qp), y, q, report)
      call taylor_flow(free_problem(other%moments), real(body%h, qp), z, r, report)
      call expect(error, maxval(abs(z + y([3, 2, 1]))) + maxval(abs(r(2:4) + &
                 q([4, 3, 2]))) < 1.0e-30_qp, "an odd relabelling is not a mirror image")
      thin = log_uniform(stream, 2.0_dp, 3.0_dp)
      call expect(error, thin > 100 .and. thin < 1000, "log_uniform")
   end subroutine test_random

   !> A number for a message.
   function text(x) result(string)
      real(dp), intent(in) :: x
      character(10) :: string
      write (string, "(es10.3)") x
   end function text

end module test_oracle
