!> A potential U(Q, t) given by the user as a formula: torque and force gradient from its exact
!> derivatives (mathematics.md section 7).
!>
!> The rows of Q are space directions in the body frame, gamma_i = Q^T e_i, which change by gamma_i
!> x delta along Q -> Q exp(hat(delta)); with R_i = dU/dgamma_i the torque is the sum of gamma_i x
!> R_i, that is -rot(Q^T dU/dQ).
module poinsot_effect_potential
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_quiet, only: quiet_state, begin_quiet, end_quiet, is_number, no_number
   use poinsot_body_class, only: body_class
   use poinsot_effect_effect, only: effect, torque_effect
   use poinsot_effect_formula, only: compile_formula
   use poinsot_effect_formula_node, only: formula, most_nodes, op_attitude, op_time
   use poinsot_effect_formula_run, only: run_values, run_gradient, run_change, is_tame
   use poinsot_effect_geometry, only: to_body
   use poinsot_effect_traits, only: effect_traits
   use poinsot_effect_row, only: effect_label, effect_row
   use poinsot_effect_settings, only: setting, effect_info, number_key, text_key, get_text, &
      get_values, body_vector
   implicit none(type, external)
   private
   public :: potential, potential_label, potential_row

   type(effect_label), parameter :: potential_label = effect_label("potential", 11)

   real(dp), parameter :: longest_time = 1e30_dp
   real(dp), parameter :: unit(3, 3) = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])

   !> U, compiled.
   type, extends(torque_effect) :: potential
      type(formula) :: u
      real(dp) :: axes(3, 3) = unit !! columns: the body vectors whose directions are Q's columns
      logical :: turned = .false.   !! they are others than the principal axes
      logical :: rows(3) = .false.  !! of Q that U reads
      logical :: tame = .false.     !! nothing in it can trap, up to longest_time
   contains
      procedure :: add_torque
      procedure :: add_energy
      procedure :: has_gradient
      procedure :: get_traits
      procedure :: add_derivative
   end type potential

contains

   !> Its row in the registry.
   function potential_row() result(row)
      type(effect_row) :: row
      row%info%name = potential_label%name
      row%info%formula = "U = a formula of Q11 ... Q33, t and constants;  torque = -rot(Q^T dU/dQ)"
      row%info%check = "the heavy top, a dipole, a spring and gravity gradient as formulas"
      allocate (row%info%keys, source=[ &
                  text_key("u", "required", "", &
                  "+ - * / ^ sqrt exp log sin ... atan2 min max; t, pi, Q11 to Q33"), &
                  text_key("constants", "", "", "named numbers, as in 'k = 1.5, w = 2'"), &
                  number_key("axes", 9, 9, "1,0,0,0,1,0,0,0,1", "direction", &
                  "the body axes whose components are Q11, Q21, Q31, ...", body_vector)])
      row%make => make_potential
   end function potential_row

   !> A potential from checked settings. POINSOT_E_DOMAIN, with the character, for a formula that
   !> cannot be read.
   subroutine make_potential(info, settings, made, error)
      type(effect_info), intent(in) :: info           !! the row of the registry
      type(setting), intent(in) :: settings(:)        !! checked against the row
      class(effect), allocatable, intent(out) :: made !! not allocated after an error
      type(poinsot_error), intent(inout) :: error
      type(potential), allocatable :: new
      real(dp), allocatable :: axes(:)
      integer :: k
      allocate (new)
      call compile_formula(get_text(info, settings, "u"), get_text(info, settings, "constants"), &
                           new%u, error)
      if (raised(error)) return
      call get_values(info, settings, "axes", axes)
      new%axes = reshape(axes, [3, 3])
      new%turned = any(abs(new%axes - unit) > 0)
      do k = 1, new%u%n
         if (new%u%op(k) == op_attitude) new%rows(new%u%a(k)) = .true.
      end do
      ! 1.001: a quaternion may be off unit norm by 1e-6, and sums of three rounded
      new%tame = is_tame(new%u, 1.001_dp*max(1.0_dp, 3*maxval(abs(new%axes))))
      call move_alloc(new, made)
   end subroutine make_potential

   !> The elements of Q that the formula reads, and the rows of Q seen from the principal axes.
   pure subroutine elements(self, q, gamma, x)
      type(potential), intent(in) :: self
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: gamma(lanes, 3, 3) !! (:, component, row)
      real(dp), intent(inout) :: x(lanes, 3, 3)     !! (:, column, row)
      integer :: i
      do i = 1, 3
         if (.not. self%rows(i)) cycle
         call to_body(unit(:, i), q, gamma(:, :, i))
         call along_axes(self, gamma(:, :, i), x(:, :, i))
      end do
   end subroutine elements

   !> Components along the axes of the formula.
   pure subroutine along_axes(self, v, x)
      type(potential), intent(in) :: self
      real(dp), intent(in) :: v(lanes, 3)
      real(dp), intent(out) :: x(lanes, 3)
      integer :: k
      if (.not. self%turned) then
         x = v
         return
      end if
      do k = 1, 3
         x(:, k) = self%axes(1, k)*v(:, 1) + self%axes(2, k)*v(:, 2) + self%axes(3, k)*v(:, 3)
      end do
   end subroutine along_axes

   !> The vector that has these products with the axes of the formula: a gradient back.
   pure subroutine from_axes(self, r, v)
      type(potential), intent(in) :: self
      real(dp), intent(in) :: r(lanes, 3)
      real(dp), intent(out) :: v(lanes, 3)
      integer :: k
      if (.not. self%turned) then
         v = r
         return
      end if
      do k = 1, 3
         v(:, k) = self%axes(k, 1)*r(:, 1) + self%axes(k, 2)*r(:, 2) + self%axes(k, 3)*r(:, 3)
      end do
   end subroutine from_axes

   !> c += v x w
   pure subroutine add_cross(v, w, c)
      real(dp), intent(in) :: v(lanes, 3), w(lanes, 3)
      real(dp), intent(inout) :: c(lanes, 3)
      c(:, 1) = c(:, 1) + (v(:, 2)*w(:, 3) - v(:, 3)*w(:, 2))
      c(:, 2) = c(:, 2) + (v(:, 3)*w(:, 1) - v(:, 1)*w(:, 3))
      c(:, 3) = c(:, 3) + (v(:, 1)*w(:, 2) - v(:, 2)*w(:, 1))
   end subroutine add_cross

   !> Does anything in it have to run where nothing traps?
   pure logical function is_risky(self, t)
      type(potential), intent(in) :: self
      real(dp), intent(in) :: t
      is_risky = .not. (self%tame .and. abs(t) <= longest_time)
   end function is_risky

   !> A lane without a finite result has no number at all: that raises nothing further on.
   pure subroutine mark_not_finite(d)
      real(dp), intent(inout) :: d(:, :) !! (lanes, 1 or 3)
      integer :: l
      do l = 1, lanes
         if (.not. all(is_number(d(l, :)))) d(l, :) = no_number
      end do
   end subroutine mark_not_finite

   subroutine add_torque(self, class, t, q, g)
      class(potential), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: g(lanes, 3)
      real(dp) :: torque(lanes, 3)
      type(quiet_state) :: saved
      associate (unused => class%moments)
      end associate
      if (is_risky(self, t)) then
         call begin_quiet(saved)
         call find_torque(self, t, q, torque)
         call end_quiet(saved)
         call mark_not_finite(torque)
      else
         call find_torque(self, t, q, torque)
      end if
      g = g + torque
   end subroutine add_torque

   subroutine find_torque(self, t, q, torque)
      type(potential), intent(in) :: self
      real(dp), intent(in) :: t, q(lanes, 4)
      real(dp), intent(out) :: torque(lanes, 3)
      real(dp), dimension(lanes, most_nodes) :: v, p, w
      real(dp), dimension(lanes, 3, 3) :: gamma, x, r
      real(dp) :: s(most_nodes), gradient(lanes, 3)
      integer :: i
      call elements(self, q, gamma, x)
      call run_values(self%u, t, x, s, v)
      call run_gradient(self%u, s, v, p, w, r)
      torque = 0
      do i = 1, 3
         if (.not. self%rows(i)) cycle
         call from_axes(self, r(:, :, i), gradient)
         call add_cross(gamma(:, :, i), gradient, torque)
      end do
   end subroutine find_torque

   subroutine add_energy(self, class, t, q, u)
      class(potential), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: u(lanes)
      real(dp) :: energy(lanes, 1)
      type(quiet_state) :: saved
      associate (unused => class%moments)
      end associate
      if (is_risky(self, t)) then
         call begin_quiet(saved)
         call find_energy(self, t, q, energy(:, 1))
         call end_quiet(saved)
         call mark_not_finite(energy)
      else
         call find_energy(self, t, q, energy(:, 1))
      end if
      u = u + energy(:, 1)
   end subroutine add_energy

   subroutine find_energy(self, t, q, energy)
      type(potential), intent(in) :: self
      real(dp), intent(in) :: t, q(lanes, 4)
      real(dp), intent(out) :: energy(lanes)
      real(dp) :: v(lanes, most_nodes), s(most_nodes)
      real(dp), dimension(lanes, 3, 3) :: gamma, x
      call elements(self, q, gamma, x)
      call run_values(self%u, t, x, s, v)
      energy = v(:, self%u%result)
   end subroutine find_energy

   !> A formula of the third row of Q alone depends on no direction except z.
   pure subroutine get_traits(self, traits)
      class(potential), intent(in) :: self
      type(effect_traits), intent(out) :: traits
      traits%energy = .not. any(self%u%op(:self%u%n) == op_time)
      traits%one_direction = .not. any(self%rows(:2))
      traits%direction%at = unit(:, 3)
   end subroutine get_traits

   pure logical function has_gradient(self)
      class(potential), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      has_gradient = .true.
   end function has_gradient

   subroutine add_derivative(self, class, t, q, delta, dg)
      class(potential), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: delta(lanes, 3)
      real(dp), intent(inout) :: dg(lanes, 3)
      real(dp) :: change(lanes, 3)
      type(quiet_state) :: saved
      associate (unused => class%moments)
      end associate
      if (is_risky(self, t)) then
         call begin_quiet(saved)
         call find_change(self, t, q, delta, change)
         call end_quiet(saved)
         call mark_not_finite(change)
      else
         call find_change(self, t, q, delta, change)
      end if
      dg = dg + change
   end subroutine add_derivative

   !> sum of (gamma_i x delta) x R_i + gamma_i x dR_i
   subroutine find_change(self, t, q, delta, change)
      type(potential), intent(in) :: self
      real(dp), intent(in) :: t, q(lanes, 4), delta(lanes, 3)
      real(dp), intent(out) :: change(lanes, 3)
      real(dp), dimension(lanes, most_nodes) :: v, p, w
      real(dp), dimension(lanes, 3, 3) :: gamma, turn, x, dx, r, dr
      real(dp) :: s(most_nodes), gradient(lanes, 3)
      integer :: i
      call elements(self, q, gamma, x)
      call run_values(self%u, t, x, s, v)
      call run_gradient(self%u, s, v, p, w, r)
      turn = 0
      do i = 1, 3
         if (.not. self%rows(i)) cycle
         call add_cross(gamma(:, :, i), delta, turn(:, :, i))
         call along_axes(self, turn(:, :, i), dx(:, :, i))
      end do
      call run_change(self%u, s, v, p, w, dx, dr)
      change = 0
      do i = 1, 3
         if (.not. self%rows(i)) cycle
         call from_axes(self, r(:, :, i), gradient)
         call add_cross(turn(:, :, i), gradient, change)
         call from_axes(self, dr(:, :, i), gradient)
         call add_cross(gamma(:, :, i), gradient, change)
      end do
   end subroutine find_change

end module poinsot_effect_potential
