!> The public module for Fortran: `use poinsot`. Names and meanings as in C (include/poinsot.h);
!> errors are returned in `error`.
!>
!>     type(poinsot_body) :: body
!>     type(poinsot_error) :: error
!>     call poinsot_body_create([0.6d0, 0.8d0, 1.0d0], body, error)
!>     call poinsot_rotate(body, "exact", 0.01d0, 1000, y, q, error)      ! y(3, n), q(4, n)
!>     if (error%raised()) print *, error%message
!>
!> Reals are double precision, `kind(1d0)`; all names begin with `poinsot`. Quaternions, conversions
!> and inertia: `use poinsot_rotation`; elliptic functions: `use poinsot_elliptic`.
!>
!> Frames, units and rules are those of the header, except that classes count from 1; a view is
!> filled by poinsot_bodies_rows or _arrays, and the caller may point its components body_class, id,
!> carry and status to its own arrays. If a body fails, error%code is POINSOT_E_PARTIAL; the other
!> bodies are advanced.
module poinsot
   use, intrinsic :: iso_c_binding, only: c_int
   use poinsot_body_class, only: poinsot_body => body_class, make_class
   use poinsot_body_inertia, only: principal_axes
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_status, only: poinsot_ok, poinsot_e_null, poinsot_e_size, &
      poinsot_e_domain, poinsot_e_method, poinsot_e_step, poinsot_e_convergence, poinsot_e_memory, &
      poinsot_e_callback, poinsot_e_partial, poinsot_e_io, poinsot_e_scene, poinsot_e_cpu, &
      poinsot_e_not_finite, poinsot_e_not_unit, poinsot_e_axis_momentum, &
      poinsot_status_text => status_text
   use poinsot_core_version, only: poinsot_version => version_number
   use poinsot_effect_callback, only: poinsot_user_torque => user_torque, &
      poinsot_user_potential => user_potential
   use poinsot_effect_effect, only: poinsot_effect => effect
   use poinsot_effect_registry, only: poinsot_effect_count => numbered_effect_count, &
      poinsot_effect_name => numbered_effect
   use poinsot_effect_settings, only: setting
   use poinsot_effect_settings_text, only: read_settings
   use poinsot_elliptic_jacobi, only: poinsot_jacobi => jacobi_functions
   use poinsot_ensemble_bodies, only: poinsot_bodies => body_view, view_rows, view_columns, column
   use poinsot_ensemble_system, only: poinsot_torque => torque_callback
   use poinsot_ensemble_observe, only: body_energies, body_momenta, &
      poinsot_degrees_of_freedom => total_degrees_of_freedom
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_tensor_class, find_class, &
      class_axes, set_option, &
      add_effect, add_ready_effect
   use poinsot_ensemble_rotate, only: rotate_bodies
   use poinsot_ensemble_dissipate, only: dissipate_bodies
   use poinsot_ensemble_step, only: drift_bodies, kick_bodies, step_bodies
   use poinsot_free_method, only: free_method, find_method, &
      poinsot_method_count => numbered_method_count, poinsot_method_name => numbered_method
   use poinsot_splitting_registry, only: poinsot_splitting_count => numbered_count, &
      poinsot_splitting_name => numbered_splitting, poinsot_splitting_flows => splitting_flows
   implicit none(type, external)
   private
   public :: poinsot_error
   public :: poinsot_ok, poinsot_e_null, poinsot_e_size, poinsot_e_domain, poinsot_e_method, &
      poinsot_e_step
   public :: poinsot_e_convergence, poinsot_e_memory, poinsot_e_callback, &
      poinsot_e_partial, poinsot_e_io
   public :: poinsot_e_scene, poinsot_e_cpu, poinsot_e_not_finite, poinsot_e_not_unit, &
      poinsot_e_axis_momentum, poinsot_status_text, poinsot_version
   public :: poinsot_method_count, poinsot_method_name, poinsot_splitting_count, &
      poinsot_splitting_name
   public :: poinsot_splitting_flows, poinsot_effect_count, poinsot_effect_name
   public :: poinsot_body, poinsot_body_create, poinsot_body_create_tensor, poinsot_rotate, &
      poinsot_jacobi
   public :: poinsot_plan, poinsot_plan_create, poinsot_plan_add_class, poinsot_plan_find_class, &
      poinsot_plan_add_class_tensor, poinsot_plan_class_axes, poinsot_plan_set
   public :: poinsot_plan_add_effect, poinsot_plan_ready
   public :: poinsot_bodies, poinsot_bodies_rows, poinsot_bodies_arrays
   public :: poinsot_drift, poinsot_kick, poinsot_dissipate, poinsot_step, poinsot_energy, &
      poinsot_momentum, &
      poinsot_degrees_of_freedom
   public :: poinsot_torque, poinsot_effect, poinsot_user_torque, poinsot_user_potential

   interface
      !> 1 if this processor is one that the library was compiled for (src/api/cpu_check.c).
      integer(c_int) function poinsot_processor_fits() bind(c)
         import :: c_int
         implicit none(type, external)
      end function poinsot_processor_fits
   end interface

   !> Add an effect by name with its settings in one string, or one of a type of the caller's own.
   interface poinsot_plan_add_effect
      module procedure add_named_effect, add_own_effect
   end interface poinsot_plan_add_effect

   !> Steps with effects and a callback's torques; step numbers of either integer kind.
   interface poinsot_step
      module procedure step_long, step_plain
   end interface poinsot_step

   !> Drag and thermostats alone; the step number of either integer kind.
   interface poinsot_dissipate
      module procedure dissipate_long, dissipate_plain
   end interface poinsot_dissipate

contains

   !> Called first by every procedure: stop here if the processor lacks instructions of this build.
   !> Arguments are inout and not out, so that nothing is set before.
   logical function admitted(error)
      type(poinsot_error), intent(inout) :: error
      admitted = poinsot_processor_fits() == 1
      if (.not. admitted) call raise(error, poinsot_e_cpu)
   end function admitted

   !> A body from its principal moments.
   subroutine poinsot_body_create(moments, body, error, physical)
      real(dp), intent(in) :: moments(3)            !! any order, any unit
      type(poinsot_body), intent(inout) :: body
      type(poinsot_error), intent(inout) :: error   !! POINSOT_E_DOMAIN for unphysical moments
      logical, intent(in), optional :: physical     !! .false.: any that are zero or positive
      if (admitted(error)) call make_class(moments, body, error, physical)
   end subroutine poinsot_body_create

   !> A body from its inertia tensor in any frame, and the rotation whose columns are the principal
   !> axes.
   subroutine poinsot_body_create_tensor(inertia, body, axes, error, physical)
      real(dp), intent(in) :: inertia(3, 3)
      type(poinsot_body), intent(inout) :: body
      real(dp), intent(inout) :: axes(3, 3)         !! x_given = matmul(axes, x_principal)
      type(poinsot_error), intent(inout) :: error
      logical, intent(in), optional :: physical
      !! .false.: any moments that are zero or positive
      real(dp) :: moments(3)
      if (.not. admitted(error)) return
      call principal_axes(inertia, moments, axes, error, physical)
      if (.not. raised(error)) call make_class(moments, body, error, physical)
   end subroutine poinsot_body_create_tensor

   !> Free steps of n bodies with the same moments, in place.
   subroutine poinsot_rotate(body, method, h, steps, y, q, error, per_body, threads)
      type(poinsot_body), intent(in) :: body
      character(*), intent(in) :: method                          !! see poinsot_method_name
      real(dp), intent(in) :: h                                   !! step, either sign
      integer, intent(in) :: steps                                !! number of steps
      real(dp), intent(inout), target :: y(:, :)                  !! (3, n) angular momenta, body
                                                                  !! frame
      real(dp), intent(inout), target :: q(:, :)                  !! (4, n) attitudes
      type(poinsot_error), intent(inout) :: error
      integer(c_int), intent(inout), optional, target :: per_body(:) !! (n) status of each body
      integer, intent(in), optional :: threads                    !! 0 or absent: OpenMP's number
      if (admitted(error)) call rotate_rows(body, method, h, steps, y, q, error, per_body, threads)
   end subroutine poinsot_rotate

   subroutine rotate_rows(body, method, h, steps, y, q, error, per_body, threads)
      type(poinsot_body), intent(in) :: body
      character(*), intent(in) :: method
      real(dp), intent(in) :: h
      integer, intent(in) :: steps
      real(dp), intent(inout), target :: y(:, :), q(:, :)
      type(poinsot_error), intent(inout) :: error
      integer(c_int), intent(inout), optional, target :: per_body(:)
      integer, intent(in), optional :: threads
      type(free_method) :: chosen
      type(poinsot_bodies) :: view
      integer :: status, team
      call find_method(method, chosen, error)
      if (.not. raised(error)) call poinsot_bodies_rows(view, y, q, error)
      if (raised(error)) return
      if (present(per_body)) then
         if (size(per_body) < view%n) then
            call raise(error, poinsot_e_size, &
               "rotate: per_body is shorter than the number of bodies")
            return
         end if
         view%status => per_body
      end if
      team = 0
      if (present(threads)) team = threads
      call rotate_bodies(body, chosen, h, steps, view, team, status, error)
      call raise_status(status, error)
   end subroutine rotate_rows

   !> Report bodies that failed as an error.
   subroutine raise_status(status, error)
      integer, intent(in) :: status
      type(poinsot_error), intent(inout) :: error
      if (status /= poinsot_ok .and. .not. raised(error)) call raise(error, status)
   end subroutine raise_status

   !> A view of bodies in rows: y(3, n), or (4, n) for a conjugate momentum, q(4, n).
   subroutine poinsot_bodies_rows(bodies, y, q, error)
      type(poinsot_bodies), intent(inout) :: bodies
      real(dp), intent(in), target :: y(:, :)        !! momentum variable of the plan; must not be
                                                     !! moved
      real(dp), intent(in), target :: q(:, :)        !! attitudes, scalar first; must not be
                                                     !! moved
      type(poinsot_error), intent(inout) :: error    !! POINSOT_E_SIZE for shapes that do not fit
      if (size(y, 1) < 3 .or. size(y, 1) > 4 .or. size(q, 1) /= 4 .or. &
          size(y, 2) /= size(q, 2)) then
         call raise(error, poinsot_e_size, &
            "bodies in rows: the shapes must be y(3, n) or y(4, n), and q(4, n)")
      else
         call view_rows(y, q, bodies)
      end if
   end subroutine poinsot_bodies_rows

   !> A view of component arrays: y(n, 3), or (n, 4), q(n, 4). Components of other strides: point
   !> bodies%y(j)%of to them.
   subroutine poinsot_bodies_arrays(bodies, y, q, error)
      type(poinsot_bodies), intent(inout) :: bodies
      real(dp), intent(in), target :: y(:, :), q(:, :)
      type(poinsot_error), intent(inout) :: error
      if (size(y, 2) < 3 .or. size(y, 2) > 4 .or. size(q, 2) /= 4 .or. &
          size(y, 1) /= size(q, 1)) then
         call raise(error, poinsot_e_size, &
            "component arrays: the shapes must be y(n, 3) or y(n, 4), and q(n, 4)")
      else
         call view_columns(y, q, bodies)
      end if
   end subroutine poinsot_bodies_arrays

   !> Make the plan empty. A new variable of this type is empty already: this is for using it again,
   !> and for symmetry with C.
   subroutine poinsot_plan_create(plan, error)
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      if (admitted(error)) call empty(plan)
   end subroutine poinsot_plan_create

   subroutine empty(plan)
      type(poinsot_plan), intent(out) :: plan
      associate (unused => plan%ready)
      end associate
   end subroutine empty

   !> Add a body class by its moments; bodies refer to it by its number, from 1.
   subroutine poinsot_plan_add_class(plan, moments, number, error)
      type(poinsot_plan), intent(inout) :: plan
      real(dp), intent(in) :: moments(3)
      integer, intent(inout) :: number
      type(poinsot_error), intent(inout) :: error
      if (admitted(error)) call add_class(plan, moments, number, error)
   end subroutine poinsot_plan_add_class

   !> The class whose moments are nearest, each within `tolerance` times the largest (the lowest
   !> number of several); or a new one.
   subroutine poinsot_plan_find_class(plan, moments, tolerance, number, error)
      type(poinsot_plan), intent(inout) :: plan
      real(dp), intent(in) :: moments(3)
      real(dp), intent(in) :: tolerance
      integer, intent(inout) :: number
      type(poinsot_error), intent(inout) :: error
      if (admitted(error)) call find_class(plan, moments, tolerance, number, error)
   end subroutine poinsot_plan_find_class

   !> Add a body class by its tensor in the caller's body frame, to which y, q, torques and the body
   !> vectors of effects refer; poinsot_user_torque and poinsot_user_potential see it too.
   subroutine poinsot_plan_add_class_tensor(plan, inertia, number, error)
      type(poinsot_plan), intent(inout) :: plan
      real(dp), intent(in) :: inertia(3, 3)
      integer, intent(inout) :: number
      type(poinsot_error), intent(inout) :: error
      if (admitted(error)) call add_tensor_class(plan, inertia, number, error)
   end subroutine poinsot_plan_add_class_tensor

   !> The principal axes of a class as the columns of a rotation; the identity for a class made from
   !> moments.
   subroutine poinsot_plan_class_axes(plan, number, axes, error)
      type(poinsot_plan), intent(in) :: plan
      integer, intent(in) :: number                 !! of the class, from 1
      real(dp), intent(inout) :: axes(3, 3)         !! x_given = matmul(axes, x_principal)
      type(poinsot_error), intent(inout) :: error   !! POINSOT_E_DOMAIN if there is no such class
      if (admitted(error)) call class_axes(plan, number, axes, error)
   end subroutine poinsot_plan_class_axes

   !> Set an option by name: method, splitting, layout, momentum, frame, threads, seed,
   !> tolerance, physical.
   subroutine poinsot_plan_set(plan, option, value, error)
      type(poinsot_plan), intent(inout) :: plan
      character(*), intent(in) :: option, value
      type(poinsot_error), intent(inout) :: error
      if (admitted(error)) call set_option(plan, option, value, error)
   end subroutine poinsot_plan_set

   !> Add an effect: call poinsot_plan_add_effect(plan, "gravity", "centre = 0, 0, 1; weight = 2",
   !> error)
   subroutine add_named_effect(plan, name, settings, error)
      type(poinsot_plan), intent(inout) :: plan
      character(*), intent(in) :: name, settings
      type(poinsot_error), intent(inout) :: error
      type(setting), allocatable :: list(:)
      if (.not. admitted(error)) return
      call read_settings(settings, list, error, name)
      if (.not. raised(error)) call add_effect(plan, name, list, error)
   end subroutine add_named_effect

   !> Add an effect of the program's own type, an extension of poinsot_user_torque or
   !> poinsot_user_potential, in a variable `class(poinsot_effect), allocatable`. It moves into the
   !> plan. Error: POINSOT_E_METHOD for an extension of poinsot_effect alone.
   subroutine add_own_effect(plan, own, error)
      type(poinsot_plan), intent(inout) :: plan
      class(poinsot_effect), allocatable, intent(inout) :: own
      type(poinsot_error), intent(inout) :: error
      if (admitted(error)) call add_ready_effect(plan, own, error)
   end subroutine add_own_effect

   !> Check the plan and make it ready; from then on it cannot be changed.
   subroutine poinsot_plan_ready(plan, error)
      type(poinsot_plan), intent(inout), target :: plan
      type(poinsot_error), intent(inout) :: error
      if (admitted(error)) call make_ready(plan, error)
   end subroutine poinsot_plan_ready

   !> Free rotation of all bodies over h, with built-in rotors (gyrostats); no other effect acts.
   subroutine poinsot_drift(plan, bodies, h, error)
      type(poinsot_plan), intent(in) :: plan
      type(poinsot_bodies), intent(in) :: bodies
      real(dp), intent(in) :: h
      type(poinsot_error), intent(inout) :: error
      integer :: status
      if (.not. admitted(error)) return
      call drift_bodies(plan, bodies, h, status, error)
      call raise_status(status, error)
   end subroutine poinsot_drift

   !> y += h torque for all bodies.
   subroutine poinsot_kick(plan, bodies, h, torque, error)
      type(poinsot_plan), intent(in) :: plan
      type(poinsot_bodies), intent(in) :: bodies
      real(dp), intent(in) :: h
      real(dp), intent(in), target :: torque(:, :)   !! (3, n), in the plan's frame of torques
      type(poinsot_error), intent(inout) :: error
      type(column) :: columns(3)
      integer :: j, status
      if (.not. admitted(error)) return
      if (size(torque, 1) /= 3 .or. size(torque, 2) < bodies%n) then
         call raise(error, poinsot_e_size, "kick: the shape must be torque(3, n)")
         return
      end if
      do j = 1, 3
         columns(j)%of => torque(j, :)
      end do
      call kick_bodies(plan, bodies, h, columns, status, error)
      call raise_status(status, error)
   end subroutine poinsot_kick

   !> The flow of the plan's drag and thermostats over h, in the middle of a host's own step: kick
   !> h/2, drift h/2, dissipate h, drift h/2, kick h/2. With step = k it is bitwise what step k of
   !> `baoab` does.
   subroutine dissipate_long(plan, bodies, h, step, error)
      type(poinsot_plan), intent(in), target :: plan
      type(poinsot_bodies), intent(in) :: bodies
      real(dp), intent(in) :: h                      !! not negative
      integer(i8), intent(in) :: step                !! number of the step
      type(poinsot_error), intent(inout) :: error
      integer :: status
      if (.not. admitted(error)) return
      call dissipate_bodies(plan, bodies, h, step, status, error)
      call raise_status(status, error)
   end subroutine dissipate_long

   !> The same with a step number of default kind.
   subroutine dissipate_plain(plan, bodies, h, step, error)
      type(poinsot_plan), intent(in), target :: plan
      type(poinsot_bodies), intent(in) :: bodies
      real(dp), intent(in) :: h
      integer, intent(in) :: step
      type(poinsot_error), intent(inout) :: error
      call dissipate_long(plan, bodies, h, int(step, i8), error)
   end subroutine dissipate_plain

   !> Take steps number first to first + steps - 1 of size h; step k starts at t + k h.
   subroutine step_long(plan, bodies, t, h, first, steps, error, callback)
      type(poinsot_plan), intent(in), target :: plan
      type(poinsot_bodies), intent(in) :: bodies
      real(dp), intent(in) :: t, h
      integer(i8), intent(in) :: first, steps
      type(poinsot_error), intent(inout) :: error
      class(poinsot_torque), intent(inout), optional :: callback   !! the host's torques
      integer :: status
      if (.not. admitted(error)) return
      call step_bodies(plan, bodies, t, h, first, steps, status, error, callback)
      call raise_status(status, error)
   end subroutine step_long

   !> The same with step numbers of default kind.
   subroutine step_plain(plan, bodies, t, h, first, steps, error, callback)
      type(poinsot_plan), intent(in), target :: plan
      type(poinsot_bodies), intent(in) :: bodies
      real(dp), intent(in) :: t, h
      integer, intent(in) :: first, steps
      type(poinsot_error), intent(inout) :: error
      class(poinsot_torque), intent(inout), optional :: callback
      call step_long(plan, bodies, t, h, int(first, i8), int(steps, i8), error, callback)
   end subroutine step_plain

   !> Kinetic and potential energy of each body at time t.
   subroutine poinsot_energy(plan, bodies, t, kinetic, potential, error)
      type(poinsot_plan), intent(in), target :: plan
      type(poinsot_bodies), intent(in) :: bodies
      real(dp), intent(in) :: t
      real(dp), intent(inout), target :: kinetic(:), potential(:)   !! (n)
      type(poinsot_error), intent(inout) :: error
      integer :: status
      if (.not. admitted(error)) return
      call body_energies(plan, bodies, t, kinetic, potential, status, error)
      call raise_status(status, error)
   end subroutine poinsot_energy

   !> Angular momentum of each body in the space frame.
   subroutine poinsot_momentum(plan, bodies, momentum, error)
      type(poinsot_plan), intent(in) :: plan
      type(poinsot_bodies), intent(in) :: bodies
      real(dp), intent(inout), target :: momentum(:, :)   !! (3, n)
      type(poinsot_error), intent(inout) :: error
      integer :: status
      if (.not. admitted(error)) return
      call body_momenta(plan, bodies, momentum, status, error)
      call raise_status(status, error)
   end subroutine poinsot_momentum

end module poinsot
