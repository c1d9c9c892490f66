!> From the caller's arrays into a block and back: `lanes` bodies of one class, checked, in native variables.
!>
!> A lane that is refused (not finite, not a unit quaternion, momentum about an axis without inertia) gets a status and stands
!> in the block at rest, so that it can do no harm; it is never written back.
module poinsot_ensemble_block
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain
   use poinsot_body_class, only: body_class
   use poinsot_ensemble_bodies, only: body_view, column
   use poinsot_ensemble_layout, only: to_native, from_native
   implicit none(type, external)
   private
   public :: block_state, load_block, store_block

   !> One block of bodies.
   type :: block_state
      integer :: n = 0                    !! bodies in it; the other lanes are padding at rest
      integer :: class = 1                !! their class
      integer :: at(lanes) = 1            !! where each stands in the caller's arrays
      real(dp) :: y(lanes, 3) = 0         !! angular momentum, principal frame
      real(dp) :: q(lanes, 4) = 0         !! attitude
      real(dp) :: carry(lanes, 7) = 0     !! compensated sums
      integer(i8) :: id(lanes) = 0        !! number for random streams
      integer :: status(lanes) = poinsot_ok
      logical :: compensated = .false.    !! the caller keeps a carry
   contains
      procedure :: refuse_values
   end type block_state

   real(dp), parameter :: norm_slack = 2e-6_dp   !! of |q|^2: |q| within 1e-6 of 1
   real(dp), parameter :: fastest = 1e70_dp      !! angular velocity, in the caller's unit
   real(dp), parameter :: axis_slack = 1e-12_dp  !! momentum about a zero moment, relative to |y|

   integer(i8), parameter :: exponent_bits = int(z'7FF0000000000000', i8)

contains

   !> Fill a block with n bodies of one class and check them.
   subroutine load_block(view, at, n, number, class, momentum, axes, b)
      type(body_view), intent(in) :: view
      integer, intent(in) :: n                     !! bodies, 1 to lanes
      integer, intent(in) :: at(n)                 !! their places
      integer, intent(in) :: number                !! their class
      type(body_class), intent(in) :: class
      integer, intent(in) :: momentum              !! the caller's momentum variable
      real(dp), intent(in) :: axes(4)              !! rotation from the principal frame to the caller's body frame
      type(block_state), intent(inout) :: b
      real(dp) :: p(lanes, 4)
      integer :: l

      b%n = n
      b%class = number
      b%at(1:n) = at
      p = 0
      b%q = 0
      b%q(:, 1) = 1
      call gather(view%y, 4, at, n, p)
      call gather(view%q, 4, at, n, b%q)
      b%status = poinsot_ok
      if (associated(view%id)) then
         do l = 1, n
            b%id(l) = view%id(at(l))
         end do
      else
         do l = 1, n
            b%id(l) = at(l) - 1
         end do
      end if
      b%compensated = associated(view%carry)
      if (b%compensated) then
         b%carry = 0
         do l = 1, n
            b%carry(l, :) = view%carry(:, at(l))
         end do
      end if
      call refuse(p, b%q, b%status)
      call to_native(momentum, axes, class, p, b%y, b%q)
      call refuse_speed(class, b)
      if (minval(class%inverse) <= 0) call refuse_axis(class, b)
   end subroutine load_block

   !> Copy columns at the given places into the first n lanes.
   pure subroutine gather(from, columns, at, n, into)
      integer, intent(in) :: columns, n, at(n)
      type(column), intent(in) :: from(columns)
      real(dp), intent(inout) :: into(lanes, columns)
      integer :: j, l
      do j = 1, columns
         if (.not. associated(from(j)%of)) cycle
         do l = 1, n
            into(l, j) = from(j)%of(at(l))
         end do
      end do
   end subroutine gather

   !> Put lanes at rest whose numbers are not finite or whose quaternion is not of unit norm. Bit tests first: a
   !> comparison with a NaN would raise an exception in hosts that trap.
   pure subroutine refuse(p, q, status)
      real(dp), intent(inout) :: p(lanes, 4), q(lanes, 4)
      integer, intent(inout) :: status(lanes)
      real(dp) :: good(lanes), qq
      integer :: l, j
      good = 1
      do j = 1, 4
         !GCC$ ivdep
         do l = 1, lanes
            good(l) = merge(good(l), 0.0_dp, iand(transfer(p(l, j), 1_i8), exponent_bits) /= exponent_bits)
            good(l) = merge(good(l), 0.0_dp, iand(transfer(q(l, j), 1_i8), exponent_bits) /= exponent_bits)
         end do
      end do
      do j = 1, 4
         !GCC$ ivdep
         do l = 1, lanes
            p(l, j) = merge(p(l, j), 0.0_dp, good(l) > 0)
            q(l, j) = merge(q(l, j), merge(1.0_dp, 0.0_dp, j == 1), good(l) > 0 .and. abs(q(l, j)) < 2)
         end do
      end do
      !GCC$ ivdep
      do l = 1, lanes
         qq = q(l, 1)**2 + q(l, 2)**2 + q(l, 3)**2 + q(l, 4)**2
         good(l) = merge(good(l), 0.0_dp, abs(qq - 1) <= norm_slack)
      end do
      if (minval(good) >= 1) return
      do l = 1, lanes
         if (good(l) < 1) then
            status(l) = poinsot_e_domain
            p(l, :) = 0
            q(l, :) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
         end if
      end do
   end subroutine refuse

   !> An angular velocity whose square would overflow is refused, by a comparison that cannot overflow itself.
   pure subroutine refuse_speed(class, b)
      type(body_class), intent(in) :: class
      type(block_state), intent(inout) :: b
      real(dp) :: limit(3), good(lanes)
      integer :: l
      limit = fastest*min(class%moments, 1e200_dp)
      where (.not. class%moments > 0) limit = huge(limit)
      !GCC$ ivdep
      do l = 1, lanes
         good(l) = merge(1.0_dp, 0.0_dp, abs(b%y(l, 1)) <= limit(1) .and. abs(b%y(l, 2)) <= limit(2) &
                         .and. abs(b%y(l, 3)) <= limit(3))
      end do
      if (minval(good) >= 1) return
      do l = 1, lanes
         if (good(l) >= 1) cycle
         b%status(l) = poinsot_e_domain
         b%y(l, :) = 0
      end do
   end subroutine refuse_speed

   !> Numbers that come with the bodies, a torque for instance: a lane where they are not finite fails, and gets zeros.
   pure subroutine refuse_values(b, values)
      class(block_state), intent(inout) :: b
      real(dp), intent(inout) :: values(:, :)   !! (lanes, components)
      integer :: l, j
      do j = 1, size(values, 2)
         do l = 1, lanes
            if (iand(transfer(values(l, j), 1_i8), exponent_bits) /= exponent_bits) cycle
            b%status(l) = poinsot_e_domain
            values(l, :) = 0
         end do
      end do
   end subroutine refuse_values

   !> Momentum about an axis without inertia is refused; what rounding leaves there is dropped.
   pure subroutine refuse_axis(class, b)
      type(body_class), intent(in) :: class
      type(block_state), intent(inout) :: b
      integer :: j, l
      do j = 1, 3
         if (class%inverse(j) > 0) cycle
         do l = 1, lanes
            if (abs(b%y(l, j)) > axis_slack*maxval(abs(b%y(l, :)))) then
               b%status(l) = poinsot_e_domain
               b%y(l, :) = 0
            end if
         end do
         b%y(:, j) = 0
      end do
   end subroutine refuse_axis

   !> Write back the bodies that did not fail, and every status. `keep_momentum`: a variable that free motion does not change
   !> (space-frame momentum) is left as it is, to the bit; so is `keep_attitude` by a kick.
   subroutine store_block(view, class, momentum, axes, keep_momentum, keep_attitude, b)
      type(body_view), intent(in) :: view
      type(body_class), intent(in) :: class
      integer, intent(in) :: momentum
      real(dp), intent(in) :: axes(4)
      logical, intent(in) :: keep_momentum, keep_attitude
      type(block_state), intent(inout) :: b
      real(dp) :: p(lanes, 4), q(lanes, 4)
      integer :: l, j
      logical :: all_good

      q = b%q
      call from_native(momentum, axes, class, b%y, q, p)
      all_good = all(b%status == poinsot_ok)
      if (associated(view%status)) then
         do l = 1, b%n
            view%status(b%at(l)) = b%status(l)
         end do
      end if
      do j = 1, 4
         if (keep_momentum .or. .not. associated(view%y(j)%of)) cycle
         do l = 1, b%n
            if (all_good .or. b%status(l) == poinsot_ok) view%y(j)%of(b%at(l)) = p(l, j)
         end do
      end do
      do j = 1, 4
         if (keep_attitude) exit
         do l = 1, b%n
            if (all_good .or. b%status(l) == poinsot_ok) view%q(j)%of(b%at(l)) = q(l, j)
         end do
      end do
      if (.not. associated(view%carry)) return
      do l = 1, b%n
         if (b%status(l) == poinsot_ok) view%carry(:, b%at(l)) = b%carry(l, :)
      end do
   end subroutine store_block

end module poinsot_ensemble_block
