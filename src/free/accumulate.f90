!> How increments become the next state: plainly, or with compensated sums.
!>
!> Compensated, the carry holds what rounding took from y and q. Two corrections then remove what is
!> left of the drift (mathematics, section 3): the change of energy that the increment itself
!> implies, and the norm of q. Both are computed from increments and from the present state, never
!> from stored invariants. Vilmart (2008), section 3.
module poinsot_free_accumulate
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_body_class, only: body_class
   implicit none(type, external)
   private
   public :: add_plain, add_compensated, add_kick, add_kick_compensated, conserve_energy

contains

   !> y += dy, q += dq, with |q| drawn to 1. A lane with h = 0 keeps its bits.
   pure subroutine add_plain(h, dy, dq, y, q)
      real(dp), intent(in) :: h(lanes), dy(lanes, 3), dq(lanes, 4)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      real(dp) :: excess
      integer :: l
      !GCC$ ivdep
      do l = 1, lanes
         excess = merge(0.5_dp, 0.0_dp, abs(h(l)) > 0) &
                  *((q(l, 1)**2 + q(l, 2)**2) + (q(l, 3)**2 + q(l, 4)**2) - 1)
         y(l, 1) = y(l, 1) + dy(l, 1)
         y(l, 2) = y(l, 2) + dy(l, 2)
         y(l, 3) = y(l, 3) + dy(l, 3)
         q(l, 1) = q(l, 1) + (dq(l, 1) - excess*q(l, 1))
         q(l, 2) = q(l, 2) + (dq(l, 2) - excess*q(l, 2))
         q(l, 3) = q(l, 3) + (dq(l, 3) - excess*q(l, 3))
         q(l, 4) = q(l, 4) + (dq(l, 4) - excess*q(l, 4))
      end do
   end subroutine add_plain

   !> The same with compensated sums; carry = (3 of y, 4 of q), what rounding has taken so far.
   pure subroutine add_compensated(h, dy, dq, y, q, carry)
      real(dp), intent(in) :: h(lanes), dy(lanes, 3), dq(lanes, 4)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4), carry(lanes, 7)
      real(dp) :: excess(lanes)
      integer :: l, j
      !GCC$ ivdep
      do l = 1, lanes
         excess(l) = merge(0.5_dp, 0.0_dp, abs(h(l)) > 0) &
                     *((q(l, 1)**2 + q(l, 2)**2) + (q(l, 3)**2 + q(l, 4)**2) - 1)
      end do
      call add_kick_compensated(dy, y, carry)
      do j = 1, 4
         !GCC$ ivdep
         do l = 1, lanes
            call two_sum(q(l, j), carry(l, 3 + j), dq(l, j) - excess(l)*q(l, j))
         end do
      end do
   end subroutine add_compensated

   !> y += dy: the sum of a kick.
   pure subroutine add_kick(dy, y)
      real(dp), intent(in) :: dy(lanes, 3)
      real(dp), intent(inout) :: y(lanes, 3)
      y = y + dy
   end subroutine add_kick

   !> y += dy with the first three columns of the carry.
   pure subroutine add_kick_compensated(dy, y, carry)
      real(dp), intent(in) :: dy(lanes, 3)
      real(dp), intent(inout) :: y(lanes, 3), carry(lanes, 7)
      integer :: l, j
      do j = 1, 3
         !GCC$ ivdep
         do l = 1, lanes
            call two_sum(y(l, j), carry(l, j), dy(l, j))
         end do
      end do
   end subroutine add_kick_compensated

   !> x + carry + d without loss: Knuth's sum, no test of sizes.
   pure subroutine two_sum(x, carry, d)
      real(dp), intent(inout) :: x, carry
      real(dp), intent(in) :: d
      real(dp) :: add, sum, part
      add = d + carry
      sum = x + add
      part = sum - x
      carry = (x - (sum - part)) + (add - part)
      x = sum
   end subroutine two_sum

   !> Take from dy the change of energy it implies, dE = sum dy (omega + d omega / 2), along G, the
   !> part of the new omega normal to the new y, so that |y| is not touched. Skipped where G is
   !> small: nothing can be gained there.
   pure subroutine conserve_energy(class, h, y, dy)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes), y(lanes, 3)
      real(dp), intent(inout) :: dy(lanes, 3)
      real(dp) :: i1, i2, i3, w1, w2, w3, y1, y2, y3, e, yy, yw, ww, gg, f, scale, biggest, alive
      integer :: l
      real(dp), parameter :: small = 1e-4_dp
      i1 = class%inverse(1)
      i2 = class%inverse(2)
      i3 = class%inverse(3)
      !GCC$ ivdep
      do l = 1, lanes
         e = h(l)*(dy(l, 1)*i1*(y(l, 1) + 0.5_dp*dy(l, 1)) + dy(l, 2)*i2*(y(l, 2) + 0.5_dp*dy(l, &
            2)) &
                   + dy(l, 3)*i3*(y(l, 3) + 0.5_dp*dy(l, 3)))
         y1 = y(l, 1) + dy(l, 1)
         y2 = y(l, 2) + dy(l, 2)
         y3 = y(l, 3) + dy(l, 3)
         biggest = abs(y1) + abs(y2) + abs(y3)
         alive = merge(1.0_dp, 0.0_dp, biggest > tiny(1.0_dp))
         scale = alive/(biggest + (1 - alive))
         w1 = h(l)*(y1*i1)
         w2 = h(l)*(y2*i2)
         w3 = h(l)*(y3*i3)
         y1 = y1*scale
         y2 = y2*scale
         y3 = y3*scale
         yy = y1*y1 + y2*y2 + y3*y3 + (1 - alive)
         yw = (y1*w1 + y2*w2 + y3*w3)/yy
         ww = w1*w1 + w2*w2 + w3*w3
         w1 = w1 - yw*y1
         w2 = w2 - yw*y2
         w3 = w3 - yw*y3
         gg = w1*w1 + w2*w2 + w3*w3
         alive = merge(1.0_dp, 0.0_dp, gg > small*ww)
         f = alive*e/(gg + (1 - alive))
         dy(l, 1) = dy(l, 1) - f*w1
         dy(l, 2) = dy(l, 2) - f*w2
         dy(l, 3) = dy(l, 3) - f*w3
      end do
   end subroutine conserve_energy

end module poinsot_free_accumulate
