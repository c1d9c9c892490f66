!> Picture of what should stay constant: the change of each quantity against time.
module poinsot_scene_plots_drift
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_text, only: text_of
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_plots_common, only: put_lines, put_start, put_end, put_columns
   implicit none(type, external)
   private
   public :: write_drift

   integer, parameter :: strip_length = 60 !! of the name and the expression of a strip

contains

   !> What should stay constant, against time: a strip for each.
   subroutine write_drift(scene, path, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: path          !! of the file
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(strip_length), allocatable :: names(:), terms(:)
      integer :: i
      call open_out(path, file, error)
      if (raised(error)) return
      if (size(scene%effects) == 0) then
         names = [character(strip_length) :: "the energy", "|y|", &
                  "Q y, all three components", "|q|"]
         terms = [character(strip_length) :: "$12/unit_h", "sqrt($7**2+$8**2+$9**2)/unit_l", &
                  "qy#($3,$4,$5,$6,$7,$8,$9)/unit_l", "sqrt($3**2+$4**2+$5**2+$6**2)"]
      else
         names = [character(strip_length) :: "the energy", "the vertical component of Q y", "|q|"]
         terms = [character(strip_length) :: "$12/unit_h", "qy3($3,$4,$5,$6,$7,$8,$9)/unit_l", &
                  "sqrt($3**2+$4**2+$5**2+$6**2)"]
      end if
      call put_start(scene, file, "drift", 720, 110*size(names) + 80, error)
      call put_columns(file, error)
      call put_lines(file, [character(120) :: &
         "unset key; set border 3; set tics nomirror out", &
         "set xrange [*:*]; set yrange [*:*]; set offsets 0,0,0,0", &
         "first(x) = (n == 0 ? (n = 1, x0 = x) : 0, x - x0)", &
         "qy1(a,b,c,d,x,y,z) = q11(a,b,c,d)*x + q12(a,b,c,d)*y + q13(a,b,c,d)*z", &
         "qy2(a,b,c,d,x,y,z) = q21(a,b,c,d)*x + q22(a,b,c,d)*y + q23(a,b,c,d)*z", &
         "qy3(a,b,c,d,x,y,z) = q31(a,b,c,d)*x + q32(a,b,c,d)*y + q33(a,b,c,d)*z", &
         "stats file skip 1 every bodies::body using (sqrt($7**2+$8**2+$9**2)) name 'L' nooutput", &
         "stats file skip 1 every bodies::body using (abs($10) + abs($11)) name 'H' nooutput", &
         "unit_l = L_max > 0 ? L_max : 1; unit_h = H_max > 0 ? H_max : 1", &
         "array m[4] = [1e-17, 1e-17, 1e-17, 1e-17]   # largest change in each strip"], error)
      do i = 1, size(names)
         call put_range(file, i, trim(terms(i)), error)
      end do
      call put(file, "set multiplot layout " // text_of(size(names)) // &
               ",1 margins 0.14,0.97,0.15,0.93 spacing 0,0.07", error)
      do i = 1, size(names)
         call put_strip(file, i, trim(names(i)), trim(terms(i)), i == size(names), error)
      end do
      call put(file, "unset multiplot; unset xlabel", error)
      call put_end(file, error)
      call finish_out(file, error)
   end subroutine write_drift

   !> Find the largest change of a strip's curves.
   subroutine put_range(file, strip, term, error)
      type(out_file), intent(in) :: file
      integer, intent(in) :: strip
      character(*), intent(in) :: term
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: m
      integer :: j
      m = "m[" // text_of(strip) // "]"
      do j = 1, parts_of(term)
         call put(file, "n = 0; stats file skip 1 every bodies::body using (first(" // &
                  part_of(term, j) // ")) name 'D' nooutput", error)
         call put(file, m // " = abs(D_min) > " // m // " ? abs(D_min) : " // m // "; " // &
                  m // " = abs(D_max) > " // m // " ? abs(D_max) : " // m, error)
      end do
   end subroutine put_range

   !> One strip: change of a quantity since the first row.
   subroutine put_strip(file, strip, name, term, last, error)
      type(out_file), intent(in) :: file
      integer, intent(in) :: strip
      character(*), intent(in) :: name, term
      logical, intent(in) :: last           !! has the time axis
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: styles(3) = [character(24) :: "lc rgb '#1f3f66' lw 1.0", &
                                              "lc rgb '#8a8a8a' lw 1.0", "lc rgb '#b4c2d2' lw 1.0"]
      character(:), allocatable :: m
      integer :: j
      m = "m[" // text_of(strip) // "]"
      call put(file, "set yrange [-1.15*" // m // ":1.15*" // m // "]; " // &
               "set ytics (sprintf('%.0e', " // m // ") " // m // ", '0' 0, " // &
               "sprintf('%.0e', -" // m // ") -" // m // ")", error)
      call put(file, "set label 1 'change of " // name // "' at graph 0.01, graph 1.1", error)
      if (last) then
         call put(file, "set xlabel 't'; set xtics format '%g'", error)
      else
         call put(file, "unset xlabel; set xtics format ''", error)
      end if
      do j = 1, parts_of(term)
         call put(file, merge("plot", "    ", j == 1) // &
                  " file skip 1 every bodies::body using ($0 == 0 ? (n = 0) : 0, $1):(first(" // &
                  part_of(term, j) // ")) with lines " // trim(styles(j)) // &
                  trim(merge(", \", "   ", j < parts_of(term))), error)
      end do
   end subroutine put_strip

   !> How many curves a strip has: # in its expression stands for 1, 2 and 3.
   pure integer function parts_of(term)
      character(*), intent(in) :: term
      parts_of = merge(3, 1, index(term, "#") > 0)
   end function parts_of

   !> One of the curves.
   pure function part_of(term, j) result(part)
      character(*), intent(in) :: term
      integer, intent(in) :: j
      character(:), allocatable :: part
      integer :: mark
      part = term
      mark = index(term, "#")
      if (mark > 0) part = term(:mark - 1) // text_of(j) // term(mark + 1:)
   end function part_of

end module poinsot_scene_plots_drift
