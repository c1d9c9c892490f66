!> Every method with every effect: the bits of a body depend neither on threads, nor on the place
!> among others and their number, nor on the calls that the steps are spread over, nor on a restart.
module test_ensemble_every
   use testdrive, only: unittest_type, new_unittest, error_type
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain
   use poinsot_effect_registry, only: effect_count, effect_names
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_coupled, only: torque_callback
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, set_option
   use poinsot_ensemble_step, only: step_bodies
   use poinsot_free_method, only: method_count, method_name
   use poinsot_splitting_registry, only: splitting_count, splitting_name
   use test_crowd, only: crowd, make_crowd, mixed_plan, with_effect, class_count, same_bits
   use test_expectation, only: expect
   implicit none(type, external)
   private
   public :: collect_every

   !> Bodies, with what else of theirs a plan reads or writes.
   type :: members
      type(crowd) :: of
      real(dp), allocatable :: carry(:, :)
      integer(i8), allocatable :: id(:)
   end type members

   type, extends(torque_callback) :: twist
   contains
      procedure :: evaluate => evaluate_twist
   end type twist

   !> An effect and its settings; those that can change with time do.
   type :: one_effect
      character(18) :: name
      character(96) :: settings
   end type one_effect

   type(one_effect), parameter :: effects(13) = [ &
      one_effect("gravity", "centre = 0.1, 0.2, 1; weight = 1.3"), &
      one_effect("field", "dipole = 1, 0.2, 0.3; strength = 0.2, 0, 1; motion = rotating; " &
      // "frequency = 3"), &
      one_effect("field", "dipole = 1, 0.2, 0.3; strength = 0.2, 0, 1; motion = oscillating; " &
      // "frequency = 3"), &
      one_effect("gravity_gradient", "rate = 0.7"), &
      one_effect("spring", "stiffness = 1.5; axis = 1, 2, 3; direction = 1, 0, 1"), &
      one_effect("torque", "value = 0.1, 0.2, -0.3; frame = space; frequency = 2"), &
      one_effect("torque", "times = 0, 0.1, 0.5; table = 0, 0, 0.1, 0.3, 0, 0.2, 0, 0.1, 0"), &
      one_effect("drag", "friction = 0.1, 0.2, 0.3"), &
      one_effect("langevin", "friction = 0.5; temperature = 0.4"), &
      one_effect("gyrostat", "rotor = 0.1, 0.3, 0.2; class = 2"), &
      one_effect("dipoles", "dipole = 0.3, 0.1, 1; coupling = 0.01; spacing = 2"), &
      one_effect("potential", "u = k*sin(t)*Q31 + exp(Q12*Q33) - Q11^3; constants = k = 0.4"), &
      one_effect("potential", "u = sqrt(2 + Q33)/(3 - Q12) + atan2(Q11, 2 + Q22)")]

   type(one_effect), parameter :: drag = one_effect("drag", "friction = 0.1")

   real(dp), parameter :: h = 0.04_dp, begin = 0.3_dp
   integer(i8), parameter :: first = 5, steps = 3

contains

   subroutine collect_every(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("every-effect-is-here", test_names), &
         new_unittest("every-method-and-effect-bits", test_effects), &
         new_unittest("every-method-and-callback-bits", test_callbacks), &
         new_unittest("every-splitting-bits", test_splittings), &
         new_unittest("no-rotor-on-a-linear-body", test_linear_rotor), &
         new_unittest("padding-fails-nobody", test_padding)]
   end subroutine collect_every

   !> A new effect needs a row here.
   subroutine test_names(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: k
      do k = 1, effect_count
         if (effect_names(k) == "callback") cycle
         call expect(error, any(effects%name == effect_names(k)), "no test for "//effect_names(k))
      end do
   end subroutine test_names

   subroutine test_effects(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: e, m
      do e = 1, size(effects)
         do m = 1, method_count()
            call one_way(error, method_name(m), "strang", effects(e))
            if (allocated(error)) return
         end do
      end do
   end subroutine test_effects

   subroutine test_callbacks(error)
      type(error_type), allocatable, intent(out) :: error
      type(twist) :: host
      integer :: m
      do m = 1, method_count()
         call one_way(error, method_name(m), "srkn4", drag, host)
         if (allocated(error)) return
      end do
   end subroutine test_callbacks

   subroutine test_splittings(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: k
      do k = 1, splitting_count()
         call one_way(error, "exact", splitting_name(k), effects(2))
         if (allocated(error)) return
         call one_way(error, "dmv6", splitting_name(k), effects(5))
         if (allocated(error)) return
      end do
   end subroutine test_splittings

   !> A rotor would give a linear body momentum about its axis, where it has no moment.
   subroutine test_linear_rotor(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: problem
      call mixed_plan(plan)
      call with_effect(plan, "gyrostat", "rotor = 0.1, 0.3, 0")
      call make_ready(plan, problem)
      call expect(error, problem%code == poinsot_e_domain .and. .not. plan%ready, &
         "a linear body with a rotor")
      problem = poinsot_error()
      call mixed_plan(plan)
      call with_effect(plan, "gyrostat", "rotor = 0, 0, 0")
      call make_ready(plan, problem)
      call expect(error, .not. raised(problem), "a rotor at rest is none")
   end subroutine test_linear_rotor

   !> A block's lanes without a body draw noise too, which may take them beyond a method's longest
   !> step: no matter of the call's.
   subroutine test_padding(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: problem
      real(dp), target :: y(3, 1), q(4, 1)
      integer(i8), target :: id(1)
      integer, target :: each(1)
      integer :: k, number, status, failures
      call add_class(plan, [0.6_dp, 0.8_dp, 1.0_dp], number, problem)
      call with_effect(plan, "langevin", "friction = 5; temperature = 1")
      call set_option(plan, "method", "dmv8", problem)
      call make_ready(plan, problem)
      failures = 0
      do k = 1, 100
         y = 0.1_dp
         q = 0.5_dp
         id = k
         call view_rows(y, q, view)
         view%id => id
         view%status => each
         call step_bodies(plan, view, 0.0_dp, 0.8_dp, int(k, i8), 1_i8, status, problem)
         call expect(error, (status == poinsot_ok) .eqv. (each(1) == poinsot_ok), &
            "the call fails, and no body does")
         if (status /= poinsot_ok) failures = failures + 1
      end do
      call expect(error, failures > 5 .and. failures < 95, "noise about the longest step")
   end subroutine test_padding

   !> All comparisons for one plan. Bodies that act on each other stay in their order, and together.
   !> A processor works at both ends of each call, so there calls must be the same ones.
   subroutine one_way(error, method, splitting, effect, host)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: method, splitting
      type(one_effect), intent(in) :: effect
      type(twist), intent(inout), optional :: host
      type(members) :: start, one, other
      character(:), allocatable :: what
      integer :: k
      logical :: coupled
      what = method//", "//splitting//", "//trim(effect%name)//": bits depend on "
      coupled = effect%name == "dipoles"
      call make_members(merge(300, 600, coupled), start)
      one = start
      call go(one, [steps], 1)
      call expect(error, .not. same_bits(one%of%y, start%of%y) .and. maxval(abs(one%carry)) > 0, &
         what//"nothing")
      other = start
      call go(other, [steps], 3)
      call compare(other, one, "threads")
      if (allocated(error)) return
      other = start
      if (splitting /= "takahashi-imada") then
         call go(other, [1_i8, steps - 1], 1)
         call compare(other, one, "a restart")
      end if
      if (allocated(error) .or. coupled) return
      other = some(start, [(k, k=start%of%n, 1, -1)])
      call go(other, [steps], 1)
      call compare(other, some(one, [(k, k=start%of%n, 1, -1)]), "the place")
      if (allocated(error)) return
      other = some(start, [(k, k=3, start%of%n, 37)])
      call go(other, [steps], 1)
      call compare(other, some(one, [(k, k=3, start%of%n, 37)]), "how many there are")
      if (allocated(error)) return
      other = some(start, [77])
      call go(other, [steps], 1)
      call compare(other, some(one, [77]), "the others")

   contains

      !> Steps in several parts, each by a plan of its own.
      subroutine go(it, parts, threads)
         type(members), intent(inout), target :: it
         integer(i8), intent(in) :: parts(:)
         integer, intent(in) :: threads
         type(poinsot_plan) :: plan
         type(body_view) :: view
         type(poinsot_error) :: problem
         integer :: part, status
         do part = 1, size(parts)
            call mixed_plan(plan)
            call with_effect(plan, trim(effect%name), trim(effect%settings))
            call set_option(plan, "method", method, problem)
            call set_option(plan, "splitting", splitting, problem)
            call set_option(plan, "seed", "987654321", problem)
            call set_option(plan, "threads", achar(iachar("0") + threads), problem)
            call make_ready(plan, problem)
            call view_rows(it%of%y, it%of%q, view)
            view%body_class => it%of%class
            view%carry => it%carry
            view%id => it%id
            call step_bodies(plan, view, begin, h, first + sum(parts(:part - 1)), parts(part), &
               status, problem, host)
            if (.not. allocated(error)) call expect(error, .not. raised(problem) .and. &
               status == poinsot_ok, what//"nothing: it fails, "//problem%message)
         end do
      end subroutine go

      subroutine compare(a, b, cause)
         type(members), intent(in) :: a, b
         character(*), intent(in) :: cause
         if (.not. allocated(error)) call expect(error, same_bits(a%of%y, b%of%y) .and. &
            same_bits(a%of%q, b%of%q) .and. same_bits(a%carry, b%carry), what//cause)
      end subroutine compare

   end subroutine one_way

   subroutine make_members(n, it)
      integer, intent(in) :: n
      type(members), intent(out) :: it
      integer :: i
      call make_crowd(n, it%of)
      where (it%of%class == class_count) it%of%class = 1 ! a tensor's frame is turned at each call,
                                                         ! which rounds
      allocate (it%carry(7, n), source=0.0_dp)
      it%id = [(int(i, i8)*1000003_i8, i=1, n)]
   end subroutine make_members

   pure function some(it, places) result(taken)
      type(members), intent(in) :: it
      integer, intent(in) :: places(:)
      type(members) :: taken
      taken%of%n = size(places)
      taken%of%y = it%of%y(:, places)
      taken%of%q = it%of%q(:, places)
      taken%of%class = it%of%class(places)
      taken%carry = it%carry(:, places)
      taken%id = it%id(places)
   end function some

   subroutine evaluate_twist(self, t, q, torque, energy, stop)
      class(twist), intent(inout) :: self
      real(dp), intent(in) :: t
      real(dp), intent(in), target :: q(:, :)
      real(dp), intent(inout), target :: torque(:, :)
      real(dp), intent(inout) :: energy
      logical, intent(inout) :: stop
      torque(:, 1) = q(:, 1)*q(:, 2) + t
      torque(:, 2) = q(:, 3)
      torque(:, 3) = -q(:, 2)*q(:, 4)
      energy = 0
      stop = .false.
      associate (unused => self)
      end associate
   end subroutine evaluate_twist

end module test_ensemble_every
