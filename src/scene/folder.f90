!> The output folder of a run: locked while the run lasts, and cleared of the files of an earlier
!> run only. The summary lists the files of its run; any other file is the user's.
module poinsot_scene_folder
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_int, c_null_char, c_null_ptr, &
      c_ptr
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io, poinsot_e_scene
   use poinsot_scene_files, only: file_exists, make_folder, real_path, remove_file
   use poinsot_scene_pictures, only: picture_files, scene_files
   use poinsot_scene_settings, only: scene_settings
   use poinsot_scene_view, only: has_page, page_name
   implicit none(type, external)
   private
   public :: folder_lock, lock_folder, unlock_folder, clear_folder, check_inputs, file_name, &
      run_files
   public :: files_row, file_separator, old_files, is_one_of, study_list, study_head, listed_files

   character(*), parameter :: files_row = "files"        !! of the summary: the marker
   character(*), parameter :: file_separator = " / "     !! no file name holds it
   integer, parameter :: label_width = 22                !! of a row of the summary
   character(*), parameter :: study_list = "written.txt" !! the list of the studies, and its head
   character(*), parameter :: study_head = &
      "Files that a study of poinsot wrote here: the next one replaces these, and no others."

   !> A lock on a folder. It ends with its process, whatever ends that, and is not passed on to
   !> programs that it starts.
   type :: folder_lock
      type(c_ptr) :: handle = c_null_ptr !! C's DIR; null: not locked
   end type folder_lock

   type :: file_name
      character(:), allocatable :: text
   end type file_name

   interface
      type(c_ptr) function c_opendir(path) bind(c, name="opendir")
         import :: c_ptr, c_char
         implicit none(type, external)
         character(kind=c_char), intent(in) :: path(*)
      end function c_opendir

      integer(c_int) function c_dirfd(folder) bind(c, name="dirfd")
         import :: c_int, c_ptr
         implicit none(type, external)
         type(c_ptr), value, intent(in) :: folder
      end function c_dirfd

      integer(c_int) function c_closedir(folder) bind(c, name="closedir")
         import :: c_int, c_ptr
         implicit none(type, external)
         type(c_ptr), value, intent(in) :: folder
      end function c_closedir

      integer(c_int) function c_flock(descriptor, operation) bind(c, name="flock")
         import :: c_int
         implicit none(type, external)
         integer(c_int), value, intent(in) :: descriptor, operation
      end function c_flock
   end interface

contains

   !> Make the folder if it is not there, and lock it. Error: POINSOT_E_IO if another run has it. A
   !> file system without locks is no error.
   subroutine lock_folder(out, lock, error)
      character(*), intent(in) :: out          !! the folder
      type(folder_lock), intent(inout) :: lock !! held from here on
      type(poinsot_error), intent(inout) :: error
      integer(c_int), parameter :: exclusive = 2, at_once = 4, unlock = 8 ! the same on all systems
      call make_folder(out, error)
      if (raised(error)) return
      lock%handle = c_opendir(out // c_null_char)
      if (.not. c_associated(lock%handle)) return
      associate (descriptor => c_dirfd(lock%handle))
         if (c_flock(descriptor, exclusive + at_once) == 0) return
         ! where nothing can be locked, nothing can be unlocked either
         if (c_flock(descriptor, unlock) == 0) call raise(error, poinsot_e_io, out // &
            ": another run is writing into this folder; wait for it, or choose another --out")
      end associate
      call unlock_folder(lock)
   end subroutine lock_folder

   !> Let go of a folder; harmless if it is not locked.
   subroutine unlock_folder(lock)
      type(folder_lock), intent(inout) :: lock
      integer(c_int) :: code
      if (c_associated(lock%handle)) code = c_closedir(lock%handle)
      lock%handle = c_null_ptr
   end subroutine unlock_folder

   !> A run must not replace what it reads. Error: POINSOT_E_SCENE for a restart file that lies in
   !> the
   !> output folder, under whatever name, and for an input that has the name of an output.
   subroutine check_inputs(scene, out, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: out           !! the output folder; may not be there yet
      type(poinsot_error), intent(inout) :: error
      type(file_name), allocatable :: names(:), inputs(:)
      character(:), allocatable :: folder, place
      integer :: i, k
      folder = real_path(out)
      if (len(folder) == 0) return
      if (folder /= "/") folder = folder // "/"
      place = real_path(scene%from)
      if (len(scene%from) > 0 .and. index(place, folder) == 1 .and. &
          index(place(min(len(place), len(folder)) + 1:), "/") == 0) then
         call raise(error, poinsot_e_scene, scene%from // ": lies in the output folder, and " // &
                    "the run would overwrite what it continues; choose another --out")
         return
      end if
      call run_files(scene, names)
      call input_files(scene, inputs)
      do i = 1, size(inputs)
         place = real_path(inputs(i)%text)
         do k = 1, size(names)
            if (place /= folder // names(k)%text) cycle
            call raise(error, poinsot_e_scene, inputs(i)%text // &
                       ": is read by this run, which would replace it; choose another --out")
            return
         end do
      end do
   end subroutine check_inputs

   !> Remove what an earlier run wrote, as its summary says: it would pass for this one's. Error:
   !> POINSOT_E_IO for a file that would be replaced and is of no earlier run.
   subroutine clear_folder(scene, out, error)
      type(scene_settings), intent(in) :: scene !! the typed scene
      character(*), intent(in) :: out           !! the output folder
      type(poinsot_error), intent(inout) :: error
      type(file_name), allocatable :: names(:), old(:), of_study(:)
      integer :: i
      call old_files(out // "/summary.txt", old)
      call listed_files(out // "/" // study_list, of_study)
      call run_files(scene, names)
      do i = 1, size(names)
         if (is_one_of(names(i)%text, old) .or. is_one_of(names(i)%text, of_study)) cycle
         if (.not. file_exists(out // "/" // names(i)%text)) cycle
         call raise(error, poinsot_e_io, out // "/" // names(i)%text // ": this run would " // &
                    "replace it, and no earlier run wrote it; move it away, or choose " // &
                    "another --out")
         return
      end do
      ! the list is the last to go
      do i = size(old), 1, -1
         if (.not. is_input(scene, out // "/" // old(i)%text)) then
            call remove_file(out // "/" // old(i)%text)
         end if
      end do
   end subroutine clear_folder

   !> Names of all files that a run of this scene writes, the summary first.
   subroutine run_files(scene, names)
      type(scene_settings), intent(in) :: scene !! the typed scene
      type(file_name), allocatable, intent(out) :: names(:)
      character(40), allocatable :: pictures(:)
      integer :: i
      call append(names, "summary.txt")
      if (.not. scene%output%present) return
      if (scene%output%csv) call append(names, "trajectory.csv")
      if (scene%output%extxyz) call append(names, "trajectory.xyz")
      if (scene%output%npy) call append(names, "trajectory.npy")
      if (scene%output%observables) call append(names, "observables.csv")
      if (len(scene%output%restart) > 0) call append(names, scene%output%restart)
      if (has_page(scene)) call append(names, page_name)
      call scene_files(scene, pictures)
      do i = 1, size(pictures)
         call append(names, trim(pictures(i)))
      end do
   end subroutine run_files

   !> The files that a scene reads.
   subroutine input_files(scene, names)
      type(scene_settings), intent(in) :: scene
      type(file_name), allocatable, intent(out) :: names(:)
      integer :: i
      call append(names, scene%file)
      if (len(scene%from) > 0) call append(names, scene%from)
      do i = 1, size(scene%bodies)
         if (allocated(scene%bodies(i)%points)) call append(names, scene%bodies(i)%points)
         if (allocated(scene%bodies(i)%file)) call append(names, scene%bodies(i)%file)
      end do
      do i = 1, size(scene%effects)
         if (.not. allocated(scene%effects(i)%file)) cycle
         call append(names, scene%effects(i)%file)
      end do
   end subroutine input_files

   !> One more name. (gfortran 12 loses the text of structures in an array constructor.)
   subroutine append(names, text)
      type(file_name), allocatable, intent(inout) :: names(:)
      character(*), intent(in) :: text
      type(file_name), allocatable :: longer(:)
      integer :: i, n
      n = 0
      if (allocated(names)) n = size(names)
      allocate (longer(n + 1))
      do i = 1, n
         call move_alloc(names(i)%text, longer(i)%text)
      end do
      longer(n + 1)%text = text
      call move_alloc(longer, names)
   end subroutine append

   logical function is_input(scene, path)
      type(scene_settings), intent(in) :: scene
      character(*), intent(in) :: path
      type(file_name), allocatable :: inputs(:)
      character(:), allocatable :: place
      integer :: i
      is_input = .false.
      place = real_path(path)
      if (len(place) == 0) return
      call input_files(scene, inputs)
      do i = 1, size(inputs)
         if (real_path(inputs(i)%text) == place) is_input = .true.
      end do
   end function is_input

   !> Is it the name of a file in the list?
   pure logical function is_one_of(name, names)
      character(*), intent(in) :: name
      type(file_name), intent(in) :: names(:)
      integer :: i
      is_one_of = .false.
      do i = 1, size(names)
         if (names(i)%text == name) is_one_of = .true.
      end do
   end function is_one_of

   !> The files that a summary lists, itself first; none if it is no summary of a run. A summary of
   !> version 0.1 has no list: its run had cleared the folder of every name that it might use.
   subroutine old_files(path, names)
      character(*), intent(in) :: path
      type(file_name), allocatable, intent(out) :: names(:)
      character(4000) :: line
      integer :: unit, code, k
      logical :: ours
      allocate (names(0))
      open (newunit=unit, file=path, action="read", status="old", iostat=code)
      if (code /= 0) return
      ours = .false.
      do k = 1, 100
         read (unit, "(a)", iostat=code) line
         if (code /= 0) exit
         if (k == 1 .and. line(:6) /= "state ") exit
         ours = ours .or. line(:8) == "poinsot "
         if (line(:label_width) /= files_row) cycle
         call split(trim(line(label_width + 1:)), names)
         exit
      end do
      close (unit)
      if (ours .and. size(names) == 0) call version_1_files(names)
   end subroutine old_files

   !> The files that a list of the studies names; none if it is no such list.
   subroutine listed_files(path, names)
      character(*), intent(in) :: path
      type(file_name), allocatable, intent(out) :: names(:)
      character(200) :: line
      integer :: unit, code
      allocate (names(0))
      open (newunit=unit, file=path, action="read", status="old", iostat=code)
      if (code /= 0) return
      read (unit, "(a)", iostat=code) line
      if (code == 0 .and. line == study_head) then
         call append(names, study_list)
         do
            read (unit, "(a)", iostat=code) line
            if (code /= 0) exit
            call append(names, trim(line))
         end do
      end if
      close (unit)
   end subroutine listed_files

   !> Names from a row of the summary.
   subroutine split(row, names)
      character(*), intent(in) :: row
      type(file_name), allocatable, intent(inout) :: names(:)
      integer :: first, next
      first = 1
      do while (first <= len(row))
         next = index(row(first:) // file_separator, file_separator)
         associate (name => row(first:first + next - 2))
            if (len(name) > 0 .and. index(name, "/") == 0) call append(names, name)
         end associate
         first = first + next - 1 + len(file_separator)
      end do
   end subroutine split

   subroutine version_1_files(names)
      type(file_name), allocatable, intent(out) :: names(:)
      character(40), allocatable :: pictures(:)
      integer :: i
      call append(names, "summary.txt")
      call append(names, "trajectory.csv")
      call append(names, "trajectory.xyz")
      call append(names, "restart.txt")
      call picture_files(pictures)
      do i = 1, size(pictures)
         call append(names, trim(pictures(i)))
      end do
   end subroutine version_1_files

end module poinsot_scene_folder
