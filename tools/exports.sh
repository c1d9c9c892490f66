#!/bin/sh
# What the shared library exports: the functions of include/poinsot.h, and of Fortran what a program needs that uses the public
# modules (src/*.f90: poinsot, poinsot_rotation, ...): their names, the specific procedures behind generic ones, and of types
# what gfortran makes for them and the procedures bound to them. Read from the sources, so that no list has to be kept.
#
# usage: tools/exports.sh c               the C functions, one a line
#        tools/exports.sh fortran         the Fortran symbols, one a line; of types patterns
#        tools/exports.sh modules         the public modules
#        tools/exports.sh map             a version script for the linker (gfortran's names, flang's, Intel's)
#        tools/exports.sh list            the same for macOS, -exported_symbols_list

set -u
cd "$(dirname "$0")/.." || exit 1

# Declarations of the header: without comments, directives and braces, what stands before the first parenthesis.
c_functions() {
   awk '
      { text = text $0 "\n" }
      END {
         while (i = index(text, "/*")) {
            rest = substr(text, i + 2)
            text = substr(text, 1, i - 1) " " substr(rest, index(rest, "*/") + 2)
         }
         gsub(/\\\n/, " ", text)
         gsub(/(^|\n)[ \t]*#[^\n]*/, "\n", text)
         gsub(/extern[ \t]+"C"[ \t]*{/, "", text)
         n = split(text, statement, /;/)
         for (i = 1; i <= n; i++) {
            it = statement[i]
            gsub(/[ \t\n]+/, " ", it)
            if (it ~ /^ *typedef/ || it !~ /poinsot_[a-z0-9_]+\)? *\(/) continue
            match(it, /poinsot_[a-z0-9_]+\)? *\(/)
            it = substr(it, RSTART, RLENGTH)
            gsub(/[() ]/, "", it)
            print it
         }
      }' include/poinsot.h | sort
}

# A line for each symbol: module, name; or module, *, type.
fortran_names() {
   cat src/*.f90 src/*/*.f90 | awk '
      function words(list, into,   n, i) {
         n = split(list, into, /,/)
         for (i = 1; i <= n; i++) gsub(/^ +| +$/, "", into[i])
         return n
      }
      function statement(s,   n, i, j, it, from, list) {
         gsub(/[ \t]+/, " ", s)
         sub(/^ /, "", s)
         s = tolower(s)
         if (s ~ /^module [a-z]/ && s !~ /^module procedure/ && s !~ /^module (sub|func)/) { split(s, it, " "); module = it[2]; inside = ""; bound = 0; return }
         if (s ~ /^use poinsot[a-z0-9_]*, only:/) {
            split(s, it, /[ ,]/)
            from = it[2]
            sub(/^[^:]*: */, "", s)
            n = words(s, list)
            for (i = 1; i <= n; i++) {
               j = index(list[i], "=>")
               local = j ? substr(list[i], 1, j - 1) : list[i]
               gsub(/ /, "", local)
               origin = j ? substr(list[i], j + 2) : list[i]
               gsub(/^ /, "", origin)
               source[module, local] = from SUBSEP origin
               locals[module] = locals[module] "," local
            }
         } else if (s ~ /^public ::/) {
            sub(/^public :: */, "", s)
            public[module] = public[module] "," s
         } else if (s ~ /^(public|private)$/) {
            if (!inside) open[module] = s == "public"
         } else if (s ~ /^(abstract )?interface( |$)/) {
            inside = "interface"
            name = s
            sub(/^(abstract )?interface ?/, "", name)
         } else if (s ~ /^end interface/) inside = ""
         else if (inside == "interface" && name != "" && s ~ /^(module )?procedure/) {
            sub(/^(module )?procedure *(:: *)?/, "", s)
            generic[module, name] = generic[module, name] "," s
         } else if (s ~ /^type(,.*)? ?::/ || s ~ /^type [a-z]/) {
            name = s
            sub(/^type[^:]*:: */, "", name)
            sub(/^type /, "", name)
            inside = "type"
            bound = 0
            is_type[module, name] = 1
            if (match(s, /extends\([a-z0-9_]+\)/)) parent[module, name] = substr(s, RSTART + 8, RLENGTH - 9)
            if (s ~ /, public/) public[module] = public[module] "," name
         } else if (s ~ /^end type/) inside = ""
         else if (inside == "type" && s == "contains") bound = 1
         else if (inside == "type" && bound && s ~ /^(procedure|final)/ && s ~ /::/ && s !~ /deferred/) {
            sub(/^[^:]*:: */, "", s)
            n = words(s, list)
            for (i = 1; i <= n; i++) {
               if (j = index(list[i], "=>")) list[i] = substr(list[i], j + 2)
               gsub(/ /, "", list[i])
               binding[module, name] = binding[module, name] "," list[i]
            }
         } else if (inside == "type" && !bound && match(s, /^(type|class)\([a-z0-9_]+\)/))
            component[module, name] = component[module, name] "," substr(s, index(s, "(") + 1, RLENGTH - index(s, "(") - 1)
      }
      function emit(m, name, shallow,   it, list, n, i) {
         if ((m, name, shallow) in done) return
         done[m, name, shallow] = 1
         if ((m, name) in source) {
            split(source[m, name], it, SUBSEP)
            emit(it[1], it[2], shallow)
            if (!((m, name) in generic)) return
         }
         if ((m, name) in generic) {
            n = words(substr(generic[m, name], 2), list)
            for (i = 1; i <= n; i++) emit(m, list[i])
            return
         }
         if (!((m, name) in is_type)) { print m, name; return }
         print m, "*", name
         n = words(substr(component[m, name], 2), list)
         for (i = 1; i <= n; i++) emit(m, list[i], 1)
         if ((m, name) in parent) emit(m, parent[m, name], shallow)
         if (shallow) return
         n = words(substr(binding[m, name], 2), list)
         for (i = 1; i <= n; i++) emit(m, list[i])
      }
      # Comments go (no text of ours holds a mark of exclamation and a name), continued lines are joined.
      {
         line = $0
         gsub(/"[^"]*"/, "\"\"", line)
         sub(/!.*/, "", line)
         sub(/^[ \t]*&/, "", line)
         sub(/[ \t]+$/, "", line)
         if (line ~ /&$/) { sub(/&$/, "", line); part = part line; next }
         if (part line !~ /^[ \t]*$/) statement(part line)
         part = ""
      }
      END {
         split("'"$(modules | tr '\n' ' ')"'", front, " ")
         for (k in front) {
            m = front[k]
            count = words((open[m] ? locals[m] : "") public[m], all)
            for (w = 1; w <= count; w++) if (all[w] != "") emit(m, all[w])
         }
      }' | sort -u
}
modules() { for file in src/*.f90; do basename "$file" .f90 | sed 's/^poinsot$/&/; t; s/^/poinsot_/'; done; }

gfortran() { awk '$2 != "*" { print "__" $1 "_MOD_" $2 } $2 == "*" { print "__" $1 "_MOD___*_" toupper(substr($3, 1, 1)) substr($3, 2) }'; }

case ${1:-} in
c) c_functions ;;
modules) modules ;;
fortran) fortran_names | gfortran ;;
map)
   echo "{ global:"
   c_functions | sed 's/$/;/'
   names=$(fortran_names)
   echo "$names" | gfortran | sed 's/$/;/'
   echo "$names" | awk '$2 != "*" { print "_QM" $1 "P" $2 ";" $1 "_mp_" $2 "_;" }
      $2 == "*" { print "_QM" $1 "E*" $3 "*;" }' # flang; Intel
   echo "local: *; };"
   ;;
list)
   { c_functions; fortran_names | gfortran; } | sed 's/^/_/'
   ;;
*)
   echo "usage: tools/exports.sh c | fortran | modules | map | list" >&2
   exit 2
   ;;
esac
