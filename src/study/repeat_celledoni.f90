!> E. Celledoni, F. Fasso, N. Safstrom, A. Zanna, The exact computation of the free rigid body
!> motion and its use in splitting methods, SIAM J. Sci. Comput. 30 (2008) 2084: when does the exact
!> rotor pay inside a splitting? A top with gravity weak to strong against its spin; for each rotor
!> the time to one accuracy, each with the splitting and step that serve it best.
module poinsot_study_repeat_celledoni
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_e_convergence
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_plots_common, only: put_lines, put_end
   use poinsot_scene_reader, only: scan_source
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_source, only: scene_source
   use poinsot_scene_text, only: text_of
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_candidates, only: any_name
   use poinsot_study_choose, only: choose_request, choice, choose_method
   use poinsot_study_plots, only: put_terminals, strong_colour, strong_point
   implicit none(type, external)
   private
   public :: repeat_celledoni

   character(20), parameter :: rotors(7) = [character(20) :: "exact", "dmv2", "dmv4", "dmv6", &
      "dmv8", &
                                            "three-rotations", "symmetric-rotation"]
   real(dp), parameter :: weights(7) = [1e-4_dp, 1e-3_dp, 1e-2_dp, 3e-2_dp, 0.1_dp, 0.3_dp, 1.0_dp]
   real(dp), parameter :: lifts(7) = [1.0_dp, 0.87_dp, 1.15_dp, 1.0_dp, 1.0_dp, 1.15_dp, 0.87_dp]
   real(dp), parameter :: tol = 1e-6_dp

contains

   !> Measure, write celledoni.csv and its picture into a folder that is there; it takes about
   !> `budget` seconds. Error: POINSOT_E_IO.
   subroutine repeat_celledoni(out, budget, watch, error)
      character(*), intent(in) :: out
      real(dp), intent(in) :: budget
      class(run_watch), intent(inout) :: watch
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      type(choice) :: answer
      type(choose_request) :: request
      type(poinsot_error) :: refused
      type(scene_settings) :: scene
      integer :: i, m
      call open_out(out // "/celledoni.csv", file, error)
      call put(file, "ratio,rotor,splitting,h,error,ns_per_step,ns_per_time", error)
      request%tol = tol
      request%budget = budget/(size(rotors)*size(weights))
      request%splittings = any_name
      do m = 1, size(rotors)
         do i = 1, size(weights)
            call make_top(weights(i), scene, error)
            if (raised(error) .or. watch%stop_now()) exit
            request%methods = [character(24) :: rotors(m)]
            refused = poinsot_error()
            call choose_method(scene, request, watch, answer, refused)
            if (refused%code == poinsot_e_convergence) cycle ! too slow: no point in the picture
            if (raised(refused)) error = refused
            if (.not. raised(error)) call put_row(file, weights(i), answer, error)
         end do
      end do
      call finish_out(file, error)
      if (.not. raised(error)) call write_plot(out, error)
   end subroutine repeat_celledoni

   !> A top of kinetic energy about 0.75 that turns ten times, under a weight; an ensemble, so that
   !> times are those of full blocks.
   subroutine make_top(weight, scene, error)
      real(dp), intent(in) :: weight
      type(scene_settings), intent(out) :: scene
      type(poinsot_error), intent(inout) :: error
      type(scene_source) :: source
      character(*), parameter :: break = new_line("a")
      call scan_source("&scene t_end = 40, h = 0.1 /" // break // &
                       "&bodies moments = 0.5, 0.7, 1.0, count = 96, random = 'thermal', " // &
                       "temperature = 0.5 /" // &
                       break // "&gravity centre = 0, 0, 1, weight = " // text_of(weight) // &
                          " /" // break, &
                       "top", source, error)
      if (.not. raised(error)) call build_scene(source, scene, error)
   end subroutine make_top

   !> The ratio is that of the mean kinetic energy, 3/2 kT, to half the range of the potential.
   subroutine put_row(file, weight, answer, error)
      type(out_file), intent(in) :: file
      real(dp), intent(in) :: weight
      type(choice), intent(in) :: answer
      type(poinsot_error), intent(inout) :: error
      character(160) :: line
      associate (b => answer%best)
         write (line, "(es10.3, ',', a, ',', a, 4(',', es11.4e3))") 0.75_dp/weight, &
            trim(b%way%method), &
            trim(b%way%splitting), b%h, b%error, b%ns, b%ns/b%h
      end associate
      call put(file, trim(line), error)
   end subroutine put_row

   !> Time with each rotor over time with the exact one.
   subroutine write_plot(out, error)
      character(*), intent(in) :: out
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(:), allocatable :: line, rows
      integer :: m
      call open_out(out // "/plot_celledoni.gp", file, error)
      if (raised(error)) return
      call put_terminals(file, "celledoni", 820, 500, error)
      call put_lines(file, [character(120) :: "file = 'celledoni.csv'", &
         "set logscale xy; set format x '10^{%T}'; set format y '%g'", &
         "set border 3; set tics nomirror out; unset key; set grid lc rgb '#ececec' lt 1 lw 0.7", &
         "set xrange [0.4:2e5]; set yrange [0.6:*]; set tmargin 3; set rmargin 3", &
         "set ytics (0.7, 1, 2, 5, 10, 20, 50, 100, 200, 500)", &
         "set xlabel 'kinetic energy over that of the torque'", &
         "set ylabel 'time with another rotor over time with exact, error 1e-6'", &
         "set label 'when the exact rotor pays inside a splitting' at graph 0, graph 1.06 " // &
         "font ',14'", &
         "set label 'slow body, strong torque' at graph 0.01, graph 0.03 " // &
         "tc rgb '#707070' font ',10'", &
         "set label 'fast spin, weak torque' at graph 0.99, graph 0.03 right " // &
         "tc rgb '#707070' font ',10'", &
         "array base[20]; array place[20]; n = 0", &
         "do for [k=1:20] { place[k] = 0.0; base[k] = NaN }", &
         "stats file skip 1 using (stringcolumn(2) eq 'exact' ? " // &
         "(n = n + 1, place[n] = $1, base[n] = $7, 1) " // &
         ": NaN) nooutput", &
         "exact(r) = (found = NaN, sum [k=1:20] (abs(place[k]/r - 1) < 1e-3 ? " // &
         "(found = base[k], 0) : 0), found)"], error)
      do m = 2, size(rotors)
         rows = "stringcolumn(2) eq '" // trim(rotors(m)) // "'"
         call put(file, "best = 0; stats file skip 1 using (" // rows // " && $1 > best ? " // &
                  "(best = $1, last_y = $7/exact($1), 1) : NaN) nooutput", error)
         call put(file, "set label '" // trim(rotors(m)) // "' at best*1.3, last_y*" // &
                  text_of(lifts(m)) // " tc rgb '" // &
                  strong_colour(m) // "' font ',10' front", error)
      end do
      line = "plot 1 with lines lw 3 lc rgb '#c8c8c8', "
      do m = 2, size(rotors)
         call put(file, line // "file skip 1 using (stringcolumn(2) eq '" // trim(rotors(m)) // &
                  "' ? $1 : NaN):($7/exact($1)) with linespoints pt " // &
                     text_of(strong_point(m)) // &
                  " ps 0.8 lw 1.6 lc rgb '" // strong_colour(m) // "', \", error)
         line = "   "
      end do
      call put(file, "   NaN notitle", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_plot

end module poinsot_study_repeat_celledoni
