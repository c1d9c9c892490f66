!> C entries for the fuzzer (test/fuzz/driver.c): what reads scenes and restart files, and a short
!> run of what they ask for.
module fuzz_entry
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_int, c_size_t, c_f_pointer, c_ptr
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_status, only: poinsot_ok, poinsot_e_axis_momentum
   use poinsot_scene_build, only: build_scene
   use poinsot_scene_reader, only: scan_source
   use poinsot_scene_run, only: check_scene, run_scene
   use poinsot_scene_schedule, only: step_total, output_count
   use poinsot_scene_settings, only: scene_settings, body_total
   use poinsot_scene_source, only: scene_source
   use poinsot_scene_summary, only: run_report
   use poinsot_scene_watch, only: run_watch
   implicit none(type, external)
   private
   public :: fuzz_scene, fuzz_restart

   integer(i8), parameter :: most_bodies = 40
   real(dp), parameter :: most_work = 100, most_outputs = 5

   !> Stops a run that takes long.
   type, extends(run_watch) :: impatient
      integer :: looks = 0
   contains
      procedure :: stop_now => stop_soon
   end type impatient

contains

   !> Read a scene from memory, build it, and run it if it is small. Answers the status, or -1 if
   !> the library broke a promise: a status without a message, or one that is none.
   integer(c_int) function fuzz_scene(bytes, length, folder, folder_length, run) &
      bind(c) result(status)
      type(c_ptr), value :: bytes, folder
      integer(c_size_t), value :: length, folder_length
      integer(c_int), value :: run             !! /= 0: run small scenes
      type(scene_source) :: source
      type(scene_settings) :: scene
      type(poinsot_error) :: error
      call scan_source(text_of(bytes, length), "fuzz.nml", source, error)
      if (.not. raised(error)) call build_scene(source, scene, error)
      if (.not. raised(error) .and. run /= 0) call try_to_run(scene, text_of(folder, &
         folder_length), error)
      status = verdict(error)
   end function fuzz_scene

   !> Continue a scene from a restart file.
   integer(c_int) function fuzz_restart(bytes, length, file, file_length, folder, folder_length) &
      bind(c) result(status)
      type(c_ptr), value :: bytes, file, folder    !! the scene, the path of the restart file, the
                                                   !! folder for output
      integer(c_size_t), value :: length, file_length, folder_length
      type(scene_source) :: source
      type(scene_settings) :: scene
      type(poinsot_error) :: error
      call scan_source(text_of(bytes, length), "fuzz.nml", source, error)
      if (.not. raised(error)) call build_scene(source, scene, error)
      if (.not. raised(error)) scene%from = text_of(file, file_length)
      if (.not. raised(error)) call try_to_run(scene, text_of(folder, folder_length), error)
      status = verdict(error)
   end function fuzz_restart

   !> A run of a few steps: the whole of a small scene, the beginning of a longer one.
   subroutine try_to_run(scene, folder, error)
      type(scene_settings), intent(inout) :: scene
      character(*), intent(in) :: folder
      type(poinsot_error), intent(inout) :: error
      type(impatient) :: watch
      type(run_report) :: report
      scene%threads = 1
      if (body_total(scene) > most_bodies) then
         if (body_total(scene) <= 1000) call check_scene(scene, error)
         return
      end if
      if (output_count(scene) > most_outputs .or. step_total(scene) > most_work) then
         scene%output%present = .false.
         scene%t_end = min(scene%t_end, 20*scene%h)
         if (scene%t_end <= 0) return
      end if
      call run_scene(scene, folder, watch, report, error)
      if (.not. raised(error) .and. scene%output%present) then
         if (.not. finite_numbers(folder // "/trajectory.csv")) error%code = -1
      end if
   end subroutine try_to_run

   !> A run that ended well leaves numbers.
   logical function finite_numbers(file)
      character(*), intent(in) :: file
      character(:), allocatable :: text
      integer :: unit, size, status
      finite_numbers = .true.
      open (newunit=unit, file=file, access="stream", status="old", action="read", iostat=status)
      if (status /= 0) return
      inquire (unit, size=size)
      allocate (character(size) :: text)
      read (unit, iostat=status) text
      close (unit)
      if (status == 0) finite_numbers = index(text, "NaN") == 0 .and. index(text, "Inf") == 0
   end function finite_numbers

   logical function stop_soon(self)
      class(impatient), intent(inout) :: self
      self%looks = self%looks + 1
      stop_soon = self%looks > 100
   end function stop_soon

   integer function verdict(error)
      type(poinsot_error), intent(in) :: error
      verdict = error%code
      if (verdict < poinsot_ok .or. verdict > poinsot_e_axis_momentum) verdict = -1
      if (verdict == poinsot_ok) return
      if (.not. allocated(error%message)) then
         verdict = -1
      else if (len_trim(error%message) < 5) then
         verdict = -1
      end if
   end function verdict

   function text_of(bytes, length) result(text)
      type(c_ptr), intent(in) :: bytes
      integer(c_size_t), intent(in) :: length
      character(:), allocatable :: text
      character(kind=c_char), pointer :: c(:)
      integer(c_size_t) :: i
      call c_f_pointer(bytes, c, [length])
      allocate (character(length) :: text)
      do i = 1, length
         text(i:i) = c(i)
      end do
   end function text_of

end module fuzz_entry
