!> Copying between the caller's arrays and blocks, as fast as their layout allows: rows and
!> component arrays with vector code, other layouts by strides. The layout is determined once per
!> call.
module poinsot_ensemble_transfer
   use, intrinsic :: iso_c_binding, only: c_f_pointer, c_intptr_t, c_loc, c_ptr
   use poinsot_core_kinds, only: dp, group, groups, lanes
   use poinsot_ensemble_bodies, only: column
   implicit none(type, external)
   private
   public :: arrays, find_layout, copy_in, copy_out, rows_in_3, rows_in_4, rows_out_3, rows_out_4

   integer, parameter :: bytes = storage_size(1.0_dp)/8

   !> Some columns of the caller, and what they turned out to be.
   type :: arrays
      integer :: columns = 0                                      !! how many there are, 3 or 4
      type(column) :: any(4)                                      !! them, with their strides
      logical :: scattered = .false.        !! places need not follow each other
      real(dp), pointer, contiguous :: rows(:, :) => null() !! (columns, n), if that is what they
                                                            !! are
   end type arrays

contains

   !> Find out how bodies lie in memory.
   subroutine find_layout(from, columns, a)
      type(column), intent(in) :: from(:)
      integer, intent(in) :: columns
      type(arrays), intent(out) :: a
      type(c_ptr) :: base
      integer(c_intptr_t) :: first
      integer :: j, n
      logical :: are_rows
      n = size(from(1)%of)
      a%columns = columns
      a%any(1:columns) = from(1:columns)
      if (n < 1) return
      first = address(from(1)%of(1))
      are_rows = .true.
      do j = 1, columns
         are_rows = are_rows .and. address(from(j)%of(1)) == first + (j - 1)*bytes
         if (n > 1) are_rows = are_rows .and. address(from(j)%of(2)) - address(from(j)%of(1)) &
            == columns*bytes
      end do
      if (.not. are_rows) return
      base = c_loc(from(1)%of(1))
      call c_f_pointer(base, a%rows, [columns, n])
   end subroutine find_layout

   !> The address of a number.
   integer(c_intptr_t) function address(x)
      real(dp), intent(in), target :: x
      address = transfer(c_loc(x), 0_c_intptr_t)
   end function address

   !> Bodies at the given places into the first n lanes.
   subroutine copy_in(a, at, n, into)
      type(arrays), intent(in) :: a
      integer, intent(in) :: n, at(n)
      real(dp), intent(inout) :: into(lanes, *)
      integer :: j
      if (.not. associated(a%rows)) then
         do j = 1, a%columns
            call column_in(a%any(j)%of, a%scattered, at, n, into(1, j))
         end do
      else if (in_a_row(a%scattered, at, n)) then
         if (a%columns == 3) then
            call rows_in_3(groups, a%rows(:, at(1):at(n)), into)
         else
            call rows_in_4(groups, a%rows(:, at(1):at(n)), into)
         end if
      else if (a%columns == 3) then
         call pick_3(at, n, a%rows, into)
      else
         call pick_4(at, n, a%rows, into)
      end if
   end subroutine copy_in

   !> The first n lanes to the given places.
   subroutine copy_out(a, at, n, from)
      type(arrays), intent(inout) :: a
      integer, intent(in) :: n, at(n)
      real(dp), intent(in) :: from(lanes, *)
      integer :: j
      if (.not. associated(a%rows)) then
         do j = 1, a%columns
            call column_out(a%any(j)%of, a%scattered, at, n, from(1, j))
         end do
      else if (in_a_row(a%scattered, at, n)) then
         if (a%columns == 3) then
            call rows_out_3(groups, from, a%rows(:, at(1):at(n)))
         else
            call rows_out_4(groups, from, a%rows(:, at(1):at(n)))
         end if
      else if (a%columns == 3) then
         call place_3(at, n, from, a%rows)
      else
         call place_4(at, n, from, a%rows)
      end if
   end subroutine copy_out

   !> Do the places of a full block follow each other? They ascend unless they are scattered.
   pure logical function in_a_row(scattered, at, n)
      logical, intent(in) :: scattered
      integer, intent(in) :: n, at(n)
      in_a_row = n == lanes .and. .not. scattered
      if (in_a_row) in_a_row = at(n) - at(1) == lanes - 1
   end function in_a_row

   ! Rows here and there: to and from rows in a row, each as a whole.

   pure subroutine pick_3(at, n, rows, into)
      integer, intent(in) :: n, at(n)
      real(dp), intent(in) :: rows(3, *)
      real(dp), intent(inout) :: into(lanes, *)
      real(dp) :: picked(3, lanes)
      integer :: l
      !GCC$ novector
      do l = 1, n
         picked(1, l) = rows(1, at(l))
         picked(2, l) = rows(2, at(l))
         picked(3, l) = rows(3, at(l))
      end do
      call rows_in_3(n/group, picked, into)
      do l = group*(n/group) + 1, n
         into(l, 1) = picked(1, l)
         into(l, 2) = picked(2, l)
         into(l, 3) = picked(3, l)
      end do
   end subroutine pick_3

   pure subroutine pick_4(at, n, rows, into)
      integer, intent(in) :: n, at(n)
      real(dp), intent(in) :: rows(4, *)
      real(dp), intent(inout) :: into(lanes, *)
      real(dp) :: picked(4, lanes)
      integer :: l
      !GCC$ novector
      do l = 1, n
         picked(1, l) = rows(1, at(l))
         picked(2, l) = rows(2, at(l))
         picked(3, l) = rows(3, at(l))
         picked(4, l) = rows(4, at(l))
      end do
      call rows_in_4(n/group, picked, into)
      do l = group*(n/group) + 1, n
         into(l, 1) = picked(1, l)
         into(l, 2) = picked(2, l)
         into(l, 3) = picked(3, l)
         into(l, 4) = picked(4, l)
      end do
   end subroutine pick_4

   pure subroutine place_3(at, n, from, rows)
      integer, intent(in) :: n, at(n)
      real(dp), intent(in) :: from(lanes, *)
      real(dp), intent(inout) :: rows(3, *)
      real(dp) :: picked(3, lanes)
      integer :: l
      call rows_out_3((n + group - 1)/group, from, picked)
      !GCC$ novector
      do l = 1, n
         rows(1, at(l)) = picked(1, l)
         rows(2, at(l)) = picked(2, l)
         rows(3, at(l)) = picked(3, l)
      end do
   end subroutine place_3

   pure subroutine place_4(at, n, from, rows)
      integer, intent(in) :: n, at(n)
      real(dp), intent(in) :: from(lanes, *)
      real(dp), intent(inout) :: rows(4, *)
      real(dp) :: picked(4, lanes)
      integer :: l
      call rows_out_4((n + group - 1)/group, from, picked)
      !GCC$ novector
      do l = 1, n
         rows(1, at(l)) = picked(1, l)
         rows(2, at(l)) = picked(2, l)
         rows(3, at(l)) = picked(3, l)
         rows(4, at(l)) = picked(4, l)
      end do
   end subroutine place_4

   ! Rows of whole groups of lanes; of a full block without counting.

   pure subroutine rows_in_3(nvec, rows, into)
      integer, intent(in) :: nvec                  !! groups of lanes
      real(dp), intent(in) :: rows(3, *)
      real(dp), intent(inout) :: into(lanes, *)
      integer :: l
      if (nvec == groups) then
         do l = 1, lanes
            into(l, 1) = rows(1, l)
            into(l, 2) = rows(2, l)
            into(l, 3) = rows(3, l)
         end do
      else
         do l = 1, group*nvec
            into(l, 1) = rows(1, l)
            into(l, 2) = rows(2, l)
            into(l, 3) = rows(3, l)
         end do
      end if
   end subroutine rows_in_3

   pure subroutine rows_in_4(nvec, rows, into)
      integer, intent(in) :: nvec                  !! groups of lanes
      real(dp), intent(in) :: rows(4, *)
      real(dp), intent(inout) :: into(lanes, *)
      integer :: l
      if (nvec == groups) then
         do l = 1, lanes
            into(l, 1) = rows(1, l)
            into(l, 2) = rows(2, l)
            into(l, 3) = rows(3, l)
            into(l, 4) = rows(4, l)
         end do
      else
         do l = 1, group*nvec
            into(l, 1) = rows(1, l)
            into(l, 2) = rows(2, l)
            into(l, 3) = rows(3, l)
            into(l, 4) = rows(4, l)
         end do
      end if
   end subroutine rows_in_4

   pure subroutine rows_out_3(nvec, from, rows)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: from(lanes, *)
      real(dp), intent(inout) :: rows(3, *)
      integer :: l
      if (nvec == groups) then
         do l = 1, lanes
            rows(1, l) = from(l, 1)
            rows(2, l) = from(l, 2)
            rows(3, l) = from(l, 3)
         end do
      else
         do l = 1, group*nvec
            rows(1, l) = from(l, 1)
            rows(2, l) = from(l, 2)
            rows(3, l) = from(l, 3)
         end do
      end if
   end subroutine rows_out_3

   pure subroutine rows_out_4(nvec, from, rows)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: from(lanes, *)
      real(dp), intent(inout) :: rows(4, *)
      integer :: l
      if (nvec == groups) then
         do l = 1, lanes
            rows(1, l) = from(l, 1)
            rows(2, l) = from(l, 2)
            rows(3, l) = from(l, 3)
            rows(4, l) = from(l, 4)
         end do
      else
         do l = 1, group*nvec
            rows(1, l) = from(l, 1)
            rows(2, l) = from(l, 2)
            rows(3, l) = from(l, 3)
            rows(4, l) = from(l, 4)
         end do
      end if
   end subroutine rows_out_4

   !> One column. (Here as above: where places lie anywhere, single loads beat gathers by vectors,
   !> which compilers prefer.)
   pure subroutine column_in(from, scattered, at, n, into)
      real(dp), intent(in) :: from(:)
      logical, intent(in) :: scattered
      integer, intent(in) :: n, at(n)
      real(dp), intent(inout) :: into(lanes)
      integer :: l, first
      first = at(1) - 1
      if (in_a_row(scattered, at, n) .and. is_contiguous(from)) then
         do l = 1, lanes
            into(l) = from(first + l)
         end do
      else
         !GCC$ novector
         do l = 1, n
            into(l) = from(at(l))
         end do
      end if
   end subroutine column_in

   pure subroutine column_out(to, scattered, at, n, from)
      real(dp), intent(inout) :: to(:)
      logical, intent(in) :: scattered
      integer, intent(in) :: n, at(n)
      real(dp), intent(in) :: from(lanes)
      integer :: l, first
      first = at(1) - 1
      if (in_a_row(scattered, at, n) .and. is_contiguous(to)) then
         do l = 1, lanes
            to(first + l) = from(l)
         end do
      else
         !GCC$ novector
         do l = 1, n
            to(at(l)) = from(l)
         end do
      end if
   end subroutine column_out

end module poinsot_ensemble_transfer
