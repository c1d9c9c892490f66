# The mean of w_i^2 I_i over the bodies, w their angular velocity, for each axis, against time.
# `gnuplot plot_temperature.gp`, in this folder, draws temperature.svg and temperature.png.
load 'motion.gp'
heat(j) = moment(column(2), j) > 0 ? moving(column(2), j)**2/moment(column(2), j)/kt : NaN
set table $heat
plot for [j=1:3] file skip 1 using 1:(heat(j)) smooth unique
unset table
set datafile separator whitespace
stats $heat using 2 name 'H' nooutput

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'temperature', 720, 420)
   set datafile separator whitespace
   set key bottom right reverse Left; set border 3; set tics nomirror out; set rmargin 3
   set xlabel 't'; set ylabel 'temperature of each axis / target'
   set autoscale xfix; set yrange [0 : 1.05*larger(H_max, 1.2)]
   set arrow 1 from graph 0, first 1 to graph 1, first 1 nohead lc rgb '#b0b0b0' dt 2
   plot $heat index 0 using 1:2 title 'axis 1' with lines lc rgb dark lw 2, \
      $heat index 1 using 1:2 title 'axis 2' with lines lc rgb '#d55e00' lw 2 dt 2, \
      $heat index 2 using 1:2 title 'axis 3' with lines lc rgb '#2f8fce' lw 2 dt 4
   unset output
}
