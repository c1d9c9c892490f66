!> The table of `make bench`: what a step of every method costs and how wrong it is, beside what
!> other codes do, in one run.
!>
!> usage: bench [--quick] FOLDER         FOLDER gets times.csv and errors.csv
program bench
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error
   use poinsot_body_class, only: body_class, make_class
   use poinsot_effect_registry, only: effect_count, effect_name
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_free_method, only: free_method, find_method, method_names
   use bench_kernels, only: kernel_table
   use bench_effect_plans, only: make_plan, add_any_effect, finish_plan
   use bench_measure, only: task_item, measure, clock_rate, median, minimum, spread_of, &
      median_cpu
   use bench_tasks, only: free_task, plan_task, rival_task, random_bodies, attach
   use bench_yardsticks, only: yardstick, yardsticks, reference
   implicit none(type, external)

   real(dp), parameter :: moments(3) = [0.376_dp, 0.627_dp, 1.0_dp] !! the body of the review
   real(dp), parameter :: t_end = 10                !! time at which errors are taken
   ! up to t_end: h |omega| <= 0.1, 0.2, 0.27 (h = 0.1), 0.5
   integer, parameter :: run_steps(4) = [266, 133, 100, 54]
   integer, parameter :: timed(3) = [1, 2, 4]       !! which of them are timed
   ! bodies whose state stays in the first-level cache
   integer, parameter :: in_cache = 512
   integer, parameter :: many = 100                 !! "many steps per call"
   type(body_class) :: class
   type(poinsot_error) :: error
   type(yardstick) :: rivals(7)
   ! errors: methods then rivals; steps of run_steps
   real(dp), allocatable :: wrong(:, :)
   real(dp), allocatable :: fast(:, :)              !! medians of the first table, the same way
   real(dp) :: from_memory(5)                       !! medians of `exact`, one layout each
   real(dp) :: thread_gain(2)                       !! of `exact`: wall, processor time
   real(dp) :: seconds                              !! for each table
   logical :: quick
   character(256) :: folder
   integer :: times, errors, methods

   call read_arguments()
   call make_class(moments, class, error)
   rivals = yardsticks()
   methods = size(method_names)
   open (newunit=times, file=trim(folder)//"/times.csv", action="write")
   write (times, "(a)") "section,name,order,layout,bodies,steps_per_call,threads,h_omega,"// &
      "ns_median,ns_minimum,spread"
   open (newunit=errors, file=trim(folder)//"/errors.csv", action="write")
   write (errors, "(a)") "name,order,h,h_omega,attitude_error_largest,attitude_error_median"
   print "(a, f5.2, a)", "clock in use: about ", clock_rate(6364136223846793005_i8, &
      int(command_argument_count(), i8)), " GHz"
   call error_table()
   call step_table()
   call memory_table()
   call single_table()
   call effect_table()
   call thread_table()
   call verdict()
   call kernels()
   close (times)
   close (errors)

contains

   subroutine read_arguments()
      integer :: i
      quick = .false.
      folder = "."
      do i = 1, command_argument_count()
         call get_command_argument(i, folder)
         if (folder == "--quick") quick = .true.
      end do
      seconds = merge(1.5_dp, 10.0_dp, quick)
   end subroutine read_arguments

   real(dp) function step_of(k)
      integer, intent(in) :: k
      step_of = t_end/run_steps(k)
   end function step_of

   real(dp) function phase_of(k)
      integer, intent(in) :: k
      phase_of = step_of(k)/minval(moments)
   end function phase_of

   ! ---- errors -----------------------------------------------------------------------------------

   !> Attitude at t_end of everybody, against Taylor series in quadruple precision.
   subroutine error_table()
      real(dp), allocatable, target :: y0(:, :), q0(:, :), ye(:, :), qe(:, :), y(:, :), q(:, :)
      real(dp), allocatable :: off(:)
      type(free_task) :: one
      integer :: i, k, n
      n = merge(8, 32, quick)
      allocate (y0(3, n), q0(4, n), off(n), wrong(methods + size(rivals), size(run_steps)))
      call random_bodies(y0, q0)
      allocate (ye, source=y0)
      allocate (qe, source=q0)
      do i = 1, n
         call reference(moments, t_end, ye(:, i), qe(:, i))
      end do
      allocate (y, source=y0)
      allocate (q, source=q0)
      call attach(one, y, q, .false.)
      one%class = class
      do i = 1, methods + size(rivals)
         do k = 1, size(run_steps)
            y = y0
            q = q0
            one%h = step_of(k)
            one%steps = run_steps(k)
            if (i <= methods) then
               call find_method(trim(method_names(i)), one%method, error)
               call one%run()
            else
               call rivals(i - methods)%run(moments, one%h, one%steps, y, q)
               one%failed = .false.
            end if
            off = min(norm2(q - qe, 1), norm2(q + qe, 1))
            wrong(i, k) = maxval(off)
            if (one%failed) wrong(i, k) = -1
            if (one%failed) cycle
            write (errors, "(a, ',', i0, 4(',', es11.4))") trim(name_of(i)), order_of(i), &
               step_of(k), &
               phase_of(k), maxval(off), middle(off)
         end do
      end do
   end subroutine error_table

   real(dp) function middle(x)
      real(dp), intent(in) :: x(:)
      integer :: i
      do i = 1, size(x)
         middle = x(i)
         if (count(x <= x(i)) >= (size(x) + 1)/2 .and. count(x < x(i)) <= size(x)/2) return
      end do
   end function middle

   function name_of(i) result(name)
      integer, intent(in) :: i
      character(20) :: name
      if (i <= methods) name = method_names(i)
      if (i > methods) name = rivals(i - methods)%name
   end function name_of

   integer function order_of(i)
      integer, intent(in) :: i
      type(free_method) :: method
      if (i <= methods) then
         call find_method(trim(method_names(i)), method, error)
         order_of = method%order
      else
         order_of = rivals(i - methods)%order
      end if
   end function order_of

   ! ---- tasks ------------------------------------------------------------------------------------

   !> A task for method or rival i.
   subroutine new_task(i, h, item, section, layout, steps, threads)
      integer, intent(in) :: i, steps, threads
      real(dp), intent(in) :: h
      character(*), intent(in) :: section, layout
      type(task_item), intent(out) :: item
      type(free_task), allocatable :: one
      type(rival_task), allocatable :: other
      if (i <= methods) then
         allocate (one)
         one%class = class
         one%h = h
         call find_method(trim(method_names(i)), one%method, error)
         call move_alloc(one, item%it)
      else
         allocate (other)
         other%moments = moments
         other%h = h
         other%rival = rivals(i - methods)
         call move_alloc(other, item%it)
      end if
      item%it%name = name_of(i)
      item%it%order = order_of(i)
      item%it%section = section
      item%it%layout = layout
      item%it%steps = steps
      item%it%threads = threads
      item%it%phase = h/minval(moments)
   end subroutine new_task

   !> Bodies for a task of any type.
   subroutine give(item, y, q, own)
      type(task_item), intent(inout) :: item
      real(dp), intent(in), target :: y(:, :), q(:, :)
      logical, intent(in) :: own
      select type (one => item%it)
      type is (free_task)
         call attach(one, y, q, own)
      type is (plan_task)
         call attach(one, y, q, own)
      type is (rival_task)
         call attach(one, y, q, own)
      end select
   end subroutine give

   subroutine record(tasks)
      type(task_item), intent(in) :: tasks(:)
      integer :: i
      do i = 1, size(tasks)
         associate (one => tasks(i)%it)
            if (one%failed) cycle
            write (times, "(a, ',', a, ',', i0, ',', a, 3(',', i0), 4(',', f0.4))") &
               trim(one%section), &
               trim(one%name), one%order, trim(one%layout), one%n, one%steps, one%threads, &
                  one%phase, &
               median(one), minimum(one), spread_of(one)
         end associate
      end do
   end subroutine record

   !> "median (minimum)"
   function shown(item) result(text)
      type(task_item), intent(in) :: item
      character(20) :: text
      character(16) :: least
      text = "        -"
      if (item%it%failed) return
      write (least, "(f0.2)") minimum(item%it)
      write (text(1:9), "(f9.2)") median(item%it)
      text(10:) = " ("//trim(least)//")"
   end function shown

   function shown_error(x) result(text)
      real(dp), intent(in) :: x
      character(8) :: text
      text = "      - "
      if (x >= 0) write (text, "(es8.1)") x
   end function shown_error

   !> Name and order.
   function head(i) result(text)
      integer, intent(in) :: i
      character(28) :: text
      character(5) :: order
      write (order, "(i5)") order_of(i)
      if (order_of(i) == 0) order = "exact"
      text = name_of(i)//" "//order
   end function head

   ! ---- tables -----------------------------------------------------------------------------------

   subroutine step_table()
      type(task_item), allocatable :: tasks(:)
      real(dp) :: y(3, in_cache), q(4, in_cache)
      integer :: i, j, k, all
      all = methods + size(rivals)
      allocate (tasks(all*size(timed)), fast(all, size(timed)))
      call random_bodies(y, q)
      do i = 1, all
         do j = 1, size(timed)
            k = (i - 1)*size(timed) + j
            call new_task(i, step_of(timed(j)), tasks(k), "in-cache", "rows", many, 1)
            call give(tasks(k), y, q, .true.)
            tasks(k)%it%phase = phase_of(timed(j))
         end do
      end do
      call measure(tasks, merge(5, 25, quick), 3*seconds)
      call record(tasks)
      print "(/, a, i0, a, i0, a)", "1. ns per body-step, median (minimum): ", many, &
         " steps per call, ", in_cache, &
         " bodies, one thread;"
      print "(a)", "   attitude error |q - q'| at T = 10, largest over random |y| = 1"
      print "(/, 26x, 4a)", "  |  h|omega| <= 0.1", "           <= 0.2", "            <= 0.5", &
         "     |  error  0.1      0.2      0.5"
      do i = 1, all
         if (i == methods + 1) print "(a)", "what others do"
         k = (i - 1)*size(timed)
         fast(i, :) = [(median(tasks(k + j)%it), j=1, size(timed))]
         if (tasks(k + 1)%it%failed) fast(i, :) = -1
         print "(a, '|', 3a, ' |  ', 3(a, ' '))", head(i), (shown(tasks(k + j)), j=1, &
            size(timed)), &
            (shown_error(wrong(i, timed(j))), j=1, size(timed))
      end do
   end subroutine step_table

   !> One step per call through memory, the arrays of several hosts.
   subroutine memory_table()
      character(8), parameter :: layouts(5) = [character(8) :: "rows", "columns", "lammps", &
         "dl_poly", "hoomd"]
      character(20), parameter :: brief(4) = [character(20) :: "exact", "dmv2", "dmv6", "dmv10"]
      type(task_item), allocatable :: tasks(:)
      type(poinsot_plan), allocatable, target :: plans(:)
      character(20) :: cells(methods, size(layouts))
      integer :: i, k, n, chosen(methods), count_of
      n = merge(200000, 1000000, quick)
      count_of = 0
      do i = 1, methods
         if (quick .and. .not. any(brief == method_names(i))) cycle
         count_of = count_of + 1
         chosen(count_of) = i
      end do
      do k = 1, size(layouts)
         allocate (plans(count_of), tasks(count_of))
         call layout_tasks(layouts(k), n, chosen(1:count_of), plans, tasks)
         call record(tasks)
         from_memory(k) = median(tasks(1)%it)
         do i = 1, count_of
            cells(i, k) = shown(tasks(i))
         end do
         deallocate (plans, tasks)
      end do
      print "(/, a, i0, a)", "2. ns per body-step, median (minimum): one step per call, ", n, &
         " bodies, one thread, h|omega| <= 0.1"
      print "(/, 28x, '|', *(5x, a8, 7x))", layouts
      do i = 1, count_of
         print "(a, '|', *(a))", head(chosen(i)), cells(i, :)
      end do
   end subroutine memory_table

   !> All methods on arrays of one layout. A plan does it, except for the native rows and columns.
   subroutine layout_tasks(layout, n, chosen, plans, tasks)
      character(*), intent(in) :: layout
      integer, intent(in) :: n, chosen(:)
      type(poinsot_plan), intent(inout), target :: plans(:)
      type(task_item), intent(inout) :: tasks(:)
      real(dp), pointer :: y(:, :), q(:, :)
      type(plan_task), allocatable :: one
      integer :: i
      call layout_bodies(layout, n, y, q)
      do i = 1, size(chosen)
         if (layout == "rows" .or. layout == "columns") then
            call new_task(chosen(i), step_of(1), tasks(i), "from-memory", layout, 1, 1)
         else
            call make_plan(moments, trim(method_names(chosen(i))), layout, plans(i))
            call finish_plan(plans(i))
            allocate (one)
            one%plan => plans(i)
            one%drift = .true.
            one%h = step_of(1)
            one%name = method_names(chosen(i))
            one%order = order_of(chosen(i))
            one%section = "from-memory"
            one%layout = layout
            one%phase = phase_of(1)
            call move_alloc(one, tasks(i)%it)
         end if
         call give(tasks(i), y, q, .false.)
      end do
      call measure(tasks, merge(3, 7, quick), seconds/2)
      deallocate (y, q)
   end subroutine layout_tasks

   !> Bodies as a host keeps them. Which momentum exactly does not matter for the time: sizes are
   !> right.
   subroutine layout_bodies(layout, n, y, q)
      character(*), intent(in) :: layout
      integer, intent(in) :: n
      real(dp), pointer, intent(out) :: y(:, :), q(:, :)
      real(dp), allocatable :: yr(:, :), qr(:, :)
      integer :: i
      allocate (yr(3, n), qr(4, n))
      call random_bodies(yr, qr)
      select case (layout)
      case ("columns", "dl_poly")
         allocate (y(n, 3), q(n, 4))
         y = transpose(yr)
         q = transpose(qr)
         if (layout == "columns") return
         do i = 1, 3
            y(:, i) = y(:, i)/moments(i)
         end do
      case ("hoomd")
         allocate (y(4, n), q(4, n))
         q = qr
         y(1, :) = -2*(q(2, :)*yr(1, :) + q(3, :)*yr(2, :) + q(4, :)*yr(3, :))
         y(2, :) = 2*(q(1, :)*yr(1, :) + q(3, :)*yr(3, :) - q(4, :)*yr(2, :))
         y(3, :) = 2*(q(1, :)*yr(2, :) + q(4, :)*yr(1, :) - q(2, :)*yr(3, :))
         y(4, :) = 2*(q(1, :)*yr(3, :) + q(2, :)*yr(2, :) - q(3, :)*yr(1, :))
      case default
         allocate (y(3, n), q(4, n))
         y = yr
         q = qr
      end select
   end subroutine layout_bodies

   !> A single body: the same code in a block that is otherwise empty.
   subroutine single_table()
      type(task_item), allocatable :: tasks(:)
      real(dp) :: y(3, 1), q(4, 1)
      integer :: i, k, all
      all = methods + size(rivals)
      allocate (tasks(2*all))
      call random_bodies(y, q)
      do i = 1, all
         do k = 1, 2
            call new_task(i, step_of(1), tasks(2*i - 2 + k), "single", "rows", merge(1000, 1, &
               k == 1), 1)
            call give(tasks(2*i - 2 + k), y, q, .true.)
         end do
      end do
      do i = 1, 2*all
         tasks(i)%it%calls = merge(1, 1000, mod(i, 2) == 1)
      end do
      call measure(tasks, merge(7, 31, quick), seconds)
      call record(tasks)
      print "(/, a)", "3. a single body, ns per step, median (minimum), h|omega| <= 0.1"
      print "(/, 28x, '|', 2a)", "  1000 steps/call ", "  1 step per call"
      do i = 1, all
         if (i == methods + 1) print "(a)", "what others do"
         if (index(name_of(i), "vector") > 0) cycle
         print "(a, '|', 2a)", head(i), shown(tasks(2*i - 1)), shown(tasks(2*i))
      end do
   end subroutine single_table

   !> A plan without effects against the bare kernel, and each effect of the registry against that
   !> plan.
   subroutine effect_table()
      type(task_item), allocatable :: tasks(:)
      type(poinsot_plan), allocatable, target :: plans(:)
      type(plan_task), allocatable :: one
      real(dp) :: y(3, in_cache), q(4, in_cache)
      integer :: i
      allocate (tasks(0:effect_count + 1), plans(0:effect_count))
      call random_bodies(y, q)
      call new_task(1, step_of(1), tasks(effect_count + 1), "effect", "rows", many, 1)
      do i = 0, effect_count
         call make_plan(moments, "exact", "native", plans(i))
         if (i > 0) call add_any_effect(plans(i), i)
         call finish_plan(plans(i))
         allocate (one)
         one%plan => plans(i)
         one%h = step_of(1)
         one%section = "effect"
         one%name = "no effect"
         if (i > 0) one%name = effect_name(i)
         one%phase = phase_of(1)
         one%steps = merge(4, many, plans(i)%coupled)
         call move_alloc(one, tasks(i)%it)
      end do
      do i = 0, effect_count + 1
         call give(tasks(i), y, q, .true.)
      end do
      tasks(effect_count + 1)%it%name = "bare kernel"
      call measure(tasks, merge(7, 51, quick), seconds)
      call record(tasks)
      print "(/, a, i0, a)", &
         "4. effects: ns per body-step with `exact` and `strang`, one kick a step, ", in_cache, &
         " bodies, h|omega| <= 0.1"
      print "(/, 28x, '|', 2a)", "             step", "     more than without"
      print "(a28, '|', a)", "bare kernel", shown(tasks(effect_count + 1))
      print "(a28, '|', a, f16.2, '  = ', f6.3, ' of the bare kernel (minima)')", &
         "plan without effects", &
         shown(tasks(0)), median(tasks(0)%it) - median(tasks(effect_count + 1)%it), &
         minimum(tasks(0)%it)/minimum(tasks(effect_count + 1)%it)
      do i = 1, effect_count
         print "(a28, '|', a, f16.2)", effect_name(i), shown(tasks(i)), &
            median(tasks(i)%it) - median(tasks(0)%it)
      end do
   end subroutine effect_table

   !> What a second thread is worth.
   subroutine thread_table()
      integer, parameter :: n = 131072, steps = 20
      character(20), parameter :: brief(5) = [character(20) :: "exact", "jacobi", "dmv2", &
         "dmv10", "three-rotations"]
      type(task_item), allocatable :: tasks(:)
      real(dp), allocatable, target :: y(:, :), q(:, :)
      integer :: i, k, chosen(methods), count_of
      count_of = 0
      do i = 1, methods
         if (.not. any(brief == method_names(i))) cycle
         count_of = count_of + 1
         chosen(count_of) = i
      end do
      allocate (y(3, n), q(4, n), tasks(2*count_of))
      call random_bodies(y, q)
      do i = 1, count_of
         do k = 1, 2
            call new_task(chosen(i), step_of(1), tasks(2*i - 2 + k), "threads", "rows", steps, k)
            call give(tasks(2*i - 2 + k), y, q, .false.)
            tasks(2*i - 2 + k)%it%wall = .true.
         end do
      end do
      call measure(tasks, merge(5, 21, quick), seconds)
      call record(tasks)
      print "(/, a, i0, a, i0, a)", "5. ns per body-step, wall time, median (minimum): ", n, &
         " bodies, ", &
         steps, &
         " steps per call, h|omega| <= 0.1"
      print "(a)", &
         "   (on a busy machine the last column says more: twice the processor time of one "// &
         "over that of two)"
      print "(/, 28x, '|', 5a)", "       one thread   ", "      two threads   ", &
         "   wall: medians", &
         "   minima", "   processor time"
      do i = 1, count_of
         associate (one => tasks(2*i - 1), two => tasks(2*i))
            if (one%it%failed) cycle
            print "(a, '|', 2a, f16.2, f9.2, f17.2)", head(chosen(i)), shown(one), shown(two), &
               median(one%it)/median(two%it), minimum(one%it)/minimum(two%it), &
               2*median_cpu(one%it)/median_cpu(two%it)
            if (chosen(i) == 1) thread_gain = [median(one%it)/median(two%it), &
                                               2*median_cpu(one%it)/median_cpu(two%it)]
         end associate
      end do
   end subroutine thread_table

   ! ---- targets ----------------------------------------------------------------------------------

   !> The ratios that carry the claims, each within this run.
   subroutine verdict()
      real(dp) :: exact(size(timed)), per_time
      integer :: i, dop, worst
      exact = fast(1, :)
      per_time = exact(3)/step_of(4)
      dop = rival_number("dop853 vector")
      print "(/, a, /)", "6. ratios within this run, and what they were meant to be"
      call line("exact, ns, h|omega| <= 0.1", exact(1), "<= 4")
      call line("exact, ns, h|omega| <= 0.5", exact(3), "<= 5")
      call line("exact, ns, one step per call, rows", from_memory(1), "<= 6")
      call line("exact, ns, one step per call, slowest host layout", maxval(from_memory(3:)), &
         "<= 8")
      call line("exact, two threads, wall time", thread_gain(1), ">= 1.9")
      call line("   the most it could be, by processor time", thread_gain(2), "-")
      worst = maxloc(fast(3:10, 2), 1) + 2
      call line(trim(name_of(worst))//", slowest of dmv2..dmv16, ns, <= 0.2", fast(worst, 2), &
         "<= 7")
      i = rival_number("no-squish")
      call line("NO_SQUISH (scalar, rotation only) / exact, <= 0.1", fast(i, 1)/exact(1), ">= 20")
      i = rival_number("richardson")
      call line("Richardson (scalar, rotation only) / exact, <= 0.1", fast(i, 1)/exact(1), ">= 12")
      call line("DOP853 (vector, h = 0.1) / exact (<= 0.5), per unit time", &
                fast(dop, 2)/step_of(3)/per_time, ">= 4")
      print "(3x, a, es8.1, a, es8.1)", "   their errors: DOP853 ", wrong(dop, 3), ", exact ", &
         wrong(1, 4)
   end subroutine verdict

   subroutine kernels()
      real(dp) :: y(3, lanes), q(4, lanes)
      call random_bodies(y, q)
      call kernel_table(y, q)
   end subroutine kernels

   integer function rival_number(name)
      character(*), intent(in) :: name
      do rival_number = methods + 1, methods + size(rivals)
         if (name_of(rival_number) == name) return
      end do
   end function rival_number

   subroutine line(what, value, target)
      character(*), intent(in) :: what, target
      real(dp), intent(in) :: value
      print "(3x, a58, f9.2, '   meant: ', a)", what, value, target
   end subroutine line

end program bench
