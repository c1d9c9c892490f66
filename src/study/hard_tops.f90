!> Tops and strong fields with every splitting and the exact rotor: one figure per splitting.
!>
!> A case is a procedure here and a row of `tops`.
module poinsot_study_hard_tops
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_partial
   use poinsot_effect_settings, only: setting
   use poinsot_effect_settings_text, only: read_settings
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_effect, set_option
   use poinsot_ensemble_step, only: step_bodies
   use poinsot_rotation_quaternion, only: rotate_back
   use poinsot_splitting_registry, only: find_splitting
   use poinsot_splitting_tableaux, only: splitting
   use poinsot_study_hard_promises, only: broken
   implicit none(type, external)
   private
   public :: top_names, top_bounds, top_about, measure_top, top_bound

   !> A case: its name, its bound in 1e-16 (-1: see top_bound), and its description.
   type :: top
      character(9) :: name
      real(dp) :: bound
      character(74) :: about
   end type top

   type(top), parameter :: tops(*) = [ &
      top("fast", 4e5_dp, "spin 1e4 times the precession, h spin = 50: energy and L_z kept"), &
      top("sleeping", 0.0_dp, "upright at the threshold of stability, 200 steps: it stays"), &
      top("nudged", 3e9_dp, "the same tilted by 1e-8: the tilt after 200 steps of .05"), &
      top("upright", -1.0_dp, "swings through the upright, h = .02, 500 steps: energy kept"), &
      top("back", -1.0_dp, "250 steps there and 250 back"), &
      top("strong", 1e14_dp, "a dipole in a field, h omega0 = .5, 2000 steps: energy kept"), &
      top("overflow", 0.0_dp, "a field of 1e80 units: a status, the state of before")]

   character(9), parameter :: top_names(*) = tops%name
   real(dp), parameter :: top_bounds(*) = tops%bound
   character(74), parameter :: top_about(*) = tops%about

   real(dp), parameter :: moments(3) = [0.6_dp, 0.6_dp, 1.0_dp]
   character(*), parameter :: weight = "centre = 0, 0, 1; weight = 1"

contains

   !> The bound of a case for a splitting, in 1e-16: some hold for the order of the scheme.
   real(dp) function top_bound(number, scheme) result(bound)
      integer, intent(in) :: number
      character(*), intent(in) :: scheme
      real(dp), parameter :: upright(4) = [5e12_dp, 2e11_dp, 1e6_dp, 2e4_dp] !! orders 2 to 8
      type(splitting) :: found
      type(poinsot_error) :: error
      bound = top_bounds(number)
      if (.not. bound < 0) return
      call find_splitting(scheme, found, error)
      if (top_names(number) == "upright") then
         bound = upright(max(1, min(size(upright), found%order/2)))
      else
         bound = merge(2e6_dp, 2000.0_dp, size(found%enter) > 0)
      end if
   end function top_bound

   !> Figure of a case, in 1e-16; `broken`: a NaN, or a status that should not be.
   real(dp) function measure_top(number, scheme) result(figure)
      integer, intent(in) :: number
      character(*), intent(in) :: scheme
      real(dp), parameter :: threshold = 1.5491933384829668_dp ! I3^2 w3^2 = 4 I1 m g l
      real(dp), parameter :: z(3) = [0.0_dp, 0.0_dp, 1.0_dp]
      select case (top_names(number))
      case ("fast")
         figure = lost(scheme, "gravity", weight, 5e-3_dp, 400, [0.1_dp, 0.0_dp, 1e4_dp], &
            [0.8_dp, 0.6_dp, 0.0_dp, 0.0_dp], z)
      case ("sleeping")
         figure = tilt(scheme, threshold, 0.0_dp)
      case ("nudged")
         figure = tilt(scheme, threshold, 5e-9_dp)
      case ("upright")
         figure = lost(scheme, "gravity", weight, 0.02_dp, 500, [1.2_dp, 0.0_dp, 0.3_dp], &
            [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], z)
      case ("back")
         figure = there_and_back(scheme)
      case ("strong")
         figure = lost(scheme, "field", "dipole = 0, 0, 1; strength = 0, 0, 1", &
            0.5_dp*sqrt(moments(1)), 2000, [0.05_dp, 0.0_dp, 0.0_dp], &
            [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], -z)
      case default
         figure = refused(scheme)
      end select
   end function measure_top

   !> What energy and the momentum about the vertical lose, in 1e-16 of the energy scale.
   real(dp) function lost(scheme, effect, settings, h, steps, y0, q0, centre) result(figure)
      character(*), intent(in) :: scheme, effect, settings
      real(dp), intent(in) :: h, y0(3), q0(4), centre(3)
      integer, intent(in) :: steps
      real(dp) :: y(3), q(4), before(2), after(2)
      integer :: status
      y = y0
      q = q0
      before = kept(y, q, centre)
      call run(scheme, effect, settings, h, steps, y, q, status)
      figure = broken
      if (status /= poinsot_ok .or. .not. all(ieee_is_finite([y, q]))) return
      after = kept(y, q, centre)
      figure = maxval(abs(after - before)/[1 + abs(before(1)), 1 + norm2(y0)])/1e-16_dp
   end function lost

   !> Energy, and momentum about the vertical.
   pure function kept(y, q, centre)
      real(dp), intent(in) :: y(3), q(4), centre(3)
      real(dp) :: kept(2), up(3)
      up = rotate_back(q, [0.0_dp, 0.0_dp, 1.0_dp])
      kept = [sum(y*y/moments)/2 + dot_product(up, centre), dot_product(y, up)]
   end function kept

   !> Tilt of a spinning top that starts at a small one, in 1e-16.
   real(dp) function tilt(scheme, spin, start) result(figure)
      character(*), intent(in) :: scheme
      real(dp), intent(in) :: spin, start
      real(dp) :: y(3), q(4)
      integer :: status
      y = [0.0_dp, 0.0_dp, spin]
      q = [1.0_dp, start, 0.0_dp, 0.0_dp]
      call run(scheme, "gravity", weight, 0.05_dp, 200, y, q, status)
      figure = broken
      if (status /= poinsot_ok .or. .not. all(ieee_is_finite([y, q]))) return
      figure = 2*norm2(q(2:3))/1e-16_dp
   end function tilt

   real(dp) function there_and_back(scheme) result(figure)
      character(*), intent(in) :: scheme
      real(dp), parameter :: y0(3) = [1.2_dp, 0.5_dp, -0.3_dp], q0(4) = [0.5_dp, -0.1_dp, 0.7_dp, &
         0.5_dp]
      real(dp) :: y(3), q(4)
      integer :: status(2)
      y = y0
      q = q0
      call run(scheme, "gravity", weight, 0.02_dp, 250, y, q, status(1))
      call run(scheme, "gravity", weight, -0.02_dp, 250, y, q, status(2))
      figure = broken
      if (all(status == poinsot_ok)) figure = max(norm2(y - y0), norm2(q - q0))/1e-16_dp
   end function there_and_back

   !> 0 if an impossible field is refused with the state of before, `broken` if not.
   real(dp) function refused(scheme) result(figure)
      character(*), intent(in) :: scheme
      real(dp), parameter :: y0(3) = [0.05_dp, 0.0_dp, 0.0_dp], q0(4) = [0.5_dp, 0.5_dp, 0.5_dp, &
         -0.5_dp]
      real(dp) :: y(3), q(4)
      integer :: status
      y = y0
      q = q0
      call run(scheme, "field", "dipole = 0, 0, 1; strength = 0, 0, 1e80", 0.1_dp, 3, y, q, status)
      figure = broken
      if (status /= poinsot_ok .and. all(abs(y - y0) <= 0) .and. all(abs(q - q0) <= 0)) figure = 0
   end function refused

   !> Steps of one body under an effect; the status is the body's.
   subroutine run(scheme, effect, text, h, steps, y, q, status)
      character(*), intent(in) :: scheme, effect, text
      real(dp), intent(in) :: h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(3), q(4)
      integer, intent(out) :: status
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(setting), allocatable :: settings(:)
      type(poinsot_error) :: error
      real(dp), target :: yy(3, 1), qq(4, 1)
      integer, target :: each(1)
      integer :: number
      call add_class(plan, moments, number, error)
      call set_option(plan, "method", "exact", error)
      call set_option(plan, "splitting", scheme, error)
      call read_settings(text, settings, error)
      if (.not. raised(error)) call add_effect(plan, effect, settings, error)
      call make_ready(plan, error)
      yy(:, 1) = y
      qq(:, 1) = q
      each = poinsot_ok
      call view_rows(yy, qq, view)
      view%status => each
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, int(steps, i8), status, error)
      y = yy(:, 1)
      q = qq(:, 1)
      if (status == poinsot_e_partial) status = each(1)
      if (raised(error)) status = error%code
   end subroutine run

end module poinsot_study_hard_tops
