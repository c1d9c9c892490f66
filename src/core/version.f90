!> The version.
module poinsot_core_version
   implicit none(type, external)
   private
   public :: version_number, version_text

   integer, parameter :: major = 0, minor = 2, patch = 0
   !> The value of poinsot_version().
   integer, parameter :: version_number = 10000*major + 100*minor + patch
   !> The same as text.
   character(*), parameter :: version_text = "0.2.0"
end module poinsot_core_version
