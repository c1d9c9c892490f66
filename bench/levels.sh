#!/bin/sh
# The kernels built for each level of processor and run on this one: ns a body-step.
#
# usage: bench/levels.sh     environment: FC (gfortran); needs nothing built, leaves objects in build/bench/levels; ten seconds a level

set -u
cd "$(dirname "$0")/.." || exit 1
FC=${FC:-gfortran}
export FC
out=build/bench/levels
rm -rf $out # objects of other sources
mkdir -p $out
here=$(ld.so --help 2>/dev/null || /lib64/ld-linux-x86-64.so.2 --help 2>/dev/null)
files=$(tools/sources.sh | grep '^src/\(core\|rotation\|elliptic\|body\|free\)/.*f90$')

# table LEVEL: "name;ns" for each kernel
table() {
   folder=$out/$1
   mkdir -p "$folder"
   flags=$(TARGET=$1 tools/flags.sh release)
   for file in $files bench/kernels.f90 bench/levels.f90; do
      object=$folder/$(echo "$file" | tr / _).o
      "$FC" $flags -J "$folder" -I "$folder" -c "$file" -o "$object" || return 1
   done
   "$FC" $flags "$folder"/*.o $(tools/flags.sh link) -llapack -lblas -o "$folder/kernels" &&
      "$folder/kernels" | awk '
         match($0, /\|[^|]*$/) {
            split(substr($0, RSTART + 1), number, " ")
            if (number[1] + 0 > 0) { name = substr($0, 1, RSTART - 1); sub(/^ */, "", name); print name ";" number[1] } }' >"$folder.txt"
}

levels=x86-64
for level in x86-64-v3 x86-64-v4; do
   if echo "$here" | grep -q "$level (supported"; then levels="$levels $level"; fi
done
lists=
for level in $levels native; do
   table $level || exit 1
   lists="$lists $out/$level.txt"
done
echo "9. kernels by level of processor, each built for it and run here: ns a body-step, minimum"
echo
awk -F';' -v levels="$levels native" '
   FNR == 1 { number++ }
   { if (number == 1) name[++rows] = $1; ns[number, FNR] = $2 }
   END {
      n = split(levels, level, " ")
      printf "%42s", ""; for (k = 1; k <= n; k++) printf "%12s", level[k]; print ""
      for (i = 1; i <= rows; i++) { printf "%42s", name[i]; for (k = 1; k <= n; k++) printf "%12.2f", ns[k, i]; print "" }
   }' $lists
