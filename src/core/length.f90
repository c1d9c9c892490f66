!> The norm of a vector, bitwise the same in all units that differ by powers of two. The intrinsic
!> norm2 is not: it scales by the largest component, but starts from 1.
module poinsot_core_length
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp
   use poinsot_core_maxima, only: largest_of
   implicit none(type, external)
   private
   public :: length_of

contains

   !> |v|, also where squares would leave the range of numbers; of a vector that is not finite, a
   !> component that is not.
   pure real(dp) function length_of(v) result(length)
      real(dp), intent(in) :: v(:)
      integer :: power
      length = largest_of(abs(v))
      if (.not. ieee_is_finite(length)) return
      if (.not. length > 0) return
      power = exponent(length)
      length = scale(sqrt(sum(scale(v, -power)**2)), power)
   end function length_of

end module poinsot_core_length
