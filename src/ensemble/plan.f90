!> The plan: everything about a calculation that does not change from call to call. Immutable once
!> ready, so that threads may share it; all data of bodies belong to the caller.
module poinsot_ensemble_plan
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_message, only: printable
   use poinsot_core_nearest, only: known_names
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_memory, poinsot_e_method
   use poinsot_body_class, only: body_class, make_class
   use poinsot_body_moments, only: accept_moments
   use poinsot_body_inertia, only: principal_axes, is_diagonal
   use poinsot_core_number, only: lower, parse_integer, parse_real, number_ok
   use poinsot_rotation_conversions, only: from_matrix, to_matrix
   use poinsot_effect_callback, only: callback_label
   use poinsot_effect_effect, only: effect, effect_item, torque_effect, flow_effect, pair_effect
   use poinsot_effect_gyrostat, only: gyrostat
   use poinsot_effect_registry, only: make_effect
   use poinsot_effect_settings, only: setting
   use poinsot_ensemble_class_index, only: class_index, insert_class, nearest_class
   use poinsot_ensemble_layout, only: momentum_names, body_momentum, layout_names, &
      layout_momentum
   use poinsot_free_method, only: free_method, find_method
   use poinsot_splitting_class_flows, only: class_flows
   use poinsot_splitting_registry, only: find_splitting
   use poinsot_splitting_tableaux, only: splitting
   use poinsot_taylor_problem, only: taylor_problem
   use poinsot_taylor_settings, only: taylor_orders, default_tolerance, least_tolerance, &
      most_tolerance
   implicit none(type, external)
   private
   public :: poinsot_plan, add_class, add_tensor_class, find_class, class_axes, set_option, &
      add_effect, add_ready_effect, grow, refused

   !> A container for a class: arrays of them can grow without moving classes.
   type :: class_item
      type(body_class), allocatable :: it
      logical :: from_tensor = .false.
   end type class_item

   !> The fixed data of a calculation. It owns all that it uses, so that it can be copied.
   type :: poinsot_plan
      logical :: ready = .false.
      type(class_item), allocatable :: classes(:) !! as many as were added, then room for more
      integer :: added = 0                        !! how many
      type(class_index) :: index                  !! of them by moments, if it was asked for
      integer :: indexed = 0                      !! how many it knows
      type(free_method) :: method                 !! set on creation to `exact`
      type(splitting) :: splitting                !! set to `srkn6`
      logical :: physical = .true.                !! classes must have moments that a mass can have
      integer :: momentum = body_momentum         !! the caller's momentum variable
      logical :: principal = .false.              !! the caller's arrays are in principal frames,
                                                  !! whatever frame a class was given in
      logical :: space_torque = .false.           !! torques of `kick` and of callbacks are in the
                                                  !! space frame
      integer :: threads = 1                      !! 0: as OpenMP says
      real(dp) :: tolerance = default_tolerance   !! of `taylor`, relative
      integer(i8) :: seed = 0                     !! of random numbers
      type(effect_item), allocatable :: effects(:)
      logical :: coupled = .false.                !! an effect couples bodies
      ! made when the plan is closed
      type(splitting) :: free                     !! of classes without torque
      type(splitting) :: damped                   !! of those with drag or a thermostat alone
      type(class_flows), allocatable :: composed(:)
      !! what acts, once for all classes that share it
      integer, allocatable :: composition(:)      !! (classes): which of these
      type(taylor_problem), allocatable :: taylor(:) !! (classes), with splitting `taylor`
      type(taylor_orders) :: orders               !! of its series
      logical :: has_dissipation = .false.        !! of any class
      logical :: rotors_change = .false.          !! a rotor's momentum is a table in time
      logical :: classless = .false.              !! no class was added: bodies have moments of
                                                  !! their own; the one class is a sphere unused
   contains
      procedure :: is_turned
      procedure :: class_count
   end type poinsot_plan

contains

   !> Are the caller's arrays, for bodies of this class, in another frame than the principal one?
   pure logical function is_turned(plan, class)
      class(poinsot_plan), intent(in) :: plan
      type(body_class), intent(in) :: class
      is_turned = class%turned .and. .not. plan%principal
   end function is_turned

   !> Number of classes added.
   pure integer function class_count(plan)
      class(poinsot_plan), intent(in) :: plan
      class_count = 0
      if (.not. plan%classless) class_count = plan%added
   end function class_count

   !> Add a body class by principal moments; bodies refer to it by its number.
   subroutine add_class(plan, moments, number, error, axes)
      type(poinsot_plan), intent(inout) :: plan
      real(dp), intent(in) :: moments(3)            !! principal moments, any order, any unit
      integer, intent(out) :: number                !! of the class, from 1
      type(poinsot_error), intent(inout) :: error   !! POINSOT_E_DOMAIN for unphysical moments
      real(dp), intent(in), optional :: axes(3, 3)  !! its columns the principal axes in the frame
                                                    !! that the class was given in
      call append_class(plan, moments, number, error)
      if (raised(error) .or. .not. present(axes)) return
      associate (class => plan%classes(number)%it)
         class%axes = from_matrix(axes)
         class%turned = any(abs(class%axes(2:4)) > 0)
      end associate
   end subroutine add_class

   !> Add a body class by its inertia tensor in the caller's body frame, which y, q, torques and the
   !> body vectors of effects then refer to. Entries of a diagonal tensor are moments.
   subroutine add_tensor_class(plan, tensor, number, error)
      type(poinsot_plan), intent(inout) :: plan
      real(dp), intent(in) :: tensor(3, 3)
      integer, intent(out) :: number
      type(poinsot_error), intent(inout) :: error
      real(dp) :: moments(3), axes(3, 3)
      number = 0
      if (refused(plan, error)) return
      if (is_diagonal(tensor)) then
         call add_class(plan, [tensor(1, 1), tensor(2, 2), tensor(3, 3)], number, error)
      else
         call principal_axes(tensor, moments, axes, error, plan%physical)
         if (.not. raised(error)) call add_class(plan, moments, number, error, axes)
      end if
      if (.not. raised(error)) plan%classes(number)%from_tensor = .true.
   end subroutine add_tensor_class

   !> The principal axes of a class as the columns of a rotation: x_given = matmul(axes,
   !> x_principal). The identity for a class made from moments.
   subroutine class_axes(plan, number, axes, error)
      type(poinsot_plan), intent(in) :: plan
      integer, intent(in) :: number                 !! of the class, from 1
      real(dp), intent(inout) :: axes(3, 3)
      type(poinsot_error), intent(inout) :: error   !! POINSOT_E_DOMAIN if there is no such class
      if (number < 1 .or. number > plan%class_count()) then
         call raise(error, poinsot_e_domain, "plan: there is no body class of that number")
      else
         axes = to_matrix(plan%classes(number)%it%axes)
      end if
   end subroutine class_axes

   subroutine append_class(plan, moments, number, error)
      type(poinsot_plan), intent(inout) :: plan
      real(dp), intent(in) :: moments(3)
      integer, intent(out) :: number
      type(poinsot_error), intent(inout) :: error
      integer :: state

      number = 0
      if (refused(plan, error)) return
      call make_room(plan, state)
      if (state == 0) allocate (plan%classes(plan%added + 1)%it, stat=state)
      if (state /= 0) then
         call raise(error, poinsot_e_memory, "no memory for another body class")
         return
      end if
      call make_class(moments, plan%classes(plan%added + 1)%it, error, plan%physical)
      if (raised(error)) then
         deallocate (plan%classes(plan%added + 1)%it)
         return
      end if
      plan%added = plan%added + 1
      number = plan%added
   end subroutine append_class

   !> Room for one more class: twice as many places when there is none left.
   subroutine make_room(plan, state)
      type(poinsot_plan), intent(inout) :: plan
      integer, intent(out) :: state              !! 0, or there is no memory
      type(class_item), allocatable :: longer(:)
      integer :: i, room
      state = 0
      room = 0
      if (allocated(plan%classes)) room = size(plan%classes)
      if (plan%added < room) return
      allocate (longer(max(1, 2*room)), stat=state)
      if (state /= 0) return
      do i = 1, room
         longer(i)%from_tensor = plan%classes(i)%from_tensor
         call move_alloc(plan%classes(i)%it, longer(i)%it)
      end do
      call move_alloc(longer, plan%classes)
   end subroutine make_room

   !> The class whose moments are nearest to those given, none of them further than `tolerance`
   !> times the largest, of several the lowest; or a new one. Classes made from tensors are left
   !> out.
   subroutine find_class(plan, moments, tolerance, number, error)
      type(poinsot_plan), intent(inout) :: plan
      real(dp), intent(in) :: moments(3)            !! axis by axis, in the caller's order
      real(dp), intent(in) :: tolerance             !! zero or positive
      integer, intent(out) :: number                !! of the class, from 1
      type(poinsot_error), intent(inout) :: error   !! POINSOT_E_DOMAIN: the tolerance, the moments
      real(dp) :: accepted(3), bound
      number = 0
      if (refused(plan, error)) return
      if (.not. ieee_is_finite(tolerance)) then
         call raise(error, poinsot_e_domain, "find_class: tolerance is not finite")
      else if (tolerance < 0) then
         call raise(error, poinsot_e_domain, "find_class: tolerance is negative")
      else
         accepted = moments
         call accept_moments(accepted, error, plan%physical)
      end if
      if (.not. raised(error)) call update_index(plan, error)
      if (raised(error)) return
      bound = huge(bound)
      if (exponent(tolerance) + exponent(maxval(accepted)) < maxexponent(bound)) then
         bound = tolerance*maxval(accepted)
      end if
      number = nearest_class(plan%index, accepted, bound)
      if (number == 0) call add_class(plan, moments, number, error)
   end subroutine find_class

   !> Index the classes that were added since the last time.
   subroutine update_index(plan, error)
      type(poinsot_plan), intent(inout) :: plan
      type(poinsot_error), intent(inout) :: error
      logical :: failed
      do while (plan%indexed < plan%added)
         associate (class => plan%classes(plan%indexed + 1)%it)
            failed = .false.
            if (.not. (class%turned .or. plan%classes(plan%indexed + 1)%from_tensor)) then
               if (nearest_class(plan%index, class%moments, 0.0_dp) == 0) then
                  call insert_class(plan%index, class%moments, plan%indexed + 1, failed)
               end if
            end if
         end associate
         if (failed) then
            call raise(error, poinsot_e_memory, "no memory for the index of body classes")
            return
         end if
         plan%indexed = plan%indexed + 1
      end do
   end subroutine update_index

   !> Set an option by name: method, splitting, layout, momentum, frame (of torques: body, space),
   !> threads, seed, tolerance, physical (yes, no: of classes added from then on). Options in any
   !> case; blanks at the ends are ignored. POINSOT_E_METHOD for an unknown name or value, with
   !> what there is.
   subroutine set_option(plan, option, text, error)
      type(poinsot_plan), intent(inout) :: plan
      character(*), intent(in) :: option, text
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: key, value
      character(9), parameter :: keys(9) = [character(9) :: "method", "splitting", "layout", &
         "momentum", "frame", "threads", "seed", "tolerance", "physical"]
      integer :: place
      integer(i8) :: number

      if (refused(plan, error)) return
      key = lower(trim(adjustl(option)))
      value = trim(adjustl(text))
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
      case ("tolerance")
         call read_tolerance(value, plan%tolerance, error)
      case ("physical")
         call choose("physical", value, [character(3) :: "yes", "no"], place, error)
         if (.not. raised(error)) plan%physical = place == 1
      case default
         call raise(error, poinsot_e_method, "plan: unknown option '"//printable(key)// &
            "'"//known_names(keys))
      end select
   end subroutine set_option

   !> Index of a name in a list.
   subroutine choose(key, value, names, place, error)
      character(*), intent(in) :: key, value, names(:)
      integer, intent(out) :: place
      type(poinsot_error), intent(inout) :: error
      do place = 1, size(names)
         if (names(place) == value) return
      end do
      call raise(error, poinsot_e_method, "plan: unknown "//key//" '"//printable(value)// &
         "'"//known_names(names))
   end subroutine choose

   subroutine read_tolerance(value, tolerance, error)
      character(*), intent(in) :: value
      real(dp), intent(inout) :: tolerance
      type(poinsot_error), intent(inout) :: error
      real(dp) :: number
      integer :: outcome
      call parse_real(trim(value), number, outcome)
      if (outcome == number_ok .and. number >= least_tolerance .and. number <= most_tolerance) then
         tolerance = number
      else
         call raise(error, poinsot_e_domain, "plan: tolerance = '"//printable(value)// &
            "' is not a number from 1e-15 to 1e-2")
      end if
   end subroutine read_tolerance

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
      call raise(error, poinsot_e_domain, "plan: "//key//" = '"//printable(value) &
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
      if (.not. raised(error)) call add_ready_effect(plan, made, error, settings)
   end subroutine add_effect

   !> Add an effect of a program's own type, or one that was made from settings already.
   !> POINSOT_E_METHOD if it is of no kind that a plan knows: it would do nothing.
   subroutine add_ready_effect(plan, made, error, settings)
      type(poinsot_plan), intent(inout) :: plan
      class(effect), allocatable, intent(inout) :: made   !! moved into the plan
      type(poinsot_error), intent(inout) :: error
      type(setting), intent(in), optional :: settings(:)
      type(effect_item) :: item
      if (refused(plan, error)) return
      if (.not. acts(made)) then
         call raise(error, poinsot_e_method, "an effect of a program's own extends " // &
            "poinsot_user_torque or poinsot_user_potential; this one would do nothing")
         return
      end if
      if (made%name == "") made%name = callback_label%name ! for messages
      call move_alloc(made, item%it)
      if (present(settings)) item%settings = settings
      call grow(plan%effects, 1, error)
      if (.not. raised(error)) call move_item(item, plan%effects(size(plan%effects)))
   end subroutine add_ready_effect

   !> Is an effect of a kind that acts on bodies?
   pure logical function acts(made)
      class(effect), intent(in) :: made
      acts = .true.
      select type (made)
      class is (torque_effect)
      class is (flow_effect)
      class is (pair_effect)
      class is (gyrostat)
      class default
         acts = .false.
      end select
   end function acts

   !> Room for more effects, or, if negative, for fewer.
   subroutine grow(effects, more, error)
      type(effect_item), allocatable, intent(inout) :: effects(:)
      integer, intent(in) :: more
      type(poinsot_error), intent(inout) :: error
      type(effect_item), allocatable :: longer(:)
      integer :: n, i, state
      n = 0
      if (allocated(effects)) n = size(effects)
      allocate (longer(n + more), stat=state)
      if (state /= 0) then
         call raise(error, poinsot_e_memory, "no memory for another effect")
         return
      end if
      do i = 1, min(n, n + more)
         call move_item(effects(i), longer(i))
      end do
      call move_alloc(longer, effects)
   end subroutine grow

   subroutine move_item(from, to)
      type(effect_item), intent(inout) :: from, to
      call move_alloc(from%it, to%it)
      if (allocated(from%settings)) call move_alloc(from%settings, to%settings)
   end subroutine move_item

   !> A ready plan cannot be changed.
   logical function refused(plan, error)
      type(poinsot_plan), intent(in) :: plan
      type(poinsot_error), intent(inout) :: error
      refused = plan%ready
      if (refused) call raise(error, poinsot_e_domain, &
         "plan: it is ready and can no longer be changed")
   end function refused

end module poinsot_ensemble_plan
