! Rotation of DL_POLY 5's rigid bodies by poinsot, all bodies of a domain in one call. Compiled with the host; use_poinsot.sh inserts the
! calls: the loop of a first stage over bodies is split in two, and the bodies are rotated between its halves.
Module poinsot_rigid
  Use errors_warnings, Only: error
  Use kinds,           Only: wp
  Use poinsot_legacy,  Only: poinsot_drift_c_f, poinsot_plan_add_class_f, poinsot_plan_create_f, &
                             poinsot_plan_ready_f, poinsot_plan_set_f, poinsot_status_text_f
  Use rigid_bodies,    Only: no_squish, rigid_bodies_type

  Implicit None

  Private

  Public :: poinsot_begin, poinsot_keep, poinsot_turn, poinsot_take

  Integer(Kind=8) :: plan = 0 ! one per process, as it has one system
  Integer(Kind=4), Allocatable :: kind_of(:), each(:)
  Real(Kind=wp), Allocatable :: p0_of(:), p1_of(:), p2_of(:), p3_of(:), force(:, :)

Contains

  ! Before the first loop: allocate for the bodies of this domain, all of them skipped at first.
  Subroutine poinsot_begin(rigid)
    Type(rigid_bodies_type), Intent(In   ) :: rigid

    If (plan == 0) Call make_plan(rigid)
    If (Allocated(kind_of)) Then
      If (Size(kind_of) < rigid%n_types) Deallocate (kind_of, each, p0_of, p1_of, p2_of, p3_of, force)
    End If
    If (.not. Allocated(kind_of)) Then
      Allocate (kind_of(rigid%max_rigid), each(rigid%max_rigid), force(3, rigid%max_rigid), p0_of(rigid%max_rigid), &
                p1_of(rigid%max_rigid), p2_of(rigid%max_rigid), p3_of(rigid%max_rigid))
    End If
    kind_of = -1 ! is skipped
    p0_of = 0.0_wp; p1_of = 0.0_wp; p2_of = 0.0_wp; p3_of = 0.0_wp
  End Subroutine poinsot_begin

  ! Types of bodies are classes. Where the host has 1/I = 0 the moment is 0, whatever rounding errors left there.
  Subroutine make_plan(rigid)
    Type(rigid_bodies_type), Intent(In   ) :: rigid

    Integer         :: k
    Integer(Kind=4) :: number, status
    Real(Kind=wp)   :: moments(3)

    Call poinsot_plan_create_f(plan, status)
    Call require(status, 'plan')
    Do k = 1, rigid%max_type
      moments = [rigid%rix(1, k), rigid%riy(1, k), rigid%riz(1, k)]
      Where ([rigid%rix(2, k), rigid%riy(2, k), rigid%riz(2, k)] == 0.0_wp) moments = 0.0_wp
      If (rigid%frozen(0, k) > 0) moments = 1.0_wp ! not turned by poinsot: see poinsot_keep
      Call poinsot_plan_add_class_f(plan, moments, number, status)
      Call require(status, 'moments of a type of rigid bodies')
    End Do
    Call poinsot_plan_set_f(plan, 3_4, 4_4, status) ! layout: conjugate momenta
    Call require(status, 'layout')
    Call poinsot_plan_ready_f(plan, status)
    Call require(status, 'plan')
  End Subroutine make_plan

  ! In the first loop, in place of no_squish: the momentum p after the kick, and the force on the centre of mass, of body i. A type with
  ! frozen particles can rotate only about some axes, marked by 1/I = 0: the host's own rotation handles it.
  Subroutine poinsot_keep(i, tstep, rigid, p0, p1, p2, p3, fmx, fmy, fmz)
    Integer,                 Intent(In   ) :: i
    Real(Kind=wp),           Intent(In   ) :: tstep, fmx, fmy, fmz
    Type(rigid_bodies_type), Intent(InOut) :: rigid
    Real(Kind=wp),           Intent(InOut) :: p0, p1, p2, p3

    Integer :: k

    k = rigid%list(0, i)
    If (rigid%frozen(0, k) > 0) Then
      Call no_squish(tstep, rigid%rix(2, k), rigid%riy(2, k), rigid%riz(2, k), &
                     rigid%q0(i), rigid%q1(i), rigid%q2(i), rigid%q3(i), p0, p1, p2, p3)
    Else
      kind_of(i) = k
    End If
    p0_of(i) = p0; p1_of(i) = p1; p2_of(i) = p2; p3_of(i) = p3
    force(:, i) = [fmx, fmy, fmz]
  End Subroutine poinsot_keep

  ! Between the loops: free rotation of all bodies over tstep, on the host's own quaternions.
  Subroutine poinsot_turn(tstep, rigid)
    Real(Kind=wp),           Intent(In   ) :: tstep
    Type(rigid_bodies_type), Intent(InOut) :: rigid

    Character(Len=72) :: text
    Character(Len=20) :: number
    Integer           :: i
    Integer(Kind=4)   :: status

    If (rigid%n_types < 1) Return
    Call poinsot_drift_c_f(plan, Int(rigid%n_types, 4), p0_of, p1_of, p2_of, p3_of, rigid%q0, rigid%q1, rigid%q2, rigid%q3, &
                           kind_of, tstep, each, status)
    If (status == 0) Return
    Do i = 1, rigid%n_types
      If (each(i) == 0) Cycle
      Call poinsot_status_text_f(each(i), text, Len(text, 4))
      Write (number, '(i0)') i
      Call error(0, 'poinsot: rigid body '//Trim(number)//' of this domain: '//Trim(text))
    End Do
    Call require(status, 'free rotation')
  End Subroutine poinsot_turn

  ! In the second loop: return the stored data of body i, rotated.
  Subroutine poinsot_take(i, p0, p1, p2, p3, fmx, fmy, fmz)
    Integer,       Intent(In   ) :: i
    Real(Kind=wp), Intent(  Out) :: p0, p1, p2, p3, fmx, fmy, fmz

    p0 = p0_of(i); p1 = p1_of(i); p2 = p2_of(i); p3 = p3_of(i)
    fmx = force(1, i); fmy = force(2, i); fmz = force(3, i)
  End Subroutine poinsot_take

  ! Status 0 is OK; any other ends the run, with poinsot's message.
  Subroutine require(status, what)
    Integer(Kind=4),  Intent(In   ) :: status
    Character(Len=*), Intent(In   ) :: what

    Character(Len=72) :: text

    If (status == 0) Return
    Call poinsot_status_text_f(status, text, Len(text, 4))
    Call error(0, 'poinsot: '//what//': '//Trim(text))
  End Subroutine require
End Module poinsot_rigid
