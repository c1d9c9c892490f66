!> E. Hairer, G. Vilmart, Preprocessed discrete Moser-Veselov algorithm for the full dynamics of a
!> rigid body, J. Phys. A 39 (2006) 13225, figure 1, once more: two bodies, error against work for
!> methods of order 2 to 10, and the exact step that was not there then.
module poinsot_study_repeat_hairer
   use poinsot_core_kinds, only: dp, i8, lanes, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_plots_common, only: put_lines, put_end
   use poinsot_scene_text, only: text_of
   use poinsot_study_errors, only: attitude_error
   use poinsot_study_free_trial, only: run_block
   use poinsot_study_plots, only: put_terminals, strong_colour, strong_point
   use poinsot_study_quadruple, only: turn_freely
   use poinsot_study_statistics, only: median
   implicit none(type, external)
   private
   public :: repeat_hairer

   real(dp), parameter :: bodies(3, 2) = reshape([0.6_dp, 0.8_dp, 1.0_dp, 0.345_dp, 0.653_dp, &
      1.0_dp], [3, 2])
   real(dp), parameter :: y0(3) = [1.8_dp, 0.4_dp, -0.9_dp], t_end = 10
   character(16), parameter :: methods(8) = [character(16) :: "dmv2", "dmv4", "dmv6", "dmv8", &
      "dmv10", &
                                             "midpoint", "three-rotations", "exact"]
   integer, parameter :: repeats = 5

contains

   !> Measure, write hairer-vilmart.csv and its picture into a folder that is there. Error:
   !> POINSOT_E_IO.
   subroutine repeat_hairer(out, error)
      character(*), intent(in) :: out
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      integer :: body, m, k
      call open_out(out // "/hairer-vilmart.csv", file, error)
      call put(file, "body,method,steps,h,momentum,attitude,ns_per_step,us_per_run", error)
      do body = 1, 2
         do m = 1, size(methods)
            do k = 3, 13
               if (.not. raised(error)) call one_run(file, body, trim(methods(m)), 2_i8**k, error)
            end do
         end do
      end do
      call finish_out(file, error)
      if (.not. raised(error)) call write_plot(out, error)
   end subroutine repeat_hairer

   !> One line, if the method comes through: a block of 32 copies, time of one.
   subroutine one_run(file, body, method, steps, error)
      type(out_file), intent(in) :: file
      integer, intent(in) :: body
      character(*), intent(in) :: method
      integer(i8), intent(in) :: steps
      type(poinsot_error), intent(inout) :: error
      real(dp) :: y(lanes, 3), q(lanes, 4), seconds(repeats), unit
      real(qp) :: ye(3), qe(4)
      character(120) :: line
      integer :: r, j
      logical :: good
      do r = 1, repeats
         do j = 1, 3
            y(:, j) = y0(j)
         end do
         q = 0
         q(:, 1) = 1
         call run_block(bodies(:, body), method, t_end/real(steps, dp), steps, y, q, good, &
            seconds(r), error)
         if (raised(error) .or. .not. good) return
      end do
      call turn_freely(bodies(:, body), y0, [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], t_end, ye, qe)
      unit = median(seconds)/lanes
      write (line, "(i0, ',', a, ',', i0, 5(',', es11.4e3))") body, method, steps, &
         t_end/real(steps, dp), &
         real(norm2(real(y(1, :), qp) - ye)/norm2(ye), dp), attitude_error(real(q(1, :), qp), qe), &
         1e9_dp*unit/real(steps, dp), 1e6_dp*unit
      call put(file, trim(line), error)
   end subroutine one_run

   !> Left the first body, right the second; error of the attitude against time of the run.
   subroutine write_plot(out, error)
      character(*), intent(in) :: out
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(:), allocatable :: line
      integer :: m, body
      call open_out(out // "/plot_hairer-vilmart.gp", file, error)
      if (raised(error)) return
      call put_terminals(file, "hairer-vilmart", 960, 470, error)
      call put_lines(file, [character(110) :: "file = 'hairer-vilmart.csv'", &
         "set multiplot", "set logscale xy; set format x '10^{%T}'; set format y '10^{%T}'", &
         "set border 3; set tics nomirror out; unset key; set grid lc rgb '#ececec' lt 1 lw 0.7", &
         "set xrange [0.05:3000]; set yrange [1e-16:10]", "set tmargin 2.5; set bmargin 3.5", &
         "set xlabel 'time of the run to t = 10, microseconds'"], error)
      do body = 1, 2
         call put(file, "unset label", error)
         if (body == 1) then
            call put(file, "set lmargin at screen 0.085; set rmargin at screen 0.48", error)
            call put(file, "set ylabel 'error in attitude, radians'", error)
            call put(file, "set label 'moments 0.6, 0.8, 1' at graph 0, graph 1.05 font ',13'", &
               error)
         else
            call put(file, &
               "set lmargin at screen 0.575; set rmargin at screen 0.97; unset ylabel", error)
            call put(file, &
               "set label 'moments 0.345, 0.653, 1' at graph 0, graph 1.05 font ',13'", error)
         end if
         do m = 1, size(methods)
            call put(file, "n = 0; stats file skip 1 using (stringcolumn(1) eq '" // &
               text_of(body) // &
                     "' && stringcolumn(2) eq '" // trim(methods(m)) // &
                        "' ? (n = n + 1, n == 1 ? (first_x = $8, " // &
                     "first_y = $6) : 0, last_x = $8, last_y = $6, 1) : NaN) nooutput", error)
            call put(file, "set label '" // trim(methods(m)) // "' at " // label_place(m) // &
               " tc rgb '" // &
                     strong_colour(m) // "' font ',10' front", error)
         end do
         line = "plot "
         do m = 1, size(methods)
            call put(file, line // "file skip 1 using (stringcolumn(1) eq '" // text_of(body) // &
                     "' && stringcolumn(2) eq '" // trim(methods(m)) // &
                        "' ? $8 : NaN):6 with linespoints pt " // &
                     text_of(strong_point(m)) // " ps 0.6 lw 1.4 lc rgb '" // strong_colour(m) // &
                        "', \", error)
            line = "   "
         end do
         call put(file, "   NaN notitle", error)
      end do
      call put(file, "unset multiplot", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_plot

   !> Names of order 2 stand at the last point of their curves, others at the first.
   function label_place(m) result(text)
      integer, intent(in) :: m
      character(:), allocatable :: text
      text = "first_x*0.8, first_y right"
      select case (methods(m))
      case ("dmv2")
         text = "last_x*1.3, last_y*4"
      case ("midpoint")
         text = "last_x*1.3, last_y*1.2"
      case ("three-rotations")
         text = "last_x*1.3, last_y*0.5"
      case default
         return
      end select
   end function label_place

end module poinsot_study_repeat_hairer
