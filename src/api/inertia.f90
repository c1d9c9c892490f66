!> Implementation of the C functions for inertia: point masses, principal axes, and tests of moments
!> and tensors. See include/poinsot.h and cpu_check.c.
module poinsot_api_inertia
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_ptr, c_size_t
   use poinsot_api_arrays, only: check_arrays
   use poinsot_api_text, only: to_c
   use poinsot_body_class, only: body_class, make_class
   use poinsot_body_inertia, only: point_mass_tensor, principal_axes
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_ok, poinsot_e_null, poinsot_e_size
   implicit none(type, external)
   private

contains

   !> Centre of mass, and tensor about it.
   integer(c_int) function of_points(n, mass, x, centre, tensor) &
      bind(c, name="poinsot_do_inertia_of_points") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional :: mass(*), x(3, *)
      real(c_double), intent(inout), optional :: centre(3), tensor(3, 3)
      type(poinsot_error) :: error
      real(dp) :: middle(3), about_it(3, 3)
      status = poinsot_e_null
      if (.not. (present(mass) .and. present(x) .and. present(centre) .and. present(tensor))) return
      status = check_arrays(n, .true.)
      if (n == 0) status = poinsot_e_size
      if (status /= poinsot_ok) return
      call point_mass_tensor(mass(:n), x(:, :n), about_it, error, centre=middle)
      status = error%code
      if (raised(error)) return
      centre = middle
      tensor = about_it ! symmetric: row-major and column-major alike
   end function of_points

   !> Principal moments, ascending, and axes, the columns of a row-major matrix.
   integer(c_int) function axes_of(tensor, moments, axes) &
      bind(c, name="poinsot_do_principal_axes") result(status)
      real(c_double), intent(in), optional, target :: tensor(3, 3)
      real(c_double), intent(inout), optional, target :: moments(3), axes(3, 3)
      type(poinsot_error) :: error
      real(dp) :: values(3), columns(3, 3)
      status = poinsot_e_null
      if (.not. (present(tensor) .and. present(moments) .and. present(axes))) return
      call principal_axes(transpose(tensor), values, columns, error)
      status = error%code
      if (raised(error)) return
      moments = values
      axes = transpose(columns)
   end function axes_of

   !> The status that poinsot_body_create would give, and why.
   integer(c_int) function moments_check(moments, buffer, capacity) &
      bind(c, name="poinsot_do_moments_check") result(status)
      real(c_double), intent(in), optional :: moments(3)
      type(c_ptr), value :: buffer           !! char *, may be NULL
      integer(c_size_t), value :: capacity   !! bytes in it
      type(body_class) :: class
      type(poinsot_error) :: error
      if (present(moments)) then
         call make_class(moments, class, error)
      else
         call raise(error, poinsot_e_null, "moments of inertia: the pointer is NULL")
      end if
      call answer(error, buffer, capacity, status)
   end function moments_check

   !> The status that poinsot_body_create_tensor would give, and why.
   integer(c_int) function inertia_check(inertia, buffer, capacity) &
      bind(c, name="poinsot_do_inertia_check") result(status)
      real(c_double), intent(in), optional :: inertia(3, 3)
      type(c_ptr), value :: buffer           !! char *, may be NULL
      integer(c_size_t), value :: capacity   !! bytes in it
      real(dp) :: moments(3), axes(3, 3)
      type(body_class) :: class
      type(poinsot_error) :: error
      if (present(inertia)) then
         call principal_axes(transpose(inertia), moments, axes, error)
         if (.not. raised(error)) call make_class(moments, class, error)
      else
         call raise(error, poinsot_e_null, "inertia tensor: the pointer is NULL")
      end if
      call answer(error, buffer, capacity, status)
   end function inertia_check

   subroutine answer(error, buffer, capacity, status)
      type(poinsot_error), intent(in) :: error
      type(c_ptr), intent(in) :: buffer
      integer(c_size_t), intent(in) :: capacity
      integer(c_int), intent(out) :: status
      status = error%code
      if (raised(error)) call to_c(error%message, buffer, capacity)
   end subroutine answer

end module poinsot_api_inertia
