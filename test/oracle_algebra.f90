!> Vectors and quaternions of the judge: written anew, with nothing of src but kinds, so that no
!> test asks the library about itself. In quadruple precision; those in double are its rounding.
module test_oracle_algebra
   use poinsot_core_kinds, only: dp, qp
   implicit none(type, external)
   private
   public :: cross, hat, quaternion_product, rotate, rotate_back

   !> a x b.
   interface cross
      module procedure cross_dp, cross_qp
   end interface cross

   !> a b; (1, 0, 0, 0) is neutral.
   interface quaternion_product
      module procedure product_dp, product_qp
   end interface quaternion_product

   !> Q v for the rotation of the quaternion q of any norm: body to space.
   interface rotate
      module procedure rotate_dp, rotate_qp
   end interface rotate

   !> Q^T v: space to body.
   interface rotate_back
      module procedure rotate_back_dp, rotate_back_qp
   end interface rotate_back

contains

   pure function cross_qp(a, b) result(c)
      real(qp), intent(in) :: a(3), b(3)
      real(qp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross_qp

   pure function cross_dp(a, b) result(c)
      real(dp), intent(in) :: a(3), b(3)
      real(dp) :: c(3)
      c = real(cross_qp(real(a, qp), real(b, qp)), dp)
   end function cross_dp

   pure function product_qp(a, b) result(c)
      real(qp), intent(in) :: a(4), b(4)
      real(qp) :: c(4)
      c(1) = a(1)*b(1) - dot_product(a(2:4), b(2:4))
      c(2:4) = a(1)*b(2:4) + b(1)*a(2:4) + cross_qp(a(2:4), b(2:4))
   end function product_qp

   pure function product_dp(a, b) result(c)
      real(dp), intent(in) :: a(4), b(4)
      real(dp) :: c(4)
      c = real(product_qp(real(a, qp), real(b, qp)), dp)
   end function product_dp

   pure function rotate_qp(q, v) result(u)
      real(qp), intent(in) :: q(4), v(3)
      real(qp) :: u(3), t(3)
      t = 2*cross_qp(q(2:4), v)
      u = v + (q(1)*t + cross_qp(q(2:4), t))/sum(q*q)
   end function rotate_qp

   pure function rotate_dp(q, v) result(u)
      real(dp), intent(in) :: q(4), v(3)
      real(dp) :: u(3)
      u = real(rotate_qp(real(q, qp), real(v, qp)), dp)
   end function rotate_dp

   pure function rotate_back_qp(q, v) result(u)
      real(qp), intent(in) :: q(4), v(3)
      real(qp) :: u(3)
      u = rotate_qp([q(1), -q(2:4)], v)
   end function rotate_back_qp

   pure function rotate_back_dp(q, v) result(u)
      real(dp), intent(in) :: q(4), v(3)
      real(dp) :: u(3)
      u = rotate_dp([q(1), -q(2:4)], v)
   end function rotate_back_dp

   !> The matrix of v x.
   pure function hat(v) result(m)
      real(qp), intent(in) :: v(3)
      real(qp) :: m(3, 3)
      m = reshape([0.0_qp, v(3), -v(2), -v(3), 0.0_qp, v(1), v(2), -v(1), 0.0_qp], [3, 3])
   end function hat

end module test_oracle_algebra
