!> The constants of the moments of inertia that the exact step needs, for a block of bodies: the
!> only source of these constants, both for bodies that all differ and for a body class, which is a
!> block of one.
!>
!> Axes are sorted by moment, I1 <= I2 <= I3; an odd permutation would be a mirror image, so it
!> comes with `parity = -1`, the sign of momentum and of the vector part of a rotation. All
!> constants except the inverse moments are dimensionless, and finite for every physical body,
!> including linear, flat, symmetric and spherical ones; no two moments are multiplied, so that SI
!> units of molecules (1e-46 kg m^2) do no harm. Choices are masks: the bits of a lane depend on
!> that lane alone.
module poinsot_body_constants
   use poinsot_core_constants, only: exponent_bits
   use poinsot_core_kinds, only: dp, i8, group, lanes
   use poinsot_body_moments, only: moment_tolerance
   use poinsot_body_series_start, only: start_degree, start_series
   implicit none(type, external)
   private
   public :: lane_constants, make_constants

   !> Constants of a block of bodies, axes sorted (mathematics, sections 2 and 3).
   type :: lane_constants
      real(dp), dimension(lanes, 3) :: moments    !! ascending, over `scale`
      real(dp), dimension(lanes, 3) :: inverse    !! 1/moment, caller's unit; 0 for a zero one
      real(dp), dimension(lanes) :: largest_inverse !! of these
      real(dp), dimension(lanes) :: scale         !! power of two near the largest moment
      real(dp), dimension(lanes) :: parity        !! +1 or -1: sign of the permutation
      integer(i8), dimension(lanes, 3) :: exchange !! masks of axes 1 and 2, 2 and 3, 1 and 2 that
                                                   !! changed places, in this order
      real(dp), dimension(lanes) :: top           !! I3 - I2, at most I1 for a body
      real(dp), dimension(lanes, 3) :: a          !! (I3-I2)/I1, (I3-I1)/I2, (I2-I1)/I3; a(1) = 0 if
                                                  !! I1 = 0
      real(dp), dimension(lanes) :: b4, c4        !! a1 a2/4, a2 a3/4
      real(dp), dimension(lanes) :: theta         !! (I3-I2)/(I3-I1); 1/2 for a sphere
      real(dp), dimension(lanes) :: k1            !! theta I2/I1; 0 if I1 = 0
      real(dp), dimension(lanes) :: k3            !! (1-theta) I2/I3
      real(dp), dimension(lanes) :: f1            !! (I3-I2)/I3
      real(dp), dimension(lanes) :: reach         !! (h |omega|)^2 to which the short series of the
                                                  !! exact step are exact to rounding
      !> Series (1 + P)/2 and (1 + R)/2: coefficient (i, j) of p^i r^j to degree 4, others not set
      real(dp), dimension(lanes, 0:start_degree, 0:start_degree) :: half_p, half_r
   end type lane_constants

   real(dp), parameter :: least_reach = 0.0127_dp !! of any body with b, c <= 1: .113^2
   integer(i8), parameter :: top_exponent = 9214364837600034816_i8 !! of 2**1023
   integer(i8), parameter :: least = shiftl(30_i8, 52), greatest = shiftl(2016_i8, 52)

contains

   !> All constants of a block. Moments are such as `check_moments` lets pass.
   pure subroutine make_constants(nvec, moments, c)
      integer, intent(in) :: nvec               !! groups of lanes to work on
      real(dp), intent(in) :: moments(lanes, 3) !! principal moments, any order, any unit
      type(lane_constants), intent(inout) :: c
      real(dp) :: b(lanes), bm(lanes)
      integer :: l
      call sort_axes(nvec, moments, c)
      call ratios(nvec, c)
      !GCC$ ivdep
      do l = 1, group*nvec
         b(l) = c%a(l, 1)*c%a(l, 2)
         bm(l) = c%a(l, 2)*c%a(l, 3)
         c%b4(l) = 0.25_dp*b(l)
         c%c4(l) = 0.25_dp*bm(l)
         ! a part of degree n has at most the n-th power of b or of c
         c%reach(l) = least_reach/max(1.0_dp, b(l), bm(l))
      end do
      call start_series(nvec, b, bm, c%a(:, 2), c%half_p, c%half_r)
   end subroutine make_constants

   !> Axes in ascending order, ties as they stand, and moments over a power of two.
   pure subroutine sort_axes(nvec, moments, c)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: moments(lanes, 3)
      type(lane_constants), intent(inout) :: c
      integer(i8) :: i1, i2, i3, e, m, odd
      real(dp) :: down
      integer :: l
      !$omp simd private(i1, i2, i3, e, m, odd, down)
      do l = 1, group*nvec
         i1 = transfer(abs(moments(l, 1)), i1)      ! bits of numbers >= 0 compare like the numbers
         i2 = transfer(abs(moments(l, 2)), i2)
         i3 = transfer(abs(moments(l, 3)), i3)
         m = shifta(i2 - i1, 63)
         call exchange_bits(m, i1, i2)
         c%exchange(l, 1) = m
         odd = m
         m = shifta(i3 - i2, 63)
         call exchange_bits(m, i2, i3)
         c%exchange(l, 2) = m
         odd = ieor(odd, m)
         m = shifta(i2 - i1, 63)
         call exchange_bits(m, i1, i2)
         c%exchange(l, 3) = m
         odd = ieor(odd, m)
         e = min(max(iand(i3, exponent_bits), least), greatest)
         c%scale(l) = transfer(e, down)
         down = transfer(top_exponent - e, down)
         c%moments(l, 1) = transfer(i1, down)*down
         c%moments(l, 2) = transfer(i2, down)*down
         c%moments(l, 3) = transfer(i3, down)*down
         c%parity(l) = choose(odd, -1.0_dp, 1.0_dp)
      end do
   end subroutine sort_axes

   pure subroutine exchange_bits(mask, x, y)
      integer(i8), intent(in) :: mask
      integer(i8), intent(inout) :: x, y
      integer(i8) :: change
      change = iand(ieor(x, y), mask)
      x = ieor(x, change)
      y = ieor(y, change)
   end subroutine exchange_bits

   !> Ratios of sorted moments, each a quotient by a reciprocal and one correction. A thin body's
   !> I3 - I2 may exceed I1 by no more than a rounding of I3, and be many times I1: every constant
   !> takes the same physical value, or they would be of different bodies.
   pure subroutine ratios(nvec, c)
      integer, intent(in) :: nvec
      type(lane_constants), intent(inout) :: c
      real(dp) :: i1, i2, i3, w1, w2, w3, d, id, top, a1, a2, a3, low, t, down, largest_a
      integer(i8) :: some, wide, body
      integer :: l
      !$omp simd private(i1, i2, i3, w1, w2, w3, d, id, top, a1, a2, a3, low, t, down, largest_a, &
      !$omp some, wide, body)
      do l = 1, group*nvec
         i1 = c%moments(l, 1)
         i2 = c%moments(l, 2)
         i3 = c%moments(l, 3)
         some = below(tiny(1.0_dp), i1)             ! it has inertia about axis 1
         w1 = choose(some, 1.0_dp, 0.0_dp)/choose(some, i1, 1.0_dp)
         w2 = 1/i2
         w3 = 1/i3
         down = transfer(top_exponent - transfer(c%scale(l), some), down)
         c%inverse(l, 1) = w1*down
         c%inverse(l, 2) = w2*down
         c%inverse(l, 3) = w3*down
         c%largest_inverse(l) = max(c%inverse(l, 1), c%inverse(l, 2))
         top = i3 - i2
         body = not(below((i1 + i2)*(1 + moment_tolerance), i3))
         top = choose(iand(body, below(i1, top)), i1, top)
         largest_a = choose(body, 1.0_dp, huge(1.0_dp))
         d = i3 - i1
         low = i2 - i1
         a1 = quotient(top, i1, w1)
         a2 = quotient(d, i2, w2)
         a3 = quotient(low, i3, w3)
         c%a(l, 1) = min(a1, largest_a)
         c%a(l, 2) = min(a2, largest_a)
         c%a(l, 3) = min(a3, largest_a)
         c%top(l) = top
         c%f1(l) = quotient(top, i3, w3)
         wide = below(0.0_dp, d)                    ! it is no sphere
         id = 1/choose(wide, d, 1.0_dp)
         t = choose(wide, quotient(top, d, id), 0.5_dp)
         c%theta(l) = t
         c%k1(l) = choose(wide, (t*w1)*i2, 0.5_dp)
         c%k3(l) = choose(wide, quotient(low, d, id)*(i2*w3), 0.5_dp)
      end do
   end subroutine ratios

   !> x/y with 1/y given, the last bit put right where products and sums are fused.
   pure real(dp) function quotient(x, y, inverse)
      real(dp), intent(in) :: x, y, inverse
      quotient = x*inverse
      quotient = quotient + (x - quotient*y)*inverse
   end function quotient

   include "../core/choose.inc"
   include "../core/below.inc"

end module poinsot_body_constants
