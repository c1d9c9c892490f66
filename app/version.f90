!> Version, compiler and flags of this program.
module app_version
   use, intrinsic :: iso_fortran_env, only: compiler_version, compiler_options
   use poinsot_api_build, only: built_with, build_level
   use poinsot_core_version, only: version_text
   use app_terminal, only: say
   implicit none(type, external)
   private
   public :: show_version

contains

   !> Print it.
   subroutine show_version()
      logical :: openmp
      openmp = .false.
      !$ openmp = .true.
      call say("poinsot " // version_text)
      call say("compiler: " // compiler_version())
      call say("flags:    " // chosen(compiler_options()))
      if (.not. built_with("release")) call say( &
         "          not optimised: up to 20 times slower (with fpm: --profile release)")
      if (build_level() /= "") call say("level:    " // trim(build_level()))
      call say("openmp:   " // trim(merge("yes", "no ", openmp)))
   end subroutine show_version

   !> The flags that were chosen: without folders, and without what -march stands for, which
   !> gfortran spells out.
   pure function chosen(flags) result(short)
      character(*), intent(in) :: flags
      character(:), allocatable :: short, rest, one
      integer :: blank
      short = ""
      rest = trim(adjustl(flags)) // " "
      do while (len_trim(rest) > 0)
         blank = index(rest, " ")
         one = rest(:blank - 1)
         rest = adjustl(rest(blank + 1:))
         select case (one(:min(2, len(one))))
         case ("-I", "-J")
            if (len(one) == 2) rest = adjustl(rest(index(rest // " ", " "):))
            cycle
         case ("--")
            cycle
         case ("-m")
            if (.not. any(one(:min(6, len(one))) == ["-march", "-mtune", "-mcpu=", "-mpref"])) cycle
         case default
            continue
         end select
         if (index(one, "-fpre-include") == 1 .or. index(short // " ", " " // one // " ") > 0) cycle
         short = short // " " // one
      end do
      short = adjustl(short)
   end function chosen

end module app_version
