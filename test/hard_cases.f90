!> Hard cases of free rotation and how they are judged: every method on every case either meets the
!> error that its order allows, or answers with a status and leaves the state alone. The judge is
!> the Taylor series in quadruple precision.
module test_hard_cases
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use testdrive, only: error_type
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_status, only: poinsot_ok, poinsot_e_step, poinsot_e_convergence
   use test_bodies, only: permute_body, random_body
   use test_expectation, only: expect
   use test_free_tools, only: method_names, method_orders, approximate_count, turn_body, text
   use test_measure, only: attitude_distance, momentum_distance
   use test_oracle_algebra, only: rotate
   use test_oracle_taylor, only: taylor_report, taylor_flow, free_problem, conditioning
   implicit none(type, external)
   private
   public :: hard_case, hard_list, add_case, judge_case, worst_errors, all_orders, unmoved, &
      largest_rate, last_truth

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

   !> The series' answer to the last question, for the next method that is asked the same.
   type :: last_truth
      real(dp) :: moments(3) = 0, y0(3) = 0, q0(4) = 0, h = 0
      real(qp) :: y(3) = 0, q(4) = 0
      real(dp) :: cond = 0           !! 0: not worked out yet
   end type last_truth

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
   subroutine judge_case(error, case, order, turn, method, units, worst, truth, compared)
      type(error_type), allocatable, intent(inout) :: error
      type(hard_case), intent(in) :: case
      integer, intent(in) :: order                   !! column of all_orders
      real(dp), intent(in) :: turn                   !! h times the largest rate, either sign
      integer, intent(in) :: method                  !! place in method_names
      real(dp), intent(in) :: units
      type(worst_errors), intent(inout) :: worst
      type(last_truth), intent(inout) :: truth
      logical, intent(in), &
         optional :: compared      !! .false.: no series, the conserved quantities only
      type(random_body) :: body
      real(dp) :: y(3), q(4), h, gap, may, cond, rate, thin
      integer :: status
      if (allocated(error)) return
      body%moments = case%moments
      body%y = case%y
      body%q = case%q/norm2(case%q)
      call permute_body(all_orders(:, order), body)
      rate = largest_rate(body%moments, body%y)
      h = turn
      if (rate > 0) h = turn/rate
      thin = maxval(body%moments)/max(minval(body%moments), 1e-300_dp*maxval(body%moments))
      y = body%y
      q = body%q
      call turn_body(method_names(method), body%moments, h, 1, y, q, status)
      if (status /= poinsot_ok) then
         worst%refused = worst%refused + 1
         call expect(error, (status == poinsot_e_step .or. status == poinsot_e_convergence) &
            .and. unmoved(y, body%y) &
            .and. unmoved(q, body%q), told("fails in a way that is not told"))
         if (.not. allocated(error)) call expect(error, method <= approximate_count &
            .and. (abs(turn) > 0.9_dp .or. (thin > 10 .and. method <= 2)), &
            told("refuses"))
         return
      end if
      worst%answered = worst%answered + 1
      call expect(error, all(ieee_is_finite(y)) .and. all(ieee_is_finite(q)), told("answers a NaN"))
      gap = max(abs(norm2(q) - 1), drift_of_length(y, body%y), space_momentum_gap(y, q, body%y, &
         body%q))
      may = 20e-16_dp*max(1.0_dp, sqrt(abs(turn)))
      call expect(error, gap < may, &
         told("loses |q|, |y| or Qy by "//text(gap)))
      if (present(compared)) return
      call find_truth(body, h, truth)
      gap = max(momentum_distance(real(y, qp), truth%y), attitude_distance(real(q, qp), truth%q))
      may = allowed_error(method, abs(turn))
      ! what three-rotations moves into a thin body's axis turns it there
      if (method == 1 .and. thin > 3) may = min(2.0_dp, may*thin/3)
      if (method == 1 .and. thin > 10) may = min(2.0_dp, max(may, thin*turn**2))
      cond = 1
      if (gap > may + 4e-16_dp) cond = condition_of(body, h, truth)
      if (method > approximate_count &
         .and. gap/(1e-16_dp*cond) > worst%units) worst%units = gap/(1e-16_dp*cond)
      if (gap/(may + units*1e-16_dp*cond) > worst%part) then
         worst%part = gap/(may + units*1e-16_dp*cond)
         worst%label = case%label
         worst%turn = turn
      end if
      call expect(error, gap <= may + units*1e-16_dp*cond, told("is "//text(gap)// &
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

   subroutine find_truth(body, h, truth)
      type(random_body), intent(in) :: body
      real(dp), intent(in) :: h
      type(last_truth), intent(inout) :: truth
      type(taylor_report) :: report
      if (all(abs(truth%moments - body%moments) <= 0) .and. all(abs(truth%y0 - body%y) <= 0) &
         .and. all(abs(truth%q0 - body%q) <= 0) .and. abs(truth%h - h) <= 0) return
      truth = last_truth(moments=body%moments, y0=body%y, q0=body%q, h=h)
      truth%y = body%y
      truth%q = body%q/sqrt(sum(real(body%q, qp)**2))
      call taylor_flow(free_problem(body%moments), real(h, qp), truth%y, truth%q, report)
   end subroutine find_truth

   !> How much larger than a rounding of the input the answer's error must be.
   real(dp) function condition_of(body, h, truth) result(cond)
      type(random_body), intent(in) :: body
      real(dp), intent(in) :: h
      type(last_truth), intent(inout) :: truth
      real(dp) :: c(4)
      if (truth%cond <= 0) then
         call conditioning(body%moments, body%y, h, c(1), c(2), c(3), c(4))
         truth%cond = max(1.0_dp, c(1), c(2))
      end if
      cond = truth%cond
   end function condition_of

   !> The largest |omega| of the motion, sqrt(p2 + r2) of mathematics.md, section 2; exact for thin
   !> bodies too.
   pure real(dp) function largest_rate(moments, y) result(rate)
      real(dp), intent(in) :: moments(3), y(3)
      real(qp) :: i(3), w(3), theta
      integer :: order(3), k
      order = [1, 2, 3]
      if (moments(order(1)) > moments(order(2))) order([1, 2]) = order([2, 1])
      if (moments(order(2)) > moments(order(3))) order([2, 3]) = order([3, 2])
      if (moments(order(1)) > moments(order(2))) order([1, 2]) = order([2, 1])
      i = moments(order)
      w = 0
      do k = 1, 3
         if (i(k) > 0) w(k) = y(order(k))/i(k)
      end do
      theta = 0.5_qp
      if (i(3) > i(1)) theta = min(i(3) - i(2), i(1))/(i(3) - i(1))
      rate = real(sqrt(w(1)**2 + w(3)**2 + (1 - theta)*i(2)/i(3)*w(2)**2), dp)
      if (i(1) > 0) rate = real(sqrt(real(rate, qp)**2 + theta*i(2)/i(1)*w(2)**2), dp)
   end function largest_rate

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
      if (scale > 1e-290_dp) gap = norm2(rotate(q, y/scale) - rotate(q0, y0/scale))
   end function space_momentum_gap

   !> Equal to the last bit, but for the sign of a zero.
   pure logical function unmoved(a, b)
      real(dp), intent(in) :: a(:), b(:)
      unmoved = all(abs(a - b) <= 0)
   end function unmoved

end module test_hard_cases
