!> Dealing bodies out to blocks of one class, chunk by chunk. A chunk is the unit that OpenMP deals
!> out to threads.
module poinsot_ensemble_chunk
   use poinsot_core_kinds, only: lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain
   use poinsot_ensemble_bodies, only: body_view
   implicit none(type, external)
   private
   public :: chunk_size, chunk_count, class_sorted_chunk, collect_chunk, next_block

   integer, parameter :: chunk_size = 8*lanes !! bodies in a chunk

   !> The bodies of one chunk in the order in which they go into blocks: class by class.
   type :: class_sorted_chunk
      integer :: n                         !! bodies in it
      logical :: one_class                 !! they are all of class 1
      integer :: at(chunk_size)            !! their places in the caller's arrays
      integer :: class(chunk_size)         !! their classes
      integer :: done                      !! how many have gone into blocks
   end type class_sorted_chunk

contains

   !> Chunks that n bodies make.
   pure integer function chunk_count(n)
      integer, intent(in) :: n
      chunk_count = (n + chunk_size - 1)/chunk_size
   end function chunk_count

   !> Collect chunk number k. A body whose class does not exist is refused: POINSOT_E_DOMAIN, and
   !> left out; one whose class is negative is left out in peace.
   subroutine collect_chunk(view, classes, k, h, refused)
      type(body_view), intent(in) :: view
      integer, intent(in) :: classes          !! how many classes there are
      integer, intent(in) :: k                !! chunk, from 1
      type(class_sorted_chunk), intent(inout) :: h
      logical, intent(inout) :: refused
      integer :: i, first, last, class

      first = (k - 1)*chunk_size + 1
      last = min(view%n, k*chunk_size)
      h%n = 0
      h%done = 0
      h%one_class = .not. associated(view%body_class)
      if (h%one_class) then
         h%n = last - first + 1
         do i = 1, h%n
            h%at(i) = first + i - 1
         end do
         return
      end if
      do i = first, last
         class = view%body_class(i)
         if (class >= view%first_class .and. class < view%first_class + classes) then
            call insert(h, i, class - view%first_class + 1)
         else if (class < 0) then ! skipped
            if (associated(view%status)) view%status(i) = poinsot_ok
         else
            refused = .true.
            if (associated(view%status)) view%status(i) = poinsot_e_domain
         end if
      end do
   end subroutine collect_chunk

   !> Insert a body behind the others of its class. Bodies usually come class by class already: then
   !> nothing moves.
   pure subroutine insert(h, at, class)
      type(class_sorted_chunk), intent(inout) :: h
      integer, intent(in) :: at, class
      integer :: j
      j = h%n
      do while (j > 0)
         if (h%class(j) <= class) exit
         h%at(j + 1) = h%at(j)
         h%class(j + 1) = h%class(j)
         j = j - 1
      end do
      h%at(j + 1) = at
      h%class(j + 1) = class
      h%n = h%n + 1
   end subroutine insert

   !> The next block of the chunk: up to `lanes` bodies of one class. n = 0 when there are none
   !> left.
   pure subroutine next_block(h, first, n, number)
      type(class_sorted_chunk), intent(inout) :: h
      integer, intent(out) :: first, n, number
      first = h%done + 1
      n = 0
      number = 0
      if (first > h%n) return
      if (h%one_class) then
         number = 1
         n = min(lanes, h%n - h%done)
         h%done = h%done + n
         return
      end if
      number = h%class(first)
      do while (n < lanes .and. first + n <= h%n)
         if (h%class(first + n) /= number) exit
         n = n + 1
      end do
      h%done = h%done + n
   end subroutine next_block

end module poinsot_ensemble_chunk
