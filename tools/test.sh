#!/bin/sh
# Build and run the tests in the release and in the checking profile, then those of the installed library and app.
# The last line is "N passed, M failed" over all of them; the exit code is non-zero on a failure or when no test ran.
#
# usage: tools/test.sh [--deep] [SUITE [TEST]]       with a SUITE: the suites only, not the installed library
# environment: PROFILES the profiles ("release checking"); FC, PORTABLE, EXTRA_FLAGS as in tools/flags.sh; BUILD (build);
# FUZZ=no leaves out the fuzzers

set -u
cd "$(dirname "$0")/.." || exit 1
FC=${FC:-gfortran} BUILD=${BUILD:-build}
case $BUILD in /*) POINSOT_APP=$BUILD/stage/bin/poinsot ;; *) POINSOT_APP=$PWD/$BUILD/stage/bin/poinsot ;; esac
export FC BUILD POINSOT_APP # the app for tests of the command line
passed=0 failed=0 empty=0
mkdir -p "$BUILD/log"

# Run a command and show what it says; add up its lines "N passed, M failed". One that stops without such a line, or with
# an exit code that its count does not explain, is one more failure, beside the tests it reported before.
counted() {
   log=$BUILD/log/$1.log
   shift
   { "$@" 2>&1; echo $? >"$log.code"; } | tee "$log"
   code=$(cat "$log.code")
   set -- $(awk '
      /^[0-9]+ passed, [0-9]+ failed$/ { passed += $1; failed += $3; open_passed = open_failed = 0; closed = 1; next }
      / \[(PASSED|EXPECTED FAIL)\]$/ { open_passed++ }
      / \[(FAILED|UNEXPECTED PASS)\]$/ { open_failed++ }
      END { print passed + open_passed, failed + open_failed, closed + 0 }' "$log")
   passed=$((passed + $1)) failed=$((failed + $2))
   if [ "$3" = 1 ] && [ "$1$2" = 00 ]; then
      empty=1
   elif [ "$3" = 0 ] || { [ "$code" != 0 ] && [ "$2" = 0 ]; }; then
      echo "stopped before its end (exit code $code), in or after the last test above: counted as one failure"
      failed=$((failed + 1))
   fi
}

suites() { tools/build.sh tests "$1" && tools/build.sh run "$@"; }

arguments=$*
for profile in ${PROFILES:-release checking}; do
   skip= # derivatives in quadruple precision, a third of the time: once is enough
   [ "$profile" = release ] || skip="--without properties"
   printf '\n=== tests, %s profile: %s\n' "$profile" "$(tools/flags.sh "$profile")"
   # shellcheck disable=SC2086 # words
   counted "$profile" suites "$profile" $skip $arguments
done
if [ -z "$arguments" ] && [ -x test/installed.sh ]; then
   printf '\n=== tests of the installed library and app\n'
   counted installed test/installed.sh
fi
if [ -z "$arguments" ]; then
   printf '\n=== rows that describe themselves, in a copy of the sources\n'
   counted rows test/rows.sh quick
fi
if [ -z "$arguments" ] && [ "${FUZZ:-yes}" != no ]; then
   printf '\n=== fuzzers, a short run\n'
   if tools/fuzz.sh probe; then counted fuzz tools/fuzz.sh all 1500; else echo "       ... fuzz [SKIPPED] no sanitizers"; fi
fi

printf '\n%d passed, %d failed\n' $passed $failed
[ $failed -eq 0 ] && [ $passed -gt 0 ] && [ $empty = 0 ]
