!> The explicit exact step: one pass from state to state, no iteration, no elliptic function
!> (mathematics, section 3).
!>
!> All kinds of body go through the same straight code. Everything is dimensionless: w = h omega,
!> and momenta only ever enter linearly. Three loops over the lanes, so that values stay in
!> registers and the division of one vector runs beside the arithmetic of others; statements that
!> more than one loop needs, those of bodies that all differ too (poinsot_free_exact_lanes), stand
!> in files of their own. Lanes that need longer series have them chosen by a mask: a lane's bits do
!> not depend on the lanes beside it.
module poinsot_free_exact_step
   use poinsot_core_kinds, only: dp, i8, group, lanes
   use poinsot_body_class, only: body_class, series_levels
   use poinsot_body_sine_series, only: short_sine, short_product, long_sine, half_cosine, &
      half_factor
   use poinsot_body_series_start, only: axis_series
   implicit none(type, external)
   private
   public :: single_pass, single_pass_increments, step_sizes, step_rotation

   !> The rotation of a step, axes sorted.
   type :: step_rotation
      real(dp) :: v(lanes, 3)   !! sin(angle) axis
      real(dp) :: loss(lanes)   !! of momentum about the axis of the smallest moment
      real(dp) :: cosine(lanes) !! cos(angle/2) - 1
      real(dp) :: factor(lanes) !! 1/(2 cos(angle/2))
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

   !> One step of each lane in one pass, plain sums, |q| drawn to 1. A lane with h = 0 keeps its
   !> bits. Where `too_long` comes out true, a lane is beyond the longest series of its class, and
   !> nothing has been done.
   pure subroutine single_pass(nvec, class, h, y, q, too_long)
      integer, intent(in) :: nvec            !! groups of lanes to work on
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes)       !! step of each lane, any sign; 0: it stands still
      real(dp), intent(inout) :: y(lanes, 3) !! angular momentum, caller's axes
      real(dp), intent(inout) :: q(lanes, 4) !! attitude
      logical, intent(out) :: too_long
      type(step_rotation) :: rotation
      call find_rotation(nvec, class, h, y, rotation, too_long)
      if (.not. too_long) call turn(nvec, class, rotation, h, y, q)
   end subroutine single_pass

   !> The same as increments of y and q.
   pure subroutine single_pass_increments(nvec, class, h, y, q, dy, dq, too_long)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      logical, intent(out) :: too_long
      type(step_rotation) :: rotation
      call find_rotation(nvec, class, h, y, rotation, too_long)
      if (.not. too_long) call rotation_increments(nvec, class, rotation, y, q, dy, dq)
   end subroutine single_pass_increments

   !> The rotation of one step of each lane.
   !>
   !> Lanes with short and with long series each go through a loop of their own, and mostly only one
   !> is needed: the first body says which to begin with.
   pure subroutine find_rotation(nvec, class, h, y, rotation, too_long)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes), y(lanes, 3)
      type(step_rotation), intent(inout) :: rotation
      logical, intent(out) :: too_long
      type(series_block) :: short, long
      integer(i8) :: far(lanes)
      logical :: any_far, any_near

      too_long = .false.
      any_near = .true.
      if (begins_far(class, h(1), y(1, 1), y(1, 2), y(1, 3))) then
         call long_series(nvec, class, h, y, long, far, any_near, too_long)
         if (too_long) return
         if (any_near) call short_series(nvec, class, h, y, short, any_far)
         any_far = .true.
      else
         call short_series(nvec, class, h, y, short, any_far)
         if (any_far) call long_series(nvec, class, h, y, long, far, any_near, too_long)
         if (too_long) return
      end if
      if (.not. any_near) then
         call find_axis_far(nvec, class, long, rotation)
      else if (any_far) then
         call take_chosen(nvec, far, long, short)
         call find_axis_both(nvec, class, far, short, rotation)
      else
         call find_axis(nvec, class, short, rotation)
      end if
   end subroutine find_rotation

   !> Does a body need the long series? A guess for its neighbours, by which no bit changes.
   pure logical function begins_far(class, h, y1, y2, y3)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h, y1, y2, y3
      real(dp) :: w1, w2, w3
      w1 = y1*class%inverse(1)*h
      w2 = y2*class%inverse(2)*h
      w3 = y3*class%inverse(3)*h
      begins_far = w1*w1 + w2*w2 + w3*w3 > class%reach(1)
   end function begins_far

   !> The long ones where `far` says so.
   pure subroutine take_chosen(nvec, far, long, s)
      integer, intent(in) :: nvec
      integer(i8), intent(in) :: far(lanes)
      type(series_block), intent(in) :: long
      type(series_block), intent(inout) :: s
      integer :: l
      !GCC$ ivdep
      do l = 1, group*nvec
         s%xs(l) = choose(far(l), long%xs(l), s%xs(l))
         s%zs(l) = choose(far(l), long%zs(l), s%zs(l))
         s%product(l) = choose(far(l), long%product(l), s%product(l))
         s%ps(l) = choose(far(l), long%ps(l), s%ps(l))
         s%rs(l) = choose(far(l), long%rs(l), s%rs(l))
      end do
   end subroutine take_chosen

   !> h omega, and the short series. (`target` here and below: what may be stored to is not copied
   !> before the loop; each coefficient then is the operand of an instruction.) Bits of positive
   !> numbers compare like the numbers.
   pure subroutine short_series(nvec, class, h, y, s, any_far)
      integer, intent(in) :: nvec
      type(body_class), intent(in), target :: class
      real(dp), intent(in) :: h(lanes), y(lanes, 3)
      type(series_block), intent(inout), target :: s
      logical, intent(out) :: any_far !! does a lane need the long ones?
      real(dp) :: m1, m2, m3, k1, k3, b4, c4, w1, w2, w3, square, p, r, cp, cr, x, z, e, f, t, u
      real(dp) :: xs, zs, product, ps, rs
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
      limit = transfer(class%reach(1), limit)
      over = 0
      associate (c => class%half_p, d => class%half_r)
         associate (p01 => c(0, 1), p11 => c(1, 1), p21 => c(2, 1), p31 => c(3, 1), &
                    p02 => c(0, 2), p12 => c(1, 2), p22 => c(2, 2), p03 => c(0, 3), &
                    p13 => c(1, 3), p04 => c(0, 4), r10 => d(1, 0), r11 => d(1, 1), &
                    r12 => d(1, 2), r13 => d(1, 3), r20 => d(2, 0), r21 => d(2, 1), &
                    r22 => d(2, 2), r30 => d(3, 0), r31 => d(3, 1), r40 => d(4, 0))
            !GCC$ ivdep
            do l = 1, group*nvec
               w1 = y(l, i1)*m1*h(l)
               w2 = y(l, i2)*m2*h(l)
               w3 = y(l, i3)*m3*h(l)
               include "exact_step_near.inc"
               over = ior(over, limit - transfer(p + r, limit))
               s%w(l, 1) = w1
               s%w(l, 2) = w2
               s%w(l, 3) = w3
               s%xs(l) = xs
               s%zs(l) = zs
               s%product(l) = product
               s%ps(l) = ps
               s%rs(l) = rs
            end do
         end associate
      end associate
      any_far = over < 0
   end subroutine short_series

   !> h omega, and the long series: degrees 0 to 7.
   pure subroutine long_series(nvec, class, h, y, s, far, any_near, too_long)
      integer, intent(in) :: nvec
      type(body_class), intent(in), target :: class
      real(dp), intent(in) :: h(lanes), y(lanes, 3)
      type(series_block), intent(inout), target :: s
      integer(i8), intent(out) :: far(lanes)   !! mask of the lanes that need them
      logical, intent(out) :: any_near         !! is there another one?
      logical, intent(out) :: too_long         !! is one beyond these too?
      real(dp) :: m1, m2, m3, k1, k3, b4, c4, w1, w2, w3, square, p, r, x, z, e, f, t, xs, zs, u, v
      integer(i8) :: limit, longest, over, near, mask
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
      limit = transfer(class%reach(1), limit)
      longest = transfer(class%reach(series_levels), longest)
      over = 0
      near = 0
      !GCC$ ivdep
      do l = 1, group*nvec
         w1 = y(l, i1)*m1*h(l)
         w2 = y(l, i2)*m2*h(l)
         w3 = y(l, i3)*m3*h(l)
         square = w2*w2
         p = w1*w1 + k1*square
         r = w3*w3 + k3*square
         mask = shifta(limit - transfer(p + r, mask), 63)
         over = ior(over, longest - transfer(p + r, over))
         near = ior(near, not(mask))
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
         s%w(l, 1) = w1
         s%w(l, 2) = w2
         s%w(l, 3) = w3
         s%xs(l) = xs
         s%zs(l) = zs
         s%product(l) = sqrt(max(t*((1 - xs)*(1 - zs)), 0.0_dp))
         associate (c => class%half_p, d => class%high_p)
            u = d(0, 6) + p*d(1, 6) + r*d(2, 6)
            u = d(0, 5) + p*(d(1, 5) + p*d(2, 5)) + r*u
            v = d(0, 4) + p*(d(1, 4) + p*d(2, 4))
            u = c(0, 4) + p*v + r*u
            v = d(0, 3) + p*(d(1, 3) + p*d(2, 3))
            u = c(0, 3) + p*(c(1, 3) + p*v) + r*u
            v = d(0, 2) + p*(d(1, 2) + p*d(2, 2))
            u = c(0, 2) + p*(c(1, 2) + p*(c(2, 2) + p*v)) + r*u
            v = d(0, 1) + p*(d(1, 1) + p*d(2, 1))
            u = c(0, 1) + p*(c(1, 1) + p*(c(2, 1) + p*(c(3, 1) + p*v))) + r*u
            v = d(0, 0) + p*(d(1, 0) + p*d(2, 0))
            s%ps(l) = c(0, 0) + p*(c(1, 0) + p*(c(2, 0) + p*(c(3, 0) + p*(c(4, 0) + p*v)))) + r*u
         end associate
         associate (c => class%half_r, d => class%high_r)
            u = d(0, 6) + p*d(1, 6) + r*d(2, 6)
            u = d(0, 5) + p*(d(1, 5) + p*d(2, 5)) + r*u
            v = d(0, 4) + p*(d(1, 4) + p*d(2, 4))
            u = c(0, 4) + p*v + r*u
            v = d(0, 3) + p*(d(1, 3) + p*d(2, 3))
            u = c(0, 3) + p*(c(1, 3) + p*v) + r*u
            v = d(0, 2) + p*(d(1, 2) + p*d(2, 2))
            u = c(0, 2) + p*(c(1, 2) + p*(c(2, 2) + p*v)) + r*u
            v = d(0, 1) + p*(d(1, 1) + p*d(2, 1))
            u = c(0, 1) + p*(c(1, 1) + p*(c(2, 1) + p*(c(3, 1) + p*v))) + r*u
            v = d(0, 0) + p*(d(1, 0) + p*d(2, 0))
            s%rs(l) = c(0, 0) + p*(c(1, 0) + p*(c(2, 0) + p*(c(3, 0) + p*(c(4, 0) + p*v)))) + r*u
         end associate
      end do
      too_long = over < 0
      any_near = near < 0
   end subroutine long_series

   !> The momentum at the end of the step by the duplication formula, and the rotation of the
   !> step; half its angle by polynomials.
   pure subroutine find_axis(nvec, class, s, rotation)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      type(series_block), intent(in) :: s
      type(step_rotation), intent(inout) :: rotation
      real(dp) :: a1, a2, a3, theta, f1, w1, w2, w3, xs, zs, product, ps, rs
      real(dp) :: den, u, cf, df, b, g, u1, u3, s1, s2, s3, d, loss, v1, v2, v3, vv
      real(dp) :: cosine, factor
      integer :: l, n
      a1 = class%a(1)
      a2 = class%a(2)
      a3 = class%a(3)
      theta = class%theta
      f1 = class%f1
      n = iand(group*nvec, not(group - 1)) ! says to the compiler that no lane is left over
      !GCC$ ivdep
      do l = 1, n
         w1 = s%w(l, 1)
         w2 = s%w(l, 2)
         w3 = s%w(l, 3)
         xs = s%xs(l)
         zs = s%zs(l)
         product = s%product(l)
         ps = s%ps(l)
         rs = s%rs(l)
         include "exact_step_second.inc"
         include "exact_step_angle.inc"
         rotation%v(l, 1) = v1
         rotation%v(l, 2) = v2
         rotation%v(l, 3) = v3
         rotation%loss(l) = loss
         rotation%cosine(l) = cosine
         rotation%factor(l) = factor
      end do
   end subroutine find_axis

   !> The same; half the angle by roots.
   pure subroutine find_axis_far(nvec, class, s, rotation)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      type(series_block), intent(in) :: s
      type(step_rotation), intent(inout) :: rotation
      real(dp) :: a1, a2, a3, theta, f1, w1, w2, w3, xs, zs, product, ps, rs
      real(dp) :: den, u, cf, df, b, g, u1, u3, s1, s2, s3, d, loss, v1, v2, v3, vv
      real(dp) :: half
      integer :: l, n
      a1 = class%a(1)
      a2 = class%a(2)
      a3 = class%a(3)
      theta = class%theta
      f1 = class%f1
      n = iand(group*nvec, not(group - 1))
      !GCC$ ivdep
      do l = 1, n
         w1 = s%w(l, 1)
         w2 = s%w(l, 2)
         w3 = s%w(l, 3)
         xs = s%xs(l)
         zs = s%zs(l)
         product = s%product(l)
         ps = s%ps(l)
         rs = s%rs(l)
         include "exact_step_second.inc"
         vv = v1*v1 + v2*v2 + v3*v3
         half = sqrt(0.5_dp + 0.5_dp*sqrt(1 - vv))
         rotation%v(l, 1) = v1
         rotation%v(l, 2) = v2
         rotation%v(l, 3) = v3
         rotation%loss(l) = loss
         rotation%cosine(l) = half - 1
         rotation%factor(l) = 0.5_dp/half
      end do
   end subroutine find_axis_far

   !> The same; half the angle by roots in the lanes that turn far.
   pure subroutine find_axis_both(nvec, class, far, s, rotation)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      integer(i8), intent(in) :: far(lanes)
      type(series_block), intent(in) :: s
      type(step_rotation), intent(inout) :: rotation
      real(dp) :: a1, a2, a3, theta, f1, w1, w2, w3, xs, zs, product, ps, rs
      real(dp) :: den, u, cf, df, b, g, u1, u3, s1, s2, s3, d, loss, v1, v2, v3, vv
      real(dp) :: cosine, factor, half
      integer :: l, n
      a1 = class%a(1)
      a2 = class%a(2)
      a3 = class%a(3)
      theta = class%theta
      f1 = class%f1
      n = iand(group*nvec, not(group - 1))
      !GCC$ ivdep
      do l = 1, n
         w1 = s%w(l, 1)
         w2 = s%w(l, 2)
         w3 = s%w(l, 3)
         xs = s%xs(l)
         zs = s%zs(l)
         product = s%product(l)
         ps = s%ps(l)
         rs = s%rs(l)
         include "exact_step_second.inc"
         include "exact_step_angle.inc"
         half = sqrt(0.5_dp + 0.5_dp*sqrt(1 - vv))
         rotation%v(l, 1) = v1
         rotation%v(l, 2) = v2
         rotation%v(l, 3) = v3
         rotation%loss(l) = loss
         rotation%cosine(l) = choose(far(l), half - 1, cosine)
         rotation%factor(l) = choose(far(l), 0.5_dp/half, factor)
      end do
   end subroutine find_axis_both

   !> The next state, plain sums.
   pure subroutine turn(nvec, class, rotation, h, y, q)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      type(step_rotation), intent(in) :: rotation
      real(dp), intent(in) :: h(lanes)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      real(dp) :: v1, v2, v3, cosine, factor, y1, y2, y3, q0, q1, q2, q3, draw
      real(dp) :: u1, u2, u3, k, d1, d2, d3, e0, e1, e2, e3, parity
      integer :: l, n, i1, i2, i3
      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      parity = class%parity
      n = iand(group*nvec, not(group - 1))
      !GCC$ ivdep
      do l = 1, n
         draw = merge(0.5_dp, 0.0_dp, abs(h(l)) > 0)
         include "exact_step_third.inc"
         y(l, i1) = y1 + d1
         y(l, i2) = y2 + d2
         y(l, i3) = y3 + d3
         q(l, 1) = parity*(q0 + e0)
         q(l, 1 + i1) = q1 + e1
         q(l, 1 + i2) = q2 + e2
         q(l, 1 + i3) = q3 + e3
      end do
   end subroutine turn

   !> The increments of y and q.
   pure subroutine rotation_increments(nvec, class, rotation, y, q, dy, dq)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      type(step_rotation), intent(in) :: rotation
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      real(dp) :: v1, v2, v3, cosine, factor, y1, y2, y3, q0, q1, q2, q3, draw
      real(dp) :: u1, u2, u3, k, d1, d2, d3, e0, e1, e2, e3, parity
      integer :: l, n, i1, i2, i3
      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      parity = class%parity
      draw = 0
      n = iand(group*nvec, not(group - 1))
      !GCC$ ivdep
      do l = 1, n
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

   include "../core/choose.inc"

end module poinsot_free_exact_step
