#!/bin/sh
# Put poinsot into a copy of DL_POLY Classic's sources: two files edited, one added, and the line that compiles it.
#
# usage: use_poinsot.sh SOURCE [stages]      SOURCE: the folder with vv_rotation1_module.f and a makefile in it (build/MakeSEQ or
#                                            MakePAR, copied there as Makefile, as DL_POLY's own instructions say)
#        with `stages` the nve routine takes kicks and drifts of a splitting: POINSOT_SPLITTING=6 in the environment of a run
# environment: PKG_CONFIG_PATH where poinsot.pc is, if it is not on the system's path
set -eu
here=$(cd "$(dirname "$0")" && pwd)
source=${1:?usage: use_poinsot.sh SOURCE [stages]}
stages=0
[ "${2:-}" != stages ] || stages=1
cd "$source"
for file in vv_rotation1_module.f vv_rotation2_module.f Makefile; do
   [ -f "$file" ] || { echo "use_poinsot.sh: no $file in $source"; exit 1; }
done
grep -q 'call nosquish(ig,' vv_rotation1_module.f || { echo "use_poinsot.sh: no call of nosquish: done already, or another version"; exit 1; }
pkg-config --exists --print-errors poinsot
for file in vv_rotation1_module.f vv_rotation2_module.f; do
   cp "$file" "$file.orig"
   awk -v stages=$stages -f "$here/edit.awk" "$file.orig" >"$file"
done
cp "$here/poinsot_turn.f" .
libs="$(pkg-config --libs poinsot) $(pkg-config --libs-only-L poinsot | sed 's/-L/-Wl,-rpath,/g')"
cp Makefile Makefile.orig
awk -v libs="$libs" '
   /^OBJ_SRC *=/ { $0 = $0 " poinsot_turn.o" }
   /^\t\$\(LD\) / { $0 = $0 " " libs }
   { print }' Makefile.orig >Makefile
echo "edited; originals end in .orig. Now: make ... as before"
