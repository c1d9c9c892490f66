!> Carlson's R_J for one block of lanes, with its arctangents as complex numbers.
!>
!> For x <= y <= 1 <= p each R_C term of the duplication is 2**n atan(t_n)/g, with g = sqrt((p - x)
!> (p - y) (p - 1)); sums of them are products of complex numbers, so that code which needs an angle
!> of rotation, like the free body, needs no arctangent at all. (B. C. Carlson, Numer. Algorithms 10
!> (1995) 13-26; the last series DLMF 19.36.2.)
module poinsot_elliptic_third_kind
   use poinsot_core_kinds, only: dp, i8, group, groups, lanes
   implicit none(type, external)
   private
   public :: third_kind_block

   integer, parameter :: most = 24                 !! duplications; four or five are usual
   real(dp), parameter :: close_enough = 0.0115_dp !! relative spread at which the series takes over

contains

   !> R_J(x, y, 1, p) g/6 = g series/6 + angle of (re, im). Lanes stop each at its own time.
   pure subroutine third_kind_block(x0, y0, p0, g0, series, re, im, nvec)
      real(dp), intent(in) :: x0(lanes)      !! >= 0; not 0 together with y0
      real(dp), intent(in) :: y0(lanes)      !! x0 <= y0 <= 1
      real(dp), intent(in) :: p0(lanes)      !! >= 1
      real(dp), intent(in) :: g0(lanes)      !! sqrt((p - x) (p - y) (p - 1))
      real(dp), intent(out) :: series(lanes) !! the part that is no angle
      real(dp), intent(out) :: re(lanes)     !! the angle (but for whole turns) as a complex number
      real(dp), intent(out) :: im(lanes)     !! imaginary part
      integer, intent(in), optional :: nvec  !! groups of lanes to work on, instead of all
      real(dp), dimension(lanes) :: x, y, z, p, g, power
      real(dp) :: t(lanes, most), w
      integer :: n, k, l, used
      logical :: going
      used = groups
      if (present(nvec)) used = nvec
      !$omp simd
      do l = 1, group*used
         x(l) = x0(l)
         y(l) = y0(l)
         z(l) = 1.0_dp
         p(l) = p0(l)
         g(l) = g0(l)
         power(l) = 1.0_dp
         re(l) = 1.0_dp
         im(l) = 0.0_dp
      end do
      do n = 1, most
         call halve(used, x, y, z, p, g, power, t(:, n), going)
         if (.not. going) exit
      end do
      do k = min(n, most) - 1, 1, -1 ! angle = atan t1 + 2 (atan t2 + 2 (...))
         !$omp simd private(w)
         do l = 1, group*used
            w = (re(l) - im(l))*(re(l) + im(l))
            im(l) = 2.0_dp*re(l)*im(l)
            re(l) = w - im(l)*t(l, k)
            im(l) = im(l) + w*t(l, k)
         end do
      end do
      call last_terms(used, x, y, z, p, power, series)
   end subroutine third_kind_block

   !> One duplication of the lanes that have not converged; the others stay as they are, t = 0.
   pure subroutine halve(nvec, x, y, z, p, g, power, t, going)
      integer, intent(in) :: nvec
      real(dp), intent(inout), dimension(lanes) :: x, y, z, p, g, power
      real(dp), intent(out) :: t(lanes)
      logical, intent(out) :: going
      real(dp) :: rx, ry, rz, rp, lambda, a
      integer(i8) :: mask, all_masks
      integer :: l
      all_masks = 0_i8
      !$omp simd private(rx, ry, rz, rp, lambda, a, mask) reduction(ior: all_masks)
      do l = 1, group*nvec
         a = 0.2_dp*(x(l) + y(l) + z(l) + 2.0_dp*p(l))
         mask = shifta(transfer(close_enough*a - (p(l) - x(l)), mask), 63)
         all_masks = ior(all_masks, mask)
         rx = sqrt(x(l))
         ry = sqrt(y(l))
         rz = sqrt(z(l))
         rp = sqrt(p(l))
         lambda = rx*ry + rz*(rx + ry)
         t(l) = choose(mask, g(l)/((rp + rx)*(rp + ry)*(rp + rz)), 0.0_dp)
         x(l) = choose(mask, 0.25_dp*(x(l) + lambda), x(l))
         y(l) = choose(mask, 0.25_dp*(y(l) + lambda), y(l))
         z(l) = choose(mask, 0.25_dp*(z(l) + lambda), z(l))
         p(l) = choose(mask, 0.25_dp*(p(l) + lambda), p(l))
         g(l) = choose(mask, 0.125_dp*g(l), g(l))
         power(l) = choose(mask, 0.25_dp*power(l), power(l))
      end do
      going = all_masks /= 0_i8
   end subroutine halve

   !> The series that ends the duplication (DLMF 19.36.2), to seventh order.
   pure subroutine last_terms(nvec, x, y, z, p, power, series)
      integer, intent(in) :: nvec
      real(dp), intent(in), dimension(lanes) :: x, y, z, p, power
      real(dp), intent(out) :: series(lanes)
      real(dp) :: a, inv, dx, dy, dz, e, xyz, e2, e3, e4, e5, r
      integer :: l
      !$omp simd private(a, inv, dx, dy, dz, e, xyz, e2, e3, e4, e5, r)
      do l = 1, group*nvec
         a = 0.2_dp*(x(l) + y(l) + z(l) + 2.0_dp*p(l))
         inv = 1.0_dp/a
         dx = (a - x(l))*inv
         dy = (a - y(l))*inv
         dz = (a - z(l))*inv
         e = -0.5_dp*(dx + dy + dz)
         xyz = dx*dy*dz
         e2 = dx*dy + dz*(dx + dy) - 3.0_dp*(e*e)
         e3 = xyz + 2.0_dp*e*(e2 + 2.0_dp*(e*e))
         e4 = (2.0_dp*xyz + e*(e2 + 3.0_dp*(e*e)))*e
         e5 = xyz*(e*e)
         r = -3.0_dp/14.0_dp + e2*(9.0_dp/88.0_dp - e2*(1.0_dp/16.0_dp) + e3*(45.0_dp/272.0_dp))
         r = e2*(r - e3*(9.0_dp/52.0_dp) + e4*(3.0_dp/20.0_dp) - e5*(9.0_dp/68.0_dp))
         r = r + e3*(1.0_dp/6.0_dp + e3*(3.0_dp/40.0_dp) - e4*(9.0_dp/68.0_dp))
         r = r - (e4*(3.0_dp/22.0_dp) - e5*(3.0_dp/26.0_dp))
         series(l) = power(l)*(1.0_dp + r)*inv/sqrt(a)
      end do
   end subroutine last_terms

   include "../core/choose.inc"

end module poinsot_elliptic_third_kind
