!> Implementation of the C functions that a host calls every step: drift, kick, step, and
!> observables of an ensemble. See include/poinsot.h and cpu_check.c.
module poinsot_api_step
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_f_procpointer, &
      c_funptr, c_int, c_int64_t, c_loc, c_null_ptr, c_ptr, c_ptrdiff_t, c_size_t, c_sizeof
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_api_bodies, only: open_bodies
   use poinsot_api_plan, only: plan_handle, open_plan
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_ok, poinsot_e_memory, poinsot_e_null, poinsot_e_partial
   use poinsot_ensemble_bodies, only: body_view, column, most_bodies, open_column, &
      poinsot_bodies, view_from
   use poinsot_ensemble_check, only: check_ready
   use poinsot_ensemble_direct, only: adds_direct, is_free, kick_direct, momentum_columns, &
      rotate_direct, takes_direct
   use poinsot_ensemble_layout, only: space_momentum
   use poinsot_ensemble_plain, only: open_moments, open_plain, open_torques, plain_arrays, &
      plain_torques
   use poinsot_ensemble_system, only: torque_callback
   use poinsot_ensemble_observe, only: body_energies, body_momenta, total_degrees_of_freedom
   use poinsot_ensemble_dissipate, only: dissipate_bodies
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

   integer, parameter :: one_drift = -1

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
      integer :: left
      call drift_plain(plan, bodies, h, one_drift, left, status)
      if (left > 0) call drift_rest(plan, bodies, h, left, status)
   end function drift

   ! The rest, in procedures of their own: the short way does not pay for what is initialised there.

   !> Bodies from `first` on.
   subroutine drift_rest(plan, bodies, h, first, status)
      type(c_ptr), intent(in) :: plan, bodies
      real(c_double), intent(in) :: h
      integer, intent(in) :: first
      integer(c_int), intent(inout) :: status !! of those before it; of all
      type(plan_handle), pointer :: p
      type(body_view) :: view
      type(poinsot_error) :: error
      integer(c_int) :: before
      before = status
      call open_both(plan, bodies, p, view, status)
      if (first > 1) view = view_from(view, first)
      if (status == poinsot_ok) call drift_bodies(p%plan, view, h, status, error)
      if (status == poinsot_ok) status = before
   end subroutine drift_rest

   !> The short way, if a plan and a view ask for no more: bodies of the first class, nothing but y,
   !> q, status, and scale or moments.
   subroutine drift_plain(plan, bodies, h, steps, left, status)
      type(c_ptr), intent(in) :: plan, bodies
      real(c_double), intent(in) :: h
      integer, intent(in) :: steps           !! of h, with nothing that acts; or one_drift
      integer, intent(out) :: left           !! the first body that is for others; 0: none
      integer(c_int), intent(out) :: status  !! of those before it
      type(plan_handle), pointer :: p
      type(poinsot_bodies), pointer :: b
      type(plain_arrays) :: a
      logical :: failed, plain
      left = 1
      status = poinsot_ok
      call find_plain(plan, bodies, h, p, b, plain)
      if (plain .and. steps /= one_drift) plain = is_free(p%plan)
      if (.not. plain) return
      call open_arrays(p, b, a)
      call rotate_direct(p%plan%classes(1)%it, p%plan%method, p%plan%momentum, h, &
                         merge(1, steps, steps == one_drift), &
                         steps == one_drift .and. p%plan%momentum == space_momentum, a, failed, &
                         left)
      if (failed) status = poinsot_e_partial
   end subroutine drift_plain

   !> The same for a kick by torques in the frame of the momenta.
   subroutine kick_plain(plan, bodies, h, torque, stride, left, status)
      type(c_ptr), intent(in) :: plan, bodies, torque
      real(c_double), intent(in) :: h
      integer(c_ptrdiff_t), intent(in) :: stride
      integer, intent(out) :: left           !! the first body that is for others; 0: none
      integer(c_int), intent(out) :: status  !! of those before it
      type(plan_handle), pointer :: p
      type(poinsot_bodies), pointer :: b
      type(plain_arrays) :: a
      type(c_ptr), pointer :: bases(:)
      type(plain_torques) :: g
      logical :: failed, plain
      left = 1
      status = poinsot_ok
      call find_plain(plan, bodies, h, p, b, plain)
      if (plain) plain = c_associated(torque) .and. adds_direct(p%plan) .and. stride >= 1 .and. &
         stride <= huge(0)
      if (.not. plain) return
      call c_f_pointer(torque, bases, [3])
      plain = c_associated(bases(1)) .and. c_associated(bases(2)) .and. c_associated(bases(3))
      if (.not. plain) return
      call open_torques(int(b%n), bases, stride, g)
      call open_arrays(p, b, a)
      call kick_direct(p%plan%classes(1)%it, p%plan%momentum, h, g, a, failed, left)
      if (failed) status = poinsot_e_partial
   end subroutine kick_plain

   !> Plan and bodies, if the short way will do.
   subroutine find_plain(plan, bodies, h, p, b, plain)
      type(c_ptr), intent(in) :: plan, bodies
      real(c_double), intent(in) :: h
      type(plan_handle), pointer, intent(out) :: p
      type(poinsot_bodies), pointer, intent(out) :: b
      logical, intent(out) :: plain
      plain = .false.
      call open_plan(plan, p)
      if (.not. associated(p) .or. .not. c_associated(bodies)) return
      call c_f_pointer(bodies, b)
      if (.not. is_plain(b)) return
      plain = takes_direct(p%plan, int(b%n), c_associated(b%moments(1))) .and. &
         ieee_is_finite(h) .and. &
         (momentum_columns(p%plan) == 3 .or. c_associated(b%y_fourth))
   end subroutine find_plain

   !> The arrays of a plain view.
   subroutine open_arrays(p, b, a)
      type(plan_handle), intent(in) :: p
      type(poinsot_bodies), intent(in) :: b
      type(plain_arrays), intent(out) :: a
      if (momentum_columns(p%plan) == 4) then
         call open_plain(int(b%n), 4, [b%y, b%y_fourth], b%y_stride, b%q, b%q_stride, b%status, &
                         b%scale, a)
      else
         call open_plain(int(b%n), 3, b%y, b%y_stride, b%q, b%q_stride, b%status, &
                         b%scale, a)
      end if
      if (c_associated(b%moments(1))) call open_moments(b%moments, moments_stride(b), a)
   end subroutine open_arrays

   pure integer(c_ptrdiff_t) function moments_stride(b)
      type(poinsot_bodies), intent(in) :: b
      moments_stride = merge(1_c_ptrdiff_t, b%moments_stride, b%moments_stride == 0)
   end function moments_stride

   !> Are there but y, q, statuses, and scales or moments, as many and with such strides as can be?
   logical function is_plain(b)
      type(poinsot_bodies), intent(in) :: b
      integer :: j
      is_plain = .false.
      if (b%size /= c_sizeof(b) .or. b%n < 1 .or. b%n > most_bodies) return
      if (min(b%y_stride, b%q_stride) < 1 .or. max(b%y_stride, b%q_stride) > huge(0)) return
      do j = 1, 3
         if (.not. c_associated(b%y(j))) return
         if (c_associated(b%moments(j)) .neqv. c_associated(b%moments(1))) return
      end do
      if (c_associated(b%moments(1))) then
         if (c_associated(b%scale) .or. moments_stride(b) < 1 .or. &
             moments_stride(b) > huge(0)) return
      end if
      do j = 1, 4
         if (.not. c_associated(b%q(j))) return
      end do
      if (c_associated(b%body_class) .or. c_associated(b%carry) .or. c_associated(b%y_at) .or. &
          c_associated(b%q_at)) return
      is_plain = b%class_stride >= 0 .and. b%class_stride <= huge(0) .and. &
         (b%first_class == 0 .or. b%first_class == 1)
   end function is_plain

   !> y += h torque
   integer(c_int) function kick(plan, bodies, h, torque, stride) bind(c, name="poinsot_do_kick") &
      result(status)
      type(c_ptr), value :: plan, bodies     !! const poinsot_plan *, const poinsot_bodies *
      real(c_double), value :: h
      type(c_ptr), value :: torque           !! const double *const[3]
      integer(c_ptrdiff_t), value :: stride  !! in doubles
      integer :: left
      call kick_plain(plan, bodies, h, torque, stride, left, status)
      if (left > 0) call kick_rest(plan, bodies, h, torque, stride, left, status)
   end function kick

   subroutine kick_rest(plan, bodies, h, torque, stride, first, status)
      type(c_ptr), intent(in) :: plan, bodies, torque
      real(c_double), intent(in) :: h
      integer(c_ptrdiff_t), intent(in) :: stride
      integer, intent(in) :: first
      integer(c_int), intent(inout) :: status !! of those before it; of all
      type(plan_handle), pointer :: p
      type(body_view) :: view
      type(poinsot_error) :: error
      type(c_ptr), pointer :: bases(:)
      type(column) :: columns(3)
      integer(c_int) :: before
      integer :: j
      before = status
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
      if (first > 1) then
         view = view_from(view, first)
         do j = 1, 3
            columns(j)%of => columns(j)%of(first:)
         end do
      end if
      call kick_bodies(p%plan, view, h, columns, status, error)
      if (status == poinsot_ok) status = before
   end subroutine kick_rest

   !> Drag and noise of one step.
   integer(c_int) function dissipate(plan, bodies, h, step) &
      bind(c, name="poinsot_do_dissipate") result(status)
      type(c_ptr), value :: plan, bodies     !! const poinsot_plan *, const poinsot_bodies *
      real(c_double), value :: h
      integer(c_int64_t), value :: step
      type(plan_handle), pointer :: p
      type(body_view) :: view
      type(poinsot_error) :: error
      call open_both(plan, bodies, p, view, status)
      if (status == poinsot_ok) call dissipate_bodies(p%plan, view, h, step, status, error)
   end function dissipate

   !> Steps by the plan's splitting, with its effects and the callback.
   integer(c_int) function step(plan, bodies, t, h, first, steps, callback, context) &
         bind(c, name="poinsot_do_step") result(status)
      type(c_ptr), value :: plan, bodies     !! const poinsot_plan *, const poinsot_bodies *
      real(c_double), value :: t, h
      integer(c_int64_t), value :: first, steps
      type(c_funptr), value :: callback      !! poinsot_torque *, may be NULL
      type(c_ptr), value :: context          !! void *
      integer :: left
      left = 1
      status = poinsot_ok
      if (.not. c_associated(callback) .and. steps >= 0 .and. steps <= huge(0) .and. &
          first <= huge(first) - max(steps, 0_c_int64_t) .and. ieee_is_finite(t)) then
         call drift_plain(plan, bodies, h, int(steps), left, status)
      end if
      if (left > 0) call step_rest(plan, bodies, t, h, first, steps, callback, context, left, &
         status)
   end function step

   subroutine step_rest(plan, bodies, t, h, first, steps, callback, context, body, status)
      type(c_ptr), intent(in) :: plan, bodies, context
      real(c_double), intent(in) :: t, h
      integer(c_int64_t), intent(in) :: first, steps
      type(c_funptr), intent(in) :: callback
      integer, intent(in) :: body             !! the first of them
      integer(c_int), intent(inout) :: status !! of those before it; of all
      type(plan_handle), pointer :: p
      type(body_view) :: view
      type(poinsot_error) :: error
      type(c_callback) :: host
      integer(c_int) :: before
      before = status
      call open_both(plan, bodies, p, view, status)
      if (status /= poinsot_ok) return
      if (c_associated(callback)) then
         call c_f_procpointer(callback, host%call)
         host%context = context
         call step_bodies(p%plan, view, t, h, first, steps, status, error, host)
      else
         if (body > 1) view = view_from(view, body)
         call step_bodies(p%plan, view, t, h, first, steps, status, error)
      end if
      if (status == poinsot_ok) status = before
   end subroutine step_rest

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
