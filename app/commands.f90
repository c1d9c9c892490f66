!> The table of commands. A new one is a row in `table`, a case in `dispatch`, a help text in
!> app_help.
module app_commands
   use poinsot_scene_communicator, only: communicator
   use poinsot_core_nearest, only: suggestion
   use app_arguments, only: word, word_list, command_words, is_option
   use app_codes, only: exit_ok, exit_usage
   use app_help, only: command, table, show_help, show_command_help
   use app_terminal, only: print_error
   use app_version, only: show_version
   use app_run, only: command_run, command_view
   use app_cost, only: command_cost
   use app_measured, only: command_properties, command_hard
   use app_choose, only: command_choose
   use app_reproduce, only: command_reproduce
   use app_lists, only: command_methods, command_splittings, command_effects, command_keys, &
      command_scenes
   implicit none(type, external)
   private
   public :: run_command

contains

   !> Run the command of the command line.
   subroutine run_command(code, ranks)
      integer, intent(out) :: code !! exit code: 0 ok, 1 runtime, 2 usage or input, 3 numerical
      class(communicator), intent(inout), optional :: ranks !! who else runs this
      type(word_list) :: all, rest
      character(:), allocatable :: name
      integer :: i
      call command_words(all)
      code = exit_ok
      if (size(all%at) == 0) then
         call show_help()
         code = exit_usage
         return
      end if
      name = all%at(1)%text
      rest%at = all%at(2:)
      if (name == "help" .and. size(rest%at) > 0) then
         name = rest%at(1)%text
         rest%at = [word("--help")]
      end if
      select case (name)
      case ("--help", "-h", "help")
         call show_help()
         return
      case ("--version", "-V", "version")
         call show_version()
         return
      case default
         continue
      end select
      if (is_option(name)) then
         call print_error("unknown option '" // name // "'; before a command only --help and " // &
                       "--version are allowed")
         code = exit_usage
         return
      else if (.not. any(table%name == name)) then
         call print_error("unknown command '" // name // "'" // suggestion(name, table%name) // &
                       " (poinsot --help shows all)")
         code = exit_usage
         return
      end if
      do i = 1, size(rest%at)
         if (rest%at(i)%text /= "--help" .and. rest%at(i)%text /= "-h") cycle
         call show_command_help(name)
         return
      end do
      call dispatch(name, rest, code, ranks)
   end subroutine run_command

   !> A command of the table.
   subroutine dispatch(name, words, code, ranks)
      character(*), intent(in) :: name
      type(word_list), intent(in) :: words   !! what follows it
      integer, intent(out) :: code
      class(communicator), intent(inout), optional :: ranks
      if (present(ranks)) then
         code = exit_ok
         if (ranks%number > 0 .and. name /= "run") return ! for one alone
      end if
      select case (name)
      case ("run")
         call command_run(words, code, ranks)
      case ("view")
         call command_view(words, code)
      case ("cost")
         call command_cost(words, code)
      case ("choose")
         call command_choose(words, code)
      case ("reproduce")
         call command_reproduce(words, code)
      case ("properties")
         call command_properties(words, code)
      case ("hard")
         call command_hard(words, code)
      case ("methods")
         call command_methods(words, code)
      case ("splittings")
         call command_splittings(words, code)
      case ("effects")
         call command_effects(words, code)
      case ("keys")
         call command_keys(words, code)
      case ("scenes")
         call command_scenes(words, code)
      case default
         call print_error("the command '" // name // "' is not built in")
         code = exit_usage
      end select
   end subroutine dispatch

end module app_commands
