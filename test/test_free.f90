!> Room free, judged by data, by the quadruple-precision Taylor series and by the reference maps.
module test_free
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use, intrinsic :: ieee_exceptions, only: ieee_get_flag, ieee_set_flag, ieee_invalid, ieee_overflow, &
      ieee_divide_by_zero, ieee_set_halting_mode, ieee_get_halting_mode
   use testdrive, only: new_unittest, unittest_type, error_type, check, test_failed, skip_test
   use poinsot_core_kinds, only: dp, qp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_method, poinsot_e_step, poinsot_e_convergence
   use poinsot_body_class, only: body_class, make_class
   use poinsot_free_method, only: free_method, find_method, advance
   use test_bodies, only: random_body, random_stream, start_stream, hard_body, body_kinds, rate_bound, uniform, &
      generic_moments, permute_body, random_quaternion
   use test_measure, only: measure_slope, attitude_distance, momentum_distance, units
   use test_oracle_data, only: free_case, read_free_rotation, dmv_term, read_dmv_coefficients, published, published_1, &
      published_2a, published_2b, published_4_y
   use test_oracle_dmv, only: reference_map, make_reference, inverse_moments
   use test_oracle_properties, only: plain_map, property_report, measure_properties
   use test_oracle_taylor, only: taylor_report, taylor_flow, free_problem, conditioning
   implicit none(type, external)
   private
   public :: collect_free, turn_body, worst_of_kind, worst_of_hard, worst_of_map

   character(20), parameter :: approximate(16) = [character(20) :: "three-rotations", "symmetric-rotation", "midpoint", &
      "dmv2", "dmv4", "dmv6", "dmv8", "dmv10", "dmv12", "dmv14", "dmv16", "dmv18", "dmv20", "dmv22", "dmv24", "exact"]
   integer, parameter :: orders(15) = [2, 2, 2, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24]
   real(dp), parameter :: generic(3) = [0.8_dp, 0.55_dp, 0.95_dp], start(3) = [0.5_dp, -0.6_dp, 0.4_dp]

   !> A method of the library as a map on plain state.
   type, extends(plain_map) :: library_map
      character(20) :: name = ""
      real(dp) :: moments(3) = 1
   contains
      procedure :: apply => apply_library
   end type library_map

contains

   !> Tests of the free rotors.
   subroutine collect_free(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
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
         new_unittest("hard-bodies", test_hard), &
         new_unittest("hard-bodies-jacobi", test_hard_jacobi), &
         new_unittest("symmetric-exact", test_symmetric), &
         new_unittest("reversal", test_reversal), &
         new_unittest("permutations", test_permutations), &
         new_unittest("powers-of-two", test_scaling), &
         new_unittest("lanes", test_lanes), &
         new_unittest("class-and-padding", test_padding), &
         new_unittest("steps", test_steps), &
         new_unittest("refuses-long-step", test_long_step), &
         new_unittest("refuses-bad-state", test_bad_state), &
         new_unittest("frozen-lanes", test_frozen), &
         new_unittest("no-exceptions", test_exceptions), &
         new_unittest("drift", test_drift)]
   end subroutine collect_free

   ! How the tests step ------------------------------------------------------------------------------

   !> `steps` steps of one body, alone in its block (or in the place `lane`).
   subroutine turn_body(name, moments, h, steps, y, q, status, lane, compensate)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(3), q(4)
      integer, intent(out) :: status             !! of the body; or of the call that refused name or moments
      integer, intent(in), optional :: lane
      logical, intent(in), optional :: compensate
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: error
      real(dp) :: yb(lanes, 3), qb(lanes, 4), carry(lanes, 7)
      integer :: sb(lanes), i, l
      call prepare(name, moments, method, class, error)
      status = error%code
      if (raised(error)) return
      l = 1
      if (present(lane)) l = lane
      call rest_block(yb, qb, sb)
      carry = 0
      yb(l, :) = y
      qb(l, :) = q
      do i = 1, steps
         if (present(compensate)) then
            call advance(method, class, h, yb, qb, sb, carry)
         else
            call advance(method, class, h, yb, qb, sb)
         end if
      end do
      y = yb(l, :)
      q = qb(l, :)
      status = sb(l)
   end subroutine turn_body

   !> Method and class by name and moments.
   subroutine prepare(name, moments, method, class, error)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3)
      type(free_method), intent(out) :: method
      type(body_class), intent(out) :: class
      type(poinsot_error), intent(inout) :: error
      call find_method(trim(name), method, error)
      if (raised(error)) return
      call make_class(moments, class, error)
   end subroutine prepare

   subroutine rest_block(y, q, status)
      real(dp), intent(out) :: y(lanes, 3), q(lanes, 4)
      integer, intent(out) :: status(lanes)
      y = 0
      q = 0
      q(:, 1) = 1
      status = poinsot_ok
   end subroutine rest_block

   !> A block of generic states of one body.
   subroutine random_block(stream, y, q)
      type(random_stream), intent(inout) :: stream
      real(dp), intent(out) :: y(lanes, 3), q(lanes, 4)
      integer :: l, j
      do l = 1, lanes
         do j = 1, 3
            y(l, j) = 2*uniform(stream) - 1
         end do
         q(l, :) = random_quaternion(stream)
      end do
   end subroutine random_block

   subroutine apply_library(self, h, y, q, ok)
      class(library_map), intent(in) :: self
      real(qp), intent(in) :: h
      real(qp), intent(inout) :: y(3), q(4)
      logical, intent(out) :: ok
      real(dp) :: yd(3), qd(4)
      integer :: status
      yd = real(y, dp)
      qd = real(q, dp)
      call turn_body(self%name, self%moments, real(h, dp), 1, yd, qd, status)
      y = yd
      q = qd
      ok = status == poinsot_ok
   end subroutine apply_library

   !> Does the library know the method?
   logical function known(name)
      character(*), intent(in) :: name
      type(free_method) :: method
      type(poinsot_error) :: error
      call find_method(trim(name), method, error)
      known = .not. raised(error)
   end function known

   !> A number for a message.
   function text(x) result(string)
      real(dp), intent(in) :: x
      character(:), allocatable :: string
      character(16) :: buffer
      write (buffer, "(es9.2)") x
      string = trim(adjustl(buffer))
   end function text

   ! The methods -------------------------------------------------------------------------------------

   !> Every name is known, with its order; other names are refused with a message.
   subroutine test_registry(error)
      type(error_type), allocatable, intent(out) :: error
      character(12), parameter :: wrong(6) = [character(12) :: "dmv", "dmv3", "dmv26", "Exact", "", "euler"]
      type(free_method) :: method
      type(poinsot_error) :: answer
      integer :: i
      do i = 1, 15
         call find_method(trim(approximate(i)), method, answer)
         call check(error, .not. raised(answer), "unknown method "//approximate(i))
         if (allocated(error)) return
         call check(error, method%order, orders(i), "order of "//approximate(i))
         if (allocated(error)) return
      end do
      call find_method("exact", method, answer)
      call check(error, method%order, 0)
      if (allocated(error)) return
      do i = 1, size(wrong)
         answer = poinsot_error()
         call find_method(trim(wrong(i)), method, answer)
         call check(error, answer%code, poinsot_e_method, "should be refused: '"//trim(wrong(i))//"'")
         if (allocated(error)) return
         call check(error, allocated(answer%message), "refused without a message")
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
      do i = 1, 8 ! dmv10 is the last with three points above rounding
         do k = 1, 6
            n = nint((4 + 30.0_dp/orders(i))*1.35_dp**(k - 1))
            h(k) = 1.0_dp/n
            y = momentum
            q = [1, 0, 0, 0]
            call turn_body(approximate(i), generic, h(k), n, y, q, status)
            call check(error, status, poinsot_ok, "status of "//approximate(i))
            if (allocated(error)) return
            ey(k) = momentum_distance(real(y, qp), yt)
            eq(k) = attitude_distance(real(q, qp), qt)
         end do
         call measure_slope(h, ey, 1.0e-15_dp, slope(1), used(1))
         call measure_slope(h, eq, 1.0e-15_dp, slope(2), used(2))
         call check(error, maxval(abs(slope - orders(i))) < 0.05_dp + 0.03_dp*orders(i), &
            "slopes of "//trim(approximate(i))//": "//text(slope(1))//", "//text(slope(2)))
         if (allocated(error)) return
      end do
   end subroutine test_orders

   !> One step of every method against its reference map in quadruple precision.
   subroutine test_maps(error)
      type(error_type), allocatable, intent(out) :: error
      type(dmv_term), allocatable :: terms(:)
      real(dp) :: worst
      integer :: i
      call read_dmv_coefficients(terms)
      do i = 1, 15
         call worst_of_map(approximate(i), terms, 40, worst)
         call check(error, worst < 10, trim(approximate(i))//" is "//text(worst)//" e-16 off its reference map")
         if (allocated(error)) return
      end do
   end subroutine test_maps

   !> Largest difference, in 1e-16, between a method and its reference map over random generic, nearly symmetric and
   !> flat bodies, h|omega| up to .95; infinite if one of the two has no answer.
   subroutine worst_of_map(name, terms, count, worst)
      character(*), intent(in) :: name
      type(dmv_term), intent(in) :: terms(:)
      integer, intent(in) :: count
      real(dp), intent(out) :: worst
      character(12), parameter :: kinds(4) = [character(12) :: "generic", "nearsym", "flat", "separatrix"]
      type(random_stream) :: stream
      type(random_body) :: body
      type(reference_map) :: map
      real(qp) :: y(3), q(4)
      integer :: i, status
      logical :: ok
      stream = start_stream(11)
      worst = 0
      do i = 1, count
         call hard_body(stream, kinds(1 + mod(i, 4)), 0.95_dp, body)
         call make_reference(name, body%moments, terms, map)
         y = body%y
         q = body%q
         call map%apply(real(body%h, qp), y, q, ok)
         call turn_body(name, body%moments, body%h, 1, body%y, body%q, status)
         if (.not. ok .or. status /= poinsot_ok) worst = huge(worst)
         worst = max(worst, units(momentum_distance(real(body%y, qp), y), 1.0_dp))
         worst = max(worst, units(attitude_distance(real(body%q, qp), q), 1.0_dp))
      end do
   end subroutine worst_of_map

   !> The review's Table 2, columns Qy, C, H: kept to rounding over many steps, or visibly not.
   subroutine test_invariants(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      real(dp) :: y(3), q(4), moments(3), defect(4), most(4)
      integer :: i, k, status
      logical :: splits
      do i = 1, 16
         stream = start_stream(5)
         most = 0
         do k = 1, 6
            moments = generic_moments(stream)
            q = random_quaternion(stream)
            y = start
            defect = invariants(moments, y, q)
            call turn_body(approximate(i), moments, 0.3_dp, 100, y, q, status)
            defect = abs(invariants(moments, y, q) - defect)
            most = max(most, defect)
         end do
         splits = i <= 2
         call check(error, most(1) < 2.0e-14_dp, trim(approximate(i))//" loses Qy: "//text(most(1)))
         if (allocated(error)) return
         call check(error, most(2) < 2.0e-14_dp, trim(approximate(i))//" loses |y|: "//text(most(2)))
         if (allocated(error)) return
         call check(error, (most(3) < 2.0e-14_dp) .neqv. splits, trim(approximate(i))//" energy: "//text(most(3)))
         if (allocated(error)) return
         call check(error, most(4) < 2.0e-14_dp, trim(approximate(i))//" loses |q|: "//text(most(4)))
         if (allocated(error)) return
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
      character(20), parameter :: names(7) = [character(20) :: "exact", "three-rotations", "symmetric-rotation", &
         "dmv2", "dmv4", "dmv8", "midpoint"]
      logical, parameter :: poisson(7) = [.true., .true., .true., .true., .true., .true., .false.]
      logical, parameter :: symplectic(7) = [.true., .true., .true., .true., .false., .false., .false.]
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
         call check(error, p%ok, trim(names(i))//" has no answer")
         if (allocated(error)) return
         call check(error, (p%poisson < small) .eqv. poisson(i), trim(names(i))//" Poisson: "//text(p%poisson))
         if (allocated(error)) return
         call check(error, (p%symplectic < small) .eqv. symplectic(i), &
            trim(names(i))//" symplectic: "//text(p%symplectic))
         if (allocated(error)) return
         call check(error, max(p%symmetric, p%reversible, p%equivariant) < 5.0e-15_dp, &
            trim(names(i))//" reversal: "//text(max(p%symmetric, p%reversible, p%equivariant)))
         if (allocated(error)) return
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

   !> Published end state 2, second body: its moments break the triangle inequality by two parts in a thousand, yet it is
   !> published, so it must run.
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
         call turn_body(names(k), motion%moments, motion%h, steps, y, q, status)
         call check(error, status, poinsot_ok, names(k)//" refuses: "//source)
         if (allocated(error)) return
         allowed = max(motion%digits, 1.0e-17_dp*steps)
         if (k == 1 .and. steps == 1) allowed = 1.0e-14_dp ! one long step of order 10
         gap = maxval(abs(y - motion%y_end))
         if (any(motion%q_end /= 0)) gap = max(gap, maxval(abs(q - motion%q_end)))
         call check(error, gap < allowed, names(k)//" is "//text(gap)//" off: "//source)
         if (allocated(error)) return
      end do
   end subroutine judge_published

   ! The data file -----------------------------------------------------------------------------------

   !> Largest error of a kind of free_rotation.csv, y and q, in units of conditioning. A failed body counts as infinite.
   subroutine worst_of_kind(name, kind, cases, worst_y, worst_q, line)
      character(*), intent(in) :: name, kind
      type(free_case), intent(in) :: cases(:)
      real(dp), intent(out) :: worst_y, worst_q
      integer, intent(out) :: line               !! in the file, of the worst case
      real(dp) :: y(3), q(4), ey, eq, cond(2)
      integer :: i, status
      worst_y = 0
      worst_q = 0
      line = 0
      do i = 1, size(cases)
         if (cases(i)%kind /= kind) cycle
         y = cases(i)%y
         q = [1, 0, 0, 0]
         call turn_body(name, cases(i)%moments, cases(i)%h, 1, y, q, status, lane=1 + mod(i, lanes))
         cond = [cases(i)%cond_y, cases(i)%cond_r]
         if (kind == "nearsym" .or. kind == "nearlinear") cond = [cases(i)%state_y, cases(i)%state_r]
         ey = units(momentum_distance(real(y, qp), cases(i)%y_end), cond(1))
         eq = units(attitude_distance(real(q, qp), cases(i)%turn), cond(2))
         if (status /= poinsot_ok) ey = huge(ey)
         if (max(ey, eq) > max(worst_y, worst_q)) line = cases(i)%line
         worst_y = max(worst_y, ey)
         worst_q = max(worst_q, eq)
      end do
   end subroutine worst_of_kind

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
      call check(error, size(cases), 264)
      if (allocated(error)) return
      do k = 1, size(kinds)
         call worst_of_kind(name, kinds(k), cases, worst_y, worst_q, line)
         write (where_, "(i4)") line
         call check(error, max(worst_y, worst_q) <= allowed, trim(name)//" on "//trim(kinds(k))//": y "// &
            text(worst_y)//", q "//text(worst_q)//" units of conditioning, line "//where_)
         if (allocated(error)) return
      end do
   end subroutine judge_kinds

   subroutine test_data_exact(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_kinds(error, "exact", [character(12) :: "generic", "nearsym", "flat", "nearlinear", "linear", &
         "sphere", "separatrix", "axis", "rest", "scaleI", "middle", "long"], 4.0_dp)
   end subroutine test_data_exact

   subroutine test_data_jacobi(error)
      type(error_type), allocatable, intent(out) :: error
      if (.not. known("jacobi")) then
         call skip_test(error, "jacobi is not there yet")
         return
      end if
      call judge_kinds(error, "jacobi", [character(12) :: "generic", "nearsym", "flat", "nearlinear", "linear", &
         "sphere", "separatrix", "axis", "rest", "long", "middle", "scaleI"], 5.0_dp)
   end subroutine test_data_jacobi

   !> dmv16 on short pieces of the same motions: the series has converged, so it is as good as exact.
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
         call check(error, status, poinsot_ok, "dmv16 fails on "//cases(i)%kind)
         if (allocated(error)) return
         call check(error, max(ey, eq) < 8 + 0.3_dp*n, "dmv16 on "//trim(cases(i)%kind)//": y "//text(ey)//", q "//text(eq))
         if (allocated(error)) return
      end do
   end subroutine test_data_dmv

   ! Hard random bodies ------------------------------------------------------------------------------

   !> Largest error of a method over hard random bodies of a kind against the Taylor series, in units of conditioning.
   subroutine worst_of_hard(name, kind, reach, count, worst_y, worst_q)
      character(*), intent(in) :: name, kind
      real(dp), intent(in) :: reach              !! largest h|omega|
      integer, intent(in) :: count
      real(dp), intent(out) :: worst_y, worst_q
      type(random_stream) :: stream
      type(random_body) :: body
      type(taylor_report) :: report
      real(qp) :: yt(3), qt(4)
      real(dp) :: c(4), ey, eq
      integer :: i, status
      stream = start_stream(17)
      worst_y = 0
      worst_q = 0
      do i = 1, count
         call hard_body(stream, kind, reach, body)
         call conditioning(body%moments, body%y, body%h, c(1), c(2), c(3), c(4))
         if (kind == "nearsym" .or. kind == "nearlinear" .or. kind == "linear") c(1:2) = c(3:4)
         yt = body%y
         qt = body%q/sqrt(sum(real(body%q, qp)**2))
         call taylor_flow(free_problem(body%moments), real(body%h, qp), yt, qt, report)
         call turn_body(name, body%moments, body%h, 1, body%y, body%q, status)
         ey = units(momentum_distance(real(body%y, qp), yt), c(1))
         eq = units(attitude_distance(real(body%q, qp), qt), c(2))
         if (status /= poinsot_ok) ey = huge(ey)
         worst_y = max(worst_y, ey)
         worst_q = max(worst_q, eq)
      end do
   end subroutine worst_of_hard

   !> `exact` on every kind of hard body, one short step and steps that need substeps.
   subroutine test_hard(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_hard(error, "exact", 0.7_dp, 5.0_dp)
      if (allocated(error)) return
      call judge_hard(error, "exact", 20.0_dp, 8.0_dp)
   end subroutine test_hard

   subroutine test_hard_jacobi(error)
      type(error_type), allocatable, intent(out) :: error
      if (.not. known("jacobi")) then
         call skip_test(error, "jacobi is not there yet")
         return
      end if
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
         call check(error, max(worst_y, worst_q) < allowed, trim(name)//" on hard "//trim(body_kinds(k))//" bodies: y "// &
            text(worst_y)//", q "//text(worst_q)//" units of conditioning")
         if (allocated(error)) return
      end do
   end subroutine judge_hard

   ! Symmetries --------------------------------------------------------------------------------------

   !> symmetric-rotation is exact for any two equal moments.
   subroutine test_symmetric(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: moments(3, 4) = reshape([0.7_dp, 0.7_dp, 1.1_dp, 1.1_dp, 0.7_dp, 0.7_dp, &
         0.7_dp, 1.1_dp, 0.7_dp, 0.9_dp, 0.9_dp, 0.9_dp], [3, 4])
      type(taylor_report) :: report
      real(qp) :: yt(3), qt(4)
      real(dp) :: y(3), q(4)
      integer :: k, status
      do k = 1, 4
         y = start
         q = [0.5_dp, -0.5_dp, 0.5_dp, 0.5_dp]
         yt = y
         qt = q
         call turn_body("symmetric-rotation", moments(:, k), -1.1_dp, 1, y, q, status)
         call taylor_flow(free_problem(moments(:, k)), -1.1_qp, yt, qt, report)
         call check(error, momentum_distance(real(y, qp), yt) + attitude_distance(real(q, qp), qt) < 2.0e-15_dp, &
            "not exact for two equal moments: "//text(momentum_distance(real(y, qp), yt))//", "// &
            text(attitude_distance(real(q, qp), qt)))
         if (allocated(error)) return
      end do
   end subroutine test_symmetric

   !> h, then -h: every method comes back; and -h from y is h from -y.
   subroutine test_reversal(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(random_body) :: body
      real(dp) :: y(3), q(4), z(3), r(4), gap
      integer :: i, k, status(4)
      do i = 1, 16
         stream = start_stream(23)
         do k = 1, 12
            call hard_body(stream, merge("generic     ", "flat        ", k > 4), 0.9_dp, body)
            y = body%y
            q = body%q
            call turn_body(approximate(i), body%moments, body%h, 1, y, q, status(1))
            z = y
            r = q
            call turn_body(approximate(i), body%moments, -body%h, 1, z, r, status(2))
            gap = momentum_distance(z, body%y) + attitude_distance(r, body%q)
            z = -body%y
            r = body%q
            call turn_body(approximate(i), body%moments, -body%h, 1, z, r, status(3))
            call check(error, all(status(1:3) == poinsot_ok), "status of "//approximate(i))
            if (allocated(error)) return
            call check(error, gap < 3.0e-15_dp, trim(approximate(i))//" does not come back: "//text(gap))
            if (allocated(error)) return
            call check(error, all(z == -y) .and. all(r == q), &
               trim(approximate(i))//": turning y and h together changes bits")
            if (allocated(error)) return
         end do
      end do
   end subroutine test_reversal

   !> Other labels of the axes, same motion. three-rotations names its axes, so it is left out; symmetric-rotation tells the
   !> two axes of its pair apart by the cyclic order.
   subroutine test_permutations(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: p(3, 5) = reshape([2, 3, 1, 3, 1, 2, 2, 1, 3, 3, 2, 1, 1, 3, 2], [3, 5])
      type(random_body) :: body, other
      real(dp) :: gap
      integer :: i, k, status
      do i = 2, 16
         do k = 1, merge(2, 5, i == 2)
            body%moments = generic
            body%y = start
            body%q = [0.1_dp, 0.7_dp, -0.5_dp, 0.5_dp]
            other = body
            call permute_body(p(:, k), other)
            call turn_body(approximate(i), body%moments, 0.8_dp, 1, body%y, body%q, status)
            call turn_body(approximate(i), other%moments, 0.8_dp, 1, other%y, other%q, status)
            call permute_body(p(:, k), body)
            gap = momentum_distance(body%y, other%y) + attitude_distance(body%q, other%q)
            call check(error, gap < 2.0e-15_dp, trim(approximate(i))//" depends on the labels: "//text(gap))
            if (allocated(error)) return
         end do
      end do
   end subroutine test_permutations

   !> Other units, powers of two: the same bits.
   subroutine test_scaling(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: mass(4) = [-150, 40, 300, -3], rate(4) = [0, 30, -60, 45]
      type(random_stream) :: stream
      type(random_body) :: body
      real(dp) :: y(3), q(4), z(3), r(4)
      integer :: i, k, status(2)
      do i = 1, 17
         if (i == 17) then
            if (.not. known("jacobi")) exit
         end if
         stream = start_stream(29)
         do k = 1, 24
            call hard_body(stream, merge("generic     ", "flat        ", k > 8), 0.9_dp, body)
            associate (m => mass(1 + mod(k, 4)), w => rate(1 + mod(k, 4)))
               y = body%y
               q = body%q
               z = scale(body%y, m + w)
               r = body%q
               call turn_body(method_name(i), body%moments, body%h, 1, y, q, status(1))
               call turn_body(method_name(i), scale(body%moments, m), scale(body%h, -w), 1, z, r, status(2))
               call check(error, status(1) == status(2), trim(method_name(i))//": status depends on the units")
               if (allocated(error)) return
               call check(error, all(z == scale(y, m + w)) .and. all(r == q), trim(method_name(i))//": bits depend on the units")
               if (allocated(error)) return
            end associate
         end do
      end do
   end subroutine test_scaling

   ! Bits --------------------------------------------------------------------------------------------

   !> A body's bits do not depend on its place in the block, nor on its neighbours.
   subroutine test_lanes(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      real(dp) :: y0(lanes, 3), q0(lanes, 4), y(lanes, 3), q(lanes, 4), z(3), r(4), h
      real(dp), parameter :: several(4) = [0.37_dp, -0.37_dp, 0.05_dp, -0.8_dp]
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: answer
      integer :: i, k, l, status(lanes), alone
      do i = 1, 17
         if (i == 17) then
            if (.not. known("jacobi")) exit
         end if
         call prepare(method_name(i), generic, method, class, answer)
         if (raised(answer)) cycle
         stream = start_stream(31)
         call random_block(stream, y0, q0)
         do l = 1, lanes ! rates from 0 to 1: lanes of different series lengths, sweeps and pieces
            y0(l, :) = y0(l, :)*(l - 1)/lanes
         end do
         do k = -1, 2
            h = several(k + 2)
            y = cshift(y0, k)
            q = cshift(q0, k)
            status = poinsot_ok
            call advance(method, class, h, y, q, status)
            y = cshift(y, -k)
            q = cshift(q, -k)
            do l = 1, lanes
               z = y0(l, :)
               r = q0(l, :)
               call turn_body(method_name(i), generic, h, 1, z, r, alone, lane=1 + mod(7*l, lanes))
               call check(error, all(z == y(l, :)) .and. all(r == q(l, :)), &
                  trim(method_name(i))//": bits depend on the place or the neighbours")
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine test_lanes

   pure function method_name(i) result(name)
      integer, intent(in) :: i
      character(20) :: name
      name = "jacobi"
      if (i <= 16) name = approximate(i)
   end function method_name

   !> Padding at rest, other states in the padding, a body that fails: the others keep their bits.
   subroutine test_padding(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      real(dp) :: y0(lanes, 3), q0(lanes, 4), y(lanes, 3), q(lanes, 4), z(lanes, 3), r(lanes, 4)
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: answer
      integer :: i, status(lanes), other(lanes)
      do i = 1, 17
         call prepare(method_name(i), generic, method, class, answer)
         if (raised(answer)) cycle
         stream = start_stream(37)
         call random_block(stream, y0, q0)
         y = y0
         q = q0
         status = poinsot_ok
         call advance(method, class, 0.4_dp, y, q, status)
         call rest_block(z, r, other)
         z(1:3, :) = y0(1:3, :)
         r(1:3, :) = q0(1:3, :)
         z(9, :) = 300*y0(9, :)
         call advance(method, class, 0.4_dp, z, r, other)
         call check(error, all(z(1:3, :) == y(1:3, :)) .and. all(r(1:3, :) == q(1:3, :)), &
            trim(method_name(i))//": bits depend on the padding")
         if (allocated(error)) return
         call check(error, all(z(10:, :) == 0) .and. all(r(10:, 1) == 1) .and. all(r(10:, 2:) == 0), &
            trim(method_name(i))//": a body at rest moves")
         if (allocated(error)) return
         call check(error, all(other(10:) == poinsot_ok), trim(method_name(i))//": a body at rest fails")
         if (allocated(error)) return
      end do
   end subroutine test_padding

   !> Ten steps in one block and ten calls of a single body are the same; so is a stop and a new start.
   subroutine test_steps(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: y(3), q(4), z(3), r(4)
      integer :: i, k, status
      do i = 1, 17
         if (.not. known(method_name(i))) cycle
         y = start
         q = [0.1_dp, 0.7_dp, -0.5_dp, 0.5_dp]
         z = y
         r = q
         call turn_body(method_name(i), generic, -0.3_dp, 10, y, q, status)
         do k = 1, 10
            call turn_body(method_name(i), generic, -0.3_dp, 1, z, r, status, lane=1 + mod(3*k, lanes))
         end do
         call check(error, all(y == z) .and. all(q == r), trim(method_name(i))//": ten steps are not ten times one")
         if (allocated(error)) return
      end do
   end subroutine test_steps

   ! Refusals ----------------------------------------------------------------------------------------

   !> h|omega| > pi/2: approximate methods say E_STEP and keep the state; just below they answer, or say that they could
   !> not, and never return the wrong root (a rotation of 90 degrees or more).
   subroutine test_long_step(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: q0(4) = [0.1_dp, 0.7_dp, -0.5_dp, 0.5_dp]
      type(dmv_term), allocatable :: terms(:)
      type(reference_map) :: map
      real(qp) :: yt(3), qt(4)
      real(dp) :: y(3), q(4), h, gap
      integer :: i, k, status
      logical :: ok
      call read_dmv_coefficients(terms)
      do i = 1, 15
         do k = 1, 24
            ! |omega| of the start is its largest bound for this body to within a tenth
            h = 0.9_dp + 0.15_dp*k
            y = start
            q = q0
            call turn_body(approximate(i), generic, h, 1, y, q, status)
            if (status == poinsot_ok) then
               call make_reference(approximate(i), generic, terms, map)
               yt = start
               qt = q0
               call map%apply(real(h, qp), yt, qt, ok)
               gap = momentum_distance(real(y, qp), yt) + attitude_distance(real(q, qp), qt)
               call check(error, ok .and. gap < 1.0e-12_dp, trim(approximate(i))//" returns a wrong root, h = "//text(h))
               if (allocated(error)) return
               call check(error, h*norm2(start/generic) < 1.7_dp, trim(approximate(i))//" accepts h = "//text(h))
               if (allocated(error)) return
            else
               call check(error, all(y == start) .and. all(q == q0), trim(approximate(i))//" fails and moves")
               if (allocated(error)) return
               call check(error, status == poinsot_e_step .or. status == poinsot_e_convergence, "which status")
               if (allocated(error)) return
               call check(error, h*norm2(start/generic) > 1.2_dp, trim(approximate(i))//" refuses h = "//text(h))
               if (allocated(error)) return
            end if
         end do
         call check(error, status, poinsot_e_step, "status of a step far too long, "//approximate(i))
         if (allocated(error)) return
      end do
   end subroutine test_long_step

   !> Moments that are no body's; a state that is not finite; momentum about an axis without moment.
   subroutine test_bad_state(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: bad(3, 8), nan, inf, y(3), q(4)
      integer :: i, k, status
      nan = ieee_value(nan, ieee_quiet_nan)
      inf = ieee_value(inf, ieee_positive_inf)
      bad = reshape([nan, 1.0_dp, 1.0_dp, 1.0_dp, inf, 1.0_dp, 1.0_dp, 1.0_dp, -0.5_dp, 0.0_dp, 0.0_dp, 0.0_dp, &
         1.0_dp, 2.0_dp, 3.1_dp, 0.0_dp, 1.0_dp, 2.0_dp, 0.0_dp, 0.0_dp, 1.0_dp, -1.0_dp, -1.0_dp, -1.0_dp], [3, 8])
      do k = 1, size(bad, 2)
         y = start
         q = [1, 0, 0, 0]
         call turn_body("exact", bad(:, k), 0.1_dp, 1, y, q, status)
         call check(error, status, poinsot_e_domain, "moments "//text(bad(1, k))//text(bad(2, k))//text(bad(3, k)))
         if (allocated(error)) return
         call check(error, all(y == start), "a refused body moves")
         if (allocated(error)) return
      end do
      do i = 1, 17
         if (.not. known(method_name(i))) cycle
         do k = 1, 3
            y = start
            q = [1, 0, 0, 0]
            if (k == 1) y(2) = nan
            if (k == 2) y(3) = -inf
            if (k == 3) q(4) = nan
            call turn_body(method_name(i), generic, 0.1_dp, 1, y, q, status)
            call check(error, status, poinsot_e_domain, trim(method_name(i))//" on a state that is not finite")
            if (allocated(error)) return
            call check(error, y(1) == start(1) .and. q(1) == 1, trim(method_name(i))//" moves a bad state")
            if (allocated(error)) return
         end do
         y = [0.3_dp, 0.1_dp, 0.4_dp]
         q = [1, 0, 0, 0]
         call turn_body(method_name(i), [1.0_dp, 0.0_dp, 1.0_dp], 0.1_dp, 1, y, q, status)
         call check(error, status, poinsot_e_domain, trim(method_name(i))//": momentum about an axis without moment")
         if (allocated(error)) return
         y = [0.3_dp, 0.0_dp, 0.4_dp]
         call turn_body(method_name(i), [1.0_dp, 0.0_dp, 1.0_dp], 0.1_dp, 1, y, q, status)
         call check(error, status, poinsot_ok, trim(method_name(i))//" on a linear body")
         if (allocated(error)) return
      end do
   end subroutine test_bad_state

   !> A lane that comes with a status stands still, bit for bit, and keeps the status.
   subroutine test_frozen(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      real(dp) :: y0(lanes, 3), q0(lanes, 4), y(lanes, 3), q(lanes, 4), z(lanes, 3), r(lanes, 4), carry(lanes, 7)
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: answer
      integer :: i, k, status(lanes), all_well(lanes)
      do i = 1, 17
         call prepare(method_name(i), generic, method, class, answer)
         if (raised(answer)) cycle
         stream = start_stream(41)
         call random_block(stream, y0, q0)
         do k = 1, 2
            carry = 0
            y = y0
            q = q0
            z = y0
            r = q0
            status = poinsot_ok
            status(5::7) = poinsot_e_domain
            all_well = poinsot_ok
            if (k == 1) then
               call advance(method, class, 0.4_dp, y, q, status)
               call advance(method, class, 0.4_dp, z, r, all_well)
            else
               call advance(method, class, 0.4_dp, y, q, status, carry)
               carry = 0
               call advance(method, class, 0.4_dp, z, r, all_well, carry)
            end if
            z(5::7, :) = y0(5::7, :)
            r(5::7, :) = q0(5::7, :)
            all_well(5::7) = poinsot_e_domain
            call check(error, all(y == z) .and. all(q == r), trim(method_name(i))//" moves a frozen lane, or a neighbour")
            if (allocated(error)) return
            call check(error, all(status == all_well), trim(method_name(i))//" changes the status of a frozen lane")
            if (allocated(error)) return
         end do
      end do
   end subroutine test_frozen

   !> Valid input raises neither invalid nor overflow nor division by zero, in padding and masked lanes neither.
   subroutine test_exceptions(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(random_body) :: body
      logical :: halting(3), flags(3)
      integer :: i, k, status
      call ieee_get_halting_mode(ieee_invalid, halting(1))
      call ieee_get_halting_mode(ieee_overflow, halting(2))
      call ieee_get_halting_mode(ieee_divide_by_zero, halting(3))
      do i = 1, 17
         if (.not. known(method_name(i))) cycle
         stream = start_stream(43)
         do k = 1, 10*size(body_kinds)
            call hard_body(stream, body_kinds(1 + mod(k, size(body_kinds))), merge(1.4_dp, 200.0_dp, i <= 15), body)
            call ieee_set_halting_mode([ieee_invalid, ieee_overflow, ieee_divide_by_zero], .false.)
            call ieee_set_flag([ieee_invalid, ieee_overflow, ieee_divide_by_zero], .false.)
            call turn_body(method_name(i), body%moments, body%h, 1, body%y, body%q, status, lane=3)
            call ieee_get_flag([ieee_invalid, ieee_overflow, ieee_divide_by_zero], flags)
            call ieee_set_flag([ieee_invalid, ieee_overflow, ieee_divide_by_zero], .false.)
            call ieee_set_halting_mode([ieee_invalid, ieee_overflow, ieee_divide_by_zero], halting)
            call check(error, .not. flags(1), trim(method_name(i))//" raises invalid on "//body%kind)
            if (allocated(error)) return
            call check(error, .not. flags(2), trim(method_name(i))//" raises overflow on "//body%kind)
            if (allocated(error)) return
            call check(error, .not. flags(3), trim(method_name(i))//" divides by zero on "//body%kind)
            if (allocated(error)) return
         end do
      end do
   end subroutine test_exceptions

   !> Energy, |y| and |q| over 1e4 steps at h|omega| = .1, plain and compensated, `exact` and dmv10.
   subroutine test_drift(error)
      type(error_type), allocatable, intent(out) :: error
      character(5), parameter :: names(2) = [character(5) :: "exact", "dmv10"]
      type(random_stream) :: stream
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: answer
      real(dp) :: y(lanes, 3), q(lanes, 4), carry(lanes, 7), h0(lanes), c0(lanes), rms, norm
      integer :: i, k, n, status(lanes)
      do i = 1, 2
         do k = 1, 2
            call prepare(names(i), generic, method, class, answer)
            stream = start_stream(47)
            call random_block(stream, y, q)
            y = y/spread(norm2(y, 2), 2, 3)
            h0 = energies(y)
            c0 = norm2(y, 2)
            carry = 0
            status = poinsot_ok
            do n = 1, 10000
               if (k == 1) then
                  call advance(method, class, 0.07_dp, y, q, status)
               else
                  call advance(method, class, 0.07_dp, y, q, status, carry)
               end if
            end do
            rms = sqrt(sum((energies(y)/h0 - 1)**2)/lanes)
            norm = max(maxval(abs(norm2(q, 2) - 1)), maxval(abs(norm2(y, 2)/c0 - 1))/10)
            call check(error, rms < merge(3.0e-14_dp, 1.0e-15_dp, k == 1), names(i)//" energy drifts: "//text(rms))
            if (allocated(error)) return
            call check(error, norm < 2.0e-15_dp, names(i)//" |q| or |y| drifts: "//text(norm))
            if (allocated(error)) return
         end do
      end do
   end subroutine test_drift

   pure function energies(y)
      real(dp), intent(in) :: y(lanes, 3)
      real(dp) :: energies(lanes)
      energies = (y(:, 1)**2/generic(1) + y(:, 2)**2/generic(2) + y(:, 3)**2/generic(3))/2
   end function energies

end module test_free
