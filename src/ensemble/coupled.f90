!> Steps of bodies that see each other: pair effects and the host's callback need all attitudes
!> before a kick. All bodies then stand in blocks at once; each stage of the splitting goes over all
!> of them.
module poinsot_ensemble_coupled
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_callback, poinsot_e_memory, &
      poinsot_e_method, poinsot_e_partial, &
      poinsot_e_size
   use poinsot_effect_effect, only: pair_effect
   use poinsot_ensemble_block, only: block_state, host_arrays, open_host, load_block, store_block
   use poinsot_ensemble_bodies, only: body_view
   use poinsot_ensemble_deal, only: hand, chunk_count, deal_chunk, next_block
   use poinsot_ensemble_layout, only: turn_to_body, from_native, body_momentum
   use poinsot_ensemble_plan, only: poinsot_plan, compose_classes
   use poinsot_splitting_block_flows, only: block_flows
   use poinsot_splitting_registry, only: find_splitting
   use poinsot_splitting_stepper, only: flows, run_steps, enter_kernel, leave_kernel
   use poinsot_splitting_tableaux, only: splitting
   !$ use omp_lib, only: omp_in_parallel, omp_get_max_threads
   implicit none(type, external)
   private
   public :: torque_callback, run_coupled, coupled_energy

   integer, parameter :: blocks_per_thread = 4 !! with fewer, a thread costs more than it brings

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
         real(dp), intent(in) :: t                          !! time
         real(dp), intent(in), target :: q(:, :)        !! (n, 4): attitudes, the caller's body
                                                        !! frames
         real(dp), intent(inout), target :: torque(:, :)    !! (n, 3): zero on entry
         real(dp), intent(inout) :: energy              !! potential energy of all, if it is known
         logical, intent(inout) :: stop
      end subroutine evaluate
   end interface

   !> One block of the ensemble with its places in the caller's arrays.
   type :: station
      type(block_flows) :: flows
      type(block_state) :: b
   end type station

   !> What a station needs to go back to: the state before a step.
   type :: memory
      real(dp) :: y(lanes, 3), q(lanes, 4), carry(lanes, 7)
      integer :: status(lanes)
   end type memory

   !> All blocks as one system for the stepper.
   type, extends(flows) :: ensemble_flows
      type(poinsot_plan), pointer :: plan => null()
      type(station), allocatable :: at(:)
      class(torque_callback), pointer :: callback => null()
      real(dp), allocatable :: sources(:, :, :), changes(:, :) !! (3, n, effects), (3, n): of pair
                                                               !! effects
      real(dp), allocatable :: q(:, :), torque(:, :)    !! (n, 4), (n, 3): what the callback sees
      real(dp) :: energy = 0                                      !! what it answered last
      integer :: n = 0, team = 1
   contains
      procedure :: drift => drift_all
      procedure :: kick => kick_all
      procedure :: outer => outer_all
   end type ensemble_flows

contains

   !> Steps of all bodies with pair effects and callback. See step_bodies.
   subroutine run_coupled(plan, view, t, h, first, steps, status, error, callback)
      type(poinsot_plan), intent(in), target :: plan
      type(body_view), intent(in) :: view
      real(dp), intent(in) :: t, h
      integer(i8), intent(in) :: first, steps
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      class(torque_callback), intent(inout), optional, target :: callback
      type(ensemble_flows) :: system
      type(memory), allocatable :: before(:)
      integer(i8) :: k
      integer :: state
      logical :: failed

      if (present(callback)) system%callback => callback
      failed = .false.
      call gather_all(plan, view, system, failed, error)
      if (.not. raised(error)) then
         allocate (before(merge(size(system%at), 0, present(callback))), stat=state)
         if (state /= 0) call raise(error, poinsot_e_memory, &
            "no memory for the state before a step")
      end if
      status = error%code
      if (raised(error)) return
      if (size(system%at) == 0) then ! nobody to move: no reason to count the steps
         status = merge(poinsot_e_partial, poinsot_ok, failed)
         return
      end if
      call enter_kernel(plan%splitting, system, t, h, first)
      do k = first, first + steps - 1
         if (present(callback)) call remember(system, before)
         call run_steps(plan%splitting, system, t, h, k, 1_i8)
         if (system%halted) exit
      end do
      if (system%halted) then
         call raise(error, poinsot_e_callback, "the callback asked to stop")
         call go_back(system, before)
      else
         call leave_kernel(plan%splitting, system, t, h, first + steps)
      end if
      call store_all(plan, view, system, failed)
      status = merge(poinsot_e_partial, poinsot_ok, failed)
      if (raised(error)) status = error%code
   end subroutine run_coupled

   !> Keep the state of all stations.
   subroutine remember(system, before)
      type(ensemble_flows), intent(in) :: system
      type(memory), intent(inout) :: before(:)
      integer :: k
      do k = 1, size(before)
         associate (f => system%at(k)%flows)
            before(k) = memory(f%y, f%q, f%carry, f%status)
         end associate
      end do
   end subroutine remember

   subroutine go_back(system, before)
      type(ensemble_flows), intent(inout) :: system
      type(memory), intent(in) :: before(:)
      integer :: k
      do k = 1, size(before)
         associate (f => system%at(k)%flows)
            f%y = before(k)%y
            f%q = before(k)%q
            f%carry = before(k)%carry
            f%status = before(k)%status
         end associate
      end do
   end subroutine go_back

   !> Kinetic and potential energy of each body at time t, pair energies shared between the two. A
   !> body that is refused keeps what stands in the arrays.
   subroutine coupled_energy(plan, view, t, kinetic, potential, status, error)
      type(poinsot_plan), intent(in), target :: plan
      type(body_view), intent(in) :: view
      real(dp), intent(in) :: t
      real(dp), intent(inout) :: kinetic(:), potential(:)
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      type(ensemble_flows) :: system
      real(dp) :: e(lanes), u(lanes)
      logical :: failed
      integer :: k, l

      failed = .false.
      call gather_all(plan, view, system, failed, error)
      status = error%code
      if (raised(error)) return
      call lay_all(system)
      do k = 1, size(system%at)
         associate (s => system%at(k))
            call s%flows%energies(t, e, u)
            call add_pairs(system, k, u)
            do l = 1, s%b%n
               if (associated(view%status)) view%status(s%b%at(l)) = s%b%status(l)
               failed = failed .or. s%b%status(l) /= poinsot_ok
               if (s%b%status(l) /= poinsot_ok) cycle
               kinetic(s%b%at(l)) = e(l)
               potential(s%b%at(l)) = u(l)
            end do
         end associate
      end do
      status = merge(poinsot_e_partial, poinsot_ok, failed)
   end subroutine coupled_energy

   !> Load all bodies into blocks, with the flows of their classes.
   subroutine gather_all(plan, view, system, failed, error)
      type(poinsot_plan), intent(in), target :: plan
      type(body_view), intent(in) :: view
      type(ensemble_flows), intent(inout) :: system
      logical, intent(inout) :: failed
      type(poinsot_error), intent(inout) :: error
      type(block_flows), allocatable :: composed(:)
      type(hand) :: h
      type(host_arrays) :: host
      integer :: c, k, blocks, first, n, class, state

      system%plan => plan
      system%n = view%n
      system%team = 1
      !$ if (.not. omp_in_parallel()) &
      !$    system%team = merge(plan%threads, omp_get_max_threads(), plan%threads > 0)
      call check_pairs(plan, view, error)
      if (.not. raised(error)) call compose_classes(plan, plan%splitting, composed, error)
      if (raised(error)) return
      if (plan%splitting%needs_gradient .and. associated(system%callback)) then
         call raise(error, poinsot_e_method, "splitting '"//trim(plan%splitting%name) &
            //"' needs a force gradient, "// &
                    "which a callback does not have; srkn4 and srkn6 need none")
         return
      end if
      blocks = 0
      do c = 1, chunk_count(view%n)
         call deal_chunk(view, size(plan%classes), c, h, failed)
         do
            call next_block(h, first, n, class)
            if (n == 0) exit
            blocks = blocks + 1
         end do
      end do
      system%team = max(1, min(system%team, blocks/blocks_per_thread))
      allocate (system%at(blocks), stat=state)
      if (state == 0 .and. plan%coupled) then
         allocate (system%sources(3, view%n, size(plan%effects)), system%changes(3, view%n), &
            stat=state)
      end if
      if (state == 0 .and. associated(system%callback)) then
         allocate (system%q(view%n, 4), system%torque(view%n, 3), stat=state)
      end if
      if (state /= 0) then
         call raise(error, poinsot_e_memory, "no memory for the blocks of all bodies")
         return
      end if
      if (view%n > 0) call open_host(view, plan%momentum, host)
      host%wants_id = .true.
      k = 0
      do c = 1, chunk_count(view%n)
         call deal_chunk(view, size(plan%classes), c, h, failed)
         do
            call next_block(h, first, n, class)
            if (n == 0) exit
            k = k + 1
            call load_station(plan, host, composed(class), h%at(first:first + n - 1), n, class, &
               system%at(k))
         end do
      end do
      do k = 1, size(composed)
         system%has_outer = system%has_outer .or. composed(k)%has_outer
      end do
   end subroutine gather_all

   subroutine load_station(plan, host, flows, places, n, class, s)
      type(poinsot_plan), intent(in) :: plan
      type(host_arrays), intent(in) :: host
      type(block_flows), intent(in) :: flows
      integer, intent(in) :: n, class, places(n)
      type(station), intent(inout) :: s
      s%flows = flows
      call load_block(host, places, n, class, plan%classes(class), plan%axes(:, class), s%b)
      s%b%at(n + 1:) = 0
      s%flows%y = s%b%y
      s%flows%q = s%b%q
      if (s%b%compensated) s%flows%carry = s%b%carry
      s%flows%status = s%b%status
      s%flows%id = s%b%id
      s%flows%compensated = s%b%compensated
   end subroutine load_station

   subroutine store_all(plan, view, system, failed)
      type(poinsot_plan), intent(in) :: plan
      type(body_view), intent(in) :: view
      type(ensemble_flows), intent(inout) :: system
      logical, intent(inout) :: failed
      type(host_arrays) :: host
      integer :: k
      if (view%n == 0) return
      call open_host(view, plan%momentum, host)
      do k = 1, size(system%at)
         associate (s => system%at(k))
            s%b%y = s%flows%y
            s%b%q = s%flows%q
            s%b%carry = s%flows%carry
            s%b%status = s%flows%status
            call store_block(host, plan%classes(s%b%class), plan%axes(:, s%b%class), .false., &
               .false., s%b)
            failed = failed .or. any(s%b%status(1:s%b%n) /= poinsot_ok)
         end associate
      end do
   end subroutine store_all

   !> Pair effects that know positions need one for each body.
   subroutine check_pairs(plan, view, error)
      type(poinsot_plan), intent(in) :: plan
      type(body_view), intent(in) :: view
      type(poinsot_error), intent(inout) :: error
      character(24) :: numbers
      integer :: i
      do i = 1, size(plan%effects)
         select type (one => plan%effects(i)%it)
         class is (pair_effect)
            if (one%bodies() > 0 .and. one%bodies() /= view%n) then
               write (numbers, "(i0, a, i0)") one%bodies(), " for ", view%n
               call raise(error, poinsot_e_size, "effect '"//trim(one%name) &
                  //"' has positions of "//trim(numbers)// &
                          " bodies: give one position for each")
            end if
         end select
      end do
   end subroutine check_pairs

   subroutine drift_all(self, h)
      class(ensemble_flows), intent(inout) :: self
      real(dp), intent(in) :: h
      integer :: k
      self%fresh = .false.
      !$omp parallel do num_threads(self%team) schedule(static) default(none) &
      !$omp shared(self, h) private(k)
      do k = 1, size(self%at)
         call self%at(k)%flows%drift(h)
      end do
      !$omp end parallel do
   end subroutine drift_all

   subroutine outer_all(self, h, step, half)
      class(ensemble_flows), intent(inout) :: self
      real(dp), intent(in) :: h
      integer(i8), intent(in) :: step
      integer, intent(in) :: half
      integer :: k
      !$omp parallel do num_threads(self%team) schedule(static) default(none) &
      !$omp shared(self, h, step, half) private(k)
      do k = 1, size(self%at)
         if (self%at(k)%flows%has_outer) call self%at(k)%flows%outer(h, step, half)
      end do
      !$omp end parallel do
   end subroutine outer_all

   !> y += b g + c G for all bodies: own torques, pair torques, the host's.
   subroutine kick_all(self, t, b, c)
      class(ensemble_flows), intent(inout) :: self
      real(dp), intent(in) :: t, b, c
      integer :: k
      if (.not. self%fresh) call evaluate_torques(self, t)
      if (self%halted) return
      self%fresh = .true.
      if (abs(c) > 0) call evaluate_gradients(self, t)
      !$omp parallel do num_threads(self%team) schedule(static) default(none) &
      !$omp shared(self, b, c) private(k)
      do k = 1, size(self%at)
         call self%at(k)%flows%push(b, c)
      end do
      !$omp end parallel do
   end subroutine kick_all

   !> Torques of all bodies at time t, into each block's g.
   subroutine evaluate_torques(self, t)
      type(ensemble_flows), intent(inout) :: self
      real(dp), intent(in) :: t
      integer :: k, i
      call lay_all(self)
      !$omp parallel do num_threads(self%team) schedule(static) default(none) &
      !$omp shared(self, t) private(k, i)
      do k = 1, size(self%at)
         associate (s => self%at(k))
            call s%flows%start_torque(t)
            do i = 1, size(self%plan%effects)
               select type (one => self%plan%effects(i)%it)
               class is (pair_effect)
                  if (one%acts_on(s%b%class)) then
                     call one%add_torque(s%b%class, s%b%at, s%flows%q, self%sources(:, :, i), &
                        s%flows%g)
                  end if
               end select
            end do
         end associate
      end do
      !$omp end parallel do
      if (associated(self%callback)) call ask_callback(self, t)
      do k = 1, size(self%at)
         call self%at(k)%flows%freeze_torque()
      end do
   end subroutine evaluate_torques

   !> What each body shows to the others.
   subroutine lay_all(self)
      type(ensemble_flows), intent(inout) :: self
      integer :: k, i
      if (self%plan%coupled) self%sources = 0
      do i = 1, size(self%plan%effects)
         select type (one => self%plan%effects(i)%it)
         class is (pair_effect)
            do k = 1, size(self%at)
               associate (s => self%at(k))
                  if (one%acts_on(s%b%class)) call one%lay_source(s%b%class, s%b%at, s%flows%q, &
                                                                    self%sources(:, :, i))
               end associate
            end do
         end select
      end do
   end subroutine lay_all

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
               if (one%acts_on(s%b%class)) call one%add_energy(s%b%class, s%b%at, s%flows%q, &
                  self%sources(:, :, i), u)
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
         associate (s => self%at(k), axes => self%plan%axes, classes => self%plan%classes)
            q = s%flows%q
            call from_native(body_momentum, axes(:, s%b%class), classes(s%b%class), s%flows%y, q, p)
            do l = 1, s%b%n
               self%q(s%b%at(l), :) = q(l, :)
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
            do l = 1, s%b%n
               g(l, :) = self%torque(s%b%at(l), :)
            end do
            s%b%status = s%flows%status
            call s%b%refuse_values(g)
            s%flows%status = s%b%status
            call turn_to_body(self%plan%space_torque, self%plan%axes(:, s%b%class), s%flows%q, g)
            s%flows%g = s%flows%g + g
         end associate
      end do
   end subroutine ask_callback

   !> Force gradients of all bodies: two passes for pair effects, as for torques.
   subroutine evaluate_gradients(self, t)
      type(ensemble_flows), intent(inout) :: self
      real(dp), intent(in) :: t
      integer :: k, i
      do k = 1, size(self%at)
         call self%at(k)%flows%start_gradient(t)
      end do
      do i = 1, size(self%plan%effects)
         select type (one => self%plan%effects(i)%it)
         class is (pair_effect)
            self%changes = 0
            do k = 1, size(self%at)
               associate (s => self%at(k))
                  if (one%acts_on(s%b%class)) then
                     call one%lay_change(s%b%class, s%b%at, s%flows%q, s%flows%delta, self%changes)
                  end if
               end associate
            end do
            do k = 1, size(self%at)
               associate (s => self%at(k))
                  if (one%acts_on(s%b%class)) call one%add_derivative(s%b%class, s%b%at, &
                     s%flows%q, s%flows%delta, &
                                                                      self%sources(:, :, i), &
                                                                         self%changes, &
                                                                         s%flows%gradient)
               end associate
            end do
         end select
      end do
      do k = 1, size(self%at)
         call self%at(k)%flows%finish_gradient()
      end do
   end subroutine evaluate_gradients

end module poinsot_ensemble_coupled
