!> One body through the library's own kernels, as the studies need it.
module poinsot_study_turn
   use poinsot_core_kinds, only: dp, qp, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok
   use poinsot_body_class, only: body_class, make_class
   use poinsot_free_method, only: free_method, find_method, advance
   implicit none(type, external)
   private
   public :: turn_one, momentum_gap, attitude_gap

contains

   !> `steps` steps of one body. Status of the body, or of the refusing call.
   subroutine turn_one(name, moments, h, steps, y, q, status)
      character(*), intent(in) :: name
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(3), q(4)
      integer, intent(out) :: status
      type(free_method) :: method
      type(body_class) :: class
      type(poinsot_error) :: error
      real(dp) :: yb(lanes, 3), qb(lanes, 4)
      integer :: sb(lanes), i
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
      do i = 1, steps
         call advance(method, class, h, yb, qb, sb)
      end do
      y = yb(1, :)
      q = qb(1, :)
      status = sb(1)
   end subroutine turn_one

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
