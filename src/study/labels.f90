!> Names beside curves: places that do not lie on each other, in fractions of the picture.
module poinsot_study_labels
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: label_list, label_place, axis, place_label, take_curve, fraction_of

   integer, parameter :: most = 200
   real(dp), parameter :: line_height = 0.031_dp
   real(dp), parameter :: wide = 1.6_dp        !! width of a picture over its height
   real(dp), parameter :: sample = 0.012_dp    !! distance of the points that stand for a curve
   real(dp), parameter :: led_from = 0.045_dp  !! names farther than this get a line to their curve
   real(dp), parameter :: outside = 1000, on_name = 300, on_curve = 3, astray = 8
   real(dp), parameter :: margin = 0.006_dp    !! between a name and a curve

   !> A logarithmic axis from one end of the picture to the other.
   type :: axis
      real(dp) :: from = 1, to = 10
   end type axis

   !> What is taken already: boxes of names, and points of curves.
   type :: label_list
      real(dp) :: letter = 0.0108_dp   !! width of one
      integer :: boxes = 0
      real(dp) :: box(4, most) = 0     !! left, right, bottom, top
      integer :: points = 0
      real(dp), allocatable :: point(:, :)
      integer, allocatable :: owner(:)
   end type label_list

   !> Where a name goes.
   type :: label_place
      real(dp) :: x = 0, y = 0         !! left, middle or right end of the text, as `side` says
      integer :: side = 1              !! of its point: 1 right, 0 above or below, -1 left
      real(dp) :: penalty = huge(1.0_dp) !! from 300: it lies on another
      logical :: led = .false.      !! far from its curve: a thin line leads there,
      real(dp) :: line(4) = 0          !! from (x, y) to (x, y)
   end type label_place

contains

   !> Where a value lies, 0 to 1.
   pure real(dp) function fraction_of(scale, value) result(part)
      type(axis), intent(in) :: scale
      real(dp), intent(in) :: value
      part = log(max(value, 1e-300_dp)/scale%from)/log(scale%to/scale%from)
   end function fraction_of

   !> A curve that names should not lie on.
   subroutine take_curve(list, x, y, curve)
      type(label_list), intent(inout) :: list
      real(dp), intent(in) :: x(:), y(:)        !! fractions of the picture
      integer, intent(in) :: curve              !! its number, to tell it from others
      real(dp) :: from(2), to(2)
      integer :: i, k, parts
      do i = 1, size(x)
         to = [x(i), y(i)]
         if (i == 1) from = to
         parts = min(100, 1 + int(hypot(wide*(to(1) - from(1)), to(2) - from(2))/sample))
         do k = 1, parts
            call take_point(list, from + (to - from)*real(k, dp)/parts, curve)
         end do
         from = to
      end do
   end subroutine take_curve

   subroutine take_point(list, point, curve)
      type(label_list), intent(inout) :: list
      real(dp), intent(in) :: point(2)
      integer, intent(in) :: curve
      real(dp), allocatable :: points(:, :)
      integer, allocatable :: owners(:)
      if (any(point < 0) .or. any(point > 1)) return
      if (.not. allocated(list%point)) allocate (list%point(2, 1024), list%owner(1024))
      if (list%points == size(list%owner)) then
         allocate (points(2, 2*list%points), owners(2*list%points))
         points(:, :list%points) = list%point
         owners(:list%points) = list%owner
         call move_alloc(points, list%point)
         call move_alloc(owners, list%owner)
      end if
      list%points = list%points + 1
      list%point(:, list%points) = point
      list%owner(list%points) = curve
   end subroutine take_point

   !> A place for the name of a curve near one of the points given: of all places around all of them
   !> the one that touches no other name, the fewest curves, and lies nearest to its own. Taken, if
   !> its price is at most `limit`.
   subroutine place_label(list, x, y, length, curve, place, limit)
      type(label_list), intent(inout) :: list
      real(dp), intent(in) :: x(:), y(:)      !! fractions of the picture
      integer, intent(in) :: length           !! letters
      integer, intent(in) :: curve
      type(label_place), intent(out) :: place
      real(dp), intent(in), optional :: limit
      real(dp) :: width, at(2), last(2)
      integer :: i
      width = list%letter*length
      do i = 1, size(x)
         at = [x(i), y(i)]
         if (i == 1) last = at
         call try_point(list, at, width, curve, place)
         call try_point(list, 0.5_dp*(at + last), width, curve, place)
         last = at
      end do
      if (present(limit)) then
         if (place%penalty > limit) return
      end if
      if (list%boxes == most .or. .not. place%penalty < huge(1.0_dp)) return
      list%boxes = list%boxes + 1
      list%box(:, list%boxes) = box_of(place%x - 0.5_dp*(1 - place%side)*width, place%y, width)
   end subroutine place_label

   pure function box_of(x, y, width) result(box)
      real(dp), intent(in) :: x, y, width
      real(dp) :: box(4)
      box = [x, x + width, y - 0.5_dp*line_height, y + 0.5_dp*line_height]
   end function box_of

   !> All places around a point that is in the picture.
   pure subroutine try_point(list, at, width, curve, place)
      type(label_list), intent(in) :: list
      real(dp), intent(in) :: at(2), width
      integer, intent(in) :: curve
      type(label_place), intent(inout) :: place
      integer :: side, ring
      if (any(at < 0) .or. any(at > 1)) return
      do ring = 0, 3
         do side = 1, 8
            call try_place(list, at, width, curve, side, ring, place)
         end do
      end do
   end subroutine try_point

   !> One place: on one of eight sides of a point, near or farther; kept if it is better.
   pure subroutine try_place(list, at, width, curve, side, ring, place)
      type(label_list), intent(in) :: list
      real(dp), intent(in) :: at(2), width
      integer, intent(in) :: curve, side, ring
      type(label_place), intent(inout) :: place
      !> right below, right, right above, left above, left, left below, below, above
      real(dp), parameter :: aside(8) = [1, 1, 1, -1, -1, -1, 0, 0]
      real(dp), parameter :: above(8) = [-1, 0, 1, 1, 0, -1, -1, 1]
      real(dp) :: box(4), x, y, penalty, touch(2)
      x = at(1) + aside(side)*(merge(0.012_dp, 0.016_dp, abs(above(side)) > 0) + 0.012_dp*ring)
      if (aside(side) < 0) x = x - width
      if (abs(aside(side)) < 0.5_dp) x = x - 0.5_dp*width
      y = at(2) + above(side)*(merge(0.024_dp, 0.034_dp, abs(aside(side)) > 0.5_dp) + 0.032_dp*ring)
      if (ring > 0 .and. abs(above(side)) < 0.5_dp) return
      box = box_of(x, y, width)
      penalty = 0.15_dp*side + 2.5_dp*ring
      if (box(1) < 0.004_dp .or. box(2) > 1.01_dp .or. box(3) < 0.004_dp .or. box(4) > 1) then
         penalty = penalty + outside
      end if
      penalty = penalty + on_names(list, box)
      if (penalty >= place%penalty) return
      penalty = penalty + on_curves(list, box, curve)
      touch = [min(max(at(1), box(1)), box(2)), min(max(at(2), box(3)), box(4))]
      if (ring > 0) penalty = penalty + crossings(list, at, touch)
      if (penalty >= place%penalty) return
      place%side = nint(aside(side))
      place%x = x + 0.5_dp*(1 - place%side)*width
      place%y = y
      place%penalty = penalty
      place%led = hypot(wide*(touch(1) - at(1)), touch(2) - at(2)) > led_from
      place%line = [touch, at]
   end subroutine try_place

   !> Names under a box.
   pure real(dp) function on_names(list, box) result(penalty)
      type(label_list), intent(in) :: list
      real(dp), intent(in) :: box(4)
      integer :: i
      penalty = 0
      do i = 1, list%boxes
         if (box(2) < list%box(1, i) .or. box(1) > list%box(2, i)) cycle
         if (box(4) < list%box(3, i) .or. box(3) > list%box(4, i)) cycle
         penalty = penalty + on_name
      end do
   end function on_names

   !> Curves under a box, and others nearer to it than its own.
   pure real(dp) function on_curves(list, box, curve) result(penalty)
      type(label_list), intent(in) :: list
      real(dp), intent(in) :: box(4)
      integer, intent(in) :: curve
      real(dp) :: distance, nearest_own, other
      integer :: i
      penalty = 0
      nearest_own = 1
      other = 1
      do i = 1, list%points
         associate (p => list%point(:, i))
            distance = hypot(wide*max(0.0_dp, box(1) - p(1), p(1) - box(2)), &
                         max(0.0_dp, box(3) - p(2), p(2) - box(4)))
         end associate
         if (distance < margin) penalty = penalty + on_curve
         if (list%owner(i) == curve) nearest_own = min(nearest_own, distance)
         if (list%owner(i) /= curve) other = min(other, distance)
      end do
      nearest_own = nearest_own + margin
      if (other < nearest_own) penalty = penalty + astray*min(1.0_dp, &
         (nearest_own - other)/(5*margin))
   end function on_curves

   !> Names and curves that a line to the curve would cross; it ends on one.
   pure real(dp) function crossings(list, from, to) result(penalty)
      type(label_list), intent(in) :: list
      real(dp), intent(in) :: from(2), to(2)
      real(dp) :: at(2)
      integer :: i, k
      penalty = 0
      do k = 2, 8
         at = from + (to - from)*k/8.0_dp
         do i = 1, list%boxes
            if (at(1) > list%box(1, i) .and. at(1) < list%box(2, i) .and. &
                at(2) > list%box(3, i) .and. at(2) < list%box(4, i)) penalty = penalty + on_name
         end do
         do i = 1, list%points
            associate (p => list%point(:, i))
               if (hypot(wide*(at(1) - p(1)), &
                  at(2) - p(2)) < 0.5_dp*sample) penalty = penalty + 0.5_dp
            end associate
         end do
      end do
   end function crossings

end module poinsot_study_labels
