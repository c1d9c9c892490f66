!> poinsot properties, poinsot hard: measured properties of the library's own methods.
module app_measured
   use, intrinsic :: iso_fortran_env, only: output_unit
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_claim, only: claim_files
   use poinsot_study_hard, only: run_hard
   use poinsot_study_properties, only: run_properties
   use app_arguments, only: word_list, option_value, is_option
   use app_codes, only: exit_ok, exit_usage, exit_of_run
   use app_run, only: unknown_option
   use app_progress, only: progress_watch
   use app_terminal, only: print_error, error_is_terminal
   implicit none(type, external)
   private
   public :: command_properties, command_hard

   character(5), parameter :: known(1) = ["--out"]

contains

   !> poinsot properties [--out DIR]
   subroutine command_properties(words, code)
      type(word_list), intent(in) :: words !! what follows the command
      integer, intent(out) :: code         !! exit code
      type(poinsot_error) :: error
      type(progress_watch) :: watch
      character(:), allocatable :: folder
      call read_folder("properties", words, folder, code)
      if (code /= exit_ok) return
      watch%shown = error_is_terminal()
      watch%things = "methods"
      call run_properties(folder, output_unit, watch, error)
      call watch%wipe()
      call finish(error, code)
   end subroutine command_properties

   !> poinsot hard [NAME] [--out DIR]
   subroutine command_hard(words, code)
      type(word_list), intent(in) :: words !! what follows the command
      integer, intent(out) :: code         !! exit code
      type(poinsot_error) :: error
      type(progress_watch) :: watch
      character(:), allocatable :: folder, only
      call read_folder("hard", words, folder, code, only)
      if (code /= exit_ok) return
      if (folder /= "") call claim_files(folder, ["hard.csv"], error) ! before minutes of work
      watch%shown = error_is_terminal()
      watch%things = "cases"
      if (.not. raised(error)) call run_hard(only, folder, output_unit, watch, error)
      call watch%wipe()
      call finish(error, code)
   end subroutine command_hard

   !> The folder of --out, and a name where one is expected, "" without one; anything else is
   !> complained of.
   subroutine read_folder(command, words, folder, code, only)
      character(*), intent(in) :: command
      type(word_list), intent(in) :: words
      character(:), allocatable, intent(out) :: folder
      integer, intent(out) :: code
      character(:), allocatable, intent(out), optional :: only
      character(:), allocatable :: name, first
      logical :: found
      integer :: i
      folder = ""
      first = ""
      code = exit_usage
      i = 0
      do while (i < size(words%at))
         i = i + 1
         name = words%at(i)%text
         if (.not. is_option(name)) then
            if (len(first) > 0 .or. .not. present(only)) then
               call print_error(command // ": unexpected argument '" // name // "'")
               return
            end if
            first = name
            cycle
         end if
         if (index(name, "=") > 0) name = name(:index(name, "=") - 1)
         if (name /= "--out") then
            call unknown_option(command, name, known)
            return
         end if
         call option_value(words, i, folder, found)
         if (.not. found .or. len(folder) == 0) then
            call print_error(command // ": the option --out needs a value")
            return
         end if
      end do
      if (present(only)) only = first
      code = exit_ok
   end subroutine read_folder

   subroutine finish(error, code)
      type(poinsot_error), intent(in) :: error
      integer, intent(out) :: code
      flush (output_unit)
      code = exit_of_run(error%code)
      if (raised(error)) call print_error(error%message)
   end subroutine finish

end module app_measured
