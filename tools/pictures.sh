#!/bin/sh
# All pictures of the documentation anew, into docs/pictures: runs the studies they show and draws them 960 dots wide.
# Times are those of this machine: run it on one at rest. About five minutes after `make build`.
#
# usage: tools/pictures.sh [BUDGET]     of each cost study (60s)

set -eu
cd "$(dirname "$0")/.."
budget=${1:-60s}
app=build/stage/bin/poinsot
work=build/pictures
pictures=$PWD/docs/pictures
[ -x $app ] || { echo "tools/pictures.sh: run 'make build' first" >&2; exit 1; }
command -v gnuplot >/dev/null || { echo "tools/pictures.sh: needs gnuplot" >&2; exit 1; }
mkdir -p "$pictures"

# draw FOLDER PICTURE NAME [WIDTH]: PICTURE of the run or study in FOLDER as docs/pictures/NAME.png, so many dots wide.
draw() {
   (cd "$work/$1" && gnuplot -e "kinds = 'pngcairo'; dots = ${4:-960}" "plot_$2.gp" && mv "$2.png" "$pictures/$3.png")
   echo "docs/pictures/$3.png   $(wc -c <"$pictures/$3.png") bytes"
}

$app run free-body --no-pictures --quiet --out $work/free-body
draw free-body attitude free-body-attitude
$app run heavy-top --no-pictures --quiet --out $work/heavy-top
draw heavy-top nutation heavy-top-nutation
for figure in hairer-vilmart fasso celledoni; do
   $app reproduce $figure --no-pictures --quiet --out $work/$figure
   draw $figure $figure $figure
   cat $work/$figure/$figure.txt
done
for scene in heavy-top free-body; do
   $app cost $scene --budget "$budget" --no-pictures --quiet --out $work/$scene-cost
   draw $scene-cost attitude_cost $scene-cost 800
   draw $scene-cost attitude_step $scene-steps
   draw $scene-cost energy_drift $scene-energy
   cat $work/$scene-cost/cost.txt
done
