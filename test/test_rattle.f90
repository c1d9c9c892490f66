!> RATTLE in the matrices (P, Q): equation (11) line by line, the change of variables, agreement
!> with dmv2 in the Strang splitting, symplecticity with a potential.
module test_rattle
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, qp, lanes
   use poinsot_core_error, only: poinsot_error
   use poinsot_core_status, only: poinsot_ok, poinsot_e_step
   use poinsot_body_class, only: body_class, make_class
   use poinsot_free_method, only: free_method, find_method, advance
   use poinsot_free_rattle, only: rattle_start, rattle_finish, second_moments, to_matrices, &
      from_matrices, body_momentum
   use test_bodies, only: random_stream, start_stream
   use test_expectation, only: expect
   use test_free_tools, only: generic, start, start_q, random_block, text, rest_block
   use test_oracle_algebra, only: cross
   use test_oracle_properties, only: plain_map, property_report, measure_properties
   implicit none(type, external)
   private
   public :: collect_rattle

   !> A potential with a full gradient: U = sum A_ij Q_ij + sum B_ij Q_ij**2/2.
   real(dp), parameter :: a(3, 3) = reshape([0.3_dp, -0.2_dp, 0.5_dp, 0.7_dp, 0.1_dp, -0.4_dp, &
      0.2_dp, -0.6_dp, 0.9_dp], [3, 3])
   real(dp), parameter :: b(3, 3) = reshape([0.8_dp, 0.2_dp, -0.3_dp, -0.5_dp, 0.4_dp, 0.6_dp, &
      0.1_dp, 0.7_dp, -0.2_dp], [3, 3])

   !> Generic (unsorted), flat, nearly symmetric, nearly linear, linear.
   real(dp), parameter :: bodies(3, 5) = reshape([generic, 1.5_dp, 0.6_dp, 0.9_dp, &
      0.8_dp, 0.8_dp + 1.0e-9_dp, 1.1_dp, 1.0_dp, 1.0e-7_dp, 1.0_dp + 4.0e-8_dp, &
      0.7_dp, 0.7_dp, 0.0_dp], [3, 5])

   !> One step with the potential as a map of (y, q).
   type, extends(plain_map) :: potential_map
   contains
      procedure :: apply => apply_potential
   end type potential_map

contains

   subroutine collect_rattle(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("change-of-variables", test_change), &
         new_unittest("equation-11", test_equation), &
         new_unittest("strang-dmv2", test_strang), &
         new_unittest("symplectic-potential", test_symplectic), &
         new_unittest("refusal", test_refusal)]
   end subroutine collect_rattle

   !> Body torque -rot(Q^T grad U) of every lane.
   subroutine torque_of(matrix, g)
      real(dp), intent(in) :: matrix(lanes, 3, 3)
      real(dp), intent(out) :: g(lanes, 3)
      real(dp) :: m(3, 3)
      integer :: l
      do l = 1, lanes
         m = matmul(transpose(matrix(l, :, :)), a + b*matrix(l, :, :))
         g(l, :) = [m(2, 3) - m(3, 2), m(3, 1) - m(1, 3), m(1, 2) - m(2, 1)]
      end do
   end subroutine torque_of

   !> (y, q) -> (P, Q) -> (y, q); Q^T P = omega^ D; trace(P^T Q xi^) = y . xi; kinetic energy.
   subroutine test_change(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(body_class) :: class
      type(poinsot_error) :: answer
      real(dp), dimension(lanes, 3) :: y, z
      real(dp) :: q(lanes, 4), r(lanes, 4), p(lanes, 3, 3), m(lanes, 3, 3), d(3), w(3), gap
      real(dp) :: x(3, 3), xi(3)
      integer :: k, l, i
      stream = start_stream(3)
      do k = 1, size(bodies, 2)
         call make_class(bodies(:, k), class, answer)
         d = second_moments(class)
         call random_block(stream, y, q)
         q = q*spread(sign(1.0_dp, q(:, 1)), 2, 4)
         do i = 1, 3
            if (.not. bodies(i, k) > 0) y(:, i) = 0
         end do
         gap = maxval(abs(cshift(d, 1) + cshift(d, 2) - bodies(:, k))/max(bodies(:, k), &
            tiny(1.0_dp)))
         call expect(error, gap < 3.0e-16_dp, "moments from d: "//text(gap))
         call to_matrices(class, y, q, p, m)
         call from_matrices(p, m, z, r)
         gap = maxval(abs(z - y)) + maxval(abs(r - q))
         call expect(error, gap < 3.0e-15_dp, "the way back: "//text(gap))
         if (bodies(2, k) < 1.0e-6_dp) then
            gap = maxval(abs(z(:, 2)/y(:, 2) - 1)*bodies(2, k))
            call expect(error, gap < 1.0e-15_dp, "a thin body's own momentum: "//text(gap))
         end if
         do l = 1, lanes
            w = class%inverse*y(l, :)
            x = matmul(transpose(m(l, :, :)), p(l, :, :))
            gap = 0
            do i = 1, 3
               gap = max(gap, maxval(abs(x(:, i) - d(i)*cross(w, unit(i)))))
            end do
            call expect(error, gap < 2.0e-15_dp*norm2(w), "constraint: "//text(gap))
            xi = [0.3_dp, -0.8_dp, 0.5_dp]
            gap = -dot_product(y(l, :), xi)
            do i = 1, 3
               gap = gap + dot_product(p(l, :, i), matmul(m(l, :, :), cross(xi, unit(i))))
            end do
            call expect(error, abs(gap) < 2.0e-15_dp, "one-form: "//text(gap))
         end do
      end do
   end subroutine test_change

   !> Every line of (11) with the full gradient, the multipliers computed and found symmetric.
   subroutine test_equation(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: h = 0.3_dp
      type(random_stream) :: stream
      type(body_class) :: class
      type(poinsot_error) :: answer
      real(dp), dimension(lanes, 3, 3) :: p0, q0, p1, q1, half
      real(dp) :: y(lanes, 3), q(lanes, 4), g(lanes, 3), x(3, 3), d(3), gap(5)
      integer :: k, l, i, status(lanes)
      stream = start_stream(5)
      do k = 1, 3
         call make_class(bodies(:, k), class, answer)
         d = second_moments(class)
         call random_block(stream, y, q)
         call to_matrices(class, y, q, p0, q0)
         half = p0
         q1 = q0
         status = poinsot_ok
         call torque_of(q0, g)
         call rattle_start(class, h, g, half, q1, status)
         call torque_of(q1, g)
         p1 = half
         call rattle_finish(class, h, g, p1, q1, status)
         call expect(error, all(status == poinsot_ok), "status")
         gap = 0
         do l = 1, lanes
            x = 2/h*(p0(l, :, :) - half(l, :, :)) - (a + b*q0(l, :, :))
            gap(1) = max(gap(1), skew(matmul(transpose(q0(l, :, :)), x)))
            do i = 1, 3
               gap(2) = max(gap(2), maxval(abs((q1(l, :, i) - q0(l, :, i))*d(i) - h*half(l, :, i))))
            end do
            x = matmul(transpose(q1(l, :, :)), q1(l, :, :))
            do i = 1, 3
               x(i, i) = x(i, i) - 1
            end do
            gap(3) = max(gap(3), maxval(abs(x)))
            x = 2/h*(half(l, :, :) - p1(l, :, :)) - (a + b*q1(l, :, :))
            gap(4) = max(gap(4), skew(matmul(transpose(q1(l, :, :)), x)))
            if (minval(d) > 0) then
               x = matmul(transpose(q1(l, :, :)), p1(l, :, :))
               do i = 1, 3
                  x(:, i) = x(:, i)/d(i)
               end do
               gap(5) = max(gap(5), maxval(abs(x + transpose(x))))
            end if
         end do
         call expect(error, all(gap < 2.0e-14_dp), &
            "equation (11): "//text(gap(1))//" "//text(gap(2))//" "// &
            text(gap(3))//" "//text(gap(4))//" "//text(gap(5)))
      end do
   end subroutine test_equation

   !> 30 steps (beyond, the motion itself is chaotic): half kick, dmv2, half kick on (y, q) against
   !> RATTLE on (P, Q).
   subroutine test_strang(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: h = 0.05_dp
      type(random_stream) :: stream
      type(body_class) :: class
      type(free_method) :: method
      type(poinsot_error) :: answer
      real(dp), dimension(lanes, 3, 3) :: p, m, pz, mz
      real(dp), dimension(lanes, 3) :: y, g, z
      real(dp) :: q(lanes, 4), gap
      integer :: k, n, i, status(lanes), other(lanes)
      stream = start_stream(7)
      call find_method("dmv2", method, answer)
      do k = 1, size(bodies, 2)
         call make_class(bodies(:, k), class, answer)
         call random_block(stream, y, q)
         y = spread(min(bodies(:, k), 1.0_dp), 1, lanes)*y
         call to_matrices(class, y, q, p, m)
         status = poinsot_ok
         other = poinsot_ok
         do n = 1, 30
            mz = m
            call torque_of(m, g)
            call freeze(bodies(:, k), g)
            call rattle_start(class, h, g, p, m, status)
            call torque_of(m, g)
            call freeze(bodies(:, k), g)
            call rattle_finish(class, h, g, p, m, status)
            call to_matrices(class, y, q, pz, mz)
            call torque_of(mz, g)
            call freeze(bodies(:, k), g)
            y = y + 0.5_dp*h*g
            call advance(method, class, h, y, q, other)
            call to_matrices(class, y, q, pz, mz)
            call torque_of(mz, g)
            call freeze(bodies(:, k), g)
            y = y + 0.5_dp*h*g
         end do
         call body_momentum(p, m, z)
         call expect(error, all(status == poinsot_ok .and. other == poinsot_ok), "status")
         gap = max(maxval(abs(z - y)), maxval(abs(m - mz)))
         do i = 1, 3
            if (bodies(i, k) > 0) gap = max(gap, maxval(abs(z(:, i) - y(:, i)))/bodies(i, k)*0.1_dp)
         end do
         call expect(error, gap < 3.0e-14_dp, "RATTLE and dmv2 differ: "//text(gap))
      end do
   end subroutine test_strang

   !> A body takes no torque about an axis without inertia; small ones get small torques.
   subroutine freeze(moments, g)
      real(dp), intent(in) :: moments(3)
      real(dp), intent(inout) :: g(lanes, 3)
      integer :: i
      do i = 1, 3
         g(:, i) = g(:, i)*min(1.0_dp, moments(i))
      end do
   end subroutine freeze

   !> With the potential: symplectic in (y, q) and symmetric.
   subroutine test_symplectic(error)
      type(error_type), allocatable, intent(out) :: error
      type(potential_map) :: map
      type(property_report) :: r
      map%delta = 1.0e-2_qp
      call measure_properties(map, 1/real(generic, qp), 0.3_qp, real(start, qp), &
         real(start_q, qp), r)
      call expect(error, r%ok .and. r%symplectic < 1.0e-10_dp, "symplectic: "//text(r%symplectic))
      call expect(error, r%symmetric < 3.0e-15_dp, "symmetric: "//text(r%symmetric))
   end subroutine test_symplectic

   subroutine apply_potential(self, h, y, q, ok)
      class(potential_map), intent(in) :: self
      real(qp), intent(in) :: h
      real(qp), intent(inout) :: y(3), q(4)
      logical, intent(out) :: ok
      type(body_class) :: class
      type(poinsot_error) :: answer
      real(dp), dimension(lanes, 3, 3) :: p, m
      real(dp) :: yb(lanes, 3), qb(lanes, 4), g(lanes, 3)
      integer :: status(lanes)
      associate (unused => self%delta)
      end associate
      call make_class(generic, class, answer)
      call rest_block(yb, qb, status)
      yb(1, :) = real(y, dp)
      qb(1, :) = real(q, dp)
      call to_matrices(class, yb, qb, p, m)
      call torque_of(m, g)
      call rattle_start(class, real(h, dp), g, p, m, status)
      call torque_of(m, g)
      call rattle_finish(class, real(h, dp), g, p, m, status)
      call from_matrices(p, m, yb, qb)
      ok = status(1) == poinsot_ok
      y = yb(1, :)
      q = qb(1, :)
   end subroutine apply_potential

   !> A lane too fast after its kick says E_STEP and stands still; its neighbours do not notice.
   subroutine test_refusal(error)
      type(error_type), allocatable, intent(out) :: error
      type(random_stream) :: stream
      type(body_class) :: class
      type(poinsot_error) :: answer
      real(dp), dimension(lanes, 3, 3) :: p, m, pa, ma, p0, m0
      real(dp) :: y(lanes, 3), q(lanes, 4), g(lanes, 3)
      integer :: status(lanes), other(lanes)
      stream = start_stream(11)
      call make_class(generic, class, answer)
      call random_block(stream, y, q)
      call to_matrices(class, y, q, p, m)
      p0 = p
      m0 = m
      pa = p
      ma = m
      call torque_of(m, g)
      status = poinsot_ok
      call rattle_start(class, 0.2_dp, g, p, m, status)
      call rattle_finish(class, 0.2_dp, g, p, m, status)
      g(9, 1) = 100
      other = poinsot_ok
      call rattle_start(class, 0.2_dp, g, pa, ma, other)
      call rattle_finish(class, 0.2_dp, g, pa, ma, other)
      call expect(error, other(9), poinsot_e_step)
      call expect(error, count(other /= status), 1)
      call expect(error, all(abs(pa(9, :, :) - p0(9, :, :)) <= 0) .and. &
         all(abs(ma(9, :, :) - m0(9, :, :)) <= 0), "the refused lane moves")
      p(9, :, :) = pa(9, :, :)
      m(9, :, :) = ma(9, :, :)
      call expect(error, all(abs(pa - p) <= 0) .and. all(abs(ma - m) <= 0), "neighbours notice")
   end subroutine test_refusal

   !> Largest element of M - M^T.
   pure real(dp) function skew(m)
      real(dp), intent(in) :: m(3, 3)
      skew = maxval(abs(m - transpose(m)))
   end function skew

   pure function unit(i) result(e)
      integer, intent(in) :: i
      real(dp) :: e(3)
      e = 0
      e(i) = 1
   end function unit

end module test_rattle
