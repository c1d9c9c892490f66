# A body axis in space: left its curve on the sphere, right its two angles against each other.
# `gnuplot plot_nutation.gp`, in this folder, draws nutation.svg and nutation.png.
load 'motion.gp'
az = 35*pi/180; el = 22*pi/180

# Angle from the vertical, and azimuth followed through full turns; in degrees. On the vertical there is no azimuth.
theta(k) = atan2(sqrt(AX(k)**2 + AY(k)**2), AZ(k))*180/pi
jump(p) = p - 360*floor((p + 180)/360.0)
turned_to(p) = (old = (old > -1e8 ? old + jump(p - old) : p))
phi(k) = abs(AX(k)) + abs(AY(k)) < 1e-12 ? (column(0) == 0 && phi_0 > -1e8 ? phi_0 : NaN) : turned_to(atan2(AY(k), AX(k))*180/pi)

# Where it begins, with the first azimuth there is; ranges.
old = -1e9; phi_0 = -1e9; phi_1 = -1e9
stats file skip 1 every ::body::body using (b = $2, theta_0 = theta(1), 1) nooutput
stats file skip 1 every bodies::body using (p = phi(1), phi_1 = (phi_1 < -1e8 && p == p ? p : phi_1), p) name 'P' nooutput
stats file skip 1 every bodies::body using (theta(1)) name 'A' nooutput
phi_0 = phi_1 > -1e8 ? phi_1 : 0
if (!exists('P_max')) { P_min = 0; P_max = 0 }
wide = larger(P_max - P_min, 1e-6); high = larger(A_max - A_min, 1e-6)

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'nutation', 960, 470)
   set multiplot
   eval sphere
   set lmargin at screen 0.0; set rmargin at screen 0.47; set bmargin at screen 0.02; set tmargin at screen 0.98
   set arrow 1 from 0,py(0,0,1) to 0,py(0,0,1)+0.16 lc rgb '#7d7d7d' front
   set label 1 'up' at 0.05,py(0,0,1)+0.12 tc rgb '#7d7d7d'
   set label 2 axis_name . (bodies > 1 ? sprintf(' of body %d', b) : '') at -1.15,1.1 tc rgb '#555555'
   plot @wires_far, @wires_near, @outline, \
      file skip 1 every bodies::body using (far(AX(1),AY(1),AZ(1))):(py(AX(1),AY(1),AZ(1))) with lines lc rgb pale lw 1.4, \
      '' skip 1 every bodies::body using (near(AX(1),AY(1),AZ(1))):(py(AX(1),AY(1),AZ(1))) with lines lc rgb dark lw 1.9, \
      '' skip 1 every ::body::body using (far(AX(1),AY(1),AZ(1))):(py(AX(1),AY(1),AZ(1))) with points pt 6 ps 1.2 lw 1.6 \
         lc rgb dark, \
      '' skip 1 every ::body::body using (near(AX(1),AY(1),AZ(1))):(py(AX(1),AY(1),AZ(1))) with points pt 7 ps 1.5 \
         lc rgb '#ffffff', \
      '' skip 1 every ::body::body using (near(AX(1),AY(1),AZ(1))):(py(AX(1),AY(1),AZ(1))) with points pt 7 ps 1.1 lc rgb dark
   unset arrow 1; unset label 1; unset label 2; set size noratio; set border 3
   set lmargin at screen 0.57; set rmargin at screen 0.965; set bmargin at screen 0.14; set tmargin at screen 0.93
   set xtics nomirror out tick(wide, 6) format '%g'
   set ytics nomirror out tick(high, 9) format '%g'
   set xrange [P_min - 0.03*wide : P_max + 0.03*wide]; set yrange [A_max + 0.03*high : A_min - 0.03*high]
   set xlabel 'azimuth of ' . axis_name . ' (degrees)'
   set ylabel 'angle of ' . axis_name . ' from the vertical (degrees)'
   plot file skip 1 every bodies::body using ($0 == 0 ? (old = -1e9) : 0, phi(1)):(theta(1)) with lines lc rgb dark lw 1.6, \
      '+' every ::0::0 using (phi_0):(theta_0) with points pt 7 ps 1.5 lc rgb '#ffffff', \
      '+' every ::0::0 using (phi_0):(theta_0) with points pt 7 ps 1.1 lc rgb dark
   unset multiplot
   unset output
}
