!> Splittings by name.
module poinsot_splitting_registry
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_e_method
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_core_message, only: printable
   use poinsot_core_nearest, only: suggestion
   use poinsot_splitting_tableaux, only: splitting, splitting_names => scheme_names, &
      numbered_splittings => numbered_names, scheme_count, scheme_row
   implicit none(type, external)
   private
   public :: is_table, splitting_names, splitting_count, splitting_name, find_splitting, &
      numbered_splittings, numbered_count, numbered_splitting, splitting_flows, achieved_order

contains

   !> How many splittings there are.
   pure integer function splitting_count()
      splitting_count = scheme_count
   end function splitting_count

   !> Is splitting i a table of flows that the stepper runs? `taylor` is none.
   pure logical function is_table(i)
      integer, intent(in) :: i
      type(splitting) :: row
      row = scheme_row(i)
      is_table = .not. row%adaptive
   end function is_table

   !> Name of the splitting in row i, 1 to splitting_count, in listed order; "" outside.
   pure function splitting_name(i) result(name)
      integer, intent(in) :: i
      character(:), allocatable :: name
      name = ""
      if (i >= 1 .and. i <= scheme_count) name = trim(splitting_names(i))
   end function splitting_name

   !> The highest public number of a splitting.
   pure integer function numbered_count()
      numbered_count = size(numbered_splittings)
   end function numbered_count

   !> Name of the splitting of public number i, from 1; "" for a number that none has.
   pure function numbered_splitting(i) result(name)
      integer, intent(in) :: i
      character(:), allocatable :: name
      name = ""
      if (i >= 1 .and. i <= size(numbered_splittings)) name = trim(numbered_splittings(i))
   end function numbered_splitting

   !> A splitting by name; POINSOT_E_METHOD, naming the nearest known one, if there is none of that
   !> name.
   pure subroutine find_splitting(name, scheme, error)
      character(*), intent(in) :: name
      type(splitting), intent(out) :: scheme !! its table
      type(poinsot_error), intent(inout) :: error
      integer :: i
      do i = 1, scheme_count
         if (splitting_names(i) /= name) cycle
         scheme = scheme_row(i)
         return
      end do
      call raise(error, poinsot_e_method, "unknown splitting '" // printable(trim(name)) // "'" // &
                 suggestion(name, splitting_names))
   end subroutine find_splitting

   !> One step of a splitting as pairs of flows, for a host that moves more than attitudes and so
   !> runs the step itself: for i = 1, 2, ... a kick over kick(i) h, then a drift over drift(i) h; a
   !> zero is no flow. POINSOT_E_METHOD for an unknown name, and for a splitting that is not kicks
   !> and drifts alone (force gradients, a processor, `taylor`, `baoab`).
   pure subroutine splitting_flows(name, kick, drift, error)
      character(*), intent(in) :: name
      real(dp), allocatable, intent(out) :: kick(:), drift(:)
      type(poinsot_error), intent(inout) :: error
      type(splitting) :: scheme
      integer :: i, n
      call find_splitting(name, scheme, error)
      if (raised(error)) return
      if (scheme%middle > 0) then
         call raise(error, poinsot_e_method, "splitting '" // trim(name) // &
                    "' is kick 1/2, drift 1/2, poinsot_dissipate 1, drift 1/2, kick 1/2")
         return
      end if
      if (scheme%needs_gradient .or. scheme%adaptive .or. size(scheme%enter) > 0) then
         call raise(error, poinsot_e_method, "splitting '" // trim(name) // &
                    "' needs more than kicks and drifts; use 'srkn4' or 'srkn6'")
         return
      end if
      allocate (kick(size(scheme%operations)), drift(size(scheme%operations)), source=0.0_dp)
      n = 1
      do i = 1, size(scheme%operations)
         if (scheme%operations(i)%is_kick) then
            if (i > 1) n = n + 1
            kick(n) = scheme%operations(i)%b
         else
            drift(n) = scheme%operations(i)%b
         end if
      end do
      kick = kick(:n)
      drift = drift(:n)
   end subroutine splitting_flows

   !> Order that a step reaches: the least of scheme, free rotation and effects (0 in any of them:
   !> no limit).
   pure integer function achieved_order(scheme, method, effects) result(order)
      integer, intent(in) :: scheme      !! order of the splitting; 0 for the free rotation alone
      integer, intent(in) :: method      !! order of the free rotation; 0 = exact
      integer, intent(in) :: effects(:)  !! order each effect allows; 0 = any
      integer :: limits(size(effects) + 2)
      limits = [scheme, method, effects]
      order = 0
      if (any(limits > 0)) order = minval(limits, mask=limits > 0)
   end function achieved_order

end module poinsot_splitting_registry
