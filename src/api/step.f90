!> Behind the C entry points that a host calls every step: drift, kick, step, and what an ensemble
!> has. See include/poinsot.h and cpu_check.c.
module poinsot_api_step
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_f_procpointer, &
      c_funptr, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr, c_ptrdiff_t, c_size_t
   use poinsot_api_bodies, only: open_bodies
   use poinsot_api_plan, only: plan_handle, open_plan
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_ok, poinsot_e_memory, poinsot_e_null
   use poinsot_ensemble_bodies, only: body_view, column, open_column
   use poinsot_ensemble_check, only: check_ready
   use poinsot_ensemble_system, only: torque_callback
   use poinsot_ensemble_observe, only: body_energies, body_momenta, total_degrees_of_freedom
   use poinsot_ensemble_step, only: drift_bodies, kick_bodies, step_bodies
   implicit none(type, external)
   private

   abstract interface
      !> poinsot_torque of poinsot.h
      integer(c_int) function torque_function(context, t, n, q, q_stride, torque, torque_stride, &
         energy) bind(c)
         import :: c_double, c_int, c_ptr, c_ptrdiff_t, c_size_t
         implicit none(type, external)
         type(c_ptr), value :: context
         real(c_double), value :: t
         integer(c_size_t), value :: n
         type(c_ptr), intent(in) :: q(4)
         integer(c_ptrdiff_t), value :: q_stride
         type(c_ptr), intent(in) :: torque(3)
         integer(c_ptrdiff_t), value :: torque_stride
         real(c_double), intent(inout) :: energy
      end function torque_function
   end interface

   !> A host's C function with its context.
   type, extends(torque_callback) :: c_callback
      procedure(torque_function), pointer, nopass :: call => null()
      type(c_ptr) :: context = c_null_ptr
   contains
      procedure :: evaluate => evaluate_c
   end type c_callback

contains

   !> Plan and bodies of a call.
   subroutine open_both(plan, bodies, p, view, status)
      type(c_ptr), intent(in) :: plan, bodies
      type(plan_handle), pointer, intent(out) :: p
      type(body_view), intent(out) :: view
      integer(c_int), intent(out) :: status
      type(poinsot_error) :: error
      status = poinsot_e_null
      call open_plan(plan, p)
      if (.not. associated(p)) return
      call open_bodies(bodies, view, error)
      status = error%code
   end subroutine open_both

   !> Free rotation.
   integer(c_int) function drift(plan, bodies, h) bind(c, name="poinsot_do_drift") result(status)
      type(c_ptr), value :: plan, bodies     !! const poinsot_plan *, const poinsot_bodies *
      real(c_double), value :: h
      type(plan_handle), pointer :: p
      type(body_view) :: view
      type(poinsot_error) :: error
      call open_both(plan, bodies, p, view, status)
      if (status == poinsot_ok) call drift_bodies(p%plan, view, h, status, error)
   end function drift

   !> y += h torque
   integer(c_int) function kick(plan, bodies, h, torque, stride) bind(c, name="poinsot_do_kick") &
      result(status)
      type(c_ptr), value :: plan, bodies     !! const poinsot_plan *, const poinsot_bodies *
      real(c_double), value :: h
      type(c_ptr), value :: torque           !! const double *const[3]
      integer(c_ptrdiff_t), value :: stride  !! in doubles
      type(plan_handle), pointer :: p
      type(body_view) :: view
      type(poinsot_error) :: error
      type(c_ptr), pointer :: bases(:)
      type(column) :: columns(3)
      integer :: j
      call open_both(plan, bodies, p, view, status)
      if (status /= poinsot_ok) return
      status = poinsot_e_null
      if (.not. c_associated(torque)) return
      if (view%n > 0) then
         call c_f_pointer(torque, bases, [3])
         do j = 1, 3
            call open_column(bases(j), int(view%n, c_size_t), stride, "torque", columns(j), error)
         end do
         status = error%code
         if (raised(error)) return
      end if
      call kick_bodies(p%plan, view, h, columns, status, error)
   end function kick

   !> Steps by the plan's splitting, with its effects and the callback.
   integer(c_int) function step(plan, bodies, t, h, first, steps, callback, context) &
         bind(c, name="poinsot_do_step") result(status)
      type(c_ptr), value :: plan, bodies     !! const poinsot_plan *, const poinsot_bodies *
      real(c_double), value :: t, h
      integer(c_int64_t), value :: first, steps
      type(c_funptr), value :: callback      !! poinsot_torque *, may be NULL
      type(c_ptr), value :: context          !! void *
      type(plan_handle), pointer :: p
      type(body_view) :: view
      type(poinsot_error) :: error
      type(c_callback) :: host
      call open_both(plan, bodies, p, view, status)
      if (status /= poinsot_ok) return
      if (c_associated(callback)) then
         call c_f_procpointer(callback, host%call)
         host%context = context
         call step_bodies(p%plan, view, t, h, first, steps, status, error, host)
      else
         call step_bodies(p%plan, view, t, h, first, steps, status, error)
      end if
   end function step

   subroutine evaluate_c(self, t, q, torque, energy, stop)
      class(c_callback), intent(inout) :: self
      real(dp), intent(in) :: t
      real(dp), intent(in), target :: q(:, :)
      real(dp), intent(inout), target :: torque(:, :)
      real(dp), intent(inout) :: energy
      logical, intent(inout) :: stop
      type(c_ptr) :: attitudes(4), torques(3)
      integer :: j
      if (size(q, 1) == 0) return
      do j = 1, 4
         attitudes(j) = c_loc(q(1, j))
      end do
      do j = 1, 3
         torques(j) = c_loc(torque(1, j))
      end do
      stop = self%call(self%context, t, size(q, 1, c_size_t), attitudes, 1_c_ptrdiff_t, torques, &
         1_c_ptrdiff_t, energy) /= 0
   end subroutine evaluate_c

   !> Energies of each body.
   integer(c_int) function energy(plan, bodies, t, kinetic, potential) &
      bind(c, name="poinsot_do_energy") result(status)
      type(c_ptr), value :: plan, bodies         !! const poinsot_plan *, const poinsot_bodies *
      real(c_double), value :: t
      type(c_ptr), value :: kinetic, potential   !! double[n], may be NULL
      type(plan_handle), pointer :: p
      type(body_view) :: view
      type(poinsot_error) :: error
      real(dp), pointer :: k(:), u(:)
      real(dp), allocatable, target :: unwanted(:)
      integer :: state
      call open_both(plan, bodies, p, view, status)
      if (status /= poinsot_ok) return
      status = poinsot_e_memory
      allocate (unwanted(merge(0, view%n, &
                c_associated(kinetic) .and. c_associated(potential))), stat=state)
      if (state /= 0) return
      k => unwanted
      u => unwanted
      if (c_associated(kinetic)) call c_f_pointer(kinetic, k, [view%n])
      if (c_associated(potential)) call c_f_pointer(potential, u, [view%n])
      if (c_associated(kinetic) .or. c_associated(potential)) then
         call body_energies(p%plan, view, t, k, u, status, error)
      else
         call check_ready(p%plan, view, error)
         status = error%code
      end if
   end function energy

   !> Angular momentum of each body in space.
   integer(c_int) function momentum(plan, bodies, space) bind(c, name="poinsot_do_momentum") &
      result(status)
      type(c_ptr), value :: plan, bodies     !! const poinsot_plan *, const poinsot_bodies *
      type(c_ptr), value :: space            !! double[n][3]
      type(plan_handle), pointer :: p
      type(body_view) :: view
      type(poinsot_error) :: error
      real(dp), pointer :: l(:, :)
      call open_both(plan, bodies, p, view, status)
      if (status == poinsot_ok .and. view%n == 0) then
         call check_ready(p%plan, view, error)
         status = error%code
         return
      end if
      if (status /= poinsot_ok) return
      status = poinsot_e_null
      if (.not. c_associated(space)) return
      call c_f_pointer(space, l, [3, view%n])
      call body_momenta(p%plan, view, l, status, error)
   end function momentum

   !> Rotational degrees of freedom of all bodies.
   integer(c_int) function degrees_of_freedom(plan, bodies, total) &
      bind(c, name="poinsot_do_degrees_of_freedom") result(status)
      type(c_ptr), value :: plan, bodies     !! const poinsot_plan *, const poinsot_bodies *
      type(c_ptr), value :: total            !! size_t *
      type(plan_handle), pointer :: p
      type(body_view) :: view
      type(poinsot_error) :: error
      integer(c_size_t), pointer :: number
      call open_both(plan, bodies, p, view, status)
      if (status /= poinsot_ok) return
      status = poinsot_e_null
      if (.not. c_associated(total)) return
      call c_f_pointer(total, number)
      call check_ready(p%plan, view, error)
      status = error%code
      if (raised(error)) return
      number = total_degrees_of_freedom(p%plan, view)
      status = poinsot_ok
   end function degrees_of_freedom

end module poinsot_api_step
