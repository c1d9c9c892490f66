!> `jacobi`: free motion of any body over any step by Jacobi's elliptic functions (mathematics,
!> section 4).
!>
!> C. G. J. Jacobi, J. reine angew. Math. 39 (1850) 293-350, for the momentum; the angle about it is
!> an integral of the third kind, here Carlson's R_J by duplication. Its arctangents are not taken
!> but multiplied, as complex numbers: L nu/sqrt(c1 B), the factor of the integral in the angle, and
!> the root g = sqrt(nu (1 + nu) (nu + k**2)) that R_J divides them by are one and the same number,
!> so they are plain angles. One call may jump any number of periods.
!>
!> Straight code for all lanes: axes and poles are chosen by masks, and lanes that have converged
!> are held by masks, so a lane's bits depend on that lane alone. Momenta are divided by a power of
!> two near |y|, moments by one near the largest.
module poinsot_free_jacobi_solution
   use poinsot_core_constants, only: exponent_bits
   use poinsot_core_kinds, only: dp, i8, group, lanes
   use poinsot_core_status, only: poinsot_e_step
   use poinsot_body_class, only: body_class
   use poinsot_body_constants, only: lane_constants
   use poinsot_elliptic_elementary, only: atan2_block, sincos_block
   use poinsot_elliptic_jacobi_kernel, only: jacobi_block
   use poinsot_elliptic_third_kind, only: third_kind_block
   implicit none(type, external)
   private
   public :: jacobi_increment, jacobi_lanes

   real(dp), parameter :: longest_phase = 1.0e15_dp   !! radians; beyond, no digit is left
   integer(i8), parameter :: longest_exponent = 60_i8 !! the same, roughly, as a power of two
   real(dp), parameter :: tail = 340.0_dp             !! phase at which cn and dn are as good as 0
   real(dp), parameter :: tail_square = 4.7e-295_dp   !! and their squares there, 4 exp(-2 tail)
   integer(i8), parameter :: top26 = not(134217727_i8)             !! keeps 26 significant bits
   integer(i8), parameter :: top_exponent = 9214364837600034816_i8 !! of 2**1023

   !> Constants of a body, axes in order and with 1 and 3 exchanged. m: inverse moments; rate =
   !> sqrt(d13 d23), d13 = m1 - m3, d23 = m2 - m3, with the sign of d13.
   type :: axes_constants
      real(dp) :: c1 = 0.5_dp, c2 = 0.5_dp, m1 = 1, m3 = 1, rate = 0, exchanged_rate = 0
   end type axes_constants

   !> The same for a block, of one body class or of bodies that all differ.
   type :: axes_block
      integer :: order(3) = [1, 2, 3]           !! which columns of y and q are the sorted axes
      real(dp) :: parity = 1                    !! of this order
      real(dp), dimension(lanes) :: scale       !! of the moments, a power of two
      real(dp), dimension(lanes) :: c1, c2, m1, m3, rate, exchanged_rate
   end type axes_block

   !> The lanes at the start of the step.
   type :: start_type
      real(dp), dimension(lanes) :: y1, y2, y3         !! momentum, scaled, axes in the order chosen
      real(dp), dimension(lanes) :: unit               !! scaled momentum times it is the caller's
      real(dp), dimension(lanes) :: tau                !! step, scaled to match
      real(dp), dimension(lanes) :: c1, c2, m1, m3     !! constants, axes in the order chosen
      real(dp), dimension(lanes) :: a, b               !! A and B, constants of the motion
      real(dp), dimension(lanes) :: k2, kc2, w         !! parameters, and the increase of the phase
      integer(i8), dimension(lanes) :: exchanged       !! mask: axes 1 and 3 exchanged
      integer(i8), dimension(lanes) :: quiet           !! mask: to be left alone
   end type start_type

   !> The end of the step, and the angle about the momentum.
   type :: end_type
      real(dp), dimension(lanes) :: v1, v2, v3         !! momentum
      real(dp), dimension(lanes) :: low1, low2, low3   !! and what rounding took from it
      real(dp), dimension(lanes) :: s0, s1, c1, d1     !! sn at the start; sn, cn, dn at the end
      real(dp), dimension(lanes) :: nu, g              !! characteristic, factor of the integral
      real(dp), dimension(lanes) :: half               !! half the angle, but for arctangents
      real(dp), dimension(lanes) :: sgn                !! sign of the integral in the angle
      real(dp), dimension(lanes) :: re, im             !! half the arctangents, a complex number
      integer(i8), dimension(lanes) :: pole1           !! mask: counted about axis 1, not 3
   end type end_type

contains

   !> Increments of y and q over h, exact to rounding, for every body and any h. POINSOT_E_STEP, and
   !> zero increments, where h |omega| is beyond about 1e15. The rotation is the one below half a
   !> turn.
   pure subroutine jacobi_increment(nvec, class, terms, h, y, q, dy, dq, status)
      integer, intent(in) :: nvec             !! groups of lanes to work on
      type(body_class), intent(in) :: class   !! of these bodies
      integer, intent(in) :: terms            !! not used
      real(dp), intent(in) :: h(lanes)        !! step of each lane, either sign; 0: stands still
      real(dp), intent(in) :: y(lanes, 3)     !! angular momentum, caller's axes
      real(dp), intent(in) :: q(lanes, 4)     !! attitude, unit quaternion
      real(dp), intent(out) :: dy(lanes, 3)   !! y(h) - y
      real(dp), intent(out) :: dq(lanes, 4)   !! q(h) - q
      integer, intent(inout) :: status(lanes) !! POINSOT_E_STEP where h is too long
      type(axes_block) :: axes
      type(axes_constants) :: one
      integer :: n
      n = group*nvec
      one = constants_of(class%sorted(1), class%sorted(2), class%sorted(3), class%top)
      axes%order = class%order
      axes%parity = class%parity
      axes%scale(:n) = class%scale
      axes%c1(:n) = one%c1
      axes%c2(:n) = one%c2
      axes%m1(:n) = one%m1
      axes%m3(:n) = one%m3
      axes%rate(:n) = one%rate
      axes%exchanged_rate(:n) = one%exchanged_rate
      call block_increment(nvec, axes, h, y, q, dy, dq, status)
   end subroutine jacobi_increment

   !> The same for bodies that all differ, their axes sorted and right-handed already.
   pure subroutine jacobi_lanes(nvec, c, h, y, q, dy, dq, status)
      integer, intent(in) :: nvec
      type(lane_constants), intent(in) :: c
      real(dp), intent(in) :: h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      type(axes_block) :: axes
      type(axes_constants) :: one
      integer :: l
      do l = 1, group*nvec
         one = constants_of(c%moments(l, 1), c%moments(l, 2), c%moments(l, 3), c%top(l))
         axes%scale(l) = c%scale(l)
         axes%c1(l) = one%c1
         axes%c2(l) = one%c2
         axes%m1(l) = one%m1
         axes%m3(l) = one%m3
         axes%rate(l) = one%rate
         axes%exchanged_rate(l) = one%exchanged_rate
      end do
      call block_increment(nvec, axes, h, y, q, dy, dq, status)
   end subroutine jacobi_lanes

   pure subroutine block_increment(nvec, axes, h, y, q, dy, dq, status)
      integer, intent(in) :: nvec
      type(axes_block), intent(in) :: axes
      real(dp), intent(in) :: h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      type(start_type) :: start
      type(end_type) :: finish
      real(dp), dimension(lanes) :: s, c, d, turns, sf, cf
      real(dp) :: rho(lanes, 4)
      integer(i8) :: too_long(lanes)
      integer :: n

      call scale_lanes(nvec, axes, h, y, start, too_long)
      call order_axes(nvec, axes, start)
      call find_phase(nvec, axes, start, too_long)
      call jacobi_block(start%w, start%k2, start%kc2, s, c, d, turns, nvec)
      call unfold(nvec, turns, s, c, sf, cf)
      call move(nvec, start, sf, cf, d, finish)
      call choose_pole(nvec, start, finish, too_long)
      call arctangents(nvec, start, sf, finish)
      call third_kind(nvec, start, s, c, d, turns, finish)
      n = group*nvec
      if (any(abs(turns(:n)) > 0.0_dp)) call whole_turns(nvec, start, turns, finish)
      call rotation(nvec, start, finish, rho)
      call increments(nvec, axes, start, finish, rho, q, dy, dq)
      where (too_long(:n) /= 0_i8) status(:n) = poinsot_e_step
   end subroutine block_increment

   include "../core/choose.inc"
   include "../core/below.inc"

   !> Constants of a body; the zero moment of a linear one is taken as equal to the others.
   pure type(axes_constants) function constants_of(first, middle, last, top) result(axes)
      real(dp), intent(in) :: first, middle, last !! moments, ascending, over a power of two
      real(dp), intent(in) :: top                 !! last - middle
      real(dp) :: i1, i2, i3, d13
      i1 = first
      i2 = middle
      i3 = last
      if (i1 <= 0.0_dp) i1 = i2
      if (i1 <= 0.0_dp) i1 = i3
      if (i2 <= 0.0_dp) i2 = i3
      axes%m1 = 1.0_dp/i1
      axes%m3 = 1.0_dp/i3
      if (i3 <= i1) return
      axes%c1 = (i1/i2)*(top/(i3 - i1))
      axes%c2 = (i3/i2)*((i2 - i1)/(i3 - i1))
      d13 = (i3 - i1)/i1/i3
      axes%rate = sqrt(d13)*sqrt(top/i2/i3)
      axes%exchanged_rate = -sqrt(d13)*sqrt((i2 - i1)/i2/i1)
   end function constants_of

   !> Momenta into sorted axes, divided by a power of two near the largest component; the step times
   !> that power, over the scale of the moments. Lanes that stand still get a harmless momentum.
   pure subroutine scale_lanes(nvec, axes, h, y, start, too_long)
      integer, intent(in) :: nvec
      type(axes_block), intent(in) :: axes
      real(dp), intent(in) :: h(lanes), y(lanes, 3)
      type(start_type), intent(inout) :: start
      integer(i8), intent(out) :: too_long(lanes)
      integer(i8), parameter :: least = shiftl(30_i8, 52), greatest = shiftl(2040_i8, 52)
      integer(i8) :: big, e, eh, rest, far
      real(dp) :: down, half
      integer :: l, i1, i2, i3
      i1 = axes%order(1)
      i2 = axes%order(2)
      i3 = axes%order(3)
      !$omp simd private(big, e, eh, rest, far, down, half)
      do l = 1, group*nvec
         big = max(ibclr(transfer(y(l, 1), 0_i8), 63), ibclr(transfer(y(l, 2), 0_i8), 63))
         big = max(big, ibclr(transfer(y(l, 3), 0_i8), 63))
         e = min(max(iand(big, exponent_bits), least), greatest)
         start%unit(l) = axes%parity*transfer(e, down)
         down = axes%parity*transfer(top_exponent - e, down)
         eh = ibclr(transfer(h(l), 0_i8), 63)
         e = shiftr(e, 52) - shiftr(transfer(axes%scale(l), 0_i8), 52) ! of unit/scale
         rest = ior(shifta(big - least, 63), shifta(eh - 1_i8, 63)) ! no momentum, or no step
         far = shifta(longest_exponent - (shiftr(eh, 52) - 1023_i8 + e), 63)
         too_long(l) = iand(far, not(rest))
         rest = ior(far, rest)
         start%quiet(l) = rest
         start%y1(l) = choose(rest, 0.0_dp, y(l, i1)*down)
         start%y2(l) = choose(rest, 0.0_dp, y(l, i2)*down)
         start%y3(l) = choose(rest, 1.0_dp, y(l, i3)*down)
         half = transfer(shiftl(1023_i8 + shifta(e, 1), 52), half)
         down = transfer(shiftl(1023_i8 + (e - shifta(e, 1)), 52), down)
         start%tau(l) = (choose(rest, 0.0_dp, h(l))*half)*down
      end do
   end subroutine scale_lanes

   !> Exchange axes 1 and 3, a mirror, where c2 y1^2 > c1 y3^2, or both are equal and c1 < c2; then
   !> dn never changes its sign, and c1 > 0.
   pure subroutine order_axes(nvec, axes, start)
      integer, intent(in) :: nvec
      type(axes_block), intent(in) :: axes
      type(start_type), intent(inout) :: start
      real(dp) :: y1, y3, q1, q3, sgn
      integer(i8) :: mask, tie, equal
      integer :: l
      !$omp simd private(y1, y3, q1, q3, sgn, mask, tie, equal)
      do l = 1, group*nvec
         q1 = axes%c2(l)*(start%y1(l)*start%y1(l))
         q3 = axes%c1(l)*(start%y3(l)*start%y3(l))
         tie = below(axes%c1(l), axes%c2(l))
         equal = not(ior(below(q1, q3), below(q3, q1)))
         mask = ior(below(q3, q1), iand(tie, equal))
         start%exchanged(l) = mask
         sgn = choose(mask, -1.0_dp, 1.0_dp)
         y1 = sgn*choose(mask, start%y3(l), start%y1(l))
         y3 = sgn*choose(mask, start%y1(l), start%y3(l))
         start%y1(l) = y1
         start%y2(l) = sgn*start%y2(l)
         start%y3(l) = y3
         start%unit(l) = sgn*start%unit(l)
         start%c1(l) = choose(mask, axes%c2(l), axes%c1(l))
         start%c2(l) = choose(mask, axes%c1(l), axes%c2(l))
         start%m1(l) = choose(mask, axes%m3(l), axes%m1(l))
         start%m3(l) = choose(mask, axes%m1(l), axes%m3(l))
         start%kc2(l) = abs(q3 - q1)
      end do
   end subroutine order_axes

   !> Constants of the motion, parameters, increase of the phase.
   pure subroutine find_phase(nvec, axes, start, too_long)
      integer, intent(in) :: nvec
      type(axes_block), intent(in) :: axes
      type(start_type), intent(inout) :: start
      integer(i8), intent(inout) :: too_long(lanes)
      real(dp) :: y22, cb, inv, w
      integer(i8) :: far
      integer :: l
      !$omp simd private(y22, cb, inv, w, far)
      do l = 1, group*nvec
         y22 = start%y2(l)*start%y2(l)
         start%a(l) = start%y1(l)*start%y1(l) + start%c1(l)*y22
         start%b(l) = start%y3(l)*start%y3(l) + start%c2(l)*y22
         cb = start%c1(l)*start%b(l)
         inv = 1.0_dp/max(cb, tiny(1.0_dp))
         start%k2(l) = min((start%c2(l)*start%a(l))*inv, 1.0_dp)
         start%kc2(l) = choose(below(0.0_dp, cb), min(start%kc2(l)*inv, 1.0_dp), 1.0_dp)
         w = choose(start%exchanged(l), axes%exchanged_rate(l), axes%rate(l))
         w = sign(1.0_dp, start%y3(l))*w*sqrt(start%b(l))*start%tau(l)
         far = below(longest_phase, abs(w))
         start%w(l) = choose(far, 0.0_dp, w)
         too_long(l) = ior(too_long(l), far)
      end do
   end subroutine find_phase

   !> Signs of sn and cn after an odd number of half periods.
   pure subroutine unfold(nvec, turns, s, c, sf, cf)
      integer, intent(in) :: nvec
      real(dp), intent(in), dimension(lanes) :: turns, s, c
      real(dp), intent(out), dimension(lanes) :: sf, cf
      real(dp), parameter :: rounder = 6755399441055744.0_dp
      real(dp) :: half, odd
      integer :: l
      !$omp simd private(half, odd)
      do l = 1, group*nvec
         half = 0.5_dp*turns(l)
         odd = 1.0_dp - 4.0_dp*abs(half - ((half + rounder) - rounder))
         sf(l) = odd*s(l)
         cf(l) = odd*c(l)
      end do
   end subroutine unfold

   !> Addition theorem: sn, cn, dn at the end, and with them the momentum. Factors are scaled so
   !> that nothing vanishes next to the middle axis; the denominator drops out as (s1, c1) has
   !> length 1.
   pure subroutine move(nvec, start, sf, cf, d, finish)
      integer, intent(in) :: nvec
      type(start_type), intent(in) :: start
      real(dp), intent(in), dimension(lanes) :: sf, cf, d
      type(end_type), intent(inout) :: finish
      real(dp) :: ra, rb, rc, inv, s0, c0, d0, f, g, ns, nc, dn1, dn2
      integer(i8) :: some
      integer :: l
      !$omp simd private(ra, rb, rc, inv, s0, c0, d0, f, g, ns, nc, dn1, dn2, some)
      do l = 1, group*nvec
         ra = sqrt(start%a(l))
         rb = sqrt(start%b(l))
         rc = sqrt(start%c1(l))
         some = below(0.0_dp, ra)
         inv = 1.0_dp/max(ra, tiny(1.0_dp))
         s0 = choose(some, (start%y2(l)*rc)*inv, 0.0_dp)
         c0 = choose(some, start%y1(l)*inv, 1.0_dp)
         d0 = choose(below(0.0_dp, rb), abs(start%y3(l))/max(rb, tiny(1.0_dp)), 1.0_dp)
         f = scale_of(max(d0, abs(cf(l))))
         g = scale_of(max(d(l), abs(c0)))
         d0 = d0*f
         ns = (s0*(cf(l)*f))*(d(l)*g) + (sf(l)*(c0*g))*d0
         nc = (c0*g)*(cf(l)*f) - (s0*d0)*(sf(l)*(d(l)*g))
         inv = 1.0_dp/sqrt(ns*ns + nc*nc)
         ns = ns*inv
         nc = nc*inv
         dn1 = sqrt(start%kc2(l)*(ns*ns) + nc*nc)
         dn2 = sqrt(max(1.0_dp - start%k2(l)*(ns*ns), 0.0_dp))
         dn1 = choose(below(0.5_dp, start%k2(l)), dn1, dn2)
         finish%s0(l) = s0
         finish%s1(l) = ns
         finish%c1(l) = nc
         finish%d1(l) = dn1
         rc = ra/rc
         rb = sign(rb, start%y3(l))
         finish%v1(l) = ra*nc
         finish%v2(l) = rc*ns
         finish%v3(l) = rb*dn1
         finish%low1(l) = rest_of(ra, nc, finish%v1(l))
         finish%low2(l) = rest_of(rc, ns, finish%v2(l))
         finish%low3(l) = rest_of(rb, dn1, finish%v3(l))
      end do
   end subroutine move

   !> x y - product, exact to rounding, by splitting: no fused multiply-add is needed.
   elemental real(dp) function rest_of(x, y, product)
      real(dp), intent(in) :: x, y, product
      real(dp) :: xh, xl, yh, yl
      xh = transfer(iand(transfer(x, 0_i8), top26), xh)
      yh = transfer(iand(transfer(y, 0_i8), top26), yh)
      xl = x - xh
      yl = y - yh
      rest_of = ((xh*yh - product) + xh*yl + xl*yh) + xl*yl
   end function rest_of

   !> A power of two near 1/x, x > 0.
   elemental real(dp) function scale_of(x)
      real(dp), intent(in) :: x
      scale_of = transfer(top_exponent - iand(transfer(x, 0_i8), exponent_bits), x)
   end function scale_of

   !> The axis about which angles are counted: never near the momentum. Characteristic and factor.
   pure subroutine choose_pole(nvec, start, finish, too_long)
      integer, intent(in) :: nvec
      type(start_type), intent(in) :: start
      type(end_type), intent(inout) :: finish
      integer(i8), intent(inout) :: too_long(lanes)
      real(dp) :: nu, m, length, half
      integer(i8) :: mask, far
      integer :: l
      !$omp simd private(nu, m, length, half, mask, far)
      do l = 1, group*nvec
         mask = below(start%a(l), start%b(l))
         finish%pole1(l) = mask
         nu = choose(mask, start%a(l), start%c2(l))/choose(mask, start%b(l), start%c1(l))
         finish%nu(l) = nu
         finish%g(l) = sqrt(nu*(1.0_dp + nu)*(nu + start%k2(l)))
         m = choose(mask, start%m3(l), start%m1(l))
         finish%sgn(l) = sign(1.0_dp, start%y3(l))*choose(mask, 1.0_dp, -1.0_dp)
         length = sqrt(start%a(l) + start%b(l))
         half = (0.5_dp*length*m)*start%tau(l)
         far = below(longest_phase, abs(half))
         finish%half(l) = choose(far, 0.0_dp, half)
         too_long(l) = ior(too_long(l), far)
      end do
   end subroutine choose_pole

   !> The angle between the azimuths of both momenta and the arctangent of the addition theorem of
   !> the third kind, halved together: as a complex number.
   pure subroutine arctangents(nvec, start, sf, finish)
      integer, intent(in) :: nvec
      type(start_type), intent(in) :: start
      real(dp), intent(in) :: sf(lanes)
      type(end_type), intent(inout) :: finish
      real(dp) :: u1, u2, v1, v2, x, y, re, im, pr, pi, size
      integer(i8) :: mask
      integer :: l
      !$omp simd private(u1, u2, v1, v2, x, y, re, im, pr, pi, size, mask)
      do l = 1, group*nvec
         mask = finish%pole1(l)
         u1 = choose(mask, start%y2(l), start%y1(l))
         u2 = choose(mask, start%y3(l), start%y2(l))
         v1 = choose(mask, finish%v2(l), finish%v1(l))
         v2 = choose(mask, finish%v3(l), finish%v2(l))
         x = finish%nu(l)*(finish%s0(l)*(sf(l)*(finish%c1(l)*finish%d1(l))))
         x = 1.0_dp + (finish%nu(l)*(finish%s1(l)*finish%s1(l)) - x)
         y = finish%sgn(l)*(finish%g(l)*(finish%s0(l)*(sf(l)*finish%s1(l))))
         re = u1*v1 + u2*v2
         im = u2*v1 - u1*v2
         pr = re*x - im*y
         pi = re*y + im*x
         size = sqrt(pr*pr + pi*pi) + abs(pr)
         mask = shifta(transfer(pr, mask), 63)
         finish%re(l) = choose(mask, pi, size)
         finish%im(l) = choose(mask, size, pi)
      end do
   end subroutine arctangents

   !> The third kind over the rest of the phase.
   pure subroutine third_kind(nvec, start, s, c, d, turns, finish)
      integer, intent(in) :: nvec
      type(start_type), intent(in) :: start
      real(dp), intent(in), dimension(lanes) :: s, c, d, turns
      type(end_type), intent(inout) :: finish
      real(dp), dimension(lanes) :: x, y, p, g, series, re, im
      real(dp) :: sgn, excess, r
      integer :: l
      !$omp simd
      do l = 1, group*nvec
         x(l) = max(c(l)*c(l), tail_square)
         y(l) = max(d(l)*d(l), tail_square)
         p(l) = 1.0_dp + finish%nu(l)*(s(l)*s(l))
         g(l) = finish%g(l)*abs(s(l)*(s(l)*s(l)))
      end do
      call third_kind_block(x, y, p, g, series, re, im, nvec)
      !$omp simd private(sgn, excess, r)
      do l = 1, group*nvec
         sgn = finish%sgn(l)*sign(1.0_dp, s(l))
         excess = choose(below(0.5_dp, abs(turns(l))), 0.0_dp, max(abs(start%w(l)) - tail, 0.0_dp))
         r = g(l)*series(l)/6.0_dp + 0.5_dp*excess*(finish%g(l)/(1.0_dp + finish%nu(l)))
         finish%half(l) = finish%half(l) + sgn*r
         r = sgn*im(l)
         im(l) = finish%im(l)*re(l) + finish%re(l)*r
         finish%re(l) = finish%re(l)*re(l) - finish%im(l)*r
         finish%im(l) = im(l)
      end do
   end subroutine third_kind

   !> The complete integral, once for every half period. Whole turns that the arctangent loses are
   !> whole turns of half the angle.
   pure subroutine whole_turns(nvec, start, turns, finish)
      integer, intent(in) :: nvec
      type(start_type), intent(in) :: start
      real(dp), intent(in) :: turns(lanes)
      type(end_type), intent(inout) :: finish
      real(dp), dimension(lanes) :: x, y, p, series, re, im, angle
      integer :: l
      !$omp simd
      do l = 1, group*nvec
         x(l) = choose(below(0.5_dp, abs(turns(l))), 0.0_dp, 1.0_dp)
         y(l) = choose(below(0.5_dp, abs(turns(l))), max(start%kc2(l), tiny(1.0_dp)), 1.0_dp)
         p(l) = 1.0_dp + finish%nu(l)
      end do
      call third_kind_block(x, y, p, finish%g, series, re, im, nvec)
      call atan2_block(im, re, angle, nvec)
      !$omp simd
      do l = 1, group*nvec
         finish%half(l) = finish%half(l) + finish%sgn(l)*turns(l) &
            *(finish%g(l)*series(l)/3.0_dp + 2.0_dp*angle(l))
      end do
   end subroutine whole_turns

   !> The rotation of the step, rho0 >= 0: from the pole to the old momentum, the angle about it,
   !> and back from the new one.
   pure subroutine rotation(nvec, start, finish, rho)
      integer, intent(in) :: nvec
      type(start_type), intent(in) :: start
      type(end_type), intent(in) :: finish
      real(dp), intent(out) :: rho(lanes, 4)
      real(dp) :: s(lanes), c(lanes)
      real(dp) :: u1, u2, v1, v2, a, b, t0, t1, t2, t3, r0, r1, r2, r3, cs, sn
      integer(i8) :: mask
      integer :: l
      call sincos_block(finish%half, s, c, nvec)
      !$omp simd private(u1, u2, v1, v2, a, b, t0, t1, t2, t3, r0, r1, r2, r3, cs, sn, mask)
      do l = 1, group*nvec
         mask = finish%pole1(l)
         u1 = choose(mask, start%y2(l), start%y1(l))
         u2 = choose(mask, start%y3(l), start%y2(l))
         v1 = choose(mask, finish%v2(l), finish%v1(l))
         v2 = choose(mask, finish%v3(l), finish%v2(l))
         a = choose(mask, start%y1(l), start%y3(l))
         a = a + sqrt(a*a + (u1*u1 + u2*u2))
         b = choose(mask, finish%v1(l), finish%v3(l))
         b = b + sqrt(b*b + (v1*v1 + v2*v2))
         cs = c(l)*finish%re(l) - s(l)*finish%im(l)
         sn = s(l)*finish%re(l) + c(l)*finish%im(l)
         t0 = a*cs
         t1 = u1*sn - u2*cs
         t2 = u1*cs + u2*sn
         t3 = a*sn
         r0 = t0*b + (t2*v1 - t1*v2)
         r1 = b*t1 + (t0*v2 + t3*v1)
         r2 = b*t2 + (t3*v2 - t0*v1)
         r3 = b*t3 - (t1*v1 + t2*v2)
         a = sign(1.0_dp/sqrt((r0*r0 + r1*r1) + (r2*r2 + r3*r3)), r0)
         rho(l, 1) = r0*a
         rho(l, 2) = choose(mask, r3, r1)*a
         rho(l, 3) = choose(mask, r1, r2)*a
         rho(l, 4) = choose(mask, r2, r3)*a
      end do
   end subroutine rotation

   !> Back to the caller's axes and units: y(h) - y and q o (rho - 1). What the increment d of y
   !> would change of A and then of |y|^2 is taken off, in proportion to the components and before
   !> the new momentum is rounded: on a symmetric body the same rounding comes back every step.
   pure subroutine increments(nvec, axes, start, finish, rho, q, dy, dq)
      integer, intent(in) :: nvec
      type(axes_block), intent(in) :: axes
      type(start_type), intent(in) :: start
      type(end_type), intent(in) :: finish
      real(dp), intent(in) :: rho(lanes, 4), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      real(dp) :: v(lanes, 3), r0, sgn, d1, d2, d3, m1, m2, m3, k1, k2, k3, c1, f
      real(dp) :: unit
      integer(i8) :: mask, quiet
      integer :: l, i1, i2, i3
      i1 = axes%order(1)
      i2 = axes%order(2)
      i3 = axes%order(3)
      !$omp simd private(sgn, mask, quiet, d1, d2, d3, m1, m2, m3, k1, k2, k3, c1, f, &
      !$omp unit)
      do l = 1, group*nvec
         mask = start%exchanged(l)
         quiet = start%quiet(l)
         unit = start%unit(l)
         d1 = finish%v1(l) - start%y1(l)
         d2 = finish%v2(l) - start%y2(l)
         d3 = finish%v3(l) - start%y3(l)
         m1 = d1*(start%y1(l) + 0.5_dp*d1)
         m2 = d2*(start%y2(l) + 0.5_dp*d2)
         m3 = d3*(start%y3(l) + 0.5_dp*d3)
         k1 = finish%low1(l)
         k2 = finish%low2(l)
         k3 = finish%low3(l)
         c1 = start%c1(l)
         f = ((m1 + c1*m2) + (k1*finish%v1(l) + c1*(k2*finish%v2(l)))) &
            /max(start%a(l), tiny(1.0_dp))
         k1 = k1 - f*finish%v1(l)
         k2 = k2 - f*finish%v2(l)
         f = ((m1 + m2 + m3) + (k1*finish%v1(l) + k2*finish%v2(l) + k3*finish%v3(l))) &
            /(start%a(l) + start%b(l))
         d1 = d1 + (k1 - f*finish%v1(l))
         d2 = d2 + (k2 - f*finish%v2(l))
         d3 = d3 + (k3 - f*finish%v3(l))
         dy(l, i1) = choose(quiet, 0.0_dp, unit*choose(mask, d3, d1))
         dy(l, i2) = choose(quiet, 0.0_dp, unit*d2)
         dy(l, i3) = choose(quiet, 0.0_dp, unit*choose(mask, d1, d3))
         sgn = choose(quiet, 0.0_dp, sign(1.0_dp, unit))
         v(l, i1) = sgn*choose(mask, rho(l, 4), rho(l, 2))
         v(l, i2) = sgn*rho(l, 3)
         v(l, i3) = sgn*choose(mask, rho(l, 2), rho(l, 4))
      end do
      !$omp simd private(r0)
      do l = 1, group*nvec
         r0 = -(v(l, 1)*v(l, 1) + (v(l, 2)*v(l, 2) + v(l, 3)*v(l, 3)))/(1.0_dp + rho(l, 1))
         dq(l, 1) = q(l, 1)*r0 - (q(l, 2)*v(l, 1) + (q(l, 3)*v(l, 2) + q(l, 4)*v(l, 3)))
         dq(l, 2) = q(l, 2)*r0 + (q(l, 1)*v(l, 1) + (q(l, 3)*v(l, 3) - q(l, 4)*v(l, 2)))
         dq(l, 3) = q(l, 3)*r0 + (q(l, 1)*v(l, 2) + (q(l, 4)*v(l, 1) - q(l, 2)*v(l, 3)))
         dq(l, 4) = q(l, 4)*r0 + (q(l, 1)*v(l, 3) + (q(l, 2)*v(l, 2) - q(l, 3)*v(l, 1)))
      end do
   end subroutine increments

end module poinsot_free_jacobi_solution
