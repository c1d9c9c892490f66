!> Sorting three numbers in ascending order, mostly moments of inertia.
module poinsot_core_order
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: ascending_order

contains

   !> Places of three numbers in ascending order, ties by place.
   pure subroutine ascending_order(x, order, parity)
      real(dp), intent(in) :: x(3)        !! any numbers but NaN
      integer, intent(out) :: order(3)    !! x(order) ascends
      real(dp), intent(out) :: parity     !! sign of the permutation
      order = [1, 2, 3]
      parity = 1
      call exchange(x, 1, 2, order, parity)
      call exchange(x, 2, 3, order, parity)
      call exchange(x, 1, 2, order, parity)
   end subroutine ascending_order

   !> Put places i < j of an order right.
   pure subroutine exchange(x, i, j, order, parity)
      real(dp), intent(in) :: x(3)
      integer, intent(in) :: i, j
      integer, intent(inout) :: order(3)
      real(dp), intent(inout) :: parity
      if (x(order(i)) <= x(order(j))) return
      order([i, j]) = order([j, i])
      parity = -parity
   end subroutine exchange

end module poinsot_core_order
