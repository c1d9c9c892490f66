#!/bin/sh
# Print include/poinsot_legacy.f90, made from the declarations of include/poinsot.h: explicit interfaces for
# Fortran hosts. test/exports.sh compares. usage: tools/legacy_interface.sh >include/poinsot_legacy.f90
cd "$(dirname "$0")/.." || exit 1

awk '
# "const double moments[3]" -> kind, intent, name, shape
function declare(argument,   name, shape, type, constant, callback) {
   constant = argument ~ /^const /
   sub(/^const /, "", argument)
   type = argument
   sub(/ .*/, "", type)
   name = argument
   sub(/^[a-z0-9_]+ \**/, "", name)
   shape = ""
   if (name ~ /\[\]$/) shape = "(*)"
   if (match(name, /\[[0-9]+\]$/)) shape = "(" substr(name, RSTART + 1, RLENGTH - 2) ")"
   sub(/\[.*/, "", name)
   names[++n] = name
   if (type == "poinsot_torque_f") { lines[n] = "         procedure(poinsot_torque_f) :: " name; return }
   kind = type == "double" ? "real(c_double)" : type == "int64_t" ? "integer(c_int64_t)" : type == "char" ? "character(*)" : "integer(c_int)"
   intent = constant ? "in" : name ~ /^(y|q|p)[0-9]?$/ || name == "plan" || name == "each" ? "inout" : "out"
   lines[n] = "         " kind ", intent(" intent ") :: " name shape
}

# A list in lines of at most 96 columns, to be continued with &.
function folded(head, list, count, tail,   i, line, text) {
   line = head
   text = ""
   for (i = 1; i <= count; i++) {
      piece = list[i] (i < count ? ", " : tail)
      if (length(line piece) > 94) { text = text line "&\n"; line = "         " }
      line = line piece
   }
   return text line
}

function show(declaration,   name, arguments, part, i, k) {
   name = declaration
   sub(/\(.*/, "", name)
   sub(/^.* /, "", name)
   sub(/_$/, "", name)
   arguments = declaration
   sub(/^[^(]*\(/, "", arguments)
   sub(/\);.*/, "", arguments)
   k = split(arguments, part, /, */)
   n = 0
   for (i = 1; i <= k; i++) declare(part[i])
   text = "\n" folded("      subroutine " name "(", names, n, ")") "\n"
   text = text "         import\n         implicit none\n"
   for (i = 1; i <= n; i++) text = text lines[i] "\n"
   text = text "      end subroutine " name "\n"
   body = body text
   public[++count] = name
}

/^void poinsot_.*_f_\(/ { whole = $0; while (whole !~ /;/) { getline; sub(/^ */, "", $0); whole = whole " " $0 } show(whole) }

END {
   print "! Interfaces of the subroutines poinsot_..._f, for Fortran hosts that want the compiler to check the"
   print "! arguments of calls; poinsot.h documents them. Compile this file with the host: it works with any"
   print "! compiler that appends one underscore to external names. Generated from poinsot.h."
   print "module poinsot_legacy"
   print "   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t"
   print "   implicit none"
   print "   private"
   for (i = 1; i <= count; i++) print "   public :: " public[i]
   print "   public :: poinsot_torque_f"
   print ""
   print "   abstract interface"
   print "      subroutine poinsot_torque_f(t, n, q, torque, stop)"
   print "         import"
   print "         implicit none"
   print "         real(c_double), intent(in) :: t"
   print "         integer(c_int), intent(in) :: n"
   print "         real(c_double), intent(in) :: q(n, 4)"
   print "         real(c_double), intent(inout) :: torque(n, 3)"
   print "         integer(c_int), intent(inout) :: stop"
   print "      end subroutine poinsot_torque_f"
   print "   end interface"
   print ""
   printf "   interface"
   printf "%s", body
   print "   end interface"
   print ""
   print "end module poinsot_legacy"
}
' include/poinsot.h
