#!/bin/sh
# The deep checks: the library and its tests under every tool that this machine has. Each part says what it does, or that it is
# skipped and why. Ends with "N passed, M failed" over the checks of all parts. All of it takes half an hour on two cores.
#
# usage: tools/deep.sh [PART...]      (all parts)
#   sanitize   all suites with address and undefined-behaviour sanitizers
#   valgrind   suites and the C abuse test (leaks too) under valgrind, built for any processor (it does not know AVX-512)
#   threads    a plan shared by threads: thread sanitizer and helgrind, without OpenMP (whose run-time library they do not know)
#   flags      suites at -O0, -O2, -O3, without FMA contraction, without FMA, without AVX-512; the end states of every method,
#              splitting and effect (test/builds/states.f90) against those of the release flags, within its bound
#   coverage   lines of src/ that the suites, the C programs and the app's commands reach, by gcov
#   flang      library and suites by LLVM's Fortran compiler, and its end states against gfortran's
#   fuzz       the fuzzers, INPUTS inputs each
#   rows       a method, a splitting and an effect more, in the middle of their tables, through every command (test/rows.sh)
# Elsewhere: -fcheck=all and -ffpe-trap=invalid,zero,overflow are the checking profile (tools/flags.sh), in which tools/test.sh
# runs every suite; test/installed.sh has the C programs under the sanitizers, memory that ends and processors that are older.
#
# environment: SUITES the suites instead of those a part chooses; INPUTS of each fuzzer (20000); FC, CC, FLANG

set -u
cd "$(dirname "$0")/.." || exit 1
FC=${FC:-gfortran} CC=${CC:-cc}
export FC CC
out=build/deep
mkdir -p $out
passed=0 failed=0
testdrive=build/dependencies/test-drive/src/testdrive.f90
[ -f $testdrive ] || testdrive=tools/testdrive/src/testdrive.f90
libraries="-llapack -lblas -lpthread -lm"
# The app, for tests of the command line.
POINSOT_APP=${POINSOT_APP:-$PWD/build/stage/bin/poinsot}
export POINSOT_APP
every=$(sed -n 's/^ *new_testsuite("\([a-z]*\)", .*/\1/p' test/main.f90 | tr '\n' ' ')
numerical="core rotation body elliptic free rattle effect splitting ensemble hard"
have() { command -v "$1" >/dev/null 2>&1; }
skip() { echo "       ... $1 [SKIPPED] $2"; }
told() { # NAME RESULT LOG
   if [ "$2" = 0 ]; then
      echo "       ... $1 [PASSED]"
      passed=$((passed + 1))
   else
      echo "       ... $1 [FAILED] see $3"
      [ ! -f "$3" ] || grep -E -A 1 'FAILED|ERROR|rror:|SUMMARY|a failure' "$3" | head -n 12
      failed=$((failed + 1))
   fi
}

# compile NAME FLAGS FILE...: objects of library and files into build/deep/NAME, in order
compile() {
   name=$1 flags=$2 folder=$out/$1
   shift 2
   rm -rf "$folder"
   mkdir -p "$folder"
   for file in $(tools/sources.sh "$@"); do
      object=$folder/$(echo "$file" | tr / _).o
      case $file in
      *.c) "$CC" -O1 -g ${c_flags:-} -Iinclude -c "$file" -o "$object" ;;
      *) "$FC" $flags -J "$folder" -c "$file" -o "$object" ;;
      esac >>"$folder/build.log" 2>&1 || { echo "ERROR: $file does not compile" >>"$folder/build.log"; return 1; }
   done
}
# link NAME FLAGS PROGRAM OBJECT...
link() {
   folder=$out/$1 flags=$2 program=$3
   shift 3
   "$FC" $flags "$@" -o "$folder/$program" $(tools/flags.sh link) $libraries >>"$folder/build.log" 2>&1
}
# build NAME FLAGS: build/deep/NAME/check, all suites
build() {
   compile "$1" "$2" $testdrive test/*.f90 && link "$1" "$2" check $out/$1/*.o
}

# suites NAME COMMAND...: run the chosen suites of build NAME with a command in front
suites() {
   name=$1 log=$out/$1.log result=0
   shift
   : >"$log"
   for suite in ${SUITES:-$chosen}; do
      "$@" $out/$name/check $suite >>"$log" 2>&1 || { result=1; echo "ERROR: suite $suite" >>"$log"; }
   done
   told "$name: $(echo ${SUITES:-$chosen})" $result "$log"
}

part_sanitize() {
   # The run-time library keeps memory to the end; exceptions of the tests' own quiet NaN are theirs.
   export ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1 OMP_NUM_THREADS=2
   chosen=$every
   build sanitize "-O1 -g -fopenmp -fsanitize=address,undefined -fno-sanitize-recover=undefined" || {
      told "sanitize: build" 1 $out/sanitize/build.log
      return
   }
   suites sanitize
}

part_valgrind() {
   have valgrind || { skip valgrind "no valgrind"; return; }
   export OMP_NUM_THREADS=1
   chosen="core rotation body ensemble"
   build valgrind "-O1 -g" || { told "valgrind: build" 1 $out/valgrind/build.log; return; }
   suites valgrind valgrind --quiet --error-exitcode=9
   c_program valgrind abuse "-O1 -g" valgrind --quiet --error-exitcode=9 --leak-check=full --errors-for-leak-kinds=definite
}

# c_program BUILD SOURCE FLAGS COMMAND...: test/c/SOURCE.c with the library of a build
c_program() {
   name=$1 source=$2 flags=$3 log=$out/$1.$2.log
   shift 3
   "$CC" -std=c99 $flags -Iinclude -c test/c/$source.c -o $out/$name/$source.o >$log 2>&1 &&
      link $name "$flags" $source $out/$name/$source.o $out/$name/src_*.o && "$@" $out/$name/$source >>$log 2>&1
   told "$name: $source.c" $? $log
}

part_threads() {
   export OMP_NUM_THREADS=1
   c_flags="-fsanitize=thread" compile threads "-O1 -g -fsanitize=thread" || { told "threads: build" 1 $out/threads/build.log; return; }
   c_program threads abuse "-O1 -g -fsanitize=thread" setarch "$(uname -m)" -R
   have valgrind || { skip helgrind "no valgrind"; return; }
   compile helgrind "-O1 -g" || { told "helgrind: build" 1 $out/helgrind/build.log; return; }
   c_program helgrind abuse "-O1 -g" valgrind --tool=helgrind --quiet --error-exitcode=9
}

# states NAME FLAGS FOLDER: build/deep/NAME.states by the library in a folder, and its difference from the release flags'
states() {
   name=$1 flags=$2 folder=$out/$3 log=$out/$1.states.log
   "$FC" $flags -J "$folder" -c test/builds/states.f90 -o "$folder/states.object" >$log 2>&1 &&
      link "$3" "$flags" states "$folder/states.object" "$folder"/src_*.o && "$folder/states" write $out/$name.states >>$log 2>&1
   result=$?
   if [ $result = 0 ] && [ "$name" != reference ]; then
      "$folder/states" compare $out/reference.states $out/$name.states >>$log 2>&1
      result=$?
   fi
   told "$name: $(tail -n 1 $log)" $result $log
}
# The states that others are held against: those of the release flags.
reference() {
   flags=$(tools/flags.sh release)
   compile reference "$flags" || { told "reference: build" 1 $out/reference/build.log; return 1; }
   states reference "$flags" reference
}

part_flags() {
   export OMP_NUM_THREADS=2
   chosen=$numerical
   reference || return
   case $(uname -m) in
   x86_64) variants="O0:-O0 O2:-O2@-march=native O3:-O3@-march=native contract-off:-O3@-march=native@-ffp-contract=off
      no-fma:-O3@-march=native@-mno-fma@-mno-avx512f no-avx512:-O3@-march=native@-mno-avx512f any:-O3" ;;
   *) variants="O0:-O0 O2:-O2 O3:-O3@-mcpu=native contract-off:-O3@-ffp-contract=off" ;;
   esac
   for variant in $variants; do
      flags="$(echo "${variant#*:}" | tr @ ' ') -fopenmp" kind=flags-${variant%%:*}
      build "$kind" "$flags" || { told "$kind: build" 1 "$out/$kind/build.log"; continue; }
      suites "$kind"
      states "$kind" "$flags" "$kind"
      rm -rf "${out:?}/$kind"
   done
}

# reach NAME COMMAND...: one more run for the coverage, which must succeed
reach() {
   what=$1
   shift
   "$@" >$out/coverage.run.log 2>&1
   result=$?
   [ $result = 0 ] || told "coverage: $what" $result $out/coverage.run.log
}

part_coverage() {
   have gcov || { skip coverage "no gcov"; return; }
   export OMP_NUM_THREADS=2
   folder=$out/coverage
   flags="-O0 -g -fopenmp --coverage"
   { c_flags=--coverage compile coverage "$flags" $testdrive test/*.f90 app/*.f90 &&
      link coverage "$flags" check $(ls $folder/*.o | grep -v '/app_') &&
      link coverage "$flags" poinsot $folder/src_*.o $folder/app_*.o; } ||
      { told "coverage: build" 1 $folder/build.log; return; }
   POINSOT_APP=$PWD/$folder/poinsot
   chosen=$(echo "$every" | sed 's/choose //')
   suites coverage
   $folder/check choose >$out/coverage.choose.log 2>&1 # not judged: it has budgets by the clock, and this build is slow
   for source in test/c/abuse.c test/consumer/consumer.c example/c/heavy_top.c example/fixed/molecules.f \
      example/fortran/heavy_top.f90 test/consumer/consumer.f90; do
      object=$folder/$(basename $source)
      case $source in
      *.c) "$CC" -g -Iinclude -c $source -o $object.object ;;
      *) "$FC" -g -I $folder -c $source -o $object.object ;;
      esac && link coverage "$flags" $(basename $source).run $object.object $folder/src_*.o
      reach $source $object.run
   done
   app="$folder/poinsot"
   results=$folder/out
   printf '%s\n' name,setting,angle,worst,momentum,worst,ns euler,0.1,1e-2,2e-2,1e-2,2e-2,50 >$out/rivals.csv
   reach cost $app cost heavy-top --budget 6s --methods exact,dmv6 --splittings strang,srkn4 --no-pictures --out $results/cost \
      --rivals $out/rivals.csv
   reach choose $app choose heavy-top --tol 1e-4 --budget 20s --out $results/chosen.nml
   for command in keys methods splittings effects scenes "hard --out $results/hard" "properties --out $results/properties" \
      "reproduce review --no-pictures --out $results/review"; do
      reach "${command%% *}" $app $command
   done
   reach hairer $app reproduce hairer-vilmart --no-pictures --out $results/hairer
   reach fasso $app reproduce fasso --no-pictures --out $results/fasso
   reach celledoni $app reproduce celledoni --budget 6s --no-pictures --out $results/celledoni
   for scene in $(ls scenes | sed 's/\.nml$//'); do
      [ "$scene" = large-ensemble ] || reach "$scene" $app run "$scene" --no-pictures --out $results/$scene
   done
   POINSOT_APP=$PWD/build/stage/bin/poinsot
   (cd $folder && gcov -n $(ls src_*.gcda)) 2>/dev/null >$out/coverage.txt
   awk '/^File/ { name = $2; mine = /src\// }
        mine && /^Lines executed/ { split($2, p, /[:%]/); print p[2], substr($4, 1), name; mine = 0 }' $out/coverage.txt | sort -n >$out/coverage.files
   awk '{ n += $2; hit += $1*$2/100 } END { printf "coverage: %.1f %% of %d lines of src/; least:\n", 100*hit/n, n; exit !(n > 0 && hit > 0.92*n) }' \
      $out/coverage.files
   result=$?
   head -n 10 $out/coverage.files | awk '{ print "   " $1 " % of " $2 " lines of " $3 }'
   told "coverage: 92 %" $result $out/coverage.files
}

# The newest of LLVM's Fortran compilers. Version 16 cannot compile this library; 22 can.
newest_flang() {
   for it in ${FLANG:-} flang-new-24 flang-24 flang-23 flang-22 flang-21 flang-20 flang; do
      if have "$it" && "$it" --version 2>/dev/null | grep -q 'flang.* version \(19\|[2-9][0-9]\)'; then echo "$it"; return; fi
   done
}
part_flang() {
   flang=$(newest_flang)
   [ -n "$flang" ] || { skip flang "no flang of version 19 or newer (Debian: flang-22 libomp-22-dev, by tools/setup.sh deep)"; return; }
   echo "$("$flang" --version | head -n 1)"
   [ -f $out/reference.states ] || reference || return
   export OMP_NUM_THREADS=2
   openmp=-fopenmp
   printf 'end\n' >$out/try.f90
   "$flang" -fopenmp $out/try.f90 -o $out/try >/dev/null 2>&1 || openmp=
   # Where its run-time library lacks functions of long arguments: from gcc's libquadmath.
   long=
   printf 'real(selected_real_kind(18)) :: x\nread *, x\nprint *, sin(x), log(x)**x\nend\n' >$out/try.f90
   if ! "$flang" $out/try.f90 -o $out/try >/dev/null 2>&1; then
      gcc -O1 -c tools/flang_long.c -o $out/flang_long.o && long="$PWD/$out/flang_long.o $(gcc -print-file-name=libquadmath.a)"
   fi
   libraries_before=$libraries compiler=$FC
   libraries="$libraries $long" FC=$flang
   if build flang "-O2 $openmp"; then
      # The other suites measure against quadruple precision.
      chosen="core rotation body elliptic rattle drift effect splitting ensemble scene choose"
      suites flang
      states flang "-O2 $openmp" flang
   else
      told "flang: build" 1 $out/flang/build.log
   fi
   libraries=$libraries_before FC=$compiler
}

part_fuzz() {
   tools/fuzz.sh all "${INPUTS:-20000}" >$out/fuzz.log 2>&1
   result=$?
   told "fuzz: $(awk '/inputs,.*crashes/ { n += $3; c += $5 } END { print n + 0, "inputs,", c + 0, "crashes" }' $out/fuzz.log)" \
      $result $out/fuzz.log
}

part_rows() {
   test/rows.sh >$out/rows.log 2>&1
   result=$?
   told "rows: $(tail -n 1 $out/rows.log)" $result $out/rows.log
}

for part in ${*:-sanitize valgrind threads flags coverage flang fuzz rows}; do
   case $part in
   sanitize | valgrind | threads | flags | coverage | flang | fuzz | rows) ;;
   *) echo "usage: tools/deep.sh [sanitize valgrind threads flags coverage flang fuzz rows]" >&2; exit 2 ;;
   esac
   begun=$(date +%s)
   echo "deep: $part"
   part_$part
   echo "deep: $part took $(($(date +%s) - begun)) s"
done
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
