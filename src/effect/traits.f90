!> Properties of an effect for a whole run, as data: which integrals of the free motion it
!> conserves, and what can be drawn of it. Pictures, summaries and pages use these; none of them
!> refers to an effect by name.
module poinsot_effect_traits
   use poinsot_core_kinds, only: dp
   use poinsot_effect_terms, only: space_direction
   implicit none(type, external)
   private
   public :: effect_traits

   !> Without a word of its own an effect does work, knows every direction of space, and is not
   !> shown.
   type :: effect_traits
      logical :: energy = .false.        !! T + U stays, seen from the frame that turns with
                                         !! `direction`, if that turns
      logical :: internal = .false.      !! it acts within the body: |y| and Q y stay
      logical :: one_direction = .false. !! of space it knows `direction` only, and turns about
                                         !! that change nothing
      type(space_direction) :: direction
      real(dp) :: eccentricity = 0       !! of the orbit that `direction` turns with
      logical :: swings = .false.        !! strength along it as cos(rate t + phase)
      real(dp) :: arm(3) = 0             !! U = arm.(Q^T direction), a fixed unit vector: a top's
      character(8) :: shown = "other"    !! what pages make of it: a "gyrostat", a "top", a body
                                         !! in a "field", on an "orbit" or seen from a "turning"
                                         !! frame, or "other"
   end type effect_traits

end module poinsot_effect_traits
