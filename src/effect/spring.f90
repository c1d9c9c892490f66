!> A spring that aligns a body axis with a direction in space, in either sense.
module poinsot_effect_spring
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_body_class, only: body_class
   use poinsot_effect_effect, only: effect, torque_effect
   use poinsot_effect_geometry, only: to_body
   use poinsot_effect_terms, only: torque_terms, quadratic_term
   use poinsot_effect_traits, only: effect_traits
   use poinsot_effect_turning, only: turning_direction, turning_keys, get_turning
   use poinsot_effect_row, only: effect_label, effect_row
   use poinsot_effect_settings, only: setting, effect_info, number_key, get_value, &
      get_direction, body_vector
   implicit none(type, external)
   private
   public :: spring, spring_label, spring_row

   type(effect_label), parameter :: spring_label = effect_label("spring", 4)

   !> U = -(stiffness/2) (axis . Q^T direction)^2
   type, extends(torque_effect) :: spring
      real(dp) :: stiffness = 0
      real(dp) :: axis(3) = [0, 0, 1]       !! unit vector, body frame
      type(turning_direction) :: direction  !! in space
   contains
      procedure :: add_torque
      procedure :: add_terms
      procedure :: add_energy
      procedure :: has_gradient
      procedure :: get_traits
      procedure :: add_derivative
   end type spring

contains

   !> Its row in the registry.
   function spring_row() result(row)
      type(effect_row) :: row
      row%info%name = spring_label%name
      row%info%formula = "U = -(k/2) (axis.gamma)^2;  torque = k (axis.gamma) axis x gamma;  &
                     &k = stiffness, gamma = Q^T direction"
      row%info%check = "libration sqrt(stiffness/I)"
      allocate (row%info%keys, source=[ &
                  number_key("stiffness", 1, 1, "required", "energy", "strength of the spring"), &
                  number_key("axis", 3, 3, "0,0,1", "direction", &
                  "axis that it aligns, body frame; normalised", body_vector), &
                  number_key("direction", 3, 3, "0,0,1", "direction", &
                  "direction that it aligns the axis with, in space; normalised"), &
                  turning_keys("direction")])
      row%make => make_spring
   end function spring_row

   !> A spring from checked settings.
   subroutine make_spring(info, settings, made, error)
      type(effect_info), intent(in) :: info           !! the row of the registry
      type(setting), intent(in) :: settings(:)        !! checked against the row
      class(effect), allocatable, intent(out) :: made !! not allocated after an error
      type(poinsot_error), intent(inout) :: error
      type(spring) :: new
      call get_direction(info, settings, "axis", new%axis, error)
      if (.not. raised(error)) call get_turning(info, settings, "direction", new%direction, error)
      if (raised(error)) return
      new%stiffness = get_value(info, settings, "stiffness")
      made = new
   end subroutine make_spring

   subroutine add_torque(self, class, t, q, g)
      class(spring), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: g(lanes, 3)
      real(dp) :: v(lanes, 3), n(3), pull
      integer :: i
      associate (unused => class%moments)
      end associate
      n = self%axis
      call to_body(self%direction%at_time(t), q, v)
      !$omp simd private(pull)
      do i = 1, lanes
         pull = self%stiffness*(n(1)*v(i, 1) + n(2)*v(i, 2) + n(3)*v(i, 3))
         g(i, 1) = g(i, 1) + pull*(n(2)*v(i, 3) - n(3)*v(i, 2))
         g(i, 2) = g(i, 2) + pull*(n(3)*v(i, 1) - n(1)*v(i, 3))
         g(i, 3) = g(i, 3) + pull*(n(1)*v(i, 2) - n(2)*v(i, 1))
      end do
   end subroutine add_torque

   subroutine add_energy(self, class, t, q, u)
      class(spring), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: u(lanes)
      real(dp) :: v(lanes, 3)
      associate (unused => class%moments)
      end associate
      call to_body(self%direction%at_time(t), q, v)
      u = u - 0.5_dp*self%stiffness*(self%axis(1)*v(:, 1) + self%axis(2)*v(:, 2) + &
                                     self%axis(3)*v(:, 3))**2
   end subroutine add_energy

   pure subroutine get_traits(self, traits)
      class(spring), intent(in) :: self
      type(effect_traits), intent(out) :: traits
      traits%energy = .true.
      traits%one_direction = .true.
      traits%direction = self%direction%as_data()
      if (abs(self%direction%rate) > 0) traits%shown = "turning"
   end subroutine get_traits

   pure logical function has_gradient(self)
      class(spring), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      has_gradient = .true.
   end function has_gradient

   !> stiffness [(n.w) n x gamma + (n.gamma) n x w], w = gamma x delta
   subroutine add_derivative(self, class, t, q, delta, dg)
      class(spring), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: delta(lanes, 3)
      real(dp), intent(inout) :: dg(lanes, 3)
      real(dp) :: v(lanes, 3), n(3), w1, w2, w3, pull, change, m1, m2, m3
      integer :: i
      associate (unused => class%moments)
      end associate
      n = self%axis
      call to_body(self%direction%at_time(t), q, v)
      !$omp simd private(w1, w2, w3, pull, change, m1, m2, m3)
      do i = 1, lanes
         w1 = v(i, 2)*delta(i, 3) - v(i, 3)*delta(i, 2)
         w2 = v(i, 3)*delta(i, 1) - v(i, 1)*delta(i, 3)
         w3 = v(i, 1)*delta(i, 2) - v(i, 2)*delta(i, 1)
         pull = self%stiffness*(n(1)*v(i, 1) + n(2)*v(i, 2) + n(3)*v(i, 3))
         change = self%stiffness*(n(1)*w1 + n(2)*w2 + n(3)*w3)
         m1 = change*v(i, 1) + pull*w1
         m2 = change*v(i, 2) + pull*w2
         m3 = change*v(i, 3) + pull*w3
         dg(i, 1) = dg(i, 1) + (n(2)*m3 - n(3)*m2)
         dg(i, 2) = dg(i, 2) + (n(3)*m1 - n(1)*m3)
         dg(i, 3) = dg(i, 3) + (n(1)*m2 - n(2)*m1)
      end do
   end subroutine add_derivative

   !> The effect as data.
   pure subroutine add_terms(self, class, terms, served)
      class(spring), intent(in) :: self
      type(body_class), intent(in) :: class
      type(torque_terms), intent(inout) :: terms
      logical, intent(out) :: served
      associate (unused => class%moments)
      end associate
      served = .true.
      associate (a => self%axis, k => self%stiffness)
         call terms%add_quadratic(quadratic_term(self%direction%as_data(), &
            [k*((a(2) - a(3))*(a(2) + a(3))), k*((a(3) - a(1))*(a(3) + a(1))), &
             k*((a(1) - a(2))*(a(1) + a(2)))], [-k*(a(2)*a(3)), -k*(a(3)*a(1)), -k*(a(1)*a(2))]))
      end associate
   end subroutine add_terms

end module poinsot_effect_spring
