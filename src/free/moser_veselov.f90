!> The discrete Moser-Veselov map, its preprocessing to any even order, and the implicit midpoint
!> rule.
!>
!> With modified moments It the step solves e_j = (1 + |e|^2) z_j - kappa_j e_{j+1} e_{j+2}, z =
!> (h/2) It^-1 y, for the Cayley vector e of the rotation (Vilmart 2013, Algorithm 3; Hairer and
!> Vilmart 2006); the midpoint rule leaves 1 + |e|^2 out. 1/It = (1 + c)/I with c = (P, theta P + (1
!> - theta) R, R) (mathematics, section 2). Differences of modified moments are formed as sums of
!> small terms, so that nearly linear, nearly symmetric and flat bodies lose no digits.
module poinsot_free_moser_veselov
   use poinsot_core_constants, only: quarter_turn
   use poinsot_core_kinds, only: dp, group, lanes
   use poinsot_core_lanes, only: smallest
   use poinsot_core_status, only: poinsot_ok, poinsot_e_step, poinsot_e_convergence
   use poinsot_body_class, only: body_class
   use poinsot_free_cayley_vector, only: find_cayley_vector
   use poinsot_free_exact_step, only: step_sizes
   use poinsot_free_series, only: correction
   implicit none(type, external)
   private
   public :: moser_veselov_increment, midpoint_increment

contains

   !> Increments of a step of the Moser-Veselov map with `terms` terms of the preprocessing series:
   !> order 2 terms + 2. POINSOT_E_STEP for h |omega| > pi/2, POINSOT_E_CONVERGENCE if there is no
   !> root below 90 degrees a step: that of the plain map ends at h |omega| = 1 for a sphere,
   !> between 1 and 1.5 for other bodies; with terms there is one up to pi/2.
   pure subroutine moser_veselov_increment(nvec, class, terms, h, y, q, dy, dq, status)
      integer, intent(in) :: nvec                       !! groups of lanes to work on
      type(body_class), intent(in) :: class
      integer, intent(in) :: terms                           !! 0 (plain) to 11
      real(dp), intent(in) :: h(lanes)                  !! step, either sign; 0: the lane stands
                                                        !! still
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      call cayley_increment(nvec, class, terms, 1.0_dp, h, y, q, dy, dq, status)
   end subroutine moser_veselov_increment

   !> Increments of a step of the implicit midpoint rule for (y, Q): order 2. Vilmart (2013), Remark
   !> 4.
   pure subroutine midpoint_increment(nvec, class, terms, h, y, q, dy, dq, status)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      integer, intent(in) :: terms                           !! not used
      real(dp), intent(in) :: h(lanes)
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      call cayley_increment(nvec, class, 0, 0.0_dp, h, y, q, dy, dq, status)
   end subroutine midpoint_increment

   !> Both maps: `quadratic` is the factor of |e|^2 in alpha = 1 + quadratic |e|^2. A lane that is
   !> too fast (live = 0) is carried along at rest.
   pure subroutine cayley_increment(nvec, class, terms, quadratic, h, y, q, dy, dq, status)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      integer, intent(in) :: terms
      real(dp), intent(in) :: quadratic, h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      real(dp) :: w(lanes, 3), z(lanes, 3), kappa(lanes, 3), e(lanes, 3)
      real(dp), dimension(lanes) :: p, r, ps, rs, size, loss, live, found
      integer :: l

      call step_sizes(nvec, class, h, y, w, p, r)
      !GCC$ ivdep
      do l = 1, group*nvec
         live(l) = merge(1.0_dp, 0.0_dp, p(l) + r(l) <= quarter_turn**2)
         p(l) = merge(p(l), 0.0_dp, live(l) > 0)
         r(l) = merge(r(l), 0.0_dp, live(l) > 0)
         size(l) = p(l) + r(l)
      end do
      call correction(nvec, terms, class, p, r, ps, rs)
      call coefficients(nvec, class, live, w, ps, rs, z, kappa, loss)
      call find_cayley_vector(nvec, quadratic, size, z, kappa, e, found)
      if (smallest(nvec, live) < 1) call set_failed(nvec, live, poinsot_e_step, status)
      if (smallest(nvec, found) < 1) call set_failed(nvec, found, poinsot_e_convergence, status)
      call apply(nvec, class, e, loss, y, q, dy, dq)
   end subroutine cayley_increment

   !> The status of lanes that are not well, if they have none.
   pure subroutine set_failed(nvec, well, code, status)
      integer, intent(in) :: nvec, code
      real(dp), intent(in) :: well(lanes)
      integer, intent(inout) :: status(lanes)
      integer :: n
      n = group*nvec
      where (well(:n) < 1 .and. status(:n) == poinsot_ok) status(:n) = code
   end subroutine set_failed

   !> z and kappa of the equation, and loss = 1 - It_2/It_3 for the momentum about the axis of the
   !> smallest moment.
   pure subroutine coefficients(nvec, class, live, w, ps, rs, z, kappa, loss)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: live(lanes), w(lanes, 3), ps(lanes), rs(lanes)
      real(dp), intent(out) :: z(lanes, 3), kappa(lanes, 3), loss(lanes)
      real(dp) :: one_p, one_r, one_c, d, ratio, i12
      integer :: l
      i12 = class%sorted(1)/class%sorted(2)
      !GCC$ ivdep
      do l = 1, group*nvec
         d = ps(l) - rs(l)
         one_p = ps(l)
         one_r = rs(l)
         one_c = one_r + class%theta*d
         z(l, 1) = 0.5_dp*live(l)*w(l, 1)*one_p
         z(l, 2) = 0.5_dp*live(l)*w(l, 2)*one_c
         z(l, 3) = 0.5_dp*live(l)*w(l, 3)*one_r
         ratio = 1/(one_p*one_r*one_c)
         kappa(l, 1) = one_p*one_p*ratio*(class%a(1)*one_r + class%g1*d)
         kappa(l, 2) = -one_c*one_c*ratio*(class%a(2)*one_p + i12*d)
         kappa(l, 3) = one_r*one_r*ratio*(class%a(3)*one_p + class%g3*d)
         loss(l) = (class%f1*one_r + class%theta*d)*one_p*one_r*ratio
      end do
   end subroutine coefficients

   !> Increments from the Cayley vector: y' = R(rho)^T y and q' = q o rho, rho = (1, e)/sqrt(1 +
   !> |e|^2); the momentum about the axis of the smallest moment by its own small increment.
   pure subroutine apply(nvec, class, e, loss, y, q, dy, dq)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: e(lanes, 3), loss(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      real(dp) :: e1, e2, e3, y1, y2, y3, u1, u2, u3, d2, d3, ee, k, root, half, r0, r1, r2, r3, &
         parity
      integer :: l, i1, i2, i3
      i1 = class%order(1)
      i2 = class%order(2)
      i3 = class%order(3)
      parity = class%parity
      !GCC$ ivdep
      do l = 1, group*nvec
         e1 = e(l, 1)
         e2 = e(l, 2)
         e3 = e(l, 3)
         ee = e1*e1 + e2*e2 + e3*e3
         k = 2/(1 + ee)
         y1 = parity*y(l, i1)
         y2 = parity*y(l, i2)
         y3 = parity*y(l, i3)
         u1 = k*((e2*y3 - e3*y2) - y1)
         u2 = k*((e3*y1 - e1*y3) - y2)
         u3 = k*((e1*y2 - e2*y1) - y3)
         d2 = e3*u1 - e1*u3
         d3 = e1*u2 - e2*u1
         dy(l, i1) = -parity*(e2*loss(l)*(2*y3 + d3))
         dy(l, i2) = parity*d2
         dy(l, i3) = parity*d3
         root = sqrt(1 + ee)
         half = 1/root
         r0 = -ee*half/(1 + root)
         r1 = parity*e1*half
         r2 = parity*e2*half
         r3 = parity*e3*half
         dq(l, 1) = q(l, 1)*r0 - q(l, 1 + i1)*r1 - q(l, 1 + i2)*r2 - q(l, 1 + i3)*r3
         dq(l, 1 + i1) = q(l, 1 + i1)*r0 + q(l, 1)*r1 + parity*(q(l, 1 + i2)*r3 - q(l, 1 + i3)*r2)
         dq(l, 1 + i2) = q(l, 1 + i2)*r0 + q(l, 1)*r2 + parity*(q(l, 1 + i3)*r1 - q(l, 1 + i1)*r3)
         dq(l, 1 + i3) = q(l, 1 + i3)*r0 + q(l, 1)*r3 + parity*(q(l, 1 + i1)*r2 - q(l, 1 + i2)*r1)
      end do
   end subroutine apply

end module poinsot_free_moser_veselov
