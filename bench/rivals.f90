!> General-purpose integrators on the bodies of a cost study: reads the scene and members.csv that
!> `poinsot cost` wrote, writes a CSV that `poinsot cost --rivals` draws beside our own methods.
!>
!> usage: rivals SCENE-FILE members.csv out.csv
program rivals
   use poinsot_core_kinds, only: dp, i8, lanes, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_effect_effect, only: torque_effect
   use poinsot_ensemble_compose, only: attach_plan
   use poinsot_ensemble_plan, only: poinsot_plan
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_reader, only: read_source
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_source, only: scene_source
   use poinsot_splitting_block_flows, only: block_flows
   use poinsot_study_clock, only: processor_seconds
   use poinsot_study_errors, only: attitude_error
   use poinsot_study_statistics, only: median
   use poinsot_study_trial, only: make_plan
   use bench_general, only: rk4_fixed, dop853_fixed, dop853_adaptive
   implicit none(type, external)

   integer, parameter :: most_members = 1024, repeats = 5
   integer, parameter :: use_rk4 = 1, use_dop853 = 2, use_adaptive = 3
   character(16), parameter :: names(3) = [character(16) :: "rk4", "dop853", "dop853 adaptive"]
   type(scene_settings) :: scene
   type(poinsot_plan), target :: plan
   type(block_flows), allocatable :: flows(:)
   type(poinsot_error) :: error
   real(dp) :: start(7, most_members), moments(3, most_members)
   real(qp) :: finish(7, most_members)
   real(dp), allocatable :: x(:, :, :)
   integer, allocatable :: class(:), body(:, :)
   integer :: n, blocks, unit
   logical :: forced
   character(400) :: scene_file, members_file, out_file

   call get_command_argument(1, scene_file)
   call get_command_argument(2, members_file)
   call get_command_argument(3, out_file)
   call open_scene(trim(scene_file))
   call read_members(trim(members_file))
   call deal()
   open (newunit=unit, file=trim(out_file), action="write", status="replace")
   write (unit, &
      "(a)") "name,setting,angle_median,angle_worst,momentum_median,momentum_worst,ns_per_time"
   call climb(use_rk4)
   call climb(use_dop853)
   call climb(use_adaptive)
   close (unit)

contains

   !> The scene with its torques; what is not a torque is not for a Runge-Kutta method.
   subroutine open_scene(file)
      character(*), intent(in) :: file
      type(scene_source) :: source
      integer :: i
      call read_source(file, source, error)
      if (.not. raised(error)) call build_scene(source, scene, error)
      if (.not. raised(error)) call make_plan(scene, "exact", "srkn6", plan, error)
      if (raised(error)) then
         print "(a)", error%message
         error stop 2
      end if
      allocate (flows(plan%class_count()))
      do i = 1, size(flows)
         flows(i)%number = i
         flows(i)%class => plan%classes(i)%it
         nullify (flows(i)%by_lane) ! a block has no defaults
         call attach_plan(plan, flows(i))
      end do
      forced = size(plan%effects) > 0
      do i = 1, size(plan%effects)
         select type (one => plan%effects(i)%it)
         class is (torque_effect)
            cycle
         class default
            print "(a)", "rivals: the effect " // trim(one%name) // " is not a torque on one body"
            error stop 2
         end select
      end do
   end subroutine open_scene

   subroutine read_members(file)
      character(*), intent(in) :: file
      character(1000) :: line
      integer :: in, code
      n = 0
      open (newunit=in, file=file, action="read", status="old")
      do
         read (in, "(a)", iostat=code) line
         if (code /= 0 .or. n == most_members) exit
         if (line(1:1) == "#" .or. line(1:1) == "I") cycle
         n = n + 1
         read (line, *) moments(:, n), start(:, n), finish(:, n)
      end do
      close (in)
   end subroutine read_members

   !> Members into blocks of one class.
   subroutine deal()
      integer :: i, c, l
      allocate (class(n), body(lanes, n), x(lanes, 7, n))
      blocks = 0
      body = 0
      do c = 1, size(flows)
         l = lanes
         do i = 1, n
            if (class_of(moments(:, i)) /= c) cycle
            if (l == lanes) then
               blocks = blocks + 1
               class(blocks) = c
               l = 0
            end if
            l = l + 1
            body(l, blocks) = i
         end do
      end do
   end subroutine deal

   integer function class_of(i)
      real(dp), intent(in) :: i(3)
      do class_of = 1, size(flows)
         if (all(abs(scene%bodies(class_of)%moments - i) <= 1e-14_dp*maxval(i))) return
      end do
   end function class_of

   subroutine load()
      integer :: b, l
      x = 0
      x(:, 4, :) = 1
      do b = 1, blocks
         do l = 1, lanes
            if (body(l, b) > 0) x(l, :, b) = start(:, body(l, b))
         end do
      end do
   end subroutine load

   !> Finer and finer, until nothing is gained.
   subroutine climb(which)
      integer, intent(in) :: which
      real(dp) :: off, best
      integer :: k, level, stalls
      best = huge(best)
      stalls = 0
      level = 16
      do k = 2, 40
         if (which == use_adaptive) then
            if (k > 30) exit
            call try(which, 10.0_dp**(-0.5_dp*k), off)
         else
            call try(which, real(level, dp), off)
            level = level*merge(3, 4, mod(k, 2) == 0)/merge(2, 3, mod(k, 2) == 0)
         end if
         stalls = stalls + 1
         if (off < 0.6_dp*best) stalls = 0
         best = min(best, off)
         if (stalls == 3 .and. best < 1e-9_dp .or. level > 400000) exit
      end do
   end subroutine climb

   !> One setting: run all members, several times, and write a line.
   subroutine try(which, setting, off)
      integer, intent(in) :: which
      real(dp), intent(in) :: setting
      real(dp), intent(out) :: off              !! median error of the attitude
      real(dp) :: seconds(repeats), begun, angle(n), momentum(n)
      integer :: r, b, l, taken
      do r = 1, repeats
         call load()
         begun = processor_seconds()
         do b = 1, blocks
            select case (which)
            case (use_rk4)
               call rk4_fixed(flows(class(b)), forced, scene%t_end, nint(setting), x(:, :, b))
            case (use_dop853)
               call dop853_fixed(flows(class(b)), forced, scene%t_end, nint(setting), x(:, :, b))
            case default
               call dop853_adaptive(flows(class(b)), forced, scene%t_end, setting, x(:, :, b), &
                  taken)
            end select
         end do
         seconds(r) = processor_seconds() - begun
      end do
      do b = 1, blocks
         do l = 1, lanes
            if (body(l, b) == 0) cycle
            associate (i => body(l, b))
               angle(i) = 3.2_dp
               momentum(i) = 2
               if (.not. sum(abs(x(l, :, b))) < 1e10_dp) cycle
               angle(i) = attitude_error(real(x(l, 4:7, b), qp), finish(4:7, i)/norm2(finish(4:7, &
                  i)))
               momentum(i) = real(norm2(x(l, 1:3, b) - finish(1:3, i))/norm2(finish(1:3, i)), dp)
            end associate
         end do
      end do
      off = median(angle)
      if (off > 1) return
      write (unit, "(a, ',', es10.3, 5(',', es11.4e3))") trim(names(which)), setting, &
         median(angle), maxval(angle), &
         median(momentum), maxval(momentum), 1e9_dp*median(seconds)/(blocks*lanes*scene%t_end)
      flush (unit)
   end subroutine try

end program rivals
