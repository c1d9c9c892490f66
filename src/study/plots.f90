!> What pictures of studies share: terminals, colours that differ in grey and for the colour-blind,
!> ends of axes.
module poinsot_study_plots
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error
   use poinsot_scene_files, only: out_file, put
   use poinsot_scene_plots_common, only: put_lines
   use poinsot_scene_text, only: text_of
   implicit none(type, external)
   private
   public :: put_terminals, strong_colour, strong_point, nice_below, nice_above, either

   integer, parameter, public :: strong = 8 !! curves that have colours of their own

   !> Okabe and Ito's colours, darkened where they are too pale on white, dark and light in turn.
   character(7), parameter :: colours(strong) = ["#0b3c6f", "#d55e00", "#007a5a", "#b0539a", &
      "#2f8fce", &
                                                 "#8a6d00", "#000000", "#a00000"]
   integer, parameter :: shapes(strong) = [7, 5, 9, 13, 6, 4, 8, 12]

contains

   !> Head of a script: how to run it, and the loop over terminals that put_end closes.
   subroutine put_terminals(file, name, width, height, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: name          !! of the picture
      integer, intent(in) :: width, height      !! points
      type(poinsot_error), intent(inout) :: error
      call put(file, "# gnuplot plot_" // name // ".gp, in this folder, draws " // name // &
         ".svg and " // &
               name // ".png", error)
      call put_lines(file, [character(100) :: &
         "set datafile separator ','", &
         "set encoding utf8", &
         "do for [kind in 'svg pngcairo'] {", &
         "if (strstrt(GPVAL_TERMINALS, kind) == 0) { continue }", &
         "unset label; unset arrow; unset object", &
         "if (kind eq 'svg') {"], error)
      call put(file, "set terminal svg size " // text_of(width) // "," // text_of(height) // &
               " dynamic background '#ffffff' font 'DejaVu Sans,12'", error)
      call put(file, "set output '" // name // ".svg'", error)
      call put(file, "} else {", error)
      call put(file, "set terminal pngcairo size " // text_of(2*width) // "," // &
         text_of(2*height) // &
               " font 'DejaVu Sans,12' fontscale 2 linewidth 2 pointscale 2", error)
      call put(file, "set output '" // name // ".png'", error)
      call put(file, "}", error)
   end subroutine put_terminals

   !> One text or another, of any lengths.
   pure function either(yes, no, which) result(text)
      character(*), intent(in) :: yes, no
      logical, intent(in) :: which
      character(:), allocatable :: text
      text = no
      if (which) text = yes
   end function either

   !> Colour of the k-th curve.
   pure function strong_colour(k) result(colour)
      integer, intent(in) :: k
      character(7) :: colour
      colour = colours(1 + mod(k - 1, strong))
   end function strong_colour

   !> Shape of its points.
   pure integer function strong_point(k)
      integer, intent(in) :: k
      strong_point = shapes(1 + mod(k - 1, strong))
   end function strong_point

   !> Ends of a logarithmic axis: 1, 2 or 5 times a power of ten.
   pure real(dp) function nice_below(value) result(nice)
      real(dp), intent(in) :: value
      real(dp) :: unit
      unit = 10.0_dp**floor(log10(value))
      nice = unit
      if (value >= 2*unit) nice = 2*unit
      if (value >= 5*unit) nice = 5*unit
   end function nice_below

   !> The same above.
   pure real(dp) function nice_above(value) result(nice)
      real(dp), intent(in) :: value
      real(dp) :: unit
      unit = 10.0_dp**floor(log10(value))
      nice = 10*unit
      if (value <= 5*unit) nice = 5*unit
      if (value <= 2*unit) nice = 2*unit
      if (value <= unit) nice = unit
   end function nice_above

end module poinsot_study_plots
