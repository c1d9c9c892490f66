# Averages over all bodies: the kinetic energy about each axis and the cosine of the tilt against time; how the cosines are
# spread at the first and at the last output.
# `gnuplot plot_observables.gp`, in this folder, draws observables.svg and observables.png.
load 'trajectory.gp'
load 'common.gp'
file = 'observables.csv'
set datafile separator ','
stats file skip 1 using 1 name 'T' nooutput
t_first = T_min; t_last = T_max > T_min ? T_max : T_min + 1
stats file skip 1 using (larger(larger($2, $3), $4)) name 'K' nooutput
stats file skip 1 using (smaller(smaller($6, $8), 0)) name 'C' nooutput
bins = 10
array before[bins]
array after[bins]
do for [k=1:bins] {
   stats file skip 1 every ::0::0 using (before[k] = column(13+k)) nooutput
   stats file skip 1 every ::T_records-1 using (after[k] = column(13+k)) nooutput
}
array edges[bins+1]
middle(k) = -1 + (k - 0.5)*2/bins
along(j) = abs(axis[j]) > 0.9999999
axis_name = along(1) ? 'body axis 1' : along(2) ? 'body axis 2' : along(3) ? 'body axis 3' : \
   sprintf('body axis (%.3g, %.3g, %.3g)', axis[1], axis[2], axis[3])

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'observables', 960, 400)
   set border 3; set tics nomirror out; set tmargin at screen 0.86
   set multiplot layout 1,3 margins 0.07,0.985,0.3,0.88 spacing 0.065,0
   set key at graph 0.5, graph -0.24 center top horizontal reverse Left samplen 2.5
   set xlabel 't' offset 0,0.4; set xrange [t_first : t_last]; set xtics tick(t_last - t_first, 4)
   set title 'kinetic energy, mean of all bodies' offset 0,-0.4
   set yrange [0 : 1.06*larger(K_max, 1e-300)]
   plot file using 1:2 skip 1 title 'axis 1' with lines lc rgb dark lw 2, \
      file using 1:3 skip 1 title 'axis 2' with lines lc rgb '#d55e00' lw 2 dt 2, \
      file using 1:4 skip 1 title 'axis 3' with lines lc rgb '#2f8fce' lw 2 dt 4
   set title axis_name offset 0,-0.4
   set yrange [1.06*C_min : 1.06]; set ytics 0.25
   plot file using 1:6 skip 1 title '⟨cos⟩' with lines lc rgb dark lw 2, \
      file using 1:7 skip 1 title '⟨cos²⟩' with lines lc rgb '#d55e00' lw 2 dt 2, \
      file using 1:8 skip 1 title 'autocorrelation' with lines lc rgb '#2f8fce' lw 2 dt 4
   set title 'fraction of bodies' offset 0,-0.4
   set xlabel 'cosine of the tilt'; set xrange [-1:1]; set xtics 0.5; set yrange [0:*]; set ytics autofreq
   set boxwidth 2.0/bins
   plot sample [k=1:bins:1] '+' using (middle($1)):(after[int($1)]) title 'last output' with boxes fs solid 1 \
         border lc rgb '#ffffff' fc rgb pale, \
      [k=1:bins:1] '+' using (middle($1)):(before[int($1)]) title 'first' with points pt 5 ps 0.6 lc rgb dark
   unset multiplot
   unset output
}
