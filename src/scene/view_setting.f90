!> What a page has to know of a scene to show its motion rightly: free body, gyrostat, top,
!> satellite, body in a field; and the vectors of its bodies, along their principal axes.
module poinsot_scene_view_setting
   use poinsot_core_kinds, only: dp
   use poinsot_scene_integrals, only: vector_in, number_in, text_in, any_of
   use poinsot_scene_json, only: numbers_json, number_json
   use poinsot_scene_settings, only: scene_settings, effect_setting
   implicit none(type, external)
   private
   public :: view_setting, body_vectors

contains

   !> "kind", "up", and what belongs to the kind, as members of a JSON object. Of several effects of
   !> one kind the first is shown.
   function view_setting(scene) result(text)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(:), allocatable :: text
      character(:), allocatable :: kind
      integer :: i
      kind = "free"
      text = ""
      do i = 1, size(scene%effects)
         associate (item => scene%effects(i))
            select case (item%name)
            case ("gyrostat")
               if (kind == "free") kind = "gyrostat"
               if (any_of(item, "times") .and. kind == "gyrostat") kind = "other"
            case ("gravity")
               if (any_of(item, "rate")) then
                  call add_turning(item, "up", kind, text)
                  cycle
               end if
               kind = "top"
               if (index(text, """up""") == 0) text = text // """up"": " // &
                  numbers_json(vector_in(item, "up"), 9) // ", "
            case ("spring")
               call add_turning(item, "direction", kind, text)
            case ("field")
               if (kind /= "top") kind = "field"
               if (index(text, """field""") > 0) cycle
               text = text // """field"": {""motion"": """ // text_in(item, "motion") // &
                  """, ""strength"": " // numbers_json(vector_in(item, "strength"), 9) // &
                  ", ""frequency"": " // number_json(number_in(item, "frequency"), 9) // &
                  ", ""phase"": " // number_json(number_in(item, "phase"), 9) // &
                  ", ""axis"": " // numbers_json(vector_in(item, "axis"), 9) // "}, "
            case ("gravity_gradient")
               if (kind == "top") cycle
               kind = "other"
               if (text_in(item, "orbit") /= "circular") cycle
               kind = "orbit"
               if (index(text, """frame""") > 0) cycle
               text = text // """frame"": {""axis"": " // &
                  numbers_json(vector_in(item, "normal"), 9) // ", ""rate"": " // &
                  number_json(number_in(item, "rate"), 9) // ", ""phase"": " // &
                  number_json(number_in(item, "anomaly"), 9) // ", ""eccentricity"": " // &
                  number_json(number_in(item, "eccentricity"), 9) // ", ""direction"": " // &
                  numbers_json(vector_in(item, "radial"), 9) // "}, "
            case default
               if (kind == "free" .or. kind == "gyrostat") kind = "other"
            end select
         end associate
      end do
      text = text // """kind"": """ // kind // ""","
   end function view_setting

   !> A direction in space that turns: the motion is seen from the frame that turns with it.
   subroutine add_turning(item, key, kind, text)
      type(effect_setting), intent(in) :: item
      character(*), intent(in) :: key !! of the direction
      character(:), allocatable, intent(inout) :: kind, text
      if (kind /= "top" .and. kind /= "orbit") kind = "other"
      if (kind /= "other" .or. .not. any_of(item, "rate")) return
      kind = "turning"
      if (index(text, """frame""") > 0) return
      text = text // """frame"": {""name"": """ // item%name // """, ""axis"": " // &
         numbers_json(vector_in(item, "about"), 9) // ", ""rate"": " // &
         number_json(number_in(item, "rate"), 9) // ", ""phase"": " // &
         number_json(number_in(item, "phase"), 9) // ", ""eccentricity"": 0, ""direction"": " // &
         numbers_json(vector_in(item, key), 9) // "}, "
   end subroutine add_turning

   !> ", "centre": [...]" and so on: the body vectors of a group.
   function body_vectors(scene, group) result(text)
      type(scene_settings), intent(in) :: scene !! the typed scene
      integer, intent(in) :: group              !! number of a &bodies group
      character(:), allocatable :: text
      real(dp) :: centre(3), rotor(3), dipole(3)
      logical :: heavy
      integer :: i
      heavy = .false.
      centre = 0
      rotor = 0
      dipole = 0
      do i = 1, size(scene%effects)
         associate (item => scene%effects(i))
            heavy = heavy .or. item%name == "gravity"
            if (.not. any(nint(number_in(item, "class")) == [0, group])) cycle
            if (item%name == "gravity") centre = centre + vector_in(item, "centre")
            if (item%name == "gyrostat") rotor = rotor + vector_in(item, "rotor")
            if (item%name == "field" .or. item%name == "dipoles") dipole = dipole + &
               vector_in(item, "dipole")
         end associate
      end do
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

end module poinsot_scene_view_setting
