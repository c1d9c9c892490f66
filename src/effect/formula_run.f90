!> A compiled formula on a block: its value; its derivatives with respect to the elements of Q, by
!> reverse-mode differentiation; and their change along a change of Q, by forward and reverse mode.
!> Exact up to rounding errors.
module poinsot_effect_formula_run
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_effect_formula_node, only: formula, value_of, most_nodes, op_attitude, op_time, &
      op_constant, op_add, op_multiply, op_shift, op_scale, op_spread, op_invert, op_root, op_exp, &
      op_log, op_sin, op_cos, op_asin, op_acos, op_atan, op_sinh, op_cosh, op_tanh, op_abs, &
      op_power, op_atan2, op_min, op_max
   implicit none(type, external)
   private
   public :: run_values, run_gradient, run_change, is_tame

   real(dp), parameter :: tame_value = 1e40_dp, tame_slope = 1e60_dp
   real(dp), parameter :: longest_time = 1e30_dp !! for which a formula counts as tame

contains

   !> Can no operation on an attitude and a time up to 1e30 raise an exception, here or in the
   !> derivatives? Found from bounds of all values and of their influence on the result.
   pure logical function is_tame(f, size_of_axes)
      type(formula), intent(in) :: f
      real(dp), intent(in) :: size_of_axes !! bound of the elements of Q
      real(dp) :: most(most_nodes), slope(most_nodes), reach(most_nodes), rate
      integer :: k, a, b
      is_tame = .false.
      reach = 0
      do k = 1, f%n
         rate = 1
         select case (f%op(k))
         case (op_attitude)
            most(k) = size_of_axes
            reach(k) = 1e3_dp*size_of_axes
         case (op_time); most(k) = longest_time
         case (op_constant); most(k) = abs(f%value(k))
         case (op_add, op_shift); most(k) = most(f%a(k)) + most(f%b(k))
         case (op_multiply, op_scale)
            most(k) = most(f%a(k))*most(f%b(k))
            rate = max(most(f%a(k)), most(f%b(k)))
         case (op_sin, op_cos, op_tanh); most(k) = 1
         case (op_atan); most(k) = 2
         case (op_spread, op_abs); most(k) = most(f%a(k))
         case (op_min, op_max); most(k) = max(most(f%a(k)), most(f%b(k)))
         case default
            if (.not. f%uniform(k)) return
            most(k) = 2*tame_value ! made of the time: anything
         end select
         if (most(k) > tame_value) return
         if (f%op(k) > op_constant) reach(k) = rate*reach(f%a(k))
         if (f%b(k) > 0 .and. f%op(k) > op_constant) reach(k) = reach(k) + rate*reach(f%b(k))
         if (reach(k) > tame_slope) return
      end do
      slope = 0
      slope(f%result) = 1
      do k = f%n, 1, -1
         if (f%op(k) <= op_constant) cycle
         a = f%a(k)
         b = f%b(k)
         rate = 1
         if (f%op(k) == op_multiply .or. f%op(k) == op_scale) rate = most(b)
         slope(a) = slope(a) + rate*slope(k)
         if (b > 0) slope(b) = slope(b) + max(most(a), 1.0_dp)*slope(k)
         if (slope(a) > tame_slope .or. slope(max(b, 1)) > tame_slope) return
      end do
      is_tame = .true.
   end function is_tame

   !> Evaluate the uniform nodes at time t.
   pure subroutine run_uniform(f, t, s)
      type(formula), intent(in) :: f
      real(dp), intent(in) :: t
      real(dp), intent(out) :: s(most_nodes)
      integer :: k
      do k = 1, f%n
         if (.not. f%uniform(k)) cycle
         select case (f%op(k))
         case (op_constant); s(k) = f%value(k)
         case (op_time); s(k) = t
         case default; s(k) = value_of(f%op(k), s(f%a(k)), s(max(f%b(k), 1)))
         end select
      end do
   end subroutine run_uniform

   !> The values of all nodes; the result in v(:, f%result).
   pure subroutine run_values(f, t, x, s, v)
      type(formula), intent(in) :: f
      real(dp), intent(in) :: t               !! time
      real(dp), intent(in) :: x(lanes, 3, 3)  !! Q(row, column) is x(:, column, row)
      real(dp), intent(out) :: s(most_nodes)  !! values of uniform nodes,
      real(dp), intent(inout) :: v(lanes, most_nodes) !! of the others; other columns stay
      integer :: k, l
      call run_uniform(f, t, s)
      do k = 1, f%n
         if (f%uniform(k)) cycle
         associate (a => f%a(k), b => f%b(k))
            select case (f%op(k))
            case (op_attitude); v(:, k) = x(:, b, a)
            case (op_add); v(:, k) = v(:, a) + v(:, b)
            case (op_multiply); v(:, k) = v(:, a)*v(:, b)
            case (op_shift); v(:, k) = v(:, a) + s(b)
            case (op_scale); v(:, k) = v(:, a)*s(b)
            case (op_spread); v(:, k) = s(a)
            case (op_invert); v(:, k) = 1/v(:, a)
            case (op_root); v(:, k) = sqrt(v(:, a))
            case (op_atan2, op_min, op_max)
               do l = 1, lanes
                  v(l, k) = value_of(f%op(k), v(l, a), v(l, b))
               end do
            case (op_power)
               do l = 1, lanes
                  v(l, k) = value_of(op_power, v(l, a), s(b))
               end do
            case default
               do l = 1, lanes
                  v(l, k) = value_of(f%op(k), v(l, a), 0.0_dp)
               end do
            end select
         end associate
      end do
      if (f%uniform(f%result)) v(:, f%result) = s(f%result)
   end subroutine run_values

   !> The derivatives of the result with respect to Q, added up backwards. p(:, k) is the derivative
   !> of an operation on one thing, w(:, k) that of the result with respect to node k.
   pure subroutine run_gradient(f, s, v, p, w, r)
      type(formula), intent(in) :: f
      real(dp), intent(in) :: s(most_nodes), v(lanes, most_nodes) !! from run_values
      real(dp), intent(inout) :: p(lanes, most_nodes), w(lanes, most_nodes)
      real(dp), intent(out) :: r(lanes, 3, 3) !! dU/dQ(row, column) in r(:, column, row)
      real(dp) :: pa(lanes), pb(lanes)
      integer :: k
      r = 0
      if (f%uniform(f%result)) return
      do k = 1, f%n
         if (.not. f%uniform(k)) w(:, k) = 0
      end do
      w(:, f%result) = 1
      do k = f%n, 1, -1
         if (f%uniform(k)) cycle
         associate (a => f%a(k), b => f%b(k))
            select case (f%op(k))
            case (op_attitude); r(:, b, a) = w(:, k)
            case (op_add)
               w(:, a) = w(:, a) + w(:, k)
               w(:, b) = w(:, b) + w(:, k)
            case (op_multiply)
               w(:, a) = w(:, a) + w(:, k)*v(:, b)
               w(:, b) = w(:, b) + w(:, k)*v(:, a)
            case (op_shift); w(:, a) = w(:, a) + w(:, k)
            case (op_scale); w(:, a) = w(:, a) + w(:, k)*s(b)
            case (op_spread); continue
            case (op_atan2, op_min, op_max)
               call slopes_of_two(f%op(k), v(:, a), v(:, b), pa, pb)
               w(:, a) = w(:, a) + w(:, k)*pa
               w(:, b) = w(:, b) + w(:, k)*pb
            case default
               call slope(f%op(k), v(:, a), s(max(b, 1)), v(:, k), p(:, k))
               w(:, a) = w(:, a) + w(:, k)*p(:, k)
            end select
         end associate
      end do
   end subroutine run_gradient

   !> The change of dU/dQ along a change of Q: forwards the changes d of all nodes, backwards those
   !> of
   !> w. After run_gradient.
   pure subroutine run_change(f, s, v, p, w, dx, dr)
      type(formula), intent(in) :: f
      real(dp), intent(in) :: s(most_nodes), v(lanes, most_nodes), p(lanes, most_nodes), &
         w(lanes, most_nodes)
      real(dp), intent(in) :: dx(lanes, 3, 3)  !! change of Q, as x of run_values
      real(dp), intent(out) :: dr(lanes, 3, 3) !! change of r of run_gradient
      real(dp) :: d(lanes, most_nodes), e(lanes, most_nodes)
      real(dp), dimension(lanes) :: pa, pb, paa, pab, pbb
      integer :: k
      dr = 0
      if (f%uniform(f%result)) return
      do k = 1, f%n
         if (f%uniform(k)) cycle
         e(:, k) = 0
         associate (a => f%a(k), b => f%b(k))
            select case (f%op(k))
            case (op_attitude); d(:, k) = dx(:, b, a)
            case (op_add); d(:, k) = d(:, a) + d(:, b)
            case (op_multiply); d(:, k) = d(:, a)*v(:, b) + v(:, a)*d(:, b)
            case (op_shift); d(:, k) = d(:, a)
            case (op_scale); d(:, k) = d(:, a)*s(b)
            case (op_spread); d(:, k) = 0
            case (op_atan2, op_min, op_max)
               call slopes_of_two(f%op(k), v(:, a), v(:, b), pa, pb)
               d(:, k) = d(:, a)*pa + d(:, b)*pb
            case default; d(:, k) = d(:, a)*p(:, k)
            end select
         end associate
      end do
      do k = f%n, 1, -1
         if (f%uniform(k)) cycle
         associate (a => f%a(k), b => f%b(k))
            select case (f%op(k))
            case (op_attitude); dr(:, b, a) = e(:, k)
            case (op_add)
               e(:, a) = e(:, a) + e(:, k)
               e(:, b) = e(:, b) + e(:, k)
            case (op_multiply)
               e(:, a) = e(:, a) + (e(:, k)*v(:, b) + w(:, k)*d(:, b))
               e(:, b) = e(:, b) + (e(:, k)*v(:, a) + w(:, k)*d(:, a))
            case (op_shift); e(:, a) = e(:, a) + e(:, k)
            case (op_scale); e(:, a) = e(:, a) + e(:, k)*s(b)
            case (op_spread); continue
            case (op_atan2, op_min, op_max)
               call slopes_of_two(f%op(k), v(:, a), v(:, b), pa, pb)
               call bends_of_two(f%op(k), v(:, a), v(:, b), paa, pab, pbb)
               e(:, a) = e(:, a) + (e(:, k)*pa + w(:, k)*(paa*d(:, a) + pab*d(:, b)))
               e(:, b) = e(:, b) + (e(:, k)*pb + w(:, k)*(pab*d(:, a) + pbb*d(:, b)))
            case default
               call bend(f%op(k), v(:, a), s(max(b, 1)), v(:, k), p(:, k), paa)
               e(:, a) = e(:, a) + (e(:, k)*p(:, k) + w(:, k)*paa*d(:, a))
            end select
         end associate
      end do
   end subroutine run_change

   !> The derivative of an operation on one thing x, whose value is v; c the power of op_power.
   pure subroutine slope(op, x, c, v, p)
      integer, intent(in) :: op
      real(dp), intent(in) :: x(lanes), c, v(lanes)
      real(dp), intent(out) :: p(lanes)
      integer :: l
      select case (op)
      case (op_invert); p = -v*v
      case (op_root); p = 0.5_dp/v
      case (op_exp); p = v
      case (op_log); p = 1/x
      case (op_asin); p = 1/sqrt((1 - x)*(1 + x))
      case (op_acos); p = -1/sqrt((1 - x)*(1 + x))
      case (op_atan); p = 1/(1 + x*x)
      case (op_tanh); p = (1 - v)*(1 + v)
      case (op_abs); p = sign(1.0_dp, x)
      case default
         do l = 1, lanes
            select case (op)
            case (op_sin); p(l) = value_of(op_cos, x(l), 0.0_dp)
            case (op_cos); p(l) = -value_of(op_sin, x(l), 0.0_dp)
            case (op_sinh); p(l) = value_of(op_cosh, x(l), 0.0_dp)
            case (op_cosh); p(l) = value_of(op_sinh, x(l), 0.0_dp)
            case default; p(l) = c*value_of(op_power, x(l), c - 1)
            end select
         end do
      end select
   end subroutine slope

   !> The second derivative, from x, value and first derivative.
   pure subroutine bend(op, x, c, v, p, pp)
      integer, intent(in) :: op
      real(dp), intent(in) :: x(lanes), c, v(lanes), p(lanes)
      real(dp), intent(out) :: pp(lanes)
      integer :: l
      select case (op)
      case (op_invert); pp = -2*v*p
      case (op_root); pp = -0.5_dp*p/x
      case (op_exp); pp = v
      case (op_log); pp = -p*p
      case (op_sin, op_cos); pp = -v
      case (op_asin, op_acos); pp = x*p*p*p
      case (op_atan); pp = -2*x*p*p
      case (op_sinh, op_cosh); pp = v
      case (op_tanh); pp = -2*v*p
      case (op_abs); pp = 0
      case default
         do l = 1, lanes
            pp(l) = c*(c - 1)*value_of(op_power, x(l), c - 2)
         end do
      end select
   end subroutine bend

   !> The derivatives of an operation on two things.
   pure subroutine slopes_of_two(op, x, y, px, py)
      integer, intent(in) :: op
      real(dp), intent(in) :: x(lanes), y(lanes)
      real(dp), intent(out) :: px(lanes), py(lanes)
      if (op == op_atan2) then
         px = y/(x*x + y*y)
         py = -x/(x*x + y*y)
      else
         px = 0
         if (op == op_min) then
            where (x <= y) px = 1
         else
            where (x >= y) px = 1
         end if
         py = 1 - px
      end if
   end subroutine slopes_of_two

   pure subroutine bends_of_two(op, x, y, pxx, pxy, pyy)
      integer, intent(in) :: op
      real(dp), intent(in) :: x(lanes), y(lanes)
      real(dp), intent(out) :: pxx(lanes), pxy(lanes), pyy(lanes)
      pxx = 0
      pxy = 0
      pyy = 0
      if (op /= op_atan2) return
      pxx = x*x + y*y
      pxy = (x - y)*(x + y)/pxx**2
      pyy = 2*x*y/pxx**2
      pxx = -pyy
   end subroutine bends_of_two

end module poinsot_effect_formula_run
