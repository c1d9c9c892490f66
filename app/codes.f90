!> Exit codes, and their relation to error statuses.
module app_codes
   use poinsot_core_status, only: poinsot_ok, poinsot_e_step, poinsot_e_convergence, &
      poinsot_e_partial, poinsot_e_scene, poinsot_e_domain, poinsot_e_method, poinsot_e_size
   implicit none(type, external)
   private
   public :: exit_of_run

   integer, parameter, public :: exit_ok = 0        !! done
   integer, parameter, public :: exit_runtime = 1   !! files, memory, interrupted
   integer, parameter, public :: exit_usage = 2     !! command line or input
   integer, parameter, public :: exit_numerical = 3 !! the calculation failed
   integer, parameter, public :: exit_tolerance = 4 !! the result is there, its error too large

contains

   !> Exit code for an error that came out of a run.
   pure integer function exit_of_run(status) result(code)
      integer, intent(in) :: status !! a poinsot_e_... value
      select case (status)
      case (poinsot_ok)
         code = exit_ok
      case (poinsot_e_step, poinsot_e_convergence, poinsot_e_partial)
         code = exit_numerical
      case (poinsot_e_scene, poinsot_e_domain, poinsot_e_method, poinsot_e_size)
         code = exit_usage
      case default
         code = exit_runtime
      end select
   end function exit_of_run

end module app_codes
