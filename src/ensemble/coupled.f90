!> Steps of bodies that interact, by pair effects or the host's callback.
module poinsot_ensemble_coupled
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_rounding, only: rounds_to_nearest
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_callback, poinsot_e_memory, &
      poinsot_e_partial
   use poinsot_ensemble_block, only: clock, reject_energies
   use poinsot_ensemble_bodies, only: body_view
   use poinsot_ensemble_chunk, only: reject_chunk
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_ensemble_system, only: torque_callback, ensemble_flows, scatter_all, add_pairs
   use poinsot_ensemble_gather, only: saved_state, gather_all, store_all, save_state, restore_state
   use poinsot_splitting_stepper, only: glance, run_steps, apply_preprocessor, apply_postprocessor
   implicit none(type, external)
   private
   public :: torque_callback, run_coupled, coupled_energy

contains

   !> Steps of all bodies with pair effects and callback. See step_bodies.
   subroutine run_coupled(plan, view, t, h, first, steps, status, error, callback)
      type(poinsot_plan), intent(in), target :: plan !! ready
      type(body_view), intent(in) :: view            !! the caller's arrays
      real(dp), intent(in) :: t, h                   !! time; length of a step
      integer(i8), intent(in) :: first, steps        !! number of the first step; how many
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      class(torque_callback), intent(inout), optional, target :: callback
      type(ensemble_flows), target :: system
      type(saved_state), allocatable :: before(:)
      integer(i8) :: k
      integer :: state
      logical :: failed

      failed = .false.
      if (.not. rounds_to_nearest()) then
         call reject_chunk(view, view%n, 1, failed)
         status = merge(poinsot_e_partial, poinsot_ok, failed)
         return
      end if
      if (present(callback)) system%callback => callback
      system%loaded = clock(t + real(first, dp)*h, glance*h)
      call gather_all(plan, view, system, failed, error)
      if (.not. raised(error)) then
         allocate (before(merge(size(system%at), 0, present(callback))), stat=state)
         if (state /= 0) then
            call raise(error, poinsot_e_memory, "no memory for the state before a step")
         end if
      end if
      status = error%code
      if (raised(error)) return
      if (size(system%at) == 0) then ! nobody to move: no reason to count the steps
         status = merge(poinsot_e_partial, poinsot_ok, failed)
         return
      end if
      call apply_preprocessor(plan%splitting, system, t, h, first)
      do k = first, first + steps - 1
         if (present(callback)) call save_state(system, before)
         call run_steps(plan%splitting, system, t, h, k, 1_i8)
         if (system%halted) exit
      end do
      if (system%halted) then
         call raise(error, poinsot_e_callback, "the callback asked to stop")
         call restore_state(system, before)
      else
         call apply_postprocessor(plan%splitting, system, t, h, first + steps)
      end if
      system%stored = clock(t + real(k, dp)*h, glance*h) ! as the next call looks
      call store_all(plan, view, system, failed)
      status = merge(poinsot_e_partial, poinsot_ok, failed)
      if (raised(error)) status = error%code
   end subroutine run_coupled

   !> Kinetic and potential energy of each body at time t, pair energies shared between the two. A
   !> body that is refused keeps what stands in the arrays.
   subroutine coupled_energy(plan, view, t, kinetic, potential, status, error)
      type(poinsot_plan), intent(in), target :: plan      !! ready
      type(body_view), intent(in) :: view                 !! the caller's arrays
      real(dp), intent(in) :: t                           !! time
      real(dp), intent(inout) :: kinetic(:), potential(:) !! (n)
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      type(ensemble_flows), target :: system
      real(dp) :: e(lanes), u(lanes)
      logical :: failed
      integer :: k, l

      failed = .false.
      if (.not. rounds_to_nearest()) then
         call reject_chunk(view, view%n, 1, failed)
         status = merge(poinsot_e_partial, poinsot_ok, failed)
         return
      end if
      system%loaded = clock(t, 0.0_dp)
      call gather_all(plan, view, system, failed, error)
      status = error%code
      if (raised(error)) return
      call scatter_all(system)
      do k = 1, size(system%at)
         associate (s => system%at(k))
            call s%energies(t, e, u)
            call add_pairs(system, k, u)
            call reject_energies(e, u, s)
            do l = 1, s%n
               if (associated(view%status)) view%status(s%at(l)) = s%status(l)
               failed = failed .or. s%status(l) /= poinsot_ok
               if (s%status(l) /= poinsot_ok) cycle
               kinetic(s%at(l)) = e(l)
               potential(s%at(l)) = u(l)
            end do
         end associate
      end do
      status = merge(poinsot_e_partial, poinsot_ok, failed)
   end subroutine coupled_energy

end module poinsot_ensemble_coupled
