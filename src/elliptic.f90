!> The public module of elliptic functions and integrals: `use poinsot_elliptic`; in C they are
!> poinsot_elliptic_..., poinsot_jacobi..., poinsot_carlson_...
!>
!> The parameter is m = k**2, in [0, 1]; all functions of it have an optional last argument m1 = 1 -
!> m, for callers who know it more accurately than 1 - m gives. The characteristic n of Pi is the
!> one in 1 - n sin(t)**2. Elemental; reals are `kind(1d0)`. An argument outside the domain,
!> infinite or NaN gives NaN, without an exception.
module poinsot_elliptic
   ! K(m), E(m), Pi(n, m)
   use poinsot_elliptic_complete, only: elliptic_k => complete_k, elliptic_e => complete_e, &
      elliptic_pi => complete_pi
   ! F(phi, m), E(phi, m), Pi(n, phi, m)
   use poinsot_elliptic_legendre, only: elliptic_f => legendre_f, &
      elliptic_e_incomplete => legendre_e, elliptic_pi_incomplete => legendre_pi
   ! the same of s = sin(phi)
   use poinsot_elliptic_legendre, only: elliptic_f_sine => legendre_f_sine, &
      elliptic_e_sine => legendre_e_sine, elliptic_pi_sine => legendre_pi_sine
   ! am(u, m); sn, cn, dn; their inverses; forms for arrays, which are the fast ones
   use poinsot_elliptic_jacobi, only: jacobi_am, jacobi_functions, jacobi_array, jacobi_am_array
   use poinsot_elliptic_legendre, only: inverse_sn, inverse_cn, inverse_dn
   ! Carlson's R_F, R_C, R_D, R_J
   use poinsot_elliptic_carlson, only: carlson_rf, carlson_rc, carlson_rd, carlson_rj
   implicit none(type, external)
   public
end module poinsot_elliptic
