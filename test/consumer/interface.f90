! A Fortran host of another compiler: it has no .mod files, only include/poinsot_interface.f90 and
! the library.
program through_interface
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_int, c_int64_t, c_loc, &
      c_null_char, c_null_funptr, c_null_ptr, c_ptr, c_size_t
   use poinsot_interface, only: poinsot_bodies, poinsot_bodies_rows, poinsot_body_create, &
      poinsot_body_destroy, poinsot_degrees_of_freedom, poinsot_energy, poinsot_momentum, &
      poinsot_plan_add_class, poinsot_plan_create, poinsot_plan_destroy, poinsot_plan_ready, &
      poinsot_rotate, poinsot_step, poinsot_version
   implicit none(type, external)
   type(c_ptr) :: body, plan
   type(poinsot_bodies) :: view
   real(c_double), target :: y(3, 2), q(4, 2), y2(3, 2), q2(4, 2)
   real(c_double) :: kinetic(2), potential(2), momentum(3, 2)
   integer(c_int) :: number
   integer(c_size_t) :: count

   y = reshape([0.6d0, 0.0d0, 0.8d0, 0.0d0, 0.6d0, 0.8d0], [3, 2])
   q = spread([1.0d0, 0.0d0, 0.0d0, 0.0d0], 2, 2)
   y2 = y
   q2 = q
   if (poinsot_version() < 100) error stop 1
   if (poinsot_body_create([0.376d0, 0.627d0, 1.0d0], body) /= 0) error stop 2
   if (poinsot_rotate(body, "exact"//c_null_char, 0.1d0, 10_c_size_t, 2_c_size_t, y, q, &
      c_null_ptr) /= 0) error stop 3
   call poinsot_body_destroy(body)
   if (c_associated(body)) error stop 4

   if (poinsot_plan_create(plan) /= 0) error stop 5
   if (poinsot_plan_add_class(plan, [0.376d0, 0.627d0, 1.0d0], number) /= 0) error stop 6
   if (number /= 0) error stop 6
   if (poinsot_plan_ready(plan) /= 0) error stop 7
   if (poinsot_bodies_rows(view, "native"//c_null_char, "wxyz"//c_null_char, 2_c_size_t, &
      c_loc(y2), c_loc(q2)) /= 0) error stop 8
   if (poinsot_step(plan, view, 0.0d0, 0.1d0, 0_c_int64_t, 10_c_int64_t, c_null_funptr, &
      c_null_ptr) /= 0) error stop 9
   if (any(abs(y2 - y) > 0) .or. any(abs(q2 - q) > 0)) error stop 10 ! without effects: the same
                                                                     ! bits
   if (poinsot_energy(plan, view, 0.0d0, kinetic, potential) /= 0) error stop 11
   if (any(kinetic <= 0)) error stop 11
   if (poinsot_momentum(plan, view, momentum) /= 0) error stop 12
   if (any(abs(momentum(:, 1) - [0.6d0, 0.0d0, 0.8d0]) > 1d-14)) error stop 13
   if (poinsot_degrees_of_freedom(plan, view, count) /= 0) error stop 14
   if (count /= 6) error stop 14
   call poinsot_plan_destroy(plan)
   if (c_associated(plan)) error stop 15
   print '(a)', "interface: ok"
end program through_interface
