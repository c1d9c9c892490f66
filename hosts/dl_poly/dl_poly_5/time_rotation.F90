! DL_POLY 5's own no_squish beside poinsot's call, on the same bodies: ns a body and step, the least of several rounds, and how far apart the
! attitudes are at the end of ten steps.
Program time_rotation
  Use, Intrinsic :: iso_fortran_env, Only: int64
  Use kinds,          Only: wp
  Use poinsot_legacy, Only: poinsot_drift_c_f, poinsot_plan_add_class_f, poinsot_plan_create_f, poinsot_plan_ready_f, &
                            poinsot_plan_set_f
  Use rigid_bodies,   Only: no_squish

  Implicit None

  Integer, Parameter :: n = 256, steps = 10, rounds = 400
  Real(Kind=wp), Parameter :: moments(3) = [1.34_wp, 1.92_wp, 0.58_wp], h = 1.0e-3_wp ! SPC/E water, amu A^2; ps
  Real(Kind=wp)    :: p(n, 0:3, 2), q(n, 0:3, 2), y(3), least(2), start(n, 0:7)
  Integer(Kind=4)  :: kind_of(n), each(n), status, number
  Integer(Kind=8)  :: plan
  Integer          :: i, k, round
  Integer(int64)   :: from, to, rate

  Call poinsot_plan_create_f(plan, status)
  Call poinsot_plan_add_class_f(plan, moments, number, status)
  Call poinsot_plan_set_f(plan, 3_4, 4_4, status)
  Call poinsot_plan_ready_f(plan, status)
  kind_of = 1
  Call Random_number(start)
  Do i = 1, n
    start(i, :3) = start(i, :3) / Norm2(start(i, :3))
    y = 40.0_wp * (start(i, 4:6) - 0.5_wp) ! some 10 radians a ps
    start(i, 4:) = 2.0_wp * [-Dot_product(start(i, 1:3), y), start(i, 0) * y(1) - start(i, 3) * y(2) + start(i, 2) * y(3), &
                             start(i, 3) * y(1) + start(i, 0) * y(2) - start(i, 1) * y(3), &
                             -start(i, 2) * y(1) + start(i, 1) * y(2) + start(i, 0) * y(3)]
  End Do
  least = Huge(1.0_wp)
  Do round = 1, rounds
    Do k = 1, 2
      q(:, :, k) = start(:, :3)
      p(:, :, k) = start(:, 4:)
    End Do
    Call System_clock(from, rate)
    Do k = 1, steps
      Do i = 1, n
        Call no_squish(h, 1.0_wp / moments(1), 1.0_wp / moments(2), 1.0_wp / moments(3), &
                       q(i, 0, 1), q(i, 1, 1), q(i, 2, 1), q(i, 3, 1), p(i, 0, 1), p(i, 1, 1), p(i, 2, 1), p(i, 3, 1))
      End Do
    End Do
    Call System_clock(to)
    least(1) = Min(least(1), Real(to - from, wp) / Real(rate, wp))
    Call System_clock(from)
    Do k = 1, steps
      Call poinsot_drift_c_f(plan, Int(n, 4), p(1, 0, 2), p(1, 1, 2), p(1, 2, 2), p(1, 3, 2), q(1, 0, 2), q(1, 1, 2), q(1, 2, 2), &
                             q(1, 3, 2), kind_of, h, each, status)
      If (status /= 0) Error Stop 'poinsot refuses'
    End Do
    Call System_clock(to)
    least(2) = Min(least(2), Real(to - from, wp) / Real(rate, wp))
  End Do
  Write (*, '(2f9.1, es10.2)') 1.0e9_wp * least / (n * steps), Maxval(Abs(q(:, :, 1) - q(:, :, 2)))
End Program time_rotation
