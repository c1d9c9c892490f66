!> Methods of free rotation: their registry, and one step of a block by any of them.
!>
!> A new method is one kernel in a file of its own, one row of `rows`, anywhere in it and with the
!> next free number, and for a new kernel its line in `attach`. Users see rows in their order,
!> programs by number.
module poinsot_free_method
   use poinsot_core_kinds, only: dp, i8, group, groups, lanes, name_length
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_core_lanes, only: any_failed
   use poinsot_core_message, only: printable
   use poinsot_core_nearest, only: known_names
   use poinsot_core_status, only: poinsot_ok, poinsot_e_method, poinsot_e_step
   use poinsot_body_class, only: body_class
   use poinsot_free_accumulate, only: add_plain, add_compensated, conserve
   use poinsot_free_exact, only: exact_increment, exact_step
   use poinsot_free_jacobi_solution, only: jacobi_increment
   use poinsot_free_moser_veselov, only: moser_veselov_increment, midpoint_increment
   use poinsot_free_rattle, only: rattle_increment
   use poinsot_free_split_rotations, only: three_rotations_increment, symmetric_rotation_increment
   implicit none(type, external)
   private
   public :: free_method, find_method, method_names, method_count, method_name
   public :: numbered_methods, numbered_method_count, numbered_method
   public :: advance, advance_lanes

   abstract interface
      !> A kernel: the increments of y and q of a block over h. A lane with h = 0 gets zeros; a lane
      !> that fails gets a status. Written so that a lane's bits depend on that lane alone: lanes
      !> behind the first 8 nvec are neither read nor given a status.
      pure subroutine increment_kernel(nvec, class, terms, h, y, q, dy, dq, status)
         import :: dp, lanes, body_class
         implicit none(type, external)
         integer, intent(in) :: nvec                !! groups of lanes to work on
         type(body_class), intent(in) :: class      !! constants of the body class
         !> terms of the preprocessing series, where there is one
         integer, intent(in) :: terms
         real(dp), intent(in) :: h(lanes)           !! step of each lane, either sign
         !> angular momentum, principal frame, caller's axes
         real(dp), intent(in) :: y(lanes, 3)
         real(dp), intent(in) :: q(lanes, 4)        !! attitude, unit quaternion, scalar first
         real(dp), intent(out) :: dy(lanes, 3)      !! y(h) - y
         real(dp), intent(out) :: dq(lanes, 4)      !! q(h) - q
         integer, intent(inout) :: status(lanes)    !! set where a lane fails
      end subroutine increment_kernel

      !> The same from state to state with plain sums, |q| drawn to 1, where a method does that in
      !> one go. A lane with h = 0 keeps its bits.
      pure subroutine step_kernel(nvec, class, terms, h, y, q, status)
         import :: dp, lanes, body_class
         implicit none(type, external)
         integer, intent(in) :: nvec
         type(body_class), intent(in) :: class
         integer, intent(in) :: terms
         real(dp), intent(in) :: h(lanes)
         real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
         integer, intent(inout) :: status(lanes)
      end subroutine step_kernel
   end interface

   !> A free method: its properties, and its kernel.
   type :: free_method
      character(name_length) :: name = ""
      integer :: number = 0                        !! the public one: never another's
      character(name_length) :: kernel = ""        !! the family of maps it is one of
      integer :: order = 0                         !! order of accuracy; 0: exact
      integer :: terms = 0                         !! terms of the preprocessing series
      logical :: conserves_energy = .true.         !! up to rounding
      logical :: fixed_axes = .false.              !! another map if the axes come in another order
      character(7) :: heading = ""                 !! of its column in tables; "": it has none
      character(64) :: about = ""                  !! one line for people
      procedure(increment_kernel), pointer, nopass :: increment => null()
      procedure(step_kernel), pointer, nopass :: step => null() !! plain sums in one go, if there is
      real(dp) :: ns = 7                           !! about what a body and a step take, in
                                                   !! nanoseconds: for the choice of threads
   end type free_method

   real(dp), parameter :: far = 1e70_dp !! beyond, h is looked at before it is multiplied

   !> A method as it is written down.
   type :: method_row
      character(name_length) :: name
      integer :: number
      character(name_length) :: kernel
      integer :: order
      character(7) :: heading
      character(64) :: about
      integer :: terms = 0
      logical :: conserves_energy = .true.
      logical :: fixed_axes = .false.
      real(dp) :: ns = 7
   end type method_row

   character(*), parameter :: dmv = "moser-veselov"
   character(*), parameter :: preprocessed = "discrete Moser-Veselov map, preprocessed"
   type(method_row), parameter :: rows(*) = [ &
      method_row("exact", 1, "exact", 0, "exact", &
         "explicit exact step; substeps and Jacobi's functions by itself", ns=5.0_dp), &
      method_row("jacobi", 2, "jacobi", 0, "jacobi", "Jacobi's elliptic functions, any step", &
         ns=20.0_dp), &
      method_row("dmv2", 3, dmv, 2, "dmv2", "discrete Moser-Veselov map, plain"), &
      method_row("dmv4", 4, dmv, 4, "dmv4", preprocessed, 1), &
      method_row("dmv6", 5, dmv, 6, "", preprocessed, 2), &
      method_row("dmv8", 6, dmv, 8, "dmv8", preprocessed, 3), &
      method_row("dmv10", 7, dmv, 10, "", preprocessed, 4), &
      method_row("dmv12", 8, dmv, 12, "", preprocessed, 5), &
      method_row("dmv14", 9, dmv, 14, "", preprocessed, 6), &
      method_row("dmv16", 10, dmv, 16, "dmv16", preprocessed, 7), &
      method_row("dmv18", 11, dmv, 18, "", preprocessed, 8), &
      method_row("dmv20", 12, dmv, 20, "", preprocessed, 9), &
      method_row("dmv22", 13, dmv, 22, "", preprocessed, 10), &
      method_row("dmv24", 14, dmv, 24, "dmv24", preprocessed, 11), &
      method_row("midpoint", 15, "midpoint", 2, "midpnt", "implicit midpoint rule"), &
      method_row("three-rotations", 16, "three-rotations", 2, "three", &
         "splitting into rotations about the axes, 3-2-1-2-3", &
         conserves_energy=.false., fixed_axes=.true.), &
      method_row("symmetric-rotation", 17, "symmetric-rotation", 2, "symrot", &
         "splitting into a symmetric body and a rotation", &
         conserves_energy=.false., fixed_axes=.true.), &
      method_row("rattle", 18, "rattle", 2, "rattle", &
         "RATTLE in the matrices (P, Q); the map of dmv2", ns=100.0_dp)]

   integer :: k !! of the tables only
   !> Names in the order of the rows.
   character(name_length), parameter :: method_names(*) = rows%name
   !> Names by public number; "" where a number is not given.
   character(name_length), parameter :: numbered_methods(*) = &
      [(merge(rows(max(1, findloc(rows%number, k, dim=1)))%name, repeat(" ", name_length), &
              any(rows%number == k)), k=1, maxval(rows%number))]

contains

   !> Number of methods.
   pure integer function method_count()
      method_count = size(rows)
   end function method_count

   !> Name of the method in row i, 1 <= i <= method_count(), as people see them listed; empty
   !> beyond.
   pure function method_name(i) result(name)
      integer, intent(in) :: i
      character(:), allocatable :: name
      name = ""
      if (i >= 1 .and. i <= size(rows)) name = trim(method_names(i))
   end function method_name

   !> The highest public number of a method.
   pure integer function numbered_method_count()
      numbered_method_count = size(numbered_methods)
   end function numbered_method_count

   !> Name of the method of public number i, from 1; "" for an unused number.
   pure function numbered_method(i) result(name)
      integer, intent(in) :: i
      character(:), allocatable :: name
      name = ""
      if (i >= 1 .and. i <= size(numbered_methods)) name = trim(numbered_methods(i))
   end function numbered_method

   !> Method by name. POINSOT_E_METHOD for an unknown one, with the list of known ones.
   pure subroutine find_method(name, method, error)
      character(*), intent(in) :: name
      type(free_method), intent(out) :: method
      type(poinsot_error), intent(inout) :: error
      character(name_length) :: wanted
      integer :: i
      wanted = name ! texts of one length are compared at once
      if (len_trim(name) > name_length) wanted = ""
      do i = 1, size(rows)
         if (method_names(i) /= wanted) cycle
         call take_row(i, method)
         if (associated(method%increment)) return
      end do
      call raise(error, poinsot_e_method, "unknown method '"//printable(trim(name))//"'"// &
         known_names(method_names))
   end subroutine find_method

   pure subroutine take_row(i, method)
      integer, intent(in) :: i
      type(free_method), intent(inout) :: method
      method%name = rows(i)%name
      method%number = rows(i)%number
      method%kernel = rows(i)%kernel
      method%order = rows(i)%order
      method%terms = rows(i)%terms
      method%conserves_energy = rows(i)%conserves_energy
      method%fixed_axes = rows(i)%fixed_axes
      method%heading = rows(i)%heading
      method%about = rows(i)%about
      method%ns = rows(i)%ns
      call attach(method)
   end subroutine take_row

   !> The procedures of a kernel.
   pure subroutine attach(method)
      type(free_method), intent(inout) :: method
      select case (method%kernel)
      case ("exact")
         method%increment => exact_increment
         method%step => exact_step
      case ("jacobi")
         method%increment => jacobi_increment
      case (dmv)
         method%increment => moser_veselov_increment
      case ("midpoint")
         method%increment => midpoint_increment
      case ("three-rotations")
         method%increment => three_rotations_increment
      case ("symmetric-rotation")
         method%increment => symmetric_rotation_increment
      case ("rattle")
         method%increment => rattle_increment
      case default ! a row whose kernel is not here is no method
         nullify (method%increment)
      end select
   end subroutine attach

   !> One step h, either sign, of a block. A lane whose status is not POINSOT_OK stands still; a
   !> lane that fails here gets its status and keeps its state. With `nvec` the first 8 nvec lanes
   !> only, with the same bits.
   pure subroutine advance(method, class, h, y, q, status, carry, nvec)
      type(free_method), intent(in) :: method
      type(body_class), intent(in) :: class                  !! of these bodies
      real(dp), intent(in) :: h                              !! step
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)    !! the state
      integer, intent(inout) :: status(lanes)
      real(dp), intent(inout), optional :: carry(lanes, 7)   !! compensated sums, if wanted
      integer, intent(in), optional :: nvec                  !! groups of lanes to work on
      real(dp) :: hl(lanes)
      integer :: used, n, l
      used = groups
      if (present(nvec)) used = nvec
      n = iand(group*used, not(group - 1)) ! says to the compiler that no lane is left over
      do l = 1, n
         hl(l) = merge(h, 0.0_dp, status(l) == poinsot_ok)
      end do
      if (abs(h) > far) call reject_far(used, class, y, hl, status)
      if (associated(method%step) .and. .not. present(carry)) then
         call method%step(used, class, method%terms, hl, y, q, status)
         return
      end if
      call advance_by_increments(method, class, hl, y, q, status, used, carry)
   end subroutine advance

   !> The same with a step for each lane: bodies of one shape and different sizes (moments scale I
   !> over h are moments I over h/scale, mathematics, section 3), or a time of their own.
   pure subroutine advance_lanes(method, class, h, y, q, status, nvec, carry)
      type(free_method), intent(in) :: method
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h(lanes)                       !! step of each lane
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      integer, intent(inout) :: status(lanes)
      integer, intent(in) :: nvec                            !! groups of lanes to work on
      real(dp), intent(inout), optional :: carry(lanes, 7)
      real(dp) :: hl(lanes)
      integer(i8) :: most
      integer :: n, l
      n = iand(group*nvec, not(group - 1))
      most = 0
      do l = 1, n
         hl(l) = merge(h(l), 0.0_dp, status(l) == poinsot_ok)
         most = max(most, transfer(abs(hl(l)), most)) ! bits compare like the numbers
      end do
      if (most > transfer(far, most)) call reject_far(nvec, class, y, hl, status)
      if (associated(method%step) .and. .not. present(carry)) then
         call method%step(nvec, class, method%terms, hl, y, q, status)
         return
      end if
      call advance_by_increments(method, class, hl, y, q, status, nvec, carry)
   end subroutine advance_lanes

   !> The step by increments, lanes that stand still having h = 0.
   pure subroutine advance_by_increments(method, class, h, y, q, status, nvec, carry)
      type(free_method), intent(in) :: method
      type(body_class), intent(in) :: class
      real(dp), intent(inout) :: h(lanes)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      integer, intent(inout) :: status(lanes)
      integer, intent(in) :: nvec
      real(dp), intent(inout), optional :: carry(lanes, 7)
      real(dp) :: dy(lanes, 3), dq(lanes, 4)

      call method%increment(nvec, class, method%terms, h, y, q, dy, dq, status)
      if (any_failed(status, nvec)) then
         call stop_failed(nvec, status, h)
         call drop_failed(nvec, status, dy, dq)
      end if
      if (present(carry)) then
         call conserve(class, method%conserves_energy, h, y, dy, carry, nvec)
         call add_compensated(h, dy, dq, y, q, carry, nvec)
      else
         call add_plain(h, dy, dq, y, q, nvec)
      end if
   end subroutine advance_by_increments

   !> h = 0 where a lane has failed.
   pure subroutine stop_failed(nvec, status, h)
      integer, intent(in) :: nvec, status(lanes)
      real(dp), intent(inout) :: h(lanes)
      where (status(:group*nvec) /= poinsot_ok) h(:group*nvec) = 0
   end subroutine stop_failed

   !> No increment where a lane has failed.
   pure subroutine drop_failed(nvec, status, dy, dq)
      integer, intent(in) :: nvec, status(lanes)
      real(dp), intent(inout) :: dy(lanes, 3), dq(lanes, 4)
      integer :: l
      do l = 1, group*nvec
         if (status(l) == poinsot_ok) cycle
         dy(l, :) = 0
         dq(l, :) = 0
      end do
   end subroutine drop_failed

   !> A step so long that its rotation would overflow: POINSOT_E_STEP. Exponents are compared,
   !> nothing is multiplied.
   pure subroutine reject_far(nvec, class, y, h, status)
      integer, intent(in) :: nvec
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: y(lanes, 3)
      real(dp), intent(inout) :: h(lanes)
      integer, intent(inout) :: status(lanes)
      integer :: l, j
      do j = 1, 3
         if (.not. class%inverse(j) > 0) cycle
         do l = 1, group*nvec
            if (.not. abs(y(l, j)) > 0 .or. .not. abs(h(l)) > far) cycle
            if (exponent(y(l, j)) + exponent(class%inverse(j)) + exponent(h(l)) &
                < exponent(far)) cycle
            status(l) = poinsot_e_step
            h(l) = 0
         end do
      end do
   end subroutine reject_far

end module poinsot_free_method
