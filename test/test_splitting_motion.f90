!> Room splitting at work: measured orders of every scheme, data of the heavy top, and the rules on
!> bits.
module test_splitting_motion
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, qp, i8, lanes
   use poinsot_core_error, only: poinsot_error
   use poinsot_effect_effect, only: effect_item
   use poinsot_effect_settings, only: number_setting, text_setting
   use poinsot_effect_registry, only: make_effect
   use poinsot_splitting_tableaux, only: turn_composition
   use poinsot_splitting_registry, only: is_table, splitting_count, splitting_name, achieved_order
   use poinsot_splitting_stepper, only: apply_preprocessor, apply_postprocessor
   use test_expectation, only: expect
   use test_measure, only: measure_slope, attitude_distance, momentum_distance
   use test_oracle_data, only: top_case, read_top, published_3
   use test_oracle_taylor, only: taylor_problem, taylor_report, taylor_flow
   use test_turning, only: bench, set_up, place, run, run_processed, judge, generic_effects, &
      generic_problem, generic_moments_of, generic_y, generic_q
   implicit none(type, external)
   private
   public :: collect_motion

contains

   subroutine collect_motion(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
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
         new_unittest("frozen-lanes-stand-still", test_frozen)]
   end subroutine collect_motion

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
         if (.not. is_table(i)) cycle
         call set_up(it, generic_moments_of, "exact", splitting_name(i), effects)
         call expect(error, it%good, it%message)
         slope = slopes(it, 4.0_dp, 12, y, q)
         width = merge(0.3_dp, 0.5_dp, it%scheme%order <= 4)
         call expect(error, all(abs(slope - it%scheme%order) < width), told(it, slope))
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
                       number_setting("frequency", [2.0_dp]), text_setting("frame", "space")], &
                       effects(3)%it, refusal)
      call set_up(it, generic_moments_of, "exact", "srkn6", effects)
      call expect(error, it%good, it%message)
      call place(it, generic_y, generic_q)
      call judge(it, 0.7_dp, 3.0_dp/6000, 6000)
      y = it%block%y(1, :)
      q = it%block%q(1, :)
      do i = 1, size(names)
         call set_up(it, generic_moments_of, "exact", trim(names(i)), effects)
         slope = slopes(it, 3.0_dp, 12, y, q, start=0.7_dp, floor=1e-14_dp)
         call expect(error, all(abs(slope - it%scheme%order) < 0.4_dp), told(it, slope))
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
         call expect(error, it%good, it%message)
         slope = slopes(it, 2.0_dp, 10, y, q)
         order = achieved_order(it%scheme%order, it%method%order, [0])
         call expect(error, order, merge(4, 2, rotors(i) == "dmv4"), "told order")
         call expect(error, all(abs(slope - order) < 0.4_dp), "rotor "//rotors(i)//told(it, slope))
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
      call expect(error, all(abs(slope - 4) < 0.3_dp), told(it, slope))
      deallocate (it%scheme%enter, it%scheme%leave)
      allocate (it%scheme%enter(0), it%scheme%leave(0))
      slope = slopes(it, 2.0_dp, 12, y, q)
      call expect(error, all(abs(slope - 2) < 0.3_dp), told(it, slope))
   end subroutine test_processor

   !> Leaving and entering again comes back, up to rounding.
   subroutine test_processor_inverse(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      call generic_effects(effects)
      call set_up(it, generic_moments_of, "exact", "takahashi-imada", effects)
      call place(it, generic_y, generic_q)
      call apply_postprocessor(it%scheme, it%block, 0.0_dp, 0.3_dp, 0_i8)
      call expect(error, momentum_distance(it%block%y(1, :), generic_y) > 1e-4_dp, &
         "the processor does nothing")
      call apply_preprocessor(it%scheme, it%block, 0.0_dp, 0.3_dp, 0_i8)
      call expect(error, momentum_distance(it%block%y(1, :), generic_y) < 1e-14_dp .and. &
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
            call expect(error, it%good, it%message)
            slope = slopes(it, 4.0_dp, 12, real(yq, dp), real(qq, dp), floor=5e-15_dp)
            call expect(error, all(slope > 2*i - 0.5_dp), "with rotor, "//told(it, slope))
         end do
      end do
      do i = 2, 8, 2
         call turn_composition(i, weights)
         call expect(error, abs(sum(weights) - 1) < 2e-15_dp .and. &
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
      call expect(error, it%good, it%message)
      call place(it, generic_y, generic_q)
      call judge(it, 0.0_dp, 1.0_dp/2000, 2000)
      y = it%block%y(1, :)
      q = it%block%q(1, :)
      slope = slopes(it, 1.0_dp, 12, y, q)
      call expect(error, all(abs(slope - 2) < 0.2_dp), told(it, slope))
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
      call expect(error, size(cases) >= 12, "data/top.csv")
      if (allocated(error)) return
      allocate (effects(1))
      do i = 1, size(cases)
         call make_effect("gravity", [number_setting("centre", cases(i)%centre), &
            number_setting("up", cases(i)%direction), &
            number_setting("weight", [norm2(cases(i)%direction)])], effects(1)%it, refusal)
         do k = 1, 2
            call set_up(it, cases(i)%moments, "exact", trim(names(k)), effects)
            call expect(error, it%good, it%message)
            it%block%compensated = .true.
            call place(it, cases(i)%y, cases(i)%q)
            n = nint(cases(i)%t*merge(100, 200, k == 1))
            call run(it, 0.0_dp, cases(i)%t/n, 0, n)
            dy = momentum_distance(real(it%block%y(1, :), qp), cases(i)%y_end)
            dq = attitude_distance(real(it%block%q(1, :), qp), cases(i)%q_end)
            write (text, '(a, " row ", i0, ": y ", es8.1, " q ", es8.1)') trim(names(k)), i, dy, dq
            call expect(error, max(dy, dq) < 1e-12_dp, trim(text))
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
      call expect(error, kinetic(1) + potential(1), 4.205_dp, thr=1e-14_dp)
      call run(it, 0.0_dp, 0.01_dp, 0, 1000)
      call expect(error, maxval(abs(it%block%y(1, :) - published_3%y_end)) < 2e-13_dp, "y")
      call expect(error, maxval(abs(it%block%q(1, :) - published_3%q_end)) < 2e-13_dp, "q")
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
                       number_setting("temperature", [0.3_dp])], effects(5)%it, refusal)
      call make_effect("field", [number_setting("dipole", [0.5_dp, -0.3_dp, 0.4_dp]), &
                       number_setting("strength", [1.5_dp, 0.2_dp, 0.3_dp]), &
                       number_setting("frequency", [3.0_dp]), &
                       text_setting("motion", "oscillating")], effects(2)%it, refusal)
      do i = 1, splitting_count()
         if (.not. is_table(i)) cycle
         call set_up(it, generic_moments_of, "exact", splitting_name(i), effects)
         call expect(error, it%good, it%message)
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
         call expect(error, all(it%block%y == y) .and. all(it%block%q == q), &
            "bits: "//splitting_name(i))
         call expect(error, maxval(abs(y(:, 1) - generic_y(1))) > 1e-3_dp, "nothing happened")
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
      call expect(error, all(it%block%y == y(lanes:1:-1, :)) .and. &
                 all(it%block%q == q(lanes:1:-1, :)), "bits depend on the lane")
   end subroutine test_place

   !> Symmetric schemes run back to where they came from.
   subroutine test_reversal(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      integer :: i
      call generic_effects(effects)
      do i = 1, splitting_count()
         if (.not. is_table(i)) cycle
         call set_up(it, generic_moments_of, "exact", splitting_name(i), effects)
         call place(it, generic_y, generic_q)
         call run(it, 0.0_dp, 0.1_dp, 0, 20)
         it%block%fresh = .false.
         call run(it, 2.0_dp, -0.1_dp, 0, 20)
         call expect(error, momentum_distance(it%block%y(1, :), generic_y) < 5e-14_dp .and. &
            attitude_distance(it%block%q(1, :), generic_q) < 5e-14_dp, &
            "not reversible: "//splitting_name(i))
      end do
   end subroutine test_reversal

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
      call expect(error, all(it%block%y(5, :) == generic_y) .and. all(it%block%q(5, :) &
         == generic_q), "it moved")
      y(5, :) = generic_y
      q(5, :) = generic_q
      call expect(error, all(it%block%y == y) .and. all(it%block%q == q), "neighbours noticed")
   end subroutine test_frozen

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

end module test_splitting_motion
