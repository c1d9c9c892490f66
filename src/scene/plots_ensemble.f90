!> Pictures of many bodies: the temperature of each axis in time, and the distribution of momenta.
module poinsot_scene_plots_ensemble
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_text, only: text_of
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_plots_common, only: put_lines, put_start, put_end, first_group
   implicit none(type, external)
   private
   public :: write_temperature, write_momenta, wanted_temperature

contains

   !> Names of the bodies' moments and temperature in a script.
   subroutine put_moments(scene, file, error)
      type(scene_settings), intent(in) :: scene
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      associate (bodies => scene%bodies(first_group(scene)))
         call put(file, "i1 = " // text_of(bodies%moments(1)) // "; i2 = " // &
                  text_of(bodies%moments(2)) // "; i3 = " // text_of(bodies%moments(3)), error)
         call put(file, "kt = " // text_of(wanted_temperature(scene)), error)
      end associate
   end subroutine put_moments

   !> kT of the thermostat if there is one, else of the first momenta.
   pure real(dp) function wanted_temperature(scene) result(kt)
      type(scene_settings), intent(in) :: scene !! the typed scene
      integer :: i, k
      kt = maxval(scene%bodies%temperature)
      do i = 1, size(scene%effects)
         if (scene%effects(i)%name /= "langevin") cycle
         do k = 1, size(scene%effects(i)%settings)
            if (scene%effects(i)%settings(k)%key == "temperature") then
               kt = scene%effects(i)%settings(k)%values(1)
            end if
         end do
      end do
   end function wanted_temperature

   !> Mean of y_i^2/I_i over the bodies, for each axis, against time.
   subroutine write_temperature(scene, path, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: path          !! of the file
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      call open_out(path, file, error)
      if (raised(error)) return
      call put_start(scene, file, "temperature", 720, 420, error)
      call put_moments(scene, file, error)
      call put_lines(file, [character(230) :: &
         "set key bottom right reverse Left; set border 3; set tics nomirror out", &
         "set xlabel 't'; set ylabel 'temperature of each axis / wanted one'", &
         "set autoscale xfix; set yrange [0:1.4]", &
         "set arrow 1 from graph 0, first 1 to graph 1, first 1 nohead " // &
         "lc rgb '#b0b0b0' dt 2"], error)
      call put_lines(file, [character(160) :: &
         "plot file skip 1 using 1:(i1 > 0 ? $7**2/i1/kt : NaN) smooth unique title 'axis 1' " // &
         "with lines lc rgb '#1f3f66' lw 2, \", &
         "   file skip 1 using 1:(i2 > 0 ? $8**2/i2/kt : NaN) smooth unique title 'axis 2' " // &
         "with lines lc rgb '#5f5f5f' lw 2 dt 2, \", &
         "   file skip 1 using 1:(i3 > 0 ? $9**2/i3/kt : NaN) smooth unique title 'axis 3' " // &
         "with lines lc rgb '#94a6ba' lw 2"], error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_temperature

   !> Distribution of y_i/sqrt(I_i kT) at the last output, beside the normal one.
   subroutine write_momenta(scene, path, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: path          !! of the file
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      call open_out(path, file, error)
      if (raised(error)) return
      call put_start(scene, file, "momenta", 960, 360, error)
      call put_moments(scene, file, error)
      call put_lines(file, [character(230) :: &
         "unset key; set border 1; set tics nomirror out; unset ytics", &
         "stats file skip 1 using 1 name 'T' nooutput", &
         "last = int(T_records) - bodies   # first row of the last frame", &
         "width = 0.25; bin(x) = width*(floor(x/width) + 0.5)", &
         "set xrange [-4.2:4.2]; set yrange [0:0.47]; set xtics 2", &
         "set multiplot layout 1,3 margins 0.02,0.98,0.24,0.9 spacing 0.03,0", &
         "do for [j=1:3] {", &
         "i = j == 1 ? i1 : j == 2 ? i2 : i3", &
         "set title sprintf('axis %d', j) offset 0,-0.6", &
         "set xlabel sprintf('y_%d / {/Symbol \326}(I_%d kT)', j, j)", &
         "if (i > 0) {", &
         "plot file skip 1 every ::last using (bin(column(6+j)/sqrt(i*kt))):" // &
         "(1.0/bodies/width) smooth frequency with boxes fs solid 1 " // &
         "border lc rgb '#ffffff' fc rgb '#b4c2d2', \", &
         "   exp(-x*x/2)/sqrt(2*pi) with lines lc rgb '#1f3f66' lw 2", &
         "} else { set label 1 'no inertia' at 0,0.2 center; plot NaN; unset label 1 }", &
         "}", &
         "unset multiplot"], error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_momenta

end module poinsot_scene_plots_ensemble
