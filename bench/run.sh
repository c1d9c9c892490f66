#!/bin/sh
# Measure: what a step of every method costs and how wrong it is, beside what other codes do, on this machine.
#
# usage: bench/run.sh [--quick | --doc]     --quick: 20 seconds instead of four minutes
#                                           --doc: put the report into docs/performance.md
# environment: FC the compiler (gfortran), CC (cc), PORTABLE and EXTRA_FLAGS as in tools/flags.sh
#
# Needs what `make build` leaves in build/stage; leaves report.txt and *.csv in build/bench.

set -u
cd "$(dirname "$0")/.." || exit 1
FC=${FC:-gfortran}
CC=${CC:-cc}
export FC
stage=build/stage
out=build/bench
flags=$(tools/flags.sh release)
libraries="$stage/lib/libpoinsot.a $(tools/flags.sh link) -llapack -lblas"
quick=
plain_drift=68.0          # instructions a body of a drift that uses no member of the view but y and q: it shall stay within 1 %
OMP_WAIT_POLICY=passive # a thread that waits must not cost processor time
OMP_PROC_BIND=true        # two threads on two processors, also while another program has one of them
export OMP_WAIT_POLICY OMP_PROC_BIND
[ "${1:-}" != --quick ] || quick=--quick

have() { command -v "$1" >/dev/null 2>&1; }

compile() { "$FC" $flags -I $stage/include -J $out -c "bench/$1" -o "$out/$1.o" || exit 1; }

machine() {
   echo "poinsot benchmark, $(date -u '+%Y-%m-%d %H:%M UTC')$(git rev-parse --short HEAD 2>/dev/null | sed 's/^/, commit /')"
   if [ -r /proc/cpuinfo ]; then
      echo "processor: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1), $(grep -c '^processor' /proc/cpuinfo) in use here$(
         grep -qw avx512f /proc/cpuinfo && echo ', AVX-512')"
      echo "load before the start: $(cut -d' ' -f1-3 /proc/loadavg)"
   else
      echo "processor: $(sysctl -n machdep.cpu.brand_string 2>/dev/null || uname -m)"
   fi
   echo "system: $(uname -srm)"
   echo "compiler: $("$FC" --version | head -n 1)"
   echo "flags: $flags"
   "$stage/bin/poinsot" --version | sed -n 's/^level: *\|^ *\(not optimised\)/level of processor: \1/p'
   echo "processor time, but table 5 by the wall; in brackets the minimum"
}

[ -f $stage/lib/libpoinsot.a ] || { echo "bench/run.sh: run 'make build' first" >&2; exit 1; }
mkdir -p $out
rm -f $out/*.csv $out/report.txt

for file in runge_kutta yardsticks measure tasks effect_plans kernels; do compile $file.f90; done
objects=
for file in runge_kutta yardsticks measure tasks effect_plans kernels; do objects="$objects $out/$file.f90.o"; done
compile bench.f90
"$FC" $flags $objects $out/bench.f90.o $libraries -o $out/bench || exit 1

elliptic() {
   [ -f $stage/include/poinsot_elliptic_jacobi.mod ] || return 0
   gsl=
   printf 'int main(void){return 0;}\n' >$out/try.c
   if have "$CC" && "$CC" $out/try.c -lgsl -lgslcblas -o $out/try 2>/dev/null; then gsl="-lgsl -lgslcblas"; fi
   "$FC" $flags ${gsl:+-DHAVE_GSL} -cpp -I $stage/include -J $out $objects bench/elliptic.F90 $libraries $gsl -o $out/elliptic &&
      $out/elliptic $quick $out
}

# Instructions, where single steps or counters can be had; the counts do not depend on what else the machine does.
instructions() {
   have "$CC" && have objdump && [ "$(uname -sm)" = "Linux x86_64" ] || return 0
   compile counted.f90
   "$CC" -O2 -c bench/mark.c -o $out/mark.o && "$CC" -O2 bench/stepper.c -o $out/stepper || return 0
   "$FC" $flags -no-pie $objects $out/mark.o $out/counted.f90.o $libraries -o $out/counted || return 0
   $out/stepper $out/counted $out >$out/steps.txt || { echo "8. instructions: single steps are not permitted here"; return 0; }
   objdump -d --no-show-raw-insn $out/counted >$out/counted.s
   awk -f bench/mix.awk $out/regions.txt $out/counted.s $out/steps.txt >$out/instructions.csv
   awk -v functions=1 -f bench/mix.awk $out/regions.txt $out/counted.s $out/steps.txt | sort -t, -k1,2 -k4,4nr >$out/functions.csv
   echo
   echo "8. instructions per body-step, by kind (kernel: one step of a block; step: one step more in a call; functions.csv: where)"
   echo
   awk -F, 'NR == 1 || $1 == "kernel" || $1 == "step" || $1 == "call"' $out/instructions.csv | awk -F, '
      { printf "   %-8s %-22s %8s %13s %7s %7s %11s %18s %16s %7s\n", $1, $2, $3, $4, $5, $6, $7, $8, $9, $10 }'
   echo
   awk -F, -v recorded=$plain_drift '$1 == "call" && $2 == "plain drift" {
      printf "   a plain drift: %.1f instructions a body; recorded with gfortran 12.2 and AVX-512: %.1f (%+.1f %%)\n",
         $4, recorded, 100*($4/recorded - 1) }' $out/instructions.csv
}

# What a host pays: layouts, members of poinsot_bodies, few bodies.
ways() {
   have "$CC" && "$CC" -O2 -march=native -ffp-contract=fast -I include -c bench/ways.c -o $out/ways.o 2>/dev/null || return 0
   "$FC" $flags $out/ways.o $libraries -o $out/ways || return 0
   echo
   echo "what a host pays, by the ways of poinsot_bodies"
   echo
   $out/ways $quick
}

# What threads bring, on the machine as it is and on one where each processor has another program.
threads() {
   have "$CC" && "$CC" -O2 -I include -c bench/threads.c -o $out/threads.o 2>/dev/null || return 0
   "$FC" $flags $out/threads.o $libraries -o $out/threads || return 0
   echo
   echo "threads, by the work of a call"
   echo
   $out/threads $quick
}

{
   machine
   $out/bench $quick $out || exit 1
   elliptic
   ways
   threads
   [ -n "$quick" ] || instructions
   [ -n "$quick" ] || { echo; bench/levels.sh; }
   echo
   echo "written: $out/report.txt, times.csv, errors.csv$([ -n "$quick" ] || echo ', instructions.csv, functions.csv')"
} 2>&1 | tee $out/report.txt

[ "${1:-}" = --doc ] || exit 0
awk -v report=$out/report.txt '
   /^```report$/ { print; while ((getline line < report) > 0) if (line !~ /^written/) print line; inside = 1; next }
   /^```$/ { inside = 0 }
   !inside' docs/performance.md >$out/performance.md && cp $out/performance.md docs/performance.md
