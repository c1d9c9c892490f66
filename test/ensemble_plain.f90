!> The short way for plain views gives what the long way does, to the bit and to the status: the
!> long way is taken where classes are named.
module test_ensemble_plain
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan
   use testdrive, only: unittest_type, new_unittest, error_type
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_partial
   use poinsot_ensemble_bodies, only: body_view, column, view_columns, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_layout, only: conjugate_momentum, momentum_names
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, set_option
   use poinsot_ensemble_step, only: drift_bodies, kick_bodies, step_bodies
   use test_bodies, only: random_quaternion, random_stream, start_stream, uniform
   use test_crowd, only: same_bits
   use test_expectation, only: expect
   implicit none(type, external)
   private
   public :: collect_plain

   real(dp), parameter :: h = 0.03_dp
   integer, parameter :: most = 100                !! bodies: blocks full and not
   integer, parameter :: of_class = 0, scaled = 1, own = 2 !! whence moments come
   integer, parameter :: linear = 50               !! the only body without inertia about an axis

   !> What a view points to.
   type :: state
      real(dp) :: y(4, most), q(4, most), columns_y(most, 4), columns_q(most, 4), scale(most)
      real(dp) :: moments(4, most), columns_moments(most, 4)
      integer :: class(most), status(most)
   end type state

contains

   subroutine collect_plain(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("short-way-drifts-alike", test_drift), &
         new_unittest("short-way-steps-alike", test_step), &
         new_unittest("short-way-kicks-alike", test_kick)]
   end subroutine collect_plain

   subroutine test_drift(error)
      type(error_type), allocatable, intent(out) :: error
      call compare(error, "drift")
   end subroutine test_drift

   subroutine test_step(error)
      type(error_type), allocatable, intent(out) :: error
      call compare(error, "step")
   end subroutine test_step

   subroutine test_kick(error)
      type(error_type), allocatable, intent(out) :: error
      call compare(error, "kick")
   end subroutine test_kick

   !> Every momentum variable, frame of torques, and number of bodies; rows, columns, rows with
   !> gaps; moments of the class, times a scale, and of each body; whole, and with bodies that fail.
   subroutine compare(error, what)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: what
      type(poinsot_plan), target :: plan
      integer :: v, n, frame
      logical :: ill
      do v = 1, size(momentum_names)
         do frame = 0, merge(1, 0, what == "kick")
            call make_plan(momentum_names(v), frame == 1, plan)
            do n = 1, most, merge(1, 13, v <= 2)
               ill = mod(n, 3) == 0
               call compare_one(error, what, plan, n, mod(n/2, 3), ill, trim(momentum_names(v)))
               if (allocated(error)) return
            end do
         end do
      end do
   end subroutine compare

   subroutine make_plan(momentum, space, plan)
      character(*), intent(in) :: momentum
      logical, intent(in) :: space                 !! torques in space
      type(poinsot_plan), intent(out) :: plan
      type(poinsot_error) :: error
      integer :: number
      call add_class(plan, [0.8_dp, 0.5_dp, 1.1_dp], number, error)
      call set_option(plan, "momentum", trim(momentum), error)
      if (space) call set_option(plan, "frame", "space", error)
      call make_ready(plan, error)
      if (raised(error)) error stop "make_plan"
   end subroutine make_plan

   subroutine compare_one(error, what, plan, n, kind, ill, name)
      type(error_type), allocatable, intent(out) :: error
      character(*), intent(in) :: what, name
      type(poinsot_plan), intent(in), target :: plan
      integer, intent(in) :: n, kind
      logical, intent(in) :: ill
      type(state), target :: short, long
      character(90) :: text
      integer :: order, answers(2)
      do order = 1, 3
         call make_state(plan%momentum, n, ill, short)
         long = short
         answers(1) = act(what, plan, n, kind, .false., order, short)
         answers(2) = act(what, plan, n, kind, .true., order, long)
         write (text, "(4a, 3(i0, a))") what, ", ", name, ", n = ", n, ", order ", order, &
            ", moments ", kind
         call expect(error, answers(1), merge(poinsot_e_partial, poinsot_ok, ill), &
                     trim(text)//": the call")
         call expect(error, answers(1) == answers(2) .and. &
                     all(short%status(:n) == long%status(:n)), trim(text)//": statuses")
         call expect(error, same_bits(short%y, long%y) .and. same_bits(short%q, long%q) .and. &
                     same_bits(short%columns_y, long%columns_y) .and. &
                     same_bits(short%columns_q, long%columns_q), trim(text)//": bits")
         if (allocated(error)) return
      end do
   end subroutine compare_one

   !> Bodies, every fifth of them ill if they may be.
   subroutine make_state(momentum, n, ill, s)
      integer, intent(in) :: momentum, n
      logical, intent(in) :: ill
      type(state), intent(out) :: s
      type(random_stream) :: stream
      integer :: i, j
      stream = start_stream(11)
      s%class = 1
      s%status = -7
      do i = 1, most
         do j = 1, 4
            s%y(j, i) = 2*uniform(stream) - 1
         end do
         s%q(:, i) = random_quaternion(stream)
         s%scale(i) = 0.5_dp + 3*uniform(stream)
         s%moments(4, i) = 0
         s%moments(:3, i) = cshift([0.8_dp, 0.5_dp, 1.1_dp] + 0.1_dp*uniform(stream), mod(i, 3))
         if (i == linear) then ! which no momentum variable turns about the axis without inertia
            s%moments(:3, i) = [0.0_dp, 0.7_dp, 0.7_dp]
            s%y(:, i) = 0
         end if
         if (.not. ill .or. i > n .or. mod(i, 5) /= mod(n, 5)) cycle
         if (mod(i, 2) == 0) s%y(2, i) = ieee_value(0.0_dp, ieee_quiet_nan)
         if (mod(i, 2) == 1) s%q(:, i) = 2*s%q(:, i)
         if (mod(i, 3) == 0) s%moments(2, i) = -1
         if (mod(i, 3) == 1) s%moments(3, i) = ieee_value(0.0_dp, ieee_quiet_nan)
      end do
      if (momentum /= conjugate_momentum) s%y(4, :) = 0
      s%columns_y = transpose(s%y)
      s%columns_q = transpose(s%q)
      s%columns_moments = transpose(s%moments)
   end subroutine make_state

   !> One call, and its status.
   integer function act(what, plan, n, kind, named, order, s) result(status)
      character(*), intent(in) :: what
      type(poinsot_plan), intent(in), target :: plan
      integer, intent(in) :: n, kind, order
      logical, intent(in) :: named
      type(state), intent(inout), target :: s
      type(body_view) :: view
      type(column) :: torque(3)
      type(poinsot_error) :: error
      real(dp), target :: tight(3, most), tight_moments(3, most), g(4, most)
      integer :: j
      tight_moments = s%moments(:3, :)
      if (plan%momentum /= conjugate_momentum) tight = s%y(:3, :)
      if (order == 1) then
         if (plan%momentum == conjugate_momentum) call view_rows(s%y(:, :n), s%q(:, :n), view)
         if (plan%momentum /= conjugate_momentum) call view_rows(tight(:, :n), s%q(:, :n), view)
      else if (order == 2) then
         call view_columns(s%columns_y(:n, :), s%columns_q(:n, :), view)
      else
         call view_rows(s%y(:, :n), s%q(:, :n), view)
      end if
      view%status => s%status(:n)
      if (named) view%body_class => s%class(:n)
      if (kind == scaled) view%scale => s%scale(:n)
      do j = 1, merge(3, 0, kind == own)
         if (order == 1) view%moments(j)%of => tight_moments(j, :n)
         if (order == 2) view%moments(j)%of => s%columns_moments(:n, j)
         if (order == 3) view%moments(j)%of => s%moments(j, :n)
      end do
      g = reshape([(0.01_dp*mod(37*j, 101) - 0.4_dp, j=1, 4*most)], [4, most])
      do j = 1, 3
         torque(j)%of => g(j, :n)
      end do
      select case (what)
      case ("drift")
         call drift_bodies(plan, view, h, status, error)
      case ("kick")
         call kick_bodies(plan, view, h, torque, status, error)
      case default
         call step_bodies(plan, view, 0.0_dp, h, 0_i8, 3_i8, status, error)
      end select
      if (plan%momentum /= conjugate_momentum .and. order == 1) s%y(:3, :) = tight
   end function act

end module test_ensemble_plain
