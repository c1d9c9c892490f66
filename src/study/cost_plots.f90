!> Pictures of a cost study: which there are, and cost.gp and rivals.csv, the data that their
!> scripts (share/poinsot/plots) need besides cost.csv and drift.csv.
module poinsot_study_cost_plots
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_claim, only: picture_claims
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_plot_data, only: put_variable
   use poinsot_scene_settings, only: scene_settings
   use poinsot_study_candidates, only: label_of
   use poinsot_study_cost_curves, only: find_curve
   use poinsot_study_cost_data, only: cost_study, few
   use poinsot_study_cost_point, only: middle, of_angle, of_momentum, slope_of
   use poinsot_study_efficient, only: frontier_part, leading_parts
   use poinsot_study_rivals, only: rival_names
   use poinsot_study_statistics, only: median
   implicit none(type, external)
   private
   public :: write_cost_plots, cost_pictures, cost_files

   character(16), parameter :: all_pictures(4) = [character(16) :: "attitude_cost", &
      "momentum_cost", "attitude_step", "energy_drift"]
   integer, parameter :: label_length = 52, strong = 8 !! curves with colours of their own
   real(dp), parameter :: rounding = 1e-13_dp !! curves below this are rounding alone

contains

   !> cost.gp, and rivals.csv if there are any. Error: POINSOT_E_IO.
   subroutine write_cost_plots(out, scene, study, error)
      character(*), intent(in) :: out           !! folder of cost.csv
      type(scene_settings), intent(in) :: scene
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      if (raised(error)) return
      call open_out(out // "/cost.gp", file, error)
      if (raised(error)) return
      call put(file, "# What plot_*.gp need to know of cost.csv and drift.csv.", error)
      call put_variable(file, "scene", scene%name, error)
      call put_variable(file, "t_end", study%t_end, error)
      call put_variable(file, "states", study%members%n, error)
      call put_doubt(file, study, error)
      call put(file, "# all candidates, where they are few; those on the efficient frontier, " // &
               "coarse to fine; how many", error)
      call put_variable(file, "few", merge(1, 0, size(study%candidates) <= few), error)
      if (size(study%candidates) <= few) then
         call put_names(file, "candidates", "candidate", all_labels(study), error)
      end if
      call put_names(file, "angle_front", "angle_names", front_labels(study, of_angle), error)
      call put_names(file, "momentum_front", "momentum_names", front_labels(study, of_momentum), &
                     error)
      call put_steps(file, study, error)
      call put_rivals(file, out, study, error)
      call finish_out(file, error)
   end subroutine write_cost_plots

   !> The pictures that a study has.
   pure function cost_pictures(study) result(names)
      type(cost_study), intent(in) :: study
      character(16), allocatable :: names(:)
      names = all_pictures(:merge(4, 3, size(study%drift) > 0))
   end function cost_pictures

   !> Every file that a cost study may write into its folder.
   pure function cost_files() result(names)
      character(64), allocatable :: names(:), pictures(:)
      character(64), parameter :: data(6) = [character(64) :: "cost.csv", "drift.csv", &
         "members.csv", "cost.txt", "cost.gp", "rivals.csv"]
      pictures = picture_claims(all_pictures)
      names = [data, pictures]
   end function cost_files

   !> A number and an array of names.
   subroutine put_names(file, count_name, name, labels, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: count_name, name, labels(:)
      type(poinsot_error), intent(inout) :: error
      call put_variable(file, count_name, size(labels), error)
      call put_variable(file, name, labels, error)
   end subroutine put_names

   !> Errors that the reference cannot vouch for; 0 if it is exact.
   subroutine put_doubt(file, study, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      real(dp) :: doubt(2)
      doubt = 0
      if (.not. study%kind%free) then
         doubt = [median(study%reference%angle), median(study%reference%momentum)]
      end if
      call put(file, "# the reference's own errors, median; 0: none", error)
      call put_variable(file, "doubt_angle", doubt(1), error)
      call put_variable(file, "doubt_momentum", doubt(2), error)
   end subroutine put_doubt

   pure function all_labels(study) result(labels)
      type(cost_study), intent(in) :: study
      character(label_length) :: labels(size(study%candidates))
      integer :: i
      do i = 1, size(labels)
         labels(i) = label_of(study%candidates(i))
      end do
   end function all_labels

   !> Who is on the frontier, each once, coarse to fine; the splittings that would be without
   !> `taylor`; and the exact rotation of a free body.
   pure function front_labels(study, what) result(labels)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: what                  !! of_angle, of_momentum
      character(label_length), allocatable :: labels(:)
      type(frontier_part), allocatable :: parts(:)
      character(label_length) :: label
      integer :: i
      call leading_parts(study%points, size(study%candidates), what, parts)
      allocate (labels(0))
      do i = 1, size(parts)
         label = label_of(study%candidates(parts(i)%candidate))
         if (.not. any(labels == label) .and. size(labels) < strong) labels = [labels, label]
      end do
      label = "exact"
      if (any(all_labels(study) == label) .and. .not. any(labels == label)) labels = [labels, label]
   end function front_labels

   !> What the picture of errors against steps shows: all candidates with a slope, and the exact
   !> ones; where there are too many, the splittings of the exact rotation.
   subroutine put_steps(file, study, error)
      type(out_file), intent(in) :: file
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      character(label_length), allocatable :: labels(:)
      integer, allocatable :: orders(:)
      real(dp), allocatable :: slopes(:)
      integer :: k
      allocate (labels(0), orders(0), slopes(0))
      do k = 1, size(study%candidates)
         if (.not. has_steps(study, k)) cycle
         labels = [character(label_length) :: labels, label_of(study%candidates(k))]
         orders = [orders, study%candidates(k)%order]
         slopes = [slopes, merge(slope_of(study%points, k), 0.0_dp, orders(size(orders)) > 0)]
      end do
      call put(file, "# in the picture of errors against steps; order 0: exact; slope 0: none", &
               error)
      call put_names(file, "shown", "shown_name", labels, error)
      call put_variable(file, "shown_order", orders, error)
      call put_variable(file, "shown_slope", slopes, error)
   end subroutine put_steps

   pure logical function has_steps(study, k)
      type(cost_study), intent(in) :: study
      integer, intent(in) :: k
      integer :: first, last
      associate (one => study%candidates(k))
         has_steps = size(study%candidates) <= few .or. one%method == "exact"
         call find_curve(study, k, of_angle, first, last)
         if (first == 0 .or. (last == first .and. one%order > 0)) has_steps = .false.
         if (one%adaptive) has_steps = .false. ! it has tolerances
         if (.not. has_steps) return
         has_steps = any(study%points(first:last)%good)
         if (one%order > 0) has_steps = has_steps .and. &
            any(study%points(first:last)%good .and. &
                study%points(first:last)%angle(middle) > rounding)
      end associate
   end function has_steps

   !> Rivals' names here, their points into rivals.csv.
   subroutine put_rivals(file, out, study, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: out
      type(cost_study), intent(in) :: study
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: table
      character(32), allocatable :: names(:)
      character(60) :: numbers
      integer :: i
      call rival_names(study%rivals, names)
      call put(file, "# other integrators, of --rivals", error)
      call put_names(file, "rivals", "rival_name", plain(names), error)
      if (size(names) == 0) return
      call open_out(out // "/rivals.csv", table, error)
      if (raised(error)) return
      call put(table, "name,angle_median,momentum_median,ns_per_time", error)
      do i = 1, size(study%rivals)
         associate (r => study%rivals(i))
            write (numbers, "(3(',', es12.5e3))") r%angle(1), r%momentum(1), r%time
            call put(table, trim(plain(r%name)) // trim(numbers), error)
         end associate
      end do
      call finish_out(table, error)
   end subroutine put_rivals

   !> A name that means nothing to a reader of CSV: without double quotes.
   elemental function plain(name)
      character(*), intent(in) :: name
      character(len(name)) :: plain
      integer :: i
      plain = name
      do i = 1, len(name)
         if (name(i:i) == """") plain(i:i) = "'"
      end do
   end function plain

end module poinsot_study_cost_plots
