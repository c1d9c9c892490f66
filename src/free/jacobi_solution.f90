!> PLACEHOLDER until the elliptic helper's room arrives
module poinsot_free_jacobi_solution
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_status, only: poinsot_e_step
   use poinsot_body_class, only: body_class
   implicit none(type, external)
   private
   public :: jacobi_increment
contains
   pure subroutine jacobi_increment(class, terms, h, y, q, dy, dq, status)
      type(body_class), intent(in) :: class
      integer, intent(in) :: terms
      real(dp), intent(in) :: h(lanes), y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: dy(lanes, 3), dq(lanes, 4)
      integer, intent(inout) :: status(lanes)
      dy = 0; dq = 0
      where (abs(h) > 0) status = poinsot_e_step
   end subroutine jacobi_increment
end module poinsot_free_jacobi_solution
