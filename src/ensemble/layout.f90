!> The momentum variables and body frames of other codes, converted to native ones and back, block
!> by block.
!>
!> Native: angular momentum y in the principal frame, attitude q from the principal frame to space.
!> See docs on conventions.
module poinsot_ensemble_layout
   use poinsot_core_kinds, only: dp, group, lanes
   use poinsot_body_class, only: body_class
   use poinsot_free_lane_moments, only: lane_moments
   implicit none(type, external)
   private
   public :: momentum_names, body_momentum, space_momentum, body_velocity, space_velocity, &
      conjugate_momentum
   public :: layout_names, layout_momentum, to_native, from_native, turn_to_body

   integer, parameter :: body_momentum = 1      !! angular momentum, body frame
   integer, parameter :: space_momentum = 2     !! angular momentum, space frame (LAMMPS)
   integer, parameter :: body_velocity = 3      !! angular velocity, body frame (DL_POLY, ESPResSo)
   integer, parameter :: space_velocity = 4     !! angular velocity, space frame (Bullet)
   integer, parameter :: conjugate_momentum = 5 !! 2 q o (0, y), four components (HOOMD, NO_SQUISH
                                                !! codes)
   character(20), parameter :: momentum_names(5) = [character(20) :: "body-momentum", &
      "space-momentum", &
                                                    "body-velocity", "space-velocity", &
                                                       "conjugate-momentum"]

   !> Layouts by name, and their momentum variables.
   character(8), parameter :: layout_names(4) = [character(8) :: "native", "lammps", "dl_poly", &
      "hoomd"]
   integer, parameter :: layout_momentum(4) = [body_momentum, space_momentum, body_velocity, &
      conjugate_momentum]

contains

   !> p, the caller's momentum variable, and q, from the caller's body frame -> y and q of the
   !> principal frame. A velocity is I^-1 (y - s), s the momentum of the class's rotors.
   pure subroutine to_native(momentum, turned, class, rotor, p, y, q, by_lane, nvec)
      integer, intent(in) :: momentum            !! one of the five variables
      logical, intent(in) :: turned              !! the caller's body frame is class%axes, not the
                                                 !! principal one
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: rotor(3)           !! s, at this time
      real(dp), intent(in) :: p(lanes, 4)
      real(dp), intent(inout) :: y(lanes, 3)
      real(dp), intent(inout) :: q(lanes, 4)
      type(lane_moments), intent(in), optional :: by_lane !! moments that are not those of the class
      integer, intent(in), optional :: nvec      !! groups of lanes to work on, instead of all
      real(dp) :: s(lanes, 4)
      integer :: l, j, n
      n = lanes
      if (present(nvec)) n = group*nvec
      select case (momentum)
      case (space_momentum, space_velocity)
         y(:n, :) = p(:n, 1:3)
         call rotate_back(n, q, y)
      case (conjugate_momentum)
         !GCC$ ivdep
         do l = 1, n
            y(l, 1) = 0.5_dp*(q(l, 1)*p(l, 2) - q(l, 2)*p(l, 1) - (q(l, 3)*p(l, 4) - q(l, 4)*p(l, &
               3)))
            y(l, 2) = 0.5_dp*(q(l, 1)*p(l, 3) - q(l, 3)*p(l, 1) - (q(l, 4)*p(l, 2) - q(l, 2)*p(l, &
               4)))
            y(l, 3) = 0.5_dp*(q(l, 1)*p(l, 4) - q(l, 4)*p(l, 1) - (q(l, 2)*p(l, 3) - q(l, 3)*p(l, &
               2)))
         end do
      case default
         y(:n, :) = p(:n, 1:3)
      end select
      if (turned) then
         s = spread(class%axes, 1, lanes)
         call rotate_back(n, s, y)
         call times(n, q, class%axes)
      end if
      if (momentum == body_velocity .or. momentum == space_velocity) then
         do j = 1, 3
            if (present(by_lane)) then
               y(:n, j) = y(:n, j)*by_lane%moments(:n, j)
            else
               y(:n, j) = y(:n, j)*class%moments(j)
            end if
            if (class%has_rotor) y(:n, j) = y(:n, j) + rotor(j)
         end do
      end if
   end subroutine to_native

   !> The inverse: y and q of the principal frame -> p and q of the caller.
   pure subroutine from_native(momentum, turned, class, rotor, y, q, p, by_lane, nvec)
      integer, intent(in) :: momentum
      logical, intent(in) :: turned
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: rotor(3)           !! s, at this time
      real(dp), intent(in) :: y(lanes, 3)
      real(dp), intent(inout) :: q(lanes, 4)
      real(dp), intent(inout) :: p(lanes, 4)
      type(lane_moments), intent(in), optional :: by_lane
      integer, intent(in), optional :: nvec      !! groups of lanes to work on, instead of all
      real(dp) :: s(lanes, 4), v(lanes, 3), back(4)
      integer :: l, j, n

      n = lanes
      if (present(nvec)) n = group*nvec
      v(:n, :) = y(:n, :)
      if (momentum == body_velocity .or. momentum == space_velocity) then
         do j = 1, 3
            if (class%has_rotor) v(:n, j) = v(:n, j) - rotor(j)
            if (present(by_lane)) then
               v(:n, j) = v(:n, j)*by_lane%inverse(:n, j)
            else
               v(:n, j) = v(:n, j)*class%inverse(j)
            end if
         end do
      end if
      if (turned) then
         back = [class%axes(1), -class%axes(2:4)]
         s = spread(back, 1, lanes)
         call rotate_back(n, s, v)
         call times(n, q, back)
      end if
      p(:n, 4) = 0
      select case (momentum)
      case (space_momentum, space_velocity)
         s(:n, 1) = q(:n, 1)
         s(:n, 2:4) = -q(:n, 2:4)
         call rotate_back(n, s, v)
         p(:n, 1:3) = v(:n, :)
      case (conjugate_momentum)
         !GCC$ ivdep
         do l = 1, n
            p(l, 1) = -2*(q(l, 2)*v(l, 1) + q(l, 3)*v(l, 2) + q(l, 4)*v(l, 3))
            p(l, 2) = 2*(q(l, 1)*v(l, 1) + q(l, 3)*v(l, 3) - q(l, 4)*v(l, 2))
            p(l, 3) = 2*(q(l, 1)*v(l, 2) + q(l, 4)*v(l, 1) - q(l, 2)*v(l, 3))
            p(l, 4) = 2*(q(l, 1)*v(l, 3) + q(l, 2)*v(l, 2) - q(l, 3)*v(l, 1))
         end do
      case default
         p(:n, 1:3) = v(:n, :)
      end select
   end subroutine from_native

   !> A vector of the host, in space or in the caller's body frame, in the principal frame.
   pure subroutine turn_to_body(space, turned, class, q, v)
      logical, intent(in) :: space               !! it is in the space frame
      logical, intent(in) :: turned              !! the caller's body frame is class%axes
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: q(lanes, 4)        !! attitude of the principal frame
      real(dp), intent(inout) :: v(lanes, 3)
      if (space) then
         call rotate_back(lanes, q, v)
      else if (turned) then
         call rotate_back(lanes, spread(class%axes, 1, lanes), v)
      end if
   end subroutine turn_to_body

   !> v = Q^T v, lane by lane.
   pure subroutine rotate_back(n, q, v)
      integer, intent(in) :: n                   !! lanes, whole groups
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: v(lanes, 3)
      real(dp) :: t1, t2, t3, v1, v2, v3
      integer :: l
      !GCC$ ivdep
      do l = 1, n
         v1 = v(l, 1)
         v2 = v(l, 2)
         v3 = v(l, 3)
         t1 = 2*(q(l, 3)*v3 - q(l, 4)*v2)
         t2 = 2*(q(l, 4)*v1 - q(l, 2)*v3)
         t3 = 2*(q(l, 2)*v2 - q(l, 3)*v1)
         v(l, 1) = v1 - q(l, 1)*t1 + (q(l, 3)*t3 - q(l, 4)*t2)
         v(l, 2) = v2 - q(l, 1)*t2 + (q(l, 4)*t1 - q(l, 2)*t3)
         v(l, 3) = v3 - q(l, 1)*t3 + (q(l, 2)*t2 - q(l, 3)*t1)
      end do
   end subroutine rotate_back

   !> q = q o a, lane by lane.
   pure subroutine times(n, q, a)
      integer, intent(in) :: n
      real(dp), intent(inout) :: q(lanes, 4)
      real(dp), intent(in) :: a(4)
      real(dp) :: q1, q2, q3, q4
      integer :: l
      !GCC$ ivdep
      do l = 1, n
         q1 = q(l, 1)
         q2 = q(l, 2)
         q3 = q(l, 3)
         q4 = q(l, 4)
         q(l, 1) = q1*a(1) - q2*a(2) - q3*a(3) - q4*a(4)
         q(l, 2) = q1*a(2) + q2*a(1) + q3*a(4) - q4*a(3)
         q(l, 3) = q1*a(3) + q3*a(1) + q4*a(2) - q2*a(4)
         q(l, 4) = q1*a(4) + q4*a(1) + q2*a(3) - q3*a(2)
      end do
   end subroutine times

end module poinsot_ensemble_layout
