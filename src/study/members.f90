!> The initial states of a study: the scene's own, and similar ones, so that the error is not that
!> of one atypical orbit.
module poinsot_study_members
   use, intrinsic :: iso_c_binding, only: c_int
   use poinsot_core_kinds, only: dp, i4, i8
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_memory, poinsot_e_size
   use poinsot_rotation_quaternion, only: quaternion_product, normalise, rotate
   use poinsot_rotation_random, only: random_uniform, random_direction, random_quaternion
   use poinsot_scene_settings, only: scene_settings, body_total
   use poinsot_scene_states, only: body_states, first_states
   use poinsot_scene_text, only: text_of
   implicit none(type, external)
   private
   public :: member_set, draw_members, repeat_members, any_direction

   real(dp), parameter :: any_direction = 4 !! a spread beyond pi: directions and attitudes are
      !! uniform
   real(dp), parameter :: speed_share = 0.05_dp !! momenta vary by this part, at spreads up to 1

   !> Initial states in the principal frame.
   type :: member_set
      integer :: n = 0                        !! bodies in all
      integer :: given = 0                      !! the first of them are the scene's own
      integer :: together = 1 !! bodies of one system: 1, or those that see each other
      integer(c_int), allocatable :: group(:) !! (n): which &bodies group, from 1
      real(dp), allocatable :: y(:, :)        !! (3, n): angular momenta
      real(dp), allocatable :: q(:, :)        !! (4, n): attitudes
   end type member_set

contains

   !> The scene's bodies, or some of them if there are more than `wanted`; then copies of them
   !> turned by random angles up to `spread` until there are `wanted`. Where bodies see each other,
   !> whole scenes are copied instead. Errors: POINSOT_E_MEMORY; POINSOT_E_SIZE for too many coupled
   !> bodies.
   subroutine draw_members(scene, coupled, wanted, spread, members, error)
      type(scene_settings), intent(in) :: scene
      logical, intent(in) :: coupled            !! an effect couples the bodies
      integer, intent(in) :: wanted             !! how many
      real(dp), intent(in) :: spread            !! radians; any_direction: uniform
      type(member_set), intent(out) :: members
      type(poinsot_error), intent(inout) :: error
      type(body_states) :: first
      integer :: i, n, from, code
      call first_states(scene, first, error)
      if (raised(error)) return
      if (coupled .and. first%n > 4096) then
         call raise(error, poinsot_e_size, scene%file // ": " // text_of(first%n) // &
                    " bodies that see each other are too many to study; up to 4096")
         return
      end if
      members%together = merge(first%n, 1, coupled)
      n = wanted
      if (coupled) n = first%n*min(4, max(1, wanted/first%n + 1))
      allocate (members%group(n), stat=code)
      if (code == 0) allocate (members%y(3, n), stat=code)
      if (code == 0) allocate (members%q(4, n), stat=code)
      if (code /= 0) then
         call raise(error, poinsot_e_memory, "no memory for " // text_of(n) // " initial states")
         return
      end if
      members%n = n
      members%given = min(n, first%n)
      do i = 1, n
         from = 1 + mod(i - 1, first%n)
         if (first%n > n) from = 1 + int(real(i - 1, dp)*(first%n - 1)/max(n - 1, 1))
         members%group(i) = first%group(from)
         members%y(:, i) = first%y(:, from)
         members%q(:, i) = first%q(:, from)
         if (i > members%given) call disturb(scene%bodies(members%group(i))%moments, spread, &
                                           scene%seed, int(i, i8), members%y(:, i), members%q(:, i))
      end do
      associate (unused => body_total(scene))
      end associate
   end subroutine draw_members

   !> Another state of the same body: momentum and attitude each turned by a random angle.
   subroutine disturb(moments, spread, seed, id, y, q)
      real(dp), intent(in) :: moments(3), spread
      integer(i8), intent(in) :: seed, id
      real(dp), intent(inout) :: y(3), q(4)
      real(dp) :: size_before, u(2), unit, turned(3)
      integer(i8), parameter :: other = 715517_i8 ! not the seed that drew the states themselves
      unit = maxval(abs(y))
      u = random_uniform(seed + other, id, 0_i8, 8_i4)
      if (spread >= any_direction) then
         q = random_quaternion(seed + other, id)
      else
         q = normalise(quaternion_product(q, turn_about(random_direction(seed + other, id), &
            spread*u(1))))
      end if
      if (.not. unit > 0) return
      y = y/unit
      size_before = norm2(y)
      if (spread >= any_direction) then
         turned = size_before*random_direction(seed - other, id)
      else
         turned = rotate(turn_about(random_direction(seed - other, id), spread*u(2)), y)
         size_before = size_before*(1 + speed_share*min(spread, 1.0_dp)*(2*u(1) - 1))
      end if
      where (.not. moments > 0) turned = 0
      if (norm2(turned) > 0.1_dp*size_before) y = turned*(size_before/norm2(turned))
      y = unit*y
   end subroutine disturb

   !> The turn by an angle about a unit vector.
   pure function turn_about(axis, angle) result(q)
      real(dp), intent(in) :: axis(3), angle
      real(dp) :: q(4)
      q = [cos(0.5_dp*angle), sin(0.5_dp*angle)*axis]
   end function turn_about

   !> The same states again and again until there are n: an ensemble to be timed.
   subroutine repeat_members(members, n, many)
      type(member_set), intent(in) :: members
      integer, intent(in) :: n
      type(member_set), intent(out) :: many
      integer :: i, from
      many%n = n
      many%given = n
      many%together = members%together
      allocate (many%group(n), many%y(3, n), many%q(4, n))
      do i = 1, n
         from = 1 + mod(i - 1, members%n)
         many%group(i) = members%group(from)
         many%y(:, i) = members%y(:, from)
         many%q(:, i) = members%q(:, from)
      end do
   end subroutine repeat_members

end module poinsot_study_members
