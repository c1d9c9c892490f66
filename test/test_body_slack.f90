!> Room body: moments and tensors as people have them, with few digits; what is taken, what becomes
!> of
!> it, what is refused and how; and that the motion is right for what is taken.
module test_body_slack
   use testdrive, only: new_unittest, unittest_type, error_type
   use test_expectation, only: within, expect, refused, accepted
   use test_free_tools, only: turn_body, method_names
   use test_measure, only: attitude_distance, momentum_distance, units
   use test_oracle_taylor, only: taylor_report, taylor_flow, free_problem, conditioning
   use poinsot_core_kinds, only: dp, sp, qp, i4, i8
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_method, poinsot_e_step, &
      poinsot_e_convergence
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_rotation, only: identity_matrix, to_matrix, random_uniform, random_quaternion, &
      random_direction, space_momentum => rotate
   use poinsot_body_class, only: body_class, make_class
   use poinsot_body_moments, only: accept_moments, check_moments, kind_of_body, kind_linear
   use poinsot_body_inertia, only: principal_axes, parallel_axis, tensor_of_axes
   use poinsot_body_invariants, only: kinetic_energy
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_tensor_class, set_option
   implicit none(type, external)
   private
   public :: collect_body_slack

   integer(i8), parameter :: seed = 1834_i8
   real(dp), parameter :: eps = epsilon(1._dp)
   real(dp), parameter :: scales(5) = [1e-280_dp, 1e-46_dp, 1._dp, 1e15_dp, 1e150_dp]
   integer, parameter :: orders(3, 6) = reshape([1, 2, 3, 1, 3, 2, 2, 1, 3, 2, 3, 1, 3, 1, 2, 3, &
      2, 1], [3, 6])

contains

   subroutine collect_body_slack(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("slack-examples", test_examples), &
         new_unittest("slack-limits", test_limits), &
         new_unittest("slack-planar-bodies-in-few-digits", test_planar), &
         new_unittest("slack-not-physical", test_not_physical), &
         new_unittest("slack-plan-option", test_plan_option), &
         new_unittest("slack-tensors-in-single-precision", test_single), &
         new_unittest("slack-moved-linear-tensors", test_moved), &
         new_unittest("slack-zero-moments-of-tensors", test_zero_moments), &
         new_unittest("slack-tensors-refused", test_refused_tensors), &
         new_unittest("slack-motion", test_motion), &
         new_unittest("slack-motion-thin-and-degenerate", test_thin_motion)]
   end subroutine collect_body_slack

   !> Moments that users brought: in every order of the axes.
   subroutine test_examples(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: mean = 42.23701736645_dp
      call both([1.022_dp, 1.920_dp, 2.9421_dp], [1.022_dp, 1.920_dp, 2.9421_dp])
      call both([42.2370182357_dp, 42.2370164972_dp, 0._dp], [mean, mean, 0._dp])
      call both([0._dp, 1._dp, 1.00000000001_dp], [0._dp, 1.000000000005_dp, 1.000000000005_dp])
      call both([10.0000000001_dp, 10._dp, 0._dp], [10.00000000005_dp, 10.00000000005_dp, 0._dp])
      call none([0.604636_dp, 1.160852_dp, 1.817004_dp], &
                "exceeds the sum of the other two by 2.84e-02 of itself; up to 1e-3")
      call none([1._dp, 2._dp, 3.01_dp], "3.32e-03 of itself; up to 1e-3")
      call none([0._dp, 1._dp, 1.01_dp], "9.90e-03 of itself; up to 1e-3")
      call none([1._dp, 2._dp, 9._dp], "6.67e-01 of itself; up to 1e-3")
      call none([-0.001_dp, 1._dp, 1._dp], "is negative, by 1.00e-03 of the largest")
   contains
      subroutine both(moments, expected)
         real(dp), intent(in) :: moments(3), expected(3)
         type(poinsot_error) :: refusal
         type(body_class) :: class
         real(dp) :: m(3), worst
         integer :: k
         worst = 0
         do k = 1, size(orders, 2)
            m = moments(orders(:, k))
            call accept_moments(m, refusal)
            call accepted(error, refusal)
            worst = max(worst, maxval(abs(m - expected(orders(:, k)))))
            call make_class(moments(orders(:, k)), class, refusal)
            call accepted(error, refusal)
            worst = max(worst, maxval(abs(class%moments - m)))
            if (any(m <= 0)) then
               call expect(error, kind_of_body(m, tolerance=0._dp) == kind_linear, "not linear")
            end if
         end do
         call within(error, worst, merge(8*eps*maxval(moments), 0._dp, any(moments <= 0)), &
                     "accepted moments")
      end subroutine both

      subroutine none(moments, words)
         real(dp), intent(in) :: moments(3)
         character(*), intent(in) :: words
         type(poinsot_error) :: refusal
         type(body_class) :: class
         integer :: k
         do k = 1, size(orders, 2)
            call check_moments(moments(orders(:, k)), refusal)
            call refused(error, refusal, poinsot_e_domain, words)
            call make_class(moments(orders(:, k)), class, refusal)
            call refused(error, refusal, poinsot_e_domain, words)
         end do
      end subroutine none
   end subroutine test_examples

   !> Both sides of every limit, at every scale.
   subroutine test_limits(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: m(3), before(3)
      integer :: i
      do i = 1, size(scales)
         before = scales(i)*[1._dp, 2._dp, 3.0029_dp]
         m = before
         call accept_moments(m, refusal)
         call accepted(error, refusal)
         call within(error, maxval(abs(m - before)), 0._dp, "used as they are")
         call check_moments(scales(i)*[1._dp, 2._dp, 3.0031_dp], refusal)
         call refused(error, refusal, poinsot_e_domain, "I3 exceeds the sum")
         m = scales(i)*[1.0000099_dp, 0._dp, 1._dp]
         call accept_moments(m, refusal)
         call accepted(error, refusal)
         call within(error, m(1)/scales(i) - 1.00000495_dp, 2*eps, "mean")
         call within(error, m(3) - m(1), 0._dp, "equal")
         call check_moments(scales(i)*[1.0011_dp, 0._dp, 1._dp], refusal)
         call refused(error, refusal, poinsot_e_domain, "I1 exceeds the sum")
         m = scales(i)*[1.0000099_dp, 1e-12_dp, 1._dp] ! a line, by rounding not quite
         call accept_moments(m, refusal)
         call accepted(error, refusal)
         call within(error, m(1)/scales(i) - 1.00000495_dp, 2*eps, "mean of a thin body")
         call within(error, m(3) - m(1), 0._dp, "equal moments of a thin body")
         m = scales(i)*[1.0000099_dp, 1e-9_dp, 1._dp]  ! that is no line
         before = m
         call accept_moments(m, refusal)
         call accepted(error, refusal)
         call within(error, maxval(abs(m - before)), 0._dp, "a thin body changed")
      end do
   end subroutine test_limits

   !> Random planar bodies, and linear ones, written with 4 to 12 digits.
   subroutine test_planar(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: m(3), before(3), u(2)
      integer(i8) :: k
      integer :: digits
      do k = 1, 900
         digits = 4 + int(mod(k, 9_i8))
         u = random_uniform(seed, k, 0_i8, 7_i4)
         m = [u(1), u(2), u(1) + u(2)]
         m = rounded(m/maxval(m), digits)
         before = m
         call accept_moments(m, refusal)
         call accepted(error, refusal)
         call within(error, maxval(abs(m - before)), 0._dp, "planar body changed")
      end do
   contains
      elemental real(dp) function rounded(x, digits)
         real(dp), intent(in) :: x
         integer, intent(in) :: digits
         rounded = anint(x*10._dp**digits)/10._dp**digits
      end function rounded
   end subroutine test_planar

   !> What no mass has, where that is asked for: zero or positive, finite.
   subroutine test_not_physical(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      type(body_class) :: class
      real(dp), parameter :: taken(3, 5) = reshape([0.604636_dp, 1.160852_dp, 1.817004_dp, 1._dp, &
         2._dp, 9._dp, 1._dp, 2._dp, 3.01_dp, 0._dp, 0._dp, 1._dp, 0._dp, 0._dp, 0._dp], [3, 5])
      integer :: i, k
      do i = 1, size(taken, 2)
         do k = 1, size(orders, 2)
            call make_class(taken(orders(:, k), i), class, refusal, physical=.false.)
            call accepted(error, refusal)
            call within(error, maxval(abs(class%moments - taken(orders(:, k), i))), 0._dp, &
               "as given")
            call make_class(taken(orders(:, k), i), class, refusal, physical=.true.)
            call expect(error, raised(refusal), "physical = .true. takes what no body has")
            call refusal%clear()
         end do
      end do
      call make_class([0._dp, 1._dp, 1.01_dp], class, refusal, physical=.false.)
      call accepted(error, refusal)
      call within(error, maxval(abs(class%moments - [0._dp, 1.005_dp, 1.005_dp])), 2*eps, "mean")
      call check_moments([-0.001_dp, 1._dp, 1._dp], refusal, physical=.false.)
      call refused(error, refusal, poinsot_e_domain, "I1 is negative")
      call check_moments([1._dp, 1e308_dp*10, 1._dp], refusal, physical=.false.)
      call refused(error, refusal, poinsot_e_domain, "I2 is not finite")
   end subroutine test_not_physical

   !> The plan's option, of classes added after it.
   subroutine test_plan_option(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_plan) :: plan
      type(poinsot_error) :: refusal
      real(dp), parameter :: water(3) = [0.604636_dp, 1.160852_dp, 1.817004_dp]
      integer :: number
      call add_class(plan, water, number, refusal)
      call refused(error, refusal, poinsot_e_domain, "I3 exceeds the sum")
      call set_option(plan, "physical", "no", refusal)
      call add_class(plan, water, number, refusal)
      call accepted(error, refusal)
      call within(error, maxval(abs(plan%classes(number)%it%moments - water)), 0._dp, "as given")
      call add_tensor_class(plan, tensor_of_axes(water, to_matrix(random_quaternion(seed, 9_i8))), &
                            number, refusal)
      call accepted(error, refusal)
      call set_option(plan, "physical", "yes", refusal)
      call add_class(plan, water, number, refusal)
      call refused(error, refusal, poinsot_e_domain, "I3 exceeds the sum")
      call set_option(plan, "physical", ".false.", refusal)
      call refused(error, refusal, poinsot_e_method, "unknown physical '.false.'")
   end subroutine test_plan_option

   !> R I R^T formed and kept in single precision: linear, planar and other bodies, at the scales
   !> that single precision has and, entries scaled by powers of two, at others.
   subroutine test_single(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: bodies(3, 4) = reshape([0._dp, 1._dp, 1._dp, .35_dp, .65_dp, 1._dp, &
         .6_dp, .8_dp, 1._dp, 1._dp, 1._dp, 1._dp], [3, 4])
      integer, parameter :: powers(3) = [0, -153, 400]
      type(poinsot_error) :: refusal
      real(sp) :: r(3, 3), t(3, 3)
      real(dp) :: tensor(3, 3), moments(3), axes(3, 3), worst
      integer(i8) :: k
      integer :: i, e
      worst = 0
      do k = 1, 400
         r = real(to_matrix(random_quaternion(seed, k)), sp)
         do i = 1, size(bodies, 2)
            t = matmul(matmul(r, tensor_in_single(bodies(:, i))), transpose(r)) ! asymmetric as well
            e = powers(1 + int(mod(k, 3_i8)))
            tensor = scale(real(t, dp), e)
            call principal_axes(tensor, moments, axes, refusal)
            call accepted(error, refusal)
            worst = max(worst, maxval(abs(scale(moments, -e) - bodies(:, i))))
            if (i == 1) call expect(error, kind_of_body(moments, tolerance=0._dp) == kind_linear, &
                                    "a linear body in single precision is not linear")
            tensor = tensor/2 + transpose(tensor)/2
            call principal_axes(real(real(scale(tensor, -e), sp), dp), moments, axes, refusal)
            call accepted(error, refusal)
            if (i == 1) call expect(error, moments(1) <= 0, "symmetric single precision")
         end do
      end do
      call within(error, worst, 1e-6_dp, "moments from single precision")
   contains
      pure function tensor_in_single(moments) result(t)
         real(dp), intent(in) :: moments(3)
         real(sp) :: t(3, 3)
         integer :: j
         t = 0
         do j = 1, 3
            t(j, j) = real(moments(j), sp)
         end do
      end function tensor_in_single
   end subroutine test_single

   !> A linear body's tensor brought to its centre of mass from afar: digits cancel.
   subroutine test_moved(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: tensor(3, 3), moments(3), axes(3, 3), shift(3)
      integer(i8) :: k
      do k = 1, 500
         tensor = tensor_of_axes([0._dp, 1._dp, 1._dp], to_matrix(random_quaternion(seed, k)))
         shift = 100*random_direction(seed, k)
         tensor = parallel_axis(tensor, 7._dp, shift)
         tensor = parallel_axis(tensor, -7._dp, shift)
         call principal_axes(tensor, moments, axes, refusal)
         call accepted(error, refusal)
         call expect(error, kind_of_body(moments, tolerance=0._dp) == kind_linear, "not linear")
         call within(error, maxval(abs(moments - [0._dp, 1._dp, 1._dp])), 1e-9_dp, "moments")
      end do
   end subroutine test_moved

   !> Which smallest moment of a tensor is zero: with many digits from -1e-6 to 1e-10 of the
   !> largest,
   !> with few to 1e-6; a diagonal tensor's is what it says.
   subroutine test_zero_moments(error)
      type(error_type), allocatable, intent(out) :: error
      call smallest(0.9e-10_dp, .false., zero=.true.)
      call smallest(1.1e-10_dp, .false., zero=.false.)
      call smallest(-0.9e-6_dp, .false., zero=.true.)
      call smallest(0.9e-6_dp, .true., zero=.true.)
      call smallest(1.1e-6_dp, .true., zero=.false.)
      call smallest(-0.9e-6_dp, .true., zero=.true.)
      call diagonal(0.9e-10_dp)
      call diagonal(0.9e-6_dp)
   contains
      subroutine smallest(least, asymmetric, zero)
         real(dp), intent(in) :: least
         logical, intent(in) :: asymmetric, zero
         type(poinsot_error) :: refusal
         real(dp) :: tensor(3, 3), moments(3), axes(3, 3)
         integer(i8) :: k
         integer :: i
         do k = 1, 20
            i = 2 + int(mod(k, 4_i8)) ! a scale
            tensor = tensor_of_axes([least, 1._dp, 1._dp], to_matrix(random_quaternion(seed, k)))
            tensor = tensor/2 + transpose(tensor)/2
            if (asymmetric) tensor(1, 2) = tensor(1, 2) + 4*eps
            call principal_axes(scales(i)*tensor, moments, axes, refusal)
            call accepted(error, refusal)
            call expect(error, (moments(1) <= 0) .eqv. zero, "zero or not")
            if (zero) call within(error, moments(3) - moments(2), 0._dp, "two equal moments")
            if (.not. zero) then
               call within(error, moments(1)/scales(i) - least, 16*eps, "smallest moment")
            end if
         end do
      end subroutine smallest

      subroutine diagonal(least)
         real(dp), intent(in) :: least
         type(poinsot_error) :: refusal
         real(dp) :: moments(3), axes(3, 3)
         call principal_axes(tensor_of_axes([1._dp, least, 1._dp], identity_matrix), moments, &
            axes, &
                             refusal)
         call accepted(error, refusal)
         call within(error, moments(1) - least, 0._dp, "smallest moment of a diagonal tensor")
      end subroutine diagonal
   end subroutine test_zero_moments

   subroutine test_refused_tensors(error)
      type(error_type), allocatable, intent(out) :: error
      type(poinsot_error) :: refusal
      real(dp) :: tensor(3, 3), moments(3), axes(3, 3)
      tensor = tensor_of_axes([.6_dp, .8_dp, 1._dp], to_matrix(random_quaternion(seed, 3_i8)))
      tensor(1, 3) = tensor(3, 1) + 0.9e-6_dp*maxval(abs(tensor))
      call principal_axes(tensor, moments, axes, refusal)
      call accepted(error, refusal)
      call within(error, maxval(abs(moments - [.6_dp, .8_dp, 1._dp])), 1e-6_dp, "symmetrised")
      tensor(1, 3) = tensor(3, 1) + 1.1e-6_dp*maxval(abs(tensor))
      call principal_axes(tensor, moments, axes, refusal)
      call refused(error, refusal, poinsot_e_domain, &
                   "(1,3) and (3,1) differ by 1.10e-06 of the largest entry; up to 1e-6")
      tensor = tensor_of_axes([-1.1e-6_dp, 1._dp, 1._dp], to_matrix(random_quaternion(seed, 4_i8)))
      call principal_axes(tensor, moments, axes, refusal)
      call refused(error, refusal, poinsot_e_domain, "I1 is negative, by 1.10e-06 of the largest")
      tensor = tensor_of_axes([-0.9e-6_dp, 1._dp, 1._dp], identity_matrix)
      call principal_axes(tensor, moments, axes, refusal)
      call refused(error, refusal, poinsot_e_domain, "I1 is negative, by 9.00e-07 of the largest")
      tensor = tensor_of_axes([.3_dp, .4_dp, 1._dp], to_matrix(random_quaternion(seed, 5_i8)))
      call principal_axes(tensor, moments, axes, refusal)
      call refused(error, refusal, poinsot_e_domain, &
         "I3 exceeds the sum of the other two by 3.00e-01")
      call principal_axes(tensor, moments, axes, refusal, physical=.false.)
      call accepted(error, refusal)
      call within(error, maxval(abs(moments - [.3_dp, .4_dp, 1._dp])), 4*eps, "not physical")
   end subroutine test_refused_tensors

   !> Moments that break the inequality within the slack move as Euler's equations say: both exact
   !> methods against a Taylor series in quadruple precision.
   subroutine test_motion(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: bodies(3, 5) = reshape([1.022_dp, 1.920_dp, 2.9421_dp, 2._dp, &
         3.0029_dp, &
         1._dp, 1e-2_dp, 1.0005_dp, 1._dp, 1e-3_dp, 1._dp, 1.0019_dp, 1e-4_dp, 1._dp, 1.001_dp], &
         [3, 5])
      real(dp), parameter :: steps(3) = [0.1_dp, 0.7_dp, 4._dp]
      integer :: i, j
      do i = 1, size(bodies, 2)
         do j = 1, size(steps)
            call against_series("exact", bodies(:, i), steps(j))
            call against_series("jacobi", bodies(:, i), steps(j))
         end do
      end do
   contains
      subroutine against_series(name, moments, h)
         character(*), intent(in) :: name
         real(dp), intent(in) :: moments(3), h
         type(taylor_report) :: report
         real(qp) :: yt(3), qt(4)
         real(dp) :: y(3), q(4), c(4)
         integer :: status
         y = moments*[.5_dp, -.6_dp, .4_dp]
         q = [1, 0, 0, 0]
         call conditioning(moments, y, h, c(1), c(2), c(3), c(4))
         yt = y
         qt = q
         call taylor_flow(free_problem(moments), real(h, qp), yt, qt, report)
         call turn_body(name, moments, h, 1, y, q, status)
         call expect(error, status == poinsot_ok, name // " fails")
         call within(error, units(momentum_distance(real(y, qp), yt), max(c(1), c(3))), 4._dp, &
                     name // ", y in units of conditioning")
         call within(error, units(attitude_distance(real(q, qp), qt), max(c(2), c(4))), 4._dp, &
                     name // ", q in units of conditioning")
      end subroutine against_series
   end subroutine test_motion

   !> Whatever is taken moves without an exception, and a step that answers "ok" keeps the
   !> momentum in space (a short one, of methods that iterate); exact ones keep the energy too.
   subroutine test_thin_motion(error)
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: bodies(3, 9) = reshape([1e-5_dp, 1._dp, 1.001_dp, 1e-9_dp, 1._dp, &
         1.0005_dp, 1e-12_dp, 42.2370164972_dp, 42.2370182357_dp, 1e-300_dp, 1._dp, 1.0005_dp, &
         0._dp, 1._dp, 1.0009_dp, 0._dp, 1._dp, 2._dp, 0._dp, 0._dp, 1._dp, 0._dp, 0._dp, 0._dp, &
         1._dp, 2._dp, 9._dp], [3, 9])
      real(dp), parameter :: steps(3) = [1e-3_dp, 0.3_dp, 50._dp]
      type(body_class) :: class
      type(poinsot_error) :: refusal
      real(dp) :: y(3), q(4), before(3)
      integer :: i, j, k, status
      do i = 1, size(bodies, 2)
         call make_class(bodies(:, i), class, refusal, physical=.false.)
         call accepted(error, refusal)
         do k = 1, size(method_names)
            do j = 1, size(steps)
               before = class%moments*[.5_dp, -.6_dp, .4_dp]
               y = before
               q = [1, 0, 0, 0]
               call turn_body(method_names(k), bodies(:, i), steps(j), 3, y, q, status, &
                              physical=.false.)
               call expect(error, any(status == [poinsot_ok, poinsot_e_step, &
                           poinsot_e_convergence]), trim(method_names(k)) // ": unexpected status")
               if (status /= poinsot_ok .or. (k <= 16 .and. j > 1)) cycle
               call within(error, maxval(abs(space_momentum(q, y) - before)), &
                           merge(1e-10_dp, 2e-12_dp, k <= 16)*maxval(class%moments) + 1e-300_dp, &
                           trim(method_names(k)) // ": momentum in space")
               if (k <= 16) cycle
               call within(error, kinetic_energy(class%moments, y) - &
                           kinetic_energy(class%moments, before), &
                           1e-11_dp*kinetic_energy(class%moments, before), &
                           trim(method_names(k)) // ": energy")
            end do
         end do
      end do
   end subroutine test_thin_motion

end module test_body_slack
