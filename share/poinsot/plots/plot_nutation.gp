# A body axis in space: left its curve on the sphere, right its two angles against each other.
# `gnuplot plot_nutation.gp`, in this folder, draws nutation.svg and nutation.png.
load 'motion.gp'
az = 35*pi/180; el = 22*pi/180

# Angle from the vertical, and azimuth followed through full turns; in degrees. On the vertical there is no azimuth.
theta(k) = atan2(sqrt(AX(k)**2 + AY(k)**2), AZ(k))*180/pi
jump(p) = p - 360*floor((p + 180)/360.0)
turned_to(p) = (old = (old > -1e8 ? old + jump(p - old) : p))
phi(k) = abs(AX(k)) + abs(AY(k)) < 1e-12 ? (column(0) == 0 && phi_0 > -1e8 ? phi_0 : NaN) : turned_to(atan2(AY(k), AX(k))*180/pi)

# Up to six bodies, each with a colour of its own; or the one that the run says.
shown = bodies > 1 && bodies <= 6 ? bodies : 1
first = shown > 1 ? 0 : body
shade(i) = shown > 1 ? colour(i) : dark

# Where each begins, with the first azimuth there is; ranges of all.
array phis[shown]; array thetas[shown]; array names[shown]
azimuth_low = 1e9; azimuth_high = -1e9; angle_low = 1e9; angle_high = -1e9
do for [i = 1:shown] {
   old = -1e9; phi_0 = -1e9; phi_1 = -1e9
   k = first + i - 1
   stats file skip 1 every ::k::k using (b = $2, theta_0 = theta(1), 1) nooutput
   stats file skip 1 every bodies::k using (p = phi(1), phi_1 = (phi_1 < -1e8 && p == p ? p : phi_1), p) name 'P' nooutput
   stats file skip 1 every bodies::k using (theta(1)) name 'A' nooutput
   phis[i] = phi_1 > -1e8 ? phi_1 : 0
   thetas[i] = theta_0; names[i] = sprintf('%d', b)
   if (!exists('P_max')) { P_min = 0; P_max = 0 }
   azimuth_low = smaller(azimuth_low, P_min); azimuth_high = larger(azimuth_high, P_max)
   angle_low = smaller(angle_low, A_min); angle_high = larger(angle_high, A_max)
}
wide = larger(azimuth_high - azimuth_low, 1e-6); high = larger(angle_high - angle_low, 1e-6)
do for [i = 1:shown] { eval arcs(sprintf('path_%d', i), first + i - 1, 'AX(1)', 'AY(1)', 'AZ(1)') }
near_paths = ''; far_paths = ''
do for [i = 1:shown] {
   far_paths = far_paths . sprintf("$path_%d using (far($1,$2,$3)):(py($1,$2,$3)) with lines lc rgb pale lw 1.4, ", i)
   near_paths = near_paths . sprintf("$path_%d using (near($1,$2,$3)):(py($1,$2,$3)) with lines lc rgb shade(%d) lw 1.9, ", i, i)
}
of_body = shown > 1 ? ' of bodies 1 to ' . names[shown] : bodies > 1 ? ' of body ' . names[1] : ''

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'nutation', 960, 470)
   set multiplot
   eval sphere
   set lmargin at screen 0.0; set rmargin at screen 0.47; set bmargin at screen 0.02; set tmargin at screen 0.98
   set arrow 1 from 0,py(0,0,1) to 0,py(0,0,1)+0.16 lc rgb '#7d7d7d' front
   set label 1 'up' at 0.05,py(0,0,1)+0.12 tc rgb '#7d7d7d'
   set label 2 axis_name . of_body at -1.15,(shown > 1 ? -1.12 : 1.1) tc rgb '#555555'
   plot @wires_far, @wires_near, @outline, @far_paths @near_paths \
      for [i=1:shown] file skip 1 every ::first+i-1::first+i-1 using (far(AX(1),AY(1),AZ(1))):(py(AX(1),AY(1),AZ(1))) \
         with points pt 6 ps 1.2 lw 1.6 lc rgb shade(i), \
      for [i=1:shown] file skip 1 every ::first+i-1::first+i-1 using (near(AX(1),AY(1),AZ(1))):(py(AX(1),AY(1),AZ(1))) \
         with points pt 7 ps 1.5 lc rgb '#ffffff', \
      for [i=1:shown] file skip 1 every ::first+i-1::first+i-1 using (near(AX(1),AY(1),AZ(1))):(py(AX(1),AY(1),AZ(1))) \
         with points pt 7 ps 1.1 lc rgb shade(i)
   unset arrow 1; unset label 1; unset label 2; set size noratio; set border 3
   set lmargin at screen 0.57; set rmargin at screen 0.965; set bmargin at screen 0.14; set tmargin at screen 0.93
   set xtics nomirror out tick(wide, 6) format '%g'
   set ytics nomirror out tick(high, 9) format '%g'
   set xrange [azimuth_low - 0.03*wide : azimuth_high + 0.03*wide]; set yrange [angle_high + 0.03*high : angle_low - 0.03*high]
   set xlabel 'azimuth of ' . axis_name . ' (degrees)'
   set ylabel 'angle of ' . axis_name . ' from the vertical (degrees)'
   plot for [i=1:shown] file skip 1 every bodies::first+i-1 \
         using ($0 == 0 ? (old = -1e9, phi_0 = phis[i]) : 0, phi(1)):(theta(1)) with lines lc rgb shade(i) lw 1.6, \
      for [i=1:shown] '+' every ::0::0 using (phis[i]):(thetas[i]) with points pt 7 ps 1.5 lc rgb '#ffffff', \
      for [i=1:shown] '+' every ::0::0 using (phis[i]):(thetas[i]) with points pt 7 ps 1.1 lc rgb shade(i), \
      for [i=1:shown] '+' every ::0::0 using (phis[i]):(thetas[i]):(shown > 1 ? names[i] : '') with labels offset 1.2,0 \
         tc rgb shade(i)
   unset multiplot
   unset output
}
