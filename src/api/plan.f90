!> Implementation of the C functions for the plan. See include/poinsot.h and cpu_check.c.
module poinsot_api_plan
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_loc, &
      c_null_ptr, c_ptr, c_size_t
   use poinsot_api_bodies, only: open_bodies
   use poinsot_api_text, only: from_c, to_c
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_memory, poinsot_e_null
   use poinsot_effect_settings, only: setting
   use poinsot_effect_settings_text, only: read_settings
   use poinsot_ensemble_bodies, only: body_view
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_tensor_class, find_class, &
      class_axes, &
      set_option, &
      add_effect
   use poinsot_ensemble_check, only: check_ready, check_purpose, to_drift
   use poinsot_ensemble_layout, only: conjugate_momentum
   implicit none(type, external)
   private
   public :: plan_handle, open_plan

   !> What a C host holds: a plan, and why the last call that would change it failed.
   type :: plan_handle
      type(poinsot_plan) :: plan
      character(:), allocatable :: message
   end type plan_handle

contains

   !> A new plan.
   integer(c_int) function plan_create(plan) bind(c, name="poinsot_do_plan_create") result(status)
      type(c_ptr), value :: plan     !! poinsot_plan **
      type(c_ptr), pointer :: handle
      type(plan_handle), pointer :: p
      integer :: state
      status = poinsot_e_null
      if (.not. c_associated(plan)) return
      call c_f_pointer(plan, handle)
      handle = c_null_ptr
      allocate (p, stat=state)
      status = merge(poinsot_ok, poinsot_e_memory, state == 0)
      if (state == 0) handle = c_loc(p)
   end function plan_create

   !> Give a plan back, and set the handle to NULL.
   subroutine plan_destroy(plan) bind(c, name="poinsot_do_plan_destroy")
      type(c_ptr), value :: plan     !! poinsot_plan **
      type(c_ptr), pointer :: handle
      type(plan_handle), pointer :: p
      if (.not. c_associated(plan)) return
      call c_f_pointer(plan, handle)
      call open_plan(handle, p)
      if (associated(p)) deallocate (p)
      handle = c_null_ptr
   end subroutine plan_destroy

   !> The plan behind a handle; not associated for NULL.
   subroutine open_plan(plan, p)
      type(c_ptr), intent(in) :: plan
      type(plan_handle), pointer, intent(out) :: p
      nullify (p)
      if (c_associated(plan)) call c_f_pointer(plan, p)
   end subroutine open_plan

   !> Status of a change, its message kept with the plan. A plan that is ready may be shared:
   !> nothing is written to it.
   integer(c_int) function answer(p, error)
      type(plan_handle), intent(inout) :: p
      type(poinsot_error), intent(in) :: error
      answer = error%code
      if (p%plan%ready .and. raised(error)) return
      if (allocated(p%message)) deallocate (p%message)
      if (raised(error)) p%message = error%message
   end function answer

   !> Add a body class by its moments.
   integer(c_int) function plan_add_class(plan, moments, number) &
      bind(c, name="poinsot_do_plan_add_class") result(status)
      type(c_ptr), value :: plan      !! poinsot_plan *
      type(c_ptr), value :: moments   !! const double[3]
      type(c_ptr), value :: number    !! int *, may be NULL
      status = add_any(plan, moments, .false., number)
   end function plan_add_class

   !> Add a body class by its inertia tensor, row-major.
   integer(c_int) function plan_add_class_tensor(plan, inertia, number) &
         bind(c, name="poinsot_do_plan_add_class_tensor") result(status)
      type(c_ptr), value :: plan      !! poinsot_plan *
      type(c_ptr), value :: inertia   !! const double[9]
      type(c_ptr), value :: number    !! int *, may be NULL
      status = add_any(plan, inertia, .true., number)
   end function plan_add_class_tensor

   integer(c_int) function add_any(plan, numbers, is_tensor, number) result(status)
      type(c_ptr), intent(in) :: plan, numbers, number
      logical, intent(in) :: is_tensor
      type(plan_handle), pointer :: p
      type(poinsot_error) :: error
      real(c_double), pointer :: x(:)
      integer(c_int), pointer :: place
      integer :: made
      status = poinsot_e_null
      call open_plan(plan, p)
      if (.not. associated(p)) return
      made = 0
      if (.not. c_associated(numbers)) then
         call raise(error, poinsot_e_null, "plan: moments or tensor of a body class are NULL")
      else if (is_tensor) then
         call c_f_pointer(numbers, x, [9])
         call add_tensor_class(p%plan, transpose(reshape(x, [3, 3])), made, error)
      else
         call c_f_pointer(numbers, x, [3])
         call add_class(p%plan, x, made, error)
      end if
      status = answer(p, error)
      if (raised(error) .or. .not. c_associated(number)) return
      call c_f_pointer(number, place)
      place = made - 1
   end function add_any

   !> The class with moments near to those given, or a new one.
   integer(c_int) function plan_find_class(plan, moments, tolerance, number) &
         bind(c, name="poinsot_do_plan_find_class") result(status)
      type(c_ptr), value :: plan          !! poinsot_plan *
      type(c_ptr), value :: moments       !! const double[3]
      real(c_double), value :: tolerance  !! relative to the largest moment
      type(c_ptr), value :: number        !! int *, may be NULL
      type(plan_handle), pointer :: p
      type(poinsot_error) :: error
      real(c_double), pointer :: x(:)
      integer(c_int), pointer :: place
      integer :: found
      status = poinsot_e_null
      call open_plan(plan, p)
      if (.not. associated(p)) return
      found = 0
      if (.not. c_associated(moments)) then
         call raise(error, poinsot_e_null, "plan: moments of a body class are NULL")
      else
         call c_f_pointer(moments, x, [3])
         call find_class(p%plan, x, tolerance, found, error)
      end if
      status = answer(p, error)
      if (raised(error) .or. .not. c_associated(number)) return
      call c_f_pointer(number, place)
      place = found - 1
   end function plan_find_class

   !> Principal axes of a class, as columns, row-major.
   integer(c_int) function plan_class_axes(plan, number, axes) &
      bind(c, name="poinsot_do_plan_class_axes") result(status)
      type(c_ptr), value :: plan           !! const poinsot_plan *
      integer(c_int), value :: number      !! from 0
      type(c_ptr), value :: axes           !! double[9]
      type(plan_handle), pointer :: p
      type(poinsot_error) :: error
      real(c_double), pointer :: a(:, :)
      real(c_double) :: columns(3, 3)
      status = poinsot_e_null
      call open_plan(plan, p)
      if (.not. associated(p) .or. .not. c_associated(axes)) return
      call class_axes(p%plan, int(max(min(number, huge(number) - 1), -1_c_int)) + 1, columns, error)
      status = error%code
      if (raised(error)) return
      call c_f_pointer(axes, a, [3, 3])
      a = transpose(columns)
   end function plan_class_axes

   !> Set an option by name.
   integer(c_int) function plan_set(plan, option, value) bind(c, name="poinsot_do_plan_set") &
      result(status)
      type(c_ptr), value :: plan             !! poinsot_plan *
      type(c_ptr), value :: option, value    !! const char *
      type(plan_handle), pointer :: p
      type(poinsot_error) :: error
      character(:), allocatable :: key, text
      status = poinsot_e_null
      call open_plan(plan, p)
      if (.not. associated(p)) return
      call from_c(option, key)
      call from_c(value, text)
      if (allocated(key) .and. allocated(text)) then
         call set_option(p%plan, key, text, error)
      else
         call raise(error, poinsot_e_null, "plan: the name or the value of an option is NULL")
      end if
      status = answer(p, error)
   end function plan_set

   !> Add an effect by name, with settings in one text.
   integer(c_int) function plan_add_effect(plan, name, settings) &
      bind(c, name="poinsot_do_plan_add_effect") result(status)
      type(c_ptr), value :: plan             !! poinsot_plan *
      type(c_ptr), value :: name             !! const char *
      type(c_ptr), value :: settings         !! const char *, may be NULL
      type(plan_handle), pointer :: p
      type(poinsot_error) :: error
      type(setting), allocatable :: list(:)
      character(:), allocatable :: which, text
      status = poinsot_e_null
      call open_plan(plan, p)
      if (.not. associated(p)) return
      call from_c(name, which)
      call from_c(settings, text)
      if (.not. c_associated(settings)) text = ""
      if (.not. c_associated(name)) then
         call raise(error, poinsot_e_null, "plan: the name of an effect is NULL")
      else if (.not. (allocated(which) .and. allocated(text))) then
         call raise(error, poinsot_e_memory, "no memory for the settings of an effect")
      else
         call read_settings(text, list, error, which)
         if (.not. raised(error)) call add_effect(p%plan, which, list, error)
      end if
      status = answer(p, error)
   end function plan_add_effect

   !> Close the plan.
   integer(c_int) function plan_ready(plan) bind(c, name="poinsot_do_plan_ready") result(status)
      type(c_ptr), value :: plan             !! poinsot_plan *
      type(plan_handle), pointer :: p
      type(poinsot_error) :: error
      status = poinsot_e_null
      call open_plan(plan, p)
      if (.not. associated(p)) return
      call make_ready(p%plan, error)
      status = answer(p, error)
   end function plan_ready

   !> How many components the momentum has, for fixed form: 3, or 4 if it is conjugate.
   integer(c_int) function plan_components(plan) bind(c, name="poinsot_do_plan_components") &
      result(components)
      type(c_ptr), value :: plan             !! const poinsot_plan *
      type(plan_handle), pointer :: p
      components = 3
      call open_plan(plan, p)
      if (.not. associated(p)) return
      if (p%plan%momentum == conjugate_momentum) components = 4
   end function plan_components

   !> Length of the message of the last change that failed, and as much of it as the buffer takes.
   integer(c_size_t) function plan_message(plan, buffer, capacity) &
      bind(c, name="poinsot_do_plan_message") result(length)
      type(c_ptr), value :: plan             !! const poinsot_plan *
      type(c_ptr), value :: buffer           !! char *, may be NULL
      integer(c_size_t), value :: capacity   !! bytes in it
      type(plan_handle), pointer :: p
      length = 0
      call open_plan(plan, p)
      if (.not. associated(p)) return
      if (.not. allocated(p%message)) return
      length = len(p%message, kind=c_size_t)
      call to_c(p%message, buffer, capacity)
   end function plan_message

   !> Would poinsot_drift take these bodies with this plan? The reason if not goes to the buffer.
   integer(c_int) function bodies_check(plan, bodies, buffer, capacity) &
      bind(c, name="poinsot_do_bodies_check") result(status)
      type(c_ptr), value :: plan             !! const poinsot_plan *
      type(c_ptr), value :: bodies           !! const poinsot_bodies *
      type(c_ptr), value :: buffer           !! char *, may be NULL
      integer(c_size_t), value :: capacity   !! bytes in it
      type(plan_handle), pointer :: p
      type(body_view) :: view
      type(poinsot_error) :: error
      call open_plan(plan, p)
      call open_bodies(bodies, view, error)
      if (.not. associated(p)) then
         call raise(error, poinsot_e_null, "the plan is NULL")
      else if (.not. raised(error)) then
         call check_ready(p%plan, view, error)
         if (.not. raised(error)) call check_purpose(p%plan, view, to_drift, error)
      end if
      status = error%code
      if (raised(error)) call to_c(error%message, buffer, capacity)
   end function bodies_check

end module poinsot_api_plan
