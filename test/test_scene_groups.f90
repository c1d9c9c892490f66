!> Room scene: groups that are repeated, and the classes that effects act on.
module test_scene_groups
   use testdrive, only: new_unittest, unittest_type, error_type
   use test_expectation, only: expect, within
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_settings, only: scene_settings
   use test_scene_tools, only: output, nl, make_scene, run_made, column, get_text
   implicit none(type, external)
   private
   public :: collect_scene_groups

   character(*), parameter :: run = "&scene t_end=2 h=0.05 /" // nl // "&output every=2 /" // nl
   character(*), parameter :: first_body = "&bodies moments=0.6,0.8,1 y=0.3,0.2,-0.5 /" // nl
   character(*), parameter :: second_body = "&bodies moments=1,2,2.5 omega=0.3,0.2,0.5 /" // nl
   character(*), parameter :: first_field = "dipole=0,0,1 strength=1,0,0.5 /" // nl
   character(*), parameter :: second_field = "dipole=1,0.2,0 strength=0,2,0 /" // nl

contains

   subroutine collect_scene_groups(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("mixture-of-two-fields", test_mixture), &
         new_unittest("effects-of-one-kind-add-up", test_sum), &
         new_unittest("settings-over-repeated-groups", test_override), &
         new_unittest("blame-of-options", test_blame), &
         new_unittest("rotors-of-two-classes", test_rotors), &
         new_unittest("formulas-in-scenes", test_formula)]
   end subroutine collect_scene_groups

   !> Each kind of body moves as it does alone in its own field.
   subroutine test_mixture(error)
      type(error_type), allocatable, intent(out) :: error
      character(:), allocatable :: text
      call run_one("mixture", run // first_body // second_body // "&field class=2 " // &
                   second_field // "&field class=1 " // first_field, "")
      call run_one("mixture-1", run // first_body // "&field " // first_field, "")
      call run_one("mixture-2", run // second_body // "&field " // second_field, "")
      call same("y1", "the momentum")
      call same("q2", "the attitude")
      call same("potential", "the energy")
      call get_text(output // "mixture/summary.txt", text)
      call expect(error, index(text, "field of class 2, field of class 1") > 0, &
         "the summary does not say which field acts on whom")

   contains

      subroutine run_one(folder, words, settings)
         character(*), intent(in) :: folder, words, settings
         type(scene_settings) :: scene
         type(poinsot_error) :: failure
         call make_scene(words, scene, failure, settings)
         call run_made(scene, folder, failure)
         call expect(error, .not. raised(failure), folder // " refused")
      end subroutine run_one

      subroutine same(name, what)
         character(*), intent(in) :: name, what
         real(dp), allocatable :: both(:), one(:), two(:)
         call column("mixture/trajectory.csv", name, both)
         call column("mixture-1/trajectory.csv", name, one)
         call column("mixture-2/trajectory.csv", name, two)
         call expect(error, size(both) == 4 .and. size(one) == 2 .and. size(two) == 2, "rows")
         if (allocated(error)) return
         call within(error, both(3) - one(2), 0.0_dp, what // " of body 1")
         call within(error, both(4) - two(2), 0.0_dp, what // " of body 2")
      end subroutine same

   end subroutine test_mixture

   !> Two fields on one body are the field of their sum.
   subroutine test_sum(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      real(dp), allocatable :: two(:), one(:)
      call make_scene(run // first_body // "&field dipole=0,0,1 strength=1,0,0 /" // &
         "&field dipole=0,0,1 strength=0,0,0.5 /", scene, failure)
      call run_made(scene, "sum-2", failure)
      call make_scene(run // first_body // "&field " // first_field, scene, failure)
      call run_made(scene, "sum-1", failure)
      call expect(error, .not. raised(failure), "refused")
      call column("sum-2/trajectory.csv", "y2", two)
      call column("sum-1/trajectory.csv", "y2", one)
      call expect(error, size(two) == 2 .and. size(one) == 2, "rows")
      if (allocated(error)) return
      call within(error, two(2) - one(2), 1e-14_dp, "two fields against one")
      call expect(error, abs(one(2) - one(1)) > 0.1_dp, "nothing acts")
   end subroutine test_sum

   !> `field(2).strength` names the second; without a number it is not said which.
   subroutine test_override(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      character(*), parameter :: text = run // first_body // "&field " // first_field // &
         "&field " // second_field
      call make_scene(text, scene, failure, "field(2).strength=7,8,9;field(1).phase=0.5")
      call expect(error, .not. raised(failure), "refused")
      call expect(error, size(scene%effects), 2, "two fields")
      if (allocated(error)) return
      associate (settings => scene%effects(2)%settings)
         call within(error, norm2(settings(size(settings))%values - [7, 8, 9]), 0.0_dp, "strength")
      end associate
      call make_scene(text, scene, failure, "field.strength=7,8,9")
      call expect(error, raised(failure), "taken without a number")
      call expect(error, index(failure%message, "several &field groups; select one, as in &
         &field(2).strength") > 0, failure%message)
      failure = poinsot_error()
      call make_scene(text, scene, failure, "field(3).strength=7,8,9")
      call expect(error, index(failure%message, "no &field group number 3") > 0, failure%message)
   end subroutine test_override

   !> An error of what --set gave says so, and an error of the file has the file's line.
   subroutine test_blame(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: text = run // first_body // &
         "&gravity_gradient rate=1 radial=1,0,0 /" // new_line("a") // &
         "&spring stiffness=1 axis=0,0,0 /"
      character(*), parameter :: options(6) = [character(40) :: "gravity_gradient.eccentricity=2", &
         "gravity_gradient.radial(1)=many", "gravity_gradient.radial(1:3)=0,0,0", &
         "scene.h=1e-300", "scene.seed=0.5", "bodies.moments(2)=1e9"]
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      integer :: i
      do i = 1, size(options)
         failure = poinsot_error()
         call make_scene(text, scene, failure, trim(options(i)))
         call expect(error, raised(failure), "taken: " // trim(options(i)))
         call expect(error, index(failure%message, "--set") == 1, trim(options(i)) // " -> " // &
            failure%message)
      end do
      failure = poinsot_error()
      call make_scene(text, scene, failure, "scene.h=0.2")
      call expect(error, raised(failure), "a direction of zero taken")
      call expect(error, index(failure%message, "--set") == 0, "the file's fault: " // &
         failure%message)
   end subroutine test_blame

   !> A wheel of each class is part of the momentum of its own bodies only.
   subroutine test_rotors(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      call make_scene(run // second_body // second_body // "&gyrostat rotor=0,0,1 class=2 /" // &
         "&gyrostat rotor=1,0,0 /", scene, failure)
      call expect(error, .not. raised(failure), "refused")
      if (allocated(error)) return
      call within(error, norm2(scene%bodies(1)%y - [1.3_dp, 0.4_dp, 1.25_dp]), 1e-15_dp, "first")
      call within(error, norm2(scene%bodies(2)%y - [1.3_dp, 0.4_dp, 2.25_dp]), 1e-15_dp, "second")
   end subroutine test_rotors

   !> A formula moves a body as the effect it stands for, and keeps what its words leave; an error
   !> names the line and the character.
   subroutine test_formula(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      real(dp), allocatable :: one(:), other(:)
      character(:), allocatable :: text
      call make_scene(run // first_body // "&gravity centre=0,0,1 weight=2 /", scene, failure)
      call run_made(scene, "formula-1", failure)
      call make_scene(run // first_body // "&potential u='k*Q33' constants='k=2' /", scene, failure)
      call run_made(scene, "formula-2", failure)
      call expect(error, .not. raised(failure), "refused")
      call column("formula-1/trajectory.csv", "y1", one)
      call column("formula-2/trajectory.csv", "y1", other)
      call expect(error, size(one) == 2 .and. size(other) == 2, "rows")
      if (allocated(error)) return
      call within(error, other(2) - one(2), 1e-14_dp, "formula against gravity")
      call get_text(output // "formula-2/trajectory.gp", text)
      call expect(error, index(text, "energy vertical norm") > 0, "what a formula of Q33 keeps")
      call make_scene(run // first_body // "&potential u='sin(t)*Q13' /", scene, failure)
      call run_made(scene, "formula-2", failure)
      call get_text(output // "formula-2/trajectory.gp", text)
      call expect(error, index(text, "work norm") > 0, "what a formula with t keeps")
      call make_scene(run // first_body // "&potential u='2*Q44' /", scene, failure)
      call expect(error, index(failure%message, "test.nml:4: &potential") > 0 .and. &
         index(failure%message, "character 3: unknown name") > 0, failure%message)
   end subroutine test_formula

end module test_scene_groups
