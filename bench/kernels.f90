!> What kernels alone cost, in FMA slots: the time of one fused multiply-add of 8 doubles, a unit in
!> which processors of one kind agree. One block in the first-level cache, minimum of many runs.
module bench_kernels
   use poinsot_core_kinds, only: dp, i8, group, groups, lanes
   use poinsot_core_error, only: poinsot_error
   use poinsot_core_status, only: poinsot_ok
   use poinsot_body_class, only: body_class, make_class
   use poinsot_free_exact_lanes, only: lane_constants, make_lane_constants, advance_each
   use poinsot_free_method, only: free_method, find_method, advance
   implicit none(type, external)
   private
   public :: fma_time, kernel_table

   integer, parameter :: repetitions = 300, steps = 50
   real(dp), parameter :: moments(3) = [0.376_dp, 0.627_dp, 1.0_dp] !! the body of the review

contains

   !> Nanoseconds of one fused multiply-add of 8 doubles: 16 chains of them, which do not wait for
   !> each other.
   real(dp) function fma_time()
      integer, parameter :: chains = 16, links = 2000
      real(dp) :: x(group, chains)
      integer(i8) :: start
      integer :: i, j, k
      fma_time = huge(fma_time)
      x = 1
      do k = 1, repetitions
         call system_clock(start)
         do j = 1, links
            do i = 1, chains
               x(:, i) = x(:, i)*(1 - 1e-9_dp) + 1e-12_dp
            end do
         end do
         fma_time = min(fma_time, since(start)/(chains*links))
      end do
      if (sum(x) < 0) fma_time = 0
   end function fma_time

   !> Nanoseconds since a reading of the clock.
   real(dp) function since(start)
      integer(i8), intent(in) :: start
      integer(i8) :: finish, rate
      call system_clock(finish, rate)
      since = 1e9_dp*real(finish - start, dp)/real(rate, dp)
   end function since

   !> The table: ns and slots of a body (of 8), or of what is made.
   subroutine kernel_table(y0, q0)
      real(dp), intent(in) :: y0(3, lanes), q0(4, lanes) !! states
      real(dp) :: slot
      slot = fma_time()
      print "(/, a, f7.4, a, /)", "7. kernels in one block; one FMA of 8 doubles takes", slot, &
         " ns here: a slot, an eighth of which is a body's share"
      print "(a)", "                                             |       ns    slots   meant"
      call by_method("exact, h|omega| <= 0.1", "exact", 0.1_dp, groups, .false., "<= 180")
      call by_method("exact, h|omega| <= 0.5", "exact", 0.5_dp, groups, .false., "<= 250")
      call by_method("exact, some near, some far", "exact", 0.2_dp, groups, .false., "-")
      call by_method("exact, compensated sums", "exact", 0.1_dp, groups, .true., "-")
      call by_method("exact, 8 lanes only", "exact", 0.1_dp, 1, .false., "-")
      call by_method("jacobi", "jacobi", 0.1_dp, groups, .false., "-")
      call by_method("dmv10", "dmv10", 0.1_dp, groups, .false., "-")
      call by_lane("moments for each body, constants kept", .false., .true., "<= 235 (8 ns)")
      call by_lane("moments for each body, made anew", .true., .true., "<= 640 (22 ns)")
      call by_lane("their constants alone", .true., .false., "<= 380 (13 ns)")
      call classes()

   contains

      subroutine by_method(what, name, phase, nvec, compensated, meant)
         character(*), intent(in) :: what, name, meant
         real(dp), intent(in) :: phase
         integer, intent(in) :: nvec
         logical, intent(in) :: compensated
         type(body_class) :: class
         type(free_method) :: method
         type(poinsot_error) :: error
         real(dp) :: y(lanes, 3), q(lanes, 4), carry(lanes, 7), h, best
         integer :: status(lanes), i, k
         integer(i8) :: start
         call make_class(moments, class, error)
         call find_method(name, method, error)
         h = phase*minval(moments)
         best = huge(best)
         do k = 1, repetitions
            y = transpose(y0)
            q = transpose(q0)
            carry = 0
            status = poinsot_ok
            call system_clock(start)
            if (compensated) then
               do i = 1, steps
                  call advance(method, class, h, y, q, status, carry, nvec)
               end do
            else
               do i = 1, steps
                  call advance(method, class, h, y, q, status, nvec=nvec)
               end do
            end if
            best = min(best, since(start)/(steps*group*nvec))
         end do
         call row(what, best, meant)
      end subroutine by_method

      subroutine by_lane(what, anew, turns, meant)
         character(*), intent(in) :: what, meant
         logical, intent(in) :: anew, turns
         type(lane_constants) :: c
         real(dp) :: y(lanes, 3), q(lanes, 4), m(lanes, 3), h(lanes), best
         integer :: status(lanes), i, k
         integer(i8) :: start
         do i = 1, lanes
            m(i, :) = moments*(1 + 1e-3_dp*i*[1, 2, -1])
         end do
         h = 0.1_dp*minval(moments)
         status = poinsot_ok
         call make_lane_constants(m, groups, c, status)
         best = huge(best)
         do k = 1, repetitions
            y = transpose(y0)
            q = transpose(q0)
            call system_clock(start)
            if (.not. anew) call advance_each(c, .false., h, steps, y, q, status, groups)
            do i = 1, merge(steps, 0, anew)
               call make_lane_constants(m, groups, c, status)
               if (turns) call advance_each(c, .false., h, 1, y, q, status, groups)
            end do
            best = min(best, since(start)/(steps*lanes))
         end do
         call row(what, best, meant)
      end subroutine by_lane

      subroutine classes()
         type(body_class) :: class
         type(poinsot_error) :: error
         real(dp) :: best
         integer :: i, k
         integer(i8) :: start
         best = huge(best)
         do k = 1, repetitions
            call system_clock(start)
            do i = 1, steps
               call make_class(moments*(1 + 1e-6_dp*i), class, error)
            end do
            best = min(best, since(start)/steps)
         end do
         print "(3x, a42, '|', f9.0, 9x, 3x, a, i0, a)", "a body class made", best, &
            "<= 6000; takes ", storage_size(class)/8, " bytes (<= 1200)"
      end subroutine classes

      subroutine row(what, ns, meant)
         character(*), intent(in) :: what, meant
         real(dp), intent(in) :: ns
         print "(3x, a42, '|', f9.2, f9.0, 3x, a)", what, ns, ns*group/slot, meant
      end subroutine row

   end subroutine kernel_table

end module bench_kernels
