!> What a host calls every step: `drift` (free rotation), `kick` (its own torques), `step` (both,
!> with the plan's effects).
module poinsot_ensemble_step
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_partial, poinsot_e_size
   use poinsot_body_class, only: body_class
   use poinsot_ensemble_block, only: block_state
   use poinsot_ensemble_bodies, only: body_view, column
   use poinsot_ensemble_coupled, only: run_coupled, torque_callback
   use poinsot_ensemble_drive, only: block_job, for_each_block
   use poinsot_ensemble_layout, only: body_momentum, space_momentum, conjugate_momentum, &
      turn_to_body
   use poinsot_ensemble_plan, only: poinsot_plan, compose_classes
   use poinsot_ensemble_rotate, only: rotate_job, check_step
   use poinsot_free_accumulate, only: add_kick, add_kick_compensated
   use poinsot_free_limits, only: reject_speed
   use poinsot_splitting_block_flows, only: block_flows
   use poinsot_splitting_stepper, only: run_steps, apply_preprocessor, apply_postprocessor
   use poinsot_splitting_tableaux, only: splitting
   implicit none(type, external)
   private
   public :: drift_bodies, kick_bodies, step_bodies, check_ready

   !> y += h times the host's torques.
   type, extends(block_job) :: kick_job
      type(column) :: torque(3)
      logical :: space = .false.              !! torques are in the space frame
      logical :: same_frame = .false.         !! and so are the caller's momenta, or both in its
                                              !! body frame
      real(dp) :: h = 0
      real(dp), allocatable :: axes(:, :)
   contains
      procedure :: run => run_kick
   end type kick_job

   !> Steps of a block with the effects of its class.
   type, extends(block_job) :: step_job
      type(block_flows), allocatable :: flows(:)      !! one per class
      type(splitting), allocatable :: schemes(:)      !! one per class: without torque, no kick
      real(dp) :: t = 0, h = 0
      integer(i8) :: first = 0, steps = 0
      logical :: compensated = .false.
   contains
      procedure :: run => run_step
   end type step_job

contains

   !> Free rotation of all bodies over h. Returns POINSOT_E_PARTIAL if some failed; an error
   !> otherwise.
   subroutine drift_bodies(plan, view, h, status, error)
      type(poinsot_plan), intent(in) :: plan          !! ready
      type(body_view), intent(in) :: view
      real(dp), intent(in) :: h                       !! step, either sign
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      type(rotate_job) :: job
      call check_ready(plan, view, error)
      if (.not. raised(error)) call check_step(h, 1, error)
      status = error%code
      if (raised(error)) return
      job%method = plan%method
      job%h = h
      job%compensated = associated(view%carry)
      job%keep_momentum = plan%momentum == space_momentum
      status = for_each_block(view, plan%classes, plan%axes, plan%momentum, plan%threads, job)
   end subroutine drift_bodies

   !> Kick all bodies: y += h torque, in the body or in the space frame as the plan says.
   subroutine kick_bodies(plan, view, h, torque, status, error)
      type(poinsot_plan), intent(in) :: plan
      type(body_view), intent(in) :: view
      real(dp), intent(in) :: h
      type(column), intent(in) :: torque(3)           !! components of the torque, one per body
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      type(kick_job) :: job
      call check_ready(plan, view, error)
      if (.not. raised(error)) call check_step(h, 1, error)
      status = error%code
      if (raised(error)) return
      job%torque = torque
      job%space = plan%space_torque
      job%same_frame = plan%momentum == merge(space_momentum, body_momentum, plan%space_torque)
      job%h = h
      job%axes = plan%axes
      job%keep_attitude = .true.
      status = for_each_block(view, plan%classes, plan%axes, plan%momentum, plan%threads, job)
   end subroutine kick_bodies

   !> Steps number first to first + steps - 1 of length h; step k starts at t + k h. Effects of the
   !> plan act, and the callback's torques, if there is one. Ten steps in one call are ten calls, to
   !> the bit.
   subroutine step_bodies(plan, view, t, h, first, steps, status, error, callback)
      type(poinsot_plan), intent(in), target :: plan
      type(body_view), intent(in) :: view
      real(dp), intent(in) :: t, h
      integer(i8), intent(in) :: first, steps
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      class(torque_callback), intent(inout), optional :: callback
      type(step_job) :: job
      integer :: i

      call check_ready(plan, view, error)
      if (.not. raised(error)) call check_step(h, 1, error)
      if (.not. raised(error)) call check_step(t, 1, error, "time t")
      if (.not. raised(error)) call check_count(first, steps, error)
      status = error%code
      if (raised(error)) return
      if (plan%coupled .or. present(callback)) then
         call run_coupled(plan, view, t, h, first, steps, status, error, callback)
         return
      end if
      call compose_classes(plan, plan%splitting, job%flows, error)
      if (.not. raised(error)) call check_direction(job%flows, h, error)
      status = error%code
      if (raised(error)) return
      allocate (job%schemes(size(job%flows)))
      do i = 1, size(job%flows)
         job%schemes(i) = job%flows(i)%scheme_for(plan%splitting)
      end do
      job%t = t
      job%h = h
      job%first = first
      job%steps = steps
      job%compensated = associated(view%carry)
      job%wants_id = any(job%flows%has_dissipation)
      status = for_each_block(view, plan%classes, plan%axes, plan%momentum, plan%threads, job)
   end subroutine step_bodies

   !> Steps can be counted, and the number of the one after the last.
   pure subroutine check_count(first, steps, error)
      integer(i8), intent(in) :: first, steps
      type(poinsot_error), intent(inout) :: error
      if (steps < 0) then
         call raise(error, poinsot_e_size, "number of steps is negative")
      else if (first > huge(first) - steps) then
         call raise(error, poinsot_e_size, &
            "step numbers first to first + steps leave the range of 64 bits")
      end if
   end subroutine check_count

   !> A thermostat does not run backwards.
   subroutine check_direction(flows, h, error)
      type(block_flows), intent(in) :: flows(:)
      real(dp), intent(in) :: h
      type(poinsot_error), intent(inout) :: error
      integer :: i, j
      if (h >= 0) return
      do i = 1, size(flows)
         if (.not. allocated(flows(i)%dissipative)) cycle
         do j = 1, size(flows(i)%dissipative)
            if (flows(i)%dissipative(j)%it%only_forward()) then
               call raise(error, poinsot_e_domain, &
                  "effect '"//trim(flows(i)%dissipative(j)%it%name)// &
                          "' is defined for steps h > 0 only")
            end if
         end do
      end do
   end subroutine check_direction

   !> The plan must be ready, the view complete for its momentum variable.
   subroutine check_ready(plan, view, error)
      type(poinsot_plan), intent(in) :: plan
      type(body_view), intent(in) :: view
      type(poinsot_error), intent(inout) :: error
      if (.not. plan%ready) then
         call raise(error, poinsot_e_domain, "the plan is not ready: call plan_ready first")
      else if (plan%momentum == conjugate_momentum .and. view%n > 0 .and. &
         .not. associated(view%y(4)%of)) then
         call raise(error, poinsot_e_size, &
            "a conjugate momentum has four components: y_fourth is missing")
      end if
   end subroutine check_ready

   !> A torque whose product with the step would leave the range of numbers: the body fails.
   pure subroutine reject_strong(h, b, torque)
      real(dp), intent(in) :: h
      type(block_state), intent(inout) :: b
      real(dp), intent(inout) :: torque(lanes, 3)
      real(dp) :: strongest
      integer :: l
      strongest = 0.0625_dp*huge(h)/max(1.0_dp, abs(h))
      do l = 1, b%n
         if (maxval(abs(torque(l, :))) <= strongest) cycle
         b%status(l) = poinsot_e_domain
         torque(l, :) = 0
      end do
   end subroutine reject_strong

   subroutine run_kick(self, class, b)
      class(kick_job), intent(inout) :: self
      type(body_class), intent(in) :: class
      type(block_state), intent(inout) :: b
      real(dp) :: dy(lanes, 3)
      integer :: l, j
      dy = 0
      do j = 1, 3
         do l = 1, b%n
            dy(l, j) = self%torque(j)%of(b%at(l))
         end do
      end do
      call b%reject_values(dy)
      call reject_strong(self%h, b, dy)
      if (self%same_frame .and. .not. b%compensated .and. all(class%inverse > 0)) then
         b%adding = .true.
         b%add = self%h*dy
         return
      end if
      call turn_to_body(self%space, self%axes(:, b%class), b%q, dy)
      do j = 1, 3
         dy(:, j) = self%h*dy(:, j)
         if (.not. class%inverse(j) > 0) dy(:, j) = 0
      end do
      if (b%compensated) then
         call add_kick_compensated(dy, b%y, b%carry)
      else
         call add_kick(dy, b%y)
      end if
      call reject_speed(class, b%y, b%status)
   end subroutine run_kick

   subroutine run_step(self, class, b)
      class(step_job), intent(inout) :: self
      type(body_class), intent(in) :: class
      type(block_state), intent(inout) :: b
      associate (f => self%flows(b%class), scheme => self%schemes(b%class), unused => class%moments)
         f%y = b%y
         f%q = b%q
         f%fresh = .false.
         f%status = b%status
         if (f%has_dissipation) f%id = b%id
         f%compensated = self%compensated
         if (self%compensated) f%carry = b%carry
         call apply_preprocessor(scheme, f, self%t, self%h, self%first)
         call run_steps(scheme, f, self%t, self%h, self%first, self%steps)
         call apply_postprocessor(scheme, f, self%t, self%h, self%first + self%steps)
         b%y = f%y
         b%q = f%q
         b%status = f%status
         if (self%compensated) b%carry = f%carry
      end associate
   end subroutine run_step

end module poinsot_ensemble_step
