!> Pictures of a body under torque: the curve its axis draws on the sphere, and its angle in time.
module poinsot_scene_plots_top
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_text, only: text_of
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_plots_common, only: put_lines, put_start, put_end, put_columns, &
      written_bodies, dark
   use poinsot_scene_plots_sphere, only: put_sphere, put_wires, put_trace
   implicit none(type, external)
   private
   public :: write_nutation, write_angle, write_tilt

   character(*), parameter :: row = "($3,$4,$5,$6)"
   character(*), parameter :: vector = "(n1" // row // ",n2" // row // ",n3" // row // ")"
   character(*), parameter :: angle = "angle($1,n1" // row // ",n2" // row // ",n3" // row // ")"

contains

   !> The followed body axis in space, as functions n1, n2, n3 of a quaternion.
   subroutine put_axis(scene, file, error)
      type(scene_settings), intent(in) :: scene
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      integer :: i, j
      character(:), allocatable :: sum
      do i = 1, 3
         sum = ""
         do j = 1, 3
            if (abs(scene%output%axis(j)) <= 0) cycle
            if (len(sum) > 0) sum = sum // " + "
            sum = sum // "(" // text_of(scene%output%axis(j)) // ")*q" // text_of(i) // &
                  text_of(j) // "(a,b,c,d)"
         end do
         call put(file, "n" // text_of(i) // "(a,b,c,d) = " // sum, error)
      end do
   end subroutine put_axis

   !> Left the curve of the axis on the sphere, right its two angles against each other.
   subroutine write_nutation(scene, path, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: path          !! of the file
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      call open_out(path, file, error)
      if (raised(error)) return
      call put_start(scene, file, "nutation", 960, 470, error)
      call put_columns(file, error)
      call put_axis(scene, file, error)
      call put_lines(file, [character(100) :: &
         "# angle from the vertical, and azimuth followed through full turns; in degrees", &
         "theta(x,y,z) = atan2(sqrt(x*x + y*y), z)*180/pi", &
         "jump(p) = p - 360*floor((p + 180)/360.0)", &
         "turned(p) = (old = (old > -1e8 ? old + jump(p - old) : p))", &
         "phi(x,y,z) = x == 0 && y == 0 ? NaN : turned(atan2(y, x)*180/pi)", &
         "set multiplot"], error)
      call put_sphere(file, 35, 22, error)
      call put_lines(file, [character(100) :: &
         "set lmargin at screen 0.0; set rmargin at screen 0.47", &
         "set bmargin at screen 0.02; set tmargin at screen 0.98", &
         "set arrow 1 from 0,py(0,0,1) to 0,py(0,0,1)+0.16 lc rgb '#7d7d7d' front", &
         "set label 1 'up' at 0.05,py(0,0,1)+0.12 tc rgb '#7d7d7d'"], error)
      call put_wires(file, error)
      call put_trace(file, vector, "1.4", "1.9", "1", error)
      call put_lines(file, [character(100) :: &
         "unset arrow 1; unset label 1; set size noratio; set border 3", &
         "set lmargin at screen 0.57; set rmargin at screen 0.975", &
         "set bmargin at screen 0.14; set tmargin at screen 0.93", &
         "set xtics nomirror out autofreq format '%g'", &
         "set ytics nomirror out autofreq format '%g'", &
         "set xrange [*:*]; set yrange [*:*] reverse", &
         "set xlabel 'azimuth of the axis (degrees)'", &
         "set ylabel 'angle from the vertical (degrees)'", &
         "old = -1e9"], error)
      call put(file, "plot file skip 1 every bodies::body using ($0 == 0 ? (old = -1e9) : 0, " // &
               "phi" // vector // "):(theta" // vector // ") with lines lc rgb '" // dark // &
               "' lw 1.6, \", error)
      call put(file, "   file skip 1 every bodies::body::body using ((old = -1e9), " // &
               "phi" // vector // "):(theta" // vector // &
               ") with points pt 7 ps 1 lc rgb '" // dark // "'", error)
      call put_lines(file, [character(60) :: &
         "unset multiplot", &
         "unset xlabel; unset ylabel; set yrange [*:*] noreverse"], error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_nutation

   !> Angle of the followed axis from the vertical against time, a curve for each of few bodies.
   subroutine write_tilt(scene, path, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: path          !! of the file
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      integer :: n
      n = min(written_bodies(scene), 3)
      call open_out(path, file, error)
      if (raised(error)) return
      call put_start(scene, file, "tilt", 720, 400, error)
      call put_columns(file, error)
      call put_axis(scene, file, error)
      call put_lines(file, [character(120) :: &
         "theta(x,y,z) = atan2(sqrt(x*x + y*y), z)*180/pi", &
         "look(i) = i == 0 ? '#1f3f66' : i == 1 ? '#8a8a8a' : '#b4c2d2'", &
         "unset key; set border 3; set tics nomirror out; set rmargin 9", &
         "set xlabel 't'; set ylabel 'tilt of the axis (degrees)'", &
         "set autoscale xfix; set yrange [0:*]"], error)
      call put(file, "do for [i=0:" // text_of(n - 1) // "] { stats file skip 1 every " // &
               "bodies::i using (last = theta" // vector // ") nooutput; " // &
               "set label i+1 sprintf('body %d', i+1) at graph 1.01, first last " // &
               "tc rgb look(i) }", error)
      call put(file, "plot for [i=0:" // text_of(n - 1) // "] file skip 1 every bodies::i " // &
               "using 1:(theta" // vector // ") with lines lw 1.6 lc rgb look(i)", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_tilt

   !> Angle of the followed axis about z against time, in a frame that may turn; of many bodies each
   !> in a lane of its own.
   subroutine write_angle(scene, path, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: path          !! of the file
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      integer :: n
      n = min(written_bodies(scene), 16)
      call open_out(path, file, error)
      if (raised(error)) return
      call put_start(scene, file, "angle", 720, merge(400, 560, n <= 2), error)
      call put_columns(file, error)
      call put_axis(scene, file, error)
      call put(file, "rate = " // text_of(scene%output%rate) // &
               "   # turning of the frame the angle is seen from", error)
      call put_lines(file, [character(120) :: &
         "# azimuth of the axis, followed through full turns; in degrees", &
         "jump(p) = p - 360*floor((p + 180)/360.0)", &
         "turned(p) = (old = (old > -1e8 ? old + jump(p - old) : jump(p)))", &
         "angle(t,x,y,z) = x == 0 && y == 0 ? NaN : turned((atan2(y, x) - rate*t)*180/pi)", &
         "unset key; set border 3; set tics nomirror out", &
         "set xlabel 't'; set autoscale xfix"], error)
      if (n <= 2) then
         call put_few_angles(file, n, error)
      else
         call put_many_angles(file, n, error)
      end if
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_angle

   !> One or two bodies: their angles themselves.
   subroutine put_few_angles(file, n, error)
      type(out_file), intent(in) :: file
      integer, intent(in) :: n         !! 1 or 2
      type(poinsot_error), intent(inout) :: error
      call put(file, "set ylabel 'angle of the axis (degrees)'; set rmargin 9", error)
      call put(file, "set zeroaxis lc rgb '#c8c8c8'", error)
      if (n == 2) then
         call put(file, "do for [i=0:1] { old = -1e9; stats file skip 1 every bodies::i " // &
                  "using (last = " // angle // ") nooutput; set label i+1 " // &
                  "sprintf('body %d', i+1) at graph 1.01, first last " // &
                  "tc rgb (i == 0 ? '#1f3f66' : '#8a8a8a') }", error)
      end if
      call put(file, "plot for [i=0:" // text_of(n - 1) // "] file skip 1 every bodies::i " // &
               "using ($0 == 0 ? (old = -1e9) : 0, $1):(" // angle // ") with lines " // &
               "lc rgb (i == 0 ? '" // dark // "' : '#8a8a8a') lw 1.6", error)
   end subroutine put_few_angles

   !> More: each in a lane of its own.
   subroutine put_many_angles(file, n, error)
      type(out_file), intent(in) :: file
      integer, intent(in) :: n         !! how many lanes
      type(poinsot_error), intent(inout) :: error
      call put(file, "lanes = " // text_of(n), error)
      call put_lines(file, [character(160) :: &
         "m = 1; set yrange [*:*]", &
         "do for [i=0:lanes-1] { old = -1e9; stats file skip 1 every bodies::i using " // &
         "(" // angle // ") name 'A' nooutput; \", &
         "   m = abs(A_max) > m ? abs(A_max) : m; m = abs(A_min) > m ? abs(A_min) : m }", &
         "set ylabel sprintf('body; a lane is %.0f degrees to either side', m)", &
         "set yrange [lanes+0.6:0.4]; set ytics 1"], error)
      call put(file, "plot for [i=0:lanes-1] i+1 with lines lc rgb '#dddddd' lw 0.8, " // &
               "for [i=0:lanes-1] file skip 1 every bodies::i using " // &
               "($0 == 0 ? (old = -1e9) : 0, $1):(i + 1 - 0.46/m*" // angle // ") " // &
               "with lines lc rgb '" // dark // "' lw 1.4", error)
   end subroutine put_many_angles

end module poinsot_scene_plots_top
