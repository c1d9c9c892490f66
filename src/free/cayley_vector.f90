!> The Cayley vector e of a step of the Moser-Veselov map or of the midpoint rule: the root below 90
!> degrees of e_i = (1 + c |e|^2) z_i - kappa_i e_j e_k, (i, j, k) cyclic. McLachlan and Zanna,
!> Found. Comput. Math. 5, 87 (2005); Lewis and Simo, Fields Inst. Commun. 10, 121 (1996).
module poinsot_free_cayley_vector
   use poinsot_core_kinds, only: dp, i8, group, lanes
   use poinsot_core_lanes, only: largest, smallest
   implicit none(type, external)
   private
   public :: find_cayley_vector

   !> Newton sweeps that reach rounding from the predictor: 1, 2, 3, 4, 7, for (h |omega|)^2 up to
   !> each of these bounds and beyond. With z = h |omega|/2 the predictor is good to z^5, and a
   !> sweep squares the error: z^10, z^20, ...
   real(dp), parameter :: sweep_bound(4) = [0.03_dp**2, 0.25_dp**2, 0.8_dp**2, 1.25_dp**2]

contains

   !> The vector e of each lane by Newton's method, with a number of sweeps fixed beforehand by the
   !> size of the step: it cannot spin in rounding noise. A lane keeps its root once its own sweeps
   !> are done; lanes near a double root get more. `found` is 0 where the last sweep still moved, or
   !> |e| >= 1.
   pure subroutine find_cayley_vector(nvec, quadratic, size, z, kappa, e, found)
      integer, intent(in) :: nvec                             !! groups of lanes to work on
      real(dp), intent(in) :: quadratic                       !! factor of |e|^2: 1, midpoint 0
      real(dp), intent(in) :: size(lanes)                     !! (h |omega|)^2, to choose the sweeps
      real(dp), intent(in) :: z(lanes, 3), kappa(lanes, 3)    !! of the equation
      real(dp), intent(out) :: e(lanes, 3), found(lanes)
      real(dp) :: moved(lanes), ee, e1, e2, e3
      real(dp), dimension(lanes) :: sweeps, active
      integer :: l, k
      real(dp), parameter :: tolerance = 1e-14_dp !! of the last sweep's move squared; what is left
                                                  !! is its square again

      !GCC$ ivdep
      do l = 1, group*nvec
         e1 = z(l, 1) - kappa(l, 1)*z(l, 2)*z(l, 3)
         e2 = z(l, 2) - kappa(l, 2)*z(l, 3)*z(l, 1)
         e3 = z(l, 3) - kappa(l, 3)*z(l, 1)*z(l, 2)
         call sweep(quadratic, z(l, 1), z(l, 2), z(l, 3), kappa(l, 1), kappa(l, 2), kappa(l, 3), &
            e1, e2, e3)
         call sweep(quadratic, z(l, 1), z(l, 2), z(l, 3), kappa(l, 1), kappa(l, 2), kappa(l, 3), &
            e1, e2, e3)
         e(l, 1) = e1
         e(l, 2) = e2
         e(l, 3) = e3
         moved(l) = 0
         sweeps(l) = 1 + merge(1.0_dp, 0.0_dp, size(l) > sweep_bound(1)) &
                     + merge(1.0_dp, 0.0_dp, size(l) > sweep_bound(2)) &
                     + merge(1.0_dp, 0.0_dp, size(l) > sweep_bound(3)) &
                     + merge(3.0_dp, 0.0_dp, size(l) > sweep_bound(4))
      end do
      do k = 1, nint(largest(nvec, sweeps))
         do l = 1, group*nvec
            active(l) = merge(1.0_dp, 0.0_dp, sweeps(l) >= k)
         end do
         call newton(nvec, quadratic, z, kappa, active, e, moved)
      end do
      !GCC$ ivdep
      do l = 1, group*nvec
         ee = e(l, 1)**2 + e(l, 2)**2 + e(l, 3)**2
         found(l) = choose(iand(below(ee, 1.0_dp), not(below(tolerance*ee, moved(l)))), &
            1.0_dp, 0.0_dp)
      end do
      if (smallest(nvec, found) < 1) call iterate_further(nvec, quadratic, z, kappa, e, found)
   end subroutine find_cayley_vector

   !> Lanes without a root so far: near h |omega| = 1 the two roots of the plain map come together
   !> (on a sphere they meet there), and Newton's method halves its distance only. From e = z again,
   !> until a sweep no longer moves; a lane that leaves |e| < 4 is given up.
   pure subroutine iterate_further(nvec, quadratic, z, kappa, e, found)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: quadratic, z(lanes, 3), kappa(lanes, 3)
      real(dp), intent(inout) :: e(lanes, 3), found(lanes)
      real(dp), dimension(lanes) :: active, moved, ee, limit
      real(dp) :: enough
      integer :: k, l
      integer, parameter :: most = 30 !! 2**-30: closer roots are one to a double
      real(dp), parameter :: tolerance(2) = [1e-24_dp, 1e-14_dp] !! where roots lie close, rounding
                                                                  !! moves a lane to the end
      do l = 1, group*nvec
         active(l) = merge(0.0_dp, 1.0_dp, found(l) > 0)
         moved(l) = 0
         if (active(l) > 0) e(l, :) = z(l, :)
      end do
      do k = 1, most
         call newton(nvec, quadratic, z, kappa, active, e, moved)
         enough = tolerance(merge(1, 2, k < most))
         do l = 1, group*nvec
            ee(l) = e(l, 1)**2 + e(l, 2)**2 + e(l, 3)**2
            limit(l) = enough*ee(l)
         end do
         do l = 1, group*nvec
            if (.not. active(l) > 0) cycle
            if (ee(l) < 1 .and. moved(l) <= limit(l)) found(l) = 1
            if (found(l) > 0 .or. ee(l) > 16) active(l) = 0
         end do
         if (.not. largest(nvec, active) > 0) exit
      end do
   end subroutine iterate_further

   !> One sweep of the fixed-point iteration: gains one power of z.
   pure subroutine sweep(quadratic, z1, z2, z3, k1, k2, k3, e1, e2, e3)
      real(dp), intent(in) :: quadratic, z1, z2, z3, k1, k2, k3
      real(dp), intent(inout) :: e1, e2, e3
      real(dp) :: alpha, f1, f2
      alpha = 1 + quadratic*(e1*e1 + e2*e2 + e3*e3)
      f1 = alpha*z1 - k1*e2*e3
      f2 = alpha*z2 - k2*e3*e1
      e3 = alpha*z3 - k3*e1*e2
      e1 = f1
      e2 = f2
   end subroutine sweep

   !> One sweep of Newton's method; `moved` = how far a lane went in its last one, squared.
   pure subroutine newton(nvec, quadratic, z, kappa, active, e, moved)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: quadratic, z(lanes, 3), kappa(lanes, 3)
      real(dp), intent(in) :: active(lanes) !! 1: this lane moves, 0: it keeps its root
      real(dp), intent(inout) :: e(lanes, 3), moved(lanes)
      real(dp) :: f1, f2, f3, al, z1, z2, z3, k1, k2, k3, e1, e2, e3, d1, d2, d3
      real(dp) :: m11, m12, m13, m21, m22, m23, m31, m32, m33, c11, c12, c13, det, two
      integer :: l
      two = 2*quadratic
      !GCC$ ivdep
      do l = 1, group*nvec
         e1 = e(l, 1)
         e2 = e(l, 2)
         e3 = e(l, 3)
         z1 = z(l, 1)
         z2 = z(l, 2)
         z3 = z(l, 3)
         k1 = kappa(l, 1)
         k2 = kappa(l, 2)
         k3 = kappa(l, 3)
         al = 1 + quadratic*(e1*e1 + e2*e2 + e3*e3)
         f1 = al*z1 - k1*e2*e3 - e1
         f2 = al*z2 - k2*e3*e1 - e2
         f3 = al*z3 - k3*e1*e2 - e3
         m11 = 1 - two*z1*e1
         m12 = k1*e3 - two*z1*e2
         m13 = k1*e2 - two*z1*e3
         m21 = k2*e3 - two*z2*e1
         m22 = 1 - two*z2*e2
         m23 = k2*e1 - two*z2*e3
         m31 = k3*e2 - two*z3*e1
         m32 = k3*e1 - two*z3*e2
         m33 = 1 - two*z3*e3
         c11 = m22*m33 - m23*m32
         c12 = m23*m31 - m21*m33
         c13 = m21*m32 - m22*m31
         det = m11*c11 + m12*c12 + m13*c13
         det = active(l)/choose(below(1e-8_dp, abs(det)), det, 1.0_dp)
         d1 = det*(c11*f1 + (m13*m32 - m12*m33)*f2 + (m12*m23 - m13*m22)*f3)
         d2 = det*(c12*f1 + (m11*m33 - m13*m31)*f2 + (m13*m21 - m11*m23)*f3)
         d3 = det*(c13*f1 + (m12*m31 - m11*m32)*f2 + (m11*m22 - m12*m21)*f3)
         e(l, 1) = e1 + d1
         e(l, 2) = e2 + d2
         e(l, 3) = e3 + d3
         moved(l) = choose(below(0.0_dp, active(l)), d1*d1 + d2*d2 + d3*d3, moved(l))
      end do
   end subroutine newton

   include "../core/choose.inc"
   include "../core/below.inc"

end module poinsot_free_cayley_vector
