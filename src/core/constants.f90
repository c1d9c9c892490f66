!> Constants that several modules need.
module poinsot_core_constants
   use poinsot_core_kinds, only: dp, i8
   implicit none(type, external)
   private
   public :: pi, quarter_turn, exponent_bits

   real(dp), parameter :: pi = 3.1415926535897932_dp
   real(dp), parameter :: quarter_turn = pi/2 !! 90 degrees
   !> The bits of a double that hold its exponent: all set, it is infinite or a NaN.
   integer(i8), parameter :: exponent_bits = int(z'7FF0000000000000', i8)

end module poinsot_core_constants
