!> Behind the C entry point of Jacobi's elliptic functions. See include/poinsot.h and cpu_check.c.
module poinsot_api_jacobi
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, &
      c_ptr, c_size_t
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_null, poinsot_e_size
   use poinsot_elliptic_jacobi, only: jacobi_array
   implicit none(type, external)
   private

   integer(c_size_t), parameter :: most = 2_c_size_t**57 !! bytes of an array stay countable

contains

   !> sn, cn, dn of n arguments. POINSOT_E_DOMAIN if one of them is out of its domain; it gets NaN.
   integer(c_int) function jacobi(n, u, m, m1, sn, cn, dn) bind(c, name="poinsot_do_jacobi") &
      result(status)
      integer(c_size_t), value :: n
      type(c_ptr), value :: u, m         !! const double[n]: arguments, parameters
      type(c_ptr), value :: m1           !! const double[n]: 1 - m, or NULL
      type(c_ptr), value :: sn, cn, dn   !! double[n]
      real(c_double), dimension(:), pointer :: uu, mm, mm1, s, c, d
      real(dp) :: complement(lanes)
      integer(c_size_t) :: first, last
      integer :: k

      status = poinsot_ok
      if (n == 0) return
      status = poinsot_e_null
      if (.not. (c_associated(u) .and. c_associated(m) .and. c_associated(sn) .and. &
          c_associated(cn) .and. c_associated(dn))) return
      status = poinsot_e_size
      if (n < 0 .or. n > most) return
      call c_f_pointer(u, uu, [n])
      call c_f_pointer(m, mm, [n])
      call c_f_pointer(sn, s, [n])
      call c_f_pointer(cn, c, [n])
      call c_f_pointer(dn, d, [n])
      if (c_associated(m1)) call c_f_pointer(m1, mm1, [n])
      status = poinsot_ok
      do first = 1, n, lanes
         last = min(n, first + lanes - 1)
         k = int(last - first + 1)
         if (c_associated(m1)) then
            complement(1:k) = mm1(first:last)
         else
            complement(1:k) = complement_of(mm(first:last))
         end if
         call jacobi_array(uu(first:last), mm(first:last), complement(1:k), s(first:last), &
            c(first:last), d(first:last))
         if (any(ieee_is_nan(d(first:last)))) status = poinsot_e_domain
      end do
   end function jacobi

   !> 1 - m where m is finite: a NaN is left for jacobi_array to answer, without an exception.
   elemental real(dp) function complement_of(m)
      real(dp), intent(in) :: m
      integer(i8), parameter :: exponent_bits = int(z'7FF0000000000000', i8)
      complement_of = m
      if (iand(transfer(m, 1_i8), exponent_bits) /= exponent_bits) complement_of = 1 - m
   end function complement_of

end module poinsot_api_jacobi
