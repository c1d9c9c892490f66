#!/bin/sh
# Builds the app for several MPI processes, build/mpi/poinsot, over the library in build/stage, by the first pair of an MPI compiler
# and a starter of processes that work together; tried, because a compiler without its development files, or the starter of
# another MPI, fails in the middle. The starter is left in build/mpi/starter, for test/mpi.sh.
#
# usage: make MPI=1
# environment: MPIFC the MPI compiler (mpifort, mpifort.mpich, mpifort.openmpi), of the same Fortran compiler as the library's;
#   MPIRUN the starter (mpirun, mpiexec, mpirun.mpich, mpirun.openmpi)
set -eu
cd "$(dirname "$0")/.."
BUILD=${BUILD:-build}
out=$BUILD/mpi
mkdir -p "$out"
OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 # of Open MPI
export OMPI_ALLOW_RUN_AS_ROOT OMPI_ALLOW_RUN_AS_ROOT_CONFIRM OMPI_MCA_rmaps_base_oversubscribe
have() { command -v "$1" >/dev/null 2>&1; }

cat >"$out/try.f90" <<'END'
use mpi_f08
integer :: rank, ranks
call mpi_init()
call mpi_comm_rank(mpi_comm_world, rank)
call mpi_comm_size(mpi_comm_world, ranks)
if (rank == 0) print '(a, i0)', "ranks ", ranks
call mpi_finalize()
end
END
: >"$out/log"
found=
for MPIFC in ${MPIFC:-mpifort mpifort.mpich mpifort.openmpi}; do
   have "$MPIFC" || continue
   echo "--- $MPIFC" >>"$out/log"
   "$MPIFC" "$out/try.f90" -o "$out/try" >>"$out/log" 2>&1 || continue
   for starter in ${MPIRUN:-mpirun mpiexec mpirun.mpich mpirun.openmpi}; do
      have "$starter" || continue
      echo "--- $starter" >>"$out/log"
      if "$starter" -n 2 "$out/try" 2>>"$out/log" | tee -a "$out/log" | grep -qx 'ranks 2'; then found=$starter; break 2; fi
   done
done
if [ -z "$found" ]; then
   echo "mpi: no pair of an MPI compiler (module mpi_f08) and a starter of processes works here; name them with MPIFC= and MPIRUN=;" >&2
   echo "     what was tried: $out/log" >&2
   exit 1
fi
echo "mpi: $MPIFC and $found"
echo "$found" >"$out/starter"

cc=$(tools/flags.sh c)
# shellcheck disable=SC2086
"${CC:-cc}" $cc -c app/processor.c -o "$out/processor.o"
# In the order in which they use each other: the library's own are in build/stage.
sources=$(tools/sources.sh app/*.f90 mpi/*.f90 | grep '^\(app\|mpi\)/' | grep -v '^app/main\.f90$')
# shellcheck disable=SC2086,SC2046
"$MPIFC" $(tools/flags.sh release) -ffree-line-length-none -J "$out" -I "$BUILD/stage/include" $sources "$out/processor.o" \
   -o "$out/poinsot" "$BUILD/stage/lib/libpoinsot.a" $(tools/flags.sh link) -llapack -lblas >>"$out/log" 2>&1 ||
   { tail -n 40 "$out/log" >&2; exit 1; }
echo "built: $out/poinsot"
