!> The judge for bodies no data file knows: a Taylor series of high order in quadruple precision,
!> for a free body, a gyrostat, or a body in a field with one direction fixed in space (uniform
!> gravity, dipole, gravity gradient, aligning spring). It shares nothing with the library but the
!> kinds.
!>
!> The equations are quadratic, so the coefficients follow from Cauchy products:
!> y' = y x w + g x (r + K g),  w = J^-1 (y - s),  g' = g x w,  q' = (1/2) q o (0, w),  g = Q^T k.
module test_oracle_taylor
   use poinsot_core_kinds, only: dp, qp
   use test_oracle_algebra, only: rotate_back
   implicit none(type, external)
   private
   public :: taylor_problem, taylor_report, free_problem, top_problem
   public :: taylor_flow, taylor_verified, taylor_series, conditioning, max_order

   integer, parameter :: max_order = 44
   real(qp), parameter :: default_tolerance = 1.0e-31_qp

   !> What turns, and in what field. U = r.g + g.K g/2 with g = Q^T k.
   type :: taylor_problem
      real(qp) :: inverse(3) = 0         !! 1/I, 0 for a zero moment
      real(qp) :: spin(3) = 0            !! s: angular momentum of internal rotors, body frame
      logical :: field = .false.         !! is there a field at all
      real(qp) :: centre(3) = 0          !! r: the linear part of the potential, body frame
      real(qp) :: stiffness(3, 3) = 0    !! K: the quadratic part, symmetric, body frame
      real(qp) :: direction(3) = 0       !! k, fixed frame
   end type taylor_problem

   !> How far the answer can be trusted.
   type :: taylor_report
      integer :: steps = 0
      real(qp) :: truncation = 0         !! sum of the last terms left out, relative to |y| and |w|
      real(qp) :: energy = 0             !! relative defect of H + U
      real(qp) :: momentum = 0           !! relative defect of |y| (free) or of k.Qy (field)
      real(qp) :: norm = 0               !! defect of |q|
      real(qp) :: difference = 0         !! taylor_verified: to another run
      logical :: finished = .false.      !! the end time was reached
   end type taylor_report

contains

   !> A free body from its moments; a zero moment counts as 1/I = 0.
   pure function free_problem(moments) result(problem)
      real(dp), intent(in) :: moments(3)
      type(taylor_problem) :: problem
      integer :: j
      do j = 1, 3
         if (moments(j) /= 0) problem%inverse(j) = 1/real(moments(j), qp)
      end do
   end function free_problem

   !> A body on a fixed point: U = gamma.centre, gamma = Q^T direction.
   pure function top_problem(moments, centre, direction) result(problem)
      real(dp), intent(in) :: moments(3), centre(3), direction(3)
      type(taylor_problem) :: problem
      problem = free_problem(moments)
      problem%field = .true.
      problem%centre = centre
      problem%direction = direction
   end function top_problem

   !> Carry (y, q) over the time t (either sign).
   subroutine taylor_flow(problem, t, y, q, report, tolerance, order)
      type(taylor_problem), intent(in) :: problem
      real(qp), intent(in) :: t
      real(qp), intent(inout) :: y(3), q(4)
      type(taylor_report), intent(out) :: report
      real(qp), intent(in), optional :: tolerance !! relative truncation of a step, default 1e-31
      integer, intent(in), optional :: order      !! of the series; by default from the tolerance
      integer, parameter :: max_steps = 200000
      type(taylor_problem) :: unit
      real(qp) :: cy(0:max_order, 3), cq(0:max_order, 4), done, step, tol, energy0, momentum0, left
      integer :: n
      tol = default_tolerance
      if (present(tolerance)) tol = tolerance
      n = nint(-2.45_qp*log10(tol)/2) ! near the least work: step ~ radius tol**(1/n), work ~ n**2
      if (present(order)) n = order
      n = max(6, min(n, max_order))
      energy0 = energy(problem, y, q)
      momentum0 = momentum(problem, y, q)
      ! the time t becomes 1: powers of tiny rates would underflow
      unit = problem
      unit%inverse = problem%inverse*t
      unit%centre = problem%centre*t
      unit%stiffness = problem%stiffness*t
      done = 0
      do while (report%steps < max_steps)
         left = 1 - done
         if (left == 0) exit
         call taylor_series(unit, n, y, q, cy, cq)
         call choose_step(unit, n, cy, cq, tol, left, step, report%truncation)
         y = horner(cy(0:n, 1:3), step)
         q = horner(cq(0:n, 1:4), step)
         done = done + step
         if (step == left) done = 1
         report%steps = report%steps + 1
      end do
      report%finished = done == 1
      report%energy = relative(energy(problem, y, q) - energy0, energy0)
      report%momentum = relative(momentum(problem, y, q) - momentum0, momentum0)
      report%norm = abs(sqrt(sum(q*q)) - 1)
   end subroutine taylor_flow

   !> The same twice, with another order and other steps; `report%difference` is how far the two lie
   !> apart.
   subroutine taylor_verified(problem, t, y, q, report)
      type(taylor_problem), intent(in) :: problem
      real(qp), intent(in) :: t
      real(qp), intent(inout) :: y(3), q(4)
      type(taylor_report), intent(out) :: report
      type(taylor_report) :: other
      real(qp) :: y2(3), q2(4), scale
      y2 = y
      q2 = q
      call taylor_flow(problem, t, y, q, report)
      call taylor_flow(problem, t, y2, q2, other, tolerance=1.0e-33_qp, order=31)
      scale = sqrt(sum(y*y))
      report%difference = sqrt(sum((q - q2)**2))
      if (scale > 0) report%difference = max(report%difference, sqrt(sum((y - y2)**2))/scale)
      report%finished = report%finished .and. other%finished
   end subroutine taylor_verified

   !> How far the result moves when each input moves by one part (as in test/data): sums over the
   !> inputs of |d y(h)|/|y| and |d q(h)|, at least 1; with and without the moments among the
   !> inputs.
   subroutine conditioning(moments, y0, h, cond_y, cond_q, state_y, state_q)
      real(dp), intent(in) :: moments(3), y0(3), h
      real(dp), intent(out) :: cond_y, cond_q, state_y, state_q
      real(qp), parameter :: part = 1.0e-7_qp, tol = 1.0e-15_qp
      type(taylor_problem) :: problem
      type(taylor_report) :: report
      real(qp) :: y(3), q(4), yj(3), qj(4), start(3), scale, time
      real(dp) :: dy, dq
      integer :: j, k
      problem = free_problem(moments)
      call from_rest_attitude(problem, real(h, qp), real(y0, qp), y, q, report, tol)
      scale = max(sqrt(sum(y*y)), tiny(1.0_qp))
      state_y = 0
      state_q = 0
      cond_y = 0
      cond_q = 0
      do j = 1, 7
         problem = free_problem(moments)
         start = y0
         time = h
         k = 1 + mod(j - 1, 3)
         if (j == 7) then
            time = h*(1 + part)
         else if (j > 3) then
            start(k) = y0(k)*(1 + part)
         else
            problem%inverse(k) = problem%inverse(k)/(1 + part)
         end if
         call from_rest_attitude(problem, time, start, yj, qj, report, tol)
         dy = real(sqrt(sum((yj - y)**2))/(part*scale), dp)
         dq = real(sqrt(sum((qj - q)**2))/part, dp)
         cond_y = cond_y + dy
         cond_q = cond_q + dq
         if (j > 3) state_y = state_y + dy
         if (j > 3) state_q = state_q + dq
      end do
      cond_y = max(1.0_dp, cond_y)
      cond_q = max(1.0_dp, cond_q)
      state_y = max(1.0_dp, state_y)
      state_q = max(1.0_dp, state_q)
   end subroutine conditioning

   !> One flow from the attitude 1.
   subroutine from_rest_attitude(problem, t, y0, y, q, report, tol)
      type(taylor_problem), intent(in) :: problem
      real(qp), intent(in) :: t, tol
      real(qp), intent(in) :: y0(3)
      real(qp), intent(out) :: y(3), q(4)
      type(taylor_report), intent(out) :: report
      y = y0
      q = [1, 0, 0, 0]
      call taylor_flow(problem, t, y, q, report, tolerance=tol)
   end subroutine from_rest_attitude

   !> Taylor coefficients of y and q in time, up to order n <= max_order.
   pure subroutine taylor_series(problem, n, y, q, cy, cq)
      type(taylor_problem), intent(in) :: problem
      integer, intent(in) :: n
      real(qp), intent(in) :: y(3), q(4)
      real(qp), intent(out) :: cy(0:max_order, 3), cq(0:max_order, 4)
      real(qp) :: w(0:max_order, 3), g(0:max_order, 3), f(0:max_order, 3), next(3)
      integer :: k
      cy(0, :) = y
      cq(0, :) = q
      if (problem%field) g(0, :) = rotate_back(q, problem%direction)
      do k = 0, n - 1
         w(k, :) = problem%inverse*cy(k, :)
         if (k == 0) w(k, :) = problem%inverse*(cy(k, :) - problem%spin)
         next = euler(problem, k, cy, w)
         if (problem%field) then
            f(k, :) = matmul(problem%stiffness, g(k, :))
            if (k == 0) f(k, :) = f(k, :) + problem%centre
            next = next + cauchy_cross(k, g, f)
            g(k + 1, :) = cauchy_cross(k, g, w)/(k + 1)
         end if
         cy(k + 1, :) = next/(k + 1)
         cq(k + 1, :) = cauchy_turn(k, cq, w)/(2*(k + 1))
      end do
   end subroutine taylor_series

   !> Coefficient k of y x w. Without a spin the differences of 1/I stand in front, so nothing
   !> cancels twice.
   pure function euler(problem, k, y, w) result(c)
      type(taylor_problem), intent(in) :: problem
      integer, intent(in) :: k
      real(qp), intent(in) :: y(0:max_order, 3), w(0:max_order, 3)
      real(qp) :: c(3)
      if (any(problem%spin /= 0)) then
         c = cauchy_cross(k, y, w)
      else
         c(1) = (problem%inverse(3) - problem%inverse(2))*cauchy(k, y(:, 2), y(:, 3))
         c(2) = (problem%inverse(1) - problem%inverse(3))*cauchy(k, y(:, 3), y(:, 1))
         c(3) = (problem%inverse(2) - problem%inverse(1))*cauchy(k, y(:, 1), y(:, 2))
      end if
   end function euler

   pure real(qp) function cauchy(k, a, b)
      integer, intent(in) :: k
      real(qp), intent(in) :: a(0:max_order), b(0:max_order)
      integer :: j
      cauchy = 0
      do j = 0, k
         cauchy = cauchy + a(j)*b(k - j)
      end do
   end function cauchy

   pure function cauchy_cross(k, a, b) result(c)
      integer, intent(in) :: k
      real(qp), intent(in) :: a(0:max_order, 3), b(0:max_order, 3)
      real(qp) :: c(3)
      c(1) = cauchy(k, a(:, 2), b(:, 3)) - cauchy(k, a(:, 3), b(:, 2))
      c(2) = cauchy(k, a(:, 3), b(:, 1)) - cauchy(k, a(:, 1), b(:, 3))
      c(3) = cauchy(k, a(:, 1), b(:, 2)) - cauchy(k, a(:, 2), b(:, 1))
   end function cauchy_cross

   !> Coefficient k of q o (0, w).
   pure function cauchy_turn(k, q, w) result(c)
      integer, intent(in) :: k
      real(qp), intent(in) :: q(0:max_order, 4), w(0:max_order, 3)
      real(qp) :: c(4)
      c(1) = -cauchy(k, q(:, 2), w(:, 1)) - cauchy(k, q(:, 3), w(:, 2)) &
         - cauchy(k, q(:, 4), w(:, 3))
      c(2) = cauchy(k, q(:, 1), w(:, 1)) + cauchy(k, q(:, 3), w(:, 3)) - cauchy(k, q(:, 4), w(:, 2))
      c(3) = cauchy(k, q(:, 1), w(:, 2)) + cauchy(k, q(:, 4), w(:, 1)) - cauchy(k, q(:, 2), w(:, 3))
      c(4) = cauchy(k, q(:, 1), w(:, 3)) + cauchy(k, q(:, 2), w(:, 2)) - cauchy(k, q(:, 3), w(:, 1))
   end function cauchy_turn

   !> The longest step whose last two terms stay below the tolerance, for y, for the rates w and for
   !> q: a slow component of a nearly linear body turns fast, so y alone would not do.
   pure subroutine choose_step(problem, n, cy, cq, tol, left, step, truncation)
      type(taylor_problem), intent(in) :: problem
      integer, intent(in) :: n
      real(qp), intent(in) :: cy(0:max_order, 3), cq(0:max_order, 4), tol, left
      real(qp), intent(out) :: step
      real(qp), intent(inout) :: truncation
      real(qp) :: size(n - 1:n), longest, rates(3)
      integer :: k
      longest = abs(left)
      rates = problem%inverse*(cy(0, :) - problem%spin)
      do k = n - 1, n
         size(k) = max(ratio(cy(k, :), cy(0, :)), sqrt(sum(cq(k, :)**2)))
         size(k) = max(size(k), ratio(problem%inverse*cy(k, :), rates))
         if (size(k) > 0) longest = min(longest, (tol/size(k))**(1.0_qp/k))
      end do
      step = sign(longest, left)
      if (longest == abs(left)) step = left
      truncation = truncation + size(n)*longest**n
   end subroutine choose_step

   !> |a|/|b|; without a b, |a| itself.
   pure real(qp) function ratio(a, b)
      real(qp), intent(in) :: a(:), b(:)
      ratio = sqrt(sum(a*a))
      if (any(b /= 0)) ratio = ratio/sqrt(sum(b*b))
   end function ratio

   pure function horner(c, x) result(p)
      real(qp), intent(in) :: c(:, :), x
      real(qp) :: p(size(c, 2))
      integer :: k
      p = c(size(c, 1), :)
      do k = size(c, 1) - 1, 1, -1
         p = p*x + c(k, :)
      end do
   end function horner

   pure real(qp) function energy(problem, y, q)
      type(taylor_problem), intent(in) :: problem
      real(qp), intent(in) :: y(3), q(4)
      real(qp) :: g(3)
      energy = sum(problem%inverse*(y - problem%spin)**2)/2
      if (.not. problem%field) return
      g = rotate_back(q, problem%direction)
      energy = energy + dot_product(problem%centre + matmul(problem%stiffness, g)/2, g)
   end function energy

   !> |y| of a free body; the component of Qy along the field otherwise.
   pure real(qp) function momentum(problem, y, q)
      type(taylor_problem), intent(in) :: problem
      real(qp), intent(in) :: y(3), q(4)
      if (problem%field) then
         momentum = dot_product(y, rotate_back(q, problem%direction))
      else
         momentum = sqrt(sum(y*y))
      end if
   end function momentum

   pure real(qp) function relative(defect, of)
      real(qp), intent(in) :: defect, of
      relative = abs(defect)
      if (of /= 0) relative = abs(defect/of)
   end function relative

end module test_oracle_taylor
