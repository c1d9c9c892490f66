!> The stepper: runs any table of rotations and kicks over any system that provides them.
module poinsot_splitting_stepper
   use poinsot_core_kinds, only: dp, i8
   use poinsot_splitting_tableaux, only: splitting, operation
   implicit none(type, external)
   private
   public :: flows, glance, run_steps, apply_preprocessor, apply_postprocessor

   !> So small a part of a step that a jump within it is at the step's end: where times are added up
   !> they are off by some roundings.
   real(dp), parameter :: glance = 1e-9_dp

   !> What a splitting composes. The torque g is a function of attitude and time only: `kick`
   !> evaluates it when `fresh` is false, sets `fresh`, and leaves it; `drift` clears `fresh`. So
   !> the torque at the end of a step serves the start of the next (same attitudes, same time),
   !> while the two kicks stay two sums.
   !>
   !> Nothing has a default here: a block is made for every call, and filled.
   type, abstract :: flows
      logical :: fresh              !! is the stored torque that of the present attitudes?
      logical :: has_dissipation    !! is there a flow outside the scheme (drag, thermostat)?
      logical :: halted             !! set by a kick that cannot go on: no further flow is run
   contains
      procedure(drift), deferred :: drift
      procedure(kick), deferred :: kick
      procedure :: dissipative_half_step => no_dissipation
      procedure :: dissipate => no_dissipation_inside
   end type flows

   abstract interface
      !> Free rotation over h (any sign) from time t on, which a rotor that changes looks at.
      subroutine drift(self, t, h)
         import :: flows, dp
         implicit none(type, external)
         class(flows), intent(inout) :: self
         real(dp), intent(in) :: t
         real(dp), intent(in) :: h
      end subroutine drift

      !> y += b g + c G with g and G at time t.
      subroutine kick(self, t, b, c, ahead)
         import :: flows, dp
         implicit none(type, external)
         class(flows), intent(inout) :: self
         real(dp), intent(in) :: t
         real(dp), intent(in) :: b   !! coefficient times h
         real(dp), intent(in) :: c   !! coefficient times h^3; 0: no gradient is needed
         real(dp), intent(in) :: ahead !! at an end of the step, or beyond it, a way that leads just
                                       !! into it: there a torque that jumps is meant; else 0
      end subroutine kick
   end interface

contains

   !> Steps number first to first + steps - 1 of length h. Step k starts at t + k h, computed so and
   !> not by adding: ten steps at once are ten calls of one step, to the bit. A torque that is fresh
   !> on entry is used: whoever changes the state must clear the flag.
   subroutine run_steps(scheme, system, t, h, first, steps)
      type(splitting), intent(in) :: scheme !! its table
      class(flows), intent(inout) :: system !! what is moved
      real(dp), intent(in) :: t             !! time at which step 0 starts
      real(dp), intent(in) :: h             !! step, any sign
      integer(i8), intent(in) :: first      !! number of the first step
      integer(i8), intent(in) :: steps      !! how many
      integer(i8) :: k
      do k = first, first + steps - 1
         if (.not. system%has_dissipation) then
            call run_operations(scheme%operations, system, t, h, k)
         else if (scheme%middle > 0) then
            call run_operations(scheme%operations(:scheme%middle), system, t, h, k)
            if (system%halted) return
            call system%dissipate(t + (real(k, dp) + 0.5_dp)*h, h, k)
            call run_operations(scheme%operations(scheme%middle + 1:), system, t, h, k)
         else
            call system%dissipative_half_step(t + real(k, dp)*h, 0.5_dp*h, k, 0)
            call run_operations(scheme%operations, system, t, h, k)
            if (.not. system%halted) call system%dissipative_half_step(t + &
               real(k + 1, dp)*h, 0.5_dp*h, k, 1)
         end if
         if (system%halted) return
      end do
   end subroutine run_steps

   !> From the state to the variables of a processed kernel, before step `first`. Nothing for other
   !> schemes.
   subroutine apply_preprocessor(scheme, system, t, h, first)
      type(splitting), intent(in) :: scheme !! its table
      class(flows), intent(inout) :: system !! what is moved
      real(dp), intent(in) :: t, h
      integer(i8), intent(in) :: first
      system%fresh = .false.
      call run_operations(scheme%enter, system, t, h, first)
   end subroutine apply_preprocessor

   !> From the variables of a processed kernel to the state, before step `first`: for output, on a
   !> copy.
   subroutine apply_postprocessor(scheme, system, t, h, first)
      type(splitting), intent(in) :: scheme !! its table
      class(flows), intent(inout) :: system !! what is moved
      real(dp), intent(in) :: t, h
      integer(i8), intent(in) :: first
      system%fresh = .false.
      call run_operations(scheme%leave, system, t, h, first)
   end subroutine apply_postprocessor

   !> One pass through a table. A node of exactly 1 in step k and of 0 in step k + 1 give the same
   !> time.
   subroutine run_operations(operations, system, t, h, k)
      type(operation), intent(in) :: operations(:)
      class(flows), intent(inout) :: system
      real(dp), intent(in) :: t, h
      integer(i8), intent(in) :: k
      real(dp) :: ahead
      integer :: i
      do i = 1, size(operations)
         if (operations(i)%is_kick) then
            ahead = 0
            if (operations(i)%node <= 0) ahead = (glance - operations(i)%node)*h
            if (operations(i)%node >= 1) ahead = (1 - operations(i)%node - glance)*h
            call system%kick(t + (real(k, dp) + operations(i)%node)*h, operations(i)%b*h, &
                             operations(i)%c*h*h*h, ahead)
         else
            call system%drift(t + (real(k, dp) + operations(i)%node)*h, operations(i)%b*h)
         end if
         if (system%halted) return
      end do
   end subroutine run_operations

   !> No flow outside the scheme.
   subroutine no_dissipation(self, t, h, step, half)
      class(flows), intent(inout) :: self
      real(dp), intent(in) :: t           !! time
      real(dp), intent(in) :: h           !! half the step
      integer(i8), intent(in) :: step
      integer, intent(in) :: half         !! 0 before the step, 1 after it
      associate (unused_1 => self%fresh, unused_2 => h, unused_3 => step, &
         unused_4 => half, unused_5 => t)
      end associate
   end subroutine no_dissipation

   subroutine no_dissipation_inside(self, t, h, step)
      class(flows), intent(inout) :: self
      real(dp), intent(in) :: t           !! time
      real(dp), intent(in) :: h           !! the whole step
      integer(i8), intent(in) :: step
      associate (unused_1 => self%fresh, unused_2 => h, unused_3 => step, &
         unused_4 => t)
      end associate
   end subroutine no_dissipation_inside

end module poinsot_splitting_stepper
