#!/bin/sh
# The compiler, with the flags that tools/by_file.txt has for the file compiled. fpm, which knows flags for all files only, runs it by the
# compiler's own name: a link that tools/build.sh makes.
#
# usage: by_file.sh ARGUMENT...       environment: FC the compiler (gfortran)

optimised= file=
for it in "$@"; do
   case $it in
   -O3) optimised=1 ;;
   src/*.f90 | */src/*.f90) file=src/${it##*src/} ;;
   esac
done
# shellcheck disable=SC2046 # words
[ -z "$optimised" ] || [ -z "$file" ] || set -- "$@" $(sed -n "s|^$file  *||p" tools/by_file.txt)
exec "${FC:-gfortran}" "$@"
