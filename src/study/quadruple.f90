!> Free bodies in quadruple precision: the reference for double precision.
!>
!> The explicit exact step (mathematics, section 3) with its series summed for the given body: p2
!> and r2 are constants of the motion, so the series are evaluated once and the steps are closed
!> formulas. Steps of half a radian; the error after a thousand of them is about 1e-30.
module poinsot_study_quadruple
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_order, only: ascending_order
   implicit none(type, external)
   private
   public :: turn_freely, cross

   integer, parameter :: terms = 24                 !! of the series
   real(qp), parameter :: longest_default = 0.5_qp  !! step times angular velocity

   !> One body with moments sorted, and what its steps of one length have in common.
   type :: sorted_body
      integer :: order(3) = [1, 2, 3]
      real(dp) :: parity = 1
      real(qp) :: i(3) = 1, inverse(3) = 1
      real(qp) :: a(3) = 0, th = 0.5_qp
      real(qp) :: h = 0
      real(qp) :: c(3) = 0                   !! 1 + c_j of the section
      real(qp) :: s = 1, cf = 1, df = 1      !! S_f, C_f, D_f
   end type sorted_body

contains

   !> State of one body after time t.
   pure subroutine turn_freely(moments, y0, q0, t, y, q, finer)
      real(dp), intent(in) :: moments(3)       !! principal moments, any order; 0 where y0 is 0 too
      real(dp), intent(in) :: y0(3), q0(4)     !! angular momentum, attitude
      real(dp), intent(in) :: t                !! either sign
      real(qp), intent(out) :: y(3), q(4)      !! after t; |q| = 1
      integer, intent(in), optional :: finer   !! that many times as many steps: to judge the error
      type(sorted_body) :: body
      real(qp) :: speed, longest, work(3), rho(4)
      integer :: k, steps
      call sort_body(moments, body)
      work = body%parity*real(y0(body%order), qp)
      q = real(q0, qp)/sqrt(sum(real(q0, qp)**2))
      speed = sqrt(sum(work**2*body%inverse))*sqrt(maxval(body%inverse))
      longest = longest_default
      if (present(finer)) longest = longest/finer
      steps = max(1, ceiling(abs(t)*speed/longest))
      body%h = real(t, qp)/steps
      call sum_series(body, work)
      do k = 1, steps
         call step(body, work, rho)
         q = product_of(q, rho)
         q = q*(3 - sum(q**2))/2
      end do
      y(body%order) = body%parity*work
   end subroutine turn_freely

   !> Constants of the moments alone.
   pure subroutine sort_body(moments, body)
      real(dp), intent(in) :: moments(3)
      type(sorted_body), intent(out) :: body
      integer :: j
      call ascending_order(moments, body%order, body%parity)
      body%i = moments(body%order)
      do j = 1, 3
         body%inverse(j) = 0
         if (body%i(j) > 0) body%inverse(j) = 1/body%i(j)
      end do
      associate (i => body%i)
         body%a = [i(3) - i(2), i(3) - i(1), i(2) - i(1)]*body%inverse
         if (i(3) > i(1)) body%th = (i(3) - i(2))/(i(3) - i(1))
      end associate
   end subroutine sort_body

   !> Everything that is the same in all steps of this body.
   pure subroutine sum_series(body, y)
      type(sorted_body), intent(inout) :: body
      real(qp), intent(in) :: y(3)
      real(qp) :: w(3), p2, r2, x, z, s(0:terms), c(0:terms + 1), d(0:terms + 1), ss, cc, dd, xs, &
         zs, den
      integer :: n
      w = y*body%inverse
      p2 = w(1)**2 + body%th*body%i(2)*body%inverse(1)*w(2)**2
      r2 = w(3)**2 + (1 - body%th)*body%i(2)*body%inverse(3)*w(2)**2
      call preprocess(body, p2, r2)
      x = body%a(1)*body%a(2)*r2*body%h**2/4
      z = body%a(2)*body%a(3)*p2*body%h**2/4
      s = 0
      c = 0
      d = 0
      c(0) = 1
      d(0) = 1
      do n = 0, terms
         s(n) = folded(c, d, n)/(2*n + 1)
         c(n + 1) = -x*folded(s, d, n)/(2*n + 2)
         d(n + 1) = -z*folded(s, c, n)/(2*n + 2)
      end do
      ss = sum(s)
      cc = sum(c(:terms))
      dd = sum(d(:terms))
      xs = x*ss**2
      zs = z*ss**2
      den = 1 - xs*zs
      body%s = body%h*ss*cc*dd/den
      body%cf = (cc**2 - xs*dd**2)/den
      body%df = (dd**2 - zs*cc**2)/den
   end subroutine sum_series

   !> 1 + P and 1 + R from the motion that starts where omega2 = 0, at t = h/2.
   pure subroutine preprocess(body, p2, r2)
      type(sorted_body), intent(inout) :: body
      real(qp), intent(in) :: p2, r2
      real(qp), dimension(0:terms + 1) :: f, g, k, q0, q1, q2, q3
      real(qp) :: t2, vf, vg, v0, v1, v2, v3, rho0, p, r
      integer :: n
      f = 0; g = 0; k = 0; q0 = 0; q1 = 0; q2 = 0; q3 = 0
      f(0) = 1
      g(0) = 1
      q0(0) = 1
      do n = 0, terms
         k(n) = body%a(2)*folded(f, g, n)/(2*n + 1)
         q1(n) = folded(q0, f, n)
         q3(n) = folded(q0, g, n)
         if (n > 0) q1(n) = q1(n) + r2*(folded(q2, g, n - 1) - folded(q3, k, n - 1))
         if (n > 0) q3(n) = q3(n) + p2*(folded(q1, k, n - 1) - folded(q2, f, n - 1))
         q1(n) = q1(n)/(2*(2*n + 1))
         q3(n) = q3(n)/(2*(2*n + 1))
         q2(n) = (folded(q0, k, n) - folded(q1, g, n) + folded(q3, f, n))/(2*(2*n + 2))
         f(n + 1) = -body%a(1)*r2*folded(k, g, n)/(2*n + 2)
         g(n + 1) = -body%a(3)*p2*folded(k, f, n)/(2*n + 2)
         q0(n + 1) = p2*folded(q1, f, n) + r2*folded(q3, g, n)
         if (n > 0) q0(n + 1) = q0(n + 1) + p2*r2*folded(q2, k, n - 1)
         q0(n + 1) = -q0(n + 1)/(2*(2*n + 2))
      end do
      t2 = body%h**2/4
      vf = value_at(f, t2)
      vg = value_at(g, t2)
      v0 = value_at(q0, t2)
      v1 = value_at(q1, t2)
      v2 = value_at(q2, t2)
      v3 = value_at(q3, t2)
      rho0 = v0**2 - p2*t2*v1**2 + p2*r2*t2**2*v2**2 - r2*t2*v3**2
      p = 2*rho0*(v0*v1 - r2*t2*v2*v3)/vf
      r = 2*rho0*(v0*v3 + p2*t2*v1*v2)/vg
      body%c = [p, body%th*p + (1 - body%th)*r, r]
   end subroutine preprocess

   !> Coefficient n of a product of series.
   pure real(qp) function folded(x, z, n)
      integer, intent(in) :: n
      real(qp), intent(in) :: x(0:n), z(0:n)
      folded = dot_product(x(0:n), z(n:0:-1))
   end function folded

   pure real(qp) function value_at(x, t)
      real(qp), intent(in) :: x(0:), t
      integer :: n
      value_at = 0
      do n = ubound(x, 1), 0, -1
         value_at = value_at*t + x(n)
      end do
   end function value_at

   !> Momentum after one step, and the turn.
   pure subroutine step(body, y, rho)
      type(sorted_body), intent(in) :: body
      real(qp), intent(inout) :: y(3)
      real(qp), intent(out) :: rho(4)
      real(qp) :: w(3), n(3), v(3), d
      w = y*body%inverse
      associate (a => body%a, s => body%s, c => body%cf, df => body%df)
         d = 1/(1 - a(1)*a(3)*(w(2)*s)**2)
         n(1) = (w(1)*c - a(1)*w(2)*w(3)*s*df)*d
         n(2) = (w(2)*c*df + a(2)*w(1)*w(3)*s)*d
         n(3) = (w(3)*df - a(3)*w(1)*w(2)*s*c)*d
      end associate
      v = body%h/4*body%c*(w + n)
      rho(1) = sqrt(0.5_qp + sqrt(1 - 4*sum(v**2))/2)
      rho(2:4) = v/rho(1)
      ! R(rho)^T y
      w = 2*cross(y, rho(2:4))
      y = y + rho(1)*w + cross(w, rho(2:4))
      where (.not. body%i > 0) y = 0
      rho(2:4) = body%parity*rho(2:4)
      call unsort(body%order, rho(2:4))
   end subroutine step

   !> From sorted axes to the caller's.
   pure subroutine unsort(order, v)
      integer, intent(in) :: order(3)
      real(qp), intent(inout) :: v(3)
      real(qp) :: keep(3)
      keep = v
      v(order) = keep
   end subroutine unsort

   !> u x v.
   pure function cross(u, v) result(w)
      real(qp), intent(in) :: u(3), v(3)
      real(qp) :: w(3)
      w = [u(2)*v(3) - u(3)*v(2), u(3)*v(1) - u(1)*v(3), u(1)*v(2) - u(2)*v(1)]
   end function cross

   pure function product_of(p, q) result(r)
      real(qp), intent(in) :: p(4), q(4)
      real(qp) :: r(4)
      r(1) = p(1)*q(1) - dot_product(p(2:4), q(2:4))
      r(2:4) = p(1)*q(2:4) + q(1)*p(2:4) + cross(p(2:4), q(2:4))
   end function product_of

end module poinsot_study_quadruple
