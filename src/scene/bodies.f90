!> One &bodies group: moments from the given data, momentum and attitude transformed to the
!> principal frame.
module poinsot_scene_bodies
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_source, only: place
   use poinsot_scene_text, only: text_of
   use poinsot_core_time_table, only: time_table
   use poinsot_effect_gyrostat, only: gyrostat
   use poinsot_scene_settings, only: scene_settings, body_group, rotor_of, random_none, &
      random_uniform, random_thermal
   use poinsot_scene_typed_group, only: typed_group, given, number_of, numbers_of, word_of, &
      integer_of, reject_key
   use poinsot_rotation_quaternion, only: quaternion_product, rotate_back, unit_tolerance
   use poinsot_scene_attitude, only: build_attitude, make_unit, amount
   use poinsot_scene_inertia, only: find_moments
   use poinsot_scene_states_file, only: read_states
   use poinsot_scene_table, only: file_beside
   implicit none(type, external)
   private
   public :: build_bodies, add_rotors

   real(dp), parameter :: axis_slack = 1e-6_dp !! momentum about a zero moment, relative to |y|
   integer(i8), parameter :: most_bodies = 2000000000_i8

contains

   !> Check and convert one group. Error: POINSOT_E_SCENE naming file, line and key.
   subroutine build_bodies(group, bodies, error)
      type(typed_group), intent(in) :: group !! keys with their values
      type(body_group), intent(out) :: bodies
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: values(:)
      bodies%line = group%line
      bodies%convention = word_of(group, "convention")
      bodies%drawn = word_of(group, "drawn")
      call integer_of(group, "count", 1_i8, most_bodies, bodies%count, error)
      if (.not. raised(error)) call build_lattice(group, bodies, error)
      if (.not. raised(error)) call find_moments(group, bodies, error)
      if (.not. raised(error) .and. given(group, "file")) call build_states(group, bodies, error)
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
                       "is required with random = 'thermal', and only there", error)
      else if (bodies%temperature < 0) then
         call reject_key(group, "temperature", "= " // text_of(bodies%temperature) // &
                       " must not be negative", error)
      else if (bodies%random == random_thermal .and. &
               (given(group, "y") .or. given(group, "omega") .or. given(group, "y_space"))) then
         call reject_key(group, "random", &
                       "= 'thermal' draws the momenta; leave y, omega and y_space out", error)
      end if
   end subroutine build_random

   !> y, omega or y_space, zero about an axis without inertia.
   subroutine build_momentum(group, bodies, error)
      type(typed_group), intent(in) :: group
      type(body_group), intent(inout) :: bodies
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: values(:)
      real(dp) :: vector(3)
      character(:), allocatable :: key
      call find_momentum(group, key, error)
      if (raised(error) .or. key == "") return
      call numbers_of(group, key, values)
      vector = values
      select case (key)
      case ("omega")
         if (bodies%turned) vector = matmul(transpose(bodies%axes), vector)
         if (any(abs(vector) > 1e150_dp .and. bodies%moments > 1e150_dp)) then
            call reject_key(group, key, "times the moments is beyond the range of numbers", error)
            return
         end if
         bodies%y = bodies%moments*vector ! and the rotor's, which is not known yet
         bodies%from_omega = .true.
         return
      case ("y_space")
         if (bodies%random /= random_none) then
            call drawn_attitudes(group, bodies, vector, error)
            return
         end if
         vector = rotate_back(bodies%q, vector)
      case default
         if (bodies%turned) vector = matmul(transpose(bodies%axes), vector)
      end select
      call drop_idle(bodies%moments, vector, bodies%y, values)
      if (size(values) > 0) call reject_key(group, key, idle_words(values), error)
   end subroutine build_momentum

   !> Which of the three keys gives the momentum; "" for none.
   subroutine find_momentum(group, key, error)
      type(typed_group), intent(in) :: group
      character(:), allocatable, intent(out) :: key
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: ways(3) = [character(7) :: "y", "omega", "y_space"]
      integer :: i
      key = ""
      do i = 1, size(ways)
         if (.not. given(group, trim(ways(i)))) cycle
         if (key /= "") then
            call reject_key(group, trim(ways(i)), "and " // key // &
               " are both given; leave one of them out", error)
            return
         end if
         key = trim(ways(i))
      end do
   end subroutine find_momentum

   !> One momentum in space for bodies whose attitudes are drawn.
   subroutine drawn_attitudes(group, bodies, y_space, error)
      type(typed_group), intent(in) :: group
      type(body_group), intent(inout) :: bodies
      real(dp), intent(in) :: y_space(3)
      type(poinsot_error), intent(inout) :: error
      if (any(bodies%moments <= 0)) then
         call reject_key(group, "y_space", &
            "of bodies with an axis without inertia needs their " // &
            "attitude, and random = 'uniform' draws it; give y", error)
         return
      end if
      bodies%turns_y = .true.
      bodies%y_space = y_space
   end subroutine drawn_attitudes

   !> Momentum about an axis without inertia: what few digits leave is dropped; of more, the axis
   !> and
   !> how much.
   pure subroutine drop_idle(moments, vector, y, found)
      real(dp), intent(in) :: moments(3), vector(3)  !! principal frame
      real(dp), intent(out) :: y(3)                  !! vector without what is dropped
      real(dp), allocatable, intent(out) :: found(:) !! axis and momentum; size 0: nothing is left
      integer :: j
      allocate (found(0))
      y = vector
      where (moments <= 0 .and. abs(vector) <= axis_slack*norm2(vector)) y = 0
      do j = 3, 1, -1
         if (moments(j) <= 0 .and. abs(y(j)) > 0) found = [real(j, dp), vector(j)]
      end do
   end subroutine drop_idle

   function idle_words(found) result(text)
      real(dp), intent(in) :: found(2)
      character(:), allocatable :: text
      text = "has momentum " // text_of(found(2)) // " about principal axis " // &
         text_of(nint(found(1))) // ", whose moment is zero; up to 1e-6 of |y| is dropped " // &
         "there, more is not possible"
   end function idle_words

   !> lattice, and the count that it makes.
   subroutine build_lattice(group, bodies, error)
      type(typed_group), intent(in) :: group
      type(body_group), intent(inout) :: bodies
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: side(:)
      if (.not. given(group, "lattice")) return
      call numbers_of(group, "lattice", side)
      if (any(side < 1) .or. any(abs(side - anint(side)) > 0) .or. &
          product(min(side, 1e9_dp)) > real(most_bodies, dp)) then
         call reject_key(group, "lattice", "is not three positive integers with a product " // &
            "of at most " // &
            text_of(most_bodies) // " bodies", error)
      else if (given(group, "count") .and. bodies%count /= product(nint(side, i8))) then
         call reject_key(group, "count", "= " // text_of(bodies%count) // &
            ", but lattice makes " // &
            text_of(product(nint(side, i8))) // " bodies; leave count out", error)
      else
         bodies%lattice = nint(side)
         bodies%count = product(nint(side, i8))
      end if
   end subroutine build_lattice

   !> file: the states of all bodies.
   subroutine build_states(group, bodies, error)
      type(typed_group), intent(in) :: group
      type(body_group), intent(inout) :: bodies
      type(poinsot_error), intent(inout) :: error
      type(poinsot_error) :: refused
      character(*), parameter :: others(7) = [character(10) :: "q", "euler", "axis_angle", "y", &
                                              "omega", "y_space", "random"]
      integer, allocatable :: lines(:)
      integer :: i
      do i = 1, size(others)
         if (.not. given(group, trim(others(i)))) cycle
         call reject_key(group, "file", "and " // trim(others(i)) // " are both given; the file " &
            // "has attitudes and momenta", error)
         return
      end do
      if (len(word_of(group, "file")) == 0) then
         call reject_key(group, "file", "is empty; name a CSV file with q0..q3 and y1..y3", error)
         return
      end if
      bodies%file = file_beside(group%file, word_of(group, "file"))
      call read_states(bodies%file, bodies%file_q, bodies%file_y, lines, refused)
      if (raised(refused)) then
         call reject_key(group, "file", "refused: " // refused%message, error)
      else if ((given(group, "count") .or. given(group, "lattice")) .and. &
               bodies%count /= size(lines)) then
         call reject_key(group, "file", "has " // text_of(size(lines)) // " bodies, the group " // &
            text_of(bodies%count) // "; leave count out", error)
      else
         bodies%count = size(lines)
         call check_states(group, lines, bodies, error)
      end if
   end subroutine build_states

   !> Each state as one of a group: unit quaternions, principal frame, nothing about idle axes.
   subroutine check_states(group, lines, bodies, error)
      type(typed_group), intent(in) :: group
      integer, intent(in) :: lines(:)
      type(body_group), intent(inout) :: bodies
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: found(:)
      real(dp) :: off, vector(3)
      logical :: good
      integer :: i, mended
      mended = 0
      do i = 1, size(lines)
         associate (q => bodies%file_q(:, i))
            good = maxval(abs(q)) > 0
            off = 1
            if (good) call make_unit(q, off, good)
            if (.not. good) then
               call reject_key(group, "file", "refused: " // bodies%file // ":" // &
                  text_of(lines(i)) // ": q is not a unit quaternion, its norm differs " // &
                  "from 1 by " // amount(off) // "; up to 1e-3 is normalised", error)
               return
            end if
            if (off > unit_tolerance) mended = mended + 1
            if (bodies%turned) q = quaternion_product(q, bodies%frame)
         end associate
         vector = bodies%file_y(:, i)
         if (bodies%turned) vector = matmul(transpose(bodies%axes), vector)
         call drop_idle(bodies%moments, vector, bodies%file_y(:, i), found)
         if (size(found) == 0) cycle
         call reject_key(group, "file", "refused: " // bodies%file // ":" // text_of(lines(i)) // &
            ": y " // idle_words(found), error)
         return
      end do
      if (mended > 0) bodies%note = place(group%file, group%line) // "&bodies: " // &
         text_of(mended) // " quaternions of " // bodies%file // &
         " were off unit norm by up to 1e-3, and were normalised"
   end subroutine check_states

   !> The rotors of gyrostats, once the effects are known: a body whose angular velocity was given
   !> has the momentum I omega + rotor.
   subroutine add_rotors(scene)
      type(scene_settings), intent(inout) :: scene   !! its effects are built
      type(time_table) :: table
      integer :: i, k
      do k = 1, size(scene%effects)
         select type (one => scene%effects(k)%made)
         class is (gyrostat)
            do i = 1, size(scene%bodies)
               if (.not. one%acts_on(i)) cycle
               associate (bodies => scene%bodies(i))
                  if (allocated(one%table)) then
                     table = one%table
                     if (bodies%turned) table%values = matmul(transpose(bodies%axes), table%values)
                     call bodies%rotor_tables%append(table)
                  else if (bodies%turned) then
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
            + rotor_of(scene%bodies(i), 0.0_dp)
      end do
   end subroutine add_rotors

end module poinsot_scene_bodies
