!> Compiler for formulas of users, such as `k*(1 - Q33)^2`.
!>
!> Numbers, names and functions in upper or lower case; + - * / ^ (or **) with the usual precedence,
!> ^ right-associative and binding tighter than a leading minus; parentheses. Q11 ... Q33 are the
!> elements of the attitude, t the time, pi is pi. A recursive descent of three levels, with a node
!> for each operation.
module poinsot_effect_formula
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_message, only: printable
   use poinsot_core_nearest, only: suggestion
   use poinsot_core_number, only: parse_real, number_ok
   use poinsot_core_quiet, only: quiet_state, begin_quiet, end_quiet, is_number
   use poinsot_core_status, only: poinsot_e_domain
   use poinsot_effect_formula_node, only: formula, add_node, add_constant, &
      op_attitude, op_time, op_add, op_multiply, op_shift, op_scale, op_spread, op_invert, &
         op_root, &
      op_exp, op_log, op_sin, op_cos, op_asin, op_acos, op_atan, op_sinh, op_cosh, op_tanh, &
         op_abs, &
      op_power, op_atan2, op_min, op_max
   implicit none(type, external)
   private
   public :: compile_formula

   character(*), parameter :: blanks = " " // achar(9)
   character(*), parameter :: letters = "abcdefghijklmnopqrstuvwxyz_", digits = "0123456789"
   integer, parameter :: longest_name = 24, most_constants = 100, deepest = 100

   !> Functions of one number, the operations they are, and those that take two.
   character(5), parameter :: functions(*) = [character(5) :: "sqrt", "exp", "log", "sin", "cos", &
      "asin", "acos", "atan", "sinh", "cosh", "tanh", "abs", "tan", "atan2", "min", "max"]
   integer, parameter :: operations(*) = [op_root, op_exp, op_log, op_sin, op_cos, op_asin, &
      op_acos, op_atan, op_sinh, op_cosh, op_tanh, op_abs, 0, op_atan2, op_min, op_max]
   integer, parameter :: first_of_two = 14

   !> A text while it is read.
   type :: reader
      character(:), allocatable :: text, shown !! lower case; as it was written
      integer :: at = 1
      integer :: depth = 0                     !! of parentheses and signs
      character(longest_name), allocatable :: names(:)
      real(dp), allocatable :: values(:)       !! of the constants of these names
      character(:), allocatable :: key         !! for messages: u or constants
   end type reader

contains

   !> Compile a formula. POINSOT_E_DOMAIN with the character where it cannot be read, for a constant
   !> that is not one, and for more than 200 operations.
   subroutine compile_formula(text, constants, f, error)
      character(*), intent(in) :: text      !! the formula
      character(*), intent(in) :: constants !! "k = 1.5, w = 2", or empty
      type(formula), intent(out) :: f
      type(poinsot_error), intent(inout) :: error
      type(reader) :: r
      type(quiet_state) :: saved
      integer :: k
      call open_text("constants", constants, r)
      allocate (r%names(0), r%values(0))
      call read_constants(r, error)
      if (raised(error)) return
      call open_text("u", text, r)
      call begin_quiet(saved) ! constants are worked out here
      call read_sum(r, f, k, error)
      call end_quiet(saved)
      if (raised(error)) return
      if (f%full) then
         call fail(r, r%at, "more than 200 operations up to here", error)
      else if (next(r) /= "") then
         call fail(r, r%at, "'" // printable(r%shown(r%at:r%at)) // "' is not expected here", error)
      else if (.not. all(is_number(f%value(:f%n)))) then
         call fail(r, 1, "has a constant part that is not a finite number", error)
      else
         f%result = k
      end if
   end subroutine compile_formula

   subroutine open_text(key, text, r)
      character(*), intent(in) :: key, text
      type(reader), intent(inout) :: r
      integer :: i, code
      r%key = key
      r%shown = text
      r%text = text
      do i = 1, len(text)
         code = iachar(text(i:i))
         if (code >= iachar("A") .and. code <= iachar("Z")) r%text(i:i) = achar(code + 32)
      end do
      r%at = 1
   end subroutine open_text

   !> The character that comes, behind blanks; "" at the end.
   function next(r) result(c)
      type(reader), intent(inout) :: r
      character(:), allocatable :: c
      integer :: skipped
      c = ""
      if (r%at > len(r%text)) return
      skipped = verify(r%text(r%at:), blanks)
      r%at = merge(r%at + skipped - 1, len(r%text) + 1, skipped > 0)
      if (r%at <= len(r%text)) c = r%text(r%at:r%at)
   end function next

   subroutine fail(r, at, what, error)
      type(reader), intent(in) :: r
      integer, intent(in) :: at
      character(*), intent(in) :: what
      type(poinsot_error), intent(inout) :: error
      character(12) :: number
      if (raised(error)) return
      write (number, "(i0)") at
      call raise(error, poinsot_e_domain, "effect 'potential': key '" // r%key // "' = '" // &
         printable(r%shown, 400) // "', character " // trim(number) // ": " // what)
   end subroutine fail

   !> `name = number`, apart by commas or semicolons.
   subroutine read_constants(r, error)
      type(reader), intent(inout) :: r
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: name
      real(dp) :: value
      integer :: first, sign_of
      do while (next(r) /= "" .and. .not. raised(error))
         first = r%at
         call read_name(r, name)
         if (name == "" .or. len(name) > longest_name) then
            call fail(r, first, "a name of at most 24 letters and digits is expected", error)
         else if (is_taken(name) .or. any(r%names == name)) then
            call fail(r, first, "'" // name // "' has a meaning already", error)
         else if (next(r) /= "=") then
            call fail(r, r%at, "= is expected behind '" // name // "'", error)
         end if
         if (raised(error)) return
         r%at = r%at + 1
         sign_of = 1
         if (index("+-", next(r)) > 0 .and. next(r) /= "") then
            if (next(r) == "-") sign_of = -1
            r%at = r%at + 1
         end if
         call read_number(r, value, error)
         if (size(r%names) == most_constants) call fail(r, first, "more than 100 constants", error)
         if (raised(error)) return
         r%names = [character(longest_name) :: r%names, name]
         r%values = [r%values, sign_of*value]
         if (next(r) == "") return
         if (next(r) /= "," .and. next(r) /= ";") then
            call fail(r, r%at, "a comma is expected", error)
            return
         end if
         r%at = r%at + 1
      end do
   end subroutine read_constants

   !> Has a name a meaning of its own?
   pure logical function is_taken(name)
      character(*), intent(in) :: name
      is_taken = name == "t" .or. name == "pi" .or. any(functions == name) .or. is_attitude(name)
   end function is_taken

   !> q11 ... q33
   pure logical function is_attitude(name)
      character(*), intent(in) :: name
      is_attitude = len(name) == 3
      if (is_attitude) is_attitude = name(1:1) == "q" .and. verify(name(2:3), "123") == 0
   end function is_attitude

   !> The name at this position; "" if there is none.
   subroutine read_name(r, name)
      type(reader), intent(inout) :: r
      character(:), allocatable, intent(out) :: name
      integer :: length
      name = ""
      if (index(letters, next(r)) == 0 .or. next(r) == "") return
      length = verify(r%text(r%at:), letters // digits) - 1
      if (length < 0) length = len(r%text) - r%at + 1
      name = r%text(r%at:r%at + length - 1)
      r%at = r%at + length
   end subroutine read_name

   !> An unsigned number.
   subroutine read_number(r, value, error)
      type(reader), intent(inout) :: r
      real(dp), intent(out) :: value
      type(poinsot_error), intent(inout) :: error
      integer :: first, last, outcome
      value = 0
      if (next(r) == "") then
         call fail(r, len(r%text) + 1, "ends where a number is expected", error)
         return
      end if
      first = r%at
      last = first
      do while (last <= len(r%text))
         if (index(digits // ".", r%text(last:last)) == 0) exit
         last = last + 1
      end do
      if (last > first .and. last < len(r%text)) then
         if (index("ed", r%text(last:last)) > 0) then ! an exponent, if digits follow
            outcome = last + 1
            if (index("+-", r%text(outcome:outcome)) > 0) outcome = outcome + 1
            if (outcome <= len(r%text)) then
               if (index(digits, r%text(outcome:outcome)) > 0) last = outcome
            end if
            do while (last <= len(r%text))
               if (index(digits, r%text(last:last)) == 0) exit
               last = last + 1
            end do
         end if
      end if
      call parse_real(r%text(first:last - 1), value, outcome)
      if (outcome /= number_ok) call fail(r, first, "a finite number is expected", error)
      r%at = last
   end subroutine read_number

   !> Terms with + and - between them.
   recursive subroutine read_sum(r, f, k, error)
      type(reader), intent(inout) :: r
      type(formula), intent(inout) :: f
      integer, intent(out) :: k
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: sign_of
      integer :: right
      call read_product(r, f, k, error)
      do while (.not. raised(error))
         sign_of = next(r)
         if (sign_of /= "+" .and. sign_of /= "-") return
         r%at = r%at + 1
         call read_product(r, f, right, error)
         if (raised(error)) return
         if (sign_of == "-") call negate(f, right)
         call combine(f, op_add, op_shift, k, right)
      end do
   end subroutine read_sum

   !> Factors with * and / between them.
   recursive subroutine read_product(r, f, k, error)
      type(reader), intent(inout) :: r
      type(formula), intent(inout) :: f
      integer, intent(out) :: k
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: sign_of
      integer :: right
      right = 0
      call read_power(r, f, k, error)
      do while (.not. raised(error))
         sign_of = next(r)
         if (sign_of /= "*" .and. sign_of /= "/") return
         r%at = r%at + 1
         call read_power(r, f, right, error)
         if (raised(error) .or. f%full) return
         if (sign_of == "/") call add_node(f, op_invert, right, 0, right)
         call combine(f, op_multiply, op_scale, k, right)
      end do
   end subroutine read_product

   !> A sign, a thing, and what it is raised to.
   recursive subroutine read_power(r, f, k, error)
      type(reader), intent(inout) :: r
      type(formula), intent(inout) :: f
      integer, intent(out) :: k
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: sign_of
      integer :: exponent_node, at
      k = 0
      r%depth = r%depth + 1
      if (r%depth > deepest) call fail(r, r%at, "more than 100 parentheses and signs within " // &
         "each other", error)
      sign_of = next(r)
      if (sign_of == "+" .or. sign_of == "-") then
         r%at = r%at + 1
         if (.not. raised(error)) call read_power(r, f, k, error)
         if (sign_of == "-" .and. .not. raised(error)) call negate(f, k)
      else if (.not. raised(error)) then
         call read_thing(r, f, k, error)
         at = 0
         if (next(r) == "^") at = 1
         if (next(r) == "*" .and. r%at < len(r%text)) then
            if (r%text(r%at:r%at + 1) == "**") at = 2
         end if
         if (at > 0 .and. .not. raised(error)) then
            r%at = r%at + at
            call read_power(r, f, exponent_node, error)
            if (.not. raised(error)) call raise_to(f, k, exponent_node)
         end if
      end if
      r%depth = r%depth - 1
   end subroutine read_power

   !> A number, a name, a function, or a sum in parentheses.
   recursive subroutine read_thing(r, f, k, error)
      type(reader), intent(inout) :: r
      type(formula), intent(inout) :: f
      integer, intent(out) :: k
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: name
      real(dp) :: value
      integer :: first
      k = 0
      if (next(r) == "") then
         call fail(r, len(r%text) + 1, "ends where a number, a name or ( is expected", error)
      else if (next(r) == "(") then
         r%at = r%at + 1
         call read_sum(r, f, k, error)
         call expect(r, ")", error)
      else if (index(digits // ".", next(r)) > 0) then
         call read_number(r, value, error)
         if (.not. raised(error)) call add_constant(f, value, k)
      else
         first = r%at
         call read_name(r, name)
         if (name == "") then
            call fail(r, first, "'" // printable(r%shown(first:first)) // &
               "' where a number, a name or ( is expected", error)
         else if (any(functions == name)) then
            call read_call(r, f, name, k, error)
         else
            call find_name(r, f, name, first, k, error)
         end if
      end if
   end subroutine read_thing

   subroutine expect(r, wanted, error)
      type(reader), intent(inout) :: r
      character, intent(in) :: wanted
      type(poinsot_error), intent(inout) :: error
      if (raised(error)) return
      if (next(r) /= wanted) call fail(r, r%at, wanted // " is expected", error)
      r%at = r%at + 1
   end subroutine expect

   !> The meaning of a name.
   subroutine find_name(r, f, name, first, k, error)
      type(reader), intent(in) :: r
      type(formula), intent(inout) :: f
      character(*), intent(in) :: name
      integer, intent(in) :: first
      integer, intent(out) :: k
      type(poinsot_error), intent(inout) :: error
      integer :: i
      k = 0
      if (name == "t") then
         call add_node(f, op_time, 0, 0, k)
      else if (name == "pi") then
         call add_constant(f, acos(-1.0_dp), k)
      else if (is_attitude(name)) then
         call add_node(f, op_attitude, index("123", name(2:2)), index("123", name(3:3)), k)
      else
         do i = 1, size(r%names)
            if (r%names(i) == name) call add_constant(f, r%values(i), k)
         end do
         if (k == 0 .and. .not. f%full) call fail(r, first, "unknown name '" // name // "'" // &
            suggestion(name, [character(longest_name) :: functions, "t", "pi", "q11", "q12", &
            "q13", "q21", "q22", "q23", "q31", "q32", "q33", r%names]) // &
            " (numbers get their names in constants)", error)
      end if
   end subroutine find_name

   !> A function and its arguments in parentheses.
   recursive subroutine read_call(r, f, name, k, error)
      type(reader), intent(inout) :: r
      type(formula), intent(inout) :: f
      character(*), intent(in) :: name
      integer, intent(out) :: k
      type(poinsot_error), intent(inout) :: error
      integer :: which, right, below
      do which = 1, size(functions)
         if (functions(which) == name) exit
      end do
      call expect(r, "(", error)
      below = 0
      k = 0
      if (.not. raised(error)) call read_sum(r, f, k, error)
      if (raised(error)) return
      if (which >= first_of_two) then
         call expect(r, ",", error)
         do while (.not. raised(error))
            call read_sum(r, f, right, error)
            if (raised(error)) return
            call join(f, operations(which), k, right)
            if (next(r) /= "," .or. name == "atan2") exit
            r%at = r%at + 1
         end do
      else if (f%full) then
         return
      else if (name == "tan") then
         call add_node(f, op_cos, k, 0, below)
         call add_node(f, op_sin, k, 0, k)
         if (f%full) return
         call add_node(f, op_invert, below, 0, below)
         call combine(f, op_multiply, op_scale, k, below)
      else
         call add_node(f, operations(which), k, 0, k)
      end if
      call expect(r, ")", error)
   end subroutine read_call

   !> k = k + right, or k*right, whichever of the two has lanes.
   subroutine combine(f, both, mixed, k, right)
      type(formula), intent(inout) :: f
      integer, intent(in) :: both, mixed !! op_add and op_shift, or op_multiply and op_scale
      integer, intent(inout) :: k
      integer, value :: right
      if (f%full) return
      if (f%uniform(k) .eqv. f%uniform(right)) then
         call add_node(f, both, k, right, k)
      else if (f%uniform(right)) then
         call add_node(f, mixed, k, right, k)
      else
         call add_node(f, mixed, right, k, k)
      end if
   end subroutine combine

   subroutine negate(f, k)
      type(formula), intent(inout) :: f
      integer, intent(inout) :: k
      integer :: minus
      call add_constant(f, -1.0_dp, minus)
      call combine(f, op_multiply, op_scale, k, minus)
   end subroutine negate

   !> An operation on two, both with lanes or both uniform.
   subroutine join(f, op, k, right)
      type(formula), intent(inout) :: f
      integer, intent(in) :: op
      integer, intent(inout) :: k
      integer, intent(inout) :: right
      if (f%full) return
      if (f%uniform(k) .and. .not. f%uniform(right)) call add_node(f, op_spread, k, 0, k)
      if (f%full) return
      if (f%uniform(right) .and. .not. f%uniform(k)) call add_node(f, op_spread, right, 0, right)
      call add_node(f, op, k, right, k)
   end subroutine join

   !> k to the power of p: products for whole numbers, a root for 1/2, by logarithms if p has lanes.
   subroutine raise_to(f, k, p)
      type(formula), intent(inout) :: f
      integer, intent(inout) :: k
      integer, intent(in) :: p
      integer :: n, base, made
      if (f%full) return
      if (.not. f%uniform(p)) then
         call add_node(f, op_log, k, 0, k)
         call combine(f, op_multiply, op_scale, k, p)
         if (.not. f%full) call add_node(f, op_exp, k, 0, k)
         return
      end if
      if (f%constant(p) .and. is_number(f%value(p))) then
         if (abs(f%value(p) - 0.5_dp) <= 0) then
            call add_node(f, op_root, k, 0, k)
            return
         else if (abs(f%value(p)) <= 64 .and. abs(f%value(p) - anint(f%value(p))) <= 0) then
            n = abs(nint(f%value(p)))
            base = k
            made = 0
            if (n == 0) call add_constant(f, 1.0_dp, made)
            do while (n > 0)
               if (mod(n, 2) == 1 .and. made > 0) call combine(f, op_multiply, op_scale, made, base)
               if (mod(n, 2) == 1 .and. made == 0) made = base
               n = n/2
               if (n > 0) call combine(f, op_multiply, op_scale, base, base)
               if (f%full) return
            end do
            k = made
            if (f%value(p) < 0) call add_node(f, op_invert, k, 0, k)
            return
         end if
      end if
      call add_node(f, op_power, k, p, k)
   end subroutine raise_to

end module poinsot_effect_formula
