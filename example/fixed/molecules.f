C     A fixed-form host with implicit interfaces: water and nitrogen,
C     kicked and drifted as in a molecular-dynamics code.
C     gfortran molecules.f $(pkg-config --libs poinsot)
      PROGRAM MOLECS
      INTEGER NMOL
      PARAMETER (NMOL = 300)
      INTEGER*8 PLAN
      INTEGER CLASS(NMOL), EACH(NMOL), NUMBER, STATUS, I, K, VERSN
      DOUBLE PRECISION Y(3,NMOL), Q(4,NMOL), TORQUE(3,NMOL)
      DOUBLE PRECISION KIN(NMOL), POT(NMOL), WATER(3), NITRO(3)
      DOUBLE PRECISION H, BEFORE, AFTER
      EXTERNAL FIELD
      DATA WATER /0.58D0, 1.18D0, 1.76D0/, NITRO /8.4D0, 8.4D0, 0.0D0/
      DATA H /0.05D0/

      CALL POINSOT_VERSION_F(VERSN, STATUS)
      CALL CHECK('version', STATUS)
      CALL POINSOT_PLAN_CREATE_F(PLAN, STATUS)
      CALL CHECK('create', STATUS)
      CALL POINSOT_PLAN_ADD_CLASS_F(PLAN, WATER, NUMBER, STATUS)
      CALL CHECK('water', STATUS)
      CALL POINSOT_PLAN_ADD_CLASS_F(PLAN, NITRO, NUMBER, STATUS)
      CALL CHECK('nitrogen', STATUS)
C     option 1: the method, 1 = exact; option 5: the frame of torques,
C     2 = space; option 2: the splitting, 1 = strang
      CALL POINSOT_PLAN_SET_F(PLAN, 1, 1, STATUS)
      CALL CHECK('method', STATUS)
      CALL POINSOT_PLAN_SET_F(PLAN, 5, 2, STATUS)
      CALL CHECK('frame', STATUS)
      CALL POINSOT_PLAN_SET_F(PLAN, 2, 1, STATUS)
      CALL CHECK('splitting', STATUS)
      CALL POINSOT_PLAN_READY_F(PLAN, STATUS)
      CALL CHECK('ready', STATUS)

      DO 20 I = 1, NMOL
         CLASS(I) = 1 + MOD(I, 2)
         Y(1,I) = SIN(DBLE(I))
         Y(2,I) = COS(DBLE(I))
C        nitrogen has no momentum about its axis
         Y(3,I) = 0.3D0*MOD(I + 1, 2)
         Q(1,I) = 1
         DO 10 K = 2, 4
            Q(K,I) = 0
   10    CONTINUE
   20 CONTINUE
      CALL TOTAL(PLAN, NMOL, Y, Q, CLASS, KIN, POT, BEFORE)

C     kick, drift, kick: ten steps with the host's own torques ...
      DO 40 K = 1, 10
         CALL FIELD(NMOL, Q, TORQUE, 3, 1)
         CALL POINSOT_KICK_F(PLAN, NMOL, Y, Q, CLASS, H/2, TORQUE,
     &                       EACH, STATUS)
         CALL CHECK('kick', STATUS)
         CALL POINSOT_DRIFT_F(PLAN, NMOL, Y, Q, CLASS, H, EACH, STATUS)
         CALL CHECK('drift', STATUS)
         CALL FIELD(NMOL, Q, TORQUE, 3, 1)
         CALL POINSOT_KICK_F(PLAN, NMOL, Y, Q, CLASS, H/2, TORQUE,
     &                       EACH, STATUS)
         CALL CHECK('kick', STATUS)
   40 CONTINUE
C     ... and ten more in one call, which calls back for them
      CALL STEPS(PLAN, NMOL, Y, Q, CLASS, H, EACH, STATUS)
      CALL CHECK('step', STATUS)
      CALL TOTAL(PLAN, NMOL, Y, Q, CLASS, KIN, POT, AFTER)
      CALL POINSOT_PLAN_DESTROY_F(PLAN)
      IF (PLAN .NE. 0) STOP 2
      WRITE (*, '(A, F12.6, A, F12.6)') ' H before ', BEFORE,
     &   '   after ', AFTER
      IF (ABS(AFTER - BEFORE) .GT. 1D-3*ABS(BEFORE)) STOP 3
      END

C     Ten steps in one call: the library calls ASKED for torques
      SUBROUTINE STEPS(PLAN, N, Y, Q, CLASS, H, EACH, STATUS)
      INTEGER*8 PLAN
      INTEGER N, CLASS(*), EACH(*), STATUS
      DOUBLE PRECISION Y(*), Q(*), H
      EXTERNAL ASKED
      CALL POINSOT_STEP_TORQUE_F(PLAN, N, Y, Q, CLASS, 0D0, H, 10, 10,
     &                           ASKED, EACH, STATUS)
      END

      SUBROUTINE ASKED(T, N, Q, TORQUE, STOP)
      INTEGER N, STOP
      DOUBLE PRECISION T, Q(N,4), TORQUE(N,3)
      CALL FIELD(N, Q, TORQUE, 1, N)
      STOP = 0
      END

C     Dipole along body axis 1, field along space axis 3: torque in
C     the space frame. Component K of body I is NB*(I-1) + NC*(K-1)
C     numbers after the first, with 4 for Q instead of 3.
      SUBROUTINE FIELD(N, Q, TORQUE, NB, NC)
      INTEGER N, NB, NC, I, J, L
      DOUBLE PRECISION Q(*), TORQUE(*), A, B, C, D
      DO 10 I = 1, N
         J = 1 + (I - 1)*NB
         L = J
         IF (NB .GT. 1) L = 1 + (I - 1)*4
         A = Q(L)
         B = Q(L + NC)
         C = Q(L + 2*NC)
         D = Q(L + 3*NC)
         TORQUE(J) = 2*(B*C + A*D)
         TORQUE(J + NC) = -(A*A + B*B - C*C - D*D)
         TORQUE(J + 2*NC) = 0
   10 CONTINUE
      END

C     Total energy; that of the field is -mu.E = -Q31
      SUBROUTINE TOTAL(PLAN, N, Y, Q, CLASS, KIN, POT, H)
      INTEGER*8 PLAN
      INTEGER N, CLASS(*), STATUS, I
      DOUBLE PRECISION Y(3,*), Q(4,*), KIN(*), POT(*), H
      CALL POINSOT_ENERGY_F(PLAN, N, Y, Q, CLASS, 0D0, KIN, POT, STATUS)
      CALL CHECK('energy', STATUS)
      H = 0
      DO 10 I = 1, N
         H = H + KIN(I) + POT(I)
     &         - 2*(Q(2,I)*Q(4,I) - Q(1,I)*Q(3,I))
   10 CONTINUE
      END

      SUBROUTINE CHECK(WHAT, STATUS)
      CHARACTER*(*) WHAT
      INTEGER STATUS
      IF (STATUS .EQ. 0) RETURN
      WRITE (*, *) WHAT, ': status ', STATUS
      STOP 1
      END
