!> How the tests turn bodies with the library, and the largest errors they find.
module test_free_tools
   use poinsot_core_kinds, only: dp, qp, groups, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok
   use poinsot_body_class, only: body_class, make_class
   use poinsot_free_exact_lanes, only: lane_constants, make_lane_constants, advance_each
   use poinsot_free_method, only: free_method, find_method, advance
   use test_bodies, only: random_body, random_stream, start_stream, hard_body, uniform, &
      random_quaternion, body_kinds
   use test_measure, only: attitude_distance, momentum_distance, units
   use test_oracle_data, only: free_case
   use test_oracle_dmv, only: reference_map, make_reference
   use test_oracle_properties, only: plain_map
   use test_oracle_taylor, only: taylor_report, taylor_flow, free_problem, conditioning
   implicit none(type, external)
   private
   public :: method_names, method_orders, approximate_count, generic, start, start_q
   public :: turn_body, prepare, rest_block, random_block, text, library_map
   public :: worst_of_kind, worst_of_hard, worst_of_map

   !> The approximate methods first, three-rotations and symmetric-rotation before all.
   character(20), parameter :: method_names(18) = [character(20) :: "three-rotations", &
      "symmetric-rotation", &
      "midpoint", "rattle", "dmv2", "dmv4", "dmv6", "dmv8", "dmv10", "dmv12", "dmv14", "dmv16", &
         "dmv18", &
      "dmv20", "dmv22", &
      "dmv24", "exact", "jacobi"]
   integer, parameter :: method_orders(18) = [2, 2, 2, 2, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, &
      24, 0, 0]
   integer, parameter :: approximate_count = 16
   real(dp), parameter :: generic(3) = [0.8_dp, 0.55_dp, 0.95_dp] !! of a generic body, unsorted
   real(dp), parameter :: start(3) = [0.5_dp, -0.6_dp, 0.4_dp]    !! its momentum
   real(dp), parameter :: start_q(4) = [0.1_dp, 0.7_dp, -0.5_dp, 0.5_dp]

   !> A method of the library as a map on plain state.
   type, extends(plain_map) :: library_map
      character(20) :: name = ""
      real(dp) :: moments(3) = 1
   contains
      procedure :: apply => apply_library
   end type library_map

contains

   !> `steps` steps of one body, alone in its block (or in the place `lane`).
   subroutine turn_body(name, moments, h, steps, y, q, status, lane, compensate, physical)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(3), q(4)
      integer, intent(out) :: status             !! of the body, or of the refusing call
      integer, intent(in), optional :: lane
      logical, intent(in), optional :: compensate
      !> .false.: moments that break the triangle inequality
      logical, intent(in), optional :: physical
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: error
      real(dp) :: yb(lanes, 3), qb(lanes, 4), carry(lanes, 7)
      integer :: sb(lanes), i, l
      l = 1
      if (present(lane)) l = lane
      if (name(1:min(5, len(name))) == "each-") then
         call turn_among_others(name == "each-jacobi", moments, h, steps, y, q, status, l, &
            present(compensate))
         return
      end if
      call prepare(name, moments, method, class, error, physical)
      status = error%code
      if (raised(error)) return
      call rest_block(yb, qb, sb)
      carry = 0
      yb(l, :) = y
      qb(l, :) = q
      do i = 1, steps
         if (present(compensate)) then
            call advance(method, class, h, yb, qb, sb, carry)
         else
            call advance(method, class, h, yb, qb, sb)
         end if
      end do
      y = yb(l, :)
      q = qb(l, :)
      status = sb(l)
   end subroutine turn_body

   !> "each-exact" and "each-jacobi": a body among others with moments, sizes and steps of their
   !> own.
   subroutine turn_among_others(by_jacobi, moments, h, steps, y, q, status, lane, compensate)
      logical, intent(in) :: by_jacobi, compensate
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps, lane
      real(dp), intent(inout) :: y(3), q(4)
      integer, intent(out) :: status
      type(random_stream) :: stream
      type(random_body) :: other
      type(lane_constants) :: c
      real(dp) :: m(lanes, 3), hl(lanes), yb(lanes, 3), qb(lanes, 4), carry(lanes, 7)
      integer :: sb(lanes), i, l
      stream = start_stream(int(1000*abs(y(1)/(1 + norm2(y)))) + lane)
      do l = 1, lanes
         call hard_body(stream, body_kinds(1 + mod(l, size(body_kinds))), 0.9_dp, other)
         m(l, :) = other%moments
         yb(l, :) = other%y
         qb(l, :) = other%q
         hl(l) = other%h
      end do
      sb = poinsot_ok
      carry = 0
      m(lane, :) = moments
      yb(lane, :) = y
      qb(lane, :) = q
      hl(lane) = h
      call make_lane_constants(m, groups, c, sb)
      do i = 1, steps
         if (compensate) then
            call advance_each(c, by_jacobi, hl, 1, yb, qb, sb, groups, carry)
         else
            call advance_each(c, by_jacobi, hl, 1, yb, qb, sb, groups)
         end if
      end do
      y = yb(lane, :)
      q = qb(lane, :)
      status = sb(lane)
   end subroutine turn_among_others

   !> Method and class by name and moments.
   subroutine prepare(name, moments, method, class, error, physical)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3)
      type(free_method), intent(out) :: method
      type(body_class), intent(out) :: class
      type(poinsot_error), intent(inout) :: error
      logical, intent(in), optional :: physical
      call find_method(trim(name), method, error)
      if (raised(error)) return
      call make_class(moments, class, error, physical)
   end subroutine prepare

   subroutine rest_block(y, q, status)
      real(dp), intent(out) :: y(lanes, 3), q(lanes, 4)
      integer, intent(out) :: status(lanes)
      y = 0
      q = 0
      q(:, 1) = 1
      status = poinsot_ok
   end subroutine rest_block

   !> A block of generic states of one body.
   subroutine random_block(stream, y, q)
      type(random_stream), intent(inout) :: stream
      real(dp), intent(out) :: y(lanes, 3), q(lanes, 4)
      integer :: l, j
      do l = 1, lanes
         do j = 1, 3
            y(l, j) = 2*uniform(stream) - 1
         end do
         q(l, :) = random_quaternion(stream)
      end do
   end subroutine random_block

   subroutine apply_library(self, h, y, q, ok)
      class(library_map), intent(in) :: self
      real(qp), intent(in) :: h
      real(qp), intent(inout) :: y(3), q(4)
      logical, intent(out) :: ok
      real(dp) :: yd(3), qd(4)
      integer :: status
      yd = real(y, dp)
      qd = real(q, dp)
      call turn_body(self%name, self%moments, real(h, dp), 1, yd, qd, status)
      y = yd
      q = qd
      ok = status == poinsot_ok
   end subroutine apply_library

   !> A number for a message.
   function text(x) result(string)
      real(dp), intent(in) :: x
      character(:), allocatable :: string
      character(16) :: buffer
      write (buffer, "(es9.2)") x
      string = trim(adjustl(buffer))
   end function text

   !> Largest error of a kind of free_rotation.csv, y and q, in units of conditioning. A failed body
   !> counts as infinite.
   subroutine worst_of_kind(name, kind, cases, worst_y, worst_q, line)
      character(*), intent(in) :: name, kind
      type(free_case), intent(in) :: cases(:)
      real(dp), intent(out) :: worst_y, worst_q
      integer, intent(out) :: line               !! in the file, of the worst case
      real(dp) :: y(3), q(4), ey, eq, cond(2)
      integer :: i, status
      worst_y = 0
      worst_q = 0
      line = 0
      do i = 1, size(cases)
         if (cases(i)%kind /= kind) cycle
         y = cases(i)%y
         q = [1, 0, 0, 0]
         call turn_body(name, cases(i)%moments, cases(i)%h, 1, y, q, status, lane=1 + mod(i, lanes))
         cond = [cases(i)%cond_y, cases(i)%cond_r]
         if (kind == "nearsym" .or. kind == "nearlinear") cond = [cases(i)%state_y, &
            cases(i)%state_r]
         ey = units(momentum_distance(real(y, qp), cases(i)%y_end), cond(1))
         eq = units(attitude_distance(real(q, qp), cases(i)%turn), cond(2))
         if (status /= poinsot_ok) ey = huge(ey)
         if (max(ey, eq) > max(worst_y, worst_q)) line = cases(i)%line
         worst_y = max(worst_y, ey)
         worst_q = max(worst_q, eq)
      end do
   end subroutine worst_of_kind

   !> Largest error of a method over hard random bodies of a kind against the Taylor series, in
   !> units of conditioning.
   subroutine worst_of_hard(name, kind, reach, count, worst_y, worst_q)
      character(*), intent(in) :: name, kind
      real(dp), intent(in) :: reach              !! largest h|omega|
      integer, intent(in) :: count
      real(dp), intent(out) :: worst_y, worst_q
      type(random_stream) :: stream
      type(random_body) :: body
      type(taylor_report) :: report
      real(qp) :: yt(3), qt(4)
      real(dp) :: c(4), ey, eq
      integer :: i, status
      stream = start_stream(17)
      worst_y = 0
      worst_q = 0
      do i = 1, count
         call hard_body(stream, kind, reach, body)
         call conditioning(body%moments, body%y, body%h, c(1), c(2), c(3), c(4))
         if (kind == "nearsym" .or. kind == "nearlinear" .or. kind == "linear") c(1:2) = c(3:4)
         yt = body%y
         qt = body%q/sqrt(sum(real(body%q, qp)**2))
         call taylor_flow(free_problem(body%moments), real(body%h, qp), yt, qt, report)
         call turn_body(name, body%moments, body%h, 1, body%y, body%q, status)
         ey = units(momentum_distance(real(body%y, qp), yt), c(1))
         eq = units(attitude_distance(real(body%q, qp), qt), c(2))
         if (status /= poinsot_ok) ey = huge(ey)
         worst_y = max(worst_y, ey)
         worst_q = max(worst_q, eq)
      end do
   end subroutine worst_of_hard

   !> Largest difference, in 1e-16, between one step of a method and its reference map over random
   !> bodies of a kind, h|omega| up to .95; infinite if one of the two has no answer.
   subroutine worst_of_map(name, kind, count, worst)
      character(*), intent(in) :: name, kind
      integer, intent(in) :: count
      real(dp), intent(out) :: worst
      type(random_stream) :: stream
      type(random_body) :: body
      type(reference_map) :: map
      real(qp) :: y(3), q(4)
      integer :: i, status
      logical :: ok
      stream = start_stream(11)
      worst = 0
      do i = 1, count
         call hard_body(stream, kind, 0.95_dp, body)
         call make_reference(name, body%moments, map)
         y = body%y
         q = body%q
         call map%apply(real(body%h, qp), y, q, ok)
         call turn_body(name, body%moments, body%h, 1, body%y, body%q, status)
         if (.not. ok .or. status /= poinsot_ok) worst = huge(worst)
         worst = max(worst, units(momentum_distance(real(body%y, qp), y), 1.0_dp))
         worst = max(worst, units(attitude_distance(real(body%q, qp), q), 1.0_dp))
      end do
   end subroutine worst_of_map

end module test_free_tools
