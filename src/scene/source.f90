!> The contents of a scene file after scanning, before they are interpreted.
module poinsot_scene_source
   use poinsot_core_kinds, only: dp
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_core_message, only: from_option, place
   use poinsot_core_status, only: poinsot_e_scene
   implicit none(type, external)
   private
   public :: scene_value, scene_entry, scene_group, scene_source
   public :: value_null, value_number, value_logical, value_text
   public :: from_option
   public :: append, place, reject, find_group, find_groups

   integer, parameter :: value_null = 0, value_number = 1, value_logical = 2, value_text = 3

   !> One value as written, `repeats` times (Fortran's `3*0.0`; a null value leaves the default).
   type :: scene_value
      integer :: kind = value_null
      integer :: repeats = 1
      real(dp) :: number = 0
      logical :: flag = .false.
      character(:), allocatable :: text !! as written; of a string, what is between its quotes
   end type scene_value

   !> `key(first) = values`, or `key(first:last) = values`
   type :: scene_entry
      character(:), allocatable :: key !! lower case
      integer :: line = 0
      integer :: first = 1             !! subscript of the first value
      integer :: last = huge(1)        !! of the last that a section has room for
      logical :: subscripted = .false.
      integer :: count = 0             !! how many of `values` are in use
      type(scene_value), allocatable :: values(:)
   end type scene_entry

   !> `&name entries /`
   type :: scene_group
      character(:), allocatable :: name !! lower case, without the ampersand
      integer :: line = 0
      integer :: count = 0              !! how many of `entries` are in use
      type(scene_entry), allocatable :: entries(:)
   end type scene_group

   !> A whole file.
   type :: scene_source
      character(:), allocatable :: file !! as named by the user, for messages
      character(:), allocatable :: head !! the comment that it begins with, without its marks
      integer :: count = 0              !! how many of `groups` are in use
      type(scene_group), allocatable :: groups(:)
   end type scene_source

   !> Put a value, an entry or a group at the end of a list that grows by doubling.
   interface append
      module procedure append_value, append_entry, append_group
   end interface append

contains

   subroutine append_value(entry, item)
      type(scene_entry), intent(inout) :: entry
      type(scene_value), intent(in) :: item
      type(scene_value), allocatable :: more(:)
      if (.not. allocated(entry%values)) allocate (entry%values(4))
      if (entry%count == size(entry%values)) then
         allocate (more(2*entry%count))
         more(:entry%count) = entry%values
         call move_alloc(more, entry%values)
      end if
      entry%count = entry%count + 1
      entry%values(entry%count) = item
   end subroutine append_value

   subroutine append_entry(group, item)
      type(scene_group), intent(inout) :: group
      type(scene_entry), intent(in) :: item
      type(scene_entry), allocatable :: more(:)
      if (.not. allocated(group%entries)) allocate (group%entries(8))
      if (group%count == size(group%entries)) then
         allocate (more(2*group%count))
         more(:group%count) = group%entries
         call move_alloc(more, group%entries)
      end if
      group%count = group%count + 1
      group%entries(group%count) = item
   end subroutine append_entry

   subroutine append_group(source, item)
      type(scene_source), intent(inout) :: source
      type(scene_group), intent(in) :: item
      type(scene_group), allocatable :: more(:)
      if (.not. allocated(source%groups)) allocate (source%groups(8))
      if (source%count == size(source%groups)) then
         allocate (more(2*source%count))
         more(:source%count) = source%groups
         call move_alloc(more, source%groups)
      end if
      source%count = source%count + 1
      source%groups(source%count) = item
   end subroutine append_group

   !> Places of all groups of that name in the source, in its order.
   pure function find_groups(source, name) result(places)
      type(scene_source), intent(in) :: source !! the scanned file
      character(*), intent(in) :: name         !! lower case
      integer, allocatable :: places(:)
      integer :: i, n
      allocate (places(source%count))
      n = 0
      do i = 1, source%count
         if (source%groups(i)%name /= name) cycle
         n = n + 1
         places(n) = i
      end do
      places = places(:n)
   end function find_groups

   !> Place of the n-th group of that name in the source, 0 if there is none.
   pure integer function find_group(source, name, nth)
      type(scene_source), intent(in) :: source !! the scanned file
      character(*), intent(in) :: name         !! lower case
      integer, intent(in), optional :: nth     !! counted from 1 (default)
      integer :: i, left
      left = 1
      if (present(nth)) left = nth
      find_group = 0
      do i = 1, source%count
         if (source%groups(i)%name /= name) cycle
         left = left - 1
         if (left == 0) find_group = i
         if (left == 0) return
      end do
   end function find_group

   !> Raise POINSOT_E_SCENE with the place in front.
   pure subroutine reject(error, file, line, message)
      type(poinsot_error), intent(inout) :: error
      character(*), intent(in) :: file      !! its name
      integer, intent(in) :: line           !! 0: the file as a whole
      character(*), intent(in) :: message   !! what is wrong and what would be right
      call raise(error, poinsot_e_scene, place(file, line) // message)
   end subroutine reject

end module poinsot_scene_source
