!> Every help text, and the table of commands.
module app_help
   use app_terminal, only: say
   implicit none(type, external)
   private
   public :: command, table, show_help, show_command_help

   !> One command.
   type :: command
      character(10) :: name
      character(60) :: about
   end type command

   type(command), parameter :: table(12) = [ &
      command("run", "run a scene: trajectory, summary, pictures, web page"), &
      command("view", "make the web page that shows the motion of a run or scene"), &
      command("cost", "measure what accuracy costs in time, on a scene"), &
      command("choose", "find the cheapest method and step size for a tolerance"), &
      command("reproduce", "reproduce published comparisons, with pictures"), &
      command("properties", "measure what each method conserves: the review's table"), &
      command("hard", "test every method on hard bodies, steps and tops"), &
      command("methods", "list the methods for free rotation"), &
      command("splittings", "list the splitting schemes"), &
      command("effects", "list the effects, or explain one and its keys"), &
      command("keys", "list the keys of a scene file: type, default, units"), &
      command("scenes", "list the shipped scenes, or print one")]

contains

   !> poinsot --help
   subroutine show_help()
      integer :: i
      call put([character(100) :: &
         "poinsot computes the rotation of rigid bodies.", &
         "", &
         "   poinsot COMMAND [ARGUMENTS]", &
         ""])
      do i = 1, size(table)
         call say("   " // table(i)%name // "  " // trim(table(i)%about))
      end do
      call put([character(100) :: &
         "", &
         "   poinsot COMMAND --help   explains a command", &
         "   poinsot --version        version, compiler and flags", &
         "", &
         "First steps:  poinsot run free-body", &
         "              poinsot run heavy-top --out top", &
         "", &
         "Exit code: 0 success, 1 file or memory error, or interrupted, 2 bad command line or", &
         "           input, 3 the calculation failed, 4 tolerance of choose or auto not met"])
   end subroutine show_help

   !> poinsot COMMAND --help
   subroutine show_command_help(name)
      character(*), intent(in) :: name !! a command of the table
      select case (name)
      case ("run")
         call help_run()
      case ("view")
         call help_view()
      case ("cost")
         call help_cost()
      case ("choose")
         call put([character(100) :: &
            "poinsot choose SCENE --tol 1e-8 [OPTIONS]", &
            "", &
            "Finds the cheapest method, splitting and step size that meet a tolerance at the end", &
            "of the scene, for its own bodies on this machine, and writes the scene with them.", &
            "The tolerance applies to the attitude, in radians, and to the relative momentum.", &
            "", &
            "   --tol TOL              the tolerance, 1e-15 to 1 (default: &scene tol)", &
            "   --out FILE             where to write the scene, a file or a folder (default", &
            "                          poinsot-out/SCENE-chosen.nml)", &
            "   --budget TIME          limit of processor time, e.g. 20s or 2m (default 20s):", &
            "                          other programs delay the choice, but do not change it", &
            "   --methods A,B,C        consider only these methods", &
            "   --splittings A,B,C     consider only these splittings", &
            "   --set GROUP.KEY=VALUE  override a setting of the file, also in the scene written", &
            "   --quiet                print errors only", &
            "", &
            "The choice is verified by a run of all bodies to the end of the scene.", &
            "", &
            "A scene with method = 'auto' does the same at start-up, for &scene tol, within 5", &
            "seconds, and records the choice in summary and restart file. splitting = 'auto'", &
            "chooses only the splitting and step size; a given h is the largest allowed. A", &
            "restarted run keeps its choice. Exit code 4: nothing meets the tolerance, because", &
            "the motion is chaotic (the time for which it holds is printed), the tolerance is", &
            "out of reach, or time ran out; the best is printed. A run with 'auto' goes on with", &
            "the best, and also ends with code 4."])
      case ("reproduce")
         call put([character(100) :: &
            "poinsot reproduce review | hairer-vilmart | fasso | celledoni [OPTIONS]", &
            "", &
            "   review           the thrown book of Vilmart's review (2013), figure 1: distance", &
            "                    of several methods from the published end point, and picture", &
            "   hairer-vilmart   error against time for two free bodies, orders 2 to 10 and the", &
            "                    exact step (J. Phys. A 39, 13225, 2006, figure 1)", &
            "   fasso            error of each method over the triangle of all bodies: how much", &
            "                    methods of one order differ (J. Comput. Phys. 189, 527, 2003)", &
            "   celledoni        when the exact rotor pays inside a splitting (SIAM J. Sci.", &
            "                    Comput. 30, 2084, 2008); option --budget, default 120s", &
            "", &
            "Prints the results; writes CSV files and, with gnuplot, pictures to --out DIR", &
            "(default poinsot-out/FIGURE). --no-pictures and --quiet as in cost."])
      case ("properties")
         call put([character(100) :: &
            "poinsot properties [--out DIR]", &
            "", &
            "Measures the properties of every method in a few seconds: its order, whether it", &
            "conserves the quadratic and linear invariants, is Poisson, symplectic, time-", &
            "reversible and exact for symmetric bodies; and the distance of the library's kernel", &
            "from the map so tested. DIR/properties.csv has the number behind each yes and no."])
      case ("hard")
         call put([character(100) :: &
            "poinsot hard [NAME] [--out DIR]", &
            "", &
            "Tests every method, with plain and compensated sums, on 18 kinds of hard bodies", &
            "(near the separatrix, nearly linear, flat, in SI units, ...) and for 13 promised", &
            "properties (other units, axes in any order, there and back, steps of any size,", &
            "quaternions off unit norm, ...); every splitting on seven tops and fields; and", &
            "taylor on nine tops. Prints the worst errors, the bodies refused, and verdicts on", &
            "each against its bound, in a few seconds.", &
            "", &
            "   NAME        one case, method or splitting: all its figures, bounds and verdicts", &
            "   --out DIR   write everything to DIR/hard.csv", &
            "", &
            "docs/robustness.md describes each case and the limits of each method. Exit code 3:", &
            "a verdict is bad."])
      case ("methods")
         call put([character(100) :: &
            "poinsot methods", &
            "", &
            "Lists the methods for free rotation: name, order (exact: to rounding error for any", &
            "step), description. A scene selects one with &scene method = '...'.", &
            "", &
            "Except exact and jacobi, methods take steps of at most a quarter turn at the", &
            "largest angular velocity of the motion (dmv2 and rattle a third less), and refuse", &
            "longer ones: see poinsot hard and docs/robustness.md."])
      case ("splittings")
         call put([character(100) :: &
            "poinsot splittings", &
            "", &
            "Lists the schemes that alternate kicks by the effects with drifts (free rotation):", &
            "name, order, drifts per step, force gradients, purpose, author and year. A scene", &
            "with effects selects one with &scene splitting = '...'."])
      case ("effects")
         call put([character(100) :: &
            "poinsot effects [NAME]", &
            "", &
            "Lists the effects; each is a group &NAME ... / in a scene file. With NAME: its", &
            "formula, its keys with defaults and units, and what it is tested against. NAME may", &
            "also be scene, bodies or output."])
      case ("keys")
         call put([character(100) :: &
            "poinsot keys [GROUP]", &
            "", &
            "Lists every key of a scene file, or of one group: type, default, units or choices,", &
            "meaning. The Markdown tables are also in docs/scenes.md, with the rules."])
      case ("scenes")
         call put([character(100) :: &
            "poinsot scenes [NAME]", &
            "", &
            "Lists the scenes that `poinsot run NAME` finds, or prints one. To start a scene of", &
            "your own: poinsot scenes heavy-top > mine.nml", &
            "", &
            "NAME.nml is searched for in the current folder, in the folders of POINSOT_SCENES", &
            "(separated by colons), in ../share/poinsot/scenes relative to the program, and in", &
            "the source tree from which the program was built."])
      case default
         call show_help()
      end select
   end subroutine show_command_help

   subroutine help_run()
      call put([character(100) :: &
         "poinsot run SCENE [OPTIONS]", &
         "", &
         "SCENE is a scene file, the name of a shipped scene (see poinsot scenes), or - for", &
         "standard input.", &
         "", &
         "   --out DIR              output folder (default poinsot-out/SCENE), created if", &
         "                          missing; files of an earlier run in it are replaced", &
         "   --threads N            threads (default: OpenMP's number for 20 ms of work, else 1)", &
         "   --set GROUP.KEY=VALUE  override a setting of the file; may be repeated:", &
         "                          --set scene.h=0.05 --set bodies.y=0,0.6,-0.8", &
         "                          bodies(2).KEY is of the second &bodies group; likewise", &
         "                          for effects", &
         "   --check                check the scene and report what it would do, without running", &
         "   --no-pictures          write the plot scripts, do not run gnuplot", &
         "   --no-view              no view.html", &
         "   --quiet                print errors only", &
         "", &
         "Output (selected by &output: poinsot keys output):", &
         "   summary.txt       the run, its speed, drift of conserved quantities, the error", &
         "   trajectory.csv    t,body,q0..q3,y1..y3,kinetic,potential,energy", &
         "   trajectory.xyz    extended XYZ, for OVITO (&output format = 'extxyz')", &
         "   trajectory.npy    the columns of trajectory.csv for NumPy (format = 'npy')", &
         "   observables.csv   means over all bodies (observables = .true.)", &
         "   restart.txt       the exact state: continue with --set scene.from=FILE", &
         "   plot_*.gp         gnuplot scripts, and their pictures if gnuplot is found", &
         "   view.html         the motion, to watch in any browser without a network", &
         "", &
         "q is a unit quaternion, scalar first, body to space; y is the angular momentum in", &
         "the body frame. On Ctrl-C a run stops at the next step, with complete files and a", &
         "restart file; the summary says so, and the exit code is 1."])
   end subroutine help_run

   subroutine help_view()
      call put([character(100) :: &
         "poinsot view FOLDER", &
         "poinsot view SCENE [OPTIONS]", &
         "", &
         "Remakes the page view.html of a run in FOLDER from its data, or runs SCENE only to", &
         "make its page; the options are those of run. Prints the path of the page: open it in", &
         "a browser. It needs no other file and no network.", &
         "", &
         "Left: the body with its axes, momentum and angular velocity. Right, for a free body:", &
         "Poinsot's construction, the inertia ellipsoid rolling on the invariable plane. Below:", &
         "momenta, energies, conserved quantities. Drag to rotate; the space bar stops and", &
         "resumes; view.html?t=3 opens at t = 3. At most 40 bodies and 2000 states are shown."])
   end subroutine help_view

   subroutine help_cost()
      call put([character(100) :: &
         "poinsot cost SCENE [OPTIONS]", &
         "", &
         "Measures what accuracy costs in time, for the scene's own bodies and effects: every", &
         "method in every splitting over a range of step sizes, against a reference of known", &
         "error. Errors are medians over many initial states: the scene's own and similar ones.", &
         "", &
         "   --budget TIME          limit for the whole study, e.g. 60s or 2m (default 60s)", &
         "   --methods A,B,C        only these methods (default: all)", &
         "   --splittings A,B,C     only these splittings (default: all that the effects allow)", &
         "   --tol 1e-3,1e-6        tolerances of the table (default 1e-3 to 1e-15)", &
         "   --states N             number of initial states (default 64)", &
         "   --spread ANGLE         how far they differ from the scene's own, in radians, or any", &
         "                          (default 0.3; any for free bodies)", &
         "   --sums plain           without the compensated sums that `poinsot run` uses", &
         "   --rivals A.csv,B.csv   other integrators to draw, and to compare in time at equal", &
         "                          error (bench/rivals.sh SCENE measures them)", &
         "   --set GROUP.KEY=VALUE  override a setting of the file, as in run", &
         "   --out DIR              output folder (default poinsot-out/SCENE-cost)", &
         "   --no-pictures          write the plot scripts, do not run gnuplot", &
         "   --quiet                print errors only", &
         "", &
         "Output:", &
         "   cost.txt          reference, the cheapest for each tolerance, orders and times", &
         "   cost.csv          every point: errors, energy drift, ns per step", &
         "   drift.csv         energy error against time in long runs", &
         "   members.csv       initial states, and end states of the reference", &
         "   attitude_cost, momentum_cost, attitude_step, energy_drift: pictures", &
         "", &
         "Thermostats are studied without noise, because runs with noise are only samples.", &
         "Errors of averages are not measured; the splitting baoab is best for them."])
   end subroutine help_cost

   subroutine put(lines)
      character(*), intent(in) :: lines(:)
      integer :: i
      do i = 1, size(lines)
         call say(trim(lines(i)))
      end do
   end subroutine put

end module app_help
