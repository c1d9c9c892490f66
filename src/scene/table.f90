!> Tables of numbers from a text file: each line has a time and some values; # or ! starts a
!> comment. A byte order mark, a header line and a final Ctrl-Z, as written by other programs, are
!> allowed.
module poinsot_scene_table
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io
   use poinsot_scene_text, only: reason_of, text_of, quoted
   use poinsot_core_number, only: parse_real, number_ok, number_no
   use poinsot_scene_source, only: reject
   implicit none(type, external)
   private
   public :: read_table, file_beside

   integer, parameter :: longest_line = 1000, most_rows = 1000000
   character(*), parameter :: blanks = " ,;" // achar(9) // achar(13)
   character(*), parameter :: order_mark = char(239) // char(187) // char(191) !! of UTF-8
   character, parameter :: end_of_text = achar(26)                           !! Ctrl-Z

contains

   !> A file that a scene names: relative names count from the folder of the scene.
   pure function file_beside(scene_file, name) result(path)
      character(*), intent(in) :: scene_file !! name of the scene's file
      character(*), intent(in) :: name       !! not empty
      character(:), allocatable :: path
      path = name
      if (name(1:1) /= "/") path = scene_file(:index(scene_file, "/", back=.true.)) // name
   end function file_beside

   !> Read rows of a time and `columns` values. Error: POINSOT_E_IO if the file cannot be read,
   !> POINSOT_E_SCENE naming file and line of what is no such row.
   subroutine read_table(file, columns, times, values, error, row_is)
      character(*), intent(in) :: file                    !! its name
      integer, intent(in) :: columns                      !! values beside the time
      real(dp), allocatable, intent(out) :: times(:)      !! (rows)
      real(dp), allocatable, intent(out) :: values(:)     !! (columns*rows), row after row
      type(poinsot_error), intent(inout) :: error
      character(*), intent(in), optional :: row_is        !! what a row holds, if no time and values
      real(dp), allocatable :: room(:, :), more(:, :)
      character(:), allocatable :: holds
      real(dp) :: row(columns + 1)
      character(longest_line) :: text
      character(200) :: reason
      integer :: unit, code, line, n
      logical :: empty, ended, headed
      open (newunit=unit, file=file, action="read", status="old", iostat=code, iomsg=reason)
      if (code /= 0) then
         call raise(error, poinsot_e_io, file // ": cannot be opened: " // reason_of(reason))
         return
      end if
      holds = "a time and " // text_of(columns) // " values"
      if (present(row_is)) holds = row_is
      allocate (room(columns + 1, 64))
      n = 0
      line = 0
      headed = .false.
      do
         read (unit, "(a)", iostat=code) text
         if (code /= 0) exit
         line = line + 1
         if (line == 1 .and. text(:3) == order_mark) text = text(4:)
         ended = index(text, end_of_text) > 0
         if (ended) text = text(:index(text, end_of_text) - 1)
         if (n == 0 .and. .not. headed .and. is_heading(text)) then
            headed = .true.
            text = ""
         end if
         call read_row(file, line, text, holds, row, empty, error)
         if (n == most_rows) call reject(error, file, line, "more than " // text_of(n) // " rows")
         if (raised(error)) exit
         if (ended .and. empty) exit
         if (empty) cycle
         if (n == size(room, 2)) then
            allocate (more(columns + 1, 2*n))
            more(:, :n) = room
            call move_alloc(more, room)
         end if
         n = n + 1
         room(:, n) = row
         if (ended) exit
      end do
      close (unit)
      times = room(1, :n)
      values = reshape(room(2:, :n), [columns*n])
      if (n == 0 .and. .not. raised(error)) call reject(error, file, 0, "holds no rows of numbers")
   end subroutine read_table

   !> Is a line a header: words, and no number among them?
   pure logical function is_heading(text)
      character(*), intent(in) :: text
      character(:), allocatable :: rest
      real(dp) :: number
      integer :: length, outcome
      rest = trim(text)
      if (scan(rest, "#!") > 0) rest = rest(:scan(rest, "#!") - 1)
      is_heading = verify(rest, blanks) > 0
      do while (is_heading .and. verify(rest, blanks) > 0)
         rest = rest(verify(rest, blanks):)
         length = scan(rest, blanks) - 1
         if (length < 0) length = len(rest)
         call parse_real(rest(:length), number, outcome)
         is_heading = outcome == number_no
         rest = rest(length + 1:)
      end do
   end function is_heading

   subroutine read_row(file, line, text, holds, row, empty, error)
      character(*), intent(in) :: file, text, holds
      integer, intent(in) :: line
      real(dp), intent(out) :: row(:)
      logical, intent(out) :: empty
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: rest
      integer :: k, length, outcome
      rest = trim(text)
      if (scan(rest, "#!") > 0) rest = rest(:scan(rest, "#!") - 1)
      row = 0
      empty = verify(rest, blanks) == 0
      if (empty) return
      do k = 1, size(row)
         if (verify(rest, blanks) == 0) exit
         rest = rest(verify(rest, blanks):)
         length = scan(rest, blanks) - 1
         if (length < 0) length = len(rest)
         call parse_real(rest(:length), row(k), outcome)
         if (outcome /= number_ok) then
            call reject(error, file, line, quoted(rest(:length)) // " is not a finite number")
            return
         end if
         rest = rest(length + 1:)
      end do
      if (k <= size(row) .or. verify(rest, blanks) > 0) then
         call reject(error, file, line, "a row has " // text_of(size(row)) // &
                     " numbers: " // holds)
      end if
   end subroutine read_row

end module poinsot_scene_table
