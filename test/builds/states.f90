!> What a build computes, to be held against another's: tools/deep.sh.
!>
!>    states write FILE         end states of every method on every kind of body, every splitting,
!>                              every effect
!>    states compare FILE FILE  the largest difference; exit code 1 if it is beyond the bound
!>
!> A difference is counted in units of the conditioning: epsilon times how much the end state
!> changes if the start does, measured by starts that are 1e-8 off. So it says how much of the
!> difference is the builds', and how much the problem's.
program states
   use, intrinsic :: iso_fortran_env, only: output_unit, error_unit
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_status, only: poinsot_ok
   use poinsot_effect_settings, only: setting
   use poinsot_effect_settings_text, only: read_settings
   use poinsot_ensemble_bodies, only: body_view, view_rows
   use poinsot_ensemble_compose, only: make_ready
   use poinsot_ensemble_plan, only: poinsot_plan, add_class, add_effect, set_option
   use poinsot_ensemble_step, only: step_bodies
   use poinsot_free_method, only: method_count, method_name
   use poinsot_splitting_registry, only: splitting_count, splitting_name
   implicit none(type, external)

   !> Units of the conditioning: 200 steps that each round a few times; four times what was found.
   real(dp), parameter :: bound = 100
   real(dp), parameter :: off = 1e-8_dp, h = 0.1_dp
   integer(i8), parameter :: steps = 200
   character(*), parameter :: row = "(a40, es12.4, 7(1x, z16.16))"

   real(dp), parameter :: bodies(3, 8) = reshape([0.6_dp, 0.8_dp, 1.0_dp, 1.0_dp, 0.6_dp, 0.8_dp, &
      0.6_dp, 0.6_dp, 1.0_dp, 1.0_dp, 1.0_dp, 0.6_dp, 0.6_dp, 0.6_dp + 1e-9_dp, 1.0_dp, &
      0.7_dp, 0.7_dp, 0.7_dp, 0.4_dp, 0.6_dp, 1.0_dp, 0.7_dp, 0.7_dp, 0.0_dp], [3, 8])
   character(*), parameter :: body_names(8) = [character(16) :: "generic", "other order", &
      "oblate", "prolate", "nearly oblate", "sphere", "flat", "linear"]
   character(*), parameter :: effect_names(10) = [character(16) :: "gravity", "field", "field", &
      "gravity_gradient", "spring", "torque", "drag", "langevin", "gyrostat", "dipoles"]
   character(*), parameter :: effect_settings(10) = [character(80) :: &
      "centre = 0.1, 0.2, 1; weight = 1.3", &
      "dipole = 1, 0.2, 0.3; strength = 0.2, 0, 1; motion=rotating; frequency=3", &
      "dipole = 1, 0.2, 0; strength = 0.2, 0, 1; motion=oscillating; frequency=3", &
      "rate = 0.7", "stiffness = 1.5; axis = 1, 2, 3; direction = 1, 0, 1", &
      "value = 0.1, 0.2, -0.3; frame = space; frequency = 2", "friction = 0.01, 0.02, 0.03", &
      "friction = 0.01; temperature = 0.4", "rotor = 0.1, 0.3, 0.2", &
      "dipole = 0.3, 0.1, 1; coupling = 0.001; spacing = 2"]

   character(8) :: command
   character(1000) :: first, second
   call get_command_argument(1, command)
   call get_command_argument(2, first)
   call get_command_argument(3, second)
   select case (command)
   case ("write")
      call write_all(trim(first))
   case ("compare")
      call compare(trim(first), trim(second))
   case default
      write (error_unit, "(a)") "usage: states write FILE | states compare FILE FILE"
      stop 2
   end select

contains

   subroutine write_all(file)
      character(*), intent(in) :: file
      integer :: unit, k, m
      open (newunit=unit, file=file, status="replace", action="write")
      do m = 1, method_count()
         do k = 1, size(bodies, 2)
            call one_case(unit, method_name(m), "strang", bodies(:, k), body_names(k), "", "")
         end do
      end do
      do m = 1, splitting_count()
         call one_case(unit, "exact", splitting_name(m), bodies(:, 1), "generic", &
            effect_names(1), effect_settings(1))
         call one_case(unit, "dmv8", splitting_name(m), bodies(:, 2), "other order", &
            effect_names(5), effect_settings(5))
      end do
      do m = 1, size(effect_names)
         call one_case(unit, "exact", "srkn4", bodies(:, 1), "generic", effect_names(m), &
            effect_settings(m))
      end do
      close (unit)
   end subroutine write_all

   !> One body, and six more that start a little off it.
   subroutine one_case(unit, method, splitting, moments, body, effect, settings)
      integer, intent(in) :: unit
      character(*), intent(in) :: method, splitting, body, effect, settings
      real(dp), intent(in) :: moments(3)
      type(poinsot_plan) :: plan
      type(body_view) :: view
      type(poinsot_error) :: error
      type(setting), allocatable :: list(:)
      real(dp), target :: y(3, 7), q(4, 7)
      integer(i8), target :: id(7)
      real(dp) :: conditioning
      integer :: k, number, status
      call add_class(plan, moments, number, error)
      call set_option(plan, "method", method, error)
      call set_option(plan, "splitting", splitting, error)
      if (len_trim(effect) > 0) then
         call read_settings(trim(settings), list, error)
         call add_effect(plan, trim(effect), list, error)
      end if
      call make_ready(plan, error)
      y = spread(merge([0.5_dp, 0.6_dp, -0.3_dp], [0.5_dp, 0.6_dp, 0.0_dp], moments(3) > 0), 2, 7)
      q = spread([0.5_dp, -0.1_dp, 0.7_dp, 0.5_dp], 2, 7)
      do k = 1, 3
         if (moments(k) > 0) y(k, 1 + k) = y(k, 1 + k) + off
         q(1 + k, 4 + k) = q(1 + k, 4 + k) + off
      end do
      q = q/spread(norm2(q, 1), 1, 4)
      id = 7 ! the same noise
      call view_rows(y, q, view)
      view%id => id
      call step_bodies(plan, view, 0.0_dp, h, 0_i8, steps, status, error)
      if (raised(error) .or. status /= poinsot_ok) then
         write (error_unit, "(5(a, 1x))") "a failure: ", method, splitting, trim(body), trim(effect)
         error stop
      end if
      conditioning = 1
      do k = 2, 7
         conditioning = max(conditioning, distance(y(:, 1), q(:, 1), y(:, k), q(:, k))/off)
      end do
      write (unit, row) method//" "//splitting//" "//trim(body)//" "//trim(effect), conditioning, &
         transfer([y(:, 1), q(:, 1)], [0_i8])
   end subroutine one_case

   pure real(dp) function distance(y, q, z, r)
      real(dp), intent(in) :: y(3), q(4), z(3), r(4)
      distance = max(norm2(y - z)/norm2(y), norm2(q - r))
   end function distance

   subroutine compare(one, two)
      character(*), intent(in) :: one, two
      character(40) :: name, other, worst
      integer(i8) :: bits(7, 2)
      real(dp) :: x(7, 2), conditioning(2), units, most
      integer :: a, b, ios, rows, same
      open (newunit=a, file=one, status="old", action="read")
      open (newunit=b, file=two, status="old", action="read")
      rows = 0
      same = 0
      most = 0
      worst = ""
      do
         read (a, row, iostat=ios) name, conditioning(1), bits(:, 1)
         if (ios /= 0) exit
         read (b, row, iostat=ios) other, conditioning(2), bits(:, 2)
         if (ios /= 0 .or. name /= other) error stop "the files do not hold the same cases"
         x = reshape(transfer(bits, [0.0_dp]), [7, 2])
         units = distance(x(:3, 1), x(4:, 1), x(:3, 2), x(4:, 2)) &
            /(epsilon(1.0_dp)*maxval(conditioning))
         rows = rows + 1
         if (all(bits(:, 1) == bits(:, 2))) same = same + 1
         if (.not. units <= most) then
            most = units
            worst = name
         end if
      end do
      write (output_unit, "(i0, a, i0, a, f0.1, 3a)") same, " of ", rows, &
         " end states the same to the bit, at most ", most, &
         " units of the conditioning apart (", trim(adjustl(worst)), ")"
      if (rows < 100 .or. .not. most <= bound) error stop
   end subroutine compare

end program states
