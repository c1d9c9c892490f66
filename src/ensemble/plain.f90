!> Loads and stores y and q if the bodies have few other data: component by component with any
!> stride. Full blocks of rows and of component arrays use vector code.
module poinsot_ensemble_plain
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_intptr_t, &
      c_loc, &
      c_long_long, c_null_ptr, c_ptr, c_ptrdiff_t
   use poinsot_core_kinds, only: dp, group, groups, lanes
   use poinsot_core_lanes, only: any_failed
   use poinsot_core_status, only: poinsot_ok
   use poinsot_ensemble_bodies, only: body_view, column
   use poinsot_ensemble_transfer, only: rows_in_3, rows_in_4, rows_out_3, rows_out_4
   implicit none(type, external)
   private
   public :: ask_for, plain_arrays, plain_torques, open_plain, open_plain_view, open_moments, &
      open_torques, &
      open_plain_torques, load, load_moments, load_scale, load_torques, store

   integer, parameter :: bytes = storage_size(1.0_dp)/8
   integer, parameter :: in_cache = 8192        !! so many bodies are near the processor anyway

   !> The numbers of a block. A pointer to it is an address and nothing more; a pointer to an array
   !> is 64 bytes, for which few bodies would have to wait.
   type, bind(c) :: numbers
      real(c_double) :: x(4*lanes)
   end type numbers

   !> Three or four components of all bodies, with one stride.
   type :: components
      integer(c_ptrdiff_t) :: stride
      logical :: rows                           !! they are rows without gaps
      type(c_ptr) :: x(4)                       !! first numbers
   end type components

   !> Nothing is initialised: one body must not wait for it.
   type :: plain_arrays
      integer :: n                              !! bodies
      integer :: columns                        !! of the momentum variable, 3 or 4
      type(components) :: y, q
      integer(c_int), pointer, contiguous :: each(:) !! status of each body, or not associated
      real(dp), pointer, contiguous :: scale(:) !! moments over the class's, or none
      logical :: has_moments                    !! each body has its own
      type(components) :: moments               !! then these
   end type plain_arrays

   !> Torques of a kick.
   type :: plain_torques
      integer :: n                              !! bodies
      type(components) :: of
   end type plain_torques

   interface
      !> See prefetch.c.
      subroutine poinsot_prefetch(from, bytes) bind(c)
         import :: c_long_long, c_ptr
         implicit none(type, external)
         type(c_ptr), value :: from
         integer(c_long_long), value :: bytes
      end subroutine poinsot_prefetch
   end interface

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
      call open_components(n, y, dy, a%y)
      call open_components(n, q, dq, a%q)
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
      call open_components(a%n, bases, stride, a%moments)
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
      call open_components(n, bases, stride, t%of)
   end subroutine open_torques

   subroutine open_components(n, bases, stride, x)
      integer, intent(in) :: n
      type(c_ptr), intent(in) :: bases(:)       !! three or four
      integer(c_ptrdiff_t), intent(in) :: stride
      type(components), intent(out) :: x
      integer :: j
      x%stride = stride
      do j = 1, 3 ! one by one: a copy of all would be a call
         x%x(j) = bases(j)
      end do
      if (size(bases) == 4) x%x(4) = bases(4)
      x%rows = .false.
      if (n >= group) x%rows = are_rows(bases, stride)
   end subroutine open_components

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

   !> Have the block after the one at `first` on its way from memory. That pays where much is done
   !> for each body; a block of one class is done before it would have come.
   subroutine ask_for(a, first)
      type(plain_arrays), intent(in) :: a
      integer, intent(in) :: first
      if (a%n <= in_cache .or. first + 2*lanes - 1 > a%n) return
      call ask_for_components(a%y, a%columns, first + lanes)
      call ask_for_components(a%q, 4, first + lanes)
      if (a%has_moments) call ask_for_components(a%moments, 3, first + lanes)
   end subroutine ask_for

   !> Numbers of one block, where it is full.
   subroutine ask_for_components(x, columns, first)
      type(components), intent(in) :: x
      integer, intent(in) :: columns, first
      integer :: j
      do j = 1, merge(columns, 1, x%stride == 1) ! else they lie side by side
         call poinsot_prefetch(number_at(x%x(j), (first - 1)*x%stride), &
                               int(bytes*lanes*x%stride, c_long_long))
      end do
   end subroutine ask_for_components

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
      call take(a%columns, a%y, first, m, y)
      call take(4, a%q, first, m, q)
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
      call take(3, a%moments, first, m, moments)
   end subroutine load_moments

   !> Scales of the same bodies; 1 for the rest.
   subroutine load_scale(a, first, m, nvec, scale)
      type(plain_arrays), intent(in) :: a       !! with scales
      integer, intent(in) :: first, m, nvec
      real(dp), intent(inout) :: scale(lanes)
      if (m < group*nvec) call fill(1, 1.0_dp, scale(group*(nvec - 1) + 1))
      call copy(m, a%scale(first:first + m - 1), scale)
   end subroutine load_scale

   !> Torques of the same bodies; none on the rest.
   subroutine load_torques(t, first, m, nvec, g)
      type(plain_torques), intent(in) :: t
      integer, intent(in) :: first, m, nvec
      real(dp), intent(inout) :: g(lanes, 3)
      if (m < group*nvec) call fill(3, 0.0_dp, g(group*(nvec - 1) + 1, 1))
      call take(3, t%of, first, m, g)
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
      if (.not. keep_y) call give(a%columns, a%y, first, n, from, y)
      if (.not. keep_q) call give(4, a%q, first, n, from, q)
   end subroutine put

   !> The address of number i, from 0, of those from an address on.
   pure type(c_ptr) function number_at(base, i)
      type(c_ptr), intent(in) :: base
      integer(c_ptrdiff_t), intent(in) :: i
      number_at = transfer(address(base) + bytes*i, base)
   end function number_at

   !> m bodies from `first` on of three or four components.
   subroutine take(columns, x, first, m, into)
      integer, intent(in) :: columns
      type(components), intent(in) :: x
      integer, intent(in) :: first, m
      real(dp), intent(inout) :: into(lanes, *)
      type(numbers), pointer :: some
      integer(c_ptrdiff_t) :: at
      integer :: j, l, whole
      at = (first - 1)*x%stride
      if (x%rows .and. m == lanes) then
         call c_f_pointer(number_at(x%x(1), at), some)
         if (columns == 3) call rows_in_3(groups, some%x, into)
         if (columns == 4) call rows_in_4(groups, some%x, into)
         return
      end if
      if (x%stride == 1) then
         do j = 1, columns
            call c_f_pointer(number_at(x%x(j), at), some)
            call copy(m, some%x, into(1, j))
         end do
         return
      end if
      whole = 0
      if (x%rows) then
         whole = m/group
         call c_f_pointer(number_at(x%x(1), at), some)
         if (columns == 3) call rows_in_3(whole, some%x, into)
         if (columns == 4) call rows_in_4(whole, some%x, into)
         whole = group*whole
      end if
      do l = whole + 1, m
         at = (first + l - 2)*x%stride
         into(l, 1) = number(x%x(1), at)
         into(l, 2) = number(x%x(2), at)
         into(l, 3) = number(x%x(3), at)
         if (columns == 4) into(l, 4) = number(x%x(4), at)
      end do
   end subroutine take

   real(dp) function number(base, i)
      type(c_ptr), intent(in) :: base
      integer(c_ptrdiff_t), intent(in) :: i
      real(dp), pointer :: one
      call c_f_pointer(number_at(base, i), one)
      number = one
   end function number

   subroutine set_number(base, i, value)
      type(c_ptr), intent(in) :: base
      integer(c_ptrdiff_t), intent(in) :: i
      real(dp), intent(in) :: value
      real(dp), pointer :: one
      call c_f_pointer(number_at(base, i), one)
      one = value
   end subroutine set_number

   !> n lanes from `from` on to bodies from `first` on.
   subroutine give(columns, x, first, n, from, y)
      integer, intent(in) :: columns
      type(components), intent(in) :: x
      integer, intent(in) :: first, n, from
      real(dp), intent(in) :: y(lanes, *)
      type(numbers), pointer :: some
      integer(c_ptrdiff_t) :: at
      integer :: j, l, whole
      at = (first - 1)*x%stride
      if (x%rows .and. n == lanes) then
         call c_f_pointer(number_at(x%x(1), at), some)
         if (columns == 3) call rows_out_3(groups, y(from, 1), some%x)
         if (columns == 4) call rows_out_4(groups, y(from, 1), some%x)
         return
      end if
      if (x%stride == 1) then
         do j = 1, columns
            call c_f_pointer(number_at(x%x(j), at), some)
            call copy(n, y(from, j), some%x)
         end do
         return
      end if
      whole = 0
      if (x%rows) then
         whole = n/group
         call c_f_pointer(number_at(x%x(1), at), some)
         if (columns == 3) call rows_out_3(whole, y(from, 1), some%x)
         if (columns == 4) call rows_out_4(whole, y(from, 1), some%x)
         whole = group*whole
      end if
      do l = whole, n - 1
         at = (first + l - 1)*x%stride
         call set_number(x%x(1), at, y(from + l, 1))
         call set_number(x%x(2), at, y(from + l, 2))
         call set_number(x%x(3), at, y(from + l, 3))
         if (columns == 4) call set_number(x%x(4), at, y(from + l, 4))
      end do
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
