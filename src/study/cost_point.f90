!> One point of a work-precision diagram: a candidate with one step size, its errors and its time.
module poinsot_study_cost_point
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_maxima, only: larger, largest_of
   use poinsot_study_errors, only: body_errors
   use poinsot_study_statistics, only: median
   implicit none(type, external)
   private
   public :: cost_point, digest, frontier, cheapest, add_point, all_states, middle, worst, given
   public :: of_angle, of_momentum, of_both, error_of, slope_of

   !> Median and worst over all initial states, worst of the scene's own.
   integer, parameter :: middle = 1, worst = 2, given = 3
   integer, parameter :: all_states = 3
   integer, parameter :: of_angle = 1, of_momentum = 2, of_both = 3 !! the larger of the two

   real(dp), parameter :: coarse = 0.03_dp, near_rounding = 2e-13_dp !! no slope beyond these

   !> What was measured.
   type :: cost_point
      integer :: candidate = 0               !! number in the list of candidates
      integer(i8) :: steps = 0               !! from start to end
      real(dp) :: h = 0
      real(dp) :: tolerance = 0              !! of `taylor`; 0 of others
      logical :: good = .false.              !! every body came through
      real(dp) :: angle(all_states) = 0      !! median, worst, worst of the scene's own; radians
      real(dp) :: momentum(all_states) = 0   !! relative
      real(dp) :: energy(all_states) = 0     !! relative to the kinetic energy, largest over time
      real(dp) :: slope(all_states) = 0      !! drift of energy, the same per unit time
      real(dp) :: guess = 0                  !! ns per body-step while errors were measured
      real(dp) :: ns = 0 !! per body-step of an ensemble, median of the repetitions
      real(dp) :: ns_least = 0, ns_spread = 0 !! least; half the middle half, relative
      real(dp) :: single = 0                 !! the same of one body alone
      real(dp) :: single_spread = 0
      integer :: repeats = 0
      logical :: front(2) = .false.          !! on the frontier of attitude, of momentum
   end type cost_point

contains

   !> Median, worst, and worst of the first `given_bodies`.
   pure subroutine digest(errors, given_bodies, point)
      type(body_errors), intent(in) :: errors
      integer, intent(in) :: given_bodies
      type(cost_point), intent(inout) :: point
      point%angle = three(errors%angle, given_bodies)
      point%momentum = three(errors%momentum, given_bodies)
      point%energy = three(errors%energy, given_bodies)
      point%slope = three(errors%slope, given_bodies)
      ! an error that is no number is that of no result
      point%good = point%good .and. all(ieee_is_finite([point%angle, point%momentum, point%energy]))
   end subroutine digest

   pure function three(x, given_bodies) result(values)
      real(dp), intent(in) :: x(:)
      integer, intent(in) :: given_bodies
      real(dp) :: values(all_states)
      values = [median(x), largest_of(x), largest_of(x(:given_bodies))]
   end function three

   !> The error that counts.
   elemental real(dp) function error_of(point, what, which) result(error)
      type(cost_point), intent(in) :: point
      integer, intent(in) :: what      !! of_angle, of_momentum, of_both
      integer, intent(in) :: which     !! middle, worst, own
      select case (what)
      case (of_angle)
         error = point%angle(which)
      case (of_momentum)
         error = point%momentum(which)
      case default
         error = larger(point%angle(which), point%momentum(which))
      end select
   end function error_of

   !> Time of the ensemble per body and unit of simulated time, ns.
   elemental real(dp) function time_of(point)
      type(cost_point), intent(in) :: point
      time_of = huge(time_of)
      if (point%h > 0 .and. point%good) time_of = point%ns/point%h
   end function time_of

   !> Mark the points that no other beats in both time and median error.
   pure subroutine frontier(points, what)
      type(cost_point), intent(inout) :: points(:)
      integer, intent(in) :: what      !! of_angle or of_momentum
      real(dp) :: time(size(points)), deviation(size(points))
      integer :: i
      do i = 1, size(points)
         time(i) = time_of(points(i))
         deviation(i) = error_of(points(i), what, middle)
      end do
      do i = 1, size(points)
         points(i)%front(what) = points(i)%good .and. points(i)%ns > 0 .and. .not. &
            any(points%good .and. points%ns > 0 .and. time <= time(i) .and. &
               deviation <= deviation(i) .and. &
                (time < time(i) .or. deviation < deviation(i)))
      end do
   end subroutine frontier

   !> Number of the cheapest point whose error is within the tolerance, 0 if none; not those of the
   !> candidate `but`.
   pure integer function cheapest(points, tol, what, which, but) result(best)
      type(cost_point), intent(in) :: points(:)
      real(dp), intent(in) :: tol
      integer, intent(in) :: what, which
      integer, intent(in), optional :: but
      integer :: i
      best = 0
      do i = 1, size(points)
         if (.not. points(i)%good .or. .not. points(i)%ns > 0) cycle
         if (error_of(points(i), what, which) > tol) cycle
         if (present(but)) then
            if (points(i)%candidate == but) cycle
         end if
         if (best > 0) then
            if (time_of(points(i)) >= time_of(points(best))) cycle
         end if
         best = i
      end do
   end function cheapest

   !> Slope of a candidate's median attitude error between its two finest points clear of rounding;
   !> 0 if there are no two.
   pure real(dp) function slope_of(points, candidate) result(slope)
      type(cost_point), intent(in) :: points(:)
      integer, intent(in) :: candidate
      integer :: i, before, last
      slope = 0
      before = 0
      last = 0
      do i = 1, size(points)
         associate (p => points(i))
            if (p%candidate /= candidate .or. .not. p%good) cycle
            if (p%angle(middle) > coarse .or. p%angle(middle) < near_rounding) cycle
            before = last
            last = i
         end associate
      end do
      if (before == 0) return
      if (.not. points(before)%h > points(last)%h) return ! tolerances, not steps
      slope = log(points(before)%angle(middle)/points(last)%angle(middle))/ &
              log(points(before)%h/points(last)%h)
   end function slope_of

   !> One more point.
   subroutine add_point(points, n, one)
      type(cost_point), allocatable, intent(inout) :: points(:)
      integer, intent(inout) :: n               !! how many there are
      type(cost_point), intent(in) :: one
      type(cost_point), allocatable :: more(:)
      if (n == size(points)) then
         allocate (more(2*n + 16))
         more(:n) = points
         call move_alloc(more, points)
      end if
      n = n + 1
      points(n) = one
   end subroutine add_point

end module poinsot_study_cost_point
