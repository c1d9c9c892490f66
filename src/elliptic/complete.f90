!> Legendre's complete elliptic integrals of the parameter m = k**2, or of m1 = 1 - m near m = 1.
!>
!> Sums of positive terms in Carlson's integrals (DLMF 19.25(i)), so accurate to the last digits for
!> every m in [0, 1], also where m1 is far below the spacing of doubles near 1. Arguments outside
!> the domain, infinite or NaN give NaN.
module poinsot_elliptic_complete
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use poinsot_core_constants, only: pi
   use poinsot_core_kinds, only: dp
   use poinsot_elliptic_carlson, only: carlson_rd, carlson_rf, carlson_rj
   implicit none(type, external)
   private
   public :: complete_k, complete_e, complete_pi, complete_parameter, parameter_of

contains

   !> K(m) = R_F(0, 1 - m, 1), by the arithmetic-geometric mean: K = pi/(2 agm(1, sqrt(1 - m))).
   elemental real(dp) function complete_k(m, m1) result(r)
      real(dp), intent(in) :: m            !! parameter, in [0, 1)
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it; > 0
      real(dp) :: a, b, c
      integer :: i
      b = complete_parameter(m, m1)
      r = b
      if (.not. ieee_is_finite(b)) return
      r = ieee_value(r, ieee_quiet_nan)
      if (b <= 0.0_dp) return
      a = 1.0_dp
      b = sqrt(b)
      do i = 1, 20 ! a dozen steps for the smallest m1 there is
         c = 0.5_dp*(a - b)
         if (abs(c) < 1.0e-9_dp*a) exit
         b = sqrt(a*b)
         a = a - c
         if (b > a) b = a
      end do
      r = pi/2/(0.5_dp*(a + b))
   end function complete_k

   !> E(m) = m1 (R_D(0, m1, 1) + R_D(0, 1, m1))/3.
   elemental real(dp) function complete_e(m, m1) result(r)
      real(dp), intent(in) :: m            !! parameter, in [0, 1]
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it
      real(dp) :: b
      b = complete_parameter(m, m1)
      r = b
      if (.not. ieee_is_finite(b)) return
      r = 1.0_dp
      if (b < 1.0e-300_dp) return
      r = b*(carlson_rd(0.0_dp, b, 1.0_dp) + carlson_rd(0.0_dp, 1.0_dp, b))/3.0_dp
   end function complete_e

   !> Pi(n, m) = integral of dt/((1 - n sin(t)**2) sqrt(1 - m sin(t)**2)) from 0 to pi/2.
   elemental real(dp) function complete_pi(n, m, m1) result(r)
      real(dp), intent(in) :: n            !! characteristic, < 1, any negative value too
      real(dp), intent(in) :: m            !! parameter, in [0, 1)
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it; > 0
      real(dp), parameter :: far = -1.0e40_dp, up = 2.0_dp**200, root_up = 2.0_dp**100
      real(dp) :: b, p, q, part, better
      b = complete_parameter(m, m1)
      r = b
      if (.not. ieee_is_finite(b)) return
      r = ieee_value(r, ieee_quiet_nan)
      if (.not. ieee_is_finite(n)) return
      if (b <= 0.0_dp .or. n >= 1.0_dp) return
      r = carlson_rf(0.0_dp, b, 1.0_dp)
      if (n >= 0.0_dp) then
         r = r + n*carlson_rj(0.0_dp, b, 1.0_dp, 1.0_dp - n)/3.0_dp
         return
      end if
      ! Abramowitz and Stegun 17.7.17: the other characteristic q, positive terms again
      better = parameter_of(m, b)
      q = (better - n)/(1.0_dp - n)
      p = b/(1.0_dp - n)
      if (n < far) then ! p R_J(0, b, 1, p) = 3/2 pi sqrt(p/b) (1 - O(sqrt(p/b)))
         part = pi/2/sqrt(1.0_dp - n)
      else if (b < 1.0e-200_dp) then ! p might be subnormal
         part = root_up*((up*b)/(1.0_dp - n)) &
            *carlson_rj(0.0_dp, up*b, up, (up*b)/(1.0_dp - n))/3.0_dp
      else
         part = p*carlson_rj(0.0_dp, b, 1.0_dp, p)/3.0_dp
      end if
      r = (better/(better - n))*r + ((-n)/(better - n))*(p*r + q*part)
   end function complete_pi

   !> 1 - m, the given or the computed one; NaN if either is out of the domain.
   elemental real(dp) function complete_parameter(m, m1) result(b)
      real(dp), intent(in) :: m            !! parameter, in [0, 1]
      real(dp), intent(in), optional :: m1 !! 1 - m, which is believed
      b = ieee_value(b, ieee_quiet_nan)
      if (.not. ieee_is_finite(m)) return
      if (m < 0.0_dp .or. m > 1.0_dp) return
      if (present(m1)) then
         if (.not. ieee_is_finite(m1)) return
         if (m1 < 0.0_dp .or. m1 > 1.0_dp) return
         b = m1
      else
         b = 1.0_dp - m
      end if
   end function complete_parameter

   !> m, as given or from 1 - m, whichever is more accurate.
   elemental real(dp) function parameter_of(m, b) result(better)
      real(dp), intent(in) :: m !! as given
      real(dp), intent(in) :: b !! of `complete_parameter`
      better = m
      if (b < 0.5_dp) better = 1.0_dp - b
   end function parameter_of

end module poinsot_elliptic_complete
