!> Dual numbers in quadruple precision: a value and its six partial derivatives, carried along
!> exactly. A map written in them gives its Jacobian to the same rounding as its value.
module poinsot_study_dual
   use poinsot_core_kinds, only: qp
   implicit none(type, external)
   private
   public :: dual, directions, constant, variable, value_of
   public :: operator(+), operator(-), operator(*), operator(/), sqrt, sin, cos

   integer, parameter :: directions = 6

   !> v + sum d_k epsilon_k, epsilon_j epsilon_k = 0.
   type :: dual
      real(qp) :: v = 0
      real(qp) :: d(directions) = 0
   end type dual

   interface operator(+)
      module procedure add, add_real
   end interface operator(+)
   interface operator(-)
      module procedure subtract, negate
   end interface operator(-)
   interface operator(*)
      module procedure multiply, times_real
   end interface operator(*)
   interface operator(/)
      module procedure divide
   end interface operator(/)
   interface sqrt
      module procedure square_root
   end interface sqrt
   interface sin
      module procedure sine
   end interface sin
   interface cos
      module procedure cosine
   end interface cos

contains

   !> A number that depends on nothing.
   elemental type(dual) function constant(x)
      real(qp), intent(in) :: x
      constant%v = x
   end function constant

   !> The variable number k, from 1 to `directions`.
   elemental type(dual) function variable(x, k)
      real(qp), intent(in) :: x
      integer, intent(in) :: k
      variable%v = x
      variable%d(k) = 1
   end function variable

   !> Value without derivatives.
   elemental real(qp) function value_of(x)
      type(dual), intent(in) :: x
      value_of = x%v
   end function value_of

   elemental type(dual) function add(a, b)
      type(dual), intent(in) :: a, b
      add%v = a%v + b%v
      add%d = a%d + b%d
   end function add

   elemental type(dual) function add_real(a, b)
      real(qp), intent(in) :: a
      type(dual), intent(in) :: b
      add_real%v = a + b%v
      add_real%d = b%d
   end function add_real

   elemental type(dual) function subtract(a, b)
      type(dual), intent(in) :: a, b
      subtract%v = a%v - b%v
      subtract%d = a%d - b%d
   end function subtract

   elemental type(dual) function negate(a)
      type(dual), intent(in) :: a
      negate%v = -a%v
      negate%d = -a%d
   end function negate

   elemental type(dual) function multiply(a, b)
      type(dual), intent(in) :: a, b
      multiply%v = a%v*b%v
      multiply%d = a%v*b%d + b%v*a%d
   end function multiply

   elemental type(dual) function times_real(a, b)
      real(qp), intent(in) :: a
      type(dual), intent(in) :: b
      times_real%v = a*b%v
      times_real%d = a*b%d
   end function times_real

   elemental type(dual) function divide(a, b)
      type(dual), intent(in) :: a, b
      divide%v = a%v/b%v
      divide%d = (a%d - divide%v*b%d)/b%v
   end function divide

   elemental type(dual) function square_root(a)
      type(dual), intent(in) :: a
      square_root%v = sqrt(a%v)
      square_root%d = a%d/(2*square_root%v)
   end function square_root

   elemental type(dual) function sine(a)
      type(dual), intent(in) :: a
      sine%v = sin(a%v)
      sine%d = cos(a%v)*a%d
   end function sine

   elemental type(dual) function cosine(a)
      type(dual), intent(in) :: a
      cosine%v = cos(a%v)
      cosine%d = -sin(a%v)*a%d
   end function cosine

end module poinsot_study_dual
