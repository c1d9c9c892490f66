# Names beside the right ends of curves, moved up and down until none lies on another; a thin line leads from each curve to its
# name. Before: ends of them, array end_x and end_y (fractions of the graph), end_text, end_colour; gap, the least distance.
array place[ends]
array order[ends]
do for [k=1:ends] { place[k] = end_y[k]; order[k] = k }
do for [i=2:ends] {
   do for [j=ends:i:-1] {
      if (end_y[order[j]] > end_y[order[j-1]]) { swap = order[j]; order[j] = order[j-1]; order[j-1] = swap }
   }
}
do for [pass=1:60] {
   place[order[1]] = smaller(place[order[1]], 1)
   place[order[ends]] = larger(place[order[ends]], 0)
   do for [i=2:ends] {
      lack = gap - (place[order[i-1]] - place[order[i]])
      if (lack > 0) { place[order[i-1]] = place[order[i-1]] + 0.5*lack; place[order[i]] = place[order[i]] - 0.5*lack }
   }
}
do for [k=1:ends] {
   set label 100+k end_text[k] at graph 1.03, graph place[k] left tc rgb end_colour[k] font ',10' noenhanced front
   if (end_x[k] < 0.99 || abs(place[k] - end_y[k]) > 0.3*gap) {
      set arrow 100+k from graph end_x[k]+0.004, graph end_y[k] to graph 1.025, graph place[k] nohead lw 0.5 lc rgb end_colour[k]
   }
}
