#!/bin/sh
# Rows describe themselves: a method, a splitting and two effects are put into the middle of their tables in a copy of the
# sources, and every command that lists or measures them is run there. Ends with "N passed, M failed".
#
# usage: test/rows.sh [quick]      quick: without optimisation, and without what measures (make test); else all (tools/deep.sh rows)
# environment: FC, BUILD (build); not quick: the tools of the build in build/tools
set -u
cd "$(dirname "$0")/.." || exit 1
FC=${FC:-gfortran} BUILD=${BUILD:-build}
case $BUILD in /*) ;; *) BUILD=$PWD/$BUILD ;; esac
copy=$BUILD/rows quick=${1:-}
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
tar cf - fpm.toml CMakeLists.txt Makefile app include scenes share src tools $(ls -d example test 2>/dev/null) | tar xf - -C "$copy" || exit 1
cd "$copy" || exit 1

# A second implicit midpoint rule, Verlet's scheme that begins with a rotation, gravity and a thermostat by other names.
sed -i '/method_row("jacobi"/i\      method_row("dummy-method", 99, "dummy", 2, "dummy", "midpoint once more"), \&
/case ("midpoint")/i\      case ("dummy")\
         method%increment => midpoint_increment' src/free/method.f90
sed -i '/tableau("forest-ruth"/i\      tableau("dummy-splitting", 98, 2, "Nobody", 2000, "nowhere", "a test", "T", \&\
         reshape([0.5_dp, 1.0_dp], [width], zero)), \&' src/splitting/tableaux.f90
sed 's/gravity/dummy_effect/g; s/effect_label("dummy_effect", [0-9]*)/effect_label("dummy_effect", 97)/' src/effect/gravity.f90 >src/effect/dummy_effect.f90
sed 's/langevin/dummy_noise/g; s/effect_label("dummy_noise", [0-9]*)/effect_label("dummy_noise", 96)/' src/effect/langevin.f90 >src/effect/dummy_noise.f90
sed -i '/use poinsot_effect_field,/i\   use poinsot_effect_dummy_effect, only: dummy_effect_label, dummy_effect_row\
   use poinsot_effect_dummy_noise, only: dummy_noise_label, dummy_noise_row
/^      field_label/i\      dummy_effect_label, dummy_noise_label, \&
/row_source(field_row)/i\         row_source(dummy_effect_row), row_source(dummy_noise_row), \&' src/effect/registry.f90
if [ "$quick" = quick ]; then
   app=$copy/bin/poinsot
   mkdir -p mod bin
   # shellcheck disable=SC2046 # words
   "$FC" -O0 -fopenmp -fPIC -cpp -Iinclude -J mod -o "$app" $(tools/sources.sh $(echo app/*.f90)) -llapack -lblas >build.log 2>&1
else
   app=$copy/build/stage/bin/poinsot
   ln -s "$BUILD/tools" build/tools
   cp "$BUILD/builder" build/ 2>/dev/null
   cp -r "$BUILD/dependencies" build/ 2>/dev/null
   BUILD=build EXTRA_FLAGS="-O1" SETUP=no tools/build.sh stage >build.log 2>&1
fi
told $? "an app with four more rows builds ($copy/build.log)"
[ -x "$app" ] || { echo "$passed passed, $((failed + 1)) failed"; exit 1; }

"$app" methods | grep -q '^dummy-method .*midpoint once more'; told $? "methods"
"$app" splittings | grep -q '^dummy-splitting .*a test'; told $? "splittings"
"$app" effects | grep -q '^dummy_effect .*U = weight'; told $? "effects"
"$app" effects dummy_effect | grep -q centre; told $? "effects dummy_effect"
"$app" keys | grep -q '&dummy_effect'; told $? "keys"

# A body whose axes are not principal, a body vector, an energy of its own: what a scene of gravity has, file for file.
scene() { # EFFECT SETTINGS BODIES OUTPUT
   echo "&scene t_end = 1, h = 0.05, splitting = 'srkn4' / &bodies $3 /
&$1 $2 / &output every = 0.1 ${4:-} /" >"$1.nml"
   "$app" run "$1.nml" --out "$1" --no-pictures >/dev/null
}
same() { # FILE: but for the name of the effect and the times that the run took
   for name in gravity dummy_effect; do
      sed "s/$name/EFFECT/g; /^wall time\|^speed/d" "$name/$1" >"$name/compared"
   done
   cmp gravity/compared dummy_effect/compared
}
both() { scene gravity "$@" && scene dummy_effect "$@"; }
both "centre = 0.1, 0.2, 0.5, weight = 2" "tensor = 0.9, 0.1, 0.02, 0.1, 0.8, 0, 0.02, 0, 0.7, y = 1, 0.4, -0.9"
told $? "scenes with the effect run"
same trajectory.csv; told $? "trajectory.csv, energies too: a body vector in any frame"
same summary.txt; told $? "summary.txt"
same trajectory.gp && ls gravity | grep plot_ >gravity.plots && ls dummy_effect | grep plot_ | cmp - gravity.plots; told $? "pictures: what stays, what is drawn"
same view.html && grep -q '"kind": "top"' dummy_effect/view.html; told $? "view.html: a top"
both "centre = 0, 0, 0.5, weight = 2" "moments = 1, 1, 0.7, y = 1, 0.4, -0.9" "observables = .true." && same trajectory.gp && same observables.csv &&
   grep -q 'energy vertical symmetry' dummy_effect/trajectory.gp; told $? "the third integral of a symmetric top"
for name in langevin dummy_noise; do
   scene $name "friction = 0.1, temperature = 2" "moments = 1, 0.8, 0.7, random = 'thermal', temperature = 1, count = 40" "pictures = 'ensemble'"
done
cmp langevin/trajectory.csv dummy_noise/trajectory.csv && cmp langevin/trajectory.gp dummy_noise/trajectory.gp &&
   ls dummy_noise | grep -q plot_temperature; told $? "noise: pictures of its temperature"
"$app" run dummy_noise.nml --set "scene.splitting='takahashi-imada'" --out refused --no-pictures 2>&1 | grep -q "noise of 'dummy_noise'"
told $? "noise: refused where it would be processed"
"$app" run gravity.nml --set "scene.method='dummy-method'" --set "scene.splitting='dummy-splitting'" --out other --no-pictures >/dev/null
told $? "run"
if [ "$quick" != quick ]; then
   "$app" hard --out hard >hard.txt; told $? "hard: every verdict is good"
   awk -F, '$2 == "dummy-method" { a[$1 $3] = $8 $9 $10 } $2 == "midpoint" { b[$1 $3] = $8 $9 $10 }
      END { for (k in b) { n++; if (a[k] != b[k]) exit 1 } exit n < 20 }' hard/hard.csv; told $? "hard.csv: the figures are the method's own"
   awk '/ exact .* dummy/ { columns = NF; for (i = 1; i <= NF; i++) at[$i] = i + 1 }
      /^generic / && NF == columns + 1 { n++; if ($at["dummy"] != $at["midpnt"] || $at["dummy"] == $at["exact"]) bad = 1 }
      END { exit bad || n < 2 }' hard.txt; told $? "hard: figures stand under their headings"
   grep -q '^dummy-splitting .*[0-9]' hard.txt && "$app" hard dummy-splitting >/dev/null; told $? "hard: a line for the splitting"
   "$app" properties --out properties >properties.txt && grep -q '^dummy-method .*no map' properties.txt &&
      grep -q '^midpoint .*no      no ' properties.txt; told $? "properties: a kernel without a map is measured alone"
   "$app" cost heavy-top --methods exact,dummy-method --splittings dummy-splitting --budget 3s --no-pictures --out cost >/dev/null &&
      grep -q 'dummy-method.*dummy-splitting' cost/cost.csv; told $? "cost"
   "$app" choose heavy-top --tol 1e-3 --methods dummy-method --splittings dummy-splitting --budget 3s >choose.txt 2>&1 &&
      grep -q dummy-splitting choose.txt; told $? "choose"
fi

echo "$passed passed, $failed failed"
[ "$failed" = 0 ]
