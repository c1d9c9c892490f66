!> Splittings as data: one row per scheme. T a is a free rotation over a h; K b c adds b h g + c h^3
!> G to y (g the body torque, G its force gradient, mathematics.md section 6). Flows are applied
!> left to right.
!>
!> All schemes are symmetric, so a row holds the left half of the coefficients, the middle one last;
!> T and K alternate. Those of Blanes and Moan, Chin, and Omelyan, Mryglod and Folk use that the
!> kinetic energy is quadratic in y: [U, [U, [U, T]]] = 0. A new scheme is one row in `scheme_row`
!> and its place in the count.
module poinsot_splitting_tableaux
   use poinsot_core_kinds, only: dp, qp
   implicit none(type, external)
   private
   public :: splitting, operation, scheme_count, scheme_names, scheme_row, free_scheme, &
      turn_composition

   !> One flow of a scheme.
   type :: operation
      logical :: is_kick = .false.
      real(dp) :: b = 0       !! length in units of h: of the free rotation, or of the kick
      real(dp) :: c = 0       !! force gradient of a kick in units of h^3
      real(dp) :: node = 0     !! when, in units of h: the sum of rotations before it
   end type operation

   !> One scheme with its ancestry.
   type :: splitting
      character(18) :: name = ""
      character(40) :: author = ""
      integer :: year = 0
      integer :: order = 0                  !! with processor: the effective order
      integer :: stages = 0 !! free rotations per step, those at both ends counted as one
      logical :: symmetric = .true.
      logical :: needs_gradient = .false.
      logical :: adaptive = .false.         !! no table: a Taylor series to a tolerance
      character(56) :: paper = ""
      type(operation), allocatable :: operations(:)
      type(operation), allocatable :: enter(:)   !! at the start: state to kernel's variables
      type(operation), allocatable :: leave(:)   !! at output: kernel's variables to state
   end type splitting

   !> Names of the rows, in their order.
   character(18), parameter :: scheme_names(*) = [character(18) :: &
      "strang", "forest-ruth", "suzuki4", "yoshida6", "mclachlan4", "srkn4", "srkn6", "chin4", &
      "omelyan4", "omelyan6", "omelyan8", "takahashi-imada", "taylor"]
   integer, parameter :: scheme_count = size(scheme_names)

contains

   !> Row i, 1 to scheme_count.
   pure function scheme_row(i) result(row)
      integer, intent(in) :: i
      type(splitting) :: row
      select case (i)
      case (1)
         row = splitting("strang", "Strang", 1968, 2, paper="SIAM J. Numer. Anal. 5, 506")
         call fill_row(row, "K", [0.5_dp, 1.0_dp])
      case (2)
         row = splitting("forest-ruth", "Forest, Ruth; Yoshida", 1990, 4, paper="Physica D 43, 105")
         call fill_row(row, "K", [0.67560359597982881702_dp, 1.351207191959657634_dp, &
            -0.17560359597982881702_dp, -1.7024143839193152681_dp])
      case (3)
         row = splitting("suzuki4", "Suzuki", 1990, 4, paper="Phys. Lett. A 146, 319")
         call fill_row(row, "K", [0.20724538589718786857_dp, 0.41449077179437573714_dp, &
            0.41449077179437573714_dp, 0.41449077179437573714_dp, -0.12173615769156360571_dp, &
            -0.65796308717750294857_dp])
      case (4)
         row = splitting("yoshida6", "Yoshida", 1990, 6, paper="Phys. Lett. A 150, 262, solution A")
         call fill_row(row, "K", [0.39225680523877863191_dp, 0.78451361047755726382_dp, &
            0.51004341191845769875_dp, 0.23557321335935813368_dp, -0.47105338540975643664_dp, &
            -1.17767998417887100695_dp, 0.06875316825252010598_dp, 1.31518632068391121889_dp])
      case (5)
         row = splitting("mclachlan4", "McLachlan", 1995, 4, paper="SIAM J. Sci. Comput. 16, 151")
         call fill_row(row, "K", [0.089269454226475244887_dp, 0.4_dp, -0.097336042636895508015_dp, &
            -0.1_dp, 0.50806658841042026313_dp, 0.4_dp])
      case (6)
         row = splitting("srkn4", "Blanes, Moan", 2002, 4, &
            paper="J. Comput. Appl. Math. 142, 313, SRKN 6b")
         call fill_row(row, "K", [0.0829844064174052_dp, 0.245298957184271_dp, &
            0.396309801498368_dp, &
            0.60487266571108_dp, -0.0390563049223486_dp, -0.350171622895351_dp, &
            0.1195241940131508_dp])
      case (7)
         row = splitting("srkn6", "Blanes, Moan", 2002, 6, &
            paper="J. Comput. Appl. Math. 142, 313, SRKN 14a")
         call fill_row(row, "T", [0.0378593198406116_dp, 0.09171915262446165_dp, &
            0.102635633102435_dp, &
            0.183983170005006_dp, -0.0258678882665587_dp, -0.05653436583288827_dp, &
            0.314241403071447_dp, &
            0.004914688774712854_dp, -0.130144459517415_dp, 0.143761127168358_dp, &
            0.106417700369543_dp, &
            0.328567693746804_dp, -0.00879424312851058_dp, -0.196411466486454234_dp, &
            0.20730506905689536_dp])
      case (8)
         row = splitting("chin4", "Chin", 1997, 4, paper="Phys. Lett. A 226, 344, 4A; the review's")
         call fill_row(row, "K", [0.16666666666666666667_dp, 0.5_dp, 0.66666666666666666667_dp], &
            [0.0_dp, 0.0_dp, 0.013888888888888888889_dp])
      case (9)
         row = splitting("omelyan4", "Omelyan, Mryglod, Folk", 2003, 4, &
                         paper="Comput. Phys. Commun. 151, 272, 3F2G velocity")
         call fill_row(row, "K", [0.087893686016807062458_dp, 0.2813980611667719_dp, &
            0.41210631398319293754_dp, 0.4372038776664562_dp], &
            [0.0_dp, 0.0_dp, 0.0030618101223697702906_dp, 0.0_dp])
      case (10)
         row = splitting("omelyan6", "Omelyan, Mryglod, Folk", 2003, 6, &
                         paper="Comput. Phys. Commun. 151, 272, 5F3G position")
         call fill_row(row, "T", [0.1097059723948682_dp, 0.2693315848935301_dp, &
            0.4140632267310831_dp, &
            1.1319803486515564_dp, -0.0237691991259513_dp, -1.802623867090173_dp], &
            [0.0_dp, 0.0008642161339706166_dp, 0.0_dp, 0.0_dp, 0.0_dp, -0.01324638643416052_dp])
      case (11)
         row = splitting("omelyan8", "Omelyan, Mryglod, Folk", 2003, 8, &
                         paper="Comput. Phys. Commun. 151, 272, 11F11G position")
         call fill_row(row, "T", [0.41009674738801111929_dp, 0.0048249309817414952913_dp, &
            -0.34123345756052780489_dp, 0.17492394861090375603_dp, 0.25644714021068150492_dp, &
            0.29304366370957066164_dp, 0.27765273975812438394_dp, 0.047448940168459770284_dp, &
            -0.56926266869753773903_dp, -0.0015299863411743974499_dp, 0.46629949890124853577_dp, &
            -0.037422994259002571607_dp], &
            [0.0_dp, 0.00014743936907797528365_dp, 0.0_dp, 0.00023288450531932545357_dp, 0.0_dp, &
            0.0061648659635535962498_dp, 0.0_dp, -0.012307516860831240717_dp, 0.0_dp, &
            -0.000073296648559126385387_dp, 0.0_dp, 0.015295860994523744732_dp])
      case (12)
         row = splitting("takahashi-imada", "Takahashi, Imada; Blanes, Casas, Ros", 1984, 4, &
                         paper="J. Phys. Soc. Jpn. 53, 3765; Appl. Num. Math. 39, 245")
         call fill_row(row, "T", [0.5_dp, 1.0_dp], [0.0_dp, 1.0_dp/24.0_dp])
         call add_processor(row)
      case (13)
         row = splitting("taylor", "Jorba, Zou", 2005, adaptive=.true., &
                         paper="Exp. Math. 14, 99; in two precisions")
         allocate (row%operations(0), row%enter(0), row%leave(0))
      case default
         row = free_scheme()
      end select
   end function scheme_row

   !> Operations of a symmetric row from its left half.
   pure subroutine fill_row(row, first, half, gradients)
      type(splitting), intent(inout) :: row
      character, intent(in) :: first                  !! "T" or "K": the first flow
      real(dp), intent(in) :: half(:)                 !! coefficients, the middle one last
      real(dp), intent(in), optional :: gradients(:)  !! c of each, zero for a rotation
      real(dp) :: c(size(half))
      integer :: n
      n = size(half)
      c = 0
      if (present(gradients)) c = gradients
      row%operations = alternating(first, [half, half(n - 1:1:-1)], [c, c(n - 1:1:-1)])
      row%stages = min(count(row%operations%is_kick), count(.not. row%operations%is_kick))
      row%needs_gradient = any(abs(c) > 0)
      allocate (row%enter(0), row%leave(0))
   end subroutine fill_row

   !> T and K in turn. Nodes are summed in quadruple precision, and one that closes the step is
   !> exactly 1: the torque at the end of a step is then the torque at the start of the next, to the
   !> bit.
   pure function alternating(first, b, c) result(operations)
      character, intent(in) :: first
      real(dp), intent(in) :: b(:), c(:)
      type(operation) :: operations(size(b))
      real(qp) :: node
      integer :: i
      node = 0
      do i = 1, size(b)
         operations(i)%is_kick = (first == "K") .eqv. (mod(i, 2) == 1)
         operations(i)%b = b(i)
         operations(i)%c = c(i)
         operations(i)%node = real(node, dp)
         if (abs(node - 1) < 1e-13_qp .and. i == size(b)) operations(i)%node = 1
         if (.not. operations(i)%is_kick) node = node + b(i)
      end do
   end function alternating

   !> Processor of the Takahashi-Imada kernel. The kernel is exp(h (T + U) - h^3/24 [T + U, [T, U]]
   !> + O(h^5)), so the flow of h^2/24 [T, U] takes its solution to one of order 4. Here that flow
   !> and the two terms of h^4 that leave the smallest error of order 5 (-1/640 [T,T,T,U] - 1/1152
   !> [U,T,T,U]) are composed from rotations and kicks; the coefficients solve the order conditions
   !> with the least sum of squares.
   pure subroutine add_processor(row)
      type(splitting), intent(inout) :: row
      real(dp), parameter :: b(*) = [ &
         0.11804257670960278_dp, -0.0862006645713153_dp, 0.24702625764338573_dp, &
         0.245074981924611_dp, &
         0.20795405485274107_dp, -0.13290448562578844_dp, -0.25694324274260005_dp, &
         0.12189993888971454_dp, &
         -0.3160796464631296_dp, -0.1478697706172218_dp]
      deallocate (row%enter, row%leave)
      row%leave = alternating("T", b, 0*b)
      row%enter = alternating("K", -b(size(b):1:-1), 0*b)
   end subroutine add_processor

   !> The scheme of a body without torque: one free rotation, no kick. Its order is the method's.
   pure function free_scheme() result(row)
      type(splitting) :: row
      row = splitting("free", "Euler", 1758, 0, 1, paper="the free rotation itself")
      row%operations = [operation(.false., 1.0_dp)]
      allocate (row%enter(0), row%leave(0))
   end function free_scheme

   !> Weights of a symmetric composition of "turn 1/2, rotate 1, turn 1/2" for the drift of a
   !> gyrostat: the smallest of orders 2, 4, 6 and 8 that reaches `order`. Suzuki 1990; Kahan and Li
   !> 1997 (9 stages); Suzuki and Umeno 1993, McLachlan 1995 (15 stages).
   pure subroutine turn_composition(order, weights)
      integer, intent(in) :: order
      real(dp), allocatable, intent(out) :: weights(:)
      real(dp), parameter :: w4(*) = [0.41449077179437573714_dp, 0.41449077179437573714_dp, &
         -0.65796308717750294857_dp]
      real(dp), parameter :: w6(*) = [0.39216144400731413927925056_dp, &
         0.33259913678935943859974864_dp, &
         -0.70624617255763935980996482_dp, 0.08221359629355080023149045_dp, &
         0.79854399093482996339895035_dp]
      real(dp), parameter :: w8(*) = [0.74167036435061295344822780_dp, &
         -0.40910082580003159399730010_dp, &
         0.19075471029623837995387626_dp, -0.57386247111608226665638773_dp, &
         0.29906418130365592384446354_dp, &
         0.33462491824529818378495798_dp, 0.31529309239676659663205666_dp, &
         -0.79688793935291635401978884_dp]
      select case (order)
      case (:2)
         weights = [1.0_dp]
      case (3:4)
         weights = [w4, w4(2:1:-1)]
      case (5:6)
         weights = [w6, w6(4:1:-1)]
      case default
         weights = [w8, w8(7:1:-1)]
      end select
   end subroutine turn_composition

end module poinsot_splitting_tableaux
