!> A formula as a list of operations on the results of earlier ones: what formulas are compiled to
!> and blocks run.
!>
!> A node is uniform if it is the same for all bodies (constants, the time, and functions of these);
!> otherwise it has a value in every lane. Subtraction, division, powers and tangents are composed
!> of the few operations here, so that each has one derivative in one place.
module poinsot_effect_formula_node
   use, intrinsic :: iso_c_binding, only: c_double
   use poinsot_core_kinds, only: dp
   use poinsot_core_libm, only: arctangent, cosine, exponential, logarithm, sine
   implicit none(type, external)
   private
   public :: formula, add_node, add_constant, value_of, most_nodes
   public :: op_attitude, op_time, op_constant, op_add, op_multiply, op_shift, op_scale, &
      op_spread, &
      op_invert, op_root, op_exp, op_log, op_sin, op_cos, op_asin, op_acos, op_atan, op_sinh, &
      op_cosh, op_tanh, op_abs, op_power, op_atan2, op_min, op_max

   integer, parameter :: most_nodes = 200

   integer, parameter :: op_attitude = 1 !! Q(a, b)
   integer, parameter :: op_time = 2, op_constant = 3
   integer, parameter :: op_add = 4, op_multiply = 5 !! two of a kind, in lanes or uniform
   integer, parameter :: op_shift = 6, op_scale = 7  !! lanes plus, or times, a uniform one
   integer, parameter :: op_spread = 8               !! a uniform one into all lanes
   integer, parameter :: op_atan2 = 9, op_min = 10, op_max = 11 !! two of a kind
   integer, parameter :: op_invert = 12, op_root = 13, op_exp = 14, op_log = 15, op_sin = 16, &
      op_cos = 17, op_asin = 18, op_acos = 19, op_atan = 20, op_sinh = 21, op_cosh = 22, &
      op_tanh = 23, op_abs = 24
   integer, parameter :: op_power = 25 !! to the power of a uniform b

   !> The nodes in the order of evaluation; operands precede.
   type :: formula
      integer :: n = 0                          !! nodes; the last one may not be the result
      integer :: result = 0                     !! the node that is
      integer :: op(most_nodes) = 0, a(most_nodes) = 0, b(most_nodes) = 0
      logical :: uniform(most_nodes) = .false., constant(most_nodes) = .false.
      real(dp) :: value(most_nodes) = 0         !! of constants
      logical :: full = .false.                 !! there was no room for another
   end type formula

   interface
      pure real(c_double) function c_asin(x) bind(c, name="asin")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: x
      end function c_asin

      pure real(c_double) function c_acos(x) bind(c, name="acos")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: x
      end function c_acos

      pure real(c_double) function c_atan(x) bind(c, name="atan")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: x
      end function c_atan

      pure real(c_double) function c_sinh(x) bind(c, name="sinh")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: x
      end function c_sinh

      pure real(c_double) function c_cosh(x) bind(c, name="cosh")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: x
      end function c_cosh

      pure real(c_double) function c_tanh(x) bind(c, name="tanh")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: x
      end function c_tanh

      pure real(c_double) function c_pow(x, y) bind(c, name="pow")
         import :: c_double
         implicit none(type, external)
         real(c_double), intent(in), value :: x, y
      end function c_pow
   end interface

contains

   !> The node of an operation: an equal one that is there already, a constant if its operands are,
   !> else a new one. 0, and `full`, if there is no room.
   subroutine add_node(f, op, a, b, k)
      type(formula), intent(inout) :: f
      integer, intent(in) :: op   !! one of op_...
      integer, value :: a, b      !! operands; of op_attitude row and column; 0 = none
      integer, intent(out) :: k   !! may be the variable that a or b came from
      logical :: uniform
      k = 0
      if (f%full) return
      uniform = op == op_time
      if (op > op_constant) then
         uniform = f%uniform(a) .and. op /= op_spread
         if (b > 0) uniform = uniform .and. f%uniform(b)
         if (uniform .and. f%constant(a)) then
            if (b == 0) then
               call add_constant(f, value_of(op, f%value(a), 0.0_dp), k)
               return
            else if (f%constant(b)) then
               call add_constant(f, value_of(op, f%value(a), f%value(b)), k)
               return
            end if
         end if
      end if
      do k = 1, f%n
         if (f%op(k) == op .and. f%a(k) == a .and. f%b(k) == b) return
      end do
      call new_node(f, k)
      if (k == 0) return
      f%op(k) = op
      f%a(k) = a
      f%b(k) = b
      f%uniform(k) = uniform
   end subroutine add_node

   !> The node of a number.
   subroutine add_constant(f, value, k)
      type(formula), intent(inout) :: f
      real(dp), intent(in) :: value
      integer, intent(out) :: k
      k = 0
      if (.not. f%full) call new_node(f, k)
      if (k == 0) return
      f%op(k) = op_constant
      f%value(k) = value
      f%uniform(k) = .true.
      f%constant(k) = .true.
   end subroutine add_constant

   subroutine new_node(f, k)
      type(formula), intent(inout) :: f
      integer, intent(out) :: k
      k = 0
      f%full = f%n == most_nodes
      if (f%full) return
      f%n = f%n + 1
      k = f%n
   end subroutine new_node

   !> The result of an operation on numbers. It may be NaN: call it with traps disabled.
   elemental real(dp) function value_of(op, x, y) result(value)
      integer, intent(in) :: op
      real(dp), intent(in) :: x, y !! y of operations on two
      select case (op)
      case (op_add, op_shift); value = x + y
      case (op_multiply, op_scale); value = x*y
      case (op_invert); value = 1/x
      case (op_root); value = sqrt(x)
      case (op_exp); value = exponential(x)
      case (op_log); value = logarithm(x)
      case (op_sin); value = sine(x)
      case (op_cos); value = cosine(x)
      case (op_asin); value = c_asin(x)
      case (op_acos); value = c_acos(x)
      case (op_atan); value = c_atan(x)
      case (op_sinh); value = c_sinh(x)
      case (op_cosh); value = c_cosh(x)
      case (op_tanh); value = c_tanh(x)
      case (op_abs); value = abs(x)
      case (op_power); value = c_pow(x, y)
      case (op_atan2); value = arctangent(x, y)
      case (op_min); value = merge(x, y, x <= y)
      case (op_max); value = merge(x, y, x >= y)
      case default; value = x
      end select
   end function value_of

end module poinsot_effect_formula_node
