!> Moments of inertia of each body's own: those of its class times a number, or any (mathematics,
!> section 10).
!>
!> Bodies of one shape share the constants of their class: a body of moments s I moves over h as one
!> of moments I over h/s, with the same y. Bodies that all differ have constants for each lane.
module poinsot_free_lane_moments
   use poinsot_core_kinds, only: dp, i8, group, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_not_finite
   use poinsot_body_class, only: body_class, fastest
   use poinsot_free_exact_lanes, only: lane_constants, accept_lanes, make_constants, &
      advance_each
   use poinsot_free_method, only: free_method, advance_lanes
   implicit none(type, external)
   private
   public :: lane_moments, take_scale, take_moments, takes_moments, advance_own

   !> Of the bodies of a block. All lanes are set, those of padding too, but for the constants.
   type :: lane_moments
      ! arrays first: vectors of a block then begin at a multiple of 64 bytes
      real(dp), dimension(lanes) :: scale         !! over the moments of the class; else 1
      real(dp), dimension(lanes, 3) :: moments    !! caller's axes
      real(dp), dimension(lanes, 3) :: inverse    !! 0 for a zero moment
      real(dp), dimension(lanes, 3) :: limit      !! momenta that no body may exceed
      type(lane_constants) :: constants           !! unless `scaled`, once a step has needed them
      logical :: scaled                           !! of the shape of the class; else any
      logical :: wide                             !! a scale is far from 1
      logical :: linear                           !! a body has no inertia about some axis
      logical :: made                             !! the constants are
   end type lane_moments

   real(dp), parameter :: heaviest = 1e200_dp     !! a bound on momenta grows with moments to here
   real(dp), parameter :: massless = 1e270_dp     !! bound about an axis without inertia
   integer, parameter :: near = 10                !! powers of two that kernels have room for
   integer, parameter :: range = 1018             !! powers of two that moments may have
   integer, parameter :: faint = -800             !! of y: below, it is not made smaller
   real(dp), parameter :: far = 1e70_dp           !! steps that are not divided by a small number
   integer(i8), parameter :: exponent_bits = int(z'7FF0000000000000', i8)

contains

   !> Moments that are those of a class times a number for each body. A number that is not positive,
   !> or moments beyond the range of numbers: POINSOT_E_DOMAIN; not finite: POINSOT_E_NOT_FINITE.
   !> Such a lane gets the moments of its class.
   pure subroutine take_scale(class, scale, own, status)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: scale(lanes)
      type(lane_moments), intent(inout) :: own
      integer, intent(inout) :: status(lanes)
      integer(i8) :: least, most, bits, outside, spread
      real(dp) :: reciprocal(lanes)
      integer :: j, l
      least = lowest_scale(class)
      most = highest_scale(class)
      outside = 0
      spread = 0
      do l = 1, lanes
         bits = transfer(scale(l), bits)
         outside = ior(outside, ior(bits - least, most - bits))
         own%scale(l) = scale(l)
      end do
      if (outside < 0) then
         do l = 1, lanes
            bits = transfer(scale(l), bits)
            if (bits >= least .and. bits <= most) cycle
            if (status(l) == poinsot_ok) status(l) = merge(poinsot_e_not_finite, poinsot_e_domain, &
               iand(bits, exponent_bits) == exponent_bits)
            own%scale(l) = 1
         end do
      end if
      do l = 1, lanes
         spread = max(spread, abs(shiftr(transfer(own%scale(l), bits), 52) - 1023))
      end do
      own%scaled = .true.
      own%wide = spread > near
      own%linear = class%sorted(1) <= 0
      do l = 1, lanes
         reciprocal(l) = 1/own%scale(l)  ! one division, and a rounding more for velocities
      end do
      do j = 1, 3
         do l = 1, lanes
            own%moments(l, j) = class%moments(j)*own%scale(l)
            own%inverse(l, j) = class%inverse(j)*reciprocal(l)
         end do
      end do
      call set_limits(own)
   end subroutine take_scale

   !> Bits of the smallest number that leaves every moment of a class one.
   pure integer(i8) function lowest_scale(class)
      type(body_class), intent(in) :: class
      integer :: e
      e = -range
      if (any(class%moments > 0)) then
         e = max(e, -range - exponent(minval(class%moments, class%moments > 0)))
      end if
      lowest_scale = shiftl(int(min(e, range) + 1023, i8), 52)
   end function lowest_scale

   !> And of the largest.
   pure integer(i8) function highest_scale(class)
      type(body_class), intent(in) :: class
      integer :: e
      e = range
      if (any(class%moments > 0)) e = min(e, range - exponent(maxval(class%moments)))
      highest_scale = shiftl(int(max(e, -range) + 1023, i8), 52)
   end function highest_scale

   !> Moments for each body. Those that no body has: POINSOT_E_DOMAIN; not finite:
   !> POINSOT_E_NOT_FINITE.
   pure subroutine take_moments(moments, nvec, own, status)
      real(dp), intent(in) :: moments(lanes, 3)   !! principal moments, any order, any unit
      integer, intent(in) :: nvec                 !! groups of lanes that hold bodies
      type(lane_moments), intent(inout) :: own
      integer, intent(inout) :: status(lanes)
      integer(i8) :: bits, most
      integer :: j, l
      own%scaled = .false.
      own%wide = .false.
      own%made = .false.
      most = 0
      do j = 1, 3
         !GCC$ ivdep
         do l = 1, lanes
            own%moments(l, j) = moments(l, j)
            most = max(most, iand(transfer(moments(l, j), bits), exponent_bits))
         end do
      end do
      own%scale = 1
      if (most == exponent_bits) call drop_not_finite(own, status)
      call accept_lanes(own%moments, nvec, status)
      own%linear = .not. all(own%moments > 0)
      if (own%linear) then
         own%inverse = 0
         where (own%moments > 0) own%inverse = 1/own%moments
      else
         own%inverse = 1/own%moments
      end if
      call set_limits(own)
   end subroutine take_moments

   !> Moments that are no numbers: those of a sphere, and a status.
   pure subroutine drop_not_finite(own, status)
      type(lane_moments), intent(inout) :: own
      integer, intent(inout) :: status(lanes)
      integer(i8) :: bits(3)
      integer :: l
      do l = 1, lanes
         bits = transfer(own%moments(l, :), bits)
         if (all(iand(bits, exponent_bits) /= exponent_bits)) cycle
         if (status(l) == poinsot_ok) status(l) = poinsot_e_not_finite
         own%moments(l, :) = 1
      end do
   end subroutine drop_not_finite

   !> Bounds on momenta: no body may turn faster than `fastest`.
   pure subroutine set_limits(own)
      type(lane_moments), intent(inout) :: own
      integer :: j, l
      do j = 1, 3
         !GCC$ ivdep
         do l = 1, lanes
            own%limit(l, j) = fastest*min(own%moments(l, j), heaviest)
         end do
      end do
      if (own%linear) where (.not. own%moments > 0) own%limit = massless
   end subroutine set_limits

   !> Is there a kernel of a method for bodies that all differ?
   pure logical function takes_moments(method)
      type(free_method), intent(in) :: method
      takes_moments = method%name == "exact" .or. method%name == "jacobi"
   end function takes_moments

   !> One step of a block. A lane whose status is not POINSOT_OK stands still; a lane that fails
   !> here gets its status and keeps its state.
   pure subroutine advance_own(own, method, class, h, y, q, status, nvec, carry)
      type(lane_moments), intent(inout) :: own
      type(free_method), intent(in) :: method                !! one that takes them
      type(body_class), intent(in) :: class                  !! of these bodies
      real(dp), intent(in) :: h                              !! step, either sign
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)    !! the state
      integer, intent(inout) :: status(lanes)
      integer, intent(in) :: nvec                            !! groups of lanes to work on
      real(dp), intent(inout), optional :: carry(lanes, 7)   !! compensated sums, if wanted
      real(dp) :: hl(lanes)
      if (.not. own%scaled) then
         hl = h
         if (.not. own%made) call make_constants(nvec, own%moments, own%constants)
         own%made = .true.
         call advance_each(own%constants, method%name == "jacobi", hl, y, q, status, nvec, carry)
      else if (own%wide .or. abs(h) > far) then
         call advance_wide(own, method, class, h, y, q, status, nvec, carry)
      else
         hl = h/own%scale
         call advance_lanes(method, class, hl, y, q, status, nvec, carry)
      end if
   end subroutine advance_own

   !> The same where scales are far from 1: of h/s only what is left of s without its power of two,
   !> which y is divided by and multiplied by again, without rounding.
   pure subroutine advance_wide(own, method, class, h, y, q, status, nvec, carry)
      type(lane_moments), intent(in) :: own
      type(free_method), intent(in) :: method
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      integer, intent(inout) :: status(lanes)
      integer, intent(in) :: nvec
      real(dp), intent(inout), optional :: carry(lanes, 7)
      integer :: power(lanes), l
      real(dp) :: hl(lanes)
      do l = 1, group*nvec
         power(l) = exponent(own%scale(l)) - 1
         if (status(l) /= poinsot_ok) then
            power(l) = 0
         else if (abs(power(l)) <= near .and. abs(h) <= far) then
            power(l) = 0
         else if (power(l) > 0 .and. exponent(maxval(abs(y(l, :)))) - power(l) < faint) then
            power(l) = 0
         end if
         hl(l) = h/scale(own%scale(l), -power(l))
         y(l, :) = scale(y(l, :), -power(l))
         if (present(carry)) carry(l, 1:3) = scale(carry(l, 1:3), -power(l))
      end do
      call advance_lanes(method, class, hl, y, q, status, nvec, carry)
      do l = 1, group*nvec
         y(l, :) = scale(y(l, :), power(l))
         if (present(carry)) carry(l, 1:3) = scale(carry(l, 1:3), power(l))
      end do
   end subroutine advance_wide

end module poinsot_free_lane_moments
