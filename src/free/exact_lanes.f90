!> `exact` and `jacobi` for bodies that all differ: moments of inertia for each lane of a block.
!>
!> The constants of poinsot_body_constants, and the statements of the exact step of a body class,
!> each with the number of its own lane. There are no long series here: beyond h |omega| = .11 a
!> body takes substeps, and beyond `most_substeps` of them Jacobi's functions. Inside, bodies are
!> seen through sorted, right-handed axes: y and the vector part of q are put in order on the way
!> in, by masks, and back on the way out. A lane's bits depend on that lane alone.
!>
!> usage: make_lane_constants once for a block of moments, then advance_each for every step.
module poinsot_free_exact_lanes
   use poinsot_core_constants, only: exponent_bits
   use poinsot_core_kinds, only: dp, i8, group, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_lanes, only: any_failed
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_not_finite, poinsot_e_step
   use poinsot_body_moments, only: accept_moments
   use poinsot_body_constants, only: lane_constants, make_constants
   use poinsot_body_series_start, only: axis_series
   use poinsot_body_sine_series, only: short_sine, short_product, half_cosine, half_factor
   use poinsot_free_accumulate, only: add_plain, add_compensated, conserve_each
   use poinsot_free_exact, only: count_substeps
   use poinsot_free_exact_step, only: step_rotation
   use poinsot_free_jacobi_solution, only: jacobi_lanes
   implicit none(type, external)
   private
   public :: lane_constants, make_lane_constants, accept_lanes, make_constants, advance_each

   integer, parameter :: most_substeps = 6 !! beyond, Jacobi's functions are cheaper
   integer, parameter :: in_order(3) = [1, 2, 3]
   integer(i8), parameter :: smallest_bits = shiftl(1_i8, 52)      !! of tiny(1.0_dp)
   integer(i8), parameter :: largest_bits = shiftl(2047_i8, 52) - 1 !! of huge(1.0_dp)
   integer, parameter :: far_exponent = 232 !! a turn beyond 2**232 = 1e70 is not multiplied

contains

   !> Constants of a block of bodies. POINSOT_E_DOMAIN where no body has such moments (the rule of
   !> `accept_moments`: few digits are taken), POINSOT_E_NOT_FINITE where they are no numbers; such
   !> a lane has the constants of a sphere.
   pure subroutine make_lane_constants(moments, nvec, c, status)
      real(dp), intent(inout) :: moments(lanes, 3)  !! principal moments, any order, any unit; on
                                                    !! exit as they are taken
      integer, intent(in) :: nvec                   !! groups of lanes to work on
      type(lane_constants), intent(inout) :: c
      integer, intent(inout) :: status(lanes)
      real(dp) :: least
      call accept_lanes(moments, nvec, status, least)
      call make_constants(nvec, moments, c)
   end subroutine make_lane_constants

   !> Moments as they are taken; those of a sphere where no body has such, with a status.
   pure subroutine accept_lanes(moments, nvec, status, least)
      real(dp), intent(inout) :: moments(lanes, 3)
      integer, intent(in) :: nvec
      integer, intent(inout) :: status(lanes)
      real(dp), intent(out) :: least                !! the smallest of all; 0: a body has none about
                                                    !! some axis
      integer(i8) :: plain(lanes)
      logical :: all_plain
      integer :: l
      call find_plain(nvec, moments, plain, all_plain, least)
      if (all_plain) return
      do l = 1, group*nvec
         if (plain(l) == 0) call take_special(moments(l, :), status(l))
      end do
      least = minval(moments(:group*nvec, :))
   end subroutine accept_lanes

   !> Mask of the lanes whose moments `accept_moments` takes as they are: positive, within the
   !> triangle inequality, and of no body as thin as a line.
   pure subroutine find_plain(nvec, moments, plain, all_plain, least)
      integer, intent(in) :: nvec
      real(dp), intent(in) :: moments(lanes, 3)
      integer(i8), intent(out) :: plain(lanes)
      logical, intent(out) :: all_plain
      real(dp), intent(out) :: least                !! the smallest of all, if they are plain
      real(dp), parameter :: thin = 1e-9_dp, slack = 0.9e-3_dp !! well within what is taken
      integer(i8) :: b1, b2, b3, mask, all_of_them, lowest
      real(dp) :: m1, m2, m3, small, large, middle
      integer :: l
      all_of_them = -1
      lowest = huge(lowest)
      !$omp simd private(b1, b2, b3, mask, m1, m2, m3, small, large, middle) &
      !$omp reduction(iand: all_of_them) reduction(min: lowest)
      do l = 1, group*nvec
         b1 = transfer(moments(l, 1), b1)
         b2 = transfer(moments(l, 2), b2)
         b3 = transfer(moments(l, 3), b3)
         lowest = min(lowest, b1, b2, b3)
         mask = max(min(b1, b2, b3), 0_i8) - smallest_bits ! 0 in place of what is negative:
         mask = ior(mask, largest_bits - max(b1, b2, b3, 0_i8)) ! a difference must not overflow
         mask = not(shifta(mask, 63))
         m1 = choose(mask, moments(l, 1), 1.0_dp)
         m2 = choose(mask, moments(l, 2), 1.0_dp)
         m3 = choose(mask, moments(l, 3), 1.0_dp)
         small = min(m1, m2, m3)
         large = max(m1, m2, m3)
         middle = max(min(m1, m2), min(max(m1, m2), m3))
         mask = iand(mask, below(thin*large, small))
         mask = iand(mask, below(large - middle, small + slack*large))
         plain(l) = mask
         all_of_them = iand(all_of_them, mask)
      end do
      all_plain = all_of_them /= 0
      least = transfer(lowest, least)
   end subroutine find_plain

   !> Moments of one lane by the rule for all: thin and linear bodies, or none.
   pure subroutine take_special(moments, status)
      real(dp), intent(inout) :: moments(3)
      integer, intent(inout) :: status
      type(poinsot_error) :: refusal
      integer(i8) :: most
      real(dp) :: taken(3)
      most = maxval(iand(transfer(moments, [most]), exponent_bits))
      taken = moments
      if (most < exponent_bits) call accept_moments(taken, refusal)
      moments = taken
      if (most < exponent_bits .and. .not. raised(refusal)) return
      if (status == poinsot_ok) status = merge(poinsot_e_domain, poinsot_e_not_finite, &
         most < exponent_bits)
      moments = 1
   end subroutine take_special

   !> Steps of a block. A lane whose status is not POINSOT_OK stands still; a lane that fails here
   !> gets its status and keeps its state of then.
   pure subroutine advance_each(c, by_jacobi, h, steps, y, q, status, nvec, carry)
      type(lane_constants), intent(in) :: c                  !! from make_lane_constants
      logical, intent(in) :: by_jacobi                       !! method `jacobi`, else `exact`
      real(dp), intent(in) :: h(lanes)                       !! step of each lane, either sign
      integer, intent(in) :: steps                           !! how many, with the same bits in one
                                                             !! call as in several
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)    !! the state, caller's axes
      integer, intent(inout) :: status(lanes)
      integer, intent(in) :: nvec                            !! groups of lanes to work on
      real(dp), intent(inout), optional :: carry(lanes, 7)   !! compensated sums, if wanted
      real(dp) :: hs(lanes), ys(lanes, 3), qs(lanes, 4), cs(lanes, 7)
      logical :: watch
      integer :: k
      call put_in_order(nvec, c, h, status, y, q, hs, ys, qs, watch)
      if (present(carry)) call order_vectors(nvec, c, carry(:, 1:3), carry(:, 4:7), cs(:, 1:3), &
         cs(:, 4:7))
      do k = 1, steps
         if (watch) then
            call stop_failed(nvec, status, hs)
            call reject_far(nvec, c, ys, hs, status)
         end if
         if (present(carry)) then
            call sorted_compensated(nvec, c, by_jacobi, hs, ys, qs, cs, status)
         else
            call sorted_step(nvec, c, by_jacobi, hs, ys, qs, status)
         end if
         if (k < steps) watch = watch .or. any_failed(status, nvec)
      end do
      call put_back(nvec, c, ys, qs, y, q)
      if (present(carry)) call put_back(nvec, c, cs(:, 1:3), cs(:, 4:7), carry(:, 1:3), &
         carry(:, 4:7))
   end subroutine advance_each

   ! The order of axes
   ! -----------------------------------------------------------------------------------------------

   !> The state in sorted, right-handed axes. Is there a lane to be watched: one that has failed, or
   !> whose y/I h might leave the range, now or once it has turned? That by the largest exponents in
   !> the block: no bit depends on the answer, since no step is taken from 1e15 on, and squares
   !> overflow from 1e154 on only.
   pure subroutine put_in_order(nvec, c, h, status, y, q, hs, ys, qs, watch)
      integer, intent(in) :: nvec
      type(lane_constants), intent(in) :: c
      real(dp), intent(in) :: h(lanes)
      integer, intent(in) :: status(lanes)
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: hs(lanes), ys(lanes, 3), qs(lanes, 4)
      logical, intent(out) :: watch
      integer(i8), parameter :: margin = 2 ! a component may grow to 1.74 times the largest
      integer(i8) :: by, bi, bh
      integer :: l, failed
      call order_vectors(nvec, c, y, q, ys, qs)
      by = 0
      bi = 0
      bh = 0
      failed = 0
      !GCC$ ivdep
      do l = 1, group*nvec
         hs(l) = h(l)
         failed = ior(failed, status(l))
         by = max(by, transfer(abs(y(l, 1)), by), transfer(abs(y(l, 2)), by), &
                  transfer(abs(y(l, 3)), by))
         bi = max(bi, transfer(c%largest_inverse(l), bi))
         bh = max(bh, transfer(abs(h(l)), bh))
      end do
      watch = failed /= poinsot_ok .or. &
         shiftr(by, 52) + shiftr(bi, 52) + shiftr(bh, 52) - 3*1022 >= far_exponent - margin
   end subroutine put_in_order

   !> A vector and the vector part of a quaternion in sorted, right-handed axes.
   pure subroutine order_vectors(nvec, c, y, q, ys, qs)
      integer, intent(in) :: nvec
      type(lane_constants), intent(in) :: c
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4)
      real(dp), intent(out) :: ys(lanes, 3), qs(lanes, 4)
      real(dp) :: x1, x2, x3, z1, z2, z3
      integer(i8) :: m1, m2, m3
      integer :: l
      !$omp simd private(x1, x2, x3, z1, z2, z3, m1, m2, m3)
      do l = 1, group*nvec
         m1 = c%exchange(l, 1)
         m2 = c%exchange(l, 2)
         m3 = c%exchange(l, 3)
         x1 = c%parity(l)*y(l, 1)
         x2 = c%parity(l)*y(l, 2)
         x3 = c%parity(l)*y(l, 3)
         z1 = c%parity(l)*q(l, 2)
         z2 = c%parity(l)*q(l, 3)
         z3 = c%parity(l)*q(l, 4)
         call exchange(m1, x1, x2)
         call exchange(m1, z1, z2)
         call exchange(m2, x2, x3)
         call exchange(m2, z2, z3)
         call exchange(m3, x1, x2)
         call exchange(m3, z1, z2)
         ys(l, 1) = x1
         ys(l, 2) = x2
         ys(l, 3) = x3
         qs(l, 1) = q(l, 1)
         qs(l, 2) = z1
         qs(l, 3) = z2
         qs(l, 4) = z3
      end do
   end subroutine order_vectors

   !> Back in the caller's axes.
   pure subroutine put_back(nvec, c, ys, qs, y, q)
      integer, intent(in) :: nvec
      type(lane_constants), intent(in) :: c
      real(dp), intent(in) :: ys(lanes, 3), qs(lanes, 4)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      real(dp) :: x1, x2, x3, z1, z2, z3
      integer(i8) :: m1, m2, m3
      integer :: l
      !$omp simd private(x1, x2, x3, z1, z2, z3, m1, m2, m3)
      do l = 1, group*nvec
         m1 = c%exchange(l, 1)
         m2 = c%exchange(l, 2)
         m3 = c%exchange(l, 3)
         x1 = c%parity(l)*ys(l, 1)
         x2 = c%parity(l)*ys(l, 2)
         x3 = c%parity(l)*ys(l, 3)
         z1 = c%parity(l)*qs(l, 2)
         z2 = c%parity(l)*qs(l, 3)
         z3 = c%parity(l)*qs(l, 4)
         call exchange(m3, x1, x2)
         call exchange(m3, z1, z2)
         call exchange(m2, x2, x3)
         call exchange(m2, z2, z3)
         call exchange(m1, x1, x2)
         call exchange(m1, z1, z2)
         y(l, 1) = x1
         y(l, 2) = x2
         y(l, 3) = x3
         q(l, 1) = qs(l, 1)
         q(l, 2) = z1
         q(l, 3) = z2
         q(l, 4) = z3
      end do
   end subroutine put_back

   elemental subroutine exchange(mask, a, b)
      integer(i8), intent(in) :: mask
      real(dp), intent(inout) :: a, b
      real(dp) :: old
      old = a
      a = merge(b, a, mask < 0)
      b = merge(old, b, mask < 0)
   end subroutine exchange

   ! Steps in sorted axes
   ! -----------------------------------------------------------------------------------------------

   !> Plain sums.
   pure subroutine sorted_step(nvec, c, by_jacobi, h, y, q, status)
      integer, intent(in) :: nvec
      type(lane_constants), intent(in) :: c
      logical, intent(in) :: by_jacobi
      real(dp), intent(in) :: h(lanes)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      integer, intent(inout) :: status(lanes)
      type(step_rotation) :: rotation
      real(dp), dimension(lanes) :: sizes, parts, hs
      real(dp) :: dy(lanes, 3), dq(lanes, 4), ys(lanes, 3), qs(lanes, 4)
      logical :: beyond
      integer :: k, n
      n = group*nvec
      if (.not. by_jacobi) then
         call find_rotation(nvec, c, h, y, rotation, sizes, beyond)
         if (.not. beyond) then
            call turn(nvec, rotation, h, y, q)
            return
         end if
      end if
      call split(nvec, c, by_jacobi, h, sizes, parts, hs, status)
      ys(:n, :) = y(:n, :)
      qs(:n, :) = q(:n, :)
      if (any(parts(:n) < 0)) then
         call jacobi_lanes(nvec, c, hs, y, q, dy, dq, status)
         call stop_failed(nvec, status, hs)
         call add_plain(hs, dy, dq, ys, qs, nvec)
         call take(n, parts(:n) < 0 .and. status(:n) == poinsot_ok, ys, qs, y, q)
      end if
      do k = 1, nint(maxval(parts(:n)))
         hs(:n) = merge(h(:n), 0.0_dp, k <= parts(:n))/max(parts(:n), 1.0_dp)
         ys(:n, :) = y(:n, :)
         qs(:n, :) = q(:n, :)
         call find_rotation(nvec, c, hs, ys, rotation, sizes, beyond)
         if (beyond) exit
         call turn(nvec, rotation, hs, ys, qs)
         call take(n, k <= parts(:n), ys, qs, y, q)
      end do
   end subroutine sorted_step

   !> Lanes of one state from another, and of the others not as much as a zero added.
   pure subroutine take(n, which, y_from, q_from, y, q)
      integer, intent(in) :: n
      logical, intent(in) :: which(n)
      real(dp), intent(in) :: y_from(lanes, 3), q_from(lanes, 4)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      integer :: l
      do l = 1, n
         if (.not. which(l)) cycle
         y(l, :) = y_from(l, :)
         q(l, :) = q_from(l, :)
      end do
   end subroutine take

   !> Compensated sums.
   pure subroutine sorted_compensated(nvec, c, by_jacobi, h, y, q, carry, status)
      integer, intent(in) :: nvec
      type(lane_constants), intent(in) :: c
      logical, intent(in) :: by_jacobi
      real(dp), intent(inout) :: h(lanes)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4), carry(lanes, 7)
      integer, intent(inout) :: status(lanes)
      type(step_rotation) :: rotation
      real(dp), dimension(lanes) :: sizes, parts, hs
      real(dp) :: dy(lanes, 3), dq(lanes, 4), ddy(lanes, 3), ddq(lanes, 4)
      real(dp) :: yk(lanes, 3), qk(lanes, 4), gap(lanes, 2)
      logical :: beyond
      integer :: k, l, n
      n = group*nvec
      dy(:n, :) = 0
      dq(:n, :) = 0
      beyond = .true.
      if (.not. by_jacobi) call find_rotation(nvec, c, h, y, rotation, sizes, beyond)
      if (.not. beyond) then
         call increments(nvec, rotation, y, q, dy, dq)
      else
         call split(nvec, c, by_jacobi, h, sizes, parts, hs, status)
         if (any(parts(:n) < 0)) call jacobi_lanes(nvec, c, hs, y, q, dy, dq, status)
         yk(:n, :) = y(:n, :)
         qk(:n, :) = q(:n, :)
         do k = 1, nint(maxval(parts(:n)))
            hs(:n) = merge(h(:n), 0.0_dp, k <= parts(:n))/max(parts(:n), 1.0_dp)
            call find_rotation(nvec, c, hs, yk, rotation, sizes, beyond)
            if (beyond) exit
            call increments(nvec, rotation, yk, qk, ddy, ddq)
            do l = 1, n
               if (k > parts(l)) cycle
               dy(l, :) = merge(ddy(l, :), dy(l, :) + ddy(l, :), k == 1)
               dq(l, :) = merge(ddq(l, :), dq(l, :) + ddq(l, :), k == 1)
               yk(l, :) = y(l, :) + dy(l, :)
               qk(l, :) = q(l, :) + dq(l, :)
            end do
         end do
         call stop_failed(nvec, status, h)
         do l = 1, n
            if (status(l) == poinsot_ok) cycle
            dy(l, :) = 0 ! what is refused moves by no bit
            dq(l, :) = 0
         end do
      end if
      gap(:n, 1) = (c%moments(:n, 2) - c%moments(:n, 1))/c%moments(:n, 2)
      gap(:n, 2) = c%f1(:n)
      call conserve_each(c%inverse, gap, in_order, .true., h, y, dy, carry, nvec)
      call add_compensated(h, dy, dq, y, q, carry, nvec)
   end subroutine sorted_compensated

   !> How many substeps each lane takes; -1: Jacobi's functions (its h in hs, else 0); 0: h is too
   !> long for any way.
   pure subroutine split(nvec, c, by_jacobi, h, sizes, parts, hs, status)
      integer, intent(in) :: nvec
      type(lane_constants), intent(in) :: c
      logical, intent(in) :: by_jacobi
      real(dp), intent(in) :: h(lanes), sizes(lanes)
      real(dp), intent(out) :: parts(lanes), hs(lanes)
      integer, intent(inout) :: status(lanes)
      integer :: l
      do l = 1, group*nvec
         parts(l) = -1
         hs(l) = h(l)
         if (by_jacobi) cycle
         parts(l) = count_substeps(sizes(l), c%reach(l))
         if (parts(l) < 1) status(l) = poinsot_e_step
         hs(l) = merge(h(l), 0.0_dp, parts(l) > most_substeps)
         if (parts(l) > most_substeps) parts(l) = -1
      end do
   end subroutine split

   !> The rotation of a step; none if a lane is `beyond` the short series, by its size p + r.
   pure subroutine find_rotation(nvec, c, h, y, rotation, sizes, beyond)
      integer, intent(in) :: nvec
      type(lane_constants), intent(in) :: c
      real(dp), intent(in) :: h(lanes), y(lanes, 3)
      type(step_rotation), intent(inout) :: rotation
      real(dp), intent(inout) :: sizes(lanes)
      logical, intent(out) :: beyond
      real(dp), dimension(lanes) :: xss, zss, products, pss, rss
      call find_series(nvec, c, h, y, xss, zss, products, pss, rss, sizes, beyond)
      if (.not. beyond) call find_axis(nvec, c, h, y, xss, zss, products, pss, rss, rotation)
   end subroutine find_rotation

   !> The short series of every lane.
   pure subroutine find_series(nvec, c, h, y, xss, zss, products, pss, rss, sizes, beyond)
      integer, intent(in) :: nvec
      type(lane_constants), intent(in) :: c
      real(dp), intent(in) :: h(lanes), y(lanes, 3)
      real(dp), intent(out), dimension(lanes) :: xss, zss, products, pss, rss
      real(dp), intent(inout) :: sizes(lanes)
      logical, intent(out) :: beyond
      real(dp) :: k1, k3, b4, c4, w1, w2, w3, square, p, r, cp, cr, x, z, e, f, t, u
      real(dp) :: xs, zs, product, ps, rs
      integer(i8) :: over
      integer :: l
      over = 0
      !GCC$ ivdep
      do l = 1, group*nvec
         w1 = y(l, 1)*c%inverse(l, 1)*h(l)
         w2 = y(l, 2)*c%inverse(l, 2)*h(l)
         w3 = y(l, 3)*c%inverse(l, 3)*h(l)
         k1 = c%k1(l)
         k3 = c%k3(l)
         b4 = c%b4(l)
         c4 = c%c4(l)
         associate (p01 => c%half_p(l, 0, 1), p11 => c%half_p(l, 1, 1), p21 => c%half_p(l, 2, 1), &
                    p31 => c%half_p(l, 3, 1), p02 => c%half_p(l, 0, 2), p12 => c%half_p(l, 1, 2), &
                    p22 => c%half_p(l, 2, 2), p03 => c%half_p(l, 0, 3), p13 => c%half_p(l, 1, 3), &
                    p04 => c%half_p(l, 0, 4), r10 => c%half_r(l, 1, 0), r11 => c%half_r(l, 1, 1), &
                    r12 => c%half_r(l, 1, 2), r13 => c%half_r(l, 1, 3), r20 => c%half_r(l, 2, 0), &
                    r21 => c%half_r(l, 2, 1), r22 => c%half_r(l, 2, 2), r30 => c%half_r(l, 3, 0), &
                    r31 => c%half_r(l, 3, 1), r40 => c%half_r(l, 4, 0))
            include "exact_step_near.inc"
         end associate
         over = ior(over, transfer(c%reach(l), over) - transfer(p + r, over))
         sizes(l) = p + r
         xss(l) = xs
         zss(l) = zs
         products(l) = product
         pss(l) = ps
         rss(l) = rs
      end do
      beyond = over < 0
   end subroutine find_series

   !> The rotation of every lane.
   pure subroutine find_axis(nvec, c, h, y, xss, zss, products, pss, rss, rotation)
      integer, intent(in) :: nvec
      type(lane_constants), intent(in) :: c
      real(dp), intent(in) :: h(lanes), y(lanes, 3)
      real(dp), intent(in), dimension(lanes) :: xss, zss, products, pss, rss
      type(step_rotation), intent(inout) :: rotation
      real(dp) :: a1, a2, a3, theta, f1, w1, w2, w3, xs, zs, product, ps, rs
      real(dp) :: den, u, cf, df, b, g, u1, u3, s1, s2, s3, d, loss, v1, v2, v3, vv
      real(dp) :: cosine, factor
      integer :: l
      !GCC$ ivdep
      do l = 1, group*nvec
         w1 = y(l, 1)*c%inverse(l, 1)*h(l)
         w2 = y(l, 2)*c%inverse(l, 2)*h(l)
         w3 = y(l, 3)*c%inverse(l, 3)*h(l)
         a1 = c%a(l, 1)
         a2 = c%a(l, 2)
         a3 = c%a(l, 3)
         theta = c%theta(l)
         f1 = c%f1(l)
         xs = xss(l)
         zs = zss(l)
         product = products(l)
         ps = pss(l)
         rs = rss(l)
         include "exact_step_second.inc"
         include "exact_step_angle.inc"
         rotation%v(l, 1) = v1
         rotation%v(l, 2) = v2
         rotation%v(l, 3) = v3
         rotation%loss(l) = loss
         rotation%cosine(l) = cosine
         rotation%factor(l) = factor
      end do
   end subroutine find_axis

   !> The next state, plain sums, |q| drawn to 1. A lane with h = 0 keeps its bits.
   pure subroutine turn(nvec, rotation, h, y, q)
      integer, intent(in) :: nvec
      type(step_rotation), intent(in) :: rotation
      real(dp), intent(in) :: h(lanes)
      real(dp), intent(inout) :: y(lanes, 3), q(lanes, 4)
      real(dp) :: v1, v2, v3, cosine, factor, y1, y2, y3, q0, q1, q2, q3, draw
      real(dp) :: u1, u2, u3, k, d1, d2, d3, e0, e1, e2, e3
      real(dp), parameter :: parity = 1
      integer, parameter :: i1 = 1, i2 = 2, i3 = 3
      integer :: l
      !GCC$ ivdep
      do l = 1, group*nvec
         draw = merge(0.5_dp, 0.0_dp, abs(h(l)) > 0)
         include "exact_step_third.inc"
         y(l, 1) = y1 + d1
         y(l, 2) = y2 + d2
         y(l, 3) = y3 + d3
         q(l, 1) = q0 + e0
         q(l, 2) = q1 + e1
         q(l, 3) = q2 + e2
         q(l, 4) = q3 + e3
      end do
   end subroutine turn

   !> The increments of y and q.
   pure subroutine increments(nvec, rotation, y, q, dy, dq)
      integer, intent(in) :: nvec
      type(step_rotation), intent(in) :: rotation
      real(dp), intent(in) :: y(lanes, 3), q(lanes, 4)
      real(dp), intent(inout) :: dy(lanes, 3), dq(lanes, 4)
      real(dp) :: v1, v2, v3, cosine, factor, y1, y2, y3, q0, q1, q2, q3
      real(dp) :: u1, u2, u3, k, d1, d2, d3, e0, e1, e2, e3
      real(dp), parameter :: parity = 1, draw = 0
      integer, parameter :: i1 = 1, i2 = 2, i3 = 3
      integer :: l
      !GCC$ ivdep
      do l = 1, group*nvec
         include "exact_step_third.inc"
         dy(l, 1) = d1
         dy(l, 2) = d2
         dy(l, 3) = d3
         dq(l, 1) = e0
         dq(l, 2) = e1
         dq(l, 3) = e2
         dq(l, 4) = e3
      end do
   end subroutine increments

   ! Steps that are too long, lanes that have failed
   ! -----------------------------------------------------------------------------------------------

   !> POINSOT_E_STEP, and no step, where y/I h leaves the range. Exponents are compared, nothing is
   !> multiplied.
   pure subroutine reject_far(nvec, c, y, h, status)
      integer, intent(in) :: nvec
      type(lane_constants), intent(in) :: c
      real(dp), intent(in) :: y(lanes, 3)
      real(dp), intent(inout) :: h(lanes)
      integer, intent(inout) :: status(lanes)
      integer :: l, j
      do j = 1, 3
         do l = 1, group*nvec
            if (.not. abs(y(l, j)) > 0 .or. .not. abs(h(l)) > 0) cycle
            if (.not. abs(c%inverse(l, j)) > 0) cycle
            if (exponent(y(l, j)) + exponent(c%inverse(l, j)) + exponent(h(l)) &
                < far_exponent) cycle
            status(l) = poinsot_e_step
            h(l) = 0
         end do
      end do
   end subroutine reject_far

   pure subroutine stop_failed(nvec, status, h)
      integer, intent(in) :: nvec, status(lanes)
      real(dp), intent(inout) :: h(lanes)
      where (status(:group*nvec) /= poinsot_ok) h(:group*nvec) = 0
   end subroutine stop_failed

   ! Choices
   ! -----------------------------------------------------------------------------------------------

   include "../core/choose.inc"
   include "../core/below.inc"

end module poinsot_free_exact_lanes
