# What the plot scripts of a run share: the columns of trajectory.csv as vectors, and curves on a sphere.
load 'trajectory.gp'
load 'common.gp'
file = 'trajectory.csv'
set datafile separator ','

# Components in space of the vector (u, v, w) that stands in the body, by the quaternion of the row.
X(u,v,w) = (1 - 2*(column(5)**2 + column(6)**2))*u + 2*(column(4)*column(5) - column(3)*column(6))*v \
   + 2*(column(4)*column(6) + column(3)*column(5))*w
Y(u,v,w) = 2*(column(4)*column(5) + column(3)*column(6))*u + (1 - 2*(column(4)**2 + column(6)**2))*v \
   + 2*(column(5)*column(6) - column(3)*column(4))*w
Z(u,v,w) = 2*(column(4)*column(6) - column(3)*column(5))*u + 2*(column(5)*column(6) + column(3)*column(4))*v \
   + (1 - 2*(column(4)**2 + column(5)**2))*w
length(x,y,z) = sqrt(x*x + y*y + z*z)

# The body axis that the scene follows.
AX(k) = X(axis[1], axis[2], axis[3])
AY(k) = Y(axis[1], axis[2], axis[3])
AZ(k) = Z(axis[1], axis[2], axis[3])
along(j) = abs(axis[j]) > 0.9999999
axis_name = along(1) ? 'body axis 1' : along(2) ? 'body axis 2' : along(3) ? 'body axis 3' : \
   sprintf('body axis (%.3g, %.3g, %.3g)', axis[1], axis[2], axis[3])

# Bodies: the number that row k of a frame has in the scene, from 1; its group; what its group is like, in principal axes.
array number[bodies]
stats file skip 1 every ::0::bodies-1 using (number[int($0) + 1] = $2, 1) nooutput
group(b) = 1 + (groups > 1 ? sum [g = 1:groups] (b > last_body[g]) : 0)
moment(b, j) = moments[3*group(b) - 3 + j]
principal(b, j) = axes[9*group(b) - 12 + 3*j + 1]*column(7) + axes[9*group(b) - 12 + 3*j + 2]*column(8) \
   + axes[9*group(b) - 12 + 3*j + 3]*column(9)
moving(b, j) = principal(b, j) - rotors[3*group(b) - 3 + j]

stats file skip 1 every bodies using 1 name 'T' nooutput
t_first = T_min; t_last = T_max > T_min ? T_max : T_min + 1

# `eval arcs('block', k, 'x', 'y', 'z')`: the curve of a unit vector of row k of the frames, from output to output along great
# circles, as a data block. x, y, z say it of a row; where they are undefined the curve is broken.
outputs = T_records
array arc_x[outputs]
array arc_y[outputs]
array arc_z[outputs]
arc_row(x,y,z) = (arc_x[int($0) + 1] = x, arc_y[int($0) + 1] = y, arc_z[int($0) + 1] = z, 1)
arc_at(i) = smaller(int(i) + 1, larger(outputs - 1, 1))
arc_to(i) = smaller(arc_at(i) + 1, outputs)
arc_angle(n,m) = atan2(length(arc_y[n]*arc_z[m] - arc_z[n]*arc_y[m], arc_z[n]*arc_x[m] - arc_x[n]*arc_z[m], \
   arc_x[n]*arc_y[m] - arc_y[n]*arc_x[m]), arc_x[n]*arc_x[m] + arc_y[n]*arc_y[m] + arc_z[n]*arc_z[m])
part(s,w) = w > 1e-6 && w < 3.14 ? sin(s*w)/sin(w) : s
between(i,a,b) = (s = i + 1 - arc_at(i), w = arc_angle(arc_at(i), arc_to(i)), part(1 - s, w)*a + part(s, w)*b)
arcs(block, k, x, y, z) = sprintf("stats file skip 1 every bodies::%d using (arc_row(%s, %s, %s)) nooutput; widest = 0; " . \
   "do for [n=1:outputs-1] { w = arc_angle(n, n+1); if (w == w) { widest = larger(widest, w) } }; " . \
   "set samples larger(outputs-1, 1)*int(larger(1, smaller(smaller(40, 40000.0/outputs), ceil(widest/0.04)))) + 1; " . \
   "set table $%s separator comma; plot [i=0:larger(outputs-1, 1)] '+' " . \
   "using (between($1, arc_x[arc_at($1)], arc_x[arc_to($1)])):(between($1, arc_y[arc_at($1)], arc_y[arc_to($1)]))" . \
   ":(between($1, arc_z[arc_at($1)], arc_z[arc_to($1)])) with table; unset table", k, x, y, z, block)

# The unit sphere seen from (az, el): projection, depth; near and far side.
px(x,y,z) = -sin(az)*x + cos(az)*y
py(x,y,z) = -cos(az)*sin(el)*x - sin(az)*sin(el)*y + cos(el)*z
depth(x,y,z) = cos(az)*cos(el)*x + sin(az)*cos(el)*y + sin(el)*z
near(x,y,z) = depth(x,y,z) >= 0 ? px(x,y,z) : NaN
far(x,y,z) = depth(x,y,z) < 0 ? px(x,y,z) : NaN
sphere = "set size ratio -1; unset border; unset tics; unset key; " . \
   "set xrange [-1.18:1.18]; set yrange [-1.18:1.18]; set samples 361"

# For plot: its meridians and parallels every 30 degrees, on the far side and on the near one, and its outline.
MX(s,k) = cos(s)*cos(k*pi/6)
MY(s,k) = cos(s)*sin(k*pi/6)
PZ(k) = sin(k*pi/6)
wires_far = "for [k=0:5] [s=0:2*pi] '+' using (far(MX($1,k),MY($1,k),sin($1))):(py(MX($1,k),MY($1,k),sin($1)))" . \
   " with lines lc rgb '#efefef', " . \
   "for [k=-2:2] [s=0:2*pi] '+' using (far(MX($1,k),sin($1)*cos(k*pi/6),PZ(k))):(py(MX($1,k),sin($1)*cos(k*pi/6),PZ(k)))" . \
   " with lines lc rgb '#efefef'"
wires_near = "for [k=0:5] [s=0:2*pi] '+' using (near(MX($1,k),MY($1,k),sin($1))):(py(MX($1,k),MY($1,k),sin($1)))" . \
   " with lines lc rgb '#d9d9d9', " . \
   "for [k=-2:2] [s=0:2*pi] '+' using (near(MX($1,k),sin($1)*cos(k*pi/6),PZ(k))):(py(MX($1,k),sin($1)*cos(k*pi/6),PZ(k)))" . \
   " with lines lc rgb '#d9d9d9'"
outline = "for [k=1:1] [s=0:2*pi] '+' using (cos($1)):(sin($1)) with lines lc rgb '#9a9a9a' lw 1"
