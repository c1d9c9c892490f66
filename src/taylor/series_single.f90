!> Taylor series of 16 bodies side by side in single precision.
module poinsot_taylor_series_single
   use poinsot_core_kinds, only: wp => sp
   use poinsot_taylor_series_common, only: top => last_order, reciprocal, sine_series, &
      cosine_series, turn_limit => farthest_turn, angle_limit => farthest_angle
   implicit none(type, external)
   private
   public :: lane_constants, lane_extras, width, series_one, series_two, fill_cosine, &
      horner_one, horner_two, turn_one, turn_two

   integer, parameter :: width = 16
   integer, parameter :: trig = 6        ! terms of sine and cosine
   real(wp), parameter :: farthest_turn = real(turn_limit, wp), &
      farthest_angle = real(angle_limit, wp)

   include 'series.inc'

end module poinsot_taylor_series_single
