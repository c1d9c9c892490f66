# Fasso's conclusion: the error over the triangle of all bodies, for each method.
# `gnuplot plot_fasso.gp`, in this folder, draws fasso.svg and fasso.png.
load 'fasso.gp'
load 'common.gp'
n = |methods|

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'fasso', 960, 600)
   set multiplot
   unset key; unset border; unset tics; set size ratio -1
   set lmargin 0; set rmargin 0; set tmargin 0; set bmargin 0
   set xrange [-0.06:1.06]; set yrange [-0.12:1.02]
   set cbrange [-9:-1]
   # one hue from pale to dark: grey paper and all eyes see the same order
   set palette defined (0 '#f7f4e8', 1 '#d9d3a4', 2 '#9fbf8f', 3 '#5aa08c', 4 '#2f7d86', 5 '#245778', 6 '#1f3358', 7 '#140f26')
   unset colorbox; set format cb '10^{%.0f}'; set cbtics -9,2,-1
   # points cover the triangle; what they cover beside it is covered in white
   set style fill solid noborder
   set object 1 polygon from -0.05,0 to 1.05,0 to 1.05,-0.03 to -0.05,-0.03 to -0.05,0 fc rgb 'white' front
   set object 2 polygon from 0,0 to 0.5,0.8660254 to 0.5,0.9 to -0.05,0.01 to -0.05,0 to 0,0 fc rgb 'white' front
   set object 3 polygon from 1,0 to 0.5,0.8660254 to 0.5,0.9 to 1.05,0.01 to 1.05,0 to 1,0 fc rgb 'white' front
   set object 4 polygon from 0,0 to 1,0 to 0.5,0.8660254 to 0,0 fs empty border rgb '#7d7d7d' front lw 1
   do for [m=1:n] {
      set origin 0.285*((m - 1)%3), (m <= 3 ? 0.5 : 0)
      set size 0.285,0.5
      unset label; unset arrow
      set label methods[m] at 0.5,1.0 center font ',13' front
      set label ranges[m] . ' for 9 bodies in 10' at 0.5,0.93 center font ',9' tc rgb '#505050' front
      set label 'all mass on axis 1' at -0.02,-0.06 left font ',8' tc rgb '#505050' front
      set label 'on axis 2' at 1.02,-0.06 right font ',8' tc rgb '#505050' front
      set label 'axis 3' at 0.56,0.86 left font ',8' tc rgb '#505050' front
      if (m == 1) {
         # moments in ratio 1 : 3/4 : 1/4: mass 0, 1/4, 3/4 along the axes
         set label "moments\n1, 3/4, 1/4" at 0.8,0.76 font ',9' tc rgb '#a03000' front
         set arrow 1 from 0.79,0.74 to 0.645,0.66 lc rgb '#a03000' lw 1.2 front
      }
      if (m == n) {
         set colorbox vertical user origin 0.905,0.15 size 0.02,0.7
         set cblabel 'error in attitude after 10 radians, h|omega| = 0.1'
      }
      plot 'fasso.csv' skip 1 using 1:2:(log10(column(5 + m))) with points pt 7 ps 45.0/side lc palette
   }
   unset multiplot
   unset output
}
