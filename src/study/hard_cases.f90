!> Bodies that break rotation codes, made here by rule: the same on every machine.
module poinsot_study_hard_cases
   use poinsot_core_kinds, only: dp, i4, i8
   use poinsot_core_order, only: ascending_order
   use poinsot_rotation_random, only: random_uniform
   implicit none(type, external)
   private
   public :: hard_case, kind_names, kind_about, cases_of_kind, make_case

   !> A body, its state, and the time to cross.
   type :: hard_case
      real(dp) :: moments(3) = 1, y(3) = 0, q(4) = [1.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], h = 0
      logical :: with_moments = .true. !! are the moments among the inputs of the condition number
   end type hard_case

   integer, parameter :: cases_of_kind = 8
   integer(i4), parameter :: stream_cases = 0_i4

   !> A kind of body: its name, the seed of its cases (never another's), and what it is.
   type :: kind_of_body
      character(11) :: name
      integer :: seed
      character(70) :: about
   end type kind_of_body

   type(kind_of_body), parameter :: kinds(*) = [ &
      kind_of_body("generic", 1, "three distinct moments, unsorted"), &
      kind_of_body("nearsym", 2, "two moments within 1e-15 .. 1e-3 of each other"), &
      kind_of_body("flat", 3, "one moment the sum of the others"), &
      kind_of_body("nearlinear", 4, "one moment 1e-14 .. 1e-3 of the others"), &
      kind_of_body("linear", 5, "one moment zero"), &
      kind_of_body("sphere", 6, "three equal moments"), &
      kind_of_body("separatrix", 7, "1e-16 .. 1e-2 off the separatrix"), &
      kind_of_body("on-separatr", 8, "on the separatrix, to double precision"), &
      kind_of_body("middle", 9, "about the middle axis, 1e-16 .. 1e-1 off"), &
      kind_of_body("axis", 10, "about a principal axis exactly"), &
      kind_of_body("rest", 11, "no momentum"), &
      kind_of_body("scale", 12, "moments and momenta times 1e-46 .. 1e20"), &
      kind_of_body("units", 13, "the same times 1e-140 .. 1e140, other units of time too"), &
      kind_of_body("wide", 14, "moments over 8 decades, momenta over 12"), &
      kind_of_body("slow", 15, "momenta of 1e-150 .. 1e-100"), &
      kind_of_body("tiny-step", 16, "h |omega| of 1e-160 .. 1e-9"), &
      kind_of_body("backwards", 17, "negative times"), &
      kind_of_body("long", 18, "up to a hundred radians")]

   character(11), parameter :: kind_names(*) = kinds%name
   character(70), parameter :: kind_about(*) = kinds%about

   !> Random numbers of one case, each from the last by counting.
   type :: stream
      integer(i8) :: kind = 0, number = 0, drawn = 0
   end type stream

contains

   !> Case number 1 .. cases_of_kind of kind number `kind`.
   subroutine make_case(kind, number, one)
      integer, intent(in) :: kind, number
      type(hard_case), intent(out) :: one
      type(stream) :: s
      real(dp) :: d(3), top, rate, units
      integer :: j, shift
      s%kind = kinds(kind)%seed
      s%number = number
      do j = 1, 3
         d(j) = 0.1_dp + uniform(s)
         one%y(j) = sign(0.1_dp + uniform(s), uniform(s) - 0.5_dp)
      end do
      top = 20
      units = 1
      call shape_body(trim(kind_names(kind)), s, d, one, top, units)
      rate = 0
      where (one%moments > 0) d = abs(one%y/one%moments)
      where (.not. one%moments > 0) d = 0
      rate = maxval(d)
      one%h = 1
      if (rate > 0) one%h = power(s, merge(-160.0_dp, -2.0_dp, top < 1e-3_dp), log10(top))/rate
      if (kind_names(kind) == "backwards") one%h = -one%h
      one%moments = one%moments*units
      one%y = one%y*units
      do j = 1, 4
         one%q(j) = uniform(s) - 0.5_dp
      end do
      one%q = one%q/norm2(one%q)
      ! any order of the axes
      shift = mod(number, 3)
      one%moments = cshift(one%moments, shift)
      one%y = cshift(one%y, shift)
      if (mod(number/3, 2) == 1) then
         one%moments = one%moments([2, 1, 3])
         one%y = one%y([2, 1, 3])
      end if
   end subroutine make_case

   !> Moments in rising order and the momentum of a kind; top: largest h |omega|; units: of moments
   !> and momenta.
   subroutine shape_body(kind, s, d, one, top, units)
      character(*), intent(in) :: kind
      type(stream), intent(inout) :: s
      real(dp), intent(inout) :: d(3)
      type(hard_case), intent(inout) :: one
      real(dp), intent(inout) :: top, units
      real(dp) :: c(2), small
      integer :: j
      call sort(d)
      select case (kind)
      case ("nearsym")
         small = power(s, -15.0_dp, -3.0_dp)
         if (uniform(s) < 0.5_dp) then
            d(3) = d(2)*(1 + small)
         else
            d(2) = d(1)*(1 + small)
         end if
         one%with_moments = .false.
      case ("flat")
         d(1) = 0
      case ("nearlinear")
         small = power(s, -14.0_dp, -3.0_dp)
         d(1:2) = d(1:2)*small
         one%y(1) = one%y(1)*small
         one%with_moments = .false.
      case ("linear")
         d(1:2) = 0
         one%y(1) = 0
         one%with_moments = .false.
      case ("sphere")
         d = d(1)
      case ("wide")
         do j = 1, 3
            d(j) = power(s, -8.0_dp, 0.0_dp)
            one%y(j) = one%y(j)*power(s, -12.0_dp, 0.0_dp)
         end do
         call sort(d)
         one%with_moments = .false.
      case ("middle")
         one%y(1) = one%y(1)*power(s, -16.0_dp, -1.0_dp)
         one%y(3) = one%y(3)*power(s, -16.0_dp, -1.0_dp)
      case ("axis")
         j = 1 + int(3*uniform(s))
         one%y = merge(one%y, 0.0_dp, [1, 2, 3] == j)
      case ("rest")
         one%y = 0
      case ("scale")
         units = power(s, -46.0_dp, 20.0_dp)
      case ("units")
         units = power(s, -140.0_dp, 140.0_dp)
         one%y = one%y*power(s, -10.0_dp, 10.0_dp)
      case ("slow")
         one%y = one%y*power(s, -150.0_dp, -100.0_dp)
      case ("tiny-step")
         top = 1e-9_dp
      case ("long")
         top = 100
      case default ! generic; the separatrix is made below
      end select
      one%moments = [d(1) + d(2), d(1) + d(3), d(2) + d(3)]
      if (index(kind, "separatr") == 0) return
      c = [one%moments(1)*(one%moments(3) - one%moments(2)), one%moments(3)*(one%moments(2) &
         - one%moments(1))]
      one%y(3) = sign(sqrt(c(2)/c(1))*one%y(1), one%y(3))
      if (kind == "separatrix") one%y(3) = one%y(3)*(1 + power(s, -16.0_dp, -2.0_dp))
   end subroutine shape_body

   pure subroutine sort(d)
      real(dp), intent(inout) :: d(3)
      integer :: order(3)
      real(dp) :: parity
      call ascending_order(d, order, parity)
      d = d(order)
   end subroutine sort

   !> 10**u, u uniform between the two.
   real(dp) function power(s, low, high)
      type(stream), intent(inout) :: s
      real(dp), intent(in) :: low, high
      power = 10.0_dp**(low + (high - low)*uniform(s))
   end function power

   !> The next number of a case, uniform in (0, 1).
   real(dp) function uniform(s)
      type(stream), intent(inout) :: s
      real(dp) :: pair(2)
      s%drawn = s%drawn + 1
      pair = random_uniform(s%kind, s%number, s%drawn, stream_cases)
      uniform = pair(1)
   end function uniform

end module poinsot_study_hard_cases
