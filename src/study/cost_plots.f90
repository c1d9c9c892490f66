!> Pictures of a cost study, as gnuplot scripts over cost.csv and drift.csv.
module poinsot_study_cost_plots
   use poinsot_core_error, only: poinsot_error
   use poinsot_scene_settings, only: scene_settings
   use poinsot_study_cost_data, only: cost_study
   use poinsot_study_cost_point, only: of_angle, of_momentum
   use poinsot_study_plot_drift, only: write_drift
   use poinsot_study_plot_steps, only: write_steps
   use poinsot_study_plot_work, only: write_work
   implicit none(type, external)
   private
   public :: write_cost_plots, cost_pictures

contains

   !> All scripts. Error: POINSOT_E_IO.
   subroutine write_cost_plots(out, scene, study, error)
      character(*), intent(in) :: out           !! folder of cost.csv
      type(scene_settings), intent(in) :: scene
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      call write_work(out, "attitude_cost", scene, study, of_angle, error)
      call write_work(out, "momentum_cost", scene, study, of_momentum, error)
      call write_steps(out, "attitude_step", scene, study, error)
      call write_drift(out, "energy_drift", scene, study, error)
   end subroutine write_cost_plots

   !> The pictures that a study has.
   pure function cost_pictures(study) result(names)
      type(cost_study), intent(in) :: study
      character(16), allocatable :: names(:)
      names = [character(16) :: "attitude_cost", "momentum_cost", "attitude_step"]
      if (size(study%drift) > 0) names = [character(16) :: names, "energy_drift"]
   end function cost_pictures

end module poinsot_study_cost_plots
