!> What tests of scenes share: scenes from text, runs into folders of the test output, whole files.
module test_scene_tools
   use testdrive, only: error_type, skip_test
   use test_expectation, only: expect
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_files, only: make_folder
   use poinsot_scene_override, only: override
   use poinsot_scene_reader, only: scan_source
   use poinsot_scene_run, only: run_scene
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_source, only: scene_source
   use poinsot_scene_summary, only: run_report
   use poinsot_scene_watch, only: run_watch
   implicit none(type, external)
   private
   public :: output, nl, empty_folder, put_text, get_text, make_scene, run_text, run_made, column, &
      ask_app

   character, parameter :: nl = achar(10)
   character(*), parameter :: output = "build/test-output/"

contains

   !> A scene from its text, and settings ("a=b;c=d") over it.
   subroutine make_scene(text, scene, failure, settings)
      character(*), intent(in) :: text
      type(scene_settings), intent(out) :: scene
      type(poinsot_error), intent(inout) :: failure
      character(*), intent(in), optional :: settings
      type(scene_source) :: source
      integer :: first, last
      call scan_source(text, "test.nml", source, failure)
      first = 1
      if (present(settings)) then
         do while (first <= len(settings) .and. .not. raised(failure))
            last = index(settings(first:) // ";", ";") + first - 2
            call override(settings(first:last), source, failure)
            first = last + 2
         end do
      end if
      if (.not. raised(failure)) call build_scene(source, scene, failure)
   end subroutine make_scene

   !> Run a scene into a folder of the test output, emptied before.
   subroutine run_made(scene, folder, failure, report)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: folder
      type(poinsot_error), intent(inout) :: failure
      type(run_report), intent(out), optional :: report
      type(run_watch) :: watch
      type(run_report) :: here
      type(scene_settings) :: copy
      if (raised(failure)) return
      call empty_folder(folder)
      copy = scene
      copy%output%draw = .false.
      call run_scene(copy, output // folder, watch, here, failure)
      if (present(report)) report = here
   end subroutine run_made

   !> The numbers of a column of a CSV file that a run wrote; size 0 without such a column.
   subroutine column(path, name, values)
      character(*), intent(in) :: path, name
      real(dp), allocatable, intent(out) :: values(:)
      character(:), allocatable :: text, line
      integer :: at, k, i, first
      call get_text(output // path, text)
      allocate (values(0))
      at = index(text, nl)
      if (at == 0) return
      line = "," // text(:at - 1) // ","
      first = index(line, "," // name // ",")
      if (first == 0) return
      k = 0
      do i = 1, first
         if (line(i:i) == ",") k = k + 1
      end do
      do while (at < len(text))
         line = text(at + 1:at + index(text(at + 1:), nl) - 1)
         at = at + len(line) + 1
         values = [values, nth(line, k)]
      end do
   end subroutine column

   !> The k-th number of a line.
   real(dp) function nth(line, k)
      character(*), intent(in) :: line
      integer, intent(in) :: k
      integer :: i, first, last
      first = 1
      do i = 2, k
         first = first + index(line(first:), ",")
      end do
      last = first + index(line(first:) // ",", ",") - 2
      read (line(first:last), *) nth
   end function nth

   !> An empty folder of the test output.
   subroutine empty_folder(name)
      character(*), intent(in) :: name
      type(poinsot_error) :: failure
      integer :: state
      call execute_command_line("rm -rf " // output // name, exitstat=state)
      call make_folder(output // name, failure)
   end subroutine empty_folder

   subroutine put_text(path, text)
      character(*), intent(in) :: path, text
      integer :: unit
      open (newunit=unit, file=path, access="stream", form="unformatted", status="replace", &
            action="write")
      write (unit) text
      close (unit)
   end subroutine put_text

   subroutine get_text(path, text)
      character(*), intent(in) :: path
      character(:), allocatable, intent(out) :: text
      integer :: unit, length, code
      open (newunit=unit, file=path, access="stream", form="unformatted", status="old", &
            action="read", iostat=code)
      length = 0
      if (code == 0) inquire (unit=unit, size=length)
      allocate (character(length) :: text)
      if (length > 0) read (unit) text
      if (code == 0) close (unit)
   end subroutine get_text

   !> Run a scene, given by its text, into a folder.
   subroutine run_text(text, folder, failure, file, report, watch)
      character(*), intent(in) :: text, folder
      type(poinsot_error), intent(inout) :: failure
      character(*), intent(in), optional :: file
      type(run_report), intent(out), optional :: report
      class(run_watch), intent(inout), optional :: watch
      type(scene_source) :: source
      type(scene_settings) :: scene
      type(run_watch) :: patient
      type(run_report) :: here
      character(:), allocatable :: name
      name = "test.nml"
      if (present(file)) name = file
      call scan_source(text, name, source, failure)
      if (.not. raised(failure)) call build_scene(source, scene, failure)
      if (raised(failure)) return
      if (present(watch)) then
         call run_scene(scene, output // folder, watch, here, failure)
      else
         call run_scene(scene, output // folder, patient, here, failure)
      end if
      if (present(report)) report = here
   end subroutine run_text

   !> What the program named by POINSOT_APP prints, its exit code in the last line.
   subroutine ask_app(arguments, got, error)
      character(*), intent(in) :: arguments
      character(:), allocatable, intent(out) :: got
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: asked = "build/test-asked.txt"
      character(:), allocatable :: app
      integer :: length, state, code
      call get_environment_variable("POINSOT_APP", length=length)
      if (length == 0) then
         call skip_test(error, "POINSOT_APP does not name the program")
         return
      end if
      allocate (character(length) :: app)
      call get_environment_variable("POINSOT_APP", app)
      call execute_command_line("{ '" // app // "' " // arguments // "; echo exit $?; } >" // &
                                asked // " 2>&1", exitstat=state, cmdstat=code)
      call expect(error, code == 0 .and. state == 0, "no shell to run the program")
      call get_text(asked, got)
   end subroutine ask_app

end module test_scene_tools
