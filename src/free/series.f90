!> The series of a block of bodies of one class: 1 + P and 1 + R to any degree from 1 to 11, orders
!> 4 to 24.
!>
!> Written out, one loop per degree, because only straight-line code keeps a bivariate Horner scheme
!> in vector registers.
module poinsot_free_series
   use poinsot_core_kinds, only: dp, group, lanes
   use poinsot_body_class, only: body_class, long_series, highest_degree
   use poinsot_body_series_start, only: start_degree
   implicit none(type, external)
   private
   public :: correction

contains

   !> 1 + P(p, r) and 1 + R(p, r) to a given degree in h^2, lane by lane. Mathematics, sections 2
   !> and 3.
   pure subroutine correction(nvec, degree, class, p, r, ps, rs)
      integer, intent(in) :: nvec                    !! groups of lanes to work on
      integer, intent(in) :: degree                  !! 0 (none) to 11
      type(body_class), intent(in) :: class          !! of these bodies
      real(dp), intent(in) :: p(lanes), r(lanes)     !! h^2 p2 and h^2 r2, constants of the motion
      real(dp), intent(out) :: ps(lanes), rs(lanes)  !! 1 + P and 1 + R
      real(dp) :: c(0:highest_degree, 0:highest_degree, 2)
      integer :: l
      if (degree <= start_degree) then
         call polynomial(nvec, degree, start_degree, class%half_p, p, r, ps)
         call polynomial(nvec, degree, start_degree, class%half_r, p, r, rs)
         !GCC$ ivdep
         do l = 1, group*nvec
            ps(l) = 2*ps(l)
            rs(l) = 2*rs(l)
         end do
      else if (allocated(class%higher)) then
         call polynomial(nvec, degree, highest_degree, class%higher(:, :, 1), p, r, ps)
         call polynomial(nvec, degree, highest_degree, class%higher(:, :, 2), p, r, rs)
      else
         call long_series(class, degree, c)
         call polynomial(nvec, degree, highest_degree, c(:, :, 1), p, r, ps)
         call polynomial(nvec, degree, highest_degree, c(:, :, 2), p, r, rs)
      end if
   end subroutine correction

   !> One bivariate polynomial: rows are Horner schemes in x, nested in powers of y.
   pure subroutine polynomial(nvec, degree, most, c, x, y, f)
      integer, intent(in) :: nvec, degree, most
      real(dp), intent(in) :: c(0:most, 0:most), x(lanes), y(lanes)
      real(dp), intent(out) :: f(lanes)
      integer :: l, n
      n = iand(group*nvec, not(group - 1)) ! says to the compiler that no lane is left over
      select case (degree)
      case (1)
         !GCC$ ivdep
         do l = 1, n
            f(l) = c(0, 1)
            f(l) = f(l)*y(l) + h1(c(0, 0), x(l))
         end do
      case (2)
         !GCC$ ivdep
         do l = 1, n
            f(l) = c(0, 2)
            f(l) = f(l)*y(l) + h1(c(0, 1), x(l))
            f(l) = f(l)*y(l) + h2(c(0, 0), x(l))
         end do
      case (3)
         !GCC$ ivdep
         do l = 1, n
            f(l) = c(0, 3)
            f(l) = f(l)*y(l) + h1(c(0, 2), x(l))
            f(l) = f(l)*y(l) + h2(c(0, 1), x(l))
            f(l) = f(l)*y(l) + h3(c(0, 0), x(l))
         end do
      case (4)
         !GCC$ ivdep
         do l = 1, n
            f(l) = c(0, 4)
            f(l) = f(l)*y(l) + h1(c(0, 3), x(l))
            f(l) = f(l)*y(l) + h2(c(0, 2), x(l))
            f(l) = f(l)*y(l) + h3(c(0, 1), x(l))
            f(l) = f(l)*y(l) + h4(c(0, 0), x(l))
         end do
      case (5)
         !GCC$ ivdep
         do l = 1, n
            f(l) = c(0, 5)
            f(l) = f(l)*y(l) + h1(c(0, 4), x(l))
            f(l) = f(l)*y(l) + h2(c(0, 3), x(l))
            f(l) = f(l)*y(l) + h3(c(0, 2), x(l))
            f(l) = f(l)*y(l) + h4(c(0, 1), x(l))
            f(l) = f(l)*y(l) + h5(c(0, 0), x(l))
         end do
      case (6)
         !GCC$ ivdep
         do l = 1, n
            f(l) = c(0, 6)
            f(l) = f(l)*y(l) + h1(c(0, 5), x(l))
            f(l) = f(l)*y(l) + h2(c(0, 4), x(l))
            f(l) = f(l)*y(l) + h3(c(0, 3), x(l))
            f(l) = f(l)*y(l) + h4(c(0, 2), x(l))
            f(l) = f(l)*y(l) + h5(c(0, 1), x(l))
            f(l) = f(l)*y(l) + h6(c(0, 0), x(l))
         end do
      case (7)
         !GCC$ ivdep
         do l = 1, n
            f(l) = c(0, 7)
            f(l) = f(l)*y(l) + h1(c(0, 6), x(l))
            f(l) = f(l)*y(l) + h2(c(0, 5), x(l))
            f(l) = f(l)*y(l) + h3(c(0, 4), x(l))
            f(l) = f(l)*y(l) + h4(c(0, 3), x(l))
            f(l) = f(l)*y(l) + h5(c(0, 2), x(l))
            f(l) = f(l)*y(l) + h6(c(0, 1), x(l))
            f(l) = f(l)*y(l) + h7(c(0, 0), x(l))
         end do
      case (8)
         !GCC$ ivdep
         do l = 1, n
            f(l) = c(0, 8)
            f(l) = f(l)*y(l) + h1(c(0, 7), x(l))
            f(l) = f(l)*y(l) + h2(c(0, 6), x(l))
            f(l) = f(l)*y(l) + h3(c(0, 5), x(l))
            f(l) = f(l)*y(l) + h4(c(0, 4), x(l))
            f(l) = f(l)*y(l) + h5(c(0, 3), x(l))
            f(l) = f(l)*y(l) + h6(c(0, 2), x(l))
            f(l) = f(l)*y(l) + h7(c(0, 1), x(l))
            f(l) = f(l)*y(l) + h8(c(0, 0), x(l))
         end do
      case (9)
         !GCC$ ivdep
         do l = 1, n
            f(l) = c(0, 9)
            f(l) = f(l)*y(l) + h1(c(0, 8), x(l))
            f(l) = f(l)*y(l) + h2(c(0, 7), x(l))
            f(l) = f(l)*y(l) + h3(c(0, 6), x(l))
            f(l) = f(l)*y(l) + h4(c(0, 5), x(l))
            f(l) = f(l)*y(l) + h5(c(0, 4), x(l))
            f(l) = f(l)*y(l) + h6(c(0, 3), x(l))
            f(l) = f(l)*y(l) + h7(c(0, 2), x(l))
            f(l) = f(l)*y(l) + h8(c(0, 1), x(l))
            f(l) = f(l)*y(l) + h9(c(0, 0), x(l))
         end do
      case (10)
         !GCC$ ivdep
         do l = 1, n
            f(l) = c(0, 10)
            f(l) = f(l)*y(l) + h1(c(0, 9), x(l))
            f(l) = f(l)*y(l) + h2(c(0, 8), x(l))
            f(l) = f(l)*y(l) + h3(c(0, 7), x(l))
            f(l) = f(l)*y(l) + h4(c(0, 6), x(l))
            f(l) = f(l)*y(l) + h5(c(0, 5), x(l))
            f(l) = f(l)*y(l) + h6(c(0, 4), x(l))
            f(l) = f(l)*y(l) + h7(c(0, 3), x(l))
            f(l) = f(l)*y(l) + h8(c(0, 2), x(l))
            f(l) = f(l)*y(l) + h9(c(0, 1), x(l))
            f(l) = f(l)*y(l) + h10(c(0, 0), x(l))
         end do
      case (11)
         !GCC$ ivdep
         do l = 1, n
            f(l) = c(0, 11)
            f(l) = f(l)*y(l) + h1(c(0, 10), x(l))
            f(l) = f(l)*y(l) + h2(c(0, 9), x(l))
            f(l) = f(l)*y(l) + h3(c(0, 8), x(l))
            f(l) = f(l)*y(l) + h4(c(0, 7), x(l))
            f(l) = f(l)*y(l) + h5(c(0, 6), x(l))
            f(l) = f(l)*y(l) + h6(c(0, 5), x(l))
            f(l) = f(l)*y(l) + h7(c(0, 4), x(l))
            f(l) = f(l)*y(l) + h8(c(0, 3), x(l))
            f(l) = f(l)*y(l) + h9(c(0, 2), x(l))
            f(l) = f(l)*y(l) + h10(c(0, 1), x(l))
            f(l) = f(l)*y(l) + h11(c(0, 0), x(l))
         end do
      case default
         f(:n) = 0.5_dp
      end select
   end subroutine polynomial

   ! h1 to h11: Horner in x.

   pure real(dp) function h1(c, x)
      real(dp), intent(in) :: c(0:1), x
      h1 = c(1)*x + c(0)
   end function h1

   pure real(dp) function h2(c, x)
      real(dp), intent(in) :: c(0:2), x
      h2 = (c(2)*x + c(1))*x + c(0)
   end function h2

   pure real(dp) function h3(c, x)
      real(dp), intent(in) :: c(0:3), x
      h3 = ((c(3)*x + c(2))*x + c(1))*x + c(0)
   end function h3

   pure real(dp) function h4(c, x)
      real(dp), intent(in) :: c(0:4), x
      h4 = (((c(4)*x + c(3))*x + c(2))*x + c(1))*x + c(0)
   end function h4

   pure real(dp) function h5(c, x)
      real(dp), intent(in) :: c(0:5), x
      h5 = ((((c(5)*x + c(4))*x + c(3))*x + c(2))*x + c(1))*x + c(0)
   end function h5

   pure real(dp) function h6(c, x)
      real(dp), intent(in) :: c(0:6), x
      h6 = (((((c(6)*x + c(5))*x + c(4))*x + c(3))*x + c(2))*x + c(1))*x + c(0)
   end function h6

   pure real(dp) function h7(c, x)
      real(dp), intent(in) :: c(0:7), x
      h7 = ((((((c(7)*x + c(6))*x + c(5))*x + c(4))*x + c(3))*x + c(2))*x + c(1))*x + c(0)
   end function h7

   pure real(dp) function h8(c, x)
      real(dp), intent(in) :: c(0:8), x
      h8 = (((((((c(8)*x + c(7))*x + c(6))*x + c(5))*x + c(4))*x + c(3))*x + c(2))*x &
            + c(1))*x + c(0)
   end function h8

   pure real(dp) function h9(c, x)
      real(dp), intent(in) :: c(0:9), x
      h9 = ((((((((c(9)*x + c(8))*x + c(7))*x + c(6))*x + c(5))*x + c(4))*x + c(3))*x &
            + c(2))*x + c(1))*x + c(0)
   end function h9

   pure real(dp) function h10(c, x)
      real(dp), intent(in) :: c(0:10), x
      h10 = (((((((((c(10)*x + c(9))*x + c(8))*x + c(7))*x + c(6))*x + c(5))*x + c(4))*x &
            + c(3))*x + c(2))*x + c(1))*x + c(0)
   end function h10

   pure real(dp) function h11(c, x)
      real(dp), intent(in) :: c(0:11), x
      h11 = ((((((((((c(11)*x + c(10))*x + c(9))*x + c(8))*x + c(7))*x + c(6))*x &
            + c(5))*x + c(4))*x + c(3))*x + c(2))*x + c(1))*x + c(0)
   end function h11

end module poinsot_free_series
