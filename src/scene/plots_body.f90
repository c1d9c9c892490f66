!> Picture of one free body: its axes in space (the review's figure 1).
module poinsot_scene_plots_body
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_text, only: text_of
   use poinsot_rotation_quaternion, only: rotate
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_plots_common, only: put_lines, put_start, put_end, put_columns, first_group
   use poinsot_scene_plots_sphere, only: find_eye, put_sphere, put_wires, put_trace
   implicit none(type, external)
   private
   public :: write_attitude

contains

   !> The review's figure 1: where each body axis points in space, a sphere for each.
   subroutine write_attitude(scene, path, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: path          !! of the file
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(:), allocatable :: j, vector
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
      call put(file, "set multiplot layout 1,3 margins 0.005,0.995,0.005,0.995 spacing " // &
               "0.01,0", error)
      do axis = 1, 3
         j = text_of(axis)
         vector = "(q1" // j // "($3,$4,$5,$6),q2" // j // "($3,$4,$5,$6),q3" // j // &
            "($3,$4,$5,$6))"
         call put(file, "set label 2 '" // axis_title(scene, axis) // "' at 0,-1.25 center", error)
         call put_wires(file, error)
         call put_trace(file, vector, "1.2", "1.8", "0.9", error)
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

end module poinsot_scene_plots_body
