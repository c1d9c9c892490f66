!> Torques at any accuracy: bodies of one class, over steps of any size, by Taylor series in two
!> precisions (mathematics.md, "Torques at any accuracy"; Jorba and Zou 2005 for the step size).
module poinsot_taylor_integrate
   use poinsot_core_kinds, only: dp
   use poinsot_taylor_problem, only: taylor_problem
   use poinsot_taylor_settings, only: taylor_orders, taylor_time
   use poinsot_taylor_lanes, only: run_lanes
   implicit none(type, external)
   private
   public :: integrate

contains

   !> Steps of n bodies. A body that is not POINSOT_OK is left out; one that fails keeps its state:
   !> POINSOT_E_DOMAIN if it turns faster than any may, POINSOT_E_STEP if a step h has more than 1e9
   !> substeps.
   subroutine integrate(problem, orders, time, keep, n, y, q, carry, status)
      type(taylor_problem), intent(in) :: problem
      type(taylor_orders), intent(in) :: orders
      type(taylor_time), intent(in) :: time
      logical, intent(in) :: keep                  !! there is a carry
      integer, intent(in) :: n                     !! bodies
      real(dp), intent(inout) :: y(3, n)           !! angular momenta, principal frame
      real(dp), intent(inout) :: q(4, n)           !! attitudes
      real(dp), intent(inout) :: carry(7, merge(n, 0, keep))   !! of the sums of y and q
      integer, intent(inout) :: status(n)
      if (n == 0 .or. time%steps <= 0 .or. .not. abs(time%h) > 0) return
      call run_lanes(problem, orders, time, keep, n, y, q, carry, status)
   end subroutine integrate

end module poinsot_taylor_integrate
