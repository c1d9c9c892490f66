!> A body class and its torques in the form needed by the Taylor integrator, computed once:
!> right-hand sides that contain only coefficients.
!>
!>     omega' = g (omega omega) + [rotor x omega - friction omega + torques]/I
!>     d' = d x (omega - rate a)
!>
!> for every direction d integrated: one to three that are orthonormal and fixed in space (the
!> `basis`), then others, fixed or rotating about an axis a in the span of the basis. Torques are
!> divided by I and by the square of a power of two, `unit`, so that moments of 1e-46 and torques of
!> 1e70 give numbers near one.
module poinsot_taylor_problem
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_e_method
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_body_class, only: body_class
   use poinsot_effect_effect, only: effect_item
   use poinsot_effect_geometry, only: turned
   use poinsot_effect_terms, only: torque_terms, space_direction, table_term
   use poinsot_taylor_basis, only: span_rows, add_direction
   implicit none(type, external)
   private
   public :: taylor_problem, make_problem, collect_terms, place_in_table, see_phases

   integer, parameter :: largest_unit = 235   !! its power of two: faster than any body may turn
   real(dp), parameter :: equal = 4*epsilon(1.0_dp)

   !> A body class with its torques.
   type :: taylor_problem
      real(dp) :: moments(3) = 1, inverse(3) = 1, limit(3) = 0 !! as those of the class
      real(dp) :: g(3) = 0                    !! (I2 - I3)/I1, cyclic; 0 for a zero moment
      real(dp) :: growth = 1                  !! largest of 1 and |g|
      real(dp) :: rotor(3) = 0
      real(dp) :: rate = 0                    !! the largest rate of all torques: 1/time
      real(dp) :: unit = 0                    !! a power of two, not below sqrt(torque/I)
      logical :: too_strong = .false.         !! no body could stay below its limit
      integer :: fixed = 1                    !! vectors of the basis followed, 1 to 3
      integer :: directions = 1               !! all directions followed
      real(dp) :: basis(3, 3) = 0             !! (space components, vectors), orthonormal
      type(space_direction), allocatable :: other(:) !! directions after the basis, of length 1
      real(dp), allocatable :: axis(:, :)     !! (3, other): their axes in the basis
      logical :: simple = .true.              !! one direction and arms: M has no diagonal
      real(dp), allocatable :: linear(:, :, :)       !! (3, 3, directions): torque = M d
      real(dp), allocatable :: difference(:, :)      !! (3, directions): quadratic torques
      real(dp), allocatable :: product(:, :, :)      !! (3, 3, directions): K23, K31, K12 / I
      real(dp) :: body(3) = 0                 !! constant torque in the body frame
      real(dp), allocatable :: frequency(:), phase(:)        !! harmonic torques
      real(dp), allocatable :: harmonic(:, :, :, :)          !! (3, 3, fixed, waves)
      real(dp), allocatable :: harmonic_body(:, :)           !! (3, waves)
      type(table_term), allocatable :: table(:) !! values normalised; in space: along the basis,
                                                !! and still to be multiplied by table_inverse
      real(dp), allocatable :: table_inverse(:, :)           !! (3, tables)
      logical :: damped = .false.
      real(dp) :: spin(3, 3) = 0              !! omega' += spin omega: rotors and friction, over I
   end type taylor_problem

contains

   !> Effects on a body class as data. POINSOT_E_METHOD if one cannot be served.
   subroutine collect_terms(class, acting, effects, terms, error)
      type(body_class), intent(in) :: class
      integer, intent(in) :: acting(:)             !! places of the effects that act on it
      type(effect_item), intent(in) :: effects(:)
      type(torque_terms), intent(inout) :: terms
      type(poinsot_error), intent(inout) :: error
      logical :: served
      integer :: i
      do i = 1, size(acting)
         call effects(acting(i))%it%add_terms(class, terms, served)
         if (served) cycle
         call raise(error, poinsot_e_method, "splitting 'taylor' does not support " // &
            "effect '" // trim(effects(acting(i))%it%name) // "' (pairs, noise, a formula, an " // &
            "eccentric orbit, a program's own torque); use 'srkn6'")
         return
      end do
   end subroutine collect_terms

   !> Work out the problem of one class. Torques about an axis without inertia count as none.
   pure subroutine make_problem(class, terms, problem)
      type(body_class), intent(in) :: class
      type(torque_terms), intent(in) :: terms
      type(taylor_problem), intent(out) :: problem
      type(torque_terms) :: parts
      real(dp) :: a(3), cyclic
      integer :: i, j, k
      parts = terms
      if (.not. allocated(parts%linear)) allocate (parts%linear(0))
      if (.not. allocated(parts%quadratic)) allocate (parts%quadratic(0))
      if (.not. allocated(parts%body)) allocate (parts%body(0))
      if (.not. allocated(parts%table)) allocate (parts%table(0))
      problem%moments = class%moments
      problem%inverse = class%inverse
      problem%limit = class%limit
      problem%rotor = class%rotor
      a = [-class%a(1), class%a(2), -class%a(3)]
      problem%g(class%order) = class%parity*a
      problem%growth = max(1.0_dp, maxval(abs(problem%g)))
      do i = 1, 3
         do j = 1, 3
            problem%spin(i, j) = -quotient(parts%friction(i, j), class%moments(i))
            k = 6 - i - j
            if (j == i) cycle
            cyclic = merge(1, -1, j == 1 + mod(i, 3))
            problem%spin(i, j) = problem%spin(i, j) - cyclic*quotient(class%rotor(k), &
               class%moments(i))
         end do
      end do
      problem%damped = any(abs(parts%friction) > 0)
      call choose_unit(class, parts, problem)
      if (problem%too_strong) then ! bodies are refused: nothing may overflow on the way there
         parts%linear = parts%linear(:0)
         parts%quadratic = parts%quadratic(:0)
         parts%body = parts%body(:0)
         parts%table = parts%table(:0)
      end if
      call resolve_fixed(parts)
      call build_basis(class, parts, problem)
      call fill_directions(class, parts, problem)
      call fill_times(class, parts, problem)
      problem%simple = problem%directions == 1 .and. size(problem%frequency) == 0 .and. &
         size(problem%table) == 0 .and. all_zero(problem%body) .and. &
         all_zero(reshape(problem%spin, [9])) .and. &
         all_zero(problem%difference(:, 1)) .and. &
         all_zero(reshape(problem%product(:, :, 1), [9])) .and. &
         all_zero([(problem%linear(i, i, 1), i=1, 3)])
   end subroutine make_problem

   pure logical function all_zero(x)
      real(dp), intent(in) :: x(:)
      all_zero = all(abs(x) <= 0)
   end function all_zero

   !> x/moment, 0 for a zero moment, at most 1e200.
   pure real(dp) function quotient(x, moment)
      real(dp), intent(in) :: x, moment
      quotient = 0
      if (.not. moment > 0 .or. .not. abs(x) > 0) return
      quotient = sign(1e200_dp, x)
      if (exponent(x) - exponent(moment) < 600) quotient = scale(fraction(x)/fraction(moment), &
         exponent(x) - exponent(moment))
   end function quotient

   !> torque/(I_i unit^2).
   pure real(dp) function normal(class, problem, torque, i)
      type(body_class), intent(in) :: class
      type(taylor_problem), intent(in) :: problem
      real(dp), intent(in) :: torque
      integer, intent(in) :: i                !! axis
      normal = 0
      if (.not. class%moments(i) > 0 .or. .not. abs(torque) > 0) return
      normal = scale(fraction(torque)/fraction(class%moments(i)), exponent(torque) - &
         exponent(class%moments(i)) - 2*(exponent(problem%unit) - 1))
   end function normal

   !> unit = a power of two at least sqrt(largest torque/I); rate = the largest rate there is.
   pure subroutine choose_unit(class, parts, problem)
      type(body_class), intent(in) :: class
      type(torque_terms), intent(in) :: parts
      type(taylor_problem), intent(inout) :: problem
      real(dp), parameter :: small = 2.0_dp**(-20)
      real(dp) :: t(3), rates(5)
      integer :: i, j, power
      t = 0
      rates = 0
      do i = 1, size(parts%linear)
         do j = 1, 3
            t(j) = t(j) + small*norm2(small*parts%linear(i)%matrix(j, :))* &
               maxval(abs(parts%linear(i)%e%at))
         end do
         rates(1) = max(rates(1), abs(parts%linear(i)%e%rate))
         if (parts%linear(i)%harmonic) rates(2) = max(rates(2), abs(parts%linear(i)%frequency))
      end do
      t = 2*t/small
      do i = 1, size(parts%quadratic)
         t = t + small*(abs(parts%quadratic(i)%difference)*0.5_dp + &
            sum(abs(parts%quadratic(i)%product)))
         rates(3) = max(rates(3), abs(parts%quadratic(i)%e%rate))
      end do
      do i = 1, size(parts%body)
         t = t + small*abs(parts%body(i)%value)
         if (parts%body(i)%harmonic) rates(4) = max(rates(4), abs(parts%body(i)%frequency))
      end do
      do i = 1, size(parts%table)
         if (parts%table(i)%in_space) then
            t = t + 2*small*maxval(abs(parts%table(i)%values))
         else
            t = t + small*maxval(abs(parts%table(i)%values), dim=2)
         end if
      end do
      rates(5) = maxval(abs(problem%spin))
      power = -1000
      do i = 1, 3
         if (.not. (class%moments(i) > 0 .and. t(i) > 0)) cycle
         power = max(power, (exponent(t(i)) + 20 - exponent(class%moments(i)) + 2)/2)
      end do
      problem%too_strong = power > largest_unit .or. maxval(rates) > 1e70_dp
      problem%unit = scale(1.0_dp, min(power, largest_unit))
      problem%rate = maxval(rates)
      if (power > -1000) problem%rate = max(problem%rate, problem%unit)
   end subroutine choose_unit

   !> A direction that does not rotate is at its phase.
   pure subroutine resolve_fixed(parts)
      type(torque_terms), intent(inout) :: parts
      integer :: i
      do i = 1, size(parts%linear)
         call resolve(parts%linear(i)%e)
      end do
      do i = 1, size(parts%quadratic)
         call resolve(parts%quadratic(i)%e)
      end do
   contains
      pure subroutine resolve(e)
         type(space_direction), intent(inout) :: e
         if (turns(e)) return
         if (abs(e%phase) > 0) e%at = turned(e%at, e%axis, e%phase)
         e%phase = 0
      end subroutine resolve
   end subroutine resolve_fixed

   pure logical function turns(e)
      type(space_direction), intent(in) :: e
      turns = abs(e%rate) > 0
   end function turns

   !> The basis is quadratic directions as far as they are orthogonal, axes of what turns, then what
   !> the linear torques and tables need beside these: the rank of all of them together.
   pure subroutine build_basis(class, parts, problem)
      type(body_class), intent(in) :: class
      type(torque_terms), intent(in) :: parts
      type(taylor_problem), intent(inout) :: problem
      real(dp), allocatable :: rows(:, :)
      integer :: i, j, k
      problem%fixed = 0
      do i = 1, size(parts%quadratic)
         if (turns(parts%quadratic(i)%e)) cycle
         associate (v => parts%quadratic(i)%e%at/norm2(parts%quadratic(i)%e%at))
            if (all(abs(matmul(v, problem%basis(:, :problem%fixed))) <= equal)) then
               call add_direction(v, problem%basis, problem%fixed)
            end if
         end associate
      end do
      do i = 1, size(parts%linear)
         if (turns(parts%linear(i)%e)) call add_direction(parts%linear(i)%e%axis, problem%basis, &
            problem%fixed)
      end do
      do i = 1, size(parts%quadratic)
         if (turns(parts%quadratic(i)%e)) call add_direction( &
            parts%quadratic(i)%e%axis, problem%basis, problem%fixed)
      end do
      allocate (rows(3, 0))
      do i = 1, size(parts%linear)
         if (turns(parts%linear(i)%e)) cycle
         do j = 1, 3
            do k = 1, 3
               rows = reshape([rows, normal(class, problem, parts%linear(i)%matrix(j, k), j)* &
                  parts%linear(i)%e%at], [3, size(rows, 2) + 1])
            end do
         end do
      end do
      do i = 1, size(parts%table)
         if (.not. parts%table(i)%in_space) cycle
         k = maxloc(class%inverse, 1)
         do j = 1, size(parts%table(i)%times)
            associate (v => parts%table(i)%values(:, j))
               rows = reshape([rows, normal(class, problem, v(1), k), &
                  normal(class, problem, v(2), k), normal(class, problem, v(3), k)], &
                  [3, size(rows, 2) + 1])
            end associate
         end do
      end do
      call span_rows(rows, problem%basis, problem%fixed)
      if (problem%fixed == 0) call add_direction([0.0_dp, 0.0_dp, 1.0_dp], problem%basis, &
         problem%fixed)
   end subroutine build_basis

   !> Coefficients of every direction; directions that the basis does not hold follow it.
   pure subroutine fill_directions(class, parts, problem)
      type(body_class), intent(in) :: class
      type(torque_terms), intent(in) :: parts
      type(taylor_problem), intent(inout) :: problem
      integer :: i, j, k, most, number
      real(dp) :: size_of
      most = problem%fixed + size(parts%linear) + size(parts%quadratic)
      allocate (problem%linear(3, 3, most), problem%difference(3, most), &
         problem%product(3, 3, most), source=0.0_dp)
      allocate (problem%other(0))
      do i = 1, size(parts%linear)
         associate (term => parts%linear(i))
            size_of = norm2(term%e%at)
            if (.not. size_of > 0 .or. term%harmonic) cycle
            if (turns(term%e)) then
               call find_other(term%e, size_of, problem, number)
               call add_matrix(class, size_of*term%matrix, number, problem)
            else
               do k = 1, problem%fixed
                  call add_matrix(class, dot_product(problem%basis(:, k), term%e%at)* &
                     term%matrix, k, problem)
               end do
            end if
         end associate
      end do
      do i = 1, size(parts%quadratic)
         associate (term => parts%quadratic(i))
            size_of = norm2(term%e%at)
            number = 0
            if (.not. turns(term%e)) then
               do k = 1, problem%fixed
                  if (abs(abs(dot_product(problem%basis(:, k), term%e%at)) - size_of) <= &
                      equal*size_of) number = k
               end do
            end if
            if (number == 0) call find_other(term%e, size_of, problem, number)
            do j = 1, 3
               problem%difference(j, number) = problem%difference(j, number) + size_of**2* &
                  normal(class, problem, term%difference(j), j)
               do k = 1, 3
                  problem%product(k, j, number) = problem%product(k, j, number) + size_of**2* &
                     normal(class, problem, term%product(k), j)
               end do
            end do
         end associate
      end do
      problem%directions = problem%fixed + size(problem%other)
      allocate (problem%axis(3, size(problem%other)), source=0.0_dp)
      do i = 1, size(problem%other)
         if (turns(problem%other(i))) problem%axis(:, i) = matmul(problem%other(i)%axis, &
            problem%basis)
      end do
   end subroutine fill_directions

   !> torque += M d of a direction.
   pure subroutine add_matrix(class, matrix, number, problem)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: matrix(3, 3)
      integer, intent(in) :: number
      type(taylor_problem), intent(inout) :: problem
      integer :: a, b
      do b = 1, 3
         do a = 1, 3
            problem%linear(a, b, number) = problem%linear(a, b, number) + &
               normal(class, problem, matrix(a, b), a)
         end do
      end do
   end subroutine add_matrix

   !> Number of a direction beside the basis; a new one, if it is not there yet.
   pure subroutine find_other(e, size_of, problem, number)
      type(space_direction), intent(in) :: e
      real(dp), intent(in) :: size_of                 !! its length
      type(taylor_problem), intent(inout) :: problem
      integer, intent(out) :: number
      type(space_direction) :: one
      integer :: i
      one = e
      one%at = e%at/size_of
      do i = 1, size(problem%other)
         associate (other => problem%other(i))
            number = problem%fixed + i
            if (all(abs(other%at - one%at) <= 0) .and. all(abs(other%axis - one%axis) <= 0) .and. &
                abs(other%rate - one%rate) <= 0 .and. abs(other%phase - one%phase) <= 0) return
         end associate
      end do
      problem%other = [problem%other, one]
      number = problem%fixed + size(problem%other)
   end subroutine find_other

   !> Torques that depend on time alone, or on time and the basis.
   pure subroutine fill_times(class, parts, problem)
      type(body_class), intent(in) :: class
      type(torque_terms), intent(in) :: parts
      type(taylor_problem), intent(inout) :: problem
      integer :: i, j, a, b, most, number
      most = count(parts%linear%harmonic) + count(parts%body%harmonic)
      allocate (problem%frequency(0), problem%phase(0))
      allocate (problem%harmonic(3, 3, problem%fixed, most), problem%harmonic_body(3, most), &
         source=0.0_dp)
      do i = 1, size(parts%linear)
         associate (term => parts%linear(i))
            if (.not. term%harmonic) cycle
            call find_wave(term%frequency, term%phase, problem, number)
            do j = 1, problem%fixed
               do b = 1, 3
                  do a = 1, 3
                     problem%harmonic(a, b, j, number) = problem%harmonic(a, b, j, number) + &
                        normal(class, problem, dot_product(problem%basis(:, j), term%e%at)* &
                        term%matrix(a, b), a)
                  end do
               end do
            end do
         end associate
      end do
      do i = 1, size(parts%body)
         associate (term => parts%body(i))
            do a = 1, 3
               if (term%harmonic) then
                  call find_wave(term%frequency, term%phase, problem, number)
                  problem%harmonic_body(a, number) = problem%harmonic_body(a, number) + &
                     normal(class, problem, term%value(a), a)
               else
                  problem%body(a) = problem%body(a) + normal(class, problem, term%value(a), a)
               end if
            end do
         end associate
      end do
      problem%table = parts%table
      allocate (problem%table_inverse(3, size(parts%table)), source=0.0_dp)
      do i = 1, size(problem%table)
         call fill_table(class, problem%table(i), problem%table_inverse(:, i), problem)
      end do
   end subroutine fill_times

   pure subroutine find_wave(frequency, phase, problem, number)
      real(dp), intent(in) :: frequency, phase
      type(taylor_problem), intent(inout) :: problem
      integer, intent(out) :: number
      do number = 1, size(problem%frequency)
         if (abs(problem%frequency(number) - frequency) <= 0 .and. &
             abs(problem%phase(number) - phase) <= 0) return
      end do
      problem%frequency = [problem%frequency, frequency]
      problem%phase = [problem%phase, phase]
      number = size(problem%frequency)
   end subroutine find_wave

   pure subroutine fill_table(class, table, inverse, problem)
      type(body_class), intent(in) :: class
      type(table_term), intent(inout) :: table
      real(dp), intent(out) :: inverse(3)
      type(taylor_problem), intent(in) :: problem
      real(dp) :: largest, v(3)
      integer :: j, a
      inverse = 0
      largest = maxval(abs(table%values))
      do j = 1, size(table%times)
         v = table%values(:, j)
         if (table%in_space) then
            if (largest > 0) v = matmul(v/largest, problem%basis)
            table%values(:, j) = v
         else
            do a = 1, 3
               table%values(a, j) = normal(class, problem, v(a), a)
            end do
         end if
      end do
      if (.not. table%in_space) return
      do a = 1, 3
         inverse(a) = normal(class, problem, largest, a)
      end do
   end subroutine fill_table

   !> Cosines and sines of the phases of all harmonic torques at one time. In a file of its own
   !> beside the loops over lanes: these would take a vector function of other bits.
   pure subroutine see_phases(problem, now, cosine, sine)
      type(taylor_problem), intent(in) :: problem
      real(dp), intent(in) :: now
      real(dp), intent(out) :: cosine(:), sine(:)       !! (waves)
      integer :: i
      do i = 1, size(problem%frequency)
         cosine(i) = cos(problem%frequency(i)*now + problem%phase(i))
         sine(i) = sin(problem%frequency(i)*now + problem%phase(i))
      end do
   end subroutine see_phases

   !> Value and slope of a table at time t on the way forwards or backwards, and how far it is to
   !> its next knot, at most `farthest`; a knot nearer than `slack` counts as passed.
   pure subroutine place_in_table(table, t, forwards, slack, value, slope, farthest)
      type(table_term), intent(in) :: table
      real(dp), intent(in) :: t
      logical, intent(in) :: forwards
      real(dp), intent(in) :: slack                   !! positive
      real(dp), intent(out) :: value(3), slope(3)
      real(dp), intent(inout) :: farthest             !! positive
      real(dp) :: at
      integer :: low, high, middle, n
      n = size(table%times)
      at = t + merge(slack, -slack, forwards)
      low = 0
      high = n + 1
      do while (high - low > 1)
         middle = (low + high)/2
         if (table%times(middle) <= at) then
            low = middle
         else
            high = middle
         end if
      end do
      if (forwards .and. high <= n) farthest = min(farthest, table%times(high) - t)
      if (.not. forwards .and. low >= 1) farthest = min(farthest, t - table%times(low))
      slope = 0
      if (low >= 1 .and. low < n) then
         slope = (table%values(:, high) - table%values(:, low))/(table%times(high) - &
            table%times(low))
         value = table%values(:, low) + slope*(t - table%times(low))
      else
         value = table%values(:, max(1, min(low, n)))
      end if
   end subroutine place_in_table

end module poinsot_taylor_problem
