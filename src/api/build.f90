!> The processor that the Fortran part of this build was compiled for, as constant data:
!> src/api/cpu_check.c reads it before anything else runs.
module poinsot_api_build
   use, intrinsic :: iso_c_binding, only: c_int
   use, intrinsic :: iso_fortran_env, only: compiler_options
   use poinsot_core_version, only: version_number
   implicit none(type, external)
   private
   public :: build_needs, build_version, built_with, build_level

   ! The compiler spells -march=native out.
   character(*), parameter :: options = compiler_options()//" "

   integer :: i !! of the tables only

   !> Bit i - 1 of the needs: the i-th of these. The same order as in cpu_check.c.
   character(16), parameter :: features(22) = [character(16) :: &
      "sse3", "ssse3", "sse4.1", "sse4.2", "popcnt", "avx", "avx2", "fma", "bmi", "bmi2", &
      "avx512f", "avx512vl", "avx512bw", "avx512dq", "avx512cd", "avx512vbmi", "avx512ifma", &
      "avx512vpopcntdq", "avx512vbmi2", "gfni", "vpclmulqdq", "avx512vnni"]

   !> Levels that a -march= may name instead of the features: how many of them it stands for, from
   !> the first on.
   integer, parameter :: v2 = 5, avx = 6, v3 = 10, v4 = 15, all = 22
   character(16), parameter :: machines(28) = [character(16) :: &
      "x86-64-v2", "nehalem", "westmere", "silvermont", "goldmont", "sandybridge", "ivybridge", &
      "x86-64-v3", "haswell", "broadwell", "skylake", "alderlake", "core-avx2", "znver1", &
         "znver2", "znver3", &
      "x86-64-v4", "skylake-avx512", "cascadelake", "cooperlake", &
      "icelake-client", "icelake-server", "tigerlake", "rocketlake", "sapphirerapids", &
         "graniterapids", "znver4", "znver5"]
   integer, parameter :: levels(28) = [(v2, i=1, 5), avx, avx, (v3, i=8, 16), (v4, i=17, 20), &
      (all, i=21, 28)]

   integer, parameter :: from = index(options, "-march=") + 7
   character(16), parameter :: machine = options(from:from - 2 + index(options(from:), " "))
   integer, parameter :: level = maxval(merge(levels, 0, machines == machine))

   !> Features of the processor that the build uses, one bit each. Never changed.
   integer(c_int), protected, save, bind(c, name="poinsot_build_needs") :: build_needs = sum([( &
      merge(2**(i - 1), 0, (i <= level .or. index(options, "-m"//trim(features(i))//" ") > 0) &
            .and. index(options, "-mno-"//trim(features(i))//" ") == 0), i=1, size(features))])

   !> The version, also for a processor that this build does not fit.
   integer(c_int), protected, save, &
      bind(c, name="poinsot_build_version") :: build_version = version_number

contains

   !> Does the build use a feature of the processor, by its name above, or all of a level's
   !> (x86-64-v2, -v3, -v4)? "release": was it compiled with optimisation and without checks?
   pure logical function built_with(feature)
      character(*), intent(in) :: feature
      integer :: k
      select case (feature)
      case ("release")
         built_with = (index(options, "-O2 ") > 0 .or. index(options, "-O3 ") > 0) .and. &
                      index(options, "-fcheck=all") == 0
      case ("x86-64-v2")
         built_with = has_first(v2)
      case ("x86-64-v3")
         built_with = has_first(v3)
      case ("x86-64-v4")
         built_with = has_first(v4)
      case default
         built_with = .false.
         do k = 1, size(features)
            if (features(k) == feature) built_with = btest(build_needs, k - 1)
         end do
      end select
   end function built_with

   !> The highest level of x86-64 that the build uses all of; "" on another kind of processor.
   pure function build_level() result(name)
      character(9) :: name
      name = ""
      if (index(options, "-march=") == 0 .or. machine(:3) == "arm") return
      name = "x86-64"
      if (has_first(v2)) name = "x86-64-v2"
      if (has_first(v3)) name = "x86-64-v3"
      if (has_first(v4)) name = "x86-64-v4"
   end function build_level

   pure logical function has_first(count)
      integer, intent(in) :: count !! of the features
      has_first = iand(build_needs, 2**count - 1) == 2**count - 1
   end function has_first

end module poinsot_api_build
