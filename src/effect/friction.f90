!> Friction of a body, torque = -F omega, as the exact flow used by drag and thermostat.
!>
!> F is diagonal, or a full symmetric matrix: three frictions about axes that are not the principal
!> ones. With z = J^(-1/2) y the flow of ydot = -F J^-1 y is that of the symmetric matrix S =
!> J^(-1/2) F J^(-1/2), and noise sqrt(2 kT F) gives z the variance kT on every axis. A rate is S
!> itself: F = J^(1/2) S J^(1/2), on principal axes rate I.
module poinsot_effect_friction
   use poinsot_core_kinds, only: dp, lanes
   use poinsot_core_status, only: poinsot_e_domain
   use poinsot_core_error, only: poinsot_error, raise
   use poinsot_body_class, only: body_class
   use poinsot_effect_settings, only: setting, effect_info, effect_key, get_values, was_given, &
      number_key, per_axis
   implicit none(type, external)
   private
   public :: friction_law, friction_keys, get_friction, apply_full, lost

   real(dp), parameter :: longest_decay = 1e4_dp !! what is left after it is less than any number

   !> What a user said.
   type :: friction_law
      real(dp) :: values(3) = 0           !! about each principal axis
      real(dp), allocatable :: full(:, :) !! (3, 3), principal frame, allocated if that is not all
      logical :: by_rate = .false.        !! S; else F
   contains
      procedure :: decay
      procedure :: decay_each
      procedure :: symmetric
      procedure :: matrix
   end type friction_law

contains

   !> The two keys of which one is given.
   pure function friction_keys(what) result(keys)
      character(*), intent(in) :: what    !! "drag", "friction"
      type(effect_key) :: keys(2)
      keys(1) = number_key("friction", 1, 3, "required", "torque per angular velocity", &
                           what // ", one for all axes or one per body axis; or give rate", &
                           per_axis)
      keys(2) = number_key("rate", 1, 3, "", "1/time", &
                           "instead of friction: friction = rate I", per_axis)
      keys(2)%instead_of = "friction"
   end function friction_keys

   !> Exponents of the decay over h about each principal axis: friction h/I. About an axis without
   !> inertia 0.
   pure function decay(self, class, h) result(x)
      class(friction_law), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h                 !! positive
      real(dp) :: x(3)
      integer :: j
      x = 0
      do j = 1, 3
         if (.not. self%by_rate) then
            x(j) = self%values(j)*class%inverse(j)*h
         else if (class%inverse(j) > 0) then
            x(j) = self%values(j)*h
         end if
      end do
   end function decay

   !> The same about axis j for bodies that are `scale` times as heavy as their class.
   pure function decay_each(self, class, h, j, scale) result(x)
      class(friction_law), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp), intent(in) :: h
      integer, intent(in) :: j
      real(dp), intent(in) :: scale(lanes)
      real(dp) :: x(lanes), all(3)
      all = self%decay(class, h)
      x = all(j)
      if (.not. self%by_rate) x = decay_rate(all(j), scale)
   end function decay_each

   !> S of a full matrix.
   pure function symmetric(self, class) result(s)
      class(friction_law), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp) :: s(3, 3), inverse(3)
      integer :: j
      inverse = sqrt(class%inverse)
      if (self%by_rate) inverse = merge(1.0_dp, 0.0_dp, class%inverse > 0)
      do j = 1, 3
         s(:, j) = (inverse*self%full(:, j))*inverse(j)
      end do
   end function symmetric

   !> F as a matrix.
   pure function matrix(self, class) result(f)
      class(friction_law), intent(in) :: self
      type(body_class), intent(in) :: class
      real(dp) :: f(3, 3), root(3)
      integer :: j
      f = 0
      if (allocated(self%full)) then
         f = self%full
      else
         do j = 1, 3
            f(j, j) = self%values(j)
         end do
      end if
      if (.not. self%by_rate) return
      root = sqrt(class%moments)
      do j = 1, 3
         f(:, j) = (root*f(:, j))*root(j)
      end do
   end function matrix

   !> One number or three of either key, none negative; nine are a matrix (column by column) that
   !> poinsot_effect_frame made of three.
   subroutine get_friction(info, settings, law, error)
      type(effect_info), intent(in) :: info    !! the row of the registry
      type(setting), intent(in) :: settings(:) !! checked against the row
      type(friction_law), intent(out) :: law
      type(poinsot_error), intent(inout) :: error
      real(dp), allocatable :: values(:)
      character(:), allocatable :: key
      law%by_rate = was_given(settings, "rate")
      key = "friction"
      if (law%by_rate) key = "rate"
      call get_values(info, settings, key, values)
      if (size(values) == 9) then
         law%full = reshape(values, [3, 3])
         law%values = values(1:9:4)
         return
      end if
      law%values = values(1)
      if (size(values) == 3) law%values = values
      if (size(values) == 2 .or. any(law%values < 0)) then
         call raise(error, poinsot_e_domain, "effect '" // trim(info%name) // &
                    "': key '" // key // "' takes one number or three, none negative")
      end if
   end subroutine get_friction

   !> What the flow of a full matrix is made of: y = sum of left(:, k) a_k, a_k = right(:, k).y, and
   !> each a_k decays at a rate of its own. A zero moment has no part in it.
   pure subroutine find_modes(class, law, rates, left, right)
      type(body_class), intent(in) :: class
      type(friction_law), intent(in) :: law     !! with a full matrix
      real(dp), intent(out) :: rates(3), left(3, 3), right(3, 3)
      real(dp) :: s(3, 3), v(3, 3)
      integer :: k
      s = law%symmetric(class)
      call diagonalise(s, v)
      do k = 1, 3
         rates(k) = max(s(k, k), 0.0_dp)
         left(:, k) = sqrt(class%moments)*v(:, k)
         right(:, k) = sqrt(class%inverse)*v(:, k)
      end do
   end subroutine find_modes

   !> y(h) = y - loss y + noise xi of a full matrix. What is lost in a step is small: so its
   !> rounding is that of the change, not that of y.
   pure subroutine full_flow(rates, left, right, temperature, loss, noise)
      real(dp), intent(in) :: rates(3)          !! times the step
      real(dp), intent(in) :: left(3, 3), right(3, 3)
      real(dp), intent(in) :: temperature       !! kT
      real(dp), intent(out) :: loss(3, 3), noise(3, 3)
      real(dp) :: taken(3)
      integer :: j, k
      do k = 1, 3
         noise(:, k) = sqrt(temperature)*left(:, k)*sqrt(lost(rates(k)))
         taken(k) = lost(0.5_dp*rates(k))
      end do
      do j = 1, 3
         loss(:, j) = left(:, 1)*(taken(1)*right(j, 1)) + left(:, 2)*(taken(2)*right(j, 2)) &
            + left(:, 3)*(taken(3)*right(j, 3))
      end do
   end subroutine full_flow

   !> The flow of a full matrix for the bodies of a block, of one size or of different ones.
   pure subroutine apply_full(class, law, h, temperature, y, xi, scale)
      type(body_class), intent(in) :: class
      type(friction_law), intent(in) :: law     !! with a full matrix
      real(dp), intent(in) :: h                 !! positive
      real(dp), intent(in) :: temperature       !! kT
      real(dp), intent(inout) :: y(lanes, 3)
      real(dp), intent(in), optional :: xi(lanes, 3)   !! Gaussian numbers, if there is noise
      real(dp), intent(in), optional :: scale(lanes)   !! moments over those of the class
      real(dp) :: rates(3), left(3, 3), right(3, 3), loss(3, 3), noise(3, 3), before(lanes, 3)
      integer :: i
      call find_modes(class, law, rates, left, right)
      if (present(scale)) then
         call apply_full_each(law, h*rates, left, right, temperature, scale, y, xi)
         return
      end if
      call full_flow(h*rates, left, right, temperature, loss, noise)
      before = y
      do i = 1, 3
         y(:, i) = y(:, i) - (loss(i, 1)*before(:, 1) + loss(i, 2)*before(:, 2) &
                              + loss(i, 3)*before(:, 3))
         if (present(xi)) y(:, i) = y(:, i) + (noise(i, 1)*xi(:, 1) + noise(i, 2)*xi(:, 2) &
                                               + noise(i, 3)*xi(:, 3))
      end do
   end subroutine apply_full

   !> The same for bodies of one shape and different sizes.
   pure subroutine apply_full_each(law, rates, left, right, temperature, scale, y, xi)
      type(friction_law), intent(in) :: law
      real(dp), intent(in) :: rates(3)          !! of the class, times the step
      real(dp), intent(in) :: left(3, 3), right(3, 3)
      real(dp), intent(in) :: temperature       !! kT
      real(dp), intent(in) :: scale(lanes)
      real(dp), intent(inout) :: y(lanes, 3)
      real(dp), intent(in), optional :: xi(lanes, 3)
      real(dp) :: own(3), loss(3, 3), noise(3, 3)
      integer :: l
      do l = 1, lanes
         own = rates
         if (.not. law%by_rate) own = decay_rate(rates, scale(l))
         call full_flow(own, left, right, temperature, loss, noise)
         y(l, :) = y(l, :) - matmul(loss, y(l, :))
         if (present(xi)) y(l, :) = y(l, :) + sqrt(scale(l))*matmul(noise, xi(l, :))
      end do
   end subroutine apply_full_each

   !> A rate times a time, of a body that is `scale` times as heavy: no more than can be told from
   !> infinite.
   elemental real(dp) function decay_rate(rate, scale)
      real(dp), intent(in) :: rate, scale
      decay_rate = longest_decay
      if (exponent(rate) - exponent(scale) < exponent(longest_decay)) decay_rate = rate/scale
   end function decay_rate

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
