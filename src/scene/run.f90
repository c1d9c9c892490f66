!> Run a typed scene: states, steps, frames, summary, restart, plot scripts.
module poinsot_scene_run
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raise, raised, clear
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_memory, poinsot_e_method, &
      poinsot_e_partial, poinsot_e_scene, poinsot_e_io
   use poinsot_scene_text, only: text_of
   use poinsot_scene_settings, only: scene_settings, body_total, is_auto
   use poinsot_scene_schedule, only: piece, piece_count, get_piece, whole_steps
   use poinsot_scene_states, only: body_states, first_states
   use poinsot_scene_engine, only: engine, start_engine, engine_step, engine_energy, &
      couples_bodies, number_bodies, threads_used
   use poinsot_scene_collect, only: collect, row_size
   use poinsot_scene_communicator, only: communicator, slice_of
   use poinsot_scene_drift, only: start_drift, start_energy, follow_drift
   use poinsot_scene_files, only: make_folder, file_exists
   use poinsot_scene_folder, only: check_inputs, clear_folder
   use poinsot_scene_frames, only: frame_writer, open_frames, write_frame, finish_frames
   use poinsot_scene_restart, only: restart_state, write_restart, read_restart, sum_of_kinds
   use poinsot_scene_summary, only: run_report, write_summary
   use poinsot_scene_compare, only: compare_end
   use poinsot_scene_pictures, only: write_pictures
   use poinsot_scene_view, only: view_writer, open_view, add_view_frame, write_view
   use poinsot_scene_watch, only: run_watch
   implicit none(type, external)
   private
   public :: run_scene, check_scene

   real(dp), parameter :: first_chunk = 1e5_dp  !! body-steps before the first look at the watch
   real(dp), parameter :: short = 0.05_dp, long = 0.4_dp !! seconds between two looks
   integer(i8), parameter :: small_run = 1000     !! bodies: all are compared at the end
   integer(i8), parameter :: processed_chunk = 64 !! at least: its processor costs some steps

   !> Everything a rank holds.
   type :: run_state
      type(engine) :: engine
      class(communicator), allocatable :: holders !! among whom the bodies are shared out
      logical :: writes = .true.                  !! has this rank part in what is written?
      type(body_states) :: states
      type(frame_writer) :: frames
      type(view_writer) :: view
      real(dp), allocatable :: kinetic(:), potential(:)
      real(dp) :: t = 0
      integer(i8) :: step = 0
      logical :: stopped = .false.
   end type run_state

contains

   !> Run a scene and write its files into the folder `out`, which is made if it is not there.
   !> Errors: POINSOT_E_IO, POINSOT_E_MEMORY, POINSOT_E_SCENE (restart file), POINSOT_E_PARTIAL and
   !> others of the engine (numerical failure). After every error but a failing disk the summary
   !> says that the run is not complete.
   !> With several ranks, each holds and steps a slice of the bodies; every rank calls. Rank 0
   !> writes, but for arrays and the restart file, which all write.
   subroutine run_scene(scene, out, watch, report, error, ranks)
      type(scene_settings), intent(in) :: scene    !! the typed scene
      character(*), intent(in) :: out              !! folder for the output
      class(run_watch), intent(inout) :: watch     !! asked whether to go on, told how far it is
      type(run_report), intent(out) :: report      !! what the summary says
      type(poinsot_error), intent(inout) :: error
      class(communicator), intent(inout), optional :: ranks
      type(communicator) :: alone
      if (present(ranks)) then
         call run_rank(scene, out, watch, ranks, report, error)
      else
         call run_rank(scene, out, watch, alone, report, error)
      end if
   end subroutine run_scene

   !> The run of this rank.
   subroutine run_rank(scene, out, watch, ranks, report, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: out
      class(run_watch), intent(inout) :: watch
      class(communicator), intent(inout) :: ranks
      type(run_report), intent(out) :: report
      type(poinsot_error), intent(inout) :: error
      type(run_state) :: run
      type(body_states) :: whole
      type(poinsot_error) :: closing
      real(dp) :: begun
      begun = wall_clock()
      report%state = "failed"
      report%reason = ""
      report%reference = ""
      report%restart = ""
      report%branch = ""
      call prepare(scene, out, ranks, run, report, error)
      if (raised(error)) then
         call finish_frames(run%frames, error)
         return
      end if
      call integrate(scene, run, watch, ranks, report, error)
      if (.not. raised(error)) call check_end(run, error)
      if (.not. run%writes) return
      call whole_states(scene, run, whole)
      ! a file that could not be written keeps its .part
      if (error%code == poinsot_e_io) closing = error
      call finish_frames(run%frames, closing)
      call run%holders%share_error(closing)
      report%t = run%t
      report%all = wall_clock() - begun
      if (raised(error)) then
         report%reason = error%message
      else if (raised(closing)) then
         error = closing
         report%reason = error%message
      else if (run%stopped) then
         report%state = "interrupted"
         report%reason = "stopped on request"
      else
         report%state = "complete"
         if (ranks%number == 0 .and. whole%n > 0) then
            call compare_end(scene, whole, report)
         else if (ranks%number == 0) then
            call compare_end(scene, run%states, report)
         end if
      end if
      call clear(closing)
      if (.not. raised(error)) call save_restart(scene, out, run, report, closing)
      if (ranks%number > 0) return
      if (run%stopped .and. len(report%restart) > 0) then
         report%reason = report%reason // "; continue from " // report%restart
      end if
      if (.not. raised(closing)) then
         if (whole%n > 0) then
            call write_summary(out // "/summary.txt", scene, report, whole, closing)
         else
            call write_summary(out // "/summary.txt", scene, report, run%states, closing)
         end if
      end if
      if (.not. raised(closing)) call write_pictures(scene, out, closing)
      if (.not. raised(closing)) call write_view(run%view, scene, out, closing)
      if (raised(closing) .and. .not. raised(error)) error = closing
   end subroutine run_rank

   !> A state that is no number is no result, whatever the plan said of it. An error is that of all
   !> ranks.
   subroutine check_end(run, error)
      type(run_state), intent(inout) :: run
      type(poinsot_error), intent(inout) :: error
      integer :: i
      do i = 1, run%states%n
         if (all(ieee_is_finite(run%states%y(:, i))) .and. &
             all(ieee_is_finite(run%states%q(:, i)))) cycle
         call raise(error, poinsot_e_partial, "at t = " // text_of(run%t) // " the state of body " &
                    // text_of(run%states%first + i) // " is beyond the range of numbers")
         exit
      end do
      call run%holders%share_error(error)
   end subroutine check_end

   !> All bodies of a small run on rank 0; nothing of a large one.
   subroutine whole_states(scene, run, whole)
      type(scene_settings), intent(in) :: scene
      type(run_state), intent(inout) :: run
      type(body_states), intent(out) :: whole
      type(poinsot_error) :: error
      real(dp), allocatable :: rows(:, :)
      integer :: i
      if (body_total(scene) > small_run) return
      if (run%holders%size == 1) then
         whole = run%states
         return
      end if
      allocate (rows(row_size, run%states%total))
      call collect(run%holders, run%states, run%kinetic, run%potential, &
         [(int(i, i8), i=1, run%states%total)], rows)
      if (run%holders%number > 0) return
      call first_states(scene, whole, error)
      whole%y = rows(1:3, :)
      whole%q = rows(4:7, :)
   end subroutine whole_states

   !> Can the scene be run? Makes the plan, runs nothing. Error: whatever the plan refuses.
   subroutine check_scene(scene, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      type(poinsot_error), intent(inout) :: error
      type(engine) :: trial
      call start_engine(scene, trial, error)
   end subroutine check_scene

   !> Folder, states, engine, first frame. An error is that of all ranks.
   subroutine prepare(scene, out, ranks, run, report, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: out
      class(communicator), intent(inout) :: ranks
      type(run_state), intent(inout) :: run
      type(run_report), intent(inout) :: report
      type(poinsot_error), intent(inout) :: error
      report%method = scene%method
      report%splitting = scene%splitting
      allocate (communicator :: run%holders)
      call make_states(scene, out, ranks, run, report, error)
      call ranks%share_error(error)
      if (raised(error)) return
      call continue_from(scene, run, report, error)
      call ranks%share_error(error)
      if (raised(error)) return
      call begin_output(scene, out, ranks, run, report, error)
      call ranks%share_error(error)
      if (raised(error)) return
      call start_energy(run%kinetic, run%potential, run%holders, report%drift)
      if (run%writes .and. len(scene%from) == 0 .and. writes_start(scene)) then
         call frame(scene, run, report, error)
      end if
      call ranks%share_error(error)
   end subroutine prepare

   !> The plan, and the bodies that this rank holds: a slice, or all if they see each other.
   subroutine make_states(scene, out, ranks, run, report, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: out
      class(communicator), intent(in) :: ranks
      type(run_state), intent(inout) :: run
      type(run_report), intent(inout) :: report
      type(poinsot_error), intent(inout) :: error
      integer :: from, to
      if (is_auto(scene)) then
         call raise(error, poinsot_e_method, &
                    scene%file // ": 'auto' must be resolved before the run (poinsot_study_auto)")
         return
      end if
      call start_engine(scene, run%engine, error)
      if (raised(error)) return
      if (ranks%size > 1 .and. .not. couples_bodies(run%engine)) then
         deallocate (run%holders)
         allocate (run%holders, source=ranks)
      end if
      run%writes = ranks%number == 0 .or. run%holders%size > 1
      call slice_of(run%holders%number, run%holders%size, int(body_total(scene)), from, to)
      call first_states(scene, run%states, error, from, to)
      if (.not. raised(error)) call number_bodies(run%engine, run%states, error)
      if (raised(error)) return
      report%threads = threads_used(run%engine, run%states)
      call check_inputs(scene, out, error)
   end subroutine make_states

   !> Energies at the start, folder and files.
   subroutine begin_output(scene, out, ranks, run, report, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: out
      class(communicator), intent(inout) :: ranks
      type(run_state), intent(inout) :: run
      type(run_report), intent(inout) :: report
      type(poinsot_error), intent(inout) :: error
      integer :: code
      allocate (run%kinetic(run%states%n), stat=code)
      if (code == 0) allocate (run%potential(run%states%n), stat=code)
      if (code == 0) then
         call engine_energy(run%engine, run%states, run%t, run%kinetic, run%potential, error)
         if (.not. raised(error)) call start_drift(run%states, report%drift, code)
      end if
      if (code /= 0) call raise(error, poinsot_e_memory, scene%file // ": no memory for " // &
                                text_of(run%states%n) // " bodies")
      if (ranks%number == 0 .and. .not. raised(error)) call make_folder(out, error)
      if (ranks%number == 0 .and. .not. raised(error)) call clear_folder(scene, out, error)
      call ranks%share_error(error)
      if (raised(error) .or. .not. run%writes) return
      call open_frames(scene, out, run%holders, run%frames, error)
      call open_view(scene, run%view)
   end subroutine begin_output

   !> Is t = 0 an output time?
   pure logical function writes_start(scene)
      type(scene_settings), intent(in) :: scene
      writes_start = scene%output%present
      if (writes_start .and. size(scene%output%times) > 0) writes_start = scene%output%times(1) <= 0
   end function writes_start

   !> Take the state of a restart file, if the scene names one.
   subroutine continue_from(scene, run, report, error)
      type(scene_settings), intent(in) :: scene
      type(run_state), intent(inout) :: run
      type(run_report), intent(inout) :: report
      type(poinsot_error), intent(inout) :: error
      type(restart_state) :: saved
      if (len(scene%from) == 0) return
      call read_restart(scene%from, kinds_of(scene), saved, run%states, run%holders, error)
      if (raised(error)) return
      if (saved%t >= scene%t_end) then
         call raise(error, poinsot_e_scene, scene%from // ": is at t = " // text_of(saved%t) // &
                    ", not before t_end = " // text_of(scene%t_end))
      else if (saved%method /= scene%method) then
         call differs("method", saved%method, scene%method)
      else if (saved%splitting /= scene%splitting .and. scene%splitting /= "auto") then
         call differs("splitting", saved%splitting, scene%splitting)
      else if (saved%splitting == "taylor" .and. abs(saved%tolerance - scene%tolerance) > 0) then
         call differs("tolerance", text_of(saved%tolerance), text_of(scene%tolerance))
      else if (abs(saved%h - scene%h) > 0) then
         call differs("h", text_of(saved%h), text_of(scene%h))
      else if (saved%seed /= scene%seed .and. .not. scene%reseed) then
         call differs("seed", text_of(saved%seed), text_of(scene%seed))
      end if
      if (raised(error)) return
      run%t = saved%t
      run%step = saved%step
      report%splitting = saved%splitting
      if (saved%seed /= scene%seed) report%branch = "branched off at t = " // text_of(saved%t) // &
         ": seed " // text_of(scene%seed) // " from there on, " // text_of(saved%seed) // " before"

   contains

      subroutine differs(key, old, new)
         character(*), intent(in) :: key, old, new
         character(:), allocatable :: hint
         hint = ""
         if (key == "seed") hint = ", except with reseed = .true., which makes a branch"
         call raise(error, poinsot_e_scene, scene%from // ": was written with " // key // " = " // &
                    old // ", the scene has " // new // "; a continuation must not change it" // &
                       hint)
      end subroutine differs

   end subroutine continue_from

   !> Piece by piece to the end, or until the watch requests a stop.
   subroutine integrate(scene, run, watch, ranks, report, error)
      type(scene_settings), intent(in) :: scene
      type(run_state), intent(inout) :: run
      class(run_watch), intent(inout) :: watch
      class(communicator), intent(inout) :: ranks
      type(run_report), intent(inout) :: report
      type(poinsot_error), intent(inout) :: error
      type(piece) :: part
      integer(i8) :: k, done
      do k = 1, piece_count(scene)
         part = get_piece(scene, k)
         call enter_piece(run%t, part, done)
         if (done >= part%steps) cycle
         call integrate_piece(scene, part, done, run, watch, ranks, report, error)
         if (raised(error) .or. run%stopped) return
         if (part%writes) then
            if (run%writes) call frame(scene, run, report, error)
            call ranks%share_error(error)
         end if
         if (raised(error)) return
         call watch%report_progress(run%t, scene%t_end)
      end do
   end subroutine integrate

   !> Where in a piece time t lies: steps done already. A time between two steps (another schedule
   !> wrote the restart) makes a piece of its own from t on.
   subroutine enter_piece(t, part, done)
      real(dp), intent(in) :: t
      type(piece), intent(inout) :: part
      integer(i8), intent(out) :: done
      done = 0
      if (t <= part%from) return
      done = part%steps
      if (t >= part%to) return
      done = nint((t - part%from)/part%h, i8)
      if (abs(time_in(part, done) - t) <= 0) return
      done = 0
      part%steps = whole_steps(t, part%to, part%h)
      part%from = t
      part%h = (part%to - t)/real(part%steps, dp)
   end subroutine enter_piece

   !> Time after `done` steps of a piece.
   pure real(dp) function time_in(part, done) result(t)
      type(piece), intent(in) :: part
      integer(i8), intent(in) :: done
      t = part%from + real(done, dp)*part%h
      if (done >= part%steps) t = part%to
   end function time_in

   !> The steps of one piece, in chunks between looks at the watch. Bits do not depend on where
   !> chunks end, but for a splitting with a processor, which works at both ends of each: there
   !> their length is fixed, and no matter of the clock.
   subroutine integrate_piece(scene, part, done, run, watch, ranks, report, error)
      type(scene_settings), intent(in) :: scene
      type(piece), intent(in) :: part
      integer(i8), intent(inout) :: done
      type(run_state), intent(inout) :: run
      class(run_watch), intent(inout) :: watch
      class(communicator), intent(inout) :: ranks
      type(run_report), intent(inout) :: report
      type(poinsot_error), intent(inout) :: error
      integer(i8) :: steps, most
      real(dp) :: begun, origin
      logical :: processed
      origin = part%from - real(run%step - done, dp)*part%h
      processed = size(run%engine%plan%splitting%enter) > 0
      most = max(merge(processed_chunk, 1_i8, processed), &
         int(first_chunk/real(body_total(scene), dp), i8))
      do while (done < part%steps)
         ! what depends on a clock or a signal is rank 0's to say
         if (watch%stop_now()) most = -most
         most = ranks%broadcast(most)
         run%stopped = most < 0
         if (run%stopped) return
         steps = min(most, part%steps - done)
         begun = wall_clock()
         call engine_step(run%engine, run%states, origin, part%h, run%step, steps, error, &
            run%holders)
         if (run%holders%size == 1) call ranks%share_error(error)
         begun = wall_clock() - begun
         report%stepping = report%stepping + begun
         if (.not. processed) then
            if (begun < short .and. steps == most) most = 2*most
            if (begun > long) most = max(1_i8, most/2)
         end if
         if (raised(error)) return
         done = done + steps
         run%step = run%step + steps
         report%steps = report%steps + steps
         if (report%shortest > 0) report%shortest = min(report%shortest, part%h)
         if (.not. report%shortest > 0) report%shortest = part%h
         report%longest = max(report%longest, part%h)
         run%t = time_in(part, done)
         if (done < part%steps) call watch%report_progress(run%t, scene%t_end)
      end do
   end subroutine integrate_piece

   !> Energies, changes, and the frame itself, by all ranks. An error may be of rank 0 alone.
   subroutine frame(scene, run, report, error)
      type(scene_settings), intent(in) :: scene
      type(run_state), intent(inout) :: run
      type(run_report), intent(inout) :: report
      type(poinsot_error), intent(inout) :: error
      call engine_energy(run%engine, run%states, run%t, run%kinetic, run%potential, error)
      if (.not. raised(error) .and. .not. (all(ieee_is_finite(run%kinetic)) .and. &
          all(ieee_is_finite(run%potential)))) then
         call raise(error, poinsot_e_domain, "at t = " // text_of(run%t) // &
            " the energy is beyond the range of numbers; use other units, or smaller settings")
      end if
      call run%holders%share_error(error)
      if (raised(error)) return
      call follow_drift(run%states, run%kinetic, run%potential, run%holders, report%drift)
      call write_frame(run%frames, scene, run%t, run%states, run%kinetic, run%potential, &
         run%holders, error)
      call add_view_frame(run%view, run%t, run%states, run%kinetic, run%potential, report%drift, &
         run%holders)
      report%outputs = report%outputs + 1
   end subroutine frame

   !> The restart file.
   subroutine save_restart(scene, out, run, report, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: out
      type(run_state), intent(inout) :: run
      type(run_report), intent(inout) :: report
      type(poinsot_error), intent(inout) :: error
      type(restart_state) :: saved
      character(:), allocatable :: path
      if (len(scene%output%restart) == 0) return
      if (.not. (scene%output%present .or. run%stopped)) return
      path = out // "/" // scene%output%restart
      if (.not. scene%output%present .and. file_exists(path)) then
         call raise(error, poinsot_e_io, path // ": exists and was not written by an earlier " // &
            "run, so it is not replaced; no restart file was written")
         return
      end if
      saved%method = report%method
      saved%splitting = report%splitting
      saved%t = run%t
      saved%h = scene%h
      if (saved%splitting == "taylor") saved%tolerance = scene%tolerance
      saved%step = run%step
      saved%seed = scene%seed
      saved%kinds = kinds_of(scene)
      call write_restart(path, saved, run%states, run%holders, error)
      if (.not. raised(error)) report%restart = path
   end subroutine save_restart

   !> A hash of this scene's bodies.
   pure integer(i8) function kinds_of(scene)
      type(scene_settings), intent(in) :: scene
      real(dp) :: moments(3, size(scene%bodies))
      integer(i8) :: counts(size(scene%bodies))
      integer :: i
      do i = 1, size(scene%bodies)
         counts(i) = scene%bodies(i)%count
         moments(:, i) = scene%bodies(i)%moments
      end do
      kinds_of = sum_of_kinds(counts, moments)
   end function kinds_of

   !> Seconds on some clock.
   real(dp) function wall_clock()
      integer(i8) :: count, rate
      call system_clock(count, rate)
      wall_clock = real(count, dp)/real(max(rate, 1_i8), dp)
   end function wall_clock

end module poinsot_scene_run
