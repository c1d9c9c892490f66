!> Hard tops through `taylor` at its finest, beside quadruple precision: one figure a case.
!>
!> An error counts in units of conditioning, as that of free bodies does: one unit is what moving
!> each input (momentum, attitude, torque, time) by 1e-16 does to the result. Torques over moments
!> are rounded before anything is integrated, and a body that librates ten times in a field is known
!> no better than that. Moments are no inputs here: a needle's two large ones, moved one without the
!> other, would allow any error at all.
!>
!> A case is a row of `cases`.
module poinsot_study_hard_series
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, i8, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok
   use poinsot_effect_settings, only: setting
   use poinsot_effect_settings_text, only: read_settings
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_effect, set_option
   use poinsot_ensemble_step, only: step_bodies
   use poinsot_study_hard_promises, only: broken
   use poinsot_study_quadruple, only: cross
   use poinsot_study_torque_series, only: torque_problem, torque_problems, turn_under_torque, fine
   implicit none(type, external)
   private
   public :: series_names, series_bound, series_about, measure_series, torque_conditioning

   !> A top under gravity: its name, what it is, and where it begins.
   type :: series_case
      character(9) :: name
      character(66) :: about
      real(dp) :: moments(3)
      real(dp) :: torque(3)              !! weight times centre
      real(dp) :: y(3)
      real(dp) :: q(4)
      real(dp) :: time
   end type series_case

   real(dp), parameter :: limit = 1.5491933384829668_dp ! I3^2 w3^2 = 4 I1 m g l
   real(dp), parameter :: up(3) = [0, 0, 1], along(3) = [1, 0, 0], upright(4) = [1, 0, 0, 0], &
      hanging(4) = [0, 1, 0, 0], some(4) = [0.5_dp, 0.1_dp, 0.7_dp, 0.5_dp]

   type(series_case), parameter :: cases(*) = [ &
      series_case("asleep", "upright at the limit of stability, 100 units of time", &
         [0.6_dp, 0.6_dp, 1.0_dp], up, limit*up, upright, 100.0_dp), &
      series_case("limit", "the same tilted by 1e-8, 10 units", &
         [0.6_dp, 0.6_dp, 1.0_dp], up, limit*up, [1.0_dp, 5e-9_dp, 0.0_dp, 0.0_dp], 10.0_dp), &
      series_case("pendulum", "at its separatrix: it comes to rest upright, 6 units", &
         [0.5_dp, 0.8_dp, 1.0_dp], up, [sqrt(2.0_dp), 0.0_dp, 0.0_dp], hanging, 6.0_dp), &
      series_case("needle", "I1 = 1e-6, its centre on the axis, 10 units", &
         [1e-6_dp, 1.0_dp, 1.0_dp], along, [1e-7_dp, 0.8_dp, 0.5_dp], some, 10.0_dp), &
      series_case("sliver", "I1 = 1e-9, a third of it between I2 and I3, 10 units", &
         [1e-9_dp, 1.0_dp, 1.0000000003_dp], along, [1e-10_dp, 0.8_dp, 0.5_dp], some, 10.0_dp), &
      series_case("lopsided", "I1 = 1e-6, its centre off the axis: 10 librations about it", &
         [1e-6_dp, 1.0_dp, 1.0_dp], up, [1e-7_dp, 0.8_dp, 0.5_dp], some, 0.06_dp), &
      series_case("line", "I1 = 0, its centre on the axis, 10 units", &
         [0.0_dp, 1.0_dp, 1.0_dp], along, [0.0_dp, 0.8_dp, 0.5_dp], some, 10.0_dp), &
      series_case("molecule", "about water in SI units, a torque of 1e-21 N m, 1 ps", &
         1e-47_dp*[1.0_dp, 1.9_dp, 2.9_dp], 1e-21_dp*up, 1e-34_dp*[1.0_dp, 0.4_dp, -0.9_dp], some, &
         1e-12_dp), &
      series_case("huge", "moments, momentum and torque of 1e70, 10 units", &
         1e70_dp*[0.6_dp, 0.8_dp, 1.0_dp], 1e70_dp*up, 1e70_dp*[1.8_dp, 0.4_dp, -0.9_dp], some, &
         10.0_dp)]

   character(9), parameter :: series_names(*) = cases%name
   character(66), parameter :: series_about(*) = cases%about
   real(dp), parameter :: series_bound = 3           !! units, as `exact` may lose of free bodies
   integer, parameter :: inputs = 8
   real(qp), parameter :: part = 2.0_qp**(-36)       !! by which inputs move

contains

   !> Figure of a case, forwards and backwards: its error in units; `broken`: a NaN, or a status.
   real(dp) function measure_series(number) result(figure)
      integer, intent(in) :: number
      integer :: way
      figure = 0
      do way = 1, -1, -2
         figure = max(figure, units_off(cases(number), way*cases(number)%time))
      end do
   end function measure_series

   !> Units of conditioning between `taylor` in one call and quadruple precision, the worse of plain
   !> and of compensated sums.
   real(dp) function units_off(one, time) result(units)
      type(series_case), intent(in) :: one
      real(dp), intent(in) :: time
      type(torque_problem), allocatable :: problems(:)
      type(poinsot_plan) :: plan
      type(poinsot_error) :: error
      real(qp) :: y(3), q(4), off
      real(dp) :: y0(3), q0(4)
      integer :: sums
      logical :: good
      units = broken
      call make_plan(one, plan, error)
      if (.not. raised(error)) call torque_problems(plan, problems, error)
      if (raised(error)) return
      call solve(problems(1), one%y, one%q, time, 0, y, q)
      off = 0
      do sums = 1, 2
         y0 = one%y
         q0 = one%q
         call advance(plan, time, sums == 2, y0, q0, good)
         if (.not. good .or. .not. all(ieee_is_finite([y0, q0]))) return
         off = max(off, apart(real(y0, qp), real(q0, qp), y, q))
      end do
      units = real(off, dp)/(1e-16_dp*torque_conditioning(problems(1), one%y, one%q, time))
   end function units_off

   !> How far the end of a motion moves when each input does by one part: a sum over the inputs of
   !> the larger of |d y|/|y| and |d q|, at least 1.
   real(dp) function torque_conditioning(problem, y0, q0, time) result(moved)
      type(torque_problem), intent(in) :: problem
      real(dp), intent(in) :: y0(3), q0(4)     !! the start
      real(dp), intent(in) :: time
      real(qp) :: yr(3), qr(4), y(3), q(4)
      integer :: input
      call solve(problem, y0, q0, time, 0, yr, qr)
      moved = 0
      do input = 1, inputs
         call solve(problem, y0, q0, time, input, y, q)
         moved = moved + real(apart(y, q, yr, qr)/part, dp)
      end do
      moved = max(moved, 1.0_dp)
   end function torque_conditioning

   !> In quadruple precision, one input moved.
   subroutine solve(problem, y0, q0, time, input, y, q)
      type(torque_problem), intent(in) :: problem
      real(dp), intent(in) :: y0(3), q0(4), time
      integer, intent(in) :: input             !! 0: none; y, turns, torque, time
      real(qp), intent(out) :: y(3), q(4)
      integer, parameter :: most_steps = 100000
      type(torque_problem) :: moved
      real(qp) :: t, t1
      logical :: done
      moved = problem
      y = y0
      q = q0
      t = 0
      t1 = time
      select case (input)
      case (0)
      case (1:3); y(input) = y(input)*(1 + part)
      case (4:6); q = q + part*turned_about(input - 3, q)
      case (7); call strengthen(moved)
      case default; t1 = t1*(1 + part)
      end select
      call turn_under_torque(moved, fine, t, t1, most_steps, y, q, done)
      if (.not. done) y = huge(part)
   end subroutine solve

   !> All torques, by one part.
   pure subroutine strengthen(problem)
      type(torque_problem), intent(inout) :: problem
      real(dp), parameter :: more = 1 + real(part, dp)
      integer :: i
      do i = 1, size(problem%linear)
         problem%linear(i)%matrix = problem%linear(i)%matrix*more
      end do
      do i = 1, size(problem%quadratic)
         problem%quadratic(i)%difference = problem%quadratic(i)%difference*more
         problem%quadratic(i)%product = problem%quadratic(i)%product*more
      end do
      do i = 1, size(problem%body)
         problem%body(i)%value = problem%body(i)%value*more
      end do
      do i = 1, size(problem%table)
         problem%table(i)%values = problem%table(i)%values*more
      end do
   end subroutine strengthen

   !> q o e_i.
   pure function turned_about(i, q) result(r)
      integer, intent(in) :: i
      real(qp), intent(in) :: q(4)
      real(qp) :: r(4), e(3)
      e = 0
      e(i) = 1
      r = [-dot_product(q(2:4), e), q(1)*e + cross(q(2:4), e)]
   end function turned_about

   pure real(qp) function apart(y, q, yr, qr)
      real(qp), intent(in) :: y(3), q(4), yr(3), qr(4)
      apart = max(norm2((y - yr)/norm2(yr)), min(norm2(q - qr), norm2(q + qr)))
   end function apart

   subroutine make_plan(one, plan, error)
      type(series_case), intent(in) :: one
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      type(setting), allocatable :: settings(:)
      character(100) :: text
      integer :: number
      call add_class(plan, one%moments, number, error)
      if (.not. raised(error)) call set_option(plan, "splitting", "taylor", error)
      if (.not. raised(error)) call set_option(plan, "tolerance", "1e-15", error)
      write (text, "(a, 2(es24.16e3, ','), es24.16e3, a)") "centre = ", one%torque, "; weight = 1"
      if (.not. raised(error)) call read_settings(trim(text), settings, error)
      if (.not. raised(error)) call add_effect(plan, "gravity", settings, error)
      if (.not. raised(error)) call make_ready(plan, error)
   end subroutine make_plan

   !> One call from start to end.
   subroutine advance(plan, time, compensated, y, q, good)
      type(poinsot_plan), intent(in) :: plan
      real(dp), intent(in) :: time
      logical, intent(in) :: compensated
      real(dp), intent(inout) :: y(3), q(4)
      logical, intent(out) :: good
      type(body_view) :: view
      type(poinsot_error) :: error
      real(dp), target :: yy(3, 1), qq(4, 1), carry(7, 1)
      integer :: status
      yy(:, 1) = y
      qq(:, 1) = q
      carry = 0
      call view_rows(yy, qq, view)
      if (compensated) view%carry => carry
      call step_bodies(plan, view, 0.0_dp, time, 0_i8, 1_i8, status, error)
      y = yy(:, 1)
      q = qq(:, 1)
      good = status == poinsot_ok .and. .not. raised(error)
   end subroutine advance

end module poinsot_study_hard_series
