#!/bin/sh
# Tests of what `make install` gives: installs into a folder of its own under a name with a space, builds consumers against
# it by each route that this machine has, and uninstalls. Ends with "N passed, M failed".

set -u
cd "$(dirname "$0")/.." || exit 1
root=$PWD
work=$root/build/installed
prefix="$work/a prefix"
FC=${FC:-gfortran} CC=${CC:-cc} PYTHON=${PYTHON:-python3}
export FC
version=$(sed -n 's/^version = "\(.*\)"/\1/p' fpm.toml)
header=include/poinsot.h
passed=0 failed=0 skipped=0

rm -rf "$work"
mkdir -p "$prefix" "$work/build"
: >"$prefix/stranger"

# expect NAME COMMAND...: the command succeeds.
expect() {
   name=$1
   shift
   if "$@" >"$work/log" 2>&1; then
      echo "       ... $name [PASSED]"
      passed=$((passed + 1))
   else
      echo "       ... $name [FAILED]"
      sed 's/^/  /' "$work/log" | tail -n 20
      failed=$((failed + 1))
   fi
}

skip() { echo "       ... $1 [SKIPPED] $2"; skipped=$((skipped + 1)); }
have() { command -v "$1" >/dev/null 2>&1; }
config() { PKG_CONFIG_PATH=$prefix/lib/pkgconfig pkg-config "$@" poinsot; }

by_hand() {
   "$CC" -std=c99 test/consumer/consumer.c -o build/installed/build/by-hand -I"$prefix/include" -L"$prefix/lib" -lpoinsot -lm &&
      LD_LIBRARY_PATH=$prefix/lib build/installed/build/by-hand
}
# pkg-config escapes the blank of the prefix; eval takes it back.
shared_c() {
   eval "$CC -std=c99 -pedantic -Wall -Wextra -Werror test/consumer/consumer.c -o build/installed/build/shared \
      $(config --cflags --libs) -lm" && LD_LIBRARY_PATH=$prefix/lib build/installed/build/shared
}
static_c() {
   eval "$CC -std=c99 test/consumer/consumer.c -o build/installed/build/static $(config --cflags --libs --static |
      sed 's/-lpoinsot/-l:libpoinsot.a/')" && build/installed/build/static
}
cpp() { eval "c++ -std=c++11 -Wall -Wextra -Werror -fsyntax-only -x c++ $(config --cflags) $header"; }
fortran() {
   eval "$FC test/consumer/consumer.f90 -o build/installed/build/fortran $(config --cflags --libs)" &&
      LD_LIBRARY_PATH=$prefix/lib build/installed/build/fortran
}
cmake_c() {
   cmake -S test/consumer -B build/installed/cmake -DCMAKE_PREFIX_PATH="$prefix" && cmake --build build/installed/cmake &&
      build/installed/cmake/with_poinsot && build/installed/cmake/with_static
}
files() {
   for it in lib/libpoinsot.a lib/libpoinsot.so lib/libpoinsot.so.0 lib/libpoinsot.so.$version lib/pkgconfig/poinsot.pc \
      lib/cmake/poinsot/poinsotConfig.cmake include/poinsot/poinsot_core_version.mod share/poinsot/installed.txt; do
      [ -e "$prefix/$it" ] || { echo "$it is not there"; return 1; }
   done
   if nm "$prefix/lib/libpoinsot.a" | grep -q testdrive; then echo "test-drive is in the library"; return 1; fi
}
app() { "$prefix/bin/poinsot" --version | grep -F "$version"; }
nothing_left() { [ "$(cd "$prefix" && find . | sort | tr '\n' ' ')" = ". ./stranger " ] || { find "$prefix"; return 1; }; }

expect "install" tools/install.sh install "$prefix"
expect "install-again" tools/install.sh install "$prefix"
[ "$(uname)" = Darwin ] || expect "files" files
have_api=$version
[ -f $header ] || have_api=
if have "$PYTHON" && [ "$(uname)" != Darwin ]; then
   expect "dlopen" "$PYTHON" test/consumer/load.py "$prefix/lib/libpoinsot.so" $have_api
else
   skip "dlopen" "no $PYTHON"
fi
[ -z "$have_api" ] || expect "c-by-hand" by_hand
if have pkg-config; then
   expect "fortran-by-pkg-config" fortran
   if [ -n "$have_api" ]; then
      expect "c-shared-by-pkg-config" shared_c
      [ "$(uname)" = Darwin ] || expect "c-static-by-pkg-config" static_c
      if have c++; then expect "c++-header" cpp; else skip "c++-header" "no c++"; fi
   fi
else
   skip "by-pkg-config" "no pkg-config"
fi
if [ -n "$have_api" ]; then
   if have cmake; then expect "c-by-cmake" cmake_c; else skip "c-by-cmake" "no cmake"; fi
fi
[ ! -x "$prefix/bin/poinsot" ] || expect "app" app
expect "uninstall" tools/install.sh uninstall "$prefix"
expect "nothing-left" nothing_left

[ $skipped -eq 0 ] || echo "$skipped skipped"
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
