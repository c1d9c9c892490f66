!> sn, cn, dn of arrays: ns per triple, beside GSL where it was found (HAVE_GSL).
!>
!> usage: elliptic [--quick] FOLDER      adds to times.csv there
program elliptic
   use, intrinsic :: iso_c_binding, only: c_double, c_int
   use poinsot_core_kinds, only: dp, i8
   use poinsot_elliptic_jacobi, only: jacobi_array
   use poinsot_rotation_random, only: random_uniform
   implicit none(type, external)

#ifdef HAVE_GSL
   interface
      integer(c_int) function gsl_sf_elljac_e(u, m, sn, cn, dn) bind(c)
         import :: c_double, c_int
         implicit none(type, external)
         real(c_double), value :: u, m
         real(c_double), intent(out) :: sn, cn, dn
      end function gsl_sf_elljac_e
   end interface
#endif

   integer, parameter :: n = 2048
   real(dp), dimension(n) :: u, m, m1, sn, cn, dn
   real(dp) :: pair(2), off
   character(256) :: folder
   integer :: i, table

   do i = 1, n
      pair = random_uniform(7_i8, int(i, i8), 0_i8, 0)
      u(i) = 20*pair(1) - 10
      m(i) = pair(2)
   end do
   m1 = 1 - m
   call get_command_argument(command_argument_count(), folder)
   open (newunit=table, file=trim(folder)//"/times.csv", position="append", action="write")
   print "(/, a, /)", &
      "elliptic functions: ns per triple sn, cn, dn, arrays of 2048, "// &
      "|u| <= 10, 0 <= m <= 1: median (minimum)"
   call time(1, "poinsot")
#ifdef HAVE_GSL
   block
      real(dp), dimension(n) :: s, c, d
      s = sn
      c = cn
      d = dn
      call time(2, "GSL")
      off = max(maxval(abs(s - sn)), maxval(abs(c - cn)), maxval(abs(d - dn)))
      print "(a, es8.1)", "   largest difference between the two: ", off
   end block
#else
   off = 0
   print "(a)", "   GSL was not found"
#endif
   close (table)

contains

   subroutine time(who, name)
      integer, intent(in) :: who
      character(*), intent(in) :: name
      integer, parameter :: repeats = 51
      real(dp) :: ns(repeats), start, finish, keep
      integer :: i, j, calls
      calls = merge(10, 1, who == 1)
      do i = 1, repeats
         call cpu_time(start)
         do j = 1, calls
            call run(who)
         end do
         call cpu_time(finish)
         ns(i) = 1e9_dp*(finish - start)/(real(n, dp)*calls)
      end do
      do i = 2, repeats
         do j = i, 2, -1
            if (ns(j - 1) <= ns(j)) exit
            keep = ns(j)
            ns(j) = ns(j - 1)
            ns(j - 1) = keep
         end do
      end do
      print "(3x, a12, f8.2, ' (', f0.2, ')')", name, ns((repeats + 1)/2), ns(1)
      write (table, "(a, ',', a, ',0,arrays,', i0, ',1,1,0', 3(',', f0.4))") "elliptic", name, n, &
         ns((repeats + 1)/2), ns(1), 0.5_dp*(ns(39) - ns(13))/ns(26)
   end subroutine time

   subroutine run(who)
      integer, intent(in) :: who
#ifdef HAVE_GSL
      integer :: k, answer
      if (who == 2) then
         do k = 1, n
            answer = gsl_sf_elljac_e(u(k), m(k), sn(k), cn(k), dn(k))
            if (answer /= 0) print "(a)", "   GSL refuses"
         end do
         return
      end if
#endif
      if (who == 1) call jacobi_array(u, m, m1, sn, cn, dn)
   end subroutine run

end program elliptic
