!> Gathers bodies of all ranks, some at a time, on rank 0, which writes them.
module poinsot_scene_collect
   use poinsot_core_kinds, only: dp, i8
   use poinsot_scene_communicator, only: communicator, slice_of
   use poinsot_scene_states, only: body_states
   implicit none(type, external)
   private
   public :: collect, own_rows, row_size

   integer, parameter :: row_size = 9 !! y, q, kinetic and potential energy

contains

   !> Rows of the bodies with these numbers, on rank 0; on the others nothing. All ranks call, with
   !> the same numbers.
   subroutine collect(ranks, states, kinetic, potential, numbers, rows)
      class(communicator), intent(inout) :: ranks      !! among whom the bodies are shared out
      type(body_states), intent(in) :: states          !! of this rank
      real(dp), intent(in) :: kinetic(:), potential(:) !! (n)
      integer(i8), intent(in) :: numbers(:)            !! (m): from 1
      real(dp), intent(inout) :: rows(:, :)            !! (row_size, m)
      real(dp), allocatable :: own(:, :)
      integer, allocatable :: at(:)
      integer(i8) :: least, most
      integer :: rank, from, to, i
      if (size(numbers) == 0) return
      least = minval(numbers)
      most = maxval(numbers)
      do rank = 0, ranks%size - 1
         call slice_of(rank, ranks%size, states%total, from, to)
         if (from > most .or. to < least) cycle
         if (ranks%number > 0 .and. ranks%number /= rank) cycle
         at = pack([(i, i=1, size(numbers))], numbers >= from .and. numbers <= to)
         if (size(at) == 0) cycle
         allocate (own(row_size, size(at)))
         if (ranks%number == rank) then
            own = own_rows(states, kinetic, potential, numbers(at))
            if (rank > 0) call ranks%send_rows(own)
         else
            call ranks%receive_rows(rank, own)
         end if
         if (ranks%number == 0) rows(:, at) = own
         deallocate (own)
      end do
   end subroutine collect

   !> Rows of bodies that this rank holds.
   pure function own_rows(states, kinetic, potential, numbers) result(rows)
      type(body_states), intent(in) :: states
      real(dp), intent(in) :: kinetic(:), potential(:) !! (n)
      integer(i8), intent(in) :: numbers(:)            !! from 1
      real(dp) :: rows(row_size, size(numbers))
      integer :: i, k
      do i = 1, size(numbers)
         k = int(numbers(i) - states%first)
         rows(:, i) = [states%y(:, k), states%q(:, k), kinetic(k), potential(k)]
      end do
   end function own_rows

end module poinsot_scene_collect
