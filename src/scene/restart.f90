!> Restart files: the exact state, in hexadecimal, with a count and a checksum at the end, so that a
!> truncated or edited file is detected.
module poinsot_scene_restart
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_status, only: poinsot_e_io, poinsot_e_scene
   use poinsot_rotation_quaternion, only: unit_tolerance
   use poinsot_scene_text, only: reason_of, text_of, quoted
   use poinsot_scene_source, only: place
   use poinsot_scene_communicator, only: communicator
   use poinsot_scene_states, only: body_states
   implicit none(type, external)
   private
   public :: restart_state, write_restart, read_restart, read_choice, sum_of_kinds

   integer, parameter :: version = 2        !! version 1 had no tolerance
   character(*), parameter :: magic = "poinsot-restart"
   integer, parameter :: numbers_of_body = 14    !! y, q, carry
   integer(i8), parameter :: line_length = 17*numbers_of_body !! of a body, with its end
   integer, parameter :: turn_of_number = 5      !! of the sum, by each number
   integer, parameter :: chunk = 4096            !! bodies that are text at once
   character, parameter :: newline = achar(10)

   !> What a run needs to go on, beside the states of its bodies.
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
   end type restart_state

contains

   !> Write a restart file under a temporary name, then give it its own. Every rank writes the lines
   !> of its own bodies; all ranks call. Error: POINSOT_E_IO, on all.
   subroutine write_restart(path, state, states, ranks, error)
      character(*), intent(in) :: path           !! of the file
      type(restart_state), intent(in) :: state
      type(body_states), intent(in) :: states    !! of this rank's bodies
      class(communicator), intent(inout) :: ranks
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: head, text
      integer(i8) :: total, place, begin
      integer :: i, k, n
      head = magic // " " // text_of(version) // newline // &
         "method " // state%method // newline // "splitting " // state%splitting // newline // &
         "tolerance " // hex(state%tolerance) // "  " // text_of(state%tolerance) // newline // &
         "t " // hex(state%t) // "  " // text_of(state%t) // newline // &
         "h " // hex(state%h) // "  " // text_of(state%h) // newline // &
         "step " // text_of(state%step) // newline // "seed " // text_of(state%seed) // newline // &
         "kinds " // digits_of(state%kinds) // newline // &
         "bodies " // text_of(states%total) // newline
      call ranks%open_file(path, error)
      if (raised(error)) return
      if (ranks%number == 0) call ranks%write_at(0_i8, head, error)
      total = 0
      begin = len(head, i8)
      place = begin + line_length*int(states%first, i8)
      allocate (character(int(line_length)*min(chunk, max(1, states%n))) :: text)
      do i = 1, states%n, chunk
         n = min(chunk, states%n - i + 1)
         do k = 1, n
            call put_line([states%y(:, i + k - 1), states%q(:, i + k - 1), &
               states%carry(:, i + k - 1)], text(int(line_length)*(k - 1) + 1:int(line_length)*k))
            call add_to_sum(total, [states%y(:, i + k - 1), states%q(:, i + k - 1), &
               states%carry(:, i + k - 1)])
         end do
         call ranks%write_at(place, text(:int(line_length)*n), error)
         if (raised(error)) exit
         place = place + line_length*n
      end do
      total = total_of(state, states, total, ranks)
      place = begin + line_length*int(states%total, i8)
      head = "end " // digits_of(total) // newline
      if (ranks%number == 0) call ranks%write_at(place, head, error)
      call ranks%close_file(error)
   end subroutine write_restart

   !> One body's line, with its end.
   pure subroutine put_line(values, line)
      real(dp), intent(in) :: values(numbers_of_body)
      character(line_length), intent(out) :: line
      character, parameter :: digits(0:15) = ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9", &
         "A", "B", "C", "D", "E", "F"]
      integer(i8) :: bits
      integer :: i, k
      do i = 1, size(values)
         bits = transfer(values(i), bits)
         do k = 17*i - 1, 17*i - 16, -1
            line(k:k) = digits(iand(bits, 15_i8))
            bits = shiftr(bits, 4)
         end do
         line(17*i:17*i) = " "
      end do
      line(line_length:) = newline
   end subroutine put_line

   !> The sum of all ranks' bodies from the sum of each: the bits of a number are turned on by all
   !> numbers behind it.
   integer(i8) function total_of(state, states, own, ranks) result(total)
      type(restart_state), intent(in) :: state
      type(body_states), intent(in) :: states
      integer(i8), intent(in) :: own
      class(communicator), intent(inout) :: ranks
      total = ishftc(own, turns_of(states%total - states%first - states%n))
      total = ieor(ranks%xor_over_ranks(total), ishftc(start_sum(state), turns_of(states%total)))
   end function total_of

   !> By how much so many bodies turn the sum.
   pure integer function turns_of(bodies)
      integer, intent(in) :: bodies
      turns_of = int(mod(turn_of_number*numbers_of_body*int(bodies, i8), 64_i8))
   end function turns_of

   !> Bits of a number as 16 hexadecimal digits.
   pure function hex(value) result(text)
      real(dp), intent(in) :: value
      character(16) :: text
      text = digits_of(transfer(value, 0_i8))
   end function hex

   !> 16 hexadecimal digits.
   pure function digits_of(bits) result(text)
      integer(i8), intent(in) :: bits
      character(16) :: text
      write (text, "(z16.16)") bits
   end function digits_of

   !> A hash that distinguishes bodies with other moments or in other groups.
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
         total = ieor(ishftc(total, turn_of_number), transfer(values(i), 0_i8))
      end do
   end subroutine add_to_sum

   pure integer(i8) function start_sum(state) result(total)
      type(restart_state), intent(in) :: state
      total = ieor(state%step, ishftc(state%seed, 32))
      call add_to_sum(total, [state%t, state%h])
      if (state%tolerance > 0) call add_to_sum(total, [state%tolerance])
   end function start_sum

   !> Read a restart file: its beginning by all ranks, of the bodies each its own. All ranks call.
   !> Error: POINSOT_E_IO if it cannot be read, POINSOT_E_SCENE if it is none, of another version,
   !> truncated, changed, or of other bodies; on all ranks.
   subroutine read_restart(path, kinds, state, states, ranks, error)
      character(*), intent(in) :: path            !! of the file
      integer(i8), intent(in) :: kinds            !! `sum_of_kinds` of the scene's bodies
      type(restart_state), intent(out) :: state
      type(body_states), intent(inout) :: states  !! of this rank: which they are; receives them
      class(communicator), intent(inout) :: ranks
      type(poinsot_error), intent(inout) :: error
      integer :: unit, code
      integer(i8) :: place
      character(200) :: reason
      open (newunit=unit, file=path, action="read", status="old", access="stream", &
            form="formatted", iostat=code, iomsg=reason)
      if (code /= 0) then
         call raise(error, poinsot_e_io, path // ": cannot be opened: " // reason_of(reason))
      else
         call read_head(unit, path, int(states%total, i8), kinds, state, error)
         inquire (unit=unit, pos=place)
         close (unit)
      end if
      call ranks%share_error(error)
      if (.not. raised(error)) call read_bodies(path, place - 1, state, states, ranks, error)
   end subroutine read_restart

   !> Method, splitting and step of a restart file: what a scene that leaves them to `auto` goes on
   !> with. Errors as of read_restart.
   subroutine read_choice(path, method, splitting, h, tolerance, error)
      character(*), intent(in) :: path            !! of the file
      character(:), allocatable, intent(out) :: method, splitting
      real(dp), intent(out) :: h                  !! 0: none
      real(dp), intent(inout) :: tolerance        !! of `taylor`; left as it is for others
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
      if (told /= "1" .and. splitting == "taylor") call one_real(path, line, word, tolerance, error)
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
      integer :: i, k, digit
      values = 0
      good = .false.
      if (len(text) < 17*size(values) - 1) return
      do i = 1, size(values)
         bits = 0
         do k = 17*i - 16, 17*i - 1
            digit = digit_of(text(k:k))
            if (digit < 0) return
            bits = ior(shiftl(bits, 4), int(digit, i8))
         end do
         values(i) = transfer(bits, 0.0_dp)
         if (i < size(values)) then
            if (text(17*i:17*i) /= " ") return
         end if
      end do
      good = len_trim(text) == 17*size(values) - 1
   end subroutine from_hex

   !> Value of a hexadecimal digit; -1 if it is not one.
   pure integer function digit_of(letter)
      character, intent(in) :: letter
      select case (letter)
      case ("0":"9")
         digit_of = iachar(letter) - iachar("0")
      case ("A":"F")
         digit_of = iachar(letter) - iachar("A") + 10
      case ("a":"f")
         digit_of = iachar(letter) - iachar("a") + 10
      case default
         digit_of = -1
      end select
   end function digit_of

   !> The bodies and the sum.
   subroutine read_bodies(path, begin, state, states, ranks, error)
      character(*), intent(in) :: path
      integer(i8), intent(in) :: begin     !! where the first body's line is, from 0
      type(restart_state), intent(in) :: state
      type(body_states), intent(inout) :: states
      class(communicator), intent(inout) :: ranks
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: text
      character(20) :: last
      real(dp) :: values(numbers_of_body)
      integer(i8) :: total
      integer :: i, k, n, line
      logical :: good
      total = 0
      allocate (character(int(line_length)*min(chunk, max(1, states%n))) :: text)
      do i = 1, states%n, chunk
         n = min(chunk, states%n - i + 1)
         call ranks%read_at(path, begin + line_length*(states%first + i - 1), &
                            text(:int(line_length)*n), error)
         do k = 1, n
            if (raised(error)) exit
            call from_hex(text(int(line_length)*(k - 1) + 1:int(line_length)*k - 1), values, good)
            if (good) good = text(int(line_length)*k:int(line_length)*k) == newline
            if (good) good = all(ieee_is_finite(values))
            if (good) good = all(abs(values(4:7)) < 2)
            if (good) good = abs(norm2(values(4:7)) - 1) <= unit_tolerance
            if (.not. good) then
               line = states%first + i + k - 1
               call bad(path, state%head_lines + line, "body " // text_of(line) // " of " // &
                        text_of(states%total) // " is missing or damaged", error)
               exit
            end if
            states%y(:, i + k - 1) = values(1:3)
            states%q(:, i + k - 1) = values(4:7)
            states%carry(:, i + k - 1) = values(8:14)
            call add_to_sum(total, values)
         end do
      end do
      call ranks%share_error(error)
      if (raised(error)) return
      total = total_of(state, states, total, ranks)
      line = state%head_lines + states%total + 1
      call ranks%read_at(path, begin + line_length*states%total, last, error)
      if (last(:4) /= "end ") then
         call bad(path, line, "the file ends where ""end"" is expected", error)
      else if (last(5:) /= digits_of(total)) then
         call bad(path, line, "the checksum at the end is wrong: the file was " // &
                  "changed or damaged", error)
      end if
      call ranks%share_error(error)
   end subroutine read_bodies

   subroutine bad(path, line, message, error)
      character(*), intent(in) :: path, message
      integer, intent(in) :: line
      type(poinsot_error), intent(inout) :: error
      if (.not. raised(error)) call raise(error, poinsot_e_scene, place(path, line) // message)
   end subroutine bad

end module poinsot_scene_restart
