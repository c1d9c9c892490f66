!> The loop over bodies: chunks are distributed to threads; blocks are loaded, processed and stored.
!>
!> The work on a block is a `block_job`, which the loop need not know. Threads start once per call,
!> however many steps the job takes. Inside a parallel region of the host the loop runs on one
!> thread.
module poinsot_ensemble_drive
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_lanes, only: any_failed
   use poinsot_core_rounding, only: rounds_to_nearest
   use poinsot_core_status, only: poinsot_ok, poinsot_e_partial
   use poinsot_body_class, only: body_class
   use poinsot_ensemble_block, only: clock, host_arrays, open_host, &
      load_block, store_block, store_status
   use poinsot_ensemble_bodies, only: body_view
   use poinsot_ensemble_chunk, only: class_sorted_chunk, chunk_length, chunk_count, collect_chunk, &
      next_block, reject_chunk
   use poinsot_ensemble_layout, only: body_momentum
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_free_lane_moments, only: lane_moments
   use poinsot_splitting_block_flows, only: block_flows
   !$ use omp_lib, only: omp_in_parallel, omp_get_max_threads
   implicit none(type, external)
   private
   public :: block_job, for_each_block, team_size

   !> Work on a block of bodies of one class: of a plan or, without one, of the given class.
   type, abstract :: block_job
      type(poinsot_plan), pointer :: plan => null()
      type(body_class), pointer :: class => null()
      logical :: keep_momentum = .false. !! the caller's momentum variable is not changed by this
                                         !! job
      logical :: keep_attitude = .false. !! nor the attitude
      logical :: wants_id = .false.      !! it draws random numbers
      logical :: read_only = .false.     !! nothing is written back but statuses
      real(dp) :: ns = 10                !! about what a body takes, in nanoseconds
      type(clock) :: loaded, stored      !! when velocities are read and written; 0 without them
   contains
      procedure(run_job), deferred :: run
   end type block_job

   abstract interface
      subroutine run_job(self, b)
         import :: block_job, block_flows
         implicit none(type, external)
         class(block_job), intent(inout) :: self
         type(block_flows), intent(inout) :: b
      end subroutine run_job
   end interface

contains

   !> Do a job on all bodies. Returns POINSOT_OK, or POINSOT_E_PARTIAL if some bodies failed: those
   !> keep the state they had.
   integer function for_each_block(view, threads, job) result(status)
      type(body_view), intent(in), target :: view
      integer, intent(in) :: threads                !! 0: as OpenMP says
      class(block_job), intent(inout) :: job
      class(block_job), allocatable :: mine         !! a thread's own copy: jobs have work space
      type(host_arrays) :: host
      integer :: k, length, chunks, team, state
      logical :: failed, short

      team = 1
      !$ if (.not. omp_in_parallel()) team = merge(threads, omp_get_max_threads(), threads > 0)
      team = team_size(team, real(view%n, dp)*job%ns)
      length = chunk_length(view, team)
      chunks = chunk_count(view%n, length)
      team = max(1, min(team, chunks))
      failed = .false.
      if (view%n == 0) then
         status = poinsot_ok
         return
      end if
      if (associated(job%plan)) then
         call open_host(view, job%plan%momentum, job%plan%principal, host)
      else
         call open_host(view, body_momentum, .true., host)
      end if
      host%wants_id = job%wants_id
      host%loaded = job%loaded
      host%stored = job%stored
      short = .false.
      if (team > 1) then
         !$omp parallel num_threads(team) default(none) reduction(.or.: failed) &
         !$omp shared(job, length, chunks, short) firstprivate(host) private(k, mine, state)
         allocate (mine, source=job, stat=state)
         if (state /= 0) then
            !$omp atomic write
            short = .true.
         end if
         !$omp barrier
         if (.not. short) then
            !$omp do schedule(static)
            do k = 1, chunks
               call run_chunk(host, mine, length, k, failed)
            end do
            !$omp end do
         end if
         if (allocated(mine)) deallocate (mine)
         !$omp end parallel
      end if
      if (team == 1 .or. short) then ! short of memory for the others: one thread does it all
         do k = 1, chunks
            call run_chunk(host, job, length, k, failed)
         end do
      end if
      status = merge(poinsot_e_partial, poinsot_ok, failed)
   end function for_each_block

   !> The number of threads to start: each must get enough work to be worth it.
   pure integer function team_size(threads, ns)
      integer, intent(in) :: threads                !! at least 1
      real(dp), intent(in) :: ns                    !! of all the work, in nanoseconds
      real(dp), parameter :: least = 2e5_dp         !! for each
      team_size = max(1, int(min(real(threads, dp), ns/least)))
   end function team_size

   !> All blocks of one chunk; none where the thread does not round to nearest.
   subroutine run_chunk(host, job, length, k, failed)
      type(host_arrays), intent(inout) :: host
      class(block_job), intent(inout) :: job
      integer, intent(in) :: length, k
      logical, intent(inout) :: failed
      type(class_sorted_chunk) :: h
      type(block_flows) :: b
      type(lane_moments) :: by_lane
      type(body_class), pointer :: class
      integer :: at(lanes), n, c, classes

      if (.not. rounds_to_nearest()) then ! asked by the thread that computes
         call reject_chunk(host%view, length, k, failed)
         return
      end if
      classes = 1
      if (associated(job%plan)) classes = job%plan%class_count()
      do n = 1, lanes ! a loop here has the compiler align the whole of them
         by_lane%scale(n) = 1
      end do
      call collect_chunk(host%view, classes, length, k, h, failed)
      do
         call next_block(h, n, c, at)
         if (n == 0) exit
         class => job%class
         if (associated(job%plan)) class => job%plan%classes(c)%it
         call load_block(host, at(:n), n, c, class, by_lane, b)
         call job%run(b)
         if (job%read_only) then
            call store_status(host%view, b)
         else
            call store_block(host, job%keep_momentum, job%keep_attitude, b)
         end if
         if (any_failed(b%status)) then ! padding may fail: it has noise too
            failed = failed .or. any(b%status(1:n) /= poinsot_ok)
         end if
      end do
   end subroutine run_chunk

end module poinsot_ensemble_drive
