!> Settings of an effect in one text, "centre = 0, 0, 1; weight = 2": what a C host writes.
module poinsot_effect_settings_text
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_memory
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_number, only: parse_real, number_ok, number_range
   use poinsot_effect_settings, only: setting
   implicit none(type, external)
   private
   public :: read_settings

   character(*), parameter :: blanks = " ,"//achar(9)//achar(10)//achar(13)

contains

   !> Settings from a text: `key = values`, separated by semicolons; values are numbers (blanks or
   !> commas between them) or one word, which may stand in quotes. POINSOT_E_DOMAIN, quoting the
   !> part, for anything else.
   subroutine read_settings(text, settings, error)
      character(*), intent(in) :: text
      type(setting), allocatable, intent(out) :: settings(:)
      type(poinsot_error), intent(inout) :: error
      integer :: first, last, n, pass, state
      do pass = 1, 2 ! count, then read: a list cut to size would be a copy, made without a look
         n = 0
         first = 1
         do while (first <= len(text))
            last = index(text(first:), ";") + first - 2
            if (last < first - 1) last = len(text)
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
   end subroutine read_settings

   !> One `key = values`.
   subroutine read_one(part, one, error)
      character(*), intent(in) :: part
      type(setting), intent(inout) :: one
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: values
      integer :: equals
      equals = index(part, "=")
      if (equals > 0) one%key = trimmed(part(1:equals - 1))
      if (equals > 0) values = trimmed(part(equals + 1:))
      if (equals == 0) then
         call raise(error, poinsot_e_domain, "settings: '"//trimmed(part)// &
            "' is not of the form key = values")
      else if (len(one%key) == 0 .or. len(values) == 0) then
         call raise(error, poinsot_e_domain, "settings: '"//trimmed(part)// &
            "' lacks its key or its values")
      else if (is_quoted(values)) then
         one%text = values(2:len(values) - 1)
      else if (scan(values(1:1), "+-.0123456789") == 1 .or. is_number_word(values)) then
         call read_numbers(values, one, error)
      else
         one%text = values
      end if
   end subroutine read_one

   subroutine read_numbers(values, one, error)
      character(*), intent(in) :: values
      type(setting), intent(inout) :: one
      type(poinsot_error), intent(inout) :: error
      integer :: first, last, n, state, outcome
      real(dp), allocatable :: found(:)
      real(dp) :: x
      allocate (found(1 + len(values)/2), stat=state)
      if (state /= 0) then
         call raise(error, poinsot_e_memory, "no memory for the settings of an effect")
         return
      end if
      n = 0
      first = 1
      do
         last = verify(values(first:), blanks)
         if (last == 0) exit
         first = first + last - 1
         last = scan(values(first:), blanks) + first - 2
         if (last < first) last = len(values)
         call parse_real(values(first:last), x, outcome)
         if (outcome /= number_ok) then
            call raise(error, poinsot_e_domain, "settings: '" // one%key // " = " // values // &
                       "': '" // values(first:last) // trim(merge( &
                       "' is not finite or beyond 1e307", "' is not a number              ", &
                       outcome == number_range)))
            return
         end if
         n = n + 1
         found(n) = x
         first = last + 1
         if (first > len(values)) exit
      end do
      allocate (one%values(n), stat=state) ! an assignment would allocate without a look
      if (state /= 0) then
         call raise(error, poinsot_e_memory, "no memory for the settings of an effect")
         return
      end if
      one%values(:) = found(1:n)
   end subroutine read_numbers

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
