!> A choice in words: for the terminal, a scene file, a summary.
module poinsot_study_choose_text
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_reader, only: read_source
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_source, only: scene_source
   use poinsot_scene_summary, only: brief_number
   use poinsot_scene_text, only: text_of
   use poinsot_study_candidates, only: label_of, no_splitting
   use poinsot_study_choice, only: choice, tolerance_kept, time_ran_out, out_of_reach, &
      motion_chaotic
   use poinsot_study_fill_scene, only: fill_scene, text_line, insert_line
   implicit none(type, external)
   private
   public :: choice_lines, choice_sentence, verdict, write_chosen_scene

contains

   !> The output of `poinsot choose`.
   subroutine choice_lines(scene, tol, answer, lines)
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: tol
      type(choice), intent(in) :: answer
      type(text_line), allocatable, intent(out) :: lines(:)
      allocate (lines(0))
      call add("scene       " // scene%name // " to t = " // text_of(scene%t_end))
      call add("tolerance   " // brief_number(tol) // &
         " at the end: attitude in radians, momentum over |y|")
      if (.not. answer%best%h > 0) then
         call add("nothing     " // verdict(scene, tol, answer))
         return
      end if
      call add("method      " // trim(answer%best%setup%method))
      if (answer%best%setup%splitting /= no_splitting) call add("splitting   " // &
         trim(answer%best%setup%splitting))
      if (answer%best%tolerance > 0) call add("series      tolerance = " // &
         text_of(answer%best%tolerance) // ", which sets taylor's own steps")
      call add("step h      " // text_of(answer%best%h))
      call add("error       " // error_text(scene, answer))
      if (.not. cannot_be_predicted(scene, answer)) then
         call add("near        " // brief_number(answer%best%near) // &
            ", the median error of " // text_of(answer%bodies) // " states, " // &
            text_of(answer%given) // " of them the scene's own")
      end if
      call add("time        " // brief_number(answer%best%ns) // " ns per body-step, " // &
               brief_number(answer%best%run) // " s for the run, on one thread")
      if (answer%runner_up%h > 0) then
         call add("runner-up   " // label_of(answer%runner_up%setup) // ", h = " // &
            text_of(answer%runner_up%h) // &
                  ", " // brief_number(answer%runner_up%run/answer%best%run) // &
                     " times as long, error " // &
                  brief_number(answer%runner_up%error))
      else if (answer%ended == tolerance_kept) then
         call add("runner-up   none: no other meets the tolerance at a similar cost")
      end if
      call add("reference   " // answer%reference)
      if (answer%noisy) then
         call add("noise       was off in the trials, so errors of averages were not " // &
                  "measured; baoab samples attitudes best")
      end if
      if (answer%t_measured < scene%t_end .and. .not. answer%checked .and. &
          answer%ended /= motion_chaotic) then
         call add("measured    to t = " // text_of(answer%t_measured) // &
            "; errors are assumed to grow in proportion to time")
      end if
      if (answer%late > 0) call add("left out    " // candidates_of(answer%late) // &
         ", because time ran out; increase --budget")
      if (answer%ended /= tolerance_kept) call add("verdict     " // verdict(scene, tol, answer))
      call add("chosen      in " // brief_number(answer%seconds) // &
         " s of processor time, among " // &
         text_of(answer%candidates) // " that succeeded")

   contains

      subroutine add(text)
         character(*), intent(in) :: text
         call insert_line(lines, size(lines), text)
      end subroutine add

   end subroutine choice_lines

   !> "1 candidate", "7 candidates".
   function candidates_of(n) result(text)
      integer, intent(in) :: n
      character(:), allocatable :: text
      text = text_of(n) // " candidate"
      if (n /= 1) text = text // "s"
   end function candidates_of

   !> The error, and how it is known.
   function error_text(scene, answer) result(text)
      type(scene_settings), intent(in) :: scene
      type(choice), intent(in) :: answer
      character(:), allocatable :: text
      text = brief_number(answer%best%error)
      if (cannot_be_predicted(scene, answer)) then
         text = "beyond the tolerance from t = " // brief_number(answer%growth%holds) // " on"
      else if (answer%checked .and. answer%total == 1) then
         text = text // " at the end of the whole run"
      else if (answer%checked) then
         text = text // ", the worst of all " // text_of(answer%total) // &
            " bodies at the end of the whole run"
      else
         text = text // " predicted from " // text_of(answer%given) // " of " // &
            text_of(answer%total) // " bodies to t = " // text_of(min(answer%t_measured, &
            scene%t_end)) // "; the whole run was not checked"
      end if
   end function error_text

   !> Errors that grow exponentially, beyond the time that was tried.
   pure logical function cannot_be_predicted(scene, answer)
      type(scene_settings), intent(in) :: scene
      type(choice), intent(in) :: answer
      cannot_be_predicted = answer%ended == motion_chaotic .and. .not. answer%checked .and. &
         answer%t_measured < scene%t_end
   end function cannot_be_predicted

   !> Why a tolerance is not met.
   function verdict(scene, tol, answer) result(text)
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: tol
      type(choice), intent(in) :: answer
      character(:), allocatable :: text
      select case (answer%ended)
      case (motion_chaotic)
         text = "chaotic: errors grow e-fold every " // brief_number(answer%growth%fold) // &
            "; " // &
            brief_number(tol) // " holds to t = " // brief_number(answer%growth%holds)
      case (time_ran_out)
         text = "time ran out before any candidate met " // brief_number(tol) // "; " // &
            candidates_of(answer%late) // " given up; increase --budget"
      case (out_of_reach)
         text = "out of reach: no candidate meets " // brief_number(tol) // &
            " with any step size or tolerance"
      case default
         text = "met"
      end select
      if (answer%ended == tolerance_kept .or. .not. answer%best%h > 0) return
      text = text // "; " // label_of(answer%best%setup) // " comes nearest"
      if (cannot_be_predicted(scene, answer)) return
      text = text // ", with an error of " // brief_number(answer%best%error) // " at t = " // &
         text_of(scene%t_end)
   end function verdict

   !> One line for a summary and for the head of a scene file.
   function choice_sentence(scene, tol, answer) result(text)
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: tol
      type(choice), intent(in) :: answer
      character(:), allocatable :: text
      text = label_of(answer%best%setup) // ", h = " // text_of(answer%best%h)
      if (answer%best%tolerance > 0) text = text // ", tolerance = " // &
         text_of(answer%best%tolerance)
      text = text // " for tol = " // brief_number(tol) // ": error " // &
         error_text(scene, answer) // ", " // brief_number(answer%best%ns) // &
         " ns per body-step on this machine; found in " // brief_number(answer%seconds) // " s"
      if (answer%ended /= tolerance_kept) text = text // "; NOT MET: " // &
         verdict(scene, tol, answer)
   end function choice_sentence

   !> The scene's file with the choice filled in, read again to be sure. Errors: POINSOT_E_IO,
   !> POINSOT_E_SCENE.
   subroutine write_chosen_scene(scene, path, tol, answer, settings, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: path
      real(dp), intent(in) :: tol
      type(choice), intent(in) :: answer
      type(text_line), intent(in) :: settings(:)   !! of --set
      type(poinsot_error), intent(inout) :: error
      type(text_line) :: values(5)
      character(9), parameter :: keys(5) = [character(9) :: "method", "splitting", "h", "tol", &
         "tolerance"]
      type(scene_source) :: source
      type(scene_settings) :: again
      integer :: keys_set
      values(1)%text = "'" // trim(answer%best%setup%method) // "'"
      values(2)%text = "'" // scene%splitting // "'"
      if (scene%splitting == "auto") values(2)%text = "'srkn6'"
      if (answer%best%setup%splitting /= no_splitting) values(2)%text = "'" // &
         trim(answer%best%setup%splitting) // "'"
      values(3)%text = text_of(answer%best%h)
      values(4)%text = text_of(tol)
      values(5)%text = text_of(merge(answer%best%tolerance, scene%tolerance, &
         answer%best%setup%adaptive))
      keys_set = merge(5, 4, answer%best%setup%adaptive)
      call fill_scene(scene%file, path, "chosen by poinsot choose: " // choice_sentence( &
         scene, tol, answer), settings, keys(:keys_set), values(:keys_set), error)
      if (raised(error)) return
      call read_source(path, source, error)
      if (.not. raised(error)) call build_scene(source, again, error)
   end subroutine write_chosen_scene

end module poinsot_study_choose_text
