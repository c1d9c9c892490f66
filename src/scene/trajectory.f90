!> Trajectories as text: CSV for general use, extended XYZ for OVITO. Writers take plain arrays, one
!> call per frame; the caller selects the bodies.
module poinsot_scene_trajectory
   use poinsot_core_kinds, only: dp, i8
   use poinsot_core_error, only: poinsot_error, raised
   use poinsot_core_decimal, only: append_number, append_integer, longest_number
   use poinsot_scene_text, only: text_of
   use poinsot_scene_files, only: out_file, open_out, put
   implicit none(type, external)
   private
   public :: csv_header, csv_row, longest_row, open_csv, write_csv
   public :: open_xyz, begin_xyz, write_xyz, semi_axes

   character(*), parameter :: csv_header = &
      "t,body,q0,q1,q2,q3,y1,y2,y3,kinetic,potential,energy" !! the columns of trajectory.csv
   integer, parameter :: longest_row = 27*(longest_number + 1) !! characters

contains

   !> Begin trajectory.csv: the header.
   subroutine open_csv(path, more, file, error)
      character(*), intent(in) :: path    !! of the file
      character(*), intent(in) :: more(:) !! names of further columns
      type(out_file), intent(out) :: file !! open from here on
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: header
      integer :: i
      header = csv_header
      do i = 1, size(more)
         header = header // "," // trim(more(i))
      end do
      call open_out(path, file, error)
      if (.not. raised(error)) call put(file, header, error)
   end subroutine open_csv

   !> Rows of a frame, one for each body.
   subroutine write_csv(file, t, bodies, y, q, kinetic, potential, more, error)
      type(out_file), intent(in) :: file      !! open
      real(dp), intent(in) :: t               !! time
      integer(i8), intent(in) :: bodies(:)    !! (n): numbers of the bodies, from 1
      real(dp), intent(in) :: y(:, :)         !! (3, n): angular momenta, body frame as the scene's
      real(dp), intent(in) :: q(:, :)         !! (4, n): attitudes
      real(dp), intent(in) :: kinetic(:)      !! (n)
      real(dp), intent(in) :: potential(:)    !! (n)
      real(dp), intent(in) :: more(:, :)      !! (further columns, n)
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: time
      character(longest_row) :: row
      integer :: i, n
      time = text_of(t)
      do i = 1, size(bodies)
         call csv_row(time, bodies(i), y(:, i), q(:, i), kinetic(i), potential(i), row, n)
         call append_all(",", more(:, i), row, n)
         call put(file, row(:n), error)
         if (raised(error)) return
      end do
   end subroutine write_csv

   !> One row.
   pure subroutine csv_row(time, body, y, q, kinetic, potential, row, n)
      character(*), intent(in) :: time               !! as text
      integer(i8), intent(in) :: body
      real(dp), intent(in) :: y(3), q(4), kinetic, potential
      character(longest_row), intent(inout) :: row
      integer, intent(out) :: n                      !! characters in it
      n = len(time) + 1
      row(:n) = time // ","
      call append_integer(body, row, n)
      call append_all(",", q, row, n)
      call append_all(",", y, row, n)
      call append_all(",", [kinetic, potential, kinetic + potential], row, n)
   end subroutine csv_row

   !> A separator and a number, each in 17 significant digits, so that it reads back to its bits.
   pure subroutine append_all(separator, numbers, row, n)
      character, intent(in) :: separator
      real(dp), intent(in) :: numbers(:)
      character(*), intent(inout) :: row
      integer, intent(inout) :: n
      integer :: j
      do j = 1, size(numbers)
         n = n + 1
         row(n:n) = separator
         call append_number(numbers(j), row, n)
      end do
   end subroutine append_all

   !> Begin trajectory.xyz.
   subroutine open_xyz(path, file, error)
      character(*), intent(in) :: path    !! of the file
      type(out_file), intent(out) :: file !! open from here on
      type(poinsot_error), intent(inout) :: error
      call open_out(path, file, error)
   end subroutine open_xyz

   !> Begin a frame of extended XYZ, with the column names OVITO maps by itself: `orientation` is a
   !> quaternion in the order x, y, z, w; `aspherical_shape` the semi-axes of an ellipsoid.
   subroutine begin_xyz(file, t, n, error)
      type(out_file), intent(in) :: file      !! open
      real(dp), intent(in) :: t               !! time
      integer(i8), intent(in) :: n            !! rows that follow
      type(poinsot_error), intent(inout) :: error
      call put(file, text_of(n), error)
      call put(file, &
         "Properties=id:I:1:species:S:1:pos:R:3:orientation:R:4:aspherical_shape:R:3" // &
               ":angular_momentum:R:3:body_energy:R:1 Time=" // text_of(t) // " pbc=""F F F""", &
                  error)
   end subroutine begin_xyz

   !> Rows of a frame, one for each body.
   subroutine write_xyz(file, bodies, position, shape, y, q, energy, error)
      type(out_file), intent(in) :: file      !! open
      integer(i8), intent(in) :: bodies(:)    !! (n): numbers of the bodies, from 1
      real(dp), intent(in) :: position(:, :)  !! (3, n)
      real(dp), intent(in) :: shape(:, :)     !! (3, n): semi-axes
      real(dp), intent(in) :: y(:, :)         !! (3, n): angular momenta, space frame
      real(dp), intent(in) :: q(:, :)         !! (4, n): attitudes of the axes of `shape`
      real(dp), intent(in) :: energy(:)       !! (n)
      type(poinsot_error), intent(inout) :: error
      character(longest_row) :: row
      integer :: i, n
      do i = 1, size(bodies)
         n = 0
         call append_integer(bodies(i), row, n)
         row(n + 1:n + 2) = " X" ! no chemical element
         n = n + 2
         call append_all(" ", position(:, i), row, n)
         call append_all(" ", [q(2:4, i), q(1, i)], row, n)
         call append_all(" ", shape(:, i), row, n)
         call append_all(" ", [y(:, i), energy(i)], row, n)
         call put(file, row(:n), error)
         if (raised(error)) return
      end do
   end subroutine write_xyz

   !> Semi-axes of an even ellipsoid of mass 5 with these moments: a_i^2 = (I_j + I_k - I_i)/2. A
   !> flat or linear body gets a twentieth of its longest semi-axis, so that it can be seen.
   pure function semi_axes(moments) result(a)
      real(dp), intent(in) :: moments(3) !! principal moments
      real(dp) :: a(3), unit
      unit = maxval(moments)
      a = 1
      if (unit <= 0) return
      a = moments/unit
      a = sqrt(max((sum(a) - 2*a)/2, 0.0_dp))
      a = max(a, maxval(a)/20)*sqrt(unit)
   end function semi_axes

end module poinsot_scene_trajectory
