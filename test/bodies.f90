!> Deterministic random bodies, the hard ones too: moments over 8 decades, momenta over 12, next to
!> the separatrix, nearly symmetric, nearly linear, flat, linear, in odd units.
module test_bodies
   use poinsot_core_kinds, only: dp, i8
   implicit none(type, external)
   private
   public :: random_stream, start_stream, uniform, log_uniform, random_quaternion
   public :: random_body, hard_body, body_kinds, rate_bound, generic_moments, permute_body

   !> Two multiplicative congruential generators (moduli 2**31 - 1 and 2**31 - 249); products fit 64
   !> bits.
   type :: random_stream
      private
      integer(i8) :: a = 12345, b = 67890
   end type random_stream

   !> A body, its state and a step.
   type :: random_body
      character(12) :: kind = ""
      real(dp) :: moments(3) = 1, y(3) = 0, q(4) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], h = 0
   end type random_body

   character(12), parameter :: body_kinds(12) = [character(12) :: "generic", "wide", &
      "separatrix", "nearsym", "flat", &
      "nearlinear", "linear", "sphere", "middle", "axis", "units", "slow"]

contains

   !> Start a stream from a small positive seed.
   pure type(random_stream) function start_stream(seed) result(stream)
      integer, intent(in) :: seed
      stream%a = 1 + mod(48271_i8*(seed + 1000_i8), 2147483646_i8)
      stream%b = 1 + mod(69621_i8*(seed + 5000_i8), 2147483398_i8)
   end function start_stream

   !> Uniform in (0, 1), 53 bits.
   impure real(dp) function uniform(stream)
      type(random_stream), intent(inout) :: stream
      integer(i8), parameter :: bits27 = 134217728_i8, bits26 = 67108864_i8
      stream%a = mod(48271_i8*stream%a, 2147483647_i8)
      stream%b = mod(40692_i8*stream%b, 2147483399_i8)
      uniform = (real(mod(stream%b, bits26), dp) + 0.5_dp)/real(bits26, dp)
      uniform = (real(mod(stream%a, bits27), dp) + uniform)/real(bits27, dp)
   end function uniform

   !> 10**u with u uniform in (low, high).
   impure real(dp) function log_uniform(stream, low, high)
      type(random_stream), intent(inout) :: stream
      real(dp), intent(in) :: low, high
      log_uniform = 10.0_dp**(low + (high - low)*uniform(stream))
   end function log_uniform

   !> A sign, each with probability 1/2.
   impure real(dp) function random_sign(stream)
      type(random_stream), intent(inout) :: stream
      random_sign = merge(1.0_dp, -1.0_dp, uniform(stream) < 0.5_dp)
   end function random_sign

   !> Uniform on the unit sphere of quaternions, by rejection.
   function random_quaternion(stream) result(q)
      type(random_stream), intent(inout) :: stream
      real(dp) :: q(4), s
      integer :: j
      do
         do j = 1, 4
            q(j) = 2*uniform(stream) - 1
         end do
         s = sum(q*q)
         if (s < 1 .and. s > 0.01_dp) exit
      end do
      q = q/sqrt(s)
   end function random_quaternion

   !> Three distinct moments of a physical body, unsorted, no two within 5 %, none of the special
   !> ratios.
   function generic_moments(stream) result(moments)
      type(random_stream), intent(inout) :: stream
      real(dp) :: moments(3), d(3)
      integer :: j
      do
         do j = 1, 3
            d(j) = 0.1_dp + 0.9_dp*uniform(stream)
         end do
         moments = [d(2) + d(3), d(3) + d(1), d(1) + d(2)]
         if (minval(abs(moments - cshift(moments, 1))/maxval(moments)) > 0.05_dp) exit
      end do
   end function generic_moments

   !> A body of the kind `kind` (one of `body_kinds`), with h times the largest rate between 1e-3
   !> and `reach`.
   subroutine hard_body(stream, kind, reach, body)
      type(random_stream), intent(inout) :: stream
      character(*), intent(in) :: kind
      real(dp), intent(in) :: reach        !! largest h |omega|
      type(random_body), intent(out) :: body
      integer :: shift
      real(dp) :: bound
      body%kind = kind
      call sorted_body(stream, kind, body)
      body%q = random_quaternion(stream)
      shift = int(3*uniform(stream))
      body%moments = cshift(body%moments, shift)
      body%y = cshift(body%y, shift)
      if (uniform(stream) < 0.5_dp) call permute_body([2, 1, 3], body)
      bound = rate_bound(body%moments, body%y)
      body%h = random_sign(stream)
      if (bound <= 0) return
      body%h = body%h*log_uniform(stream, min(-3.0_dp, log10(reach)), log10(reach))/bound
   end subroutine hard_body

   !> Moments in rising order, and a momentum.
   subroutine sorted_body(stream, kind, body)
      type(random_stream), intent(inout) :: stream
      character(*), intent(in) :: kind
      type(random_body), intent(inout) :: body
      real(dp) :: d(3), y(3), small
      integer :: j
      do j = 1, 3
         d(j) = 0.1_dp + uniform(stream)
         y(j) = random_sign(stream)*(0.1_dp + uniform(stream))
      end do
      call sort3(d)
      select case (kind)
      case ("wide") ! point masses at distances over 8 decades; momentum components over 12
         do j = 1, 3
            d(j) = log_uniform(stream, -8.0_dp, 0.0_dp)
            y(j) = random_sign(stream)*log_uniform(stream, -12.0_dp, 0.0_dp)
         end do
         call sort3(d)
      case ("nearsym")
         if (uniform(stream) < 0.5_dp) then
            d(3) = d(2)*(1 + log_uniform(stream, -15.0_dp, -3.0_dp))
         else
            d(2) = d(1)*(1 + log_uniform(stream, -15.0_dp, -3.0_dp))
         end if
      case ("flat")
         d(1) = 0
      case ("nearlinear")
         small = log_uniform(stream, -14.0_dp, -3.0_dp)
         d(1) = d(1)*small
         d(2) = d(2)*small
         call sort3(d)
      case ("linear")
         d(1:2) = 0
         y(1) = 0
      case ("sphere")
         d = d(1)
      case ("middle")
         y(1) = y(1)*log_uniform(stream, -16.0_dp, -1.0_dp)
         y(3) = y(3)*log_uniform(stream, -16.0_dp, -1.0_dp)
      case ("axis")
         j = 1 + int(3*uniform(stream))
         y = merge(y, 0.0_dp, [1, 2, 3] == j)
      case default ! generic; separatrix, units and slow are made below
      end select
      body%moments = [d(1) + d(2), d(1) + d(3), d(2) + d(3)]
      body%y = y
      ! a thin body's own axis carries little momentum, or it would only spin about it
      if (kind == "nearlinear") body%y(1) = y(1)*body%moments(1)/body%moments(3)
      if (kind == "separatrix") call onto_separatrix(stream, body)
      if (kind == "units") call change_units(stream, body)
      if (kind == "slow") body%y = body%y*log_uniform(stream, -150.0_dp, -100.0_dp)
   end subroutine sorted_body

   !> c2 y1**2 = c1 y3**2, but for a part between 1e-16 and 1e-2.
   subroutine onto_separatrix(stream, body)
      type(random_stream), intent(inout) :: stream
      type(random_body), intent(inout) :: body
      real(dp) :: c(2), off
      associate (m => body%moments)
         c(1) = m(1)*(m(3) - m(2))
         c(2) = m(3)*(m(2) - m(1))
      end associate
      if (minval(c) <= 0) return
      body%y(3) = sign(sqrt(c(2)/c(1))*body%y(1), body%y(3))
      if (uniform(stream) > 0.8_dp) return
      off = log_uniform(stream, -16.0_dp, -2.0_dp)
      body%y(3) = body%y(3)*(1 + random_sign(stream)*off)
   end subroutine onto_separatrix

   !> Moments and momenta in units from 1e-140 (SI molecules: 1e-46) to 1e+140.
   subroutine change_units(stream, body)
      type(random_stream), intent(inout) :: stream
      type(random_body), intent(inout) :: body
      real(dp) :: scale
      scale = log_uniform(stream, -140.0_dp, 140.0_dp)
      body%moments = body%moments*scale
      body%y = body%y*(scale*log_uniform(stream, -15.0_dp, 15.0_dp))
   end subroutine change_units

   !> Relabel the axes: new axis j is old axis p(j). An odd permutation turns the sign of y and of
   !> the vector part.
   pure subroutine permute_body(p, body)
      integer, intent(in) :: p(3)
      type(random_body), intent(inout) :: body
      real(dp) :: parity
      parity = real((p(2) - p(1))*(p(3) - p(2))*(p(3) - p(1))/2, dp)
      body%moments = body%moments(p)
      body%y = parity*body%y(p)
      body%q(2:4) = parity*body%q(1 + p)
   end subroutine permute_body

   !> A bound on |omega| over the whole motion, from |omega_j| <= |y|/I_j and omega_j**2 <= 2 H/I_j.
   pure real(dp) function rate_bound(moments, y)
      real(dp), intent(in) :: moments(3), y(3)
      real(dp) :: m(3), w(3), scale
      rate_bound = 0
      scale = maxval(abs(y))
      if (scale <= 0) return
      m = 0
      where (moments > 0) m = maxval(moments)/moments
      w = min(m*norm2(y/scale), sqrt(m*sum(m*(y/scale)**2)))
      rate_bound = norm2(w)*(scale/maxval(moments))
   end function rate_bound

   pure subroutine sort3(d)
      real(dp), intent(inout) :: d(3)
      d = [minval(d), sum(d) - minval(d) - maxval(d), maxval(d)]
      d(2) = min(max(d(1), d(2)), d(3))
   end subroutine sort3

end module test_bodies
