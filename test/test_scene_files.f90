!> Room scene: the files of a run and those of the user; locks; what a summary says.
module test_scene_files
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_is_nan
   use testdrive, only: new_unittest, unittest_type, error_type, skip_test
   use test_expectation, only: expect, within, refused, accepted
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_maxima, only: larger, largest_of
   use poinsot_core_status, only: poinsot_e_io, poinsot_e_scene
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_communicator, only: communicator
   use poinsot_scene_drift, only: drift_watch, start_drift, start_energy, follow_drift
   use poinsot_scene_claim, only: claim_files
   use poinsot_scene_files, only: file_exists, real_path
   use poinsot_scene_folder, only: folder_lock, lock_folder, unlock_folder
   use poinsot_scene_reader, only: scan_source
   use poinsot_scene_run, only: check_scene, run_scene
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_source, only: scene_source
   use poinsot_scene_states, only: body_states, first_states
   use poinsot_scene_summary, only: run_report
   use poinsot_scene_table, only: read_table
   use poinsot_scene_watch, only: run_watch
   use test_scene_tools, only: output, nl, empty_folder, put_text, get_text, make_scene, run_text
   implicit none(type, external)
   private
   public :: collect_scene_files

   character(*), parameter :: body = "&bodies moments=0.6,0.8,1.0 y=1.8,0.4,-0.9 /"
   character(*), parameter :: quiet = "&scene t_end=1 h=0.1 /" // body
   character(*), parameter :: written = quiet // "&output every=0.5 /"

   !> Stops at the first look.
   type, extends(run_watch) :: hasty
   contains
      procedure :: stop_now
   end type hasty

contains

   subroutine collect_scene_files(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("files-of-the-user", test_own_files), &
         new_unittest("files-of-a-study", test_study_files), &
         new_unittest("thousands-of-groups", test_many_groups), &
         new_unittest("files-of-an-earlier-run", test_earlier_files), &
         new_unittest("files-that-a-run-reads", test_inputs), &
         new_unittest("folder-locked", test_lock), &
         new_unittest("folder-locked-for-the-app", test_locked_app), &
         new_unittest("restart-by-other-names", test_restart_names), &
         new_unittest("restart-named-if-written", test_restart_hint), &
         new_unittest("summary-of-what-was-run", test_summary), &
         new_unittest("summary-with-noise", test_noise), &
         new_unittest("summary-without-outputs", test_unmeasured), &
         new_unittest("nan-is-not-lost", test_nan), &
         new_unittest("torque-file-forms", test_tables), &
         new_unittest("few-digits-in-bodies", test_few_digits)]
   end subroutine collect_scene_files

   logical function stop_now(self)
      class(hasty), intent(inout) :: self
      associate (unused => self)
      end associate
      stop_now = .true.
   end function stop_now

   subroutine still_mine(error, path)
      type(error_type), allocatable, intent(inout) :: error
      character(*), intent(in) :: path
      character(:), allocatable :: text
      call get_text(path, text)
      call expect(error, text == "mine", path // " is gone")
   end subroutine still_mine

   !> What the user has under the names of outputs stays: used names are refused, others left alone.
   subroutine test_own_files(error)
      type(error_type), allocatable, intent(out) :: error
      character(16), parameter :: names(6) = [character(16) :: "trajectory.csv", "trajectory.xyz", &
         "momentum.png", "restart.txt", "plot_drift.gp", "common.gp"]
      type(poinsot_error) :: failure
      integer :: i
      do i = 1, size(names)
         call empty_folder("own")
         call put_text(output // "own/" // trim(names(i)), "mine")
         call run_text(quiet, "own", failure)
         call accepted(error, failure)
         call still_mine(error, output // "own/" // trim(names(i)))
         call run_text(written, "own", failure)
         if (names(i) == "trajectory.xyz") then
            call accepted(error, failure)
         else
            call refused(error, failure, poinsot_e_io, trim(names(i)) // &
               ": this run would replace it")
         end if
         call still_mine(error, output // "own/" // trim(names(i)))
      end do
      call empty_folder("own")
      call put_text(output // "own/summary.txt", "mine")
      call run_text(quiet, "own", failure)
      call refused(error, failure, poinsot_e_io, "summary.txt: this run would replace it")
      call still_mine(error, output // "own/summary.txt")
   end subroutine test_own_files

   !> A study replaces what a study or a run wrote, and nothing else.
   subroutine test_study_files(error)
      type(error_type), allocatable, intent(out) :: error
      character(8), parameter :: names(2) = [character(8) :: "cost.csv", "cost.txt"]
      type(poinsot_error) :: failure
      character(:), allocatable :: folder
      folder = output // "study"
      call empty_folder("study")
      call put_text(folder // "/cost.txt", "mine")
      call claim_files(folder, names, failure)
      call refused(error, failure, poinsot_e_io, "cost.txt: this command would replace it")
      call still_mine(error, folder // "/cost.txt")
      call expect(error, .not. file_exists(folder // "/written.txt"), "a list of nothing")
      call empty_folder("study")
      call put_text(folder // "/written.txt", "mine")
      call claim_files(folder, names, failure)
      call refused(error, failure, poinsot_e_io, "written.txt: this command would replace it")
      call empty_folder("study")
      call claim_files(folder, [character(9) :: names, "common.gp"], failure)
      call put_text(folder // "/cost.csv", "of a study")
      call put_text(folder // "/common.gp", "of a study")
      call claim_files(folder, names, failure)
      call accepted(error, failure)
      call run_text(written, "study", failure)
      call accepted(error, failure)
      call claim_files(folder, ["trajectory.csv"], failure)
      call accepted(error, failure)
   end subroutine test_study_files

   !> Thousands of groups, each of them a class with a torque of its own, in their order.
   subroutine test_many_groups(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: many = 4000
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      character(100) :: line
      character(:), allocatable :: text
      integer :: i, first
      allocate (character(many*len(line)) :: text)
      text(:) = "&scene t_end=1 h=0.1 /"
      first = 101
      do i = 1, many - 1
         write (line, "(a, i0, a, i0, a, i0, a)") "&bodies moments=1,1,1 y=", i, &
            ",0,0 /&torque value=", i, ",0,0 class=", i, " /"
         text(first:first + len(line) - 1) = line
         first = first + len(line)
      end do
      call make_scene(text, scene, failure)
      call accepted(error, failure)
      call expect(error, size(scene%bodies) == many - 1 .and. size(scene%effects) == many - 1, &
         "groups are missing")
      if (allocated(error)) return
      do i = 1, many - 1, 57
         call expect(error, nint(scene%bodies(i)%y(1)), i, "order of bodies")
         call expect(error, nint(scene%effects(i)%settings(1)%values(1)), i, "order of effects")
      end do
   end subroutine test_many_groups

   !> What an earlier run wrote goes, even if this one writes no such file; also that of a run that
   !> was
   !> killed, and of version 0.1, whose summary had no list.
   subroutine test_earlier_files(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: failure
      call empty_folder("earlier")
      call run_text(quiet // "&output every=0.5, format='csv+extxyz', restart='my state' /", &
         "earlier", &
                    failure)
      call accepted(error, failure)
      call put_text(output // "earlier/notes.txt", "mine")
      call run_text(written, "earlier", failure)
      call accepted(error, failure)
      call expect(error, .not. file_exists(output // "earlier/trajectory.xyz"), "an old trajectory")
      call expect(error, .not. file_exists(output // "earlier/my state"), "an old restart")
      call expect(error, file_exists(output // "earlier/restart.txt"), "no restart")
      call still_mine(error, output // "earlier/notes.txt")
      call put_text(output // "earlier/trajectory.csv.part", "of a run that was killed")
      call run_text(written, "earlier", failure)
      call accepted(error, failure)
      call empty_folder("earlier")
      call put_text(output // "earlier/summary.txt", "state                 complete" // nl // &
                    "poinsot               0.1.0" // nl)
      call put_text(output // "earlier/trajectory.csv", "t,body")
      call run_text(written, "earlier", failure)
      call accepted(error, failure)
   end subroutine test_earlier_files

   !> No run replaces what it reads: a torque file, its own scene.
   subroutine test_inputs(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: table = "0 0 0 0" // nl // "1 0 0 0" // nl
      character(*), parameter :: driven = written // "&torque file='trajectory.csv' /"
      type(poinsot_error) :: failure
      character(:), allocatable :: text
      call empty_folder("inputs")
      call run_text(written, "inputs", failure)
      call accepted(error, failure)
      ! the list of that run has the name
      call put_text(output // "inputs/trajectory.csv", table)
      call run_text(driven, "inputs", failure, file=output // "inputs/s.nml")
      call refused(error, failure, poinsot_e_scene, "trajectory.csv: is read by this run")
      call run_text(driven, "./inputs/../inputs", failure, file=real_path(output // "inputs") // &
                    "/s.nml")
      call refused(error, failure, poinsot_e_scene, "trajectory.csv: is read by this run")
      call get_text(output // "inputs/trajectory.csv", text)
      call expect(error, text == table, "a torque file is replaced")
      ! not written by this run: left where it is
      call run_text(quiet // "&output every=1 format='extxyz' /&torque file='trajectory.csv' /", &
                    "inputs", failure, file=output // "inputs/s.nml")
      call accepted(error, failure)
      call get_text(output // "inputs/trajectory.csv", text)
      call expect(error, text == table, "a torque file is removed")
      call empty_folder("inputs")
      call put_text(output // "inputs/s.nml", "mine")
      call run_text(quiet // "&output every=1 restart='s.nml' /", "inputs", failure, &
                    file=output // "inputs/s.nml")
      call refused(error, failure, poinsot_e_scene, "s.nml: is read by this run")
      call still_mine(error, output // "inputs/s.nml")
   end subroutine test_inputs

   !> A folder is one run's until it is let go.
   subroutine test_lock(error)
      type(error_type), allocatable, intent(out) :: error
      type(folder_lock) :: first, second
      type(poinsot_error) :: failure
      call empty_folder("locked")
      call lock_folder(output // "locked", first, failure)
      call accepted(error, failure)
      call lock_folder(output // "./locked", second, failure)
      call refused(error, failure, poinsot_e_io, "another run is writing into this folder")
      call lock_folder(output // "locked/inside", second, failure)
      call accepted(error, failure)
      call unlock_folder(second)
      call unlock_folder(first)
      call lock_folder(output // "locked", second, failure)
      call accepted(error, failure)
      call unlock_folder(second)
      call lock_folder("fpm.toml", second, failure)
      call refused(error, failure, poinsot_e_io, "the output folder is a file")
   end subroutine test_lock

   !> The app ends at its start, with 1, and leaves everything alone; then it runs. Skipped without
   !> POINSOT_APP.
   subroutine test_locked_app(error)
      type(error_type), allocatable, intent(out) :: error
      type(folder_lock) :: lock
      type(poinsot_error) :: failure
      character(:), allocatable :: app
      integer :: length, code
      call get_environment_variable("POINSOT_APP", length=length)
      if (length == 0) then
         call skip_test(error, "POINSOT_APP does not name the program")
         return
      end if
      allocate (character(length) :: app)
      call get_environment_variable("POINSOT_APP", app)
      call empty_folder("busy")
      call put_text(output // "busy/s.nml", written)
      call put_text(output // "busy/trajectory.csv.part", "mine")
      call lock_folder(output // "busy", lock, failure)
      call run_app(code)
      call expect(error, code == 1, "a second run into one folder is not refused with 1")
      call still_mine(error, output // "busy/trajectory.csv.part")
      call unlock_folder(lock)
      call run_app(code)
      call expect(error, code == 0, "left-over .part files refuse")
      call run_app(code)
      call expect(error, code == 0, "a second run after the first is refused")
   contains
      subroutine run_app(state)
         integer, intent(out) :: state
         call execute_command_line("'" // app // "' run " // output // "busy/s.nml --out " // &
            output // "busy --quiet --no-pictures 2>/dev/null", exitstat=state)
      end subroutine run_app
   end subroutine test_locked_app

   !> A restart file in the output folder is refused by whatever name; from elsewhere it is taken.
   subroutine test_restart_names(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: failure
      character(:), allocatable :: before, after
      integer :: state
      call empty_folder("r1")
      call empty_folder("r2")
      call run_text(written, "r1", failure)
      call accepted(error, failure)
      call get_text(output // "r1/restart.txt", before)
      call execute_command_line("ln -s ../r1/restart.txt " // output // "r2/link", exitstat=state)
      call refuse_from("./" // output // "r1/restart.txt", "r1")
      call refuse_from(output // "r1/restart.txt", "./r1")
      call refuse_from(output // "r1/restart.txt", "r2/../r1")
      call refuse_from(output // "r2/link", "r1")
      call refuse_from(real_path(output) // "/r1/restart.txt", "r1")
      call get_text(output // "r1/restart.txt", after)
      call expect(error, len(before) > 100 .and. before == after, "the restart file changed")
      call run_text("&scene t_end=2 h=0.1 from='" // output // "r1/restart.txt' /" // body, "r2", &
                    failure)
      call accepted(error, failure)
   contains
      subroutine refuse_from(from, folder)
         character(*), intent(in) :: from, folder
         call run_text("&scene t_end=2 h=0.1 from='" // from // "' /" // body, folder, failure)
         call refused(error, failure, poinsot_e_scene, "lies in the output folder")
      end subroutine refuse_from
   end subroutine test_restart_names

   !> An interrupted run names its restart file, if there is one.
   subroutine test_restart_hint(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: failure
      type(run_report) :: report
      type(hasty) :: watch
      character(:), allocatable :: text
      call empty_folder("hint")
      call run_text(quiet, "hint", failure, report=report, watch=watch)
      call accepted(error, failure)
      call expect(error, report%restart == output // "hint/restart.txt", "restart not named")
      call get_text(output // "hint/summary.txt", text)
      call expect(error, index(text, "continue from " // report%restart) > 0, text)
      call run_text(quiet // "&output every=1, restart='' /", "hint", failure, report=report, &
                    watch=watch)
      call accepted(error, failure)
      call expect(error, report%state == "interrupted" .and. report%restart == "", &
                  "a restart file that is not there is named")
      call get_text(output // "hint/summary.txt", text)
      call expect(error, index(text, "continue") == 0, text)
      ! one of the user's is not replaced
      call empty_folder("hint")
      call put_text(output // "hint/restart.txt", "mine")
      call run_text(quiet, "hint", failure, report=report, watch=watch)
      call refused(error, failure, poinsot_e_io, "not written by an earlier run")
      call still_mine(error, output // "hint/restart.txt")
   end subroutine test_restart_hint

   !> The steps that were taken, moments and axes of every class, the files.
   subroutine test_summary(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: failure
      character(:), allocatable :: text
      call empty_folder("told")
      call run_text("&scene t_end=1 h=0.3 /" // body // &
                    "&bodies tensor=1,0,0,0,0.6,0,0,0,0.8 /" // &
                    "&bodies tensor=0.8,0.2,0,0.2,0.8,0,0,0,1.5 /" // &
                    "&output every=0.02 restart='' pictures='none' /", "told", failure)
      call accepted(error, failure)
      call get_text(output // "told/summary.txt", text)
      call holds("step h                0.02 (0.3 asked for; steps end at outputs and at t_end)")
      call holds("  class 1             0.6, 0.8, 1.0  (asymmetric)")
      call holds("  class 2             1.0, 0.6, 0.8  (asymmetric)")
      call holds("  class 3  axis 1     0.70710678")
      call holds("  class 3  axis 3     0.0, 0.0, 1.0")
      call holds("threads               1" // nl)
      call holds("files                 summary.txt / trajectory.csv" // nl)
      call run_text("&scene t_end=1 h=0.3 /" // body // "&output times=0.5,0.9 /", "told", failure)
      call get_text(output // "told/summary.txt", text)
      call holds("step h                0.1 to 0.25 (0.3 asked")
      call run_text("&scene t_end=1 h=0.25 /" // body, "told", failure)
      call get_text(output // "told/summary.txt", text)
      call holds("step h                0.25" // nl)
      call run_text("&scene t_end=1 /" // body, "told", failure)
      call get_text(output // "told/summary.txt", text)
      call holds("step h                1.0, from output to output" // nl)
      call run_text("&scene t_end=1 h=0.1 /" // body // "&torque times=0,0.3,0.55 table=9*0 /", &
         "told", &
                    failure)
      call get_text(output // "told/summary.txt", text)
      call holds("order at knots        2: the table of &torque has a knot at t = 0.55, " // &
                 "within a step")
      call run_text("&scene t_end=1 h=0.1 /" // body // "&torque times=0,0.3,0.7 table=9*0 /" // &
                    "&output every=0.05 /", "told", failure)
      call get_text(output // "told/summary.txt", text)
      call expect(error, index(text, "order at knots") == 0, "a knot at the end of a step is told")
   contains
      subroutine holds(words)
         character(*), intent(in) :: words
         call expect(error, index(text, words) > 0, "no '" // words // "' in" // nl // text)
      end subroutine holds
   end subroutine test_summary

   !> With a thermostat: momenta under baoab are cold where they are written, and what auto promises
   !> is not about noise.
   subroutine test_noise(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: bath = "&scene t_end=1 h=0.1 splitting='baoab' /" // body // &
         "&langevin friction=1 temperature=1 /"
      type(scene_source) :: source
      type(scene_settings) :: scene
      type(run_report) :: report
      type(run_watch) :: watch
      type(poinsot_error) :: failure
      character(:), allocatable :: text
      call empty_folder("noise")
      call scan_source(bath, "t.nml", source, failure)
      call build_scene(source, scene, failure)
      call run_scene(scene, output // "noise", watch, report, failure)
      call accepted(error, failure)
      call get_text(output // "noise/summary.txt", text)
      call expect(error, index(text, "momenta               are those at ends of steps, where " // &
         "with baoab they are too cold") > 0 .and. index(text, "noise  ") == 0, text)
      scene%chosen = "exact + baoab"
      call run_scene(scene, output // "noise", watch, report, failure)
      call get_text(output // "noise/summary.txt", text)
      call expect(error, index(text, "noise                 was off in the choice") > 0, text)
   end subroutine test_noise

   !> Where nothing was compared with the start no changes are printed.
   subroutine test_unmeasured(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: failure
      type(hasty) :: watch
      character(:), allocatable :: text
      call empty_folder("unmeasured")
      call run_text("&scene t_end=1 h=0.1 /" // body // "&output times=0.5 /", "unmeasured", &
         failure, &
                    watch=watch)
      call accepted(error, failure)
      call get_text(output // "unmeasured/summary.txt", text)
      call expect(error, index(text, "interrupted") > 0 .and. index(text, "energy H") == 0, text)
      call run_text(written, "unmeasured", failure)
      call get_text(output // "unmeasured/summary.txt", text)
      call expect(error, index(text, "energy H") > 0, text)
   end subroutine test_unmeasured

   !> A NaN anywhere is the largest.
   subroutine test_nan(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_source) :: source
      type(scene_settings) :: scene
      type(body_states) :: states
      type(communicator) :: alone
      type(drift_watch) :: drift
      type(poinsot_error) :: failure
      real(dp) :: nan, zero(2)
      integer :: code
      nan = ieee_value(nan, ieee_quiet_nan)
      call expect(error, ieee_is_nan(larger(nan, 1._dp)) .and. ieee_is_nan(larger(1._dp, nan)), &
         "larger")
      call within(error, larger(-1._dp, -2._dp) + 1, 0._dp, "larger of two numbers")
      call expect(error, ieee_is_nan(largest_of([1._dp, nan, 3._dp])), "largest of three")
      call within(error, largest_of([1._dp, 3._dp, 2._dp]) - 3, 0._dp, "largest of numbers")
      call scan_source("&scene t_end=1 h=0.1 /" // "&bodies moments=1,1,1 y=1,0,0 count=2 /", &
         "t.nml", &
                       source, failure)
      call build_scene(source, scene, failure)
      call first_states(scene, states, failure)
      call accepted(error, failure)
      zero = 0
      call start_drift(states, drift, code)
      call start_energy(zero, zero, alone, drift)
      states%y(2, 1) = nan
      states%q(2, 1) = nan
      call follow_drift(states, [nan, 0._dp], zero, alone, drift)
      states%y(2, 1) = 0
      states%q(2, 1) = 0
      call follow_drift(states, zero, zero, alone, drift)
      call expect(error, all(ieee_is_nan([drift%energy_change, drift%casimir_change, &
                  drift%momentum_change, drift%vertical_change, drift%norm_change])), &
                  "a change that is no number is lost")
   end subroutine test_nan

   !> What other programs put around a table.
   subroutine test_tables(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: mark = char(239) // char(187) // char(191), cr = achar(13)
      character(*), parameter :: rows = "0,1,2,3" // cr // nl // "1,4,5,6" // cr // nl
      call taken(rows)
      call taken(mark // rows)
      call taken(mark // "t,tx,ty,tz" // cr // nl // rows)
      call taken("# made by hand" // nl // """time [s]"";""torque 1"";""2a"";x" // nl // rows)
      call taken(rows // achar(26))
      call taken(rows // achar(26) // nl // "what is behind it")
      call taken("0 1 2 3" // nl // "1 4 5 6" // achar(26))
      call none(mark // "t,tx,ty,tz" // nl // "t,tx,ty,tz" // nl // rows, &
         """t"" is not a finite number")
      call none(rows // "t,tx,ty,tz" // nl, """t"" is not a finite number")
      call none("t 1 2 3" // nl // rows, """t"" is not a finite number")
      call none(mark, "holds no rows")
   contains
      subroutine read_it(text, times, values, failure)
         character(*), intent(in) :: text
         real(dp), allocatable, intent(out) :: times(:), values(:)
         type(poinsot_error), intent(inout) :: failure
         call put_text(output // "table.txt", text)
         call read_table(output // "table.txt", 3, times, values, failure)
      end subroutine read_it

      subroutine taken(text)
         character(*), intent(in) :: text
         real(dp), allocatable :: times(:), values(:)
         type(poinsot_error) :: failure
         call read_it(text, times, values, failure)
         call accepted(error, failure)
         if (raised(failure)) return
         call expect(error, size(times) == 2 .and. size(values) == 6, "rows")
         if (size(times) /= 2) return
         call within(error, maxval(abs(times - [0, 1])) + maxval(abs(values - [1, 2, 3, 4, 5, &
            6])), &
                     0._dp, "numbers")
      end subroutine taken

      subroutine none(text, words)
         character(*), intent(in) :: text, words
         real(dp), allocatable :: times(:), values(:)
         type(poinsot_error) :: failure
         call read_it(text, times, values, failure)
         call refused(error, failure, poinsot_e_scene, words)
      end subroutine none
   end subroutine test_tables

   !> q and y with few digits; moments that no mass has, where that is asked for.
   subroutine test_few_digits(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: first = "&scene t_end=1 h=0.1 /&bodies "
      type(scene_settings) :: scene
      call taken("moments=1,2,2.5 q=0.7071,0.7071,0,0 /")
      call within(error, norm2(scene%bodies(1)%q) - 1, 1e-15_dp, "|q|")
      call expect(error, allocated(scene%bodies(1)%note), "no note")
      if (allocated(error)) return
      call expect(error, index(scene%bodies(1)%note, &
         "test.nml:1: &bodies: q was normalised, its norm differed from 1 by 9.59E-06: " // &
         "0.7071067811865") == 1, &
         scene%bodies(1)%note)
      call taken("moments=1,2,2.5 q=1.0009,0,0,0 /")
      call within(error, scene%bodies(1)%q(1) - 1, 0._dp, "q")
      call taken("moments=1,2,2.5 q=1.0000009,0,0,0 /")
      call expect(error, .not. allocated(scene%bodies(1)%note), "a note of what is used as it is")
      call within(error, scene%bodies(1)%q(1) - 1.0000009_dp, 0._dp, "q as it is")
      call none("moments=1,2,2.5 q=1.0011,0,0,0 /", "from 1 by 1.10E-03; up to 1e-3 is normalised")
      call none("moments=1,2,2.5 q=3,0,0,0 /", "from 1 by more than 1;")
      call taken("moments=0,1,1.00000000001 y=0.9e-6,1,0 /")
      call within(error, scene%bodies(1)%y(1), 0._dp, "momentum where nothing can turn")
      call none("moments=0,1,1 y=1.1e-6,1,0 /", "about principal axis 1")
      call none("moments=0.604636,1.160852,1.817004 /", &
         "I3 exceeds the sum of the other two by 2.84e-02")
      call none("moments=0.604636,1.160852,1.817004 physical=.true. /", "I3 exceeds")
      call none("moments=1,1,1 physical='maybe' /", """maybe"" is neither .true. nor .false.")
      call none("moments=1,1,1 physical=1 /", """1"" is neither .true. nor .false.")
      call taken("moments=0.604636,1.160852,1.817004 physical=.false. /")
      call taken("moments=0.604636,1.160852,1.817004 physical=F /")
      call taken("tensor=0.604636,0,0,0,1.160852,0,0,0,1.817004 physical=f " // &
                 "/&bodies moments=1,1,1 /")
      call none("moments=0.604636,1.160852,1.817004 physical=F /&bodies moments=1,1,3 /", &
         "I3 exceeds")
      ! noise on processed momenta is another temperature's
      call taken("moments=1,1.2,1.5 /&langevin friction=1, temperature=1 /&gravity centre=0,0,1 /")
      call none("moments=1,1.2,1.5 /&langevin friction=1, temperature=1 /&gravity centre=0,0,1 /", &
                "of 'langevin' would heat them", "splitting='takahashi-imada'")
   contains
      subroutine build(text, failure, more)
         character(*), intent(in) :: text
         type(poinsot_error), intent(inout) :: failure
         character(*), intent(in), optional :: more
         type(scene_source) :: source
         if (present(more)) then
            call scan_source("&scene t_end=1 h=0.1 " // more // "/&bodies " // text, "test.nml", &
               source, &
                             failure)
         else
            call scan_source(first // text, "test.nml", source, failure)
         end if
         if (.not. raised(failure)) call build_scene(source, scene, failure)
         if (.not. raised(failure)) call check_scene(scene, failure)
      end subroutine build

      subroutine taken(text)
         character(*), intent(in) :: text
         type(poinsot_error) :: failure
         call build(text, failure)
         call accepted(error, failure)
      end subroutine taken

      subroutine none(text, words, more)
         character(*), intent(in) :: text, words
         character(*), intent(in), optional :: more
         type(poinsot_error) :: failure
         call build(text, failure, more)
         call expect(error, raised(failure), text // " is taken")
         if (allocated(error)) return
         call refused(error, failure, failure%code, words)
      end subroutine none
   end subroutine test_few_digits

end module test_scene_files
