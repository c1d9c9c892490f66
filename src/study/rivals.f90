!> Other integrators on the same bodies, measured separately (bench/rivals.sh) and read from CSV:
!> for the same diagram, and for the ratio of times at equal error.
module poinsot_study_rivals
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io
   use poinsot_core_number, only: parse_real, number_ok
   use poinsot_scene_text, only: text_of
   implicit none(type, external)
   private
   public :: rival_point, read_rivals, rival_names, rival_time

   !> One run of a rival.
   type :: rival_point
      character(32) :: name = ""
      real(dp) :: setting = 0          !! step, steps or tolerance: its own
      real(dp) :: angle(2) = 0         !! median and worst over the states, radians
      real(dp) :: momentum(2) = 0      !! the same, relative
      real(dp) :: time = 0             !! ns per body and unit of simulated time
   end type rival_point

contains

   !> Read one or several files, commas between their names; each has a line of column names. Error:
   !> POINSOT_E_IO naming file and line.
   subroutine read_rivals(files, points, error)
      character(*), intent(in) :: files
      type(rival_point), allocatable, intent(out) :: points(:)
      type(poinsot_error), intent(inout) :: error
      integer :: from, comma
      allocate (points(0))
      from = 1
      do while (from <= len(files))
         comma = index(files(from:) // ",", ",")
         if (comma > 1 .and. .not. raised(error)) call read_one(files(from:from + comma - 2), &
            points, error)
         from = from + comma
      end do
   end subroutine read_rivals

   subroutine read_one(file, points, error)
      character(*), intent(in) :: file
      type(rival_point), allocatable, intent(inout) :: points(:)
      type(poinsot_error), intent(inout) :: error
      character(1000) :: line
      type(rival_point) :: one
      integer :: unit, code, number
      logical :: good
      open (newunit=unit, file=file, action="read", status="old", iostat=code)
      if (code /= 0) then
         call raise(error, poinsot_e_io, file // &
            ": cannot be read; bench/rivals.sh writes such files")
         return
      end if
      number = 0
      do
         read (unit, "(a)", iostat=code) line
         if (code /= 0) exit
         number = number + 1
         if (number == 1 .or. len_trim(line) == 0) cycle
         call take_line(trim(line), one, good)
         if (.not. good) then
            call raise(error, poinsot_e_io, file // ":" // text_of(number) // &
               ": is not a name and six numbers")
            exit
         end if
         points = [points, one]
      end do
      close (unit)
   end subroutine read_one

   !> "name,setting,angle,angle,momentum,momentum,time"
   subroutine take_line(line, one, good)
      character(*), intent(in) :: line
      type(rival_point), intent(out) :: one
      logical, intent(out) :: good
      real(dp) :: numbers(6)
      integer :: from, comma, k, outcome
      comma = index(line, ",")
      good = comma > 1
      if (.not. good) return
      one%name = line(:comma - 1)
      from = comma + 1
      do k = 1, 6
         comma = index(line(min(from, len(line) + 1):) // ",", ",")
         call parse_real(trim(adjustl(line(min(from, len(line) + 1):min(from + comma - 2, &
            len(line))))), &
                         numbers(k), outcome)
         good = good .and. outcome == number_ok
         from = from + comma
      end do
      one%setting = numbers(1)
      one%angle = numbers(2:3)
      one%momentum = numbers(4:5)
      one%time = numbers(6)
   end subroutine take_line

   !> Their names, each once, in the order of the files.
   subroutine rival_names(points, names)
      type(rival_point), intent(in) :: points(:)
      character(32), allocatable, intent(out) :: names(:)
      integer :: i
      allocate (names(0))
      do i = 1, size(points)
         if (.not. any(names == points(i)%name)) names = [character(32) :: names, points(i)%name]
      end do
   end subroutine rival_names

   !> The least time with which a rival's median error is within a tolerance; 0 if it never is.
   pure real(dp) function rival_time(points, name, tol) result(time)
      type(rival_point), intent(in) :: points(:)
      character(*), intent(in) :: name
      real(dp), intent(in) :: tol
      integer :: i
      time = 0
      do i = 1, size(points)
         if (points(i)%name /= name .or. max(points(i)%angle(1), points(i)%momentum(1)) > tol) cycle
         if (time <= 0 .or. points(i)%time < time) time = points(i)%time
      end do
   end function rival_time

end module poinsot_study_rivals
