!> Restart files: the state to the bit, in hexadecimal, with a count and a sum at the end, so that a
!> truncated or edited file is not taken for a good one.
module poinsot_scene_restart
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io, poinsot_e_scene, poinsot_e_memory
   use poinsot_rotation_quaternion, only: unit_tolerance
   use poinsot_scene_text, only: reason_of, text_of, quoted
   use poinsot_scene_source, only: place
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   implicit none(type, external)
   private
   public :: restart_state, write_restart, read_restart, read_choice, sum_of_kinds

   integer, parameter :: version = 2        !! version 1 had no tolerance
   character(*), parameter :: magic = "poinsot-restart"
   integer, parameter :: numbers_of_body = 14    !! y, q, carry

   !> What a run needs to go on.
   type :: restart_state
      character(:), allocatable :: method, splitting !! as run, never `auto`
      real(dp) :: t = 0                    !! time
      real(dp) :: tolerance = 0            !! of splitting taylor; 0 = another splitting
      integer :: head_lines = 10           !! of the file, before the first body
      real(dp) :: h = 0                    !! step of the scene, 0 = none
      integer(i8) :: step = 0              !! steps taken since t = 0
      integer(i8) :: seed = 0
      integer(i8) :: kinds = 0             !! `sum_of_kinds`: a continuation must be of the same
                                           !! bodies
      real(dp), allocatable :: y(:, :)     !! (3, n): principal frame
      real(dp), allocatable :: q(:, :)     !! (4, n)
      real(dp), allocatable :: carry(:, :) !! (7, n)
   end type restart_state

contains

   !> Write a restart file under a temporary name, then give it its own. Error: POINSOT_E_IO.
   subroutine write_restart(path, state, error)
      character(*), intent(in) :: path !! of the file
      type(restart_state), intent(in) :: state
      type(poinsot_error), intent(inout) :: error
      type(out_file) :: file
      integer(i8) :: total
      integer :: i
      call open_out(path, file, error)
      if (raised(error)) return
      call put(file, magic // " " // text_of(version), error)
      call put(file, "method " // state%method, error)
      call put(file, "splitting " // state%splitting, error)
      call put(file, "tolerance " // hex([state%tolerance]) // "  " // &
         text_of(state%tolerance), error)
      call put(file, "t " // hex([state%t]) // "  " // text_of(state%t), error)
      call put(file, "h " // hex([state%h]) // "  " // text_of(state%h), error)
      call put(file, "step " // text_of(state%step), error)
      call put(file, "seed " // text_of(state%seed), error)
      call put(file, "kinds " // digits_of(state%kinds), error)
      call put(file, "bodies " // text_of(size(state%y, 2)), error)
      total = start_sum(state)
      do i = 1, size(state%y, 2)
         call put(file, hex([state%y(:, i), state%q(:, i), state%carry(:, i)]), error)
         call add_to_sum(total, [state%y(:, i), state%q(:, i), state%carry(:, i)])
         if (raised(error)) exit
      end do
      call put(file, "end " // digits_of(total), error)
      call finish_out(file, error)
   end subroutine write_restart

   !> Bits of each number as 16 hexadecimal digits.
   pure function hex(values) result(text)
      real(dp), intent(in) :: values(:)
      character(:), allocatable :: text
      character(17) :: digits
      integer :: i
      text = ""
      do i = 1, size(values)
         write (digits, "(z16.16)") transfer(values(i), 0_i8)
         if (i > 1) text = text // " "
         text = text // digits(:16)
      end do
   end function hex

   !> 16 hexadecimal digits.
   pure function digits_of(bits) result(text)
      integer(i8), intent(in) :: bits
      character(16) :: text
      write (text, "(z16.16)") bits
   end function digits_of

   !> A number that tells bodies of other moments or in other groups apart.
   pure integer(i8) function sum_of_kinds(counts, moments) result(total)
      integer(i8), intent(in) :: counts(:)   !! (groups)
      real(dp), intent(in) :: moments(:, :)  !! (3, groups)
      integer :: i
      total = 0
      do i = 1, size(counts)
         total = ieor(ishftc(total, 9), counts(i))
         call add_to_sum(total, moments(:, i))
      end do
   end function sum_of_kinds

   !> A sum over bits that sees exchanged and changed numbers; no integer overflow.
   pure subroutine add_to_sum(total, values)
      integer(i8), intent(inout) :: total
      real(dp), intent(in) :: values(:)
      integer :: i
      do i = 1, size(values)
         total = ieor(ishftc(total, 5), transfer(values(i), 0_i8))
      end do
   end subroutine add_to_sum

   pure integer(i8) function start_sum(state) result(total)
      type(restart_state), intent(in) :: state
      total = ieor(state%step, ishftc(state%seed, 32))
      call add_to_sum(total, [state%t, state%h])
      if (state%tolerance > 0) call add_to_sum(total, [state%tolerance])
   end function start_sum

   !> Read a restart file. Error: POINSOT_E_IO if it cannot be read, POINSOT_E_SCENE if it is none,
   !> of another version, truncated, changed, or of another number of bodies.
   subroutine read_restart(path, bodies, kinds, state, error)
      character(*), intent(in) :: path            !! of the file
      integer(i8), intent(in) :: bodies           !! how many the scene has
      integer(i8), intent(in) :: kinds            !! their `sum_of_kinds`
      type(restart_state), intent(out) :: state
      type(poinsot_error), intent(inout) :: error
      integer :: unit, code
      character(200) :: reason
      open (newunit=unit, file=path, action="read", status="old", iostat=code, iomsg=reason)
      if (code /= 0) then
         call raise(error, poinsot_e_io, path // ": cannot be opened: " // reason_of(reason))
         return
      end if
      call read_head(unit, path, bodies, kinds, state, error)
      if (.not. raised(error)) call read_bodies(unit, path, int(bodies), state, error)
      close (unit)
   end subroutine read_restart

   !> Method, splitting and step of a restart file: what a scene that leaves them to `auto` goes on
   !> with. Errors as of read_restart.
   subroutine read_choice(path, method, splitting, h, error)
      character(*), intent(in) :: path            !! of the file
      character(:), allocatable, intent(out) :: method, splitting
      real(dp), intent(out) :: h                  !! 0: none
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: word, told
      character(200) :: reason
      integer :: unit, code, line
      h = 0
      line = 0
      open (newunit=unit, file=path, action="read", status="old", iostat=code, iomsg=reason)
      if (code /= 0) then
         call raise(error, poinsot_e_io, path // ": cannot be opened: " // reason_of(reason))
         return
      end if
      call next(unit, path, magic, line, told, error)
      call next(unit, path, "method", line, method, error)
      call next(unit, path, "splitting", line, splitting, error)
      if (told /= "1") call next(unit, path, "tolerance", line, word, error)
      call next(unit, path, "t", line, word, error)
      call next(unit, path, "h", line, word, error)
      call one_real(path, line, word, h, error)
      close (unit, iostat=code)
      if (code /= 0 .and. .not. raised(error)) then
         call raise(error, poinsot_e_io, path // ": cannot be closed")
      end if
   end subroutine read_choice

   !> Everything before the bodies.
   subroutine read_head(unit, path, bodies, kinds, state, error)
      integer, intent(in) :: unit
      character(*), intent(in) :: path
      integer(i8), intent(in) :: bodies, kinds
      type(restart_state), intent(inout) :: state
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: word, told
      integer(i8) :: number
      integer :: line
      logical :: old
      line = 0
      call next(unit, path, magic, line, word, error)
      if (raised(error)) return
      old = word == "1"
      if (old) state%head_lines = state%head_lines - 1
      if (.not. (old .or. word == text_of(version))) then
         call bad(path, line, "is of version " // quoted(word) // &
                  "; this program reads versions 1 and " // text_of(version), error)
         return
      end if
      call next(unit, path, "method", line, state%method, error)
      call next(unit, path, "splitting", line, state%splitting, error)
      if (.not. old) then
         call next(unit, path, "tolerance", line, word, error)
         call one_real(path, line, word, state%tolerance, error)
      end if
      call next(unit, path, "t", line, word, error)
      call one_real(path, line, word, state%t, error)
      call next(unit, path, "h", line, word, error)
      call one_real(path, line, word, state%h, error)
      call next(unit, path, "step", line, word, error)
      call one_integer(path, line, word, state%step, error)
      call next(unit, path, "seed", line, word, error)
      call one_integer(path, line, word, state%seed, error)
      call next(unit, path, "kinds", line, told, error)
      call next(unit, path, "bodies", line, word, error)
      call one_integer(path, line, word, number, error)
      if (raised(error)) return
      if (number /= bodies) then
         call bad(path, line, "is of " // text_of(number) // " bodies, the scene has " // &
                  text_of(bodies), error)
      else if (told /= digits_of(kinds)) then
         call bad(path, line - 1, &
                  "is of bodies with other moments, or in other groups, than the scene's", error)
      end if
   end subroutine read_head

   !> The first word behind the key of the next line.
   subroutine next(unit, path, key, line, word, error)
      integer, intent(in) :: unit
      character(*), intent(in) :: path, key
      integer, intent(inout) :: line
      character(:), allocatable, intent(out) :: word
      type(poinsot_error), intent(inout) :: error
      character(200) :: text
      integer :: code
      word = ""
      if (raised(error)) return
      line = line + 1
      read (unit, "(a)", iostat=code) text
      if (code /= 0) then
         call bad(path, line, "the file ends where """ // key // """ is expected", error)
      else if (text(:len(key) + 1) /= key // " ") then
         call bad(path, line, &
                  "begins with " // quoted(trim(text(:min(40, len(text))))) // " where """ // &
                  key // """ is expected: not a restart file, or a damaged one", error)
      else
         word = trim(adjustl(text(len(key) + 2:)))
         if (index(word, " ") > 0) word = word(:index(word, " ") - 1)
      end if
   end subroutine next

   subroutine one_real(path, line, word, value, error)
      character(*), intent(in) :: path, word
      integer, intent(in) :: line
      real(dp), intent(out) :: value
      type(poinsot_error), intent(inout) :: error
      real(dp) :: values(1)
      logical :: good
      value = 0
      if (raised(error)) return
      call from_hex(word, values, good)
      if (good) good = ieee_is_finite(values(1))
      if (good) good = values(1) >= 0
      if (.not. good) call bad(path, line, quoted(word) // " is not a time in 16 digits", error)
      if (good) value = values(1)
   end subroutine one_real

   subroutine one_integer(path, line, word, value, error)
      use poinsot_core_number, only: parse_integer, number_ok
      character(*), intent(in) :: path, word
      integer, intent(in) :: line
      integer(i8), intent(out) :: value
      type(poinsot_error), intent(inout) :: error
      integer :: outcome
      value = 0
      if (raised(error)) return
      call parse_integer(word, value, outcome)
      if (outcome /= number_ok) call bad(path, line, quoted(word) // " is not an integer", error)
   end subroutine one_integer

   !> Numbers from 16 hexadecimal digits each, one blank between them.
   pure subroutine from_hex(text, values, good)
      character(*), intent(in) :: text
      real(dp), intent(out) :: values(:)
      logical, intent(out) :: good
      integer(i8) :: bits
      integer :: i, at
      values = 0
      good = .false.
      do i = 1, size(values)
         at = 17*(i - 1)
         if (len(text) < at + 16) return
         if (verify(text(at + 1:at + 16), "0123456789ABCDEFabcdef") > 0) return
         read (text(at + 1:at + 16), "(z16)") bits
         values(i) = transfer(bits, 0.0_dp)
      end do
      good = len_trim(text) == 17*size(values) - 1
   end subroutine from_hex

   !> The bodies, the sum, and nothing after it.
   subroutine read_bodies(unit, path, n, state, error)
      integer, intent(in) :: unit, n
      character(*), intent(in) :: path
      type(restart_state), intent(inout) :: state
      type(poinsot_error), intent(inout) :: error
      character(17*numbers_of_body + 8) :: text
      character(:), allocatable :: word
      real(dp) :: values(numbers_of_body)
      integer(i8) :: total
      integer :: i, code, line
      logical :: good
      allocate (state%y(3, n), stat=code)
      if (code == 0) allocate (state%q(4, n), stat=code)
      if (code == 0) allocate (state%carry(7, n), stat=code)
      if (code /= 0) then
         call raise(error, poinsot_e_memory, path // ": no memory for " // text_of(n) // " bodies")
         return
      end if
      total = start_sum(state)
      do i = 1, n
         line = state%head_lines + i
         read (unit, "(a)", iostat=code) text
         good = code == 0
         if (good) call from_hex(trim(text), values, good)
         if (good) good = all(ieee_is_finite(values))
         if (good) good = all(abs(values(4:7)) < 2)
         if (good) good = abs(norm2(values(4:7)) - 1) <= unit_tolerance
         if (.not. good) then
            call bad(path, line, "body " // text_of(i) // " of " // text_of(n) // &
                     " is missing or damaged", error)
            return
         end if
         state%y(:, i) = values(1:3)
         state%q(:, i) = values(4:7)
         state%carry(:, i) = values(8:14)
         call add_to_sum(total, values)
      end do
      line = state%head_lines + n
      call next(unit, path, "end", line, word, error)
      if (raised(error)) return
      if (word /= digits_of(total)) then
         call bad(path, line, "the sum at the end is not that of the numbers: the file was " // &
                  "changed or damaged", error)
      end if
   end subroutine read_bodies

   subroutine bad(path, line, message, error)
      character(*), intent(in) :: path, message
      integer, intent(in) :: line
      type(poinsot_error), intent(inout) :: error
      if (.not. raised(error)) call raise(error, poinsot_e_scene, place(path, line) // message)
   end subroutine bad

end module poinsot_scene_restart
