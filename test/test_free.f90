!> Room free, judged by data, by the quadruple-precision Taylor series and by the reference maps.
module test_free
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_method
   use poinsot_free_method, only: free_method, find_method
   use test_bodies, only: random_stream, start_stream, body_kinds, rate_bound, generic_moments, &
      random_quaternion
   use test_expectation, only: expect
   use test_free_lanes, only: collect_free_lanes
   use test_free_state, only: collect_free_state
   use test_free_tools, only: method_names, method_orders, approximate_count, generic, start, &
      turn_body, text, library_map, worst_of_kind, worst_of_hard, worst_of_map
   use test_measure, only: measure_slope, attitude_distance, momentum_distance, units
   use test_oracle_data, only: free_case, read_free_rotation, published, published_1, &
      published_2a, published_2b, published_4_y
   use test_oracle_dmv, only: inverse_moments
   use test_oracle_properties, only: property_report, measure_properties
   use test_oracle_taylor, only: taylor_report, taylor_flow, free_problem
   implicit none(type, external)
   private
   public :: collect_free

contains

   !> Tests of the free rotors.
   subroutine collect_free(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      type(unittest_type), allocatable :: state(:), in_lanes(:)
      call collect_free_state(state)
      call collect_free_lanes(in_lanes)
      testsuite = [ &
         new_unittest("registry", test_registry), &
         new_unittest("orders", test_orders), &
         new_unittest("reference-maps", test_maps), &
         new_unittest("invariants", test_invariants), &
         new_unittest("properties", test_properties), &
         new_unittest("published", test_published), &
         new_unittest("published-unphysical", test_published_unphysical), &
         new_unittest("data-exact", test_data_exact), &
         new_unittest("data-jacobi", test_data_jacobi), &
         new_unittest("data-dmv16", test_data_dmv), &
         new_unittest("data-moments-of-each", test_data_each), &
         new_unittest("hard-bodies-moments-of-each", test_hard_each), &
         new_unittest("hard-bodies", test_hard), &
         new_unittest("hard-bodies-jacobi", test_hard_jacobi), &
         state, &
         in_lanes]
   end subroutine collect_free

   ! The methods
   ! -------------------------------------------------------------------------------------

   !> Every name is known, with its order; other names are refused with a message.
   subroutine test_registry(error)
      type(error_type), allocatable, intent(out) :: error
      character(12), parameter :: wrong(6) = [character(12) :: "dmv", "dmv3", "dmv26", "Exact", &
         "", "euler"]
      type(free_method) :: method
      type(poinsot_error) :: answer
      integer :: i
      do i = 1, approximate_count
         call find_method(trim(method_names(i)), method, answer)
         call expect(error, .not. raised(answer), "unknown method "//method_names(i))
         call expect(error, method%order, method_orders(i), "order of "//method_names(i))
      end do
      call find_method("exact", method, answer)
      call expect(error, method%order, 0)
      do i = 1, size(wrong)
         answer = poinsot_error()
         call find_method(trim(wrong(i)), method, answer)
         call expect(error, answer%code, poinsot_e_method, &
                    "should be refused: '"//trim(wrong(i))// "'")
         call expect(error, allocated(answer%message), "refused without a message")
         if (allocated(error)) return
      end do
   end subroutine test_registry

   !> Global error over t = 1 against the Taylor series: the slope is the order, in y and in q.
   subroutine test_orders(error)
      type(error_type), allocatable, intent(out) :: error
      type(taylor_report) :: report
      real(qp) :: yt(3), qt(4)
      real(dp) :: y(3), q(4), h(6), ey(6), eq(6), slope(2), momentum(3)
      integer :: i, k, n, status, used(2)
      momentum = 3*start
      yt = momentum
      qt = [1, 0, 0, 0]
      call taylor_flow(free_problem(generic), 1.0_qp, yt, qt, report)
      do i = 1, 9 ! dmv10 is the last with three points above rounding
         do k = 1, 6
            n = nint((4 + 30.0_dp/method_orders(i))*1.35_dp**(k - 1))
            h(k) = 1.0_dp/n
            y = momentum
            q = [1, 0, 0, 0]
            call turn_body(method_names(i), generic, h(k), n, y, q, status)
            call expect(error, status, poinsot_ok, "status of "//method_names(i))
            ey(k) = momentum_distance(real(y, qp), yt)
            eq(k) = attitude_distance(real(q, qp), qt)
         end do
         call measure_slope(h, ey, 1.0e-15_dp, slope(1), used(1))
         call measure_slope(h, eq, 1.0e-15_dp, slope(2), used(2))
         call expect(error, &
            maxval(abs(slope - method_orders(i))) < 0.05_dp + 0.03_dp*method_orders(i), &
            "slopes of "//trim(method_names(i))//": "//text(slope(1))//", "//text(slope(2)))
      end do
   end subroutine test_orders

   !> One step of every approximate method against its reference map in quadruple precision, on
   !> every kind of body.
   subroutine test_maps(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: worst
      integer :: i, k
      do i = 1, approximate_count
         do k = 1, size(body_kinds)
            call worst_of_map(method_names(i), body_kinds(k), 12, worst)
            call expect(error, worst < 5, trim(method_names(i))//" is "//text(worst)// " e-16 " // &
                       "off its reference map on "// body_kinds(k))
         end do
      end do
   end subroutine test_maps

   !> The review's Table 2, columns Qy, C, H: kept to rounding over many steps, or visibly not.
   subroutine test_invariants(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      real(dp) :: y(3), q(4), moments(3), defect(4), most(4)
      integer :: i, k, status
      logical :: splits
      do i = 1, approximate_count + 1
         stream = start_stream(5)
         most = 0
         do k = 1, 6
            moments = generic_moments(stream)
            q = random_quaternion(stream)
            y = start
            defect = invariants(moments, y, q)
            call turn_body(method_names(i), moments, 0.3_dp, 100, y, q, status)
            defect = abs(invariants(moments, y, q) - defect)
            most = max(most, defect)
         end do
         splits = i <= 2
         call expect(error, most(1) < 2.0e-14_dp, trim(method_names(i))//" loses Qy: "// &
            text(most(1)))
         call expect(error, most(2) < 2.0e-14_dp, trim(method_names(i))//" loses |y|: "// &
            text(most(2)))
         call expect(error, (most(3) < 2.0e-14_dp) .neqv. splits, trim(method_names(i))// &
            " energy: "//text(most(3)))
         call expect(error, most(4) < 2.0e-14_dp, trim(method_names(i))//" loses |q|: "// &
            text(most(4)))
      end do
   end subroutine test_invariants

   !> A component of Qy, |y|, H, |q|; of order one.
   pure function invariants(moments, y, q) result(v)
      real(dp), intent(in) :: moments(3), y(3), q(4)
      real(dp) :: v(4)
      v(1) = 2*((q(2)*q(4) - q(1)*q(3))*y(1) + (q(3)*q(4) + q(1)*q(2))*y(2)) &
         + (q(1)**2 - q(2)**2 - q(3)**2 + q(4)**2)*y(3)
      v(2) = norm2(y)
      v(3) = sum(y*y/moments)/2
      v(4) = norm2(q)
   end function invariants

   !> The review's Table 2, columns Poisson and symplectic, on the library's own maps.
   subroutine test_properties(error)
      type(error_type), allocatable, intent(out) :: error
      character(20), parameter :: names(7) = [character(20) :: "exact", "three-rotations", &
         "symmetric-rotation", &
         "dmv2", "dmv4", "dmv8", "midpoint"]
      logical, parameter :: poisson(7) = [.true., .true., .true., .true., .true., .true., .false.]
      logical, parameter :: symplectic(7) = [.true., .true., .true., .true., .false., &
         .false., .false.]
      real(dp), parameter :: small = 1.0e-10_dp
      type(library_map) :: map
      type(property_report) :: p
      integer :: i
      map%moments = generic
      map%delta = 1.0e-2_qp
      do i = 1, size(names)
         map%name = names(i)
         call measure_properties(map, inverse_moments(generic), 0.6_qp, real(start, qp), &
            [0.1_qp, 0.7_qp, -0.5_qp, 0.5_qp], p)
         call expect(error, p%ok, trim(names(i))//" has no answer")
         call expect(error, (p%poisson < small) .eqv. poisson(i), trim(names(i))//" Poisson: "// &
            text(p%poisson))
         call expect(error, (p%symplectic < small) .eqv. symplectic(i), &
            trim(names(i))//" symplectic: "//text(p%symplectic))
         call expect(error, max(p%symmetric, p%reversible, p%equivariant) < 5.0e-15_dp, &
            trim(names(i))//" reversal: "//text(max(p%symmetric, p%reversible, p%equivariant)))
      end do
   end subroutine test_properties

   !> Published end states 1, 2 (first body) and 4, to the printed digits.
   subroutine test_published(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_published(error, published_1, "figure 1 of the review")
      if (allocated(error)) return
      call judge_published(error, published_2a, "Hairer and Vilmart, first body")
      if (allocated(error)) return
      call judge_published(error, published_4_y, "TOMS 903")
   end subroutine test_published

   !> Published end state 2, second body: its moments break the triangle inequality by two parts in
   !> a thousand, yet it is published, so it must run.
   subroutine test_published_unphysical(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_published(error, published_2b, "Hairer and Vilmart, second body")
   end subroutine test_published_unphysical

   !> dmv10 and exact against a published motion, allowing a few roundings over thousands of steps.
   subroutine judge_published(error, motion, source)
      type(error_type), allocatable, intent(out) :: error
      type(published), intent(in) :: motion
      character(*), intent(in) :: source
      character(5), parameter :: names(2) = [character(5) :: "dmv10", "exact"]
      real(dp) :: y(3), q(4), allowed, gap
      integer :: k, steps, status
      steps = nint(motion%t/motion%h)
      do k = 1, size(names)
         y = motion%y
         q = [1, 0, 0, 0]
         call turn_body(names(k), motion%moments, motion%h, steps, y, q, status, physical=.false.)
         call expect(error, status, poinsot_ok, names(k)//" refuses: "//source)
         allowed = max(motion%digits, 1.0e-17_dp*steps)
         if (k == 1 .and. steps == 1) allowed = 1.0e-14_dp ! one long step of order 10
         gap = maxval(abs(y - motion%y_end))
         if (any(motion%q_end /= 0)) gap = max(gap, maxval(abs(q - motion%q_end)))
         call expect(error, gap < allowed, names(k)//" is "//text(gap)//" off: "//source)
      end do
   end subroutine judge_published

   ! The data file
   ! -----------------------------------------------------------------------------------

   !> All the named kinds within `allowed` units.
   subroutine judge_kinds(error, name, kinds, allowed)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: name, kinds(:)
      real(dp), intent(in) :: allowed
      type(free_case), allocatable :: cases(:)
      real(dp) :: worst_y, worst_q
      integer :: k, line
      character(4) :: where_
      call read_free_rotation(cases)
      call expect(error, size(cases), 264)
      if (allocated(error)) return
      do k = 1, size(kinds)
         call worst_of_kind(name, kinds(k), cases, worst_y, worst_q, line)
         write (where_, "(i4)") line
         call expect(error, max(worst_y, worst_q) <= allowed, &
                    trim(name)//" on "//trim(kinds(k))//": y "//text(worst_y)//", q "// &
                    text(worst_q)//" units of conditioning, line "//where_)
      end do
   end subroutine judge_kinds

   subroutine test_data_exact(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_kinds(error, "exact", [character(12) :: "generic", "nearsym", "flat", &
         "nearlinear", "linear", &
         "sphere", "separatrix", "axis", "rest", "scaleI", "middle", "long"], 4.0_dp)
   end subroutine test_data_exact

   subroutine test_data_jacobi(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_kinds(error, "jacobi", [character(12) :: "generic", "nearsym", "flat", &
         "nearlinear", "linear", &
         "sphere", "separatrix", "axis", "rest", "long", "middle", "scaleI"], 5.0_dp)
   end subroutine test_data_jacobi

   !> With moments for each body, among others: at most 2 units above.
   subroutine test_data_each(error)
      type(error_type), allocatable, intent(out) :: error
      character(12), parameter :: kinds(12) = [character(12) :: "generic", "nearsym", "flat", &
         "nearlinear", "linear", "sphere", "separatrix", "axis", "rest", "scaleI", "middle", "long"]
      call judge_kinds(error, "each-exact", kinds, 6.0_dp)
      if (allocated(error)) return
      call judge_kinds(error, "each-jacobi", kinds, 7.0_dp)
   end subroutine test_data_each

   subroutine test_hard_each(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_hard(error, "each-exact", 0.1_dp, 5.0_dp)
      if (allocated(error)) return
      call judge_hard(error, "each-exact", 0.7_dp, 7.0_dp)
      if (allocated(error)) return
      call judge_hard(error, "each-exact", 20.0_dp, 10.0_dp)
      if (allocated(error)) return
      call judge_hard(error, "each-jacobi", 20.0_dp, 10.0_dp)
   end subroutine test_hard_each

   !> dmv16 on short pieces of the same motions: the series has converged, so it is as good as
   !> exact.
   subroutine test_data_dmv(error)
      type(error_type), allocatable, intent(out) :: error
      type(free_case), allocatable :: cases(:)
      real(dp) :: y(3), q(4), ey, eq
      integer :: i, n, status
      call read_free_rotation(cases)
      do i = 1, size(cases)
         n = ceiling(3*rate_bound(cases(i)%moments, cases(i)%y)*abs(cases(i)%h))
         if (n > 60 .or. cases(i)%kind == "middle") cycle
         y = cases(i)%y
         q = [1, 0, 0, 0]
         call turn_body("dmv16", cases(i)%moments, cases(i)%h/max(n, 1), max(n, 1), y, q, status)
         ey = units(momentum_distance(real(y, qp), cases(i)%y_end), cases(i)%cond_y)
         eq = units(attitude_distance(real(q, qp), cases(i)%turn), cases(i)%cond_r)
         call expect(error, status, poinsot_ok, "dmv16 fails on "//cases(i)%kind)
         call expect(error, max(ey, eq) < 8 + 0.3_dp*n, "dmv16 on "//trim(cases(i)%kind)//": y "// &
            text(ey)//", q "//text(eq))
      end do
   end subroutine test_data_dmv

   ! Hard random bodies
   ! ------------------------------------------------------------------------------

   !> `exact` on every kind of hard body, one short step and steps that need substeps.
   subroutine test_hard(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_hard(error, "exact", 0.7_dp, 5.0_dp)
      if (allocated(error)) return
      call judge_hard(error, "exact", 20.0_dp, 8.0_dp)
   end subroutine test_hard

   subroutine test_hard_jacobi(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_hard(error, "jacobi", 20.0_dp, 8.0_dp)
   end subroutine test_hard_jacobi

   subroutine judge_hard(error, name, reach, allowed)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: name
      real(dp), intent(in) :: reach, allowed
      real(dp) :: worst_y, worst_q
      integer :: k
      do k = 1, size(body_kinds)
         call worst_of_hard(name, body_kinds(k), reach, 25, worst_y, worst_q)
         call expect(error, max(worst_y, worst_q) < allowed, trim(name)//" on hard "// &
            trim(body_kinds(k))//" bodies: y "// &
            text(worst_y)//", q "//text(worst_q)//" units of conditioning")
      end do
   end subroutine judge_hard

end module test_free
