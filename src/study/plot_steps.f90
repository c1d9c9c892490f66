!> Error against step in a cost study, with the slope of each curve beside its name.
module poinsot_study_plot_steps
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_plots_common, only: put_end
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_text, only: text_of
   use poinsot_study_candidates, only: label_of
   use poinsot_study_cost_curves, only: find_curve, rows_of, shown_error, start_plot, put_axes, &
      put_name, short_time
   use poinsot_study_cost_data, only: cost_study, few
   use poinsot_study_cost_point, only: middle, of_angle, slope_of
   use poinsot_study_labels, only: label_list, axis, take_curve, fraction_of
   use poinsot_study_plots, only: strong_colour, strong_point, nice_below, nice_above, either
   implicit none(type, external)
   private
   public :: write_steps

   real(dp), parameter :: rounding = 1e-13_dp !! curves below this are rounding alone

contains

   !> plot_NAME.gp. Error: POINSOT_E_IO.
   subroutine write_steps(out, name, scene, study, error)
      character(*), intent(in) :: out, name
      type(scene_settings), intent(in) :: scene
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      type(axis) :: x, y
      integer, allocatable :: shown(:)
      integer :: k, first, last
      if (raised(error)) return
      call open_out(out // "/plot_" // name // ".gp", file, error)
      if (raised(error)) return
      call choose_shown(study, shown)
      call step_axes(study, shown, x, y)
      call start_plot(name, trim(scene%name) // ": error against step", file, error)
      call put(file, "set label '" // &
               either("exact rotation; ", "", size(study%candidates) > few) // &
               "names with their slopes' at graph 1, graph 1.05 right " // &
               "tc rgb '#606060' font ',10'", error)
      call put_axes(file, x, y, "step h", "error in attitude, radians, at t = " // &
                    short_time(study%t_end) // " (median)", error)
      call name_curves(file, study, shown, x, y, error)
      call put(file, "file = 'cost.csv'", error)
      do k = 1, size(shown)
         call find_curve(study, shown(k), of_angle, first, last)
         call put(file, either("plot ", "   ", k == 1) // rows_of(first, last) // &
                  " using 6:($27 > 0 ? ($7 > 1e-17 ? $7 : 1e-17) : NaN) with linespoints pt " // &
                  text_of(shape_of(study, shown, k)) // " ps 0.5 lw 1.4 lc rgb '" // &
                  colour_of(study%candidates(shown(k))%order) // "', \", error)
      end do
      call put(file, either("plot ", "   ", size(shown) == 0) // "NaN notitle", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_steps

   !> All candidates with a slope to show, and the exact ones; where there are too many, the
   !> splittings of the exact rotation.
   subroutine choose_shown(study, shown)
      type(cost_study), intent(in) :: study
      integer, allocatable, intent(out) :: shown(:)
      integer :: k, first, last
      allocate (shown(0))
      do k = 1, size(study%candidates)
         if (size(study%candidates) > few .and. study%candidates(k)%method /= "exact") cycle
         call find_curve(study, k, of_angle, first, last)
         if (first == 0 .or. (last - first < 1 .and. study%candidates(k)%order > 0)) cycle
         if (.not. any(study%points(first:last)%good)) cycle
         if (study%candidates(k)%order > 0 .and. &
             .not. any(study%points(first:last)%angle(middle) > rounding)) cycle
         shown = [shown, k]
      end do
   end subroutine choose_shown

   pure subroutine step_axes(study, shown, x, y)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: shown(:)
      type(axis), intent(out) :: x, y
      real(dp) :: least(2), most(2)
      integer :: i, k, first, last
      least = huge(least)
      most = 0
      do k = 1, size(shown)
         call find_curve(study, shown(k), of_angle, first, last)
         do i = first, last
            associate (p => study%points(i))
               if (.not. p%good) cycle
               least = min(least, [p%h, shown_error(p%angle(middle))])
               most = max(most, [p%h, p%angle(middle)])
            end associate
         end do
      end do
      if (.not. most(1) > 0) most = 1
      if (least(1) > most(1)) least = 1e-3_dp
      x = axis(nice_below(0.9_dp*least(1)), nice_above(1.1_dp*most(1)))
      y = axis(nice_below(0.5_dp*least(2)), nice_above(1.1_dp*most(2)))
   end subroutine step_axes

   !> Names with slopes, each beside its curve.
   subroutine name_curves(file, study, shown, x, y, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      integer, intent(in) :: shown(:)
      type(axis), intent(in) :: x, y
      type(poinsot_error), intent(inout) :: error
      type(label_list) :: labels
      real(dp), allocatable :: px(:), py(:)
      character(:), allocatable :: text
      integer :: k
      do k = 1, size(shown)
         call curve_in_picture(study, shown(k), x, y, px, py)
         call take_curve(labels, px, py, shown(k))
      end do
      do k = 1, size(shown)
         call curve_in_picture(study, shown(k), x, y, px, py)
         text = label_of(study%candidates(shown(k)))
         if (index(text, "exact + ") == 1) text = text(9:)
         call put_name(file, text // slope_text(study, shown(k)), "", &
                       colour_of(study%candidates(shown(k))%order), px, py, shown(k), labels, error)
      end do
   end subroutine name_curves

   !> A candidate's points, in fractions of the picture.
   subroutine curve_in_picture(study, candidate, x, y, px, py)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: candidate
      type(axis), intent(in) :: x, y
      real(dp), allocatable, intent(out) :: px(:), py(:)
      integer :: i, first, last
      allocate (px(0), py(0))
      call find_curve(study, candidate, of_angle, first, last)
      do i = max(first, 1), last
         associate (p => study%points(i))
            if (.not. p%good) cycle
            px = [px, fraction_of(x, p%h)]
            py = [py, fraction_of(y, shown_error(p%angle(middle)))]
         end associate
      end do
   end subroutine curve_in_picture

   !> "  4.0", nothing for who has no slope.
   function slope_text(study, candidate) result(text)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: candidate
      character(:), allocatable :: text
      character(8) :: number
      real(dp) :: slope
      text = ""
      if (study%candidates(candidate)%order == 0) return
      slope = slope_of(study%points, candidate)
      if (.not. slope > 0) return
      write (number, "(f8.1)") slope
      text = "  " // trim(adjustl(number))
   end function slope_text

   !> A colour for each order; the exact ones have the last.
   pure function colour_of(order) result(colour)
      integer, intent(in) :: order
      character(7) :: colour
      colour = strong_colour(8)
      if (order > 0) colour = strong_colour(1 + mod(max(order, 2)/2 - 1, 7))
   end function colour_of

   !> Points of one shape for each curve of an order.
   pure integer function shape_of(study, shown, k) result(shape)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: shown(:), k
      shape = strong_point(count(study%candidates(shown(:k))%order == &
                                 study%candidates(shown(k))%order))
   end function shape_of

end module poinsot_study_plot_steps
