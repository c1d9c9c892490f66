!> Variables of a plot script in gnuplot's language: numbers, strings, arrays of both. Strings may
!> contain any character: gnuplot substitutes nothing between single quotes.
module poinsot_scene_plot_data
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error
   use poinsot_scene_files, only: out_file, put
   use poinsot_scene_text, only: text_of
   implicit none(type, external)
   private
   public :: put_variable, quoted_text

   !> "name = value", or "array name[n] = [values]"; nothing for an array without elements.
   interface put_variable
      module procedure put_integer, put_real, put_text, put_integers, put_reals, put_texts
   end interface put_variable

contains

   subroutine put_integer(file, name, value, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: name
      integer, intent(in) :: value
      type(poinsot_error), intent(inout) :: error
      call put(file, name // " = " // text_of(value), error)
   end subroutine put_integer

   subroutine put_real(file, name, value, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: name
      real(dp), intent(in) :: value
      type(poinsot_error), intent(inout) :: error
      call put(file, name // " = " // text_of(value), error)
   end subroutine put_real

   subroutine put_text(file, name, value, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: name, value
      type(poinsot_error), intent(inout) :: error
      call put(file, name // " = " // quoted_text(value), error)
   end subroutine put_text

   subroutine put_integers(file, name, values, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: name
      integer, intent(in) :: values(:)
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: list
      integer :: i
      list = ""
      do i = 1, size(values)
         list = list // ", " // text_of(values(i))
      end do
      call put_list(file, name, size(values), list, error)
   end subroutine put_integers

   subroutine put_reals(file, name, values, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: name
      real(dp), intent(in) :: values(:)
      type(poinsot_error), intent(inout) :: error
      call put_list(file, name, size(values), ", " // text_of(values), error)
   end subroutine put_reals

   subroutine put_texts(file, name, values, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: name, values(:) !! blanks at their ends are dropped
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: list
      integer :: i
      list = ""
      do i = 1, size(values)
         list = list // ", " // quoted_text(trim(values(i)))
      end do
      call put_list(file, name, size(values), list, error)
   end subroutine put_texts

   subroutine put_list(file, name, n, list, error)
      type(out_file), intent(in) :: file
      character(*), intent(in) :: name
      integer, intent(in) :: n
      character(*), intent(in) :: list            !! ", first, second ..."
      type(poinsot_error), intent(inout) :: error
      if (n == 0) return
      call put(file, "array " // name // "[" // text_of(n) // "] = [" // list(3:) // "]", error)
   end subroutine put_list

   !> A text between single quotes; bytes that would end a line or mean something to a terminal
   !> become question marks.
   pure function quoted_text(text) result(safe)
      character(*), intent(in) :: text !! any bytes
      character(:), allocatable :: safe
      integer :: i
      safe = "'"
      do i = 1, len(text)
         if (iachar(text(i:i)) < 32 .or. iachar(text(i:i)) == 127) then
            safe = safe // "?"
         else if (text(i:i) == "'") then
            safe = safe // "''"
         else
            safe = safe // text(i:i)
         end if
      end do
      safe = safe // "'"
   end function quoted_text

end module poinsot_scene_plot_data
