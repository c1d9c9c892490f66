!> Room scene: bodies, attitudes and momenta as people have them.
module test_scene_beginnings
   use testdrive, only: new_unittest, unittest_type, error_type
   use test_expectation, only: expect, within
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_rotation_quaternion, only: attitude_distance, quaternion_product, rotate
   use poinsot_scene_effects, only: body_positions
   use poinsot_scene_settings, only: scene_settings, body_total
   use poinsot_scene_states, only: body_states, first_states, to_scene_frame
   use test_scene_tools, only: output, nl, make_scene, run_made, column, get_text, put_text, &
      empty_folder
   implicit none(type, external)
   private
   public :: collect_scene_beginnings

   character(*), parameter :: run = "&scene t_end=1 h=0.05 /" // nl
   real(dp), parameter :: half = sqrt(0.5_dp)

contains

   subroutine collect_scene_beginnings(testsuite)
      type(unittest_type), allocatable, intent(out) :: testsuite(:)
      testsuite = [ &
         new_unittest("attitude-by-angles", test_angles), &
         new_unittest("momentum-in-space", test_space), &
         new_unittest("momentum-in-space-of-drawn-attitudes", test_drawn), &
         new_unittest("bodies-of-point-masses", test_points), &
         new_unittest("states-from-a-file", test_states), &
         new_unittest("lattice-of-bodies", test_lattice), &
         new_unittest("branch-of-a-restart", test_branch), &
         new_unittest("sections-of-a-list", test_sections), &
         new_unittest("beginnings-refused", test_refused)]
   end subroutine collect_scene_beginnings

   !> The scene of one group of bodies.
   subroutine bodies_of(words, scene, error)
      character(*), intent(in) :: words
      type(scene_settings), intent(out) :: scene
      type(error_type), allocatable, intent(inout) :: error
      type(poinsot_error) :: failure
      call make_scene(run // "&bodies " // words // " /", scene, failure)
      if (raised(failure)) call expect(error, .false., words // ": " // failure%message)
   end subroutine bodies_of

   !> Numbers by sections, as a namelist written by a program has them.
   subroutine test_sections(error)
      type(error_type), allocatable, intent(out) :: error
      call same("moments(1:3)=1,2,2.5 y(:)=3*0.5")
      call same("moments(:3) = 1 2 2.5, y(1:) = .5, .5 .5")
      call same("moments(1:2)=1,2 moments(3)=2.5 y(1:1)=0.5 y( 2 : 3 )=2*0.5")
      call same("moments=1,2,7 moments(3:3)=2.5 y=7,7,0.5 y(1:2)=0.5,0.5")
      call refused("moments(1:2)=1,2,2.5", "(1:2) has room for 2 numbers, more are given")
      call refused("moments(2:3)=1,2", "has a place without a value")
      call refused("moments(1:4)=1,2,2.5,3", "takes 3 numbers")

   contains

      subroutine same(words)
         character(*), intent(in) :: words
         type(scene_settings) :: scene
         call bodies_of(words, scene, error)
         if (allocated(error)) return
         call within(error, norm2(scene%bodies(1)%moments - [1.0_dp, 2.0_dp, 2.5_dp]), 0.0_dp, &
            words)
         call within(error, norm2(scene%bodies(1)%y - 0.5_dp), 0.0_dp, words)
      end subroutine same

      subroutine refused(words, message)
         character(*), intent(in) :: words, message
         type(scene_settings) :: scene
         type(poinsot_error) :: failure
         call make_scene(run // "&bodies " // words // " /", scene, failure)
         call expect(error, index(failure%message, message) > 0, words // ": " // failure%message)
      end subroutine refused

   end subroutine test_sections

   !> Euler angles in named conventions, axis and angle, in radians and in degrees.
   subroutine test_angles(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: m = "moments=1,2,2.5 "
      real(dp), parameter :: a = 0.3_dp, b = 0.7_dp, c = -1.1_dp
      call same(m // "euler=0.3,0.7,-1.1", &
                product_of(turn(3, a), turn(1, b), turn(3, c)))
      call same(m // "euler=0.3,0.7,-1.1 convention='zyx'", &
                product_of(turn(3, a), turn(2, b), turn(1, c)))
      call same(m // "euler=90,0,0 convention='xyz' degrees=T", turn(1, acos(0.0_dp)))
      call same(m // "axis_angle=0,0,5,0.7", turn(3, b))
      call same(m // "axis_angle=0,0,5,90 degrees=.true.", [half, 0.0_dp, 0.0_dp, half])
      ! of a tensor the attitude is that of the given frame
      call same("tensor=2,0.1,0, 0.1,3,0.2, 0,0.2,4 axis_angle=0,0,5,0.7", turn(3, b))

   contains

      subroutine same(words, q)
         character(*), intent(in) :: words
         real(dp), intent(in) :: q(4)
         type(scene_settings) :: scene
         type(body_states) :: states
         type(poinsot_error) :: failure
         call bodies_of(words, scene, error)
         if (allocated(error)) return
         call first_states(scene, states, failure)
         call to_scene_frame(scene%bodies(1), states%y(:, 1), states%q(:, 1))
         call within(error, attitude_distance(states%q(:, 1), q), 4e-16_dp, words)
      end subroutine same

      pure function turn(axis, angle) result(q)
         integer, intent(in) :: axis
         real(dp), intent(in) :: angle
         real(dp) :: q(4)
         q = 0
         q(1) = cos(angle/2)
         q(1 + axis) = sin(angle/2)
      end function turn

      pure function product_of(p, q, r) result(s)
         real(dp), intent(in) :: p(4), q(4), r(4)
         real(dp) :: s(4)
         s = quaternion_product(quaternion_product(p, q), r)
      end function product_of

   end subroutine test_angles

   !> Q y is what was given, whatever the attitude and the frame of the body.
   subroutine test_space(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: bodies(2) = [character(50) :: "moments=1,2,2.5", &
                                              "tensor=2,0.1,0, 0.1,3,0.2, 0,0.2,4"]
      type(scene_settings) :: scene
      integer :: i
      do i = 1, 2
         call bodies_of(trim(bodies(i)) // " y_space=0.3,-0.2,0.9 euler=0.4,1.2,2", scene, error)
         if (allocated(error)) return
         call within(error, norm2(rotate(scene%bodies(1)%q, scene%bodies(1)%y) - [0.3_dp, &
            -0.2_dp, 0.9_dp]), 4e-16_dp, "Q y of " // trim(bodies(i)))
      end do
      call bodies_of("moments=1,1,0 y_space=0,0.5,1e-9", scene, error)
      call within(error, scene%bodies(1)%y(3), 0.0_dp, "about an axis without inertia")
   end subroutine test_space

   subroutine test_drawn(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      type(body_states) :: states
      type(poinsot_error) :: failure
      integer :: i
      call bodies_of("count=5 moments=1,2,2.5 random='uniform' y_space=0.3,-0.2,0.9", scene, error)
      if (allocated(error)) return
      call first_states(scene, states, failure)
      do i = 1, 5
         call within(error, norm2(rotate(states%q(:, i), states%y(:, i)) - [0.3_dp, -0.2_dp, &
            0.9_dp]), 1e-15_dp, "Q y of a body")
      end do
      call expect(error, norm2(states%y(:, 1) - states%y(:, 2)) > 0.1_dp, "all alike")
   end subroutine test_drawn

   !> Masses anywhere: the tensor about their centre; the frame of the file is the scene's.
   subroutine test_points(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      call empty_folder("points")
      call put_text(output // "points/rod.txt", "# m x y z" // nl // "1 10 0 0" // nl // &
         "1,12,0,0" // nl)
      call put_text(output // "points/four.txt", "mass x y z" // nl // "2 1 1 0" // nl // &
         "1 0 0 1" // nl // "1 0 0 0" // nl // "3 0 2 0" // nl)
      call bodies_of("points='" // output // "points/rod.txt'", scene, error)
      if (allocated(error)) return
      call within(error, norm2(scene%bodies(1)%moments - [0, 2, 2]), 1e-15_dp, "rod")
      call bodies_of("points='" // output // "points/four.txt' omega=0.1,0,0", scene, error)
      if (allocated(error)) return
      ! by hand: I_11 = sum m (y^2 + z^2) - M (Y^2 + Z^2), I_12 = -sum m x y + M X Y, ...
      associate (b => scene%bodies(1))
         call within(error, norm2(matmul(b%axes, b%y) - 0.1_dp*[15 - 7*(64/49.0_dp + 1/49.0_dp), &
            -2 + 7*16/49.0_dp, 7*2/49.0_dp]), 1e-15_dp, "the tensor of four points")
      end associate
   end subroutine test_points

   !> The last states of a run are the first of another, by its own trajectory.
   subroutine test_states(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: path = output // "states/"
      type(scene_settings) :: scene
      type(body_states) :: states
      type(poinsot_error) :: failure
      call empty_folder("states")
      call put_text(path // "two.csv", "t,body,q0, Q1 ,q2,q3,y1,y2,y3,energy" // nl // &
         "0,1,1,0,0,0,0.1,0.2,0.3," // nl // "0,2,0.7071,0.7071,0,0,1e0,2d0,3,x" // achar(13) // nl)
      call bodies_of("moments=1,2,2.5 file='" // path // "two.csv'", scene, error)
      if (allocated(error)) return
      call expect(error, int(body_total(scene)), 2, "two rows")
      call first_states(scene, states, failure)
      call within(error, norm2(states%y(:, 1) - [0.1_dp, 0.2_dp, 0.3_dp]), 0.0_dp, "first y")
      call within(error, norm2(states%y(:, 2) - [1, 2, 3]), 0.0_dp, "second y")
      call within(error, norm2(states%q(:, 2) - [half, half, 0.0_dp, 0.0_dp]), 2e-16_dp, "second q")
      call expect(error, index(scene%bodies(1)%note, "1 quaternions of ") > 0, "no note")
      call bodies_of("tensor=2,0.1,0, 0.1,3,0.2, 0,0.2,4 file='" // path // "two.csv'", scene, &
         error)
      if (allocated(error)) return
      call first_states(scene, states, failure)
      call to_scene_frame(scene%bodies(1), states%y(:, 2), states%q(:, 2))
      call within(error, norm2(states%y(:, 2) - [1, 2, 3]), 2e-15_dp, "y in the given frame")
      call states_refused("q0 q1 q2 q3 y1 y2" // nl // "1 0 0 0 0 0", "0 columns ""y3""")
      call states_refused("q0 q1 q2 q3 y1 y2 y3" // nl, "holds no rows")
      call states_refused("q0 q1 q2 q3 y1 y2 y3" // nl // "1 0 0 0 0 0", "bad.csv:2: has 6 columns")
      call states_refused("q0 q1 q2 q3 y1 y2 y3" // nl // "1 0 0 0 0 0 x", """x"", in column y3")
      call states_refused("q0 q1 q2 q3 y1 y2 y3" // nl // nl // "1 0 0 1 0 0 0", &
         "bad.csv:3: q is not a unit quaternion, its norm differs from 1 by 4.14E-01")

   contains

      subroutine states_refused(text, words)
         character(*), intent(in) :: text, words
         type(scene_settings) :: bad
         type(poinsot_error) :: refusal
         call put_text(path // "bad.csv", text)
         call make_scene(run // "&bodies moments=1,2,2.5 file='" // path // "bad.csv' /", bad, &
            refusal)
         call expect(error, raised(refusal), "taken: " // words)
         if (raised(refusal)) call expect(error, index(refusal%message, words) > 0, refusal%message)
      end subroutine states_refused

   end subroutine test_states

   subroutine test_lattice(error)
      type(error_type), allocatable, intent(out) :: error
      type(scene_settings) :: scene
      real(dp), allocatable :: at(:, :)
      call bodies_of("moments=1,2,2.5 lattice=2,3,4 spacing=1,10,100 position=0.5,0,0", scene, &
         error)
      if (allocated(error)) return
      call expect(error, int(body_total(scene)), 24, "count")
      call body_positions(scene, at)
      call within(error, norm2(at(:, 1) - [0.5_dp, 0.0_dp, 0.0_dp]), 0.0_dp, "first")
      call within(error, norm2(at(:, 2) - [1.5_dp, 0.0_dp, 0.0_dp]), 0.0_dp, "second")
      call within(error, norm2(at(:, 3) - [0.5_dp, 10.0_dp, 0.0_dp]), 0.0_dp, "third")
      call within(error, norm2(at(:, 24) - [1.5_dp, 20.0_dp, 300.0_dp]), 0.0_dp, "last")
   end subroutine test_lattice

   !> One restart, two seeds: the first steps on are the same without noise, others with it; the
   !> summary and the next restart have the new seed.
   subroutine test_branch(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: hot = "&bodies moments=1,2,2.5 count=2 /" // nl // &
         "&langevin friction=0.5 temperature=1 /" // nl // "&output every=0.5 /" // nl
      character(*), parameter :: on = "scene.t_end=2;scene.from=" // output // "branch/restart.txt"
      type(scene_settings) :: scene
      type(poinsot_error) :: failure
      real(dp), allocatable :: old(:), new(:)
      character(:), allocatable :: text
      call make_scene(run // hot, scene, failure)
      call run_made(scene, "branch", failure)
      call make_scene(run // hot, scene, failure, on)
      call run_made(scene, "branch-old", failure)
      call expect(error, .not. raised(failure), "the run itself goes on")
      call make_scene(run // hot, scene, failure, on // ";scene.seed=2")
      call run_made(scene, "branch-new", failure)
      call expect(error, index(failure%message, "reseed = .true., which makes a branch") > 0, &
         "another seed unasked: " // failure%message)
      failure = poinsot_error()
      call make_scene(run // hot, scene, failure, on // ";scene.seed=2;scene.reseed=T")
      call run_made(scene, "branch-new", failure)
      call expect(error, .not. raised(failure), "the branch is refused")
      if (allocated(error)) return
      call column("branch-old/trajectory.csv", "y1", old)
      call column("branch-new/trajectory.csv", "y1", new)
      call expect(error, size(old) == size(new), "rows")
      call expect(error, abs(old(size(old)) - new(size(new))) > 1e-3_dp, "the noise is the same")
      call get_text(output // "branch-new/summary.txt", text)
      call expect(error, index(text, &
         "branched off at t = 1.0: seed 2 from there on, 1 before") > 0, &
         "the summary does not say so")
      call get_text(output // "branch-new/restart.txt", text)
      call expect(error, index(text, "seed 2") > 0, "the restart keeps the old seed")
   end subroutine test_branch

   !> Two ways to say one thing, and values that are none.
   subroutine test_refused(error)
      type(error_type), allocatable, intent(out) :: error
      character(*), parameter :: words(2, 16) = reshape([character(70) :: &
         "q=1,3*0 euler=3*0", "euler and q are both given", &
         "euler=3*0 axis_angle=1,0,0,0", "axis_angle and euler are both given", &
         "euler=3*0 convention='xxy'", "is not one of: zxz", &
         "degrees=T", "degrees is for euler or axis_angle", &
         "axis_angle=0,0,0,1", "axis_angle refused", &
         "euler=3*0 random='uniform'", "asks for random attitudes", &
         "y=3*1 y_space=3*1", "y_space and y are both given", &
         "y=3*1 omega=3*1", "omega and y are both given", &
         "random='thermal' temperature=1 y_space=3*1", "leave y, omega and y_space out", &
         "points='x'", "give one of them only", &
         "file='nowhere.csv'", "cannot be opened", &
         "file='x' q=1,0,0,0", "file and q are both given", &
         "lattice=2,2,0", "three positive integers", &
         "lattice=1e5,1e5,1", "three positive integers", &
         "lattice=2,2,2 count=7", "lattice makes 8", &
         "file=''", "file is empty"], [2, 16])
      type(scene_settings) :: scene
      integer :: i
      do i = 1, size(words, 2)
         call one(run // "&bodies moments=1,2,2.5 " // trim(words(1, i)) // " /", words(2, i))
      end do
      call one(run // "&bodies moments=1,1,0 random='uniform' y_space=3*1 /", &
         "an axis without inertia")
      call one("&scene t_end=1 h=0.1 reseed=T /&bodies moments=1,1,1 /", "reseed is for a restart")
      call one(run // "&bodies points='nowhere.txt' /", "cannot be opened")

   contains

      subroutine one(text, part)
         character(*), intent(in) :: text, part
         type(poinsot_error) :: failure
         call make_scene(text, scene, failure)
         call expect(error, raised(failure), "taken: " // text)
         if (raised(failure)) call expect(error, index(failure%message, trim(part)) > 0, &
            failure%message)
      end subroutine one

   end subroutine test_refused

end module test_scene_beginnings
