!> Picture of one free body: its momentum on the sphere, with the contours of energy.
module poinsot_scene_plots_momentum
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_text, only: text_of
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_settings, only: scene_settings, body_group
   use poinsot_scene_plots_common, only: put_lines, put_start, put_end, first_group, grey
   use poinsot_scene_plots_sphere, only: find_eye, put_sphere, put_wires, put_trace
   implicit none(type, external)
   private
   public :: write_momentum

contains

   !> Momentum in the body frame on its sphere, with the contours of energy: polhodes.
   subroutine write_momentum(scene, path, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: path          !! of the file
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
         call put(file, "plot for [k=1:1] [s=0:2*pi] '+' using (cos($1)):(sin($1)) " // &
                  "with lines lc rgb '#9a9a9a' lw 1, \", error)
         call put_contour_plots(file, error)
      else
         call put_wires(file, error)
      end if
      call put_trace(file, vector, "3", "3.5", "1.1", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_momentum

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
      call put(file, "length(a,b,c) = a == 0 && b == 0 && c == 0 ? " // &
               "NaN : sqrt(a*a + b*b + c*c)", error)
      do j = 1, 3
         call put(file, "u" // text_of(j) // "(a,b,c) = (a*(" // text_of(axes(1, j)) // &
                  ") + b*(" // text_of(axes(2, j)) // ") + c*(" // text_of(axes(3, j)) // &
                  "))/length(a,b,c)", error)
      end do
      vector = "(u1($7,$8,$9),u2($7,$8,$9),u3($7,$8,$9))"
   end subroutine put_principal

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
         "center boxed front"], error)
   end subroutine put_axis_labels

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

end module poinsot_scene_plots_momentum
