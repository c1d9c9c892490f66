#!/bin/sh
# Lint: fortitude (settings in fpm.toml), module name = path, the compiler's warnings as errors over src/ and app/ only.
# Warnings are no errors elsewhere: flags reach the dependencies too, and those are not ours.
#
# usage: tools/lint.sh
# environment: FC the compiler (gfortran)

set -u
cd "$(dirname "$0")/.." || exit 1
tools=build/tools/bin
FC=${FC:-gfortran}
bad=0

echo "lint: fortitude"
folders=
for it in src app test example tools bench; do [ -d $it ] && folders="$folders $it"; done
$tools/fortitude check --output-format concise $folders || bad=1

echo "lint: module name = path"
# src/room/file.f90 holds module poinsot_room_file, src/room.f90 poinsot_room, test/test_room.f90 test_room,
# test/instrument.f90 test_instrument.
for file in $(find src test -maxdepth 3 -name '*.f90' ! -path 'test/*/*' ! -name main.f90 | sort); do
   case $file in
   src/poinsot.f90) want=poinsot ;;
   src/*) want=poinsot_$(echo "${file#src/}" | sed 's/\.f90$//; s,/,_,g') ;;
   test/test_*) want=$(basename "$file" .f90) ;;
   *) want=test_$(basename "$file" .f90) ;;
   esac
   found=$(sed -n 's/^ *\(sub\)\{0,1\}module  *\(([^)]*) *\)\{0,1\}\([a-z][a-z0-9_]*\) *\(!.*\)\{0,1\}$/\3/p' "$file" | grep -vx procedure | tr '\n' ' ')
   if [ "$found" != "$want " ]; then
      echo "$file: holds '${found% }', its path says '$want'"
      bad=1
   fi
done

echo "lint: no IEEE state saved and restored at each call"
# A procedure with a `use` of an IEEE module of its own costs 200 ns a call; one `use` at the head of its module costs nothing. Asked
# of the library that `make build` left, and of the sources.
library=build/stage/lib/libpoinsot.a
if [ -f $library ]; then
   slow=$(nm $library 2>/dev/null | awk '/\.o:$/ { member = $1 } /ieee_procedure_entry/ && member !~ /(scene|study)/ { print member }' | sort -u)
   [ -z "$slow" ] || { echo "$library: $slow call ieee_procedure_entry"; bad=1; }
fi
for file in $(find src -name '*.f90' ! -path 'src/scene/*' ! -path 'src/study/*' | sort); do
   line=$(awk '/^contains/ { inside = 1 } inside && /^ *use.*:: *ieee_/ { print FNR; exit }' "$file")
   [ -z "$line" ] || { echo "$file:$line: use of an IEEE module within a procedure; have it at the head of the module"; bad=1; }
done

echo "lint: $FC, warnings as errors"
# Equality of reals stays allowed: a zero moment, a fixed point and a saturated series are exact questions. So do unused dummy
# arguments: kernels of one interface need not all of them. "Used uninitialized" is no error: gfortran 12 says it of the
# descriptors of allocatables that a function's result allocates.
warnings="-Werror -Wall -Wextra -Wtrampolines -Wno-compare-reals -Wno-unused-dummy-argument -Wno-error=maybe-uninitialized -Wno-error=uninitialized"
if $tools/fpm build --compiler "$FC" --link-flag "$(tools/flags.sh link)" --flag "-Og -fopenmp $warnings" >build/lint.log 2>&1; then
   grep -B 4 '^Warning' build/lint.log
else
   cat build/lint.log
   bad=1
fi

if [ $bad = 0 ]; then echo "lint: nothing to say"; else echo "lint: see above"; fi
exit $bad
