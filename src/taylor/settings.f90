!> Orders of the series for a tolerance, in double precision and in total; and the times of a call.
module poinsot_taylor_settings
   use poinsot_core_kinds, only: sp, dp, i8
   implicit none(type, external)
   private
   public :: taylor_orders, taylor_time, choose_orders, default_tolerance, least_tolerance, &
      most_tolerance

   real(dp), parameter :: default_tolerance = 1e-12_dp
   real(dp), parameter :: least_tolerance = 1e-15_dp, most_tolerance = 1e-2_dp

   !> Orders and tolerance.
   type :: taylor_orders
      integer :: double = 0              !! up to here in double precision; 0: all in single
      integer :: last = 0                !! of the series
      real(sp) :: log_tolerance = 0      !! to base 2
   end type taylor_orders

   !> The steps of a call: step k starts at t + k h.
   type :: taylor_time
      real(dp) :: t = 0, h = 0
      integer(i8) :: first = 0, steps = 0
   end type taylor_time

contains

   !> Orders for a tolerance: the last one where a unit of time costs least (measured), those in
   !> double precision where single precision would show, as order k needs only the relative
   !> precision tolerance^(1 - k/N).
   pure type(taylor_orders) function choose_orders(tolerance) result(orders)
      real(dp), intent(in) :: tolerance      !! 1e-15 to 1e-2
      real(dp) :: digits
      digits = -log(tolerance)
      orders%log_tolerance = real(log(tolerance)/log(2.0_dp), sp)
      orders%last = min(24, max(8, nint(5.2_dp + 0.49_dp*digits)))
      orders%double = ceiling(orders%last*(1 - 13.2_dp/digits))
      if (tolerance < 1e-7_dp) orders%double = orders%double + 1
      if (tolerance >= 1e-6_dp) orders%double = 0
      orders%double = max(0, min(16, orders%double))
   end function choose_orders

end module poinsot_taylor_settings
