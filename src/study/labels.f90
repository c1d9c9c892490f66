!> Names beside curves: places that do not lie on each other, in fractions of the picture.
module poinsot_study_labels
   use poinsot_core_kinds, only: dp
   implicit none(type, external)
   private
   public :: label_list, axis, place_label, place_along, take_point, fraction_of

   integer, parameter :: most = 400
   real(dp), parameter :: letter = 0.0112_dp, line_height = 0.030_dp

   !> A logarithmic axis from one end of the picture to the other.
   type :: axis
      real(dp) :: from = 1, to = 10
   end type axis

   !> What is taken already: boxes of labels, and points of curves.
   type :: label_list
      integer :: boxes = 0
      real(dp) :: box(4, most) = 0     !! left, right, bottom, top
      integer :: points = 0
      real(dp) :: point(2, 40*most) = 0
      integer :: curve = 0             !! that the last point belongs to
   end type label_list

contains

   !> Where a value lies, 0 to 1.
   pure real(dp) function fraction_of(scale, value) result(part)
      type(axis), intent(in) :: scale
      real(dp), intent(in) :: value
      part = log(max(value, 1e-300_dp)/scale%from)/log(scale%to/scale%from)
   end function fraction_of

   !> A point of a curve, and the line to it from the one before.
   pure subroutine take_point(list, x, y, curve)
      type(label_list), intent(inout) :: list
      real(dp), intent(in) :: x, y              !! fractions of the picture
      integer, intent(in), optional :: curve    !! not 0; absent: no line
      real(dp) :: from(2)
      integer :: i, parts
      parts = 1
      from = 0
      if (present(curve)) then
         if (curve == list%curve .and. list%points > 0) then
            parts = 12
            from = list%point(:, list%points)
         end if
         list%curve = curve
      end if
      do i = 1, parts
         if (list%points == size(list%point, 2)) return
         list%points = list%points + 1
         list%point(:, list%points) = from + ([x, y] - from)*real(i, dp)/parts
      end do
   end subroutine take_point

   !> A place near (x, y) for a text, its left middle.
   pure subroutine place_label(list, x, y, length, at_x, at_y)
      type(label_list), intent(inout) :: list
      real(dp), intent(in) :: x, y            !! fractions of the picture
      integer, intent(in) :: length           !! letters
      real(dp), intent(out) :: at_x, at_y
      call place_along(list, [x], [y], length, at_x, at_y)
   end subroutine place_label

   !> A place for the name of a curve, near one of its points: of all places around all of them the
   !> one that touches no other label and the fewest curves.
   pure subroutine place_along(list, x, y, length, at_x, at_y)
      type(label_list), intent(inout) :: list
      real(dp), intent(in) :: x(:), y(:)      !! fractions of the picture
      integer, intent(in) :: length           !! letters
      real(dp), intent(out) :: at_x, at_y     !! of the text's left middle
      real(dp), parameter :: ring(2, 12) = reshape([0.012_dp, -0.03_dp, 0.015_dp, 0.0_dp, &
         0.012_dp, 0.03_dp, -1.012_dp, 0.03_dp, -1.015_dp, 0.0_dp, -1.012_dp, -0.03_dp, &
         -0.5_dp, -0.045_dp, -0.5_dp, 0.045_dp, 0.02_dp, -0.055_dp, 0.02_dp, 0.055_dp, &
         -1.02_dp, -0.055_dp, -1.02_dp, 0.055_dp], [2, 12])
      real(dp) :: width, left, bottom, price, least
      integer :: i, k
      width = letter*length
      least = huge(least)
      at_x = 0
      at_y = 0
      do k = 1, size(x)
         do i = 1, size(ring, 2)
            left = x(k) + ring(1, i)
            if (ring(1, i) < -0.9_dp) left = x(k) + (ring(1, i) + 1) - width
            if (abs(ring(1, i) + 0.5_dp) < 0.01_dp) left = x(k) - 0.5_dp*width
            bottom = y(k) + ring(2, i) - 0.5_dp*line_height
            price = penalty(list, left, left + width, bottom, bottom + line_height) + 0.5_dp*i
            if (price >= least) cycle
            least = price
            at_x = left
            at_y = bottom + 0.5_dp*line_height
         end do
      end do
      if (list%boxes == most) return
      list%boxes = list%boxes + 1
      list%box(:, list%boxes) = [at_x, at_x + width, at_y - 0.5_dp*line_height, at_y + &
         0.5_dp*line_height]
   end subroutine place_along

   !> How bad a box is.
   pure real(dp) function penalty(list, left, right, bottom, top)
      type(label_list), intent(in) :: list
      real(dp), intent(in) :: left, right, bottom, top
      integer :: i
      penalty = 0
      if (left < 0.005_dp .or. right > 1.005_dp .or. bottom < 0 .or. top > 1) penalty = 1000
      do i = 1, list%boxes
         if (right < list%box(1, i) .or. left > list%box(2, i)) cycle
         if (top < list%box(3, i) .or. bottom > list%box(4, i)) cycle
         penalty = penalty + 300
      end do
      do i = 1, list%points
         if (list%point(1, i) > left .and. list%point(1, i) < right .and. &
             list%point(2, i) > bottom .and. list%point(2, i) < top) penalty = penalty + 1.2_dp
      end do
   end function penalty

end module poinsot_study_labels
