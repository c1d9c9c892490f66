!> The principal moments of a &bodies group, from moments, a tensor, point masses or a shape.
module poinsot_scene_inertia
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_rotation_conversions, only: from_matrix
   use poinsot_body_moments, only: accept_moments
   use poinsot_body_inertia, only: principal_axes, is_diagonal, point_mass_tensor
   use poinsot_body_shapes, only: shape_moments, shape_names, shape_sizes
   use poinsot_core_nearest, only: suggestion
   use poinsot_scene_table, only: read_table, file_beside
   use poinsot_scene_text, only: quoted
   use poinsot_scene_settings, only: body_group
   use poinsot_scene_typed_group, only: typed_group, given, flag_of, number_of, numbers_of, &
      word_of, reject_key, relabel
   implicit none(type, external)
   private
   public :: find_moments

contains

   !> Exactly one of moments, tensor, points and shape. Error: POINSOT_E_SCENE naming file, line
   !> and key.
   subroutine find_moments(group, bodies, error)
      type(typed_group), intent(in) :: group    !! keys with their values
      type(body_group), intent(inout) :: bodies !! gets moments, axes, frame, turned
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: values(:)
      bodies%physical = flag_of(group, "physical")
      select case (count([given(group, "moments"), given(group, "tensor"), &
                          given(group, "points"), given(group, "shape")]))
      case (0)
         call reject_key(group, "moments", "are missing (or a tensor, points, or a shape)", error)
         return
      case (2:)
         call reject_key(group, "moments", "tensor, points and shape: give one of them only", error)
         return
      case default
         continue
      end select
      if (.not. given(group, "shape") .and. (given(group, "mass") .or. given(group, "size"))) then
         call reject_key(group, "shape", "is missing, but mass or size is given", error)
      else if (given(group, "tensor")) then
         call from_tensor(group, bodies, error)
      else if (given(group, "points")) then
         call from_points(group, bodies, error)
      else if (given(group, "shape")) then
         call from_shape(group, bodies, error)
      else
         call numbers_of(group, "moments", values)
         bodies%moments = values
         call accept_moments(bodies%moments, error, bodies%physical)
         call relabel(group, "moments", error)
      end if
   end subroutine find_moments

   !> A full tensor; the scene's frame is then the tensor's, the library's the principal one.
   !> Entries
   !> of a diagonal tensor are moments.
   subroutine from_tensor(group, bodies, error)
      type(typed_group), intent(in) :: group
      type(body_group), intent(inout) :: bodies
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: values(:)
      call numbers_of(group, "tensor", values)
      call take_tensor(transpose(reshape(values, [3, 3])), bodies, error)
      call relabel(group, "tensor", error)
   end subroutine from_tensor

   !> Moments, and axes unless the tensor is diagonal.
   subroutine take_tensor(tensor, bodies, error)
      real(dp), intent(in) :: tensor(3, 3)
      type(body_group), intent(inout) :: bodies
      type(poinsot_error), intent(inout) :: error
      if (is_diagonal(tensor)) then
         bodies%moments = [tensor(1, 1), tensor(2, 2), tensor(3, 3)]
         call accept_moments(bodies%moments, error, bodies%physical)
         return
      end if
      call principal_axes(tensor, bodies%moments, bodies%axes, error, bodies%physical)
      if (raised(error)) return
      bodies%turned = .true.
      bodies%frame = from_matrix(bodies%axes)
   end subroutine take_tensor

   !> Point masses of a file, about their centre of mass; the scene's frame is that of their
   !> coordinates, moved there.
   subroutine from_points(group, bodies, error)
      type(typed_group), intent(in) :: group
      type(body_group), intent(inout) :: bodies
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: mass(:), values(:)
      real(dp) :: tensor(3, 3)
      character(:), allocatable :: name
      name = word_of(group, "points")
      if (len(name) == 0) then
         call reject_key(group, "points", "is empty; name a file with lines of mass, x, y, z", &
            error)
         return
      end if
      bodies%points = file_beside(group%file, name)
      call read_table(bodies%points, 3, mass, values, error, "a mass and its x, y, z")
      if (.not. raised(error)) then
         call point_mass_tensor(mass, reshape(values, [3, size(mass)]), tensor, error)
      end if
      if (.not. raised(error)) call take_tensor(tensor, bodies, error)
      call relabel(group, "points", error)
   end subroutine from_points

   !> A named shape.
   subroutine from_shape(group, bodies, error)
      type(typed_group), intent(in) :: group
      type(body_group), intent(inout) :: bodies
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: values(:)
      real(dp) :: lengths(3), mass
      character(:), allocatable :: name
      name = word_of(group, "shape")
      if (shape_sizes(name) < 0) then
         call reject_key(group, "shape", &
                       "= " // quoted(name) // ": unknown shape" // &
                       suggestion(name, shape_names(), """", """"), error)
         return
      end if
      call numbers_of(group, "size", values)
      lengths = 0
      lengths(:size(values)) = values
      mass = number_of(group, "mass")
      if (shape_sizes(name) == 0 .and. .not. given(group, "mass")) mass = 0
      call shape_moments(name, mass, lengths, bodies%moments, error)
      bodies%shape = name
      bodies%lengths = lengths
      call relabel(group, "shape", error)
   end subroutine from_shape

end module poinsot_scene_inertia
