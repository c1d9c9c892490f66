!> The length of a vector with the same bits in all units that are powers of two. The intrinsic
!> norm2 has not: it scales by the largest component, but starts from 1.
module poinsot_core_length
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: length_of

contains

   !> |v|, also where squares would leave the range of numbers.
   pure real(dp) function length_of(v) result(length)
      real(dp), intent(in) :: v(:)    !! finite
      integer :: power
      length = maxval(abs(v))
      if (.not. length > 0) return
      power = exponent(length)
      length = scale(sqrt(sum(scale(v, -power)**2)), power)
   end function length_of

end module poinsot_core_length
