#!/bin/sh
# Builds by fpm or by CMake, whichever tools/setup.sh left in $BUILD/builder. Shows how far it is; of a failure the errors first.
#
# usage: tools/build.sh stage                        library and app, into $BUILD/stage
#        tools/build.sh tests PROFILE                tests in a profile (release, checking)
#        tools/build.sh run PROFILE [SUITE [TEST]]   and runs them
# environment: BUILD (build), FC, PORTABLE, TARGET, EXTRA_FLAGS as in tools/flags.sh

set -u
cd "$(dirname "$0")/.." || exit 1
FC=${FC:-gfortran} BUILD=${BUILD:-build}
export FC
builder=$(cat "$BUILD/builder" 2>/dev/null) || builder=fpm
mkdir -p "$BUILD/log"

# Run a command; its words go into a log. On a terminal the last line shows how far it is.
quietly() {
   log=$1
   shift
   if [ -t 2 ]; then
      # read, not awk or tr, which wait for some thousand characters; so does what fpm is written in
      { export GFORTRAN_UNBUFFERED_PRECONNECTED=y; "$@" 2>&1; echo $? >"$log.code"; } | tee "$log" | while IFS= read -r line; do
         case $line in '['*[0-9]']'* | '['*%']'*) printf '\r%.78s\033[K' "$line" ;; esac
      done >&2
      printf '\r\033[K' >&2
      code=$(cat "$log.code")
   else
      "$@" >"$log" 2>&1
      code=$?
   fi
   [ "$code" = 0 ] && return
   echo "the build failed (the whole log: $log):"
   grep -n -i -B 6 '\(^\|[^_a-z-]\)error\(:\| #\|[: ]*[^a-z]*$\)' "$log" | tail -n 40
   [ "$(grep -c -i 'error' "$log")" != 0 ] || tail -n 30 "$log"
   return 1
}

# fpm does not look into included files: what includes one that is newer is compiled again.
by_fpm() {
   command=$1
   shift
   for included in $(find src -name '*.inc'); do
      for user in $(grep -l "include ['\"].*${included##*/}" -r src --include='*.f90'); do
         for object in build/*/poinsot/"$(printf %s "$user" | tr / _)".o; do
            [ "$included" -nt "$object" ] && rm -f "$object.digest"
         done
      done
   done
   compiler=$FC
   case ${FC##*/} in
   *gfortran*) # flags for single files, which fpm does not know; all is compiled again when they change
      compiler=build/tools/by_file/${FC##*/}
      mkdir -p build/tools/by_file && ln -sf ../../../tools/by_file.sh "$compiler"
      find build -path '*/poinsot/src_*.o' ! -newer tools/by_file.txt -exec rm -f '{}.digest' ';' ;;
   esac
   build/tools/bin/fpm "$command" --no-prune --compiler "$compiler" --c-flag "$(tools/flags.sh c)" --link-flag "$(tools/flags.sh link)" "$@"
}

# configure FOLDER OPTION...: what is built where
configure() {
   folder=$1
   shift
   target=${TARGET:-native}
   [ "${PORTABLE:-0}" != 1 ] || target=portable
   set -- "-DCMAKE_Fortran_COMPILER=$(command -v "$FC")" "-DPOINSOT_TARGET=$target" "-DCMAKE_Fortran_FLAGS=${EXTRA_FLAGS:-}" "$@"
   [ -f "$folder/CMakeCache.txt" ] || ! command -v ninja >/dev/null || set -- -G Ninja "$@"
   cmake -S . -B "$folder" "$@"
}
jobs=$(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)

case ${1:-}:$builder in
stage:fpm)
   # Without pruning: the library holds every module, not only those that the app reaches. Objects of the tests go when
   # a module was compiled anew: fpm compiles again what uses a changed module only if it is of the same run.
   quietly build/log/build by_fpm install --prefix build/stage --flag "$(tools/flags.sh release)" || exit 1
   grep -q "up to date" build/log/build || rm -f build/*/poinsot/test_*.o build/*/poinsot/test_*.o.digest
   echo "built by fpm: build/stage/bin/poinsot and build/stage/lib/libpoinsot.a"
   ;;
stage:cmake)
   by_cmake() {
      configure "$BUILD/cmake" -DCMAKE_BUILD_TYPE=Release -DPOINSOT_TESTS=OFF -DCMAKE_INSTALL_LIBDIR=lib -DPOINSOT_MODDIR= &&
         cmake --build "$BUILD/cmake" --parallel "$jobs" && cmake --install "$BUILD/cmake" --prefix "$BUILD/stage"
   }
   quietly "$BUILD/log/build" by_cmake || exit 1
   # For bench/ and mpi/, which use all of it: every module, and scenes and studies in the archive, as fpm leaves them.
   cp "$BUILD"/cmake/mod/core/*.mod "$BUILD"/cmake/mod/scenes/*.mod "$BUILD/stage/include"
   (cd "$BUILD/cmake" && printf '%s\n' "create all.a" "addlib libpoinsot.a" "addlib libpoinsot_scenes.a" save end | ar -M) &&
      mv "$BUILD/cmake/all.a" "$BUILD/stage/lib/libpoinsot.a"
   echo "built by CMake: $BUILD/stage/bin/poinsot and $BUILD/stage/lib"
   ;;
tests:fpm)
   quietly build/log/tests by_fpm build --tests --flag "$(tools/flags.sh "$2")"
   ;;
run:fpm)
   flags=$(tools/flags.sh "$2")
   shift 2
   by_fpm test --target check --flag "$flags" -- "$@"
   ;;
tests:cmake | run:cmake)
   by_cmake() {
      case $1 in
      checking) configure "$BUILD/cmake-checking" -DCMAKE_BUILD_TYPE=Debug -DPOINSOT_TARGET=portable -DPOINSOT_APP=OFF \
         -DPOINSOT_EXAMPLES=OFF -DPOINSOT_TESTS=ON "-DCMAKE_Fortran_FLAGS_DEBUG=$(tools/flags.sh checking)" ;;
      *) configure "$BUILD/cmake" -DCMAKE_BUILD_TYPE=Release -DPOINSOT_TESTS=ON ;;
      esac && cmake --build "$folder" --parallel "$jobs"
   }
   action=$1 profile=$2
   shift 2
   quietly "$BUILD/log/tests" by_cmake "$profile" || exit 1
   [ "$action" = run ] || exit 0
   folder=$BUILD/cmake
   [ "$profile" = release ] || folder=$BUILD/cmake-$profile
   cd "$folder/run" && exec ../check "$@"
   ;;
*)
   echo "usage: tools/build.sh stage | tests PROFILE | run PROFILE [SUITE [TEST]]" >&2
   exit 2
   ;;
esac
