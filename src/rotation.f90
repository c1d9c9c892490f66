!> The public module of rotations: `use poinsot_rotation`. Vectors, quaternions, their conversions,
!> random attitudes, inertia; in C they are poinsot_quaternion_...
!>
!> Quaternions are q = (q0, q1, q2, q3), scalar first, Hamilton's product. A unit quaternion is an
!> attitude, body to space: x = Q X = rotate(q, X); q and -q are the same attitude. Angles are in
!> radians, reals are `kind(1d0)`. Procedures that can fail have an argument `error`; the valid
!> arguments of the others are documented with them.
module poinsot_rotation
   ! p o q, 1/q, |q|, q/|q|; Q v and Q^T v; e**q, log q
   use poinsot_rotation_quaternion, only: identity_quaternion, unit_tolerance, check_quaternion, &
      is_attitude, quaternion_product, quaternion_conjugate, quaternion_inverse, quaternion_norm, &
      normalise, rotate, rotate_back, quaternion_exp, quaternion_log
   ! between two attitudes
   use poinsot_rotation_quaternion, only: slerp, shortest_arc, attitude_distance, attitude_angle
   ! a rotation matrix, axis and angle, rotation vector, Cayley vector, Euler angles, and back
   use poinsot_rotation_conversions, only: to_matrix, from_matrix, from_axis_angle, &
      to_axis_angle, from_rotation_vector, to_rotation_vector, from_cayley, to_cayley, &
      from_euler, to_euler
   use poinsot_rotation_nearest, only: check_rotation, nearest_rotation
   ! the review's u, v, a and U, V, hat, rot
   use poinsot_rotation_review, only: quaternion_u, quaternion_v, quaternion_a, matrix_u, &
      matrix_v, matrix_a
   use poinsot_rotation_vector, only: cross, vector_norm, unit_vector, perpendicular, &
      angle_between, hat, vee, rot, identity_matrix, determinant
   ! functions of (seed, number): no state
   use poinsot_rotation_random, only: random_uniform, random_gaussian, random_quaternion, &
      random_direction
   ! tensors (with -sum of m x y off the diagonal), principal moments and axes
   use poinsot_body_inertia, only: inertia_of_points => point_mass_tensor, parallel_axis, &
      tensor_of_axes, principal_axes
   use poinsot_core_error, only: poinsot_error
   implicit none(type, external)
   public
end module poinsot_rotation
