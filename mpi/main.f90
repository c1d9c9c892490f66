!> The poinsot program on several MPI processes: `mpirun -n 4 poinsot run SCENE`. Only rank 0
!> prints.
program poinsot_processes
   use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
   use app_commands, only: run_command
   use app_terminal, only: leave
   use mpi_communicators, only: mpi_communicator, start_mpi, finish_mpi
   implicit none(type, external)
   type(mpi_communicator) :: ranks
   integer :: code
   call start_mpi(ranks)
   if (ranks%number > 0) then
      open (output_unit, file="/dev/null")
      open (error_unit, file="/dev/null")
   end if
   call run_command(code, ranks)
   call finish_mpi()
   if (code /= 0) call leave(code)
end program poinsot_processes
