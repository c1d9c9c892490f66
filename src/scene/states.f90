!> The bodies of a run as plain arrays: initial states, and states in the scene's own frame.
module poinsot_scene_states
   use, intrinsic :: iso_c_binding, only: c_int
   use poinsot_core_kinds, only: dp, i4, i8
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_core_status, only: poinsot_e_memory
   use poinsot_rotation_quaternion, only: quaternion_product, quaternion_conjugate, rotate_back
   use poinsot_rotation_random, only: random_quaternion, random_gaussian, stream_momentum
   use poinsot_scene_text, only: text_of
   use poinsot_scene_settings, only: scene_settings, body_group, body_total, rotor_of, &
      random_none, random_thermal
   implicit none(type, external)
   private
   public :: body_states, first_states, find_group, to_scene_frame

   !> State of the bodies that this process holds, in the principal frame: number first + 1 to
   !> first + n of the scene's. One process alone holds all.
   type :: body_states
      integer :: n = 0, first = 0
      integer :: total = 0                  !! bodies of the scene
      integer(c_int), allocatable :: group(:)  !! (n): which &bodies group, from 1
      integer(c_int), allocatable :: status(:) !! (n): of the last call
      real(dp), allocatable :: y(:, :)      !! (3, n)
      real(dp), allocatable :: q(:, :)      !! (4, n)
      real(dp), allocatable :: carry(:, :)  !! (7, n): compensated sums
      integer(i8), allocatable :: id(:)     !! (n): their numbers from 0, if they are not 0 to n - 1
   end type body_states

contains

   !> Where the bodies begin: as given, or drawn as a function of (seed, number of the body).
   !> Error: POINSOT_E_MEMORY.
   subroutine first_states(scene, states, error, from, to)
      type(scene_settings), intent(in) :: scene !! the typed scene
      type(body_states), intent(out) :: states
      type(poinsot_error), intent(inout) :: error
      integer, intent(in), optional :: from, to !! the bodies to hold; all, if not there
      integer :: i, n, code, last
      states%total = int(body_total(scene))
      n = states%total
      if (present(from) .and. present(to)) then
         states%first = from - 1
         n = to - states%first
      end if
      allocate (states%y(3, n), stat=code)
      if (code == 0) allocate (states%q(4, n), stat=code)
      if (code == 0) allocate (states%carry(7, n), stat=code)
      if (code == 0) allocate (states%group(n), stat=code)
      if (code == 0) allocate (states%status(n), stat=code)
      if (code /= 0) then
         call raise(error, poinsot_e_memory, &
                    scene%file // ": no memory for " // text_of(n) // " bodies")
         return
      end if
      states%n = n
      states%carry = 0
      states%status = 0
      last = 0
      do i = 1, size(scene%bodies)
         call fill(scene%bodies(i), i, scene%seed, last, states)
         last = last + int(scene%bodies(i)%count)
      end do
   end subroutine first_states

   !> The part of one group held here, after the `last` body of the groups before.
   subroutine fill(bodies, group, seed, last, states)
      type(body_group), intent(in) :: bodies
      integer, intent(in) :: group, last
      integer(i8), intent(in) :: seed
      type(body_states), intent(inout) :: states
      real(dp) :: normal(4)
      integer(i8) :: id
      integer :: j
      do j = max(1, last + 1 - states%first), min(states%n, last + int(bodies%count) - states%first)
         id = int(states%first + j, i8)
         states%group(j) = group
         states%y(:, j) = bodies%y
         states%q(:, j) = bodies%q
         if (allocated(bodies%file_q)) then
            states%y(:, j) = bodies%file_y(:, id - last)
            states%q(:, j) = bodies%file_q(:, id - last)
         end if
         if (bodies%random /= random_none) states%q(:, j) = random_quaternion(seed, id)
         if (bodies%turns_y) states%y(:, j) = rotate_back(states%q(:, j), bodies%y_space)
         if (bodies%random /= random_thermal) cycle
         normal(1:2) = random_gaussian(seed, id, 0_i8, stream_momentum)
         normal(3:4) = random_gaussian(seed, id, 0_i8, stream_momentum + 1_i4)
         ! roots first: I and kT may each be near the ends of the range
         states%y(:, j) = sqrt(bodies%moments)*sqrt(bodies%temperature)*normal(1:3) &
                           + rotor_of(bodies, 0.0_dp)
      end do
   end subroutine fill

   !> Which &bodies group a body belongs to; quickly found from the group of its neighbour.
   pure subroutine find_group(scene, number, group, before)
      type(scene_settings), intent(in) :: scene !! the typed scene
      integer(i8), intent(in) :: number         !! of the body, from 1
      integer, intent(inout) :: group           !! in: any; 0 at first
      integer(i8), intent(inout) :: before      !! bodies of the groups before
      if (group == 0 .or. number <= before) then
         group = 1
         before = 0
      end if
      do while (number > before + scene%bodies(group)%count)
         before = before + scene%bodies(group)%count
         group = group + 1
      end do
   end subroutine find_group

   !> Momentum and attitude of one body as the scene's own frame has them.
   pure subroutine to_scene_frame(bodies, y, q)
      type(body_group), intent(in) :: bodies     !! the body's group
      real(dp), intent(inout) :: y(3), q(4)      !! principal frame in, given frame out
      if (.not. bodies%turned) return
      y = matmul(bodies%axes, y)
      q = quaternion_product(q, quaternion_conjugate(bodies%frame))
   end subroutine to_scene_frame

end module poinsot_scene_states
