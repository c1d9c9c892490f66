!> Bodies with torques in quadruple precision: the reference for double precision.
!>
!> Taylor series of momentum and quaternion themselves, y' = y x w + torques, q' = (1/2) q o (0, w),
!> w = I^-1 (y - s), with every direction in space that a torque depends on as d' = d x (w - rate
!> a). The torques are the same data as for the Taylor integrator (poinsot_effect_terms); equations,
!> unknowns and step size are different.
module poinsot_study_torque_series
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_body_class, only: body_class
   use poinsot_effect_terms, only: torque_terms, space_direction, linear_term, quadratic_term, &
      body_term, table_term
   use poinsot_ensemble_compose, only: class_terms
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_study_quadruple, only: cross
   implicit none(type, external)
   private
   public :: torque_problem, series_accuracy, fine, coarse, torque_problems, turn_under_torque

   integer, parameter :: most = 27              !! highest order there is room for

   !> Order of the series, and what is left out of a step, relative.
   type :: series_accuracy
      integer :: order = 0
      real(dp) :: tolerance = 0
   end type series_accuracy

   type(series_accuracy), parameter :: fine = series_accuracy(27, 1e-22_dp) !! a solution
   type(series_accuracy), parameter :: coarse = series_accuracy(22, 1e-18_dp) !! what judges it

   !> A body class and what acts on it.
   type :: torque_problem
      real(qp) :: inverse(3) = 1                     !! 1/I, 0 for a zero moment
      real(qp) :: rotor(3) = 0
      real(qp) :: friction(3, 3) = 0
      logical :: damped = .false.
      type(space_direction), allocatable :: seen(:)  !! directions that torques depend on
      integer, allocatable :: axis(:)                !! where the axis of each stands; 0: fixed
      type(linear_term), allocatable :: linear(:)
      integer, allocatable :: linear_at(:)           !! their directions
      type(quadratic_term), allocatable :: quadratic(:)
      integer, allocatable :: quadratic_at(:)
      type(body_term), allocatable :: body(:)
      type(table_term), allocatable :: table(:)
      integer :: frame(3) = 0                        !! the axes of space, for tables in it
   end type torque_problem

   !> Series of everything, coefficient by coefficient.
   type :: all_series
      real(qp) :: y(3, 0:most) = 0, w(3, 0:most) = 0, q(4, 0:most) = 0
      real(qp), allocatable :: d(:, :, :)            !! (3, 0:most, directions)
      real(qp), allocatable :: linear_wave(:, :)     !! (0:most, linear torques): their cosines
      real(qp), allocatable :: body_wave(:, :)       !! (0:most, torques in the body frame)
   end type all_series

contains

   !> What acts on the classes of a plan that is ready. Error: POINSOT_E_METHOD if an effect is no
   !> data (pairs, noise, a program's own torque).
   subroutine torque_problems(plan, problems, error)
      type(poinsot_plan), intent(in) :: plan
      type(torque_problem), allocatable, intent(out) :: problems(:)   !! (classes)
      type(poinsot_error), intent(inout) :: error
      type(torque_terms) :: terms
      integer :: c
      allocate (problems(plan%added))
      do c = 1, size(problems)
         call class_terms(plan, c, terms, error)
         if (raised(error)) return
         call make_torque_problem(plan%classes(c)%it, terms, problems(c))
      end do
   end subroutine torque_problems

   !> What acts on a class, made ready.
   pure subroutine make_torque_problem(class, terms, problem)
      type(body_class), intent(in) :: class
      type(torque_terms), intent(in) :: terms
      type(torque_problem), intent(out) :: problem
      real(dp), parameter :: unit(3, 3) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
      integer :: i
      problem%inverse = 0
      where (class%moments > 0) problem%inverse = 1/real(class%moments, qp)
      problem%rotor = class%rotor
      problem%friction = terms%friction
      problem%damped = any(abs(terms%friction) > 0)
      allocate (problem%seen(0), problem%axis(0))
      allocate (problem%linear(0), problem%quadratic(0), problem%body(0), problem%table(0))
      if (allocated(terms%linear)) problem%linear = terms%linear
      if (allocated(terms%quadratic)) problem%quadratic = terms%quadratic
      if (allocated(terms%body)) problem%body = terms%body
      if (allocated(terms%table)) problem%table = terms%table
      allocate (problem%linear_at(size(problem%linear)), &
         problem%quadratic_at(size(problem%quadratic)))
      do i = 1, size(problem%linear)
         call see(problem, problem%linear(i)%e, problem%linear_at(i))
      end do
      do i = 1, size(problem%quadratic)
         call see(problem, problem%quadratic(i)%e, problem%quadratic_at(i))
      end do
      if (.not. any(problem%table%in_space)) return
      do i = 1, 3
         call see(problem, space_direction(unit(:, i)), problem%frame(i))
      end do
   end subroutine make_torque_problem

   !> Index of a direction; a new one is added, with its axis if it rotates.
   pure recursive subroutine see(problem, e, at)
      type(torque_problem), intent(inout) :: problem
      type(space_direction), intent(in) :: e
      integer, intent(out) :: at
      integer :: axis
      do at = 1, size(problem%seen)
         associate (other => problem%seen(at))
            if (all(abs(other%at - e%at) <= 0) .and. all(abs(other%axis - e%axis) <= 0) .and. &
                abs(other%rate - e%rate) <= 0 .and. abs(other%phase - e%phase) <= 0) return
         end associate
      end do
      axis = 0
      if (abs(e%rate) > 0) call see(problem, space_direction(e%axis), axis)
      problem%seen = [problem%seen, e]
      problem%axis = [problem%axis, axis]
      at = size(problem%seen)
   end subroutine see

   !> Carry (y, q) from t to t1; |q| = 1 at the end. Not finished with `most_steps` steps: `done` is
   !> false, and the state is that of the time t reached, to go on from.
   pure subroutine turn_under_torque(problem, accuracy, t, t1, most_steps, y, q, done)
      type(torque_problem), intent(in) :: problem
      type(series_accuracy), intent(in) :: accuracy
      real(qp), intent(inout) :: t
      real(qp), intent(in) :: t1
      integer, intent(in) :: most_steps
      real(qp), intent(inout) :: y(3), q(4)
      logical, intent(out) :: done
      type(all_series) :: s
      real(qp) :: h, farthest
      integer :: steps
      allocate (s%d(3, 0:most, size(problem%seen)))
      allocate (s%linear_wave(0:most, size(problem%linear)), &
         s%body_wave(0:most, size(problem%body)))
      q = q/norm2(q)
      where (.not. problem%inverse > 0) y = 0
      steps = 0
      do while (abs(t1 - t) > 0 .and. steps < most_steps)
         steps = steps + 1
         farthest = knot_behind(problem, t, t1) - t
         call expand(problem, accuracy%order, t, t + farthest/2, y, q, s)
         h = step_of(accuracy, s)
         if (h >= abs(farthest)) then
            t = t + farthest
            h = farthest
            if (abs(t1 - t) <= epsilon(t)*abs(t1)) t = t1
         else
            h = farthest/aint(1 + abs(farthest)/h) ! equal steps to the knot
            t = t + h
         end if
         y = value_at(s%y(:, :accuracy%order), h)
         q = value_at(s%q(:, :accuracy%order), h)
         q = q*(3 - sum(q**2))/2
      end do
      q = q/norm2(q)
      done = .not. abs(t1 - t) > 0
   end subroutine turn_under_torque

   !> The next knot of a table between t and t1, or t1.
   pure real(qp) function knot_behind(problem, t, t1) result(stop_at)
      type(torque_problem), intent(in) :: problem
      real(qp), intent(in) :: t, t1
      integer :: i, j
      real(qp) :: knot
      stop_at = t1
      do i = 1, size(problem%table)
         do j = 1, size(problem%table(i)%times)
            knot = problem%table(i)%times(j)
            if ((knot - t)*(t1 - t) > 0 .and. abs(knot - t) < abs(stop_at - t)) stop_at = knot
         end do
      end do
   end function knot_behind

   !> Series of all unknowns at time t; `inside` is a time within the piece of every table.
   pure subroutine expand(problem, n, t, inside, y, q, s)
      type(torque_problem), intent(in) :: problem
      integer, intent(in) :: n
      real(qp), intent(in) :: t, inside, y(3), q(4)
      type(all_series), intent(inout) :: s
      real(qp) :: next(3)
      integer :: i, k
      s%y(:, 0) = y
      s%q(:, 0) = q
      do i = 1, size(problem%seen)
         s%d(:, 0, i) = seen_from(q, direction_at(problem%seen(i), t))
      end do
      do i = 1, size(problem%linear)
         if (problem%linear(i)%harmonic) call fill_wave(n, problem%linear(i)%frequency, &
            problem%linear(i)%phase, t, s%linear_wave(:, i))
      end do
      do i = 1, size(problem%body)
         if (problem%body(i)%harmonic) call fill_wave(n, problem%body(i)%frequency, &
            problem%body(i)%phase, t, s%body_wave(:, i))
      end do
      do k = 0, n - 1
         s%w(:, k) = problem%inverse*s%y(:, k)
         if (k == 0) s%w(:, k) = problem%inverse*(y - problem%rotor)
         next = folded_cross(k, s%y, s%w)
         if (problem%damped) next = next - matmul(problem%friction, s%w(:, k))
         call add_directions(problem, k, s, next)
         call add_times(problem, k, t, inside, s, next)
         where (.not. problem%inverse > 0) next = 0
         s%y(:, k + 1) = next/(k + 1)
         do i = 1, size(problem%seen)
            next = folded_cross(k, s%d(:, :, i), s%w)
            if (problem%axis(i) > 0) next = next - problem%seen(i)%rate* &
               folded_cross(k, s%d(:, :, i), s%d(:, :, problem%axis(i)))
            s%d(:, k + 1, i) = next/(k + 1)
         end do
         s%q(:, k + 1) = folded_turn(k, s%q, s%w)/(2*(k + 1))
      end do
      s%w(:, n) = problem%inverse*s%y(:, n)
   end subroutine expand

   !> Torques that depend on directions, coefficient k.
   pure subroutine add_directions(problem, k, s, torque)
      type(torque_problem), intent(in) :: problem
      integer, intent(in) :: k
      type(all_series), intent(in) :: s
      real(qp), intent(inout) :: torque(3)
      real(qp) :: squares(3), products(3)      !! of the components; product i leaves out i
      real(qp) :: v(3)
      integer :: i, j, a, b, c
      do i = 1, size(problem%linear)
         associate (term => problem%linear(i), at => problem%linear_at(i))
            v = s%d(:, k, at)
            if (term%harmonic) then
               v = 0
               do j = 0, k
                  v = v + s%linear_wave(j, i)*s%d(:, k - j, at)
               end do
            end if
            torque = torque + matmul(real(term%matrix, qp), v)
         end associate
      end do
      do i = 1, size(problem%quadratic)
         associate (term => problem%quadratic(i), at => problem%quadratic_at(i))
            do a = 1, 3
               b = 1 + mod(a, 3)
               c = 6 - a - b
               squares(a) = dot_product(s%d(a, 0:k, at), s%d(a, k:0:-1, at))
               products(a) = dot_product(s%d(b, 0:k, at), s%d(c, k:0:-1, at))
            end do
            do a = 1, 3
               b = 1 + mod(a, 3)
               c = 6 - a - b
               torque(a) = torque(a) + term%difference(a)*products(a) + &
                  term%product(a)*(squares(b) - squares(c)) + term%product(b)*products(c) - &
                  term%product(c)*products(b)
            end do
         end associate
      end do
   end subroutine add_directions

   !> Torques given in time, coefficient k.
   pure subroutine add_times(problem, k, t, inside, s, torque)
      type(torque_problem), intent(in) :: problem
      integer, intent(in) :: k
      real(qp), intent(in) :: t, inside
      type(all_series), intent(in) :: s
      real(qp), intent(inout) :: torque(3)
      real(qp) :: value(3), slope(3)
      integer :: i, a
      do i = 1, size(problem%body)
         associate (term => problem%body(i))
            if (term%harmonic) then
               torque = torque + s%body_wave(k, i)*term%value
            else if (k == 0) then
               torque = torque + term%value
            end if
         end associate
      end do
      do i = 1, size(problem%table)
         if (k > 1 .and. .not. problem%table(i)%in_space) cycle
         call look_up(problem%table(i), t, inside, value, slope)
         if (problem%table(i)%in_space) then
            do a = 1, 3
               torque = torque + value(a)*s%d(:, k, problem%frame(a))
               if (k > 0) torque = torque + slope(a)*s%d(:, k - 1, problem%frame(a))
            end do
         else if (k == 0) then
            torque = torque + value
         else
            torque = torque + slope
         end if
      end do
   end subroutine add_times

   !> Value at time t and slope of the piece of a table that holds the time `inside`.
   pure subroutine look_up(table, t, inside, value, slope)
      type(table_term), intent(in) :: table
      real(qp), intent(in) :: t, inside
      real(qp), intent(out) :: value(3), slope(3)
      integer :: n, low
      n = size(table%times)
      low = count(table%times <= inside)
      slope = 0
      value = table%values(:, max(1, min(low, n)))
      if (low < 1 .or. low >= n) return
      slope = (real(table%values(:, low + 1), qp) - table%values(:, low))/ &
         (real(table%times(low + 1), qp) - table%times(low))
      value = value + slope*(t - table%times(low))
   end subroutine look_up

   !> Coefficients 0 to n of cos(frequency (t + x) + phase) in x.
   pure subroutine fill_wave(n, frequency, phase, t, wave)
      integer, intent(in) :: n
      real(dp), intent(in) :: frequency, phase
      real(qp), intent(in) :: t
      real(qp), intent(out) :: wave(0:most)
      real(qp) :: angle
      integer :: k
      angle = frequency*t + phase
      wave = 0
      wave(0) = cos(angle)
      wave(1) = -frequency*sin(angle)
      do k = 2, n
         wave(k) = -wave(k - 2)*real(frequency, qp)**2/(k*(k - 1))
      end do
   end subroutine fill_wave

   !> A direction at time t, in space.
   pure function direction_at(e, t) result(v)
      type(space_direction), intent(in) :: e
      real(qp), intent(in) :: t
      real(qp) :: v(3), a(3), angle
      v = e%at
      angle = e%rate*t + e%phase
      if (.not. abs(angle) > 0) return
      a = e%axis
      v = cos(angle)*v + sin(angle)*cross(a, v) + (1 - cos(angle))*dot_product(a, v)*a
   end function direction_at

   !> Q^T v.
   pure function seen_from(q, v) result(u)
      real(qp), intent(in) :: q(4), v(3)
      real(qp) :: u(3), w(3)
      w = 2*cross(v, q(2:4))
      u = v + (q(1)*w + cross(w, q(2:4)))/sum(q**2)
   end function seen_from

   !> Coefficient k of a x b.
   pure function folded_cross(k, a, b) result(c)
      integer, intent(in) :: k
      real(qp), intent(in) :: a(3, 0:most), b(3, 0:most)
      real(qp) :: c(3)
      integer :: j
      c = 0
      do j = 0, k
         c = c + cross(a(:, j), b(:, k - j))
      end do
   end function folded_cross

   !> Coefficient k of q o (0, w).
   pure function folded_turn(k, q, w) result(c)
      integer, intent(in) :: k
      real(qp), intent(in) :: q(4, 0:most), w(3, 0:most)
      real(qp) :: c(4)
      integer :: j
      c = 0
      do j = 0, k
         associate (a => q(:, j), b => w(:, k - j))
            c(1) = c(1) - dot_product(a(2:4), b)
            c(2:4) = c(2:4) + a(1)*b + cross(a(2:4), b)
         end associate
      end do
   end function folded_turn

   !> The longest step whose last two terms are within the tolerance (Jorba and Zou 2005): of the
   !> attitude, and of the rates beside the fastest, which y of a thin body does not show.
   pure real(qp) function step_of(accuracy, s) result(h)
      type(series_accuracy), intent(in) :: accuracy
      type(all_series), intent(in) :: s
      real(qp) :: size_of, longest, fastest, heaviest
      integer :: k
      fastest = max(maxval(abs(s%w(:, 0))), sqrt(maxval(abs(s%w(:, 1)))))
      heaviest = maxval(abs(s%y(:, 0)))
      h = huge(h)
      do k = accuracy%order - 1, accuracy%order
         size_of = norm2(s%q(:, k))
         if (fastest > 0) size_of = max(size_of, norm2(s%w(:, k)/fastest))
         if (heaviest > 0 .and. .not. fastest > 0) size_of = max(size_of, norm2(s%y(:, &
            k)/heaviest))
         if (.not. size_of > 0) cycle
         longest = exp((log(real(accuracy%tolerance, qp)) - log(size_of))/k)
         h = min(h, longest)
      end do
   end function step_of

   !> Horner's scheme.
   pure function value_at(c, h) result(x)
      real(qp), intent(in) :: c(:, 0:), h
      real(qp) :: x(size(c, 1))
      integer :: k
      x = c(:, ubound(c, 2))
      do k = ubound(c, 2) - 1, 0, -1
         x = x*h + c(:, k)
      end do
   end function value_at

end module poinsot_study_torque_series
