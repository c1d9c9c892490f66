!> One block of free bodies with the same moments, without plan or scene: for comparisons in which
!> moments need not be physical.
module poinsot_study_free_trial
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok
   use poinsot_body_class, only: body_class, make_class
   use poinsot_free_method, only: free_method, find_method, advance
   use poinsot_study_clock, only: processor_seconds
   implicit none(type, external)
   private
   public :: run_block

contains

   !> Turn up to `lanes` bodies by `steps` steps of h; unused lanes must be at rest.
   subroutine run_block(moments, method, h, steps, y, q, good, seconds, error)
      real(dp), intent(in) :: moments(3) !! positive, the largest may exceed the other two
      character(*), intent(in) :: method
      real(dp), intent(in) :: h
      integer(i8), intent(in) :: steps
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      logical, intent(out) :: good                    !! no body failed
      real(dp), intent(out) :: seconds                !! of the processor
      type(poinsot_error), intent(inout) :: error
      type(body_class) :: class
      type(free_method) :: rotor
      real(dp) :: carry(lanes, 7)
      integer :: status(lanes)
      integer(i8) :: k
      good = .false.
      seconds = 0
      call make_class(moments, class, error, physical=.false.)
      if (.not. raised(error)) call find_method(method, rotor, error)
      if (raised(error)) return
      status = poinsot_ok
      carry = 0
      seconds = processor_seconds()
      do k = 1, steps
         call advance(rotor, class, h, y, q, status, carry)
      end do
      seconds = processor_seconds() - seconds
      good = all(status == poinsot_ok)
   end subroutine run_block

end module poinsot_study_free_trial
