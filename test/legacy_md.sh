#!/bin/sh
# Builds example/legacy_md against the installed library that pkg-config finds, in the folder given, and compares its two rotations:
# energies that agree at a small step, the closer the smaller it is, water and a linear molecule in one box.
#
# usage: test/legacy_md.sh FOLDER
set -eu
cd "$(dirname "$0")/.."
mkdir -p "$1"
cp example/legacy_md/*.f example/legacy_md/common.inc example/legacy_md/Makefile "$1"
cd "$1"
make FC="${FC:-gfortran}" PKG_CONFIG_PATH="${PKG_CONFIG_PATH:-}"

# run ROTATION SPLITTING STEP STEPS: energies of the last step, and the line of results
run() {
   printf '%-12s%s\n' water 32 co2 32 box 15 cutoff 7 start start.cfg rotation "$1" splitting "$2" step "$3" steps "$4" print "$4" |
      ./md | tail -n 4 | sed -n '1p;$p' | tr '\n' ' '
}
printf '%-12s%s\n' water 32 co2 32 box 15 cutoff 7 equilibrate 300 steps 0 finish start.cfg | ./md >log
{
   run own 1 .0004 50
   run poinsot 1 .0004 50
   run own 1 .0002 100
   run poinsot 1 .0002 100
   run poinsot 6 .0012 17
   echo
} | tee energies | awk '
   function size(x) { return x < 0 ? -x : x }
   { # of each run: step, time, kinetic energies, potential, total, "result", step, rms fluctuation, ...
      for (i = 0; i < 5; i++) { rotation[i] = $(4 + 15*i); total[i] = $(6 + 15*i); fluctuation[i] = $(9 + 15*i) }
      coarse = size(rotation[0] - rotation[1]); fine = size(rotation[2] - rotation[3])
      print "kinetic energy of rotation", rotation[3], "differs by", coarse, "at 0.4 fs and by", fine, "at 0.2 fs"
      print "fluctuation of srkn4 and of velocity Verlet at 1.2 and 0.2 fs:", fluctuation[4], fluctuation[3]
      if (!(fine > 0 && fine < 1e-4*rotation[3])) { print "the rotations do not agree"; exit 1 }
      if (!(coarse > 3*fine && coarse < 5*fine)) { print "the difference is not of second order"; exit 1 }
      if (!(fluctuation[4] < 0.5*fluctuation[3])) { print "srkn4 does not gain"; exit 1 }
   }'

# A thermostat in the middle of the step: its temperature right after the noise, less at the ends of steps.
printf '%-12s%s\n' water 32 co2 32 box 15 cutoff 7 start start.cfg rotation poinsot friction 20 noise middle step .002 steps 500 print 500 |
   ./md | grep '^thermostat' | tee heat
awk '{ gsub(",", ""); ends = $11; after = $15 }
   END { if (!(after > 0.92*298 && after < 1.08*298)) { print "the thermostat keeps", after, "K, not 298"; exit 1 }
      if (!(ends < after)) { print "momenta are not cold at the ends of steps"; exit 1 } }' heat
