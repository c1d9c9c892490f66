!> The caller's y and q where little else comes with the bodies: component by component with any
!> stride, into blocks and back. Full blocks of rows and of component arrays go by vectors.
module poinsot_ensemble_plain
   use, intrinsic :: iso_c_binding, only: c_associated, c_f_pointer, c_int, c_intptr_t, c_loc, &
      c_null_ptr, c_ptr, c_ptrdiff_t
   use poinsot_core_kinds, only: dp, group, lanes
   use poinsot_core_lanes, only: any_failed
   use poinsot_core_status, only: poinsot_ok
   use poinsot_ensemble_bodies, only: body_view, column
   use poinsot_ensemble_transfer, only: rows_in_3, rows_in_4, rows_out_3, rows_out_4
   implicit none(type, external)
   private
   public :: plain_arrays, plain_torques, open_plain, open_plain_view, open_moments, open_torques, &
      open_plain_torques, load, load_moments, load_torques, store

   integer, parameter :: bytes = storage_size(1.0_dp)/8

   !> Nothing is initialised: one body must not wait for it.
   type :: plain_arrays
      integer :: n                              !! bodies
      integer :: columns                        !! of the momentum variable, 3 or 4
      type(c_ptr) :: y(4), q(4)                 !! first numbers; y(4) is y(1) where there are three
      integer(c_ptrdiff_t) :: dy, dq            !! strides
      logical :: y_rows, q_rows                 !! they are rows without gaps
      integer(c_int), pointer, contiguous :: each(:) !! status of each body, or not associated
      real(dp), pointer, contiguous :: scale(:) !! moments over the class's, or none
      logical :: has_moments                    !! each body has its own
      type(c_ptr) :: moments(4)                 !! then their first numbers, of three components
      integer(c_ptrdiff_t) :: dm                !! and stride
      logical :: m_rows                         !! they are rows without gaps
   end type plain_arrays

   !> Torques of a kick.
   type :: plain_torques
      integer :: n                              !! bodies
      type(c_ptr) :: of(3)                      !! first numbers
      integer(c_ptrdiff_t) :: stride
      logical :: rows                           !! they are rows without gaps
   end type plain_torques

contains

   !> Arrays by the addresses of their first numbers.
   subroutine open_plain(n, columns, y, dy, q, dq, each, scale, a)
      integer, intent(in) :: n                  !! bodies; the arrays are there also without any
      integer, intent(in) :: columns            !! of y
      type(c_ptr), intent(in) :: y(columns), q(4)
      integer(c_ptrdiff_t), intent(in) :: dy, dq !! strides, at least 1
      type(c_ptr), intent(in) :: each           !! n statuses, or c_null_ptr
      type(c_ptr), intent(in) :: scale          !! n numbers, or c_null_ptr
      type(plain_arrays), intent(out) :: a
      a%n = n
      a%columns = columns
      a%dy = dy
      a%dq = dq
      a%y(1:3) = y(1:3)
      a%y(4) = y(merge(4, 1, columns == 4))
      a%q = q
      a%y_rows = .false.
      a%q_rows = .false.
      if (n >= lanes) then
         a%y_rows = are_rows(y, dy)
         a%q_rows = are_rows(q, dq)
      end if
      nullify (a%each)
      if (c_associated(each)) call c_f_pointer(each, a%each, [n])
      nullify (a%scale)
      if (c_associated(scale)) call c_f_pointer(scale, a%scale, [n])
      a%has_moments = .false.
   end subroutine open_plain

   !> Moments of each body, by the addresses of their first numbers.
   subroutine open_moments(bases, stride, a)
      type(c_ptr), intent(in) :: bases(3)
      integer(c_ptrdiff_t), intent(in) :: stride !! at least 1
      type(plain_arrays), intent(inout) :: a
      a%has_moments = .true.
      a%moments = [bases, bases(1)]
      a%dm = stride
      a%m_rows = are_rows(bases, stride)
   end subroutine open_moments

   !> The same of a view, if there is nothing in it but y, q, statuses, and scales or moments.
   subroutine open_plain_view(view, columns, a, plain)
      type(body_view), intent(in) :: view
      integer, intent(in) :: columns
      type(plain_arrays), intent(inout) :: a
      logical, intent(out) :: plain
      type(c_ptr) :: y(4), q(4), each, scale
      integer(c_ptrdiff_t) :: dy, dq
      integer :: j
      plain = view%n > 0 .and. .not. (associated(view%body_class) .or. associated(view%carry) .or. &
         associated(view%y_at) .or. associated(view%q_at))
      if (.not. plain) return
      dy = stride_of(view%n, view%y(1))
      dq = stride_of(view%n, view%q(1))
      plain = min(dy, dq) >= 1
      do j = 1, columns
         plain = plain .and. stride_of(view%n, view%y(j)) == dy
      end do
      do j = 1, 4
         plain = plain .and. stride_of(view%n, view%q(j)) == dq
      end do
      each = c_null_ptr
      if (plain .and. associated(view%status)) then
         plain = size(view%status) == 1 .or. is_contiguous(view%status)
         each = c_loc(view%status(1))
      end if
      scale = c_null_ptr
      if (plain .and. associated(view%scale)) then
         plain = size(view%scale) == 1 .or. is_contiguous(view%scale)
         scale = c_loc(view%scale(1))
      end if
      if (.not. plain) return
      do j = 1, columns
         y(j) = c_loc(view%y(j)%of(1))
      end do
      do j = 1, 4
         q(j) = c_loc(view%q(j)%of(1))
      end do
      call open_plain(view%n, columns, y(:columns), dy, q, dq, each, scale, a)
      if (associated(view%moments(1)%of)) call open_view_moments(view, a, plain)
   end subroutine open_plain_view

   !> Moments of a view, if they have one stride.
   subroutine open_view_moments(view, a, plain)
      type(body_view), intent(in) :: view
      type(plain_arrays), intent(inout) :: a
      logical, intent(out) :: plain
      type(c_ptr) :: bases(3)
      integer(c_ptrdiff_t) :: stride
      integer :: j
      stride = stride_of(view%n, view%moments(1))
      plain = stride >= 1
      do j = 1, 3
         plain = plain .and. stride_of(view%n, view%moments(j)) == stride
         bases(j) = c_loc(view%moments(j)%of(1))
      end do
      if (plain) call open_moments(bases, stride, a)
   end subroutine open_view_moments

   !> Torques by the addresses of their first numbers.
   subroutine open_torques(n, bases, stride, t)
      integer, intent(in) :: n
      type(c_ptr), intent(in) :: bases(3)
      integer(c_ptrdiff_t), intent(in) :: stride
      type(plain_torques), intent(out) :: t
      t%n = n
      t%of = bases
      t%stride = stride
      t%rows = are_rows(bases, stride)
   end subroutine open_torques

   !> The same of columns, if they have one stride.
   subroutine open_plain_torques(n, torque, t, plain)
      integer, intent(in) :: n
      type(column), intent(in) :: torque(3)
      type(plain_torques), intent(inout) :: t
      logical, intent(out) :: plain
      type(c_ptr) :: bases(3)
      integer(c_ptrdiff_t) :: stride
      integer :: j
      stride = stride_of(n, torque(1))
      plain = stride >= 1
      do j = 1, 3
         plain = plain .and. stride_of(n, torque(j)) == stride
         bases(j) = c_loc(torque(j)%of(1))
      end do
      if (plain) call open_torques(n, bases, stride, t)
   end subroutine open_plain_torques

   !> From one body to the next, in numbers; 0 if that is no whole number.
   integer(c_ptrdiff_t) function stride_of(n, x)
      integer, intent(in) :: n
      type(column), intent(in) :: x
      integer(c_intptr_t) :: apart
      stride_of = 1
      if (n == 1) return
      apart = address(c_loc(x%of(2))) - address(c_loc(x%of(1)))
      stride_of = 0
      if (mod(apart, int(bytes, c_intptr_t)) == 0) stride_of = apart/bytes
   end function stride_of

   !> Does each component begin where the one before it does, a number on, and each row where the
   !> row before it ends?
   pure logical function are_rows(x, stride)
      type(c_ptr), intent(in) :: x(:)
      integer(c_ptrdiff_t), intent(in) :: stride
      integer :: j
      are_rows = stride == size(x)
      do j = 2, size(x)
         are_rows = are_rows .and. address(x(j)) - address(x(1)) == (j - 1)*bytes
      end do
   end function are_rows

   pure integer(c_intptr_t) function address(x)
      type(c_ptr), intent(in) :: x
      address = transfer(x, 0_c_intptr_t)
   end function address

   !> Bodies from `first` on into the first m lanes; the rest of the last group is at rest.
   subroutine load(a, first, m, nvec, y, q)
      type(plain_arrays), intent(in) :: a
      integer, intent(in) :: first, m
      integer, intent(in) :: nvec               !! groups of lanes for m bodies
      real(dp), intent(inout) :: y(lanes, *), q(lanes, 4)
      integer :: l
      l = group*(nvec - 1) + 1
      if (m < group*nvec) then
         call fill(a%columns, 0.0_dp, y(l, 1))
         call fill(1, 1.0_dp, q(l, 1))
         call fill(3, 0.0_dp, q(l, 2))
      end if
      call take_from(a%y, a%n, a%columns, a%dy, a%y_rows, first, m, y)
      call take_from(a%q, a%n, 4, a%dq, a%q_rows, first, m, q)
   end subroutine load

   !> A group of lanes in some columns.
   pure subroutine fill(columns, value, x)
      integer, intent(in) :: columns
      real(dp), intent(in) :: value
      real(dp), intent(inout) :: x(lanes, *)       !! from the first lane of the group on
      integer :: j, l
      do j = 1, columns
         do l = 1, group
            x(l, j) = value
         end do
      end do
   end subroutine fill

   !> Moments of the same bodies; those of a sphere for the rest.
   subroutine load_moments(a, first, m, nvec, moments)
      type(plain_arrays), intent(in) :: a       !! with moments
      integer, intent(in) :: first, m, nvec
      real(dp), intent(inout) :: moments(lanes, 3)
      if (m < group*nvec) call fill(3, 1.0_dp, moments(group*(nvec - 1) + 1, 1))
      call take_from(a%moments, a%n, 3, a%dm, a%m_rows, first, m, moments)
   end subroutine load_moments

   !> Torques of the same bodies; none on the rest.
   subroutine load_torques(t, first, m, nvec, g)
      type(plain_torques), intent(in) :: t
      integer, intent(in) :: first, m, nvec
      real(dp), intent(inout) :: g(lanes, 3)
      if (m < group*nvec) call fill(3, 0.0_dp, g(group*(nvec - 1) + 1, 1))
      call take_from([t%of, t%of(1)], t%n, 3, t%stride, t%rows, first, m, g)
   end subroutine load_torques

   !> And back, but for those that failed; every status.
   subroutine store(a, first, m, nvec, y, q, status, keep_y, keep_q, failed)
      type(plain_arrays), intent(in) :: a
      integer, intent(in) :: first, m, nvec
      real(dp), intent(in) :: y(lanes, *), q(lanes, 4)
      integer, intent(in) :: status(lanes)
      logical, intent(in) :: keep_y, keep_q     !! these are left as they are
      logical, intent(inout) :: failed          !! set if a body failed
      integer :: l, n
      if (associated(a%each)) a%each(first:first + m - 1) = status(:m)
      if (.not. any_failed(status, nvec)) then
         call put(a, first, m, 1, y, q, keep_y, keep_q)
         return
      end if
      failed = .true.
      l = 1
      do while (l <= m)             ! in runs of those that did not
         n = 0
         do while (l + n <= m)
            if (status(l + n) /= poinsot_ok) exit
            n = n + 1
         end do
         if (n > 0) call put(a, first + l - 1, n, l, y, q, keep_y, keep_q)
         l = l + n + 1
      end do
   end subroutine store

   !> n lanes from `from` on to bodies from `first` on.
   subroutine put(a, first, n, from, y, q, keep_y, keep_q)
      type(plain_arrays), intent(in) :: a
      integer, intent(in) :: first, n, from
      real(dp), intent(in) :: y(lanes, *), q(lanes, 4)
      logical, intent(in) :: keep_y, keep_q
      if (.not. keep_y) call give_to(a%y, a%n, a%columns, a%dy, a%y_rows, first, n, from, y)
      if (.not. keep_q) call give_to(a%q, a%n, 4, a%dq, a%q_rows, first, n, from, q)
   end subroutine put

   !> Components by their addresses.
   subroutine open_columns(x, length, x1, x2, x3, x4)
      type(c_ptr), intent(in) :: x(4)
      integer(c_ptrdiff_t), intent(in) :: length
      real(dp), pointer, contiguous, dimension(:), intent(out) :: x1, x2, x3, x4
      call c_f_pointer(x(1), x1, [length])
      call c_f_pointer(x(2), x2, [length])
      call c_f_pointer(x(3), x3, [length])
      call c_f_pointer(x(4), x4, [length])
   end subroutine open_columns

   !> m bodies from `first` on of three or four components, by the addresses of these.
   subroutine take_from(x, n, columns, stride, rows, first, m, into)
      type(c_ptr), intent(in) :: x(4)
      integer, intent(in) :: n                  !! bodies that there are
      integer, intent(in) :: columns
      integer(c_ptrdiff_t), intent(in) :: stride
      logical, intent(in) :: rows
      integer, intent(in) :: first, m
      real(dp), intent(inout) :: into(lanes, *)
      real(dp), pointer, contiguous, dimension(:) :: x1, x2, x3, x4
      call open_columns(x, 1 + max(0, n - 1)*stride, x1, x2, x3, x4)
      call take(columns, stride, rows, first, m, x1, x2, x3, x4, into)
   end subroutine take_from

   !> n lanes from `from` on to bodies from `first` on.
   subroutine give_to(x, all, columns, stride, rows, first, n, from, y)
      type(c_ptr), intent(in) :: x(4)
      integer, intent(in) :: all                !! bodies that there are
      integer, intent(in) :: columns
      integer(c_ptrdiff_t), intent(in) :: stride
      logical, intent(in) :: rows
      integer, intent(in) :: first, n, from
      real(dp), intent(in) :: y(lanes, *)
      real(dp), pointer, contiguous, dimension(:) :: x1, x2, x3, x4
      call open_columns(x, 1 + max(0, all - 1)*stride, x1, x2, x3, x4)
      call give(columns, stride, rows, first, n, from, y, x1, x2, x3, x4)
   end subroutine give_to

   !> m bodies from `first` on of three or four components.
   pure subroutine take(columns, stride, rows, first, m, x1, x2, x3, x4, into)
      integer, intent(in) :: columns
      integer(c_ptrdiff_t), intent(in) :: stride
      logical, intent(in) :: rows
      integer, intent(in) :: first, m
      real(dp), intent(in) :: x1(*), x2(*), x3(*), x4(*) !! x4 is not read if there are three
      real(dp), intent(inout) :: into(lanes, *)
      integer(c_ptrdiff_t) :: at
      integer :: l
      at = 1 + (first - 1)*stride
      if (rows .and. m == lanes) then
         if (columns == 3) call rows_in_3(x1(at), into)
         if (columns == 4) call rows_in_4(x1(at), into)
      else if (stride == 1) then
         call copy(m, x1(at), into(1, 1))
         call copy(m, x2(at), into(1, 2))
         call copy(m, x3(at), into(1, 3))
         if (columns == 4) call copy(m, x4(at), into(1, 4))
      else
         do l = 1, m
            into(l, 1) = x1(at)
            into(l, 2) = x2(at)
            into(l, 3) = x3(at)
            if (columns == 4) into(l, 4) = x4(at)
            at = at + stride
         end do
      end if
   end subroutine take

   !> n lanes from `from` on to bodies from `first` on.
   pure subroutine give(columns, stride, rows, first, n, from, x, x1, x2, x3, x4)
      integer, intent(in) :: columns
      integer(c_ptrdiff_t), intent(in) :: stride
      logical, intent(in) :: rows
      integer, intent(in) :: first, n, from
      real(dp), intent(in) :: x(lanes, *)
      real(dp), intent(inout) :: x1(*), x2(*), x3(*), x4(*)
      integer(c_ptrdiff_t) :: at
      integer :: l
      at = 1 + (first - 1)*stride
      if (rows .and. n == lanes) then
         if (columns == 3) call rows_out_3(x, x1(at))
         if (columns == 4) call rows_out_4(x, x1(at))
      else if (stride == 1) then
         call copy(n, x(from, 1), x1(at))
         call copy(n, x(from, 2), x2(at))
         call copy(n, x(from, 3), x3(at))
         if (columns == 4) call copy(n, x(from, 4), x4(at))
      else
         do l = from, from + n - 1
            x1(at) = x(l, 1)
            x2(at) = x(l, 2)
            x3(at) = x(l, 3)
            if (columns == 4) x4(at) = x(l, 4)
            at = at + stride
         end do
      end if
   end subroutine give

   pure subroutine copy(n, from, to)
      integer, intent(in) :: n
      real(dp), intent(in) :: from(*)
      real(dp), intent(inout) :: to(*)
      integer :: l
      do l = 1, n
         to(l) = from(l)
      end do
   end subroutine copy

end module poinsot_ensemble_plain
