!> Data the library did not make: readers for test/data, and the published end states as constants.
module test_oracle_data
   use poinsot_core_kinds, only: dp, qp
   implicit none(type, external)
   private
   public :: free_case, read_free_rotation, top_case, read_top, dmv_term, read_dmv_coefficients
   public :: published, published_1, published_2a, published_2b, published_3, published_4_y

   character(*), parameter :: folder = "test/data/"

   !> A row of free_rotation.csv.
   type :: free_case
      character(12) :: kind = ""
      integer :: line = 0                            !! in the file, the header is line 1
      real(dp) :: moments(3) = 0, y(3) = 0, h = 0
      real(qp) :: y_end(3) = 0, turn(4) = 0          !! y(h), and the rotation over h
      real(dp) :: cond_y = 1, cond_r = 1, state_y = 1, state_r = 1
   end type free_case

   !> A row of top.csv.
   type :: top_case
      real(dp) :: moments(3) = 0, y(3) = 0, q(4) = 0, centre(3) = 0, direction(3) = 0, t = 0
      real(qp) :: y_end(3) = 0, q_end(4) = 0
   end type top_case

   !> One term of dmv_coefficients.txt: value C^c H^h e1^e(1) e2^e(2) e3^e(3) of s_k or t_k.
   type :: dmv_term
      character(1) :: letter = " "
      integer :: k = 0, c = 0, h = 0, e(3) = 0
      real(qp) :: value = 0
   end type dmv_term

   !> A published motion: from q = 1 over the time t.
   type :: published
      real(dp) :: moments(3), y(3), t, h, y_end(3), q_end(4)
      real(dp) :: digits !! half a unit of the last printed digit, doubled for the reader's safety
   end type published

   !> Vilmart 2013, figure 1 (order 10, h = .01).
   type(published), parameter :: published_1 = published( &
      [0.376_dp, 0.627_dp, 1.0_dp], [0.0_dp, 0.6_dp, -0.8_dp], &
      40.0_dp, 0.01_dp, [0.0545936805170048_dp, -0.5930307093190378_dp, -0.8033268997439126_dp], &
      [-0.7620456033094549_dp, -0.5769991038241422_dp, -0.0272197283757480_dp, &
      0.2926048855539088_dp], 1.0e-15_dp)

   !> Hairer and Vilmart 2006, figure 1, both bodies.
   type(published), parameter :: published_2a = published( &
      [0.6_dp, 0.8_dp, 1.0_dp], [1.8_dp, 0.4_dp, -0.9_dp], &
      10.0_dp, 0.0125_dp, [1.765963_dp, -0.6954642_dp, 0.7795550_dp], &
      [-0.7360614_dp, -0.5707870_dp, -0.2993886_dp, -0.2068391_dp], 1.0e-6_dp)
   type(published), parameter :: published_2b = published( &
      [0.345_dp, 0.653_dp, 1.0_dp], [1.8_dp, 0.4_dp, -0.9_dp], &
      10.0_dp, 0.0125_dp, [1.805749_dp, -0.2931591_dp, 0.9291552_dp], &
      [-0.5909531_dp, 0.7497771_dp, -0.2775674_dp, -0.1075407_dp], 1.0e-6_dp)

   !> The same as a top with U = Q33 (H = 4.205): centre (0, 0, 1), direction (0, 0, 1).
   type(published), parameter :: published_3 = published( &
      [0.6_dp, 0.8_dp, 1.0_dp], [1.8_dp, 0.4_dp, -0.9_dp], &
      10.0_dp, 0.01_dp, [1.922573381663007_dp, 0.7720232344670848_dp, -0.2011054792035490_dp], &
      [0.9257399890934638_dp, -0.3514906679727545_dp, 0.1021838760186523_dp, &
      -0.0949644059798463_dp], 1.0e-15_dp)

   !> ACM TOMS 903 (Celledoni et al. 2008), example 0: momentum only, the attitude was not printed.
   !> The printed y2 is 4e-15 off (|y| of the printed end differs by 3e-15 from that of the start).
   type(published), parameter :: published_4_y = published( &
      [1.0_dp, 1.6487857827119290_dp, 1.9720127096641928_dp], &
      [-0.709894965287627_dp, -0.685144717153483_dp, 0.163174308075589_dp], 0.1_dp, 0.1_dp, &
      [-0.7088447919224319_dp, -0.6905148054187735_dp, 0.1439734852739133_dp], &
      [0.0_dp, 0.0_dp, 0.0_dp, 0.0_dp], 5.0e-15_dp)

contains

   !> All rows of free_rotation.csv; an empty array if the file cannot be read.
   subroutine read_free_rotation(cases)
      type(free_case), allocatable, intent(out) :: cases(:)
      character(:), allocatable :: line
      integer :: unit, i, n, comma
      real(qp) :: x(18)
      n = count_rows(folder//"free_rotation.csv")
      allocate (cases(n))
      if (n == 0) return
      open (newunit=unit, file=folder//"free_rotation.csv", status="old", action="read")
      call read_line(unit, line)
      do i = 1, n
         call read_line(unit, line)
         comma = index(line, ",")
         cases(i)%kind = line(:comma - 1)
         cases(i)%line = i + 1
         read (line(comma + 1:), *) x
         cases(i)%moments = real(x(1:3), dp)
         cases(i)%y = real(x(4:6), dp)
         cases(i)%h = real(x(7), dp)
         cases(i)%y_end = x(8:10)
         cases(i)%turn = x(11:14)
         cases(i)%cond_y = real(x(15), dp)
         cases(i)%cond_r = real(x(16), dp)
         cases(i)%state_y = real(x(17), dp)
         cases(i)%state_r = real(x(18), dp)
      end do
      close (unit)
   end subroutine read_free_rotation

   !> All rows of top.csv; an empty array if the file cannot be read.
   subroutine read_top(cases)
      type(top_case), allocatable, intent(out) :: cases(:)
      character(:), allocatable :: line
      integer :: unit, i, n
      real(qp) :: x(24)
      n = count_rows(folder//"top.csv")
      allocate (cases(n))
      if (n == 0) return
      open (newunit=unit, file=folder//"top.csv", status="old", action="read")
      call read_line(unit, line)
      do i = 1, n
         call read_line(unit, line)
         read (line, *) x
         cases(i)%moments = real(x(1:3), dp)
         cases(i)%y = real(x(4:6), dp)
         cases(i)%q = real(x(7:10), dp)
         cases(i)%centre = real(x(11:13), dp)
         cases(i)%direction = real(x(14:16), dp)
         cases(i)%t = real(x(17), dp)
         cases(i)%y_end = x(18:20)
         cases(i)%q_end = x(21:24)
      end do
      close (unit)
   end subroutine read_top

   !> All terms of dmv_coefficients.txt, in the order of the file.
   subroutine read_dmv_coefficients(terms)
      type(dmv_term), allocatable, intent(out) :: terms(:)
      character(*), parameter :: name = folder//"dmv_coefficients.txt"
      character(:), allocatable :: line
      integer :: unit, rows, i, n, place, colon
      type(dmv_term) :: head
      rows = count_rows(name)
      allocate (terms(0))
      if (rows == 0) return
      n = 0
      deallocate (terms)
      allocate (terms(8192))
      open (newunit=unit, file=name, status="old", action="read")
      do i = 1, rows + 1
         call read_line(unit, line)
         if (line(1:1) == "#") cycle
         head%letter = line(1:1)
         colon = index(line, ":")
         read (line(2:colon - 1), *) head%k
         place = index(line, "C^")
         read (line(place + 2:place + 4), *) head%c
         place = index(line, "H^")
         read (line(place + 2:place + 4), *) head%h
         place = index(line, ":", back=.true.)
         call read_terms(line(place + 1:), head, terms, n)
      end do
      close (unit)
      terms = terms(1:n)
   end subroutine read_dmv_coefficients

   !> The terms of one row, each like +17/2520*e1^0*e2^3*e3^0, parted by blanks.
   subroutine read_terms(text, head, terms, n)
      character(*), intent(in) :: text
      type(dmv_term), intent(in) :: head
      type(dmv_term), intent(inout) :: terms(:)
      integer, intent(inout) :: n
      character(:), allocatable :: word, rest
      integer :: blank, slash, star
      real(qp) :: top, bottom
      rest = trim(adjustl(text))
      do while (len(rest) > 0)
         blank = index(rest//" ", " ")
         word = rest(:blank - 1)
         rest = trim(adjustl(rest(min(blank, len(rest) + 1):)))
         star = index(word, "*")
         slash = index(word(:star), "/")
         bottom = 1
         if (slash > 0) then
            read (word(:slash - 1), *) top
            read (word(slash + 1:star - 1), *) bottom
         else
            read (word(:star - 1), *) top
         end if
         n = n + 1
         terms(n) = head
         terms(n)%value = top/bottom
         terms(n)%e = [power(word, "e1^"), power(word, "e2^"), power(word, "e3^")]
      end do
   end subroutine read_terms

   !> The exponent that follows `name` in `word`.
   integer function power(word, name)
      character(*), intent(in) :: word, name
      integer :: first, last
      first = index(word, name) + len(name)
      last = index(word(first:)//"*", "*") + first - 2
      read (word(first:last), *) power
   end function power

   !> Lines of a file less one for its header; 0 if it cannot be opened.
   integer function count_rows(name)
      character(*), intent(in) :: name
      integer :: unit, status
      count_rows = 0
      open (newunit=unit, file=name, status="old", action="read", iostat=status)
      if (status /= 0) return
      count_rows = -1
      do
         read (unit, "(a)", iostat=status)
         if (status /= 0) exit
         count_rows = count_rows + 1
      end do
      close (unit)
      count_rows = max(count_rows, 0)
   end function count_rows

   !> One line of any length.
   subroutine read_line(unit, line)
      integer, intent(in) :: unit
      character(:), allocatable, intent(out) :: line
      character(512) :: buffer
      integer :: length, status
      line = ""
      do
         read (unit, "(a)", advance="no", size=length, iostat=status) buffer
         line = line//buffer(:length)
         if (status /= 0) exit
      end do
   end subroutine read_line

end module test_oracle_data
