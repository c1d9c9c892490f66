#!/bin/sh
# The compiler, with the flags that tools/by_file.txt has for the file compiled. fpm, which knows flags for all files only, runs this by the
# compiler's own name: a link that tools/build.sh makes.
#
# usage: by_file.sh ARGUMENT...       environment: FC the compiler (gfortran)

optimised='' file=''
for it in "$@"; do
   case $it in
   -O3) optimised=1 ;;
   src/*.f90 | */src/*.f90) file=src/${it##*src/} ;;
   esac
done
if [ -n "$optimised" ] && [ -n "$file" ]; then
   kind=$(sed -n "s|^\([a-z]*\) $file\$|\1|p" tools/by_file.txt)
   # shellcheck disable=SC2046 # words
   [ -z "$kind" ] || set -- "$@" $(sed -n "s|^$kind = ||p" tools/by_file.txt)
fi
exec "${FC:-gfortran}" "$@"
