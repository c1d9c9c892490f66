!> Drawing pictures with gnuplot, and printing text files on the terminal.
module app_draw
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_text, only: escaped
   use app_find_scene, only: find_shared
   use app_terminal, only: say, print_error
   implicit none(type, external)
   private
   public :: draw_pictures, show_file

contains

   !> Put the script plot_NAME.gp of each picture into a folder, with the scripts it loads, and draw
   !> it where gnuplot is found; what gnuplot complains of stays in plot_NAME.log.
   subroutine draw_pictures(names, out, quiet, scripts_only)
      character(*), intent(in) :: names(:), out
      logical, intent(in) :: quiet
      logical, intent(in) :: scripts_only !! do not draw
      type(poinsot_error) :: error
      character(:), allocatable :: plots
      integer :: i, state, code
      if (size(names) == 0) return
      call find_shared("plots", plots)
      if (len(plots) == 0) then
         if (.not. scripts_only) call print_error("no pictures: the plot " // &
            "scripts, share/poinsot/plots, were not found; set POINSOT_SHARE to the folder " // &
            "share/poinsot")
         return
      end if
      do i = 1, size(names)
         call place_script(plots, "plot_" // trim(names(i)) // ".gp", out, error)
      end do
      if (raised(error)) call print_error(error%message)
      if (raised(error) .or. scripts_only) return
      call execute_command_line("gnuplot --version >/dev/null 2>&1", exitstat=state, cmdstat=code)
      if (state /= 0 .or. code /= 0) then
         if (.not. quiet) call say("gnuplot not found; pictures can be drawn later by plot_*.gp")
         return
      end if
      do i = 1, size(names)
         call draw(trim(names(i)), out, quiet)
      end do
   end subroutine draw_pictures

   !> One picture.
   subroutine draw(name, out, quiet)
      character(*), intent(in) :: name, out
      logical, intent(in) :: quiet
      character(:), allocatable :: script
      integer :: state, code
      script = "plot_" // name
      call execute_command_line("cd " // escaped(out) // " && gnuplot " // script // ".gp >" // &
                                script // ".log 2>&1 && rm -f " // script // ".log", &
                                exitstat=state, cmdstat=code)
      if (state /= 0 .or. code /= 0) then
         call print_error("gnuplot failed on " // script // ".gp; see " // script // &
            ".log beside it")
      else if (.not. quiet) then
         call say("picture   " // name // ".svg, " // name // ".png")
      end if
   end subroutine draw

   !> Copy a script and the shipped scripts that it loads; the others are data of the run.
   recursive subroutine place_script(plots, script, out, error)
      character(*), intent(in) :: plots, script, out !! where from, which, where to
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: load = "load '"
      type(out_file) :: file
      character(400) :: line
      integer :: unit, code, from
      open (newunit=unit, file=plots // "/" // script, action="read", status="old", iostat=code)
      if (code /= 0 .or. raised(error)) return
      call open_out(out // "/" // script, file, error)
      do
         read (unit, "(a)", iostat=code) line
         if (code /= 0 .or. raised(error)) exit
         call put(file, trim(line), error)
         from = index(line, load) + len(load)
         if (from == len(load)) cycle
         call place_script(plots, line(from:from + index(line(from:), "'") - 2), out, error)
      end do
      close (unit)
      call finish_out(file, error)
   end subroutine place_script

   !> A text file on standard output.
   subroutine show_file(file)
      character(*), intent(in) :: file
      character(4000) :: line
      integer :: unit, code
      open (newunit=unit, file=file, action="read", status="old", iostat=code)
      if (code /= 0) return
      do
         read (unit, "(a)", iostat=code) line
         if (code /= 0) exit
         call say(trim(line))
      end do
      close (unit)
   end subroutine show_file

end module app_draw
