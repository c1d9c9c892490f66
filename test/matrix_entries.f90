!> The ways into the library, for the matrix of entries: the same problem by `use poinsot`, by the C
!> interface, and as the text of a scene. (Fixed form: matrix_fixed.f90.)
module test_matrix_entries
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_funloc, c_funptr, c_int, c_int64_t, &
      c_intptr_t, c_loc, c_null_char, c_null_funptr, c_null_ptr, c_ptr, c_size_t, c_sizeof
   use poinsot, only: poinsot_plan, poinsot_bodies, poinsot_error, poinsot_plan_add_class, &
      poinsot_plan_add_class_tensor, poinsot_plan_set, poinsot_plan_add_effect, &
      poinsot_plan_ready, poinsot_bodies_rows, poinsot_bodies_arrays, poinsot_step, &
      poinsot_energy
   use poinsot_core_kinds, only: dp, i8
   use poinsot_scene_run, only: run_scene
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_summary, only: run_report
   use poinsot_scene_text, only: text_of
   use poinsot_scene_watch, only: run_watch
   use test_matrix_host, only: top_data, fortran_top, c_top, momentum_names, to_variable, &
      from_variable
   use test_matrix_oracle, only: energy_source
   use test_matrix_problem, only: problem, n, classes, steps, h, settings_text, tensor_of
   use test_random_scenes, only: scene_from
   implicit none(type, external)
   private
   public :: outcome, by_fortran, by_c, by_scene, plan_energy, class_of, is_space, moments, &
      tensor, keep

   !> Where the bodies are after all steps, momenta in the body frame of the problem.
   type :: outcome
      real(dp) :: y(3, n) = 0, q(4, n) = 0, kinetic(n) = 0, potential(n) = 0
      integer :: status = 0
      character(:), allocatable :: message
   end type outcome

   !> The view of C, as in poinsot.h.
   type, bind(c) :: c_bodies
      integer(c_size_t) :: size = 0, n = 0
      type(c_ptr) :: y(3) = c_null_ptr, q(4) = c_null_ptr
      integer(c_intptr_t) :: y_stride = 0, q_stride = 0
      type(c_ptr) :: body_class = c_null_ptr, id = c_null_ptr, carry = c_null_ptr, &
         status = c_null_ptr, y_fourth = c_null_ptr
      integer(c_intptr_t) :: first_class = 0, class_stride = 0
      type(c_ptr) :: y_at = c_null_ptr, q_at = c_null_ptr
      integer(c_size_t) :: rows = 0
      type(c_ptr) :: scale = c_null_ptr, moments(3) = c_null_ptr
      integer(c_intptr_t) :: moments_stride = 0
   end type c_bodies

   interface
      integer(c_int) function plan_create(plan) bind(c, name="poinsot_plan_create")
         import :: c_int, c_ptr
         implicit none(type, external)
         type(c_ptr), intent(out) :: plan
      end function plan_create
      subroutine plan_destroy(plan) bind(c, name="poinsot_plan_destroy")
         import :: c_ptr
         implicit none(type, external)
         type(c_ptr), intent(inout) :: plan
      end subroutine plan_destroy
      integer(c_int) function plan_add_class(plan, moments, number) &
            bind(c, name="poinsot_plan_add_class")
         import :: c_int, c_ptr, c_double
         implicit none(type, external)
         type(c_ptr), value :: plan
         real(c_double), intent(in) :: moments(3)
         integer(c_int), intent(out) :: number
      end function plan_add_class
      integer(c_int) function plan_add_tensor(plan, inertia, number) &
            bind(c, name="poinsot_plan_add_class_tensor")
         import :: c_int, c_ptr, c_double
         implicit none(type, external)
         type(c_ptr), value :: plan
         real(c_double), intent(in) :: inertia(3, 3)
         integer(c_int), intent(out) :: number
      end function plan_add_tensor
      integer(c_int) function plan_set(plan, option, to) bind(c, name="poinsot_plan_set")
         import :: c_int, c_ptr, c_char
         implicit none(type, external)
         type(c_ptr), value :: plan
         character(kind=c_char), intent(in) :: option(*), to(*)
      end function plan_set
      integer(c_int) function plan_add_effect(plan, name, settings) &
            bind(c, name="poinsot_plan_add_effect")
         import :: c_int, c_ptr, c_char
         implicit none(type, external)
         type(c_ptr), value :: plan
         character(kind=c_char), intent(in) :: name(*), settings(*)
      end function plan_add_effect
      integer(c_int) function plan_ready(plan) bind(c, name="poinsot_plan_ready")
         import :: c_int, c_ptr
         implicit none(type, external)
         type(c_ptr), value :: plan
      end function plan_ready
      integer(c_int) function bodies_rows(bodies, size, layout, order, n, momentum, attitude) &
            bind(c, name="poinsot_bodies_rows_sized")
         import :: c_int, c_ptr, c_char, c_size_t, c_bodies
         implicit none(type, external)
         type(c_bodies), intent(inout) :: bodies
         integer(c_size_t), value :: size, n
         character(kind=c_char), intent(in) :: layout(*), order(*)
         type(c_ptr), value :: momentum, attitude
      end function bodies_rows
      integer(c_int) function step(plan, bodies, t, h, first, steps, callback, context) &
            bind(c, name="poinsot_step")
         import :: c_int, c_ptr, c_double, c_int64_t, c_funptr, c_bodies
         implicit none(type, external)
         type(c_ptr), value :: plan, context
         type(c_bodies), intent(in) :: bodies
         real(c_double), value :: t, h
         integer(c_int64_t), value :: first, steps
         type(c_funptr), value :: callback
      end function step
      integer(c_int) function energy(plan, bodies, t, kinetic, potential) &
            bind(c, name="poinsot_energy")
         import :: c_int, c_ptr, c_double, c_bodies
         implicit none(type, external)
         type(c_ptr), value :: plan
         type(c_bodies), intent(in) :: bodies
         real(c_double), value :: t
         real(c_double), intent(out) :: kinetic(*), potential(*)
      end function energy
   end interface

   !> Energies by a plan that knows some effects only.
   type, extends(energy_source) :: plan_energy
      type(problem) :: of
      character(:), allocatable :: name     !! the effect; "" = all
      type(poinsot_plan) :: plan
      logical :: ready = .false.
   contains
      procedure :: total
   end type plan_energy

   integer, parameter :: class_of(n) = [1, 2, 3]

contains

   !> `use poinsot`: momentum variable 1 to 5, in rows or in component arrays.
   subroutine by_fortran(this, form, splitting, in_rows, got)
      type(problem), intent(in) :: this
      integer, intent(in) :: form
      character(*), intent(in) :: splitting
      logical, intent(in) :: in_rows
      type(outcome), intent(out) :: got
      type(poinsot_plan), target :: plan
      type(poinsot_bodies) :: view
      type(poinsot_error) :: error
      type(fortran_top) :: top
      real(dp), target :: p(4, n), q(4, n), pt(n, 4), qt(n, 4)
      integer(c_int), target :: class(n)
      integer :: width
      call fortran_plan(this, form, splitting, "", plan, error)
      width = merge(4, 3, form == 5)
      q = this%q
      p = to_variable(this, form, this%y, this%q)
      pt = transpose(p)
      qt = transpose(q)
      class = class_of
      if (in_rows) call poinsot_bodies_rows(view, p(:width, :), q, error)
      if (.not. in_rows) call poinsot_bodies_arrays(view, pt(:, :width), qt, error)
      view%body_class => class
      top%data = top_data(this%centre, merge(1, 0, is_space(form)))
      if (.not. error%raised()) then
         if (this%hosted) then
            call poinsot_step(plan, view, 0.0_dp, h, 0, steps, error, top)
         else
            call poinsot_step(plan, view, 0.0_dp, h, 0, steps, error)
         end if
      end if
      if (.not. error%raised()) call poinsot_energy(plan, view, steps*h, got%kinetic, &
         got%potential, error)
      got%status = error%code
      if (error%raised()) got%message = error%message
      if (.not. in_rows) p(:width, :) = transpose(pt(:, :width))
      if (.not. in_rows) q = transpose(qt)
      got%q = q
      got%y = from_variable(this, form, p, q)
   end subroutine by_fortran

   subroutine fortran_plan(this, form, splitting, only, plan, error)
      type(problem), intent(in) :: this
      integer, intent(in) :: form
      character(*), intent(in) :: splitting, only
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      integer :: c, i, number
      do c = 1, classes
         if (this%by_tensor) call poinsot_plan_add_class_tensor(plan, tensor(this, c), number, &
            error)
         if (.not. this%by_tensor) call poinsot_plan_add_class(plan, moments(this, c), number, &
            error)
      end do
      call poinsot_plan_set(plan, "momentum", trim(momentum_names(form)), error)
      call poinsot_plan_set(plan, "frame", frame_name(form), error)
      call poinsot_plan_set(plan, "splitting", splitting, error)
      if (splitting == "taylor") call poinsot_plan_set(plan, "tolerance", "1e-15", error)
      call poinsot_plan_set(plan, "seed", text_of(this%number), error)
      do i = 1, size(this%effects)
         if (only /= "" .and. only /= this%effects(i)%name) cycle
         if (.not. error%raised()) call poinsot_plan_add_effect(plan, this%effects(i)%name, &
            settings_text(this%effects(i), .false.), error)
      end do
      if (.not. error%raised()) call poinsot_plan_ready(plan, error)
   end subroutine fortran_plan

   real(dp) function total(self, t, q)
      class(plan_energy), intent(inout), target :: self
      real(dp), intent(in) :: t, q(4, n)
      type(poinsot_bodies) :: view
      type(poinsot_error) :: error
      real(dp), target :: y(3, n), x(4, n), kinetic(n), potential(n)
      integer(c_int), target :: class(n)
      integer :: i
      if (.not. self%ready) call fortran_plan(self%of, 1, "srkn6", self%name, self%plan, error)
      self%ready = .true.
      y = 0
      do i = 1, n
         x(:, i) = q(:, i)/norm2(q(:, i))
      end do
      class = class_of
      call poinsot_bodies_rows(view, y, x, error)
      view%body_class => class
      call poinsot_energy(self%plan, view, t, kinetic, potential, error)
      total = sum(potential)
      if (error%raised()) error stop "matrix: no energy"
   end function total

   !> The C interface; layouts by their names where there is one.
   subroutine by_c(this, form, splitting, got)
      type(problem), intent(in) :: this
      integer, intent(in) :: form
      character(*), intent(in) :: splitting
      type(outcome), intent(out) :: got
      character(7), parameter :: layouts(5) = [character(7) :: "native", "lammps", "dl_poly", &
         "native", "hoomd"]
      type(c_ptr) :: plan
      type(c_bodies) :: view
      type(top_data), target :: top
      real(c_double), target :: p(4, n), q(4, n), p3(3, n)
      integer(c_int), target :: class(n)
      integer(c_int) :: number
      type(c_funptr) :: callback
      integer :: c, i
      got%status = plan_create(plan)
      do c = 1, classes
         if (this%by_tensor) call keep(got, plan_add_tensor(plan, tensor(this, c), number))
         if (.not. this%by_tensor) call keep(got, plan_add_class(plan, moments(this, c), number))
      end do
      call keep(got, plan_set(plan, z("layout"), z(trim(layouts(form)))))
      if (form == 4) call keep(got, plan_set(plan, z("momentum"), z("space-velocity")))
      call keep(got, plan_set(plan, z("frame"), z(frame_name(form))))
      call keep(got, plan_set(plan, z("splitting"), z(splitting)))
      call keep(got, plan_set(plan, z("seed"), z(text_of(this%number))))
      do i = 1, size(this%effects)
         call keep(got, plan_add_effect(plan, z(this%effects(i)%name), &
            z(settings_text(this%effects(i), .false.))))
      end do
      call keep(got, plan_ready(plan))
      q = this%q
      p = to_variable(this, form, this%y, this%q)
      p3 = p(:3, :)
      class = class_of - 1
      if (form == 5) then
         call keep(got, bodies_rows(view, c_sizeof(view), z("hoomd"), z("wxyz"), &
            int(n, c_size_t), c_loc(p), c_loc(q)))
      else
         call keep(got, bodies_rows(view, c_sizeof(view), z(trim(layouts(form))), z("wxyz"), &
            int(n, c_size_t), c_loc(p3), c_loc(q)))
      end if
      view%body_class = c_loc(class)
      top = top_data(this%centre, merge(1, 0, is_space(form)))
      callback = c_null_funptr
      if (this%hosted) callback = c_funloc(c_top)
      if (got%status == 0) call keep(got, step(plan, view, 0.0_dp, h, 0_i8, int(steps, i8), &
         callback, c_loc(top)))
      if (got%status == 0) call keep(got, energy(plan, view, steps*h, got%kinetic, got%potential))
      if (form /= 5) p(:3, :) = p3
      got%q = q
      got%y = from_variable(this, form, p, q)
      call plan_destroy(plan)
   end subroutine by_c

   subroutine keep(got, status)
      type(outcome), intent(inout) :: got
      integer, intent(in) :: status
      if (got%status == 0) got%status = status
   end subroutine keep

   pure function z(text)
      character(*), intent(in) :: text
      character(len(text) + 1) :: z
      z = text//c_null_char
   end function z

   !> A scene from its text, run into a folder, its last rows read back. Momenta, or velocities.
   subroutine by_scene(this, by_velocity, splitting, folder, got)
      type(problem), intent(in) :: this
      logical, intent(in) :: by_velocity
      character(*), intent(in) :: splitting, folder
      type(outcome), intent(out) :: got
      type(scene_settings) :: scene
      type(run_watch) :: watch
      type(run_report) :: report
      type(poinsot_error) :: error
      character, parameter :: nl = new_line("a")
      character(:), allocatable :: text
      integer :: i
      text = "&scene t_end = "//text_of(steps*h)//", h = "//text_of(h)//", splitting = '"// &
         splitting//"', threads = 1, seed = "//text_of(this%number)//" /"//nl
      do i = 1, n
         text = text//bodies_text(this, i, by_velocity)//nl
      end do
      do i = 1, size(this%effects)
         text = text//settings_text(this%effects(i), .true.)
      end do
      text = text//"&output times = "//text_of(steps*h)//", pictures = 'none', restart = '' /"//nl
      call scene_from(text, "matrix.nml", scene, error)
      if (.not. error%raised()) call run_scene(scene, folder, watch, report, error)
      if (.not. error%raised()) call read_rows(folder//"/trajectory.csv", got)
      if (error%raised()) got%status = error%code
      if (error%raised()) got%message = error%message
   end subroutine by_scene

   !> One body, a class of its own.
   function bodies_text(this, i, by_velocity) result(text)
      type(problem), intent(in) :: this
      integer, intent(in) :: i
      logical, intent(in) :: by_velocity
      character(:), allocatable :: text
      real(dp) :: w(4, n)
      text = "&bodies moments = "//text_of(moments(this, i))
      if (this%by_tensor) text = "&bodies tensor = "//text_of(reshape(tensor(this, i), [9]))
      w = to_variable(this, 3, this%y, this%q)
      if (by_velocity) text = text//", omega = "//text_of(w(:3, i))
      if (.not. by_velocity) text = text//", y = "//text_of(this%y(:, i))
      text = text//", q = "//text_of(this%q(:, i))//" /"
   end function bodies_text

   !> The columns of trajectory.csv: t, body, q, y, kinetic, potential, energy.
   subroutine read_rows(file, got)
      character(*), intent(in) :: file
      type(outcome), intent(inout) :: got
      real(dp) :: values(12)
      integer :: unit, i, state
      open (newunit=unit, file=file, action="read", status="old", iostat=state)
      if (state == 0) read (unit, *, iostat=state)
      do i = 1, n
         if (state == 0) read (unit, *, iostat=state) values
         got%q(:, i) = values(3:6)
         got%y(:, i) = values(7:9)
         got%kinetic(i) = values(10)
         got%potential(i) = values(11)
      end do
      got%status = state
      close (unit)
   end subroutine read_rows

   !> Torques of the host, and of the plan, stand in the space frame: with every other variable.
   pure logical function is_space(form)
      integer, intent(in) :: form
      is_space = mod(form, 2) == 0
   end function is_space

   pure function frame_name(form) result(name)
      integer, intent(in) :: form
      character(:), allocatable :: name
      name = "body"
      if (is_space(form)) name = "space"
   end function frame_name

   !> Symmetric to the bit.
   pure function tensor(this, class) result(j)
      type(problem), intent(in) :: this
      integer, intent(in) :: class
      real(dp) :: j(3, 3)
      j = tensor_of(this, class, 1)
      j = (j + transpose(j))/2
   end function tensor

   !> In the order of the frame, whose axes are principal.
   pure function moments(this, class) result(v)
      type(problem), intent(in) :: this
      integer, intent(in) :: class
      real(dp) :: v(3)
      v = matmul(abs(this%frame), this%principal(:, class))
   end function moments

end module test_matrix_entries
