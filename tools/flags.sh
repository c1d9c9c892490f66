#!/bin/sh
# Compiler flags, as far as the compiler accepts them.
#
# usage: tools/flags.sh release | checking | c | link
# environment: FC the compiler (gfortran), PORTABLE=1 or TARGET=portable for any processor of this kind, TARGET=x86-64-v3 or another
#    name that -march= knows instead of this one, EXTRA_FLAGS added at the end

set -u
FC=${FC:-gfortran}
scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
printf 'end\n' >"$scratch/try.f90"

# Print those of the flags that the compiler takes without complaint.
accepted() {
   for flag in "$@"; do
      if (cd "$scratch" && "$FC" -Werror "$flag" -c try.f90 -o try.o >/dev/null 2>&1); then printf '%s ' "$flag"; fi
   done
}

case ${1:-} in
release)
   # No -ffast-math: it deletes compensated sums and tests for NaN. Position-independent code, because the same objects make the
   # shared library; without interposition the compiler may still inline; what nobody calls, the linker leaves out of it by
   # sections.
   native=-march=${TARGET:-native}
   { [ "${PORTABLE:-0}" = 1 ] || [ "${TARGET:-}" = portable ]; } && native=
   printf '%s ' -O3
   accepted $native -mprefer-vector-width=512 -fopenmp -fPIC -fno-semantic-interposition -ffunction-sections -fdata-sections
   ;;
checking)
   printf '%s ' -Og -g
   accepted -fcheck=all,no-array-temps -Wall -Wextra -ffpe-trap=invalid,zero,overflow -fbacktrace -fopenmp
   ;;
c)
   # For src/api/*.c, which look at the processor before anything else: never -march.
   printf '%s ' -O2 -fPIC
   ;;
link)
   # Where conda and brew keep libraries that the compiler does not find by itself.
   for folder in "${CONDA_PREFIX:+$CONDA_PREFIX/lib}" "${HOMEBREW_PREFIX:+$HOMEBREW_PREFIX/opt/lapack/lib}"; do
      if [ -n "$folder" ] && ls "$folder"/liblapack.* >/dev/null 2>&1; then printf '%s ' "-L$folder -Wl,-rpath,$folder"; fi
   done
   ;;
*)
   echo "usage: tools/flags.sh release | checking | c | link" >&2
   exit 2
   ;;
esac
printf '%s\n' "${EXTRA_FLAGS:-}"
