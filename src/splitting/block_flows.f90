!> The flows of one block with the effects of its body class: what `run_steps` composes for bodies
!> that do not see each other. What is not there costs nothing: lists are made when the block is
!> composed, and a block without torque has no kick in its scheme (`scheme_for`).
module poinsot_splitting_block_flows
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_memory, &
      poinsot_e_method
   use poinsot_core_lanes, only: any_failed
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_body_class, only: body_class
   use poinsot_free_accumulate, only: add_plain, add_compensated, add_kick, add_kick_compensated
   use poinsot_free_limits, only: reject_speed, reject_torque
   use poinsot_free_method, only: free_method, advance
   use poinsot_effect_effect, only: effect_item, torque_effect, flow_effect
   use poinsot_effect_gyrostat, only: gyrostat
   use poinsot_splitting_stepper, only: flows
   use poinsot_splitting_tableaux, only: splitting, free_scheme, turn_composition
   implicit none(type, external)
   private
   public :: block_flows

   type :: torque_pointer
      class(torque_effect), pointer :: it => null()
   end type torque_pointer

   type :: flow_pointer
      class(flow_effect), pointer :: it => null()
   end type flow_pointer

   !> One block at work. Compose once per body class, then load y, q, status (and id, carry), step,
   !> unload.
   type, extends(flows) :: block_flows
      real(dp) :: y(lanes, 3) = 0                        !! angular momenta
      real(dp) :: q(lanes, 4) = 0                        !! attitudes
      real(dp) :: carry(lanes, 7) = 0                    !! compensated sums, used if `compensated`
      integer :: status(lanes) = poinsot_ok              !! a lane that is not ok stands still
      integer(i8) :: id(lanes) = 0                       !! of the bodies, for random numbers
      integer(i8) :: seed = 0
      logical :: compensated = .false.
      real(dp) :: g(lanes, 3) = 0                        !! body torque, valid if `fresh`
      real(dp) :: delta(lanes, 3) = 0                    !! M g, while a force gradient is made
      real(dp) :: gradient(lanes, 3) = 0                 !! force gradient G
      type(body_class), pointer :: class => null()
      type(free_method), pointer :: method => null()
      type(torque_pointer), allocatable :: torques(:)
      type(flow_pointer), allocatable :: dissipative(:)
      type(gyrostat), allocatable :: rotor_sum               !! all rotors of the class as one
      real(dp), allocatable :: weights(:)                !! composition of free rotation and turn
   contains
      procedure :: compose
      procedure :: scheme_for
      procedure :: drift
      procedure :: kick
      procedure :: dissipative_half_step
      procedure :: energies
      procedure :: start_torque
      procedure :: finish_torque
      procedure :: start_gradient
      procedure :: finish_gradient
      procedure :: apply_kick
   end type block_flows

contains

   !> Pick the effects that act on a body class. POINSOT_E_METHOD if the scheme needs a force
   !> gradient that an effect does not have. Pair effects are not taken: they need all blocks.
   subroutine compose(self, class, number, method, scheme, effects, error)
      class(block_flows), intent(inout) :: self
      type(body_class), intent(in), target :: class !! must outlive the block, as must the next
      integer, intent(in) :: number                       !! of the class, from 1
      type(free_method), intent(in), target :: method
      type(splitting), intent(in) :: scheme
      type(effect_item), intent(in), target :: effects(:)
      type(poinsot_error), intent(inout) :: error
      integer :: i, torques, dissipative, failed
      self%class => class
      self%method => method
      if (allocated(self%rotor_sum)) deallocate (self%rotor_sum)
      if (allocated(self%torques)) deallocate (self%torques)
      if (allocated(self%dissipative)) deallocate (self%dissipative)
      torques = 0
      dissipative = 0
      do i = 1, size(effects)
         if (.not. effects(i)%it%acts_on(number)) cycle
         select type (one => effects(i)%it)
         class is (torque_effect)
            torques = torques + 1
            if (scheme%needs_gradient .and. .not. one%has_gradient()) then
               call raise(error, poinsot_e_method, "splitting '" // trim(scheme%name) // &
                          "' needs a force gradient, which effect '" // trim(one%name) // &
                          "' does not have; srkn4 and srkn6 need none")
               return
            end if
         class is (flow_effect)
            dissipative = dissipative + 1
         class is (gyrostat)
            if (class%sorted(1) <= 0 .and. any(abs(one%rotor) > 0)) then
               call raise(error, poinsot_e_domain, "effect 'gyrostat': a linear body, which " // &
                  "has a moment of zero, holds no rotor; name another class by key 'class'")
               return
            end if
            call add_rotor(self, one, scheme%order)
         end select
      end do
      failed = 0
      if (torques > 0) allocate (self%torques(torques), stat=failed)
      if (dissipative > 0 .and. failed == 0) allocate (self%dissipative(dissipative), stat=failed)
      if (failed /= 0) then
         call raise(error, poinsot_e_memory)
         return
      end if
      self%has_dissipation = dissipative > 0
      call point(self, number, effects)
   end subroutine compose

   !> Momenta of rotors add.
   subroutine add_rotor(self, one, order)
      class(block_flows), intent(inout) :: self
      type(gyrostat), intent(in) :: one
      integer, intent(in) :: order
      if (allocated(self%rotor_sum)) then
         self%rotor_sum%rotor = self%rotor_sum%rotor + one%rotor
      else
         self%rotor_sum = one
         call turn_composition(order, self%weights)
      end if
   end subroutine add_rotor

   subroutine point(self, number, effects)
      class(block_flows), intent(inout) :: self
      integer, intent(in) :: number
      type(effect_item), intent(in), target :: effects(:)
      integer :: i, torques, dissipative
      torques = 0
      dissipative = 0
      do i = 1, size(effects)
         if (.not. effects(i)%it%acts_on(number)) cycle
         select type (one => effects(i)%it)
         class is (torque_effect)
            torques = torques + 1
            self%torques(torques)%it => one
         class is (flow_effect)
            dissipative = dissipative + 1
            self%dissipative(dissipative)%it => one
         end select
      end do
   end subroutine point

   !> The scheme itself, or the bare free rotation where there is no torque.
   function scheme_for(self, scheme) result(chosen)
      class(block_flows), intent(in) :: self
      type(splitting), intent(in) :: scheme
      type(splitting) :: chosen
      if (allocated(self%torques)) then
         chosen = scheme
      else
         chosen = free_scheme()
      end if
   end function scheme_for

   !> Free rotation over h; with a gyrostat composed with its turn.
   subroutine drift(self, h)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: h
      integer :: i, n
      self%fresh = .false.
      if (.not. allocated(self%rotor_sum)) then
         call rotate(self, h)
         return
      end if
      n = size(self%weights)
      call turn(self, 0.5_dp*self%weights(1)*h)
      do i = 1, n - 1
         call rotate(self, self%weights(i)*h)
         call turn(self, 0.5_dp*(self%weights(i) + self%weights(i + 1))*h)
      end do
      call rotate(self, self%weights(n)*h)
      call turn(self, 0.5_dp*self%weights(n)*h)
   end subroutine drift

   subroutine rotate(self, h)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: h
      if (self%compensated) then
         call advance(self%method, self%class, h, self%y, self%q, self%status, self%carry)
      else
         call advance(self%method, self%class, h, self%y, self%q, self%status)
      end if
   end subroutine rotate

   subroutine turn(self, h)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: h
      real(dp) :: dy(lanes, 3), dq(lanes, 4), hl(lanes)
      call self%rotor_sum%turn_increment(self%class, h, self%y, self%q, dy, dq)
      hl = merge(h, 0.0_dp, self%status == poinsot_ok)
      call mask_failed_lanes(self%status, dy)
      call mask_failed_lanes(self%status, dq)
      if (self%compensated) then
         call add_compensated(hl, dy, dq, self%y, self%q, self%carry)
      else
         call add_plain(hl, dy, dq, self%y, self%q)
      end if
   end subroutine turn

   !> Zero in every lane that stands still.
   pure subroutine mask_failed_lanes(status, d)
      integer, intent(in) :: status(lanes)
      real(dp), intent(inout) :: d(:, :)
      integer :: j
      if (.not. any_failed(status)) return
      do j = 1, size(d, 2)
         where (status /= poinsot_ok) d(:, j) = 0
      end do
   end subroutine mask_failed_lanes

   !> y += b g + c G, G = 2 (Dg[M g] + (M g) x g).
   subroutine kick(self, t, b, c)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: t, b, c
      if (.not. self%fresh) then
         call self%start_torque(t)
         call self%finish_torque()
         self%fresh = .true.
      end if
      if (abs(c) > 0) then
         call self%start_gradient(t)
         call self%finish_gradient()
      end if
      call self%apply_kick(b, c)
   end subroutine kick

   !> g = the torques of the block's own effects at time t.
   subroutine start_torque(self, t)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: t
      integer :: i
      self%g = 0
      if (.not. allocated(self%torques)) return
      do i = 1, size(self%torques)
         call self%torques(i)%it%add_torque(self%class, t, self%q, self%g)
      end do
   end subroutine start_torque

   !> What others may have added to g is done: mask axes without inertia.
   subroutine finish_torque(self)
      class(block_flows), intent(inout) :: self
      call mask_massless_axes(self%class, self%g)
   end subroutine finish_torque

   !> gradient = Dg[M g] of the block's own effects; delta = M g.
   subroutine start_gradient(self, t)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: t
      integer :: i
      call reject_torque(self%class, self%g, self%status)
      do i = 1, 3
         self%delta(:, i) = self%class%inverse(i)*self%g(:, i)
      end do
      self%gradient = 0
      if (.not. allocated(self%torques)) return
      do i = 1, size(self%torques)
         call self%torques(i)%it%add_derivative(self%class, t, self%q, self%delta, self%gradient)
      end do
   end subroutine start_gradient

   !> gradient = G = 2 (Dg[M g] + (M g) x g), from Dg[M g].
   subroutine finish_gradient(self)
      class(block_flows), intent(inout) :: self
      integer :: l
      associate (dg => self%gradient, delta => self%delta, g => self%g)
         !GCC$ ivdep
         do l = 1, lanes
            dg(l, 1) = 2*(dg(l, 1) + (delta(l, 2)*g(l, 3) - delta(l, 3)*g(l, 2)))
            dg(l, 2) = 2*(dg(l, 2) + (delta(l, 3)*g(l, 1) - delta(l, 1)*g(l, 3)))
            dg(l, 3) = 2*(dg(l, 3) + (delta(l, 1)*g(l, 2) - delta(l, 2)*g(l, 1)))
         end do
      end associate
      call mask_massless_axes(self%class, self%gradient)
   end subroutine finish_gradient

   !> y += b g + c G with what stands in g and gradient.
   subroutine apply_kick(self, b, c)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: b, c
      real(dp) :: dy(lanes, 3)
      dy = b*self%g
      if (abs(c) > 0) dy = dy + c*self%gradient
      call mask_failed_lanes(self%status, dy)
      if (self%compensated) then
         call add_kick_compensated(dy, self%y, self%carry)
      else
         call add_kick(dy, self%y)
      end if
      call reject_speed(self%class, self%y, self%status)
   end subroutine apply_kick

   !> An axis without inertia takes no torque.
   pure subroutine mask_massless_axes(class, g)
      type(body_class), intent(in) :: class
      real(dp), intent(inout) :: g(lanes, 3)
      integer :: j
      do j = 1, 3
         if (.not. class%moments(j) > 0) g(:, j) = 0
      end do
   end subroutine mask_massless_axes

   !> Flows outside the scheme, in reverse order after the step.
   subroutine dissipative_half_step(self, h, step, half)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: h
      integer(i8), intent(in) :: step
      integer, intent(in) :: half
      integer :: i, k
      do i = 1, size(self%dissipative)
         k = merge(i, size(self%dissipative) + 1 - i, half == 0)
         call self%dissipative(k)%it%apply(self%class, h, self%seed, self%id, step, half, self%q, &
            self%y)
      end do
      call reject_speed(self%class, self%y, self%status)
   end subroutine dissipative_half_step

   !> Kinetic and potential energy of every lane at time t.
   subroutine energies(self, t, kinetic, potential)
      class(block_flows), intent(in) :: self
      real(dp), intent(in) :: t
      real(dp), intent(out) :: kinetic(lanes), potential(lanes)
      integer :: i, j
      kinetic = 0
      potential = 0
      if (allocated(self%rotor_sum)) then
         call self%rotor_sum%add_kinetic(self%class, self%y, kinetic)
      else
         do j = 1, 3
            kinetic = kinetic + 0.5_dp*(self%y(:, j)*self%class%inverse(j))*self%y(:, j)
         end do
      end if
      if (.not. allocated(self%torques)) return
      do i = 1, size(self%torques)
         call self%torques(i)%it%add_energy(self%class, t, self%q, potential)
      end do
   end subroutine energies

end module poinsot_splitting_block_flows
