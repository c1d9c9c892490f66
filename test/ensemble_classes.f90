!> Room ensemble: classes by their moments, and many of them.
module test_ensemble_classes
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use testdrive, only: unittest_type, new_unittest, error_type
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_chunk, only: class_sorted_chunk, collect_chunk
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_tensor_class, find_class
   use poinsot_ensemble_step, only: drift_bodies
   use test_bodies, only: random_stream, start_stream, uniform
   use test_expectation, only: expect, refused, accepted
   implicit none(type, external)
   private
   public :: collect_classes, collect_classes_deep

contains

   subroutine collect_classes(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("class-found-by-moments", test_find), &
         new_unittest("class-found-is-the-nearest", test_nearest), &
         new_unittest("class-not-found", test_refused), &
         new_unittest("classes-in-any-order", test_any_order), &
         new_unittest("classes-by-the-thousand", test_thousands)]
   end subroutine collect_classes

   subroutine collect_classes_deep(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [new_unittest("classes-by-the-hundred-thousand", test_hundred_thousand)]
   end subroutine collect_classes_deep

   !> Moments of water as coordinates of few digits give them.
   subroutine test_find(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      real(dp), parameter :: water(3) = [1.02_dp, 1.92_dp, 2.94_dp]
      real(dp) :: moments(3)
      type(random_stream) :: stream
      integer :: i, j, number
      stream = start_stream(3)
      do i = 1, 216
         moments = water*[(1 + 1e-9_dp*uniform(stream), j=1, 3)]
         call find_class(plan, moments, 1e-6_dp, number, problem)
         call accepted(error, problem)
         call expect(error, number, 1, "one class of water")
      end do
      call find_class(plan, water([3, 1, 2]), 1e-6_dp, number, problem)
      call expect(error, number, 2, "axis by axis, in the caller's order")
      call find_class(plan, 1.001_dp*water, 1e-6_dp, number, problem)
      call expect(error, number, 3, "beyond the tolerance")
      call find_class(plan, water*[1.0_dp, 1.0_dp, 1 + 3e-4_dp], 1e-3_dp, number, problem)
      call expect(error, number, 1, "the nearest of two")
      call expect(error, plan%class_count(), 3, "classes")
      call add_tensor_class(plan, reshape([5.0_dp, 0.0_dp, 0.0_dp, 0.0_dp, 5.0_dp, 0.0_dp, &
         0.0_dp, 0.0_dp, 5.0_dp], [3, 3]), number, problem)
      call find_class(plan, [5.0_dp, 5.0_dp, 5.0_dp], 0.0_dp, number, problem)
      call expect(error, number, 5, "a class made from a tensor is no candidate")
      call add_class(plan, [5.0_dp, 5.0_dp, 5.0_dp], number, problem)
      call expect(error, number, 6, "add_class adds")
      call find_class(plan, [5.0_dp, 5.0_dp, 5.0_dp], 0.0_dp, number, problem)
      call expect(error, number, 5, "the lowest of equal ones")
   end subroutine test_find

   !> As by looking at all of them, for any tolerance and order; also where they share moments.
   subroutine test_nearest(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      type(random_stream) :: stream
      real(dp) :: known(3, 700), moments(3), tolerance
      integer :: i, j, classes, number, wanted
      stream = start_stream(9)
      classes = 0
      do i = 1, 700
         moments = [(1 + 0.02_dp*int(40*uniform(stream)), j=1, 3)]
         if (mod(i, 3) == 0) moments(1) = 1.5_dp
         if (mod(i, 5) == 0) moments(2) = 1.2_dp + 1e-3_dp*i
         tolerance = merge(0.0_dp, 0.15_dp*uniform(stream), mod(i, 2) == 0)
         wanted = nearest(known(:, :classes), moments, tolerance*maxval(moments))
         if (wanted == 0) then
            classes = classes + 1
            known(:, classes) = moments
            wanted = classes
         end if
         call find_class(plan, moments, tolerance, number, problem)
         call expect(error, number, wanted, "the nearest class")
      end do
      call expect(error, classes > 100 .and. classes < 650, "some were found, some made")
   end subroutine test_nearest

   pure integer function nearest(known, moments, bound) result(number)
      real(dp), intent(in) :: known(:, :), moments(3), bound
      real(dp) :: least, distance
      integer :: i
      number = 0
      least = bound
      do i = size(known, 2), 1, -1
         distance = maxval(abs(known(:, i) - moments))
         if (distance > least) cycle
         least = distance
         number = i
      end do
   end function nearest

   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      real(dp), parameter :: one(3) = [1.0_dp, 1.0_dp, 1.0_dp]
      integer :: number
      call find_class(plan, one, -1e-6_dp, number, problem)
      call refused(error, problem, poinsot_e_domain, "tolerance is negative")
      call find_class(plan, one, ieee_value(1.0_dp, ieee_quiet_nan), number, problem)
      call refused(error, problem, poinsot_e_domain, "tolerance is not finite")
      call find_class(plan, one, ieee_value(1.0_dp, ieee_positive_inf), number, problem)
      call refused(error, problem, poinsot_e_domain, "tolerance is not finite")
      call find_class(plan, [1.0_dp, 2.0_dp, 4.0_dp], 1.0_dp, number, problem)
      call expect(error, problem%code, poinsot_e_domain, "moments that no body has")
      problem = poinsot_error()
      call expect(error, plan%class_count(), 0, "no class was made")
      call find_class(plan, 1e-150_dp*one, 1e300_dp, number, problem)
      call find_class(plan, 1e150_dp*one, 1e300_dp, number, problem)
      call accepted(error, problem)
      call expect(error, number, 1, "any tolerance that is a number")
      call make_ready(plan, problem)
      call find_class(plan, one, 0.0_dp, number, problem)
      call refused(error, problem, poinsot_e_domain, "ready")
   end subroutine test_refused

   !> Bodies go into blocks class by class, each in the order of their places, however many classes
   !> there are and however their numbers lie; who is skipped or refused is left out.
   subroutine test_any_order(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: sizes(9) = [2, 3, 31, 64, 65, 255, 256, 1027, 8192]
      integer, parameter :: ranges(5) = [2, 3, 17, 400, 100000]
      integer :: k, j
      do k = 1, size(sizes)
         do j = 1, size(ranges)
            call sort_bodies(error, sizes(k), ranges(j), .false.)
            call sort_bodies(error, sizes(k), ranges(j), .true.)
            if (allocated(error)) return
         end do
      end do
   end subroutine test_any_order

   !> n bodies of so many classes at random; with `ill` some are skipped, and some are of none.
   subroutine sort_bodies(error, n, classes, ill)
      type(error_type), allocatable, intent(inout) :: error
      integer, intent(in) :: n, classes
      logical, intent(in) :: ill
      type(random_stream) :: stream
      type(body_view) :: view
      type(class_sorted_chunk) :: h
      real(dp), target :: y(3, n), q(4, n)
      integer, target :: class(n), status(n)
      integer, allocatable :: expected(:), number(:)
      integer :: i, c
      logical :: refused
      character(60) :: what
      write (what, "(i0, a, i0, a, l1)") n, " bodies, ", classes, " classes, ill ", ill
      stream = start_stream(n + classes)
      y = 0
      q = 0.5_dp
      status = -1
      do i = 1, n
         class(i) = 1 + int(classes*uniform(stream))
         if (ill .and. mod(i, 7) == 3) class(i) = -2
         if (ill .and. mod(i, 7) == 5) class(i) = classes + i
      end do
      allocate (expected(0))
      do c = 1, merge(classes, 0, classes <= 400)
         expected = [expected, pack([(i, i=1, n)], class == c)]
      end do
      call view_rows(y, q, view)
      view%body_class => class
      view%status => status
      refused = .false.
      call collect_chunk(view, classes, n, 1, h, refused)
      call expect(error, refused .eqv. any(class > classes), trim(what)//": refused")
      call expect(error, h%n, count(class >= 1 .and. class <= classes), trim(what)//": how many")
      if (allocated(error)) return
      number = class(h%at(:h%n))
      call expect(error, all(h%class(:h%n) == number), trim(what)//": class by class")
      call expect(error, all(number(2:) > number(:h%n - 1) .or. (number(2:) == number(:h%n - 1) &
         .and. h%at(2:h%n) > h%at(:h%n - 1))), trim(what)//": in order")
      if (classes <= 400) call expect(error, all(h%at(:h%n) == expected), trim(what)//": places")
      call expect(error, all(merge(poinsot_e_domain, merge(poinsot_ok, -1, class < 0), &
         class > classes) == status), trim(what)//": statuses")
   end subroutine sort_bodies

   subroutine test_thousands(error)
      type(error_type), allocatable, intent(out) :: error
      call many_classes(error, 3000)
   end subroutine test_thousands

   subroutine test_hundred_thousand(error)
      type(error_type), allocatable, intent(out) :: error
      call many_classes(error, 100000)
   end subroutine test_hundred_thousand

   !> Bodies of so many classes, each its own, turn as bodies of moments of their own; and each
   !> class is found again.
   subroutine many_classes(error, n)
      type(error_type), allocatable, intent(out) :: error
      integer, intent(in) :: n
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      type(body_view) :: view
      real(dp), allocatable, target :: y(:, :, :), q(:, :, :), moments(:, :)
      integer, allocatable, target :: class(:)
      integer :: i, j, number, status
      allocate (y(3, n, 2), q(4, n, 2), moments(3, n), class(n))
      do i = 1, n
         moments(:, i) = [1 + 1e-5_dp*mod(7*i, n), 1.3_dp - 1e-6_dp*i, 1.1_dp]
         y(:, i, 1) = [0.1_dp, 0.2_dp + 1e-6_dp*i, 0.3_dp]
         q(:, i, 1) = 0.5_dp
         call add_class(plan, moments(:, i), class(i), problem)
      end do
      call accepted(error, problem)
      y(:, :, 2) = y(:, :, 1)
      q(:, :, 2) = q(:, :, 1)
      do i = 1, n
         call find_class(plan, moments(:, i), 1e-9_dp, number, problem)
         if (number /= i) call expect(error, number, i, "a class found again")
      end do
      call make_ready(plan, problem)
      call view_rows(y(:, :, 1), q(:, :, 1), view)
      view%body_class => class
      call drift_bodies(plan, view, 0.1_dp, status, problem)
      call expect(error, status, poinsot_ok, "bodies of many classes")
      call view_rows(y(:, :, 2), q(:, :, 2), view)
      do j = 1, 3
         view%moments(j)%of => moments(j, :)
      end do
      call drift_bodies(plan, view, 0.1_dp, status, problem)
      call expect(error, maxval(abs(y(:, :, 1) - y(:, :, 2))) < 1e-15_dp .and. &
         maxval(abs(q(:, :, 1) - q(:, :, 2))) < 1e-15_dp, "as by moments of their own")
   end subroutine many_classes

end module test_ensemble_classes
