!> E. Hairer, G. Vilmart, Preprocessed discrete Moser-Veselov algorithm for the full dynamics of a
!> rigid body, J. Phys. A 39 (2006) 13225, figure 1, reproduced: two bodies, error against time for
!> methods of order 2 to 10, and for the exact step, which was not available then.
module poinsot_study_repeat_hairer
   use poinsot_core_kinds, only: dp, i8, lanes, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_summary, only: brief_number
   use poinsot_study_errors, only: attitude_error
   use poinsot_study_free_trial, only: run_block
   use poinsot_study_quadruple, only: turn_freely
   use poinsot_study_statistics, only: median
   implicit none(type, external)
   private
   public :: repeat_hairer

   !> The second is flat to three digits and a little beyond what a body can be: .345 + .653 < 1.
   real(dp), parameter :: bodies(3, 2) = reshape([0.6_dp, 0.8_dp, 1.0_dp, &
                                                  0.345_dp, 0.653_dp, 1.0_dp], [3, 2])
   real(dp), parameter :: y0(3) = [1.8_dp, 0.4_dp, -0.9_dp], t_end = 10
   character(16), parameter :: methods(8) = [character(16) :: "dmv2", "dmv4", "dmv6", "dmv8", &
      "dmv10", "midpoint", "three-rotations", "exact"]
   integer, parameter :: repeats = 5, coarsest = 3, usual_finest = 13 !! powers of 2 of the steps

   !> What was measured; 0 where a method did not come through.
   type :: comparison
      real(dp), dimension(coarsest:usual_finest, size(methods), 2) :: attitude = 0, time = 0
   end type comparison

contains

   !> Measure, write hairer-vilmart.csv and hairer-vilmart.txt into a folder that is there.
   !> Error: POINSOT_E_IO.
   subroutine repeat_hairer(out, error, finest)
      character(*), intent(in) :: out
      type(poinsot_error), intent(inout) :: error
      integer, intent(in), optional :: finest  !! up to 2**finest steps; default 13
      type(out_file) :: file
      type(comparison) :: found
      integer :: body, m, k, last
      last = usual_finest
      if (present(finest)) last = min(finest, usual_finest)
      call open_out(out // "/hairer-vilmart.csv", file, error)
      call put(file, "body,method,steps,h,momentum,attitude,ns_per_step,us_per_run", error)
      do body = 1, 2
         do m = 1, size(methods)
            do k = coarsest, last
               if (.not. raised(error)) call one_run(file, body, m, k, found, error)
            end do
         end do
      end do
      call finish_out(file, error)
      if (.not. raised(error)) call write_words(out, found, error)
   end subroutine repeat_hairer

   !> One line, if the method comes through: a block of 32 copies, time of one.
   subroutine one_run(file, body, m, k, found, error)
      type(out_file), intent(in) :: file
      integer, intent(in) :: body, m, k
      type(comparison), intent(inout) :: found
      type(poinsot_error), intent(inout) :: error
      real(dp) :: y(lanes, 3), q(lanes, 4), seconds(repeats), unit, h, momentum
      real(qp) :: ye(3), qe(4)
      character(120) :: line
      integer(i8) :: steps
      integer :: r
      logical :: good
      steps = 2_i8**k
      h = t_end/real(steps, dp)
      do r = 1, repeats
         y = spread(y0, 1, lanes)
         q = 0
         q(:, 1) = 1
         call run_block(bodies(:, body), trim(methods(m)), h, steps, y, q, good, seconds(r), error)
         if (raised(error) .or. .not. good) return
      end do
      call turn_freely(bodies(:, body), y0, [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], t_end, ye, qe)
      unit = median(seconds)/lanes
      momentum = real(norm2(real(y(1, :), qp) - ye)/norm2(ye), dp)
      found%attitude(k, m, body) = attitude_error(real(q(1, :), qp), qe)
      found%time(k, m, body) = 1e6_dp*unit
      write (line, "(i0, ',', a, ',', i0, 5(',', es11.4e3))") body, trim(methods(m)), steps, h, &
         momentum, found%attitude(k, m, body), 1e9_dp*unit/real(steps, dp), found%time(k, m, body)
      call put(file, trim(line), error)
   end subroutine one_run

   !> For each body and method: slope, and the time to a few errors.
   subroutine write_words(out, found, error)
      character(*), intent(in) :: out
      type(comparison), intent(in) :: found
      type(poinsot_error), intent(inout) :: error
      real(dp), parameter :: tolerances(4) = [1e-3_dp, 1e-6_dp, 1e-9_dp, 1e-12_dp]
      type(out_file) :: file
      character(100) :: line
      integer :: body, m, i
      real(dp) :: time, slope
      call open_out(out // "/hairer-vilmart.txt", file, error)
      do body = 1, 2
         write (line, "('moments', 3f7.3)") bodies(:, body)
         call put(file, trim(line) // ": microseconds of a body's run to t = 10 for an error " // &
                  "in attitude, and slopes", error)
         write (line, "(18x, 4es10.0e2, a9)") tolerances, "slope"
         call put(file, trim(line), error)
         do m = 1, size(methods)
            line = "   " // methods(m)
            do i = 1, size(tolerances)
               time = minval(found%time(:, m, body), mask=found%time(:, m, body) > 0 .and. &
                             found%attitude(:, m, body) <= tolerances(i))
               line(10*i + 9:10*i + 18) = "         -"
               if (time < huge(time)) write (line(10*i + 9:10*i + 18), "(f10.2)") time
            end do
            line(59:67) = "        -"
            slope = slope_of(found, m, body)
            if (slope > 0) write (line(59:67), "(f9.1)") slope
            call put(file, trim(line), error)
         end do
      end do
      call put(file, "The exact step is right to rounding (" // &
               brief_number(maxval(found%attitude(:, size(methods), :))) // &
               " at worst) with any step.", error)
      call finish_out(file, error)
   end subroutine write_words

   !> Slope between the two finest runs clear of rounding, 0 if there are none.
   pure real(dp) function slope_of(found, m, body) result(slope)
      type(comparison), intent(in) :: found
      integer, intent(in) :: m, body
      integer :: k
      slope = 0
      associate (deviation => found%attitude(:, m, body))
         do k = 2, size(deviation)
            ! 0: no result
            if (deviation(k - 1) > 0.1_dp .or. .not. deviation(k - 1) > deviation(k)) cycle
            if (deviation(k) > 3e-13_dp) slope = log(deviation(k - 1)/deviation(k))/log(2.0_dp)
         end do
      end associate
   end function slope_of

end module poinsot_study_repeat_hairer
