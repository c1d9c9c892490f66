!> Stateless random numbers: a pure function of (seed, body, step, stream), so results depend
!> neither on threads nor on order nor on restarts.
!>
!> Philox4x32-10 (J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, SC11, 2011): the seed is the
!> key, the counter contains body, step and stream. 32-bit words are stored in 64-bit integers with
!> masks, so nothing overflows.
module poinsot_rotation_random
   use poinsot_core_constants, only: pi
   use poinsot_core_kinds, only: dp, i4, i8, lanes
   use poinsot_core_libm, only: cosine, logarithm, sine
   use poinsot_rotation_vector, only: unit_vector
   use poinsot_rotation_quaternion, only: normalise
   implicit none(type, external)
   private
   public :: philox4x32, philox_block, random_words, uniform_from_words
   public :: random_uniform, random_gaussian, random_quaternion, random_direction
   public :: stream_attitude, stream_direction, stream_momentum, stream_noise

   !> The use of each stream, so that no number is drawn twice. A stream gives two doubles
   !> per body and step.
   integer(i4), parameter :: stream_attitude = 0_i4  !! and 1: initial attitudes
   integer(i4), parameter :: stream_direction = 2_i4 !! initial directions
   integer(i4), parameter :: stream_momentum = 4_i4  !! and 5: initial momenta
   integer(i4), parameter :: stream_noise = 16_i4    !! and beyond: noise within a step

   integer(i8), parameter :: low_16 = int(z"FFFF", i8), low_32 = int(z"FFFFFFFF", i8)
   integer(i8), parameter :: multiplier(2) = [int(z"D2511F53", i8), int(z"CD9E8D57", i8)]
   integer(i8), parameter :: weyl(2) = [int(z"9E3779B9", i8), int(z"BB67AE85", i8)]
   integer, parameter :: rounds = 10


contains

   !> High and low 32 bits of a 32 x 32 bit product; the partial products stay below 2**49.
   elemental subroutine multiply_words(a, b, high, low)
      integer(i8), intent(in) :: a, b
      integer(i8), intent(out) :: high, low
      integer(i8) :: lower, upper
      lower = a*iand(b, low_16)
      upper = a*shiftr(b, 16) + shiftr(lower, 16)
      high = shiftr(upper, 16)
      low = ior(shiftl(iand(upper, low_16), 16), iand(lower, low_16))
   end subroutine multiply_words

   !> One of the ten rounds, with the key of that round.
   elemental subroutine philox_round(key1, key2, w1, w2, w3, w4)
      integer(i8), intent(in) :: key1, key2
      integer(i8), intent(inout) :: w1, w2, w3, w4
      integer(i8) :: high1, low1, high2, low2
      call multiply_words(multiplier(1), w1, high1, low1)
      call multiply_words(multiplier(2), w3, high2, low2)
      w1 = ieor(ieor(high2, w2), key1)
      w3 = ieor(ieor(high1, w4), key2)
      w2 = low2
      w4 = low1
   end subroutine philox_round

   !> One Philox4x32-10 block: four random words of four counter words and two key words.
   elemental subroutine philox4x32(c1, c2, c3, c4, k1, k2, w1, w2, w3, w4)
      integer(i8), intent(in) :: c1, c2, c3, c4   !! counter words, 0 to 2**32 - 1, least first
      integer(i8), intent(in) :: k1, k2           !! key words, 0 to 2**32 - 1
      integer(i8), intent(out) :: w1, w2, w3, w4  !! random words, 0 to 2**32 - 1
      integer :: round
      w1 = c1; w2 = c2; w3 = c3; w4 = c4
      do round = 0, rounds - 1
         call philox_round(iand(k1 + round*weyl(1), low_32), iand(k2 + round*weyl(2), low_32), &
            w1, w2, w3, w4)
      end do
   end subroutine philox4x32

   !> The same for every lane of a block: rounds outside, so that the loop over lanes is vectorised.
   pure subroutine philox_block(key, counter, word)
      integer(i8), intent(in) :: key(2)            !! key words, as above
      integer(i8), intent(in) :: counter(lanes, 4) !! counter words
      integer(i8), intent(out) :: word(lanes, 4)   !! random words
      integer(i8) :: k(2)
      integer :: round, i
      word = counter
      do round = 0, rounds - 1
         k = iand(key + round*weyl, low_32)
         !$omp simd
         do i = 1, lanes
            call philox_round(k(1), k(2), word(i, 1), word(i, 2), word(i, 3), word(i, 4))
         end do
      end do
   end subroutine philox_block

   !> Four random words of (seed, id, step, stream).
   elemental subroutine random_words(seed, id, step, stream, w1, w2, w3, w4)
      integer(i8), intent(in) :: seed             !! any
      integer(i8), intent(in) :: id               !! which body: any, negative too
      integer(i8), intent(in) :: step             !! which step: its low 48 bits count
      integer(i4), intent(in) :: stream           !! what for: its low 16 bits count
      integer(i8), intent(out) :: w1, w2, w3, w4  !! 0 to 2**32 - 1
      call philox4x32(iand(id, low_32), ishft(id, -32), iand(step, low_32), &
         ior(iand(ishft(step, -32), low_16), ishft(iand(int(stream, i8), low_16), 16)), &
         iand(seed, low_32), ishft(seed, -32), w1, w2, w3, w4)
   end subroutine random_words

   !> A double strictly inside (0, 1) from two random words: the middle of one of 2**52 equal cells.
   elemental real(dp) function uniform_from_words(high, low)
      integer(i8), intent(in) :: high !! 0 to 2**32 - 1
      integer(i8), intent(in) :: low  !! 0 to 2**32 - 1, its upper 20 bits count
      uniform_from_words = (real(ior(ishft(high, 20), ishft(low, -12)), dp) + 0.5_dp)*2._dp**(-52)
   end function uniform_from_words

   !> Two independent uniform numbers strictly inside (0, 1).
   pure function random_uniform(seed, id, step, stream) result(u)
      integer(i8), intent(in) :: seed   !! any
      integer(i8), intent(in) :: id     !! which body
      integer(i8), intent(in) :: step   !! which step
      integer(i4), intent(in) :: stream !! what for
      real(dp) :: u(2)
      integer(i8) :: w(4)
      call random_words(seed, id, step, stream, w(1), w(2), w(3), w(4))
      u = uniform_from_words(w([1, 3]), w([2, 4]))
   end function random_uniform

   !> Two independent normal numbers, mean 0 and variance 1 (G. E. P. Box and M. E. Muller, 1958).
   pure function random_gaussian(seed, id, step, stream) result(g)
      integer(i8), intent(in) :: seed   !! any
      integer(i8), intent(in) :: id     !! which body
      integer(i8), intent(in) :: step   !! which step
      integer(i4), intent(in) :: stream !! what for
      real(dp) :: g(2)
      real(dp) :: u(2)
      u = random_uniform(seed, id, step, stream)
      g = sqrt(-2*logarithm(u(1)))*[cosine(2*pi*u(2)), sine(2*pi*u(2))]
   end function random_gaussian

   !> An attitude, uniform over all rotations (K. Shoemake, Graphics Gems III, 1992).
   pure function random_quaternion(seed, id) result(q)
      integer(i8), intent(in) :: seed !! any
      integer(i8), intent(in) :: id   !! which body
      real(dp) :: q(4)
      real(dp) :: u(2), turn(2)
      u = random_uniform(seed, id, 0_i8, stream_attitude)
      turn = 2*pi*random_uniform(seed, id, 0_i8, stream_attitude + 1_i4)
      q(1:2) = sqrt(1 - u(1))*[sine(turn(1)), cosine(turn(1))]
      q(3:4) = sqrt(u(1))*[sine(turn(2)), cosine(turn(2))]
      q = normalise(q)
   end function random_quaternion

   !> A direction, uniform on the unit sphere.
   pure function random_direction(seed, id) result(v)
      integer(i8), intent(in) :: seed !! any
      integer(i8), intent(in) :: id   !! which body
      real(dp) :: v(3)
      real(dp) :: u(2), z
      u = random_uniform(seed, id, 0_i8, stream_direction)
      z = 2*u(1) - 1
      v = unit_vector([sqrt((1 - z)*(1 + z))*[cosine(2*pi*u(2)), sine(2*pi*u(2))], z])
   end function random_direction

end module poinsot_rotation_random
