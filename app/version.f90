!> What this program is: version, compiler and flags.
module app_version
   use, intrinsic :: iso_fortran_env, only: compiler_version, compiler_options
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
      call say("flags:    " // compiler_options())
      call say("openmp:   " // trim(merge("yes", "no ", openmp)))
   end subroutine show_version

end module app_version
