!> `poinsot hard`: hard bodies, steps and tops for every method and splitting, with a verdict on
!> each, as tables and as CSV.
module poinsot_study_hard
   use poinsot_core_kinds, only: dp, name_length
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_nearest, only: suggestion
   use poinsot_core_status, only: poinsot_e_convergence, poinsot_e_method
   use poinsot_free_method, only: free_method, find_method, method_count, method_name
   use poinsot_scene_files, only: out_file, make_folder, open_out, put, finish_out
   use poinsot_scene_watch, only: run_watch
   use poinsot_splitting_registry, only: is_table, splitting_count, splitting_name
   use poinsot_study_hard_cases, only: kind_names, kind_about, cases_of_kind
   use poinsot_study_hard_kinds, only: approach_names
   use poinsot_study_hard_promises, only: promise_names, promise_bounds, promise_about, &
      broken, measured_nothing
   use poinsot_study_hard_rows, only: hard_row, measure_rows, find_row, verdict_words
   use poinsot_study_hard_series, only: series_names, series_bound, series_about
   use poinsot_study_hard_tops, only: top_names, top_bounds, top_about
   use poinsot_study_write_line, only: write_line
   implicit none(type, external)
   private
   public :: run_hard

contains

   !> Everything, or one case, method or splitting in full; tables on `unit`, DIR/hard.csv if there
   !> is a DIR. Error: POINSOT_E_METHOD for an unknown name, POINSOT_E_IO, POINSOT_E_CONVERGENCE if
   !> a verdict is bad.
   subroutine run_hard(only, folder, unit, watch, error)
      character(*), intent(in) :: only               !! a name; "": everything, as tables
      character(*), intent(in) :: folder             !! where the file goes; "": nowhere
      integer, intent(in) :: unit                    !! open for formatted writing
      class(run_watch), intent(inout) :: watch       !! told how many cases are done
      type(poinsot_error), intent(inout) :: error
      type(hard_row), allocatable :: rows(:)
      character(60) :: text
      integer :: i, bad
      call check_name(only, error)
      if (raised(error)) return
      call measure_rows(only, watch, rows)
      call watch%wipe()
      if (only == "") then
         call show_kinds(unit, rows)
         call show_promises(unit, rows)
         call show_tops(unit, rows)
         call show_series(unit, rows)
         call show_verdicts(unit, rows)
      else
         do i = 1, size(rows)
            call write_line(unit, line_of(rows(i)))
         end do
      end if
      if (folder /= "") call write_csv(folder, rows, error)
      bad = count(.not. rows%good)
      write (text, "(i0, a, i0, a)") size(rows) - bad, " of ", size(rows), " verdicts are good"
      call write_line(unit, "")
      call write_line(unit, text)
      if (bad > 0 .and. .not. raised(error)) call raise(error, poinsot_e_convergence, &
         "hard: a bound is broken, see BROKEN above")
   end subroutine run_hard

   subroutine check_name(only, error)
      character(*), intent(in) :: only
      type(poinsot_error), intent(inout) :: error
      character(name_length), allocatable :: names(:)
      integer :: i
      if (only == "") return
      names = [character(name_length) :: kind_names, promise_names, top_names, series_names]
      do i = 1, method_count()
         names = [character(name_length) :: names, method_name(i)]
      end do
      do i = 1, splitting_count()
         names = [character(name_length) :: names, splitting_name(i)]
      end do
      if (any(names == only)) return
      call raise(error, poinsot_e_method, "hard: there is no case, method or splitting '"//only// &
         "'"//suggestion(only, names))
   end subroutine check_name

   ! Tables
   ! ---------------------------------------------------------------------------------------------

   !> The methods that have a column in the tables, and its heading.
   subroutine shown_methods(names, heads)
      character(name_length), allocatable, intent(out) :: names(:)
      character(7), allocatable, intent(out) :: heads(:)
      type(free_method) :: method
      type(poinsot_error) :: error
      integer :: i
      allocate (names(0), heads(0))
      do i = 1, method_count()
         call find_method(method_name(i), method, error)
         if (method%heading == "") cycle
         names = [names, method%name]
         heads = [heads, method%heading]
      end do
   end subroutine shown_methods

   subroutine show_kinds(unit, rows)
      integer, intent(in) :: unit
      type(hard_row), intent(in) :: rows(:)
      character(name_length), allocatable :: shown(:)
      character(7), allocatable :: heads(:)
      character(400) :: line
      character(40), parameter :: titles(3) = [character(40) :: "The whole time in one step:", &
         "In steps of at most 0.2 radians:", "In such steps, with compensated sums:"]
      integer :: kind, w
      call shown_methods(shown, heads)
      call write_line(unit, "Hard bodies: worst error in units of conditioning (one unit: the "// &
         "effect of changing")
      call write_line(unit, "all inputs by 1e-16), against a Taylor series in quadruple precision")
      do w = 1, size(titles)
         call write_line(unit, "")
         call write_line(unit, titles(w))
         call write_line(unit, "")
         write (line, "(11x, *(1x, a7))") adjustr(heads)
         call write_line(unit, line)
         do kind = 1, size(kind_names)
            call write_line(unit, table_line(kind_names(kind), rows, shown, approach_names(w)))
         end do
      end do
      call show_own(unit, rows)
      call write_line(unit, "")
      call write_line(unit, "refused: status 'step too long' or 'no convergence', state kept; "// &
         "*: in some cases")
      write (line, "(a, i0, a)") "Steps of any size up to 20 radians unless stated; ", &
         cases_of_kind, " cases of each kind, in all orders of the axes:"
      call write_line(unit, line)
      call write_line(unit, "")
      do kind = 1, size(kind_names)
         call write_line(unit, "   "//kind_names(kind)//"  "//kind_about(kind))
      end do
   end subroutine show_kinds

   !> The two methods that hosts have by scale and by moments of each body.
   subroutine show_own(unit, rows)
      integer, intent(in) :: unit
      type(hard_row), intent(in) :: rows(:)
      character(name_length), parameter :: whom(2) = [character(name_length) :: "exact", "jacobi"]
      character(8) :: cells(4)
      character(80) :: line
      integer :: kind, w
      call write_line(unit, "")
      call write_line(unit, "With scale of a class of another size, and with moments of each "// &
         "body; the worse of")
      call write_line(unit, "one step and steps of 0.2:")
      call write_line(unit, "")
      call write_line(unit, "            exact: scale  moments jacobi: scale  moments")
      do kind = 1, size(kind_names)
         do w = 1, 2
            cells(2*w - 1) = cell(rows(find_row(rows, kind_names(kind), whom(w), "scale")))
            cells(2*w) = cell(rows(find_row(rows, kind_names(kind), whom(w), "moments")))
         end do
         write (line, "(a11, 2(3x, 2a9))") kind_names(kind), cells
         call write_line(unit, line)
      end do
   end subroutine show_own

   subroutine show_promises(unit, rows)
      integer, intent(in) :: unit
      type(hard_row), intent(in) :: rows(:)
      character(name_length), allocatable :: shown(:)
      character(7), allocatable :: heads(:)
      character(400) :: line
      integer :: k
      call shown_methods(shown, heads)
      call write_line(unit, "")
      call write_line(unit, &
         "Promises of every method, in 1e-16 of |y| and of 1; 0: bitwise; -: "// &
         "not promised")
      call write_line(unit, "")
      write (line, "(11x, *(1x, a7))") adjustr(heads)
      call write_line(unit, line)
      do k = 1, size(promise_names)
         call write_line(unit, table_line(promise_names(k), rows, shown, ""))
      end do
      call write_line(unit, "")
      do k = 1, size(promise_names)
         call write_line(unit, legend(promise_names(k), promise_about(k), promise_bounds(k)))
      end do
   end subroutine show_promises

   !> A line for each splitting, so that there is room for any number of them.
   subroutine show_tops(unit, rows)
      integer, intent(in) :: unit
      type(hard_row), intent(in) :: rows(:)
      character(8) :: cells(size(top_names))
      character(120) :: line
      integer :: i, k
      call write_line(unit, "")
      call write_line(unit, "Tops and fields by every splitting, with the exact rotor, in 1e-16:")
      call write_line(unit, "")
      write (line, "(19x, *(1x, a8))") (adjustr(top_names(k)(:8)), k=1, size(top_names))
      call write_line(unit, line)
      do i = 1, splitting_count()
         if (.not. is_table(i)) cycle
         do k = 1, size(top_names)
            cells(k) = cell(rows(find_row(rows, top_names(k), splitting_name(i), "")))
         end do
         write (line, "(a, t20, *(1x, a8))") splitting_name(i), cells
         call write_line(unit, line)
      end do
      call write_line(unit, "")
      do k = 1, size(top_names)
         call write_line(unit, legend(top_names(k), top_about(k), top_bounds(k)))
      end do
   end subroutine show_tops

   !> Tops by `taylor`.
   subroutine show_series(unit, rows)
      integer, intent(in) :: unit
      type(hard_row), intent(in) :: rows(:)
      character(120) :: line
      integer :: k
      call write_line(unit, "")
      call write_line(unit, "Tops by taylor, tolerance 1e-15, in one call, forwards and "// &
         "backwards; in units of conditioning")
      write (line, "(a, f4.1, a)") "by momentum, attitude, torque and time (bound", &
         series_bound, "):"
      call write_line(unit, line)
      call write_line(unit, "")
      do k = 1, size(series_names)
         write (line, "(a11, a8, 2x, a)") series_names(k), cell(rows(find_row(rows, &
            series_names(k), "taylor", ""))), series_about(k)
         call write_line(unit, line)
      end do
   end subroutine show_series

   function legend(name, about, bound) result(line)
      character(*), intent(in) :: name, about
      real(dp), intent(in) :: bound                  !! in 1e-16; negative: by the order
      character(120) :: line
      character(24) :: text
      write (text, "(a, es6.0e2, a)") "  (bound ", bound, ")"
      if (.not. abs(bound) > 0) text = "  (bound 0)"
      if (bound < 0) text = "  (bound by the scheme)"
      line = "   "//name//"  "//trim(about)//text
   end function legend

   !> One line of a table: the case, and a cell for each method or splitting.
   function table_line(case, rows, names, approach) result(line)
      character(*), intent(in) :: case, names(:), approach
      type(hard_row), intent(in) :: rows(:)
      character(400) :: line
      character(8) :: cells(size(names))
      integer :: j
      do j = 1, size(names)
         cells(j) = cell(rows(find_row(rows, case, trim(names(j)), approach)))
      end do
      write (line, "(a11, *(a8))") case//repeat(" ", 11), cells
   end function table_line

   !> "    2.3", "4.6e+05", with a * where some were refused; "refused" where all were.
   function cell(row) result(text)
      type(hard_row), intent(in) :: row
      character(8) :: text
      if (row%counts%other > 0 .or. row%figure >= broken .or. &
         (row%approach == "" .and. .not. row%good)) then
         text = "  BROKEN"
      else if (row%figure <= measured_nothing) then
         text = "      -"
      else if (row%approach /= "" .and. row%counts%answered == 0) then
         text = " refused"
      else
         if (.not. row%figure > 0) then
            text = "      0"
         else if (row%figure < 999.5_dp) then
            write (text, "(f7.1)") row%figure
         else
            write (text, "(es7.0e2)") row%figure
         end if
         text(8:8) = merge("*", " ", row%counts%too_long > 0)
      end if
   end function cell

   ! Verdicts
   ! ---------------------------------------------------------------------------------------------

   !> One sentence on every method and splitting.
   subroutine show_verdicts(unit, rows)
      integer, intent(in) :: unit
      type(hard_row), intent(in) :: rows(:)
      integer :: m
      call write_line(unit, "")
      call write_line(unit, "Verdicts; the worst figure over its bound, and where")
      call write_line(unit, "")
      do m = 1, method_count()
         call write_line(unit, sentence(method_name(m), rows))
      end do
      do m = 1, splitting_count()
         if (.not. is_table(m)) cycle
         call write_line(unit, sentence(splitting_name(m), rows))
      end do
      call write_line(unit, sentence("taylor", rows))
   end subroutine show_verdicts

   function sentence(who, rows) result(line)
      character(*), intent(in) :: who
      type(hard_row), intent(in) :: rows(:)
      character(:), allocatable :: line
      character(60) :: numbers
      character(20) :: name
      integer :: i, worst, refused, bad
      name = who
      worst = 0
      refused = 0
      bad = 0
      do i = 1, size(rows)
         if (rows(i)%who /= who) cycle
         if (worst == 0) worst = i
         if (rows(i)%part > rows(worst)%part) worst = i
         refused = refused + rows(i)%counts%too_long
         if (.not. rows(i)%good) bad = bad + 1
      end do
      write (numbers, "(f7.3, 2a)") min(rows(worst)%part, 999.0_dp), &
         " of the bound, ", trim(rows(worst)%case)
      line = "   "//name//merge("good   ", "BROKEN ", bad == 0)//trim(numbers)
      select case (rows(worst)%approach)
      case ("pieces")
         line = line//" in pieces"
      case ("scale", "moments")
         line = line//" by "//trim(rows(worst)%approach)
      case ("compensated")
         line = line//" with compensated sums"
      case default ! in one step, or there is one way only
      end select
      if (refused > 0) then
         write (numbers, "(a, i0, a)") "; ", refused, " steps refused"
         line = line//trim(numbers)
      end if
   end function sentence

   !> A row in full.
   function line_of(row) result(line)
      type(hard_row), intent(in) :: row
      character(140) :: line
      character(8) :: figure
      character(24) :: part
      figure = cell(row)
      part = ""
      if (row%part > 0) write (part, "(f7.3, a)") min(row%part, 999.0_dp), " of the bound"
      line = row%case//" "//row%who(:20)//row%approach//figure//"  "//part//verdict_words(row)
   end function line_of

   subroutine write_csv(folder, rows, error)
      character(*), intent(in) :: folder
      type(hard_row), intent(in) :: rows(:)
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(200) :: line
      character(9) :: figure
      integer :: i
      call make_folder(folder, error)
      if (.not. raised(error)) call open_out(folder//"/hard.csv", file, error)
      if (raised(error)) return
      call put(file, "case,who,way,answered,refused,failed,units_y,units_q,largest_error,"// &
         "figure,part_of_bound,good,verdict", error)
      do i = 1, size(rows)
         associate (row => rows(i), of => rows(i)%counts)
            figure = ""
            if (row%figure >= 0 .and. row%figure < broken) write (figure, "(es9.3)") row%figure
            write (line, "(3(a, ','), 3(i0, ','), 3(es9.3, ','), a, ',', f6.4, ',', i0, ',', 3a)") &
               trim(row%case), trim(row%who), trim(row%approach), of%answered, of%too_long, &
                  of%other, &
               of%y, of%q, of%largest, trim(figure), min(row%part, 9.0_dp), &
               merge(1, 0, row%good), '"', verdict_words(row), '"'
         end associate
         call put(file, trim(line), error)
      end do
      call finish_out(file, error)
   end subroutine write_csv

end module poinsot_study_hard
