!> Largest values that do not lose a NaN: the intrinsics max and maxval may, and an error that is
!> NaN would pass for a small one.
module poinsot_core_maxima
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: larger, largest_of

contains

   !> The larger of two numbers; one that is not finite, if there is one.
   elemental real(dp) function larger(a, b)
      real(dp), intent(in) :: a, b
      larger = a
      if (.not. ieee_is_finite(a)) return
      larger = b
      if (.not. ieee_is_finite(b)) return
      larger = max(a, b)
   end function larger

   !> The largest of some numbers; one that is not finite, if there is one. -huge of none.
   pure real(dp) function largest_of(values) result(largest)
      real(dp), intent(in) :: values(:)
      integer :: i
      largest = -huge(largest)
      do i = 1, size(values)
         largest = larger(largest, values(i))
      end do
   end function largest_of

end module poinsot_core_maxima
