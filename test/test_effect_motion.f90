!> What theory says of the motion under each effect: conserved quantities, frequencies, exact
!> solutions (the analytic checks the registry names).
module test_effect_motion
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error
   use poinsot_effect_effect, only: effect_item, pair_effect
   use poinsot_effect_callback, only: user_potential, user_torque
   use poinsot_effect_registry, only: make_effect
   use poinsot_effect_settings, only: setting, number_setting, text_setting
   use poinsot_splitting_stepper, only: flows, run_steps
   use poinsot_splitting_block_flows, only: block_flows
   use test_expectation, only: expect
   use test_oracle_algebra, only: rotate, rotate_back
   use test_turning, only: bench, set_up, place, run, generic_moments_of, generic_y, generic_q
   implicit none(type, external)
   private
   public :: collect_motion

   real(dp), parameter :: pi = acos(-1.0_dp)
   real(dp), parameter :: x_axis(3) = [1.0_dp, 0.0_dp, 0.0_dp], y_axis(3) = [0.0_dp, 1.0_dp, &
      0.0_dp], &
      z_axis(3) = [0.0_dp, 0.0_dp, 1.0_dp], nowhere(3) = [0.0_dp, 0.0_dp, 0.0_dp]
   real(dp), parameter :: unity(4) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]

   !> The heavy top by a user: U = l.Q^T z as a torque of its own, and as a potential of Q.
   type, extends(user_torque) :: own_torque
   contains
      procedure :: evaluate => evaluate_torque
   end type own_torque
   type, extends(user_potential) :: own_potential
   contains
      procedure :: evaluate => evaluate_potential
   end type own_potential
   real(dp), parameter :: arm(3) = [0.3_dp, -0.4_dp, 0.9_dp]

   !> One block of bodies that see each other.
   type, extends(flows) :: coupled
      type(block_flows) :: block
      class(pair_effect), pointer :: pair => null()
      integer :: body(lanes) = 0
      real(dp) :: g(lanes, 3) = 0
   contains
      procedure :: drift => coupled_drift
      procedure :: kick => coupled_kick
   end type coupled

contains

   subroutine collect_motion(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("gravity-steady-precession", test_precession), &
         new_unittest("gravity-lagrange-integrals", test_lagrange), &
         new_unittest("gravity-sleeping-top", test_sleeping), &
         new_unittest("gravity-kovalevskaya", test_kovalevskaya), &
         new_unittest("field-libration", test_field), &
         new_unittest("field-fast-oscillation", test_fast_field), &
         new_unittest("field-rotating-carries-along", test_rotating_field), &
         new_unittest("gradient-pitch-libration", test_pitch), &
         new_unittest("spring-libration", test_spring), &
         new_unittest("torque-in-space-adds-up", test_space_torque), &
         new_unittest("torque-harmonic-integral", test_harmonic), &
         new_unittest("drag-sphere", test_drag), &
         new_unittest("drag-power", test_drag_power), &
         new_unittest("gyrostat-integrals", test_gyrostat), &
         new_unittest("gyrostat-steadies-middle-axis", test_middle), &
         new_unittest("dipoles-frequencies", test_dipoles), &
         new_unittest("dipoles-momentum-along-line", test_dipole_momentum), &
         new_unittest("callback-heavy-top", test_callback)]
   end subroutine collect_motion

   !> Symmetric top at tilt th: I1 W^2 cos(th) - I3 w3 W + m g l = 0 gives its steady precession W.
   subroutine test_precession(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      real(dp), parameter :: i1 = 0.8_dp, i3 = 0.5_dp, mgl = 1.3_dp, th = 0.6_dp, spin = 6.0_dp, &
         t = 3.0_dp
      real(dp) :: rate, y(3), q(4), axis(3), late
      integer :: root
      do root = -1, 1, 2
         rate = (i3*spin + root*sqrt((i3*spin)**2 - 4*i1*mgl*cos(th)))/(2*i1*cos(th))
         call set_up(it, [i1, i1, i3], "exact", "srkn6", [gravity([0.0_dp, 0.0_dp, mgl])])
         call expect(error, it%good, it%message)
         y = [0.0_dp, i1*rate*sin(th), i3*spin]
         q = [cos(0.5_dp*th), sin(0.5_dp*th), 0.0_dp, 0.0_dp]
         call place(it, y, q)
         call run(it, 0.0_dp, t/600, 0, 600)
         axis = rotate(it%block%q(1, :), z_axis)
         call expect(error, axis(3), cos(th), thr=1e-11_dp, message="tilt")
         late = modulo(atan2(axis(1), -axis(2)) - rate*t + pi, 2*pi) - pi
         call expect(error, abs(late) < 1e-10_dp, "precession")
      end do
   end subroutine test_precession

   !> Lagrange's top: y3, L_z and the energy are kept.
   subroutine test_lagrange(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      real(dp) :: y(3), l(3), kinetic(lanes), potential(lanes), energy
      call set_up(it, [0.8_dp, 0.8_dp, 0.5_dp], "exact", "srkn6", &
                  [gravity([0.0_dp, 0.0_dp, 1.3_dp])])
      call place(it, generic_y, generic_q)
      call it%block%energies(0.0_dp, kinetic, potential)
      energy = kinetic(1) + potential(1)
      call run(it, 0.0_dp, 0.02_dp, 0, 2000)
      y = it%block%y(1, :)
      l = rotate(it%block%q(1, :), y) - rotate(generic_q, generic_y)
      call it%block%energies(0.0_dp, kinetic, potential)
      call expect(error, y(3), generic_y(3), thr=2e-14_dp, message="y3")
      call expect(error, l(3), 0.0_dp, thr=2e-13_dp, message="L_z")
      call expect(error, abs(l(1)) > 0.01_dp, "L_x is kept too: is there gravity?")
      call expect(error, kinetic(1) + potential(1), energy, thr=1e-11_dp, message="energy")
   end subroutine test_lagrange

   !> Upright and spinning, stable if and only if I3^2 w3^2 > 4 I1 m g l: 5 % above and below.
   subroutine test_sleeping(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      real(dp), parameter :: i1 = 0.8_dp, i3 = 0.5_dp, mgl = 1.3_dp
      real(dp) :: tilt, axis(3)
      integer :: k, side
      do side = -1, 1, 2
         call set_up(it, [i1, i1, i3], "exact", "srkn4", [gravity([0.0_dp, 0.0_dp, mgl])])
         call place(it, [0.0_dp, 0.0_dp, sqrt(4*i1*mgl)*(1 + 0.025_dp*side)], [1.0_dp, 1e-3_dp, &
            0.0_dp, 0.0_dp])
         tilt = 0
         do k = 1, 100
            call run(it, 0.0_dp, 0.05_dp, 10*k, 10)
            axis = rotate(it%block%q(1, :), z_axis)
            tilt = max(tilt, norm2(axis(1:2)))
         end do
         if (side > 0) call expect(error, tilt < 0.03_dp, "a fast top fell over")
         if (side < 0) call expect(error, tilt > 0.2_dp, "a slow top did not fall")
      end do
   end subroutine test_sleeping

   !> Kovalevskaya's top, I1 = I2 = 2 I3, centre on axis 1. With gamma upwards, U = m g a gamma1 and
   !> c = m g a/I3 her integral is (w1^2 - w2^2 - c g1)^2 + (2 w1 w2 - c g2)^2.
   subroutine test_kovalevskaya(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      real(dp), parameter :: i3 = 0.5_dp, mga = 0.7_dp
      real(dp) :: before, after
      call set_up(it, [2*i3, 2*i3, i3], "exact", "srkn6", [gravity([mga, 0.0_dp, 0.0_dp])])
      call place(it, generic_y, generic_q)
      before = integral(it)
      call run(it, 0.0_dp, 0.02_dp, 0, 1000)
      after = integral(it)
      call expect(error, after, before, thr=1e-10_dp)

   contains

      real(dp) function integral(top)
         type(bench), intent(in) :: top
         real(dp) :: w(3), g(3)
         w = top%block%y(1, :)*top%class%inverse
         g = rotate_back(top%block%q(1, :), z_axis)
         integral = (w(1)**2 - w(2)**2 - mga/i3*g(1))**2 + (2*w(1)*w(2) - mga/i3*g(2))**2
      end function integral

   end subroutine test_kovalevskaya

   !> A small libration comes back after 2 pi / sqrt(mu E/I).
   subroutine test_field(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      call set_up(it, [0.6_dp, 1.0_dp, 0.8_dp], "exact", "srkn6", [one("field", &
         [number_setting("dipole", [0.0_dp, 0.0_dp, 0.7_dp]), number_setting("strength", [0.0_dp, &
         0.0_dp, 1.9_dp])])])
      call libration(it, 1, sqrt(0.7_dp*1.9_dp/0.6_dp), error)
      if (allocated(error)) return
      call libration(it, 2, sqrt(0.7_dp*1.9_dp/1.0_dp), error)
   end subroutine test_field

   !> Turned by 1e-4 about axis j and let go: after a quarter, a half and a whole period at the
   !> middle, the far end, and back.
   subroutine libration(it, j, rate, error)
      type(bench), intent(inout) :: it
      integer, intent(in) :: j
      real(dp), intent(in) :: rate
      type(error_type), allocatable, intent(out) :: error
      real(dp), parameter :: small = 1e-4_dp
      real(dp) :: q(4), part(3), h
      integer :: k
      call expect(error, it%good, it%message)
      q = 0
      q(1) = cos(0.5_dp*small)
      q(1 + j) = sin(0.5_dp*small)
      call place(it, nowhere, q)
      h = 2*pi/rate/400
      do k = 1, 3
         call run(it, 0.0_dp, h, 0, merge(200, 100, k == 3))
         it%block%fresh = .false.
         part(k) = 2*it%block%q(1, 1 + j)/small
      end do
      call expect(error, maxval(abs(part - [0.0_dp, -1.0_dp, 1.0_dp])) < 1e-7_dp, &
         "libration is not sqrt(k/I)")
      call expect(error, abs(it%block%y(1, j)) < 1e-7_dp*small*rate, "not at rest after a period")
   end subroutine libration

   !> E0 cos(W t), W fast: slow libration at mu E0/(sqrt(2) I W), within 1 %, seen once per fast
   !> period.
   subroutine test_fast_field(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      real(dp), parameter :: i1 = 0.6_dp, pull = 1.2_dp, fast = 40.0_dp, small = 1e-3_dp
      real(dp) :: slow, first, last, before, now, period
      integer :: k, crossings
      call set_up(it, [i1, i1, i1], "exact", "srkn4", [one("field", &
                  [number_setting("dipole", pull*z_axis), number_setting("strength", z_axis), &
                  number_setting("frequency", [fast]), text_setting("motion", "oscillating")])])
      call expect(error, it%good, it%message)
      call place(it, nowhere, [cos(0.5_dp*small), sin(0.5_dp*small), 0.0_dp, 0.0_dp])
      slow = pull/(sqrt(2.0_dp)*i1*fast)
      period = 2*pi/fast
      crossings = 0
      first = 0
      last = 0
      before = it%block%q(1, 2)
      do k = 1, nint(3.3_dp*2*pi/slow/period)
         call run(it, 0.0_dp, period/24, 24*(k - 1), 24)
         now = it%block%q(1, 2)
         if (before > 0 .neqv. now > 0) then
            crossings = crossings + 1
            last = (k - now/(now - before))*period
            if (crossings == 1) first = last
         end if
         before = now
      end do
      call expect(error, crossings > 4, "no slow libration")
      call expect(error, pi*(crossings - 1)/(last - first)/slow, 1.0_dp, thr=0.01_dp, &
         message="slow rate")
   end subroutine test_fast_field

   !> In a field that rotates with the body's own rate about a principal axis, the dipole stays
   !> along it.
   subroutine test_rotating_field(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      real(dp), parameter :: rate = 1.7_dp, t = 5.0_dp
      real(dp) :: direction(3)
      call set_up(it, generic_moments_of, "exact", "srkn6", [one("field", &
         [number_setting("dipole", x_axis), &
         number_setting("strength", 2*x_axis), number_setting("frequency", [rate]), &
         text_setting("motion", "rotating")])])
      call place(it, [0.0_dp, 0.0_dp, rate*generic_moments_of(3)], unity)
      call run(it, 0.0_dp, t/500, 0, 500)
      direction = rotate(it%block%q(1, :), x_axis)
      call expect(error, norm2(direction - [cos(rate*t), sin(rate*t), 0.0_dp]) < 1e-12_dp, &
         "left behind")
   end subroutine test_rotating_field

   !> On a circular orbit, yaw along the radius, pitch normal to the orbit: pitch librates at n
   !> sqrt(3 (I_roll - I_yaw)/I_pitch).
   subroutine test_pitch(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      real(dp), parameter :: n = 0.7_dp, yaw = 0.6_dp, roll = 0.8_dp, pitch = 1.0_dp, &
         small = 1e-4_dp
      real(dp) :: period, offset
      call set_up(it, [yaw, roll, pitch], "exact", "srkn6", [one("gravity_gradient", &
         [number_setting("rate", [n])])])
      call expect(error, it%good, it%message)
      period = 2*pi/(n*sqrt(3*(roll - yaw)/pitch))
      call place(it, [0.0_dp, 0.0_dp, pitch*n], [cos(0.5_dp*small), 0.0_dp, 0.0_dp, &
         sin(0.5_dp*small)])
      call run(it, 0.0_dp, period/500, 0, 250)
      offset = 2*atan2(it%block%q(1, 4), it%block%q(1, 1)) - 0.5_dp*n*period
      call expect(error, modulo(offset/small + 1 + pi/small, 2*pi/small) - pi/small, 0.0_dp, &
         thr=1e-6_dp, message="half")
      it%block%fresh = .false.
      call run(it, 0.0_dp, period/500, 250, 250)
      offset = 2*atan2(it%block%q(1, 4), it%block%q(1, 1)) - n*period
      call expect(error, modulo(offset/small - 1 + pi/small, 2*pi/small) - pi/small, 0.0_dp, &
         thr=1e-6_dp, message="whole")
   end subroutine test_pitch

   subroutine test_spring(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      call set_up(it, [0.6_dp, 1.0_dp, 0.8_dp], "exact", "srkn6", [one("spring", &
         [number_setting("stiffness", [1.7_dp])])])
      call libration(it, 1, sqrt(1.7_dp/0.6_dp), error)
      if (allocated(error)) return
      call libration(it, 2, sqrt(1.7_dp/1.0_dp), error)
   end subroutine test_spring

   !> A constant torque in space: L = L0 + t torque up to rounding, whatever the step and the body.
   subroutine test_space_torque(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      real(dp), parameter :: value(3) = [0.3_dp, -0.2_dp, 0.5_dp], t = 4.0_dp
      real(dp) :: l(3)
      call set_up(it, generic_moments_of, "exact", "strang", [one("torque", &
         [number_setting("value", value), text_setting("frame", "space")])])
      call place(it, generic_y, generic_q)
      call run(it, 0.0_dp, t/20, 0, 20)
      l = rotate(it%block%q(1, :), it%block%y(1, :))
      call expect(error, norm2(l - rotate(generic_q, generic_y) - t*value) < 1e-14_dp, &
         "L0 + integral")
   end subroutine test_space_torque

   !> A harmonic torque in space: L = L0 + value [sin(W t + phase) - sin(phase)]/W to the order of
   !> the scheme, here 6.
   subroutine test_harmonic(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      real(dp), parameter :: value(3) = [0.3_dp, -0.2_dp, 0.5_dp], t = 4.0_dp, w = 2.0_dp, &
         phase = 0.3_dp
      real(dp) :: l(3)
      call set_up(it, generic_moments_of, "exact", "srkn6", [one("torque", &
         [number_setting("value", value), &
         number_setting("frequency", [w]), number_setting("phase", [phase]), &
         text_setting("frame", "space")])])
      call place(it, generic_y, generic_q)
      call run(it, 0.0_dp, t/100, 0, 100)
      l = rotate(it%block%q(1, :), it%block%y(1, :)) - rotate(generic_q, generic_y)
      call expect(error, norm2(l - value*(sin(w*t + phase) - sin(phase))/w) < 1e-13_dp, &
         "integral of the torque")
   end subroutine test_harmonic

   !> A sphere: y(t) = exp(-friction t/I) turned back, exact for any step.
   subroutine test_drag(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      real(dp), parameter :: t = 3.0_dp
      real(dp) :: l(3)
      call set_up(it, [0.7_dp, 0.7_dp, 0.7_dp], "exact", "srkn6", [one("drag", &
         [number_setting("friction", [0.4_dp])])])
      call place(it, generic_y, generic_q)
      call run(it, 0.0_dp, t/3, 0, 3)
      l = rotate(it%block%q(1, :), it%block%y(1, :))
      call expect(error, norm2(l - exp(-0.4_dp*t/0.7_dp)*rotate(generic_q, generic_y)) &
         < 1e-14_dp, "decay")
   end subroutine test_drag

   !> Energy lost over a run = integral of omega.friction omega, by Simpson's rule along the way.
   subroutine test_drag_power(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      real(dp), parameter :: friction(3) = [0.5_dp, 0.2_dp, 0.9_dp], h = 2e-3_dp
      real(dp) :: kinetic(lanes), potential(lanes), before, lost
      integer :: k
      call set_up(it, generic_moments_of, "exact", "strang", [one("drag", &
         [number_setting("friction", friction)])])
      call place(it, generic_y, generic_q)
      call it%block%energies(0.0_dp, kinetic, potential)
      before = kinetic(1)
      lost = power(it)
      do k = 1, 500
         call run(it, 0.0_dp, h, k, 1)
         lost = lost + power(it)*merge(4, 2, mod(k, 2) == 1)
      end do
      lost = (lost - power(it))*h/3
      call it%block%energies(0.0_dp, kinetic, potential)
      call expect(error, before - kinetic(1), lost, thr=1e-6_dp)

   contains

      real(dp) function power(turning)
         type(bench), intent(in) :: turning
         power = sum(friction*(turning%block%y(1, :)*turning%class%inverse)**2)
      end function power

   end subroutine test_drag_power

   !> |y| and T = (y - s).J^-1 (y - s)/2 are kept, and so is L = Q y in space.
   subroutine test_gyrostat(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      real(dp) :: kinetic(lanes), potential(lanes), before, l(3)
      call set_up(it, generic_moments_of, "exact", "omelyan8", [one("gyrostat", &
         [number_setting("rotor", [0.4_dp, -0.3_dp, 0.6_dp])])])
      call expect(error, it%good, it%message)
      call place(it, generic_y, generic_q)
      call it%block%energies(0.0_dp, kinetic, potential)
      before = kinetic(1)
      call run(it, 0.0_dp, 0.1_dp, 0, 500)
      call it%block%energies(0.0_dp, kinetic, potential)
      call expect(error, kinetic(1), before, thr=1e-11_dp, message="T")
      call expect(error, norm2(it%block%y(1, :)), norm2(generic_y), thr=1e-12_dp, message="|y|")
      l = rotate(it%block%q(1, :), it%block%y(1, :)) - rotate(generic_q, generic_y)
      call expect(error, norm2(l) < 1e-12_dp, "L")
   end subroutine test_gyrostat

   !> Spin about the middle axis turns over by itself and stays with a rotor along that axis.
   subroutine test_middle(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it
      integer :: k, with
      real(dp) :: least
      do with = 0, 1
         if (with == 1) then
            call set_up(it, [0.6_dp, 0.8_dp, 1.0_dp], "exact", "srkn4", [one("gyrostat", &
               [number_setting("rotor", [0.0_dp, 0.8_dp, 0.0_dp])])])
         else
            call set_up(it, [0.6_dp, 0.8_dp, 1.0_dp], "exact", "srkn4", [effect_item ::])
         end if
         call place(it, [1e-3_dp, 0.8_dp, 1e-3_dp], unity)
         least = 1
         do k = 1, 200
            call run(it, 0.0_dp, 0.1_dp, 5*k, 5)
            least = min(least, it%block%y(1, 2)/0.8_dp)
         end do
         if (with == 1) call expect(error, least > 0.99_dp, "turned over with a rotor")
         if (with == 0) call expect(error, least < -0.99_dp, "did not turn over without a rotor")
      end do
   end subroutine test_middle

   !> Two dipoles head to tail, C = coupling mu^2: opposite tilts librate at sqrt(C/(I r^3)), equal
   !> tilts at sqrt(3 C/(I r^3)).
   subroutine test_dipoles(error)
      type(error_type), allocatable, intent(out) :: error
      type(coupled), target :: two
      type(bench), target :: it
      type(effect_item), target :: pair
      real(dp), parameter :: inertia = 0.6_dp, strength = 1.7_dp*0.49_dp/1.5_dp**3, small = 1e-4_dp
      real(dp) :: rate, part(2)
      integer :: mode
      pair = one("dipoles", [number_setting("dipole", 0.7_dp*x_axis), &
         number_setting("coupling", [1.7_dp]), number_setting("spacing", [1.5_dp])])
      do mode = 1, 2
         rate = sqrt(merge(1, 3, mode == 1)*strength/inertia)
         call set_up(it, [inertia, inertia, inertia], "exact", "srkn6", [gravity(nowhere)])
         call pair_up(two, it, pair)
         two%block%q(1:2, 4) = sin(0.5_dp*small)
         two%block%q(1:2, 1) = cos(0.5_dp*small)
         if (mode == 1) two%block%q(2, 4) = -two%block%q(2, 4)
         call run_steps(it%scheme, two, 0.0_dp, 2*pi/rate/400, 0_i8, 200_i8)
         part = two%block%q(1:2, 4)/(0.5_dp*small)
         call expect(error, maxval(abs(part - [-1.0_dp, merge(1.0_dp, -1.0_dp, mode == 1)])) &
            < 1e-7_dp, "half a period")
         call run_steps(it%scheme, two, 0.0_dp, 2*pi/rate/400, 200_i8, 200_i8)
         call expect(error, maxval(abs(two%block%y(1:2, 3))) < 1e-6_dp*small*rate, &
            "not at rest after a period")
      end do
   end subroutine test_dipoles

   !> Fixed places take angular momentum, but not along the line that joins two of them; energy is
   !> kept.
   subroutine test_dipole_momentum(error)
      type(error_type), allocatable, intent(out) :: error
      type(coupled), target :: two
      type(bench), target :: it
      type(effect_item), target :: pair
      real(dp) :: before(3), after(3), start, finish
      pair = one("dipoles", [number_setting("dipole", [0.3_dp, 0.5_dp, -0.2_dp]), &
         number_setting("spacing", [0.8_dp])])
      call set_up(it, generic_moments_of, "exact", "srkn6", [gravity(nowhere)])
      call pair_up(two, it, pair)
      two%block%q(1, :) = generic_q/norm2(generic_q)
      two%block%y(1, :) = generic_y
      two%block%y(2, :) = -generic_y(3:1:-1)
      before = momentum(two)
      start = energy(two)
      call run_steps(it%scheme, two, 0.0_dp, 0.02_dp, 0_i8, 500_i8)
      after = momentum(two)
      finish = energy(two)
      call expect(error, after(1), before(1), thr=1e-13_dp, message="L along the line")
      call expect(error, abs(after(2) - before(2)) > 1e-2_dp, "no torque at all?")
      call expect(error, finish, start, thr=1e-11_dp, message="energy")
   end subroutine test_dipole_momentum

   subroutine pair_up(two, it, pair)
      type(coupled), intent(inout) :: two
      type(bench), intent(inout) :: it
      type(effect_item), intent(in), target :: pair
      call place(it, nowhere, unity)
      two%block = it%block
      two%fresh = .false.
      two%has_dissipation = .false.
      two%halted = .false.
      two%fresh = .false.
      two%body = 0
      two%body(1:2) = [1, 2]
      select type (both => pair%it)
      class is (pair_effect)
         two%pair => both
      end select
   end subroutine pair_up

   function momentum(two) result(l)
      type(coupled), intent(in) :: two
      real(dp) :: l(3)
      l = rotate(two%block%q(1, :), two%block%y(1, :)) + rotate(two%block%q(2, :), &
         two%block%y(2, :))
   end function momentum

   function energy(two) result(e)
      type(coupled), intent(in) :: two
      real(dp) :: e, kinetic(lanes), potential(lanes), u(lanes, 1), x(3, 2)
      call two%block%energies(0.0_dp, kinetic, potential)
      u = 0
      call two%pair%add_energies([1], reshape(two%body, [lanes, 1]), &
                                 reshape(two%block%q, [lanes, 4, 1]), x, u)
      e = sum(kinetic(1:2)) + sum(u)
   end function energy

   subroutine coupled_drift(self, t, h)
      class(coupled), intent(inout) :: self
      real(dp), intent(in) :: t, h
      self%fresh = .false.
      call self%block%drift(t, h)
   end subroutine coupled_drift

   subroutine coupled_kick(self, t, b, c, ahead)
      class(coupled), intent(inout) :: self
      real(dp), intent(in) :: t, b, c, ahead
      real(dp) :: g(lanes, 3, 1), x(3, 2)
      g = 0*(t + c + ahead)
      if (.not. self%fresh) then
         call self%pair%add_torques([1], reshape(self%body, [lanes, 1]), reshape(self%block%q, &
            [lanes, 4, 1]), x, g)
         self%g = g(:, :, 1)
         self%fresh = .true.
      end if
      self%block%y = self%block%y + b*self%g
   end subroutine coupled_kick

   !> The heavy top by a user's torque and by a user's potential moves as under gravity.
   subroutine test_callback(error)
      type(error_type), allocatable, intent(out) :: error
      type(bench), target :: it, other
      type(effect_item) :: mine(1)
      real(dp) :: k1(lanes), u1(lanes), k2(lanes), u2(lanes)
      integer :: form
      call set_up(it, generic_moments_of, "exact", "srkn6", [gravity(arm)])
      call place(it, generic_y, generic_q)
      call run(it, 0.0_dp, 0.05_dp, 0, 100)
      call it%block%energies(5.0_dp, k1, u1)
      do form = 1, 2
         if (allocated(mine(1)%it)) deallocate (mine(1)%it)
         if (form == 1) allocate (own_torque :: mine(1)%it)
         if (form == 2) allocate (own_potential :: mine(1)%it)
         call set_up(other, generic_moments_of, "exact", "srkn6", mine)
         call expect(error, other%good, other%message)
         call place(other, generic_y, generic_q)
         call run(other, 0.0_dp, 0.05_dp, 0, 100)
         call expect(error, maxval(abs(other%block%y - it%block%y)) < 1e-12_dp .and. &
            maxval(abs(other%block%q - it%block%q)) < 1e-12_dp, "another motion")
         call other%block%energies(5.0_dp, k2, u2)
         call expect(error, maxval(abs(u1 - u2)) < 1e-12_dp, "another energy")
      end do
   end subroutine test_callback

   subroutine evaluate_torque(self, t, q, torque, energy)
      class(own_torque), intent(in) :: self
      real(dp), intent(in) :: t, q(4)
      real(dp), intent(out) :: torque(3), energy
      real(dp) :: g(3)
      g = rotate_back(q, z_axis)
      energy = dot_product(g, arm) + 0*t*self%class_index
      torque = [g(2)*arm(3) - g(3)*arm(2), g(3)*arm(1) - g(1)*arm(3), g(1)*arm(2) - g(2)*arm(1)]
   end subroutine evaluate_torque

   subroutine evaluate_potential(self, t, attitude, energy, gradient)
      class(own_potential), intent(in) :: self
      real(dp), intent(in) :: t, attitude(3, 3)
      real(dp), intent(out) :: energy, gradient(3, 3)
      energy = dot_product(attitude(3, :), arm) + 0*t*self%class_index
      gradient = 0
      gradient(3, :) = arm
   end subroutine evaluate_potential

   !> U = gamma.centre
   function gravity(centre) result(item)
      real(dp), intent(in) :: centre(3)
      type(effect_item) :: item
      item = one("gravity", [number_setting("centre", centre)])
   end function gravity

   function one(name, settings) result(item)
      character(*), intent(in) :: name
      type(setting), intent(in) :: settings(:)
      type(effect_item) :: item
      type(poinsot_error) :: refusal
      call make_effect(name, settings, item%it, refusal)
   end function one

end module test_effect_motion
