!> The matrix of entries: every effect alone and in pairs, with moments in any order and with a
!> tensor, without a wheel and with one, by every way into the library and in every momentum
!> variable: the same states and energies, those of a judge that shares no code. A new effect enters
!> by its description.
module test_matrix
   use testdrive, only: new_unittest, unittest_type, error_type
   use poinsot_core_kinds, only: dp
   use poinsot_effect_registry, only: describe_effect, effect_count, effect_name
   use poinsot_effect_settings, only: effect_info
   use poinsot_scene_text, only: text_of
   use test_expectation, only: expect
   use test_matrix_entries, only: outcome, by_fortran, by_c, by_scene, plan_energy
   use test_matrix_fixed, only: by_fixed
   use test_matrix_host, only: momentum_names
   use test_matrix_oracle, only: solve, energies, has_law, is_random
   use test_matrix_problem, only: problem, n, new_problem, with_rotor, random_frame, &
      permuted_frame, put_in_frame, settings_text, has_effect
   implicit none(type, external)
   private
   public :: collect_matrix

   character(*), parameter :: folder = "build/test-output/matrix"
   real(dp), parameter :: bound = 1e-12_dp

contains

   subroutine collect_matrix(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("every-effect-by-every-entry", test_alone), &
         new_unittest("pairs-of-effects-by-every-entry", test_pairs), &
         new_unittest("judge-by-energies", test_judge)]
   end subroutine collect_matrix

   subroutine test_alone(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: i
      do i = 1, effect_count
         call test_problem(i, [i], error)
         if (allocated(error)) return
      end do
   end subroutine test_alone

   !> All pairs.
   subroutine test_pairs(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: i, j
      do i = 1, effect_count
         do j = i + 1, effect_count
            call test_problem(100*i + j, [i, j], error)
            if (allocated(error)) return
         end do
      end do
   end subroutine test_pairs

   !> One set of effects: with settings that are taken, in two frames, without and with a wheel.
   subroutine test_problem(k, numbers, error)
      integer, intent(in) :: k, numbers(:)
      type(error_type), allocatable, intent(inout) :: error
      type(problem) :: here, there
      integer :: rotor
      if (any_formula(numbers)) return
      call draw_problem(k, numbers, here, error)
      if (allocated(error)) return
      do rotor = 0, 1
         if (rotor == 1) then
            if (has_effect(here, "gyrostat")) return
            call with_rotor(here)
         end if
         there = put_in_frame(here, permuted_frame(here), .false.)
         call test_entries(there, error)
         there = put_in_frame(here, random_frame(here), .true.)
         call test_entries(there, error)
      end do
   end subroutine test_problem

   !> Is one of them said by a formula, which has no frame that could be changed?
   logical function any_formula(numbers)
      integer, intent(in) :: numbers(:)
      type(effect_info) :: info
      integer :: i
      any_formula = .false.
      do i = 1, size(numbers)
         info = describe_effect(numbers(i))
         if (.not. allocated(info%keys)) cycle
         if (any(info%keys%is_text .and. info%keys%default == "required")) any_formula = .true.
      end do
   end function any_formula

   !> Settings that go together are found by trying.
   subroutine draw_problem(k, numbers, this, error)
      integer, intent(in) :: k, numbers(:)
      type(problem), intent(out) :: this
      type(error_type), allocatable, intent(inout) :: error
      type(outcome) :: got
      integer :: attempt
      do attempt = 1, 60
         this = new_problem(k, attempt, numbers)
         call by_fortran(this, 1, "srkn6", .true., got)
         if (got%status == 0) return
      end do
      call expect(error, .false., "no settings of "//names(numbers)//" are taken: "//got%message)
   end subroutine draw_problem

   function names(numbers) result(text)
      integer, intent(in) :: numbers(:)
      character(:), allocatable :: text
      integer :: i
      text = ""
      do i = 1, size(numbers)
         text = text//" "//effect_name(numbers(i))
      end do
   end function names

   !> Every entry against the judge; against the first one where chance acts.
   subroutine test_entries(this, error)
      type(problem), intent(in) :: this
      type(error_type), allocatable, intent(inout) :: error
      type(outcome) :: truth, got
      integer :: form
      if (allocated(error)) return
      call judge(this, .false., truth)
      do form = 1, size(momentum_names)
         call by_fortran(this, form, "srkn6", mod(form + this%number/5, 2) == 0, got)
         call compare(this, truth, got, "use poinsot", form, error)
         call by_c(this, form, "srkn6", got)
         call compare(this, truth, got, "C", form, error)
         call by_fixed(this, form, "srkn6", got)
         call compare(this, truth, got, "fixed form", form, error)
      end do
      if (.not. this%hosted) then
         call by_scene(this, mod(this%number, 2) == 0, "srkn6", folder, got)
         call compare(this, truth, got, "scene", 1, error)
      end if
      call test_taylor(this, error)
   end subroutine test_entries

   subroutine judge(this, continuous, truth)
      type(problem), intent(in) :: this
      logical, intent(in) :: continuous
      type(outcome), intent(out) :: truth
      type(plan_energy) :: source
      integer :: i
      if (is_random(this)) then
         call by_fortran(this, 1, "srkn6", .true., truth)
         return
      end if
      do i = 1, size(this%effects)
         if (has_law(this%effects(i)%name)) cycle
         source%of = this
         source%name = this%effects(i)%name
      end do
      if (allocated(source%name)) then
         call solve(this, continuous, truth%y, truth%q, source)
      else
         call solve(this, continuous, truth%y, truth%q)
      end if
      call energies(this, truth%y, truth%q, truth%kinetic, truth%potential)
   end subroutine judge

   !> The Taylor integrator, where it serves these effects: friction is a torque there.
   subroutine test_taylor(this, error)
      type(problem), intent(in) :: this
      type(error_type), allocatable, intent(inout) :: error
      type(outcome) :: truth, got
      if (this%hosted .or. is_random(this)) return
      call by_fortran(this, 1, "taylor", .true., got)
      if (got%status /= 0) return
      call judge(this, .true., truth)
      call compare(this, truth, got, "taylor", 1, error)
   end subroutine test_taylor

   subroutine compare(this, truth, got, entry, form, error)
      type(problem), intent(in) :: this
      type(outcome), intent(in) :: truth, got
      character(*), intent(in) :: entry
      integer, intent(in) :: form
      type(error_type), allocatable, intent(inout) :: error
      real(dp) :: off(4)
      integer :: i
      if (allocated(error)) return
      off = [maxval(abs(got%y - truth%y)), 0.0_dp, maxval(abs(got%kinetic - truth%kinetic)), &
         maxval(abs(got%potential - truth%potential))]
      do i = 1, n
         off(2) = max(off(2), min(maxval(abs(got%q(:, i) - truth%q(:, i))), &
            maxval(abs(got%q(:, i) + truth%q(:, i)))))
      end do
      call expect(error, got%status == 0 .and. all(off <= bound), &
         entry//", "//trim(momentum_names(form))//": status "//text_of(got%status)// &
         ", y, q, kinetic, potential off by "//text_of(off)//new_line("a")//told(this))
   end subroutine compare

   !> An effect without a law is judged by its energy: known ones put to that, against their laws.
   subroutine test_judge(error)
      type(error_type), allocatable, intent(out) :: error
      integer :: i
      do i = 1, effect_count
         if (any(effect_name(i) == [character(16) :: "gravity", "gravity_gradient", "field", &
            "spring"])) call judge_by_energy(i, error)
      end do
   end subroutine test_judge

   subroutine judge_by_energy(i, error)
      integer, intent(in) :: i
      type(error_type), allocatable, intent(inout) :: error
      type(problem) :: this, free
      type(plan_energy) :: source
      type(outcome) :: truth, got
      call draw_problem(i, [i], this, error)
      if (allocated(error)) return
      source%of = this
      source%name = effect_name(i)
      free = this
      deallocate (free%effects)
      allocate (free%effects(0))
      call solve(this, .false., truth%y, truth%q)
      call solve(free, .false., got%y, got%q, source)
      call expect(error, maxval(abs(got%y - truth%y)) <= bound .and. &
         maxval(abs(got%q - truth%q)) <= bound, effect_name(i)//" by differences: "// &
         text_of(maxval(abs(got%y - truth%y))))
   end subroutine judge_by_energy

   !> The problem as a scene has it.
   function told(this) result(text)
      type(problem), intent(in) :: this
      character(:), allocatable :: text
      integer :: i
      text = "problem "//text_of(this%number)//merge(", tensor ", ", moments", this%by_tensor)// &
         new_line("a")
      do i = 1, size(this%effects)
         text = text//settings_text(this%effects(i), .true.)
      end do
   end function told

end module test_matrix
