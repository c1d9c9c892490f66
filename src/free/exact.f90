!> `exact`: the explicit exact step for any h. One evaluation where it is valid, substeps beyond,
!> Jacobi's functions where many substeps would be needed. The choice is a function of the body's
!> state, class and h alone.
module poinsot_free_exact
   use poinsot_core_kinds, only: dp, group, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_step
   use poinsot_body_class, only: body_class, series_levels
   use poinsot_free_accumulate, only: add_plain
   use poinsot_free_exact_step, only: single_pass, single_pass_increments, step_sizes
   use poinsot_free_jacobi_solution, only: jacobi_increment
   implicit none(type, external)
   private
   public :: exact_increment, exact_step, count_substeps

   integer, parameter :: most_substeps = 4 !! beyond, Jacobi's functions are cheaper, and as exact
   real(dp), parameter :: longest_phase = 1e15_dp !! h |omega| beyond which no digit of the angle is
                                                  !! left

contains

   !> Increments of y and q over h, exact to rounding, for every body, any h. Mathematics, section 3
   !> (and 4 beyond 4 substeps). POINSOT_E_STEP for h |omega| > 1e15.
   pure subroutine exact_increment(nvec, class, terms, h, y, q, dy, dq, status)
      integer, intent(in) :: nvec                          !! groups of lanes to work on
      type(body_class), intent(in) :: class                !! of these bodies
      integer, intent(in) :: terms                         !! not used
      real(dp), intent(in) :: h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      real(dp) :: parts(lanes)
      logical :: too_long

      call single_pass_increments(nvec, class, h, y, q, dy, dq, too_long)
      if (.not. too_long) return
      call substeps(nvec, class, h, y, parts, status)
      call long_increment(nvec, class, terms, parts, h, y, q, dy, dq, status)
   end subroutine exact_increment

   !> The same with plain sums, from state to state.
   pure subroutine exact_step(nvec, class, terms, h, y, q, status)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      integer, intent(in) :: terms                         !! not used
      real(dp), intent(in) :: h(lanes)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      integer, intent(inout) :: status(lanes)
      logical :: too_long
      call single_pass(nvec, class, h, y, q, too_long)
      if (too_long) call long_step(nvec, class, terms, h, y, q, status)
   end subroutine exact_step

   !> The same where at least one lane needs more than one pass.
   pure subroutine long_step(nvec, class, terms, h, y, q, status)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      integer, intent(in) :: terms
      real(dp), intent(in) :: h(lanes)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      integer, intent(inout) :: status(lanes)
      real(dp), dimension(lanes) :: parts, short, long
      real(dp) :: dy(lanes, 3), dq(lanes, 4), ys(lanes, 3), qs(lanes, 4), yl(lanes, 3), ql(lanes, 4)
      logical :: too_long, single(lanes)
      integer :: l, n

      call substeps(nvec, class, h, y, parts, status)
      n = group*nvec
      single(:n) = nint(parts(:n)) == 1
      short(:n) = merge(h(:n), 0.0_dp, single(:n))
      ys(:n, :) = y(:n, :)
      qs(:n, :) = q(:n, :)
      call single_pass(nvec, class, short, ys, qs, too_long)
      where (single(:n)) parts(:n) = 0
      call long_increment(nvec, class, terms, parts, h, y, q, dy, dq, status)
      long(:n) = merge(h(:n), 0.0_dp, parts(:n) > 0 .and. status(:n) == poinsot_ok)
      yl(:n, :) = y(:n, :)
      ql(:n, :) = q(:n, :)
      call add_plain(long, dy, dq, yl, ql, nvec)
      do l = 1, n ! each lane from the way it takes, without as much as a zero added by the other
         if (single(l)) then
            y(l, :) = ys(l, :)
            q(l, :) = qs(l, :)
         else if (abs(long(l)) > 0) then
            y(l, :) = yl(l, :)
            q(l, :) = ql(l, :)
         end if
      end do
   end subroutine long_step

   !> How many substeps each lane takes; more than most_substeps: Jacobi's functions; 0 and a status
   !> where h is too long for any way.
   pure subroutine substeps(nvec, class, h, y, parts, status)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes), y(lanes, 3)
      real(dp), intent(out) :: parts(lanes)
      integer, intent(inout) :: status(lanes)
      real(dp) :: w(lanes, 3), p(lanes), r(lanes)
      integer :: l
      call step_sizes(nvec, class, h, y, w, p, r)
      do l = 1, group*nvec
         parts(l) = count_substeps(p(l) + r(l), class%reach(series_levels))
         if (parts(l) < 1) status(l) = poinsot_e_step
      end do
   end subroutine substeps

   !> Substeps for (h |omega|)^2 = s where a pass reaches to `reach`; 0 if no digit would be left.
   elemental real(dp) function count_substeps(s, reach) result(parts)
      real(dp), intent(in) :: s, reach
      parts = 1
      if (s > reach) parts = aint(sqrt(s/reach)*(1 + 8*epsilon(1.0_dp))) + 1
      if (s > longest_phase**2) parts = 0
   end function count_substeps

   !> Increments of lanes in one or more substeps, or by Jacobi's functions; parts = 0: none.
   pure subroutine long_increment(nvec, class, terms, substeps_of, h, y, q, dy, dq, status)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      integer, intent(in) :: terms
      real(dp), intent(in) :: substeps_of(lanes), h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      real(dp), dimension(lanes) :: parts, step
      real(dp) :: ys(lanes, 3), qs(lanes, 4), ddy(lanes, 3), ddq(lanes, 4)
      logical :: too_long
      integer :: n, k, l

      n = group*nvec
      parts(:n) = substeps_of(:n)
      dy(:n, :) = 0
      dq(:n, :) = 0
      if (any(parts(:n) > most_substeps)) then
         step(:n) = merge(h(:n), 0.0_dp, parts(:n) > most_substeps)
         call jacobi_increment(nvec, class, terms, step, y, q, dy, dq, status)
         where (parts(:n) > most_substeps) parts(:n) = 0
      end if
      ys(:n, :) = y(:n, :)
      qs(:n, :) = q(:n, :)
      do k = 1, nint(maxval(parts(:n)))
         step(:n) = merge(h(:n), 0.0_dp, k <= parts(:n))/max(parts(:n), 1.0_dp)
         call single_pass_increments(nvec, class, step, ys, qs, ddy, ddq, too_long)
         if (too_long) exit
         do l = 1, n
            if (k > parts(l)) cycle
            dy(l, :) = merge(ddy(l, :), dy(l, :) + ddy(l, :), k == 1)
            dq(l, :) = merge(ddq(l, :), dq(l, :) + ddq(l, :), k == 1)
            ys(l, :) = y(l, :) + dy(l, :)
            qs(l, :) = q(l, :) + dq(l, :)
         end do
      end do
   end subroutine long_increment

end module poinsot_free_exact
