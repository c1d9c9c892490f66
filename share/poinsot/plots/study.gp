# What the pictures of a cost study share: names of the curves in cost.csv and drift.csv, axes, a title.
load 'cost.gp'
if (rivals == 0) { array rival_name[1] = [''] }
load 'common.gp'
set datafile separator ','
label(k) = strcol(2) eq '-' ? strcol(1) : strcol(1) . ' + ' . strcol(2)
at_least(x) = larger(x, 1e-17)   # no error is beyond the end of an axis
logarithmic = "set logscale xy; set format x '10^{%T}'; set format y '10^{%T}'; set border 3; " . \
   "set tics nomirror out; unset key; set grid lc rgb '#ececec' lt 1 lw 0.7; set tmargin 3"
title(what) = (strlen(scene) > 32 ? scene[1:30] . '...' : scene) . ': ' . what
fraction(x, from, to) = log(x/from)/log(to/from)
