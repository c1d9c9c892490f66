!> Largest changes of conserved quantities since the start of a run.
module poinsot_scene_drift
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_length, only: length_of
   use poinsot_core_kinds, only: dp
   use poinsot_core_maxima, only: larger, largest_of
   use poinsot_body_invariants, only: space_momentum
   use poinsot_scene_communicator, only: communicator
   use poinsot_scene_states, only: body_states
   implicit none(type, external)
   private
   public :: drift_watch, start_drift, start_energy, follow_drift

   !> First values and largest changes, all of them relative to the scale of their own quantity.
   type :: drift_watch
      real(dp), allocatable :: length(:)        !! (n): |y| at the start
      real(dp), allocatable :: momentum(:, :)   !! (3, n): Q y at the start
      real(dp), allocatable :: size_y(:)        !! (n): largest |y| so far
      real(dp) :: total = 0                     !! energy of all bodies at the start
      real(dp) :: total_size = 0
      real(dp) :: energy_change = 0             !! of all bodies together
      real(dp) :: casimir_change = 0            !! |y|, body by body
      real(dp) :: momentum_change = 0           !! Q y, body by body
      real(dp) :: vertical_change = 0           !! third component of Q y, body by body
      real(dp) :: norm_change = 0               !! |q|
      logical :: measured = .false.             !! has anything been compared with the start?
   end type drift_watch

contains

   !> Note the start; `start_energy` follows.
   subroutine start_drift(states, drift, code)
      type(body_states), intent(in) :: states          !! of this rank
      type(drift_watch), intent(out) :: drift
      integer, intent(out) :: code                     !! not 0: no memory
      integer :: i, n
      n = states%n
      allocate (drift%length(n), stat=code)
      if (code == 0) allocate (drift%momentum(3, n), stat=code)
      if (code == 0) allocate (drift%size_y(n), stat=code)
      if (code /= 0) return
      do i = 1, n
         drift%length(i) = length_of(states%y(:, i))
         drift%momentum(:, i) = space_momentum(states%y(:, i), states%q(:, i))
      end do
      drift%size_y = drift%length
   end subroutine start_drift

   !> Note the energy of all bodies at the start. All ranks call.
   subroutine start_energy(kinetic, potential, ranks, drift)
      real(dp), intent(in) :: kinetic(:), potential(:) !! (n): of this rank's bodies
      class(communicator), intent(inout) :: ranks
      type(drift_watch), intent(inout) :: drift
      call sum_energies(kinetic, potential, ranks, drift%total, drift%total_size)
   end subroutine start_energy

   !> Energy of the bodies of all ranks, and the sum of the sizes of its parts.
   subroutine sum_energies(kinetic, potential, ranks, total, scale)
      real(dp), intent(in) :: kinetic(:), potential(:)
      class(communicator), intent(inout) :: ranks
      real(dp), intent(out) :: total, scale
      real(dp) :: sums(4)
      integer :: i
      call ranks%sums_before(sums)
      do i = 1, size(kinetic)
         sums = sums + [kinetic(i), potential(i), abs(kinetic(i)), abs(potential(i))]
      end do
      call ranks%sums_after(sums)
      total = sums(1) + sums(2)
      scale = sums(3) + sums(4)
   end subroutine sum_energies

   !> Compare with the start. All ranks call.
   subroutine follow_drift(states, kinetic, potential, ranks, drift)
      type(body_states), intent(in) :: states          !! of this rank
      real(dp), intent(in) :: kinetic(:), potential(:) !! (n)
      class(communicator), intent(inout) :: ranks
      type(drift_watch), intent(inout) :: drift
      real(dp) :: now(3), length, total, scale, changes(4)
      integer :: i
      drift%measured = .true.
      do i = 1, states%n
         length = length_of(states%y(:, i))
         drift%size_y(i) = larger(drift%size_y(i), length)
         now = space_momentum(states%y(:, i), states%q(:, i)) - drift%momentum(:, i)
         drift%casimir_change = larger(drift%casimir_change, &
                                       relative(length - drift%length(i), drift%size_y(i)))
         drift%momentum_change = larger(drift%momentum_change, &
                                        relative(length_of(now), drift%size_y(i)))
         drift%vertical_change = larger(drift%vertical_change, relative(now(3), drift%size_y(i)))
         drift%norm_change = larger(drift%norm_change, off_unit(states%q(:, i)))
      end do
      changes = [drift%casimir_change, drift%momentum_change, drift%vertical_change, &
                 drift%norm_change]
      call ranks%largest_over_ranks(changes)
      drift%casimir_change = changes(1)
      drift%momentum_change = changes(2)
      drift%vertical_change = changes(3)
      drift%norm_change = changes(4)
      call sum_energies(kinetic, potential, ranks, total, scale)
      drift%total_size = larger(drift%total_size, scale)
      drift%energy_change = larger(drift%energy_change, &
         relative(total - drift%total, drift%total_size))
   end subroutine follow_drift

   !> | |q| - 1 |
   pure real(dp) function off_unit(q)
      real(dp), intent(in) :: q(4)
      off_unit = largest_of(abs(q))
      if (ieee_is_finite(off_unit)) off_unit = abs(norm2(q) - 1)
   end function off_unit

   pure real(dp) function relative(change, scale)
      real(dp), intent(in) :: change, scale
      relative = abs(change)
      if (.not. ieee_is_finite(scale)) return
      if (scale > 0) relative = abs(change)/scale
   end function relative

end module poinsot_scene_drift
