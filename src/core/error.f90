!> Error reports: a status value, and a message that says what is wrong, where, and what is allowed.
module poinsot_core_error
   use poinsot_core_status, only: poinsot_ok, status_text
   implicit none(type, external)
   private
   public :: poinsot_error, clear, raise, raised

   !> An error, or none (`code == poinsot_ok`). Comes back through an argument that is not optional.
   !> The type also has `error%raised()` and `call error%clear()`.
   type :: poinsot_error
      integer :: code = poinsot_ok
      character(:), allocatable :: message
   contains
      procedure :: clear
      procedure :: raised
   end type poinsot_error

contains

   !> Forget an earlier error.
   pure subroutine clear(error)
      class(poinsot_error), intent(inout) :: error
      error%code = poinsot_ok
      if (allocated(error%message)) deallocate (error%message)
   end subroutine clear

   !> Record an error; without a message the text of the status value is used.
   pure subroutine raise(error, code, message)
      type(poinsot_error), intent(inout) :: error
      integer, intent(in) :: code                    !! a poinsot_e_... value
      character(*), intent(in), optional :: message  !! what, where, and what would be right
      error%code = code
      if (present(message)) then
         error%message = message
      else
         error%message = status_text(code)
      end if
   end subroutine raise

   !> Has an error been recorded?
   pure logical function raised(error)
      class(poinsot_error), intent(in) :: error
      raised = error%code /= poinsot_ok
   end function raised

end module poinsot_core_error
