!> How far the end of a run is from a better answer: for free bodies the other exact solution in one
!> stride, with effects the same run at a quarter of the step with `exact`.
module poinsot_scene_compare
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_maxima, only: larger, largest_of
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_rotation_quaternion, only: attitude_distance
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_schedule, only: piece, piece_count, get_piece
   use poinsot_scene_states, only: body_states, first_states
   use poinsot_scene_engine, only: engine, start_engine, engine_step
   use poinsot_scene_summary, only: run_report
   implicit none(type, external)
   private
   public :: compare_end

   real(dp), parameter :: most_work = 4e6_dp !! body-steps a comparison may cost
   integer(i8), parameter :: finer = 4

contains

   !> Put the comparison into the report; none for large runs, continued runs and random effects. A
   !> comparison that fails is no failure of the run.
   subroutine compare_end(scene, states, report)
      type(scene_settings), intent(in) :: scene       !! the typed scene
      type(body_states), intent(in) :: states         !! at the end; not filled for a large run
      type(run_report), intent(inout) :: report       !! what the summary says
      type(body_states) :: other
      type(poinsot_error) :: refused
      logical :: free
      report%reference = ""
      free = size(scene%effects) == 0
      if (states%n == 0 .or. len(scene%from) > 0) return
      if (any_random(scene)) return
      if (.not. free .and. real(finer*report%steps, dp)*states%n > most_work) return
      call first_states(scene, other, refused)
      if (raised(refused)) then
         continue
      else if (free) then
         call free_reference(scene, other, report, refused)
      else
         call fine_reference(scene, other, report, refused)
      end if
      if (raised(refused)) then
         report%reference = ""
         return
      end if
      call largest_difference(states, other, report)
   end subroutine compare_end

   !> Does a random force act?
   pure logical function any_random(scene)
      type(scene_settings), intent(in) :: scene
      integer :: i
      any_random = .false.
      do i = 1, size(scene%effects)
         if (scene%effects(i)%name == "langevin") any_random = .true.
      end do
   end function any_random

   subroutine free_reference(scene, other, report, error)
      type(scene_settings), intent(in) :: scene
      type(body_states), intent(inout) :: other
      type(run_report), intent(inout) :: report
      type(poinsot_error), intent(inout) :: error
      type(engine) :: better
      character(:), allocatable :: method
      method = "exact"
      if (scene%method == "exact") method = "jacobi"
      call start_engine(scene, better, error, method)
      if (.not. raised(error)) then
         call engine_step(better, other, 0.0_dp, scene%t_end, 0_i8, 1_i8, error)
      end if
      report%reference = "'" // method // "' in one stride"
   end subroutine free_reference

   subroutine fine_reference(scene, other, report, error)
      type(scene_settings), intent(in) :: scene
      type(body_states), intent(inout) :: other
      type(run_report), intent(inout) :: report
      type(poinsot_error), intent(inout) :: error
      type(engine) :: better
      type(piece) :: part
      integer(i8) :: k, step
      real(dp) :: h
      call start_engine(scene, better, error, "exact")
      step = 0
      do k = 1, piece_count(scene)
         if (raised(error)) return
         part = get_piece(scene, k)
         h = part%h/real(finer, dp)
         call engine_step(better, other, part%from - real(step, dp)*h, h, step, &
                          finer*part%steps, error)
         step = step + finer*part%steps
      end do
      report%reference = "the same scene with 'exact' and a quarter of the step"
   end subroutine fine_reference

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
