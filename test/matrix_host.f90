!> The host's own torque in the matrix of entries, a top's, U = (Q^T z).centre, as each way in asks
!> for it; and the momentum variables of hosts.
module test_matrix_host
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_intptr_t, c_ptr, c_size_t, &
      c_f_pointer
   use poinsot, only: poinsot_torque
   use poinsot_core_kinds, only: dp
   use test_matrix_problem, only: problem, n, steps, h, tensor_of, total_rotor
   use test_oracle_algebra, only: cross, quaternion_product, rotate, rotate_back
   implicit none(type, external)
   private
   public :: top_data, fortran_top, c_top, fixed_top, fixed_data, momentum_names, to_variable, &
      from_variable

   character(18), parameter :: momentum_names(5) = [character(18) :: "body-momentum", &
      "space-momentum", "body-velocity", "space-velocity", "conjugate-momentum"]

   type, bind(c) :: top_data
      real(c_double) :: centre(3)
      integer(c_int) :: in_space
   end type top_data

   type, extends(poinsot_torque) :: fortran_top
      type(top_data) :: data
   contains
      procedure :: evaluate
   end type fortran_top

   type(top_data) :: fixed_data   !! fixed form has no context: a common block there

contains

   pure function torque_of(this, q) result(torque)
      type(top_data), intent(in) :: this
      real(dp), intent(in) :: q(4)
      real(dp) :: torque(3)
      torque = cross(rotate_back(q, [0.0_dp, 0.0_dp, 1.0_dp]), this%centre)
      if (this%in_space /= 0) torque = rotate(q, torque)
   end function torque_of

   subroutine evaluate(self, t, q, torque, energy, stop)
      class(fortran_top), intent(inout) :: self
      real(dp), intent(in) :: t
      real(dp), intent(in), target :: q(:, :)
      real(dp), intent(inout), target :: torque(:, :)
      real(dp), intent(inout) :: energy
      logical, intent(inout) :: stop
      integer :: i
      do i = 1, size(q, 1)
         torque(i, :) = torque_of(self%data, q(i, :))
      end do
      energy = 0*t
      stop = .false.
   end subroutine evaluate

   integer(c_int) function c_top(context, t, bodies, q, q_stride, torque, torque_stride, energy) &
         bind(c) result(stop)
      type(c_ptr), value :: context
      real(c_double), value :: t
      integer(c_size_t), value :: bodies
      integer(c_intptr_t), value :: q_stride, torque_stride
      type(c_ptr), intent(in) :: q(4), torque(3)
      real(c_double), intent(inout) :: energy
      type(top_data), pointer :: data
      real(c_double), pointer :: from(:), to(:)
      real(dp) :: attitude(4), g(3)
      integer :: i, j
      call c_f_pointer(context, data)
      do i = 1, int(bodies)
         do j = 1, 4
            call c_f_pointer(q(j), from, [bodies*q_stride])
            attitude(j) = from(1 + (i - 1)*q_stride)
         end do
         g = torque_of(data, attitude)
         do j = 1, 3
            call c_f_pointer(torque(j), to, [bodies*torque_stride])
            to(1 + (i - 1)*torque_stride) = g(j)
         end do
      end do
      energy = 0*t
      stop = 0
   end function c_top

   subroutine fixed_top(t, bodies, q, torque, stop)
      real(dp), intent(in) :: t
      integer, intent(in) :: bodies
      real(dp), intent(in) :: q(bodies, 4)
      real(dp), intent(inout) :: torque(bodies, 3)
      integer, intent(inout) :: stop
      integer :: i
      do i = 1, bodies
         torque(i, :) = torque_of(fixed_data, q(i, :)) + 0*t
      end do
      stop = 0
   end subroutine fixed_top

   !> The variable of the host, in 3 or 4 rows of p.
   function to_variable(this, form, y, q) result(p)
      type(problem), intent(in) :: this
      integer, intent(in) :: form
      real(dp), intent(in) :: y(3, n), q(4, n)
      real(dp) :: p(4, n)
      integer :: i, c
      do i = 1, n
         c = i
         p(:, i) = [y(:, i), 0.0_dp]
         select case (form)
         case (1)
            cycle
         case (2)
            p(:3, i) = rotate(q(:, i), y(:, i))
         case (3, 4)
            p(:3, i) = matmul(tensor_of(this, c, -1), y(:, i) - &
               total_rotor(this, c, 0.0_dp, 0.0_dp))
            if (form == 4) p(:3, i) = rotate(q(:, i), p(:3, i))
         case default
            p(:, i) = 2*quaternion_product(q(:, i), [0.0_dp, y(:, i)])
         end select
      end do
   end function to_variable

   !> At the end of the steps.
   function from_variable(this, form, p, q) result(y)
      type(problem), intent(in) :: this
      integer, intent(in) :: form
      real(dp), intent(in) :: p(4, n), q(4, n)
      real(dp), parameter :: end = steps*h
      real(dp) :: y(3, n), w(4)
      integer :: i, c
      do i = 1, n
         c = i
         y(:, i) = p(:3, i)
         select case (form)
         case (1)
            cycle
         case (2)
            y(:, i) = rotate_back(q(:, i), y(:, i))
         case (3, 4)
            if (form == 4) y(:, i) = rotate_back(q(:, i), y(:, i))
            y(:, i) = matmul(tensor_of(this, c, 1), y(:, i)) + total_rotor(this, c, end, end - h/2)
         case default
            w = quaternion_product([q(1, i), -q(2:, i)], p(:, i))/2
            y(:, i) = w(2:)
         end select
      end do
   end function from_variable

end module test_matrix_host
