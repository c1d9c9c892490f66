!> Implementation of the C functions for elliptic functions and integrals, on arrays. See
!> include/poinsot.h and cpu_check.c.
!>
!> Each element is read before its result is written, so that input and output may be the same
!> array.
module poinsot_api_elliptic
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_size_t
   use poinsot_api_arrays, only: check_arrays, give
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain
   use poinsot_elliptic_carlson, only: carlson_rc, carlson_rd, carlson_rf, carlson_rj
   use poinsot_elliptic_complete, only: complete_e, complete_k, complete_pi
   use poinsot_elliptic_jacobi, only: jacobi_am_array, jacobi_array
   use poinsot_elliptic_legendre, only: legendre_e, legendre_f, legendre_pi
   implicit none(type, external)
   private

contains

   !> sn, cn, dn (u, m)
   integer(c_int) function jacobi(n, u, m, m1, sn, cn, dn) bind(c, name="poinsot_do_jacobi") &
      result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: u(*), m(*), m1(*)
      real(c_double), intent(inout), optional, target :: sn(*), cn(*), dn(*)
      real(dp), dimension(lanes) :: ub, mb, m1b, s, c, d
      integer(c_size_t) :: first
      integer :: k
      status = check_arrays(n, present(u) .and. present(m) .and. present(sn) .and. &
         present(cn) .and. present(dn))
      if (status /= poinsot_ok) return
      do first = 1, n, lanes
         k = int(min(n - first + 1, int(lanes, c_size_t)))
         call fill(first, k, u, m, m1, ub, mb, m1b)
         call jacobi_array(ub(:k), mb(:k), m1b(:k), s(:k), c(:k), d(:k))
         sn(first:first + k - 1) = s(:k)
         cn(first:first + k - 1) = c(:k)
         dn(first:first + k - 1) = d(:k)
         if (.not. all(ieee_is_finite(d(:k)))) status = poinsot_e_domain
      end do
   end function jacobi

   !> am(u, m)
   integer(c_int) function am_of(n, u, m, m1, am) bind(c, name="poinsot_do_jacobi_am") &
      result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: u(*), m(*), m1(*)
      real(c_double), intent(inout), optional, target :: am(*)
      real(dp), dimension(lanes) :: ub, mb, m1b, a
      integer(c_size_t) :: first
      integer :: k
      status = check_arrays(n, present(u) .and. present(m) .and. present(am))
      if (status /= poinsot_ok) return
      do first = 1, n, lanes
         k = int(min(n - first + 1, int(lanes, c_size_t)))
         call fill(first, k, u, m, m1, ub, mb, m1b)
         call jacobi_am_array(ub(:k), mb(:k), m1b(:k), a(:k))
         am(first:first + k - 1) = a(:k)
         if (.not. all(ieee_is_finite(a(:k)))) status = poinsot_e_domain
      end do
   end function am_of

   !> k arguments from number `first` on.
   pure subroutine fill(first, k, u, m, m1, ub, mb, m1b)
      integer(c_size_t), intent(in) :: first
      integer, intent(in) :: k
      real(c_double), intent(in) :: u(*), m(*)
      real(c_double), intent(in), optional :: m1(*)
      real(dp), intent(out), dimension(lanes) :: ub, mb, m1b
      integer :: j
      do j = 1, k
         ub(j) = u(first + j - 1)
         mb(j) = m(first + j - 1)
         m1b(j) = complement(first + j - 1, mb(j), m1)
      end do
   end subroutine fill

   !> 1 - m, as given or computed; non-finite values are handled elsewhere.
   pure real(dp) function complement(i, m, m1)
      integer(c_size_t), intent(in) :: i
      real(c_double), intent(in) :: m
      real(c_double), intent(in), optional :: m1(*)
      complement = m
      if (present(m1)) then
         complement = m1(i)
      else if (ieee_is_finite(m)) then
         complement = 1 - m
      end if
   end function complement

   !> K(m)
   integer(c_int) function k_of(n, m, m1, k) bind(c, name="poinsot_do_elliptic_k") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: m(*), m1(*)
      real(c_double), intent(inout), optional, target :: k(*)
      integer(c_size_t) :: i
      status = check_arrays(n, present(m) .and. present(k))
      if (status /= poinsot_ok) return
      do i = 1, n
         call give(complete_k(m(i), complement(i, m(i), m1)), .true., k(i), status)
      end do
   end function k_of

   !> E(m)
   integer(c_int) function e_of(n, m, m1, e) bind(c, name="poinsot_do_elliptic_e") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: m(*), m1(*)
      real(c_double), intent(inout), optional, target :: e(*)
      integer(c_size_t) :: i
      status = check_arrays(n, present(m) .and. present(e))
      if (status /= poinsot_ok) return
      do i = 1, n
         call give(complete_e(m(i), complement(i, m(i), m1)), .true., e(i), status)
      end do
   end function e_of

   !> Pi(nu, m)
   integer(c_int) function pi_of(n, nu, m, m1, p) &
      bind(c, name="poinsot_do_elliptic_pi") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: nu(*), m(*), m1(*)
      real(c_double), intent(inout), optional, target :: p(*)
      integer(c_size_t) :: i
      status = check_arrays(n, present(nu) .and. present(m) .and. present(p))
      if (status /= poinsot_ok) return
      do i = 1, n
         call give(complete_pi(nu(i), m(i), complement(i, m(i), m1)), .true., p(i), status)
      end do
   end function pi_of

   !> F(phi, m)
   integer(c_int) function f_of(n, phi, m, m1, f) &
      bind(c, name="poinsot_do_elliptic_f") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: phi(*), m(*), m1(*)
      real(c_double), intent(inout), optional, target :: f(*)
      integer(c_size_t) :: i
      status = check_arrays(n, present(phi) .and. present(m) .and. present(f))
      if (status /= poinsot_ok) return
      do i = 1, n
         call give(legendre_f(phi(i), m(i), complement(i, m(i), m1)), .true., f(i), status)
      end do
   end function f_of

   !> E(phi, m)
   integer(c_int) function e_incomplete(n, phi, m, m1, e) &
      bind(c, name="poinsot_do_elliptic_e_incomplete") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: phi(*), m(*), m1(*)
      real(c_double), intent(inout), optional, target :: e(*)
      integer(c_size_t) :: i
      status = check_arrays(n, present(phi) .and. present(m) .and. present(e))
      if (status /= poinsot_ok) return
      do i = 1, n
         call give(legendre_e(phi(i), m(i), complement(i, m(i), m1)), .true., e(i), status)
      end do
   end function e_incomplete

   !> Pi(nu; phi, m)
   integer(c_int) function pi_incomplete(n, nu, phi, m, m1, p) &
      bind(c, name="poinsot_do_elliptic_pi_incomplete") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: nu(*), phi(*), m(*), m1(*)
      real(c_double), intent(inout), optional, target :: p(*)
      integer(c_size_t) :: i
      status = check_arrays(n, present(nu) .and. present(phi) .and. present(m) .and. present(p))
      if (status /= poinsot_ok) return
      do i = 1, n
         call give(legendre_pi(nu(i), phi(i), m(i), complement(i, m(i), m1)), .true., p(i), status)
      end do
   end function pi_incomplete

   !> R_F(x, y, z)
   integer(c_int) function rf_of(n, x, y, z, r) bind(c, name="poinsot_do_carlson_rf") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: x(*), y(*), z(*)
      real(c_double), intent(inout), optional, target :: r(*)
      integer(c_size_t) :: i
      status = check_arrays(n, present(x) .and. present(y) .and. present(z) .and. present(r))
      if (status /= poinsot_ok) return
      do i = 1, n
         call give(carlson_rf(x(i), y(i), z(i)), .true., r(i), status)
      end do
   end function rf_of

   !> R_C(x, y)
   integer(c_int) function rc_of(n, x, y, r) bind(c, name="poinsot_do_carlson_rc") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: x(*), y(*)
      real(c_double), intent(inout), optional, target :: r(*)
      integer(c_size_t) :: i
      status = check_arrays(n, present(x) .and. present(y) .and. present(r))
      if (status /= poinsot_ok) return
      do i = 1, n
         call give(carlson_rc(x(i), y(i)), .true., r(i), status)
      end do
   end function rc_of

   !> R_D(x, y, z)
   integer(c_int) function rd_of(n, x, y, z, r) bind(c, name="poinsot_do_carlson_rd") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: x(*), y(*), z(*)
      real(c_double), intent(inout), optional, target :: r(*)
      integer(c_size_t) :: i
      status = check_arrays(n, present(x) .and. present(y) .and. present(z) .and. present(r))
      if (status /= poinsot_ok) return
      do i = 1, n
         call give(carlson_rd(x(i), y(i), z(i)), .true., r(i), status)
      end do
   end function rd_of

   !> R_J(x, y, z, p)
   integer(c_int) function rj_of(n, x, y, z, p, r) &
      bind(c, name="poinsot_do_carlson_rj") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: x(*), y(*), z(*), p(*)
      real(c_double), intent(inout), optional, target :: r(*)
      integer(c_size_t) :: i
      status = check_arrays(n, present(x) .and. present(y) .and. present(z) .and. &
         present(p) .and. present(r))
      if (status /= poinsot_ok) return
      do i = 1, n
         call give(carlson_rj(x(i), y(i), z(i), p(i)), .true., r(i), status)
      end do
   end function rj_of

end module poinsot_api_elliptic
