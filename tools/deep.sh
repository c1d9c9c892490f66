#!/bin/sh
# The deep checks: the library and its tests under every tool that this machine has. Each part says what it does, or that it is
# skipped and why. Ends with "N passed, M failed" over the parts.
#
# usage: tools/deep.sh [PART...]      (all parts)
#   sanitize   all suites with address and undefined-behaviour sanitizers
#   valgrind   suites and the C abuse test under valgrind, built for any processor (it does not know AVX-512)
#   threads    a plan shared by threads: thread sanitizer and helgrind, without OpenMP (whose run-time library they do not know)
#   flags      suites at -O0, -O2, -O3, without FMA contraction, without FMA, without AVX-512: within the bounds of the tests
#   coverage   lines of src/ that the suites and the app reach, by gcov
#   flang      how many sources LLVM's Fortran compiler takes
#   fuzz       the fuzzers, 20000 inputs each
# environment: SUITES the suites instead of those a part chooses; FC, CC

set -u
cd "$(dirname "$0")/.." || exit 1
FC=${FC:-gfortran} CC=${CC:-cc}
out=build/deep
mkdir -p $out
passed=0 failed=0
testdrive=build/dependencies/test-drive/src/testdrive.f90
[ -f $testdrive ] || testdrive=tools/testdrive/src/testdrive.f90
# The app, for tests of the command line.
POINSOT_APP=$PWD/build/stage/bin/poinsot
export POINSOT_APP
have() { command -v "$1" >/dev/null 2>&1; }
skip() { echo "       ... $1 [SKIPPED] $2"; }
told() { # NAME RESULT LOG
   if [ "$2" = 0 ]; then
      echo "       ... $1 [PASSED]"
      passed=$((passed + 1))
   else
      echo "       ... $1 [FAILED] see $3"
      grep -E -A 1 'FAILED|ERROR|runtime error|SUMMARY|^Error' "$3" | head -n 12
      failed=$((failed + 1))
   fi
}

# build NAME FLAGS [files]: objects of library and tests, and build/deep/NAME/check
build() {
   name=$1 flags=$2 folder=$out/$1
   rm -rf "$folder"
   mkdir -p "$folder"
   tests=$(ls test/*.f90)
   for file in $(tools/sources.sh $testdrive $tests); do
      object=$folder/$(echo "$file" | tr / _).o
      case $file in
      *.c) "$CC" -O1 -g ${c_flags:-} -Iinclude -c "$file" -o "$object" ;;
      *) "$FC" $flags -J "$folder" -c "$file" -o "$object" ;;
      esac >>"$folder/build.log" 2>&1 || { echo "$file does not compile" >>"$folder/build.log"; return 1; }
   done
   "$FC" $flags "$folder"/*.o -o "$folder/check" $(tools/flags.sh link) -llapack -lblas >>"$folder/build.log" 2>&1
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
every=$(sed -n 's/^ *new_testsuite("\([a-z]*\)", .*/\1/p' test/main.f90 | tr '\n' ' ')
numerical="core rotation body elliptic free rattle effect splitting ensemble hard"

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
   c_program valgrind abuse "-O1 -g" valgrind --quiet --error-exitcode=9
}

# c_program BUILD SOURCE FLAGS COMMAND...: test/c/SOURCE.c with the library of a build
c_program() {
   name=$1 source=$2 flags=$3
   shift 3
   "$CC" -std=c99 $flags -Iinclude -c test/c/$source.c -o $out/$name.$source.o &&
      "$FC" $flags $out/$name.$source.o $(ls $out/$name/src_*.o) -o $out/$name.$source $(tools/flags.sh link) -llapack -lblas -lpthread \
         >$out/$name.$source.log 2>&1 && "$@" $out/$name.$source >>$out/$name.$source.log 2>&1
   told "$name: $source.c" $? $out/$name.$source.log
}

part_threads() {
   export OMP_NUM_THREADS=1
   c_flags="-fsanitize=thread" build threads "-O1 -g -fsanitize=thread" || { told "threads: build" 1 $out/threads/build.log; return; }
   c_program threads abuse "-O1 -g -fsanitize=thread" setarch "$(uname -m)" -R
   have valgrind || { skip helgrind "no valgrind"; return; }
   [ -d $out/valgrind ] || build valgrind "-O1 -g" || return
   c_program valgrind abuse "-O1 -g" valgrind --tool=helgrind --quiet --error-exitcode=9
}

part_flags() {
   export OMP_NUM_THREADS=2
   chosen=$numerical
   case $(uname -m) in
   x86_64) variants="O0:-O0 O2:-O2@-march=native O3:-O3@-march=native contract-off:-O3@-march=native@-ffp-contract=off
      no-fma:-O3@-march=native@-mno-fma@-mno-avx512f no-avx512:-O3@-march=native@-mno-avx512f any:-O3" ;;
   *) variants="O0:-O0 O2:-O2 O3:-O3@-mcpu=native contract-off:-O3@-ffp-contract=off" ;;
   esac
   for variant in $variants; do
      build "flags-${variant%%:*}" "$(echo "${variant#*:}" | tr @ ' ') -fopenmp" || {
         told "flags-${variant%%:*}: build" 1 "$out/flags-${variant%%:*}/build.log"
         continue
      }
      suites "flags-${variant%%:*}"
      rm -rf "$out/flags-${variant%%:*}"
   done
}

part_coverage() {
   have gcov || { skip coverage "no gcov"; return; }
   export OMP_NUM_THREADS=2
   chosen=$every
   c_flags=--coverage build coverage "-O0 -g -fopenmp --coverage" || { told "coverage: build" 1 $out/coverage/build.log; return; }
   suites coverage
   (cd $out/coverage && "$CC" --coverage -g -I../../../include -c ../../../test/c/abuse.c -o abuse.o &&
      "$FC" --coverage -fopenmp $(ls src_*.o) abuse.o -o abuse -llapack -lblas -lpthread && ./abuse) >$out/coverage.abuse.log 2>&1
   (cd $out/coverage && gcov -n $(ls src_*.gcda)) 2>/dev/null |
      awk '/^File/ { mine = /src\// } mine && /^Lines executed/ { split($2, p, /[:%]/); file = f; n += $4; hit += p[2]*$4/100; mine = 0 }
           END { printf "coverage: %.1f %% of %d lines of src/\n", 100*hit/n, n; exit !(n > 0) }'
   (cd $out/coverage && gcov -n $(ls src_*.gcda)) 2>/dev/null |
      awk '/^File/ { name = $2; mine = /src\// } mine && /^Lines executed/ { split($2, p, /[:%]/); if (p[2] < 80) print "   " p[2] " % of", $4, name; mine = 0 }' |
      sort -n | head -n 12
}

part_flang() {
   compiler=
   for it in flang-new flang-new-20 flang-new-19 flang-new-18 flang-new-17 flang-new-16 flang; do
      if have $it; then compiler=$it; break; fi
   done
   [ -n "$compiler" ] || { skip flang "no flang"; return; }
   rm -rf $out/flang
   mkdir -p $out/flang
   good=0 all=0
   for file in $(tools/sources.sh); do
      case $file in *.c) continue ;; esac
      all=$((all + 1))
      # before version 17 it does not know implicit none(external)
      sed 's/implicit none(type, external)/implicit none/' "$file" >$out/flang/source.f90
      if (cd $out/flang && timeout 120 $compiler -O1 -c source.f90 -o "$(echo "$file" | tr / _).o") >>$out/flang/log 2>&1; then
         good=$((good + 1))
      else
         echo "$file" >>$out/flang/refused
      fi
   done
   echo "flang: $("$compiler" --version | head -n 1): $good of $all sources compile$([ -f $out/flang/refused ] && echo "; not: $(tr '\n' ' ' <$out/flang/refused)")"
   grep -h 'not yet implemented' $out/flang/log | sed 's/.*not yet/not yet/' | sort | uniq -c
}

part_fuzz() {
   tools/fuzz.sh all 20000 >$out/fuzz.log 2>&1
   told "fuzz: $(grep -c PASSED $out/fuzz.log) of 3 targets" $? $out/fuzz.log
}

for part in ${*:-sanitize valgrind threads flags coverage flang fuzz}; do
   case $part in
   sanitize | valgrind | threads | flags | coverage | flang | fuzz) echo "deep: $part"; part_$part ;;
   *) echo "usage: tools/deep.sh [sanitize valgrind threads flags coverage flang fuzz]" >&2; exit 2 ;;
   esac
done
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
