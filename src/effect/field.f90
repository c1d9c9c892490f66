!> A dipole in a uniform field: static, rotating about an axis, or oscillating along its direction.
module poinsot_effect_field
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_body_class, only: body_class
   use poinsot_effect_effect, only: effect, torque_effect
   use poinsot_effect_geometry, only: turned, add_linear_torque, add_linear_energy, &
      add_linear_derivative
   use poinsot_effect_traits, only: effect_traits
   use poinsot_effect_terms, only: torque_terms, linear_term, space_direction, cross_matrix
   use poinsot_effect_row, only: effect_label, effect_row
   use poinsot_effect_settings, only: setting, effect_info, number_key, text_key, get_values, &
      get_value, get_text, get_direction, body_vector
   implicit none(type, external)
   private
   public :: field, field_label, field_row

   type(effect_label), parameter :: field_label = effect_label("field", 2)

   integer, parameter :: static = 0, rotating = 1, oscillating = 2

   !> U = -dipole . Q^T E(t)
   type, extends(torque_effect) :: field
      real(dp) :: dipole(3) = 0    !! body frame
      real(dp) :: strength(3) = 0  !! E at phase zero, in space
      integer :: motion = static
      real(dp) :: axis(3) = [0, 0, 1]
      real(dp) :: frequency = 0    !! radians per time
      real(dp) :: phase = 0        !! radians
   contains
      procedure :: at_time
      procedure :: add_torque
      procedure :: add_terms
      procedure :: add_energy
      procedure :: has_gradient
      procedure :: get_traits
      procedure :: add_derivative
   end type field

contains

   !> Its row in the registry.
   function field_row() result(row)
      type(effect_row) :: row
      row%info%name = field_label%name
      row%info%formula = "U = -dipole.(Q^T E);  torque = dipole x (Q^T E);  &
                     &E = E0, turned by W t + phase, or E0 cos"
      row%info%check = "libration sqrt(dipole E/I); fast oscillating field: dipole E/(sqrt(2) I W)"
      allocate (row%info%keys, source=[ &
                  number_key("dipole", 3, 3, "required", "dipole moment", "dipole, body frame", &
                  body_vector, shown="dipole"), &
                  number_key("strength", 3, 3, "required", "energy per dipole moment", &
                  "the field E0, in space"), &
                  text_key("motion", "static", "static rotating oscillating", &
                  "how the field changes with time"), &
                  number_key("frequency", 1, 1, "0", "radians per time", &
                  "W of a rotating or oscillating field"), &
                  number_key("phase", 1, 1, "0", "radians", "phase at t = 0"), &
                  number_key("axis", 3, 3, "0,0,1", "direction", &
                  "axis of a rotating field, in space; normalised")])
      row%make => make_field
   end function field_row

   !> A field from checked settings.
   subroutine make_field(info, settings, made, error)
      type(effect_info), intent(in) :: info           !! the row of the registry
      type(setting), intent(in) :: settings(:)        !! checked against the row
      class(effect), allocatable, intent(out) :: made !! not allocated after an error
      type(poinsot_error), intent(inout) :: error
      type(field) :: new
      real(dp), allocatable :: values(:)
      call get_values(info, settings, "dipole", values)
      new%dipole = values
      call get_values(info, settings, "strength", values)
      new%strength = values
      call get_direction(info, settings, "axis", new%axis, error)
      if (raised(error)) return
      new%frequency = get_value(info, settings, "frequency")
      new%phase = get_value(info, settings, "phase")
      select case (get_text(info, settings, "motion"))
      case ("rotating")
         new%motion = rotating
      case ("oscillating")
         new%motion = oscillating
      case default
         new%motion = static
      end select
      made = new
   end subroutine make_field

   !> The field at time t, in space.
   pure function at_time(self, t) result(e)
      class(field), intent(in) :: self
      real(dp), intent(in) :: t
      real(dp) :: e(3)
      select case (self%motion)
      case (rotating)
         e = turned(self%strength, self%axis, self%frequency*t + self%phase)
      case (oscillating)
         e = self%strength*cos(self%frequency*t + self%phase)
      case default
         e = self%strength
      end select
   end function at_time

   subroutine add_torque(self, class, t, q, g)
      class(field), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: g(lanes, 3)
      associate (unused => class%moments)
      end associate
      call add_linear_torque(self%at_time(t), -self%dipole, q, g)
   end subroutine add_torque

   subroutine add_energy(self, class, t, q, u)
      class(field), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: u(lanes)
      associate (unused => class%moments)
      end associate
      call add_linear_energy(self%at_time(t), -self%dipole, q, u)
   end subroutine add_energy

   !> A field whose strength swings does work in every frame.
   pure subroutine get_traits(self, traits)
      class(field), intent(in) :: self
      type(effect_traits), intent(out) :: traits
      traits%energy = self%motion /= oscillating
      traits%one_direction = .true.
      traits%swings = self%motion == oscillating
      traits%direction = space_direction(self%strength)
      if (self%motion == rotating) then
         traits%direction = space_direction(self%strength, self%axis, self%frequency, self%phase)
      else if (self%motion == oscillating) then
         traits%direction%rate = self%frequency
         traits%direction%phase = self%phase
      end if
      traits%shown = "field"
   end subroutine get_traits

   pure logical function has_gradient(self)
      class(field), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      has_gradient = .true.
   end function has_gradient

   subroutine add_derivative(self, class, t, q, delta, dg)
      class(field), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: delta(lanes, 3)
      real(dp), intent(inout) :: dg(lanes, 3)
      associate (unused => class%moments)
      end associate
      call add_linear_derivative(self%at_time(t), -self%dipole, q, delta, dg)
   end subroutine add_derivative

   !> The effect as data.
   pure subroutine add_terms(self, class, terms, served)
      class(field), intent(in) :: self
      type(body_class), intent(in) :: class
      type(torque_terms), intent(inout) :: terms
      logical, intent(out) :: served
      associate (unused => class%moments)
      end associate
      served = .true.
      associate (matrix => cross_matrix(-self%dipole))
         select case (self%motion)
         case (rotating)
            call terms%add_linear(linear_term(space_direction(self%strength, self%axis, &
               self%frequency, self%phase), matrix))
         case (oscillating)
            call terms%add_linear(linear_term(space_direction(self%strength), matrix, .true., &
               self%frequency, self%phase))
         case default
            call terms%add_linear(linear_term(space_direction(self%strength), matrix))
         end select
      end associate
   end subroutine add_terms

end module poinsot_effect_field
