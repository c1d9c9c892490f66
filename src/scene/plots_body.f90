!> Pictures of one free body: its axes in space (the review's figure 1), its momentum on the sphere
!> with the contours of energy, and what should stay constant.
module poinsot_scene_plots_body
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_text, only: text_of
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_settings, only: scene_settings, body_group
   use poinsot_scene_plots_common, only: put_lines, put_start, put_end, put_columns, put_sphere, &
      first_group, dark, pale, grey, faint
   implicit none(type, external)
   private
   public :: write_attitude, write_momentum, write_drift, put_wires

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
         "   (py(cos($1)*cos(k*pi/6),sin($1)*cos(k*pi/6),sin(k*pi/6))) with lines lc rgb wire(0), \", &
         "   for [k=0:5] [s=0:2*pi] '+' using " // &
         "(near(cos($1)*cos(k*pi/6),cos($1)*sin(k*pi/6),sin($1))): \", &
         "   (py(cos($1)*cos(k*pi/6),cos($1)*sin(k*pi/6),sin($1))) with lines lc rgb wire(1), \", &
         "   for [k=-2:2] [s=0:2*pi] '+' using " // &
         "(near(cos($1)*cos(k*pi/6),sin($1)*cos(k*pi/6),sin(k*pi/6))): \", &
         "   (py(cos($1)*cos(k*pi/6),sin($1)*cos(k*pi/6),sin(k*pi/6))) with lines lc rgb wire(1), \", &
         "   [s=0:2*pi] '+' using (cos($1)):(sin($1)) with lines lc rgb '#9a9a9a' lw 1, \"], error)
   end subroutine put_wires

   !> The review's figure 1: where each body axis points in space, a sphere for each.
   subroutine write_attitude(scene, path, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: path
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(:), allocatable :: j, vector, row
      integer :: axis
      call open_out(path, file, error)
      if (raised(error)) return
      call put_start(scene, file, "attitude", 960, 370, error)
      call put_columns(file, error)
      call put_sphere(file, 35, 22, error)
      call put(file, "set multiplot layout 1,3 margins 0.01,0.99,0.02,0.88 spacing 0.01,0", error)
      row = " every bodies::body+1 "
      do axis = 1, 3
         j = text_of(axis)
         vector = "(q1" // j // "($3,$4,$5,$6),q2" // j // "($3,$4,$5,$6),q3" // j // "($3,$4,$5,$6))"
         call put(file, "set title '" // axis_title(scene, axis) // "' offset 0,-0.4", error)
         call put_wires(file, error)
         call put(file, "   file" // row // "using (far" // vector // "):(py" // vector // &
                  ") with lines lc rgb '" // pale // "' lw 1.2, \", error)
         call put(file, "   file" // row // "using (near" // vector // "):(py" // vector // &
                  ") with lines lc rgb '" // dark // "' lw 1.8, \", error)
         call put(file, "   file every bodies::body+1::body+1 using (px" // vector // "):(py" // &
                  vector // ") with points pt 7 ps 0.9 lc rgb '" // dark // "'", error)
      end do
      call put(file, "unset multiplot", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_attitude

   !> "axis 1 of the body (moment 0.376)"
   function axis_title(scene, axis) result(text)
      type(scene_settings), intent(in) :: scene
      integer, intent(in) :: axis
      character(:), allocatable :: text
      text = "axis " // text_of(axis) // " of the body, in space"
      if (scene%bodies(first_group(scene))%turned) return
      text = text // ":  I_" // text_of(axis) // " = " // &
         text_of(scene%bodies(first_group(scene))%moments(axis))
   end function axis_title

   !> Momentum in the body frame on its sphere, with the contours of energy: polhodes.
   subroutine write_momentum(scene, path, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: path
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(:), allocatable :: vector
      call open_out(path, file, error)
      if (raised(error)) return
      call put_start(scene, file, "momentum", 560, 560, error)
      call put_sphere(file, 35, 22, error)
      call put_principal(scene, file, vector, error)
      call put_contours(scene%bodies(first_group(scene)), file, error)
      call put_axis_labels(file, error)
      call put(file, "set margins 0.5,0.5,0.5,0.5", error)
      call put_wires(file, error)
      call put_contour_plots(scene%bodies(first_group(scene)), file, error)
      call put(file, "   file every bodies::body+1 using (far" // vector // "):(py" // vector // &
               ") with lines lc rgb '" // pale // "' lw 3, \", error)
      call put(file, "   file every bodies::body+1 using (near" // vector // "):(py" // vector // &
               ") with lines lc rgb '" // dark // "' lw 3.5, \", error)
      call put(file, "   file every bodies::body+1::body+1 using (px" // vector // "):(py" // &
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
      call put(file, "length(a,b,c) = a == 0 && b == 0 && c == 0 ? NaN : sqrt(a*a + b*b + c*c)", error)
      do j = 1, 3
         call put(file, "u" // text_of(j) // "(a,b,c) = (a*(" // text_of(axes(1, j)) // ") + b*(" // &
                  text_of(axes(2, j)) // ") + c*(" // text_of(axes(3, j)) // "))/length(a,b,c)", error)
      end do
      vector = "(u1($7,$8,$9),u2($7,$8,$9),u3($7,$8,$9))"
   end subroutine put_principal

   !> Contours of H = sum a_j u_j^2 on the sphere, a sorted so that a1 > a2 > a3: closed curves about
   !> the axis of the smallest moment, about that of the largest, and the separatrix between them.
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

   !> The plot elements of the contours.
   subroutine put_contour_plots(bodies, file, error)
      type(body_group), intent(in) :: bodies
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: sides(2) = ["fpx", "npx"]
      character(7) :: colours(2)
      integer :: i
      if (.not. has_contours(bodies)) return
      colours = [faint, "#9c9c9c"]
      do i = 1, 2
         call put(file, "   for [g=-1:1:2] for [k=1:4] [s=0:2*pi] '+' using (" // sides(i) // &
                  "(c1x(k,$1,g),c1y(k,$1),c1z(k,$1))):(spy(c1x(k,$1,g),c1y(k,$1),c1z(k,$1))) " // &
                  "with lines lc rgb '" // colours(i) // "' lw 0.8, \", error)
         call put(file, "   for [g=-1:1:2] for [k=1:4] [s=0:2*pi] '+' using (" // sides(i) // &
                  "(c3x(k,$1),c3y(k,$1),c3z(k,$1,g))):(spy(c3x(k,$1),c3y(k,$1),c3z(k,$1,g))) " // &
                  "with lines lc rgb '" // colours(i) // "' lw 0.8, \", error)
         call put(file, "   for [g=-1:1:2] [s=0:2*pi] '+' using (" // sides(i) // &
                  "(sx($1,g),sy($1),sz($1))):(spy(sx($1,g),sy($1),sz($1))) " // &
                  "with lines dt 2 lc rgb '" // trim(merge("#555555", faint // "", i == 2)) // &
                  "' lw 1.2, \", error)
      end do
   end subroutine put_contour_plots

   !> Names of the body's axes where they leave the sphere; separatrix functions.
   subroutine put_axis_labels(file, error)
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      call put_lines(file, [character(100) :: &
         "# the separatrix: two great circles through the middle axis", &
         "sx(s,g) = g*sqrt((a2-a3)/(a1-a3))*cos(s)", &
         "sy(s) = sin(s)", &
         "sz(s) = sqrt((a1-a2)/(a1-a3))*cos(s)", &
         "set label 1 'y_1' at 1.13*px(1,0,0),1.13*py(1,0,0) center", &
         "set label 2 'y_2' at 1.13*px(0,1,0),1.13*py(0,1,0) center", &
         "set label 3 'y_3' at 1.13*px(0,0,1),1.13*py(0,0,1) center"], error)
   end subroutine put_axis_labels

   !> What should stay constant, against time: a strip for each.
   subroutine write_drift(scene, path, error)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: path
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      logical :: free
      free = size(scene%effects) == 0
      call open_out(path, file, error)
      if (raised(error)) return
      call put_start(scene, file, "drift", 720, merge(520, 420, free), error)
      call put_columns(file, error)
      call put_lines(file, [character(120) :: &
         "unset key; set border 3; set tics nomirror out; set samples 100", &
         "set xrange [*:*]; set format y ''", &
         "first(x) = (n == 0 ? (n = 1, x0 = x) : 0, x - x0)", &
         "qy1(a,b,c,d,x,y,z) = q11(a,b,c,d)*x + q12(a,b,c,d)*y + q13(a,b,c,d)*z", &
         "qy2(a,b,c,d,x,y,z) = q21(a,b,c,d)*x + q22(a,b,c,d)*y + q23(a,b,c,d)*z", &
         "qy3(a,b,c,d,x,y,z) = q31(a,b,c,d)*x + q32(a,b,c,d)*y + q33(a,b,c,d)*z", &
         "stats file every bodies::body+1 using (sqrt($7**2+$8**2+$9**2)) name 'L' nooutput", &
         "stats file every bodies::body+1 using (abs($10) + abs($11)) name 'H' nooutput", &
         "unit_l = L_max > 0 ? L_max : 1; unit_h = H_max > 0 ? H_max : 1"], error)
      call put(file, "rows = " // text_of(merge(4, 3, free)), error)
      call put_lines(file, [character(100) :: &
         "set multiplot layout rows,1 margins 0.17,0.97,0.13,0.92 spacing 0,0.055"], error)
      call put_strip(file, "energy H", "$12/unit_h", .false., error)
      if (free) then
         call put_strip(file, "momentum |y|", "sqrt($7**2+$8**2+$9**2)/unit_l", .false., error)
         call put_strip(file, "(Q y)_x, (Q y)_y, (Q y)_z", "qy#($3,$4,$5,$6,$7,$8,$9)/unit_l", &
                        .false., error)
      else
         call put_strip(file, "(Q y)_z", "qy3($3,$4,$5,$6,$7,$8,$9)/unit_l", .false., error)
      end if
      call put_strip(file, "|q|", "sqrt($3**2+$4**2+$5**2+$6**2)", .true., error)
      call put(file, "unset multiplot", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_drift

   !> One strip: change of an expression since the first row; # in it stands for 1, 2 and 3.
   subroutine put_strip(file, name, expression, last, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: name, expression
      logical, intent(in) :: last           !! has the time axis
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: styles(3) = [character(24) :: "lc rgb '#1f3f66' lw 1.4", &
                                              "lc rgb '#7d7d7d' lw 1.4", "lc rgb '#b4c2d2' lw 1.4"]
      character(:), allocatable :: term
      integer :: j, mark, parts
      mark = index(expression, "#")
      parts = merge(3, 1, mark > 0)
      call put(file, "m = 0", error)
      do j = 1, parts
         term = expression
         if (mark > 0) term = expression(:mark - 1) // text_of(j) // expression(mark + 1:)
         call put(file, "n = 0; stats file every bodies::body+1 using (first(" // term // &
                  ")) name 'D' nooutput; m = (abs(D_min) > m ? abs(D_min) : m); " // &
                  "m = (abs(D_max) > m ? abs(D_max) : m)", error)
      end do
      call put(file, "m = (m > 0 ? m : 1e-17)", error)
      call put(file, "set yrange [-1.15*m:1.15*m]; set ytics (sprintf('%.1e', m) m, '0' 0, " // &
               "sprintf('%.1e', -m) -m)", error)
      call put(file, "set title 'change of " // name // "' left offset graph 0, -0.6 font ',11'", error)
      if (last) then
         call put(file, "set xlabel 't'; set xtics format '%g'", error)
      else
         call put(file, "unset xlabel; set xtics format ''", error)
      end if
      do j = 1, parts
         term = expression
         if (mark > 0) term = expression(:mark - 1) // text_of(j) // expression(mark + 1:)
         call put(file, trim(merge("n = 0; plot ", "             ", j == 1)) // &
                  " file every bodies::body+1 using ($0 == 0 ? n = 0 : 0, $1):(first(" // term // &
                  ")) with lines " // trim(styles(j)) // trim(merge(", \", "   ", j < parts)), error)
      end do
   end subroutine put_strip

end module poinsot_scene_plots_body
