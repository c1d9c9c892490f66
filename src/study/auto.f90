!> method = 'auto', splitting = 'auto': the choice at the start of a run.
module poinsot_study_auto
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_convergence
   use poinsot_scene_restart, only: read_choice
   use poinsot_scene_settings, only: scene_settings, is_auto
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_candidates, only: any_name
   use poinsot_study_choice, only: choose_request, choice, chosen_scene, tolerance_kept
   use poinsot_study_choose, only: choose_method
   use poinsot_study_choose_text, only: choice_sentence, verdict
   implicit none(type, external)
   private
   public :: resolve_auto

   real(dp), parameter, public :: auto_seconds = 5 !! of the processor, that the choice may take

contains

   !> Put a choice in the place of `auto`: that of the restart file if the scene continues one, else
   !> the cheapest that meets &scene tol. A method or splitting that is named stays; a step that is
   !> given is the longest allowed. Nothing is done to a scene without `auto`. Where nothing keeps
   !> the tolerance the nearest is taken, and scene%chosen_fails says why. Errors: those of
   !> choose_method and of read_choice; POINSOT_E_CONVERGENCE if no method comes through.
   subroutine resolve_auto(scene, watch, error)
      type(scene_settings), intent(inout) :: scene
      class(run_watch), intent(inout) :: watch
      type(poinsot_error), intent(inout) :: error
      type(choose_request) :: request
      type(choice) :: answer
      if (.not. is_auto(scene)) return
      if (len(scene%from) > 0) then
         call read_choice(scene%from, scene%method, scene%splitting, scene%h, &
            scene%tolerance, error)
         scene%chosen = "by the run that wrote " // scene%from
         return
      end if
      request%tol = scene%tol
      request%budget = auto_seconds
      request%longest = scene%h
      request%methods = any_name
      request%splittings = any_name
      if (scene%method /= "auto") request%methods = [character(24) :: scene%method]
      call choose_method(scene, request, watch, answer, error)
      if (raised(error)) return
      if (.not. answer%best%h > 0) then
         call raise(error, poinsot_e_convergence, scene%file // ": " // verdict(scene, &
            request%tol, answer))
         return
      end if
      scene%chosen = choice_sentence(scene, request%tol, answer)
      if (answer%ended /= tolerance_kept) scene%chosen_fails = verdict(scene, request%tol, answer)
      scene = chosen_scene(scene, answer%best)
   end subroutine resolve_auto

end module poinsot_study_auto
