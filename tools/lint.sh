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

echo "lint: $FC, warnings as errors"
# Equality of reals stays allowed: a zero moment, a fixed point and a saturated series are exact questions. So do unused dummy
# arguments: kernels of one interface need not all of them. "May be used uninitialized" is shown, not refused: gfortran 12 says
# it of descriptors of allocatable components.
warnings="-Werror -Wall -Wextra -Wtrampolines -Wno-compare-reals -Wno-unused-dummy-argument -Wno-error=maybe-uninitialized"
if $tools/fpm build --compiler "$FC" --link-flag "$(tools/flags.sh link)" --flag "-Og -fopenmp $warnings" >build/lint.log 2>&1; then
   grep -B 4 '^Warning' build/lint.log
else
   cat build/lint.log
   bad=1
fi

if [ $bad = 0 ]; then echo "lint: nothing to say"; else echo "lint: see above"; fi
exit $bad
