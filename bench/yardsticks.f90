!> What other codes do to turn a free body, written from the literature for the table of `make
!> bench`, and the reference that everybody is measured against.
!>
!> Arrays are rows, y(3, n) and q(4, n), as the hosts keep them; variables are changed once at each
!> end of a run, not every step. Scalar code, body after body, with the sine and cosine of the C
!> library: that is how these codes do it.
module bench_yardsticks
   use poinsot_core_kinds, only: dp, qp
   use bench_runge_kutta, only: rk4_scalar, dop853_scalar, rk4_vector, dop853_vector
   implicit none(type, external)
   private
   public :: yardstick, yardsticks, reference

   abstract interface
      !> Turn all bodies freely by `steps` steps of h.
      subroutine run_bodies(moments, h, steps, y, q)
         import :: dp
         implicit none(type, external)
         real(dp), intent(in) :: moments(3)            !! three positive principal moments
         real(dp), intent(in) :: h
         integer, intent(in) :: steps
         real(dp), intent(inout) :: y(:, :), q(:, :)   !! (3, n), (4, n)
      end subroutine run_bodies
   end interface

   !> A rival: its name, order, code and source.
   type :: yardstick
      character(20) :: name = ""
      integer :: order = 0
      procedure(run_bodies), pointer, nopass :: run => null()
      character(100) :: about = ""
   end type yardstick

contains

   !> All of them.
   function yardsticks() result(all)
      type(yardstick) :: all(7)
      all(1) = yardstick("no-squish", 2, no_squish, &
         "scalar: Miller et al. 2002, as LAMMPS rigid, HOOMD, DL_POLY, RASPA do")
      all(2) = yardstick("richardson", 2, richardson, &
         "scalar: two half steps against one, as LAMMPS nve/asphere does")
      all(3) = yardstick("fixed-point midpoint", 2, midpoint, &
         "scalar: implicit midpoint rule, iterated to rounding")
      all(4) = yardstick("rk4 scalar", 4, rk4_scalar, "scalar: classical Runge-Kutta on (y, q)")
      all(5) = yardstick("rk4 vector", 4, rk4_vector, "32 bodies side by side")
      all(6) = yardstick("dop853 scalar", 8, dop853_scalar, "scalar: fixed step, on (y, q)")
      all(7) = yardstick("dop853 vector", 8, dop853_vector, "32 bodies side by side")
   end function yardsticks

   !> NO_SQUISH: the free body in five rotations about body axes, 3-2-1-2-3, of attitude and
   !> conjugate momentum p = 2 q o (0, y). T. F. Miller, M. Eleftheriou, P. Pattnaik, A. Ndirango,
   !> D. Newns, G. J. Martyna, J. Chem. Phys. 116 (2002) 8649.
   subroutine no_squish(moments, h, steps, y, q)
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(:, :), q(:, :)
      real(dp) :: p(4), a(4)
      integer :: i, s
      do i = 1, size(q, 2)
         a = q(:, i)
         p = 2*product_of(a, [0.0_dp, y(:, i)])
         do s = 1, steps
            call turn(3, h/2, moments, p, a)
            call turn(2, h/2, moments, p, a)
            call turn(1, h, moments, p, a)
            call turn(2, h/2, moments, p, a)
            call turn(3, h/2, moments, p, a)
         end do
         q(:, i) = a
         p = product_of([a(1), -a(2:4)], p)
         y(:, i) = p(2:4)/2
      end do
   end subroutine no_squish

   !> One of the five: the exact flow of H_k = (p . q o e_k)^2/(8 I_k).
   pure subroutine turn(k, t, moments, p, q)
      integer, intent(in) :: k
      real(dp), intent(in) :: t, moments(3)
      real(dp), intent(inout) :: p(4), q(4)
      real(dp) :: kp(4), kq(4), angle, c, s
      select case (k)
      case (1)
         kq = [-q(2), q(1), q(4), -q(3)]
         kp = [-p(2), p(1), p(4), -p(3)]
      case (2)
         kq = [-q(3), -q(4), q(1), q(2)]
         kp = [-p(3), -p(4), p(1), p(2)]
      case default
         kq = [-q(4), q(3), -q(2), q(1)]
         kp = [-p(4), p(3), -p(2), p(1)]
      end select
      angle = t*dot_product(p, kq)/(4*moments(k))
      c = cos(angle)
      s = sin(angle)
      p = c*p + s*kp
      q = c*q + s*kq
   end subroutine turn

   !> Richardson extrapolation of a first-order quaternion step with the velocity taken again after
   !> half of it; the momentum in space stays. This is how aspherical particles are turned in
   !> molecular dynamics (LAMMPS, fix nve/asphere).
   subroutine richardson(moments, h, steps, y, q)
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(:, :), q(:, :)
      real(dp) :: momentum(3), a(4), rate(4), whole(4), half(4), inverse(3)
      integer :: i, s
      inverse = 1/moments
      do i = 1, size(q, 2)
         a = q(:, i)
         momentum = to_space(a, y(:, i))
         do s = 1, steps
            rate = quaternion_rate(inverse, momentum, a)
            whole = unit(a + h*rate)
            half = unit(a + (h/2)*rate)
            rate = quaternion_rate(inverse, momentum, half)
            half = unit(half + (h/2)*rate)
            a = unit(2*half - whole)
         end do
         q(:, i) = a
         y(:, i) = to_body(a, momentum)
      end do
   end subroutine richardson

   !> dq/dt at a given momentum in space.
   pure function quaternion_rate(inverse, momentum, q) result(rate)
      real(dp), intent(in) :: inverse(3), momentum(3), q(4)
      real(dp) :: rate(4), w(3)
      w = 0.5_dp*to_body(q, momentum)*inverse
      rate(1) = -q(2)*w(1) - q(3)*w(2) - q(4)*w(3)
      rate(2) = q(1)*w(1) + q(3)*w(3) - q(4)*w(2)
      rate(3) = q(1)*w(2) + q(4)*w(1) - q(2)*w(3)
      rate(4) = q(1)*w(3) + q(2)*w(2) - q(3)*w(1)
   end function quaternion_rate

   !> Implicit midpoint rule: fixed-point iteration for the momentum until it stops, then the
   !> rotation by Cayley's formula.
   subroutine midpoint(moments, h, steps, y, q)
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(:, :), q(:, :)
      real(dp) :: start(3), next(3), old(3), mean(3), a(4), e(3), change, before, &
         inverse(3)
      integer :: i, s, sweep
      integer, parameter :: most_sweeps = 60
      inverse = 1/moments
      do i = 1, size(q, 2)
         start = y(:, i)
         a = q(:, i)
         do s = 1, steps
            next = start
            before = huge(before)
            do sweep = 1, most_sweeps
               mean = 0.5_dp*(start + next)
               old = next
               next = start + h*cross(mean, mean*inverse)
               change = sum(abs(next - old))
               if (.not. change > 0 .or. .not. change < before) exit
               before = change
            end do
            e = (h/2)*(0.5_dp*(start + next)*inverse)
            a = product_of(a, [1.0_dp, e])/sqrt(1 + dot_product(e, e))
            start = next
         end do
         y(:, i) = start
         q(:, i) = a
      end do
   end subroutine midpoint

   !> The reference: Taylor series of y and q in quadruple precision, 24 terms, steps of at most
   !> 1/10 with h |omega| < 0.3.
   subroutine reference(moments, t, y, q)
      real(dp), intent(in) :: moments(3)
      real(dp), intent(in) :: t                     !! time to go
      real(dp), intent(inout) :: y(3), q(4)
      integer, parameter :: terms = 24
      real(qp) :: ys(3, 0:terms), ws(3, 0:terms), qs(4, 0:terms), d(3), e(4), h, y0(3), q0(4)
      integer :: s, k, j, steps
      steps = ceiling(10*t)
      h = real(t, qp)/steps
      y0 = y
      q0 = q
      do s = 1, steps
         ys(:, 0) = y0
         qs(:, 0) = q0
         do k = 0, terms - 1
            ws(:, k) = ys(:, k)/moments
            d = 0
            e = 0
            do j = 0, k
               d = d + [ys(2, j)*ws(3, k - j) - ys(3, j)*ws(2, k - j), ys(3, j)*ws(1, &
                  k - j) - ys(1, j)*ws(3, k - j), &
                        ys(1, j)*ws(2, k - j) - ys(2, j)*ws(1, k - j)]
               e(1) = e(1) - dot_product(qs(2:4, j), ws(:, k - j))
               e(2) = e(2) + qs(1, j)*ws(1, k - j) + qs(3, j)*ws(3, k - j) - qs(4, j)*ws(2, k - j)
               e(3) = e(3) + qs(1, j)*ws(2, k - j) + qs(4, j)*ws(1, k - j) - qs(2, j)*ws(3, k - j)
               e(4) = e(4) + qs(1, j)*ws(3, k - j) + qs(2, j)*ws(2, k - j) - qs(3, j)*ws(1, k - j)
            end do
            ys(:, k + 1) = d/(k + 1)
            qs(:, k + 1) = e/(2*(k + 1))
         end do
         y0 = ys(:, terms)
         q0 = qs(:, terms)
         do k = terms - 1, 0, -1
            y0 = y0*h + ys(:, k)
            q0 = q0*h + qs(:, k)
         end do
      end do
      y = real(y0, dp)
      q = real(q0, dp)
   end subroutine reference

   !> Hamilton product.
   pure function product_of(a, b) result(c)
      real(dp), intent(in) :: a(4), b(4)
      real(dp) :: c(4)
      c(1) = a(1)*b(1) - a(2)*b(2) - a(3)*b(3) - a(4)*b(4)
      c(2) = a(1)*b(2) + a(2)*b(1) + a(3)*b(4) - a(4)*b(3)
      c(3) = a(1)*b(3) + a(3)*b(1) + a(4)*b(2) - a(2)*b(4)
      c(4) = a(1)*b(4) + a(4)*b(1) + a(2)*b(3) - a(3)*b(2)
   end function product_of

   pure function cross(a, b) result(c)
      real(dp), intent(in) :: a(3), b(3)
      real(dp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

   pure function to_space(q, v) result(x)
      real(dp), intent(in) :: q(4), v(3)
      real(dp) :: x(3), t(3)
      t = 2*cross(q(2:4), v)
      x = v + q(1)*t + cross(q(2:4), t)
   end function to_space

   pure function to_body(q, v) result(x)
      real(dp), intent(in) :: q(4), v(3)
      real(dp) :: x(3), t(3)
      t = 2*cross(v, q(2:4))
      x = v + q(1)*t + cross(t, q(2:4))
   end function to_body

   pure function unit(q) result(u)
      real(dp), intent(in) :: q(4)
      real(dp) :: u(4)
      u = q*(1/sqrt(dot_product(q, q)))
   end function unit

end module bench_yardsticks
