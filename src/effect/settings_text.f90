!> Settings of an effect in one string, "centre = 0, 0, 1; weight = 2", as written by a C host.
module poinsot_effect_settings_text
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_memory
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_message, only: printable
   use poinsot_core_number, only: parse_real, parse_repeats, lower, number_ok, number_range
   use poinsot_effect_settings, only: setting
   implicit none(type, external)
   private
   public :: read_settings

   character(*), parameter :: blanks = " ,"//achar(9)//achar(10)//achar(13)
   integer, parameter :: most_numbers = 1000000 !! of one key

   character(*), parameter :: of_settings = "settings: " !! how a message begins, the effect unknown

contains

   !> Settings from a text: `key = values`, separated by semicolons; keys in any case; values are
   !> numbers (blanks or a comma between them, `3*0` says one three times) or one word, which may
   !> stand in quotes, those within it doubled. POINSOT_E_DOMAIN, naming the effect and quoting the
   !> part, for anything else.
   subroutine read_settings(text, settings, error, effect)
      character(*), intent(in) :: text
      type(setting), allocatable, intent(out) :: settings(:)
      type(poinsot_error), intent(inout) :: error
      character(*), intent(in), optional :: effect !! whose settings they are, for messages
      call read_list(text, settings, error)
      if (.not. (raised(error) .and. present(effect))) return
      if (index(error%message, of_settings) /= 1) return
      error%message = "effect '" // printable(effect) // "': " // &
         error%message(len(of_settings) + 1:)
   end subroutine read_settings

   !> The list itself.
   subroutine read_list(text, settings, error)
      character(*), intent(in) :: text
      type(setting), allocatable, intent(out) :: settings(:)
      type(poinsot_error), intent(inout) :: error
      integer :: first, last, n, pass, state
      do pass = 1, 2 ! count, then read: a list cut to size would be a copy, made without a look
         n = 0
         first = 1
         do while (first <= len(text))
            last = first - 1 + part_length(text(first:))
            if (verify(text(first:last), blanks) > 0) then
               n = n + 1
               if (pass == 2) call read_one(text(first:last), settings(n), error)
               if (raised(error)) return
            end if
            first = last + 2
         end do
         if (pass == 2) return
         allocate (settings(n), stat=state)
         if (state /= 0) then
            call raise(error, poinsot_e_memory, "no memory for the settings of an effect")
            return
         end if
      end do
   end subroutine read_list

   !> The length of a text before the next semicolon that is not within quotes.
   pure integer function part_length(text) result(n)
      character(*), intent(in) :: text
      character :: quote
      quote = " "
      do n = 0, len(text) - 1
         associate (c => text(n + 1:n + 1))
            if (quote /= " ") then
               if (c == quote) quote = " "
            else if (c == "'" .or. c == '"') then
               if (index(text(n + 2:), c) > 0) quote = c
            else if (c == ";") then
               return
            end if
         end associate
      end do
   end function part_length

   !> One `key = values`.
   subroutine read_one(part, one, error)
      character(*), intent(in) :: part
      type(setting), intent(inout) :: one
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: values
      integer :: equals
      equals = index(part, "=")
      if (equals > 0) one%key = lower(trimmed(part(1:equals - 1)))
      if (equals > 0) values = trimmed(part(equals + 1:))
      if (equals == 0) then
         call raise(error, poinsot_e_domain, of_settings//"'"//printable(trimmed(part))// &
            "' is not of the form key = values")
      else if (len(one%key) == 0 .or. len(values) == 0) then
         call raise(error, poinsot_e_domain, of_settings//"'"//printable(trimmed(part))// &
            "' lacks its key or its values")
      else if (is_quoted(values)) then
         one%text = between_quotes(values)
      else if (scan(values(1:1), "+-.0123456789") == 1 .or. is_number_word(values)) then
         call read_numbers(trim(adjustl(part(equals + 1:))), one, error)
      else
         one%text = values
      end if
   end subroutine read_one

   !> Numbers into a setting: counted, then stored.
   subroutine read_numbers(values, one, error)
      character(*), intent(in) :: values
      type(setting), intent(inout) :: one
      type(poinsot_error), intent(inout) :: error
      integer :: pass, first, last, n, state, repeats
      logical :: wanted
      real(dp) :: x
      do pass = 1, 2
         n = 0
         first = 1
         wanted = .true.
         do while (first <= len(values))
            last = first
            if (values(first:first) == ",") then
               if (wanted) call reject_values(one%key, values, "a place between commas is empty", &
                  error)
               wanted = .true.
            else if (scan(values(first:first), blanks) == 0) then
               last = scan(values(first:), blanks) + first - 2
               if (last < first) last = len(values)
               call read_number(one%key, values, values(first:last), repeats, x, error)
               if (n > most_numbers - repeats) call reject_values(one%key, values, &
                  "these are more than a million numbers", error)
               if (raised(error)) return
               if (pass == 2) one%values(n + 1:n + repeats) = x
               n = n + repeats
               wanted = .false.
            end if
            if (raised(error)) return
            first = last + 1
         end do
         if (pass == 2) return
         allocate (one%values(n), stat=state) ! an assignment would allocate without a look
         if (state /= 0) then
            call raise(error, poinsot_e_memory, "no memory for the settings of an effect")
            return
         end if
      end do
   end subroutine read_numbers

   !> One number, with its repeat count.
   subroutine read_number(key, values, word, repeats, x, error)
      character(*), intent(in) :: key, values !! for messages
      character(*), intent(in) :: word
      integer, intent(out) :: repeats
      real(dp), intent(out) :: x
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: shown
      integer :: length, outcome
      logical :: good
      shown = printable(word)
      call parse_repeats(word, repeats, length, good)
      if (good) then
         repeats = max(repeats, 1)
         call parse_real(word(length + 1:), x, outcome)
         if (outcome == number_range) then
            call reject_values(key, values, "'" // shown // &
               "' must be finite and at most 1e307 in size", error)
         else if (outcome /= number_ok) then
            call reject_values(key, values, "'" // shown // "' is not a number", error)
         end if
      else
         call reject_values(key, values, "the repeat count of '" // shown // &
            "' is not from 1 to 100000000", error)
      end if
   end subroutine read_number

   subroutine reject_values(key, values, why, error)
      character(*), intent(in) :: key, values, why
      type(poinsot_error), intent(inout) :: error
      call raise(error, poinsot_e_domain, of_settings // "'" // printable(key) // " = " // &
         printable(values) // "': " // why)
   end subroutine reject_values

   !> The text between the quotes, with doubled quotes made single.
   pure function between_quotes(s) result(text)
      character(*), intent(in) :: s
      character(:), allocatable :: text
      integer :: i, n
      allocate (character(len(s)) :: text)
      n = 0
      i = 2
      do while (i < len(s))
         n = n + 1
         text(n:n) = s(i:i)
         if (s(i:i) == s(1:1) .and. i + 1 < len(s)) then
            if (s(i + 1:i + 1) == s(1:1)) i = i + 1
         end if
         i = i + 1
      end do
      text = text(:n)
   end function between_quotes

   pure logical function is_quoted(s)
      character(*), intent(in) :: s
      is_quoted = .false.
      if (len(s) >= 2) is_quoted = (s(1:1) == "'" .or. s(1:1) == '"') &
          .and. s(len(s):len(s)) == s(1:1)
   end function is_quoted

   !> nan and inf are numbers, refused as such.
   pure logical function is_number_word(s)
      character(*), intent(in) :: s
      is_number_word = any(s == [character(8) :: "nan", "NaN", "NAN", "inf", "Inf", "INF", &
         "infinity", "Infinity"])
   end function is_number_word

   !> Without blanks at both ends.
   pure function trimmed(s) result(t)
      character(*), intent(in) :: s
      character(:), allocatable :: t
      integer :: first
      first = verify(s, blanks)
      t = ""
      if (first > 0) t = s(first:verify(s, blanks, back=.true.))
   end function trimmed

end module poinsot_effect_settings_text
