# The error of the energy against time in long runs.
# `gnuplot plot_energy_drift.gp`, in this folder, draws energy_drift.svg and energy_drift.png.
load 'study.gp'
run_name(k) = valid(7) ? sprintf('%s, tolerance = %.2g', label(1), column(7)) : sprintf('%s, h = %.4g', label(1), column(3))
stats 'drift.csv' skip 1 using 4 name 'X' nooutput
stats 'drift.csv' skip 1 using (larger($5, 2e-17)) name 'Y' nooutput
left = round_down(0.9*X_min); right = round_up(1.1*X_max); bottom = round_down(0.3*larger(Y_min, 6e-17)); top = round_up(10*Y_max)

# The runs in the order of the file, and where they end.
array end_x[100]
array end_y[100]
array end_text[100]
array end_colour[100]
ends = 0; name = ''
follow(k) = (run_name(1) ne name ? (ends = ends + 1, name = run_name(1)) : 0, end_text[ends] = name, \
   end_x[ends] = fraction(column(4), left, right), end_y[ends] = fraction(larger(column(5), 2e-17), bottom, top), 1)
stats 'drift.csv' skip 1 using (follow(1)) nooutput
do for [k=1:ends] { end_colour[k] = colour(k) }

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'energy_drift', 820, 560)
   eval logarithmic
   set label 1 title(sprintf('energy in long runs (median of %d states)', states)) at graph 0, graph 1.05 font ',14' noenhanced
   set xrange [left:right]; set yrange [bottom:top]
   set xlabel 't'; set ylabel 'largest relative energy error so far'
   gap = 0.034; letter = 0.0122
   load 'ends.gp'; set rmargin 3 + 0.78*overhang
   plot for [k=1:ends] 'drift.csv' skip 1 using 4:(run_name(1) eq end_text[k] ? larger($5, 2e-17) : NaN) \
      with linespoints pt shape(k) ps 0.5 lw 1.6 lc rgb colour(k)
   unset output
}
