!> Room splitting: the tables themselves, the stepper, and what is not there costs nothing. Measured
!> orders stand in test_splitting_motion.
!> costs nothing.
module test_splitting
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_status, only: poinsot_ok
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_body_class, only: body_class, make_class
   use poinsot_free_method, only: free_method, find_method, advance
   use poinsot_effect_effect, only: effect_item
   use poinsot_effect_callback, only: user_torque
   use poinsot_effect_settings, only: number_setting
   use poinsot_effect_registry, only: make_effect
   use poinsot_splitting_tableaux, only: splitting, operation
   use poinsot_splitting_registry, only: is_table, find_splitting, splitting_count, &
      splitting_name, achieved_order
   use poinsot_splitting_stepper, only: flows, run_steps
   use test_expectation, only: expect
   use test_splitting_motion, only: collect_motion
   use test_turning, only: bench, set_up, place, run, no_effects, generic_moments_of, &
      generic_y, generic_q
   implicit none(type, external)
   private
   public :: collect_splitting

   !> A system that writes down what a stepper asks of it.
   type, extends(flows) :: recorder
      integer :: evaluations = 0, kicks = 0, drifts = 0
      integer :: from_ahead = 0, from_behind = 0  !! kicks at the beginning and at the end of steps
      real(dp) :: moved = 0, pushed = 0, last_time = -1, evaluated_at = -1, now = 0
      logical :: stale = .false.   !! was a stored torque used at another time?
   contains
      procedure :: drift => record_drift
      procedure :: kick => record_kick
   end type recorder

   !> A torque without a force gradient.
   type, extends(user_torque) :: plain_torque
   contains
      procedure :: evaluate => plain_evaluate
   end type plain_torque

contains

   subroutine collect_splitting(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      type(unittest_type), allocatable :: motion(:)
      testsuite = [ &
         new_unittest("sums-are-one", test_sums), &
         new_unittest("tables-are-symmetric", test_symmetry), &
         new_unittest("tables-are-the-published-ones", test_published_tables), &
         new_unittest("order-in-a-weak-torque", test_weak), &
         new_unittest("nodes", test_nodes), &
         new_unittest("rows-are-complete", test_rows), &
         new_unittest("names", test_names), &
         new_unittest("achieved-order", test_achieved_order), &
         new_unittest("stepper-counts", test_stepper_counts), &
         new_unittest("stepper-halts", test_stepper_halts), &
         new_unittest("no-effect-no-kick", test_absent), &
         new_unittest("gradient-refused", test_gradient_refused)]
      call collect_motion(motion)
      testsuite = [testsuite, motion]
   end subroutine collect_splitting

   subroutine test_sums(error)
      type(error_type), allocatable, intent(out) :: error
      type(splitting) :: scheme
      integer :: i
      do i = 1, splitting_count()
         if (.not. is_table(i)) cycle
         scheme = row(i)
         associate (ops => scheme%operations)
            call expect(error, abs(sum(ops%b, mask=ops%is_kick) - 1) < 1e-15_dp, &
               "kicks do not add to 1: "//scheme%name)
            call expect(error, abs(sum(ops%b, mask=.not. ops%is_kick) - 1) < 1e-15_dp, &
               "rotations do not add to 1: "//scheme%name)
         end associate
         associate (ops => scheme%leave)
            call expect(error, abs(sum(ops%b, mask=ops%is_kick)) < 1e-15_dp .and. &
               abs(sum(ops%b, mask=.not. ops%is_kick)) < 1e-15_dp, "processor moves: "//scheme%name)
         end associate
      end do
   end subroutine test_sums

   subroutine test_symmetry(error)
      type(error_type), allocatable, intent(out) :: error
      type(splitting) :: scheme
      integer :: i, k, n
      do i = 1, splitting_count()
         if (.not. is_table(i)) cycle
         scheme = row(i)
         n = size(scheme%operations)
         associate (ops => scheme%operations, back => scheme%operations(n:1:-1))
            call expect(error, scheme%symmetric .and. &
                       (mod(n, 2) == 1 .or. scheme%middle == n/2) &
                       .and. all(ops%b == back%b) .and. all(ops%c == back%c) .and. &
                       all(ops%is_kick .eqv. back%is_kick), "not symmetric: "//scheme%name)
            call expect(error, all((ops(2:)%is_kick .neqv. ops(:n - 1)%is_kick) .or. &
               [(k == scheme%middle, k=1, n - 1)]), &
               "rotations and kicks do not alternate: "//scheme%name)
         end associate
      end do
   end subroutine test_symmetry

   !> Every row against data/splittings.txt, coefficient by coefficient.
   subroutine test_published_tables(error)
      type(error_type), allocatable, intent(out) :: error
      character(20), parameter :: theirs(13) = [character(20) :: "Strang_BAB", "ForestRuth", &
         "Suzuki_S5", &
         "Yoshida6A", "McL95_S5(nonRKN)", "BM02_SRKN6b", "BM02_SRKN14a", "Chin4A", "OMF_3F2G_V", &
         "OMF6_5F3G_P", "OMF8_11F11G_P", "SABA(8,6,4)", "SABA(10,6,4)"]
      character(20), parameter :: ours(13) = [character(20) :: "strang", "forest-ruth", &
         "suzuki4", "yoshida6", &
         "mclachlan4", "srkn4", "srkn6", "chin4", "omelyan4", "omelyan6", "omelyan8", "saba864", &
         "saba1064"]
      type(splitting) :: scheme
      type(poinsot_error) :: refusal
      type(operation), allocatable :: table(:)
      integer :: i, order
      do i = 1, size(ours)
         call find_splitting(trim(ours(i)), scheme, refusal)
         call expect(error, .not. raised(refusal), "missing: "//ours(i))
         call read_table(trim(theirs(i)), table, order)
         call expect(error, size(table), size(scheme%operations), "length of "//ours(i))
         if (allocated(error)) return
         ! the file has 14 digits of Yoshida's, the row 20
         call expect(error, all(table%is_kick .eqv. scheme%operations%is_kick) .and. &
            maxval(abs(table%b - scheme%operations%b)) < merge(2e-14_dp, 1e-16_dp, ours(i) &
            == "yoshida6") .and. &
            maxval(abs(table%c - scheme%operations%c)) < 1e-18_dp, "coefficients of "//ours(i))
         call expect(error, scheme%order, order, "order of "//ours(i))
      end do
   end subroutine test_published_tables

   !> The error of first order in the torque is that of a quadrature: kicks are weights, nodes
   !> are points. saba864 is exact for polynomials of degree below 8, saba1064 below 10.
   subroutine test_weak(error)
      type(error_type), allocatable, intent(out) :: error
      character(8), parameter :: names(2) = [character(8) :: "saba864", "saba1064"]
      integer, parameter :: degrees(2) = [8, 10]
      type(splitting) :: scheme
      type(poinsot_error) :: refusal
      real(dp) :: rest
      integer :: i, k
      do i = 1, size(names)
         call find_splitting(names(i), scheme, refusal)
         do k = 1, degrees(i)
            rest = sum(scheme%operations%b*(scheme%operations%node - 0.5_dp)**k, &
                       mask=scheme%operations%is_kick)
            if (mod(k, 2) == 0) rest = rest - 0.5_dp**k/(k + 1)
            call expect(error, abs(rest) < 1e-16_dp .eqv. k < degrees(i), &
               "moments of the kicks: "//names(i))
         end do
      end do
   end subroutine test_weak

   subroutine test_nodes(error)
      type(error_type), allocatable, intent(out) :: error
      type(splitting) :: scheme
      integer :: i, k, n
      do i = 1, splitting_count()
         if (.not. is_table(i)) cycle
         scheme = row(i)
         n = size(scheme%operations)
         associate (ops => scheme%operations)
            do k = 1, n
               call expect(error, abs(ops(k)%node - sum(ops(:k - 1)%b, &
                          mask=.not. ops(:k - 1)%is_kick)) < 1e-15_dp, "node of "//scheme%name)
            end do
            if (ops(n)%is_kick) call expect(error, ops(1)%node == 0 .and. ops(n)%node == 1, &
               "the last kick is not at the end exactly: "//scheme%name)
         end associate
      end do
   end subroutine test_nodes

   subroutine test_rows(error)
      type(error_type), allocatable, intent(out) :: error
      type(splitting) :: scheme
      integer :: i
      do i = 1, splitting_count()
         if (.not. is_table(i)) cycle
         scheme = row(i)
         call expect(error, scheme%author /= "" .and. scheme%paper /= "" .and. &
            scheme%year > 1900 .and. &
            scheme%order >= 2 .and. scheme%stages >= 1, "incomplete: "//scheme%name)
         call expect(error, scheme%needs_gradient .eqv. any(scheme%operations%c /= 0), &
            "needs_gradient: "//scheme%name)
      end do
   end subroutine test_rows

   subroutine test_names(error)
      type(error_type), allocatable, intent(out) :: error
      type(splitting) :: scheme
      type(poinsot_error) :: refusal
      integer :: i
      do i = 1, splitting_count()
         call find_splitting(splitting_name(i), scheme, refusal)
         call expect(error, .not. raised(refusal) .and. scheme%name == splitting_name(i), &
            "not found by name")
      end do
      call expect(error, splitting_name(0)//splitting_name(splitting_count() + 1), "")
      call find_splitting("skrn6", scheme, refusal)
      call expect(error, raised(refusal), "unknown name taken")
      call expect(error, index(refusal%message, "'srkn6'") > 0, "nearest name: "//refusal%message)
   end subroutine test_names

   subroutine test_achieved_order(error)
      type(error_type), allocatable, intent(out) :: error
      call expect(error, achieved_order(6, 0, [integer ::]) == 6 .and. &
                 achieved_order(6, 4, [0]) == 4 .and. achieved_order(8, 10, [0, 2]) == 2 .and. &
                 achieved_order(0, 0, [0]) == 0, "achieved order")
   end subroutine test_achieved_order

   !> A scheme that ends with a kick evaluates its torque once less per step; times are right to the
   !> bit.
   subroutine test_stepper_counts(error)
      type(error_type), allocatable, intent(out) :: error
      type(recorder) :: log
      type(splitting) :: scheme
      integer :: i, kicks
      real(dp), parameter :: t = 0.3_dp, h = 0.1_dp
      do i = 1, splitting_count()
         if (.not. is_table(i)) cycle
         scheme = row(i)
         log = recorder(fresh=.false., has_dissipation=.false., halted=.false.)
         log%now = t + 7*h
         call run_steps(scheme, log, t, h, 7_i8, 5_i8)
         kicks = count(scheme%operations%is_kick)
         call expect(error, log%kicks == 5*kicks .and. &
                    log%drifts == 5*(size(scheme%operations) - kicks), "flows of "//scheme%name)
         if (allocated(error)) return
         if (scheme%operations(1)%is_kick) kicks = kicks - 1
         call expect(error, log%evaluations == 5*kicks + merge(1, 0, &
            scheme%operations(1)%is_kick), &
            "torques of "//scheme%name)
         call expect(error, .not. log%stale, "a stored torque served another time: "//scheme%name)
         call expect(error, abs(log%moved - 0.5_dp) < 1e-14_dp .and. abs(log%pushed - &
                    0.5_dp) < 1e-14_dp, "five steps are not five steps: "//scheme%name)
         associate (ops => scheme%operations)
            call expect(error, log%from_ahead == 5*count(ops%is_kick .and. ops%node <= 0) .and. &
               log%from_behind == 5*count(ops%is_kick .and. ops%node >= 1), &
               "kicks at the ends of steps: "//scheme%name)
         end associate
         if (scheme%operations(1)%is_kick) call expect(error, log%last_time, t + 12*h, &
            "end", thr=1e-15_dp)
      end do
   end subroutine test_stepper_counts

   subroutine test_stepper_halts(error)
      type(error_type), allocatable, intent(out) :: error
      type(recorder) :: log
      type(splitting) :: scheme
      scheme = row(1)
      log%fresh = .false.
      log%has_dissipation = .false.
      log%halted = .true.
      call run_steps(scheme, log, 0.0_dp, 0.1_dp, 0_i8, 5_i8)
      call expect(error, log%kicks == 1 .and. log%drifts == 0, "a halted system went on")
   end subroutine test_stepper_halts

   !> Without effects: one rotation, no kick, nothing allocated, and the bits of the bare rotor.
   subroutine test_absent(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(body_class) :: class
      type(free_method) :: method
      type(poinsot_error) :: refusal
      type(effect_item), allocatable :: other(:)
      real(dp) :: y(lanes, 3), q(lanes, 4)
      integer :: status(lanes), k
      allocate (other(1))
      call make_effect("gravity", [number_setting("centre", generic_y), &
                       number_setting("class", [2.0_dp])], other(1)%it, refusal)
      call set_up(it, generic_moments_of, "exact", "srkn6", other)
      call expect(error, it%good .and. size(it%scheme%operations) == 1, &
         "an effect of another class makes kicks")
      if (allocated(error)) return
      call set_up(it, generic_moments_of, "exact", "srkn6", no_effects())
      call expect(error, size(it%scheme%operations) == 1 .and. &
                 .not. any(it%scheme%operations%is_kick), "a kick without torque")
      if (allocated(error)) return
      call expect(error, size(it%acting%torques) == 0 .and. size(it%acting%dissipative) == 0 .and. &
         .not. (allocated(it%acting%weights) .or. it%class%has_rotor .or. &
         it%block%has_dissipation), "something acts")
      if (allocated(error)) return
      call place(it, generic_y, generic_q)
      y = it%block%y
      q = it%block%q
      status = poinsot_ok
      call run(it, 0.0_dp, 0.2_dp, 0, 50)
      call make_class(generic_moments_of, class, refusal)
      call find_method("exact", method, refusal)
      do k = 1, 50
         call advance(method, class, 0.2_dp, y, q, status)
      end do
      call expect(error, all(it%block%y == y) .and. all(it%block%q == q), &
         "not the bits of the bare rotor")
   end subroutine test_absent

   subroutine test_gradient_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      allocate (effects(1))
      allocate (plain_torque :: effects(1)%it)
      effects(1)%it%name = "mine"
      call set_up(it, generic_moments_of, "exact", "chin4", effects)
      call expect(error, .not. it%good, "a scheme with gradient took a torque without")
      call expect(error, index(it%message, "chin4") > 0 .and. &
                 index(it%message, "mine") > 0, it%message)
      call set_up(it, generic_moments_of, "exact", "srkn4", effects)
      call expect(error, it%good, it%message)
   end subroutine test_gradient_refused

   function row(i) result(scheme)
      integer, intent(in) :: i
      type(splitting) :: scheme
      type(poinsot_error) :: refusal
      call find_splitting(splitting_name(i), scheme, refusal)
   end function row

   !> One table of data/splittings.txt; size 0 if it is not there.
   subroutine read_table(name, table, order)
      character(*), intent(in) :: name
      type(operation), allocatable, intent(out) :: table(:)
      integer, intent(out) :: order
      character(200) :: line
      character(30) :: word
      type(operation) :: one
      integer :: unit, ios
      logical :: here
      allocate (table(0))
      order = 0
      here = .false.
      open (newunit=unit, file="test/data/splittings.txt", status="old", action="read", iostat=ios)
      if (ios /= 0) return
      do
         read (unit, '(a)', iostat=ios) line
         if (ios /= 0) exit
         if (line(1:7) == "scheme ") then
            word = line(8:7 + index(line(8:), " ")) ! names have commas
            here = word == name
            if (here) read (line(index(line, "order") + 5:), *) order
         else if (here .and. line(1:2) == "  " .and. line /= "") then
            one = operation(is_kick=line(3:3) == "K")
            read (line(4:), *, iostat=ios) one%b, one%c
            if (ios /= 0) then
               one%c = 0
               read (line(4:), *) one%b
            end if
            table = [table, one]
         end if
      end do
      close (unit)
   end subroutine read_table

   subroutine record_drift(self, t, h)
      class(recorder), intent(inout) :: self
      real(dp), intent(in) :: t, h
      self%now = t + h
      self%fresh = .false.
      self%drifts = self%drifts + 1
      self%moved = self%moved + h
   end subroutine record_drift

   subroutine record_kick(self, t, b, c, ahead)
      class(recorder), intent(inout) :: self
      real(dp), intent(in) :: t, b, c, ahead
      if (abs(t - self%now) > 1e-13_dp) self%stale = .true. ! the drifts have come to another time
      if (ahead > 0) self%from_ahead = self%from_ahead + 1
      if (ahead < 0) self%from_behind = self%from_behind + 1
      if (.not. self%fresh) then
         self%evaluations = self%evaluations + 1
         self%evaluated_at = t
      end if
      if (self%evaluated_at /= t) self%stale = .true.
      self%fresh = .true.
      self%kicks = self%kicks + 1
      self%pushed = self%pushed + b + 0*c
      self%last_time = t
   end subroutine record_kick

   subroutine plain_evaluate(self, t, q, torque, energy)
      class(plain_torque), intent(in) :: self
      real(dp), intent(in) :: t, q(4)
      real(dp), intent(out) :: torque(3), energy
      torque = q(2:4) + 0*t
      energy = self%class_index*0
   end subroutine plain_evaluate

end module test_splitting
