!> The poinsot program: arguments to a command, the command's outcome to an exit code.
program poinsot_app
   use app_commands, only: run_command
   implicit none(type, external)
   integer :: code
   call run_command(code)
   if (code /= 0) stop code, quiet=.true.
end program poinsot_app
