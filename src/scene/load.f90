!> Reads a whole text file into memory: a regular file, a pipe or a device.
module poinsot_scene_load
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_core_status, only: poinsot_e_io
   use poinsot_scene_text, only: reason_of, text_of
   use poinsot_scene_source, only: reject
   implicit none(type, external)
   private
   public :: load_text

   integer, parameter :: largest_file = 16*1024*1024

contains

   !> The whole file as text, at most 16 MB. Errors: POINSOT_E_IO if it cannot be read,
   !> POINSOT_E_SCENE if it is longer.
   subroutine load_text(file, text, error)
      character(*), intent(in) :: file !! its name
      character(:), allocatable, intent(out) :: text
      type(poinsot_error), intent(inout) :: error
      integer :: unit, code, length
      character(200) :: reason
      open (newunit=unit, file=file, access="stream", form="unformatted", action="read", &
            status="old", iostat=code, iomsg=reason)
      if (code /= 0) then
         call raise(error, poinsot_e_io, file // ": cannot be opened: " // reason_of(reason))
         return
      end if
      inquire (unit=unit, size=length)
      if (length > largest_file) then
         call reject(error, file, 0, "has " // text_of(length) // " bytes; a scene may have " // &
                     "at most " // text_of(largest_file))
      else if (length > 0) then
         allocate (character(length) :: text, stat=code)
         if (code == 0) read (unit, iostat=code, iomsg=reason) text
         if (code /= 0) then
            call raise(error, poinsot_e_io, file // ": cannot be read: " // reason_of(reason))
         end if
      else
         call load_slowly(unit, text, error, file)
      end if
      close (unit)
   end subroutine load_text

   !> Files without a size (pipes, /proc, /dev): byte by byte to the end.
   subroutine load_slowly(unit, text, error, file)
      integer, intent(in) :: unit
      character(:), allocatable, intent(out) :: text
      type(poinsot_error), intent(inout) :: error
      character(*), intent(in) :: file
      character(:), allocatable :: more
      character :: byte
      integer :: code, count
      allocate (character(65536) :: text)
      count = 0
      do
         read (unit, iostat=code) byte
         if (code /= 0) exit
         if (count == largest_file) then
            call reject(error, file, 0, "has no end within " // text_of(largest_file) // " bytes")
            return
         end if
         if (count == len(text)) then
            more = text // repeat(" ", count)
            call move_alloc(more, text)
         end if
         count = count + 1
         text(count:count) = byte
      end do
      if (.not. is_iostat_end(code)) then
         call raise(error, poinsot_e_io, file // ": cannot be read")
         return
      end if
      more = text(:count)
      call move_alloc(more, text)
   end subroutine load_slowly

end module poinsot_scene_load
