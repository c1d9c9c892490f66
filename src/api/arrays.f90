!> Shared code of C functions on arrays: tests for missing arrays, and the result of an element
!> outside the domain. Dummy arguments of these functions are optional, which is how a NULL arrives,
!> and targets, because an output may be the same array as an input.
module poinsot_api_arrays
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_size_t
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_null, poinsot_e_size
   implicit none(type, external)
   private
   public :: check_arrays, give, not_a_number

   integer(c_size_t), parameter :: most = 2_c_size_t**56 !! elements: bytes of a row stay countable
   real(dp), parameter :: not_a_number = transfer(int(z'7FF8000000000000', i8), 1.0_dp)

   !> A result, or NaN and POINSOT_E_DOMAIN if it is not finite or not `good`.
   interface give
      module procedure give_number, give_row
   end interface give

contains

   !> May a function on arrays of n elements begin? Of no elements no array need be there.
   pure integer(c_int) function check_arrays(n, there) result(status)
      integer(c_size_t), intent(in) :: n
      logical, intent(in) :: there !! are all arrays that must be
      status = poinsot_ok
      if (n /= 0 .and. .not. there) status = poinsot_e_null
      if (status == poinsot_ok .and. (n < 0 .or. n > most)) status = poinsot_e_size
   end function check_arrays

   pure subroutine give_number(x, good, r, status)
      real(dp), intent(in) :: x
      logical, intent(in) :: good
      real(c_double), intent(out) :: r
      integer(c_int), intent(inout) :: status
      r = x
      if (good .and. ieee_is_finite(x)) return
      r = not_a_number
      status = poinsot_e_domain
   end subroutine give_number

   pure subroutine give_row(x, good, r, status)
      real(dp), intent(in) :: x(:)
      logical, intent(in) :: good
      real(c_double), intent(out) :: r(:)
      integer(c_int), intent(inout) :: status
      r = x
      if (good) return
      r = not_a_number
      status = poinsot_e_domain
   end subroutine give_row

end module poinsot_api_arrays
