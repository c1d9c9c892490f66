#!/bin/sh
# The shared library exports the functions of include/poinsot.h, the symbols of Fortran that tools/exports.sh names, and nothing
# else; a name of the public modules that is a procedure of the library is among them.
#
# usage: test/exports.sh LIBRARY.so [LIBRARY.a]
set -u
cd "$(dirname "$0")/.." || exit 1
library=${1:?library} archive=${2:-}
CC=${CC:-cc}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
bad=0

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

tools/exports.sh fortran | sed 's/\*/.*/; s/^/^/; s/$/$/' >"$scratch/patterns"
if grep '^__' "$scratch/all" | grep -v -f "$scratch/patterns"; then
   echo "   exported, though no public module needs them"
   bad=1
fi
# Of gfortran: each public procedure that the archive has.
if [ -n "$archive" ]; then
   nm --defined-only "$archive" 2>/dev/null | awk '$2 == "T" { print $3 }' | grep '^__' | grep -f "$scratch/patterns" | sort -u >"$scratch/has"
   if comm -23 "$scratch/has" "$scratch/all" | grep .; then
      echo "   needed by a public module, not exported"
      bad=1
   fi
fi
if ! tools/legacy_interface.sh | cmp -s - include/poinsot_legacy.f90; then
   echo "include/poinsot_legacy.f90 is not what tools/legacy_interface.sh makes of include/poinsot.h: run it"
   bad=1
fi
if nm -D --defined-only "$library" | grep -q 'MOD_poinsot_scene\|poinsot_study'; then
   echo "scene or study is in the library"
   bad=1
fi
echo "exported: $(wc -l <"$scratch/c") of C, $(grep -c '^__' "$scratch/all") of Fortran; text $(size "$library" | awk 'NR == 2 { print $1 }') bytes"
exit $bad
