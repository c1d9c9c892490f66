!> Promises of every method for every body, measured: one figure per method.
!>
!> A promise is a procedure here and a row of `promises`, with its bound.
module poinsot_study_hard_promises
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_value, ieee_quiet_nan, &
      ieee_positive_inf
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error
   use poinsot_core_status, only: poinsot_ok, poinsot_e_not_finite, poinsot_e_not_unit, &
      poinsot_e_step, poinsot_e_convergence
   use poinsot_body_class, only: body_class, make_class
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_rotate, only: rotate_bodies
   use poinsot_free_method, only: free_method, find_method
   use poinsot_rotation_quaternion, only: rotate
   use poinsot_study_hard_frames, only: in_a_frame, with_a_rotor, few_digits
   use poinsot_study_turn, only: turn_one
   implicit none(type, external)
   private
   public :: promise_names, promise_bounds, promise_about, measure_promise, broken, measured_nothing

   !> A promise: its name, its bound in 1e-16, and its description.
   type :: promise
      character(9) :: name
      real(dp) :: bound
      character(74) :: about
   end type promise

   type(promise), parameter :: promises(*) = [ &
      promise("units-2", 0.0_dp, &
         "units by powers of two from 2^-498 to 2^498: bitwise the same"), &
      promise("units-10", 40.0_dp, &
         "units by powers of ten from 1e-150 to 1e150; a molecule in SI units"), &
      promise("axes", 20.0_dp, "the axes in all six orders: the same motion"), &
      promise("zero", 0.0_dp, "steps of 0 and -0 change nothing"), &
      promise("return", 2000.0_dp, "100 steps forth and 100 back"), &
      promise("at-rest", 10.0_dp, &
         "no momentum, momenta from 5e-324 to 1e-300: no rotation, no spin-up"), &
      promise("any-step", 100.0_dp, &
         "1e-12 to 1e9 periods, both signs: |q|, |y|, Qy conserved, or E_STEP"), &
      promise("too-far", 0.0_dp, "a step beyond the method's limit: refused, state kept"), &
      promise("near-unit", 60.0_dp, "|q| off by 1e-16 to 1e-6: used as given, the norm stays"), &
      promise("no-unit", 0.0_dp, &
         "|q| off by more, zero, infinite, not a number: refused, state kept"), &
      promise("frame", 500.0_dp, "a top given by a tensor in another frame: the same motion"), &
      promise("rotor", 500.0_dp, "a gyrostat: drift and step bitwise the same, Q y conserved"), &
      promise("slack", 0.0_dp, "rounded moments: accepted within the tolerance, else refused")]

   character(9), parameter :: promise_names(*) = promises%name
   real(dp), parameter :: promise_bounds(*) = promises%bound
   character(74), parameter :: promise_about(*) = promises%about

   real(dp), parameter :: broken = huge(1.0_dp)           !! a NaN, or a status that should not be
   real(dp), parameter :: measured_nothing = -1           !! the promise says nothing of this method

   integer, parameter :: bodies_count = 6, thin_body = 5
   real(dp), parameter :: moments(3, bodies_count) = reshape([0.6_dp, 0.8_dp, 1.0_dp, &
      0.7_dp, 0.7_dp, 1.1_dp, 0.4_dp, 0.6_dp, 1.0_dp, 1.0_dp, 1.0_dp, 1.0_dp, &
      1e-3_dp, 1.0_dp, 1.0_dp, 0.0_dp, 1.0_dp, 1.0_dp], [3, bodies_count])
   real(dp), parameter :: momenta(3, bodies_count) = reshape([0.5_dp, -0.6_dp, 0.4_dp, &
      0.3_dp, 0.6_dp, -0.5_dp, -0.5_dp, 0.6_dp, 0.4_dp, 0.5_dp, 0.6_dp, 0.4_dp, &
      5e-4_dp, 0.6_dp, -0.4_dp, 0.0_dp, 0.6_dp, -0.4_dp], [3, bodies_count])
   real(dp), parameter :: start(4) = [0.5_dp, -0.1_dp, 0.7_dp, 0.5_dp]

contains

   !> Figure of promise `number` for a method, in 1e-16; `broken` or `measured_nothing`.
   real(dp) function measure_promise(number, name) result(figure)
      integer, intent(in) :: number
      character(*), intent(in) :: name
      type(free_method) :: method
      type(poinsot_error) :: error
      real(dp) :: one
      integer :: b
      call find_method(name, method, error)
      figure = measured_nothing
      do b = 1, bodies_count
         select case (promise_names(number))
         case ("units-2"); one = other_units(name, b, .true.)
         case ("units-10"); one = other_units(name, b, .false.)
         case ("axes"); one = other_orders(method, b)
         case ("zero"); one = no_step(name, b)
         case ("return"); one = there_and_back(name, b)
         case ("at-rest"); one = at_rest(name, b)
         case ("any-step"); one = any_step(method, b)
         case ("too-far"); one = too_far(method, b)
         case ("near-unit"); one = near_unit(name, b)
         case ("frame"); one = another_frame(method, b)
         case ("rotor")
            one = measured_nothing ! there is none on a linear body
            if (moments(1, b) > 0) one = with_a_rotor(name, moments(:, b), momenta(:, b))
         case ("slack"); one = few_digits(name)
         case default; one = no_unit(name, b)
         end select
         ! its roundings grow like the largest moment over the smallest: a thin body counts for less
         if (method%kernel == "three-rotations" .and. b == thin_body .and. one < broken) then
            one = one*minval(moments(:, b))/maxval(moments(:, b))
         end if
         figure = max(figure, one)
      end do
   end function measure_promise

   !> A tensor knows a small moment only to its rounding, and axes of equal moments not at all, by
   !> which methods of fixed axes go.
   real(dp) function another_frame(method, b) result(figure)
      type(free_method), intent(in) :: method
      integer, intent(in) :: b
      logical :: equal
      equal = count(abs(moments(:, b) - cshift(moments(:, b), 1)) <= 0) > 0
      figure = measured_nothing
      if (b == thin_body .or. (equal .and. method%fixed_axes)) return
      figure = in_a_frame(trim(method%name), moments(:, b), momenta(:, b))
   end function another_frame

   !> Three steps in units of moment and of rate, taken back to the plain units.
   real(dp) function other_units(name, b, two) result(figure)
      character(*), intent(in) :: name
      integer, intent(in) :: b
      logical, intent(in) :: two
      integer, parameter :: power(2, 6) = reshape([-498, 0, 498, 0, -200, 300, 498, -200, -153, &
         40, 0, -230], [2, 6])
      real(dp), parameter :: ten(2, 6) = reshape([1e-150_dp, 1.0_dp, 1e150_dp, 1.0_dp, 1e-46_dp, &
         1e12_dp, 1e-100_dp, 1e60_dp, 1e100_dp, 1e-60_dp, 1.0_dp, 1e60_dp], [2, 6])
      real(dp), parameter :: h = 0.4_dp
      real(dp) :: y(3), q(4), z(3), r(4), mass, rate
      integer :: k, status(2)
      figure = 0
      do k = 1, 6
         mass = ten(1, k)
         rate = ten(2, k)
         if (two) mass = 2.0_dp**power(1, k)
         if (two) rate = 2.0_dp**power(2, k)
         y = momenta(:, b)
         q = start
         z = y*mass*rate
         r = q
         call turn_one(name, moments(:, b), h, 3, y, q, status(1))
         call turn_one(name, moments(:, b)*mass, h/rate, 3, z, r, status(2))
         z = z/rate/mass
         figure = max(figure, gap(status, y, q, z, r))
      end do
   end function other_units

   !> Three steps with the axes relabelled by an even or odd permutation, labelled back.
   real(dp) function other_orders(method, b) result(figure)
      type(free_method), intent(in) :: method
      integer, intent(in) :: b
      integer, parameter :: orders(3, 5) = reshape([2, 3, 1, 3, 1, 2, 2, 1, 3, 1, 3, 2, 3, 2, 1], &
         [3, 5])
      real(dp), parameter :: h = 0.4_dp
      real(dp) :: y(3), q(4), z(3), r(4), parity
      integer :: k, o(3), status(2)
      ! splittings about fixed axes are another map in another order
      figure = measured_nothing
      if (method%fixed_axes) return
      figure = 0
      do k = 1, 5
         o = orders(:, k)
         parity = merge(1.0_dp, -1.0_dp, k <= 2)
         y = momenta(:, b)
         q = start
         z = parity*y(o)
         r = [q(1), parity*q(1 + o)]
         call turn_one(method%name, moments(:, b), h, 3, y, q, status(1))
         call turn_one(method%name, moments(o, b), h, 3, z, r, status(2))
         z(o) = parity*z
         r(1 + o) = parity*r(2:4)
         figure = max(figure, gap(status, y, q, z, r))
      end do
   end function other_orders

   real(dp) function no_step(name, b) result(figure)
      character(*), intent(in) :: name
      integer, intent(in) :: b
      real(dp) :: y(3), q(4)
      integer :: k, status
      figure = 0
      do k = 1, 2
         y = momenta(:, b)
         q = start
         call turn_one(name, moments(:, b), merge(0.0_dp, -0.0_dp, k == 1), 3, y, q, status)
         figure = max(figure, gap([status, poinsot_ok], y, q, momenta(:, b), start))
      end do
   end function no_step

   real(dp) function there_and_back(name, b) result(figure)
      character(*), intent(in) :: name
      integer, intent(in) :: b
      real(dp) :: y(3), q(4)
      integer :: status(2)
      y = momenta(:, b)
      q = start
      call turn_one(name, moments(:, b), 0.2_dp, 100, y, q, status(1))
      call turn_one(name, moments(:, b), -0.2_dp, 100, y, q, status(2))
      figure = gap(status, y, q, momenta(:, b), start)
   end function there_and_back

   real(dp) function at_rest(name, b) result(figure)
      character(*), intent(in) :: name
      integer, intent(in) :: b
      real(dp), parameter :: small(6) = [0.0_dp, 1e-300_dp, 3e-308_dp, 1e-310_dp, 1e-320_dp, &
         5e-324_dp]
      real(dp) :: y(3), q(4)
      integer :: k, status
      figure = 0
      do k = 1, size(small)
         y = merge(small(k), 0.0_dp, abs(momenta(:, b)) > 0)
         q = start
         call turn_one(name, moments(:, b), 0.5_dp, 2, y, q, status)
         if (maxval(abs(y)) > 2*small(k)) figure = broken
         figure = max(figure, gap([status, poinsot_ok], [1, 0, 0]*1.0_dp, q, [1, 0, 0]*1.0_dp, &
            start))
      end do
   end function at_rest

   real(dp) function any_step(method, b) result(figure)
      type(free_method), intent(in) :: method
      integer, intent(in) :: b
      integer, parameter :: powers(10) = [-12, -8, -4, -2, 0, 1, 2, 3, 6, 9]
      real(dp) :: y(3), q(4), turn, lost
      integer :: k, status
      figure = 0
      do k = 1, size(powers)
         turn = (-1)**k*6.28_dp*10.0_dp**powers(k)
         y = momenta(:, b)
         q = start
         call turn_one(method%name, moments(:, b), turn, 1, y, q, status)
         if (far(status) .and. method%order > 0) cycle
         lost = gap([status, poinsot_ok], rotate(q, y), [norm2(q), 0.0_dp, 0.0_dp, 0.0_dp], &
            rotate(start, momenta(:, b)), [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp])
         if (lost < broken) lost = lost/sqrt(max(1.0_dp, abs(turn)))
         figure = max(figure, lost)
      end do
   end function any_step

   !> How often a step that is too long is accepted, or changes the state.
   real(dp) function too_far(method, b) result(figure)
      type(free_method), intent(in) :: method
      integer, intent(in) :: b
      real(dp), parameter :: steps(6) = [6.0_dp, -6.0_dp, 1e3_dp, 1e80_dp, -1e200_dp, 1e308_dp]
      real(dp) :: y(3), q(4)
      integer :: k, status
      figure = measured_nothing
      if (method%order == 0) return
      figure = 0
      do k = 1, size(steps)
         y = momenta(:, b)
         q = start
         call turn_one(method%name, moments(:, b), steps(k), 2, y, q, status)
         if (.not. far(status)) figure = broken
         if (any(abs(y - momenta(:, b)) > 0) .or. any(abs(q - start) > 0)) figure = broken
      end do
   end function too_far

   !> What ten steps do to a norm that is a little off.
   real(dp) function near_unit(name, b) result(figure)
      character(*), intent(in) :: name
      integer, intent(in) :: b
      real(dp), parameter :: deviation(6) = [1e-16_dp, -1e-12_dp, 1e-9_dp, -1e-7_dp, 9e-7_dp, &
         -9e-7_dp]
      real(dp) :: q(4), norm
      integer :: k, status
      figure = 0
      do k = 1, size(deviation)
         q = start*(1 + deviation(k))
         norm = norm2(q)
         call rotate_one(name, b, q, status)
         if (status /= poinsot_ok) then
            figure = broken
         else
            ! compensated sums bring the norm back to 1; plain ones leave it
            figure = max(figure, min(abs(norm2(q) - norm), abs(norm2(q) - 1))/1e-16_dp)
         end if
      end do
   end function near_unit

   real(dp) function no_unit(name, b) result(figure)
      character(*), intent(in) :: name
      integer, intent(in) :: b
      real(dp) :: q(4), kept(4), factors(8)
      integer :: k, status
      figure = 0
      factors = [0.0_dp, 1 + 1e-5_dp, 1 - 1e-5_dp, 0.5_dp, 1e3_dp, 1e300_dp, &
         ieee_value(1.0_dp, ieee_positive_inf), ieee_value(1.0_dp, ieee_quiet_nan)]
      do k = 1, size(factors)
         q = start
         if (k <= 6) q = start*factors(k)
         if (k > 6) q(2) = factors(k)
         kept = q
         call rotate_one(name, b, q, status)
         if (status /= merge(poinsot_e_not_unit, poinsot_e_not_finite, k <= 6)) figure = broken
         if (any(transfer(q, [0, 0]) /= transfer(kept, [0, 0]))) figure = broken
      end do
   end function no_unit

   !> Ten steps of one body as a host takes them; the status is the body's.
   subroutine rotate_one(name, b, q, status)
      character(*), intent(in) :: name
      integer, intent(in) :: b
      real(dp), intent(inout) :: q(4)
      integer, intent(out) :: status
      type(free_method) :: method
      type(body_class) :: class
      type(body_view) :: view
      type(poinsot_error) :: error
      real(dp), target :: yy(3, 1), qq(4, 1)
      integer, target :: each(1)
      call find_method(name, method, error)
      call make_class(moments(:, b), class, error)
      yy(:, 1) = momenta(:, b)
      qq(:, 1) = q
      each = poinsot_ok
      call view_rows(yy, qq, view)
      view%status => each
      call rotate_bodies(class, method, 0.1_dp, 10, view, 1, status, error)
      q = qq(:, 1)
      status = each(1)
   end subroutine rotate_one

   pure logical function far(status)
      integer, intent(in) :: status
      far = status == poinsot_e_step .or. status == poinsot_e_convergence
   end function far

   !> How far two states lie apart, in 1e-16 of |y| and of 1; `broken` without a state.
   real(dp) function gap(status, y, q, z, r)
      integer, intent(in) :: status(2)
      real(dp), intent(in) :: y(3), q(4), z(3), r(4)
      gap = broken
      if (any(status /= poinsot_ok)) return
      if (.not. all(ieee_is_finite([y, q, z, r]))) return
      gap = max(norm2(y - z)/norm2(y), norm2(q - r))/1e-16_dp
   end function gap

end module poinsot_study_hard_promises
