!> The states of many bodies from a table with named columns: q0..q3 and y1..y3, as in
!> trajectory.csv; a row for each body.
module poinsot_scene_states_file
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_number, only: parse_real, number_ok
   use poinsot_core_status, only: poinsot_e_io
   use poinsot_scene_source, only: reject
   use poinsot_scene_text, only: lower, quoted, reason_of, text_of
   implicit none(type, external)
   private
   public :: read_states

   integer, parameter :: longest_line = 4000, most_columns = 400
   character(*), parameter :: names(7) = [character(2) :: "q0", "q1", "q2", "q3", "y1", "y2", "y3"]
   character(*), parameter :: order_mark = char(239) // char(187) // char(191) !! of UTF-8

   !> How the columns of a file stand.
   type :: table_head
      logical :: commas = .false.            !! fields end at commas, else at blanks
      integer :: columns = 0
      integer :: slot(most_columns) = 0      !! which of `names` a column is; 0: none of them
   end type table_head

contains

   !> Read attitudes and momenta of all rows. Errors: POINSOT_E_IO if the file cannot be read,
   !> POINSOT_E_SCENE naming file and line of what is no such row.
   subroutine read_states(file, q, y, lines, error)
      character(*), intent(in) :: file                      !! its name
      real(dp), allocatable, intent(out) :: q(:, :), y(:, :) !! (4, rows), (3, rows)
      integer, allocatable, intent(out) :: lines(:)         !! (rows): where they stand
      type(poinsot_error), intent(inout) :: error
      type(table_head) :: head
      real(dp), allocatable :: room(:, :)
      character(longest_line) :: text
      character(200) :: reason
      integer :: unit, code, line, n
      open (newunit=unit, file=file, action="read", status="old", iostat=code, iomsg=reason)
      if (code /= 0) then
         call raise(error, poinsot_e_io, file // ": cannot be opened: " // reason_of(reason))
         return
      end if
      allocate (room(7, 64), lines(64))
      n = 0
      line = 0
      do while (.not. raised(error))
         read (unit, "(a)", iostat=code) text
         if (code /= 0) exit
         line = line + 1
         if (line == 1 .and. text(:3) == order_mark) text = text(4:)
         if (is_empty(text)) cycle
         if (head%columns == 0) then
            call read_head(file, line, trim(text), head, error)
            cycle
         end if
         if (n == size(lines)) call double(room, lines)
         n = n + 1
         lines(n) = line
         call read_row(file, line, trim(text), head, room(:, n), error)
      end do
      close (unit)
      if (raised(error)) return
      if (n == 0) call reject(error, file, 0, "holds no rows; a header with q0,q1,q2,q3,y1,y2,y3 " &
         // "and a row for each body are needed")
      q = room(:4, :n)
      y = room(5:, :n)
      lines = lines(:n)
   end subroutine read_states

   !> Nothing but a comment?
   pure logical function is_empty(text)
      character(*), intent(in) :: text
      integer :: first
      first = verify(text, " " // achar(9) // achar(13))
      is_empty = first == 0
      if (.not. is_empty) is_empty = text(first:first) == "#"
   end function is_empty

   subroutine double(room, lines)
      real(dp), allocatable, intent(inout) :: room(:, :)
      integer, allocatable, intent(inout) :: lines(:)
      real(dp), allocatable :: more(:, :)
      integer, allocatable :: more_lines(:)
      integer :: n
      n = size(lines)
      allocate (more(7, 2*n), more_lines(2*n))
      more(:, :n) = room
      more_lines(:n) = lines
      call move_alloc(more, room)
      call move_alloc(more_lines, lines)
   end subroutine double

   !> The names of the columns; all seven must be there.
   subroutine read_head(file, line, text, head, error)
      character(*), intent(in) :: file, text
      integer, intent(in) :: line
      type(table_head), intent(inout) :: head
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: field
      integer :: at, k
      head%commas = index(text, ",") > 0
      at = 1
      do
         call next_field(text, head%commas, at, field)
         if (at == 0) exit
         head%columns = head%columns + 1
         if (head%columns > most_columns) then
            call reject(error, file, line, "has more than " // text_of(most_columns) // " columns")
            return
         end if
         do k = 1, 7
            if (lower(field) == names(k)) head%slot(head%columns) = k
         end do
      end do
      do k = 1, 7
         if (count(head%slot == k) == 1) cycle
         call reject(error, file, line, "the header has " // text_of(count(head%slot == k)) // &
            " columns " // quoted(names(k)) // "; it takes one of each of q0,q1,q2,q3,y1,y2,y3")
         return
      end do
   end subroutine read_head

   subroutine read_row(file, line, text, head, values, error)
      character(*), intent(in) :: file, text
      integer, intent(in) :: line
      type(table_head), intent(in) :: head
      real(dp), intent(out) :: values(7)
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: field
      integer :: at, k, outcome
      values = 0
      at = 1
      k = 0
      do
         call next_field(text, head%commas, at, field)
         if (at == 0) exit
         k = k + 1
         if (k > head%columns) exit
         if (head%slot(k) == 0) cycle
         call parse_real(field, values(head%slot(k)), outcome)
         if (outcome == number_ok) cycle
         call reject(error, file, line, quoted(field) // ", in column " // &
            names(head%slot(k)) // ", is not a finite number")
         return
      end do
      if (k /= head%columns) call reject(error, file, line, "has " // text_of(k) // &
         " columns or more, the header has " // text_of(head%columns))
   end subroutine read_row

   !> The field at `at`, which moves past it; at = 0 if there is none.
   pure subroutine next_field(text, commas, at, field)
      character(*), intent(in) :: text
      logical, intent(in) :: commas
      integer, intent(inout) :: at
      character(:), allocatable, intent(out) :: field
      character(*), parameter :: blanks = " " // achar(9) // achar(13)
      integer :: last
      field = ""
      if (.not. commas .and. at <= len(text)) then
         last = verify(text(at:), blanks)
         at = merge(at + last - 1, len(text) + 2, last > 0)
      end if
      if (at > len(text) + 1 .or. (.not. commas .and. at > len(text))) then
         at = 0
         return
      end if
      last = scan(text(at:), merge(",,,", blanks, commas))
      last = merge(at + last - 2, len(text), last > 0)
      field = text(at:last)
      if (commas .and. verify(field, blanks) > 0) then
         field = field(verify(field, blanks):verify(field, blanks, back=.true.))
      end if
      at = last + 2
   end subroutine next_field

end module poinsot_scene_states_file
