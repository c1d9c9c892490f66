!> A body class: the constants of a body's moments of inertia that kernels need, computed once.
!>
!> Kernels use axes sorted by moment, I1 <= I2 <= I3 (`order`); an odd permutation would be a mirror
!> image, so it comes with `parity = -1`, the sign of momentum and of the vector part of a rotation.
!> All constants below are dimensionless and finite for every physical body, including linear, flat,
!> symmetric and spherical ones; no two moments are multiplied, so that SI units of molecules (1e-46
!> kg m^2) do no harm. Constants shared with bodies that have their own moments come from
!> poinsot_body_constants.
module poinsot_body_class
   use poinsot_core_kinds, only: dp, group, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_order, only: ascending_order
   use poinsot_core_time_table, only: time_table_list
   use poinsot_body_moments, only: accept_moments
   use poinsot_body_constants, only: lane_constants, make_constants
   use poinsot_body_series, only: max_degree, first_tabulated, degree_bound, correction_series
   use poinsot_body_series_start, only: start_degree, axis_series
   use poinsot_body_economization, only: last_kept, economized, economization_bound
   use poinsot_body_sine_series, only: short_range, short_step, long_range, short_sine_error, &
      short_product_error, long_sine_error
   implicit none(type, external)
   private
   public :: body_class, make_class, rotor_at, extend_class, needs_more, long_series
   public :: series_levels, longest_step, highest_degree, fastest

   integer, parameter :: series_levels = 2              !! lengths of series the exact step offers
   integer, parameter :: highest_degree = 11    !! of P and R that a method can ask for: order 24
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
      !> Series (1 + P)/2 and (1 + R)/2: coefficient (i, j) of p^i r^j to degree 4
      real(dp) :: half_p(0:start_degree, 0:start_degree) = 0
      real(dp) :: half_r(0:start_degree, 0:start_degree) = 0
      !> Half of degrees 5 to 7 of the second level (poinsot_body_economization)
      real(dp) :: high_p(0:2, 0:6) = 0
      real(dp) :: high_r(0:2, 0:6) = 0
      real(dp) :: reach(series_levels) = 0 !! largest (h |omega|)^2 for which a level is exact to
                                           !! rounding
      !> 1 + P and 1 + R to degree 11, (i, j) of p^i r^j, once extend_class has been asked for them
      real(dp), allocatable :: higher(:, :, :)
      ! of the class in a plan
      real(dp) :: axes(4) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp] !! principal frame -> the frame that
                                           !! the caller gave it in
      logical :: turned = .false.          !! these are two frames
      real(dp) :: rotor(3) = 0             !! angular momentum s of built-in rotors, relative to the
                                           !! body, principal frame: omega = (y - s)/I
      real(dp) :: rotor_rate = 0           !! |I^-1 s|
      logical :: has_rotor = .false.
      !> rotors whose momentum changes with time: s is `rotor` and all of them (rotor_at)
      type(time_table_list), allocatable :: rotor_tables
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
      real(dp) :: accepted(3)
      type(lane_constants) :: c
      real(dp), dimension(0:max_degree, 0:max_degree) :: p, r
      real(dp) :: copies(lanes, 3)

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
      call ascending_order(accepted, class%order, class%parity)
      ! what has no inertia about two axes, or three, turns about the last alone: as a line does
      if (accepted(class%order(2)) <= 0) then
         if (accepted(class%order(3)) <= 0) accepted = 1
         accepted(class%order(2)) = accepted(class%order(3))
         accepted(class%order(1)) = 0
      end if
      copies(:group, :) = spread(accepted, 1, group)
      call make_constants(1, copies, c)
      call take_first(c, class)
      call correction_series(class%a, max_degree, p, r)
      class%reach = reach_of(class, p, r)
      class%high_p = 0.5_dp*economized(p, class%reach(series_levels))
      class%high_r = 0.5_dp*economized(r, class%reach(series_levels))
   end subroutine make_class

   !> The constants of the first body of a block, and those that only other methods need.
   pure subroutine take_first(c, one)
      type(lane_constants), intent(in) :: c
      type(body_class), intent(inout) :: one
      real(dp) :: i1, i3, low
      integer :: j
      i1 = c%moments(1, 1)
      i3 = c%moments(1, 3)
      one%sorted = c%moments(1, :)
      one%scale = c%scale(1)
      one%top = c%top(1)
      one%a = c%a(1, :)
      one%theta = c%theta(1)
      one%k1 = c%k1(1)
      one%k3 = c%k3(1)
      one%f1 = c%f1(1)
      one%half_p(:, 0) = axis_series
      one%half_r(0, :) = axis_series
      do j = 1, start_degree
         one%half_p(:start_degree - j, j) = c%half_p(1, :start_degree - j, j)
         one%half_r(j, :start_degree - j) = c%half_r(1, j, :start_degree - j)
      end do
      if (i3 <= i1) return
      low = (one%sorted(2) - i1)/(i3 - i1)
      one%g1 = ratio(one%theta, i1)*i3
      one%g3 = low*(i1/i3)
   end subroutine take_first

   !> The momentum s of all rotors at time t.
   pure function rotor_at(class, t, ahead) result(rotor)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: ahead    !! of a jump at t, which side is meant (time_table%seen)
      real(dp) :: rotor(3)
      rotor = class%rotor
      if (allocated(class%rotor_tables)) rotor = rotor + class%rotor_tables%sum_at(t, ahead)
   end function rotor_at

   !> Keep the series that a method with more terms of it needs than every class has (`dmv12` and
   !> on). Without it such a method works them out at every call.
   pure subroutine extend_class(class, terms)
      type(body_class), intent(inout) :: class
      integer, intent(in) :: terms !! degree in h^2, at most highest_degree; below 5 nothing is done
      integer :: failed
      if (.not. needs_more(class, terms)) return
      allocate (class%higher(0:highest_degree, 0:highest_degree, 2), stat=failed)
      if (failed == 0) call long_series(class, highest_degree, class%higher)
   end subroutine extend_class

   !> Has a method more terms than the class keeps?
   pure logical function needs_more(class, terms)
      type(body_class), intent(in) :: class
      integer, intent(in) :: terms
      needs_more = terms > start_degree .and. .not. allocated(class%higher)
   end function needs_more

   !> Coefficients (i, j) of p^i r^j of 1 + P and 1 + R to degree `terms`.
   pure subroutine long_series(class, terms, c)
      type(body_class), intent(in) :: class
      integer, intent(in) :: terms !! start_degree to highest_degree
      real(dp), intent(out) :: c(0:highest_degree, 0:highest_degree, 2)
      real(dp), dimension(0:max_degree, 0:max_degree) :: p, r
      integer :: i, n
      call correction_series(class%a, terms, p, r)
      c = 0
      c(:start_degree, :start_degree, 1) = 2*class%half_p
      c(:start_degree, :start_degree, 2) = 2*class%half_r
      do n = first_tabulated, terms
         do i = 0, n
            c(i, n - i, 1) = p(i, n)
            c(i, n - i, 2) = r(i, n)
         end do
      end do
   end subroutine long_series

   !> x / y, and 0 for a zero moment y.
   pure real(dp) function ratio(x, y)
      real(dp), intent(in) :: x, y
      ratio = 0
      if (y > 0) ratio = x/y
   end function ratio

   !> Largest (h |omega|)^2 = s for which the errors of each level's series stay below a quarter of
   !> a rounding error.
   !>
   !> They are bounded degree by degree, on p + r <= s, the bound of (h |omega|)^2 over the whole
   !> motion (reached where omega2 = 0): of the first level the Bernstein coefficients of the parts
   !> left out, of the second economization_bound. With z = max(a1 a2, a2 a3)/4, so that X + Z <= z
   !> s, an attitude error is at most sqrt(s) (dP/2 + z s dT/2 + sqrt(s) dW/8); of the second level
   !> W comes from T, dW <= 0.6 dT.
   pure function reach_of(class, p, r) result(reach)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(0:, 0:) :: p, r
      real(dp) :: reach(series_levels)
      real(dp) :: bound(0:max_degree), z
      real(dp), parameter :: sine_to_product = 0.6_dp
      integer :: n

      z = 0.25_dp*class%a(2)*max(class%a(1), class%a(3))
      bound = 0
      do n = start_degree + 1, max_degree
         bound(n) = 0.5_dp*max(degree_bound(p(:, n), n), degree_bound(r(:, n), n))
      end do
      bound(1) = 0.5_dp*z*short_sine_error
      reach(1) = largest(bound, 0.125_dp*short_product_error, &
                         min(short_step, short_range/max(z, 0.1_dp)))
      bound = 0
      do n = last_kept + 1, max_degree
         bound(n) = 0.5_dp*max(economization_bound(p(:, n), n), economization_bound(r(:, n), n))
      end do
      bound(1) = 0.5_dp*z*long_sine_error
      reach(2) = largest(bound, 0.125_dp*sine_to_product*long_sine_error, &
                         min(longest_step**2, long_range/max(z, 0.1_dp)))
      reach(2) = max(reach(1), reach(2))
   end function reach_of

   !> Largest s <= range with sqrt(s) (sum_n bound(n) s^n + last sqrt(s)) <= allowed, by bisection.
   pure real(dp) function largest(bound, last, range)
      real(dp), intent(in) :: bound(0:max_degree), last, range
      real(dp), parameter :: allowed = 0.25_dp*epsilon(1.0_dp)
      real(dp) :: low, high, s
      integer :: i
      low = 0
      high = range
      largest = high
      if (tail(high) <= allowed) return
      do i = 1, 26
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
            tail = tail*s + bound(n)
         end do
         tail = (tail + last*sqrt(s))*sqrt(s)
      end function tail
   end function largest

end module poinsot_body_class
