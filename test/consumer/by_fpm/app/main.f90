! A project of fpm with poinsot as its dependency:
! FPM_FFLAGS="-march=native -fopenmp" fpm run --profile release
program by_fpm
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_null_char
   use poinsot, only: poinsot_body, poinsot_body_create, poinsot_error, poinsot_rotate
   implicit none(type, external)
   interface
      integer(c_int) function poinsot_has_feature(name) bind(c)
         import :: c_char, c_int
         implicit none(type, external)
         character(1, c_char), intent(in) :: name(*)
      end function poinsot_has_feature
   end interface
   integer, parameter :: dp = kind(1.0d0)
   type(poinsot_body) :: body
   type(poinsot_error) :: error
   real(dp) :: y(3, 1), q(4, 1)
   y(:, 1) = [0.0_dp, 0.6_dp, -0.8_dp]
   q(:, 1) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
   call poinsot_body_create([0.376_dp, 0.627_dp, 1.0_dp], body, error)
   call poinsot_rotate(body, "exact", 40.0_dp, 1, y, q, error)
   if (error%raised()) error stop error%message
   if (abs(y(1, 1) - 0.0545936805170046_dp) > 1e-13_dp) error stop "momentum"
   if (poinsot_has_feature("release" // c_null_char) /= 1) error stop "poinsot is not optimised"
   if (poinsot_has_feature("openmp" // c_null_char) /= 1) error stop "poinsot has no threads"
   print '(a)', "by fpm: ok"
end program by_fpm
