!> Pictures of a cost study, as gnuplot scripts over cost.csv: work against precision for attitude
!> and for momentum with the efficient frontier named, and error against step.
module poinsot_study_cost_plots
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_plots_common, only: put_lines, put_end
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_text, only: text_of
   use poinsot_study_candidates, only: label_of
   use poinsot_study_cost, only: cost_study
   use poinsot_study_cost_point, only: cost_point, middle, of_angle, of_momentum, error_of
   use poinsot_study_efficient, only: frontier_part, frontier_parts, frontier_line
   use poinsot_study_labels, only: label_list, axis, place_label, place_along, take_point, &
      fraction_of
   use poinsot_study_rivals, only: rival_point, rival_names
   use poinsot_study_plots, only: put_terminals, strong, strong_colour, strong_point, nice_below, &
      nice_above, either
   implicit none(type, external)
   private
   public :: write_cost_plots

   character(24), parameter, public :: cost_pictures(4) = [character(24) :: "attitude_cost", &
      "momentum_cost", &
                                                           "attitude_step", "energy_drift"]
   integer, parameter :: few = 24              !! so many curves are all named
   real(dp), parameter :: least_shown = 1e-17_dp

contains

   !> All scripts. Error: POINSOT_E_IO.
   subroutine write_cost_plots(out, scene, study, error)
      character(*), intent(in) :: out           !! folder of cost.csv
      type(scene_settings), intent(in) :: scene
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      call write_work(out, "attitude_cost", scene, study, of_angle, error)
      call write_work(out, "momentum_cost", scene, study, of_momentum, error)
      call write_steps(out, "attitude_step", scene, study, error)
      if (study%conserves) call write_drift(out, "energy_drift", scene, study, error)
   end subroutine write_cost_plots

   !> Work against precision.
   subroutine write_work(out, name, scene, study, what, error)
      character(*), intent(in) :: out, name
      type(scene_settings), intent(in) :: scene
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      type(label_list) :: labels
      type(axis) :: x, y
      type(frontier_part), allocatable :: parts(:)
      integer, allocatable :: chosen(:), shown(:)
      character(:), allocatable :: columns, plot
      integer :: i, k, rivals
      if (raised(error)) return
      call open_out(out // "/plot_" // name // ".gp", file, error)
      if (raised(error)) return
      call put_front(file, study, what, error)
      call put_rivals(file, study, what, rivals, error)
      call put_terminals(file, name, 820, 560, error)
      call work_axes(study, what, x, y)
      call frontier_parts(study%points, size(study%candidates), what, parts)
      call front_candidates(parts, chosen)
      columns = "($27 > 0 ? ($" // text_of(merge(7, 10, what == of_angle)) // " > 1e-17 ? $" // &
                text_of(merge(7, 10, what == of_angle)) // " : 1e-17) : NaN):25"
      call put_lines(file, [character(100) :: "file = 'cost.csv'", &
         "set logscale xy; set format x '10^{%T}'; set format y '10^{%T}'", &
         "set border 3; set tics nomirror out; unset key", &
         "set grid lc rgb '#ececec' lt 1 lw 0.7; set tmargin 3; set rmargin 3", &
         "unset mxtics"], error)
      call put(file, "set xrange [" // text_of(x%from) // ":" // text_of(x%to) // &
         "]; set yrange [" // &
               text_of(y%from) // ":" // text_of(y%to) // "]", error)
      call put(file, "set xlabel 'error in " // either("attitude, radians", &
                                                   "momentum, relative to |y|", &
                                                      what == of_angle) // &
               ", at t = " // short_time(study%t_end) // " (median of " // &
                  text_of(study%members%n) // &
               " initial states; bars: to the worst)'", error)
      call put(file, "set ylabel 'time, ns per body and unit of simulated time'", error)
      call put(file, "set label '" // trim(scene%name) // &
         ": what accuracy costs' at graph 0, graph 1.05 font ',14'", &
               error)
      call put(file, &
         "set label 'band: our fastest for each accuracy' at graph 1, graph 1.05" // &
               " right tc rgb '#707070' font ',10'", error)
      shown = chosen
      if (size(study%candidates) <= few) shown = [(i, i=1, size(study%candidates))]
      call take_points(study, what, shown, x, y, labels)
      do k = 1, size(chosen)
         i = findloc(parts%candidate, chosen(k), 1)
         call put_label(file, study, what, chosen(k), parts(i)%point, x, y, strong_colour(k), &
            .true., labels, error)
      end do
      if (size(study%candidates) <= few) then
         do i = 1, size(study%candidates)
            if (.not. any(chosen == i)) call name_curve(file, study, what, i, x, y, labels, error)
         end do
      end if
      call name_rivals(file, study, what, x, y, labels, error)
      plot = "plot $front using 1:2 with lines lw 11 lc rgb '#dbe4ee', "
      do i = 1, size(study%candidates)
         if (any(chosen == i) .or. .not. any(study%points%candidate == i)) cycle
         call put(file, plot // rows(study, i) // " using " // columns // &
                  " with lines lw 0.6 lc rgb '#c9c9c9', \", error)
         plot = "   "
      end do
      do k = 1, rivals
         call put(file, plot // "$rivals index " // text_of(k - 1) // &
                  " using 1:2 with linespoints dt 2 pt 2 ps 0.5 lw 1.3 lc rgb '#555555', \", error)
         plot = "   "
      end do
      do k = 1, size(chosen)
         call put(file, plot // rows(study, chosen(k)) // " using ($27 > 0 && $" // &
                  text_of(merge(28, 29, what == of_angle)) // " > 0 ? $" // text_of(merge(7, 10, &
                     what == of_angle)) // &
                  " : NaN):25:" // text_of(merge(7, 10, what == of_angle)) // ":" // &
                  text_of(merge(8, 11, what == of_angle)) // &
                     " with xerrorbars pt 0 lw 0.8 lc rgb '" // &
                  strong_colour(k) // "', \", error)
         plot = "   "
         call put(file, plot // rows(study, chosen(k)) // " using " // columns // &
            " with linespoints pt " // &
                  text_of(strong_point(k)) // " ps 0.7 lw 1.8 lc rgb '" // strong_colour(k) // &
                     "', \", error)
      end do
      call put(file, "   NaN notitle", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_work

   !> "10" rather than "10.0".
   pure function short_time(t) result(text)
      real(dp), intent(in) :: t
      character(:), allocatable :: text
      text = text_of(t)
      if (len(text) > 2) then
         if (text(len(text) - 1:) == ".0") text = text(:len(text) - 2)
      end if
   end function short_time

   !> Lines of cost.csv that a candidate has, as gnuplot reads them.
   pure function rows(study, candidate) result(text)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: candidate
      character(:), allocatable :: text
      integer :: i, first, last
      first = 0
      last = 0
      do i = 1, size(study%points)
         if (study%points(i)%candidate /= candidate) cycle
         if (first == 0) first = i
         last = i
      end do
      text = "file skip 1 every ::" // text_of(first - 1) // "::" // text_of(last - 1)
   end function rows

   !> The frontier itself, as data in the script.
   subroutine put_front(file, study, what, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: line(:, :)
      character(40) :: row
      integer :: i
      call frontier_line(study%points, what, line)
      call put(file, "$front << EOD", error)
      do i = 1, size(line, 2)
         write (row, "(es12.5e3, ',', es12.5e3)") line(:, i)
         call put(file, row, error)
      end do
      call put(file, "EOD", error)
   end subroutine put_front

   !> Rivals as data in the script, one block each.
   subroutine put_rivals(file, study, what, rivals, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what
      integer, intent(out) :: rivals              !! how many
      type(poinsot_error), intent(inout) :: error
      character(32), allocatable :: names(:)
      character(40) :: row
      integer :: i, k
      call rival_names(study%rivals, names)
      rivals = size(names)
      if (rivals == 0) return
      call put(file, "$rivals << EOD", error)
      do k = 1, rivals
         if (k > 1) call put(file, "", error)
         if (k > 1) call put(file, "", error)
         do i = 1, size(study%rivals)
            if (study%rivals(i)%name /= names(k)) cycle
            write (row, "(es12.5e3, ',', es12.5e3)") rival_error(study%rivals(i), what), &
               study%rivals(i)%time
            call put(file, row, error)
         end do
      end do
      call put(file, "EOD", error)
   end subroutine put_rivals

   !> Names of rivals, each at the most accurate point it has in the picture.
   subroutine name_rivals(file, study, what, x, y, labels, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what
      type(axis), intent(in) :: x, y
      type(label_list), intent(inout) :: labels
      type(poinsot_error), intent(inout) :: error
      character(32), allocatable :: names(:)
      real(dp), allocatable :: px(:), py(:)
      real(dp) :: off, up
      integer :: i, k
      call rival_names(study%rivals, names)
      do k = 1, size(names)
         if (allocated(px)) deallocate (px, py)
         allocate (px(0), py(0))
         do i = 1, size(study%rivals)
            if (study%rivals(i)%name /= names(k)) cycle
            off = fraction_of(x, max(rival_error(study%rivals(i), what), least_shown))
            up = fraction_of(y, study%rivals(i)%time)
            call take_point(labels, off, up, 1000 + k)
            if (off < 0.1_dp .or. up > 1) cycle
            px = [px, off]
            py = [py, up]
         end do
         if (size(px) == 0) cycle
         call place_along(labels, px, py, len_trim(names(k)), off, up)
         call put(file, "set label '{/:Italic " // trim(names(k)) // "}' at " // graph_place(off, &
            up) // &
                  " tc rgb '#404040' font ',10' front", error)
      end do
   end subroutine name_rivals

   !> A place as gnuplot reads it.
   pure function graph_place(x, y) result(text)
      real(dp), intent(in) :: x, y        !! fractions of the picture
      character(32) :: text
      write (text, "('graph ', f7.4, ', graph ', f7.4)") x, y
   end function graph_place

   !> The error of a rival that the picture is about.
   pure real(dp) function rival_error(point, what)
      type(rival_point), intent(in) :: point
      integer, intent(in) :: what
      rival_error = merge(point%angle(1), point%momentum(1), what == of_angle)
   end function rival_error

   !> Ranges that hold all good points.
   pure subroutine work_axes(study, what, x, y)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what
      type(axis), intent(out) :: x, y
      real(dp) :: least(2), most(2), off, time
      integer :: i
      least = huge(least)
      most = 0
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (.not. p%good .or. .not. p%ns > 0) cycle
            off = max(error_of(p, what, middle), least_shown)
            time = p%ns/p%h
            if (off > 1) cycle
            least = min(least, [off, time])
            most = max(most, [off, time])
         end associate
      end do
      do i = 1, size(study%rivals)
         if (rival_error(study%rivals(i), what) > 0.1_dp) cycle
         least(2) = min(least(2), study%rivals(i)%time)
         most(2) = min(max(most(2), study%rivals(i)%time), 1e3_dp*least(2)*100)
      end do
      if (least(1) > most(1)) least = 1e-16_dp
      if (.not. most(1) > 0) most = 1
      x = axis(nice_above(most(1)), nice_below(least(1))/3) ! accuracy grows to the right
      y = axis(nice_below(least(2)), nice_above(most(2)))
   end subroutine work_axes

   !> Candidates on the frontier, from coarse to fine, each once.
   pure subroutine front_candidates(parts, chosen)
      type(frontier_part), intent(in) :: parts(:)
      integer, allocatable, intent(out) :: chosen(:)
      integer :: i
      allocate (chosen(0))
      do i = 1, size(parts)
         if (any(chosen == parts(i)%candidate) .or. size(chosen) == strong) cycle
         chosen = [chosen, parts(i)%candidate]
      end do
   end subroutine front_candidates

   !> Points that labels should not lie on.
   subroutine take_points(study, what, chosen, x, y, labels)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: chosen(:)
      integer, intent(in) :: what
      type(axis), intent(in) :: x, y
      type(label_list), intent(inout) :: labels
      integer :: i
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (.not. p%good .or. .not. p%ns > 0 .or. .not. any(chosen == p%candidate)) cycle
            call take_point(labels, fraction_of(x, max(error_of(p, what, middle), least_shown)), &
                            fraction_of(y, p%ns/p%h), p%candidate)
         end associate
      end do
   end subroutine take_points

   !> Name any other curve, wherever along it there is room.
   subroutine name_curve(file, study, what, candidate, x, y, labels, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what, candidate
      type(axis), intent(in) :: x, y
      type(label_list), intent(inout) :: labels
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: px(:), py(:)
      character(:), allocatable :: text
      integer :: i
      allocate (px(0), py(0))
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (p%candidate /= candidate .or. .not. p%good .or. .not. p%ns > 0) cycle
            if (error_of(p, what, middle) > 0.3_dp) cycle
            px = [px, fraction_of(x, max(error_of(p, what, middle), least_shown))]
            py = [py, fraction_of(y, p%ns/p%h)]
         end associate
      end do
      text = label_of(study%candidates(candidate))
      if (size(px) > 0) call write_label(file, text, px, py, "#707070", labels, error)
   end subroutine name_curve

   !> A name somewhere along a curve.
   subroutine write_label(file, text, px, py, colour, labels, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: text, colour
      real(dp), intent(in) :: px(:), py(:)
      type(label_list), intent(inout) :: labels
      type(poinsot_error), intent(inout) :: error
      real(dp) :: to_x, to_y
      call place_along(labels, px, py, len(text), to_x, to_y)
      call put(file, "set label '" // text // "' at " // graph_place(to_x, to_y) // " tc rgb '" // &
         colour // &
               "' font ',10' front", error)
   end subroutine write_label

   subroutine put_label(file, study, what, candidate, at, x, y, colour, bold, labels, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what, candidate, at
      type(axis), intent(in) :: x, y
      character(*), intent(in) :: colour
      logical, intent(in) :: bold
      type(label_list), intent(inout) :: labels
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: text
      real(dp) :: to_x, to_y
      text = label_of(study%candidates(candidate))
      associate (p => study%points(at))
         call place_label(labels, fraction_of(x, max(error_of(p, what, middle), least_shown)), &
                          fraction_of(y, p%ns/p%h), len(text) + merge(2, 0, bold), to_x, to_y)
      end associate
      if (bold) text = "{/:Bold " // text // "}"
      call put(file, "set label '" // text // "' at " // graph_place(to_x, to_y) // " tc rgb '" // &
         colour // &
               "' font ',10' front", error)
   end subroutine put_label

   !> Error against step.
   subroutine write_steps(out, name, scene, study, error)
      character(*), intent(in) :: out, name
      type(scene_settings), intent(in) :: scene
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      type(label_list) :: labels
      type(axis) :: x, y
      character(:), allocatable :: plot
      integer :: i, k
      logical :: shown(size(study%candidates))
      if (raised(error)) return
      call open_out(out // "/plot_" // name // ".gp", file, error)
      if (raised(error)) return
      call put_terminals(file, name, 820, 560, error)
      shown = .true.
      if (size(study%candidates) > few) shown = study%candidates%method == "exact"
      call step_axes(study, shown, x, y)
      call put_lines(file, [character(100) :: "file = 'cost.csv'", &
         "set logscale xy; set format x '10^{%T}'; set format y '10^{%T}'", &
         "set border 3; set tics nomirror out; unset key", &
         "set grid lc rgb '#ececec' lt 1 lw 0.7; set tmargin 3; set rmargin 3"], error)
      call put(file, "set xrange [" // text_of(x%from) // ":" // text_of(x%to) // &
         "]; set yrange [" // &
               text_of(y%from) // ":" // text_of(y%to) // "]", error)
      call put(file, "set xlabel 'step h'; set ylabel 'error in attitude, radians, at t = " // &
               short_time(study%t_end) // "'", error)
      call put(file, "set label '" // trim(scene%name) // &
         ": error against step, with the slope of each curve" // &
               either("", " (exact rotation)", all(shown)) // &
                  "' at graph 0, graph 1.05 font ',14'", error)
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (.not. p%good .or. .not. shown(p%candidate)) cycle
            call take_point(labels, fraction_of(x, p%h), fraction_of(y, max(p%angle(middle), &
               least_shown)), p%candidate)
         end associate
      end do
      plot = "plot "
      k = 0
      do i = 1, size(study%candidates)
         if (.not. shown(i) .or. .not. any(study%points%candidate == i)) cycle
         k = k + 1
         call name_slope(file, study, i, k, x, y, labels, error)
      end do
      k = 0
      do i = 1, size(study%candidates)
         if (.not. shown(i) .or. .not. any(study%points%candidate == i)) cycle
         k = k + 1
         call put(file, plot // rows(study, i) // &
            " using 6:($27 > 0 ? ($7 > 1e-17 ? $7 : 1e-17) : NaN) " // &
                  "with linespoints pt " // text_of(strong_point(k)) // &
                     " ps 0.5 lw 1.4 lc rgb '" // strong_colour(k) // &
                  "', \", error)
         plot = "   "
      end do
      call put(file, "   NaN notitle", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_steps

   pure subroutine step_axes(study, shown, x, y)
      type(cost_study), intent(in) :: study
      logical, intent(in) :: shown(:)
      type(axis), intent(out) :: x, y
      real(dp) :: least(2), most(2)
      integer :: i
      least = huge(least)
      most = 0
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (.not. p%good .or. .not. shown(p%candidate)) cycle
            least = min(least, [p%h, max(p%angle(middle), least_shown)])
            most = max(most, [p%h, p%angle(middle)])
         end associate
      end do
      if (.not. most(1) > 0) most = 1
      if (least(1) > most(1)) least = 1e-3_dp
      x = axis(nice_below(least(1)), nice_above(most(1)))
      y = axis(nice_below(least(2)), nice_above(most(2)))
   end subroutine step_axes

   !> A curve's name and the slope between its last points clear of rounding.
   subroutine name_slope(file, study, candidate, k, x, y, labels, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      integer, intent(in) :: candidate, k
      type(axis), intent(in) :: x, y
      type(label_list), intent(inout) :: labels
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: text
      character(8) :: number
      real(dp), allocatable :: px(:), py(:)
      real(dp) :: slope
      integer :: i, at, before
      at = 0
      before = 0
      allocate (px(0), py(0))
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (p%candidate /= candidate .or. .not. p%good) cycle
            px = [px, fraction_of(x, p%h)]
            py = [py, fraction_of(y, max(p%angle(middle), least_shown))]
            if (p%angle(middle) > 0.03_dp .or. p%angle(middle) < 3e-13_dp) cycle
            before = at
            at = i
         end associate
      end do
      if (size(px) == 0) return
      text = label_of(study%candidates(candidate))
      if (index(text, "exact + ") == 1) text = text(9:)
      if (before > 0 .and. study%candidates(candidate)%order > 0) then
         slope = log(study%points(at)%angle(middle)/study%points(before)%angle(middle))/ &
                 log(study%points(at)%h/study%points(before)%h)
         write (number, "(f6.1)") slope
         text = text // "  " // trim(adjustl(number))
      end if
      call write_label(file, text, px, py, strong_colour(k), labels, error)
   end subroutine name_slope

   !> Error of the energy against time.
   subroutine write_drift(out, name, scene, study, error)
      character(*), intent(in) :: out, name
      type(scene_settings), intent(in) :: scene
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      type(label_list) :: labels
      type(axis) :: x, y
      character(:), allocatable :: plot
      real(dp) :: to_x, to_y
      integer :: i, k, from
      if (raised(error) .or. size(study%drift) == 0) return
      call open_out(out // "/plot_" // name // ".gp", file, error)
      if (raised(error)) return
      call put_terminals(file, name, 820, 560, error)
      x = axis(nice_below(minval(study%drift%t)), nice_above(maxval(study%drift%t)))
      y = axis(nice_below(max(minval(study%drift%median), least_shown)), &
         nice_above(10*maxval(study%drift%median)))
      x%to = x%to*(x%to/x%from)**0.4_dp ! room for names
      call put_lines(file, [character(100) :: "file = 'drift.csv'", &
         "set logscale xy; set format x '10^{%T}'; set format y '10^{%T}'", &
         "set border 3; set tics nomirror out; unset key; set tmargin 3; set rmargin 3", &
         "set grid lc rgb '#ececec' lt 1 lw 0.7", &
         "set xlabel 't'; set ylabel 'largest error of the energy so far, relative (median)'"], &
         error)
      call put(file, "set xrange [" // text_of(x%from) // ":" // text_of(x%to) // &
         "]; set yrange [" // &
               text_of(y%from) // ":" // text_of(y%to) // "]", error)
      call put(file, "set label '" // trim(scene%name) // &
         ": energy in long runs' at graph 0, graph 1.05 font ',14'", &
               error)
      do i = 1, size(study%drift)
         call take_point(labels, fraction_of(x, study%drift(i)%t), fraction_of(y, &
            max(study%drift(i)%median, least_shown)))
      end do
      plot = "plot "
      k = 0
      do from = 1, size(study%drift)
         if (from > 1) then
            if (study%drift(from - 1)%candidate == study%drift(from)%candidate) cycle
         end if
         i = from
         do while (i < size(study%drift))
            if (study%drift(i + 1)%candidate /= study%drift(from)%candidate) exit
            i = i + 1
         end do
         k = k + 1
         associate (r => study%drift(i))
            call place_label(labels, fraction_of(x, r%t), fraction_of(y, max(r%median, &
               least_shown)), &
                             len(label_of(study%candidates(r%candidate))) + 12, to_x, to_y)
                  call put(file, "set label '" // label_of(study%candidates(r%candidate)) // &
                     ", h = " // &
                     three_digits(r%h) // "' at " // graph_place(to_x, to_y) // " tc rgb '" // &
                        strong_colour(k) // "' font ',10'", error)
         end associate
      end do
      k = 0
      do from = 1, size(study%drift)
         if (from > 1) then
            if (study%drift(from - 1)%candidate == study%drift(from)%candidate) cycle
         end if
         i = count(study%drift%candidate == study%drift(from)%candidate)
         k = k + 1
         call put(file, plot // "file skip 1 every ::" // text_of(from - 1) // "::" // &
            text_of(from + i - 2) // &
                  " using 4:($5 > 1e-17 ? $5 : 1e-17) with linespoints pt " // &
                     text_of(strong_point(k)) // &
                  " ps 0.5 lw 1.6 lc rgb '" // strong_colour(k) // "', \", error)
         plot = "   "
      end do
      call put(file, "   NaN notitle", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_drift

   !> A number in three digits.
   pure function three_digits(x) result(text)
      real(dp), intent(in) :: x
      character(:), allocatable :: text
      character(16) :: buffer
      write (buffer, "(es9.2e2)") x
      if (x >= 1e-3_dp .and. x < 1000) write (buffer, "(f8.4)") x
      text = trim(adjustl(buffer))
      if (index(text, "E") > 0) return
      do while (text(len(text):) == "0")
         text = text(:len(text) - 1)
      end do
   end function three_digits

end module poinsot_study_cost_plots
