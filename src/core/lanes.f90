!> Tests over all lanes of a block, without the early exit that would prevent vectorisation.
module poinsot_core_lanes
   use poinsot_core_kinds, only: dp, i8, group, lanes
   use poinsot_core_status, only: poinsot_ok
   implicit none(type, external)
   private
   public :: largest, smallest, any_failed

contains

   !> The largest of all lanes, none of them negative: bits of positive numbers compare like the
   !> numbers.
   pure real(dp) function largest(nvec, x)
      integer, intent(in) :: nvec      !! groups of lanes to look at
      real(dp), intent(in) :: x(lanes) !! a value for each lane
      integer(i8) :: m
      integer :: l
      m = 0
      do l = 1, group*nvec
         m = max(m, transfer(x(l), 1_i8))
      end do
      largest = transfer(m, 1.0_dp)
   end function largest

   !> The smallest of all lanes, none of them negative.
   pure real(dp) function smallest(nvec, x)
      integer, intent(in) :: nvec      !! groups of lanes to look at
      real(dp), intent(in) :: x(lanes) !! a value for each lane
      integer(i8) :: m
      integer :: l
      m = huge(m)
      do l = 1, group*nvec
         m = min(m, transfer(x(l), 1_i8))
      end do
      smallest = transfer(m, 1.0_dp)
   end function smallest

   !> Is there a lane that is not POINSOT_OK? Statuses are never negative.
   pure logical function any_failed(status, nvec)
      integer, intent(in) :: status(lanes)
      integer, intent(in), optional :: nvec !! groups of lanes to look at, instead of all
      integer :: n
      n = lanes
      if (present(nvec)) n = group*nvec
      any_failed = sum(status(:n)) /= poinsot_ok
   end function any_failed

end module poinsot_core_lanes
