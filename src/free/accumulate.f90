!> Adding increments to the state, with plain or compensated sums.
!>
!> With compensated sums, the carry holds the rounding errors of y and q. Three corrections then
!> remove the remaining drift (mathematics, section 3): the changes of |y| and of energy that the
!> increment itself implies, and the norm of q. All are computed from increments and from the
!> present state, never from stored invariants. Vilmart (2008), section 3.
module poinsot_free_accumulate
   use poinsot_core_kinds, only: dp, i8, group, lanes
   use poinsot_body_class, only: body_class
   implicit none(type, external)
   private
   public :: add_plain, add_compensated, add_kick, add_kick_compensated, conserve, conserve_each

contains

   !> y += dy, q += dq, with |q| drawn to 1. A lane with h = 0 keeps its bits.
   pure subroutine add_plain(h, dy, dq, y, q, nvec)
      integer, intent(in), optional :: nvec !! groups of lanes to work on, instead of all
      real(dp), intent(in) :: h(lanes), dy(lanes, 3), dq(lanes, 4)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      real(dp) :: excess
      integer :: l, n
      n = working(nvec)
      !GCC$ ivdep
      do l = 1, n
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
   pure subroutine add_compensated(h, dy, dq, y, q, carry, nvec)
      integer, intent(in), optional :: nvec
      real(dp), intent(in) :: h(lanes), dy(lanes, 3), dq(lanes, 4)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4), carry(lanes, 7)
      real(dp) :: excess(lanes)
      integer :: l, j, n
      n = working(nvec)
      !GCC$ ivdep
      do l = 1, n
         excess(l) = merge(0.5_dp, 0.0_dp, abs(h(l)) > 0) &
                     *((q(l, 1)**2 + q(l, 2)**2) + (q(l, 3)**2 + q(l, 4)**2) - 1)
      end do
      call add_kick_compensated(dy, y, carry, nvec)
      do j = 1, 4
         !GCC$ ivdep
         do l = 1, n
            call two_sum(q(l, j), carry(l, 3 + j), dq(l, j) - excess(l)*q(l, j))
         end do
      end do
   end subroutine add_compensated

   !> y += dy: the sum of a kick.
   pure subroutine add_kick(dy, y, nvec)
      integer, intent(in), optional :: nvec
      real(dp), intent(in) :: dy(lanes, 3)
      real(dp), intent(inout) :: y(lanes, 3)
      integer :: n
      n = working(nvec)
      y(:n, :) = y(:n, :) + dy(:n, :)
   end subroutine add_kick

   !> y += dy with the first three columns of the carry.
   pure subroutine add_kick_compensated(dy, y, carry, nvec)
      integer, intent(in), optional :: nvec
      real(dp), intent(in) :: dy(lanes, 3)
      real(dp), intent(inout) :: y(lanes, 3), carry(lanes, 7)
      integer :: l, j, n
      n = working(nvec)
      do j = 1, 3
         !GCC$ ivdep
         do l = 1, n
            call two_sum(y(l, j), carry(l, j), dy(l, j))
         end do
      end do
   end subroutine add_kick_compensated

   !> Lanes to work on.
   pure integer function working(nvec)
      integer, intent(in), optional :: nvec
      working = lanes
      if (present(nvec)) working = group*nvec
      working = iand(working, not(group - 1)) ! says to the compiler that none is left over
   end function working

   !> x + carry + d without loss: Knuth's sum, no test of sizes.
   pure subroutine two_sum(x, carry, d)
      real(dp), intent(inout) :: x, carry
      real(dp), intent(in) :: d
      real(dp) :: sum, part, rest
      sum = x + d
      part = sum - x
      rest = carry + ((x - (sum - part)) + (d - part))
      x = sum + rest
      carry = rest - (x - sum)
   end subroutine two_sum

   !> Take from the sums the changes of |y| and of energy that the increment implies and that the
   !> motion does not have: dC = sum dy m, along the new y, m = y + carry + dy/2; then dE = sum dy
   !> m/I, along G, the part of the new omega normal to the new y, so that |y| is not touched again.
   !> The second only for a method that conserves energy, and not where G is small: nothing can be
   !> gained there. Both go into the carry: in dy they would be rounded again. dE is taken about the
   !> middle axis, dE - dC/I2: one term less that rounds. 1/I1 - 1/I2 and 1/I3 - 1/I2 come from
   !> differences of moments: of the reciprocals of moments nearly alike little would be left, and a
   !> needle's small momentum about its axis would be moved by what is missing.
   pure subroutine conserve(class, energy, h, y, dy, carry, nvec)
      type(body_class), intent(in) :: class  !! of these bodies
      logical, intent(in) :: energy          !! does the method conserve energy?
      real(dp), intent(in) :: h(lanes), y(lanes, 3), dy(lanes, 3)
      real(dp), intent(inout) :: carry(lanes, 7)
      integer, intent(in), optional :: nvec
      real(dp) :: inverse(lanes, 3), gap(lanes, 2)
      integer :: j, n
      n = working(nvec)
      do j = 1, 3
         inverse(:n, j) = class%inverse(j)
      end do
      gap(:n, 1) = (class%sorted(2) - class%sorted(1))/class%sorted(2)
      gap(:n, 2) = (class%sorted(3) - class%sorted(2))/class%sorted(3)
      call conserve_each(inverse, gap, class%order, energy, h, y, dy, carry, n/group)
   end subroutine conserve

   !> The same for bodies that all differ.
   pure subroutine conserve_each(inverse, gap, order, energy, h, y, dy, carry, nvec)
      real(dp), intent(in) :: inverse(lanes, 3) !! 1/moment, or minus that for all three
      real(dp), intent(in) :: gap(lanes, 2)     !! (I2-I1)/I2 and (I3-I2)/I3
      integer, intent(in) :: order(3)           !! of the axes, by moment
      logical, intent(in) :: energy
      real(dp), intent(in) :: h(lanes), y(lanes, 3), dy(lanes, 3)
      real(dp), intent(inout) :: carry(lanes, 7)
      integer, intent(in) :: nvec
      real(dp) :: i1, i2, i3, d13, d23, w1, w2, w3, y1, y2, y3, d1, d2, d3, m1, m2, m3, r1, r2, r3
      real(dp) :: e, c, yy, yw, ww, gg, f, scale, biggest, alive, wanted
      integer :: l, j1, j2, j3, n
      real(dp), parameter :: small = 1e-4_dp
      n = iand(group*nvec, not(group - 1))
      j1 = order(1)
      j3 = order(2)
      j2 = order(3)
      wanted = merge(1.0_dp, 0.0_dp, energy)
      !GCC$ ivdep
      do l = 1, n
         i1 = inverse(l, j1)
         i2 = inverse(l, j2)
         i3 = inverse(l, j3)
         d13 = gap(l, 1)*i1
         d23 = -gap(l, 2)*i3
         y1 = y(l, j1) + dy(l, j1)
         y2 = y(l, j2) + dy(l, j2)
         y3 = y(l, j3) + dy(l, j3)
         biggest = abs(y1) + abs(y2) + abs(y3)
         alive = choose(below(tiny(1.0_dp), biggest), 1.0_dp, 0.0_dp)
         scale = alive/(biggest + (1 - alive))
         w1 = h(l)*(y1*i1)
         w2 = h(l)*(y2*i2)
         w3 = h(l)*(y3*i3)
         y1 = y1*scale
         y2 = y2*scale
         y3 = y3*scale
         d1 = dy(l, j1)*scale
         d2 = dy(l, j2)*scale
         d3 = dy(l, j3)*scale
         yy = y1*y1 + y2*y2 + y3*y3 + (1 - alive)
         m1 = y(l, j1) + 0.5_dp*dy(l, j1)
         m2 = y(l, j2) + 0.5_dp*dy(l, j2)
         m3 = y(l, j3) + 0.5_dp*dy(l, j3)
         r1 = carry(l, j1) + (0.5_dp*dy(l, j1) - (m1 - y(l, j1)))
         r2 = carry(l, j2) + (0.5_dp*dy(l, j2) - (m2 - y(l, j2)))
         r3 = carry(l, j3) + (0.5_dp*dy(l, j3) - (m3 - y(l, j3)))
         c = scale*((d1*m1 + d2*m2 + d3*m3) + (d1*r1 + d2*r2 + d3*r3))
         e = h(l)*((d1*m1*d13 + d2*m2*d23) + (d1*r1*d13 + d2*r2*d23))
         yw = (y1*w1 + y2*w2 + y3*w3)/yy
         c = c/yy
         f = (y1*y1*d13 + y2*y2*d23)
         e = e - c*(h(l)*(f*biggest))
         ww = w1*w1 + w2*w2 + w3*w3
         w1 = w1 - yw*y1
         w2 = w2 - yw*y2
         w3 = w3 - yw*y3
         gg = w1*w1 + w2*w2 + w3*w3
         alive = choose(below(small*ww, gg), 1.0_dp, 0.0_dp)
         f = wanted*alive*e/(gg + (1 - alive))
         carry(l, j1) = carry(l, j1) - biggest*(c*y1 + f*w1)
         carry(l, j2) = carry(l, j2) - biggest*(c*y2 + f*w2)
         carry(l, j3) = carry(l, j3) - biggest*(c*y3 + f*w3)
      end do
   end subroutine conserve_each

   include "../core/choose.inc"
   include "../core/below.inc"

end module poinsot_free_accumulate
