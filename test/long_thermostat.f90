!> The thermostat over long times: mean energy of each degree of freedom, the distribution of energy
!> and of each momentum component by chi-square, the time after which a momentum is forgotten.
module test_long_thermostat
   use, intrinsic :: iso_fortran_env, only: output_unit
   use testdrive, only: error_type
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, set_option
   use poinsot_ensemble_step, only: step_bodies
   use test_bodies, only: random_stream, start_stream, random_quaternion
   use test_crowd, only: with_effect
   use test_expectation, only: expect
   use test_free_tools, only: text
   implicit none(type, external)
   private
   public :: test_thermostat, test_thermostat_deep

   integer, parameter :: bins = 20
   real(dp), parameter :: heat = 0.7_dp, friction = 0.5_dp
   !> chi-square of 19 degrees of freedom beyond this: once in 1e6.
   real(dp), parameter :: too_much = 63.7_dp

   !> What a run has counted.
   type :: statistics
      real(dp) :: energy(3) = 0                  !! mean of y^2/I, over kT
      real(dp) :: chi_energy = 0, chi_y(3) = 0   !! chi-square, 19 degrees of freedom
      real(dp) :: memory(3) = 0                  !! correlation of y over one interval, measured
      real(dp) :: count = 0                      !! samples of each axis
      logical :: good = .true.
   end type statistics

contains

   !> n bodies, `samples` states each, an interval of 8 relaxation times of the slowest axis apart.
   subroutine run_hot(moments, field, seed, n, samples, found)
      real(dp), intent(in) :: moments(3)
      logical, intent(in) :: field               !! in a field too
      integer, intent(in) :: seed, n, samples
      type(statistics), intent(out) :: found
      real(dp), parameter :: h = 0.1_dp
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: error
      type(random_stream) :: stream
      real(dp), allocatable, target :: y(:, :), q(:, :)
      real(dp), allocatable :: before(:, :)
      real(dp) :: histogram(bins, 4)
      character(12) :: word
      integer :: i, j, k, number, status, freedom
      integer(i8) :: apart, near, step
      write (word, "(i0)") seed
      call add_class(plan, moments, number, error)
      call set_option(plan, "splitting", "strang", error)
      call set_option(plan, "seed", trim(word), error)
      call with_effect(plan, "langevin", "friction = 0.5; temperature = 0.7")
      if (field) call with_effect(plan, "field", "dipole = 0, 0.6, 0.8; strength = 0, 0, 1")
      call make_ready(plan, error)
      allocate (y(3, n), q(4, n), before(3, n))
      stream = start_stream(seed)
      y = 0
      do i = 1, n
         q(:, i) = random_quaternion(stream)
      end do
      call view_rows(y, q, view)
      freedom = count(moments > 0)
      apart = nint(8*maxval(moments)/(friction*h), i8)
      near = 5
      histogram = 0
      step = 0
      do k = 0, samples
         call step_bodies(plan, view, 0.0_dp, h, step, apart, status, error)
         step = step + apart
         before = y
         call step_bodies(plan, view, 0.0_dp, h, step, near, status, error)
         step = step + near
         found%good = status == poinsot_ok .and. .not. raised(error)
         if (.not. found%good) return
         if (k == 0) cycle ! from rest: not yet warm
         do i = 1, n
            call count_one(moments, freedom, y(:, i), histogram)
            do j = 1, 3
               if (.not. moments(j) > 0) cycle
               found%energy(j) = found%energy(j) + y(j, i)**2/(moments(j)*heat)
               found%memory(j) = found%memory(j) + y(j, i)*before(j, i)/(moments(j)*heat)
            end do
         end do
      end do
      found%count = real(n, dp)*samples
      found%energy = found%energy/found%count
      found%memory = found%memory/found%count
      do j = 1, 3
         if (moments(j) > 0) found%chi_y(j) = chi_square(histogram(:, j))
      end do
      found%chi_energy = chi_square(histogram(:, 4))
   end subroutine run_hot

   !> Of counts that should be equal.
   pure real(dp) function chi_square(counts)
      real(dp), intent(in) :: counts(bins)
      chi_square = sum((counts - sum(counts)/bins)**2)*bins/sum(counts)
   end function chi_square

   !> Into bins that are equally likely: each momentum component by the normal law, the energy by
   !> its own, chi-square of 3 or 2 degrees of freedom.
   subroutine count_one(moments, freedom, y, histogram)
      real(dp), intent(in) :: moments(3), y(3)
      integer, intent(in) :: freedom
      real(dp), intent(inout) :: histogram(bins, 4)
      real(dp), parameter :: pi = 3.14159265358979324_dp
      real(dp) :: energy, p
      integer :: j, b
      energy = 0
      do j = 1, 3
         if (.not. moments(j) > 0) cycle
         p = 0.5_dp*erfc(-y(j)/sqrt(2*moments(j)*heat))
         b = min(bins, 1 + int(bins*p))
         histogram(b, j) = histogram(b, j) + 1
         energy = energy + y(j)**2/(2*moments(j)*heat)
      end do
      p = 1 - exp(-energy)
      if (freedom == 3) p = erf(sqrt(energy)) - 2*sqrt(energy/pi)*exp(-energy)
      b = min(bins, 1 + int(bins*p))
      histogram(b, 4) = histogram(b, 4) + 1
   end subroutine count_one

   !> All kinds of body, several seeds.
   subroutine judge(error, n, samples, seeds, shown)
      type(error_type), allocatable, intent(inout) :: error
      integer, intent(in) :: n, samples, seeds
      logical, intent(in) :: shown
      real(dp), parameter :: moments(3, 5) = reshape([0.6_dp, 1.0_dp, 0.8_dp, 0.9_dp, 0.9_dp, &
         0.9_dp, 1.0_dp, 0.05_dp, 1.0_dp, 0.3_dp, 1.0_dp, 0.7_dp, 1.0_dp, 0.0_dp, 1.0_dp], [3, 5])
      character(11), parameter :: kinds(5) = [character(11) :: "asymmetric", "sphere", &
         "near-linear", "flat, field", "linear"]
      type(statistics) :: found
      real(dp) :: off, chi
      integer :: i, k
      do i = 1, size(kinds)
         do k = 1, seeds
            call run_hot(moments(:, i), i == 4, 100*k + i, n, samples, found)
            call expect(error, found%good, "a thermostat fails: "//kinds(i))
            ! mean of the square of a normal number: off by sqrt(2/count)
            off = maxval(abs(found%energy - 1)*sqrt(found%count/2), mask=moments(:, i) > 0)
            chi = max(found%chi_energy, maxval(found%chi_y))
            if (shown) write (output_unit, "(2x, a, ' seed ', i0, ': <y^2/I>/kT', 3f9.5, ' (', &
               &f3.1, ' standard errors), chi-square of 19: energy ', f5.1, ', momenta', 3f6.1, &
               &'; kept over .5:', 3f7.4)") kinds(i), k, found%energy, off, found%chi_energy, &
               found%chi_y, found%memory
            call expect(error, off < 5, kinds(i)//": kT is "//text(off)//" standard errors off")
            call expect(error, chi < too_much, kinds(i)//": chi-square "//text(chi))
            if (i == 2) call check_memory(error, found)
            if (i == 5) call expect(error, .not. abs(found%energy(2)) > 0, &
               "heat about an axis without inertia")
         end do
      end do
   end subroutine judge

   !> A sphere's momentum is forgotten like exp(-friction t/I): over .5 of time, in the frame of the
   !> body, where that of a sphere does not turn.
   subroutine check_memory(error, found)
      type(error_type), allocatable, intent(inout) :: error
      type(statistics), intent(in) :: found
      real(dp) :: want, off
      want = exp(-friction*0.5_dp/0.9_dp)
      off = maxval(abs(found%memory - want))*sqrt(found%count/(1 + want**2))
      call expect(error, off < 5, "correlation "//text(found%memory(1))//" instead of "//text(want))
   end subroutine check_memory

   subroutine test_thermostat(error)
      type(error_type), allocatable, intent(out) :: error
      call judge(error, 256, 40, 1, .false.)
   end subroutine test_thermostat

   subroutine test_thermostat_deep(error)
      type(error_type), allocatable, intent(out) :: error
      call judge(error, 2048, 500, 4, .true.)
   end subroutine test_thermostat_deep

end module test_long_thermostat
