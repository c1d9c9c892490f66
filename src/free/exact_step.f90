!> The explicit exact step: one pass from state to state, no iteration, no elliptic function
!> (mathematics, section 3).
!>
!> All kinds of body go through the same straight code. Everything is dimensionless: w = h omega,
!> and momenta only ever enter linearly. Notation: xs = X T and zs = Z T are k^2 sn^2 and its
!> companion for half a step.
module poinsot_free_exact_step
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_body_class, only: body_class
   use poinsot_free_bands, only: sine_band, correction_band
   implicit none(type, external)
   private
   public :: exact_step_increment, step_sizes

contains

   !> p = h^2 p2 and r = h^2 r2, constants of the motion, and with them p + r, the largest (h
   !> |omega|)^2 of the motion.
   pure subroutine step_sizes(class, h, y, w, p, r, above)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes)       !! step of each lane, any sign; 0 for a lane that
                                             !! stands still
      real(dp), intent(in) :: y(lanes, 3)    !! angular momentum, caller's axes
      real(dp), intent(out) :: w(lanes, 3)   !! h omega, sorted axes
      real(dp), intent(out) :: p(lanes), r(lanes)
      real(dp), intent(out) :: above         !! the largest p + r
      real(dp) :: m(3)
      integer(i8) :: bits
      integer :: l, i1, i2, i3
      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      m = class%parity*class%inverse(class%order)
      bits = 0
      !GCC$ ivdep
      do l = 1, lanes
         w(l, 1) = y(l, i1)*m(1)*h(l)
         w(l, 2) = y(l, i2)*m(2)*h(l)
         w(l, 3) = y(l, i3)*m(3)*h(l)
         p(l) = w(l, 1)**2 + class%k1*w(l, 2)**2
         r(l) = w(l, 3)**2 + class%k3*w(l, 2)**2
         bits = max(bits, transfer(p(l) + r(l), bits))  ! of positive numbers, they compare alike
      end do
      above = transfer(bits, above)
   end subroutine step_sizes

   !> Increments of y and q over one step of at most `longest_step` = h |omega| (see step_sizes).
   !>
   !> In several passes over the lanes: divisions and roots of one vector then run beside the
   !> arithmetic of others.
   pure subroutine exact_step_increment(class, w, p, r, above, y, q, dy, dq)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: w(lanes, 3), p(lanes), r(lanes) !! from step_sizes
      real(dp), intent(in) :: above                           !! the largest p + r
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      real(dp), dimension(lanes) :: ps, rs, t, half, root, slip
      real(dp) :: v(lanes, 3)

      call sine_band(class, p, r, above, t)
      call both_ends(class, w, p, r, t, v)
      call correction_band(class, p, r, above, ps, rs)
      call rotation_of_step(class, ps, rs, v, half, root, slip)
      call turn(class, v, half, root, slip, y, q, dy, dq)
   end subroutine exact_step_increment

   !> h omega at both ends of the step, summed. That at the end comes from sn, cn, dn of half a step
   !> by the duplication formula.
   pure subroutine both_ends(class, w, p, r, t, sum)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(lanes) :: p, r, t
      real(dp), intent(in) :: w(lanes, 3)
      real(dp), intent(out) :: sum(lanes, 3)
      real(dp) :: xs, zs, xz, den, cf, df, s, b, g, w1, w3, a1, a2, a3, a13, c1, c3
      integer :: l
      a1 = class%a(1)
      a2 = class%a(2)
      a3 = class%a(3)
      a13 = a1*a3
      c1 = 0.25_dp*a1*a2
      c3 = 0.25_dp*a2*a3
      !GCC$ ivdep
      do l = 1, lanes
         xs = c1*r(l)*t(l)
         zs = c3*p(l)*t(l)
         xz = xs*zs
         den = 1 - xz
         cf = den - 2*(xs - xz)
         df = den - 2*(zs - xz)
         s = sqrt(t(l)*((1 - xs)*(1 - zs)))
         b = w(l, 2)*s
         g = 1/(den*den - a13*(b*b))
         w1 = w(l, 1)*cf
         w3 = w(l, 3)*df
         sum(l, 1) = w(l, 1) + g*(w1*den - (a1*b)*w3)
         sum(l, 2) = w(l, 2) + g*(w(l, 2)*(cf*df) + (a2*s)*(w(l, 1)*w(l, 3))*den)
         sum(l, 3) = w(l, 3) + g*(w3*den - (a3*b)*w1)
      end do
   end subroutine both_ends

   !> The rotation of the step, in sorted axes: v = sin(angle) axis, half = cos(angle/2), root =
   !> 1/(2 half). `slip` is what the momentum about the axis of the smallest moment loses, over
   !> root^2 (2 y3 + dy3).
   pure subroutine rotation_of_step(class, ps, rs, v, half, root, slip)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(lanes) :: ps, rs
      real(dp), intent(inout) :: v(lanes, 3)     !! in: from both_ends
      real(dp), intent(out), dimension(lanes) :: half, root, slip
      real(dp) :: hp, hr, d, f1, theta
      integer :: l
      f1 = 2*class%f1
      theta = 2*class%theta
      !GCC$ ivdep
      do l = 1, lanes
         hp = 0.5_dp*ps(l)
         hr = 0.5_dp*rs(l)
         d = hp - hr
         slip(l) = v(l, 2)*(f1*hr + theta*d)
         v(l, 1) = hp*v(l, 1)
         v(l, 2) = (hr + class%theta*d)*v(l, 2)
         v(l, 3) = hr*v(l, 3)
         half(l) = sqrt(0.5_dp + 0.5_dp*sqrt(1 - (v(l, 1)**2 + v(l, 2)**2 + v(l, 3)**2)))
         root(l) = 0.5_dp/half(l)
      end do
   end subroutine rotation_of_step

   !> The increments that a rotation gives: R^T y - y and q o (rho - 1), rho = (half, root v). The
   !> momentum about the axis of the smallest moment changes by an increment with its small factor
   !> in front.
   !>
   !> All in sorted axes, the columns of y and q exchanged. Where the order of axes is odd, y and
   !> the vector part of q are then minus what they are in a right-handed frame; that shows only
   !> where v meets the scalar part of q.
   pure subroutine turn(class, v, half, root, slip, y, q, dy, dq)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(lanes) :: half, root, slip
      real(dp), intent(in) :: v(lanes, 3), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      real(dp) :: v1, v2, v3, k, y1, y2, y3, u1, u2, u3, d3, q0, q1, q2, q3, e0, a0, a1, a2, a3
      integer :: l, i1, i2, i3
      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      !GCC$ ivdep
      do l = 1, lanes
         v1 = v(l, 1)
         v2 = v(l, 2)
         v3 = v(l, 3)
         y1 = y(l, i1)
         y2 = y(l, i2)
         y3 = y(l, i3)
         q0 = class%parity*q(l, 1)
         q1 = q(l, 1 + i1)
         q2 = q(l, 1 + i2)
         q3 = q(l, 1 + i3)
         u1 = v2*y3 - v3*y2
         u2 = v3*y1 - v1*y3
         u3 = v1*y2 - v2*y1
         a0 = q1*v1 + q2*v2 + q3*v3
         a1 = q0*v1 + (q2*v3 - q3*v2)
         a2 = q0*v2 + (q3*v1 - q1*v3)
         a3 = q0*v3 + (q1*v2 - q2*v1)
         k = root(l)*root(l)
         u1 = (2*k)*u1 - y1
         u2 = (2*k)*u2 - y2
         u3 = (2*k)*u3 - y3
         d3 = v1*u2 - v2*u1
         dy(l, i1) = -(k*slip(l))*(2*y3 + d3)
         dy(l, i2) = v3*u1 - v1*u3
         dy(l, i3) = d3
         e0 = half(l) - 1
         dq(l, 1) = class%parity*(q0*e0 - a0*root(l))
         dq(l, 1 + i1) = q1*e0 + a1*root(l)
         dq(l, 1 + i2) = q2*e0 + a2*root(l)
         dq(l, 1 + i3) = q3*e0 + a3*root(l)
      end do
   end subroutine turn

end module poinsot_free_exact_step
