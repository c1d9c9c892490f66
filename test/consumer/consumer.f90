! A program outside the tree: the installed .mod files and library serve a Fortran host that has a
! `dp`, an `i8`, a `clear` and a `raised` of its own, and an effect of its own.
module host_kinds
   implicit none(type, external)
   public
   integer, parameter :: dp = kind(1.0d0), i8 = selected_int_kind(18)
contains
   pure subroutine clear(x)
      real(dp), intent(out) :: x
      x = 0
   end subroutine clear
   pure logical function raised(x)
      real(dp), intent(in) :: x
      raised = x > 0
   end function raised
end module host_kinds

module host_effect
   use host_kinds, only: dp
   use poinsot, only: poinsot_user_potential
   implicit none(type, external)
   private
   public :: pendulum

   !> U = weight Q33: gravity on a body whose centre lies at distance 1 on axis 3.
   type, extends(poinsot_user_potential) :: pendulum
      real(dp) :: weight = 1
   contains
      procedure :: evaluate
   end type pendulum

contains

   subroutine evaluate(self, t, attitude, energy, gradient)
      class(pendulum), intent(in) :: self
      real(dp), intent(in) :: t, attitude(3, 3)
      real(dp), intent(out) :: energy, gradient(3, 3)
      energy = self%weight*attitude(3, 3) + 0*t
      gradient = 0
      gradient(3, 3) = self%weight
   end subroutine evaluate

end module host_effect

program consumer
   ! allow(C121): bare, as hosts do it
   use host_kinds
   use host_effect, only: pendulum
   ! allow(C121)
   use poinsot
   implicit none(type, external)
   type(poinsot_error) :: error
   real(dp) :: own, by_name
   if (poinsot_version < 100 .or. poinsot_status_text(poinsot_ok) /= "ok") error stop "no version"
   call clear(own)
   if (raised(own)) error stop "not the host's own"
   call turn(.true., own, error)
   call turn(.false., by_name, error)
   if (error%raised()) error stop error%message
   if (abs(own - by_name) > 1e-14_dp .or. own <= 0) error stop "an effect of the host's own"
   call error%clear()
   call turn(.false., own, error, "centre = none")
   if (.not. error%raised()) error stop "not refused"
   call error%clear()
   if (error%raised()) error stop "not cleared"
   print '(a)', "consumer: ok"

contains

   !> |y| after ten steps under gravity, the host's own or poinsot's.
   subroutine turn(own_effect, length, error, settings)
      logical, intent(in) :: own_effect
      real(dp), intent(out) :: length
      type(poinsot_error), intent(inout) :: error
      character(*), intent(in), optional :: settings
      class(poinsot_effect), allocatable :: effect
      type(poinsot_plan) :: plan
      type(poinsot_bodies) :: bodies
      real(dp), target :: y(3, 1), q(4, 1)
      integer :: number
      y = reshape([0.3_dp, 0.0_dp, 0.4_dp], [3, 1])
      q = reshape([0.8_dp, 0.6_dp, 0.0_dp, 0.0_dp], [4, 1])
      length = 0
      if (error%raised()) return
      call poinsot_plan_add_class(plan, [0.6_dp, 0.8_dp, 1.0_dp], number, error)
      if (error%raised()) return
      if (own_effect) then
         allocate (pendulum :: effect)
         call poinsot_plan_add_effect(plan, effect, error)
      else if (present(settings)) then
         call poinsot_plan_add_effect(plan, "gravity", settings, error)
      else
         call poinsot_plan_add_effect(plan, "gravity", "centre = 0, 0, 1", error)
      end if
      if (.not. error%raised()) call poinsot_plan_ready(plan, error)
      if (.not. error%raised()) call poinsot_bodies_rows(bodies, y, q, error)
      if (.not. error%raised()) call poinsot_step(plan, bodies, 0.0_dp, 0.1_dp, 0_i8, 10_i8, error)
      length = norm2(y)
   end subroutine turn

end program consumer
