!> A trial of one candidate: a scene's plan with a method and a splitting selected by the study, run
!> over the members with one step size.
module poinsot_study_trial
   use, intrinsic :: iso_c_binding, only: c_int
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_observe, only: body_energies
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_ensemble_step, only: step_bodies
   use poinsot_scene_engine, only: engine, start_engine
   use poinsot_scene_settings, only: scene_settings
   use poinsot_study_clock, only: processor_seconds
   use poinsot_study_members, only: member_set
   use poinsot_taylor_settings, only: choose_orders
   implicit none(type, external)
   private
   public :: trial_run, make_plan, set_tolerance, run_trial, integrate, member_energies, most_checks

   integer, parameter :: most_checks = 16 !! looks at the energy between start and end

   !> What a run leaves.
   type :: trial_run
      logical :: good = .false.              !! every body came through
      real(dp), allocatable :: y(:, :)       !! (3, n) at the end
      real(dp), allocatable :: q(:, :)       !! (4, n)
      real(dp), allocatable :: energy(:, :) !! (n, 0:checks), of a body, or of all that see each
         !! other
      real(dp), allocatable :: kinetic(:)    !! (n), at the start
      real(dp) :: seconds = 0                !! of the processor, energies included
   end type trial_run

contains

   !> The scene's plan with another method and splitting, on one thread. Error: what the plan
   !> refuses.
   subroutine make_plan(scene, method, splitting, plan, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: method, splitting
      type(poinsot_plan), intent(out) :: plan
      type(poinsot_error), intent(inout) :: error
      type(scene_settings) :: changed
      type(engine) :: made
      changed = scene
      changed%method = method
      changed%splitting = splitting
      changed%threads = 1
      call start_engine(changed, made, error)
      if (.not. raised(error)) plan = made%plan
   end subroutine make_plan

   !> Another tolerance of `taylor` for a plan that is ready: nothing else depends on it.
   pure subroutine set_tolerance(plan, tolerance)
      type(poinsot_plan), intent(inout) :: plan
      real(dp), intent(in) :: tolerance        !! 1e-15 to 1e-2
      plan%tolerance = tolerance
      plan%orders = choose_orders(tolerance)
   end subroutine set_tolerance

   !> Run all members from 0 to t_end in `steps` equal steps, with energies at up to `checks` times
   !> at equal distances.
   subroutine run_trial(plan, members, t_end, steps, checks, compensated, run)
      type(poinsot_plan), intent(in) :: plan
      type(member_set), intent(in) :: members
      real(dp), intent(in) :: t_end
      integer(i8), intent(in) :: steps
      integer, intent(in) :: checks
      logical, intent(in) :: compensated        !! with compensated sums, as `poinsot run`
      type(trial_run), intent(out) :: run
      real(dp), allocatable :: carry(:, :)
      real(dp) :: begun
      integer :: k, looks
      integer(i8) :: done, next
      looks = common_divisor(checks, steps)
      run%y = members%y
      run%q = members%q
      allocate (run%energy(members%n, 0:looks), run%kinetic(members%n))
      if (compensated) then
         allocate (carry(7, members%n))
         carry = 0
      end if
      begun = processor_seconds()
      call member_energies(plan, members, 0.0_dp, run%y, run%q, run%energy(:, 0), run%kinetic)
      done = 0
      do k = 1, looks
         next = k*steps/looks
         call integrate(plan, members, t_end/real(steps, dp), done, next - done, run%y, run%q, &
            carry, &
            run%good)
         if (.not. run%good) exit
         done = next
         call member_energies(plan, members, t_end*real(done, dp)/real(steps, dp), run%y, run%q, &
                              run%energy(:, k))
      end do
      run%seconds = processor_seconds() - begun
   end subroutine run_trial

   !> Equidistant output times at ends of steps.
   pure integer function common_divisor(checks, steps)
      integer, intent(in) :: checks
      integer(i8), intent(in) :: steps
      do common_divisor = checks, 2, -1
         if (mod(checks, common_divisor) == 0 .and. mod(steps, int(common_divisor, i8)) == 0) return
      end do
      common_divisor = 1
   end function common_divisor

   !> Steps number first to first + steps - 1 of all systems. A carry that is not allocated: plain
   !> sums.
   subroutine integrate(plan, members, h, first, steps, y, q, carry, good, start)
      type(poinsot_plan), intent(in) :: plan
      type(member_set), intent(in) :: members
      real(dp), intent(in) :: h
      integer(i8), intent(in) :: first, steps
      real(dp), intent(inout), target :: y(:, :), q(:, :)
      real(dp), intent(inout), allocatable, target :: carry(:, :)
      logical, intent(out) :: good
      real(dp), intent(in), optional :: start    !! the time of step 0; 0 if not there
      type(body_view) :: view
      type(poinsot_error) :: error
      integer(c_int), target :: group(size(members%group))
      real(dp) :: t0
      integer :: from, to, status
      t0 = 0
      if (present(start)) t0 = start
      group = members%group
      good = .true.
      from = 1
      do while (from <= members%n)
         to = members%n
         if (members%together > 1) to = from + members%together - 1
         call view_rows(y(:, from:to), q(:, from:to), view)
         view%body_class => group(from:to)
         if (allocated(carry)) view%carry => carry(:, from:to)
         call step_bodies(plan, view, t0, h, first, steps, status, error)
         good = good .and. status == poinsot_ok .and. .not. raised(error)
         from = to + 1
      end do
   end subroutine integrate

   !> Energies of all bodies; those that see each other get their sum.
   subroutine member_energies(plan, members, t, y, q, energy, kinetic)
      type(poinsot_plan), intent(in) :: plan
      type(member_set), intent(in) :: members
      real(dp), intent(in) :: t
      real(dp), intent(in), target :: y(:, :), q(:, :)
      real(dp), intent(out) :: energy(:)
      real(dp), intent(out), optional :: kinetic(:)
      type(body_view) :: view
      type(poinsot_error) :: error
      integer(c_int), target :: group(size(members%group))
      real(dp) :: of_motion(members%n), potential(members%n)
      integer :: from, to, status
      group = members%group
      from = 1
      do while (from <= members%n)
         to = members%n
         if (members%together > 1) to = from + members%together - 1
         call view_rows(y(:, from:to), q(:, from:to), view)
         view%body_class => group(from:to)
         call body_energies(plan, view, t, of_motion(from:to), potential(from:to), status, error)
         energy(from:to) = of_motion(from:to) + potential(from:to)
         if (members%together > 1) energy(from:to) = sum(energy(from:to))
         if (members%together > 1) of_motion(from:to) = sum(of_motion(from:to))
         from = to + 1
      end do
      if (present(kinetic)) kinetic = of_motion
   end subroutine member_energies

end module poinsot_study_trial
