!> The data that a page needs to show a scene: free body, gyrostat, top, satellite or body in a
!> field; and the vectors of its bodies, along their principal axes.
module poinsot_scene_view_setting
   use poinsot_core_kinds, only: dp
   use poinsot_effect_registry, only: describe_effect, effect_number, shown_key
   use poinsot_effect_settings, only: get_values
   use poinsot_effect_traits, only: effect_traits
   use poinsot_scene_json, only: numbers_json, number_json
   use poinsot_scene_settings, only: scene_settings, traits_of
   implicit none(type, external)
   private
   public :: view_setting, body_vectors

   !> Of several kinds the page shows the last one here.
   character(*), parameter :: kinds(*) = [character(8) :: "free", "gyrostat", "other", "field", &
                                          "turning", "orbit", "top"]

contains

   !> "kind", "up", and what belongs to the kind, as members of a JSON object. Of several effects of
   !> one kind the first is shown; a field is, whatever the kind.
   function view_setting(scene) result(text)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(:), allocatable :: text
      type(effect_traits) :: traits(size(scene%effects))
      integer :: first(size(kinds)), i, k
      first = 0
      do i = 1, size(traits)
         traits(i) = traits_of(scene%effects(i))
         k = findloc(kinds, traits(i)%shown, dim=1)
         if (k == 0) k = findloc(kinds, "other", dim=1)
         if (first(k) == 0) first(k) = i
      end do
      k = max(1, findloc(first > 0, .true., dim=1, back=.true.))
      text = ""
      i = first(findloc(kinds, "field", dim=1))
      if (i > 0) text = field_json(traits(i))
      if (kinds(k) == "top") text = text // """up"": " // &
         numbers_json(traits(first(k))%direction%at, 9) // ", "
      if (kinds(k) == "turning" .or. kinds(k) == "orbit") text = text // &
         frame_json(scene%effects(first(k))%name, traits(first(k)))
      text = text // """kind"": """ // trim(kinds(k)) // ""","
   end function view_setting

   !> A field in space.
   function field_json(traits) result(text)
      type(effect_traits), intent(in) :: traits
      character(:), allocatable :: text
      character(:), allocatable :: motion
      associate (e => traits%direction)
         motion = "static"
         if (abs(e%rate) > 0) motion = "rotating"
         if (traits%swings) motion = "oscillating"
         text = """field"": {""motion"": """ // motion // """, ""strength"": " // &
            numbers_json(e%at, 9) // ", ""frequency"": " // number_json(e%rate, 9) // &
            ", ""phase"": " // number_json(e%phase, 9) // ", ""axis"": " // &
            numbers_json(e%axis, 9) // "}, "
      end associate
   end function field_json

   !> A direction in space that turns: the motion is seen from the frame that turns with it.
   function frame_json(name, traits) result(text)
      character(*), intent(in) :: name !! of the effect
      type(effect_traits), intent(in) :: traits
      character(:), allocatable :: text
      character(:), allocatable :: label
      label = name
      if (shown_key(name, "centre") /= "") label = "up"
      associate (e => traits%direction)
         text = """frame"": {""name"": """ // name // """, ""label"": """ // label // &
            """, ""axis"": " // numbers_json(e%axis, 9) // ", ""rate"": " // &
            number_json(e%rate, 9) // ", ""phase"": " // number_json(e%phase, 9) // &
            ", ""eccentricity"": " // number_json(traits%eccentricity, 9) // &
            ", ""direction"": " // numbers_json(e%at, 9) // "}, "
      end associate
   end function frame_json

   !> ", "centre": [...]" and so on: the body vectors of a group.
   function body_vectors(scene, group) result(text)
      type(scene_settings), intent(in) :: scene !! the typed scene
      integer, intent(in) :: group              !! number of a &bodies group
      character(:), allocatable :: text
      real(dp), dimension(3) :: centre, rotor, dipole
      logical :: heavy
      integer :: i
      heavy = .false.
      do i = 1, size(scene%effects)
         heavy = heavy .or. shown_key(scene%effects(i)%name, "centre") /= ""
      end do
      centre = shown_vector(scene, group, "centre")
      rotor = shown_vector(scene, group, "rotor")
      dipole = shown_vector(scene, group, "dipole")
      text = ", ""axis"": " // along_axes(scene%output%axis)
      if (norm2(dipole) > 0) text = ", ""axis"": " // along_axes(dipole) // &
         ", ""dipole"": " // along_axes(dipole)
      if (heavy) text = text // ", ""centre"": " // along_axes(centre)
      if (norm2(rotor) > 0) text = text // ", ""rotor"": " // along_axes(rotor)
      associate (bodies => scene%bodies(group))
         if (bodies%drawn /= "natural") then
            text = text // ", ""shape"": """ // bodies%drawn // """"
         else if (allocated(bodies%shape)) then
            text = text // ", ""shape"": """ // bodies%shape // """, ""size"": " // &
               numbers_json(bodies%lengths, 9)
         end if
      end associate

   contains

      function along_axes(v) result(numbers)
         real(dp), intent(in) :: v(3)
         character(:), allocatable :: numbers
         numbers = numbers_json(v, 9)
         if (scene%bodies(group)%turned) numbers = &
            numbers_json(matmul(v, scene%bodies(group)%axes), 9)
      end function along_axes

   end function body_vectors

   !> The sum of what the effects that act on a group show as this.
   function shown_vector(scene, group, what) result(vector)
      type(scene_settings), intent(in) :: scene
      integer, intent(in) :: group
      character(*), intent(in) :: what
      real(dp) :: vector(3)
      real(dp), allocatable :: values(:)
      character(:), allocatable :: key
      integer :: i
      vector = 0
      do i = 1, size(scene%effects)
         associate (item => scene%effects(i))
            key = shown_key(item%name, what)
            if (key == "" .or. .not. item%made%acts_on(group)) cycle
            call get_values(describe_effect(effect_number(item%name)), item%settings, key, values)
            if (size(values) >= 3*group) then ! one for each class
               vector = vector + values(3*group - 2:3*group)
            else if (size(values) >= 3) then
               vector = vector + values(:3)
            end if
         end associate
      end do
   end function shown_vector

end module poinsot_scene_view_setting
