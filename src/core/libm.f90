!> Elementary functions of one number, from the C library.
!>
!> gfortran may replace the intrinsic ones by calls of a vector library, which has errors up to 4
!> ULP and other bits for elements at the end of an array. It cannot replace these: a number gives
!> bitwise the same result at every position. Errors within 1 ULP, in every rounding mode; on the
!> arguments that they are used for, no exception except underflow.
module poinsot_core_libm
   use, intrinsic :: iso_c_binding, only: c_double
   implicit none(type, external)
   private
   public :: sine, cosine, arctangent, exponential, logarithm, logarithm_1p

   interface
      !> sin(x), x in radians, of any finite size.
      pure real(c_double) function sine(x) bind(c, name="sin")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: x
      end function sine

      !> cos(x), x in radians, of any finite size.
      pure real(c_double) function cosine(x) bind(c, name="cos")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: x
      end function cosine

      !> Angle of the point (x, y) in [-pi, pi].
      pure real(c_double) function arctangent(y, x) bind(c, name="atan2")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: y, x
      end function arctangent

      !> e**x, x at most 709.78.
      pure real(c_double) function exponential(x) bind(c, name="exp")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: x
      end function exponential

      !> Natural logarithm of a positive x.
      pure real(c_double) function logarithm(x) bind(c, name="log")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: x
      end function logarithm

      !> Natural logarithm of 1 + x, x above -1: of full precision for small x.
      pure real(c_double) function logarithm_1p(x) bind(c, name="log1p")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: x
      end function logarithm_1p
   end interface

end module poinsot_core_libm
