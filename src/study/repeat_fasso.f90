!> F. Fasso, Comparison of splitting algorithms for the rigid body, J. Comput. Phys. 189 (2003) 527:
!> methods of one order differ by orders of magnitude with the body. Its conclusion as a map of the
!> error over the triangle of all bodies, for each method.
module poinsot_study_repeat_fasso
   use poinsot_core_kinds, only: dp, i8, lanes, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_rotation_random, only: random_direction
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_plots_common, only: put_lines, put_end
   use poinsot_scene_text, only: text_of
   use poinsot_study_errors, only: attitude_error
   use poinsot_study_free_trial, only: run_block
   use poinsot_study_plots, only: put_terminals
   use poinsot_study_statistics, only: median
   implicit none(type, external)
   private
   public :: repeat_fasso

   character(20), parameter :: methods(6) = [character(20) :: "three-rotations", &
      "symmetric-rotation", "midpoint", &
                                             "dmv2", "dmv4", "dmv6"]
   integer, parameter :: side = 48          !! cells along an edge of the triangle
   real(dp), parameter :: turns = 10        !! angle through which bodies turn, radians
   real(dp), parameter :: phase = 0.1_dp    !! h |omega|

contains

   !> Measure, write fasso.csv and its picture into a folder that is there. Error: POINSOT_E_IO.
   subroutine repeat_fasso(out, error)
      character(*), intent(in) :: out
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      integer :: i, j, up
      call open_out(out // "/fasso.csv", file, error)
      call put(file, "x,y,I1,I2,I3," // columns(), error)
      do i = 0, side - 1
         do j = 0, side - 1 - i
            do up = 0, merge(1, 0, i + j < side - 1)
               if (.not. raised(error)) call one_body(file, i, j, up, error)
            end do
         end do
      end do
      call finish_out(file, error)
      if (.not. raised(error)) call write_plot(out, error)
   end subroutine repeat_fasso

   function columns() result(text)
      character(:), allocatable :: text
      integer :: m
      text = trim(methods(1))
      do m = 2, size(methods)
         text = text // "," // trim(methods(m))
      end do
   end function columns

   !> The body at the middle of a small triangle: parts a, b, c of its mass along the axes, so that
   !> its moments are b + c, c + a, a + b; all bodies are such. |y| is such that |omega| is about 1.
   subroutine one_body(file, i, j, up, error)
      type(out_file), intent(in) :: file
      integer, intent(in) :: i, j, up
      type(poinsot_error), intent(inout) :: error
      real(dp) :: part(3), moments(3), y0(lanes, 3), y(lanes, 3), q(lanes, 4), ye(lanes, 3), &
         qe(lanes, 4)
      real(dp) :: angle(lanes), speed, h, seconds
      character(300) :: line
      integer :: m, l
      integer(i8) :: steps
      logical :: good
      part(1) = (i + merge(2, 1, up == 1)/3.0_dp)/side
      part(2) = (j + merge(2, 1, up == 1)/3.0_dp)/side
      part(3) = 1 - part(1) - part(2)
      moments = 1 - part
      do l = 1, lanes
         y0(l, :) = random_direction(7_i8, int(l, i8))
      end do
      speed = 0
      do l = 1, lanes
         speed = speed + norm2(y0(l, :)/moments)/lanes
      end do
      steps = nint(turns/phase, i8)
      h = phase/speed
      ye = y0
      qe = 0
      qe(:, 1) = 1
      call run_block(moments, "exact", h*real(steps, dp), 1_i8, ye, qe, good, seconds, error)
      write (line, "(es13.6, 4(',', es13.6))") part(2) + 0.5_dp*part(3), sqrt(0.75_dp)*part(3), &
         moments
      do m = 1, size(methods)
         y = y0
         q = 0
         q(:, 1) = 1
         call run_block(moments, trim(methods(m)), h, steps, y, q, good, seconds, error)
         if (raised(error)) return
         do l = 1, lanes
            angle(l) = attitude_error(real(q(l, :), qp), real(qe(l, :), qp)/norm2(real(qe(l, :), &
               qp)))
         end do
         if (.not. good) angle = 1
         write (line(len_trim(line) + 1:), "(',', es11.4e3)") max(median(angle), 1e-17_dp)
      end do
      call put(file, trim(line), error)
   end subroutine one_body

   !> Six triangles of one scale.
   subroutine write_plot(out, error)
      character(*), intent(in) :: out
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      integer :: m
      call open_out(out // "/plot_fasso.gp", file, error)
      if (raised(error)) return
      call put_terminals(file, "fasso", 960, 600, error)
      call put_lines(file, [character(130) :: "file = 'fasso.csv'", &
         "set multiplot", "unset key; unset border; unset tics; set size ratio -1", &
         "set lmargin 0; set rmargin 0; set tmargin 0; set bmargin 0", &
         "set xrange [-0.06:1.06]; set yrange [-0.12:1.02]", "set cbrange [-9:-1]", &
         "# one hue from pale to dark: grey paper and all eyes see the same order", &
         "set palette defined (0 '#f7f4e8', 1 '#d9d3a4', 2 '#9fbf8f', 3 '#5aa08c', " // &
         "4 '#2f7d86', 5 '#245778', " // &
         "6 '#1f3358', 7 '#140f26')", &
         "unset colorbox; set format cb '10^{%.0f}'; set cbtics -9,2,-1", &
         "set object 1 polygon from 0,0 to 1,0 to 0.5,0.8660254 to 0,0 fs empty " // &
         "border rgb '#7d7d7d' lw 1"], error)
      do m = 1, size(methods)
         call put(file, "set origin " // text_of(0.0_dp + 0.285_dp*mod(m - 1, 3)) // "," // &
                  text_of(merge(0.5_dp, 0.0_dp, m <= 3)) // "; set size 0.285,0.5", error)
         call put(file, "unset label", error)
         call put(file, "set label '" // trim(methods(m)) // "' at 0.5,0.96 center font ',13'", &
            error)
         call put_lines(file, [character(130) :: &
            "set label 'all mass on axis 1' at -0.02,-0.06 left font ',8' tc rgb '#505050'", &
            "set label 'on axis 2' at 1.02,-0.06 right font ',8' tc rgb '#505050'", &
            "set label 'axis 3' at 0.56,0.86 left font ',8' tc rgb '#505050'"], error)
         if (m == 1) then
            call put_lines(file, [character(130) :: &
               "# moments in ratio 1 : 3/4 : 1/4: mass 0, 1/4, 3/4 along the axes", &
               "set label 'moments 1, 3/4, 1/4' at 0.74,0.8 left font ',9' tc rgb '#a03000'", &
               "set arrow 1 from 0.8,0.77 to 0.645,0.66 lc rgb '#a03000' lw 1.2 front"], error)
         else
            call put(file, "unset arrow 1", error)
         end if
         if (m == size(methods)) call put_lines(file, [character(130) :: &
            "set colorbox vertical user origin 0.905,0.15 size 0.02,0.7", &
            "set cblabel 'error in attitude after 10 radians, h|omega| = 0.1'"], error)
         call put(file, "plot file skip 1 using 1:2:(log10($" // text_of(5 + m) // &
                  ")) with points pt 7 ps 0.62 lc palette", error)
      end do
      call put_lines(file, [character(130) :: &
         "unset multiplot; unset label; unset object 1; unset arrow 1"], error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_plot

end module poinsot_study_repeat_fasso
