!> Room scene: what a run writes beside the state: columns by name, NumPy arrays, observables.
module test_scene_endings
   use testdrive, only: new_unittest, unittest_type, error_type
   use test_expectation, only: expect, within
   use test_oracle_algebra, only: rotate
   use test_scene_tools, only: output, nl, make_scene, run_made, column, get_text
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_summary, only: run_report
   implicit none(type, external)
   private
   public :: collect_scene_endings

   character(*), parameter :: run = "&scene t_end=1 h=0.05 /" // nl
   character(*), parameter :: skew = "&bodies tensor=2,0.1,0, 0.1,3,0.2, 0,0.2,4 " // &
      "omega=0.3,1.2,-0.5 euler=0.1,0.7,0.2 count=2 /" // nl

contains

   subroutine collect_scene_endings(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("columns-by-name", test_columns), &
         new_unittest("columns-of-a-gyrostat", test_gyrostat), &
         new_unittest("numpy-array", test_npy), &
         new_unittest("observables-of-all-bodies", test_observables), &
         new_unittest("end-compared", test_compared), &
         new_unittest("columns-refused", test_refused)]
   end subroutine collect_scene_endings

   subroutine run_text(text, folder, error)
      character(*), intent(in) :: text, folder
      type(error_type), allocatable, intent(inout) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      call make_scene(text, scene, failure)
      call run_made(scene, folder, failure)
      if (raised(failure)) call expect(error, .false., failure%message)
   end subroutine run_text

   !> The end beside a better run: all bodies of a small run, some of a large one; what `auto` chose
   !> is held to its tolerance.
   subroutine test_compared(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: top = "&gravity centre=0,0,1 /" // nl
      character(*), parameter :: many = "&bodies moments=1,1.2,1.5 count=1500 " // &
         "random='thermal' temperature=1 /" // nl
      type(run_report) :: report
      call compared("&bodies moments=1,1.2,1.5 y=1,2,3 /" // nl // top, "strang", 1e-8_dp, report)
      call expect(error, report%reference, "the same scene with 'exact' and a quarter of the step")
      call expect(error, report%error_y > 1e-6_dp .and. report%beyond, "strang is not within 1e-8")
      call compared("&bodies moments=1,1.2,1.5 y=1,2,3 /" // nl // top, "strang", 0.1_dp, report)
      call expect(error, .not. report%beyond, "strang is within .1")
      call compared(many // top, "taylor", 1e-4_dp, report)
      call expect(error, report%reference, &
         "the same scene with tolerance = 1e-15, of 64 of 1500 bodies")
      call expect(error, report%error_y < 1e-10_dp .and. report%error_q < 1e-10_dp .and. .not. &
         report%beyond, "taylor at 1e-12")
      call compared(many, "srkn6", 1e-4_dp, report)
      call expect(error, report%reference, "'jacobi' in one stride, of 64 of 1500 bodies")
      call expect(error, report%error_y < 1e-13_dp .and. report%error_q < 1e-13_dp, "exact")
   end subroutine test_compared

   subroutine compared(text, splitting, tol, report)
      character(*), intent(in) :: text, splitting
      real(dp), intent(in) :: tol
      type(run_report), intent(out) :: report
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      call make_scene(run // text, scene, failure)
      scene%splitting = splitting
      scene%chosen = "as if by auto"
      scene%tol = tol
      call run_made(scene, "compared", failure, report)
      if (raised(failure)) report%reference = failure%message
   end subroutine compared

   !> 2 T = omega.y, the tilt is the second Euler angle, Q y stays.
   subroutine test_columns(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: w(:), y(:), twice(:), kinetic(:), tilt(:), euler(:), up(:)
      character :: axis
      integer :: i
      call run_text(run // skew // "&output every=0.25 columns='omega1,omega2 OMEGA3 tilt euler2 " &
         // "qy3 euler1 qy1 qy2' /", "columns", error)
      if (allocated(error)) return
      call column("columns/trajectory.csv", "kinetic", kinetic)
      call expect(error, size(kinetic), 10, "rows")
      allocate (twice(size(kinetic)), source=0.0_dp)
      do i = 1, 3
         write (axis, "(i1)") i
         call column("columns/trajectory.csv", "omega" // axis, w)
         call column("columns/trajectory.csv", "y" // axis, y)
         call expect(error, size(w) == 10 .and. size(y) == 10, "columns")
         if (allocated(error)) return
         twice = twice + w*y
      end do
      call within(error, maxval(abs(twice - 2*kinetic)), 4e-15_dp, "omega.y against 2 T")
      call column("columns/trajectory.csv", "tilt", tilt)
      call column("columns/trajectory.csv", "euler2", euler)
      call column("columns/trajectory.csv", "Qy3", up)
      call within(error, maxval(abs(tilt - euler)), 1e-14_dp, "tilt against nutation")
      call within(error, tilt(1) - 0.7_dp, 1e-15_dp, "the first tilt")
      call within(error, maxval(abs(up - up(1))), 1e-14_dp, "Q y along z")
      call check_space_momentum(error)
      call column("columns/trajectory.csv", "euler1", euler)
      call within(error, euler(1) - 0.1_dp, 1e-15_dp, "the first precession")
   end subroutine test_columns

   !> Q y by its three columns against the attitude and the momentum of each row.
   subroutine check_space_momentum(error)
      type(error_type), allocatable, intent(inout) :: error
      real(dp), allocatable :: x(:), q(:, :), y(:, :), space(:, :)
      character :: axis
      integer :: i
      allocate (q(4, 10), y(3, 10), space(3, 10))
      do i = 0, 3
         write (axis, "(i1)") i
         call column("columns/trajectory.csv", "q" // axis, x)
         q(i + 1, :) = x
         if (i == 0) cycle
         call column("columns/trajectory.csv", "y" // axis, x)
         y(i, :) = x
         call column("columns/trajectory.csv", "Qy" // axis, x)
         space(i, :) = x
      end do
      do i = 1, 10
         call within(error, norm2(space(:, i) - rotate(q(:, i), y(:, i))), 1e-14_dp, "Q y")
      end do
   end subroutine check_space_momentum

   !> omega is what was given, with a rotor inside.
   subroutine test_gyrostat(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: w(:)
      call run_text(run // skew // "&gyrostat rotor=0.4,0.5,0.6 /" // nl // &
         "&output every=0.5 columns='omega2' /", "columns-gyrostat", error)
      call column("columns-gyrostat/trajectory.csv", "omega2", w)
      call expect(error, size(w), 6, "rows")
      if (.not. allocated(error)) call within(error, w(1) - 1.2_dp, 1e-15_dp, "omega")
   end subroutine test_gyrostat

   !> A head that says what follows, the numbers of the CSV file to the bit.
   subroutine test_npy(error)
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: bytes
      real(dp), allocatable :: numbers(:), y(:)
      call run_text(run // skew // "&output every=0.25 format='csv+npy' columns='tilt' /", "npy", &
         error)
      if (allocated(error)) return
      call get_text(output // "npy/trajectory.npy", bytes)
      call expect(error, len(bytes), 128 + 8*5*2*13, "length of the file")
      if (allocated(error)) return
      call expect(error, index(bytes(:128), "'fortran_order': False, 'shape': (5, 2, 13), }") > 0, &
         bytes(:128))
      call expect(error, bytes(2:6) == "NUMPY" .and. iachar(bytes(128:128)) == 10, &
         "magic, line end")
      numbers = transfer(bytes(129:), numbers, 130)
      call column("npy/trajectory.csv", "y2", y)
      call within(error, maxval(abs(numbers(8::13) - y)), 0.0_dp, "y2")
      call column("npy/trajectory.csv", "tilt", y)
      call within(error, maxval(abs(numbers(13::13) - y)), 0.0_dp, "tilt")
   end subroutine test_npy

   !> Means over all bodies, written ones or not.
   subroutine test_observables(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), allocatable :: kinetic(:), energy(:), one(:), sum_of(:), hot(:)
      character(2) :: number
      integer :: i
      call run_text(run // &
         "&bodies moments=1,1,0 count=4000 random='thermal' temperature=2.5 /" // &
         nl // "&output every=0.5 sample=2 observables=T /", "observables", error)
      if (allocated(error)) return
      call column("observables/observables.csv", "temperature", hot)
      call expect(error, size(hot), 3, "lines")
      if (allocated(error)) return
      call within(error, hot(1) - 2.5_dp, 0.12_dp, "temperature of linear bodies")
      call column("observables/observables.csv", "kinetic3", one)
      call within(error, maxval(abs(one)), 0.0_dp, "an axis without inertia")
      call column("observables/observables.csv", "kinetic1", kinetic)
      call column("observables/observables.csv", "kinetic2", one)
      call column("observables/observables.csv", "energy", energy)
      call within(error, maxval(abs(4000*(kinetic + one)/energy - 1)), 1e-12_dp, "kinetic of axes")
      call column("observables/observables.csv", "autocorrelation", one)
      call within(error, one(1) - 1, 1e-14_dp, "autocorrelation at first")
      call expect(error, one(3) < 0.9_dp, "autocorrelation later")
      sum_of = 0*one
      do i = 1, 10
         write (number, "(i0)") i
         call column("observables/observables.csv", "bin" // trim(number), one)
         sum_of = sum_of + one
      end do
      call within(error, maxval(abs(sum_of - 1)), 1e-14_dp, "all bins")
   end subroutine test_observables

   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      call make_scene(run // skew // "&output every=1 columns='tilt omega4' /", scene, failure)
      call expect(error, index(failure%message, """omega4"" is not one of: omega1") > 0, &
         failure%message)
   end subroutine test_refused

end module test_scene_endings
