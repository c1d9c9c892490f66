#!/bin/sh
# Set-up: what is missing to build poinsot is installed, what is there is used. Says what it does.
#
# usage: tools/setup.sh [build | demo | lint | docs | mpi | deep] ...
#   build (always): Fortran compiler, LAPACK, and fpm or CMake to build with;   demo: and gnuplot;   lint: fpm, fortitude;
#   docs: FORD;   mpi: MPICH, if there is no MPI compiler;   deep: on Debian and its kin valgrind and LLVM's flang, if that can be
#   done (the deep checks skip what is not there)
#
# fpm builds where it is there (on the PATH, or in build/tools from an earlier set-up); CMake where fpm is not; where neither is,
# fpm is fetched from PyPI. The choice is left in $BUILD/builder. Compiler, LAPACK, gnuplot, git and pip come from the system's own
# package manager (apt, dnf, brew or conda); fpm, fortitude and FORD from PyPI, or from wheels in build/wheels, into build/tools, so
# nothing of the user's Python changes; test-drive from its repository into build/dependencies, or, where that does not answer, the
# stand-in of tools/testdrive.
# environment: SETUP=no installs and fetches nothing; BUILDER=fpm or cmake; BUILD the folder of builds (build; elsewhere: CMake);
#   FC the Fortran compiler (gfortran), PYTHON the Python (python3), PICTURES=no a demo without gnuplot

set -u
cd "$(dirname "$0")/.." || exit 1

FC=${FC:-gfortran}
PYTHON=${PYTHON:-python3}
BUILD=${BUILD:-build}
fpm_version=0.12.0
fortitude_version=0.10.0
ford_version=7.0.13
oldest_gfortran=11
oldest_cmake=3.18
tools=build/tools
wheels=build/wheels
test_drive=build/dependencies/test-drive

say() { printf 'setup: %s\n' "$*"; }
stop() { printf 'setup: %s\n' "$@" >&2; exit 1; }
stop_with_log() { printf 'setup: %s\n' "$1" >&2; tail -n 20 "$scratch/log" >&2; exit 1; }
have() { command -v "$1" >/dev/null 2>&1; }

# Run a command, for so many seconds at most.
within() {
   if have timeout; then timeout "$@"
   elif have gtimeout; then gtimeout "$@"
   else perl -e 'alarm shift; exec @ARGV or exit 127' "$@"
   fi
}

# ---- what the system's package manager gives ----------------------------------------------------------------------

scratch=$(mktemp -d) || exit 1
trap 'rm -rf "$scratch"' EXIT
trap 'exit 1' HUP INT TERM

# Does a program that calls LAPACK and BLAS compile and link? Whether it is the compiler or the libraries is asked in turn.
links() { "$FC" $(tools/flags.sh link) "$scratch/$1.f90" -o "$scratch/$1" $2 >"$scratch/log" 2>&1; }
compiler_works() { have "$FC" && links plain ""; }
# Older compilers fail in the middle, with messages that name no reason.
compiler_is_new_enough() {
   "$FC" --version 2>/dev/null | grep -q '^GNU Fortran' || return 0
   number=$("$FC" -dumpversion)
   [ "${number%%.*}" -ge $oldest_gfortran ] || stop "$FC is gfortran $number; poinsot needs gfortran $oldest_gfortran or newer" \
      "name another with FC=, gfortran-12 say"
}
cmake_works() {
   have cmake && cmake --version | awk -v want=$oldest_cmake '
      function number(text, part) { split(text, part, "."); return 1e3*part[1] + part[2] }
      NR == 1 { exit !(number($3) >= number(want)) }'
}
lapack_works() { links lapack "-llapack -lblas"; }
# As far as it can be told by a look: tools/mpi.sh tries the pairs of compiler and starter.
mpi_works() {
   printf 'use mpi_f08\ncall mpi_init()\nend\n' >"$scratch/mpi.f90"
   for it in ${MPIFC:-mpifort mpifort.mpich mpifort.openmpi}; do
      have "$it" && "$it" "$scratch/mpi.f90" -o "$scratch/mpi" >/dev/null 2>&1 && return
   done
   return 1
}
pip_works() { have "$PYTHON" && "$PYTHON" -m pip --version >/dev/null 2>&1; }

printf 'end\n' >"$scratch/plain.f90"
printf 'external :: dgesdd, ddot\ncall dgesdd()\ncall ddot()\nend\n' >"$scratch/lapack.f90"

manager() {
   for it in apt-get dnf brew; do
      if have $it; then echo $it; return; fi
   done
   if have conda; then echo conda; fi
}

# The package manager's name for a need.
package() {
   case $1:$2 in
   apt-get:compiler) echo gfortran libc6-dev ;;
   apt-get:lapack)   echo liblapack-dev libblas-dev ;;
   apt-get:gnuplot)  echo gnuplot-nox ;;
   apt-get:mpi)      echo mpich libmpich-dev ;;
   dnf:compiler)     echo gcc-gfortran ;;
   dnf:mpi)          echo mpich mpich-devel ;;
   dnf:lapack)       echo lapack-devel blas-devel ;;
   brew:compiler)    echo gcc ;;
   brew:mpi)         echo mpich ;;
   brew:lapack)      echo lapack ;;
   brew:pip)         echo python ;;
   conda:compiler)   echo gfortran ;;
   conda:mpi)        echo mpich mpich-mpifort ;;
   conda:lapack)     echo liblapack blas-devel ;;
   conda:pip)        echo python pip ;;
   *:pip)            echo python3-pip ;;
   *)                echo "$2" ;;
   esac
}

describe() {
   case $1 in
   compiler) echo "a Fortran compiler ($FC)" ;;
   lapack)   echo "LAPACK and BLAS, with what is needed to link them" ;;
   pip)      echo "pip for $PYTHON" ;;
   cmake)    echo "CMake $oldest_cmake or newer, or fpm $fpm_version or newer in the PATH" ;;
   mpi)      echo "MPI (${MPIFC:-mpifort} and mpirun)" ;;
   *)        echo "$1" ;;
   esac
}

# Install the needs named, or stop and say what to do.
install() {
   with=$(manager)
   case " $* " in *" compiler "*)
      [ "$FC" = gfortran ] || ! have "$FC" || compiler_works || stop_with_log "FC=$FC does not compile here:"
      [ "$FC" = gfortran ] || stop "FC=$FC is not in the PATH; without FC= it is gfortran, which ${with:-the package manager} can install" ;;
   esac
   if [ "${SETUP:-yes}" = no ]; then
      stop "to be installed by hand (SETUP=no): $([ -z "$with" ] || for it in "$@"; do package "$with" "$it"; done | tr '\n' ' ')" \
         "$(for it in "$@"; do describe "$it"; done | sed '2,$s/^/       /')"
   fi
   for it in "$@"; do say "missing: $(describe "$it")"; done
   [ -n "$with" ] || stop "to be installed by hand: the above; there is no package manager that I know (apt, dnf, brew, conda)"
   packages=$(for it in "$@"; do package "$with" "$it"; done | tr '\n' ' ')
   case $with in
   apt-get) command="apt-get install -y --no-install-recommends $packages" ;;
   dnf)     command="dnf install -y $packages" ;;
   brew)    command="brew install $packages" ;;
   conda)   command="conda install -y -c conda-forge $packages" ;;
   esac
   as=
   case $with in apt-get | dnf)
      if [ "$(id -u)" -ne 0 ]; then
         as="sudo -n"
         if ! { have sudo && sudo -n true 2>/dev/null; }; then
            if have conda && [ -n "${CONDA_PREFIX:-}" ]; then
               with=conda as=
               command="conda install -y -c conda-forge $(for it in "$@"; do package conda "$it"; done | tr '\n' ' ')"
            else
               stop "not permitted to install (not root, and sudo asks for a password). Please run, then again:" "   sudo $command"
            fi
         fi
      fi ;;
   esac
   set -- $as
   [ $with != apt-get ] || set -- "$@" env DEBIAN_FRONTEND=noninteractive
   if [ $with = apt-get ]; then
      say "apt-get update"
      "$@" apt-get update -qq >"$scratch/log" 2>&1 || say "apt-get update failed, going on with the lists that are there"
   fi
   say "$command"
   "$@" $command >"$scratch/log" 2>&1 || {
      printf 'setup: to be installed by hand: %s\nsetup: this failed: %s\n' "$packages" "$command" >&2
      tail -n 20 "$scratch/log" >&2
      exit 1
   }
   say "installed: $packages"
}

system_needs() {
   needs=
   compiler_works || needs="compiler"
   lapack_works || needs="$needs lapack"
   if [ $builder = fpm ]; then
      if private_fpm_needed && [ "${SETUP:-yes}" = no ]; then # fpm is fetched by pip
         needs="$needs cmake"
      else
         private_fpm_needed && ! pip_works && needs="$needs pip"
         [ -f $test_drive/fpm.toml ] || have git || needs="$needs git"
      fi
   fi
   case " $* " in *" lint "* | *" docs "*) pip_works || needs="$needs pip" ;; esac
   case " $* " in *" demo "*) [ "${PICTURES:-yes}" = no ] || have gnuplot || needs="$needs gnuplot" ;; esac
   case " $* " in *" mpi "*) mpi_works || needs="$needs mpi" ;; esac
   [ -n "$needs" ] || return 0
   needs=$(printf '%s\n' $needs | sort -u)
   install $needs
   compiler_works || { stop_with_log "the compiler $FC still does not work"; }
   lapack_works || { stop_with_log "LAPACK still does not link with $FC"; }
}

# Tools of the deep checks: no set-up fails for want of them.
deep_wishes() {
   [ "${SETUP:-yes}" != no ] || return 0
   wishes=
   have valgrind || wishes=valgrind
   flang=$(apt-cache pkgnames flang- 2>/dev/null | sed -n 's/^flang-\(19\|[2-9][0-9]\)$/\1/p' | sort -n | tail -n 1)
   if [ -n "$flang" ] && ! have "flang-$flang" && ! have "flang-new-$flang"; then wishes="$wishes flang-$flang libomp-$flang-dev"; fi
   [ -n "$wishes" ] || return 0
   as=
   [ "$(id -u)" -eq 0 ] || as="sudo -n"
   if have apt-get && $as env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $wishes >"$scratch/log" 2>&1; then
      say "installed: $wishes"
   else
      say "could not install for the deep checks, which skip them: $wishes"
   fi
}

# ---- what PyPI gives ----------------------------------------------------------------------------------------------

# from_pypi NAME PACKAGE [OPTIONS [OR WHAT ELSE]]: a package of PyPI in a folder of its own; no virtual environment needed. Wheels
# in build/wheels are taken instead of the network.
from_pypi() {
   [ "${SETUP:-yes}" != no ] || stop "to be installed by hand (SETUP=no): $2 into the PATH${4:-}"
   pip_works || stop "to be installed by hand: $2 into the PATH${4:-}; $PYTHON has no pip"
   from=
   [ -z "$(ls $wheels/*.whl 2>/dev/null)" ] || from="--no-index --find-links $wheels"
   say "installing $2 from ${from:+$wheels}${from:-PyPI} into $tools/$1" | sed 's/--no-index.* into/ into/'
   rm -rf "$tools/$1" "$tools/$1.part"
   mkdir -p "$tools"
   PIP_USER=0 "$PYTHON" -m pip install --quiet --disable-pip-version-check --no-warn-script-location $from \
      --target "$tools/$1.part" ${3:-} "$2" >"$scratch/log" 2>&1 ||
      stop_with_log "to be installed by hand: $2 into the PATH, or its wheel into $wheels (pip download $2)${4:-}; pip says:"
   mv "$tools/$1.part" "$tools/$1"
}

# A script build/tools/bin/NAME.
wrapper() {
   mkdir -p "$tools/bin"
   printf '#!/bin/sh\nhere=$(dirname "$0")/..\n%s\n' "$2" >"$tools/bin/$1.part"
   chmod +x "$tools/bin/$1.part"
   mv "$tools/bin/$1.part" "$tools/bin/$1"
}

# The Fortran package manager (another program is called fpm too), in the version tried or newer?
is_fpm() {
   "$1" --version 2>/dev/null | awk -v want=$fpm_version '
      function number(text, part) { split(text, part, "."); return 1e6*part[1] + 1e3*part[2] + part[3] }
      /Fortran/ { fortran = 1 }
      $1 == "Version:" { version = number($2) }
      END { exit !(fortran && version >= number(want)) }'
}

private_fpm_needed() { ! is_fpm "$tools/bin/fpm" && ! { have fpm && is_fpm fpm; }; }

# fpm of the PATH before the private one; tools/bin/fpm is what the scripts call.
fpm_needs() {
   # a wrapper that calls itself would never end
   if have fpm && is_fpm fpm && ! [ "$(command -v fpm)" -ef $tools/bin/fpm ]; then
      grep -qsF "exec '$(command -v fpm)'" $tools/bin/fpm || say "using fpm of the PATH: $(command -v fpm)"
      wrapper fpm "exec '$(command -v fpm)' \"\$@\""
      return
   fi
   is_fpm "$tools/bin/fpm" && return
   from_pypi fpm fpm==$fpm_version "--only-binary :all:" ", or CMake $oldest_cmake or newer instead of it"
   wrapper fpm 'exec "$here/fpm/fpm/fpm" "$@"'
   is_fpm "$tools/bin/fpm" || stop "fpm of PyPI does not run on this machine; put fpm $fpm_version or newer on the PATH, or use CMake"
}

# Who builds. fpm writes into build/ of the sources only, and knows one level of processor.
choose_builder() {
   case ${BUILDER:-}:$BUILD:${TARGET:-} in
   fpm:build:levels) stop "TARGET=levels is built by CMake: leave BUILDER=fpm out" ;;
   fpm:build:*) builder=fpm why= ;;
   fpm:*) stop "BUILDER=fpm builds in build only: leave BUILD=$BUILD out" ;;
   cmake:*) builder=cmake why= ;;
   :build:levels) builder=cmake why="TARGET=levels" ;;
   :build:*)
      builder=fpm why=
      if private_fpm_needed && cmake_works; then builder=cmake why="there is no fpm; BUILDER=fpm fetches it"; fi ;;
   :*) builder=cmake why="BUILD=$BUILD" ;;
   *) stop "BUILDER=$BUILDER: fpm or cmake" ;;
   esac
   for it in "$@"; do
      case $it in lint) [ $builder = fpm ] || private_fpm_needed || builder=fpm ;; esac
   done
   if [ $builder = cmake ]; then
      cmake_works || stop "to be installed by hand: CMake $oldest_cmake or newer${why:+ ($why)}"
   fi
   { mkdir -p "$BUILD" && echo $builder >"$BUILD/builder"; } 2>/dev/null || stop "no permission to write to $BUILD: choose another folder with BUILD="
}

fortitude_needs() {
   [ -x $tools/bin/fortitude ] && return
   from_pypi fortitude fortitude-lint==$fortitude_version "--only-binary :all:"
   wrapper fortitude 'exec "$here/fortitude/bin/fortitude" "$@"'
}

ford_needs() {
   [ -x $tools/bin/ford ] && return
   from_pypi ford FORD==$ford_version
   wrapper ford "PYTHONPATH=\"\$here/ford\" exec $PYTHON -m ford \"\$@\""
}

# ---- test-drive ---------------------------------------------------------------------------------------------------

from_manifest() { sed -n "s/^test-drive\\.$1 *= *\"\\(.*\\)\".*/\\1/p" fpm.toml; }

is_stand_in() { [ -f $test_drive/src/testdrive.f90 ] && head -n 1 $test_drive/src/testdrive.f90 | grep -q '^!> Stand-in'; }

# A git repository of its own is all that fpm asks of a checkout that is already there.
place_stand_in() {
   rm -rf $test_drive
   mkdir -p $test_drive
   cp -R tools/testdrive/. $test_drive/
   (cd $test_drive && git init -q . && git add -A &&
      git -c user.name=poinsot -c user.email=poinsot@localhost -c commit.gpgsign=false commit -q -m "stand-in for test-drive") \
      >"$scratch/log" 2>&1 || { cat "$scratch/log" >&2; stop "could not place the stand-in for test-drive"; }
}

clone_test_drive() {
   [ "${SETUP:-yes}" != no ] || return 1
   url=$(from_manifest git)
   tag=$(from_manifest tag)
   GIT_TERMINAL_PROMPT=0 within 6 git ls-remote --exit-code "$url" "refs/tags/$tag" >/dev/null 2>&1 || return 1
   rm -rf $test_drive
   mkdir -p build/dependencies
   GIT_TERMINAL_PROMPT=0 within 120 git -c advice.detachedHead=false clone -q --depth 1 --branch "$tag" "$url" $test_drive \
      >/dev/null 2>&1
}

test_drive_needs() {
   if is_stand_in; then
      if ! cmp -s tools/testdrive/src/testdrive.f90 $test_drive/src/testdrive.f90; then place_stand_in; fi
   elif ! [ -f $test_drive/fpm.toml ]; then
      clone_test_drive || place_stand_in
   fi
   if is_stand_in; then
      asked="its repository did not answer; 'make distclean' asks again"
      [ "${SETUP:-yes}" != no ] || asked="SETUP=no: its repository is not asked"
      say "test-drive: the stand-in of tools/testdrive ($asked)"
   else
      say "test-drive: the original, version $(sed -n 's/^version *= *"\(.*\)".*/\1/p' $test_drive/fpm.toml)"
   fi
}

# fpm adds to an archive but takes nothing away, and its objects outlive a change of test-drive: after a source file came, went
# or moved, the build starts anew.
forget_old_objects() {
   find src $test_drive/src -name '*.[fF]90' -o -name '*.c' | sort >"$scratch/sources"
   cmp -s "$scratch/sources" build/sources.txt || rm -rf build/*_????????????????
   cp "$scratch/sources" build/sources.txt
}

# -------------------------------------------------------------------------------------------------------------------

choose_builder "$@"
! compiler_works || compiler_is_new_enough
system_needs "$@"
compiler_is_new_enough
[ $builder = fpm ] || [ -z "$why" ] || say "building by CMake ($why)"
if [ $builder = fpm ]; then
   fpm_needs
   test_drive_needs
   forget_old_objects
fi
for it in "$@"; do
   case $it in
   lint) fpm_needs; fortitude_needs ;;
   docs) ford_needs ;;
   deep) deep_wishes ;;
   build | demo | mpi) ;;
   *) stop "unknown: $it (build, demo, lint, docs, mpi, deep)" ;;
   esac
done
