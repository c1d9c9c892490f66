!> Gravity gradient on a satellite far from the attracting centre.
module poinsot_effect_gravity_gradient
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_status, only: poinsot_e_domain
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_body_class, only: body_class
   use poinsot_core_libm, only: arctangent, cosine, sine
   use poinsot_effect_effect, only: effect, torque_effect
   use poinsot_effect_geometry, only: turned, to_body
   use poinsot_effect_traits, only: effect_traits
   use poinsot_effect_terms, only: torque_terms, quadratic_term, space_direction
   use poinsot_effect_row, only: effect_label, effect_row
   use poinsot_effect_settings, only: setting, effect_info, number_key, text_key, get_value, &
      get_text, get_direction, check_product
   implicit none(type, external)
   private
   public :: gravity_gradient, gravity_gradient_label, gravity_gradient_row

   type(effect_label), parameter :: gravity_gradient_label = effect_label("gravity_gradient", 3)

   real(dp), parameter :: pi = acos(-1.0_dp), most_eccentric = 0.99_dp

   !> U = (kappa/2) n.Jn, n = Q^T rhat(t), kappa = 3 G M/R^3; on a circle 3 rate^2
   type, extends(torque_effect) :: gravity_gradient
      real(dp) :: kappa = 0             !! at the mean distance
      real(dp) :: rate = 0              !! radians per time, along the orbit
      real(dp) :: radial(3) = [1, 0, 0] !! direction of the centre (either sign) at t = 0, in space
      real(dp) :: normal(3) = [0, 0, 1] !! of the orbit, in space
      real(dp) :: eccentricity = 0      !! radial is then the direction at the least distance
      real(dp) :: anomaly = 0           !! mean anomaly at t = 0: on a circle the angle from radial
   contains
      procedure :: look
      procedure :: add_torque
      procedure :: add_terms
      procedure :: add_energy
      procedure :: has_gradient
      procedure :: get_traits
      procedure :: uses_moments
      procedure :: add_derivative
   end type gravity_gradient

contains

   !> Its row in the registry.
   function gravity_gradient_row() result(row)
      type(effect_row) :: row
      row%info%name = gravity_gradient_label%name
      row%info%formula = "U = (3/2) rate^2 n.I n;  torque = 3 rate^2 n x I n;  &
                     &n = Q^T radial, rate^2 = GM/R^3"
      row%info%check = "pitch libration rate sqrt(3 (I_roll - I_yaw)/I_pitch)"
      allocate (row%info%keys, source=[ &
                  number_key("rate", 1, 1, "required", "radians per time", &
                  "mean motion sqrt(GM/a^3), a the mean distance"), &
                  number_key("radial", 3, 3, "1,0,0", "direction", &
                  "to or from the centre at anomaly 0, in space"), &
                  number_key("normal", 3, 3, "0,0,1", "direction", &
                  "normal of the orbit, in space, perpendicular to radial"), &
                  text_key("orbit", "circular", "circular fixed", &
                  "whether the radial direction rotates with the orbit"), &
                  number_key("eccentricity", 1, 1, "0", "relative", &
                  "of the orbit, 0 to 0.99; radial is along its least distance"), &
                  number_key("anomaly", 1, 1, "0", "radians", "mean anomaly at t = 0")])
      row%make => make_gravity_gradient
   end function gravity_gradient_row

   !> A gravity gradient from checked settings.
   subroutine make_gravity_gradient(info, settings, made, error)
      type(effect_info), intent(in) :: info           !! the row of the registry
      type(setting), intent(in) :: settings(:)        !! checked against the row
      class(effect), allocatable, intent(out) :: made !! not allocated after an error
      type(poinsot_error), intent(inout) :: error
      type(gravity_gradient) :: new
      call get_direction(info, settings, "radial", new%radial, error)
      if (.not. raised(error)) call get_direction(info, settings, "normal", new%normal, error)
      if (raised(error)) return
      new%rate = get_value(info, settings, "rate")
      call check_product(info, settings, "rate", new%rate, error)
      if (raised(error)) return
      new%kappa = 3*new%rate**2
      new%eccentricity = get_value(info, settings, "eccentricity")
      new%anomaly = get_value(info, settings, "anomaly")
      if (new%eccentricity < 0 .or. new%eccentricity > most_eccentric) then
         call raise(error, poinsot_e_domain, "effect 'gravity_gradient': key 'eccentricity' is " &
            // "from 0 to 0.99")
         return
      end if
      if (get_text(info, settings, "orbit") == "fixed") then
         new%rate = 0
         if (new%eccentricity > 0 .or. abs(new%anomaly) > 0) then
            call raise(error, poinsot_e_domain, "effect 'gravity_gradient': keys 'eccentricity' " &
               // "and 'anomaly' go with an orbit that is not 'fixed'")
            return
         end if
      end if
      if (new%rate > 0 .or. new%rate < 0) then
         if (abs(dot_product(new%radial, new%normal)) > 1e-6_dp) then
            call raise(error, poinsot_e_domain, "effect 'gravity_gradient': key 'normal' must " // &
                       "be perpendicular to 'radial' on an orbit that is not 'fixed'")
            return
         end if
      end if
      made = new
   end subroutine make_gravity_gradient

   !> The radial direction at time t, in space, and 3 G M/R^3.
   pure subroutine look(self, t, e, kappa)
      class(gravity_gradient), intent(in) :: self
      real(dp), intent(in) :: t
      real(dp), intent(out) :: e(3), kappa
      real(dp) :: mean, eccentric, distance
      kappa = self%kappa
      mean = self%rate*t + self%anomaly
      if (.not. self%eccentricity > 0) then
         e = turned(self%radial, self%normal, mean)
         return
      end if
      eccentric = eccentric_anomaly(mean, self%eccentricity)
      distance = 1 - self%eccentricity*cosine(eccentric)
      kappa = self%kappa/distance**3
      e = turned(self%radial, self%normal, arctangent(sqrt((1 - self%eccentricity)*(1 + &
         self%eccentricity))*sine(eccentric), cosine(eccentric) - self%eccentricity))
   end subroutine look

   !> E of Kepler's equation, E - e sin E = M, by Newton's method from above or below the root,
   !> where
   !> it never leaves the side (M reduced to [-pi, pi]).
   pure real(dp) function eccentric_anomaly(mean, e) result(x)
      real(dp), intent(in) :: mean !! M, radians
      real(dp), intent(in) :: e    !! eccentricity, 0 to 0.99
      real(dp) :: m, change
      integer :: i
      m = mean - 2*pi*anint(mean/(2*pi))
      x = sign(min(abs(m) + e, pi), m)
      do i = 1, 50
         change = (x - e*sine(x) - m)/(1 - e*cosine(x))
         x = x - change
         if (abs(change) <= 4*epsilon(x)*abs(x)) exit
      end do
   end function eccentric_anomaly

   !> kappa n x Jn, by differences of moments: exactly zero for a sphere.
   subroutine add_torque(self, class, t, q, g)
      class(gravity_gradient), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: g(lanes, 3)
      real(dp) :: n(lanes, 3), d(3), e(3), kappa
      integer :: i
      call self%look(t, e, kappa)
      d = kappa*differences(class)
      if (all(abs(d) <= 0)) return
      call to_body(e, q, n)
      !$omp simd
      do i = 1, lanes
         g(i, 1) = g(i, 1) + d(1)*(n(i, 2)*n(i, 3))
         g(i, 2) = g(i, 2) + d(2)*(n(i, 3)*n(i, 1))
         g(i, 3) = g(i, 3) + d(3)*(n(i, 1)*n(i, 2))
      end do
   end subroutine add_torque

   subroutine add_energy(self, class, t, q, u)
      class(gravity_gradient), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: u(lanes)
      real(dp) :: n(lanes, 3), half(3), e(3), kappa
      call self%look(t, e, kappa)
      half = 0.5_dp*kappa*class%moments
      call to_body(e, q, n)
      u = u + (half(1)*n(:, 1)**2 + half(2)*n(:, 2)**2 + half(3)*n(:, 3)**2)
   end subroutine add_energy

   !> The distance of an eccentric orbit changes in every frame.
   pure subroutine get_traits(self, traits)
      class(gravity_gradient), intent(in) :: self
      type(effect_traits), intent(out) :: traits
      traits%energy = .not. self%eccentricity > 0
      traits%one_direction = .true.
      traits%eccentricity = self%eccentricity
      traits%direction = space_direction(self%radial, self%normal, self%rate, self%anomaly)
      if (abs(self%rate) > 0) traits%shown = "orbit"
   end subroutine get_traits

   pure logical function has_gradient(self)
      class(gravity_gradient), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      has_gradient = .true.
   end function has_gradient

   pure logical function uses_moments(self)
      class(gravity_gradient), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      uses_moments = .true.
   end function uses_moments

   !> kappa [(n x delta) x Jn + n x J(n x delta)]
   subroutine add_derivative(self, class, t, q, delta, dg)
      class(gravity_gradient), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: t
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: delta(lanes, 3)
      real(dp), intent(inout) :: dg(lanes, 3)
      real(dp) :: n(lanes, 3), d(3), w1, w2, w3, e(3), kappa
      integer :: i
      call self%look(t, e, kappa)
      d = kappa*differences(class)
      if (all(abs(d) <= 0)) return
      call to_body(e, q, n)
      !$omp simd private(w1, w2, w3)
      do i = 1, lanes
         w1 = n(i, 2)*delta(i, 3) - n(i, 3)*delta(i, 2)
         w2 = n(i, 3)*delta(i, 1) - n(i, 1)*delta(i, 3)
         w3 = n(i, 1)*delta(i, 2) - n(i, 2)*delta(i, 1)
         dg(i, 1) = dg(i, 1) + d(1)*(w2*n(i, 3) + n(i, 2)*w3)
         dg(i, 2) = dg(i, 2) + d(2)*(w3*n(i, 1) + n(i, 3)*w1)
         dg(i, 3) = dg(i, 3) + d(3)*(w1*n(i, 2) + n(i, 1)*w2)
      end do
   end subroutine add_derivative

   pure function differences(class) result(d)
      type(body_class), intent(in) :: class
      real(dp) :: d(3)
      d = [class%moments(3) - class%moments(2), class%moments(1) - class%moments(3), &
           class%moments(2) - class%moments(1)]
   end function differences

   !> The effect as data; not on an eccentric orbit.
   pure subroutine add_terms(self, class, terms, served)
      class(gravity_gradient), intent(in) :: self
      type(body_class), intent(in) :: class
      type(torque_terms), intent(inout) :: terms
      logical, intent(out) :: served
      served = .not. self%eccentricity > 0
      if (served) call terms%add_quadratic(quadratic_term(space_direction(turned(self%radial, &
         self%normal, self%anomaly), self%normal, self%rate), self%kappa*differences(class)))
   end subroutine add_terms

end module poinsot_effect_gravity_gradient
