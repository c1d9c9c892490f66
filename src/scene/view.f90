!> view.html: the motion of a run, to watch in any browser. The page is a template
!> (share/poinsot/view.html); its data are collected here during the run and inserted.
module poinsot_scene_view
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io
   use poinsot_core_version, only: version_text
   use poinsot_body_invariants, only: space_momentum
   use poinsot_effect_effect, only: torque_effect, pair_effect
   use poinsot_scene_collect, only: collect, row_size
   use poinsot_scene_communicator, only: communicator
   use poinsot_scene_drift, only: drift_watch
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_integrals, only: integral_list, scene_integrals
   use poinsot_scene_json, only: quoted_json, numbers_json, number_json
   use poinsot_scene_settings, only: scene_settings, body_total
   use poinsot_scene_states, only: body_states
   use poinsot_scene_view_setting, only: view_setting, body_vectors
   implicit none(type, external)
   private
   public :: view_writer, open_view, add_view_frame, write_view, remake_view, has_page, page_name

   character(*), parameter :: page_name = "view.html"
   character(*), parameter :: data_mark = "@DATA@"              !! in the template
   character(*), parameter :: data_begin = "<script type=""application/json"" id=""data"">"
   character(*), parameter :: data_end = "</script>"
   integer, parameter :: most_states = 2000  !! that the frames of all bodies share
   integer, parameter :: most_bodies = 40    !! shown, evenly out of all

   !> One frame of the bodies that are shown.
   type :: view_frame
      real(dp) :: t = 0
      real(dp) :: change(3) = 0              !! of energy (or what stands for it), |y|, L_z so far
      real(dp), allocatable :: y(:, :), q(:, :) !! principal axes
      real(dp), allocatable :: kinetic(:), potential(:)
   end type view_frame

   !> What has been gathered: every `stride`-th output, and the last.
   type :: view_writer
      integer, allocatable :: bodies(:)      !! numbers of those shown; not allocated: no page
      integer :: most = 0                    !! frames at the end; up to twice as many on the way
      integer :: n = 0, stride = 1, seen = 0
      type(view_frame), allocatable :: frames(:)
      type(view_frame) :: last
      type(integral_list) :: kept
      real(dp) :: start = 0, size = 0, turning_change = 0 !! of T + U - W.L
   end type view_writer

contains

   !> Choose the bodies. Nothing is gathered for a scene without &output or without a page.
   subroutine open_view(scene, view)
      type(scene_settings), intent(in) :: scene !! the typed scene
      type(view_writer), intent(out) :: view
      integer :: n, i, shown
      if (.not. has_page(scene)) return
      n = size(scene%output%bodies)
      if (n == 0) n = int(body_total(scene))
      shown = min(n, most_bodies)
      view%bodies = [(1 + int(real(i - 1, dp)*n/shown), i=1, shown)]
      if (size(scene%output%bodies) > 0) view%bodies = int(scene%output%bodies(view%bodies))
      view%most = max(2, most_states/shown)
      allocate (view%frames(2*view%most))
      call scene_integrals(scene, view%kept)
   end subroutine open_view

   !> Does a run of this scene write a page?
   pure logical function has_page(scene)
      type(scene_settings), intent(in) :: scene !! the typed scene
      has_page = scene%output%present .and. allocated(scene%output%page)
      if (has_page) has_page = len(scene%output%page) > 0
   end function has_page

   !> One output more. When there are twice as many as will be written, every other one goes.
   !> All ranks call; the frames of rank 0 are the page's.
   subroutine add_view_frame(view, t, states, kinetic, potential, drift, ranks)
      type(view_writer), intent(inout) :: view
      real(dp), intent(in) :: t                           !! time
      type(body_states), intent(in) :: states             !! of this rank, principal axes
      real(dp), intent(in) :: kinetic(:), potential(:)    !! of this rank
      type(drift_watch), intent(in) :: drift              !! changes up to here
      class(communicator), intent(inout) :: ranks
      real(dp), allocatable :: rows(:, :)
      integer :: k
      if (.not. allocated(view%bodies)) return
      if (has(view, "rotating")) call follow_turning(view, states, kinetic, potential, ranks)
      allocate (rows(row_size, size(view%bodies)), source=0.0_dp)
      call collect(ranks, states, kinetic, potential, int(view%bodies, i8), rows)
      view%last%t = t
      view%last%change = [merge(view%turning_change, drift%energy_change, &
         has(view, "rotating")), drift%casimir_change, drift%vertical_change]
      view%last%y = rows(1:3, :)
      view%last%q = rows(4:7, :)
      view%last%kinetic = rows(8, :) ! gfortran 12 takes the wrong numbers of such a section
      view%last%potential = rows(9, :) ! in a structure constructor
      view%seen = view%seen + 1
      if (mod(view%seen - 1, view%stride) /= 0) return
      if (view%n == size(view%frames)) then
         do k = 1, view%n/2
            view%frames(k) = view%frames(2*k - 1)
         end do
         view%n = view%n/2
         view%stride = 2*view%stride
         if (mod(view%seen - 1, view%stride) /= 0) return
      end if
      view%n = view%n + 1
      view%frames(view%n) = view%last
   end subroutine add_view_frame

   !> Is this integral among those that the scene keeps?
   pure logical function has(view, word)
      type(view_writer), intent(in) :: view
      character(*), intent(in) :: word
      has = index(" " // view%kept%words // " ", " " // word // " ") > 0
   end function has

   !> T + U - W.L of all bodies, against its start.
   subroutine follow_turning(view, states, kinetic, potential, ranks)
      type(view_writer), intent(inout) :: view
      type(body_states), intent(in) :: states
      real(dp), intent(in) :: kinetic(:), potential(:)
      class(communicator), intent(inout) :: ranks
      real(dp) :: now, part, sums(3)
      integer :: i
      call ranks%sums_before(sums)
      do i = 1, states%n
         part = kinetic(i) + potential(i) - dot_product(view%kept%spin, &
            space_momentum(states%y(:, i), states%q(:, i)))
         sums = sums + [part, abs(kinetic(i)), abs(potential(i))]
      end do
      call ranks%sums_after(sums)
      now = sums(1)
      if (view%seen == 0) view%start = now
      view%size = max(view%size, sums(2) + sums(3))
      if (view%size > 0) view%turning_change = max(view%turning_change, &
                                                   abs(now - view%start)/view%size)
   end subroutine follow_turning

   !> Write the page: the template with this run's data. Errors: POINSOT_E_IO, also for a template
   !> that is not there.
   subroutine write_view(view, scene, out, error)
      type(view_writer), intent(in) :: view
      type(scene_settings), intent(in) :: scene !! the typed scene; its output%page is the template
      character(*), intent(in) :: out           !! folder
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      if (.not. allocated(view%bodies) .or. view%n == 0) return
      call start_page(scene%output%page, out // "/" // page_name, file, error)
      if (raised(error)) return
      call put_data(view, scene, file, error)
      call end_page(scene%output%page, file, error)
   end subroutine write_view

   !> The page of a folder made anew: the data that stand in it, in this template. Error:
   !> POINSOT_E_IO if there is no page, or none of ours.
   subroutine remake_view(template, out, error)
      character(*), intent(in) :: template !! file
      character(*), intent(in) :: out      !! folder with a page
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      character(:), allocatable :: page
      integer :: from, to
      call read_whole(out // "/" // page_name, page, error)
      if (raised(error)) return
      from = index(page, data_begin) + len(data_begin)
      to = from - 2
      if (from > len(data_begin)) to = from + index(page(from:), data_end) - 2
      if (to < from) then
         call raise(error, poinsot_e_io, out // "/" // page_name // &
                    ": holds no data of a run; run its scene again")
         return
      end if
      call start_page(template, out // "/" // page_name, file, error)
      if (raised(error)) return
      call put(file, without_ends(page(from:to)), error)
      call end_page(template, file, error)
   end subroutine remake_view

   !> A page is the template with data inserted: first the part before, at the end the part after.
   subroutine start_page(template, path, file, error)
      character(*), intent(in) :: template, path
      type(out_file), intent(out) :: file
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: page
      call read_whole(template, page, error)
      if (raised(error)) return
      call open_out(path, file, error)
      if (.not. raised(error)) call put(file, page(:index(page, data_mark) - 1), error)
   end subroutine start_page

   subroutine end_page(template, file, error)
      character(*), intent(in) :: template
      type(out_file), intent(inout) :: file
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: page
      call read_whole(template, page, error)
      call put(file, without_ends(page(index(page, data_mark) + len(data_mark):)), error)
      call finish_out(file, error)
   end subroutine end_page

   !> Without the ends of line before and behind, which `put` adds.
   pure function without_ends(text) result(bare)
      character(*), intent(in) :: text
      character(:), allocatable :: bare
      character, parameter :: newline = achar(10)
      bare = text(max(1, verify(text, newline)):verify(text, newline, back=.true.))
   end function without_ends

   !> The contents of a file. Error: POINSOT_E_IO.
   subroutine read_whole(path, text, error)
      character(*), intent(in) :: path
      character(:), allocatable, intent(out) :: text
      type(poinsot_error), intent(inout) :: error
      integer :: unit, length, code
      text = ""
      open (newunit=unit, file=path, access="stream", form="unformatted", action="read", &
            status="old", iostat=code)
      if (code == 0) then
         inquire (unit=unit, size=length)
         deallocate (text)
         allocate (character(length) :: text)
         if (length > 0) read (unit, iostat=code) text
         close (unit)
      end if
      if (code /= 0 .and. .not. raised(error)) then
         call raise(error, poinsot_e_io, path // ": not found, or cannot be read")
      end if
   end subroutine read_whole

   !> The data as JSON.
   subroutine put_data(view, scene, file, error)
      type(view_writer), intent(in) :: view
      type(scene_settings), intent(in) :: scene
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: about
      integer :: n, i, k
      n = view%n
      if (view%frames(n)%t < view%last%t) n = n + 1 ! the end is always shown
      about = how_it_goes(scene)
      if (scene%h > 0) about = about // ", h = " // number_json(scene%h, 5)
      about = about // ", poinsot " // version_text
      call put(file, "{""title"": " // quoted_json(scene%name) // ", ""about"": " // &
               quoted_json(about) // ",", error)
      call put(file, """words"": " // quoted_json(scene%head) // ",", error)
      call put(file, """axis"": " // numbers_json(scene%output%axis, 9) // ",", error)
      call put(file, view_setting(scene), error)
      call put_series(file, """t"": ", [(t_of(k), k=1, n)], 10, ",", error)
      call put_changes(view, n, file, error)
      call put(file, """bodies"": [", error)
      do i = 1, size(view%bodies)
         call put_body(view, scene, n, i, file, error)
      end do
      call put(file, "]}", error)

   contains

      pure real(dp) function t_of(k)
         integer, intent(in) :: k
         t_of = view%last%t
         if (k <= view%n) t_of = view%frames(k)%t
      end function t_of

   end subroutine put_data

   !> Method and splitting, as far as they do anything: without a torque only `baoab`, which says
   !> where the noise is, and `taylor`, which needs no method.
   pure function how_it_goes(scene) result(words)
      type(scene_settings), intent(in) :: scene
      character(:), allocatable :: words
      logical :: splits
      integer :: i
      words = scene%method
      if (size(scene%effects) == 0) return
      splits = scene%splitting == "baoab"
      do i = 1, size(scene%effects)
         if (.not. allocated(scene%effects(i)%made)) cycle
         select type (one => scene%effects(i)%made)
         class is (torque_effect)
            splits = .true.
         class is (pair_effect)
            splits = .true.
         end select
      end do
      if (splits) words = scene%method // " + " // scene%splitting
      if (scene%splitting == "taylor") words = scene%splitting
   end function how_it_goes

   !> Largest changes so far of what the scene keeps.
   subroutine put_changes(view, n, file, error)
      type(view_writer), intent(in) :: view
      integer, intent(in) :: n
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      character(*), parameter :: words(4) = [character(8) :: "energy", "rotating", "length", &
                                             "vertical"]
      character(*), parameter :: names(4) = [character(32) :: "\u0394H/H", &
         "\u0394(H\u2212W\u00b7L)/H", &
                                             "\u0394|y|/|y|", "\u0394L_z/L"]
      integer, parameter :: column(4) = [1, 1, 2, 3]
      character(:), allocatable :: comma
      integer :: i, k
      comma = ""
      call put(file, """changes"": [", error)
      do i = 1, size(words)
         if (.not. has(view, trim(words(i)))) cycle
         call put_series(file, comma // "{""name"": """ // trim(names(i)) // """, ""values"": ", &
                         [(change_of(k), k=1, n)], 2, "}", error)
         comma = ","
      end do
      call put(file, "],", error)

   contains

      pure real(dp) function change_of(k)
         integer, intent(in) :: k
         change_of = view%last%change(column(i))
         if (k <= view%n) change_of = view%frames(k)%change(column(i))
      end function change_of

   end subroutine put_changes

   !> One body: what it is, and its frames.
   subroutine put_body(view, scene, n, i, file, error)
      type(view_writer), intent(in) :: view
      type(scene_settings), intent(in) :: scene
      integer, intent(in) :: n, i
      type(out_file), intent(in) :: file
      type(poinsot_error), intent(inout) :: error
      real(dp) :: y(3, n), q(4, n), kinetic(n), potential(n)
      integer :: group, k
      group = 1
      do while (sum(scene%bodies(:group)%count) < view%bodies(i))
         group = group + 1
      end do
      do k = 1, n
         if (k <= view%n) then
            call take(view%frames(k))
         else
            call take(view%last)
         end if
      end do
      call put(file, "{""name"": """ // number_json(real(view%bodies(i), dp), 10) // &
               """, ""moments"": " // numbers_json(scene%bodies(group)%moments, 9) // &
               body_vectors(scene, group) // ",", error)
      call put_series(file, """q"": ", reshape(q, [4*n]), 8, ",", error)
      call put_series(file, """y"": ", reshape(y, [3*n]), 8, ",", error)
      call put_series(file, """kinetic"": ", kinetic, 6, ",", error)
      call put_series(file, """potential"": ", potential, 6, "", error)
      call put(file, trim(merge("},", "} ", i < size(view%bodies))), error)

   contains

      subroutine take(frame)
         type(view_frame), intent(in) :: frame
         y(:, k) = frame%y(:, i)
         q(:, k) = frame%q(:, i)
         kinetic(k) = frame%kinetic(i)
         potential(k) = frame%potential(i)
      end subroutine take

   end subroutine put_body

   !> name, [numbers], end: in lines of a readable length.
   subroutine put_series(file, name, values, digits, ending, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: name, ending
      real(dp), intent(in) :: values(:)
      integer, intent(in) :: digits
      type(poinsot_error), intent(inout) :: error
      integer, parameter :: in_a_line = 64
      character(:), allocatable :: line
      integer :: from, to
      line = name // "["
      do from = 1, size(values), in_a_line
         to = min(size(values), from + in_a_line - 1)
         line = line // numbers_json(values(from:to), digits, bare=.true.)
         if (to < size(values)) line = line // ","
         if (to == size(values)) line = line // "]" // ending
         call put(file, line, error)
         line = ""
      end do
   end subroutine put_series

end module poinsot_scene_view
