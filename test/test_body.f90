!> Room body: moments, kinds, tensors, shapes and invariants; extreme scales; refusals.
module test_body
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_positive_inf
   use testdrive, only: new_unittest, unittest_type, error_type
   use test_body_series, only: collect_body_series
   use test_body_slack, only: collect_body_slack
   use test_expectation, only: within, expect, refused, accepted
   use poinsot_core_kinds, only: dp, i4, i8
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_size, poinsot_e_method
   use poinsot_core_error, only: poinsot_error
   use poinsot_rotation, only: hat, identity_matrix, determinant, to_matrix, random_uniform, &
      random_quaternion, random_direction
   use poinsot_body_moments, only: check_moments, kind_of_body, kind_name, describe_body, is_flat, &
      symmetry_axis, mass_spread, ascending_order, kind_at_rest, kind_spherical, kind_symmetric, &
      kind_asymmetric, kind_flat, kind_linear
   use poinsot_body_inertia, only: principal_axes, point_mass_tensor, parallel_axis, &
      tensor_of_axes
   use poinsot_body_shapes, only: shape_moments, shape_names, shape_count, shape_help, &
      shape_sizes, name_length
   use poinsot_body_invariants, only: check_momentum, angular_velocity, kinetic_energy, casimir, &
      space_momentum, degrees_of_freedom
   implicit none(type, external)
   private
   public :: collect_body

   integer(i8), parameter :: seed = 1850_i8
   real(dp), parameter :: eps = epsilon(1._dp)
   real(dp), parameter :: scales(6) = [1e-280_dp, 1e-46_dp, 1e-15_dp, 1._dp, 1e15_dp, 1e150_dp]

contains

   subroutine collect_body(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      type(unittest_type), allocatable :: series(:), slack(:)
      call collect_body_series(series)
      call collect_body_slack(slack)
      testsuite = [ &
         new_unittest("moments-accepted", test_accepted), &
         new_unittest("moments-refused", test_refused), &
         new_unittest("kinds", test_kinds), &
         new_unittest("kind-words", test_words), &
         new_unittest("mass-spread", test_spread), &
         new_unittest("principal-axes", test_axes), &
         new_unittest("principal-axes-deterministic", test_axes_deterministic), &
         new_unittest("principal-axes-of-special-bodies", test_special_axes), &
         new_unittest("principal-axes-refusals", test_axes_refusals), &
         new_unittest("point-masses", test_point_masses), &
         new_unittest("point-mass-refusals", test_point_mass_refusals), &
         new_unittest("parallel-axis", test_parallel_axis), &
         new_unittest("solids", test_solids), &
         new_unittest("molecules", test_molecules), &
         new_unittest("shape-refusals", test_shape_refusals), &
         new_unittest("energy-and-casimir", test_invariants), &
         new_unittest("momentum-refusals", test_momentum), &
         new_unittest("degrees-of-freedom", test_freedom), &
         series, slack]
   end subroutine collect_body

   !> Moments of a body with random positive d_k over six decades.
   pure function some_moments(id) result(moments)
      integer(i8), intent(in) :: id
      real(dp) :: moments(3)
      real(dp) :: d(3)
      d = some_spread(id)
      moments = [d(2) + d(3), d(3) + d(1), d(1) + d(2)]
   end function some_moments

   pure function some_spread(id) result(d)
      integer(i8), intent(in) :: id
      real(dp) :: d(3)
      real(dp) :: u(4)
      u(1:2) = random_uniform(seed, id, 0_i8, 100_i4)
      u(3:4) = random_uniform(seed, id, 0_i8, 101_i4)
      d = 10**(6*u(1:3) - 6)
   end function some_spread

   subroutine test_accepted(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      integer(i8) :: k
      integer :: i
      do k = 1, 500
         call check_moments(some_moments(k)*scales(1 + mod(k, 6_i8)), refusal)
         call accepted(error, refusal)
      end do
      do i = 1, size(scales)
         call check_moments(scales(i)*[1._dp, 1._dp, 0._dp], refusal)
         call check_moments(scales(i)*[.3_dp, .1_dp + .2_dp, .6_dp], refusal) ! flat to round-off
         call check_moments(scales(i)*[.1_dp, .3_dp, .2_dp], refusal)
         call check_moments(scales(i)*[1._dp, 1e-14_dp, 1._dp], refusal)
         call check_moments(scales(i)*[1._dp, 1._dp + eps, 0._dp], refusal)
         call accepted(error, refusal)
      end do
   end subroutine test_accepted

   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      integer :: i
      do i = 1, size(scales)
         call check_moments(scales(i)*[1._dp, -1e-3_dp, 1._dp], refusal)
         call refused(error, refusal, poinsot_e_domain, "I2 is negative")
         call check_moments(scales(i)*[1._dp, 2.003_dp, 1._dp], refusal)
         call refused(error, refusal, poinsot_e_domain, "I2 exceeds the sum")
         call check_moments(scales(i)*[1._dp, 1e-14_dp, 1.0011_dp], refusal)
         call refused(error, refusal, poinsot_e_domain, "I3 exceeds the sum")
         call check_moments(scales(i)*[0._dp, 1.0011_dp, 1._dp], refusal)
         call refused(error, refusal, poinsot_e_domain, "I2 exceeds the sum")
         call check_moments(scales(i)*[1._dp, 0._dp, 0._dp], refusal)
         call refused(error, refusal, poinsot_e_domain, "I1 is the only one")
      end do
      call check_moments([0._dp, 0._dp, 0._dp], refusal)
      call refused(error, refusal, poinsot_e_domain, "all are zero")
      call check_moments([1._dp, 1._dp, ieee_value(1._dp, ieee_quiet_nan)], refusal)
      call refused(error, refusal, poinsot_e_domain, "I3 is not finite")
      call check_moments([ieee_value(1._dp, ieee_positive_inf), -1._dp, 1._dp], refusal)
      call refused(error, refusal, poinsot_e_domain, "I1 is not finite")
      call check_moments([1e-310_dp, 1e-310_dp, 1e-310_dp], refusal)
      call refused(error, refusal, poinsot_e_domain, "I1 is too small")
      call check_moments([1.25_dp, 2.5_dp, 4._dp], refusal)
      call refused(error, refusal, poinsot_e_domain, "(1.25, 2.5, 4.0)")
   end subroutine test_refused

   !> Every kind, at every scale and in every order of the axes.
   subroutine test_kinds(error)
      type(error_type), allocatable, intent(out) :: error
      integer, parameter :: orders(3, 6) = reshape([1, 2, 3, 1, 3, 2, 2, 1, 3, 2, 3, 1, 3, 1, 2, &
         3, 2, 1], [3, 6])
      real(dp), parameter :: examples(3, 8) = reshape([1._dp, 1._dp, 1._dp, .7_dp, .7_dp, 1._dp, &
         .7_dp, 1._dp, 1._dp, .6_dp, .8_dp, 1._dp, .4_dp, .6_dp, 1._dp, 0._dp, 1._dp, 1._dp, &
         .5_dp, .5_dp, 1._dp, 1e-14_dp, 1._dp, 1._dp], [3, 8])
      integer, parameter :: kinds(8) = [kind_spherical, kind_symmetric, kind_symmetric, &
         kind_asymmetric, kind_flat, kind_linear, kind_symmetric, kind_symmetric]
      integer, parameter :: axes(8) = [0, 3, 1, 0, 0, 1, 3, 1]
      logical, parameter :: flat(8) = [.false., .false., .false., .false., .true., .true., &
         .true., .false.]
      real(dp) :: m(3)
      integer :: i, j, k, axis
      do k = 1, 8
         do j = 1, 6
            do i = 1, size(scales)
               m = scales(i)*examples(orders(:, j), k)
               axis = 0
               if (axes(k) > 0) axis = findloc(orders(:, j), axes(k), dim=1)
               call expect(error, kind_of_body(m) == kinds(k), "kind: "//describe_body(m))
               call expect(error, symmetry_axis(m) == axis, "axis: "//describe_body(m))
               call expect(error, is_flat(m) .eqv. flat(k), "flat: "//describe_body(m))
            end do
         end do
      end do
      m = [1._dp, 1 + 8*eps, 1 - 8*eps]
      call expect(error, kind_of_body(m) == kind_spherical, "spherical to round-off")
      call expect(error, kind_of_body(m, tolerance=0._dp) == kind_asymmetric, "no tolerance")
      m = [1._dp, 1 + 1e-13_dp, 1.5_dp]
      call expect(error, kind_of_body(m) == kind_asymmetric, "symmetric only nearly")
      call expect(error, kind_of_body(m, tolerance=1e-12_dp) == kind_symmetric, "own tolerance")
      call expect(error, kind_of_body(m, y=[0._dp, 0._dp, 0._dp]) == kind_at_rest, "at rest")
      call expect(error, kind_of_body(m, y=[0._dp, 1e-300_dp, 0._dp]) == kind_asymmetric, &
         "not at rest")
   end subroutine test_kinds

   subroutine test_words(error)
      type(error_type), allocatable, intent(out) :: error
      call expect(error, describe_body([2._dp, 1._dp, 2._dp]) == "symmetric about axis 2", &
         "prolate")
      call expect(error, describe_body([1._dp, 1._dp, 2._dp]) == "symmetric about axis 3, flat", &
         "disc")
      call expect(error, describe_body([2._dp, 2._dp, 0._dp]) == "linear along axis 3", "rod")
      call expect(error, describe_body([1._dp, 2._dp, 3._dp]) == "flat", "flat")
      call expect(error, describe_body([3._dp, 2._dp, 2.5_dp]) == "asymmetric", "asymmetric")
      call expect(error, describe_body([3._dp, 3._dp, 3._dp]) == "spherical", "spherical")
      call expect(error, describe_body([1._dp, 2._dp, 3._dp], [0._dp, 0._dp, 0._dp]) == "at rest", &
         "at rest")
      call expect(error, kind_name(77) == "unknown", "unknown kind")
   end subroutine test_words

   !> d_k comes back from its moments, to round-off of the largest, and exactly zero when flat.
   subroutine test_spread(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp) :: d(3), m(3), worst
      integer(i8) :: k
      integer :: i
      worst = 0
      do k = 1, 500
         d = some_spread(k)
         m = some_moments(k)
         do i = 1, size(scales)
            worst = max(worst, maxval(abs(mass_spread(m*scales(i))/scales(i) - d))/maxval(m))
         end do
      end do
      call within(error, worst, 4*eps, "mass spread")
      d = mass_spread([.375_dp, .625_dp, 1._dp])
      call within(error, maxval(abs(d - [.625_dp, .375_dp, 0._dp])), 0._dp, "flat")
      d = mass_spread([1._dp, 0._dp, 1._dp])
      call within(error, maxval(abs(d - [0._dp, 1._dp, 0._dp])), 0._dp, "linear")
      d = mass_spread([.6_dp, 1.6_dp + 4*eps, 1._dp])
      call within(error, d(2), 0._dp, "round-off below zero")
      d = mass_spread([1e308_dp, 1e308_dp, 1e308_dp])
      call within(error, d(1)/5e307_dp - 1, 2*eps, "no overflow")
   end subroutine test_spread

   !> tensor = axes moments axes^T, right-handed, ascending, signs as promised, at every scale.
   subroutine test_axes(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: tensor(3, 3), axes(3, 3), m(3), found(3), worst(3)
      integer(i8) :: k
      integer :: i
      worst = 0
      do k = 1, 300
         m = some_moments(k)
         tensor = tensor_of_axes(m, to_matrix(random_quaternion(seed, k)))
         do i = 1, size(scales)
            call principal_axes(scales(i)*tensor, found, axes, refusal)
            call accepted(error, refusal)
            found = found/scales(i)
            worst(1) = max(worst(1), maxval(abs(tensor_of_axes(found, axes) - tensor))/maxval(m))
            worst(2) = max(worst(2), maxval(abs(found - m(ascending_order(m))))/maxval(m))
            worst(3) = max(worst(3), maxval(abs(matmul(transpose(axes), axes) - identity_matrix)), &
               abs(determinant(axes) - 1))
            call expect(error, found(1) <= found(2) .and. found(2) <= found(3), "ascending")
            call expect(error, axes(maxloc(abs(axes(:, 1)), 1), 1) > 0 .and. &
               axes(maxloc(abs(axes(:, 2)), 1), 2) > 0, "signs")
         end do
      end do
      call within(error, worst(1), 32*eps, "tensor rebuilt")
      call within(error, worst(2), 16*eps, "moments")
      call within(error, worst(3), 16*eps, "axes are a rotation")
   end subroutine test_axes

   !> Diagonal tensors keep their numbers to the bit, and noise does not move the axes that equal
   !> moments leave free.
   subroutine test_axes_deterministic(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp), parameter :: examples(3, 3) = reshape([1._dp, 1._dp, 1._dp, 1._dp, 1._dp, 1.5_dp, &
         .3_dp, 1._dp, 1._dp], [3, 3])
      real(dp) :: tensor(3, 3), axes(3, 3), other(3, 3), m(3), worst
      integer(i8) :: k
      integer :: i
      tensor = tensor_of_axes([1._dp, 1e-15_dp, 1 - eps], identity_matrix)
      call principal_axes(tensor, m, axes, refusal)
      call within(error, maxval(abs(m - [1e-15_dp, 1 - eps, 1._dp])), 0._dp, "diagonal moments")
      call principal_axes(tensor_of_axes([1._dp, .6_dp, .8_dp], identity_matrix), m, axes, refusal)
      call within(error, maxval(abs(axes - identity_matrix(:, [2, 3, 1]))), 0._dp, "diagonal axes")
      call principal_axes(tensor_of_axes([.8_dp, .6_dp, 1._dp], identity_matrix), m, axes, refusal)
      call within(error, maxval(abs(axes - identity_matrix(:, [2, 1, 3])*spread([1, 1, -1], 1, &
                  3))), 0._dp, "diagonal axes, odd order")
      worst = 0
      do k = 1, 100
         do i = 1, 3
            tensor = tensor_of_axes(examples(:, i), to_matrix(random_quaternion(seed, k)))
            call principal_axes(tensor, m, axes, refusal)
            tensor = tensor*(1 + 2*eps*hat(random_direction(seed, k))) ! not even symmetric
            call principal_axes(tensor, m, other, refusal)
            call accepted(error, refusal)
            worst = max(worst, maxval(abs(axes - other)))
         end do
      end do
      call within(error, worst, 1e-13_dp, "noise moves the axes")
      call principal_axes(tensor_of_axes([2._dp, 2._dp, 2._dp], axes), m, other, refusal)
      call within(error, maxval(abs(other - identity_matrix)), 0._dp, "axes of a sphere")
   end subroutine test_axes_deterministic

   !> Linear and flat bodies in any attitude come out exactly so.
   subroutine test_special_axes(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: axes(3, 3), m(3), turn(3, 3)
      integer(i8) :: k
      integer :: i
      do k = 1, 300
         turn = to_matrix(random_quaternion(seed, k))
         i = 1 + int(mod(k, 6_i8))
         call principal_axes(scales(i)*tensor_of_axes([0._dp, 1._dp, 1._dp], turn), m, &
                             axes, refusal)
         call accepted(error, refusal)
         call expect(error, kind_of_body(m, tolerance=0._dp) == kind_linear, "linear")
         call within(error, (m(3) - m(2))/m(3), 0._dp, "two equal moments of a linear body")
         call within(error, m(2)/scales(i) - 1, 8*eps, "moment of a linear body")
         call within(error, 1 - abs(dot_product(axes(:, 1), turn(:, 1))), 8*eps, "its axis")
         call principal_axes(scales(i)*tensor_of_axes([.3_dp, .7_dp, 1._dp], turn), m, &
                             axes, refusal)
         call accepted(error, refusal)
         call expect(error, is_flat(m), "flat")
      end do
   end subroutine test_special_axes

   subroutine test_axes_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: t(3, 3), axes(3, 3), m(3)
      t = identity_matrix
      t(1, 3) = 1e-5_dp
      call principal_axes(t, m, axes, refusal)
      call refused(error, refusal, poinsot_e_domain, "entries (1,3) and (3,1) differ")
      call within(error, maxval(abs(m)) + maxval(abs(axes - identity_matrix)), 0._dp, "left clean")
      call principal_axes(0*t, m, axes, refusal)
      call refused(error, refusal, poinsot_e_domain, "all entries are zero")
      call principal_axes(1e-305_dp*t, m, axes, refusal)
      call refused(error, refusal, poinsot_e_domain, "other units")
      call principal_axes(1e305_dp*t, m, axes, refusal)
      call refused(error, refusal, poinsot_e_domain, "other units")
      t = tensor_of_axes([1._dp, 2._dp, -.5_dp], to_matrix(random_quaternion(seed, 1_i8)))
      call principal_axes(t, m, axes, refusal)
      call refused(error, refusal, poinsot_e_domain, "I1 is negative")
      t = tensor_of_axes([1._dp, 2._dp, 3.1_dp], to_matrix(random_quaternion(seed, 1_i8)))
      call principal_axes(t, m, axes, refusal)
      call refused(error, refusal, poinsot_e_domain, "I3 exceeds")
      call within(error, maxval(abs(m)) + maxval(abs(axes - identity_matrix)), 0._dp, "left clean")
      t(2, 2) = ieee_value(1._dp, ieee_quiet_nan)
      call principal_axes(t, m, axes, refusal)
      call refused(error, refusal, poinsot_e_domain, "not finite")
   end subroutine test_axes_refusals

   !> Six masses on the axes have d_k = 2 m_k r_k^2; moved anywhere, in any unit, the same.
   subroutine test_point_masses(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp), parameter :: unit_of_mass(4) = [1._dp, 1.66e-27_dp, 1e30_dp, 1e-100_dp]
      real(dp), parameter :: unit_of_length(4) = [1._dp, 1e-10_dp, 1e9_dp, 1e120_dp]
      real(dp), parameter :: shift(3) = [10._dp, -3._dp, 5._dp]
      real(dp) :: mass(6), x(3, 6), tensor(3, 3), expected(3, 3), total, centre(3)
      integer :: i
      mass = [1._dp, 1._dp, 2._dp, 2._dp, 3._dp, 3._dp]
      x = reshape([1, 0, 0, -1, 0, 0, 0, 2, 0, 0, -2, 0, 0, 0, 1, 0, 0, -1], [3, 6])
      expected = tensor_of_axes([22._dp, 8._dp, 18._dp], identity_matrix) ! d = 2, 16, 6
      do i = 1, size(unit_of_mass)
         call point_mass_tensor(mass*unit_of_mass(i), unit_of_length(i)*(x + spread(shift, 2, 6)), &
            tensor, refusal, total, centre)
         call accepted(error, refusal)
         call within(error, maxval(abs(tensor/unit_of_mass(i)/unit_of_length(i)**2 - expected)), &
            200*eps, "tensor of six masses")
         call within(error, total/unit_of_mass(i) - 12, 12*eps, "total mass")
         call within(error, maxval(abs(centre/unit_of_length(i) - shift)), 20*eps, "centre")
      end do
      call point_mass_tensor([1._dp, 4._dp], reshape([1._dp, 2._dp, 2._dp, -1._dp, -2._dp, &
         -2._dp], &
         [3, 2]), tensor, refusal) ! reduced mass 0.8 at distance 6: not diagonal
      call within(error, tensor(1, 2) + .8_dp*2*4, 16*eps, "product of inertia")
      call within(error, tensor(1, 1) - .8_dp*32, 32*eps, "moment of a dumb-bell")
   end subroutine test_point_masses

   subroutine test_point_mass_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: x(3, 2), t(3, 3)
      x = reshape([0._dp, 0._dp, 0._dp, 1._dp, 1._dp, 1._dp], [3, 2])
      call point_mass_tensor([1._dp], x, t, refusal)
      call refused(error, refusal, poinsot_e_size, "position(3, n)")
      call point_mass_tensor([real(dp) ::], x(:, 1:0), t, refusal)
      call refused(error, refusal, poinsot_e_size, "n at least 1")
      call point_mass_tensor([1._dp, -1._dp], x, t, refusal)
      call refused(error, refusal, poinsot_e_domain, "negative")
      call point_mass_tensor([0._dp, 0._dp], x, t, refusal)
      call refused(error, refusal, poinsot_e_domain, "all masses are zero")
      call point_mass_tensor([1._dp, 1._dp], 1e160_dp*x, t, refusal)
      call refused(error, refusal, poinsot_e_domain, "other units")
      x(2, 2) = ieee_value(1._dp, ieee_quiet_nan)
      call point_mass_tensor([1._dp, 1._dp], x, t, refusal)
      call refused(error, refusal, poinsot_e_domain, "not finite")
   end subroutine test_point_mass_refusals

   !> About a shifted point: the sum over the same masses, counted from there.
   subroutine test_parallel_axis(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: shift(3) = [.5_dp, -2._dp, 1._dp], zero(3) = 0
      real(dp) :: t(3, 3), moved(3, 3), back(3, 3)
      integer :: i
      t = tensor_of_axes([22._dp, 8._dp, 18._dp], to_matrix(random_quaternion(seed, 5_i8)))
      moved = parallel_axis(t, 12._dp, shift)
      call within(error, moved(1, 1) - t(1, 1) - 60, 64*eps, "m (y^2 + z^2)")
      call within(error, moved(1, 2) - t(1, 2) - 12, 64*eps, "-m x y")
      call within(error, moved(3, 2) - t(3, 2) - 24, 64*eps, "-m y z")
      back = parallel_axis(moved, -12._dp, -shift)
      call within(error, maxval(abs(back - t)), 128*eps, "there and back")
      call within(error, maxval(abs(parallel_axis(t, 12._dp, zero) - t)), 0._dp, "no shift")
      do i = 1, size(scales)
         moved = parallel_axis(scales(i)*t, scales(i)*12._dp*1e40_dp, 1e-20_dp*shift)
         call within(error, moved(1, 1)/scales(i) - t(1, 1) - 60, 128*eps, "at some scale")
      end do
   end subroutine test_parallel_axis

   !> Solids against their textbook moments, and through a fine grid of point masses for the box.
   subroutine test_solids(error)
      type(error_type), allocatable, intent(out) :: error
      call solid("box", [1._dp, 2._dp, 3._dp], [13._dp, 10._dp, 5._dp]/12)
      call solid("ellipsoid", [1._dp, 2._dp, 3._dp], [13._dp, 10._dp, 5._dp]/5)
      call solid("sphere", [2._dp, 0._dp, 0._dp], [1.6_dp, 1.6_dp, 1.6_dp])
      call solid("cylinder", [2._dp, 3._dp, 0._dp], [1.75_dp, 1.75_dp, 2._dp])
      call solid("rod", [3._dp, 0._dp, 0._dp], [.75_dp, .75_dp, 0._dp])
      call solid("plate", [3._dp, 2._dp, 0._dp], [4._dp, 9._dp, 13._dp]/12)
      call solid("disc", [2._dp, 0._dp, 0._dp], [1._dp, 1._dp, 2._dp])
   contains
      subroutine solid(name, lengths, expected)
         character(*), intent(in) :: name
         real(dp), intent(in) :: lengths(3), expected(3)
         type(poinsot_error) :: refusal
         real(dp) :: m(3)
         call shape_moments(name, 7._dp, lengths, m, refusal)
         call accepted(error, refusal)
         call within(error, maxval(abs(m - 7*expected)), 64*eps, name)
         call shape_moments(name, 7e-26_dp, 1e-10_dp*lengths, m, refusal)
         call accepted(error, refusal)
         call within(error, maxval(abs(m*1e46_dp - 7*expected)), 128*eps, name//" in SI units")
         call check_moments(m, refusal)
         call accepted(error, refusal)
         call expect(error, shape_sizes(name) == count(lengths > 0), "how many sizes: "//name)
         call expect(error, len(shape_help(name)) > 0, "no help: "//name)
      end subroutine solid
   end subroutine test_solids

   !> Molecules against their atoms through the tensor, and against measured rotational constants
   !> B = 16.8576 cm^-1 amu A^2 / I (Huber and Herzberg 1979; Herzberg 1966).
   subroutine test_molecules(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp), parameter :: h = 1.008_dp, o = 15.999_dp, c = 12.011_dp, wavenumber = 16.857629_dp
      real(dp) :: water(3, 3), ring(3, 12), m(3), t(3, 3), found(3), axes(3, 3), angle
      integer :: i
      water = 0
      water(1, 2:3) = [1, -1]*sqrt(2/3._dp)
      water(3, 2:3) = sqrt(1/3._dp)
      call point_mass_tensor([o, h, h], water, t, refusal)
      call shape_moments("water", 0._dp, [0._dp, 0._dp, 0._dp], m, refusal)
      call accepted(error, refusal)
      call within(error, maxval(abs(t - tensor_of_axes(m, identity_matrix))), 16*eps, "water")
      call expect(error, describe_body(m) == "flat", "water is "//describe_body(m))
      do i = 1, 12
         angle = acos(-1._dp)*i/3
         ring(:, i) = merge(1.397_dp, 2.481_dp, i <= 6)*[cos(angle), sin(angle), 0._dp]
      end do
      call point_mass_tensor([(c, i=1, 6), (h, i=1, 6)], ring, t, refusal)
      call principal_axes(t, found, axes, refusal)
      call shape_moments("benzene", 0._dp, [0._dp, 0._dp, 0._dp], m, refusal)
      call within(error, maxval(abs(m - found)), 1e-12_dp, "benzene")
      call within(error, wavenumber/m(1) - .1897_dp, 2e-4_dp, "rotational constant of benzene")
      call expect(error, describe_body(m) == "symmetric about axis 3, flat", "benzene's kind")
      call shape_moments("nitrogen", 0._dp, [0._dp, 0._dp, 0._dp], m, refusal)
      call within(error, wavenumber/m(1) - 1.9982_dp, 2e-3_dp, "rotational constant of nitrogen")
      call expect(error, describe_body(m) == "linear along axis 3", "nitrogen's kind")
      call shape_moments("carbon-dioxide", 0._dp, [0._dp, 0._dp, 0._dp], m, refusal)
      call within(error, wavenumber/m(1) - .3916_dp, 4e-4_dp, "rotational constant of CO2")
      call expect(error, describe_body(m) == "linear along axis 3", "CO2's kind")
      call accepted(error, refusal)
   end subroutine test_molecules

   subroutine test_shape_refusals(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp), parameter :: none(3) = 0
      character(name_length) :: names(shape_count)
      real(dp) :: m(3)
      integer :: i
      call shape_moments("spher", 1._dp, [1._dp, 0._dp, 0._dp], m, refusal)
      call refused(error, refusal, poinsot_e_method, "unknown shape 'spher'; known: box, ellipsoid")
      call shape_moments("box", 0._dp, [1._dp, 1._dp, 1._dp], m, refusal)
      call refused(error, refusal, poinsot_e_domain, "box: mass must be positive")
      call shape_moments("box", 1._dp, [1._dp, 1._dp, 0._dp], m, refusal)
      call refused(error, refusal, poinsot_e_domain, "edges along axes 1, 2, 3")
      call shape_moments("disc", 1._dp, [1._dp, 1._dp, 0._dp], m, refusal)
      call refused(error, refusal, poinsot_e_domain, "too many sizes")
      call shape_moments("sphere", 1._dp, [-1._dp, 0._dp, 0._dp], m, refusal)
      call refused(error, refusal, poinsot_e_domain, "takes positive sizes: radius")
      call shape_moments("sphere", 1e-200_dp, [1e-100_dp, 0._dp, 0._dp], m, refusal)
      call refused(error, refusal, poinsot_e_domain, "other units")
      call shape_moments("sphere", 1e200_dp, [1e100_dp, 0._dp, 0._dp], m, refusal)
      call refused(error, refusal, poinsot_e_domain, "other units")
      call shape_moments("sphere", ieee_value(1._dp, ieee_quiet_nan), none, m, refusal)
      call refused(error, refusal, poinsot_e_domain, "not finite")
      call shape_moments("water", 18._dp, none, m, refusal)
      call refused(error, refusal, poinsot_e_domain, "leave both out")
      call shape_moments("water", 0._dp, [1._dp, 0._dp, 0._dp], m, refusal)
      call refused(error, refusal, poinsot_e_domain, "leave both out")
      call within(error, maxval(abs(m)), 0._dp, "moments of a refused shape")
      names = shape_names()
      do i = 1, shape_count
         call expect(error, shape_sizes(trim(names(i))) >= 0 .and. count(names == names(i)) == 1, &
            "name not unique or not found: "//names(i))
      end do
      call expect(error, shape_sizes("teapot") == -1 .and. shape_help("teapot") == "", "teapot")
   end subroutine test_shape_refusals

   subroutine test_invariants(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: m(3) = [.5_dp, .8_dp, 1._dp], y(3) = [1.5_dp, .4_dp, -3._dp]
      real(dp), parameter :: linear(3) = [2._dp, 0._dp, 2._dp], y_linear(3) = [1._dp, 0._dp, 3._dp]
      real(dp) :: q(4), l(3)
      integer :: i
      do i = 1, size(scales) ! moments and momenta alike: the energy scales so too
         call within(error, kinetic_energy(scales(i)*m, scales(i)*y)/scales(i) - 6.85_dp, &
                     16*eps, "energy")
         call within(error, maxval(abs(angular_velocity(scales(i)*m, scales(i)*y) - &
            [3._dp, .5_dp, -3._dp])), 8*eps, "angular velocity")
      end do
      call within(error, kinetic_energy(linear, y_linear) - 2.5_dp, 0._dp, "energy, linear")
      call within(error, maxval(abs(angular_velocity(linear, y_linear) - [.5_dp, 0._dp, 1.5_dp])), &
         0._dp, "angular velocity, linear")
      call within(error, casimir(y) - 5.705_dp, 8*eps, "Casimir")
      call expect(error, casimir([0._dp, 1e200_dp, 0._dp]) > 1e308_dp, "Casimir beyond the range")
      call within(error, casimir([0._dp, 1e-200_dp, 0._dp]), 0._dp, "Casimir below the range")
      q = random_quaternion(seed, 9_i8)
      l = space_momentum(y, q)
      call within(error, maxval(abs(l - matmul(to_matrix(q), y))), 16*eps, "Q y")
      call within(error, casimir(l) - casimir(y), 32*eps, "same Casimir in space")
   end subroutine test_invariants

   subroutine test_momentum(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp), parameter :: linear(3) = [2._dp, 0._dp, 2._dp]
      call check_momentum(linear, [1._dp, 0._dp, 3._dp], refusal)
      call accepted(error, refusal)
      call check_momentum(linear, [1._dp, 1e-300_dp, 3._dp], refusal)
      call refused(error, refusal, poinsot_e_domain, "y2 is not zero")
      call check_momentum(linear, [1._dp, 0._dp, ieee_value(1._dp, ieee_positive_inf)], refusal)
      call refused(error, refusal, poinsot_e_domain, "y3 is not finite")
   end subroutine test_momentum

   subroutine test_freedom(error)
      type(error_type), allocatable, intent(out) :: error
      call expect(error, degrees_of_freedom([1e-46_dp, 1e-46_dp, 2e-46_dp]) == 3, "a body has 3")
      call expect(error, degrees_of_freedom([1e-46_dp, 0._dp, 1e-46_dp]) == 2, "a linear one 2")
      call expect(error, degrees_of_freedom([0._dp, 0._dp, 0._dp]) == 0, "a point none")
   end subroutine test_freedom

end module test_body
