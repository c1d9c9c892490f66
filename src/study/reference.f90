!> The reference solution for candidates, with an estimate of its own error.
!>
!> Free bodies: quadruple precision. Torques that are data: Taylor series (torque_reference.f90).
!> Other effects (pairs, friction with noise): two schemes of high order with the exact rotor and
!> compensated sums, each with smaller and smaller steps until only rounding error is left (effects
!> that limit the order to 2 are extrapolated in powers of h^2); the difference of the two is the
!> estimate.
module poinsot_study_reference
   use poinsot_core_kinds, only: dp, i8, qp
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_convergence
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_summary, only: brief_number
   use poinsot_scene_text, only: text_of
   use poinsot_study_candidates, only: scene_kind, candidate, list_candidates, plan_splitting, &
      label_of, no_splitting, any_name
   use poinsot_study_clock, only: time_limit, part_of, now_by, left_of, processor_seconds
   use poinsot_study_errors, only: end_state, compare_states
   use poinsot_study_members, only: member_set
   use poinsot_study_quadruple, only: turn_freely
   use poinsot_study_torque_reference, only: solve_torques
   use poinsot_study_trial, only: trial_run, make_plan, run_trial
   implicit none(type, external)
   private
   public :: reference_solution, find_reference

   integer, parameter :: columns = 5            !! of the extrapolation table
   integer(i8), parameter :: first_steps = 32, most_steps = 2_i8**26

   real(dp), parameter :: both_good = 1e-12_dp  !! two solutions so near differ by rounding

   !> A solution, what it is, and how good.
   type :: reference_solution
      type(end_state) :: state
      real(dp), allocatable :: angle(:), momentum(:) !! (n): its own error, as estimated
      character(:), allocatable :: how               !! for people
      real(dp) :: seconds = 0                        !! of the processor, for all members alike
      logical :: series = .false.                    !! by Taylor series: at any time at little cost
   end type reference_solution

contains

   !> Solve for all members. Error: POINSOT_E_CONVERGENCE if no step gives a solution in the time.
   subroutine find_reference(scene, kind, members, t_end, checks, limit, reference, error, enough)
      type(scene_settings), intent(in) :: scene      !! without noise
      type(scene_kind), intent(in) :: kind
      type(member_set), intent(in) :: members
      real(dp), intent(in) :: t_end
      integer, intent(in) :: checks                  !! looks at the energy
      type(time_limit), intent(in) :: limit
      type(reference_solution), intent(out) :: reference
      type(poinsot_error), intent(inout) :: error
      real(dp), intent(in), optional :: enough !! an error small enough; absent: rounding alone
      real(dp) :: target_error
      logical :: served
      target_error = 0
      if (present(enough)) target_error = enough
      if (kind%free) then
         call solve_free(scene, members, t_end, checks, reference, error)
         return
      end if
      served = .false.
      if (.not. kind%coupled) call solve_torques(scene, members, t_end, checks, limit, &
         target_error, reference%state, reference%angle, reference%momentum, reference%how, &
         reference%seconds, served)
      if (served) then
         reference%series = .true.
         reference%state%scale = positive(reference%state%scale)
      else
         reference%seconds = processor_seconds()
         call solve_forced(scene, kind, members, t_end, checks, limit, target_error, reference, &
            error)
         reference%seconds = processor_seconds() - reference%seconds
      end if
   end subroutine find_reference

   !> Quadruple precision; energies are those of the start.
   subroutine solve_free(scene, members, t_end, checks, reference, error)
      type(scene_settings), intent(in) :: scene
      type(member_set), intent(in) :: members
      real(dp), intent(in) :: t_end
      integer, intent(in) :: checks
      type(reference_solution), intent(inout) :: reference
      type(poinsot_error), intent(inout) :: error
      type(poinsot_plan) :: plan
      type(trial_run) :: start
      real(qp) :: y(3), q(4)
      integer :: i
      call make_plan(scene, "jacobi", "srkn6", plan, error)
      if (raised(error)) return
      call run_trial(plan, members, 0.0_dp, 1_i8, 1, .false., start)
      allocate (reference%state%y(3, members%n), reference%state%q(4, members%n), &
                reference%state%energy(members%n, 0:checks), reference%angle(members%n), &
                reference%momentum(members%n))
      reference%angle = 0
      reference%momentum = 0
      !$omp parallel do schedule(dynamic, 4) private(y, q)
      do i = 1, members%n
         associate (moments => scene%bodies(members%group(i))%moments)
            call turn_freely(moments, members%y(:, i), members%q(:, i), t_end, &
                             reference%state%y(:, i), reference%state%q(:, i))
            if (i > 4) cycle
            call turn_freely(moments, members%y(:, i), members%q(:, i), t_end, y, q, 2)
         end associate
         reference%angle(i) = real(2*norm2(q - reference%state%q(:, i)), dp)
         reference%momentum(i) = real(norm2((y - reference%state%y(:, i))/max(norm2(y), tiny(y))), &
            dp)
      end do
      !$omp end parallel do
      reference%state%energy = spread(start%energy(:, 0), 2, checks + 1)
      reference%state%scale = positive(start%kinetic)
      reference%how = "exact step in quadruple precision; half the step changes it by " // &
                      brief_number(max(maxval(reference%angle), maxval(reference%momentum)))
   end subroutine solve_free

   !> What energies are relative to: kinetic energy; 1 of a body at rest alone.
   pure function positive(kinetic) result(scale)
      real(dp), intent(in) :: kinetic(:)
      real(dp), allocatable :: scale(:)
      scale = kinetic
      where (.not. scale > 1e-3_dp*maxval(kinetic)) scale = maxval(kinetic)
      if (.not. maxval(kinetic) > 0) scale = 1
   end function positive

   !> Two schemes, finer and finer.
   subroutine solve_forced(scene, kind, members, t_end, checks, limit, enough, reference, error)
      type(scene_settings), intent(in) :: scene
      type(scene_kind), intent(in) :: kind
      type(member_set), intent(in) :: members
      real(dp), intent(in) :: t_end
      integer, intent(in) :: checks
      type(time_limit), intent(in) :: limit
      real(dp), intent(in) :: enough
      type(reference_solution), intent(inout) :: reference
      type(poinsot_error), intent(inout) :: error
      type(candidate), allocatable :: list(:)
      type(candidate) :: best, other
      type(end_state) :: second
      real(dp) :: change(2)
      integer(i8) :: steps(2)
      call list_candidates(scene, kind, [character(24) :: "exact"], any_name, list, error)
      if (raised(error)) return
      call two_best(list, best, other)
      call refine(scene, kind, best, members, t_end, checks, part_of(limit, 0.5_dp), enough, &
         reference%state, &
                  steps(1), change(1), error)
      if (.not. raised(error)) call refine(scene, kind, other, members, t_end, checks, &
         limit, enough, &
                                           second, steps(2), change(2), error)
      if (raised(error)) return
      call compare_states(second%y, second%q, reference%state, reference%angle, reference%momentum)
      if (max(maxval(reference%angle), maxval(reference%momentum)) < both_good) then
         call take_middle(second, reference%state)
      end if
      reference%how = label_of(best) // ", " // text_of(steps(1)) // " steps"
      if (kind%limit > 0) reference%how = reference%how // " at the finest, extrapolated"
      reference%how = reference%how // "; " // label_of(other) // ", " // &
                      text_of(steps(2)) // " steps, differs by " // &
                      brief_number(maxval(reference%momentum)) // " in momentum, " // &
                      brief_number(maxval(reference%angle)) // " in attitude"
   end subroutine solve_forced

   !> Where the two differ by rounding alone, the middle between them is nearer than either, and no
   !> candidate's run is the reference itself.
   pure subroutine take_middle(second, state)
      type(end_state), intent(in) :: second
      type(end_state), intent(inout) :: state
      integer :: i
      state%y = 0.5_qp*(state%y + second%y)
      do i = 1, size(state%q, 2)
         associate (q => state%q(:, i), p => second%q(:, i))
            q = q + sign(1.0_qp, dot_product(q, p))*p
            q = q/norm2(q)
         end associate
      end do
   end subroutine take_middle

   !> The cheapest scheme of the highest order; and the same among the others.
   subroutine two_best(list, best, other)
      type(candidate), intent(in) :: list(:)
      type(candidate), intent(out) :: best, other
      integer :: i
      best = list(1)
      other = list(1)
      if (best%splitting == no_splitting) other%method = "jacobi"
      if (best%splitting == no_splitting) return
      do i = 1, size(list)
         if (standing(list(i)) > standing(best)) best = list(i)
      end do
      if (best%splitting == list(1)%splitting .and. size(list) > 1) other = list(2)
      do i = 1, size(list)
         if (list(i)%splitting == best%splitting) cycle
         if (standing(list(i)) > standing(other)) other = list(i)
      end do
   end subroutine two_best

   !> How well a scheme serves as a reference; measured constants of mathematics, section 5.
   pure integer function standing(one)
      type(candidate), intent(in) :: one
      select case (one%splitting)
      case ("omelyan8")
         standing = 5
      case ("srkn6")
         standing = 4
      case ("omelyan6")
         standing = 3
      case ("srkn4")
         standing = 2
      case default
         standing = 1
      end select
   end function standing

   !> One scheme with steps halved until the change stops shrinking.
   subroutine refine(scene, kind, one, members, t_end, checks, limit, enough, state, steps, &
      change, error)
      type(scene_settings), intent(in) :: scene
      type(scene_kind), intent(in) :: kind
      type(candidate), intent(in) :: one
      type(member_set), intent(in) :: members
      real(dp), intent(in) :: t_end, enough
      type(time_limit), intent(in) :: limit
      integer, intent(in) :: checks
      type(end_state), intent(out) :: state
      integer(i8), intent(out) :: steps            !! of the solution taken
      real(dp), intent(out) :: change              !! between it and the one before
      type(poinsot_error), intent(inout) :: error
      type(poinsot_plan) :: plan
      type(end_state) :: table(columns), last(columns)
      type(trial_run) :: run
      real(dp), allocatable :: angle(:), momentum(:)
      real(dp) :: now, took
      integer(i8) :: n
      integer :: row, rows, worse
      call make_plan(scene, trim(one%method), plan_splitting(one), plan, error)
      if (raised(error)) return
      took = 0
      change = huge(change)
      steps = 0
      row = 0
      worse = 0
      n = first_steps
      do while (n <= most_steps .and. 2.2_dp*took < left_of(limit) .or. row < 3)
         took = now_by(limit)
         call run_trial(plan, members, t_end, n, checks, .true., run)
         took = now_by(limit) - took
         n = 2*n
         if (.not. run%good .and. n <= most_steps .and. left_of(limit) > 0) cycle
         if (.not. run%good) exit
         rows = merge(min(row + 1, columns), 1, kind%limit > 0)
         call extend_table(run, rows, last, table)
         if (row > 0) then
            call compare_states(last(size_of(last))%y, last(size_of(last))%q, table(rows), angle, &
               momentum)
            now = max(maxval(angle), maxval(momentum))
            if (now < change) then
               change = now
               steps = n/2
               state = table(rows)
               worse = 0
            else
               worse = worse + 1
            end if
            if (worse >= 2 .and. change < 1e-9_dp .or. change < enough) exit
         end if
         row = row + 1
         last = table
      end do
      if (steps == 0) call raise(error, poinsot_e_convergence, &
         "no reference: the scene's bodies " // &
                                 "fail with every step size that the budget allows")
   end subroutine refine

   !> How many columns of a row are filled.
   pure integer function size_of(row)
      type(end_state), intent(in) :: row(:)
      size_of = 0
      do while (size_of < size(row))
         if (.not. allocated(row(size_of + 1)%y)) exit
         size_of = size_of + 1
      end do
   end function size_of

   !> The next row of Romberg's table: column k has its error terms up to h^(2k) removed.
   subroutine extend_table(run, rows, last, table)
      type(trial_run), intent(in) :: run
      integer, intent(in) :: rows
      type(end_state), intent(in) :: last(:)
      type(end_state), intent(inout) :: table(:)
      integer :: k, i
      real(qp) :: factor, sign_of
      table(1)%y = run%y
      table(1)%q = run%q
      table(1)%energy = run%energy
      table(1)%scale = positive(run%kinetic)
      do i = 1, size(run%q, 2)
         table(1)%q(:, i) = table(1)%q(:, i)/norm2(table(1)%q(:, i))
      end do
      do k = 2, rows
         factor = 1/(real(4, qp)**(k - 1) - 1)
         table(k) = table(k - 1)
         table(k)%y = table(k - 1)%y + factor*(table(k - 1)%y - last(k - 1)%y)
         table(k)%energy = table(k - 1)%energy + real(factor, dp)*(table(k - 1)%energy - last(k - &
            1)%energy)
         do i = 1, size(run%q, 2)
            sign_of = sign(1.0_qp, dot_product(table(k - 1)%q(:, i), last(k - 1)%q(:, i)))
            table(k)%q(:, i) = table(k - 1)%q(:, i) + factor*(table(k - 1)%q(:, i) - &
               sign_of*last(k - 1)%q(:, i))
            table(k)%q(:, i) = table(k)%q(:, i)/norm2(table(k)%q(:, i))
         end do
      end do
   end subroutine extend_table

end module poinsot_study_reference
