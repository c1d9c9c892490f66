!> Promises about what a host or a scene brings: a tensor in some frame, a rotor, numbers with few
!> digits. One figure each of a method and a body, in 1e-16; `broken` where a promise is not kept.
module poinsot_study_hard_frames
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_axis_momentum, poinsot_e_not_unit
   use poinsot_effect_settings, only: number_setting
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_tensor_class, set_option, &
      add_effect
   use poinsot_ensemble_step, only: drift_bodies, step_bodies
   use poinsot_rotation_conversions, only: to_matrix
   use poinsot_rotation_quaternion, only: quaternion_product, quaternion_conjugate, rotate
   implicit none(type, external)
   private
   public :: in_a_frame, with_a_rotor, few_digits

   real(dp), parameter :: broken = huge(1.0_dp)
   real(dp), parameter :: axes(4) = [0.5_dp, 0.1_dp, -0.7_dp, 0.5_dp] !! of a frame, of norm 1
   real(dp), parameter :: centre(3) = [0.3_dp, -0.5_dp, 0.7_dp], h = 0.05_dp
   real(dp), parameter :: start(4) = [0.5_dp, -0.1_dp, 0.7_dp, 0.5_dp]

contains

   !> A top told by its tensor in another frame: the same motion. A tensor knows small moments and
   !> equal ones only to its rounding, so thin bodies are left out, and of bodies whose axes are not
   !> told by it methods that go by axes.
   real(dp) function in_a_frame(name, moments, momentum) result(figure)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3), momentum(3)   !! moments ascend
      type(poinsot_plan) :: plan
      type(poinsot_error) :: error
      real(dp) :: y(3, 2), q(4, 2), r(3, 3), tensor(3, 3), arm(3)
      integer :: k, number
      figure = 0
      r = to_matrix(axes)
      arm = centre
      if (.not. moments(1) > 0) arm = [1.0_dp, 0.0_dp, 0.0_dp] ! no torque about that axis
      do k = 1, 2
         call renew(plan, name, error)
         y(:, k) = momentum
         q(:, k) = start
         if (k == 1) then
            call add_class(plan, moments, number, error)
            call add_effect(plan, "gravity", [number_setting("centre", arm)], error)
         else
            tensor = matmul(r*spread(moments, 1, 3), transpose(r))
            call add_tensor_class(plan, (tensor + transpose(tensor))/2, number, error)
            call add_effect(plan, "gravity", [number_setting("centre", matmul(r, arm))], error)
            y(:, k) = matmul(r, y(:, k))
            q(:, k) = quaternion_product(q(:, k), quaternion_conjugate(axes))
         end if
         call go(plan, y(:, k), q(:, k), error)
      end do
      y(:, 2) = matmul(transpose(r), y(:, 2))
      q(:, 2) = quaternion_product(q(:, 2), axes)
      figure = broken
      if (.not. raised(error) .and. all(ieee_is_finite(y)) .and. all(ieee_is_finite(q))) figure = &
         max(norm2(y(:, 1) - y(:, 2))/norm2(y(:, 1)), norm2(q(:, 1) - q(:, 2)))/1e-16_dp
   end function in_a_frame

   !> A rotor inside: poinsot_drift and a step are one motion, to the bit, and Q y stays.
   real(dp) function with_a_rotor(name, moments, momentum) result(figure)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3), momentum(3)
      type(poinsot_plan), target :: plan
      type(poinsot_error) :: error
      type(body_view) :: view
      real(dp), target :: y(3, 1), q(4, 1)
      real(dp) :: rotor(3), z(3), r(4)
      integer :: k, number, status
      rotor = centre
      where (.not. moments > 0) rotor = 0
      call renew(plan, name, error)
      call add_class(plan, moments, number, error)
      call add_effect(plan, "gyrostat", [number_setting("rotor", rotor)], error)
      call set_option(plan, "splitting", "srkn6", error)
      z = momentum
      r = start
      call go(plan, z, r, error)
      y(:, 1) = momentum
      q(:, 1) = start
      call view_rows(y, q, view)
      do k = 1, 20
         if (raised(error)) exit
         call drift_bodies(plan, view, h, status, error)
         if (status /= poinsot_ok) exit
      end do
      figure = broken
      if (raised(error) .or. status /= poinsot_ok) return
      if (.not. all(ieee_is_finite([y, q, z, r]))) return
      if (any(transfer([y, q], [0]) /= transfer([z, r], [0]))) return
      figure = norm2(rotate(r, z) - rotate(start, momentum))/norm2(momentum)/1e-16_dp
   end function with_a_rotor

   !> Few digits within the slack are taken, and change nothing but what they must; beyond it they
   !> are refused. 0 or `broken`.
   real(dp) function few_digits(name) result(figure)
      character(*), intent(in) :: name
      real(dp), parameter :: line(3) = [0.0_dp, 1.0_dp, 1.0_dp], spin(3) = [0.0_dp, 0.6_dp, -0.8_dp]
      real(dp), parameter :: wide(3) = [0.6_dp, 0.4_dp, 1.0005_dp]
      logical :: good(6)
      good(1) = moves(name, line, spin, start, line, spin, start, poinsot_ok)
      good(2) = moves(name, [0.0_dp, 1 - 2.0_dp**(-18), 1 + 2.0_dp**(-18)], spin, start, line, &
         spin, start, poinsot_ok)
      good(3) = moves(name, line, [9e-7_dp, 0.6_dp, -0.8_dp], start, line, spin, start, poinsot_ok)
      good(4) = moves(name, line, [2e-6_dp, 0.6_dp, -0.8_dp], start, line, spin, start, &
         poinsot_e_axis_momentum)
      good(5) = moves(name, wide, centre, start, wide, centre, start, poinsot_ok)
      good(6) = moves(name, wide, centre, start*(1 + 2e-6_dp), wide, centre, start, &
         poinsot_e_not_unit)
      figure = merge(0.0_dp, broken, all(good))
   end function few_digits

   !> A body gets this status, and if that is OK its motion is bitwise that of another.
   logical function moves(name, moments, momentum, attitude, moments_2, momentum_2, attitude_2, &
         wanted)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3), momentum(3), attitude(4)
      real(dp), intent(in) :: moments_2(3), momentum_2(3), attitude_2(4)
      integer, intent(in) :: wanted
      type(poinsot_plan) :: plan
      type(poinsot_error) :: error
      real(dp) :: y(3, 2), q(4, 2)
      integer :: number, status
      y(:, 1) = momentum
      q(:, 1) = attitude
      call renew(plan, name, error)
      call add_class(plan, moments, number, error)
      call go(plan, y(:, 1), q(:, 1), error, status)
      moves = status == wanted .and. .not. raised(error)
      if (wanted /= poinsot_ok .or. .not. moves) return
      y(:, 2) = momentum_2
      q(:, 2) = attitude_2
      call renew(plan, name, error)
      call add_class(plan, moments_2, number, error)
      call go(plan, y(:, 2), q(:, 2), error)
      moves = .not. raised(error) .and. all(transfer([y(:, 1), q(:, 1)], [0]) == &
         transfer([y(:, 2), q(:, 2)], [0]))
   end function moves

   !> An empty plan with this method.
   subroutine renew(plan, name, error)
      type(poinsot_plan), intent(out) :: plan
      character(*), intent(in) :: name
      type(poinsot_error), intent(inout) :: error
      plan%threads = 1
      call set_option(plan, "method", trim(name), error)
   end subroutine renew

   !> Twenty steps of one body, and its status.
   subroutine go(plan, y, q, error, status)
      type(poinsot_plan), intent(inout), target :: plan
      real(dp), intent(inout) :: y(3), q(4)
      type(poinsot_error), intent(inout) :: error
      integer, intent(out), optional :: status
      type(body_view) :: view
      real(dp), target :: yy(3, 1), qq(4, 1)
      integer, target :: each(1)
      integer :: whole
      if (.not. raised(error)) call make_ready(plan, error)
      yy(:, 1) = y
      qq(:, 1) = q
      each = poinsot_ok
      call view_rows(yy, qq, view)
      view%status => each
      if (.not. raised(error)) call step_bodies(plan, view, 0.0_dp, h, 0_i8, 20_i8, whole, error)
      y = yy(:, 1)
      q = qq(:, 1)
      if (present(status)) status = each(1)
   end subroutine go

end module poinsot_study_hard_frames
