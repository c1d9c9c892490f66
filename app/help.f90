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
      command("run", "run a scene: trajectory, summary, pictures, page to watch"), &
      command("view", "the motion in a browser: a run's page anew, or a scene's"), &
      command("cost", "what accuracy costs in time, on a scene"), &
      command("choose", "the cheapest method and step that meet a tolerance"), &
      command("reproduce", "published comparisons once more, as pictures"), &
      command("properties", "what each method keeps: the review's table, measured"), &
      command("hard", "hard bodies through every method, measured"), &
      command("methods", "list the methods that turn a free body"), &
      command("splittings", "list the schemes that alternate kicks and turns"), &
      command("effects", "list the effects with their keys; or explain one"), &
      command("keys", "all keys of a scene file: type, default, units"), &
      command("scenes", "list the scenes that are shipped; or print one")]

contains

   !> poinsot --help
   subroutine show_help()
      integer :: i
      call put([character(100) :: &
         "poinsot turns rigid bodies.", &
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
         "Exit code: 0 done, 1 files or memory or interrupted, 2 command line or input,", &
         "           3 the calculation failed, 4 the tolerance of choose or auto is not kept"])
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
            "Finds the cheapest method, splitting and step that meet a tolerance at the scene's", &
            "end, on its own bodies and this machine, and writes the scene with them filled in.", &
            "The tolerance is for the attitude, in radians, and for the momentum, over its size.", &
            "", &
            "   --tol TOL              the tolerance, 1e-15 to 1 (default &scene tol)", &
            "   --out FILE             the scene written, or a folder for it (default", &
            "                          poinsot-out/SCENE-chosen.nml)", &
            "   --budget TIME          of the processor, as 20s or 2m (default 20s): another", &
            "                          program at work changes the wait, not the choice", &
            "   --methods A,B,C        among these only", &
            "   --splittings A,B,C     among these only", &
            "   --set GROUP.KEY=VALUE  a setting over the file's own; it is in the scene written", &
            "   --quiet                print errors only", &
            "", &
            "The choice is run to the scene's end with all its bodies before it is named.", &
            "", &
            "A scene with method = 'auto' does the same when it starts, for &scene tol, within 5", &
            "seconds, and says in summary and restart what it chose; splitting = 'auto' keeps", &
            "the method; a step that is given is the longest allowed. A restart never chooses", &
            "again. Exit code 4: nothing keeps the tolerance, because the motion is chaotic (how", &
            "long it holds is said) or out of reach, or time ran out; the best is named. A run", &
            "under 'auto' then goes on with the best, and ends with code 4 too."])
      case ("reproduce")
         call put([character(100) :: &
            "poinsot reproduce review | hairer-vilmart | fasso | celledoni [OPTIONS]", &
            "", &
            "   review           the thrown book of Vilmart's review (2013), figure 1: distance", &
            "                    from the published end by several methods, and its picture", &
            "   hairer-vilmart   error against time of two free bodies, order 2 to 10, and the", &
            "                    exact step (J. Phys. A 39, 13225, 2006, figure 1)", &
            "   fasso            error over the triangle of all bodies for each method: how much", &
            "                    methods of one order differ (J. Comput. Phys. 189, 527, 2003)", &
            "   celledoni        when the exact rotor pays inside a splitting (SIAM J. Sci.", &
            "                    Comput. 30, 2084, 2008); takes --budget, default 120s", &
            "", &
            "Prints what was found; numbers as CSV, pictures by gnuplot, in DIR (default", &
            "poinsot-out/FIGURE). --no-pictures, --quiet as in cost."])
      case ("properties")
         call put([character(100) :: &
            "poinsot properties [--out DIR]", &
            "", &
            "Measures what every method keeps, a few seconds: its order, the quadratic and", &
            "linear invariants, whether it is Poisson, symplectic, time-reversible and exact for", &
            "symmetric bodies; and how far the library's kernel is from the map so judged.", &
            "DIR/properties.csv holds the numbers behind each yes and no."])
      case ("hard")
         call put([character(100) :: &
            "poinsot hard [NAME] [--out DIR]", &
            "", &
            "Sends hard bodies of 18 kinds (near the separatrix, nearly linear, flat, in SI", &
            "units, ...) through every method, with plain and with compensated sums; measures 13", &
            "promises (other units, axes in any order, there and back, steps of any size,", &
            "quaternions off unit norm, ...), seven tops and fields in every splitting, and nine", &
            "tops by taylor: the worst errors, refusals, verdicts on each against its bound.", &
            "A few seconds.", &
            "", &
            "   NAME        one case, method or splitting: every figure, bound and verdict of it", &
            "   --out DIR   all of it in DIR/hard.csv", &
            "", &
            "docs/robustness.md says what each case is and where each method's limit lies. Exit", &
            "code 3: a verdict is bad."])
      case ("methods")
         call put([character(100) :: &
            "poinsot methods", &
            "", &
            "Lists the methods that turn a free body: name, order (exact: right to rounding for", &
            "any step), what it is. A scene names one in &scene method = '...'.", &
            "", &
            "All but exact and jacobi take steps of at most a quarter turn by the largest", &
            "angular velocity of the motion (dmv2 and rattle a third less), and refuse longer", &
            "ones: poinsot hard, docs/robustness.md."])
      case ("splittings")
         call put([character(100) :: &
            "poinsot splittings", &
            "", &
            "Lists the schemes that alternate kicks by the effects with free turns: name, order,", &
            "turns and force gradients of a step, author and year. A scene with effects names", &
            "one in &scene splitting = '...'."])
      case ("effects")
         call put([character(100) :: &
            "poinsot effects [NAME]", &
            "", &
            "Lists the effects a scene can hold, each a group &NAME ... / in the scene file. A", &
            "NAME: its formula, its keys with defaults and units, what it is tested against.", &
            "NAME may also be scene, bodies or output: the keys of those groups."])
      case ("keys")
         call put([character(100) :: &
            "poinsot keys [GROUP]", &
            "", &
            "Every key of every group of a scene file, or of one group: what it takes, its", &
            "default, its units or choices, what it means. The tables are in Markdown, and", &
            "stand in docs/scenes.md with the rules around them."])
      case ("scenes")
         call put([character(100) :: &
            "poinsot scenes [NAME]", &
            "", &
            "Lists the scenes that `poinsot run NAME` finds, or prints one: the place to start a", &
            "scene of your own is `poinsot scenes heavy-top > mine.nml`.", &
            "", &
            "A NAME is looked for as NAME.nml in this folder, in the folders of POINSOT_SCENES", &
            "(colons between them), beside the program in ../share/poinsot/scenes, and in the", &
            "source tree the program was built in."])
      case default
         call show_help()
      end select
   end subroutine show_command_help

   subroutine help_run()
      call put([character(100) :: &
         "poinsot run SCENE [OPTIONS]", &
         "", &
         "SCENE is a scene file, the name of a shipped scene (poinsot scenes lists them), or -", &
         "for the standard input.", &
         "", &
         "   --out DIR              folder for the output (default poinsot-out/SCENE), made", &
         "                          if missing; files of an earlier run in it are replaced", &
         "   --threads N            threads (default: as OpenMP says, for 20 ms and more)", &
         "   --set GROUP.KEY=VALUE  a setting over the file's own, as often as wanted:", &
         "                          --set scene.h=0.05 --set bodies.y=0,0.6,-0.8", &
         "                          bodies(2).KEY names the second &bodies; so with effects", &
         "   --check                check the scene, say what it would do, run nothing", &
         "   --no-pictures          write the plot scripts, do not run gnuplot", &
         "   --no-view              no view.html", &
         "   --quiet                print errors only", &
         "", &
         "Output (&output says which: poinsot keys):", &
         "   summary.txt       what ran, its speed, what changed that should not, the error", &
         "   trajectory.csv    t,body,q0..q3,y1..y3,kinetic,potential,energy", &
         "   trajectory.xyz    extended XYZ, for OVITO (&output format = 'extxyz')", &
         "   trajectory.npy    the columns of trajectory.csv for NumPy (format = 'npy')", &
         "   observables.csv   means over all bodies (observables = .true.)", &
         "   restart.txt       the state to the bit: continue with --set scene.from=FILE", &
         "   plot_*.gp         gnuplot scripts; their pictures too where gnuplot is found", &
         "   view.html         the motion, to watch in any browser; it needs no network", &
         "", &
         "q is a unit quaternion, scalar first, from body to space; y the angular momentum in", &
         "the body frame. Interrupted (Ctrl-C), a run ends at the next step with all its files", &
         "readable and a restart; the summary says so, and the exit code is 1."])
   end subroutine help_run

   subroutine help_view()
      call put([character(100) :: &
         "poinsot view FOLDER", &
         "poinsot view SCENE [OPTIONS]", &
         "", &
         "FOLDER is that of a run: its page view.html is made anew, from the data that stand in", &
         "it. SCENE is run for its page alone; the options are those of run. Prints where the", &
         "page is: open it in a browser. It holds everything it needs and asks nothing of a", &
         "network.", &
         "", &
         "Left the body with its axes, momentum and angular velocity; right, for a free body,", &
         "Poinsot's construction: the inertia ellipsoid rolling on the invariable plane. Below", &
         "momenta, energies, and what should stay constant. Drag to turn; space stops and goes;", &
         "view.html?t=3 opens at t = 3. At most 40 bodies and 2000 states are shown."])
   end subroutine help_view

   subroutine help_cost()
      call put([character(100) :: &
         "poinsot cost SCENE [OPTIONS]", &
         "", &
         "Measures what accuracy costs in time on the scene's own bodies and effects: every", &
         "method in every splitting over a range of steps, against a reference of known error.", &
         "Errors are medians over many initial states, the scene's own and others like them.", &
         "", &
         "   --budget TIME          all of it takes no longer, as 60s or 2m (default 60s)", &
         "   --methods A,B,C        these only (default all: poinsot methods)", &
         "   --splittings A,B,C     these only (default all that the effects allow)", &
         "   --tol 1e-3,1e-6        tolerances of the table (default 1e-3 to 1e-15)", &
         "   --states N             initial states (default 64)", &
         "   --spread ANGLE         how far they differ from the scene's own, in radians, or any", &
         "                          (default 0.3; of free bodies any)", &
         "   --sums plain           without compensated sums, which `poinsot run` has", &
         "   --rivals A.csv,B.csv   other integrators in the pictures, and the ratio of times at", &
         "                          equal error (bench/rivals.sh SCENE measures them)", &
         "   --set GROUP.KEY=VALUE  a setting over the file's own, as in run", &
         "   --out DIR              folder for the output (default poinsot-out/SCENE-cost)", &
         "   --no-pictures          write the plot scripts, do not run gnuplot", &
         "   --quiet                print errors only", &
         "", &
         "Output:", &
         "   cost.txt          reference, the cheapest for each tolerance, orders and times", &
         "   cost.csv          every point: errors, drift of energy, ns of a step", &
         "   drift.csv         error of the energy against time in long runs", &
         "   members.csv       initial states, and where the reference ends", &
         "   attitude_cost, momentum_cost, attitude_step, energy_drift: pictures", &
         "", &
         "A thermostat is studied without its noise: two runs with noise are two samples. What", &
         "averages are off by is not judged; splitting baoab is best there."])
   end subroutine help_cost

   subroutine put(lines)
      character(*), intent(in) :: lines(:)
      integer :: i
      do i = 1, size(lines)
         call say(trim(lines(i)))
      end do
   end subroutine put

end module app_help
