!> `poinsot hard`: every kind of hard body through every method, against a Taylor series in
!> quadruple precision.
!>
!> An error counts in units of conditioning: one unit is what moving each input by 1e-16 does to the
!> result. Each method crosses the time twice: in one step, as far as it takes it, and in steps of
!> at most a fifth of a radian.
module poinsot_study_hard
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok, poinsot_e_step, poinsot_e_convergence
   use poinsot_free_method, only: free_method, find_method, method_count, method_name
   use poinsot_scene_files, only: out_file, make_folder, open_out, put, finish_out
   use poinsot_study_hard_cases, only: hard_case, kind_names, kind_about, cases_of_kind, make_case
   use poinsot_study_taylor, only: taylor_flow, conditioning, largest_rate
   use poinsot_study_tell, only: tell
   use poinsot_study_turn, only: turn_one, momentum_gap, attitude_gap
   implicit none(type, external)
   private
   public :: run_hard, hard_result, judge_kind

   !> One kind, one method, one way of stepping.
   type :: hard_result
      integer :: answered = 0        !! cases with an answer
      integer :: too_long = 0        !! refused: POINSOT_E_STEP
      integer :: other = 0           !! any other status, or an answer that is not finite
      real(dp) :: y = 0, q = 0       !! worst error in units of conditioning
      real(dp) :: largest = 0        !! worst plain error, of |y| and of q
   end type hard_result

   !> Reference of one case.
   type :: solved_case
      type(hard_case) :: it
      real(qp) :: y(3), q(4)
      real(dp) :: of_y = 1, of_q = 1
      integer :: pieces = 1
   end type solved_case

   real(dp), parameter :: piece = 0.2_dp
   integer, parameter :: ways = 2
   character(6), parameter :: way_names(ways) = [character(6) :: "whole", "pieces"]
   character(20), parameter :: shown(11) = [character(20) :: "exact", "jacobi", "dmv2", "dmv4", &
      "dmv8", "dmv16", "dmv24", "midpoint", "three-rotations", "symmetric-rotation", "rattle"]
   character(7), parameter :: heads(11) = [character(7) :: "exact", "jacobi", "dmv2", "dmv4", &
      "dmv8", &
      "dmv16", "dmv24", "midpnt", "three", "symrot", "rattle"]

contains

   !> All kinds, all methods; tables on `unit`, DIR/hard.csv if there is a DIR. Error: POINSOT_E_IO.
   subroutine run_hard(folder, unit, error)
      character(*), intent(in) :: folder             !! where the file goes; "": nowhere
      integer, intent(in) :: unit                    !! open for formatted writing
      type(poinsot_error), intent(inout) :: error
      type(hard_result), allocatable :: results(:, :, :)
      integer :: kind
      allocate (results(method_count(), size(kind_names), ways))
      do kind = 1, size(kind_names)
         call judge_kind(kind, results(:, kind, :))
      end do
      call tell(unit, &
         "Hard bodies: worst error in units of conditioning (one unit: what moving "// &
         "inputs by")
      call tell(unit, "1e-16 does), against a Taylor series in quadruple precision")
      call show_table(unit, "The whole time in one step:", results(:, :, 1))
      call show_table(unit, "In steps of at most 0.2 radians:", results(:, :, 2))
      call show_legend(unit)
      call show_verdicts(unit, results)
      if (folder /= "") call write_csv(folder, results, error)
   end subroutine run_hard

   !> Every method on all cases of a kind: results(method, way).
   subroutine judge_kind(kind, results)
      integer, intent(in) :: kind
      type(hard_result), intent(out) :: results(:, :)
      type(solved_case) :: one
      integer :: number, m
      do number = 1, cases_of_kind
         call solve_case(kind, number, one)
         do m = 1, size(results, 1)
            call judge_case(method_name(m), one, 1, results(m, 1))
            call judge_case(method_name(m), one, one%pieces, results(m, 2))
         end do
      end do
   end subroutine judge_kind

   subroutine solve_case(kind, number, one)
      integer, intent(in) :: kind, number
      type(solved_case), intent(out) :: one
      real(qp) :: inverse(3)
      call make_case(kind, number, one%it)
      inverse = 0
      where (one%it%moments > 0) inverse = 1/real(one%it%moments, qp)
      one%y = one%it%y
      one%q = one%it%q
      one%pieces = 1 + int(largest_rate(inverse, one%y)*abs(one%it%h)/piece)
      call taylor_flow(inverse, real(one%it%h, qp), one%y, one%q, .false.)
      call conditioning(one%it%moments, one%it%y, one%it%h, one%it%with_moments, one%of_y, one%of_q)
   end subroutine solve_case

   subroutine judge_case(name, one, steps, answer)
      character(*), intent(in) :: name
      type(solved_case), intent(in) :: one
      integer, intent(in) :: steps
      type(hard_result), intent(inout) :: answer
      real(dp) :: y(3), q(4), ey, eq
      integer :: status
      y = one%it%y
      q = one%it%q
      call turn_one(name, one%it%moments, one%it%h/steps, steps, y, q, status)
      if (status == poinsot_e_step .or. status == poinsot_e_convergence) then
         answer%too_long = answer%too_long + 1
      else if (status /= poinsot_ok .or. .not. all(ieee_is_finite([y, q]))) then
         answer%other = answer%other + 1
      else
         ey = momentum_gap(real(y, qp), one%y)
         eq = attitude_gap(real(q, qp), one%q)
         answer%answered = answer%answered + 1
         answer%y = max(answer%y, ey/(1e-16_dp*one%of_y))
         answer%q = max(answer%q, eq/(1e-16_dp*one%of_q))
         answer%largest = max(answer%largest, ey, eq)
      end if
   end subroutine judge_case

   ! Showing
   ! ---------------------------------------------------------------------------------------------

   subroutine show_table(unit, title, results)
      integer, intent(in) :: unit
      character(*), intent(in) :: title
      type(hard_result), intent(in) :: results(:, :) !! (method, kind)
      character(8) :: cells(size(shown))
      character(120) :: line
      integer :: kind, j, m
      call tell(unit, "")
      call tell(unit, title)
      call tell(unit, "")
      write (line, "(11x, *(1x, a7))") adjustr(heads)
      call tell(unit, line)
      do kind = 1, size(kind_names)
         do j = 1, size(shown)
            m = method_number(shown(j))
            cells(j) = cell(results(m, kind))
         end do
         write (line, "(a11, *(a8))") kind_names(kind), cells
         call tell(unit, line)
      end do
   end subroutine show_table

   !> The number of a method in the registry.
   integer function method_number(name) result(m)
      character(*), intent(in) :: name
      do m = 1, method_count()
         if (method_name(m) == name) return
      end do
      m = 1
   end function method_number

   !> "    2.3", "4.6e+05", with a * where some were refused; "refused" where all were.
   function cell(one) result(text)
      type(hard_result), intent(in) :: one
      character(8) :: text
      real(dp) :: worst
      worst = max(one%y, one%q)
      if (one%other > 0) then
         text = "  FAILED"
      else if (one%answered == 0) then
         text = " refused"
      else
         if (worst < 999.5_dp) then
            write (text, "(f7.1)") worst
         else
            write (text, "(es7.0e2)") worst
         end if
         text(8:8) = merge("*", " ", one%too_long > 0)
      end if
   end function cell

   subroutine show_legend(unit)
      integer, intent(in) :: unit
      character(120) :: line
      integer :: kind
      call tell(unit, "")
      call tell(unit, "refused: status 'step too long' or 'no convergence', state kept; "// &
         "*: in some of the cases")
      write (line, "(a, i0, a)") "A step of any size up to 20 radians unless said; ", &
         cases_of_kind, &
         " cases of each kind, in all orders of the axes:"
      call tell(unit, line)
      call tell(unit, "")
      do kind = 1, size(kind_names)
         call tell(unit, "   "//kind_names(kind)//"  "//kind_about(kind))
      end do
   end subroutine show_legend

   !> One sentence on every method.
   subroutine show_verdicts(unit, results)
      integer, intent(in) :: unit
      type(hard_result), intent(in) :: results(:, :, :)
      character(20) :: name
      integer :: m
      call tell(unit, "")
      call tell(unit, "Verdicts")
      call tell(unit, "")
      do m = 1, method_count()
         name = method_name(m)
         call tell(unit, "   "//name//"in one step "//verdict(m, total(results(m, :, 1)))// &
            "; in pieces "//verdict(m, total(results(m, :, 2))))
      end do
   end subroutine show_verdicts

   !> Several results as one.
   pure type(hard_result) function total(several)
      type(hard_result), intent(in) :: several(:)
      total%answered = sum(several%answered)
      total%too_long = sum(several%too_long)
      total%other = sum(several%other)
      total%y = maxval(several%y)
      total%q = maxval(several%q)
      total%largest = maxval(several%largest)
   end function total

   !> A result in words.
   function verdict(m, one) result(words)
      integer, intent(in) :: m                       !! number of the method
      type(hard_result), intent(in) :: one
      character(:), allocatable :: words
      type(free_method) :: method
      type(poinsot_error) :: error
      character(12) :: number
      real(dp) :: worst
      call find_method(method_name(m), method, error)
      worst = max(one%y, one%q)
      if (one%other > 0) then
         words = "FAILED"
      else if (one%answered == 0) then
         words = "refused"
      else
         if (worst <= 10) then
            write (number, "(f4.1)") worst
            words = "right to rounding ("//trim(adjustl(number))//" units)"
         else if (method%order == 0) then
            write (number, "(es8.1)") worst
            words = merge("a digit lost ", "digits lost  ", worst <= 100)
            words = trim(words)//" ("//trim(adjustl(number))//" units)"
         else
            write (number, "(es8.1)") one%largest
            words = "off by "//trim(adjustl(number))
            if (one%largest > 0.1_dp) words = words//", of no use"
         end if
         if (one%too_long > 0) then
            write (number, "(i0)") one%too_long
            words = words//", "//trim(number)//" refused"
         end if
      end if
   end function verdict

   subroutine write_csv(folder, results, error)
      character(*), intent(in) :: folder
      type(hard_result), intent(in) :: results(:, :, :)
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(200) :: line
      integer :: m, kind, way
      call make_folder(folder, error)
      if (.not. raised(error)) call open_out(folder//"/hard.csv", file, error)
      if (raised(error)) return
      call put(file, &
         "kind,method,way,answered,too_long,failed,units_y,units_q,largest_error,verdict", error)
      do kind = 1, size(kind_names)
         do m = 1, method_count()
            do way = 1, ways
               associate (one => results(m, kind, way))
                  write (line, "(3(a, ','), 3(i0, ','), 3(es9.3, ','), 3a)") &
                     trim(kind_names(kind)), method_name(m), trim(way_names(way)), one%answered, &
                     one%too_long, one%other, one%y, one%q, one%largest, '"', verdict(m, one), '"'
               end associate
               call put(file, trim(line), error)
            end do
         end do
      end do
      call finish_out(file, error)
   end subroutine write_csv

end module poinsot_study_hard
