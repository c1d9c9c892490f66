!> The end of a scene by equations of (y, q) that share nothing with the library but the numbers of
!> the scene: torques straight from their formulas, Gragg's midpoint rule extrapolated (Hairer,
!> Norsett and Wanner, section II.9), in the longest arithmetic that is fast: of 64 bits at least.
module test_judge_scene
   use poinsot_core_kinds, only: dp, qp
   use poinsot_effect_settings, only: setting
   use poinsot_scene_settings, only: scene_settings, effect_setting
   use poinsot_study_members, only: member_set
   implicit none(type, external)
   private
   public :: judged_body, judge_body, judge_members, judge_flow

   integer, parameter, public :: wp = selected_real_kind(18, 4000)
   integer, parameter :: most_columns = 12
   integer, parameter :: usual_columns = 10, other_columns = 8

   !> A torque by its formula.
   type :: torque
      character(18) :: name = ""
      character(12) :: motion = "static"      !! of a field; of an orbit: "circular", "fixed"
      real(wp) :: body(3) = 0                 !! dipole, weight times centre, axis, rotor, friction
      real(wp) :: space(3) = [0, 0, 1]        !! up, strength, direction
      real(wp) :: about(3) = [0, 0, 1]        !! a field turns about
      real(wp) :: strength = 1                !! stiffness, rate of an orbit
      real(wp) :: frequency = 0, phase = 0
   end type torque

   !> A body and what acts on it.
   type :: judged_body
      real(wp) :: moments(3) = 1
      type(torque), allocatable :: torques(:)
   end type judged_body

contains

   !> The body of a group of a scene. `known` is false if a torque or a frame is not among those
   !> here.
   subroutine judge_body(scene, group, body, known)
      type(scene_settings), intent(in) :: scene
      integer, intent(in) :: group
      type(judged_body), intent(out) :: body
      logical, intent(out) :: known
      integer :: i
      known = .not. scene%bodies(group)%turned
      body%moments = scene%bodies(group)%moments
      allocate (body%torques(size(scene%effects)))
      do i = 1, size(scene%effects)
         call read_torque(scene%effects(i), body%torques(i), known)
      end do
   end subroutine judge_body

   subroutine read_torque(effect, one, known)
      type(effect_setting), intent(in) :: effect
      type(torque), intent(out) :: one
      logical, intent(inout) :: known
      integer :: i
      real(wp) :: weight
      one%name = effect%name
      weight = 1
      if (effect%name == "gravity_gradient") one%motion = "circular"
      do i = 1, size(effect%settings)
         associate (s => effect%settings(i))
            select case (effect%name // "." // s%key)
            case ("gravity.centre", "field.dipole", "spring.axis", "gyrostat.rotor")
               one%body = s%values
            case ("drag.friction")
               one%body = s%values(1)
               if (size(s%values) == 3) one%body = s%values
            case ("gravity.weight"); weight = s%values(1)
            case ("gravity.up", "field.strength", "spring.direction"); one%space = s%values
            case ("field.motion", "gravity_gradient.orbit"); one%motion = s%text
            case ("field.frequency"); one%frequency = s%values(1)
            case ("field.phase"); one%phase = s%values(1)
            case ("field.axis"); one%about = unit(real(s%values, wp))
            case ("spring.stiffness", "gravity_gradient.rate"); one%strength = s%values(1)
            case default; known = .false.
            end select
         end associate
      end do
      select case (effect%name)
      case ("gravity")
         one%body = weight*one%body
         one%space = unit(one%space)
      case ("spring")
         one%body = unit(one%body)
         one%space = unit(one%space)
      case ("field", "gravity_gradient", "gyrostat", "drag"); continue
      case default; known = .false.
      end select
   end subroutine read_torque

   pure function unit(v) result(u)
      real(wp), intent(in) :: v(3)
      real(wp) :: u(3)
      u = v/sqrt(sum(v*v))
   end function unit

   !> All bodies from 0 to t_end; how far two solutions of different orders lie apart where that was
   !> tried, on the first few.
   subroutine judge_members(scene, members, t_end, y, q, doubt, known)
      type(scene_settings), intent(in) :: scene
      type(member_set), intent(in) :: members
      real(dp), intent(in) :: t_end
      real(qp), allocatable, intent(out) :: y(:, :), q(:, :)
      real(dp), intent(out) :: doubt
      logical, intent(out) :: known
      integer, parameter :: tried = 4
      type(judged_body), allocatable :: bodies(:)
      real(wp) :: x(7), z(7)
      integer :: i
      doubt = 0
      known = .true.
      allocate (bodies(size(scene%bodies)), y(3, members%n), q(4, members%n))
      do i = 1, size(bodies)
         call judge_body(scene, i, bodies(i), known)
         if (.not. known) return
      end do
      !$omp parallel do schedule(dynamic, 8) private(x, z) reduction(max: doubt)
      do i = 1, members%n
         x(1:3) = members%y(:, i)
         x(4:7) = members%q(:, i)
         x(4:7) = x(4:7)/sqrt(sum(x(4:7)**2))
         z = x
         call judge_flow(bodies(members%group(i)), usual_columns, 0.0_wp, real(t_end, wp), x)
         if (i <= tried) then
            call judge_flow(bodies(members%group(i)), other_columns, 0.0_wp, real(t_end, wp), z)
            doubt = max(doubt, real(distance(x, z), dp))
         end if
         y(:, i) = x(1:3)
         q(:, i) = x(4:7)
         q(:, i) = q(:, i)/sqrt(sum(q(:, i)**2))
      end do
      !$omp end parallel do
   end subroutine judge_members

   !> In radians and parts of |y|.
   pure real(wp) function distance(x, z)
      real(wp), intent(in) :: x(7), z(7)
      distance = max(norm2(x(1:3) - z(1:3))/max(norm2(x(1:3)), tiny(distance)), &
         2*norm2(x(4:7) - z(4:7)))
   end function distance

   !> Carry (y, q) from t0 to t1, either way. The step is that with which the last two columns of
   !> the table agree to rounding.
   pure subroutine judge_flow(body, columns, t0, t1, x)
      type(judged_body), intent(in) :: body
      integer, intent(in) :: columns           !! the order is twice as many
      real(wp), intent(in) :: t0, t1
      real(wp), intent(inout) :: x(7)          !! y, then q
      real(wp), parameter :: tolerance = 8*epsilon(t0)
      real(wp) :: t, h, z(7), off
      t = t0
      h = (t1 - t0)/64
      do while (abs(t1 - t) > 0)
         if (abs(h) >= abs(t1 - t)) h = t1 - t
         call extrapolate(body, columns, t, h, x, z, off)
         if (off <= tolerance) then
            x = z
            t = t + h
            if (abs(t1 - t) <= 4*epsilon(t)*abs(t1)) exit
         end if
         h = h*min(2.0_wp, max(0.2_wp, 0.9_wp*(tolerance/max(off, 1e-4_wp*tolerance))** &
            (1.0_wp/(2*columns - 1))))
      end do
   end subroutine judge_flow

   !> One step of length h by 2, 4, ... substeps; `off`: what the last column changed.
   pure subroutine extrapolate(body, columns, t, h, x, z, off)
      type(judged_body), intent(in) :: body
      integer, intent(in) :: columns
      real(wp), intent(in) :: t, h, x(7)
      real(wp), intent(out) :: z(7), off
      real(wp), dimension(7) :: a, b, c, start
      real(wp) :: table(7, most_columns), last(7, most_columns), s
      integer :: i, k, n
      start = slope(body, t, x)
      do k = 1, columns
         n = 2*k
         s = h/n
         ! changes of x alone: they round less
         a = 0
         b = s*start
         do i = 1, n - 1
            c = a + 2*s*slope(body, t + i*s, x + b)
            a = b
            b = c
         end do
         table(:, 1) = (a + b + s*slope(body, t + h, x + b))/2
         do i = 2, k
            table(:, i) = table(:, i - 1) + (table(:, i - 1) - last(:, i - 1))/ &
               ((real(k, wp)/(k - i + 1))**2 - 1)
         end do
         last(:, :k) = table(:, :k)
      end do
      z = x + table(:, columns)
      a = table(:, columns) - table(:, columns - 1)
      off = max(norm2(a(1:3))/max(norm2(x(1:3)), tiny(off)), norm2(a(4:7)))
   end subroutine extrapolate

   !> Right-hand side: y' = y x omega + torques, q' = q (0, omega)/2.
   pure function slope(body, t, x) result(dx)
      type(judged_body), intent(in) :: body
      real(wp), intent(in) :: t, x(7)
      real(wp) :: dx(7), w(3)
      integer :: i
      w = x(1:3)
      do i = 1, size(body%torques)
         if (body%torques(i)%name == "gyrostat") w = w - body%torques(i)%body
      end do
      where (body%moments > 0) w = w/body%moments
      where (.not. body%moments > 0) w = 0
      dx(1:3) = cross(x(1:3), w)
      do i = 1, size(body%torques)
         dx(1:3) = dx(1:3) + torque_of(body%torques(i), body%moments, t, x(4:7), w)
      end do
      where (.not. body%moments > 0) dx(1:3) = 0
      dx(4) = -(x(5)*w(1) + x(6)*w(2) + x(7)*w(3))/2
      dx(5:7) = (x(4)*w + cross(x(5:7), w))/2
   end function slope

   pure function torque_of(one, moments, t, q, w) result(g)
      type(torque), intent(in) :: one
      real(wp), intent(in) :: moments(3), t, q(4), w(3)
      real(wp) :: g(3), e(3)
      select case (one%name)
      case ("gravity")        ! U = weight centre.(Q^T up)
         g = cross(seen(q, one%space), one%body)
      case ("field")          ! U = -dipole.(Q^T field)
         e = one%space
         if (one%motion == "rotating") e = turned(e, one%about, one%frequency*t + one%phase)
         if (one%motion == "oscillating") e = e*cos(one%frequency*t + one%phase)
         g = cross(one%body, seen(q, e))
      case ("gravity_gradient") ! U = (3/2) rate^2 e.I e
         e = [1, 0, 0]
         if (one%motion == "circular") e = [cos(one%strength*t), sin(one%strength*t), 0.0_wp]
         e = seen(q, e)
         g = 3*one%strength**2*cross(e, moments*e)
      case ("spring")         ! U = -(stiffness/2) (axis.(Q^T direction))^2
         e = seen(q, one%space)
         g = one%strength*dot_product(one%body, e)*cross(one%body, e)
      case ("drag")
         g = -one%body*w
      case default            ! a rotor is no torque
         g = 0
      end select
   end function torque_of

   !> v turned about a unit axis.
   pure function turned(v, axis, angle) result(u)
      real(wp), intent(in) :: v(3), axis(3), angle
      real(wp) :: u(3)
      u = cos(angle)*v + sin(angle)*cross(axis, v) + (1 - cos(angle))*dot_product(axis, v)*axis
   end function turned

   !> Q^T v, for q of any length.
   pure function seen(q, v) result(u)
      real(wp), intent(in) :: q(4), v(3)
      real(wp) :: u(3), w(3)
      w = 2*cross(v, q(2:4))
      u = v + (q(1)*w + cross(w, q(2:4)))/(q(1)**2 + q(2)**2 + q(3)**2 + q(4)**2)
   end function seen

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)
      c(1) = a(2)*b(3) - a(3)*b(2)
      c(2) = a(3)*b(1) - a(1)*b(3)
      c(3) = a(1)*b(2) - a(2)*b(1)
   end function cross

end module test_judge_scene
