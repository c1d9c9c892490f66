!> A cost study as files: every point as CSV, the initial and end states, and the report.
module poinsot_study_cost_files
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_maxima, only: larger
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_version, only: version_text
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_summary, only: brief_number
   use poinsot_scene_text, only: text_of
   use poinsot_study_candidates, only: label_of, no_splitting
   use poinsot_study_cost_curves, only: find_curve
   use poinsot_study_cost_data, only: cost_study, cost_request, few
   use poinsot_study_cost_point, only: cost_point, cheapest, middle, worst, of_angle, of_momentum, &
      of_both, error_of, slope_of
   use poinsot_study_efficient, only: frontier_part, frontier_parts
   use poinsot_study_rivals, only: rival_names, rival_time
   use poinsot_study_statistics, only: median
   implicit none(type, external)
   private
   public :: write_points, write_members, write_report, write_drift_rows

   character(*), parameter :: columns = "method,splitting,order,turns,steps,h," // &
      "angle_median,angle_worst,angle_own,momentum_median,momentum_worst,momentum_own," // &
      "energy_median,energy_worst,energy_own,drift_median,drift_worst,drift_own," // &
      "ns_per_step,ns_least,ns_spread,single_ns_per_step,single_spread,repeats," // &
      "ns_per_time,single_ns_per_time,good,front_angle,front_momentum,shown_angle," // &
      "shown_momentum,tolerance"

contains

   !> cost.csv: one line a point. Error: POINSOT_E_IO.
   subroutine write_points(path, study, error)
      character(*), intent(in) :: path
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      logical :: shown(size(study%points), of_angle:of_momentum)
      integer :: i, k, first, last
      call open_out(path, file, error)
      if (raised(error)) return
      shown = .false.
      do k = 1, size(study%candidates)
         do i = of_angle, of_momentum
            call find_curve(study, k, i, first, last)
            if (first > 0) shown(first:last, i) = .true.
         end do
      end do
      call put(file, columns, error)
      do i = 1, size(study%points)
         call put(file, line_of(study, study%points(i)) // "," // flag(shown(i, of_angle)) // &
                  "," // flag(shown(i, of_momentum)) // "," // &
                  optional_text(study%points(i)%tolerance), error)
      end do
      call finish_out(file, error)
   end subroutine write_points

   function line_of(study, p) result(line)
      type(cost_study), intent(in) :: study
      type(cost_point), intent(in) :: p
      character(:), allocatable :: line
      real(dp) :: numbers(20)
      integer, parameter :: errors = 12         !! the first of them; then times
      integer :: i
      associate (one => study%candidates(p%candidate))
         line = trim(one%method) // "," // trim(one%splitting)
         if (one%adaptive) line = trim(one%splitting) // "," // no_splitting ! it uses no method
         line = line // "," // text_of(one%order) // "," // &
                text_of(one%turns) // "," // text_of(p%steps) // "," // short_text(p%h)
      end associate
      numbers = [p%angle, p%momentum, p%energy, p%slope, p%ns, p%ns_least, p%ns_spread, p%single, &
                 p%single_spread, real(p%repeats, dp), p%ns/p%h, p%single/p%h]
      do i = 1, size(numbers)
         line = line // ","
         if (.not. p%good) cycle                ! of a failed run nothing is known
         if (i > errors .and. p%repeats == 0) cycle ! there was no time to time it
         line = line // short_text(numbers(i))
      end do
      line = line // "," // flag(p%good) // "," // flag(p%front(of_angle)) // "," // &
             flag(p%front(of_momentum))
   end function line_of

   pure function short_text(x) result(text)
      real(dp), intent(in) :: x
      character(:), allocatable :: text
      character(16) :: buffer
      write (buffer, "(es11.4e3)") x
      text = trim(adjustl(buffer))
   end function short_text

   !> Nothing for a number that is not there.
   pure function optional_text(x) result(text)
      real(dp), intent(in) :: x
      character(:), allocatable :: text
      text = ""
      if (x > 0) text = short_text(x)
   end function optional_text

   pure character function flag(is)
      logical, intent(in) :: is
      flag = merge("1", "0", is)
   end function flag

   !> members.csv: initial state and reference end state of every body; 17 digits.
   subroutine write_members(path, scene, study, error)
      character(*), intent(in) :: path
      type(scene_settings), intent(in) :: scene
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(24) :: numbers(17)
      character(:), allocatable :: line
      real(qp) :: values(17)
      integer :: i, j
      call open_out(path, file, error)
      if (raised(error)) return
      call put(file, "# scene " // scene%name // ", from t = 0 to " // text_of(study%t_end) // &
               "; reference: " // study%reference%how, error)
      call put_effects(file, scene, error)
      call put(file, &
         "I1,I2,I3,y1,y2,y3,q0,q1,q2,q3,end_y1,end_y2,end_y3,end_q0,end_q1,end_q2,end_q3", error)
      do i = 1, study%members%n
         values(:10) = [scene%bodies(study%members%group(i))%moments, study%members%y(:, i), &
                        study%members%q(:, i)]
         values(11:) = [study%reference%state%y(:, i), study%reference%state%q(:, i)]
         write (numbers, "(es24.16e3)") values
         line = trim(adjustl(numbers(1)))
         do j = 2, size(numbers)
            line = line // "," // trim(adjustl(numbers(j)))
         end do
         call put(file, line, error)
      end do
      call finish_out(file, error)
   end subroutine write_members

   !> What acts on the bodies, as comments that a program can read.
   subroutine put_effects(file, scene, error)
      type(out_file), intent(in) :: file
      type(scene_settings), intent(in) :: scene
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: line
      integer :: i, j
      call put(file, "# t_end " // text_of(scene%t_end), error)
      do i = 1, size(scene%effects)
         line = "# effect " // scene%effects(i)%name
         do j = 1, size(scene%effects(i)%settings)
            associate (one => scene%effects(i)%settings(j))
               if (allocated(one%values)) line = line // "; " // one%key // " = " // &
                  text_of(one%values)
               if (allocated(one%text)) line = line // "; " // one%key // " = '" // one%text // "'"
            end associate
         end do
         call put(file, line, error)
      end do
   end subroutine put_effects

   !> drift.csv: error of the energy against time. Error: POINSOT_E_IO.
   subroutine write_drift_rows(path, study, error)
      character(*), intent(in) :: path
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(:), allocatable :: name
      integer :: i
      call open_out(path, file, error)
      if (raised(error)) return
      call put(file, "method,splitting,h,t,energy_median,energy_worst,tolerance", error)
      do i = 1, size(study%drift)
         associate (r => study%drift(i), one => study%candidates(study%drift(i)%candidate))
            name = trim(one%method) // "," // trim(one%splitting)
            if (one%adaptive) name = trim(one%splitting) // "," // no_splitting
            call put(file, name // "," // short_text(r%h) // "," // short_text(r%t) // "," // &
                     short_text(r%median) // "," // short_text(r%worst) // "," // &
                     optional_text(r%tolerance), error)
         end associate
      end do
      call finish_out(file, error)
   end subroutine write_drift_rows

   !> cost.txt: what was done, and the cheapest for each tolerance.
   subroutine write_report(path, scene, request, study, tolerances, error)
      character(*), intent(in) :: path
      type(scene_settings), intent(in) :: scene
      type(cost_request), intent(in) :: request
      type(cost_study), intent(in) :: study
      real(dp), intent(in) :: tolerances(:)
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      real(dp) :: doubt
      call open_out(path, file, error)
      if (raised(error)) return
      call put(file, "scene         " // scene%name // " to t = " // text_of(study%t_end) // &
               ", poinsot " // version_text, error)
      call put(file, "states        " // text_of(study%members%n) // ", " // &
               text_of(study%members%given) // " of them the scene's own; the others " // &
               spread_text(request%spread), error)
      if (study%kind%noisy) call put(file, &
         "noise         off: temperature 0 with the same friction, " // &
                                     "because runs with noise are only samples", error)
      if (study%kind%limit > 0) call put(file, "order         of splittings at most " // &
         text_of(study%kind%limit) // ": drag or thermostat act at both ends of a step", error)
      call put(file, "reference     " // study%reference%how, error)
      call put(file, "candidates    " // text_of(size(study%candidates)) // ", " // &
               text_of(size(study%points)) // " points, " // brief_number(study%seconds) // &
                  " s of " // &
               brief_number(request%budget), error)
      call put(file, "sums          " // trim(merge("compensated, as in poinsot run", &
                                                   "plain                         ", &
                                                      request%compensated)), error)
      if (study%late > 0) call put(file, "left out      shorter steps of " // &
         text_of(study%late) // " candidates, because time ran out; increase --budget", error)
      if (study%untimed > 0) call put(file, "not timed     " // text_of(study%untimed) // &
         " of the points, because time ran out", error)
      if (study%conserves .and. size(study%drift) == 0 .and. request%timed) call put(file, &
         "energy        in long runs not measured, because time ran out", error)
      if (.not. study%conserves) call put(file, &
         "energy        is not conserved in this scene: its error is the " // &
                                       "distance from the reference, and there are no long runs", &
                                             error)
      doubt = larger(median(study%reference%angle), median(study%reference%momentum))
      if (any(tolerances < doubt)) call put(file, "doubt         errors below " // &
         brief_number(doubt) // " are within the error of the reference", error)
      call put_choices(file, study, tolerances, of_both, error)
      if (size(study%rivals) > 0) call put_rivals(file, study, tolerances, error)
      call put_curves(file, study, error)
      call finish_out(file, error)
   end subroutine write_report

   function spread_text(spread) result(text)
      real(dp), intent(in) :: spread
      character(:), allocatable :: text
      text = "rotated from them by up to " // brief_number(spread) // " rad, at random"
      if (spread > 3.2_dp) text = "in any direction, uniformly distributed"
   end function spread_text

   !> Tolerances against candidates.
   subroutine put_choices(file, study, tolerances, what, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      real(dp), intent(in) :: tolerances(:)
      integer, intent(in) :: what
      type(poinsot_error), intent(inout) :: error
      character(150) :: line
      integer :: i, best, next
      call put(file, "", error)
      call put(file, &
         "cheapest for a tolerance (median over states, the larger of attitude in radians and " // &
               "momentum)", error)
      write (line, "(a9, 2x, a30, a11, 2a10, a12, 2x, a)") "tolerance", "method + splitting", &
         "step", "median", "worst", "ns per time", "runner-up (time)"
      call put(file, trim(line), error)
      do i = 1, size(tolerances)
         best = cheapest(study%points, tolerances(i), what, middle)
         if (best == 0) then
            write (line, "(a9, 2x, a30)") tolerance_text(tolerances(i)), "none of the candidates"
            call put(file, trim(line), error)
            cycle
         end if
         next = cheapest(study%points, tolerances(i), what, middle, &
            but=study%points(best)%candidate)
         associate (p => study%points(best))
            write (line, "(a9, 2x, a30, es11.3, 2es10.1e2, f12.2)") tolerance_text(tolerances(i)), &
               point_label(study, p), p%h, error_of(p, of_both, middle), &
               error_of(p, of_both, worst), p%ns/p%h
         end associate
         if (next > 0) then
            call put(file, trim(line) // "  " // &
               label_of(study%candidates(study%points(next)%candidate)) // &
                     " (" // brief_number(study%points(next)%ns/study%points(next)%h) // ")", error)
         else
            call put(file, trim(line), error)
         end if
      end do
   end subroutine put_choices

   !> The candidate, and its tolerance if it has one.
   function point_label(study, p) result(text)
      type(cost_study), intent(in) :: study
      type(cost_point), intent(in) :: p
      character(:), allocatable :: text
      text = label_of(study%candidates(p%candidate))
      if (p%tolerance > 0) text = text // ", tolerance " // tolerance_text(p%tolerance)
   end function point_label

   !> Rivals: their time over that of our cheapest, at equal error.
   subroutine put_rivals(file, study, tolerances, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      real(dp), intent(in) :: tolerances(:)
      type(poinsot_error), intent(inout) :: error
      character(32), allocatable :: names(:)
      character(200) :: line
      real(dp) :: theirs
      integer :: i, k, best
      call rival_names(study%rivals, names)
      call put(file, "", error)
      call put(file, &
         "time of others over that of our cheapest, at equal error (-: error not reached)", &
         error)
      line = "tolerance"
      do i = 1, size(tolerances)
         write (line(24 + 12*i:), "(a12)") tolerance_text(tolerances(i))
      end do
      call put(file, trim(line), error)
      do k = 1, size(names)
         line = names(k)
         do i = 1, size(tolerances)
            best = cheapest(study%points, tolerances(i), of_both, middle)
            theirs = rival_time(study%rivals, trim(names(k)), tolerances(i))
            line(24 + 12*i:35 + 12*i) = "           -"
            if (best == 0 .or. .not. theirs > 0) cycle
            write (line(24 + 12*i:), "(f12.2)") theirs/(study%points(best)%ns/study%points(best)%h)
         end do
         call put(file, trim(line), error)
      end do
   end subroutine put_rivals

   !> "1e-03", "2.5e-07".
   pure function tolerance_text(tol) result(text)
      real(dp), intent(in) :: tol
      character(:), allocatable :: text
      character(9) :: buffer
      write (buffer, "(es8.1e2)") tol
      text = trim(adjustl(buffer))
      if (text(2:3) == ".0") text = text(:1) // text(4:)
      text = text(:index(text, "E") - 1) // "e" // text(index(text, "E") + 1:)
   end function tolerance_text

   !> The best that each candidate reaches.
   subroutine put_curves(file, study, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      character(150) :: line
      type(frontier_part), allocatable :: parts(:)
      real(dp) :: least(3), slope
      integer :: i, k, points
      call put(file, "", error)
      if (size(study%candidates) > few) call put(file, &
         "the exact rotation in every splitting, and the candidates on " // &
         "the frontier; cost.csv has all", error)
      call put(file, &
         "order, slope shown, least median errors; ns per body-step in an ensemble, their " // &
               "spread, and for a single body", error)
      write (line, "(a30, 2a6, 3a10, a10, a9, a12)") "method + splitting", "order", "slope", &
         "attitude", "momentum", "energy", "ns", "spread", "ns alone"
      call put(file, trim(line), error)
      call frontier_parts(study%points, size(study%candidates), of_both, parts)
      do i = 1, size(study%candidates)
         if (size(study%candidates) > few .and. study%candidates(i)%method /= "exact" .and. &
             .not. any(parts%candidate == i)) cycle
         least = huge(least)
         points = 0
         do k = 1, size(study%points)
            associate (p => study%points(k))
               if (p%candidate /= i .or. .not. p%good) cycle
               least = min(least, [p%angle(middle), p%momentum(middle), p%energy(middle)])
               if (points == 0 .or. p%ns > 0) points = k
            end associate
         end do
         if (points == 0) then
            write (line, "(a30, i6, a)") label_of(study%candidates(i)), study%candidates(i)%order, &
               "  no step size was small enough"
         else
            slope = slope_of(study%points, i)
            associate (p => study%points(points))
               write (line, "(a30, i6, f6.1, 3es10.1e2, f10.2, i7, a2, f12.1)") &
                  label_of(study%candidates(i)), study%candidates(i)%order, slope, least, p%ns, &
                  nint(100*p%ns_spread), " %", p%single
               if (p%repeats == 0) line(73:) = "         -" // "        -" // "           -"
            end associate
            if (.not. slope > 0) line(37:42) = "     -"
         end if
         call put(file, trim(line), error)
      end do
   end subroutine put_curves

end module poinsot_study_cost_files
