!> Legendre's incomplete elliptic integrals F, E, Pi, of the amplitude or of its sine.
!>
!> Sums of positive terms in Carlson's integrals (DLMF 19.25(i)): no cancellation for any amplitude
!> and any m in [0, 1]. Beyond a quarter turn, whole half periods are added. Arguments outside the
!> domain, infinite or NaN give NaN. Every function also accepts m1 = 1 - m, for m so close to 1
!> that m alone is not accurate enough.
module poinsot_elliptic_legendre
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use poinsot_core_constants, only: pi
   use poinsot_core_kinds, only: dp
   use poinsot_core_libm, only: arctangent, cosine, sine
   use poinsot_elliptic_carlson, only: carlson_rd, carlson_rf, carlson_rj
   use poinsot_elliptic_complete, only: complete_e, complete_k, complete_parameter, complete_pi, &
      parameter_of
   implicit none(type, external)
   private
   public :: legendre_f, legendre_e, legendre_pi
   public :: legendre_f_sine, legendre_e_sine, legendre_pi_sine
   public :: inverse_sn, inverse_cn, inverse_dn

   real(dp), parameter :: largest = 1.0e15_dp !! amplitudes beyond it have no phase left

contains

   !> F(phi, m) = integral of dt/sqrt(1 - m sin(t)**2) from 0 to phi.
   elemental real(dp) function legendre_f(phi, m, m1) result(r)
      real(dp), intent(in) :: phi          !! amplitude, radians, |phi| <= 1e15; < pi/2 if m = 1
      real(dp), intent(in) :: m            !! parameter, in [0, 1]
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it
      real(dp) :: s, c, turns, b
      call reduce(phi, m, m1, s, c, turns, b, r)
      if (.not. ieee_is_finite(r)) return
      r = f_part(s, c, b)
      if (abs(turns) > 0.0_dp) r = r + turns*(2.0_dp*complete_k(m, m1))
   end function legendre_f

   !> E(phi, m) = integral of sqrt(1 - m sin(t)**2) from 0 to phi.
   elemental real(dp) function legendre_e(phi, m, m1) result(r)
      real(dp), intent(in) :: phi          !! amplitude, radians, |phi| <= 1e15
      real(dp), intent(in) :: m            !! parameter, in [0, 1]
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it
      real(dp) :: s, c, turns, b
      call reduce(phi, m, m1, s, c, turns, b, r)
      if (.not. ieee_is_finite(r)) return
      r = e_part(s, c, parameter_of(m, b), b)
      if (abs(turns) > 0.0_dp) r = r + turns*(2.0_dp*complete_e(m, m1))
   end function legendre_e

   !> Pi(n; phi, m) = integral of dt/((1 - n sin(t)**2) sqrt(1 - m sin(t)**2)) from 0 to phi.
   elemental real(dp) function legendre_pi(n, phi, m, m1) result(r)
      real(dp), intent(in) :: n            !! characteristic, n sin(phi)**2 < 1; < 1 beyond pi/2
      real(dp), intent(in) :: phi          !! amplitude, radians, |phi| <= 1e15; < pi/2 if m = 1
      real(dp), intent(in) :: m            !! parameter, in [0, 1]
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it
      real(dp) :: s, c, turns, b
      call reduce(phi, m, m1, s, c, turns, b, r)
      if (.not. ieee_is_finite(r)) return
      r = pi_part(n, s, c, parameter_of(m, b), b)
      if (abs(turns) > 0.0_dp) r = r + turns*(2.0_dp*complete_pi(n, m, m1))
   end function legendre_pi

   !> F of the amplitude whose sine is given.
   elemental real(dp) function legendre_f_sine(s, m, m1) result(r)
      real(dp), intent(in) :: s            !! sine of the amplitude, in [-1, 1]; not +-1 if m = 1
      real(dp), intent(in) :: m            !! parameter, in [0, 1]
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it
      real(dp) :: c, b
      call cosine_of(s, m, m1, c, b, r)
      if (ieee_is_finite(r)) r = f_part(s, c, b)
   end function legendre_f_sine

   !> E of the amplitude whose sine is given.
   elemental real(dp) function legendre_e_sine(s, m, m1) result(r)
      real(dp), intent(in) :: s            !! sine of the amplitude, in [-1, 1]
      real(dp), intent(in) :: m            !! parameter, in [0, 1]
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it
      real(dp) :: c, b
      call cosine_of(s, m, m1, c, b, r)
      if (ieee_is_finite(r)) r = e_part(s, c, parameter_of(m, b), b)
   end function legendre_e_sine

   !> Pi of the amplitude whose sine is given.
   elemental real(dp) function legendre_pi_sine(n, s, m, m1) result(r)
      real(dp), intent(in) :: n            !! characteristic, n s**2 < 1
      real(dp), intent(in) :: s            !! sine of the amplitude, in [-1, 1]; not +-1 if m = 1
      real(dp), intent(in) :: m            !! parameter, in [0, 1]
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it
      real(dp) :: c, b
      call cosine_of(s, m, m1, c, b, r)
      if (.not. ieee_is_finite(r)) return
      if (abs(s) < 1.0_dp) then
         r = pi_part(n, s, c, parameter_of(m, b), b)
      else
         r = s*complete_pi(n, m, m1)
      end if
   end function legendre_pi_sine

   !> The u in [-K, K] with sn(u, m) = x.
   elemental real(dp) function inverse_sn(x, m, m1) result(u)
      real(dp), intent(in) :: x            !! in [-1, 1]
      real(dp), intent(in) :: m            !! parameter, in [0, 1]
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it
      u = legendre_f_sine(x, m, m1)
   end function inverse_sn

   !> The u in [0, 2 K] with cn(u, m) = x (DLMF 22.15).
   elemental real(dp) function inverse_cn(x, m, m1) result(u)
      real(dp), intent(in) :: x            !! in [-1, 1]; > 0 if m = 1
      real(dp), intent(in) :: m            !! parameter, in [0, 1]
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it
      real(dp) :: c, b
      call cosine_of(x, m, m1, c, b, u)
      if (.not. ieee_is_finite(u)) return
      u = f_part(c, abs(x), b)
      if (x < 0.0_dp) u = 2.0_dp*complete_k(m, m1) - u
   end function inverse_cn

   !> The u in [0, K] with dn(u, m) = x.
   elemental real(dp) function inverse_dn(x, m, m1) result(u)
      real(dp), intent(in) :: x            !! in [sqrt(1 - m), 1]
      real(dp), intent(in) :: m            !! parameter, in (0, 1]
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it
      real(dp) :: b, y, w
      b = complete_parameter(m, m1)
      u = b
      if (.not. ieee_is_finite(b)) return
      u = ieee_value(u, ieee_quiet_nan)
      if (.not. ieee_is_finite(x)) return
      y = sqrt(b)
      w = (x - y)*(x + y)
      if (x > 1.0_dp .or. w < 0.0_dp .or. x <= 0.0_dp .or. m <= 0.0_dp) return
      u = sqrt((1.0_dp - x)*(1.0_dp + x)/m)*carlson_rf(w/m, x*x, 1.0_dp)
   end function inverse_dn

   !> Sine, cosine (not negative) and whole half turns of an amplitude; r is NaN out of the domain,
   !> else 0.
   elemental subroutine reduce(phi, m, m1, s, c, turns, b, r)
      real(dp), intent(in) :: phi, m
      real(dp), intent(in), optional :: m1
      real(dp), intent(out) :: s, c, turns, b, r
      s = 0.0_dp
      c = 1.0_dp
      turns = 0.0_dp
      b = complete_parameter(m, m1)
      r = b
      if (.not. ieee_is_finite(b)) return
      r = ieee_value(r, ieee_quiet_nan)
      if (.not. ieee_is_finite(phi)) return
      if (abs(phi) > largest) return
      turns = anint(phi/pi)
      s = sine(phi)
      c = cosine(phi)
      if (modulo(turns, 2.0_dp) > 0.0_dp) then
         s = -s
         c = -c
      end if
      if (c < 0.0_dp) then ! phi/pi was rounded across a half
         turns = turns + sign(1.0_dp, s)
         s = -s
         c = -c
      end if
      r = 0.0_dp
   end subroutine reduce

   !> Cosine (not negative) of the amplitude of a sine; r is NaN out of the domain, else 0.
   elemental subroutine cosine_of(s, m, m1, c, b, r)
      real(dp), intent(in) :: s, m
      real(dp), intent(in), optional :: m1
      real(dp), intent(out) :: c, b, r
      c = 1.0_dp
      b = complete_parameter(m, m1)
      r = b
      if (.not. ieee_is_finite(b)) return
      r = ieee_value(r, ieee_quiet_nan)
      if (.not. ieee_is_finite(s)) return
      if (abs(s) > 1.0_dp) return
      c = sqrt((1.0_dp - s)*(1.0_dp + s))
      r = 0.0_dp
   end subroutine cosine_of

   !> F of an amplitude up to a quarter turn.
   elemental real(dp) function f_part(s, c, m1) result(r)
      real(dp), intent(in) :: s, c, m1
      r = s*carlson_rf(c*c, c*c + m1*s*s, 1.0_dp) ! NaN for m = 1 at a quarter turn
   end function f_part

   !> E of an amplitude up to a quarter turn (DLMF 19.25.10: positive terms).
   elemental real(dp) function e_part(s, c, m, m1) result(r)
      real(dp), intent(in) :: s, c, m, m1
      real(dp) :: d2
      d2 = c*c + m1*s*s
      r = s
      if (m1 <= 0.0_dp .or. d2 < 1.0e-300_dp) return
      r = carlson_rf(c*c, d2, 1.0_dp) + m*s*s*carlson_rd(c*c, 1.0_dp, d2)/3.0_dp
      r = s*(m1*r + m*c/sqrt(d2))
   end function e_part

   !> Pi of an amplitude up to a quarter turn; for n < 0 by the other characteristic (Abramowitz and
   !> Stegun 17.7.15).
   elemental real(dp) function pi_part(n, s, c, m, m1) result(r)
      real(dp), intent(in) :: n, s, c, m, m1
      real(dp) :: f, d2, p, q, a
      r = ieee_value(r, ieee_quiet_nan)
      if (.not. ieee_is_finite(n)) return
      d2 = c*c + m1*s*s
      p = c*c + (1.0_dp - n)*s*s
      if (p <= 0.0_dp .or. d2 <= 0.0_dp) return
      f = carlson_rf(c*c, d2, 1.0_dp)
      if (n >= 0.0_dp) then
         r = s*(f + n*s*s*carlson_rj(c*c, d2, 1.0_dp, p)/3.0_dp)
         return
      end if
      q = (m - n)/(1.0_dp - n)
      p = c*c + (m1/(1.0_dp - n))*s*s
      r = f + q*s*s*carlson_rj(c*c, d2, 1.0_dp, p)/3.0_dp
      r = s*((m/(m - n))*f + ((-n)/(m - n))*(m1/(1.0_dp - n))*r)
      a = (-n/(1.0_dp - n))*(m - n)
      r = r + sqrt(a)/(m - n)*arctangent(sqrt(a)*s*c, sqrt(d2))
   end function pi_part

end module poinsot_elliptic_legendre
