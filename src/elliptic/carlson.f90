!> Carlson's symmetric elliptic integrals R_F, R_C, R_D, R_J by duplication, to full double
!> precision.
!>
!> B. C. Carlson, Numer. Algorithms 10 (1995) 13-26; series of seventh order, DLMF 19.36(i). The
!> argument 1 + e_n of R_C within R_J is computed as 2 sqrt(p) (p + lambda)/d_n, a positive sum,
!> which works for arguments 1e130 apart. Sums are formed from scaled parts, so that they stay in
!> range for every argument. The functions are homogeneous of degree -1/2 and -3/2: tiny arguments
!> are scaled by a power of 4. Arguments outside the domain, infinite or NaN give NaN, and so does a
!> result out of range (of R_D and R_J only); no exception is raised.
module poinsot_elliptic_carlson
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: carlson_rf, carlson_rc, carlson_rd, carlson_rj

   real(dp), parameter :: close_enough = 0.008_dp !! its eighth power is 2e-17
   integer, parameter :: most = 1100              !! duplications; a dozen is usual
   real(dp), parameter :: four_thirds = 4.0_dp/3.0_dp
   real(dp), parameter :: tiny_argument = 2.0_dp**(-500) !! below it sums could be subnormal
   real(dp), parameter :: up = 2.0_dp**400, root_up = 2.0_dp**200
   integer, parameter :: least = -900, largest = 1000 !! binary exponents of what needs no scaling

contains

   !> R_F(x, y, z) = (1/2) integral of dt/sqrt((t+x)(t+y)(t+z)) from 0 to infinity.
   elemental real(dp) function carlson_rf(x, y, z) result(r)
      real(dp), intent(in) :: x !! >= 0; at most one of the three is 0
      real(dp), intent(in) :: y !! >= 0
      real(dp), intent(in) :: z !! >= 0
      r = ieee_value(r, ieee_quiet_nan)
      if (.not. triple_fits(x, y, z)) return
      if (max(x, y, z) < tiny_argument) then
         r = root_up*rf_sum(x*up, y*up, z*up)
      else
         r = rf_sum(x, y, z)
      end if
   end function carlson_rf

   !> Three numbers that are finite, not negative, at most one of them 0.
   elemental logical function triple_fits(x, y, z) result(fits)
      real(dp), intent(in) :: x, y, z
      fits = ieee_is_finite(x) .and. ieee_is_finite(y) .and. ieee_is_finite(z)
      if (.not. fits) return
      fits = min(x, y, z) >= 0.0_dp .and. max(min(x, y), min(max(x, y), z)) > 0.0_dp
   end function triple_fits

   !> A quarter of the lambda of Carlson's duplication.
   elemental real(dp) function quarter_lambda(x, y, z) result(quarter)
      real(dp), intent(in) :: x, y, z
      real(dp) :: half_x, half_y, half_z
      half_x = 0.5_dp*sqrt(x)
      half_y = 0.5_dp*sqrt(y)
      half_z = 0.5_dp*sqrt(z)
      quarter = half_x*(half_y + half_z) + half_y*half_z
   end function quarter_lambda

   !> Duplication for R_F; the arguments have been checked.
   elemental real(dp) function rf_sum(x0, y0, z0) result(r)
      real(dp), intent(in) :: x0, y0, z0
      real(dp) :: x, y, z, a, lambda, p, q, e2, e3
      integer :: i
      x = x0
      y = y0
      z = z0
      do i = 1, most
         a = four_thirds*(0.25_dp*x + 0.25_dp*y + 0.25_dp*z)
         if (max(abs(a - x), abs(a - y), abs(a - z)) < close_enough*a) exit
         lambda = quarter_lambda(x, y, z)
         x = 0.25_dp*x + lambda
         y = 0.25_dp*y + lambda
         z = 0.25_dp*z + lambda
      end do
      p = (a - x)/a
      q = (a - y)/a
      e2 = p*q - (p + q)**2
      e3 = -p*q*(p + q)
      r = 1.0_dp + (e2*(-1.0_dp/10.0_dp + e2/24.0_dp - 3.0_dp*e3/44.0_dp - 5.0_dp*e2*e2/208.0_dp &
         + e2*e3/16.0_dp) + e3*(1.0_dp/14.0_dp + 3.0_dp*e3/104.0_dp))
      r = r/sqrt(a)
   end function rf_sum

   !> R_C(x, y) = R_F(x, y, y); its Cauchy principal value for y < 0.
   elemental real(dp) function carlson_rc(x, y) result(r)
      real(dp), intent(in) :: x !! >= 0
      real(dp), intent(in) :: y !! not 0
      r = ieee_value(r, ieee_quiet_nan)
      if (.not. (ieee_is_finite(x) .and. ieee_is_finite(y))) return
      if (x < 0.0_dp .or. abs(y) <= 0.0_dp) return
      if (max(x, abs(y)) < tiny_argument) then
         r = root_up*rc_any(x*up, y*up)
      else if (y < 0.0_dp .and. max(x, -y) > 0.5_dp*huge(x)) then ! x - y could overflow
         r = 0.5_dp*rc_any(0.25_dp*x, 0.25_dp*y)
      else
         r = rc_any(x, y)
      end if
   end function carlson_rc

   !> R_C of either sign of y (DLMF 19.2.20).
   elemental real(dp) function rc_any(x, y) result(r)
      real(dp), intent(in) :: x, y
      if (y > 0.0_dp) then
         r = rc_sum(x, y)
      else if (x > 0.0_dp) then
         r = (sqrt(x)/sqrt(x - y))*rc_sum(x - y, -y)
      else
         r = 0.0_dp
      end if
   end function rc_any

   !> Duplication for R_C, y > 0.
   elemental real(dp) function rc_sum(x0, y0) result(r)
      real(dp), intent(in) :: x0, y0
      real(dp) :: x, y, a, lambda, s
      integer :: i
      x = x0
      y = y0
      do i = 1, most
         a = four_thirds*(0.25_dp*x + 0.5_dp*y)
         if (abs(a - x) < close_enough*a) exit
         lambda = 0.5_dp*sqrt(x)*sqrt(y) + 0.25_dp*y
         x = 0.25_dp*x + lambda
         y = 0.25_dp*y + lambda
      end do
      s = 0.5_dp*(a - x)/a
      r = 9.0_dp/22.0_dp + s*(159.0_dp/208.0_dp + s*9.0_dp/8.0_dp)
      r = 1.0_dp + s*s*(0.3_dp + s*(1.0_dp/7.0_dp + s*(0.375_dp + s*r)))
      r = r/sqrt(a)
   end function rc_sum

   !> R_D(x, y, z) = R_J(x, y, z, z).
   elemental real(dp) function carlson_rd(x, y, z) result(r)
      real(dp), intent(in) :: x !! >= 0; not 0 together with y
      real(dp), intent(in) :: y !! >= 0
      real(dp), intent(in) :: z !! > 0
      integer :: k
      r = ieee_value(r, ieee_quiet_nan)
      if (.not. triple_fits(x, y, z)) return
      if (z <= 0.0_dp) return
      k = upward(exponent(z) + exponent(max(x, y))/2, max(x, y, z)) ! value at most 3/(z sqrt(y))
      r = rescaled(rd_sum(scale(x, 2*k), scale(y, 2*k), scale(z, 2*k)), k)
   end function carlson_rd

   !> The k with which arguments 4**k as large have a value in range, if the value of arguments as
   !> they are may be as large as 2**(-bound). 0 for most.
   elemental integer function upward(bound, greatest) result(k)
      integer, intent(in) :: bound
      real(dp), intent(in) :: greatest !! of the arguments
      k = 0
      if (bound < least) k = min((least - bound)/3 + 1, (largest - exponent(greatest))/2)
   end function upward

   !> A value of degree -3/2 of arguments 4**k as large; NaN out of range.
   elemental real(dp) function rescaled(value, k) result(r)
      real(dp), intent(in) :: value
      integer, intent(in) :: k
      r = value
      if (k == 0) return
      if (exponent(value) + 3*k > maxexponent(r)) then
         r = ieee_value(r, ieee_quiet_nan)
      else
         r = scale(value, 3*k)
      end if
   end function rescaled

   !> Duplication for R_D.
   elemental real(dp) function rd_sum(x0, y0, z0) result(r)
      real(dp), intent(in) :: x0, y0, z0
      real(dp) :: x, y, z, a, lambda, total, power
      integer :: i
      x = x0
      y = y0
      z = z0
      total = 0.0_dp
      power = 1.0_dp
      do i = 1, most
         a = 1.6_dp*(0.125_dp*x + 0.125_dp*y + 0.375_dp*z)
         if (max(abs(a - x), abs(a - y), abs(a - z)) < close_enough*a) exit
         lambda = quarter_lambda(x, y, z)
         power = 0.25_dp*power
         total = total + power/sqrt(z)/(0.25_dp*z + lambda)
         x = 0.25_dp*x + lambda
         y = 0.25_dp*y + lambda
         z = 0.25_dp*z + lambda
      end do
      r = degree_3_2(power, a, (a - x)/a, (a - y)/a, (a - z)/a, (a - z)/a) + 3.0_dp*total
   end function rd_sum

   !> The series that R_D and R_J end with (DLMF 19.36.2), x + y + z + 2 p = 0.
   elemental real(dp) function degree_3_2(power, a, x, y, z, p) result(r)
      real(dp), intent(in) :: power !! what it is multiplied by
      real(dp), intent(in) :: a, x, y, z, p
      real(dp) :: e2, e3, e4, e5, xyz
      xyz = x*y*z
      e2 = x*y + x*z + y*z - 3.0_dp*p*p
      e3 = xyz + 2.0_dp*e2*p + 4.0_dp*p*p*p
      e4 = (2.0_dp*xyz + e2*p + 3.0_dp*p*p*p)*p
      e5 = xyz*p*p
      r = e2*(-3.0_dp/14.0_dp + 9.0_dp*e2/88.0_dp - 9.0_dp*e3/52.0_dp - e2*e2/16.0_dp &
         + 3.0_dp*e4/20.0_dp + 45.0_dp*e2*e3/272.0_dp - 9.0_dp*e5/68.0_dp)
      r = r + e3*(1.0_dp/6.0_dp + 3.0_dp*e3/40.0_dp - 9.0_dp*e4/68.0_dp)
      r = r - 3.0_dp*e4/22.0_dp + 3.0_dp*e5/26.0_dp
      r = (1.0_dp + r)*(power/a)/sqrt(a)
   end function degree_3_2

   !> R_J(x, y, z, p), symmetric in x, y, z; its Cauchy principal value for p < 0.
   elemental real(dp) function carlson_rj(x, y, z, p) result(r)
      real(dp), intent(in) :: x !! >= 0; at most one of the three is 0
      real(dp), intent(in) :: y !! >= 0
      real(dp), intent(in) :: z !! >= 0
      real(dp), intent(in) :: p !! not 0
      integer :: k
      r = ieee_value(r, ieee_quiet_nan)
      if (.not. triple_fits(x, y, z)) return
      if (.not. ieee_is_finite(p)) return
      if (abs(p) <= 0.0_dp) return
      k = upward(rj_bound(x, y, z, p), max(x, y, z, abs(p)))
      if (p < 0.0_dp .and. max(x, y, z, -p) > 0.5_dp*huge(x)) k = -1 ! y - p could overflow
      r = rescaled(rj_any(scale(x, 2*k), scale(y, 2*k), scale(z, 2*k), scale(p, 2*k)), k)
   end function carlson_rj

   !> The value, and every term on the way to it, is less than about 2**(-bound): 5/sqrt(y z p) with
   !> x the least of three, or for p < 0 5/((y - p) (y z)**(1/4)) and 5/(y sqrt(z)).
   elemental integer function rj_bound(x, y, z, p) result(bound)
      real(dp), intent(in) :: x, y, z, p
      integer :: middle, high
      middle = exponent(max(min(x, y), min(max(x, y), z)))
      high = exponent(max(x, y, z))
      if (p > 0.0_dp) then
         bound = (middle + high + exponent(p))/2
      else
         bound = min((middle + high)/4 + max(middle, exponent(p)), middle + high/2)
      end if
   end function rj_bound

   !> R_J for either sign of p (DLMF 19.20.14).
   elemental real(dp) function rj_any(x, y, z, p) result(r)
      real(dp), intent(in) :: x, y, z, p
      real(dp) :: low, middle, high, t
      if (p > 0.0_dp) then
         r = rj_sum(1.0_dp, x, y, z, p)
         return
      end if
      low = min(x, y, z)
      high = max(x, y, z)
      middle = max(min(x, y), min(max(x, y), z))
      t = middle + (high - middle)*((middle - low)/(middle - p))
      r = rj_sum(t - middle, low, middle, high, t) - 3.0_dp*rf_sum(low, middle, high)
      ! low high/middle and t p/middle, with factors of at most 1
      r = r + 3.0_dp*rc_any((low/middle)*high, &
         p + (p/(middle - p))*((high - middle)*((middle - low)/middle)))
      r = r/(middle - p)
   end function rj_any

   !> Duplication for R_J times a factor, p > 0.
   elemental real(dp) function rj_sum(factor, x0, y0, z0, p0) result(r)
      real(dp), intent(in) :: factor !! so large that R_J alone might be below the range
      real(dp), intent(in) :: x0, y0, z0, p0
      real(dp) :: x, y, z, p, a, lambda, total, power, sx, sy, sz, q
      integer :: i
      x = x0
      y = y0
      z = z0
      p = p0
      total = 0.0_dp
      power = factor
      do i = 1, most
         a = 1.6_dp*(0.125_dp*x + 0.125_dp*y + 0.125_dp*z + 0.25_dp*p)
         if (max(abs(a - x), abs(a - y), abs(a - z), abs(a - p)) < close_enough*a) exit
         lambda = quarter_lambda(x, y, z)
         sx = sqrt(p) + sqrt(x)
         sy = sqrt(p) + sqrt(y)
         sz = sqrt(p) + sqrt(z)
         ! Carlson's 1 + e_n, without cancellation
         q = 2.0_dp*(sqrt(p)/sx)*((p/sy + 4.0_dp*(lambda/sy))/sz)
         total = total + ((power/sx)/sy)/sz*rc_sum(1.0_dp, q)
         power = 0.25_dp*power
         x = 0.25_dp*x + lambda
         y = 0.25_dp*y + lambda
         z = 0.25_dp*z + lambda
         p = 0.25_dp*p + lambda
      end do
      r = degree_3_2(power, a, (a - x)/a, (a - y)/a, (a - z)/a, (a - p)/a) + 6.0_dp*total
   end function rj_sum

end module poinsot_elliptic_carlson
