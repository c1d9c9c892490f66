#!/bin/sh
# Build the fuzzer (test/fuzz) with address and undefined-behaviour sanitizers and run it.
#
# usage: tools/fuzz.sh [scene | restart | abi | all | probe] [INPUTS [SEED]]      (all, 20000 inputs, seed 1)
# environment: FC, CC; FUZZ_FLAGS instead of the sanitizers' flags
#
# What an earlier run found, test/fuzz/found/TARGET-*, runs first. Ends with "N passed, M failed": a target passes if no input crashed, hung or broke a promise. Inputs that did are kept in
# build/fuzz/crash-*; `build/fuzz/fuzz TARGET --runs 0 FILE` runs one again.

set -u
cd "$(dirname "$0")/.." || exit 1
FC=${FC:-gfortran} CC=${CC:-cc}
targets=${1:-all} inputs=${2:-20000} seed=${3:-1}
[ "$targets" = all ] && targets="scene restart abi"
flags=${FUZZ_FLAGS:--O1 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer}
BUILD=${BUILD:-build}
out=$BUILD/fuzz
mkdir -p $out/objects

# The library anew if a source is younger than it; then the fuzzer itself.
build() {
   newest=$(ls -t src/*.f90 src/*/*.f90 src/api/*.c test/fuzz/entry.f90 | head -n 1)
   if ! [ $out/library -nt "$newest" ]; then
      covered="$flags -fsanitize-coverage=trace-pc"
      "$FC" $covered -J $out -c src/core/kinds.f90 -o $out/try.o 2>/dev/null || covered=$flags
      rm -f $out/objects/*
      for file in $(tools/sources.sh) test/fuzz/entry.f90; do
         object=$out/objects/$(echo "$file" | tr / _).o
         case $file in
         *.c) "$CC" $flags -Iinclude -c "$file" -o "$object" || return 1 ;;
         *) "$FC" $covered -fopenmp -J $out/objects -c "$file" -o "$object" || return 1 ;;
         esac
      done
      echo "$flags" >$out/library
   fi
   for file in driver abi; do
      "$CC" -O1 -g -fsanitize=address -Iinclude -Wall -Wextra -c test/fuzz/$file.c -o $out/objects/$file.o || return 1
   done
   "$FC" $flags -fopenmp $out/objects/*.o -o $out/fuzz $(tools/flags.sh link) -llapack -lblas -lm
}

if [ "$targets" = probe ]; then # can sanitized programs be built and run here?
   printf 'end\n' >$out/try.f90
   "$FC" $flags $out/try.f90 -o $out/try >/dev/null 2>&1 && $out/try
   exit
fi
build >$out/build.log 2>&1 || { tail -n 20 $out/build.log; echo "0 passed, 1 failed"; exit 1; }
passed=0 failed=0
# Memory that the compiler's run-time library keeps is no leak of ours; a number of an input that no memory holds is refused.
export ASAN_OPTIONS="detect_leaks=0:allocator_may_return_null=1:handle_sigfpe=1:${ASAN_OPTIONS:-}"
export UBSAN_OPTIONS="print_stacktrace=1:${UBSAN_OPTIONS:-}" OMP_NUM_THREADS=1
for target in $targets; do
   files=
   [ $target = scene ] && files=$(ls scenes/*.nml test/fuzz/seeds/*.nml 2>/dev/null)
   found=$(ls test/fuzz/found/$target-* 2>/dev/null)
   if { [ -z "$found" ] || $out/fuzz $target --runs 0 --out $out $found >$out/$target.log 2>&1; } &&
      $out/fuzz $target --runs "$inputs" --seed "$seed" --out $out $files >$out/$target.log 2>&1; then
      echo "       ... fuzz-$target [PASSED]"
      passed=$((passed + 1))
   else
      echo "       ... fuzz-$target [FAILED]"
      grep -E 'ERROR|runtime error|abi:|fuzz:|Error|SUMMARY' $out/$target.log | sort | uniq -c | sort -rn | head -n 20
      failed=$((failed + 1))
   fi
   tail -n 2 $out/$target.log
done
echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
