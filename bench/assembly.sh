#!/bin/sh
# Are the kernels vector code? In the functions of the files below no loop may hold scalar floating-point arithmetic, and the
# arithmetic in vectors must be there, at the full width that the processor of the build has.
#
# usage: bench/assembly.sh [--all]      after `make build`; --all shows every function, not only the bad ones
# A build for another kind of processor, or without optimisation, is not judged (exit code 0, and it says so).
#
# A loop: the instructions from the target of a backward jump to the jump. It is bad if it has scalar arithmetic and no vector
# arithmetic; one with both is a block of code that another one comes back to, and its scalars are set-up.

set -u
cd "$(dirname "$0")/.." || exit 1
library=build/stage/lib/libpoinsot.a
kernels="free_exact_step free_exact_lanes free_jacobi_solution body_constants body_series_start free_series free_moser_veselov free_accumulate free_split_rotations"
command -v objdump >/dev/null 2>&1 || { echo "assembly: no objdump here, not judged"; exit 0; }
[ -f $library ] || { echo "assembly: run 'make build' first" >&2; exit 2; }
[ "$(uname -m)" = x86_64 ] || { echo "assembly: not x86-64, not judged"; exit 0; }

objdump -d --no-show-raw-insn $library | awk -v kernels="$kernels" -v all="${1:-}" '
   function decimal(hex, i, v) {
      v = 0
      for (i = 1; i <= length(hex); i++) v = v*16 + index("0123456789abcdef", substr(hex, i, 1)) - 1
      return v
   }
   function judge(    i, j, vectors, bad) {
      if (name == "") return
      bad = 0
      for (j = 1; j <= jumps; j++) {
         vectors = 0
         for (i = 1; i <= n; i++) if (at[i] >= target[j] && at[i] <= from[j] && vector[i]) vectors++
         if (vectors > 0) continue
         for (i = 1; i <= n; i++)
            if (at[i] >= target[j] && at[i] <= from[j] && scalar[i] && !seen[i]) { seen[i] = 1; bad++ }
      }
      functions++
      total_zmm += zmm
      total_ymm += ymm
      scalars += bad
      if (bad > 0 || all != "")
         printf "   %-70s zmm %4d  ymm %4d  xmm %4d  scalar arithmetic in loops %3d\n", name, zmm, ymm, xmm, bad
      if (bad > 0) failed++
   }
   function clear() {
      n = jumps = zmm = ymm = xmm = 0
      delete at; delete scalar; delete vector; delete seen; delete target; delete from
   }
   /^[0-9a-f]+ <.*>:$/ {
      judge()
      clear()
      name = ""
      split(kernels, kernel, " ")
      for (i in kernel) if (index($2, "__poinsot_" kernel[i] "_MOD_") > 0) name = $2
      gsub(/[<>:]/, "", name)
      next
   }
   name != "" && /^ *[0-9a-f]+:/ {
      n++
      here = $1
      sub(/:/, "", here)
      at[n] = decimal(here)
      if (/%zmm/) arithmetic = "zmm"; else if (/%ymm/) arithmetic = "ymm"; else if (/%xmm/) arithmetic = "xmm"; else arithmetic = ""
      if ($2 ~ /^v?(add|sub|mul|div|sqrt|fmadd|fmsub|fnmadd|fnmsub)[0-9]*pd$/) {
         if (arithmetic == "zmm") zmm++
         if (arithmetic == "ymm") ymm++
         if (arithmetic == "xmm") xmm++
         if (arithmetic != "xmm") vector[n] = 1
      }
      scalar[n] = $2 ~ /^v?(add|sub|mul|div|sqrt|fmadd|fmsub|fnmadd|fnmsub)[0-9]*sd$/
      if ($2 ~ /^j/ && $3 ~ /^[0-9a-f]+$/ && decimal($3) <= at[n]) {
         jumps++
         target[jumps] = decimal($3)
         from[jumps] = at[n]
      }
   }
   END {
      judge()
      if (functions == 0 || total_zmm + total_ymm < 100) {
         printf "assembly: %d functions, hardly any wide vectors: a portable build, not judged\n", functions
         exit 0
      }
      printf "assembly: %d functions of the kernels, vector arithmetic %d zmm, %d ymm; %d with scalar arithmetic in a loop\n", functions, total_zmm, total_ymm, failed
      exit failed > 0
   }'
