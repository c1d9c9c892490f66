# The work-precision diagram of plot_attitude_cost.gp and plot_momentum_cost.gp: every candidate as a curve; those on the
# efficient frontier, and the exact one, in colours and with names; of few candidates the others have names too.
ok(k) = column(27) > 0 && column(25) > 0 && column(shown) > 0
e(k) = at_least(column(error))
stats 'cost.csv' skip 1 using (ok(1) && e(1) <= 1 ? e(1) : NaN) name 'X' nooutput
stats 'cost.csv' skip 1 using (ok(1) && e(1) <= 1 ? column(25) : NaN) name 'T' nooutput
if (!exists('X_min')) { X_min = 1e-16; X_max = 1; T_min = 1; T_max = 1 }
if (rivals > 0) {
   stats 'rivals.csv' skip 1 using (column(rival) <= 0.1 ? $4 : NaN) name 'R' nooutput
   if (exists('R_min')) {
      T_min = smaller(T_min, R_min)
      T_max = larger(T_max, smaller(R_max, 1e5*T_min))
   }
}
rival_file = rivals > 0 ? 'rivals.csv' : 'cost.csv'   # gnuplot opens it even for no curve
left = round_up(X_max); right = round_down(X_min)/3; bottom = 0.6*T_min; top = round_up(T_max)

# Where names stand: under the middle of its stretch for a candidate on the frontier, beside the finest point for others.
quiet = few ? candidates : 0
ends = strong + quiet + rivals
array end_x[ends + 1]
array end_y[ends + 1]
array end_text[ends + 1]
array end_colour[ends + 1]
found = 0
on_stretch(name) = label(1) eq name && ok(1) && column(on_front) > 0
is_strong(name) = strong > 0 ? sum [j = 1:strong] (names[j] eq name) : 0
do for [k=1:ends] {
   name = k <= strong ? names[k] : k <= strong + quiet ? candidate[k - strong] : rival_name[k - strong - quiet]
   x = 0
   if (k <= strong || (k <= strong + quiet && !is_strong(name))) {
      stats 'cost.csv' skip 1 using (label(1) eq name && ok(1) ? (x = e(1), y = $25) : 0) nooutput
      n = 0; m = 0
      stats 'cost.csv' skip 1 using (on_stretch(name) ? (n = n + 1) : 0) nooutput
      stats 'cost.csv' skip 1 using (on_stretch(name) ? (m = m + 1, m == (n + 1)/2 ? (x = e(1), y = $25) : 0) : 0) nooutput
   }
   if (k > strong + quiet) {
      stats 'rivals.csv' skip 1 using (strcol(1) eq name ? (x = at_least(column(rival)), y = $4) : 0) nooutput
   }
   if (x > 0) {
      found = found + 1
      end_x[found] = larger(0, smaller(1, fraction(x, left, right)))
      end_y[found] = larger(0, smaller(1, fraction(y, bottom, top))) - (k <= strong ? 0.02 : 0)
      end_text[found] = name
      end_colour[found] = k <= strong ? colour(k) : k <= strong + quiet ? '#808080' : '#404040'
   }
}
ends = found

# Curves of all candidates: from each point to the next of the same one.
last_label = ''; last_x = 0; last_y = 0; from_x = 0; from_y = 0
from(k, x, y) = (same = label(1) eq last_label, from_x = last_x, from_y = last_y, last_label = label(1), last_x = x, last_y = y, \
   same ? from_x : NaN)
in_sight(k) = ok(1) && !is_strong(label(1))

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, picture, 820, 560)
   eval logarithmic
   set label 1 title('what accuracy costs') at graph 0, graph 1.05 font ',14' noenhanced
   if (strlen(scene) < 24) {
      set label 2 'band: our fastest for each accuracy; bars: to the worst state' at screen 0.985, graph 1.05 right \
         tc rgb '#606060' font ',10'
   }
   set xrange [left:right]; set yrange [bottom:top]; unset mxtics
   set xlabel sprintf('error in %s, at t = %g (median of %d states)', quantity, t_end, states)
   set ylabel 'time, ns per body and unit of simulated time'
   if (doubt > right) {
      set object 1 rect from doubt, graph 0 to graph 1, graph 1 fc rgb '#f2f0ea' fs solid noborder behind
      set label 3 "the reference's\nown error" at graph 0.995, graph 0.07 right tc rgb '#606060' font ',8'
   }
   gap = 0.032; letter = 0.0098
   if (ends > 0) { load 'ends.gp'; set rmargin 3 + 0.78*overhang }
   last_label = ''
   plot 'cost.csv' skip 1 using (ok(1) && column(on_front) > 0 ? e(1) : NaN):25 smooth unique with lines lw 11 lc rgb '#dbe4ee', \
      '' skip 1 using (in_sight(1) ? from(1, e(1), $25) : NaN):(from_y):(last_x - from_x):(last_y - from_y) \
         with vectors nohead lw few ? 0.9 : 0.6 lc rgb few ? '#9a9a9a' : '#c9c9c9', \
      '' skip 1 using (in_sight(1) && few ? e(1) : NaN):25 with points pt 7 ps 0.25 lc rgb '#9a9a9a', \
      for [k=1:rivals] rival_file skip 1 using (strcol(1) eq rival_name[k] ? at_least(column(rival)) : NaN):4 \
         with linespoints dt 2 pt 2 ps 0.5 lw 1.3 lc rgb '#555555', \
      for [k=1:strong] 'cost.csv' skip 1 \
         using (label(1) eq names[k] && ok(1) && column(on_front) > 0 ? e(1) : NaN):25:(e(1)):worst \
         with xerrorbars pt 0 lw 0.8 lc rgb colour(k), \
      for [k=1:strong] 'cost.csv' skip 1 using (label(1) eq names[k] && ok(1) ? e(1) : NaN):25 \
         with linespoints pt shape(k) ps 0.7 lw 1.8 lc rgb colour(k)
   unset output
}
