!> A choice put to the test: the scene as it will be run, all its bodies from start to end, beside a
!> reference; and how errors grow where no choice would do.
module poinsot_study_choose_check
   use poinsot_core_kinds, only: dp, i8, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_engine, only: engine, start_engine, engine_step
   use poinsot_scene_schedule, only: piece, piece_count, get_piece
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_states, only: body_states, first_states
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_clock, only: time_limit, left_of
   use poinsot_study_errors, only: end_state, compare_states
   use poinsot_study_members, only: member_set
   use poinsot_study_statistics, only: line_slope
   use poinsot_study_torque_series, only: torque_problem, torque_problems, turn_under_torque, fine
   use poinsot_study_trial, only: make_plan, set_tolerance, integrate
   use poinsot_taylor_settings, only: least_tolerance
   implicit none(type, external)
   private
   public :: run_whole, error_growth, find_growth

   integer, parameter :: looks = 32              !! at errors that grow
   real(dp), parameter :: chaotic_gain = 30      !! in the second half of the time, at least
   real(dp), parameter :: a_step = 2e-4_dp       !! no step in quadruple takes less; seconds

   !> How the errors of the most accurate run grow.
   type :: error_growth
      logical :: known = .false.
      logical :: chaotic = .false.
      real(dp) :: fold = 0                       !! the time in which they grow e-fold
      real(dp) :: holds = 0                      !! the tolerance holds to this time
   end type error_growth

contains

   !> The scene step by step, as `poinsot run` takes it, without files. Not done when the limit is
   !> over. Error: what the engine refuses.
   subroutine run_whole(scene, limit, watch, states, done, error)
      type(scene_settings), intent(in) :: scene  !! method, splitting, step and tolerance as chosen
      type(time_limit), intent(in) :: limit
      class(run_watch), intent(inout) :: watch
      type(body_states), intent(out) :: states
      logical, intent(out) :: done
      type(poinsot_error), intent(inout) :: error
      type(engine) :: motor
      type(piece) :: part
      integer(i8) :: k, number, from, several
      done = .false.
      call first_states(scene, states, error)
      if (.not. raised(error)) call start_engine(scene, motor, error)
      number = 0
      do k = 1, piece_count(scene)
         part = get_piece(scene, k)
         from = 0
         do while (from < part%steps)
            several = min(part%steps - from, max(1_i8, 1000000_i8/states%n))
            if (.not. raised(error)) call engine_step(motor, states, part%from - &
               real(number, dp)*part%h, part%h, number + from, several, error)
            if (raised(error) .or. left_of(limit) < 0 .or. watch%stop_now()) return
            from = from + several
         end do
         number = number + part%steps
      end do
      done = .true.
   end subroutine run_whole

   !> Follow some bodies by `taylor` at its finest beside quadruple precision: do errors grow
   !> exponentially, how fast, and how long does a tolerance hold? Not known where the torques are
   !> no data, or the time is short.
   subroutine find_growth(scene, members, at, tol, limit, growth)
      type(scene_settings), intent(in) :: scene
      type(member_set), intent(in) :: members
      integer, intent(in) :: at(:)               !! which of them: the worst
      real(dp), intent(in) :: tol
      type(time_limit), intent(in) :: limit
      type(error_growth), intent(out) :: growth
      type(torque_problem), allocatable :: problems(:)
      type(poinsot_plan) :: plan
      type(poinsot_error) :: refused
      real(dp) :: errors(0:looks)
      integer :: i, k
      logical :: done
      call make_plan(scene, "exact", "taylor", plan, refused)
      if (.not. raised(refused)) call torque_problems(plan, problems, refused)
      if (raised(refused)) return
      call set_tolerance(plan, least_tolerance)
      growth%holds = scene%t_end
      do i = 1, size(at)
         call errors_of(plan, problems, members, at(i), scene%t_end, limit, errors, done)
         if (.not. done) return
         growth%known = .true.
         do k = 1, looks
            if (errors(k) <= tol) cycle
            growth%holds = min(growth%holds, scene%t_end*(k - 1)/looks)
            exit
         end do
         if (errors(looks) < chaotic_gain*errors(looks/2)) cycle
         growth%chaotic = .true.
         if (growth%fold > 0) then
            growth%fold = min(growth%fold, fold_of(errors, scene%t_end))
         else
            growth%fold = fold_of(errors, scene%t_end)
         end if
      end do
   end subroutine find_growth

   !> Errors of one body at equal distances in time.
   subroutine errors_of(plan, problems, members, k, t_end, limit, errors, done)
      type(poinsot_plan), intent(in) :: plan
      type(torque_problem), intent(in) :: problems(:)
      type(member_set), intent(in) :: members
      integer, intent(in) :: k
      real(dp), intent(in) :: t_end
      type(time_limit), intent(in) :: limit
      real(dp), intent(out) :: errors(0:looks)
      logical, intent(out) :: done
      type(member_set) :: one
      type(end_state) :: state
      real(dp), allocatable :: y(:, :), q(:, :), carry(:, :), angle(:), momentum(:)
      integer :: j, most_steps
      one%n = 1
      one%given = 1
      one%group = members%group(k:k)
      y = members%y(:, k:k)
      q = members%q(:, k:k)
      state%y = y
      state%q = q
      allocate (carry(7, 1), source=0.0_dp)
      errors = 0
      do j = 1, looks
         most_steps = int(min(1e8_dp, max(left_of(limit), 0.0_dp)/a_step))
         call turn_under_torque(problems(one%group(1)), fine, real(t_end, qp)*(j - 1)/looks, &
            real(t_end, qp)*j/looks, most_steps, state%y(:, 1), state%q(:, 1), done)
         if (done) call integrate(plan, one, t_end/looks, int(j - 1, i8), 1_i8, y, q, carry, done)
         if (.not. done) return
         call compare_states(real(y, qp), real(q, qp), state, angle, momentum)
         errors(j) = max(angle(1), momentum(1))
      end do
   end subroutine errors_of

   !> The time of an e-fold growth: the line through the logarithms, from rounding to the end.
   pure real(dp) function fold_of(errors, t_end)
      real(dp), intent(in) :: errors(0:)
      real(dp), intent(in) :: t_end
      real(dp) :: rate
      rate = line_slope(log(max(errors(looks/4:), 1e-17_dp)))*looks/t_end
      fold_of = 0
      if (rate > 0) fold_of = 1/rate
   end function fold_of

end module poinsot_study_choose_check
