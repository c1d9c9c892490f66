# Names of curves at their ends, none on another; a thin line leads from an end to a name that had to move.
# Before: ends of them, arrays end_x and end_y (fractions of the graph), end_text, end_colour; gap and letter, the height and the
# width of a letter as such fractions; perhaps an array end_shape: the points of its curve stand before a name.
# After: overhang, by how many letters names stand out on the right.
array place[ends]
array name_x[ends]
overhang = 0
# Ends that nearly stand below each other have their names so.
follows(j, x) = end_x[j] > farthest && end_x[j] - x < 0.05 ? (farthest = end_x[j]) : farthest
row_of(x) = (farthest = x, sum [j=1:ends] follows(j, x), farthest)
do for [k=1:ends] {
   place[k] = end_y[k]
   name_x[k] = row_of(end_x[k]) + (exists('end_shape') ? 2.2 : 1.2)*letter
   overhang = larger(overhang, (name_x[k] - 1)/letter + strlen(end_text[k]))
}
beside(i, j) = name_x[i] < name_x[j] + letter*(strlen(end_text[j]) + 1) && name_x[j] < name_x[i] + letter*(strlen(end_text[i]) + 1)
meet(i, j) = abs(place[i] - place[j]) < gap && beside(i, j)

# From the top down: each name goes to the free place that is nearest to its end, below the names of higher ends if there is room.
array done[ends]
do for [k=1:ends] { done[k] = 0 }
do for [n=1:ends] {
   next = 0
   do for [k=1:ends] { if (!done[k] && (next == 0 || end_y[k] > end_y[next > 0 ? next : k])) { next = k } }
   do for [try=0:800] {
      place[next] = end_y[next] + (try%2 ? -0.05 : 0.05)*gap*(try%401)
      free = place[next] > 0 && place[next] < 1.02
      do for [k=1:ends] {
         if (done[k] && (meet(next, k) || (try <= 400 && beside(next, k) && place[next] > place[k]))) { free = 0 }
      }
      if (free) { break }
   }
   done[next] = 1
}
do for [k=1:ends] {
   set label 100+k end_text[k] at graph name_x[k], graph place[k] left tc rgb end_colour[k] font ',10' noenhanced front
   if (exists('end_shape')) {
      set label 200+k '' at graph name_x[k] - 1.1*letter, graph place[k] point pt end_shape[k] ps 0.7 lc rgb end_colour[k] front
   }
   if (abs(place[k] - end_y[k]) > 0.6*gap || name_x[k] - end_x[k] > 3*letter) {
      set arrow 100+k from graph end_x[k]+0.3*letter, graph end_y[k] \
         to graph name_x[k]-(exists('end_shape') ? 1.8 : 0.3)*letter, graph place[k] nohead lw 0.8 dt 3 lc rgb end_colour[k]
   }
}
