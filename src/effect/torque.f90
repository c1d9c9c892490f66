!> A prescribed torque, in the body frame or in space: constant, harmonic, or a table in time.
module poinsot_effect_torque
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_status, only: poinsot_e_domain
   use poinsot_core_time_table, only: time_table
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_body_class, only: body_class
   use poinsot_effect_effect, only: effect, torque_effect
   use poinsot_effect_geometry, only: to_body
   use poinsot_effect_terms, only: torque_terms, linear_term, body_term, table_term, space_direction
   use poinsot_effect_time_settings, only: times_key, table_file_key, read_time_table
   use poinsot_effect_row, only: effect_label, effect_row
   use poinsot_effect_settings, only: setting, effect_info, number_key, text_key, get_values, &
      get_value, get_text, was_given, body_vector
   implicit none(type, external)
   private
   public :: torque, torque_label, torque_row

   type(effect_label), parameter :: torque_label = effect_label("torque", 5)

   !> A torque without potential: it adds no energy of its own.
   type, extends(torque_effect) :: torque
      logical :: in_space = .false.
      logical :: harmonic = .false.
      real(dp) :: value(3) = 0
      real(dp) :: frequency = 0, phase = 0      !! radians per time, radians
      type(time_table), allocatable :: table    !! instead of these
   contains
      procedure :: at_time
      procedure :: jumps
      procedure :: seen
      procedure :: add_torque
      procedure :: add_terms
      procedure :: add_energy
      procedure :: has_gradient
      procedure :: add_derivative
   end type torque

contains

   !> Its row in the registry.
   function torque_row() result(row)
      type(effect_row) :: row
      row%info%name = torque_label%name
      row%info%formula = "torque = value, value cos(W t + phase), or a table, linear between &
                   &times; &
                     &in space: Q^T of it"
      row%info%check = "in space: angular momentum L = L0 + integral of the torque"
      allocate (row%info%keys, source=[ &
                  number_key("value", 3, 3, "0,0,0", "torque", "the torque, or its amplitude", &
                  body_vector, "frame"), &
                  text_key("frame", "body", "body space", "the frame of value"), &
                  number_key("frequency", 1, 1, "0", "radians per time", &
                  "W of a harmonic torque"), &
                  number_key("phase", 1, 1, "0", "radians", "phase at t = 0"), &
                  times_key(), &
                  number_key("table", 3, -1, "", "torque", "three numbers for each time", &
                  body_vector, "frame"), &
                  table_file_key("scene only: file with lines of t and three torques")])
      row%make => make_torque
   end function torque_row

   !> A torque from checked settings.
   subroutine make_torque(info, settings, made, error)
      type(effect_info), intent(in) :: info           !! the row of the registry
      type(setting), intent(in) :: settings(:)        !! checked against the row
      class(effect), allocatable, intent(out) :: made !! not allocated after an error
      type(poinsot_error), intent(inout) :: error
      type(torque) :: new
      real(dp), allocatable :: values(:)
      call get_values(info, settings, "value", values)
      new%value = values
      new%in_space = get_text(info, settings, "frame") == "space"
      new%frequency = get_value(info, settings, "frequency")
      new%phase = get_value(info, settings, "phase")
      new%harmonic = was_given(settings, "frequency") .or. was_given(settings, "phase")
      call read_time_table(info, settings, new%table, error)
      if (raised(error)) return
      if (allocated(new%table) .and. (was_given(settings, "value") .or. new%harmonic)) then
         call raise(error, poinsot_e_domain, "effect 'torque': give either a table " // &
                    "or 'value', 'frequency', 'phase', not both")
         return
      end if
      made = new
   end subroutine make_torque

   !> The torque at time t, in its own frame.
   pure function at_time(self, t) result(value)
      class(torque), intent(in) :: self
      real(dp), intent(in) :: t
      real(dp) :: value(3)
      if (allocated(self%table)) then
         value = self%table%at(t)
      else if (self%harmonic) then
         value = self%value*cos(self%frequency*t + self%phase)
      else
         value = self%value
      end if
   end function at_time

   pure logical function jumps(self)
      class(torque), intent(in) :: self
      jumps = .false.
      if (allocated(self%table)) jumps = self%table%jumps
   end function jumps

   pure real(dp) function seen(self, t, ahead)
      class(torque), intent(in) :: self
      real(dp), intent(in) :: t, ahead
      seen = t
      if (allocated(self%table)) seen = self%table%seen(t, ahead)
   end function seen

   subroutine add_torque(self, class, t, q, g)
      class(torque), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: g(lanes, 3)
      real(dp) :: value(3), v(lanes, 3)
      integer :: j
      associate (unused => class%moments)
      end associate
      value = self%at_time(t)
      if (self%in_space) then
         call to_body(value, q, v)
         g = g + v
      else
         do j = 1, 3
            g(:, j) = g(:, j) + value(j)
         end do
      end if
   end subroutine add_torque

   subroutine add_energy(self, class, t, q, u)
      class(torque), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: u(lanes)
      associate (unused_1 => self%class_index, unused_2 => class%moments, unused_3 => t, &
         unused_4 => q, unused_5 => u)
      end associate
   end subroutine add_energy

   !> [U, [T, U]] of a torque without potential has the same form: the derivation uses g alone.
   pure logical function has_gradient(self)
      class(torque), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      has_gradient = .true.
   end function has_gradient

   !> In space: (Q^T value) x delta. In the body frame: nothing.
   subroutine add_derivative(self, class, t, q, delta, dg)
      class(torque), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: delta(lanes, 3)
      real(dp), intent(inout) :: dg(lanes, 3)
      real(dp) :: v(lanes, 3)
      integer :: i
      associate (unused => class%moments)
      end associate
      if (.not. self%in_space) return
      call to_body(self%at_time(t), q, v)
      !$omp simd
      do i = 1, lanes
         dg(i, 1) = dg(i, 1) + (v(i, 2)*delta(i, 3) - v(i, 3)*delta(i, 2))
         dg(i, 2) = dg(i, 2) + (v(i, 3)*delta(i, 1) - v(i, 1)*delta(i, 3))
         dg(i, 3) = dg(i, 3) + (v(i, 1)*delta(i, 2) - v(i, 2)*delta(i, 1))
      end do
   end subroutine add_derivative

   !> The effect as data.
   pure subroutine add_terms(self, class, terms, served)
      class(torque), intent(in) :: self
      type(body_class), intent(in) :: class
      type(torque_terms), intent(inout) :: terms
      logical, intent(out) :: served
      real(dp), parameter :: identity(9) = [1, 0, 0, 0, 1, 0, 0, 0, 1]
      associate (unused => class%moments)
      end associate
      served = .true.
      if (allocated(self%table)) then
         call terms%add_table(table_term(self%in_space, self%table%times, self%table%values))
      else if (self%in_space) then
         call terms%add_linear(linear_term(space_direction(self%value), reshape(identity, [3, 3]), &
            self%harmonic, self%frequency, self%phase))
      else
         call terms%add_body(body_term(self%value, self%harmonic, self%frequency, self%phase))
      end if
   end subroutine add_terms

end module poinsot_effect_torque
