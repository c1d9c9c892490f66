!> One block of bodies of one class: their state, and the flows that a splitting composes.
!>
!> The block owns y, q, carry, status and id from the moment they are loaded until they are stored;
!> all flows act on them here. The effects on the class were composed when the plan was made ready
!> (poinsot_splitting_class_flows), and are accessed through pointers during a call.
module poinsot_splitting_block_flows
   use poinsot_core_kinds, only: dp, i8, groups, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_step
   use poinsot_core_lanes, only: any_failed
   use poinsot_body_class, only: body_class, rotor_at
   use poinsot_core_length, only: length_of
   use poinsot_free_accumulate, only: add_plain, add_compensated, add_kick, add_kick_compensated
   use poinsot_free_lane_moments, only: lane_moments, advance_by_lane
   use poinsot_free_limits, only: reject_speed, reject_speed_each, reject_torque
   use poinsot_free_method, only: free_method, advance
   use poinsot_effect_effect, only: effect_item, torque_effect, flow_effect
   use poinsot_effect_gyrostat, only: turn_increment, turn_is_too_long, add_kinetic
   use poinsot_splitting_class_flows, only: class_flows
   use poinsot_splitting_stepper, only: flows, glance
   implicit none(type, external)
   private
   public :: block_flows

   !> What is not asked for is not filled: `id`, `carry`, `at`, all work space, and what `attach`
   !> sets. Nothing has a default, which would be copied with all the rest for every chunk.
   ! allow(C101)
   type, extends(flows) :: block_flows
      ! 12 bytes stand before: the arrays begin at lines of the cache, as the block does
      integer :: filler(13)
      real(dp) :: y(lanes, 3)                 !! angular momenta, principal frame
      real(dp) :: q(lanes, 4)                 !! attitudes
      real(dp) :: carry(lanes, 7)             !! compensated sums, used if `compensated`
      integer(i8) :: id(lanes)                !! of the bodies, for random numbers
      integer :: status(lanes)                !! a lane that is not ok stands still
      logical :: compensated
      integer :: n                            !! bodies in it; the other lanes are padding at rest
      integer :: nvec                         !! groups of lanes that hold them
      integer :: at(lanes)
      !! where each stands in the caller's arrays; 0: padding
      integer :: number                       !! of the body class
      logical :: stored                       !! the caller's arrays have the result already
      logical :: drops                        !! momentum about an axis without inertia was dropped
      logical :: dropped(lanes)               !! in these lanes, if so
      type(body_class), pointer :: class
      type(lane_moments), pointer :: by_lane !! moments that are not those of the class
      ! set by `attach`: what acts on it
      type(free_method), pointer :: method
      type(class_flows), pointer :: acting
      type(effect_item), pointer :: effects(:) !! of the plan
      integer(i8) :: seed                     !! of random numbers
      ! work space
      real(dp) :: g(lanes, 3)                 !! body torque, valid if `fresh`
      real(dp) :: delta(lanes, 3)             !! M g, while a force gradient is made
      real(dp) :: gradient(lanes, 3)          !! force gradient G
   contains
      procedure :: attach
      procedure :: drift
      procedure :: kick
      procedure :: dissipative_half_step
      procedure :: dissipate
      procedure :: energies
      procedure :: start_torque
      procedure :: finish_torque
      procedure :: start_gradient
      procedure :: finish_gradient
      procedure :: apply_kick
      procedure :: reject_fast
      procedure :: has_massless
      procedure :: mask_massless_axes
   end type block_flows

contains

   !> Attach the effects on the bodies. Nothing may be moved while the block is in use.
   subroutine attach(self, class, method, acting, effects, seed)
      class(block_flows), intent(inout) :: self
      type(body_class), intent(in), target :: class
      type(free_method), intent(in), target :: method
      type(class_flows), intent(in), target :: acting
      type(effect_item), intent(in), target :: effects(:)
      integer(i8), intent(in) :: seed
      self%class => class
      self%method => method
      self%acting => acting
      self%effects => effects
      self%seed = seed
      self%fresh = .false.
      self%halted = .false.
      self%has_dissipation = size(acting%dissipative) > 0
   end subroutine attach

   !> Free rotation over h; with a rotor composed with its turn, of which each looks at the rotor at
   !> the time that the free rotations before it have reached.
   subroutine drift(self, t, h)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: t, h
      real(dp) :: passed
      integer :: i, n
      self%fresh = .false.
      if (.not. self%class%has_rotor) then
         call rotate(self, h)
         return
      end if
      passed = 0
      associate (weights => self%acting%weights)
         n = size(weights)
         call turn(self, t, glance*h, 0.5_dp*weights(1)*h)
         do i = 1, n - 1
            call rotate(self, weights(i)*h)
            passed = passed + weights(i)
            call turn(self, t + passed*h, 0.0_dp, 0.5_dp*(weights(i) + weights(i + 1))*h)
         end do
         call rotate(self, weights(n)*h)
         call turn(self, t + h, -glance*h, 0.5_dp*weights(n)*h)
      end associate
   end subroutine drift

   subroutine rotate(self, h)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: h
      if (associated(self%by_lane)) then
         call rotate_by_lane(self, h)
      else if (self%compensated) then
         call advance(self%method, self%class, h, self%y, self%q, self%status, self%carry, &
                      nvec=self%nvec)
      else
         call advance(self%method, self%class, h, self%y, self%q, self%status, nvec=self%nvec)
      end if
   end subroutine rotate

   !> The same for bodies with moments of their own.
   subroutine rotate_by_lane(self, h)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: h
      if (self%compensated) then
         call advance_by_lane(self%by_lane, self%method, self%class, h, 1, self%y, self%q, &
                              self%status, self%nvec, self%carry)
      else
         call advance_by_lane(self%by_lane, self%method, self%class, h, 1, self%y, self%q, &
                              self%status, self%nvec)
      end if
   end subroutine rotate_by_lane

   !> The turn of the rotor. One whose angle has no right digit: POINSOT_E_STEP.
   subroutine turn(self, t, ahead, h)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: t, ahead        !! time, of rotors that change
      real(dp), intent(in) :: h
      real(dp) :: dy(lanes, 3), dq(lanes, 4), hl(lanes), rotor(3), rate
      rotor = self%class%rotor
      rate = self%class%rotor_rate
      if (allocated(self%class%rotor_tables)) then
         rotor = rotor_at(self%class, t, ahead)
         rate = length_of(self%class%inverse*rotor)
      end if
      if (associated(self%by_lane)) then
         where (self%status == poinsot_ok .and. turn_is_too_long(rate, h, self%by_lane%scale)) &
            self%status = poinsot_e_step
         call turn_increment(rotor, rate, self%class%inverse, h, self%y, self%q, dy, dq, &
            self%by_lane%scale)
      else if (turn_is_too_long(rate, h)) then
         where (self%status == poinsot_ok) self%status = poinsot_e_step
         return
      else
         call turn_increment(rotor, rate, self%class%inverse, h, self%y, self%q, dy, dq)
      end if
      hl = merge(h, 0.0_dp, self%status == poinsot_ok)
      call mask_failed_lanes(self%status, dy)
      call mask_failed_lanes(self%status, dq)
      if (self%compensated) then
         call add_compensated(hl, dy, dq, self%y, self%q, self%carry)
      else
         call add_plain(hl, dy, dq, self%y, self%q)
      end if
   end subroutine turn

   !> Zero in every inactive lane.
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
   subroutine kick(self, t, b, c, ahead)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: t, b, c, ahead
      if (.not. self%fresh .or. (self%acting%jumps .and. abs(ahead) > 0)) then
         call self%start_torque(t, ahead)
         call self%finish_torque()
         self%fresh = .true.
      end if
      if (abs(c) > 0) then
         call self%start_gradient(t, ahead)
         call self%finish_gradient()
      end if
      call self%apply_kick(b, c)
   end subroutine kick

   !> g = the torques of the block's own effects at time t.
   subroutine start_torque(self, t, ahead)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: t, ahead
      integer :: i
      self%g = 0
      do i = 1, size(self%acting%torques)
         select type (one => self%effects(self%acting%torques(i))%it)
         class is (torque_effect)
            if (grows(self, one)) then
               call add_grown_torque(self, one, one%seen(t, ahead))
            else
               call one%add_torque(self%class, one%seen(t, ahead), self%q, self%g)
            end if
         end select
      end do
   end subroutine start_torque

   !> Is a torque as many times that of the class as the moments are?
   pure logical function grows(self, one)
      class(block_flows), intent(in) :: self
      class(torque_effect), intent(in) :: one
      grows = associated(self%by_lane)
      if (grows) grows = one%uses_moments()
   end function grows

   subroutine add_grown_torque(self, one, t)
      class(block_flows), intent(inout) :: self
      class(torque_effect), intent(in) :: one
      real(dp), intent(in) :: t
      real(dp) :: g(lanes, 3)
      integer :: j
      g = 0
      call one%add_torque(self%class, t, self%q, g)
      do j = 1, 3
         self%g(:, j) = self%g(:, j) + self%by_lane%scale*g(:, j)
      end do
   end subroutine add_grown_torque

   !> What others may have added to g is done: mask axes without inertia.
   subroutine finish_torque(self)
      class(block_flows), intent(inout) :: self
      call self%mask_massless_axes(self%g)
   end subroutine finish_torque

   !> gradient = Dg[M g] of the block's own effects; delta = M g.
   subroutine start_gradient(self, t, ahead)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: t, ahead
      real(dp) :: dg(lanes, 3)
      integer :: i, j
      if (associated(self%by_lane)) then
         call reject_torque(self%class, self%g, self%status, self%by_lane%scale)
         self%delta = self%by_lane%inverse*self%g
      else
         call reject_torque(self%class, self%g, self%status)
         do i = 1, 3
            self%delta(:, i) = self%class%inverse(i)*self%g(:, i)
         end do
      end if
      self%gradient = 0
      do i = 1, size(self%acting%torques)
         select type (one => self%effects(self%acting%torques(i))%it)
         class is (torque_effect)
            if (grows(self, one)) then
               dg = 0
               call one%add_derivative(self%class, one%seen(t, ahead), self%q, self%delta, dg)
               do j = 1, 3
                  self%gradient(:, j) = self%gradient(:, j) + self%by_lane%scale*dg(:, j)
               end do
            else
               call one%add_derivative(self%class, one%seen(t, ahead), self%q, self%delta, &
                  self%gradient)
            end if
         end select
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
      call self%mask_massless_axes(self%gradient)
   end subroutine finish_gradient

   !> y += b g + c G, with the contents of g and gradient.
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
      call self%reject_fast()
   end subroutine apply_kick

   !> Bodies that turn faster than any may.
   pure subroutine reject_fast(self)
      class(block_flows), intent(inout) :: self
      if (associated(self%by_lane)) then
         call reject_speed_each(self%by_lane%limit, self%y, self%status, groups)
      else
         call reject_speed(self%class, self%y, self%status)
      end if
   end subroutine reject_fast

   !> Has a body no inertia about some axis?
   pure logical function has_massless(self)
      class(block_flows), intent(in) :: self
      if (associated(self%by_lane)) then
         has_massless = self%by_lane%linear
      else
         has_massless = .not. all(self%class%moments > 0)
      end if
   end function has_massless

   !> An axis without inertia takes no torque.
   pure subroutine mask_massless_axes(self, g)
      class(block_flows), intent(in) :: self
      real(dp), intent(inout) :: g(lanes, 3)
      integer :: j
      if (associated(self%by_lane)) then
         if (self%by_lane%linear) where (.not. self%by_lane%moments > 0) g = 0
         return
      end if
      do j = 1, 3
         if (.not. self%class%moments(j) > 0) g(:, j) = 0
      end do
   end subroutine mask_massless_axes

   !> All of drag and noise of step number `step`, in one place: one exact flow over h, or several
   !> as a symmetric composition.
   subroutine dissipate(self, t, h, step)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: t, h
      integer(i8), intent(in) :: step
      if (size(self%acting%dissipative) == 1) then
         call self%dissipative_half_step(t, h, step, 0)
      else
         call self%dissipative_half_step(t, 0.5_dp*h, step, 0)
         call self%dissipative_half_step(t, 0.5_dp*h, step, 1)
      end if
   end subroutine dissipate

   !> Flows outside the scheme, in reverse order after the step. They act on I omega = y - s, what
   !> damps and heats a body with a rotor. Each has random numbers of its own.
   subroutine dissipative_half_step(self, t, h, step, half)
      class(block_flows), intent(inout) :: self
      real(dp), intent(in) :: t, h
      integer(i8), intent(in) :: step
      integer, intent(in) :: half
      real(dp) :: rotor(3)
      integer :: i, place, n
      n = size(self%acting%dissipative)
      if (self%class%has_rotor) then
         rotor = rotor_at(self%class, t, merge(glance, -glance, half == 0)*h)
         call add_rotor(-rotor, self%y)
      end if
      do i = 1, n
         place = merge(i, n + 1 - i, half == 0)
         select type (one => self%effects(self%acting%dissipative(place))%it)
         class is (flow_effect)
            if (associated(self%by_lane)) then
               call one%apply(self%class, h, self%seed, self%id, step, half + 2*(place - 1), &
                              self%q, self%y, self%by_lane%scale)
            else
               call one%apply(self%class, h, self%seed, self%id, step, half + 2*(place - 1), &
                              self%q, self%y)
            end if
         end select
      end do
      if (self%class%has_rotor) call add_rotor(rotor, self%y)
      call self%reject_fast()
   end subroutine dissipative_half_step

   pure subroutine add_rotor(rotor, y)
      real(dp), intent(in) :: rotor(3)
      real(dp), intent(inout) :: y(lanes, 3)
      integer :: j
      do j = 1, 3
         y(:, j) = y(:, j) + rotor(j)
      end do
   end subroutine add_rotor

   !> Kinetic and potential energy of every lane at time t.
   subroutine energies(self, t, kinetic, potential)
      class(block_flows), intent(in) :: self
      real(dp), intent(in) :: t
      real(dp), intent(out) :: kinetic(lanes), potential(lanes)
      real(dp) :: inverse(lanes, 3), u(lanes)
      integer :: i, j
      kinetic = 0
      potential = 0
      inverse = spread(self%class%inverse, 1, lanes)
      if (associated(self%by_lane)) inverse = self%by_lane%inverse
      if (self%class%has_rotor) then
         call add_kinetic(rotor_at(self%class, t, 0.0_dp), inverse, self%y, kinetic)
      else
         do j = 1, 3
            kinetic = kinetic + 0.5_dp*(self%y(:, j)*inverse(:, j))*self%y(:, j)
         end do
      end if
      do i = 1, size(self%acting%torques)
         select type (one => self%effects(self%acting%torques(i))%it)
         class is (torque_effect)
            if (grows(self, one)) then
               u = 0
               call one%add_energy(self%class, t, self%q, u)
               potential = potential + self%by_lane%scale*u
            else
               call one%add_energy(self%class, t, self%q, potential)
            end if
         end select
      end do
   end subroutine energies

end module poinsot_splitting_block_flows
