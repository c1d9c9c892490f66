!> The directions in space that torques depend on: an orthonormal basis of their span.
module poinsot_taylor_basis
   use poinsot_core_kinds, only: dp
   use poinsot_rotation_vector, only: cross
   implicit none(type, external)
   private
   public :: span_rows, add_direction

   real(dp), parameter :: nothing = 4*epsilon(1.0_dp)   !! relative length of what is left out

contains

   !> Add the part of a unit vector normal to the basis, normalised, unless it is zero.
   pure subroutine add_direction(v, basis, n)
      real(dp), intent(in) :: v(3)
      real(dp), intent(inout) :: basis(3, 3)   !! orthonormal columns
      integer, intent(inout) :: n              !! how many of them
      real(dp) :: r(3), start
      integer :: i
      if (n == 3) return
      start = norm2(v)
      r = v - matmul(basis(:, :n), matmul(v, basis(:, :n)))
      if (norm2(r) <= nothing*start) return
      r = r/norm2(r)
      do i = 1, 2
         r = r - matmul(basis(:, :n), matmul(r, basis(:, :n)))
         r = r/norm2(r)
      end do
      if (n == 2) then
         start = sign(1.0_dp, dot_product(r, cross(basis(:, 1), basis(:, 2))))
         r = start*cross(basis(:, 1), basis(:, 2))
      end if
      n = n + 1
      basis(:, n) = r
   end subroutine add_direction

   !> Add what rows (as columns here) span beside the basis: right singular vectors, the largest
   !> first, by one-sided Jacobi rotations (Hestenes 1958), which leave small singular values their
   !> digits.
   pure subroutine span_rows(rows, basis, n)
      real(dp), intent(in) :: rows(:, :)       !! (3, rows)
      real(dp), intent(inout) :: basis(3, 3)
      integer, intent(inout) :: n
      real(dp) :: a(size(rows, 2), 3), v(3, 3), length(3), largest, whole
      integer :: i, sweep
      if (size(rows) == 0 .or. n == 3) return
      largest = maxval(abs(rows))
      if (.not. largest > 0) return
      a = transpose(rows)/largest
      whole = norm2(a)
      a = a - matmul(matmul(a, basis(:, :n)), transpose(basis(:, :n)))
      v = 0
      do i = 1, 3
         v(i, i) = 1
      end do
      do sweep = 1, 12
         call rotate(1, 2, a, v)
         call rotate(1, 3, a, v)
         call rotate(2, 3, a, v)
      end do
      length = [norm2(a(:, 1)), norm2(a(:, 2)), norm2(a(:, 3))]
      do while (maxval(length) > nothing*whole)
         i = maxloc(length, 1)
         call add_direction(v(:, i), basis, n)
         length(i) = 0
      end do
   end subroutine span_rows

   !> Make columns i and j of a orthogonal, and turn those of v alike.
   pure subroutine rotate(i, j, a, v)
      integer, intent(in) :: i, j
      real(dp), intent(inout) :: a(:, :), v(3, 3)
      real(dp) :: x, y, c, s, t, old(size(a, 1)), turned(3)
      x = dot_product(a(:, i), a(:, j))
      if (abs(x) <= 1e-280_dp) return
      y = (dot_product(a(:, j), a(:, j)) - dot_product(a(:, i), a(:, i)))/(2*x)
      t = sign(1.0_dp, y)/(abs(y) + hypot(1.0_dp, y))
      c = 1/hypot(1.0_dp, t)
      s = c*t
      old = a(:, i)
      a(:, i) = c*old - s*a(:, j)
      a(:, j) = s*old + c*a(:, j)
      turned = v(:, i)
      v(:, i) = c*turned - s*v(:, j)
      v(:, j) = s*turned + c*v(:, j)
   end subroutine rotate

end module poinsot_taylor_basis
