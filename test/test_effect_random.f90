!> Random numbers of the thermostat, and what it must leave behind: kT/2 on each axis that can turn,
!> for every kind of body, and Boltzmann's distribution of attitudes.
module test_effect_random
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, i4, i8, lanes
   use poinsot_core_error, only: poinsot_error
   use poinsot_effect_effect, only: effect_item, flow_effect
   use poinsot_effect_gaussian, only: gaussian_block
   use poinsot_effect_registry, only: make_effect
   use poinsot_effect_settings, only: number_setting
   use poinsot_rotation_random, only: philox_block, random_words
   use test_bodies, only: random_stream, start_stream, random_quaternion
   use test_expectation, only: expect
   use test_oracle_algebra, only: rotate
   use test_turning, only: bench, set_up, place, run, generic_moments_of, generic_y, generic_q
   implicit none(type, external)
   private
   public :: collect_random

contains

   subroutine collect_random(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("philox-published-vectors", test_philox), &
         new_unittest("philox-is-that-of-room-rotation", test_same_words), &
         new_unittest("gaussian-moments", test_gaussian), &
         new_unittest("gaussian-of-body-and-step-only", test_counter), &
         new_unittest("langevin-equipartition", test_equipartition), &
         new_unittest("langevin-attitudes", test_boltzmann), &
         new_unittest("langevin-without-temperature-is-drag", test_cold), &
         new_unittest("langevin-relaxation", test_relaxation), &
         new_unittest("drag-and-langevin-go-forward-only", test_forward)]
   end subroutine collect_random

   !> The three known answers of the Random123 distribution for philox4x32-10.
   subroutine test_philox(error)
      type(error_type), allocatable, intent(out) :: error
      integer(i8), parameter :: ones = 4294967295_i8
      integer(i8), parameter :: pi(4) = [int(z"243f6a88", i8), int(z"85a308d3", i8), &
         int(z"13198a2e", i8), &
         int(z"03707344", i8)]
      integer(i8), parameter :: pi_key(2) = [int(z"a4093822", i8), int(z"299f31d0", i8)]
      call one_vector([0_i8, 0_i8], [0_i8, 0_i8, 0_i8, 0_i8], [int(z"6627e8d5", i8), &
                      int(z"e169c58d", i8), int(z"bc57ac4c", i8), int(z"9b00dbd8", i8)], error)
      if (allocated(error)) return
      call one_vector([ones, ones], [ones, ones, ones, ones], [int(z"408f276d", i8), &
                      int(z"41c83b0e", i8), int(z"a20bc7c6", i8), int(z"6d5451fd", i8)], error)
      if (allocated(error)) return
      call one_vector(pi_key, pi, [int(z"d16cfe09", i8), int(z"94fdcceb", i8), &
                      int(z"5001e420", i8), int(z"24126ea1", i8)], error)
   end subroutine test_philox

   subroutine one_vector(key, counter, want, error)
      integer(i8), intent(in) :: key(2), counter(4), want(4)
      type(error_type), allocatable, intent(out) :: error
      integer(i8) :: c(lanes, 4), word(lanes, 4)
      c = spread(counter, 1, lanes)
      call philox_block(key, c, word)
      call expect(error, all(word == spread(want, 1, lanes)), "philox4x32-10")
   end subroutine one_vector

   subroutine test_same_words(error)
      type(error_type), allocatable, intent(out) :: error
      integer(i8) :: c(lanes, 4), word(lanes, 4), w(4)
      integer :: l
      integer(i8), parameter :: seed = 123456789012345_i8
      do l = 1, lanes
         c(l, :) = [int(l, i8), 0_i8, 77_i8, 5_i8 + 65536_i8*9_i8]
      end do
      call philox_block([iand(seed, 4294967295_i8), shiftr(seed, 32)], c, word)
      do l = 1, lanes
         call random_words(seed, int(l, i8), 77_i8 + 5_i8*4294967296_i8, 9_i4, w(1), &
                           w(2), w(3), w(4))
         call expect(error, all(word(l, :) == w), "words differ")
      end do
   end subroutine test_same_words

   !> Mean, variance, fourth moment and correlations of 3 x 204800 numbers: each off by 5 standard
   !> errors with probability 6e-7.
   subroutine test_gaussian(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: xi(lanes, 3), last(lanes, 3), m(3), v(3), k(3), c(3), s(3)
      integer(i8) :: id(lanes), step
      integer :: l
      integer, parameter :: n = 6400
      id = [(int(l, i8), l=1, lanes)]
      m = 0
      v = 0
      k = 0
      c = 0
      s = 0
      last = 0
      do step = 1, n
         call gaussian_block(42_i8, id, step, int(mod(step, 2_i8)), xi)
         m = m + sum(xi, 1)
         v = v + sum(xi**2, 1)
         k = k + sum(xi**4, 1)
         c = c + [sum(xi(:, 1)*xi(:, 2)), sum(xi(:, 2)*xi(:, 3)), sum(xi(:, 3)*xi(:, 1))]
         s = s + sum(xi*last, 1)
         last = cshift(xi, 1)
      end do
      associate (all_of => real(n*lanes, dp))
         call expect(error, maxval(abs(m))/sqrt(all_of) < 5, "mean")
         call expect(error, maxval(abs(v/all_of - 1))*sqrt(all_of/2) < 5, "variance")
         call expect(error, maxval(abs(k/all_of - 3))*sqrt(all_of/96) < 5, "fourth moment")
         call expect(error, maxval(abs([c, s]))/sqrt(all_of) < 5, "correlation")
      end associate
   end subroutine test_gaussian

   !> A body gets the same numbers in any lane; other bodies, steps, halves and seeds get others.
   subroutine test_counter(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: a(lanes, 3), b(lanes, 3)
      integer(i8) :: id(lanes)
      integer :: l
      id = [(int(l, i8) - 9_i8, l=1, lanes)]
      call gaussian_block(-3_i8, id, 5_i8, 0, a)
      call gaussian_block(-3_i8, id(lanes:1:-1), 5_i8, 0, b)
      call expect(error, all(a == b(lanes:1:-1, :)), "numbers depend on the lane")
      call gaussian_block(-3_i8, id, 5_i8, 1, b)
      call expect(error, all(a /= b), "halves are equal")
      call gaussian_block(-3_i8, id, 5_i8 + 2_i8**33, 0, b)
      call expect(error, all(a /= b), "steps are equal")
      call gaussian_block(-4_i8, id, 5_i8, 0, b)
      call expect(error, all(a /= b) .and. all(a(:lanes - 1, :) /= a(2:, :)), &
         "seeds or bodies are equal")
   end subroutine test_counter

   !> <y^2/I> = kT on each axis that can turn, 0 on one that cannot, for every kind of body in odd
   !> units. 102400 nearly independent samples an axis: 5 standard errors. 17 axes: a true
   !> thermostat fails with probability 1e-5 (for another seed).
   subroutine test_equipartition(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: moments(3, 6) = reshape([0.6_dp, 1.0_dp, 0.8_dp, 0.7_dp, 0.7_dp, &
         0.7_dp, &
         1.0_dp, 0.4_dp, 1.0_dp, 0.3_dp, 1.0_dp, 0.7_dp, 1.0_dp, 0.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, &
         0.05_dp], [3, 6])
      character(10), parameter :: kinds(6) = [character(10) :: "asymmetric", "sphere", &
         "symmetric", "flat", &
         "linear", "nearlinear"]
      real(dp), parameter :: unit = 1e-46_dp, temperature = 4e-21_dp, friction = 1e-33_dp, &
         h = 2e-13_dp
      integer, parameter :: blocks = 16, steps = 200
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      type(poinsot_error) :: refusal
      real(dp) :: heat(3), start(3)
      integer :: i, k, j, b, l
      allocate (effects(1))
      call make_effect("langevin", [number_setting("friction", [1.0_dp, 0.7_dp, 1.5_dp]*friction), &
         number_setting("temperature", [temperature])], effects(1)%it, refusal)
      do i = 1, 6
         call set_up(it, unit*moments(:, i), "exact", "strang", effects)
         call expect(error, it%good, it%message)
         it%block%seed = 7
         start = sqrt(temperature*unit*moments(:, i))
         heat = 0
         do b = 1, blocks
            call place(it, start, generic_q)
            it%block%id = [(int(l + lanes*b, i8), l=1, lanes)]
            call run(it, 0.0_dp, h, 0, 10)
            do k = 1, steps
               call run(it, 0.0_dp, h, 10 + k, 1)
               do j = 1, 3
                  heat(j) = heat(j) + sum((it%block%y(:, j)*it%class%inverse(j))*it%block%y(:, j))
               end do
            end do
            call expect(error, all(it%block%status == 0), "status: "//kinds(i))
         end do
         heat = heat/(temperature*blocks*steps*lanes)
         do j = 1, 3
            if (moments(j, i) > 0) then
               call expect(error, abs(heat(j) - 1) < 5*sqrt(2.0_dp/(blocks*steps*lanes)), &
                  "temperature: "//kinds(i))
            else
               call expect(error, all(it%block%y(:, j) == 0), &
                  "an axis without inertia was heated: "//kinds(i))
            end if
            if (allocated(error)) return
         end do
      end do
   end subroutine test_equipartition

   !> A dipole in a field at x = mu E/kT = 2: <cos> = coth x - 1/x and <cos^2> = 1 - 2 <cos>/x, by
   !> 512 independent bodies, 5 standard errors of their own scatter (probability 1e-6); h is short
   !> enough that order 2 does not show.
   subroutine test_boltzmann(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: blocks = 16, steps = 1500, resolve_auto = 300
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      type(poinsot_error) :: refusal
      type(random_stream) :: stream
      real(dp) :: first(lanes, blocks), second(lanes, blocks), x, want, direction(3)
      integer :: b, k, l
      allocate (effects(2))
      call make_effect("langevin", [number_setting("friction", [1.0_dp]), &
                       number_setting("temperature", [0.5_dp])], effects(1)%it, refusal)
      call make_effect("field", [number_setting("dipole", [0.0_dp, 1.0_dp, 0.0_dp]), &
         number_setting("strength", [0.0_dp, 0.0_dp, 1.0_dp])], effects(2)%it, refusal)
      call set_up(it, generic_moments_of, "exact", "strang", effects)
      call expect(error, it%good, it%message)
      it%block%seed = 11
      stream = start_stream(5)
      first = 0
      second = 0
      do b = 1, blocks
         call place(it, generic_y, generic_q)
         do l = 1, lanes
            it%block%q(l, :) = random_quaternion(stream)
         end do
         it%block%id = [(int(l + lanes*b, i8), l=1, lanes)]
         do k = 1, steps
            call run(it, 0.0_dp, 0.1_dp, k, 1)
            if (k <= resolve_auto) cycle
            do l = 1, lanes
               direction = rotate(it%block%q(l, :), [0.0_dp, 1.0_dp, 0.0_dp])
               first(l, b) = first(l, b) + direction(3)/(steps - resolve_auto)
               second(l, b) = second(l, b) + direction(3)**2/(steps - resolve_auto)
            end do
         end do
      end do
      x = 2
      want = 1/tanh(x) - 1/x
      call expect(error, within(first, want), "<cos>")
      call expect(error, within(second, 1 - 2*want/x), "<cos^2>")
   end subroutine test_boltzmann

   pure logical function within(samples, want)
      real(dp), intent(in) :: samples(:, :), want
      real(dp) :: mean, n
      n = size(samples)
      mean = sum(samples)/n
      within = abs(mean - want) < 5*sqrt(sum((samples - mean)**2)/(n*(n - 1))) .and. &
         abs(mean - want) < 0.02_dp
   end function within

   !> kT = 0: the bits of drag with the same friction.
   subroutine test_cold(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it, other
      type(effect_item), allocatable :: effects(:)
      type(poinsot_error) :: refusal
      allocate (effects(1))
      call make_effect("langevin", [number_setting("friction", [0.3_dp]), &
                       number_setting("temperature", [0.0_dp])], effects(1)%it, refusal)
      call set_up(it, generic_moments_of, "exact", "strang", effects)
      call make_effect("drag", [number_setting("friction", [0.3_dp])], effects(1)%it, refusal)
      call set_up(other, generic_moments_of, "exact", "strang", effects)
      call place(it, generic_y, generic_q)
      call place(other, generic_y, generic_q)
      call run(it, 0.0_dp, 0.1_dp, 0, 20)
      call run(other, 0.0_dp, 0.1_dp, 0, 20)
      call expect(error, all(it%block%y == other%block%y) .and. &
                 all(it%block%q == other%block%q), "not drag")
   end subroutine test_cold

   !> A sphere's mean momentum decays as exp(-friction t/I): 3200 bodies, 5 standard errors
   !> (probability 6e-7 for each of three axes).
   subroutine test_relaxation(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      type(effect_item), allocatable :: effects(:)
      type(poinsot_error) :: refusal
      real(dp) :: sum_l(3), start(3), want(3), spread
      integer :: b, l
      integer, parameter :: blocks = 100
      allocate (effects(1))
      call make_effect("langevin", [number_setting("friction", [0.5_dp]), &
                       number_setting("temperature", [0.1_dp])], effects(1)%it, refusal)
      call set_up(it, [2.0_dp, 2.0_dp, 2.0_dp], "exact", "strang", effects)
      it%block%seed = 3
      start = rotate(generic_q, generic_y)
      sum_l = 0
      do b = 1, blocks
         call place(it, generic_y, generic_q)
         it%block%id = [(int(l + lanes*b, i8), l=1, lanes)]
         call run(it, 0.0_dp, 0.25_dp, 0, 8)
         do l = 1, lanes
            sum_l = sum_l + rotate(it%block%q(l, :), it%block%y(l, :))/(blocks*lanes)
         end do
      end do
      want = start*exp(-0.5_dp*2.0_dp/2.0_dp)
      spread = sqrt(0.1_dp*2.0_dp*(1 - exp(-2*0.5_dp*2.0_dp/2.0_dp))/(blocks*lanes))
      call expect(error, maxval(abs(sum_l - want)) < 5*spread, "decay of the mean")
   end subroutine test_relaxation

   subroutine test_forward(error)
      type(error_type), allocatable, intent(out) :: error
      type(effect_item) :: hot, plain
      type(poinsot_error) :: refusal
      call make_effect("langevin", [number_setting("friction", [0.3_dp]), &
                       number_setting("temperature", [0.0_dp])], hot%it, refusal)
      call make_effect("drag", [number_setting("friction", [0.3_dp])], plain%it, refusal)
      call expect(error, forward(hot) .and. forward(plain), "noise and drag have no way back")
   end subroutine test_forward

   logical function forward(item)
      type(effect_item), intent(in) :: item
      forward = .false.
      select type (one => item%it)
      class is (flow_effect)
         forward = one%only_forward()
      end select
   end function forward

end module test_effect_random
