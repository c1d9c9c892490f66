!> Approximate rotation matrices: tests, and the nearest rotation.
module poinsot_rotation_nearest
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_convergence
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_rotation_vector, only: identity_matrix, determinant, largest_exponent
   implicit none(type, external)
   private
   public :: check_rotation, nearest_rotation

   !> How far transpose(Q) Q may be from the identity: the square of what a quaternion's norm may be
   !> off (1e-6).
   real(dp), parameter :: orthogonal_tolerance = 4e-6_dp

   interface
      !> Of LAPACK, singular value decomposition A = U diag(s) V^T. 8-byte integers are read right
      !> by a library of 4-byte integers too (their lower half comes first), and a host may have
      !> brought one of 8-byte integers; `info`, of which the former writes half, is 0 before the
      !> call.
      subroutine dgesvd(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork, info)
         import :: dp, i8
         implicit none(type, external)
         character(1), intent(in) :: jobu, jobvt
         integer(i8), intent(in) :: m, n, lda, ldu, ldvt, lwork
         real(dp), intent(inout) :: a(lda, *)
         real(dp), intent(out) :: s(*), u(ldu, *), vt(ldvt, *), work(*)
         integer(i8), intent(inout) :: info
      end subroutine dgesvd
   end interface

contains

   !> Refuse a matrix that is no rotation: not finite, columns not orthonormal to within 4e-6, or a
   !> reflection.
   pure subroutine check_rotation(matrix, error)
      real(dp), intent(in) :: matrix(3, 3)        !! body to space
      type(poinsot_error), intent(inout) :: error !! poinsot_e_domain
      real(dp) :: defect
      if (.not. all(ieee_is_finite(matrix))) then
         call raise(error, poinsot_e_domain, "rotation matrix: an entry is not finite")
         return
      end if
      defect = huge(defect)
      if (maxval(abs(matrix)) < 2) then
         defect = maxval(abs(matmul(transpose(matrix), matrix) - identity_matrix))
      end if
      if (.not. defect <= orthogonal_tolerance) then
         call raise(error, poinsot_e_domain, &
            "rotation matrix: its columns are not orthonormal to within "// &
            "4e-6; nearest_rotation repairs a noisy one")
      else if (determinant(matrix) < 0) then
         call raise(error, poinsot_e_domain, "rotation matrix: determinant -1, a reflection; "// &
            "change the sign of one column for right-handed axes")
      end if
   end subroutine check_rotation

   !> The rotation nearest to a matrix (least sum of squared differences, determinant +1): U diag(1,
   !> 1, +-1) V^T from the singular value decomposition (W. Kabsch, Acta Cryst. A32, 922, 1976; G.
   !> Wahba's problem).
   subroutine nearest_rotation(matrix, rotation, error)
      real(dp), intent(in) :: matrix(3, 3)        !! a multiple of a noisy rotation, any scale
      real(dp), intent(out) :: rotation(3, 3)     !! orthogonal to rounding; the identity if refused
      type(poinsot_error), intent(inout) :: error !! poinsot_e_domain if not finite, or if there is
                                                  !! no nearest one (rank below 2, or the tie of
                                                  !! a reflection)
      real(dp) :: a(3, 3), s(3), u(3, 3), vt(3, 3), work(64), handed
      integer(i8) :: info
      rotation = identity_matrix
      if (.not. all(ieee_is_finite(matrix))) then
         call raise(error, poinsot_e_domain, &
            "nearest_rotation: an entry of the matrix is not finite")
         return
      end if
      a = scale(matrix, -largest_exponent(reshape(matrix, [9])))
      info = 0
      call dgesvd("A", "A", 3_i8, 3_i8, a, 3_i8, s, u, 3_i8, vt, 3_i8, work, size(work, kind=i8), &
         info)
      if (info /= 0) then
         call raise(error, poinsot_e_convergence, &
            "nearest_rotation: LAPACK's dgesvd did not converge")
         return
      end if
      handed = sign(1._dp, determinant(u)*determinant(vt))
      if (s(2) + handed*s(3) <= 64*epsilon(1._dp)*s(1)) then
         call raise(error, poinsot_e_domain, "nearest_rotation: no rotation is nearest "// &
            "(rank below 2, or a reflection); the matrix must be near a multiple of a rotation")
         return
      end if
      u(:, 3) = handed*u(:, 3)
      rotation = matmul(u, vt)
   end subroutine nearest_rotation

end module poinsot_rotation_nearest
