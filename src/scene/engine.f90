!> A scene as a plan: its groups are the body classes, its effects the plan's, and one view of the
!> state arrays is all a step needs.
module poinsot_scene_engine
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_partial, status_text
   use poinsot_effect_effect, only: effect
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_chunk, only: chunk_count, chunk_length
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, set_option, add_effect, &
      add_ready_effect
   use poinsot_ensemble_step, only: step_bodies
   use poinsot_ensemble_observe, only: body_energies
   use poinsot_scene_text, only: text_of
   use poinsot_scene_settings, only: scene_settings, effect_setting
   use poinsot_scene_states, only: body_states
   use poinsot_scene_communicator, only: communicator, slice_of
   !$ use omp_lib, only: omp_get_max_threads
   implicit none(type, external)
   private
   public :: engine, start_engine, engine_step, engine_energy, couples_bodies, threads_used

   !> What does not change during a run.
   type :: engine
      type(poinsot_plan) :: plan
   end type engine

contains

   !> Make the plan. Error: whatever the plan refuses.
   subroutine start_engine(scene, this, error, method)
      type(scene_settings), intent(in) :: scene    !! the typed scene
      type(engine), intent(out) :: this
      type(poinsot_error), intent(inout) :: error
      character(*), intent(in), optional :: method !! instead of the scene's
      integer :: i, number
      this%plan%principal = .true. ! the states are; the scene's effects are in the scene's frames
      this%plan%threads = scene%threads
      this%plan%seed = scene%seed
      this%plan%tolerance = scene%tolerance
      do i = 1, size(scene%bodies)
         if (raised(error)) return
         this%plan%physical = scene%bodies(i)%physical
         if (scene%bodies(i)%turned) then
            call add_class(this%plan, scene%bodies(i)%moments, number, error, scene%bodies(i)%axes)
         else
            call add_class(this%plan, scene%bodies(i)%moments, number, error)
         end if
      end do
      if (present(method)) then
         call set(this, "method", method, error)
      else
         call set(this, "method", scene%method, error)
      end if
      call set(this, "splitting", scene%splitting, error)
      do i = 1, size(scene%effects)
         if (.not. raised(error)) call add_to_plan(scene%effects(i), this%plan, error)
      end do
      if (.not. raised(error)) call make_ready(this%plan, error)
   end subroutine start_engine

   subroutine set(this, key, value, error)
      type(engine), intent(inout) :: this
      character(*), intent(in) :: key, value
      type(poinsot_error), intent(inout) :: error
      if (.not. raised(error)) call set_option(this%plan, key, value, error)
   end subroutine set

   !> The effect that was made when the scene was read, into the plan; made anew if its settings
   !> have
   !> changed since.
   subroutine add_to_plan(item, plan, error)
      type(effect_setting), intent(in) :: item
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      class(effect), allocatable :: made
      if (allocated(item%made)) then
         allocate (made, source=item%made)
         call add_ready_effect(plan, made, error, item%settings)
      else
         call add_effect(plan, item%name, item%settings, error)
      end if
   end subroutine add_to_plan

   !> Threads that step the bodies: as many as the scene or OpenMP says, but one for each chunk of
   !> bodies at most.
   integer function threads_used(this, states)
      type(engine), intent(in) :: this
      type(body_states), intent(in), target :: states
      type(body_view) :: view
      threads_used = 1
      !$ threads_used = merge(this%plan%threads, omp_get_max_threads(), this%plan%threads > 0)
      call look(states, view, 1, states%n)
      threads_used = max(1, min(threads_used, chunk_count(states%n, chunk_length(view, &
         threads_used))))
   end function threads_used

   !> Does a body's motion depend on the others'?
   pure logical function couples_bodies(this)
      type(engine), intent(in) :: this
      couples_bodies = this%plan%coupled
   end function couples_bodies

   !> See the states as the plan does; of all bodies, or of a slice that brings its numbers.
   subroutine look(states, view, from, to, id)
      type(body_states), intent(in), target :: states
      type(body_view), intent(out) :: view
      integer, intent(in) :: from, to
      integer(i8), intent(in), target, optional :: id(:)
      call view_rows(states%y(:, from:to), states%q(:, from:to), view)
      view%body_class => states%group(from:to)
      view%carry => states%carry(:, from:to)
      view%status => states%status(from:to)
      if (present(id)) view%id => id
   end subroutine look

   !> Steps number `first` to `first + steps - 1` of length h; step k begins at `origin + k h`, so
   !> that the bits of a run do not depend on where calls cut it. The bodies of this rank only, if
   !> there are several ranks. Error: POINSOT_E_PARTIAL on all ranks if bodies failed, naming the
   !> first.
   subroutine engine_step(this, states, origin, h, first, steps, error, ranks)
      type(engine), intent(in), target :: this
      type(body_states), intent(inout), target :: states
      real(dp), intent(in) :: origin, h
      integer(i8), intent(in) :: first, steps
      type(poinsot_error), intent(inout) :: error
      class(communicator), intent(inout), optional :: ranks
      type(body_view) :: view
      integer(i8), allocatable, target :: id(:)
      integer :: status, i, from, to
      states%status = poinsot_ok
      from = 1
      to = states%n
      if (present(ranks)) then
         if (.not. couples_bodies(this)) call slice_of(ranks%number, ranks%size, states%n, from, to)
      end if
      status = poinsot_ok
      if (to >= from) then
         if (from > 1) id = [(int(i, i8) - 1, i=from, to)]
         if (from > 1) then
            call look(states, view, from, to, id)
         else
            call look(states, view, from, to)
         end if
         call step_bodies(this%plan, view, origin, h, first, steps, status, error)
      end if
      if (present(ranks)) then
         if (ranks%size > 1) call join(ranks, this, states, status, error)
      end if
      if (raised(error) .or. status == poinsot_ok) return
      do i = 1, states%n - 1
         if (states%status(i) /= poinsot_ok) exit
      end do
      call raise(error, poinsot_e_partial, text_of(count(states%status /= poinsot_ok)) // &
                 " of " // text_of(states%n) // " bodies failed between t = " // text_of(origin + &
                 real(first, dp)*h) // " and " // text_of(origin + real(first + steps, dp)*h) // &
                 "; the first is body " // text_of(i) // ": " // status_text(states%status(i)))
   end subroutine engine_step

   !> What went wrong on any rank is known to all; bodies that failed, with their states.
   subroutine join(ranks, this, states, status, error)
      class(communicator), intent(inout) :: ranks
      type(engine), intent(in) :: this
      type(body_states), intent(inout) :: states
      integer, intent(inout) :: status
      type(poinsot_error), intent(inout) :: error
      integer :: code
      code = ranks%max_over_ranks(error%code)
      if (code /= poinsot_ok) then
         if (.not. raised(error)) call raise(error, code, "another rank failed: " // &
            status_text(code))
         return
      end if
      status = ranks%max_over_ranks(status)
      if (status /= poinsot_ok .and. .not. couples_bodies(this)) call ranks%allgather(states)
   end subroutine join

   !> Energies of all bodies at time t.
   subroutine engine_energy(this, states, t, kinetic, potential, error)
      type(engine), intent(in), target :: this
      type(body_states), intent(inout), target :: states
      real(dp), intent(in) :: t
      real(dp), intent(out) :: kinetic(:), potential(:)   !! (n)
      type(poinsot_error), intent(inout) :: error
      type(body_view) :: view
      integer :: status
      states%status = poinsot_ok
      call look(states, view, 1, states%n)
      call body_energies(this%plan, view, t, kinetic, potential, status, error)
      if (status /= poinsot_ok .and. .not. raised(error)) then
         call raise(error, poinsot_e_partial, "some bodies have no energy at t = " // text_of(t))
      end if
   end subroutine engine_energy

end module poinsot_scene_engine
