!> One &bodies group: moments from what was given, momentum and attitude into the principal frame.
module poinsot_scene_bodies
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_source, only: place
   use poinsot_scene_text, only: text_of
   use poinsot_effect_gyrostat, only: gyrostat
   use poinsot_scene_settings, only: scene_settings, body_group, random_none, random_uniform, &
      random_thermal
   use poinsot_scene_typed_group, only: typed_group, given, number_of, numbers_of, word_of, &
      integer_of, reject_key
   use poinsot_rotation_quaternion, only: quaternion_product, unit_tolerance
   use poinsot_scene_inertia, only: find_moments
   implicit none(type, external)
   private
   public :: build_bodies, add_rotors

   real(dp), parameter :: axis_slack = 1e-6_dp !! momentum about a zero moment, relative to |y|
   real(dp), parameter :: largest_slack = 1e-3_dp !! of |q|: what three or four digits lose

contains

   !> Check and convert one group. Error: POINSOT_E_SCENE naming file, line and key.
   subroutine build_bodies(group, bodies, error)
      type(typed_group), intent(in) :: group !! keys with their values
      type(body_group), intent(out) :: bodies
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: values(:)
      bodies%line = group%line
      call integer_of(group, "count", 1_i8, 2000000000_i8, bodies%count, error)
      if (.not. raised(error)) call find_moments(group, bodies, error)
      if (.not. raised(error)) call build_random(group, bodies, error)
      if (.not. raised(error)) call build_attitude(group, bodies, error)
      if (.not. raised(error)) call build_momentum(group, bodies, error)
      if (raised(error)) return
      call numbers_of(group, "position", values)
      bodies%position = values
      call numbers_of(group, "spacing", values)
      bodies%spacing = values
   end subroutine build_bodies

   !> random and temperature.
   subroutine build_random(group, bodies, error)
      type(typed_group), intent(in) :: group
      type(body_group), intent(inout) :: bodies
      type(poinsot_error), intent(inout) :: error
      select case (word_of(group, "random"))
      case ("uniform")
         bodies%random = random_uniform
      case ("thermal")
         bodies%random = random_thermal
      case default
         bodies%random = random_none
      end select
      bodies%temperature = number_of(group, "temperature")
      if (bodies%random == random_thermal .neqv. given(group, "temperature")) then
         call reject_key(group, "temperature", &
                       "goes with random = 'thermal' and is needed there", error)
      else if (bodies%temperature < 0) then
         call reject_key(group, "temperature", "= " // text_of(bodies%temperature) // &
                       " must not be negative", error)
      else if (bodies%random /= random_none .and. given(group, "q")) then
         call reject_key(group, "q", "is given, and random = '" // word_of(group, "random") // &
                       "' asks for random attitudes; leave one of them out", error)
      else if (bodies%random == random_thermal .and. &
               (given(group, "y") .or. given(group, "omega"))) then
         call reject_key(group, "random", &
                       "= 'thermal' draws the momenta; leave y and omega out", error)
      end if
   end subroutine build_random

   !> q: a unit quaternion, or one with few digits, which is made one.
   subroutine build_attitude(group, bodies, error)
      type(typed_group), intent(in) :: group
      type(body_group), intent(inout) :: bodies
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: q(:)
      real(dp) :: largest, norm, off
      character(11) :: digits
      call numbers_of(group, "q", q)
      largest = maxval(abs(q))
      if (largest <= 0) then
         call reject_key(group, "q", "is zero; no rotation is 1, 0, 0, 0", error)
         return
      end if
      norm = norm2(q/largest)
      off = norm*min(largest, 2.0_dp) - 1
      if (abs(off) > unit_tolerance) then
         write (digits, "(es9.2e2)") abs(off)
         if (largest > 2) digits = "more than 1"
         if (largest > 2 .or. abs(off) > largest_slack) then
            call reject_key(group, "q", "is not a unit quaternion, its length is off 1 by " // &
                       trim(adjustl(digits)) // "; up to 1e-3 is divided out, which makes it " // &
                       text_of(q/largest/norm), error)
            return
         end if
         q = q/largest/norm
         bodies%note = place(group%file, group%line) // "&bodies: q was off unit length by " // &
                       trim(adjustl(digits)) // "; used is " // text_of(q)
      end if
      bodies%q = q
      if (bodies%turned) bodies%q = quaternion_product(q, bodies%frame)
   end subroutine build_attitude

   !> y or omega, zero about an axis without inertia.
   subroutine build_momentum(group, bodies, error)
      type(typed_group), intent(in) :: group
      type(body_group), intent(inout) :: bodies
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: given_vector(:)
      real(dp) :: vector(3)
      character(:), allocatable :: key
      integer :: j
      if (given(group, "y") .and. given(group, "omega")) then
         call reject_key(group, "omega", "and y are both given; leave one of them out", error)
         return
      end if
      key = "y"
      if (given(group, "omega")) key = "omega"
      if (.not. given(group, key)) return
      call numbers_of(group, key, given_vector)
      vector = given_vector
      if (bodies%turned) vector = matmul(transpose(bodies%axes), vector)
      if (key == "omega") then
         if (any(abs(vector) > 1e150_dp .and. bodies%moments > 1e150_dp)) then
            call reject_key(group, key, "times the moments is beyond the range of numbers", error)
            return
         end if
         bodies%y = bodies%moments*vector ! and the rotor's, which is not known yet
         bodies%from_omega = .true.
         return
      end if
      bodies%y = vector
      ! about an axis without inertia nothing can turn; files have few digits
      where (bodies%moments <= 0 .and. abs(vector) <= axis_slack*norm2(vector)) bodies%y = 0
      do j = 1, 3
         if (bodies%moments(j) > 0 .or. abs(bodies%y(j)) <= 0) cycle
         call reject_key(group, &
                       "y", "has momentum " // text_of(vector(j)) // " about principal axis " // &
                       text_of(j) // &
                          ", whose moment is zero; up to 1e-6 of |y| is dropped there, " // &
                       "more cannot be", error)
         return
      end do
   end subroutine build_momentum

   !> The rotors of gyrostats, once the effects are known: a body whose angular velocity was given
   !> has
   !> the momentum I omega + rotor.
   subroutine add_rotors(scene)
      type(scene_settings), intent(inout) :: scene   !! its effects are built
      integer :: i, k
      do k = 1, size(scene%effects)
         select type (one => scene%effects(k)%made)
         class is (gyrostat)
            do i = 1, size(scene%bodies)
               if (.not. one%acts_on(i)) cycle
               associate (bodies => scene%bodies(i))
                  if (bodies%turned) then
                     bodies%rotor = bodies%rotor + matmul(transpose(bodies%axes), one%rotor)
                  else
                     bodies%rotor = bodies%rotor + one%rotor
                  end if
               end associate
            end do
         end select
      end do
      do i = 1, size(scene%bodies)
         if (scene%bodies(i)%from_omega) scene%bodies(i)%y = scene%bodies(i)%y &
            + scene%bodies(i)%rotor
      end do
   end subroutine add_rotors

end module poinsot_scene_bodies
