!> The explicit exact step: one pass from state to state, no iteration, no elliptic function (mathematics, section 3).
!>
!> All kinds of body go through the same straight code. Everything is dimensionless: w = h omega, and momenta only ever
!> enter linearly. Notation: x = X T and z = Z T are k^2 sn^2 and its companion for half a step.
module poinsot_free_exact_step
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_body_class, only: body_class, series_levels, level_degree, longest_step
   use poinsot_free_series, only: correction, universal
   implicit none(type, external)
   private
   public :: exact_step_increment, step_sizes

contains

   !> p = h^2 p2 and r = h^2 r2, constants of the motion, and with them p + r, the largest (h |omega|)^2 of the motion.
   pure subroutine step_sizes(class, h, y, w, p, r)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes)       !! step of each lane, any sign; 0 for a lane that stands still
      real(dp), intent(in) :: y(lanes, 3)    !! angular momentum, caller's axes
      real(dp), intent(out) :: w(lanes, 3)   !! h omega, sorted axes
      real(dp), intent(out) :: p(lanes), r(lanes)
      real(dp) :: m(3)
      integer :: l, i1, i2, i3
      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      m = class%parity*class%inverse(class%order)
      !GCC$ ivdep
      do l = 1, lanes
         w(l, 1) = y(l, i1)*m(1)*h(l)
         w(l, 2) = y(l, i2)*m(2)*h(l)
         w(l, 3) = y(l, i3)*m(3)*h(l)
         p(l) = w(l, 1)**2 + class%k1*w(l, 2)**2
         r(l) = w(l, 3)**2 + class%k3*w(l, 2)**2
      end do
   end subroutine step_sizes

   !> Increments of y and q over one step of at most `longest_step` = h |omega| (see step_sizes).
   pure subroutine exact_step_increment(class, w, p, r, y, q, dy, dq)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: w(lanes, 3), p(lanes), r(lanes) !! from step_sizes
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      real(dp), dimension(lanes) :: ps, rs, t, s

      call all_series(class, p, r, ps, rs, t, s)
      call turn(class, w, p, r, ps, rs, t, s, y, q, dy, dq)
   end subroutine exact_step_increment

   !> P, R, T, W, each lane with the shortest series that is exact to rounding for it. A block whose lanes differ runs
   !> each length that is asked for, and lanes take their own.
   pure subroutine all_series(class, p, r, ps, rs, t, w)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: p(lanes), r(lanes)
      real(dp), intent(out), dimension(lanes) :: ps, rs, t, w
      real(dp), dimension(lanes) :: size, e, f, ps2, rs2, t2, w2
      integer :: level, l, longest
      real(dp) :: c1, c3, above

      c1 = 0.25_dp*class%a(1)*class%a(2)
      c3 = 0.25_dp*class%a(2)*class%a(3)
      !GCC$ ivdep
      do l = 1, lanes
         size(l) = p(l) + r(l)
         e(l) = c1*r(l) + c3*p(l)
         f(l) = (c1*r(l))*(c3*p(l))
      end do
      longest = 1
      above = maxval(size)
      do while (longest < series_levels .and. above > class%reach(longest))
         longest = longest + 1
      end do
      call correction(level_degree(longest), class, p, r, ps, rs)
      call universal(level_degree(longest), e, f, t, w)
      do level = longest - 1, 1, -1
         if (.not. any(size <= class%reach(level) .and. size > 0)) exit
         call correction(level_degree(level), class, p, r, ps2, rs2)
         call universal(level_degree(level), e, f, t2, w2)
         !GCC$ ivdep
         do l = 1, lanes
            ps(l) = merge(ps2(l), ps(l), size(l) <= class%reach(level))
            rs(l) = merge(rs2(l), rs(l), size(l) <= class%reach(level))
            t(l) = merge(t2(l), t(l), size(l) <= class%reach(level))
            w(l) = merge(w2(l), w(l), size(l) <= class%reach(level))
         end do
      end do
   end subroutine all_series

   !> The rotation of the step from the series, and the increments it gives. Sorted axes inside, caller's axes outside.
   pure subroutine turn(class, w, p, r, ps, rs, t, s, y, q, dy, dq)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(lanes) :: p, r, ps, rs, t, s
      real(dp), intent(in) :: w(lanes, 3), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      real(dp) :: x, z, xz, den, cf, df, b, g, n1, n2, n3, v1, v2, v3, vv, c, k, half, root
      real(dp) :: y1, y2, y3, u1, u2, u3, d2, d3, a1, a2, a3, e0, e1, e2, e3, parity
      integer :: l, i1, i2, i3

      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      parity = class%parity
      a1 = class%a(1)
      a2 = class%a(2)
      a3 = class%a(3)
      !GCC$ ivdep
      do l = 1, lanes
         ! omega at the end of the step, from sn, cn, dn of half a step by the duplication formula
         x = 0.25_dp*a1*a2*r(l)*t(l)
         z = 0.25_dp*a2*a3*p(l)*t(l)
         xz = x*z
         den = 1 - xz
         cf = 1 - 2*x + xz
         df = 1 - 2*z + xz
         b = w(l, 2)*s(l)
         g = 1/(den*den - a1*a3*(b*b))
         n1 = (w(l, 1)*cf*den - a1*w(l, 3)*b*df)*g
         n2 = (w(l, 2)*cf*df + a2*w(l, 1)*w(l, 3)*s(l)*den)*g
         n3 = (w(l, 3)*df*den - a3*w(l, 1)*b*cf)*g
         ! sine and cosine of the angle of the step: v = sin/2 times the axis
         v1 = 0.25_dp*(1 + ps(l))*(w(l, 1) + n1)
         v2 = 0.25_dp*(1 + rs(l) + class%theta*(ps(l) - rs(l)))*(w(l, 2) + n2)
         v3 = 0.25_dp*(1 + rs(l))*(w(l, 3) + n3)
         vv = v1*v1 + v2*v2 + v3*v3
         c = sqrt(1 - 4*vv)
         k = 4/(1 + c)
         ! momentum: R^T y - y; the first one, of the smallest moment, with its small factor in front
         y1 = parity*y(l, i1)
         y2 = parity*y(l, i2)
         y3 = parity*y(l, i3)
         u1 = k*(v2*y3 - v3*y2) - 2*y1
         u2 = k*(v3*y1 - v1*y3) - 2*y2
         u3 = k*(v1*y2 - v2*y1) - 2*y3
         d2 = v3*u1 - v1*u3
         d3 = v1*u2 - v2*u1
         dy(l, i1) = -parity*(0.125_dp*k*(w(l, 2) + n2)*(2*y3 + d3) &
                              *(class%f1*(1 + rs(l)) + class%theta*(ps(l) - rs(l))))
         dy(l, i2) = parity*d2
         dy(l, i3) = parity*d3
         ! attitude: q o (rho - 1), rho = (half, v/half)
         half = sqrt(0.5_dp + 0.5_dp*c)
         root = parity/half
         e0 = -0.5_dp*vv*k/(1 + half)
         e1 = v1*root
         e2 = v2*root
         e3 = v3*root
         dq(l, 1) = q(l, 1)*e0 - q(l, 1 + i1)*e1 - q(l, 1 + i2)*e2 - q(l, 1 + i3)*e3
         dq(l, 1 + i1) = q(l, 1 + i1)*e0 + q(l, 1)*e1 + parity*(q(l, 1 + i2)*e3 - q(l, 1 + i3)*e2)
         dq(l, 1 + i2) = q(l, 1 + i2)*e0 + q(l, 1)*e2 + parity*(q(l, 1 + i3)*e1 - q(l, 1 + i1)*e3)
         dq(l, 1 + i3) = q(l, 1 + i3)*e0 + q(l, 1)*e3 + parity*(q(l, 1 + i1)*e2 - q(l, 1 + i2)*e1)
      end do
   end subroutine turn

end module poinsot_free_exact_step
