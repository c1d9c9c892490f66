#!/bin/sh
# What poinsot's rotation gains in this program: runs, numbers and pictures, into runs/. About twenty minutes on one core; half of that is the thermostat.
#
# environment: PS  picoseconds per run (4)

set -eu
cd "$(dirname "$0")"
PS=${PS:-4}
mkdir -p runs
cd runs

# md KEY VALUE ...: one run
md() {
   while [ $# -gt 1 ]; do
      printf '%-12s%s\n' "$1" "$2"
      shift 2
   done | ../md
}
# family NAME ROTATION SUBSTEPS SPLITTING FORCES STEP...: step, fluctuation, drift, ... of one way to turn, a line per step (fs).
# FORCES is how many a step takes: the step is that many times longer.
family() {
   name=$1 rotation=$2 substeps=$3 splitting=$4 forces=$5
   shift 5
   : >"$name.dat"
   for per in "$@"; do
      h=$(awk "BEGIN { print $per*$forces*1e-3 }")
      md start "$liquid.cfg" cutoff "$cutoff" rotation "$rotation" substeps "$substeps" splitting "$splitting" step "$h" \
         steps "$(awk "BEGIN { printf \"%d\", $PS/$h + 0.5 }")" print 1000000 | sed -n "s/^result/$per/p" >>"$name.dat"
   done
   echo "$name"
   cat "$name.dat"
}

echo "equilibrating"
[ -f water.cfg ] || md water 216 equilibrate 4000 steps 0 finish water.cfg >/dev/null
[ -f co2.cfg ] || md water 0 co2 216 box 25.08 cutoff 12 temperature 300 equilibrate 3000 steps 0 finish co2.cfg >/dev/null
[ -f thousand.cfg ] || md water 1000 box 31.04 equilibrate 400 steps 0 finish thousand.cfg >/dev/null

# columns: fs per force, step (fs), rms fluctuation, drift per ps, temperature, forces per step, us per step, rotation, forces
liquid=water cutoff=9
family water-own own 1 1 1 1 2 3 4 5 6
family water-exact poinsot 1 1 1 1 2 3 4 5 6
family water-own-srkn4 own 1 6 6 0.5 1 1.333333 1.666667 2 2.5
family water-exact-srkn4 poinsot 1 6 6 0.5 1 1.333333 1.666667 2 2.5
# substeps of the own rotation under srkn4, the last line poinsot's: fluctuation
echo "srkn4, 1 fs a force, 0.9 ps: rotation, substeps, fluctuation"
for way in "own 1" "own 10" "poinsot 1"; do
   md start water.cfg rotation "${way% *}" substeps "${way#* }" splitting 6 step 0.006 steps 150 print 1000000 |
      awk -v w="$way" '/^result/ { print w, $3 }'
done | tee substeps.dat
liquid=co2 cutoff=12
family co2-own own 1 1 1 4 8 12 16
family co2-exact poinsot 1 1 1 4 8 12 16
family co2-exact-srkn4 poinsot 1 6 6 2.666667 4 5.333333

# a thermostat, noise in the middle of a step (baoab) and at its ends; both at equal cost
: >heat.dat
for noise in middle ends; do
   for per in 1 2 3 4 5; do
      h=$(awk "BEGIN { print $per*1e-3 }")
      md start water.cfg rotation poinsot friction 5 noise $noise step "$h" steps "$(awk "BEGIN { printf \"%d\", 5*$PS/$h + 0.5 }")" \
         print 1000000 | awk -v n=$noise -v per=$per '/^thermostat/ { gsub(",", ""); print n, per, $5, $11, $15 }' >>heat.dat
   done
done
echo "noise, step (fs), mean potential energy (10 J/mol a molecule), temperature at ends of steps, after noise in the middle"
cat heat.dat

# time in rotation: 216 and 1000 molecules, own once and ten times a step, poinsot
: >time.dat
for it in "water 216" "thousand 1000"; do
   for way in "own 1" "own 10" "poinsot 1"; do
      md start "${it% *}.cfg" rotation "${way% *}" substeps "${way#* }" step 0.002 steps 100 print 1000000 |
         awk -v n="${it#* }" -v w="$way" '/^result/ { print n, "\"" w "\"", $8/n, $9/n, 100*$8/$7 }' >>time.dat
   done
done
echo "molecules, rotation, us per molecule and step: rotation, forces; share of rotation (%)"
cat time.dat

# energies of one run each, for lammps_check.py and the picture
md start water.cfg step 0.002 steps 1000 sites water.sites | grep '^ ' | awk '{ print $2, $6 }' >own.energies
md start water.cfg step 0.002 steps 1000 rotation poinsot | grep '^ ' | awk '{ print $2, $6 }' >exact.energies
md start water.cfg step 0.008 steps 250 rotation poinsot splitting 6 | grep '^ ' | awk '{ print $2, $6 }' >srkn4.energies
${PYTHON:-python3} ../lammps_check.py water.sites 0.002 1000 lammps.energies || true

command -v gnuplot >/dev/null || { echo "no gnuplot: no pictures"; exit 0; }
gnuplot ../gains.gp
echo "pictures: runs/*.png"
