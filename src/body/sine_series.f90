!> sn^2 of half a step without a modulus, for the explicit exact step.
!>
!> With S, C, D of mathematics section 3, T = S^2 is symmetric in X and Z, so a series in e = X + Z
!> and f = X Z: T = sum t(i,j) e^i f^j, degree i + 2j. Because C^2 = 1 - X T and D^2 = 1 - Z T
!> nothing else is needed; S C D = W = sum (i + 2j + 1) t(i,j) e^i f^j, or the root of T (1 - X T)(1
!> - Z T).
!>
!> The polynomials below are least-squares fits of low degree to T and W (40 digits, Chebyshev nodes
!> in e, f = phi e^2/4 with nodes in phi), whose value at 0 is exact; so are those of the half
!> angle.
module poinsot_body_sine_series
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: short_sine, short_product, long_sine, half_cosine, half_factor
   public :: short_range, short_step, long_range, short_sine_error, short_product_error, &
      long_sine_error

   real(dp), parameter :: short_range = 0.0039_dp !! X + Z to which the short ones reach
   real(dp), parameter :: long_range = 0.07_dp    !! and the long one
   real(dp), parameter :: short_step = 0.0156_dp  !! (h |omega|)^2 to which the half angle's reach

   !> T for short steps: 1, e, e^2, e^3, f, e f, f^2.
   real(dp), parameter :: short_sine(7) = [ &
      1.0_dp, -0.33333333330826737_dp, 0.044444424734546295_dp, -0.003170544494974824_dp, &
      0.19999984909942448_dp, -0.08561104940588753_dp, 0.02774721065132738_dp]
   real(dp), parameter :: short_sine_error = 1.5e-14_dp    !! its largest error

   !> W for short steps: 1, e, e^2, e^3, e^4, f, e f, e^2 f, f^2.
   real(dp), parameter :: short_product(9) = [ &
      1.0_dp, -0.6666666666666055_dp, 0.1333333332651066_dp, -0.012698395448784709_dp, &
      0.0007045149569154783_dp, 0.5999999993403689_dp, -0.34285635334620485_dp, &
      0.08550055408917873_dp, 0.13300981188966618_dp]
   real(dp), parameter :: short_product_error = 6e-17_dp

   !> T for longer steps: 1, e to e^7; f, e f to e^5 f; f^2 to e^3 f^2; f^3, e f^3.
   real(dp), parameter :: long_sine(20) = [ &
      1.0_dp, -0.3333333333333332_dp, 0.04444444444442445_dp, -0.003174603173876569_dp, &
      0.00014109347578877363_dp, -4.275980876697189e-06_dp, 1.0022945585025531e-07_dp, &
      -2.9081794773159593e-08_dp, &
      0.19999999999979742_dp, -0.08571428567563287_dp, 0.017142855025450196_dp, &
      -0.0021548371108362444_dp, 0.00019116719854474549_dp, -1.166283807159261e-05_dp, &
      0.02666666406675078_dp, -0.014660684208289872_dp, 0.003917442158556374_dp, &
      -0.0006408535842446383_dp, &
      0.0030736657374814454_dp, -0.0019805754988665046_dp]
   real(dp), parameter :: long_sine_error = 7e-18_dp

   !> With v = sin^2(angle), v <= short_step: cos(angle/2) = 1 + v times the first, and
   !> 1/(2 cos(angle/2)) the second, powers of v from 0 to 5; errors 8e-19 and 6e-17.
   real(dp), parameter :: half_cosine(0:5) = [ &
      -0.125_dp, -0.03906250000013514_dp, -0.020507812378913845_dp, -0.013092076413956974_dp, &
      -0.009269008850362734_dp, -0.007269161722524001_dp]
   real(dp), parameter :: half_factor(0:5) = [ &
      0.5_dp, 0.06250000000015127_dp, 0.027343749864460438_dp, 0.01611332087503456_dp, &
      0.010904973950966273_dp, 0.008301535920241717_dp]

end module poinsot_body_sine_series
