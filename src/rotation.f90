!> Room rotation: vectors, quaternions, their conversions, and random attitudes.
module poinsot_rotation
   use poinsot_rotation_vector, only: cross, vector_norm, unit_vector, perpendicular, &
      angle_between, hat, vee, rot, identity_matrix, determinant, largest_exponent
   use poinsot_rotation_quaternion, only: identity_quaternion, unit_tolerance, check_quaternion, &
      quaternion_product, quaternion_conjugate, quaternion_inverse, quaternion_norm, normalise, &
      rotate, rotate_back, quaternion_exp, quaternion_log, slerp, shortest_arc, &
      attitude_distance, attitude_angle
   use poinsot_rotation_conversions, only: to_matrix, from_matrix, from_axis_angle, &
      to_axis_angle, to_rotation_vector, from_cayley, to_cayley, from_euler_zyx, to_euler_zyx, &
      from_euler_zxz, to_euler_zxz
   use poinsot_rotation_nearest, only: check_rotation, nearest_rotation
   use poinsot_rotation_review, only: quaternion_u, quaternion_v, quaternion_a, matrix_u, &
      matrix_v, matrix_a
   use poinsot_rotation_random, only: philox4x32, random_words, uniform_from_words, &
      random_uniform, random_gaussian, random_quaternion, random_direction, stream_attitude, &
      stream_direction, stream_momentum, stream_noise
   implicit none(type, external)
   public
end module poinsot_rotation
