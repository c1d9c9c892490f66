#!/bin/sh
# Builds the app for several MPI processes, build/mpi/poinsot, over the library in build/stage.
#
# usage: make MPI=1
# environment: MPIFC the MPI compiler (mpifort), of the same Fortran compiler as the library's
set -eu
cd "$(dirname "$0")/.."
MPIFC=${MPIFC:-mpifort}
mkdir -p build/mpi
sources="app/terminal.f90 app/arguments.f90 app/codes.f90 app/find_scene.f90 app/progress.f90 app/help.f90 app/version.f90
   app/draw.f90 app/view.f90 app/run.f90 app/keys.f90 app/options.f90 app/cost.f90 app/choose.f90 app/reproduce.f90 app/measured.f90 app/lists.f90
   app/commands.f90 mpi/communicator.f90 mpi/main.f90"
# shellcheck disable=SC2086,SC2046
"$MPIFC" $(tools/flags.sh release) -ffree-line-length-none -J build/mpi -I build/stage/include $sources -o build/mpi/poinsot \
   build/stage/lib/libpoinsot.a $(tools/flags.sh link) -llapack -lblas >build/mpi/log 2>&1 || { cat build/mpi/log; exit 1; }
echo "built: build/mpi/poinsot"
