!> The caller's bodies, accessed through pointers and strides: nothing is copied or owned.
module poinsot_ensemble_bodies
   use, intrinsic :: iso_c_binding, only: c_ptr, c_null_ptr, c_size_t, c_ptrdiff_t, c_int, &
      c_int64_t, c_associated, c_f_pointer, c_sizeof
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_null, poinsot_e_size
   implicit none(type, external)
   private
   public :: poinsot_bodies, column, body_view, view_rows, view_columns, view_from, open_view, &
      open_column
   public :: most_bodies, first_size, check_rows

   integer(c_size_t), parameter :: first_size = 136 !! bytes of the struct in 0.1
   integer, parameter :: most_bodies = 268435455 !! in one call: places times 8 stay countable

   !> What C sees as `poinsot_bodies` (include/poinsot.h): component pointers and strides in
   !> doubles.
   type, bind(c) :: poinsot_bodies
      integer(c_size_t) :: size = 0            !! sizeof(poinsot_bodies) of the caller
      integer(c_size_t) :: n = 0               !! how many bodies
      type(c_ptr) :: y(3) = c_null_ptr         !! components of the momentum variable
      type(c_ptr) :: q(4) = c_null_ptr         !! components of the attitude, scalar first
      integer(c_ptrdiff_t) :: y_stride = 0     !! from one body to the next, in doubles
      integer(c_ptrdiff_t) :: q_stride = 0
      type(c_ptr) :: body_class = c_null_ptr   !! class of each body; NULL: all of the first
      type(c_ptr) :: id = c_null_ptr           !! 64-bit numbers for random streams; NULL: position
      type(c_ptr) :: carry = c_null_ptr        !! 7 n compensated sums, or NULL
      type(c_ptr) :: status = c_null_ptr       !! n statuses, or NULL
      type(c_ptr) :: y_fourth = c_null_ptr     !! fourth component of a conjugate momentum, or NULL
      integer(c_ptrdiff_t) :: first_class = 0  !! what body_class calls the first class: 0 or 1
      ! since 0.2
      integer(c_ptrdiff_t) :: class_stride = 0 !! of body_class, in ints; 0 = 1
      type(c_ptr) :: y_at = c_null_ptr         !! rows of y, from 0; NULL: body i is row i
      type(c_ptr) :: q_at = c_null_ptr         !! rows of q
      integer(c_size_t) :: rows = 0            !! how many there are; 0: unknown
      type(c_ptr) :: scale = c_null_ptr        !! moments of a body over those of its class
      type(c_ptr) :: moments(3) = c_null_ptr   !! or moments for each body
      integer(c_ptrdiff_t) :: moments_stride = 0 !! in doubles; 0 = 1
   end type poinsot_bodies

   !> One component of all bodies, with whatever stride.
   type :: column
      real(dp), pointer :: of(:) => null()
   end type column

   !> The same opened for Fortran.
   type :: body_view
      integer :: n = 0
      type(column) :: y(4)                              !! momentum variable; the fourth only for a
                                                        !! conjugate one
      type(column) :: q(4)                                     !! attitude
      integer(c_int), pointer :: body_class(:) => null()       !! from `first_class`
      integer :: first_class = 0                        !! number of the first class: 0 in C, 1 in
                                                        !! Fortran
      integer(c_int64_t), pointer :: id(:) => null()
      real(dp), pointer :: carry(:, :) => null()               !! (7, n)
      integer(c_int), pointer :: status(:) => null()
      integer(c_int), pointer :: y_at(:) => null()             !! rows of y, from 0
      integer(c_int), pointer :: q_at(:) => null()             !! rows of q, from 0
      real(dp), pointer :: scale(:) => null()                  !! moments over those of the class
      type(column) :: moments(3)                               !! or moments for each body
   end type body_view

contains

   !> View of rows: y(3, n) and q(4, n), the native layout.
   subroutine view_rows(y, q, view)
      real(dp), intent(in), target :: y(:, :)      !! (3, n), or (4, n) for a conjugate momentum
      real(dp), intent(in), target :: q(:, :)      !! (4, n)
      type(body_view), intent(out) :: view
      integer :: j
      view%n = size(q, 2)
      view%first_class = 1
      do j = 1, min(4, size(y, 1))
         view%y(j)%of => y(j, :)
      end do
      do j = 1, 4
         view%q(j)%of => q(j, :)
      end do
   end subroutine view_rows

   !> View of component arrays: y(n, 3) and q(n, 4).
   subroutine view_columns(y, q, view)
      real(dp), intent(in), target :: y(:, :), q(:, :)
      type(body_view), intent(out) :: view
      integer :: j
      view%n = size(q, 1)
      view%first_class = 1
      do j = 1, min(4, size(y, 2))
         view%y(j)%of => y(:, j)
      end do
      do j = 1, 4
         view%q(j)%of => q(:, j)
      end do
   end subroutine view_columns

   !> The bodies of a view from a given one to the last.
   function view_from(view, first) result(rest)
      type(body_view), intent(in) :: view
      integer, intent(in) :: first                 !! 1 to view%n
      type(body_view) :: rest
      integer :: j
      rest = view
      rest%n = view%n - first + 1
      do j = 1, 4
         if (associated(view%y(j)%of) .and. .not. associated(view%y_at)) then
            rest%y(j)%of => view%y(j)%of(first:)
         end if
         if (.not. associated(view%q_at)) rest%q(j)%of => view%q(j)%of(first:)
      end do
      do j = 1, 3
         if (associated(view%moments(j)%of)) rest%moments(j)%of => view%moments(j)%of(first:)
      end do
      if (associated(view%body_class)) rest%body_class => view%body_class(first:)
      if (associated(view%id)) rest%id => view%id(first:)
      if (associated(view%carry)) rest%carry => view%carry(:, first:)
      if (associated(view%status)) rest%status => view%status(first:)
      if (associated(view%y_at)) rest%y_at => view%y_at(first:)
      if (associated(view%q_at)) rest%q_at => view%q_at(first:)
      if (associated(view%scale)) rest%scale => view%scale(first:)
   end function view_from

   !> Open a C view. POINSOT_E_NULL names a pointer that is missing, POINSOT_E_SIZE a size or stride
   !> that cannot be.
   subroutine open_view(bodies, view, error)
      type(poinsot_bodies), intent(in) :: bodies
      type(body_view), intent(out) :: view
      type(poinsot_error), intent(inout) :: error
      integer :: j

      if (bodies%size /= c_sizeof(bodies)) then
         call raise(error, poinsot_e_size, "poinsot_bodies: set size = sizeof(poinsot_bodies)")
      else if (bodies%n < 0 .or. bodies%n > most_bodies) then ! an unsigned n may look negative here
         call raise(error, poinsot_e_size, "poinsot_bodies: n is beyond 268435455")
      end if
      if (raised(error)) return
      view%n = int(bodies%n)
      view%first_class = int(max(-1_c_ptrdiff_t, min(2_c_ptrdiff_t, bodies%first_class)))
      if (view%first_class /= 0 .and. view%first_class /= 1) then
         call raise(error, poinsot_e_size, "poinsot_bodies: first_class must be 0 or 1")
      end if
      if (view%n == 0 .or. raised(error)) return
      if (c_associated(bodies%y_at)) call c_f_pointer(bodies%y_at, view%y_at, [bodies%n])
      if (c_associated(bodies%q_at)) call c_f_pointer(bodies%q_at, view%q_at, [bodies%n])
      do j = 1, 3
         call open_rows(bodies%y(j), bodies, bodies%y_stride, view%y_at, "poinsot_bodies: y", &
                        view%y(j), error)
      end do
      if (c_associated(bodies%y_fourth)) then
         call open_rows(bodies%y_fourth, bodies, bodies%y_stride, view%y_at, &
                        "poinsot_bodies: y", view%y(4), error)
      end if
      do j = 1, 4
         call open_rows(bodies%q(j), bodies, bodies%q_stride, view%q_at, "poinsot_bodies: q", &
                        view%q(j), error)
      end do
      call open_classes(bodies, view, error)
      if (c_associated(bodies%id)) call c_f_pointer(bodies%id, view%id, [bodies%n])
      if (c_associated(bodies%carry)) then
         call c_f_pointer(bodies%carry, view%carry, [7_c_size_t, bodies%n])
      end if
      if (c_associated(bodies%status)) call c_f_pointer(bodies%status, view%status, [bodies%n])
   end subroutine open_view

   !> Classes, and moments of each body's own.
   subroutine open_classes(bodies, view, error)
      type(poinsot_bodies), intent(in) :: bodies
      type(body_view), intent(inout) :: view
      type(poinsot_error), intent(inout) :: error
      integer(c_int), pointer :: all(:)
      integer(c_ptrdiff_t) :: step
      integer :: j, given
      step = merge(1_c_ptrdiff_t, bodies%class_stride, bodies%class_stride == 0 .or. bodies%n == 1)
      if (step < 1 .or. step > huge(0)) then
         call raise(error, poinsot_e_size, "poinsot_bodies: class_stride is negative or beyond "// &
                    "2147483647")
         return
      end if
      if (c_associated(bodies%body_class)) then
         call c_f_pointer(bodies%body_class, all, [1 + (bodies%n - 1)*step])
         view%body_class => all(::step)
      end if
      if (c_associated(bodies%scale)) call c_f_pointer(bodies%scale, view%scale, [bodies%n])
      given = count([(c_associated(bodies%moments(j)), j=1, 3)])
      if (given == 0) return
      if (given < 3) then
         call raise(error, poinsot_e_null, "poinsot_bodies: moments has a component that is NULL")
         return
      end if
      step = merge(1_c_ptrdiff_t, bodies%moments_stride, bodies%moments_stride == 0)
      do j = 1, 3
         call open_column(bodies%moments(j), bodies%n, step, "poinsot_bodies: moments", &
                          view%moments(j), error)
      end do
   end subroutine open_classes

   !> One component of y or q, of bodies that stand in rows of the caller's choice, or one after the
   !> other.
   subroutine open_rows(base, bodies, stride, at, what, into, error)
      type(c_ptr), intent(in) :: base
      type(poinsot_bodies), intent(in) :: bodies
      integer(c_ptrdiff_t), intent(in) :: stride
      integer(c_int), pointer, intent(in) :: at(:)
      character(*), intent(in) :: what
      type(column), intent(out) :: into
      type(poinsot_error), intent(inout) :: error
      integer(c_size_t) :: rows
      rows = bodies%n
      if (associated(at)) then
         rows = bodies%rows
         if (rows == 0) rows = int(max(0, maxval(at)), c_size_t) + 1
         if (rows < 0 .or. rows > huge(0)) rows = huge(0)
      end if
      call open_column(base, rows, stride, what, into, error)
   end subroutine open_rows

   !> Check that the rows named by the caller exist. POINSOT_E_SIZE names the first that does not.
   subroutine check_rows(view, error)
      type(body_view), intent(in) :: view
      type(poinsot_error), intent(inout) :: error
      if (view%n == 0) return
      if (associated(view%y_at)) call check_index(view%y_at, size(view%y(1)%of), "y_at", error)
      if (associated(view%q_at)) call check_index(view%q_at, size(view%q(1)%of), "q_at", error)
   end subroutine check_rows

   subroutine check_index(at, rows, what, error)
      integer(c_int), intent(in) :: at(:)
      integer, intent(in) :: rows
      character(*), intent(in) :: what
      type(poinsot_error), intent(inout) :: error
      character(80) :: text
      integer :: i
      do i = 1, size(at)
         if (at(i) >= 0 .and. at(i) < rows) cycle
         write (text, "(3a, i0, a, i0, a, i0)") "poinsot_bodies: ", what, " of body ", i - 1, &
            " is ", &
            at(i), "; there are rows 0 to ", rows - 1
         call raise(error, poinsot_e_size, trim(text))
         return
      end do
   end subroutine check_index

   !> One component of n > 0 bodies. POINSOT_E_NULL without a pointer, POINSOT_E_SIZE for a stride
   !> that cannot be.
   subroutine open_column(base, n, stride, what, into, error)
      type(c_ptr), intent(in) :: base
      integer(c_size_t), intent(in) :: n             !! 1 to most_bodies
      integer(c_ptrdiff_t), intent(in) :: stride     !! in doubles
      character(*), intent(in) :: what               !! for the message
      type(column), intent(out) :: into
      type(poinsot_error), intent(inout) :: error
      real(dp), pointer :: all(:)
      integer(c_ptrdiff_t) :: step
      if (.not. c_associated(base)) then
         call raise(error, poinsot_e_null, what//" has a component that is NULL")
      else if (n > 1 .and. (stride < 1 .or. stride > huge(0))) then
         call raise(error, poinsot_e_size, what &
            //" has a stride below 1 or beyond 2147483647 doubles")
      else
         step = merge(stride, 1_c_ptrdiff_t, n > 1)
         call c_f_pointer(base, all, [1 + (n - 1)*step])
         into%of => all(::step)
      end if
   end subroutine open_column

end module poinsot_ensemble_bodies
