!> Implementation of the C functions that fill a view of bodies. See include/poinsot.h and
!> cpu_check.c.
module poinsot_api_bodies
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_int8_t, &
      c_loc, c_ptr, c_size_t, c_sizeof
   use poinsot_api_text, only: from_c
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_core_status, only: poinsot_ok, poinsot_e_method, poinsot_e_null, poinsot_e_size
   use poinsot_ensemble_bodies, only: poinsot_bodies, body_view, most_bodies, first_size, open_view
   use poinsot_ensemble_layout, only: conjugate_momentum, layout_momentum, layout_names
   implicit none(type, external)
   private
   public :: open_bodies

   integer(c_size_t), parameter :: longest_struct = 4096 !! more is no poinsot_bodies

contains

   !> Open what a C caller handed over. A struct of an earlier version lacks members, which are
   !> zero;
   !> one longer than ours, from a newer header, is taken if its end is zero: then it asks for
   !> nothing
   !> that we do not know.
   subroutine open_bodies(bodies, view, error)
      type(c_ptr), intent(in) :: bodies            !! const poinsot_bodies *
      type(body_view), intent(out) :: view
      type(poinsot_error), intent(inout) :: error
      type(poinsot_bodies), pointer :: given

      if (.not. c_associated(bodies)) then
         call raise(error, poinsot_e_null, "poinsot_bodies: the view is NULL")
         return
      end if
      call c_f_pointer(bodies, given)
      if (given%size == c_sizeof(given)) then
         call open_view(given, view, error)
      else
         call open_other(bodies, given%size, view, error)
      end if
   end subroutine open_bodies

   !> A struct of another size.
   subroutine open_other(bodies, size, view, error)
      type(c_ptr), intent(in) :: bodies
      integer(c_size_t), intent(in) :: size
      type(body_view), intent(inout) :: view
      type(poinsot_error), intent(inout) :: error
      type(poinsot_bodies) :: known
      integer(c_int8_t), pointer :: bytes(:)
      integer(c_int8_t) :: image(c_sizeof(known))
      integer(c_size_t) :: common
      if (is_known(size) .or. size > c_sizeof(known) .and. size <= longest_struct) then
         call c_f_pointer(bodies, bytes, [size])
         common = min(size, c_sizeof(known))
         image = 0
         image(:common) = bytes(:common)
         known = transfer(image, known)
         if (all(bytes(common + 1:) == 0)) known%size = c_sizeof(known)
         call open_view(known, view, error)
      else
         call raise(error, poinsot_e_size, "poinsot_bodies: set size = sizeof(poinsot_bodies)")
      end if
   end subroutine open_other

   !> Is it the size of the struct in this or an earlier version?
   pure logical function is_known(size)
      integer(c_size_t), intent(in) :: size
      type(poinsot_bodies) :: now
      is_known = size == first_size .or. size == c_sizeof(now)
   end function is_known

   !> View of rows: momentum [n][3] or [n][4], attitude [n][4], quaternion in the order "wxyz" or
   !> "xyzw".
   integer(c_int) function bodies_rows(bodies, size, layout, order, n, momentum, attitude) &
         bind(c, name="poinsot_do_bodies_rows_sized") result(status)
      type(c_ptr), value :: bodies               !! poinsot_bodies *
      integer(c_size_t), value :: size           !! of it, in the caller's version
      type(c_ptr), value :: layout, order        !! const char *; a NULL order is "wxyz"
      integer(c_size_t), value :: n
      type(c_ptr), value :: momentum, attitude   !! double *
      type(poinsot_bodies) :: view
      character(:), allocatable :: how
      integer :: components, j, first

      call start(bodies, size, layout, n, view, components, status)
      if (status /= poinsot_ok) return
      status = poinsot_e_method
      how = "wxyz"
      if (c_associated(order)) call from_c(order, how)
      if (how /= "wxyz" .and. how /= "xyzw") return
      status = poinsot_e_null
      if (n > 0 .and. .not. (c_associated(momentum) .and. c_associated(attitude))) return
      status = poinsot_ok
      view%y_stride = components
      view%q_stride = 4
      first = merge(3, 0, how == "xyzw")
      if (n > 0) then
         do j = 1, 3
            view%y(j) = element(momentum, j - 1)
         end do
         if (components == 4) view%y_fourth = element(momentum, 3)
         do j = 1, 4
            view%q(j) = element(attitude, mod(first + j - 1, 4))
         end do
      end if
      call hand_out(view, size, bodies)
   end function bodies_rows

   !> View of component arrays: momentum[3] or [4] and attitude[4] (w, x, y, z) point to n numbers
   !> each.
   integer(c_int) function bodies_arrays(bodies, size, layout, n, momentum, attitude) &
         bind(c, name="poinsot_do_bodies_arrays_sized") result(status)
      type(c_ptr), value :: bodies               !! poinsot_bodies *
      integer(c_size_t), value :: size           !! of it, in the caller's version
      type(c_ptr), value :: layout               !! const char *
      integer(c_size_t), value :: n
      type(c_ptr), value :: momentum, attitude   !! double *const []
      type(poinsot_bodies) :: view
      type(c_ptr), pointer :: y(:), q(:)
      integer :: components, j

      call start(bodies, size, layout, n, view, components, status)
      if (status /= poinsot_ok) return
      view%y_stride = 1
      view%q_stride = 1
      status = poinsot_e_null
      if (.not. (c_associated(momentum) .and. c_associated(attitude))) return
      call c_f_pointer(momentum, y, [components])
      call c_f_pointer(attitude, q, [4])
      do j = 1, components
         if (n > 0 .and. .not. c_associated(y(j))) return
      end do
      do j = 1, 4
         if (n > 0 .and. .not. c_associated(q(j))) return
      end do
      status = poinsot_ok
      view%y = y(1:3)
      view%q = q
      if (components == 4) view%y_fourth = y(4)
      call hand_out(view, size, bodies)
   end function bodies_arrays

   !> What both have in common: an empty view of n bodies, which the caller has already, and the
   !> components of the layout's momentum.
   subroutine start(bodies, size, layout, n, view, components, status)
      type(c_ptr), intent(in) :: bodies, layout
      integer(c_size_t), intent(in) :: size, n
      type(poinsot_bodies), intent(out) :: view
      integer, intent(out) :: components
      integer(c_int), intent(out) :: status
      character(:), allocatable :: name
      integer :: k
      components = 0
      status = poinsot_e_null
      call from_c(layout, name)
      if (.not. c_associated(bodies) .or. .not. allocated(name)) return
      status = poinsot_e_size
      if (.not. is_known(size)) return
      call hand_out(view, size, bodies)
      do k = 1, ubound(layout_names, 1)
         if (layout_names(k) == name) components = merge(4, 3, &
            layout_momentum(k) == conjugate_momentum)
      end do
      status = poinsot_e_method
      if (components == 0) return
      status = poinsot_e_size
      if (n < 0 .or. n > most_bodies) return
      status = poinsot_ok
      view%n = n
   end subroutine start

   !> As much of a view as the caller's version has.
   subroutine hand_out(view, size, bodies)
      type(poinsot_bodies), intent(inout) :: view
      integer(c_size_t), intent(in) :: size
      type(c_ptr), intent(in) :: bodies
      integer(c_int8_t), pointer :: bytes(:)
      view%size = size
      call c_f_pointer(bodies, bytes, [size])
      bytes = transfer(view, bytes, size)
   end subroutine hand_out

   !> Address of element j, from 0, of an array of doubles.
   type(c_ptr) function element(base, j)
      type(c_ptr), intent(in) :: base
      integer, intent(in) :: j
      real(c_double), pointer :: x(:)
      call c_f_pointer(base, x, [j + 1])
      element = c_loc(x(j + 1))
   end function element

end module poinsot_api_bodies
