#!/bin/sh
# Builds DL_POLY 5 as it is, then with poinsot in nve.F90, and compares them in runs of rigid water and carbon dioxide. The last line is
# "N passed, M failed"; exit code 77 where DL_POLY_5 does not name its folder, or CMake, an MPI compiler or poinsot are missing.
#
# usage: DL_POLY_5=.../dl-poly check.sh        a copy is edited, not it
# environment: FC, an MPI compiler of gfortran (mpif90.mpich or mpif90); WORK a folder for builds and runs (a temporary one); STEPS per run
# (1000); JOBS of make (2)
set -u
here=$(cd "$(dirname "$0")" && pwd)
FC=${FC:-$(command -v mpif90.mpich || command -v mpif90)} STEPS=${STEPS:-1000} JOBS=${JOBS:-2}
[ -f "${DL_POLY_5:-}/source/nve.F90" ] || { echo "skipped: set DL_POLY_5 to the folder of DL_POLY 5"; exit 77; }
[ -n "$FC" ] || { echo "skipped: no MPI compiler (mpif90)"; exit 77; }
command -v cmake >/dev/null || { echo "skipped: no cmake"; exit 77; }
pkg-config --exists poinsot || { echo "skipped: poinsot not found by pkg-config"; exit 77; }
mpirun=$(command -v mpirun.mpich || command -v mpirun || true)
work=${WORK:-$(mktemp -d)}
mkdir -p "$work"
passed=0 failed=0
check() { # NAME TEXT RESULT: a test as $? of the command before
   if [ "$3" = 0 ]; then passed=$((passed + 1)); say=PASSED; else failed=$((failed + 1)); say=FAILED; fi
   echo "   ... $1 [$say]  $2"
}

# build NAME [OPTION...]: the program of the sources in $work/source, as $work/NAME.Z
build() {
   name=$1
   shift
   cmake -S "$work/source" -B "$work/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_Fortran_COMPILER=gfortran -DMPI_Fortran_COMPILER="$FC" \
      -DCMAKE_Fortran_FLAGS=-fallow-argument-mismatch "$@" >"$work/$name.log" 2>&1 &&
      cmake --build "$work/build" -j "$JOBS" >>"$work/$name.log" 2>&1 &&
      cp "$(find "$work/build" -name DLPOLY.Z -type f | head -n 1)" "$work/$name.Z" ||
      { tail -n 5 "$work/$name.log"; echo "DL_POLY 5 did not build: $work/$name.log"; exit 1; }
}
[ -d "$work/source" ] || cp -r "$DL_POLY_5" "$work/source"
[ -f "$work/stock.Z" ] || build stock
if [ ! -f "$work/exact.Z" ]; then
   "$here/use_poinsot.sh" "$work/source" || exit 1
   build exact "-DCMAKE_Fortran_STANDARD_LIBRARIES=$(pkg-config --libs poinsot) $(pkg-config --libs-only-L poinsot | sed 's/-L/-Wl,-rpath,/g')"
fi

# control STEP STEPS [LINE...]: CONTROL
control() {
   printf '%s\n' "title rigid molecules" "temperature 298 K" "ensemble nve" "timestep $1 ps" "time_run $2 steps" "cutoff 9.0 ang" "padding 0.2 ang" \
      "vdw_cutoff 9.0 ang" "vdw_force_shift ON" "coul_method force_shifted" "coul_damping 0.2 1/ang" "print_frequency 100 steps" >CONTROL
   shift 2
   printf '%s\n' "$@" >>CONTROL
}
# run WHAT PROGRAM STEP RANKS: $STEPS steps from the common start; prints the first energy, rms about its line and drift, per molecule in
# J/mol and per ps, and of how many lines
run() {
   mkdir -p "$work/$1-$2-$3-$4"
   cd "$work/$1-$2-$3-$4" || exit 1
   rm -f ./*
   cp "$work/$1-start/FIELD" .
   cp "$work/$1-start/REVCON" CONFIG
   cp "$work/$1-start/REVIVE" REVOLD
   control "$3" "$STEPS" "restart noscale" "stats_frequency 5 steps" "time_equilibration 0 steps"
   if [ "$4" = 1 ]; then "$work/$2.Z" >log 2>&1; else "$mpirun" -n "$4" "$work/$2.Z" >log 2>&1; fi || { tail -n 20 log OUTPUT; exit 1; }
   awk 'NR <= 2 { next }
      left <= 0 { time = $2; left = $3; first = 1; next }
      { if (first) { e = $1/216*1000; n++; if (n == 1) e0 = e; d = e - e0; s += d; ss += d*d; t += time; tt += time^2; td += time*d }
        first = 0; left -= NF }
      END { free = tt - t*t/n; drift = (td - t*s/n)/free; print e0, sqrt(ss/n - (s/n)^2 - drift^2*free/n + 1e-30), drift, n }' STATIS
}
for what in water co2; do
   [ ! -f "$work/$what-start/REVIVE" ] || continue
   mkdir -p "$work/$what-start"
   cd "$work/$what-start" || exit 1
   awk -v what=$what -f "$here/../molecules.awk"
   sed 's/ snm\(.*\) 9\.0$/ nm \1/' FIELD >FIELD.new && mv FIELD.new FIELD # here CONTROL says that pair forces are shifted
   control 0.001 2000 "time_equilibration 2000 steps" "rescale_frequency 10 steps" "stats_frequency 100 steps"
   "$work/stock.Z" >log 2>&1 || { tail -n 20 log OUTPUT; exit 1; }
done
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
# compare NAME WHAT STEP: stock and exact go the same way from the same start
compare() {
   set -- "$1" "$2" "$3" $(run "$2" stock "$3" 1) $(run "$2" exact "$3" 1)
   off=$(apart "$2-stock-$3-1" "$2-exact-$3-1")
   [ $# = 11 ] && awk -v off="$off" -v a="$4" -v b="$8" -v d="$9" -v n="${11}" 'BEGIN { exit !(off ~ /^[0-9]/ && off < 0.02 && n > 100 && (a - b)^2 < 1e-10*a^2 && d > 0) }'
   check "$1" "$2, steps of $3 ps: energy $4 and, with poinsot, $8 J/mol a molecule, $off apart in the first 0.2 ps; fluctuation $5 and $9, drift $6 and ${10} a ps" $?
}
compare water water 0.001
compare water-long-steps water 0.004
compare linear co2 0.004
if [ -n "$mpirun" ]; then
   one=$(run water exact 0.001 1) two=$(run water exact 0.001 2)
   [ "${one%% *}" = "${two%% *}" ]
   check two-ranks "1 and 2 processes: energies ${one%% *} and ${two%% *}, fluctuations $(echo "$one" | cut -d ' ' -f 2) and $(echo "$two" | cut -d ' ' -f 2)" $?
fi

cd "$work" || exit 1
"$FC" -O2 -I"$(dirname "$(find build/ -name rigid_bodies.mod | head -n 1)")" "$here/time_rotation.F90" "$(find build/ -name libdlpoly.a)" \
   $(pkg-config --libs poinsot) $(pkg-config --libs-only-L poinsot | sed 's/-L/-Wl,-rpath,/g') -o time_rotation >time.log 2>&1 || { cat time.log; exit 1; }
set -- $(./time_rotation)
awk -v own="$1" -v ours="$2" -v apart="$3" 'BEGIN { exit !(ours > 0 && 3*ours < own && apart < 1e-3) }'
check time "256 bodies: ns a body and step: no_squish $1, poinsot $2; attitudes $3 apart" $?
[ -n "${WORK:-}" ] || rm -rf "$work"
printf '\n%d passed, %d failed\n' $passed $failed
[ $failed -eq 0 ]
