!> Studies: the references, the errors they measure, candidates, labels and frontiers. Errors only;
!> no test is about time.
module test_study
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_value, ieee_quiet_nan, &
      ieee_positive_inf
   use testdrive, only: new_unittest, unittest_type, error_type, test_failed
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_status, only: poinsot_e_io
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_override, only: override
   use poinsot_scene_reader, only: read_source
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_source, only: scene_source
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_candidates, only: candidate, scene_kind, survey_scene, list_candidates, &
      quiet_scene, any_name
   use poinsot_study_cost, only: cost_request, cost_study, study_cost
   use poinsot_study_cost_point, only: cost_point, digest, frontier, cheapest, middle, worst, &
      of_angle, of_both
   use poinsot_study_cost_curves, only: find_curve
   use poinsot_study_cost_files, only: write_points, write_report
   use poinsot_study_efficient, only: frontier_part, frontier_parts, leading_parts
   use poinsot_study_errors, only: attitude_error, body_errors
   use poinsot_study_members, only: member_set, draw_members, any_direction
   use poinsot_study_hard_series, only: torque_conditioning
   use poinsot_study_quadruple, only: turn_freely
   use poinsot_study_rivals, only: rival_point, read_rivals, rival_names, rival_time
   use poinsot_study_statistics, only: median, quantile, line_slope
   use poinsot_study_torque_series, only: torque_problem, torque_problems
   use poinsot_study_trial, only: make_plan
   use test_expectation, only: expect
   use test_scene_tools, only: get_text
   implicit none(type, external)
   private
   public :: collect_study, open_scene, as_it_is

   character(40), parameter :: as_it_is(0) = ""   !! no settings over a scene

contains

   subroutine collect_study(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("quadruple: published end states", published_ends), &
         new_unittest("quadruple: half the step, any axis order", quadruple_steps), &
         new_unittest("attitude error of tiny angles", tiny_angles), &
         new_unittest("statistics", numbers_in_order), &
         new_unittest("an error that is no number is not lost", no_number), &
         new_unittest("members: own first, others near", members_near), &
         new_unittest("members: no momentum where no inertia", members_linear), &
         new_unittest("candidates of a free scene", free_candidates), &
         new_unittest("candidates of a scene with a thermostat", noisy_candidates), &
         new_unittest("cost of a free body: orders and floors", free_cost), &
         new_unittest("cost of a top: orders, against the published state", top_cost), &
         new_unittest("cost of a top with taylor: errors follow tolerances", taylor_cost), &
         new_unittest("cost: what was not measured is empty", empty_fields), &
         new_unittest("cost: unknown names are refused", unknown_names), &
         new_unittest("frontier and its names", names_of_frontier), &
         new_unittest("rivals from files", rivals_read), &
         new_unittest("rivals: damaged files are refused", rivals_refused), &
         new_unittest("a curve ends where rounding begins", curve_ends)]
   end subroutine collect_study

   !> A shipped scene, with settings over it.
   subroutine open_scene(name, settings, scene, error)
      character(*), intent(in) :: name, settings(:)
      type(scene_settings), intent(out) :: scene
      type(poinsot_error), intent(inout) :: error
      type(scene_source) :: source
      integer :: i
      call read_source("scenes/" // name // ".nml", source, error)
      do i = 1, size(settings)
         if (.not. raised(error)) call override(trim(settings(i)), source, error)
      end do
      if (.not. raised(error)) call build_scene(source, scene, error)
   end subroutine open_scene

   !> The review's figure 1, and figure 1 of Hairer and Vilmart 2006 (7 digits).
   subroutine published_ends(error)
      type(error_type), allocatable, intent(out) :: error
      real(qp) :: y(3), q(4)
      call turn_freely([0.376_dp, 0.627_dp, 1.0_dp], [0.0_dp, 0.6_dp, -0.8_dp], &
                       [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 40.0_dp, y, q)
      call expect(error, maxval(abs(real(y, dp) - [0.0545936805170048_dp, -0.5930307093190378_dp, &
                                                  -0.8033268997439126_dp])) < 2e-15_dp, &
                                                     "momentum of the review")
      call expect(error, maxval(abs(real(q, dp) - [-0.7620456033094549_dp, -0.5769991038241422_dp, &
                                                  -0.0272197283757480_dp, &
                                                     0.2926048855539088_dp])) < 2e-15_dp, &
                 "attitude of the review")
      call turn_freely([0.6_dp, 0.8_dp, 1.0_dp], [1.8_dp, 0.4_dp, -0.9_dp], &
                       [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 10.0_dp, y, q)
      call expect(error, maxval(abs(real(q, dp) - [-0.7360614_dp, -0.5707870_dp, -0.2993886_dp, &
                                                  -0.2068391_dp])) < 1e-7_dp, &
                                                     "attitude of Hairer and Vilmart")
   end subroutine published_ends

   !> Twice as many steps change nothing but the last digits of quadruple precision; nor do other
   !> names of the axes, odd permutations included.
   subroutine quadruple_steps(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: moments(3) = [0.3_dp, 0.9_dp, 1.1_dp], y0(3) = [0.4_dp, -0.7_dp, &
         0.9_dp]
      real(dp), parameter :: q0(4) = [0.5_dp, 0.5_dp, -0.5_dp, 0.5_dp]
      integer, parameter :: orders(3, 5) = reshape([1, 3, 2, 3, 2, 1, 2, 1, 3, 2, 3, 1, 3, 1, 2], &
         [3, 5])
      real(dp), parameter :: parity(5) = [-1, -1, -1, 1, 1]
      real(qp) :: y(3), q(4), other_y(3), other_q(4)
      integer :: k
      call turn_freely(moments, y0, q0, 30.0_dp, y, q)
      call turn_freely(moments, y0, q0, 30.0_dp, other_y, other_q, 2)
      call expect(error, max(maxval(abs(y - other_y)), maxval(abs(q - other_q))) < 1e-28_qp, &
         "half the step")
      do k = 1, size(parity)
         if (allocated(error)) return
         call turn_freely(moments(orders(:, k)), parity(k)*y0(orders(:, k)), &
                          [q0(1), parity(k)*q0(1 + orders(:, k))], 30.0_dp, other_y, other_q)
         call expect(error, maxval(abs(parity(k)*y(orders(:, k)) - other_y)) < 1e-28_qp .and. &
                    maxval(abs(parity(k)*q(1 + orders(:, k)) - other_q(2:4))) < 1e-28_qp, &
                       "other names of axes")
      end do
   end subroutine quadruple_steps

   subroutine tiny_angles(error)
      type(error_type), allocatable, intent(out) :: error
      real(qp) :: q(4)
      real(dp) :: angle
      q = [cos(0.5e-12_qp), 0.0_qp, sin(0.5e-12_qp), 0.0_qp]
      angle = attitude_error(-q, [1.0_qp, 0.0_qp, 0.0_qp, 0.0_qp])
      call expect(error, abs(angle - 1e-12_dp) < 1e-25_dp, "a turn by 1e-12")
      angle = attitude_error([0.0_qp, 1.0_qp, 0.0_qp, 0.0_qp], [1.0_qp, 0.0_qp, 0.0_qp, 0.0_qp])
      call expect(error, abs(angle - acos(-1.0_dp)) < 1e-15_dp, "a half-turn")
   end subroutine tiny_angles

   !> One NaN among the errors of the bodies: the worst is no number, and the point no result.
   subroutine no_number(error)
      type(error_type), allocatable, intent(out) :: error
      type(body_errors) :: errors
      type(cost_point) :: point
      integer :: which
      do which = 0, 4
         errors%angle = [1e-3_dp, 2e-3_dp, 1e-3_dp]
         errors%momentum = errors%angle
         errors%energy = errors%angle
         errors%slope = errors%angle
         if (which == 1) errors%angle(2) = ieee_value(1.0_dp, ieee_positive_inf)
         if (which == 2) errors%momentum(2) = ieee_value(1.0_dp, ieee_quiet_nan)
         if (which == 3) errors%energy(3) = ieee_value(1.0_dp, ieee_quiet_nan)
         point = cost_point()
         point%good = .true.
         call digest(errors, 2, point)
         call expect(error, point%good .eqv. (which == 0 .or. which == 4), "good or not")
         if (which == 2) call expect(error, .not. ieee_is_finite(point%momentum(worst)), "lost")
      end do
   end subroutine no_number

   subroutine numbers_in_order(error)
      type(error_type), allocatable, intent(out) :: error
      call expect(error, abs(median([3.0_dp, 1.0_dp, 2.0_dp]) - 2) < 1e-15_dp .and. &
                 abs(median([4.0_dp, 1.0_dp, 2.0_dp, 3.0_dp]) - 2.5_dp) < 1e-15_dp, "medians")
      call expect(error, abs(quantile([5.0_dp, 1.0_dp, 3.0_dp], 1.0_dp) - 5) < 1e-15_dp, "largest")
      call expect(error, abs(line_slope([1.0_dp, 3.0_dp, 5.0_dp, 7.0_dp]) - 2) < 1e-14_dp, "slope")
   end subroutine numbers_in_order

   subroutine members_near(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(member_set) :: members
      type(poinsot_error) :: failure
      real(dp) :: along
      integer :: i
      call open_scene("heavy-top", as_it_is, scene, failure)
      call draw_members(scene, .false., 40, 0.1_dp, members, failure)
      call expect(error, .not. raised(failure) .and. members%n == 40 .and. members%given == 1, &
         "forty, one its own")
      call expect(error, all(abs(members%y(:, 1) - [1.8_dp, 0.4_dp, -0.9_dp]) <= 0), &
         "the scene's own is first")
      do i = 2, 40
         if (allocated(error)) return
         along = dot_product(members%y(:, i), members%y(:, 1))/norm2(members%y(:, &
            i))/norm2(members%y(:, 1))
         call expect(error, along > cos(0.1001_dp) .and. along < 1 .and. &
                    abs(norm2(members%q(:, i)) - 1) < 1e-15_dp .and. &
                    members%q(1, i) > cos(0.05001_dp) .and. members%q(1, i) < 1 .and. &
                    all(abs(members%q(2:, i)) > 1e-9_dp), "others are turned by 0.1 at most")
      end do
   end subroutine members_near

   subroutine members_linear(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(member_set) :: members
      type(poinsot_error) :: failure
      call open_scene("free-body", [character(40) :: "bodies.moments=1,0,1", "bodies.y=0.6,0,0.8", &
                                    "scene.method='exact'"], scene, failure)
      call draw_members(scene, .false., 30, any_direction, members, failure)
      call expect(error, .not. raised(failure) .and. all(abs(members%y(2, :)) <= 0) .and. &
                 all(abs(norm2(members%y, 1) - 1) < 1e-14_dp), &
                    "a linear body turns about no axis of its own")
   end subroutine members_linear

   subroutine free_candidates(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(scene_kind) :: kind
      type(candidate), allocatable :: list(:)
      type(poinsot_error) :: failure
      call open_scene("free-body", as_it_is, scene, failure)
      call survey_scene(scene, kind, failure)
      call list_candidates(scene, kind, any_name, any_name, list, failure)
      call expect(error, .not. raised(failure) .and. kind%free .and. .not. kind%kicks .and. &
         size(list) >= 17 .and. &
                 all(list%splitting == "-"), "methods alone")
      if (allocated(error)) return
      call expect(error, list(1)%method == "exact" .and. list(1)%order == 0, "exact has no order")
   end subroutine free_candidates

   subroutine noisy_candidates(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene, quiet
      type(scene_kind) :: kind
      type(candidate), allocatable :: list(:)
      type(poinsot_error) :: failure
      call open_scene("thermostat", [character(20) :: "bodies.count=3", "output.sample=3"], scene, &
         failure)
      call quiet_scene(scene, quiet)
      call survey_scene(quiet, kind, failure)
      call list_candidates(quiet, kind, [character(24) :: "exact"], any_name, list, &
         failure)
      call expect(error, .not. raised(failure) .and. kind%noisy .and. kind%limit == 2 .and. &
         .not. kind%kicks .and. &
                 size(list) == 1, "a thermostat limits the order")
      if (allocated(error)) return
      call expect(error, list(1)%order == 2, "exact within it has order 2")
   end subroutine noisy_candidates

   subroutine free_cost(error)
      type(error_type), allocatable, intent(out) :: error
      type(cost_study) :: study
      real(dp) :: slope
      call small_study("free-body", [character(24) :: "exact", "dmv4", "three-rotations"], &
         any_name, &
                       study, error)
      if (allocated(error)) return
      call expect(error, maxval(study%reference%angle) < 1e-25_dp, &
         "the reference knows its own error")
      call measure_order(study, 2, slope)
      call expect(error, abs(slope - 4) < 0.15_dp, "dmv4 has order 4")
      call measure_order(study, 3, slope)
      call expect(error, abs(slope - 2) < 0.15_dp, "three-rotations has order 2")
      call expect(error, minval(study%points%angle(worst), &
         mask=study%points%candidate == 1) < 1e-13_dp, &
                 "exact is exact")
   end subroutine free_cost

   subroutine top_cost(error)
      type(error_type), allocatable, intent(out) :: error
      type(cost_study) :: study
      real(dp) :: slope
      call small_study("heavy-top", [character(24) :: "exact"], [character(24) :: "strang", &
         "srkn4", "omelyan6"], &
                       study, error)
      if (allocated(error)) return
      call expect(error, maxval(abs(real(study%reference%state%y(:, 1), dp) - &
         [1.922573381663007_dp, &
                       0.7720232344670848_dp, -0.2011054792035490_dp])) < 1e-15_dp, &
                          "published end of the top, to all its digits")
      call expect(error, maxval(study%reference%angle) < 1e-17_dp .and. &
         maxval(study%reference%momentum) < 1e-17_dp, "errors of 1e-15 can be told")
      call measure_order(study, 1, slope)
      call expect(error, abs(slope - 2) < 0.15_dp, "strang has order 2")
      call measure_order(study, 2, slope)
      call expect(error, abs(slope - 4) < 0.3_dp, "srkn4 has order 4")
      call measure_order(study, 3, slope)
      call expect(error, abs(slope - 6) < 0.4_dp, "omelyan6 has order 6")
   end subroutine top_cost

   !> `taylor` stands there by its tolerances, down to rounding, each within twenty times its own.
   !> What rounding is, the motion says: a unit of conditioning, with or without fused products.
   subroutine taylor_cost(error)
      type(error_type), allocatable, intent(out) :: error
      type(cost_study) :: study
      real(dp) :: rounding
      integer :: i
      call small_study("heavy-top", [character(24) :: "exact"], [character(24) :: "taylor"], &
         study, error)
      if (allocated(error)) return
      call one_unit("heavy-top", study, rounding)
      call expect(error, size(study%points) == 27 .and. study%late == 0, "two a decade")
      do i = 1, size(study%points)
         if (allocated(error)) return
         associate (p => study%points(i))
            call expect(error, p%good .and. p%steps == 1, "one call from start to end")
            call expect(error, abs(p%tolerance/(1e-2_dp*sqrt(0.1_dp)**(i - 1)) - 1) < 1e-6_dp, &
               "the tolerances")
            call expect(error, p%angle(middle) < 20*p%tolerance + rounding, "the error it makes")
         end associate
      end do
      call expect(error, study%points(27)%angle(middle) < rounding, "down to rounding")
   end subroutine taylor_cost

   !> The angle that a unit of conditioning is, median of a study's members.
   subroutine one_unit(name, study, angle)
      character(*), intent(in) :: name
      type(cost_study), intent(in) :: study
      real(dp), intent(out) :: angle
      type(scene_settings) :: scene
      type(poinsot_plan) :: plan
      type(torque_problem), allocatable :: problems(:)
      type(poinsot_error) :: failure
      real(dp) :: units(study%members%n)
      integer :: k
      angle = 0
      call open_scene(name, as_it_is, scene, failure)
      if (.not. raised(failure)) call make_plan(scene, "exact", "taylor", plan, failure)
      if (.not. raised(failure)) call torque_problems(plan, problems, failure)
      if (raised(failure)) return
      do k = 1, size(units)
         associate (m => study%members)
            units(k) = torque_conditioning(problems(m%group(k)), m%y(:, k), m%q(:, k), scene%t_end)
         end associate
      end do
      angle = 2*1e-16_dp*median(units) ! twice the distance of quaternions
   end subroutine one_unit

   !> Times that nobody took and all numbers of a failed run are empty in cost.csv, never 0.
   subroutine empty_fields(error)
      type(error_type), allocatable, intent(out) :: error
      type(cost_study) :: study
      type(cost_request) :: request
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      character(:), allocatable :: text, line
      integer :: i, at
      call small_study("heavy-top", [character(24) :: "exact"], [character(24) :: "taylor"], &
         study, error)
      if (allocated(error)) return
      call open_scene("heavy-top", as_it_is, scene, failure)
      call write_report("build/test-cost.txt", scene, request, study, [1e-3_dp], failure)
      call expect(error, .not. raised(failure), failure%message)
      call get_text("build/test-cost.txt", text)
      line = text(index(text, " taylor     0"):)
      line = line(:index(line, new_line("a")) - 1)
      call expect(error, index(line, "0.00") == 0 .and. line(len(line):) == "-", "no time: " // &
         line)
      if (allocated(error)) return
      study%points(2)%good = .false.
      study%points(3)%repeats = 1
      study%points(3)%ns = 5
      call write_points("build/test-cost.csv", study, failure)
      call expect(error, .not. raised(failure), failure%message)
      call get_text("build/test-cost.csv", text)
      do i = 1, 4
         at = index(text, new_line("a"))
         line = text(:at - 1)
         text = text(at + 1:)
         if (i == 1) call expect(error, field(line, 19) == "ns_per_step" .and. field(line, 27) == &
            "good" .and. field(line, 32) == "tolerance", "columns")
         if (i == 2) call expect(error, field(line, 18) /= "" .and. field(line, 19) == "" .and. &
            field(line, 26) == "" .and. field(line, 27) == "1", "no time: " // line)
         if (i == 3) call expect(error, field(line, 7) == "" .and. field(line, 18) == "" .and. &
            field(line, 26) == "" .and. field(line, 27) == "0", "failed: " // line)
         if (i == 4) call expect(error, field(line, 19) == "5.0000E+000" .and. &
            field(line, 32) == "1.0000E-003", "timed: " // line)
      end do
   end subroutine empty_fields

   !> The k-th field of a line of CSV.
   pure function field(line, k) result(text)
      character(*), intent(in) :: line
      integer, intent(in) :: k
      character(:), allocatable :: text
      integer :: i
      text = line // ","
      do i = 2, k
         text = text(index(text, ",") + 1:)
      end do
      text = text(:index(text, ",") - 1)
   end function field

   !> A study without times: it depends on no clock but the budget, which is ample.
   subroutine small_study(name, methods, splittings, study, error)
      character(*), intent(in) :: name
      character(24), intent(in) :: methods(:), splittings(:)
      type(cost_study), intent(out) :: study
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(cost_request) :: request
      type(run_watch) :: watch
      type(poinsot_error) :: failure
      call open_scene(name, as_it_is, scene, failure)
      request%methods = methods
      request%splittings = splittings
      request%members = 8
      request%timed = .false.
      request%budget = 200 ! no limit: threads that wait on a busy machine take it too
      request%most_steps = 3072
      call study_cost(scene, request, watch, study, failure)
      if (raised(failure)) call test_failed(error, failure%message)
   end subroutine small_study

   !> Slope of the median error between the two finest points clear of rounding.
   subroutine measure_order(study, candidate, slope)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: candidate
      real(dp), intent(out) :: slope
      integer :: i, before, last
      before = 0
      last = 0
      slope = 0
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (p%candidate /= candidate .or. .not. p%good) cycle
            if (p%angle(middle) < 1e-11_dp .or. p%angle(middle) > 0.03_dp) cycle
            before = last
            last = i
         end associate
      end do
      if (before == 0) return
      slope = log(study%points(before)%angle(middle)/study%points(last)%angle(middle))/ &
              log(study%points(before)%h/study%points(last)%h)
   end subroutine measure_order

   subroutine unknown_names(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(scene_kind) :: kind
      type(candidate), allocatable :: list(:)
      type(poinsot_error) :: failure
      call open_scene("heavy-top", as_it_is, scene, failure)
      call survey_scene(scene, kind, failure)
      call list_candidates(scene, kind, [character(24) :: "exakt"], any_name, list, &
         failure)
      call expect(error, raised(failure), "an unknown method")
      call expect(error, index(failure%message, """exact""") > 0, "the nearest is named")
   end subroutine unknown_names

   !> Three candidates by hand: one cheap and coarse, one better, one behind everywhere.
   subroutine names_of_frontier(error)
      type(error_type), allocatable, intent(out) :: error
      type(cost_point) :: points(6)
      type(frontier_part), allocatable :: parts(:)
      points%candidate = [1, 1, 2, 2, 3, 3]
      points%good = .true.
      points%h = 1
      points%ns = [10.0_dp, 100.0_dp, 20.0_dp, 30.0_dp, 50.0_dp, 300.0_dp]
      points%angle(middle) = [1e-2_dp, 1e-4_dp, 1e-3_dp, 1e-8_dp, 1e-3_dp, 1e-8_dp]
      points%momentum(middle) = points%angle(middle)
      call frontier(points, of_angle)
      call expect(error, all(points%front(of_angle) .eqv. [.true., .false., .true., .true., &
                                                          .false., .false.]), &
                 "points that none beats")
      call expect(error, cheapest(points, 1e-4_dp, of_both, middle) == 4 .and. &
                 cheapest(points, 1e-4_dp, of_both, middle, but=2) == 2 .and. &
                 cheapest(points, 1e-9_dp, of_both, middle) == 0, "cheapest within a tolerance")
      call frontier_parts(points, 3, of_angle, parts)
      call expect(error, size(parts) == 2, "two names")
      if (allocated(error)) return
      call expect(error, all(parts%candidate == [1, 2]), "from coarse to fine")
      where (points%candidate == 2) points%tolerance = 1e-9_dp
      call leading_parts(points, 3, of_angle, parts)
      call expect(error, size(parts) > 2 .and. any(parts%candidate == 2) .and. &
         all(points(parts(3:)%point)%tolerance <= 0), "who would lead without taylor")
   end subroutine names_of_frontier

   !> Two files with one line too many at their ends; the least time within a tolerance.
   subroutine rivals_read(error)
      type(error_type), allocatable, intent(out) :: error
      type(rival_point), allocatable :: points(:)
      character(32), allocatable :: names(:)
      type(poinsot_error) :: failure
      call put_file("build/test-rivals-1.csv", "name,setting,angle,worst,momentum,worst,ns"// &
         new_line("a")//"euler,0.1,1e-2,2e-2,1e-3,2e-3,50"//new_line("a")// &
         "euler,0.01,1e-4,2e-4, 1e-3 ,2e-3,500"//new_line("a")//new_line("a"))
      call put_file("build/test-rivals-2.csv", "name"//new_line("a")// &
         "verlet,0.1,1e-5,2e-5,1e-6,2e-6,70"//new_line("a")//"euler,1,1e-2,1,1e-3,1,40")
      call read_rivals("build/test-rivals-1.csv,,build/test-rivals-2.csv", points, failure)
      call expect(error, .not. raised(failure) .and. size(points) == 4, "four points")
      if (allocated(error)) return
      call rival_names(points, names)
      call expect(error, size(names) == 2 .and. names(1) == "euler" .and. names(2) == "verlet", &
         "two names")
      if (allocated(error)) return
      call expect(error, all(abs([rival_time(points, "euler", 0.01_dp) - 40, &
         rival_time(points, "euler", 0.005_dp) - 500, rival_time(points, "euler", 1e-4_dp), &
         rival_time(points, "verlet", 1e-5_dp) - 70, rival_time(points, "none", 1.0_dp)]) <= 0), &
         "the least time")
   end subroutine rivals_read

   subroutine rivals_refused(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: file = "build/test-rivals-3.csv"
      character(*), parameter :: lines(5) = [character(40) :: "euler", ",0.1,1,1,1,1,1", &
         "euler,0.1,1,1,1,1", "euler,0.1,1,one,1,1,1", "euler,0.1,1,,1,1,1"]
      type(rival_point), allocatable :: points(:)
      type(poinsot_error) :: failure
      integer :: i
      call read_rivals("build/no-such-file.csv", points, failure)
      call expect(error, failure%code, poinsot_e_io)
      do i = 1, size(lines)
         if (allocated(error)) return
         call put_file(file, "name"//new_line("a")//trim(lines(i))//new_line("a"))
         failure = poinsot_error()
         call read_rivals(file, points, failure)
         call expect(error, failure%code == poinsot_e_io .and. &
            index(failure%message, file//":2") > 0, "taken: "//trim(lines(i)))
      end do
   end subroutine rivals_refused

   subroutine put_file(name, text)
      character(*), intent(in) :: name, text
      integer :: unit
      open (newunit=unit, file=name, access="stream", status="replace", action="write")
      write (unit) text
      close (unit)
   end subroutine put_file

   !> Order 4 down to rounding, then noise; order 2 that is still on its way; an exact one.
   subroutine curve_ends(error)
      type(error_type), allocatable, intent(out) :: error
      type(cost_study) :: study
      integer :: first, last
      study%candidates = [candidate("dmv4", order=4), candidate("dmv2", order=2), &
                          candidate("exact", order=0)]
      allocate (study%points(14))
      study%points%good = .true.
      study%points%candidate = [1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3]
      study%points%angle(middle) = [1e-6_dp, 1e-10_dp, 1e-14_dp, 9e-15_dp, 2e-14_dp, 8e-15_dp, &
         1e-3_dp, 5e-4_dp, 2.8e-4_dp, 1.25e-4_dp, 1e-14_dp, 9e-15_dp, 2e-14_dp, 8e-15_dp]
      call find_curve(study, 1, of_angle, first, last)
      call expect(error, first == 1 .and. last == 3, "the floor is cut off")
      call find_curve(study, 2, of_angle, first, last)
      call expect(error, first == 7 .and. last == 10, "what still gains is kept")
      call find_curve(study, 3, of_angle, first, last)
      call expect(error, first == 11 .and. last == 14, "exact at any step is kept")
   end subroutine curve_ends

end module test_study
