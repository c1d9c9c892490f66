!> The explicit exact step: one pass from state to state, no iteration, no elliptic function
!> (mathematics, section 3).
!>
!> All kinds of body go through the same straight code. Everything is dimensionless: w = h omega,
!> and momenta only ever enter linearly. Three loops over the lanes, so that values stay in registers
!> and the division of one vector runs beside the arithmetic of others; the statements in them stand
!> in files of their own because bodies that all differ need the same ones (poinsot_free_exact_lanes).
!> Lanes that need longer series have them chosen by a mask: a lane's bits do not depend on the
!> lanes beside it.
module poinsot_free_exact_step
   use poinsot_core_kinds, only: dp, i8, group, lanes
   use poinsot_body_class, only: body_class, series_levels
   use poinsot_body_sine_series, only: short_sine, short_product, long_sine, half_cosine, &
      half_factor
   use poinsot_body_series_start, only: axis_series
   implicit none(type, external)
   private
   public :: step_rotation, find_rotation, rotate_state, rotation_increments, step_sizes

   !> The rotation of a step, axes sorted.
   type :: step_rotation
      real(dp) :: v(lanes, 3)    !! sin(angle) axis
      real(dp) :: cosine(lanes)  !! cos(angle/2) - 1
      real(dp) :: factor(lanes)  !! 1/(2 cos(angle/2))
      real(dp) :: loss(lanes)    !! of momentum about the axis of the smallest moment
   end type step_rotation

   !> What stands between the first loop and the second.
   type :: series_block
      real(dp) :: w(lanes, 3)                             !! h omega, axes sorted
      real(dp), dimension(lanes) :: xs, zs, product       !! X T, Z T, S C D
      real(dp), dimension(lanes) :: ps, rs                !! (1 + P)/2, (1 + R)/2
   end type series_block

contains

   !> p = h^2 p2 and r = h^2 r2, constants of the motion, whose sum is the largest (h |omega|)^2 of
   !> the motion.
   pure subroutine step_sizes(nvec, class, h, y, w, p, r)
      integer, intent(in) :: nvec            !! groups of lanes to work on
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes)       !! step of each lane, any sign; 0 for a lane that
                                             !! stands still
      real(dp), intent(in) :: y(lanes, 3)    !! angular momentum, caller's axes
      real(dp), intent(out) :: w(lanes, 3)   !! h omega, sorted axes
      real(dp), intent(out) :: p(lanes), r(lanes)
      real(dp) :: m1, m2, m3
      integer :: l, i1, i2, i3
      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      m1 = class%parity*class%inverse(i1)
      m2 = class%parity*class%inverse(i2)
      m3 = class%parity*class%inverse(i3)
      !GCC$ ivdep
      do l = 1, group*nvec
         w(l, 1) = y(l, i1)*m1*h(l)
         w(l, 2) = y(l, i2)*m2*h(l)
         w(l, 3) = y(l, i3)*m3*h(l)
         p(l) = w(l, 1)**2 + class%k1*w(l, 2)**2
         r(l) = w(l, 3)**2 + class%k3*w(l, 2)**2
      end do
   end subroutine step_sizes

   !> The rotation of one step of each lane. Where `too_long` comes out true, a lane is beyond the
   !> longest series of its class, and there is no rotation for any.
   pure subroutine find_rotation(nvec, class, h, y, rotation, too_long)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes)       !! step of each lane, any sign; 0: it stands still
      real(dp), intent(in) :: y(lanes, 3)    !! angular momentum, caller's axes
      type(step_rotation), intent(inout) :: rotation
      logical, intent(out) :: too_long
      type(series_block) :: s
      integer(i8) :: far(lanes)
      logical :: any_far

      call first_loop(nvec, class, h, y, s, any_far)
      too_long = .false.
      if (any_far) call take_long_series(nvec, class, s, far, too_long)
      if (too_long) return
      call second_loop(nvec, class, s, rotation)
      if (any_far) call take_roots(nvec, far, rotation)
   end subroutine find_rotation

   !> h omega, and the short series.
   pure subroutine first_loop(nvec, class, h, y, s, any_far)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes), y(lanes, 3)
      type(series_block), intent(inout) :: s
      logical, intent(out) :: any_far !! does a lane need the long ones?
      real(dp) :: m1, m2, m3, k1, k3, b4, c4, w1, w2, w3, square, p, r, cp, cr, x, z, e, f, t, u
      real(dp) :: xs, zs, product, ps, rs, p01, p11, p21, p31, p02, p12, p22, p03, p13, p04
      real(dp) :: r10, r11, r12, r13, r20, r21, r22, r30, r31, r40
      integer(i8) :: limit, over
      integer :: l, i1, i2, i3
      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      m1 = class%parity*class%inverse(i1)
      m2 = class%parity*class%inverse(i2)
      m3 = class%parity*class%inverse(i3)
      k1 = class%k1
      k3 = class%k3
      b4 = 0.25_dp*(class%a(1)*class%a(2))
      c4 = 0.25_dp*(class%a(2)*class%a(3))
      associate (c => class%half_p)
         p01 = c(0, 1); p11 = c(1, 1); p21 = c(2, 1); p31 = c(3, 1); p02 = c(0, 2)
         p12 = c(1, 2); p22 = c(2, 2); p03 = c(0, 3); p13 = c(1, 3); p04 = c(0, 4)
      end associate
      associate (c => class%half_r)
         r10 = c(1, 0); r11 = c(1, 1); r12 = c(1, 2); r13 = c(1, 3); r20 = c(2, 0)
         r21 = c(2, 1); r22 = c(2, 2); r30 = c(3, 0); r31 = c(3, 1); r40 = c(4, 0)
      end associate
      limit = transfer(class%reach(1), limit)
      over = 0
      !GCC$ ivdep
      do l = 1, group*nvec
         w1 = y(l, i1)*m1*h(l)
         w2 = y(l, i2)*m2*h(l)
         w3 = y(l, i3)*m3*h(l)
         include "exact_step_first.inc"
         over = ior(over, limit - transfer(p + r, limit)) ! bits of positive numbers compare like
         s%w(l, 1) = w1                                   ! the numbers
         s%w(l, 2) = w2
         s%w(l, 3) = w3
         s%xs(l) = xs
         s%zs(l) = zs
         s%product(l) = product
         s%ps(l) = ps
         s%rs(l) = rs
      end do
      any_far = over < 0
   end subroutine first_loop

   !> The long series, for the lanes that need them.
   pure subroutine take_long_series(nvec, class, s, far, too_long)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      type(series_block), intent(inout) :: s
      integer(i8), intent(out) :: far(lanes) !! mask of these lanes
      logical, intent(out) :: too_long       !! is one beyond these too?
      real(dp) :: k1, k3, b4, c4, square, p, r, x, z, e, f, t, xs, zs, pp, rr, e0, e1, e2
      integer(i8) :: limit, longest, over, mask
      integer :: l
      k1 = class%k1
      k3 = class%k3
      b4 = 0.25_dp*(class%a(1)*class%a(2))
      c4 = 0.25_dp*(class%a(2)*class%a(3))
      limit = transfer(class%reach(1), limit)
      longest = transfer(class%reach(series_levels), longest)
      over = 0
      !GCC$ ivdep
      do l = 1, group*nvec
         square = s%w(l, 2)*s%w(l, 2)
         p = s%w(l, 1)*s%w(l, 1) + k1*square
         r = s%w(l, 3)*s%w(l, 3) + k3*square
         mask = shifta(limit - transfer(p + r, mask), 63)
         over = ior(over, longest - transfer(p + r, over))
         far(l) = mask
         p = min(p, 1.0_dp)
         r = min(r, 1.0_dp)
         x = b4*r
         z = c4*p
         e = x + z
         f = x*z
         associate (a => long_sine)
            t = a(15) + e*(a(16) + e*(a(17) + e*a(18))) + f*(a(19) + e*a(20))
            t = a(9) + e*(a(10) + e*(a(11) + e*(a(12) + e*(a(13) + e*a(14))))) + f*t
            t = a(1) + e*(a(2) + e*(a(3) + e*(a(4) + e*(a(5) + e*(a(6) + e*(a(7) + e*a(8))))))) &
               + f*t
         end associate
         xs = x*t
         zs = z*t
         s%product(l) = choose(mask, sqrt(max(t*((1 - xs)*(1 - zs)), 0.0_dp)), s%product(l))
         s%xs(l) = choose(mask, xs, s%xs(l))
         s%zs(l) = choose(mask, zs, s%zs(l))
         pp = p*p
         rr = r*r
         associate (c => class%high_p)
            e0 = (c(0, 0) + p*(c(1, 0) + p*c(2, 0)))*p + (c(0, 1) + p*(c(1, 1) + p*c(2, 1)))*r
            e1 = (c(0, 2) + p*(c(1, 2) + p*c(2, 2)))*p + (c(0, 3) + p*(c(1, 3) + p*c(2, 3)))*r
            e2 = (c(0, 4) + p*(c(1, 4) + p*c(2, 4)))*p &
               + (c(0, 5) + p*(c(1, 5) + p*c(2, 5)) + r*(c(0, 6) + p*c(1, 6) + r*c(2, 6)))*r
         end associate
         s%ps(l) = choose(mask, s%ps(l) + ((e0*pp + e1*rr)*pp + e2*(rr*rr)), s%ps(l))
         associate (c => class%high_r)
            e0 = (c(0, 0) + p*(c(1, 0) + p*c(2, 0)))*p + (c(0, 1) + p*(c(1, 1) + p*c(2, 1)))*r
            e1 = (c(0, 2) + p*(c(1, 2) + p*c(2, 2)))*p + (c(0, 3) + p*(c(1, 3) + p*c(2, 3)))*r
            e2 = (c(0, 4) + p*(c(1, 4) + p*c(2, 4)))*p &
               + (c(0, 5) + p*(c(1, 5) + p*c(2, 5)) + r*(c(0, 6) + p*c(1, 6) + r*c(2, 6)))*r
         end associate
         s%rs(l) = choose(mask, s%rs(l) + ((e0*pp + e1*rr)*pp + e2*(rr*rr)), s%rs(l))
      end do
      too_long = over < 0
   end subroutine take_long_series

   !> The momentum at the end of the step by the duplication formula, and the rotation.
   pure subroutine second_loop(nvec, class, s, rotation)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      type(series_block), intent(in) :: s
      type(step_rotation), intent(inout) :: rotation
      real(dp) :: a1, a2, a3, theta, f1, w1, w2, w3, xs, zs, product, ps, rs
      real(dp) :: den, u, cf, df, b, g, u1, u3, s1, s2, s3, d, loss, v1, v2, v3, vv
      integer :: l
      a1 = class%a(1)
      a2 = class%a(2)
      a3 = class%a(3)
      theta = class%theta
      f1 = class%f1
      !GCC$ ivdep
      do l = 1, group*nvec
         w1 = s%w(l, 1)
         w2 = s%w(l, 2)
         w3 = s%w(l, 3)
         xs = s%xs(l)
         zs = s%zs(l)
         product = s%product(l)
         ps = s%ps(l)
         rs = s%rs(l)
         include "exact_step_second.inc"
         rotation%v(l, 1) = v1
         rotation%v(l, 2) = v2
         rotation%v(l, 3) = v3
         rotation%loss(l) = loss
         rotation%cosine(l) = vv*(half_cosine(0) + vv*(half_cosine(1) + vv*(half_cosine(2) &
            + vv*(half_cosine(3) + vv*(half_cosine(4) + vv*half_cosine(5))))))
         rotation%factor(l) = half_factor(0) + vv*(half_factor(1) + vv*(half_factor(2) &
            + vv*(half_factor(3) + vv*(half_factor(4) + vv*half_factor(5)))))
      end do
   end subroutine second_loop

   !> The half angle by roots, for the lanes that turn further.
   pure subroutine take_roots(nvec, far, rotation)
      integer, intent(in) :: nvec
      integer(i8), intent(in) :: far(lanes)
      type(step_rotation), intent(inout) :: rotation
      real(dp) :: vv, half
      integer :: l
      !GCC$ ivdep
      do l = 1, group*nvec
         vv = rotation%v(l, 1)**2 + rotation%v(l, 2)**2 + rotation%v(l, 3)**2
         half = sqrt(0.5_dp + 0.5_dp*sqrt(1 - vv))
         rotation%cosine(l) = choose(far(l), half - 1, rotation%cosine(l))
         rotation%factor(l) = choose(far(l), 0.5_dp/half, rotation%factor(l))
      end do
   end subroutine take_roots

   !> The next state, plain sums, |q| drawn to 1. A lane with h = 0 keeps its bits.
   pure subroutine rotate_state(nvec, class, rotation, h, y, q)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      type(step_rotation), intent(in) :: rotation
      real(dp), intent(in) :: h(lanes)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      real(dp) :: v1, v2, v3, loss, cosine, factor, y1, y2, y3, q0, q1, q2, q3, parity, draw
      real(dp) :: u1, u2, u3, k, d1, d2, d3, e0, e1, e2, e3
      integer :: l, i1, i2, i3
      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      parity = class%parity
      !GCC$ ivdep
      do l = 1, group*nvec
         v1 = rotation%v(l, 1)
         v2 = rotation%v(l, 2)
         v3 = rotation%v(l, 3)
         loss = rotation%loss(l)
         factor = rotation%factor(l)
         y1 = y(l, i1)
         y2 = y(l, i2)
         y3 = y(l, i3)
         q0 = parity*q(l, 1)
         q1 = q(l, 1 + i1)
         q2 = q(l, 1 + i2)
         q3 = q(l, 1 + i3)
         draw = merge(0.5_dp, 0.0_dp, abs(h(l)) > 0)
         cosine = rotation%cosine(l) - draw*((q0*q0 + q1*q1) + (q2*q2 + q3*q3) - 1)
         include "exact_step_third.inc"
         y(l, i1) = y1 + d1
         y(l, i2) = y2 + d2
         y(l, i3) = y3 + d3
         q(l, 1) = parity*(q0 + e0)
         q(l, 1 + i1) = q1 + e1
         q(l, 1 + i2) = q2 + e2
         q(l, 1 + i3) = q3 + e3
      end do
   end subroutine rotate_state

   !> The increments of y and q.
   pure subroutine rotation_increments(nvec, class, rotation, y, q, dy, dq)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      type(step_rotation), intent(in) :: rotation
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      real(dp) :: v1, v2, v3, loss, cosine, factor, y1, y2, y3, q0, q1, q2, q3, parity
      real(dp) :: u1, u2, u3, k, d1, d2, d3, e0, e1, e2, e3
      integer :: l, i1, i2, i3
      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      parity = class%parity
      !GCC$ ivdep
      do l = 1, group*nvec
         v1 = rotation%v(l, 1)
         v2 = rotation%v(l, 2)
         v3 = rotation%v(l, 3)
         loss = rotation%loss(l)
         factor = rotation%factor(l)
         cosine = rotation%cosine(l)
         y1 = y(l, i1)
         y2 = y(l, i2)
         y3 = y(l, i3)
         q0 = parity*q(l, 1)
         q1 = q(l, 1 + i1)
         q2 = q(l, 1 + i2)
         q3 = q(l, 1 + i3)
         include "exact_step_third.inc"
         dy(l, i1) = d1
         dy(l, i2) = d2
         dy(l, i3) = d3
         dq(l, 1) = parity*e0
         dq(l, 1 + i1) = e1
         dq(l, 1 + i2) = e2
         dq(l, 1 + i3) = e3
      end do
   end subroutine rotation_increments

   !> a where the mask is all ones, b where it is zero: a choice that cannot become a branch.
   elemental real(dp) function choose(mask, a, b)
      integer(i8), intent(in) :: mask
      real(dp), intent(in) :: a, b
      choose = transfer(ior(iand(transfer(a, mask), mask), iand(transfer(b, mask), not(mask))), a)
   end function choose

end module poinsot_free_exact_step
