# Hairer and Vilmart's figure 1: left the first body, right the second; error of the attitude against time of the run.
# `gnuplot plot_hairer-vilmart.gp`, in this folder, draws hairer-vilmart.svg and hairer-vilmart.png.
load 'common.gp'
set datafile separator ','
file = 'hairer-vilmart.csv'
stats file skip 1 using 8 name 'X' nooutput
left = round_down(0.5*X_min); right = round_up(1.5*X_max); bottom = 1e-16; top = 10.0
across(x) = log(x/left)/log(right/left)
along(y) = log(larger(y, 1e-16)/bottom)/log(top/bottom)
is(k, body) = column(1) == body && strcol(2) eq end_text[k]

# The methods in the order of the file.
ends = 0; name = ''
array end_x[20]
array end_y[20]
array end_text[20]
array end_colour[20]
stats file skip 1 using (column(1) == 1 && strcol(2) ne name ? (ends = ends + 1, name = strcol(2), end_text[ends] = name, 1) : 0) \
   nooutput
do for [k=1:ends] { end_colour[k] = colour(k) }

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'hairer-vilmart', 960, 470)
   set multiplot
   set logscale xy; set format x '10^{%T}'; set format y '10^{%T}'
   set border 3; set tics nomirror out; unset key; set grid lc rgb '#ececec' lt 1 lw 0.7
   set tmargin 2.5; set bmargin 3.5
   set xlabel 'time of the run to t = 10, microseconds per body'
   set xrange [left:right]; set yrange [bottom:top]
   do for [body=1:2] {
      unset label; unset arrow
      if (body == 1) { set ylabel 'error in attitude at t = 10, radians' } else { unset ylabel }
      set lmargin at screen body == 1 ? 0.095 : 0.57
      set rmargin at screen body == 1 ? 0.42 : 0.895
      set label 1 (body == 1 ? 'moments 0.6, 0.8, 1' : 'moments 0.345, 0.653, 1') at graph 0, graph 1.05 font ',13'
      do for [k=1:ends] {
         end_x[k] = 0; end_y[k] = 0
         stats file skip 1 using (is(k, body) ? (end_x[k] = across(column(8)), end_y[k] = along(column(6))) : 0) nooutput
      }
      gap = 0.042; letter = 0.0205
      load 'ends.gp'
      plot for [k=1:ends] file skip 1 using (is(k, body) ? column(8) : NaN):6 \
         with linespoints pt shape(k) ps 0.6 lw 1.4 lc rgb colour(k)
   }
   unset multiplot
   unset output
}
