!> Point dipoles at fixed positions, with torques between all pairs. For moderate numbers of bodies
!> (cost n^2).
module poinsot_effect_dipoles
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_size
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_effect_effect, only: effect, pair_effect
   use poinsot_effect_traits, only: effect_traits
   use poinsot_effect_geometry, only: each_to_body, to_space
   use poinsot_effect_row, only: effect_label, effect_row
   use poinsot_effect_settings, only: setting, effect_info, number_key, get_values, get_value, &
      get_direction, was_given, class_vectors
   implicit none(type, external)
   private
   public :: dipoles, dipoles_label, dipoles_row

   type(effect_label), parameter :: dipoles_label = effect_label("dipoles", 9)

   ! distances between which r^3 is a normal number
   real(dp), parameter :: nearest = 1e-100_dp, farthest = 1e90_dp

   !> U = -(1/2) sum_i m_i . E_i,  E_i = coupling sum_j [3 r (r.m_j)/r^2 - m_j]/r^3,  m = Q dipole
   type, extends(pair_effect) :: dipoles
      real(dp) :: coupling = 1
      real(dp), allocatable :: dipole(:, :) !! (3, 1) for all classes, or (3, classes); body frame
      real(dp), allocatable :: positions(:, :)   !! (3, bodies); not allocated: a chain
      real(dp) :: link(3) = 0                    !! from one body of a chain to the next
   contains
      procedure :: scatter_source
      procedure :: add_torque
      procedure :: add_energy
      procedure :: bodies
      procedure :: has_gradient
      procedure :: get_traits
      procedure :: scatter_change
      procedure :: add_derivative
   end type dipoles

contains

   !> Its row in the registry.
   function dipoles_row() result(row)
      type(effect_row) :: row
      row%info%name = dipoles_label%name
      row%info%formula = "U = C sum_(i<j) [m_i.m_j - 3 (m_i.r)(m_j.r)/r^2]/r^3,  m = Q dipole"
      row%info%check = "two head to tail, C = coupling m^2: w^2 = C/(I r^3), 3 C/(I r^3); &
                   &L along r conserved"
      allocate (row%info%keys, source=[ &
                  number_key("dipole", 3, -1, "required", "dipole moment", &
                             "body frame: three numbers for all, or three per body class", &
                             class_vectors, shown="dipole"), &
                  number_key("coupling", 1, 1, "1", "energy length^3/dipole^2", &
                  "C, e.g. 1/(4 pi eps0)"), &
                  number_key("positions", 3, -1, "", "length", &
                  "three numbers per body, in the order of bodies"), &
                  number_key("spacing", 1, 1, "1", "length", &
                  "without positions: distance along a chain"), &
                  number_key("axis", 3, 3, "1,0,0", "direction", &
                  "without positions: direction of the chain")])
      row%info%keys(3)%positions_unless = "spacing"
      row%make => make_dipoles
   end function dipoles_row

   !> Dipoles from checked settings.
   subroutine make_dipoles(info, settings, made, error)
      type(effect_info), intent(in) :: info           !! the row of the registry
      type(setting), intent(in) :: settings(:)        !! checked against the row
      class(effect), allocatable, intent(out) :: made !! not allocated after an error
      type(poinsot_error), intent(inout) :: error
      type(dipoles) :: new
      real(dp), allocatable :: values(:)
      real(dp) :: axis(3), spacing
      call get_values(info, settings, "dipole", values)
      if (mod(size(values), 3) /= 0) then
         call raise(error, poinsot_e_size, &
            "effect 'dipoles': key 'dipole' takes three numbers per class")
         return
      end if
      new%dipole = reshape(values, [3, size(values)/3])
      new%coupling = get_value(info, settings, "coupling")
      call get_direction(info, settings, "axis", axis, error)
      if (raised(error)) return
      spacing = get_value(info, settings, "spacing")
      if (spacing < nearest .or. spacing > farthest) then
         call raise(error, poinsot_e_domain, &
                    "effect 'dipoles': key 'spacing' must be between 1e-100 and 1e90")
      end if
      new%link = spacing*axis
      if (was_given(settings, "positions") .and. .not. raised(error)) then
         call get_values(info, settings, "positions", values)
         call place(values, new, error)
      end if
      if (.not. raised(error)) made = new
   end subroutine make_dipoles

   !> A conservative force that depends on all directions between bodies.
   pure subroutine get_traits(self, traits)
      class(dipoles), intent(in) :: self
      type(effect_traits), intent(out) :: traits
      associate (unused => self%class_index)
      end associate
      traits%energy = .true.
   end subroutine get_traits

   subroutine place(values, new, error)
      real(dp), intent(in) :: values(:)
      type(dipoles), intent(inout) :: new
      type(poinsot_error), intent(inout) :: error
      integer :: i, j, n
      n = size(values)/3
      if (mod(size(values), 3) /= 0) then
         call raise(error, poinsot_e_size, &
            "effect 'dipoles': key 'positions' takes three numbers per body")
         return
      end if
      new%positions = reshape(values, [3, n])
      if (maxval(abs(values)) > farthest) then
         call raise(error, poinsot_e_domain, "effect 'dipoles': a position is beyond 1e90")
         return
      end if
      do i = 2, n
         do j = 1, i - 1
            if (norm2(new%positions(:, i) - new%positions(:, j)) > nearest) cycle
            call raise(error, poinsot_e_domain, &
               "effect 'dipoles': two bodies have the same position")
            return
         end do
      end do
   end subroutine place

   !> How many bodies have a position; a chain has room for any number (0).
   pure integer function bodies(self)
      class(dipoles), intent(in) :: self
      bodies = 0
      if (allocated(self%positions)) bodies = size(self%positions, 2)
   end function bodies

   !> The dipoles in space.
   subroutine scatter_source(self, number, body, q, sources)
      class(dipoles), intent(in) :: self
      integer, intent(in) :: number
      integer, intent(in) :: body(lanes)
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(inout) :: sources(:, :)
      real(dp) :: m(lanes, 3)
      call to_space(repeated(dipole_of(self, number)), q, m)
      call scatter(body, m, sources)
   end subroutine scatter_source

   subroutine add_torque(self, number, body, q, sources, g)
      class(dipoles), intent(in) :: self
      integer, intent(in) :: number
      integer, intent(in) :: body(lanes)
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: sources(:, :)
      real(dp), intent(inout) :: g(lanes, 3)
      real(dp) :: e(lanes, 3), v(lanes, 3)
      call field_at(self, body, sources, e)
      call each_to_body(e, q, v)
      call add_cross(dipole_of(self, number), v, g)
   end subroutine add_torque

   subroutine add_energy(self, number, body, q, sources, u)
      class(dipoles), intent(in) :: self
      integer, intent(in) :: number
      integer, intent(in) :: body(lanes)
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: sources(:, :)
      real(dp), intent(inout) :: u(lanes)
      real(dp) :: e(lanes, 3), v(lanes, 3), d(3)
      d = dipole_of(self, number)
      call field_at(self, body, sources, e)
      call each_to_body(e, q, v)
      u = u - 0.5_dp*(d(1)*v(:, 1) + d(2)*v(:, 2) + d(3)*v(:, 3))
   end subroutine add_energy

   pure logical function has_gradient(self)
      class(dipoles), intent(in) :: self
      associate (unused => self%class_index)
      end associate
      has_gradient = .true.
   end function has_gradient

   !> Along Q -> Q exp(hat(delta)) the dipole in space changes by Q (delta x dipole).
   subroutine scatter_change(self, number, body, q, delta, changes)
      class(dipoles), intent(in) :: self
      integer, intent(in) :: number
      integer, intent(in) :: body(lanes)
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: delta(lanes, 3)
      real(dp), intent(inout) :: changes(:, :)
      real(dp) :: v(lanes, 3), m(lanes, 3)
      v = 0
      call add_cross(-dipole_of(self, number), delta, v)
      call to_space(v, q, m)
      call scatter(body, m, changes)
   end subroutine scatter_change

   !> dipole x [(Q^T E) x delta + Q^T (change of E)]
   subroutine add_derivative(self, number, body, q, delta, sources, changes, dg)
      class(dipoles), intent(in) :: self
      integer, intent(in) :: number
      integer, intent(in) :: body(lanes)
      real(dp), intent(in) :: q(lanes, 4)
      real(dp), intent(in) :: delta(lanes, 3)
      real(dp), intent(in) :: sources(:, :), changes(:, :)
      real(dp), intent(inout) :: dg(lanes, 3)
      real(dp) :: e(lanes, 3), v(lanes, 3), w(lanes, 3)
      call field_at(self, body, sources, e)
      call each_to_body(e, q, v)
      call field_at(self, body, changes, e)
      call each_to_body(e, q, w)
      w(:, 1) = w(:, 1) + (v(:, 2)*delta(:, 3) - v(:, 3)*delta(:, 2))
      w(:, 2) = w(:, 2) + (v(:, 3)*delta(:, 1) - v(:, 1)*delta(:, 3))
      w(:, 3) = w(:, 3) + (v(:, 1)*delta(:, 2) - v(:, 2)*delta(:, 1))
      call add_cross(dipole_of(self, number), w, dg)
   end subroutine add_derivative

   !> Field of all dipoles at the place of every lane, its own left out; summed in the order of
   !> bodies.
   subroutine field_at(self, body, sources, e)
      class(dipoles), intent(in) :: self
      integer, intent(in) :: body(lanes)
      real(dp), intent(in) :: sources(:, :)
      real(dp), intent(out) :: e(lanes, 3)
      real(dp) :: x(lanes, 3), p(3), m(3), r1, r2, r3, square, weight, along
      logical :: away
      integer :: i, j
      do i = 1, lanes
         x(i, :) = position_of(self, body(i))
      end do
      e = 0
      do j = 1, size(sources, 2)
         p = position_of(self, j)
         m = self%coupling*sources(:, j)
         !$omp simd private(r1, r2, r3, square, weight, along, away)
         do i = 1, lanes
            away = body(i) /= j .and. body(i) > 0
            r1 = x(i, 1) - p(1)
            r2 = x(i, 2) - p(2)
            r3 = x(i, 3) - p(3)
            square = merge(r1*r1 + r2*r2 + r3*r3, 1.0_dp, away)
            weight = merge(1/(square*sqrt(square)), 0.0_dp, away)
            along = 3*(r1*m(1) + r2*m(2) + r3*m(3))/square
            e(i, 1) = e(i, 1) + weight*(along*r1 - m(1))
            e(i, 2) = e(i, 2) + weight*(along*r2 - m(2))
            e(i, 3) = e(i, 3) + weight*(along*r3 - m(3))
         end do
      end do
   end subroutine field_at

   pure function position_of(self, body) result(x)
      class(dipoles), intent(in) :: self
      integer, intent(in) :: body   !! 0 for padding
      real(dp) :: x(3)
      if (.not. allocated(self%positions)) then
         x = max(body - 1, 0)*self%link
      else
         x = self%positions(:, min(max(body, 1), size(self%positions, 2)))
      end if
   end function position_of

   !> One dipole for all classes, or one per class; a class beyond the list has none.
   pure function dipole_of(self, number) result(d)
      class(dipoles), intent(in) :: self
      integer, intent(in) :: number
      real(dp) :: d(3)
      d = 0
      if (size(self%dipole, 2) == 1) then
         d = self%dipole(:, 1)
      else if (number <= size(self%dipole, 2)) then
         d = self%dipole(:, number)
      end if
   end function dipole_of

   pure function repeated(b) result(v)
      real(dp), intent(in) :: b(3)
      real(dp) :: v(lanes, 3)
      v = spread(b, 1, lanes)
   end function repeated

   pure subroutine scatter(body, v, columns)
      integer, intent(in) :: body(lanes)
      real(dp), intent(in) :: v(lanes, 3)
      real(dp), intent(inout) :: columns(:, :)
      integer :: i
      do i = 1, lanes
         if (body(i) > 0) columns(:, body(i)) = v(i, :)
      end do
   end subroutine scatter

   !> g += d x v
   pure subroutine add_cross(d, v, g)
      real(dp), intent(in) :: d(3)
      real(dp), intent(in) :: v(lanes, 3)
      real(dp), intent(inout) :: g(lanes, 3)
      integer :: i
      !$omp simd
      do i = 1, lanes
         g(i, 1) = g(i, 1) + (d(2)*v(i, 3) - d(3)*v(i, 2))
         g(i, 2) = g(i, 2) + (d(3)*v(i, 1) - d(1)*v(i, 3))
         g(i, 3) = g(i, 3) + (d(1)*v(i, 2) - d(2)*v(i, 1))
      end do
   end subroutine add_cross

end module poinsot_effect_dipoles
