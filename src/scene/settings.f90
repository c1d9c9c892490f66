!> A typed scene: what the reader makes of the file and the run needs.
module poinsot_scene_settings
   use poinsot_core_time_table, only: time_table_list
   use poinsot_core_kinds, only: dp, i8
   use poinsot_effect_effect, only: effect
   use poinsot_effect_settings, only: setting
   use poinsot_effect_traits, only: effect_traits
   implicit none(type, external)
   private
   public :: scene_settings, body_group, effect_setting, output_settings, body_total, &
      rotor_of, is_auto, traits_of
   public :: random_none, random_uniform, random_thermal

   integer, parameter :: random_none = 0, random_uniform = 1, random_thermal = 2

   !> One &bodies group. Momentum and attitude are in the principal frame.
   type :: body_group
      integer :: line = 0                     !! in the file, for messages
      integer(i8) :: count = 1
      real(dp) :: moments(3) = 1              !! principal moments, caller's order
      real(dp) :: axes(3, 3) = 0              !! columns: principal axes in the given frame
      real(dp) :: frame(4) = [1, 0, 0, 0]     !! the same turn as a quaternion: principal -> given
      logical :: turned = .false.             !! the given frame is not the principal one
      logical :: physical = .true.            !! refuse moments that no mass has
      real(dp) :: y(3) = 0                    !! angular momentum
      character(3) :: convention = "zxz"      !! of Euler angles
      logical :: from_omega = .false.         !! y was given as an angular velocity
      real(dp) :: rotor(3) = 0                !! momentum of its gyrostats: omega = (y - rotor)/I
      type(time_table_list) :: rotor_tables   !! of those that change: rotor_of has all of them
      real(dp) :: q(4) = [1, 0, 0, 0]         !! attitude
      character(:), allocatable :: note       !! what was made of a value, if anything
      integer :: random = random_none
      real(dp) :: temperature = 0             !! k T
      character(:), allocatable :: shape      !! if the moments are a shape's
      real(dp) :: lengths(3) = 0              !! of the shape, as its help says
      character(:), allocatable :: drawn      !! how its page shows it
      real(dp) :: position(3) = 0             !! of the first body
      real(dp) :: spacing(3) = 0              !! from one to the next
      integer :: lattice(3) = 0               !! bodies along each axis; 0: a chain
      logical :: turns_y = .false.            !! momenta are y_space, whatever the drawn attitudes
      real(dp) :: y_space(3) = 0
      character(:), allocatable :: points     !! file of point masses, if the moments are theirs
      character(:), allocatable :: file       !! of the states, if they were read
      real(dp), allocatable :: file_y(:, :), file_q(:, :) !! (3, count), (4, count): these states
   end type body_group

   !> One effect group: name and key-value pairs, as the effect registry takes them, in the scene's
   !> own body frames.
   type :: effect_setting
      character(:), allocatable :: name
      integer :: line = 0
      type(setting), allocatable :: settings(:)
      character(:), allocatable :: file      !! that numbers of it were read from, if any
      class(effect), allocatable :: made
      !! from these settings; whoever changes them deallocates
                                              !! it
   end type effect_setting

   !> &output
   type :: output_settings
      logical :: present = .false.            !! without the group nothing but the summary is
                                              !! written
      real(dp) :: every = 0                   !! time between outputs; 0 = use `times`
      real(dp), allocatable :: times(:)       !! output times, ascending
      integer(i8), allocatable :: bodies(:)   !! numbers of the bodies written; size 0 = all
      logical :: csv = .true., extxyz = .false., npy = .false.
      logical :: observables = .false.
      integer, allocatable :: columns(:)      !! further ones, by their numbers in column_names
      character(:), allocatable :: restart    !! name of the restart file, "" = none
      character(:), allocatable :: page       !! template of view.html, "" = no page
      character(:), allocatable :: pictures   !! none, body, top, tilt, angle, ensemble
      real(dp) :: axis(3) = [0, 0, 1]         !! body axis that pictures follow
      logical :: draw = .true.                !! pictures will be drawn, not their scripts only
      real(dp) :: rate = 0                    !! turning of the frame that `angle` is seen from
   end type output_settings

   !> The whole scene.
   type :: scene_settings
      character(:), allocatable :: file       !! where it was read
      character(:), allocatable :: name       !! the file's name without folder and ending
      character(:), allocatable :: head       !! what the file says of itself, at its beginning
      real(dp) :: t_end = 0
      real(dp) :: h = 0                       !! 0: free bodies go from output to output
      character(:), allocatable :: method, splitting
      real(dp) :: tol = 1e-8_dp
      real(dp) :: tolerance = 1e-12_dp        !! of splitting taylor
      integer(i8) :: seed = 1
      integer :: threads = 0                  !! 0: as OpenMP says, for long work
      character(:), allocatable :: from       !! restart file to continue from, "" = none
      logical :: reseed = .false.             !! a continuation may have another seed
      character(:), allocatable :: chosen     !! what `auto` chose and promises, "" = nothing
      character(:), allocatable :: chosen_fails !! why the choice does not keep `tol`, "" = it does
      type(body_group), allocatable :: bodies(:)
      type(effect_setting), allocatable :: effects(:)
      type(output_settings) :: output
   end type scene_settings

contains

   !> Number of bodies of all groups.
   pure integer(i8) function body_total(scene)
      type(scene_settings), intent(in) :: scene !! the typed scene
      body_total = sum(scene%bodies%count)
   end function body_total

   !> Is the method, the splitting or both still to be chosen?
   pure logical function is_auto(scene)
      type(scene_settings), intent(in) :: scene !! the typed scene
      is_auto = scene%method == "auto" .or. scene%splitting == "auto" .and. size(scene%effects) > 0
   end function is_auto

   !> What an effect is to a run; the worst of one that is not made.
   pure function traits_of(item) result(traits)
      type(effect_setting), intent(in) :: item
      type(effect_traits) :: traits
      if (allocated(item%made)) call item%made%get_traits(traits)
   end function traits_of

   !> The momentum of the gyrostats of a group at time t, principal axes.
   pure function rotor_of(bodies, t) result(rotor)
      type(body_group), intent(in) :: bodies
      real(dp), intent(in) :: t
      real(dp) :: rotor(3)
      rotor = bodies%rotor + bodies%rotor_tables%sum_at(t, 0.0_dp)
   end function rotor_of

end module poinsot_scene_settings
