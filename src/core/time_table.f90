!> Three numbers as a table in time: linear between its times, constant beyond both ends; a time
!> that is given twice is a jump.
module poinsot_core_time_table
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: time_table, time_table_list

   !> The table; at a jump, the value after it.
   type :: time_table
      real(dp), allocatable :: times(:)       !! (n), ascending, none more than twice
      real(dp), allocatable :: values(:, :)   !! (3, n)
      logical :: jumps = .false.              !! a time stands twice
   contains
      procedure :: at
      procedure :: seen
   end type time_table

   !> Tables whose numbers add up.
   type :: time_table_list
      type(time_table), allocatable :: item(:)
   contains
      procedure :: append
      procedure :: sum_at
      procedure :: bound
   end type time_table_list

contains

   !> The numbers at time t.
   pure function at(self, t) result(value)
      class(time_table), intent(in) :: self
      real(dp), intent(in) :: t
      real(dp) :: value(3), part
      integer :: low, n
      n = size(self%times)
      if (t < self%times(1)) then
         value = self%values(:, 1)
      else if (t >= self%times(n)) then
         value = self%values(:, n)
      else
         low = last_until(self%times, t)
         part = (t - self%times(low))/(self%times(low + 1) - self%times(low))
         value = self%values(:, low) + part*(self%values(:, low + 1) - self%values(:, low))
      end if
   end function at

   !> The time at which one sees the table who stands at t and looks ahead: t itself, but of a jump
   !> that is no further than |ahead|, the side where t + ahead lies. Who steps from jump to jump
   !> is at its times to rounding only.
   pure real(dp) function seen(self, t, ahead)
      class(time_table), intent(in) :: self
      real(dp), intent(in) :: t
      real(dp), intent(in) :: ahead           !! forwards positive, backwards negative; 0: at t
      integer :: k
      seen = t
      if (.not. self%jumps .or. .not. abs(ahead) > 0) return
      k = last_until(self%times, max(t, t + ahead)) ! of the times up to there only the last is near
      if (k < 2) return
      if (self%times(k) > self%times(k - 1) .or. self%times(k) < min(t, t + ahead)) return
      seen = self%times(k)
      if (ahead < 0) seen = nearest(seen, -1.0_dp)
      if (ahead > 0) seen = max(t, seen)
      if (ahead < 0) seen = min(t, seen)
   end function seen

   !> One more table. (No array constructor: of structures that own arrays gfortran 12 loses some.)
   subroutine append(self, table)
      class(time_table_list), intent(inout) :: self
      type(time_table), intent(in) :: table
      type(time_table), allocatable :: more(:)
      integer :: i, n
      n = 0
      if (allocated(self%item)) n = size(self%item)
      allocate (more(n + 1))
      do i = 1, n
         more(i) = self%item(i)
      end do
      more(n + 1) = table
      call move_alloc(more, self%item)
   end subroutine append

   !> Their sum at time t, looking ahead (seen).
   pure function sum_at(self, t, ahead) result(value)
      class(time_table_list), intent(in) :: self
      real(dp), intent(in) :: t, ahead
      real(dp) :: value(3)
      integer :: i
      value = 0
      if (.not. allocated(self%item)) return
      do i = 1, size(self%item)
         value = value + self%item(i)%at(self%item(i)%seen(t, ahead))
      end do
   end function sum_at

   !> No component of the sum is ever larger.
   pure function bound(self) result(value)
      class(time_table_list), intent(in) :: self
      real(dp) :: value(3)
      integer :: i
      value = 0
      if (.not. allocated(self%item)) return
      do i = 1, size(self%item)
         value = value + maxval(abs(self%item(i)%values), dim=2)
      end do
   end function bound

   !> The last of ascending times that is not beyond t; 0 if all are.
   pure integer function last_until(times, t) result(low)
      real(dp), intent(in) :: times(:)
      real(dp), intent(in) :: t
      integer :: high, middle
      low = 0
      high = size(times) + 1
      do while (high - low > 1)
         middle = (low + high)/2
         if (t < times(middle)) then
            high = middle
         else
            low = middle
         end if
      end do
   end function last_until

end module poinsot_core_time_table
