!> What `make bench` times: rotation of bodies by a method of the registry, by a plan, by a rival.
module bench_tasks
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_body_class, only: body_class
   use poinsot_ensemble_bodies, only: body_view, view_rows, view_columns
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_ensemble_rotate, only: rotate_bodies
   use poinsot_ensemble_step, only: drift_bodies, step_bodies
   use poinsot_free_method, only: free_method
   use poinsot_effect_callback, only: user_torque
   use poinsot_rotation_random, only: random_direction, random_quaternion
   use bench_measure, only: task
   use bench_yardsticks, only: yardstick
   implicit none(type, external)
   private
   public :: free_task, plan_task, rival_task, down_torque, random_bodies, attach

   !> A task with arrays of bodies: its own, or some that tasks share.
   type, abstract, extends(task) :: body_task
      real(dp) :: h = 0
      real(dp), pointer :: y(:, :) => null(), q(:, :) => null()
      real(dp), allocatable :: y0(:, :), q0(:, :)    !! where each run starts; else it goes on
      type(body_view) :: view
   contains
      procedure :: prepare => start_again
   end type body_task

   !> rotate_bodies: one kind of body, one method.
   type, extends(body_task) :: free_task
      type(body_class) :: class
      type(free_method) :: method
   contains
      procedure :: run => run_free
   end type free_task

   !> A plan: drift_bodies, or step_bodies.
   type, extends(body_task) :: plan_task
      type(poinsot_plan), pointer :: plan => null()
      logical :: drift = .false.
   contains
      procedure :: run => run_plan
   end type plan_task

   !> Somebody else's way.
   type, extends(body_task) :: rival_task
      real(dp) :: moments(3) = 1
      type(yardstick) :: rival
   contains
      procedure :: run => run_rival
   end type rival_task

   !> The effect `callback` of the registry: a constant torque that a program computes body by body.
   type, extends(user_torque) :: down_torque
   contains
      procedure :: evaluate
   end type down_torque

contains

   !> n bodies with |y| = 1, all directions alike, and any attitude: rows.
   subroutine random_bodies(y, q)
      real(dp), intent(out) :: y(:, :), q(:, :)   !! (3, n), (4, n)
      integer :: i
      do i = 1, size(q, 2)
         y(1:3, i) = random_direction(1_i8, int(i, i8))
         q(:, i) = random_quaternion(1_i8, int(i, i8))
      end do
   end subroutine random_bodies

   !> Give a task bodies: copies of y and q that every run starts from, or the arrays themselves.
   subroutine attach(one, y, q, own)
      class(body_task), intent(inout) :: one
      real(dp), intent(in), target :: y(:, :), q(:, :)
      logical, intent(in) :: own
      logical :: columns
      columns = one%layout == "columns" .or. one%layout == "dl_poly"
      if (own) then
         one%y0 = y
         one%q0 = q
         allocate (one%y, source=y)
         allocate (one%q, source=q)
      else
         one%y => y
         one%q => q
      end if
      if (columns) then
         call view_columns(one%y, one%q, one%view)
      else
         call view_rows(one%y, one%q, one%view)
      end if
      one%n = one%view%n
   end subroutine attach

   subroutine start_again(self)
      class(body_task), intent(inout) :: self
      if (.not. allocated(self%y0)) return
      self%y = self%y0
      self%q = self%q0
   end subroutine start_again

   subroutine run_free(self)
      class(free_task), intent(inout) :: self
      type(poinsot_error) :: error
      integer :: status
      call rotate_bodies(self%class, self%method, self%h, self%steps, self%view, self%threads, &
                         status, error)
      self%failed = status /= 0
   end subroutine run_free

   subroutine run_plan(self)
      class(plan_task), intent(inout) :: self
      type(poinsot_error) :: error
      integer :: status
      if (self%drift) then
         call drift_bodies(self%plan, self%view, self%h, status, error)
      else
         call step_bodies(self%plan, self%view, 0.0_dp, self%h, 0_i8, int(self%steps, i8), &
            status, error)
      end if
      self%failed = status /= 0
      if (raised(error)) print "(2a)", "   "//trim(self%name)//": ", error%message
   end subroutine run_plan

   subroutine run_rival(self)
      class(rival_task), intent(inout) :: self
      call self%rival%run(self%moments, self%h, self%steps, self%y, self%q)
   end subroutine run_rival

   subroutine evaluate(self, t, q, torque, energy)
      class(down_torque), intent(in) :: self
      real(dp), intent(in) :: t, q(4)
      real(dp), intent(out) :: torque(3), energy
      associate (unused_1 => self%class_index, unused_2 => t)
      end associate
      torque = 0.1_dp*[q(2), q(3), q(4)]
      energy = 0
   end subroutine evaluate

end module bench_tasks
