!> Median, quantiles and slopes of a few numbers.
module poinsot_study_statistics
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp
   use poinsot_core_maxima, only: largest_of
   implicit none(type, external)
   private
   public :: quantile, median, line_slope

contains

   !> Quantile, interpolated between neighbours; 0 without numbers.
   pure real(dp) function quantile(x, part)
      real(dp), intent(in) :: x(:)      !! finite numbers
      real(dp), intent(in) :: part      !! 0 the least, 0.5 the median, 1 the largest
      real(dp) :: s(size(x)), place, keep
      integer :: i, j
      quantile = 0
      if (size(x) == 0) return
      if (.not. all(ieee_is_finite(x))) then
         quantile = largest_of(x)
         return
      end if
      s = x
      do i = 2, size(s)
         keep = s(i)
         do j = i - 1, 1, -1
            if (s(j) <= keep) exit
            s(j + 1) = s(j)
         end do
         s(j + 1) = keep
      end do
      place = 1 + part*(size(s) - 1)
      i = min(int(place), max(1, size(s) - 1))
      j = min(i + 1, size(s))
      quantile = s(i) + (place - i)*(s(j) - s(i))
   end function quantile

   !> The median.
   pure real(dp) function median(x)
      real(dp), intent(in) :: x(:)
      median = quantile(x, 0.5_dp)
   end function median

   !> Slope of the straight line through points of equal distance 1, by least squares.
   pure real(dp) function line_slope(z)
      real(dp), intent(in) :: z(:)
      real(dp) :: middle, above, below
      integer :: i
      line_slope = 0
      if (size(z) < 2) return
      middle = 0.5_dp*(size(z) + 1)
      above = 0
      below = 0
      do i = 1, size(z)
         above = above + (i - middle)*z(i)
         below = below + (i - middle)**2
      end do
      line_slope = above/below
   end function line_slope

end module poinsot_study_statistics
