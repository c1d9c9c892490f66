!> Free rotation of many bodies with the same moments: the simplest interface.
module poinsot_ensemble_rotate
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_partial, poinsot_e_size
   use poinsot_body_class, only: body_class, extend_class, needs_more
   use poinsot_ensemble_bodies, only: body_view
   use poinsot_ensemble_direct, only: one_chunk, rotate_direct
   use poinsot_ensemble_drive, only: block_job, for_each_block
   use poinsot_ensemble_layout, only: body_momentum
   use poinsot_ensemble_plain, only: open_plain_view, plain_arrays
   use poinsot_free_method, only: free_method, advance
   use poinsot_splitting_block_flows, only: block_flows
   implicit none(type, external)
   private
   public :: rotate_job, rotate_bodies, check_step, threads_for

   !> `steps` steps of h by one method.
   type, extends(block_job) :: rotate_job
      type(free_method) :: method
      real(dp) :: h = 0
      integer :: steps = 1
   contains
      procedure :: run => run_rotate
   end type rotate_job

contains

   !> Rotate all bodies of a native view freely. POINSOT_E_PARTIAL if some failed: each has a status
   !> and its state of before.
   subroutine rotate_bodies(class, method, h, steps, view, threads, status, error)
      type(body_class), intent(in), target :: class
      type(free_method), intent(in) :: method
      real(dp), intent(in) :: h                     !! step, either sign
      integer, intent(in) :: steps                  !! how many
      type(body_view), intent(in) :: view
      integer, intent(in) :: threads                !! 0: as OpenMP says, if it is long enough
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error   !! a step that is not finite
      type(rotate_job) :: job
      type(body_class), target :: longer
      logical :: done

      call check_step(h, steps, error)
      status = error%code
      if (status /= 0) return
      call rotate_plain(class, method, h, steps, view, threads, status, done)
      if (done) return
      job%class => class
      if (needs_more(class, method%terms)) then
         longer = class
         call extend_class(longer, method%terms)
         job%class => longer
      end if
      job%method = method
      job%h = h
      job%steps = steps
      job%ns = method%ns*steps
      status = for_each_block(view, threads_for(threads, view%n*job%ns), job)
   end subroutine rotate_bodies

   !> The same by the short way: few bodies, or one thread, and a view with nothing else in it.
   subroutine rotate_plain(class, method, h, steps, view, threads, status, done)
      type(body_class), intent(in) :: class
      type(free_method), intent(in) :: method
      real(dp), intent(in) :: h
      integer, intent(in) :: steps, threads
      type(body_view), intent(in) :: view
      integer, intent(inout) :: status
      logical, intent(out) :: done                  !! else it is for others
      type(plain_arrays) :: a
      logical :: failed
      integer :: none_left
      done = class%sorted(1) > 0 .and. (threads == 1 .or. view%n <= one_chunk) .and. &
         .not. (associated(view%scale) .or. associated(view%moments(1)%of) .or. &
                needs_more(class, method%terms))
      if (done) call open_plain_view(view, 3, a, done)
      if (.not. done) return
      call rotate_direct(class, method, body_momentum, h, steps, .false., a, failed, none_left)
      status = merge(poinsot_e_partial, poinsot_ok, failed)
   end subroutine rotate_plain

   !> Threads that nobody gave a number of: one where the work is short, since on a busy machine a
   !> team waits for its last thread as long as the scheduler likes.
   pure integer function threads_for(threads, ns)
      integer, intent(in) :: threads                !! 0: as OpenMP says
      real(dp), intent(in) :: ns                    !! of all the work, in nanoseconds
      real(dp), parameter :: long = 2e7_dp
      threads_for = threads
      if (threads == 0 .and. ns < long) threads_for = 1
   end function threads_for

   !> A step (or a time) must be finite, a number of steps not negative.
   subroutine check_step(h, steps, error, what)
      real(dp), intent(in) :: h
      integer, intent(in) :: steps
      type(poinsot_error), intent(inout) :: error
      character(*), intent(in), optional :: what    !! for the message, if it is not "step h"
      if (.not. ieee_is_finite(h)) then
         if (present(what)) then
            call raise(error, poinsot_e_domain, what//" is not finite")
         else
            call raise(error, poinsot_e_domain, "step h is not finite")
         end if
      else if (steps < 0) then
         call raise(error, poinsot_e_size, "number of steps is negative")
      end if
   end subroutine check_step

   subroutine run_rotate(self, b)
      class(rotate_job), intent(inout) :: self
      type(block_flows), intent(inout) :: b
      integer :: k
      if (b%compensated) then
         do k = 1, self%steps
            call advance(self%method, b%class, self%h, b%y, b%q, b%status, b%carry, b%nvec)
         end do
      else
         do k = 1, self%steps
            call advance(self%method, b%class, self%h, b%y, b%q, b%status, nvec=b%nvec)
         end do
      end if
   end subroutine run_rotate

end module poinsot_ensemble_rotate
