!> Invariants of a free body: kinetic energy, Casimir, angular momentum in space; and the number of
!> its degrees of freedom.
!>
!> A zero moment means an axis without rotation: 1/I counts as 0 there.
module poinsot_body_invariants
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_e_domain
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_rotation_quaternion, only: rotate
   implicit none(type, external)
   private
   public :: check_momentum, angular_velocity, kinetic_energy, casimir, space_momentum, &
      degrees_of_freedom

contains

   !> Refuse an angular momentum that is not finite, or not zero about an axis whose moment is zero.
   pure subroutine check_momentum(moments, y, error)
      real(dp), intent(in) :: moments(3)          !! as `check_moments` allows
      real(dp), intent(in) :: y(3)                !! angular momentum, body frame
      type(poinsot_error), intent(inout) :: error !! poinsot_e_domain
      integer :: i
      do i = 1, 3
         if (.not. ieee_is_finite(y(i))) then
            call raise(error, poinsot_e_domain, &
               "angular momentum: y"//achar(iachar("0") + i)//" is not finite")
            return
         else if (moments(i) <= 0 .and. abs(y(i)) > 0) then
            call raise(error, poinsot_e_domain, "angular momentum: y"//achar(iachar("0") + i)// &
               " is not zero but the moment of inertia about that axis is; it must be zero too")
            return
         end if
      end do
   end subroutine check_momentum

   !> omega = y/I in the body frame, 0 about an axis whose moment is zero.
   pure function angular_velocity(moments, y) result(omega)
      real(dp), intent(in) :: moments(3) !! as `check_moments` allows
      real(dp), intent(in) :: y(3)       !! angular momentum, body frame
      real(dp) :: omega(3)
      integer :: i
      omega = 0
      do i = 1, 3
         if (moments(i) > 0) omega(i) = y(i)/moments(i)
      end do
   end function angular_velocity

   !> H = sum of y_j^2/(2 I_j) (Vilmart's review, equation 6), formed as y (y/I)/2: no square leaves
   !> the range before the energy does.
   pure real(dp) function kinetic_energy(moments, y)
      real(dp), intent(in) :: moments(3) !! as `check_moments` allows
      real(dp), intent(in) :: y(3)       !! angular momentum, body frame
      kinetic_energy = sum(y*angular_velocity(moments, y))/2
   end function kinetic_energy

   !> C = |y|^2/2 (Vilmart's review, equation 5). huge where it is not representable (|y| beyond
   !> 1e154).
   pure real(dp) function casimir(y)
      real(dp), intent(in) :: y(3) !! angular momentum, either frame
      casimir = huge(casimir)
      if (maxval(abs(y)) < sqrt(huge(casimir)/2)) casimir = sum(y**2)/2
   end function casimir

   !> Q y, the angular momentum in the space frame: constant when no torque acts.
   pure function space_momentum(y, q) result(momentum)
      real(dp), intent(in) :: y(3) !! angular momentum, body frame
      real(dp), intent(in) :: q(4) !! attitude, unit
      real(dp) :: momentum(3)
      momentum = rotate(q, y)
   end function space_momentum

   !> Rotational degrees of freedom, as a thermostat counts them: 3, or 2 for a linear body, or 0
   !> for a point.
   pure integer function degrees_of_freedom(moments)
      real(dp), intent(in) :: moments(3) !! zero or positive
      degrees_of_freedom = count(moments > 0)
   end function degrees_of_freedom

end module poinsot_body_invariants
