!> Splittings as data: one row per scheme. T a is a free rotation over a h; K b c adds b h g + c h^3
!> G to y (g the body torque, G its force gradient, mathematics.md section 6). Flows are applied
!> left to right.
!>
!> All schemes are symmetric, so a row has the left half of the coefficients, the middle one last; T
!> and K alternate. Those of Blanes and Moan, Chin, and Omelyan, Mryglod and Folk use that the
!> kinetic energy is quadratic in y: [U, [U, [U, T]]] = 0. A new scheme is one row of `rows`, at any
!> position, with the next free number: users see rows in their order, programs by number.
module poinsot_splitting_tableaux
   use poinsot_core_kinds, only: dp, qp, name_length
   implicit none(type, external)
   private
   public :: splitting, operation, scheme_count, scheme_names, numbered_names, scheme_row, &
      free_scheme, turn_composition

   !> One flow of a scheme.
   type :: operation
      logical :: is_kick = .false.
      real(dp) :: b = 0       !! length in units of h: of the free rotation, or of the kick
      real(dp) :: c = 0       !! force gradient of a kick in units of h^3
      real(dp) :: node = 0     !! when, in units of h: the sum of rotations before it
   end type operation

   !> One scheme with its ancestry.
   type :: splitting
      character(name_length) :: name = ""
      integer :: number = 0                 !! the public one: never another's
      integer :: order = 0                  !! with processor: the effective order
      character(48) :: author = ""
      integer :: year = 0
      character(56) :: paper = ""
      character(48) :: purpose = ""         !! what it is for, in words
      logical :: adaptive = .false.         !! no table: a Taylor series to a tolerance
      integer :: stages = 0 !! free rotations per step, those at both ends counted as one
      logical :: symmetric = .true.
      logical :: needs_gradient = .false.
      integer :: middle = 0  !! drag and noise act after that many flows; 0: half before, half after
      type(operation), allocatable :: operations(:)
      type(operation), allocatable :: enter(:)   !! at the start: state to kernel's variables
      type(operation), allocatable :: leave(:)   !! at output: kernel's variables to state
   end type splitting

   integer, parameter :: width = 20 !! coefficients that a row has room for
   real(dp), parameter :: zero(1) = 0

   !> A scheme as it is written down.
   type :: tableau
      character(name_length) :: name
      integer :: number
      integer :: order
      character(48) :: author
      integer :: year
      character(56) :: paper
      character(48) :: purpose
      character :: first = "-"            !! "T" or "K": the first flow
      real(dp) :: half(width) = 0         !! the left half, the middle one last; then zeros
      real(dp) :: gradients(width) = 0    !! c of each, zero for a rotation
      real(dp) :: processor(width) = 0    !! T, K, T, ... from the kernel's variables to the state
      logical :: adaptive = .false.
      logical :: inside = .false.         !! drag and noise act in the middle, between two flows
   end type tableau

   ! Processor of the Takahashi-Imada kernel. The kernel is exp(h (T + U) - h^3/24 [T + U, [T, U]]
   ! + O(h^5)), so the flow of h^2/24 [T, U] takes its solution to one of order 4. Here that flow
   ! and the two terms of h^4 that leave the smallest error of order 5 (-1/640 [T,T,T,U] - 1/1152
   ! [U,T,T,U]) are composed from rotations and kicks; the coefficients solve the order conditions
   ! with the least sum of squares.

   type(tableau), parameter :: rows(*) = [ &
      tableau("strang", 1, 2, "Strang", 1968, &
         "SIAM J. Numer. Anal. 5, 506", &
         "one torque per step: low accuracy, friction", "K", &
         reshape([0.5_dp, 1.0_dp], [width], zero)), &
      tableau("forest-ruth", 2, 4, "Forest, Ruth; Yoshida", 1990, &
         "Physica D 43, 105", &
         "for comparison: the first of order 4", "K", &
         reshape([0.67560359597982881702_dp, 1.351207191959657634_dp, &
         -0.17560359597982881702_dp, -1.7024143839193152681_dp], [width], zero)), &
      tableau("suzuki4", 3, 4, "Suzuki", 1990, &
         "Phys. Lett. A 146, 319", &
         "for comparison: order 4 by equal substeps", "K", &
         reshape([0.20724538589718786857_dp, 0.41449077179437573714_dp, &
         0.41449077179437573714_dp, 0.41449077179437573714_dp, -0.12173615769156360571_dp, &
         -0.65796308717750294857_dp], [width], zero)), &
      tableau("yoshida6", 4, 6, "Yoshida", 1990, &
         "Phys. Lett. A 150, 262, solution A", &
         "for comparison: the first of order 6", "K", &
         reshape([0.39225680523877863191_dp, 0.78451361047755726382_dp, &
         0.51004341191845769875_dp, 0.23557321335935813368_dp, -0.47105338540975643664_dp, &
         -1.17767998417887100695_dp, 0.06875316825252010598_dp, &
         1.31518632068391121889_dp], [width], zero)), &
      tableau("mclachlan4", 5, 4, "McLachlan", 1995, &
         "SIAM J. Sci. Comput. 16, 151", &
         "order 4, a general splitting; srkn4 is better", "K", &
         reshape([0.089269454226475244887_dp, 0.4_dp, -0.097336042636895508015_dp, -0.1_dp, &
         0.50806658841042026313_dp, 0.4_dp], [width], zero)), &
      tableau("srkn4", 6, 4, "Blanes, Moan", 2002, &
         "J. Comput. Appl. Math. 142, 313, SRKN 6b", &
         "1e-3 to 1e-6 without force gradients", "K", &
         reshape([0.0829844064174052_dp, 0.245298957184271_dp, 0.396309801498368_dp, &
         0.60487266571108_dp, -0.0390563049223486_dp, -0.350171622895351_dp, &
         0.1195241940131508_dp], [width], zero)), &
      tableau("srkn6", 7, 6, "Blanes, Moan", 2002, &
         "J. Comput. Appl. Math. 142, 313, SRKN 14a", &
         "the default: 1e-6 and better, any torque", "T", &
         reshape([0.0378593198406116_dp, 0.09171915262446165_dp, 0.102635633102435_dp, &
         0.183983170005006_dp, -0.0258678882665587_dp, -0.05653436583288827_dp, &
         0.314241403071447_dp, 0.004914688774712854_dp, -0.130144459517415_dp, &
         0.143761127168358_dp, 0.106417700369543_dp, 0.328567693746804_dp, &
         -0.00879424312851058_dp, -0.196411466486454234_dp, &
         0.20730506905689536_dp], [width], zero)), &
      tableau("chin4", 8, 4, "Chin", 1997, &
         "Phys. Lett. A 226, 344, 4A; the review's", &
         "1e-3 in large steps; the review's own scheme", "K", &
         reshape([0.16666666666666666667_dp, 0.5_dp, 0.66666666666666666667_dp], [width], zero), &
         gradients=reshape([0.0_dp, 0.0_dp, 0.013888888888888888889_dp], [width], zero)), &
      tableau("omelyan4", 9, 4, "Omelyan, Mryglod, Folk", 2003, &
         "Comput. Phys. Commun. 151, 272, 3F2G velocity", &
         "1e-3 to 1e-6; weak torques", "K", &
         reshape([0.087893686016807062458_dp, 0.2813980611667719_dp, 0.41210631398319293754_dp, &
         0.4372038776664562_dp], [width], zero), &
         gradients=reshape([0.0_dp, 0.0_dp, 0.0030618101223697702906_dp, 0.0_dp], [width], zero)), &
      tableau("omelyan6", 10, 6, "Omelyan, Mryglod, Folk", 2003, &
         "Comput. Phys. Commun. 151, 272, 5F3G position", &
         "1e-6 to 1e-9", "T", &
         reshape([0.1097059723948682_dp, 0.2693315848935301_dp, 0.4140632267310831_dp, &
         1.1319803486515564_dp, -0.0237691991259513_dp, -1.802623867090173_dp], [width], zero), &
         gradients=reshape([0.0_dp, 0.0008642161339706166_dp, 0.0_dp, 0.0_dp, 0.0_dp, &
         -0.01324638643416052_dp], [width], zero)), &
      tableau("omelyan8", 11, 8, "Omelyan, Mryglod, Folk", 2003, &
         "Comput. Phys. Commun. 151, 272, 11F11G position", &
         "1e-9 and better", "T", &
         reshape([0.41009674738801111929_dp, 0.0048249309817414952913_dp, &
         -0.34123345756052780489_dp, 0.17492394861090375603_dp, 0.25644714021068150492_dp, &
         0.29304366370957066164_dp, 0.27765273975812438394_dp, 0.047448940168459770284_dp, &
         -0.56926266869753773903_dp, -0.0015299863411743974499_dp, 0.46629949890124853577_dp, &
         -0.037422994259002571607_dp], [width], zero), &
         gradients=reshape([0.0_dp, 0.00014743936907797528365_dp, 0.0_dp, &
         0.00023288450531932545357_dp, 0.0_dp, 0.0061648659635535962498_dp, 0.0_dp, &
         -0.012307516860831240717_dp, 0.0_dp, -0.000073296648559126385387_dp, 0.0_dp, &
         0.015295860994523744732_dp], [width], zero)), &
      tableau("takahashi-imada", 12, 4, "Takahashi, Imada; Blanes, Casas, Ros", 1984, &
         "J. Phys. Soc. Jpn. 53, 3765; Appl. Num. Math. 39, 245", &
         "order 4, one torque per step; at outputs only", "T", &
         reshape([0.5_dp, 1.0_dp], [width], zero), &
         gradients=reshape([0.0_dp, 1.0_dp/24.0_dp], [width], zero), &
         processor=reshape([0.11804257670960278_dp, -0.0862006645713153_dp, &
         0.24702625764338573_dp, 0.245074981924611_dp, 0.20795405485274107_dp, &
         -0.13290448562578844_dp, -0.25694324274260005_dp, 0.12189993888971454_dp, &
         -0.3160796464631296_dp, -0.1478697706172218_dp], [width], zero)), &
      tableau("taylor", 13, 0, "Jorba, Zou", 2005, &
         "Exp. Math. 14, 99; in two precisions", &
         "any accuracy, by `tolerance`; steps of any size", adaptive=.true.), &
      tableau("baoab", 14, 2, "Leimkuhler, Matthews; Davidchack et al.", 2013, &
         "J. Chem. Phys. 138, 174102; 142, 144114", &
         "thermostats: samples attitudes best, large steps", "K", &
         reshape([0.5_dp, 0.5_dp], [width], zero), inside=.true.), &
      tableau("saba864", 15, 4, "Blanes, Casas, Farres, Laskar, Makazaga, Murua", 2013, &
         "Appl. Numer. Math. 68, 58, ABA(8,6,4)", &
         "weak torques without gradient, 1e-6 to 1e-10", "T", &
         reshape([0.0711334264982231177779_dp, 0.1830836874721972219617_dp, &
         0.2411534279566400987364_dp, 0.3107828598985748695075_dp, 0.5214117617728147892121_dp, &
         -0.026564618511958800697_dp, -0.333698616227678005726_dp, &
         0.0653961422823734184559_dp], [width], zero)), &
      tableau("saba1064", 16, 4, "Blanes, Casas, Farres, Laskar, Makazaga, Murua", 2013, &
         "Appl. Numer. Math. 68, 58, ABA(10,6,4)", &
         "even weaker torques: 1e-3 of the spin and less", "T", &
         reshape([0.0380944974224121954569_dp, 0.0958588808370752106107_dp, &
         0.1452987161169137492940_dp, 0.2044461531429987806805_dp, 0.2076276957255412507162_dp, &
         0.2170703479789911017143_dp, 0.4359097036515261592231_dp, -0.017375381959065093005_dp, &
         -0.653861225832786709380_dp], [width], zero))]

   integer :: k !! of the tables only
   integer, parameter :: scheme_count = size(rows)
   !> Names in the order of the rows.
   character(name_length), parameter :: scheme_names(*) = rows%name
   !> Names by public number; "" where a number is not given.
   character(name_length), parameter :: numbered_names(*) = &
      [(merge(rows(max(1, findloc(rows%number, k, dim=1)))%name, repeat(" ", name_length), &
              any(rows%number == k)), k=1, maxval(rows%number))]

contains

   !> Row i, 1 to scheme_count.
   pure function scheme_row(i) result(row)
      integer, intent(in) :: i
      type(splitting) :: row
      type(tableau) :: it
      it = rows(i)
      row%name = it%name
      row%number = it%number
      row%order = it%order
      row%author = it%author
      row%year = it%year
      row%paper = it%paper
      row%purpose = it%purpose
      row%adaptive = it%adaptive
      if (it%inside) then
         row%operations = mirrored(alternating(it%first, used(it%half), it%gradients))
         row%middle = size(row%operations)/2
      else
         row%operations = both_halves(it%first, used(it%half), it%gradients)
      end if
      allocate (row%leave, source=alternating("T", used(it%processor), spread(0.0_dp, 1, width)))
      allocate (row%enter, source=inverse(row%leave))
      row%stages = min(count(row%operations%is_kick), count(.not. row%operations%is_kick))
      row%needs_gradient = any(abs(row%operations%c) > 0)
   end function scheme_row

   !> The coefficients before the zeros: none is zero itself.
   pure function used(padded) result(b)
      real(dp), intent(in) :: padded(width)
      real(dp), allocatable :: b(:)
      b = pack(padded, abs(padded) > 0)
   end function used

   !> Operations of a symmetric row from its left half.
   pure function both_halves(first, half, gradients) result(operations)
      character, intent(in) :: first
      real(dp), intent(in) :: half(:), gradients(:)   !! the second at least as long
      type(operation), allocatable :: operations(:)
      integer :: n
      n = size(half)
      operations = alternating(first, [half, half(n - 1:1:-1)], &
         [gradients(:n), gradients(n - 1:1:-1)])
   end function both_halves

   !> A row without a middle flow from its left half.
   pure function mirrored(left) result(operations)
      type(operation), intent(in) :: left(:)
      type(operation), allocatable :: operations(:)
      integer :: i, n
      n = size(left)
      operations = [left, left(n:1:-1)]
      do i = n + 1, 2*n
         operations(i)%node = 1 - operations(i)%node
         if (.not. operations(i)%is_kick) operations(i)%node = operations(i)%node - operations(i)%b
      end do
   end function mirrored

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

   !> Flows that undo others.
   pure function inverse(flows) result(back)
      type(operation), intent(in) :: flows(:)
      type(operation), allocatable :: back(:)
      integer :: n
      n = size(flows)
      allocate (back(n))
      if (n == 0) return
      back = alternating(merge("K", "T", flows(n)%is_kick), -flows(n:1:-1)%b, -flows(n:1:-1)%c)
   end function inverse

   !> The scheme of a body without torque: one free rotation, no kick. Its order is the method's.
   pure function free_scheme(inside) result(row)
      logical, intent(in) :: inside   !! in two halves, with drag and noise between them
      type(splitting) :: row
      row = splitting("free", author="Euler", year=1758, stages=1, paper="the free rotation itself")
      row%operations = [operation(.false., 1.0_dp)]
      if (inside) row%operations = mirrored([operation(.false., 0.5_dp)])
      if (inside) row%middle = 1
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
