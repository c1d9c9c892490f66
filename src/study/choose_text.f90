!> A choice in sentences: for the terminal, for a scene file, for a summary.
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
   use poinsot_study_choose, only: choice, chosen
   use poinsot_study_fill_scene, only: fill_scene, text_line, insert_line
   implicit none(type, external)
   private
   public :: choice_lines, choice_sentence, write_chosen_scene

contains

   !> What `poinsot choose` says.
   subroutine choice_lines(scene, tol, answer, lines)
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: tol
      type(choice), intent(in) :: answer
      type(text_line), allocatable, intent(out) :: lines(:)
      allocate (lines(0))
      call add("scene       " // scene%name // " to t = " // text_of(scene%t_end))
      call add("tolerance   " // brief_number(tol) // &
         " at the end: attitude in radians, momentum over |y|")
      call add("method      " // trim(answer%best%setup%method))
      if (answer%best%setup%splitting /= no_splitting) call add("splitting   " // &
         trim(answer%best%setup%splitting))
      call add("step h      " // text_of(answer%best%h))
      call add("error       " // brief_number(answer%best%error) // " predicted; " // &
               brief_number(answer%best%near) // " is the median of " // text_of(answer%bodies) // &
               " states, " // text_of(answer%given) // " of them the scene's own")
      call add("time        " // brief_number(answer%best%ns) // " ns a body-step, " // &
               brief_number(answer%best%run) // " s the run, on one thread")
      if (answer%runner_up%h > 0) then
         call add("runner-up   " // label_of(answer%runner_up%setup) // ", h = " // &
            text_of(answer%runner_up%h) // &
                  ", " // brief_number(answer%runner_up%run/answer%best%run) // &
                     " times as long, error " // &
                  brief_number(answer%runner_up%error))
      else
         call add("runner-up   none: no other meets the tolerance")
      end if
      call add("reference   " // answer%reference)
      if (answer%noisy) then
         call add("noise       is not judged: it was off in the trials, and errors of " // &
                  "averages are others; baoab samples attitudes best")
      end if
      if (answer%t_measured < scene%t_end) then
         call add("measured    to t = " // text_of(answer%t_measured) // &
            "; errors are taken to grow in proportion to time")
      end if
      call add("chosen      in " // brief_number(answer%seconds) // " s, among " // &
         text_of(answer%candidates) // &
               " that came through")

   contains

      subroutine add(text)
         character(*), intent(in) :: text
         call insert_line(lines, size(lines), text)
      end subroutine add

   end subroutine choice_lines

   !> One line for a summary and for the head of a scene file.
   function choice_sentence(tol, answer) result(text)
      real(dp), intent(in) :: tol
      type(choice), intent(in) :: answer
      character(:), allocatable :: text
      text = label_of(answer%best%setup) // ", h = " // text_of(answer%best%h) // " for tol = " // &
         brief_number(tol) // &
             ": error " // brief_number(answer%best%error) // ", " // &
                brief_number(answer%best%ns) // &
             " ns a body-step on this machine; found in " // brief_number(answer%seconds) // " s"
   end function choice_sentence

   !> The scene's file with the choice filled in, read again to be sure. Errors: POINSOT_E_IO,
   !> POINSOT_E_SCENE.
   subroutine write_chosen_scene(scene, path, tol, answer, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: path
      real(dp), intent(in) :: tol
      type(choice), intent(in) :: answer
      type(poinsot_error), intent(inout) :: error
      type(text_line) :: values(4)
      character(9), parameter :: keys(4) = [character(9) :: "method", "splitting", "h", "tol"]
      type(scene_source) :: source
      type(scene_settings) :: again
      values(1)%text = "'" // trim(answer%best%setup%method) // "'"
      values(2)%text = "'" // scene%splitting // "'"
      if (scene%splitting == "auto") values(2)%text = "'srkn6'"
      if (answer%best%setup%splitting /= no_splitting) values(2)%text = "'" // &
         trim(answer%best%setup%splitting) // "'"
      values(3)%text = text_of(answer%best%h)
      values(4)%text = text_of(tol)
      call fill_scene(scene%file, path, "chosen by poinsot choose: " // choice_sentence(tol, &
         answer), keys, values, &
                      error)
      if (raised(error)) return
      call read_source(path, source, error)
      if (.not. raised(error)) call build_scene(source, again, error)
   end subroutine write_chosen_scene

end module poinsot_study_choose_text
