!> Conversion of strings between C and Fortran.
module poinsot_api_text
   use, intrinsic :: iso_c_binding, only: c_char, c_ptr, c_null_char, c_size_t, &
      c_associated, c_f_pointer
   implicit none(type, external)
   private
   public :: from_c, name_from_c, to_c

   interface
      pure integer(c_size_t) function c_strlen(text) bind(c, name="strlen")
         import :: c_ptr, c_size_t
         implicit none(type, external)
         type(c_ptr), value, intent(in) :: text
      end function c_strlen
   end interface

contains

   !> A C text, of any length, as a Fortran one; not allocated for NULL, or if there is no memory.
   subroutine from_c(text, s)
      type(c_ptr), intent(in) :: text
      character(:), allocatable, intent(out) :: s
      character(kind=c_char), pointer :: c(:)
      integer(c_size_t) :: n, i
      integer :: state
      if (.not. c_associated(text)) return
      n = c_strlen(text)
      call c_f_pointer(text, c, [n])
      allocate (character(n) :: s, stat=state)
      if (state /= 0) return
      do i = 1, n
         s(i:i) = c(i)
      end do
   end subroutine from_c

   !> The same as one of fixed length, blank-padded, for calls that must not wait for memory.
   subroutine name_from_c(text, name, fits)
      type(c_ptr), intent(in) :: text              !! not NULL
      character(*), intent(out) :: name
      logical, intent(out) :: fits                 !! .false.: it is longer
      character(kind=c_char), pointer :: c(:)
      integer :: i
      call c_f_pointer(text, c, [len(name) + 1])   ! looked at up to its end only
      name = ""
      do i = 1, len(name) + 1
         fits = c(i) == c_null_char
         if (fits .or. i > len(name)) return
         name(i:i) = c(i)
      end do
   end subroutine name_from_c

   !> A Fortran text into a C buffer: at most `capacity` bytes, the last of them zero. A NULL buffer
   !> takes nothing.
   subroutine to_c(s, buffer, capacity)
      character(*), intent(in) :: s
      type(c_ptr), intent(in) :: buffer
      integer(c_size_t), intent(in) :: capacity
      character(kind=c_char), pointer :: c(:)
      integer :: n, i
      if (.not. c_associated(buffer) .or. capacity == 0) return
      n = len(s)
      if (capacity > 0) n = int(min(int(n, c_size_t), capacity - 1)) ! a capacity beyond the signed
                                                                     ! range is enough
      call c_f_pointer(buffer, c, [n + 1])
      do i = 1, n
         c(i) = s(i:i)
      end do
      c(n + 1) = c_null_char
   end subroutine to_c

end module poinsot_api_text
