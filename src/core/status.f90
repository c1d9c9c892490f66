!> The list of status values, with their texts. C has the same numbers (include/poinsot.h).
module poinsot_core_status
   implicit none(type, external)
   private
   public :: poinsot_ok, poinsot_e_null, poinsot_e_size, poinsot_e_domain, poinsot_e_method
   public :: poinsot_e_step, poinsot_e_convergence, poinsot_e_memory, poinsot_e_callback
   public :: poinsot_e_partial, poinsot_e_io, poinsot_e_scene, poinsot_e_cpu
   public :: poinsot_e_not_finite, poinsot_e_not_unit, poinsot_e_axis_momentum
   public :: status_text, status_texts, last_status

   integer, parameter :: poinsot_ok = 0
   integer, parameter :: poinsot_e_null = 1
   integer, parameter :: poinsot_e_size = 2
   integer, parameter :: poinsot_e_domain = 3
   integer, parameter :: poinsot_e_method = 4
   integer, parameter :: poinsot_e_step = 5
   integer, parameter :: poinsot_e_convergence = 6
   integer, parameter :: poinsot_e_memory = 7
   integer, parameter :: poinsot_e_callback = 8
   integer, parameter :: poinsot_e_partial = 9
   integer, parameter :: poinsot_e_io = 10
   integer, parameter :: poinsot_e_scene = 11
   integer, parameter :: poinsot_e_cpu = 12
   integer, parameter :: poinsot_e_not_finite = 13
   integer, parameter :: poinsot_e_not_unit = 14
   integer, parameter :: poinsot_e_axis_momentum = 15
   integer, parameter :: last_status = 15 !! the highest of them

   character(76), parameter :: status_texts(0:last_status) = [character(76) :: &
      "ok", &
      "a required pointer is NULL", &
      "a size or a stride does not fit", &
      "a value is out of range or not physical", &
      "unknown method, splitting, effect, layout or option name", &
      "the step is too long for this method (rotation per step beyond its limit)", &
      "an iteration did not converge", &
      "out of memory", &
      "the callback asked to stop", &
      "some bodies failed: see the status of each body", &
      "a file could not be read or written", &
      "the scene file has an error", &
      "this build needs a newer processor", &
      "a number of a body is not finite", &
      "the attitude is not a unit quaternion", &
      "angular momentum about an axis without inertia"]

contains

   !> Text of a status value; "unknown status" for any other number.
   pure function status_text(code) result(text)
      integer, intent(in) :: code !! one of the poinsot_e_... values or poinsot_ok
      character(:), allocatable :: text
      if (code >= lbound(status_texts, 1) .and. code <= ubound(status_texts, 1)) then
         text = trim(status_texts(code))
      else
         text = "unknown status"
      end if
   end function status_text

end module poinsot_core_status
