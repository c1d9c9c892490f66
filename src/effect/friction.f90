!> Friction of a body, torque = -F omega, as the exact flow that drag and thermostat share.
!>
!> F is diagonal, or a full symmetric matrix: three frictions about axes that are not the principal
!> ones. With z = J^(-1/2) y the flow of ydot = -F J^-1 y is that of the symmetric matrix
!> S = J^(-1/2) F J^(-1/2), and noise sqrt(2 kT F) leaves z with variance kT on every axis.
module poinsot_effect_friction
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_status, only: poinsot_e_domain
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_body_class, only: body_class
   use poinsot_effect_settings, only: setting, effect_info, get_values
   implicit none(type, external)
   private
   public :: get_friction, full_flow, apply_flow, apply_full_each, decay_rate, lost

   real(dp), parameter :: longest_decay = 1e4_dp !! what is left after it is less than any number

contains

   !> One friction or three, none negative; nine are a matrix (column by column) that
   !> poinsot_effect_frame made of three.
   subroutine get_friction(info, settings, friction, full, error)
      type(effect_info), intent(in) :: info    !! the row of the registry
      type(setting), intent(in) :: settings(:) !! checked against the row
      real(dp), intent(out) :: friction(3)     !! about each principal axis
      real(dp), allocatable, intent(out) :: full(:, :) !! (3, 3), allocated if that is not all
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: values(:)
      call get_values(info, settings, "friction", values)
      if (size(values) == 9) then
         full = reshape(values, [3, 3])
         friction = values(1:9:4)
         return
      end if
      friction = values(1)
      if (size(values) == 3) friction = values
      if (size(values) == 2 .or. any(friction < 0)) then
         call raise(error, poinsot_e_domain, "effect '" // trim(info%name) // &
                    "': key 'friction' takes one number or three, none negative")
      end if
   end subroutine get_friction

   !> y(h) = decay y + noise xi of a full matrix. A zero moment has no part in it.
   pure subroutine full_flow(class, full, h, temperature, decay, noise, scale)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: full(3, 3)        !! F, principal frame
      real(dp), intent(in) :: h                 !! positive
      real(dp), intent(in) :: temperature       !! kT
      real(dp), intent(out) :: decay(3, 3), noise(3, 3)
      real(dp), intent(in), optional :: scale   !! moments over those of the class
      real(dp) :: root(3), inverse(3), s(3, 3), v(3, 3), rate
      integer :: i, j, k
      root = sqrt(class%moments)
      inverse = sqrt(class%inverse)
      do j = 1, 3
         s(:, j) = (inverse*full(:, j))*inverse(j)
      end do
      call diagonalise(s, v)
      decay = 0
      do k = 1, 3
         rate = max(s(k, k), 0.0_dp)*h
         if (present(scale)) rate = decay_rate(rate, scale)
         noise(:, k) = sqrt(temperature)*root*v(:, k)*sqrt(lost(rate))
         do j = 1, 3
            do i = 1, 3
               decay(i, j) = decay(i, j) + (root(i)*v(i, k))*exp(-rate)*(v(j, k)*inverse(j))
            end do
         end do
      end do
   end subroutine full_flow

   !> A rate times a time, of a body that is `scale` times as heavy: no more than can be told from
   !> infinite.
   elemental real(dp) function decay_rate(rate, scale)
      real(dp), intent(in) :: rate, scale
      decay_rate = longest_decay
      if (exponent(rate) - exponent(scale) < exponent(longest_decay)) decay_rate = rate/scale
   end function decay_rate

   !> The flow of a full matrix for bodies of one shape and different sizes.
   pure subroutine apply_full_each(class, full, h, temperature, scale, y, xi)
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: full(3, 3)        !! F, principal frame
      real(dp), intent(in) :: h                 !! positive
      real(dp), intent(in) :: temperature       !! kT
      real(dp), intent(in) :: scale(lanes)      !! moments over those of the class
      real(dp), intent(inout) :: y(lanes, 3)
      real(dp), intent(in), optional :: xi(lanes, 3) !! Gaussian numbers, if there is noise
      real(dp) :: decay(3, 3), noise(3, 3)
      integer :: l
      do l = 1, lanes
         call full_flow(class, full, h, temperature, decay, noise, scale(l))
         y(l, :) = matmul(decay, y(l, :))
         if (present(xi)) y(l, :) = y(l, :) + sqrt(scale(l))*matmul(noise, xi(l, :))
      end do
   end subroutine apply_full_each

   !> y = m y, lane by lane.
   pure subroutine apply_flow(m, y)
      real(dp), intent(in) :: m(3, 3)
      real(dp), intent(inout) :: y(lanes, 3)
      real(dp) :: x(lanes, 3)
      integer :: i
      x = y
      do i = 1, 3
         y(:, i) = m(i, 1)*x(:, 1) + m(i, 2)*x(:, 2) + m(i, 3)*x(:, 3)
      end do
   end subroutine apply_flow

   !> 1 - exp(-2 x), 0 for x <= 0; without cancellation for small x.
   elemental real(dp) function lost(x)
      real(dp), intent(in) :: x
      lost = 0
      if (x > 20) then
         lost = 1
      else if (x > 0) then
         lost = 2*exp(-x)*sinh(x)
      end if
   end function lost

   !> Eigenvalues of a symmetric matrix on its diagonal, eigenvectors as columns of v, by Jacobi's
   !> rotations (six sweeps leave nothing of three by three).
   pure subroutine diagonalise(s, v)
      real(dp), intent(inout) :: s(3, 3)
      real(dp), intent(out) :: v(3, 3)
      integer, parameter :: p(3) = [1, 1, 2], q(3) = [2, 3, 3]
      real(dp) :: r(3, 3), t, ratio, cosine
      integer :: sweep, k
      v = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
      do sweep = 1, 6
         do k = 1, 3
            associate (a => s(p(k), p(k)), b => s(q(k), q(k)), c => s(p(k), q(k)))
               if (abs(c) <= 1e-17_dp*(abs(a) + abs(b))) cycle
               ratio = (b/2 - a/2)/c
               t = sign(1.0_dp, ratio)/(abs(ratio) + sqrt(1 + min(abs(ratio), 1e100_dp)**2))
            end associate
            cosine = 1/sqrt(1 + t*t)
            r = reshape([1, 0, 0, 0, 1, 0, 0, 0, 1], [3, 3])
            r(p(k), p(k)) = cosine
            r(q(k), q(k)) = cosine
            r(p(k), q(k)) = t*cosine
            r(q(k), p(k)) = -t*cosine
            s = matmul(transpose(r), matmul(s, r))
            v = matmul(v, r)
         end do
      end do
   end subroutine diagonalise

end module poinsot_effect_friction
