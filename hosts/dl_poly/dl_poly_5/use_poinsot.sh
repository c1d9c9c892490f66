#!/bin/sh
# Put poinsot into a copy of DL_POLY 5's sources: nve.F90 edited, two files added, and the list of files that CMake compiles.
#
# usage: use_poinsot.sh DL_POLY      the folder with source/nve.F90 in it
# environment: PKG_CONFIG_PATH where poinsot.pc is, if it is not on the system's path
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "${1:?usage: use_poinsot.sh DL_POLY}/source"
grep -q 'Call no_squish' nve.F90 || { echo "use_poinsot.sh: no call of no_squish in source/nve.F90: done already, or another version"; exit 1; }
pkg-config --exists --print-errors poinsot
legacy=$(pkg-config --variable=includedir poinsot)/poinsot_legacy.f90
[ -f "$legacy" ] || { echo "use_poinsot.sh: no $legacy"; exit 1; }
awk -f "$here/edit.awk" nve.F90 >nve.F90.new || { rm nve.F90.new; echo "use_poinsot.sh: nve.F90 is not as expected: another version"; exit 1; }
cp nve.F90 nve.F90.orig
mv nve.F90.new nve.F90
cp "$here/poinsot_rigid.F90" .
cp "$legacy" poinsot_legacy.f90
cp CMakeLists.txt CMakeLists.txt.orig
awk '{ print } /^set\(dlpoly_SRCS/ { print "  poinsot_legacy.f90\n  poinsot_rigid.F90" }' CMakeLists.txt.orig >CMakeLists.txt
echo "edited; originals end in .orig. Now CMake as before, with"
echo "   -DCMAKE_Fortran_STANDARD_LIBRARIES=\"$(pkg-config --libs poinsot) $(pkg-config --libs-only-L poinsot | sed 's/-L/-Wl,-rpath,/g')\""
