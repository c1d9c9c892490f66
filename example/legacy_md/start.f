C     Kinds of molecules, the first configuration, and files of it.
C
C     Site parameters: SPC/E, Berendsen et al., J. Phys. Chem. 91, 6269
C     (1987); EPM2, Harris and Yung, J. Phys. Chem. 99, 12021 (1995).
      SUBROUTINE MODELS
      INCLUDE 'common.inc'
      INTEGER A, K
      DOUBLE PRECISION ANGLE, LONG, S
      DO 10 K = 1, MAXKND
         NSITE(K) = 3
         DO 10 A = 1, 3
            XB(A,K) = 0
            YB(A,K) = 0
            ZB(A,K) = 0
   10 CONTINUE
C     water in the plane x = 0, hydrogens along z: lengths 1 A, the
C     angle of a tetrahedron
      ANGLE = ACOS(-1D0/3D0)/2
      SITMAS(1,1) = 15.9994D0
      SITMAS(2,1) = 1.008D0
      SITMAS(3,1) = 1.008D0
      CHARGE(1,1) = -0.8476D0
      CHARGE(2,1) = 0.4238D0
      CHARGE(3,1) = 0.4238D0
      EPS(1,1) = 65.0D0
      SIG(1,1) = 3.166D0
      YB(2,1) = COS(ANGLE)
      YB(3,1) = COS(ANGLE)
      ZB(2,1) = SIN(ANGLE)
      ZB(3,1) = -SIN(ANGLE)
C     carbon dioxide along z: a linear molecule, Izz = 0
      LONG = 1.149D0
      SITMAS(1,2) = 12.011D0
      SITMAS(2,2) = 15.9994D0
      SITMAS(3,2) = 15.9994D0
      CHARGE(1,2) = 0.6512D0
      CHARGE(2,2) = -0.3256D0
      CHARGE(3,2) = -0.3256D0
      EPS(1,2) = 28.129D0*BOLTZ
      EPS(2,2) = 80.507D0*BOLTZ
      EPS(3,2) = EPS(2,2)
      SIG(1,2) = 2.757D0
      SIG(2,2) = 3.033D0
      SIG(3,2) = 3.033D0
      ZB(2,2) = LONG
      ZB(3,2) = -LONG
C     centres of mass to the origin, moments of inertia
      DO 40 K = 1, MAXKND
         TOTMAS(K) = SITMAS(1,K) + SITMAS(2,K) + SITMAS(3,K)
         S = 0
         DO 20 A = 1, 3
            S = S + SITMAS(A,K)*YB(A,K)/TOTMAS(K)
   20    CONTINUE
         ROTIN(1,K) = 0
         ROTIN(2,K) = 0
         ROTIN(3,K) = 0
         DO 30 A = 1, 3
            YB(A,K) = YB(A,K) - S
            ROTIN(1,K) = ROTIN(1,K)
     &                 + SITMAS(A,K)*(YB(A,K)**2 + ZB(A,K)**2)
            ROTIN(2,K) = ROTIN(2,K) + SITMAS(A,K)*ZB(A,K)**2
            ROTIN(3,K) = ROTIN(3,K) + SITMAS(A,K)*YB(A,K)**2
   30    CONTINUE
         DO 40 A = 1, 3
            ROTINI(A,K) = 0
            IF (ROTIN(A,K) .GT. 0) ROTINI(A,K) = 1/ROTIN(A,K)
   40 CONTINUE
      END

C     NWATER + NCO2 molecules on a cubic lattice, mixed, attitudes and
C     momenta at random, temperature TEMP
      SUBROUTINE LATTIC(NWATER, NCO2)
      INCLUDE 'common.inc'
      INTEGER NWATER, NCO2, EDGE, I, J, K, L
      DOUBLE PRECISION S, PX, PY, PZ, MASS, NORMAL, UNIFRM
      EXTERNAL NORMAL, UNIFRM
      NMOL = NWATER + NCO2
      EDGE = 1
   10 IF (EDGE**3 .LT. NMOL) THEN
         EDGE = EDGE + 1
         GO TO 10
      END IF
      PX = 0
      PY = 0
      PZ = 0
      MASS = 0
      DO 20 I = 1, NMOL
C        the fraction of carbon dioxide among the first I molecules
         J = (I*NCO2)/NMOL - ((I - 1)*NCO2)/NMOL
         K = 1 + J
         KIND(I) = K
         L = I - 1
         X(I) = BOX*((MOD(L, EDGE) + 0.5D0)/EDGE - 0.5D0)
         Y(I) = BOX*((MOD(L/EDGE, EDGE) + 0.5D0)/EDGE - 0.5D0)
         Z(I) = BOX*((L/EDGE**2 + 0.5D0)/EDGE - 0.5D0)
         Q0(I) = NORMAL()
         Q1(I) = NORMAL()
         Q2(I) = NORMAL()
         Q3(I) = NORMAL()
         S = 1/SQRT(Q0(I)**2 + Q1(I)**2 + Q2(I)**2 + Q3(I)**2)
         Q0(I) = S*Q0(I)
         Q1(I) = S*Q1(I)
         Q2(I) = S*Q2(I)
         Q3(I) = S*Q3(I)
         S = SQRT(BOLTZ*TEMP/TOTMAS(K))
         VX(I) = S*NORMAL()
         VY(I) = S*NORMAL()
         VZ(I) = S*NORMAL()
C        1/Izz = 0 of a linear molecule leaves that axis at rest
         OMX(I) = SQRT(BOLTZ*TEMP*ROTINI(1,K))*NORMAL()
         OMY(I) = SQRT(BOLTZ*TEMP*ROTINI(2,K))*NORMAL()
         OMZ(I) = SQRT(BOLTZ*TEMP*ROTINI(3,K))*NORMAL()
         PX = PX + TOTMAS(K)*VX(I)
         PY = PY + TOTMAS(K)*VY(I)
         PZ = PZ + TOTMAS(K)*VZ(I)
         MASS = MASS + TOTMAS(K)
   20 CONTINUE
      DO 30 I = 1, NMOL
         VX(I) = VX(I) - PX/MASS
         VY(I) = VY(I) - PY/MASS
         VZ(I) = VZ(I) - PZ/MASS
   30 CONTINUE
      END

C     The minimal standard generator (Park and Miller, Commun. ACM 31,
C     1192 (1988)), without overflow
      DOUBLE PRECISION FUNCTION UNIFRM()
      INTEGER SEED, HIGH
      COMMON /CHANCE/ SEED
      HIGH = SEED/127773
      SEED = 16807*(SEED - HIGH*127773) - HIGH*2836
      IF (SEED .LE. 0) SEED = SEED + 2147483647
      UNIFRM = SEED/2147483647D0
      END

C     Normal deviate, by Box and Muller
      DOUBLE PRECISION FUNCTION NORMAL()
      DOUBLE PRECISION R, UNIFRM
      EXTERNAL UNIFRM
      R = SQRT(-2*LOG(UNIFRM()))
      NORMAL = R*COS(2*ACOS(-1D0)*UNIFRM())
      END

C     A configuration to a file, with all digits: box, then a molecule a
C     line: kind, centre, velocity, quaternion, angular velocity
      SUBROUTINE SAVE(FILE)
      INCLUDE 'common.inc'
      CHARACTER*(*) FILE
      INTEGER I
      OPEN (12, FILE=FILE, STATUS='UNKNOWN')
      WRITE (12, '(I6,1P,E25.17)') NMOL, BOX
      DO 10 I = 1, NMOL
         WRITE (12, '(I2,1P,13E25.17)') KIND(I), X(I), Y(I), Z(I),
     &      VX(I), VY(I), VZ(I), Q0(I), Q1(I), Q2(I), Q3(I), OMX(I),
     &      OMY(I), OMZ(I)
   10 CONTINUE
      CLOSE (12)
      END

      SUBROUTINE LOAD(FILE)
      INCLUDE 'common.inc'
      CHARACTER*(*) FILE
      INTEGER I
      OPEN (12, FILE=FILE, STATUS='OLD')
      READ (12, *) NMOL, BOX
      IF (NMOL .GT. MAXMOL) STOP 'too many molecules'
      DO 10 I = 1, NMOL
         READ (12, *) KIND(I), X(I), Y(I), Z(I), VX(I), VY(I), VZ(I),
     &      Q0(I), Q1(I), Q2(I), Q3(I), OMX(I), OMY(I), OMZ(I)
   10 CONTINUE
      CLOSE (12)
      END

C     Sites to a file for another program to check: molecule, site,
C     kind, position, velocity, force, mass, charge such that the energy
C     is q q'/r, Lennard-Jones parameters
      SUBROUTINE SITES(FILE)
      INCLUDE 'common.inc'
      CHARACTER*(*) FILE
      INTEGER I, A, K
      DOUBLE PRECISION R(3,3), U, V, W
      OPEN (12, FILE=FILE, STATUS='UNKNOWN')
      WRITE (12, '(I6,1P,4E25.17)') NMOL, BOX, RCUT, ALPHA, POTEN
      DO 10 I = 1, NMOL
         K = KIND(I)
         CALL MATRIX(Q0(I), Q1(I), Q2(I), Q3(I), R)
         DO 10 A = 1, NSITE(K)
C           velocity about the centre, body frame
            U = OMY(I)*ZB(A,K) - OMZ(I)*YB(A,K)
            V = OMZ(I)*XB(A,K) - OMX(I)*ZB(A,K)
            W = OMX(I)*YB(A,K) - OMY(I)*XB(A,K)
            WRITE (12, '(I5,I2,I2,1P,13E25.17)') I, A, K, XS(A,I),
     &         YS(A,I), ZS(A,I),
     &         VX(I) + R(1,1)*U + R(1,2)*V + R(1,3)*W,
     &         VY(I) + R(2,1)*U + R(2,2)*V + R(2,3)*W,
     &         VZ(I) + R(3,1)*U + R(3,2)*V + R(3,3)*W,
     &         FXS(A,I), FYS(A,I), FZS(A,I), SITMAS(A,K),
     &         SQRT(COULMB)*CHARGE(A,K), EPS(A,K), SIG(A,K)
   10 CONTINUE
      CLOSE (12)
      END
