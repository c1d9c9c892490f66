!> G. Vilmart, Rigid body dynamics (2013), figure 1: the published end state of a thrown book, by
!> the method that computed it and by others.
module poinsot_study_repeat_review
   use poinsot_core_kinds, only: dp, i8, lanes
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_study_free_trial, only: run_block
   implicit none(type, external)
   private
   public :: repeat_review

   real(dp), parameter :: moments(3) = [0.376_dp, 0.627_dp, 1.0_dp], t_end = 40
   real(dp), parameter :: y0(3) = [0.0_dp, 0.6_dp, -0.8_dp]
   real(dp), parameter :: q0(4) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp]
   !> As published, from 4000 steps of order 10.
   real(dp), parameter :: y_end(3) = [0.0545936805170048_dp, -0.5930307093190378_dp, &
                                      -0.8033268997439126_dp]
   real(dp), parameter :: q_end(4) = [-0.7620456033094549_dp, -0.5769991038241422_dp, &
                                      -0.0272197283757480_dp, 0.2926048855539088_dp]
   character(20), parameter :: methods(10) = [character(20) :: "dmv10", "exact", "exact", &
      "jacobi", "dmv2", "dmv4", "dmv6", "midpoint", "three-rotations", "symmetric-rotation"]
   integer(i8), parameter :: steps(10) = [4000_i8, 4000_i8, 1_i8, 1_i8, 4000_i8, 4000_i8, 4000_i8, &
      4000_i8, 4000_i8, 4000_i8]

contains

   !> Compute, write review.csv and review.txt into a folder that is there. Error: POINSOT_E_IO.
   subroutine repeat_review(out, error)
      character(*), intent(in) :: out
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: table, words
      real(dp) :: y(3), q(4), error_y, error_q
      character(240) :: line
      integer :: m
      call open_out(out // "/review.csv", table, error)
      if (.not. raised(error)) call open_out(out // "/review.txt", words, error)
      if (raised(error)) return
      call put(table, "method,steps,y1,y2,y3,q0,q1,q2,q3,off_y,off_q", error)
      call put(words, "a thrown book at t = 40: distance from the published end", error)
      call put(words, "   method                steps     in y      in q", error)
      do m = 1, size(methods)
         call one_end(trim(methods(m)), steps(m), y, q, error)
         error_y = norm2(y - y_end)
         error_q = min(norm2(q - q_end), norm2(q + q_end))
         write (line, "(a, ',', i0, 7(',', es23.16), 2(',', es9.2))") trim(methods(m)), steps(m), &
            y, q, error_y, error_q
         call put(table, trim(line), error)
         write (line, "(3x, a20, i7, 2es10.1)") methods(m), steps(m), error_y, error_q
         call put(words, trim(line), error)
      end do
      call finish_out(table, error)
      call finish_out(words, error)
   end subroutine repeat_review

   subroutine one_end(method, count, y, q, error)
      character(*), intent(in) :: method
      integer(i8), intent(in) :: count
      real(dp), intent(out) :: y(3), q(4)
      type(poinsot_error), intent(inout) :: error
      real(dp) :: yb(lanes, 3), qb(lanes, 4), seconds
      logical :: good
      yb = spread(y0, 1, lanes)
      qb = spread(q0, 1, lanes)
      call run_block(moments, method, t_end/real(count, dp), count, yb, qb, good, seconds, error)
      y = yb(1, :)
      q = qb(1, :)
   end subroutine one_end

end module poinsot_study_repeat_review
