!> Growth of the energy error in long runs: a few candidates, each with the step size it would be
!> used with.
module poinsot_study_energy_drift
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_maxima, only: larger, largest_of
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_candidates, only: candidate, plan_splitting
   use poinsot_study_clock, only: wall_seconds
   use poinsot_study_members, only: member_set
   use poinsot_study_statistics, only: median
   use poinsot_study_trial, only: make_plan, set_tolerance, integrate, &
      member_energies
   implicit none(type, external)
   private
   public :: drift_row, follow_energy

   integer, parameter :: a_decade = 8       !! looks in a decade of time
   real(dp), parameter :: longest = 1e4_dp  !! times the scene's own length

   !> Error of the energy so far, at one time of one candidate.
   type :: drift_row
      integer :: candidate = 0
      real(dp) :: h = 0, t = 0
      real(dp) :: median = 0, worst = 0 !! over the states; largest so far, over the kinetic energy
      real(dp) :: tolerance = 0         !! of `taylor`; 0 of others
   end type drift_row

contains

   !> Run a candidate for long, until its seconds are over.
   subroutine follow_energy(scene, one, number, members, h, tolerance, t_end, seconds, &
      compensated, watch, &
      rows, n, error)
      type(scene_settings), intent(in) :: scene
      type(candidate), intent(in) :: one
      integer, intent(in) :: number
      type(member_set), intent(in) :: members
      real(dp), intent(in) :: h
      real(dp), intent(in) :: tolerance           !! of `taylor`; 0 of others
      real(dp), intent(in) :: t_end
      real(dp), intent(in) :: seconds             !! budget
      logical, intent(in) :: compensated
      class(run_watch), intent(inout) :: watch
      type(drift_row), intent(inout) :: rows(:)   !! filled from n + 1
      integer, intent(inout) :: n
      type(poinsot_error), intent(inout) :: error
      type(poinsot_plan) :: plan
      real(dp), allocatable :: y(:, :), q(:, :), carry(:, :)
      real(dp), dimension(members%n) :: begin, now, scale, most
      real(dp) :: begun, a_step
      integer(i8) :: done, next
      integer :: k
      logical :: good
      call make_plan(scene, trim(one%method), plan_splitting(one), plan, error)
      if (raised(error)) return
      if (tolerance > 0) call set_tolerance(plan, tolerance)
      y = members%y
      q = members%q
      if (compensated) then
         allocate (carry(7, members%n))
         carry = 0
      end if
      call member_energies(plan, members, 0.0_dp, y, q, begin, scale)
      where (.not. scale > 1e-3_dp*maxval(scale)) scale = max(maxval(scale), tiny(scale))
      most = 0
      begun = wall_seconds()
      done = 0
      k = 0
      do while (n < size(rows))
         next = max(done + 1, nint(0.1_dp*t_end/h*10.0_dp**(real(k, dp)/a_decade), i8))
         k = k + 1
         a_step = (wall_seconds() - begun)/max(done, 1_i8)
         if (next*h > longest*t_end .or. next*a_step > seconds .or. watch%stop_now()) exit
         call integrate(plan, members, h, done, next - done, y, q, carry, good)
         if (.not. good) exit
         done = next
         call member_energies(plan, members, done*h, y, q, now)
         most = larger(most, abs(now - begin)/scale)
         n = n + 1
         rows(n) = drift_row(number, h, done*h, median(most), largest_of(most), tolerance)
      end do
   end subroutine follow_energy

end module poinsot_study_energy_drift
