!> `poinsot properties`: Table 2 of the review (Vilmart 2013), measured for every method of the
!> registry.
!>
!> Ticks come from maps in dual numbers of quadruple precision (module maps): a property that holds
!> has a defect at rounding, 1e-32, one that does not stands far above. Each map is first compared
!> with the kernel it stands for; their distance, and what the kernels themselves lose over a
!> hundred steps, is in the table too.
module poinsot_study_properties
   use poinsot_core_kinds, only: dp, qp, name_length
   use poinsot_core_error, only: poinsot_error, raised, raise
   use poinsot_core_status, only: poinsot_ok, poinsot_e_convergence
   use poinsot_free_method, only: free_method, find_method, method_count, method_name
   use poinsot_rotation_quaternion, only: rotate
   use poinsot_scene_claim, only: claim_files
   use poinsot_scene_files, only: out_file, open_out, put, finish_out
   use poinsot_scene_watch, only: run_watch
   use poinsot_study_defects, only: defects, measure_defects, plain_step
   use poinsot_study_maps, only: has_map
   use poinsot_study_write_line, only: write_line
   use poinsot_study_turn, only: turn_one, momentum_gap, attitude_gap
   implicit none(type, external)
   private
   public :: method_properties, run_properties, measure_method, holds

   !> The measurements of one method.
   type :: method_properties
      character(name_length) :: name = ""
      logical :: has_map = .true.         !! else there are the figures of the kernel alone
      integer :: order = 0                !! of the registry; 0: exact
      real(dp) :: slope(2) = 0            !! order of the map, y and q
      !> order of the kernel; 0 if rounding leaves less than three points
      real(dp) :: kernel_slope(2) = 0
      real(dp) :: distance = 0            !! kernel from map, one step, in 1e-16
      type(defects) :: map                !! largest over the states
      real(dp) :: linear = 0              !! y3 of a body with I1 = I2, in all orders of the axes
      real(dp) :: symmetric_body = 0      !! error for two equal moments, in all orders of the axes
      real(dp) :: sphere = 0              !! error for three
      !> Qy, C, H, |q| lost by the kernel over 100 steps, relative
      real(dp) :: kernel(4) = 0
   end type method_properties

   real(dp), parameter :: yes_below = 1e-31_dp, no_above = 1e-29_dp

   ! Three bodies, none sorted, none special but the flat one, with h |omega| = 1.1.
   integer, parameter :: states = 3
   real(dp), parameter :: bodies(3, states) = reshape([0.8_dp, 0.55_dp, 0.95_dp, 0.376_dp, 1.0_dp, &
      0.627_dp, 1.5_dp, 0.6_dp, 0.9_dp], [3, states])
   real(dp), parameter :: momenta(3, states) = reshape([0.5_dp, -0.6_dp, 0.4_dp, 0.3_dp, 0.7_dp, &
      -0.6_dp, -0.5_dp, 0.4_dp, 0.8_dp], [3, states])
   real(dp), parameter :: attitude(4) = [0.1_dp, 0.7_dp, -0.5_dp, 0.5_dp]
   real(dp), parameter :: turn = 0.8_dp

   !> A row of the review's Table 2: the kernel it is of, with preprocessing or without, and what is
   !> printed in the columns.
   type :: reviewed_row
      character(name_length) :: kernel
      logical :: preprocessed
      logical :: keeps(5)
   end type reviewed_row

   character(12), parameter :: columns(5) = [character(12) :: "Qy", "C", "H", "Poisson", &
      "symplectic"]
   logical, parameter :: yes = .true., no = .false.
   type(reviewed_row), parameter :: review(*) = [ &
      reviewed_row("exact", no, [yes, yes, yes, yes, yes]), &
      reviewed_row("jacobi", no, [yes, yes, yes, yes, yes]), &
      reviewed_row("symmetric-rotation", no, [yes, yes, no, yes, yes]), &
      reviewed_row("rattle", no, [yes, yes, yes, yes, yes]), &
      reviewed_row("moser-veselov", no, [yes, yes, yes, yes, yes]), &
      reviewed_row("moser-veselov", yes, [yes, yes, yes, yes, no]), &
      reviewed_row("midpoint", no, [yes, yes, yes, no, no])]

contains

   !> Measure all methods; a table on `unit`, DIR/properties.csv if there is a DIR. Error:
   !> POINSOT_E_IO.
   subroutine run_properties(folder, unit, watch, error)
      character(*), intent(in) :: folder             !! where the file goes; "": nowhere
      integer, intent(in) :: unit                    !! open for formatted writing
      class(run_watch), intent(inout) :: watch       !! told how many methods are done
      type(poinsot_error), intent(inout) :: error
      type(method_properties) :: row
      type(out_file) :: file
      character(100) :: contradictions(100)
      integer :: i, said
      if (folder /= "") then
         call claim_files(folder, ["properties.csv"], error)
         if (.not. raised(error)) call open_out(folder//"/properties.csv", file, error)
         if (raised(error)) return
         call put(file, csv_head(), error)
      end if
      call show_head(unit)
      said = 0
      do i = 1, method_count()
         call watch%report_progress(real(i - 1, dp), real(method_count(), dp))
         call measure_method(method_name(i), row, error)
         call watch%wipe()
         if (raised(error)) return
         call show_row(unit, row)
         call compare_with_review(row, contradictions, said)
         if (folder /= "") call put(file, csv_row(row), error)
      end do
      call show_foot(unit, contradictions(:said))
      if (folder /= "") call finish_out(file, error)
   end subroutine run_properties

   ! Measuring
   ! ---------------------------------------------------------------------------------------------

   !> Everything about one method.
   subroutine measure_method(name, row, error)
      character(*), intent(in) :: name
      type(method_properties), intent(out) :: row
      type(poinsot_error), intent(inout) :: error
      type(free_method) :: method
      integer :: i
      call find_method(name, method, error)
      if (raised(error)) return
      row%name = name
      row%order = method%order
      row%has_map = has_map(name)
      row%map%ok = .true.
      do i = 1, states
         if (row%has_map) call at_state(bodies(:, i), momenta(:, i), row)
         call kernel_losses(bodies(:, i), momenta(:, i), row)
      end do
      if (.not. row%map%ok) then
         call raise(error, poinsot_e_convergence, name//": a map has no answer")
         return
      end if
      if (row%order > 0) call kernel_slopes(row)
      if (.not. row%has_map) return
      do i = 0, 2
         call symmetric_body(cshift([0.7_dp, 0.7_dp, 1.1_dp], i), 3 - i, row)
      end do
      call symmetric_body([0.9_dp, 0.9_dp, 0.9_dp], 0, row)
      if (row%order > 0) call map_slopes(row)
   end subroutine measure_method

   !> Defects, distance of kernel and map.
   subroutine at_state(moments, y, row)
      real(dp), intent(in) :: moments(3), y(3)
      type(method_properties), intent(inout) :: row
      type(defects) :: found
      real(qp) :: ym(3), qm(4)
      real(dp) :: h, yk(3), qk(4)
      integer :: status, k
      logical :: ok
      h = turn/norm2(y/moments)
      call measure_defects(trim(row%name), moments, h, y, attitude, found)
      row%map%ok = row%map%ok .and. found%ok
      row%map%space = max(row%map%space, found%space)
      row%map%casimir = max(row%map%casimir, found%casimir)
      row%map%energy = max(row%map%energy, found%energy)
      row%map%norm = max(row%map%norm, found%norm)
      row%map%poisson = max(row%map%poisson, found%poisson)
      row%map%symplectic = max(row%map%symplectic, found%symplectic)
      row%map%symmetric = max(row%map%symmetric, found%symmetric)
      row%map%reversible = max(row%map%reversible, found%reversible)
      do k = 1, 4
         ym = y
         qm = attitude
         yk = y
         qk = attitude
         call plain_step(trim(row%name), moments, real(h/k, qp), ym, qm, ok)
         call turn_one(trim(row%name), moments, h/k, 1, yk, qk, status)
         row%map%ok = row%map%ok .and. ok .and. status == poinsot_ok
         row%distance = max(row%distance, momentum_gap(real(yk, qp), ym)/1e-16_dp, &
            attitude_gap(real(qk, qp), qm)/1e-16_dp)
      end do
   end subroutine at_state

   !> What the kernel loses in a hundred steps.
   subroutine kernel_losses(moments, y, row)
      real(dp), intent(in) :: moments(3), y(3)
      type(method_properties), intent(inout) :: row
      real(dp) :: h, yk(3), qk(4), before(3), after(3)
      integer :: status
      h = turn/norm2(y/moments)
      yk = y
      qk = attitude
      before = rotate(qk, yk)
      call turn_one(trim(row%name), moments, h/3, 100, yk, qk, status)
      row%map%ok = row%map%ok .and. status == poinsot_ok
      after = rotate(qk, yk)
      row%kernel(1) = max(row%kernel(1), norm2(after - before)/norm2(y))
      row%kernel(2) = max(row%kernel(2), abs(sum(yk*yk)/sum(y*y) - 1))
      row%kernel(3) = max(row%kernel(3), abs(sum(yk*yk/moments)/sum(y*y/moments) - 1))
      row%kernel(4) = max(row%kernel(4), abs(norm2(qk) - 1))
   end subroutine kernel_losses

   !> Two equal moments and the axis of symmetry; axis 0: a sphere.
   subroutine symmetric_body(moments, axis, row)
      real(dp), intent(in) :: moments(3)
      integer, intent(in) :: axis
      type(method_properties), intent(inout) :: row
      real(qp) :: y(3), q(4), z(3), r(4), h
      real(dp) :: error
      logical :: ok, found
      h = turn/norm2(momenta(:, 1)/moments)
      y = momenta(:, 1)
      q = attitude
      z = y
      r = q
      call plain_step(trim(row%name), moments, h, y, q, ok)
      call plain_step("exact", moments, h, z, r, found)
      error = max(momentum_gap(y, z), attitude_gap(q, r))
      if (axis == 0) then
         row%sphere = error
         row%linear = max(row%linear, real(maxval(abs(y - momenta(:, 1))), dp))
      else
         row%symmetric_body = max(row%symmetric_body, error)
         row%linear = max(row%linear, real(abs(y(axis) - momenta(axis, 1)), dp))
      end if
   end subroutine symmetric_body

   !> Order of the map: the error of one step shrinks with the power order + 1.
   subroutine map_slopes(row)
      type(method_properties), intent(inout) :: row
      integer, parameter :: points = 4
      real(dp) :: h(points), ey(points), eq(points)
      real(qp) :: y(3), q(4), z(3), r(4)
      logical :: ok
      integer :: k
      do k = 1, points
         h(k) = (0.2_dp + 0.03_dp*row%order)/1.25_dp**(k - 1)
         y = momenta(:, 1)
         q = attitude
         z = y
         r = q
         call plain_step(trim(row%name), bodies(:, 1), real(h(k), qp), y, q, ok)
         call plain_step("exact", bodies(:, 1), real(h(k), qp), z, r, ok)
         ey(k) = momentum_gap(y, z)
         eq(k) = attitude_gap(q, r)
      end do
      row%slope(1) = slope(h, ey, 1e-31_dp) - 1
      row%slope(2) = slope(h, eq, 1e-31_dp) - 1
   end subroutine map_slopes

   !> Order of the kernel: global error at t = 2.
   subroutine kernel_slopes(row)
      type(method_properties), intent(inout) :: row
      integer, parameter :: points = 6
      real(dp) :: h(points), ey(points), eq(points), y(3), q(4)
      real(qp) :: z(3), r(4)
      logical :: ok
      integer :: k, n, status
      z = momenta(:, 1)
      r = attitude
      call plain_step("exact", bodies(:, 1), 2.0_qp, z, r, ok)
      do k = 1, points
         n = nint((3 + 20.0_dp/row%order)*1.3_dp**(k - 1))
         h(k) = 2.0_dp/n
         y = momenta(:, 1)
         q = attitude
         call turn_one(trim(row%name), bodies(:, 1), h(k), n, y, q, status)
         ey(k) = momentum_gap(real(y, qp), z)
         eq(k) = attitude_gap(real(q, qp), r)
      end do
      row%kernel_slope(1) = slope(h, ey, 1e-15_dp)
      row%kernel_slope(2) = slope(h, eq, 1e-15_dp)
   end subroutine kernel_slopes

   !> Slope of log(error) over log(h) by least squares, over the points above 30 times `floor`; 0 if
   !> they are fewer than three.
   pure real(dp) function slope(h, error, floor)
      real(dp), intent(in) :: h(:), error(:), floor
      real(dp) :: x(size(h)), z(size(h))
      logical :: good(size(h))
      integer :: n
      slope = 0
      good = error > 30*floor .and. error < 0.1_dp
      n = count(good)
      if (n < 3) return
      x = log(h)
      z = log(merge(error, 1.0_dp, good))
      x = merge(x - sum(x, mask=good)/n, 0.0_dp, good)
      slope = sum(x*z)/sum(x*x)
   end function slope

   ! Showing
   ! ---------------------------------------------------------------------------------------------

   !> "yes", "no", or "?" between the two.
   pure function holds(defect) result(word)
      real(dp), intent(in) :: defect
      character(3) :: word
      word = "?"
      if (defect < yes_below) word = "yes"
      if (defect > no_above) word = "no"
   end function holds

   subroutine show_head(unit)
      integer, intent(in) :: unit
      call write_line(unit, &
         "Properties of each method: the review's Table 2 (Vilmart 2013), measured")
      call write_line(unit, "")
      call write_line(unit, &
         "                     order measured  exact preservation of            "// &
         "  sym- time-   exact for   kernel")
      call write_line(unit, &
         "method               y     q        Qy  C   H   |q| linear  Poisson plectic "// &
         "reversible symm. sphere  off")
   end subroutine show_head

   subroutine show_row(unit, row)
      integer, intent(in) :: unit
      type(method_properties), intent(in) :: row
      character(*), parameter :: table = &
         "(a20, 1x, a13, 2x, 4(a3, 1x), 3(a3, 5x), a3, 8x, a3, 3x, a3, f8.1)"
      character(13) :: orders
      character(120) :: line
      orders = "exact exact"
      if (row%order > 0) write (orders, "(f5.2, 1x, f5.2)") merge(row%slope, row%kernel_slope, &
         row%has_map)
      line = row%name(:20)//" "//orders//"  no map: its kernel is measured alone"
      if (row%has_map) write (line, table) row%name, orders, holds(row%map%space), &
         holds(row%map%casimir), holds(row%map%energy), holds(row%map%norm), &
         holds(row%linear), holds(row%map%poisson), holds(row%map%symplectic), &
         holds(max(row%map%symmetric, row%map%reversible)), holds(row%symmetric_body), &
         holds(row%sphere), row%distance
      call write_line(unit, line)
   end subroutine show_row

   subroutine show_foot(unit, contradictions)
      integer, intent(in) :: unit
      character(*), intent(in) :: contradictions(:)
      character(100), parameter :: lines(13) = [character(100) :: &
         "", &
         "Measured for three bodies (unsorted, one flat) at h|omega| = 0.8 on maps in quadruple", &
         "precision; derivatives by dual numbers. yes: defect below 1e-31, no: above 1e-29.", &
         "  Qy, C, H, |q|   space momentum, |y|^2/2, energy, norm: the quadratic invariants", &
         "  linear          y on the axis of a body with two equal moments (any); y of a sphere", &
         "  Poisson         the Jacobian of y maps the structure matrix y^ to that of the new y", &
         "  symplectic      the Jacobian of (y, Q) preserves the canonical two-form of T*SO(3)", &
         "  time-reversible the step -h inverts the step h, and equals h with y reversed", &
         "  exact for       bodies with two equal moments (any two); with three", &
         "  kernel off      largest distance of the kernel from its map in one step, in 1e-16", &
         "Orders are slopes of the error of one step, minus one. Those of the kernels, all", &
         "defects, and the drift of the kernels over 100 steps: properties.csv (--out DIR).", &
         ""]
      integer :: i
      do i = 1, size(lines)
         call write_line(unit, trim(lines(i)))
      end do
      if (size(contradictions) == 0) then
         call write_line(unit, "No entry of the review's table is contradicted.")
      else
         call write_line(unit, "Entries of the review's table that are contradicted:")
         do i = 1, size(contradictions)
            call write_line(unit, "  "//trim(contradictions(i)))
         end do
      end if
   end subroutine show_foot

   !> Entries of the review's row for this method that were measured otherwise.
   subroutine compare_with_review(row, contradictions, said)
      type(method_properties), intent(in) :: row
      character(100), intent(inout) :: contradictions(:)
      integer, intent(inout) :: said
      real(dp) :: measured(5)
      type(free_method) :: method
      type(poinsot_error) :: error
      integer :: i, k
      if (.not. row%has_map) return
      call find_method(trim(row%name), method, error)
      measured = [row%map%space, row%map%casimir, row%map%energy, row%map%poisson, &
         row%map%symplectic]
      do k = 1, size(review)
         if (review(k)%kernel /= method%kernel) cycle
         if (review(k)%preprocessed .neqv. method%terms > 0) cycle
         do i = 1, size(columns)
            if (holds(measured(i)) == merge("yes", "no ", review(k)%keeps(i))) cycle
            if (said == size(contradictions)) return
            said = said + 1
            write (contradictions(said), "(a, ': ', a, ' printed ', a, ', measured ', a, es9.1)") &
               trim(row%name), trim(columns(i)), &
               trim(merge("yes", "no ", review(k)%keeps(i))), holds(measured(i)), measured(i)
         end do
      end do
   end subroutine compare_with_review

   function csv_head() result(line)
      character(:), allocatable :: line
      line = "method,order,slope_y,slope_q,kernel_slope_y,kernel_slope_q,kernel_off,Qy,C,H,"// &
         "norm,linear,poisson,symplectic,symmetric,reversible,symmetric_body,sphere,"// &
         "kernel_Qy,kernel_C,kernel_H,kernel_norm"
   end function csv_head

   !> Without a map its columns are empty.
   function csv_row(row) result(line)
      type(method_properties), intent(in) :: row
      character(:), allocatable :: line
      character(400) :: numbers
      if (row%has_map) then
         write (numbers, "(a, ',', i0, 20(',', es10.3))") trim(row%name), row%order, row%slope, &
            row%kernel_slope, row%distance, row%map%space, row%map%casimir, row%map%energy, &
            row%map%norm, row%linear, row%map%poisson, row%map%symplectic, row%map%symmetric, &
            row%map%reversible, row%symmetric_body, row%sphere, row%kernel
      else
         write (numbers, "(a, ',', i0, ',,', 2(',', es10.3), a, 4(',', es10.3))") trim(row%name), &
            row%order, row%kernel_slope, repeat(",", 12), row%kernel
      end if
      line = trim(numbers)
   end function csv_row

end module poinsot_study_properties
