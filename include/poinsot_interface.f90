! Interfaces of the C functions of poinsot.h, for Fortran compilers other than the one that built
! the library: compile this file with your program. poinsot.h documents each function; strings are
! `trim(text)//c_null_char`, handles type(c_ptr). With the compiler that built the library, `use
! poinsot` is simpler.
module poinsot_interface
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_funptr, c_int, c_int64_t, &
      c_null_ptr, c_ptr, c_intptr_t, c_size_t, c_sizeof
   implicit none
   private
   public :: poinsot_bodies
   public :: poinsot_version, poinsot_status_text, poinsot_has_feature, poinsot_method_count, &
      poinsot_method_name
   public :: poinsot_splitting_count, poinsot_splitting_name, poinsot_splitting_flows, &
      poinsot_effect_count, poinsot_effect_name
   public :: poinsot_body_create, poinsot_body_create_tensor, poinsot_body_destroy, &
      poinsot_rotate, poinsot_jacobi
   public :: poinsot_moments_check, poinsot_inertia_check, poinsot_inertia_of_points
   public :: poinsot_principal_axes, poinsot_jacobi_am, poinsot_elliptic_k, poinsot_elliptic_e
   public :: poinsot_elliptic_pi, poinsot_elliptic_f, poinsot_elliptic_e_incomplete
   public :: poinsot_elliptic_pi_incomplete, poinsot_carlson_rf, poinsot_carlson_rc
   public :: poinsot_carlson_rd, poinsot_carlson_rj, poinsot_quaternion_multiply
   public :: poinsot_quaternion_conjugate, poinsot_quaternion_inverse
   public :: poinsot_quaternion_normalize, poinsot_quaternion_exp, poinsot_quaternion_log
   public :: poinsot_quaternion_rotate, poinsot_quaternion_rotate_back
   public :: poinsot_quaternion_to_matrix, poinsot_quaternion_from_matrix
   public :: poinsot_quaternion_nearest, poinsot_quaternion_from_rotation_vector
   public :: poinsot_quaternion_to_rotation_vector, poinsot_quaternion_from_axis_angle
   public :: poinsot_quaternion_to_axis_angle, poinsot_quaternion_from_cayley
   public :: poinsot_quaternion_to_cayley, poinsot_quaternion_from_euler
   public :: poinsot_quaternion_to_euler, poinsot_quaternion_slerp
   public :: poinsot_quaternion_shortest_arc, poinsot_quaternion_distance
   public :: poinsot_quaternion_random
   public :: poinsot_bodies_rows, poinsot_bodies_arrays, poinsot_bodies_rows_sized, &
      poinsot_bodies_arrays_sized
   public :: poinsot_plan_create, poinsot_plan_destroy, poinsot_plan_add_class, &
      poinsot_plan_find_class, &
      poinsot_plan_add_class_tensor, poinsot_plan_class_axes
   public :: poinsot_plan_set, poinsot_plan_add_effect, poinsot_plan_ready, poinsot_plan_message, &
      poinsot_bodies_check
   public :: poinsot_drift, poinsot_kick, poinsot_dissipate, poinsot_step, poinsot_energy, &
      poinsot_momentum, &
      poinsot_degrees_of_freedom

   type, bind(c) :: poinsot_bodies
      integer(c_size_t) :: size = 0, n = 0
      type(c_ptr) :: y(3) = c_null_ptr, q(4) = c_null_ptr
      integer(c_intptr_t) :: y_stride = 0, q_stride = 0
      type(c_ptr) :: body_class = c_null_ptr, id = c_null_ptr, carry = c_null_ptr, &
         status = c_null_ptr
      type(c_ptr) :: y_fourth = c_null_ptr
      integer(c_intptr_t) :: first_class = 0
      integer(c_intptr_t) :: class_stride = 0
      type(c_ptr) :: y_at = c_null_ptr, q_at = c_null_ptr
      integer(c_size_t) :: rows = 0
      type(c_ptr) :: scale = c_null_ptr, moments(3) = c_null_ptr
      integer(c_intptr_t) :: moments_stride = 0
   end type poinsot_bodies

   interface
      integer(c_int) function poinsot_version() bind(c)
         import
      end function poinsot_version

      type(c_ptr) function poinsot_status_text(status) bind(c)
         import
         integer(c_int), value :: status
      end function poinsot_status_text

      integer(c_int) function poinsot_has_feature(name) bind(c)
         import
         character(kind=c_char), intent(in) :: name(*)
      end function poinsot_has_feature

      integer(c_size_t) function poinsot_method_count() bind(c)
         import
      end function poinsot_method_count

      type(c_ptr) function poinsot_method_name(i) bind(c)
         import
         integer(c_size_t), value :: i
      end function poinsot_method_name

      integer(c_size_t) function poinsot_splitting_count() bind(c)
         import
      end function poinsot_splitting_count

      type(c_ptr) function poinsot_splitting_name(i) bind(c)
         import
         integer(c_size_t), value :: i
      end function poinsot_splitting_name

      integer(c_int) function poinsot_splitting_flows(name, capacity, kick, drift, count) bind(c)
         import
         character(kind=c_char), intent(in) :: name(*)
         integer(c_size_t), value :: capacity
         real(c_double), intent(out) :: kick(*), drift(*)
         integer(c_size_t), intent(out) :: count
      end function poinsot_splitting_flows

      integer(c_size_t) function poinsot_effect_count() bind(c)
         import
      end function poinsot_effect_count

      type(c_ptr) function poinsot_effect_name(i) bind(c)
         import
         integer(c_size_t), value :: i
      end function poinsot_effect_name

      integer(c_int) function poinsot_body_create(moments, body) bind(c)
         import
         real(c_double), intent(in) :: moments(3)
         type(c_ptr), intent(out) :: body
      end function poinsot_body_create

      integer(c_int) function poinsot_body_create_tensor(inertia, body, axes) bind(c)
         import
         real(c_double), intent(in) :: inertia(3, 3)      ! symmetric
         type(c_ptr), intent(out) :: body
         real(c_double), intent(out) :: axes(3, 3)        ! principal axes as rows: row-major in C
      end function poinsot_body_create_tensor

      subroutine poinsot_body_destroy(body) bind(c)
         import
         type(c_ptr), intent(inout) :: body
      end subroutine poinsot_body_destroy

      integer(c_int) function poinsot_rotate(body, method, h, steps, n, y, q, per_body) bind(c)
         import
         type(c_ptr), value :: body
         character(kind=c_char), intent(in) :: method(*)
         real(c_double), value :: h
         integer(c_size_t), value :: steps, n
         real(c_double), intent(inout) :: y(3, *), q(4, *)
         type(c_ptr), value :: per_body                   ! c_loc of integer(c_int) :: per_body(n),
                                                          ! or c_null_ptr
      end function poinsot_rotate

      integer(c_int) function poinsot_moments_check(moments, buffer, capacity) bind(c)
         import
         real(c_double), intent(in) :: moments(3)
         character(kind=c_char), intent(out) :: buffer(*)
         integer(c_size_t), value :: capacity
      end function poinsot_moments_check

      integer(c_int) function poinsot_inertia_check(inertia, buffer, capacity) bind(c)
         import
         real(c_double), intent(in) :: inertia(3, 3)
         character(kind=c_char), intent(out) :: buffer(*)
         integer(c_size_t), value :: capacity
      end function poinsot_inertia_check

      integer(c_int) function poinsot_inertia_of_points(n, mass, x, centre, tensor) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: mass(*), x(3, *)
         real(c_double), intent(out) :: centre(3), tensor(3, 3)
      end function poinsot_inertia_of_points

      integer(c_int) function poinsot_principal_axes(tensor, moments, axes) bind(c)
         import
         real(c_double), intent(in) :: tensor(3, 3)       ! symmetric
         real(c_double), intent(out) :: moments(3)
         real(c_double), intent(out) :: axes(3, 3)        ! principal axes as rows: row-major in C
      end function poinsot_principal_axes

      integer(c_int) function poinsot_jacobi(n, u, m, m1, sn, cn, dn) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: u(*), m(*)
         type(c_ptr), value :: m1                         ! c_loc of real(c_double) :: m1(n), or
                                                          ! c_null_ptr
         real(c_double), intent(out) :: sn(*), cn(*), dn(*)
      end function poinsot_jacobi

      integer(c_int) function poinsot_jacobi_am(n, u, m, m1, am) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: u(*), m(*)
         type(c_ptr), value :: m1                         ! c_loc of m1(n), or c_null_ptr
         real(c_double), intent(out) :: am(*)
      end function poinsot_jacobi_am

      integer(c_int) function poinsot_elliptic_k(n, m, m1, k) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: m(*)
         type(c_ptr), value :: m1                         ! c_loc of m1(n), or c_null_ptr
         real(c_double), intent(out) :: k(*)
      end function poinsot_elliptic_k

      integer(c_int) function poinsot_elliptic_e(n, m, m1, e) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: m(*)
         type(c_ptr), value :: m1                         ! c_loc of m1(n), or c_null_ptr
         real(c_double), intent(out) :: e(*)
      end function poinsot_elliptic_e

      integer(c_int) function poinsot_elliptic_pi(n, nu, m, m1, p) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: nu(*), m(*)
         type(c_ptr), value :: m1                         ! c_loc of m1(n), or c_null_ptr
         real(c_double), intent(out) :: p(*)
      end function poinsot_elliptic_pi

      integer(c_int) function poinsot_elliptic_f(n, phi, m, m1, f) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: phi(*), m(*)
         type(c_ptr), value :: m1                         ! c_loc of m1(n), or c_null_ptr
         real(c_double), intent(out) :: f(*)
      end function poinsot_elliptic_f

      integer(c_int) function poinsot_elliptic_e_incomplete(n, phi, m, m1, e) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: phi(*), m(*)
         type(c_ptr), value :: m1                         ! c_loc of m1(n), or c_null_ptr
         real(c_double), intent(out) :: e(*)
      end function poinsot_elliptic_e_incomplete

      integer(c_int) function poinsot_elliptic_pi_incomplete(n, nu, phi, m, m1, p) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: nu(*), phi(*), m(*)
         type(c_ptr), value :: m1                         ! c_loc of m1(n), or c_null_ptr
         real(c_double), intent(out) :: p(*)
      end function poinsot_elliptic_pi_incomplete

      integer(c_int) function poinsot_carlson_rf(n, x, y, z, r) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: x(*), y(*), z(*)
         real(c_double), intent(out) :: r(*)
      end function poinsot_carlson_rf

      integer(c_int) function poinsot_carlson_rc(n, x, y, r) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: x(*), y(*)
         real(c_double), intent(out) :: r(*)
      end function poinsot_carlson_rc

      integer(c_int) function poinsot_carlson_rd(n, x, y, z, r) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: x(*), y(*), z(*)
         real(c_double), intent(out) :: r(*)
      end function poinsot_carlson_rd

      integer(c_int) function poinsot_carlson_rj(n, x, y, z, p, r) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: x(*), y(*), z(*), p(*)
         real(c_double), intent(out) :: r(*)
      end function poinsot_carlson_rj

      integer(c_int) function poinsot_quaternion_multiply(n, p, q, r) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: p(4, *), q(4, *)
         real(c_double), intent(out) :: r(4, *)
      end function poinsot_quaternion_multiply

      integer(c_int) function poinsot_quaternion_conjugate(n, q, r) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: q(4, *)
         real(c_double), intent(out) :: r(4, *)
      end function poinsot_quaternion_conjugate

      integer(c_int) function poinsot_quaternion_inverse(n, q, r) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: q(4, *)
         real(c_double), intent(out) :: r(4, *)
      end function poinsot_quaternion_inverse

      integer(c_int) function poinsot_quaternion_normalize(n, q, r) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: q(4, *)
         real(c_double), intent(out) :: r(4, *)
      end function poinsot_quaternion_normalize

      integer(c_int) function poinsot_quaternion_exp(n, q, r) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: q(4, *)
         real(c_double), intent(out) :: r(4, *)
      end function poinsot_quaternion_exp

      integer(c_int) function poinsot_quaternion_log(n, q, r) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: q(4, *)
         real(c_double), intent(out) :: r(4, *)
      end function poinsot_quaternion_log

      integer(c_int) function poinsot_quaternion_rotate(n, q, v, w) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: q(4, *), v(3, *)
         real(c_double), intent(out) :: w(3, *)
      end function poinsot_quaternion_rotate

      integer(c_int) function poinsot_quaternion_rotate_back(n, q, v, w) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: q(4, *), v(3, *)
         real(c_double), intent(out) :: w(3, *)
      end function poinsot_quaternion_rotate_back

      integer(c_int) function poinsot_quaternion_to_matrix(n, q, m) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: q(4, *)
         real(c_double), intent(out) :: m(9, *)
      end function poinsot_quaternion_to_matrix

      integer(c_int) function poinsot_quaternion_from_matrix(n, m, q) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: m(9, *)
         real(c_double), intent(out) :: q(4, *)
      end function poinsot_quaternion_from_matrix

      integer(c_int) function poinsot_quaternion_nearest(n, m, q) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: m(9, *)
         real(c_double), intent(out) :: q(4, *)
      end function poinsot_quaternion_nearest

      integer(c_int) function poinsot_quaternion_from_rotation_vector(n, v, q) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: v(3, *)
         real(c_double), intent(out) :: q(4, *)
      end function poinsot_quaternion_from_rotation_vector

      integer(c_int) function poinsot_quaternion_to_rotation_vector(n, q, v) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: q(4, *)
         real(c_double), intent(out) :: v(3, *)
      end function poinsot_quaternion_to_rotation_vector

      integer(c_int) function poinsot_quaternion_from_axis_angle(n, axis, angle, q) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: axis(3, *), angle(*)
         real(c_double), intent(out) :: q(4, *)
      end function poinsot_quaternion_from_axis_angle

      integer(c_int) function poinsot_quaternion_to_axis_angle(n, q, axis, angle) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: q(4, *)
         real(c_double), intent(out) :: axis(3, *), angle(*)
      end function poinsot_quaternion_to_axis_angle

      integer(c_int) function poinsot_quaternion_from_cayley(n, e, q) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: e(3, *)
         real(c_double), intent(out) :: q(4, *)
      end function poinsot_quaternion_from_cayley

      integer(c_int) function poinsot_quaternion_to_cayley(n, q, e) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: q(4, *)
         real(c_double), intent(out) :: e(3, *)
      end function poinsot_quaternion_to_cayley

      integer(c_int) function poinsot_quaternion_from_euler(n, convention, angles, q) bind(c)
         import
         integer(c_size_t), value :: n
         character(kind=c_char), intent(in) :: convention(*)
         real(c_double), intent(in) :: angles(3, *)
         real(c_double), intent(out) :: q(4, *)
      end function poinsot_quaternion_from_euler

      integer(c_int) function poinsot_quaternion_to_euler(n, convention, q, angles) bind(c)
         import
         integer(c_size_t), value :: n
         character(kind=c_char), intent(in) :: convention(*)
         real(c_double), intent(in) :: q(4, *)
         real(c_double), intent(out) :: angles(3, *)
      end function poinsot_quaternion_to_euler

      integer(c_int) function poinsot_quaternion_slerp(n, p, q, t, r) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: p(4, *), q(4, *), t(*)
         real(c_double), intent(out) :: r(4, *)
      end function poinsot_quaternion_slerp

      integer(c_int) function poinsot_quaternion_shortest_arc(n, a, b, q) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: a(3, *), b(3, *)
         real(c_double), intent(out) :: q(4, *)
      end function poinsot_quaternion_shortest_arc

      integer(c_int) function poinsot_quaternion_distance(n, p, q, d) bind(c)
         import
         integer(c_size_t), value :: n
         real(c_double), intent(in) :: p(4, *), q(4, *)
         real(c_double), intent(out) :: d(*)
      end function poinsot_quaternion_distance

      integer(c_int) function poinsot_quaternion_random(n, seed, q) bind(c)
         import
         integer(c_size_t), value :: n
         integer(c_int64_t), value :: seed
         real(c_double), intent(out) :: q(4, *)
      end function poinsot_quaternion_random

      integer(c_int) function poinsot_bodies_rows_sized(bodies, size, layout, order, n, momentum, &
            attitude) bind(c)
         import
         type(poinsot_bodies), intent(inout) :: bodies
         integer(c_size_t), value :: size, n
         character(kind=c_char), intent(in) :: layout(*), order(*)
         type(c_ptr), value :: momentum, attitude         ! c_loc of arrays that stay where they are
      end function poinsot_bodies_rows_sized

      integer(c_int) function poinsot_bodies_arrays_sized(bodies, size, layout, n, momentum, &
            attitude) bind(c)
         import
         type(poinsot_bodies), intent(inout) :: bodies
         integer(c_size_t), value :: size, n
         character(kind=c_char), intent(in) :: layout(*)
         type(c_ptr), intent(in) :: momentum(*), attitude(4)
      end function poinsot_bodies_arrays_sized

      integer(c_int) function poinsot_plan_create(plan) bind(c)
         import
         type(c_ptr), intent(out) :: plan
      end function poinsot_plan_create

      subroutine poinsot_plan_destroy(plan) bind(c)
         import
         type(c_ptr), intent(inout) :: plan
      end subroutine poinsot_plan_destroy

      integer(c_int) function poinsot_plan_add_class(plan, moments, number) bind(c)
         import
         type(c_ptr), value :: plan
         real(c_double), intent(in) :: moments(3)
         integer(c_int), intent(inout) :: number
      end function poinsot_plan_add_class

      integer(c_int) function poinsot_plan_find_class(plan, moments, tolerance, number) bind(c)
         import
         type(c_ptr), value :: plan
         real(c_double), intent(in) :: moments(3)
         real(c_double), value :: tolerance
         integer(c_int), intent(inout) :: number
      end function poinsot_plan_find_class

      integer(c_int) function poinsot_plan_add_class_tensor(plan, inertia, number) bind(c)
         import
         type(c_ptr), value :: plan
         real(c_double), intent(in) :: inertia(3, 3)
         integer(c_int), intent(inout) :: number
      end function poinsot_plan_add_class_tensor

      integer(c_int) function poinsot_plan_class_axes(plan, number, axes) bind(c)
         import
         type(c_ptr), value :: plan
         integer(c_int), value :: number
         real(c_double), intent(inout) :: axes(3, 3)
      end function poinsot_plan_class_axes

      integer(c_int) function poinsot_plan_set(plan, option, value) bind(c)
         import
         type(c_ptr), value :: plan
         character(kind=c_char), intent(in) :: option(*), value(*)
      end function poinsot_plan_set

      integer(c_int) function poinsot_plan_add_effect(plan, name, settings) bind(c)
         import
         type(c_ptr), value :: plan
         character(kind=c_char), intent(in) :: name(*), settings(*)
      end function poinsot_plan_add_effect

      integer(c_int) function poinsot_plan_ready(plan) bind(c)
         import
         type(c_ptr), value :: plan
      end function poinsot_plan_ready

      integer(c_size_t) function poinsot_plan_message(plan, buffer, capacity) bind(c)
         import
         type(c_ptr), value :: plan
         character(kind=c_char), intent(inout) :: buffer(*)
         integer(c_size_t), value :: capacity
      end function poinsot_plan_message

      integer(c_int) function poinsot_bodies_check(plan, bodies, buffer, capacity) bind(c)
         import
         type(c_ptr), value :: plan
         type(poinsot_bodies), intent(in) :: bodies
         character(kind=c_char), intent(inout) :: buffer(*)
         integer(c_size_t), value :: capacity
      end function poinsot_bodies_check

      integer(c_int) function poinsot_drift(plan, bodies, h) bind(c)
         import
         type(c_ptr), value :: plan
         type(poinsot_bodies), intent(in) :: bodies
         real(c_double), value :: h
      end function poinsot_drift

      integer(c_int) function poinsot_kick(plan, bodies, h, torque, stride) bind(c)
         import
         type(c_ptr), value :: plan
         type(poinsot_bodies), intent(in) :: bodies
         real(c_double), value :: h
         type(c_ptr), intent(in) :: torque(3)
         integer(c_intptr_t), value :: stride
      end function poinsot_kick

      integer(c_int) function poinsot_dissipate(plan, bodies, h, step) bind(c)
         import
         type(c_ptr), value :: plan
         type(poinsot_bodies), intent(in) :: bodies
         real(c_double), value :: h
         integer(c_int64_t), value :: step
      end function poinsot_dissipate

      integer(c_int) function poinsot_step(plan, bodies, t, h, first, steps, callback, context) &
         bind(c)
         import
         type(c_ptr), value :: plan
         type(poinsot_bodies), intent(in) :: bodies
         real(c_double), value :: t, h
         integer(c_int64_t), value :: first, steps
         type(c_funptr), value :: callback                ! c_funloc of a bind(c) function, or
                                                          ! c_null_funptr
         type(c_ptr), value :: context
      end function poinsot_step

      integer(c_int) function poinsot_energy(plan, bodies, t, kinetic, potential) bind(c)
         import
         type(c_ptr), value :: plan
         type(poinsot_bodies), intent(in) :: bodies
         real(c_double), value :: t
         real(c_double), intent(inout) :: kinetic(*), potential(*)
      end function poinsot_energy

      integer(c_int) function poinsot_momentum(plan, bodies, momentum) bind(c)
         import
         type(c_ptr), value :: plan
         type(poinsot_bodies), intent(in) :: bodies
         real(c_double), intent(inout) :: momentum(3, *)
      end function poinsot_momentum

      integer(c_int) function poinsot_degrees_of_freedom(plan, bodies, count) bind(c)
         import
         type(c_ptr), value :: plan
         type(poinsot_bodies), intent(in) :: bodies
         integer(c_size_t), intent(inout) :: count
      end function poinsot_degrees_of_freedom
   end interface

contains

   integer(c_int) function poinsot_bodies_rows(bodies, layout, order, n, momentum, attitude)
      type(poinsot_bodies), intent(inout) :: bodies
      character(kind=c_char), intent(in) :: layout(*), order(*)
      integer(c_size_t), value :: n
      type(c_ptr), value :: momentum, attitude            ! c_loc of arrays that stay where they are
      poinsot_bodies_rows = poinsot_bodies_rows_sized(bodies, c_sizeof(bodies), layout, order, n, &
                                                      momentum, attitude)
   end function poinsot_bodies_rows

   integer(c_int) function poinsot_bodies_arrays(bodies, layout, n, momentum, attitude)
      type(poinsot_bodies), intent(inout) :: bodies
      character(kind=c_char), intent(in) :: layout(*)
      integer(c_size_t), value :: n
      type(c_ptr), intent(in) :: momentum(*), attitude(4)
      poinsot_bodies_arrays = poinsot_bodies_arrays_sized(bodies, c_sizeof(bodies), layout, n, &
                                                          momentum, attitude)
   end function poinsot_bodies_arrays

end module poinsot_interface
