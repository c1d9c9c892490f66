!> The judge of the matrix of entries: equations of motion of y and q by an extrapolated midpoint
!> rule in extended precision, in whatever body frame, with the torques of mathematics.md written
!> anew. Nothing of src but kinds; of a problem it reads the data.
!>
!> An effect that it has no law for is judged by its potential energy: the torque is the derivative
!> of that by a turn of the body.
module test_matrix_oracle
   use poinsot_core_kinds, only: dp
   use test_matrix_problem, only: problem, acting, n, classes, steps, h, tensor_of, &
      total_rotor, in_table, values_of
   implicit none(type, external)
   private
   public :: solve, energies, energy_source, has_law, is_random

   integer, parameter :: wp = selected_real_kind(18) !! 80 bits, or more where these are not there
   integer, parameter :: columns = 6                 !! of the extrapolation: order 12

   !> The potential energy of all bodies from effects without a law here.
   type, abstract :: energy_source
   contains
      procedure(total_energy), deferred :: total
   end type energy_source

   abstract interface
      real(dp) function total_energy(self, t, q)
         import :: energy_source, dp, n
         implicit none(type, external)
         class(energy_source), intent(inout), target :: self
         real(dp), intent(in) :: t, q(4, n)
      end function total_energy
   end interface

   !> What the equations need.
   type :: system
      type(problem) :: of
      real(wp) :: moment(3, 3, classes), inverse(3, 3, classes)
      real(wp) :: middle = 0            !! of the step at work: its side of a jump is meant
      logical :: continuous = .false.   !! friction is a torque; else a flow around each step
   end type system

contains

   !> Is there a law for this effect?
   pure logical function has_law(name)
      character(*), intent(in) :: name
      has_law = any(name == [character(18) :: "gravity", "field", "gravity_gradient", "spring", &
         "torque", "drag", "langevin", "gyrostat", "dipoles"])
   end function has_law

   !> Does chance act on these bodies?
   pure logical function is_random(this)
      type(problem), intent(in) :: this
      integer :: i
      is_random = .false.
      do i = 1, size(this%effects)
         if (number(this%effects(i), "temperature", 0.0_wp) > 0) is_random = .true.
      end do
   end function is_random

   !> The state after all steps. Friction as the library composes it, half a step of its exact flow
   !> before and after each step of the rest; or, `continuous`, as the torque that it is.
   subroutine solve(this, continuous, y, q, source)
      type(problem), intent(in) :: this
      logical, intent(in) :: continuous
      real(dp), intent(out) :: y(3, n), q(4, n)
      class(energy_source), intent(inout), optional :: source
      type(system) :: sys
      real(wp) :: x(7, n)
      integer :: k
      sys = system_of(this)
      sys%continuous = continuous
      x(:3, :) = this%y
      x(4:, :) = this%q
      do k = 1, steps
         sys%middle = (k - 0.5_wp)*h
         if (.not. continuous) call friction_flow(sys, .true., x)
         call extrapolated_step(sys, (k - 1)*real(h, wp), x, source)
         if (.not. continuous) call friction_flow(sys, .false., x)
      end do
      y = real(x(:3, :), dp)
      q = real(x(4:, :), dp)
   end subroutine solve

   function system_of(this) result(sys)
      type(problem), intent(in) :: this
      type(system) :: sys
      integer :: c
      sys%of = this
      do c = 1, classes
         sys%moment(:, :, c) = tensor_of(this, c, 1)
         sys%inverse(:, :, c) = tensor_of(this, c, -1)
      end do
   end function system_of

   !> Midpoint rule with 2, 4, 6, ... parts, extrapolated to none.
   subroutine extrapolated_step(sys, t, x, source)
      type(system), intent(in) :: sys
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: x(7, n)
      class(energy_source), intent(inout), optional :: source
      real(wp) :: table(7, n, columns), before(7, n), now(7, n), next(7, n), d
      integer :: i, j, m
      do i = 1, columns
         d = real(h, wp)/(2*i)
         before = x
         now = x + d*slope(sys, t, x, source)
         do m = 1, 2*i - 1
            next = before + 2*d*slope(sys, t + m*d, now, source)
            before = now
            now = next
         end do
         table(:, :, i) = (before + now + d*slope(sys, t + real(h, wp), now, source))/2
         do j = i - 1, 1, -1
            table(:, :, j) = table(:, :, j + 1) + (table(:, :, j + 1) - table(:, :, j))/ &
               ((real(i, wp)/j)**2 - 1)
         end do
      end do
      x = table(:, :, 1)
   end subroutine extrapolated_step

   function slope(sys, t, x, source) result(rate)
      type(system), intent(in) :: sys
      real(wp), intent(in) :: t, x(7, n)
      class(energy_source), intent(inout), optional :: source
      real(wp) :: rate(7, n), torque(3, n), w(3)
      integer :: i, c, k
      torque = 0
      do k = 1, size(sys%of%effects)
         call add_torque(sys, sys%of%effects(k), t, x, torque)
      end do
      if (sys%of%hosted) then
         do i = 1, n
            torque(:, i) = torque(:, i) + cross(to_body(x(4:, i), [0.0_wp, 0.0_wp, 1.0_wp]), &
               real(sys%of%centre, wp))
         end do
      end if
      if (present(source)) call add_difference(source, t, x, torque)
      do i = 1, n
         c = class_of(i)
         w = matmul(sys%inverse(:, :, c), x(:3, i) - rotor(sys, c, t))
         rate(:3, i) = cross(x(:3, i), w) + torque(:, i)
         if (sys%continuous) rate(:3, i) = rate(:3, i) - matmul(friction_of(sys, c), w)
         rate(4, i) = -dot_product(x(5:, i), w)/2
         rate(5:, i) = (x(4, i)*w + cross(x(5:, i), w))/2
      end do
   end function slope

   !> The momentum of all wheels.
   pure function rotor(sys, c, t) result(s)
      type(system), intent(in) :: sys
      integer, intent(in) :: c
      real(wp), intent(in) :: t
      real(wp) :: s(3)
      s = total_rotor(sys%of, c, real(t, dp), real(sys%middle, dp))
   end function rotor

   !> Torque of one effect on the bodies that it acts on.
   subroutine add_torque(sys, one, t, x, torque)
      type(system), intent(in) :: sys
      type(acting), intent(in) :: one
      real(wp), intent(in) :: t, x(7, n)
      real(wp), intent(inout) :: torque(3, n)
      real(wp) :: v(3), e(3)
      integer :: i
      if (one%name == "dipoles") then
         call add_dipoles(one, x, torque)
         return
      end if
      do i = 1, n
         if (.not. acts(one, i)) cycle
         select case (one%name)
         case ("gravity")
            v = to_body(x(4:, i), turning(one, "up", t))
            torque(:, i) = torque(:, i) + number(one, "weight", 1.0_wp)*cross(v, vector(one, &
               "centre"))
         case ("field")
            v = to_body(x(4:, i), field_at(one, t))
            torque(:, i) = torque(:, i) + cross(vector(one, "dipole"), v)
         case ("gravity_gradient")
            v = to_body(x(4:, i), radial_at(one, t))
            torque(:, i) = torque(:, i) + 3*number(one, "rate", 0.0_wp)**2/distance_at(one, t)**3* &
               cross(v, matmul(sys%moment(:, :, class_of(i)), v))
         case ("spring")
            v = to_body(x(4:, i), turning(one, "direction", t))
            e = unit(one, "axis", [0, 0, 1])
            torque(:, i) = torque(:, i) + number(one, "stiffness", 0.0_wp)*dot_product(e, v)* &
               cross(e, v)
         case ("torque")
            v = torque_at(one, t, sys%middle)
            if (word(one, "frame", "body") == "space") v = to_body(x(4:, i), v)
            torque(:, i) = torque(:, i) + v
         case default
            cycle ! friction, wheels, and what is judged by its energy
         end select
      end do
   end subroutine add_torque

   !> Kinetic and potential energies at the end.
   subroutine energies(this, y, q, kinetic, potential)
      type(problem), intent(in) :: this
      real(dp), intent(in) :: y(3, n), q(4, n)
      real(dp), intent(out) :: kinetic(n), potential(n)
      type(system) :: sys
      real(wp) :: t, v(3), u(n), x(4, n), z(3)
      integer :: i, k
      sys = system_of(this)
      t = steps*real(h, wp)
      sys%middle = t
      x = q
      u = 0
      do k = 1, size(this%effects)
         associate (one => this%effects(k))
            if (one%name == "dipoles") call add_dipole_energy(one, x, u)
            do i = 1, n
               if (.not. acts(one, i)) cycle
               select case (one%name)
               case ("gravity")
                  u(i) = u(i) + number(one, "weight", 1.0_wp)*dot_product(to_body(x(:, i), &
                     turning(one, "up", t)), vector(one, "centre"))
               case ("field")
                  u(i) = u(i) - dot_product(to_body(x(:, i), field_at(one, t)), vector(one, &
                     "dipole"))
               case ("gravity_gradient")
                  v = to_body(x(:, i), radial_at(one, t))
                  u(i) = u(i) + 1.5_wp*number(one, "rate", 0.0_wp)**2/distance_at(one, t)**3* &
                     dot_product(v, matmul(sys%moment(:, :, class_of(i)), v))
               case ("spring")
                  v = to_body(x(:, i), turning(one, "direction", t))
                  u(i) = u(i) - number(one, "stiffness", 0.0_wp)/2* &
                     dot_product(unit(one, "axis", [0, 0, 1]), v)**2
               case default
                  cycle ! no potential
               end select
            end do
         end associate
      end do
      potential = real(u, dp)
      do i = 1, n
         z = y(:, i) - rotor(sys, class_of(i), t)
         kinetic(i) = real(dot_product(z, matmul(sys%inverse(:, :, class_of(i)), z))/2, dp)
      end do
   end subroutine energies

   !> Half a step of friction: y - s to exp(-F J^-1 h/2) (y - s), one effect after the other.
   subroutine friction_flow(sys, forward, x)
      type(system), intent(in) :: sys
      logical, intent(in) :: forward          !! the first effect first
      real(wp), intent(inout) :: x(7, n)
      real(wp) :: m(3, 3), power(3, 3), flow(3, 3), s(3)
      integer :: i, j, k, c
      do j = 1, size(sys%of%effects)
         k = merge(j, size(sys%of%effects) + 1 - j, forward)
         if (.not. given(sys%of%effects(k), "friction")) cycle
         do i = 1, n
            if (.not. acts(sys%of%effects(k), i)) cycle
            c = class_of(i)
            m = -real(h, wp)/2*matmul(friction_matrix(sys%of%effects(k)), sys%inverse(:, :, c))
            flow = identity()
            power = identity()
            do c = 1, 25
               power = matmul(power, m)/c
               flow = flow + power
            end do
            s = rotor(sys, class_of(i), sys%middle + merge(-1, 1, forward)*real(h, wp)/2)
            x(:3, i) = s + matmul(flow, x(:3, i) - s)
         end do
      end do
   end subroutine friction_flow

   pure function friction_of(sys, c) result(f)
      type(system), intent(in) :: sys
      integer, intent(in) :: c
      real(wp) :: f(3, 3)
      integer :: k
      f = 0
      do k = 1, size(sys%of%effects)
         if (.not. given(sys%of%effects(k), "friction")) cycle
         if (acts(sys%of%effects(k), c)) f = f + friction_matrix(sys%of%effects(k))
      end do
   end function friction_of

   !> One number for all axes of the frame, or three: numbers of a key go round.
   pure function friction_matrix(one) result(f)
      type(acting), intent(in) :: one
      real(wp) :: f(3, 3)
      f = identity()*spread(vector(one, "friction"), 1, 3)
   end function friction_matrix

   pure function identity() result(e)
      real(wp) :: e(3, 3)
      e = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
   end function identity

   !> m_i x B_i, B_i the field of all others.
   subroutine add_dipoles(one, x, torque)
      type(acting), intent(in) :: one
      real(wp), intent(in) :: x(7, n)
      real(wp), intent(inout) :: torque(3, n)
      integer :: i
      do i = 1, n
         if (.not. acts(one, i)) cycle
         torque(:, i) = torque(:, i) + cross(dipole_of(one, i), to_body(x(4:, i), &
            dipole_field(one, x(4:, :), i)))
      end do
   end subroutine add_dipoles

   subroutine add_dipole_energy(one, q, u)
      type(acting), intent(in) :: one
      real(wp), intent(in) :: q(4, n)
      real(wp), intent(inout) :: u(n)
      integer :: i
      do i = 1, n
         if (acts(one, i)) u(i) = u(i) - dot_product(to_space(q(:, i), dipole_of(one, i)), &
            dipole_field(one, q, i))/2
      end do
   end subroutine add_dipole_energy

   function dipole_field(one, q, i) result(b)
      type(acting), intent(in) :: one
      real(wp), intent(in) :: q(4, n)
      integer, intent(in) :: i
      real(wp) :: b(3), m(3), r(3), d
      integer :: j
      b = 0
      do j = 1, n
         if (j == i .or. .not. acts(one, j)) cycle
         r = position(one, i) - position(one, j)
         d = norm2(r)
         m = to_space(q(:, j), dipole_of(one, j))
         b = b + number(one, "coupling", 1.0_wp)*(3*dot_product(m, r)*r/d**2 - m)/d**3
      end do
   end function dipole_field

   function position(one, i) result(r)
      type(acting), intent(in) :: one
      integer, intent(in) :: i
      real(wp) :: r(3)
      if (given(one, "positions")) then
         r = vector(one, "positions", 3*i - 2)
      else
         r = (i - 1)*number(one, "spacing", 1.0_wp)*unit(one, "axis", [1, 0, 0])
      end if
   end function position

   pure function dipole_of(one, i) result(m)
      type(acting), intent(in) :: one
      integer, intent(in) :: i
      real(wp) :: m(3)
      m = vector(one, "dipole", 3*class_of(i) - 2)
   end function dipole_of

   function field_at(one, t) result(e)
      type(acting), intent(in) :: one
      real(wp), intent(in) :: t
      real(wp) :: e(3), angle
      e = vector(one, "strength")
      angle = number(one, "frequency", 0.0_wp)*t + number(one, "phase", 0.0_wp)
      if (word(one, "motion", "static") == "oscillating") e = e*cos(angle)
      if (word(one, "motion", "static") == "rotating") e = turned(e, unit(one, "axis", [0, 0, 1]), &
         angle)
   end function field_at

   !> A direction that turns.
   function turning(one, key, t) result(e)
      type(acting), intent(in) :: one
      character(*), intent(in) :: key
      real(wp), intent(in) :: t
      real(wp) :: e(3)
      e = turned(unit(one, key, [0, 0, 1]), unit(one, "about", [0, 0, 1]), &
         number(one, "rate", 0.0_wp)*t + number(one, "phase", 0.0_wp))
   end function turning

   function radial_at(one, t) result(e)
      type(acting), intent(in) :: one
      real(wp), intent(in) :: t
      real(wp) :: e(3)
      e = unit(one, "radial", [1, 0, 0])
      if (word(one, "orbit", "circular") == "circular") e = turned(e, unit(one, "normal", [0, 0, &
         1]), 2*atan(sqrt((1 + eccentricity(one))/(1 - eccentricity(one)))* &
         tan(eccentric_anomaly(one, t)/2)))
   end function radial_at

   !> From the centre, over the mean distance.
   real(wp) function distance_at(one, t)
      type(acting), intent(in) :: one
      real(wp), intent(in) :: t
      distance_at = 1 - eccentricity(one)*cos(eccentric_anomaly(one, t))
   end function distance_at

   real(wp) function eccentricity(one)
      type(acting), intent(in) :: one
      eccentricity = number(one, "eccentricity", 0.0_wp)
   end function eccentricity

   !> Kepler's equation, by halving.
   real(wp) function eccentric_anomaly(one, t) result(middle)
      type(acting), intent(in) :: one
      real(wp), intent(in) :: t
      real(wp) :: mean, below, above
      integer :: i
      mean = number(one, "rate", 0.0_wp)*t + number(one, "anomaly", 0.0_wp)
      below = mean - 1
      above = mean + 1
      do i = 1, 70
         middle = (below + above)/2
         if (middle - eccentricity(one)*sin(middle) < mean) then
            below = middle
         else
            above = middle
         end if
      end do
   end function eccentric_anomaly

   !> Constant, harmonic, or linear between times.
   function torque_at(one, t, within) result(v)
      type(acting), intent(in) :: one
      real(wp), intent(in) :: t, within
      real(wp) :: v(3)
      if (given(one, "table")) then
         v = in_table(values_of(one, "times"), values_of(one, "table"), real(t, dp), &
            real(within, dp))
      else
         v = vector(one, "value")
         if (given(one, "frequency") .or. given(one, "phase")) then
            v = v*cos(number(one, "frequency", 0.0_wp)*t + number(one, "phase", 0.0_wp))
         end if
      end if
   end function torque_at

   !> Minus the derivative of the energy by a turn of each body about each of its axes: central
   !> differences of order 8.
   subroutine add_difference(source, t, x, torque)
      class(energy_source), intent(inout) :: source
      real(wp), intent(in) :: t, x(7, n)
      real(wp), intent(inout) :: torque(3, n)
      real(wp), parameter :: weight(4) = [0.8_wp, -0.2_wp, 4/105.0_wp, -1/280.0_wp], a = 0.04_wp
      real(wp) :: e(3), q(4, n), u(2)
      integer :: i, j, k, side
      do i = 1, n
         do j = 1, 3
            do k = 1, 4
               do side = 1, 2
                  e = 0
                  e(j) = sin((3 - 2*side)*k*a/2)
                  q = x(4:, :)
                  q(1, i) = x(4, i)*cos(k*a/2) - dot_product(x(5:, i), e)
                  q(2:, i) = x(5:, i)*cos(k*a/2) + x(4, i)*e + cross(x(5:, i), e)
                  u(side) = source%total(real(t, dp), real(q, dp))
               end do
               torque(j, i) = torque(j, i) - weight(k)*(u(1) - u(2))/a
            end do
         end do
      end do
   end subroutine add_difference

   ! ---- data of a problem ----

   pure integer function class_of(i)
      integer, intent(in) :: i
      class_of = i
   end function class_of

   pure logical function acts(one, i)
      type(acting), intent(in) :: one
      integer, intent(in) :: i
      acts = one%class == 0 .or. one%class == class_of(i)
   end function acts

   pure logical function given(one, key)
      type(acting), intent(in) :: one
      character(*), intent(in) :: key
      given = place(one, key) > 0
   end function given

   !> The place of a key in the settings; 0 if it is not given.
   pure integer function place(one, key)
      type(acting), intent(in) :: one
      character(*), intent(in) :: key
      do place = size(one%settings), 1, -1
         if (one%settings(place)%key == key) return
      end do
   end function place

   !> Number i of a key, in a cycle if there are fewer.
   pure real(wp) function number(one, key, default, i)
      type(acting), intent(in) :: one
      character(*), intent(in) :: key
      real(wp), intent(in) :: default
      integer, intent(in), optional :: i
      integer :: k, j
      k = place(one, key)
      number = default
      j = 1
      if (present(i)) j = i
      if (k > 0) number = one%settings(k)%values(1 + mod(j - 1, size(one%settings(k)%values)))
   end function number

   !> Three numbers of a key from number `first` on.
   pure function vector(one, key, first) result(v)
      type(acting), intent(in) :: one
      character(*), intent(in) :: key
      integer, intent(in), optional :: first
      real(wp) :: v(3)
      integer :: j, before
      before = 0
      if (present(first)) before = first - 1
      do j = 1, 3
         v(j) = number(one, key, 0.0_wp, before + j)
      end do
   end function vector

   pure function unit(one, key, default) result(v)
      type(acting), intent(in) :: one
      character(*), intent(in) :: key
      integer, intent(in) :: default(3)
      real(wp) :: v(3)
      v = default
      if (given(one, key)) v = vector(one, key)
      v = v/norm2(v)
   end function unit

   pure function word(one, key, default) result(text)
      type(acting), intent(in) :: one
      character(*), intent(in) :: key, default
      character(:), allocatable :: text
      integer :: i
      text = default
      do i = 1, size(one%settings)
         if (one%settings(i)%key == key) text = one%settings(i)%text
      end do
   end function word

   ! ---- algebra ----

   pure function cross(a, b) result(c)
      real(wp), intent(in) :: a(3), b(3)
      real(wp) :: c(3)
      c = [a(2)*b(3) - a(3)*b(2), a(3)*b(1) - a(1)*b(3), a(1)*b(2) - a(2)*b(1)]
   end function cross

   pure function to_space(q, v) result(u)
      real(wp), intent(in) :: q(4), v(3)
      real(wp) :: u(3), s(3)
      s = 2*cross(q(2:), v)
      u = v + (q(1)*s + cross(q(2:), s))/sum(q*q)
   end function to_space

   pure function to_body(q, v) result(u)
      real(wp), intent(in) :: q(4), v(3)
      real(wp) :: u(3)
      u = to_space([q(1), -q(2:)], v)
   end function to_body

   !> v turned about a unit axis.
   pure function turned(v, axis, angle) result(u)
      real(wp), intent(in) :: v(3), axis(3), angle
      real(wp) :: u(3)
      u = v*cos(angle) + cross(axis, v)*sin(angle) + axis*dot_product(axis, v)*(1 - cos(angle))
   end function turned

end module test_matrix_oracle
