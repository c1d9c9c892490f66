!> Bodies sorted by class, chunk by chunk, so that they go into blocks of one class. A chunk is the
!> unit that OpenMP hands to threads.
module poinsot_ensemble_chunk
   use, intrinsic :: iso_c_binding, only: c_int
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain
   use poinsot_ensemble_bodies, only: body_view
   implicit none(type, external)
   private
   public :: chunk_length, chunk_count, class_sorted_chunk, collect_chunk, next_block, &
      reject_chunk

   integer, parameter :: short = 8*lanes         !! bodies in a chunk where all are of one class
   integer, parameter :: long = 256*lanes        !! at most where there are more: blocks fill up
   integer, parameter :: chunks_per_thread = 4   !! then at least, if there are bodies enough
   integer, parameter :: widest = 8*long         !! range of class numbers that is counted out

   !> The bodies of one chunk in the order in which they go into blocks: class by class, each in the
   !> order of their places.
   type :: class_sorted_chunk
      integer :: n                         !! bodies in it
      integer :: done                      !! how many have gone into blocks
      logical :: one_class                 !! they are all of class 1, in the order of their places
      integer :: first                     !! of them, then
      integer(i8) :: touched               !! what was read ahead; nobody needs it
      integer :: at(long)                  !! their places in the caller's arrays
      integer :: class(long)               !! their classes
   end type class_sorted_chunk

contains

   !> How many bodies make a chunk. The more there are, the fuller the blocks of bodies whose
   !> classes
   !> come in any order.
   pure integer function chunk_length(view, team)
      type(body_view), intent(in) :: view
      integer, intent(in) :: team             !! threads that share the chunks
      chunk_length = short
      if (.not. associated(view%body_class)) return
      chunk_length = max(short, min(long, lanes*(view%n/(lanes*chunks_per_thread*max(1, team)))))
   end function chunk_length

   !> Chunks that n bodies make.
   pure integer function chunk_count(n, length)
      integer, intent(in) :: n, length        !! bodies; chunk_length
      chunk_count = (n + length - 1)/length
   end function chunk_count

   !> Collect chunk number k. A body whose class does not exist is refused: POINSOT_E_DOMAIN, and
   !> left out; one whose class is negative is left out in peace.
   subroutine collect_chunk(view, classes, length, k, h, refused)
      type(body_view), intent(in) :: view
      integer, intent(in) :: classes          !! how many classes there are
      integer, intent(in) :: length           !! chunk_length
      integer, intent(in) :: k                !! chunk, from 1
      type(class_sorted_chunk), intent(inout) :: h
      logical, intent(inout) :: refused
      integer :: last
      h%first = (k - 1)*length + 1
      last = min(view%n, k*length)
      h%done = 0
      h%n = last - h%first + 1
      h%one_class = .not. associated(view%body_class)
      if (.not. h%one_class) then
         call sort_by_class(view, classes, last, h, refused)
      else if (classes < 1 .and. .not. associated(view%moments(1)%of)) then
         h%n = 0
         refused = .true.
         if (associated(view%status)) view%status(h%first:last) = poinsot_e_domain
      end if
   end subroutine collect_chunk

   !> Refuse the bodies of chunk number k, POINSOT_E_DOMAIN, but for those that are skipped: this
   !> thread does not round to nearest, and nothing that it computes would be right.
   subroutine reject_chunk(view, length, k, refused)
      type(body_view), intent(in) :: view
      integer, intent(in) :: length           !! chunk_length
      integer, intent(in) :: k                !! chunk, from 1
      logical, intent(inout) :: refused
      integer :: i
      logical :: skipped
      do i = (k - 1)*length + 1, min(view%n, k*length)
         skipped = .false.
         if (associated(view%body_class)) skipped = view%body_class(i) < 0
         refused = refused .or. .not. skipped
         if (associated(view%status)) view%status(i) = merge(poinsot_ok, poinsot_e_domain, skipped)
      end do
   end subroutine reject_chunk

   !> The bodies of a chunk in the order of their classes.
   subroutine sort_by_class(view, classes, last, h, refused)
      type(body_view), intent(in) :: view
      integer, intent(in) :: classes, last
      type(class_sorted_chunk), intent(inout) :: h
      logical, intent(inout) :: refused
      integer :: least, most
      call copy_classes(view%body_class(h%first:last), h)
      call find_range(h, least, most)
      if (least < view%first_class .or. most > view%first_class + classes - 1) then
         call leave_out(view, classes, h, refused)
         call find_range(h, least, most)
      end if
      if (view%first_class /= 1) h%class(:h%n) = h%class(:h%n) + (1 - view%first_class)
      if (are_sorted(h)) return
      if (most - least < widest) then
         call count_out(least + (1 - view%first_class), most + (1 - view%first_class), h)
      else
         call merge_sort(h)
      end if
      call read_ahead(view, last, h)
   end subroutine sort_by_class

   !> All of them in the order of their places, with the caller's numbers of classes.
   pure subroutine copy_classes(class_of, h)
      integer(c_int), intent(in) :: class_of(:)
      type(class_sorted_chunk), intent(inout) :: h
      integer :: i
      do i = 1, h%n
         h%class(i) = class_of(i)
         h%at(i) = h%first + i - 1
      end do
   end subroutine copy_classes

   pure subroutine find_range(h, least, most)
      type(class_sorted_chunk), intent(in) :: h
      integer, intent(out) :: least, most
      integer :: i
      least = huge(least)
      most = -huge(most)
      do i = 1, h%n
         least = min(least, h%class(i))
         most = max(most, h%class(i))
      end do
   end subroutine find_range

   pure logical function are_sorted(h)
      type(class_sorted_chunk), intent(in) :: h
      integer :: i, falls
      falls = 0
      do i = 2, h%n
         falls = ior(falls, h%class(i) - h%class(i - 1)) ! both are numbers of classes
      end do
      are_sorted = falls >= 0
   end function are_sorted

   !> Without those whose class is not there, and those that are skipped.
   subroutine leave_out(view, classes, h, refused)
      type(body_view), intent(in) :: view
      integer, intent(in) :: classes
      type(class_sorted_chunk), intent(inout) :: h
      logical, intent(inout) :: refused
      integer :: i, class, taken
      taken = 0
      do i = 1, h%n
         class = h%class(i)
         if (class >= view%first_class .and. class <= view%first_class + classes - 1) then
            taken = taken + 1
            h%at(taken) = h%at(i)
            h%class(taken) = class
         else
            refused = refused .or. class >= 0
            if (associated(view%status)) view%status(h%at(i)) = &
               merge(poinsot_ok, poinsot_e_domain, class < 0)
         end if
      end do
      h%n = taken
   end subroutine leave_out

   !> Sort by counting: how many of each class, where each class begins, and everyone to its place.
   pure subroutine count_out(least, most, h)
      integer, intent(in) :: least, most      !! class numbers
      type(class_sorted_chunk), intent(inout) :: h
      integer :: at(long), number(long), next(least:most), i, place, n
      at(:h%n) = h%at(:h%n)
      number(:h%n) = h%class(:h%n)
      next = 0
      do i = 1, h%n
         next(number(i)) = next(number(i)) + 1
      end do
      place = 1
      do i = least, most
         n = next(i)
         next(i) = place
         h%class(place:place + n - 1) = i
         place = place + n
      end do
      do i = 1, h%n
         place = next(number(i))
         next(number(i)) = place + 1
         h%at(place) = at(i)
      end do
   end subroutine count_out

   !> Sort by merging, where the numbers of the classes lie far apart.
   pure subroutine merge_sort(h)
      type(class_sorted_chunk), intent(inout) :: h
      integer(i8) :: key(h%n), other(h%n)
      integer :: width, from
      key = shiftl(int(h%class(:h%n), i8), 32) + h%at(:h%n)
      width = 1
      do while (width < h%n)
         do from = 1, h%n, 2*width
            call merge_runs(key(from:min(h%n, from + width - 1)), &
                            key(from + width:min(h%n, from + 2*width - 1)), &
                            other(from:min(h%n, from + 2*width - 1)))
         end do
         key = other
         width = 2*width
      end do
      h%class(:h%n) = int(shiftr(key, 32))
      h%at(:h%n) = int(iand(key, 4294967295_i8))
   end subroutine merge_sort

   !> Two sorted runs into one.
   pure subroutine merge_runs(a, b, into)
      integer(i8), intent(in) :: a(:), b(:)
      integer(i8), intent(out) :: into(:)
      integer :: i, j, k
      i = 1
      j = 1
      do k = 1, size(into)
         if (j > size(b)) then
            into(k) = a(i)
            i = i + 1
         else if (i > size(a)) then
            into(k) = b(j)
            j = j + 1
         else if (a(i) <= b(j)) then
            into(k) = a(i)
            i = i + 1
         else
            into(k) = b(j)
            j = j + 1
         end if
      end do
   end subroutine merge_runs

   !> Read one component of every body in the order of the places: memory is fetched at its full
   !> speed, and the blocks that follow, whose bodies are scattered, find theirs in the cache.
   subroutine read_ahead(view, last, h)
      type(body_view), intent(in) :: view
      integer, intent(in) :: last
      type(class_sorted_chunk), intent(inout) :: h
      h%touched = 0
      if (.not. associated(view%y_at)) h%touched = touch(view%y(1)%of(h%first:last))
      if (.not. associated(view%q_at)) h%touched = ior(h%touched, touch(view%q(1)%of(h%first:last)))
   end subroutine read_ahead

   !> Bits of all of them, so that nothing is raised and nothing is left out.
   pure integer(i8) function touch(x)
      real(dp), intent(in) :: x(:)
      integer :: i
      touch = 0
      do i = 1, size(x)
         touch = ieor(touch, transfer(x(i), 1_i8))
      end do
   end function touch

   !> The next block of the chunk: up to `lanes` bodies of one class, with their places. n = 0 when
   !> there are none left.
   pure subroutine next_block(h, n, number, at)
      type(class_sorted_chunk), intent(inout) :: h
      integer, intent(out) :: n, number       !! bodies; their class
      integer, intent(out) :: at(lanes)       !! the first n are set
      integer :: l, first
      first = h%done + 1
      n = 0
      number = 0
      if (first > h%n) return
      if (h%one_class) then
         number = 1
         n = min(lanes, h%n - h%done)
         do l = 1, n
            at(l) = h%first + h%done + l - 1
         end do
      else
         number = h%class(first)
         n = min(lanes, h%n - h%done)
         if (h%class(first + n - 1) /= number) then ! classes ascend
            n = 0
            do while (h%class(first + n) == number)
               n = n + 1
            end do
         end if
         do l = 1, n
            at(l) = h%at(first + l - 1)
         end do
      end if
      h%done = h%done + n
   end subroutine next_block

end module poinsot_ensemble_chunk
