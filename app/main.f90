!> The poinsot program: passes the arguments to a command, and the result of the command to the exit
!> code.
program poinsot_app
   use app_commands, only: run_command
   use app_terminal, only: leave
   implicit none(type, external)
   integer :: code
   call run_command(code)
   if (code /= 0) call leave(code)
end program poinsot_app
