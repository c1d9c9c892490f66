!> The fixed-form way into the library, for the matrix of entries: subroutines ..._f, everything by
!> reference. (A fixed-form program calls them without interfaces; these are of the same names.)
module test_matrix_fixed
   use poinsot, only: poinsot_splitting_name
   use poinsot_core_kinds, only: dp, i8
   use test_matrix_entries, only: outcome, class_of, is_space, moments, tensor, keep
   use test_matrix_host, only: top_data, fixed_top, fixed_data, to_variable, from_variable
   use test_matrix_problem, only: problem, n, classes, steps, h, settings_text
   implicit none(type, external)
   private
   public :: by_fixed

   abstract interface
      subroutine torque_routine(t, bodies, q, torque, stop)
         import :: dp
         implicit none(type, external)
         real(dp), intent(in) :: t
         integer, intent(in) :: bodies
         real(dp), intent(in) :: q(bodies, 4)
         real(dp), intent(inout) :: torque(bodies, 3)
         integer, intent(inout) :: stop
      end subroutine torque_routine
   end interface

   interface
      subroutine poinsot_plan_create_f(plan, status)
         import :: dp, i8
         implicit none(type, external)
         integer(i8), intent(out) :: plan
         integer, intent(out) :: status
      end subroutine poinsot_plan_create_f
      subroutine poinsot_plan_destroy_f(plan)
         import :: dp, i8
         implicit none(type, external)
         integer(i8), intent(inout) :: plan
      end subroutine poinsot_plan_destroy_f
      subroutine poinsot_plan_add_class_f(plan, moments, number, status)
         import :: dp, i8
         implicit none(type, external)
         integer(i8), intent(in) :: plan
         real(dp), intent(in) :: moments(3)
         integer, intent(out) :: number, status
      end subroutine poinsot_plan_add_class_f
      subroutine poinsot_plan_add_tensor_f(plan, inertia, number, status)
         import :: dp, i8
         implicit none(type, external)
         integer(i8), intent(in) :: plan
         real(dp), intent(in) :: inertia(9)
         integer, intent(out) :: number, status
      end subroutine poinsot_plan_add_tensor_f
      subroutine poinsot_plan_set_f(plan, option, to, status)
         import :: dp, i8
         implicit none(type, external)
         integer(i8), intent(in) :: plan
         integer, intent(in) :: option, to
         integer, intent(out) :: status
      end subroutine poinsot_plan_set_f
      subroutine poinsot_plan_effect_f(plan, name, name_length, settings, length, status)
         import :: dp, i8
         implicit none(type, external)
         integer(i8), intent(in) :: plan
         character(*), intent(in) :: name, settings
         integer, intent(in) :: name_length, length
         integer, intent(out) :: status
      end subroutine poinsot_plan_effect_f
      subroutine poinsot_plan_ready_f(plan, status)
         import :: dp, i8
         implicit none(type, external)
         integer(i8), intent(in) :: plan
         integer, intent(out) :: status
      end subroutine poinsot_plan_ready_f
      subroutine poinsot_step_f(plan, n, y, q, class, t, h, first, steps, each, status)
         import :: dp, i8
         implicit none(type, external)
         integer(i8), intent(in) :: plan
         integer, intent(in) :: n, class(*)
         real(dp), intent(inout) :: y(*), q(*)
         real(dp), intent(in) :: t, h
         integer, intent(in) :: first, steps
         integer, intent(inout) :: each(*)
         integer, intent(out) :: status
      end subroutine poinsot_step_f
      subroutine poinsot_step_torque_f(plan, n, y, q, class, t, h, first, steps, torques, each, &
            status)
         import :: dp, i8, torque_routine
         implicit none(type, external)
         integer(i8), intent(in) :: plan
         integer, intent(in) :: n, class(*)
         real(dp), intent(inout) :: y(*), q(*)
         real(dp), intent(in) :: t, h
         integer, intent(in) :: first, steps
         integer, intent(inout) :: each(*)
         procedure(torque_routine) :: torques
         integer, intent(out) :: status
      end subroutine poinsot_step_torque_f
      subroutine poinsot_energy_f(plan, n, y, q, class, t, kinetic, potential, status)
         import :: dp, i8
         implicit none(type, external)
         integer(i8), intent(in) :: plan
         integer, intent(in) :: n, class(*)
         real(dp), intent(inout) :: y(*), q(*)
         real(dp), intent(in) :: t
         real(dp), intent(inout) :: kinetic(*), potential(*)
         integer, intent(out) :: status
      end subroutine poinsot_energy_f
   end interface

contains

   !> Classes from 1, options and splittings by their numbers, momenta in rows of 3 or 4.
   subroutine by_fixed(this, form, splitting, got)
      type(problem), intent(in) :: this
      integer, intent(in) :: form
      character(*), intent(in) :: splitting
      type(outcome), intent(out) :: got
      integer(i8) :: plan
      real(dp) :: p(4, n), q(4, n), p3(3, n)
      character(:), allocatable :: text
      integer :: class(n), each(n), c, i, number, status
      call poinsot_plan_create_f(plan, got%status)
      do c = 1, classes
         if (this%by_tensor) call poinsot_plan_add_tensor_f(plan, reshape(tensor(this, c), [9]), &
            number, status)
         if (.not. this%by_tensor) call poinsot_plan_add_class_f(plan, moments(this, c), number, &
            status)
         call keep(got, status)
      end do
      call poinsot_plan_set_f(plan, 4, form, status)
      call keep(got, status)
      call poinsot_plan_set_f(plan, 5, merge(2, 1, is_space(form)), status)
      call keep(got, status)
      call poinsot_plan_set_f(plan, 2, splitting_index(splitting), status)
      call keep(got, status)
      call poinsot_plan_set_f(plan, 7, this%number, status)
      call keep(got, status)
      do i = 1, size(this%effects)
         text = settings_text(this%effects(i), .false.)
         call poinsot_plan_effect_f(plan, this%effects(i)%name, len(this%effects(i)%name), text, &
            len(text), status)
         call keep(got, status)
      end do
      call poinsot_plan_ready_f(plan, status)
      call keep(got, status)
      q = this%q
      p = to_variable(this, form, this%y, this%q)
      p3 = p(:3, :)
      class = class_of
      fixed_data = top_data(this%centre, merge(1, 0, is_space(form)))
      if (got%status == 0) then
         if (this%hosted .and. form == 5) then
            call poinsot_step_torque_f(plan, n, p, q, class, 0.0_dp, h, 0, steps, fixed_top, &
               each, status)
         else if (this%hosted) then
            call poinsot_step_torque_f(plan, n, p3, q, class, 0.0_dp, h, 0, steps, fixed_top, &
               each, status)
         else if (form == 5) then
            call poinsot_step_f(plan, n, p, q, class, 0.0_dp, h, 0, steps, each, status)
         else
            call poinsot_step_f(plan, n, p3, q, class, 0.0_dp, h, 0, steps, each, status)
         end if
         call keep(got, status)
         if (form == 5) then
            call poinsot_energy_f(plan, n, p, q, class, steps*h, got%kinetic, got%potential, status)
         else
            call poinsot_energy_f(plan, n, p3, q, class, steps*h, got%kinetic, got%potential, &
               status)
         end if
         call keep(got, status)
      end if
      if (form /= 5) p(:3, :) = p3
      got%q = q
      got%y = from_variable(this, form, p, q)
      call poinsot_plan_destroy_f(plan)
   end subroutine by_fixed

   integer function splitting_index(name) result(i)
      character(*), intent(in) :: name
      i = 1
      do while (poinsot_splitting_name(i) /= name .and. poinsot_splitting_name(i) /= "")
         i = i + 1
      end do
   end function splitting_index

end module test_matrix_fixed
