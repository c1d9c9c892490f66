!> Pictures of a run: which a scene has, what stays constant in it, and texts that reach gnuplot.
module test_pictures
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised, clear
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_integrals, only: integral_list, scene_integrals
   use poinsot_scene_pictures, only: picture_names, scene_files
   use poinsot_scene_plot_data, only: quoted_text
   use poinsot_scene_reader, only: read_source, scan_source
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_source, only: scene_source
   use poinsot_scene_text, only: joined
   use test_expectation, only: expect
   implicit none(type, external)
   private
   public :: collect_pictures

   character, parameter :: nl = achar(10)
   character(*), parameter :: top = "&scene t_end=1 h=0.1 /" // nl // &
      "&bodies moments=2,2,1 y=1.8,0.4,-0.9 /" // nl

contains

   subroutine collect_pictures(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("several-kinds", several_kinds), &
         new_unittest("kinds-refused", kinds_refused), &
         new_unittest("averages-are-drawn", averages_drawn), &
         new_unittest("integrals-of-shipped-scenes", shipped_integrals), &
         new_unittest("integrals-of-tops", top_integrals), &
         new_unittest("texts-for-gnuplot", gnuplot_texts)]
   end subroutine collect_pictures

   subroutine make(text, scene, failure)
      character(*), intent(in) :: text
      type(scene_settings), intent(out) :: scene
      type(poinsot_error), intent(inout) :: failure
      type(scene_source) :: source
      call clear(failure)
      call scan_source(text, "test.nml", source, failure)
      if (.not. raised(failure)) call build_scene(source, scene, failure)
   end subroutine make

   subroutine several_kinds(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: texts(5) = [character(24) :: "none", "auto", "tilt", &
         "top body", "angle+body, tilt  top"]
      character(*), parameter :: names(5) = [character(60) :: "", "attitude, momentum, drift", &
         "tilt, drift", "nutation, drift, attitude, momentum", &
         "angle, drift, attitude, momentum, tilt, nutation"]
      character(*), parameter :: wheel = "&gyrostat times=0,1 table=0,0,1,0,0,2 /"
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      character(16), allocatable :: found(:)
      integer :: i
      do i = 1, size(texts)
         call make(top // "&output every=0.5 pictures='" // trim(texts(i)) // "' /", scene, failure)
         call expect(error, .not. raised(failure), trim(texts(i)) // ": refused")
         call picture_names(scene, found)
         call expect(error, joined(found) == trim(names(i)), &
            trim(texts(i)) // ": " // joined(found))
      end do
      call make(top // wheel // nl // "&output every=0.5 /", scene, failure)
      call picture_names(scene, found)
      call expect(error, joined(found) == "attitude, drift", "a wheel that changes: " // &
         joined(found))
   end subroutine several_kinds

   !> Observables have a picture of their own, which needs no trajectory.csv.
   subroutine averages_drawn(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: texts(3) = [character(40) :: "", "format='npy'", &
         "pictures='none'"]
      character(*), parameter :: names(3) = [character(40) :: &
         "attitude, momentum, drift, observables", "observables", ""]
      character(*), parameter :: files(3) = [character(160) :: "", "trajectory.gp, common.gp, " // &
         "plot_observables.gp, observables.svg, observables.png", ""]
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      character(16), allocatable :: found(:)
      character(40), allocatable :: written(:)
      integer :: i
      do i = 1, size(texts)
         call make(top // "&output every=0.5 observables=T " // trim(texts(i)) // " /", scene, &
            failure)
         call expect(error, .not. raised(failure), trim(texts(i)) // ": refused")
         call picture_names(scene, found)
         call expect(error, joined(found) == trim(names(i)), trim(texts(i)) // ": " // &
            joined(found))
         call scene_files(scene, written)
         if (i > 1) call expect(error, joined(written) == trim(files(i)), joined(written))
      end do
   end subroutine averages_drawn

   subroutine kinds_refused(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: texts(5) = [character(12) :: "bodies", "", "auto body", &
         "body none", "body, topp"]
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      integer :: i
      do i = 1, size(texts)
         call make(top // "&output every=0.5 pictures='" // trim(texts(i)) // "' /", scene, failure)
         call expect(error, raised(failure), "taken: " // trim(texts(i)))
         call expect(error, index(failure%message, "test.nml:3") > 0, failure%message)
      end do
   end subroutine kinds_refused

   subroutine shipped_integrals(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: names(10) = [character(16) :: "free-body", "tennis-racket", &
         "heavy-top", "sleeping-top", "kovalevskaya", "satellite", "rotating-field", &
         "dipole-chain", "gyrostat", "thermostat"]
      character(*), parameter :: kept(10) = [character(44) :: "energy length momentum norm", &
         "energy length momentum norm", "energy vertical norm", "energy vertical norm", &
         "energy vertical kovalevskaya norm", "rotating norm", "rotating norm", "energy norm", &
         "energy length momentum norm", "work norm"]
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      type(scene_source) :: source
      type(integral_list) :: list
      integer :: i
      do i = 1, size(names)
         call read_source("scenes/" // trim(names(i)) // ".nml", source, failure)
         if (.not. raised(failure)) call build_scene(source, scene, failure)
         call expect(error, .not. raised(failure), names(i))
         call scene_integrals(scene, list)
         call expect(error, list%words, trim(kept(i)), names(i))
         if (names(i) == "rotating-field") call expect(error, abs(list%spin(3) - 0.5_dp) <= 0, "W")
      end do
   end subroutine shipped_integrals

   !> The third integral is there exactly for Lagrange's and Kovalevskaya's tops; what pulls
   !> sideways, works, or turns otherwise takes integrals away.
   subroutine top_integrals(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: texts(9) = [character(120) :: &
         "&gravity centre=0,0,-1 /", "&gravity centre=0.6,0.8,0 weight=2 /", &
         "&gravity centre=1,0,0.1 /", "&gravity centre=0,0,1 up=1,0,0 /", &
         "&gravity centre=0,0,1 up=0,0,-3 /", &
         "&gravity centre=0,0,1 /" // nl // "&drag friction=1 /", &
         "&field dipole=1,0,0 strength=0,0,2 /" // nl // "&gravity centre=1,0,0 /", &
         "&gravity_gradient rate=1 /" // nl // "&field dipole=1,0,0 strength=1,0,0 " // &
         "motion='rotating' frequency=2 /", &
         "&gravity_gradient rate=1 normal=0,0,2 /" // nl // "&gravity centre=1,0,0 /"]
      character(*), parameter :: kept(9) = [character(44) :: "energy vertical symmetry norm", &
         "energy vertical kovalevskaya norm", "energy vertical norm", "energy norm", &
         "energy vertical symmetry norm", "work norm", "energy vertical norm", "work norm", &
         "rotating norm"]
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      type(integral_list) :: list
      integer :: i
      do i = 1, size(texts)
         call make(top // trim(texts(i)), scene, failure)
         call expect(error, .not. raised(failure), trim(texts(i)) // " refused")
         call scene_integrals(scene, list)
         call expect(error, list%words, trim(kept(i)), trim(texts(i)))
         if (i /= 2) cycle
         call expect(error, abs(list%pull - 2) + abs(list%first(2) - 0.8_dp) < 1e-14_dp, "pull")
      end do
   end subroutine top_integrals

   subroutine gnuplot_texts(error)
      type(error_type), allocatable, intent(out) :: error
      call expect(error, quoted_text("it's `x` $(y) ""z"" <&"), "'it''s `x` $(y) ""z"" <&'")
      call expect(error, quoted_text("a" // nl // "b" // achar(127)), "'a?b?'")
   end subroutine gnuplot_texts

end module test_pictures
