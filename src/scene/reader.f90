!> Our own reader of scene files: Fortran namelist text into groups, keys and values with line
!> numbers, with messages that say what, where and what would be right (the run-time library's own
!> do not).
!>
!> The subset of namelist input that is read: `&name key = values / ` with any case;
!> `key(i) = values` from subscript i, `key(i:j) = values` to subscript j; values apart by blanks,
!> line ends or one comma; nothing between two commas is a null value (the default stays), as is
!> `3*`; `3*0.0` repeats; numbers with e or d; .true. .false. t f; strings in ' or " with the quote
!> doubled inside, closed on their own line; comments from ! to the line's end; /, or &end, closes.
!> Lines end in LF, CRLF or CR. Bytes beyond ASCII are welcome in comments and strings. Not read:
!> unquoted words, sections with a stride, text between groups.
module poinsot_scene_reader
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_scene_text, only: text_of, quoted
   use poinsot_scene_source, only: scene_entry, scene_group, scene_source, append, reject
   use poinsot_scene_load, only: load_text
   use poinsot_scene_cursor, only: cursor, open_cursor, skip, word_at, scan_name, &
      scan_subscript, longest_name, newline
   use poinsot_scene_values, only: scan_list
   implicit none(type, external)
   private
   public :: read_source, scan_source

contains

   !> Read a scene file. Errors: POINSOT_E_IO if it cannot be read, POINSOT_E_SCENE if it is not a
   !> namelist file.
   subroutine read_source(file, source, error)
      character(*), intent(in) :: file          !! its name
      type(scene_source), intent(out) :: source !! the scanned file
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: text
      call load_text(file, text, error)
      if (raised(error)) return
      call scan_source(text, file, source, error)
   end subroutine read_source

   !> Scan the text of a scene file. Error: POINSOT_E_SCENE naming file and line.
   subroutine scan_source(text, file, source, error)
      character(*), intent(in) :: text          !! the bytes of the file
      character(*), intent(in) :: file          !! its name, for messages
      type(scene_source), intent(out) :: source !! the scanned file
      type(poinsot_error), intent(inout) :: error
      type(cursor) :: here
      type(scene_group) :: group
      source%file = file
      allocate (source%groups(0:0))
      deallocate (source%groups)
      call open_cursor(text, file, here, error)
      source%head = ""
      if (.not. raised(error)) source%head = head_of(here%text)
      do while (.not. raised(error))
         call skip(here)
         if (here%at > len(here%text)) exit
         if (here%text(here%at:here%at) /= "&") then
            call reject(error, file, here%line, quoted(word_at(here)) // " is outside of " // &
                        "a group; a group begins with &name and ends with /, a comment with !")
            return
         end if
         call scan_group(here, group, error)
         if (.not. raised(error)) call append(source, group)
      end do
      if (raised(error)) return
      if (source%count == 0) then
         call reject(error, file, 0, "holds no group; a scene has at least &scene and &bodies")
      end if
   end subroutine scan_source

   !> The comment lines that a text begins with, without `!` and the blank behind it.
   pure function head_of(text) result(head)
      character(*), intent(in) :: text
      character(:), allocatable :: head
      integer :: from, to
      head = ""
      from = 1
      do while (from <= len(text))
         if (text(from:from) /= "!") exit
         to = index(text(from:), newline) + from - 1
         if (to < from) to = len(text) + 1
         from = from + 1
         if (from < to) then
            if (text(from:from) == " ") from = from + 1
         end if
         head = head // text(from:to - 1) // newline
         from = to + 1
      end do
   end function head_of

   !> `&name ... /`, the cursor on the ampersand.
   subroutine scan_group(here, group, error)
      type(cursor), intent(inout) :: here
      type(scene_group), intent(out) :: group
      type(poinsot_error), intent(inout) :: error
      type(scene_entry) :: entry
      type(cursor) :: before
      character(:), allocatable :: name
      group%line = here%line
      here%at = here%at + 1
      call scan_name(here, group%name)
      if (len(group%name) == 0 .or. len(group%name) > longest_name) then
         call reject(error, here%file, here%line, "& is not followed by the name of " // &
                     "a group, as in &scene")
         return
      end if
      do
         call skip(here)
         if (here%at > len(here%text)) then
            call reject(error, here%file, group%line, "&" // group%name // &
                        " begins here and is not closed by /")
            return
         end if
         select case (here%text(here%at:here%at))
         case ("/")
            here%at = here%at + 1
            return
         case ("&")
            before%at = here%at
            here%at = here%at + 1
            call scan_name(here, name)
            if (name == "end") return
            call reject(error, here%file, here%line, "&" // name // " begins inside of &" // &
                        group%name // " (line " // text_of(group%line) // &
                        "): is the closing / missing?")
            return
         case default
            call scan_entry(here, group%name, entry, error)
            if (raised(error)) return
            call append(group, entry)
         end select
      end do
   end subroutine scan_group

   !> `key = values`, `key(i) = values` or `key(i:j) = values`.
   subroutine scan_entry(here, group, entry, error)
      type(cursor), intent(inout) :: here
      character(*), intent(in) :: group
      type(scene_entry), intent(out) :: entry
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: found
      entry%line = here%line
      found = word_at(here)
      call scan_name(here, entry%key)
      if (len(entry%key) == 0 .or. len(entry%key) > longest_name) then
         call reject(error, here%file, here%line, "&" // group // ": " // quoted(found) // &
                     " where a key is expected, as in key = value")
         return
      end if
      call scan_subscript(here, group, entry, error)
      if (raised(error)) return
      call skip(here)
      if (here%at <= len(here%text)) then
         if (here%text(here%at:here%at) == "=") then
            here%at = here%at + 1
            call scan_list(here, group, entry, error)
            return
         end if
      end if
      call reject(error, here%file, entry%line, "&" // group // ": " // quoted(entry%key) // &
                  " is not followed by = (is a string without its quotes?)")
   end subroutine scan_entry

end module poinsot_scene_reader
