!> General-purpose rivals on a scene: Runge-Kutta methods on (y, q) with the scene's own torques, 32
!> bodies side by side as the library has them. Classical order 4 and DOP853 of order 8, with fixed
!> steps; DOP853 also with its own error estimate and step control (E. Hairer, S. P. Norsett, G.
!> Wanner, Solving Ordinary Differential Equations I, 2nd ed., 1993, section II.5), all bodies of a
!> block with one step.
module bench_general
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_splitting_block_flows, only: block_flows
   use bench_runge_kutta, only: dop853_tableau => tableau
   implicit none(type, external)
   private
   public :: rk4_fixed, dop853_fixed, dop853_adaptive

   real(dp), parameter :: bhh(3) = [0.244094488188976377952755905512_dp, &
      0.733846688281611857341361741547_dp, 0.220588235294117647058823529412e-1_dp]
   real(dp), parameter :: er(12) = [0.1312004499419488073250102996e-1_dp, 0.0_dp, 0.0_dp, 0.0_dp, &
      0.0_dp, -0.1225156446376204440720569753e1_dp, -0.4957589496572501915214079952_dp, &
      0.1664377182454986536961530415e1_dp, -0.3503288487499736816886487290_dp, &
      0.3341791187130174790297318841_dp, 0.8192320648511571246570742613e-1_dp, &
      -0.2235530786388629525884427845e-1_dp]

contains

   !> Right side of a block at time t: y' = y x omega + g, q' = q o (0, omega)/2.
   subroutine slopes(flows, forced, t, x, f)
      type(block_flows), intent(inout) :: flows
      logical, intent(in) :: forced
      real(dp), intent(in) :: t, x(lanes, 7)
      real(dp), intent(out) :: f(lanes, 7)
      real(dp) :: w1, w2, w3
      integer :: l
      !GCC$ ivdep
      do l = 1, lanes
         w1 = x(l, 1)*flows%class%inverse(1)
         w2 = x(l, 2)*flows%class%inverse(2)
         w3 = x(l, 3)*flows%class%inverse(3)
         f(l, 1) = x(l, 2)*w3 - x(l, 3)*w2
         f(l, 2) = x(l, 3)*w1 - x(l, 1)*w3
         f(l, 3) = x(l, 1)*w2 - x(l, 2)*w1
         w1 = 0.5_dp*w1
         w2 = 0.5_dp*w2
         w3 = 0.5_dp*w3
         f(l, 4) = -x(l, 5)*w1 - x(l, 6)*w2 - x(l, 7)*w3
         f(l, 5) = x(l, 4)*w1 + x(l, 6)*w3 - x(l, 7)*w2
         f(l, 6) = x(l, 4)*w2 + x(l, 7)*w1 - x(l, 5)*w3
         f(l, 7) = x(l, 4)*w3 + x(l, 5)*w2 - x(l, 6)*w1
      end do
      if (.not. forced) return
      flows%q = x(:, 4:7)
      call flows%start_torque(t, 0.0_dp)
      call flows%finish_torque()
      f(:, 1:3) = f(:, 1:3) + flows%g
   end subroutine slopes

   !> Classical Runge-Kutta, fixed steps.
   subroutine rk4_fixed(flows, forced, t_end, steps, x)
      type(block_flows), intent(inout) :: flows
      logical, intent(in) :: forced
      real(dp), intent(in) :: t_end
      integer, intent(in) :: steps
      real(dp), intent(inout) :: x(lanes, 7)
      real(dp) :: k(lanes, 7, 4), z(lanes, 7), h, t
      integer :: s
      h = t_end/steps
      do s = 0, steps - 1
         t = s*h
         call slopes(flows, forced, t, x, k(:, :, 1))
         z = x + (h/2)*k(:, :, 1)
         call slopes(flows, forced, t + h/2, z, k(:, :, 2))
         z = x + (h/2)*k(:, :, 2)
         call slopes(flows, forced, t + h/2, z, k(:, :, 3))
         z = x + h*k(:, :, 3)
         call slopes(flows, forced, t + h, z, k(:, :, 4))
         x = x + (h/6)*(k(:, :, 1) + 2*(k(:, :, 2) + k(:, :, 3)) + k(:, :, 4))
      end do
   end subroutine rk4_fixed

   !> The twelve slopes of a step of DOP853, and the state it comes to.
   subroutine dop853_step(flows, forced, a, c, t, h, x, k, z)
      type(block_flows), intent(inout) :: flows
      logical, intent(in) :: forced
      real(dp), intent(in) :: a(12, 2:13), c(13), t, h
      real(dp), intent(in) :: x(lanes, 7)
      real(dp), intent(inout) :: k(lanes, 7, 12)      !! the first slope is there already
      real(dp), intent(out) :: z(lanes, 7)
      integer :: r, j
      do r = 2, 13
         z = x
         do j = 1, r - 1
            if (abs(a(j, r)) > 0) z = z + (h*a(j, r))*k(:, :, j)
         end do
         if (r < 13) call slopes(flows, forced, t + c(r)*h, z, k(:, :, r))
      end do
   end subroutine dop853_step

   !> DOP853, fixed steps.
   subroutine dop853_fixed(flows, forced, t_end, steps, x)
      type(block_flows), intent(inout) :: flows
      logical, intent(in) :: forced
      real(dp), intent(in) :: t_end
      integer, intent(in) :: steps
      real(dp), intent(inout) :: x(lanes, 7)
      real(dp) :: k(lanes, 7, 12), z(lanes, 7), h, a(12, 2:13), c(13)
      integer :: s
      call nodes(a, c)
      h = t_end/steps
      do s = 0, steps - 1
         call slopes(flows, forced, s*h, x, k(:, :, 1))
         call dop853_step(flows, forced, a, c, s*h, h, x, k, z)
         x = z
      end do
   end subroutine dop853_fixed

   !> DOP853 with step control; a step is good for all bodies of the block or for none.
   subroutine dop853_adaptive(flows, forced, t_end, tol, x, steps)
      type(block_flows), intent(inout) :: flows
      logical, intent(in) :: forced
      real(dp), intent(in) :: t_end, tol         !! absolute and relative tolerance alike
      real(dp), intent(inout) :: x(lanes, 7)
      integer, intent(out) :: steps              !! taken and refused
      real(dp) :: k(lanes, 7, 12), z(lanes, 7), h, t, a(12, 2:13), c(13), error
      call nodes(a, c)
      t = 0
      h = 0.1_dp*tol**0.125_dp
      steps = 0
      call slopes(flows, forced, t, x, k(:, :, 1))
      do while (t < t_end .and. steps < 10000000)
         h = min(h, t_end - t)
         call dop853_step(flows, forced, a, c, t, h, x, k, z)
         error = estimate(h, tol, x, z, k)
         steps = steps + 1
         if (error <= 1) then
            t = t + h
            if (t_end - t < 1e-14_dp*t_end) t = t_end
            x = z
            call slopes(flows, forced, t, x, k(:, :, 1))
         end if
         h = h*min(6.0_dp, max(0.333_dp, 0.9_dp*max(error, 1e-10_dp)**(-0.125_dp)))
      end do
   end subroutine dop853_adaptive

   !> Hairer's estimate, of order 8 from those of order 5 and 3; the largest of all bodies.
   pure real(dp) function estimate(h, tol, x, z, k) result(error)
      real(dp), intent(in) :: h, tol, x(lanes, 7), z(lanes, 7), k(lanes, 7, 12)
      real(dp) :: fifth(lanes), third(lanes), scale(lanes), e(lanes), sum_of(lanes)
      integer :: i, j
      fifth = 0
      third = 0
      do i = 1, 7
         scale = tol*(1 + max(abs(x(:, i)), abs(z(:, i))))
         e = 0
         sum_of = 0
         do j = 1, 12
            if (abs(er(j)) > 0) e = e + er(j)*k(:, i, j)
         end do
         call dop853_sum(k(:, i, :), sum_of)
         fifth = fifth + (e/scale)**2
         third = third + ((sum_of - bhh(1)*k(:, i, 1) - bhh(2)*k(:, i, 9) - bhh(3)*k(:, i, &
            12))/scale)**2
      end do
      error = maxval(abs(h)*fifth/sqrt(7*max(fifth + 0.01_dp*third, tiny(error))))
   end function estimate

   !> The weighted sum of slopes that makes the step.
   pure subroutine dop853_sum(k, total)
      real(dp), intent(in) :: k(lanes, 12)
      real(dp), intent(out) :: total(lanes)
      real(dp) :: a(12, 2:13)
      integer :: j
      call dop853_tableau(a)
      total = 0
      do j = 1, 12
         if (abs(a(j, 13)) > 0) total = total + a(j, 13)*k(:, j)
      end do
   end subroutine dop853_sum

   !> Tableau and times of its stages, the sums of its rows.
   pure subroutine nodes(a, c)
      real(dp), intent(out) :: a(12, 2:13), c(13)
      integer :: r
      call dop853_tableau(a)
      c(1) = 0
      do r = 2, 13
         c(r) = sum(a(:, r))
      end do
   end subroutine nodes

end module bench_general
