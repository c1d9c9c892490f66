!> E. Celledoni, F. Fasso, N. Safstrom, A. Zanna, The exact computation of the free rigid body
!> motion and its use in splitting methods, SIAM J. Sci. Comput. 30 (2008) 2084: when does the exact
!> rotor pay inside a splitting? A top with gravity from weak to strong compared to its spin; for
!> each rotor the time to reach one accuracy, with the best splitting and step size for it.
module poinsot_study_repeat_celledoni
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_reader, only: scan_source
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_source, only: scene_source
   use poinsot_scene_text, only: text_of
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_candidates, only: any_name
   use poinsot_study_choice, only: choose_request, choice, tolerance_kept
   use poinsot_study_choose, only: choose_method
   implicit none(type, external)
   private
   public :: repeat_celledoni

   character(20), parameter :: rotors(7) = [character(20) :: "exact", "dmv2", "dmv4", "dmv6", &
      "dmv8", "three-rotations", "symmetric-rotation"]
   real(dp), parameter :: weights(7) = [1e-4_dp, 1e-3_dp, 1e-2_dp, 3e-2_dp, 0.1_dp, 0.3_dp, 1.0_dp]
   real(dp), parameter :: tol = 1e-6_dp

contains

   !> Measure, write celledoni.csv and celledoni.txt into a folder that is there; it takes at most
   !> about `budget` seconds. Error: POINSOT_E_IO.
   subroutine repeat_celledoni(out, budget, watch, error, fewer)
      character(*), intent(in) :: out
      real(dp), intent(in) :: budget
      class(run_watch), intent(inout) :: watch
      type(poinsot_error), intent(inout) :: error
      integer, intent(in), optional :: fewer   !! rotors and weights, instead of all
      type(choice) :: found(size(weights), size(rotors))
      type(choose_request) :: request
      type(poinsot_error) :: refused
      type(scene_settings) :: scene
      integer :: i, m, most
      most = size(weights)
      if (present(fewer)) most = min(fewer, most)
      request%tol = tol
      request%budget = budget/(size(rotors)*size(weights))
      request%splittings = any_name
      do m = 1, min(most, size(rotors))
         do i = 1, most
            call make_top(weights(i), scene, error)
            if (raised(error) .or. watch%stop_now()) exit
            request%methods = [character(24) :: rotors(m)]
            refused = poinsot_error()
            call choose_method(scene, request, watch, found(i, m), refused)
            if (raised(refused)) error = refused
            if (found(i, m)%ended /= tolerance_kept) found(i, m)%best%h = 0 ! no point
            call watch%report_progress(real(i + (m - 1)*most, dp), real(most**2, dp))
         end do
      end do
      if (.not. raised(error)) call write_table(out, found, error)
      if (.not. raised(error)) call write_words(out, found, error)
   end subroutine repeat_celledoni

   !> A top of kinetic energy about 0.75 that turns ten times, under a weight; an ensemble, so that
   !> times are those of full blocks.
   subroutine make_top(weight, scene, error)
      real(dp), intent(in) :: weight
      type(scene_settings), intent(out) :: scene
      type(poinsot_error), intent(inout) :: error
      type(scene_source) :: source
      character(*), parameter :: break = new_line("a")
      call scan_source("&scene t_end = 40, h = 0.1 /" // break // &
                       "&bodies moments = 0.5, 0.7, 1.0, count = 96, random = 'thermal', " // &
                       "temperature = 0.5 /" // break // &
                       "&gravity centre = 0, 0, 1, weight = " // text_of(weight) // " /" // break, &
                       "top", source, error)
      if (.not. raised(error)) call build_scene(source, scene, error)
   end subroutine make_top

   !> celledoni.csv.
   subroutine write_table(out, found, error)
      character(*), intent(in) :: out
      type(choice), intent(in) :: found(:, :)
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(160) :: line
      integer :: i, m
      call open_out(out // "/celledoni.csv", file, error)
      call put(file, "ratio,rotor,splitting,h,error,ns_per_step,ns_per_time,over_exact", error)
      do m = 1, size(rotors)
         do i = 1, size(weights)
            associate (b => found(i, m)%best)
               if (.not. b%h > 0) cycle
               write (line, "(es10.3, ',', a, ',', a, 5(',', es11.4e3))") energies(weights(i)), &
                  trim(b%setup%method), trim(b%setup%splitting), b%h, b%error, b%ns, b%ns/b%h, &
                  over_exact(found, i, m)
               call put(file, trim(line), error)
            end associate
         end do
      end do
      call finish_out(file, error)
   end subroutine write_table

   !> The mean kinetic energy, 3/2 kT, over half the range of the potential.
   elemental real(dp) function energies(weight)
      real(dp), intent(in) :: weight
      energies = 0.75_dp/weight
   end function energies

   !> Time with a rotor over time with the exact one; 0 if either did not come through.
   pure real(dp) function over_exact(found, i, m)
      type(choice), intent(in) :: found(:, :)
      integer, intent(in) :: i, m
      over_exact = 0
      associate (mine => found(i, m)%best, exact => found(i, 1)%best)
         if (mine%h > 0 .and. exact%h > 0) over_exact = (mine%ns/mine%h)/(exact%ns/exact%h)
      end associate
   end function over_exact

   !> What the exact rotor gains, weakest torque first.
   subroutine write_words(out, found, error)
      character(*), intent(in) :: out
      type(choice), intent(in) :: found(:, :)
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(120) :: line
      integer :: i, m
      call open_out(out // "/celledoni.txt", file, error)
      call put(file, "a top turned ten times at an error of 1e-6: time with a rotor over time " // &
               "with exact, each", error)
      call put(file, "with its own best splitting and step, for kinetic energy over energy of " // &
               "the torque", error)
      write (line, "(23x, 7f9.2)") energies(weights)
      call put(file, trim(line), error)
      do m = 1, size(rotors)
         line = "   " // rotors(m)
         do i = 1, size(weights)
            line(15 + 9*i:23 + 9*i) = "        -"
            if (over_exact(found, i, m) > 0) write (line(15 + 9*i:23 + 9*i), "(f9.2)") &
               over_exact(found, i, m)
         end do
         call put(file, trim(line), error)
      end do
      line = "   splitting with exact"
      do i = 1, size(weights)
         associate (best => found(i, 1)%best)
            if (best%h > 0) line = trim(line) // " " // trim(best%setup%splitting)
         end associate
      end do
      call put(file, trim(line), error)
      call finish_out(file, error)
   end subroutine write_words

end module poinsot_study_repeat_celledoni
