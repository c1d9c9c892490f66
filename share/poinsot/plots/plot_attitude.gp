# Where each body axis points in space, a sphere for each: the review's figure 1.
# `gnuplot plot_attitude.gp`, in this folder, draws attitude.svg and attitude.png.
load 'motion.gp'

# The momentum in space does not turn: a pin in the sphere where its upper end is. Of a momentum that points down that is -Qy.
stats file skip 1 every ::body::body using (b = $2, lx = X($7,$8,$9), ly = Y($7,$8,$9), lz = Z($7,$8,$9), 1) nooutput
up = lz < 0 ? -1 : 1
largest = larger(larger(abs(lx), abs(ly)), abs(lz))
unit = largest > 0 ? largest*length(lx/largest, ly/largest, lz/largest) : 1
lx = up*lx/unit; ly = up*ly/unit; lz = up*lz/unit

# Seen from the side: two of the three axes run around the momentum.
az = (largest > 0 && lz < 0.99 ? atan2(ly, lx) : 10*pi/180) + 55*pi/180
el = 16*pi/180
along_axis(what, j) = sprintf('%s(%d,%d,%d)', what, j == 1, j == 2, j == 3)
do for [j=1:3] { eval arcs(sprintf('path_%d', j), body, along_axis('X', j), along_axis('Y', j), along_axis('Z', j)) }
inside(x) = larger(-1.02, smaller(1.02, x))

begins = "file skip 1 every ::body::body using (%s(X(j==1,j==2,j==3),Y(j==1,j==2,j==3),Z(j==1,j==2,j==3))):" . \
   "(py(X(j==1,j==2,j==3),Y(j==1,j==2,j==3),Z(j==1,j==2,j==3))) with points "
curves(j) = 'plot ' . wires_far . ', ' . wires_near . ', ' . outline . ', ' . \
   sprintf("$path_%d using (far($1,$2,$3)):(py($1,$2,$3)) with lines lc rgb pale lw 1.2, ", j) . \
   sprintf("$path_%d using (near($1,$2,$3)):(py($1,$2,$3)) with lines lc rgb dark lw 1.8, ", j) . \
   sprintf(begins, 'far') . 'pt 6 ps 1 lw 1.4 lc rgb dark, ' . \
   sprintf(begins, 'near') . "pt 7 ps 1.4 lc rgb '#ffffff', " . sprintf(begins, 'near') . 'pt 7 ps 1 lc rgb dark'

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'attitude', 960, 370)
   eval sphere
   set xrange [-1.15:1.15]; set yrange [-1.4:1.45]
   if (largest > 0 && strstrt(kept, 'momentum')) {
      set arrow 1 from px(lx,ly,lz),py(lx,ly,lz) to 1.2*px(lx,ly,lz),1.2*py(lx,ly,lz) nohead lw 2 lc rgb '#555555' front
      set label 1 (up > 0 ? 'Qy' : '-Qy') at inside(1.36*px(lx,ly,lz)),1.36*py(lx,ly,lz) center tc rgb '#555555' front
   }
   if (bodies > 1) { set label 3 sprintf('body %d', b) at -1.12,1.3 tc rgb '#555555' }
   set multiplot layout 1,3 margins 0.005,0.995,0.005,0.995 spacing 0.01,0
   do for [j=1:3] {
      title = turned[group(b)] ? sprintf('body axis %d', j) : sprintf('body axis %d,  I_%d = %g', j, j, moment(b, j))
      set label 2 title at 0,-1.25 center
      eval curves(j)
   }
   unset multiplot
   unset output
}
