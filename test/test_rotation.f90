!> Room rotation: identities on random input, round trips, extreme scales, refusals.
module test_rotation
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use testdrive, only: new_unittest, unittest_type, error_type
   use test_expectation, only: within, expect, refused, accepted
   use poinsot_core_kinds, only: dp, i4, i8
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_method
   use poinsot_core_error, only: poinsot_error
   use poinsot_rotation, only: cross, vector_norm, unit_vector, perpendicular, angle_between, hat, &
      vee, rot, identity_matrix, determinant, identity_quaternion, check_quaternion, &
      quaternion_product, quaternion_conjugate, quaternion_inverse, quaternion_norm, normalise, &
      rotate, rotate_back, quaternion_exp, quaternion_log, slerp, shortest_arc, attitude_distance, &
      attitude_angle, to_matrix, from_matrix, from_axis_angle, to_axis_angle, to_rotation_vector, &
      from_cayley, to_cayley, from_euler, to_euler, check_rotation, nearest_rotation, &
      quaternion_u, quaternion_v, quaternion_a, matrix_u, matrix_v, matrix_a, random_uniform, &
      random_gaussian, random_quaternion, random_direction
   use poinsot_rotation_conversions, only: attitude_of_euler, euler_axes, euler_of_attitude
   use poinsot_rotation_random, only: philox4x32, random_words, uniform_from_words
   use poinsot_rotation_vector, only: largest_exponent
   implicit none(type, external)
   private
   public :: collect_rotation

   integer(i8), parameter :: seed = 20130415_i8, trials = 1000_i8
   real(dp), parameter :: eps = epsilon(1._dp), pi = acos(-1._dp)
   character(*), parameter :: conventions(12) = ["xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", &
      "xzx", "yxy", "yzy", "zxz", "zyz"]

contains

   subroutine collect_rotation(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("hat-and-vee", test_hat), &
         new_unittest("vectors-at-any-scale", test_vector_scales), &
         new_unittest("perpendicular", test_perpendicular), &
         new_unittest("angle-between", test_angle_between), &
         new_unittest("quaternion-units", test_units), &
         new_unittest("quaternion-algebra", test_algebra), &
         new_unittest("quaternion-scales", test_quaternion_scales), &
         new_unittest("rotate-is-product", test_rotate), &
         new_unittest("exp-and-log", test_exp_log), &
         new_unittest("check-quaternion", test_check_quaternion), &
         new_unittest("slerp", test_slerp), &
         new_unittest("shortest-arc", test_shortest_arc), &
         new_unittest("attitude-distance", test_distance), &
         new_unittest("matrix", test_matrix), &
         new_unittest("matrix-branches", test_matrix_branches), &
         new_unittest("check-rotation", test_check_rotation), &
         new_unittest("nearest-rotation", test_nearest), &
         new_unittest("nearest-rotation-refusals", test_nearest_refusals), &
         new_unittest("axis-angle", test_axis_angle), &
         new_unittest("rotation-vector", test_rotation_vector), &
         new_unittest("cayley", test_cayley), &
         new_unittest("euler", test_euler), &
         new_unittest("small-nutation", test_small_nutation), &
         new_unittest("gimbal-lock", test_gimbal_lock), &
         new_unittest("euler-refusals", test_euler_refusals), &
         new_unittest("review-u-v-a", test_review), &
         new_unittest("review-flows", test_review_flows), &
         new_unittest("philox-known-answers", test_philox), &
         new_unittest("random-keys", test_random_keys), &
         new_unittest("random-distributions", test_distributions)]
   end subroutine collect_rotation

   !> A vector with components spread over (-1, 1).
   pure function some_vector(id) result(v)
      integer(i8), intent(in) :: id
      real(dp) :: v(3)
      real(dp) :: u(4)
      u(1:2) = random_uniform(seed, id, 1_i8, 100_i4)
      u(3:4) = random_uniform(seed, id, 1_i8, 101_i4)
      v = 2*u(1:3) - 1
   end function some_vector

   !> A quaternion that is not unit.
   pure function some_quaternion(id) result(q)
      integer(i8), intent(in) :: id
      real(dp) :: q(4)
      q = [some_vector(id + 1000000_i8), sum(some_vector(id + 2000000_i8))]
   end function some_quaternion

   !> Length of the difference of two quaternions or vectors.
   pure real(dp) function apart(a, b)
      real(dp), intent(in) :: a(:), b(:)
      apart = maxval(abs(a - b))
   end function apart

   pure real(dp) function matrix_apart(a, b)
      real(dp), intent(in) :: a(3, 3), b(3, 3)
      matrix_apart = maxval(abs(a - b))
   end function matrix_apart

   subroutine test_hat(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: a(3), b(3), m(3, 3), worst
      integer(i8) :: k
      worst = 0
      do k = 1, trials
         a = some_vector(k)
         b = some_vector(-k)
         m = hat(a) + 0.7_dp*matmul(hat(b), hat(b)) ! a symmetric part, to be ignored
         worst = max(worst, apart(matmul(hat(a), b), cross(a, b)), apart(vee(m), a), &
            matrix_apart(hat(rot(m)), m - transpose(m)), abs(dot_product(cross(a, b), a)))
      end do
      call within(error, worst, 4*eps, "hat, vee, rot, cross")
      call expect(error, all(cross([1._dp, 0._dp, 0._dp], [0._dp, 1._dp, 0._dp]) > &
         [-.5_dp, -.5_dp, .5_dp]), "e1 x e2 is not e3")
      call within(error, determinant(reshape([2._dp, 0._dp, 1._dp, 0._dp, 3._dp, 0._dp, 0._dp, &
         0._dp, 4._dp], [3, 3])) - 24, 0._dp, "determinant")
   end subroutine test_hat

   subroutine test_vector_scales(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: scales(7) = [1e-300_dp, 1e-200_dp, 1e-46_dp, 1._dp, 1e139_dp, &
         1e200_dp, 1e300_dp]
      integer :: i
      do i = 1, size(scales)
         call within(error, vector_norm(scales(i)*[3._dp, -4._dp, 12._dp])/scales(i) - 13, 20*eps, &
            "length at some scale")
         call within(error, apart(unit_vector(scales(i)*[2._dp, -3._dp, 6._dp]), &
            [2._dp, -3._dp, 6._dp]/7), 2*eps, "unit vector at some scale")
      end do
      call within(error, vector_norm([0._dp, 0._dp, 0._dp]), 0._dp, "length of zero")
      call within(error, maxval(abs(unit_vector([0._dp, 0._dp]))), 0._dp, "unit vector of zero")
      call expect(error, largest_exponent([0.3_dp, -5._dp]) == 3, "exponent of 5 is not 3")
      call expect(error, largest_exponent([0._dp]) == 0, "exponent of zero is not 0")
   end subroutine test_vector_scales

   subroutine test_perpendicular(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: a(3), p(3), worst
      integer(i8) :: k
      worst = 0
      do k = 1, trials
         a = 10._dp**mod(k, 200_i8)*random_direction(seed, k)
         if (k <= 9) a = identity_matrix(:, 1 + mod(k, 3_i8)) + 1e-20_dp*(k/4) ! on or near an axis
         p = perpendicular(a)
         worst = max(worst, abs(dot_product(unit_vector(a), p)), abs(vector_norm(p) - 1))
      end do
      call within(error, worst, 4*eps, "perpendicular")
      call within(error, vector_norm(perpendicular([0._dp, 0._dp, 0._dp])) - 1, 0._dp, "of zero")
   end subroutine test_perpendicular

   subroutine test_angle_between(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: angles(6) = [0._dp, 1e-150_dp, 1e-9_dp, 1._dp, 3._dp, pi]
      integer :: i
      do i = 1, size(angles)
         call within(error, angle_between([1e-40_dp, 0._dp, 0._dp], 1e30_dp*[cos(angles(i)), &
            sin(angles(i)), 0._dp]) - angles(i), 4*eps*angles(i), "angle between")
      end do
      call within(error, angle_between([0._dp, 0._dp, 0._dp], [1._dp, 0._dp, 0._dp]), 0._dp, "zero")
   end subroutine test_angle_between

   !> i o j = k and its cycle, squares -1: the table of Hamilton.
   subroutine test_units(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: unit(4, 0:3)
      integer :: a, b, c
      unit = 0
      do a = 0, 3
         unit(a + 1, a) = 1
      end do
      do a = 1, 3
         b = modulo(a, 3) + 1
         c = modulo(b, 3) + 1
         call within(error, apart(quaternion_product(unit(:, a), unit(:, b)), unit(:, c)), &
                     0._dp, "i j = k")
         call within(error, apart(quaternion_product(unit(:, b), unit(:, a)), -unit(:, c)), &
                     0._dp, "j i = -k")
         call within(error, apart(quaternion_product(unit(:, a), unit(:, a)), -unit(:, 0)), &
                     0._dp, "i i = -1")
      end do
      call within(error, apart(unit(:, 0), identity_quaternion), 0._dp, "identity")
   end subroutine test_units

   subroutine test_algebra(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: p(4), q(4), r(4), worst(5)
      integer(i8) :: k
      worst = 0
      do k = 1, trials
         p = some_quaternion(k)
         q = some_quaternion(k + trials)
         r = some_quaternion(k + 2*trials)
         worst(1) = max(worst(1), apart(quaternion_product(quaternion_product(p, q), r), &
            quaternion_product(p, quaternion_product(q, r))))
         worst(2) = max(worst(2), apart(quaternion_conjugate(quaternion_product(p, q)), &
            quaternion_product(quaternion_conjugate(q), quaternion_conjugate(p))))
         worst(3) = max(worst(3), abs(quaternion_norm(quaternion_product(p, q)) - &
            quaternion_norm(p)*quaternion_norm(q)))
         worst(4) = max(worst(4), apart(quaternion_product(p, quaternion_inverse(p)), &
            identity_quaternion), apart(quaternion_product(quaternion_inverse(p), p), &
            identity_quaternion))
         worst(5) = max(worst(5), abs(quaternion_norm(normalise(p)) - 1), &
            apart(normalise(p)*quaternion_norm(p), p))
      end do
      call within(error, worst(1), 100*eps, "(p q) r = p (q r)")
      call within(error, worst(2), 10*eps, "conjugate of a product")
      call within(error, worst(3), 20*eps, "norm of a product")
      call within(error, worst(4), 4*eps, "inverse")
      call within(error, worst(5), 8*eps, "normalise")
   end subroutine test_algebra

   subroutine test_quaternion_scales(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: q(4) = [1._dp, -2._dp, 4._dp, 10._dp], zero(4) = 0
      real(dp), parameter :: scales(5) = [1e-300_dp, 1e-200_dp, 1._dp, 1e200_dp, 1e300_dp]
      integer :: i
      do i = 1, size(scales)
         call within(error, quaternion_norm(scales(i)*q)/scales(i) - 11, 20*eps, "norm")
         call within(error, apart(normalise(scales(i)*q), q/11), 2*eps, "normalise")
         call within(error, apart(scales(i)*quaternion_inverse(scales(i)*q), &
            quaternion_conjugate(q)/121), 4*eps, "inverse")
      end do
      call within(error, quaternion_norm(zero), 0._dp, "norm of zero")
      call within(error, apart(quaternion_inverse(zero), zero), 0._dp, "inverse of zero")
      call within(error, apart(normalise(zero), identity_quaternion), 0._dp, "normalise zero")
   end subroutine test_quaternion_scales

   subroutine test_rotate(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: p(4), q(4), v(3), w(4), worst(4)
      integer(i8) :: k
      worst = 0
      do k = 1, trials
         q = random_quaternion(seed, k)
         p = random_quaternion(seed, -k)
         v = some_vector(k)
         w = quaternion_product(quaternion_product(q, [0._dp, v]), quaternion_conjugate(q))
         worst(1) = max(worst(1), apart(rotate(q, v), w(2:4)))
         worst(2) = max(worst(2), apart(rotate_back(q, rotate(q, v)), v), &
            apart(rotate_back(q, v), matmul(transpose(to_matrix(q)), v)))
         worst(3) = max(worst(3), abs(vector_norm(rotate(q, v)) - vector_norm(v)))
         worst(4) = max(worst(4), apart(rotate(quaternion_product(p, q), v), &
            rotate(p, rotate(q, v))))
      end do
      call within(error, worst(1), 10*eps, "rotate is q v conjugate(q)")
      call within(error, worst(2), 10*eps, "rotate_back")
      call within(error, worst(3), 10*eps, "rotate keeps lengths")
      call within(error, worst(4), 20*eps, "product = first right, then left")
      call within(error, apart(rotate([sqrt(.5_dp), 0._dp, 0._dp, sqrt(.5_dp)], &
         [1e-46_dp, 0._dp, 0._dp])/1e-46_dp, [0._dp, 1._dp, 0._dp]), 4*eps, &
         "a quarter turn about axis 3 takes e1 to e2")
   end subroutine test_rotate

   subroutine test_exp_log(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: q(4), worst(2)
      integer(i8) :: k
      worst = 0
      do k = 1, trials
         q = some_quaternion(k)
         worst(1) = max(worst(1), apart(quaternion_exp(quaternion_log(q)), q))
         q(2:4) = 3.1_dp*random_uniform_one(k)*random_direction(seed, k) ! shorter than pi
         worst(2) = max(worst(2), apart(quaternion_log(quaternion_exp(q)), q))
      end do
      call within(error, worst(1), 16*eps, "exp(log(q)) = q")
      call within(error, worst(2), 16*eps, "log(exp(q)) = q")
      call within(error, apart(quaternion_exp([0._dp, 0._dp, 0._dp, 0._dp]), &
         identity_quaternion), 0._dp, "exp(0) = 1")
      call within(error, apart(quaternion_exp([log(2._dp), 0._dp, pi/2, 0._dp]), &
         [0._dp, 0._dp, 2._dp, 0._dp]), 4*eps, "exp(log 2 + j pi/2) = 2 j")
      call within(error, apart(quaternion_log([-1._dp, 0._dp, 0._dp, 0._dp]), &
         [0._dp, pi, 0._dp, 0._dp]), 0._dp, "log(-1) = i pi")
      call within(error, apart(quaternion_log([1._dp, 1e-300_dp, 0._dp, 0._dp])*1e300_dp, &
         [0._dp, 1._dp, 0._dp, 0._dp]), 4*eps, "log next to 1")
      q = quaternion_log([0._dp, 0._dp, 0._dp, 0._dp])
      call expect(error, q(1) < -1e300_dp .and. maxval(abs(q(2:4))) <= 0, "log(0)")
   end subroutine test_exp_log

   !> One uniform number.
   pure real(dp) function random_uniform_one(id)
      integer(i8), intent(in) :: id
      real(dp) :: u(2)
      u = random_uniform(seed, id, 2_i8, 102_i4)
      random_uniform_one = u(1)
   end function random_uniform_one

   subroutine test_check_quaternion(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: nan
      nan = ieee_value(nan, ieee_quiet_nan)
      call check_quaternion([.5_dp, -.5_dp, .5_dp, .5_dp], refusal)
      call accepted(error, refusal)
      call check_quaternion([1 + .99e-6_dp, 0._dp, 0._dp, 0._dp], refusal)
      call accepted(error, refusal)
      call check_quaternion([1 - 1.01e-6_dp, 0._dp, 0._dp, 0._dp], refusal)
      call refused(error, refusal, poinsot_e_domain, "norm")
      call check_quaternion([0._dp, 0._dp, 0._dp, 0._dp], refusal)
      call refused(error, refusal, poinsot_e_domain, "norm")
      call check_quaternion([1e300_dp, 1e300_dp, 0._dp, 0._dp], refusal)
      call refused(error, refusal, poinsot_e_domain, "norm")
      call check_quaternion([1._dp, nan, 0._dp, 0._dp], refusal)
      call refused(error, refusal, poinsot_e_domain, "not finite")
   end subroutine test_check_quaternion

   subroutine test_slerp(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: p(4), q(4), r(4), t, worst(4)
      integer(i8) :: k
      worst = 0
      do k = 1, trials
         p = random_quaternion(seed, k)
         q = random_quaternion(seed, k + trials)
         if (mod(k, 3_i8) == 0) q = quaternion_product(p, quaternion_a(1e-9_dp*some_vector(k)))
         t = random_uniform_one(k)
         r = slerp(p, q, t)
         worst(1) = max(worst(1), attitude_distance(slerp(p, q, 0._dp), p), &
            attitude_distance(slerp(p, q, 1._dp), q))
         worst(2) = max(worst(2), abs(attitude_angle(p, r) - t*attitude_angle(p, q)), &
            abs(attitude_angle(r, q) - (1 - t)*attitude_angle(p, q)))
         worst(3) = max(worst(3), apart(slerp(p, -q, t), r))
         worst(4) = max(worst(4), abs(quaternion_norm(r) - 1))
      end do
      call within(error, worst(1), 4*eps, "slerp at its ends")
      call within(error, worst(2), 20*eps, "slerp turns at a constant rate")
      call within(error, worst(3), 4*eps, "slerp does not see the sign of q")
      call within(error, worst(4), 4*eps, "slerp is unit")
      call within(error, attitude_distance(slerp(identity_quaternion, quaternion_u(-1._dp), &
         2._dp), quaternion_u(-2._dp)), 4*eps, "slerp beyond its ends")
      do k = 1, 15 ! ends 10**-k apart, far beyond them
         t = 10._dp**k
         call within(error, attitude_distance(slerp(identity_quaternion, quaternion_u(-1/t), t), &
            quaternion_u(-1._dp)), 4*eps, "slerp far beyond near ends")
         call within(error, attitude_distance(slerp(identity_quaternion, quaternion_u(-1/t), &
            -2.5_dp*t), quaternion_u(2.5_dp)), 8*eps, "slerp far before near ends")
      end do
   end subroutine test_slerp

   subroutine test_shortest_arc(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: a(3), b(3), q(4), worst(3)
      real(dp), parameter :: zero(3) = 0
      integer(i8) :: k
      worst = 0
      do k = 1, trials
         a = random_direction(seed, k)
         b = random_direction(seed, k + trials)
         if (mod(k, 2_i8) == 0) b = -a + 10._dp**(-mod(k, 40_i8)/2)*some_vector(k) ! nearly opposite
         call shortest_arc(1e-200_dp*a, 1e200_dp*b, q, refusal)
         b = unit_vector(b)
         worst(1) = max(worst(1), apart(rotate(q, a), b), abs(quaternion_norm(q) - 1))
         worst(2) = max(worst(2), abs(2*atan2(vector_norm(q(2:4)), q(1)) - angle_between(a, b)))
         worst(3) = max(worst(3), abs(dot_product(q(2:4), a)))
      end do
      call accepted(error, refusal)
      call within(error, worst(1), 8*eps, "shortest arc takes a to b")
      call within(error, worst(2), 8*eps, "shortest arc has the least angle")
      call within(error, worst(3), 8*eps, "shortest arc turns about a normal")
      call shortest_arc([0._dp, 0._dp, 2._dp], [0._dp, 0._dp, -3._dp], q, refusal)
      call within(error, apart(rotate(q, [0._dp, 0._dp, 1._dp]), [0._dp, 0._dp, -1._dp]), 4*eps, &
         "opposite directions")
      call shortest_arc(a, a, q, refusal)
      call within(error, apart(q, identity_quaternion), eps, "equal directions")
      call shortest_arc(zero, a, q, refusal)
      call refused(error, refusal, poinsot_e_domain, "zero vector")
      call shortest_arc(a, [1._dp, ieee_value(1._dp, ieee_positive_inf), 0._dp], q, refusal)
      call refused(error, refusal, poinsot_e_domain, "not finite")
   end subroutine test_shortest_arc

   subroutine test_distance(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: angles(6) = [0._dp, 1e-100_dp, 1e-10_dp, 1._dp, 3._dp, pi]
      real(dp) :: q(4)
      integer :: i
      do i = 1, size(angles)
         q = quaternion_v(angles(i))
         call within(error, attitude_angle(identity_quaternion, -q) - angles(i), &
            4*eps*angles(i), "angle")
         call within(error, attitude_distance(q, identity_quaternion) - 2*sin(angles(i)/4), &
            4*eps, "distance")
      end do
      q = random_quaternion(seed, 7_i8)
      call within(error, attitude_distance(q, -q), 0._dp, "q and -q are the same attitude")
   end subroutine test_distance

   subroutine test_matrix(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: q(4), m(3, 3), worst(4)
      integer(i8) :: k
      worst = 0
      do k = 1, trials
         q = random_quaternion(seed, k)
         m = to_matrix(q)
         worst(1) = max(worst(1), matrix_apart(matmul(transpose(m), m), identity_matrix), &
            abs(determinant(m) - 1))
         worst(2) = max(worst(2), apart(matmul(m, q(2:4)), q(2:4)), &
            apart(matmul(m, [1._dp, 2._dp, 3._dp]), rotate(q, [1._dp, 2._dp, 3._dp])))
         worst(3) = max(worst(3), attitude_distance(from_matrix(m), q))
         q = from_matrix(m)
         worst(4) = max(worst(4), -q(1), matrix_apart(m, matmul(hat(q(2:4)), hat(q(2:4)))*2 + &
            2*q(1)*hat(q(2:4)) + identity_matrix))
      end do
      call within(error, worst(1), 10*eps, "orthogonal, right-handed")
      call within(error, worst(2), 20*eps, "Q v = rotate(q, v)")
      call within(error, worst(3), 4*eps, "from_matrix(to_matrix(q)) = +-q")
      call within(error, worst(4), 10*eps, "the review's |q|^2 + 2 q0 hat(e) + 2 hat(e)^2")
   end subroutine test_matrix

   !> Each of the four branches, half-turns and the places where two components tie.
   subroutine test_matrix_branches(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: q(4)
      integer :: i, j
      do i = 1, 4
         q = 0
         q(i) = 1
         call within(error, apart(from_matrix(to_matrix(q)), q), 0._dp, "a unit")
         do j = i + 1, 4
            q = 0
            q(i) = sqrt(.5_dp)
            q(j) = -sqrt(.5_dp)
            call within(error, apart(from_matrix(to_matrix(q)), q), 4*eps, "two equal components")
            q = 1e-10_dp
            q(i) = 1
            q(j) = 1e-5_dp
            call within(error, attitude_distance(from_matrix(to_matrix(normalise(q))), &
               normalise(q)), 4*eps, "nearly a unit")
         end do
      end do
   end subroutine test_matrix_branches

   subroutine test_check_rotation(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: m(3, 3)
      m = to_matrix(random_quaternion(seed, 3_i8))
      call check_rotation(m + 1e-7_dp, refusal)
      call accepted(error, refusal)
      call check_rotation(m + 1e-5_dp, refusal)
      call refused(error, refusal, poinsot_e_domain, "orthonormal")
      call check_rotation(1e200_dp*m, refusal)
      call refused(error, refusal, poinsot_e_domain, "orthonormal")
      m(:, 2) = -m(:, 2)
      call check_rotation(m, refusal)
      call refused(error, refusal, poinsot_e_domain, "reflection")
      m(1, 1) = ieee_value(1._dp, ieee_quiet_nan)
      call check_rotation(m, refusal)
      call refused(error, refusal, poinsot_e_domain, "not finite")
   end subroutine test_check_rotation

   !> Orthogonal, a fixed point on rotations, and no small turn of it is nearer to the noisy matrix.
   subroutine test_nearest(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: m(3, 3), noisy(3, 3), r(3, 3), turned(3, 3), closer, worst(4)
      integer(i8) :: k
      worst = 0
      do k = 1, 200
         m = to_matrix(random_quaternion(seed, k))
         call nearest_rotation(m, r, refusal)
         worst(1) = max(worst(1), matrix_apart(r, m))
         noisy = m + 0.1_dp*spread(some_vector(k), 1, 3)*spread(some_vector(-k), 2, 3)
         call nearest_rotation(10._dp**(3*k - 300)*noisy, r, refusal)
         worst(2) = max(worst(2), matrix_apart(matmul(transpose(r), r), identity_matrix), &
            abs(determinant(r) - 1))
         worst(3) = max(worst(3), maxval(abs(rot(matmul(transpose(r), noisy))))) ! R^T M symmetric
         turned = matmul(r, matrix_a(1e-3_dp*some_vector(k)))
         closer = sum((turned - noisy)**2) - sum((r - noisy)**2)
         worst(4) = max(worst(4), -closer)
      end do
      call accepted(error, refusal)
      call within(error, worst(1), 16*eps, "nearest to a rotation is itself")
      call within(error, worst(2), 16*eps, "nearest is a rotation")
      call within(error, worst(3), 64*eps, "R^T M is symmetric")
      call within(error, worst(4), 0._dp, "a neighbour is nearer")
      noisy = identity_matrix
      noisy(3, 3) = -0.2_dp ! an improper matrix whose nearest rotation is unique
      call nearest_rotation(noisy, r, refusal)
      call within(error, matrix_apart(r, identity_matrix), 4*eps, "determinant +1 is kept")
   end subroutine test_nearest

   subroutine test_nearest_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: m(3, 3), r(3, 3)
      m = 0
      call nearest_rotation(m, r, refusal)
      call refused(error, refusal, poinsot_e_domain, "no rotation is nearest")
      m = 1
      call nearest_rotation(m, r, refusal)
      call refused(error, refusal, poinsot_e_domain, "no rotation is nearest")
      call nearest_rotation(-identity_matrix, r, refusal)
      call refused(error, refusal, poinsot_e_domain, "no rotation is nearest")
      call within(error, matrix_apart(r, identity_matrix), 0._dp, "left as the identity")
      m(2, 3) = ieee_value(1._dp, ieee_quiet_nan)
      call nearest_rotation(m, r, refusal)
      call refused(error, refusal, poinsot_e_domain, "not finite")
   end subroutine test_nearest_refusals

   subroutine test_axis_angle(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp), parameter :: zero(3) = 0
      real(dp) :: axis(3), n(3), angle, phi, q(4), worst
      integer(i8) :: k
      worst = 0
      do k = 1, trials
         n = random_direction(seed, k)
         phi = pi*random_uniform_one(k)
         call from_axis_angle(10._dp**mod(k, 300_i8)*n, phi, q, refusal)
         call to_axis_angle(-q, axis, angle)
         worst = max(worst, apart(axis, n)*sin(phi/2), abs(angle - phi), &
            apart(rotate(q, n), n), attitude_distance(q, quaternion_a(phi*n)))
      end do
      call accepted(error, refusal)
      call within(error, worst, 8*eps, "axis and angle there and back")
      call from_axis_angle([0._dp, 0._dp, 5._dp], pi/2, q, refusal)
      call within(error, apart(rotate(q, [1._dp, 0._dp, 0._dp]), [0._dp, 1._dp, 0._dp]), 4*eps, &
         "right-handed")
      call to_axis_angle(-identity_quaternion, axis, angle)
      call within(error, abs(angle) + apart(axis, [1._dp, 0._dp, 0._dp]), 0._dp, "of the identity")
      call from_axis_angle(zero, 1._dp, q, refusal)
      call refused(error, refusal, poinsot_e_domain, "axis is zero")
      call from_axis_angle(n, ieee_value(1._dp, ieee_positive_inf), q, refusal)
      call refused(error, refusal, poinsot_e_domain, "not finite")
   end subroutine test_axis_angle

   subroutine test_rotation_vector(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: w(3), worst, tiny_worst
      integer(i8) :: k
      worst = 0
      tiny_worst = 0
      do k = 1, trials
         w = pi*random_uniform_one(k)*random_direction(seed, k)
         worst = max(worst, apart(to_rotation_vector(-quaternion_a(w)), w))
         w = 10._dp**(-mod(k, 290_i8))*random_direction(seed, k)
         tiny_worst = max(tiny_worst, &
            apart(to_rotation_vector(quaternion_a(w)), w)/maxval(abs(w)))
      end do
      call within(error, worst, 8*eps, "rotation vector there and back")
      call within(error, tiny_worst, 8*eps, "tiny ones, relative to their length")
   end subroutine test_rotation_vector

   subroutine test_cayley(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: e(3), v(3), q(4), m(3, 3), worst(2)
      integer(i8) :: k
      worst = 0
      do k = 1, trials
         v = 10._dp**(mod(k, 400_i8) - 200)*some_vector(k)
         q = from_cayley(v)
         call to_cayley(-q, e, refusal)
         worst(1) = max(worst(1), apart(e, v)/maxval(abs(v)), abs(quaternion_norm(q) - 1))
         v = some_vector(k)
         m = to_matrix(from_cayley(v)) ! (1 + hat(v)) = Q (1 - hat(v))
         worst(2) = max(worst(2), matrix_apart(matmul(m, identity_matrix - hat(v)), &
            identity_matrix + hat(v)))
      end do
      call accepted(error, refusal)
      call within(error, worst(1), 8*eps, "Cayley vector there and back")
      call within(error, worst(2), 16*eps, "Q = (1 + hat(e)) (1 - hat(e))^-1")
      call to_cayley([0._dp, 1._dp, 0._dp, 0._dp], e, refusal)
      call refused(error, refusal, poinsot_e_domain, "half-turn")
      call to_cayley([1e-310_dp, 1._dp, 0._dp, 0._dp], e, refusal)
      call refused(error, refusal, poinsot_e_domain, "half-turn")
   end subroutine test_cayley

   !> Turn by an angle about axis k, straight from the definition.
   pure function turn(k, angle) result(q)
      integer, intent(in) :: k
      real(dp), intent(in) :: angle
      real(dp) :: q(4)
      q = 0
      q(1) = cos(angle/2)
      q(1 + k) = sin(angle/2)
   end function turn

   !> Angles of all twelve conventions make the product of three turns, and come back.
   subroutine test_euler(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: a(3), b(3), q(4), worst(3), size_of_lever
      integer(i8) :: k
      integer :: c, axes(3)
      do c = 1, 12
         axes = [(index("xyz", conventions(c)(k:k)), k=1, 3)]
         worst = 0
         do k = 1, trials
            a = pi*some_vector(k)*[1._dp, .49_dp, 1._dp]
            size_of_lever = cos(a(2))
            if (axes(1) == axes(3)) a(2) = pi*random_uniform_one(k)
            if (axes(1) == axes(3)) size_of_lever = sin(a(2))
            call from_euler(conventions(c), a, q, refusal)
            worst(1) = max(worst(1), apart(q, quaternion_product(turn(axes(1), a(1)), &
               quaternion_product(turn(axes(2), a(2)), turn(axes(3), a(3))))))
            call to_euler(conventions(c), -q, b, refusal)
            worst(2) = max(worst(2), apart(b, a)*size_of_lever)
            q = random_quaternion(seed, k)
            call to_euler(conventions(c), q, b, refusal)
            worst(3) = max(worst(3), attitude_distance(attitude_of_euler(axes, b), q))
         end do
         call within(error, worst(1), 4*eps, conventions(c)//": the product of three turns")
         call within(error, worst(2), 16*eps, conventions(c)//": angles there and back")
         call within(error, worst(3), 8*eps, conventions(c)//": attitude there and back")
      end do
      call accepted(error, refusal)
   end subroutine test_euler

   !> A small second angle of a symmetric convention keeps its digits.
   subroutine test_small_nutation(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: b(3), worst, nutation
      integer :: k
      worst = 0
      do k = 0, 13
         nutation = 10._dp**(-k)
         b = euler_of_attitude([3, 1, 3], attitude_of_euler([3, 1, 3], [.3_dp, nutation, .4_dp]))
         worst = max(worst, abs(b(2)/nutation - 1))
      end do
      call within(error, worst, 16*eps, "small nutation keeps its digits")
   end subroutine test_small_nutation

   !> In the lock the last angle is zero and the attitude comes back.
   subroutine test_gimbal_lock(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: a(3), b(3), q(4), worst, last
      integer(i8) :: k
      integer :: c, axes(3)
      worst = 0
      last = 0
      do c = 1, 12
         axes = euler_axes(conventions(c))
         do k = 1, trials/10
            a = pi*some_vector(k)
            a(2) = sign(pi/2, a(2))
            if (axes(1) == axes(3)) a(2) = merge(0._dp, pi, a(2) > 0)
            q = attitude_of_euler(axes, a)
            b = euler_of_attitude(axes, q)
            worst = max(worst, attitude_distance(attitude_of_euler(axes, b), q))
            last = max(last, abs(b(3)))
         end do
      end do
      call within(error, worst, 8*eps, "attitude in gimbal lock there and back")
      call within(error, last, 0._dp, "the third angle in gimbal lock")
   end subroutine test_gimbal_lock

   subroutine test_euler_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: bad(7) = [character(6) :: "", "zx", "ZXZ", "zzx", "xyy", "xyw", &
         "zxz-zx"]
      type(poinsot_error) :: refusal
      real(dp) :: q(4), a(3)
      integer :: i
      do i = 1, size(bad)
         call from_euler(trim(bad(i)), [0._dp, 0._dp, 0._dp], q, refusal)
         call refused(error, refusal, poinsot_e_method, "from_euler: unknown convention")
         call to_euler(trim(bad(i)), identity_quaternion, a, refusal)
         call refused(error, refusal, poinsot_e_method, "to_euler: unknown convention")
      end do
      call from_euler("zxz", [0._dp, ieee_value(q(1), ieee_quiet_nan), 0._dp], q, refusal)
      call refused(error, refusal, poinsot_e_domain, "not finite")
   end subroutine test_euler_refusals

   !> u, v, a stand for U, V, exp(hat), which are what the review prints.
   subroutine test_review(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: theta, w(3), series(3, 3), power(3, 3), worst(3)
      integer(i8) :: k
      integer :: j
      worst = 0
      do k = 1, trials
         theta = 10*some_angle(k)
         worst(1) = max(worst(1), matrix_apart(to_matrix(quaternion_u(theta)), matrix_u(theta)))
         worst(2) = max(worst(2), matrix_apart(to_matrix(quaternion_v(theta)), matrix_v(theta)))
         w = some_vector(k)
         series = identity_matrix
         power = identity_matrix
         do j = 1, 25
            power = matmul(power, hat(w))/j
            series = series + power
         end do
         worst(3) = max(worst(3), matrix_apart(matrix_a(w), series))
      end do
      call within(error, worst(1), 8*eps, "u(theta) stands for U(theta)")
      call within(error, worst(2), 8*eps, "v(theta) stands for V(theta)")
      call within(error, worst(3), 16*eps, "a(omega) stands for exp(hat(omega))")
      w = matmul(matrix_u(.3_dp), [0._dp, 1._dp, 0._dp])
      call within(error, apart(w, [0._dp, cos(.3_dp), -sin(.3_dp)]), 0._dp, "U as printed")
      w = matmul(matrix_v(.3_dp), [1._dp, 0._dp, 0._dp])
      call within(error, apart(w, [cos(.3_dp), -sin(.3_dp), 0._dp]), 0._dp, "V as printed")
      call within(error, apart(quaternion_a([0._dp, 0._dp, 0._dp]), identity_quaternion), 0._dp, &
         "a(0) = 1")
   end subroutine test_review

   pure real(dp) function some_angle(id)
      integer(i8), intent(in) :: id
      some_angle = 2*random_uniform_one(id) - 1
   end function some_angle

   !> The flows of Algorithm 2 with its misprints put right solve their equations: the space
   !> momentum q y stays, and a short step agrees with y' = y x grad, q' = q o grad/2.
   subroutine test_review_flows(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: inertia(3) = [.6_dp, .8_dp, 1._dp], y(3) = [1.8_dp, .4_dp, -.9_dp]
      real(dp), parameter :: t = 1e-6_dp
      real(dp) :: angle, turn_y(3, 3), y_end(3), q_end(4), grad(3)
      angle = (1/inertia(1) - 1/inertia(2))*y(1)*t
      turn_y = matrix_u(angle)
      y_end = matmul(turn_y, y)
      q_end = quaternion_u(-angle)
      grad = [angle/t, 0._dp, 0._dp]
      call within(error, apart(rotate(q_end, y_end), y), 8*eps, "flow R keeps Q y")
      call within(error, apart(y_end, y + t*cross(y, grad)), 1e-11_dp, "flow R turns y")
      call within(error, apart(q_end, [1._dp, t*grad/2]), 1e-11_dp, "flow R turns q")
      angle = (1/inertia(3) - 1/inertia(2))*y(3)*t
      turn_y = matrix_v(angle)
      y_end = matmul(turn_y, y)
      q_end = quaternion_product(quaternion_a(t*y/inertia(2)), quaternion_v(-angle))
      grad = y/inertia([2, 2, 3])
      call within(error, apart(rotate(q_end, y_end), y), 8*eps, "flow S keeps Q y")
      call within(error, apart(y_end, y + t*cross(y, grad)), 1e-11_dp, "flow S turns y")
      call within(error, apart(q_end, [1._dp, t*grad/2]), 1e-11_dp, "flow S turns q")
   end subroutine test_review_flows

   !> The vectors published with the generator (Salmon and others 2011): zeros, ones, digits of pi.
   subroutine test_philox(error)
      type(error_type), allocatable, intent(out) :: error
      integer(i8), parameter :: ones = int(z"FFFFFFFF", i8)
      integer(i8) :: w(4)
      call philox4x32(0_i8, 0_i8, 0_i8, 0_i8, 0_i8, 0_i8, w(1), w(2), w(3), w(4))
      call expect(error, all(w == [int(z"6627E8D5", i8), int(z"E169C58D", i8), &
         int(z"BC57AC4C", i8), int(z"9B00DBD8", i8)]), "zeros")
      call philox4x32(ones, ones, ones, ones, ones, ones, w(1), w(2), w(3), w(4))
      call expect(error, all(w == [int(z"408F276D", i8), int(z"41C83B0E", i8), &
         int(z"A20BC7C6", i8), int(z"6D5451FD", i8)]), "ones")
      call philox4x32(int(z"243F6A88", i8), int(z"85A308D3", i8), int(z"13198A2E", i8), &
         int(z"03707344", i8), int(z"A4093822", i8), int(z"299F31D0", i8), w(1), w(2), w(3), w(4))
      call expect(error, all(w == [int(z"D16CFE09", i8), int(z"94FDCCEB", i8), &
         int(z"5001E420", i8), int(z"24126EA1", i8)]), "digits of pi")
      ! the same ones through (seed, id, step, stream): -1 is all ones
      call random_words(-1_i8, -1_i8, -1_i8, -1_i4, w(1), w(2), w(3), w(4))
      call expect(error, w(1) == int(z"408F276D", i8), "seed, id, step, stream all ones")
      ! least word of each first: id is words 1 and 2, step and stream words 3 and 4, seed the key
      call random_words(int(z"299F31D0A4093822", i8), ieor(ishft(int(z"85A308D3", i8), 32), &
         int(z"243F6A88", i8)), int(z"734413198A2E", i8), int(z"0370", i4), w(1), w(2), w(3), w(4))
      call expect(error, w(1) == int(z"D16CFE09", i8), "seed, id, step, stream from digits of pi")
   end subroutine test_philox

   !> The same key gives the same number; any other seed, id, step or stream another one.
   subroutine test_random_keys(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: u(2, 7), low, high
      integer :: i, j
      u(:, 1) = random_uniform(1_i8, 2_i8, 3_i8, 4_i4)
      u(:, 2) = random_uniform(2_i8, 2_i8, 3_i8, 4_i4)
      u(:, 3) = random_uniform(1_i8, 3_i8, 3_i8, 4_i4)
      u(:, 4) = random_uniform(1_i8, 2_i8, 4_i8, 4_i4)
      u(:, 5) = random_uniform(1_i8, 2_i8, 3_i8, 5_i4)
      u(:, 6) = random_uniform(1_i8, 2_i8 + 2_i8**40, 3_i8, 4_i4)
      u(:, 7) = random_uniform(1_i8, 2_i8, 3_i8 + 2_i8**40, 4_i4)
      call within(error, apart(u(:, 1), random_uniform(1_i8, 2_i8, 3_i8, 4_i4)), 0._dp, "same key")
      do i = 1, 7
         do j = 1, i - 1
            call expect(error, minval(abs(u(:, i) - u(:, j))) > 0, "two keys, one number")
         end do
         call expect(error, abs(u(1, i) - u(2, i)) > 0, "both numbers of a pair are equal")
      end do
      low = uniform_from_words(0_i8, 0_i8)
      high = uniform_from_words(int(z"FFFFFFFF", i8), int(z"FFFFFFFF", i8))
      call expect(error, low > 0 .and. high < 1, "0 or 1 comes out")
      call within(error, low + high - 1, 0._dp, "the range is not symmetric")
   end subroutine test_random_keys

   !> Moments of 20000 draws, to five standard deviations of their means.
   subroutine test_distributions(error)
      type(error_type), allocatable, intent(out) :: error
      integer(i8), parameter :: draws = 20000
      real(dp) :: mean(2), square(2), u(2), g(2), q(4), v(3), qq(4, 4), vv(3, 3), spread_of_mean
      real(dp) :: kurtosis, unit_off
      integer(i8) :: k
      integer :: i
      mean = 0; square = 0; kurtosis = 0; qq = 0; vv = 0; unit_off = 0
      do k = 1, draws
         u = random_uniform(seed, k, 0_i8, 200_i4)
         g = random_gaussian(seed, k, 0_i8, 201_i4)
         q = random_quaternion(seed, k)
         v = random_direction(seed, k)
         mean = mean + [sum(u)/2, sum(g)/2]/draws
         square = square + [sum(u**2)/2, sum(g**2)/2]/draws
         kurtosis = kurtosis + sum(g**4)/2/draws
         qq = qq + spread(q, 1, 4)*spread(q, 2, 4)/draws
         vv = vv + spread(v, 1, 3)*spread(v, 2, 3)/draws
         unit_off = max(unit_off, abs(quaternion_norm(q) - 1), abs(vector_norm(v) - 1))
      end do
      spread_of_mean = 5/sqrt(2*real(draws, dp))
      call within(error, mean(1) - .5_dp, spread_of_mean*sqrt(1/12._dp), "mean of uniform")
      call within(error, square(1) - 1/3._dp, spread_of_mean*sqrt(4/45._dp), "square of uniform")
      call within(error, mean(2), spread_of_mean, "mean of normal")
      call within(error, square(2) - 1, spread_of_mean*sqrt(2._dp), "variance of normal")
      call within(error, kurtosis - 3, spread_of_mean*sqrt(96._dp), "fourth moment of normal")
      vv = vv - identity_matrix/3
      do i = 1, 4
         qq(i, i) = qq(i, i) - .25_dp
      end do
      call within(error, maxval(abs(qq)), 5*sqrt(1/16._dp/draws), "attitudes are not uniform")
      call within(error, maxval(abs(vv)), 5*sqrt(4/45._dp/draws), "directions are not uniform")
      call within(error, unit_off, 4*eps, "not unit")
   end subroutine test_distributions

end module test_rotation
