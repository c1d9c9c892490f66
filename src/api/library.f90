!> C functions that return information about the library: version, statuses, features, methods. See
!> include/poinsot.h.
module poinsot_api_library
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, &
      c_loc, c_null_char, c_null_ptr, c_ptr, c_size_t
   use poinsot_api_build, only: built_with
   use poinsot_api_text, only: from_c
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: status_texts, last_status, poinsot_ok, poinsot_e_null, &
      poinsot_e_size
   use poinsot_effect_registry, only: numbered_effects
   use poinsot_free_method, only: numbered_methods
   use poinsot_splitting_registry, only: numbered_splittings, splitting_flows
   implicit none(type, external)
   private

   integer :: i !! of the tables only
   integer, parameter :: length = 80

   ! Texts as C wants them: constant, zero-terminated.
   character(length, c_char), target, save :: texts(0:last_status) = &
      [character(length, c_char) :: (trim(status_texts(i))//c_null_char, i=0, last_status)]
   character(length, c_char), target, save :: no_text = "unknown status"//c_null_char
   character(length, c_char), target, save :: methods(size(numbered_methods)) = &
      [character(length, c_char) :: (trim(numbered_methods(i))//c_null_char, i=1, &
         size(numbered_methods))]
   character(length, c_char), target, save :: splittings(size(numbered_splittings)) = &
      [character(length, c_char) :: (trim(numbered_splittings(i))//c_null_char, i=1, &
         size(numbered_splittings))]
   character(length, c_char), target, save :: effects(size(numbered_effects)) = &
      [character(length, c_char) :: (trim(numbered_effects(i))//c_null_char, i=1, &
         size(numbered_effects))]

contains

   !> Constant text of a status; never NULL.
   type(c_ptr) function status_text(status) bind(c, name="poinsot_do_status_text")
      integer(c_int), value :: status
      status_text = c_loc(no_text)
      if (status >= 0 .and. status <= last_status) status_text = c_loc(texts(status))
   end function status_text

   !> 1 if the build has a feature: openmp, lapack, release, avx512 and others of the processor, a
   !> level of processors; else 0.
   integer(c_int) function has_feature(name) bind(c, name="poinsot_do_has_feature")
      type(c_ptr), value :: name
      character(:), allocatable :: asked
      logical :: has
      has = .false.
      call from_c(name, asked)
      if (allocated(asked)) then
         select case (asked)
         case ("lapack")
            has = .true.
         case ("openmp")
            !$ has = .true.
         case ("avx512")
            has = built_with("avx512f")
         case default
            has = built_with(asked)
         end select
      end if
      has_feature = merge(1_c_int, 0_c_int, has)
   end function has_feature

   !> How many methods there are.
   integer(c_size_t) function method_count() bind(c, name="poinsot_do_method_count")
      method_count = size(methods, kind=c_size_t)
   end function method_count

   !> Constant name of method i, from 0; NULL past the end.
   type(c_ptr) function method_name(i) bind(c, name="poinsot_do_method_name")
      integer(c_size_t), value :: i
      method_name = name_of(methods, i)
   end function method_name

   !> How many splittings there are.
   integer(c_size_t) function splitting_count() bind(c, name="poinsot_do_splitting_count")
      splitting_count = size(splittings, kind=c_size_t)
   end function splitting_count

   !> Constant name of splitting i, from 0; NULL past the end.
   type(c_ptr) function splitting_name(i) bind(c, name="poinsot_do_splitting_name")
      integer(c_size_t), value :: i
      splitting_name = name_of(splittings, i)
   end function splitting_name

   !> A step of a splitting as pairs of kick and drift.
   integer(c_int) function flows_of(name, capacity, kick, drift, count) bind(c, &
      name="poinsot_do_splitting_flows") &
         result(status)
      type(c_ptr), value :: name             !! const char *
      integer(c_size_t), value :: capacity   !! of the arrays
      type(c_ptr), value :: kick, drift      !! double[capacity]
      type(c_ptr), value :: count            !! size_t *: how many pairs there are, also when they
                                             !! do not fit
      character(:), allocatable :: asked
      real(dp), allocatable :: kicks(:), drifts(:)
      real(c_double), pointer :: x(:)
      integer(c_size_t), pointer :: n
      type(poinsot_error) :: error
      status = poinsot_e_null
      if (.not. c_associated(count)) return
      call c_f_pointer(count, n)
      n = 0
      call from_c(name, asked)
      if (.not. allocated(asked)) return
      call splitting_flows(asked, kicks, drifts, error)
      status = error%code
      if (raised(error)) return
      n = size(kicks, kind=c_size_t)
      status = poinsot_e_size
      if (capacity >= 0 .and. capacity < n) return
      status = poinsot_e_null
      if (.not. (c_associated(kick) .and. c_associated(drift))) return
      call c_f_pointer(kick, x, [n])
      x = kicks
      call c_f_pointer(drift, x, [n])
      x = drifts
      status = poinsot_ok
   end function flows_of

   !> How many effects there are.
   integer(c_size_t) function effect_count() bind(c, name="poinsot_do_effect_count")
      effect_count = size(effects, kind=c_size_t)
   end function effect_count

   !> Constant name of effect i, from 0; NULL past the end.
   type(c_ptr) function effect_name(i) bind(c, name="poinsot_do_effect_name")
      integer(c_size_t), value :: i
      effect_name = name_of(effects, i)
   end function effect_name

   type(c_ptr) function name_of(names, i)
      character(length, c_char), intent(in), target :: names(:)
      integer(c_size_t), intent(in) :: i
      name_of = c_null_ptr
      if (i >= 0 .and. i < size(names)) name_of = c_loc(names(i + 1))
   end function name_of

end module poinsot_api_library
