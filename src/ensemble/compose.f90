!> Making a plan ready: the effects on each class, in its frame.
module poinsot_ensemble_compose
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_memory, poinsot_e_method
   use poinsot_body_class, only: extend_class
   use poinsot_effect_effect, only: effect, effect_item, flow_effect, pair_effect
   use poinsot_effect_frame, only: depends_on_frame, turn_settings, turn_class_vectors, &
      has_class_vectors
   use poinsot_effect_gyrostat, only: gyrostat
   use poinsot_effect_registry, only: describe_effect, effect_number, remake_effect, &
      noise_key
   use poinsot_effect_settings, only: setting, effect_info
   use poinsot_effect_terms, only: torque_terms
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, grow, refused
   use poinsot_free_method, only: find_method
   use poinsot_rotation_conversions, only: to_matrix
   use poinsot_splitting_block_flows, only: block_flows
   use poinsot_splitting_class_flows, only: compose_class
   use poinsot_splitting_registry, only: find_splitting
   use poinsot_splitting_tableaux, only: splitting, free_scheme
   use poinsot_taylor_problem, only: taylor_problem, make_problem, collect_terms
   use poinsot_taylor_settings, only: choose_orders
   implicit none(type, external)
   private
   public :: make_ready, attach_plan, scheme_of, class_terms

contains

   !> Make the plan ready: compose effects, check that they, the classes and the splitting fit.
   !> Immutable from then on.
   subroutine make_ready(plan, error)
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      integer :: unused
      if (refused(plan, error)) return
      if (plan%added == 0) then ! bodies have moments of their own, if there are any
         call add_class(plan, [1.0_dp, 1.0_dp, 1.0_dp], unused, error)
         if (raised(error)) return
         plan%classless = .true.
      end if
      if (.not. associated(plan%method%increment)) call find_method("exact", plan%method, error)
      if (plan%splitting%name == "") call find_splitting("srkn6", plan%splitting, error)
      if (.not. allocated(plan%effects)) allocate (plan%effects(0))
      call check_classes(plan, error)
      if (.not. raised(error)) call compose_all(plan, error)
      plan%ready = .not. raised(error)
      if (plan%ready .or. .not. plan%classless) return
      deallocate (plan%classes(1)%it)
      plan%added = 0
      plan%classless = .false.
   end subroutine make_ready

   !> Check that every class named by an effect exists.
   subroutine check_classes(plan, error)
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      integer :: i
      character(11) :: count_text
      do i = 1, size(plan%effects)
         select type (one => plan%effects(i)%it)
         class is (pair_effect)
            plan%coupled = .true.
         class is (flow_effect)
            plan%has_dissipation = .true.
         class is (gyrostat)
            plan%rotors_change = plan%rotors_change .or. allocated(one%table)
         end select
         if (size(plan%splitting%enter) > 0 .and. &
             noise_key(trim(plan%effects(i)%it%name)) /= "") then
            call raise(error, poinsot_e_method, "splitting '"//trim(plan%splitting%name)// &
                       "' works on processed momenta, and the noise of '"// &
                       trim(plan%effects(i)%it%name)//"' would heat them to another "// &
                       "temperature; use one without a processor, 'strang' or 'srkn6'")
            return
         end if
         if (plan%effects(i)%it%class_index > plan%class_count()) then
            write (count_text, "(i0)") plan%class_count()
            call raise(error, poinsot_e_domain, "effect '"//trim(plan%effects(i)%it%name)// &
                       "': key 'class' names a body class that does not exist; classes of "// &
                       "the plan: "//trim(count_text))
            return
         end if
      end do
   end subroutine check_classes

   !> The effects on each class, composed once for classes that share them.
   subroutine compose_all(plan, error)
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      integer :: c, n, classes, effects, next, state
      logical, allocatable :: framed(:)
      effects = size(plan%effects)
      classes = plan%added
      call turn_pair_effects(plan, error)
      if (raised(error)) return
      framed = [(is_framed(plan%effects(c)), c=1, effects)]
      call make_room_for_copies(plan, framed, error)
      n = classes
      if (all_alike(plan%effects(:effects)) .and. size(plan%effects) == effects) n = 1
      if (.not. raised(error)) allocate (plan%composed(n), plan%composition(classes), stat=state)
      if (.not. raised(error) .and. state /= 0) then
         call raise(error, poinsot_e_memory, "no memory for the flows of the body classes")
      end if
      if (raised(error)) return
      plan%free = free_scheme(inside=.false.)
      plan%damped = free_scheme(plan%splitting%middle > 0)
      plan%composition = [(min(c, n), c=1, classes)]
      next = effects
      do c = 1, n
         call compose_one(plan, c, framed, next, error)
         if (raised(error)) exit
      end do
      do c = 1, classes
         if (.not. raised(error)) call extend_class(plan%classes(c)%it, plan%method%terms)
      end do
      if (.not. raised(error)) call compose_taylor(plan, error)
      if (.not. raised(error)) return
      deallocate (plan%composed, plan%composition)
      call grow(plan%effects, effects - size(plan%effects), error)
   end subroutine compose_all

   !> Effects as data, class by class, for the Taylor integrator.
   subroutine compose_taylor(plan, error)
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      type(taylor_problem), allocatable :: problems(:)
      type(torque_terms) :: terms
      integer :: c, state
      if (.not. plan%splitting%adaptive) return
      if (plan%coupled) then
         call raise(error, poinsot_e_method, "splitting 'taylor' does not support effects " &
            // "that couple bodies; use 'srkn6'")
         return
      end if
      if (plan%rotors_change) then
         call raise(error, poinsot_e_method, "splitting 'taylor' does not support rotors " &
            // "that change with time (effect 'gyrostat', key 'table'); use 'srkn6'")
         return
      end if
      plan%orders = choose_orders(plan%tolerance)
      allocate (problems(plan%added), stat=state)
      if (state /= 0) then
         call raise(error, poinsot_e_memory, "no memory for the torques of the body classes")
         return
      end if
      do c = 1, plan%added
         call class_terms(plan, c, terms, error)
         if (raised(error)) return
         call make_problem(plan%classes(c)%it, terms, problems(c))
      end do
      call move_alloc(problems, plan%taylor)
   end subroutine compose_taylor

   !> What acts on class c, as data. POINSOT_E_METHOD for what is no data: pairs, noise, a program's
   !> own torque.
   subroutine class_terms(plan, c, terms, error)
      type(poinsot_plan), intent(in) :: plan      !! composed
      integer, intent(in) :: c                    !! 1 to plan%added
      type(torque_terms), intent(out) :: terms
      type(poinsot_error), intent(inout) :: error
      associate (flows => plan%composed(plan%composition(c)))
         call collect_terms(plan%classes(c)%it, [flows%torques, flows%dissipative], plan%effects, &
                            terms, error)
      end associate
   end subroutine class_terms

   !> Do the settings of an effect depend on the frame of the body?
   logical function is_framed(item)
      type(effect_item), intent(in) :: item
      is_framed = .false.
      if (.not. allocated(item%settings)) return
      is_framed = depends_on_frame(describe_effect(effect_number(trim(item%it%name))), &
                                   item%settings)
   end function is_framed

   !> Places behind the effects for their copies in the principal frames of classes.
   subroutine make_room_for_copies(plan, framed, error)
      type(poinsot_plan), intent(inout) :: plan
      logical, intent(in) :: framed(:)               !! (effects)
      type(poinsot_error), intent(inout) :: error
      integer :: c, i, copies
      copies = 0
      if (.not. any(framed)) return
      do c = 1, plan%added
         if (.not. plan%classes(c)%it%turned) cycle
         do i = 1, size(framed)
            if (framed(i) .and. plan%effects(i)%it%acts_on(c)) copies = copies + 1
         end do
      end do
      if (copies > 0) call grow(plan%effects, copies, error)
   end subroutine make_room_for_copies

   !> The effects on class c: as they are, or copies in its principal frame.
   subroutine compose_one(plan, c, framed, next, error)
      type(poinsot_plan), intent(inout) :: plan
      integer, intent(in) :: c
      logical, intent(in) :: framed(:)              !! (effects): the settings depend on the frame
      integer, intent(inout) :: next                !! the last place that is taken
      type(poinsot_error), intent(inout) :: error
      integer :: acting(size(framed)), i, n
      n = 0
      do i = 1, size(framed)
         if (.not. plan%effects(i)%it%acts_on(c)) cycle
         n = n + 1
         acting(n) = i
         if (.not. (plan%classes(c)%it%turned .and. framed(i))) cycle
         next = next + 1
         acting(n) = next
         call turn_effect(plan%effects(i), to_matrix(plan%classes(c)%it%axes), plan%effects(next), &
            error)
         if (raised(error)) return
      end do
      call compose_class(plan%classes(c)%it, acting(:n), plan%splitting, plan%effects, &
                         plan%composed(c), error)
   end subroutine compose_one

   !> An effect in the frame of a class with these principal axes.
   subroutine turn_effect(item, axes, copy, error)
      type(effect_item), intent(in) :: item
      real(dp), intent(in) :: axes(3, 3)
      type(effect_item), intent(inout) :: copy
      type(poinsot_error), intent(inout) :: error
      type(effect_info) :: info
      type(setting), allocatable :: turned(:)
      info = describe_effect(effect_number(trim(item%it%name)))
      call turn_settings(info, item%settings, axes, turned)
      call remake_effect(info, turned, copy%it, error)
   end subroutine turn_effect

   !> Effects that couple classes, with the vectors of each class in its principal frame.
   subroutine turn_pair_effects(plan, error)
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      type(effect_info) :: info
      type(setting), allocatable :: turned(:)
      real(dp), allocatable :: axes(:, :, :)
      class(effect), allocatable :: made
      integer :: i, c
      if (.not. plan%coupled) return
      if (.not. any([(plan%classes(c)%it%turned, c=1, plan%added)])) return
      allocate (axes(3, 3, plan%added))
      do c = 1, plan%added
         axes(:, :, c) = to_matrix(plan%classes(c)%it%axes)
      end do
      do i = 1, size(plan%effects)
         if (.not. allocated(plan%effects(i)%settings)) cycle
         info = describe_effect(effect_number(trim(plan%effects(i)%it%name)))
         if (.not. has_class_vectors(info)) cycle
         call turn_class_vectors(info, plan%effects(i)%settings, axes, turned)
         call remake_effect(info, turned, made, error)
         if (raised(error)) return
         call move_alloc(made, plan%effects(i)%it)
      end do
   end subroutine turn_pair_effects

   !> Does every effect act on all classes in the same way? A rotor turns each as its moments say.
   logical function all_alike(effects)
      type(effect_item), intent(in) :: effects(:)
      integer :: i
      all_alike = .true.
      do i = 1, size(effects)
         if (effects(i)%it%class_index /= 0) all_alike = .false.
         select type (one => effects(i)%it)
         class is (gyrostat)
            all_alike = .false.
         end select
      end do
   end function all_alike

   !> Attach the effects on its class to a block, by pointers into the plan, for one call.
   subroutine attach_plan(plan, b)
      type(poinsot_plan), intent(in), target :: plan   !! ready
      type(block_flows), intent(inout) :: b            !! number and class are known
      call b%attach(b%class, plan%method, plan%composed(plan%composition(b%number)), &
                    plan%effects, plan%seed)
   end subroutine attach_plan

   !> The scheme of a block: the plan's, or the bare free rotation where there is no torque.
   function scheme_of(plan, b) result(scheme)
      type(poinsot_plan), intent(in), target :: plan   !! ready
      type(block_flows), intent(in) :: b               !! attached
      type(splitting), pointer :: scheme
      if (size(b%acting%torques) > 0) then
         scheme => plan%splitting
      else if (b%has_dissipation) then
         scheme => plan%damped
      else
         scheme => plan%free
      end if
   end function scheme_of

end module poinsot_ensemble_compose
