!> An index of body classes by their moments: finds the class nearest to three numbers with far
!> fewer comparisons than there are classes.
!>
!> Balanced k-d trees of 1, 2, 4, ... classes, one for each bit of their number, stored with the
!> largest first: adding a class makes one tree of it and of all trees that are no larger (Bentley
!> and Saxe 1980). A tree is a range: its root in the middle, smaller values on an axis before it,
!> larger values after it.
module poinsot_ensemble_class_index
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: class_index, insert_class, nearest_class

   !> An entry: moments, the class they belong to, and the axis by which its tree is divided.
   type :: entry_type
      real(dp) :: moments(3) = 0
      integer :: number = 0
      integer :: axis = 1
   end type entry_type

   !> The classes known so far, in trees.
   type :: class_index
      integer :: n = 0
      type(entry_type), allocatable :: entries(:)
   end type class_index

   !> The best so far.
   type :: candidate
      real(dp) :: distance = 0     !! the largest difference of a moment
      integer :: number = 0        !! 0: none within the bound
   end type candidate

contains

   !> Add a class.
   subroutine insert_class(index, moments, number, failed)
      type(class_index), intent(inout) :: index
      real(dp), intent(in) :: moments(3)
      integer, intent(in) :: number
      logical, intent(out) :: failed         !! no memory: nothing has changed
      type(entry_type), allocatable :: longer(:)
      integer :: room, size_of_tree, state
      failed = .false.
      room = 0
      if (allocated(index%entries)) room = size(index%entries)
      if (index%n == room) then
         allocate (longer(max(16, room + room/2)), stat=state)
         failed = state /= 0
         if (failed) return
         if (room > 0) longer(:room) = index%entries
         call move_alloc(longer, index%entries)
      end if
      index%n = index%n + 1
      index%entries(index%n) = entry_type(moments, number, 1)
      size_of_tree = iand(index%n, -index%n)
      call build(index%entries(index%n - size_of_tree + 1:index%n))
   end subroutine insert_class

   !> The class whose moments differ least, by no more than a bound; of several the lowest number;
   !> 0: there is none.
   pure integer function nearest_class(index, moments, bound) result(number)
      type(class_index), intent(in) :: index
      real(dp), intent(in) :: moments(3)
      real(dp), intent(in) :: bound          !! of each difference, zero or positive
      type(candidate) :: best
      integer :: first, bit
      best = candidate(bound, 0)
      first = 1
      do bit = bit_size(first) - 2, 0, -1
         if (.not. btest(index%n, bit)) cycle
         call search(index%entries(first:first + 2**bit - 1), moments, best)
         first = first + 2**bit
      end do
      number = best%number
   end function nearest_class

   !> Make a tree of entries.
   pure recursive subroutine build(e)
      type(entry_type), intent(inout) :: e(:)
      integer :: middle, axis, j
      real(dp) :: widest, width
      if (size(e) <= 1) return
      middle = (size(e) + 1)/2
      axis = 1
      widest = -1
      do j = 1, 3
         width = maxval(e%moments(j)) - minval(e%moments(j))
         if (width <= widest) cycle
         widest = width
         axis = j
      end do
      call select(e, middle, axis)
      e(middle)%axis = axis
      call build(e(:middle - 1))
      call build(e(middle + 1:))
   end subroutine build

   !> Put the k-th entry by a moment to its place, none that is larger before it, none that is
   !> smaller behind it (Hoare's selection).
   pure subroutine select(e, k, axis)
      type(entry_type), intent(inout) :: e(:)
      integer, intent(in) :: k, axis
      type(entry_type) :: other
      real(dp) :: pivot
      integer :: low, high, i, j
      low = 1
      high = size(e)
      do while (low < high)
         pivot = e((low + high)/2)%moments(axis)
         i = low
         j = high
         do while (i <= j)
            do while (e(i)%moments(axis) < pivot)
               i = i + 1
            end do
            do while (pivot < e(j)%moments(axis))
               j = j - 1
            end do
            if (i > j) exit
            other = e(i)
            e(i) = e(j)
            e(j) = other
            i = i + 1
            j = j - 1
         end do
         if (k <= j) then
            high = j
         else if (k >= i) then
            low = i
         else
            return
         end if
      end do
   end subroutine select

   !> Look through a tree: first the side on which the moments are, then the other if it can have
   !> anything as near.
   pure recursive subroutine search(e, moments, best)
      type(entry_type), intent(in) :: e(:)
      real(dp), intent(in) :: moments(3)
      type(candidate), intent(inout) :: best
      real(dp) :: distance, side
      integer :: middle
      if (size(e) == 0) return
      middle = (size(e) + 1)/2
      distance = maxval(abs(e(middle)%moments - moments))
      if (distance < best%distance .or. .not. distance > best%distance .and. &
          (best%number == 0 .or. e(middle)%number < best%number)) then
         best = candidate(distance, e(middle)%number)
      end if
      side = moments(e(middle)%axis) - e(middle)%moments(e(middle)%axis)
      if (side <= 0) then
         call search(e(:middle - 1), moments, best)
         if (-side <= best%distance) call search(e(middle + 1:), moments, best)
      else
         call search(e(middle + 1:), moments, best)
         if (side <= best%distance) call search(e(:middle - 1), moments, best)
      end if
   end subroutine search

end module poinsot_ensemble_class_index
