!> Constants of the Taylor integrator's lanes.
module poinsot_taylor_lanes_common
   use poinsot_core_kinds, only: sp, dp, i8
   implicit none(type, external)
   private
   public :: fastest, slowest, two_ones, smallest, one_bits, per_bit, bits_per, &
      longest_turn, almost_one, most_parts, grid_bits, grid_limit

   real(dp), parameter :: fastest = 2.0_dp**232         !! rates from here on are looked at
   real(dp), parameter :: slowest = 2.0_dp**(-900)      !! no rate of scaled time is below this
   !> Bits of 1/x are these less those of x, for a power of two x.
   integer(i8), parameter :: two_ones = int(z'7FE0000000000000', i8)

   !> Logarithm and power to base 2 by the bits of a number, within 0.04.
   real(sp), parameter :: one_bits = 1064992512.0_sp, bits_per = 2.0_sp**23, &
      per_bit = 2.0_sp**(-23)
   real(sp), parameter :: smallest = 1e-36_sp           !! coefficient that counts

   real(sp), parameter :: longest_turn = 2.4_sp         !! h omega of a substep
   real(sp), parameter :: almost_one = 0.99999_sp       !! a part in 1e5 is not worth a substep
   real(sp), parameter :: most_parts = 1e9_sp           !! of a step h

   !> Substeps are multiples of 2^-41 of what is left of h: added to 1.5 2^(e + 11), they round so.
   integer(i8), parameter :: grid_bits = ishft(11_i8, 52), grid_limit = ishft(2040_i8, 52)

end module poinsot_taylor_lanes_common
