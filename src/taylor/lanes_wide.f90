!> The Taylor integrator of torques in two precisions, 8 x 2 bodies side by side.
module poinsot_taylor_lanes_wide
   use, intrinsic :: iso_c_binding, only: c_loc, c_f_pointer, c_intptr_t
   use poinsot_core_kinds, only: sp, dp, i4, i8
   use poinsot_core_status, only: poinsot_ok, poinsot_e_domain, poinsot_e_step
   use poinsot_effect_geometry, only: turned
   use poinsot_rotation_vector, only: cross
   use poinsot_taylor_problem, only: taylor_problem, place_in_table, see_phases
   use poinsot_taylor_settings, only: taylor_orders, taylor_time
   use poinsot_taylor_series_common, only: last_order, last_double
   use poinsot_taylor_series_double_wide, only: d_width => width, d_constants => lane_constants, &
      d_extras => lane_extras, d_series_one => series_one, d_series_two => series_two, &
      d_fill_cosine => fill_cosine, d_horner_vector => horner_vector, &
      d_horner_angle => horner_angle, d_turn_one => turn_one, d_turn_two => turn_two
   use poinsot_taylor_series_single_wide, only: s_constants => lane_constants, &
      s_extras => lane_extras, s_series_one => series_one, s_series_two => series_two, &
      s_fill_cosine => fill_cosine, s_horner_vector => horner_vector, &
      s_horner_angle => horner_angle, s_turn_one => turn_one, s_turn_two => turn_two
   use poinsot_taylor_lanes_common, only: fastest, slowest, exponent_bits, two_ones, smallest, &
      one_bits, per_bit, bits_per, longest_turn, almost_one, most_parts, grid_bits, grid_limit
   implicit none(type, external)
   private
   public :: run_lanes

   integer, parameter :: parts = 2              ! vectors of double precision

   include 'lanes.inc'

end module poinsot_taylor_lanes_wide
