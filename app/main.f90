!> The poinsot program: arguments to a command, the command's outcome to an exit code.
program poinsot_app
   use app_commands, only: run_command
   use app_terminal, only: leave
   implicit none(type, external)
   integer :: code
   call run_command(code)
   if (code /= 0) call leave(code)
end program poinsot_app
