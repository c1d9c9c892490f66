!> The effects on the bodies of one class: composed once, when a plan is made ready, and never
!> changed.
module poinsot_splitting_class_flows
   use poinsot_core_length, only: length_of
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_memory, poinsot_e_method
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_body_class, only: body_class
   use poinsot_effect_effect, only: effect_item, torque_effect, flow_effect
   use poinsot_effect_gyrostat, only: gyrostat
   use poinsot_splitting_tableaux, only: splitting, turn_composition
   implicit none(type, external)
   private
   public :: class_flows, compose_class

   !> Effects by their places in the plan's list. What is not there costs nothing.
   type :: class_flows
      integer, allocatable :: torques(:)      !! kicks; size 0: the scheme is the free rotation
      integer, allocatable :: dissipative(:)  !! flows outside the scheme
      real(dp), allocatable :: weights(:)     !! composition of free rotation and a rotor's turn
      logical :: only_forward = .false.       !! a flow is not defined for h < 0
      logical :: jumps = .false.              !! a torque jumps in time
   end type class_flows

contains

   !> Sort the effects that act on a body class, and give the class the sum of their rotors.
   !> POINSOT_E_METHOD if the scheme needs a force gradient that an effect does not have. Pair
   !> effects are not taken: they need all blocks.
   subroutine compose_class(class, acting, scheme, effects, composed, error)
      type(body_class), intent(inout) :: class         !! gets its rotor
      integer, intent(in) :: acting(:)                 !! places of the effects that act on it
      type(splitting), intent(in) :: scheme
      type(effect_item), intent(in) :: effects(:)      !! of the plan
      type(class_flows), intent(out) :: composed
      type(poinsot_error), intent(inout) :: error
      integer :: i, k, state
      allocate (composed%torques(0), composed%dissipative(0), stat=state)
      if (state /= 0) then
         call raise(error, poinsot_e_memory, "no memory for the flows of the body classes")
         return
      end if
      class%rotor = 0
      class%rotor_rate = 0
      class%has_rotor = .false.
      if (allocated(class%rotor_tables)) deallocate (class%rotor_tables)
      do k = 1, size(acting)
         i = acting(k)
         select type (one => effects(i)%it)
         class is (torque_effect)
            if (scheme%needs_gradient .and. .not. one%has_gradient()) then
               call raise(error, poinsot_e_method, "splitting '" // trim(scheme%name) // &
                          "' needs a force gradient, which effect '" // trim(one%name) // &
                          "' does not have; srkn4 and srkn6 need none")
               return
            end if
            composed%torques = [composed%torques, i]
            composed%jumps = composed%jumps .or. one%jumps()
         class is (flow_effect)
            composed%dissipative = [composed%dissipative, i]
            composed%only_forward = composed%only_forward .or. one%only_forward()
         class is (gyrostat)
            call add_rotor(one, scheme%order, class, composed, error)
            if (raised(error)) return
         end select
      end do
   end subroutine compose_class

   !> Momenta of rotors add.
   subroutine add_rotor(one, order, class, composed, error)
      type(gyrostat), intent(in) :: one
      integer, intent(in) :: order                     !! of the scheme
      type(body_class), intent(inout) :: class
      type(class_flows), intent(inout) :: composed
      type(poinsot_error), intent(inout) :: error
      real(dp) :: most(3), sum_of(3)
      most = abs(one%rotor)
      if (allocated(one%table)) most = maxval(abs(one%table%values), dim=2)
      sum_of = abs(class%rotor)
      if (allocated(class%rotor_tables)) sum_of = sum_of + class%rotor_tables%bound()
      if (class%sorted(1) <= 0 .and. any(most > 0)) then
         call raise(error, poinsot_e_domain, "effect 'gyrostat': a linear body, which has a " // &
            "moment of zero, holds no rotor; name another class by key 'class'")
         return
      end if
      if (any(most > class%limit - sum_of)) then
         call raise(error, poinsot_e_domain, "effect 'gyrostat': the rotor's momentum over the " &
            // "moment of inertia is beyond 1e70, the largest angular velocity")
         return
      end if
      class%rotor = class%rotor + one%rotor
      if (allocated(one%table)) then
         if (.not. allocated(class%rotor_tables)) allocate (class%rotor_tables)
         call class%rotor_tables%append(one%table)
      end if
      class%rotor_rate = length_of(class%inverse*class%rotor)
      class%has_rotor = .true.
      if (.not. allocated(composed%weights)) call turn_composition(order, composed%weights)
   end subroutine add_rotor

end module poinsot_splitting_class_flows
