!> The error of the energy against time in long runs of a cost study.
module poinsot_study_plot_drift
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_plots_common, only: put_end
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_text, only: text_of
   use poinsot_study_candidates, only: label_of
   use poinsot_study_cost_curves, only: rows_of, shown_error, start_plot, put_axes, put_name
   use poinsot_study_cost_data, only: cost_study
   use poinsot_study_energy_drift, only: drift_row
   use poinsot_study_labels, only: label_list, axis, take_curve, fraction_of
   use poinsot_study_plots, only: strong_colour, strong_point, nice_below, nice_above, either
   implicit none(type, external)
   private
   public :: write_drift

   real(dp), parameter :: least_energy = 2e-17_dp

contains

   !> plot_NAME.gp, if there is anything to show. Error: POINSOT_E_IO.
   subroutine write_drift(out, name, scene, study, error)
      character(*), intent(in) :: out, name
      type(scene_settings), intent(in) :: scene
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      type(axis) :: x, y
      integer, allocatable :: from(:)
      integer :: k
      if (raised(error) .or. size(study%drift) == 0) return
      call open_out(out // "/plot_" // name // ".gp", file, error)
      if (raised(error)) return
      call find_runs(study%drift, from)
      x = axis(nice_below(0.9_dp*minval(study%drift%t)), nice_above(3*maxval(study%drift%t)))
      y = axis(nice_below(0.3_dp*max(minval(study%drift%median), 3*least_energy)), &
               nice_above(10*max(maxval(study%drift%median), least_energy)))
      call start_plot(name, trim(scene%name) // ": energy in long runs (median of " // &
                      text_of(study%members%n) // " states)", file, error)
      call put_axes(file, x, y, "t", "largest error of the energy so far, relative", error)
      call name_runs(file, study, from, x, y, error)
      call put(file, "file = 'drift.csv'", error)
      do k = 1, size(from) - 1
         call put(file, either("plot ", "   ", k == 1) // rows_of(from(k), from(k + 1) - 1) // &
                  " using 4:($5 > 2e-17 ? $5 : 2e-17) with linespoints pt " // &
                  text_of(strong_point(k)) // " ps 0.5 lw 1.6 lc rgb '" // strong_colour(k) // &
                  "', \", error)
      end do
      call put(file, "   NaN notitle", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_drift

   !> Where each candidate's rows begin; the last number is one beyond all.
   pure subroutine find_runs(rows, from)
      type(drift_row), intent(in) :: rows(:)
      integer, allocatable, intent(out) :: from(:)
      integer :: i
      from = [1]
      do i = 2, size(rows)
         if (rows(i)%candidate /= rows(i - 1)%candidate) from = [from, i]
      end do
      from = [from, size(rows) + 1]
   end subroutine find_runs

   !> Names with steps: near the ends of the curves if there is room.
   subroutine name_runs(file, study, from, x, y, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      integer, intent(in) :: from(:)
      type(axis), intent(in) :: x, y
      type(poinsot_error), intent(inout) :: error
      type(label_list) :: labels
      real(dp), allocatable :: px(:), py(:)
      integer :: k
      do k = 1, size(from) - 1
         call run_in_picture(study%drift(from(k):from(k + 1) - 1), x, y, px, py)
         call take_curve(labels, px, py, k)
      end do
      do k = 1, size(from) - 1
         associate (rows => study%drift(from(k):from(k + 1) - 1))
            call run_in_picture(rows, x, y, px, py)
            call put_name(file, label_of(study%candidates(rows(1)%candidate)) // ", h = " // &
                          three_digits(rows(1)%h), "", strong_colour(k), &
                          px(size(px)/2 + 1:), py(size(px)/2 + 1:), k, labels, error)
         end associate
      end do
   end subroutine name_runs

   !> In fractions of the picture.
   subroutine run_in_picture(rows, x, y, px, py)
      type(drift_row), intent(in) :: rows(:)
      type(axis), intent(in) :: x, y
      real(dp), allocatable, intent(out) :: px(:), py(:)
      integer :: i
      px = [(fraction_of(x, rows(i)%t), i=1, size(rows))]
      py = [(fraction_of(y, max(shown_error(rows(i)%median), least_energy)), i=1, size(rows))]
   end subroutine run_in_picture

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

end module poinsot_study_plot_drift
