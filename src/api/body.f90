!> Implementation of the C functions for bodies with the same moments: create, destroy, rotate. See
!> include/poinsot.h and cpu_check.c.
module poinsot_api_body
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_loc, &
      c_null_ptr, c_ptr, c_ptrdiff_t, c_size_t
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_api_text, only: name_from_c
   use poinsot_body_class, only: body_class, make_class, needs_more
   use poinsot_body_inertia, only: principal_axes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_kinds, only: name_length
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_memory, &
      poinsot_e_method, poinsot_e_null, poinsot_e_partial, poinsot_e_size
   use poinsot_ensemble_bodies, only: body_view, most_bodies, view_rows
   use poinsot_ensemble_direct, only: one_chunk, without_inertia, rotate_direct, &
      rotate_by_moments
   use poinsot_ensemble_layout, only: body_momentum
   use poinsot_ensemble_plain, only: open_plain, plain_arrays
   use poinsot_ensemble_rotate, only: rotate_bodies
   use poinsot_free_method, only: free_method, find_method
   implicit none(type, external)
   private

contains

   !> A body class from principal moments.
   integer(c_int) function body_create(moments, body) bind(c, name="poinsot_do_body_create") &
      result(status)
      type(c_ptr), value :: moments  !! const double[3]
      type(c_ptr), value :: body     !! poinsot_body **
      real(c_double), pointer :: m(:)
      type(c_ptr), pointer :: handle
      status = poinsot_e_null
      if (.not. c_associated(body)) return
      call c_f_pointer(body, handle)
      handle = c_null_ptr
      if (.not. c_associated(moments)) return
      call c_f_pointer(moments, m, [3])
      call create(m, handle, status)
   end function body_create

   !> A body class from a full inertia tensor, row-major; `axes` gets the principal axes as columns,
   !> row-major.
   integer(c_int) function body_create_tensor(inertia, body, axes) &
      bind(c, name="poinsot_do_body_create_tensor") result(status)
      type(c_ptr), value :: inertia  !! const double[9]
      type(c_ptr), value :: body     !! poinsot_body **
      type(c_ptr), value :: axes     !! double[9], may be NULL
      real(c_double), pointer :: tensor(:, :), a(:, :)
      type(c_ptr), pointer :: handle
      type(poinsot_error) :: error
      real(c_double) :: moments(3), columns(3, 3)
      status = poinsot_e_null
      if (.not. c_associated(body)) return
      call c_f_pointer(body, handle)
      handle = c_null_ptr
      if (.not. c_associated(inertia)) return
      call c_f_pointer(inertia, tensor, [3, 3])
      call principal_axes(transpose(tensor), moments, columns, error)
      status = error%code
      if (raised(error)) return
      call create(moments, handle, status)
      if (status /= poinsot_ok .or. .not. c_associated(axes)) return
      call c_f_pointer(axes, a, [3, 3])
      a = transpose(columns)
   end function body_create_tensor

   subroutine create(moments, handle, status)
      real(c_double), intent(in) :: moments(3)
      type(c_ptr), intent(inout) :: handle
      integer(c_int), intent(out) :: status
      type(body_class), pointer :: class
      type(poinsot_error) :: error
      integer :: state
      status = poinsot_e_memory
      allocate (class, stat=state)
      if (state /= 0) return
      call make_class(moments, class, error)
      status = error%code
      if (raised(error)) then
         deallocate (class)
      else
         handle = c_loc(class)
      end if
   end subroutine create

   !> Give a body class back, and set the handle to NULL. NULL and a NULL handle are fine.
   subroutine body_destroy(body) bind(c, name="poinsot_do_body_destroy")
      type(c_ptr), value :: body     !! poinsot_body **
      type(c_ptr), pointer :: handle
      type(body_class), pointer :: class
      if (.not. c_associated(body)) return
      call c_f_pointer(body, handle)
      if (.not. c_associated(handle)) return
      call c_f_pointer(handle, class)
      deallocate (class)
      handle = c_null_ptr
   end subroutine body_destroy

   !> `steps` free steps of h for n bodies of one class, in place.
   integer(c_int) function rotate(body, method, h, steps, n, y, q, per_body) &
      bind(c, name="poinsot_do_rotate") result(status)
      type(c_ptr), value :: body      !! const poinsot_body *
      type(c_ptr), value :: method    !! const char *
      real(c_double), value :: h      !! step, either sign
      integer(c_size_t), value :: steps, n
      type(c_ptr), value :: y, q      !! double[n][3], double[n][4]
      type(c_ptr), value :: per_body  !! poinsot_status[n], may be NULL
      status = rotate_by(0_c_int, body, method, h, steps, n, y, q, per_body)
   end function rotate

   !> The same with a given number of threads: legacy.c uses one.
   integer(c_int) function rotate_by(threads, body, method, h, steps, n, y, q, per_body) &
      bind(c, name="poinsot_do_rotate_by") result(status)
      integer(c_int), value :: threads !! 0: as OpenMP says, where the work is long enough
      type(c_ptr), value :: body      !! const poinsot_body *
      type(c_ptr), value :: method    !! const char *
      real(c_double), value :: h      !! step, either sign
      integer(c_size_t), value :: steps, n
      type(c_ptr), value :: y, q      !! double[n][3], double[n][4]
      type(c_ptr), value :: per_body  !! poinsot_status[n], may be NULL
      type(body_class), pointer :: class
      type(free_method) :: chosen
      type(poinsot_error) :: error
      character(name_length) :: name
      logical :: fits

      status = poinsot_e_null
      if (.not. (c_associated(body) .and. c_associated(method))) return
      call name_from_c(method, name, fits)
      if (n > 0 .and. .not. (c_associated(y) .and. c_associated(q))) return
      status = poinsot_e_method
      if (.not. fits) return
      call find_method(name, chosen, error)
      status = error%code
      if (raised(error)) return
      status = poinsot_e_size
      if (n < 0 .or. n > most_bodies .or. steps < 0 .or. steps > huge(0)) return
      call c_f_pointer(body, class)
      call rotate_rows(class, chosen, h, int(steps), int(threads), int(n), y, q, per_body, status)
   end function rotate_by

   !> The same of arrays that are there: few bodies by the short way.
   subroutine rotate_rows(class, method, h, steps, threads, n, y, q, per_body, status)
      type(body_class), intent(in) :: class
      type(free_method), intent(in) :: method
      real(c_double), intent(in) :: h
      integer, intent(in) :: steps, threads, n
      type(c_ptr), intent(in) :: y, q          !! double[n][3], double[n][4]
      type(c_ptr), intent(in) :: per_body      !! int[n], or NULL
      integer(c_int), intent(out) :: status
      type(plain_arrays) :: a
      integer :: none_left
      logical :: failed
      if (n > 0 .and. n <= one_chunk .and. class%sorted(1) > 0 .and. ieee_is_finite(h) .and. &
          .not. needs_more(class, method%terms)) then
         call open_rows(n, y, q, per_body, a)
         call rotate_direct(class, method, body_momentum, h, steps, .false., a, failed, none_left)
         status = merge(poinsot_e_partial, poinsot_ok, failed)
      else
         call rotate_many(class, method, h, steps, threads, n, y, q, per_body, status)
      end if
   end subroutine rotate_rows

   subroutine open_rows(n, y, q, per_body, a)
      integer, intent(in) :: n
      type(c_ptr), intent(in) :: y, q, per_body
      type(plain_arrays), intent(out) :: a
      real(c_double), pointer :: yy(:), qq(:)
      call c_f_pointer(y, yy, [3])
      call c_f_pointer(q, qq, [4])
      call open_plain(n, 3, [c_loc(yy(1)), c_loc(yy(2)), c_loc(yy(3))], 3_c_ptrdiff_t, &
                      [c_loc(qq(1)), c_loc(qq(2)), c_loc(qq(3)), c_loc(qq(4))], 4_c_ptrdiff_t, &
                      per_body, c_null_ptr, a)
   end subroutine open_rows

   !> The same of any number, by a view.
   subroutine rotate_many(class, method, h, steps, threads, n, y, q, per_body, status)
      type(body_class), intent(in) :: class
      type(free_method), intent(in) :: method
      real(c_double), intent(in) :: h
      integer, intent(in) :: steps, threads, n
      type(c_ptr), intent(in) :: y, q, per_body
      integer(c_int), intent(out) :: status
      type(body_view) :: view
      type(poinsot_error) :: error
      real(c_double), pointer :: yy(:, :), qq(:, :)
      real(c_double), target :: no_y(3, 0), no_q(4, 0)
      yy => no_y
      qq => no_q
      if (n > 0) call c_f_pointer(y, yy, [3, n])
      if (n > 0) call c_f_pointer(q, qq, [4, n])
      call view_rows(yy, qq, view)
      if (n > 0 .and. c_associated(per_body)) call c_f_pointer(per_body, view%status, [n])
      call rotate_bodies(class, method, h, steps, view, threads, status, error)
   end subroutine rotate_many

   !> Bodies of one kind by their moments, for fixed form: constants for each lane, no class.
   integer(c_int) function rotate_moments(moments, by_jacobi, h, steps, n, y, q, per_body) &
      bind(c, name="poinsot_do_rotate_moments") result(status)
      type(c_ptr), value :: moments          !! const double[3]
      integer(c_int), value :: by_jacobi     !! method "jacobi", not "exact"
      real(c_double), value :: h
      integer(c_size_t), value :: steps, n
      type(c_ptr), value :: y, q             !! double[n][3], double[n][4]
      type(c_ptr), value :: per_body         !! poinsot_status[n], may be NULL
      real(c_double), pointer :: m(:)
      real(c_double), target :: still(4)
      type(plain_arrays) :: a
      logical :: failed
      status = poinsot_e_null
      if (.not. c_associated(moments)) return
      if (n > 0 .and. .not. (c_associated(y) .and. c_associated(q))) return
      status = poinsot_e_size
      if (n < 0 .or. n > most_bodies .or. steps < 0 .or. steps > huge(0)) return
      status = poinsot_e_domain
      if (.not. ieee_is_finite(h)) return
      call c_f_pointer(moments, m, [3])
      if (n > 0) then
         call open_rows(int(n), y, q, per_body, a)
      else ! the moments are judged all the same
         still = 0
         call open_rows(0, c_loc(still), c_loc(still), c_null_ptr, a)
      end if
      call rotate_by_moments(m, by_jacobi /= 0, h, int(steps), a, failed, status)
      if (status == poinsot_ok .and. failed) status = poinsot_e_partial
      if (status == without_inertia) call rotate_linear(m, by_jacobi /= 0, h, int(steps), int(n), &
         y, q, per_body, status)
   end function rotate_moments

   !> The same of bodies that need a class.
   subroutine rotate_linear(moments, by_jacobi, h, steps, n, y, q, per_body, status)
      real(c_double), intent(in) :: moments(3)
      logical, intent(in) :: by_jacobi
      real(c_double), intent(in) :: h
      integer, intent(in) :: steps, n
      type(c_ptr), intent(in) :: y, q, per_body
      integer(c_int), intent(out) :: status
      type(body_class) :: class
      type(free_method) :: chosen
      type(poinsot_error) :: error
      call make_class(moments, class, error)
      call find_method(trim(merge("jacobi", "exact ", by_jacobi)), chosen, error)
      call rotate_rows(class, chosen, h, steps, 1, n, y, q, per_body, status)
   end subroutine rotate_linear

end module poinsot_api_body
