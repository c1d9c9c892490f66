#!/bin/sh
# Install what `make build` left in build/stage, or remove exactly what was installed.
#
# usage: tools/install.sh install | uninstall PREFIX [DESTDIR [LIBDIR]]
#
# A list of what was installed goes into PREFIX/share/poinsot/installed.txt; uninstall, and installing anew, removes what stands
# there. The files can be moved together: nothing in them names PREFIX.

set -eu
cd "$(dirname "$0")/.."
action=${1:?install or uninstall} prefix=${2:?PREFIX}
destdir=${3:-} libdir=${4:-lib}
stop() { echo "install: $*" >&2; exit 1; }
case $prefix in /*) ;; *) prefix=$PWD/$prefix ;; esac
root=$destdir$prefix
list=share/poinsot/installed.txt
stage=build/stage
FC=${FC:-gfortran}

# Remove what the list names, last first: files, and folders (they end in /) if nothing else is in them.
uninstall() {
   sed '1!G;h;$!d' "$root/$list" >"$scratch/removal"
   while IFS= read -r it; do
      case $it in
      */) rmdir "$root/$it" 2>/dev/null || true ;;
      *) rm -f "$root/$it" ;;
      esac
   done <"$scratch/removal"
}

# Make a folder under PREFIX; those that were not there before go into the list.
folder() {
   [ ! -d "$root/$1" ] || return 0
   case $1 in */*) folder "${1%/*}" ;; esac
   mkdir "$root/$1"
   echo "$1/" >>"$scratch/list"
}

# put MODE SOURCE TARGET: one file to PREFIX/TARGET, and into the list.
put() {
   folder "${3%/*}"
   rm -f "$root/$3"
   cp "$2" "$root/$3"
   chmod "$1" "$root/$3"
   echo "$3" >>"$scratch/list"
}

# link_to WHAT TARGET: a symbolic link.
link_to() {
   rm -f "$root/$2"
   ln -s "$1" "$root/$2"
   echo "$2" >>"$scratch/list"
}

# filled TEMPLATE: the template with its @NAMES@ replaced.
filled() {
   up=$(echo "$libdir" | sed 's,[^/][^/]*,..,g')
   sed "s|@LIBDIR@|$libdir|g; s|@VERSION@|$version|g; s|@PRIVATE@|$private|g; s|@SHARED@|$shared|g; s|@SONAME@|$soname|g
        s|@PRIVATE_LIST@|$(echo $private | tr ' ' ';')|g; s|@SERIES@|${version%.*}|g; s|@MAJOR@|${version%%.*}|g
        s|@POINTER@|$(($(getconf LONG_BIT) / 8))|g; s|@UP@|$up|g" "tools/install/$1.in" >"$scratch/$1"
}

# The static library: what fpm made, without the dependencies that it puts there too (test-drive).
make_static() {
   cp $stage/lib/libpoinsot.a "$scratch/libpoinsot.a"
   others=$(ar t "$scratch/libpoinsot.a" | grep '^build_dependencies_' || true)
   [ -z "$others" ] || ar d "$scratch/libpoinsot.a" $others
   ar s "$scratch/libpoinsot.a"
}

# The shared library: all objects of the static one, with LAPACK, the OpenMP and the Fortran runtime linked in by name, so
# that dlopen from a program that has none of them works.
make_shared() {
   set -- $(tools/flags.sh link) -fopenmp -llapack -lblas
   if [ "$(uname)" = Darwin ]; then
      "$FC" -dynamiclib -o "$scratch/$shared" -Wl,-install_name,@rpath/$soname -Wl,-force_load,"$scratch/libpoinsot.a" "$@"
   else
      "$FC" -shared -o "$scratch/$shared" -Wl,-soname,$soname -Wl,--whole-archive "$scratch/libpoinsot.a" \
         -Wl,--no-whole-archive -Wl,--no-undefined -Wl,-z,noexecstack "$@"
   fi
}

# What a program needs beside libpoinsot.a when another compiler than gfortran links it.
private_libraries() {
   runtime=$(dirname "$("$FC" -print-file-name=libgfortran.a)")
   case $runtime in /*) runtime=-L$(cd "$runtime" && pwd -P) ;; *) runtime= ;; esac
   quadmath=-lquadmath
   printf 'end\n' >"$scratch/try.f90"
   "$FC" "$scratch/try.f90" -lquadmath -o "$scratch/try" 2>/dev/null || quadmath=
   echo $(tools/flags.sh link | tr ' ' '\n' | grep '^-L' || true) -llapack -lblas $runtime -lgfortran -lgomp $quadmath -lm
}

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

if [ "$action" = uninstall ]; then
   [ -f "$root/$list" ] || stop "nothing is installed there: $root/$list is not found"
   uninstall
   echo "removed from $root"
   exit 0
fi
[ "$action" = install ] || stop "unknown: $action (install, uninstall)"
[ -f $stage/lib/libpoinsot.a ] || stop "no $stage/lib/libpoinsot.a: run make build first"
mkdir -p "$root" 2>/dev/null && [ -w "$root" ] || stop "no permission to write to $root: choose another PREFIX="

version=$(sed -n 's/^version = "\(.*\)"/\1/p' fpm.toml)
if [ "$(uname)" = Darwin ]; then
   shared=libpoinsot.$version.dylib soname=libpoinsot.${version%%.*}.dylib plain=libpoinsot.dylib
else
   shared=libpoinsot.so.$version soname=libpoinsot.so.${version%%.*} plain=libpoinsot.so
fi
private=$(private_libraries)
make_static
make_shared
[ ! -f "$root/$list" ] || uninstall

put 644 "$scratch/libpoinsot.a" "$libdir/libpoinsot.a"
put 755 "$scratch/$shared" "$libdir/$shared"
link_to "$shared" "$libdir/$soname"
link_to "$soname" "$libdir/$plain"
for file in $stage/include/poinsot*.mod; do put 644 "$file" "include/poinsot/$(basename "$file")"; done
for file in include/poinsot.h include/poinsot_interface.f90; do [ ! -f $file ] || put 644 $file $file; done
filled poinsot.pc
put 644 "$scratch/poinsot.pc" "$libdir/pkgconfig/poinsot.pc"
for file in poinsotConfig.cmake poinsotConfigVersion.cmake; do
   filled $file
   put 644 "$scratch/$file" "$libdir/cmake/poinsot/$file"
done
[ ! -f $stage/bin/poinsot ] || put 755 $stage/bin/poinsot bin/poinsot
[ ! -f docs/poinsot.1 ] || put 644 docs/poinsot.1 share/man/man1/poinsot.1
[ ! -d scenes ] || for file in scenes/*; do put 644 "$file" "share/poinsot/$file"; done
put 644 LICENSE share/poinsot/LICENSE
echo "$list" >>"$scratch/list"
cp "$scratch/list" "$root/$list"
echo "installed under $root: $(grep -vc '/$' "$scratch/list") files"
