!> C entry points that ask the library about itself: version, statuses, features, methods. See include/poinsot.h.
module poinsot_api_library
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_loc, c_null_char, c_null_ptr, c_ptr, c_size_t
   use, intrinsic :: iso_fortran_env, only: compiler_options
   use poinsot_api_text, only: from_c
   use poinsot_core_status, only: status_texts, last_status
   use poinsot_core_version, only: version_number
   use poinsot_free_method, only: method_names
   implicit none(type, external)
   private

   integer :: i !! of the tables only
   integer, parameter :: length = 80

   ! Texts as C wants them: constant, zero-terminated.
   character(length, c_char), target, save :: texts(0:last_status) = &
      [character(length, c_char) :: (trim(status_texts(i))//c_null_char, i=0, last_status)]
   character(length, c_char), target, save :: no_text = "unknown status"//c_null_char
   character(length, c_char), target, save :: names(size(method_names)) = &
      [character(length, c_char) :: (trim(method_names(i))//c_null_char, i=1, size(method_names))]

contains

   !> 10000 major + 100 minor + patch.
   integer(c_int) function poinsot_version() bind(c)
      poinsot_version = version_number
   end function poinsot_version

   !> Constant text of a status; never NULL.
   type(c_ptr) function poinsot_status_text(status) bind(c)
      integer(c_int), value :: status
      poinsot_status_text = c_loc(no_text)
      if (status >= 0 .and. status <= last_status) poinsot_status_text = c_loc(texts(status))
   end function poinsot_status_text

   !> 1 if the build has a feature: openmp, lapack, avx512, avx2, fma; else 0.
   integer(c_int) function poinsot_has_feature(name) bind(c)
      type(c_ptr), value :: name
      character(:), allocatable :: asked
      logical :: has
      has = .false.
      asked = from_c(name)
      if (allocated(asked)) then
         select case (asked)
         case ("lapack")
            has = .true.
         case ("openmp")
            !$ has = .true.
         case ("avx512")
            has = built_with("-mavx512f")
         case ("avx2", "fma")
            has = built_with("-m"//asked)
         end select
      end if
      poinsot_has_feature = merge(1_c_int, 0_c_int, has)
   end function poinsot_has_feature

   !> Was the library compiled with a flag? The compiler spells -march=native out.
   logical function built_with(flag)
      character(*), intent(in) :: flag
      built_with = index(compiler_options()//" ", flag//" ") > 0
   end function built_with

   !> How many methods there are.
   integer(c_size_t) function poinsot_method_count() bind(c)
      poinsot_method_count = size(names, kind=c_size_t)
   end function poinsot_method_count

   !> Constant name of method i, from 0; NULL past the end.
   type(c_ptr) function poinsot_method_name(i) bind(c)
      integer(c_size_t), value :: i
      poinsot_method_name = c_null_ptr
      if (i >= 0 .and. i < size(names)) poinsot_method_name = c_loc(names(i + 1))
   end function poinsot_method_name

end module poinsot_api_library
