# The angle of a body axis about z against time, followed through full turns, in a frame that may turn: one or two bodies in one
# graph, at most 16 in a lane each.
# `gnuplot plot_angle.gp`, in this folder, draws angle.svg and angle.png.
load 'motion.gp'
lanes = smaller(bodies, 16)

jump(p) = p - 360*floor((p + 180)/360.0)
turned_to(p) = (old = (old > -1e8 ? old + jump(p - old) : jump(p)))
angle(k) = abs(AX(k)) + abs(AY(k)) < 1e-12 ? NaN : turned_to((atan2(AY(k), AX(k)) - rate*column(1))*180/pi)
start(k) = column(0) == 0 ? (old = -1e9) : 0

ends = lanes
array end_x[ends]
array end_y[ends]
array end_text[ends]
array end_colour[ends]
least = 1e300; most = -1e300
do for [k=1:lanes] {
   old = -1e9; last = 0
   stats file skip 1 every bodies::k-1 using (p = angle(1), last = (p == p ? p : last), p) name 'A' nooutput
   if (exists('A_max')) { least = smaller(least, A_min); most = larger(most, A_max) }
   end_x[k] = 1; end_y[k] = last; end_colour[k] = colour(k); end_text[k] = sprintf('body %d', number[k])
}
if (least > most) { least = 0; most = 0 }
if (most - least < 1e-6) { least = least - 1; most = most + 1 }
span = most - least
step = tick(span, 7)
bottom = step*floor(least/step - 0.02); top = step*ceil(most/step + 0.02)
widest = larger(abs(least), abs(most)); widest = widest > 0 ? widest : 1
do for [k=1:ends] { end_y[k] = (end_y[k] - bottom)/(top - bottom) }
frame = rate == 0 ? 'about z, from x' : sprintf('about z, from a direction that turns at rate %g', rate)

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'angle', 720, bodies <= 2 ? 400 : 560)
   unset key; set border 3; set tics nomirror out; set tmargin 2.5
   set xlabel 't'; set xrange [t_first : t_last]; set xtics tick(t_last - t_first, 7)
   set label 1 axis_name . ': angle ' . frame at graph 0, graph 1.05 tc rgb '#555555'
   if (bodies <= 2) {
      set ylabel 'angle (degrees)'; set zeroaxis lc rgb '#c8c8c8'; set rmargin bodies > 1 ? 9 : 3
      set yrange [bottom:top]; set ytics step
      gap = 0.055; letter = 0.0105
      if (bodies > 1) { load 'ends.gp' }
      plot for [k=1:bodies] file skip 1 every bodies::k-1 using (start(1), $1):(angle(1)) with lines lw 1.6 lc rgb colour(k)
   } else {
      set rmargin 3
      set ylabel sprintf(widest < 1000 ? 'body; a band is %.3g degrees to either side' : 'body; a band is %.0f degrees to either side', widest)
      set yrange [lanes+0.6:0.4]; set ytics ()
      do for [k=1:lanes] { set ytics add (sprintf('%d', number[k]) k) }
      if (bodies > lanes) {
         set label 2 sprintf('the first %d of %d bodies', lanes, bodies) at graph 1, graph 1.05 right tc rgb '#555555'
      }
      plot for [k=1:lanes] k with lines lc rgb '#dddddd' lw 0.8, \
         for [k=1:lanes] file skip 1 every bodies::k-1 using (start(1), $1):(k - 0.46/widest*angle(1)) with lines lc rgb dark lw 1.4
   }
   unset output
}
