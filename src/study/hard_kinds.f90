!> Hard bodies of every kind through every method, against a Taylor series in quadruple precision.
!>
!> An error counts in units of conditioning: one unit is what moving each input by 1e-16 does to the
!> result. Each method crosses the time three times: in one step, as far as it takes it, in steps of
!> at most a fifth of a radian, and in these with compensated sums. `exact` and `jacobi` do so again
!> as hosts can have it: the body by `scale` of a class of another size, and by `moments` of its
!> own, with constants for each lane (every other case with compensated sums).
module poinsot_study_hard_kinds
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, qp
   use poinsot_core_error, only: poinsot_error
   use poinsot_core_status, only: poinsot_ok, poinsot_e_step, poinsot_e_convergence
   use poinsot_free_method, only: free_method, find_method, method_name
   use poinsot_study_hard_cases, only: hard_case, cases_of_kind, make_case
   use poinsot_study_taylor, only: taylor_flow, conditioning, largest_rate
   use poinsot_study_turn, only: turn_one, turn_scaled, turn_by_moments, momentum_gap, attitude_gap
   implicit none(type, external)
   private
   public :: hard_result, judge_kind, total, approaches, approach_names, takes_approach

   !> One kind, one method, one way of stepping.
   type :: hard_result
      integer :: answered = 0        !! cases with an answer
      integer :: too_long = 0        !! refused: POINSOT_E_STEP, POINSOT_E_CONVERGENCE
      integer :: other = 0           !! any other status, or an answer that is not finite
      real(dp) :: y = 0, q = 0       !! worst error in units of conditioning
      real(dp) :: largest = 0        !! worst plain error, of |y| and of q
      real(dp) :: part = 0           !! worst error over what is allowed
   end type hard_result

   !> Reference of one case.
   type :: solved_case
      type(hard_case) :: it
      real(qp) :: y(3), q(4)
      real(dp) :: of_y = 1, of_q = 1
      real(dp) :: turn = 0           !! h times the largest |omega|
      real(dp) :: thin = 1           !! largest moment over smallest
      integer :: pieces = 1
   end type solved_case

   real(dp), parameter :: piece = 0.2_dp
   integer, parameter :: whole = 1, pieces = 2, compensated = 3, by_scale = 4, by_moments = 5, &
      approaches = 5
   character(11), parameter :: approach_names(approaches) = [character(11) :: "whole", "pieces", &
      "compensated", "scale", "moments"]
   real(dp), parameter :: usual = 3     !! units that `exact` may lose by a class
   real(dp), parameter :: own_units = 2 !! and so many more by moments
   real(dp), parameter :: roundings = 20 !! units of conditioning that any method may lose

contains

   !> Every method on all cases of a kind: results(method, approach).
   subroutine judge_kind(kind, results)
      integer, intent(in) :: kind
      type(hard_result), intent(out) :: results(:, :)
      type(solved_case) :: one
      type(free_method) :: method
      type(poinsot_error) :: error
      integer :: number, m, a
      do number = 1, cases_of_kind
         call solve_case(kind, number, one)
         do m = 1, size(results, 1)
            call find_method(method_name(m), method, error)
            do a = 1, approaches
               if (.not. takes_approach(method_name(m), a)) cycle
               if (a /= pieces .and. a /= compensated) then
                  call judge_case(method, one, a, 1, number, results(m, a))
               end if
               if (a /= whole) call judge_case(method, one, a, one%pieces, number, results(m, a))
            end do
         end do
      end do
      do m = 1, size(results, 1)
         call judge_moments(results(m, :))
      end do
   end subroutine judge_kind

   !> Is a method tested this way? With scale and moments only the two exact ones.
   pure logical function takes_approach(name, approach)
      character(*), intent(in) :: name
      integer, intent(in) :: approach
      takes_approach = approach <= compensated .or. name == "exact" .or. name == "jacobi"
   end function takes_approach

   !> Constants for each lane may cost two units more than those of a class do at worst.
   subroutine judge_moments(results)
      type(hard_result), intent(inout) :: results(:)
      real(dp) :: class_units
      if (results(by_moments)%answered == 0) return
      class_units = max(usual, results(whole)%y, results(whole)%q, results(pieces)%y, &
         results(pieces)%q)
      results(by_moments)%part = max(results(by_moments)%y, results(by_moments)%q)/ &
         (class_units + own_units)
   end subroutine judge_moments

   subroutine solve_case(kind, number, one)
      integer, intent(in) :: kind, number
      type(solved_case), intent(out) :: one
      real(qp) :: inverse(3)
      call make_case(kind, number, one%it)
      inverse = 0
      where (one%it%moments > 0) inverse = 1/real(one%it%moments, qp)
      one%y = one%it%y
      one%q = one%it%q
      one%turn = real(largest_rate(inverse, one%y)*abs(one%it%h), dp)
      one%pieces = 1 + int(one%turn/piece)
      if (minval(one%it%moments) > 0) one%thin = maxval(one%it%moments)/minval(one%it%moments)
      call taylor_flow(inverse, real(one%it%h, qp), one%y, one%q, .false.)
      call conditioning(one%it%moments, one%it%y, one%it%h, one%it%with_moments, one%of_y, one%of_q)
   end subroutine solve_case

   subroutine judge_case(method, one, approach, steps, number, answer)
      type(free_method), intent(in) :: method
      type(solved_case), intent(in) :: one
      integer, intent(in) :: approach, steps, number
      type(hard_result), intent(inout) :: answer
      real(dp), parameter :: sizes(4) = [3.0_dp, 0.7_dp, 1e-6_dp, 1.7e9_dp] !! none a power of two
      real(dp) :: y(3), q(4), h, ey, eq, may
      integer :: status
      y = one%it%y
      q = one%it%q
      h = one%it%h/steps
      select case (approach)
      case (by_scale)
         call turn_scaled(method%name, one%it%moments, sizes(1 + mod(number, size(sizes))), h, &
                          steps, y, q, status)
      case (by_moments)
         call turn_by_moments(method%name, one%it%moments, h, steps, y, q, status, &
                              compensated=mod(number, 2) == 0)
      case default
         call turn_one(method%name, one%it%moments, h, steps, y, q, status, &
                       compensated=approach == compensated)
      end select
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
         may = allowed(method, one, steps)
         answer%part = max(answer%part, ey/(may*one%of_y), eq/(may*one%of_q))
      end if
   end subroutine judge_case

   !> What `steps` steps of a method may be off, for a condition number of 1: roundings, and as many
   !> times as there are steps the error of one by the method's order, three times the largest of
   !> one body at h |omega| = 1 (mathematics, section 2) scaled to the step at hand.
   pure real(dp) function allowed(method, one, steps)
      type(free_method), intent(in) :: method
      type(solved_case), intent(in) :: one
      integer, intent(in) :: steps
      ! of orders 2, 4, ..., 24
      real(dp), parameter :: at_one(12) = [0.5_dp, 1.5e-2_dp, 5e-4_dp, 2e-5_dp, 1e-6_dp, 4e-8_dp, &
         1.5e-9_dp, 5e-11_dp, 2e-12_dp, 1e-13_dp, 5e-15_dp, 5e-16_dp]
      real(dp) :: step, error
      integer :: row
      step = one%turn/steps
      error = 0
      row = max(1, min(size(at_one), method%order/2))
      if (method%order > 0) error = 3*at_one(row)*step**(method%order + 1)
      if (method%order > 2) error = error*max(1.0_dp, step)**4 ! the series converges slowly there
      ! what three-rotations moves into a thin body's axis turns it there
      if (method%kernel == "three-rotations" .and. one%thin > 10) then
         error = max(error, one%thin*step**2)
      end if
      allowed = min(2.0_dp, error*steps) + roundings*1e-16_dp
   end function allowed

   !> Several results as one.
   pure type(hard_result) function total(several)
      type(hard_result), intent(in) :: several(:)
      total%answered = sum(several%answered)
      total%too_long = sum(several%too_long)
      total%other = sum(several%other)
      total%y = maxval(several%y)
      total%q = maxval(several%q)
      total%largest = maxval(several%largest)
      total%part = maxval(several%part)
   end function total

end module poinsot_study_hard_kinds
