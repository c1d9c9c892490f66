!> The series of the exact step in two bands of degrees: 1 + P, 1 + R and T.
!>
!> A lane that needs the second band takes the sum of both, the others the first alone: a lane's
!> bits do not depend on the lanes beside it, and a block in which lanes differ computes nothing
!> twice.
module poinsot_free_bands
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_body_class, only: body_class
   use poinsot_body_series, only: max_degree
   use poinsot_body_universal, only: sine_squared, high_sine
   implicit none(type, external)
   private
   public :: correction_band, sine_band

contains

   !> 1 + P and 1 + R.
   pure subroutine correction_band(class, p, r, above, ps, rs)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(lanes) :: p, r     !! h^2 p2 and h^2 r2
      real(dp), intent(in) :: above                      !! the largest p + r
      real(dp), intent(out), dimension(lanes) :: ps, rs  !! 1 + P and 1 + R
      real(dp) :: takes(lanes)
      call quartic(class%p, p, r, ps)
      call quartic(class%r, p, r, rs)
      if (above <= class%reach(1)) return
      takes = merge(1.0_dp, 0.0_dp, p + r > class%reach(1))
      call add_septic(class%high_p, p, r, takes, ps)
      call add_septic(class%high_r, p, r, takes, rs)
   end subroutine correction_band

   !> T = S^2, to degree 4 or 7.
   pure subroutine sine_band(class, p, r, above, t)
      type(body_class), intent(in) :: class
      real(dp), intent(in), dimension(lanes) :: p, r     !! h^2 p2 and h^2 r2
      real(dp), intent(in) :: above                      !! the largest p + r
      real(dp), intent(out), dimension(lanes) :: t       !! S^2
      real(dp) :: takes(lanes), c1, c3, e, f, ee, s
      integer :: l
      c1 = 0.25_dp*class%a(1)*class%a(2)
      c3 = 0.25_dp*class%a(2)*class%a(3)
      associate (a => sine_squared)
         !GCC$ ivdep
         do l = 1, lanes
            e = c1*r(l) + c3*p(l)
            f = (c1*r(l))*(c3*p(l))
            t(l) = (((a(4, 0)*e + a(3, 0))*e + a(2, 0))*e + a(1, 0))*e + a(0, 0) &
                   + f*((a(2, 1)*e + a(1, 1))*e + a(0, 1) + a(0, 2)*f)
         end do
      end associate
      if (above <= class%reach(1)) return
      takes = merge(1.0_dp, 0.0_dp, p + r > class%reach(1))
      associate (a => high_sine)
         !GCC$ ivdep
         do l = 1, lanes
            e = c1*r(l) + c3*p(l)
            f = (c1*r(l))*(c3*p(l))
            ee = e*e
            s = e*(a(0, 2) + e*(a(1, 2) + e*a(2, 2))) + f*(a(1, 3) + e*a(2, 3))
            s = s*f + (a(0, 1) + e*(a(1, 1) + e*a(2, 1)))*(e*ee)
            s = s*f + (a(0, 0) + e*(a(1, 0) + e*a(2, 0)))*(e*(ee*ee))
            t(l) = t(l) + takes(l)*s
         end do
      end associate
   end subroutine sine_band

   !> The polynomial of degree 4 with coefficients c(i,j) of p^i r^j.
   pure subroutine quartic(c, p, r, s)
      real(dp), intent(in) :: c(0:max_degree, 0:max_degree), p(lanes), r(lanes)
      real(dp), intent(out) :: s(lanes)
      real(dp) :: x, z
      integer :: l
      !GCC$ ivdep
      do l = 1, lanes
         x = p(l)
         z = r(l)
         s(l) = c(0, 3) + x*c(1, 3) + z*c(0, 4)
         s(l) = c(0, 2) + x*(c(1, 2) + x*c(2, 2)) + z*s(l)
         s(l) = c(0, 1) + x*(c(1, 1) + x*(c(2, 1) + x*c(3, 1))) + z*s(l)
         s(l) = c(0, 0) + x*(c(1, 0) + x*(c(2, 0) + x*(c(3, 0) + x*c(4, 0)))) + z*s(l)
      end do
   end subroutine quartic

   !> s += takes times the degrees 5 to 7.
   pure subroutine add_septic(c, p, r, takes, s)
      real(dp), intent(in) :: c(0:2, 0:6) !! see poinsot_body_economy
      real(dp), intent(in) :: p(lanes), r(lanes), takes(lanes)
      real(dp), intent(inout) :: s(lanes)
      real(dp) :: x, z, e0, e1, e2
      integer :: l
      !GCC$ ivdep
      do l = 1, lanes
         x = p(l)
         z = r(l)
         e0 = (c(0, 0) + x*(c(1, 0) + x*c(2, 0)))*x + (c(0, 1) + x*(c(1, 1) + x*c(2, 1)))*z
         e1 = (c(0, 2) + x*(c(1, 2) + x*c(2, 2)))*x + (c(0, 3) + x*(c(1, 3) + x*c(2, 3)))*z
         e2 = (c(0, 4) + x*(c(1, 4) + x*c(2, 4)))*x &
              + (c(0, 5) + x*(c(1, 5) + x*c(2, 5)) + z*(c(0, 6) + x*c(1, 6) + z*c(2, 6)))*z
         s(l) = s(l) + takes(l)*((e0*(x*x) + e1*(z*z))*(x*x) + e2*((z*z)*(z*z)))
      end do
   end subroutine add_septic

end module poinsot_free_bands
