!> Steps of a block by Taylor series.
module poinsot_ensemble_taylor
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_status, only: poinsot_ok
   use poinsot_body_class, only: body_class
   use poinsot_effect_terms, only: torque_terms
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_splitting_block_flows, only: block_flows
   use poinsot_taylor_integrate, only: integrate
   use poinsot_taylor_problem, only: taylor_problem, make_problem, collect_terms
   use poinsot_taylor_settings, only: taylor_time
   implicit none(type, external)
   private
   public :: run_taylor

contains

   !> Steps of all bodies of a block: of one class, or, where they have scales, for each scale.
   subroutine run_taylor(plan, time, b)
      type(poinsot_plan), intent(in) :: plan     !! of splitting `taylor`
      type(taylor_time), intent(in) :: time
      type(block_flows), intent(inout) :: b
      type(taylor_problem) :: problem
      real(dp) :: scale
      logical :: left(lanes)
      integer :: l
      if (.not. associated(b%by_lane)) then
         call run_some(plan, plan%taylor(b%number), time, spread(.true., 1, b%n), b)
         return
      end if
      left = b%status == poinsot_ok
      do l = 1, b%n
         if (.not. left(l)) cycle
         scale = b%by_lane%scale(l)
         call make_scaled(plan, b, l, problem)
         call run_some(plan, problem, time, left(:b%n) .and. &
            .not. abs(b%by_lane%scale(:b%n) - scale) > 0, b)
         where (.not. abs(b%by_lane%scale - scale) > 0) left = .false.
      end do
   end subroutine run_taylor

   !> The problem of a body whose moments are so many times those of its class.
   subroutine make_scaled(plan, b, l, problem)
      type(poinsot_plan), intent(in) :: plan
      type(block_flows), intent(in) :: b
      integer, intent(in) :: l                   !! its lane
      type(taylor_problem), intent(out) :: problem
      type(body_class) :: scaled
      type(torque_terms) :: terms
      type(poinsot_error) :: error
      scaled = b%class
      scaled%moments = b%by_lane%moments(l, :)
      scaled%inverse = b%by_lane%inverse(l, :)
      scaled%limit = b%by_lane%limit(l, :)
      associate (flows => plan%composed(plan%composition(b%number)))
         call collect_terms(scaled, [flows%torques, flows%dissipative], plan%effects, terms, error)
      end associate
      if (.not. raised(error)) call make_problem(scaled, terms, problem) ! it was, for the class
   end subroutine make_scaled

   !> Steps of some bodies of a block.
   subroutine run_some(plan, problem, time, which, b)
      type(poinsot_plan), intent(in) :: plan
      type(taylor_problem), intent(in) :: problem
      type(taylor_time), intent(in) :: time
      logical, intent(in) :: which(:)
      type(block_flows), intent(inout) :: b
      real(dp) :: y(3, lanes), q(4, lanes), carry(7, lanes)
      integer :: status(lanes), from(lanes), n, l
      n = 0
      do l = 1, size(which)
         if (.not. which(l)) cycle
         n = n + 1
         from(n) = l
         y(:, n) = b%y(l, :)
         q(:, n) = b%q(l, :)
         if (b%compensated) carry(:, n) = b%carry(l, :)
         status(n) = b%status(l)
      end do
      call integrate(problem, plan%orders, time, b%compensated, n, y, q, carry, status)
      do l = 1, n
         b%y(from(l), :) = y(:, l)
         b%q(from(l), :) = q(:, l)
         if (b%compensated) b%carry(from(l), :) = carry(:, l)
         b%status(from(l)) = status(l)
      end do
   end subroutine run_some

end module poinsot_ensemble_taylor
