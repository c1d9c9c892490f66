!> The error at the end of a run, against a more accurate solution: for free bodies the other exact
!> method in one step, with effects the same run with `exact` and a quarter of the step size, or
!> `taylor` at its smallest tolerance.
module poinsot_scene_compare
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_maxima, only: larger, largest_of
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_rotation_quaternion, only: attitude_distance
   use poinsot_scene_noise, only: has_noise
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_schedule, only: piece, piece_count, get_piece
   use poinsot_scene_states, only: body_states, first_states
   use poinsot_scene_engine, only: engine, start_engine, engine_step, couples_bodies
   use poinsot_scene_summary, only: run_report
   use poinsot_scene_text, only: text_of
   use poinsot_taylor_settings, only: least_tolerance
   implicit none(type, external)
   private
   public :: compare_end

   real(dp), parameter :: most_work = 4e6_dp !! body-steps a comparison may cost
   integer(i8), parameter :: finer = 4
   integer, parameter :: small_run = 1000      !! bodies: all are compared
   integer, parameter :: some = 64             !! of larger ones
   real(dp), parameter :: as_good = 1.07_dp    !! order 2: a quarter of the step leaves a sixteenth

contains

   !> Put the comparison into the report: of all bodies, or of some if they are many or the run is
   !> long; none for very long runs, continued runs, random effects, and many that see each other. A
   !> comparison that fails is no failure of the run. A choice of `auto` has to be within `tol`.
   subroutine compare_end(scene, states, report)
      type(scene_settings), intent(in) :: scene       !! the typed scene
      type(body_states), intent(in) :: states         !! at the end: all, or those of a rank
      type(run_report), intent(inout) :: report       !! what the summary says
      type(scene_settings) :: better
      type(engine) :: motor
      type(body_states) :: ours, other
      type(poinsot_error) :: refused
      report%reference = ""
      if (states%n == 0 .or. len(scene%from) > 0) return
      if (has_noise(scene)) return
      call better_scene(scene, better, report%reference)
      call start_engine(better, motor, refused)
      if (.not. raised(refused)) call pick_bodies(scene, states, couples_bodies(motor), &
         real(report%steps, dp), ours, other, refused)
      if (raised(refused) .or. ours%n == 0) then
         report%reference = ""
         return
      end if
      if (size(scene%effects) == 0) then
         call engine_step(motor, other, 0.0_dp, scene%t_end, 0_i8, 1_i8, refused)
      else
         call run_finely(scene, motor, other, refused)
      end if
      if (raised(refused)) then
         report%reference = ""
         return
      end if
      if (ours%n < states%total) report%reference = report%reference // ", of " // &
         text_of(ours%n) // " of " // text_of(states%total) // " bodies"
      call largest_difference(ours, other, report)
      report%beyond = len(scene%chosen) > 0 .and. larger(report%error_y, 2*report%error_q) > &
         as_good*scene%tol
   end subroutine compare_end

   !> What to compare with, and its name.
   subroutine better_scene(scene, better, name)
      type(scene_settings), intent(in) :: scene
      type(scene_settings), intent(out) :: better
      character(:), allocatable, intent(inout) :: name
      better = scene
      if (size(scene%effects) == 0) then
         better%method = "exact"
         if (scene%method == "exact") better%method = "jacobi"
         name = "'" // better%method // "' in one stride"
      else if (scene%splitting == "taylor") then
         better%tolerance = least_tolerance
         name = "the same scene with tolerance = " // text_of(least_tolerance)
      else
         better%method = "exact"
         name = "the same scene with 'exact' and a quarter of the step"
      end if
   end subroutine better_scene

   !> The bodies to compare: their ends, and where they began.
   subroutine pick_bodies(scene, states, coupled, steps, ours, other, error)
      type(scene_settings), intent(in) :: scene
      type(body_states), intent(in) :: states
      logical, intent(in) :: coupled              !! only all or none can be run
      real(dp), intent(in) :: steps               !! of the run
      type(body_states), intent(out) :: ours, other
      type(poinsot_error), intent(inout) :: error
      type(body_states) :: one
      integer :: i, k, n, allowed
      allowed = small_run
      if (size(scene%effects) > 0) allowed = int(min(real(small_run, dp), &
         most_work/(real(finer, dp)*max(steps, 1.0_dp))))
      if (states%n <= allowed .and. states%n == states%total) then
         ours = states
         call first_states(scene, other, error)
         return
      end if
      n = min(states%n, allowed, some)
      if (n == 0 .or. coupled) return
      ours%n = n
      ours%total = states%total
      allocate (ours%y(3, n), ours%q(4, n), ours%carry(7, n), ours%group(n), ours%status(n))
      ours%carry = 0
      other = ours
      do i = 1, n
         k = 1 + int(real(i - 1, dp)*(states%n - 1)/max(n - 1, 1))
         call first_states(scene, one, error, states%first + k, states%first + k)
         if (raised(error)) return
         ours%y(:, i) = states%y(:, k)
         ours%q(:, i) = states%q(:, k)
         other%y(:, i) = one%y(:, 1)
         other%q(:, i) = one%q(:, 1)
         other%group(i) = one%group(1)
      end do
   end subroutine pick_bodies

   !> At a quarter of the step; `taylor` at the run's own calls.
   subroutine run_finely(scene, motor, other, error)
      type(scene_settings), intent(in) :: scene
      type(engine), intent(in) :: motor
      type(body_states), intent(inout) :: other
      type(poinsot_error), intent(inout) :: error
      type(piece) :: part
      integer(i8) :: k, step, times
      real(dp) :: h
      times = finer
      if (scene%splitting == "taylor") times = 1
      step = 0
      do k = 1, piece_count(scene)
         if (raised(error)) return
         part = get_piece(scene, k)
         h = part%h/real(times, dp)
         call engine_step(motor, other, part%from - real(step, dp)*h, h, step, &
                          times*part%steps, error)
         step = step + times*part%steps
      end do
   end subroutine run_finely

   !> Largest over the bodies: y relative to the largest |y| of the two, q up to its sign.
   subroutine largest_difference(states, other, report)
      type(body_states), intent(in) :: states, other
      type(run_report), intent(inout) :: report
      real(dp) :: unit
      integer :: i
      report%error_y = 0
      report%error_q = 0
      do i = 1, states%n
         unit = larger(largest_of(abs(states%y(:, i))), largest_of(abs(other%y(:, i))))
         if (.not. unit <= 0) then
            report%error_y = larger(report%error_y, norm2((states%y(:, i) - other%y(:, i))/unit))
         end if
         report%error_q = larger(report%error_q, &
                                 attitude_distance(states%q(:, i), other%q(:, i)))
      end do
   end subroutine largest_difference

end module poinsot_scene_compare
