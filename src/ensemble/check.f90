!> Checks at the start of every call that a plan and the caller's bodies fit together.
module poinsot_ensemble_check
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_method, poinsot_e_null, poinsot_e_size
   use poinsot_effect_effect, only: effect, torque_effect
   use poinsot_effect_gyrostat, only: gyrostat
   use poinsot_ensemble_bodies, only: body_view, check_rows
   use poinsot_ensemble_layout, only: body_velocity, space_velocity, conjugate_momentum
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_free_lane_moments, only: takes_moments
   implicit none(type, external)
   private
   public :: check_ready, check_purpose, to_drift, to_kick, to_step, to_observe, &
      to_dissipate

   !> The purpose of a call on bodies with moments of their own.
   integer, parameter :: to_drift = 1, to_kick = 2, to_step = 3, to_observe = 4, &
      to_dissipate = 5

contains

   !> The plan must be ready, the view complete.
   subroutine check_ready(plan, view, error)
      type(poinsot_plan), intent(in) :: plan
      type(body_view), intent(in) :: view
      type(poinsot_error), intent(inout) :: error
      if (.not. plan%ready) then
         call raise(error, poinsot_e_domain, "the plan is not ready: call plan_ready first")
      else if (plan%momentum == conjugate_momentum .and. view%n > 0 .and. &
         .not. associated(view%y(4)%of)) then
         call raise(error, poinsot_e_size, &
            "a conjugate momentum has four components: y_fourth is missing")
      else
         call check_own(view, error)
         if (.not. raised(error)) call check_rows(view, error)
      end if
   end subroutine check_ready

   !> Moments of each body's own: a scale or moments, all three, one for each body.
   subroutine check_own(view, error)
      type(body_view), intent(in) :: view
      type(poinsot_error), intent(inout) :: error
      integer :: given, shortest, j
      given = 0
      shortest = view%n
      do j = 1, 3
         if (.not. associated(view%moments(j)%of)) cycle
         given = given + 1
         shortest = min(shortest, size(view%moments(j)%of))
      end do
      if (associated(view%scale)) then
         shortest = min(shortest, size(view%scale))
         if (given > 0) then
            call raise(error, poinsot_e_method, "poinsot_bodies: scale and moments are both " &
               //"given; a scale is of the moments of a body's class")
            return
         end if
      end if
      if (given == 1 .or. given == 2) then
         call raise(error, poinsot_e_null, "poinsot_bodies: moments has a component that is NULL")
      else if (shortest < view%n) then
         call raise(error, poinsot_e_size, &
            "poinsot_bodies: scale or moments are shorter than the number of bodies")
      end if
   end subroutine check_own

   !> Does a call of this purpose know what the plan asks for: with moments for each body, does
   !> the plan do without those of a class; with rotors that change, is there a time?
   !> POINSOT_E_METHOD if not.
   subroutine check_purpose(plan, view, purpose, error)
      type(poinsot_plan), intent(in) :: plan    !! ready
      type(body_view), intent(in) :: view
      integer, intent(in) :: purpose            !! to_drift, to_kick, ... of above
      type(poinsot_error), intent(inout) :: error
      integer :: i
      if (plan%rotors_change .and. wants_time(plan, purpose)) then
         call raise(error, poinsot_e_method, "effect 'gyrostat': the momentum of a rotor changes " &
            //"with time, and this call is not given the time; use poinsot_step or " &
            //"poinsot_energy")
         return
      end if
      if (.not. associated(view%moments(1)%of)) return
      if (purpose == to_drift .or. purpose == to_step) then
         if (.not. takes_moments(plan%method)) then
            call raise(error, poinsot_e_method, "method '"//trim(plan%method%name)//"' does not " &
               //"support moments for each body; use 'exact' or 'jacobi'")
            return
         end if
      end if
      if (purpose == to_step .and. &
          (plan%splitting%adaptive .or. plan%splitting%needs_gradient)) then
         call raise(error, poinsot_e_method, "splitting '"//trim(plan%splitting%name)//"' does " &
            //"not support moments for each body; use 'strang', 'srkn4' or 'srkn6'")
         return
      end if
      do i = 1, size(plan%effects)
         if (.not. plan%effects(i)%it%uses_moments()) cycle
         if (.not. matters(plan, plan%effects(i)%it, purpose)) cycle
         call raise(error, poinsot_e_method, "effect '"//trim(plan%effects(i)%it%name)//"' needs " &
            //"the moments of a body class; it does not act on bodies with moments for each")
         return
      end do
   end subroutine check_purpose

   !> Does a call without a time need one, where rotors change?
   pure logical function wants_time(plan, purpose)
      type(poinsot_plan), intent(in) :: plan
      integer, intent(in) :: purpose
      wants_time = purpose == to_drift .or. (purpose == to_dissipate .and. plan%has_dissipation)
      if (purpose == to_kick) wants_time = plan%momentum == body_velocity .or. &
         plan%momentum == space_velocity
   end function wants_time

   !> Does an effect that uses moments matter for this purpose?
   pure logical function matters(plan, one, purpose)
      type(poinsot_plan), intent(in) :: plan
      class(effect), intent(in) :: one
      integer, intent(in) :: purpose
      matters = purpose == to_step .or. purpose == to_dissipate
      select type (one)
      class is (gyrostat)
         matters = purpose /= to_kick .or. plan%momentum == body_velocity .or. &
            plan%momentum == space_velocity
      class is (torque_effect)
         matters = purpose == to_step .or. purpose == to_observe
      end select
   end function matters

end module poinsot_ensemble_check
