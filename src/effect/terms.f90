!> Effects as data: torques in the form used by the Taylor integrator (mathematics.md, "Torques at
!> any accuracy").
!>
!> An effect that supports it adds its terms (`add_terms` of its type). Directions are fixed in
!> space or rotate about a fixed axis at a constant rate; strengths are constant, harmonic, or
!> linear between the times of a table. Torques and arms are in the body frame.
module poinsot_effect_terms
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: torque_terms, space_direction, linear_term, quadratic_term, body_term, table_term
   public :: cross_matrix

   !> A vector in space: at t = 0 turned by `phase` about `axis`, at time t by rate t + phase.
   type :: space_direction
      real(dp) :: at(3) = 0             !! any length
      real(dp) :: axis(3) = [0, 0, 1]   !! unit vector; of no meaning if rate and phase are zero
      real(dp) :: rate = 0              !! radians per time
      real(dp) :: phase = 0             !! radians
   end type space_direction

   !> torque = M Q^T e, times cos(frequency t + phase) if `harmonic`; e is then fixed in space.
   type :: linear_term
      type(space_direction) :: e
      real(dp) :: matrix(3, 3) = 0
      logical :: harmonic = .false.
      real(dp) :: frequency = 0, phase = 0
   end type linear_term

   !> torque = n x K n with n = Q^T e, U = n.K n/2. Differences of the diagonal of K are given as
   !> such, so that none is formed by cancellation.
   type :: quadratic_term
      type(space_direction) :: e
      real(dp) :: difference(3) = 0     !! K33 - K22, K11 - K33, K22 - K11
      real(dp) :: product(3) = 0        !! K23, K31, K12
   end type quadratic_term

   !> torque = value, times cos(frequency t + phase) if `harmonic`.
   type :: body_term
      real(dp) :: value(3) = 0
      logical :: harmonic = .false.
      real(dp) :: frequency = 0, phase = 0
   end type body_term

   !> torque = a table in time, linear between its times and constant beyond its ends.
   type :: table_term
      logical :: in_space = .false.             !! torque = Q^T of it
      real(dp), allocatable :: times(:)         !! (n), increasing
      real(dp), allocatable :: values(:, :)     !! (3, n)
   end type table_term

   !> The sum of all parts that act on a body class.
   type :: torque_terms
      type(linear_term), allocatable :: linear(:)
      type(quadratic_term), allocatable :: quadratic(:)
      type(body_term), allocatable :: body(:)
      type(table_term), allocatable :: table(:)
      real(dp) :: friction(3, 3) = 0            !! torque = -friction omega
   contains
      procedure :: add_linear
      procedure :: add_quadratic
      procedure :: add_body
      procedure :: add_table
   end type torque_terms

contains

   !> One more linear term.
   pure subroutine add_linear(self, term)
      class(torque_terms), intent(inout) :: self
      type(linear_term), intent(in) :: term
      if (.not. allocated(self%linear)) allocate (self%linear(0))
      self%linear = [self%linear, term]
   end subroutine add_linear

   !> One more quadratic term.
   pure subroutine add_quadratic(self, term)
      class(torque_terms), intent(inout) :: self
      type(quadratic_term), intent(in) :: term
      if (.not. allocated(self%quadratic)) allocate (self%quadratic(0))
      self%quadratic = [self%quadratic, term]
   end subroutine add_quadratic

   !> One more torque in the body frame.
   pure subroutine add_body(self, term)
      class(torque_terms), intent(inout) :: self
      type(body_term), intent(in) :: term
      if (.not. allocated(self%body)) allocate (self%body(0))
      self%body = [self%body, term]
   end subroutine add_body

   !> One more table.
   pure subroutine add_table(self, term)
      class(torque_terms), intent(inout) :: self
      type(table_term), intent(in) :: term
      if (.not. allocated(self%table)) allocate (self%table(0))
      self%table = [self%table, term]
   end subroutine add_table

   !> The matrix M with M v = v x arm: the torque of U = v.arm.
   pure function cross_matrix(arm) result(m)
      real(dp), intent(in) :: arm(3)
      real(dp) :: m(3, 3)
      m = 0
      m(1, 2) = arm(3)
      m(1, 3) = -arm(2)
      m(2, 3) = arm(1)
      m(2, 1) = -arm(3)
      m(3, 1) = arm(2)
      m(3, 2) = -arm(1)
   end function cross_matrix

end module poinsot_effect_terms
