!> The two series P and R that turn a body's moments into the modified moments of the Moser-Veselov
!> map (mathematics, sections 2 and 3).
!>
!> Each is a power series in h^2 whose n-th coefficient is a homogeneous polynomial of degree n in
!> (p, r). They come from a Taylor recursion without any division by a difference of moments, so
!> that nearly symmetric, nearly spherical and nearly linear bodies cost no digits.
module poinsot_body_series
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: max_degree, degree_bound, correction_series

   integer, parameter :: max_degree = 13 !! highest power of h^2 that is tabulated

   !> A truncated series in t^2: column n holds the n + 1 coefficients of its homogeneous part of
   !> degree n, `c(i, n)` belonging to p^i r^(n-i).
   type :: series
      real(dp) :: c(0:max_degree, 0:max_degree) = 0.0_dp
   end type series

contains

   !> P and R of one body: `p(i,j)` multiplies p^i r^j, where p and r already carry h^2.
   !> Vilmart and Hairer (2006); recursion of mathematics section 3.
   pure subroutine correction_series(a, p, r)
      real(dp), intent(in) :: a(3)                      !! (I3-I2)/I1, (I3-I1)/I2, (I2-I1)/I3,
                                                        !! sorted
      real(dp), intent(out) :: p(0:max_degree, 0:max_degree)      !! coefficients of 1 + P
      real(dp), intent(out) :: r(0:max_degree, 0:max_degree)      !! coefficients of 1 + R
      type(series) :: f, g, k, q0, q1, q2, q3, rho, w
      integer :: n

      f%c(0, 0) = 1
      g%c(0, 0) = 1
      q0%c(0, 0) = 1
      do n = 0, max_degree
         if (n > 0) then
            call add(f, n, -a(1)/(2*n), product_part(k, g, n - 1), 0, 1)
            call add(g, n, -a(3)/(2*n), product_part(k, f, n - 1), 1, 0)
            call add(q0, n, -1.0_dp/(4*n), product_part(q1, f, n - 1), 1, 0)
            call add(q0, n, -1.0_dp/(4*n), product_part(q3, g, n - 1), 0, 1)
            if (n > 1) call add(q0, n, -1.0_dp/(4*n), product_part(q2, k, n - 2), 1, 1)
         end if
         call add(k, n, a(2)/(2*n + 1), product_part(f, g, n), 0, 0)
         call add(q1, n, 0.5_dp/(2*n + 1), product_part(q0, f, n), 0, 0)
         call add(q3, n, 0.5_dp/(2*n + 1), product_part(q0, g, n), 0, 0)
         if (n > 0) then
            call add(q1, n, 0.5_dp/(2*n + 1), product_part(q2, g, n - 1) - product_part(q3, k, n &
               - 1), 0, 1)
            call add(q3, n, 0.5_dp/(2*n + 1), product_part(q1, k, n - 1) - product_part(q2, f, n &
               - 1), 1, 0)
         end if
         call add(q2, n, 0.5_dp/(2*n + 2), &
                  product_part(q0, k, n) - product_part(q1, g, n) + product_part(q3, f, n), 0, 0)
         call add(rho, n, 1.0_dp, product_part(q0, q0, n), 0, 0)
         if (n > 0) call add(rho, n, -1.0_dp, product_part(q1, q1, n - 1), 1, 0)
         if (n > 0) call add(rho, n, -1.0_dp, product_part(q3, q3, n - 1), 0, 1)
         if (n > 1) call add(rho, n, 1.0_dp, product_part(q2, q2, n - 2), 1, 1)
      end do

      w = combination(q0, q1, q2, q3, -1.0_dp, [0, 1])
      call table(quotient(times(rho, w), f), p)
      w = combination(q0, q3, q1, q2, 1.0_dp, [1, 0])
      call table(quotient(times(rho, w), g), r)
   end subroutine correction_series

   !> A bound of the part of degree n on p + r = 1, p, r >= 0: the largest coefficient of its
   !> Bernstein form.
   pure real(dp) function degree_bound(c, n)
      real(dp), intent(in) :: c(0:max_degree, 0:max_degree) !! coefficients (i,j) of p^i r^j
      integer, intent(in) :: n                              !! degree
      real(dp) :: binomial
      integer :: i
      degree_bound = 0
      binomial = 1
      do i = 0, n
         degree_bound = max(degree_bound, abs(c(i, n - i))/binomial)
         binomial = binomial*(n - i)/(i + 1)
      end do
   end function degree_bound

   !> The part of degree n of a product.
   pure function product_part(x, y, n) result(part)
      type(series), intent(in) :: x, y
      integer, intent(in) :: n
      real(dp) :: part(0:max_degree)
      integer :: i, j, m
      part = 0
      do m = 0, n
         do j = 0, n - m
            do i = 0, m
               part(i + j) = part(i + j) + x%c(i, m)*y%c(j, n - m)
            end do
         end do
      end do
   end function product_part

   !> x_n += factor p^i r^j part, with part of degree n - i - j.
   pure subroutine add(x, n, factor, part, i, j)
      type(series), intent(inout) :: x
      integer, intent(in) :: n, i, j
      real(dp), intent(in) :: factor, part(0:max_degree)
      x%c(i:n - j, n) = x%c(i:n - j, n) + factor*part(0:n - i - j)
   end subroutine add

   pure type(series) function times(x, y)
      type(series), intent(in) :: x, y
      integer :: n
      do n = 0, max_degree
         times%c(:, n) = product_part(x, y, n)
      end do
   end function times

   !> x / y for a y that starts with 1.
   pure type(series) function quotient(x, y)
      type(series), intent(in) :: x, y
      integer :: n
      do n = 0, max_degree
         quotient%c(:, n) = 0
         quotient%c(:, n) = x%c(:, n) - product_part(quotient, y, n)
      end do
   end function quotient

   !> 2 (a b + sign p^i r^j c d), one of i, j being 1.
   pure type(series) function combination(a, b, c, d, sign, power)
      type(series), intent(in) :: a, b, c, d
      real(dp), intent(in) :: sign
      integer, intent(in) :: power(2)
      integer :: n
      do n = 0, max_degree
         combination%c(:, n) = 2*product_part(a, b, n)
         if (n > 0) call add(combination, n, 2*sign, product_part(c, d, n - 1), power(1), power(2))
      end do
   end function combination

   !> From powers of t^2 = h^2/4 to powers of h^2.
   pure subroutine table(x, c)
      type(series), intent(in) :: x
      real(dp), intent(out) :: c(0:max_degree, 0:max_degree)
      integer :: i, j
      c = square_form(x)
      do j = 0, max_degree
         do i = 0, max_degree - j
            c(i, j) = c(i, j)*0.25_dp**(i + j)
         end do
      end do
   end subroutine table

   !> Coefficients by powers of both variables.
   pure function square_form(x) result(c)
      type(series), intent(in) :: x
      real(dp) :: c(0:max_degree, 0:max_degree)
      integer :: i, n
      c = 0
      do n = 0, max_degree
         do i = 0, n
            c(i, n - i) = x%c(i, n)
         end do
      end do
   end function square_form

end module poinsot_body_series
