!> Columns of a trajectory besides the state of a body, by name.
module poinsot_scene_columns
   use poinsot_core_kinds, only: dp
   use poinsot_core_libm, only: arctangent
   use poinsot_rotation_conversions, only: euler_axes, euler_of_attitude
   use poinsot_rotation_quaternion, only: rotate
   use poinsot_scene_settings, only: scene_settings, rotor_of
   use poinsot_scene_states, only: to_scene_frame
   use poinsot_scene_text, only: lower, next_word
   implicit none(type, external)
   private
   public :: column_names, find_columns, column_values, angular_velocity, tilt_cosine

   !> All that there are; omega and Euler angles in the scene's frame, Q y in space.
   character(6), parameter :: column_names(*) = [character(6) :: "omega1", "omega2", "omega3", &
      "euler1", "euler2", "euler3", "Qy1", "Qy2", "Qy3", "tilt"]

contains

   !> The numbers of the columns that a text names; `unknown` is the first word that is none of
   !> them.
   subroutine find_columns(text, columns, unknown)
      character(*), intent(in) :: text                 !! names apart by blanks or commas
      integer, allocatable, intent(out) :: columns(:)
      character(:), allocatable, intent(out) :: unknown !! "" if all are known
      character(:), allocatable :: rest, name
      integer :: k
      allocate (columns(0))
      unknown = ""
      rest = text
      call next_word(rest, name)
      do while (name /= "")
         do k = size(column_names), 1, -1
            if (lower(trim(column_names(k))) == lower(name)) exit
         end do
         if (k == 0) then
            unknown = name
            return
         end if
         if (.not. any(columns == k)) columns = [columns, k]
         call next_word(rest, name)
      end do
   end subroutine find_columns

   !> Their values for one body.
   subroutine column_values(scene, group, t, y, q, columns, values)
      type(scene_settings), intent(in) :: scene
      integer, intent(in) :: group          !! number of the body's &bodies group
      real(dp), intent(in) :: t             !! time
      real(dp), intent(in) :: y(3), q(4)    !! its state, principal frame
      integer, intent(in) :: columns(:)
      real(dp), intent(out) :: values(:)
      real(dp) :: all(size(column_names)), y_scene(3), q_scene(4), cosine, sine
      y_scene = y
      q_scene = q
      call to_scene_frame(scene%bodies(group), y_scene, q_scene)
      all(1:3) = angular_velocity(scene, group, t, y)
      if (any(columns >= 4 .and. columns <= 6)) then
         all(4:6) = euler_of_attitude(euler_axes(scene%bodies(group)%convention), q_scene)
      end if
      all(7:9) = rotate(q, y)
      call tilt_cosine(scene, q_scene, cosine, sine)
      all(10) = arctangent(sine, cosine)
      values = all(columns)
   end subroutine column_values

   !> I^-1 (y - rotor), 0 about an axis without inertia, in the scene's frame.
   pure function angular_velocity(scene, group, t, y) result(omega)
      type(scene_settings), intent(in) :: scene
      integer, intent(in) :: group
      real(dp), intent(in) :: t    !! time
      real(dp), intent(in) :: y(3) !! principal frame
      real(dp) :: omega(3)
      omega = 0
      associate (b => scene%bodies(group))
         where (b%moments > 0) omega = (y - rotor_of(b, t))/b%moments
         if (b%turned) omega = matmul(b%axes, omega)
      end associate
   end function angular_velocity

   !> Cosine and sine of the angle between z and the axis that pictures follow.
   pure subroutine tilt_cosine(scene, q, cosine, sine)
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: q(4) !! in the scene's frame
      real(dp), intent(out) :: cosine, sine
      real(dp) :: axis(3)
      axis = rotate(q, scene%output%axis)
      cosine = axis(3)
      sine = norm2(axis(:2))
   end subroutine tilt_cosine

end module poinsot_scene_columns
