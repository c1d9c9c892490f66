!> Loads the caller's bodies into all blocks at once, and stores them back.
module poinsot_ensemble_gather
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_memory, poinsot_e_method, poinsot_e_size
   use poinsot_effect_effect, only: pair_effect
   use poinsot_ensemble_block, only: host_arrays, open_host, load_block, store_block
   use poinsot_ensemble_bodies, only: body_view
   use poinsot_ensemble_chunk, only: class_sorted_chunk, chunk_length, chunk_count, collect_chunk, &
      next_block
   use poinsot_ensemble_compose, only: attach_plan
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_ensemble_system, only: ensemble_flows
   !$ use omp_lib, only: omp_in_parallel, omp_get_max_threads
   implicit none(type, external)
   private
   public :: saved_state, gather_all, store_all, save_state, restore_state

   integer, parameter :: blocks_per_thread = 4 !! with fewer, a thread costs more than it brings

   !> What a block needs to go back to: the state before a step.
   type :: saved_state
      real(dp) :: y(lanes, 3), q(lanes, 4), carry(lanes, 7)
      integer :: status(lanes)
   end type saved_state

contains

   !> Load all bodies into blocks, with the flows of their classes. The callback is there already.
   !> Errors: POINSOT_E_MEMORY, POINSOT_E_METHOD if the splitting needs a gradient that the callback
   !> has not, POINSOT_E_SIZE if a pair effect has positions for another number of bodies.
   subroutine gather_all(plan, view, system, failed, error)
      type(poinsot_plan), intent(in), target :: plan !! ready
      type(body_view), intent(in) :: view            !! the caller's arrays
      type(ensemble_flows), intent(inout), target :: system  !! all blocks; blocks point into it
      logical, intent(inout) :: failed               !! set if a body is refused
      type(poinsot_error), intent(inout) :: error
      integer :: blocks

      system%plan => plan
      system%n = view%n
      system%fresh = .false.
      system%halted = .false.
      system%has_dissipation = plan%has_dissipation
      call check_pairs(plan, view, error)
      if (raised(error)) return
      if (plan%splitting%adaptive) then
         call raise(error, poinsot_e_method, "splitting 'taylor' does not support " // &
                    "callbacks; use 'srkn6'")
         return
      end if
      if (plan%splitting%needs_gradient .and. associated(system%callback)) then
         call raise(error, poinsot_e_method, "splitting '" // trim(plan%splitting%name) // &
                    "' needs force gradients, which a callback does not provide; " // &
                    "use 'srkn4' or 'srkn6'")
         return
      end if
      blocks = count_blocks(plan, view, failed)
      system%team = team_size(plan, blocks)
      call make_room(plan, view, blocks, system, error)
      if (raised(error)) return
      call load_all(plan, view, system, failed)
   end subroutine gather_all

   !> How many blocks the bodies make.
   integer function count_blocks(plan, view, failed) result(blocks)
      type(poinsot_plan), intent(in) :: plan
      type(body_view), intent(in) :: view
      logical, intent(inout) :: failed
      type(class_sorted_chunk) :: h
      integer :: at(lanes), length, c, n, class
      blocks = 0
      length = chunk_length(view, 1)
      do c = 1, chunk_count(view%n, length)
         call collect_chunk(view, plan%class_count(), length, c, h, failed)
         do
            call next_block(h, n, class, at)
            if (n == 0) exit
            blocks = blocks + 1
         end do
      end do
   end function count_blocks

   !> Threads for so many blocks.
   integer function team_size(plan, blocks) result(team)
      type(poinsot_plan), intent(in) :: plan
      integer, intent(in) :: blocks
      team = 1
      !$ if (.not. omp_in_parallel()) then
      !$    team = merge(plan%threads, omp_get_max_threads(), plan%threads > 0)
      !$ end if
      team = max(1, min(team, blocks/blocks_per_thread))
   end function team_size

   subroutine make_room(plan, view, blocks, system, error)
      type(poinsot_plan), intent(in) :: plan
      type(body_view), intent(in) :: view
      integer, intent(in) :: blocks
      type(ensemble_flows), intent(inout) :: system
      type(poinsot_error), intent(inout) :: error
      integer :: state
      allocate (system%at(blocks), stat=state)
      if (state == 0) then
         allocate (system%by_lane(merge(blocks, 1, associated(view%scale) .or. &
                                    associated(view%moments(1)%of))), stat=state)
      end if
      if (state == 0 .and. plan%coupled) then
         allocate (system%sources(3, system%n, size(plan%effects)), &
                   system%changes(3, system%n), stat=state)
      end if
      if (state == 0 .and. associated(system%callback)) then
         allocate (system%q(system%n, 4), system%torque(system%n, 3), stat=state)
      end if
      if (state /= 0) then
         call raise(error, poinsot_e_memory, "no memory for the blocks of all bodies")
      end if
   end subroutine make_room

   subroutine load_all(plan, view, system, failed)
      type(poinsot_plan), intent(in), target :: plan
      type(body_view), intent(in), target :: view
      type(ensemble_flows), intent(inout), target :: system
      logical, intent(inout) :: failed
      type(class_sorted_chunk) :: h
      type(host_arrays) :: host
      integer :: at(lanes), length, c, k, n, class
      if (view%n > 0) call open_host(view, plan%momentum, plan%principal, host)
      host%wants_id = .true.
      host%loaded = system%loaded
      k = 0
      length = chunk_length(view, 1)
      do c = 1, chunk_count(view%n, length)
         call collect_chunk(view, plan%class_count(), length, c, h, failed)
         do
            call next_block(h, n, class, at)
            if (n == 0) exit
            k = k + 1
            call load_block(host, at(:n), n, class, plan%classes(class)%it, &
                            system%by_lane(min(k, size(system%by_lane))), system%at(k))
            system%at(k)%at(n + 1:) = 0
            call attach_plan(plan, system%at(k))
         end do
      end do
   end subroutine load_all

   !> All blocks back into the caller's arrays.
   subroutine store_all(plan, view, system, failed)
      type(poinsot_plan), intent(in) :: plan        !! ready
      type(body_view), intent(in), target :: view   !! the caller's arrays
      type(ensemble_flows), intent(inout) :: system !! all blocks
      logical, intent(inout) :: failed              !! set if a body failed
      type(host_arrays) :: host
      integer :: k
      if (view%n == 0) return
      call open_host(view, plan%momentum, plan%principal, host)
      host%stored = system%stored
      do k = 1, size(system%at)
         associate (b => system%at(k))
            call store_block(host, .false., .false., b)
            failed = failed .or. any(b%status(1:b%n) /= poinsot_ok)
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
               call raise(error, poinsot_e_size, "effect '" // trim(one%name) // &
                          "' has positions of " // trim(numbers) // &
                          " bodies: give one position for each")
            end if
         end select
      end do
   end subroutine check_pairs

   !> Keep the state of all blocks.
   subroutine save_state(system, before)
      type(ensemble_flows), intent(in) :: system !! all blocks
      type(saved_state), intent(inout) :: before(:)
      integer :: k
      do k = 1, size(before)
         associate (f => system%at(k))
            before(k) = saved_state(f%y, f%q, f%carry, f%status)
         end associate
      end do
   end subroutine save_state

   !> Put that state back.
   subroutine restore_state(system, before)
      type(ensemble_flows), intent(inout) :: system !! all blocks
      type(saved_state), intent(in) :: before(:)
      integer :: k
      do k = 1, size(before)
         associate (f => system%at(k))
            f%y = before(k)%y
            f%q = before(k)%q
            f%carry = before(k)%carry
            f%status = before(k)%status
         end associate
      end do
   end subroutine restore_state

end module poinsot_ensemble_gather
