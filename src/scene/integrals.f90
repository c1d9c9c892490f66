!> What a scene keeps constant: the integrals of motion that its effects and bodies leave.
module poinsot_scene_integrals
   use poinsot_core_kinds, only: dp
   use poinsot_effect_formula_node, only: op_time
   use poinsot_effect_potential, only: potential
   use poinsot_effect_registry, only: describe_effect, effect_number
   use poinsot_effect_settings, only: get_values, get_value, get_text
   use poinsot_scene_settings, only: scene_settings, effect_setting, body_total
   implicit none(type, external)
   private
   public :: integral_list, scene_integrals
   public :: vector_in, number_in, text_in, any_of

   real(dp), parameter :: same = 1e-12_dp    !! relative: equal numbers of a scene
   real(dp), parameter :: z(3) = [0.0_dp, 0.0_dp, 1.0_dp]

   !> The integrals, by the words that pictures know: energy (or `work`: it need not stay), rotating
   !> (T + U - W.L), length (|y|), momentum (Q y), vertical (its component along z), symmetry (y
   !> along the axis of a symmetric top), kovalevskaya, norm (|q|).
   type :: integral_list
      character(:), allocatable :: words       !! blanks between them
      real(dp) :: spin(3) = 0                  !! W of `rotating`
      real(dp) :: symmetry(3) = 0              !! the axis of `symmetry`
      integer :: equal(2) = [1, 2]             !! kovalevskaya: the axes of equal moments,
      real(dp) :: first(2) = [1, 0]            !! the centre's direction in their plane,
      real(dp) :: pull = 0                     !! weight |centre|/I of the third, upwards along z
   end type integral_list

contains

   !> All that the scene has, `norm` last.
   subroutine scene_integrals(scene, list)
      type(scene_settings), intent(in) :: scene !! the typed scene
      type(integral_list), intent(out) :: list
      logical :: free, works, turns, coupled, all_written
      integer :: i
      free = .true.
      works = .false.
      turns = .false.
      coupled = .false.
      do i = 1, size(scene%effects)
         if (scene%effects(i)%name /= "gyrostat") free = .false.
         if (scene%effects(i)%name == "dipoles") coupled = .true.
         call add_motion(scene%effects(i), list%spin, turns, works)
      end do
      all_written = size(scene%output%bodies) == 0 .or. &
                    size(scene%output%bodies) == int(body_total(scene))
      if (turns) works = works .or. .not. symmetric_about(scene, list%spin)
      list%words = ""
      if (works) then
         list%words = "work "
      else if (turns) then
         list%words = "rotating "
      else if (all_written .or. .not. coupled) then
         list%words = "energy "
      end if
      if (free) list%words = list%words // "length momentum "
      if (.not. free .and. .not. turns .and. .not. works) then
         if (symmetric_about(scene, z)) list%words = list%words // "vertical "
         call add_top(scene, list)
      end if
      list%words = list%words // "norm"
   end subroutine scene_integrals

   !> What an effect does in time: a frame it turns with, or work that no frame takes away.
   subroutine add_motion(item, spin, turns, works)
      type(effect_setting), intent(in) :: item
      real(dp), intent(inout) :: spin(3)
      logical, intent(inout) :: turns, works
      real(dp), allocatable :: axis(:)
      real(dp) :: rate
      if (any_of(item, "times")) works = .true.
      select case (item%name)
      case ("dipoles", "gyrostat")
         return
      case ("gravity", "spring")
         if (.not. any_of(item, "rate")) return
         axis = vector_in(item, "about")
         rate = number_in(item, "rate")
      case ("potential")
         works = works .or. depends_on_time(item)
         return
      case ("field")
         if (text_in(item, "motion") == "oscillating") works = .true.
         if (text_in(item, "motion") /= "rotating") return
         axis = vector_in(item, "axis")
         rate = number_in(item, "frequency")
      case ("gravity_gradient")
         if (any_of(item, "eccentricity")) works = .true.
         if (text_in(item, "orbit") /= "circular") return
         axis = vector_in(item, "normal")
         rate = number_in(item, "rate")
      case default ! friction, noise, torques of any kind, and whatever is not known here
         works = .true.
         return
      end select
      axis = rate*axis
      if (turns .and. norm2(axis - spin) > same*norm2(axis)) works = .true.
      turns = .true.
      spin = axis
   end subroutine add_motion

   !> Are there numbers of this key, other than zero?
   pure logical function any_of(item, key)
      type(effect_setting), intent(in) :: item
      character(*), intent(in) :: key
      integer :: i
      any_of = .false.
      do i = 1, size(item%settings)
         if (item%settings(i)%key /= key .or. .not. allocated(item%settings(i)%values)) cycle
         any_of = any(abs(item%settings(i)%values) > 0)
      end do
   end function any_of

   !> Do all effects look the same after a turn about this direction (or turn about it themselves)?
   logical function symmetric_about(scene, direction)
      type(scene_settings), intent(in) :: scene
      real(dp), intent(in) :: direction(3)
      integer :: i
      symmetric_about = .true.
      do i = 1, size(scene%effects)
         associate (item => scene%effects(i))
            select case (item%name)
            case ("gravity")
               symmetric_about = stands_along(item, "up", direction)
            case ("spring")
               symmetric_about = stands_along(item, "direction", direction)
            case ("field")
               if (text_in(item, "motion") /= "rotating") then
                  symmetric_about = along(vector_in(item, "strength"), direction)
               end if
            case ("gravity_gradient")
               if (text_in(item, "orbit") /= "circular") then
                  symmetric_about = along(vector_in(item, "radial"), direction)
               end if
            case ("gyrostat")
               continue ! in the body
            case ("potential")
               symmetric_about = along(direction, z) .and. reads_third_row(item)
            case default
               symmetric_about = .false.
            end select
         end associate
         if (.not. symmetric_about) return
      end do
   end function symmetric_about

   !> Does a direction that may turn look the same after a turn about another (or turn about it
   !> itself)?
   logical function stands_along(item, key, direction)
      type(effect_setting), intent(in) :: item
      character(*), intent(in) :: key
      real(dp), intent(in) :: direction(3)
      stands_along = any_of(item, "rate") .or. (along(vector_in(item, key), direction) .and. &
         .not. any_of(item, "phase"))
   end function stands_along

   !> Does a formula know the time? Yes, if the effect is not made.
   logical function depends_on_time(item)
      type(effect_setting), intent(in) :: item
      depends_on_time = .true.
      if (.not. allocated(item%made)) return
      select type (one => item%made)
      class is (potential)
         depends_on_time = any(one%u%op(:one%u%n) == op_time)
      end select
   end function depends_on_time

   !> Does a formula read nothing of Q but its third row, which a turn about z leaves?
   logical function reads_third_row(item)
      type(effect_setting), intent(in) :: item
      reads_third_row = .false.
      if (.not. allocated(item%made)) return
      select type (one => item%made)
      class is (potential)
         reads_third_row = .not. any(one%rows(:2))
      end select
   end function reads_third_row

   !> The third integral of Lagrange's and of Kovalevskaya's top: one kind of body, under gravity
   !> along z alone.
   subroutine add_top(scene, list)
      type(scene_settings), intent(in) :: scene
      type(integral_list), intent(inout) :: list
      real(dp), allocatable :: centre(:), up(:)
      integer :: k, a, b
      if (size(scene%effects) /= 1 .or. size(scene%bodies) /= 1) return
      if (scene%effects(1)%name /= "gravity" .or. scene%bodies(1)%turned) return
      centre = vector_in(scene%effects(1), "centre")
      up = vector_in(scene%effects(1), "up")
      if (any_of(scene%effects(1), "phase")) return
      if (.not. along(up, z) .or. maxval(abs(centre)) <= 0) return
      associate (moments => scene%bodies(1)%moments)
         do k = 1, 3
            a = 1 + mod(k, 3)
            b = 1 + mod(k + 1, 3)
            if (abs(moments(a) - moments(b)) > same*moments(a)) cycle
            list%symmetry = 0
            list%symmetry(k) = 1
            if (along(centre, list%symmetry)) then
               list%words = list%words // "symmetry "
               return
            end if
            if (.not. moments(k) > 0 .or. abs(moments(a) - 2*moments(k)) > same*moments(a)) cycle
            if (abs(centre(k)) > same*maxval(abs(centre))) cycle
            list%equal = [a, b]
            list%first = [centre(a), centre(b)]/norm2(centre)
            list%pull = sign(number_in(scene%effects(1), "weight"), &
                             up(3)*number_in(scene%effects(1), "weight"))*norm2(centre)/moments(k)
            list%words = list%words // "kovalevskaya "
            return
         end do
      end associate
   end subroutine add_top

   !> Parallel, or one of them zero.
   pure logical function along(v, w)
      real(dp), intent(in) :: v(3), w(3)
      along = abs(abs(dot_product(v, w)) - norm2(v)*norm2(w)) <= same*norm2(v)*norm2(w)
   end function along

   !> A key's three numbers, its default if the scene does not say, zeros without one; a direction
   !> has length 1.
   function vector_in(item, key) result(vector)
      type(effect_setting), intent(in) :: item
      character(*), intent(in) :: key
      real(dp) :: vector(3)
      real(dp), allocatable :: values(:)
      call get_values(describe_effect(effect_number(item%name)), item%settings, key, values)
      vector = 0
      if (size(values) >= 3) vector = values(:3)
      if (any(key == [character(8) :: "axis", "normal", "up", "about"])) vector = &
         vector/norm2(vector)
   end function vector_in

   real(dp) function number_in(item, key)
      type(effect_setting), intent(in) :: item
      character(*), intent(in) :: key
      number_in = get_value(describe_effect(effect_number(item%name)), item%settings, key)
   end function number_in

   function text_in(item, key) result(text)
      type(effect_setting), intent(in) :: item
      character(*), intent(in) :: key
      character(:), allocatable :: text
      text = get_text(describe_effect(effect_number(item%name)), item%settings, key)
   end function text_in

end module poinsot_scene_integrals
