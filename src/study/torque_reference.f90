!> Solutions under torques that are data (poinsot_effect_terms): the Taylor integrator at its finest
!> for all bodies, and quadruple precision for those where that is not enough; each with an
!> estimate of its own error.
module poinsot_study_torque_reference
   use poinsot_core_kinds, only: dp, i8, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_summary, only: brief_number
   use poinsot_scene_text, only: text_of
   use poinsot_study_clock, only: time_limit, left_of
   use poinsot_study_errors, only: end_state, compare_states
   use poinsot_study_members, only: member_set
   use poinsot_study_torque_series, only: torque_problem, series_accuracy, torque_problems, &
      turn_under_torque, fine, coarse
   use poinsot_study_trial, only: trial_run, make_plan, set_tolerance, run_trial
   use poinsot_taylor_settings, only: least_tolerance
   implicit none(type, external)
   private
   public :: solve_torques, solve_long, turn_in_time

   real(dp), parameter :: rounding = 4*epsilon(1.0_dp)  !! no estimate in double is below this
   integer, parameter :: between_looks = 20             !! steps, at the clock
   real(dp), parameter :: longer = 1e-5_dp !! what quadruple precision leaves of an error, at least
   integer, parameter :: spot = 4                       !! solved in quadruple precision anyway

contains

   !> Solve for all members. `served` is false, and nothing done, if an effect is no data, or a body
   !> turns too fast for the integrator.
   subroutine solve_torques(scene, members, t_end, checks, limit, enough, state, angle, &
      momentum, how, seconds, served)
      type(scene_settings), intent(in) :: scene
      type(member_set), intent(in) :: members
      real(dp), intent(in) :: t_end
      integer, intent(in) :: checks                  !! looks at the energy
      type(time_limit), intent(in) :: limit          !! for quadruple precision
      real(dp), intent(in) :: enough                 !! an error small enough; 0: all in quadruple
      type(end_state), intent(inout) :: state        !! `scale`: kinetic energies
      real(dp), allocatable, intent(out) :: angle(:), momentum(:)  !! (n): estimates
      character(:), allocatable, intent(out) :: how  !! for people
      real(dp), intent(out) :: seconds               !! of the processor, in double precision
      logical, intent(out) :: served
      type(poinsot_plan) :: plan
      type(poinsot_error) :: refused
      type(torque_problem), allocatable :: problems(:)
      type(trial_run) :: run, rough
      integer, allocatable :: at(:)
      logical, allocatable :: solved(:)
      served = .false.
      seconds = 0
      call make_plan(scene, "exact", "taylor", plan, refused)
      if (.not. raised(refused)) call torque_problems(plan, problems, refused)
      if (raised(refused)) return
      call set_tolerance(plan, least_tolerance)
      call run_trial(plan, members, t_end, int(checks, i8), checks, .true., run)
      if (.not. run%good) return
      call set_tolerance(plan, 10*least_tolerance)
      call run_trial(plan, members, t_end, 1_i8, 1, .true., rough)
      served = rough%good
      seconds = run%seconds + rough%seconds
      if (.not. served) return
      state%y = run%y
      state%q = run%q
      state%q = state%q/spread(norm2(state%q, 1), 1, 4)
      state%energy = run%energy
      state%scale = run%kinetic
      call compare_states(real(rough%y, qp), real(rough%q, qp), state, angle, momentum)
      angle = max(angle, rounding)
      momentum = max(momentum, rounding)
      call doubtful(max(angle, momentum), enough, at)
      call solve_long(problems, members, at, t_end, limit, state, angle, momentum, solved)
      how = sentence(count(solved), members%n, maxval(max(angle(at), momentum(at)), mask=solved), &
         maxval(max(angle, momentum)))
   end subroutine solve_torques

   !> Members in the order of their errors, as far as these are beyond what is enough; some anyway.
   pure subroutine doubtful(errors, enough, at)
      real(dp), intent(in) :: errors(:)
      real(dp), intent(in) :: enough
      integer, allocatable, intent(out) :: at(:)
      logical :: left(size(errors))
      integer :: i, n
      left = .true.
      n = min(size(errors), max(spot, count(errors > enough)))
      allocate (at(n))
      if (n == size(errors)) then
         at = [(i, i=1, n)]
         return
      end if
      do i = 1, n
         at(i) = maxloc(errors, 1, mask=left)
         left(at(i)) = .false.
      end do
   end subroutine doubtful

   !> Some members in quadruple precision, as far as the time goes. Estimates: of the first few the
   !> distance from a solution of lower order; of the others the error that the motion made of
   !> double precision's rounding, in proportion.
   subroutine solve_long(problems, members, at, t_end, limit, state, angle, momentum, solved)
      type(torque_problem), intent(in) :: problems(:)
      type(member_set), intent(in) :: members
      integer, intent(in) :: at(:)                   !! which of them, the most wanted first
      real(dp), intent(in) :: t_end
      type(time_limit), intent(in) :: limit
      type(end_state), intent(inout) :: state        !! theirs are replaced
      real(dp), intent(inout) :: angle(:), momentum(:)
      logical, allocatable, intent(out) :: solved(:) !! (at)
      type(end_state) :: one
      real(dp), allocatable :: da(:), dm(:)
      real(qp) :: y(3, 2), q(4, 2)
      integer :: i, k
      logical :: done(2)
      allocate (solved(size(at)), source=.false.)
      !$omp parallel do schedule(dynamic, 1) private(y, q, k, done, one, da, dm)
      do i = 1, size(at)
         if (left_of(limit) < 0) cycle
         k = at(i)
         y = spread(real(members%y(:, k), qp), 2, 2)
         q = spread(real(members%q(:, k), qp), 2, 2)
         done = .true.
         associate (problem => problems(members%group(k)))
            call turn_in_time(problem, fine, 0.0_qp, real(t_end, qp), limit, y(:, 1), q(:, 1), &
               done(1))
            if (i <= spot .and. done(1)) call turn_in_time(problem, coarse, 0.0_qp, &
               real(t_end, qp), limit, y(:, 2), q(:, 2), done(2))
         end associate
         if (.not. all(done)) cycle
         state%y(:, k) = y(:, 1)
         state%q(:, k) = q(:, 1)
         solved(i) = .true.
         angle(k) = longer*angle(k)
         momentum(k) = longer*momentum(k)
         if (i > spot) cycle
         one%y = y(:, 1:1)
         one%q = q(:, 1:1)
         call compare_states(y(:, 2:2), q(:, 2:2), one, da, dm)
         angle(k) = max(da(1), angle(k))
         momentum(k) = max(dm(1), momentum(k))
      end do
      !$omp end parallel do
   end subroutine solve_long

   !> Carry (y, q) from t0 to t1 in quadruple precision. The limit is over first: `done` is false,
   !> the state is of no use.
   subroutine turn_in_time(problem, accuracy, t0, t1, limit, y, q, done)
      type(torque_problem), intent(in) :: problem
      type(series_accuracy), intent(in) :: accuracy
      real(qp), intent(in) :: t0, t1
      type(time_limit), intent(in) :: limit
      real(qp), intent(inout) :: y(3), q(4)
      logical, intent(out) :: done
      real(qp) :: t
      t = t0
      done = .false.
      do while (.not. done)
         if (left_of(limit) < 0) return
         call turn_under_torque(problem, accuracy, t, t1, between_looks, y, q, done)
      end do
   end subroutine turn_in_time

   function sentence(solved, all, error_of_these, error_of_all) result(text)
      integer, intent(in) :: solved, all
      real(dp), intent(in) :: error_of_these, error_of_all
      character(:), allocatable :: text
      if (solved == all) then
         text = "Taylor series in quadruple precision, its error at most " // &
            brief_number(error_of_these)
      else if (solved == 0) then
         text = "Taylor series in double precision, its error at most " // &
            brief_number(error_of_all)
      else
         text = "Taylor series in double precision, of " // text_of(solved) // " of " // &
            text_of(all) // " states in quadruple precision; its error at most " // &
            brief_number(error_of_all)
      end if
   end function sentence

end module poinsot_study_torque_reference
