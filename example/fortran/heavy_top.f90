!> A spinning top with `use poinsot`: gfortran heavy_top.f90 $(pkg-config --cflags --libs poinsot)
program heavy_top
   use poinsot, only: poinsot_bodies, poinsot_bodies_rows, poinsot_energy, poinsot_error, &
      poinsot_plan, poinsot_plan_add_class, poinsot_plan_add_effect, poinsot_plan_ready, &
      poinsot_step
   implicit none(type, external)
   integer, parameter :: dp = kind(1.0d0)
   type(poinsot_plan) :: plan
   type(poinsot_bodies) :: bodies
   type(poinsot_error) :: error
   real(dp), target :: y(3, 1), q(4, 1), kinetic(1), potential(1)
   integer :: k, number

   y(:, 1) = [1.8_dp, 0.4_dp, -0.9_dp]
   q(:, 1) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
   call poinsot_plan_add_class(plan, [0.6_dp, 0.8_dp, 1.0_dp], number, error)
   if (.not. error%raised()) call poinsot_plan_add_effect(plan, "gravity", &
      "centre = 0, 0, 1; weight = 1", error)
   if (.not. error%raised()) call poinsot_plan_ready(plan, error)
   if (.not. error%raised()) call poinsot_bodies_rows(bodies, y, q, error)

   do k = 0, 10 ! 100 steps of 0.01 at a time
      if (error%raised()) exit
      call poinsot_energy(plan, bodies, real(k, dp), kinetic, potential, error)
      print '("t = ", i4, "   H = ", f15.13, "   q = ", 4f10.6)', k, kinetic + potential, q
      if (k < 10) call poinsot_step(plan, bodies, 0.0_dp, 0.01_dp, 100*k, 100, error)
   end do
   if (error%raised()) then
      print '(a)', error%message
      error stop
   end if
end program heavy_top
