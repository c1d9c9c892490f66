#!/bin/sh
# The shared library exports the functions of include/poinsot.h, the names of Fortran that test/data/exported.txt lists, and
# nothing else, and it is no larger than it need be.
#
# usage: test/exports.sh LIBRARY.so
set -u
cd "$(dirname "$0")/.." || exit 1
library=${1:?library}
CC=${CC:-cc}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
bad=0
most=1050 # kB: 1000 with AVX-512, 1011 of x86-64-v3, 1045 of any x86-64

# What the compiler sees in the header, not what our own reader of it does.
"$CC" -aux-info "$scratch/prototypes" -fsyntax-only -x c include/poinsot.h 2>/dev/null &&
   sed -n 's/^.*include\/poinsot\.h:.*\*\/ extern [a-z0-9_ *]*\(poinsot_[a-z0-9_]*\) (.*/\1/p' "$scratch/prototypes" | sort -u >"$scratch/header"
[ -s "$scratch/header" ] || tools/exports.sh c >"$scratch/header" # another compiler than gcc
nm -D --defined-only "$library" | awk '{ print $3 }' | sed 's/@.*//' | sort >"$scratch/all"
grep -v '^_' "$scratch/all" >"$scratch/c"
if ! cmp -s "$scratch/header" "$scratch/c"; then
   comm -23 "$scratch/header" "$scratch/c" | sed 's/$/: in include\/poinsot.h, not exported/'
   comm -13 "$scratch/header" "$scratch/c" | sed 's/$/: exported, not in include\/poinsot.h/'
   bad=1
fi

# Of gfortran, every kind of symbol: procedures by name, and of types whatever the compiler makes for them. Not what our own
# tool says, which made the library: a list that was compared with the compiler's .mod files of the public modules.
awk '/^__/ {
   at = index($0, "_MOD_")
   module = substr($0, 3, at - 3)
   name = substr($0, at + 5)
   if (match(name, /^__[a-z_]+_poinsot/)) {
      name = substr(name, RLENGTH - 6)
      print module, "type", tolower(substr(name, length(module) + 2))
   } else print module, name
}' "$scratch/all" | sort -u >"$scratch/fortran"
sort -u test/data/exported.txt >"$scratch/listed"
if [ -s "$scratch/fortran" ] && ! cmp -s "$scratch/listed" "$scratch/fortran"; then
   comm -23 "$scratch/listed" "$scratch/fortran" | sed 's/$/: in test\/data\/exported.txt, not exported/'
   comm -13 "$scratch/listed" "$scratch/fortran" | sed 's/$/: exported, not in test\/data\/exported.txt (a new public name? enter it there)/'
   bad=1
fi
for name in $(grep -v '_f_$' "$scratch/header"); do
   grep -qiw "function $name\|subroutine $name" include/poinsot_interface.f90 || { echo "$name: in include/poinsot.h, not in include/poinsot_interface.f90"; bad=1; }
done
if ! tools/legacy_interface.sh | cmp -s - include/poinsot_legacy.f90; then
   echo "include/poinsot_legacy.f90 is not what tools/legacy_interface.sh makes of include/poinsot.h: run it"
   bad=1
fi
if nm -D --defined-only "$library" | grep -q 'MOD_poinsot_scene\|poinsot_study'; then
   echo "scene or study is in the library"
   bad=1
fi
text=$(size "$library" | awk 'NR == 2 { print $1 }')
if [ "$text" -gt $((most*1000)) ]; then
   echo "the library has $((text/1000)) kB of text, at most $most are meant: what runs once goes into tools/by_file.txt"
   bad=1
fi
echo "exported: $(wc -l <"$scratch/c") of C, $(grep -c '^__' "$scratch/all") of Fortran; text $text bytes"
exit $bad
