!> Jacobi's elliptic functions for one block of lanes: any argument, any parameter.
!>
!> Theta functions of the smaller of m and m1 = 1 - m, so of a nome q <= exp(-pi): the circular ones
!> for m <= 1/2, otherwise the hyperbolic ones (Jacobi's imaginary transformation). Four terms
!> suffice for double precision, and nothing degenerates as m -> 1: the complementary parameter
!> itself is the input there. The nome comes from the first two steps of the arithmetic-geometric
!> mean of (1, sqrt(1 - mu)) and its series (Abramowitz and Stegun 17.3.21; 16.27 for the theta
!> functions, 16.20 for the transformation). The period has a relative error of about 1e-19, and the
!> argument is reduced in double-double arithmetic, so that at |u| = 1e6 only the rounding error of
!> u itself matters. Products are made exact by splitting: no fused multiply-add is needed.
module poinsot_elliptic_jacobi_kernel
   use poinsot_core_constants, only: exponent_bits
   use poinsot_core_kinds, only: dp, i8, group, groups, lanes
   implicit none(type, external)
   private
   public :: jacobi_block

   integer(i8), parameter :: fraction_bits = 4503599627370495_i8
   integer(i8), parameter :: two_exponents = 9214364837600034816_i8
   integer(i8), parameter :: two52_bits = 4841369599423283200_i8
   integer(i8), parameter :: root_half = 4604544271217802189_i8
   integer(i8), parameter :: offset = 4607182418800017408_i8 - root_half
   integer(i8), parameter :: top26 = not(134217727_i8)  !! keeps 26 significant bits
   integer(i8), parameter :: top22 = not(2147483647_i8) !! keeps 22
   real(dp), parameter :: two52 = 4503599627370496.0_dp, rounder = 6755399441055744.0_dp
   real(dp), parameter :: two64 = 18446744073709551616.0_dp
   real(dp), parameter :: log2e = 1.4426950408889634_dp
   real(dp), parameter :: ln2_hi = 0.6931471805601177_dp, ln2_lo = -1.7239444525614835e-13_dp
   real(dp), parameter :: pi_hi = 3.141592653589793_dp, pi_lo = 1.2246467991473532e-16_dp
   real(dp), parameter :: endless = 1.0e300_dp !! period for m = 1, beyond every argument

   ! sine, cosine and exponential as in poinsot_elliptic_elementary, in line: arguments are small
   real(dp), parameter :: s1 = -0.16666666666666666_dp, s2 = 0.008333333333330948_dp
   real(dp), parameter :: s3 = -0.00019841269836756774_dp, s4 = 2.7557316101617874e-06_dp
   real(dp), parameter :: s5 = -2.505113165023518e-08_dp, s6 = 1.5918115263265974e-10_dp
   real(dp), parameter :: c1 = 0.041666666666666664_dp, c2 = -0.0013888888888887398_dp
   real(dp), parameter :: c3 = 2.480158729876456e-05_dp, c4 = -2.7557317271145144e-07_dp
   real(dp), parameter :: c5 = 2.087614614655861e-09_dp, c6 = -1.1382623647474462e-11_dp
   real(dp), parameter :: e2 = 0.5_dp, e3 = 0.1666666666666667_dp, e4 = 0.04166666666666667_dp
   real(dp), parameter :: e5 = 0.008333333333326136_dp, e6 = 0.0013888888888883748_dp
   real(dp), parameter :: e7 = 0.00019841269874820627_dp, e8 = 2.4801587325547743e-05_dp
   real(dp), parameter :: e9 = 2.7557255400206422e-06_dp, e10 = 2.75572736431103e-07_dp
   real(dp), parameter :: e11 = 2.5105217004720745e-08_dp, e12 = 2.0914686968086876e-09_dp

contains

   !> sn, cn, dn of the argument less its whole turns: for odd turns sn and cn of u have the other
   !> signs.
   pure subroutine jacobi_block(u, m, m1, sn, cn, dn, turns, nvec)
      real(dp), intent(in) :: u(lanes)       !! arguments, |u| <= 1e9 (full accuracy to 4e6 turns)
      real(dp), intent(in) :: m(lanes)       !! parameters, in [0, 1]
      real(dp), intent(in) :: m1(lanes)      !! 1 - m; only the smaller of m and m1 is used
      real(dp), intent(out) :: sn(lanes)     !! sn(u - 2 K turns | m)
      real(dp), intent(out) :: cn(lanes)     !! cn(u - 2 K turns | m), not negative but for rounding
      real(dp), intent(out) :: dn(lanes)     !! dn(u | m)
      real(dp), intent(out) :: turns(lanes)  !! nearest integer to u/(2 K), as a real
      integer, intent(in), optional :: nvec  !! groups of lanes to work on, instead of all
      real(dp), dimension(lanes) :: mu, side, q, q_low, z, z_low, period, period_low
      real(dp), dimension(lanes) :: kc, kc_low, r, r_low, a, a_low, d, d_low, s, c, e, em1
      real(dp), dimension(lanes) :: s_far, c_far, d_far, far, s_near, c_near, d_near, near
      integer :: used, n
      used = groups
      if (present(nvec)) used = nvec
      n = group*used
      mu(:n) = min(m(:n), m1(:n))
      side(:n) = m1(:n) - m(:n) ! negative: near m = 1
      call find_roots(used, mu, kc, kc_low, r, r_low)
      call find_means(used, kc, kc_low, r, r_low, a, a_low, d, d_low)
      call find_nome(used, mu, d, d_low, q, q_low)
      call find_phase(used, u, q, a, a_low, z, z_low)
      call log_period(used, q, q_low, period, period_low)
      call reduce(used, side, period, period_low, z, z_low, turns)
      call phase_sincos(used, z, z_low, s, c)
      call circular_sums(used, q, s, c, s_far, c_far, d_far, far)
      call phase_exp(used, z, z_low, e, em1)
      call hyperbolic_sums(used, q, z, e, em1, s_near, c_near, d_near, near)
      call quotients(used, side, q, s_far, c_far, d_far, far, s_near, c_near, d_near, near, &
         sn, cn, dn)
   end subroutine jacobi_block

   !> kc = sqrt(1 - mu) and r = sqrt(kc), double-double.
   pure subroutine find_roots(nvec, mu, kc, kc_low, r, r_low)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: mu(lanes)
      real(dp), intent(out), dimension(lanes) :: kc, kc_low, r, r_low
      real(dp) :: m1, ah, al, w
      integer :: i
      !$omp simd private(m1, ah, al, w)
      do i = 1, group*nvec
         m1 = 1.0_dp - mu(i)
         kc(i) = sqrt(m1)
         ah = transfer(iand(transfer(kc(i), 0_i8), top26), ah)
         al = kc(i) - ah
         w = (((m1 - ah*ah) - 2.0_dp*(ah*al)) - al*al) + ((1.0_dp - m1) - mu(i))
         kc_low(i) = w*(0.50139_dp + mu(i)*(0.20135_dp + mu(i)*0.41002_dp)) ! about 1/(2 kc(i))
         r(i) = sqrt(kc(i))
         ah = transfer(iand(transfer(r(i), 0_i8), top26), ah)
         al = r(i) - ah
         w = (((kc(i) - ah*ah) - 2.0_dp*(ah*al)) - al*al) + kc_low(i)
         r_low(i) = w*(0.50049_dp + mu(i)*(0.10786_dp + mu(i)*0.15733_dp)) ! about 1/(2 r(i))
      end do
   end subroutine find_roots

   !> Two steps of the mean of 1 and kc, a = ((1 + r)/2)**2, and d = (1 + kc) a, double-double.
   pure subroutine find_means(nvec, kc, kc_low, r, r_low, a, a_low, d, d_low)
      integer, intent(in) :: nvec
      real(dp), intent(in), dimension(lanes) :: kc, kc_low, r, r_low
      real(dp), intent(out), dimension(lanes) :: a, a_low, d, d_low
      real(dp) :: b, b_low, ah, al, bh, bl
      integer :: i
      !$omp simd private(b, b_low, ah, al, bh, bl)
      do i = 1, group*nvec
         b = 0.5_dp*(1.0_dp + r(i))
         b_low = ((0.5_dp - b) + 0.5_dp*r(i)) + 0.5_dp*r_low(i)
         a(i) = b*b
         bh = transfer(iand(transfer(b, 0_i8), top26), bh)
         bl = b - bh
         a_low(i) = ((bh*bh - a(i)) + 2.0_dp*(bh*bl)) + (bl*bl + 2.0_dp*(b*b_low))

         b = 1.0_dp + kc(i)
         b_low = ((1.0_dp - b) + kc(i)) + kc_low(i)
         d(i) = a(i)*b
         ah = transfer(iand(transfer(a(i), 0_i8), top26), ah)
         al = a(i) - ah
         bh = transfer(iand(transfer(b, 0_i8), top26), bh)
         bl = b - bh
         d_low(i) = (((ah*bh - d(i)) + ah*bl + al*bh) + al*bl) + (a(i)*b_low + a_low(i)*b)
      end do
   end subroutine find_means

   !> Nome of mu, double-double.
   pure subroutine find_nome(nvec, mu, d, d_low, q, q_low)
      integer, intent(in) :: nvec
      real(dp), intent(in), dimension(lanes) :: mu, d, d_low
      real(dp), intent(out), dimension(lanes) :: q, q_low
      real(dp) :: inv, e, e4, w, ah, al, bh, bl
      integer :: i
      !$omp simd private(inv, e, e4, w, ah, al, bh, bl)
      do i = 1, group*nvec
         inv = 1.0_dp/d(i)                             ! e = mu/(8 d(i)) = (1 - r)/(2 (1 + r))
         e = mu(i)*inv
         ah = transfer(iand(transfer(e, 0_i8), top26), ah)
         al = e - ah
         bh = transfer(iand(transfer(d(i), 0_i8), top26), bh)
         bl = d(i) - bh
         w = (((mu(i) - ah*bh) - ah*bl) - al*bh) - al*bl
         w = 0.125_dp*((w - e*d_low(i))*inv)
         e = 0.125_dp*e
         e4 = (e*e)*(e*e)
         w = w + e*(e4*(2.0_dp + e4*(15.0_dp + e4*150.0_dp)))
         q(i) = e + w
         q_low(i) = (e - q(i)) + w
      end do
   end subroutine find_nome

   !> The phase z = u/theta3(q)**2 = u agm(1, kc), where agm(1, kc) = a/theta3(q**4)**2,
   !> double-double.
   pure subroutine find_phase(nvec, u, q, a, a_low, z, z_low)
      integer, intent(in) :: nvec
      real(dp), intent(in), dimension(lanes) :: u, q, a, a_low
      real(dp), intent(out), dimension(lanes) :: z, z_low
      real(dp) :: e4, w, b, b_low, ah, al, bh, bl
      integer :: i
      !$omp simd private(e4, w, b, b_low, ah, al, bh, bl)
      do i = 1, group*nvec
         e4 = (q(i)*q(i))*(q(i)*q(i))
         w = -4.0_dp*(a(i)*e4)*(1.0_dp - e4*(3.0_dp - e4*8.0_dp)) + a_low(i)
         b = a(i) + w
         b_low = (a(i) - b) + w
         z(i) = u(i)*b
         ah = transfer(iand(transfer(u(i), 0_i8), top26), ah)
         al = u(i) - ah
         bh = transfer(iand(transfer(b, 0_i8), top26), bh)
         bl = b - bh
         z_low(i) = (((ah*bh - z(i)) + ah*bl + al*bh) + al*bl) + u(i)*b_low
      end do
   end subroutine find_phase

   !> -log(q), the period of the hyperbolic phase, as an unevaluated sum; `endless` for q = 0.
   pure subroutine log_period(nvec, q, q_low, period, period_low)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: q(lanes), q_low(lanes)
      real(dp), intent(out) :: period(lanes), period_low(lanes)
      real(dp) :: x, shift, scale, e, f, den, s, s_low, w, p, t
      integer(i8) :: bits
      integer :: i
      !$omp simd private(x, shift, scale, e, f, den, s, s_low, w, p, t, bits)
      do i = 1, group*nvec
         shift = merge(64.0_dp, 0.0_dp, q(i) < 1.0e-280_dp)
         scale = 1.0_dp + shift*(two64/64.0_dp)     ! 1 or 2**64
         x = max(q(i)*scale, tiny(1.0_dp))
         bits = transfer(x, bits) + offset
         x = q_low(i)*scale*transfer(two_exponents - iand(bits, exponent_bits), x)
         e = transfer(ior(shiftr(bits, 52), two52_bits), e) - (two52 + 1023.0_dp) - shift
         bits = iand(bits, fraction_bits) + root_half
         f = transfer(bits, f) - 1.0_dp             ! log(1 + f) = 2 atanh(s), s = f/(2 + f)
         den = 2.0_dp + f
         s = f/den
         s_low = (0.5_dp*s)*((den - 2.0_dp) - f)*(1.0_dp - s)
         w = s*s
         p = 0.18181795630884748_dp + w*(0.1538624020581371_dp + w*(0.13268759668555402_dp &
            + w*0.13086767009995384_dp))
         p = w*(0.6666666666666666_dp + w*(0.4000000000000088_dp + w*(0.2857142857080323_dp &
            + w*(0.2222222239180047_dp + w*p))))
         t = e*ln2_hi                               ! exact
         w = t + 2.0_dp*s
         p = ((t - w) + 2.0_dp*s) + (((e*ln2_lo + 2.0_dp*s_low) + s*p) &
            + x*(1.0_dp - 2.0_dp*s*(1.0_dp - s*(1.0_dp - s))))
         t = w + p
         p = (w - t) + p
         period(i) = merge(0.0_dp, endless, q(i) > 0.0_dp) - t
         period_low(i) = -p
      end do
   end subroutine log_period

   !> Subtract whole periods from the phase, which stays an unevaluated sum.
   pure subroutine reduce(nvec, side, period, period_low, z, z_low, turns)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: side(lanes), period(lanes), period_low(lanes)
      real(dp), intent(inout) :: z(lanes), z_low(lanes)
      real(dp), intent(out) :: turns(lanes)
      real(dp) :: n, hi, lo, r, a, b, w, p, p_low
      integer(i8) :: mask
      integer :: i
      !$omp simd private(n, hi, lo, r, a, b, w, p, p_low, mask)
      do i = 1, group*nvec
         mask = shifta(transfer(side(i), mask), 63)
         p = choose(mask, period(i), pi_hi)
         p_low = choose(mask, period_low(i), pi_lo)
         n = (z(i)/p + rounder) - rounder
         hi = transfer(iand(transfer(p, 0_i8), top22), hi)
         lo = n*(p - hi)                            ! exact for |n| <= 2**22
         r = z(i) - n*hi                            ! exact
         a = r - lo
         b = a - r
         w = ((r - (a - b)) - (lo + b)) + (z_low(i) - n*p_low)
         z(i) = a + w
         z_low(i) = (a - z(i)) + w
         turns(i) = n
      end do
   end subroutine reduce

   !> Sine and cosine of the reduced phase, from those of its half (at most pi/4).
   pure subroutine phase_sincos(nvec, z, z_low, s, c)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: z(lanes), z_low(lanes)
      real(dp), intent(out) :: s(lanes), c(lanes)
      real(dp) :: x, y, ps, pc, sn, cs
      integer :: i
      !$omp simd private(x, y, ps, pc, sn, cs)
      do i = 1, group*nvec
         x = 0.5_dp*min(max(z(i), -1.6_dp), 1.6_dp) ! bites near m = 1 only, where this is not used
         y = x*x
         ps = s1 + y*(s2 + y*(s3 + y*(s4 + y*(s5 + y*s6))))
         pc = c1 + y*(c2 + y*(c3 + y*(c4 + y*(c5 + y*c6))))
         sn = x + x*(y*ps)
         cs = 1.0_dp - (0.5_dp*y - y*y*pc)
         x = 1.0_dp - 2.0_dp*(sn*sn)
         y = 2.0_dp*(sn*cs)
         s(i) = y + x*z_low(i)
         c(i) = x - y*z_low(i)
      end do
   end subroutine phase_sincos

   !> Numerators of sn, cn, dn from theta1, theta2, theta3 of the phase, and what divides them.
   pure subroutine circular_sums(nvec, q, s, c, s_part, c_part, d_part, divisor)
      integer, intent(in) :: nvec
      real(dp), intent(in), dimension(lanes) :: q, s, c
      real(dp), intent(out), dimension(lanes) :: s_part, c_part, d_part, divisor
      real(dp) :: q2, q4, q6, y, cos2, cos4, even, odd, theta2, theta4, w
      integer :: i
      !$omp simd private(q2, q4, q6, y, cos2, cos4, even, odd, theta2, theta4, w)
      do i = 1, group*nvec
         q2 = q(i)*q(i)
         q4 = q2*q2
         q6 = q4*q2
         theta2 = 1.0_dp + (q2 + q6)
         theta4 = 1.0_dp - 2.0_dp*q(i)*(1.0_dp - q(i)*(q2 - q6*q(i)))
         y = s(i)*s(i)
         cos2 = 1.0_dp - 2.0_dp*y
         cos4 = 2.0_dp*cos2*cos2 - 1.0_dp
         even = 1.0_dp + 2.0_dp*q4*cos4
         odd = 2.0_dp*q(i)*cos2*(1.0_dp + q4*q4*(2.0_dp*cos4 - 1.0_dp))
         d_part(i) = (theta4*theta2)*(even + odd)
         divisor(i) = theta2*(even - odd)
         w = q6*(5.0_dp - y*(20.0_dp - 16.0_dp*y)) - q2*(3.0_dp - 4.0_dp*y)
         s_part(i) = s(i) + s(i)*w
         w = q6*(1.0_dp - y*(12.0_dp - 16.0_dp*y)) + q2*(1.0_dp - 4.0_dp*y)
         c_part(i) = theta4*(c(i) + c(i)*w)
      end do
   end subroutine circular_sums

   !> exp(-|z|), and the same less 1.
   pure subroutine phase_exp(nvec, z, z_low, e, em1)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: z(lanes), z_low(lanes)
      real(dp), intent(out) :: e(lanes), em1(lanes)
      real(dp) :: x, t, n, hi, lo, p, power
      integer(i8) :: bits
      integer :: i
      !$omp simd private(x, t, n, hi, lo, p, power, bits)
      do i = 1, group*nvec
         x = max(-abs(z(i)), -700.0_dp)
         t = x*log2e + rounder
         n = t - rounder
         bits = transfer(t, bits)
         power = transfer(shiftl(bits + 1023_i8, 52), power)
         hi = x - n*ln2_hi
         lo = n*ln2_lo + sign(1.0_dp, z(i))*z_low(i)
         x = hi - lo
         lo = (hi - x) - lo
         p = e7 + x*(e8 + x*(e9 + x*(e10 + x*(e11 + x*e12))))
         p = e2 + x*(e3 + x*(e4 + x*(e5 + x*(e6 + x*p))))
         p = power*(x + (x*x*p + lo))
         e(i) = power + p
         em1(i) = (power - 1.0_dp) + p
      end do
   end subroutine phase_exp

   !> The same sums near m = 1, where the phase is imaginary.
   pure subroutine hyperbolic_sums(nvec, q, z, e, em1, s_part, c_part, d_part, divisor)
      integer, intent(in) :: nvec
      real(dp), intent(in), dimension(lanes) :: q, z, e, em1
      real(dp), intent(out), dimension(lanes) :: s_part, c_part, d_part, divisor
      real(dp) :: q2, q4, cosh2, a, even, odd, theta2, theta4, w
      integer :: i
      !$omp simd private(q2, q4, cosh2, a, even, odd, theta2, theta4, w)
      do i = 1, group*nvec
         q2 = q(i)*q(i)
         q4 = q2*q2
         theta2 = 2.0_dp*e(i)*(1.0_dp + (q2 + q2*q4))
         theta4 = 1.0_dp - 2.0_dp*q(i)*(1.0_dp - q(i)*(q2 - q4*q2*q(i)))
         w = e(i)*e(i)
         cosh2 = q(i)/max(w, 1.0e-307_dp) + q(i)*w  ! 2 q cosh(2 z), at most about 1
         a = cosh2*cosh2
         even = 1.0_dp - q2 + (a - q2)*(q4 - q4*q4*q2)
         odd = q(i)*cosh2*(1.0_dp - q4 + q4*q4*(a - 2.0_dp*q2))
         divisor(i) = theta4*((1.0_dp + w)*(even + odd))
         s_part(i) = sign(em1(i)*(2.0_dp + em1(i)), z(i))*(even - odd)
         even = 1.0_dp + q2*(a - 2.0_dp*q2)
         odd = cosh2 + cosh2*(q4*q2*(a - 3.0_dp*q2))
         c_part(i) = theta2*(even - odd)
         d_part(i) = (theta2*theta4)*(even + odd)
      end do
   end subroutine hyperbolic_sums

   !> sn, cn, dn from the sums of the right side.
   pure subroutine quotients(nvec, side, q, s_far, c_far, d_far, far, s_near, c_near, d_near, &
      near, sn, cn, dn)
      integer, intent(in) :: nvec
      real(dp), intent(in), dimension(lanes) :: side, q, s_far, c_far, d_far, far
      real(dp), intent(in), dimension(lanes) :: s_near, c_near, d_near, near
      real(dp), intent(out), dimension(lanes) :: sn, cn, dn
      real(dp) :: theta3, q2, r
      integer(i8) :: mask
      integer :: i
      !$omp simd private(theta3, q2, r, mask)
      do i = 1, group*nvec
         mask = shifta(transfer(side(i), mask), 63)
         q2 = q(i)*q(i)
         theta3 = 1.0_dp + 2.0_dp*q(i)*(1.0_dp + q2*q(i)*(1.0_dp + q2*q2*q(i)))
         r = 1.0_dp/(choose(mask, near(i), far(i))*theta3)
         sn(i) = choose(mask, s_near(i), s_far(i))*(theta3*(theta3*r))
         cn(i) = choose(mask, c_near(i), c_far(i))*(theta3*r)
         dn(i) = choose(mask, d_near(i), d_far(i))*r
      end do
   end subroutine quotients

   include "../core/choose.inc"

end module poinsot_elliptic_jacobi_kernel
