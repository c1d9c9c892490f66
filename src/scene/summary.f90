!> summary.txt: the run, its time, drift of conserved quantities, and the error.
module poinsot_scene_summary
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_version, only: version_text
   use poinsot_body_moments, only: describe_body
   use poinsot_scene_text, only: text_of
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_folder, only: file_name, run_files, files_row, file_separator
   use poinsot_scene_schedule, only: knot_within_step
   use poinsot_scene_noise, only: has_noise
   use poinsot_scene_settings, only: scene_settings, effect_setting, body_total
   use poinsot_scene_drift, only: drift_watch
   use poinsot_scene_states, only: body_states, to_scene_frame
   implicit none(type, external)
   private
   public :: run_report, write_summary, brief_number, class_words

   integer, parameter :: most_bodies_shown = 3, most_classes_shown = 5

   !> The report of a run.
   type :: run_report
      character(:), allocatable :: state      !! complete, interrupted, failed
      character(:), allocatable :: reason     !! why it failed
      character(:), allocatable :: method, splitting
      character(:), allocatable :: restart    !! the restart file that was written; "" = none
      character(:), allocatable :: branch     !! that the seed is new since the restart; "" = is not
      integer(i8) :: steps = 0                !! steps taken
      integer(i8) :: outputs = 0              !! frames written
      real(dp) :: shortest = 0, longest = 0   !! of the steps taken; 0: none
      real(dp) :: t = 0                       !! time reached
      integer :: threads = 1
      real(dp) :: stepping = 0, all = 0       !! wall time, s
      type(drift_watch) :: drift
      character(:), allocatable :: reference  !! what the end was compared with; "" = not compared
      real(dp) :: error_y = 0, error_q = 0    !! largest differences from it
      logical :: beyond = .false.             !! of what `auto` chose: they are beyond `tol`
   end type run_report

contains

   !> Write the summary. Error: POINSOT_E_IO.
   subroutine write_summary(path, scene, report, states, error)
      character(*), intent(in) :: path          !! of the file
      type(scene_settings), intent(in) :: scene !! the typed scene
      type(run_report), intent(in) :: report    !! what the summary says
      type(body_states), intent(in) :: states   !! at the end
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      call open_out(path, file, error)
      if (raised(error)) return
      call put_run(file, scene, report, error)
      call put_time(file, scene, report, error)
      call put_bodies(file, scene, error)
      if (report%drift%measured) call put_drift(file, scene, report, error)
      call put_end(file, scene, report, states, error)
      call finish_out(file, error)
   end subroutine write_summary

   !> "name            value"
   subroutine row(file, name, value, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: name, value
      type(poinsot_error), intent(inout) :: error
      character(22) :: left
      left = name
      call put(file, left // value, error)
   end subroutine row

   subroutine put_run(file, scene, report, error)
      type(out_file), intent(in) :: file
      type(scene_settings), intent(in) :: scene
      type(run_report), intent(in) :: report
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: effects, name
      real(dp) :: knot
      integer :: i
      call row(file, "state", report%state, error)
      if (report%state /= "complete") call row(file, "reason", report%reason, error)
      call row(file, "scene", scene%name // " (" // scene%file // ")", error)
      call row(file, "poinsot", version_text, error)
      call row(file, "bodies", text_of(body_total(scene)), error)
      effects = ""
      do i = 1, size(scene%effects)
         if (i > 1) effects = effects // ", "
         effects = effects // scene%effects(i)%name // on_class(scene%effects(i))
      end do
      if (size(scene%effects) == 0) effects = "none"
      call row(file, "effects", effects, error)
      call row(file, "method", report%method, error)
      if (size(scene%effects) > 0) call row(file, "splitting", report%splitting, error)
      call knot_within_step(scene, knot, name)
      if (report%splitting /= "taylor" .and. knot >= 0) call row(file, "order at knots", &
         "2: the table of &" // name // " has a knot at t = " // text_of(knot) // &
         ", within a step; make steps end there", error)
      if (report%splitting == "baoab" .and. has_noise(scene)) then
         call row(file, "momenta", "are those at ends of steps, where with baoab they are too " // &
                  "cold by O(h^2); attitudes are sampled best there", &
                  error)
      end if
      if (report%splitting == "taylor") call row(file, "tolerance", text_of(scene%tolerance), error)
      if (len(scene%chosen) > 0) call row(file, "chosen", scene%chosen, error)
      if (len(scene%chosen) > 0 .and. has_noise(scene)) then
         call row(file, "noise", "was off in the choice, so errors of averages were not " // &
                  "measured; baoab is best for them", error)
      end if
      call row(file, "seed", text_of(scene%seed), error)
      if (len(scene%from) > 0) call row(file, "continued from", scene%from, error)
      if (len(report%branch) > 0) call row(file, "branch", report%branch, error)
      call row(file, files_row, list_of_files(scene, report), error)
   end subroutine put_run

   !> " of class 2", if an effect does not act on all.
   function on_class(item) result(text)
      type(effect_setting), intent(in) :: item
      character(:), allocatable :: text
      integer :: number
      text = ""
      number = item%made%class_index
      if (number > 0) text = " of class " // text_of(number)
   end function on_class

   !> What this run wrote, or its scripts will draw: the next run into this folder may remove it.
   function list_of_files(scene, report) result(list)
      type(scene_settings), intent(in) :: scene
      type(run_report), intent(in) :: report
      character(:), allocatable :: list
      type(file_name), allocatable :: names(:)
      integer :: i
      call run_files(scene, names)
      list = names(1)%text
      do i = 2, size(names)
         if (names(i)%text == scene%output%restart .and. len(report%restart) == 0) cycle
         list = list // file_separator // names(i)%text
      end do
      if (.not. scene%output%present .and. len(report%restart) > 0) then
         list = list // file_separator // scene%output%restart
      end if
   end function list_of_files

   subroutine put_time(file, scene, report, error)
      type(out_file), intent(in) :: file
      type(scene_settings), intent(in) :: scene
      type(run_report), intent(in) :: report
      type(poinsot_error), intent(inout) :: error
      real(dp) :: body_steps
      call row(file, "step h", step_used(scene%h, report), error)
      call row(file, "steps", text_of(report%steps), error)
      call row(file, "time reached", text_of(report%t) // " of " // text_of(scene%t_end), error)
      call row(file, "outputs", text_of(report%outputs), error)
      call row(file, "threads", text_of(report%threads), error)
      call row(file, "wall time", brief_number(report%stepping) // " s stepping, " // &
               brief_number(report%all) // " s in all", error)
      body_steps = real(report%steps, dp)*real(body_total(scene), dp)
      if (body_steps > 0) then
         call row(file, "speed", &
                  brief_number(report%stepping*1e9_dp/body_steps) // " ns per body-step", error)
      end if
   end subroutine put_time

   !> The steps that were taken, and the one that was wished if they are shorter: a step ends at
   !> every
   !> output.
   function step_used(wished, report) result(text)
      real(dp), intent(in) :: wished            !! 0: none
      type(run_report), intent(in) :: report
      character(:), allocatable :: text
      real(dp), parameter :: near = 1e-9_dp
      if (.not. report%longest > 0) then
         text = text_of(wished) // ", no step was taken"
         if (.not. wished > 0) text = "no step was taken"
         return
      end if
      text = text_of(rounded(report%longest))
      if (report%shortest < report%longest*(1 - near)) then
         text = text_of(rounded(report%shortest)) // " to " // text
      end if
      if (.not. wished > 0) then
         text = text // ", from output to output"
      else if (report%shortest < wished*(1 - near)) then
         text = text // " (" // text_of(wished) // " asked for; steps end at outputs and at t_end)"
      end if
   end function step_used

   !> To 12 digits: 0.02 where a difference of two times makes 0.020000000000000018.
   pure real(dp) function rounded(value)
      real(dp), intent(in) :: value
      character(24) :: digits
      write (digits, "(es20.11e3)") value
      read (digits, *) rounded
   end function rounded

   !> Moments of each class, and axes where they are not those of the scene.
   subroutine put_bodies(file, scene, error)
      type(out_file), intent(in) :: file
      type(scene_settings), intent(in) :: scene
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: name
      integer :: i, j
      call put(file, "", error)
      call put(file, "moments of inertia" // trim(merge(" (the first few classes)", &
               "                        ", size(scene%bodies) > most_classes_shown)), error)
      do i = 1, min(size(scene%bodies), most_classes_shown)
         name = "  class " // text_of(i)
         call row(file, name, class_words(scene, i), error)
         if (.not. scene%bodies(i)%turned) cycle
         do j = 1, 3
            call row(file, name // "  axis " // text_of(j), text_of(scene%bodies(i)%axes(:, &
               j) + 0.0_dp), error)
         end do
      end do
   end subroutine put_bodies

   !> Moments of a class, and what kind of body that is.
   function class_words(scene, class) result(text)
      type(scene_settings), intent(in) :: scene
      integer, intent(in) :: class
      character(:), allocatable :: text
      text = text_of(scene%bodies(class)%moments) // "  (" // &
         describe_body(scene%bodies(class)%moments) // ")"
   end function class_words

   subroutine put_drift(file, scene, report, error)
      type(out_file), intent(in) :: file
      type(scene_settings), intent(in) :: scene
      type(run_report), intent(in) :: report
      type(poinsot_error), intent(inout) :: error
      call put(file, "", error)
      call put(file, "largest relative change at an output" // &
               trim(merge(" (a free body conserves all of them)         ", &
               " (with effects, some are not conserved)      ", size(scene%effects) == 0)), error)
      call row(file, "  energy H", brief_number(report%drift%energy_change), error)
      call row(file, "  |y| (Casimir C)", brief_number(report%drift%casimir_change), error)
      call row(file, "  Q y, all of it", brief_number(report%drift%momentum_change), error)
      call row(file, "  Q y, along z", brief_number(report%drift%vertical_change), error)
      call row(file, "  |q| - 1", brief_number(report%drift%norm_change), error)
   end subroutine put_drift

   subroutine put_end(file, scene, report, states, error)
      type(out_file), intent(in) :: file
      type(scene_settings), intent(in) :: scene
      type(run_report), intent(in) :: report
      type(body_states), intent(in) :: states
      type(poinsot_error), intent(inout) :: error
      real(dp) :: y(3), q(4)
      integer :: i
      call put(file, "", error)
      if (len(report%reference) > 0) then
         call put(file, "error at the end, against " // report%reference, error)
         call row(file, "  y, over |y|", brief_number(report%error_y), error)
         call row(file, "  q", brief_number(report%error_q), error)
         if (len(scene%chosen) > 0) call row(file, "  tol of auto", brief_number(scene%tol) // &
            trim(merge(" is NOT MET", " is met    ", report%beyond)), error)
         call put(file, "", error)
      end if
      call put(file, "state at the end, body frame" // trim(merge(" (the first few)", &
               "                ", states%n > most_bodies_shown)), error)
      do i = 1, min(states%n, most_bodies_shown)
         y = states%y(:, i)
         q = states%q(:, i)
         call to_scene_frame(scene%bodies(states%group(i)), y, q)
         call row(file, "  body " // text_of(i) // "  y", text_of(y), error)
         call row(file, "  body " // text_of(i) // "  q", text_of(q), error)
      end do
   end subroutine put_end

   !> Two or three digits for people.
   pure function brief_number(value) result(text)
      real(dp), intent(in) :: value
      character(:), allocatable :: text
      character(24) :: buffer
      if (abs(value) <= 0) then
         text = "0"
         return
      else if (abs(value) >= 0.01_dp .and. abs(value) < 1000) then
         write (buffer, "(f12.3)") value
         if (abs(value) >= 10) write (buffer, "(f12.1)") value
      else
         write (buffer, "(es12.1e3)") value
      end if
      text = trim(adjustl(buffer))
      if (index(text, "E") == 0) return
      text = text(:index(text, "E") - 1) // "e" // plain_power(text(index(text, "E") + 1:))
   end function brief_number

   !> "-016" as "-16"
   pure function plain_power(digits) result(text)
      character(*), intent(in) :: digits
      character(:), allocatable :: text
      integer :: power
      read (digits, *) power
      text = text_of(power)
   end function plain_power

end module poinsot_scene_summary
