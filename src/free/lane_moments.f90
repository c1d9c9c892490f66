!> Moments of inertia of each body: a multiple of those of its class, or arbitrary (mathematics,
!> section 3).
!>
!> Bodies of one shape share the constants of their class: a body of moments s I moves over h like
!> one of moments I over h/s, with the same y. Bodies that all differ have constants for each lane.
module poinsot_free_lane_moments
   use poinsot_core_constants, only: exponent_bits
   use poinsot_core_kinds, only: dp, i8, group, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_not_finite
   use poinsot_body_class, only: body_class, fastest
   use poinsot_free_exact_lanes, only: lane_constants, accept_lanes, make_constants, &
      advance_each
   use poinsot_free_method, only: free_method, advance_lanes
   implicit none(type, external)
   private
   public :: lane_moments, take_scale, take_moments, complete_moments, common_limit, &
      speed_limit, takes_moments, advance_by_lane

   !> Of the bodies of a block.
   type :: lane_moments
      ! arrays first: vectors of a block then begin at a multiple of 64 bytes
      real(dp), dimension(lanes) :: scale         !! over the moments of the class; else 1
      real(dp), dimension(lanes, 3) :: moments    !! caller's axes; by a scale: complete_moments
      real(dp), dimension(lanes, 3) :: inverse    !! 0 for a zero moment; by complete_moments
      real(dp), dimension(lanes, 3) :: limit      !! momenta that no body may exceed; likewise
      type(lane_constants) :: constants           !! unless `scaled`, once a step has needed them
      real(dp) :: least                           !! the smallest moment of all
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

contains

   !> Moments that are those of a class times a number for each body, which stands in `own%scale`. A
   !> number that is not positive, or moments beyond the range of numbers: POINSOT_E_DOMAIN; not
   !> finite: POINSOT_E_NOT_FINITE. Such a lane gets the moments of its class.
   pure subroutine take_scale(class, nvec, by_lane, status)
      type(body_class), intent(in) :: class
      integer, intent(in) :: nvec                 !! groups of lanes that hold bodies
      type(lane_moments), intent(inout) :: by_lane
      integer, intent(inout) :: status(lanes)
      integer(i8) :: spread, smallest
      call measure_scales(nvec, by_lane%scale, spread, smallest)
      by_lane%scaled = .true.
      by_lane%linear = class%sorted(1) <= 0
      if (spread > near .or. .not. has_room(class)) then
         call judge_scales(class, nvec, by_lane%scale, status)
         call measure_scales(nvec, by_lane%scale, spread, smallest)
      end if
      by_lane%wide = spread > near
      by_lane%least = class%sorted(1)*transfer(smallest, by_lane%least)
   end subroutine take_scale

   !> The largest power of two, either sign, and the bits of the smallest. A number that is not
   !> positive and finite has a large power.
   pure subroutine measure_scales(nvec, scale, spread, smallest)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: scale(lanes)
      integer(i8), intent(out) :: spread, smallest
      integer(i8) :: bits, most
      integer :: l, n
      n = iand(group*nvec, not(group - 1)) ! says to the compiler that no lane is left over
      smallest = huge(smallest)
      most = 0
      !GCC$ ivdep
      do l = 1, n
         bits = transfer(scale(l), bits)
         smallest = min(smallest, bits)
         most = max(most, bits)
      end do
      spread = max(shiftr(most, 52) - 1023, 1023 - shifta(smallest, 52))
   end subroutine measure_scales

   !> Have the moments of a class room for scales that are near 1?
   pure logical function has_room(class)
      type(body_class), intent(in) :: class
      integer(i8), parameter :: most = shiftl(int(1023 + range - near - 1, i8), 52)
      integer(i8), parameter :: least = shiftl(int(1023 - range + near + 1, i8), 52)
      integer(i8) :: bits
      integer :: j
      has_room = .true.
      do j = 1, 3 ! one by one: of all three an array would be allocated
         bits = transfer(class%moments(j), bits)
         has_room = has_room .and. bits > least .and. bits < most
      end do
   end function has_room

   pure subroutine judge_scales(class, nvec, scale, status)
      type(body_class), intent(in) :: class
      integer, intent(in) :: nvec
      real(dp), intent(inout) :: scale(lanes)
      integer, intent(inout) :: status(lanes)
      integer(i8) :: least, most, bits
      integer :: l
      least = lowest_scale(class)
      most = highest_scale(class)
      do l = 1, group*nvec
         bits = transfer(scale(l), bits)
         if (bits >= least .and. bits <= most) cycle
         if (status(l) == poinsot_ok) status(l) = merge(poinsot_e_not_finite, poinsot_e_domain, &
            iand(bits, exponent_bits) == exponent_bits)
         scale(l) = 1
      end do
   end subroutine judge_scales

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

   !> Moments for each body, which stand in `own%moments`: principal ones, any order, any unit.
   !> Those that no body has: POINSOT_E_DOMAIN; not finite: POINSOT_E_NOT_FINITE.
   pure subroutine take_moments(nvec, by_lane, status)
      integer, intent(in) :: nvec                 !! groups of lanes that hold bodies
      type(lane_moments), intent(inout) :: by_lane
      integer, intent(inout) :: status(lanes)
      by_lane%scaled = .false.
      by_lane%wide = .false.
      by_lane%made = .false.
      call accept_lanes(by_lane%moments, nvec, status, by_lane%least)
      by_lane%linear = .not. by_lane%least > 0
   end subroutine take_moments

   !> What the step of a body with inertia about every axis does without: moments by a scale, their
   !> inverses, bounds on momenta.
   pure subroutine complete_moments(class, nvec, by_lane)
      type(body_class), intent(in) :: class       !! of these bodies
      integer, intent(in) :: nvec
      type(lane_moments), intent(inout) :: by_lane
      real(dp) :: reciprocal(lanes)
      integer :: j, n
      n = group*nvec
      if (by_lane%scaled) then
         reciprocal(:n) = 1/by_lane%scale(:n)  ! one division, and a rounding more for velocities
         do j = 1, 3
            by_lane%moments(:n, j) = class%moments(j)*by_lane%scale(:n)
            by_lane%inverse(:n, j) = class%inverse(j)*reciprocal(:n)
         end do
      else if (by_lane%linear) then
         by_lane%inverse(:n, :) = 0
         where (by_lane%moments(:n, :) > 0) by_lane%inverse(:n, :) = 1/by_lane%moments(:n, :)
      else
         by_lane%inverse(:n, :) = 1/by_lane%moments(:n, :)
      end if
      by_lane%limit(:n, :) = speed_limit(by_lane%moments(:n, :))
      if (by_lane%linear) where (.not. by_lane%moments(:n, :) > 0) by_lane%limit(:n, :) = massless
   end subroutine complete_moments

   !> A bound on momenta that no body of the block would exceed by turning too fast.
   pure real(dp) function common_limit(by_lane)
      type(lane_moments), intent(in) :: by_lane
      common_limit = speed_limit(by_lane%least)
   end function common_limit

   !> A bound on momentum about an axis with inertia: no body may turn faster than `fastest`.
   elemental real(dp) function speed_limit(moment)
      real(dp), intent(in) :: moment
      speed_limit = fastest*min(moment, heaviest)
   end function speed_limit

   !> Is there a kernel of a method for bodies that all differ?
   pure logical function takes_moments(method)
      type(free_method), intent(in) :: method
      takes_moments = method%name == "exact" .or. method%name == "jacobi"
   end function takes_moments

   !> Steps of a block. A lane whose status is not POINSOT_OK stands still; a lane that fails here
   !> gets its status and keeps its state of then.
   pure subroutine advance_by_lane(by_lane, method, class, h, steps, y, q, status, nvec, carry)
      type(lane_moments), intent(inout) :: by_lane
      type(free_method), intent(in) :: method                !! one that takes them
      type(body_class), intent(in) :: class                  !! of these bodies
      real(dp), intent(in) :: h                              !! step, either sign
      integer, intent(in) :: steps                           !! how many
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)    !! the state
      integer, intent(inout) :: status(lanes)
      integer, intent(in) :: nvec                            !! groups of lanes to work on
      real(dp), intent(inout), optional :: carry(lanes, 7)   !! compensated sums, if wanted
      real(dp) :: hl(lanes)
      integer :: k
      if (.not. by_lane%scaled) then
         hl = h
         if (.not. by_lane%made) call make_constants(nvec, by_lane%moments, by_lane%constants)
         by_lane%made = .true.
         call advance_each(by_lane%constants, method%name == "jacobi", hl, steps, y, q, status, &
                           nvec, carry)
      else if (by_lane%wide .or. abs(h) > far) then
         do k = 1, steps
            call advance_wide(by_lane, method, class, h, y, q, status, nvec, carry)
         end do
      else
         hl = h/by_lane%scale
         do k = 1, steps
            call advance_lanes(method, class, hl, y, q, status, nvec, carry)
         end do
      end if
   end subroutine advance_by_lane

   !> The same where scales are far from 1: of h/s only what is left of s without its power of two,
   !> which y is divided by and multiplied by again, without rounding.
   pure subroutine advance_wide(by_lane, method, class, h, y, q, status, nvec, carry)
      type(lane_moments), intent(in) :: by_lane
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
         power(l) = exponent(by_lane%scale(l)) - 1
         if (status(l) /= poinsot_ok) then
            power(l) = 0
         else if (abs(power(l)) <= near .and. abs(h) <= far) then
            power(l) = 0
         else if (power(l) > 0 .and. exponent(maxval(abs(y(l, :)))) - power(l) < faint) then
            power(l) = 0
         end if
         hl(l) = h/scale(by_lane%scale(l), -power(l))
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
