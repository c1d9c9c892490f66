# What should stay constant, against time: the change since the first output of each integral that the scene has, a strip for
# each. Energies are those of all bodies together; of the rest that body is drawn, at each output, which changed most.
# `gnuplot plot_drift.gp`, in this folder, draws drift.svg and drift.png.
load 'motion.gp'

# What a strip is about: `s`, a word of `kept`, says which. The value of a row; what is relative to what.
title(s) = s eq 'energy' ? 'the energy' : s eq 'work' ? 'the energy (not conserved with these effects)' : \
   s eq 'rotating' ? 'T + U - W.L in the turning frame' : s eq 'length' ? '|y|' : s eq 'momentum' ? 'Q y' : \
   s eq 'vertical' ? 'Q y along z' : s eq 'symmetry' ? 'y along the axis of symmetry' : \
   s eq 'kovalevskaya' ? "Kovalevskaya's integral" : '|q|'
whose(s) = bodies == 1 ? '' : summed(s) ? \
   sprintf(', %d bodies together', bodies) : sprintf(': of the %d bodies the one that changed most', bodies)
summed(s) = s eq 'energy' || s eq 'work' || s eq 'rotating'
L1(k) = X(column(7), column(8), column(9))
L2(k) = Y(column(7), column(8), column(9))
L3(k) = Z(column(7), column(8), column(9))
turning(k) = spin[1]*L1(k) + spin[2]*L2(k) + spin[3]*L3(k)
amount(s) = s eq 'length' ? length(column(7), column(8), column(9)) : s eq 'momentum' ? L1(1) : s eq 'vertical' ? L3(1) : \
   s eq 'symmetry' ? symmetry[1]*column(7) + symmetry[2]*column(8) + symmetry[3]*column(9) : \
   s eq 'kovalevskaya' ? kovalevskaya(column(2)) : s eq 'norm' ? sqrt(column(3)**2 + column(4)**2 + column(5)**2 + column(6)**2) : \
   s eq 'rotating' ? column(10) + column(11) - turning(1) : column(10) + column(11)
unit(s) = s eq 'energy' || s eq 'work' ? unit_t : s eq 'rotating' ? unit_r : s eq 'norm' ? 1 : \
   s eq 'kovalevskaya' ? unit_k : unit_y[place(1)]

# Kovalevskaya's: |(w1 + i w2)^2 - c (g1 + i g2)|^2, w the angular velocity, g upwards seen from the body, both along the two
# axes of equal moments; c = weight |centre|/I of the third, with the centre along the first of the two.
UP(j) = j == 1 ? 2*(column(4)*column(6) - column(3)*column(5)) : j == 2 ? 2*(column(5)*column(6) + column(3)*column(4)) : \
   1 - 2*(column(4)**2 + column(5)**2)
W(j,b) = column(6 + j)/moment(b, j)
along_1(v1,v2) = first[1]*v1 + first[2]*v2
along_2(v1,v2) = first[1]*v2 - first[2]*v1
kovalevskaya(b) = complex_k(along_1(W(equal[1],b), W(equal[2],b)), along_2(W(equal[1],b), W(equal[2],b)), \
   along_1(UP(equal[1]), UP(equal[2])), along_2(UP(equal[1]), UP(equal[2])))
complex_k(w1,w2,g1,g2) = (w1**2 - w2**2 - pull*g1)**2 + (2*w1*w2 - pull*g2)**2
size_k(b) = (W(equal[1],b)**2 + W(equal[2],b)**2 + abs(pull))**2

# The place of a row in its frame. Changes since the first frame, of the frame so far; a value at its last row.
place(k) = int(column(0))%bodies + 1
is_first(k) = column(0) < bodies
array start_1[bodies]
array start_2[bodies]
array start_3[bodies]
keep(s) = s eq 'momentum' ? (start_2[place(1)] = L2(1), start_3[place(1)] = L3(1)) : 0
change(s, x) = (is_first(1) ? (start_1[place(1)] = x, keep(s)) : 0, s eq 'momentum' ? \
   length(x - start_1[place(1)], L2(1) - start_2[place(1)], L3(1) - start_3[place(1)]) : x - start_1[place(1)])
gathered(s, d) = summed(s) ? (place(1) == 1 ? 0 : so_far) + d : place(1) == 1 || abs(d) > abs(so_far) ? d : so_far
drift(s) = so_far = gathered(s, change(s, amount(s))/unit(s))

# Largest |y| of each body, largest energies of a frame.
array unit_y[bodies]
do for [k=1:bodies] { unit_y[k] = 0 }
of_frame(x) = so_far = (place(1) == 1 ? 0 : so_far) + x
so_far = 0
stats file skip 1 using (unit_y[place(1)] = larger(unit_y[place(1)], length(column(7), column(8), column(9))), \
   of_frame(abs(column(10)) + abs(column(11)))) name 'E' nooutput
R_max = 0
if (strstrt(kept, 'rotating')) { stats file skip 1 using (of_frame(abs(turning(1)))) name 'R' nooutput }
unit_t = E_max > 0 ? E_max : 1
unit_r = E_max + R_max > 0 ? E_max + R_max : 1
do for [k=1:bodies] { unit_y[k] = unit_y[k] > 0 ? unit_y[k] : 1 }
if (strstrt(kept, 'kovalevskaya')) { stats file skip 1 using (size_k(column(2))) name 'K' nooutput; unit_k = K_max > 0 ? K_max : 1 }

# A block of data for each strip: t, and the change at the last row of each frame.
strips = words(kept)
array m[strips]
do for [i=1:strips] {
   s = word(kept, i)
   eval sprintf('set table $strip_%d separator comma', i)
   plot file skip 1 using 1:(drift(s)) with table if (place(1) == bodies)
   unset table
   eval sprintf("stats $strip_%d using 2 name 'D' nooutput", i)
   m[i] = larger(1e-17, larger(abs(D_min), abs(D_max)))
}

do for [kind in kinds] {
   if (!can_draw(kind)) { continue }
   eval begin(kind, 'drift', 720, 110*strips + 80)
   unset key; set border 3; set tics nomirror out
   set xrange [t_first : t_last]; set xtics tick(t_last - t_first, 7) format ''
   high = 110.0*strips + 80
   set multiplot layout strips,1 margins 0.14,0.96,65/high,1 - 35/high spacing 0,36/high
   do for [i=1:strips] {
      s = word(kept, i)
      set yrange [-1.15*m[i] : 1.15*m[i]]
      set ytics (sprintf('%.0e', m[i]) m[i], '0' 0, sprintf('%.0e', -m[i]) -m[i])
      set label 1 'change of ' . title(s) . whose(s) at graph 0.01, graph 1.1 noenhanced
      if (i == strips) { set xlabel 't'; set xtics format '%g' }
      eval sprintf('plot $strip_%d using 1:2 with lines lc rgb dark lw 1', i)
   }
   unset multiplot
   unset output
}
