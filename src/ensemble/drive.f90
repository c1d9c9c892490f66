!> The one loop over bodies: chunks dealt out to threads, blocks loaded, worked on, stored.
!>
!> What is done to a block is a `block_job`; the loop knows nothing of it. Threads start once per
!> call, however many steps the job makes. Inside somebody else's parallel region the loop runs
!> serial.
module poinsot_ensemble_drive
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_ok, poinsot_e_partial
   use poinsot_body_class, only: body_class
   use poinsot_ensemble_block, only: block_state, host_arrays, open_host, load_block, store_block
   use poinsot_ensemble_bodies, only: body_view
   use poinsot_ensemble_chunk, only: class_sorted_chunk, chunk_count, collect_chunk, next_block
   !$ use omp_lib, only: omp_in_parallel, omp_get_max_threads
   implicit none(type, external)
   private
   public :: block_job, for_each_block

   !> Something to do with a block of bodies of one class.
   type, abstract :: block_job
      logical :: keep_momentum = .false. !! the caller's momentum variable is not changed by this
                                         !! job
      logical :: keep_attitude = .false. !! nor the attitude
      logical :: wants_id = .false.      !! it draws random numbers
      logical :: read_only = .false.     !! nothing is written back but statuses
   contains
      procedure(run_job), deferred :: run
   end type block_job

   abstract interface
      subroutine run_job(self, class, b)
         import :: block_job, body_class, block_state
         implicit none(type, external)
         class(block_job), intent(inout) :: self
         type(body_class), intent(in) :: class
         type(block_state), intent(inout) :: b
      end subroutine run_job
   end interface

contains

   !> Do a job on all bodies. Returns POINSOT_OK, or POINSOT_E_PARTIAL if some bodies failed: those
   !> keep the state they had.
   integer function for_each_block(view, classes, axes, momentum, threads, job) result(status)
      type(body_view), intent(in) :: view
      type(body_class), intent(in) :: classes(:)
      real(dp), intent(in) :: axes(:, :)            !! (4, classes), see plan
      integer, intent(in) :: momentum               !! momentum variable of the caller's arrays
      integer, intent(in) :: threads                !! 0: as OpenMP says
      class(block_job), intent(inout) :: job
      class(block_job), allocatable :: mine          !! a thread's own copy: jobs have work space
      type(host_arrays) :: host
      integer :: k, chunks, team, state
      logical :: failed, short

      chunks = chunk_count(view%n)
      team = 1
      !$ if (.not. omp_in_parallel()) team = merge(threads, omp_get_max_threads(), threads > 0)
      team = max(1, min(team, chunks))
      failed = .false.
      if (view%n == 0) then
         status = poinsot_ok
         return
      end if
      call open_host(view, momentum, host)
      host%wants_id = job%wants_id
      short = .false.
      if (team > 1) then
         !$omp parallel num_threads(team) default(none) reduction(.or.: failed) &
         !$omp shared(classes, axes, job, chunks, short) firstprivate(host) private(k, mine, state)
         allocate (mine, source=job, stat=state)
         if (state /= 0) then
            !$omp atomic write
            short = .true.
         end if
         !$omp barrier
         if (.not. short) then
            !$omp do schedule(static)
            do k = 1, chunks
               call run_chunk(host, classes, axes, mine, k, failed)
            end do
            !$omp end do
         end if
         if (allocated(mine)) deallocate (mine)
         !$omp end parallel
      end if
      if (team == 1 .or. short) then ! short of memory for the others: one thread does it all
         do k = 1, chunks
            call run_chunk(host, classes, axes, job, k, failed)
         end do
      end if
      status = merge(poinsot_e_partial, poinsot_ok, failed)
   end function for_each_block

   !> All blocks of one chunk.
   subroutine run_chunk(host, classes, axes, job, k, failed)
      type(host_arrays), intent(inout) :: host
      type(body_class), intent(in) :: classes(:)
      real(dp), intent(in) :: axes(:, :)
      integer, intent(in) :: k
      class(block_job), intent(inout) :: job
      logical, intent(inout) :: failed
      type(class_sorted_chunk) :: h
      type(block_state) :: b
      integer :: first, n, c

      call collect_chunk(host%view, size(classes), k, h, failed)
      do
         call next_block(h, first, n, c)
         if (n == 0) exit
         call load_block(host, h%at(first:first + n - 1), n, c, classes(c), axes(:, c), b)
         call job%run(classes(c), b)
         if (job%read_only) then
            call store_status(host%view, b)
         else
            call store_block(host, classes(c), axes(:, c), job%keep_momentum, job%keep_attitude, b)
         end if
         failed = failed .or. any(b%status(1:n) /= poinsot_ok) ! padding may fail: it has noise too
      end do
   end subroutine run_chunk

   subroutine store_status(view, b)
      type(body_view), intent(in) :: view
      type(block_state), intent(in) :: b
      integer :: l
      if (.not. associated(view%status)) return
      do l = 1, b%n
         view%status(b%at(l)) = b%status(l)
      end do
   end subroutine store_status

end module poinsot_ensemble_drive
