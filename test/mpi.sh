#!/bin/sh
# Tests of the app on several MPI processes: the files of a run are those of one process, to the bit. `make test-mpi`.
# Ends with "N passed, M failed".
#
# environment: MPIRUN how to start processes (what tools/mpi.sh found)
set -u
cd "$(dirname "$0")/.." || exit 1
root=$PWD
work=$root/build/mpi/test
one=$root/build/stage/bin/poinsot
many=$root/build/mpi/poinsot
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

same_bits() { ranks "$1" run mixed.nml --out "mixed-$1" && cmp mixed/trajectory.csv "mixed-$1/trajectory.csv" && cmp mixed/end.restart "mixed-$1/end.restart"; }
restart() {
   ranks 3 run mixed.nml --out half --set scene.t_end=1 && ranks 2 run mixed.nml --out rest --set scene.from=half/end.restart &&
      cmp mixed/end.restart rest/end.restart
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
no_folder() { ranks 3 run mixed.nml --out /dev/null/folder; [ $? -ne 0 ]; }
speaks_once() { [ "$($MPIRUN -n 3 "$many" methods | wc -l)" -eq "$("$one" methods | wc -l)" ]; }

expect "alone" alone run mixed.nml --out mixed
for n in 1 2 3 4; do expect "same-bits-$n" same_bits $n; done
expect "restart-3-to-2" restart
expect "one-body" shipped heavy-top
expect "coupled-bodies" shipped dipole-chain
expect "auto" auto
expect "failure" failure
expect "no-folder" no_folder
expect "speaks-once" speaks_once
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
