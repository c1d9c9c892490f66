!> The plan of a scene: its groups become the body classes, its effects those of the plan, with one
!> view of the state arrays for all steps.
module poinsot_scene_engine
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_memory, poinsot_e_partial, &
      status_text
   use poinsot_effect_effect, only: effect
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_chunk, only: chunk_count, chunk_length
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, set_option, add_effect, &
      add_ready_effect
   use poinsot_ensemble_drive, only: team_size
   use poinsot_ensemble_rotate, only: threads_for
   use poinsot_ensemble_step, only: step_bodies, step_ns
   use poinsot_ensemble_observe, only: body_energies
   use poinsot_scene_text, only: text_of
   use poinsot_scene_schedule, only: step_total, piece_count
   use poinsot_scene_settings, only: scene_settings, effect_setting, body_total
   use poinsot_scene_states, only: body_states
   use poinsot_scene_communicator, only: communicator
   !$ use omp_lib, only: omp_get_max_threads
   implicit none(type, external)
   private
   public :: engine, start_engine, engine_step, engine_energy, couples_bodies, &
      number_bodies, threads_used

   !> What does not change during a run.
   type :: engine
      type(poinsot_plan) :: plan
      logical :: numbered = .false.    !! do effects ask for the numbers of bodies?
      real(dp) :: ns = 0        !! about what the steps from one output to the next take
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
      this%numbered = size(scene%effects) > 0
      if (.not. raised(error)) call make_ready(this%plan, error)
      if (raised(error)) return
      this%ns = step_ns(this%plan)*real(body_total(scene), dp)*step_total(scene)/ &
         real(piece_count(scene), dp)
      this%plan%threads = threads_for(scene%threads, this%ns)
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
   !> bodies at most, and no more than get some work.
   integer function threads_used(this, states)
      type(engine), intent(in) :: this
      type(body_states), intent(in), target :: states
      type(body_view) :: view
      threads_used = 1
      !$ threads_used = merge(this%plan%threads, omp_get_max_threads(), this%plan%threads > 0)
      threads_used = team_size(threads_used, this%ns)
      call look(states, view)
      threads_used = max(1, min(threads_used, chunk_count(states%n, chunk_length(view, &
         threads_used))))
   end function threads_used

   !> Does the motion of a body depend on other bodies?
   pure logical function couples_bodies(this)
      type(engine), intent(in) :: this
      couples_bodies = this%plan%coupled
   end function couples_bodies

   !> See the states as the plan does.
   subroutine look(states, view)
      type(body_states), intent(in), target :: states
      type(body_view), intent(out) :: view
      call view_rows(states%y, states%q, view)
      view%body_class => states%group
      view%carry => states%carry
      view%status => states%status
      if (allocated(states%id)) view%id => states%id
   end subroutine look

   !> Number the bodies of a rank that is not the first, if anything depends on their numbers: by
   !> themselves they would be numbered from 1.
   subroutine number_bodies(this, states, error)
      type(engine), intent(in) :: this
      type(body_states), intent(inout) :: states
      type(poinsot_error), intent(inout) :: error
      integer :: i, code
      if (states%first == 0 .or. .not. this%numbered) return
      allocate (states%id(states%n), stat=code)
      if (code /= 0) then
         call raise(error, poinsot_e_memory, "no memory for the numbers of " // &
                    text_of(states%n) // " bodies")
         return
      end if
      do i = 1, states%n
         states%id(i) = int(states%first, i8) + i - 1
      end do
   end subroutine number_bodies

   !> Steps number `first` to `first + steps - 1` of length h; step k begins at `origin + k h`, so
   !> that the bits of a run do not depend on where calls cut it. With several ranks, all call, each
   !> for its bodies. Error: POINSOT_E_PARTIAL on all ranks if bodies failed, naming the first.
   subroutine engine_step(this, states, origin, h, first, steps, error, ranks)
      type(engine), intent(in), target :: this
      type(body_states), intent(inout), target :: states
      real(dp), intent(in) :: origin, h
      integer(i8), intent(in) :: first, steps
      type(poinsot_error), intent(inout) :: error
      class(communicator), intent(inout), optional :: ranks
      type(body_view) :: view
      integer(i8) :: failed
      integer :: status, i
      states%status = poinsot_ok
      if (states%n > 0) then
         call look(states, view)
         call step_bodies(this%plan, view, origin, h, first, steps, status, error)
      end if
      if (present(ranks)) call ranks%share_error(error)
      if (raised(error)) return
      failed = count(states%status /= poinsot_ok, kind=i8)
      if (present(ranks)) failed = ranks%sum_over_ranks(failed)
      if (failed == 0) return
      do i = 1, states%n
         if (states%status(i) == poinsot_ok) cycle
         call raise(error, poinsot_e_partial, text_of(failed) // " of " // text_of(states%total) &
                 // " bodies failed between t = " // text_of(origin + real(first, dp)*h) // &
                 " and " // text_of(origin + real(first + steps, dp)*h) // &
                 "; the first is body " // text_of(states%first + i) // ": " // &
                 status_text(states%status(i)))
         exit
      end do
      if (present(ranks)) call ranks%share_error(error)
   end subroutine engine_step

   !> Energies of the bodies of this rank at time t.
   subroutine engine_energy(this, states, t, kinetic, potential, error)
      type(engine), intent(in), target :: this
      type(body_states), intent(inout), target :: states
      real(dp), intent(in) :: t
      real(dp), intent(out) :: kinetic(:), potential(:)   !! (n)
      type(poinsot_error), intent(inout) :: error
      type(body_view) :: view
      integer :: status
      states%status = poinsot_ok
      if (states%n == 0) return
      call look(states, view)
      call body_energies(this%plan, view, t, kinetic, potential, status, error)
      if (status /= poinsot_ok .and. .not. raised(error)) then
         call raise(error, poinsot_e_partial, "some bodies have no energy at t = " // text_of(t))
      end if
   end subroutine engine_energy

end module poinsot_scene_engine
