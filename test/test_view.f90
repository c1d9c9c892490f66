!> The page that shows a motion: its data as JSON, which outputs it keeps, an old page made anew.
module test_view
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised, clear
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_files, only: make_folder
   use poinsot_scene_json, only: quoted_json, number_json, numbers_json
   use poinsot_scene_reader, only: scan_source
   use poinsot_scene_run, only: run_scene
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_source, only: scene_source
   use poinsot_scene_summary, only: run_report
   use poinsot_scene_view, only: remake_view
   use poinsot_scene_watch, only: run_watch
   use test_expectation, only: expect
   implicit none(type, external)
   private
   public :: collect_view

   character(*), parameter :: folder = "build/test-output/view"
   character(*), parameter :: template = folder // "/template.html"

contains

   subroutine collect_view(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("json-text", test_text), &
         new_unittest("json-numbers", test_numbers), &
         new_unittest("page-of-a-run", test_page), &
         new_unittest("page-of-two-bodies", test_two), &
         new_unittest("page-of-a-wheel", test_wheel), &
         new_unittest("page-made-anew", test_anew), &
         new_unittest("many-outputs-and-bodies", test_many)]
   end subroutine collect_view

   !> Nothing ends the element early, nothing ends the text.
   subroutine test_text(error)
      type(error_type), allocatable, intent(out) :: error
      call expect(error, quoted_json("a""b\c</script>&" // achar(10) // "`$(x)'"), &
         """a\u0022b\u005Cc\u003C/script\u003E\u0026\u000A`$(x)'""")
   end subroutine test_text

   subroutine test_numbers(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: x(8) = [0.0_dp, -1.5_dp, 120.0_dp, 0.001_dp, 1/3.0_dp, 1e-46_dp, &
                                     -2.5e150_dp, 99999.9_dp]
      real(dp) :: infinite
      infinite = transfer(9218868437227405312_i8, infinite)
      call expect(error, numbers_json(x, 5) == &
         "[0,-1.5,120,0.001,0.33333,1e-46,-2.5e150,1e5]", numbers_json(x, 5))
      call expect(error, number_json(infinite, 5) == "null", "infinity")
      call expect(error, number_json(100000.0_dp, 6) == "100000", number_json(100000.0_dp, 6))
   end subroutine test_numbers

   !> A top runs into a folder: the page says what it is, and holds every output.
   subroutine test_page(error)
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: page
      call run_text("top", "&scene t_end = 1, h = 0.1 / &bodies moments = 0.6, 0.8, 1.0, " // &
         "y = 1.8, 0.4, -0.9 / &gravity centre = 0, 0, 1 / &output every = 0.1, " // &
         "pictures = 'none', restart = '' /", page, error)
      if (allocated(error)) return
      call expect(error, index(page, "BEGIN<script type=""application/json"" id=""data"">" // &
                  achar(10) // "{") == 1, &
                  "the template's beginning")
      call expect(error, index(page, "</script>END") > 0, "the template's end")
      call expect(error, index(page, """about"": ""exact + srkn6, h = 0.1,") > 0, "how it goes")
      call expect(error, index(page, """kind"": ""top""") > 0, "not a top")
      call expect(error, index(page, """centre"": [0,0,1]") > 0, "no centre")
      call expect(error, index(page, """t"": [0,0.1,0.2,0.3,0.4,0.5,0.6,0.7,0.8,0.9,1]") > 0, &
                  "the times")
      call expect(error, index(page, "H/H") > 0, "no change of the energy")
   end subroutine test_page

   !> Two bodies have energies of their own; shapes, words and a direction that turns are told.
   subroutine test_two(error)
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: page
      call run_text("two", "! Two <bodies>." // achar(10) // "!" // achar(10) // &
         "!Look for: ""them""." // achar(10) // "&scene t_end = 1, h = 0.5 / " // &
         "&bodies shape = 'cylinder', size = 1, 2, y = 0, 0, 0 / " // &
         "&bodies moments = 1, 2, 2, drawn = 'racket', y = 1, 0, 0 / " // &
         "&spring stiffness = -1, direction = 1, 0, 0, rate = 0.05, class = 1 / " // &
         "&output every = 0.5, pictures = 'none', restart = '' /", page, error)
      if (allocated(error)) return
      call expect(error, index(page, """words"": ""Two \u003Cbodies\u003E.\u000A\u000ALook " // &
                  "for: \u0022them\u0022.\u000A""") > 0, "the words of the scene")
      call expect(error, index(page, """kinetic"": [0.5,0.5,0.5]") > 0, "the second's energy")
      call expect(error, index(page, """potential"": [0,0,0]") > 0, "the second's potential")
      call expect(error, index(page, """shape"": ""cylinder"", ""size"": [1,2,0]") > 0, &
                  "the shape that was told")
      call expect(error, index(page, """shape"": ""racket""") > 0, "the shape to be drawn")
      call expect(error, index(page, """kind"": ""turning""") > 0, "no direction that turns")
      call expect(error, index(page, """frame"": {""name"": ""spring"", " // &
                  """label"": ""spring"", ""axis"": [0,0,1], ""rate"": 0.05, ""phase"": 0,") > 0, &
                  "how the direction turns")
   end subroutine test_two

   !> A wheel inside is no torque: nothing is split.
   subroutine test_wheel(error)
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: page
      call run_text("wheel", "&scene t_end = 1, h = 0.5 / &bodies moments = 1, 2, 3 / " // &
         "&gyrostat rotor = 0, 1, 0 / &output every = 0.5, pictures = 'none', restart = '' /", &
         page, error)
      if (allocated(error)) return
      call expect(error, index(page, """about"": ""exact, h = 0.5,") > 0, "how it goes")
   end subroutine test_wheel

   !> The same data in another template; a folder without a page is refused.
   subroutine test_anew(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: failure
      character(:), allocatable :: page, again
      call run_text("anew", "&scene t_end = 1 / &bodies moments = 1, 2, 3, y = 1, 1, 1 / " // &
         "&output every = 0.5, pictures = 'none', restart = '' /", page, error)
      if (allocated(error)) return
      call remake_view(template, folder // "/anew", failure)
      call expect(error, .not. raised(failure), "not made anew")
      call slurp(folder // "/anew/view.html", again)
      call expect(error, again == page, "other data")
      call remake_view(template, folder // "/nowhere", failure)
      call expect(error, raised(failure), "a page from nothing")
      call clear(failure)
   end subroutine test_anew

   !> 100 bodies and 1000 outputs: 40 bodies share 2000 states, and the end is among them.
   subroutine test_many(error)
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: page
      integer :: bodies, from
      call run_text("many", "&scene t_end = 1000 / &bodies count = 100, moments = 1, 2, 3, " // &
         "y = 1, 1, 1 / &output every = 1, pictures = 'none', restart = '', bodies = 1, 2 /", &
         page, error)
      if (allocated(error)) return
      call expect(error, index(page, """name"": ""2""") > 0, "the second body")
      call expect(error, len(page) < 300000, "a long page")
      call run_text("many", "&scene t_end = 1000 / &bodies count = 100, moments = 1, 2, 3, " // &
         "y = 1, 1, 1 / &output every = 1, pictures = 'none', restart = '' /", page, error)
      if (allocated(error)) return
      bodies = 0
      from = 1
      do while (index(page(from:), """name"": """) > 0)
         from = from + index(page(from:), """name"": """)
         if (index("0123456789", page(from + 8:from + 8)) > 0) bodies = bodies + 1
      end do
      call expect(error, bodies, 40)
      call expect(error, len(page) < 400000, "a long page of many bodies")
      from = index(page, """t"": [")
      call expect(error, index(page(from:from + index(page(from:), "]")), ",1000]") > 0, "no end")
   end subroutine test_many

   !> Run a scene's text into a folder; its page, in a template of three words.
   subroutine run_text(name, text, page, error)
      character(*), intent(in) :: name, text
      character(:), allocatable, intent(out) :: page
      type(error_type), allocatable, intent(inout) :: error
      type(scene_source) :: source
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      type(run_watch) :: watch
      type(run_report) :: report
      integer :: unit
      page = ""
      call make_folder(folder, failure)
      open (newunit=unit, file=template, action="write", status="replace")
      write (unit, "(a)") "BEGIN<script type=""application/json"" id=""data"">@DATA@</script>END"
      close (unit)
      call scan_source(text, name // ".nml", source, failure)
      if (.not. raised(failure)) call build_scene(source, scene, failure)
      if (.not. raised(failure)) then
         scene%output%page = template
         call run_scene(scene, folder // "/" // name, watch, report, failure)
      end if
      if (raised(failure)) then
         call expect(error, .false., failure%message)
         return
      end if
      call slurp(folder // "/" // name // "/view.html", page)
   end subroutine run_text

   subroutine slurp(path, text)
      character(*), intent(in) :: path
      character(:), allocatable, intent(out) :: text
      integer :: unit, length, code
      text = ""
      open (newunit=unit, file=path, access="stream", form="unformatted", action="read", &
         iostat=code)
      if (code /= 0) return
      inquire (unit=unit, size=length)
      deallocate (text)
      allocate (character(length) :: text)
      if (length > 0) read (unit) text
      close (unit)
   end subroutine slurp

end module test_view
