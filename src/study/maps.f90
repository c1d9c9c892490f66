!> The map of every free method once more, plainly, in dual numbers of quadruple precision: value
!> and Jacobian of one step. The kernels are double precision and cannot tell what a property costs
!> them below 1e-16; these maps can, and are compared with the kernels, state by state, before
!> anything is said about them.
module poinsot_study_maps
   use poinsot_core_error, only: poinsot_error
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_order, only: ascending_order
   use poinsot_free_method, only: free_method, find_method
   use poinsot_study_dual, only: dual, constant, sqrt, sin, cos, operator(+), operator(-), &
      operator(*), operator(/)
   implicit none(type, external)
   private
   public :: step_map, has_map, dual_product

   integer, parameter :: taylor_order = 40
   real(qp), parameter :: taylor_step = 0.2_qp !! h |omega| of a piece: its remainder is below 1e-33

contains

   !> One step h of the method `name`, moments in any order; a zero moment counts as 1/I = 0.
   subroutine step_map(name, moments, h, y, q, ok)
      !> of the registry; its kernel says which map it is: that of exact and jacobi is the flow
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3)
      real(qp), intent(in) :: h
      type(dual), intent(inout) :: y(3), q(4)
      logical, intent(out) :: ok                 !! .false. if there is no such map, or no root
      real(qp) :: inverse(3)
      type(dual) :: modified(3)
      type(free_method) :: method
      type(poinsot_error) :: error
      call find_method(name, method, error)
      inverse = 0
      where (moments > 0) inverse = 1/real(moments, qp)
      ok = .true.
      select case (method%kernel)
      case ("exact", "jacobi")
         call flow(inverse, h, y, q)
      case ("three-rotations")
         call turn_axis(3, (h/2*inverse(3))*y(3), y, q)
         call turn_axis(2, (h/2*inverse(2))*y(2), y, q)
         call turn_axis(1, (h*inverse(1))*y(1), y, q)
         call turn_axis(2, (h/2*inverse(2))*y(2), y, q)
         call turn_axis(3, (h/2*inverse(3))*y(3), y, q)
      case ("symmetric-rotation")
         call symmetric_rotation(inverse, h, y, q)
      case ("midpoint")
         modified = constant(inverse)
         call cayley_step(modified, h, .false., y, q, ok)
      case ("rattle")
         modified = constant(inverse)
         call cayley_step(modified, h, .true., y, q, ok)
      case ("moser-veselov")
         call modified_inverses(moments, method%terms, h, y, modified)
         call cayley_step(modified, h, .true., y, q, ok)
      case default
         ok = .false.
      end select
   end subroutine step_map

   !> Is there a map of this method? There is one for each kernel; a method with a kernel of its own
   !> may be without.
   logical function has_map(name)
      character(*), intent(in) :: name
      type(dual) :: y(3), q(4)
      y = constant([0.3_qp, 0.4_qp, 0.5_qp])
      q = constant([1.0_qp, 0.0_qp, 0.0_qp, 0.0_qp])
      call step_map(name, [0.6_dp, 0.8_dp, 1.0_dp], 0.01_qp, y, q, has_map)
   end function has_map

   ! Splittings
   ! -----------------------------------------------------------------------------------------------

   !> The body turns by `angle` about its own axis j.
   pure subroutine turn_axis(j, angle, y, q)
      integer, intent(in) :: j
      type(dual), intent(in) :: angle
      type(dual), intent(inout) :: y(3), q(4)
      type(dual) :: c, s, r(4), yk
      integer :: k, l
      k = 1 + mod(j, 3)
      l = 1 + mod(k, 3)
      c = cos(angle)
      s = sin(angle)
      yk = c*y(k) + s*y(l)
      y(l) = c*y(l) - s*y(k)
      y(k) = yk
      r = constant(0.0_qp)
      r(1) = cos(0.5_qp*angle)
      r(1 + j) = sin(0.5_qp*angle)
      q = dual_product(q, r)
   end subroutine turn_axis

   !> R(h/2) S(h) R(h/2); (a, b) the cyclic pair with the smallest |1/Ia - 1/Ib|, the first of
   !> equals.
   pure subroutine symmetric_rotation(inverse, h, y, q)
      real(qp), intent(in) :: inverse(3), h
      type(dual), intent(inout) :: y(3), q(4)
      type(dual) :: r(4), size, s
      integer :: a, b, c
      a = minloc(abs(inverse - cshift(inverse, 1)), dim=1)
      b = 1 + mod(a, 3)
      c = 1 + mod(b, 3)
      call turn_axis(a, ((inverse(a) - inverse(b))*h/2)*y(a), y, q)
      size = sqrt(y(1)*y(1) + y(2)*y(2) + y(3)*y(3))
      s = sin((h/2*inverse(b))*size)/size
      r = [cos((h/2*inverse(b))*size), s*y(1), s*y(2), s*y(3)]
      q = dual_product(q, r)
      call turn_axis(c, ((inverse(c) - inverse(b))*h)*y(c), y, q)
      call turn_axis(a, ((inverse(a) - inverse(b))*h/2)*y(a), y, q)
   end subroutine symmetric_rotation

   ! Moser-Veselov and midpoint
   ! -----------------------------------------------------------------------------------------------

   !> Y = alpha y + Y x e, e = (h/2) Y/It, by Newton's method from the fixed point; y' = y +
   !> (2/alpha) Y x e, q' = q o (1, e)/|(1, e)|; alpha = 1 + |e|^2, or 1 for the midpoint rule.
   !> Vilmart (2013), Algorithm 3 and Remark 4.
   subroutine cayley_step(inverse, h, scaled_step, y, q, ok)
      type(dual), intent(in) :: inverse(3)
      real(qp), intent(in) :: h
      logical, intent(in) :: scaled_step
      type(dual), intent(inout) :: y(3), q(4)
      logical, intent(out) :: ok
      type(dual), dimension(3) :: mean, e, rate, f, change
      type(dual) :: slope(3, 3), alpha, unit(3), norm
      integer :: i, j
      rate = (h/2)*inverse
      mean = y
      do i = 1, 14 ! the value needs 6 at most, its derivatives one more
         e = rate*mean
         norm = 1.0_qp + (e(1)*e(1) + e(2)*e(2) + e(3)*e(3))
         alpha = constant(1.0_qp)
         if (scaled_step) alpha = norm
         f = mean - alpha*y - cross(mean, e)
         do j = 1, 3
            unit = constant(0.0_qp)
            unit(j) = constant(1.0_qp)
            slope(:, j) = unit - cross(unit, e) - cross(mean, rate(j)*unit)
            if (scaled_step) slope(:, j) = slope(:, j) - (2.0_qp*(rate(j)*e(j)))*y
         end do
         change = solve(slope, f)
         mean = mean - change
      end do
      e = rate*mean
      norm = 1.0_qp + (e(1)*e(1) + e(2)*e(2) + e(3)*e(3))
      ok = norm2(change%v) <= 1e-28_qp*norm2(mean%v) .and. norm%v < 2
      if (.not. ok) return
      alpha = constant(1.0_qp)
      if (scaled_step) alpha = norm
      y = y + (2.0_qp*cross(mean, e))/alpha
      q = dual_product(q, [constant(1.0_qp), e])/sqrt(norm)
   end subroutine cayley_step

   !> a x = b by Cramer's rule; columns of a.
   pure function solve(a, b) result(x)
      type(dual), intent(in) :: a(3, 3), b(3)
      type(dual) :: x(3), d
      d = dot(a(:, 1), cross(a(:, 2), a(:, 3)))
      x(1) = dot(b, cross(a(:, 2), a(:, 3)))/d
      x(2) = dot(a(:, 1), cross(b, a(:, 3)))/d
      x(3) = dot(a(:, 1), cross(a(:, 2), b))/d
   end function solve

   !> 1/It to the degree n in h^2, from the series in t = h/2 with the constants p2, r2
   !> (mathematics, section 3) in numbers.
   pure subroutine modified_inverses(moments, n, h, y, modified)
      real(dp), intent(in) :: moments(3)
      integer, intent(in) :: n                   !! 0: the moments themselves
      real(qp), intent(in) :: h
      type(dual), intent(in) :: y(3)
      type(dual), intent(out) :: modified(3)
      real(qp) :: i(3), m(3), a(3), theta, k1, k3
      real(dp) :: parity
      type(dual) :: p, r, cp, cr, w(3)
      integer :: s(3)
      call ascending_order(moments, s, parity)
      i = moments(s)
      m = 0
      where (i > 0) m = 1/i
      a = [(i(3) - i(2))*m(1), (i(3) - i(1))*m(2), (i(2) - i(1))*m(3)]
      theta = 0.5_qp
      if (i(3) > i(1)) theta = (i(3) - i(2))/(i(3) - i(1))
      k1 = theta*i(2)*m(1)
      k3 = (1 - theta)*i(2)*m(3)
      w = m*y(s)
      p = w(1)*w(1) + k1*(w(2)*w(2))
      r = w(3)*w(3) + k3*(w(2)*w(2))
      call corrections(n, a, (h/2)**2*p, (h/2)**2*r, cp, cr)
      modified(s(1)) = m(1)*cp
      modified(s(2)) = m(2)*(theta*cp + (1 - theta)*cr)
      modified(s(3)) = m(3)*cr
   end subroutine modified_inverses

   !> 1 + P and 1 + R at t = 1, cut after degree n in t^2.
   pure subroutine corrections(n, a, p, r, cp, cr)
      integer, intent(in) :: n
      real(qp), intent(in) :: a(3)
      type(dual), intent(in) :: p, r             !! t^2 p2 and t^2 r2
      type(dual), intent(out) :: cp, cr
      type(dual), dimension(0:n) :: f, g, k, q0, q1, q2, q3, rho, top
      type(dual) :: pr
      integer :: i
      pr = p*r
      f = constant(0.0_qp)
      g = f
      k = f
      q0 = f
      q1 = f
      q2 = f
      q3 = f
      f(0) = constant(1.0_qp)
      g(0) = constant(1.0_qp)
      q0(0) = constant(1.0_qp)
      do i = 0, n
         if (i > 0) then
            f(i) = (-a(1)/(2*i))*(r*term(k, g, i - 1))
            g(i) = (-a(3)/(2*i))*(p*term(k, f, i - 1))
            q0(i) = (-1.0_qp/(4*i))*(p*term(q1, f, i - 1) + r*term(q3, g, i - 1) + pr*term(q2, &
               k, i - 2))
         end if
         k(i) = (a(2)/(2*i + 1))*term(f, g, i)
         q1(i) = (0.5_qp/(2*i + 1))*(term(q0, f, i) + r*(term(q2, g, i - 1) - term(q3, k, i - 1)))
         q3(i) = (0.5_qp/(2*i + 1))*(term(q0, g, i) + p*(term(q1, k, i - 1) - term(q2, f, i - 1)))
         q2(i) = (0.5_qp/(2*i + 2))*(term(q0, k, i) - term(q1, g, i) + term(q3, f, i))
      end do
      do i = 0, n
         rho(i) = term(q0, q0, i) - p*term(q1, q1, i - 1) + pr*term(q2, q2, i - 2) - r*term(q3, &
            q3, i - 1)
      end do
      do i = 0, n
         top(i) = term(q0, q1, i) - r*term(q2, q3, i - 1)
      end do
      cp = quotient(rho, top, f)
      do i = 0, n
         top(i) = term(q0, q3, i) + p*term(q1, q2, i - 1)
      end do
      cr = quotient(rho, top, g)
   end subroutine corrections

   !> Coefficient i of a product of power series; 0 for i < 0.
   pure type(dual) function term(a, b, i)
      type(dual), intent(in) :: a(0:), b(0:)
      integer, intent(in) :: i
      integer :: j
      do j = 0, i
         term = term + a(j)*b(i - j)
      end do
   end function term

   !> The sum of the coefficients of 2 a b/c, cut.
   pure type(dual) function quotient(a, b, c)
      type(dual), intent(in) :: a(0:), b(0:), c(0:)
      type(dual) :: x(0:ubound(a, 1))
      integer :: i, j
      do i = 0, ubound(a, 1)
         x(i) = 2.0_qp*term(a, b, i)
         do j = 0, i - 1
            x(i) = x(i) - x(j)*c(i - j)
         end do
         quotient = quotient + x(i)
      end do
   end function quotient

   ! The flow
   ! -----------------------------------------------------------------------------------------------

   !> The exact motion by Taylor series of y and q in pieces.
   pure subroutine flow(inverse, h, y, q)
      real(qp), intent(in) :: inverse(3), h
      type(dual), intent(inout) :: y(3), q(4)
      type(dual) :: cy(0:taylor_order, 3), cq(0:taylor_order, 4), w(0:taylor_order, 3)
      real(qp) :: piece, bound
      integer :: n, i, j, k, l
      bound = abs(h)*maxval(inverse*abs(y%v))*2
      n = 1 + int(bound/taylor_step)
      piece = h/n
      do i = 1, n
         cy(0, :) = y
         cq(0, :) = q
         do k = 0, taylor_order - 1
            w(k, :) = piece*(inverse*cy(k, :))
            do j = 1, 3
               l = 1 + mod(j, 3)
               cy(k + 1, j) = (piece*(inverse(6 - j - l) - inverse(l))/(k + 1))*term(cy(:, l), &
                  cy(:, 6 - j - l), k)
            end do
            cq(k + 1, 1) = -(term(cq(:, 2), w(:, 1), k) + term(cq(:, 3), w(:, 2), k) &
               + term(cq(:, 4), w(:, 3), k))
            cq(k + 1, 2) = term(cq(:, 1), w(:, 1), k) + term(cq(:, 3), w(:, 3), k) - term(cq(:, &
               4), w(:, 2), k)
            cq(k + 1, 3) = term(cq(:, 1), w(:, 2), k) + term(cq(:, 4), w(:, 1), k) - term(cq(:, &
               2), w(:, 3), k)
            cq(k + 1, 4) = term(cq(:, 1), w(:, 3), k) + term(cq(:, 2), w(:, 2), k) - term(cq(:, &
               3), w(:, 1), k)
            cq(k + 1, :) = (0.5_qp/(k + 1))*cq(k + 1, :)
         end do
         y = cy(taylor_order, :)
         q = cq(taylor_order, :)
         do k = taylor_order - 1, 0, -1
            y = y + cy(k, :)
            q = q + cq(k, :)
         end do
      end do
   end subroutine flow

   ! Algebra
   ! -----------------------------------------------------------------------------------------------

   !> Product of quaternions.
   pure function dual_product(a, b) result(c)
      type(dual), intent(in) :: a(4), b(4)
      type(dual) :: c(4)
      c(1) = a(1)*b(1) - dot(a(2:4), b(2:4))
      c(2:4) = a(1)*b(2:4) + b(1)*a(2:4) + cross(a(2:4), b(2:4))
   end function dual_product

   pure function cross(a, b) result(c)
      type(dual), intent(in) :: a(3), b(3)
      type(dual) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

   pure type(dual) function dot(a, b)
      type(dual), intent(in) :: a(3), b(3)
      dot = a(1)*b(1) + a(2)*b(2) + a(3)*b(3)
   end function dot

end module poinsot_study_maps
