!> F. Fasso, Comparison of splitting algorithms for the rigid body, J. Comput. Phys. 189 (2003) 527:
!> errors of methods of one order differ by orders of magnitude, depending on the body. Reproduced
!> as a map of the error over the triangle of all bodies, for each method.
module poinsot_study_repeat_fasso
   use poinsot_core_kinds, only: dp, i8, lanes, qp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_rotation_random, only: random_direction
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_plot_data, only: put_variable
   use poinsot_scene_summary, only: brief_number
   use poinsot_study_errors, only: attitude_error
   use poinsot_study_free_trial, only: run_block
   use poinsot_study_statistics, only: median, quantile
   implicit none(type, external)
   private
   public :: repeat_fasso

   character(20), parameter :: methods(6) = [character(20) :: "three-rotations", &
      "symmetric-rotation", "midpoint", "dmv2", "dmv4", "dmv6"]
   integer, parameter :: usual_side = 48    !! cells along an edge of the triangle
   real(dp), parameter :: turns = 10        !! angle through which bodies turn, radians
   real(dp), parameter :: phase = 0.1_dp    !! h |omega|
   real(dp), parameter :: least = 1e-17_dp

contains

   !> Measure, write fasso.csv, fasso.txt and fasso.gp into a folder that is there.
   !> Error: POINSOT_E_IO.
   subroutine repeat_fasso(out, error, cells)
      character(*), intent(in) :: out
      type(poinsot_error), intent(inout) :: error
      integer, intent(in), optional :: cells   !! along an edge; default 48
      type(out_file) :: file
      real(dp), allocatable :: found(:, :)     !! (methods, bodies)
      integer :: i, j, up, side, n
      side = usual_side
      if (present(cells)) side = cells
      allocate (found(size(methods), side**2))
      call open_out(out // "/fasso.csv", file, error)
      call put(file, "x,y,I1,I2,I3," // columns(), error)
      n = 0
      do i = 0, side - 1
         do j = 0, side - 1 - i
            do up = 0, merge(1, 0, i + j < side - 1)
               n = n + 1
               if (.not. raised(error)) call one_body(file, i, j, up, side, found(:, n), error)
            end do
         end do
      end do
      call finish_out(file, error)
      if (.not. raised(error)) call write_words(out, found, error)
      if (.not. raised(error)) call write_variables(out, found, side, error)
   end subroutine repeat_fasso

   function columns() result(text)
      character(:), allocatable :: text
      integer :: m
      text = trim(methods(1))
      do m = 2, size(methods)
         text = text // "," // trim(methods(m))
      end do
   end function columns

   !> The body at the middle of a small triangle: parts a, b, c of its mass along the axes, so that
   !> its moments are b + c, c + a, a + b; all bodies are such. |y| is such that |omega| is about 1.
   subroutine one_body(file, i, j, up, side, found, error)
      type(out_file), intent(in) :: file
      integer, intent(in) :: i, j, up, side
      real(dp), intent(out) :: found(:)           !! median error of each method
      type(poinsot_error), intent(inout) :: error
      real(dp) :: part(3), moments(3), y0(lanes, 3), y(lanes, 3), q(lanes, 4), ye(lanes, 3), &
         qe(lanes, 4)
      real(dp) :: angle(lanes), speed, h, seconds
      character(300) :: line
      integer :: m, l
      integer(i8) :: steps
      logical :: good
      part(1) = (i + merge(2, 1, up == 1)/3.0_dp)/side
      part(2) = (j + merge(2, 1, up == 1)/3.0_dp)/side
      part(3) = 1 - part(1) - part(2)
      moments = 1 - part
      do l = 1, lanes
         y0(l, :) = random_direction(7_i8, int(l, i8))
      end do
      speed = 0
      do l = 1, lanes
         speed = speed + norm2(y0(l, :)/moments)/lanes
      end do
      steps = nint(turns/phase, i8)
      h = phase/speed
      ye = y0
      qe = 0
      qe(:, 1) = 1
      call run_block(moments, "exact", h*real(steps, dp), 1_i8, ye, qe, good, seconds, error)
      write (line, "(es13.6, 4(',', es13.6))") part(2) + 0.5_dp*part(3), sqrt(0.75_dp)*part(3), &
         moments
      do m = 1, size(methods)
         y = y0
         q = 0
         q(:, 1) = 1
         call run_block(moments, trim(methods(m)), h, steps, y, q, good, seconds, error)
         if (raised(error)) return
         do l = 1, lanes
            associate (reference => real(qe(l, :), qp))
               angle(l) = attitude_error(real(q(l, :), qp), reference/norm2(reference))
            end associate
         end do
         if (.not. good) angle = 1
         found(m) = max(median(angle), least)
         write (line(len_trim(line) + 1:), "(',', es11.4e3)") found(m)
      end do
      call put(file, trim(line), error)
   end subroutine one_body

   !> How much each method varies.
   subroutine write_words(out, found, error)
      character(*), intent(in) :: out
      real(dp), intent(in) :: found(:, :)
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(100) :: line
      integer :: m
      call open_out(out // "/fasso.txt", file, error)
      call put(file, "error in attitude after 10 radians, h|omega| = 0.1, over all bodies", error)
      write (line, "(23x, 5a11)") "least", "5 %", "median", "95 %", "most"
      call put(file, trim(line), error)
      do m = 1, size(methods)
         write (line, "(3x, a20, 5es11.1e2)") methods(m), minval(found(m, :)), &
            quantile(found(m, :), 0.05_dp), median(found(m, :)), quantile(found(m, :), 0.95_dp), &
            maxval(found(m, :))
         call put(file, trim(line), error)
      end do
      call put(file, "Splittings differ by orders of magnitude with the body; the discrete " // &
               "Moser-Veselov methods and midpoint hardly.", error)
      call finish_out(file, error)
   end subroutine write_words

   !> What the picture's script needs to know: cells along an edge, and between which errors 9
   !> bodies in 10 lie, a text for each method.
   subroutine write_variables(out, found, side, error)
      character(*), intent(in) :: out
      real(dp), intent(in) :: found(:, :)
      integer, intent(in) :: side
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(40) :: ranges(size(methods))
      integer :: m
      call open_out(out // "/fasso.gp", file, error)
      if (raised(error)) return
      do m = 1, size(methods)
         ranges(m) = brief_number(quantile(found(m, :), 0.05_dp)) // " to " // &
                     brief_number(quantile(found(m, :), 0.95_dp))
      end do
      call put_variable(file, "side", side, error)
      call put_variable(file, "methods", methods, error)
      call put_variable(file, "ranges", ranges, error)
      call finish_out(file, error)
   end subroutine write_variables

end module poinsot_study_repeat_fasso
