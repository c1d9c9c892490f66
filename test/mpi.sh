#!/bin/sh
# Tests of the app on several MPI processes: the files of a run are those of one process, to the bit. `make test-mpi`.
# Ends with "N passed, M failed".
#
# environment: MPIRUN how to start processes (what tools/mpi.sh found); ALONE and MANY the apps for one process and for several
set -u
cd "$(dirname "$0")/.." || exit 1
root=$PWD
work=$root/build/mpi/test
one=${ALONE:-$root/build/stage/bin/poinsot}
many=${MANY:-$root/build/mpi/poinsot}
MPIRUN=${MPIRUN:-$(cat build/mpi/starter)}
passed=0 failed=0
OMP_NUM_THREADS=1
OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 # of Open MPI: more ranks than cores
export OMP_NUM_THREADS OMPI_ALLOW_RUN_AS_ROOT OMPI_ALLOW_RUN_AS_ROOT_CONFIRM OMPI_MCA_rmaps_base_oversubscribe
rm -rf "$work"
mkdir -p "$work"
cd "$work" || exit 1

expect() {
   name=$1
   shift
   if "$@" >log 2>&1; then
      echo "       ... $name [PASSED]"
      passed=$((passed + 1))
   else
      echo "       ... $name [FAILED]"
      sed 's/^/  /' log | tail -n 20
      failed=$((failed + 1))
   fi
}
ranks() {
   n=$1
   shift
   $MPIRUN -n "$n" "$many" "$@" --quiet --no-pictures
}
alone() { "$one" "$@" --quiet --no-pictures; }

# 1333 bodies of two kinds (the last block is not full), thermostat (random numbers by body), a torque
cat >mixed.nml <<END
&scene
   t_end = 2, h = 0.1, seed = 7
/
&bodies
   count = 1000, moments = 0.5, 1.0, 1.4, random = 'uniform'
/
&bodies
   count = 333, moments = 1.0, 1.0, 0.0, random = 'thermal', temperature = 1.0
/
&langevin
   friction = 0.1, temperature = 1.0
/
&gravity
   centre = 0, 0, 1, weight = 1
/
&output
   every = 0.5, restart = 'end.restart'
/
END
cat >fails.nml <<END
&scene
   t_end = 2, h = 0.1, method = 'dmv6'
/
&bodies
   count = 100, moments = 0.5, 1.0, 1.4, y = 0.1, 0.2, 0.3
/
&bodies
   count = 3, moments = 0.5, 1.0, 1.4, y = 10, 20, 30
/
&output
   every = 0.5, restart = 'end.restart'
/
END

# Arrays and averages of all bodies, in the scene's own frame, with columns; and of bodies here and there.
cat >array.nml <<END
&scene
   t_end = 1, h = 0.1, seed = 3
/
&bodies
   count = 4500, tensor = 1.0, 0.1, 0, 0.1, 1.2, 0, 0, 0, 1.4, random = 'uniform', y = 1, 2, 3
/
&bodies
   count = 6001, moments = 1.0, 1.0, 0.0, random = 'thermal', temperature = 1.0
/
&gravity
   centre = 0, 0, 1, weight = 1
/
&output
   every = 0.5, format = 'npy', columns = 'omega1 tilt', observables = .true.
/
END
# Bodies that see each other.
cat >pairs.nml <<END
&scene
   t_end = 0.2, h = 0.1
/
&bodies
   count = 9, moments = 0.5, 1.0, 1.4, random = 'uniform', y = 1, 2, 3, lattice = 3, 3, 1, spacing = 1, 1, 0
/
&dipoles
   dipole = 0, 0, 1
/
&output
   every = 0.1, format = 'csv+npy', observables = .true.
/
END

# Several kinds of output, of some bodies in the scene's own frame.
cat >shown.nml <<END
&scene
   t_end = 1, h = 0.1
/
&bodies
   count = 200, tensor = 1.0, 0.1, 0, 0.1, 1.2, 0, 0, 0, 1.4, random = 'uniform', y = 1, 2, 3
/
&bodies
   count = 150, moments = 1.0, 1.0, 0.5, random = 'thermal', temperature = 1.0
/
&output
   every = 0.5, format = 'csv+extxyz', bodies = 1, 7, 200, 201, 350
/
END
same_bits() { ranks "$1" run mixed.nml --out "mixed-$1" && cmp mixed/trajectory.csv "mixed-$1/trajectory.csv" && cmp mixed/end.restart "mixed-$1/end.restart"; }
restart() {
   ranks 3 run mixed.nml --out half --set scene.t_end=1 && ranks 2 run mixed.nml --out rest --set scene.from=half/end.restart &&
      cmp mixed/end.restart rest/end.restart
}
array() {
   ranks "$1" run array.nml --out "array-$1" && cmp array/trajectory.npy "array-$1/trajectory.npy" &&
      cmp array/observables.csv "array-$1/observables.csv" && ls "array-$1" && ! ls "array-$1" | grep -q part
}
array_alone() { alone run array.nml --out array && [ "$(wc -c <array/trajectory.npy)" -eq $((128 + 3*10501*14*8)) ]; }
array_of_some() {
   set -- run array.nml --set "output.bodies=1,7,31,33,4499,4500,4501,5000,10501" --set output.format=csv+npy
   alone "$@" --out some && ranks 4 "$@" --out some-4 && cmp some/trajectory.npy some-4/trajectory.npy && cmp some/trajectory.csv some-4/trajectory.csv
}
pairs() {
   alone run pairs.nml --out pairs && ranks 3 run pairs.nml --out pairs-3 && cmp pairs/trajectory.csv pairs-3/trajectory.csv &&
      cmp pairs/trajectory.npy pairs-3/trajectory.npy && cmp pairs/observables.csv pairs-3/observables.csv
}
# All that does not tell the time is the same: also sums over the bodies of all ranks.
shown() {
   alone run shown.nml --out shown && ranks 4 run shown.nml --out shown-4 && cmp shown/trajectory.csv shown-4/trajectory.csv &&
      cmp shown/trajectory.xyz shown-4/trajectory.xyz &&
      for it in mixed shown; do
         grep -v 'wall time\|speed\|threads' $it/summary.txt >a && grep -v 'wall time\|speed\|threads' $it-4/summary.txt >b && diff a b || return 1
         diff "$it/view.html" "$it-4/view.html" || return 1
      done
}
# A restart file that was changed, within one rank's part of it or at its end.
damaged() {
   sed '900s/./F/20' mixed/end.restart >changed.restart
   head -n 1000 mixed/end.restart >short.restart
   for it in changed short; do
      "$one" run mixed.nml --out refused --quiet --set scene.t_end=3 --set scene.from=$it.restart 2>said
      [ $? -eq 2 ] || return 1
      ranks 3 run mixed.nml --out refused --set scene.t_end=3 --set scene.from=$it.restart 2>said-3
      [ $? -eq 2 ] && grep -F "$(cat said)" said-3 || return 1
   done
}
# Memory of each process: a quarter of the bodies each.
memory() {
   most() { tr ' ' '\n' <"$1" | grep '^[0-9][0-9]*$' | sort -n | tail -n 1; }
   set -- run "$root/scenes/free-body.nml" --quiet --no-pictures --set bodies.count=1000000 --set scene.t_end=0.02 \
      --set output.every=0.01 --set output.bodies=1
   /usr/bin/time -f %M -o one "$one" "$@" --out large && $MPIRUN -n 4 sh -c 'exec /usr/bin/time -f %M -o "many.$$" "$@"' sh "$many" "$@" --out large-4 &&
      cat many.* >many && echo "kB of one process $(most one), of each of four $(most many)" && cmp large/trajectory.csv large-4/trajectory.csv &&
      [ "$(most many)" -lt $(($(most one)*45/100)) ]
}
shipped() {
   alone run "$root/scenes/$1.nml" --out "$1" && ranks 3 run "$root/scenes/$1.nml" --out "$1-3" && cmp "$1/trajectory.csv" "$1-3/trajectory.csv"
}
# A choice by measured times is made once.
auto() {
   ranks 3 run mixed.nml --out auto --set scene.method=auto --set scene.splitting=auto --set scene.tol=1e-4 --set scene.t_end=1 &&
      [ "$(grep -c . auto/trajectory.csv)" -gt 2000 ] && ! grep -iq nan auto/trajectory.csv
}
# The same sentence and the same code; frames up to there.
failure() {
   alone run fails.nml --out fails 2>said
   [ $? -eq 3 ] || return 1
   ranks 4 run fails.nml --out fails-4 2>said-4
   [ $? -eq 3 ] && grep -F "$(cat said)" said-4 && [ "$(grep -c 'bodies failed' said-4)" -eq 1 ] && cmp fails/trajectory.csv fails-4/trajectory.csv
}
# A disk that is full, for a file of all ranks: a sentence, a code, the file not under its name; nobody waits for ever.
full() {
   # shellcheck disable=SC2016
   timeout 60 $MPIRUN -n 3 sh -c 'trap "" XFSZ; ulimit -f 131072; exec "$@"' sh "$many" run array.nml --out full --quiet --no-pictures \
      --set scene.t_end=100 --set output.every=0.5 2>said
   [ $? -eq 1 ] && grep 'trajectory.npy: cannot be written to its end' said && [ -f full/trajectory.npy.part ] && ! [ -f full/trajectory.npy ]
}
# What `auto` chose is not within tol: the first rank says so, once; the code is that of all ranks.
not_kept() {
   # shellcheck disable=SC2016
   $MPIRUN -n 3 sh -c '"$@"; echo code $?' sh "$many" run heavy-top --out kept --quiet --no-pictures --set scene.splitting=auto \
      --set scene.method=dmv2 --set scene.tol=1e-14 >said 2>&1
   cat said
   [ "$(grep -c 'code 4' said)" -eq 3 ] && [ "$(grep -c 'auto: the end is not within tol' said)" -eq 1 ]
}
no_folder() { ranks 3 run mixed.nml --out /dev/null/folder; [ $? -ne 0 ]; }
speaks_once() { [ "$($MPIRUN -n 3 "$many" methods | wc -l)" -eq "$("$one" methods | wc -l)" ]; }

expect "alone" alone run mixed.nml --out mixed
for n in 1 2 3 4; do expect "same-bits-$n" same_bits $n; done
expect "restart-3-to-2" restart
expect "restart-damaged" damaged
expect "what-is-shown" shown
expect "array-alone" array_alone
for n in 1 2 3 4; do expect "array-$n" array $n; done
expect "array-of-some" array_of_some
expect "pairs-arrays" pairs
expect "disk-full" full
if [ -x /usr/bin/time ]; then expect "memory" memory; fi
expect "one-body" shipped heavy-top
expect "coupled-bodies" shipped dipole-chain
expect "auto" auto
expect "auto-not-kept" not_kept
expect "failure" failure
expect "no-folder" no_folder
expect "speaks-once" speaks_once
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
