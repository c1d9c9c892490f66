!> TEMPORARY, until the plan: one thread, Strang splitting, torque effects only.
module poinsot_scene_engine
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_partial
   use poinsot_body_class, only: body_class, make_class
   use poinsot_body_invariants, only: kinetic_energy
   use poinsot_free_method, only: free_method, find_method, advance
   use poinsot_effect_effect, only: effect_item, torque_effect
   use poinsot_effect_registry, only: make_effect
   use poinsot_scene_text, only: text_of
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_states, only: body_states
   implicit none(type, external)
   private
   public :: engine, start_engine, engine_step, engine_energy

   !> What does not change during a run.
   type :: engine
      type(free_method) :: method
      type(body_class), allocatable :: classes(:)
      type(effect_item), allocatable :: effects(:)
   end type engine

contains

   !> Make it.
   subroutine start_engine(scene, this, error, method)
      type(scene_settings), intent(in) :: scene
      type(engine), intent(out) :: this
      type(poinsot_error), intent(inout) :: error
      character(*), intent(in), optional :: method !! instead of the scene's
      integer :: i
      if (present(method)) then
         call find_method(method, this%method, error)
      else
         call find_method(scene%method, this%method, error)
      end if
      allocate (this%classes(size(scene%bodies)), this%effects(size(scene%effects)))
      do i = 1, size(scene%bodies)
         if (.not. raised(error)) call make_class(scene%bodies(i)%moments, this%classes(i), error)
      end do
      do i = 1, size(scene%effects)
         if (.not. raised(error)) call make_effect(scene%effects(i)%name, scene%effects(i)%settings, &
                                                   this%effects(i)%it, error)
      end do
   end subroutine start_engine

   !> `steps` steps of h from time t. Error: POINSOT_E_PARTIAL if bodies failed.
   subroutine engine_step(this, states, t, h, first, steps, error)
      type(engine), intent(in) :: this
      type(body_states), intent(inout) :: states
      real(dp), intent(in) :: t, h
      integer(i8), intent(in) :: first, steps
      type(poinsot_error), intent(inout) :: error
      real(dp) :: y(lanes, 3), q(lanes, 4), carry(lanes, 7)
      integer :: status(lanes), i, m, g, failed
      integer(i8) :: k
      failed = 0
      associate (unused => first)
      end associate
      i = 1
      do while (i <= states%n)
         g = states%group(i)
         m = 1
         do while (m < lanes .and. i + m <= states%n)
            if (states%group(i + m) /= g) exit
            m = m + 1
         end do
         y = 0; q = 0; q(:, 1) = 1; carry = 0; status = poinsot_ok
         y(:m, :) = transpose(states%y(:, i:i + m - 1))
         q(:m, :) = transpose(states%q(:, i:i + m - 1))
         carry(:m, :) = transpose(states%carry(:, i:i + m - 1))
         do k = 1, steps
            if (size(this%effects) > 0) call kick(this, g, t + (k - 1)*h, h/2, y, q)
            call advance(this%method, this%classes(g), h, y, q, status, carry)
            if (size(this%effects) > 0) call kick(this, g, t + k*h, h/2, y, q)
         end do
         states%y(:, i:i + m - 1) = transpose(y(:m, :))
         states%q(:, i:i + m - 1) = transpose(q(:m, :))
         states%carry(:, i:i + m - 1) = transpose(carry(:m, :))
         failed = failed + count(status(:m) /= poinsot_ok)
         i = i + m
      end do
      if (failed > 0) call raise(error, poinsot_e_partial, text_of(failed) // " of " // &
                                 text_of(states%n) // " bodies failed")
   end subroutine engine_step

   subroutine kick(this, g, t, h, y, q)
      type(engine), intent(in) :: this
      integer, intent(in) :: g
      real(dp), intent(in) :: t, h, q(lanes, 4)
      real(dp), intent(inout) :: y(lanes, 3)
      real(dp) :: torque(lanes, 3)
      integer :: i
      torque = 0
      do i = 1, size(this%effects)
         select type (it => this%effects(i)%it)
         class is (torque_effect)
            if (it%class_index == 0 .or. it%class_index == g) call it%add_torque(this%classes(g), t, q, torque)
         end select
      end do
      y = y + h*torque
   end subroutine kick

   !> Energies of all bodies at time t.
   subroutine engine_energy(this, states, t, kinetic, potential)
      type(engine), intent(in) :: this
      type(body_states), intent(in) :: states
      real(dp), intent(in) :: t
      real(dp), intent(out) :: kinetic(:), potential(:)
      real(dp) :: q(lanes, 4), u(lanes)
      integer :: i, j
      do i = 1, states%n
         kinetic(i) = kinetic_energy(this%classes(states%group(i))%moments, states%y(:, i))
         q = spread(states%q(:, i), 1, lanes)
         u = 0
         do j = 1, size(this%effects)
            select type (it => this%effects(j)%it)
            class is (torque_effect)
               if (it%class_index == 0 .or. it%class_index == states%group(i)) &
                  call it%add_energy(this%classes(states%group(i)), t, q, u)
            end select
         end do
         potential(i) = u(1)
      end do
   end subroutine engine_energy

end module poinsot_scene_engine
