!> Conversions of attitudes: rotation matrix, axis and angle, rotation vector, Cayley vector, Euler
!> angles.
!>
!> `from_...` makes a unit quaternion, `to_...` reads one. Where a sign is free, the scalar part is
!> not negative. Inputs without a result are errors; an attitude whose axis or angle is not unique
!> (identity, gimbal lock) gets a fixed choice.
module poinsot_rotation_conversions
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_constants, only: pi
   use poinsot_core_kinds, only: dp
   use poinsot_core_libm, only: arctangent, cosine, sine
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_method
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_rotation_vector, only: vector_norm, unit_vector
   use poinsot_rotation_quaternion, only: identity_quaternion, normalise, quaternion_product
   implicit none(type, external)
   private
   public :: to_matrix, from_matrix
   public :: from_axis_angle, to_axis_angle, from_rotation_vector, to_rotation_vector
   public :: from_cayley, to_cayley, from_euler, to_euler
   public :: euler_axes, attitude_of_euler, euler_of_attitude


   !> Below this sine of half the angle, what distinguishes the first from the third Euler angle is
   !> rounding noise.
   real(dp), parameter :: lock_tolerance = 8*epsilon(1._dp)

contains

   !> Rotation matrix, body to space: Q = |q|^2 + 2 q0 hat(e) + 2 hat(e)^2 (Vilmart's review). Its
   !> columns are the body axes in space.
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
      type(poinsot_error), intent(inout) :: error !! poinsot_e_domain for a zero axis, or not finite
      q = identity_quaternion
      if (.not. (all(ieee_is_finite(axis)) .and. ieee_is_finite(angle))) then
         call raise(error, poinsot_e_domain, "from_axis_angle: the axis or the angle is not finite")
      else if (maxval(abs(axis)) <= 0) then
         call raise(error, poinsot_e_domain, &
            "from_axis_angle: the axis is zero; it must have a direction")
      else
         q = [cosine(angle/2), sine(angle/2)*unit_vector(axis)]
      end if
   end subroutine from_axis_angle

   !> Axis and angle of an attitude. The identity has no axis: it gets the first.
   pure subroutine to_axis_angle(q, axis, angle)
      real(dp), intent(in) :: q(4)     !! attitude, unit
      real(dp), intent(out) :: axis(3) !! unit
      real(dp), intent(out) :: angle   !! radians, in [0, pi]
      real(dp) :: p(4)
      p = scalar_positive(q)
      angle = 2*arctangent(vector_norm(p(2:4)), p(1))
      axis = unit_vector(p(2:4))
      if (maxval(abs(axis)) <= 0) axis = [1._dp, 0._dp, 0._dp]
   end subroutine to_axis_angle

   !> The turn by a rotation vector: about its direction, by its length.
   pure function from_rotation_vector(omega) result(q)
      real(dp), intent(in) :: omega(3) !! radians, any length up to 1e308
      real(dp) :: q(4)                 !! unit; scalar part cos(|omega|/2), of either sign
      real(dp) :: angle, factor
      angle = vector_norm(omega)
      factor = 0.5_dp ! sin(x/2)/x to within x**2/24
      if (angle > 1e-8_dp) factor = sine(angle/2)/angle
      q = [cosine(angle/2), factor*omega]
   end function from_rotation_vector

   !> Rotation vector (axis times angle) of an attitude, of length at most pi.
   pure function to_rotation_vector(q) result(omega)
      real(dp), intent(in) :: q(4) !! attitude, unit
      real(dp) :: omega(3)
      real(dp) :: p(4)
      p = scalar_positive(q)
      omega = 2*arctangent(vector_norm(p(2:4)), p(1))*unit_vector(p(2:4))
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
      type(poinsot_error), intent(inout) :: error !! poinsot_e_domain for a half-turn: it has none
      e = 0
      if (maxval(abs(q(2:4))) < abs(q(1))*1e300_dp) then
         e = q(2:4)/q(1)
      else
         call raise(error, poinsot_e_domain, "to_cayley: a half-turn has no Cayley vector")
      end if
   end subroutine to_cayley

   !> Axes of a convention, as numbers: "zxz" is 3, 1, 3. Zeros for what is none of the twelve
   !> (lower-case x, y, z, neighbours different).
   pure function euler_axes(convention) result(axes)
      character(*), intent(in) :: convention
      integer :: axes(3)
      integer :: k
      axes = 0
      if (len_trim(convention) /= 3) return
      do k = 1, 3
         axes(k) = index("xyz", convention(k:k))
      end do
      if (any(axes == 0) .or. axes(1) == axes(2) .or. axes(2) == axes(3)) axes = 0
   end function euler_axes

   !> Attitude of Euler angles about moving axes: q = q_1(a1) o q_2(a2) o q_3(a3), turns about the
   !> axes that the letters of the convention name. In body frames: first a1 about the first axis,
   !> then a2 about the second as it then lies, then a3.
   pure subroutine from_euler(convention, angles, q, error)
      character(*), intent(in) :: convention      !! one of "xyz", "xzy", "yxz", "yzx", "zxy",
                                                  !! "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"
      real(dp), intent(in) :: angles(3)           !! radians, any
      real(dp), intent(out) :: q(4)               !! unit, of either sign
      type(poinsot_error), intent(inout) :: error !! poinsot_e_method for an unknown convention,
                                                  !! poinsot_e_domain for angles not finite
      integer :: axes(3)
      q = identity_quaternion
      call find_axes("from_euler", convention, axes, error)
      if (axes(1) == 0) return
      if (all(ieee_is_finite(angles))) then
         q = attitude_of_euler(axes, angles)
      else
         call raise(error, poinsot_e_domain, "from_euler: an angle is not finite")
      end if
   end subroutine from_euler

   !> Euler angles of an attitude. In gimbal lock only the sum or the difference of the first and
   !> the third is known: the third is 0 then.
   pure subroutine to_euler(convention, q, angles, error)
      character(*), intent(in) :: convention      !! as in from_euler
      real(dp), intent(in) :: q(4)                !! attitude, unit
      real(dp), intent(out) :: angles(3)          !! first and third in [-pi, pi], the second in
                                                  !! [0, pi] if they share an axis, else in
                                                  !! [-pi/2, pi/2]
      type(poinsot_error), intent(inout) :: error !! poinsot_e_method for an unknown convention
      integer :: axes(3)
      angles = 0
      call find_axes("to_euler", convention, axes, error)
      if (axes(1) /= 0) angles = euler_of_attitude(axes, q)
   end subroutine to_euler

   !> Axes of a convention, or a refusal.
   pure subroutine find_axes(who, convention, axes, error)
      character(*), intent(in) :: who, convention
      integer, intent(out) :: axes(3)
      type(poinsot_error), intent(inout) :: error
      axes = euler_axes(convention)
      if (axes(1) == 0) call raise(error, poinsot_e_method, who//": unknown convention '"// &
         convention(:min(len(convention), 20))//"'; it must be one of xyz, xzy, yxz, yzx, zxy, "// &
         "zyx, xyx, xzx, yxy, yzy, zxz, zyz")
   end subroutine find_axes

   !> `from_euler`, the convention as numbers of axes.
   pure function attitude_of_euler(axes, angles) result(q)
      integer, intent(in) :: axes(3)    !! of `euler_axes`, not zero
      real(dp), intent(in) :: angles(3) !! radians, finite
      real(dp) :: q(4)
      q = quaternion_product(quaternion_product(turn(axes(1), angles(1)), &
         turn(axes(2), angles(2))), turn(axes(3), angles(3)))
   end function attitude_of_euler

   !> A turn about one of the axes.
   pure function turn(axis, angle) result(q)
      integer, intent(in) :: axis
      real(dp), intent(in) :: angle
      real(dp) :: q(4)
      q = 0
      q(1) = cosine(angle/2)
      q(1 + axis) = sine(angle/2)
   end function turn

   !> `to_euler`, the convention as numbers of axes.
   !>
   !> The components, or sums and differences of two, are cos and sin of (a1 + a3)/2 and of
   !> (a1 - a3)/2 times cos and sin of half the second angle (from a quarter turn, if the three axes
   !> differ). So all angles come from atan2, to rounding, with no arcsine near 1 (the idea of
   !> Bernardes and Viollet, PLoS ONE 17, 2022).
   pure function euler_of_attitude(axes, q) result(angles)
      integer, intent(in) :: axes(3) !! of `euler_axes`, not zero
      real(dp), intent(in) :: q(4)   !! attitude, unit
      real(dp) :: angles(3)
      real(dp) :: parity, plus(2), minus(2), half_sum, half_difference
      integer :: i, j, k
      i = 1 + axes(1)
      j = 1 + axes(2)
      k = 9 - i - j ! the axis that is neither
      parity = merge(1._dp, -1._dp, modulo(j - i, 3) == 1)
      if (axes(3) == axes(1)) then
         plus = [q(1), q(i)]
         minus = [q(j), parity*q(k)]
         angles(2) = 2*arctangent(vector_norm(minus), vector_norm(plus))
      else
         plus = [q(1) + parity*q(j), q(i) + q(k)]
         minus = [q(1) - parity*q(j), q(i) - q(k)]
         angles(2) = parity*(2*arctangent(vector_norm(plus), vector_norm(minus)) - pi/2)
      end if
      half_sum = arctangent(plus(2), plus(1))
      half_difference = arctangent(minus(2), minus(1))
      if (vector_norm(minus) <= lock_tolerance) then
         angles(1) = 2*half_sum
         angles(3) = 0
      else if (vector_norm(plus) <= lock_tolerance) then
         angles(1) = 2*half_difference
         angles(3) = 0
      else
         angles(1) = half_sum + half_difference
         angles(3) = half_sum - half_difference
      end if
      angles(1) = wrapped(angles(1))
      angles(3) = wrapped(angles(3))
   end function euler_of_attitude

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
