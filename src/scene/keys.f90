!> The groups of a scene file that are not effects, with every key they know: one table for the
!> reader, for its messages and for the help. Effects bring their own keys
!> (poinsot_effect_registry).
module poinsot_scene_keys
   use poinsot_effect_settings, only: effect_info, effect_key, number_key, text_key
   use poinsot_scene_typed_group, only: logical_choices
   implicit none(type, external)
   private
   public :: scene_keys, bodies_keys, output_keys

contains

   !> Keys of &scene.
   subroutine scene_keys(info)
      type(effect_info), intent(out) :: info
      info%name = "scene"
      info%formula = "the run as a whole"
      info%keys = [ &
         number_key("t_end", 1, 1, "required", "time", &
            "the run goes from t = 0 (or from a restart) to here"), &
         number_key("h", 1, 1, "0", "time", &
            "step size; optional for free bodies and an exact method"), &
         text_key("method", "exact", "", &
            "method of free rotation: poinsot methods; auto = chosen at start"), &
         text_key("splitting", "srkn6", "", &
            "splitting scheme: poinsot splittings; auto = chosen at start"), &
         number_key("tol", 1, 1, "1e-8", "relative", &
            "tolerance at t_end, for 'auto' and poinsot choose"), &
         number_key("tolerance", 1, 1, "1e-12", "relative", &
            "of each step of splitting 'taylor', 1e-15 to 1e-2"), &
         number_key("seed", 1, 1, "1", "integer", "seed of all random numbers"), &
         number_key("threads", 1, 1, "0", "integer", &
         "number of threads; 0 = OpenMP's for 20 ms of work, else 1"), &
         text_key("from", "", "", "restart file to continue from"), &
         logical_key("reseed", ".false.", "with from: continue with this seed, as another branch")]
   end subroutine scene_keys

   !> Keys of &bodies.
   subroutine bodies_keys(info)
      type(effect_info), intent(out) :: info
      info%name = "bodies"
      info%formula = "one body class; one group for each class of the scene"
      info%keys = [ &
         number_key("count", 1, 1, "1", "integer", "number of bodies"), &
         number_key("moments", 3, 3, "", "mass length^2", &
            "principal moments of inertia, in any order"), &
         number_key("tensor", 9, 9, "", "mass length^2", &
            "or the inertia tensor, row by row (-sum m x y off the diagonal)"), &
         text_key("points", "", "", "or point masses: a file with lines of mass, x, y, z"), &
         text_key("shape", "", "", &
            "or a shape: box ellipsoid cylinder sphere rod plate, water ..."), &
         logical_key("physical", ".true.", "reject moments that no distribution of mass has"), &
         number_key("mass", 1, 1, "1", "mass", "of the shape"), &
         number_key("size", 1, 3, "", "length", &
            "of the shape: edges, semi-axes, radius and height, length"), &
         number_key("y", 3, 3, "", "action", "angular momentum in the body frame"), &
         number_key("omega", 3, 3, "", "1/time", "or the angular velocity in the body frame"), &
         number_key("y_space", 3, 3, "", "action", "or the angular momentum in space"), &
         number_key("q", 4, 4, "1,0,0,0", "", &
            "attitude, unit quaternion, scalar first, body to space"), &
         number_key("euler", 3, 3, "", "radians", &
            "or intrinsic Euler angles, q = q_1(a1) q_2(a2) q_3(a3)"), &
         text_key("convention", "zxz", "zxz xyx yzy zyz xzx yxy xyz yzx zxy xzy zyx yxz", &
            "axes of euler, in order; also for the columns euler1 2 3"), &
         number_key("axis_angle", 4, 4, "", "", &
            "or an axis of any length, and the angle about it"), &
         logical_key("degrees", ".false.", "angles of euler and axis_angle are in degrees"), &
         text_key("file", "", "", "or the states of all bodies: a CSV file with q0..q3, y1..y3"), &
         text_key("random", "none", "none uniform thermal", &
            "uniform: attitudes; thermal: momenta as well"), &
         number_key("temperature", 1, 1, "", "energy", "k T of the thermal momenta"), &
         number_key("position", 3, 3, "0,0,0", "length", "of the first body (pictures; dipoles)"), &
         number_key("spacing", 3, 3, "0,0,0", "length", "from one body to the next"), &
         number_key("lattice", 3, 3, "", "integer", &
            "numbers of bodies along the axes, spacing(1..3) apart; not with count"), &
         text_key("drawn", "natural", "natural box ellipsoid cylinder racket", &
            "solid shown in view.html; natural: shape, or one with these moments")]
   end subroutine bodies_keys

   !> Describe a key that takes .true. or .false.
   pure function logical_key(name, default, meaning) result(key)
      character(*), intent(in) :: name, default, meaning
      type(effect_key) :: key
      key = text_key(name, default, logical_choices, meaning)
   end function logical_key

   !> Keys of &output.
   subroutine output_keys(info)
      type(effect_info), intent(out) :: info
      info%name = "output"
      info%formula = "what the run writes; without this group only a summary"
      info%keys = [ &
         number_key("every", 1, 1, "", "time", "time between outputs, from 0 on"), &
         number_key("times", 1, -1, "", "time", "or the output times themselves, ascending"), &
         number_key("bodies", 1, -1, "", "integer", &
            "numbers of the bodies written, from 1; default all"), &
         number_key("sample", 1, 1, "0", "integer", &
            "or write this many bodies, evenly spread over all"), &
         text_key("format", "csv", "csv extxyz npy csv+extxyz csv+npy csv+extxyz+npy", &
            "trajectory.csv, .xyz (OVITO), .npy (NumPy), or several"), &
         text_key("columns", "", "", "additional columns: omega1 2 3, euler1 2 3, Qy1 2 3, tilt"), &
         logical_key("observables", ".false.", "averages over all bodies: observables.csv"), &
         text_key("restart", "restart.txt", "", &
            "name of the restart file in the output folder; '' = none"), &
         text_key("pictures", "auto", "", &
            "auto, none, or some of: body top tilt angle ensemble"), &
         number_key("axis", 3, 3, "", "direction", &
            "body axis that pictures follow; default 3, or a top's own"), &
         number_key("rate", 1, 1, "0", "radians per time", &
            "rotation rate about z of the frame that angle is seen from")]
   end subroutine output_keys

end module poinsot_scene_keys
