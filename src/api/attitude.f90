!> Implementation of the C functions that convert attitudes, on rows: matrix, rotation vector, axis
!> and angle, Cayley vector, Euler angles. See include/poinsot.h and cpu_check.c.
module poinsot_api_attitude
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_ptr, c_size_t
   use poinsot_api_arrays, only: check_arrays, give
   use poinsot_api_text, only: from_c
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, clear, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_method, poinsot_e_null
   use poinsot_rotation_conversions, only: attitude_of_euler, euler_axes, euler_of_attitude, &
      from_axis_angle, from_cayley, from_matrix, from_rotation_vector, to_axis_angle, to_cayley, &
      to_matrix, to_rotation_vector
   use poinsot_rotation_nearest, only: check_rotation, nearest_rotation
   use poinsot_rotation_quaternion, only: identity_quaternion, is_attitude
   implicit none(type, external)
   private

   real(dp), parameter :: longest = 1e308_dp !! component of a rotation vector

contains

   !> Rotation matrices, row-major.
   integer(c_int) function to_matrices(n, q, m) bind(c, name="poinsot_do_quaternion_to_matrix") &
      result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: q(4, *)
      real(c_double), intent(inout), optional, target :: m(9, *)
      real(dp) :: x(9)
      integer(c_size_t) :: i
      logical :: good
      status = check_arrays(n, present(q) .and. present(m))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = is_attitude(q(:, i))
         if (good) x = reshape(transpose(to_matrix(q(:, i))), [9])
         call give(x, good, m(:, i), status)
      end do
   end function to_matrices

   !> Attitudes of rotation matrices.
   integer(c_int) function from_matrices(n, m, q) &
      bind(c, name="poinsot_do_quaternion_from_matrix") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: m(9, *)
      real(c_double), intent(inout), optional, target :: q(4, *)
      status = read_matrices(n, m, q, .false.)
   end function from_matrices

   !> Attitudes of the rotations nearest to matrices.
   integer(c_int) function nearest_attitudes(n, m, q) &
      bind(c, name="poinsot_do_quaternion_nearest") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: m(9, *)
      real(c_double), intent(inout), optional, target :: q(4, *)
      status = read_matrices(n, m, q, .true.)
   end function nearest_attitudes

   integer(c_int) function read_matrices(n, m, q, any_matrix) result(status)
      integer(c_size_t), intent(in) :: n
      real(c_double), intent(in), optional, target :: m(9, *)
      real(c_double), intent(inout), optional, target :: q(4, *)
      logical, intent(in) :: any_matrix !! not only rotations
      type(poinsot_error) :: error
      real(dp) :: matrix(3, 3), rotation(3, 3), x(4)
      integer(c_size_t) :: i
      status = check_arrays(n, present(m) .and. present(q))
      if (status /= poinsot_ok) return
      do i = 1, n
         call clear(error)
         x = identity_quaternion
         matrix = transpose(reshape(m(:, i), [3, 3]))
         if (any_matrix) then
            call nearest_rotation(matrix, rotation, error)
         else
            rotation = matrix
            call check_rotation(matrix, error)
         end if
         if (.not. raised(error)) x = from_matrix(rotation)
         call give(x, .not. raised(error), q(:, i), status)
      end do
   end function read_matrices

   !> Attitudes of rotation vectors.
   integer(c_int) function from_vectors(n, v, q) &
      bind(c, name="poinsot_do_quaternion_from_rotation_vector") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: v(3, *)
      real(c_double), intent(inout), optional, target :: q(4, *)
      real(dp) :: x(4)
      integer(c_size_t) :: i
      logical :: good
      status = check_arrays(n, present(v) .and. present(q))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = all(ieee_is_finite(v(:, i)))
         if (good) good = maxval(abs(v(:, i))) <= longest
         if (good) x = from_rotation_vector(v(:, i))
         call give(x, good, q(:, i), status)
      end do
   end function from_vectors

   !> Rotation vectors, of length at most pi.
   integer(c_int) function to_vectors(n, q, v) &
      bind(c, name="poinsot_do_quaternion_to_rotation_vector") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: q(4, *)
      real(c_double), intent(inout), optional, target :: v(3, *)
      real(dp) :: x(3)
      integer(c_size_t) :: i
      logical :: good
      status = check_arrays(n, present(q) .and. present(v))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = is_attitude(q(:, i))
         if (good) x = to_rotation_vector(q(:, i))
         call give(x, good, v(:, i), status)
      end do
   end function to_vectors

   !> Turns by angles about axes.
   integer(c_int) function from_axes(n, axis, angle, q) &
      bind(c, name="poinsot_do_quaternion_from_axis_angle") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: axis(3, *), angle(*)
      real(c_double), intent(inout), optional, target :: q(4, *)
      type(poinsot_error) :: error
      real(dp) :: x(4)
      integer(c_size_t) :: i
      status = check_arrays(n, present(axis) .and. present(angle) .and. present(q))
      if (status /= poinsot_ok) return
      do i = 1, n
         call clear(error)
         call from_axis_angle(axis(:, i), angle(i), x, error)
         call give(x, .not. raised(error), q(:, i), status)
      end do
   end function from_axes

   !> Axes and angles, these in [0, pi].
   integer(c_int) function to_axes(n, q, axis, angle) &
      bind(c, name="poinsot_do_quaternion_to_axis_angle") result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: q(4, *)
      real(c_double), intent(inout), optional, target :: axis(3, *), angle(*)
      real(dp) :: x(3), turn
      integer(c_size_t) :: i
      logical :: good
      status = check_arrays(n, present(q) .and. present(axis) .and. present(angle))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         turn = 0
         good = is_attitude(q(:, i))
         if (good) call to_axis_angle(q(:, i), x, turn)
         call give(x, good, axis(:, i), status)
         call give(turn, good, angle(i), status)
      end do
   end function to_axes

   !> Attitudes of Cayley vectors.
   integer(c_int) function from_cayleys(n, e, q) bind(c, name="poinsot_do_quaternion_from_cayley") &
      result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: e(3, *)
      real(c_double), intent(inout), optional, target :: q(4, *)
      real(dp) :: x(4)
      integer(c_size_t) :: i
      logical :: good
      status = check_arrays(n, present(e) .and. present(q))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = all(ieee_is_finite(e(:, i)))
         if (good) x = from_cayley(e(:, i))
         call give(x, good, q(:, i), status)
      end do
   end function from_cayleys

   !> Cayley vectors; a half-turn has none.
   integer(c_int) function to_cayleys(n, q, e) bind(c, name="poinsot_do_quaternion_to_cayley") &
      result(status)
      integer(c_size_t), value :: n
      real(c_double), intent(in), optional, target :: q(4, *)
      real(c_double), intent(inout), optional, target :: e(3, *)
      type(poinsot_error) :: error
      real(dp) :: x(3)
      integer(c_size_t) :: i
      logical :: good
      status = check_arrays(n, present(q) .and. present(e))
      if (status /= poinsot_ok) return
      do i = 1, n
         call clear(error)
         x = 0
         good = is_attitude(q(:, i))
         if (good) call to_cayley(q(:, i), x, error)
         call give(x, good .and. .not. raised(error), e(:, i), status)
      end do
   end function to_cayleys

   !> Attitudes of Euler angles.
   integer(c_int) function from_eulers(n, convention, angles, q) &
      bind(c, name="poinsot_do_quaternion_from_euler") result(status)
      integer(c_size_t), value :: n
      type(c_ptr), value :: convention !! const char *
      real(c_double), intent(in), optional, target :: angles(3, *)
      real(c_double), intent(inout), optional, target :: q(4, *)
      real(dp) :: x(4)
      integer(c_size_t) :: i
      integer :: axes(3)
      logical :: good
      call read_convention(convention, axes, status)
      if (status == poinsot_ok) status = check_arrays(n, present(angles) .and. present(q))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = all(ieee_is_finite(angles(:, i)))
         if (good) x = attitude_of_euler(axes, angles(:, i))
         call give(x, good, q(:, i), status)
      end do
   end function from_eulers

   !> Euler angles of attitudes.
   integer(c_int) function to_eulers(n, convention, q, angles) &
      bind(c, name="poinsot_do_quaternion_to_euler") result(status)
      integer(c_size_t), value :: n
      type(c_ptr), value :: convention !! const char *
      real(c_double), intent(in), optional, target :: q(4, *)
      real(c_double), intent(inout), optional, target :: angles(3, *)
      real(dp) :: x(3)
      integer(c_size_t) :: i
      integer :: axes(3)
      logical :: good
      call read_convention(convention, axes, status)
      if (status == poinsot_ok) status = check_arrays(n, present(q) .and. present(angles))
      if (status /= poinsot_ok) return
      do i = 1, n
         x = 0
         good = is_attitude(q(:, i))
         if (good) x = euler_of_attitude(axes, q(:, i))
         call give(x, good, angles(:, i), status)
      end do
   end function to_eulers

   !> A convention as numbers of axes.
   subroutine read_convention(convention, axes, status)
      type(c_ptr), intent(in) :: convention
      integer, intent(out) :: axes(3)
      integer(c_int), intent(out) :: status
      character(:), allocatable :: text
      axes = 0
      status = poinsot_e_null
      if (.not. c_associated(convention)) return
      call from_c(convention, text)
      axes = euler_axes(text)
      status = merge(poinsot_ok, poinsot_e_method, axes(1) /= 0)
   end subroutine read_convention

end module poinsot_api_attitude
