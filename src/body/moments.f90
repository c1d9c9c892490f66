!> Principal moments of inertia: tests whether they are physical, and the kind of body.
!>
!> Moments are I_1 = d_2 + d_3 and so on with d_k the integral of x_k^2 dm (Vilmart's review,
!> equation 2), so none exceeds the sum of the other two. All tests are relative to the largest
!> moment: SI molecules have I near 1e-46.
module poinsot_body_moments
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_status, only: poinsot_e_domain
   use poinsot_core_error, only: poinsot_error, raise, raised
   implicit none(type, external)
   private
   public :: accept_moments, check_moments, relative_text, kind_of_body, kind_name, describe_body
   public :: is_flat, symmetry_axis, mass_spread, ascending_order
   public :: moment_tolerance
   public :: kind_at_rest, kind_spherical, kind_symmetric, kind_asymmetric, kind_flat, kind_linear

   !> Kinds of body. A flat symmetric body (a disc) is `kind_symmetric`, with `is_flat` true.
   integer, parameter :: kind_at_rest = 0    !! no angular momentum: any body, nothing to do
   integer, parameter :: kind_spherical = 1  !! three equal moments
   integer, parameter :: kind_symmetric = 2  !! two equal moments
   integer, parameter :: kind_asymmetric = 3 !! three different moments
   integer, parameter :: kind_flat = 4       !! three different moments, the largest the sum of the
                                             !! others
   integer, parameter :: kind_linear = 5     !! one moment zero, the other two equal

   !> What counts as round-off in moments, relative to the largest: sums of decimals and LAPACK's
   !> eigenvalues stay within.
   real(dp), parameter :: moment_tolerance = 32*epsilon(1._dp)

   !> By how much, relative to itself, a largest moment may exceed the sum of the others: moments
   !> with
   !> three digits.
   real(dp), parameter :: triangle_slack = 1e-3_dp

   !> A moment up to this, relative to the largest, is that of a body as thin as a line.
   real(dp), parameter :: thin_body = 1e-10_dp

contains

   !> Accept rounded moments: refuse those that no rigid body has, and make equal the two beside a
   !> zero moment if they differ only by rounding. The only rule for moments, whatever their source.
   !>
   !> Beside a zero moment the other two become their mean if they differ by up to 1e-5: a linear
   !> body. (With more, up to where they are refused, Euler's equations have no solution, and the
   !> mean
   !> is what remains; beside one of less than 1e-10 their difference turns the body about its line
   !> as
   !> no body turns.) A largest moment may exceed the sum of the others by 1e-3 of itself and is
   !> used
   !> as it is: Euler's equations do not need the inequality. No other moment is changed by a bit.
   pure subroutine accept_moments(moments, error, physical)
      real(dp), intent(inout) :: moments(3)       !! principal moments, any order, any unit
      type(poinsot_error), intent(inout) :: error !! poinsot_e_domain says which moment, by how much
                                                  !! it is off, what is allowed
      logical, intent(in), optional :: physical   !! .false.: any that are zero or positive
      real(dp) :: excess
      integer :: order(3)
      call check_each(moments, error)
      if (raised(error)) return
      order = ascending_order(moments)
      associate (small => moments(order(1)), middle => moments(order(2)), &
                 large => moments(order(3)))
         excess = large - middle - small
         if (must_be_physical(physical)) then
            call check_body(moments, order(3), middle, excess, error)
         end if
         if (raised(error) .or. middle <= 0 .or. small > thin_body*large) return
         if (small > 0 .and. excess <= moment_tolerance*large) return
         middle = middle + (large - middle)/2
         large = middle
      end associate
   end subroutine accept_moments

   !> Are these moments accepted?
   pure subroutine check_moments(moments, error, physical)
      real(dp), intent(in) :: moments(3)          !! principal moments, any order, any unit
      type(poinsot_error), intent(inout) :: error !! as of `accept_moments`
      logical, intent(in), optional :: physical   !! as of `accept_moments`
      real(dp) :: accepted(3)
      accepted = moments
      call accept_moments(accepted, error, physical)
   end subroutine check_moments

   !> Refuse numbers that cannot be moments.
   pure subroutine check_each(moments, error)
      real(dp), intent(in) :: moments(3)
      type(poinsot_error), intent(inout) :: error
      integer :: i
      do i = 1, 3
         if (.not. ieee_is_finite(moments(i))) then
            call refuse(moments, i, error, "is not finite")
            return
         end if
      end do
      do i = 1, 3
         if (moments(i) < 0) then
            call refuse(moments, i, error, "is negative, by " // &
               relative_text(-moments(i), maxval(abs(moments))) // &
               " of the largest; a moment is zero or positive")
            return
         else if (moments(i) > 0 .and. moments(i) < tiny(1._dp)) then
            call refuse(moments, i, error, "is too small: its inverse overflows; use larger units")
            return
         end if
      end do
   end subroutine check_each

   !> Refuse moments that no mass distribution has; `largest` is the index of the largest.
   pure subroutine check_body(moments, largest, middle, excess, error)
      real(dp), intent(in) :: moments(3), middle, excess
      integer, intent(in) :: largest
      type(poinsot_error), intent(inout) :: error
      associate (large => moments(largest))
         if (large <= 0) then
            call raise(error, poinsot_e_domain, &
               "moments of inertia: all are zero; a point does not turn")
         else if (middle <= 0) then
            call refuse(moments, largest, error, &
               "is the only one that is not zero; a linear body has two equal ones")
         else if (excess > (triangle_slack + moment_tolerance)*large) then
            call refuse(moments, largest, error, "exceeds the sum of the other two by " // &
               relative_text(excess, large) // " of itself; up to 1e-3 is taken as rounding, " // &
               "and more if moments need not be physical")
         end if
      end associate
   end subroutine check_body

   pure logical function must_be_physical(physical)
      logical, intent(in), optional :: physical
      must_be_physical = .true.
      if (present(physical)) must_be_physical = physical
   end function must_be_physical

   !> A ratio with three digits, for messages: "2.83e-02".
   pure function relative_text(part, whole) result(text)
      real(dp), intent(in) :: part   !! finite, not above `whole`
      real(dp), intent(in) :: whole  !! positive
      character(:), allocatable :: text
      character(9) :: digits
      real(dp) :: ratio
      ratio = part/whole
      if (abs(ratio) < 1e-99_dp) ratio = 0
      write (digits, "(es9.2e2)") ratio
      text = trim(adjustl(digits))
      if (index(text, "E") > 0) text(index(text, "E"):index(text, "E")) = "e"
   end function relative_text

   !> Raise a refusal that shows all moments, names moment i and gives the reason.
   pure subroutine refuse(moments, i, error, reason)
      real(dp), intent(in) :: moments(3)
      integer, intent(in) :: i
      type(poinsot_error), intent(inout) :: error
      character(*), intent(in) :: reason
      call raise(error, poinsot_e_domain, "moments of inertia (" // brief(moments(1)) // ", " // &
                 brief(moments(2)) // ", " // brief(moments(3)) // "): I" // &
                 achar(iachar("0") + i) // " " // reason)
   end subroutine refuse

   !> A number in few digits if they are all of it, else in all of them.
   pure function brief(number) result(text)
      real(dp), intent(in) :: number
      character(:), allocatable :: text
      character(24) :: digits
      real(dp) :: back
      integer :: code
      write (digits, "(es24.16e3)") number
      text = trim(adjustl(digits))
      if (.not. ieee_is_finite(number)) return
      write (digits, "(g0.6)") number
      read (digits, *, iostat=code) back
      if (code /= 0) return
      if (transfer(back, 0_i8) /= transfer(number, 0_i8)) return
      text = trim(adjustl(digits))
      if (scan(text, "Ee") > 0 .or. index(text, ".") == 0) return
      do while (text(len(text):) == "0" .and. text(len(text) - 1:len(text) - 1) /= ".")
         text = text(:len(text) - 1)
      end do
   end function brief

   !> Indices of the moments from smallest to largest; equal ones keep their order.
   pure function ascending_order(moments) result(order)
      real(dp), intent(in) :: moments(3) !! finite
      integer :: order(3)
      order = [1, 2, 3]
      if (moments(order(2)) < moments(order(1))) order([1, 2]) = order([2, 1])
      if (moments(order(3)) < moments(order(2))) order([2, 3]) = order([3, 2])
      if (moments(order(2)) < moments(order(1))) order([1, 2]) = order([2, 1])
   end function ascending_order

   !> The kind of body, a `kind_...` value. `kind_at_rest` only when a zero y is given.
   pure integer function kind_of_body(moments, y, tolerance)
      real(dp), intent(in) :: moments(3)             !! as `check_moments` allows
      real(dp), intent(in), optional :: y(3)         !! angular momentum, body frame
      real(dp), intent(in), optional :: tolerance    !! relative to the largest moment; default 32
                                                     !! eps
      integer :: order(3)
      real(dp) :: allowed
      if (present(y)) then
         if (maxval(abs(y)) <= 0) then
            kind_of_body = kind_at_rest
            return
         end if
      end if
      order = ascending_order(moments)
      associate (small => moments(order(1)), middle => moments(order(2)), &
                 large => moments(order(3)))
         allowed = large*relative(tolerance)
         if (small <= 0) then
            kind_of_body = kind_linear
         else if (large - small <= allowed) then
            kind_of_body = kind_spherical
         else if (middle - small <= allowed .or. large - middle <= allowed) then
            kind_of_body = kind_symmetric
         else if (is_flat(moments, tolerance)) then
            kind_of_body = kind_flat
         else
            kind_of_body = kind_asymmetric
         end if
      end associate
   end function kind_of_body

   !> Is the body flat (or a line): is the largest moment the sum of the others?
   pure logical function is_flat(moments, tolerance)
      real(dp), intent(in) :: moments(3)          !! as `check_moments` allows
      real(dp), intent(in), optional :: tolerance !! relative to the largest moment; default 32 eps
      integer :: order(3)
      order = ascending_order(moments)
      associate (small => moments(order(1)), middle => moments(order(2)), &
                 large => moments(order(3)))
         is_flat = abs(small - (large - middle)) <= large*relative(tolerance)
      end associate
   end function is_flat

   !> The axis of a symmetric or linear body: the one whose moment differs from the two equal ones.
   !> 0 if the moments are all different or all equal.
   pure integer function symmetry_axis(moments, tolerance)
      real(dp), intent(in) :: moments(3)          !! as `check_moments` allows
      real(dp), intent(in), optional :: tolerance !! relative to the largest moment; default 32 eps
      integer :: order(3)
      logical :: lower_pair, upper_pair
      order = ascending_order(moments)
      associate (small => moments(order(1)), middle => moments(order(2)), &
                 large => moments(order(3)))
         lower_pair = middle - small <= large*relative(tolerance)
         upper_pair = large - middle <= large*relative(tolerance)
      end associate
      symmetry_axis = 0
      if (lower_pair .and. .not. upper_pair) symmetry_axis = order(3)
      if (upper_pair .and. .not. lower_pair) symmetry_axis = order(1)
   end function symmetry_axis

   !> The word for a kind; "unknown" for any other number.
   pure function kind_name(kind) result(name)
      integer, intent(in) :: kind !! a kind_... value
      character(:), allocatable :: name
      select case (kind)
      case (kind_at_rest)
         name = "at rest"
      case (kind_spherical)
         name = "spherical"
      case (kind_symmetric)
         name = "symmetric"
      case (kind_asymmetric)
         name = "asymmetric"
      case (kind_flat)
         name = "flat"
      case (kind_linear)
         name = "linear"
      case default
         name = "unknown"
      end select
   end function kind_name

   !> The kind in words, with its axis: "symmetric about axis 3, flat".
   pure function describe_body(moments, y) result(text)
      real(dp), intent(in) :: moments(3)     !! as `check_moments` allows
      real(dp), intent(in), optional :: y(3) !! angular momentum, body frame
      character(:), allocatable :: text
      integer :: kind, axis
      kind = kind_of_body(moments, y)
      axis = symmetry_axis(moments)
      text = kind_name(kind)
      if (kind == kind_symmetric) text = text//" about axis "//achar(iachar("0") + axis)
      if (kind == kind_symmetric .and. is_flat(moments)) text = text//", flat"
      if (kind == kind_linear) text = text//" along axis "//achar(iachar("0") + axis)
   end function describe_body

   !> The review's d_k = integral of x_k^2 dm = (I_i + I_j - I_k)/2 (its equation 2): zero for the
   !> normal of a flat body and across a linear one. Round-off below zero comes out as zero.
   pure function mass_spread(moments) result(d)
      real(dp), intent(in) :: moments(3) !! as `check_moments` allows
      real(dp) :: d(3)
      integer :: order(3)
      order = ascending_order(moments)
      associate (small => moments(order(1)), middle => moments(order(2)), &
                 large => moments(order(3)))
         ! large - middle is exact (it is at most 2 middle), so nothing is lost where the sum nearly
         ! cancels
         d(order(1)) = middle/2 + (large - small)/2
         d(order(2)) = (large - middle)/2 + small/2
         d(order(3)) = max(small - (large - middle), 0._dp)/2
      end associate
   end function mass_spread

   !> The tolerance asked for, or the usual one.
   pure real(dp) function relative(tolerance)
      real(dp), intent(in), optional :: tolerance
      relative = moment_tolerance
      if (present(tolerance)) relative = tolerance
   end function relative

end module poinsot_body_moments
