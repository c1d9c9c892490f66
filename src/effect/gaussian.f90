!> Gaussian random numbers for a block: a function of (seed, body, step, half) only, so that they do
!> not depend on threads, on the position of a body or on the number of steps per call, and need no
!> state for a restart.
!>
!> Philox4x32-10 (Salmon, Moraes, Dror, Shaw 2011), then Box and Muller (1958) with 32-bit uniforms:
!> the largest possible value is 6.66.
module poinsot_effect_gaussian
   use poinsot_core_constants, only: pi
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_elliptic_elementary, only: log_block, sincos_block
   use poinsot_rotation_random, only: philox_block, stream_noise
   implicit none(type, external)
   private
   public :: gaussian_block

   integer(i8), parameter :: low32 = 4294967295_i8
   integer(i8), parameter :: low16 = 65535_i8

contains

   !> Three independent numbers of mean 0 and variance 1 for every lane.
   pure subroutine gaussian_block(seed, id, step, half, xi)
      integer(i8), intent(in) :: seed         !! of the run
      integer(i8), intent(in) :: id(lanes)    !! of the bodies
      integer(i8), intent(in) :: step         !! number of the step: its low 48 bits count
      integer, intent(in) :: half             !! which draw of the step, from 0
      real(dp), intent(out) :: xi(lanes, 3)   !! the numbers
      integer(i8) :: counter(lanes, 4), word(lanes, 4), tag
      real(dp), dimension(lanes) :: u, angle, r1, r2, s, c
      real(dp), parameter :: unit = 2.0_dp**(-32)
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
      angle = (real(word(:, 2), dp) + 0.5_dp)*(unit*(2*pi))
      call sincos_block(angle, s, c)
      xi(:, 1) = r1*c
      xi(:, 2) = r1*s
      angle = (real(word(:, 4), dp) + 0.5_dp)*(unit*(2*pi))
      call sincos_block(angle, s, c)
      xi(:, 3) = r2*c
   end subroutine gaussian_block

end module poinsot_effect_gaussian
