!> Langevin thermostat: the exact Ornstein-Uhlenbeck flow on y, half before and half after each
!> step, or all of it in the middle of `baoab`.
module poinsot_effect_langevin
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_status, only: poinsot_e_domain
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_body_class, only: body_class
   use poinsot_effect_effect, only: effect, flow_effect
   use poinsot_effect_friction, only: friction_law, friction_keys, get_friction, apply_full, lost
   use poinsot_effect_gaussian, only: gaussian_block
   use poinsot_effect_row, only: effect_label, effect_row
   use poinsot_effect_settings, only: setting, effect_info, number_key, get_value
   implicit none(type, external)
   private
   public :: langevin, langevin_label, langevin_row

   type(effect_label), parameter :: langevin_label = effect_label("langevin", 7)

   !> dy_i = -friction_i y_i/I_i dt + sqrt(2 kT friction_i) dW
   type, extends(flow_effect) :: langevin
      type(friction_law) :: law
      real(dp) :: temperature = 0     !! kT, an energy
   contains
      procedure :: apply
      procedure :: only_forward
   end type langevin

contains

   !> Its row in the registry.
   function langevin_row() result(row)
      type(effect_row) :: row
      row%info%name = langevin_label%name
      row%info%formula = "y_i -> c y_i + sqrt(kT I_i (1 - c^2)) xi,  c = exp(-friction_i h/I_i)"
      row%info%check = "<y_i^2/(2 I_i)> = kT/2 on each axis, every kind of body; with baoab " // &
         "right after the noise, O(h^2) less at ends of steps"
      row%info%order = 2
      row%info%gradient = .false.
      allocate (row%info%keys, source=[ &
                  friction_keys("friction"), &
                  number_key("temperature", 1, 1, "required", "energy", &
                  "k T, Boltzmann's constant included")])
      row%info%keys(size(row%info%keys))%is_noise = .true.
      row%make => make_langevin
   end function langevin_row

   !> A thermostat from checked settings.
   subroutine make_langevin(info, settings, made, error)
      type(effect_info), intent(in) :: info           !! the row of the registry
      type(setting), intent(in) :: settings(:)        !! checked against the row
      class(effect), allocatable, intent(out) :: made !! not allocated after an error
      type(poinsot_error), intent(inout) :: error
      type(langevin) :: new
      call get_friction(info, settings, new%law, error)
      if (raised(error)) return
      new%temperature = get_value(info, settings, "temperature")
      if (new%temperature < 0) then
         call raise(error, poinsot_e_domain, &
            "effect 'langevin': key 'temperature' must not be negative")
         return
      end if
      made = new
   end subroutine make_langevin

   !> A zero moment gets neither friction nor noise.
   subroutine apply(self, class, h, seed, id, step, half, q, y, scale)
      class(langevin), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h
      integer(i8), intent(in) :: seed
      integer(i8), intent(in) :: id(lanes)
      integer(i8), intent(in) :: step
      integer, intent(in) :: half
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: y(lanes, 3)
      real(dp), intent(in), optional :: scale(lanes)
      real(dp) :: xi(lanes, 3), x(3), width, rate(lanes)
      integer :: j
      associate (unused => q)
      end associate
      call gaussian_block(seed, id, step, half, xi)
      if (allocated(self%law%full)) then
         call apply_full(class, self%law, h, self%temperature, y, xi, scale)
         return
      end if
      if (present(scale)) then
         do j = 1, 3
            rate = self%law%decay_each(class, h, j, scale)
            y(:, j) = exp(-rate)*y(:, j) &
               + sqrt(self%temperature*class%moments(j))*sqrt(scale)*sqrt(lost(rate))*xi(:, j)
         end do
         return
      end if
      x = self%law%decay(class, h)
      do j = 1, 3
         width = sqrt(self%temperature*class%moments(j))*sqrt(lost(x(j)))
         y(:, j) = exp(-x(j))*y(:, j) + width*xi(:, j)
      end do
   end subroutine apply

   !> Noise has no way back.
   pure logical function only_forward(self)
      class(langevin), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      only_forward = .true.
   end function only_forward

end module poinsot_effect_langevin
