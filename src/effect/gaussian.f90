!> Gaussian random numbers for a block: a function of (seed, body, step, half) and of nothing else,
!> so that they depend neither on threads nor on the place of a body nor on the steps per call, and
!> need no state to restart.
!>
!> Philox4x32-10 (Salmon, Moraes, Dror, Shaw 2011), then Box and Muller (1958) with 32-bit uniforms:
!> the largest possible value is 6.66. Multiplications are split so that no 64-bit product
!> overflows.
module poinsot_effect_gaussian
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_elliptic_elementary, only: log_block, sincos_block
   use poinsot_rotation_random, only: stream_noise
   implicit none(type, external)
   private
   public :: gaussian_block, philox_block

   integer(i8), parameter :: low32 = 4294967295_i8
   integer(i8), parameter :: low16 = 65535_i8
   ! the words of poinsot_rotation_random, in a form that vectorises over lanes
   integer(i8), parameter :: weyl(2) = [2654435769_i8, 3144134277_i8]
   integer(i8), parameter :: factor_high(2) = [53841_i8, 52638_i8]  !! of D2511F53, CD9E8D57
   integer(i8), parameter :: factor_low(2) = [8019_i8, 36183_i8]    !! their lower halves
   integer, parameter :: rounds = 10

contains

   !> Three independent numbers of mean 0 and variance 1 for every lane.
   pure subroutine gaussian_block(seed, id, step, half, xi)
      integer(i8), intent(in) :: seed         !! of the run
      integer(i8), intent(in) :: id(lanes)    !! of the bodies
      integer(i8), intent(in) :: step         !! number of the step: its low 48 bits count
      integer, intent(in) :: half             !! 0 or 1: before or after the step
      real(dp), intent(out) :: xi(lanes, 3)   !! the numbers
      integer(i8) :: counter(lanes, 4), word(lanes, 4), tag
      real(dp), dimension(lanes) :: u, angle, r1, r2, s, c
      real(dp), parameter :: unit = 2.0_dp**(-32), two_pi = 6.2831853071795865_dp
      tag = ior(iand(shiftr(step, 32), low16), shiftl(int(stream_noise + half, i8), 16))
      counter(:, 1) = iand(id, low32)
      counter(:, 2) = shiftr(id, 32)
      counter(:, 3) = iand(step, low32)
      counter(:, 4) = tag
      call philox_block([iand(seed, low32), shiftr(seed, 32)], counter, word)
      u = (real(word(:, 1), dp) + 0.5_dp)*unit
      call log_block(u, r1)
      u = (real(word(:, 3), dp) + 0.5_dp)*unit
      call log_block(u, r2)
      r1 = sqrt(-2*r1)
      r2 = sqrt(-2*r2)
      angle = (real(word(:, 2), dp) + 0.5_dp)*(unit*two_pi)
      call sincos_block(angle, s, c)
      xi(:, 1) = r1*c
      xi(:, 2) = r1*s
      angle = (real(word(:, 4), dp) + 0.5_dp)*(unit*two_pi)
      call sincos_block(angle, s, c)
      xi(:, 3) = r2*c
   end subroutine gaussian_block

   !> Four random 32-bit words for every lane, each in the low half of a 64-bit integer.
   pure subroutine philox_block(key, counter, word)
      integer(i8), intent(in) :: key(2)            !! 32-bit words
      integer(i8), intent(in) :: counter(lanes, 4) !! 32-bit words
      integer(i8), intent(out) :: word(lanes, 4)
      integer(i8) :: k(2), high1, high2, low1, low2
      integer :: round, i
      k = key
      word = counter
      do round = 1, rounds
         !$omp simd private(high1, high2, low1, low2)
         do i = 1, lanes
            call multiply(word(i, 1), factor_high(1), factor_low(1), high1, low1)
            call multiply(word(i, 3), factor_high(2), factor_low(2), high2, low2)
            word(i, 1) = ieor(ieor(high2, word(i, 2)), k(1))
            word(i, 3) = ieor(ieor(high1, word(i, 4)), k(2))
            word(i, 2) = low2
            word(i, 4) = low1
         end do
         k = iand(k + weyl, low32)
      end do
   end subroutine philox_block

   !> High and low word of the product of two 32-bit words, one of them given by its halves.
   pure subroutine multiply(x, factor_up, factor_down, high, low)
      integer(i8), intent(in) :: x, factor_up, factor_down
      integer(i8), intent(out) :: high, low
      integer(i8) :: down, up
      down = x*factor_down
      up = x*factor_up + shiftr(down, 16)
      high = shiftr(up, 16)
      low = ior(shiftl(iand(up, low16), 16), iand(down, low16))
   end subroutine multiply

end module poinsot_effect_gaussian
