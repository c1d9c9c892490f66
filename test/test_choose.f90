!> The choice of method, splitting and step: what it promises is kept, on scenes it has not seen;
!> and it costs little more than the best there is (the long suite, which times).
module test_choose
   use, intrinsic :: iso_fortran_env, only: output_unit
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, i8, qp
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_convergence, poinsot_e_method
   use poinsot_scene_engine, only: engine, start_engine, engine_step
   use poinsot_scene_communicator, only: communicator
   use poinsot_scene_restart, only: restart_state, write_restart
   use poinsot_scene_schedule, only: piece, piece_count, get_piece
   use poinsot_scene_settings, only: scene_settings, body_total, is_auto
   use poinsot_scene_states, only: body_states, first_states
   use poinsot_scene_text, only: text_of
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_auto, only: resolve_auto
   use poinsot_study_candidates, only: candidate, plan_splitting, any_name
   use poinsot_study_choice, only: choose_request, choice, chosen_scene, tolerance_kept, &
      motion_chaotic, time_ran_out
   use poinsot_study_choose, only: choose_method
   use poinsot_study_choose_rank, only: best_of, pick_finalists, finalists
   use poinsot_study_choose_trials, only: prepare_task
   use poinsot_study_choose_text, only: verdict
   use poinsot_study_clock, only: limit_in
   use poinsot_study_errors, only: end_state, compare_states
   use poinsot_study_fill_scene, only: set_keys, set_as_told, text_line
   use poinsot_study_members, only: member_set, draw_members, repeat_members
   use poinsot_study_search, only: problem, contender, search_steps, step_of
   use poinsot_study_statistics, only: median
   use poinsot_study_timing, only: time_steps
   use poinsot_study_torque_series, only: torque_problem, torque_problems, turn_under_torque, &
      fine
   use poinsot_study_trial, only: make_plan, set_tolerance
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_taylor_settings, only: least_tolerance
   use test_expectation, only: expect
   use test_judge_scene, only: judge_members
   use test_oracle_data, only: top_case, read_top
   use test_scene_tools, only: ask_app, get_text
   use test_random_scenes, only: random_scene, harder_scene, scene_from
   use test_study, only: open_scene, as_it_is
   implicit none(type, external)
   private
   public :: collect_choose, collect_choose_deep, one_scene

   integer, parameter :: many_scenes = 100
   integer, parameter :: quick_scenes(6) = [1002, 1008, 1011, 1013, 1014, 1019] !! soon chosen for
   real(dp), parameter :: exhaustive_slack = 8 !! times as dear as another, seen in passing

contains

   subroutine collect_choose(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("scene text: keys set where they stand", keys_in_place), &
         new_unittest("scene text: keys added", keys_added), &
         new_unittest("scene text: settings of a command line", settings_added), &
         new_unittest("scene text: settings over several lines", settings_over_lines), &
         new_unittest("the judge: published tops, every effect", judge_itself), &
         new_unittest("top: the tolerance is met", top_choice), &
         new_unittest("every body of many is within the tolerance", many_bodies), &
         new_unittest("several kinds of body", several_kinds), &
         new_unittest("a chaotic motion is called so", chaotic_motion), &
         new_unittest("a chaotic motion over a long time", long_chaos), &
         new_unittest("friction: a Taylor series where splittings have order 2", friction_choice), &
         new_unittest("of equal times the most accurate", ties), &
         new_unittest("command line: settings, exit codes", exit_codes), &
         new_unittest("choice among names", named_choice), &
         new_unittest("a tolerance beyond reach is refused", beyond_reach), &
         new_unittest("auto: settled once, a restart goes on with it", auto_settled), &
         new_unittest("random scenes keep the promise", small_promise)]
   end subroutine collect_choose

   subroutine collect_choose_deep(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [new_unittest("100 random scenes: promise kept, nearly the cheapest", &
         large_promise)]
   end subroutine collect_choose_deep

   !> Values in every place a file may have them.
   subroutine keys_in_place(error)
      type(error_type), allocatable, intent(out) :: error
      type(text_line), allocatable :: lines(:)
      logical :: found
      call three_lines("! &scene h = 7", "&SCENE t_end=1, H = 0.5 ! h = 3", "  method='exact' /", &
         lines)
      call set_keys(lines, "scene", [character(6) :: "h", "method"], [text_line("0.25"), &
         text_line("'dmv8'")], found)
      call expect(error, found .and. size(lines) == 3, "no line is added")
      if (allocated(error)) return
      call expect(error, lines(1)%text, "! &scene h = 7")
      call expect(error, lines(2)%text, "&SCENE t_end=1, H = 0.25 ! h = 3")
      call expect(error, lines(3)%text, "  method='dmv8' /")
   end subroutine keys_in_place

   !> Keys that the file has not got, on a line of their own or within the group's only line.
   subroutine keys_added(error)
      type(error_type), allocatable, intent(out) :: error
      type(text_line), allocatable :: lines(:)
      logical :: found
      call three_lines("&bodies h = 1 /", "&scene ! run", "   t_end = 1 /", lines)
      call set_keys(lines, "scene", ["h"], [text_line("0.25")], found)
      call expect(error, found .and. size(lines) == 4, "a line is added")
      if (allocated(error)) return
      call expect(error, lines(1)%text // lines(3)%text, "&bodies h = 1 /   h = 0.25")
      call three_lines("", "&scene t_end = 1 /", "&bodies y = 1, 0, 0 /", lines)
      call set_keys(lines, "scene", ["h"], [text_line("0.25")], found)
      call expect(error, lines(2)%text, "&scene h = 0.25, t_end = 1 /")
   end subroutine keys_added

   !> What --set changed is in the scene that is written.
   subroutine settings_added(error)
      type(error_type), allocatable, intent(out) :: error
      type(text_line), allocatable :: lines(:)
      call three_lines("&scene t_end = 1 /", "&bodies moments = 1, 2, 2.5, y = 1, 0, 0 /", &
         "&bodies moments = .5, .5, .7 omega = 1, 2, 3 /", lines)
      call set_as_told(lines, "bodies.moments=3,3,1")
      call set_as_told(lines, "bodies(2).omega=0,0,1")
      call set_as_told(lines, "gravity.centre=0,0,1")
      call expect(error, size(lines) == 4, "a group is added")
      if (allocated(error)) return
      call expect(error, lines(2)%text, "&bodies moments = 3,3,1, y = 1, 0, 0 /")
      call expect(error, lines(3)%text, "&bodies moments = .5, .5, .7 omega = 0,0,1 /")
      call expect(error, lines(4)%text, "&gravity centre = 0,0,1 /")
      if (allocated(error)) return
      call set_as_told(lines, "gravity.centre(2:3)=.1,.2")
      call set_as_told(lines, "bodies(2).moments(1)=.6")
      call expect(error, lines(4)%text, "&gravity centre = 0,0,1, centre(2:3) = .1,.2 /")
      call expect(error, lines(3)%text, &
         "&bodies moments = .5, .5, .7 omega = 0,0,1, moments(1) = .6 /")
   end subroutine settings_added

   !> Values over several lines, beside some of their numbers on lines of their own: one is left.
   subroutine settings_over_lines(error)
      type(error_type), allocatable, intent(out) :: error
      type(text_line), allocatable :: lines(:)
      allocate (lines(7))
      lines(1)%text = "&bodies ! 'moments(1) = 3"
      lines(2)%text = "   moments = 1, ! the first,"
      lines(3)%text = "      2*1.5, y(2) = 1"
      lines(4)%text = "   moments(3) = 2.5"
      lines(5)%text = "   file = 'moments = 1, 2 /', Moments (1) = 1.2, y(1) = 1"
      lines(6)%text = "/ moments = 4"
      lines(7)%text = "&scene /"
      call set_as_told(lines, "bodies.moments=3,3,1")
      call set_as_told(lines, "bodies.y(3)=2")
      call expect(error, size(lines) == 6, "lines left")
      if (allocated(error)) return
      call expect(error, lines(2)%text // lines(3)%text, "   moments = 3,3,1, y(2) = 1" // &
         "   file = 'moments = 1, 2 /', y(1) = 1")
      call expect(error, lines(4)%text // lines(5)%text, "   y(3) = 2/ moments = 4")
   end subroutine settings_over_lines

   !> The judge of choices by the published tops and, on random scenes of all kinds, beside the
   !> quadruple reference of cost and choose, with which it shares nothing.
   subroutine judge_itself(error)
      type(error_type), allocatable, intent(out) :: error
      type(top_case), allocatable :: tops(:)
      type(scene_settings) :: scene
      type(poinsot_plan) :: plan
      type(poinsot_error) :: failure
      type(torque_problem), allocatable :: problems(:)
      type(member_set) :: members
      type(end_state) :: judged
      real(dp), allocatable :: angle(:), momentum(:)
      character(:), allocatable :: text
      real(qp) :: t, y(3, 1), q(4, 1)
      real(dp) :: doubt, off
      integer :: k
      logical :: known, done
      call read_top(tops)
      call expect(error, size(tops) >= 12, "data/top.csv")
      do k = 1, size(tops)
         associate (top => tops(k))
            call scene_from("&scene t_end = " // text_of(top%t) // ", h = 1 /" // new_line("a") // &
               "&bodies moments = " // text_of(top%moments) // ", y = " // text_of(top%y) // &
               ", q = " // text_of(top%q) // " /" // new_line("a") // "&field dipole = " // &
               text_of(-top%centre) // ", strength = " // text_of(top%direction) // " /", &
               "top.nml", scene, failure)
            call draw_members(scene, .false., 1, 0.0_dp, members, failure)
            if (.not. raised(failure)) call judge_members(scene, members, top%t, judged%y, &
               judged%q, doubt, known)
            call expect(error, .not. raised(failure) .and. known, "a top that the judge takes")
            if (allocated(error)) return
            call compare_states(reshape(top%y_end, [3, 1]), reshape(top%q_end, [4, 1]), judged, &
               angle, momentum)
            off = max(angle(1), momentum(1))
            call expect(error, off < merge(1e-16_dp, 1e-14_dp, k == 1), "top " // text_of(k) // &
               ": off by " // text_of(real(real(off), dp)))
            if (allocated(error)) return
         end associate
      end do
      do k = 1, 30
         if (k <= 24) call random_scene(k, scene, text, failure)
         if (k > 24) call harder_scene(k - 24, scene, text, failure)
         call draw_members(scene, .false., 1, 0.0_dp, members, failure)
         if (.not. raised(failure)) call make_plan(scene, "exact", "taylor", plan, failure)
         if (.not. raised(failure)) call torque_problems(plan, problems, failure)
         if (.not. raised(failure)) call judge_members(scene, members, 3.0_dp, judged%y, judged%q, &
            doubt, known)
         call expect(error, .not. raised(failure) .and. known, "scene " // text_of(k) // text)
         if (allocated(error)) return
         y = members%y
         q = members%q
         t = 0
         call turn_under_torque(problems(1), fine, t, 3.0_qp, 1000, y(:, 1), q(:, 1), done)
         call compare_states(y, q, judged, angle, momentum)
         off = max(angle(1), momentum(1))
         call expect(error, done .and. off < 1e-15_dp .and. doubt < 1e-15_dp, text // &
            "judge and reference differ by " // text_of(real(real(off), dp)) // ", doubt " // &
            text_of(real(real(doubt), dp)))
         if (allocated(error)) return
      end do
   end subroutine judge_itself

   !> More bodies than are tried: all of them are tested, from start to end.
   subroutine many_bodies(error)
      type(error_type), allocatable, intent(out) :: error
      type(choice) :: answer
      type(scene_settings) :: scene
      real(dp) :: off
      type(poinsot_error) :: failure
      call choose_for("&scene t_end = 5, method = 'auto', tol = 1e-7 /" // new_line("a") // &
         "&bodies count = 2000, moments = .55, .9, .7, random = 'thermal', temperature = .5 /" // &
         new_line("a") // "&gravity centre = 0, 0, 1 /", 1e-7_dp, [character(24) :: "omelyan6"], &
         scene, answer, failure)
      call expect(error, .not. raised(failure) .and. answer%checked .and. &
         answer%ended == tolerance_kept .and. answer%total == 2000, "all bodies are tested")
      if (allocated(error)) return
      call true_error(chosen_scene(scene, answer%best), off, failure)
      call expect(error, off <= 1e-7_dp, "every body is within the tolerance")
      call expect(error, abs(off - answer%best%error) < 0.1_dp*off, "as it was said")
   end subroutine many_bodies

   !> A top whose errors grow exponentially: refused with the time to which the tolerance holds.
   subroutine chaotic_motion(error)
      type(error_type), allocatable, intent(out) :: error
      type(choice) :: answer
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      call choose_for("&scene t_end = 200, h = 0.01 /" // new_line("a") // &
         "&bodies moments = 1, 2, 2.5, omega = 0.5, 0.2, 1.0, " // &
         "q = 0.9, 0.435889894354067, 0, 0 /" // new_line("a") // &
         "&gravity centre = 0.3, 0.2, 1, weight = 1 /", 1e-12_dp, [character(24) :: "taylor"], &
         scene, answer, failure)
      call expect(error, .not. raised(failure) .and. answer%ended == motion_chaotic, &
         verdict(scene, 1e-12_dp, answer))
      if (allocated(error)) return
      call expect(error, answer%growth%holds > 20 .and. answer%growth%holds < 200 .and. &
         answer%growth%fold > 2 .and. answer%growth%fold < 50, verdict(scene, 1e-12_dp, answer))
   end subroutine chaotic_motion

   !> So long that errors are full grown in a hundredth of the time, and that the time is short: it
   !> is called chaotic all the same, whatever else could be tried.
   subroutine long_chaos(error)
      type(error_type), allocatable, intent(out) :: error
      type(choice) :: answer
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      call choose_for("&scene t_end = 20000, h = 0.01 /" // new_line("a") // &
         "&bodies moments = 1, 2, 2.5, omega = 0.5, 0.2, 1.0, " // &
         "q = 0.9, 0.435889894354067, 0, 0 /" // new_line("a") // &
         "&gravity centre = 0.3, 0.2, 1, weight = 1 /" // new_line("a") // &
         "&output every = 5 /", 1e-6_dp, any_name, scene, answer, failure)
      call expect(error, .not. raised(failure) .and. answer%ended == motion_chaotic, &
         verdict(scene, 1e-6_dp, answer))
      if (allocated(error)) return
      call expect(error, answer%growth%holds > 100 .and. answer%growth%holds < 500 .and. &
         answer%growth%fold > 2 .and. answer%growth%fold < 50, verdict(scene, 1e-6_dp, answer))
   end subroutine long_chaos

   !> Of those within 10 % of the least time the most accurate; a dearer one never.
   subroutine ties(error)
      type(error_type), allocatable, intent(out) :: error
      type(contender) :: four(4)
      real(dp) :: cost_of(4), five(5)
      integer :: at(finalists), i, n
      four%error = [3.6e-12_dp, 4.5e-15_dp, 1e-13_dp, 1e-16_dp]
      cost_of = [1.0_dp, 1.09_dp, 1.02_dp, 1.12_dp]
      call expect(error, best_of(four, cost_of), 2)
      cost_of(2) = 1.11_dp
      call expect(error, best_of(four, cost_of), 3)
      cost_of(3) = 1e100_dp ! does not meet the tolerance
      call expect(error, best_of(four, cost_of), 1)
      if (allocated(error)) return
      ! who is timed again: the cheapest as seen in passing, and taylor
      five = [1.0_dp, 1.1_dp, 1.2_dp, 1.4_dp, 7.0_dp]
      call pick_finalists(five, [(.false., i=1, 5)], at, n)
      call expect(error, n == 4 .and. all(at(:4) == [1, 2, 3, 4]), "the cheapest")
      five = [1.0_dp, 1.1_dp, 1.2_dp, 1.4_dp, 7.0_dp]
      call pick_finalists(five, [(i == 5, i=1, 5)], at, n)
      call expect(error, n == 5 .and. at(5) == 5, "taylor, timed once, is timed again")
   end subroutine ties

   !> 0 with what --set said tried, and in the scene written; 4 where nothing keeps the tolerance,
   !> and where a run under `auto` does not.
   subroutine exit_codes(error)
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: got, text
      character(*), parameter :: out = " --out build/test-choose.nml"
      call ask_app("choose heavy-top --tol 1e-4 --methods exact --splittings taylor --quiet " &
         // "--set gravity.centre=0,0,0.75" // out, got, error)
      if (allocated(error)) return
      call expect(error, got, "exit 0" // new_line("a"))
      if (allocated(error)) return
      call get_text("build/test-choose.nml", text)
      call expect(error, index(text, "centre = 0,0,0.75") > 0 .and. &
         index(text, "'taylor'") > 0, text)
      if (allocated(error)) return
      call ask_app("choose heavy-top --tol 1e-14 --methods exact --splittings strang --budget 1s " &
         // "--set scene.t_end=5" // out, got, error)
      if (allocated(error)) return
      call expect(error, index(got, "heavy-top to t = 5.0" // new_line("a")) > 0 .and. &
         index(got, "comes nearest, with an error of ") > 0 .and. index(got, " at t = 5") > 0 &
         .and. index(got, "exit 4") > 0, got)
      if (allocated(error)) return
      call ask_app("run heavy-top --no-view --no-pictures --quiet --out build/test-choose-run " // &
         "--set scene.splitting=auto --set scene.method=dmv2 --set scene.tol=1e-14", got, error)
      if (allocated(error)) return
      call expect(error, index(got, "auto: the end is not within tol = 1e-14: ") > 0 .and. &
         index(got, "exit 4") > 0, got)
   end subroutine exit_codes

   !> Of one to five kinds: a plan has room for more classes than it has.
   subroutine several_kinds(error)
      type(error_type), allocatable, intent(out) :: error
      type(choice) :: answer
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      character(:), allocatable :: text
      character(4) :: moment
      integer :: kinds
      text = "&scene t_end = 2, h = 0.02 /" // new_line("a") // "&gravity centre = 0, 0, 1 /"
      do kinds = 1, 5
         write (moment, "(f4.1)") 1.4_dp + 0.1_dp*kinds
         text = text // new_line("a") // "&bodies moments = 1, 1.2, " // moment // &
            ", y = 1, .1, .2 /"
         call choose_for(text, 1e-8_dp, any_name, scene, answer, failure)
         call expect(error, .not. raised(failure) .and. answer%ended == tolerance_kept, "refused")
         call expect(error, answer%best%error <= 1e-8_dp, "beyond the tolerance")
      end do
   end subroutine several_kinds

   !> Drag limits every splitting to order 2.
   subroutine friction_choice(error)
      type(error_type), allocatable, intent(out) :: error
      type(choice) :: answer
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      call choose_for("&scene t_end = 20, h = 0.01 /" // new_line("a") // &
         "&bodies moments = .6, .8, 1, y = 1.8, .4, -.9 /" // new_line("a") // &
         "&gravity centre = 0, 0, 1 /" // new_line("a") // "&drag friction = .05 /", 1e-8_dp, &
         any_name, scene, answer, failure)
      call expect(error, .not. raised(failure) .and. answer%ended == tolerance_kept .and. &
         answer%best%setup%adaptive .and. answer%best%error <= 1e-8_dp .and. &
         .not. answer%noisy, "taylor, within the tolerance")
   end subroutine friction_choice

   subroutine choose_for(text, tol, splittings, scene, answer, failure)
      character(*), intent(in) :: text
      real(dp), intent(in) :: tol
      character(24), intent(in) :: splittings(:)
      type(scene_settings), intent(out) :: scene
      type(choice), intent(out) :: answer
      type(poinsot_error), intent(inout) :: failure
      type(choose_request) :: request
      type(run_watch) :: watch
      call scene_from(text, "test.nml", scene, failure)
      request%tol = tol
      request%methods = [character(24) :: "exact"]
      request%splittings = splittings
      if (.not. raised(failure)) call choose_method(scene, request, watch, answer, failure)
   end subroutine choose_for

   subroutine three_lines(a, b, c, lines)
      character(*), intent(in) :: a, b, c
      type(text_line), allocatable, intent(out) :: lines(:)
      allocate (lines(3))
      lines(1)%text = a
      lines(2)%text = b
      lines(3)%text = c
   end subroutine three_lines

   !> Against the published end of the top.
   subroutine top_choice(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(body_states) :: states
      type(poinsot_error) :: failure
      type(run_watch) :: watch
      call open_scene("heavy-top", [character(40) :: "scene.method='auto'", "scene.h=1", &
         "scene.tol=1e-9", &
                                    "output.every=1"], scene, failure)
      if (.not. raised(failure)) call resolve_auto(scene, watch, failure)
      if (.not. raised(failure)) call run_through(scene, states, failure)
      call expect(error, .not. raised(failure) .and. .not. is_auto(scene) .and. scene%h <= 1, &
         "chosen, and run")
      call expect(error, norm2(states%y(:, 1) - [1.922573381663007_dp, 0.7720232344670848_dp, &
                                               -0.2011054792035490_dp])/norm2(states%y(:, &
                                                  1)) < 1e-9_dp, "momentum")
      call expect(error, 2*norm2(states%q(:, 1) - [0.9257399890934638_dp, -0.3514906679727545_dp, &
                                                 0.1021838760186523_dp, &
                                                    -0.0949644059798463_dp]) < 1e-9_dp, "attitude")
   end subroutine top_choice

   !> The scene as `poinsot run` takes it, without files.
   subroutine run_through(scene, states, error)
      type(scene_settings), intent(in) :: scene
      type(body_states), intent(out) :: states
      type(poinsot_error), intent(inout) :: error
      type(engine) :: motor
      type(piece) :: part
      integer(i8) :: k, done
      call first_states(scene, states, error)
      if (.not. raised(error)) call start_engine(scene, motor, error)
      done = 0
      do k = 1, piece_count(scene)
         if (raised(error)) return
         part = get_piece(scene, k)
         call engine_step(motor, states, part%from - real(done, dp)*part%h, part%h, done, &
            part%steps, error)
         done = done + part%steps
      end do
   end subroutine run_through

   subroutine named_choice(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(choose_request) :: request
      type(choice) :: answer
      type(run_watch) :: watch
      type(poinsot_error) :: failure
      call open_scene("heavy-top", as_it_is, scene, failure)
      request%tol = 1e-5_dp
      request%methods = [character(24) :: "dmv8"]
      request%splittings = [character(24) :: "srkn4", "strang"]
      call choose_method(scene, request, watch, answer, failure)
      call expect(error, .not. raised(failure) .and. answer%best%setup%method == "dmv8", &
         "the method named")
      call expect(error, answer%best%setup%splitting == "srkn4" .or. &
         answer%best%setup%splitting == "strang", &
                 "a splitting named")
      call expect(error, answer%best%error <= 1e-5_dp .and. answer%best%h > 0, &
         "within the tolerance")
   end subroutine named_choice

   !> Order 2 does not come to 1e-14 in two seconds; the message says how far it comes.
   subroutine beyond_reach(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(choose_request) :: request
      type(choice) :: answer
      type(run_watch) :: watch
      type(poinsot_error) :: failure
      call open_scene("heavy-top", as_it_is, scene, failure)
      request%tol = 1e-14_dp
      request%budget = 2
      request%methods = [character(24) :: "exact"]
      request%splittings = [character(24) :: "strang"]
      call choose_method(scene, request, watch, answer, failure)
      call expect(error, .not. raised(failure) .and. answer%ended /= tolerance_kept .and. &
         answer%best%h > 0 .and. answer%best%error > 1e-14_dp, "not kept, and the nearest is there")
      call expect(error, index(verdict(scene, request%tol, answer), &
         "exact + strang comes nearest, with an error of ") > 0, "says what comes nearest")
   end subroutine beyond_reach

   subroutine auto_settled(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(restart_state) :: saved
      type(body_states) :: states
      type(communicator) :: alone
      type(run_watch) :: watch
      type(poinsot_error) :: failure
      character(*), parameter :: file = "build/test-auto-restart.txt"
      call open_scene("heavy-top", [character(40) :: "scene.splitting='auto'", "scene.tol=1e-4"], &
         scene, failure)
      call expect(error, .not. raised(failure) .and. is_auto(scene), "to be settled")
      call resolve_auto(scene, watch, failure)
      call expect(error, .not. raised(failure) .and. .not. is_auto(scene) .and. &
         scene%method == "exact" .and. &
                 len(scene%chosen) > 0, "the method named is kept, the splitting chosen")
      saved%method = "dmv6"
      saved%splitting = "suzuki4"
      saved%h = 0.125_dp
      states%n = 1
      states%total = 1
      allocate (states%y(3, 1), states%q(4, 1), states%carry(7, 1), source=0.0_dp)
      call write_restart(file, saved, states, alone, failure)
      call open_scene("heavy-top", [character(60) :: "scene.method='auto'", "scene.from='" // &
         file // "'"], scene, &
                      failure)
      if (.not. raised(failure)) call resolve_auto(scene, watch, failure)
      call expect(error, .not. raised(failure) .and. scene%method == "dmv6" .and. &
         scene%splitting == "suzuki4" .and. &
                 abs(scene%h - 0.125_dp) <= 0, "a restart never chooses again")
   end subroutine auto_settled

   !> The promise is for 95 of 100 scenes, and which method a scene gets depends on the clock: one
   !> miss in six is let pass (two come by chance in 3 of 100 runs if the promise barely holds).
   subroutine small_promise(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: ratio
      integer :: k, missed, met
      logical :: kept, told
      character(:), allocatable :: line
      missed = 0
      met = 0
      do k = 1, size(quick_scenes)
         call one_scene(quick_scenes(k), 4.0_dp, .false., kept, told, ratio, line)
         if (kept) met = met + 1
         if (.not. (kept .or. told)) missed = missed + 1
         call expect(error, missed <= 1, line)
      end do
      call expect(error, 2*met >= size(quick_scenes), "most scenes get a method")
   end subroutine small_promise

   !> The two figures of the promise: it is kept in 97 of 100 scenes, and in 95 the choice takes at
   !> most 1.3 times as long as the best of an exhaustive search. Every other scene is one of the
   !> hard ones. A refusal keeps the promise where `taylor` at its finest is beyond the tolerance.
   !> Scenes 1 to 100, or those from the number in POINSOT_FIRST_SCENE on.
   subroutine large_promise(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: ratio, ratios(many_scenes)
      integer :: n, first, good, chosen, near, stat
      logical :: kept, told
      character(:), allocatable :: line
      character(12) :: value
      first = 1
      call get_environment_variable("POINSOT_FIRST_SCENE", value, status=stat)
      if (stat == 0) read (value, *) first
      good = 0
      chosen = 0
      near = 0
      do n = 1, many_scenes
         call one_scene(first + n - 1, 20.0_dp, .true., kept, told, ratio, line)
         if (kept .or. told) good = good + 1
         if (kept) then
            chosen = chosen + 1
            ratios(chosen) = ratio
            if (ratio <= 1.3_dp) near = near + 1
         end if
         write (output_unit, "(4(a, i0), 2a)") "kept ", good, " of ", n, ", within 1.3 ", near, &
            " of ", chosen, ": ", line
         flush (output_unit)
      end do
      write (output_unit, "(2(a, f0.2))") "time against the best: median ", &
         median(ratios(:chosen)), ", largest ", maxval(ratios(:chosen))
      call expect(error, good >= 97, "promise kept in fewer than 97 of 100")
      call expect(error, near >= 0.95_dp*chosen, "beyond 1.3 times the best in more than 5 of 100")
   end subroutine large_promise

   !> Choose for a random scene, run it, have all its bodies judged.
   subroutine one_scene(k, budget, exhaustive, kept, told, ratio, line)
      integer, intent(in) :: k
      real(dp), intent(in) :: budget
      logical, intent(in) :: exhaustive
      logical, intent(out) :: kept                !! the error is within the tolerance
      logical, intent(out) :: told                !! nothing meets it, as the choice said
      real(dp), intent(out) :: ratio              !! time against the best found
      character(:), allocatable, intent(out) :: line
      type(scene_settings) :: scene, done
      type(choose_request) :: request
      type(choice) :: answer
      type(run_watch) :: watch
      type(poinsot_error) :: failure
      character(:), allocatable :: text
      real(dp) :: off
      kept = .false.
      told = .false.
      ratio = 1
      if (exhaustive .and. mod(k, 2) == 0) then
         call harder_scene(k/2, scene, text, failure)
      else
         call random_scene(k, scene, text, failure)
      end if
      line = "scene " // text_of(k) // ": "
      request%tol = scene%tol
      request%budget = budget
      request%methods = any_name
      request%splittings = any_name
      if (.not. raised(failure)) call choose_method(scene, request, watch, answer, failure)
      if (raised(failure)) then
         line = line // failure%message
         return
      end if
      if (answer%ended /= tolerance_kept) then
         told = answer%ended /= time_ran_out
         line = line // verdict(scene, request%tol, answer)
         if (told .and. exhaustive) then
            done = scene
            done%method = "exact"
            done%splitting = "taylor"
            done%tolerance = least_tolerance
            done%h = scene%t_end
            call true_error(done, off, failure)
            told = raised(failure) .or. off > scene%tol
            line = line // "; at its finest taylor has " // text_of(real(real(off), dp))
         end if
         if (exhaustive .and. .not. told) line = line // "  BROKEN" // new_line("a") // text
         return
      end if
      done = chosen_scene(scene, answer%best)
      call true_error(done, off, failure)
      if (raised(failure)) then
         line = line // failure%message
         return
      end if
      kept = off <= scene%tol
      if (exhaustive) call against_best(scene, request, answer, ratio)
      line = line // done%method // " + " // done%splitting // ", tol " // &
         text_of(real(real(scene%tol), dp)) // &
             ", predicted " // text_of(real(real(answer%best%error), dp)) // ", true " // &
             text_of(real(real(off), dp)) // ", time " // text_of(nint(100*ratio)) // &
                " % of the best, " // &
             text_of(nint(1000*answer%seconds)) // " ms"
      if (.not. kept) line = line // "  BROKEN" // new_line("a") // text
   end subroutine one_scene

   !> The largest error of all the scene's bodies at its end, by the judge's own equations. Error:
   !> POINSOT_E_METHOD where these do not know a torque.
   subroutine true_error(scene, off, error)
      type(scene_settings), intent(in) :: scene
      real(dp), intent(out) :: off
      type(poinsot_error), intent(inout) :: error
      type(body_states) :: states
      type(member_set) :: members
      type(end_state) :: judged
      real(dp), allocatable :: angle(:), momentum(:)
      real(dp) :: doubt
      logical :: known
      off = huge(off)
      call run_through(scene, states, error)
      if (.not. raised(error)) call draw_members(scene, .false., int(body_total(scene)), 0.0_dp, &
         members, error)
      if (raised(error)) return
      call judge_members(scene, members, scene%t_end, judged%y, judged%q, doubt, known)
      if (.not. known) call raise(error, poinsot_e_method, "the judge does not know this scene")
      if (raised(error)) return
      call compare_states(real(states%y, qp), real(states%q, qp), judged, angle, momentum)
      off = max(maxval(angle), maxval(momentum))
      if (doubt > 0.1_dp*scene%tol .and. doubt > 0.1_dp*off) call raise(error, &
         poinsot_e_convergence, "the judge is in doubt, by " // text_of(real(real(doubt), dp)))
   end subroutine true_error

   !> Time of the choice against the best of a search that gives nobody up early, all timed in turn.
   subroutine against_best(scene, request, answer, ratio)
      type(scene_settings), intent(in) :: scene
      type(choose_request), intent(in) :: request
      type(choice), intent(in) :: answer
      real(dp), intent(out) :: ratio
      type(problem) :: task
      type(candidate), allocatable :: list(:)
      type(contender), allocatable :: contenders(:)
      type(choice) :: again
      type(member_set) :: many
      type(run_watch) :: watch
      type(poinsot_error) :: failure
      type(poinsot_plan) :: plan
      real(dp) :: mine, ns(5)
      real(dp), allocatable :: times(:, :)
      integer :: i, round
      ratio = 1
      call prepare_task(scene, request, task, list, contenders, again, failure)
      if (raised(failure)) return
      call search_steps(task, contenders, exhaustive_slack, limit_in(20.0_dp, .false.), watch)
      call repeat_members(task%members, int(min(body_total(scene), 1024_i8)), many)
      if (task%members%together > 1) many = task%members
      call make_plan(scene, trim(answer%best%setup%method), plan_splitting(answer%best%setup), &
         plan, &
         failure)
      if (answer%best%tolerance > 0) call set_tolerance(plan, answer%best%tolerance)
      allocate (times(5, size(contenders)))
      do round = 1, 5
         call time_steps(plan, many, answer%best%h, answer%best%ns, 1e-3_dp, &
            nint(task%t_end/answer%best%h, i8), .true., &
            ns(round))
         do i = 1, size(contenders)
            times(round, i) = 0
            if (contenders(i)%met == 0) cycle
            associate (one => contenders(i))
               call time_steps(one%plan, many, step_of(one, one%met), one%ns*max(1, 32/many%n), &
                  1e-3_dp, one%unit*one%met, .true., times(round, i))
               times(round, i) = times(round, i)/step_of(one, one%met)
            end associate
         end do
      end do
      mine = median(ns)/answer%best%h
      ratio = 1
      do i = 1, size(contenders)
         if (contenders(i)%met > 0 .and. minval(times(:, i)) > 0) ratio = max(ratio, &
            mine/median(times(:, i)))
      end do
   end subroutine against_best

end module test_choose
