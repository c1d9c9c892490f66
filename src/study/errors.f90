!> Errors of a run against a reference, body by body: attitude, momentum, energy, energy drift.
module poinsot_study_errors
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_maxima, only: largest_of
   use poinsot_study_statistics, only: line_slope
   use poinsot_study_trial, only: trial_run
   implicit none(type, external)
   private
   public :: end_state, body_errors, compare_states, find_errors, attitude_error

   !> A reference state.
   type :: end_state
      real(qp), allocatable :: y(:, :)       !! (3, n)
      real(qp), allocatable :: q(:, :)       !! (4, n), of norm 1
      real(dp), allocatable :: energy(:, :)  !! (n, 0:checks)
      real(dp), allocatable :: scale(:)      !! (n): what energies are relative to
   end type end_state

   !> Errors of every body.
   type :: body_errors
      real(dp), allocatable :: angle(:)      !! of the turn between the attitudes, radians
      real(dp), allocatable :: momentum(:)   !! |y - reference| relative to |reference|
      real(dp), allocatable :: energy(:)     !! largest over time, relative to the kinetic energy
      real(dp), allocatable :: slope(:) !! of the energy's error in time, relative, per unit time
   end type body_errors

contains

   !> Errors of a run. Its energies are compared at the times that run and reference share.
   pure subroutine find_errors(run, reference, t_end, errors)
      type(trial_run), intent(in) :: run
      type(end_state), intent(in) :: reference
      real(dp), intent(in) :: t_end
      type(body_errors), intent(out) :: errors
      real(dp), allocatable :: deviation(:)
      integer :: i, k, looks, every
      call compare_states(real(run%y, qp), real(run%q, qp), reference, errors%angle, &
         errors%momentum)
      allocate (errors%energy(size(run%y, 2)), errors%slope(size(run%y, 2)))
      looks = ubound(run%energy, 2)
      every = ubound(reference%energy, 2)/looks
      allocate (deviation(0:looks))
      do i = 1, size(errors%energy)
         do k = 0, looks
            deviation(k) = (run%energy(i, k) - reference%energy(i, min(k*every, &
                                                              ubound(reference%energy, &
                                                                 2))))/reference%scale(i)
         end do
         errors%energy(i) = largest_of(abs(deviation))
         errors%slope(i) = abs(line_slope(deviation))*looks/t_end
      end do
   end subroutine find_errors

   !> Attitude and momentum alone.
   pure subroutine compare_states(y, q, reference, angle, momentum)
      real(qp), intent(in) :: y(:, :), q(:, :)
      type(end_state), intent(in) :: reference
      real(dp), allocatable, intent(out) :: angle(:), momentum(:)
      real(qp) :: unit
      integer :: i
      allocate (angle(size(y, 2)), momentum(size(y, 2)))
      do i = 1, size(y, 2)
         angle(i) = attitude_error(q(:, i), reference%q(:, i))
         unit = max(maxval(abs(reference%y(:, i))), maxval(abs(y(:, i))))
         momentum(i) = 0
         if (unit > 0) momentum(i) = real(norm2((y(:, i) - reference%y(:, i))/unit)/ &
                                          max(norm2(reference%y(:, i)/unit), 0.5_qp), dp)
      end do
   end subroutine compare_states

   !> Angle of the turn from one attitude to another, right for tiny ones; q need not be quite of
   !> norm 1, p is.
   pure real(dp) function attitude_error(q, p) result(angle)
      real(qp), intent(in) :: q(4), p(4)
      real(qp) :: u(4), apart, opposite
      u = q/norm2(q)
      apart = norm2(u - p)
      opposite = norm2(u + p)
      angle = 4*atan2(real(min(apart, opposite), dp), real(max(apart, opposite), dp))
   end function attitude_error

end module poinsot_study_errors
