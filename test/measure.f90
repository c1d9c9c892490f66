!> How the tests measure: slopes, distances, and errors in units of conditioning.
module test_measure
   use poinsot_core_kinds, only: dp, qp
   implicit none(type, external)
   private
   public :: measure_slope, attitude_distance, momentum_distance, units, unit_roundoff

   real(dp), parameter :: unit_roundoff = 1.0e-16_dp !! the unit in which errors are quoted

   !> min(|q - r|, |q + r|): the sign of a quaternion means nothing.
   interface attitude_distance
      module procedure attitude_distance_dp, attitude_distance_qp
   end interface attitude_distance

   !> |y - z|/|z|, or |y| itself if z = 0.
   interface momentum_distance
      module procedure momentum_distance_dp, momentum_distance_qp
   end interface momentum_distance

contains

   !> Slope of log(error) over log(h) by least squares. A point counts only between the rounding
   !> plateau (30 times `floor`) and `ceiling`, above which the asymptotic law does not hold.
   pure subroutine measure_slope(h, error, floor, slope, used, ceiling)
      real(dp), intent(in) :: h(:)              !! steps, at least 3 of them
      real(dp), intent(in) :: error(:)          !! of the same size
      real(dp), intent(in) :: floor             !! where rounding takes over
      real(dp), intent(out) :: slope            !! 0 if fewer than 3 points count
      integer, intent(out) :: used              !! how many counted
      real(dp), intent(in), optional :: ceiling !! default 0.1
      real(dp) :: top, x(size(h)), z(size(h)), dx(size(h))
      logical :: good(size(h))
      top = 0.1_dp
      if (present(ceiling)) top = ceiling
      good = error > 30*floor .and. error < top
      used = count(good)
      slope = 0
      if (used < 3) return
      x = log(merge(abs(h), 1.0_dp, good))
      z = log(merge(error, 1.0_dp, good))
      dx = merge(x - sum(x, mask=good)/used, 0.0_dp, good)
      slope = sum(dx*z)/sum(dx*dx)
   end subroutine measure_slope

   !> An error in units of (condition number times 1e-16).
   elemental real(dp) function units(error, condition)
      real(dp), intent(in) :: error
      real(dp), intent(in) :: condition !! relative condition number, taken as at least 1
      units = error/(unit_roundoff*max(1.0_dp, condition))
   end function units

   pure real(dp) function attitude_distance_dp(q, r) result(distance)
      real(dp), intent(in) :: q(4), r(4)
      distance = attitude_distance_qp(real(q, qp), real(r, qp))
   end function attitude_distance_dp

   pure real(dp) function attitude_distance_qp(q, r) result(distance)
      real(qp), intent(in) :: q(4), r(4)
      distance = real(sqrt(min(sum((q - r)**2), sum((q + r)**2))), dp)
   end function attitude_distance_qp

   pure real(dp) function momentum_distance_dp(y, z) result(distance)
      real(dp), intent(in) :: y(3), z(3)
      distance = momentum_distance_qp(real(y, qp), real(z, qp))
   end function momentum_distance_dp

   pure real(dp) function momentum_distance_qp(y, z) result(distance)
      real(qp), intent(in) :: y(3), z(3)
      real(qp) :: d
      d = sqrt(sum((y - z)**2))
      if (any(z /= 0)) d = d/sqrt(sum(z*z))
      distance = real(d, dp)
   end function momentum_distance_qp

end module test_measure
