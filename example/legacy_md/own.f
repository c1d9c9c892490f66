C     The rotation of this program: NO_SQUISH (Miller et al., J. Chem.
C     Phys. 116, 8649 (2002)), common in codes of this kind; axes in
C     LAMMPS's order, the largest moment outside, so that both can be
C     compared step by step.
C
C     OWNSET  once, when kinds of molecules are known
C     OWNKIK  angular velocities, over H, by the torques
C     OWNDRF  attitudes and angular velocities, over H, without torques
      SUBROUTINE OWNSET
      INCLUDE 'common.inc'
C     the step: kick H/2, drift H, kick H/2
      NSTAGE = 2
      CKICK(1) = 0.5D0
      CDRIFT(1) = 1
      CKICK(2) = 0.5D0
      CDRIFT(2) = 0
      END

      SUBROUTINE OWNKIK(H)
      INCLUDE 'common.inc'
      INTEGER I, K
      DOUBLE PRECISION H, R(3,3)
      DO 10 I = 1, NMOL
         K = KIND(I)
         CALL MATRIX(Q0(I), Q1(I), Q2(I), Q3(I), R)
         OMX(I) = OMX(I) + H*ROTINI(1,K)*(R(1,1)*TQX(I)
     &                   + R(2,1)*TQY(I) + R(3,1)*TQZ(I))
         OMY(I) = OMY(I) + H*ROTINI(2,K)*(R(1,2)*TQX(I)
     &                   + R(2,2)*TQY(I) + R(3,2)*TQZ(I))
         OMZ(I) = OMZ(I) + H*ROTINI(3,K)*(R(1,3)*TQX(I)
     &                   + R(2,3)*TQY(I) + R(3,3)*TQZ(I))
   10 CONTINUE
      END

      SUBROUTINE OWNDRF(H)
      INCLUDE 'common.inc'
      INTEGER I, J, K
      DOUBLE PRECISION H, S, Q(4), P(4), WX, WY, WZ
      S = H/NSUB
      DO 20 I = 1, NMOL
         K = KIND(I)
         Q(1) = Q0(I)
         Q(2) = Q1(I)
         Q(3) = Q2(I)
         Q(4) = Q3(I)
C        momentum of the quaternion: 2 q (0, I omega)
         WX = 2*ROTIN(1,K)*OMX(I)
         WY = 2*ROTIN(2,K)*OMY(I)
         WZ = 2*ROTIN(3,K)*OMZ(I)
         P(1) = -Q(2)*WX - Q(3)*WY - Q(4)*WZ
         P(2) =  Q(1)*WX - Q(4)*WY + Q(3)*WZ
         P(3) =  Q(4)*WX + Q(1)*WY - Q(2)*WZ
         P(4) = -Q(3)*WX + Q(2)*WY + Q(1)*WZ
         DO 10 J = 1, NSUB
            CALL TURN(1, S/2, ROTINI(1,K), Q, P)
            CALL TURN(2, S/2, ROTINI(2,K), Q, P)
            CALL TURN(3, S, ROTINI(3,K), Q, P)
            CALL TURN(2, S/2, ROTINI(2,K), Q, P)
            CALL TURN(1, S/2, ROTINI(1,K), Q, P)
   10    CONTINUE
C        back to the angular velocity; the norm loses a last digit
         OMX(I) = 0.5D0*ROTINI(1,K)*
     &            (-Q(2)*P(1) + Q(1)*P(2) + Q(4)*P(3) - Q(3)*P(4))
         OMY(I) = 0.5D0*ROTINI(2,K)*
     &            (-Q(3)*P(1) - Q(4)*P(2) + Q(1)*P(3) + Q(2)*P(4))
         OMZ(I) = 0.5D0*ROTINI(3,K)*
     &            (-Q(4)*P(1) + Q(3)*P(2) - Q(2)*P(3) + Q(1)*P(4))
         WX = 1/SQRT(Q(1)**2 + Q(2)**2 + Q(3)**2 + Q(4)**2)
         Q0(I) = WX*Q(1)
         Q1(I) = WX*Q(2)
         Q2(I) = WX*Q(3)
         Q3(I) = WX*Q(4)
   20 CONTINUE
      END

C     Free rotation about body axis K alone, over H
      SUBROUTINE TURN(K, H, RINV, Q, P)
      INTEGER K
      DOUBLE PRECISION H, RINV, Q(4), P(4), QK(4), PK(4), ZETA, C, S
      IF (RINV .EQ. 0) RETURN
      CALL PERMUT(K, Q, QK)
      CALL PERMUT(K, P, PK)
      ZETA = 0.25D0*RINV*H*
     &       (P(1)*QK(1) + P(2)*QK(2) + P(3)*QK(3) + P(4)*QK(4))
      C = COS(ZETA)
      S = SIN(ZETA)
      Q(1) = C*Q(1) + S*QK(1)
      Q(2) = C*Q(2) + S*QK(2)
      Q(3) = C*Q(3) + S*QK(3)
      Q(4) = C*Q(4) + S*QK(4)
      P(1) = C*P(1) + S*PK(1)
      P(2) = C*P(2) + S*PK(2)
      P(3) = C*P(3) + S*PK(3)
      P(4) = C*P(4) + S*PK(4)
      END

C     Q times the unit of axis K
      SUBROUTINE PERMUT(K, Q, QK)
      INTEGER K
      DOUBLE PRECISION Q(4), QK(4)
      GO TO (1, 2, 3), K
    1 QK(1) = -Q(2)
      QK(2) =  Q(1)
      QK(3) =  Q(4)
      QK(4) = -Q(3)
      RETURN
    2 QK(1) = -Q(3)
      QK(2) = -Q(4)
      QK(3) =  Q(1)
      QK(4) =  Q(2)
      RETURN
    3 QK(1) = -Q(4)
      QK(2) =  Q(3)
      QK(3) = -Q(2)
      QK(4) =  Q(1)
      END
