#!/bin/sh
# include/poinsot.h without comments, directives and C++: poinsot_cdef.h, for cffi and other generators of bindings.
#
# usage: tools/install/cdef.sh
cd "$(dirname "$0")/../.." || exit 1
echo "/* Made from poinsot.h, which has the documentation; size_t, ptrdiff_t and int64_t are those of C. */"
awk '
   { text = text $0 "\n" }
   END {
      while (i = index(text, "/*")) {
         rest = substr(text, i + 2)
         text = substr(text, 1, i - 1) " " substr(rest, index(rest, "*/") + 2)
      }
      gsub(/\\\n/, " ", text)
      gsub(/#ifdef __cplusplus[^#]*#endif/, "", text)
      gsub(/(^|\n)[ \t]*#[^\n]*/, "\n", text)
      gsub(/[ \t]+\n/, "\n", text)
      gsub(/\n\n+/, "\n", text)
      printf "%s", text
   }' include/poinsot.h
