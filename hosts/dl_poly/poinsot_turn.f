C     Rotation of DL_POLY Classic's rigid bodies by poinsot. This file
C     is compiled with the host; use_poinsot.sh inserts the calls.
C
C     POINSOT_TURN    free rotation of bodies FIRST to LAST over H, in
C                     place of NOSQUISH: quaternions Q0 to Q3, conjugate
C                     momenta P0 to P3 = 2 q o (0, body momentum)
C     POINSOT_STAGE   lengths of the next kick and drift of the step
C
C     The plan, made at the first call, has a class for each type of
C     bodies: class K is type K of the host. One plan per process, which
C     has one system.
      SUBROUTINE POINSOT_TURN(FIRST, LAST, NGRP, H, MXTYPE, RX, RY, RZ,
     &                        KIND, Q0, Q1, Q2, Q3, P0, P1, P2, P3)
      IMPLICIT NONE
      INTEGER FIRST, LAST, NGRP, MXTYPE, KIND(NGRP)
      DOUBLE PRECISION H, RX(MXTYPE,2), RY(MXTYPE,2), RZ(MXTYPE,2)
      DOUBLE PRECISION Q0(*), Q1(*), Q2(*), Q3(*)
      DOUBLE PRECISION P0(*), P1(*), P2(*), P3(*)
      INTEGER*8 PLAN
      COMMON /PSPLAN/ PLAN
      DATA PLAN /0/
      INTEGER I, N, STATUS, EACH(MAX(1, LAST - FIRST + 1))
      CHARACTER*72 TEXT
      N = LAST - FIRST + 1
      IF (N .LT. 1) RETURN
      IF (PLAN .EQ. 0) CALL POINSOT_TYPES(MAXVAL(KIND), MXTYPE, RX, RY,
     &                                    RZ)
      I = FIRST
      CALL POINSOT_DRIFT_C_F(PLAN, N, P0(I), P1(I), P2(I), P3(I),
     &   Q0(I), Q1(I), Q2(I), Q3(I), KIND(I), H, EACH, STATUS)
      IF (STATUS .EQ. 0) RETURN
      DO 10 I = 1, N
         IF (EACH(I) .EQ. 0) GO TO 10
         CALL POINSOT_STATUS_TEXT_F(EACH(I), TEXT, 72)
         WRITE (*, *) 'poinsot: rigid body ', FIRST + I - 1, ' type ',
     &      KIND(FIRST + I - 1), ': ', TEXT
   10 CONTINUE
      CALL POINSOT_REFUSED('free rotation', STATUS)
      END

C     Types of bodies into a plan. Where the host has 1/I = 0, a linear
C     molecule, the moment is 0, whatever rounding errors left there.
      SUBROUTINE POINSOT_TYPES(NTYPE, MXTYPE, RX, RY, RZ)
      IMPLICIT NONE
      INTEGER NTYPE, MXTYPE, K, NUMBER, STATUS
      DOUBLE PRECISION RX(MXTYPE,2), RY(MXTYPE,2), RZ(MXTYPE,2), A(3)
      INTEGER*8 PLAN
      COMMON /PSPLAN/ PLAN
      CALL POINSOT_PLAN_CREATE_F(PLAN, STATUS)
      CALL POINSOT_REFUSED('a plan', STATUS)
      DO 10 K = 1, NTYPE
         A(1) = RX(K,1)
         A(2) = RY(K,1)
         A(3) = RZ(K,1)
         IF (RX(K,2) .EQ. 0) A(1) = 0
         IF (RY(K,2) .EQ. 0) A(2) = 0
         IF (RZ(K,2) .EQ. 0) A(3) = 0
         CALL POINSOT_PLAN_ADD_CLASS_F(PLAN, A, NUMBER, STATUS)
         CALL POINSOT_REFUSED('moments of a type', STATUS)
   10 CONTINUE
C     layout 4: conjugate momenta
      CALL POINSOT_PLAN_SET_F(PLAN, 3, 4, STATUS)
      CALL POINSOT_REFUSED('the layout', STATUS)
      CALL POINSOT_PLAN_READY_F(PLAN, STATUS)
      CALL POINSOT_REFUSED('the plan', STATUS)
      END

C     The host's velocity Verlet step is KICK, DRIFT, forces, KICK. A
C     splitting of more stages is a sequence of such steps whose kicks
C     and drifts have lengths of their own: the kick between two drifts
C     is half in one step of the host and half in the next. Environment
C     variable POINSOT_SPLITTING: the splitting's number, 6 is srkn4; 1,
C     or none, velocity Verlet. With NDRIFT drifts the splitting's step
C     is NDRIFT times TSTEP: TSTEP stays the time per force, and energies
C     are those of the splitting every NDRIFT steps.
C
C     ISW = 1 or 2, the half of the host's step, as the host calls it
      SUBROUTINE POINSOT_STAGE(ISW, TSTEP, HKICK, HDRIFT)
      IMPLICIT NONE
      INTEGER MAXST
      PARAMETER (MAXST = 64)
      INTEGER ISW, NDRIFT, STAGE, NUMBER, STATUS, I
      DOUBLE PRECISION TSTEP, HKICK, HDRIFT
      DOUBLE PRECISION CKICK(MAXST), CDRIFT(MAXST)
      CHARACTER*16 WORD
      SAVE NDRIFT, STAGE, CKICK, CDRIFT
      DATA NDRIFT /0/, STAGE /0/
      IF (NDRIFT .EQ. 0) THEN
         CALL GET_ENVIRONMENT_VARIABLE('POINSOT_SPLITTING', WORD)
         NUMBER = 1
         IF (WORD .NE. ' ') READ (WORD, *) NUMBER
         CALL POINSOT_SPLITTING_F(NUMBER, MAXST, CKICK, CDRIFT, I,
     &                            STATUS)
         CALL POINSOT_REFUSED('the splitting', STATUS)
         NDRIFT = I - 1
         IF (CDRIFT(I) .NE. 0 .OR. CKICK(1) .EQ. 0) CALL
     &      POINSOT_REFUSED('a splitting that begins with a drift', 4)
      END IF
      IF (ISW .EQ. 1) STAGE = MOD(STAGE, NDRIFT) + 1
      HDRIFT = CDRIFT(STAGE)*NDRIFT*TSTEP
      IF (ISW .EQ. 1) THEN
         HKICK = CKICK(STAGE)*NDRIFT*TSTEP
         IF (STAGE .GT. 1) HKICK = HKICK/2
      ELSE
         HKICK = CKICK(STAGE + 1)*NDRIFT*TSTEP
         IF (STAGE .LT. NDRIFT) HKICK = HKICK/2
      END IF
      END

C     Status 0 is OK; any other ends the run, with poinsot's message.
      SUBROUTINE POINSOT_REFUSED(WHAT, STATUS)
      IMPLICIT NONE
      CHARACTER*(*) WHAT
      INTEGER STATUS
      CHARACTER*72 TEXT
      IF (STATUS .EQ. 0) RETURN
      CALL POINSOT_STATUS_TEXT_F(STATUS, TEXT, 72)
      WRITE (*, *) 'poinsot: ', WHAT, ': ', TEXT
      STOP 1
      END
