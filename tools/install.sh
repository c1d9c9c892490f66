#!/bin/sh
# Install what `make build` left in build/stage, or remove exactly what was installed.
#
# usage: tools/install.sh install | uninstall PREFIX [DESTDIR [LIBDIR [MODDIR]]]
#
# LIBDIR (lib) and MODDIR, of .mod files (include/poinsot), are under PREFIX, or absolute paths. A list of what was installed goes
# into PREFIX/share/poinsot/installed.txt; uninstall, and installing anew, removes what stands there; but the shared library of
# another series stays when a new one comes, for the programs that use it. The files can be moved together: nothing in them names
# PREFIX, unless LIBDIR or MODDIR lie outside of it. CMake installs the same: tools/install/rules.cmake.

set -eu
cd "$(dirname "$0")/.."
action=${1:?install or uninstall} prefix=${2:?PREFIX}
destdir=${3:-} libdir=${4:-lib} moddir=${5:-include/poinsot}
stop() { echo "install: $*" >&2; exit 1; }
case $prefix in /*) ;; *) prefix=$PWD/$prefix ;; esac
root=$destdir$prefix
libdir=${libdir#"$prefix"/} moddir=${moddir#"$prefix"/}
list=share/poinsot/installed.txt
BUILD=${BUILD:-build}
stage=$BUILD/stage
FC=${FC:-gfortran}

# Remove what the list names, last first: files, and folders (they end in /) if nothing else is in them.
uninstall() {
   sed '1!G;h;$!d' "$root/$list" >"$scratch/removal"
   while IFS= read -r it; do
      case $it in
      */) rmdir "$(place "$it")" 2>/dev/null || true ;;
      *) rm -f "$(place "$it")" ;;
      esac
   done <"$scratch/removal"
}

# Where a path of the list is: under PREFIX, or absolute; both under DESTDIR.
place() { case $1 in /*) echo "$destdir$1" ;; *) echo "$root/$1" ;; esac; }

# Make a folder; those that were not there before go into the list.
folder() {
   [ ! -d "$(place "$1")" ] || return 0
   case ${1#/} in */*) folder "${1%/*}" ;; esac
   mkdir "$(place "$1")"
   echo "$1/" >>"$scratch/list"
}

# put MODE SOURCE TARGET: one file to PREFIX/TARGET, and into the list.
put() {
   folder "${3%/*}"
   rm -f "$(place "$3")"
   cp "$2" "$(place "$3")"
   chmod "$1" "$(place "$3")"
   echo "$3" >>"$scratch/list"
}

# link_to WHAT TARGET: a symbolic link.
link_to() {
   rm -f "$(place "$2")"
   ln -s "$1" "$(place "$2")"
   echo "$2" >>"$scratch/list"
}

# from VARIABLE FOLDER: a folder of the installation, from the prefix unless it is absolute.
from() { case $2 in /*) echo "$2" ;; *) echo "\${$1}/$2" ;; esac; }

# filled TEMPLATE: the template with its @NAMES@ replaced.
filled() {
   case $libdir in
   /*) pc_prefix=$prefix cmake_prefix=$prefix ;;
   *) up=$(echo "$libdir" | sed 's,[^/][^/]*,..,g')
      pc_prefix="\${pcfiledir}/../$up" cmake_prefix="\${CMAKE_CURRENT_LIST_DIR}/../../$up" ;;
   esac
   sed "s|@PC_PREFIX@|$pc_prefix|g; s|@CMAKE_PREFIX@|$cmake_prefix|g
        s|@PC_INCLUDE@|$(from prefix include)|g; s|@CMAKE_INCLUDE@|$(from _poinsot_prefix include)|g
        s|@PC_MODULES@|$(from prefix "$moddir")|g; s|@CMAKE_MODULES@|$(from _poinsot_prefix "$moddir")|g
        s|@VERSION@|$version|g; s|@PRIVATE@|$private|g; s|@SHARED@|$shared|g; s|@SONAME@|$soname|g
        s|@PRIVATE_LIST@|$(echo $private | tr ' ' ';')|g; s|@SERIES@|${version%.*}|g; s|@MAJOR@|${version%%.*}|g
        s|@POINTER@|$(($(getconf LONG_BIT) / 8))|g" "tools/install/$1.in" >"$scratch/$1"
}

# The static library: what fpm made, without the app's rooms and without what fpm puts there too (test-drive).
make_static() {
   cp $stage/lib/libpoinsot.a "$scratch/libpoinsot.a"
   others=$(ar t "$scratch/libpoinsot.a" | grep '^build_dependencies_\|^src_scene_\|^src_study_' || true)
   [ -z "$others" ] || ar d "$scratch/libpoinsot.a" $others
   ar s "$scratch/libpoinsot.a"
}

# The shared library: all objects of the static one, with LAPACK, the OpenMP and the Fortran runtime linked in by name, so
# that dlopen from a program that has none of them works. It exports what tools/exports.sh says, and stays where it is when it
# is closed: OpenMP's threads would go on in code that is gone.
make_shared() {
   set -- $(tools/flags.sh link) -fopenmp -llapack -lblas
   if [ "$(uname)" = Darwin ]; then
      tools/exports.sh list >"$scratch/exports"
      "$FC" -dynamiclib -o "$scratch/$shared" -Wl,-install_name,@rpath/$soname -Wl,-force_load,"$scratch/libpoinsot.a" \
         -Wl,-dead_strip -Wl,-exported_symbols_list,"$scratch/exports" "$@"
   else
      tools/exports.sh map >"$scratch/exports"
      "$FC" -shared -o "$scratch/$shared" -Wl,-soname,$soname -Wl,--whole-archive "$scratch/libpoinsot.a" \
         -Wl,--no-whole-archive -Wl,--no-undefined -Wl,-z,noexecstack -Wl,-z,nodelete -Wl,--gc-sections \
         -Wl,--version-script="$scratch/exports" "$@"
   fi
}

# What a program needs beside libpoinsot.a. Not where a compiler keeps its own libraries: another version may be there tomorrow.
private_libraries() {
   quadmath=-lquadmath
   printf 'end\n' >"$scratch/try.f90"
   "$FC" "$scratch/try.f90" -lquadmath -o "$scratch/try" 2>/dev/null || quadmath=
   echo $(tools/flags.sh link | tr ' ' '\n' | grep '^-L' || true) -llapack -lblas -lgfortran -lgomp $quadmath -lm
}

# The .mod files that a program opens which uses the public modules: gfortran writes all they need into their own.
modules() {
   case $("$FC" --version 2>/dev/null) in
   *GNU*) for it in $(tools/exports.sh modules); do echo "$stage/include/$it.mod"; done ;;
   *) ls $stage/include/poinsot*.mod | grep -v '/poinsot_\(scene\|study\)_' ;;
   esac
}

# What fpm built.
put_each() {
   put 644 "$scratch/libpoinsot.a" "$libdir/libpoinsot.a"
   put 755 "$scratch/$shared" "$libdir/$shared"
   link_to "$shared" "$libdir/$soname"
   link_to "$soname" "$libdir/$plain"
   for file in $(modules); do put 644 "$file" "$moddir/$(basename "$file")"; done
   for file in include/*; do put 644 "$file" "$file"; done
   tools/install/cdef.sh >"$scratch/poinsot_cdef.h"
   put 644 "$scratch/poinsot_cdef.h" include/poinsot_cdef.h
   filled poinsot.pc
   put 644 "$scratch/poinsot.pc" "$libdir/pkgconfig/poinsot.pc"
   for file in poinsotConfig.cmake poinsotConfigVersion.cmake; do
      filled $file
      put 644 "$scratch/$file" "$libdir/cmake/poinsot/$file"
   done
   put 755 $stage/bin/poinsot bin/poinsot
   put 644 docs/poinsot.1 share/man/man1/poinsot.1
   for file in scenes/*; do put 644 "$file" "share/poinsot/$file"; done
   find share -type f 2>/dev/null | sort >"$scratch/share"
   while IFS= read -r file; do put 644 "$file" "$file"; done <"$scratch/share"
   put 644 LICENSE share/poinsot/LICENSE
}

# What CMake built: installed by its own rules (tools/install/rules.cmake) into a folder here, and put from there.
from_cmake() {
   cmake -S . -B "$BUILD/cmake" -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_INSTALL_LIBDIR="$libdir" -DPOINSOT_MODDIR="$moddir" \
      >"$scratch/log" 2>&1 && DESTDIR=$scratch/tree cmake --install "$BUILD/cmake" >"$scratch/log" 2>&1 ||
      { cat "$scratch/log" >&2; stop "CMake could not install"; }
}
put_tree() {
   (cd "$scratch/tree" && find . ! -type d | sed 's/^\.//' | sort) >"$scratch/files"
   while IFS= read -r file; do
      from=$scratch/tree$file
      if [ -h "$from" ]; then
         folder "$(dirname "${file#"$prefix"/}")"
         link_to "$(readlink "$from")" "${file#"$prefix"/}"
      elif [ -x "$from" ]; then put 755 "$from" "${file#"$prefix"/}"
      else put 644 "$from" "${file#"$prefix"/}"
      fi
   done <"$scratch/files"
}

# What a shell needs to find it all; nothing where the system looks anyway, once ldconfig has seen the library.
hints() {
   case $libdir in /*) lib=$libdir ;; *) lib=$prefix/$libdir ;; esac
   : >"$scratch/hints"
   hint() { case :$3: in *:$2:*) ;; *) echo "   export $1=\"$2\${$1:+:\$$1}\"" >>"$scratch/hints" ;; esac; }
   hint PATH "$prefix/bin" "$PATH"
   hint PKG_CONFIG_PATH "$lib/pkgconfig" "${PKG_CONFIG_PATH:-}:$(pkg-config --variable pc_path pkg-config 2>/dev/null)"
   case $prefix in /usr | /usr/local) ;; *) hint CMAKE_PREFIX_PATH "$prefix" "${CMAKE_PREFIX_PATH:-}" ;; esac
   known=$(PATH=$PATH:/sbin:/usr/sbin ldconfig -v -N 2>/dev/null | sed -n 's,^\(/[^:]*\):.*,\1,p' | tr '\n' ':')
   case :$known in
   *:$lib:*)
      if [ "$(id -u)" = 0 ] && PATH=$PATH:/sbin:/usr/sbin ldconfig 2>/dev/null; then
         echo "ldconfig has been run: programs find the library"
      else
         echo "run 'ldconfig' as root once, so that programs find the library"
      fi ;;
   *) [ "$(uname)" = Darwin ] || hint LD_LIBRARY_PATH "$lib" "${LD_LIBRARY_PATH:-}" ;;
   esac
   [ ! -s "$scratch/hints" ] || { echo "for this prefix, in the shell:"; cat "$scratch/hints"; }
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
[ -f "$stage/lib/libpoinsot.a" ] || stop "no $stage/lib/libpoinsot.a: run make build first"
mkdir -p "$root" 2>/dev/null && [ -w "$root" ] || stop "no permission to write to $root: choose another PREFIX="

version=$(sed -n 's/^version = "\(.*\)"/\1/p' fpm.toml)
if [ "$(uname)" = Darwin ]; then
   shared=libpoinsot.$version.dylib soname=libpoinsot.${version%.*}.dylib plain=libpoinsot.dylib
else
   shared=libpoinsot.so.$version soname=libpoinsot.so.${version%.*} plain=libpoinsot.so
fi
builder=$(cat "$BUILD/builder" 2>/dev/null) || builder=fpm
if [ "$builder" = cmake ]; then
   from_cmake
else
   private=$(private_libraries)
   make_static
   make_shared
fi
kept=
if [ -f "$root/$list" ]; then
   cp "$root/$list" "$scratch/before"
   kept=$(grep 'libpoinsot\.\(so\.\|[0-9].*dylib\)' "$root/$list" | grep -v "$soname" || true)
   [ -z "$kept" ] || { grep -vxF "$kept" "$root/$list" >"$scratch/rest" && cp "$scratch/rest" "$root/$list"; }
   uninstall
   sed -n '/\/$/p' "$scratch/before" | while IFS= read -r it; do [ ! -d "$(place "$it")" ] || echo "$it"; done >>"$scratch/list"
fi
if [ "$builder" = cmake ]; then put_tree; else put_each; fi
[ -z "$kept" ] || echo "$kept" >>"$scratch/list"
folder share/poinsot
echo "$list" >>"$scratch/list"
cp "$scratch/list" "$root/$list"
echo "installed under $root: $(grep -vc '/$' "$scratch/list") files"
[ -n "$destdir" ] || hints
