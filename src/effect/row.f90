!> The description of an effect in its own file, from which the registry is built.
module poinsot_effect_row
   use poinsot_core_kinds, only: name_length
   use poinsot_core_error, only: poinsot_error
   use poinsot_effect_effect, only: effect
   use poinsot_effect_settings, only: setting, effect_info
   implicit none(type, external)
   private
   public :: effect_label, effect_row, row_source, constructor

   !> The constant part: compilers accept no procedure in a constant.
   type :: effect_label
      character(name_length) :: name
      integer :: number                    !! the public one, from 1: never another's
   end type effect_label

   abstract interface
      !> An effect from checked settings; not allocated after an error.
      subroutine constructor(info, settings, made, error)
         import :: effect, effect_info, setting, poinsot_error
         implicit none(type, external)
         type(effect_info), intent(in) :: info
         type(setting), intent(in) :: settings(:)
         class(effect), allocatable, intent(out) :: made
         type(poinsot_error), intent(inout) :: error
      end subroutine constructor
   end interface

   !> One effect: what it is, and how it is made from settings (null: it is not).
   type :: effect_row
      type(effect_info) :: info
      procedure(constructor), pointer, nopass :: make => null()
   end type effect_row

   abstract interface
      function describe() result(row)
         import :: effect_row
         implicit none(type, external)
         type(effect_row) :: row
      end function describe
   end interface

   !> Where a row comes from: an effect's file.
   type :: row_source
      procedure(describe), pointer, nopass :: row => null()
   end type row_source

end module poinsot_effect_row
