!> The groups of a scene file with all their keys, as tables in Markdown, from the tables that the
!> reader itself uses.
module app_keys
   use poinsot_effect_settings, only: effect_info, effect_key
   use poinsot_effect_registry, only: effect_count, describe_effect
   use poinsot_scene_keys, only: scene_keys, bodies_keys, output_keys
   use poinsot_scene_text, only: text_of
   use poinsot_scene_typed_group, only: is_logical
   use app_terminal, only: say
   implicit none(type, external)
   private
   public :: group_count, get_group, put_table

   integer, parameter :: group_count = effect_count + 3 !! effects, then &scene, &bodies, &output

contains

   !> What group i of a scene file is and which keys it has: effects first.
   subroutine get_group(i, info)
      integer, intent(in) :: i                !! 1 to group_count
      type(effect_info), intent(out) :: info
      select case (i - effect_count)
      case (1)
         call scene_keys(info)
      case (2)
         call bodies_keys(info)
      case (3)
         call output_keys(info)
      case default
         info = describe_effect(i)
      end select
      if (.not. allocated(info%keys)) allocate (info%keys(0))
   end subroutine get_group

   !> The table of one group.
   subroutine put_table(info)
      type(effect_info), intent(in) :: info
      integer :: k
      call say("")
      call say("### `&" // trim(info%name) // "`")
      call say("")
      call say(trim(info%formula))
      call say("")
      call say("| key | takes | default | units, or choices | meaning |")
      call say("|---|---|---|---|---|")
      do k = 1, size(info%keys)
         call say("| `" // trim(info%keys(k)%name) // "` | " // takes(info%keys(k)) // " | " // &
                  default_of(info, k) // " | " // trim(info%keys(k)%units) // " | " // &
                  trim(info%keys(k)%meaning) // " |")
      end do
   end subroutine put_table

   !> Its default; of a required key also the keys that may be given in its place.
   function default_of(info, k) result(text)
      type(effect_info), intent(in) :: info
      integer, intent(in) :: k                !! which of its keys
      character(:), allocatable :: text
      integer :: i
      text = trim(info%keys(k)%default)
      do i = 1, size(info%keys)
         if (info%keys(i)%instead_of /= info%keys(k)%name) cycle
         text = text // ", or `" // trim(info%keys(i)%name) // "`"
      end do
   end function default_of

   !> "3 numbers"
   function takes(key) result(text)
      type(effect_key), intent(in) :: key
      character(:), allocatable :: text
      if (is_logical(key)) then
         text = "a logical"
      else if (key%is_text) then
         text = "a string"
      else if (key%units == "integer" .and. key%most == 1) then
         text = "an integer"
      else if (key%most < 0) then
         text = "numbers"
         if (key%least > 1) text = "numbers, at least " // text_of(key%least)
      else if (key%most == 1) then
         text = "a number"
      else if (key%least == key%most) then
         text = text_of(key%most) // " numbers"
      else
         text = text_of(key%least) // " to " // text_of(key%most) // " numbers"
      end if
   end function takes

end module app_keys
