!> Room body: the series of the exact step, in full and cut short, against quadruple precision and
!> against each other.
module test_body_series
   use testdrive, only: new_unittest, unittest_type, error_type
   use test_expectation, only: within, expect, accepted
   use test_bodies, only: random_stream, start_stream, uniform
   use poinsot_core_kinds, only: dp, qp, lanes
   use poinsot_core_error, only: poinsot_error
   use poinsot_body_class, only: body_class, make_class, series_levels, longest_step
   use poinsot_body_constants, only: lane_constants, make_constants
   use poinsot_body_economization, only: first_kept, last_kept, economization_bound
   use poinsot_body_series, only: max_degree, correction_series
   use poinsot_body_series_start, only: start_degree
   use poinsot_body_sine_series, only: short_sine, short_product, long_sine, half_cosine, &
      half_factor, short_range, short_step, long_range, short_sine_error, short_product_error, &
      long_sine_error
   implicit none(type, external)
   private
   public :: collect_body_series

   integer, parameter :: steps = 24 !! samples along a side of a triangle

contains

   subroutine collect_body_series(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("series-from-tables", test_tables), &
         new_unittest("class-is-small", test_size), &
         new_unittest("series-of-sn", test_sine), &
         new_unittest("series-economized", test_economy), &
         new_unittest("series-reach", test_reach), &
         new_unittest("reach-of-each", test_reach_of_each)]
   end subroutine collect_body_series

   !> P and R against the recursion of mathematics section 3 in quadruple precision, every kind of
   !> body: within a few roundings of the sum of a coefficient's terms, degree by degree.
   subroutine test_tables(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(body_class) :: class
      type(poinsot_error) :: refusal
      real(dp), dimension(0:max_degree, 0:max_degree) :: p, r
      real(qp), dimension(0:max_degree, 0:max_degree) :: pq, rq
      real(dp) :: bound
      integer :: i, k, n
      stream = start_stream(1974)
      do k = 1, 60
         call make_class(some_body(stream, k), class, refusal)
         call accepted(error, refusal)
         call recursion(real(class%a, qp), pq, rq)
         call correction_series(class%a, max_degree, p, r)
         do n = 0, start_degree
            do i = 0, n
               p(i, n) = 2*class%half_p(i, n - i)
               r(i, n) = 2*class%half_r(i, n - i)
            end do
         end do
         do n = 0, max_degree
            bound = 4e-16_dp*1.7_dp**n*real(max(maxval(abs(pq(0:n, n))), maxval(abs(rq(0:n, n)))), &
               dp) + 2e-16_dp*0.2_dp**n
            call within(error, real(maxval(abs(p(0:n, n) - pq(0:n, n))), dp), bound, "P")
            call within(error, real(maxval(abs(r(0:n, n) - rq(0:n, n))), dp), bound, "R")
         end do
      end do
   end subroutine test_tables

   !> 1 + P and 1 + R, column n the part of degree n, row i the power of p.
   pure subroutine recursion(a, p, r)
      real(qp), intent(in) :: a(3)
      real(qp), intent(out), dimension(0:max_degree, 0:max_degree) :: p, r
      real(qp), dimension(0:max_degree, 0:max_degree) :: f, g, k, q0, q1, q2, q3, rho, w
      integer :: n
      f = 0
      g = 0
      k = 0
      q0 = 0
      q1 = 0
      q2 = 0
      q3 = 0
      f(0, 0) = 1
      g(0, 0) = 1
      q0(0, 0) = 1
      do n = 0, max_degree
         if (n > 0) then
            f(:, n) = -a(1)/(2*n)*part(k, g, n - 1, 0)
            g(:, n) = -a(3)/(2*n)*part(k, f, n - 1, 1)
            q0(:, n) = -(part(q1, f, n - 1, 1) + part(q3, g, n - 1, 0) &
               + part(q2, k, n - 2, 1))/(4*n)
         end if
         k(:, n) = a(2)/(2*n + 1)*part(f, g, n, 0)
         q1(:, n) = (part(q0, f, n, 0) + part(q2, g, n - 1, 0) - part(q3, k, n - 1, 0))/(4*n + 2)
         q3(:, n) = (part(q0, g, n, 0) + part(q1, k, n - 1, 1) - part(q2, f, n - 1, 1))/(4*n + 2)
         q2(:, n) = (part(q0, k, n, 0) - part(q1, g, n, 0) + part(q3, f, n, 0))/(4*n + 4)
         rho(:, n) = part(q0, q0, n, 0) - part(q1, q1, n - 1, 1) - part(q3, q3, n - 1, 0) &
            + part(q2, q2, n - 2, 1)
      end do
      do n = 0, max_degree
         w(:, n) = 2*(part(q0, q1, n, 0) - part(q2, q3, n - 1, 0))
      end do
      call quotient(rho, w, f, p)
      do n = 0, max_degree
         w(:, n) = 2*(part(q0, q3, n, 0) + part(q1, q2, n - 1, 1))
      end do
      call quotient(rho, w, g, r)
   end subroutine recursion

   !> The part of degree n of x y, times p^shift.
   pure function part(x, y, n, shift)
      real(qp), intent(in), dimension(0:max_degree, 0:max_degree) :: x, y
      integer, intent(in) :: n, shift
      real(qp) :: part(0:max_degree)
      integer :: i, m
      part = 0
      do m = 0, n
         do i = 0, m
            part(i + shift:i + shift + n - m) = part(i + shift:i + shift + n - m) &
               + x(i, m)*y(0:n - m, n - m)
         end do
      end do
   end function part

   !> x y / z, z beginning with 1, in powers of h^2 = 4 t^2.
   pure subroutine quotient(x, y, z, c)
      real(qp), intent(in), dimension(0:max_degree, 0:max_degree) :: x, y, z
      real(qp), intent(out), dimension(0:max_degree, 0:max_degree) :: c
      integer :: n
      c = 0
      do n = 0, max_degree
         c(:, n) = part(x, y, n, 0) - part(c, z, n, 0)
      end do
      do n = 0, max_degree
         c(:, n) = c(:, n)/4.0_qp**n
      end do
   end subroutine quotient

   !> A plan may hold a hundred thousand classes.
   subroutine test_size(error)
      type(error_type), allocatable, intent(out) :: error
      type(body_class) :: class
      call expect(error, storage_size(class)/8 <= 1200, "a class takes more than 1200 bytes")
   end subroutine test_size

   !> T, W = S C D and the half angle by their polynomials.
   subroutine test_sine(error)
      type(error_type), allocatable, intent(out) :: error
      real(qp) :: x, z, exact, v, half
      integer :: i, k
      do k = 1, steps
         do i = 0, steps
            x = short_range*real(k*i, qp)/steps**2
            z = short_range*real(k, qp)/steps - x
            exact = sine_square(x, z)
            call within(error, real(short_t(x + z, x*z) - exact, dp), short_sine_error, "short T")
            exact = sqrt(exact*(1 - x*exact)*(1 - z*exact))
            call within(error, real(short_w(x + z, x*z) - exact, dp), short_product_error, &
               "short W")
            x = long_range*real(k*i, qp)/steps**2
            z = long_range*real(k, qp)/steps - x
            exact = sine_square(x, z)
            call within(error, real(long_t(x + z, x*z) - exact, dp), long_sine_error, "long T")
         end do
         v = short_step*real(k, qp)/steps
         half = sqrt((1 + sqrt(1 - v))/2)
         call within(error, real(v*power_sum(half_cosine, v) - (half - 1), dp), 8e-19_dp, "cosine")
         call within(error, real(power_sum(half_factor, v) - 1/(2*half), dp), 6e-17_dp, "factor")
      end do
   end subroutine test_sine

   pure real(qp) function power_sum(c, v)
      real(dp), intent(in) :: c(0:)
      real(qp), intent(in) :: v
      integer :: i
      power_sum = 0
      do i = ubound(c, 1), 0, -1
         power_sum = power_sum*v + c(i)
      end do
   end function power_sum

   pure real(qp) function short_t(e, f)
      real(qp), intent(in) :: e, f
      short_t = power_sum(short_sine(1:4), e) + f*power_sum(short_sine(5:6), e) + short_sine(7)*f**2
   end function short_t

   pure real(qp) function short_w(e, f)
      real(qp), intent(in) :: e, f
      short_w = power_sum(short_product(1:5), e) + f*power_sum(short_product(6:8), e) &
                + short_product(9)*f**2
   end function short_w

   pure real(qp) function long_t(e, f)
      real(qp), intent(in) :: e, f
      long_t = power_sum(long_sine(1:8), e) + f*power_sum(long_sine(9:14), e) &
               + f**2*power_sum(long_sine(15:18), e) + f**3*power_sum(long_sine(19:20), e)
   end function long_t

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

   !> What the kept degrees leave of degrees 5 to 13 of P and R stays below economization_bound, and
   !> so does what is promised of an attitude.
   subroutine test_economy(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(body_class) :: class
      type(poinsot_error) :: refusal
      real(dp) :: moments(3)
      real(dp), dimension(0:max_degree, 0:max_degree) :: p, r
      integer :: k
      stream = start_stream(1973)
      do k = 1, 60
         moments = some_body(stream, k)
         call make_class(moments, class, refusal)
         call accepted(error, refusal)
         call correction_series(class%a, max_degree, p, r)
         call judge(error, p, class%high_p, class%reach(series_levels))
         call judge(error, r, class%high_r, class%reach(series_levels))
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
         bound = bound + economization_bound(full(:, n), n)*s**n
      end do
      call expect(error, sqrt(s)/2*bound <= epsilon(s)/4, "a quarter of a rounding")
      do k = 1, steps
         do i = 0, steps
            p = s*real(k*i, dp)/steps**2
            r = s*real(k, dp)/steps - p
            off = 2*kept_sum(kept, p, r)
            do n = first_kept, max_degree
               off = off - form(full, n, p, r)
            end do
            call within(error, off, bound + 1e-22_dp, "economized")
         end do
      end do
   end subroutine judge

   pure real(dp) function form(c, n, p, r)
      real(dp), intent(in) :: c(0:max_degree, 0:max_degree), p, r
      integer, intent(in) :: n
      integer :: i
      form = 0
      do i = 0, n
         form = form + c(i, n)*p**i*r**(n - i)
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

   !> The reach that bodies with moments of their own take by a formula is never beyond that worked
   !> out for their class; also for those that break the triangle inequality by what is accepted.
   subroutine test_reach_of_each(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(body_class) :: class
      type(lane_constants) :: c
      type(poinsot_error) :: refusal
      real(dp) :: moments(3), copies(lanes, 3)
      integer :: k
      stream = start_stream(1991)
      do k = 1, 400
         moments = some_body(stream, k)
         if (mod(k, 5) == 0) moments(3) = (moments(1) + moments(2))*(1 + 9e-4_dp*uniform(stream))
         if (mod(k, 15) == 0) moments = [1e-4_dp, 1.0_dp, 1.0009_dp]*(1 + uniform(stream))
         call make_class(moments, class, refusal)
         call accepted(error, refusal)
         copies = spread(class%moments, 1, lanes)
         call make_constants(1, copies, c)
         call expect(error, c%reach(1) <= class%reach(1), "beyond the reach of the class")
         call expect(error, c%reach(1) > 0.05_dp**2 .or. class%a(1) > 1, "too short")
         call within(error, c%theta(1) - class%theta, 0.0_dp, "theta")
      end do
   end subroutine test_reach_of_each

end module test_body_series
