!> What a one-step map (y, q) -> (y', q') keeps and what it does not, from its Jacobian in dual
!> numbers.
!>
!> Symplectic on T*SO(3): in the left trivialisation dQ = Q xi^ with the momentum y the canonical
!> form is Omega((xi1, dy1), (xi2, dy2)) = dy1.xi2 - dy2.xi1 + xi1.(y x xi2), the same as in any
!> canonical coordinates (and as trace(dP^T ^ dQ) for P = Q (y/I)^ D); the map with the tangent map
!> M keeps it if M^T Omega(y') M = Omega(y). Poisson: D y^ D^T = y'^, D = dy'/dy, and y' does not
!> depend on q.
module poinsot_study_defects
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_maxima, only: largest_of
   use poinsot_study_dual, only: dual, constant, variable, value_of
   use poinsot_study_maps, only: step_map, dual_product
   use poinsot_study_quadruple, only: cross
   implicit none(type, external)
   private
   public :: defects, measure_defects, plain_step

   !> Relative defects of one step: at rounding of quadruple precision where the property holds.
   type :: defects
      logical :: ok = .false.        !! the map has an answer
      real(dp) :: space = 0          !! Q'y' - Qy
      real(dp) :: casimir = 0        !! |y'|^2 - |y|^2
      real(dp) :: energy = 0         !! H(y') - H(y)
      real(dp) :: norm = 0           !! |q'| - |q|
      real(dp) :: poisson = 0        !! D y^ D^T - y'^
      real(dp) :: symplectic = 0     !! M^T Omega' M - Omega
      real(dp) :: symmetric = 0      !! the step -h after the step h, against where it began
      !> from (-y, q) over h, against (y, q) over -h with y turned round
      real(dp) :: reversible = 0
   end type defects

contains

   !> One step in plain quadruple precision.
   subroutine plain_step(name, moments, h, y, q, ok)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3)
      real(qp), intent(in) :: h
      real(qp), intent(inout) :: y(3), q(4)
      logical, intent(out) :: ok
      type(dual) :: yd(3), qd(4)
      yd = constant(y)
      qd = constant(q)
      call step_map(name, moments, h, yd, qd, ok)
      y = value_of(yd)
      q = value_of(qd)
   end subroutine plain_step

   !> All defects of a method at one state.
   subroutine measure_defects(name, moments, h, y, q, found)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3), h, y(3), q(4)
      type(defects), intent(out) :: found
      type(dual) :: yd(3), qd(4)
      real(qp) :: y0(3), q0(4), y1(3), q1(4), y2(3), q2(4), dq(4), m(6, 6), inverse(3), size
      logical :: good(3)
      integer :: k
      y0 = y
      q0 = q/sqrt(sum(real(q, qp)**2))
      size = norm2(y0)
      yd = constant(y0)
      qd = constant(q0)
      do k = 1, 3
         yd(k) = variable(y0(k), 3 + k)
         yd(k)%d(3 + k) = size
         call push(q0, k, qd)
      end do
      call step_map(name, moments, real(h, qp), yd, qd, found%ok)
      if (.not. found%ok) return
      y1 = value_of(yd)
      q1 = value_of(qd)
      do k = 1, 6
         dq = [qd(1)%d(k), qd(2)%d(k), qd(3)%d(k), qd(4)%d(k)]
         m(1:3, k) = turn_between(q1, dq)
         m(4:6, k) = [yd(1)%d(k), yd(2)%d(k), yd(3)%d(k)]/size
      end do
      call form_defects(m, y0/size, y1/size, found)
      inverse = 0
      where (moments > 0) inverse = 1/real(moments, qp)
      found%space = real(norm2(rotate(q1, y1) - rotate(q0, y0))/size, dp)
      found%casimir = real(abs(sum(y1*y1)/size**2 - 1), dp)
      found%energy = real(abs(sum(inverse*y1*y1)/sum(inverse*y0*y0) - 1), dp)
      found%norm = real(abs(norm2(q1) - 1), dp)
      y2 = y1
      q2 = q1
      call plain_step(name, moments, -real(h, qp), y2, q2, good(1))
      found%symmetric = real(norm2(y2 - y0)/size + norm2(q2 - q0), dp)
      y1 = -y0
      q1 = q0
      call plain_step(name, moments, real(h, qp), y1, q1, good(2))
      y2 = y0
      q2 = q0
      call plain_step(name, moments, -real(h, qp), y2, q2, good(3))
      found%reversible = real(norm2(y1 + y2)/size + norm2(q1 - q2), dp)
      found%ok = all(good)
   end subroutine measure_defects

   !> The derivative of q o exp(xi) with respect to xi_k: q o (0, e_k/2).
   pure subroutine push(q, k, qd)
      real(qp), intent(in) :: q(4)
      integer, intent(in) :: k
      type(dual), intent(inout) :: qd(4)
      type(dual) :: turned(4)
      real(qp) :: half(4)
      half = 0
      half(1 + k) = 0.5_qp
      turned = dual_product(constant(q), constant(half))
      qd%d(k) = value_of(turned)
   end subroutine push

   !> xi of a change dq of q: the vector part of 2 q^-1 o dq.
   pure function turn_between(q, dq) result(xi)
      real(qp), intent(in) :: q(4), dq(4)
      real(qp) :: xi(3)
      type(dual) :: r(4)
      r = dual_product(constant([q(1), -q(2:4)]), constant(dq))
      xi = 2*value_of(r(2:4))
   end function turn_between

   !> Poisson and symplectic defects from the tangent map; y and y1 in units of |y|.
   pure subroutine form_defects(m, y, y1, found)
      real(qp), intent(in) :: m(6, 6), y(3), y1(3)
      type(defects), intent(inout) :: found
      real(qp) :: d(3, 3), small(3, 3), large(6, 6)
      d = m(4:6, 4:6)
      small = matmul(d, matmul(hat(y), transpose(d))) - hat(y1)
      found%poisson = largest_of(real([abs(small), abs(m(4:6, 1:3))], dp))
      large = matmul(transpose(m), matmul(form(y1), m)) - form(y)
      found%symplectic = largest_of(reshape(real(abs(large), dp), [size(large)]))
   end subroutine form_defects

   !> The matrix of Omega.
   pure function form(y) result(omega)
      real(qp), intent(in) :: y(3)
      real(qp) :: omega(6, 6)
      integer :: j
      omega = 0
      omega(1:3, 1:3) = hat(y)
      do j = 1, 3
         omega(j, j + 3) = -1
         omega(j + 3, j) = 1
      end do
   end function form

   pure function hat(v) result(m)
      real(qp), intent(in) :: v(3)
      real(qp) :: m(3, 3)
      m = reshape([0.0_qp, v(3), -v(2), -v(3), 0.0_qp, v(1), v(2), -v(1), 0.0_qp], [3, 3])
   end function hat

   !> Q v.
   pure function rotate(q, v) result(u)
      real(qp), intent(in) :: q(4), v(3)
      real(qp) :: u(3), t(3)
      t = 2*cross(q(2:4), v)
      u = v + (q(1)*t + cross(q(2:4), t))/sum(q*q)
   end function rotate

end module poinsot_study_defects
