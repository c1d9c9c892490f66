!> What a map (y, q) -> (y', q') keeps: Poisson, symplectic, reversible, the invariants. The map is
!> a procedure on plain state in quadruple precision; a map of double precision is wrapped, with a
!> longer difference.
!>
!> Symplectic on T*SO(3): in the left trivialisation dQ = Q xi^, with momentum y, the canonical form
!> is Omega((xi1, dy1), (xi2, dy2)) = dy1.xi2 - dy2.xi1 + xi1.(y x xi2),
!> the same as the canonical form in any coordinates; the tangent map M must satisfy M^T Omega(y') M
!> = Omega(y).
module test_oracle_properties
   use poinsot_core_kinds, only: dp, qp
   use test_oracle_algebra, only: hat, quaternion_product, rotate
   implicit none(type, external)
   private
   public :: plain_map, tangent_map, property_report, measure_properties

   !> A one-step map on one body.
   type, abstract :: plain_map
      real(qp) :: delta = 1.0e-3_qp !! of the differences; 1e-2 suits double precision
   contains
      procedure(apply_map), deferred :: apply
   end type plain_map

   abstract interface
      !> One step h; `ok` = .false. if the map has no answer.
      subroutine apply_map(self, h, y, q, ok)
         import :: plain_map, qp
         implicit none(type, external)
         class(plain_map), intent(in) :: self
         real(qp), intent(in) :: h
         real(qp), intent(inout) :: y(3), q(4)
         logical, intent(out) :: ok
      end subroutine apply_map
   end interface

   !> Defects, relative: near the accuracy of the differences if the property holds.
   type :: property_report
      logical :: ok = .false.         !! the map answered everywhere
      real(dp) :: poisson = 0         !! D y^ D^T - y'^, D = dy'/dy, and dependence of y' on q
      real(dp) :: symplectic = 0      !! M^T Omega(y') M - Omega(y)
      real(dp) :: volume = 0          !! |det M| - 1
      real(dp) :: symmetric = 0       !! map(-h) after map(h), against the identity
      real(dp) :: reversible = 0      !! map(h) from (-y, q), against map(-h) with y turned
      real(dp) :: space_momentum = 0  !! Q'y' - Qy
      real(dp) :: casimir = 0         !! |y'| - |y|
      real(dp) :: energy = 0          !! H(y') - H(y)
      real(dp) :: norm = 0            !! |q'| - |q|
      real(dp) :: equivariant = 0     !! map from (y, p o q) against p o (map from (y, q))
   end type property_report

contains

   !> All defects of the map for one body and one step.
   subroutine measure_properties(map, inverse, h, y, q, report)
      class(plain_map), intent(in) :: map
      real(qp), intent(in) :: inverse(3)  !! 1/I
      real(qp), intent(in) :: h, y(3), q(4)
      type(property_report), intent(out) :: report
      real(qp) :: y1(3), q1(4), tangent(6, 6), size
      logical :: ok
      size = sqrt(sum(y*y))
      y1 = y
      q1 = q
      call map%apply(h, y1, q1, ok)
      if (.not. ok) return
      call tangent_map(map, h, y, q, tangent, ok)
      if (.not. ok) return
      call poisson_defect(tangent, y, y1, report%poisson)
      call symplectic_defect(tangent, y, y1, report%symplectic)
      report%volume = real(abs(abs(determinant(tangent)) - 1), dp)
      report%space_momentum = real(norm2(rotate(q1, y1) - rotate(q, y))/size, dp)
      report%casimir = real(abs(sqrt(sum(y1*y1)) - size)/size, dp)
      report%energy = real(abs(sum(inverse*(y1 - y)*(y1 + y)))/sum(inverse*y*y), dp)
      report%norm = real(abs(sqrt(sum(q1*q1)) - sqrt(sum(q*q))), dp)
      call reversal_defects(map, h, y, q, report, ok)
      report%ok = ok
   end subroutine measure_properties

   !> The defects that compare two ways of stepping.
   subroutine reversal_defects(map, h, y, q, report, ok)
      class(plain_map), intent(in) :: map
      real(qp), intent(in) :: h, y(3), q(4)
      type(property_report), intent(inout) :: report
      logical, intent(out) :: ok
      real(qp), parameter :: p(4) = [0.5_qp, -0.5_qp, 0.5_qp, 0.5_qp]
      real(qp) :: y1(3), q1(4), y2(3), q2(4), size
      logical :: good(4)
      size = sqrt(sum(y*y))
      y1 = y
      q1 = q
      call map%apply(h, y1, q1, good(1))
      y2 = y
      q2 = quaternion_product(p, q)
      call map%apply(h, y2, q2, good(2))
      report%equivariant = real(norm2(y2 - y1)/size + norm2(q2 - quaternion_product(p, q1)), dp)
      call map%apply(-h, y1, q1, good(3))
      report%symmetric = real(norm2(y1 - y)/size + norm2(q1 - q), dp)
      y1 = -y
      q1 = q
      call map%apply(h, y1, q1, good(3))
      y2 = y
      q2 = q
      call map%apply(-h, y2, q2, good(4))
      report%reversible = real(norm2(y1 + y2)/size + norm2(q1 - q2), dp)
      ok = all(good)
   end subroutine reversal_defects

   !> The tangent map in left-trivialised coordinates (xi, dy/|y|), by central differences of order
   !> 8.
   subroutine tangent_map(map, h, y, q, tangent, ok)
      class(plain_map), intent(in) :: map
      real(qp), intent(in) :: h, y(3), q(4)
      real(qp), intent(out) :: tangent(6, 6)
      logical, intent(out) :: ok
      real(qp), parameter :: weight(4) = [4.0_qp/5, -1.0_qp/5, 4.0_qp/105, -1.0_qp/280]
      real(qp) :: y0(3), q0(4), y1(3), q1(4), size, push(6), image(6)
      integer :: column, k, side
      logical :: good
      size = sqrt(sum(y*y))
      y0 = y
      q0 = q
      tangent = 0
      call map%apply(h, y0, q0, ok)
      do column = 1, 6
         do k = 1, 4
            do side = -1, 1, 2
               push = 0
               push(column) = side*k*map%delta
               q1 = quaternion_product(q, exponential(push(1:3)))
               y1 = y + push(4:6)*size
               call map%apply(h, y1, q1, good)
               ok = ok .and. good
               image = [logarithm(q0, q1), (y1 - y0)/size]
               tangent(:, column) = tangent(:, column) + side*weight(k)/map%delta*image
            end do
         end do
      end do
   end subroutine tangent_map

   !> D y^ D^T against y'^, and the block that says whether y' depends on q.
   pure subroutine poisson_defect(tangent, y, y1, defect)
      real(qp), intent(in) :: tangent(6, 6), y(3), y1(3)
      real(dp), intent(out) :: defect
      real(qp), dimension(3, 3) :: d, transposed, before, after, difference
      real(qp) :: size
      size = sqrt(sum(y*y))
      d = tangent(4:6, 4:6)
      transposed = transpose(d)
      before = hat(y/size)
      after = hat(y1/size)
      difference = matmul(before, transposed)
      difference = matmul(d, difference) - after
      defect = real(max(maxval(abs(difference)), maxval(abs(tangent(4:6, 1:3)))), dp)
   end subroutine poisson_defect

   pure subroutine symplectic_defect(tangent, y, y1, defect)
      real(qp), intent(in) :: tangent(6, 6), y(3), y1(3)
      real(dp), intent(out) :: defect
      real(qp), dimension(6, 6) :: transposed, before, after, difference
      real(qp) :: size
      size = sqrt(sum(y*y))
      transposed = transpose(tangent)
      before = form(y/size)
      after = form(y1/size)
      difference = matmul(after, tangent)
      difference = matmul(transposed, difference) - before
      defect = real(maxval(abs(difference)), dp)
   end subroutine symplectic_defect

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

   !> The unit quaternion of the rotation vector.
   pure function exponential(turn) result(q)
      real(qp), intent(in) :: turn(3)
      real(qp) :: q(4), half
      half = sqrt(sum(turn*turn))/2
      q = [cos(half), turn/2]
      if (half > 0) q(2:4) = turn/2*(sin(half)/half)
   end function exponential

   !> The rotation vector from q0 to q1, seen in the frame of q0.
   pure function logarithm(q0, q1) result(turn)
      real(qp), intent(in) :: q0(4), q1(4)
      real(qp) :: turn(3), r(4), s
      r = quaternion_product([q0(1), -q0(2:4)], q1)
      if (r(1) < 0) r = -r
      s = sqrt(sum(r(2:4)**2))
      turn = 2*r(2:4)
      if (s > 0) turn = 2*r(2:4)*(atan2(s, r(1))/s)
   end function logarithm

   !> By elimination with row exchanges.
   pure real(qp) function determinant(matrix)
      real(qp), intent(in) :: matrix(:, :)
      real(qp) :: a(size(matrix, 1), size(matrix, 1)), row(size(matrix, 1))
      integer :: i, k, pivot
      a = matrix
      determinant = 1
      do k = 1, size(a, 1)
         pivot = k - 1 + maxloc(abs(a(k:, k)), dim=1)
         if (pivot /= k) then
            row = a(k, :)
            a(k, :) = a(pivot, :)
            a(pivot, :) = row
            determinant = -determinant
         end if
         determinant = determinant*a(k, k)
         if (determinant == 0) return
         do i = k + 1, size(a, 1)
            a(i, k:) = a(i, k:) - a(i, k)/a(k, k)*a(k, k:)
         end do
      end do
   end function determinant

end module test_oracle_properties
