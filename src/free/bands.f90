!> The series of the exact step by bands of degree: 1 + P, 1 + R, T and W.
!>
!> A lane takes as many bands as its step needs, and none of the others: what a lane gets is a sum
!> of bands, so that its bits do not depend on the lanes beside it, and a block in which lanes
!> differ runs no band twice. Bands end at `level_degree`; T ends one degree lower than the others
!> (poinsot_body_class).
module poinsot_free_bands
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_body_class, only: body_class
   use poinsot_body_series, only: max_degree
   use poinsot_body_universal, only: sine_squared
   use poinsot_free_series, only: correction
   implicit none(type, external)
   private
   public :: low_band, middle_band, high_band

   integer, parameter :: half = ubound(sine_squared, 2)
   integer :: i, j !! of the table below only
   !> W = sum (i + 2j + 1) t(i,j) e^i f^j.
   real(dp), parameter :: product_table(0:max_degree, 0:half) = &
      reshape([((i + 2*j + 1, i=0, max_degree), j=0, half)], shape(sine_squared))*sine_squared

contains

   !> Degrees 0 to 4 (T: 3) of all four series.
   pure subroutine low_band(class, p, r, e, f, ps, rs, t, w)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(lanes) :: p, r     !! h^2 p2 and h^2 r2
      real(dp), intent(in), dimension(lanes) :: e, f     !! X + Z and X Z
      real(dp), intent(out), dimension(lanes) :: ps, rs  !! 1 + P and 1 + R
      real(dp), intent(out), dimension(lanes) :: t, w    !! S^2 and S C D
      integer :: l
      call correction(4, class, p, r, ps, rs)
      associate (a => sine_squared, b => product_table)
         !GCC$ ivdep
         do l = 1, lanes
            t(l) = ((a(3, 0)*e(l) + a(2, 0))*e(l) + a(1, 0))*e(l) + a(0, 0) &
                   + f(l)*(a(1, 1)*e(l) + a(0, 1))
            w(l) = (((b(4, 0)*e(l) + b(3, 0))*e(l) + b(2, 0))*e(l) + b(1, 0))*e(l) + b(0, 0) &
                   + f(l)*((b(2, 1)*e(l) + b(1, 1))*e(l) + b(0, 1) + b(0, 2)*f(l))
         end do
      end associate
   end subroutine low_band

   !> Add degrees 5 and 6 (T: 4 and 5), times `takes`: 1 for lanes that need them, 0 for others.
   pure subroutine middle_band(class, p, r, e, f, takes, ps, rs, t, w)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(lanes) :: p, r, e, f, takes
      real(dp), intent(inout), dimension(lanes) :: ps, rs, t, w
      real(dp) :: ee, ff, s
      integer :: l
      call add_middle(class%p, p, r, takes, ps)
      call add_middle(class%r, p, r, takes, rs)
      associate (a => sine_squared, b => product_table)
         !GCC$ ivdep
         do l = 1, lanes
            ee = e(l)*e(l)
            ff = f(l)*f(l)
            t(l) = t(l) + takes(l)*(((a(4, 0) + a(5, 0)*e(l))*ee + (a(2, 1) + a(3, &
               1)*e(l))*f(l))*ee &
                                    + (a(0, 2) + a(1, 2)*e(l))*ff)
            s = ((b(5, 0) + b(6, 0)*e(l))*ee + (b(3, 1) + b(4, 1)*e(l))*f(l))*ee &
                + (b(1, 2) + b(2, 2)*e(l))*ff
            w(l) = w(l) + takes(l)*(e(l)*s + b(0, 3)*(ff*f(l)))
         end do
      end associate
   end subroutine middle_band

   !> Add degrees 7 to 9 (T: 6 to 8), times `takes`.
   pure subroutine high_band(class, p, r, e, f, takes, ps, rs, t, w)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(lanes) :: p, r, e, f, takes
      real(dp), intent(inout), dimension(lanes) :: ps, rs, t, w
      real(dp) :: x, g, ee, ff, s
      integer :: l
      call add_high(class%p, p, r, takes, ps)
      call add_high(class%r, p, r, takes, rs)
      associate (a => sine_squared, b => product_table)
         !GCC$ ivdep
         do l = 1, lanes
            x = e(l)
            g = f(l)
            ee = x*x
            ff = g*g
            s = ((a(6, 0) + x*(a(7, 0) + x*a(8, 0)))*ee + (a(4, 1) + x*(a(5, 1) + x*a(6, &
               1)))*g)*ee &
                + (a(2, 2) + x*(a(3, 2) + x*a(4, 2)))*ff
            s = s*ee + (a(0, 3) + x*(a(1, 3) + x*a(2, 3)) + a(0, 4)*g)*(ff*g)
            t(l) = t(l) + takes(l)*s
            s = ((b(7, 0) + x*(b(8, 0) + x*b(9, 0)))*ee + (b(5, 1) + x*(b(6, 1) + x*b(7, &
               1)))*g)*ee &
                + (b(3, 2) + x*(b(4, 2) + x*b(5, 2)))*ff
            s = s*ee + (b(1, 3) + x*(b(2, 3) + x*b(3, 3)) + b(1, 4)*g)*(ff*g)
            w(l) = w(l) + takes(l)*(x*s + b(0, 4)*(ff*ff))
         end do
      end associate
   end subroutine high_band

   !> s += takes times the terms of degree 5 and 6, in pairs of powers p^i r^j.
   pure subroutine add_middle(c, p, r, takes, s)
      real(dp), intent(in) :: c(0:max_degree, 0:max_degree), p(lanes), r(lanes), takes(lanes)
      real(dp), intent(inout) :: s(lanes)
      real(dp) :: pp, rr, e0, e1, e2
      integer :: l
      !GCC$ ivdep
      do l = 1, lanes
         pp = p(l)*p(l)
         rr = r(l)*r(l)
         e0 = (c(5, 0) + c(6, 0)*p(l))*p(l) + (c(4, 1) + c(5, 1)*p(l))*r(l)
         e1 = (c(3, 2) + c(4, 2)*p(l))*p(l) + (c(2, 3) + c(3, 3)*p(l))*r(l)
         e2 = (c(1, 4) + c(2, 4)*p(l))*p(l) + (c(0, 5) + c(1, 5)*p(l))*r(l) + c(0, 6)*rr
         s(l) = s(l) + takes(l)*((e0*pp + e1*rr)*pp + e2*(rr*rr))
      end do
   end subroutine add_middle

   !> s += takes times the terms of degree 7 to 9.
   pure subroutine add_high(c, p, r, takes, s)
      real(dp), intent(in) :: c(0:max_degree, 0:max_degree), p(lanes), r(lanes), takes(lanes)
      real(dp), intent(inout) :: s(lanes)
      real(dp) :: x, z, pp, rr, e0, e1, e2, e3
      integer :: l
      !GCC$ ivdep
      do l = 1, lanes
         x = p(l)
         z = r(l)
         pp = x*x
         rr = z*z
         e0 = (c(7, 0) + x*(c(8, 0) + x*c(9, 0)))*x + (c(6, 1) + x*(c(7, 1) + x*c(8, 1)))*z
         e1 = (c(5, 2) + x*(c(6, 2) + x*c(7, 2)))*x + (c(4, 3) + x*(c(5, 3) + x*c(6, 3)))*z
         e2 = (c(3, 4) + x*(c(4, 4) + x*c(5, 4)))*x + (c(2, 5) + x*(c(3, 5) + x*c(4, 5)))*z
         e3 = (c(1, 6) + x*(c(2, 6) + x*c(3, 6)))*x + (c(0, 7) + x*(c(1, 7) + x*c(2, 7)))*z &
              + (c(0, 8) + c(1, 8)*x + c(0, 9)*z)*rr
         s(l) = s(l) + takes(l)*(((e0*pp + e1*rr)*pp + e2*(rr*rr))*pp + e3*(rr*rr*rr))
      end do
   end subroutine add_high

end module poinsot_free_bands
