!> Linear rotational drag: the exact flow of ydot = -gamma J^-1 y, half before and half after each
!> step, or all of it in the middle of `baoab`.
module poinsot_effect_drag
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_body_class, only: body_class
   use poinsot_effect_effect, only: effect, flow_effect
   use poinsot_effect_terms, only: torque_terms
   use poinsot_effect_friction, only: friction_law, friction_keys, get_friction, apply_full
   use poinsot_effect_row, only: effect_label, effect_row
   use poinsot_effect_settings, only: setting, effect_info
   implicit none(type, external)
   private
   public :: drag, drag_label, drag_row

   type(effect_label), parameter :: drag_label = effect_label("drag", 6)

   !> torque = -friction_i omega_i
   type, extends(flow_effect) :: drag
      type(friction_law) :: law
   contains
      procedure :: apply
      procedure :: add_terms
      procedure :: only_forward
   end type drag

contains

   !> Its row in the registry.
   function drag_row() result(row)
      type(effect_row) :: row
      row%info%name = drag_label%name
      row%info%formula = "torque = -friction omega;  exact flow y_i -> exp(-friction_i h/I_i) y_i"
      row%info%check = "sphere: y exp(-friction t/I); dE/dt = -omega.friction omega"
      row%info%order = 2
      row%info%gradient = .false.
      allocate (row%info%keys, source=friction_keys("drag"))
      row%make => make_drag
   end function drag_row

   !> A drag from checked settings.
   subroutine make_drag(info, settings, made, error)
      type(effect_info), intent(in) :: info           !! the row of the registry
      type(setting), intent(in) :: settings(:)        !! checked against the row
      class(effect), allocatable, intent(out) :: made !! not allocated after an error
      type(poinsot_error), intent(inout) :: error
      type(drag) :: new
      call get_friction(info, settings, new%law, error)
      if (.not. raised(error)) made = new
   end subroutine make_drag

   !> A zero moment has 1/I = 0: its momentum, which is zero, stays.
   subroutine apply(self, class, h, seed, id, step, half, q, y, scale)
      class(drag), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h
      integer(i8), intent(in) :: seed
      integer(i8), intent(in) :: id(lanes)
      integer(i8), intent(in) :: step
      integer, intent(in) :: half
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: y(lanes, 3)
      real(dp), intent(in), optional :: scale(lanes)
      real(dp) :: x(3)
      integer :: j
      associate (unused_1 => seed, unused_2 => id, unused_3 => step, unused_4 => half, &
         unused_5 => q)
      end associate
      if (allocated(self%law%full)) then
         call apply_full(class, self%law, h, 0.0_dp, y, scale=scale)
         return
      end if
      if (present(scale)) then
         do j = 1, 3
            y(:, j) = exp(-self%law%decay_each(class, h, j, scale))*y(:, j)
         end do
         return
      end if
      x = self%law%decay(class, h)
      do j = 1, 3
         y(:, j) = exp(-x(j))*y(:, j)
      end do
   end subroutine apply

   !> What drag has taken has no safe way back: backwards it grows like an exponential.
   pure logical function only_forward(self)
      class(drag), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      only_forward = .true.
   end function only_forward

   !> The effect as data.
   pure subroutine add_terms(self, class, terms, served)
      class(drag), intent(in) :: self
      type(body_class), intent(in) :: class
      type(torque_terms), intent(inout) :: terms
      logical, intent(out) :: served
      served = .true.
      terms%friction = terms%friction + self%law%matrix(class)
   end subroutine add_terms

end module poinsot_effect_drag
