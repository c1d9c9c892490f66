!> Drag and thermostat alone, for hosts that run the other flows of a step themselves.
module poinsot_ensemble_dissipate
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain
   use poinsot_ensemble_bodies, only: body_view
   use poinsot_ensemble_check, only: check_ready, check_purpose, to_dissipate
   use poinsot_ensemble_compose, only: attach_plan
   use poinsot_ensemble_drive, only: block_job, for_each_block
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_ensemble_rotate, only: check_step
   use poinsot_splitting_block_flows, only: block_flows
   implicit none(type, external)
   private
   public :: dissipate_bodies

   !> Drag and noise within one step.
   type, extends(block_job) :: dissipation_job
      real(dp) :: h = 0
      integer(i8) :: step = 0
   contains
      procedure :: run => run_dissipation
   end type dissipation_job

contains

   !> The flow of the plan's drag and thermostats over h, with the random numbers of step number
   !> `step`: bitwise what stands in the middle of that step of `baoab`. It acts on I omega = y - s.
   !> Bodies on which no such effect acts are unchanged.
   subroutine dissipate_bodies(plan, view, h, step, status, error)
      type(poinsot_plan), intent(in), target :: plan  !! ready
      type(body_view), intent(in) :: view
      real(dp), intent(in) :: h                       !! not negative
      integer(i8), intent(in) :: step
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      type(dissipation_job) :: job
      call check_ready(plan, view, error)
      if (.not. raised(error)) call check_purpose(plan, view, to_dissipate, error)
      if (.not. raised(error)) call check_step(h, 1, error)
      if (.not. raised(error)) then
         if (h < 0) call raise(error, poinsot_e_domain, &
            "dissipate: h is negative, but drag and noise cannot run backwards")
      end if
      status = error%code
      if (raised(error)) return
      if (plan%has_dissipation) then
         job%plan => plan
         job%h = h
         job%step = step
         job%keep_attitude = .true.
         job%wants_id = .true.
         status = for_each_block(view, plan%threads, job)
      else if (associated(view%status)) then
         view%status(:view%n) = poinsot_ok
      end if
   end subroutine dissipate_bodies

   subroutine run_dissipation(self, b)
      class(dissipation_job), intent(inout) :: self
      type(block_flows), intent(inout) :: b
      call attach_plan(self%plan, b)
      if (b%has_dissipation) then
         call b%dissipate(0.0_dp, self%h, self%step)
      else
         b%stored = .true.
         b%status = poinsot_ok
      end if
   end subroutine run_dissipation

end module poinsot_ensemble_dissipate
