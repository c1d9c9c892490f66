!> Pictures of a run: which there are, and trajectory.gp, the data that their scripts need. The
!> scripts, plot_NAME.gp, are gnuplot files (share/poinsot/plots); the app copies them beside the
!> trajectory, where they can be run again at any time.
module poinsot_scene_pictures
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_integrals, only: integral_list, scene_integrals
   use poinsot_scene_noise, only: wanted_temperature
   use poinsot_scene_plot_data, only: put_variable
   use poinsot_scene_settings, only: scene_settings, body_total
   use poinsot_scene_text, only: next_word
   implicit none(type, external)
   private
   public :: write_pictures, picture_names, picture_files, scene_files

   character(*), parameter :: averages = "observables" !! the one that needs no trajectory.csv
   character(*), parameter :: all_names(9) = [character(16) :: "attitude", "momentum", "drift", &
                                              "nutation", "tilt", "angle", "temperature", &
                                              "momenta", averages]
   character(*), parameter :: shared(4) = [character(16) :: "trajectory.gp", "motion.gp", &
                                           "common.gp", "ends.gp"]

contains

   !> Names of the pictures that a scene has, each once. NAME is drawn by plot_NAME.gp, into
   !> NAME.svg and NAME.png.
   subroutine picture_names(scene, names)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(16), allocatable, intent(out) :: names(:)
      character(:), allocatable :: rest, kind
      allocate (names(0))
      if (.not. scene%output%present .or. scene%output%pictures == "none") return
      rest = ""
      if (scene%output%csv) rest = scene%output%pictures
      do
         call next_word(rest, kind)
         if (kind == "") exit
         select case (kind)
         case ("body")
            call add([character(16) :: "attitude"])
            if (.not. rotors_change(scene)) call add([character(16) :: "momentum"])
            call add([character(16) :: "drift"])
         case ("top")
            call add([character(16) :: "nutation", "drift"])
         case ("tilt")
            call add([character(16) :: "tilt", "drift"])
         case ("angle")
            call add([character(16) :: "angle", "drift"])
         case ("ensemble")
            if (wanted_temperature(scene) > 0 .and. .not. rotors_change(scene)) then
               call add([character(16) :: "temperature", "momenta"])
            else
               call add([character(16) :: "drift"])
            end if
         case default
            continue
         end select
      end do
      if (scene%output%observables) call add([character(16) :: averages])

   contains

      subroutine add(more)
         character(16), intent(in) :: more(:)
         integer :: i
         do i = 1, size(more)
            if (.not. any(names == more(i))) names = [character(16) :: names, more(i)]
         end do
      end subroutine add

   end subroutine picture_names

   !> Every file that drawing this scene writes: scripts, what they share, and pictures if they are
   !> drawn.
   subroutine scene_files(scene, names)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(40), allocatable, intent(out) :: names(:)
      character(16), allocatable :: pictures(:)
      integer :: i
      call picture_names(scene, pictures)
      allocate (names(0))
      if (size(pictures) > 0) names = [character(40) :: shared(1), shared(3)]
      if (any(pictures /= averages)) names = [character(40) :: shared(:3)]
      if (any(pictures == "tilt" .or. pictures == "angle")) names = [character(40) :: names, &
                                                                     shared(4)]
      do i = 1, size(pictures)
         names = [character(40) :: names, "plot_" // trim(pictures(i)) // ".gp"]
         if (scene%output%draw) names = [character(40) :: names, trim(pictures(i)) // ".svg", &
                                         trim(pictures(i)) // ".png"]
      end do
   end subroutine scene_files

   !> Every file that drawing may leave, of this scene or another.
   subroutine picture_files(names)
      character(40), allocatable, intent(out) :: names(:)
      integer :: i
      names = [character(40) :: shared]
      do i = 1, size(all_names)
         names = [character(40) :: names, "plot_" // trim(all_names(i)) // ".gp", &
                  trim(all_names(i)) // ".svg", trim(all_names(i)) // ".png"]
      end do
   end subroutine picture_files

   !> Has a body a rotor whose momentum is a table? Pictures of temperatures, and of the levels of
   !> the energy on the sphere of momenta, know constant ones.
   pure logical function rotors_change(scene)
      type(scene_settings), intent(in) :: scene !! the typed scene
      integer :: i
      rotors_change = .false.
      do i = 1, size(scene%bodies)
         rotors_change = rotors_change .or. allocated(scene%bodies(i)%rotor_tables%item)
      end do
   end function rotors_change

   !> Write trajectory.gp, if the scene has pictures. Error: POINSOT_E_IO.
   subroutine write_pictures(scene, out, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: out           !! the folder of the trajectory
      type(poinsot_error), intent(inout) :: error
      character(16), allocatable :: names(:)
      type(out_file) :: file
      integer :: written
      call picture_names(scene, names)
      if (size(names) == 0) return
      call open_out(out // "/trajectory.gp", file, error)
      if (raised(error)) return
      written = size(scene%output%bodies)
      if (written == 0) written = int(body_total(scene))
      call put(file, "# What plot_*.gp need to know of trajectory.csv.", error)
      call put_variable(file, "bodies", written, error)
      call put(file, "# which of them is drawn where only one is, from 0", error)
      call put_variable(file, "body", 0, error)
      call put_groups(scene, file, error)
      call put(file, "# the axis that pictures follow; the rate of the frame that an angle is " // &
               "seen from", error)
      call put_variable(file, "axis", scene%output%axis, error)
      call put_variable(file, "rate", scene%output%rate, error)
      call put_variable(file, "kt", max(wanted_temperature(scene), tiny(1.0_dp)), error)
      call put_integrals(scene, file, error)
      call finish_out(file, error)
   end subroutine write_pictures

   !> What the bodies are like.
   subroutine put_groups(scene, file, error)
      type(scene_settings), intent(in) :: scene
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      real(dp), dimension(3, size(scene%bodies)) :: moments, rotors
      real(dp) :: axes(3, 3, size(scene%bodies))
      integer :: last(size(scene%bodies)), g, j
      do g = 1, size(scene%bodies)
         last(g) = int(sum(scene%bodies(:g)%count))
         moments(:, g) = scene%bodies(g)%moments
         axes(:, :, g) = 0
         do j = 1, 3
            axes(j, j, g) = 1
         end do
         if (scene%bodies(g)%turned) axes(:, :, g) = scene%bodies(g)%axes
         rotors(:, g) = scene%bodies(g)%rotor
      end do
      call put(file, "# groups of bodies: the last body of each; three moments; principal " // &
               "axes in the given frame,", error)
      call put(file, "# one after another; momentum of rotors along them; does the frame " // &
               "differ from the axes", error)
      call put_variable(file, "groups", size(scene%bodies), error)
      call put_variable(file, "last_body", last, error)
      call put_variable(file, "moments", reshape(moments, [size(moments)]), error)
      call put_variable(file, "axes", reshape(axes, [size(axes)]), error)
      call put_variable(file, "rotors", reshape(rotors, [size(rotors)]), error)
      call put_variable(file, "turned", merge(1, 0, scene%bodies%turned), error)
   end subroutine put_groups

   !> What stays constant.
   subroutine put_integrals(scene, file, error)
      type(scene_settings), intent(in) :: scene
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      type(integral_list) :: list
      call scene_integrals(scene, list)
      call put(file, "# what stays constant, a strip of drift.png each; W of T + U - W.L; the " // &
               "axis of a symmetric top", error)
      call put_variable(file, "kept", list%words, error)
      call put_variable(file, "spin", list%spin, error)
      call put_variable(file, "symmetry", list%symmetry, error)
      call put(file, "# Kovalevskaya's integral: axes of equal moments, direction of the " // &
               "centre there, weight |centre|/I", error)
      call put_variable(file, "equal", list%equal, error)
      call put_variable(file, "first", list%first, error)
      call put_variable(file, "pull", list%pull, error)
   end subroutine put_integrals

end module poinsot_scene_pictures
