!> The approximate methods once more, in plain scalar quadruple precision: Moser-Veselov with the
!> modified moments of the review's Table 1 (as printed) and of test/data/dmv_coefficients.txt (to
!> order 24), implicit midpoint, three rotations, symmetric body and rotation. The library uses
!> another form of the series; the two must agree.
module test_oracle_dmv
   use poinsot_core_kinds, only: dp, qp
   use test_oracle_algebra, only: cross, quaternion_product
   use test_oracle_data, only: dmv_term
   use test_oracle_properties, only: plain_map
   use test_oracle_taylor, only: free_problem, taylor_problem, &
      taylor_report, taylor_flow, taylor_series, max_order
   implicit none(type, external)
   private
   public :: table_1, rational_coefficients, modified_inverses, truncated_inverses, exact_inverses
   public :: reference_map, make_reference, inverse_moments

   !> Any method by its name in the library, in quadruple precision.
   type, extends(plain_map) :: reference_map
      character(20) :: name = ""
      integer :: order = 0                       !! of dmv; 0 for the others
      real(qp) :: moments(3) = 1, inverse(3) = 1
   contains
      procedure :: apply => apply_reference
   end type reference_map

contains

   !> A reference map. Names: dmv2 .. dmv24, midpoint, three-rotations, symmetric-rotation, exact.
   subroutine make_reference(name, moments, map)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3)
      type(reference_map), intent(out) :: map
      map%name = name
      map%moments = moments
      map%inverse = inverse_moments(moments)
      if (name(1:3) == "dmv") read (name(4:), *) map%order
   end subroutine make_reference

   !> 1/I, 0 for a zero moment.
   pure function inverse_moments(moments) result(inverse)
      real(dp), intent(in) :: moments(3)
      real(qp) :: inverse(3)
      inverse = 0
      where (moments /= 0) inverse = 1/real(moments, qp)
   end function inverse_moments

   !> One step of the named method.
   subroutine apply_reference(self, h, y, q, ok)
      class(reference_map), intent(in) :: self
      real(qp), intent(in) :: h
      real(qp), intent(inout) :: y(3), q(4)
      logical, intent(out) :: ok
      type(taylor_problem) :: problem
      type(taylor_report) :: report
      real(qp) :: modified(3)
      ok = .true.
      select case (self%name)
      case ("three-rotations")
         if (any(.not. self%inverse > 0)) then ! a linear body turns about its momentum
            problem%inverse = self%inverse
            call taylor_flow(problem, h, y, q, report)
            ok = report%finished
            return
         end if
         call single_rotation(3, h/2, self%inverse(3), y, q)
         call single_rotation(2, h/2, self%inverse(2), y, q)
         call single_rotation(1, h, self%inverse(1), y, q)
         call single_rotation(2, h/2, self%inverse(2), y, q)
         call single_rotation(3, h/2, self%inverse(3), y, q)
      case ("symmetric-rotation")
         call symmetric_rotation(self%inverse, h, y, q)
      case ("midpoint")
         call implicit_step(self%inverse, h, .false., y, q, ok)
      case ("exact", "jacobi")
         problem%inverse = self%inverse
         call taylor_flow(problem, h, y, q, report)
         ok = report%finished
      case default
         call truncated_inverses(self%moments, self%order, h, y, modified)
         call implicit_step(modified, h, .true., y, q, ok)
      end select
   end subroutine apply_reference

   !> The flow of y_j**2/(2 I_j).
   pure subroutine single_rotation(j, h, inverse, y, q)
      integer, intent(in) :: j
      real(qp), intent(in) :: h, inverse
      real(qp), intent(inout) :: y(3), q(4)
      call turn_axis(j, h*y(j)*inverse, y, q)
   end subroutine single_rotation

   !> The frame turns by `angle` about its own axis j: y' = R(-angle) y, q' = q o (cos, sin).
   pure subroutine turn_axis(j, angle, y, q)
      integer, intent(in) :: j
      real(qp), intent(in) :: angle
      real(qp), intent(inout) :: y(3), q(4)
      real(qp) :: c, s, r(4), y2, y3
      integer :: k, l
      k = 1 + mod(j, 3)
      l = 1 + mod(k, 3)
      c = cos(angle)
      s = sin(angle)
      y2 = c*y(k) + s*y(l)
      y3 = -s*y(k) + c*y(l)
      y(k) = y2
      y(l) = y3
      r = 0
      r(1) = cos(angle/2)
      r(1 + j) = sin(angle/2)
      q = quaternion_product(q, r)
   end subroutine turn_axis

   !> Algorithm 2 of the review, corrected. The labels (a, b, c) are a cyclic order of the axes, a
   !> and b the pair with the smallest |1/Ia - 1/Ib| (ties: the first of 12, 23, 31): R = (1/Ia -
   !> 1/Ib) ya**2/2, S = ((ya**2 + yb**2)/Ib + yc**2/Ic)/2.
   pure subroutine symmetric_rotation(inverse, h, y, q)
      real(qp), intent(in) :: inverse(3), h
      real(qp), intent(inout) :: y(3), q(4)
      real(qp) :: total, r(4), angle
      integer :: a, b, c
      a = minloc(abs(inverse - cshift(inverse, 1)), dim=1)
      b = 1 + mod(a, 3)
      c = 1 + mod(b, 3)
      call turn_axis(a, (inverse(a) - inverse(b))*y(a)*h/2, y, q)
      total = sqrt(sum(y*y))
      angle = h*inverse(b)*total
      r = [cos(angle/2), 0.0_qp, 0.0_qp, 0.0_qp]
      if (total > 0) r(2:4) = y/total*sin(angle/2)
      q = quaternion_product(q, r)
      call turn_axis(c, (inverse(c) - inverse(b))*y(c)*h, y, q)
      call turn_axis(a, (inverse(a) - inverse(b))*y(a)*h/2, y, q)
   end subroutine symmetric_rotation

   !> Moser-Veselov (`factor`) or the midpoint rule: Y = alpha y + (h/2) Y x M Y by Newton, from the
   !> fixed point.
   subroutine implicit_step(inverse, h, factor, y, q, ok)
      real(qp), intent(in) :: inverse(3), h
      logical, intent(in) :: factor
      real(qp), intent(inout) :: y(3), q(4)
      logical, intent(out) :: ok
      real(qp) :: mean(3), residual(3), slope(3, 3), change(3), alpha, e(3), size, last, moved
      integer :: i, j
      size = sqrt(sum(y*y))
      ok = .true.
      if (size == 0) return
      mean = y
      last = huge(last)
      do i = 1, 60
         e = h/2*inverse*mean
         alpha = 1
         if (factor) alpha = 1 + sum(e*e)
         residual = mean - alpha*y - cross(mean, e)
         do j = 1, 3
            slope(:, j) = -cross(unit(j), e) - cross(mean, h/2*inverse(j)*unit(j)) + unit(j)
            if (factor) slope(:, j) = slope(:, j) - h*inverse(j)*e(j)*y
         end do
         change = solve(slope, residual)
         mean = mean - change
         moved = sqrt(sum(change**2))
         if (moved < 1.0e-33_qp*size .or. (i > 8 .and. moved >= last)) exit
         last = moved
      end do
      e = h/2*inverse*mean
      ok = moved < 1.0e-28_qp*size .and. sum(e*e) < 1
      if (.not. ok) return
      alpha = 1 + sum(e*e)
      q = quaternion_product(q, [1.0_qp, e])/sqrt(alpha)
      if (.not. factor) alpha = 1
      y = y + 2*cross(mean, e)/alpha
   end subroutine implicit_step

   pure function unit(j) result(v)
      integer, intent(in) :: j
      real(qp) :: v(3)
      v = 0
      v(j) = 1
   end function unit

   !> a x = b by Cramer's rule; columns of a.
   pure function solve(a, b) result(x)
      real(qp), intent(in) :: a(3, 3), b(3)
      real(qp) :: x(3), d
      d = dot_product(a(:, 1), cross(a(:, 2), a(:, 3)))
      x(1) = dot_product(b, cross(a(:, 2), a(:, 3)))/d
      x(2) = dot_product(a(:, 1), cross(b, a(:, 3)))/d
      x(3) = dot_product(a(:, 1), cross(a(:, 2), b))/d
   end function solve

   !> 1/It_j = (1/I_j)(1 + h**2 s3 + h**4 s5 + ...) + h**2 t3 + h**4 t5 + ..., up to the order asked
   !> for.
   pure subroutine modified_inverses(terms, inverse, order, h, y, modified)
      type(dmv_term), intent(in) :: terms(:)
      real(qp), intent(in) :: inverse(3), h, y(3)
      integer, intent(in) :: order !! 2 gives the plain moments
      real(qp), intent(out) :: modified(3)
      real(qp) :: s(3:23), t(3:23), casimir, energy
      integer :: k
      modified = inverse
      if (order <= 2) return
      casimir = sum(y*y)/2
      energy = sum(inverse*y*y)/2
      call rational_coefficients(terms, inverse, casimir, energy, order - 1, s, t)
      do k = 3, order - 1, 2
         modified = modified + h**(k - 1)*(inverse*s(k) + t(k))
      end do
   end subroutine modified_inverses

   !> s_k and t_k, odd k from 3 to `last`, from the rational polynomials in e1, e2, e3.
   pure subroutine rational_coefficients(terms, inverse, casimir, energy, last, s, t)
      type(dmv_term), intent(in) :: terms(:)
      real(qp), intent(in) :: inverse(3), casimir, energy
      integer, intent(in) :: last
      real(qp), intent(out) :: s(3:23), t(3:23)
      real(qp) :: e(3), term
      integer :: i
      e(1) = sum(inverse)
      e(2) = inverse(1)*inverse(2) + inverse(2)*inverse(3) + inverse(3)*inverse(1)
      e(3) = product(inverse)
      s = 0
      t = 0
      do i = 1, size(terms)
         if (terms(i)%k > last) cycle
         term = terms(i)%value*casimir**terms(i)%c*energy**terms(i)%h
         term = term*e(1)**terms(i)%e(1)*e(2)**terms(i)%e(2)*e(3)**terms(i)%e(3)
         if (terms(i)%letter == "s") then
            s(terms(i)%k) = s(terms(i)%k) + term
         else
            t(terms(i)%k) = t(terms(i)%k) + term
         end if
      end do
   end subroutine rational_coefficients

   !> s3, t3, s5, t5, s7, t7 as Table 1 of the review (Vilmart 2013) prints them.
   pure subroutine table_1(moments, c, h, s, t)
      real(qp), intent(in) :: moments(3)
      real(qp), intent(in) :: c, h              !! Casimir |y|**2/2 and energy
      real(qp), intent(out) :: s(3:7), t(3:7)   !! the odd places count
      real(qp) :: d
      d = product(moments)
      s = 0
      t = 0
      s(3) = -sigma(-1)/3*h + sigma(1)/(6*d)*c
      t(3) = sigma(1)/(6*d)*h - 1/(3*d)*c
      s(5) = (3*sigma(1) + 2*d*sigma(-2))/(60*d)*h**2 + (1 - tau(1, 1))/(30*d)*c*h &
         + (sigma(2) - d*sigma(-1))/(30*d**2)*c**2
      t(5) = -(9 + tau(1, 1))/(60*d)*h**2 + (6*d*sigma(-1) - sigma(2))/(60*d**2)*c*h &
         - sigma(1)/(60*d**2)*c**2
      s(7) = (15 - d*sigma(-3) - 2*tau(1, 1))/(630*d)*h**3 &
         + (6*d*tau(1, 2) - 100*d*sigma(-1) + 53*sigma(2))/(2520*d**2)*c*h**2 &
         + (9*sigma(1) + 10*d*sigma(-2) - 6*tau(2, 1))/(420*d**2)*c**2*h &
         + (4*d + 17*sigma(3) - 15*d*tau(1, 1))/(2520*d**3)*c**3
      t(7) = (9*d*sigma(-1) + d*tau(1, 2) - 11*sigma(2))/(1260*d**2)*h**3 &
         + (47*sigma(1) + 13*tau(2, 1) - 38*d*sigma(-2))/(2520*d**2)*c*h**2 &
         + (sigma(3) + 2*d*tau(1, 1) - 85*d)/(1260*d**3)*c**2*h &
         + (34*d*sigma(-1) - 19*sigma(2))/(2520*d**3)*c**3
   contains
      pure real(qp) function sigma(a)
         integer, intent(in) :: a
         sigma = sum(moments**a)
      end function sigma
      pure real(qp) function tau(b, e)
         integer, intent(in) :: b, e
         tau = sum((cshift(moments, 1)**b + cshift(moments, 2)**b)/moments**e)
      end function tau
   end subroutine table_1

   !> The same modified inverses by another way, for bodies whose rational polynomials cancel
   !> (nearly linear ones): from the instant where the middle component vanishes the exact rotation
   !> over eta = h/2 gives 1/It_1 = rho0 rho1/(eta y1), 1/It_3 = rho0 rho3/(eta y3), here as power
   !> series in eta, cut at the order.
   pure subroutine truncated_inverses(moments, order, h, y, modified)
      real(qp), intent(in) :: moments(3)        !! any order
      integer, intent(in) :: order              !! 2 to 24
      real(qp), intent(in) :: h, y(3)
      real(qp), intent(out) :: modified(3)
      type(taylor_problem) :: problem
      real(qp) :: i(3), m(3), u(3), th, k1, k3, cy(0:max_order, 3), cq(0:max_order, 4), &
         rho(0:max_order, 3), c(3)
      integer :: p(3), n
      modified = 0
      where (moments > 0) modified = 1/moments
      if (order <= 2) return
      p = rising(moments)
      i = moments(p)
      m = modified(p)
      th = 0.5_qp
      if (i(3) > i(1)) th = (i(3) - i(2))/(i(3) - i(1))
      k1 = th*i(2)*m(1)
      k3 = (1 - th)*i(2)*m(3)
      u = h/2*m*y(p) ! a zero amplitude is as good as a tiny one: only its square enters
      u = [sqrt(u(1)**2 + k1*u(2)**2), 0.0_qp, sqrt(u(3)**2 + k3*u(2)**2)] + [1, 0, 1]*1.0e-300_qp
      n = order - 2
      problem%inverse = merge(m/m(2), 0.0_qp, m > 0)
      u = u*merge(m(2)/m, 0.0_qp, m > 0)
      if (i(1) <= 0) u(1) = 0
      call taylor_series(problem, n + 1, u, [1.0_qp, 0.0_qp, 0.0_qp, 0.0_qp], cy, cq)
      rho(:, 1) = times(n + 1, cq(:, 1), cq(:, 1)) - times(n + 1, cq(:, 2), cq(:, 2)) &
         + times(n + 1, cq(:, 3), cq(:, 3)) - times(n + 1, cq(:, 4), cq(:, 4))
      rho(:, 2) = 2*times(n + 1, cq(:, 1), cq(:, 2)) - 2*times(n + 1, cq(:, 3), cq(:, 4))
      rho(:, 3) = 2*times(n + 1, cq(:, 1), cq(:, 4)) + 2*times(n + 1, cq(:, 2), cq(:, 3))
      c(1) = quotient_sum(n, times(n + 1, rho(:, 1), rho(:, 2)), cy(:, 1))*i(1)/i(2)
      c(3) = quotient_sum(n, times(n + 1, rho(:, 1), rho(:, 3)), cy(:, 3))*i(3)/i(2)
      c(2) = th*c(1) + (1 - th)*c(3)
      modified(p) = m*c
   end subroutine truncated_inverses

   !> Order of rising moments.
   pure function rising(moments) result(p)
      real(qp), intent(in) :: moments(3)
      integer :: p(3)
      p(1) = minloc(moments, dim=1)
      p(3) = maxloc(moments, dim=1, back=.true.)
      if (p(1) == p(3)) p(3) = 1 + mod(p(1), 3)
      p(2) = 6 - p(1) - p(3)
   end function rising

   !> Product of two power series, up to degree n.
   pure function times(n, a, b) result(c)
      integer, intent(in) :: n
      real(qp), intent(in) :: a(0:max_order), b(0:max_order)
      real(qp) :: c(0:max_order)
      integer :: k
      c = 0
      do k = 0, n
         c(k) = dot_product(a(0:k), b(k:0:-1))
      end do
   end function times

   !> The series a(t)/(t b(t)), cut after degree n, at t = 1; a(0) = 0. 0 if b vanishes.
   pure real(qp) function quotient_sum(n, a, b)
      integer, intent(in) :: n
      real(qp), intent(in) :: a(0:max_order), b(0:max_order)
      real(qp) :: c(0:n)
      integer :: k
      quotient_sum = 0
      if (abs(b(0)) <= 0) return
      do k = 0, n
         c(k) = (a(k + 1) - dot_product(c(0:k - 1), b(k:1:-1)))/b(0)
      end do
      quotient_sum = sum(c)
   end function quotient_sum

   !> The whole series at once, without a series: Moser-Veselov with these 1/It is the exact flow
   !> over h. From the instant where y2 = 0 (axis `middle`), y = (a, 0, b), the exact rotation over
   !> h/2 gives 1/It_1 = 2 rho0 rho1/(h y1), 1/It_3 = 2 rho0 rho3/(h y3); axis 2 follows from the
   !> others.
   subroutine exact_inverses(moments, h, a, b, modified)
      real(dp), intent(in) :: moments(3) !! rising or falling, so that axis 2 is the middle one
      real(qp), intent(in) :: h
      real(qp), intent(in) :: a, b       !! y1 and y3 where y2 = 0, not zero
      real(qp), intent(out) :: modified(3)
      type(taylor_report) :: report
      real(qp) :: y(3), q(4), rho(0:3), th
      y = [a, 0.0_qp, b]
      q = [1, 0, 0, 0]
      call taylor_flow(free_problem(moments), h/2, y, q, report)
      rho(0) = q(1)**2 - q(2)**2 + q(3)**2 - q(4)**2
      rho(1) = 2*(q(1)*q(2) - q(3)*q(4))
      rho(3) = 2*(q(1)*q(4) + q(2)*q(3))
      modified(1) = 2*rho(0)*rho(1)/(h*y(1))
      modified(3) = 2*rho(0)*rho(3)/(h*y(3))
      th = (real(moments(3), qp) - moments(2))/(real(moments(3), qp) - moments(1))
      modified(2) = (th*modified(1)*moments(1) + (1 - th)*modified(3)*moments(3))/moments(2)
   end subroutine exact_inverses

end module test_oracle_dmv
