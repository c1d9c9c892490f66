!> Options that the studies share, and their values as numbers and names.
module app_options
   use poinsot_core_kinds, only: dp
   use poinsot_core_number, only: parse_real, number_ok
   use poinsot_scene_text, only: joined, text_of
   use app_arguments, only: word, word_list, option_value, is_option, append_word
   use app_find_scene, only: shipped_scenes
   use app_run, only: unknown_option
   use app_terminal, only: print_error
   implicit none(type, external)
   private
   public :: study_options, read_study_options, seconds_of, numbers_in, names_in

   !> What a study was asked for, as words; "" = not said.
   type :: study_options
      character(:), allocatable :: scene, out, budget, methods, splittings, tol, spread, states, &
         sums, rivals
      type(word), allocatable :: settings(:)   !! of --set
      logical :: quiet = .false., pictures = .true.
   end type study_options

contains

   !> Words to options; complains itself.
   subroutine read_study_options(command, words, known, options, good, question)
      character(*), intent(in) :: command            !! for messages
      type(word_list), intent(in) :: words           !! what follows the command
      character(*), intent(in) :: known(:)           !! the options of this command
      type(study_options), intent(out) :: options
      logical, intent(out) :: good
      character(*), intent(in), optional :: question !! said if nothing is named; default: a scene
      character(:), allocatable :: name, value
      integer :: i
      call start(options)
      good = .true.
      i = 0
      do while (i < size(words%at) .and. good)
         i = i + 1
         name = words%at(i)%text
         if (.not. is_option(name)) then
            good = len(options%scene) == 0
            if (.not. good) call print_error(command // ": one scene at a time; unexpected '" // &
               name // "'")
            options%scene = name
            cycle
         end if
         if (index(name, "=") > 0) name = name(:index(name, "=") - 1)
         if (.not. any(known == name)) then
            call unknown_option(command, name, known)
            good = .false.
         else if (name == "--quiet") then
            options%quiet = .true.
         else if (name == "--no-pictures") then
            options%pictures = .false.
         else
            call option_value(words, i, value, good)
            if (good) call take(name, value, options)
            if (.not. good) call print_error(command // ": the option " // name // " needs a value")
         end if
      end do
      if (good .and. len(options%scene) == 0) then
         if (present(question)) then
            call print_error(command // ": " // question)
         else
            call print_error(command // ": no scene given; shipped scenes: " // &
                             joined(shipped_scenes))
         end if
         good = .false.
      end if
      do while (len(options%out) > 1)
         if (options%out(len(options%out):) /= "/") exit
         options%out = options%out(:len(options%out) - 1)
      end do
   end subroutine read_study_options

   subroutine start(options)
      type(study_options), intent(out) :: options
      options%scene = ""
      options%out = ""
      options%budget = ""
      options%methods = ""
      options%splittings = ""
      options%tol = ""
      options%spread = ""
      options%states = ""
      options%sums = ""
      options%rivals = ""
      allocate (options%settings(0))
   end subroutine start

   !> One option with its value.
   subroutine take(name, value, options)
      character(*), intent(in) :: name, value
      type(study_options), intent(inout) :: options
      select case (name)
      case ("--out")
         options%out = value
      case ("--budget")
         options%budget = value
      case ("--methods")
         options%methods = value
      case ("--splittings")
         options%splittings = value
      case ("--tol")
         options%tol = value
      case ("--spread")
         options%spread = value
      case ("--states")
         options%states = value
      case ("--sums")
         options%sums = value
      case ("--rivals")
         options%rivals = value
      case ("--set")
         call append_word(options%settings, value)
      case default
         return ! known options all have their case
      end select
   end subroutine take

   !> "60", "60s", "2m", "1500ms" as seconds, 0.1 to 86400; complains itself.
   subroutine seconds_of(command, text, seconds, good)
      character(*), intent(in) :: command, text
      real(dp), intent(inout) :: seconds
      logical, intent(out) :: good
      real(dp) :: value, unit
      integer :: last, outcome
      last = len_trim(text)
      unit = 1
      if (last > 2) then
         if (text(last - 1:last) == "ms") unit = 1e-3_dp
         if (text(last - 1:last) == "ms") last = last - 2
      end if
      if (last > 1 .and. unit >= 1) then
         if (text(last:last) == "m") unit = 60
         if (scan(text(last:last), "sm") > 0) last = last - 1
      end if
      call parse_real(text(:last), value, outcome)
      good = outcome == number_ok
      if (good) good = value*unit >= 0.1_dp .and. value*unit <= 86400
      if (good) seconds = value*unit
      if (.not. good) call print_error(command // ": --budget " // text // &
         " is not a time from 0.1 s to one day, such as 60s or 2m")
   end subroutine seconds_of

   !> "1e-3,1e-6" as numbers within bounds; complains itself.
   subroutine numbers_in(command, option, text, least, most, values, good)
      character(*), intent(in) :: command, option, text
      real(dp), intent(in) :: least, most
      real(dp), allocatable, intent(inout) :: values(:)
      logical, intent(out) :: good
      character(24), allocatable :: parts(:)
      integer :: i, outcome
      call names_in(text, parts)
      if (allocated(values)) deallocate (values)
      allocate (values(size(parts)))
      good = size(parts) > 0
      do i = 1, size(parts)
         call parse_real(trim(parts(i)), values(i), outcome)
         if (good) good = outcome == number_ok
         if (good) good = values(i) >= least .and. values(i) <= most
      end do
      if (good) return
      call print_error(command // ": " // option // " " // text // " is neither a number " // &
                    "nor a list a,b,c of numbers from " // text_of(least) // &
                    " to " // text_of(most))
   end subroutine numbers_in

   !> "a,b,c" as words.
   subroutine names_in(text, names)
      character(*), intent(in) :: text
      character(24), allocatable, intent(out) :: names(:)
      integer :: from, comma
      allocate (names(0))
      from = 1
      do while (from <= len(text))
         comma = index(text(from:) // ",", ",")
         if (comma > 1) names = [character(24) :: names, adjustl(text(from:from + comma - 2))]
         from = from + comma
      end do
   end subroutine names_in

end module app_options
