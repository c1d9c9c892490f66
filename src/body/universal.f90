!> The universal series of the explicit exact step: sn^2 without a modulus.
!>
!> With S, C, D of mathematics section 3, T = S^2 is symmetric in X and Z, so a series in e = X + Z
!> and f = X Z: T = sum t(i,j) e^i f^j, degree i + 2j. Because C^2 = 1 - X T, D^2 = 1 - Z T and (t
!> S)' = C D, nothing else is needed: S C D = W = sum (i + 2j + 1) t(i,j) e^i f^j. A quarter of the
!> work of the three series themselves.
module poinsot_body_universal
   use poinsot_core_kinds, only: dp
   use poinsot_body_series, only: max_degree
   implicit none(type, external)
   private
   public :: sine_squared, universal_bound
   public :: economy_range, high_sine, sine_error

   integer, parameter :: half_degree = (max_degree - 1)/2
   real(dp), parameter :: zeros(12) = 0.0_dp

   !> t(i,j): exact rationals, rounded once. Row j has the powers of e; checked against the
   !> recursion in the tests.
   real(dp), parameter :: sine_squared(0:max_degree, 0:half_degree) = reshape([ &
      1.000000000000000000_dp, -3.333333333333333333e-1_dp, 4.444444444444444444e-2_dp, &
      -3.174603174603174603e-3_dp, 1.410934744268077601e-4_dp, -4.275559831115386671e-6_dp, &
      9.396834793660190486e-8_dp, -1.566139132276698414e-9_dp, 2.047240695786533875e-11_dp, &
      -2.154990206091088289e-13_dp, 1.865792386226050467e-15_dp, -1.352023468279746715e-17_dp, &
      8.320144420183056709e-20_dp, -4.402192814911670216e-22_dp, &
      2.000000000000000000e-1_dp, -8.571428571428571429e-2_dp, 1.714285714285714286e-2_dp, &
      -2.154882154882154882e-3_dp, 1.915544772687629830e-4_dp, -1.281258424115566973e-5_dp, &
      6.705839261083581034e-7_dp, -2.824287064298858490e-8_dp, 9.781836388076970434e-10_dp, &
      -2.835375736150846628e-11_dp, 6.979427612163117758e-13_dp, -1.477129914149859260e-14_dp, &
      zeros(1:2), &
      2.666666666666666667e-2_dp, -1.466089466089466090e-2_dp, 3.922426779569636712e-3_dp, &
      -6.810543953401096258e-4_dp, 8.623917494132246700e-5_dp, -8.480640492041543690e-6_dp, &
      6.734225729638886927e-7_dp, -4.433707513904065631e-8_dp, 2.467195104382549562e-9_dp, &
      -1.177587498861575770e-10_dp, zeros(1:4), &
      3.076923076923076923e-3_dp, -2.085914085914085914e-3_dp, 6.977224456216052855e-4_dp, &
      -1.534016755600125790e-4_dp, 2.490857529140785027e-5_dp, -3.181652256343501679e-6_dp, &
      3.325345700837767694e-7_dp, -2.920920292090676137e-8_dp, zeros(1:6), &
      3.298139768728004022e-4_dp, -2.665069364759767236e-4_dp, 1.069322402602125975e-4_dp, &
      -2.837624439774765268e-5_dp, 5.596307679176447813e-6_dp, -8.739036053095502114e-7_dp, &
      zeros(1:8), &
      3.378582202111613876e-5_dp, -3.173006828949755319e-5_dp, 1.484596274852942401e-5_dp, &
      -4.609564227298466343e-6_dp, zeros(1:10), &
      3.356305835943844994e-6_dp, -3.593916746848259182e-6_dp, zeros(1:12)], [max_degree + 1, &
         half_degree + 1])

   !> Degrees 5 to 7 of T for X + Z <= economy_range, with what they take over from the higher ones
   !> as in poinsot_body_economy: `high_sine(m, j)` multiplies e^(5-2j+m) f^j; the last column
   !> belongs to 0, f^3 and e f^3.
   real(dp), parameter :: economy_range = 0.07_dp
   real(dp), parameter :: high_sine(0:2, 0:3) = reshape([ &
      -4.275501567513104179e-6_dp, 9.335753898090805955e-8_dp, -6.279803052720815862e-10_dp, &
      -2.154876017143985996e-3_dp, 1.913996379576850392e-4_dp, -1.195109931628915342e-5_dp, &
      -1.466086791792753064e-2_dp, 3.920590124380298092e-3_dp, -6.53817805379360828e-4_dp, &
      0.0_dp, 3.075743678763918336e-3_dp, -2.015474113133485123e-3_dp], [3, 4])
   real(dp), parameter :: sine_error = 3.4e-17_dp    !! largest error of T with them

contains

   !> A bound of |T_n|, the part of degree n of T, on X + Z = 1, X, Z >= 0 (so that f <= 1/4).
   pure real(dp) function universal_bound(n)
      integer, intent(in) :: n !! degree, 0 to max_degree
      integer :: j
      universal_bound = 0
      do j = 0, n/2
         universal_bound = universal_bound + abs(sine_squared(n - 2*j, j))*0.25_dp**j
      end do
   end function universal_bound

end module poinsot_body_universal
