!> The poinsot program on several MPI processes: `mpirun -n 4 poinsot run SCENE`. The first one speaks.
program poinsot_processes
   use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
   use app_commands, only: run_command
   use mpi_crew, only: process_crew, join_crew, leave_crew
   implicit none(type, external)
   type(process_crew) :: crew
   integer :: code
   call join_crew(crew)
   if (crew%number > 0) then
      open (output_unit, file="/dev/null")
      open (error_unit, file="/dev/null")
   end if
   call run_command(code, crew)
   call leave_crew()
   if (code /= 0) stop code, quiet=.true.
end program poinsot_processes
