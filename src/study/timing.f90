!> Time of a step, measured on a machine shared with other programs: short runs of many candidates
!> in turn, so that disturbances affect all; median, minimum and spread of the repetitions.
module poinsot_study_timing
   use poinsot_core_kinds, only: dp, i8
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_study_clock, only: processor_seconds
   use poinsot_study_members, only: member_set
   use poinsot_study_trial, only: integrate
   implicit none(type, external)
   private
   public :: time_steps

contains

   !> ns per body-step of runs that take about `seconds`, on one thread; 0 if a body failed. Runs
   !> begin anew after `most` steps: no state is timed that the errors were not measured on.
   subroutine time_steps(plan, members, h, guess, seconds, most, compensated, ns)
      type(poinsot_plan), intent(in) :: plan
      type(member_set), intent(in) :: members   !! the ensemble
      real(dp), intent(in) :: h
      real(dp), intent(in) :: guess             !! what a body-step may take, ns
      real(dp), intent(in) :: seconds
      integer(i8), intent(in) :: most           !! steps of one run
      logical, intent(in) :: compensated
      real(dp), intent(out) :: ns
      real(dp), allocatable :: y(:, :), q(:, :), carry(:, :)
      real(dp) :: begun, spent, wanted
      integer(i8) :: steps, done
      logical :: good
      allocate (y(3, members%n), q(4, members%n))
      if (compensated) allocate (carry(7, members%n))
      wanted = min(seconds*1e9_dp/(max(guess, 0.1_dp)*members%n), 1e9_dp)
      steps = max(1_i8, min(most, nint(wanted, i8)))
      done = 0
      spent = 0
      do while (done == 0 .or. real(done, dp) < 0.7_dp*wanted)
         y = members%y
         q = members%q
         if (compensated) carry = 0
         begun = processor_seconds()
         call integrate(plan, members, h, 0_i8, steps, y, q, carry, good)
         spent = spent + processor_seconds() - begun
         done = done + steps
         if (.not. good) exit
      end do
      ns = 1e9_dp*spent/(real(done, dp)*members%n)
      if (.not. good) ns = 0
   end subroutine time_steps

end module poinsot_study_timing
