# The distribution of I_i w_i/sqrt(I_i kT) at the last output, w the angular velocity, beside the normal one.
# `gnuplot plot_momenta.gp`, in this folder, draws momenta.svg and momenta.png.
load 'motion.gp'
stats file skip 1 using 1 name 'T' nooutput
last = int(T_records) - bodies   # first row of the last frame
width = 0.25
bin(x) = width*(floor(x/width) + 0.5)
scaled(j) = moment(column(2), j) > 0 ? moving(column(2), j)/sqrt(moment(column(2), j)*kt) : NaN
array most[3]
do for [j=1:3] {
   most[j] = 0
   do for [g=1:groups] { most[j] = larger(most[j], moments[3*g - 3 + j]) }
}

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'momenta', 960, 360)
   unset key; set border 1; set tics nomirror out; unset ytics
   set xrange [-4.2:4.2]; set yrange [0:*]; set xtics 2; set offsets 0,0,graph 0.05,0
   set multiplot layout 1,3 margins 0.02,0.98,0.24,0.9 spacing 0.03,0
   do for [j=1:3] {
      set title sprintf('axis %d', j) offset 0,-0.6
      set xlabel sprintf('I_%d ω_%d / √(I_%d kT)', j, j, j)
      if (most[j] > 0) {
         plot file skip 1 every ::last using (bin(scaled(j))):(1.0/bodies/width) smooth frequency \
               with boxes fs solid 1 border lc rgb '#ffffff' fc rgb pale, \
            exp(-x*x/2)/sqrt(2*pi) with lines lc rgb dark lw 2
      } else {
         set yrange [0:1]
         set label 1 'no inertia' at 0,0.5 center; plot NaN; unset label 1
         set yrange [0:*]
      }
   }
   unset multiplot
   unset output
}
