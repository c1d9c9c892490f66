!> The efficient frontier, with as few candidates as the measured times can distinguish.
module poinsot_study_efficient
   use poinsot_core_kinds, only: dp
   use poinsot_core_maxima, only: larger
   use poinsot_study_cost_point, only: cost_point, error_of, middle
   implicit none(type, external)
   private
   public :: frontier_part, frontier_parts, leading_parts

   real(dp), parameter :: as_good = 1.2_dp   !! times closer than this are the same
   real(dp), parameter :: coarsest = 0.3_dp, finest = 1e-17_dp
   real(dp), parameter :: grid = 1.2589254117941673_dp !! ten tolerances a decade

   !> A range of tolerances and the cheapest candidate there.
   type :: frontier_part
      integer :: candidate = 0
      real(dp) :: from = 0, to = 0   !! errors, coarse to fine
      integer :: point = 0           !! its point in the middle of the range
   end type frontier_part

contains

   !> Cover the tolerances from coarse to fine, each time by the candidate that stays within 20 % of
   !> the cheapest longest.
   pure subroutine frontier_parts(points, candidates, what, parts)
      type(cost_point), intent(in) :: points(:)
      integer, intent(in) :: candidates, what
      type(frontier_part), allocatable, intent(out) :: parts(:)
      type(frontier_part) :: found(200)
      real(dp), allocatable :: tol(:), cost_of(:, :)
      integer :: i, n, j, last, best, reach
      call costs(points, candidates, what, tol, cost_of)
      n = 0
      j = 1
      do while (j <= size(tol) .and. n < size(found))
         if (.not. minval(cost_of(:, j)) < huge(1.0_dp)) then
            j = j + 1
            cycle
         end if
         reach = 0
         best = 0
         do i = 1, candidates
            last = j - 1
            do while (last < size(tol))
               if (.not. minval(cost_of(:, last + 1)) < huge(1.0_dp)) exit
               if (cost_of(i, last + 1) > as_good*minval(cost_of(:, last + 1))) exit
               last = last + 1
            end do
            if (last <= reach .or. last < j) cycle
            reach = last
            best = i
         end do
         n = n + 1
         found(n) = frontier_part(best, tol(j), tol(reach), 0)
         found(n)%point = point_at(points, best, what, tol((j + reach)/2))
         j = reach + 1
      end do
      parts = found(:n)
   end subroutine frontier_parts

   !> The efficient frontier; behind it, where `taylor` is among the candidates, what it would be
   !> without: those are what people compare with, and what energy over long times asks for.
   pure subroutine leading_parts(points, candidates, what, parts)
      type(cost_point), intent(in) :: points(:)
      integer, intent(in) :: candidates, what
      type(frontier_part), allocatable, intent(out) :: parts(:)
      type(frontier_part), allocatable :: others(:)
      type(cost_point) :: stepped(size(points))
      call frontier_parts(points, candidates, what, parts)
      if (.not. any(points%tolerance > 0)) return
      stepped = points
      where (points%tolerance > 0) stepped%good = .false.
      call frontier_parts(stepped, candidates, what, others)
      parts = [parts, others]
   end subroutine leading_parts

   !> Cheapest time of every candidate at every tolerance that has points.
   pure subroutine costs(points, candidates, what, tol, cost_of)
      type(cost_point), intent(in) :: points(:)
      integer, intent(in) :: candidates, what
      real(dp), allocatable, intent(out) :: tol(:), cost_of(:, :)
      real(dp) :: deviation
      integer :: i, j, n
      deviation = coarsest ! no names for what rounding leaves of one and takes from another
      do i = 1, size(points)
         if (points(i)%good .and. points(i)%ns > 0) deviation = min(deviation, &
            larger(error_of(points(i), what, &
            middle), finest))
      end do
      n = max(1, int(log(coarsest/(3*deviation))/log(grid)))
      allocate (tol(n), cost_of(candidates, n))
      cost_of = huge(1.0_dp)
      do j = 1, n
         tol(j) = coarsest/grid**(j - 1)
      end do
      do i = 1, size(points)
         associate (p => points(i))
            if (.not. p%good .or. .not. p%ns > 0) cycle
            deviation = larger(error_of(p, what, middle), finest)
            do j = 1, n
               if (.not. deviation <= tol(j)) exit
               cost_of(p%candidate, j) = min(cost_of(p%candidate, j), p%ns/p%h)
            end do
         end associate
      end do
   end subroutine costs

   !> The cheapest point of a candidate within a tolerance.
   pure integer function point_at(points, candidate, what, tol) result(at)
      type(cost_point), intent(in) :: points(:)
      integer, intent(in) :: candidate, what
      real(dp), intent(in) :: tol
      integer :: i
      at = 0
      do i = 1, size(points)
         if (points(i)%candidate /= candidate .or. .not. points(i)%good .or. &
            .not. points(i)%ns > 0) cycle
         if (error_of(points(i), what, middle) > tol) cycle
         if (at > 0) then
            if (points(i)%ns/points(i)%h >= points(at)%ns/points(at)%h) cycle
         end if
         at = i
      end do
   end function point_at

end module poinsot_study_efficient
