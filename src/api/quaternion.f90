!> Implementation of the C functions for quaternion algebra, on rows [n][4]. See include/poinsot.h
!> and cpu_check.c.
!>
!> Each row is read before its result is written, so that input and output may be the same array.
!> Products that could overflow are computed with scaled factors: a result out of range is NaN, and
!> raises no exception.
module poinsot_api_quaternion
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_size_t
   use poinsot_api_arrays, only: check_arrays, give
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error
   use poinsot_core_status, only: poinsot_ok
   use poinsot_rotation_quaternion, only: attitude_distance, identity_quaternion, is_attitude, &
      normalise, quaternion_conjugate, quaternion_exp, quaternion_inverse, quaternion_log, &
      quaternion_product, rotate, rotate_back, shortest_arc, slerp
   use poinsot_rotation_random, only: random_quaternion
   use poinsot_rotation_vector, only: largest_exponent
   implicit none(type, external)
   private

   real(dp), parameter :: usual = 2.0_dp**500 !! products and squares up to it are in range

contains

   !> r = p o q
   integer(c_int) function multiply(n, p, q, r) bind(c, name="poinsot_do_quaternion_multiply") &
      result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: p(4, *), q(4, *)
      real(c_double), intent(inout), optional, target :: r(4, *)
      real(dp) :: product(4)
      integer(c_size_t) :: i
      integer :: ep, eq
      logical :: good
      status = check_arrays(n, present(p) .and. present(q) .and. present(r))
      if (status /= poinsot_ok) return
      do i = 1, n
         product = 0
         good = all_finite(p(:, i)) .and. all_finite(q(:, i))
         if (good) then
            ep = excess(p(:, i))
            eq = excess(q(:, i))
            product = quaternion_product(scaled(p(:, i), -ep), scaled(q(:, i), -eq))
            call scale_back(ep + eq, product, good)
         end if
         call give(product, good, r(:, i), status)
      end do
   end function multiply

   !> (q0, -q1, -q2, -q3)
   integer(c_int) function conjugate(n, q, r) bind(c, name="poinsot_do_quaternion_conjugate") &
      result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: q(4, *)
      real(c_double), intent(inout), optional, target :: r(4, *)
      integer(c_size_t) :: i
      status = check_arrays(n, present(q) .and. present(r))
      if (status /= poinsot_ok) return
      do i = 1, n
         call give(quaternion_conjugate(q(:, i)), all_finite(q(:, i)), r(:, i), status)
      end do
   end function conjugate

   !> 1/q
   integer(c_int) function inverse(n, q, r) bind(c, name="poinsot_do_quaternion_inverse") &
      result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: q(4, *)
      real(c_double), intent(inout), optional, target :: r(4, *)
      real(dp) :: x(4)
      integer(c_size_t) :: i
      logical :: good
      status = check_arrays(n, present(q) .and. present(r))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = all_finite(q(:, i))
         if (good) x = quaternion_inverse(q(:, i))
         call give(x, maxval(abs(x)) > 0, r(:, i), status)
      end do
   end function inverse

   !> q/|q|
   integer(c_int) function normalize(n, q, r) bind(c, name="poinsot_do_quaternion_normalize") &
      result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: q(4, *)
      real(c_double), intent(inout), optional, target :: r(4, *)
      real(dp) :: x(4)
      integer(c_size_t) :: i
      logical :: good
      status = check_arrays(n, present(q) .and. present(r))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = has_direction(q(:, i))
         if (good) x = normalise(q(:, i))
         call give(x, good, r(:, i), status)
      end do
   end function normalize

   !> e**q
   integer(c_int) function exp_of(n, q, r) bind(c, name="poinsot_do_quaternion_exp") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: q(4, *)
      real(c_double), intent(inout), optional, target :: r(4, *)
      real(dp), parameter :: most = 709.78_dp, longest = 1e308_dp
      real(dp) :: x(4)
      integer(c_size_t) :: i
      logical :: good
      status = check_arrays(n, present(q) .and. present(r))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = all_finite(q(:, i))
         if (good) good = q(1, i) <= most .and. maxval(abs(q(2:4, i))) <= longest
         if (good) x = quaternion_exp(q(:, i))
         call give(x, good, r(:, i), status)
      end do
   end function exp_of

   !> Principal logarithm.
   integer(c_int) function log_of(n, q, r) bind(c, name="poinsot_do_quaternion_log") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: q(4, *)
      real(c_double), intent(inout), optional, target :: r(4, *)
      real(dp) :: x(4)
      integer(c_size_t) :: i
      logical :: good
      status = check_arrays(n, present(q) .and. present(r))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = has_direction(q(:, i))
         if (good) x = quaternion_log(q(:, i))
         call give(x, good, r(:, i), status)
      end do
   end function log_of

   !> w = Q v
   integer(c_int) function rotate_rows(n, q, v, w) bind(c, name="poinsot_do_quaternion_rotate") &
      result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: q(4, *), v(3, *)
      real(c_double), intent(inout), optional, target :: w(3, *)
      status = turn_rows(n, q, v, w, .false.)
   end function rotate_rows

   !> w = Q^T v
   integer(c_int) function rotate_rows_back(n, q, v, w) &
      bind(c, name="poinsot_do_quaternion_rotate_back") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: q(4, *), v(3, *)
      real(c_double), intent(inout), optional, target :: w(3, *)
      status = turn_rows(n, q, v, w, .true.)
   end function rotate_rows_back

   integer(c_int) function turn_rows(n, q, v, w, back) result(status)
      integer(c_size_t), intent(in) :: n
      real(c_double), intent(in), optional, target :: q(4, *), v(3, *)
      real(c_double), intent(inout), optional, target :: w(3, *)
      logical, intent(in) :: back
      real(dp) :: x(3)
      integer(c_size_t) :: i
      integer :: e
      logical :: good
      status = check_arrays(n, present(q) .and. present(v) .and. present(w))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = is_attitude(q(:, i)) .and. all_finite(v(:, i))
         if (good) then
            e = excess(v(:, i))
            x = scaled(v(:, i), -e)
            if (back) then
               x = rotate_back(q(:, i), x)
            else
               x = rotate(q(:, i), x)
            end if
            call scale_back(e, x, good)
         end if
         call give(x, good, w(:, i), status)
      end do
   end function turn_rows

   !> Constant turn from p (t = 0) to q (t = 1), the shorter way.
   integer(c_int) function slerp_rows(n, p, q, t, r) bind(c, name="poinsot_do_quaternion_slerp") &
      result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: p(4, *), q(4, *), t(*)
      real(c_double), intent(inout), optional, target :: r(4, *)
      real(dp), parameter :: furthest = 1e308_dp
      real(dp) :: x(4)
      integer(c_size_t) :: i
      logical :: good
      status = check_arrays(n, present(p) .and. present(q) .and. present(t) .and. present(r))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = is_attitude(p(:, i)) .and. is_attitude(q(:, i)) .and. ieee_is_finite(t(i))
         if (good) good = abs(t(i)) <= furthest
         if (good) x = slerp(p(:, i), q(:, i), t(i))
         call give(x, good, r(:, i), status)
      end do
   end function slerp_rows

   !> The smallest turn from direction a to direction b.
   integer(c_int) function shortest_arcs(n, a, b, q) &
      bind(c, name="poinsot_do_quaternion_shortest_arc") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: a(3, *), b(3, *)
      real(c_double), intent(inout), optional, target :: q(4, *)
      type(poinsot_error) :: error
      real(dp) :: x(4)
      integer(c_size_t) :: i
      logical :: good
      status = check_arrays(n, present(a) .and. present(b) .and. present(q))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = identity_quaternion
         good = has_direction(a(:, i)) .and. has_direction(b(:, i))
         if (good) call shortest_arc(a(:, i), b(:, i), x, error)
         call give(x, good, q(:, i), status)
      end do
   end function shortest_arcs

   !> min(|p-q|, |p+q|)
   integer(c_int) function distances(n, p, q, d) bind(c, name="poinsot_do_quaternion_distance") &
      result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: p(4, *), q(4, *)
      real(c_double), intent(inout), optional, target :: d(*)
      real(dp) :: x(1)
      integer(c_size_t) :: i
      integer :: e
      logical :: good
      status = check_arrays(n, present(p) .and. present(q) .and. present(d))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = all_finite(p(:, i)) .and. all_finite(q(:, i))
         if (good) then
            e = max(excess(p(:, i)), excess(q(:, i)))
            x = attitude_distance(scaled(p(:, i), -e), scaled(q(:, i), -e))
            call scale_back(e, x, good)
         end if
         call give(x(1), good, d(i), status)
      end do
   end function distances

   !> Attitudes uniform over all rotations: row i, from 0, a function of seed and i.
   integer(c_int) function random(n, seed, q) bind(c, name="poinsot_do_quaternion_random") &
      result(status)
      integer(c_size_t), value :: n
      integer(c_int64_t), value :: seed
      real(c_double), intent(inout), optional, target :: q(4, *)
      integer(c_size_t) :: i
      status = check_arrays(n, present(q))
      if (status /= poinsot_ok) return
      do i = 1, n
         q(:, i) = random_quaternion(seed, int(i, i8))
      end do
   end function random

   pure logical function all_finite(x)
      real(dp), intent(in) :: x(:)
      all_finite = all(ieee_is_finite(x))
   end function all_finite

   !> Finite and not zero?
   pure logical function has_direction(x)
      real(dp), intent(in) :: x(:)
      has_direction = all_finite(x)
      if (has_direction) has_direction = maxval(abs(x)) > 0
   end function has_direction

   !> The exponent to divide by, 0 for numbers of usual size.
   pure integer function excess(x)
      real(dp), intent(in) :: x(:) !! finite
      excess = 0
      if (maxval(abs(x)) > usual) excess = largest_exponent(x)
   end function excess

   !> x 2**e, without a call for e = 0.
   pure function scaled(x, e) result(y)
      real(dp), intent(in) :: x(:)
      integer, intent(in) :: e
      real(dp) :: y(size(x))
      y = x
      if (e /= 0) y = scale(x, e)
   end function scaled

   !> x 2**e, if it is in range.
   pure subroutine scale_back(e, x, good)
      integer, intent(in) :: e
      real(dp), intent(inout) :: x(:)
      logical, intent(out) :: good
      good = .true.
      if (e == 0) return
      good = largest_exponent(x) + e <= maxexponent(1.0_dp)
      if (good) x = scale(x, e)
   end subroutine scale_back

end module poinsot_api_quaternion
