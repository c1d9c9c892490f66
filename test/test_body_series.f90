!> Room body: the series of the exact step, in full and cut short, against quadruple precision and
!> against each other.
module test_body_series
   use testdrive, only: new_unittest, unittest_type, error_type
   use test_expectation, only: within, expect, accepted
   use test_bodies, only: random_stream, start_stream, uniform
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_error, only: poinsot_error
   use poinsot_body_class, only: body_class, make_class, series_levels, longest_step
   use poinsot_body_economy, only: first_kept, last_kept, economy_bound
   use poinsot_body_series, only: max_degree
   use poinsot_body_universal, only: sine_squared, high_sine, sine_error, economy_range
   implicit none(type, external)
   private
   public :: collect_body_series

   integer, parameter :: steps = 24 !! samples along a side of a triangle

contains

   subroutine collect_body_series(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("series-of-sn", test_sine), &
         new_unittest("series-economised", test_economy), &
         new_unittest("series-reach", test_reach)]
   end subroutine collect_body_series

   !> T by its table, and by the two bands of the exact step.
   subroutine test_sine(error)
      type(error_type), allocatable, intent(out) :: error
      real(qp) :: x, z, exact, full
      integer :: i, k
      do k = 1, steps
         do i = 0, steps
            x = economy_range*real(k*i, qp)/steps**2
            z = economy_range*real(k, qp)/steps - x
            exact = sine_square(x, z)
            full = table_sum(max_degree, x, z)
            call within(error, real(full - exact, dp), 5e-18_dp, "T by its table")
            full = table_sum(4, x, z) + high_sum(x + z, x*z)
            call within(error, real(full - exact, dp), sine_error + 5e-18_dp, "T by two bands")
         end do
      end do
   end subroutine test_sine

   !> S^2 from the recursion of mathematics section 3.
   pure real(qp) function sine_square(x, z)
      real(qp), intent(in) :: x, z
      integer, parameter :: terms = 40
      real(qp) :: s(0:terms), c(0:terms + 1), d(0:terms + 1)
      integer :: n
      c(0) = 1
      d(0) = 1
      do n = 0, terms
         s(n) = dot_product(c(0:n), d(n:0:-1))/(2*n + 1)
         c(n + 1) = -x*dot_product(s(0:n), d(n:0:-1))/(2*n + 2)
         d(n + 1) = -z*dot_product(s(0:n), c(n:0:-1))/(2*n + 2)
      end do
      sine_square = sum(s)**2
   end function sine_square

   pure real(qp) function table_sum(degree, x, z)
      integer, intent(in) :: degree
      real(qp), intent(in) :: x, z
      integer :: i, j
      table_sum = 0
      do j = degree/2, 0, -1
         do i = degree - 2*j, 0, -1
            table_sum = table_sum + sine_squared(i, j)*(x + z)**i*(x*z)**j
         end do
      end do
   end function table_sum

   pure real(qp) function high_sum(e, f)
      real(qp), intent(in) :: e, f
      integer :: m, j
      high_sum = 0
      do j = 0, 3
         do m = 0, 2
            if (5 - 2*j + m >= 0) high_sum = high_sum + high_sine(m, j)*e**(5 - 2*j + m)*f**j
         end do
      end do
   end function high_sum

   !> What the kept degrees leave of degrees 5 to 13 of P and R stays below economy_bound, and so
   !> does what is promised of an attitude.
   subroutine test_economy(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(body_class) :: class
      type(poinsot_error) :: refusal
      real(dp) :: moments(3)
      integer :: k
      stream = start_stream(1973)
      do k = 1, 60
         moments = some_body(stream, k)
         call make_class(moments, class, refusal)
         call accepted(error, refusal)
         call judge(error, class%p, class%high_p, class%reach(series_levels))
         call judge(error, class%r, class%high_r, class%reach(series_levels))
      end do
   end subroutine test_economy

   !> Generic bodies, and those at the edges of what there is.
   function some_body(stream, k) result(moments)
      type(random_stream), intent(inout) :: stream
      integer, intent(in) :: k
      real(dp) :: moments(3), d(3)
      d = [uniform(stream), uniform(stream), uniform(stream)]
      select case (mod(k, 6))
      case (0)
         d(1) = 0                       ! flat
      case (1)
         d(2:3) = 1e-9_dp*d(2:3)        ! nearly linear
      case (2)
         d(2) = d(1)*(1 + 1e-10_dp)     ! nearly symmetric
      case (3)
         d = [1.0_dp, 0.0_dp, 0.0_dp]   ! linear
      case default
         continue                       ! generic
      end select
      moments = [d(2) + d(3), d(3) + d(1), d(1) + d(2)]
   end function some_body

   subroutine judge(error, full, kept, s)
      type(error_type), allocatable, intent(inout) :: error
      real(dp), intent(in) :: full(0:max_degree, 0:max_degree), kept(0:2, 0:6), s
      real(dp) :: bound, off, p, r
      integer :: i, k, n
      bound = 0
      do n = last_kept + 1, max_degree
         bound = bound + economy_bound(full, n)*s**n
      end do
      call expect(error, sqrt(s)/2*bound <= epsilon(s)/4, "a quarter of a rounding")
      do k = 1, steps
         do i = 0, steps
            p = s*real(k*i, dp)/steps**2
            r = s*real(k, dp)/steps - p
            off = kept_sum(kept, p, r)
            do n = first_kept, max_degree
               off = off - form(full, n, p, r)
            end do
            call within(error, off, bound + 1e-22_dp, "economised")
         end do
      end do
   end subroutine judge

   pure real(dp) function form(c, n, p, r)
      real(dp), intent(in) :: c(0:max_degree, 0:max_degree), p, r
      integer, intent(in) :: n
      integer :: i
      form = 0
      do i = 0, n
         form = form + c(i, n - i)*p**i*r**(n - i)
      end do
   end function form

   pure real(dp) function kept_sum(kept, p, r)
      real(dp), intent(in) :: kept(0:2, 0:6), p, r
      integer :: m, j
      kept_sum = kept(0, 6)*r**6 + kept(1, 6)*p*r**6 + kept(2, 6)*r**7
      do j = 0, 5
         do m = 0, 2
            kept_sum = kept_sum + kept(m, j)*p**(5 - j + m)*r**j
         end do
      end do
   end function kept_sum

   !> Levels come in order, reach what the documents say for a generic body, and never too far.
   subroutine test_reach(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(body_class) :: class
      type(poinsot_error) :: refusal
      integer :: k
      call make_class([0.376_dp, 0.627_dp, 1.0_dp], class, refusal)
      call accepted(error, refusal)
      call within(error, sqrt(class%reach(1)) - 0.119_dp, 1e-3_dp, "first level")
      call within(error, sqrt(class%reach(2)) - 0.532_dp, 1e-3_dp, "second level")
      stream = start_stream(1990)
      do k = 1, 60
         call make_class(some_body(stream, k), class, refusal)
         call expect(error, class%reach(1) > 0.08_dp**2, "first level too short")
         call expect(error, class%reach(2) > 0.4_dp**2, "second level too short")
         call expect(error, class%reach(1) <= class%reach(2), "levels in order")
         call expect(error, class%reach(2) <= longest_step**2, "too far")
      end do
   end subroutine test_reach

end module test_body_series
