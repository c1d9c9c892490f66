#!/bin/sh
# The gallery of the shipped scenes: runs each into build/gallery/NAME, where its page (view.html) and all its pictures are, and
# writes docs/gallery.md with one picture of each, 640 dots wide, in docs/pictures/scenes, and the text of the scene's own header.
#
# usage: make gallery, or tools/gallery.sh [NAME ...]: only these scenes are run anew; the others keep their picture
# environment: POINSOT the app (build/stage/bin/poinsot)

set -u
cd "$(dirname "$0")/.." || exit 1
app=${POINSOT:-$PWD/build/stage/bin/poinsot}
out=build/gallery
pictures=docs/pictures/scenes
page=docs/gallery.md
mkdir -p $out $pictures

# The most telling picture of a scene: the first that its header mentions.
picture_of() {
   sed -n '/^!/!q; p' "scenes/$1.nml" | tr -c 'a-z.\n' ' ' | tr ' ' '\n' | grep '\.png$' | head -n 1
}

# The header without comment marks.
words_of() { sed -n '/^!/!q; s/^! \{0,1\}//p' "scenes/$1.nml"; }

# draw FOLDER PICTURE NAME: again, smaller; gnuplot's own script in the run's folder.
draw() {
   mv "$1/$2" "$1/$2.large" && (cd "$1" && gnuplot -e "kinds = 'pngcairo'; dots = 640" "plot_${2%.png}.gp") || return 1
   mv "$1/$2" "$pictures/$3.png" && mv "$1/$2.large" "$1/$2"
}

names=$("$app" scenes | awk 'NF == 0 { exit } { print $1 }')
for name in ${*:-$names}; do
   "$app" run "scenes/$name.nml" --out $out/$name --quiet || exit 1
   draw $out/$name "$(picture_of "$name")" "$name" || { echo "$name: no picture"; exit 1; }
   echo "$out/$name/view.html, $pictures/$name.png   $(wc -c <$pictures/$name.png) bytes"
done

{
   echo '# Gallery'
   echo
   echo 'The shipped scenes, made by `make gallery`. `poinsot run NAME` writes these pictures, the others mentioned here, and'
   echo '`view.html`: the motion, to watch in any browser.'
   for name in $names; do
      printf '\n## %s\n\n**%s**\n\n![%s](pictures/scenes/%s.png)\n\n' "$name" "$(words_of "$name" | head -n 1)" "$name" "$name"
      words_of "$name" | sed '1d; /./,$!d'
   done
} >$page.part && mv $page.part $page
echo $page
