!> A user's own torque: extend one of two types and provide one procedure for one body.
!>
!> `user_torque`: the body torque itself. `user_potential`: U and dU/dQ (3 x 3); the body torque is
!> -rot(Q^T dU/dQ), equation (8) of the review. Both are called in the frame in which the class was
!> given to the plan. For whole blocks, in principal frames, extend torque_effect instead. A scheme
!> with force gradients needs `add_derivative` and `has_gradient`, which a user may override.
module poinsot_effect_callback
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_body_class, only: body_class
   use poinsot_effect_effect, only: torque_effect
   use poinsot_effect_row, only: effect_label, effect_row
   use poinsot_rotation_quaternion, only: quaternion_product, quaternion_conjugate, &
      rotate_back
   implicit none(type, external)
   private
   public :: user_torque, user_potential, callback_label, callback_row, torque_of_gradient

   type(effect_label), parameter :: callback_label = effect_label("callback", 10)

   !> Torque and energy of one body from its attitude as a quaternion.
   type, abstract, extends(torque_effect) :: user_torque
   contains
      procedure(evaluate_torque), deferred :: evaluate
      procedure :: add_torque => add_user_torque
      procedure :: add_energy => add_user_energy
   end type user_torque

   !> Potential of one body and its derivative by the nine components of Q.
   type, abstract, extends(torque_effect) :: user_potential
   contains
      procedure(evaluate_potential), deferred :: evaluate
      procedure :: add_torque => add_potential_torque
      procedure :: add_energy => add_potential_energy
   end type user_potential

   abstract interface
      subroutine evaluate_torque(self, t, q, torque, energy)
         import :: user_torque, dp
         implicit none(type, external)
         class(user_torque), intent(in) :: self
         real(dp), intent(in) :: t             !! time
         real(dp), intent(in) :: q(4)          !! attitude, scalar first, given body frame -> space
         real(dp), intent(out) :: torque(3)    !! in the given body frame
         real(dp), intent(out) :: energy       !! potential energy, 0 if there is none
      end subroutine evaluate_torque

      subroutine evaluate_potential(self, t, attitude, energy, gradient)
         import :: user_potential, dp
         implicit none(type, external)
         class(user_potential), intent(in) :: self
         real(dp), intent(in) :: t
         real(dp), intent(in) :: attitude(3, 3)   !! Q: x_space = matmul(Q, x_body)
         real(dp), intent(out) :: energy          !! U(Q)
         real(dp), intent(out) :: gradient(3, 3)  !! dU/dQ, component by component
      end subroutine evaluate_potential
   end interface

contains

   !> Its row in the registry.
   function callback_row() result(row)
      type(effect_row) :: row
      row%info%name = callback_label%name
      row%info%formula = "a program's own torque, or U and dU/dQ: torque = -rot(Q^T dU/dQ)"
      row%info%check = "the heavy top through the callback"
      row%info%gradient = .false.
      allocate (row%info%keys(0))
   end function callback_row

   !> -rot(Q^T dU/dQ), where hat(rot M) = M - M^T (review, equation (8)).
   pure function torque_of_gradient(attitude, gradient) result(torque)
      real(dp), intent(in) :: attitude(3, 3)
      real(dp), intent(in) :: gradient(3, 3)
      real(dp) :: torque(3), m(3, 3)
      m = matmul(transpose(attitude), gradient)
      torque = -[m(3, 2) - m(2, 3), m(1, 3) - m(3, 1), m(2, 1) - m(1, 2)]
   end function torque_of_gradient

   subroutine add_user_torque(self, class, t, q, g)
      class(user_torque), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: g(lanes, 3)
      real(dp) :: torque(3), energy
      integer :: i
      do i = 1, lanes
         call self%evaluate(t, given(class, q(i, :)), torque, energy)
         g(i, :) = g(i, :) + principal(class, torque)
      end do
   end subroutine add_user_torque

   subroutine add_user_energy(self, class, t, q, u)
      class(user_torque), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: u(lanes)
      real(dp) :: torque(3), energy
      integer :: i
      do i = 1, lanes
         call self%evaluate(t, given(class, q(i, :)), torque, energy)
         u(i) = u(i) + energy
      end do
   end subroutine add_user_energy

   subroutine add_potential_torque(self, class, t, q, g)
      class(user_potential), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: g(lanes, 3)
      real(dp) :: attitude(3, 3), gradient(3, 3), energy
      integer :: i
      do i = 1, lanes
         attitude = matrix_of(given(class, q(i, :)))
         call self%evaluate(t, attitude, energy, gradient)
         g(i, :) = g(i, :) + principal(class, torque_of_gradient(attitude, gradient))
      end do
   end subroutine add_potential_torque

   subroutine add_potential_energy(self, class, t, q, u)
      class(user_potential), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: u(lanes)
      real(dp) :: gradient(3, 3), energy
      integer :: i
      do i = 1, lanes
         call self%evaluate(t, matrix_of(given(class, q(i, :))), energy, gradient)
         u(i) = u(i) + energy
      end do
   end subroutine add_potential_energy

   !> The attitude of the frame that a class was given in.
   pure function given(class, q) result(attitude)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: q(4)           !! of the principal frame
      real(dp) :: attitude(4)
      attitude = q
      if (class%turned) attitude = quaternion_product(q, quaternion_conjugate(class%axes))
   end function given

   !> A vector of that frame in the principal one.
   pure function principal(class, v) result(w)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: v(3)
      real(dp) :: w(3)
      w = v
      if (class%turned) w = rotate_back(class%axes, v)
   end function principal

   pure function matrix_of(q) result(a)
      real(dp), intent(in) :: q(4)
      real(dp) :: a(3, 3)
      a(1, :) = [1 - 2*(q(3)**2 + q(4)**2), 2*(q(2)*q(3) - q(1)*q(4)), 2*(q(2)*q(4) + q(1)*q(3))]
      a(2, :) = [2*(q(2)*q(3) + q(1)*q(4)), 1 - 2*(q(2)**2 + q(4)**2), 2*(q(3)*q(4) - q(1)*q(2))]
      a(3, :) = [2*(q(2)*q(4) - q(1)*q(3)), 2*(q(3)*q(4) + q(1)*q(2)), 1 - 2*(q(2)**2 + q(3)**2)]
   end function matrix_of

end module poinsot_effect_callback
