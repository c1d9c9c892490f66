!> Candidates for a scene: methods times splittings, as far as they apply.
module poinsot_study_candidates
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_nearest, only: suggestion
   use poinsot_core_status, only: poinsot_e_method
   use poinsot_effect_effect, only: flow_effect
   use poinsot_effect_settings, only: effect_info
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_free_method, only: free_method, find_method, method_count, method_name
   use poinsot_scene_names, only: effect_table
   use poinsot_scene_noise, only: has_noise, noise_setting
   use poinsot_scene_settings, only: scene_settings, body_group, effect_setting, &
      random_thermal
   use poinsot_scene_text, only: quoted
   use poinsot_splitting_registry, only: splitting_count, splitting_name, &
      find_splitting, achieved_order
   use poinsot_splitting_tableaux, only: splitting
   use poinsot_study_trial, only: make_plan
   implicit none(type, external)
   private
   public :: candidate, scene_kind, survey_scene, quiet_scene, list_candidates, label_of, &
      no_splitting, &
      plan_splitting

   character(*), parameter :: no_splitting = "-" !! of scenes without kicks
   character(24), parameter, public :: any_name(0) = "" !! instead of names: all that apply

   !> One way to turn the bodies.
   type :: candidate
      character(24) :: method = ""
      character(24) :: splitting = no_splitting
      integer :: order = 0                     !! of the whole; 0: exact
      integer :: turns = 1                     !! free rotations of a step
      logical :: adaptive = .false.            !! `taylor`: a tolerance, no step; the method is not
                                               !! used
   end type candidate

   !> What a scene is to a study.
   type :: scene_kind
      logical :: free = .false.                !! no effect at all
      logical :: kicks = .false.               !! torques, or rotors: the splitting matters
      logical :: coupled = .false.             !! bodies see each other
      integer :: limit = 0                     !! highest order that the effects allow; 0: any
      logical :: noisy = .false.               !! a thermostat
   end type scene_kind

contains

   !> Which kind of scene is this? Error: what its plan refuses.
   subroutine survey_scene(scene, kind, error)
      type(scene_settings), intent(in) :: scene
      type(scene_kind), intent(out) :: kind
      type(poinsot_error), intent(inout) :: error
      type(poinsot_plan) :: plan
      type(effect_info), allocatable :: known(:)
      integer :: i, j
      call make_plan(scene, "exact", "srkn6", plan, error)
      if (raised(error)) return
      kind%coupled = plan%coupled
      kind%free = size(scene%effects) == 0
      kind%noisy = has_noise(scene)
      call effect_table(known)
      do i = 1, size(plan%effects)
         select type (one => plan%effects(i)%it)
         class is (flow_effect)
            continue
         class default
            kind%kicks = .true.
         end select
      end do
      do i = 1, size(scene%effects)
         do j = 1, size(known)
            if (known(j)%name /= scene%effects(i)%name .or. known(j)%order == 0) cycle
            if (kind%limit == 0) kind%limit = known(j)%order
            kind%limit = min(kind%limit, known(j)%order)
         end do
      end do
   end subroutine survey_scene

   !> The scene without noise: a thermostat at temperature zero, that is its friction alone. Two
   !> runs with noise and different steps are two samples, and have no distance that a step would
   !> shrink. Bodies at rest, which only noise would move, begin with momenta of its temperature.
   subroutine quiet_scene(scene, quiet)
      type(scene_settings), intent(in) :: scene
      type(scene_settings), intent(out) :: quiet
      integer :: i, j
      quiet = scene
      do i = 1, size(quiet%effects)
         j = noise_setting(quiet%effects(i))
         if (j == 0) cycle
         call warm(quiet%effects(i), quiet%effects(i)%settings(j)%values(1), quiet%bodies)
         quiet%effects(i)%settings(j)%values = [0.0_dp]
         deallocate (quiet%effects(i)%made)
      end do
   end subroutine quiet_scene

   !> Thermal momenta for groups at rest, of those that the thermostat acts on.
   pure subroutine warm(thermostat, temperature, bodies)
      type(effect_setting), intent(in) :: thermostat
      real(dp), intent(in) :: temperature
      type(body_group), intent(inout) :: bodies(:)
      integer :: i
      do i = 1, size(bodies)
         if (.not. thermostat%made%acts_on(i) .or. allocated(bodies(i)%file_q)) cycle
         if (bodies(i)%random == random_thermal .or. maxval(abs(bodies(i)%y)) > 0) cycle
         bodies(i)%random = random_thermal
         bodies(i)%temperature = temperature
      end do
   end subroutine warm

   !> All candidates for a scene, or those of the methods and splittings named. A splitting that
   !> needs a force gradient which an effect does not have is left out; by name it is an error.
   subroutine list_candidates(scene, kind, methods, splittings, list, error)
      type(scene_settings), intent(in) :: scene
      type(scene_kind), intent(in) :: kind
      character(24), intent(in) :: methods(:), splittings(:)   !! size 0: all
      type(candidate), allocatable, intent(out) :: list(:)
      type(poinsot_error), intent(inout) :: error
      character(24), allocatable :: some_methods(:), some_splittings(:)
      integer :: i, j, n
      call method_choice(methods, some_methods, error)
      if (.not. raised(error)) call splitting_choice(scene, kind, splittings, some_splittings, &
         error)
      if (raised(error)) return
      allocate (list(size(some_methods)*size(some_splittings)))
      n = 0
      do j = 1, size(some_splittings)
         do i = 1, size(some_methods)
            if (.not. goes_with(some_methods, i, some_splittings(j), size(splittings) > 0)) cycle
            n = n + 1
            call fill(kind, some_methods(i), some_splittings(j), list(n), error)
            if (raised(error)) return
         end do
      end do
      list = list(:n)
   end subroutine list_candidates

   !> `taylor` uses no method: it stands once, beside `exact`; if it is named, beside any.
   pure logical function goes_with(methods, i, scheme, named)
      character(24), intent(in) :: methods(:), scheme
      integer, intent(in) :: i
      logical, intent(in) :: named
      goes_with = .true.
      if (scheme /= "taylor") return
      goes_with = methods(i) == "exact"
      if (named .and. .not. any(methods == "exact")) goes_with = i == 1
   end function goes_with

   !> Order and cost of one candidate.
   subroutine fill(kind, method, scheme, one, error)
      type(scene_kind), intent(in) :: kind
      character(*), intent(in) :: method, scheme
      type(candidate), intent(out) :: one
      type(poinsot_error), intent(inout) :: error
      type(free_method) :: rotor
      type(splitting) :: row
      one%method = method
      one%splitting = scheme
      call find_method(trim(method), rotor, error)
      if (raised(error)) return
      one%order = achieved_order(0, rotor%order, [kind%limit])
      if (scheme == no_splitting) return
      call find_splitting(trim(scheme), row, error)
      if (raised(error)) return
      one%adaptive = row%adaptive
      one%turns = row%stages
      one%order = achieved_order(row%order, rotor%order, [kind%limit])
      if (one%adaptive) one%order = 0
      if (one%adaptive) one%turns = 1
   end subroutine fill

   !> The methods named, or all.
   subroutine method_choice(named, methods, error)
      character(24), intent(in) :: named(:)
      character(24), allocatable, intent(out) :: methods(:)
      type(poinsot_error), intent(inout) :: error
      character(24) :: all(method_count())
      integer :: i
      do i = 1, size(all)
         all(i) = method_name(i)
      end do
      methods = all
      if (size(named) > 0) methods = named
      call check_known("method", methods, all, error)
   end subroutine method_choice

   !> The splittings named, or all that the scene's effects allow; none for a scene without kicks.
   subroutine splitting_choice(scene, kind, named, splittings, error)
      type(scene_settings), intent(in) :: scene
      type(scene_kind), intent(in) :: kind
      character(24), intent(in) :: named(:)
      character(24), allocatable, intent(out) :: splittings(:)
      type(poinsot_error), intent(inout) :: error
      character(24) :: all(splitting_count())
      type(poinsot_error) :: refused
      type(poinsot_plan) :: plan
      logical :: fits(splitting_count())
      integer :: i
      do i = 1, size(all)
         all(i) = splitting_name(i)
      end do
      call check_known("splitting", named, all, error)
      splittings = [character(24) :: no_splitting]
      if (raised(error) .or. kind%free) return
      if (kind%kicks) then
         splittings = pack(all, all /= "baoab") ! it is for noise
         if (size(named) > 0) splittings = named
      else
         splittings = [character(24) :: "taylor"] ! friction alone
      end if
      do i = 1, size(splittings)
         call make_plan(scene, "exact", trim(splittings(i)), plan, refused)
         fits(i) = .not. raised(refused)
         if (.not. fits(i) .and. size(named) > 0) error = refused
         refused%code = 0
      end do
      splittings = pack(splittings, fits(:size(splittings)))
      if (.not. kind%kicks) splittings = [character(24) :: no_splitting, splittings]
   end subroutine splitting_choice

   !> Every name in the list of those there are.
   subroutine check_known(what, names, all, error)
      character(*), intent(in) :: what
      character(24), intent(in) :: names(:), all(:)
      type(poinsot_error), intent(inout) :: error
      integer :: i
      do i = 1, size(names)
         if (raised(error) .or. any(all == names(i))) cycle
         call raise(error, poinsot_e_method, "unknown " // what // " " // &
            quoted(trim(names(i))) // suggestion(names(i), all, """", """"))
      end do
   end subroutine check_known

   !> A splitting for the plan, also where none is needed.
   pure function plan_splitting(one) result(name)
      type(candidate), intent(in) :: one
      character(:), allocatable :: name
      name = trim(one%splitting)
      if (name == no_splitting) name = "srkn6"
   end function plan_splitting

   !> "exact + srkn6", or the method alone; "taylor".
   pure function label_of(one) result(text)
      type(candidate), intent(in) :: one
      character(:), allocatable :: text
      text = trim(one%method)
      if (one%adaptive) text = trim(one%splitting)
      if (one%adaptive) return
      if (one%splitting /= no_splitting) text = text // " + " // trim(one%splitting)
   end function label_of

end module poinsot_study_candidates
