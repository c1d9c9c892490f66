!> Moments of named shapes: solids of uniform density, and molecules.
!>
!> A name is a row of a table. Solids have a mass and up to three lengths and are centred on their
!> principal axes; molecules have a given mass and size, in amu and angstrom.
module poinsot_body_shapes
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use poinsot_core_kinds, only: dp
   use poinsot_core_status, only: poinsot_e_domain, poinsot_e_method
   use poinsot_core_error, only: poinsot_error, raise, raised
   use poinsot_rotation_vector, only: largest_exponent
   implicit none(type, external)
   private
   public :: shape_moments, shape_names, shape_count, shape_help, shape_sizes, name_length

   !> Length of a shape's name, blanks included.
   integer, parameter :: name_length = 16

   !> One shape: d_k = mass sum_j spread(k, j) size(j)^2 for a solid, the moments themselves for a
   !> molecule.
   type :: shape_row
      character(name_length) :: name
      integer :: sizes                 ! how many lengths it takes; 0: a molecule
      real(dp) :: spread(3, 3)         ! column j: what size(j)^2 adds to d_1, d_2, d_3
      real(dp) :: moments(3)           ! of a molecule, amu angstrom^2
      character(112) :: help           ! sizes and axes, or the source
   end type shape_row

   real(dp), parameter :: none(3) = 0
   real(dp), parameter :: no_spread(3, 3) = 0

   !> Standard atomic weights (IUPAC 2021, abridged), amu.
   real(dp), parameter :: hydrogen = 1.008_dp, carbon = 12.011_dp, nitrogen = 14.007_dp, &
      oxygen = 15.999_dp

   !> SPC/E water (Berendsen, Grigera, Straatsma, J. Phys. Chem. 91, 6269, 1987): OH 1 angstrom,
   !> tetrahedral angle, cos = -1/3. d along H-H is 2 m_H 2/3; d along the twofold axis is 2 m_H
   !> m_O/(m_O + 2 m_H) 1/3; flat.
   real(dp), parameter :: water_d1 = 4*hydrogen/3
   real(dp), parameter :: water_d3 = 2*hydrogen*oxygen/(oxygen + 2*hydrogen)/3

   !> N2, r_e 1.09768 angstrom (Huber and Herzberg, Constants of Diatomic Molecules, 1979).
   real(dp), parameter :: nitrogen_d3 = nitrogen/2*1.09768_dp**2

   !> CO2, r_e(CO) 1.1600 angstrom (Herzberg, Electronic Spectra of Polyatomic Molecules, 1966).
   real(dp), parameter :: carbon_dioxide_d3 = 2*oxygen*1.16_dp**2

   !> Benzene, CC 1.397, CH 1.084 angstrom (Herzberg 1966); a regular hexagon has d = 3 m r^2 along
   !> either axis.
   real(dp), parameter :: benzene_d1 = 3*(carbon*1.397_dp**2 + hydrogen*(1.397_dp + 1.084_dp)**2)

   type(shape_row), parameter :: table(11) = [ &
      shape_row("box", 3, reshape([1, 0, 0, 0, 1, 0, 0, 0, 1]/12._dp, [3, 3]), none, &
         "edges along axes 1, 2, 3"), &
      shape_row("ellipsoid", 3, reshape([1, 0, 0, 0, 1, 0, 0, 0, 1]/5._dp, [3, 3]), none, &
         "semi-axes along axes 1, 2, 3"), &
      shape_row("sphere", 1, reshape([1, 1, 1, 0, 0, 0, 0, 0, 0]/5._dp, [3, 3]), none, &
         "radius"), &
      shape_row("cylinder", 2, reshape([3, 3, 0, 0, 0, 1, 0, 0, 0]/12._dp, [3, 3]), none, &
         "radius, height along axis 3"), &
      shape_row("rod", 1, reshape([0, 0, 1, 0, 0, 0, 0, 0, 0]/12._dp, [3, 3]), none, &
         "length along axis 3, no thickness"), &
      shape_row("plate", 2, reshape([1, 0, 0, 0, 1, 0, 0, 0, 0]/12._dp, [3, 3]), none, &
         "edges along axes 1, 2, no thickness"), &
      shape_row("disc", 1, reshape([1, 1, 0, 0, 0, 0, 0, 0, 0]/4._dp, [3, 3]), none, &
         "radius, normal axis 3, no thickness"), &
      shape_row("water", 0, no_spread, [water_d3, water_d3 + water_d1, water_d1], &
         "SPC/E, amu A^2; axis 1 along H-H, axis 3 twofold (Berendsen, Grigera, Straatsma 1987)"), &
      shape_row("nitrogen", 0, no_spread, [nitrogen_d3, nitrogen_d3, 0._dp], &
         "N2, amu A^2; axis 3 along the bond (Huber, Herzberg 1979)"), &
      shape_row("carbon-dioxide", 0, no_spread, [carbon_dioxide_d3, carbon_dioxide_d3, 0._dp], &
         "CO2, amu A^2; axis 3 along the bonds (Herzberg 1966)"), &
      shape_row("benzene", 0, no_spread, [benzene_d1, benzene_d1, 2*benzene_d1], &
         "C6H6, amu A^2; axis 3 normal to the ring (Herzberg 1966)")]

   !> Number of shapes.
   integer, parameter :: shape_count = size(table)

contains

   !> Principal moments of a named shape, about its centre of mass, in the order of its axes.
   pure subroutine shape_moments(name, mass, lengths, moments, error)
      character(*), intent(in) :: name            !! one of `shape_names()`
      real(dp), intent(in) :: mass                !! of a solid, positive; 0 for a molecule
      real(dp), intent(in) :: lengths(3)          !! as `shape_help` says, positive; those it does
                                                  !! not take: 0
      real(dp), intent(out) :: moments(3)         !! mass times length squared, or amu angstrom^2; 0
                                                  !! if refused
      type(poinsot_error), intent(inout) :: error !! poinsot_e_method for an unknown name,
                                                  !! poinsot_e_domain for a value
      real(dp) :: d(3)
      integer :: row, ex
      moments = 0
      row = row_of(name)
      if (row == 0) then
         call raise(error, poinsot_e_method, &
            "unknown shape '"//trim(name)//"'; known: "//list_of_names())
         return
      end if
      if (.not. (ieee_is_finite(mass) .and. all(ieee_is_finite(lengths)))) then
         call raise(error, poinsot_e_domain, trim(name)//": mass or a size is not finite")
      else if (table(row)%sizes == 0) then
         if (abs(mass) > 0 .or. any(abs(lengths) > 0)) then
            call raise(error, poinsot_e_domain, &
               trim(name)//": a molecule brings its own mass and size, "// &
               "in amu and angstrom; leave both out")
         else
            moments = table(row)%moments
         end if
      else
         call check_solid(table(row), mass, lengths, error)
         if (raised(error)) return
         ex = largest_exponent(lengths)
         d = matmul(table(row)%spread, scale(lengths, -ex)**2)
         moments = scale(mass*[d(2) + d(3), d(3) + d(1), d(1) + d(2)], 2*ex)
      end if
   end subroutine shape_moments

   !> Refuse a mass or sizes that a solid cannot have, or whose moments are not representable.
   pure subroutine check_solid(solid, mass, lengths, error)
      type(shape_row), intent(in) :: solid
      real(dp), intent(in) :: mass, lengths(3)
      type(poinsot_error), intent(inout) :: error
      character(:), allocatable :: name
      name = trim(solid%name)
      if (mass <= 0) then
         call raise(error, poinsot_e_domain, name//": mass must be positive")
      else if (any(lengths(:solid%sizes) <= 0)) then
         call raise(error, poinsot_e_domain, &
            name//" takes positive sizes: "//trim(solid%help))
      else if (any(abs(lengths(solid%sizes + 1:)) > 0)) then
         call raise(error, poinsot_e_domain, &
            name//": too many sizes, it takes only: "//trim(solid%help))
      else if (abs(exponent(mass) + 2*largest_exponent(lengths)) > 1000) then
         call raise(error, poinsot_e_domain, &
            name//": moments beyond 1e-300 to 1e+300; use other units")
      end if
   end subroutine check_solid

   !> Names of all shapes.
   pure function shape_names() result(names)
      character(name_length) :: names(shape_count)
      names = table%name
   end function shape_names

   !> What the sizes of a shape are, or where a molecule's geometry is from; empty for an unknown
   !> name.
   pure function shape_help(name) result(text)
      character(*), intent(in) :: name !! a shape
      character(:), allocatable :: text
      integer :: row
      row = row_of(name)
      text = ""
      if (row > 0) text = trim(table(row)%help)
   end function shape_help

   !> How many sizes a shape takes: 1 to 3 for a solid, 0 for a molecule, -1 for an unknown name.
   pure integer function shape_sizes(name)
      character(*), intent(in) :: name !! a shape
      integer :: row
      row = row_of(name)
      shape_sizes = -1
      if (row > 0) shape_sizes = table(row)%sizes
   end function shape_sizes

   !> Row of a name in the table, 0 if there is none.
   pure integer function row_of(name)
      character(*), intent(in) :: name
      integer :: i
      row_of = 0
      do i = 1, shape_count
         if (table(i)%name == name) row_of = i
      end do
   end function row_of

   !> All names with commas, for a message.
   pure function list_of_names() result(text)
      character(:), allocatable :: text
      integer :: i
      text = trim(table(1)%name)
      do i = 2, shape_count
         text = text//", "//trim(table(i)%name)
      end do
   end function list_of_names

end module poinsot_body_shapes
