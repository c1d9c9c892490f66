!> Noise in a scene: the effects that have a temperature.
module poinsot_scene_noise
   use poinsot_core_kinds, only: dp
   use poinsot_effect_registry, only: noise_key
   use poinsot_scene_settings, only: scene_settings, effect_setting
   implicit none(type, external)
   private
   public :: has_noise, noise_setting, wanted_temperature

contains

   !> Does a random force act?
   logical function has_noise(scene)
      type(scene_settings), intent(in) :: scene !! the typed scene
      integer :: i
      has_noise = .false.
      do i = 1, size(scene%effects)
         has_noise = has_noise .or. noise_key(scene%effects(i)%name) /= ""
      end do
   end function has_noise

   !> Which setting of an effect is the temperature of its noise; 0 of one without noise.
   integer function noise_setting(item) result(k)
      type(effect_setting), intent(in) :: item
      character(:), allocatable :: key
      key = noise_key(item%name)
      do k = size(item%settings), 1, -1
         if (item%settings(k)%key == key) return
      end do
   end function noise_setting

   !> kT of the thermostat if there is one, else of the first momenta.
   real(dp) function wanted_temperature(scene) result(kt)
      type(scene_settings), intent(in) :: scene !! the typed scene
      integer :: i, k
      kt = maxval(scene%bodies%temperature)
      do i = 1, size(scene%effects)
         k = noise_setting(scene%effects(i))
         if (k > 0) kt = scene%effects(i)%settings(k)%values(1)
      end do
   end function wanted_temperature

end module poinsot_scene_noise
