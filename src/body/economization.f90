!> The series of the exact step economized: cut short at less cost than leaving terms out (Lanczos'
!> telescoping).
!>
!> On p, r >= 0, p + r <= s a homogeneous part F of degree n is nearly a polynomial of lower degree.
!> With p = x^2, r = y^2 the triangle is a disc, and (x cos(t) + y sin(t))^(2n) is approximated
!> there as tau^n is on [0, 1]: by b_k tau^k with error e. F is a sum of such powers, so that the
!> same b_k serve: because the Laplacian takes each power to the next lower even one, F becomes
!> sum_k b_k s^(n-k) (2k)!/(2n)! Laplacian^(n-k) F, with error at most e s^n times the sum of
!> |weights|. For p^i r^j that sum is 1 (Gearhart 1973, J. Approx. Theory 8, 195).
!>
!> The degrees kept begin at 5, not at 0: the shorter series of the small steps stays as it is, and
!> the error vanishes like s^5 for them.
module poinsot_body_economization
   use poinsot_core_kinds, only: dp
   use poinsot_body_series, only: max_degree
   implicit none(type, external)
   private
   public :: first_kept, last_kept, economized, economization_bound

   integer, parameter :: first_kept = 5 !! degrees kept: this
   integer, parameter :: last_kept = 7  !! to this

   !> b_k of tau^n on [0, 1], n = 8 to max_degree, telescoped by Jacobi's polynomials of parameters
   !> (-1/2, 21/2): near to the best for an error that is multiplied by sqrt(tau).
   real(dp), parameter :: replacement(first_kept:last_kept, last_kept + 1:max_degree) = reshape([ &
      0.57756696428571429_dp, -2.109375_dp, 2.53125_dp, &
      1.4778919380252101_dp, -4.7977941176470588_dp, 4.3180147058823529_dp, &
      2.545258337710084_dp, -7.7464384191176471_dp, 6.1971507352941176_dp, &
      3.68392654142249_dp, -10.763472329721362_dp, 8.0726042472910217_dp, &
      4.8351535856170182_dp, -13.734639170738197_dp, 9.8889402029315015_dp, &
      5.9633560889276558_dp, -16.593686508320433_dp, 11.615580555824303_dp], [3, 6])

   !> Largest |tau^n - sum b_k tau^k|, rounded up.
   real(dp), parameter :: error(last_kept + 1:max_degree) = &
      [0.000963_dp, 0.00301_dp, 0.00595_dp, 0.00955_dp, 0.0136_dp, 0.0179_dp]

contains

   !> The kept degrees of a series on p + r <= s, with what they take over from the higher ones.
   !> `kept(m, j)` multiplies p^(5-j+m) r^j for j <= 5; the last column belongs to r^6, p r^6, r^7.
   pure function economized(c, s) result(kept)
      real(dp), intent(in) :: c(0:max_degree, 0:max_degree) !! coefficients (i, n) of p^i r^(n-i)
      real(dp), intent(in) :: s                             !! largest p + r
      real(dp) :: kept(0:2, 0:6)
      real(dp) :: part(0:max_degree), sums(0:last_kept, first_kept:last_kept)
      integer :: j, k, n
      do k = first_kept, last_kept
         sums(0:k, k) = c(0:k, k)
      end do
      do n = last_kept + 1, max_degree
         part(0:n) = c(0:n, n)
         do k = n - 1, first_kept, -1
            call lower(part, k + 1, s)
            if (k <= last_kept) sums(0:k, k) = sums(0:k, k) + replacement(k, n)*part(0:k)
         end do
      end do
      do j = 0, 5
         kept(:, j) = [sums(5 - j, 5), sums(6 - j, 6), sums(7 - j, 7)]
      end do
      kept(:, 6) = [sums(0, 6), sums(1, 7), sums(0, 7)]
   end function economized

   !> s/(2n (2n - 1)) times the Laplacian of a form of degree n in p = x^2 and r = y^2.
   pure subroutine lower(part, n, s)
      real(dp), intent(inout) :: part(0:max_degree) !! coefficient i: p^i r^(n-i)
      integer, intent(in) :: n
      real(dp), intent(in) :: s
      integer :: i
      do i = 0, n - 1
         part(i) = ((2*i + 2)*(2*i + 1)*part(i + 1) + (2*(n - i))*(2*(n - i) - 1)*part(i)) &
                   *(s/((2*n)*(2*n - 1)))
      end do
      part(n) = 0
   end subroutine lower

   !> A bound of the error that the part of degree n leaves on p + r = 1: not more than
   !> economization_bound s^n on p + r <= s.
   pure real(dp) function economization_bound(c, n)
      real(dp), intent(in) :: c(0:) !! coefficients of p^i r^(n-i), i = 0 to n
      integer, intent(in) :: n      !! degree, above last_kept
      economization_bound = error(n)*sum(abs(c(0:n)))
   end function economization_bound

end module poinsot_body_economization
