!> Effects of bodies whose scene frame is not the principal one: their body vectors turned.
module poinsot_scene_turn
   use poinsot_core_kinds, only: dp
   use poinsot_effect_settings, only: setting, number_setting
   use poinsot_scene_settings, only: scene_settings, effect_setting
   implicit none(type, external)
   private
   public :: turn_effect, any_turned, body_vector_keys

contains

   !> Does any group have a frame of its own?
   pure logical function any_turned(scene)
      type(scene_settings), intent(in) :: scene !! the typed scene
      any_turned = any(scene%bodies%turned)
   end function any_turned

   !> Which keys of an effect are vectors in the body frame, three numbers for each; "" ends the
   !> list.
   pure function body_vector_keys(effect) result(keys)
      character(*), intent(in) :: effect !! its name
      character(8) :: keys(2)
      keys = ""
      select case (effect)
      case ("gravity")
         keys(1) = "centre"
      case ("field", "dipoles")
         keys(1) = "dipole"
      case ("spring")
         keys(1) = "axis"
      case ("gyrostat")
         keys(1) = "rotor"
      case ("torque")
         keys = [character(8) :: "value", "table"]
      case default
         continue ! no vectors in the body frame
      end select
   end function body_vector_keys

   !> The effect for one class alone, its body vectors in the principal frame; without settings if
   !> it does not act on that class. Dipoles, which couple classes, are turned as a whole with class
   !> 1.
   subroutine turn_effect(scene, item, class, turned)
      type(scene_settings), intent(in) :: scene     !! the typed scene
      type(effect_setting), intent(in) :: item
      integer, intent(in) :: class                  !! from 1
      type(effect_setting), intent(out) :: turned
      integer :: i, wanted, n
      logical :: in_space
      turned%name = item%name
      turned%line = item%line
      wanted = 0
      n = 0
      in_space = .false.
      allocate (turned%settings(size(item%settings) + 1))
      do i = 1, size(item%settings)
         if (item%settings(i)%key == "class") then
            wanted = nint(item%settings(i)%values(1))
            cycle
         end if
         n = n + 1
         turned%settings(n) = item%settings(i)
         if (item%name == "torque" .and. item%settings(i)%key == "frame") then
            in_space = item%settings(i)%text == "space"
         end if
      end do
      if (wanted > 0 .and. wanted /= class .or. item%name == "dipoles" .and. class > 1) then
         turned%settings = turned%settings(:0)
         return
      end if
      if (item%name /= "dipoles" .or. wanted > 0) then
         n = n + 1
         turned%settings(n) = number_setting("class", [real(class, dp)])
      end if
      turned%settings = turned%settings(:n)
      if (in_space) return
      do i = 1, n
         if (.not. any(body_vector_keys(item%name) == turned%settings(i)%key)) cycle
         if (item%name == "dipoles") then
            call turn_dipoles(scene, turned%settings(i)%values)
         else
            call turn_vectors(scene%bodies(class)%axes, scene%bodies(class)%turned, &
                              turned%settings(i)%values)
         end if
      end do
   end subroutine turn_effect

   !> Each three numbers from the given frame into the principal one.
   pure subroutine turn_vectors(axes, turned, values)
      real(dp), intent(in) :: axes(3, 3)
      logical, intent(in) :: turned
      real(dp), intent(inout) :: values(:)
      integer :: k
      if (.not. turned) return
      do k = 1, size(values) - 2, 3
         values(k:k + 2) = matmul(transpose(axes), values(k:k + 2))
      end do
   end subroutine turn_vectors

   !> Dipoles: three numbers for all classes become three for each.
   pure subroutine turn_dipoles(scene, values)
      type(scene_settings), intent(in) :: scene
      real(dp), allocatable, intent(inout) :: values(:)
      real(dp), allocatable :: all(:)
      integer :: i, n
      n = size(scene%bodies)
      if (size(values) == 3) then
         all = reshape(spread(values, 2, n), [3*n])
         call move_alloc(all, values)
      end if
      do i = 1, min(n, size(values)/3)
         call turn_vectors(scene%bodies(i)%axes, scene%bodies(i)%turned, values(3*i - 2:3*i))
      end do
   end subroutine turn_dipoles

end module poinsot_scene_turn
