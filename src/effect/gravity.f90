!> Uniform gravity on a body with a fixed point: the heavy top, for any centre of mass.
module poinsot_effect_gravity
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_body_class, only: body_class
   use poinsot_effect_effect, only: effect, torque_effect
   use poinsot_effect_geometry, only: add_linear_torque, add_linear_energy, add_linear_derivative
   use poinsot_effect_terms, only: torque_terms, linear_term, cross_matrix
   use poinsot_effect_traits, only: effect_traits
   use poinsot_effect_turning, only: turning_direction, turning_keys, get_turning
   use poinsot_effect_row, only: effect_label, effect_row
   use poinsot_effect_settings, only: setting, effect_info, number_key, get_values, &
      get_value, check_product, body_vector
   implicit none(type, external)
   private
   public :: gravity, gravity_label, gravity_row

   type(effect_label), parameter :: gravity_label = effect_label("gravity", 1)

   !> U = weight (Q^T up) . centre
   type, extends(torque_effect) :: gravity
      real(dp) :: arm(3) = 0  !! weight times centre of mass, body frame
      type(turning_direction) :: up !! in space
   contains
      procedure :: add_torque
      procedure :: add_terms
      procedure :: add_energy
      procedure :: has_gradient
      procedure :: get_traits
      procedure :: add_derivative
   end type gravity

contains

   !> Its row in the registry.
   function gravity_row() result(row)
      type(effect_row) :: row
      row%info%name = gravity_label%name
      row%info%formula = "U = weight (Q^T up).centre;  torque = weight (Q^T up) x centre"
      row%info%check = "Lagrange top: steady precession, y3, L_z, H conserved; sleeping top; &
                   &Kovalevskaya integral"
      allocate (row%info%keys, source=[ &
                  number_key("centre", 3, 3, "required", "length", &
                  "centre of mass from the fixed point, body frame", body_vector, shown="centre"), &
                  number_key("weight", 1, 1, "1", "force", "mass times acceleration of gravity"), &
                  number_key("up", 3, 3, "0,0,1", "direction", &
                  "upward direction, in space; normalised"), &
                  turning_keys("up")])
      row%make => make_gravity
   end function gravity_row

   !> Gravity from checked settings.
   subroutine make_gravity(info, settings, made, error)
      type(effect_info), intent(in) :: info           !! the row of the registry
      type(setting), intent(in) :: settings(:)        !! checked against the row
      class(effect), allocatable, intent(out) :: made !! not allocated after an error
      type(poinsot_error), intent(inout) :: error
      type(gravity) :: new
      real(dp), allocatable :: centre(:)
      call get_turning(info, settings, "up", new%up, error)
      if (raised(error)) return
      call get_values(info, settings, "centre", centre)
      call check_product(info, settings, "weight", maxval(abs(centre)), error)
      if (raised(error)) return
      new%arm = get_value(info, settings, "weight")*centre
      made = new
   end subroutine make_gravity

   subroutine add_torque(self, class, t, q, g)
      class(gravity), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: g(lanes, 3)
      associate (unused => class%moments)
      end associate
      call add_linear_torque(self%up%at_time(t), self%arm, q, g)
   end subroutine add_torque

   subroutine add_energy(self, class, t, q, u)
      class(gravity), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: u(lanes)
      associate (unused => class%moments)
      end associate
      call add_linear_energy(self%up%at_time(t), self%arm, q, u)
   end subroutine add_energy

   !> A top, if the direction is fixed.
   pure subroutine get_traits(self, traits)
      class(gravity), intent(in) :: self
      type(effect_traits), intent(out) :: traits
      traits%energy = .true.
      traits%one_direction = .true.
      traits%direction = self%up%as_data()
      traits%shown = "turning"
      if (abs(self%up%rate) > 0) return
      traits%shown = "top"
      if (.not. abs(self%up%phase) > 0) traits%arm = self%arm
   end subroutine get_traits

   pure logical function has_gradient(self)
      class(gravity), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      has_gradient = .true.
   end function has_gradient

   subroutine add_derivative(self, class, t, q, delta, dg)
      class(gravity), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: delta(lanes, 3)
      real(dp), intent(inout) :: dg(lanes, 3)
      associate (unused => class%moments)
      end associate
      call add_linear_derivative(self%up%at_time(t), self%arm, q, delta, dg)
   end subroutine add_derivative

   !> The effect as data.
   pure subroutine add_terms(self, class, terms, served)
      class(gravity), intent(in) :: self
      type(body_class), intent(in) :: class
      type(torque_terms), intent(inout) :: terms
      logical, intent(out) :: served
      associate (unused => class%moments)
      end associate
      served = .true.
      call terms%add_linear(linear_term(self%up%as_data(), cross_matrix(self%arm)))
   end subroutine add_terms

end module poinsot_effect_gravity
