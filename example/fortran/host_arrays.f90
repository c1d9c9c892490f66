!> A host with one array per component, with `use poinsot`: linear and bent molecules among
!> frozen ones, half-step kicks, a thermostat in the middle of the step, and a restart.
!> gfortran host_arrays.f90 $(pkg-config --cflags --libs poinsot)
program host_arrays
   use, intrinsic :: iso_fortran_env, only: int64
   use poinsot, only: poinsot_bodies, poinsot_dissipate, poinsot_drift, &
      poinsot_e_partial, poinsot_error, poinsot_kick, poinsot_plan, poinsot_plan_add_class, &
      poinsot_plan_add_effect, poinsot_plan_ready, poinsot_plan_set, poinsot_status_text
   implicit none(type, external)
   integer, parameter :: dp = kind(1.0d0), n = 400
   real(dp), parameter :: h = 0.02_dp, field = 2, kt = 1
   ! the host's arrays: angular velocities in the body frame, attitudes
   real(dp), target :: omx(n), omy(n), omz(n), q0(n), q1(n), q2(n), q3(n)
   real(dp), target :: torque(3, n)
   integer, target :: kind_of(n), each(n)
   integer(int64), target :: id(n)
   real(dp) :: kept(n, 7), cosine
   type(poinsot_plan) :: plan
   type(poinsot_bodies) :: bodies
   type(poinsot_error) :: error
   integer :: i, k, frozen

   call set_up
   call show(bodies)
   cosine = 0
   do k = 1, 2000
      if (k == 1001) kept = state()
      call step(k)
      if (k > 1000) cosine = cosine + sum(q0**2 - q1**2 - q2**2 + q3**2, mask=kind_of > 0) &
         /(1000.0_dp*count(kind_of > 0))
   end do
   print '(a, f7.4, a, f7.4)', "<cos theta> = ", cosine, "; Langevin's function: ", &
      1/tanh(field/kt) - kt/field
   if (abs(cosine - 1/tanh(field/kt) + kt/field) > 0.02_dp) error stop "not sampled right"
   call restart_repeats

contains

   !> Plan and view, once: kinds by their moments, the view points to the arrays.
   subroutine set_up
      integer :: number
      call poinsot_plan_add_class(plan, [0.6_dp, 1.8_dp, 1.2_dp], number, error)   ! kind 1, bent
      call check("kind 1")
      call poinsot_plan_add_class(plan, [1.4_dp, 1.4_dp, 0.0_dp], number, error)   ! kind 2, linear
      call check("kind 2")
      call poinsot_plan_set(plan, "layout", "dl_poly", error)
      call check("layout")
      call poinsot_plan_add_effect(plan, "langevin", "rate = 1; temperature = 1", error)
      call check("thermostat")
      call poinsot_plan_ready(plan, error)
      call check("plan")
      frozen = 10
      do i = 1, n
         kind_of(i) = 1 + mod(i, 2)
         if (i <= frozen) kind_of(i) = -1 ! does not rotate
         id(i) = i
      end do
      omx = 0
      omy = 0
      omz = 0
      q0 = 1
      q1 = 0
      q2 = 0
      q3 = 0
   end subroutine set_up

   !> Make the view of the host's arrays. To be repeated whenever they are reallocated or sorted.
   subroutine show(view)
      type(poinsot_bodies), intent(inout) :: view
      view%n = n
      view%first_class = 1
      view%y(1)%of => omx
      view%y(2)%of => omy
      view%y(3)%of => omz
      view%q(1)%of => q0
      view%q(2)%of => q1
      view%q(3)%of => q2
      view%q(4)%of => q3
      view%body_class => kind_of
      view%id => id
      view%status => each
   end subroutine show

   !> kick 1/2, drift 1/2, drag and noise, drift 1/2, kick 1/2
   subroutine step(number)
      integer, intent(in) :: number
      call forces
      call poinsot_kick(plan, bodies, h/2, torque, error)
      call poinsot_drift(plan, bodies, h/2, error)
      call poinsot_dissipate(plan, bodies, h, number, error)
      call poinsot_drift(plan, bodies, h/2, error)
      call forces
      call poinsot_kick(plan, bodies, h/2, torque, error)
      call check("a step")
   end subroutine step

   !> The host's torques, space frame: a dipole along body axis 3 in a field along z.
   subroutine forces
      torque(1, :) = field*2*(q2*q3 - q0*q1)
      torque(2, :) = -field*2*(q1*q3 + q0*q2)
      torque(3, :) = 0
   end subroutine forces

   function state() result(all)
      real(dp) :: all(n, 7)
      all = reshape([omx, omy, omz, q0, q1, q2, q3], [n, 7])
   end function state

   !> From the state of step 1000, as binary numbers: bitwise the same state at step 2000.
   subroutine restart_repeats
      real(dp) :: end_state(n, 7)
      end_state = state()
      omx = kept(:, 1)
      omy = kept(:, 2)
      omz = kept(:, 3)
      q0 = kept(:, 4)
      q1 = kept(:, 5)
      q2 = kept(:, 6)
      q3 = kept(:, 7)
      do k = 1001, 2000
         call step(k)
      end do
      if (any(abs(state() - end_state) > 0)) error stop "a restart is another run"
      if (any(abs(q0(:frozen) - 1) > 0)) error stop "a frozen molecule turned"
   end subroutine restart_repeats

   !> Error handling of a host.
   subroutine check(what)
      character(*), intent(in) :: what
      if (.not. error%raised()) return
      print '(3a)', what, ": ", error%message
      if (error%code == poinsot_e_partial) then
         do i = 1, n
            if (each(i) == 0) cycle
            print '(a, i0, 2a)', "molecule ", i, ": ", poinsot_status_text(each(i))
         end do
      end if
      error stop
   end subroutine check

end program host_arrays
