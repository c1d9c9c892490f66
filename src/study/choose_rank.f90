!> Ranking of the candidates that meet a tolerance: the likely ones are timed in turn, and among
!> those of equal cost the most accurate is chosen.
module poinsot_study_choose_rank
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_scene_settings, only: scene_settings, body_total
   use poinsot_study_choice, only: choice, chosen
   use poinsot_study_choose_trials, only: trials
   use poinsot_study_clock, only: time_limit, left_of
   use poinsot_study_members, only: member_set, repeat_members
   use poinsot_study_search, only: contender, step_of, run_cost
   use poinsot_study_statistics, only: median
   use poinsot_study_timing, only: time_steps
   implicit none(type, external)
   private
   public :: time_finalists, take, best_of, pick_finalists, finalists

   integer, parameter :: finalists = 10, repeats = 9
   real(dp), parameter :: final_share = 1.5_dp !! times the cheapest: timed again
   real(dp), parameter :: as_cheap = 1.1_dp    !! times closer than this are the same
   real(dp), parameter :: one_run = 1e-3_dp
   real(dp), parameter, public :: no_cost = 1e100_dp  !! of who does not meet the tolerance

contains

   !> Time those that may be the cheapest in turn, and rank them.
   subroutine time_finalists(scene, all, limit, answer)
      type(scene_settings), intent(in) :: scene
      type(trials), intent(in) :: all
      type(time_limit), intent(in) :: limit
      type(choice), intent(inout) :: answer
      type(member_set) :: many
      real(dp) :: cost_of(size(all%list)), times(repeats, finalists)
      integer :: at(finalists), i, k, n, round, done
      many = all%task%members
      if (many%together == 1) call repeat_members(all%task%members, int(min(body_total(scene), &
         1024_i8)), many)
      cost_of = no_cost
      do i = 1, size(all%list)
         associate (one => all%contenders(i))
            if (one%met > 0) cost_of(i) = run_cost(one, one%met)
         end associate
      end do
      call pick_finalists(cost_of, all%contenders%adaptive, at, n)
      done = 0
      do round = 1, repeats
         if (round > 1 .and. left_of(limit) < 0) exit
         do i = 1, n
            associate (one => all%contenders(at(i)))
               call time_steps(one%plan, many, step_of(one, one%met), one%ns*max(1, lanes/many%n), &
                  one_run, one%unit*one%met, .true., times(round, i))
            end associate
         end do
         done = round
      end do
      cost_of = no_cost
      do i = 1, n
         associate (one => all%contenders(at(i)))
            if (minval(times(:done, i)) > 0) cost_of(at(i)) = median(times(:done, i))* &
               real(one%met*one%unit, dp)
         end associate
      end do
      if (minval(cost_of) >= no_cost) cost_of(at(1)) = run_cost(all%contenders(at(1)), &
         all%contenders(at(1))%met)
      k = best_of(all%contenders, cost_of)
      call take(scene, all, k, cost_of(k), answer%best)
      cost_of(k) = no_cost
      k = best_of(all%contenders, cost_of)
      answer%runner_up%h = 0
      if (minval(cost_of) < no_cost) call take(scene, all, k, cost_of(k), answer%runner_up)
   end subroutine time_finalists

   !> The cheapest as seen in passing, and `taylor` anyway: it has been timed once only, and another
   !> program may have come in between.
   pure subroutine pick_finalists(cost_of, adaptive, at, n)
      real(dp), intent(inout) :: cost_of(:)
      logical, intent(in) :: adaptive(:)
      integer, intent(out) :: at(finalists), n
      real(dp) :: least
      integer :: i, k
      n = 0
      at = 0
      least = minval(cost_of)
      do i = 1, finalists - count(adaptive)
         k = minloc(cost_of, 1)
         if (.not. cost_of(k) < no_cost) exit
         if (i > 3 .and. cost_of(k) > final_share*least) exit
         n = n + 1
         at(n) = k
         cost_of(k) = no_cost
      end do
      do k = 1, size(cost_of)
         if (.not. adaptive(k) .or. .not. cost_of(k) < no_cost .or. n == finalists) cycle
         n = n + 1
         at(n) = k
      end do
   end subroutine pick_finalists

   !> The most accurate of those that cost the same.
   pure integer function best_of(contenders, cost_of) result(best)
      type(contender), intent(in) :: contenders(:)
      real(dp), intent(in) :: cost_of(:)
      best = minloc(contenders%error, 1, mask=cost_of <= as_cheap*minval(cost_of))
   end function best_of

   !> A candidate as a result.
   subroutine take(scene, all, k, cost_of, best)
      type(scene_settings), intent(in) :: scene
      type(trials), intent(in) :: all
      integer, intent(in) :: k
      real(dp), intent(in) :: cost_of
      type(chosen), intent(out) :: best
      integer(i8) :: multiple
      associate (one => all%contenders(k))
         multiple = one%met
         if (multiple == 0) multiple = one%best_multiple
         best%setup = all%list(k)
         best%h = step_of(one, multiple)
         best%error = one%given
         best%near = one%near
         if (one%met == 0) best%error = one%best_error
         if (one%met == 0) best%near = one%best_error
         if (one%adaptive) best%tolerance = merge(one%tolerance, one%best_tolerance, one%met > 0)
         best%ns = cost_of/real(multiple*one%unit, dp)
         best%run = 1e-9_dp*best%ns*(scene%t_end/best%h)*real(body_total(scene), dp)
      end associate
   end subroutine take

end module poinsot_study_choose_rank
