!> Elementary functions for block kernels: sine and cosine, arctangent, logarithm, exponential, tanh
!> and sech.
!>
!> The bits of a block kernel must not depend on how a compiler vectorises a loop (a vector
!> library's sine differs from the scalar one), so kernels call only these. Every procedure works on
!> all `lanes` elements, without branches and calls: the result of a lane depends on that lane
!> alone. The scalar forms pad a block, and so give the same bits. Errors within 1 ULP (atan2 2,
!> tanh and sech 3); no invalid, overflow or divide-by-zero exception on valid input. Not for NaN or
!> infinite arguments.
!>
!> The polynomials interpolate at Chebyshev nodes (60-digit arithmetic); arguments are reduced with
!> constants split so that every product is exact with or without fused multiply-add (W. J. Cody and
!> W. Waite, Software Manual for the Elementary Functions, 1980).
module poinsot_elliptic_elementary
   use poinsot_core_kinds, only: dp, i8, group, groups, lanes
   implicit none(type, external)
   private
   public :: sincos_block, sincos_pair_block, atan2_block, exp_block, log_block
   public :: exp_pair_block, tanh_sech_block
   public :: sincos_scalar, atan2_scalar, exp_scalar, log_scalar

   !> Adding and subtracting it rounds to an integer; in between, the low bits contain the integer.
   real(dp), parameter :: rounder = 6755399441055744.0_dp
   real(dp), parameter :: two52 = 4503599627370496.0_dp
   integer(i8), parameter :: two52_bits = 4841369599423283200_i8
   integer(i8), parameter :: fraction_bits = 4503599627370495_i8

   real(dp), parameter :: two_over_pi = 0.6366197723675814_dp
   real(dp), parameter :: p1 = 1.570796251296997_dp, p2 = 7.549789415861596e-08_dp
   real(dp), parameter :: p3 = 5.390302529957765e-15_dp, p4 = 3.2820035428735005e-22_dp

   real(dp), parameter :: s1 = -0.16666666666666666_dp, s2 = 0.008333333333330948_dp
   real(dp), parameter :: s3 = -0.00019841269836756774_dp, s4 = 2.7557316101617874e-06_dp
   real(dp), parameter :: s5 = -2.505113165023518e-08_dp, s6 = 1.5918115263265974e-10_dp

   real(dp), parameter :: c1 = 0.041666666666666664_dp, c2 = -0.0013888888888887398_dp
   real(dp), parameter :: c3 = 2.480158729876456e-05_dp, c4 = -2.7557317271145144e-07_dp
   real(dp), parameter :: c5 = 2.087614614655861e-09_dp, c6 = -1.1382623647474462e-11_dp

   real(dp), parameter :: log2e = 1.4426950408889634_dp
   real(dp), parameter :: ln2_hi = 0.6931471805601177_dp, ln2_lo = -1.7239444525614835e-13_dp

   real(dp), parameter :: e2 = 0.5_dp, e3 = 0.1666666666666667_dp, e4 = 0.04166666666666667_dp
   real(dp), parameter :: e5 = 0.008333333333326136_dp, e6 = 0.0013888888888883748_dp
   real(dp), parameter :: e7 = 0.00019841269874820627_dp, e8 = 2.4801587325547743e-05_dp
   real(dp), parameter :: e9 = 2.7557255400206422e-06_dp, e10 = 2.75572736431103e-07_dp
   real(dp), parameter :: e11 = 2.5105217004720745e-08_dp, e12 = 2.0914686968086876e-09_dp

   real(dp), parameter :: l1 = 0.6666666666666666_dp, l2 = 0.4000000000000088_dp
   real(dp), parameter :: l3 = 0.2857142857080323_dp, l4 = 0.2222222239180047_dp
   real(dp), parameter :: l5 = 0.18181795630884748_dp, l6 = 0.1538624020581371_dp
   real(dp), parameter :: l7 = 0.13268759668555402_dp, l8 = 0.13086767009995384_dp

   real(dp), parameter :: quarter_pi_hi = 0.7853981633974492_dp
   real(dp), parameter :: quarter_pi_lo = -8.575622497214414e-16_dp
   real(dp), parameter :: tan_pi_8 = 0.41421356237309503_dp
   real(dp), parameter :: a1 = -0.3333333333333333_dp, a2 = 0.19999999999995516_dp
   real(dp), parameter :: a3 = -0.14285714284665682_dp, a4 = 0.11111111015187018_dp
   real(dp), parameter :: a5 = -0.09090904575306488_dp, a6 = 0.07692183125376885_dp
   real(dp), parameter :: a7 = -0.06664510525508843_dp, a8 = 0.058581409048656254_dp
   real(dp), parameter :: a9 = -0.050854078345862384_dp, a10 = 0.039230447784709195_dp
   real(dp), parameter :: a11 = -0.01917540471101196_dp

contains

   !> Sine and cosine of each lane, within 1 ulp for |x| <= 1e9.
   pure subroutine sincos_block(x, s, c, nvec)
      real(dp), intent(in) :: x(lanes)  !! angles, radians, |x| <= 1e9
      real(dp), intent(out) :: s(lanes) !! their sines
      real(dp), intent(out) :: c(lanes) !! their cosines
      integer, intent(in), optional :: nvec !! groups of lanes to work on, instead of all
      real(dp) :: zero(lanes)
      zero = 0.0_dp
      call sincos_pair_block(x, zero, s, c, nvec)
   end subroutine sincos_block

   !> Sine and cosine of unevaluated sums, angles of more than double precision.
   pure subroutine sincos_pair_block(x, low, s, c, nvec)
      real(dp), intent(in) :: x(lanes)   !! angles, radians, |x| <= 1e9
      real(dp), intent(in) :: low(lanes) !! what to add to each, |low| at most about ulp(x)
      real(dp), intent(out) :: s(lanes)  !! sines of x + low
      real(dp), intent(out) :: c(lanes)  !! cosines of x + low
      integer, intent(in), optional :: nvec !! groups of lanes to work on, instead of all
      real(dp) :: t, n, r, a, b, rh, rl, z, ps, pc, hz, w, sn, cs
      integer(i8) :: quadrant
      integer :: i, used
      used = groups
      if (present(nvec)) used = nvec
      !$omp simd private(t, n, r, a, b, rh, rl, z, ps, pc, hz, w, sn, cs, quadrant)
      do i = 1, group*used
         t = x(i)*two_over_pi + rounder
         n = t - rounder
         quadrant = transfer(t, quadrant)
         r = (x(i) - n*p1) - n*p2      ! both exact
         a = n*p3                      ! exact; the difference r - a as a two-term sum
         rh = r - a
         b = rh - r
         rl = (r - (rh - b)) - (a + b) + (low(i) - n*p4)
         a = rh + rl
         rl = (rh - a) + rl
         rh = a

         z = rh*rh
         ps = s1 + z*(s2 + z*(s3 + z*(s4 + z*(s5 + z*s6))))
         hz = 0.5_dp*z
         sn = rh + (rh*z*ps + (rl - hz*rl))
         pc = c1 + z*(c2 + z*(c3 + z*(c4 + z*(c5 + z*c6))))
         w = 1.0_dp - hz
         cs = w + (((1.0_dp - w) - hz) + (z*z*pc - rh*rl))

         s(i) = merge(cs, sn, iand(quadrant, 1_i8) /= 0_i8)
         c(i) = merge(sn, cs, iand(quadrant, 1_i8) /= 0_i8)
         s(i) = merge(-s(i), s(i), iand(quadrant, 2_i8) /= 0_i8)
         c(i) = merge(-c(i), c(i), iand(quadrant + 1_i8, 2_i8) /= 0_i8)
      end do
   end subroutine sincos_pair_block

   !> Angle of the point (x, y), in [-pi, pi], with the sign of y; zero for the origin.
   pure subroutine atan2_block(y, x, angle, nvec)
      real(dp), intent(in) :: y(lanes)      !! ordinates, any scale
      real(dp), intent(in) :: x(lanes)      !! abscissas, any scale
      real(dp), intent(out) :: angle(lanes) !! radians
      integer, intent(in), optional :: nvec !! groups of lanes to work on, instead of all
      real(dp) :: big, small, num, den, t, w, p, k, sgn, scale
      logical :: steep, fold
      integer :: i, used
      used = groups
      if (present(nvec)) used = nvec
      !$omp simd private(big, small, num, den, t, w, p, k, sgn, scale, steep, fold)
      do i = 1, group*used
         steep = abs(y(i)) > abs(x(i))
         big = merge(abs(y(i)), abs(x(i)), steep)
         small = merge(abs(x(i)), abs(y(i)), steep)
         scale = merge(0.25_dp, 1.0_dp, big > 1.0e300_dp)
         big = merge(big*scale, 1.0_dp, big > 0.0_dp)
         small = small*scale
         fold = small > tan_pi_8*big
         num = merge(small - big, small, fold)
         den = merge(small + big, big, fold)
         t = num/den
         k = merge(1.0_dp, 0.0_dp, fold)             ! the angle is k pi/4 + sgn atan(t)
         sgn = merge(-1.0_dp, 1.0_dp, steep)
         k = merge(2.0_dp - k, k, steep)
         sgn = merge(-sgn, sgn, x(i) < 0.0_dp)
         k = merge(4.0_dp - k, k, x(i) < 0.0_dp)
         w = t*t
         p = a6 + w*(a7 + w*(a8 + w*(a9 + w*(a10 + w*a11))))
         p = a1 + w*(a2 + w*(a3 + w*(a4 + w*(a5 + w*p))))
         t = sgn*t
         p = k*quarter_pi_hi + (t + (t*w*p + k*quarter_pi_lo))
         angle(i) = sign(p, y(i))
      end do
   end subroutine atan2_block

   !> Exponential of each lane; 0 below -746, and x above 709.78 counts as 709.78.
   pure subroutine exp_block(x, r)
      real(dp), intent(in) :: x(lanes)  !! exponents
      real(dp), intent(out) :: r(lanes) !! e**x
      real(dp) :: a, t, n, hi, lo, z, p, half1, half2
      integer(i8) :: k
      integer :: i
      !$omp simd private(a, t, n, hi, lo, z, p, half1, half2, k)
      do i = 1, lanes
         a = min(max(x(i), -746.0_dp), 709.78_dp)
         t = a*log2e + rounder
         n = t - rounder
         hi = a - n*ln2_hi             ! exact
         lo = n*ln2_lo
         z = hi - lo
         lo = (hi - z) - lo
         p = e7 + z*(e8 + z*(e9 + z*(e10 + z*(e11 + z*e12))))
         p = e2 + z*(e3 + z*(e4 + z*(e5 + z*(e6 + z*p))))
         p = 1.0_dp + (z + (z*z*p + lo))
         t = 0.5_dp*n + rounder        ! 2**n in two factors: it may be subnormal
         k = transfer(t, k)
         half1 = transfer(shiftl(k + 1023_i8, 52), half1)
         t = (n - (t - rounder)) + rounder
         k = transfer(t, k)
         half2 = transfer(shiftl(k + 1023_i8, 52), half2)
         r(i) = p*half1*half2
      end do
   end subroutine exp_block

   !> Natural logarithm of each lane; smaller arguments count as the smallest positive double.
   pure subroutine log_block(x, r)
      real(dp), intent(in) :: x(lanes)  !! positive numbers, subnormal ones too
      real(dp), intent(out) :: r(lanes) !! their logarithms
      real(dp) :: a, shift, f, e, s, z, p, hz
      integer(i8) :: bits, exponent_bits
      integer(i8), parameter :: root_half = 4604544271217802189_i8
      integer(i8), parameter :: offset = 4607182418800017408_i8 - root_half
      integer :: i
      !$omp simd private(a, shift, f, e, s, z, p, hz, bits, exponent_bits)
      do i = 1, lanes
         shift = merge(-54.0_dp, 0.0_dp, x(i) < tiny(1.0_dp))
         a = x(i)*merge(18014398509481984.0_dp, 1.0_dp, x(i) < tiny(1.0_dp))
         a = max(a, tiny(1.0_dp))
         bits = transfer(a, bits) + offset
         exponent_bits = shiftr(bits, 52)
         e = transfer(ior(exponent_bits, two52_bits), e) - (two52 + 1023.0_dp) + shift
         bits = iand(bits, fraction_bits) + root_half
         f = transfer(bits, f) - 1.0_dp ! exact; 1 + f in [sqrt(1/2), sqrt(2))
         s = f/(2.0_dp + f)
         z = s*s
         p = z*(l1 + z*(l2 + z*(l3 + z*(l4 + z*(l5 + z*(l6 + z*(l7 + z*l8)))))))
         hz = 0.5_dp*f*f
         r(i) = e*ln2_hi - ((hz - (s*(hz + p) + e*ln2_lo)) - f)
      end do
   end subroutine log_block

   !> Exponential of unevaluated sums, and the same less 1, each with a small relative error.
   pure subroutine exp_pair_block(x, low, e, em1)
      real(dp), intent(in) :: x(lanes)    !! exponents, below -746 taken as that, above 700 as 700
      real(dp), intent(in) :: low(lanes)  !! what to add to each, |low| at most about ulp(x)
      real(dp), intent(out) :: e(lanes)   !! e**(x + low)
      real(dp), intent(out) :: em1(lanes) !! e**(x + low) - 1
      real(dp) :: a, t, n, hi, lo, z, p, half1, half2
      integer(i8) :: k
      integer :: i
      !$omp simd private(a, t, n, hi, lo, z, p, half1, half2, k)
      do i = 1, lanes
         a = min(max(x(i), -746.0_dp), 700.0_dp)
         t = a*log2e + rounder
         n = t - rounder
         hi = a - n*ln2_hi
         lo = n*ln2_lo - low(i)
         z = hi - lo
         lo = (hi - z) - lo
         p = e7 + z*(e8 + z*(e9 + z*(e10 + z*(e11 + z*e12))))
         p = e2 + z*(e3 + z*(e4 + z*(e5 + z*(e6 + z*p))))
         p = z + (z*z*p + lo)
         t = 0.5_dp*n + rounder
         k = transfer(t, k)
         half1 = transfer(shiftl(k + 1023_i8, 52), half1)
         t = (n - (t - rounder)) + rounder
         k = transfer(t, k)
         half2 = transfer(shiftl(k + 1023_i8, 52), half2)
         e(i) = (1.0_dp + p)*half1*half2
         em1(i) = p*half1*half2 + (half1*half2 - 1.0_dp)
      end do
   end subroutine exp_pair_block

   !> Hyperbolic tangent and secant of each lane, both with a small relative error.
   pure subroutine tanh_sech_block(x, t, s)
      real(dp), intent(in) :: x(lanes)  !! any finite numbers
      real(dp), intent(out) :: t(lanes) !! tanh x
      real(dp), intent(out) :: s(lanes) !! 1/cosh x
      real(dp) :: minus(lanes), zero(lanes), e(lanes), em1(lanes), d
      integer :: i
      minus = -abs(x)
      zero = 0.0_dp
      call exp_pair_block(minus, zero, e, em1)
      !$omp simd private(d)
      do i = 1, lanes
         d = 1.0_dp + e(i)*e(i)
         t(i) = sign(em1(i)*(2.0_dp + em1(i))/d, x(i))
         s(i) = 2.0_dp*e(i)/d
      end do
   end subroutine tanh_sech_block

   !> Sine and cosine of one angle: the bits of `sincos_block`.
   pure subroutine sincos_scalar(x, s, c)
      real(dp), intent(in) :: x  !! angle, radians, |x| <= 1e9
      real(dp), intent(out) :: s !! its sine
      real(dp), intent(out) :: c !! its cosine
      real(dp) :: xs(lanes), ss(lanes), cs(lanes)
      xs = x
      call sincos_block(xs, ss, cs, 1)
      s = ss(1)
      c = cs(1)
   end subroutine sincos_scalar

   !> Angle of one point: the bits of `atan2_block`.
   pure real(dp) function atan2_scalar(y, x) result(angle)
      real(dp), intent(in) :: y !! ordinate
      real(dp), intent(in) :: x !! abscissa
      real(dp) :: xs(lanes), ys(lanes), angles(lanes)
      xs = x
      ys = y
      call atan2_block(ys, xs, angles, 1)
      angle = angles(1)
   end function atan2_scalar

   !> Exponential of one number: the bits of `exp_block`.
   pure real(dp) function exp_scalar(x) result(r)
      real(dp), intent(in) :: x !! exponent
      real(dp) :: xs(lanes), rs(lanes)
      xs = x
      call exp_block(xs, rs)
      r = rs(1)
   end function exp_scalar

   !> Logarithm of one number: the bits of `log_block`.
   pure real(dp) function log_scalar(x) result(r)
      real(dp), intent(in) :: x !! positive number
      real(dp) :: xs(lanes), rs(lanes)
      xs = x
      call log_block(xs, rs)
      r = rs(1)
   end function log_scalar

end module poinsot_elliptic_elementary
