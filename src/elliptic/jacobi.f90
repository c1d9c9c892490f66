!> Jacobi's elliptic functions am, sn, cn, dn of any real argument, for every parameter in [0, 1].
!>
!> Elemental and array forms, of m and of m1 = 1 - m, so that even m1 = 1e-300 is meaningful. Both
!> forms run the same block kernel and give bitwise the same result, at every position of an array;
!> the array forms are the fast ones. Error of sn, cn, dn at most 1e-15 max(1, |u|/50), that of am
!> 1e-15 (1 + |am|). An element whose u, m or m1 is outside the domain, infinite or NaN gives NaN,
!> without an exception; so does every element while the rounding mode of the thread is not to
!> nearest.
module poinsot_elliptic_jacobi
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use poinsot_core_constants, only: pi
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_rounding, only: rounds_to_nearest
   use poinsot_elliptic_elementary, only: atan2_block
   use poinsot_elliptic_jacobi_kernel, only: jacobi_block
   implicit none(type, external)
   private
   public :: jacobi_functions, jacobi_am
   public :: jacobi_array, jacobi_am_array


contains

   !> sn, cn and dn of one argument.
   elemental subroutine jacobi_functions(u, m, sn, cn, dn, m1)
      real(dp), intent(in) :: u            !! argument, |u| <= 1e15
      real(dp), intent(in) :: m            !! parameter, in [0, 1]
      real(dp), intent(out) :: sn          !! sn(u | m)
      real(dp), intent(out) :: cn          !! cn(u | m)
      real(dp), intent(out) :: dn          !! dn(u | m)
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it
      real(dp) :: am
      call one(u, m, sn, cn, dn, am, m1)
   end subroutine jacobi_functions

   !> Amplitude of one argument: sn = sin(am), cn = cos(am), continuous in u.
   elemental real(dp) function jacobi_am(u, m, m1) result(am)
      real(dp), intent(in) :: u            !! argument, |u| <= 1e15
      real(dp), intent(in) :: m            !! parameter, in [0, 1]
      real(dp), intent(in), optional :: m1 !! 1 - m, if known better than m gives it
      real(dp) :: sn, cn, dn
      call one(u, m, sn, cn, dn, am, m1)
   end function jacobi_am

   !> sn, cn, dn of arrays, to the length of the shortest.
   pure subroutine jacobi_array(u, m, m1, sn, cn, dn)
      real(dp), intent(in), contiguous :: u(:)   !! arguments, |u| <= 1e15
      real(dp), intent(in), contiguous :: m(:)   !! parameters, in [0, 1]
      real(dp), intent(in), contiguous :: m1(:)  !! 1 - m: the smaller of both is used
      real(dp), intent(out), contiguous :: sn(:) !! sn(u | m)
      real(dp), intent(out), contiguous :: cn(:) !! cn(u | m)
      real(dp), intent(out), contiguous :: dn(:) !! dn(u | m)
      real(dp), dimension(lanes) :: s, c, d, turns
      integer(i8) :: outside(lanes)
      integer :: first, n, total
      total = min(size(u), size(m), size(m1), size(sn), size(cn), size(dn))
      do first = 1, total, lanes
         n = min(lanes, total - first + 1)
         call take(n, u(first:), m(first:), m1(first:), s, c, d, turns, outside)
         call unfold(turns, s, c)
         call blank(outside, s, c, d)
         sn(first:first + n - 1) = s(1:n)
         cn(first:first + n - 1) = c(1:n)
         dn(first:first + n - 1) = d(1:n)
      end do
   end subroutine jacobi_array

   !> Amplitudes of arrays, to the length of the shortest.
   pure subroutine jacobi_am_array(u, m, m1, am)
      real(dp), intent(in), contiguous :: u(:)   !! arguments, |u| <= 1e15
      real(dp), intent(in), contiguous :: m(:)   !! parameters, in [0, 1]
      real(dp), intent(in), contiguous :: m1(:)  !! 1 - m: the smaller of both is used
      real(dp), intent(out), contiguous :: am(:) !! am(u | m), radians
      real(dp), dimension(lanes) :: s, c, d, turns, a
      integer(i8) :: outside(lanes)
      integer :: first, n, total
      total = min(size(u), size(m), size(m1), size(am))
      do first = 1, total, lanes
         n = min(lanes, total - first + 1)
         call take(n, u(first:), m(first:), m1(first:), s, c, d, turns, outside)
         call atan2_block(s, c, a)
         a = a + turns*pi
         call blank(outside, a)
         am(first:first + n - 1) = a(1:n)
      end do
   end subroutine jacobi_am_array

   !> All of it for one argument, in a block of equal lanes.
   pure subroutine one(u, m, sn, cn, dn, am, m1)
      real(dp), intent(in) :: u, m
      real(dp), intent(out) :: sn, cn, dn, am
      real(dp), intent(in), optional :: m1
      real(dp), dimension(1) :: us, ms, m1s
      real(dp), dimension(lanes) :: s, c, d, turns, a
      integer(i8) :: outside(lanes)
      us = u
      ms = m
      m1s = m
      if (ieee_is_finite(m)) m1s = 1.0_dp - m
      if (present(m1)) m1s = m1
      call take(1, us, ms, m1s, s, c, d, turns, outside)
      call atan2_block(s, c, a)
      a = a + turns*pi
      call unfold(turns, s, c)
      call blank(outside, s, c, d)
      call blank(outside, a)
      am = a(1)
      sn = s(1)
      cn = c(1)
      dn = d(1)
   end subroutine one

   !> Fill a block from n elements, and evaluate it; elements out of the domain as u = 0, m = 0.
   pure subroutine take(n, u, m, m1, s, c, d, turns, outside)
      integer, intent(in) :: n
      real(dp), intent(in), contiguous :: u(:), m(:), m1(:)
      real(dp), intent(out), dimension(lanes) :: s, c, d, turns
      integer(i8), intent(out) :: outside(lanes) !! not 0: out of the domain
      real(dp), dimension(lanes) :: ub, mb, m1b
      integer(i8) :: all_outside
      ub(1:n) = u(1:n)
      mb(1:n) = m(1:n)
      m1b(1:n) = m1(1:n)
      ub(n + 1:) = 0.0_dp
      mb(n + 1:) = 0.0_dp
      m1b(n + 1:) = 1.0_dp
      call find_outside(ub, mb, m1b, outside, all_outside)
      if (.not. rounds_to_nearest()) then
         outside = 1_i8
         all_outside = 1_i8
      end if
      if (all_outside /= 0_i8) then
         where (outside /= 0_i8)
            ub = 0.0_dp
            mb = 0.0_dp
            m1b = 1.0_dp
         end where
      end if
      call jacobi_block(ub, mb, m1b, s, c, d, turns)
   end subroutine take

   !> NaN for the elements out of the domain.
   pure subroutine blank(outside, a, b, c)
      integer(i8), intent(in) :: outside(lanes)
      real(dp), intent(inout) :: a(lanes)
      real(dp), intent(inout), optional :: b(lanes), c(lanes)
      real(dp) :: nan
      if (all(outside == 0_i8)) return
      nan = ieee_value(nan, ieee_quiet_nan)
      where (outside /= 0_i8) a = nan
      if (present(b)) then
         where (outside /= 0_i8) b = nan
      end if
      if (present(c)) then
         where (outside /= 0_i8) c = nan
      end if
   end subroutine blank

   !> Lanes out of the domain, by the bits of their numbers: a NaN must not meet a comparison.
   pure subroutine find_outside(u, m, m1, outside, all_outside)
      real(dp), intent(in), dimension(lanes) :: u, m, m1
      integer(i8), intent(out) :: outside(lanes) !! not 0: out of the domain
      integer(i8), intent(out) :: all_outside    !! all of them, or'ed
      integer(i8) :: a, b, c
      integer(i8), parameter :: one_bits = 4607182418800017408_i8
      integer(i8), parameter :: largest_bits = 4831355200913801216_i8
      integer :: i
      all_outside = 0_i8
      !$omp simd private(a, b, c) reduction(ior: all_outside)
      do i = 1, lanes
         a = largest_bits - ibclr(transfer(u(i), a), 63) ! negative: beyond
         b = one_bits - ibclr(transfer(m(i), b), 63)
         b = ior(b, transfer(m(i) + 0.0_dp, b))          ! negative too; -0 + 0 is 0
         c = one_bits - ibclr(transfer(m1(i), c), 63)
         c = ior(c, transfer(m1(i) + 0.0_dp, c))
         outside(i) = shiftr(ior(a, ior(b, c)), 63)
         all_outside = ior(all_outside, outside(i))
      end do
   end subroutine find_outside

   !> Give sn and cn the signs that the whole turns say.
   pure subroutine unfold(turns, s, c)
      real(dp), intent(in) :: turns(lanes)
      real(dp), intent(inout) :: s(lanes), c(lanes)
      real(dp), parameter :: rounder = 6755399441055744.0_dp
      real(dp) :: half, odd
      integer :: i
      !$omp simd private(half, odd)
      do i = 1, lanes
         half = 0.5_dp*turns(i)
         odd = 1.0_dp - 4.0_dp*abs(half - ((half + rounder) - rounder)) ! 1 if even, -1 if odd
         s(i) = odd*s(i)
         c(i) = odd*c(i)
      end do
   end subroutine unfold

end module poinsot_elliptic_jacobi
