#!/bin/sh
# The code on the pages is taken as it stands, put into the programs of test/consumer/pages, which declare what it leaves to the reader,
# compiled against an installed library, and run. A line "@PAGE LANGUAGE K" of a program is the K-th block of that language on the page.
# Each block of README.md and docs/hosts.md is in some program. Ends with exit code 1 at the first that fails.
#
# usage: test/pages.sh FOLDER [PROGRAM...]     FOLDER for what is made; PROGRAM a name in test/consumer/pages without .in (all but scenes.py,
#                                              which takes a minute, and those in Python where it has no NumPy)
# environment: PKG_CONFIG_PATH where poinsot.pc is; FC, CC, CXX, PYTHON, PYTHONPATH
set -eu
cd "$(dirname "$0")/.."
pages=$PWD/test/consumer/pages FC=${FC:-gfortran} CC=${CC:-cc} CXX=${CXX:-c++} PYTHON=${PYTHON:-python3}
mkdir -p "$1"
out=$(cd "$1" && pwd)
shift
if [ $# = 0 ]; then
   for it in "$pages"/*.in; do
      case $it in
      */scenes.py.in) ;;
      *.py.in) ! "$PYTHON" -c "import numpy" 2>/dev/null || set -- "$@" "$(basename "$it" .in)" ;;
      *) set -- "$@" "$(basename "$it" .in)" ;;
      esac
   done
   for page in README.md docs/hosts.md; do
      sed -n 's/^```\([a-z].*\)/\1/p' "$page" | sort | uniq -c | while read -r count language; do
         for k in $(seq "$count"); do
            [ "$page $language $k" = "README.md fortran 1" ] || # test/installed.sh compiles this one, by README's own lines
               grep -qx "@$page $language $k" "$pages"/*.in || { echo "test/pages.sh: no program has $page $language $k"; exit 1; }
         done
      done
   done
fi

# compiled COMPILER SOURCE FLAG...: and run
compiled() {
   compiler=$1 source=$2 program=$out/$(echo "$2 $1" | tr -c 'a-z0-9\n' -)
   shift 2
   echo "$compiler $source $*"
   (cd "$out" && eval "$compiler $* $source -o $(basename "$program") $(pkg-config --cflags --libs poinsot) -lm" &&
      eval "LD_LIBRARY_PATH=$(pkg-config --variable=libdir poinsot)" "\$program")
}
for name; do
   awk '/^@/ {
         page = substr($1, 2); count = 0; inside = 0; taken = 0
         while ((getline line < page) > 0) {
            if (inside && line ~ /^```/) inside = 0
            else if (inside) { print line; taken++ }
            else if (line == "```" $2 && ++count == $3) inside = 1
         }
         close(page)
         if (!taken) { print "no such block: " $0 > "/dev/stderr"; exit 1 }
         next
      }
      { print }' "$pages/$name.in" >"$out/$name"
   case $name in
   *.f)
      compiled "$FC" "$name" -O0 -fcheck=all -ffpe-trap=invalid,zero,overflow
      compiled "$FC" "$name" -O2 -fdefault-integer-8 ;;
   *.f90) compiled "$FC" "$name" -Wall -fcheck=all -ffpe-trap=invalid,zero,overflow ;;
   *.c)
      compiled "$CC" "$name" -std=c99 -pedantic -Wall -Wextra -Werror
      ! command -v "$CXX" >/dev/null || compiled "$CXX" "$name" -x c++ -std=c++11 -Wall -Wextra -Werror ;;
   *.py)
      echo "$PYTHON $name"
      (cd "$out" && rm -rf "a run" && "$PYTHON" "$name") ;;
   esac
done
