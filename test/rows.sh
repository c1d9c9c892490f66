#!/bin/sh
# Rows describe themselves: a method, a splitting and an effect are put into the middle of their tables in a copy of the sources,
# and every command that lists or measures them is run there. Ends with "N passed, M failed".
#
# usage: test/rows.sh       (tools/deep.sh rows runs it)
# environment: FC; the tools of the build in build/tools
set -u
cd "$(dirname "$0")/.." || exit 1
root=$PWD copy=$PWD/build/rows
passed=0 failed=0
told() { # RESULT WHAT
   if [ "$1" = 0 ]; then
      echo "       ... $2 [PASSED]"
      passed=$((passed + 1))
   else
      echo "       ... $2 [FAILED]"
      failed=$((failed + 1))
   fi
}

rm -rf "$copy"
mkdir -p "$copy/build"
tar cf - --exclude=./build --exclude=./.git . | tar xf - -C "$copy" || exit 1
ln -s "$root/build/tools" "$copy/build/tools"
cp "$root/build/builder" "$copy/build/" 2>/dev/null
cp -r "$root/build/dependencies" "$copy/build/" 2>/dev/null
cd "$copy" || exit 1

# A second implicit midpoint rule, Verlet's scheme that begins with a rotation, and gravity by another name.
sed -i '/method_row("jacobi"/i\      method_row("dummy-method", 99, "dummy", 2, "dummy", "midpoint once more"), \&
/case ("midpoint")/i\      case ("dummy")\
         method%increment => midpoint_increment' src/free/method.f90
sed -i '/tableau("forest-ruth"/i\      tableau("dummy-splitting", 98, 2, "Nobody", 2000, "nowhere", "a test", "T", \&\
         reshape([0.5_dp, 1.0_dp], [width], zero)), \&' src/splitting/tableaux.f90
sed 's/gravity/dummy_effect/g; s/effect_label("dummy_effect", [0-9]*)/effect_label("dummy_effect", 97)/' src/effect/gravity.f90 >src/effect/dummy_effect.f90
sed -i '/use poinsot_effect_field,/i\   use poinsot_effect_dummy_effect, only: dummy_effect_label, dummy_effect_row
/^      field_label/i\      dummy_effect_label, \&
/row_source(field_row)/i\         row_source(dummy_effect_row), \&' src/effect/registry.f90
EXTRA_FLAGS="-O1" SETUP=no tools/build.sh stage >build.log 2>&1
told $? "an app with three more rows builds (build/rows/build.log)"
app=$copy/build/stage/bin/poinsot
[ -x "$app" ] || { echo "$passed passed, $((failed + 1)) failed"; exit 1; }

"$app" methods | grep -q '^dummy-method .*midpoint once more'; told $? "methods"
"$app" splittings | grep -q '^dummy-splitting .*a test'; told $? "splittings"
"$app" effects | grep -q '^dummy_effect .*U = weight'; told $? "effects"
"$app" effects dummy_effect | grep -q centre; told $? "effects dummy_effect"
"$app" keys | grep -q '&dummy_effect'; told $? "keys"

"$app" hard --out hard >hard.txt; told $? "hard: every verdict is good"
awk -F, '$2 == "dummy-method" { a[$1 $3] = $8 $9 $10 } $2 == "midpoint" { b[$1 $3] = $8 $9 $10 }
   END { for (k in b) { n++; if (a[k] != b[k]) exit 1 } exit n < 20 }' hard/hard.csv; told $? "hard.csv: the figures are the method's own"
awk '/ exact .* dummy/ { for (i = 1; i <= NF; i++) at[$i] = i + 1 }
   /^generic / { n++; if ($at["dummy"] != $at["midpnt"] || $at["dummy"] == $at["exact"]) bad = 1 }
   END { exit bad || n < 2 }' hard.txt; told $? "hard: figures stand under their headings"
grep -q '^dummy-splitting .*[0-9]' hard.txt && "$app" hard dummy-splitting >/dev/null; told $? "hard: a line for the splitting"
"$app" properties --out properties >properties.txt && grep -q '^dummy-method .*no map' properties.txt &&
   grep -q '^midpoint .*no      no ' properties.txt; told $? "properties: a kernel without a map is measured alone"

scene() { # EFFECT: a body whose axes are not principal, and a body vector
   echo "&scene t_end = 1, h = 0.05, splitting = 'srkn4' / &bodies tensor = 0.9, 0.1, 0.02, 0.1, 0.8, 0, 0.02, 0, 0.7, y = 1, 0.4, -0.9 /
&$1 centre = 0.1, 0.2, 0.5, weight = 2 / &output every = 0.1 /" >"$1.nml"
   "$app" run "$1.nml" --out "$1" --no-pictures >/dev/null
}
scene gravity && scene dummy_effect && cmp gravity/trajectory.csv dummy_effect/trajectory.csv; told $? "an effect with a body vector, in any frame"
"$app" run gravity.nml --set "scene.method='dummy-method'" --set "scene.splitting='dummy-splitting'" --out other --no-pictures >/dev/null
told $? "run"
"$app" cost heavy-top --methods exact,dummy-method --splittings dummy-splitting --budget 3s --no-pictures --out cost >/dev/null &&
   grep -q 'dummy-method.*dummy-splitting' cost/cost.csv; told $? "cost"
"$app" choose heavy-top --tol 1e-3 --methods dummy-method --splittings dummy-splitting --budget 3s >choose.txt 2>&1 &&
   grep -q dummy-splitting choose.txt; told $? "choose"

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
