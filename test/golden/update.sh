#!/bin/sh
# Write the golden outputs anew, from the program named by POINSOT_APP. Read the difference before you commit it.
cd "$(dirname "$0")/../.." || exit 1
app=${POINSOT_APP:-$PWD/build/stage/bin/poinsot}
for file in test/golden/*.txt; do
   arguments=$(sed -n '1s/^\$ poinsot //p' "$file")
   { echo "\$ poinsot $arguments"; eval "'$app' $arguments"; echo "exit $?"; } >"$file.new" 2>&1
   mv "$file.new" "$file"
done
