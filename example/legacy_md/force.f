C     Forces and torques: Lennard-Jones with shifted force, and charges
C     damped and with shifted force (Fennell and Gezelter, J. Chem.
C     Phys. 124, 234104 (2006)), between the sites of different
C     molecules, nearest images, cut at RCUT between sites.
      SUBROUTINE FORCES
      INCLUDE 'common.inc'
      INTEGER I, J, A, B, KI, KJ
      DOUBLE PRECISION DX, DY, DZ, RR, R, REACH, FAR, U, F
      DOUBLE PRECISION SHIFT, SLOPE, XX, XXC, EE, SS, S6, S6C
      DOUBLE PRECISION SXX, SYY, SZZ, TWOPI
      DOUBLE PRECISION FARSIT
      TWOPI = 2*ALPHA/SQRT(ACOS(-1D0))
      SHIFT = ERFC(ALPHA*RCUT)/RCUT
      SLOPE = SHIFT/RCUT + TWOPI*EXP(-(ALPHA*RCUT)**2)/RCUT
      CALL PLACE
      REACH = FARSIT()
      FAR = (RCUT + 2*REACH)**2
      POTEN = 0
      DO 10 I = 1, NMOL
         DO 10 A = 1, MAXSIT
            FXS(A,I) = 0
            FYS(A,I) = 0
            FZS(A,I) = 0
   10 CONTINUE
      DO 50 I = 1, NMOL - 1
         KI = KIND(I)
         DO 40 J = I + 1, NMOL
            KJ = KIND(J)
C           nearest image of the centre; the sites' may be another one
            DX = X(I) - X(J)
            DY = Y(I) - Y(J)
            DZ = Z(I) - Z(J)
            DX = DX - BOX*ANINT(DX/BOX)
            DY = DY - BOX*ANINT(DY/BOX)
            DZ = DZ - BOX*ANINT(DZ/BOX)
            IF (DX*DX + DY*DY + DZ*DZ .GT. FAR) GO TO 40
            DO 30 A = 1, NSITE(KI)
               DO 20 B = 1, NSITE(KJ)
                  SXX = XS(A,I) - XS(B,J)
                  SYY = YS(A,I) - YS(B,J)
                  SZZ = ZS(A,I) - ZS(B,J)
                  SXX = SXX - BOX*ANINT(SXX/BOX)
                  SYY = SYY - BOX*ANINT(SYY/BOX)
                  SZZ = SZZ - BOX*ANINT(SZZ/BOX)
                  RR = SXX*SXX + SYY*SYY + SZZ*SZZ
                  IF (RR .GE. RCUT*RCUT) GO TO 20
                  R = SQRT(RR)
                  XX = COULMB*CHARGE(A,KI)*CHARGE(B,KJ)
                  XXC = ERFC(ALPHA*R)/R
                  U = XX*(XXC - SHIFT + SLOPE*(R - RCUT))
                  F = XX*((XXC + TWOPI*EXP(-ALPHA*ALPHA*RR))/R - SLOPE)
                  EE = SQRT(EPS(A,KI)*EPS(B,KJ))
                  IF (EE .GT. 0) THEN
                     SS = SIG(A,KI)*SIG(B,KJ)
                     S6 = (SS/RR)**3
                     S6C = (SS/RCUT**2)**3
                     U = U + 4*EE*(S6*S6 - S6 - S6C*S6C + S6C
     &                     + (12*S6C*S6C - 6*S6C)*(R - RCUT)/RCUT)
                     F = F + 24*EE*((2*S6*S6 - S6)/R
     &                            - (2*S6C*S6C - S6C)/RCUT)
                  END IF
                  POTEN = POTEN + U
                  F = F/R
                  FXS(A,I) = FXS(A,I) + F*SXX
                  FYS(A,I) = FYS(A,I) + F*SYY
                  FZS(A,I) = FZS(A,I) + F*SZZ
                  FXS(B,J) = FXS(B,J) - F*SXX
                  FYS(B,J) = FYS(B,J) - F*SYY
                  FZS(B,J) = FZS(B,J) - F*SZZ
   20          CONTINUE
   30       CONTINUE
   40    CONTINUE
   50 CONTINUE
      CALL GATHER
      END

C     Sites in space from centres and attitudes
      SUBROUTINE PLACE
      INCLUDE 'common.inc'
      INTEGER I, A, K
      DOUBLE PRECISION R(3,3)
      DO 10 I = 1, NMOL
         K = KIND(I)
         CALL MATRIX(Q0(I), Q1(I), Q2(I), Q3(I), R)
         DO 10 A = 1, NSITE(K)
            XS(A,I) = X(I) + R(1,1)*XB(A,K) + R(1,2)*YB(A,K)
     &                     + R(1,3)*ZB(A,K)
            YS(A,I) = Y(I) + R(2,1)*XB(A,K) + R(2,2)*YB(A,K)
     &                     + R(2,3)*ZB(A,K)
            ZS(A,I) = Z(I) + R(3,1)*XB(A,K) + R(3,2)*YB(A,K)
     &                     + R(3,3)*ZB(A,K)
   10 CONTINUE
      END

C     Force on each centre and torque about it
      SUBROUTINE GATHER
      INCLUDE 'common.inc'
      INTEGER I, A
      DO 20 I = 1, NMOL
         FX(I) = 0
         FY(I) = 0
         FZ(I) = 0
         TQX(I) = 0
         TQY(I) = 0
         TQZ(I) = 0
         DO 10 A = 1, NSITE(KIND(I))
            FX(I) = FX(I) + FXS(A,I)
            FY(I) = FY(I) + FYS(A,I)
            FZ(I) = FZ(I) + FZS(A,I)
            TQX(I) = TQX(I) + (YS(A,I) - Y(I))*FZS(A,I)
     &                      - (ZS(A,I) - Z(I))*FYS(A,I)
            TQY(I) = TQY(I) + (ZS(A,I) - Z(I))*FXS(A,I)
     &                      - (XS(A,I) - X(I))*FZS(A,I)
            TQZ(I) = TQZ(I) + (XS(A,I) - X(I))*FYS(A,I)
     &                      - (YS(A,I) - Y(I))*FXS(A,I)
   10    CONTINUE
   20 CONTINUE
      END

C     The farthest that any site is from its centre
      DOUBLE PRECISION FUNCTION FARSIT()
      INCLUDE 'common.inc'
      INTEGER A, K
      FARSIT = 0
      DO 10 K = 1, MAXKND
         DO 10 A = 1, NSITE(K)
            FARSIT = MAX(FARSIT,
     &                   SQRT(XB(A,K)**2 + YB(A,K)**2 + ZB(A,K)**2))
   10 CONTINUE
      END

C     Rotation matrix of a quaternion: body frame to space frame
      SUBROUTINE MATRIX(A, B, C, D, R)
      DOUBLE PRECISION A, B, C, D, R(3,3)
      R(1,1) = A*A + B*B - C*C - D*D
      R(2,1) = 2*(B*C + A*D)
      R(3,1) = 2*(B*D - A*C)
      R(1,2) = 2*(B*C - A*D)
      R(2,2) = A*A - B*B + C*C - D*D
      R(3,2) = 2*(C*D + A*B)
      R(1,3) = 2*(B*D + A*C)
      R(2,3) = 2*(C*D - A*B)
      R(3,3) = A*A - B*B - C*C + D*D
      END
