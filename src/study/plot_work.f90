!> The work-precision diagram of a cost study: time against error, every candidate as a curve, the
!> efficient frontier drawn and named, others' integrators beside it.
module poinsot_study_plot_work
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_plots_common, only: put_end
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_text, only: text_of
   use poinsot_study_candidates, only: label_of
   use poinsot_study_cost_curves, only: find_curve, rows_of, shown_error, start_plot, put_axes, &
      put_name, short_time, least_shown
   use poinsot_study_cost_data, only: cost_study, few
   use poinsot_study_cost_point, only: middle, worst, of_angle, error_of
   use poinsot_study_efficient, only: frontier_part, frontier_parts, frontier_line
   use poinsot_study_labels, only: label_list, axis, take_curve, fraction_of
   use poinsot_study_plots, only: strong, strong_colour, strong_point, nice_below, nice_above, &
      either
   use poinsot_study_rivals, only: rival_point, rival_names
   use poinsot_study_statistics, only: median
   implicit none(type, external)
   private
   public :: write_work

   integer, parameter :: rival_curve = 100000   !! curves of rivals are numbered from here
   real(dp), parameter :: slowest_rival = 1e5_dp !! times our fastest: what is slower is cut off

   !> The picture while it is made.
   type :: work_picture
      integer :: what = of_angle
      type(axis) :: x, y                       !! error, time
      integer, allocatable :: chosen(:)        !! candidates on the frontier, coarse to fine
      type(frontier_part), allocatable :: parts(:)
      type(label_list) :: labels
      character(:), allocatable :: deviation, far    !! columns of cost.csv: error, its worst
   end type work_picture

contains

   !> plot_NAME.gp. Error: POINSOT_E_IO.
   subroutine write_work(out, name, scene, study, what, error)
      character(*), intent(in) :: out, name
      type(scene_settings), intent(in) :: scene
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what              !! of_angle or of_momentum
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      type(work_picture) :: picture
      integer :: rivals
      if (raised(error)) return
      picture%what = what
      picture%deviation = text_of(merge(7, 10, what == of_angle))
      picture%far = text_of(merge(8, 11, what == of_angle))
      call work_axes(study, picture)
      call frontier_parts(study%points, size(study%candidates), what, picture%parts)
      call front_candidates(picture%parts, picture%chosen)
      call open_out(out // "/plot_" // name // ".gp", file, error)
      if (raised(error)) return
      call put_front(file, study, what, error)
      call put_rivals(file, study, what, rivals, error)
      call start_plot(name, trim(scene%name) // ": what accuracy costs", file, error)
      call put(file, "set label 'band: our fastest for each accuracy' at graph 1, graph 1.05" // &
               " right tc rgb '#606060' font ',10'", error)
      call put_axes(file, picture%x, picture%y, "error in " // &
                    either("attitude, radians", "momentum, over |y|", what == of_angle) // &
                    ", at t = " // short_time(study%t_end) // " (median of " // &
                    text_of(study%members%n) // " states, bars to the worst)", &
                    "time, ns per body and unit of simulated time", error)
      call put(file, "unset mxtics", error) ! gnuplot sets them wrong on an axis that falls
      call put_doubt(file, study, picture, error)
      call name_all(file, study, picture, error)
      call put_curves(file, study, picture, rivals, error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_work

   !> Ranges that hold what is shown.
   pure subroutine work_axes(study, picture)
      type(cost_study), intent(in) :: study
      type(work_picture), intent(inout) :: picture
      real(dp) :: least(2), most(2), deviation, time
      integer :: i, k, first, last
      least = huge(least)
      most = 0
      do k = 1, size(study%candidates)
         call find_curve(study, k, picture%what, first, last)
         do i = max(first, 1), last
            associate (p => study%points(i))
               if (.not. p%good .or. .not. p%ns > 0) cycle
               deviation = shown_error(error_of(p, picture%what, middle))
               time = p%ns/p%h
               if (deviation > 1) cycle
               least = min(least, [deviation, time])
               most = max(most, [deviation, time])
            end associate
         end do
      end do
      do i = 1, size(study%rivals)
         if (rival_error(study%rivals(i), picture%what) > 0.1_dp) cycle
         least(2) = min(least(2), study%rivals(i)%time)
         most(2) = min(max(most(2), study%rivals(i)%time), slowest_rival*least(2))
      end do
      if (least(1) > most(1)) least = 1e-16_dp
      if (.not. most(1) > 0) most = 1
      picture%x = axis(nice_above(most(1)), nice_below(least(1))/3) ! accuracy grows to the right
      picture%y = axis(0.6_dp*least(2), nice_above(most(2)))
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

   !> Errors that the reference cannot vouch for, as a pale strip.
   subroutine put_doubt(file, study, picture, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      type(work_picture), intent(in) :: picture
      type(poinsot_error), intent(inout) :: error
      real(dp) :: doubt
      doubt = median(study%reference%angle)
      if (picture%what /= of_angle) doubt = median(study%reference%momentum)
      if (study%kind%free .or. .not. doubt > picture%x%to) return
      call put(file, "set object 1 rect from " // text_of(doubt) // ", graph 0 to graph 1, " // &
               "graph 1 fc rgb '#f2f0ea' fs solid noborder behind", error)
      call put(file, "set label ""the reference's\nown error"" at graph 0.995, graph 0.07 " // &
               "right tc rgb '#606060' font ',8'", error)
   end subroutine put_doubt

   !> Names of all curves that get one: the frontier first.
   subroutine name_all(file, study, picture, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      type(work_picture), intent(inout) :: picture
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: x(:), y(:)
      integer :: i
      do i = 1, size(study%candidates)
         if (.not. any(picture%chosen == i) .and. size(study%candidates) > few) cycle
         call curve_in_picture(study, i, picture, x, y)
         call take_curve(picture%labels, x, y, i)
      end do
      call take_bars(study, picture)
      call take_rivals(study, picture)
      do i = 1, size(picture%chosen)
         call front_in_picture(study, picture%chosen(i), picture, x, y)
         call put_name(file, label_of(study%candidates(picture%chosen(i))), "Bold", &
                       strong_colour(i), x, y, picture%chosen(i), picture%labels, error)
      end do
      call name_rivals(file, study, picture, error)
      if (size(study%candidates) > few) return
      do i = 1, size(study%candidates)
         if (any(picture%chosen == i)) cycle
         call curve_in_picture(study, i, picture, x, y)
         call put_name(file, label_of(study%candidates(i)), "", "#606060", x, y, i, &
                       picture%labels, error, size(x) < 3)
      end do
   end subroutine name_all

   !> A candidate's points, in fractions of the picture.
   subroutine curve_in_picture(study, candidate, picture, x, y)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: candidate
      type(work_picture), intent(in) :: picture
      real(dp), allocatable, intent(out) :: x(:), y(:)
      integer :: i, first, last
      allocate (x(0), y(0))
      call find_curve(study, candidate, picture%what, first, last)
      do i = max(first, 1), last
         associate (p => study%points(i))
            if (.not. p%good .or. .not. p%ns > 0) cycle
            x = [x, fraction_of(picture%x, shown_error(error_of(p, picture%what, middle)))]
            y = [y, fraction_of(picture%y, p%ns/p%h)]
         end associate
      end do
   end subroutine curve_in_picture

   !> Those of them that are on the frontier, or the one in the middle of its stretch.
   subroutine front_in_picture(study, candidate, picture, x, y)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: candidate
      type(work_picture), intent(in) :: picture
      real(dp), allocatable, intent(out) :: x(:), y(:)
      integer :: i, k
      logical :: wanted
      allocate (x(0), y(0))
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (p%candidate /= candidate .or. .not. p%good .or. .not. p%ns > 0) cycle
            wanted = .false.
            do k = 1, size(picture%parts)
               if (picture%parts(k)%candidate /= candidate) cycle
               wanted = wanted .or. picture%parts(k)%point == i
               wanted = wanted .or. (p%front(picture%what) .and. &
                        error_of(p, picture%what, middle) <= picture%parts(k)%from .and. &
                        error_of(p, picture%what, middle) >= 0.3_dp*picture%parts(k)%to)
            end do
            if (.not. wanted) cycle
            x = [x, fraction_of(picture%x, shown_error(error_of(p, picture%what, middle)))]
            y = [y, fraction_of(picture%y, p%ns/p%h)]
         end associate
      end do
   end subroutine front_in_picture

   !> The bars to the worst state that the frontier's points have.
   subroutine take_bars(study, picture)
      type(cost_study), intent(in) :: study
      type(work_picture), intent(inout) :: picture
      real(dp) :: x(2), y
      integer :: i
      do i = 1, size(study%points)
         associate (p => study%points(i))
            if (.not. p%front(picture%what) .or. .not. any(picture%chosen == p%candidate)) cycle
            x(1) = fraction_of(picture%x, shown_error(error_of(p, picture%what, middle)))
            x(2) = fraction_of(picture%x, shown_error(error_of(p, picture%what, worst)))
            y = fraction_of(picture%y, p%ns/p%h)
            call take_curve(picture%labels, x, [y, y], p%candidate)
         end associate
      end do
   end subroutine take_bars

   !> What is drawn: band, pale curves, rivals, the frontier's curves with bars.
   subroutine put_curves(file, study, picture, rivals, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      type(work_picture), intent(in) :: picture
      integer, intent(in) :: rivals            !! how many
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: columns, bars, plain
      integer :: k, first, last
      columns = " using ($27 > 0 && $25 > 0 ? ($" // picture%deviation // " > 1e-17 ? $" // &
                picture%deviation // " : 1e-17) : NaN):25"
      bars = " using ($27 > 0 && $" // text_of(merge(28, 29, picture%what == of_angle)) // &
             " > 0 ? $" // picture%deviation // " : NaN):25:" // picture%deviation // ":" // &
                picture%far
      plain = " with lines lw 0.6 lc rgb '#c9c9c9', \"
      if (size(study%candidates) <= few) then
         plain = " with linespoints pt 7 ps 0.25 lw 0.9 lc rgb '#9a9a9a', \"
      end if
      call put(file, "file = 'cost.csv'", error)
      call put(file, "plot $front using 1:2 with lines lw 11 lc rgb '#dbe4ee', \", error)
      do k = 1, size(study%candidates)
         call find_curve(study, k, picture%what, first, last)
         if (any(picture%chosen == k) .or. first == 0) cycle
         call put(file, "   " // rows_of(first, last) // columns // plain, error)
      end do
      do k = 1, rivals
         call put(file, "   $rivals index " // text_of(k - 1) // &
                  " using 1:2 with linespoints dt 2 pt 2 ps 0.5 lw 1.3 lc rgb '#555555', \", error)
      end do
      do k = 1, size(picture%chosen)
         call find_curve(study, picture%chosen(k), picture%what, first, last)
         call put(file, "   " // rows_of(first, last) // bars // &
                  " with xerrorbars pt 0 lw 0.8 lc rgb '" // strong_colour(k) // "', \", error)
         call put(file, "   " // rows_of(first, last) // columns // " with linespoints pt " // &
                  text_of(strong_point(k)) // " ps 0.7 lw 1.8 lc rgb '" // strong_colour(k) // &
                  "', \", error)
      end do
      call put(file, "   NaN notitle", error)
   end subroutine put_curves

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

   ! Rivals
   ! -----------------------------------------------------------------------------------------------

   !> The error of a rival that the picture is about.
   pure real(dp) function rival_error(point, what)
      type(rival_point), intent(in) :: point
      integer, intent(in) :: what
      rival_error = merge(point%angle(1), point%momentum(1), what == of_angle)
   end function rival_error

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

   !> A rival's points, in fractions of the picture.
   subroutine rival_in_picture(study, name, picture, x, y)
      type(cost_study), intent(in) :: study
      character(*), intent(in) :: name
      type(work_picture), intent(in) :: picture
      real(dp), allocatable, intent(out) :: x(:), y(:)
      integer :: i
      allocate (x(0), y(0))
      do i = 1, size(study%rivals)
         associate (r => study%rivals(i))
            if (r%name /= name) cycle
            x = [x, fraction_of(picture%x, max(rival_error(r, picture%what), least_shown))]
            y = [y, fraction_of(picture%y, r%time)]
         end associate
      end do
   end subroutine rival_in_picture

   subroutine take_rivals(study, picture)
      type(cost_study), intent(in) :: study
      type(work_picture), intent(inout) :: picture
      character(32), allocatable :: names(:)
      real(dp), allocatable :: x(:), y(:)
      integer :: k
      call rival_names(study%rivals, names)
      do k = 1, size(names)
         call rival_in_picture(study, trim(names(k)), picture, x, y)
         call take_curve(picture%labels, x, y, rival_curve + k)
      end do
   end subroutine take_rivals

   subroutine name_rivals(file, study, picture, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      type(work_picture), intent(inout) :: picture
      type(poinsot_error), intent(inout) :: error
      character(32), allocatable :: names(:)
      real(dp), allocatable :: x(:), y(:)
      integer :: k
      call rival_names(study%rivals, names)
      do k = 1, size(names)
         call rival_in_picture(study, trim(names(k)), picture, x, y)
         if (size(x) > 0) call put_name(file, trim(names(k)), "Italic", "#404040", x, y, &
            rival_curve + k, picture%labels, error)
      end do
   end subroutine name_rivals

end module poinsot_study_plot_work
