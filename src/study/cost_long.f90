!> Long runs of a cost study: which candidates, and with which step size.
module poinsot_study_cost_long
   use poinsot_core_kinds, only: dp
   use poinsot_core_maxima, only: larger, largest_of
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_clock, only: wall_seconds
   use poinsot_study_cost_data, only: cost_request, cost_study
   use poinsot_study_cost_point, only: middle, of_both
   use poinsot_study_efficient, only: frontier_part, leading_parts
   use poinsot_study_energy_drift, only: drift_row, follow_energy
   implicit none(type, external)
   private
   public :: run_long

   real(dp), parameter :: long_share = 0.02_dp !! of the budget: the longest that one is followed

contains

   !> Energy in long runs of the frontier's candidates; of a free scene of all kinds of methods.
   subroutine run_long(quiet, request, begun, watch, study, error)
      type(scene_settings), intent(in) :: quiet
      type(cost_request), intent(in) :: request
      real(dp), intent(in) :: begun
      class(run_watch), intent(inout) :: watch
      type(cost_study), intent(inout) :: study
      type(poinsot_error), intent(inout) :: error
      type(drift_row), allocatable :: rows(:)
      integer, allocatable :: at(:)
      integer :: i, n
      real(dp) :: each, change
      change = 0
      associate (e => study%reference%state%energy, scale => study%reference%state%scale)
         do i = lbound(e, 2), ubound(e, 2)
            change = larger(change, largest_of(abs(e(:, i) - e(:, lbound(e, 2)))/scale))
         end do
      end associate
      study%conserves = change < 1e-9_dp
      if (.not. study%conserves .or. study%stopped .or. size(study%points) == 0) return
      call pick_for_drift(study, at)
      allocate (rows(100*max(1, size(at))))
      each = min(long_share*request%budget, &
                 (request%budget - (wall_seconds() - begun))/max(1, size(at)))
      n = 0
      do i = 1, size(at)
         associate (p => study%points(at(i)))
            call follow_energy(quiet, study%candidates(p%candidate), p%candidate, study%members, &
                               p%h, p%tolerance, study%t_end, each, request%compensated, &
                               watch, rows, n, error)
         end associate
         if (raised(error)) return
      end do
      study%drift = rows(:n)
   end subroutine run_long

   !> Points whose energy is followed.
   subroutine pick_for_drift(study, at)
      type(cost_study), intent(in) :: study
      integer, allocatable, intent(out) :: at(:)
      character(24), parameter :: shown(8) = [character(24) :: "exact", "dmv2", "dmv10", &
         "midpoint", "three-rotations", "symmetric-rotation", "rattle", "jacobi"]
      type(frontier_part), allocatable :: parts(:)
      integer :: i, k
      allocate (at(0))
      if (study%kind%free) then
         do k = 1, size(shown)
            i = usual_point(study, shown(k))
            if (i > 0) at = [at, i]
         end do
         return
      end if
      call leading_parts(study%points, size(study%candidates), of_both, parts)
      do k = 1, size(parts)
         if (size(at) >= 7 .or. parts(k)%point == 0) cycle
         if (.not. any(study%points(at)%candidate == parts(k)%candidate)) at = [at, parts(k)%point]
      end do
   end subroutine pick_for_drift

   !> A method's point with the step that turns the fastest body by about 0.2.
   integer function usual_point(study, method) result(at)
      type(cost_study), intent(in) :: study
      character(*), intent(in) :: method
      real(dp) :: nearest, deviation, wanted
      integer :: i
      at = 0
      nearest = huge(nearest)
      ! dmv2 makes an error of about (h omega)^3/12 a step: the step where it is a few per cent at
      ! the end is a usual one, whatever the unit of time
      wanted = 0
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (study%candidates(p%candidate)%method /= "dmv2" .or. .not. p%good) cycle
            if (p%angle(middle) < 0.05_dp .and. wanted <= 0) wanted = p%h
         end associate
      end do
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (study%candidates(p%candidate)%method /= method .or. .not. p%good) cycle
            deviation = abs(log(p%h/max(wanted, tiny(wanted))))
            if (deviation >= nearest) cycle
            nearest = deviation
            at = i
         end associate
      end do
   end function usual_point

end module poinsot_study_cost_long
