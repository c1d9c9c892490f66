!> Tops and strong fields: fast, sleeping, through the upright, and steps near the stability limit.
module test_hard_tops
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, qp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_step, &
      poinsot_e_convergence, &
      poinsot_e_partial
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, set_option
   use poinsot_ensemble_step, only: step_bodies
   use poinsot_splitting_registry, only: splitting_count, splitting_name
   use test_crowd, only: with_effect
   use test_expectation, only: expect
   use test_free_tools, only: text
   use test_measure, only: attitude_distance, momentum_distance
   use test_oracle_taylor, only: taylor_report, taylor_flow, top_problem
   implicit none(type, external)
   private
   public :: collect_hard_tops

   real(dp), parameter :: lagrange(3) = [0.6_dp, 0.6_dp, 1.0_dp]
   real(dp), parameter :: generic(3) = [0.6_dp, 0.8_dp, 1.0_dp]

contains

   subroutine collect_hard_tops(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("top-fast", test_fast), &
         new_unittest("there-and-back-with-rotors-of-order-2", test_back), &
         new_unittest("top-sleeping-at-its-threshold", test_sleeping), &
         new_unittest("top-through-the-upright", test_upright), &
         new_unittest("field-near-the-stability-limit", test_limit), &
         new_unittest("field-far-too-strong", test_too_strong)]
   end subroutine collect_hard_tops

   !> Steps of one body under an effect.
   subroutine run(method, scheme, moments, effect, settings, h, steps, y, q, status)
      character(*), intent(in) :: method, scheme, effect, settings
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(3), q(4)
      integer, intent(out) :: status
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), target :: yy(3, 1), qq(4, 1)
      integer, target :: each(1)
      integer :: number
      call add_class(plan, moments, number, problem)
      call set_option(plan, "method", method, problem)
      call set_option(plan, "splitting", scheme, problem)
      call with_effect(plan, effect, settings)
      call make_ready(plan, problem)
      yy(:, 1) = y
      qq(:, 1) = q
      call view_rows(yy, qq, view)
      view%status => each
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, int(steps, i8), status, problem)
      y = yy(:, 1)
      q = qq(:, 1)
      if (status == poinsot_e_partial) status = each(1)
      if (raised(problem)) status = problem%code
   end subroutine run

   !> Energy of a Lagrange top of unit weight at unit distance; L_z.
   pure function kept(y, q)
      real(dp), intent(in) :: y(3), q(4)
      real(dp) :: kept(2), gamma(3)
      gamma = [2*(q(2)*q(4) - q(1)*q(3)), 2*(q(3)*q(4) + q(1)*q(2)), &
         q(1)**2 - q(2)**2 - q(3)**2 + q(4)**2]
      kept = [sum(y*y/lagrange)/2 + gamma(3), dot_product(y, gamma)]
   end function kept

   !> Spin 1e4 times the precession: y3 and L_z stay, energy within what the scheme loses, at h
   !> omega3 = .5, 5 and 50 (exact rotor: the step must only resolve the slow motion). And at .1
   !> against the Taylor series.
   subroutine test_fast(error)
      type(error_type), allocatable, intent(out) :: error
      character(8), parameter :: schemes(4) = [character(8) :: "strang", "srkn4", "srkn6", &
         "omelyan4"]
      real(dp), parameter :: q0(4) = [0.8_dp, 0.6_dp, 0.0_dp, 0.0_dp], spin = 1e4_dp
      type(taylor_report) :: report
      real(qp) :: yt(3), qt(4)
      real(dp) :: y(3), q(4), before(2), h, gap, may
      integer :: i, k, status
      do i = 1, size(schemes)
         do k = 0, 3
            h = 0.5_dp*10.0_dp**(k - 1)/spin
            y = [0.1_dp, 0.0_dp, spin]
            q = q0
            before = kept(y, q)
            call run("exact", schemes(i), lagrange, "gravity", "centre = 0, 0, 1; weight = 1", h, &
               400, y, q, status)
            call expect(error, status, poinsot_ok, "fast top by "//schemes(i))
            gap = maxval(abs(kept(y, q) - before)/[before(1), spin])
            call expect(error, abs(y(3)/spin - 1) < 1e-13_dp .and. gap < 2e-11_dp, &
               "fast top by "//trim(schemes(i))// &
               " loses energy or momentum: "//text(gap)//", "//text(abs(y(3)/spin - 1)))
         end do
      end do
      yt = [0.1_dp, 0.0_dp, spin]
      qt = q0
      y = real(yt, dp)
      q = q0
      h = 0.1_dp/spin
      call run("exact", "srkn6", lagrange, "gravity", "centre = 0, 0, 1; weight = 1", h, 200, y, &
         q, status)
      call taylor_flow(top_problem(lagrange, [0.0_dp, 0.0_dp, 1.0_dp], [0.0_dp, 0.0_dp, 1.0_dp]), &
         real(h, qp)*200, yt, qt, report)
      gap = momentum_distance(real(y, qp), yt) + attitude_distance(real(q, qp), qt)
      may = 1e-16_dp*200*h*spin*4 ! roundings of the angle
      call expect(error, gap < max(may, 4e-14_dp), "fast top is "//text(gap)//" off")
   end subroutine test_fast

   !> 250 steps there and 250 back with a rotor of order 2: as with an exact one, but for a
   !> processed scheme, whose processor leaves out more where the rotor is not exact.
   subroutine test_back(error)
      type(error_type), allocatable, intent(out) :: error
      character(18), parameter :: rotors(5) = [character(18) :: "dmv2", "midpoint", &
         "three-rotations", "symmetric-rotation", "rattle"]
      character(16), parameter :: schemes(3) = [character(16) :: "takahashi-imada", "strang", &
         "srkn6"]
      real(dp), parameter :: may(3) = [4e-6_dp, 2e-13_dp, 2e-13_dp], y0(3) = [1.2_dp, 0.5_dp, &
         -0.3_dp], q0(4) = [0.5_dp, -0.1_dp, 0.7_dp, 0.5_dp]
      real(dp) :: y(3), q(4), gap
      integer :: i, k, there, back
      do k = 1, size(schemes)
         do i = 1, size(rotors)
            y = y0
            q = q0
            call run(trim(rotors(i)), trim(schemes(k)), generic, "gravity", &
               "centre = 0, 0, 1; weight = 1", 0.02_dp, 250, y, q, there)
            call run(trim(rotors(i)), trim(schemes(k)), generic, "gravity", &
               "centre = 0, 0, 1; weight = 1", -0.02_dp, 250, y, q, back)
            gap = max(norm2(y - y0), norm2(q - q0))
            call expect(error, there == poinsot_ok .and. back == poinsot_ok .and. gap <= may(k), &
               "there and back by "//trim(schemes(k))//" with "//trim(rotors(i))//": "//text(gap))
         end do
      end do
   end subroutine test_back

   !> I3^2 w3^2 = 4 I1 m g l: upright it stays, to the bit; tilted by 1e-8 it leaves slower than any
   !> exponential; ten per cent faster it stays near, ten per cent slower it falls, as the series
   !> says.
   subroutine test_sleeping(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: pace(3) = [1.0_dp, 1.1_dp, 0.9_dp]
      type(taylor_report) :: report
      real(qp) :: yt(3), qt(4)
      real(dp) :: y(3), q(4), spin, tilt, gap
      integer :: i, k, status
      do k = 1, 3
         spin = sqrt(4*lagrange(1))*pace(k)
         do i = 1, splitting_count()
            y = [0.0_dp, 0.0_dp, spin]
            q = [1, 0, 0, 0]
            call run("exact", splitting_name(i), lagrange, "gravity", &
               "centre = 0, 0, 1; weight = 1", 0.05_dp, 200, y, q, status)
            call expect(error, status == poinsot_ok .and. all(abs(y(1:2)) <= 0) &
               .and. all(abs(q(2:3)) <= 0), &
               "a sleeping top wakes up: "//splitting_name(i))
            y = [0.0_dp, 0.0_dp, spin]
            q = [1.0_dp, 5e-9_dp, 0.0_dp, 0.0_dp]
            qt = q/sqrt(sum(real(q, qp)**2))
            yt = y
            call run("exact", splitting_name(i), lagrange, "gravity", &
               "centre = 0, 0, 1; weight = 1", 0.05_dp, 200, y, q, status)
            tilt = 2*norm2(q(2:3))
            call expect(error, tilt < merge(3e-7_dp, 1e-5_dp, k < 3), &
               "tilt "//text(tilt)//" by "// &
               splitting_name(i))
            if (splitting_name(i) /= "srkn6") cycle
            call taylor_flow(top_problem(lagrange, [0.0_dp, 0.0_dp, 1.0_dp], [0.0_dp, 0.0_dp, &
               1.0_dp]), real(0.05_dp, qp)*200, &
               yt, qt, report)
            gap = real(norm2(q(2:3) - qt(2:3)), dp)/tilt
            call expect(error, gap < 1e-5_dp, "the tilt of a top near its threshold is "// &
               text(gap)//" off")
         end do
      end do
   end subroutine test_sleeping

   !> L_z = y3: the top swings exactly through the upright, where angles are singular and a
   !> quaternion is not.
   subroutine test_upright(error)
      type(error_type), allocatable, intent(out) :: error
      type(taylor_report) :: report
      real(qp) :: yt(3), qt(4)
      real(dp) :: y(3), q(4), gap
      integer :: k, status
      do k = 1, 4
         y = [1.2_dp, 0.0_dp, 0.3_dp*(k - 1)]
         q = [1, 0, 0, 0]
         yt = y
         qt = q
         if (k == 4) then ! hanging exactly down, spinning, pushed
            q = [0, 1, 0, 0]
            qt = q
         end if
         call run("exact", "omelyan8", lagrange, "gravity", "centre = 0, 0, 1; weight = 1", &
            0.01_dp, 1000, y, q, status)
         call taylor_flow(top_problem(lagrange, [0.0_dp, 0.0_dp, 1.0_dp], [0.0_dp, 0.0_dp, &
            1.0_dp]), 0.01_dp*1000.0_qp, yt, qt, &
            report)
         gap = momentum_distance(real(y, qp), yt) + attitude_distance(real(q, qp), qt)
         call expect(error, status == poinsot_ok .and. gap < 2e-11_dp, &
            "a top through the upright is "//text(gap)//" off")
      end do
   end subroutine test_upright

   !> A dipole librating in a field, step h omega0 from .5 to 4: below the limit of the scheme (2
   !> for strang) the energy stays bounded, above it the answer is finite all the same.
   subroutine test_limit(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: paces(5) = [0.5_dp, 1.0_dp, 1.9_dp, 2.1_dp, 4.0_dp]
      real(dp) :: y(3), q(4), energy(2), gap
      integer :: i, k, status
      do i = 1, splitting_count()
         do k = 1, 5
            y = [0.05_dp, 0.0_dp, 0.0_dp]
            q = [1, 0, 0, 0]
            energy(1) = sum(y*y/lagrange)/2 - 1
            call run("exact", splitting_name(i), lagrange, "field", &
               "dipole = 0, 0, 1; strength = 0, 0, 1", &
               paces(k)*sqrt(lagrange(1)), 2000, y, q, status)
            call expect(error, status, poinsot_ok, "a strong field fails by "//splitting_name(i))
            energy(2) = sum(y*y/lagrange)/2 - (q(1)**2 - q(2)**2 - q(3)**2 + q(4)**2)
            gap = abs(energy(2) - energy(1))
            call expect(error, all(ieee_is_finite(y)) .and. abs(norm2(q) - 1) < 1e-12_dp, &
               "not finite by "//splitting_name(i))
            if (.not. (k == 1 .or. (k == 3 .and. i == 1))) cycle
            call expect(error, gap < 0.01_dp, splitting_name(i)// &
               ": energy is "//text(gap)//" off at h omega0 = "//text(paces(k)))
         end do
      end do
   end subroutine test_limit

   !> A field so strong that a kick leaves the range of numbers, or makes a step too long for the
   !> method: a status, and the state of before.
   subroutine test_too_strong(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: powers(4) = [3.0_dp, 80.0_dp, 200.0_dp, 290.0_dp], q0(4) = [0.5_dp, &
         0.5_dp, 0.5_dp, -0.5_dp]
      character(14), parameter :: methods(3) = [character(14) :: "exact", "dmv8", "rattle"]
      character(60) :: settings
      real(dp) :: y(3), q(4)
      integer :: i, k, m, status
      do i = 1, splitting_count()
         ! G is of the square of the torque
         if (any(splitting_name(i) == [character(15) :: "chin4", "omelyan4", "omelyan6", &
            "omelyan8", &
            "takahashi-imada"])) cycle
         do k = 1, 4
            do m = 1, 3
               y = [0.05_dp, 0.0_dp, 0.0_dp]
               q = q0
               write (settings, "(a, es12.4e3)") "dipole = 0, 0, 1; strength = 0, 0, ", &
                  10.0_dp**powers(k)
               call run(methods(m), splitting_name(i), lagrange, "field", settings, 0.1_dp, 3, y, &
                  q, status)
               if (status == poinsot_ok) then
                  call expect(error, all(ieee_is_finite(y)) .and. abs(norm2(q) - 1) < 1e-12_dp &
                     .and. powers(k) < 70, &
                     "no status and no number, "//splitting_name(i)//" "//settings)
               else
                  call expect(error, any(status == [poinsot_e_domain, poinsot_e_step, &
                     poinsot_e_convergence]) &
                     .and. all(abs(q - q0) <= 0) &
                     .and. abs(y(1) - 0.05_dp) <= 0, "failed, and moved: "//splitting_name(i)// &
                        " "//settings)
               end if
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine test_too_strong

end module test_hard_tops
