!> A body class: what a kernel needs to know of a body's moments of inertia, worked out once.
!>
!> Kernels see bodies through axes sorted by moment, I1 <= I2 <= I3 (`order`); an odd order would be
!> a mirror image, so it comes with `parity = -1`, the sign of momentum and of the vector part of a
!> rotation. All constants below are dimensionless and finite for every physical body, linear, flat,
!> symmetric and spherical ones alike; nothing here multiplies two moments, so that SI units of
!> molecules (1e-46 kg m^2) cost nothing.
module poinsot_body_class
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_body_moments, only: accept_moments, moment_tolerance
   use poinsot_body_series, only: max_degree, degree_bound, correction_series
   use poinsot_body_economy, only: last_kept, economised, economy_bound
   use poinsot_body_universal, only: universal_bound, economy_range, sine_error
   implicit none(type, external)
   private
   public :: body_class, make_class, series_levels, longest_step

   integer, parameter :: series_levels = 2              !! lengths of series the exact step offers
   integer, parameter :: low_degree = 4                 !! highest power of h^2 in P and R of the
                                                        !! first
   real(dp), parameter :: fastest = 1e70_dp      !! angular velocity, in the caller's unit, that no
                                                 !! body may exceed: no square of a kernel overflows
   real(dp), parameter :: longest_step = 0.7_dp         !! h |omega| of the longest single exact
                                                        !! step

   !> Constants of a body class (mathematics, sections 2 and 3).
   type :: body_class
      real(dp) :: moments(3) = 1          !! as the caller gave them, in the caller's axis order
      real(dp) :: inverse(3) = 1          !! 1/moment; 0 for a zero moment
      real(dp) :: limit(3) = fastest      !! momenta that no body may exceed
      integer :: order(3) = [1, 2, 3]     !! sorted moment j is moments(order(j))
      real(dp) :: parity = 1              !! +1 or -1: sign of the permutation
      real(dp) :: sorted(3) = 1           !! ascending moments / scale
      real(dp) :: top = 0                 !! I3 - I2 / scale, at most I1 for a body
      real(dp) :: scale = 1               !! power of two near the largest moment
      real(dp) :: a(3) = 0                !! (I3-I2)/I1, (I3-I1)/I2, (I2-I1)/I3; a(1) = 0 if I1 = 0
      real(dp) :: theta = 0.5_dp          !! (I3-I2)/(I3-I1); 1/2 for a sphere
      real(dp) :: k1 = 0.5_dp             !! theta I2/I1; 0 if I1 = 0
      real(dp) :: k3 = 0.5_dp             !! (1-theta) I2/I3
      real(dp) :: f1 = 0                  !! (I3-I2)/I3
      real(dp) :: g1 = 0.5_dp             !! theta I3/I1; 0 if I1 = 0
      real(dp) :: g3 = 0.5_dp             !! (1-theta) I1/I3
      real(dp) :: p(0:max_degree, 0:max_degree) = 0 !! series 1 + P: coefficient (i,j) of p^i r^j
      real(dp) :: r(0:max_degree, 0:max_degree) = 0 !! series 1 + R
      real(dp) :: high_p(0:2, 0:6) = 0 !! degrees 5 to 7 of the second level (poinsot_body_economy)
      real(dp) :: high_r(0:2, 0:6) = 0
      real(dp) :: reach(series_levels) = 0 !! largest (h |omega|)^2 for which a level is exact to
                                           !! rounding
      ! of the class in a plan
      real(dp) :: axes(4) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp] !! principal frame -> the frame that
                                           !! the caller gave it in
      logical :: turned = .false.          !! these are two frames
      real(dp) :: rotor(3) = 0             !! angular momentum s of built-in rotors, relative to the
                                           !! body, principal frame: omega = (y - s)/I
      logical :: has_rotor = .false.
   end type body_class

contains

   !> Work out a body class. POINSOT_E_DOMAIN if the moments are not finite, negative or unphysical.
   !> With `physical = .false.` moments that no mass has (the largest above the sum of the others,
   !> or zeros) are taken all the same: Euler's equations have them, and so do published examples.
   pure subroutine make_class(moments, class, error, physical)
      real(dp), intent(in) :: moments(3)         !! principal moments, any order, any unit
      type(body_class), intent(out) :: class     !! constants for the kernels
      type(poinsot_error), intent(inout) :: error !! which moment is wrong, and why
      logical, intent(in), optional :: physical   !! default .true.
      real(dp) :: accepted(3), i1, i2, i3, top
      logical :: body

      accepted = moments
      call accept_moments(accepted, error, physical)
      if (raised(error)) return
      class%moments = accepted
      class%inverse = 0
      class%limit = 1e270_dp
      where (accepted > 0)
         class%inverse = 1/accepted
         class%limit = fastest*min(accepted, 1e200_dp)
      end where
      call sort(accepted, class%order, class%parity)
      class%scale = scale(1.0_dp, exponent(maxval(accepted)) - 1)
      class%sorted = accepted(class%order)/class%scale
      ! what has no inertia about two axes, or three, turns about the last alone: as a line does
      if (class%sorted(2) <= 0) class%sorted(2:) = max(class%sorted(3), 1.0_dp)
      i1 = class%sorted(1)
      i2 = class%sorted(2)
      i3 = class%sorted(3)
      ! A thin body's I3 - I2 may exceed I1 by no more than a rounding of I3, and be many times I1:
      ! every constant takes the same physical value, or they would be of different bodies.
      body = i3 <= (i1 + i2)*(1 + moment_tolerance)
      top = i3 - i2
      if (body) top = min(top, i1)
      class%top = top
      class%a = [ratio(top, i1), ratio(i3 - i1, i2), ratio(i2 - i1, i3)]
      if (body) class%a = min(class%a, 1.0_dp)
      if (i3 > i1) then
         class%theta = top/(i3 - i1)
         class%k1 = ratio(class%theta, i1)*i2
         class%k3 = (i2 - i1)/(i3 - i1)*(i2/i3)
         class%g1 = ratio(class%theta, i1)*i3
         class%g3 = (i2 - i1)/(i3 - i1)*(i1/i3)
      end if
      class%f1 = ratio(top, i3)
      call correction_series(class%a, class%p, class%r)
      class%reach = reach_of(class)
      class%high_p = economised(class%p, class%reach(series_levels))
      class%high_r = economised(class%r, class%reach(series_levels))
   end subroutine make_class

   !> x / y, and 0 for a zero moment y.
   pure real(dp) function ratio(x, y)
      real(dp), intent(in) :: x, y
      ratio = 0
      if (y > 0) ratio = x/y
   end function ratio

   !> Ascending order of three moments, ties by index, and the sign of the permutation.
   pure subroutine sort(x, order, parity)
      real(dp), intent(in) :: x(3)
      integer, intent(out) :: order(3)
      real(dp), intent(out) :: parity
      order = [1, 2, 3]
      parity = 1
      call exchange(x, 1, 2, order, parity)
      call exchange(x, 2, 3, order, parity)
      call exchange(x, 1, 2, order, parity)
   end subroutine sort

   !> Put places i < j of an order right.
   pure subroutine exchange(x, i, j, order, parity)
      real(dp), intent(in) :: x(3)
      integer, intent(in) :: i, j
      integer, intent(inout) :: order(3)
      real(dp), intent(inout) :: parity
      if (x(order(i)) <= x(order(j))) return
      order([i, j]) = order([j, i])
      parity = -parity
   end subroutine exchange

   !> Largest (h |omega|)^2 = s for which the errors of each level's series stay below a quarter of
   !> a rounding error.
   !>
   !> They are bounded degree by degree, on p + r <= s, the bound of (h |omega|)^2 over the whole
   !> motion (reached where omega2 = 0): of the first level the Bernstein coefficients of the parts
   !> left out, of the second economy_bound. With z = max(a1 a2, a2 a3)/4, so that X + Z <= z s, an
   !> attitude error is at most sqrt(s) (dP/2 + z s dT/2 + sqrt(s) dW/8). W comes from T: dW <= 0.6
   !> dT, as the second level's range is X + Z <= 0.07.
   pure function reach_of(class) result(reach)
      type(body_class), intent(in) :: class
      real(dp) :: reach(series_levels)
      real(dp) :: bound(0:max_degree, 2), z, range
      real(dp), parameter :: sine_to_product = 0.6_dp
      integer :: n

      z = 0.25_dp*class%a(2)*max(class%a(1), class%a(3))
      bound = 0
      do n = low_degree + 1, max_degree
         bound(n, 1) = 0.5_dp*max(degree_bound(class%p, n), degree_bound(class%r, n))
         if (n > low_degree + 1) bound(n, 1) = bound(n, 1) + 0.5_dp*z**n*universal_bound(n - 1)
         bound(n, 2) = 0.125_dp*sine_to_product*z**n*universal_bound(n)
      end do
      reach(1) = largest(bound, longest_step**2)
      bound = 0
      do n = last_kept + 1, max_degree
         bound(n, 1) = 0.5_dp*max(economy_bound(class%p, n), economy_bound(class%r, n))
      end do
      bound(1, 1) = 0.5_dp*z*sine_error
      bound(0, 2) = 0.125_dp*sine_to_product*sine_error
      range = longest_step**2
      if (z*range > economy_range) range = economy_range/z
      reach(2) = max(reach(1), largest(bound, range))
   end function reach_of

   !> Largest s <= range with sqrt(s) sum_n (bound(n,1) + sqrt(s) bound(n,2)) s^n <= allowed, by
   !> bisection.
   pure real(dp) function largest(bound, range)
      real(dp), intent(in) :: bound(0:max_degree, 2), range
      real(dp), parameter :: allowed = 0.25_dp*epsilon(1.0_dp)
      real(dp) :: low, high, s
      integer :: i
      low = 0
      high = range
      largest = high
      if (tail(high) <= allowed) return
      do i = 1, 40
         s = 0.5_dp*(low + high)
         if (tail(s) <= allowed) then
            low = s
         else
            high = s
         end if
      end do
      largest = low
   contains
      pure real(dp) function tail(s)
         real(dp), intent(in) :: s
         integer :: n
         tail = 0
         do n = max_degree, 0, -1
            tail = tail*s + (bound(n, 1) + sqrt(s)*bound(n, 2))
         end do
         tail = tail*sqrt(s)
      end function tail
   end function largest

end module poinsot_body_class
