!> The integrals of motion of a scene: those that its effects and bodies conserve.
module poinsot_scene_integrals
   use poinsot_core_kinds, only: dp
   use poinsot_effect_effect, only: pair_effect
   use poinsot_effect_traits, only: effect_traits
   use poinsot_scene_settings, only: scene_settings, body_total, traits_of
   implicit none(type, external)
   private
   public :: integral_list, scene_integrals

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
      type(effect_traits) :: traits(size(scene%effects))
      logical :: free, works, turns, coupled, all_written
      integer :: i
      works = .false.
      turns = .false.
      coupled = .false.
      do i = 1, size(scene%effects)
         traits(i) = traits_of(scene%effects(i))
         call add_motion(traits(i), list%spin, turns, works)
         select type (one => scene%effects(i)%made)
         class is (pair_effect)
            coupled = .true.
         end select
      end do
      free = all(traits%internal)
      all_written = size(scene%output%bodies) == 0 .or. &
                    size(scene%output%bodies) == int(body_total(scene))
      if (turns) works = works .or. .not. symmetric_about(traits, list%spin)
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
         if (symmetric_about(traits, z)) list%words = list%words // "vertical "
         call add_top(scene, traits, list)
      end if
      list%words = list%words // "norm"
   end subroutine scene_integrals

   !> What an effect leaves of the energy: all, that in a frame it turns with, or nothing.
   pure subroutine add_motion(traits, spin, turns, works)
      type(effect_traits), intent(in) :: traits
      real(dp), intent(inout) :: spin(3)
      logical, intent(inout) :: turns, works
      real(dp) :: axis(3)
      works = works .or. .not. traits%energy
      if (.not. turns_itself(traits)) return
      axis = traits%direction%rate*traits%direction%axis
      if (turns .and. norm2(axis - spin) > same*norm2(axis)) works = .true.
      turns = .true.
      spin = axis
   end subroutine add_motion

   pure logical function turns_itself(traits)
      type(effect_traits), intent(in) :: traits
      turns_itself = abs(traits%direction%rate) > 0 .and. .not. traits%swings
   end function turns_itself

   !> Do all effects look the same after a turn about this direction (or turn about it themselves)?
   pure logical function symmetric_about(traits, direction)
      type(effect_traits), intent(in) :: traits(:)
      real(dp), intent(in) :: direction(3)
      integer :: i
      symmetric_about = .true.
      do i = 1, size(traits)
         associate (e => traits(i)%direction)
            if (traits(i)%internal .or. turns_itself(traits(i))) cycle
            if (.not. traits(i)%one_direction .or. .not. along(e%at, direction) .or. &
                (abs(e%phase) > 0 .and. .not. traits(i)%swings)) symmetric_about = .false.
         end associate
      end do
   end function symmetric_about

   !> The third integral of Lagrange's and of Kovalevskaya's top: one kind of body that nothing
   !> but a steady pull along z acts on.
   pure subroutine add_top(scene, traits, list)
      type(scene_settings), intent(in) :: scene
      type(effect_traits), intent(in) :: traits(:)
      type(integral_list), intent(inout) :: list
      integer :: k, a, b
      if (size(traits) /= 1 .or. size(scene%bodies) /= 1) return
      if (scene%bodies(1)%turned .or. maxval(abs(traits(1)%arm)) <= 0) return
      associate (moments => scene%bodies(1)%moments, arm => traits(1)%arm, &
         up => traits(1)%direction%at)
         if (.not. along(up, z)) return
         do k = 1, 3
            a = 1 + mod(k, 3)
            b = 1 + mod(k + 1, 3)
            if (abs(moments(a) - moments(b)) > same*moments(a)) cycle
            list%symmetry = 0
            list%symmetry(k) = 1
            if (along(arm, list%symmetry)) then
               list%words = list%words // "symmetry "
               return
            end if
            if (.not. moments(k) > 0 .or. abs(moments(a) - 2*moments(k)) > same*moments(a)) cycle
            if (abs(arm(k)) > same*maxval(abs(arm))) cycle
            list%equal = [a, b]
            list%first = [arm(a), arm(b)]/norm2(arm)
            list%pull = sign(norm2(arm), up(3))/moments(k)
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

end module poinsot_scene_integrals
