# When the exact rotor pays inside a splitting: time with other rotors over time with the exact one.
# `gnuplot plot_celledoni.gp`, in this folder, draws celledoni.svg and celledoni.png.
load 'common.gp'
set datafile separator ','
file = 'celledoni.csv'
stats file skip 1 using 1 name 'X' nooutput
stats file skip 1 using 8 name 'Y' nooutput
left = 0.5*X_min; right = 1.5*X_max; bottom = 0.6; top = round_up(1.2*larger(Y_max, 2))
across(x) = log(x/left)/log(right/left)
along(y) = log(y/bottom)/log(top/bottom)

# The other rotors, in the order of the file, and where their curves end.
array end_x[20]
array end_y[20]
array end_text[20]
array end_colour[20]
ends = 0; name = ''; most = 0; counted = 0
follow(k) = (strcol(2) ne name ? (name = strcol(2), most = 0, counted = 0) : 0, \
   name ne 'exact' && column(1) > most && column(8) > 0 ? \
   (ends = counted ? ends : ends + 1, counted = 1, most = column(1), end_text[ends] = name, \
    end_x[ends] = across(column(1)), end_y[ends] = along(column(8))) : 0, 1)
stats file skip 1 using (follow(1)) nooutput
do for [k=1:ends] { end_colour[k] = colour(k + 1) }

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'celledoni', 820, 500)
   set logscale xy; set format x '10^{%T}'; set format y '%g'
   set border 3; set tics nomirror out; unset key; set grid lc rgb '#ececec' lt 1 lw 0.7; set tmargin 3
   set ytics (0.7, 1, 2, 5, 10, 20, 50, 100, 200, 500)
   set xlabel 'kinetic energy over energy of the torque'
   set ylabel 'time over that with exact, error 1e-6'
   set label 1 'when the exact rotor pays inside a splitting' at graph 0, graph 1.06 font ',14'
   set label 2 'slow body, strong torque' at graph 0.01, graph 0.03 tc rgb '#606060' font ',10'
   set label 3 'fast spin, weak torque' at graph 0.99, graph 0.03 right tc rgb '#606060' font ',10'
   set label 4 '1: exact' at graph 0.5, first 0.85 center tc rgb '#606060' font ',10'
   set xrange [left:right]; set yrange [bottom:top]
   gap = 0.036; letter = 0.0098; overhang = 2
   if (ends > 0) { load 'ends.gp' }
   set rmargin 3 + 0.78*overhang
   if (ends > 0) {
      plot 1 with lines lw 3 lc rgb '#c8c8c8', \
         for [k=1:ends] file skip 1 using (strcol(2) eq end_text[k] && column(8) > 0 ? column(1) : NaN):8 \
            with linespoints pt shape(k + 1) ps 0.8 lw 1.6 lc rgb colour(k + 1)
   } else { # nothing was measured in time
      plot 1 with lines lw 3 lc rgb '#c8c8c8'
   }
   unset output
}
