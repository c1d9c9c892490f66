!> Hard cases of free rotation and how they are judged: every method on every case either meets the
!> error that its order allows, or answers with a status and leaves the state alone. The judge is
!> the Taylor series in quadruple precision.
module test_hard_cases
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use testdrive, only: error_type, check
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_status, only: poinsot_ok, poinsot_e_step, poinsot_e_convergence
   use test_bodies, only: permute_body, random_body, rate_bound
   use test_free_tools, only: method_names, method_orders, approximate_count, turn_body, text
   use test_measure, only: attitude_distance, momentum_distance
   use test_oracle_taylor, only: taylor_report, taylor_flow, free_problem, conditioning
   implicit none(type, external)
   private
   public :: hard_case, hard_list, add_case, judge_case, worst_errors, all_orders, unmoved

   !> A body, where it starts, and what is hard about it.
   type :: hard_case
      character(40) :: label = ""
      real(dp) :: moments(3) = 1, y(3) = 0
      real(dp) :: q(4) = [0.5_dp, -0.1_dp, 0.7_dp, 0.5_dp]
   end type hard_case

   type :: hard_list
      integer :: n = 0
      type(hard_case) :: at(2000)
   end type hard_list

   !> The widest error of each method, in units of what is allowed for it, and how often it refused.
   type :: worst_errors
      real(dp) :: units = 0          !! error / (conditioning x eps), exact methods
      real(dp) :: part = 0           !! error / allowed, all
      character(40) :: label = ""
      real(dp) :: turn = 0           !! h |omega| of the widest
      integer :: answered = 0, refused = 0
   end type worst_errors

   integer, parameter :: all_orders(3, 6) = reshape([1, 2, 3, 2, 3, 1, 3, 1, 2, 2, 1, 3, 1, 3, 2, &
      3, 2, 1], &
      [3, 6])

contains

   subroutine add_case(list, label, moments, y)
      type(hard_list), intent(inout) :: list
      character(*), intent(in) :: label
      real(dp), intent(in) :: moments(3), y(3)
      list%n = list%n + 1
      list%at(list%n) = hard_case(label, moments, y)
   end subroutine add_case

   !> What a method of an order may be off in one step of h|omega| = turn; 0 is exact. The constants
   !> are those of mathematics.md, section 2, for a step of 1, and three times as much.
   pure real(dp) function allowed_error(method, turn) result(allowed)
      integer, intent(in) :: method
      real(dp), intent(in) :: turn
      real(dp), parameter :: at_one(12) = [0.5_dp, 1.5e-2_dp, 5e-4_dp, 2e-5_dp, 1e-6_dp, 4e-8_dp, &
         1.5e-9_dp, &
         5e-11_dp, 2e-12_dp, 1e-13_dp, 5e-15_dp, 5e-16_dp]
      integer :: order
      order = method_orders(method)
      allowed = 0
      if (order == 0) return
      allowed = 3*at_one(order/2)*turn**(order + 1)
      if (order > 2) allowed = allowed*max(1.0_dp, turn)**4 ! the series converges slowly beyond 1
   end function allowed_error

   !> One case, one method, one step. Roundings that are allowed: `units` times the conditioning.
   subroutine judge_case(error, case, order, turn, method, units, worst, compared)
      type(error_type), allocatable, intent(inout) :: error
      type(hard_case), intent(in) :: case
      integer, intent(in) :: order                   !! column of all_orders
      real(dp), intent(in) :: turn                   !! h times the largest rate, either sign
      integer, intent(in) :: method                  !! place in method_names
      real(dp), intent(in) :: units
      type(worst_errors), intent(inout) :: worst
      logical, intent(in), &
         optional :: compared      !! .false.: no series, the conserved quantities only
      type(random_body) :: body
      real(dp) :: y(3), q(4), h, gap, may, cond, rate
      integer :: status
      if (allocated(error)) return
      body%moments = case%moments
      body%y = case%y
      body%q = case%q/norm2(case%q)
      call permute_body(all_orders(:, order), body)
      rate = rate_bound(body%moments, body%y)
      h = turn
      if (rate > 0) h = turn/rate
      y = body%y
      q = body%q
      call turn_body(method_names(method), body%moments, h, 1, y, q, status)
      if (status /= poinsot_ok) then
         worst%refused = worst%refused + 1
         call check(error, (status == poinsot_e_step .or. status == poinsot_e_convergence) &
            .and. unmoved(y, body%y) &
            .and. unmoved(q, body%q), told("fails in a way that is not told"))
         if (.not. allocated(error)) call check(error, method <= approximate_count &
            .and. abs(turn) > 0.9_dp, &
            told("refuses"))
         return
      end if
      worst%answered = worst%answered + 1
      call check(error, all(ieee_is_finite(y)) .and. all(ieee_is_finite(q)), told("answers a NaN"))
      if (allocated(error)) return
      gap = max(abs(norm2(q) - 1), drift_of_length(y, body%y), space_momentum_gap(y, q, body%y, &
         body%q))
      may = 12e-16_dp*max(1.0_dp, sqrt(abs(turn)))
      ! three-rotations turns momentum into a linear body's axis, where none can be, and drops it
      if (method == 1 .and. any(body%moments <= 0)) may = may + allowed_error(method, abs(turn))
      call check(error, gap < may, &
         told("loses |q|, |y| or Qy by "//text(gap)))
      if (allocated(error)) return
      if (present(compared)) return
      call distance(body, h, y, q, gap)
      may = allowed_error(method, abs(turn))
      cond = 1
      if (gap > may + 4e-16_dp) call worse_of_two(body, h, cond)
      if (method > approximate_count &
         .and. gap/(1e-16_dp*cond) > worst%units) worst%units = gap/(1e-16_dp*cond)
      if (gap/(may + units*1e-16_dp*cond) > worst%part) then
         worst%part = gap/(may + units*1e-16_dp*cond)
         worst%label = case%label
         worst%turn = turn
      end if
      call check(error, gap <= may + units*1e-16_dp*cond, told("is "//text(gap)// &
         " off, conditioning "//text(cond)))

   contains

      function told(what) result(message)
         character(*), intent(in) :: what
         character(:), allocatable :: message
         message = trim(method_names(method))//" "//what//": "//trim(case%label)// &
            ", h|omega| = "//text(turn)// &
            ", order of axes "//achar(iachar("0") + order)
      end function told

   end subroutine judge_case

   !> The larger distance, of y and of q, from the Taylor series.
   subroutine distance(body, h, y, q, gap)
      type(random_body), intent(in) :: body
      real(dp), intent(in) :: h, y(3), q(4)
      real(dp), intent(out) :: gap
      type(taylor_report) :: report
      real(qp) :: yt(3), qt(4)
      yt = body%y
      qt = body%q/sqrt(sum(real(body%q, qp)**2))
      call taylor_flow(free_problem(body%moments), real(h, qp), yt, qt, report)
      gap = max(momentum_distance(real(y, qp), yt), attitude_distance(real(q, qp), qt))
   end subroutine distance

   !> How much larger than a rounding of the input the answer's error must be.
   subroutine worse_of_two(body, h, cond)
      type(random_body), intent(in) :: body
      real(dp), intent(in) :: h
      real(dp), intent(out) :: cond
      real(dp) :: c(4)
      call conditioning(body%moments, body%y, h, c(1), c(2), c(3), c(4))
      cond = max(1.0_dp, c(1), c(2))
   end subroutine worse_of_two

   !> |y| is kept by every method.
   pure real(dp) function drift_of_length(y, before) result(gap)
      real(dp), intent(in) :: y(3), before(3)
      real(dp) :: scale
      scale = maxval(abs(before))
      gap = 0
      if (scale > 1e-290_dp) gap = abs(norm2(y/scale) - norm2(before/scale))
   end function drift_of_length

   !> Q y is kept by every method.
   pure real(dp) function space_momentum_gap(y, q, y0, q0) result(gap)
      real(dp), intent(in) :: y(3), q(4), y0(3), q0(4)
      real(dp) :: scale
      scale = maxval(abs(y0))
      gap = 0
      if (scale > 1e-290_dp) gap = norm2(turned(q, y/scale) - turned(q0, y0/scale))
   end function space_momentum_gap

   pure function turned(q, v) result(w)
      real(dp), intent(in) :: q(4), v(3)
      real(dp) :: w(3), t(3)
      t = 2*cross(q(2:4), v)
      w = v + q(1)*t + cross(q(2:4), t)
   end function turned

   pure function cross(a, b) result(c)
      real(dp), intent(in) :: a(3), b(3)
      real(dp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

   !> Equal to the last bit, but for the sign of a zero.
   pure logical function unmoved(a, b)
      real(dp), intent(in) :: a(:), b(:)
      unmoved = all(abs(a - b) <= 0)
   end function unmoved

end module test_hard_cases
