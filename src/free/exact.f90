!> `exact`: the explicit exact step for any h. One pass where it is valid, substeps beyond, Jacobi's
!> functions where substeps would be many. Which of them is a function of the body's state, class
!> and h alone.
module poinsot_free_exact
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_status, only: poinsot_e_step
   use poinsot_core_lanes, only: largest
   use poinsot_body_class, only: body_class, series_levels
   use poinsot_free_exact_step, only: step_sizes, exact_step_increment
   use poinsot_free_jacobi_solution, only: jacobi_increment
   implicit none(type, external)
   private
   public :: exact_increment

   integer, parameter :: most_substeps = 4 !! beyond, Jacobi's functions are cheaper, and as exact
   real(dp), parameter :: longest_phase = 1e15_dp !! h |omega| beyond which no digit of the angle is
                                                  !! left

contains

   !> Increments of y and q over h, exact to rounding, for every body, any h. Mathematics, section 3
   !> (and 4 beyond 4 substeps). POINSOT_E_STEP for h |omega| > 1e15.
   pure subroutine exact_increment(class, terms, h, y, q, dy, dq, status)
      type(body_class), intent(in) :: class                !! of these bodies
      integer, intent(in) :: terms                         !! not used
      real(dp), intent(in) :: h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      real(dp) :: w(lanes, 3), p(lanes), r(lanes), above

      call step_sizes(class, h, y, w, p, r, above)
      if (above <= class%reach(series_levels)) then
         call exact_step_increment(class, w, p, r, above, y, q, dy, dq)
      else
         call long_increment(class, terms, p + r, h, y, q, dy, dq, status)
      end if
   end subroutine exact_increment

   !> The same where at least one lane needs more than one pass.
   pure subroutine long_increment(class, terms, sizes, h, y, q, dy, dq, status)
      type(body_class), intent(in) :: class
      integer, intent(in) :: terms
      real(dp), intent(in) :: sizes(lanes), h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      real(dp) :: parts(lanes), step(lanes), above, w(lanes, 3), p(lanes), r(lanes)
      real(dp) :: ddy(lanes, 3), ddq(lanes, 4)
      integer :: k

      parts = 1
      where (sizes > class%reach(series_levels)) &
         parts = aint(sqrt(sizes/class%reach(series_levels))*(1 + 8*epsilon(1.0_dp))) + 1
      where (sizes > longest_phase**2)
         status = poinsot_e_step
         parts = 0
      end where
      dy = 0
      dq = 0
      if (largest(parts) > most_substeps) then
         step = merge(h, 0.0_dp, parts > most_substeps)
         call jacobi_increment(class, terms, step, y, q, dy, dq, status)
         where (parts > most_substeps) parts = 0
      end if
      do k = 1, nint(largest(parts))
         step = merge(h, 0.0_dp, k <= parts)/max(parts, 1.0_dp)
         call step_sizes(class, step, y + dy, w, p, r, above)
         call exact_step_increment(class, w, p, r, above, y + dy, q + dq, ddy, ddq)
         dy = dy + ddy
         dq = dq + ddq
      end do
   end subroutine long_increment

end module poinsot_free_exact
