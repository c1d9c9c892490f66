#!/bin/sh
# Builds DL_POLY Classic twice, as it is and with poinsot, and compares them in runs of rigid water and carbon dioxide. The last
# line is "N passed, M failed"; exit code 77 where DL_POLY_SOURCE does not name its source folder or poinsot is not installed.
#
# usage: DL_POLY_SOURCE=.../source check.sh      the makefile is taken from ../build/MakeSEQ
# environment: FC, an MPI compiler, which the sources need even for one process (mpif90.mpich or mpif90); WORK a folder for builds and runs (a temporary one); STEPS per run (1200)
set -u
here=$(cd "$(dirname "$0")" && pwd)
FC=${FC:-$(command -v mpif90.mpich || command -v mpif90)} STEPS=${STEPS:-1200}
[ -f "${DL_POLY_SOURCE:-}/vv_rotation1_module.f" ] || { echo "skipped: set DL_POLY_SOURCE to the source folder of DL_POLY Classic"; exit 77; }
[ -n "$FC" ] || { echo "skipped: no MPI compiler (mpif90)"; exit 77; }
pkg-config --exists poinsot || { echo "skipped: poinsot not found by pkg-config"; exit 77; }
work=${WORK:-$(mktemp -d)}
mkdir -p "$work"
passed=0 failed=0
check() { # NAME TEXT: a test as $? of the command before
   if [ "$3" = 0 ]; then passed=$((passed + 1)); say=PASSED; else failed=$((failed + 1)); say=FAILED; fi
   echo "   ... $1 [$say]  $2"
}

# build NAME: a copy of the source in $work/NAME, its program $work/NAME/DLPOLY.X
build() {
   (cd "$work/$1" && make seq EX=DLPOLY.X BINROOT=. FC="$FC -c -O2 -std=legacy -fallow-argument-mismatch" LD="$FC -o" >log 2>&1; [ -f DLPOLY.X ]) ||
      { tail -5 "$work/$1/log"; echo "DL_POLY did not build in $work/$1"; exit 1; }
}
for name in stock exact; do
   [ ! -f "$work/$name/DLPOLY.X" ] || continue
   rm -rf "${work:?}/$name"
   cp -r "$DL_POLY_SOURCE" "$work/$name"
   cp "$DL_POLY_SOURCE/../build/MakeSEQ" "$work/$name/Makefile"
   if [ $name = exact ]; then "$here/use_poinsot.sh" "$work/exact" stages || exit 1; fi
   build $name
done

# control STEP STEPS [LINE...]: CONTROL
control() {
   printf '%s\n' "rigid molecules" "temperature 298" "ensemble nve" "integrator velocity" "timestep $1" "steps $2" \
      "cutoff 9.0" "delr 1.0" "rvdw 9.0" "shift damp 0.2" "print 100" "job time 100000" "close time 10" >CONTROL
   shift 2
   printf '%s\n' "$@" finish >>CONTROL
}
# run WHAT PROGRAM SPLITTING PER: $STEPS steps of 1 fs (water) or 4 fs (co2) a force from the common start; prints first energy, rms
# about its line and drift, per molecule in J/mol and per ps, of each PER-th step
run() {
   mkdir -p "$work/$1-$2-$3"
   cd "$work/$1-$2-$3" || exit 1
   rm -f ./*
   cp "$work/$1-start/FIELD" .
   cp "$work/$1-start/REVCON" CONFIG
   cp "$work/$1-start/REVIVE" REVOLD
   step=0.001
   [ "$1" = water ] || step=0.004
   control $step "$STEPS" "equilibration 0" "restart noscale" "stats $4" "stack 100"
   POINSOT_SPLITTING=$3 "$work/$2/DLPOLY.X" >log 2>&1 || { cat log; exit 1; }
   awk 'NR <= 2 { next }
      left <= 0 { time = $2; left = $3; first = 1; next }
      { if (first) { e = $1/216*1000; n++; if (n == 1) e0 = e; d = e - e0; s += d; ss += d*d; t += time; tt += time^2; td += time*d }
        first = 0; left -= NF }
      END { free = tt - t*t/n; drift = (td - t*s/n)/free; print e0, sqrt(ss/n - (s/n)^2 - drift^2*free/n + 1e-30), drift, n }' STATIS
}
# apart RUN RUN: by how much the energies of two runs differ at most in their first 0.2 ps, J/mol a molecule. Later chaos parts them, and
# fluctuations of runs as short as these then differ by some 10 per cent whatever turns the molecules.
energies() {
   awk 'NR <= 2 { next }
      left <= 0 { time = $2; left = $3; first = 1; next }
      { if (first) printf "%s %.10g\n", time, $1/216*1000; first = 0; left -= NF }' "$work/$1/STATIS"
}
apart() {
   energies "$1" >"$work/one"
   energies "$2" >"$work/other"
   paste "$work/one" "$work/other" | awk '$1 <= 0.2 { n++; d = $2 - $4; if (d < 0) d = -d; if (d > most) most = d } END { print (n > 5 ? most + 0 : "none") }'
}
for what in water co2; do
   [ ! -f "$work/$what-start/REVIVE" ] || continue
   mkdir -p "$work/$what-start"
   cd "$work/$what-start" || exit 1
   awk -v what=$what -f "$here/molecules.awk"
   control 0.001 2000 "equilibration 2000" "scale 10" "stats 100"
   "$work/stock/DLPOLY.X" >log 2>&1 || { cat log; exit 1; }
done
set -- $(run water stock 1 6)
stock=$2
echo "water, 1 fs, DL_POLY: energy $1, fluctuation $2 J/mol a molecule, drift $3 per ps"
set -- $(run water exact 1 6)
echo "water, 1 fs, poinsot: energy $1, fluctuation $2, drift $3"
off=$(apart water-stock-1 water-exact-1)
awk -v off="$off" -v b="$2" 'BEGIN { exit !(off ~ /^[0-9]/ && off < 0.02 && b > 0) }'
check same-verlet "velocity Verlet: energies $off J/mol apart in the first 0.2 ps; it fluctuates by $2 with poinsot, $stock without" $?
set -- $(run water exact 6 6)
echo "water, 1 fs a force, srkn4: energy $1, fluctuation $2, drift $3"
awk -v a="$stock" -v b="$2" 'BEGIN { exit !(b > 0 && 8*b < a) }'
check srkn4 "fluctuation of srkn4 $2, of velocity Verlet $stock, at equal forces" $?
set -- $(run co2 stock 1 6)
stock=$2
set -- $(run co2 exact 1 6)
off=$(apart co2-stock-1 co2-exact-1)
awk -v off="$off" -v b="$2" 'BEGIN { exit !(off ~ /^[0-9]/ && off < 0.02 && b > 0) }'
check linear "carbon dioxide, 4 fs: energies $off apart in the first 0.2 ps; $2 with poinsot, $stock without" $?
set -- $(run co2 exact 6 6)
awk -v a="$stock" -v b="$2" 'BEGIN { exit !(b > 0 && b < 1.5*a) }' # steps of 24 fs: it runs, and gains nothing
check linear-srkn4 "carbon dioxide, srkn4, 4 fs a force: $2" $?
[ -n "${WORK:-}" ] || rm -rf "$work"
printf '\n%d passed, %d failed\n' $passed $failed
[ $failed -eq 0 ]
