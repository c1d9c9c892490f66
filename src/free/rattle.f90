!> RATTLE for the rigid body in the matrices (P, Q): equation (11) of Vilmart (2013); McLachlan and
!> Scovel, J. Nonlinear Sci. 5, 233 (1995); Reich, Physica D 76, 375 (1994).
!>
!> With Q1 = Q0 W the first two lines of (11) say W D - D W^T = h y^, y^ = Q^T P - P^T Q after the
!> first kick: the six multipliers are eliminated, they are the symmetric part of what is left. This
!> Moser-Veselov equation is solved for the Cayley vector of W.
!>
!> (11) as printed divides by D. Nothing here does: only W D, D W^T and P = Q omega^ D are formed,
!> and the column of Q1 that a zero d_k leaves open follows from Q1^T Q1 = 1. So a flat body (one
!> d_k = 0) needs nothing special; of a linear body (two) the angle about its own axis is left open,
!> and W is taken without a turn about it. The condition P is tested by, Q^T P D^-1 skew, reads Q^T
!> P = omega^ D. For a flat body P has a zero column and does not determine Q.
!>
!> The torque comes from the caller at both ends: no effect is known here. Q1^T Q1 = 1 is restored
!> each step, first order in its defect: y goes through Q^T P twice a step, and a defect that stays
!> would make |y| drift linearly.
module poinsot_free_rattle
   use poinsot_core_constants, only: quarter_turn
   use poinsot_core_kinds, only: dp, group, groups, lanes
   use poinsot_core_lanes, only: smallest
   use poinsot_core_status, only: poinsot_ok, poinsot_e_step, poinsot_e_convergence
   use poinsot_body_class, only: body_class
   use poinsot_free_cayley_vector, only: find_cayley_vector
   use poinsot_free_exact_step, only: step_sizes
   use poinsot_rotation_conversions, only: to_matrix, from_matrix
   implicit none(type, external)
   private
   public :: rattle_increment, rattle_start, rattle_finish
   public :: second_moments, to_matrices, from_matrices, body_momentum

contains

   !> The diagonal of D in the caller's axes: d_k = (I_i + I_j - I_k)/2, equation (2). From
   !> differences, so that thin bodies keep their digits.
   pure function second_moments(class) result(d)
      type(body_class), intent(in) :: class !! of these bodies
      real(dp) :: d(3) !! integrals of x_k^2 over the body; 0 in the short direction of a flat one
      real(dp) :: i(3)
      i = class%moments(class%order)
      d(class%order(1)) = 0.5_dp*i(2) + 0.5_dp*(i(3) - i(1))
      d(class%order(2)) = 0.5_dp*(i(1) + (i(3) - i(2)))
      d(class%order(3)) = 0.5_dp*(i(1) - (i(3) - i(2)))
   end function second_moments

   ! Change of variables
   ! -----------------------------------------------------------------------------------------------

   !> (y, q) -> (P, Q): Q the matrix of q, P = Q (y/I)^ D. Symplectic: trace(P^T dQ) = y . xi for dQ
   !> = Q xi^.
   pure subroutine to_matrices(class, y, q, p, matrix)
      type(body_class), intent(in) :: class !! of these bodies
      !> angular momentum (body frame), attitude
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: p(lanes, 3, 3)              !! conjugate momenta
      real(dp), intent(out) :: matrix(lanes, 3, 3)         !! orthogonal, body to space
      real(dp) :: one(4)
      integer :: l
      do l = 1, lanes
         one = q(l, :)
         matrix(l, :, :) = to_matrix(one)
      end do
      call momenta(class, y, matrix, p)
   end subroutine to_matrices

   !> (P, Q) -> (y, q): y^ = Q^T P - P^T Q. The sign of q is free: its scalar part is not negative.
   pure subroutine from_matrices(p, matrix, y, q)
      real(dp), intent(in) :: p(lanes, 3, 3), matrix(lanes, 3, 3)
      real(dp), intent(out) :: y(lanes, 3), q(lanes, 4)
      real(dp) :: one(3, 3)
      integer :: l
      call body_momentum(p, matrix, y)
      do l = 1, lanes
         one = matrix(l, :, :)
         q(l, :) = from_matrix(one)
      end do
   end subroutine from_matrices

   !> y of (P, Q).
   pure subroutine body_momentum(p, matrix, y)
      real(dp), intent(in) :: p(lanes, 3, 3), matrix(lanes, 3, 3)
      real(dp), intent(out) :: y(lanes, 3)
      integer :: i, j, k
      do i = 1, 3
         j = 1 + mod(i, 3)
         k = 1 + mod(j, 3)
         y(:, i) = columns(matrix, p, k, j) - columns(matrix, p, j, k)
      end do
   end subroutine body_momentum

   !> Element (i, j) of A^T B.
   pure function columns(a, b, i, j) result(c)
      real(dp), intent(in) :: a(lanes, 3, 3), b(lanes, 3, 3)
      integer, intent(in) :: i, j
      real(dp) :: c(lanes)
      c = a(:, 1, i)*b(:, 1, j) + a(:, 2, i)*b(:, 2, j) + a(:, 3, i)*b(:, 3, j)
   end function columns

   !> P = Q omega^ D: column k is d_k omega x e_k, seen in space.
   pure subroutine momenta(class, y, matrix, p)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: y(lanes, 3), matrix(lanes, 3, 3)
      real(dp), intent(out) :: p(lanes, 3, 3)
      real(dp) :: d(3)
      integer :: i, j, k, row
      d = second_moments(class)
      do k = 1, 3
         i = 1 + mod(k, 3)
         j = 1 + mod(i, 3)
         do row = 1, 3
            p(:, row, k) = (matrix(:, row, i)*(y(:, j)*class%inverse(j)) &
                            - matrix(:, row, j)*(y(:, i)*class%inverse(i)))*d(k)
         end do
      end do
   end subroutine momenta

   ! Equation (11)
   ! -----------------------------------------------------------------------------------------------

   !> First and second line of (11), the torque given: (P0, Q0) -> (P_1/2, Q1). A lane that is not
   !> POINSOT_OK stands still. POINSOT_E_STEP for h |omega| > pi/2 after the kick,
   !> POINSOT_E_CONVERGENCE without a root below 90 degrees a step.
   pure subroutine rattle_start(class, h, torque, p, matrix, status)
      type(body_class), intent(in) :: class                !! of these bodies
      real(dp), intent(in) :: h                            !! step, either sign
      real(dp), intent(in) :: torque(lanes, 3)             !! body torque -rot(Q^T grad U) at Q0
      real(dp), intent(inout) :: p(lanes, 3, 3), matrix(lanes, 3, 3)
      integer, intent(inout) :: status(lanes)
      real(dp) :: y(lanes, 3), hl(lanes), even(lanes, 3, 3), axial(lanes, 3), v(lanes, 3, 3), &
         d(3), moved(lanes)
      integer :: row, j

      if (.not. abs(h) > 0) return
      d = second_moments(class)
      call body_momentum(p, matrix, y)
      hl = merge(h, 0.0_dp, status == poinsot_ok)
      do j = 1, 3
         y(:, j) = y(:, j) + 0.5_dp*hl*torque(:, j)
      end do
      call turn_of_step(class, hl, y, even, axial, status)
      call add_skew(even, axial, v)
      do row = 1, 3
         y = matrix(:, row, :)
         do j = 1, 3
            moved = y(:, 1)*v(:, 1, j) + y(:, 2)*v(:, 2, j) + y(:, 3)*v(:, 3, j)
            where (status == poinsot_ok)
               p(:, row, j) = moved/h*d(j)
               matrix(:, row, j) = y(:, j) + moved
            end where
         end do
      end do
      call make_orthogonal(status, matrix)
   end subroutine rattle_start

   !> Q (3 - Q^T Q)/2.
   pure subroutine make_orthogonal(status, matrix)
      integer, intent(in) :: status(lanes)
      real(dp), intent(inout) :: matrix(lanes, 3, 3)
      real(dp) :: excess(lanes, 3, 3), old(lanes, 3)
      integer :: i, j
      do j = 1, 3
         do i = 1, j
            excess(:, i, j) = 0.5_dp*columns(matrix, matrix, i, j)
            if (i == j) excess(:, i, j) = excess(:, i, j) - 0.5_dp
            where (status /= poinsot_ok) excess(:, i, j) = 0
            excess(:, j, i) = excess(:, i, j)
         end do
      end do
      do i = 1, 3
         old = matrix(:, i, :)
         do j = 1, 3
            matrix(:, i, j) = old(:, j) - (old(:, 1)*excess(:, 1, j) + old(:, 2)*excess(:, 2, &
               j) + old(:, 3)*excess(:, 3, j))
         end do
      end do
   end subroutine make_orthogonal

   !> Third line of (11), the torque given: P_1/2 -> P1, on the constraint Q^T P = omega^ D.
   pure subroutine rattle_finish(class, h, torque, p, matrix, status)
      type(body_class), intent(in) :: class                !! of these bodies
      real(dp), intent(in) :: h
      real(dp), intent(in) :: torque(lanes, 3)             !! body torque at Q1
      real(dp), intent(inout) :: p(lanes, 3, 3)
      real(dp), intent(in) :: matrix(lanes, 3, 3)          !! Q1
      integer, intent(in) :: status(lanes)                 !! of rattle_start
      real(dp) :: y(lanes, 3), new(lanes, 3, 3)
      integer :: i, j
      call body_momentum(p, matrix, y)
      y = y + (0.5_dp*h)*torque
      call momenta(class, y, matrix, new)
      do j = 1, 3
         do i = 1, 3
            p(:, i, j) = merge(new(:, i, j), p(:, i, j), status == poinsot_ok)
         end do
      end do
   end subroutine rattle_finish

   !> Increments of a free step on (y, q): the method `rattle` of the registry. The same map as
   !> `dmv2`, by matrices: dy^ = (D (W + W^T) - (W + W^T) D)/h, dq from W - W^T. Order 2. Status as
   !> in rattle_start.
   pure subroutine rattle_increment(nvec, class, terms, h, y, q, dy, dq, status)
      integer, intent(in) :: nvec                          !! groups of lanes to work on
      type(body_class), intent(in) :: class                !! of these bodies
      integer, intent(in) :: terms                         !! not used
      real(dp), intent(in) :: h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      real(dp) :: even(lanes, 3, 3), axial(lanes, 3), step(lanes)
      real(dp) :: hs(lanes), ys(lanes, 3), qs(lanes, 4)
      integer :: all_status(lanes), i, j, k, n
      associate (unused => terms)
      end associate
      n = group*nvec                                       ! lanes behind these stand still
      hs(:n) = h(:n)
      ys(:n, :) = y(:n, :)
      qs(:n, :) = q(:n, :)
      all_status(:n) = status(:n)
      hs(n + 1:) = 0
      ys(n + 1:, :) = 0
      qs(n + 1:, :) = 0
      all_status(n + 1:) = poinsot_ok
      call turn_of_step(class, hs, ys, even, axial, all_status)
      status(:n) = all_status(:n)
      step = merge(hs, 1.0_dp, abs(hs) > 0)
      do i = 1, 3
         j = 1 + mod(i, 3)
         k = 1 + mod(j, 3)
         dy(:, i) = (class%moments(j) - class%moments(k))*(2*even(:, j, k)/step)
      end do
      call quaternion_change(even, axial, qs, dq)
   end subroutine rattle_increment

   !> q o (rho - 1), rho the quaternion of W: 4 rho0^2 = 1 + trace W, 2 rho0 rho = axial. The turn
   !> is below 90 degrees.
   pure subroutine quaternion_change(even, axial, q, dq)
      real(dp), intent(in) :: even(lanes, 3, 3), axial(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dq(lanes, 4)
      real(dp) :: rho, r0, r1, r2, r3
      integer :: l
      !GCC$ ivdep
      do l = 1, lanes
         rho = 0.5_dp*sqrt(max(4 + (even(l, 1, 1) + even(l, 2, 2) + even(l, 3, 3)), 1.0_dp))
         r1 = axial(l, 1)*(0.5_dp/rho)
         r2 = axial(l, 2)*(0.5_dp/rho)
         r3 = axial(l, 3)*(0.5_dp/rho)
         r0 = -(r1*r1 + r2*r2 + r3*r3)/(1 + rho)
         dq(l, 1) = q(l, 1)*r0 - (q(l, 2)*r1 + q(l, 3)*r2 + q(l, 4)*r3)
         dq(l, 2) = q(l, 2)*r0 + q(l, 1)*r1 + (q(l, 3)*r3 - q(l, 4)*r2)
         dq(l, 3) = q(l, 3)*r0 + q(l, 1)*r2 + (q(l, 4)*r1 - q(l, 2)*r3)
         dq(l, 4) = q(l, 4)*r0 + q(l, 1)*r3 + (q(l, 2)*r2 - q(l, 3)*r1)
      end do
   end subroutine quaternion_change

   ! The Moser-Veselov equation
   ! -----------------------------------------------------------------------------------------------

   !> The orthogonal W with W D - D W^T = h y^, as W = 1 + even + axial^, even symmetric; W = 1 in a
   !> lane with h = 0. The axial part of the equation, times (1 + |e|^2)/4, is that of the Cayley
   !> vector e.
   pure subroutine turn_of_step(class, h, y, even, axial, status)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes), y(lanes, 3)
      real(dp), intent(out) :: even(lanes, 3, 3), axial(lanes, 3)
      integer, intent(inout) :: status(lanes)
      real(dp) :: w(lanes, 3), z(lanes, 3), e(lanes, 3), kappa(lanes, 3), ratio(3)
      real(dp), dimension(lanes) :: p, r, live, found, ee
      integer :: j, k

      call step_sizes(groups, class, h, y, w, p, r)
      live = merge(1.0_dp, 0.0_dp, p + r <= quarter_turn**2)
      if (smallest(groups, live) < 1) where (live < 1) status = poinsot_e_step
      p = merge(p + r, 0.0_dp, live > 0)
      do j = 1, 3
         z(:, j) = 0.5_dp*merge(w(:, j), 0.0_dp, live > 0)
      end do
      z(:, class%order) = class%parity*z
      call skew_ratios(class, ratio)
      kappa = spread(ratio, 1, lanes)
      call find_cayley_vector(groups, 1.0_dp, p, z, kappa, e, found)
      if (smallest(groups, found) < 1) where (found < 1 &
         .and. status == poinsot_ok) status = poinsot_e_convergence
      ee = e(:, 1)**2 + e(:, 2)**2 + e(:, 3)**2
      do j = 1, 3
         axial(:, j) = 2*e(:, j)/(1 + ee)
         do k = 1, 3
            even(:, k, j) = axial(:, j)*e(:, k)
         end do
      end do
      z = axial*e
      even(:, 1, 1) = -(z(:, 2) + z(:, 3))
      even(:, 2, 2) = -(z(:, 3) + z(:, 1))
      even(:, 3, 3) = -(z(:, 1) + z(:, 2))
   end subroutine turn_of_step

   !> (d_j - d_k)/I_i for cyclic (i, j, k); 0 where I_i = 0.
   pure subroutine skew_ratios(class, ratio)
      type(body_class), intent(in) :: class
      real(dp), intent(out) :: ratio(3)
      integer :: i, j, k
      ratio = 0
      do i = 1, 3
         j = 1 + mod(i, 3)
         k = 1 + mod(j, 3)
         if (class%moments(i) > 0) ratio(i) = (class%moments(k) - class%moments(j))/class%moments(i)
      end do
   end subroutine skew_ratios

   !> even + axial^.
   pure subroutine add_skew(even, axial, v)
      real(dp), intent(in) :: even(lanes, 3, 3), axial(lanes, 3)
      real(dp), intent(out) :: v(lanes, 3, 3)
      integer :: i, j, k
      v = even
      do i = 1, 3
         j = 1 + mod(i, 3)
         k = 1 + mod(j, 3)
         v(:, k, j) = v(:, k, j) + axial(:, i)
         v(:, j, k) = v(:, j, k) - axial(:, i)
      end do
   end subroutine add_skew

end module poinsot_free_rattle
