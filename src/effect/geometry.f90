!> Block kernels shared by several effects: transforming vectors between the frames, and the torque
!> of a potential that is linear in a direction in the body frame.
!>
!> A space vector e in the body frame is gamma = Q^T e; along Q -> Q exp(hat(delta)) it changes by
!> gamma x delta (mathematics.md section 6).
module poinsot_effect_geometry
   use poinsot_core_kinds, only: dp, lanes
   implicit none(type, external)
   private
   public :: to_body, to_space, each_to_body, turned
   public :: add_linear_torque, add_linear_energy, add_linear_derivative

contains

   !> v = Q^T e for one space vector e and every lane.
   pure subroutine to_body(e, q, v)
      real(dp), intent(in) :: e(3)          !! space vector, any units
      real(dp), intent(in) :: q(lanes, 4)   !! unit quaternions, scalar first, body -> space
      real(dp), intent(out) :: v(lanes, 3)  !! the same vector in the body frames
      real(dp) :: t1, t2, t3
      integer :: i
      !$omp simd private(t1, t2, t3)
      do i = 1, lanes
         t1 = 2*(e(2)*q(i, 4) - e(3)*q(i, 3))
         t2 = 2*(e(3)*q(i, 2) - e(1)*q(i, 4))
         t3 = 2*(e(1)*q(i, 3) - e(2)*q(i, 2))
         v(i, 1) = e(1) + q(i, 1)*t1 + (t2*q(i, 4) - t3*q(i, 3))
         v(i, 2) = e(2) + q(i, 1)*t2 + (t3*q(i, 2) - t1*q(i, 4))
         v(i, 3) = e(3) + q(i, 1)*t3 + (t1*q(i, 3) - t2*q(i, 2))
      end do
   end subroutine to_body

   !> v = Q b for a body vector of its own in every lane.
   pure subroutine to_space(b, q, v)
      real(dp), intent(in) :: b(lanes, 3)   !! body vectors
      real(dp), intent(in) :: q(lanes, 4)   !! attitudes
      real(dp), intent(out) :: v(lanes, 3)  !! the same vectors in space
      real(dp) :: conjugate(lanes, 4)
      conjugate(:, 1) = q(:, 1)
      conjugate(:, 2:4) = -q(:, 2:4)
      call each_to_body(b, conjugate, v)
   end subroutine to_space

   !> v = Q^T e for a space vector of its own in every lane.
   pure subroutine each_to_body(e, q, v)
      real(dp), intent(in) :: e(lanes, 3)
      real(dp), intent(in) :: q(lanes, 4) !! attitudes
      real(dp), intent(out) :: v(lanes, 3)
      real(dp) :: t1, t2, t3
      integer :: i
      !$omp simd private(t1, t2, t3)
      do i = 1, lanes
         t1 = 2*(e(i, 2)*q(i, 4) - e(i, 3)*q(i, 3))
         t2 = 2*(e(i, 3)*q(i, 2) - e(i, 1)*q(i, 4))
         t3 = 2*(e(i, 1)*q(i, 3) - e(i, 2)*q(i, 2))
         v(i, 1) = e(i, 1) + q(i, 1)*t1 + (t2*q(i, 4) - t3*q(i, 3))
         v(i, 2) = e(i, 2) + q(i, 1)*t2 + (t3*q(i, 2) - t1*q(i, 4))
         v(i, 3) = e(i, 3) + q(i, 1)*t3 + (t1*q(i, 3) - t2*q(i, 2))
      end do
   end subroutine each_to_body

   !> v turned by an angle about a unit axis (Rodrigues); for quantities computed once per stage.
   pure function turned(v, axis, angle) result(w)
      real(dp), intent(in) :: v(3)
      real(dp), intent(in) :: axis(3)  !! unit vector
      real(dp), intent(in) :: angle    !! radians, right-handed
      real(dp) :: w(3), c, s, along
      c = cos(angle)
      s = sin(angle)
      along = (1 - c)*dot_product(axis, v)
      w = c*v + along*axis + s*[axis(2)*v(3) - axis(3)*v(2), axis(3)*v(1) - axis(1)*v(3), &
                                axis(1)*v(2) - axis(2)*v(1)]
   end function turned

   !> g += gamma x s, the torque of U = gamma . s with gamma = Q^T e.
   pure subroutine add_linear_torque(e, s, q, g)
      real(dp), intent(in) :: e(3)             !! space vector
      real(dp), intent(in) :: s(3)             !! body vector
      real(dp), intent(in) :: q(lanes, 4)      !! attitudes
      real(dp), intent(inout) :: g(lanes, 3)   !! body torques, added to
      real(dp) :: v(lanes, 3)
      integer :: i
      call to_body(e, q, v)
      !$omp simd
      do i = 1, lanes
         g(i, 1) = g(i, 1) + (v(i, 2)*s(3) - v(i, 3)*s(2))
         g(i, 2) = g(i, 2) + (v(i, 3)*s(1) - v(i, 1)*s(3))
         g(i, 3) = g(i, 3) + (v(i, 1)*s(2) - v(i, 2)*s(1))
      end do
   end subroutine add_linear_torque

   !> u += gamma . s
   pure subroutine add_linear_energy(e, s, q, u)
      real(dp), intent(in) :: e(3), s(3)
      real(dp), intent(in) :: q(lanes, 4) !! attitudes
      real(dp), intent(inout) :: u(lanes) !! energies, added to
      real(dp) :: v(lanes, 3)
      call to_body(e, q, v)
      u = u + (v(:, 1)*s(1) + v(:, 2)*s(2) + v(:, 3)*s(3))
   end subroutine add_linear_energy

   !> dg += (gamma x delta) x s
   pure subroutine add_linear_derivative(e, s, q, delta, dg)
      real(dp), intent(in) :: e(3), s(3)
      real(dp), intent(in) :: q(lanes, 4)     !! attitudes
      real(dp), intent(in) :: delta(lanes, 3) !! rotation vectors, body frame
      real(dp), intent(inout) :: dg(lanes, 3) !! change of the torques, added to
      real(dp) :: v(lanes, 3), w1, w2, w3
      integer :: i
      call to_body(e, q, v)
      !$omp simd private(w1, w2, w3)
      do i = 1, lanes
         w1 = v(i, 2)*delta(i, 3) - v(i, 3)*delta(i, 2)
         w2 = v(i, 3)*delta(i, 1) - v(i, 1)*delta(i, 3)
         w3 = v(i, 1)*delta(i, 2) - v(i, 2)*delta(i, 1)
         dg(i, 1) = dg(i, 1) + (w2*s(3) - w3*s(2))
         dg(i, 2) = dg(i, 2) + (w3*s(1) - w1*s(3))
         dg(i, 3) = dg(i, 3) + (w1*s(2) - w2*s(1))
      end do
   end subroutine add_linear_derivative

end module poinsot_effect_geometry
