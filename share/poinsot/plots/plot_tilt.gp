# The angle of a body axis from z against time, a curve for each of at most 16 bodies.
# `gnuplot plot_tilt.gp`, in this folder, draws tilt.svg and tilt.png.
load 'motion.gp'
ends = smaller(bodies, 16)
theta(k) = atan2(sqrt(AX(k)**2 + AY(k)**2), AZ(k))*180/pi

array end_x[ends]
array end_y[ends]
array end_text[ends]
array end_colour[ends]
most = 0
do for [k=1:ends] {
   stats file skip 1 every bodies::k-1 using (last = theta(1)) name 'A' nooutput
   most = larger(most, A_max)
   end_x[k] = 1; end_y[k] = last; end_colour[k] = colour(k)
   end_text[k] = sprintf('body %d', number[k])
}
if (most < 1e-6) { most = 1 }
step = most > 90 ? 30 : tick(most, 6)
top = step*ceil(0.9999*most/step)
do for [k=1:ends] { end_y[k] = end_y[k]/top }

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'tilt', 720, 400)
   unset key; set border 3; set tics nomirror out; set rmargin 9; set tmargin 2.5
   set xlabel 't'; set ylabel 'angle (degrees)'
   set label 2 axis_name . ': angle from z' at graph 0, graph 1.06 tc rgb '#555555'
   set xrange [t_first : t_last]; set yrange [0:top]; set ytics step
   set xtics tick(t_last - t_first, 7)
   gap = 0.055; letter = 0.0105
   if (bodies > 1) { load 'ends.gp' }
   if (bodies > ends) {
      set label 1 sprintf('the first %d of %d bodies', ends, bodies) at graph 1, graph 1.06 right tc rgb '#555555'
   }
   plot for [k=1:ends] file skip 1 every bodies::k-1 using 1:(theta(1)) with lines lw 1.6 dt 1+(k-1)/8 lc rgb colour(k)
   unset output
}
