!> The two series P and R that turn a body's moments into the modified moments of the Moser-Veselov
!> map (mathematics, sections 2 and 3): power series in h^2 whose coefficient of degree n is a
!> homogeneous polynomial in (p, r).
!>
!> Their coefficients are polynomials in b = a1 a2, c = a2 a3 and a2, tabulated once for all bodies
!> by tools/series_table.py; no difference of moments is divided by, so that nearly symmetric,
!> nearly spherical and nearly linear bodies cost no digits. R is the mirror image of P.
module poinsot_body_series
   use poinsot_core_kinds, only: dp
   use poinsot_body_series_table, only: table_degree, even_5, even_6, even_7, even_8, even_9, &
      even_10, even_11, even_12, even_13, odd_5, odd_6, odd_7, odd_8, odd_9, odd_10, odd_11, &
      odd_12, odd_13
   implicit none(type, external)
   private
   public :: max_degree, first_tabulated, correction_series, degree_bound

   integer, parameter :: max_degree = table_degree !! highest power of h^2 that is tabulated
   integer, parameter :: first_tabulated = 5       !! lower ones: poinsot_body_series_start
   integer, parameter :: block = 4                 !! rows of the table come in blocks of so many

contains

   !> Degrees 5 and up of P and R of one body. Column n holds the part of degree n: `p(i, n)`
   !> multiplies p^i r^(n-i), where p and r already carry h^2. Vilmart and Hairer (2006).
   pure subroutine correction_series(a, degree, p, r)
      real(dp), intent(in) :: a(3)        !! (I3-I2)/I1, (I3-I1)/I2, (I2-I1)/I3, sorted
      integer, intent(in) :: degree       !! the highest wanted, at most max_degree
      real(dp), intent(inout) :: p(0:max_degree, 0:max_degree) !! coefficients of P; lower degrees
                                                               !! are not touched
      real(dp), intent(inout) :: r(0:max_degree, 0:max_degree) !! coefficients of R
      real(dp) :: b(0:max_degree), c(0:max_degree)
      integer :: n
      b(0) = 1
      c(0) = 1
      do n = 1, max_degree
         b(n) = b(n - 1)*(a(1)*a(2))
         c(n) = c(n - 1)*(a(2)*a(3))
      end do
      do n = first_tabulated, degree
         select case (n)
         case (5)
            call part(n, even_5, odd_5, b, c, a(2), p(0, n), r(0, n))
         case (6)
            call part(n, even_6, odd_6, b, c, a(2), p(0, n), r(0, n))
         case (7)
            call part(n, even_7, odd_7, b, c, a(2), p(0, n), r(0, n))
         case (8)
            call part(n, even_8, odd_8, b, c, a(2), p(0, n), r(0, n))
         case (9)
            call part(n, even_9, odd_9, b, c, a(2), p(0, n), r(0, n))
         case (10)
            call part(n, even_10, odd_10, b, c, a(2), p(0, n), r(0, n))
         case (11)
            call part(n, even_11, odd_11, b, c, a(2), p(0, n), r(0, n))
         case (12)
            call part(n, even_12, odd_12, b, c, a(2), p(0, n), r(0, n))
         case default
            call part(n, even_13, odd_13, b, c, a(2), p(0, n), r(0, n))
         end select
      end do
   end subroutine correction_series

   !> The part of degree n: P_i = E(b, c) + a2 O(b, c), R_(n-i) = E(c, b) - a2 O(c, b). Blocks of
   !> rows are summed over the powers m in registers.
   pure subroutine part(n, even, odd, b, c, a2, p, r)
      integer, intent(in) :: n
      real(dp), intent(in) :: even(*), odd(*), b(0:max_degree), c(0:max_degree), a2
      real(dp), intent(inout) :: p(0:n), r(0:n)
      real(dp), dimension(0:max_degree + block) :: ps, rs
      real(dp), dimension(block) :: e, o, em, om
      integer :: i, k, m, row, next
      ps = 0
      rs = 0
      next = 0
      do k = 0, n - 1
         do row = k, n, block
            e = 0
            o = 0
            em = 0
            om = 0
            do m = 0, n - row
               !$omp simd
               do i = 1, block
                  e(i) = e(i) + even(next + i)*b(m)
                  o(i) = o(i) + odd(next + i)*b(m)
                  em(i) = em(i) + even(next + i)*c(m)
                  om(i) = om(i) + odd(next + i)*c(m)
               end do
               next = next + block
            end do
            do i = 1, block
               ps(row + i - 1) = ps(row + i - 1) + (e(i) + a2*o(i))*c(k)
               rs(row + i - 1) = rs(row + i - 1) + (em(i) - a2*om(i))*b(k)
            end do
         end do
      end do
      do i = 0, n
         p(i) = ps(i)
         r(n - i) = rs(i)
      end do
   end subroutine part

   !> A bound of the part of degree n on p + r = 1, p, r >= 0: the largest coefficient of its
   !> Bernstein form.
   pure real(dp) function degree_bound(c, n)
      real(dp), intent(in) :: c(0:) !! coefficients of p^i r^(n-i), i = 0 to n
      integer, intent(in) :: n      !! degree
      real(dp) :: binomial
      integer :: i
      degree_bound = 0
      binomial = 1
      do i = 0, n
         degree_bound = max(degree_bound, abs(c(i))/binomial)
         binomial = binomial*(n - i)/(i + 1)
      end do
   end function degree_bound

end module poinsot_body_series
