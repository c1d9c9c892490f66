# Joins what stepper.c counted with the disassembly: instructions per body-step by sort, and with -v functions=1 by function.
#
# usage: objdump -d --no-show-raw-insn PROGRAM | awk -f mix.awk regions.txt - steps.txt
# output (CSV): kind, name, h |omega|, per body-step: instructions, zmm, ymm, xmm packed, scalar floating-point arithmetic,
# divisions and square roots (vector or scalar), the rest. A region with several steps is followed by the difference to the one with
# one step: kind "step". With functions=1: region, function, instructions and scalar arithmetic per body-step.

BEGIN { FS = "[ \t]+"; regions = 0 }

FNR == 1 { file++ }

file == 1 {
   split($0, part, ",")
   n = split($0, part, ",")
   steps[regions] = part[n]
   phase[regions] = part[n - 1]
   label = $0
   sub(/,[^,]*,[^,]*$/, "", label)
   name[regions++] = label
   next
}

file == 2 && /^[0-9a-f]+ <.*>:$/ { function_name = $2; gsub(/[<>:]/, "", function_name); next }

# "  441270:\tvmulsd %xmm2,..."
file == 2 && /^ *[0-9a-f]+:\t/ {
   split($0, piece, ":\t")
   address = piece[1]
   gsub(/ /, "", address)
   split(piece[2], word, " ")
   operation[address] = sort_of(word[1], piece[2])
   slow[address] = word[1] ~ /^v?(div|sqrt)[ps][sd]/
   scalar[address] = word[1] ~ /^v?(add|sub|mul|div|sqrt|min|max|fmadd|fmsub|fnmadd|fnmsub)[0-9]*s[sd]$/
   inside[address] = function_name
   next
}

file == 3 {
   all[$1] += $3
   by[$1, operation[$2]] += $3
   if (slow[$2]) slows[$1] += $3
   if (scalar[$2]) scalars[$1] += $3
   key = $1 SUBSEP inside[$2]
   of_function[key] += $3
   if (scalar[$2]) scalar_of[key] += $3
   if (operation[$2] == "zmm" || operation[$2] == "ymm") wide_of[key] += $3
}

function sort_of(op, line) {
   if (line ~ /%zmm/) return "zmm"
   if (line ~ /%ymm/) return "ymm"
   if (op ~ /^v?[a-z0-9]*[ps][sd]/ && line ~ /%xmm/) return op ~ /p[sd]$/ ? "xmm" : "scalar"
   return "rest"
}

function show(label, size, total, z, y, x, s, d) {
   printf "%s,%.1f,%.1f,%.1f,%.1f,%.2f,%.2f,%.1f\n", label, total/size, z/size, y/size, x/size, s/size, d/size, (total - z - y - x - s)/size
}

END {
   if (functions) {
      print "region,function,instructions,wide,scalar_arithmetic"
      for (key in of_function) {
         split(key, part, SUBSEP)
         k = part[1]
         if (of_function[key]/steps[k] >= 0.3)
            printf "%s at %s,%s,%.1f,%.1f,%.1f\n", name[k], phase[k], part[2], of_function[key]/steps[k], wide_of[key]/steps[k], scalar_of[key]/steps[k]
      }
      exit
   }
   print "kind,name,h_omega,instructions,zmm,ymm,xmm_packed,scalar_arithmetic,divide_and_root,rest"
   for (k = 0; k < regions; k++) {
      show(name[k] "," phase[k], steps[k], all[k], by[k, "zmm"], by[k, "ymm"], by[k, "xmm"], scalars[k], slows[k])
      if (k > 0 && name[k] == name[k - 1] && steps[k] > steps[k - 1]) {
         label = name[k]
         sub(/^[^,]*/, "step", label)
         show(label "," phase[k], steps[k] - steps[k - 1], all[k] - all[k - 1], by[k, "zmm"] - by[k - 1, "zmm"],
            by[k, "ymm"] - by[k - 1, "ymm"], by[k, "xmm"] - by[k - 1, "xmm"], scalars[k] - scalars[k - 1], slows[k] - slows[k - 1])
      }
   }
}
