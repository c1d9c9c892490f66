!> The names a scene may use, taken from the registries: methods, splittings, effects.
module poinsot_scene_names
   use poinsot_effect_settings, only: effect_info
   use poinsot_effect_gravity, only: describe_gravity
   use poinsot_effect_field, only: describe_field
   use poinsot_effect_spring, only: describe_spring
   use poinsot_effect_gravity_gradient, only: describe_gravity_gradient
   implicit none(type, external)
   private
   public :: method_list, splitting_list, effect_table, is_exact_method

contains

   !> Names of all methods.
   subroutine method_list(names)
      character(24), allocatable, intent(out) :: names(:)
      character(24) :: dmv
      integer :: order
      names = [character(24) :: "exact", "jacobi"]
      do order = 2, 24, 2
         write (dmv, "(a, i0)") "dmv", order
         names = [names, dmv]
      end do
      names = [character(24) :: names, "midpoint", "three-rotations", "symmetric-rotation", "rattle"]
   end subroutine method_list

   !> Names of all splittings, and `auto`.
   subroutine splitting_list(names)
      character(24), allocatable, intent(out) :: names(:)
      names = [character(24) :: "strang", "forest-ruth", "suzuki4", "yoshida6", "mclachlan4", &
               "srkn4", "srkn6", "chin4", "omelyan4", "omelyan6", "omelyan8", "auto"]
   end subroutine splitting_list

   !> Every effect with its keys.
   subroutine effect_table(effects)
      type(effect_info), allocatable, intent(out) :: effects(:)
      allocate (effects(4))
      effects(1) = describe_gravity()
      effects(2) = describe_field()
      effects(3) = describe_gravity_gradient()
      effects(4) = describe_spring()
   end subroutine effect_table

   !> Is a step of any length right to rounding with this method?
   pure logical function is_exact_method(name)
      character(*), intent(in) :: name
      is_exact_method = name == "exact" .or. name == "jacobi"
   end function is_exact_method

end module poinsot_scene_names
