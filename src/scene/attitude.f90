!> The attitude of a &bodies group in common forms: a quaternion, Euler angles, axis and angle.
module poinsot_scene_attitude
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_rotation_conversions, only: from_axis_angle, from_euler
   use poinsot_rotation_quaternion, only: quaternion_product, unit_tolerance
   use poinsot_scene_settings, only: body_group, random_none
   use poinsot_scene_source, only: place
   use poinsot_scene_text, only: text_of
   use poinsot_scene_typed_group, only: typed_group, given, numbers_of, word_of, flag_of, &
      reject_key, relabel
   implicit none(type, external)
   private
   public :: build_attitude, make_unit, amount

   real(dp), parameter :: largest_slack = 1e-3_dp !! of |q|: what three or four digits lose
   real(dp), parameter :: degree = acos(-1.0_dp)/180
   character(*), parameter :: ways(3) = [character(10) :: "q", "euler", "axis_angle"]

contains

   !> q, euler or axis_angle, one of them at most, into the principal frame. Error: POINSOT_E_SCENE
   !> naming file, line and key.
   subroutine build_attitude(group, bodies, error)
      type(typed_group), intent(in) :: group    !! keys with their values
      type(body_group), intent(inout) :: bodies !! `random`, axes and frame are known; gets q, note
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: way
      call find_way(group, bodies, way, error)
      if (raised(error)) return
      select case (way)
      case ("euler")
         call from_angles(group, bodies%q, error)
      case ("axis_angle")
         call from_axis(group, bodies%q, error)
      case default
         call from_quaternion(group, bodies, error)
      end select
      if (bodies%turned) bodies%q = quaternion_product(bodies%q, bodies%frame)
   end subroutine build_attitude

   !> The key that gives the attitude; an error if there are several.
   subroutine find_way(group, bodies, way, error)
      type(typed_group), intent(in) :: group
      type(body_group), intent(in) :: bodies
      character(:), allocatable, intent(out) :: way
      type(poinsot_error), intent(inout) :: error
      integer :: i
      way = ""
      do i = 1, size(ways)
         if (.not. given(group, trim(ways(i)))) cycle
         if (bodies%random /= random_none) then
            call reject_key(group, trim(ways(i)), "is given, and random = '" // &
               word_of(group, "random") // "' asks for random attitudes; leave one of them out", &
               error)
         else if (way /= "") then
            call reject_key(group, trim(ways(i)), "and " // way // " are both given; give the " &
               // "attitude once", error)
         end if
         if (raised(error)) return
         way = trim(ways(i))
      end do
      if (given(group, "degrees") .and. way /= "euler" .and. way /= "axis_angle") then
         call reject_key(group, "degrees", "is for euler or axis_angle; neither is given", error)
      end if
   end subroutine find_way

   !> One degree or one radian.
   real(dp) function angle_unit(group)
      type(typed_group), intent(in) :: group
      angle_unit = 1
      if (flag_of(group, "degrees")) angle_unit = degree
   end function angle_unit

   !> Three angles about moving axes: q = q_1(a1) q_2(a2) q_3(a3).
   subroutine from_angles(group, q, error)
      type(typed_group), intent(in) :: group
      real(dp), intent(out) :: q(4)
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: angles(:)
      call numbers_of(group, "euler", angles)
      call from_euler(word_of(group, "convention"), angle_unit(group)*angles(:3), q, error)
      call relabel(group, "euler", error)
   end subroutine from_angles

   !> An axis of any length and an angle about it.
   subroutine from_axis(group, q, error)
      type(typed_group), intent(in) :: group
      real(dp), intent(out) :: q(4)
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: values(:)
      call numbers_of(group, "axis_angle", values)
      call from_axis_angle(values(:3), angle_unit(group)*values(4), q, error)
      call relabel(group, "axis_angle", error)
   end subroutine from_axis

   !> A unit quaternion, or one with few digits, which is made one.
   subroutine from_quaternion(group, bodies, error)
      type(typed_group), intent(in) :: group
      type(body_group), intent(inout) :: bodies
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: values(:)
      real(dp) :: q(4), off
      logical :: good
      call numbers_of(group, "q", values)
      q = values
      if (maxval(abs(q)) <= 0) then
         call reject_key(group, "q", "is zero; the identity is 1, 0, 0, 0", error)
         return
      end if
      call make_unit(q, off, good)
      if (.not. good) then
         call reject_key(group, "q", "is not a unit quaternion, its norm differs from 1 by " // &
            amount(off) // "; up to 1e-3 is normalised, which gives " // text_of(q), error)
         return
      end if
      if (off > unit_tolerance) bodies%note = place(group%file, group%line) // &
         "&bodies: q was normalised, its norm differed from 1 by " // amount(off) // &
         ": " // text_of(q)
      bodies%q = q
   end subroutine from_quaternion

   !> Divide out what few digits left, and beyond: whether it was no more than they leave.
   pure subroutine make_unit(q, off, good)
      real(dp), intent(inout) :: q(4)  !! not zero; as it is where it is a unit quaternion already
      real(dp), intent(out) :: off     !! how far |q| was from 1; at most 1 is measured
      logical, intent(out) :: good     !! off by 1e-3 at most
      real(dp) :: largest, norm
      largest = maxval(abs(q))
      norm = norm2(q/largest)
      off = min(abs(norm*min(largest, 2.0_dp) - 1), 1.0_dp)
      good = off <= largest_slack
      if (off > unit_tolerance) q = q/largest/norm
   end subroutine make_unit

   !> How far something is off, for a message: three digits, no blanks.
   function amount(off) result(text)
      real(dp), intent(in) :: off
      character(:), allocatable :: text
      character(11) :: digits
      write (digits, "(es9.2e2)") off
      if (off >= 1) digits = "more than 1"
      text = trim(adjustl(digits))
   end function amount

end module poinsot_scene_attitude
