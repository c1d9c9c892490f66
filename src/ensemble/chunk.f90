!> Chunks of bodies sorted by class, so that they go into blocks of one class. A chunk is the unit
!> that OpenMP distributes to threads.
module poinsot_ensemble_chunk
   use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_loc
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain
   use poinsot_ensemble_bodies, only: body_view, column
   implicit none(type, external)
   private
   public :: chunk_length, chunk_count, class_sorted_chunk, collect_chunk, next_block, &
      reject_chunk

   integer, parameter :: short = 8*lanes         !! bodies in a chunk where all are of one class
   integer, parameter :: long = 256*lanes        !! at most where there are more: blocks fill up
   integer, parameter :: chunks_per_thread = 4   !! then at least, if there are bodies enough
   integer, parameter :: bytes = storage_size(1.0_dp)/8

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
      integer :: number(long), place(long), least, most, shift
      call copy_classes(view%body_class(h%first:last), h%first, number, place)
      call find_range(number(:h%n), least, most)
      if (least < view%first_class .or. most > view%first_class + classes - 1) then
         call leave_out(view, classes, h%n, number, place, refused)
         call find_range(number(:h%n), least, most)
      end if
      shift = 1 - view%first_class
      if (shift /= 0) number(:h%n) = number(:h%n) + shift
      if (are_sorted(number(:h%n))) then
         h%class(:h%n) = number(:h%n)
         h%at(:h%n) = place(:h%n)
         return
      end if
      if (most - least < 2*h%n) then
         call count_out(h%n, number, place, least + shift, most + shift, h%class, h%at)
      else
         call merge_sort(h%n, number, place, h%class, h%at)
      end if
      call read_ahead(view, h%first, last, h%touched)
   end subroutine sort_by_class

   !> All of them in the order of their places, with the caller's numbers of classes.
   pure subroutine copy_classes(class_of, first, number, place)
      integer(c_int), intent(in) :: class_of(:)
      integer, intent(in) :: first
      integer, intent(inout) :: number(long), place(long)
      integer :: i
      do i = 1, size(class_of)
         number(i) = class_of(i)
         place(i) = first + i - 1
      end do
   end subroutine copy_classes

   pure subroutine find_range(number, least, most)
      integer, intent(in) :: number(:)
      integer, intent(out) :: least, most
      integer :: i
      least = huge(least)
      most = -huge(most)
      do i = 1, size(number)
         least = min(least, number(i))
         most = max(most, number(i))
      end do
   end subroutine find_range

   pure logical function are_sorted(number)
      integer, intent(in) :: number(:) !! of classes: none is negative
      integer :: i, falls
      falls = 0
      do i = 2, size(number)
         falls = ior(falls, number(i) - number(i - 1))
      end do
      are_sorted = falls >= 0
   end function are_sorted

   !> Without those whose class is not there, and those that are skipped.
   subroutine leave_out(view, classes, n, number, place, refused)
      type(body_view), intent(in) :: view
      integer, intent(in) :: classes
      integer, intent(inout) :: n, number(long), place(long)
      logical, intent(inout) :: refused
      integer :: i, class, taken
      taken = 0
      do i = 1, n
         class = number(i)
         if (class >= view%first_class .and. class <= view%first_class + classes - 1) then
            taken = taken + 1
            place(taken) = place(i)
            number(taken) = class
         else
            refused = refused .or. class >= 0
            if (associated(view%status)) view%status(place(i)) = &
               merge(poinsot_ok, poinsot_e_domain, class < 0)
         end if
      end do
      n = taken
   end subroutine leave_out

   !> Sort by counting: how many of each class, where each class begins, and everyone to its place.
   !> Of few classes each quarter of the bodies has counters of its own: a counter that has just
   !> been written is waited for.
   pure subroutine count_out(n, number, place, least, most, class, at)
      integer, intent(in) :: n, number(long), place(long)
      integer, intent(in) :: least, most       !! of the numbers of classes
      integer, intent(inout) :: class(long), at(long) !! sorted
      integer :: next(4, least:most), i, k, c, first, quarter, many
      quarter = merge(n/4, 0, most - least < n/64)
      next = 0
      do i = 1, quarter
         call count_one(next(1, number(i)))
         call count_one(next(2, number(i + quarter)))
         call count_one(next(3, number(i + 2*quarter)))
         call count_one(next(4, number(i + 3*quarter)))
      end do
      do i = 4*quarter + 1, n
         call count_one(next(4, number(i)))
      end do
      first = 1
      do c = least, most
         many = sum(next(:, c))
         class(first:first + many - 1) = c
         do k = 1, 4
            many = next(k, c)
            next(k, c) = first
            first = first + many
         end do
      end do
      do i = 1, quarter
         call put_one(place(i), next(1, number(i)), at)
         call put_one(place(i + quarter), next(2, number(i + quarter)), at)
         call put_one(place(i + 2*quarter), next(3, number(i + 2*quarter)), at)
         call put_one(place(i + 3*quarter), next(4, number(i + 3*quarter)), at)
      end do
      do i = 4*quarter + 1, n
         call put_one(place(i), next(4, number(i)), at)
      end do
   end subroutine count_out

   pure subroutine count_one(counter)
      integer, intent(inout) :: counter
      counter = counter + 1
   end subroutine count_one

   pure subroutine put_one(place, next, at)
      integer, intent(in) :: place
      integer, intent(inout) :: next, at(long)
      integer :: k
      k = next
      next = k + 1
      at(k) = place
   end subroutine put_one

   !> Sort by merging, where the numbers of the classes lie far apart.
   pure subroutine merge_sort(n, number, place, class, at)
      integer, intent(in) :: n, number(long), place(long)
      integer, intent(inout) :: class(long), at(long)
      integer(i8) :: key(n), other(n)
      integer :: width, from
      key = shiftl(int(number(:n), i8), 32) + place(:n)
      width = 1
      do while (width < n)
         do from = 1, n, 2*width
            call merge_runs(key(from:min(n, from + width - 1)), &
                            key(from + width:min(n, from + 2*width - 1)), &
                            other(from:min(n, from + 2*width - 1)))
         end do
         key = other
         width = 2*width
      end do
      class(:n) = int(shiftr(key, 32))
      at(:n) = int(iand(key, 4294967295_i8))
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

   !> Read the bodies in the order of their places, a number of each cache line: memory is fetched
   !> at its full speed, and the blocks that follow, whose bodies are scattered, find theirs in the
   !> cache.
   subroutine read_ahead(view, first, last, touched)
      type(body_view), intent(in) :: view
      integer, intent(in) :: first, last
      integer(i8), intent(inout) :: touched    !! nobody needs it
      touched = 0
      if (.not. associated(view%y_at)) call touch(view%y, first, last, touched)
      if (.not. associated(view%q_at)) call touch(view%q, first, last, touched)
   end subroutine read_ahead

   !> Bits of a number of each line, so that nothing is raised and nothing is left out. Components
   !> that do not lie in arrays of their own lie side by side.
   subroutine touch(x, first, last, touched)
      type(column), intent(in) :: x(4)
      integer, intent(in) :: first, last       !! more than one body
      integer(i8), intent(inout) :: touched
      integer(c_intptr_t), parameter :: line = 64
      integer(c_intptr_t) :: apart
      integer :: i, j, step
      apart = address(x(1)%of(2)) - address(x(1)%of(1))
      step = int(max(1_c_intptr_t, line/max(1_c_intptr_t, abs(apart))))
      do j = 1, 4
         if (.not. associated(x(j)%of)) cycle
         if (j > 1 .and. step < line/bytes) exit
         do i = first, last, step
            touched = ieor(touched, transfer(x(j)%of(i), 1_i8))
         end do
      end do
   end subroutine touch

   !> The address of a number.
   integer(c_intptr_t) function address(x)
      real(dp), intent(in), target :: x
      address = transfer(c_loc(x), 0_c_intptr_t)
   end function address

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
