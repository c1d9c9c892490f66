!> Crowds for the tests of the ensemble: classes with three distinct moments in every order, tensors
!> off their principal axes, a flat and a linear body; states; and plans.
module test_crowd
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_tensor_class, add_effect, &
      set_option
   use poinsot_effect_settings, only: setting
   use poinsot_effect_settings_text, only: read_settings
   use test_bodies, only: random_quaternion, random_stream, start_stream, uniform
   implicit none(type, external)
   private
   public :: crowd, make_crowd, plain_plan, mixed_plan, with_effect, class_count, &
      same_bits, turned_tensor

   integer, parameter :: class_count = 9

   !> Bodies in the native layout, with room for a fourth component.
   type :: crowd
      integer :: n = 0
      real(dp), allocatable :: y(:, :), q(:, :)   !! (3, n), (4, n)
      integer, allocatable :: class(:)            !! from 1
   end type crowd

   real(dp), parameter :: sorted(3) = [0.6_dp, 0.8_dp, 1.1_dp]
   integer, parameter :: orders(3, 6) = reshape([1, 2, 3, 2, 3, 1, 3, 1, 2, 2, 1, 3, 1, 3, 2, 3, &
      2, 1], [3, 6])

contains

   !> n bodies, classes mixed, momentum about 1 (none about the axis of the linear class 8).
   subroutine make_crowd(n, it)
      integer, intent(in) :: n
      type(crowd), intent(out) :: it
      type(random_stream) :: stream
      integer :: i, j
      it%n = n
      allocate (it%y(3, n), it%q(4, n), it%class(n))
      stream = start_stream(7)
      do i = 1, n
         it%class(i) = 1 + int(class_count*uniform(stream))
         do j = 1, 3
            it%y(j, i) = 2*uniform(stream) - 1
         end do
         if (it%class(i) == 8) it%y(3, i) = 0
         it%q(:, i) = random_quaternion(stream)
      end do
   end subroutine make_crowd

   !> A tensor with off-diagonal elements.
   pure function turned_tensor() result(t)
      real(dp) :: t(3, 3)
      t = reshape([0.9_dp, 0.1_dp, -0.05_dp, 0.1_dp, 0.7_dp, 0.08_dp, -0.05_dp, 0.08_dp, 1.0_dp], &
         [3, 3])
   end function turned_tensor

   !> One class, given layout; ready.
   subroutine plain_plan(moments, layout, plan)
      real(dp), intent(in) :: moments(3)
      character(*), intent(in) :: layout
      type(poinsot_plan), intent(out) :: plan
      type(poinsot_error) :: error
      integer :: number
      call add_class(plan, moments, number, error)
      call set_option(plan, "layout", layout, error)
      call make_ready(plan, error)
      if (raised(error)) error stop "plain_plan"
   end subroutine plain_plan

   !> All classes: six orders of three moments, a flat body, a linear one, a tensor. Not ready yet.
   subroutine mixed_plan(plan)
      type(poinsot_plan), intent(out) :: plan
      type(poinsot_error) :: error
      integer :: k, number
      do k = 1, 6
         call add_class(plan, sorted(orders(:, k)), number, error)
      end do
      call add_class(plan, [0.5_dp, 0.9_dp, 0.4_dp], number, error)
      call add_class(plan, [0.7_dp, 0.7_dp, 0.0_dp], number, error)
      call add_tensor_class(plan, turned_tensor(), number, error)
      if (raised(error) .or. number /= class_count) error stop "mixed_plan"
   end subroutine mixed_plan

   !> Add an effect from a text.
   subroutine with_effect(plan, name, text)
      type(poinsot_plan), intent(inout) :: plan
      character(*), intent(in) :: name, text
      type(setting), allocatable :: settings(:)
      type(poinsot_error) :: error
      call read_settings(text, settings, error)
      if (.not. raised(error)) call add_effect(plan, name, settings, error)
      if (raised(error)) error stop "with_effect"
   end subroutine with_effect

   !> Equal to the last bit.
   pure logical function same_bits(a, b)
      real(dp), intent(in) :: a(:, :), b(:, :)
      same_bits = all(transfer(a, [0_i8]) == transfer(b, [0_i8]))
   end function same_bits

end module test_crowd
