!> The explicit exact step: one pass from state to state, no iteration, no elliptic function
!> (mathematics, section 3).
!>
!> All kinds of body go through the same straight code. Everything is dimensionless: w = h omega,
!> and momenta only ever enter linearly. Notation: x = X T and z = Z T are k^2 sn^2 and its
!> companion for half a step.
module poinsot_free_exact_step
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_body_class, only: body_class
   use poinsot_free_bands, only: low_band, middle_band, high_band
   implicit none(type, external)
   private
   public :: exact_step_increment, step_sizes

contains

   !> p = h^2 p2 and r = h^2 r2, constants of the motion, and with them p + r, the largest (h
   !> |omega|)^2 of the motion.
   pure subroutine step_sizes(class, h, y, w, p, r)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes)       !! step of each lane, any sign; 0 for a lane that
                                             !! stands still
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
   pure subroutine exact_step_increment(class, w, p, r, above, y, q, dy, dq)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: w(lanes, 3), p(lanes), r(lanes) !! from step_sizes
      real(dp), intent(in) :: above                           !! the largest p + r
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      real(dp), dimension(lanes) :: x, z, ps, rs, t, s, twice
      real(dp) :: v(lanes, 3)

      call all_series(class, p, r, above, x, z, ps, rs, t, s)
      call rotation_of_step(class, w, x, z, ps, rs, t, s, v, twice)
      call turn(class, ps, rs, v, twice, y, q, dy, dq)
   end subroutine exact_step_increment

   !> 1 + P, 1 + R, T, W, each lane with the shortest series that is exact to rounding for it. x and
   !> z are the arguments of T and W.
   pure subroutine all_series(class, p, r, above, x, z, ps, rs, t, w)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: p(lanes), r(lanes), above
      real(dp), intent(out), dimension(lanes) :: x, z, ps, rs, t, w
      real(dp), dimension(lanes) :: e, f, takes
      integer :: l
      real(dp) :: c1, c3

      c1 = 0.25_dp*class%a(1)*class%a(2)
      c3 = 0.25_dp*class%a(2)*class%a(3)
      !GCC$ ivdep
      do l = 1, lanes
         x(l) = c1*r(l)
         z(l) = c3*p(l)
         e(l) = x(l) + z(l)
         f(l) = x(l)*z(l)
      end do
      call low_band(class, p, r, e, f, ps, rs, t, w)
      if (above <= class%reach(1)) return
      takes = merge(1.0_dp, 0.0_dp, p + r > class%reach(1))
      call middle_band(class, p, r, e, f, takes, ps, rs, t, w)
      if (above <= class%reach(2)) return
      takes = merge(1.0_dp, 0.0_dp, p + r > class%reach(2))
      call high_band(class, p, r, e, f, takes, ps, rs, t, w)
   end subroutine all_series

   !> The rotation of the step from the series: v = (sin(angle)/2) axis, in the caller's axes, where
   !> an odd order of axes changes its sign; `twice` = h omega2 at both ends, summed.
   pure subroutine rotation_of_step(class, w, x, z, ps, rs, t, s, v, twice)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(lanes) :: x, z, ps, rs, t, s
      real(dp), intent(in) :: w(lanes, 3)
      real(dp), intent(out) :: v(lanes, 3), twice(lanes)
      real(dp) :: xs, zs, xz, den, cf, df, b, g, w1, w3, a1, a2, a3, a13, quarter
      integer :: l, i1, i2, i3
      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      a1 = class%a(1)
      a2 = class%a(2)
      a3 = class%a(3)
      a13 = a1*a3
      quarter = 0.25_dp*class%parity
      !GCC$ ivdep
      do l = 1, lanes
         ! omega at the end of the step, from sn, cn, dn of half a step by the duplication formula
         xs = x(l)*t(l)
         zs = z(l)*t(l)
         xz = xs*zs
         den = 1 - xz
         cf = den - 2*(xs - xz)
         df = den - 2*(zs - xz)
         b = w(l, 2)*s(l)
         g = 1/(den*den - a13*(b*b))
         w1 = w(l, 1)*cf
         w3 = w(l, 3)*df
         twice(l) = w(l, 2) + g*(w(l, 2)*(cf*df) + (a2*s(l))*(w(l, 1)*w(l, 3))*den)
         v(l, i1) = (quarter*ps(l))*(w(l, 1) + g*(w1*den - (a1*b)*w3))
         v(l, i2) = (quarter*(rs(l) + class%theta*(ps(l) - rs(l))))*twice(l)
         v(l, i3) = (quarter*rs(l))*(w(l, 3) + g*(w3*den - (a3*b)*w1))
      end do
   end subroutine rotation_of_step

   !> The increments that a rotation gives: R^T y - y and q o (rho - 1), rho = (half, v/half), half
   !> the cosine of half the angle. The momentum about the axis of the smallest moment changes by an
   !> increment with its small factor in front.
   pure subroutine turn(class, ps, rs, v, twice, y, q, dy, dq)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(lanes) :: ps, rs, twice
      real(dp), intent(in) :: v(lanes, 3), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      real(dp) :: v1, v2, v3, k, half, root, u1, u2, u3, e0, e1, e2, e3
      real(dp) :: factor(lanes)
      integer :: l, i1, i3

      i1 = class%order(1)
      i3 = class%order(3)
      !GCC$ ivdep
      do l = 1, lanes
         v1 = v(l, 1)
         v2 = v(l, 2)
         v3 = v(l, 3)
         half = sqrt(0.5_dp + 0.5_dp*sqrt(1 - 4*(v1*v1 + v2*v2 + v3*v3)))
         root = 1/half
         k = 2*root*root
         factor(l) = k*twice(l)
         u1 = k*(v2*y(l, 3) - v3*y(l, 2)) - 2*y(l, 1)
         u2 = k*(v3*y(l, 1) - v1*y(l, 3)) - 2*y(l, 2)
         u3 = k*(v1*y(l, 2) - v2*y(l, 1)) - 2*y(l, 3)
         dy(l, 1) = v2*u3 - v3*u2
         dy(l, 2) = v3*u1 - v1*u3
         dy(l, 3) = v1*u2 - v2*u1
         e0 = half - 1
         e1 = v1*root
         e2 = v2*root
         e3 = v3*root
         dq(l, 1) = q(l, 1)*e0 - q(l, 2)*e1 - q(l, 3)*e2 - q(l, 4)*e3
         dq(l, 2) = q(l, 2)*e0 + q(l, 1)*e1 + q(l, 3)*e3 - q(l, 4)*e2
         dq(l, 3) = q(l, 3)*e0 + q(l, 1)*e2 + q(l, 4)*e1 - q(l, 2)*e3
         dq(l, 4) = q(l, 4)*e0 + q(l, 1)*e3 + q(l, 2)*e2 - q(l, 3)*e1
      end do
      !GCC$ ivdep
      do l = 1, lanes
         dy(l, i1) = -0.125_dp*(factor(l)*(2*y(l, i3) + dy(l, i3))*(class%f1*rs(l) &
            + class%theta*(ps(l) - rs(l))))
      end do
   end subroutine turn

end module poinsot_free_exact_step
