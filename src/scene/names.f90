!> The names allowed in a scene, from the registries: methods, splittings, effects.
module poinsot_scene_names
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_effect_settings, only: effect_info
   use poinsot_effect_registry, only: effect_count, describe_effect
   use poinsot_splitting_registry, only: splitting_count, splitting_name
   use poinsot_free_method, only: free_method, find_method, method_count, method_name
   implicit none(type, external)
   private
   public :: method_list, splitting_list, effect_table, is_exact_method

contains

   !> Names of all methods, and `auto`.
   subroutine method_list(names)
      character(24), allocatable, intent(out) :: names(:)
      integer :: i
      allocate (names(method_count() + 1))
      do i = 1, method_count()
         names(i) = method_name(i)
      end do
      names(method_count() + 1) = "auto"
   end subroutine method_list

   !> Names of all splittings, and `auto`.
   subroutine splitting_list(names)
      character(24), allocatable, intent(out) :: names(:)
      integer :: i
      allocate (names(splitting_count() + 1))
      do i = 1, splitting_count()
         names(i) = splitting_name(i)
      end do
      names(splitting_count() + 1) = "auto"
   end subroutine splitting_list

   !> Every effect a scene can hold, with its keys.
   subroutine effect_table(effects)
      type(effect_info), allocatable, intent(out) :: effects(:)
      integer :: i, n
      allocate (effects(effect_count))
      n = 0
      do i = 1, effect_count
         n = n + 1
         effects(n) = describe_effect(i)
         if (.not. effects(n)%by_name) n = n - 1
      end do
      effects = effects(:n)
   end subroutine effect_table

   !> Is a step of any length right to rounding with this method?
   pure logical function is_exact_method(name)
      character(*), intent(in) :: name
      type(free_method) :: method
      type(poinsot_error) :: error
      call find_method(name, method, error)
      is_exact_method = .false.
      if (.not. raised(error)) is_exact_method = method%order == 0
   end function is_exact_method

end module poinsot_scene_names
