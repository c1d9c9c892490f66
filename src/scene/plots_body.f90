!> Pictures of one free body: its axes in space (the review's figure 1), its momentum on the sphere
!> with the contours of energy, and what should stay constant.
module poinsot_scene_plots_body
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_text, only: text_of
   use poinsot_rotation_quaternion, only: rotate
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_settings, only: scene_settings, body_group
   use poinsot_scene_plots_common, only: put_lines, put_start, put_end, put_columns, put_sphere, &
      first_group, dark, pale, grey, faint
   implicit none(type, external)
   private


   public :: write_attitude, write_momentum, write_drift, put_wires

   integer, parameter :: strip_length = 60 !! of the name and the expression of a strip

contains

   !> The sphere's wires: meridians and parallels every 30 degrees, and its outline.
   subroutine put_wires(file, error)
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      call put_lines(file, [character(100) :: &
         "plot for [k=0:5] [s=0:2*pi] '+' using " // &
         "(far(cos($1)*cos(k*pi/6),cos($1)*sin(k*pi/6),sin($1))): \", &
         "   (py(cos($1)*cos(k*pi/6),cos($1)*sin(k*pi/6),sin($1))) with lines lc rgb wire(0), \", &
         "   for [k=-2:2] [s=0:2*pi] '+' using " // &
         "(far(cos($1)*cos(k*pi/6),sin($1)*cos(k*pi/6),sin(k*pi/6))): \", &
         "   (py(cos($1)*cos(k*pi/6),sin($1)*cos(k*pi/6),sin(k*pi/6))) " // &
         "with lines lc rgb wire(0), \", &
         "   for [k=0:5] [s=0:2*pi] '+' using " // &
         "(near(cos($1)*cos(k*pi/6),cos($1)*sin(k*pi/6),sin($1))): \", &
         "   (py(cos($1)*cos(k*pi/6),cos($1)*sin(k*pi/6),sin($1))) with lines lc rgb wire(1), \", &
         "   for [k=-2:2] [s=0:2*pi] '+' using " // &
         "(near(cos($1)*cos(k*pi/6),sin($1)*cos(k*pi/6),sin(k*pi/6))): \", &
         "   (py(cos($1)*cos(k*pi/6),sin($1)*cos(k*pi/6),sin(k*pi/6))) " // &
         "with lines lc rgb wire(1), \", &
         "   [s=0:2*pi] '+' using (cos($1)):(sin($1)) with lines lc rgb '#9a9a9a' lw 1, \"], error)
   end subroutine put_wires

   !> The review's figure 1: where each body axis points in space, a sphere for each.
   subroutine write_attitude(scene, path, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: path
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(:), allocatable :: j, vector, row
      integer :: axis, azimuth, height
      call open_out(path, file, error)
      if (raised(error)) return
      call put_start(scene, file, "attitude", 960, 370, error)
      call put_columns(file, error)
      call find_eye(momentum_pole(scene), azimuth, height)
      azimuth = azimuth + 30 ! more from the side: two of the three axes run around the momentum
      height = 16
      call put_sphere(file, azimuth, height, error)
      call put_pole(momentum_pole(scene), file, error)
      call put(file, "set yrange [-1.4:1.45]; set xrange [-1.15:1.15]", error)
      call put(file, "set multiplot layout 1,3 margins 0.005,0.995,0.005,0.995 spacing 0.01,0", &
         error)
      row = " skip 1 every bodies::body "
      do axis = 1, 3
         j = text_of(axis)
         vector = "(q1" // j // "($3,$4,$5,$6),q2" // j // "($3,$4,$5,$6),q3" // j // &
            "($3,$4,$5,$6))"
         call put(file, "set label 2 '" // axis_title(scene, axis) // "' at 0,-1.25 center", error)
         call put_wires(file, error)
         call put(file, "   file" // row // "using (far" // vector // "):(py" // vector // &
                  ") with lines lc rgb '" // pale // "' lw 1.2, \", error)
         call put(file, "   file" // row // "using (near" // vector // "):(py" // vector // &
                  ") with lines lc rgb '" // dark // "' lw 1.8, \", error)
         call put(file, "   file skip 1 every bodies::body::body using (px" // vector // &
            "):(py" // &
                  vector // ") with points pt 7 ps 0.9 lc rgb '" // dark // "'", error)
      end do
      call put(file, "unset multiplot", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_attitude

   !> The fixed direction of the momentum: a pin in the sphere, and its name.
   subroutine put_pole(pole, file, error)
      real(dp), intent(in) :: pole(3)
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      real(dp) :: u(3)
      if (maxval(abs(pole)) <= 0) return
      u = pole/norm2(pole)
      call put(file, "lx = " // text_of(u(1)) // "; ly = " // text_of(u(2)) // "; lz = " // &
               text_of(u(3)) // "   # direction of the momentum in space, or against it", error)
      call put_lines(file, [character(120) :: &
         "set arrow 1 from px(lx,ly,lz),py(lx,ly,lz) to 1.2*px(lx,ly,lz),1.2*py(lx,ly,lz) " // &
         "nohead lw 2 lc rgb '#555555' front", &
         "set label 1 'Qy' at 1.36*px(lx,ly,lz),1.36*py(lx,ly,lz) center tc rgb '#555555' front"], &
         error)
   end subroutine put_pole

   !> "body axis 1,  I_1 = 0.376"
   function axis_title(scene, axis) result(text)
      type(scene_settings), intent(in) :: scene
      integer, intent(in) :: axis
      character(:), allocatable :: text
      text = "body axis " // text_of(axis)
      if (scene%bodies(first_group(scene))%turned) return
      text = text // ",  I_" // text_of(axis) // " = " // &
         text_of(scene%bodies(first_group(scene))%moments(axis))
   end function axis_title

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

   !> Between the momentum at the start and the axis that it runs around: what the picture of the
   !> momentum is seen along.
   pure function polhode_middle(bodies) result(middle)
      type(body_group), intent(in) :: bodies
      real(dp) :: middle(3), u(3), a(3)
      integer :: order(3), pole
      middle = 0
      if (maxval(abs(bodies%y)) <= 0) return
      u = bodies%y/maxval(abs(bodies%y))
      u = u/norm2(u)
      middle = u
      if (.not. has_contours(bodies)) return
      call sorted_inverse(bodies%moments, a, order)
      pole = order(1)
      if ((a(1) - a(2))*u(order(1))**2 < (a(2) - a(3))*u(order(3))**2) pole = order(3)
      middle(pole) = middle(pole) + sign(1.2_dp, u(pole))
   end function polhode_middle

   !> Momentum in space at the start, of the first body written, its vertical part upwards: what the
   !> picture of the axes is seen along.
   pure function momentum_pole(scene) result(pole)
      type(scene_settings), intent(in) :: scene
      real(dp) :: pole(3), unit
      associate (bodies => scene%bodies(first_group(scene)))
         unit = maxval(abs(bodies%y))
         pole = 0
         if (unit > 0) pole = rotate(bodies%q, bodies%y/unit)
      end associate
      if (pole(3) < 0) pole = -pole
   end function momentum_pole

   !> Momentum in the body frame on its sphere, with the contours of energy: polhodes.
   subroutine write_momentum(scene, path, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: path
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(:), allocatable :: vector
      integer :: azimuth, height
      call open_out(path, file, error)
      if (raised(error)) return
      call put_start(scene, file, "momentum", 520, 520, error)
      call find_eye(polhode_middle(scene%bodies(first_group(scene))), azimuth, height)
      call put_sphere(file, azimuth, height, error)
      call put_principal(scene, file, vector, error)
      call put_contours(scene%bodies(first_group(scene)), file, error)
      call put_axis_labels(file, error)
      call put(file, "set margins 0.2,0.2,0.2,0.2", error)
      if (has_contours(scene%bodies(first_group(scene)))) then
         call put(file, &
            "plot for [k=1:1] [s=0:2*pi] '+' using (cos($1)):(sin($1)) with lines lc rgb " // &
                  "'#9a9a9a' lw 1, \", error)
         call put_contour_plots(file, error)
      else
         call put_wires(file, error)
      end if
      call put(file, "   file skip 1 every bodies::body using (far" // vector // "):(py" // &
         vector // &
               ") with lines lc rgb '" // pale // "' lw 3, \", error)
      call put(file, "   file skip 1 every bodies::body using (near" // vector // "):(py" // &
         vector // &
               ") with lines lc rgb '" // dark // "' lw 3.5, \", error)
      call put(file, "   file skip 1 every bodies::body::body using (px" // vector // "):(py" // &
               vector // ") with points pt 7 ps 1.1 lc rgb '" // dark // "'", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_momentum

   !> Unit momentum in the principal frame as functions u1, u2, u3 of columns 7 to 9.
   subroutine put_principal(scene, file, vector, error)
      type(scene_settings), intent(in) :: scene
      type(out_file), intent(in) :: file
      character(:), allocatable, intent(out) :: vector !! "(u1($7,$8,$9), ...)"
      type(poinsot_error), intent(inout) :: error
      real(dp) :: axes(3, 3)
      integer :: j
      axes = 0
      do j = 1, 3
         axes(j, j) = 1
      end do
      if (scene%bodies(first_group(scene))%turned) axes = scene%bodies(first_group(scene))%axes
      call put(file, "length(a,b,c) = a == 0 && b == 0 && c == 0 ? NaN : sqrt(a*a + b*b + c*c)", &
         error)
      do j = 1, 3
         call put(file, "u" // text_of(j) // "(a,b,c) = (a*(" // text_of(axes(1, j)) // &
            ") + b*(" // &
                  text_of(axes(2, j)) // ") + c*(" // text_of(axes(3, j)) // "))/length(a,b,c)", &
                     error)
      end do
      vector = "(u1($7,$8,$9),u2($7,$8,$9),u3($7,$8,$9))"
   end subroutine put_principal

   !> Contours of H = sum a_j u_j^2 on the sphere, a sorted so that a1 > a2 > a3: closed curves
   !> about the axis of the smallest moment, about that of the largest, and the separatrix between
   !> them.
   subroutine put_contours(bodies, file, error)
      type(body_group), intent(in) :: bodies
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      integer :: order(3)
      real(dp) :: a(3)
      if (.not. has_contours(bodies)) return
      call sorted_inverse(bodies%moments, a, order)
      call put(file, "a1 = " // text_of(a(1)) // "; a2 = " // text_of(a(2)) // "; a3 = " // &
               text_of(a(3)) // "   # smallest moment / moment, sorted", error)
      call put_lines(file, [character(100) :: &
         "# level k of 5 about the axis of the smallest moment (side 1), of the largest (side 3)", &
         "r1(k) = 1 - (k/5.0)**2; r3(k) = 1 - (k/5.0)**2", &
         "c1x(k,s,g) = g*sqrt(1 - c1y(k,s)**2 - c1z(k,s)**2)", &
         "c1y(k,s) = k/5.0*cos(s)", &
         "c1z(k,s) = k/5.0*sqrt((a1-a2)/(a1-a3))*sin(s)", &
         "c3x(k,s) = k/5.0*sqrt((a2-a3)/(a1-a3))*sin(s)", &
         "c3y(k,s) = k/5.0*cos(s)", &
         "c3z(k,s,g) = g*sqrt(1 - c3x(k,s)**2 - c3y(k,s)**2)"], error)
      call put_axes_of(order, file, error)
   end subroutine put_contours

   !> Sorted coordinates (x: smallest moment) back to those of the body, an axis each.
   subroutine put_axes_of(order, file, error)
      integer, intent(in) :: order(3)  !! axis of the smallest, the middle, the largest moment
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: name(3) = ["x", "y", "z"]
      character(1) :: back(3)
      character(:), allocatable :: vector
      back(order) = name
      vector = "(" // back(1) // "," // back(2) // "," // back(3) // ")"
      call put(file, "npx(x,y,z) = near" // vector, error)
      call put(file, "fpx(x,y,z) = far" // vector, error)
      call put(file, "spy(x,y,z) = py" // vector, error)
   end subroutine put_axes_of

   !> Three moments that differ enough for contours.
   pure logical function has_contours(bodies)
      type(body_group), intent(in) :: bodies
      integer :: order(3)
      real(dp) :: a(3)
      has_contours = minval(bodies%moments) > 1e-3_dp*maxval(bodies%moments)
      if (.not. has_contours) return
      call sorted_inverse(bodies%moments, a, order)
      has_contours = a(1) - a(2) > 1e-3_dp .and. a(2) - a(3) > 1e-3_dp
   end function has_contours

   pure subroutine sorted_inverse(moments, a, order)
      real(dp), intent(in) :: moments(3)
      real(dp), intent(out) :: a(3)
      integer, intent(out) :: order(3)
      order(1) = minloc(moments, 1)
      order(3) = maxloc(moments, 1, back=.true.)
      order(2) = 6 - order(1) - order(3)
      if (order(1) == order(3)) order = [1, 2, 3]
      a = minval(moments)/moments(order)
   end subroutine sorted_inverse

   !> The plot elements of the contours, near side only.
   subroutine put_contour_plots(file, error)
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: look = "with lines lc rgb '" // grey // "' "
      call put_lines(file, [character(220) :: &
         "   for [g=-1:1:2] for [k=1:4] [s=0:2*pi] '+' using (npx(c1x(k,$1,g),c1y(k,$1)," // &
         "c1z(k,$1))):(spy(c1x(k,$1,g),c1y(k,$1),c1z(k,$1))) " // look // "lw 0.8, \", &
         "   for [g=-1:1:2] for [k=1:4] [s=0:2*pi] '+' using (npx(c3x(k,$1),c3y(k,$1)," // &
         "c3z(k,$1,g))):(spy(c3x(k,$1),c3y(k,$1),c3z(k,$1,g))) " // look // "lw 0.8, \", &
         "   for [g=-1:1:2] [s=0:2*pi] '+' using (npx(sx($1,g),sy($1),sz($1))):" // &
         "(spy(sx($1,g),sy($1),sz($1))) " // look // "lw 1.6 dt 2, \"], error)
   end subroutine put_contour_plots

   !> Names of the axes at the ends that are seen; functions of the separatrix.
   subroutine put_axis_labels(file, error)
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      call put_lines(file, [character(150) :: &
         "# the separatrix: two great circles through the middle axis", &
         "sx(s,g) = g*sqrt((a2-a3)/(a1-a3))*cos(s)", &
         "sy(s) = sin(s)", &
         "sz(s) = sqrt((a1-a2)/(a1-a3))*cos(s)", &
         "seen(x,y,z) = depth(x,y,z) >= 0 ? 1 : -1", &
         "axis_name(i,side) = (side > 0 ? '' : '-') . sprintf('y_%d', i)", &
         "set style textbox opaque noborder fillcolor rgb '#ffffff' margins 0.6,0.4", &
         "g = seen(1,0,0); set label 1 axis_name(1,g) at g*px(1,0,0),g*py(1,0,0) " // &
         "center boxed front", &
         "g = seen(0,1,0); set label 2 axis_name(2,g) at g*px(0,1,0),g*py(0,1,0) " // &
         "center boxed front", &
         "g = seen(0,0,1); set label 3 axis_name(3,g) at g*px(0,0,1),g*py(0,0,1) " // &
         "center boxed front"], &
         error)
   end subroutine put_axis_labels

   !> What should stay constant, against time: a strip for each.
   subroutine write_drift(scene, path, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: path
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(strip_length), allocatable :: names(:), terms(:)
      integer :: i
      call open_out(path, file, error)
      if (raised(error)) return
      if (size(scene%effects) == 0) then
         names = [character(strip_length) :: "the energy", "|y|", &
                  "Q y, all three components", "|q|"]
         terms = [character(strip_length) :: "$12/unit_h", "sqrt($7**2+$8**2+$9**2)/unit_l", &
                  "qy#($3,$4,$5,$6,$7,$8,$9)/unit_l", "sqrt($3**2+$4**2+$5**2+$6**2)"]
      else
         names = [character(strip_length) :: "the energy", "the vertical component of Q y", "|q|"]
         terms = [character(strip_length) :: "$12/unit_h", "qy3($3,$4,$5,$6,$7,$8,$9)/unit_l", &
                  "sqrt($3**2+$4**2+$5**2+$6**2)"]
      end if
      call put_start(scene, file, "drift", 720, 110*size(names) + 80, error)
      call put_columns(file, error)
      call put_lines(file, [character(120) :: &
         "unset key; set border 3; set tics nomirror out", &
         "set xrange [*:*]; set yrange [*:*]; set offsets 0,0,0,0", &
         "first(x) = (n == 0 ? (n = 1, x0 = x) : 0, x - x0)", &
         "qy1(a,b,c,d,x,y,z) = q11(a,b,c,d)*x + q12(a,b,c,d)*y + q13(a,b,c,d)*z", &
         "qy2(a,b,c,d,x,y,z) = q21(a,b,c,d)*x + q22(a,b,c,d)*y + q23(a,b,c,d)*z", &
         "qy3(a,b,c,d,x,y,z) = q31(a,b,c,d)*x + q32(a,b,c,d)*y + q33(a,b,c,d)*z", &
         "stats file skip 1 every bodies::body using (sqrt($7**2+$8**2+$9**2)) name 'L' nooutput", &
         "stats file skip 1 every bodies::body using (abs($10) + abs($11)) name 'H' nooutput", &
         "unit_l = L_max > 0 ? L_max : 1; unit_h = H_max > 0 ? H_max : 1", &
         "array m[4] = [1e-17, 1e-17, 1e-17, 1e-17]   # largest change in each strip"], error)
      do i = 1, size(names)
         call put_range(file, i, trim(terms(i)), error)
      end do
      call put(file, "set multiplot layout " // text_of(size(names)) // &
               ",1 margins 0.14,0.97,0.15,0.93 spacing 0,0.07", error)
      do i = 1, size(names)
         call put_strip(file, i, trim(names(i)), trim(terms(i)), i == size(names), error)
      end do
      call put(file, "unset multiplot; unset xlabel", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_drift

   !> How many curves a strip has: # in its expression stands for 1, 2 and 3.
   pure integer function parts_of(term)
      character(*), intent(in) :: term
      parts_of = merge(3, 1, index(term, "#") > 0)
   end function parts_of

   !> One of the curves.
   pure function part_of(term, j) result(part)
      character(*), intent(in) :: term
      integer, intent(in) :: j
      character(:), allocatable :: part
      integer :: mark
      part = term
      mark = index(term, "#")
      if (mark > 0) part = term(:mark - 1) // text_of(j) // term(mark + 1:)
   end function part_of

   !> Find the largest change of a strip's curves.
   subroutine put_range(file, strip, term, error)
      type(out_file), intent(in) :: file
      integer, intent(in) :: strip
      character(*), intent(in) :: term
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: m
      integer :: j
      m = "m[" // text_of(strip) // "]"
      do j = 1, parts_of(term)
         call put(file, "n = 0; stats file skip 1 every bodies::body using (first(" // &
                  part_of(term, j) // ")) name 'D' nooutput", error)
         call put(file, m // " = abs(D_min) > " // m // " ? abs(D_min) : " // m // "; " // &
                  m // " = abs(D_max) > " // m // " ? abs(D_max) : " // m, error)
      end do
   end subroutine put_range

   !> One strip: change of a quantity since the first row.
   subroutine put_strip(file, strip, name, term, last, error)
      type(out_file), intent(in) :: file
      integer, intent(in) :: strip
      character(*), intent(in) :: name, term
      logical, intent(in) :: last           !! has the time axis
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: styles(3) = [character(24) :: "lc rgb '#1f3f66' lw 1.0", &
                                              "lc rgb '#8a8a8a' lw 1.0", "lc rgb '#b4c2d2' lw 1.0"]
      character(:), allocatable :: m
      integer :: j
      m = "m[" // text_of(strip) // "]"
      call put(file, "set yrange [-1.15*" // m // ":1.15*" // m // &
         "]; set ytics (sprintf('%.0e', " // &
               m // ") " // m // ", '0' 0, sprintf('%.0e', -" // m // ") -" // m // ")", error)
      call put(file, "set label 1 'change of " // name // "' at graph 0.01, graph 1.1", error)
      if (last) then
         call put(file, "set xlabel 't'; set xtics format '%g'", error)
      else
         call put(file, "unset xlabel; set xtics format ''", error)
      end if
      do j = 1, parts_of(term)
         call put(file, merge("plot", "    ", j == 1) // &
                  " file skip 1 every bodies::body using ($0 == 0 ? (n = 0) : 0, $1):(first(" // &
                  part_of(term, j) // ")) with lines " // trim(styles(j)) // &
                  trim(merge(", \", "   ", j < parts_of(term))), error)
      end do
   end subroutine put_strip

end module poinsot_scene_plots_body
