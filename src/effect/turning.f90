!> Settings `rate`, `phase` and `about` of effects whose direction in space may rotate.
module poinsot_effect_turning
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_effect_geometry, only: turned
   use poinsot_effect_settings, only: setting, effect_info, effect_key, number_key, get_value, &
      get_direction
   use poinsot_effect_terms, only: space_direction
   implicit none(type, external)
   private
   public :: turning_direction, turning_keys, get_turning

   !> A unit vector in space that turns about an axis at a constant rate.
   type :: turning_direction
      real(dp) :: at(3) = [0, 0, 1]     !! at phase zero
      real(dp) :: about(3) = [0, 0, 1]  !! unit vector
      real(dp) :: rate = 0              !! radians per time
      real(dp) :: phase = 0             !! radians
   contains
      procedure :: at_time
      procedure :: as_data
   end type turning_direction

contains

   !> The keys: how the direction called `name` turns.
   pure function turning_keys(name) result(keys)
      character(*), intent(in) :: name
      type(effect_key) :: keys(3)
      keys(1) = number_key("rate", 1, 1, "0", "radians per time", &
         "rate at which " // name // " rotates")
      keys(2) = number_key("phase", 1, 1, "0", "radians", "angle of this rotation at t = 0")
      keys(3) = number_key("about", 3, 3, "0,0,1", "direction", &
         "axis of this rotation, in space; normalised")
   end function turning_keys

   !> A direction from checked settings. POINSOT_E_DOMAIN for a zero vector.
   subroutine get_turning(info, settings, name, direction, error)
      type(effect_info), intent(in) :: info        !! the row of the registry
      type(setting), intent(in) :: settings(:)     !! checked against it
      character(*), intent(in) :: name             !! key of the direction
      type(turning_direction), intent(out) :: direction
      type(poinsot_error), intent(inout) :: error
      call get_direction(info, settings, name, direction%at, error)
      if (.not. raised(error)) call get_direction(info, settings, "about", direction%about, error)
      if (raised(error)) return
      direction%rate = get_value(info, settings, "rate")
      direction%phase = get_value(info, settings, "phase")
   end subroutine get_turning

   !> The direction at time t, in space.
   pure function at_time(self, t) result(e)
      class(turning_direction), intent(in) :: self
      real(dp), intent(in) :: t
      real(dp) :: e(3)
      e = self%at
      if (abs(self%rate) > 0 .or. abs(self%phase) > 0) e = turned(self%at, self%about, &
         self%rate*t + self%phase)
   end function at_time

   !> As the Taylor integrator wants it.
   pure function as_data(self) result(e)
      class(turning_direction), intent(in) :: self
      type(space_direction) :: e
      e = space_direction(self%at, self%about, self%rate, self%phase)
   end function as_data

end module poinsot_effect_turning
