!> The procedures that a host calls every step: `drift` (free rotation), `kick` (its own torques),
!> `step` (both, with the plan's effects).
module poinsot_ensemble_step
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_partial, poinsot_e_size
   use poinsot_effect_effect, only: flow_effect
   use poinsot_ensemble_block, only: clock, add_momentum, reject_torques
   use poinsot_ensemble_bodies, only: body_view, column, view_from
   use poinsot_ensemble_check, only: check_ready, check_purpose, to_drift, to_kick, to_step
   use poinsot_ensemble_coupled, only: run_coupled, torque_callback
   use poinsot_ensemble_direct, only: adds_direct, is_free, kick_direct, momentum_columns, &
      rotate_direct, takes_direct
   use poinsot_ensemble_drive, only: block_job, for_each_block
   use poinsot_ensemble_layout, only: space_momentum, turn_to_body
   use poinsot_ensemble_plain, only: open_plain_torques, open_plain_view, plain_arrays, &
      plain_torques
   use poinsot_ensemble_compose, only: attach_plan, scheme_of
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_ensemble_rotate, only: check_step
   use poinsot_ensemble_taylor, only: run_taylor
   use poinsot_free_accumulate, only: add_kick, add_kick_compensated
   use poinsot_splitting_block_flows, only: block_flows
   use poinsot_splitting_stepper, only: glance, run_steps, apply_preprocessor, apply_postprocessor
   use poinsot_splitting_tableaux, only: splitting
   use poinsot_taylor_settings, only: taylor_time
   implicit none(type, external)
   private
   public :: drift_bodies, kick_bodies, step_bodies, step_ns

   !> Free rotation over h, with rotors.
   type, extends(block_job) :: drift_job
      real(dp) :: h = 0
   contains
      procedure :: run => run_drift
   end type drift_job

   !> y += h times the host's torques.
   type, extends(block_job) :: kick_job
      type(body_view) :: view
      type(column) :: torque(3)
      real(dp) :: h = 0
      logical :: same_frame = .false.         !! torques and the caller's momenta are both in the
                                              !! space frame, or both in its body frame
   contains
      procedure :: run => run_kick
   end type kick_job

   !> Steps of a block with the effects of its class.
   type, extends(block_job) :: step_job
      real(dp) :: t = 0, h = 0
      integer(i8) :: first = 0, steps = 0
   contains
      procedure :: run => run_step
   end type step_job

contains

   !> Free rotation of all bodies over h. Returns POINSOT_E_PARTIAL if some failed; an error
   !> otherwise.
   subroutine drift_bodies(plan, view, h, status, error)
      type(poinsot_plan), intent(in), target :: plan  !! ready
      type(body_view), intent(in) :: view
      real(dp), intent(in) :: h                       !! step, either sign
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      type(drift_job) :: job
      integer :: left
      call check_ready(plan, view, error)
      if (.not. raised(error)) call check_purpose(plan, view, to_drift, error)
      if (.not. raised(error)) call check_step(h, 1, error)
      status = error%code
      if (raised(error)) return
      call rotate_plain(plan, view, h, 1, plan%momentum == space_momentum, status, left)
      if (left == 0) return
      job%plan => plan
      job%h = h
      job%keep_momentum = plan%momentum == space_momentum
      job%ns = plan%method%ns
      status = for_each_left(view, left, plan%threads, job, status)
   end subroutine drift_bodies

   !> Free steps by the short path, if plan and view allow it.
   subroutine rotate_plain(plan, view, h, steps, keep, status, left)
      type(poinsot_plan), intent(in) :: plan
      type(body_view), intent(in) :: view
      real(dp), intent(in) :: h
      integer, intent(in) :: steps
      logical, intent(in) :: keep                     !! the momentum variable is left as it is
      integer, intent(inout) :: status
      integer, intent(out) :: left                    !! the first body that is for others; 0: none
      type(plain_arrays) :: a
      logical :: failed, plain
      left = 1
      plain = takes_direct(plan, view%n, associated(view%moments(1)%of))
      if (plain) call open_plain_view(view, momentum_columns(plan), a, plain)
      if (.not. plain) return
      call rotate_direct(plan%classes(1)%it, plan%method, plan%momentum, h, steps, keep, a, &
                         failed, left)
      status = merge(poinsot_e_partial, poinsot_ok, failed)
   end subroutine rotate_plain

   !> A job on the bodies from `left` on; those before it have been done.
   integer function for_each_left(view, left, threads, job, before) result(status)
      type(body_view), intent(in) :: view
      integer, intent(in) :: left, threads
      class(block_job), intent(inout) :: job
      integer, intent(in) :: before                   !! status of those
      if (left == 1) then
         status = for_each_block(view, threads, job)
      else
         status = for_each_block(view_from(view, left), threads, job)
         if (before /= poinsot_ok) status = before
      end if
   end function for_each_left

   !> Kick all bodies: y += h torque, in the body or in the space frame as the plan says.
   subroutine kick_bodies(plan, view, h, torque, status, error)
      type(poinsot_plan), intent(in), target :: plan
      type(body_view), intent(in) :: view
      real(dp), intent(in) :: h
      type(column), intent(in) :: torque(3)           !! components of the torque, one per body
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      type(kick_job) :: job
      integer :: left, j
      call check_ready(plan, view, error)
      if (.not. raised(error)) call check_purpose(plan, view, to_kick, error)
      if (.not. raised(error)) call check_step(h, 1, error)
      status = error%code
      if (raised(error)) return
      call kick_plain(plan, view, h, torque, status, left)
      if (left == 0) return
      job%plan => plan
      job%view = view
      job%torque = torque
      if (left > 1) then
         job%view = view_from(view, left)
         do j = 1, 3
            job%torque(j)%of => torque(j)%of(left:)
         end do
      end if
      job%same_frame = adds_direct(plan)
      job%h = h
      job%keep_attitude = .true.
      status = for_each_left(view, left, plan%threads, job, status)
   end subroutine kick_bodies

   !> A kick by the short path, if plan, view and torques allow it.
   subroutine kick_plain(plan, view, h, torque, status, left)
      type(poinsot_plan), intent(in) :: plan
      type(body_view), intent(in) :: view
      real(dp), intent(in) :: h
      type(column), intent(in) :: torque(3)
      integer, intent(inout) :: status
      integer, intent(out) :: left                    !! the first body that is for others; 0: none
      type(plain_arrays) :: a
      type(plain_torques) :: g
      logical :: failed, plain
      left = 1
      plain = takes_direct(plan, view%n, associated(view%moments(1)%of)) .and. adds_direct(plan)
      if (plain) call open_plain_view(view, momentum_columns(plan), a, plain)
      if (plain) call open_plain_torques(view%n, torque, g, plain)
      if (.not. plain) return
      call kick_direct(plan%classes(1)%it, plan%momentum, h, g, a, failed, left)
      status = merge(poinsot_e_partial, poinsot_ok, failed)
   end subroutine kick_plain

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
      integer :: left

      left = 1
      call check_ready(plan, view, error)
      if (.not. raised(error)) call check_purpose(plan, view, to_step, error)
      if (.not. raised(error)) call check_step(h, 1, error)
      if (.not. raised(error)) call check_step(t, 1, error, "time t")
      if (.not. raised(error)) call check_count(first, steps, error)
      if (.not. raised(error) .and. h < 0) call check_direction(plan, error)
      status = error%code
      if (raised(error)) return
      if (.not. present(callback) .and. steps <= huge(0) .and. is_free(plan)) then
         call rotate_plain(plan, view, h, int(steps), .false., status, left)
         if (left == 0) return
      end if
      if (plan%coupled .or. present(callback)) then
         call run_coupled(plan, view, t, h, first, steps, status, error, callback)
         return
      end if
      job%plan => plan
      job%t = t
      job%h = h
      job%first = first
      job%steps = steps
      job%loaded = clock(t + real(first, dp)*h, glance*h)
      job%stored = clock(t + real(first + steps, dp)*h, glance*h) ! as the next call looks
      job%wants_id = plan%has_dissipation
      job%ns = step_ns(plan)*real(steps, dp)
      status = for_each_left(view, left, plan%threads, job, status)
   end subroutine step_bodies

   !> Approximate time of a step of one body, in nanoseconds.
   pure real(dp) function step_ns(plan)
      type(poinsot_plan), intent(in) :: plan
      real(dp), parameter :: effect = 5, series = 2000  !! a kick of one effect; a Taylor step
      step_ns = series
      if (.not. plan%splitting%adaptive) step_ns = max(1, plan%splitting%stages)* &
         (plan%method%ns + effect*size(plan%effects))
   end function step_ns

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
   subroutine check_direction(plan, error)
      type(poinsot_plan), intent(in) :: plan
      type(poinsot_error), intent(inout) :: error
      integer :: i
      do i = 1, size(plan%effects)
         select type (one => plan%effects(i)%it)
         class is (flow_effect)
            if (one%only_forward()) call raise(error, poinsot_e_domain, "effect '"// &
               trim(one%name)//"' is defined for steps h > 0 only")
         end select
      end do
   end subroutine check_direction

   subroutine run_drift(self, b)
      class(drift_job), intent(inout) :: self
      type(block_flows), intent(inout) :: b
      call attach_plan(self%plan, b)
      call b%drift(0.0_dp, self%h)
   end subroutine run_drift

   subroutine run_kick(self, b)
      class(kick_job), intent(inout) :: self
      type(block_flows), intent(inout) :: b
      real(dp) :: dy(lanes, 3)
      integer :: l, j
      dy = 0
      do j = 1, 3
         do l = 1, b%n
            dy(l, j) = self%torque(j)%of(b%at(l))
         end do
      end do
      call reject_torques(b%nvec, self%h, dy, b%status)
      if (self%same_frame .and. .not. b%compensated .and. .not. b%has_massless()) then
         call add_momentum(self%view, self%h*dy, b)
         return
      end if
      call turn_to_body(self%plan%space_torque, self%plan%is_turned(b%class), b%class, b%q, dy)
      dy = self%h*dy
      call b%mask_massless_axes(dy)
      if (b%compensated) then
         call add_kick_compensated(dy, b%y, b%carry)
      else
         call add_kick(dy, b%y)
      end if
      call b%reject_fast()
   end subroutine run_kick

   subroutine run_step(self, b)
      class(step_job), intent(inout) :: self
      type(block_flows), intent(inout) :: b
      type(splitting), pointer :: scheme
      if (allocated(self%plan%taylor)) then
         call run_taylor(self%plan, taylor_time(self%t, self%h, self%first, self%steps), b)
         return
      end if
      call attach_plan(self%plan, b)
      scheme => scheme_of(self%plan, b)
      call apply_preprocessor(scheme, b, self%t, self%h, self%first)
      call run_steps(scheme, b, self%t, self%h, self%first, self%steps)
      call apply_postprocessor(scheme, b, self%t, self%h, self%first + self%steps)
   end subroutine run_step

end module poinsot_ensemble_step
