# The momentum in the body frame on its sphere, with the contours of the energy: polhodes.
# `gnuplot plot_momentum.gp`, in this folder, draws momentum.svg and momentum.png.
load 'motion.gp'

# The axes of the smallest, the middle and the largest moment; contours where three moments differ and no rotor turns.
stats file skip 1 every ::body::body using (b = $2, 1) nooutput
m(j) = moment(b, j)
lo = m(1) <= m(2) && m(1) <= m(3) ? 1 : m(2) <= m(3) ? 2 : 3
hi = m(3) >= m(1) && m(3) >= m(2) ? 3 : m(2) >= m(1) ? 2 : 1
if (lo == hi) { lo = 1; hi = 3 }
mid = 6 - lo - hi
contours = m(lo) > 1e-3*m(hi)
if (contours) {
   a1 = 1.0; a2 = 1.0*m(lo)/m(mid); a3 = 1.0*m(lo)/m(hi)
   contours = a1 - a2 > 1e-3 && a2 - a3 > 1e-3
}
rotor(j) = abs(rotors[3*group(b) - 3 + j])
if (rotor(1) + rotor(2) + rotor(3) > 0) { contours = 0 }

# Unit momentum in principal axes.
size(k) = larger(larger(abs(principal(b,1)), abs(principal(b,2))), abs(principal(b,3)))
whole(k) = size(k)*length(principal(b,1)/size(k), principal(b,2)/size(k), principal(b,3)/size(k))
u(j) = size(j) > 0 ? principal(b,j)/whole(j) : NaN

# Seen from between the momentum at the start and the axis it runs around.
array at[3]
at[1] = 0; at[2] = 0; at[3] = 0
stats file skip 1 every ::body::body using (size(1) > 0 ? (at[1] = u(1), at[2] = u(2), at[3] = u(3)) : 0, 1) nooutput
hides(j) = abs(start[j]) > 0.99   # the name of an axis the point at the start
array start[3]
do for [j=1:3] { start[j] = at[j] }
if (contours) {
   pole = (a1 - a2)*at[lo]**2 < (a2 - a3)*at[hi]**2 ? hi : lo
   at[pole] = at[pole] + (at[pole] < 0 ? -1.2 : 1.2)
}
r = length(at[1], at[2], at[3])
az = 35*pi/180; el = 22*pi/180
if (r > 0) {
   el = (at[3] < 0 ? -1 : 1)*(18 + 28*abs(at[3]/r))*pi/180
   if (abs(at[3]/r) < 0.99) { az = atan2(at[2], at[1]) + 25*pi/180 }
}

# Sorted coordinates (x: smallest moment, z: largest) as those of the body.
B(j,x,y,z) = j == lo ? x : j == mid ? y : z
nx(x,y,z) = near(B(1,x,y,z), B(2,x,y,z), B(3,x,y,z))
ny(x,y,z) = py(B(1,x,y,z), B(2,x,y,z), B(3,x,y,z))

# Contours of H = sum a_j u_j^2, a = 1/I sorted: level k of 5 about the axis of the smallest moment (side g), of the largest; and
# the separatrix, two great circles through the middle axis.
p = contours ? sqrt((a1 - a2)/(a1 - a3)) : 0
q = contours ? sqrt((a2 - a3)/(a1 - a3)) : 0
up(s,k,w) = sqrt(1 - (k/5.0*cos(s))**2 - (k/5.0*w*sin(s))**2)
C1x(s,k,g) = nx(g*up(s,k,p), k/5.0*cos(s), k/5.0*p*sin(s))
C1y(s,k,g) = ny(g*up(s,k,p), k/5.0*cos(s), k/5.0*p*sin(s))
C3x(s,k,g) = nx(k/5.0*q*sin(s), k/5.0*cos(s), g*up(s,k,q))
C3y(s,k,g) = ny(k/5.0*q*sin(s), k/5.0*cos(s), g*up(s,k,q))
SX(s,g) = nx(g*q*cos(s), sin(s), p*cos(s))
SY(s,g) = ny(g*q*cos(s), sin(s), p*cos(s))
lines = "for [g=-1:1:2] for [k=1:4] [s=0:2*pi] '+' using (C1x($1,k,g)):(C1y($1,k,g)) with lines lc rgb '#7d7d7d' lw 0.8, " . \
   "for [g=-1:1:2] for [k=1:4] [s=0:2*pi] '+' using (C3x($1,k,g)):(C3y($1,k,g)) with lines lc rgb '#7d7d7d' lw 0.8, " . \
   "for [g=-1:1:2] [s=0:2*pi] '+' using (SX($1,g)):(SY($1,g)) with lines lc rgb '#7d7d7d' lw 1.6 dt 2"
background = contours ? outline . ', ' . lines : wires_far . ', ' . wires_near . ', ' . outline

eval arcs('path', body, 'u(1)', 'u(2)', 'u(3)')
side(x,y,z) = depth(x,y,z) >= 0 ? 1 : -1
name(j,g) = (g > 0 ? '' : '-') . (turned[group(b)] ? sprintf('axis %d', j) : sprintf('y_%d', j))

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'momentum', 520, 520)
   eval sphere
   set margins 0.2,0.2,0.2,0.2
   set style textbox opaque noborder fillcolor rgb '#ffffff' margins 0.6,0.4
   do for [j=1:3] {
      g = side(j==1,j==2,j==3)
      set label j name(j,g) at g*px(j==1,j==2,j==3),g*py(j==1,j==2,j==3) center boxed front \
         offset hides(j) ? 2.2 : 0, hides(j) ? 0.6 : 0
   }
   if (turned[group(b)]) { set label 5 'principal axes' at -1.12,-1.12 tc rgb '#555555' }
   if (bodies > 1) { set label 4 sprintf('body %d', b) at -1.12,1.12 tc rgb '#555555' }
   plot @background, \
      $path using (far($1,$2,$3)):(py($1,$2,$3)) with lines lc rgb pale lw 3, \
      $path using (near($1,$2,$3)):(py($1,$2,$3)) with lines lc rgb dark lw 3.5, \
      file skip 1 every ::body::body using (far(u(1),u(2),u(3))):(py(u(1),u(2),u(3))) with points pt 6 ps 1.1 lw 2 lc rgb dark, \
      '' skip 1 every ::body::body using (near(u(1),u(2),u(3))):(py(u(1),u(2),u(3))) with points pt 7 ps 1.8 lc rgb '#ffffff', \
      '' skip 1 every ::body::body using (near(u(1),u(2),u(3))):(py(u(1),u(2),u(3))) with points pt 7 ps 1.3 lc rgb dark
   unset output
}
