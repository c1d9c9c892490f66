!> One body advanced by the library's own kernels, for the studies.
module poinsot_study_turn
   use poinsot_core_kinds, only: dp, qp, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok
   use poinsot_body_class, only: body_class, make_class
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, set_option
   use poinsot_ensemble_step, only: drift_bodies
   use poinsot_free_method, only: free_method, find_method, advance
   implicit none(type, external)
   private
   public :: turn_one, turn_scaled, turn_by_moments, momentum_gap, attitude_gap

contains

   !> `steps` steps of one body. Status of the body, or of the refusing call.
   subroutine turn_one(name, moments, h, steps, y, q, status, compensated)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(3), q(4)
      integer, intent(out) :: status
      logical, intent(in), optional :: compensated !! sums with a carry, from 0
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: error
      real(dp) :: yb(lanes, 3), qb(lanes, 4), carry(lanes, 7)
      integer :: sb(lanes), i
      logical :: plain
      plain = .true.
      if (present(compensated)) plain = .not. compensated
      call find_method(trim(name), method, error)
      if (.not. raised(error)) call make_class(moments, class, error)
      status = error%code
      if (raised(error)) return
      yb = 0
      qb = 0
      qb(:, 1) = 1
      sb = poinsot_ok
      yb(1, :) = y
      qb(1, :) = q
      carry = 0
      do i = 1, steps
         if (plain) call advance(method, class, h, yb, qb, sb)
         if (.not. plain) call advance(method, class, h, yb, qb, sb, carry)
      end do
      y = yb(1, :)
      q = qb(1, :)
      status = sb(1)
   end subroutine turn_one

   !> The same body as one of a class by scale: moments s I over s h are I over h.
   subroutine turn_scaled(name, moments, scale, h, steps, y, q, status)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3), scale, h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(3), q(4)
      integer, intent(out) :: status
      type(poinsot_plan) :: plan
      type(poinsot_error) :: error
      real(dp), target :: s(1)
      integer :: number
      s = scale
      plan%threads = 1
      call add_class(plan, moments, number, error)
      call drift_one(plan, name, scale*h, steps, y, q, status, error, scale=s)
   end subroutine turn_scaled

   !> The same body by moments of its own.
   subroutine turn_by_moments(name, moments, h, steps, y, q, status, compensated)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(3), q(4)
      integer, intent(out) :: status
      logical, intent(in), optional :: compensated !! sums with a carry, from 0
      type(poinsot_plan) :: plan
      type(poinsot_error) :: error
      real(dp), target :: m(3, 1)
      plan%threads = 1
      m(:, 1) = moments
      call drift_one(plan, name, h, steps, y, q, status, error, compensated=compensated, moments=m)
   end subroutine turn_by_moments

   !> One body through a plan: its status, or that of the refusing call.
   subroutine drift_one(plan, name, h, steps, y, q, status, error, scale, moments, compensated)
      type(poinsot_plan), intent(inout), target :: plan
      character(*), intent(in) :: name
      real(dp), intent(in) :: h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(3), q(4)
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      real(dp), intent(in), target, optional :: scale(1), moments(3, 1)
      logical, intent(in), optional :: compensated
      type(body_view) :: view
      real(dp), target :: yy(3, 1), qq(4, 1), carry(7, 1)
      integer, target :: each(1)
      integer :: i
      yy(:, 1) = y
      qq(:, 1) = q
      each = poinsot_ok
      call view_rows(yy, qq, view)
      view%status => each
      carry = 0
      if (present(compensated)) then
         if (compensated) view%carry => carry
      end if
      if (present(scale)) view%scale => scale
      if (present(moments)) then
         do i = 1, 3
            view%moments(i)%of => moments(i, :)
         end do
      end if
      if (.not. raised(error)) call set_option(plan, "method", trim(name), error)
      if (.not. raised(error)) call make_ready(plan, error)
      do i = 1, steps
         if (raised(error) .or. each(1) /= poinsot_ok) exit
         call drift_bodies(plan, view, h, status, error)
      end do
      status = error%code
      if (.not. raised(error)) status = each(1)
      y = yy(:, 1)
      q = qq(:, 1)
   end subroutine drift_one

   !> |y - z|/|z|, or |y| if z = 0.
   pure real(dp) function momentum_gap(y, z)
      real(qp), intent(in) :: y(3), z(3)
      real(qp) :: size
      size = norm2(z)
      if (.not. size > 0) size = 1
      momentum_gap = real(norm2((y - z)/size), dp)
   end function momentum_gap

   !> min(|q - r|, |q + r|): the sign of a quaternion means nothing.
   pure real(dp) function attitude_gap(q, r)
      real(qp), intent(in) :: q(4), r(4)
      attitude_gap = real(min(norm2(q - r), norm2(q + r)), dp)
   end function attitude_gap

end module poinsot_study_turn
