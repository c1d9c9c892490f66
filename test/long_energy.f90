!> Energy over long runs: 32 tops that swing and spin, for a number of periods; how large its error
!> is in the first and in the last tenth, and its trend. That of a symplectic map stays; what the
!> other rotors do is measured.
module test_long_energy
   use, intrinsic :: iso_fortran_env, only: output_unit, compiler_options
   use testdrive, only: error_type
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_observe, only: body_energies
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, set_option
   use poinsot_ensemble_step, only: step_bodies
   use poinsot_splitting_registry, only: is_table, splitting_count, splitting_name
   use test_bodies, only: random_stream, start_stream, uniform
   use test_crowd, only: with_effect
   use test_expectation, only: expect
   use test_free_tools, only: text
   implicit none(type, external)
   private
   public :: test_splittings, test_splittings_deep, test_rotors, &
      test_rotors_deep

   integer, parameter :: n = 32
   real(dp), parameter :: h = 0.5_dp
   integer(i8), parameter :: steps_of_period = 10, sample = 50

   !> Errors of the energy over its scale, 1 + |H|; the largest of all tops.
   type :: energy_record
      real(dp) :: first = 0, last = 0      !! in the first and the last tenth of the run
      real(dp) :: trend = 0                !! of the mean over all tops, per period
      real(dp) :: seen = 0                 !! standard error of the trend, from the tops' scatter
      logical :: good = .true.
   end type energy_record

contains

   !> Run `periods` periods (10 h; a small swing takes 9.7 h to 11.2 h).
   subroutine measure_energy(rotor, scheme, periods, record)
      character(*), intent(in) :: rotor, scheme
      integer(i8), intent(in) :: periods
      type(energy_record), intent(out) :: record
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: error
      real(dp), target :: y(3, n), q(4, n), carry(7, n)
      real(dp), dimension(n) :: kinetic, potential, start, off, sx, sxx
      real(dp) :: x, slope(n)
      integer(i8) :: k, samples
      integer :: number, status
      call add_class(plan, [0.6_dp, 0.8_dp, 1.0_dp], number, error)
      call set_option(plan, "method", rotor, error)
      call set_option(plan, "splitting", scheme, error)
      call set_option(plan, "threads", "1", error)
      call with_effect(plan, "gravity", "centre = 0, 0, 1; weight = 1")
      call make_ready(plan, error)
      call hang(y, q)
      carry = 0
      call view_rows(y, q, view)
      view%carry => carry
      call body_energies(plan, view, 0.0_dp, kinetic, potential, status, error)
      start = kinetic + potential
      samples = periods*steps_of_period/sample
      sx = 0
      sxx = 0
      do k = 1, samples
         call step_bodies(plan, view, 0.0_dp, h, (k - 1)*sample, sample, status, error)
         record%good = status == poinsot_ok .and. .not. raised(error)
         if (.not. record%good) return
         call body_energies(plan, view, 0.0_dp, kinetic, potential, status, error)
         off = (kinetic + potential - start)/(1 + abs(start))
         if (10*k <= samples) record%first = max(record%first, maxval(abs(off)))
         if (10*k > 9*samples) record%last = max(record%last, maxval(abs(off)))
         x = (2*real(k, dp) - samples - 1)/samples
         sx = sx + x*off
         sxx = sxx + x*x
      end do
      slope = 2*sx/(sxx*periods)
      record%trend = sum(slope)/n
      record%seen = sqrt(sum((slope - record%trend)**2)/(n*(n - 1)))
   end subroutine measure_energy

   !> Tops that hang, tilted by up to 1.2 radians, swing and spin.
   subroutine hang(y, q)
      real(dp), intent(out) :: y(3, n), q(4, n)
      type(random_stream) :: stream
      real(dp) :: angle, azimuth
      integer :: i, j
      stream = start_stream(31)
      do i = 1, n
         angle = 1.2_dp*uniform(stream)
         azimuth = 6.3_dp*uniform(stream)
         q(:, i) = [sin(angle/2), cos(angle/2)*cos(azimuth), cos(angle/2)*sin(azimuth), 0.0_dp]
         do j = 1, 3
            y(j, i) = 0.3_dp*(2*uniform(stream) - 1)
         end do
      end do
   end subroutine hang

   subroutine show(rotor, scheme, periods, record)
      character(*), intent(in) :: rotor, scheme
      integer(i8), intent(in) :: periods
      type(energy_record), intent(in) :: record
      character(20) :: names(2)
      names = [character(20) :: rotor, scheme]
      write (output_unit, &
         "(2x, 2a, i10, ' periods: largest error ', es8.1, ' in the first tenth, ', &
         &es8.1, ' in the last; trend ', es9.1, ' +- ', es7.1, ' a period')") names, periods, &
         record%first, record%last, record%trend, record%seen
   end subroutine show

   !> A million periods; fewer with every index checked.
   integer(i8) function many()
      many = merge(20000_i8, 1000000_i8, index(compiler_options(), "-fcheck") > 0)
   end function many

   !> Every splitting with the exact rotor: a symplectic map.
   subroutine judge_splittings(error, periods, shown)
      type(error_type), allocatable, intent(inout) :: error
      integer(i8), intent(in) :: periods
      logical, intent(in) :: shown
      type(energy_record) :: record
      integer :: i
      do i = 1, splitting_count()
         if (.not. is_table(i)) cycle
         call measure_energy("exact", splitting_name(i), periods, record)
         if (shown) call show("exact", splitting_name(i), periods, record)
         call check_bounded(error, splitting_name(i), record, periods)
         if (allocated(error)) return
      end do
   end subroutine judge_splittings

   !> The last tenth is no worse than the first, and what trend there is is a tenth of the error.
   subroutine check_bounded(error, name, record, periods)
      type(error_type), allocatable, intent(inout) :: error
      character(*), intent(in) :: name
      type(energy_record), intent(in) :: record
      integer(i8), intent(in) :: periods
      call expect(error, record%good, name//" fails on a long run")
      call expect(error, record%last < 1.5_dp*record%first + 1e-13_dp, name// &
         ": the error of the energy grows from "//text(record%first)//" to "//text(record%last))
      call expect(error, abs(record%trend)*periods < 0.1_dp*record%first + 1e-13_dp, &
         name//": energy drifts by "//text(record%trend)//" a period")
   end subroutine check_bounded

   !> Every kind of rotor, kicked by Strang's scheme. Symplectic are those whose free map is.
   subroutine judge_rotors(error, periods, shown)
      type(error_type), allocatable, intent(inout) :: error
      integer(i8), intent(in) :: periods
      logical, intent(in) :: shown
      character(20), parameter :: rotors(9) = [character(20) :: "dmv2", "rattle", &
         "three-rotations", "symmetric-rotation", "jacobi", "dmv4", "dmv6", "dmv10", "midpoint"]
      type(energy_record) :: record
      integer :: i
      do i = 1, size(rotors)
         call measure_energy(trim(rotors(i)), "strang", periods, record)
         if (shown) call show(trim(rotors(i)), "strang", periods, record)
         if (i <= 5) then
            call check_bounded(error, trim(rotors(i)), record, periods)
         else
            call expect(error, record%good .and. record%last < 0.1_dp, trim(rotors(i))// &
               ": the energy is "//text(record%last)//" off")
         end if
         if (allocated(error)) return
      end do
   end subroutine judge_rotors

   subroutine test_splittings(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_splittings(error, 500_i8, .false.)
   end subroutine test_splittings

   subroutine test_splittings_deep(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_splittings(error, many(), .true.)
   end subroutine test_splittings_deep

   subroutine test_rotors(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_rotors(error, 500_i8, .false.)
   end subroutine test_rotors

   subroutine test_rotors_deep(error)
      type(error_type), allocatable, intent(out) :: error
      call judge_rotors(error, many(), .true.)
   end subroutine test_rotors_deep

end module test_long_energy
