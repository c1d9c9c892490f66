!> Constants that the series of both precisions share.
module poinsot_taylor_series_common
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: last_order, last_double, reciprocal, sine_series, cosine_series, farthest_turn, &
      farthest_angle

   integer, parameter :: last_order = 24       !! of all series
   integer, parameter :: last_double = 16      !! of those in double precision
   integer :: k_                               ! of the implied loops below

   real(dp), parameter :: reciprocal(last_order + 1) = [(1.0_dp/k_, k_=1, last_order + 1)]

   !> sin a = a + a u (s1 + s2 u + ...), cos a = 1 + u (c1 + c2 u + ...), u = a^2.
   real(dp), parameter :: sine_series(10) = [-1.0_dp/6, 1.0_dp/120, -1.0_dp/5040, 1.0_dp/362880, &
      -1.0_dp/39916800, 1.0_dp/6227020800.0_dp, -1.0_dp/1307674368000.0_dp, &
      1.0_dp/355687428096000.0_dp, -1.0_dp/121645100408832000.0_dp, &
      1.0_dp/51090942171709440000.0_dp]
   real(dp), parameter :: cosine_series(10) = [-1.0_dp/2, 1.0_dp/24, -1.0_dp/720, 1.0_dp/40320, &
      -1.0_dp/3628800, 1.0_dp/479001600, -1.0_dp/87178291200.0_dp, 1.0_dp/20922789888000.0_dp, &
      -1.0_dp/6402373705728000.0_dp, 1.0_dp/2432902008176640000.0_dp]

   real(dp), parameter :: farthest_turn = 0.9_dp    !! sin^2 of half a direction's turn in a step
   real(dp), parameter :: farthest_angle = 1.35_dp  !! half the angle about it

end module poinsot_taylor_series_common
