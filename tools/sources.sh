#!/bin/sh
# The library's sources, each after what it uses: for builds without fpm.
#
# usage: tools/sources.sh [FILE...]      prints src/... (Fortran and C), then the files named, in order of compilation

set -u
cd "$(dirname "$0")/.." || exit 1
{
   for file in $(find src -name '*.f90') "$@"; do
      sed -n "s|^ *use *\(, *[a-z_]* *:: *\)\{0,1\}\([a-z][a-z0-9_]*\).*|u \2 $file|p
              s|^ *module  *\([a-z][a-z0-9_]*\) *\(!.*\)\{0,1\}\$|m \1 $file|p" "$file"
   done
   for file in $(find src -name '*.f90') "$@"; do echo "f $file"; done
} | awk '
   $1 == "m" && $2 != "procedure" { of[$2] = $3 }
   $1 == "u" { user[++n] = $3; used[n] = $2 }
   $1 == "f" { print $2, $2 }
   END { for (i = 1; i <= n; i++) if (used[i] in of && of[used[i]] != user[i]) print of[used[i]], user[i] }' | tsort
find src -name '*.c' | sort
