!> What the plot scripts share: terminals, colours, columns of the trajectory.
module poinsot_scene_plots_common
   use poinsot_core_kinds, only: i8
   use poinsot_core_error, only: poinsot_error
   use poinsot_scene_text, only: text_of
   use poinsot_scene_files, only: out_file, put
   use poinsot_scene_settings, only: scene_settings, body_total
   implicit none(type, external)
   private
   public :: put_lines, put_start, put_end, put_columns, written_bodies, first_group

   character(*), parameter, public :: dark = "#1f3f66"   !! what the picture is about
   character(*), parameter, public :: pale = "#b4c2d2"   !! the same on the far side
   character(*), parameter, public :: grey = "#7d7d7d"   !! contours, helping lines
   character(*), parameter, public :: faint = "#dcdcdc"  !! the same on the far side

contains

   !> Lines of a script; blanks at the ends are dropped, empty ones left out.
   subroutine put_lines(file, lines, error)
      type(out_file), intent(in) :: file !! open
      character(*), intent(in) :: lines(:)
      type(poinsot_error), intent(inout) :: error
      integer :: i
      do i = 1, size(lines)
         if (len_trim(lines(i)) > 0) call put(file, trim(lines(i)), error)
      end do
   end subroutine put_lines

   !> How many bodies a frame has.
   pure integer function written_bodies(scene)
      type(scene_settings), intent(in) :: scene !! the typed scene
      written_bodies = size(scene%output%bodies)
      if (written_bodies == 0) written_bodies = int(body_total(scene))
   end function written_bodies

   !> Group of the first body written.
   pure integer function first_group(scene)
      type(scene_settings), intent(in) :: scene !! the typed scene
      integer(i8) :: body, last
      body = 1
      if (size(scene%output%bodies) > 0) body = scene%output%bodies(1)
      last = 0
      do first_group = 1, size(scene%bodies)
         last = last + scene%bodies(first_group)%count
         if (body <= last) return
      end do
      first_group = 1
   end function first_group

   !> Head of a script: how to run it, data, and the loop over terminals that put_end closes.
   subroutine put_start(scene, file, name, width, height, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      type(out_file), intent(in) :: file        !! open
      character(*), intent(in) :: name          !! of the picture
      integer, intent(in) :: width, height      !! points
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: extent, large
      extent = text_of(width) // "," // text_of(height)
      large = text_of(2*width) // "," // text_of(2*height)
      call put(file, "# gnuplot plot_" // name // ".gp, in this folder, draws " // name // &
               ".svg and " // name // ".png", error)
      call put(file, "file = 'trajectory.csv'", error)
      call put(file, "bodies = " // text_of(written_bodies(scene)) // "   # rows of a frame", error)
      call put_lines(file, [character(100) :: &
         "body = 0     # which of them is drawn, from 0", &
         "do for [kind in 'svg pngcairo'] {", &
         "if (strstrt(GPVAL_TERMINALS, kind) == 0) { continue }", &
         "reset; set encoding utf8; set datafile separator ','", &
         "if (kind eq 'svg') {"], error)
      call put(file, "set terminal svg size " // extent // " dynamic background '#ffffff' " // &
               "font 'DejaVu Sans,12'", error)
      call put(file, "set output '" // name // ".svg'", error)
      call put(file, "} else {", error)
      call put(file, "set terminal pngcairo size " // large // " font 'DejaVu Sans,12' " // &
               "fontscale 2 linewidth 2 pointscale 2", error)
      call put(file, "set output '" // name // ".png'", error)
      call put(file, "}", error)
   end subroutine put_start

   !> Close the loop over terminals.
   subroutine put_end(file, error)
      type(out_file), intent(in) :: file !! open
      type(poinsot_error), intent(inout) :: error
      call put_lines(file, [character(20) :: "unset output", "}"], error)
   end subroutine put_end

   !> Columns of the rotation matrix, as functions of the columns 3 to 6 of a row.
   subroutine put_columns(file, error)
      type(out_file), intent(in) :: file !! open
      type(poinsot_error), intent(inout) :: error
      call put_lines(file, [character(100) :: &
         "# entry i of column j of the rotation matrix, from the quaternion a b c d", &
         "q11(a,b,c,d) = 1 - 2*(c*c + d*d)", &
         "q21(a,b,c,d) = 2*(b*c + a*d)", &
         "q31(a,b,c,d) = 2*(b*d - a*c)", &
         "q12(a,b,c,d) = 2*(b*c - a*d)", &
         "q22(a,b,c,d) = 1 - 2*(b*b + d*d)", &
         "q32(a,b,c,d) = 2*(c*d + a*b)", &
         "q13(a,b,c,d) = 2*(b*d + a*c)", &
         "q23(a,b,c,d) = 2*(c*d - a*b)", &
         "q33(a,b,c,d) = 1 - 2*(b*b + c*c)"], error)
   end subroutine put_columns

end module poinsot_scene_plots_common
