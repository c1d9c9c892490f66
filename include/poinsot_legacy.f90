! Interfaces of the subroutines poinsot_..._f, for Fortran hosts that want the compiler to check the
! arguments of calls; poinsot.h documents them. Compile this file with the host: it works with any
! compiler that appends one underscore to external names. Generated from poinsot.h.
module poinsot_legacy
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t
   implicit none
   private
   public :: poinsot_version_f
   public :: poinsot_rotate_f
   public :: poinsot_splitting_f
   public :: poinsot_plan_create_f
   public :: poinsot_plan_destroy_f
   public :: poinsot_plan_add_class_f
   public :: poinsot_plan_add_tensor_f
   public :: poinsot_plan_find_class_f
   public :: poinsot_plan_set_f
   public :: poinsot_plan_gravity_f
   public :: poinsot_plan_tolerance_f
   public :: poinsot_plan_effect_f
   public :: poinsot_plan_ready_f
   public :: poinsot_plan_message_f
   public :: poinsot_status_text_f
   public :: poinsot_drift_f
   public :: poinsot_kick_f
   public :: poinsot_dissipate_f
   public :: poinsot_step_f
   public :: poinsot_step_torque_f
   public :: poinsot_energy_f
   public :: poinsot_drift_a_f
   public :: poinsot_kick_a_f
   public :: poinsot_dissipate_a_f
   public :: poinsot_dissipate_c_f
   public :: poinsot_drift_c_f
   public :: poinsot_kick_c_f
   public :: poinsot_torque_f

   abstract interface
      subroutine poinsot_torque_f(t, n, q, torque, stop)
         import
         implicit none
         real(c_double), intent(in) :: t
         integer(c_int), intent(in) :: n
         real(c_double), intent(in) :: q(n, 4)
         real(c_double), intent(inout) :: torque(n, 3)
         integer(c_int), intent(inout) :: stop
      end subroutine poinsot_torque_f
   end interface

   interface
      subroutine poinsot_version_f(version, status)
         import
         implicit none
         integer(c_int), intent(out) :: version
         integer(c_int), intent(out) :: status
      end subroutine poinsot_version_f

      subroutine poinsot_rotate_f(moments, method, h, steps, n, y, q, each, status)
         import
         implicit none
         real(c_double), intent(in) :: moments(3)
         integer(c_int), intent(in) :: method
         real(c_double), intent(in) :: h
         integer(c_int), intent(in) :: steps
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: y(*)
         real(c_double), intent(inout) :: q(*)
         integer(c_int), intent(inout) :: each(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_rotate_f

      subroutine poinsot_splitting_f(splitting, capacity, kick, drift, count, status)
         import
         implicit none
         integer(c_int), intent(in) :: splitting
         integer(c_int), intent(in) :: capacity
         real(c_double), intent(out) :: kick(*)
         real(c_double), intent(out) :: drift(*)
         integer(c_int), intent(out) :: count
         integer(c_int), intent(out) :: status
      end subroutine poinsot_splitting_f

      subroutine poinsot_plan_create_f(plan, status)
         import
         implicit none
         integer(c_int64_t), intent(inout) :: plan
         integer(c_int), intent(out) :: status
      end subroutine poinsot_plan_create_f

      subroutine poinsot_plan_destroy_f(plan)
         import
         implicit none
         integer(c_int64_t), intent(inout) :: plan
      end subroutine poinsot_plan_destroy_f

      subroutine poinsot_plan_add_class_f(plan, moments, number, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         real(c_double), intent(in) :: moments(3)
         integer(c_int), intent(out) :: number
         integer(c_int), intent(out) :: status
      end subroutine poinsot_plan_add_class_f

      subroutine poinsot_plan_add_tensor_f(plan, inertia, number, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         real(c_double), intent(in) :: inertia(9)
         integer(c_int), intent(out) :: number
         integer(c_int), intent(out) :: status
      end subroutine poinsot_plan_add_tensor_f

      subroutine poinsot_plan_find_class_f(plan, moments, tolerance, number, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         real(c_double), intent(in) :: moments(3)
         real(c_double), intent(in) :: tolerance
         integer(c_int), intent(out) :: number
         integer(c_int), intent(out) :: status
      end subroutine poinsot_plan_find_class_f

      subroutine poinsot_plan_set_f(plan, option, value, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: option
         integer(c_int), intent(in) :: value
         integer(c_int), intent(out) :: status
      end subroutine poinsot_plan_set_f

      subroutine poinsot_plan_gravity_f(plan, centre, weight, up, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         real(c_double), intent(in) :: centre(3)
         real(c_double), intent(in) :: weight
         real(c_double), intent(in) :: up(3)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_plan_gravity_f

      subroutine poinsot_plan_tolerance_f(plan, tolerance, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         real(c_double), intent(in) :: tolerance
         integer(c_int), intent(out) :: status
      end subroutine poinsot_plan_tolerance_f

      subroutine poinsot_plan_effect_f(plan, name, name_length, settings, settings_length, &
         status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         character(*), intent(in) :: name
         integer(c_int), intent(in) :: name_length
         character(*), intent(in) :: settings
         integer(c_int), intent(in) :: settings_length
         integer(c_int), intent(out) :: status
      end subroutine poinsot_plan_effect_f

      subroutine poinsot_plan_ready_f(plan, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(out) :: status
      end subroutine poinsot_plan_ready_f

      subroutine poinsot_plan_message_f(plan, text, length)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         character(*), intent(out) :: text
         integer(c_int), intent(in) :: length
      end subroutine poinsot_plan_message_f

      subroutine poinsot_status_text_f(status, text, length)
         import
         implicit none
         integer(c_int), intent(in) :: status
         character(*), intent(out) :: text
         integer(c_int), intent(in) :: length
      end subroutine poinsot_status_text_f

      subroutine poinsot_drift_f(plan, n, y, q, body_class, h, each, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: y(*)
         real(c_double), intent(inout) :: q(*)
         integer(c_int), intent(in) :: body_class(*)
         real(c_double), intent(in) :: h
         integer(c_int), intent(inout) :: each(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_drift_f

      subroutine poinsot_kick_f(plan, n, y, q, body_class, h, torque, each, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: y(*)
         real(c_double), intent(inout) :: q(*)
         integer(c_int), intent(in) :: body_class(*)
         real(c_double), intent(in) :: h
         real(c_double), intent(in) :: torque(*)
         integer(c_int), intent(inout) :: each(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_kick_f

      subroutine poinsot_dissipate_f(plan, n, y, q, body_class, h, step, each, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: y(*)
         real(c_double), intent(inout) :: q(*)
         integer(c_int), intent(in) :: body_class(*)
         real(c_double), intent(in) :: h
         integer(c_int), intent(in) :: step
         integer(c_int), intent(inout) :: each(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_dissipate_f

      subroutine poinsot_step_f(plan, n, y, q, body_class, t, h, first, steps, each, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: y(*)
         real(c_double), intent(inout) :: q(*)
         integer(c_int), intent(in) :: body_class(*)
         real(c_double), intent(in) :: t
         real(c_double), intent(in) :: h
         integer(c_int), intent(in) :: first
         integer(c_int), intent(in) :: steps
         integer(c_int), intent(inout) :: each(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_step_f

      subroutine poinsot_step_torque_f(plan, n, y, q, body_class, t, h, first, steps, &
         torques, each, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: y(*)
         real(c_double), intent(inout) :: q(*)
         integer(c_int), intent(in) :: body_class(*)
         real(c_double), intent(in) :: t
         real(c_double), intent(in) :: h
         integer(c_int), intent(in) :: first
         integer(c_int), intent(in) :: steps
         procedure(poinsot_torque_f) :: torques
         integer(c_int), intent(inout) :: each(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_step_torque_f

      subroutine poinsot_energy_f(plan, n, y, q, body_class, t, kinetic, potential, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: y(*)
         real(c_double), intent(inout) :: q(*)
         integer(c_int), intent(in) :: body_class(*)
         real(c_double), intent(in) :: t
         real(c_double), intent(out) :: kinetic(*)
         real(c_double), intent(out) :: potential(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_energy_f

      subroutine poinsot_drift_a_f(plan, n, y1, y2, y3, q0, q1, q2, q3, body_class, h, each, &
         status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: y1(*)
         real(c_double), intent(inout) :: y2(*)
         real(c_double), intent(inout) :: y3(*)
         real(c_double), intent(inout) :: q0(*)
         real(c_double), intent(inout) :: q1(*)
         real(c_double), intent(inout) :: q2(*)
         real(c_double), intent(inout) :: q3(*)
         integer(c_int), intent(in) :: body_class(*)
         real(c_double), intent(in) :: h
         integer(c_int), intent(inout) :: each(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_drift_a_f

      subroutine poinsot_kick_a_f(plan, n, y1, y2, y3, q0, q1, q2, q3, body_class, h, &
         torque1, torque2, torque3, each, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: y1(*)
         real(c_double), intent(inout) :: y2(*)
         real(c_double), intent(inout) :: y3(*)
         real(c_double), intent(inout) :: q0(*)
         real(c_double), intent(inout) :: q1(*)
         real(c_double), intent(inout) :: q2(*)
         real(c_double), intent(inout) :: q3(*)
         integer(c_int), intent(in) :: body_class(*)
         real(c_double), intent(in) :: h
         real(c_double), intent(in) :: torque1(*)
         real(c_double), intent(in) :: torque2(*)
         real(c_double), intent(in) :: torque3(*)
         integer(c_int), intent(inout) :: each(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_kick_a_f

      subroutine poinsot_dissipate_a_f(plan, n, y1, y2, y3, q0, q1, q2, q3, body_class, h, &
         step, each, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: y1(*)
         real(c_double), intent(inout) :: y2(*)
         real(c_double), intent(inout) :: y3(*)
         real(c_double), intent(inout) :: q0(*)
         real(c_double), intent(inout) :: q1(*)
         real(c_double), intent(inout) :: q2(*)
         real(c_double), intent(inout) :: q3(*)
         integer(c_int), intent(in) :: body_class(*)
         real(c_double), intent(in) :: h
         integer(c_int), intent(in) :: step
         integer(c_int), intent(inout) :: each(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_dissipate_a_f

      subroutine poinsot_dissipate_c_f(plan, n, p0, p1, p2, p3, q0, q1, q2, q3, body_class, &
         h, step, each, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: p0(*)
         real(c_double), intent(inout) :: p1(*)
         real(c_double), intent(inout) :: p2(*)
         real(c_double), intent(inout) :: p3(*)
         real(c_double), intent(inout) :: q0(*)
         real(c_double), intent(inout) :: q1(*)
         real(c_double), intent(inout) :: q2(*)
         real(c_double), intent(inout) :: q3(*)
         integer(c_int), intent(in) :: body_class(*)
         real(c_double), intent(in) :: h
         integer(c_int), intent(in) :: step
         integer(c_int), intent(inout) :: each(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_dissipate_c_f

      subroutine poinsot_drift_c_f(plan, n, p0, p1, p2, p3, q0, q1, q2, q3, body_class, h, &
         each, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: p0(*)
         real(c_double), intent(inout) :: p1(*)
         real(c_double), intent(inout) :: p2(*)
         real(c_double), intent(inout) :: p3(*)
         real(c_double), intent(inout) :: q0(*)
         real(c_double), intent(inout) :: q1(*)
         real(c_double), intent(inout) :: q2(*)
         real(c_double), intent(inout) :: q3(*)
         integer(c_int), intent(in) :: body_class(*)
         real(c_double), intent(in) :: h
         integer(c_int), intent(inout) :: each(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_drift_c_f

      subroutine poinsot_kick_c_f(plan, n, p0, p1, p2, p3, q0, q1, q2, q3, body_class, h, &
         torque1, torque2, torque3, each, status)
         import
         implicit none
         integer(c_int64_t), intent(in) :: plan
         integer(c_int), intent(in) :: n
         real(c_double), intent(inout) :: p0(*)
         real(c_double), intent(inout) :: p1(*)
         real(c_double), intent(inout) :: p2(*)
         real(c_double), intent(inout) :: p3(*)
         real(c_double), intent(inout) :: q0(*)
         real(c_double), intent(inout) :: q1(*)
         real(c_double), intent(inout) :: q2(*)
         real(c_double), intent(inout) :: q3(*)
         integer(c_int), intent(in) :: body_class(*)
         real(c_double), intent(in) :: h
         real(c_double), intent(in) :: torque1(*)
         real(c_double), intent(in) :: torque2(*)
         real(c_double), intent(in) :: torque3(*)
         integer(c_int), intent(inout) :: each(*)
         integer(c_int), intent(out) :: status
      end subroutine poinsot_kick_c_f
   end interface

end module poinsot_legacy
