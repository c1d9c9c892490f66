!> The request for a cost study, and its results.
module poinsot_study_cost_data
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_study_candidates, only: candidate, scene_kind
   use poinsot_study_cost_point, only: cost_point
   use poinsot_study_energy_drift, only: drift_row
   use poinsot_study_members, only: member_set
   use poinsot_study_reference, only: reference_solution
   use poinsot_study_rivals, only: rival_point
   implicit none(type, external)
   private
   public :: cost_request, cost_study

   integer, parameter, public :: few = 24 !! so many candidates are all shown and named

   !> The request.
   type :: cost_request
      character(24), allocatable :: methods(:), splittings(:) !! size 0: all that apply
      real(dp) :: budget = 60                 !! seconds for everything
      real(dp) :: reserve = 0                 !! of those left to the caller, to write and draw
      real(dp) :: spread = 0.3_dp !! of the initial states, radians; any_direction: uniform
      integer :: members = 2*lanes            !! initial states
      integer :: ensemble = 1024              !! bodies that are timed together
      logical :: compensated = .true.         !! compensated sums, as `poinsot run` has them
      logical :: timed = .true.               !! false: errors only
      integer(i8) :: most_steps = 2_i8**40    !! from start to end
   end type cost_request

   !> The results.
   type :: cost_study
      type(scene_kind) :: kind
      type(candidate), allocatable :: candidates(:)
      type(cost_point), allocatable :: points(:)  !! candidate by candidate, steps ascending
      type(member_set) :: members
      type(reference_solution) :: reference
      real(dp) :: t_end = 0
      type(drift_row), allocatable :: drift(:)    !! energy in long runs
      type(rival_point), allocatable :: rivals(:) !! other integrators, from files; size 0: none
      logical :: conserves = .false.              !! the scene keeps its energy
      integer :: late = 0                         !! candidates given up for want of time
      integer :: untimed = 0                      !! points with an error and no time
      real(dp) :: seconds = 0                     !! spent
      logical :: stopped = .false.                !! interrupted by the user
   end type cost_study

end module poinsot_study_cost_data
