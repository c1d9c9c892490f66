!> Effects: four kinds, distinguished by how they enter a step (mathematics.md sections 5 to 7).
!>
!> A torque effect is a kick; a flow effect acts before and after the whole step; a gyrostat
!> (gyrostat.f90) changes the drift; a pair effect is a kick that couples bodies. All work on blocks
!> of one body class, in its principal frame. Torques add. Scalars that depend only on time or class
!> are computed once per call; code for lanes does not call libm.
module poinsot_effect_effect
   use poinsot_core_kinds, only: dp, i8, lanes, name_length
   use poinsot_body_class, only: body_class
   use poinsot_effect_settings, only: setting
   use poinsot_effect_terms, only: torque_terms
   use poinsot_effect_traits, only: effect_traits
   implicit none(type, external)
   private
   public :: effect, torque_effect, flow_effect, pair_effect, effect_item

   !> Any effect.
   type, abstract :: effect
      character(name_length) :: name = ""     !! its name in the registry
      integer :: class_index = 0     !! the body class it acts on, counted from 1; 0 = all of them
   contains
      procedure :: acts_on
      procedure :: uses_moments => no_moments
      procedure :: add_terms => add_no_terms
      procedure :: get_traits => get_no_traits
   end type effect

   !> A container for one effect of any kind, so that effects can be in an array.
   type :: effect_item
      class(effect), allocatable :: it
      type(setting), allocatable :: settings(:) !! it was made from; a program's own has none
   end type effect_item

   !> A torque that depends on attitude and time: a kick.
   type, abstract, extends(effect) :: torque_effect
   contains
      procedure(add_torque), deferred :: add_torque
      procedure(add_energy), deferred :: add_energy
      procedure :: has_gradient => has_no_gradient
      procedure :: add_derivative => add_no_derivative
      procedure :: jumps => never_jumps
      procedure :: seen => seen_at_once
   end type torque_effect

   !> An exact flow outside the splitting: O(h/2) [scheme(h)] O(h/2), order 2 whatever the scheme.
   type, abstract, extends(effect) :: flow_effect
   contains
      procedure(apply), deferred :: apply
      procedure :: uses_moments => moments_of_flow
      procedure :: only_forward => not_only_forward
   end type flow_effect

   !> A torque that couples bodies. Two passes: every block writes what the others need
   !> (`scatter_source`, into its bodies' columns of `sources`), then every block takes its torque
   !> from all columns (`add_torque`). Columns are summed in the caller's body order, so that the
   !> torque does not depend on which bodies share a block.
   type, abstract, extends(effect) :: pair_effect
   contains
      procedure(scatter_source), deferred :: scatter_source
      procedure(add_pair_torque), deferred :: add_torque
      procedure(add_pair_energy), deferred :: add_energy
      procedure(count_bodies), deferred :: bodies
      procedure :: add_torques
      procedure :: add_energies
      procedure :: has_gradient => pair_has_no_gradient
      procedure :: scatter_change => scatter_no_change
      procedure :: add_derivative => add_no_pair_derivative
      procedure :: add_derivatives
   end type pair_effect

   abstract interface
      !> g += body torque of every lane at time t.
      subroutine add_torque(self, class, t, q, g)
         import :: torque_effect, body_class, dp, lanes
         implicit none(type, external)
         class(torque_effect), intent(in) :: self
         type(body_class), intent(in) :: class
         real(dp), intent(in) :: t               !! time
         real(dp), intent(in) :: q(lanes, 4)     !! attitudes
         real(dp), intent(inout) :: g(lanes, 3)  !! body torques
      end subroutine add_torque

      !> u += potential energy of every lane at time t; a torque without potential adds nothing.
      subroutine add_energy(self, class, t, q, u)
         import :: torque_effect, body_class, dp, lanes
         implicit none(type, external)
         class(torque_effect), intent(in) :: self
         type(body_class), intent(in) :: class
         real(dp), intent(in) :: t
         real(dp), intent(in) :: q(lanes, 4)
         real(dp), intent(inout) :: u(lanes)     !! energies
      end subroutine add_energy

      !> The flow over a time h: half the step, before it (half = 0) and after it (half = 1).
      subroutine apply(self, class, h, seed, id, step, half, q, y, scale)
         import :: flow_effect, body_class, dp, i8, lanes
         implicit none(type, external)
         class(flow_effect), intent(in) :: self
         type(body_class), intent(in) :: class
         real(dp), intent(in) :: h               !! length of the flow: half the step
         integer(i8), intent(in) :: seed         !! of the plan
         integer(i8), intent(in) :: id(lanes)    !! of the bodies
         integer(i8), intent(in) :: step         !! number of the step
         integer, intent(in) :: half             !! tells draws of one step apart: 0 before it and
                                                 !! in its middle, 1 after it, 2 and on: the next
                                                 !! thermostat's
         real(dp), intent(in) :: q(lanes, 4)     !! attitudes: a torque at them stays valid
         real(dp), intent(inout) :: y(lanes, 3)  !! angular momenta
         real(dp), intent(in), optional :: scale(lanes) !! moments over those of the class; absent:
                                                        !! they are those of the class
      end subroutine apply

      !> sources(:, body(i)) = what the other bodies need to know of lane i; body = 0 is padding.
      subroutine scatter_source(self, number, body, q, sources)
         import :: pair_effect, dp, lanes
         implicit none(type, external)
         class(pair_effect), intent(in) :: self
         integer, intent(in) :: number             !! number of the body class of this block
         integer, intent(in) :: body(lanes)        !! number of the body in the caller's order
         real(dp), intent(in) :: q(lanes, 4)
         real(dp), intent(inout) :: sources(:, :)  !! (3, bodies)
      end subroutine scatter_source

      !> g += body torque of every lane, from all sources.
      subroutine add_pair_torque(self, number, body, q, sources, g)
         import :: pair_effect, dp, lanes
         implicit none(type, external)
         class(pair_effect), intent(in) :: self
         integer, intent(in) :: number
         integer, intent(in) :: body(lanes)
         real(dp), intent(in) :: q(lanes, 4)
         real(dp), intent(in) :: sources(:, :)
         real(dp), intent(inout) :: g(lanes, 3)
      end subroutine add_pair_torque

      !> u += half the energy each lane has with all others: the sum over bodies is the energy.
      subroutine add_pair_energy(self, number, body, q, sources, u)
         import :: pair_effect, dp, lanes
         implicit none(type, external)
         class(pair_effect), intent(in) :: self
         integer, intent(in) :: number
         integer, intent(in) :: body(lanes)
         real(dp), intent(in) :: q(lanes, 4)
         real(dp), intent(in) :: sources(:, :)
         real(dp), intent(inout) :: u(lanes)
      end subroutine add_pair_energy

      !> How many bodies the effect has positions for; 0 = any number.
      pure integer function count_bodies(self)
         import :: pair_effect
         implicit none(type, external)
         class(pair_effect), intent(in) :: self
      end function count_bodies
   end interface

contains

   !> The effect as data for the Taylor integrator, added to those of the others; `served` is false,
   !> and nothing added, if it is none: pairs, noise, a program's own torques.
   pure subroutine add_no_terms(self, class, terms, served)
      class(effect), intent(in) :: self
      type(body_class), intent(in) :: class        !! of the bodies it acts on
      type(torque_terms), intent(inout) :: terms
      logical, intent(out) :: served
      associate (unused_1 => self%class_index, unused_2 => class%moments, &
         unused_3 => terms%friction)
      end associate
      served = .false.
   end subroutine add_no_terms

   !> What it is to a whole run. Of an effect that does not say, the worst is taken.
   pure subroutine get_no_traits(self, traits)
      class(effect), intent(in) :: self
      type(effect_traits), intent(out) :: traits
      associate (unused => self%class_index)
      end associate
      traits%energy = .false. ! and the other defaults
   end subroutine get_no_traits

   !> Has the derivative of the torque in closed form? Schemes with a force gradient need it.
   pure logical function has_no_gradient(self)
      class(torque_effect), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      has_no_gradient = .false.
   end function has_no_gradient

   !> Does the torque jump in time?
   pure logical function never_jumps(self)
      class(torque_effect), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      never_jumps = .false.
   end function never_jumps

   !> The time to ask a torque about that may jump, for who stands at t and looks ahead
   !> (time_table%seen).
   pure real(dp) function seen_at_once(self, t, ahead)
      class(torque_effect), intent(in) :: self
      real(dp), intent(in) :: t, ahead
      associate (unused_1 => self%class_index, unused_2 => ahead)
      end associate
      seen_at_once = t
   end function seen_at_once

   !> dg += Dg[delta], the change of the body torque along Q -> Q exp(hat(delta)) (mathematics.md
   !> section 6).
   subroutine add_no_derivative(self, class, t, q, delta, dg)
      class(torque_effect), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: delta(lanes, 3)  !! rotation vectors in the body frame
      real(dp), intent(inout) :: dg(lanes, 3)
      associate (unused_1 => self%class_index, unused_2 => class%moments, unused_3 => t, &
         unused_4 => q, unused_5 => delta, unused_6 => dg)
      end associate
   end subroutine add_no_derivative

   !> Is the flow defined for h > 0 only? A run backwards in time is then refused.
   pure logical function not_only_forward(self)
      class(flow_effect), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      not_only_forward = .false.
   end function not_only_forward

   pure logical function pair_has_no_gradient(self)
      class(pair_effect), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      pair_has_no_gradient = .false.
   end function pair_has_no_gradient

   !> changes(:, body(i)) = change of the source along Q -> Q exp(hat(delta)): first pass of
   !> Dg[delta].
   subroutine scatter_no_change(self, number, body, q, delta, changes)
      class(pair_effect), intent(in) :: self
      integer, intent(in) :: number
      integer, intent(in) :: body(lanes)
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: delta(lanes, 3)
      real(dp), intent(inout) :: changes(:, :)   !! (3, bodies)
      associate (unused_1 => self%class_index, unused_2 => number, unused_3 => body, &
         unused_4 => q, unused_5 => delta, unused_6 => changes)
      end associate
   end subroutine scatter_no_change

   !> dg += Dg[delta] from all sources and all their changes: second pass.
   subroutine add_no_pair_derivative(self, number, body, q, delta, sources, changes, dg)
      class(pair_effect), intent(in) :: self
      integer, intent(in) :: number
      integer, intent(in) :: body(lanes)
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: delta(lanes, 3)
      real(dp), intent(in) :: sources(:, :), changes(:, :)
      real(dp), intent(inout) :: dg(lanes, 3)
      associate (unused_1 => self%class_index, unused_2 => number, unused_3 => body, &
         unused_4 => q, unused_5 => delta, unused_6 => sources, unused_7 => changes, unused_8 => dg)
      end associate
   end subroutine add_no_pair_derivative

   !> Does it depend on the moments of inertia? A torque that does must be proportional to them, and
   !> to those of the class: bodies that are a number of times as heavy get so many times the
   !> torque.
   pure logical function no_moments(self)
      class(effect), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      no_moments = .false.
   end function no_moments

   pure logical function moments_of_flow(self)
      class(flow_effect), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      moments_of_flow = .true.
   end function moments_of_flow

   !> Does an effect act on a body class?
   pure logical function acts_on(self, number)
      class(effect), intent(in) :: self
      integer, intent(in) :: number   !! of the body class, from 1
      acts_on = self%class_index == 0 .or. self%class_index == number
   end function acts_on

   !> Both passes over all blocks, serial: g += body torques. A host with threads calls the passes
   !> itself.
   subroutine add_torques(self, number, body, q, sources, g)
      class(pair_effect), intent(in) :: self
      integer, intent(in) :: number(:)           !! (blocks): body class of each block
      integer, intent(in) :: body(:, :) !! (lanes, blocks): number of the body, 0 for padding
      real(dp), intent(in) :: q(:, :, :)         !! (lanes, 4, blocks)
      real(dp), intent(inout) :: sources(:, :)   !! (3, bodies), work space
      real(dp), intent(inout) :: g(:, :, :)      !! (lanes, 3, blocks)
      integer :: k
      call scatter_sources(self, number, body, q, sources)
      do k = 1, size(number)
         if (self%acts_on(number(k))) call self%add_torque(number(k), body(:, k), q(:, :, k), &
            sources, g(:, :, k))
      end do
   end subroutine add_torques

   !> Both passes for the energy: u += energies.
   subroutine add_energies(self, number, body, q, sources, u)
      class(pair_effect), intent(in) :: self
      integer, intent(in) :: number(:)
      integer, intent(in) :: body(:, :)
      real(dp), intent(in) :: q(:, :, :)
      real(dp), intent(inout) :: sources(:, :)
      real(dp), intent(inout) :: u(:, :)         !! (lanes, blocks)
      integer :: k
      call scatter_sources(self, number, body, q, sources)
      do k = 1, size(number)
         if (self%acts_on(number(k))) call self%add_energy(number(k), body(:, k), q(:, :, k), &
            sources, u(:, k))
      end do
   end subroutine add_energies

   !> Both passes for the derivative, after add_torques has scattered the sources: dg += Dg[delta].
   subroutine add_derivatives(self, number, body, q, delta, sources, changes, dg)
      class(pair_effect), intent(in) :: self
      integer, intent(in) :: number(:)
      integer, intent(in) :: body(:, :)
      real(dp), intent(in) :: q(:, :, :)
      real(dp), intent(in) :: delta(:, :, :) !! (lanes, 3, blocks): rotation vectors, body frames
      real(dp), intent(in) :: sources(:, :)
      real(dp), intent(inout) :: changes(:, :)   !! (3, bodies), work space
      real(dp), intent(inout) :: dg(:, :, :)
      integer :: k
      changes = 0
      do k = 1, size(number)
         if (self%acts_on(number(k))) call self%scatter_change(number(k), body(:, k), q(:, :, k), &
            delta(:, :, k), changes)
      end do
      do k = 1, size(number)
         if (self%acts_on(number(k))) call self%add_derivative(number(k), body(:, k), q(:, :, k), &
            delta(:, :, k), sources, changes, dg(:, :, k))
      end do
   end subroutine add_derivatives

   subroutine scatter_sources(self, number, body, q, sources)
      class(pair_effect), intent(in) :: self
      integer, intent(in) :: number(:)
      integer, intent(in) :: body(:, :)
      real(dp), intent(in) :: q(:, :, :)
      real(dp), intent(inout) :: sources(:, :)
      integer :: k
      sources = 0
      do k = 1, size(number)
         if (self%acts_on(number(k))) call self%scatter_source(number(k), body(:, k), &
            q(:, :, k), sources)
      end do
   end subroutine scatter_sources

end module poinsot_effect_effect
