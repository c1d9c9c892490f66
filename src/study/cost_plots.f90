!> Pictures of a cost study, as gnuplot scripts over cost.csv: work against precision for attitude and
!> for momentum with the efficient frontier named, and error against step.
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
   use poinsot_study_labels, only: label_list, axis, place_label, fraction_of
   use poinsot_study_plots, only: put_terminals, strong, strong_colour, strong_point, nice_below, nice_above, either
   implicit none(type, external)
   private
   public :: write_cost_plots

   character(24), parameter, public :: cost_pictures(3) = [character(24) :: "attitude_cost", "momentum_cost", &
                                                           "attitude_step"]
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
      integer, allocatable :: chosen(:)
      character(:), allocatable :: columns, plot
      integer :: i, k
      if (raised(error)) return
      call open_out(out // "/plot_" // name // ".gp", file, error)
      if (raised(error)) return
      call put_terminals(file, name, 820, 560, error)
      call work_axes(study, what, x, y)
      call front_candidates(study, what, chosen)
      columns = "($27 > 0 ? ($" // text_of(merge(7, 10, what == of_angle)) // " > 1e-17 ? $" // &
                text_of(merge(7, 10, what == of_angle)) // " : 1e-17) : NaN):25"
      call put_lines(file, [character(100) :: "file = 'cost.csv'", &
         "set logscale xy; set format x '10^{%T}'; set format y '10^{%T}'", &
         "set border 3; set tics nomirror out; unset key", &
         "set grid lc rgb '#ececec' lt 1 lw 0.7; set bmargin 4.5; set rmargin 3"], error)
      call put(file, "set xrange [" // text_of(x%from) // ":" // text_of(x%to) // "]; set yrange [" // &
               text_of(y%from) // ":" // text_of(y%to) // "]", error)
      call put(file, "set xlabel 'error in " // either("attitude, radians", &
                                                   "momentum, relative to |y|", what == of_angle) // &
               ", at t = " // short_time(study%t_end) // " (median of " // text_of(study%members%n) // &
               " initial states; bars: to the worst)'", error)
      call put(file, "set ylabel 'time, ns per body and unit of simulated time'", error)
      call put(file, "set title '" // trim(scene%name) // ": what accuracy costs' left font ',14'", error)
      call take_points(study, what, x, y, labels)
      do k = 1, size(chosen)
         call name_front(file, study, what, chosen(k), k, x, y, labels, error)
      end do
      if (size(study%candidates) <= few) then
         do i = 1, size(study%candidates)
            if (.not. any(chosen == i)) call name_curve(file, study, what, i, x, y, labels, error)
         end do
      end if
      plot = "plot "
      do i = 1, size(study%candidates)
         if (any(chosen == i) .or. .not. any(study%points%candidate == i)) cycle
         call put(file, plot // rows(study, i) // " using " // columns // &
                  " with linespoints pt 7 ps 0.22 lw 0.8 lc rgb '#b8b8b8', \", error)
         plot = "   "
      end do
      do k = 1, size(chosen)
         call put(file, plot // rows(study, chosen(k)) // " using ($27 > 0 && $" // &
                  text_of(merge(28, 29, what == of_angle)) // " > 0 ? $" // text_of(merge(7, 10, what == of_angle)) // &
                  " : NaN):25:" // text_of(merge(7, 10, what == of_angle)) // ":" // &
                  text_of(merge(8, 11, what == of_angle)) // " with xerrorbars pt 0 lw 0.8 lc rgb '" // &
                  strong_colour(k) // "', \", error)
         plot = "   "
         call put(file, plot // rows(study, chosen(k)) // " using " // columns // " with linespoints pt " // &
                  text_of(strong_point(k)) // " ps 0.7 lw 1.8 lc rgb '" // strong_colour(k) // "', \", error)
      end do
      call put_front(file, study, what, error)
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

   !> The frontier itself, in the order of accuracy: a pale band under everything would hide nothing,
   !> a thin dark line over it shows the steps.
   subroutine put_front(file, study, what, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what
      type(poinsot_error), intent(inout) :: error
      call put(file, "   file skip 1 using ($27 > 0 && $" // text_of(merge(28, 29, what == of_angle)) // &
               " > 0 ? ($" // text_of(merge(7, 10, what == of_angle)) // " > 1e-17 ? $" // &
               text_of(merge(7, 10, what == of_angle)) // " : 1e-17) : NaN):25 smooth unique " // &
               "with lines lw 5 lc rgb '#55000000'", error)
      associate (unused => study%t_end)
      end associate
   end subroutine put_front

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
      if (least(1) > most(1)) least = 1e-16_dp
      if (.not. most(1) > 0) most = 1
      x = axis(nice_above(most(1)), nice_below(least(1))/3) ! accuracy grows to the right
      y = axis(nice_below(least(2)), nice_above(most(2)))
   end subroutine work_axes

   !> Candidates on the frontier, from coarse to fine; those that matter most if they are many.
   pure subroutine front_candidates(study, what, chosen)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what
      integer, allocatable, intent(out) :: chosen(:)
      real(dp) :: share(size(study%candidates)), place(size(study%candidates)), last
      integer :: i, k, n, best
      share = 0
      place = 0
      do i = 1, size(study%candidates)
         n = 0
         do k = 1, size(study%points)
            associate (p => study%points(k))
               if (p%candidate /= i .or. .not. p%front(what)) cycle
               if (error_of(p, what, middle) > 0.3_dp) cycle
               n = n + 1
               place(i) = place(i) + log(max(error_of(p, what, middle), least_shown))
            end associate
         end do
         share(i) = n
         if (n > 0) place(i) = place(i)/n
      end do
      do while (count(share > 0) > strong)
         share(minloc(share, mask=share > 0)) = 0
      end do
      allocate (chosen(count(share > 0)))
      last = huge(last)
      do i = 1, size(chosen)
         best = maxloc(place, 1, mask=share > 0)
         chosen(i) = best
         share(best) = 0
      end do
      associate (unused => last)
      end associate
   end subroutine front_candidates

   !> Points that labels should not lie on.
   subroutine take_points(study, what, x, y, labels)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what
      type(axis), intent(in) :: x, y
      type(label_list), intent(inout) :: labels
      integer :: i
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (.not. p%good .or. .not. p%ns > 0 .or. labels%points == size(labels%point, 2)) cycle
            labels%points = labels%points + 1
            labels%point(:, labels%points) = [fraction_of(x, max(error_of(p, what, middle), least_shown)), &
                                              fraction_of(y, p%ns/p%h)]
         end associate
      end do
   end subroutine take_points

   !> Name a frontier candidate at the middle of its part of the frontier.
   subroutine name_front(file, study, what, candidate, k, x, y, labels, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what, candidate, k
      type(axis), intent(in) :: x, y
      type(label_list), intent(inout) :: labels
      type(poinsot_error), intent(inout) :: error
      integer :: i, n, at, half
      n = count(study%points%candidate == candidate .and. study%points%front(what))
      half = (n + 1)/2
      at = 0
      n = 0
      do i = 1, size(study%points)
         if (study%points(i)%candidate /= candidate .or. .not. study%points(i)%front(what)) cycle
         n = n + 1
         if (n == half) at = i
      end do
      if (at == 0) return
      call put_label(file, study, what, candidate, at, x, y, strong_colour(k), .true., labels, error)
   end subroutine name_front

   !> Name any other curve at its most accurate point.
   subroutine name_curve(file, study, what, candidate, x, y, labels, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what, candidate
      type(axis), intent(in) :: x, y
      type(label_list), intent(inout) :: labels
      type(poinsot_error), intent(inout) :: error
      real(dp) :: least
      integer :: i, at
      at = 0
      least = huge(least)
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (p%candidate /= candidate .or. .not. p%good .or. .not. p%ns > 0) cycle
            if (error_of(p, what, middle) > 0.7_dp*least) cycle
            least = error_of(p, what, middle)
            at = i
         end associate
      end do
      if (at > 0) call put_label(file, study, what, candidate, at, x, y, "#707070", .false., labels, error)
   end subroutine name_curve

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
      character(40) :: place
      real(dp) :: to_x, to_y
      text = label_of(study%candidates(candidate))
      associate (p => study%points(at))
         call place_label(labels, fraction_of(x, max(error_of(p, what, middle), least_shown)), &
                          fraction_of(y, p%ns/p%h), len(text) + merge(2, 0, bold), to_x, to_y)
      end associate
      write (place, "('graph ', f7.4, ', graph ', f7.4)") to_x, to_y
      if (bold) text = "{/:Bold " // text // "}"
      call put(file, "set label '" // text // "' at " // trim(place) // " tc rgb '" // colour // &
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
         "set grid lc rgb '#ececec' lt 1 lw 0.7; set rmargin 3"], error)
      call put(file, "set xrange [" // text_of(x%from) // ":" // text_of(x%to) // "]; set yrange [" // &
               text_of(y%from) // ":" // text_of(y%to) // "]", error)
      call put(file, "set xlabel 'step h'; set ylabel 'error in attitude, radians, at t = " // &
               short_time(study%t_end) // "'", error)
      call put(file, "set title '" // trim(scene%name) // ": error against step, with the slope of each curve" // &
               either("", " (exact rotation)", all(shown)) // "' left font ',14'", error)
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (.not. p%good .or. .not. shown(p%candidate) .or. labels%points == size(labels%point, 2)) cycle
            labels%points = labels%points + 1
            labels%point(:, labels%points) = [fraction_of(x, p%h), fraction_of(y, max(p%angle(middle), least_shown))]
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
         call put(file, plot // rows(study, i) // " using 6:($27 > 0 ? ($7 > 1e-17 ? $7 : 1e-17) : NaN) " // &
                  "with linespoints pt " // text_of(strong_point(k)) // " ps 0.5 lw 1.4 lc rgb '" // strong_colour(k) // &
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
      character(40) :: place
      character(8) :: number
      real(dp) :: to_x, to_y, slope
      integer :: i, at, before
      at = 0
      before = 0
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (p%candidate /= candidate .or. .not. p%good) cycle
            if (at == 0) at = i
            if (p%angle(middle) > 0.03_dp .or. p%angle(middle) < 3e-13_dp) cycle
            before = at
            at = i
         end associate
      end do
      if (at == 0) return
      text = label_of(study%candidates(candidate))
      if (index(text, "exact + ") == 1) text = text(9:)
      if (before > 0 .and. study%candidates(candidate)%order > 0) then
         slope = log(study%points(at)%angle(middle)/study%points(before)%angle(middle))/ &
                 log(study%points(at)%h/study%points(before)%h)
         write (number, "(f6.1)") slope
         text = text // "  " // trim(adjustl(number))
      end if
      call place_label(labels, fraction_of(x, study%points(at)%h), &
                       fraction_of(y, max(study%points(at)%angle(middle), least_shown)), len(text), to_x, to_y)
      write (place, "('graph ', f7.4, ', graph ', f7.4)") to_x, to_y
      call put(file, "set label '" // text // "' at " // trim(place) // " tc rgb '" // strong_colour(k) // &
               "' font ',10' front", error)
   end subroutine name_slope

end module poinsot_study_cost_plots
