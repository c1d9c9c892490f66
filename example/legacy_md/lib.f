C     The rotation by poinsot: the same three routines as in own.f.
C     The arrays are unchanged: layout 3, DL_POLY's, is angular
C     velocities in the body frame and torques in the space frame.
C
C     LIBSET  once, when kinds of molecules are known
C     LIBSTP  for steps of a higher order than velocity Verlet's
C     LIBKIK  angular velocities, over H, by the torques
C     LIBDRF  attitudes and angular velocities, over H, without torques
C     LIBNOI  friction and noise of step NUMBER, over H
      SUBROUTINE LIBSET
      INCLUDE 'common.inc'
      INTEGER*8 PLAN
      COMMON /LIBROT/ PLAN
      INTEGER K, NUMBER, STATUS
      CHARACTER*80 TEXT
      CALL POINSOT_PLAN_CREATE_F(PLAN, STATUS)
      CALL LIBERR('a plan', STATUS)
      DO 10 K = 1, MAXKND
         CALL POINSOT_PLAN_ADD_CLASS_F(PLAN, ROTIN(1,K), NUMBER, STATUS)
         CALL LIBERR('a kind of molecule', STATUS)
   10 CONTINUE
      CALL POINSOT_PLAN_SET_F(PLAN, 1, METHOD, STATUS)
      CALL LIBERR('the method', STATUS)
      CALL POINSOT_PLAN_SET_F(PLAN, 3, 3, STATUS)
      CALL LIBERR('the layout', STATUS)
C     one thread, like the rest of this program
      CALL POINSOT_PLAN_SET_F(PLAN, 6, 1, STATUS)
      CALL LIBERR('threads', STATUS)
      IF (RATE .GT. 0) THEN
         WRITE (TEXT, '(A, 1PE23.16, A, E23.16)') 'rate = ', RATE,
     &      '; temperature = ', BOLTZ*TEMP
         CALL POINSOT_PLAN_EFFECT_F(PLAN, 'langevin', 8, TEXT, 80,
     &                              STATUS)
         CALL LIBERR('the thermostat', STATUS)
      END IF
      CALL POINSOT_PLAN_READY_F(PLAN, STATUS)
      CALL LIBERR('the plan', STATUS)
      END

C     The step: kicks and drifts of a splitting by its number
      SUBROUTINE LIBSTP
      INCLUDE 'common.inc'
      INTEGER STATUS
      CALL POINSOT_SPLITTING_F(ISPLIT, MAXSTG, CKICK, CDRIFT, NSTAGE,
     &                         STATUS)
      CALL LIBERR('the splitting', STATUS)
      END

      SUBROUTINE LIBKIK(H)
      INCLUDE 'common.inc'
      INTEGER*8 PLAN
      COMMON /LIBROT/ PLAN
      INTEGER EACH(MAXMOL), STATUS
      DOUBLE PRECISION H
      CALL POINSOT_KICK_A_F(PLAN, NMOL, OMX, OMY, OMZ, Q0, Q1, Q2, Q3,
     &                      KIND, H, TQX, TQY, TQZ, EACH, STATUS)
      CALL LIBERR('a kick', STATUS)
      END

      SUBROUTINE LIBDRF(H)
      INCLUDE 'common.inc'
      INTEGER*8 PLAN
      COMMON /LIBROT/ PLAN
      INTEGER EACH(MAXMOL), STATUS
      DOUBLE PRECISION H
      CALL POINSOT_DRIFT_A_F(PLAN, NMOL, OMX, OMY, OMZ, Q0, Q1, Q2, Q3,
     &                       KIND, H, EACH, STATUS)
      CALL LIBERR('a drift', STATUS)
      END

      SUBROUTINE LIBNOI(H, NUMBER)
      INCLUDE 'common.inc'
      INTEGER*8 PLAN
      COMMON /LIBROT/ PLAN
      INTEGER EACH(MAXMOL), STATUS, NUMBER
      DOUBLE PRECISION H
      CALL POINSOT_DISSIPATE_A_F(PLAN, NMOL, OMX, OMY, OMZ, Q0, Q1, Q2,
     &                          Q3, KIND, H, NUMBER, EACH, STATUS)
      CALL LIBERR('noise', STATUS)
      END

C     Status 0 is OK; poinsot.h lists the others. 9: some molecules
C     failed, EACH has their statuses; here that ends the run.
      SUBROUTINE LIBERR(WHAT, STATUS)
      CHARACTER*(*) WHAT
      INTEGER STATUS
      IF (STATUS .EQ. 0) RETURN
      WRITE (*, *) 'poinsot: ', WHAT, ': status ', STATUS
      STOP 1
      END
