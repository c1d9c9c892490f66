!> Vectors in space and their skew-symmetric matrices.
!>
!> Norms are safe at any scale (momenta of SI molecules are 1e-34, their moments 1e-46): where
!> squares would overflow or underflow, the vector is scaled by a power of two, which is exact.
module poinsot_rotation_vector
   use poinsot_core_kinds, only: dp
   use poinsot_core_libm, only: arctangent
   implicit none(type, external)
   private
   public :: cross, vector_norm, unit_vector, perpendicular, angle_between
   public :: hat, vee, rot, identity_matrix, determinant, largest_exponent

   !> Between these the sum of squares of a few components neither overflows nor loses digits to
   !> underflow.
   real(dp), parameter :: square_floor = 1e-140_dp, square_ceiling = 1e140_dp

   !> The 3 x 3 identity.
   real(dp), parameter :: identity_matrix(3, 3) = &
      reshape([1._dp, 0._dp, 0._dp, 0._dp, 1._dp, 0._dp, 0._dp, 0._dp, 1._dp], [3, 3])

contains

   !> Vector product a x b.
   pure function cross(a, b) result(c)
      real(dp), intent(in) :: a(3) !! first vector, any unit
      real(dp), intent(in) :: b(3) !! second vector, any unit
      real(dp) :: c(3)
      c(1) = a(2)*b(3) - a(3)*b(2)
      c(2) = a(3)*b(1) - a(1)*b(3)
      c(3) = a(1)*b(2) - a(2)*b(1)
   end function cross

   !> Binary exponent of the largest component: |v| lies in [2**(e-1), 2**(e+1)] for up to four
   !> components. 0 for a zero vector. `scale(v, -e)` then has components of at most 1.
   pure integer function largest_exponent(v)
      real(dp), intent(in) :: v(:) !! finite
      real(dp) :: largest
      largest = maxval(abs(v))
      largest_exponent = 0
      if (largest > 0) largest_exponent = exponent(largest)
   end function largest_exponent

   !> Euclidean length, for components from 1e-308 to 1e308 (the length itself must be
   !> representable).
   pure function vector_norm(v) result(length)
      real(dp), intent(in) :: v(:) !! finite, any number of components
      real(dp) :: length
      real(dp) :: largest
      integer :: e
      largest = maxval(abs(v))
      if (largest > square_floor .and. largest < square_ceiling) then
         length = sqrt(sum(v**2))
      else if (largest > 0) then
         e = exponent(largest)
         length = scale(sqrt(sum(scale(v, -e)**2)), e)
      else
         length = 0
      end if
   end function vector_norm

   !> v/|v| at any scale; zero stays zero.
   pure function unit_vector(v) result(u)
      real(dp), intent(in) :: v(:) !! finite
      real(dp) :: u(size(v))
      real(dp) :: largest
      largest = maxval(abs(v))
      if (largest > square_floor .and. largest < square_ceiling) then
         u = v/sqrt(sum(v**2))
      else if (largest > 0) then
         u = scale(v, -exponent(largest))
         u = u/sqrt(sum(u**2))
      else
         u = 0
      end if
   end function unit_vector

   !> A unit vector at right angles to v, always the same one: v x e_k with the axis k furthest from
   !> v (lowest k in a tie). For a zero v: the first axis.
   pure function perpendicular(v) result(u)
      real(dp), intent(in) :: v(3) !! finite
      real(dp) :: u(3)
      integer :: k
      k = minloc(abs(v), dim=1)
      u = unit_vector(cross(unit_vector(v), identity_matrix(:, k)))
      if (maxval(abs(u)) <= 0) u = identity_matrix(:, 1)
   end function perpendicular

   !> Angle between two directions in [0, pi], accurate also near 0 and pi (W. Kahan: 2 atan2(|a-b|,
   !> |a+b|) of the unit vectors). 0 if a vector is zero.
   pure real(dp) function angle_between(a, b)
      real(dp), intent(in) :: a(3) !! finite, any length
      real(dp), intent(in) :: b(3) !! finite, any length
      real(dp) :: u(3), v(3)
      u = unit_vector(a)
      v = unit_vector(b)
      angle_between = 0
      if (maxval(abs(u)) > 0 .and. maxval(abs(v)) > 0) then
         angle_between = 2*arctangent(vector_norm(u - v), vector_norm(u + v))
      end if
   end function angle_between

   !> The review's hat map: the skew matrix with hat(w) x = w x x (Vilmart's review, before equation
   !> 4).
   pure function hat(w) result(matrix)
      real(dp), intent(in) :: w(3) !! any vector
      real(dp) :: matrix(3, 3)
      matrix(:, 1) = [0._dp, w(3), -w(2)]
      matrix(:, 2) = [-w(3), 0._dp, w(1)]
      matrix(:, 3) = [w(2), -w(1), 0._dp]
   end function hat

   !> Inverse of the hat map, reading the skew part of any matrix: vee(hat(w)) = w.
   pure function vee(matrix) result(w)
      real(dp), intent(in) :: matrix(3, 3) !! a skew matrix; a symmetric part is dropped
      real(dp) :: w(3)
      w = rot(matrix)/2
   end function vee

   !> The review's rot: hat(rot(A)) = A - transpose(A). The body torque of a potential U(Q) is
   !> -rot(Q^T dU/dQ) (Vilmart's review, equation 8).
   pure function rot(matrix) result(w)
      real(dp), intent(in) :: matrix(3, 3) !! any matrix
      real(dp) :: w(3)
      w(1) = matrix(3, 2) - matrix(2, 3)
      w(2) = matrix(1, 3) - matrix(3, 1)
      w(3) = matrix(2, 1) - matrix(1, 2)
   end function rot

   !> Determinant of a 3 x 3 matrix, as the triple product of its columns.
   pure real(dp) function determinant(matrix)
      real(dp), intent(in) :: matrix(3, 3) !! entries whose triple products are representable
      determinant = dot_product(matrix(:, 1), cross(matrix(:, 2), matrix(:, 3)))
   end function determinant

end module poinsot_rotation_vector
