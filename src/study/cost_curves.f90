!> The points of a cost study that its pictures show.
module poinsot_study_cost_curves
   use poinsot_core_kinds, only: dp
   use poinsot_study_cost_data, only: cost_study
   use poinsot_study_cost_point, only: error_of, middle
   implicit none(type, external)
   private
   public :: find_curve

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
      associate (one => study%candidates(candidate))
         if (one%order == 0 .and. .not. one%adaptive) return ! exact at any step: no such end
      end associate
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

end module poinsot_study_cost_curves
