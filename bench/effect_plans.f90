!> Plans for the table of `make bench` and for counting instructions: no effect, or any one effect
!> of the registry.
module bench_effect_plans
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_effect_effect, only: effect
   use poinsot_effect_registry, only: describe_effect
   use poinsot_effect_settings, only: effect_info, setting, number_setting, text_setting
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_effect, add_ready_effect, &
      set_option
   use bench_tasks, only: down_torque
   implicit none(type, external)
   private
   public :: make_plan, add_any_effect, finish_plan

contains

   !> An open plan with one kind of body, one thread. Effects may be added; then `finish_plan`.
   subroutine make_plan(moments, method, layout, plan)
      real(dp), intent(in) :: moments(3)
      character(*), intent(in) :: method, layout
      type(poinsot_plan), intent(out) :: plan
      type(poinsot_error) :: error
      integer :: number
      call add_class(plan, moments, number, error)
      call set_option(plan, "method", method, error)
      call set_option(plan, "splitting", "strang", error)
      call set_option(plan, "layout", layout, error)
      call set_option(plan, "threads", "1", error)
      if (raised(error)) print "(2a)", "   plan: ", error%message
   end subroutine make_plan

   !> Add effect i of the registry: 0.3, 0.2, 0.1 for keys that have no default, a torque of our own
   !> for `callback`.
   subroutine add_any_effect(plan, i)
      type(poinsot_plan), intent(inout) :: plan
      integer, intent(in) :: i
      real(dp), parameter :: some(3) = [0.3_dp, 0.2_dp, 0.1_dp]
      type(effect_info) :: info
      type(setting), allocatable :: settings(:)
      type(poinsot_error) :: error
      class(effect), allocatable :: own
      integer :: k
      info = describe_effect(i)
      allocate (settings(0))
      do k = 1, size(info%keys)
         if (info%keys(k)%default /= "required") cycle
         if (info%keys(k)%is_text) settings = [settings, text_setting(trim(info%keys(k)%name), &
            "0.3*Q31 + 0.2*Q32 + 0.1*Q33")]
         if (.not. info%keys(k)%is_text) settings = [settings, &
            number_setting(trim(info%keys(k)%name), &
            some(1:min(3, max(1, info%keys(k)%least))))]
      end do
      if (size(info%keys) == 0) then
         allocate (down_torque :: own)
         own%name = info%name
         call add_ready_effect(plan, own, error)
      else
         call add_effect(plan, trim(info%name), settings, error)
      end if
      if (raised(error)) print "(2a)", "   plan: ", error%message
   end subroutine add_any_effect

   subroutine finish_plan(plan)
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error) :: error
      call make_ready(plan, error)
      if (raised(error)) print "(2a)", "   plan: ", error%message
   end subroutine finish_plan

end module bench_effect_plans
