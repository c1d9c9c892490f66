# Pictures of gains.sh: gnuplot in runs/
set terminal pngcairo noenhanced size 900,600 font "sans,11"
set key left top
set grid
set logscale xy
set xrange [500:20000]
set xlabel "CPU time for forces and all else, ms per ps"

set output "fluctuation.png"
set title "Water, 216 molecules, 298 K: fluctuation of the energy against cost"
set ylabel "rms fluctuation, J/mol per molecule"
set key right top
plot "water-own.dat" using ($7/$2):(10*$3) with linespoints pt 6 lw 2 title "own NO_SQUISH, Verlet", \
   "water-exact.dat" using ($7/$2):(10*$3) with linespoints pt 7 lw 1 title "poinsot exact, Verlet", \
   "water-own-srkn4.dat" using ($7/$2):(10*$3) with linespoints pt 4 lw 2 title "own NO_SQUISH, srkn4", \
   "water-exact-srkn4.dat" using ($7/$2):(10*$3) with linespoints pt 5 lw 2 title "poinsot exact, srkn4"

set output "drift.png"
set title "Water, 216 molecules, 298 K: drift of the energy against cost"
set ylabel "|drift| over 4 ps, J/mol per molecule and ps"
plot "water-own.dat" using ($7/$2):(10*abs($4)) with linespoints pt 6 lw 2 title "own NO_SQUISH, Verlet", \
   "water-exact.dat" using ($7/$2):(10*abs($4)) with linespoints pt 7 lw 1 title "poinsot exact, Verlet", \
   "water-own-srkn4.dat" using ($7/$2):(10*abs($4)) with linespoints pt 4 lw 2 title "own NO_SQUISH, srkn4", \
   "water-exact-srkn4.dat" using ($7/$2):(10*abs($4)) with linespoints pt 5 lw 2 title "poinsot exact, srkn4"

set output "co2.png"
set title "Carbon dioxide, 216 molecules, 300 K: fluctuation of the energy against cost"
set ylabel "rms fluctuation, J/mol per molecule"
plot "co2-own.dat" using ($7/$2):(10*$3) with linespoints pt 6 lw 2 title "own NO_SQUISH, Verlet", \
   "co2-exact.dat" using ($7/$2):(10*$3) with linespoints pt 7 lw 1 title "poinsot exact, Verlet", \
   "co2-exact-srkn4.dat" using ($7/$2):(10*$3) with linespoints pt 5 lw 2 title "poinsot exact, srkn4"

unset logscale
set xrange [*:*]
set output "time.png"
set title "Rotation, kicks and drift: CPU time per molecule and step"
unset xlabel
set ylabel "ns"
set yrange [0:*]
set key right top
set style fill solid 0.7
set boxwidth 0.7
set xtics rotate by -20
plot "time.dat" using 0:(1e3*$3):xtic(stringcolumn(1)." ".stringcolumn(2)) with boxes notitle, \
   "" using 0:(1e3*$3):(sprintf("%.1f %% of the step", $5)) with labels offset 0,0.8 notitle
set xtics norotate autofreq
set yrange [*:*]

set output "lammps.png"
set title "Water, 216 molecules, energy in time"
set xlabel "t, ps"
set ylabel "E - E(0), J/mol per molecule"
change(f) = sprintf("using 1:(10*($2 - %.11f)/216)", real(system("head -n 1 ".f.".energies | awk '{ print $2 }'")))
set key left bottom
curves = "'own.energies' ".change("own")." with lines lw 2 lc rgb '#c0392b' title 'own NO_SQUISH, 2 fs', ".\
   "'exact.energies' ".change("exact")." with lines lw 2 lc rgb '#2471a3' title 'poinsot exact, 2 fs', ".\
   "'srkn4.energies' ".change("srkn4")." with lines lw 2 lc rgb '#1e8449' title 'poinsot exact, srkn4, 8 fs (1.33 fs a force)'"
if (system("test -s lammps.energies && echo ok") eq "ok") {
   curves = curves.", 'lammps.energies' ".change("lammps")." with lines lw 1 dt 3 lc rgb '#000000' title 'LAMMPS rigid/nve, 2 fs'"
}
eval "plot ".curves
