!> What long runs keep, with and without compensated sums: growth of |dH/H| and ||y| - |y0||/|y0|
!> over the steps, and |q|. States are judged in quadruple precision, with the carry that belongs to
!> them.
module test_drift
   use, intrinsic :: iso_fortran_env, only: output_unit
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, qp, i8, lanes
   use poinsot_core_error, only: poinsot_error
   use poinsot_core_status, only: poinsot_ok
   use poinsot_body_class, only: body_class
   use poinsot_free_method, only: free_method, advance
   use test_bodies, only: random_stream, start_stream
   use test_expectation, only: expect
   use test_free_tools, only: prepare, random_block, generic, text
   use test_measure, only: measure_slope
   implicit none(type, external)
   private
   public :: collect_drift, collect_drift_deep

   integer, parameter :: most_blocks = 2

   !> Rotors, and what they had at the start.
   type :: rotors
      type(free_method) :: method
      type(body_class) :: class
      logical :: compensated = .false.
      integer :: blocks = 1
      real(dp) :: y(lanes, 3, most_blocks), q(lanes, 4, most_blocks), carry(lanes, 7, &
         most_blocks) = 0
      real(qp) :: energy(lanes, most_blocks), momentum(lanes, most_blocks)
      integer :: status(lanes, most_blocks) = poinsot_ok
   end type rotors

contains

   !> The short ones.
   subroutine collect_drift(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("growth-exact", test_exact), &
         new_unittest("growth-dmv", test_dmv), &
         new_unittest("growth-others", test_others)]
   end subroutine collect_drift

   !> The long one.
   subroutine collect_drift_deep(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [new_unittest("hundred-million-steps", test_deep)]
   end subroutine collect_drift_deep

   subroutine test_exact(error)
      type(error_type), allocatable, intent(out) :: error
      call judge(error, "exact")
   end subroutine test_exact

   subroutine test_dmv(error)
      type(error_type), allocatable, intent(out) :: error
      call judge(error, "dmv10")
   end subroutine test_dmv

   subroutine test_others(error)
      type(error_type), allocatable, intent(out) :: error
      call judge(error, "rattle")
      if (allocated(error)) return
      call judge(error, "three-rotations")
   end subroutine test_others

   !> 1e5 steps at h|omega| = .1, one block, plain and compensated: size at the end, growth
   !> exponent.
   subroutine judge(error, name)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: name
      integer, parameter :: points = 6
      integer(i8), parameter :: times(points) = [1000_i8, 3000_i8, 10000_i8, 30000_i8, 60000_i8, &
         100000_i8]
      type(rotors) :: r
      real(dp) :: rms(points, 2), norm, slope(2), largest
      integer :: mode, k, j, used
      do mode = 1, 2
         call begin(r, name, 1, mode == 2)
         do k = 1, points
            call run(r, times(k) - merge(times(max(k - 1, 1)), 0_i8, k > 1))
            call defects(r, rms(k, 1), rms(k, 2), norm)
         end do
         call expect(error, all(r%status == poinsot_ok), name//" fails")
         call expect(error, norm < 1.0e-15_dp, name//" loses |q|: "//text(norm))
         largest = merge(1.0e-13_dp, 1.0e-15_dp, mode == 1)
         do j = 1, 2
            if (j == 1 .and. .not. r%method%conserves_energy) cycle
            call measure_slope(real(times, dp), rms(:, j), 1.0e-19_dp, slope(j), used)
            call expect(error, rms(points, j) < largest, &
                       name//merge(", plain,      ", ", compensated,", mode == 1)//merge(" H: ", &
                       "|y|:", j == 1)//text(rms(points, j)))
            call expect(error, slope(j) < merge(0.9_dp, 0.65_dp, mode == 1), &
                       name//merge(", plain,      ", ", compensated,", mode == 1)//merge(" H ", &
                       "|y|", j == 1)// " grows with the power "//text(slope(j)))
         end do
      end do
   end subroutine judge

   !> 1e8 steps of `exact` at h|omega| = .1, 64 rotors, plain and compensated side by side. A
   !> rotor's growth exponent is the slope of the rms change of H over tau steps, tau from 1e5 to
   !> 3e7, taken all along its run: a single |dH/H| is one random walk, whose own exponent scatters
   !> by a tenth.
   subroutine test_deep(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: samples = 4000, rotors_count = most_blocks*lanes
      integer(i8), parameter :: every = 25000
      type(rotors) :: r
      real(dp), allocatable :: path(:, :)
      real(dp) :: rms(2), momentum(2), norm(2), exponents(rotors_count), c(lanes, most_blocks)
      character(12), parameter :: modes(2) = [character(12) :: "plain", "compensated"]
      integer :: mode, k
      allocate (path(rotors_count, samples))
      write (output_unit, '(a)') "  exact, &
         1e8 steps     rms |dH/H|  rms |d|y||/|y|  largest ||q|-1|   "// &
         "growth exponents: least, mean, largest"
      do mode = 1, 2
         call begin(r, "exact", most_blocks, mode == 2)
         do k = 1, samples
            call run(r, every)
            call relative(r, path(:, k), c)
         end do
         call defects(r, rms(mode), momentum(mode), norm(mode))
         call growth(path, exponents)
         write (output_unit, '(2x, a, 6x, 3es15.2, 10x, 3f8.2)') modes(mode), rms(mode), &
                momentum(mode), norm(mode), minval(exponents), sum(exponents)/rotors_count, &
                maxval(exponents)
         call expect(error, all(r%status == poinsot_ok) .and. norm(mode) < 1.0e-15_dp, &
            "|q|: "//text(norm(mode)))
      end do
      call expect(error, rms(2) <= 5.0e-14_dp, "rms |dH/H| "//text(rms(2)))
      call expect(error, momentum(2) <= 5.0e-14_dp, "rms |d|y||/|y| "//text(momentum(2)))
      call expect(error, maxval(exponents) <= 0.6_dp, "growth exponent "//text(maxval(exponents)))
   end subroutine test_deep

   !> Exponent of every rotor: slope of log rms (H(t + tau) - H(t)) over log tau, tau = 4, 8, ...
   !> 1024 samples, each weighted by how many separate stretches of that length the run has.
   subroutine growth(path, exponents)
      real(dp), intent(in) :: path(:, :)         !! (rotor, sample): dH/H
      real(dp), intent(out) :: exponents(:)
      integer, parameter :: points = 9
      real(dp) :: x(points), z(points), weight(points)
      integer :: l, k, lag, n
      n = size(path, 2)
      do l = 1, size(exponents)
         do k = 1, points
            lag = 2**(k + 1)
            weight(k) = real(n - lag, dp)/lag
            x(k) = log(real(lag, dp))
            z(k) = 0.5_dp*log(sum((path(l, lag + 1:) - path(l, :n - lag))**2)/(n - lag))
         end do
         x = x - sum(weight*x)/sum(weight)
         exponents(l) = sum(weight*x*z)/sum(weight*x*x)
      end do
   end subroutine growth

   !> Random rotors of the generic body, |omega| = 1 at the start.
   subroutine begin(r, name, blocks, compensated)
      type(rotors), intent(out) :: r
      character(*), intent(in) :: name
      integer, intent(in) :: blocks
      logical, intent(in) :: compensated
      type(random_stream) :: stream
      type(poinsot_error) :: answer
      integer :: b, l
      call prepare(name, generic, r%method, r%class, answer)
      r%blocks = blocks
      r%compensated = compensated
      stream = start_stream(53)
      do b = 1, blocks
         call random_block(stream, r%y(:, :, b), r%q(:, :, b))
         do l = 1, lanes
            r%y(l, :, b) = r%y(l, :, b)/norm2(r%y(l, :, b)/generic)
         end do
         call invariants(r, b, r%energy(:, b), r%momentum(:, b))
      end do
   end subroutine begin

   subroutine run(r, steps)
      type(rotors), intent(inout) :: r
      integer(i8), intent(in) :: steps
      real(dp), parameter :: h = 0.1_dp
      integer(i8) :: n
      integer :: b
      !$omp parallel do private(n) schedule(static, 1)
      do b = 1, r%blocks
         do n = 1, steps
            if (r%compensated) then
               call advance(r%method, r%class, h, r%y(:, :, b), r%q(:, :, b), r%status(:, b), &
                  r%carry(:, :, b))
            else
               call advance(r%method, r%class, h, r%y(:, :, b), r%q(:, :, b), r%status(:, b))
            end if
         end do
      end do
      !$omp end parallel do
   end subroutine run

   !> H and |y| of a block.
   subroutine invariants(r, b, energy, momentum)
      type(rotors), intent(in) :: r
      integer, intent(in) :: b
      real(qp), intent(out) :: energy(lanes), momentum(lanes)
      real(qp) :: y(lanes)
      integer :: j
      energy = 0
      momentum = 0
      do j = 1, 3
         y = real(r%y(:, j, b), qp) + r%carry(:, j, b)
         energy = energy + y*y/(2*real(generic(j), qp))
         momentum = momentum + y*y
      end do
      momentum = sqrt(momentum)
   end subroutine invariants

   !> dH/H and d|y|/|y| of every rotor.
   subroutine relative(r, h, c)
      type(rotors), intent(in) :: r
      real(dp), intent(out) :: h(lanes, *), c(lanes, *)
      real(qp) :: energy(lanes), momentum(lanes)
      integer :: b
      do b = 1, r%blocks
         call invariants(r, b, energy, momentum)
         h(:, b) = real(energy/r%energy(:, b) - 1, dp)
         c(:, b) = real(momentum/r%momentum(:, b) - 1, dp)
      end do
   end subroutine relative

   !> Over all rotors: rms of both, and the largest ||q| - 1|.
   subroutine defects(r, energy, momentum, norm)
      type(rotors), intent(in) :: r
      real(dp), intent(out) :: energy, momentum, norm
      real(dp) :: h(lanes, r%blocks), c(lanes, r%blocks)
      call relative(r, h, c)
      energy = sqrt(sum(h*h)/size(h))
      momentum = sqrt(sum(c*c)/size(c))
      norm = maxval(abs(norm2(r%q(:, :, 1:r%blocks), 2) - 1))
   end subroutine defects

end module test_drift
