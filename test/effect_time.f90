!> What changes with time: rotors by a table, torques that jump, directions that turn.
module test_effect_time
   use testdrive, only: new_unittest, unittest_type, error_type
   use test_expectation, only: expect, within
   use poinsot_core_error, only: poinsot_error, raised, clear
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_method, poinsot_ok
   use poinsot_core_time_table, only: time_table
   use poinsot_effect_effect, only: effect
   use poinsot_effect_registry, only: make_effect
   use poinsot_effect_settings, only: setting
   use poinsot_effect_settings_text, only: read_settings
   use poinsot_ensemble_bodies, only: body_view, column, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_dissipate, only: dissipate_bodies
   use poinsot_ensemble_observe, only: body_energies, body_momenta
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_effect, set_option
   use poinsot_ensemble_step, only: drift_bodies, kick_bodies, step_bodies
   use poinsot_splitting_registry, only: find_splitting, is_table, splitting_count, &
      splitting_name
   use poinsot_splitting_tableaux, only: splitting
   use test_oracle_algebra, only: cross, rotate
   implicit none(type, external)
   private
   public :: collect_effect_time

   real(dp), parameter :: moments(3) = [0.6_dp, 1.0_dp, 0.8_dp]
   real(dp), parameter :: y0(3) = [0.9_dp, 0.4_dp, -0.7_dp], q0(4) = [0.5_dp, 0.1_dp, -0.7_dp, &
      0.5_dp]
   !> Momentum of a rotor: up, away in one moment, down from another value.
   character(*), parameter :: wheel = "times = 0, 0.5, 0.5, 1; table = 0.1, 0.2, 0.3, &
      &0.4, -0.2, 0.6, -0.3, 0.5, 0.1, 0, 0.1, 0.9"
   character(*), parameter :: push = "times = 0.25, 0.5, 0.5, 1, 1; table = 0.1, 0.2, 0.3, &
      &0.4, -0.2, 0.6, -0.3, 0.5, 0.1, 0, 0.1, 0.9, 2, 3, 4"

contains

   subroutine collect_effect_time(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("table-in-time", test_table), &
         new_unittest("rotor-by-a-table", test_rotor), &
         new_unittest("rotor-by-a-table-every-splitting", test_rotor_orders), &
         new_unittest("calls-without-a-time-refuse-such-a-rotor", test_refused), &
         new_unittest("velocities-beside-a-rotor-that-changes", test_velocities), &
         new_unittest("a-jump-at-the-end-of-a-step", test_jump), &
         new_unittest("a-jump-in-one-call-and-in-many", test_bits), &
         new_unittest("gravity-that-turns", test_gravity), &
         new_unittest("spring-that-turns", test_spring)]
   end subroutine collect_effect_time

   !> Values, sides of a jump.
   subroutine test_table(error)
      type(error_type), allocatable, intent(out) :: error
      type(time_table) :: t
      real(dp) :: v(3)
      t%times = [0.0_dp, 1.0_dp, 1.0_dp, 3.0_dp]
      t%values = reshape([1.0_dp, 1.0_dp, 1.0_dp, 2.0_dp, 2.0_dp, 2.0_dp, 5.0_dp, 5.0_dp, 5.0_dp, &
         7.0_dp, 7.0_dp, 7.0_dp], [3, 4])
      t%jumps = .true.
      v = t%at(-1.0_dp)
      call within(error, maxval(abs(v - 1)), 0.0_dp, "before")
      v = t%at(0.5_dp)
      call within(error, maxval(abs(v - 1.5_dp)), 0.0_dp, "between")
      v = t%at(1.0_dp)
      call within(error, maxval(abs(v - 5)), 0.0_dp, "at the jump")
      v = t%at(t%seen(1.0_dp, -1e-9_dp))
      call within(error, maxval(abs(v - 2)), 1e-15_dp, "looking back")
      v = t%at(t%seen(1 + 1e-12_dp, -1e-9_dp))
      call within(error, maxval(abs(v - 2)), 1e-15_dp, "a little late, looking back")
      v = t%at(t%seen(1 - 1e-12_dp, 1e-9_dp))
      call within(error, maxval(abs(v - 5)), 0.0_dp, "a little early, looking ahead")
      call within(error, abs(t%seen(0.9_dp, 1e-9_dp) - 0.9_dp), 0.0_dp, "far from it")
      v = t%at(4.0_dp)
      call within(error, maxval(abs(v - 7)), 0.0_dp, "behind")
   end subroutine test_table

   !> A plan of one class with one effect.
   subroutine make(plan, name, text, scheme, failure, layout, more)
      type(poinsot_plan), intent(inout) :: plan
      character(*), intent(in) :: name, text, scheme
      type(poinsot_error), intent(inout) :: failure
      character(*), intent(in), optional :: layout, more
      type(setting), allocatable :: settings(:)
      integer :: number
      call clear(failure)
      call set_option(plan, "splitting", scheme, failure)
      if (present(layout)) call set_option(plan, "momentum", layout, failure)
      if (.not. raised(failure)) call add_class(plan, moments, number, failure)
      if (raised(failure)) return
      call read_settings(text, settings, failure)
      if (.not. raised(failure)) call add_effect(plan, name, settings, failure)
      if (present(more) .and. .not. raised(failure)) then
         call read_settings("friction = 0.1", settings, failure)
         call add_effect(plan, more, settings, failure)
      end if
      if (.not. raised(failure)) call make_ready(plan, failure)
   end subroutine make

   !> Steps of one body.
   subroutine go(plan, t, h, first, steps, y, q, failure)
      type(poinsot_plan), intent(in) :: plan
      real(dp), intent(in) :: t, h
      integer, intent(in) :: first, steps
      real(dp), intent(inout), target :: y(3, 1), q(4, 1)
      type(poinsot_error), intent(inout) :: failure
      type(body_view) :: view
      integer :: status
      call view_rows(y, q, view)
      call step_bodies(plan, view, t, h, int(first, i8), int(steps, i8), status, failure)
   end subroutine go

   !> y' = y x I^-1 (y - s(t)) by Runge and Kutta, from piece to piece.
   subroutine judge(t, t_end, y, q)
      real(dp), intent(in) :: t, t_end
      real(dp), intent(inout) :: y(3, 1), q(4, 1)
      integer, parameter :: steps = 4000
      real(dp) :: x(7), k(7, 4), h, now
      integer :: i
      h = (t_end - t)/steps
      x = [y(:, 1), q(:, 1)]
      do i = 1, steps
         now = t + (i - 1)*h
         k(:, 1) = slope(now, x)
         k(:, 2) = slope(now + h/2, x + h/2*k(:, 1))
         k(:, 3) = slope(now + h/2, x + h/2*k(:, 2))
         k(:, 4) = slope(now + h, x + h*k(:, 3))
         x = x + h/6*(k(:, 1) + 2*k(:, 2) + 2*k(:, 3) + k(:, 4))
      end do
      y(:, 1) = x(:3)
      q(:, 1) = x(4:)
   contains
      pure function slope(now, x) result(rate)
         real(dp), intent(in) :: now, x(7)
         real(dp) :: rate(7), w(3), s(3)
         if (t_end <= 0.5_dp) then
            s = [0.1_dp, 0.2_dp, 0.3_dp] + 2*now*[0.3_dp, -0.4_dp, 0.3_dp]
         else
            s = [-0.3_dp, 0.5_dp, 0.1_dp] + 2*(now - 0.5_dp)*[0.3_dp, -0.4_dp, 0.8_dp]
         end if
         w = (x(:3) - s)/moments
         rate(:3) = cross(x(:3), w)
         rate(4) = -dot_product(x(5:), w)/2
         rate(5:) = (x(4)*w + cross(x(5:), w))/2
      end function slope
   end subroutine judge

   subroutine test_rotor(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: failure
      real(dp) :: y(3, 1), q(4, 1), z(3, 1), r(4, 1), before(3)
      call make(plan, "gyrostat", wheel, "srkn6", failure)
      call expect(error, .not. raised(failure), "refused")
      if (allocated(error)) return
      y(:, 1) = y0
      q(:, 1) = q0/norm2(q0)
      z = y
      r = q
      before = rotate(q(:, 1), y(:, 1))
      call go(plan, 0.0_dp, 0.025_dp, 0, 40, y, q, failure)
      call judge(0.0_dp, 0.5_dp, z, r)
      call judge(0.5_dp, 1.0_dp, z, r)
      call within(error, maxval(abs(y - z)), 1e-11_dp, "momentum")
      call within(error, min(maxval(abs(q - r)), maxval(abs(q + r))), 1e-11_dp, "attitude")
      call within(error, maxval(abs(rotate(q(:, 1), y(:, 1)) - before)), 1e-14_dp, "Q y")
      call go(plan, 1.0_dp, -0.025_dp, 0, 40, y, q, failure)
      call within(error, maxval(abs(y(:, 1) - y0)), 1e-13_dp, "and back")
   end subroutine test_rotor

   !> Every splitting has its order, or that of its composition with a rotor, where knots and jumps
   !> are at ends of steps.
   subroutine test_rotor_orders(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan), allocatable :: plan
      type(poinsot_error) :: failure
      real(dp) :: y(3, 1), q(4, 1), z(3, 1), r(4, 1), off(2)
      integer :: i, k
      z(:, 1) = y0
      r(:, 1) = q0/norm2(q0)
      call judge(0.0_dp, 0.5_dp, z, r)
      call judge(0.5_dp, 1.0_dp, z, r)
      do i = 1, splitting_count()
         if (.not. is_table(i)) cycle
         do k = 1, 2
            allocate (plan)
            call make(plan, "gyrostat", wheel, splitting_name(i), failure)
            call expect(error, .not. raised(failure), splitting_name(i))
            if (allocated(error)) return
            y(:, 1) = y0
            q(:, 1) = q0/norm2(q0)
            call go(plan, 0.0_dp, 0.1_dp/k, 0, 10*k, y, q, failure)
            off(k) = maxval(abs(y - z))
            deallocate (plan)
         end do
         call expect(error, off(2) <= max(1e-11_dp, 0.3_dp*off(1)) .and. off(1) < 1e-2_dp, &
            splitting_name(i))
      end do
   end subroutine test_rotor_orders

   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan), target :: plan, velocity, adaptive, other
      type(poinsot_error) :: failure
      type(body_view) :: view
      type(column) :: torque(3)
      real(dp), target :: y(3, 1), q(4, 1), g(1), p(3, 1), e(1), u(1)
      integer :: status, j
      y(:, 1) = y0
      q(:, 1) = q0/norm2(q0)
      g = 1
      call view_rows(y, q, view)
      do j = 1, 3
         torque(j)%of => g
      end do
      call make(plan, "gyrostat", wheel, "srkn6", failure, more="drag")
      call expect(error, .not. raised(failure), "refused")
      call drift_bodies(plan, view, 0.1_dp, status, failure)
      call is_method("drift")
      call dissipate_bodies(plan, view, 0.1_dp, 1_i8, status, failure)
      call is_method("dissipate")
      call kick_bodies(plan, view, 0.1_dp, torque, status, failure)
      call expect(error, status, poinsot_ok, "kick")
      call within(error, maxval(abs(y(:, 1) - y0 - 0.1_dp)), 1e-15_dp, "kicked")
      call make(velocity, "gyrostat", wheel, "srkn6", failure, "body-velocity")
      call kick_bodies(velocity, view, 0.1_dp, torque, status, failure)
      call is_method("kick of velocities")
      call body_momenta(velocity, view, p, status, failure)
      call is_method("momenta of velocities")
      call body_energies(velocity, view, 0.2_dp, e, u, status, failure)
      call expect(error, status, poinsot_ok, "energy")
      call make(adaptive, "gyrostat", wheel, "taylor", failure)
      call expect(error, failure%code, poinsot_e_method, "taylor")
      call expect(error, index(failure%message, "change with time") > 0, "its words")
      call make(other, "gyrostat", "times = 0, 1; table = 0, 0, 1e80, 0, 0, 1", "srkn6", failure)
      call expect(error, failure%code, poinsot_e_domain, "a rotor too fast")
      call bad("gyrostat", "rotor = 1,2,3; times = 0; table = 1,2,3", "not beside it")
      call bad("gyrostat", "times = 0, 1; table = 1,2,3", "three numbers for each")
      call bad("torque", "times = 0,1,1,1; table = 1,1,1,1,1,1,1,1,1,1,1,1", "more than twice")
      call bad("torque", "times = 0,1,0.5; table = 1,1,1,1,1,1,1,1,1", "must ascend")
      call bad("gravity", "centre = 1,2,3; rate = 1; about = 0,0,0", "about")
   contains
      subroutine is_method(what)
         character(*), intent(in) :: what
         call expect(error, status, poinsot_e_method, what)
         call expect(error, index(failure%message, "not given the time") > 0, failure%message)
         call clear(failure)
      end subroutine is_method
      subroutine bad(name, text, words)
         character(*), intent(in) :: name, text, words
         type(setting), allocatable :: settings(:)
         class(effect), allocatable :: made
         call clear(failure)
         call read_settings(text, settings, failure)
         call make_effect(name, settings, made, failure)
         call expect(error, index(failure%message, words) > 0, text)
         if (.not. allocated(error)) call expect(error, .not. allocated(made), text)
      end subroutine bad
   end subroutine test_refused

   !> Velocities at the start are beside the rotor of then, at the end beside that of the end; from
   !> call to call the momentum stays, whatever the rotor does between them.
   subroutine test_velocities(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan, native
      type(poinsot_error) :: failure
      real(dp) :: y(3, 1), q(4, 1), w(3, 1), r(4, 1)
      real(dp), parameter :: last(3) = [0.0_dp, 0.1_dp, 0.9_dp]
      integer :: k
      call make(native, "gyrostat", wheel, "srkn6", failure)
      call make(plan, "gyrostat", wheel, "srkn6", failure, "body-velocity")
      y(:, 1) = y0
      q(:, 1) = q0/norm2(q0)
      r = q
      w(:, 1) = (y0 - [0.1_dp, 0.2_dp, 0.3_dp])/moments
      call go(native, 0.0_dp, 0.1_dp, 0, 10, y, q, failure)
      do k = 0, 9
         call go(plan, 0.0_dp, 0.1_dp, k, 1, w, r, failure)
      end do
      call within(error, maxval(abs(w(:, 1) - (y(:, 1) - last)/moments)), 1e-13_dp, "velocities")
      call within(error, maxval(abs(r - q)), 1e-13_dp, "attitudes")
   end subroutine test_velocities

   !> Torques that jump at ends of steps: every splitting moves as by two tables, one before the
   !> jump and one behind it; times off by roundings; taylor too.
   subroutine test_jump(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: first = "times = 0.25, 0.5; table = 0.1, 0.2, 0.3, 0.4, -0.2, 0.6"
      character(*), parameter :: second = "times = 0.5, 1; table = -0.3, 0.5, 0.1, 0, 0.1, 0.9"
      character(*), parameter :: frames(2) = [character(18) :: "", "; frame = 'space'"]
      type(poinsot_plan), allocatable :: whole, one, two
      type(poinsot_error) :: failure
      real(dp) :: y(3, 1), q(4, 1), z(3, 1), r(4, 1), bound
      integer :: i, k
      do i = 1, splitting_count()
         do k = 1, 2
            allocate (whole, one, two)
            call make(whole, "torque", push//frames(k), splitting_name(i), failure)
            if (.not. raised(failure)) call make(one, "torque", first//frames(k), &
               splitting_name(i), failure)
            if (.not. raised(failure)) call make(two, "torque", second//frames(k), &
               splitting_name(i), failure)
            call expect(error, .not. raised(failure), splitting_name(i))
            if (allocated(error)) return
            bound = merge(1e-14_dp, 1e-13_dp, is_table(i))
            if (is_processed(i)) bound = 1e-2_dp ! its state is not the body's
            y(:, 1) = y0
            q(:, 1) = q0/norm2(q0)
            z = y
            r = q
            call go(whole, 0.0_dp, 0.125_dp, 0, 8, y, q, failure)
            call go(one, 0.0_dp, 0.125_dp, 0, 4, z, r, failure)
            call go(two, 0.0_dp, 0.125_dp, 4, 4, z, r, failure)
            call within(error, max(maxval(abs(y - z)), maxval(abs(q - r))), bound, &
               splitting_name(i)//frames(k))
            ! steps that are no fractions: ends are off by roundings
            y(:, 1) = y0
            q(:, 1) = q0/norm2(q0)
            z = y
            r = q
            call go(whole, -0.1_dp, 0.1_dp, 0, 11, y, q, failure)
            call go(one, -0.1_dp, 0.1_dp, 0, 6, z, r, failure)
            call go(two, -0.1_dp, 0.1_dp, 6, 5, z, r, failure)
            call within(error, max(maxval(abs(y - z)), maxval(abs(q - r))), bound, &
               splitting_name(i)//" in tenths"//frames(k))
            deallocate (whole, one, two)
         end do
      end do
   end subroutine test_jump

   !> Ten steps in one call are ten calls, backwards too.
   subroutine test_bits(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan), allocatable :: plan
      type(poinsot_error) :: failure
      character(*), parameter :: names(2) = [character(8) :: "torque", "gyrostat"]
      real(dp) :: y(3, 1), q(4, 1), z(3, 1), r(4, 1), h
      integer :: i, k, j
      do i = 1, splitting_count()
         if (.not. is_table(i) .or. is_processed(i)) cycle
         do j = 1, 4
            allocate (plan)
            if (mod(j, 2) == 1) call make(plan, names(1), push, splitting_name(i), failure)
            if (mod(j, 2) == 0) call make(plan, names(2), wheel, splitting_name(i), failure)
            h = merge(0.1_dp, -0.1_dp, j <= 2)
            y(:, 1) = y0
            q(:, 1) = q0/norm2(q0)
            z = y
            r = q
            call go(plan, merge(0.0_dp, 1.0_dp, j <= 2), h, 0, 10, y, q, failure)
            do k = 0, 9
               call go(plan, merge(0.0_dp, 1.0_dp, j <= 2), h, k, 1, z, r, failure)
            end do
            call within(error, max(maxval(abs(y - z)), maxval(abs(q - r))), 0.0_dp, &
               splitting_name(i)//" "//names(2 - mod(j, 2)))
            deallocate (plan)
         end do
      end do
   end subroutine test_bits

   logical function is_processed(i)
      integer, intent(in) :: i
      type(splitting) :: scheme
      type(poinsot_error) :: failure
      call find_splitting(splitting_name(i), scheme, failure)
      is_processed = scheme%name /= ""
      if (is_processed) is_processed = is_table(i)
      if (is_processed) is_processed = size(scheme%enter) > 0
   end function is_processed

   !> Turning gravity is a dipole in a turning field.
   subroutine test_gravity(error)
      type(error_type), allocatable, intent(out) :: error
      call same("gravity", "centre = 0.3,-0.2,0.5; weight = 2; up = 1,0,0; rate = 1.3; " // &
         "phase = 0.4; about = 0,0.6,0.8", "field", "dipole = -0.3,0.2,-0.5; " // &
         "strength = 2,0,0; motion = 'rotating'; frequency = 1.3; phase = 0.4; " // &
         "axis = 0,0.6,0.8", error)
   end subroutine test_gravity

   subroutine test_spring(error)
      type(error_type), allocatable, intent(out) :: error
      call same("spring", "stiffness = 3; axis = 0,0,1; direction = 1,0,0; rate = 1.3; " // &
         "phase = 0.4", "potential", &
         "u = '-1.5*(cos(1.3*t + 0.4)*Q13 + sin(1.3*t + 0.4)*Q23)^2'", error)
   end subroutine test_spring

   !> Two effects, one motion and one energy; by taylor too.
   subroutine same(name, text, other, other_text, error)
      character(*), intent(in) :: name, text, other, other_text
      type(error_type), allocatable, intent(inout) :: error
      type(poinsot_plan) :: one, two, adaptive
      type(poinsot_error) :: failure
      real(dp), target :: y(3, 1), q(4, 1), z(3, 1), r(4, 1), w(3, 1), p(4, 1)
      real(dp) :: e(2), u(2)
      type(body_view) :: view
      integer :: status
      call make(one, name, text, "srkn6", failure)
      call expect(error, .not. raised(failure), name)
      call make(two, other, other_text, "srkn6", failure)
      call expect(error, .not. raised(failure), other)
      call make(adaptive, name, text, "taylor", failure)
      call expect(error, .not. raised(failure), "taylor")
      if (allocated(error)) return
      y(:, 1) = y0
      q(:, 1) = q0/norm2(q0)
      z = y
      r = q
      w = y
      p = q
      call go(one, 0.3_dp, 0.01_dp, 0, 200, y, q, failure)
      call go(two, 0.3_dp, 0.01_dp, 0, 200, z, r, failure)
      call go(adaptive, 0.3_dp, 2.0_dp, 0, 1, w, p, failure)
      call within(error, max(maxval(abs(y - z)), maxval(abs(q - r))), 1e-13_dp, name)
      call within(error, maxval(abs(y - w)), 1e-10_dp, name//" by taylor")
      call view_rows(y, q, view)
      call body_energies(one, view, 2.3_dp, e(1:1), u(1:1), status, failure)
      call body_energies(two, view, 2.3_dp, e(2:2), u(2:2), status, failure)
      call within(error, abs(u(1) - u(2)), 1e-14_dp, name//": energy")
   end subroutine same

end module test_effect_time
