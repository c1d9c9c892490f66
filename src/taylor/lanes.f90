!> The Taylor integrator of torques in two precisions on `width` lanes, each with its own body, step
!> size and time. A lane that has finished takes the next body; lanes are independent of each other.
module poinsot_taylor_lanes
   use, intrinsic :: iso_c_binding, only: c_loc, c_f_pointer, c_intptr_t
   use poinsot_core_constants, only: exponent_bits
   use poinsot_core_kinds, only: sp, dp, i4, i8
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_step
   use poinsot_effect_geometry, only: turned
   use poinsot_rotation_vector, only: cross
   use poinsot_taylor_problem, only: taylor_problem, place_in_table, see_phases
   use poinsot_taylor_settings, only: taylor_orders, taylor_time
   use poinsot_taylor_series_common, only: last_order, last_double
   use poinsot_taylor_series_double, only: d_width => width, d_constants => lane_constants, &
      d_extras => lane_extras, d_series_one => series_one, d_series_two => series_two, &
      d_fill_cosine => fill_cosine, d_horner_one => horner_one, &
      d_horner_two => horner_two, d_turn_one => turn_one, d_turn_two => turn_two
   use poinsot_taylor_series_single, only: s_constants => lane_constants, &
      s_extras => lane_extras, s_series_one => series_one, s_series_two => series_two, &
      s_fill_cosine => fill_cosine, s_horner_one => horner_one, &
      s_horner_two => horner_two, s_turn_one => turn_one, s_turn_two => turn_two
   use poinsot_taylor_lanes_common, only: fastest, slowest, two_ones, smallest, &
      one_bits, per_bit, bits_per, longest_turn, almost_one, most_parts, grid_bits, grid_limit
   implicit none(type, external)
   private
   public :: run_lanes

   integer, parameter :: parts = 2              ! vectors of double precision

   integer, parameter :: width = d_width*parts   ! lanes

   !> Series of all lanes: angular velocity, one or two directions, d = 1 + n.n(0) and the rate p of
   !> the angle; in double precision, then in single.
   type :: series_store
      real(dp) :: w(d_width, 3, 0:last_double, parts), n(d_width, 3, 0:last_double, parts), &
         m(d_width, 3, 0:last_double, parts), d(d_width, 0:last_double, parts), &
         p(d_width, 0:last_double, parts)
      real(sp) :: ws(width, 3, 0:last_order), ns(width, 3, 0:last_order), &
         ms(width, 3, 0:last_order), ds(width, 0:last_order), ps(width, 0:last_order)
   end type series_store

   !> What the lanes hold from step to step.
   type :: lane_state
      real(dp) :: y(d_width, 3, parts) = 0, y_carry(d_width, 3, parts) = 0
      real(dp) :: q(d_width, 4, parts) = 0, q_carry(d_width, 4, parts) = 0
      real(dp) :: left(d_width, parts) = 0      !! of the step h, with its sign; 0: it is done
      real(dp) :: reach(d_width, parts) = 0     !! to the end of h or the next knot of a table
      real(dp) :: p(d_width, parts) = 1         !! rate of scaled time: a power of two
      real(dp) :: h(d_width, parts) = 0         !! substep
      integer :: body(d_width, parts) = 0       !! 0: idle
      integer(i8) :: step(d_width, parts) = 0   !! number of the step h
      integer :: live = 0                       !! lanes that are not idle
      integer :: parts = 1                      !! vectors of double precision that have bodies
      integer :: next = 1                       !! body
   end type lane_state

   !> What a substep adds.
   type :: increments
      real(dp) :: dw(d_width, 3, parts)         !! to scaled angular velocities
      real(dp) :: turn(d_width, 4, parts)       !! a quaternion less 1
      real(dp) :: scale(d_width, parts)         !! of torques
      real(dp) :: far(d_width, parts)           !! positive where the substep is too long
      real(dp) :: h(d_width), sums(d_width, 9)
      real(sp) :: dws(width, 3), turns(width, 4), fars(width), hs(width), tail(width, 9)
   end type increments

   !> All of these begin at a line of cache: vectors across two cost a quarter of the time.
   type :: lane_memory
      type(series_store) :: series
      type(d_constants) :: cd(parts)
      type(s_constants) :: cs
      type(increments) :: gain
      type(lane_state) :: a
   end type lane_memory

contains

   !> Steps first to first + steps - 1 of length h for n bodies of one class. A body that fails
   !> keeps its state, and its status says why; one that is not POINSOT_OK at the start is left out.
   subroutine run_lanes(problem, orders, time, keep, n, y, q, carry, status)
      type(taylor_problem), intent(in) :: problem
      type(taylor_orders), intent(in) :: orders
      type(taylor_time), intent(in) :: time
      logical, intent(in) :: keep                     !! there is a carry
      integer, intent(in) :: n
      real(dp), intent(inout) :: y(3, n), q(4, n)
      real(dp), intent(inout) :: carry(7, merge(n, 0, keep))
      integer, intent(inout) :: status(n)
      type(lane_memory), pointer :: m
      real(dp), target :: memory(storage_size(m)/storage_size(1.0_dp) + 8)   ! not saved
      type(d_extras) :: xd(parts)
      type(s_extras) :: xs
      integer :: shift
      shift = int(modulo(-transfer(c_loc(memory), 0_c_intptr_t), 64_c_intptr_t))/8
      call c_f_pointer(c_loc(memory(1 + shift)), m)
      if (n <= d_width) memory = 0                    ! lanes that are never used
      m%a = lane_state()
      m%a%q(:, 1, :) = 1
      call fill_constants(problem, m%cd, m%cs)
      if (.not. problem%simple) call open_extras(problem, xd, xs)
      call refill(problem, time, keep, n, y, q, carry, status, m%a)
      do while (m%a%live > 0)
         call substep(problem, orders, time, m%series, m%cd, m%cs, xd, xs, m%gain, m%a, status)
         if (count_done(m%a%left) <= width - m%a%live) cycle
         call finish(problem, time, keep, n, y, q, carry, status, m%a)
         call refill(problem, time, keep, n, y, q, carry, status, m%a)
      end do
   end subroutine run_lanes

   !> What does not depend on the time scale of a lane.
   pure subroutine fill_constants(problem, cd, cs)
      type(taylor_problem), intent(in) :: problem
      type(d_constants), intent(inout) :: cd(parts)
      type(s_constants), intent(inout) :: cs
      integer :: i, b
      do i = 1, 3
         cs%g(:, i) = real(problem%g(i), sp)
         do b = 1, parts
            cd(b)%g(:, i) = problem%g(i)
         end do
      end do
      cs%arm = 0
      cs%e = 0
      do b = 1, parts
         cd(b)%e = 0
      end do
   end subroutine fill_constants

   !> One substep of all lanes.
   subroutine substep(problem, orders, time, store, cd, cs, xd, xs, gain, a, status)
      type(taylor_problem), intent(in) :: problem
      type(taylor_orders), intent(in) :: orders
      type(taylor_time), intent(in) :: time
      type(series_store), intent(inout) :: store
      type(d_constants), intent(inout) :: cd(parts)
      type(s_constants), intent(inout) :: cs
      type(d_extras), intent(inout) :: xd(parts)
      type(s_extras), intent(inout) :: xs
      type(increments), intent(inout) :: gain
      type(lane_state), intent(inout) :: a
      integer, intent(inout) :: status(:)
      integer :: b
      logical :: far
      do b = 1, a%parts
         call enter(problem, a%y(:, :, b), a%y_carry(:, :, b), a%q(:, :, b), a%p(:, b), &
            store%w(:, :, :, b), store%n(:, :, :, b), store%m(:, :, :, b), gain%scale(:, b))
      end do
      a%reach = a%left
      if (any_fast(a%p)) call refuse_fast(problem, a, status)
      if (.not. problem%simple) call fill_extras(problem, time, a, xd, xs)
      call fill_arms(problem, orders%double > 0, a%parts, gain%scale, cd, cs)
      do b = 1, merge(a%parts, 0, orders%double > 0)
         if (problem%fixed == 1) then
            call d_series_one(0, orders%double, problem%simple, cd(b), xd(b), store%w(:, :, :, b), &
               store%n(:, :, :, b), store%d(:, :, b), store%p(:, :, b))
         else
            call d_series_two(0, orders%double, cd(b), xd(b), store%w(:, :, :, b), &
               store%n(:, :, :, b), store%m(:, :, :, b))
         end if
      end do
      call to_single(orders%double, problem%fixed > 1, a%parts, store)
      if (.not. problem%simple) call extras_to_single(orders%double, xd, xs)
      if (problem%fixed == 1) then
         call s_series_one(orders%double, orders%last, problem%simple, cs, xs, store%ws, store%ns, &
            store%ds, store%ps)
      else
         call s_series_two(orders%double, orders%last, cs, xs, store%ws, store%ns, store%ms)
      end if
      call choose_steps(problem, orders, store, a, status)
      far = .true.
      if (orders%double == 0) then
         do while (far)
            call advance_single(orders, problem%fixed > 1, store, a, gain, far)
         end do
         call add_single(problem%moments, gain%dws, gain%turns, a)
      else
         do while (far)
            call advance(orders, problem%fixed > 1, store, a, gain, far)
         end do
         call add(problem%moments, gain%dw, gain%turn, a)
      end if
   end subroutine substep

   !> Angular velocity, directions, scales of time and torque at the start of a substep.
   subroutine enter(problem, y, carry, q, p, w, n, m, scale)
      type(taylor_problem), intent(in) :: problem
      real(dp), intent(in) :: y(d_width, 3), carry(d_width, 3), q(d_width, 4)
      real(dp), intent(out) :: p(d_width)
      real(dp), intent(inout) :: w(d_width, 3, 0:last_double), n(d_width, 3, 0:last_double), &
         m(d_width, 3, 0:last_double)
      real(dp), intent(out) :: scale(d_width)
      real(dp) :: o1, o2, o3, s, r
      integer :: l
      !GCC$ ivdep
      do l = 1, d_width
         o1 = ((y(l, 1) - problem%rotor(1)) + carry(l, 1))*problem%inverse(1)
         o2 = ((y(l, 2) - problem%rotor(2)) + carry(l, 2))*problem%inverse(2)
         o3 = ((y(l, 3) - problem%rotor(3)) + carry(l, 3))*problem%inverse(3)
         s = max(problem%growth*max(abs(o1), abs(o2), abs(o3)), problem%rate, slowest)
         s = transfer(iand(transfer(s, 1_i8), exponent_bits), 1.0_dp)
         p(l) = s
         s = transfer(two_ones - transfer(s, 1_i8), 1.0_dp)
         w(l, 1, 0) = o1*s
         w(l, 2, 0) = o2*s
         w(l, 3, 0) = o3*s
         r = problem%unit*s
         scale(l) = r*r
      end do
      call seen(problem%basis(:, 1), q, n)
      if (problem%fixed > 1) call seen(problem%basis(:, 2), q, m)
   end subroutine enter

   !> Arms of the first direction in scaled time; the scales are powers of two.
   pure subroutine fill_arms(problem, double, used, scale, cd, cs)
      type(taylor_problem), intent(in) :: problem
      logical, intent(in) :: double             !! in double precision too
      integer, intent(in) :: used
      real(dp), intent(in) :: scale(d_width, parts)
      type(d_constants), intent(inout) :: cd(parts)
      type(s_constants), intent(inout) :: cs
      real(dp) :: e(6)
      integer :: b, i, l
      associate (m => problem%linear(:, :, 1))
         e = [m(1, 2), m(1, 3), m(2, 3), m(2, 1), m(3, 1), m(3, 2)]
      end associate
      do b = 1, used
         !GCC$ ivdep
         do l = 1, d_width
            cs%arm(l + (b - 1)*d_width, 1) = real(e(1)*scale(l, b), sp)
            cs%arm(l + (b - 1)*d_width, 2) = real(e(2)*scale(l, b), sp)
            cs%arm(l + (b - 1)*d_width, 3) = real(e(3)*scale(l, b), sp)
            cs%arm(l + (b - 1)*d_width, 4) = real(e(4)*scale(l, b), sp)
            cs%arm(l + (b - 1)*d_width, 5) = real(e(5)*scale(l, b), sp)
            cs%arm(l + (b - 1)*d_width, 6) = real(e(6)*scale(l, b), sp)
         end do
      end do
      do b = 1, merge(used, 0, double)
         do i = 1, 6
            cd(b)%arm(:, i) = e(i)*scale(:, b)
         end do
      end do
   end subroutine fill_arms

   !> Q^T e of all lanes, of length 1 to rounding whatever |q| has lost.
   pure subroutine seen(e, q, v)
      real(dp), intent(in) :: e(3), q(d_width, 4)
      real(dp), intent(inout) :: v(d_width, 3)
      real(dp) :: f, s, d, a, b1, b2, b3
      integer :: l
      !GCC$ ivdep
      do l = 1, d_width
         a = q(l, 1); b1 = q(l, 2); b2 = q(l, 3); b3 = q(l, 4)
         s = b1*b1 + (b2*b2 + b3*b3)
         f = 2 - (a*a + s)
         s = (a*a - s)*f
         d = 2*f*(b1*e(1) + (b2*e(2) + b3*e(3)))
         a = 2*f*a
         v(l, 1) = s*e(1) + (d*b1 + a*(e(2)*b3 - e(3)*b2))
         v(l, 2) = s*e(2) + (d*b2 + a*(e(3)*b1 - e(1)*b3))
         v(l, 3) = s*e(3) + (d*b3 + a*(e(1)*b2 - e(2)*b1))
      end do
   end subroutine seen

   !> Orders 0 to k in single precision.
   pure subroutine to_single(k, two, used, store)
      integer, intent(in) :: k
      logical, intent(in) :: two
      integer, intent(in) :: used
      type(series_store), intent(inout) :: store
      integer :: b, j, l, at
      do b = 1, used
         at = (b - 1)*d_width
         do j = 0, k
            !GCC$ ivdep
            do l = 1, d_width
               store%ws(at + l, 1, j) = real(store%w(l, 1, j, b), sp)
               store%ws(at + l, 2, j) = real(store%w(l, 2, j, b), sp)
               store%ws(at + l, 3, j) = real(store%w(l, 3, j, b), sp)
               store%ns(at + l, 1, j) = real(store%n(l, 1, j, b), sp)
               store%ns(at + l, 2, j) = real(store%n(l, 2, j, b), sp)
               store%ns(at + l, 3, j) = real(store%n(l, 3, j, b), sp)
            end do
         end do
         if (two) then
            do j = 0, k
               !GCC$ ivdep
               do l = 1, d_width
                  store%ms(at + l, 1, j) = real(store%m(l, 1, j, b), sp)
                  store%ms(at + l, 2, j) = real(store%m(l, 2, j, b), sp)
                  store%ms(at + l, 3, j) = real(store%m(l, 3, j, b), sp)
               end do
            end do
         else if (k > 0) then                ! the series begin with these
            do j = 0, k
               !GCC$ ivdep
               do l = 1, d_width
                  store%ds(at + l, j) = real(store%d(l, j, b), sp)
                  store%ps(at + l, j) = real(store%p(l, j, b), sp)
               end do
            end do
         end if
      end do
   end subroutine to_single

   !> The substep of every lane (Jorba and Zou 2005, section 3.2), a part of what is left: from the
   !> last two coefficients, on a grid of times, so that no rounding is lost in their sum.
   subroutine choose_steps(problem, orders, store, a, status)
      type(taylor_problem), intent(in) :: problem
      type(taylor_orders), intent(in) :: orders
      type(series_store), intent(in) :: store
      type(lane_state), intent(inout) :: a
      integer, intent(inout) :: status(:)
      real(sp) :: r(width), part(width), parts_left(width), longest
      real(dp) :: s
      integer :: b, l
      longest = huge(1.0_sp)
      if (problem%damped) longest = 0.5_sp*orders%last
      do b = 1, parts
         !GCC$ ivdep
         do l = 1, d_width
            r(l + (b - 1)*d_width) = real(min(abs(a%reach(l, b))*a%p(l, b), 1e30_dp), sp)
         end do
      end do
      call count_steps(orders%last, orders%log_tolerance, problem%fixed > 1, store%ws, store%ns, &
         store%ms, store%ps, r, part, parts_left)
      if (longest < 1e30_sp) call cap_damped(problem, longest, a%p, r, part, parts_left)
      if (any_many(parts_left)) call refuse_long(parts_left, a, status)
      do b = 1, parts
         !GCC$ ivdep
         do l = 1, d_width
            s = transfer(min(iand(transfer(a%reach(l, b), 1_i8), exponent_bits) + grid_bits, &
               grid_limit), 1.0_dp)
            s = 1.5_dp*s*min(real(parts_left(l + (b - 1)*d_width), dp) - 1, 1.0_dp)
            a%h(l, b) = (a%reach(l, b)*real(part(l + (b - 1)*d_width), dp) + s) - s
         end do
      end do
   end subroutine choose_steps

   !> How many equal substeps are left of r, and one of them as a part of it.
   pure subroutine count_steps(last, log_tolerance, two, w, n, m, p, r, part, parts_left)
      integer, intent(in) :: last
      real(sp), intent(in) :: log_tolerance           !! to base 2
      logical, intent(in) :: two
      real(sp), intent(in) :: w(width, 3, 0:last_order), n(width, 3, 0:last_order), &
         m(width, 3, 0:last_order), p(width, 0:last_order)
      real(sp), intent(in) :: r(width)
      real(sp), intent(out) :: part(width), parts_left(width)
      real(sp) :: f1, f2, s, t, u, x(width), y(width)
      integer :: l, k
      k = last
      f1 = 1.0_sp/k
      f2 = 1.0_sp/(k - 1)
      if (two) then
         !GCC$ ivdep
         do l = 1, width
            x(l) = max(abs(m(l, 1, k)), abs(m(l, 2, k)), abs(m(l, 3, k)))
            y(l) = max(abs(m(l, 1, k - 1)), abs(m(l, 2, k - 1)), abs(m(l, 3, k - 1)))
         end do
      else
         !GCC$ ivdep
         do l = 1, width
            x(l) = abs(p(l, k - 1))*f1
            y(l) = abs(p(l, k - 2))*f2
         end do
      end if
      !GCC$ ivdep
      do l = 1, width
         u = max(abs(w(l, 1, 0)), abs(w(l, 2, 0)), abs(w(l, 3, 0)))
         t = 1/max(u, abs(w(l, 1, 1)), abs(w(l, 2, 1)), abs(w(l, 3, 1)), 1e-30_sp)
         s = max(max(abs(w(l, 1, k)), abs(w(l, 2, k)), abs(w(l, 3, k)))*t, abs(n(l, 1, k)), &
            abs(n(l, 2, k)), abs(n(l, 3, k)), x(l), smallest)
         t = max(max(abs(w(l, 1, k - 1)), abs(w(l, 2, k - 1)), abs(w(l, 3, k - 1)))*t, &
            abs(n(l, 1, k - 1)), abs(n(l, 2, k - 1)), abs(n(l, 3, k - 1)), y(l), smallest)
         s = (real(transfer(s, 1_i4), sp) - one_bits)*per_bit
         t = (real(transfer(t, 1_i4), sp) - one_bits)*per_bit
         s = min((log_tolerance - s)*f1, (log_tolerance - t)*f2)
         s = transfer(int(s*bits_per + one_bits, i4), 1.0_sp)
         u = longest_turn/max(u, 0.01_sp)    ! a spin along n alone would make a step of many turns
         s = min(r(l)/min(s, u) + almost_one, 2e9_sp)
         s = max(real(int(s, i4), sp), 1.0_sp)
         parts_left(l) = s
         part(l) = 1/s
      end do
   end subroutine count_steps

   !> With drag the leading terms cancel beyond h friction/I = N/2: single precision would be lost.
   subroutine cap_damped(problem, longest, p, r, part, parts_left)
      type(taylor_problem), intent(in) :: problem
      real(sp), intent(in) :: longest
      real(dp), intent(in) :: p(d_width, parts)
      real(sp), intent(in) :: r(width)
      real(sp), intent(inout) :: part(width), parts_left(width)
      real(sp) :: least
      integer :: b, l, k
      do b = 1, parts
         do l = 1, d_width
            k = l + (b - 1)*d_width
            least = real(maxval(abs(problem%spin))/p(l, b), sp)/longest
            least = min(r(k)*least + almost_one, 2e9_sp)
            parts_left(k) = max(parts_left(k), real(int(least, i4), sp))
            part(k) = 1/parts_left(k)
         end do
      end do
   end subroutine cap_damped

   !> Increments over the substeps; `far`: some were too long, are halved, and must be done again.
   subroutine advance(orders, two, store, a, gain, far)
      type(taylor_orders), intent(in) :: orders
      logical, intent(in) :: two
      type(series_store), intent(in) :: store
      type(lane_state), intent(inout) :: a
      type(increments), intent(inout) :: gain
      logical, intent(out) :: far
      integer :: b, i, l, k
      call scaled_steps(a, gain%hs)
      k = orders%double
      gain%tail = 0
      if (two) then
         call s_horner_two(k, orders%last, gain%hs, store%ws, store%ns, store%ms, gain%tail)
      else
         call s_horner_one(k, orders%last, gain%hs, store%ws, store%ns, store%ps, gain%tail)
      end if
      do b = a%parts + 1, parts
         gain%dw(:, :, b) = 0
         gain%turn(:, :, b) = 0
         gain%far(:, b) = -1
      end do
      do b = 1, a%parts
         k = (b - 1)*d_width
         associate (h => gain%h, s => gain%sums, turn => gain%turn(:, :, b))
            h = a%h(:, b)*a%p(:, b)
            do i = 1, 9
               !GCC$ ivdep
               do l = 1, d_width
                  s(l, i) = gain%tail(k + l, i)
               end do
            end do
            if (two) then
               call d_horner_two(0, orders%double, h, store%w(:, :, :, b), store%n(:, :, :, b), &
                  store%m(:, :, :, b), s)
               call d_turn_two(h, store%n(:, :, 0, b), store%m(:, :, 0, b), s(:, 4:6), s(:, 7:9), &
                  turn(:, 1), turn(:, 2:4), gain%far(:, b))
            else
               call d_horner_one(0, orders%double, h, store%w(:, :, :, b), store%n(:, :, :, b), &
                  store%p(:, :, b), s)
               call d_turn_one(h, store%n(:, :, 0, b), s(:, 4:6), s(:, 7), turn(:, 1), &
                  turn(:, 2:4), gain%far(:, b))
            end if
            do i = 1, 3
               gain%dw(:, i, b) = s(:, i)*h
            end do
         end associate
      end do
      far = any_positive(gain%far)
      if (far) where (gain%far >= 0) a%h = 0.5_dp*a%h
   end subroutine advance

   !> The same where all is in single precision.
   subroutine advance_single(orders, two, store, a, gain, far)
      type(taylor_orders), intent(in) :: orders
      logical, intent(in) :: two
      type(series_store), intent(in) :: store
      type(lane_state), intent(inout) :: a
      type(increments), intent(inout) :: gain
      logical, intent(out) :: far
      integer :: i
      associate (h => gain%hs, s => gain%tail, turn => gain%turns)
         call scaled_steps(a, h)
         s = 0
         if (two) then
            call s_horner_two(0, orders%last, h, store%ws, store%ns, store%ms, s)
            call s_turn_two(h, store%ns, store%ms, s(:, 4:6), s(:, 7:9), turn(:, 1), &
               turn(:, 2:4), gain%fars)
         else
            call s_horner_one(0, orders%last, h, store%ws, store%ns, store%ps, s)
            call s_turn_one(h, store%ns, s(:, 4:6), s(:, 7), turn(:, 1), turn(:, 2:4), gain%fars)
         end if
         do i = 1, 3
            gain%dws(:, i) = s(:, i)*h
         end do
      end associate
      far = any_positive_single(gain%fars)
      if (.not. far) return
      gain%far = reshape(real(gain%fars, dp), [d_width, parts])
      where (gain%far >= 0) a%h = 0.5_dp*a%h
   end subroutine advance_single

   !> Substeps in scaled time.
   pure subroutine scaled_steps(a, h)
      type(lane_state), intent(in) :: a
      real(sp), intent(out) :: h(width)
      integer :: b, l
      do b = 1, parts
         !GCC$ ivdep
         do l = 1, d_width
            h(l + (b - 1)*d_width) = real(a%h(l, b)*a%p(l, b), sp)
         end do
      end do
   end subroutine scaled_steps

   !> Sums of increments in single precision: rounding is far below these, and nothing is carried.
   pure subroutine add_single(moments, dw, turn, a)
      real(dp), intent(in) :: moments(3)
      real(sp), intent(in) :: dw(width, 3)         !! of scaled angular velocities
      real(sp), intent(in) :: turn(width, 4)       !! less 1
      type(lane_state), intent(inout) :: a
      real(dp) :: q1, q2, q3, q4, t1, t2, t3, t4, d1, d2, d3, d4, e
      integer :: l, b, k
      do b = 1, a%parts
         k = (b - 1)*d_width
         associate (y => a%y(:, :, b), q => a%q(:, :, b), p => a%p(:, b), left => a%left(:, b))
            !GCC$ ivdep
            do l = 1, d_width
               y(l, 1) = y(l, 1) + (real(dw(k + l, 1), dp)*p(l))*moments(1)
               y(l, 2) = y(l, 2) + (real(dw(k + l, 2), dp)*p(l))*moments(2)
               y(l, 3) = y(l, 3) + (real(dw(k + l, 3), dp)*p(l))*moments(3)
               t1 = turn(k + l, 1); t2 = turn(k + l, 2); t3 = turn(k + l, 3); t4 = turn(k + l, 4)
               q1 = q(l, 1); q2 = q(l, 2); q3 = q(l, 3); q4 = q(l, 4)
               d1 = q1 + q1*t1; d2 = q2 + q2*t1; d3 = q3 + q3*t1; d4 = q4 + q4*t1
               d1 = d1 - q2*t2; d2 = d2 + q1*t2; d3 = d3 + q1*t3; d4 = d4 + q1*t4
               d1 = d1 - q3*t3; d2 = d2 + q3*t4; d3 = d3 + q4*t2; d4 = d4 + q2*t3
               d1 = d1 - q4*t4; d2 = d2 - q4*t3; d3 = d3 - q2*t4; d4 = d4 - q3*t2
               e = 1 - d1*d1
               e = e - d2*d2
               e = e - d3*d3
               e = e - d4*d4
               e = e*(0.5_dp + e*(0.375_dp + e*(0.3125_dp + e*(0.2734375_dp + e*0.24609375_dp))))
               q(l, 1) = d1 + d1*e
               q(l, 2) = d2 + d2*e
               q(l, 3) = d3 + d3*e
               q(l, 4) = d4 + d4*e
               left(l) = left(l) - a%h(l, b)
            end do
         end associate
      end do
   end subroutine add_single

   !> Compensated sums; |q| is drawn to 1 through its carry.
   pure subroutine add(moments, dw, turn, a)
      real(dp), intent(in) :: moments(3)
      real(dp), intent(in) :: dw(d_width, 3, parts)      !! of scaled angular velocities
      real(dp), intent(in) :: turn(d_width, 4, parts)    !! less 1
      type(lane_state), intent(inout) :: a
      real(dp) :: s, c, e, d(d_width, 4)
      integer :: i, l, b
      do b = 1, a%parts
         do i = 1, 3
            !GCC$ ivdep
            do l = 1, d_width
               c = (dw(l, i, b)*a%p(l, b))*moments(i) + a%y_carry(l, i, b)
               s = a%y(l, i, b) + c
               a%y_carry(l, i, b) = c - (s - a%y(l, i, b))
               a%y(l, i, b) = s
            end do
         end do
         associate (q => a%q(:, :, b), carry => a%q_carry(:, :, b), t => turn(:, :, b))
            !GCC$ ivdep
            do l = 1, d_width
               d(l, 1) = q(l, 1)*t(l, 1) - (q(l, 2)*t(l, 2) + q(l, 3)*t(l, 3) + q(l, 4)*t(l, 4))
               d(l, 2) = q(l, 2)*t(l, 1) + (q(l, 1)*t(l, 2) + (q(l, 3)*t(l, 4) - q(l, 4)*t(l, 3)))
               d(l, 3) = q(l, 3)*t(l, 1) + (q(l, 1)*t(l, 3) + (q(l, 4)*t(l, 2) - q(l, 2)*t(l, 4)))
               d(l, 4) = q(l, 4)*t(l, 1) + (q(l, 1)*t(l, 4) + (q(l, 2)*t(l, 3) - q(l, 3)*t(l, 2)))
            end do
            do i = 1, 4
               !GCC$ ivdep
               do l = 1, d_width
                  c = d(l, i) + carry(l, i)
                  s = q(l, i) + c
                  carry(l, i) = c - (s - q(l, i))
                  q(l, i) = s
               end do
            end do
            !GCC$ ivdep
            do l = 1, d_width
               e = 1 - q(l, 1)*q(l, 1)
               e = e - q(l, 2)*q(l, 2)
               e = e - q(l, 3)*q(l, 3)
               e = e - q(l, 4)*q(l, 4)
               ! carries are of single precision where all increments are: their squares count
               s = (q(l, 1) + q(l, 1) + carry(l, 1))*carry(l, 1) &
                  + (q(l, 2) + q(l, 2) + carry(l, 2))*carry(l, 2) &
                  + (q(l, 3) + q(l, 3) + carry(l, 3))*carry(l, 3) &
                  + (q(l, 4) + q(l, 4) + carry(l, 4))*carry(l, 4)
               e = e - s
               e = e*(0.5_dp + e*(0.375_dp + e*(0.3125_dp + e*(0.2734375_dp + e*0.24609375_dp))))
               carry(l, 1) = carry(l, 1) + e*(q(l, 1) + carry(l, 1))
               carry(l, 2) = carry(l, 2) + e*(q(l, 2) + carry(l, 2))
               carry(l, 3) = carry(l, 3) + e*(q(l, 3) + carry(l, 3))
               carry(l, 4) = carry(l, 4) + e*(q(l, 4) + carry(l, 4))
            end do
         end associate
         !GCC$ ivdep
         do l = 1, d_width
            a%left(l, b) = a%left(l, b) - a%h(l, b)
         end do
      end do
   end subroutine add

   !> Does a rate need a look? Bits of positive numbers compare like the numbers, and a loop over
   !> them makes a vector of it.
   pure logical function any_fast(p)
      real(dp), intent(in) :: p(width)
      integer(i8) :: most
      integer :: l
      most = 0
      do l = 1, width
         most = max(most, transfer(p(l), 1_i8))
      end do
      any_fast = most >= transfer(fastest, 1_i8)
   end function any_fast

   !> Has a lane more parts left than can be counted?
   pure logical function any_many(parts_left)
      real(sp), intent(in) :: parts_left(width)
      integer(i4) :: most
      integer :: l
      most = 0
      do l = 1, width
         most = max(most, transfer(parts_left(l), 1_i4))
      end do
      any_many = most > transfer(most_parts, 1_i4)
   end function any_many

   !> Is any number above zero, or a positive zero?
   pure logical function any_positive(x)
      real(dp), intent(in) :: x(width)
      integer(i8) :: signs
      integer :: l
      signs = -1
      do l = 1, width
         signs = iand(signs, transfer(x(l), 1_i8))
      end do
      any_positive = signs >= 0
   end function any_positive

   !> The same in single precision.
   pure logical function any_positive_single(x) result(found)
      real(sp), intent(in) :: x(width)
      integer(i4) :: signs
      integer :: l
      signs = -1
      do l = 1, width
         signs = iand(signs, transfer(x(l), 1_i4))
      end do
      found = signs >= 0
   end function any_positive_single

   !> Lanes whose step h is done, idle ones among them.
   pure integer function count_done(left) result(number)
      real(dp), intent(in) :: left(width)
      integer :: l
      number = 0
      do l = 1, width
         number = number + merge(1, 0, iand(transfer(left(l), 1_i8), huge(1_i8)) == 0)
      end do
   end function count_done

   !> Lanes at the end of a step h: begin the next one, or store the body and leave the lane idle.
   subroutine finish(problem, time, keep, n, y, q, carry, status, a)
      type(taylor_problem), intent(in) :: problem
      type(taylor_time), intent(in) :: time
      logical, intent(in) :: keep
      integer, intent(in) :: n
      real(dp), intent(inout) :: y(3, n), q(4, n), carry(7, merge(n, 0, keep))
      integer, intent(inout) :: status(n)
      type(lane_state), intent(inout) :: a
      integer :: b, l, i
      do b = 1, parts
         do l = 1, d_width
            i = a%body(l, b)
            if (i == 0 .or. abs(a%left(l, b)) > 0) cycle
            call absorb_carry(a%y(l, :, b), a%y_carry(l, :, b))
            call absorb_carry(a%q(l, :, b), a%q_carry(l, :, b))
            if (.not. keep) then
               a%y_carry(l, :, b) = 0
               a%q_carry(l, :, b) = 0
            end if
            a%step(l, b) = a%step(l, b) + 1
            a%left(l, b) = time%h
            if (any(abs(a%y(l, :, b)) > problem%limit)) then
               if (status(i) == poinsot_ok) status(i) = poinsot_e_domain
            end if
            if (status(i) == poinsot_ok .and. a%step(l, b) < time%first + time%steps) cycle
            if (status(i) == poinsot_ok) then
               y(:, i) = a%y(l, :, b)
               q(:, i) = a%q(l, :, b)
               if (keep) carry(:, i) = [a%y_carry(l, :, b), a%q_carry(l, :, b)]
            end if
            call idle(l, b, a)
         end do
      end do
   end subroutine finish

   !> A carry of more than rounding goes into its number.
   elemental subroutine absorb_carry(x, carry)
      real(dp), intent(inout) :: x, carry
      real(dp) :: s
      s = x + carry
      carry = carry - (s - x)
      x = s
   end subroutine absorb_carry

   !> A lane at rest, which can do no harm.
   pure subroutine idle(l, b, a)
      integer, intent(in) :: l, b
      type(lane_state), intent(inout) :: a
      a%body(l, b) = 0
      a%live = a%live - 1
      a%y(l, :, b) = 0
      a%y_carry(l, :, b) = 0
      a%q(l, :, b) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
      a%q_carry(l, :, b) = 0
      a%left(l, b) = 0
   end subroutine idle

   !> Idle lanes take the next bodies. A quaternion that is off by more than rounding is drawn to
   !> length 1.
   subroutine refill(problem, time, keep, n, y, q, carry, status, a)
      type(taylor_problem), intent(in) :: problem
      type(taylor_time), intent(in) :: time
      logical, intent(in) :: keep
      integer, intent(in) :: n
      real(dp), intent(in) :: y(3, n), q(4, n), carry(7, merge(n, 0, keep))
      integer, intent(inout) :: status(n)
      type(lane_state), intent(inout) :: a
      real(dp) :: s
      integer :: b, l
      do b = 1, parts
         do l = 1, d_width
            if (a%body(l, b) > 0) cycle
            do while (a%next <= n)
               if (status(a%next) == poinsot_ok .and. problem%too_strong) then
                  status(a%next) = poinsot_e_domain
               end if
               if (status(a%next) == poinsot_ok) exit
               a%next = a%next + 1
            end do
            if (a%next > n) cycle
            a%body(l, b) = a%next
            a%y(l, :, b) = y(:, a%next)
            a%q(l, :, b) = q(:, a%next)
            s = sum(a%q(l, :, b)**2)
            if (abs(s - 1) > 1e-14_dp) then
               a%q(l, :, b) = a%q(l, :, b)/sqrt(s)
            end if
            a%y_carry(l, :, b) = 0
            a%q_carry(l, :, b) = 0
            if (keep) then
               a%y_carry(l, :, b) = carry(1:3, a%next)
               a%q_carry(l, :, b) = carry(4:7, a%next)
            end if
            a%step(l, b) = time%first
            a%left(l, b) = time%h
            a%next = a%next + 1
            a%live = a%live + 1
         end do
      end do
      a%parts = 1
      do b = 2, parts
         if (any(a%body(:, b) > 0)) a%parts = b
      end do
   end subroutine refill

   !> Bodies that have become faster than any may be.
   subroutine refuse_fast(problem, a, status)
      type(taylor_problem), intent(in) :: problem
      type(lane_state), intent(inout) :: a
      integer, intent(inout) :: status(:)
      integer :: b, l
      do b = 1, parts
         do l = 1, d_width
            if (a%body(l, b) == 0) cycle
            if (all(abs(a%y(l, :, b)) <= problem%limit)) cycle
            if (status(a%body(l, b)) == poinsot_ok) status(a%body(l, b)) = poinsot_e_domain
            call stop_lane(l, b, a)
         end do
      end do
   end subroutine refuse_fast

   !> Bodies whose step h has more parts than can be counted.
   subroutine refuse_long(parts_left, a, status)
      real(sp), intent(inout) :: parts_left(width)
      type(lane_state), intent(inout) :: a
      integer, intent(inout) :: status(:)
      integer :: b, l
      do b = 1, parts
         do l = 1, d_width
            if (.not. parts_left(l + (b - 1)*d_width) > most_parts) cycle
            if (a%body(l, b) > 0) then
               if (status(a%body(l, b)) == poinsot_ok) status(a%body(l, b)) = poinsot_e_step
               call stop_lane(l, b, a)
            end if
            a%reach(l, b) = 0
         end do
      end do
   end subroutine refuse_long

   !> This substep is the last of its body, over no time.
   pure subroutine stop_lane(l, b, a)
      integer, intent(in) :: l, b
      type(lane_state), intent(inout) :: a
      a%left(l, b) = 0
      a%reach(l, b) = 0
   end subroutine stop_lane

   !> Room for all that goes beyond arms in one direction.
   subroutine open_extras(problem, xd, xs)
      type(taylor_problem), intent(in) :: problem
      type(d_extras), intent(inout) :: xd(parts)
      type(s_extras), intent(inout) :: xs
      integer :: b, i, n, f, waves, tables
      n = problem%directions
      f = problem%fixed
      waves = size(problem%frequency)
      tables = count(problem%table%in_space)
      do b = 1, parts
         associate (x => xd(b))
            x%directions = n; x%fixed = f; x%waves = waves; x%tables = tables
            allocate (x%has_linear(n), x%has_quadratic(n), x%has_product(n), x%turning(n))
            allocate (x%z(d_width, 3, 0:last_double, n), x%o(d_width, 3, 0:last_double, n), &
               x%axis(d_width, f, n), x%linear(d_width, 3, 3, n), x%difference(d_width, 3, n), &
               x%product(d_width, 3, 3, n), x%cosine(d_width, 0:last_double, waves), &
               x%v(d_width, 3, 0:last_double, waves), x%harmonic(d_width, 3, 3, f, waves), &
               x%harmonic_body(d_width, 3, waves), x%along(d_width, f, 0:1, tables), &
               x%inverse(d_width, 3, tables), source=0.0_dp)
            do i = 1, n
               x%has_linear(i) = has_linear(problem, i)
               x%has_product(i) = any(abs(problem%product(:, :, i)) > 0)
               x%has_quadratic(i) = x%has_product(i) .or. any(abs(problem%difference(:, i)) > 0)
               x%turning(i) = .false.
               if (i > f) x%turning(i) = abs(problem%other(i - f)%rate) > 0
            end do
         end associate
      end do
      xs%directions = n; xs%fixed = f; xs%waves = waves; xs%tables = tables
      xs%has_linear = xd(1)%has_linear
      xs%has_quadratic = xd(1)%has_quadratic
      xs%has_product = xd(1)%has_product
      xs%turning = xd(1)%turning
      allocate (xs%z(width, 3, 0:last_order, n), xs%o(width, 3, 0:last_order, n), &
         xs%axis(width, f, n), xs%linear(width, 3, 3, n), xs%difference(width, 3, n), &
         xs%product(width, 3, 3, n), xs%cosine(width, 0:last_order, waves), &
         xs%v(width, 3, 0:last_order, waves), xs%harmonic(width, 3, 3, f, waves), &
         xs%harmonic_body(width, 3, waves), xs%along(width, f, 0:1, tables), &
         xs%inverse(width, 3, tables), source=0.0_sp)
   end subroutine open_extras

   !> Beside the arms of the first direction, which the series take by themselves.
   pure logical function has_linear(problem, i)
      type(taylor_problem), intent(in) :: problem
      integer, intent(in) :: i
      integer :: j
      if (i > 1) then
         has_linear = any(abs(problem%linear(:, :, i)) > 0)
      else
         has_linear = any([(abs(problem%linear(j, j, 1)) > 0, j=1, 3)])
      end if
   end function has_linear

   !> Coefficients in the scaled time of every lane, and what depends on its time.
   subroutine fill_extras(problem, time, a, xd, xs)
      type(taylor_problem), intent(in) :: problem
      type(taylor_time), intent(in) :: time
      type(lane_state), intent(inout) :: a
      type(d_extras), intent(inout) :: xd(parts)
      type(s_extras), intent(inout) :: xs
      real(dp) :: u, s, now
      real(dp) :: rate(d_width), cosine(d_width, size(problem%frequency)), &
         sine(d_width, size(problem%frequency))
      integer :: b, l, i, j, k
      do b = 1, parts
         associate (x => xd(b))
            do l = 1, d_width
               u = 1/a%p(l, b)
               s = (problem%unit*u)**2
               x%spin(l, :, :) = problem%spin*u
               x%constant(l, :) = problem%body*s
               x%slope(l, :) = 0
               do i = 1, problem%directions
                  x%linear(l, :, :, i) = problem%linear(:, :, i)*s
                  x%difference(l, :, i) = problem%difference(:, i)*s
                  x%product(l, :, :, i) = problem%product(:, :, i)*s
               end do
               do j = 2, 3
                  do k = 1, 3
                     if (j /= k) x%linear(l, k, j, 1) = 0
                     if (j /= k) x%linear(l, j, k, 1) = 0
                  end do
               end do
               do i = problem%fixed + 1, problem%directions
                  associate (other => problem%other(i - problem%fixed))
                     x%axis(l, :, i) = problem%axis(:problem%fixed, i - problem%fixed)* &
                        (other%rate*u)
                  end associate
               end do
               do i = 1, size(problem%frequency)
                  x%harmonic(l, :, :, :, i) = problem%harmonic(:, :, :, i)*s
                  x%harmonic_body(l, :, i) = problem%harmonic_body(:, i)*s
               end do
               now = time%t + real(a%step(l, b), dp)*time%h
               if (a%body(l, b) > 0) now = now + (time%h - a%left(l, b))
               call see_phases(problem, now, cosine(l, :), sine(l, :))
               call fill_tables(problem, now, time%h > 0, s, u, l, a%left(l, b), a%reach(l, b), x)
               call see_others(problem, now, a%q(l, :, b), l, x)
            end do
            do i = 1, size(problem%frequency)
               rate = problem%frequency(i)/a%p(:, b)
               call d_fill_cosine(last_double, rate, cosine(:, i), sine(:, i), x%cosine(:, :, i))
               k = (b - 1)*d_width
               call cosine_to_single(k, rate, cosine(:, i), sine(:, i), xs%cosine(:, :, i))
            end do
         end associate
      end do
      call constants_to_single(xd, xs)
   end subroutine fill_extras

   !> Tables at one time, and the next knot.
   subroutine fill_tables(problem, now, forwards, s, u, l, left, reach, x)
      type(taylor_problem), intent(in) :: problem
      real(dp), intent(in) :: now
      logical, intent(in) :: forwards
      real(dp), intent(in) :: s, u                !! scales of torque and time
      integer, intent(in) :: l
      real(dp), intent(in) :: left
      real(dp), intent(inout) :: reach
      type(d_extras), intent(inout) :: x
      real(dp) :: value(3), slope(3), farthest, slack
      integer :: i, number
      if (size(problem%table) == 0) return
      slack = 8*epsilon(1.0_dp)*max(abs(now), abs(left))
      farthest = huge(1.0_dp)
      number = 0
      do i = 1, size(problem%table)
         call place_in_table(problem%table(i), now, forwards, slack, value, slope, farthest)
         if (problem%table(i)%in_space) then
            number = number + 1
            x%along(l, :, 0, number) = value(:problem%fixed)
            x%along(l, :, 1, number) = slope(:problem%fixed)*u
            x%inverse(l, :, number) = problem%table_inverse(:, i)*s
         else
            x%constant(l, :) = x%constant(l, :) + value*s
            x%slope(l, :) = x%slope(l, :) + slope*(s*u)
         end if
      end do
      if (farthest < abs(reach) - slack) reach = sign(farthest, reach)
   end subroutine fill_tables

   !> Directions beside the first two as the body sees them at one time.
   subroutine see_others(problem, now, q, l, x)
      type(taylor_problem), intent(in) :: problem
      real(dp), intent(in) :: now, q(4)
      integer, intent(in) :: l
      type(d_extras), intent(inout) :: x
      real(dp) :: e(3), s, f
      integer :: i
      if (problem%directions <= min(problem%fixed, 2)) return
      f = 2 - sum(q*q)
      do i = min(problem%fixed, 2) + 1, problem%directions
         if (i <= problem%fixed) then
            e = problem%basis(:, i)
         else
            associate (other => problem%other(i - problem%fixed))
               e = turned(other%at, other%axis, other%rate*now + other%phase)
            end associate
         end if
         s = q(1)*q(1) - sum(q(2:4)**2)
         x%z(l, :, 0, i) = f*(s*e + 2*dot_product(q(2:4), e)*q(2:4) + 2*q(1)*cross(e, q(2:4)))
      end do
   end subroutine see_others

   subroutine cosine_to_single(k, rate, cosine, sine, series)
      integer, intent(in) :: k                      !! lanes before these
      real(dp), intent(in) :: rate(d_width), cosine(d_width), sine(d_width)
      real(sp), intent(inout) :: series(width, 0:last_order)
      real(sp) :: r(width), c(width), s(width), all(width, 0:last_order)
      r = 0; c = 0; s = 0
      r(:d_width) = real(rate, sp)
      c(:d_width) = real(cosine, sp)
      s(:d_width) = real(sine, sp)
      call s_fill_cosine(last_order, r, c, s, all)
      series(k + 1:k + d_width, :) = all(:d_width, :)
   end subroutine cosine_to_single

   subroutine constants_to_single(xd, xs)
      type(d_extras), intent(in) :: xd(parts)
      type(s_extras), intent(inout) :: xs
      integer :: b, k
      do b = 1, parts
         k = (b - 1)*d_width
         associate (x => xd(b))
            xs%spin(k + 1:k + d_width, :, :) = real(x%spin, sp)
            xs%constant(k + 1:k + d_width, :) = real(x%constant, sp)
            xs%slope(k + 1:k + d_width, :) = real(x%slope, sp)
            xs%axis(k + 1:k + d_width, :, :) = real(x%axis, sp)
            xs%linear(k + 1:k + d_width, :, :, :) = real(x%linear, sp)
            xs%difference(k + 1:k + d_width, :, :) = real(x%difference, sp)
            xs%product(k + 1:k + d_width, :, :, :) = real(x%product, sp)
            xs%harmonic(k + 1:k + d_width, :, :, :, :) = real(x%harmonic, sp)
            xs%harmonic_body(k + 1:k + d_width, :, :) = real(x%harmonic_body, sp)
            xs%along(k + 1:k + d_width, :, :, :) = real(x%along, sp)
            xs%inverse(k + 1:k + d_width, :, :) = real(x%inverse, sp)
         end associate
      end do
   end subroutine constants_to_single

   !> Series of the extras up to order k.
   subroutine extras_to_single(last, xd, xs)
      integer, intent(in) :: last
      type(d_extras), intent(in) :: xd(parts)
      type(s_extras), intent(inout) :: xs
      integer :: b, k, i
      do b = 1, parts
         k = (b - 1)*d_width
         do i = 1, xs%directions
            xs%z(k + 1:k + d_width, :, :last, i) = real(xd(b)%z(:, :, :last, i), sp)
            if (xs%turning(i)) xs%o(k + 1:k + d_width, :, :last, i) = &
               real(xd(b)%o(:, :, :last, i), sp)
         end do
         do i = 1, xs%waves
            xs%v(k + 1:k + d_width, :, :last, i) = real(xd(b)%v(:, :, :last, i), sp)
         end do
      end do
   end subroutine extras_to_single

end module poinsot_taylor_lanes
