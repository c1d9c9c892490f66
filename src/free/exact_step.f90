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
      real(dp), dimension(lanes) :: ps, rs, t, s

      call all_series(class, p, r, above, ps, rs, t, s)
      call rotate(class, w, p, r, ps, rs, t, s, y, q, dy, dq)
   end subroutine exact_step_increment

   !> 1 + P, 1 + R, T, W, each lane with the shortest series that is exact to rounding for it.
   pure subroutine all_series(class, p, r, above, ps, rs, t, w)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: p(lanes), r(lanes), above
      real(dp), intent(out), dimension(lanes) :: ps, rs, t, w
      real(dp), dimension(lanes) :: e, f, takes
      integer :: l
      real(dp) :: c1, c3, x, z

      c1 = 0.25_dp*class%a(1)*class%a(2)
      c3 = 0.25_dp*class%a(2)*class%a(3)
      !GCC$ ivdep
      do l = 1, lanes
         x = c1*r(l)
         z = c3*p(l)
         e(l) = x + z
         f(l) = x*z
      end do
      call low_band(class, p, r, e, f, ps, rs, t, w)
      if (above <= class%reach(1)) return
      takes = merge(1.0_dp, 0.0_dp, p + r > class%reach(1))
      call middle_band(class, p, r, e, f, takes, ps, rs, t, w)
      if (above <= class%reach(2)) return
      takes = merge(1.0_dp, 0.0_dp, p + r > class%reach(2))
      call high_band(class, p, r, e, f, takes, ps, rs, t, w)
   end subroutine all_series

   !> The increments of the step from the series: R^T y - y and q o (rho - 1), rho = (half, v/(2
   !> half)) the rotation, half the cosine of half its angle, v = sin(angle) axis.
   !>
   !> All in sorted axes, q and y with their columns exchanged: where the order of axes is odd, y and
   !> the vector part of q are minus what they are in a right-handed frame, which shows only where q's
   !> scalar part meets v. The momentum about the axis of the smallest moment changes by an increment
   !> with its small factor in front.
   pure subroutine rotate(class, w, p, r, ps, rs, t, s, y, q, dy, dq)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(lanes) :: p, r, ps, rs, t, s
      real(dp), intent(in) :: w(lanes, 3), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      real(dp) :: xs, zs, den, cf, df, b, g, w1, w2, w3, wc, wd, twice, hp, hr, d, v1, v2, v3
      real(dp) :: half, root, k, y1, y2, y3, u1, u2, u3, d3, q0, q1, q2, q3, e0, e1, e2, e3
      real(dp) :: a1, a2, a3, a13, c1, c3, f1, f3, parity
      real(dp) :: va(lanes, 3), tw(lanes), ha(lanes), ra(lanes)
      integer :: l, i1, i2, i3
      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      a1 = class%a(1)
      a2 = class%a(2)
      a3 = class%a(3)
      a13 = a1*a3
      c1 = 0.25_dp*a1*a2
      c3 = 0.25_dp*a2*a3
      f1 = 2*class%f1
      f3 = 2*class%theta
      parity = class%parity
      !GCC$ ivdep
      do l = 1, lanes
         w1 = w(l, 1)
         w2 = w(l, 2)
         w3 = w(l, 3)
         ! omega at the end of the step, from sn, cn, dn of half a step by the duplication formula
         xs = c1*r(l)*t(l)
         zs = c3*p(l)*t(l)
         den = 1 - xs*zs
         cf = den - 2*(xs - xs*zs)
         df = den - 2*(zs - xs*zs)
         b = w2*s(l)
         g = 1/(den*den - a13*(b*b))
         wc = w1*cf
         wd = w3*df
         twice = w2 + g*(w2*(cf*df) + (a2*s(l))*(w1*w3)*den)
         hp = 0.5_dp*ps(l)
         hr = 0.5_dp*rs(l)
         d = hp - hr
         v1 = hp*(w1 + g*(wc*den - (a1*b)*wd))
         v2 = (hr + class%theta*d)*twice
         v3 = hr*(w3 + g*(wd*den - (a3*b)*wc))
         va(l,1)=v1
         va(l,2)=v2
         va(l,3)=v3
         tw(l)=twice*(f1*hr + f3*d)
         half = sqrt(0.5_dp + 0.5_dp*sqrt(1 - (v1*v1 + v2*v2 + v3*v3)))
         ha(l) = half
         ra(l) = 0.5_dp/half
      end do
      !GCC$ ivdep
      do l = 1, lanes
         root = ra(l)
         k = root*root
         v1=va(l,1)
         v2=va(l,2)
         v3=va(l,3)
         y1 = y(l, i1)
         y2 = y(l, i2)
         y3 = y(l, i3)
         u1 = 2*k*(v2*y3 - v3*y2) - y1
         u2 = 2*k*(v3*y1 - v1*y3) - y2
         u3 = 2*k*(v1*y2 - v2*y1) - y3
         d3 = v1*u2 - v2*u1
         dy(l, i1) = -(k*tw(l))*(2*y3 + d3)
         dy(l, i2) = v3*u1 - v1*u3
         dy(l, i3) = d3
         e0 = ha(l) - 1
         e1 = v1*root
         e2 = v2*root
         e3 = v3*root
         q0 = parity*q(l, 1)
         q1 = q(l, 1 + i1)
         q2 = q(l, 1 + i2)
         q3 = q(l, 1 + i3)
         dq(l, 1) = parity*(q0*e0 - (q1*e1 + q2*e2 + q3*e3))
         dq(l, 1 + i1) = q1*e0 + q0*e1 + (q2*e3 - q3*e2)
         dq(l, 1 + i2) = q2*e0 + q0*e2 + (q3*e1 - q1*e3)
         dq(l, 1 + i3) = q3*e0 + q0*e3 + (q1*e2 - q2*e1)
      end do
   end subroutine rotate

end module poinsot_free_exact_step
