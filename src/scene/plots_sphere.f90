!> Curves on a sphere, for the plot scripts: where the eye is, projection and hidden parts, wires,
!> and the curve itself.
module poinsot_scene_plots_sphere
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error
   use poinsot_scene_text, only: text_of
   use poinsot_scene_files, only: out_file, put
   use poinsot_scene_plots_common, only: put_lines, dark, pale
   implicit none(type, external)
   private
   public :: find_eye, put_sphere, put_wires, put_trace

contains

   !> Where to look from, in degrees, to see what happens about a direction from the side.
   pure subroutine find_eye(v, azimuth, height)
      real(dp), intent(in) :: v(3)              !! the direction, any length
      integer, intent(out) :: azimuth, height
      real(dp) :: u(3)
      azimuth = 35
      height = 22
      if (maxval(abs(v)) <= 0) return
      u = v/maxval(abs(v))
      u = u/norm2(u)
      height = nint(sign(18 + 28*abs(u(3)), u(3)))
      if (abs(u(3)) < 0.99_dp) azimuth = nint(atan2(u(2), u(1))*45/atan(1.0_dp)) + 25
   end subroutine find_eye

   !> The unit sphere seen from (azimuth, height) in degrees: projection, depth, and a wire frame
   !> `wires` to begin a plot with.
   subroutine put_sphere(file, azimuth, height, error)
      type(out_file), intent(in) :: file        !! open
      integer, intent(in) :: azimuth, height    !! where the eye is
      type(poinsot_error), intent(inout) :: error
      call put(file, "az = " // text_of(azimuth) // "*pi/180; el = " // text_of(height) // &
               "*pi/180   # where the eye is", error)
      call put_lines(file, [character(100) :: &
         "px(x,y,z) = -sin(az)*x + cos(az)*y", &
         "py(x,y,z) = -cos(az)*sin(el)*x - sin(az)*sin(el)*y + cos(el)*z", &
         "depth(x,y,z) = cos(az)*cos(el)*x + sin(az)*cos(el)*y + sin(el)*z", &
         "near(x,y,z) = depth(x,y,z) >= 0 ? px(x,y,z) : NaN", &
         "far(x,y,z) = depth(x,y,z) < 0 ? px(x,y,z) : NaN", &
         "set size ratio -1; unset border; unset tics; unset key", &
         "set xrange [-1.18:1.18]; set yrange [-1.18:1.18]; set samples 361"], error)
      call put(file, "wire(side) = side == 0 ? '#efefef' : '#d9d9d9'", error)
   end subroutine put_sphere

   !> The sphere's wires, to begin a plot with: meridians and parallels every 30 degrees, the far
   !> side first, and its outline.
   subroutine put_wires(file, error)
      type(out_file), intent(in) :: file !! open
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: along = "(cos($1)*cos(k*pi/6),cos($1)*sin(k*pi/6),sin($1))"
      character(*), parameter :: round = "(cos($1)*cos(k*pi/6),sin($1)*cos(k*pi/6),sin(k*pi/6))"
      character(*), parameter :: far = ") with lines lc rgb wire(0), \"
      character(*), parameter :: near = ") with lines lc rgb wire(1), \"
      call put_lines(file, [character(100) :: &
         "plot for [k=0:5] [s=0:2*pi] '+' using (far" // along // "): \", &
         "   (py" // along // far, &
         "   for [k=-2:2] [s=0:2*pi] '+' using (far" // round // "): \", &
         "   (py" // round // far, &
         "   for [k=0:5] [s=0:2*pi] '+' using (near" // along // "): \", &
         "   (py" // along // near, &
         "   for [k=-2:2] [s=0:2*pi] '+' using (near" // round // "): \", &
         "   (py" // round // near, &
         "   [s=0:2*pi] '+' using (cos($1)):(sin($1)) with lines lc rgb '#9a9a9a' lw 1, \"], error)
   end subroutine put_wires

   !> The curve of a unit vector, thinner on the far side, and a point at its end: the last elements
   !> of a plot.
   subroutine put_trace(file, vector, far, near, point, error)
      type(out_file), intent(in) :: file        !! open
      character(*), intent(in) :: vector        !! "(x,y,z)", of the columns of a row
      character(*), intent(in) :: far, near     !! line widths
      character(*), intent(in) :: point         !! size of the point
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: rows = "   file skip 1 every bodies::body"
      call put(file, rows // " using (far" // vector // "):(py" // vector // &
               ") with lines lc rgb '" // pale // "' lw " // far // ", \", error)
      call put(file, rows // " using (near" // vector // "):(py" // vector // &
               ") with lines lc rgb '" // dark // "' lw " // near // ", \", error)
      call put(file, rows // "::body using (px" // vector // "):(py" // vector // &
               ") with points pt 7 ps " // point // " lc rgb '" // dark // "'", error)
   end subroutine put_trace

end module poinsot_scene_plots_sphere
