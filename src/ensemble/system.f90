!> All bodies as one system for the stepper: pair effects and the host's callback need all attitudes
!> before a kick, so each stage of the splitting goes over all blocks.
module poinsot_ensemble_system
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_rounding, only: rounds_to_nearest
   use poinsot_core_status, only: poinsot_e_domain
   use poinsot_effect_effect, only: pair_effect
   use poinsot_ensemble_block, only: clock, reject_values
   use poinsot_ensemble_layout, only: turn_to_body, from_native, body_momentum
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_free_lane_moments, only: lane_moments
   use poinsot_splitting_block_flows, only: block_flows
   use poinsot_splitting_stepper, only: flows
   implicit none(type, external)
   private
   public :: torque_callback, ensemble_flows, scatter_all, add_pairs

   !> The host's torques for all bodies at once: extend this type, its components are the context.
   type, abstract :: torque_callback
   contains
      procedure(evaluate), deferred :: evaluate
   end type torque_callback

   abstract interface
      !> Torques of all bodies, in the caller's order and in the frame the plan says. `stop` =
      !> .true. ends the call: the bodies then have the state of before that step.
      subroutine evaluate(self, t, q, torque, energy, stop)
         import :: torque_callback, dp
         implicit none(type, external)
         class(torque_callback), intent(inout) :: self
         real(dp), intent(in) :: t                        !! time
         real(dp), intent(in), target :: q(:, :)          !! (n, 4): attitudes, caller's body frames
         real(dp), intent(inout), target :: torque(:, :)  !! (n, 3): zero on entry
         real(dp), intent(inout) :: energy                !! potential energy of all, if it is known
         logical, intent(inout) :: stop
      end subroutine evaluate
   end interface

   !> All blocks as one system for the stepper.
   type, extends(flows) :: ensemble_flows
      type(poinsot_plan), pointer :: plan => null()
      type(block_flows), allocatable :: at(:)
      type(lane_moments), allocatable :: by_lane(:)  !! moments of the bodies' own, of each block
      class(torque_callback), pointer :: callback => null()
      real(dp), allocatable :: sources(:, :, :)  !! (3, n, effects): what pair effects scatter
      real(dp), allocatable :: changes(:, :)     !! (3, n): its derivative, of one effect
      real(dp), allocatable :: q(:, :)           !! (n, 4): what the callback sees
      real(dp), allocatable :: torque(:, :)      !! (n, 3): what it answers
      real(dp) :: energy = 0                     !! what it answered last
      integer :: n = 0, team = 1
      type(clock) :: loaded, stored              !! when the caller's velocities are
   contains
      procedure :: drift => drift_all
      procedure :: kick => kick_all
      procedure :: dissipative_half_step => dissipate_half_all
      procedure :: dissipate => dissipate_all
   end type ensemble_flows

contains

   subroutine drift_all(self, t, h)
      class(ensemble_flows), intent(inout) :: self
      real(dp), intent(in) :: t, h
      integer :: k
      self%fresh = .false.
      !$omp parallel do num_threads(self%team) schedule(static) default(none) &
      !$omp shared(self, t, h) private(k)
      do k = 1, size(self%at)
         if (.not. rounds_to_nearest()) self%at(k)%status = poinsot_e_domain
         call self%at(k)%drift(t, h)
      end do
      !$omp end parallel do
   end subroutine drift_all

   subroutine dissipate_all(self, t, h, step)
      class(ensemble_flows), intent(inout) :: self
      real(dp), intent(in) :: t, h
      integer(i8), intent(in) :: step
      integer :: k
      !$omp parallel do num_threads(self%team) schedule(static) default(none) &
      !$omp shared(self, t, h, step) private(k)
      do k = 1, size(self%at)
         if (self%at(k)%has_dissipation) call self%at(k)%dissipate(t, h, step)
      end do
      !$omp end parallel do
   end subroutine dissipate_all

   subroutine dissipate_half_all(self, t, h, step, half)
      class(ensemble_flows), intent(inout) :: self
      real(dp), intent(in) :: t, h
      integer(i8), intent(in) :: step
      integer, intent(in) :: half
      integer :: k
      !$omp parallel do num_threads(self%team) schedule(static) default(none) &
      !$omp shared(self, t, h, step, half) private(k)
      do k = 1, size(self%at)
         if (self%at(k)%has_dissipation) call self%at(k)%dissipative_half_step(t, h, &
            step, half)
      end do
      !$omp end parallel do
   end subroutine dissipate_half_all

   !> y += b g + c G for all bodies: own torques, pair torques, the host's.
   subroutine kick_all(self, t, b, c, ahead)
      class(ensemble_flows), intent(inout) :: self
      real(dp), intent(in) :: t, b, c, ahead
      logical :: jumps
      integer :: k
      jumps = abs(ahead) > 0 .and. any(self%plan%composed%jumps)
      if (.not. self%fresh .or. jumps) call evaluate_torques(self, t, ahead)
      if (self%halted) return
      self%fresh = .true.
      if (abs(c) > 0) call evaluate_gradients(self, t, ahead)
      !$omp parallel do num_threads(self%team) schedule(static) default(none) &
      !$omp shared(self, b, c) private(k)
      do k = 1, size(self%at)
         if (.not. rounds_to_nearest()) self%at(k)%status = poinsot_e_domain
         call self%at(k)%apply_kick(b, c)
      end do
      !$omp end parallel do
   end subroutine kick_all

   !> Torques of all bodies at time t, into each block's g.
   subroutine evaluate_torques(self, t, ahead)
      type(ensemble_flows), intent(inout) :: self
      real(dp), intent(in) :: t, ahead
      integer :: k, i
      call scatter_all(self)
      !$omp parallel do num_threads(self%team) schedule(static) default(none) &
      !$omp shared(self, t, ahead) private(k, i)
      do k = 1, size(self%at)
         associate (s => self%at(k))
            call s%start_torque(t, ahead)
            do i = 1, size(self%plan%effects)
               select type (one => self%plan%effects(i)%it)
               class is (pair_effect)
                  if (one%acts_on(s%number)) then
                     call one%add_torque(s%number, s%at, s%q, &
                                         self%sources(:, :, i), s%g)
                  end if
               end select
            end do
         end associate
      end do
      !$omp end parallel do
      if (associated(self%callback)) call ask_callback(self, t)
      do k = 1, size(self%at)
         call self%at(k)%finish_torque()
      end do
   end subroutine evaluate_torques

   !> What each body shows to the others, into the sources.
   subroutine scatter_all(self)
      type(ensemble_flows), intent(inout) :: self
      integer :: k, i
      if (self%plan%coupled) self%sources = 0
      do i = 1, size(self%plan%effects)
         select type (one => self%plan%effects(i)%it)
         class is (pair_effect)
            do k = 1, size(self%at)
               associate (s => self%at(k))
                  if (one%acts_on(s%number)) then
                     call one%scatter_source(s%number, s%at, s%q, self%sources(:, :, i))
                  end if
               end associate
            end do
         end select
      end do
   end subroutine scatter_all

   !> Pair energies of block k.
   subroutine add_pairs(self, k, u)
      type(ensemble_flows), intent(in) :: self
      integer, intent(in) :: k
      real(dp), intent(inout) :: u(lanes)
      integer :: i
      do i = 1, size(self%plan%effects)
         select type (one => self%plan%effects(i)%it)
         class is (pair_effect)
            associate (s => self%at(k))
               if (one%acts_on(s%number)) then
                  call one%add_energy(s%number, s%at, s%q, self%sources(:, :, i), u)
               end if
            end associate
         end select
      end do
   end subroutine add_pairs

   !> The host's torques, in its order and frame.
   subroutine ask_callback(self, t)
      type(ensemble_flows), intent(inout) :: self
      real(dp), intent(in) :: t
      real(dp) :: q(lanes, 4), p(lanes, 4), g(lanes, 3)
      integer :: k, l
      self%q = 0
      self%q(:, 1) = 1
      do k = 1, size(self%at)
         associate (s => self%at(k))
            q = s%q
            call from_native(body_momentum, self%plan%is_turned(s%class), s%class, &
               s%class%rotor, s%y, q, p)
            do l = 1, s%n
               self%q(s%at(l), :) = q(l, :)
            end do
         end associate
      end do
      self%torque = 0
      self%energy = 0
      call self%callback%evaluate(t, self%q, self%torque, self%energy, self%halted)
      if (self%halted) return
      do k = 1, size(self%at)
         associate (s => self%at(k))
            g = 0
            do l = 1, s%n
               g(l, :) = self%torque(s%at(l), :)
            end do
            call reject_values(s, g)
            call turn_to_body(self%plan%space_torque, self%plan%is_turned(s%class), s%class, s%q, g)
            s%g = s%g + g
         end associate
      end do
   end subroutine ask_callback

   !> Force gradients of all bodies: two passes for pair effects, as for torques.
   subroutine evaluate_gradients(self, t, ahead)
      type(ensemble_flows), intent(inout) :: self
      real(dp), intent(in) :: t, ahead
      integer :: k, i
      do k = 1, size(self%at)
         call self%at(k)%start_gradient(t, ahead)
      end do
      do i = 1, size(self%plan%effects)
         select type (one => self%plan%effects(i)%it)
         class is (pair_effect)
            self%changes = 0
            do k = 1, size(self%at)
               associate (s => self%at(k))
                  if (one%acts_on(s%number)) then
                     call one%scatter_change(s%number, s%at, s%q, s%delta, self%changes)
                  end if
               end associate
            end do
            do k = 1, size(self%at)
               associate (s => self%at(k))
                  if (one%acts_on(s%number)) then
                     call one%add_derivative(s%number, s%at, s%q, s%delta, &
                                             self%sources(:, :, i), self%changes, &
                                             s%gradient)
                  end if
               end associate
            end do
         end select
      end do
      do k = 1, size(self%at)
         call self%at(k)%finish_gradient()
      end do
   end subroutine evaluate_gradients

end module poinsot_ensemble_system
