!> Moments of each body's own: a scale of those of its class, or any. What they mean is said by
!> plans that have a class for each body.
module test_ensemble_own
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use testdrive, only: unittest_type, new_unittest, error_type
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_method, &
      poinsot_e_not_finite, poinsot_e_null, poinsot_e_partial, poinsot_e_axis_momentum
   use poinsot_ensemble_bodies, only: body_view, column, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_layout, only: momentum_names
   use poinsot_ensemble_observe, only: body_energies, body_momenta, total_degrees_of_freedom
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_tensor_class, set_option
   use poinsot_ensemble_step, only: drift_bodies, kick_bodies, step_bodies
   use poinsot_ensemble_system, only: torque_callback
   use poinsot_free_method, only: method_count, method_name
   use test_bodies, only: random_quaternion, random_stream, start_stream, uniform
   use test_crowd, only: with_effect, same_bits
   use test_expectation, only: expect, within, refused, accepted
   implicit none(type, external)
   private
   public :: collect_own

   !> Bodies, and what a plan says of their moments.
   type :: bodies
      integer :: n = 0
      real(dp), allocatable :: y(:, :), q(:, :)   !! (4, n), of y three or four are used
      integer, allocatable :: class(:)            !! from 1
      real(dp), allocatable :: scale(:)           !! of a class's moments
      real(dp), allocatable :: moments(:, :)      !! (3, n), or those of each body
      real(dp), allocatable :: carry(:, :)        !! compensated sums, if wanted
      integer, allocatable :: status(:)
   end type bodies

   !> A torque that depends on the attitude.
   type, extends(torque_callback) :: swirl
   contains
      procedure :: evaluate => evaluate_swirl
   end type swirl

   integer, parameter :: kinds = 6
   !> Every kind of body: three moments that differ, flat, linear, symmetric twice, sphere.
   real(dp), parameter :: kind_moments(3, kinds) = reshape([1.1_dp, 0.6_dp, 0.8_dp, 0.5_dp, &
      0.9_dp, 0.4_dp, 0.7_dp, 0.7_dp, 0.0_dp, 0.5_dp, 0.5_dp, 0.8_dp, 0.9_dp, 0.6_dp, 0.9_dp, &
      0.7_dp, 0.7_dp, 0.7_dp], [3, kinds])
   real(dp), parameter :: h = 0.05_dp
   character(90), parameter :: effects(15) = [character(90) :: "", &
      "gravity:centre = 0.1, 0.2, 1; weight = 1.3", &
      "field:dipole = 1, 0.2, 0.3; strength = 0.2, 0, 1; motion = rotating; frequency = 3", &
      "gravity_gradient:rate = 0.7", &
      "spring:stiffness = 1.5; axis = 1, 2, 3; direction = 1, 0, 1", &
      "torque:value = 0.1, 0.2, -0.3; frame = space; frequency = 2", &
      "dipoles:dipole = 0.3, 0.1, 1; coupling = 0.01; spacing = 2", &
      "callback", &
      "drag:friction = 0.1, 0.2, 0.3", &
      "langevin:friction = 0.5, 0.2, 0.1; temperature = 0.4", &
      "gyrostat:rotor = 0.1, 0.3, 0.2; class = 1", &
      "full:drag:friction = 0.1, 0.2, 0.3", &
      "full:langevin:friction = 0.1, 0.2, 0.3; temperature = 0.4", &
      "langevin:rate = 0.5, 0.2, 0.1; temperature = 0.4", &
      "drag:rate = 0.1, 0.2, 0.3"]

contains

   subroutine collect_own(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("scale-by-every-effect", test_scale_effects), &
         new_unittest("scale-in-every-layout", test_scale_layouts), &
         new_unittest("scale-by-every-method", test_scale_methods), &
         new_unittest("scale-in-any-unit", test_scale_units), &
         new_unittest("scale-faults", test_scale_faults), &
         new_unittest("moments-of-each-body", test_moments), &
         new_unittest("moments-in-any-unit", test_moments_units), &
         new_unittest("moments-refused", test_moments_refused), &
         new_unittest("moments-faults", test_moments_faults), &
         new_unittest("own-moments-bits", test_bits)]
   end subroutine collect_own

   ! Bodies and plans
   ! -----------------------------------------------------------------------------------------------

   !> Bodies of every kind, with scales about 1.
   subroutine make_bodies(n, it)
      integer, intent(in) :: n
      type(bodies), intent(out) :: it
      type(random_stream) :: stream
      integer :: i, j
      it%n = n
      allocate (it%y(4, n), it%q(4, n), it%class(n), it%scale(n), it%status(n))
      it%y = 0
      it%status = -1
      stream = start_stream(11)
      do i = 1, n
         it%class(i) = 1 + mod(i, kinds)
         it%scale(i) = 0.4_dp + 3*uniform(stream)
         do j = 1, 3
            it%y(j, i) = it%scale(i)*(2*uniform(stream) - 1)
         end do
         if (it%class(i) == 3) it%y(3, i) = 0
         it%q(:, i) = random_quaternion(stream)
      end do
   end subroutine make_bodies

   !> A plan of the kinds of body; or, for a crowd, of a class for each body.
   subroutine make_plan(effect, splitting, method, momentum, plan, each)
      character(*), intent(in) :: effect, splitting, method, momentum
      type(poinsot_plan), intent(out) :: plan
      type(bodies), intent(in), optional :: each
      type(poinsot_error) :: problem
      integer :: i
      logical :: full
      full = index(effect, "full:") == 1
      if (present(each)) then
         do i = 1, each%n
            call add_kind(each%class(i), each%scale(i), full, plan)
         end do
      else
         do i = 1, kinds
            call add_kind(i, 1.0_dp, full, plan)
         end do
      end if
      call add_effects(effect, each, plan)
      call set_option(plan, "splitting", splitting, problem)
      call set_option(plan, "method", method, problem)
      call set_option(plan, "momentum", momentum, problem)
      call set_option(plan, "seed", "5", problem)
      call make_ready(plan, problem)
      if (raised(problem)) error stop "make_plan"
   end subroutine make_plan

   !> A kind of body; in a frame that is not that of its principal axes where it is wanted.
   subroutine add_kind(kind, scale, full, plan)
      integer, intent(in) :: kind
      real(dp), intent(in) :: scale
      logical, intent(in) :: full
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error) :: problem
      integer :: number
      real(dp) :: tensor(3, 3)
      if (full .and. kind == 1) then
         tensor = reshape([0.9_dp, 0.1_dp, -0.05_dp, 0.1_dp, 0.7_dp, 0.08_dp, -0.05_dp, 0.08_dp, &
            1.0_dp], [3, 3])
         call add_tensor_class(plan, scale*tensor, number, problem)
      else
         call add_class(plan, scale*kind_moments(:, kind), number, problem)
      end if
      if (raised(problem)) error stop "add_kind"
   end subroutine add_kind

   !> An effect; one that acts on class 1 alone acts on every body of that kind.
   subroutine add_effects(effect, each, plan)
      character(*), intent(in) :: effect
      type(bodies), intent(in), optional :: each
      type(poinsot_plan), intent(inout) :: plan
      character(:), allocatable :: text, settings
      character(8) :: number
      integer :: i, colon, place
      text = effect
      if (index(text, "full:") == 1) text = text(6:)
      colon = index(text, ":")
      if (colon == 0) return
      settings = trim(text(colon + 1:))
      place = index(settings, "; class = 1")
      if (place == 0 .or. .not. present(each)) then
         call with_effect(plan, text(:colon - 1), settings)
         return
      end if
      do i = 1, each%n
         if (each%class(i) /= 1) cycle
         write (number, "(i0)") i
         call with_effect(plan, text(:colon - 1), settings(:place + 9)//trim(number))
      end do
   end subroutine add_effects

   !> A view of bodies by their scales or moments, or, `plain`, of bodies of a class each.
   subroutine open(it, plain, view)
      type(bodies), intent(inout), target :: it
      logical, intent(in) :: plain
      type(body_view), intent(out) :: view
      integer :: i, j
      call view_rows(it%y, it%q, view)
      view%status => it%status
      if (allocated(it%carry)) view%carry => it%carry
      if (plain) then
         it%class = [(i, i=1, it%n)]
      else if (allocated(it%moments)) then
         do j = 1, 3
            view%moments(j)%of => it%moments(j, :)
         end do
      else
         view%scale => it%scale
      end if
      view%body_class => it%class
   end subroutine open

   !> Steps of all bodies.
   subroutine go(plan, it, effect, plain, first, steps, status)
      type(poinsot_plan), intent(in) :: plan
      type(bodies), intent(inout) :: it
      character(*), intent(in) :: effect
      logical, intent(in) :: plain
      integer(i8), intent(in) :: first, steps
      integer, intent(out) :: status
      type(body_view) :: view
      type(poinsot_error) :: problem
      type(swirl) :: host
      call open(it, plain, view)
      if (effect == "callback") then
         call step_bodies(plan, view, 0.3_dp, h, first, steps, status, problem, host)
      else
         call step_bodies(plan, view, 0.3_dp, h, first, steps, status, problem)
      end if
      if (raised(problem)) status = problem%code
   end subroutine go

   !> The largest differences, relative to momentum and to 1.
   subroutine near(error, a, b, bound, what)
      type(error_type), allocatable, intent(inout) :: error
      type(bodies), intent(in) :: a, b
      real(dp), intent(in) :: bound
      character(*), intent(in) :: what
      integer :: i
      do i = 1, a%n
         call within(error, norm2(a%y(:, i) - b%y(:, i))/(norm2(b%y(:, i)) + tiny(h)), bound, &
            what//": momentum")
         call within(error, norm2(a%q(:, i) - b%q(:, i)), bound, what//": attitude")
      end do
   end subroutine near

   subroutine evaluate_swirl(self, t, q, torque, energy, stop)
      class(swirl), intent(inout) :: self
      real(dp), intent(in) :: t
      real(dp), intent(in), target :: q(:, :)
      real(dp), intent(inout), target :: torque(:, :)
      real(dp), intent(inout) :: energy
      logical, intent(inout) :: stop
      associate (unused => self, unused_2 => stop, unused_3 => energy)
      end associate
      torque(:, 1) = q(:, 2)*cos(t)
      torque(:, 2) = q(:, 3)
      torque(:, 3) = -q(:, 1)*q(:, 2)
   end subroutine evaluate_swirl

   ! Scales
   ! -----------------------------------------------------------------------------------------------

   !> Bodies of a scale move as bodies of a class with so many times the moments; energies too.
   subroutine test_scale_effects(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: e
      do e = 1, size(effects)
         call compare_scale(error, trim(effects(e)), "strang", "exact", "body-momentum", 4e-15_dp)
         call compare_scale(error, trim(effects(e)), "srkn6", "exact", "body-momentum", 1e-14_dp)
         if (has_gradient(trim(effects(e)))) then
            call compare_scale(error, trim(effects(e)), "takahashi-imada", "exact", &
               "body-momentum", 1e-14_dp)
         end if
         if (is_data(trim(effects(e)))) then
            call compare_scale(error, trim(effects(e)), "taylor", "exact", "body-momentum", &
               1e-12_dp)
         end if
      end do
   end subroutine test_scale_effects

   logical function has_gradient(effect)
      character(*), intent(in) :: effect
      has_gradient = effect /= "callback" .and. index(effect, "langevin") == 0
   end function has_gradient

   logical function is_data(effect)
      character(*), intent(in) :: effect
      is_data = has_gradient(effect) .and. index(effect, "dipoles") == 0
   end function is_data

   subroutine test_scale_layouts(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: k
      do k = 1, size(momentum_names)
         call compare_scale(error, trim(effects(2)), "strang", "exact", trim(momentum_names(k)), &
            1e-14_dp)
         call compare_scale(error, trim(effects(11)), "strang", "exact", trim(momentum_names(k)), &
            1e-14_dp)
         call compare_scale(error, "full:"//trim(effects(4)), "srkn4", "exact", &
            trim(momentum_names(k)), 1e-14_dp)
      end do
   end subroutine test_scale_layouts

   subroutine test_scale_methods(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: m
      do m = 1, method_count()
         call compare_scale(error, trim(effects(4)), "strang", method_name(m), "body-momentum", &
            1e-13_dp)
      end do
   end subroutine test_scale_methods

   !> Three steps, energies, momenta in space, degrees of freedom, a drift and a kick.
   subroutine compare_scale(error, effect, splitting, method, momentum, bound)
      type(error_type), allocatable, intent(inout) :: error
      character(*), intent(in) :: effect, splitting, method, momentum
      real(dp), intent(in) :: bound
      type(bodies), target :: scaled, plain
      type(poinsot_plan) :: of_kinds, of_each
      character(:), allocatable :: what
      integer :: compensated, status
      if (allocated(error)) return
      what = effect//", "//splitting//", "//method//", "//momentum
      do compensated = 0, 1
         call make_bodies(70, scaled)
         call make_plan(effect, splitting, method, momentum, of_kinds)
         call make_plan(effect, splitting, method, momentum, of_each, scaled)
         if (compensated == 1) allocate (scaled%carry(7, scaled%n), source=0.0_dp)
         call express(momentum, scaled)
         plain = scaled
         call go(of_kinds, scaled, effect, .false., 3_i8, 3_i8, status)
         call expect(error, status, poinsot_ok, what//": by scale")
         call go(of_each, plain, effect, .true., 3_i8, 3_i8, status)
         call expect(error, status, poinsot_ok, what//": by class")
         call near(error, scaled, plain, bound, what)
         call compare_rest(error, of_kinds, scaled, of_each, plain, bound, what)
         if (allocated(error)) return
      end do
   end subroutine compare_scale

   !> Momenta as a layout has them: velocities are not as large as they were.
   subroutine express(momentum, it)
      character(*), intent(in) :: momentum
      type(bodies), intent(inout) :: it
      integer :: i
      do i = 1, it%n
         if (momentum(max(1, len(momentum) - 7):) == "velocity") then
            it%y(:, i) = it%y(:, i)/it%scale(i)
            if (it%class(i) == 3) it%y(:, i) = 0
         else if (it%class(i) == 3 .and. momentum /= "body-momentum") then
            it%y(:, i) = 0
         end if
         if (momentum == "conjugate-momentum") it%y(:, i) = conjugate(it%q(:, i), it%y(1:3, i))
      end do
   end subroutine express

   pure function conjugate(q, y) result(p)
      real(dp), intent(in) :: q(4), y(3)
      real(dp) :: p(4)
      p(1) = -2*(q(2)*y(1) + q(3)*y(2) + q(4)*y(3))
      p(2) = 2*(q(1)*y(1) + q(3)*y(3) - q(4)*y(2))
      p(3) = 2*(q(1)*y(2) + q(4)*y(1) - q(2)*y(3))
      p(4) = 2*(q(1)*y(3) + q(2)*y(2) - q(3)*y(1))
   end function conjugate

   !> What a plan says of bodies, and the flows that hosts call.
   subroutine compare_rest(error, plan, a, by_class, b, bound, what)
      type(error_type), allocatable, intent(inout) :: error
      type(poinsot_plan), intent(in) :: plan, by_class
      type(bodies), intent(inout), target :: a, b
      real(dp), intent(in) :: bound
      character(*), intent(in) :: what
      type(body_view) :: va, vb
      type(poinsot_error) :: problem
      type(column) :: torque(3)
      real(dp), target :: kinetic(a%n, 2), potential(a%n, 2), space(3, a%n, 2), g(3, a%n)
      integer :: status, j, i
      call open(a, .false., va)
      call open(b, .true., vb)
      call body_energies(plan, va, 0.2_dp, kinetic(:, 1), potential(:, 1), status, problem)
      call body_energies(by_class, vb, 0.2_dp, kinetic(:, 2), potential(:, 2), status, problem)
      call accepted(error, problem)
      call within(error, maxval(abs(kinetic(:, 1) - kinetic(:, 2))), 20*bound, what//": kinetic")
      call within(error, maxval(abs(potential(:, 1) - potential(:, 2))), 20*bound, &
         what//": potential")
      call body_momenta(plan, va, space(:, :, 1), status, problem)
      call body_momenta(by_class, vb, space(:, :, 2), status, problem)
      call within(error, maxval(abs(space(:, :, 1) - space(:, :, 2))), 20*bound, what//": in space")
      call expect(error, total_degrees_of_freedom(plan, va), &
         total_degrees_of_freedom(by_class, vb), what//": degrees of freedom")
      call drift_bodies(plan, va, 7*h, status, problem)
      call drift_bodies(by_class, vb, 7*h, status, problem)
      g = reshape([(0.1_dp*mod(i, 7), i=1, 3*a%n)], [3, a%n])
      do j = 1, 3
         torque(j)%of => g(j, :)
      end do
      call kick_bodies(plan, va, h, torque, status, problem)
      call kick_bodies(by_class, vb, h, torque, status, problem)
      call accepted(error, problem)
      call near(error, a, b, 10*bound, what//": drift and kick")
   end subroutine compare_rest

   !> A body s times as heavy, with s times the momentum, turns as it did: for s that is a power of
   !> two to the bit, whatever it is.
   subroutine test_scale_units(error)
      type(error_type), allocatable, intent(out) :: error
      type(bodies), target :: one, far
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer, parameter :: powers(8) = [-498, -300, -40, -3, 5, 60, 333, 498]
      integer :: k, m, status, compensated
      do m = 1, method_count()
         do compensated = 0, 1
            do k = 1, size(powers)
               call make_plan("", "strang", method_name(m), "body-momentum", plan)
               call make_bodies(40, one)
               if (compensated == 1) allocate (one%carry(7, one%n), source=0.0_dp)
               one%scale = 1
               far = one
               far%scale(::2) = 2.0_dp**powers(k)
               far%y(:, ::2) = scale(far%y(:, ::2), powers(k))
               call open(one, .false., view)
               call drift_bodies(plan, view, h, status, problem)
               call open(far, .false., view)
               call drift_bodies(plan, view, h, status, problem)
               call expect(error, status, poinsot_ok, method_name(m)//": far scales")
               far%y(:, ::2) = scale(far%y(:, ::2), -powers(k))
               call expect(error, same_bits(far%y, one%y) .and. same_bits(far%q, one%q), &
                  method_name(m)//": scales in any unit")
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine test_scale_units

   !> A scale that no body has, and the status that says so; the others go on.
   subroutine test_scale_faults(error)
      type(error_type), allocatable, intent(out) :: error
      type(bodies), target :: start, good, bad
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer :: status, i
      integer, parameter :: wrong(5) = [2, 9, 33, 34, 64]
      call make_bodies(70, start)
      call make_plan(trim(effects(4)), "strang", "exact", "body-momentum", plan)
      good = start
      call go(plan, good, "", .false., 0_i8, 2_i8, status)
      start%scale(wrong) = [0.0_dp, -1.0_dp, ieee_value(h, ieee_quiet_nan), &
         ieee_value(h, ieee_positive_inf), 1e-320_dp]
      bad = start
      call go(plan, bad, "", .false., 0_i8, 2_i8, status)
      call expect(error, status, poinsot_e_partial, "scales that no body has")
      call expect(error, all(bad%status(wrong) == [poinsot_e_domain, poinsot_e_domain, &
         poinsot_e_not_finite, poinsot_e_not_finite, poinsot_e_domain]), "their statuses")
      do i = 1, start%n
         if (any(wrong == i)) good%y(:, i) = start%y(:, i)
         if (any(wrong == i)) good%q(:, i) = start%q(:, i)
      end do
      call expect(error, same_bits(bad%y, good%y) .and. same_bits(bad%q, good%q), "neighbours")
      call open(bad, .false., view)
      allocate (bad%moments(3, bad%n), source=1.0_dp)
      view%moments(1)%of => bad%moments(1, :)
      view%moments(2)%of => bad%moments(1, :)
      view%moments(3)%of => bad%moments(1, :)
      call drift_bodies(plan, view, h, status, problem)
      call refused(error, problem, poinsot_e_method, "both given")
      nullify (view%scale)
      nullify (view%moments(2)%of)
      call drift_bodies(plan, view, h, status, problem)
      call refused(error, problem, poinsot_e_null, "NULL")
   end subroutine test_scale_faults

   ! Moments
   ! -----------------------------------------------------------------------------------------------

   !> Bodies with moments move as bodies of a class with them.
   subroutine test_moments(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: e, k
      do e = 1, 8
         if (e == 4) cycle
         call compare_moments(error, trim(effects(e)), "strang", "exact", "body-momentum", h)
         call compare_moments(error, trim(effects(e)), "srkn4", "jacobi", "body-momentum", h)
      end do
      do k = 1, size(momentum_names)
         call compare_moments(error, trim(effects(2)), "srkn6", "exact", trim(momentum_names(k)), h)
      end do
   end subroutine test_moments

   subroutine compare_moments(error, effect, splitting, method, momentum, step)
      type(error_type), allocatable, intent(inout) :: error
      character(*), intent(in) :: effect, splitting, method, momentum
      real(dp), intent(in) :: step
      type(bodies), target :: own, plain
      type(poinsot_plan) :: of_kinds, of_each
      integer :: compensated, status, i
      character(:), allocatable :: what
      what = effect//", "//splitting//", "//method//", "//momentum//", moments"
      associate (unused => step)
      end associate
      do compensated = 0, 1
         call make_bodies(70, own)
         call make_plan(effect, splitting, method, momentum, of_kinds)
         call make_plan(effect, splitting, method, momentum, of_each, own)
         if (compensated == 1) allocate (own%carry(7, own%n), source=0.0_dp)
         call express(momentum, own)
         plain = own
         allocate (own%moments(3, own%n))
         do i = 1, own%n
            own%moments(:, i) = own%scale(i)*kind_moments(:, own%class(i))
         end do
         call go(of_kinds, own, effect, .false., 3_i8, 3_i8, status)
         call expect(error, status, poinsot_ok, what)
         call go(of_each, plain, effect, .true., 3_i8, 3_i8, status)
         call near(error, own, plain, 1e-14_dp, what)
         call compare_rest(error, of_kinds, own, of_each, plain, 1e-14_dp, what)
         if (allocated(error)) return
      end do
   end subroutine compare_moments

   !> Moments of 1e-150 and 1e150, and a plan without a class.
   subroutine test_moments_units(error)
      type(error_type), allocatable, intent(out) :: error
      type(bodies), target :: one, far
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      integer, parameter :: powers(4) = [-498, -40, 60, 498]
      integer :: i, k, m, status
      do m = 1, 2
         plan = poinsot_plan()
         call set_option(plan, "method", method_name(m), problem)
         call make_ready(plan, problem)
         call accepted(error, problem)
         do k = 1, size(powers)
            call make_bodies(40, one)
            allocate (one%moments(3, one%n))
            one%moments = reshape([(kind_moments(:, one%class(i)), i=1, one%n)], [3, one%n])
            far = one
            far%moments(:, ::2) = scale(far%moments(:, ::2), powers(k))
            far%y(:, ::2) = scale(far%y(:, ::2), powers(k))
            call open(one, .false., view)
            nullify (view%body_class)
            call drift_bodies(plan, view, h, status, problem)
            call expect(error, status, poinsot_ok, "a plan without a class")
            call open(far, .false., view)
            nullify (view%body_class)
            call drift_bodies(plan, view, h, status, problem)
            call expect(error, status, poinsot_ok, "moments of any unit")
            far%y(:, ::2) = scale(far%y(:, ::2), -powers(k))
            call expect(error, same_bits(far%y, one%y) .and. same_bits(far%q, one%q), &
               "moments in any unit")
            if (allocated(error)) return
         end do
      end do
      ! without moments of their own they are bodies of no class
      call open(one, .false., view)
      nullify (view%body_class, view%moments(1)%of, view%moments(2)%of, view%moments(3)%of)
      call drift_bodies(plan, view, h, status, problem)
      call expect(error, status == poinsot_e_partial .and. all(one%status == poinsot_e_domain), &
         "bodies of no class")
      call expect(error, total_degrees_of_freedom(plan, view), 0, "nor degrees of freedom")
   end subroutine test_moments_units

   !> What works by class says so.
   subroutine test_moments_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(bodies), target :: it
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), allocatable :: energy(:)
      integer :: e, status
      call make_bodies(10, it)
      allocate (it%moments(3, it%n), source=1.0_dp)
      allocate (energy(it%n))
      call open(it, .false., view)
      do e = 1, size(effects)
         call make_plan(trim(effects(e)), "strang", "exact", "body-momentum", plan)
         call step_bodies(plan, view, 0.0_dp, h, 0_i8, 0_i8, status, problem)
         if (e == 4 .or. e > 8) then
            call refused(error, problem, poinsot_e_method, "needs the moments of a body class")
         else
            call accepted(error, problem)
         end if
         call drift_bodies(plan, view, 0.0_dp, status, problem)
         call expect(error, raised(problem) .eqv. index(effects(e), "gyrostat") == 1, &
            "a drift with "//effects(e))
         problem = poinsot_error()
         call body_energies(plan, view, h, energy, energy, status, problem)
         call expect(error, raised(problem) .eqv. &
            (index(effects(e), "gyrostat") == 1 .or. e == 4), "energies with "//effects(e))
         problem = poinsot_error()
      end do
      call make_plan("", "taylor", "exact", "body-momentum", plan)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 1_i8, status, problem)
      call refused(error, problem, poinsot_e_method, "'taylor' does not support moments")
      call make_plan("", "takahashi-imada", "exact", "body-momentum", plan)
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, 1_i8, status, problem)
      call refused(error, problem, poinsot_e_method, "'takahashi-imada' does not support moments")
      call make_plan("", "strang", "dmv6", "body-momentum", plan)
      call drift_bodies(plan, view, h, status, problem)
      call refused(error, problem, poinsot_e_method, "'dmv6' does not support moments")
   end subroutine test_moments_refused

   !> Moments that no body has; momentum about an axis without inertia.
   subroutine test_moments_faults(error)
      type(error_type), allocatable, intent(out) :: error
      type(bodies), target :: start, good, bad
      type(poinsot_plan) :: plan
      integer :: status, i
      integer, parameter :: wrong(5) = [2, 9, 33, 34, 64]
      call make_bodies(70, start)
      call make_plan(trim(effects(2)), "strang", "exact", "body-momentum", plan)
      allocate (start%moments(3, start%n), source=0.0_dp)
      start%moments = reshape([(kind_moments(:, start%class(i)), i=1, start%n)], [3, start%n])
      good = start
      call go(plan, good, "", .false., 0_i8, 2_i8, status)
      start%moments(:, 2) = -1
      start%moments(2, 9) = ieee_value(h, ieee_quiet_nan)
      start%moments(:, 33) = [1.0_dp, 2.0_dp, 4.0_dp]
      start%moments(:, 34) = 0
      start%moments(:, 64) = [1.0_dp, 0.0_dp, 1.0_dp]
      start%y(2, 64) = 1
      bad = start
      call go(plan, bad, "", .false., 0_i8, 2_i8, status)
      call expect(error, status, poinsot_e_partial, "moments that no body has")
      call expect(error, all(bad%status(wrong) == [poinsot_e_domain, poinsot_e_not_finite, &
         poinsot_e_domain, poinsot_e_domain, poinsot_e_axis_momentum]), "their statuses")
      do i = 1, start%n
         if (any(wrong == i)) good%y(:, i) = start%y(:, i)
         if (any(wrong == i)) good%q(:, i) = start%q(:, i)
      end do
      call expect(error, same_bits(bad%y, good%y) .and. same_bits(bad%q, good%q), "neighbours")
   end subroutine test_moments_faults

   ! Bits
   ! -----------------------------------------------------------------------------------------------

   !> Whatever the place, the number of bodies, and the calls that steps are spread over.
   subroutine test_bits(error)
      type(error_type), allocatable, intent(out) :: error
      type(bodies), target :: start, all_at_once, some, part
      type(poinsot_plan) :: plan
      integer, allocatable :: which(:)
      integer :: e, i, n, k, status
      do e = 1, 11
         if (any(e == [7, 10])) cycle    ! pairs; noise goes by place
         do k = 0, 1
            if (k == 1 .and. (e == 4 .or. e > 8)) cycle
            call make_bodies(70, start)
            start%y(:, 5) = 300*start%y(:, 5)
            allocate (start%carry(7, start%n), source=0.0_dp)
            if (k == 1) then
               allocate (start%moments(3, start%n))
               start%moments = reshape([(start%scale(i)*kind_moments(:, start%class(i)), i=1, &
                  start%n)], [3, start%n])
            end if
            call make_plan(trim(effects(e)), "srkn4", "exact", "body-momentum", plan)
            all_at_once = start
            call go(plan, all_at_once, trim(effects(e)), .false., 0_i8, 3_i8, status)
            do n = 1, 70, merge(1, 23, e < 3)
               which = [(1 + mod(37*i + n, 70), i=1, n)]
               some = chosen(start, which)
               call go(plan, some, trim(effects(e)), .false., 0_i8, 1_i8, status)
               call go(plan, some, trim(effects(e)), .false., 1_i8, 2_i8, status)
               part = chosen(all_at_once, which)
               call expect(error, same_bits(some%y, part%y) .and. same_bits(some%q, part%q) .and. &
                  same_bits(some%carry, part%carry), "bits of "//trim(effects(e)))
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine test_bits

   function chosen(from, which) result(some)
      type(bodies), intent(in) :: from
      integer, intent(in) :: which(:)
      type(bodies) :: some
      some%n = size(which)
      some%y = from%y(:, which)
      some%q = from%q(:, which)
      some%class = from%class(which)
      some%scale = from%scale(which)
      some%status = from%status(which)
      some%carry = from%carry(:, which)
      if (allocated(from%moments)) some%moments = from%moments(:, which)
   end function chosen

end module test_ensemble_own
