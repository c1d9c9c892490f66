!> What stepper.c counts instructions of: regions between marks, one line of `regions.txt` for each:
!> kind, name, h |omega|, body-steps.
!>
!> usage: counted FOLDER
program counted
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error
   use poinsot_body_class, only: body_class, make_class
   use poinsot_effect_registry, only: effect_count, effect_name
   use poinsot_ensemble_bodies, only: body_view, view_rows, view_columns
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_ensemble_rotate, only: rotate_bodies
   use poinsot_ensemble_step, only: drift_bodies, step_bodies
   use poinsot_free_method, only: free_method, find_method, method_names, advance
   use bench_effect_plans, only: make_plan, add_any_effect, finish_plan
   use bench_tasks, only: random_bodies
   implicit none(type, external)

   interface
      subroutine bench_mark() bind(c)
         implicit none(type, external)
      end subroutine bench_mark
   end interface

   real(dp), parameter :: moments(3) = [0.376_dp, 0.627_dp, 1.0_dp]
   real(dp), parameter :: phases(3) = [0.1_dp, 0.2_dp, 0.5_dp]
   ! steps; the difference to one step is more - 1 steps without loading and storing
   integer, parameter :: more = 3
   type(body_class) :: class
   type(poinsot_error) :: error
   type(poinsot_plan), target :: plans(0:effect_count)
   integer, parameter :: n = 16*lanes !! bodies of a call: so many blocks that its way in is little
   real(dp), target :: y0(3, n), q0(4, n), y(3, n), q(4, n), yc(n, 3), qc(n, 4)
   character(256) :: folder
   integer :: list, i, k

   call get_command_argument(1, folder)
   open (newunit=list, file=trim(folder)//"/regions.txt", action="write")
   call make_class(moments, class, error)
   call random_bodies(y0, q0)
   do i = 1, size(method_names)
      do k = 1, size(phases)
         if (k == 1 .or. i == 1) call count_method(trim(method_names(i)), phases(k))
      end do
   end do
   call count_calls()
   do i = 0, effect_count
      call make_plan(moments, "exact", "native", plans(i))
      if (i > 0) call add_any_effect(plans(i), i)
      call finish_plan(plans(i))
      if (i == 0) call count_effect("no effect", plans(i))
      if (i > 0) call count_effect(effect_name(i), plans(i))
   end do
   close (list)

contains

   subroutine name_region(kind, name, phase, body_steps)
      character(*), intent(in) :: kind, name
      real(dp), intent(in) :: phase
      integer, intent(in) :: body_steps
      write (list, "(a, ',', a, ',', f0.2, ',', i0)") kind, name, phase, body_steps
   end subroutine name_region

   !> One step of one block.
   subroutine count_method(name, phase)
      character(*), intent(in) :: name
      real(dp), intent(in) :: phase
      type(free_method) :: method
      real(dp) :: h, yb(lanes, 3), qb(lanes, 4)
      integer :: status(lanes)
      yb = transpose(y0(:, 1:lanes))
      qb = transpose(q0(:, 1:lanes))
      status = 0
      h = phase*minval(moments)
      call find_method(name, method, error)
      call advance(method, class, h, yb, qb, status)
      call bench_mark()
      call advance(method, class, h, yb, qb, status)
      call bench_mark()
      call name_region("kernel", name, phase, lanes)
   end subroutine count_method

   !> A call with one step, from rows and from columns, and with many.
   subroutine count_calls()
      type(body_view) :: rows, columns
      call view_rows(y, q, rows)
      call view_columns(yc, qc, columns)
      y = y0
      q = q0
      yc = transpose(y0)
      qc = transpose(q0)
      call rotate_region("call", "exact from columns", columns, 1)
      call rotate_region("call", "exact from rows", rows, 1)
      call rotate_region("call", "exact from rows", rows, more)
      call drift_region(rows)
   end subroutine count_calls

   !> A drift by a plan, with no member of the view but y and q.
   subroutine drift_region(view)
      type(body_view), intent(in) :: view
      type(poinsot_plan), target :: plan
      integer :: status
      call make_plan(moments, "exact", "native", plan)
      call finish_plan(plan)
      call drift_bodies(plan, view, phases(1)*minval(moments), status, error)
      call bench_mark()
      call drift_bodies(plan, view, phases(1)*minval(moments), status, error)
      call bench_mark()
      call name_region("call", "plain drift", phases(1), n)
   end subroutine drift_region

   subroutine rotate_region(kind, name, view, steps)
      character(*), intent(in) :: kind, name
      type(body_view), intent(in) :: view
      integer, intent(in) :: steps
      type(free_method) :: method
      integer :: status
      call find_method("exact", method, error)
      call rotate_bodies(class, method, phases(1)*minval(moments), steps, view, 1, status, error)
      call bench_mark()
      call rotate_bodies(class, method, phases(1)*minval(moments), steps, view, 1, status, error)
      call bench_mark()
      call name_region(kind, name, phases(1), steps*n)
   end subroutine rotate_region

   !> A plan, one step and many.
   subroutine count_effect(name, plan)
      character(*), intent(in) :: name
      type(poinsot_plan), intent(in), target :: plan
      type(body_view) :: view
      integer :: status, steps, k
      do k = 1, 2
         steps = merge(1, more, k == 1)
         y = y0
         q = q0
         call view_rows(y(:, 1:lanes), q(:, 1:lanes), view)
         call bench_mark()
         call step_bodies(plan, view, 0.0_dp, phases(1)*minval(moments), 0_i8, int(steps, i8), &
            status, error)
         call bench_mark()
         call name_region("plan", name, phases(1), steps*lanes)
      end do
   end subroutine count_effect

end program counted
