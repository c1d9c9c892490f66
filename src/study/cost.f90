!> What accuracy costs in time, on a scene's own bodies and effects: errors against a reference and
!> times for every candidate over a range of steps.
module poinsot_study_cost
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_candidates, only: survey_scene, quiet_scene, list_candidates, plan_splitting
   use poinsot_study_clock, only: wall_seconds, limit_in
   use poinsot_study_cost_climb, only: climber, climb
   use poinsot_study_cost_data, only: cost_request, cost_study
   use poinsot_study_cost_long, only: run_long
   use poinsot_study_cost_point, only: frontier, of_angle, of_momentum
   use poinsot_study_cost_times, only: take_times
   use poinsot_study_members, only: draw_members
   use poinsot_study_reference, only: find_reference
   use poinsot_study_trial, only: make_plan, most_checks
   implicit none(type, external)
   private
   public :: cost_request, cost_study, study_cost

   real(dp), parameter :: reference_share = 0.2_dp !! of the budget, for the reference

contains

   !> Measure. Errors: what the plan or the candidates' names refuse, POINSOT_E_CONVERGENCE without
   !> a reference.
   subroutine study_cost(scene, request, watch, study, error)
      type(scene_settings), intent(in) :: scene
      type(cost_request), intent(in) :: request
      class(run_watch), intent(inout) :: watch     !! told the seconds spent; may ask to stop
      type(cost_study), intent(out) :: study
      type(poinsot_error), intent(inout) :: error
      type(scene_settings) :: quiet
      type(cost_request) :: mine
      type(climber), allocatable :: climbers(:)
      real(dp) :: begun
      integer :: i
      begun = wall_seconds()
      mine = request
      mine%budget = request%budget - request%reserve
      call quiet_scene(scene, quiet)
      call survey_scene(quiet, study%kind, error)
      if (.not. raised(error)) call list_candidates(quiet, study%kind, request%methods, &
         request%splittings, study%candidates, error)
      if (.not. raised(error)) call draw_members(quiet, study%kind%coupled, request%members, &
         request%spread, study%members, error)
      if (raised(error)) return
      study%t_end = quiet%t_end
      call find_reference(quiet, study%kind, study%members, study%t_end, most_checks, &
                          limit_in(reference_share*mine%budget, .true.), study%reference, error)
      if (raised(error)) return
      allocate (climbers(size(study%candidates)), study%points(0))
      do i = 1, size(climbers)
         associate (one => study%candidates(i))
            call make_plan(quiet, trim(one%method), plan_splitting(one), climbers(i)%plan, error)
         end associate
         climbers(i)%adaptive = study%candidates(i)%adaptive
         if (raised(error)) return
      end do
      call climb(mine, begun, watch, climbers, study)
      if (mine%timed) call take_times(mine, begun, watch, climbers, study)
      call frontier(study%points, of_angle)
      call frontier(study%points, of_momentum)
      allocate (study%drift(0), study%rivals(0))
      if (mine%timed) call run_long(quiet, mine, begun, watch, study, error)
      study%seconds = wall_seconds() - begun
   end subroutine study_cost

end module poinsot_study_cost
