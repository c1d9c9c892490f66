!> The two splittings of the free body into flows that are plain rotations.
!>
!> `three-rotations`: R3(h/2) R2(h/2) R1(h) R2(h/2) R3(h/2), R_j the flow of y_j^2/(2 I_j).
!> `symmetric-rotation`: R(h/2) S(h) R(h/2), S a symmetric body, R what is left; the pair of axes
!> with the smallest |1/Ia - 1/Ib| is the symmetric one, so that the method is exact for any two
!> equal moments. Vilmart (2013), Algorithm 2 with the corrections of mathematics, section 1.
module poinsot_free_split_rotations
   use poinsot_core_constants, only: quarter_turn
   use poinsot_core_kinds, only: dp, i8, group, lanes
   use poinsot_core_lanes, only: largest
   use poinsot_core_status, only: poinsot_e_step
   use poinsot_body_class, only: body_class
   use poinsot_elliptic_elementary, only: sincos_block
   use poinsot_free_exact_step, only: step_sizes
   implicit none(type, external)
   private
   public :: three_rotations_increment, symmetric_rotation_increment


contains

   !> Increments of a step of the three-rotations splitting: order 2. POINSOT_E_STEP for h |omega| >
   !> pi/2, and where a part turns by more. The error grows like the largest moment over the
   !> smallest. A linear body turns exactly: turns about two of its axes would put momentum about
   !> the third, where there can be none.
   pure subroutine three_rotations_increment(nvec, class, terms, h, y, q, dy, dq, status)
      integer, intent(in) :: nvec                          !! groups of lanes to work on
      type(body_class), intent(in) :: class                !! of these bodies
      integer, intent(in) :: terms                         !! not used
      real(dp), intent(in) :: h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      integer, parameter :: axis(5) = [3, 2, 1, 2, 3]
      real(dp), parameter :: half_part(5) = [0.25_dp, 0.25_dp, 0.5_dp, 0.25_dp, 0.25_dp]
      real(dp) :: hl(lanes), half(lanes), factor
      integer :: k, j, l, n

      n = group*nvec
      hl(:n) = h(:n)
      call refuse_long_steps(nvec, class, y, hl, status)
      dy(:n, :) = 0
      dq(:n, :) = 0
      if (any(.not. class%inverse > 0)) then
         call turn_along_momentum(nvec, maxval(class%inverse), hl, y, q, dy, dq)
         return
      end if
      do k = 1, size(axis)
         j = axis(k)
         factor = half_part(k)
         !GCC$ ivdep
         do l = 1, group*nvec
            half(l) = factor*((y(l, j) + dy(l, j))*class%inverse(j)*hl(l))
         end do
         call refuse_wide_turns(nvec, half, status)
         call turn_about(nvec, j, half, y, q, dy, dq)
      end do
   end subroutine three_rotations_increment

   !> Increments of a step of the symmetric + rotation splitting: order 2. POINSOT_E_STEP for h
   !> |omega| > pi/2.
   pure subroutine symmetric_rotation_increment(nvec, class, terms, h, y, q, dy, dq, status)
      integer, intent(in) :: nvec                          !! groups of lanes to work on
      type(body_class), intent(in) :: class                !! of these bodies
      integer, intent(in) :: terms                         !! not used
      real(dp), intent(in) :: h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      real(dp) :: hl(lanes), half(lanes), rest, beta
      integer :: a, b, c, n

      n = group*nvec
      hl(:n) = h(:n)
      call refuse_long_steps(nvec, class, y, hl, status)
      dy(:n, :) = 0
      dq(:n, :) = 0
      call symmetric_pair(class%inverse, a, b, c)
      rest = 0.25_dp*gap_of_inverses(class, a, b)
      beta = 0.5_dp*gap_of_inverses(class, c, b)
      half(:n) = rest*(y(:n, a) + dy(:n, a))*hl(:n)
      call refuse_wide_turns(nvec, half, status)
      call turn_about(nvec, a, half, y, q, dy, dq)
      call turn_along_momentum(nvec, class%inverse(b), hl, y, q, dy, dq)
      half(:n) = beta*(y(:n, c) + dy(:n, c))*hl(:n)
      call refuse_wide_turns(nvec, half, status)
      call turn_about(nvec, c, half, y, q, dy, dq)
      half(:n) = rest*(y(:n, a) + dy(:n, a))*hl(:n)
      call refuse_wide_turns(nvec, half, status)
      call turn_about(nvec, a, half, y, q, dy, dq)
   end subroutine symmetric_rotation_increment

   !> 1/Ia - 1/Ib to all digits: of the reciprocals of moments nearly alike little would be left.
   pure real(dp) function gap_of_inverses(class, a, b) result(gap)
      type(body_class), intent(in) :: class
      integer, intent(in) :: a, b
      gap = class%inverse(a)
      if (class%moments(b) > 0) gap = gap*((class%moments(b) - class%moments(a))/class%moments(b))
      if (.not. class%moments(a) > 0) gap = -class%inverse(b)
   end function gap_of_inverses

   !> Cyclic axes (a, b, c) with the smallest |1/Ia - 1/Ib|; ties go to the pair with the smallest
   !> index of a first.
   pure subroutine symmetric_pair(inverse, a, b, c)
      real(dp), intent(in) :: inverse(3)
      integer, intent(out) :: a, b, c
      real(dp) :: gap(3)
      integer :: j
      gap = abs(inverse - cshift(inverse, 1))
      a = 1
      do j = 2, 3
         if (gap(j) < gap(a)) a = j
      end do
      b = 1 + mod(a, 3)
      c = 1 + mod(b, 3)
   end subroutine symmetric_pair

   !> Set h = 0 and POINSOT_E_STEP where h |omega| > pi/2.
   pure subroutine refuse_long_steps(nvec, class, y, h, status)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: y(lanes, 3)
      real(dp), intent(inout) :: h(lanes)
      integer, intent(inout) :: status(lanes)
      real(dp) :: w(lanes, 3), p(lanes), r(lanes)
      integer :: n
      n = group*nvec
      call step_sizes(nvec, class, h, y, w, p, r)
      p(:n) = p(:n) + r(:n)
      if (largest(nvec, p) <= quarter_turn**2) return
      where (p(:n) > quarter_turn**2)
         status(:n) = poinsot_e_step
         h(:n) = 0
      end where
   end subroutine refuse_long_steps

   !> Turn y + dy and q + dq about body axis j by twice the angle `half`: y clockwise, q
   !> counter-clockwise.
   pure subroutine turn_about(nvec, j, half, y, q, dy, dq)
      integer, intent(in) :: nvec
      integer, intent(in) :: j
      real(dp), intent(in) :: half(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(inout) :: dy(lanes, 3), dq(lanes, 4)
      real(dp) :: s(lanes), c(lanes), e, f, ya, yb, q0, qj, qa, qb
      integer :: l, a, b
      a = 1 + mod(j, 3)
      b = 1 + mod(a, 3)
      call sincos_block(half, s, c, nvec)
      !GCC$ ivdep
      do l = 1, group*nvec
         e = 2*s(l)*s(l)
         f = 2*s(l)*c(l)
         ya = y(l, a) + dy(l, a)
         yb = y(l, b) + dy(l, b)
         dy(l, a) = dy(l, a) + (f*yb - e*ya)
         dy(l, b) = dy(l, b) - (f*ya + e*yb)
         e = -(s(l)*s(l))/(1 + c(l))
         q0 = q(l, 1) + dq(l, 1)
         qj = q(l, 1 + j) + dq(l, 1 + j)
         qa = q(l, 1 + a) + dq(l, 1 + a)
         qb = q(l, 1 + b) + dq(l, 1 + b)
         dq(l, 1) = dq(l, 1) + (e*q0 - s(l)*qj)
         dq(l, 1 + j) = dq(l, 1 + j) + (e*qj + s(l)*q0)
         dq(l, 1 + a) = dq(l, 1 + a) + (e*qa + s(l)*qb)
         dq(l, 1 + b) = dq(l, 1 + b) + (e*qb - s(l)*qa)
      end do
   end subroutine turn_about

   !> Set the turn to 0 and POINSOT_E_STEP where it exceeds a quarter turn. The parts of a splitting
   !> may turn a thin body about its own axis by far more than it turns itself in the step: a part
   !> before leaves momentum there, and the moment is small.
   pure subroutine refuse_wide_turns(nvec, half, status)
      integer, intent(in) :: nvec
      real(dp), intent(inout) :: half(lanes)
      integer, intent(inout) :: status(lanes)
      integer :: n
      n = group*nvec
      if (.not. any(abs(half(:n)) > 0.5_dp*quarter_turn)) return
      where (abs(half(:n)) > 0.5_dp*quarter_turn)
         status(:n) = poinsot_e_step
         half(:n) = 0
      end where
   end subroutine refuse_wide_turns

   !> Turn q + dq by the rotation vector h (y + dy)/I: the free flow of a spherical body.
   pure subroutine turn_along_momentum(nvec, inverse, h, y, q, dy, dq)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: inverse, h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(in) :: dy(lanes, 3)
      real(dp), intent(inout) :: dq(lanes, 4)
      real(dp) :: half(lanes), s(lanes), c(lanes), v(lanes, 3), e, f, q0, q1, q2, q3
      integer(i8) :: some
      integer :: l
      !GCC$ ivdep
      do l = 1, group*nvec
         v(l, 1) = 0.5_dp*((y(l, 1) + dy(l, 1))*inverse*h(l))
         v(l, 2) = 0.5_dp*((y(l, 2) + dy(l, 2))*inverse*h(l))
         v(l, 3) = 0.5_dp*((y(l, 3) + dy(l, 3))*inverse*h(l))
         half(l) = sqrt(v(l, 1)**2 + v(l, 2)**2 + v(l, 3)**2)
      end do
      call sincos_block(half, s, c, nvec)
      !GCC$ ivdep
      do l = 1, group*nvec
         some = below(0.0_dp, half(l))
         f = choose(some, s(l), 1.0_dp)/choose(some, half(l), 1.0_dp)
         e = -(s(l)*s(l))/(1 + c(l))
         q0 = q(l, 1) + dq(l, 1)
         q1 = q(l, 2) + dq(l, 2)
         q2 = q(l, 3) + dq(l, 3)
         q3 = q(l, 4) + dq(l, 4)
         dq(l, 1) = dq(l, 1) + (e*q0 - f*(v(l, 1)*q1 + v(l, 2)*q2 + v(l, 3)*q3))
         dq(l, 2) = dq(l, 2) + (e*q1 + f*(q0*v(l, 1) + q2*v(l, 3) - q3*v(l, 2)))
         dq(l, 3) = dq(l, 3) + (e*q2 + f*(q0*v(l, 2) + q3*v(l, 1) - q1*v(l, 3)))
         dq(l, 4) = dq(l, 4) + (e*q3 + f*(q0*v(l, 3) + q1*v(l, 2) - q2*v(l, 1)))
      end do
   end subroutine turn_along_momentum

   include "../core/choose.inc"
   include "../core/below.inc"

end module poinsot_free_split_rotations
