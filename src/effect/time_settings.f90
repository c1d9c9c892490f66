!> Settings `times` and `table` of effects that are tables in time.
module poinsot_effect_time_settings
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_size
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_core_time_table, only: time_table
   use poinsot_effect_settings, only: setting, effect_info, effect_key, number_key, get_values, &
      text_key, was_given
   implicit none(type, external)
   private
   public :: times_key, table_file_key, read_time_table

contains

   !> The key `times`.
   pure function times_key() result(key)
      type(effect_key) :: key
      key = number_key("times", 1, -1, "", "time", &
         "ascending; a repeated time is a jump; constant beyond both ends")
   end function times_key

   !> The key `file`, for scenes: a file of both.
   pure function table_file_key(meaning) result(key)
      character(*), intent(in) :: meaning
      type(effect_key) :: key
      key = text_key("file", "", "", meaning)
      key%is_table = .true.
   end function table_file_key

   !> The table, if settings have one. Errors: POINSOT_E_SIZE, POINSOT_E_DOMAIN.
   subroutine read_time_table(info, settings, table, error)
      type(effect_info), intent(in) :: info        !! the row of the registry
      type(setting), intent(in) :: settings(:)     !! checked against it
      type(time_table), allocatable, intent(out) :: table
      type(poinsot_error), intent(inout) :: error
      type(time_table) :: new
      real(dp), allocatable :: values(:)
      character(:), allocatable :: who
      integer :: n
      who = "effect '" // trim(info%name) // "': "
      if (.not. (was_given(settings, "times") .or. was_given(settings, "table"))) then
         if (was_given(settings, "file")) call raise(error, poinsot_e_domain, who // &
            "key 'file' is for scene files; give 'times' and 'table' instead")
         return
      end if
      call get_values(info, settings, "times", new%times)
      call get_values(info, settings, "table", values)
      n = size(new%times)
      if (n == 0 .or. size(values) /= 3*n) then
         call raise(error, poinsot_e_size, who // &
                    "key 'table' takes three numbers for each number of 'times'")
      else if (any(new%times(2:) < new%times(:n - 1))) then
         call raise(error, poinsot_e_domain, who // "key 'times' must ascend")
      else if (any(.not. new%times(3:) > new%times(:n - 2))) then
         call raise(error, poinsot_e_domain, who // "key 'times' has a time more than twice; " // &
                    "a jump is a time given twice")
      else
         new%values = reshape(values, [3, n])
         new%jumps = any(.not. new%times(2:) > new%times(:n - 1))
         table = new
      end if
   end subroutine read_time_table

end module poinsot_effect_time_settings
