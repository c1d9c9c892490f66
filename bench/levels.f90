!> The kernels alone, for levels.sh: built for one level of processor, run on this one.
program levels
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_rotation_random, only: random_direction, random_quaternion
   use bench_kernels, only: kernel_table
   implicit none(type, external)
   real(dp) :: y(3, lanes), q(4, lanes)
   integer :: i
   do i = 1, lanes
      y(:, i) = random_direction(1_i8, int(i, i8))
      q(:, i) = random_quaternion(1_i8, int(i, i8))
   end do
   call kernel_table(y, q)
end program levels
