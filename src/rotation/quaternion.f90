!> Quaternions q = (q0, q1, q2, q3) = q0 + i q1 + j q2 + k q3, scalar first, Hamilton's product.
!>
!> A unit quaternion is an attitude: it takes body coordinates to space coordinates, x = Q X with
!> Q = |q|^2 + 2 q0 hat(e) + 2 hat(e)^2 and e = (q1, q2, q3); q and -q are the same attitude
!> (Vilmart's review, "Quaternion implementation"; its "iq_2" is a misprint for j q2).
module poinsot_rotation_quaternion
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_constants, only: pi
   use poinsot_core_kinds, only: dp
   use poinsot_core_libm, only: arctangent, cosine, exponential, logarithm, &
      logarithm_1p, sine
   use poinsot_core_status, only: poinsot_e_domain
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_rotation_vector, only: cross, largest_exponent, perpendicular, unit_vector, &
      vector_norm
   implicit none(type, external)
   private
   public :: identity_quaternion, unit_tolerance, check_quaternion, is_attitude
   public :: quaternion_product, quaternion_conjugate, quaternion_inverse, &
      quaternion_norm, normalise
   public :: rotate, rotate_back, quaternion_exp, quaternion_log
   public :: slerp, shortest_arc, attitude_distance, attitude_angle

   !> The attitude whose body axes are the space axes.
   real(dp), parameter :: identity_quaternion(4) = [1._dp, 0._dp, 0._dp, 0._dp]

   !> Input attitudes whose norm is off 1 by at most this are used as they are; beyond, they are
   !> refused.
   real(dp), parameter :: unit_tolerance = 1e-6_dp


contains

   !> Refuse a quaternion that is no attitude: not finite, zero, or off unit norm by more than
   !> `unit_tolerance`.
   pure subroutine check_quaternion(q, error)
      real(dp), intent(in) :: q(4)                !! attitude, scalar first
      type(poinsot_error), intent(inout) :: error !! poinsot_e_domain
      character(160) :: text
      if (is_attitude(q)) return
      if (.not. all(ieee_is_finite(q))) then
         call raise(error, poinsot_e_domain, "quaternion: a component is not finite")
         return
      end if
      write (text, "(a, 4es14.6, a, es9.2)") "quaternion", q, &
         " is not an attitude: its norm must be 1 to within", unit_tolerance
      call raise(error, poinsot_e_domain, trim(text))
   end subroutine check_quaternion

   !> Is it of unit norm to within `unit_tolerance`? Not so if a component is not finite.
   pure logical function is_attitude(q)
      real(dp), intent(in) :: q(4) !! any numbers
      is_attitude = .false.
      if (.not. all(ieee_is_finite(q))) return
      if (maxval(abs(q)) < 2) is_attitude = abs(quaternion_norm(q) - 1) <= unit_tolerance
   end function is_attitude

   !> Hamilton's product p o q. As rotations: first q, then p.
   pure function quaternion_product(p, q) result(r)
      real(dp), intent(in) :: p(4) !! left factor
      real(dp), intent(in) :: q(4) !! right factor
      real(dp) :: r(4)
      r(1) = p(1)*q(1) - p(2)*q(2) - p(3)*q(3) - p(4)*q(4)
      r(2) = p(1)*q(2) + p(2)*q(1) + p(3)*q(4) - p(4)*q(3)
      r(3) = p(1)*q(3) + p(3)*q(1) + p(4)*q(2) - p(2)*q(4)
      r(4) = p(1)*q(4) + p(4)*q(1) + p(2)*q(3) - p(3)*q(2)
   end function quaternion_product

   !> (q0, -q1, -q2, -q3): the inverse rotation of a unit quaternion.
   pure function quaternion_conjugate(q) result(r)
      real(dp), intent(in) :: q(4) !! any quaternion
      real(dp) :: r(4)
      r = [q(1), -q(2), -q(3), -q(4)]
   end function quaternion_conjugate

   !> conjugate(q)/|q|^2 at any scale; zero, which has no inverse, gives zero, and so does a q so
   !> small (|q| below 1e-308) that its inverse is out of range.
   pure function quaternion_inverse(q) result(r)
      real(dp), intent(in) :: q(4) !! finite
      real(dp) :: r(4)
      integer :: e
      r = 0
      if (maxval(abs(q)) <= 0) return
      e = largest_exponent(q)
      r = scale(q, -e)
      r = quaternion_conjugate(r)/sum(r**2)
      if (largest_exponent(r) - e > maxexponent(1._dp)) then
         r = 0
      else
         r = scale(r, -e)
      end if
   end function quaternion_inverse

   !> |q|, without overflow or underflow of the squares.
   pure real(dp) function quaternion_norm(q)
      real(dp), intent(in) :: q(4) !! finite
      quaternion_norm = vector_norm(q)
   end function quaternion_norm

   !> q/|q| at any scale. Zero, which has no direction, gives the identity: test with
   !> `check_quaternion` where it matters.
   pure function normalise(q) result(r)
      real(dp), intent(in) :: q(4) !! finite
      real(dp) :: r(4)
      r = unit_vector(q)
      if (maxval(abs(r)) <= 0) r = identity_quaternion
   end function normalise

   !> Body to space: Q v = q o v o conjugate(q).
   pure function rotate(q, v) result(w)
      real(dp), intent(in) :: q(4) !! attitude, unit
      real(dp), intent(in) :: v(3) !! vector in the body frame
      real(dp) :: w(3)
      associate (e => q(2:4))
         w = (q(1)**2 - dot_product(e, e))*v + 2*dot_product(e, v)*e + 2*q(1)*cross(e, v)
      end associate
   end function rotate

   !> Space to body: Q^T v.
   pure function rotate_back(q, v) result(w)
      real(dp), intent(in) :: q(4) !! attitude, unit
      real(dp), intent(in) :: v(3) !! vector in the space frame
      real(dp) :: w(3)
      w = rotate(quaternion_conjugate(q), v)
   end function rotate_back

   !> exp(q) = e**q0 (cos|v| + sin|v| v/|v|), v the vector part. A turn by the rotation vector w is
   !> exp((0, w/2)).
   pure function quaternion_exp(q) result(r)
      real(dp), intent(in) :: q(4) !! finite; q0 at most 709.78, |v| at most 1e308
      real(dp) :: r(4)
      real(dp) :: angle
      angle = vector_norm(q(2:4))
      r(1) = cosine(angle)
      r(2:4) = sine(angle)*unit_vector(q(2:4))
      r = exponential(q(1))*r
   end function quaternion_exp

   !> Principal logarithm, log|q| + v/|v| atan2(|v|, q0); its vector part has length at most pi. A
   !> negative real q takes the first axis; zero, which has no logarithm, gives (-huge, 0, 0, 0).
   pure function quaternion_log(q) result(r)
      real(dp), intent(in) :: q(4) !! finite
      real(dp) :: r(4)
      real(dp), parameter :: ln2 = log(2._dp)
      integer :: e
      r = [-huge(r), 0._dp, 0._dp, 0._dp]
      if (maxval(abs(q)) <= 0) return
      e = largest_exponent(q)
      if (abs(e) < 1000) e = 0
      r(1) = log_of_norm(scale(q, -e)) + e*ln2
      if (maxval(abs(q(2:4))) > 0) then
         r(2:4) = arctangent(vector_norm(scale(q(2:4), -e)), scale(q(1), -e))*unit_vector(q(2:4))
      else if (q(1) < 0) then
         r(2) = pi
      end if
   end function quaternion_log

   !> log|q|, of full precision for |q| near 1 too.
   pure real(dp) function log_of_norm(q) result(r)
      real(dp), intent(in) :: q(4) !! not zero, |q| in range
      real(dp) :: big, rest(4)
      integer :: k
      r = quaternion_norm(q)
      if (abs(r - 1) > 0.1_dp) then
         r = logarithm(r)
      else
         k = maxloc(abs(q), dim=1)
         big = abs(q(k))
         rest = q
         rest(k) = 0
         r = logarithm_1p((big - 1)*(big + 1) + sum(rest**2))/2
      end if
   end function log_of_norm

   !> Spherical interpolation from p (t = 0) to q (t = 1) by the shorter arc, any signs of p and q
   !> (K. Shoemake, SIGGRAPH 1985). t outside [0, 1] extrapolates, however small the angle
   !> between p and q is. The result is a unit quaternion, with the sign of p.
   pure function slerp(p, q, t) result(r)
      real(dp), intent(in) :: p(4) !! first attitude, unit
      real(dp), intent(in) :: q(4) !! second attitude, unit
      real(dp), intent(in) :: t    !! how far, |t| at most 1e308
      real(dp) :: r(4)
      real(dp) :: near(4), across(4), angle
      near = q
      if (dot_product(p, q) < 0) near = -q
      across = near - p ! exact for a small angle; then what of it is normal to p
      across = across - (dot_product(across, p)/dot_product(p, p))*p
      angle = arctangent(vector_norm(across)*vector_norm(p), dot_product(p, near))
      r = normalise(cosine(t*angle)*normalise(p) + sine(t*angle)*unit_vector(across))
   end function slerp

   !> The smallest rotation from direction a to direction b. Opposite directions have many: then a
   !> half-turn about `perpendicular(a)`.
   pure subroutine shortest_arc(a, b, q, error)
      real(dp), intent(in) :: a(3)                !! from this direction, any length but zero
      real(dp), intent(in) :: b(3)                !! to this direction, any length but zero
      real(dp), intent(out) :: q(4)               !! unit, scalar part not negative; rotate(q, a)
                                                  !! points along b
      type(poinsot_error), intent(inout) :: error !! poinsot_e_domain if a vector is zero or not
                                                  !! finite
      real(dp) :: u(3), c(3), w(3)
      q = identity_quaternion
      if (.not. (all(ieee_is_finite(a)) .and. all(ieee_is_finite(b)))) then
         call raise(error, poinsot_e_domain, "shortest_arc: a direction is not finite")
         return
      end if
      if (maxval(abs(a)) <= 0 .or. maxval(abs(b)) <= 0) then
         call raise(error, poinsot_e_domain, "shortest_arc: a zero vector has no direction")
         return
      end if
      u = unit_vector(a)
      c = u + unit_vector(b) ! |c| = 2 cos(angle/2), exact next to opposite directions
      w = cross(u, c)        ! = u x unit(b), of length sin(angle)
      if (vector_norm(c) > 1e-8_dp) then
         q = normalise([dot_product(c, c)/2, w])
      else ! c along u is mere rounding: measure by w, and keep its direction normal to u
         q(1) = vector_norm(w)/2
         q(2:4) = unit_vector(w)
         if (q(1) <= 0) q(2:4) = perpendicular(u)
         q(2:4) = q(2:4) - dot_product(q(2:4), u)*u
         q = normalise(q)
      end if
   end subroutine shortest_arc

   !> min(|q-p|, |q+p|): how far two attitudes differ, ignoring the sign. Half the angle between
   !> them when small.
   pure real(dp) function attitude_distance(p, q)
      real(dp), intent(in) :: p(4) !! unit
      real(dp), intent(in) :: q(4) !! unit
      attitude_distance = min(vector_norm(q - p), vector_norm(q + p))
   end function attitude_distance

   !> Angle of the turn from one attitude to the other, in [0, pi], accurate also for tiny angles.
   pure real(dp) function attitude_angle(p, q)
      real(dp), intent(in) :: p(4) !! unit
      real(dp), intent(in) :: q(4) !! unit
      real(dp) :: apart, opposite
      apart = vector_norm(q - p)
      opposite = vector_norm(q + p)
      attitude_angle = 4*arctangent(min(apart, opposite), max(apart, opposite))
   end function attitude_angle

end module poinsot_rotation_quaternion
