#!/bin/sh
# Tests of what `make install` gives: installs into a folder of its own under a name with a space, builds consumers against
# it by each route that this machine has, and uninstalls. Ends with "N passed, M failed".

set -u
cd "$(dirname "$0")/.." || exit 1
BUILD=${BUILD:-build}
export BUILD
work=$BUILD/installed
case $work in /*) prefix="$work/a prefix" ;; *) prefix="$PWD/$work/a prefix" ;; esac
FC=${FC:-gfortran} CC=${CC:-cc} PYTHON=${PYTHON:-python3}
export FC
version=$(sed -n 's/^version = "\(.*\)"/\1/p' fpm.toml)
series=${version%.*}
header=include/poinsot.h
passed=0 failed=0 skipped=0

rm -rf "$work"
mkdir -p "$prefix" "$work/build"
: >"$prefix/stranger"

# expect NAME COMMAND...: the command succeeds.
expect() {
   what=$1
   shift
   if "$@" >"$work/log" 2>&1; then
      echo "       ... $what [PASSED]"
      passed=$((passed + 1))
   else
      echo "       ... $what [FAILED]"
      sed 's/^/  /' "$work/log" | tail -n 20
      failed=$((failed + 1))
   fi
}

skip() { echo "       ... $1 [SKIPPED] $2"; skipped=$((skipped + 1)); }
have() { command -v "$1" >/dev/null 2>&1; }
config() { PKG_CONFIG_PATH=$prefix/lib/pkgconfig pkg-config "$@" poinsot; }

by_hand() {
   "$CC" -std=c99 test/consumer/consumer.c -o $work/build/by-hand -I"$prefix/include" -L"$prefix/lib" -lpoinsot -lm &&
      LD_LIBRARY_PATH=$prefix/lib $work/build/by-hand
}
# pkg-config escapes the blank of the prefix; eval takes it back.
shared_c() {
   eval "$CC -std=c99 -pedantic -Wall -Wextra -Werror test/consumer/consumer.c -o $work/build/shared \
      $(config --cflags --libs) -lm" && LD_LIBRARY_PATH=$prefix/lib $work/build/shared
}
static_c() {
   eval "$CC -std=c99 test/consumer/consumer.c -o $work/build/static $(config --cflags --libs --static |
      sed 's/-lpoinsot/-l:libpoinsot.a/')" && $work/build/static
}
# The whole program static, C library and all: nothing in it may be missing at exit.
static_whole() {
   eval "$CC -static -std=c99 test/consumer/consumer.c -o $work/build/static-whole $(config --cflags --libs --static |
      sed 's/-lpoinsot/-l:libpoinsot.a/')" && $work/build/static-whole
}
static_works() {
   echo 'int main(void) { return 0; }' >"$work/try.c" && "$CC" -static "$work/try.c" -o "$work/try" 2>/dev/null && "$work/try" &&
      [ -f "$("$FC" -print-file-name=liblapack.a)" ]
}
# The header for generators of bindings: declarations and nothing else, all of those of the other.
bindings_header() {
   mkdir -p "$work/bindings" && printf '#include <stddef.h>\n#include <stdint.h>\n#include <poinsot_cdef.h>\n' >"$work/bindings/poinsot.h" &&
      ! sed 1d "$prefix/include/poinsot_cdef.h" | grep '#\|/[*]\|extern\|enum {' &&
      "$CC" -std=c99 -pedantic -Wall -Wextra -Werror -fsyntax-only -I"$work/bindings" -I"$prefix/include" test/consumer/consumer.c &&
      for file in poinsot.h poinsot_cdef.h; do
         "$CC" -E -P -include stddef.h -include stdint.h "$prefix/include/$file" | tr -d ' \n' | grep -o 'enumpoinsot_status_code.*' >"$work/bindings/$file.text"
      done && cmp "$work/bindings/poinsot.h.text" "$work/bindings/poinsot_cdef.h.text"
}
ilp64() { with_shared "-std=c99 -Wall -Wextra -Werror" test/consumer/ilp64.c; }
cpp() { eval "c++ -std=c++11 -Wall -Wextra -Werror -fsyntax-only -x c++ $(config --cflags) $header"; }
fortran() {
   eval "$FC -J $work/build test/consumer/consumer.f90 -o $work/build/fortran $(config --cflags --libs)" &&
      LD_LIBRARY_PATH=$prefix/lib $work/build/fortran
}
cmake_c() {
   cmake -S test/consumer -B $work/cmake -DCMAKE_PREFIX_PATH="$prefix" && cmake --build $work/cmake &&
      $work/cmake/with_poinsot && $work/cmake/with_static
}
# A source of example/ or test/, $2, against the installed shared library, with flags $1; then it runs.
with_shared() {
   compiler=$CC
   case ${2%% *} in *.f | *.f90) compiler=$FC ;; *.cpp) compiler=c++ ;; esac
   program=$work/build/$(basename "${2%% *}" | tr . -)
   eval "$compiler $1 $2 -o $program $(config --cflags --libs) -lm" &&
      OMP_NUM_THREADS=2 LD_LIBRARY_PATH=$prefix/lib $program
}
same_top() {
   with_shared "$1" "$2" >"$work/top" && cat "$work/top" && tail -n 1 "$work/top" | grep -q "4.2050000000000.* 0.925740 *-0.351491 *0.102184 *-0.094964"
}
one_turn() { with_shared "$1" "$2" | tee "$work/turn" && grep -q "period  *13.640624" "$work/turn" && [ "$(grep -c ': *T' "$work/turn")" = 2 ]; }
# docs/functions.md names all that the two modules of functions have, and C's functions of arrays.
functions_page() {
   { sed 's/ *!.*//; /^ *use /!{/^      /!d;}; s/.*only: *//; s/=>[^,&]*//g' src/rotation.f90 src/elliptic.f90 | tr -d '& ' | tr ',' '\n'
     sed -n 's/^poinsot_status poinsot_\(quaternion_\)*\(.*\)(size_t n, .*/\2/p' $header
   } | grep . | grep -v '^poinsot_' | sort -u >"$work/functions"
   [ "$(grep -c . "$work/functions")" -gt 80 ] || return 1
   while IFS= read -r name; do grep -q "\`\(poinsot_\)*$name[\`(]" docs/functions.md || { echo "docs/functions.md: no $name"; return 1; }; done <"$work/functions"
}
# In Python where there is NumPy.
code_on_pages() {
   env OMP_NUM_THREADS=2 PYTHONPATH="$PWD/python" PYTHONDONTWRITEBYTECODE=1 POINSOT_LIBRARY="$prefix/lib/libpoinsot.so" \
      POINSOT_APP="$prefix/bin/poinsot" PKG_CONFIG_PATH="$prefix/lib/pkgconfig" test/pages.sh "$work/pages"
}
legacy_md() { PKG_CONFIG_PATH=$prefix/lib/pkgconfig test/legacy_md.sh "$work/legacy_md"; }
other_compiler() {
   "$FC" -fsyntax-only -std=f2008 -pedantic -Wall -J $work/build "$prefix/include/poinsot_interface.f90" &&
      "$FC" -J $work/build "$prefix/include/poinsot_interface.f90" test/consumer/interface.f90 -L"$prefix/lib" -lpoinsot \
         -o $work/build/interface && LD_LIBRARY_PATH=$prefix/lib $work/build/interface &&
      "$FC" -fsyntax-only -std=f2008 -pedantic -Wall -J $work/build "$prefix/include/poinsot_legacy.f90" &&
      "$FC" -Wall -Werror -ffpe-trap=invalid,zero,overflow -J $work/build "$prefix/include/poinsot_legacy.f90" test/consumer/legacy.f \
         -L"$prefix/lib" -lpoinsot -o $work/build/legacy && LD_LIBRARY_PATH=$prefix/lib $work/build/legacy
}
abuse_sanitized() {
   eval "$CC -std=c99 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined test/c/abuse.c -o $work/build/abuse-s \
      $(config --cflags --libs) -lm -lpthread" && LD_LIBRARY_PATH=$prefix/lib $work/build/abuse-s
}
sanitizers_work() {
   echo 'int main(void) { return 0; }' >"$work/try.c" && "$CC" -fsanitize=address,undefined "$work/try.c" -o "$work/try" 2>/dev/null && "$work/try"
}
no_memory() {
   eval "$CC -std=c99 test/c/memory.c -o $work/build/memory $(config --cflags --libs)" &&
      OMP_NUM_THREADS=1 LD_LIBRARY_PATH=$prefix/lib $work/build/memory
}
memory_flat() {
   eval "$CC -std=c99 -Wall -Wextra -Werror test/c/flat.c -o $work/build/flat $(config --cflags --libs)" &&
      OMP_NUM_THREADS=1 LD_LIBRARY_PATH=$prefix/lib $work/build/flat
}
# A scene of 3e8 bodies in an address space of 2 GB: a message and exit code 1, not a signal.
no_memory_app() {
   (ulimit -v 2000000 && OMP_NUM_THREADS=1 "$prefix/bin/poinsot" run free-body --set bodies.count=300000000 --out $work/large)
   code=$?
   echo "exit code $code"
   [ $code = 1 ]
}
has_numpy() { "$PYTHON" -c "import numpy" 2>/dev/null; }
# The Python package with the installed library and app.
in_python() {
   env OMP_NUM_THREADS=2 PYTHONPATH=python PYTHONDONTWRITEBYTECODE=1 POINSOT_LIBRARY="$prefix/lib/libpoinsot.so" \
      POINSOT_APP="$prefix/bin/poinsot" "$PYTHON" "$@"
}
older_processor() {
   eval "$CC -std=c99 test/consumer/older.c -o $work/build/older $(config --cflags --libs)" &&
      LD_LIBRARY_PATH=$prefix/lib qemu-x86_64 -cpu Nehalem $work/build/older
}
# A sentence and exit code 1, not SIGILL.
older_processor_app() {
   qemu-x86_64 -cpu Nehalem "$prefix/bin/poinsot" --version 2>"$work/said"
   [ $? = 1 ] && cat "$work/said" && grep -q "compiled for a newer processor" "$work/said"
}
# valgrind does not know AVX-512: for builds without it (PORTABLE=1).
abuse_valgrind() {
   LD_LIBRARY_PATH=$prefix/lib valgrind -q --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite \
      $work/build/abuse-c
}
without_avx512() { LD_LIBRARY_PATH=$prefix/lib "$PYTHON" -c "
import ctypes, sys
sys.exit(ctypes.CDLL('$prefix/lib/libpoinsot.so').poinsot_has_feature(b'avx512'))"; }
native_build() { LD_LIBRARY_PATH=$prefix/lib "$PYTHON" -c "
import ctypes, sys
sys.exit(not ctypes.CDLL('$prefix/lib/libpoinsot.so').poinsot_has_feature(b'avx2'))"; }
files() {
   for it in lib/libpoinsot.a lib/libpoinsot.so lib/libpoinsot.so.$series lib/libpoinsot.so.$version lib/pkgconfig/poinsot.pc \
      lib/cmake/poinsot/poinsotConfig.cmake include/poinsot/poinsot.mod include/poinsot_cdef.h share/poinsot/installed.txt; do
      [ -e "$prefix/$it" ] || { echo "$it is not there"; return 1; }
   done
   if nm "$prefix/lib/libpoinsot.a" | grep -q testdrive; then echo "test-drive is in the library"; return 1; fi
}
app() { "$prefix/bin/poinsot" --version | grep -F "$version"; }
# Every picture of a run, of a scene whose name is hostile to shells, to gnuplot and to SVG; each once more from another folder.
scene_pictures() {
   rm -rf build/installed/run
   mkdir -p build/installed/run
   scene="build/installed/run/o'clock \`touch run-by-name\`\$(touch run-by-name)<&\"@~^_%g.nml"
   printf '%s\n' "&scene t_end = 2, h = 0.1 /" "&bodies moments = 2, 2, 1, random = 'thermal', temperature = 1, count = 3 /" \
      "&gravity centre = 1, 0, 0 /" "&output every = 0.1, pictures = 'body top, tilt+angle ensemble' /" >"$scene"
   "$prefix/bin/poinsot" run "$scene" --quiet --out "${scene%.nml}" || return 1
   for name in attitude momentum drift nutation tilt angle temperature momenta; do
      [ -s "${scene%.nml}/$name.png" ] && [ -s "${scene%.nml}/$name.svg" ] || { cat "${scene%.nml}"/*.log; return 1; }
   done
   printf '%s\n' "name,setting,angle,worst,momentum,worst,time" "\`touch run-by-name\` 'x' \"<&\$(touch run-by-name)@{_^,1,1e-3,1e-2,1e-3,1e-2,900" \
      "\`touch run-by-name\` 'x' \"<&\$(touch run-by-name)@{_^,2,1e-5,1e-4,1e-5,1e-4,9000" >build/installed/run/rivals.csv
   "$prefix/bin/poinsot" cost "$scene" --quiet --budget 2s --splittings srkn6 --rivals build/installed/run/rivals.csv \
      --out "${scene%.nml}-cost" || return 1
   for name in attitude_cost momentum_cost attitude_step; do
      [ -s "${scene%.nml}-cost/$name.png" ] && [ -s "${scene%.nml}-cost/$name.svg" ] || { cat "${scene%.nml}"-cost/*.log; return 1; }
   done
   cp -r "${scene%.nml}" build/installed/run/moved
   for script in build/installed/run/moved/plot_*.gp; do
      said=$(cd build/installed/run/moved && gnuplot "${script##*/}" 2>&1)
      [ -z "$said" ] || { echo "$script: $said"; return 1; }
   done
   ! have "$PYTHON" || "$PYTHON" -c "import sys, xml.dom.minidom as xml
for file in sys.argv[1:]: xml.parse(file)" "${scene%.nml}"/*.svg "${scene%.nml}"-cost/*.svg || return 1
   if find . -name run-by-name | grep .; then return 1; fi
}
# Every script that a study writes is drawn; gnuplot leaves a log where it complains.
study_pictures() {
   for study in "cost heavy-top --splittings srkn6,omelyan4 --budget 3s" "cost free-body --budget 3s" "reproduce review" \
      "reproduce hairer-vilmart" "reproduce fasso" "reproduce celledoni --budget 5s"; do
      rm -rf $work/study
      # shellcheck disable=SC2086 # words
      "$prefix/bin/poinsot" $study --quiet --out $work/study || return 1
      for script in "$work"/study/plot_*.gp; do
         picture=${script%.gp}
         picture=$work/study/${picture##*/plot_}
         [ -s "$picture.png" ] && [ -s "$picture.svg" ] || { echo "$study: no $picture"; cat $work/study/plot_*.log; return 1; }
      done
   done
}
exports() { test/exports.sh "$prefix/lib/libpoinsot.so"; }
# Enough threads of OpenMP that are still there when the library is closed.
unload() {
   "$CC" -std=c99 -D_POSIX_C_SOURCE=200809L test/consumer/unload.c -o $work/build/unload -ldl &&
      OMP_NUM_THREADS=3 $work/build/unload "$prefix/lib/libpoinsot.so"
}
# A plugin that holds the static library, as docs/hosts.md says: it stays, and so do its threads.
unload_static() {
   eval "$CC -shared -o $work/build/plugin.so -Wl,-z,nodelete -Wl,--whole-archive -l:libpoinsot.a -Wl,--no-whole-archive \
      $(config --libs --static | sed 's/-lpoinsot//')" && OMP_NUM_THREADS=3 $work/build/unload $work/build/plugin.so
}
no_component() { ! cmake -S test/consumer -B $work/nonsense -DCMAKE_PREFIX_PATH="$prefix" -DWITH=nonsense; }
# Another place for libraries and modules, in another prefix; with what was installed by an earlier series.
elsewhere() {
   here=${prefix%/*}
   other=$here/other
   tools/install.sh install "$other" "" "$other/lib64/deep" "$here/mods" && ls "$other/lib64/deep/libpoinsot.so" "$here/mods/poinsot.mod" &&
      touch "$other/lib64/deep/libpoinsot.so.0.0" && echo lib64/deep/libpoinsot.so.0.0 >>"$other/share/poinsot/installed.txt" &&
      eval "$FC -fsyntax-only test/consumer/consumer.f90 -J $work/build \
         $(PKG_CONFIG_PATH=$other/lib64/deep/pkgconfig pkg-config --cflags poinsot)" &&
      tools/install.sh install "$other" "" lib64/deep "$here/mods" && ls "$other/lib64/deep/libpoinsot.so.0.0" &&
      tools/install.sh uninstall "$other" && [ -z "$(find "$other" -mindepth 1)" ] && [ ! -e "$here/mods" ]
}
# What README says one types, after what the installation says one sets, word by word in a shell of its own.
readme_lines() {
   plain=${prefix%/*}/plain
   tools/install.sh install "$plain" >"$work/hints" && cat "$work/hints" && mkdir -p "$work/readme" || return 1
   grep '^    \(gfortran\|gcc\) .*pkg-config' README.md >"$work/lines"
   sed -n '/^program book/,/^end program book/p' README.md >"$work/readme/book.f90"
   cp example/fixed/molecules.f example/c/heavy_top.c "$work/readme"
   sed -n 's/^   export/export/p' "$work/hints" >"$work/readme/session"
   while IFS= read -r line; do echo "$line && ./a.out || exit 1"; done <"$work/lines" >>"$work/readme/session"
   (cd "$work/readme" && env -i HOME="$HOME" PATH="$PATH" OMP_NUM_THREADS=2 sh -x ./session) &&
      [ "$(grep -c . "$work/lines")" -ge 3 ] && tools/install.sh uninstall "$plain"
}
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
if [ "$(uname)" = Linux ] && have nm; then
   expect "exports" exports
   expect "unload" unload
else
   skip "exports" "for Linux, with nm"
fi
[ -z "$have_api" ] || expect "c-by-hand" by_hand
if have pkg-config; then
   expect "fortran-by-pkg-config" fortran
   if [ -n "$have_api" ]; then
      expect "c-shared-by-pkg-config" shared_c
      [ "$(uname)" = Darwin ] || expect "c-static-by-pkg-config" static_c
      [ "$(uname)" != Linux ] || expect "unload-static" unload_static
      if static_works; then expect "c-static-whole" static_whole; else skip "c-static-whole" "no static libc or LAPACK"; fi
      [ "$(uname)" != Linux ] || expect "lapack-of-8-byte-integers" ilp64
      expect "header-for-bindings" bindings_header
      if have c++; then expect "c++-header" cpp; else skip "c++-header" "no c++"; fi
   fi
else
   skip "by-pkg-config" "no pkg-config"
fi
if have pkg-config; then
   expect "example-c" same_top "-std=c99 -pedantic -Wall -Wextra -Werror" example/c/heavy_top.c
   expect "example-fortran" same_top "" example/fortran/heavy_top.f90
   expect "example-functions-c" one_turn "-std=c99 -pedantic -Wall -Wextra -Werror" example/c/one_turn.c
   expect "example-functions-fortran" one_turn "" example/fortran/one_turn.f90
   expect "example-fortran-host" with_shared "" example/fortran/host_arrays.f90
   expect "code-on-pages" code_on_pages
   expect "example-fixed-form" with_shared "" example/fixed/molecules.f
   expect "example-legacy-md" legacy_md
   if have c++; then
      expect "example-c++" with_shared "-std=c++17 -pedantic -Wall -Wextra -Werror" example/c++/lammps_rows.cpp
   else
      skip "example-c++" "no c++"
   fi
   expect "abuse" with_shared "-std=c99 -pedantic -Wall -Wextra -Werror" "test/c/abuse.c -lpthread"
   expect "functions" with_shared "-std=c99 -pedantic -Wall -Wextra -Werror" test/c/functions.c
   if sanitizers_work; then expect "abuse-sanitized" abuse_sanitized; else skip "abuse-sanitized" "no sanitizers"; fi
   if have valgrind && without_avx512; then
      expect "abuse-valgrind" abuse_valgrind
   else
      skip "abuse-valgrind" "no valgrind, or a build with AVX-512"
   fi
   [ "$(uname)" != Linux ] || expect "memory-stays-flat" memory_flat
   if [ "$(uname)" = Linux ]; then expect "no-memory" no_memory; else skip "no-memory" "for glibc"; fi
   if have qemu-x86_64 && native_build; then
      expect "older-processor" older_processor
      expect "older-processor-app" older_processor_app
   else
      skip "older-processor" "no qemu-x86_64, or a build for any processor"
   fi
fi
expect "other-compiler" other_compiler
expect "functions-page" functions_page
if has_numpy; then
   expect "example-python" in_python example/python/free_body.py "$work/free_body.png"
   expect "example-python-cost" in_python example/python/what_accuracy_costs.py "$work/cost.png" 3s
   if "$PYTHON" -c "import pytest" 2>/dev/null; then
      expect "python" in_python -m pytest -q -p no:cacheprovider python/tests
   else
      skip "python" "no pytest for $PYTHON"
   fi
else
   skip "python" "no NumPy for $PYTHON"
fi
[ "$(uname)" != Linux ] || expect "fork" env OMP_NUM_THREADS=2 "$PYTHON" test/consumer/fork.py "$prefix/lib/libpoinsot.so"
if [ -n "$have_api" ]; then
   if have cmake; then expect "c-by-cmake" cmake_c; expect "no-such-component" no_component; else skip "c-by-cmake" "no cmake"; fi
fi
[ ! -x "$prefix/bin/poinsot" ] || expect "app" app
[ ! -x "$prefix/bin/poinsot" ] || [ "$(uname)" != Linux ] || expect "no-memory-app" no_memory_app
if [ -x "$prefix/bin/poinsot" ] && have gnuplot; then
   expect "scene-pictures" scene_pictures
   expect "study-pictures" study_pictures
else
   skip "scene-pictures" "no gnuplot"
   skip "study-pictures" "no gnuplot"
fi
! have pkg-config || expect "elsewhere" elsewhere
if have pkg-config && have gfortran && have gcc; then expect "readme-lines" readme_lines; fi
expect "uninstall" tools/install.sh uninstall "$prefix"
expect "nothing-left" nothing_left

[ $skipped -eq 0 ] || echo "$skipped skipped"
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
