!> One period of the polhode, with `use poinsot_rotation` and `use poinsot_elliptic`: a water
!> molecule's momentum recurs after four quarter periods, 4 K(m) in Jacobi's time; its attitude does
!> not.
!>    gfortran one_turn.f90 $(pkg-config --cflags --libs poinsot)
program one_turn
   use poinsot, only: poinsot_body, poinsot_body_create, poinsot_rotate
   use poinsot_rotation, only: poinsot_error, inertia_of_points, principal_axes, from_euler, &
      quaternion_product, quaternion_conjugate, to_axis_angle, rotate, angle_between, vector_norm
   use poinsot_elliptic, only: elliptic_k
   implicit none(type, external)
   integer, parameter :: dp = kind(1.0d0)
   real(dp), parameter :: mass(3) = [15.999_dp, 1.008_dp, 1.008_dp]
   real(dp), parameter :: atoms(3, 3) = reshape([0.0_dp, 0.0_dp, 0.0_dp, &
      0.757_dp, 0.586_dp, 0.0_dp, -0.757_dp, 0.586_dp, 0.0_dp], [3, 3])
   type(poinsot_body) :: body
   type(poinsot_error) :: error
   real(dp) :: tensor(3, 3), axes(3, 3), i(3), y(3, 1), q(4, 1), before(3), start(4)
   real(dp) :: energy, l2, m, rate, period, axis(3), angle

   call inertia_of_points(mass, atoms, tensor, error)
   if (.not. error%raised()) call principal_axes(tensor, i, axes, error)
   if (.not. error%raised()) call poinsot_body_create(i, body, error)
   if (.not. error%raised()) call from_euler("zxz", [0.3_dp, 1.1_dp, -0.4_dp], start, error)
   if (error%raised()) error stop error%message

   before = [0.5_dp, 0.4_dp, 1.0_dp]
   energy = sum(before**2/i)/2
   l2 = sum(before**2)
   ! Landau and Lifshitz, Mechanics, section 37; here l2 > 2 energy i(2)
   m = (i(2) - i(1))*(2*energy*i(3) - l2)/((i(3) - i(2))*(l2 - 2*energy*i(1)))
   rate = sqrt((i(3) - i(2))*(l2 - 2*energy*i(1))/product(i))
   period = 4*elliptic_k(m)/rate

   y(:, 1) = before
   q(:, 1) = start
   call poinsot_rotate(body, "exact", period, 1, y, q, error)
   if (error%raised()) error stop error%message
   call to_axis_angle(quaternion_product(q(:, 1), quaternion_conjugate(start)), axis, angle)
   print '(a, 3f10.6)', "moments          ", i
   print '(a, f10.6)', "period           ", period
   print '(a, f10.6)', "turned by        ", angle
   print '(a, l1)', "momentum is back: ", vector_norm(y(:, 1) - before) < 1.0e-14_dp
   ! about the angular momentum, in space
   angle = angle_between(axis, rotate(start, before))
   print '(a, l1)', "turned about it:  ", min(angle, acos(-1.0_dp) - angle) < 1.0e-14_dp
end program one_turn
