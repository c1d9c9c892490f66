!> The quaternions and matrices of the review's Algorithm 2, under its names. Fortran does not
!> distinguish u from U, so u(theta), v(theta), a(omega) are `quaternion_u`, `quaternion_v`,
!> `quaternion_a` and U(theta), V(theta), exp(hat(omega)) are `matrix_u`, `matrix_v`, `matrix_a`;
!> hat is `hat`, in poinsot_rotation_vector.
!>
!> U and V are rotations by minus theta: U(theta) = to_matrix(quaternion_u(theta)), and the flows of
!> Algorithm 2 are y(t) = U(alpha t) y(0), q(t) = q(0) o u(-alpha t). The review prints alpha =
!> y1/I1 and beta = 1/I3 - 1/I2 there; correct are alpha = (1/I1 - 1/I2) y1 and beta = (1/I3 - 1/I2)
!> y3.
module poinsot_rotation_review
   use poinsot_core_kinds, only: dp
   use poinsot_core_libm, only: cosine, sine
   use poinsot_rotation_conversions, only: from_rotation_vector, to_matrix
   implicit none(type, external)
   private
   public :: quaternion_u, quaternion_v, quaternion_a, matrix_u, matrix_v, matrix_a

contains

   !> The review's u(theta) = cos(theta/2) - i sin(theta/2).
   pure function quaternion_u(theta) result(q)
      real(dp), intent(in) :: theta !! angle in radians
      real(dp) :: q(4)
      q = [cosine(theta/2), -sine(theta/2), 0._dp, 0._dp]
   end function quaternion_u

   !> The review's v(theta) = cos(theta/2) - k sin(theta/2).
   pure function quaternion_v(theta) result(q)
      real(dp), intent(in) :: theta !! angle in radians
      real(dp) :: q(4)
      q = [cosine(theta/2), 0._dp, 0._dp, -sine(theta/2)]
   end function quaternion_v

   !> The review's a(omega) = cos(|omega|/2) + sin(|omega|/2) omega/|omega|, the quaternion of
   !> exp(hat(omega)): the turn by the rotation vector omega.
   pure function quaternion_a(omega) result(q)
      real(dp), intent(in) :: omega(3) !! rotation vector in radians, any length
      real(dp) :: q(4)
      q = from_rotation_vector(omega)
   end function quaternion_a

   !> The review's U(theta): rows (1, 0, 0), (0, c, s), (0, -s, c).
   pure function matrix_u(theta) result(matrix)
      real(dp), intent(in) :: theta !! angle in radians
      real(dp) :: matrix(3, 3)
      matrix(:, 1) = [1._dp, 0._dp, 0._dp]
      matrix(:, 2) = [0._dp, cosine(theta), -sine(theta)]
      matrix(:, 3) = [0._dp, sine(theta), cosine(theta)]
   end function matrix_u

   !> The review's V(theta): rows (c, s, 0), (-s, c, 0), (0, 0, 1).
   pure function matrix_v(theta) result(matrix)
      real(dp), intent(in) :: theta !! angle in radians
      real(dp) :: matrix(3, 3)
      matrix(:, 1) = [cosine(theta), -sine(theta), 0._dp]
      matrix(:, 2) = [sine(theta), cosine(theta), 0._dp]
      matrix(:, 3) = [0._dp, 0._dp, 1._dp]
   end function matrix_v

   !> exp(hat(omega)), the rotation matrix of a(omega) (Rodrigues' formula).
   pure function matrix_a(omega) result(matrix)
      real(dp), intent(in) :: omega(3) !! rotation vector in radians
      real(dp) :: matrix(3, 3)
      matrix = to_matrix(quaternion_a(omega))
   end function matrix_a

end module poinsot_rotation_review
