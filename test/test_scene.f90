!> Room scene: reader, key tables, checks of values, schedule, files, restart, and whole runs.
module test_scene
   use testdrive, only: new_unittest, unittest_type, error_type
   use test_expectation, only: expect
   use test_scene_endings, only: collect_scene_endings
   use test_scene_tools, only: ask_app
   use test_scene_files, only: collect_scene_files
   use test_scene_beginnings, only: collect_scene_beginnings
   use test_scene_groups, only: collect_scene_groups
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised, clear
   use poinsot_core_status, only: poinsot_e_io, poinsot_e_scene, poinsot_e_partial
   use poinsot_effect_effect, only: effect
   use poinsot_effect_registry, only: make_effect
   use poinsot_effect_settings, only: setting
   use poinsot_effect_settings_text, only: read_settings
   use poinsot_rotation_quaternion, only: attitude_distance
   use poinsot_scene_text, only: for_shell, text_of
   use poinsot_scene_source, only: scene_source, find_group, value_null, value_number, &
      value_logical
   use poinsot_scene_reader, only: read_source, scan_source
   use poinsot_scene_override, only: override
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_schedule, only: piece, piece_count, get_piece
   use poinsot_scene_run, only: run_scene, check_scene
   use poinsot_scene_communicator, only: communicator
   use poinsot_scene_restart, only: restart_state, read_restart
   use poinsot_scene_states, only: body_states, first_states
   use poinsot_scene_summary, only: run_report
   use poinsot_scene_trajectory, only: csv_row, longest_row
   use poinsot_scene_watch, only: run_watch
   implicit none(type, external)
   private
   public :: collect_scene

   character, parameter :: nl = achar(10), cr = achar(13)
   character(*), parameter :: output = "build/test-output"
   character(*), parameter :: good_run = "&scene t_end=1 h=0.1 /" // nl, &
      good_body = "&bodies moments=0.6,0.8,1.0 y=1.8,0.4,-0.9 /" // nl

   character(*), parameter :: shipped(19) = [character(16) :: &
      "free-body", "tennis-racket", "toutatis", "heavy-top", "sleeping-top", "lagrange", &
      "kovalevskaya", "gyrocompass", "satellite", "hyperion", "rotating-field", "kapitza", &
      "dipole-chain", "chaotic-pair", "own-potential", "gyrostat", "thermostat", "mixture", &
      "large-ensemble"]

   !> A text that must be refused, and words of the message.
   type :: refusal
      character(100) :: text
      character(60) :: words
   end type refusal

   !> Stops at the third look.
   type, extends(run_watch) :: impatient
      integer :: looks = 0
   contains
      procedure :: stop_now
   end type impatient

contains

   subroutine collect_scene(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      type(unittest_type), allocatable :: files(:), groups(:), beginnings(:), endings(:)
      call collect_scene_files(files)
      call collect_scene_groups(groups)
      call collect_scene_beginnings(beginnings)
      call collect_scene_endings(endings)
      testsuite = [ &
         new_unittest("numbers-as-text", test_numbers), &
         new_unittest("shell-words", test_shell_words), &
         new_unittest("reader-values", test_values), &
         new_unittest("reader-line-ends", test_line_ends), &
         new_unittest("reader-refusals", test_reader_refusals), &
         new_unittest("reader-files", test_reader_files), &
         new_unittest("key-refusals", test_key_refusals), &
         new_unittest("keys-checked-alike", test_alike), &
         new_unittest("values-read-alike", test_read_alike), &
         new_unittest("value-refusals", test_value_refusals), &
         new_unittest("override", test_override), &
         new_unittest("schedule", test_schedule), &
         new_unittest("schedule-of-many-steps", test_many_steps), &
         new_unittest("shipped-scenes", test_shipped), &
         new_unittest("mutated-scenes", test_mutated), &
         new_unittest("csv-row", test_csv_row), &
         new_unittest("published-free-body", test_published_free_body), &
         new_unittest("published-heavy-top", test_published_top), &
         new_unittest("tensor-frame", test_tensor_frame), &
         new_unittest("restart-bitwise", test_restart), &
         new_unittest("interrupt-bitwise", test_interrupt), &
         new_unittest("restart-refusals", test_restart_refusals), &
         new_unittest("failed-run", test_failed_run), &
         new_unittest("output-refused", test_output_refused), &
         new_unittest("command-line", test_golden), &
         new_unittest("keys-documented", test_keys), &
         files, groups, beginnings, endings]
   end subroutine collect_scene

   !> A scene from its text.
   subroutine make(text, scene, failure)
      character(*), intent(in) :: text
      type(scene_settings), intent(out) :: scene
      type(poinsot_error), intent(inout) :: failure
      type(scene_source) :: source
      call scan_source(text, "test.nml", source, failure)
      if (.not. raised(failure)) call build_scene(source, scene, failure)
   end subroutine make

   !> A shipped scene, with settings ("a=b;c=d") over its own.
   subroutine load(name, settings, scene, failure)
      character(*), intent(in) :: name, settings
      type(scene_settings), intent(out) :: scene
      type(poinsot_error), intent(inout) :: failure
      type(scene_source) :: source
      integer :: first, last
      call read_source("scenes/" // trim(name) // ".nml", source, failure)
      first = 1
      do while (first <= len(settings) .and. .not. raised(failure))
         last = index(settings(first:) // ";", ";") + first - 2
         call override(settings(first:last), source, failure)
         first = last + 2
      end do
      if (.not. raised(failure)) call build_scene(source, scene, failure)
   end subroutine load

   subroutine test_numbers(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: values(12) = [0.1_dp, 1/3.0_dp, -0.8_dp, 4.205_dp, 1e-46_dp, &
         1e150_dp, &
                                           1e15_dp, 123456789012345680.0_dp, tiny(1.0_dp), &
                                              0.0_dp, 1e16_dp, -1e-5_dp]
      character(32) :: text
      real(dp) :: back
      integer :: i
      do i = 1, size(values)
         text = text_of(values(i))
         read (text, *) back
         call expect(error, transfer(back, 0_i8) == transfer(values(i), 0_i8), &
                    text_of(values(i)) // " does not read back")
      end do
      call expect(error, text_of(0.1_dp), "0.1")
      if (.not. allocated(error)) call expect(error, text_of(-40.0_dp), "-40.0")
      if (.not. allocated(error)) call expect(error, text_of(1e-46_dp), "1e-46")
      if (.not. allocated(error)) call expect(error, text_of(huge(1.0_dp)), &
         "1.7976931348623157e308")
   end subroutine test_numbers

   !> Words of commands that are printed to be pasted.
   subroutine test_shell_words(error)
      type(error_type), allocatable, intent(out) :: error
      call expect(error, for_shell("out/heavy-top.nml"), "out/heavy-top.nml")
      call expect(error, for_shell("a b"), "'a b'")
      call expect(error, for_shell("$(it's)"), "'$(it'\''s)'")
      call expect(error, for_shell(""), "''")
   end subroutine test_shell_words

   subroutine test_values(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_source) :: source
      type(poinsot_error) :: failure
      call scan_source("! c'&mment" // nl // "&A x = 3*0.5, ,1d2 -.5e+1" // nl // &
                       "  S='it''s', ""two"" t(2)=.TRUE. F ! / &b" // nl // " N = 2*, 7 &END" // &
                       nl // "&b/", "v", source, failure)
      call expect(error, .not. raised(failure), "refused")
      call expect(error, source%count == 2 .and. find_group(source, "b") == 2, "groups")
      associate (e => source%groups(1)%entries)
         call expect(error, source%groups(1)%count, 4, "entries")
         call expect(error, e(1)%count == 4 .and. e(1)%values(1)%repeats == 3 .and. &
                    e(1)%values(2)%kind == value_null .and. abs(e(1)%values(3)%number - &
                    100) <= 0 .and. abs(e(1)%values(4)%number + 5) <= 0, "x")
         call expect(error, e(2)%values(1)%text // e(2)%values(2)%text, "it'stwo")
         call expect(error, e(3)%first == 2 .and. e(3)%values(1)%kind == value_logical .and. &
                    e(3)%values(1)%flag .and. .not. e(3)%values(2)%flag .and. &
                    e(3)%line == 3, "t(2)")
         call expect(error, e(4)%values(1)%kind == value_null .and. &
                    e(4)%values(1)%repeats == 2 .and. e(4)%values(2)%kind == value_number, "n")
      end associate
   end subroutine test_values

   !> LF, CRLF, CR, a byte-order mark and bytes beyond ASCII in comments: the same lines.
   subroutine test_line_ends(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: ends(3) = [character(2) :: nl, cr // nl, cr]
      type(scene_source) :: source
      type(poinsot_error) :: failure
      character(:), allocatable :: e
      integer :: i
      do i = 1, 3
         e = trim(ends(i))
         call scan_source(char(239) // char(187) // char(191) // "! " // char(195) // char(169) // &
                          e // e // "&a" // e // "x=1" // e // "/" // e, "v", source, failure)
         call expect(error, .not. raised(failure), "refused")
         call expect(error, source%groups(1)%entries(1)%line, 4, "line number")
      end do
   end subroutine test_line_ends

   !> Refuse each text with its words, at the place "test.nml".
   subroutine refuse_all(cases, before, error)
      type(refusal), intent(in) :: cases(:)
      character(*), intent(in) :: before  !! text in front of each
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      integer :: i
      do i = 1, size(cases)
         call clear(failure)
         call make(before // trim(cases(i)%text), scene, failure)
         call expect(error, raised(failure), "taken: " // trim(cases(i)%text))
         call expect(error, index(failure%message, trim(cases(i)%words)) > 0 .and. &
                    index(failure%message, "test.nml") == 1 .and. failure%code == poinsot_e_scene, &
                    trim(cases(i)%text) // " gives: " // failure%message)
      end do
   end subroutine refuse_all

   subroutine test_reader_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      call refuse_all([refusal("", "holds no group"), refusal("! only", "holds no group"), &
                       refusal("&", "name of a group"), refusal("&scene", "not closed"), &
                       refusal("&scene t_end=1", "not closed"), refusal("x=1", &
                          "outside of a group"), &
                       refusal("&scene t_end=1 &bodies /", "closing / missing"), &
                       refusal("&scene t_end 1 /", "not followed by ="), &
                       refusal("&scene = 1 /", "where a key is expected"), &
                       refusal("&scene t_end= /", "has no value"), &
                       refusal("&scene t_end=1 method=exact /", "nor a string"), &
                       refusal("&scene method='exact /", "closing quote"), &
                       refusal("&scene t_end=0*1 /", "repeat count"), &
                       refusal("&scene t_end=99999999999*1 /", "repeat count"), &
                       refusal("&scene t_end=nan /", "must be finite"), &
                       refusal("&scene t_end=-Inf /", "must be finite"), &
                       refusal("&scene t_end=1e999 /", "must be finite"), &
                       refusal("&scene t_end=1e99999999999 /", "must be finite"), &
                       refusal("&scene t_end(0)=1 /", "subscript"), &
                       refusal("&scene t_end(2:1)=1 /", "a section, as in (1:3)"), &
                       refusal("&scene t_end(1:4:2)=1 /", "a section, as in (1:3)"), &
                       refusal("&scene t_end=1.2.3 /", "neither a number"), &
                       refusal("&scene t_end==1 /", "not a value"), &
                       refusal("&scene t_end=" // char(200) // " /", "\xC8"), &
                       refusal("&scene" // achar(0) // "/", "not a text file"), &
                       refusal("&scene" // achar(127) // "/", "not a text file")], "", error)
   end subroutine test_reader_refusals

   subroutine test_reader_files(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_source) :: source
      type(poinsot_error) :: failure
      call read_source("no/such.nml", source, failure)
      call expect(error, failure%code, poinsot_e_io, "a file that is not there")
      call clear(failure)
      call read_source("scenes", source, failure)
      call expect(error, failure%code, poinsot_e_io, "a folder")
      call clear(failure)
      call read_source("/dev/null", source, failure)
      call expect(error, failure%code, poinsot_e_scene, "an empty file")
   end subroutine test_reader_files

   !> Settings of a program and of a file are checked by the same rules, in the same words.
   subroutine test_alike(error)
      type(error_type), allocatable, intent(out) :: error
      character(16), parameter :: names(7) = [character(16) :: "gravity", "gravity", "gravity", &
         "gravity", "gravity", "torque", "torque"]
      character(48), parameter :: texts(7) = [character(48) :: "centre=1,2", "centre=1,2,3,4", &
         "centre=1,2,3; weight=1,2", "weight=2", "centre=1,2,3; weight=1; weight=2", &
         "value=1,2,3; frame='sideways'", "value=1,2,3; frame='body space'"]
      character(40), parameter :: words(7) = [character(40) :: &
         "takes 3 numbers, too few are given", "takes 3 numbers, more are given", &
         "takes 1 number, more are given", "is required: centre of mass", "is given twice", &
         "is not one of: body space", "is not one of: body space"]
      type(setting), allocatable :: settings(:)
      class(effect), allocatable :: made
      type(poinsot_error) :: failure
      type(scene_settings) :: scene
      character(len(texts)) :: text
      integer :: i, k
      do i = 1, size(names)
         text = texts(i)
         do k = 1, len(text)
            if (text(k:k) == "'") text(k:k) = " "
         end do
         call clear(failure)
         call read_settings(trim(text), settings, failure)
         if (.not. raised(failure)) call make_effect(trim(names(i)), settings, made, failure)
         call expect(error, index(said(failure), trim(words(i))) > 0, "a program's: "// &
            said(failure))
         text = texts(i)
         do k = 1, len(text)
            if (text(k:k) == ";") text(k:k) = " "
         end do
         call clear(failure)
         call make(good_run // good_body // "&" // trim(names(i)) // " " // text // "/", scene, &
            failure)
         call expect(error, index(said(failure), trim(words(i))) > 0, "a file's: "// &
            said(failure))
      end do
   end subroutine test_alike

   !> A program and a file say the same in the same words: keys in any case, repeat counts, commas,
   !> quotes.
   subroutine test_read_alike(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: texts(11) = [character(56) :: "centre = 0, 0, 3", &
         "centre = 2*0 3", "CENTRE=2*0., 3d0; Weight = 1", "centre = 2*0,3,", &
         "centre = 0, 0, 1*3", "centre = 0,,3", "centre = 4*0", "centre = 0*1, 1, 2, 3", &
         "centre = 100000001*0", "centre = 2*x, 3", "centre = 3*1e999"]
      integer, parameter :: taken = 5 !! of these texts, the first
      type(setting), allocatable :: settings(:)
      type(poinsot_error) :: failure
      type(scene_settings) :: scene
      class(effect), allocatable :: made
      character(len(texts)) :: text
      integer :: i, k
      do i = 1, size(texts)
         call clear(failure)
         call read_settings(trim(texts(i)), settings, failure)
         if (.not. raised(failure)) call make_effect(" Gravity ", settings, made, failure)
         call expect(error, raised(failure) .neqv. i <= taken, "a program's '" // &
            trim(texts(i)) // "': " // said(failure))
         if (i <= taken) call expect(error, settings(1)%key == "centre" .and. &
            all(abs(settings(1)%values - [0, 0, 3]) <= 0), "a program's " // texts(i))
         text = texts(i)
         do k = 1, len(text)
            if (text(k:k) == ";") text(k:k) = " "
         end do
         call clear(failure)
         call make(good_run // good_body // "&Gravity " // text // "/", scene, failure)
         call expect(error, raised(failure) .neqv. i <= taken, "a file's '" // trim(texts(i)) // &
            "': " // said(failure))
         if (i <= taken) call expect(error, all(abs(scene%effects(1)%settings(1)%values - &
            [0, 0, 3]) <= 0), "a file's " // texts(i))
      end do
      call clear(failure)
      call read_settings("u = 'Q33'; constants = 'it''s; so'", settings, failure)
      call expect(error, size(settings), 2, "a semicolon within quotes")
      if (size(settings) == 2) call expect(error, settings(2)%text, "it's; so")
   end subroutine test_read_alike

   !> The message of an error, or that there is none.
   pure function said(failure) result(text)
      type(poinsot_error), intent(in) :: failure
      character(:), allocatable :: text
      text = "nothing refused"
      if (raised(failure)) text = failure%message
   end function said

   !> Groups and keys: each message has the line and the nearest name.
   subroutine test_key_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      call refuse_all([refusal("&sceen /", "test.nml:3: unknown group ""&sceen""; the nearest"), &
                       refusal("&gravty /", """&gravity"""), &
                       refusal("&scene t_end=1 /", "a second &scene, the first is in line 1"), &
                       refusal("&output every=1 fromat='csv' /", &
                          "unknown key ""fromat""; the near"), &
                       refusal("&output every=1 fromat='csv' /", """format"""), &
                       refusal("&output every=1 every=2 /", "every is given twice"), &
                       refusal("&output every='1' /", "takes numbers"), &
                       refusal("&output every=1,2 /", "more are given"), &
                       refusal("&output every=1 format=2 /", "not a string"), &
                       refusal("&output every=1 format='csw' /", "is not one of: csv"), &
                       refusal("&gravity centre=1,2 /", "too few"), &
                       refusal("&gravity centre=1,,2 /", "without a value"), &
                       refusal("&gravity /", """centre"" is required"), &
                       refusal("&gravity centre=1,2,3 class=2 /", "not the number of a &bodies"), &
                       refusal("&gravity centre=1,2,3 up=3*0 /", "must not be zero"), &
                       refusal("&callback /", "unknown group"), &
                       refusal("&output /", "every or times must be given"), &
                       refusal("&output every=1 times=1 /", "one of the two"), &
                       refusal("&output times=1,0.5 /", "must ascend"), &
                       refusal("&output times=2 /", "leave the run"), &
                       refusal("&output every=1e-12 /", "more than 1e9 outputs"), &
                       refusal("&output every=1 bodies=2 /", "bodies 1 to 1"), &
                       refusal("&output every=1 bodies=1.5 /", "bodies 1 to 1"), &
                       refusal("&output every=1 restart='a/b' /", "without /")], &
                      good_run // good_body, error)
   end subroutine test_key_refusals

   !> Values that no run can have.
   subroutine test_value_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      call refuse_all([refusal("t_end=0 /", "must be positive"), refusal("t_end=1 h=0 /", &
         "must be pos"), &
                       refusal("t_end=1 h=-1 /", "must be positive"), &
                       refusal("t_end=1 h=1e-16 /", "more than 1e15 steps"), &
                       refusal("t_end=1 h=1e-300 /", "more than 1e15 steps"), &
                       refusal("h=1 /", """t_end"" is required"), &
                       refusal("t_end=1 method='exat' /", "nearest known one is ""exact"""), &
                       refusal("t_end=1 splitting='strange' /", &
                          "nearest known one is ""strang"""), &
                       refusal("t_end=1 tol=2 /", "not from 1e-15 to 1"), &
                       refusal("t_end=1 seed=0.5 /", "not an integer"), &
                       refusal("t_end=1 threads=-1 /", "not an integer"), &
                       refusal("t_end=1 method='dmv4' /", """h"" is required")], &
                      good_body // "&scene ", error)
      if (allocated(error)) return
      call refuse_all([refusal("/", "moments are missing"), &
                       refusal("moments=1,1,1 shape='box' /", "one of them only"), &
                       refusal("moments=1,1,1 mass=2 /", "shape is missing"), &
                       refusal("moments=1,1,-1 /", "negative"), refusal("moments=1,1,3 /", &
                          "exceeds"), &
                       refusal("moments=3*0 /", "refused"), refusal("shape='bix' size=1 /", &
                          """box"""), &
                       refusal("tensor=1,2,3,4,5,6,7,8,9 /", "not symmetric"), &
                       refusal("moments=1,1,1 q=4*0 /", "is zero"), &
                       refusal("moments=1,1,1 q=1,0,1,0 /", "0.7071067811865475"), &
                       refusal("moments=1,1,1 q=1e200,0,0,0 /", "not a unit quaternion"), &
                       refusal("moments=1,1,0 y=0,0,1 /", "about principal axis 3"), &
                       refusal("moments=1,1,1 y=3*1 omega=3*1 /", "both given"), &
                       refusal("moments=1,1,1 random='thermal' /", "and only there"), &
                       refusal("moments=1,1,1 temperature=1 /", "and only there"), &
                       refusal("moments=1,1,1 random='uniform' q=1,0,0,0 /", "random attitudes"), &
                       refusal("moments=1,1,1 count=0 /", "not an integer from 1"), &
                       refusal("moments=1,1,1 count=1e300 /", "not an integer from 1")], &
                      good_run // "&bodies ", error)
   end subroutine test_value_refusals

   subroutine test_override(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      character(*), parameter :: bad(8) = [character(24) :: "h=1", "scene.h", "scene.=1", ".h=1", &
                                           "bodies.count=2", "bodies(3).count=2", &
                                           "bodies(2).y(0)=1", "bodies(2).y(1:2)=1,2,3"]
      integer :: i
      call load("sleeping-top", &
                "scene.method=dmv8;bodies(2).y=1,,3;SCENE.H = 0.25;output.every=2*", scene, failure)
      call expect(error, raised(failure), "every without a number taken")
      call clear(failure)
      call load("sleeping-top", "scene.method=dmv8;bodies(2).y=1,2,3;SCENE.H = 0.25", &
                scene, failure)
      call expect(error, .not. raised(failure), "refused")
      call expect(error, scene%method == "dmv8" .and. abs(scene%h - 0.25_dp) <= 0 .and. &
                 all(abs(scene%bodies(2)%y - [1, 2, 3]) <= 0) .and. &
                 abs(scene%bodies(1)%y(3) - 2.2_dp) <= 0, "values")
      call load("sleeping-top", "bodies(2).y(2)=7;bodies(2).Y(1:1)=5", scene, failure)
      call expect(error, .not. raised(failure), "subscripts refused")
      call expect(error, all(abs(scene%bodies(2)%y(1:2) - [5, 7]) <= 0) .and. &
         abs(scene%bodies(2)%y(3)) > 0, "only the numbers of the subscripts")
      do i = 1, size(bad)
         call clear(failure)
         call load("sleeping-top", trim(bad(i)), scene, failure)
         call expect(error, failure%code, poinsot_e_scene, "taken: " // trim(bad(i)))
      end do
   end subroutine test_override

   !> Pieces meet, cover the run, and have steps no longer than h; a multiple of h is h itself.
   !> t_end/h near 1e12 and no whole number: never a longer step than asked; whole numbers keep h.
   subroutine test_many_steps(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      type(piece) :: part
      call make("&scene t_end=1000000000000.5 h=1 /" // good_body, scene, failure)
      call expect(error, .not. raised(failure), "refused")
      part = get_piece(scene, 1_i8)
      call expect(error, part%steps == 1000000000001_i8 .and. part%h <= 1, &
         "a longer step than asked")
      call expect(error, abs(part%steps*part%h - part%to) <= 1e-3_dp, "steps do not end at t_end")
      call make("&scene t_end=1e8 h=1e-3 /" // good_body // "&output every=1 /", scene, failure)
      part = get_piece(scene, 99999998_i8)
      call expect(error, part%steps == 1000_i8 .and. abs(part%h - 1e-3_dp) <= 0, &
                 "h of a piece far from the start")
      call make("&scene t_end=0.3 h=0.1 /" // good_body, scene, failure)
      part = get_piece(scene, 1_i8)
      call expect(error, part%steps == 3_i8 .and. abs(part%h - 0.1_dp) <= 0, "0.3 in steps of 0.1")
   end subroutine test_many_steps

   subroutine test_schedule(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: texts(4) = [character(40) :: "every=0.02", "every=0.3", &
                                             "times=0,0.05,0.7", "times=1"]
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      type(piece) :: part
      real(dp) :: t
      integer :: i
      integer(i8) :: k
      do i = 1, size(texts)
         call make("&scene t_end=1 h=0.01 /" // good_body // "&output " // texts(i) // "/", &
            scene, failure)
         call expect(error, .not. raised(failure), "refused")
         t = 0
         do k = 1, piece_count(scene)
            part = get_piece(scene, k)
            call expect(error, abs(part%from - t) <= 0 .and. part%to > part%from .and. &
                       part%steps > 0 .and. part%h <= 0.01_dp*(1 + 1e-9_dp) .and. &
                       abs(part%steps*part%h - (part%to - part%from)) <= 1e-12_dp, "piece")
            if (i == 1) then
               call expect(error, transfer(part%h, 0_i8) == transfer(0.01_dp, 0_i8), "h itself")
            end if
            if (allocated(error)) return
            t = part%to
         end do
         call expect(error, abs(t - 1) <= 0, "the end is not t_end")
      end do
   end subroutine test_schedule

   !> Every shipped scene reads, and its plan can be made.
   subroutine test_shipped(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      integer :: i
      do i = 1, size(shipped)
         call load(shipped(i), "", scene, failure)
         if (.not. raised(failure)) call check_scene(scene, failure)
         call expect(error, .not. raised(failure), &
            "a shipped scene is refused: " // trim(shipped(i)))
         call expect(error, scene%output%present .and. scene%output%pictures /= "none", &
            "no picture")
      end do
   end subroutine test_shipped

   !> Shipped scenes with bytes changed, doubled, left out, cut off: read or refused, never a crash.
   subroutine test_mutated(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      character(:), allocatable :: text, changed
      integer(i8) :: state
      integer :: i, j, k, at, refused
      refused = 0
      state = 12345
      do i = 1, size(shipped)
         call slurp("scenes/" // trim(shipped(i)) // ".nml", text)
         do j = 1, 200
            changed = text
            do k = 1, 1 + next(3)
               at = 1 + next(len(changed))
               select case (next(5))
               case (0)
                  changed(at:at) = char(next(256))
               case (1)
                  changed = changed(:at - 1) // changed(at + 1:)
               case (2)
                  changed = changed(:at) // changed(at:)
               case (3)
                  changed(at:at) = "&/=,*'""!().e-0123456789 "(1 + next(24):)
               case default
                  if (next(8) == 0) changed = changed(:at)
               end select
               if (len(changed) < 2) changed = text
            end do
            call clear(failure)
            call make(changed, scene, failure)
            if (raised(failure)) refused = refused + 1
            if (raised(failure)) call expect(error, len(failure%message) > 10, "no message")
         end do
      end do
      call expect(error, refused > 100, "hardly any mutation was refused")

   contains

      integer function next(n)
         integer, intent(in) :: n
         state = iand(state*1103515245_i8 + 12345_i8, 2147483647_i8)
         next = int(mod(ishft(state, -8), int(n, i8)))
      end function next

   end subroutine test_mutated

   !> A whole file.
   subroutine slurp(file, text)
      character(*), intent(in) :: file
      character(:), allocatable, intent(out) :: text
      integer :: unit, length, code
      open (newunit=unit, file=file, access="stream", form="unformatted", action="read", &
            status="old", iostat=code)
      length = 0
      if (code == 0) inquire (unit=unit, size=length)
      allocate (character(length) :: text)
      if (length > 0) read (unit) text
      if (code == 0) close (unit)
   end subroutine slurp

   subroutine test_csv_row(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: y(3) = [-0.8_dp, 1/3.0_dp, 1e-46_dp], q(4) = [1.0_dp, 0.0_dp, &
         -1e150_dp, 0.1_dp]
      character(longest_row) :: room
      character(:), allocatable :: row
      real(dp) :: back(12)
      integer :: n
      call csv_row("0.1", 7_i8, y, q, 2.5_dp, -0.5_dp, room, n)
      row = room(:n)
      read (row, *) back
      call expect(error, all(abs(back - [0.1_dp, 7.0_dp, q, y, 2.5_dp, -0.5_dp, 2.0_dp]) <= 0), row)
      call expect(error, index(row, " "), 0, "a blank in a row")
   end subroutine test_csv_row

   !> Run a scene into a folder of the test output; the end state of its bodies.
   subroutine run_to(scene, folder, y, q, failure)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: folder
      real(dp), allocatable, intent(out) :: y(:, :), q(:, :)
      type(poinsot_error), intent(inout) :: failure
      type(run_watch) :: watch
      type(run_report) :: report
      character(:), allocatable :: text
      integer :: first, n, k
      real(dp) :: values(12)
      call remove_folder(folder)
      call run_scene(scene, output // "/" // folder, watch, report, failure)
      if (raised(failure)) return
      n = int(sum(scene%bodies%count))
      allocate (y(3, n), q(4, n), source=0.0_dp)
      call slurp(output // "/" // folder // "/trajectory.csv", text)
      do k = n, 1, -1 ! the last rows
         if (len(text) == 0) return
         first = index(text(:len(text) - 1), nl, back=.true.) + 1
         read (text(first:len(text) - 1), *) values
         q(:, k) = values(3:6)
         y(:, k) = values(7:9)
         text = text(:first - 1)
      end do
   end subroutine run_to

   !> What another version of these tests left.
   subroutine remove_folder(folder)
      character(*), intent(in) :: folder
      integer :: state
      call execute_command_line("rm -rf " // output // "/" // folder, exitstat=state)
   end subroutine remove_folder

   !> Published data 1: the review's figure 1, to the digits.
   subroutine test_published_free_body(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: y_end(3) = [0.0545936805170048_dp, -0.5930307093190378_dp, &
         -0.8033268997439126_dp]
      real(dp), parameter :: q_end(4) = [-0.7620456033094549_dp, -0.5769991038241422_dp, &
                                         -0.0272197283757480_dp, 0.2926048855539088_dp]
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      real(dp), allocatable :: y(:, :), q(:, :)
      call load("free-body", "", scene, failure)
      if (.not. raised(failure)) call run_to(scene, "free-body", y, q, failure)
      call expect(error, .not. raised(failure), "the run failed")
      call expect(error, maxval(abs(y(:, 1) - y_end)) < 2e-14_dp .and. &
                 attitude_distance(q(:, 1), q_end) < 5e-14_dp, "not the published end")
   end subroutine test_published_free_body

   !> Published data 3: the heavy top.
   subroutine test_published_top(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: y_end(3) = [1.922573381663007_dp, 0.7720232344670848_dp, &
         -0.2011054792035490_dp]
      real(dp), parameter :: q_end(4) = [0.9257399890934638_dp, -0.3514906679727545_dp, &
                                         0.1021838760186523_dp, -0.0949644059798463_dp]
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      real(dp), allocatable :: y(:, :), q(:, :)
      call load("heavy-top", "", scene, failure)
      if (.not. raised(failure)) call run_to(scene, "heavy-top", y, q, failure)
      call expect(error, .not. raised(failure), "the run failed")
      call expect(error, maxval(abs(y(:, 1) - y_end)) < 2e-14_dp .and. &
                 attitude_distance(q(:, 1), q_end) < 5e-14_dp, "not the published end")
   end subroutine test_published_top

   !> The heavy top given by a tensor in axes turned about the body's axis 3 by acos(0.6): the same
   !> motion, momentum and attitude in those axes.
   subroutine test_tensor_frame(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: c = 0.6_dp, s = 0.8_dp, y_end(3) = &
         [1.922573381663007_dp, 0.7720232344670848_dp, -0.2011054792035490_dp]
      real(dp) :: wanted(3)
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      real(dp), allocatable :: y(:, :), q(:, :)
      ! given = A principal, A = [c -s; s c]; tensor = A diag(.6, .8, 1) A^T; y0 = A (1.8, .4, -.9);
      ! the attitude of the given frame is Q A^T; centre (0.3, 0, 1) of the principal frame for a
      ! test
      call make("&scene t_end=10 h=0.02 /&bodies tensor=" // text_of(0.6_dp*c*c + 0.8_dp*s*s) // &
                "," // text_of(-0.2_dp*c*s) // ",0," // text_of(-0.2_dp*c*s) // &
                "," // text_of(0.6_dp*s*s + 0.8_dp*c*c) // ",0,0,0,1" // nl // "y=" // &
                text_of(1.8_dp*c - 0.4_dp*s) // "," // text_of(1.8_dp*s + 0.4_dp*c) // ",-0.9" // &
                nl // "q=" // text_of(sqrt(0.8_dp)) // ",0,0," // text_of(-sqrt(0.2_dp)) // &
                " /&gravity centre=0,0,1 /&output every=1 /", scene, failure)
      if (.not. raised(failure)) call run_to(scene, "tensor", y, q, failure)
      call expect(error, .not. raised(failure), "refused")
      wanted = [c*y_end(1) - s*y_end(2), s*y_end(1) + c*y_end(2), y_end(3)]
      call expect(error, maxval(abs(y(:, 1) - wanted)) < 1e-11_dp, "momentum in the given frame")
   end subroutine test_tensor_frame

   !> A run cut in two by a restart file writes the bytes of the uncut one, the thermostat's too.
   subroutine test_restart(error)
      type(error_type), allocatable, intent(out) :: error
      call cut_and_compare("heavy-top", "output.pictures=none", "scene.t_end=4", error)
      if (allocated(error)) return
      call cut_and_compare("rotating-field", "output.every=0.13", "scene.t_end=26", error)
      if (allocated(error)) return
      call cut_and_compare("thermostat", &
                           "bodies.count=70;output.sample=0;output.restart=restart.txt", &
                           "scene.t_end=7.5", error)
   end subroutine test_restart

   subroutine cut_and_compare(name, settings, cut, error)
      character(*), intent(in) :: name, settings, cut
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      real(dp), allocatable :: y(:, :), q(:, :)
      call load(name, settings, scene, failure)
      if (.not. raised(failure)) call run_to(scene, "whole", y, q, failure)
      if (.not. raised(failure)) call load(name, settings // ";" // cut, scene, failure)
      if (.not. raised(failure)) call run_to(scene, "first", y, q, failure)
      if (.not. raised(failure)) then
         call load(name, settings // ";scene.from=" // output // &
            "/first/restart.txt", scene, failure)
      end if
      if (.not. raised(failure)) call run_to(scene, "second", y, q, failure)
      call expect(error, .not. raised(failure), "a run of " // name // " failed")
      if (.not. allocated(error)) call same_parts(name, error)
   end subroutine cut_and_compare

   !> first + second = whole, to the byte; and the same restart file at the end.
   subroutine same_parts(name, error)
      character(*), intent(in) :: name
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: whole, first, second
      call slurp(output // "/whole/trajectory.csv", whole)
      call slurp(output // "/first/trajectory.csv", first)
      call slurp(output // "/second/trajectory.csv", second)
      call expect(error, len(second) > 200 .and. first // second(index(second, nl) + 1:) == whole, &
                 "the parts of " // name // " are not the whole")
      call slurp(output // "/whole/restart.txt", whole)
      call slurp(output // "/second/restart.txt", second)
      call expect(error, len(whole) > 100 .and. whole == second, "another end of " // name)
   end subroutine same_parts

   logical function stop_now(self)
      class(impatient), intent(inout) :: self
      self%looks = self%looks + 1
      stop_now = self%looks > 3
   end function stop_now

   !> Stopped between two outputs: readable trajectory, summary says so, continuation to the bit;
   !> for a splitting whose calls have ends that round, too.
   subroutine test_interrupt(error)
      type(error_type), allocatable, intent(out) :: error
      call stop_and_go_on("strang", error)
      if (.not. allocated(error)) call stop_and_go_on("takahashi-imada", error)
   end subroutine test_interrupt

   subroutine stop_and_go_on(splitting, error)
      character(*), intent(in) :: splitting
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      type(impatient) :: watch
      type(run_report) :: report
      character(:), allocatable :: text, settings
      real(dp), allocatable :: y(:, :), q(:, :)
      ! full blocks: so many body-steps that the watch is asked between outputs, in few block-steps
      settings = "scene.h=1e-3;output.every=5;bodies.count=96;scene.splitting=" // splitting
      call load("heavy-top", settings, scene, failure)
      if (.not. raised(failure)) call run_to(scene, "whole", y, q, failure)
      call remove_folder("first")
      call run_scene(scene, output // "/first", watch, report, failure)
      call expect(error, .not. raised(failure) .and. report%state == "interrupted", &
         "not interrupted")
      call expect(error, report%t > 0 .and. report%t < 10, "stopped at the start or the end")
      call slurp(output // "/first/summary.txt", text)
      call expect(error, index(text, "interrupted") > 0, "the summary does not say so")
      call load("heavy-top", settings // ";scene.from=" // output // "/first/restart.txt", scene, &
         failure)
      if (.not. raised(failure)) call run_to(scene, "second", y, q, failure)
      call expect(error, .not. raised(failure), "the continuation failed")
      if (.not. allocated(error)) call same_parts("the top interrupted, " // splitting, error)
   end subroutine stop_and_go_on

   !> Restart files that are truncated, changed, of other bodies or steps.
   subroutine test_restart_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      type(restart_state) :: state
      type(body_states) :: states
      type(communicator) :: alone
      character(:), allocatable :: text
      real(dp), allocatable :: y(:, :), q(:, :)
      integer :: i, unit
      call load("heavy-top", "scene.t_end=1", scene, failure)
      if (.not. raised(failure)) call run_to(scene, "first", y, q, failure)
      call slurp(output // "/first/restart.txt", text)
      call expect(error, .not. raised(failure) .and. len(text) > 100, "no restart file")
      do i = 0, len(text) - 2, 7
         open (newunit=unit, file=output // "/cut.txt", access="stream", status="replace")
         write (unit) text(:i)
         close (unit)
         call clear(failure)
         call first_states(scene, states, failure)
         call read_restart(output // "/cut.txt", 0_i8, state, states, alone, failure)
         call expect(error, failure%code, poinsot_e_scene, "a truncated file is taken")
      end do
      call refused("scene.h=0.01", "h = 0.02")
      if (.not. allocated(error)) call refused("scene.method=dmv8", "method = exact")
      if (.not. allocated(error)) call refused("scene.seed=5", "seed = 1")
      if (.not. allocated(error)) call refused("bodies.moments=0.6,0.9,1", "other moments")
      if (.not. allocated(error)) call refused("bodies.count=2", "the scene has 2")
      if (.not. allocated(error)) call refused("scene.t_end=0.5", "not before t_end")

   contains

      subroutine refused(setting, words)
         character(*), intent(in) :: setting, words
         call clear(failure)
         call load("heavy-top", setting // ";scene.from=" // output // "/first/restart.txt", &
            scene, failure)
         if (.not. raised(failure)) call run_to(scene, "second", y, q, failure)
         call expect(error, failure%code, poinsot_e_scene, "taken with " // setting)
         if (.not. allocated(error)) then
            call expect(error, index(failure%message, words) > 0, failure%message)
         end if
      end subroutine refused

   end subroutine test_restart_refusals

   !> A step too long for the method: an error, and a summary that says failed.
   subroutine test_failed_run(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      real(dp), allocatable :: y(:, :), q(:, :)
      character(:), allocatable :: text
      call load("heavy-top", "scene.method=dmv4;scene.h=3;output.every=3", scene, failure)
      if (.not. raised(failure)) call run_to(scene, "failed", y, q, failure)
      call expect(error, failure%code, poinsot_e_partial, "not the error of a failed body")
      call slurp(output // "/failed/summary.txt", text)
      call expect(error, index(text, "failed") > 0 .and. index(text, "complete") == 0, &
         "summary: " // text)
   end subroutine test_failed_run

   subroutine test_output_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      type(run_watch) :: watch
      type(run_report) :: report
      call load("free-body", "", scene, failure)
      call run_scene(scene, "fpm.toml", watch, report, failure)
      call expect(error, failure%code, poinsot_e_io, "a file as output folder")
      call clear(failure)
      call run_scene(scene, "/dev/null/x", watch, report, failure)
      call expect(error, failure%code, poinsot_e_io, "no place for an output folder")
   end subroutine test_output_refused

   !> Command lines and what they print, from test/golden; skipped without POINSOT_APP.
   subroutine test_golden(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: names(16) = [character(20) :: &
         "help", "help-run", "help-hard", "hard-unknown", "methods", "scenes-one", &
         "effects-gravity", "unknown-command", "unknown-option", "unknown-scene", "unknown-key", &
         "unknown-method", "bad-moments", "bad-step", "no-value", "check"]
      character(:), allocatable :: wanted, got, arguments
      integer :: i
      do i = 1, size(names)
         call slurp("test/golden/" // trim(names(i)) // ".txt", wanted)
         call expect(error, index(wanted, "$ poinsot "), 1, "no golden output: " // trim(names(i)))
         arguments = wanted(11:index(wanted, nl) - 1)
         call ask_app(arguments, got, error)
         if (allocated(error)) return
         call expect(error, got == wanted(index(wanted, nl) + 1:), "poinsot " // arguments // &
            " prints:" // nl // got)
      end do
   end subroutine test_golden

   !> docs/scenes.md holds what `poinsot keys` prints; skipped without POINSOT_APP.
   subroutine test_keys(error)
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: page, got, tables
      call ask_app("keys", got, error)
      if (allocated(error)) return
      call slurp("docs/scenes.md", page)
      tables = got(:index(got, "exit 0") - 1)
      call expect(error, len(tables) > 1000 .and. index(page, tables) > 0, &
                 "docs/scenes.md does not hold what `poinsot keys` prints now:" // nl // tables)
   end subroutine test_keys

end module test_scene
