!> Who else works on a run. The library knows no message passing: a program that has it extends this
!> type (mpi/communicator.f90); alone, all of it does nothing. Every rank holds the states of all
!> bodies,
!> steps a slice of its own, and has the others' before an output.
module poinsot_scene_communicator
   use poinsot_core_kinds, only: i8, lanes
   use poinsot_scene_states, only: body_states
   implicit none(type, external)
   private
   public :: communicator, slice_of

   !> One rank among `size`.
   type :: communicator
      integer :: number = 0   !! this rank, from 0; 0 writes the files
      integer :: size = 1
   contains
      procedure :: allgather
      procedure :: max_over_ranks
      procedure :: broadcast
   end type communicator

contains

   !> First and last body of a rank: whole blocks, as even as they come.
   pure subroutine slice_of(number, size, n, from, to)
      integer, intent(in) :: number, size   !! rank, from 0, and how many there are
      integer, intent(in) :: n              !! bodies
      integer, intent(out) :: from, to      !! to = from - 1 for a rank without bodies
      integer(i8) :: blocks
      blocks = (n + lanes - 1)/lanes
      from = int(min(int(n, i8), lanes*(blocks*number/size))) + 1
      to = int(min(int(n, i8), lanes*(blocks*(number + 1)/size)))
   end subroutine slice_of

   !> Everybody gets the slices of all others: momenta, attitudes, carries and statuses.
   subroutine allgather(self, states)
      class(communicator), intent(inout) :: self
      type(body_states), intent(inout) :: states
      associate (unused_1 => self, unused_2 => states)
      end associate
   end subroutine allgather

   !> The largest of all ranks' codes.
   integer function max_over_ranks(self, code)
      class(communicator), intent(inout) :: self
      integer, intent(in) :: code
      associate (unused => self)
      end associate
      max_over_ranks = code
   end function max_over_ranks

   !> Rank 0's number, for what depends on a clock or a signal.
   integer(i8) function broadcast(self, number)
      class(communicator), intent(inout) :: self
      integer(i8), intent(in) :: number
      associate (unused => self)
      end associate
      broadcast = number
   end function broadcast

end module poinsot_scene_communicator
