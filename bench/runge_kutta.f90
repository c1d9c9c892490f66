!> General-purpose rivals for the table of `make bench`: explicit Runge-Kutta methods of fixed step
!> on (y, q), seven equations a body, y' = y x omega, q' = q o (0, omega)/2.
!>
!> Classical order 4, and DOP853 of order 8 (E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary
!> Differential Equations I, 2nd ed., 1993, section II.5; its published coefficients). Each twice:
!> as scalar code writes it, body after body, and with as many bodies as fill vector registers.
module bench_runge_kutta
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: rk4_scalar, dop853_scalar, rk4_vector, dop853_vector, tableau

   ! bodies side by side in the vector form (8, 16 and 64 are slower)
   integer, parameter :: width = 32
   integer, parameter :: m = 7*width

   ! DOP853: rows of the tableau without their zeros, then the weights
   real(dp), parameter :: a2(1) = [ &
      5.26001519587677318785587544488e-2_dp]
   real(dp), parameter :: a3(2) = [ &
      1.97250569845378994544595329183e-2_dp, 5.91751709536136983633785987549e-2_dp]
   real(dp), parameter :: a4(2) = [ &
      2.95875854768068491816892993775e-2_dp, 8.87627564304205475450678981324e-2_dp]
   real(dp), parameter :: a5(3) = [ &
      2.41365134159266685502369798665e-1_dp, -8.84549479328286085344864962717e-1_dp, &
      9.24834003261792003115737966543e-1_dp]
   real(dp), parameter :: a6(3) = [ &
      3.7037037037037037037037037037e-2_dp, 1.70828608729473871279604482173e-1_dp, &
      1.25467687566822425016691814123e-1_dp]
   real(dp), parameter :: a7(4) = [ &
      3.7109375e-2_dp, 1.70252211019544039314978060272e-1_dp, &
      6.02165389804559606850219397283e-2_dp, -1.7578125e-2_dp]
   real(dp), parameter :: a8(5) = [ &
      3.70920001185047927108779319836e-2_dp, 1.70383925712239993810214054705e-1_dp, &
      1.07262030446373284651809199168e-1_dp, -1.53194377486244017527936158236e-2_dp, &
      8.27378916381402288758473766002e-3_dp]
   real(dp), parameter :: a9(6) = [ &
      6.24110958716075717114429577812e-1_dp, -3.36089262944694129406857109825e0_dp, &
      -8.68219346841726006818189891453e-1_dp, 2.75920996994467083049415600797e1_dp, &
      2.01540675504778934086186788979e1_dp, -4.34898841810699588477366255144e1_dp]
   real(dp), parameter :: a10(7) = [ &
      4.77662536438264365890433908527e-1_dp, -2.48811461997166764192642586468e0_dp, &
      -5.90290826836842996371446475743e-1_dp, 2.12300514481811942347288949897e1_dp, &
      1.52792336328824235832596922938e1_dp, -3.32882109689848629194453265587e1_dp, &
      -2.03312017085086261358222928593e-2_dp]
   real(dp), parameter :: a11(8) = [ &
      -9.3714243008598732571704021658e-1_dp, 5.18637242884406370830023853209e0_dp, &
      1.09143734899672957818500254654e0_dp, -8.14978701074692612513997267357e0_dp, &
      -1.85200656599969598641566180701e1_dp, 2.27394870993505042818970056734e1_dp, &
      2.49360555267965238987089396762e0_dp, -3.0467644718982195003823669022e0_dp]
   real(dp), parameter :: a12(9) = [ &
      2.27331014751653820792359768449e0_dp, -1.05344954667372501984066689879e1_dp, &
      -2.00087205822486249909675718444e0_dp, -1.79589318631187989172765950534e1_dp, &
      2.79488845294199600508499808837e1_dp, -2.85899827713502369474065508674e0_dp, &
      -8.87285693353062954433549289258e0_dp, 1.23605671757943030647266201528e1_dp, &
      6.43392746015763530355970484046e-1_dp]
   real(dp), parameter :: b(8) = [ &
      5.42937341165687622380535766363e-2_dp, 4.45031289275240888144113950566e0_dp, &
      1.89151789931450038304281599044e0_dp, -5.8012039600105847814672114227e0_dp, &
      3.1116436695781989440891606237e-1_dp, -1.52160949662516078556178806805e-1_dp, &
      2.01365400804030348374776537501e-1_dp, 4.47106157277725905176885569043e-2_dp]

contains

   !> Classical Runge-Kutta, scalar.
   subroutine rk4_scalar(moments, h, steps, y, q)
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(:, :), q(:, :)   !! (3, n), (4, n)
      real(dp) :: x(7), k(7, 4), inverse(3)
      integer :: i, s
      inverse = 1/moments
      do i = 1, size(q, 2)
         x = [y(:, i), q(:, i)]
         do s = 1, steps
            call slope(inverse, x, k(:, 1))
            call slope(inverse, x + (h/2)*k(:, 1), k(:, 2))
            call slope(inverse, x + (h/2)*k(:, 2), k(:, 3))
            call slope(inverse, x + h*k(:, 3), k(:, 4))
            x = x + (h/6)*(k(:, 1) + 2*(k(:, 2) + k(:, 3)) + k(:, 4))
         end do
         y(:, i) = x(1:3)
         q(:, i) = x(4:7)
      end do
   end subroutine rk4_scalar

   !> DOP853, scalar: the loop over the tableau that a general-purpose code has.
   subroutine dop853_scalar(moments, h, steps, y, q)
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(:, :), q(:, :)
      real(dp) :: x(7), z(7), k(7, 12), inverse(3), a(12, 2:13)
      integer :: i, s, r, j
      inverse = 1/moments
      call tableau(a)
      do i = 1, size(q, 2)
         x = [y(:, i), q(:, i)]
         do s = 1, steps
            call slope(inverse, x, k(:, 1))
            do r = 2, 13
               z = x
               do j = 1, r - 1
                  if (abs(a(j, r)) > 0) z = z + (h*a(j, r))*k(:, j)
               end do
               if (r < 13) call slope(inverse, z, k(:, r))
            end do
            x = z
         end do
         y(:, i) = x(1:3)
         q(:, i) = x(4:7)
      end do
   end subroutine dop853_scalar

   !> Classical Runge-Kutta, `width` bodies side by side.
   subroutine rk4_vector(moments, h, steps, y, q)
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(:, :), q(:, :)
      real(dp) :: z(m), x(m), k(m, 4), inverse(3)
      integer :: i, s
      inverse = 1/moments
      do i = 1, size(q, 2), width
         call load(i, y, q, z)
         do s = 1, steps
            call slopes(inverse, z, k(:, 1))
            x = z + (h/2)*k(:, 1)
            call slopes(inverse, x, k(:, 2))
            x = z + (h/2)*k(:, 2)
            call slopes(inverse, x, k(:, 3))
            x = z + h*k(:, 3)
            call slopes(inverse, x, k(:, 4))
            z = z + (h/6)*(k(:, 1) + 2*(k(:, 2) + k(:, 3)) + k(:, 4))
         end do
         call store(i, z, y, q)
      end do
   end subroutine rk4_vector

   !> DOP853, `width` bodies side by side.
   subroutine dop853_vector(moments, h, steps, y, q)
      real(dp), intent(in) :: moments(3), h
      integer, intent(in) :: steps
      real(dp), intent(inout) :: y(:, :), q(:, :)
      real(dp) :: z(m), x(m), k(m, 12), inverse(3)
      integer :: i, s
      inverse = 1/moments
      do i = 1, size(q, 2), width
         call load(i, y, q, z)
         do s = 1, steps
            call slopes(inverse, z, k(:, 1))
            x = z + h*(a2(1)*k(:, 1))
            call slopes(inverse, x, k(:, 2))
            x = z + h*(a3(1)*k(:, 1) + a3(2)*k(:, 2))
            call slopes(inverse, x, k(:, 3))
            x = z + h*(a4(1)*k(:, 1) + a4(2)*k(:, 3))
            call slopes(inverse, x, k(:, 4))
            x = z + h*(a5(1)*k(:, 1) + a5(2)*k(:, 3) + a5(3)*k(:, 4))
            call slopes(inverse, x, k(:, 5))
            x = z + h*(a6(1)*k(:, 1) + a6(2)*k(:, 4) + a6(3)*k(:, 5))
            call slopes(inverse, x, k(:, 6))
            x = z + h*(a7(1)*k(:, 1) + a7(2)*k(:, 4) + a7(3)*k(:, 5) + a7(4)*k(:, 6))
            call slopes(inverse, x, k(:, 7))
            x = z + h*(a8(1)*k(:, 1) + a8(2)*k(:, 4) + a8(3)*k(:, 5) + a8(4)*k(:, 6) &
               + a8(5)*k(:, 7))
            call slopes(inverse, x, k(:, 8))
            x = z + h*(a9(1)*k(:, 1) + a9(2)*k(:, 4) + a9(3)*k(:, 5) + a9(4)*k(:, 6) &
               + a9(5)*k(:, 7) + a9(6)*k(:, 8))
            call slopes(inverse, x, k(:, 9))
            x = z + h*(a10(1)*k(:, 1) + a10(2)*k(:, 4) + a10(3)*k(:, 5) + a10(4)*k(:, 6) &
               + a10(5)*k(:, 7) + a10(6)*k(:, 8) + a10(7)*k(:, 9))
            call slopes(inverse, x, k(:, 10))
            x = z + h*(a11(1)*k(:, 1) + a11(2)*k(:, 4) + a11(3)*k(:, 5) + a11(4)*k(:, 6) &
               + a11(5)*k(:, 7) + a11(6)*k(:, 8) + a11(7)*k(:, 9) + a11(8)*k(:, 10))
            call slopes(inverse, x, k(:, 11))
            x = z + h*(a12(1)*k(:, 1) + a12(2)*k(:, 4) + a12(3)*k(:, 5) + a12(4)*k(:, 6) &
               + a12(5)*k(:, 7) + a12(6)*k(:, 8) + a12(7)*k(:, 9) + a12(8)*k(:, 10) &
               + a12(9)*k(:, 11))
            call slopes(inverse, x, k(:, 12))
            z = z + h*(b(1)*k(:, 1) + b(2)*k(:, 6) + b(3)*k(:, 7) + b(4)*k(:, 8) + b(5)*k(:, 9) &
               + b(6)*k(:, 10) + b(7)*k(:, 11) + b(8)*k(:, 12))
         end do
         call store(i, z, y, q)
      end do
   end subroutine dop853_vector

   !> Right side for one body.
   pure subroutine slope(inverse, x, f)
      real(dp), intent(in) :: inverse(3), x(7)
      real(dp), intent(out) :: f(7)
      real(dp) :: w(3)
      w = x(1:3)*inverse
      f(1) = x(2)*w(3) - x(3)*w(2)
      f(2) = x(3)*w(1) - x(1)*w(3)
      f(3) = x(1)*w(2) - x(2)*w(1)
      w = 0.5_dp*w
      f(4) = -x(5)*w(1) - x(6)*w(2) - x(7)*w(3)
      f(5) = x(4)*w(1) + x(6)*w(3) - x(7)*w(2)
      f(6) = x(4)*w(2) + x(7)*w(1) - x(5)*w(3)
      f(7) = x(4)*w(3) + x(5)*w(2) - x(6)*w(1)
   end subroutine slope

   !> Right side for `width` bodies.
   pure subroutine slopes(inverse, x, f)
      real(dp), intent(in) :: inverse(3), x(width, 7)
      real(dp), intent(out) :: f(width, 7)
      real(dp) :: w1, w2, w3
      integer :: l
      !GCC$ ivdep
      do l = 1, width
         w1 = x(l, 1)*inverse(1)
         w2 = x(l, 2)*inverse(2)
         w3 = x(l, 3)*inverse(3)
         f(l, 1) = x(l, 2)*w3 - x(l, 3)*w2
         f(l, 2) = x(l, 3)*w1 - x(l, 1)*w3
         f(l, 3) = x(l, 1)*w2 - x(l, 2)*w1
         w1 = 0.5_dp*w1
         w2 = 0.5_dp*w2
         w3 = 0.5_dp*w3
         f(l, 4) = -x(l, 5)*w1 - x(l, 6)*w2 - x(l, 7)*w3
         f(l, 5) = x(l, 4)*w1 + x(l, 6)*w3 - x(l, 7)*w2
         f(l, 6) = x(l, 4)*w2 + x(l, 7)*w1 - x(l, 5)*w3
         f(l, 7) = x(l, 4)*w3 + x(l, 5)*w2 - x(l, 6)*w1
      end do
   end subroutine slopes

   !> Bodies i, i+1, ... side by side; the last ones of a group that is not full stand still.
   subroutine load(i, y, q, z)
      integer, intent(in) :: i
      real(dp), intent(in) :: y(:, :), q(:, :)
      real(dp), intent(out) :: z(width, 7)
      integer :: l
      z = 0
      do l = 1, min(width, size(q, 2) - i + 1)
         z(l, 1:3) = y(:, i + l - 1)
         z(l, 4:7) = q(:, i + l - 1)
      end do
   end subroutine load

   subroutine store(i, z, y, q)
      integer, intent(in) :: i
      real(dp), intent(in) :: z(width, 7)
      real(dp), intent(inout) :: y(:, :), q(:, :)
      integer :: l
      do l = 1, min(width, size(q, 2) - i + 1)
         y(:, i + l - 1) = z(l, 1:3)
         q(:, i + l - 1) = z(l, 4:7)
      end do
   end subroutine store

   !> The tableau of DOP853 with its zeros, one row of it a column here.
   pure subroutine tableau(a)
      real(dp), intent(out) :: a(12, 2:13)
      a = 0
      a([1], 2) = a2
      a([1, 2], 3) = a3
      a([1, 3], 4) = a4
      a([1, 3, 4], 5) = a5
      a([1, 4, 5], 6) = a6
      a([1, 4, 5, 6], 7) = a7
      a([1, 4, 5, 6, 7], 8) = a8
      a([1, 4, 5, 6, 7, 8], 9) = a9
      a([1, 4, 5, 6, 7, 8, 9], 10) = a10
      a([1, 4, 5, 6, 7, 8, 9, 10], 11) = a11
      a([1, 4, 5, 6, 7, 8, 9, 10, 11], 12) = a12
      a([1, 6, 7, 8, 9, 10, 11, 12], 13) = b
   end subroutine tableau

end module bench_runge_kutta
