!> Inertia tensors: from point masses, about another point, and reduced to principal axes.
!>
!> A tensor is T = integral of (|x|^2 - x x^T) dm. All computations use numbers near 1 (scaled by a
!> power of two, which is exact), so tensors of 1e-46 and of 1e+150 are equally accurate.
module poinsot_body_inertia
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_size, poinsot_e_convergence
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_rotation_vector, only: cross, unit_vector, identity_matrix, largest_exponent
   use poinsot_body_moments, only: accept_moments, relative_text, moment_tolerance
   implicit none(type, external)
   private
   public :: principal_axes, is_diagonal, point_mass_tensor, parallel_axis, tensor_of_axes

   !> How far a tensor may be from symmetric, relative to its largest entry: what single precision
   !> and
   !> decimals in a file lose.
   real(dp), parameter :: symmetry_tolerance = 1e-6_dp

   !> Eigenvalues of a tensor that count as zero, relative to the largest: either side if its
   !> entries
   !> have few digits, else what rounding and cancelled decimals leave.
   real(dp), parameter :: zero_of_few_digits = 1e-6_dp
   real(dp), parameter :: least_zero = -1e-6_dp, greatest_zero = 1e-10_dp

   !> Binary exponents between which a tensor's largest entry must lie.
   integer, parameter :: least_exponent = -1000, greatest_exponent = 1000

   interface
      !> Of LAPACK, eigenvalues, ascending, and eigenvectors of a symmetric matrix. 8-byte integers
      !> are read right by a library of 4-byte integers too (their lower half comes first), and a
      !> host may have brought one of 8-byte integers; `info`, of which the former writes half, is 0
      !> before the call.
      subroutine dsyev(jobz, uplo, n, a, lda, w, work, lwork, info)
         import :: dp, i8
         implicit none(type, external)
         character(1), intent(in) :: jobz, uplo
         integer(i8), intent(in) :: n, lda, lwork
         real(dp), intent(inout) :: a(lda, *)
         real(dp), intent(out) :: w(*), work(*)
         integer(i8), intent(inout) :: info
      end subroutine dsyev
   end interface

contains

   !> Principal moments and axes of an inertia tensor: tensor = axes diag(moments) transpose(axes).
   !>
   !> Moments ascend. The axes are right-handed and always the same ones: the component of largest
   !> size of the first two is positive; where moments are equal (to 32 eps) and the axes therefore
   !> free, they lie as near the given axes as they can (for three equal moments, they are the given
   !> axes). An attitude Q of the given frame becomes Q axes, that of the principal frame.
   !>
   !> Asymmetry up to 1e-6 of the largest entry is taken as rounding: the mean counts. Entries of a
   !> diagonal tensor are its moments, to the bit. Of any other tensor a moment from -1e-6 to 1e-10
   !> of the largest is zero (to 1e-6 if its entries have few digits: not symmetric, or all of them
   !> single precision), and a largest one that exceeds the sum of the others by round-off becomes
   !> that sum. Then what `accept_moments` says of moments holds.
   subroutine principal_axes(tensor, moments, axes, error, physical)
      real(dp), intent(in) :: tensor(3, 3)        !! symmetric, about the point the body turns
                                                  !! about, any unit
      real(dp), intent(out) :: moments(3)         !! ascending, in the unit of the tensor; 0 if
                                                  !! refused
      real(dp), intent(out) :: axes(3, 3)         !! its columns the principal axes, given frame;
                                                  !! identity if refused
      type(poinsot_error), intent(inout) :: error !! poinsot_e_domain if the tensor is not finite,
                                                  !! not symmetric, or no body's
      logical, intent(in), optional :: physical   !! as of `accept_moments`
      real(dp) :: work(64)
      integer(i8) :: info
      integer :: e
      logical :: diagonal
      moments = 0
      axes = identity_matrix
      call check_tensor(tensor, error)
      if (raised(error)) return
      diagonal = is_diagonal(tensor)
      e = largest_exponent(reshape(tensor, [9]))
      axes = scale(tensor/2 + transpose(tensor)/2, -e)
      info = 0
      call dsyev("V", "U", 3_i8, axes, 3_i8, moments, work, size(work, kind=i8), info)
      if (info == 0) then
         if (.not. diagonal) call clean_moments(has_few_digits(tensor), moments)
         moments = scale(moments, e)
         call accept_moments(moments, error, physical)
      else
         call raise(error, poinsot_e_convergence, "inertia tensor: LAPACK's dsyev did not converge")
      end if
      if (raised(error)) then
         if (info == 0) error%message = "inertia tensor, principal " // error%message
         moments = 0
         axes = identity_matrix
      else
         call resolve_axes(moments, axes)
      end if
   end subroutine principal_axes

   !> Are all entries off the diagonal zero? Then those on it are moments, in the order of the axes.
   pure logical function is_diagonal(tensor)
      real(dp), intent(in) :: tensor(3, 3)
      integer, parameter :: off(6) = [2, 3, 4, 6, 7, 8]
      integer(i8) :: bits(9)
      bits = transfer(tensor, bits)
      is_diagonal = all(iand(bits(off), huge(1_i8)) == 0) ! no comparison with what may be NaN
   end function is_diagonal

   !> Refuse what is not even a symmetric matrix of workable size.
   pure subroutine check_tensor(tensor, error)
      real(dp), intent(in) :: tensor(3, 3)
      type(poinsot_error), intent(inout) :: error
      character(64) :: text
      real(dp) :: largest
      integer :: i, j, e
      if (.not. all(ieee_is_finite(tensor))) then
         call raise(error, poinsot_e_domain, "inertia tensor: an entry is not finite")
         return
      end if
      e = largest_exponent(reshape(tensor, [9]))
      if (maxval(abs(tensor)) <= 0) then
         call raise(error, poinsot_e_domain, &
            "inertia tensor: all entries are zero; a point does not turn")
      else if (e < least_exponent .or. e > greatest_exponent) then
         call raise(error, poinsot_e_domain, &
            "inertia tensor: entries beyond 1e-300 to 1e+300; use other units")
      end if
      if (raised(error)) return
      largest = maxval(abs(tensor))
      do i = 1, 3
         do j = i + 1, 3
            if (abs(tensor(i, j) - tensor(j, i)) <= symmetry_tolerance*largest) cycle
            write (text, "(4(a, i0))") "entries (", i, ",", j, ") and (", j, ",", i
            call raise(error, poinsot_e_domain, "inertia tensor: not symmetric, " // trim(text) // &
               ") differ by " // relative_text(abs(tensor(i, j)/2 - tensor(j, i)/2), largest/2) // &
               " of the largest entry; up to 1e-6 is taken as rounding")
            return
         end do
      end do
   end subroutine check_tensor

   !> Do the entries have few digits: is the tensor not symmetric, or every entry a number of single
   !> precision (24 bits; its exponent may be any)?
   pure logical function has_few_digits(tensor)
      real(dp), intent(in) :: tensor(3, 3)
      integer, parameter :: more_bits = digits(1._dp) - 24
      has_few_digits = maxval(abs(tensor - transpose(tensor))) > 0
      if (.not. has_few_digits) has_few_digits = all(ibits(transfer(tensor, 0_i8, 9), 0, &
                                                           more_bits) == 0)
   end function has_few_digits

   !> Take round-off out of ascending eigenvalues near 1: see `principal_axes`.
   pure subroutine clean_moments(few_digits, moments)
      logical, intent(in) :: few_digits
      real(dp), intent(inout) :: moments(3)
      real(dp) :: least, greatest
      least = least_zero*moments(3)
      greatest = greatest_zero*moments(3)
      if (few_digits) greatest = zero_of_few_digits*moments(3)
      where (moments >= least .and. moments <= greatest) moments = 0
      if (moments(1) <= 0) return
      if (moments(3) - moments(2) > moments(1) .and. &
          moments(3) - moments(2) <= moments(1) + moment_tolerance*moments(3)) then
         moments(3) = moments(1) + moments(2)
      end if
   end subroutine clean_moments

   !> Choose signs, handedness, and axes that are arbitrary because of equal moments.
   pure subroutine resolve_axes(moments, axes)
      real(dp), intent(in) :: moments(3)
      real(dp), intent(inout) :: axes(3, 3)
      logical :: lower_pair, upper_pair
      lower_pair = moments(2) - moments(1) <= moment_tolerance*moments(3)
      upper_pair = moments(3) - moments(2) <= moment_tolerance*moments(3)
      if (lower_pair .and. upper_pair) then
         axes = identity_matrix
         return
      else if (lower_pair) then
         axes(:, 1) = nearest_in_plane(axes(:, 3))
         axes(:, 2) = cross(axes(:, 3), axes(:, 1))
      else if (upper_pair) then
         axes(:, 2) = nearest_in_plane(axes(:, 1))
      end if
      axes(:, 1) = largest_positive(axes(:, 1))
      axes(:, 2) = largest_positive(axes(:, 2))
      axes(:, 3) = unit_vector(cross(axes(:, 1), axes(:, 2)))
   end subroutine resolve_axes

   !> The unit vector normal to n and nearest to one of the given axes: the one most normal to n,
   !> lowest index in a tie.
   pure function nearest_in_plane(n) result(v)
      real(dp), intent(in) :: n(3)
      real(dp) :: v(3)
      integer :: k
      k = 1
      ! a tie is decided with a margin, or round-off would choose between axes
      if (abs(n(2)) < abs(n(k)) - 1e-8_dp) k = 2
      if (abs(n(3)) < abs(n(k)) - 1e-8_dp) k = 3
      v = unit_vector(identity_matrix(:, k) - n(k)*n)
   end function nearest_in_plane

   !> v or -v, whichever has its component of largest size positive (lowest index in a near tie).
   pure function largest_positive(v) result(w)
      real(dp), intent(in) :: v(3)
      real(dp) :: w(3)
      integer :: k
      k = 1
      if (abs(v(2)) > abs(v(k)) + 1e-8_dp) k = 2
      if (abs(v(3)) > abs(v(k)) + 1e-8_dp) k = 3
      w = v
      if (v(k) < 0) w = -v
   end function largest_positive

   !> The tensor that has these moments about these axes: axes diag(moments) transpose(axes).
   pure function tensor_of_axes(moments, axes) result(tensor)
      real(dp), intent(in) :: moments(3) !! principal moments
      real(dp), intent(in) :: axes(3, 3) !! its columns the principal axes
      real(dp) :: tensor(3, 3)
      integer :: i, j
      do j = 1, 3
         do i = 1, 3
            tensor(i, j) = sum(axes(i, :)*moments*axes(j, :))
         end do
      end do
   end function tensor_of_axes

   !> Inertia tensor of point masses about their centre of mass.
   pure subroutine point_mass_tensor(mass, position, tensor, error, total_mass, centre)
      real(dp), intent(in) :: mass(:)                !! masses, zero or positive, not all zero
      real(dp), intent(in) :: position(:, :)         !! (3, size(mass)): where they are
      real(dp), intent(out) :: tensor(3, 3)          !! mass times length squared; 0 if refused
      type(poinsot_error), intent(inout) :: error    !! poinsot_e_size for shapes, poinsot_e_domain
                                                     !! for values
      real(dp), intent(out), optional :: total_mass  !! sum of the masses
      real(dp), intent(out), optional :: centre(3)   !! centre of mass
      real(dp) :: total, middle(3), arm(3)
      integer :: k, em, ex, ea
      tensor = 0
      if (present(total_mass)) total_mass = 0
      if (present(centre)) centre = 0
      call check_masses(mass, position, error)
      if (raised(error)) return
      em = largest_exponent(mass)
      ex = largest_exponent(reshape(position, [size(position)]))
      total = sum(scale(mass, -em))
      middle = matmul(scale(position, -ex), scale(mass, -em))/total ! in units of 2**ex
      ea = largest_exponent([(maxval(abs(scale(position(:, k), -ex) - middle)), k=1, size(mass))])
      do k = 1, size(mass)
         arm = scale(scale(position(:, k), -ex) - middle, -ea)
         tensor = tensor + scale(mass(k), -em)*about_point(arm)
      end do
      if (em + 2*(ex + ea) < least_exponent .or. em + 2*(ex + ea) > greatest_exponent) then
         tensor = 0
         call raise(error, poinsot_e_domain, &
            "point masses: the tensor is beyond 1e-300 to 1e+300; use other units")
         return
      end if
      tensor = scale(tensor, em + 2*(ex + ea))
      if (present(total_mass)) total_mass = scale(total, em)
      if (present(centre)) centre = scale(middle, ex)
   end subroutine point_mass_tensor

   !> Refuse masses and positions that do not make a body.
   pure subroutine check_masses(mass, position, error)
      real(dp), intent(in) :: mass(:), position(:, :)
      type(poinsot_error), intent(inout) :: error
      if (size(mass) < 1 .or. size(position, 1) /= 3 .or. size(position, 2) /= size(mass)) then
         call raise(error, poinsot_e_size, &
            "point masses: need position(3, n) for n masses, n at least 1")
      else if (.not. (all(ieee_is_finite(mass)) .and. all(ieee_is_finite(position)))) then
         call raise(error, poinsot_e_domain, "point masses: a mass or a position is not finite")
      else if (any(mass < 0)) then
         call raise(error, poinsot_e_domain, "point masses: a mass is negative")
      else if (maxval(mass) <= 0) then
         call raise(error, poinsot_e_domain, "point masses: all masses are zero")
      end if
   end subroutine check_masses

   !> The tensor about a point at distance `shift` from the centre of mass (Huygens and Steiner).
   pure function parallel_axis(tensor, mass, shift) result(shifted)
      real(dp), intent(in) :: tensor(3, 3) !! about the centre of mass
      real(dp), intent(in) :: mass         !! of the body; negative to go back to the centre of mass
      real(dp), intent(in) :: shift(3)     !! from the one point to the other
      real(dp) :: shifted(3, 3)
      integer :: e
      ! so that the square of a tiny or huge shift alone does not leave the range
      e = largest_exponent(shift)
      shifted = tensor + scale(mass, 2*e)*about_point(scale(shift, -e))
   end function parallel_axis

   !> |x|^2 - x x^T: the tensor of a unit mass at x.
   pure function about_point(x) result(tensor)
      real(dp), intent(in) :: x(3)
      real(dp) :: tensor(3, 3)
      integer :: i, j
      do j = 1, 3
         do i = 1, 3
            tensor(i, j) = -x(i)*x(j)
         end do
         tensor(j, j) = x(modulo(j, 3) + 1)**2 + x(modulo(j + 1, 3) + 1)**2
      end do
   end function about_point

end module poinsot_body_inertia
