# Error of the attitude against the step; the slope of each curve beside its name.
# `gnuplot plot_attitude_step.gp`, in this folder, draws attitude_step.svg and attitude_step.png.
load 'study.gp'
ok(k) = column(27) > 0 && column(30) > 0
e(k) = at_least(column(7))
is_shown(name) = shown > 0 ? sum [j = 1:shown] (shown_name[j] eq name) : 0
stats 'cost.csv' skip 1 using (ok(1) && is_shown(label(1)) ? $6 : NaN) name 'X' nooutput
stats 'cost.csv' skip 1 using (ok(1) && is_shown(label(1)) ? e(1) : NaN) name 'Y' nooutput
if (!exists('X_min')) { X_min = 1e-3; X_max = 1; Y_min = 1e-3; Y_max = 1 }
left = round_down(0.9*X_min); right = round_up(1.1*X_max); bottom = round_down(0.5*Y_min); top = round_up(1.1*Y_max)

# Eight colours, and another shape of points in the second round.
look(k) = colour(k)
mark(k) = shape(k + (k - 1)/8)

# Names at the ends with the longest steps.
ends = shown
array end_x[ends + 1]
array end_y[ends + 1]
array end_text[ends + 1]
array end_colour[ends + 1]
array end_shape[ends + 1]
do for [k=1:ends] {
   x = 0
   stats 'cost.csv' skip 1 using (label(1) eq shown_name[k] && ok(1) && $6 > x ? (x = $6, y = e(1)) : 0) nooutput
   end_x[k] = fraction(x, left, right); end_y[k] = fraction(y, bottom, top); end_colour[k] = look(k); end_shape[k] = mark(k)
   name = shown_name[k]
   if (strstrt(name, 'exact + ') == 1) { name = name[9:*] }
   end_text[k] = name . (shown_slope[k] > 0 ? sprintf('  %.1f', shown_slope[k]) : '')
}

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'attitude_step', 820, 560)
   eval logarithmic
   set label 1 title('error against step size') at graph 0, graph 1.05 font ',14' noenhanced
   set label 2 (few ? '' : 'exact rotation; ') . 'names with their slopes' at screen 0.985, graph 1.05 right \
      tc rgb '#606060' font ',10'
   set xrange [left:right]; set yrange [bottom:top]
   set xlabel 'step size h'
   set ylabel sprintf('error in attitude, radians, at t = %g (median)', t_end)
   gap = 0.034; letter = 0.0098
   if (ends > 0) { load 'ends.gp'; set rmargin 3 + 0.78*overhang }
   if (shown > 0) {
      plot for [k=1:shown] 'cost.csv' skip 1 using 6:(label(1) eq shown_name[k] && ok(1) ? e(1) : NaN) \
         with linespoints pt mark(k) ps 0.5 lw 1.4 lc rgb look(k)
   } else {
      plot NaN
   }
   unset output
}
