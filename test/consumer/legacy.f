C     A host in fixed form that lets the compiler look at its calls: it
C     has no .mod files, only include/poinsot_legacy.f90 and the library.
      PROGRAM LEGACY
      USE POINSOT_LEGACY
      IMPLICIT NONE
      INTEGER N
      PARAMETER (N = 5)
      EXTERNAL TWIST
      DOUBLE PRECISION Y(3, N), Q(4, N), R(4, N), TURN(3), KICK(32)
      DOUBLE PRECISION DRIFT(32)
      INTEGER EACH(N), CLASS(N), STATUS, NUMBER, I, PAIRS, VERSION
      INTEGER*8 PLAN
      CHARACTER*60 TEXT
      CALL POINSOT_VERSION_F(VERSION, STATUS)
      IF (STATUS .NE. 0 .OR. VERSION .LT. 200) STOP 1
      CALL POINSOT_SPLITTING_F(6, 32, KICK, DRIFT, PAIRS, STATUS)
      IF (STATUS .NE. 0 .OR. ABS(SUM(DRIFT(1:PAIRS)) - 1) .GT. 1D-15)
     &   STOP 2
      CALL POINSOT_PLAN_CREATE_F(PLAN, STATUS)
      CALL POINSOT_PLAN_ADD_CLASS_F(PLAN, (/0.6D0, 0.8D0, 1D0/),
     &   NUMBER, STATUS)
      CALL POINSOT_PLAN_EFFECT_F(PLAN, 'gravity', 7, 'centre = 0 0 1',
     &   14, STATUS)
      CALL POINSOT_PLAN_READY_F(PLAN, STATUS)
      IF (STATUS .NE. 0) STOP 3
      DO I = 1, N
         Y(:, I) = (/0.1D0, 0.2D0, 0.3D0/)
         Q(:, I) = (/1D0, 0D0, 0D0, 0D0/)
         CLASS(I) = 0
      END DO
      R = Q
      CALL POINSOT_STEP_TORQUE_F(PLAN, N, Y, Q, CLASS, 0D0, 0.1D0, 0, 3,
     &   TWIST, EACH, STATUS)
      IF (STATUS .NE. 0 .OR. ANY(EACH .NE. 0)) STOP 4
      IF (ANY(ABS(Q(:, 1) - Q(:, N)) .GT. 0D0)) STOP 5
      CALL POINSOT_ROTATE_F((/0.6D0, 0.8D0, 1D0/), 1, 0.3D0, 1, N, Y,
     &   R, EACH, STATUS)
      IF (STATUS .NE. 0) STOP 6
      CALL POINSOT_STATUS_TEXT_F(14, TEXT, 60)
      IF (TEXT .NE. 'the attitude is not a unit quaternion') STOP 7
      CALL POINSOT_PLAN_DESTROY_F(PLAN)
      TURN = Y(:, 1)
      PRINT '(3F12.8)', TURN
      END

      SUBROUTINE TWIST(T, N, Q, TORQUE, STOP)
      IMPLICIT NONE
      INTEGER N, STOP
      DOUBLE PRECISION T, Q(N, 4), TORQUE(N, 3)
      TORQUE(:, 1) = TORQUE(:, 1) + T*Q(:, 1)
      STOP = 0
      END
