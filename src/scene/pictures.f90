!> Pictures: gnuplot scripts beside the trajectory. They are always written; whoever has gnuplot
!> runs them (the app does), again whenever wanted. Projection and hidden parts are worked out in
!> the scripts themselves, so that they are plain plots in any terminal, readable in grey.
module poinsot_scene_pictures
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_plots_body, only: write_attitude
   use poinsot_scene_plots_momentum, only: write_momentum
   use poinsot_scene_plots_drift, only: write_drift
   use poinsot_scene_plots_top, only: write_nutation, write_angle, write_tilt
   use poinsot_scene_plots_ensemble, only: write_temperature, write_momenta, wanted_temperature
   implicit none(type, external)
   private
   public :: write_pictures, picture_names, picture_files

   character(*), parameter :: all_names(8) = [character(16) :: "attitude", "momentum", "drift", &
                                              "nutation", "tilt", "angle", "temperature", "momenta"]

contains

   !> Names of the pictures that a scene has. NAME is drawn by plot_NAME.gp, into NAME.svg and
   !> NAME.png.
   subroutine picture_names(scene, names)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(16), allocatable, intent(out) :: names(:)
      allocate (names(0))
      if (.not. (scene%output%present .and. scene%output%csv)) return
      select case (scene%output%pictures)
      case ("body")
         names = [character(16) :: "attitude", "momentum", "drift"]
      case ("top")
         names = [character(16) :: "nutation", "drift"]
      case ("tilt")
         names = [character(16) :: "tilt", "drift"]
      case ("angle")
         names = [character(16) :: "angle", "drift"]
      case ("ensemble")
         names = [character(16) :: "temperature", "momenta"]
         if (.not. wanted_temperature(scene) > 0) names = [character(16) :: "drift"]
      case default
         continue ! none
      end select
   end subroutine picture_names

   !> Every file that drawing may leave, of this scene or another.
   subroutine picture_files(names)
      character(40), allocatable, intent(out) :: names(:)
      integer :: i
      allocate (names(3*size(all_names)))
      do i = 1, size(all_names)
         names(3*i - 2) = "plot_" // trim(all_names(i)) // ".gp"
         names(3*i - 1) = trim(all_names(i)) // ".svg"
         names(3*i) = trim(all_names(i)) // ".png"
      end do
   end subroutine picture_files

   !> Write the scripts. Error: POINSOT_E_IO.
   subroutine write_pictures(scene, out, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: out           !! the folder of the trajectory
      type(poinsot_error), intent(inout) :: error
      character(16), allocatable :: names(:)
      character(:), allocatable :: path
      integer :: i
      call picture_names(scene, names)
      do i = 1, size(names)
         if (raised(error)) return
         path = out // "/plot_" // trim(names(i)) // ".gp"
         select case (trim(names(i)))
         case ("attitude")
            call write_attitude(scene, path, error)
         case ("momentum")
            call write_momentum(scene, path, error)
         case ("drift")
            call write_drift(scene, path, error)
         case ("nutation")
            call write_nutation(scene, path, error)
         case ("tilt")
            call write_tilt(scene, path, error)
         case ("angle")
            call write_angle(scene, path, error)
         case ("temperature")
            call write_temperature(scene, path, error)
         case default
            call write_momenta(scene, path, error)
         end select
      end do
   end subroutine write_pictures

end module poinsot_scene_pictures
