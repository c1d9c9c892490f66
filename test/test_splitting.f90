!> Room splitting: the tables themselves, measured orders, the rules on bits, and what is not there
!> costs nothing.
module test_splitting
   use testdrive, only: new_unittest, unittest_type, error_type, check, test_failed
   use poinsot_core_kinds, only: dp, qp, i8, lanes
   use poinsot_core_status, only: poinsot_ok
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_body_class, only: body_class, make_class
   use poinsot_free_method, only: free_method, find_method, advance
   use poinsot_effect_effect, only: effect_item
   use poinsot_effect_callback, only: user_torque
   use poinsot_effect_settings, only: setting, number_setting, text_setting
   use poinsot_effect_registry, only: make_effect
   use poinsot_splitting_tableaux, only: splitting, operation, turn_composition
   use poinsot_splitting_registry, only: find_splitting, splitting_count, splitting_name, &
      achieved_order
   use poinsot_splitting_stepper, only: flows, run_steps, enter_kernel, leave_kernel
   use test_measure, only: measure_slope, attitude_distance, momentum_distance
   use test_oracle_data, only: top_case, read_top, published_3
   use test_oracle_taylor, only: taylor_problem, taylor_report, taylor_flow
   use test_turning, only: bench, set_up, place, run, run_processed, judge, no_effects, &
      generic_effects, generic_problem, generic_moments_of, generic_y, generic_q
   implicit none(type, external)
   private
   public :: collect_splitting

   !> A system that writes down what a stepper asks of it.
   type, extends(flows) :: recorder
      integer :: evaluations = 0, kicks = 0, drifts = 0
      real(dp) :: moved = 0, pushed = 0, last_time = -1, evaluated_at = -1
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
      testsuite = [ &
         new_unittest("sums-are-one", test_sums), &
         new_unittest("tables-are-symmetric", test_symmetry), &
         new_unittest("tables-are-the-published-ones", test_published_tables), &
         new_unittest("nodes", test_nodes), &
         new_unittest("rows-are-complete", test_rows), &
         new_unittest("names", test_names), &
         new_unittest("achieved-order", test_achieved_order), &
         new_unittest("stepper-counts", test_stepper_counts), &
         new_unittest("stepper-halts", test_stepper_halts), &
         new_unittest("measured-orders", test_orders), &
         new_unittest("order-with-time", test_order_with_time), &
         new_unittest("low-order-rotors-cap-the-order", test_caps), &
         new_unittest("processor-makes-the-order", test_processor), &
         new_unittest("processor-is-inverted-exactly", test_processor_inverse), &
         new_unittest("gyrostat-orders", test_gyrostat_orders), &
         new_unittest("drag-caps-at-two", test_drag_order), &
         new_unittest("top-data", test_top_data), &
         new_unittest("top-published", test_top_published), &
         new_unittest("ten-steps-are-ten-calls", test_ten_calls), &
         new_unittest("place-in-block", test_place), &
         new_unittest("there-and-back", test_reversal), &
         new_unittest("no-effect-no-kick", test_absent), &
         new_unittest("frozen-lanes-stand-still", test_frozen), &
         new_unittest("gradient-refused", test_gradient_refused)]
   end subroutine collect_splitting

   subroutine test_sums(error)
      type(error_type), allocatable, intent(out) :: error
      type(splitting) :: scheme
      integer :: i
      do i = 1, splitting_count()
         scheme = row(i)
         associate (ops => scheme%operations)
            call check(error, abs(sum(ops%b, mask=ops%is_kick) - 1) < 1e-15_dp, &
               "kicks do not add to 1: "//scheme%name)
            if (allocated(error)) return
            call check(error, abs(sum(ops%b, mask=.not. ops%is_kick) - 1) < 1e-15_dp, &
               "rotations do not add to 1: "//scheme%name)
            if (allocated(error)) return
         end associate
         associate (ops => scheme%leave)
            call check(error, abs(sum(ops%b, mask=ops%is_kick)) < 1e-15_dp .and. &
               abs(sum(ops%b, mask=.not. ops%is_kick)) < 1e-15_dp, "processor moves: "//scheme%name)
            if (allocated(error)) return
         end associate
      end do
   end subroutine test_sums

   subroutine test_symmetry(error)
      type(error_type), allocatable, intent(out) :: error
      type(splitting) :: scheme
      integer :: i, n
      do i = 1, splitting_count()
         scheme = row(i)
         n = size(scheme%operations)
         associate (ops => scheme%operations, back => scheme%operations(n:1:-1))
            call check(error, scheme%symmetric .and. mod(n, 2) == 1 .and. all(ops%b == back%b) &
               .and. &
               all(ops%c == back%c) .and. all(ops%is_kick .eqv. back%is_kick), &
               "not symmetric: "//scheme%name)
            if (allocated(error)) return
            call check(error, all(ops(2:)%is_kick .neqv. ops(:n - 1)%is_kick), &
               "rotations and kicks do not alternate: "//scheme%name)
            if (allocated(error)) return
         end associate
      end do
   end subroutine test_symmetry

   !> Every row against data/splittings.txt, coefficient by coefficient.
   subroutine test_published_tables(error)
      type(error_type), allocatable, intent(out) :: error
      character(20), parameter :: theirs(11) = [character(20) :: "Strang_BAB", "ForestRuth", &
         "Suzuki_S5", &
         "Yoshida6A", "McL95_S5(nonRKN)", "BM02_SRKN6b", "BM02_SRKN14a", "Chin4A", "OMF_3F2G_V", &
         "OMF6_5F3G_P", "OMF8_11F11G_P"]
      character(20), parameter :: ours(11) = [character(20) :: "strang", "forest-ruth", &
         "suzuki4", "yoshida6", &
         "mclachlan4", "srkn4", "srkn6", "chin4", "omelyan4", "omelyan6", "omelyan8"]
      type(splitting) :: scheme
      type(poinsot_error) :: refusal
      type(operation), allocatable :: table(:)
      integer :: i, order
      do i = 1, size(ours)
         call find_splitting(trim(ours(i)), scheme, refusal)
         call check(error,.not. raised(refusal), "missing: "//ours(i))
         if (allocated(error)) return
         call read_table(trim(theirs(i)), table, order)
         call check(error, size(table), size(scheme%operations), "length of "//ours(i))
         if (allocated(error)) return
         ! the file has 14 digits of Yoshida's, the row 20
         call check(error, all(table%is_kick .eqv. scheme%operations%is_kick) .and. &
            maxval(abs(table%b - scheme%operations%b)) < merge(2e-14_dp, 1e-16_dp, ours(i) &
            == "yoshida6") .and. &
            maxval(abs(table%c - scheme%operations%c)) < 1e-18_dp, "coefficients of "//ours(i))
         if (allocated(error)) return
         call check(error, scheme%order, order, "order of "//ours(i))
         if (allocated(error)) return
      end do
   end subroutine test_published_tables

   subroutine test_nodes(error)
      type(error_type), allocatable, intent(out) :: error
      type(splitting) :: scheme
      integer :: i, k, n
      do i = 1, splitting_count()
         scheme = row(i)
         n = size(scheme%operations)
         associate (ops => scheme%operations)
            do k = 1, n
               call check(error, abs(ops(k)%node - sum(ops(:k - 1)%b, &
                  mask=.not. ops(:k - 1)%is_kick)) < &
                  1e-15_dp, "node of "//scheme%name)
               if (allocated(error)) return
            end do
            if (ops(n)%is_kick) call check(error, ops(1)%node == 0 .and. ops(n)%node == 1, &
               "the last kick is not at the end exactly: "//scheme%name)
            if (allocated(error)) return
         end associate
      end do
   end subroutine test_nodes

   subroutine test_rows(error)
      type(error_type), allocatable, intent(out) :: error
      type(splitting) :: scheme
      integer :: i
      do i = 1, splitting_count()
         scheme = row(i)
         call check(error, scheme%author /= "" .and. scheme%paper /= "" .and. &
            scheme%year > 1900 .and. &
            scheme%order >= 2 .and. scheme%stages >= 1, "incomplete: "//scheme%name)
         if (allocated(error)) return
         call check(error, scheme%needs_gradient .eqv. any(scheme%operations%c /= 0), &
            "needs_gradient: "//scheme%name)
         if (allocated(error)) return
      end do
   end subroutine test_rows

   subroutine test_names(error)
      type(error_type), allocatable, intent(out) :: error
      type(splitting) :: scheme
      type(poinsot_error) :: refusal
      integer :: i
      do i = 1, splitting_count()
         call find_splitting(splitting_name(i), scheme, refusal)
         call check(error,.not. raised(refusal) .and. scheme%name == splitting_name(i), &
            "not found by name")
         if (allocated(error)) return
      end do
      call check(error, splitting_name(0)//splitting_name(splitting_count() + 1), "")
      if (allocated(error)) return
      call find_splitting("skrn6", scheme, refusal)
      call check(error, raised(refusal), "unknown name taken")
      if (allocated(error)) return
      call check(error, index(refusal%message, "'srkn6'") > 0, "nearest name: "//refusal%message)
   end subroutine test_names

   subroutine test_achieved_order(error)
      type(error_type), allocatable, intent(out) :: error
      call check(error, achieved_order(6, 0, [integer ::]) == 6 .and. achieved_order(6, 4, [0]) &
         == 4 .and. &
         achieved_order(8, 10, [0, 2]) == 2 .and. achieved_order(0, 0, [0]) == 0, "achieved order")
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
         scheme = row(i)
         log = recorder()
         call run_steps(scheme, log, t, h, 7_i8, 5_i8)
         kicks = count(scheme%operations%is_kick)
         call check(error, log%kicks == 5*kicks .and. log%drifts == 5*(size(scheme%operations) &
            - kicks), &
            "flows of "//scheme%name)
         if (allocated(error)) return
         if (scheme%operations(1)%is_kick) kicks = kicks - 1
         call check(error, log%evaluations == 5*kicks + merge(1, 0, scheme%operations(1)%is_kick), &
            "torques of "//scheme%name)
         if (allocated(error)) return
         call check(error,.not. log%stale, "a stored torque served another time: "//scheme%name)
         if (allocated(error)) return
         call check(error, abs(log%moved - 0.5_dp) < 1e-14_dp .and. abs(log%pushed - 0.5_dp) &
            < 1e-14_dp, &
            "five steps are not five steps: "//scheme%name)
         if (allocated(error)) return
         if (scheme%operations(1)%is_kick) call check(error, log%last_time, t + 12*h, "end", &
            thr=1e-15_dp)
         if (allocated(error)) return
      end do
   end subroutine test_stepper_counts

   subroutine test_stepper_halts(error)
      type(error_type), allocatable, intent(out) :: error
      type(recorder) :: log
      type(splitting) :: scheme
      scheme = row(1)
      log%halted = .true.
      call run_steps(scheme, log, 0.0_dp, 0.1_dp, 0_i8, 5_i8)
      call check(error, log%kicks == 1 .and. log%drifts == 0, "a halted system went on")
   end subroutine test_stepper_halts

   !> Every scheme with `exact`, generic body, generic potential, y and q: slopes over the five
   !> finest of 13 steps above the rounding plateau, within .3 (.5 above order 4) of the order.
   subroutine test_orders(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      real(dp) :: slope(2), y(3), q(4), width
      integer :: i
      call generic_effects(effects)
      call true_end(4.0_dp, y, q)
      do i = 1, splitting_count()
         call set_up(it, generic_moments_of, "exact", splitting_name(i), effects)
         call check(error, it%good, it%message)
         if (allocated(error)) return
         slope = slopes(it, 4.0_dp, 12, y, q)
         width = merge(0.3_dp, 0.5_dp, it%scheme%order <= 4)
         call check(error, all(abs(slope - it%scheme%order) < width), told(it, slope))
         if (allocated(error)) return
      end do
   end subroutine test_orders

   !> A rotating field, so that the time of each stage counts: srkn6 keeps its order. The judge is
   !> Runge and Kutta's method.
   subroutine test_order_with_time(error)
      type(error_type), allocatable, intent(out) :: error
      character(12), parameter :: names(3) = [character(12) :: "strang", "srkn6", "omelyan4"]
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      type(poinsot_error) :: refusal
      real(dp) :: slope(2), y(3), q(4)
      integer :: i
      call generic_effects(effects)
      call make_effect("field", [number_setting("dipole", [0.5_dp, -0.3_dp, 0.4_dp]), &
         number_setting("strength", [1.5_dp, 0.2_dp, 0.3_dp]), number_setting("axis", [0.3_dp, &
         0.1_dp, 1.0_dp]), &
         number_setting("frequency", [3.0_dp]), number_setting("phase", [0.4_dp]), &
         text_setting("motion", "rotating")], effects(2)%it, refusal)
      call make_effect("torque", [number_setting("value", [0.3_dp, -0.2_dp, 0.5_dp]), &
         number_setting("frequency", [2.0_dp]), text_setting("frame", "space")], effects(3)%it, &
         refusal)
      call set_up(it, generic_moments_of, "exact", "srkn6", effects)
      call check(error, it%good, it%message)
      if (allocated(error)) return
      call place(it, generic_y, generic_q)
      call judge(it, 0.7_dp, 3.0_dp/6000, 6000)
      y = it%block%y(1, :)
      q = it%block%q(1, :)
      do i = 1, size(names)
         call set_up(it, generic_moments_of, "exact", trim(names(i)), effects)
         slope = slopes(it, 3.0_dp, 12, y, q, start=0.7_dp, floor=1e-14_dp)
         call check(error, all(abs(slope - it%scheme%order) < 0.4_dp), told(it, slope))
         if (allocated(error)) return
      end do
   end subroutine test_order_with_time

   !> A free rotation of order p makes an order p of any scheme.
   subroutine test_caps(error)
      type(error_type), allocatable, intent(out) :: error
      character(20), parameter :: rotors(4) = [character(20) :: "three-rotations", &
         "symmetric-rotation", "midpoint", "dmv4"]
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      real(dp) :: slope(2), y(3), q(4)
      integer :: i, order
      call generic_effects(effects)
      call true_end(2.0_dp, y, q)
      do i = 1, size(rotors)
         call set_up(it, generic_moments_of, trim(rotors(i)), "srkn6", effects)
         call check(error, it%good, it%message)
         if (allocated(error)) return
         slope = slopes(it, 2.0_dp, 10, y, q)
         order = achieved_order(it%scheme%order, it%method%order, [0])
         call check(error, order, merge(4, 2, rotors(i) == "dmv4"), "told order")
         if (allocated(error)) return
         call check(error, all(abs(slope - order) < 0.4_dp), "rotor "//rotors(i)//told(it, slope))
         if (allocated(error)) return
      end do
   end subroutine test_caps

   !> Takahashi and Imada's kernel alone is of order 2, with its processor of order 4.
   subroutine test_processor(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      real(dp) :: slope(2), y(3), q(4)
      call generic_effects(effects)
      call true_end(2.0_dp, y, q)
      call set_up(it, generic_moments_of, "exact", "takahashi-imada", effects)
      slope = slopes(it, 2.0_dp, 12, y, q)
      call check(error, all(abs(slope - 4) < 0.3_dp), told(it, slope))
      if (allocated(error)) return
      deallocate (it%scheme%enter, it%scheme%leave)
      allocate (it%scheme%enter(0), it%scheme%leave(0))
      slope = slopes(it, 2.0_dp, 12, y, q)
      call check(error, all(abs(slope - 2) < 0.3_dp), told(it, slope))
   end subroutine test_processor

   !> Leaving and entering again comes back, up to rounding.
   subroutine test_processor_inverse(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      call generic_effects(effects)
      call set_up(it, generic_moments_of, "exact", "takahashi-imada", effects)
      call place(it, generic_y, generic_q)
      call leave_kernel(it%scheme, it%block, 0.0_dp, 0.3_dp, 0_i8)
      call check(error, momentum_distance(it%block%y(1, :), generic_y) > 1e-4_dp, &
         "the processor does nothing")
      if (allocated(error)) return
      call enter_kernel(it%scheme, it%block, 0.0_dp, 0.3_dp, 0_i8)
      call check(error, momentum_distance(it%block%y(1, :), generic_y) < 1e-14_dp .and. &
         attitude_distance(it%block%q(1, :), generic_q) < 1e-14_dp, "not inverted")
   end subroutine test_processor_inverse

   !> Free rotation and turn of a rotor are composed to the order of the scheme at least, with
   !> torque and without.
   subroutine test_gyrostat_orders(error)
      type(error_type), allocatable, intent(out) :: error
      character(12), parameter :: names(4) = [character(12) :: "strang", "srkn4", "srkn6", &
         "omelyan8"]
      real(dp), parameter :: rotor(3) = [0.4_dp, -0.3_dp, 0.6_dp]
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:), both(:)
      type(poinsot_error) :: refusal
      type(taylor_problem) :: problem
      type(taylor_report) :: report
      real(qp) :: yq(3), qq(4)
      real(dp) :: slope(2)
      real(dp), allocatable :: weights(:)
      integer :: i, torque
      call generic_effects(effects)
      allocate (both(4))
      both(1:3) = effects
      call make_effect("gyrostat", [number_setting("rotor", rotor)], both(4)%it, refusal)
      do torque = 0, 1
         problem = generic_problem()
         problem%spin = rotor
         if (torque == 0) then
            problem%field = .false.
            effects = both(4:4)
         else
            effects = both
         end if
         yq = generic_y
         qq = generic_q
         call taylor_flow(problem, 4.0_qp, yq, qq, report)
         do i = 1, size(names)
            call set_up(it, generic_moments_of, "exact", trim(names(i)), effects)
            call check(error, it%good, it%message)
            if (allocated(error)) return
            slope = slopes(it, 4.0_dp, 12, real(yq, dp), real(qq, dp), floor=5e-15_dp)
            call check(error, all(slope > 2*i - 0.5_dp), "with rotor, "//told(it, slope))
            if (allocated(error)) return
         end do
      end do
      do i = 2, 8, 2
         call turn_composition(i, weights)
         call check(error, abs(sum(weights) - 1) < 2e-15_dp .and. &
            all(weights == weights(size(weights):1:-1)), "weights")
         if (allocated(error)) return
      end do
   end subroutine test_gyrostat_orders

   subroutine test_drag_order(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      type(poinsot_error) :: refusal
      real(dp) :: slope(2), y(3), q(4)
      call generic_effects(effects)
      call make_effect("drag", [number_setting("friction", [0.5_dp, 0.2_dp, 0.9_dp])], &
         effects(2)%it, refusal)
      call set_up(it, generic_moments_of, "exact", "srkn6", effects)
      call check(error, it%good, it%message)
      if (allocated(error)) return
      call place(it, generic_y, generic_q)
      call judge(it, 0.0_dp, 1.0_dp/2000, 2000)
      y = it%block%y(1, :)
      q = it%block%q(1, :)
      slope = slopes(it, 1.0_dp, 12, y, q)
      call check(error, all(abs(slope - 2) < 0.2_dp), told(it, slope))
   end subroutine test_drag_order

   !> Every row of data/top.csv to 1e-12, by two schemes of order 6.
   subroutine test_top_data(error)
      type(error_type), allocatable, intent(out) :: error
      character(12), parameter :: names(2) = [character(12) :: "srkn6", "omelyan6"]
      type(top_case), allocatable :: cases(:)
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      type(poinsot_error) :: refusal
      character(100) :: text
      real(dp) :: dy, dq
      integer :: i, k, n
      call read_top(cases)
      call check(error, size(cases) >= 12, "data/top.csv")
      if (allocated(error)) return
      allocate (effects(1))
      do i = 1, size(cases)
         call make_effect("gravity", [number_setting("centre", cases(i)%centre), &
            number_setting("up", cases(i)%direction), &
            number_setting("weight", [norm2(cases(i)%direction)])], effects(1)%it, refusal)
         do k = 1, 2
            call set_up(it, cases(i)%moments, "exact", trim(names(k)), effects)
            call check(error, it%good, it%message)
            if (allocated(error)) return
            it%block%compensated = .true.
            call place(it, cases(i)%y, cases(i)%q)
            n = nint(cases(i)%t*merge(100, 200, k == 1))
            call run(it, 0.0_dp, cases(i)%t/n, 0, n)
            dy = momentum_distance(real(it%block%y(1, :), qp), cases(i)%y_end)
            dq = attitude_distance(real(it%block%q(1, :), qp), cases(i)%q_end)
            write (text, '(a, " row ", i0, ": y ", es8.1, " q ", es8.1)') trim(names(k)), i, dy, dq
            call check(error, max(dy, dq) < 1e-12_dp, trim(text))
            if (allocated(error)) return
         end do
      end do
   end subroutine test_top_data

   !> Published data 3: the top V = Q33, and its energy 4.205.
   subroutine test_top_published(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      type(poinsot_error) :: refusal
      real(dp) :: kinetic(lanes), potential(lanes)
      allocate (effects(1))
      call make_effect("gravity", [number_setting("centre", [0.0_dp, 0.0_dp, 1.0_dp])], &
         effects(1)%it, refusal)
      call set_up(it, published_3%moments, "exact", "srkn6", effects)
      call place(it, published_3%y, [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp])
      call it%block%energies(0.0_dp, kinetic, potential)
      call check(error, kinetic(1) + potential(1), 4.205_dp, thr=1e-14_dp)
      if (allocated(error)) return
      call run(it, 0.0_dp, 0.01_dp, 0, 1000)
      call check(error, maxval(abs(it%block%y(1, :) - published_3%y_end)) < 2e-13_dp, "y")
      if (allocated(error)) return
      call check(error, maxval(abs(it%block%q(1, :) - published_3%q_end)) < 2e-13_dp, "q")
   end subroutine test_top_published

   !> steps = 10 equals ten calls of one step, to the bit, with every scheme, with time, rotor and
   !> thermostat.
   subroutine test_ten_calls(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:), some(:)
      type(poinsot_error) :: refusal
      real(dp) :: y(lanes, 3), q(lanes, 4)
      integer :: i, k
      call generic_effects(some)
      allocate (effects(5))
      effects(1:3) = some
      call make_effect("gyrostat", [number_setting("rotor", [0.1_dp, 0.2_dp, 0.3_dp])], &
         effects(4)%it, refusal)
      call make_effect("langevin", [number_setting("friction", [0.1_dp]), &
         number_setting("temperature", [0.3_dp])], &
         effects(5)%it, refusal)
      call make_effect("field", [number_setting("dipole", [0.5_dp, -0.3_dp, 0.4_dp]), &
         number_setting("strength", [1.5_dp, 0.2_dp, 0.3_dp]), number_setting("frequency", &
         [3.0_dp]), &
         text_setting("motion", "oscillating")], effects(2)%it, refusal)
      do i = 1, splitting_count()
         call set_up(it, generic_moments_of, "exact", splitting_name(i), effects)
         call check(error, it%good, it%message)
         if (allocated(error)) return
         it%block%compensated = mod(i, 2) == 0
         call place(it, generic_y, generic_q)
         call run(it, 0.1_dp, 0.013_dp, 3, 10)
         y = it%block%y
         q = it%block%q
         call place(it, generic_y, generic_q)
         do k = 0, 9
            it%block%fresh = .false.
            call run(it, 0.1_dp, 0.013_dp, 3 + k, 1)
         end do
         call check(error, all(it%block%y == y) .and. all(it%block%q == q), &
            "bits: "//splitting_name(i))
         if (allocated(error)) return
         call check(error, maxval(abs(y(:, 1) - generic_y(1))) > 1e-3_dp, "nothing happened")
         if (allocated(error)) return
      end do
   end subroutine test_ten_calls

   !> A body's bits do not depend on the lane it sits in, nor on its neighbours.
   subroutine test_place(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      real(dp) :: y(lanes, 3), q(lanes, 4)
      integer :: l
      call generic_effects(effects)
      call set_up(it, generic_moments_of, "exact", "omelyan4", effects)
      call place(it, generic_y, generic_q)
      do l = 1, lanes
         it%block%y(l, :) = it%block%y(l, :)*(1 + 0.3_dp*l)
      end do
      call run(it, 0.0_dp, 0.05_dp, 0, 20)
      y = it%block%y
      q = it%block%q
      call place(it, generic_y, generic_q)
      do l = 1, lanes
         it%block%y(l, :) = it%block%y(l, :)*(1 + 0.3_dp*(lanes + 1 - l))
      end do
      call run(it, 0.0_dp, 0.05_dp, 0, 20)
      call check(error, all(it%block%y == y(lanes:1:-1, :)) .and. all(it%block%q == q(lanes:1:-1, &
         :)), &
         "bits depend on the lane")
   end subroutine test_place

   !> Symmetric schemes run back to where they came from.
   subroutine test_reversal(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      integer :: i
      call generic_effects(effects)
      do i = 1, splitting_count()
         call set_up(it, generic_moments_of, "exact", splitting_name(i), effects)
         call place(it, generic_y, generic_q)
         call run(it, 0.0_dp, 0.1_dp, 0, 20)
         it%block%fresh = .false.
         call run(it, 2.0_dp, -0.1_dp, 0, 20)
         call check(error, momentum_distance(it%block%y(1, :), generic_y) < 5e-14_dp .and. &
            attitude_distance(it%block%q(1, :), generic_q) < 5e-14_dp, &
            "not reversible: "//splitting_name(i))
         if (allocated(error)) return
      end do
   end subroutine test_reversal

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
      call make_effect("gravity", [number_setting("centre", generic_y), number_setting("class", &
         [2.0_dp])], &
         other(1)%it, refusal)
      call set_up(it, generic_moments_of, "exact", "srkn6", other)
      call check(error, it%good .and. size(it%scheme%operations) == 1, &
         "an effect of another class makes kicks")
      if (allocated(error)) return
      call set_up(it, generic_moments_of, "exact", "srkn6", no_effects())
      call check(error, size(it%scheme%operations) == 1 .and. &
         .not. any(it%scheme%operations%is_kick), &
         "a kick without torque")
      if (allocated(error)) return
      call check(error,.not. (allocated(it%block%torques) .or. allocated(it%block%outers) .or. &
         allocated(it%block%wheel) .or. it%block%has_outer), "allocated for nothing")
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
      call check(error, all(it%block%y == y) .and. all(it%block%q == q), &
         "not the bits of the bare rotor")
   end subroutine test_absent

   !> A lane with a status stands still; its neighbours do not notice.
   subroutine test_frozen(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      real(dp) :: y(lanes, 3), q(lanes, 4)
      call generic_effects(effects)
      call set_up(it, generic_moments_of, "exact", "omelyan4", effects)
      call place(it, generic_y, generic_q)
      call run(it, 0.0_dp, 0.05_dp, 0, 20)
      y = it%block%y
      q = it%block%q
      call place(it, generic_y, generic_q)
      it%block%status(5) = 5
      call run(it, 0.0_dp, 0.05_dp, 0, 20)
      call check(error, all(it%block%y(5, :) == generic_y) .and. all(it%block%q(5, :) &
         == generic_q), "it moved")
      if (allocated(error)) return
      y(5, :) = generic_y
      q(5, :) = generic_q
      call check(error, all(it%block%y == y) .and. all(it%block%q == q), "neighbours noticed")
   end subroutine test_frozen

   subroutine test_gradient_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      allocate (effects(1))
      allocate (plain_torque :: effects(1)%it)
      effects(1)%it%name = "mine"
      call set_up(it, generic_moments_of, "exact", "chin4", effects)
      call check(error,.not. it%good, "a scheme with gradient took a torque without")
      if (allocated(error)) return
      call check(error, index(it%message, "chin4") > 0 .and. index(it%message, "mine") > 0, &
         it%message)
      if (allocated(error)) return
      call set_up(it, generic_moments_of, "exact", "srkn4", effects)
      call check(error, it%good, it%message)
   end subroutine test_gradient_refused

   !> Slopes of the errors of y and q at time t over the five finest steps that rounding has not
   !> reached.
   function slopes(it, t, count_of_steps, y, q, start, floor) result(slope)
      type(bench), intent(inout) :: it
      real(dp), intent(in) :: t
      integer, intent(in) :: count_of_steps
      real(dp), intent(in) :: y(3), q(4)
      real(dp), intent(in), optional :: start, floor
      real(dp) :: slope(2), h(count_of_steps), ey(count_of_steps), eq(count_of_steps), from, low
      integer :: j, n
      from = 0
      if (present(start)) from = start
      low = 3e-15_dp
      if (present(floor)) low = floor
      do j = 1, count_of_steps
         n = nint(t*2.0_dp**(0.5_dp*(j + 1)))
         h(j) = t/n
         call place(it, generic_y, generic_q)
         call run_processed(it, from, h(j), n)
         ey(j) = momentum_distance(it%block%y(1, :), y)
         eq(j) = attitude_distance(it%block%q(1, :), q)
      end do
      slope = [finest_slope(h, ey, low), finest_slope(h, eq, low)]
   end function slopes

   function finest_slope(h, error, low) result(slope)
      real(dp), intent(in) :: h(:), error(:), low
      real(dp) :: slope
      integer :: last, first, used
      do last = size(h), 1, -1
         if (error(last) > 30*low) exit
      end do
      first = max(1, last - 4)
      call measure_slope(h(first:last), error(first:last), low, slope, used)
   end function finest_slope

   !> Where the generic body is at time t, by Taylor's series.
   subroutine true_end(t, y, q)
      real(dp), intent(in) :: t
      real(dp), intent(out) :: y(3), q(4)
      type(taylor_report) :: report
      real(qp) :: yq(3), qq(4)
      yq = generic_y
      qq = generic_q
      call taylor_flow(generic_problem(), real(t, qp), yq, qq, report)
      y = real(yq, dp)
      q = real(qq, dp)
   end subroutine true_end

   function told(it, slope) result(text)
      type(bench), intent(in) :: it
      real(dp), intent(in) :: slope(2)
      character(:), allocatable :: text
      character(80) :: buffer
      write (buffer, '(": y ", f6.3, ", q ", f6.3, ", order ", i0)') slope, it%scheme%order
      text = trim(it%scheme%name)//trim(buffer)
   end function told

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
            read (line(8:), *) word
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

   subroutine record_drift(self, h)
      class(recorder), intent(inout) :: self
      real(dp), intent(in) :: h
      self%fresh = .false.
      self%drifts = self%drifts + 1
      self%moved = self%moved + h
   end subroutine record_drift

   subroutine record_kick(self, t, b, c)
      class(recorder), intent(inout) :: self
      real(dp), intent(in) :: t, b, c
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
