C     Molecular dynamics of rigid water and carbon dioxide in a periodic
C     box: velocity Verlet for the centres, and for the rotation either
C     this program's own step (own.f) or poinsot (lib.f), selected by
C     the line `rotation` of the input.
C
C     usage: md <input
      PROGRAM MD
      INCLUDE 'common.inc'
      INTEGER NSTEP, NPRINT, NEQUIL, I, SEED
      COMMON /CHANCE/ SEED
      CHARACTER*60 FSTART, FEND, FSITES
      DOUBLE PRECISION H
      CALL MODELS
      CALL INPUT(NSTEP, NPRINT, NEQUIL, H, FSTART, FEND, FSITES)
      IF (2*RCUT .GT. BOX) STOP 'cut-off beyond half the box'
      CALL OWNSET
      CALL FORCES
      IF (FSITES .NE. ' ') CALL SITES(FSITES)
      DO 10 I = 1, NEQUIL
         CALL COOL(I)
   10 CONTINUE
      IF (LIBROT .EQ. 1) CALL LIBSET
      IF (ISPLIT .NE. 1) CALL LIBSTP
      IF (RATE .GT. 0 .AND. (LIBROT .EQ. 0 .OR. ISPLIT .NE. 1))
     &   STOP 'friction takes rotation poinsot and no splitting'
      CALL RUN(NSTEP, NPRINT, H)
      IF (FEND .NE. ' ') CALL SAVE(FEND)
      END

C     NSTEP steps of H with energies; at the end their statistics
      SUBROUTINE RUN(NSTEP, NPRINT, H)
      INCLUDE 'common.inc'
      INTEGER NSTEP, NPRINT, I, NFORCE
      DOUBLE PRECISION H, T, ET, ER, E, E0, TROT, TFORCE, BEGIN, END
      DOUBLE PRECISION S, SE, SEE, ST, STT, STE, SK, DRIFT, RMS, FREE
      DOUBLE PRECISION TEMPER, SP
      LOGICAL FRESH
      FRESH = .TRUE.
      NSTEPS = 0
      THOT = 0
      SP = 0
      TROT = 0
      TFORCE = 0
      NFORCE = 0
      SE = 0
      SEE = 0
      ST = 0
      STT = 0
      STE = 0
      SK = 0
      CALL KINETC(ET, ER)
      E0 = ET + ER + POTEN
      WRITE (*, '(A)') '# step, time, kinetic energy of centres, of'//
     &   ' rotation, potential energy, total (10 J/mol)'
      WRITE (*, 100) 0, 0D0, ET, ER, POTEN, E0
      CALL CPU_TIME(BEGIN)
      DO 10 I = 1, NSTEP
         IF (RATE .GT. 0) THEN
            CALL HOT(H, FRESH, TFORCE, NFORCE)
         ELSE
            CALL STEP(H, FRESH, TROT, TFORCE, NFORCE)
         END IF
         CALL KINETC(ET, ER)
         SP = SP + POTEN
         T = I*H
         E = ET + ER + POTEN
         IF (MOD(I, NPRINT) .EQ. 0) WRITE (*, 100) I, T, ET, ER, POTEN,
     &      E
         SE = SE + (E - E0)
         SEE = SEE + (E - E0)**2
         ST = ST + T
         STT = STT + T*T
         STE = STE + T*(E - E0)
         SK = SK + TEMPER(ET, ER)
   10 CONTINUE
      CALL CPU_TIME(END)
      IF (NSTEP .LT. 3) RETURN
C     drift: slope of the straight line; fluctuation: rms about it
      S = NSTEP
      FREE = STT - ST*ST/S
      DRIFT = (STE - ST*SE/S)/FREE
      RMS = SQRT(MAX(SEE/S - (SE/S)**2 - DRIFT**2*FREE/S, 0D0))
      WRITE (*, '(A)') '# result: step (fs), rms fluctuation and drift'
     &   //' per ps of the energy (10 J/mol per molecule),'
      WRITE (*, '(A)') '# temperature, forces per step, CPU time per'//
     &   ' step (us), of that: rotation, forces'
      WRITE (*, 110) H*1D3, RMS/NMOL, DRIFT/NMOL, SK/S,
     &   DBLE(NFORCE)/NSTEP, (END - BEGIN)/NSTEP*1D6, TROT/NSTEP*1D6,
     &   TFORCE/NSTEP*1D6
      IF (RATE .GT. 0) WRITE (*, 120) SP/S/NMOL, SK/S, THOT/S
  100 FORMAT (I8, F12.5, 3F20.9, F22.11)
  120 FORMAT ('thermostat: mean potential energy', F12.4,
     &   ', temperature at ends of steps', F9.3,
     &   ', after noise inside', F9.3)
  110 FORMAT ('result', F8.3, 1P, 2E13.5, 0P, F9.2, F7.2, 3F12.2)
      END

C     One step: kicks and drifts of centres and attitudes together
      SUBROUTINE STEP(H, FRESH, TROT, TFORCE, NFORCE)
      INCLUDE 'common.inc'
      INTEGER I, NFORCE
      DOUBLE PRECISION H, TROT, TFORCE, T1, T2
      LOGICAL FRESH
      DO 10 I = 1, NSTAGE
         IF (CKICK(I) .NE. 0) THEN
            CALL RENEW(FRESH, TFORCE, NFORCE)
            CALL KICK(CKICK(I)*H)
            CALL CPU_TIME(T1)
            IF (LIBROT .EQ. 1) THEN
               CALL LIBKIK(CKICK(I)*H)
            ELSE
               CALL OWNKIK(CKICK(I)*H)
            END IF
            CALL CPU_TIME(T2)
            TROT = TROT + (T2 - T1)
         END IF
         IF (CDRIFT(I) .NE. 0) THEN
            CALL MOVE(CDRIFT(I)*H)
            CALL CPU_TIME(T1)
            IF (LIBROT .EQ. 1) THEN
               CALL LIBDRF(CDRIFT(I)*H)
            ELSE
               CALL OWNDRF(CDRIFT(I)*H)
            END IF
            CALL CPU_TIME(T2)
            TROT = TROT + (T2 - T1)
            FRESH = .FALSE.
         END IF
   10 CONTINUE
      CALL RENEW(FRESH, TFORCE, NFORCE)
      END

C     One step with noise: kick, half a drift, noise over H, half a
C     drift, kick (BAOAB), or noise over H/2 at both ends. Centres here,
C     rotations by poinsot, which draws its own numbers by step.
      SUBROUTINE HOT(H, FRESH, TFORCE, NFORCE)
      INCLUDE 'common.inc'
      INTEGER NFORCE
      DOUBLE PRECISION H, TFORCE, ET, ER, TEMPER
      LOGICAL FRESH
      NSTEPS = NSTEPS + 1
      IF (INSIDE .EQ. 0) CALL NOISE(H/2, 2*NSTEPS)
      CALL RENEW(FRESH, TFORCE, NFORCE)
      CALL KICK(H/2)
      CALL LIBKIK(H/2)
      CALL MOVE(H/2)
      CALL LIBDRF(H/2)
      IF (INSIDE .EQ. 1) THEN
         CALL NOISE(H, NSTEPS)
         CALL KINETC(ET, ER)
         THOT = THOT + TEMPER(ET, ER)
      END IF
      CALL MOVE(H/2)
      CALL LIBDRF(H/2)
      FRESH = .FALSE.
      CALL RENEW(FRESH, TFORCE, NFORCE)
      CALL KICK(H/2)
      CALL LIBKIK(H/2)
      IF (INSIDE .EQ. 0) CALL NOISE(H/2, 2*NSTEPS + 1)
      END

C     Exact friction and noise over H, of centres and rotations
      SUBROUTINE NOISE(H, NUMBER)
      INCLUDE 'common.inc'
      INTEGER NUMBER, I
      DOUBLE PRECISION H, C, S, NORMAL
      C = EXP(-RATE*H)
      DO 10 I = 1, NMOL
         S = SQRT(BOLTZ*TEMP*(1 - C*C)/TOTMAS(KIND(I)))
         VX(I) = C*VX(I) + S*NORMAL()
         VY(I) = C*VY(I) + S*NORMAL()
         VZ(I) = C*VZ(I) + S*NORMAL()
   10 CONTINUE
      CALL LIBNOI(H, NUMBER)
      END

C     Forces, if molecules have moved since the last ones
      SUBROUTINE RENEW(FRESH, TFORCE, NFORCE)
      INTEGER NFORCE
      DOUBLE PRECISION TFORCE, T1, T2
      LOGICAL FRESH
      IF (FRESH) RETURN
      CALL CPU_TIME(T1)
      CALL FORCES
      CALL CPU_TIME(T2)
      TFORCE = TFORCE + (T2 - T1)
      NFORCE = NFORCE + 1
      FRESH = .TRUE.
      END

C     Centres: velocities from forces, positions from velocities
      SUBROUTINE KICK(H)
      INCLUDE 'common.inc'
      INTEGER I
      DOUBLE PRECISION H, S
      DO 10 I = 1, NMOL
         S = H/TOTMAS(KIND(I))
         VX(I) = VX(I) + S*FX(I)
         VY(I) = VY(I) + S*FY(I)
         VZ(I) = VZ(I) + S*FZ(I)
   10 CONTINUE
      END

      SUBROUTINE MOVE(H)
      INCLUDE 'common.inc'
      INTEGER I
      DOUBLE PRECISION H
      DO 10 I = 1, NMOL
         X(I) = X(I) + H*VX(I)
         Y(I) = Y(I) + H*VY(I)
         Z(I) = Z(I) + H*VZ(I)
   10 CONTINUE
      END

C     Kinetic energies of centres and of rotation
      SUBROUTINE KINETC(ET, ER)
      INCLUDE 'common.inc'
      INTEGER I, K
      DOUBLE PRECISION ET, ER
      ET = 0
      ER = 0
      DO 10 I = 1, NMOL
         K = KIND(I)
         ET = ET + 0.5D0*TOTMAS(K)*(VX(I)**2 + VY(I)**2 + VZ(I)**2)
         ER = ER + 0.5D0*(ROTIN(1,K)*OMX(I)**2 + ROTIN(2,K)*OMY(I)**2
     &                  + ROTIN(3,K)*OMZ(I)**2)
   10 CONTINUE
      END

C     Temperature: a linear molecule has two rotations, not three
      DOUBLE PRECISION FUNCTION TEMPER(ET, ER)
      INCLUDE 'common.inc'
      INTEGER I, K, NFREE
      DOUBLE PRECISION ET, ER
      NFREE = 3*NMOL - 3
      IF (RATE .GT. 0) NFREE = 3*NMOL
      DO 10 I = 1, NMOL
         DO 10 K = 1, 3
            IF (ROTIN(K,KIND(I)) .GT. 0) NFREE = NFREE + 1
   10 CONTINUE
      TEMPER = 2*(ET + ER)/(NFREE*BOLTZ)
      END

C     Step I of equilibration: 1 fs with the own rotation; every 10
C     steps velocities scaled to the temperature, of centres and of
C     rotation each
      SUBROUTINE COOL(I)
      INCLUDE 'common.inc'
      INTEGER I, J, LIB, NONE
      DOUBLE PRECISION ET, ER, S, SR, T1, T2, TEMPER
      LOGICAL FRESH
      LIB = LIBROT
      LIBROT = 0
      FRESH = .TRUE.
      NONE = 0
      CALL STEP(1D-3, FRESH, T1, T2, NONE)
      LIBROT = LIB
      IF (MOD(I, 10) .NE. 0) RETURN
      CALL KINETC(ET, ER)
      S = TEMPER(2*ET, 0D0)
      SR = TEMPER(0D0, 2*ER)
      IF (S .LE. 0 .OR. SR .LE. 0) RETURN
      S = SQRT(TEMP/S)
      SR = SQRT(TEMP/SR)
      DO 10 J = 1, NMOL
         VX(J) = S*VX(J)
         VY(J) = S*VY(J)
         VZ(J) = S*VZ(J)
         OMX(J) = SR*OMX(J)
         OMY(J) = SR*OMY(J)
         OMZ(J) = SR*OMZ(J)
   10 CONTINUE
      END

C     Lines of the input: a word in columns 1 to 12, its value after it
      SUBROUTINE INPUT(NSTEP, NPRINT, NEQUIL, H, FSTART, FEND, FSITES)
      INCLUDE 'common.inc'
      INTEGER NSTEP, NPRINT, NEQUIL, NWATER, NCO2, SEED
      COMMON /CHANCE/ SEED
      CHARACTER*(*) FSTART, FEND, FSITES
      CHARACTER*12 WORD
      CHARACTER*60 VALUE
      DOUBLE PRECISION H
      RATE = 0
      INSIDE = 1
      NWATER = 216
      NCO2 = 0
      BOX = 18.62D0
      RCUT = 9
      ALPHA = 0.2D0
      TEMP = 298
      SEED = 20060301
      LIBROT = 0
      METHOD = 1
      ISPLIT = 1
      NSUB = 1
      H = 2D-3
      NSTEP = 1000
      NPRINT = 1
      NEQUIL = 0
      FSTART = ' '
      FEND = ' '
      FSITES = ' '
   10 READ (*, '(A12, A60)', END=20) WORD, VALUE
      IF (WORD .EQ. ' ' .OR. WORD(1:1) .EQ. '#') GO TO 10
      IF (WORD .EQ. 'water') THEN
         READ (VALUE, *, ERR=30) NWATER
      ELSE IF (WORD .EQ. 'co2') THEN
         READ (VALUE, *, ERR=30) NCO2
      ELSE IF (WORD .EQ. 'box') THEN
         READ (VALUE, *, ERR=30) BOX
      ELSE IF (WORD .EQ. 'cutoff') THEN
         READ (VALUE, *, ERR=30) RCUT
      ELSE IF (WORD .EQ. 'damping') THEN
         READ (VALUE, *, ERR=30) ALPHA
      ELSE IF (WORD .EQ. 'temperature') THEN
         READ (VALUE, *, ERR=30) TEMP
      ELSE IF (WORD .EQ. 'seed') THEN
         READ (VALUE, *, ERR=30) SEED
      ELSE IF (WORD .EQ. 'rotation') THEN
         IF (VALUE .NE. 'own' .AND. VALUE .NE. 'poinsot') GO TO 30
         IF (VALUE .EQ. 'poinsot') LIBROT = 1
      ELSE IF (WORD .EQ. 'friction') THEN
         READ (VALUE, *, ERR=30) RATE
      ELSE IF (WORD .EQ. 'noise') THEN
         IF (VALUE .NE. 'middle' .AND. VALUE .NE. 'ends') GO TO 30
         IF (VALUE .EQ. 'ends') INSIDE = 0
      ELSE IF (WORD .EQ. 'substeps') THEN
         READ (VALUE, *, ERR=30) NSUB
      ELSE IF (WORD .EQ. 'method') THEN
         READ (VALUE, *, ERR=30) METHOD
      ELSE IF (WORD .EQ. 'splitting') THEN
         READ (VALUE, *, ERR=30) ISPLIT
      ELSE IF (WORD .EQ. 'step') THEN
         READ (VALUE, *, ERR=30) H
      ELSE IF (WORD .EQ. 'steps') THEN
         READ (VALUE, *, ERR=30) NSTEP
      ELSE IF (WORD .EQ. 'print') THEN
         READ (VALUE, *, ERR=30) NPRINT
      ELSE IF (WORD .EQ. 'equilibrate') THEN
         READ (VALUE, *, ERR=30) NEQUIL
      ELSE IF (WORD .EQ. 'start') THEN
         FSTART = VALUE
      ELSE IF (WORD .EQ. 'finish') THEN
         FEND = VALUE
      ELSE IF (WORD .EQ. 'sites') THEN
         FSITES = VALUE
      ELSE
         GO TO 30
      END IF
      GO TO 10
   20 IF (NWATER + NCO2 .GT. MAXMOL) STOP 'too many molecules'
      IF (FSTART .NE. ' ') CALL LOAD(FSTART)
      IF (FSTART .EQ. ' ') CALL LATTIC(NWATER, NCO2)
      RETURN
   30 WRITE (*, *) 'not understood: ', WORD, VALUE
      STOP 1
      END
