!> Settings of an effect in the principal frame of a class that was given in another frame.
!>
!> The descriptions of the keys say which numbers are body vectors and which refer to axes: an
!> effect that describes its keys needs nothing else here.
module poinsot_effect_frame
   use poinsot_core_kinds, only: dp
   use poinsot_core_number, only: trusted_reals
   use poinsot_effect_settings, only: setting, effect_info, effect_key, number_setting, get_text, &
      body_vector, class_vectors, per_axis
   implicit none(type, external)
   private
   public :: depends_on_frame, turn_settings, turn_class_vectors, has_class_vectors

contains

   !> Would another frame of the body change what these settings mean?
   logical function depends_on_frame(info, settings)
      type(effect_info), intent(in) :: info     !! the row of the registry
      type(setting), intent(in) :: settings(:)  !! checked against it
      real(dp), allocatable :: values(:)
      integer :: k
      depends_on_frame = .false.
      do k = 1, size(info%keys)
         if (.not. is_turned(info, info%keys(k), settings)) cycle
         call values_of(info%keys(k), settings, values)
         if (info%keys(k)%frame == per_axis .and. size(values) < 3) cycle
         if (any(abs(values) > 0)) depends_on_frame = .true.
      end do
   end function depends_on_frame

   !> The same effect for a class whose principal axes are the columns of `axes` in the given frame.
   !> Defaults are vectors like any other.
   subroutine turn_settings(info, settings, axes, turned)
      type(effect_info), intent(in) :: info
      type(setting), intent(in) :: settings(:)
      real(dp), intent(in) :: axes(3, 3)
      type(setting), allocatable, intent(out) :: turned(:)
      real(dp), allocatable :: values(:)
      integer :: k
      turned = settings
      do k = 1, size(info%keys)
         if (.not. is_turned(info, info%keys(k), settings)) cycle
         call values_of(info%keys(k), settings, values)
         if (.not. any(abs(values) > 0)) cycle
         if (info%keys(k)%frame == body_vector) then
            call turn_vectors(axes, values)
         else if (size(values) == 3) then
            values = reshape(matmul(transpose(axes), spread(values, 2, 3)*axes), [9])
         end if
         call put(trim(info%keys(k)%name), values, turned)
      end do
   end subroutine turn_settings

   !> Vectors of an effect on several classes at once: three numbers for all classes become three
   !> for
   !> each, turned into each one's frame.
   subroutine turn_class_vectors(info, settings, axes, turned)
      type(effect_info), intent(in) :: info
      type(setting), intent(in) :: settings(:)
      real(dp), intent(in) :: axes(:, :, :)     !! (3, 3, classes)
      type(setting), allocatable, intent(out) :: turned(:)
      real(dp), allocatable :: values(:), all(:)
      integer :: k, c, classes
      classes = size(axes, 3)
      turned = settings
      do k = 1, size(info%keys)
         if (info%keys(k)%frame /= class_vectors) cycle
         call values_of(info%keys(k), settings, values)
         all = values
         if (size(values) == 3) all = reshape(spread(values, 2, classes), [3*classes])
         do c = 1, min(classes, size(all)/3)
            call turn_vectors(axes(:, :, c), all(3*c - 2:3*c))
         end do
         call put(trim(info%keys(k)%name), all, turned)
      end do
   end subroutine turn_class_vectors

   !> Has the effect vectors for several classes?
   pure logical function has_class_vectors(info)
      type(effect_info), intent(in) :: info
      has_class_vectors = any(info%keys%frame == class_vectors)
   end function has_class_vectors

   !> Are the numbers of this key turned, as these settings have it?
   logical function is_turned(info, key, settings)
      type(effect_info), intent(in) :: info
      type(effect_key), intent(in) :: key
      type(setting), intent(in) :: settings(:)
      is_turned = key%frame == body_vector .or. key%frame == per_axis
      if (is_turned .and. key%frame_key /= "") then
         is_turned = get_text(info, settings, trim(key%frame_key)) /= "space"
      end if
   end function is_turned

   !> The numbers of a key, given or default.
   subroutine values_of(key, settings, values)
      type(effect_key), intent(in) :: key
      type(setting), intent(in) :: settings(:)
      real(dp), allocatable, intent(out) :: values(:)
      integer :: i
      do i = 1, size(settings)
         if (settings(i)%key /= key%name) cycle
         values = settings(i)%values
         return
      end do
      allocate (values(merge(0, key%least, key%default == "" .or. key%default == "required")))
      if (size(values) > 0) call trusted_reals(key%default, values)
   end subroutine values_of

   subroutine put(key, values, settings)
      character(*), intent(in) :: key
      real(dp), intent(in) :: values(:)
      type(setting), allocatable, intent(inout) :: settings(:)
      type(setting), allocatable :: longer(:)
      integer :: i
      do i = 1, size(settings)
         if (settings(i)%key /= key) cycle
         settings(i)%values = values
         return
      end do
      allocate (longer(size(settings) + 1))
      longer(:size(settings)) = settings
      longer(size(longer)) = number_setting(key, values)
      call move_alloc(longer, settings)
   end subroutine put

   !> Each three numbers from the given frame into the principal one.
   pure subroutine turn_vectors(axes, values)
      real(dp), intent(in) :: axes(3, 3)
      real(dp), intent(inout) :: values(:)
      integer :: k
      do k = 1, size(values) - 2, 3
         values(k:k + 2) = matmul(transpose(axes), values(k:k + 2))
      end do
   end subroutine turn_vectors

end module poinsot_effect_frame
