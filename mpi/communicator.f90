!> The ranks of an MPI run, by the interface that MPICH and Open MPI both have for every type of buffer.
module mpi_communicators
   use mpi_f08, only: mpi_comm_world, mpi_double_precision, mpi_integer, mpi_integer8, mpi_in_place, mpi_max, &
      mpi_datatype_null, mpi_init, mpi_finalize, mpi_comm_rank, mpi_comm_size, mpi_allgatherv, mpi_allreduce, mpi_bcast
   use poinsot_core_kinds, only: i8
   use poinsot_scene_communicator, only: communicator, slice_of
   use poinsot_scene_states, only: body_states
   implicit none(type)
   private
   public :: mpi_communicator, start_mpi, finish_mpi

   !> One of MPI's processes.
   type, extends(communicator) :: mpi_communicator
   contains
      procedure :: allgather
      procedure :: max_over_ranks
      procedure :: broadcast
   end type mpi_communicator

contains

   !> Start MPI.
   subroutine start_mpi(ranks)
      type(mpi_communicator), intent(out) :: ranks
      integer :: code
      call mpi_init(code)
      call mpi_comm_rank(mpi_comm_world, ranks%number, code)
      call mpi_comm_size(mpi_comm_world, ranks%size, code)
   end subroutine start_mpi

   !> End MPI.
   subroutine finish_mpi()
      integer :: code
      call mpi_finalize(code)
   end subroutine finish_mpi

   !> Every rank's slice to all, in place.
   subroutine allgather(self, states)
      class(mpi_communicator), intent(inout) :: self
      type(body_states), intent(inout) :: states
      integer :: from, to, rank, code
      integer :: counts(self%size), starts(self%size)
      do rank = 0, self%size - 1
         call slice_of(rank, self%size, states%n, from, to)
         counts(rank + 1) = to - from + 1
         starts(rank + 1) = from - 1
      end do
      call mpi_allgatherv(mpi_in_place, 0, mpi_datatype_null, states%y, 3*counts, 3*starts, &
                          mpi_double_precision, mpi_comm_world, code)
      call mpi_allgatherv(mpi_in_place, 0, mpi_datatype_null, states%q, 4*counts, 4*starts, &
                          mpi_double_precision, mpi_comm_world, code)
      call mpi_allgatherv(mpi_in_place, 0, mpi_datatype_null, states%carry, 7*counts, 7*starts, &
                          mpi_double_precision, mpi_comm_world, code)
      call mpi_allgatherv(mpi_in_place, 0, mpi_datatype_null, states%status, counts, starts, mpi_integer, &
                          mpi_comm_world, code)
   end subroutine allgather

   integer function max_over_ranks(self, code)
      class(mpi_communicator), intent(inout) :: self
      integer, intent(in) :: code
      integer :: mine(1), all(1), ignored
      mine = code
      if (self%size > 0) call mpi_allreduce(mine, all, 1, mpi_integer, mpi_max, mpi_comm_world, ignored)
      max_over_ranks = all(1)
   end function max_over_ranks

   integer(i8) function broadcast(self, number)
      class(mpi_communicator), intent(inout) :: self
      integer(i8), intent(in) :: number
      integer(i8) :: told(1)
      integer :: code
      told = number
      if (self%size > 0) call mpi_bcast(told, 1, mpi_integer8, 0, mpi_comm_world, code)
      broadcast = told(1)
   end function broadcast

end module mpi_communicators
