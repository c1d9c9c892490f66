!> An attitude in other clothes: rotation matrix, axis and angle, rotation vector, Cayley vector,
!> Euler angles.
!>
!> `from_...` makes a unit quaternion, `to_...` reads one. Where a sign is free, the scalar part
!> comes out not negative. What has no answer is refused; an attitude whose axis or angle is free
!> (identity, gimbal lock) gets a fixed choice.
module poinsot_rotation_conversions
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_e_domain
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_rotation_vector, only: vector_norm, unit_vector
   use poinsot_rotation_quaternion, only: identity_quaternion, normalise
   implicit none(type, external)
   private
   public :: to_matrix, from_matrix
   public :: from_axis_angle, to_axis_angle, to_rotation_vector, from_cayley, to_cayley
   public :: from_euler_zyx, to_euler_zyx, from_euler_zxz, to_euler_zxz

   real(dp), parameter :: pi = acos(-1._dp)

   !> Below this sine of half the angle, what distinguishes the first from the third Euler angle is
   !> rounding noise.
   real(dp), parameter :: lock_tolerance = 8*epsilon(1._dp)

contains

   !> Rotation matrix, body to space: Q = |q|^2 + 2 q0 hat(e) + 2 hat(e)^2 (Vilmart's review). Its
   !> columns are the body axes seen in space.
   pure function to_matrix(q) result(matrix)
      real(dp), intent(in) :: q(4) !! attitude, unit
      real(dp) :: matrix(3, 3)
      real(dp) :: s(4)
      s = q**2
      matrix(1, 1) = s(1) + s(2) - s(3) - s(4)
      matrix(2, 2) = s(1) - s(2) + s(3) - s(4)
      matrix(3, 3) = s(1) - s(2) - s(3) + s(4)
      matrix(2, 1) = 2*(q(2)*q(3) + q(1)*q(4))
      matrix(1, 2) = 2*(q(2)*q(3) - q(1)*q(4))
      matrix(1, 3) = 2*(q(4)*q(2) + q(1)*q(3))
      matrix(3, 1) = 2*(q(4)*q(2) - q(1)*q(3))
      matrix(3, 2) = 2*(q(3)*q(4) + q(1)*q(2))
      matrix(2, 3) = 2*(q(3)*q(4) - q(1)*q(2))
   end function to_matrix

   !> Quaternion of a rotation matrix, scalar part not negative. Divides by the largest of the four
   !> components, so no rotation is a bad case (S. W. Shepperd, J. Guidance and Control 1, 223,
   !> 1978). A noisy matrix goes through `nearest_rotation` first, an unknown one through
   !> `check_rotation`.
   pure function from_matrix(matrix) result(q)
      real(dp), intent(in) :: matrix(3, 3) !! rotation matrix, body to space
      real(dp) :: q(4)
      real(dp) :: trace, four_q
      integer :: i, j, k
      trace = matrix(1, 1) + matrix(2, 2) + matrix(3, 3)
      i = maxloc([matrix(1, 1), matrix(2, 2), matrix(3, 3)], dim=1)
      if (trace >= matrix(i, i)) then
         four_q = 2*sqrt(1 + trace)
         q(1) = four_q/4
         q(2) = (matrix(3, 2) - matrix(2, 3))/four_q
         q(3) = (matrix(1, 3) - matrix(3, 1))/four_q
         q(4) = (matrix(2, 1) - matrix(1, 2))/four_q
      else
         j = modulo(i, 3) + 1
         k = modulo(j, 3) + 1
         four_q = 2*sqrt(1 + matrix(i, i) - matrix(j, j) - matrix(k, k))
         q(1 + i) = four_q/4
         q(1) = (matrix(k, j) - matrix(j, k))/four_q
         q(1 + j) = (matrix(i, j) + matrix(j, i))/four_q
         q(1 + k) = (matrix(k, i) + matrix(i, k))/four_q
      end if
      q = scalar_positive(normalise(q))
   end function from_matrix

   !> The attitude turned by an angle about an axis.
   pure subroutine from_axis_angle(axis, angle, q, error)
      real(dp), intent(in) :: axis(3)             !! direction, any length but zero
      real(dp), intent(in) :: angle               !! radians, any; right-handed
      real(dp), intent(out) :: q(4)               !! unit; scalar part cos(angle/2), of either sign
      type(poinsot_error), intent(inout) :: error !! poinsot_e_domain: zero axis, or not finite
      q = identity_quaternion
      if (.not. (all(ieee_is_finite(axis)) .and. ieee_is_finite(angle))) then
         call raise(error, poinsot_e_domain, "from_axis_angle: the axis or the angle is not finite")
      else if (maxval(abs(axis)) <= 0) then
         call raise(error, poinsot_e_domain, &
            "from_axis_angle: the axis is zero; it must have a direction")
      else
         q = [cos(angle/2), sin(angle/2)*unit_vector(axis)]
      end if
   end subroutine from_axis_angle

   !> Axis and angle of an attitude. The identity has no axis: it gets the first.
   pure subroutine to_axis_angle(q, axis, angle)
      real(dp), intent(in) :: q(4)     !! attitude, unit
      real(dp), intent(out) :: axis(3) !! unit
      real(dp), intent(out) :: angle   !! radians, in [0, pi]
      real(dp) :: p(4)
      p = scalar_positive(q)
      angle = 2*atan2(vector_norm(p(2:4)), p(1))
      axis = unit_vector(p(2:4))
      if (maxval(abs(axis)) <= 0) axis = [1._dp, 0._dp, 0._dp]
   end subroutine to_axis_angle

   !> Rotation vector (axis times angle) of an attitude, of length at most pi: the inverse of the
   !> review's a(omega).
   pure function to_rotation_vector(q) result(omega)
      real(dp), intent(in) :: q(4) !! attitude, unit
      real(dp) :: omega(3)
      real(dp) :: p(4)
      p = scalar_positive(q)
      omega = 2*atan2(vector_norm(p(2:4)), p(1))*unit_vector(p(2:4))
   end function to_rotation_vector

   !> Attitude of a Cayley vector e: (1, e)/sqrt(1 + |e|^2).
   pure function from_cayley(e) result(q)
      real(dp), intent(in) :: e(3) !! tan(angle/2) times the axis, finite
      real(dp) :: q(4)
      q = normalise([1._dp, e])
   end function from_cayley

   !> Cayley vector of an attitude: vector part over scalar part, tan(angle/2) times the axis.
   pure subroutine to_cayley(q, e, error)
      real(dp), intent(in) :: q(4)                !! attitude, unit
      real(dp), intent(out) :: e(3)               !! finite
      type(poinsot_error), intent(inout) :: error !! poinsot_e_domain: a half-turn, which has none
      e = 0
      if (maxval(abs(q(2:4))) < abs(q(1))*1e300_dp) then
         e = q(2:4)/q(1)
      else
         call raise(error, poinsot_e_domain, "to_cayley: a half-turn has no Cayley vector")
      end if
   end subroutine to_cayley

   !> Attitude of intrinsic z-y'-x'' angles (yaw, pitch, roll; Tait-Bryan): Q = R3(yaw) R2(pitch)
   !> R1(roll).
   pure function from_euler_zyx(angles) result(q)
      real(dp), intent(in) :: angles(3) !! yaw, pitch, roll in radians
      real(dp) :: q(4)
      real(dp) :: c(3), s(3)
      c = cos(angles/2)
      s = sin(angles/2)
      q(1) = c(1)*c(2)*c(3) + s(1)*s(2)*s(3)
      q(2) = c(1)*c(2)*s(3) - s(1)*s(2)*c(3)
      q(3) = c(1)*s(2)*c(3) + s(1)*c(2)*s(3)
      q(4) = s(1)*c(2)*c(3) - c(1)*s(2)*s(3)
   end function from_euler_zyx

   !> Intrinsic z-y'-x'' angles of an attitude. In gimbal lock (pitch +-pi/2) only yaw -+ roll is
   !> known: roll is 0 then.
   !>
   !> The four sums q0 +- q2, q3 -+ q1 are cos or sin of (yaw -+ roll)/2 times cos(pitch/2) +-
   !> sin(pitch/2), so all three angles come from atan2, to rounding, with no arcsine near 1 (the
   !> idea of Bernardes and Viollet, PLoS ONE 17, 2022).
   pure function to_euler_zyx(q) result(angles)
      real(dp), intent(in) :: q(4) !! attitude, unit
      real(dp) :: angles(3)        !! yaw in [-pi, pi], pitch in [-pi/2, pi/2], roll in [-pi, pi]
      real(dp) :: plus, minus, half_sum, half_difference
      minus = hypot(q(1) - q(3), q(2) + q(4))
      plus = hypot(q(1) + q(3), q(4) - q(2))
      half_sum = atan2(q(2) + q(4), q(1) - q(3))
      half_difference = atan2(q(4) - q(2), q(1) + q(3))
      angles(2) = pi/2 - 2*atan2(minus, plus)
      if (minus <= lock_tolerance) then
         angles(1) = 2*half_difference
         angles(3) = 0
      else if (plus <= lock_tolerance) then
         angles(1) = 2*half_sum
         angles(3) = 0
      else
         angles(1) = half_sum + half_difference
         angles(3) = half_sum - half_difference
      end if
      angles(1) = wrapped(angles(1))
      angles(3) = wrapped(angles(3))
   end function to_euler_zyx

   !> Attitude of the classical intrinsic z-x'-z'' angles of tops (precession, nutation, spin):
   !> Q = R3(precession) R1(nutation) R3(spin).
   pure function from_euler_zxz(angles) result(q)
      real(dp), intent(in) :: angles(3) !! precession, nutation, spin in radians
      real(dp) :: q(4)
      real(dp) :: half_sum, half_difference
      half_sum = (angles(1) + angles(3))/2
      half_difference = (angles(1) - angles(3))/2
      q(1) = cos(angles(2)/2)*cos(half_sum)
      q(2) = sin(angles(2)/2)*cos(half_difference)
      q(3) = sin(angles(2)/2)*sin(half_difference)
      q(4) = cos(angles(2)/2)*sin(half_sum)
   end function from_euler_zxz

   !> Intrinsic z-x'-z'' angles of an attitude. In gimbal lock (nutation 0 or pi) only precession +-
   !> spin is known: spin is 0.
   pure function to_euler_zxz(q) result(angles)
      real(dp), intent(in) :: q(4) !! attitude, unit
      real(dp) :: angles(3)        !! precession in [-pi, pi], nutation in [0, pi], spin in [-pi,
                                   !! pi]
      real(dp) :: tilted, upright, half_sum, half_difference
      tilted = hypot(q(2), q(3))
      upright = hypot(q(1), q(4))
      half_sum = atan2(q(4), q(1))
      half_difference = atan2(q(3), q(2))
      angles(2) = 2*atan2(tilted, upright)
      if (tilted <= lock_tolerance) then
         angles(1) = 2*half_sum
         angles(3) = 0
      else if (upright <= lock_tolerance) then
         angles(1) = 2*half_difference
         angles(3) = 0
      else
         angles(1) = half_sum + half_difference
         angles(3) = half_sum - half_difference
      end if
      angles(1) = wrapped(angles(1))
      angles(3) = wrapped(angles(3))
   end function to_euler_zxz

   !> The same attitude with a scalar part that is not negative; of a half-turn, with its first
   !> non-zero component positive.
   pure function scalar_positive(q) result(p)
      real(dp), intent(in) :: q(4)
      real(dp) :: p(4)
      integer :: i
      p = q
      do i = 1, 4
         if (abs(q(i)) > 0) then
            if (q(i) < 0) p = -q
            return
         end if
      end do
   end function scalar_positive

   !> An angle within (-2 pi, 2 pi] brought to [-pi, pi].
   pure real(dp) function wrapped(angle)
      real(dp), intent(in) :: angle
      wrapped = angle
      if (angle > pi) wrapped = angle - 2*pi
      if (angle < -pi) wrapped = angle + 2*pi
   end function wrapped

end module poinsot_rotation_conversions
