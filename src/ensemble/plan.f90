!> The plan: everything about a calculation that does not change from call to call. Immutable once
!> ready, so that threads may share it; all that belongs to a body is the caller's.
module poinsot_ensemble_plan
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_nearest, only: suggestion
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_memory, poinsot_e_method, &
      poinsot_e_size
   use poinsot_body_class, only: body_class, make_class
   use poinsot_body_inertia, only: principal_axes
   use poinsot_core_number, only: parse_integer, number_ok
   use poinsot_rotation_conversions, only: from_matrix
   use poinsot_effect_effect, only: effect, effect_item, flow_effect, pair_effect
   use poinsot_effect_gyrostat, only: gyrostat
   use poinsot_effect_registry, only: make_effect
   use poinsot_effect_settings, only: setting
   use poinsot_ensemble_layout, only: momentum_names, body_momentum, layout_names, &
      layout_momentum
   use poinsot_free_method, only: free_method, find_method
   use poinsot_splitting_block_flows, only: block_flows
   use poinsot_splitting_class_flows, only: class_flows, compose_class
   use poinsot_splitting_registry, only: find_splitting
   use poinsot_splitting_tableaux, only: splitting, free_scheme
   implicit none(type, external)
   private
   public :: poinsot_plan, add_class, add_tensor_class, set_option, add_effect, add_ready_effect, &
      make_ready
   public :: attach_plan, scheme_of

   !> What a calculation needs to know beforehand. It holds all that it uses, so that it may be
   !> copied.
   type :: poinsot_plan
      logical :: ready = .false.
      type(body_class), allocatable :: classes(:)
      type(free_method) :: method                 !! set on creation to `exact`
      type(splitting) :: splitting                !! set to `srkn6`
      integer :: momentum = body_momentum         !! the caller's momentum variable
      logical :: principal = .false.              !! the caller's arrays are in principal frames,
                                                  !! whatever frame a class was given in
      logical :: space_torque = .false.           !! torques of `kick` and of callbacks are in the
                                                  !! space frame
      integer :: threads = 0                      !! 0: as OpenMP says
      integer(i8) :: seed = 0                     !! of random numbers
      type(effect_item), allocatable :: effects(:)
      logical :: coupled = .false.                !! an effect couples bodies
      ! made when the plan is closed
      type(splitting) :: free                     !! of classes without torque
      type(class_flows), allocatable :: composed(:)  !! what acts, once for all classes that share it
      integer, allocatable :: composition(:)      !! (classes): which of these
      logical :: has_dissipation = .false.        !! of any class
   end type poinsot_plan

contains

   !> Add a body class by principal moments; bodies name it by its number.
   subroutine add_class(plan, moments, number, error)
      type(poinsot_plan), intent(inout) :: plan
      real(dp), intent(in) :: moments(3)            !! principal moments, any order, any unit
      integer, intent(out) :: number                !! of the class, from 1
      type(poinsot_error), intent(inout) :: error   !! POINSOT_E_DOMAIN for unphysical moments
      call append_class(plan, moments, number, error)
   end subroutine add_class

   !> Add a body class by its inertia tensor in the caller's body frame, which y and q of its bodies
   !> then refer to.
   subroutine add_tensor_class(plan, tensor, number, error)
      type(poinsot_plan), intent(inout) :: plan
      real(dp), intent(in) :: tensor(3, 3)
      integer, intent(out) :: number
      type(poinsot_error), intent(inout) :: error
      real(dp) :: moments(3), axes(3, 3)
      number = 0
      call principal_axes(tensor, moments, axes, error)
      if (raised(error)) return
      call append_class(plan, moments, number, error)
      if (.not. raised(error)) call set_axes(plan%classes(number), axes)
   end subroutine add_tensor_class

   !> The frame that a class was given in.
   subroutine set_axes(class, axes)
      type(body_class), intent(inout) :: class
      real(dp), intent(in) :: axes(3, 3)          !! its columns the principal axes
      class%axes = from_matrix(axes)
      class%turned = any(abs(class%axes(2:4)) > 0)
   end subroutine set_axes

   subroutine append_class(plan, moments, number, error)
      type(poinsot_plan), intent(inout) :: plan
      real(dp), intent(in) :: moments(3)
      integer, intent(out) :: number
      type(poinsot_error), intent(inout) :: error
      type(body_class), allocatable :: classes(:)
      integer :: n, state

      number = 0
      if (refused(plan, error)) return
      n = 0
      if (allocated(plan%classes)) n = size(plan%classes)
      allocate (classes(n + 1), stat=state)
      if (state /= 0) then
         call raise(error, poinsot_e_memory, "no memory for another body class")
         return
      end if
      call make_class(moments, classes(n + 1), error)
      if (raised(error)) return
      if (n > 0) classes(1:n) = plan%classes
      call move_alloc(classes, plan%classes)
      number = n + 1
   end subroutine append_class

   !> Set an option by name: method, splitting, layout, momentum, frame (of torques: body, space),
   !> threads, seed. POINSOT_E_METHOD for an unknown name or value, with what there is.
   subroutine set_option(plan, key, value, error)
      type(poinsot_plan), intent(inout) :: plan
      character(*), intent(in) :: key, value
      type(poinsot_error), intent(inout) :: error
      character(9), parameter :: keys(7) = [character(9) :: "method", "splitting", "layout", &
         "momentum", "frame", &
                                            "threads", "seed"]
      integer :: place
      integer(i8) :: number

      if (refused(plan, error)) return
      select case (key)
      case ("method")
         call find_method(value, plan%method, error)
      case ("splitting")
         call find_splitting(value, plan%splitting, error)
      case ("layout")
         call choose("layout", value, layout_names, place, error)
         if (raised(error)) return
         plan%momentum = layout_momentum(place)
         plan%space_torque = place /= 1
      case ("momentum")
         call choose("momentum", value, momentum_names, place, error)
         if (.not. raised(error)) plan%momentum = place
      case ("frame")
         call choose("frame", value, [character(5) :: "body", "space"], place, error)
         if (.not. raised(error)) plan%space_torque = place == 2
      case ("threads")
         call read_integer(key, value, 0_i8, 4096_i8, number, error)
         if (.not. raised(error)) plan%threads = int(number)
      case ("seed")
         call read_integer(key, value, -huge(number), huge(number), number, error)
         if (.not. raised(error)) plan%seed = number
      case default
         call raise(error, poinsot_e_method, "plan: unknown option '"//trim(key)//"'"// &
            suggestion(key, keys))
      end select
   end subroutine set_option

   !> Place of a name in a list.
   subroutine choose(key, value, names, place, error)
      character(*), intent(in) :: key, value, names(:)
      integer, intent(out) :: place
      type(poinsot_error), intent(inout) :: error
      do place = 1, size(names)
         if (names(place) == value) return
      end do
      call raise(error, poinsot_e_method, "plan: unknown "//key//" '"//trim(value)//"'"// &
         suggestion(value, names))
   end subroutine choose

   subroutine read_integer(key, value, least, most, number, error)
      character(*), intent(in) :: key, value
      integer(i8), intent(in) :: least, most
      integer(i8), intent(out) :: number
      type(poinsot_error), intent(inout) :: error
      integer :: outcome
      character(50) :: range
      call parse_integer(trim(value), number, outcome)
      if (outcome == number_ok .and. number >= least .and. number <= most) return
      write (range, "(i0, a, i0)") least, " to ", most
      call raise(error, poinsot_e_domain, "plan: "//key//" = '"//trim(value) &
         //"' is not a whole number, "//trim(range))
   end subroutine read_integer

   !> Add an effect by name, with its keys and values (see `poinsot effects`).
   subroutine add_effect(plan, name, settings, error)
      type(poinsot_plan), intent(inout) :: plan
      character(*), intent(in) :: name
      type(setting), intent(in) :: settings(:)
      type(poinsot_error), intent(inout) :: error
      class(effect), allocatable :: made
      if (refused(plan, error)) return
      call make_effect(name, settings, made, error)
      if (raised(error)) return
      call add_ready_effect(plan, made, error)
   end subroutine add_effect

   !> Add an effect of the user's own type: an extension of torque_effect, flow_effect or
   !> pair_effect.
   subroutine add_ready_effect(plan, made, error)
      type(poinsot_plan), intent(inout) :: plan
      class(effect), allocatable, intent(inout) :: made   !! moved into the plan
      type(poinsot_error), intent(inout) :: error
      type(effect_item), allocatable :: effects(:)
      integer :: n, i, state
      if (refused(plan, error)) return
      n = 0
      if (allocated(plan%effects)) n = size(plan%effects)
      allocate (effects(n + 1), stat=state)
      if (state /= 0) then
         call raise(error, poinsot_e_memory, "no memory for another effect")
         return
      end if
      do i = 1, n
         call move_alloc(plan%effects(i)%it, effects(i)%it)
      end do
      call move_alloc(made, effects(n + 1)%it)
      call move_alloc(effects, plan%effects)
   end subroutine add_ready_effect

   !> Close the plan: compose effects, check that they, the classes and the splitting fit. Immutable
   !> from here on.
   subroutine make_ready(plan, error)
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      if (refused(plan, error)) return
      if (.not. allocated(plan%classes)) then
         call raise(error, poinsot_e_size, &
            "plan: add at least one body class before it is made ready")
         return
      end if
      if (.not. associated(plan%method%increment)) call find_method("exact", plan%method, error)
      if (plan%splitting%name == "") call find_splitting("srkn6", plan%splitting, error)
      if (.not. allocated(plan%effects)) allocate (plan%effects(0))
      call check_classes(plan, error)
      if (.not. raised(error)) call compose_all(plan, error)
      plan%ready = .not. raised(error)
   end subroutine make_ready

   !> Every class that an effect names must be there.
   subroutine check_classes(plan, error)
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      integer :: i
      do i = 1, size(plan%effects)
         select type (one => plan%effects(i)%it)
         class is (pair_effect)
            plan%coupled = .true.
         class is (flow_effect)
            plan%has_dissipation = .true.
         end select
         if (plan%effects(i)%it%class_index > size(plan%classes)) then
            call raise(error, poinsot_e_domain, "effect '"//trim(plan%effects(i)%it%name)// &
                       "' acts on a body class that the plan does not have")
            return
         end if
      end do
   end subroutine check_classes

   !> What acts on each class, once for all classes that nothing tells apart.
   subroutine compose_all(plan, error)
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      integer :: c, n, classes, state
      logical :: alike
      classes = size(plan%classes)
      alike = all_alike(plan%effects)
      n = merge(1, classes, alike)
      allocate (plan%composed(n), plan%composition(classes), stat=state)
      if (state /= 0) then
         call raise(error, poinsot_e_memory, "no memory for the flows of the body classes")
         return
      end if
      plan%free = free_scheme()
      plan%composition = [(min(c, n), c=1, classes)]
      do c = 1, n
         call compose_class(plan%classes(c), c, plan%splitting, plan%effects, plan%composed(c), &
                            error)
         if (raised(error)) exit
      end do
      if (raised(error)) deallocate (plan%composed, plan%composition)
   end subroutine compose_all

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

   !> Show a block what acts on its class. It points into the plan: for the length of a call.
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
      else
         scheme => plan%free
      end if
   end function scheme_of

   !> A ready plan takes no more changes.
   logical function refused(plan, error)
      type(poinsot_plan), intent(in) :: plan
      type(poinsot_error), intent(inout) :: error
      refused = plan%ready
      if (refused) call raise(error, poinsot_e_domain, &
         "plan: it is ready, and cannot be changed any more")
   end function refused

end module poinsot_ensemble_plan
