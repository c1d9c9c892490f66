!> What the pictures of a cost study share: which lines of cost.csv a curve is, how a script begins,
!> names beside curves.
module poinsot_study_cost_curves
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error
   use poinsot_scene_files, only: out_file, put
   use poinsot_scene_plots_common, only: put_lines
   use poinsot_scene_text, only: text_of
   use poinsot_study_cost_data, only: cost_study
   use poinsot_study_cost_point, only: error_of, middle
   use poinsot_study_labels, only: label_list, label_place, axis, place_label
   use poinsot_study_plots, only: put_terminals
   implicit none(type, external)
   private
   public :: find_curve, rows_of, shown_error, start_plot, put_axes, put_name, short_time

   real(dp), parameter, public :: least_shown = 1e-17_dp
   real(dp), parameter :: near_rounding = 1e-9_dp
   real(dp), parameter :: gain(2) = [0.7_dp, 0.33_dp] !! of the last step; of several

contains

   !> First and last point of a candidate that a picture shows, 0 if it has none: a curve ends where
   !> shorter steps gain nothing more.
   pure subroutine find_curve(study, candidate, what, first, last)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: candidate
      integer, intent(in) :: what              !! of_angle, of_momentum
      integer, intent(out) :: first, last      !! the points of a candidate stand together
      real(dp) :: least
      integer :: i, end
      first = findloc(study%points%candidate, candidate, 1)
      end = findloc(study%points%candidate, candidate, 1, back=.true.)
      last = end
      if (first == 0) return
      if (study%candidates(candidate)%order == 0) return ! exact at any step: there is no such end
      do i = first, end - 1
         associate (p => study%points(i))
            if (.not. p%good .or. error_of(p, what, middle) > near_rounding) cycle
            least = minval(error_of(study%points(i + 1:end), what, middle), &
                           mask=study%points(i + 1:end)%good)
            last = i
            if (least > gain(min(2, end - i))*error_of(p, what, middle)) return
         end associate
      end do
      last = end
   end subroutine find_curve

   !> Points from first to last as gnuplot reads them from cost.csv.
   pure function rows_of(first, last) result(text)
      integer, intent(in) :: first, last
      character(:), allocatable :: text
      text = "file skip 1 every ::" // text_of(first - 1) // "::" // text_of(last - 1)
   end function rows_of

   !> The error that a picture shows: none is beyond the end of the axis.
   elemental real(dp) function shown_error(error)
      real(dp), intent(in) :: error
      shown_error = max(error, least_shown)
   end function shown_error

   !> Head and title of plot_NAME.gp; blocks of data stand before it.
   subroutine start_plot(name, title, file, error)
      character(*), intent(in) :: name, title
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      call put_terminals(file, name, 820, 560, error)
      call put_lines(file, [character(100) :: &
         "set logscale xy; set format x '10^{%T}'; set format y '10^{%T}'", &
         "set border 3; set tics nomirror out; unset key", &
         "set grid lc rgb '#ececec' lt 1 lw 0.7; set tmargin 3; set rmargin 3"], error)
      call put(file, "set label '" // title // "' at graph 0, graph 1.05 font ',14'", error)
   end subroutine start_plot

   !> Ranges and names of the axes.
   subroutine put_axes(file, x, y, x_name, y_name, error)
      type(out_file), intent(in) :: file
      type(axis), intent(in) :: x, y
      character(*), intent(in) :: x_name, y_name
      type(poinsot_error), intent(inout) :: error
      call put(file, "set xrange [" // text_of(x%from) // ":" // text_of(x%to) // "]", error)
      call put(file, "set yrange [" // text_of(y%from) // ":" // text_of(y%to) // "]", error)
      call put(file, "set xlabel """ // x_name // """; set ylabel """ // y_name // """", error)
   end subroutine put_axes

   !> Write a name near one of the points given; with `only_if_free` not at all if it would lie on
   !> another.
   subroutine put_name(file, text, style, colour, x, y, curve, labels, error, only_if_free)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: text
      character(*), intent(in) :: style        !! "", "Bold" or "Italic"
      character(*), intent(in) :: colour
      real(dp), intent(in) :: x(:), y(:)       !! fractions of the picture
      integer, intent(in) :: curve             !! its number in `labels`
      type(label_list), intent(inout) :: labels
      type(poinsot_error), intent(inout) :: error
      logical, intent(in), optional :: only_if_free
      type(label_place) :: place
      character(6), parameter :: sides(-1:1) = [character(6) :: "right", "center", "left"]
      character(:), allocatable :: shown
      real(dp) :: limit
      limit = huge(limit)
      if (present(only_if_free)) then
         if (only_if_free) limit = 6
      end if
      call place_label(labels, x, y, len(text) + merge(2, 0, style == "Bold"), curve, place, limit)
      if (.not. place%penalty < limit) return
      shown = text
      if (style /= "") shown = "{/:" // style // " " // text // "}"
      call put(file, "set label '" // shown // "' at " // graph_place(place%x, place%y) // " " // &
               trim(sides(place%side)) // " tc rgb '" // colour // "' font ',10' front", error)
      if (place%led) call put(file, "set arrow from " // graph_place(place%line(1), place%line(2)) &
         // " to " // graph_place(place%line(3), place%line(4)) // &
         " nohead lw 0.6 lc rgb '" // colour // "' front", error)
   end subroutine put_name

   !> A place as gnuplot reads it.
   pure function graph_place(x, y) result(text)
      real(dp), intent(in) :: x, y        !! fractions of the picture
      character(32) :: text
      write (text, "('graph ', f7.4, ', graph ', f7.4)") x, y
   end function graph_place

   !> "10" rather than "10.0".
   pure function short_time(t) result(text)
      real(dp), intent(in) :: t
      character(:), allocatable :: text
      text = text_of(t)
      if (len(text) > 2) then
         if (text(len(text) - 1:) == ".0") text = text(:len(text) - 2)
      end if
   end function short_time

end module poinsot_study_cost_curves
