!> The rows of `poinsot hard`: case, method, figure and verdict.
module poinsot_study_hard_rows
   use poinsot_core_kinds, only: dp, name_length
   use poinsot_free_method, only: method_count, method_name
   use poinsot_scene_watch, only: run_watch
   use poinsot_splitting_registry, only: is_table, splitting_count, splitting_name
   use poinsot_study_hard_cases, only: kind_names
   use poinsot_study_hard_kinds, only: hard_result, judge_kind, approaches, approach_names, &
      takes_approach
   use poinsot_study_hard_promises, only: promise_names, promise_bounds, measure_promise, &
      broken, measured_nothing
   use poinsot_study_hard_series, only: series_names, series_bound, measure_series
   use poinsot_study_hard_tops, only: top_names, measure_top, top_bound
   implicit none(type, external)
   private
   public :: hard_row, measure_rows, find_row, verdict_words, is_case

   !> One method or splitting on one case.
   type :: hard_row
      character(11) :: case = ""
      character(name_length) :: who = "" !! method, or splitting
      character(11) :: approach = ""     !! of `approach_names`; "": there is one only
      type(hard_result) :: counts = hard_result() !! answers and refusals of a kind of bodies
      real(dp) :: figure = 0             !! worst error, in conditioning units or in 1e-16
      real(dp) :: part = 0               !! over the bound; above 1: broken
      logical :: good = .true.
   end type hard_row

contains

   !> All rows, or those of a case, method or splitting.
   subroutine measure_rows(only, watch, rows)
      character(*), intent(in) :: only                      !! "": all
      class(run_watch), intent(inout) :: watch              !! told how many cases are done
      type(hard_row), allocatable, intent(out) :: rows(:)
      type(hard_result) :: results(method_count(), approaches)
      type(hard_row) :: row
      integer :: k, m, w
      allocate (rows(0))
      do k = 1, size(kind_names)
         if (is_case(only) .and. only /= kind_names(k)) cycle
         call tell(k - 1)
         call judge_kind(k, results)
         do m = 1, method_count()
            do w = 1, approaches
               if (.not. takes_approach(method_name(m), w)) cycle
               row = hard_row(kind_names(k), method_name(m), approach_names(w), results(m, w))
               row%figure = max(results(m, w)%y, results(m, w)%q)
               row%part = results(m, w)%part
               row%good = row%part <= 1 .and. results(m, w)%other == 0
               call add(row)
            end do
         end do
      end do
      do k = 1, size(promise_names)
         if (is_case(only) .and. only /= promise_names(k)) cycle
         call tell(size(kind_names) + k - 1)
         do m = 1, method_count()
            row = hard_row(promise_names(k), method_name(m))
            row%figure = measure_promise(k, method_name(m))
            call judge(promise_bounds(k))
            call add(row)
         end do
      end do
      do k = 1, size(top_names)
         if (is_case(only) .and. only /= top_names(k)) cycle
         call tell(size(kind_names) + size(promise_names) + k - 1)
         do m = 1, splitting_count()
            if (.not. is_table(m)) cycle
            row = hard_row(top_names(k), splitting_name(m))
            row%figure = measure_top(k, splitting_name(m))
            call judge(top_bound(k, splitting_name(m)))
            call add(row)
         end do
      end do
      do k = 1, size(series_names)
         if (is_case(only) .and. only /= series_names(k)) cycle
         if (.not. is_case(only) .and. only /= "" .and. only /= "taylor") cycle
         call tell(size(kind_names) + size(promise_names) + size(top_names) + k - 1)
         row = hard_row(series_names(k), "taylor")
         row%figure = measure_series(k)
         call judge(series_bound)
         call add(row)
      end do

   contains

      subroutine tell(done)
         integer, intent(in) :: done
         call watch%report_progress(real(done, dp), real(size(kind_names) + size(promise_names) + &
            size(top_names) + size(series_names), dp))
      end subroutine tell

      subroutine judge(bound)
         real(dp), intent(in) :: bound
         row%good = row%figure <= bound
         row%part = 0
         if (bound > 0 .and. row%figure < broken) row%part = max(0.0_dp, row%figure/bound)
      end subroutine judge

      subroutine add(one)
         type(hard_row), intent(in) :: one
         if (only == "" .or. is_case(only) .or. only == one%who) rows = [rows, one]
      end subroutine add

   end subroutine measure_rows

   !> Is it the name of a case?
   pure logical function is_case(name)
      character(*), intent(in) :: name
      is_case = any(kind_names == name) .or. any(promise_names == name) &
         .or. any(top_names == name) .or. any(series_names == name)
   end function is_case

   !> Index of a row; 0 if there is none.
   pure integer function find_row(rows, case, who, approach) result(i)
      type(hard_row), intent(in) :: rows(:)
      character(*), intent(in) :: case, who, approach
      do i = size(rows), 1, -1
         if (rows(i)%case == case .and. rows(i)%who == who .and. &
            rows(i)%approach == approach) return
      end do
   end function find_row

   !> The verdict in words.
   function verdict_words(row) result(words)
      type(hard_row), intent(in) :: row
      character(:), allocatable :: words
      character(9) :: number
      if (.not. row%good) then
         words = "BROKEN"
      else if (row%figure <= measured_nothing) then
         words = "not promised"
      else if (row%approach == "") then
         words = "kept"
         if (row%figure <= 0) words = "kept bitwise"
      else if (row%counts%answered == 0) then
         words = "refused"
      else
         words = "accurate to rounding error"
         if (row%figure > 20) then
            write (number, "(es8.1)") row%counts%largest
            words = "off by "//trim(adjustl(number))//", as its order allows"
         end if
         if (row%counts%largest > 0.1_dp) words = words//", of no use"
         if (row%counts%too_long > 0) then
            write (number, "(i0)") row%counts%too_long
            words = words//"; "//trim(number)//" refused"
         end if
      end if
   end function verdict_words

end module poinsot_study_hard_rows
