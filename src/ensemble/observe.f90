!> Observables of an ensemble: energies, momentum, degrees of freedom. Body by body, so that sums do
!> not depend on threads.
module poinsot_ensemble_observe
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_size
   use poinsot_body_invariants, only: degrees_of_freedom
   use poinsot_body_moments, only: accept_moments
   use poinsot_ensemble_block, only: reject_energies
   use poinsot_ensemble_bodies, only: body_view
   use poinsot_ensemble_check, only: check_ready, check_purpose, to_kick, to_observe
   use poinsot_ensemble_coupled, only: coupled_energy
   use poinsot_ensemble_block, only: clock
   use poinsot_ensemble_drive, only: block_job, for_each_block
   use poinsot_ensemble_layout, only: from_native, space_momentum
   use poinsot_ensemble_compose, only: attach_plan
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_ensemble_rotate, only: check_step
   use poinsot_splitting_block_flows, only: block_flows
   implicit none(type, external)
   private
   public :: body_energies, body_momenta, total_degrees_of_freedom

   !> Energies of the bodies of a block.
   type, extends(block_job) :: energy_job
      real(dp) :: t = 0
      real(dp), pointer :: kinetic(:) => null(), potential(:) => null()
   contains
      procedure :: run => run_energy
   end type energy_job

   !> Angular momenta in the space frame.
   type, extends(block_job) :: momentum_job
      real(dp), pointer :: momentum(:, :) => null()
   contains
      procedure :: run => run_momentum
   end type momentum_job

contains

   !> Kinetic and potential energy of each body at time t; what two bodies have together is shared
   !> between them. A body that is refused has a status and zero energies.
   subroutine body_energies(plan, view, t, kinetic, potential, status, error)
      type(poinsot_plan), intent(in), target :: plan              !! ready
      type(body_view), intent(in) :: view                         !! the caller's arrays
      real(dp), intent(in) :: t                                   !! time
      real(dp), intent(out), target :: kinetic(:), potential(:)   !! (n)
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      type(energy_job) :: job
      kinetic = 0
      potential = 0
      call check_ready(plan, view, error)
      if (.not. raised(error)) call check_purpose(plan, view, to_observe, error)
      if (.not. raised(error)) call check_step(t, 1, error, "time t")
      if (.not. raised(error) .and. (size(kinetic) < view%n .or. size(potential) < view%n)) then
         call raise(error, poinsot_e_size, &
            "energies: the arrays are shorter than the number of bodies")
      end if
      status = error%code
      if (raised(error)) return
      if (plan%coupled) then
         call coupled_energy(plan, view, t, kinetic, potential, status, error)
         return
      end if
      job%plan => plan
      job%read_only = .true.
      job%t = t
      job%loaded = clock(t, 0.0_dp)
      job%kinetic => kinetic
      job%potential => potential
      status = for_each_block(view, plan%threads, job)
   end subroutine body_energies

   !> Angular momentum of each body in the space frame, (3, n).
   subroutine body_momenta(plan, view, momentum, status, error)
      type(poinsot_plan), intent(in), target :: plan !! ready
      type(body_view), intent(in) :: view    !! the caller's arrays
      real(dp), intent(out), target :: momentum(:, :)
      integer, intent(out) :: status
      type(poinsot_error), intent(inout) :: error
      type(momentum_job) :: job
      momentum = 0
      call check_ready(plan, view, error)
      if (.not. raised(error)) call check_purpose(plan, view, to_kick, error)
      if (.not. raised(error) .and. (size(momentum, 1) < 3 .or. size(momentum, 2) < view%n)) then
         call raise(error, poinsot_e_size, "momenta: the array is not (3, n)")
      end if
      status = error%code
      if (raised(error)) return
      job%plan => plan
      job%read_only = .true.
      job%momentum => momentum
      status = for_each_block(view, plan%threads, job)
   end subroutine body_momenta

   !> Rotational degrees of freedom of all bodies: an axis without inertia has none.
   integer function total_degrees_of_freedom(plan, view) result(total)
      type(poinsot_plan), intent(in) :: plan !! ready
      type(body_view), intent(in) :: view    !! the caller's arrays
      integer :: i, c, first
      total = 0
      first = 1
      if (associated(view%body_class)) first = view%first_class
      do i = 1, view%n
         c = first
         if (associated(view%body_class)) c = view%body_class(i)
         if (associated(view%body_class) .and. &
             (c < first .or. c >= first + plan%class_count())) cycle
         if (associated(view%moments(1)%of)) then
            total = total + own_degrees(view, i)
         else if (plan%class_count() > 0) then
            total = total + degrees_of_freedom(plan%classes(c - first + 1)%it%moments)
         end if
      end do
   end function total_degrees_of_freedom

   !> Of one body with moments of its own; 0 if no body has them.
   integer function own_degrees(view, i)
      type(body_view), intent(in) :: view
      integer, intent(in) :: i
      type(poinsot_error) :: refusal
      real(dp) :: moments(3)
      integer :: j
      moments = [(view%moments(j)%of(i), j=1, 3)]
      call accept_moments(moments, refusal)
      own_degrees = 0
      if (.not. raised(refusal)) own_degrees = degrees_of_freedom(moments)
   end function own_degrees

   subroutine run_energy(self, b)
      class(energy_job), intent(inout) :: self
      type(block_flows), intent(inout) :: b
      real(dp) :: kinetic(lanes), potential(lanes)
      integer :: l
      call attach_plan(self%plan, b)
      call b%energies(self%t, kinetic, potential)
      call reject_energies(kinetic, potential, b)
      do l = 1, b%n
         if (b%status(l) /= poinsot_ok) cycle
         self%kinetic(b%at(l)) = kinetic(l)
         self%potential(b%at(l)) = potential(l)
      end do
   end subroutine run_energy

   subroutine run_momentum(self, b)
      class(momentum_job), intent(inout) :: self
      type(block_flows), intent(inout) :: b
      real(dp) :: p(lanes, 4), q(lanes, 4)
      integer :: l
      q = b%q
      call from_native(space_momentum, .false., b%class, b%class%rotor, b%y, q, p)
      do l = 1, b%n
         if (b%status(l) == poinsot_ok) self%momentum(1:3, b%at(l)) = p(l, 1:3)
      end do
   end subroutine run_momentum

end module poinsot_ensemble_observe
