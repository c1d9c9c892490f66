!> The judge of the hard cases: the free motion as a Taylor series in quadruple precision, in
!> pieces; it shares no formula with any kernel. And how far a motion moves when its inputs do.
module poinsot_study_taylor
   use poinsot_core_kinds, only: dp, qp
   implicit none(type, external)
   private
   public :: taylor_flow, conditioning, largest_rate

   integer, parameter :: highest = 44

contains

   !> Largest |omega| of the whole motion: sqrt(p2 + r2), reached where the middle component
   !> vanishes (mathematics, section 2). inverse = 1/I, 0 for a zero moment.
   pure real(qp) function largest_rate(inverse, y)
      real(qp), intent(in) :: inverse(3), y(3)
      real(qp) :: i(3), w(3), theta, size
      integer :: s(3)
      i = 0
      where (inverse > 0) i = 1/inverse
      s(1) = minloc(i, dim=1)
      s(3) = maxloc(i, dim=1, back=.true.)
      if (s(1) == s(3)) s(3) = 1 + mod(s(1), 3)
      s(2) = 6 - s(1) - s(3)
      i = i(s)
      w = inverse(s)*y(s)
      size = maxval(abs(w))
      largest_rate = 0
      if (.not. size > 0) return
      w = w/size
      theta = 0.5_qp
      if (i(3) > i(1)) theta = (i(3) - i(2))/(i(3) - i(1))
      w(2) = w(2)**2
      largest_rate = w(1)**2 + w(3)**2 + w(2)*i(2)*(theta*inverse(s(1)) + (1 - theta)*inverse(s(3)))
      largest_rate = size*sqrt(largest_rate)
   end function largest_rate

   !> Carry (y, q) over the time t, either sign. `rough`: to 1e-12 instead of 1e-31.
   pure subroutine taylor_flow(inverse, t, y, q, rough)
      real(qp), intent(in) :: inverse(3), t
      real(qp), intent(inout) :: y(3), q(4)
      logical, intent(in) :: rough
      real(qp) :: cy(0:highest, 3), cq(0:highest, 4), w(0:highest, 3), rate(3), piece
      integer :: n, order, i, j, k, l, m
      order = merge(20, highest, rough)
      piece = merge(0.4_qp, 0.3_qp, rough)
      n = 1 + int(abs(t)*largest_rate(inverse, y)/piece)
      rate = inverse*(t/n)
      do i = 1, n
         cy(0, :) = y
         cq(0, :) = q
         do k = 0, order - 1
            w(k, :) = rate*cy(k, :)
            do j = 1, 3
               l = 1 + mod(j, 3)
               m = 6 - j - l
               cy(k + 1, j) = (rate(m) - rate(l))*dot_product(cy(0:k, l), cy(k:0:-1, m))/(k + 1)
            end do
            cq(k + 1, 1) = -(term(1, 1) + term(2, 2) + term(3, 3))
            cq(k + 1, 2) = term(0, 1) + term(2, 3) - term(3, 2)
            cq(k + 1, 3) = term(0, 2) + term(3, 1) - term(1, 3)
            cq(k + 1, 4) = term(0, 3) + term(1, 2) - term(2, 1)
            cq(k + 1, :) = cq(k + 1, :)/(2*(k + 1))
         end do
         y = sum(cy(order:0:-1, :), dim=1)
         q = sum(cq(order:0:-1, :), dim=1)
      end do
   contains
      pure real(qp) function term(a, b)
         integer, intent(in) :: a, b
         term = dot_product(cq(0:k, a + 1), w(k:0:-1, b))
      end function term
   end subroutine taylor_flow

   !> Condition numbers of y(t) and q(t): how far they move, relative to |y| and to 1, when each
   !> input moves by one part, summed over the inputs, at least 1. The state and the time are
   !> inputs, the moments if `with_moments`.
   pure subroutine conditioning(moments, y, t, with_moments, of_y, of_q)
      real(dp), intent(in) :: moments(3), y(3), t
      logical, intent(in) :: with_moments
      real(dp), intent(out) :: of_y, of_q
      real(qp), parameter :: part = 1e-5_qp
      real(qp) :: inverse(3), i(3), z(3), r(4), z0(3), r0(4), time, size
      integer :: j, k
      inverse = 0
      where (moments > 0) inverse = 1/real(moments, qp)
      z0 = y
      r0 = [1, 0, 0, 0]
      call taylor_flow(inverse, real(t, qp), z0, r0, .true.)
      size = norm2(z0)
      of_y = 0
      of_q = 0
      if (size > 0) then
         do j = 1, 7
            if (j > 3 .and. j < 7 .and. .not. with_moments) cycle
            z = y
            i = inverse
            time = t
            k = 1 + mod(j - 1, 3)
            if (j <= 3) then
               z(k) = z(k)*(1 + part)
            else if (j <= 6) then
               i(k) = i(k)*(1 + part)
            else
               time = time*(1 + part)
            end if
            r = [1, 0, 0, 0]
            call taylor_flow(i, time, z, r, .true.)
            of_y = of_y + real(norm2(z - z0)/(part*size), dp)
            of_q = of_q + real(norm2(r - r0)/part, dp)
         end do
      end if
      of_y = max(1.0_dp, of_y)
      of_q = max(1.0_dp, of_q)
   end subroutine conditioning

end module poinsot_study_taylor
